// Rendering by rows of baked weights: see addon/baking/weights.py, which lays them out.
//
// A row is what a view sees: base closures, and cells of half vectors that hold what those leave over. A set is rows for
// all views, after a head: the stretch of its rings along x and y, and about how bright it is. There is one set, or one
// for each combination of steps of driven parameters.

#define W_FACET 7
#define W_BASE (1 + W_FACET * W_FACETS)  // first the share that is left over, then microfacets, then
#define W_CELLS (W_BASE + 3)             // the diffuse closure's colour, edges of rings, edges of cells, energies
#define W_TURNS (W_CELLS + W_RINGS + 1)
#define W_ENERGY (W_TURNS + W_RINGS * (W_AROUND + 1))
#define W_ROW (W_ENERGY + W_RINGS * W_AROUND * W_CHANNELS)
#define W_HEAD 3
#define W_SPIKE (W_HEAD + W_AZIMUTHS * W_VIEWS * W_ROW)  // after all rows, the colour of a perfect mirror, at W_SPIKES angles from row to row
#define W_SET (W_SPIKE + (W_SPIKES > 0 ? 3 * (W_SPIKES * (W_VIEWS - 1) + 1) : 0))

#define NARROWEST 5e-4    // slope: Cycles takes narrower facets for mirrors
#define SPLAT 1.2         // width of a splat's facet, of its cell's size
#define MUCH_LEFT 0.05    // of the light: where all samples per hit are drawn
#define LITTLE_LEFT 0.02  // of the light: with less, splats are drawn at fewer hits, and are heavier

// Where a view is among the rows, 0 to W_VIEWS - 1.
float weights_place(float mu)
{
    float along = clamp(acos(clamp(mu, 0.0, 1.0)) / W_STEEPEST, 0.0, 1.0);
    return (W_VIEWS - 1) * (1.0 - pow(1.0 - along, 1.0 / W_CROWDED));
}

// One of the two whole numbers beside a place, up to `last`, by the number `chance`, which is stretched for another use.
int beside(float place, int last, output float chance)
{
    int low = clamp((int)place, 0, last - 1);
    float rest = clamp(place - low, 0.0, 1.0);
    int up = chance < rest;
    chance = up ? chance / rest : (chance - rest) / max(1.0 - rest, 1e-6);
    return low + up;
}

#if W_RANGES
// Where a driven parameter is among its steps, 0 to steps - 1, in each channel.
color range_place(color value, float least, float most, int steps, int geometric)
{
    color at = clamp(value, color(least), color(most));
    color along = geometric ? log(at / least) / log(most / least) : (at - least) / (most - least);
    return (steps - 1) * along;
}

// The share, in each channel, that a set has in what is between sets: sets of the last parameter's steps are neighbours.
color weights_share(int set, color places[W_RANGES], int steps[W_RANGES])
{
    color share = 1.0;
    int rest = set;
    for (int i = W_RANGES - 1; i >= 0; i -= 1) {
        int step = rest % steps[i];
        rest = rest / steps[i];
        share *= max(color(1.0) - abs(places[i] - color(step)), color(0.0));
    }
    return share;
}

// Where the set begins that a hit takes, by `chance`, which is stretched for another use, and what it weighs in each
// channel. Sets are taken as often as they are bright; `slots` tells where each is, -1 of those that are black.
int weights_set(float w[], color places[W_RANGES], int steps[W_RANGES], int slots[W_SETS], output float chance,
                output color weight)
{
    float likely[W_SETS];
    float all = 0.0;
    for (int i = 0; i < W_SETS; i += 1) {
        color share = weights_share(i, places, steps);
        likely[i] = slots[i] < 0 ? 0.0 : (share[0] + share[1] + share[2]) * w[W_SET * slots[i] + W_HEAD - 1];
        all += likely[i];
    }
    float left = chance * all;
    int set = 0;
    while (set < W_SETS - 1 && left >= likely[set]) {
        left -= likely[set];
        set += 1;
    }
    weight = 0.0;
    if (likely[set] > 0.0) {
        weight = weights_share(set, places, steps) * (all / likely[set]);
        chance = min(left / likely[set], 0.999999);
    }
    return W_SET * max(slots[set], 0);
}
#endif

// Where the row begins that a view is given, in the set that begins at `set`.
int weights_row(int set, vector view, float place, float number)
{
    float chance = number;
    int row = beside(place, W_VIEWS - 1, chance);
#if W_WHOLE
    row += W_VIEWS * (int)mod(beside(W_AZIMUTHS * mod(atan2(view[1], view[0]) / M_2PI, 1.0), W_AZIMUTHS, chance), W_AZIMUTHS);
#elif W_AZIMUTHS > 1
    row += W_VIEWS * beside((W_AZIMUTHS - 1) * atan2(view[1], view[0]) / M_PI_2, W_AZIMUTHS - 1, chance);
#endif
    return set + W_HEAD + W_ROW * row;
}

#if W_AZIMUTHS > 1 && !W_WHOLE
// A frame turned so that the view is on the positive side of both axes, as rows of views are: what is stretched along
// axes is the same on either side of them.
Frame first_quadrant(Frame given)
{
    Frame f = given;
    if (f.view[0] < 0.0)
        f.x = -f.x;
    if (f.view[1] < 0.0)
        f.y = -f.y;
    f.view = vector(abs(f.view[0]), abs(f.view[1]), f.view[2]);
    return f;
}
#endif

color weights_colour(float w[], int at)
{
    return W_CHANNELS == 3 ? color(w[at], w[at + 1], w[at + 2]) : color(w[at]);
}

closure color weights_facet(Frame f, vector slopes, float alpha_x, float alpha_y, vector along, color weight)
{
    vector facet = normalize(slopes);
    vector across = normalize(cross(facet, along));
    return weight * microfacet("beckmann", normalize(to_world(f, facet)), normalize(to_world(f, cross(across, facet))),
                               alpha_x, alpha_y, 0.0, 0);
}

closure color weights_base(Frame f, float w[], int row)
{
    closure color sum = 0;
    for (int i = 0; i < W_FACETS; i += 1) {
        int at = row + 1 + W_FACET * i;
        color weight = color(w[at + 4], w[at + 5], w[at + 6]);
        if (max(weight[0], max(weight[1], weight[2])) > 1e-5) {
            vector x = vector(1.0, 0.0, 0.0);
            sum = weights_facet(f, vector(w[at], w[at + 1], 1.0), w[at + 2], w[at + 3], x, weight) + sum;
            if (W_AZIMUTHS == 1 && w[at + 1] != 0.0)  // a pair, on either side of the plane of incidence
                sum = weights_facet(f, vector(w[at], -w[at + 1], 1.0), w[at + 2], w[at + 3], x, weight) + sum;
        }
    }
    color flat = color(w[row + W_BASE], w[row + W_BASE + 1], w[row + W_BASE + 2]);
    if (max(flat[0], max(flat[1], flat[2])) > 1e-5)
        sum = flat * diffuse(f.z) + sum;
    return sum;
}

closure color weights_spike(Frame f, float w[], int set, float place)
{
    closure color spike = 0;
    if (W_SPIKES > 0) {
        float along = W_SPIKES * place;
        int i = min((int)along, W_SPIKES * (W_VIEWS - 1) - 1);
        int at = set + W_SPIKE + 3 * i;
        spike = mix(color(w[at], w[at + 1], w[at + 2]), color(w[at + 3], w[at + 4], w[at + 5]), along - i)
              * reflection(f.z);
    }
    return spike;
}

// A step across the normal, as one on the sphere of half vectors.
vector on_sphere(vector h, vector step)
{
    return step - vector(0.0, 0.0, dot(step, h) / max(h[2], 0.1));
}

// One splat, in the cell that the numbers u, v in 0..1 choose, at the place in it that their rests do.
closure color weights_splat(Frame f, float w[], int set, int row, float u, float v, color share, float spread, vector up)
{
    float ring = W_RINGS * u;
#if W_AZIMUTHS > 1
    float side = 1.0;
    float turn = W_AROUND * v;
#else
    float side = v < 0.5 ? 1.0 : -1.0;
    float turn = W_AROUND * mod(2.0 * v, 1.0);
#endif
    int i = min((int)ring, W_RINGS - 1);
    int j = min((int)turn, W_AROUND - 1);
    int edge = row + W_TURNS + (W_AROUND + 1) * i + j;
    float low = w[row + W_CELLS + i];
    float high = w[row + W_CELLS + i + 1];
    float s = sqrt(mix(low * low, high * high, ring - i));
    float phi = side * mix(w[edge], w[edge + 1], turn - j);
    vector out = vector(cos(phi) * w[set], sin(phi) * w[set + 1], 0.0);
    vector turned = vector(-sin(phi) * w[set], cos(phi) * w[set + 1], 0.0);
    vector h = vector(s * out[0], s * out[1], sqrt(max(1.0 - s * s * dot(out, out), 0.0)));
    vector light = 2.0 * dot(f.view, h) * h - f.view;
    float height = min(light[2], dot(light, up));
    closure color splat = 0;
    if (height > 0.0) {
        color weight = share * weights_colour(w, row + W_ENERGY + W_CHANNELS * (W_AROUND * i + j));
        // Lights move twice as fast as half vectors: little of a splat may reach below the horizon.
        float most = max(0.25 * height, NARROWEST);
        // The ellipse that two sides of the cell span, of half vectors. About the middle of rings cells end in a point:
        // splats that are narrow across and reach over it would all pile up there, by as much as they are longer.
        float across = max(s * (w[edge + 1] - w[edge]), (high - low) * clamp(1.25 - 0.25 * s / (high - low), 0.0, 1.0));
        vector a = spread * SPLAT * (high - low) * on_sphere(h, out);
        vector b = spread * SPLAT * across * on_sphere(h, turned);
        vector e1 = normalize(dot(a, a) > dot(b, b) ? a : b);
        vector e2 = cross(h, e1);
        float xx = dot(a, e1) * dot(a, e1) + dot(b, e1) * dot(b, e1);
        float xy = dot(a, e1) * dot(a, e2) + dot(b, e1) * dot(b, e2);
        float yy = dot(a, e2) * dot(a, e2) + dot(b, e2) * dot(b, e2);
        float mean = 0.5 * (xx + yy);
        float apart = hypot(0.5 * (xx - yy), xy);
        float angle = 0.5 * atan2(2.0 * xy, xx - yy);
        splat = weights_facet(f, h, clamp(sqrt(mean + apart), NARROWEST, most),
                              clamp(sqrt(max(mean - apart, 0.0)), NARROWEST, most),
                              cos(angle) * e1 + sin(angle) * e2, weight);
    }
    return splat;
}

closure color weights_estimate(Frame f, float w[], int set, vector numbers, int samples, float spread, vector up)
{
    float place = weights_place(f.view[2]);
    int row = weights_row(set, f.view, place, numbers[2]);
    float left = w[row];
    int count = clamp((int)ceil(samples * left / MUCH_LEFT), 1, samples);
    float chance = clamp(left / LITTLE_LEFT, 0.05, 1.0);
    closure color sum = weights_spike(f, w, set, place);
    if (left > 1e-5 && numbers[1] < chance) {
        vector drawn = vector(numbers[0], numbers[1] / chance, 0.0);
        color share = 1.0 / (count * chance);
        for (int k = 0; k < count; k += 1)
            sum = weights_splat(f, w, set, row, lattice_u(drawn, k, count), lattice_v(drawn, k), share, spread, up) + sum;
    }
    return weights_base(f, w, row) + sum;
}
