// Reading an albedo table; addon/forms/albedo/axes.py explains the axes, addon/forms/albedo/tables.py the image.
//
// There are two ways to read a table, with the same result: from an array of numbers compiled into the shader (TABLE is
// a float array), or, where TABLE_FILE is defined, from the image file through texture() (TABLE is its name). Both
// interpolate between the same texels with the same weights.

#ifdef TABLE_FILE
#define TABLE(name) string name
#else
#define TABLE(name) float name[]
#endif

#define TABLE_EDGE 1e-14      // smallest divisor for the squared sine at the normal
// Largest errors of what texture() reads, in half precision.
#define TABLE_MARK_OFF 1e-3   // error of a mark
#define TABLE_STAMP_OFF 5e-6  // error of the stamp
#define TABLE_HALF_OFF 2e-3   // error of the middle between the mark and the first row
#define TABLE_MOST 2.0        // larger than any albedo

struct Axes {
    int columns;
    float grazing;
    float facing;
    int rows;
    float density;
    float law;
    float stamp;
    int sine;       // 1 where a reading is linear in the sine of the angle
    int height;     // rows of the image, without its markers
    float lowest;   // exponent of the first row
    float highest;  // exponent of the last row
};

// A hit's row of a table, as a hit has one exponent, and the scales of the columns there.
struct Row {
    Axes axes;
    int row;      // the row before the exponent
    float blend;  // the way from there to the next row, 0..1
    float k;
    float span;
    int flipped;  // 1 where texture() counts rows from the bottom
    int valid;    // whether the table can be used
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
    // A table cannot be read beyond its ends, but for the part TABLE_SLACK of them.
    r.valid = exponent >= axes.lowest * (1.0 - TABLE_SLACK) && exponent <= axes.highest * (1.0 + TABLE_SLACK);
    return r;
}

// The cosine of a column.
float column_cosine(Row r, int i)
{
    if (i >= r.axes.columns - 1)
        return 1.0;
    if (r.axes.facing == 0.0)
        return sinh_of(i * r.span / (r.axes.columns - 1)) / r.k;
    float z = sinh_of(i * r.span / (r.axes.columns - 2)) / r.k;
    return z / sqrt(1.0 + z * z);
}

// The function of the cosine in which a reading between two columns is linear.
float column_law(Row r, float mu)
{
    if (r.axes.sine)
        return -sqrt(max(1.0 - mu * mu, 0.0));
    return r.axes.facing > 0.0 ? mu * (mu + 1.0 / r.k) : mu;
}

// Column number of a cosine: the cell's index plus the position in the cell, 0..1.
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

// The image's coordinate of a row, which may lie between two.
float row_place(Row r, float row)
{
    float t = (row + 0.5) / (r.axes.height + 2);
    return r.flipped ? 1.0 - t : t;
}

// Checks a table. The marker row at the top tells a valid table from a missing, stale or foreign image, and which way
// up texture() reads it. Halfway to the first row texture() must read the mean of both, or the image has a wrong number
// of rows. The numbers of the hit's row must be albedos.
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
