// Reading an albedo table; addon/forms/albedo/axes.py explains the axes, addon/forms/albedo/tables.py the image.
//
// The table comes in two ways with the same result: as an array of numbers compiled into the shader (TABLE is a float
// array), or, where TABLE_FILE is defined, from the image file through texture() (TABLE is its name). Both blend
// between the same texels with the same weights.

#ifdef TABLE_FILE
#define TABLE(name) string name
#else
#define TABLE(name) float name[]
#endif

#define TABLE_EDGE 1e-14       // squared sine at the normal that is divided by
#define TABLE_MARK_OFF 1e-3    // by how much marks may be read wrongly: by texture() in half precision,
#define TABLE_STAMP_OFF 5e-6   // the stamp,
#define TABLE_HALF_OFF 2e-3    // and the middle of the mark and the first row
#define TABLE_MOST 2.0         // no albedo is as large

struct Axes {
    int columns;
    float grazing;
    float facing;
    int rows;
    float density;
    float law;
    float stamp;
    int sine;    // read linearly in the sine of the angle
    int height;  // rows of the image, without its markers
    float lowest;   // exponents of the first row and of the last
    float highest;
};

// What a hit needs to know of a table: its row (it has one exponent) and the scales of the columns there.
struct Row {
    Axes axes;
    int row;
    float blend;
    float k;
    float span;
    int flipped;  // texture() counts rows from the bottom
    int valid;
};

float asinh_positive(float x) { return log(x + sqrt(x * x + 1.0)); }
float sinh_of(float x) { float e = exp(x); return 0.5 * (e - 1.0 / e); }

Row table_row(Axes axes, float exponent)
{
    Row r;
    r.axes = axes;
    float start = pow(axes.lowest, -axes.density);
    float step = (start - pow(axes.highest, -axes.density)) / (axes.rows - 1);
    r.row = clamp((int)((start - pow(exponent, -axes.density)) / step), 0, axes.rows - 2);
    float low = pow(start - r.row * step, axes.law / axes.density);
    float high = pow(start - (r.row + 1) * step, axes.law / axes.density);
    r.blend = clamp((pow(exponent, -axes.law) - low) / (high - low), 0.0, 1.0);
    r.k = axes.grazing * sqrt(exponent);
    r.span = asinh_positive(r.k * (axes.facing > 0.0 ? axes.facing * sqrt(exponent) : 1.0));
    r.flipped = 0;
    // Beyond its ends a table would be read wrongly; within a part TABLE_SLACK of them it is not.
    r.valid = exponent >= axes.lowest * (1.0 - TABLE_SLACK) && exponent <= axes.highest * (1.0 + TABLE_SLACK);
    return r;
}

float column_cosine(Row r, int i)
{
    if (i >= r.axes.columns - 1)
        return 1.0;
    if (r.axes.facing == 0.0)
        return sinh_of(i * r.span / (r.axes.columns - 1)) / r.k;
    float z = sinh_of(i * r.span / (r.axes.columns - 2)) / r.k;
    return z / sqrt(1.0 + z * z);
}

float column_law(Row r, float mu)
{
    if (r.axes.sine)
        return -sqrt(max(1.0 - mu * mu, 0.0));
    return r.axes.facing > 0.0 ? mu * (mu + 1.0 / r.k) : mu;
}

// Column number of a cosine: the cell's index plus how far into it the reading is.
float column_position(Row r, float mu)
{
    float t;
    if (r.axes.facing == 0.0)
        t = asinh_positive(r.k * mu) / r.span * (r.axes.columns - 1);
    else
        t = min(asinh_positive(r.k * mu / sqrt(max(1.0 - mu * mu, TABLE_EDGE))) / r.span, 1.0) * (r.axes.columns - 2);
    int i = min((int)t, r.axes.columns - 2);
    float low = column_law(r, column_cosine(r, i));
    float high = column_law(r, column_cosine(r, i + 1));
    return i + clamp((column_law(r, mu) - low) / (high - low), 0.0, 1.0);
}

#ifdef TABLE_FILE

// Blender 5.2 ignores every optional argument of texture() but alpha, and clamps to black: coordinates stay inside.
void texel(string file, float s, float t, output float a[TABLE_CHANNELS])
{
    float alpha = 0.0;
    color rgb = texture(file, s, t, "alpha", alpha, "wrap", "clamp", "interp", "linear");
    a[0] = rgb[0];
    a[1] = rgb[1];
    a[2] = rgb[2];
    a[3] = alpha;
}

float row_place(Row r, float row)
{
    float t = (row + 0.5) / (r.axes.height + 2);
    return r.flipped ? 1.0 - t : t;
}

// The marker row at the top tells a valid table from a missing, stale or foreign image, and which way up it is read.
// Halfway to the first row there must be half of both, or the image has other rows than it should; and what the hit is
// to read must be albedos.
void table_check(string file, output Row r)
{
    float height = r.axes.height + 2;
    float marker[TABLE_CHANNELS];
    texel(file, 0.5, 0.5 / height, marker);
    r.valid = r.valid && abs(marker[0] - TABLE_MARK) < TABLE_MARK_OFF && abs(marker[1] - r.axes.stamp) < TABLE_STAMP_OFF
           && abs(marker[3] - TABLE_FORMAT) < TABLE_MARK_OFF;
    r.flipped = marker[2] > 0.5;
    float first[TABLE_CHANNELS];
    float between[TABLE_CHANNELS];
    float used[TABLE_CHANNELS];
    texel(file, 0.5, row_place(r, 1.0), first);
    texel(file, 0.5, row_place(r, 0.5), between);
    texel(file, 0.5, row_place(r, r.row + r.blend + 1.0), used);
    r.valid = r.valid && abs(between[0] - 0.5 * (first[0] + TABLE_MARK)) < TABLE_HALF_OFF;
    for (int i = 0; i < TABLE_CHANNELS; i += 1)
        r.valid = r.valid && !isnan(used[i]) && used[i] > 0.0 && used[i] < TABLE_MOST;
}

void table_read(string file, Row r, float mu, int channels, output float a[TABLE_CHANNELS])
{
    texel(file, (column_position(r, mu) + 0.5) / r.axes.columns, row_place(r, r.row + r.blend + 1.0), a);
}

#else

void table_check(float table[], output Row r) { }

void table_read(float table[], Row r, float mu, int channels, output float a[TABLE_CHANNELS])
{
    float x = column_position(r, mu);
    int i = min((int)x, r.axes.columns - 2);
    float across = x - i;
    int at = TABLE_CHANNELS * (r.row * r.axes.columns + i);
    int below = at + TABLE_CHANNELS * r.axes.columns;
    for (int c = 0; c < channels; c += 1) {
        float top = mix(table[at + c], table[at + TABLE_CHANNELS + c], across);
        float bottom = mix(table[below + c], table[below + TABLE_CHANNELS + c], across);
        a[c] = mix(top, bottom, r.blend);
    }
}

#endif
