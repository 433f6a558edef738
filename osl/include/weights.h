// Rendering by rows of baked weights: see addon/baking/weights.py, which lays them out.
//
// A row is what a view sees: base closures, and cells of half vectors that hold what those leave over.

#define W_FACET 7
#define W_BASE (1 + W_FACET * W_FACETS)  // first the share that is left over, then microfacets, then
#define W_CELLS (W_BASE + 3)             // the diffuse closure's colour, edges of rings, edges of cells, energies
#define W_TURNS (W_CELLS + W_RINGS + 1)
#define W_ENERGY (W_TURNS + W_RINGS * (W_AROUND + 1))
#define W_ROW (W_ENERGY + W_RINGS * W_AROUND * W_CHANNELS)
#define W_SPIKE (W_VIEWS * W_ROW)  // after all rows, the colour of a perfect mirror, at W_SPIKES angles from row to row

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

// One of the two rows beside a place, by the number `chance`.
int weights_row(float place, float chance)
{
    int row = min((int)place, W_VIEWS - 2);
    return W_ROW * (chance < place - row ? row + 1 : row);
}

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
            if (w[at + 1] != 0.0)
                sum = weights_facet(f, vector(w[at], -w[at + 1], 1.0), w[at + 2], w[at + 3], x, weight) + sum;
        }
    }
    color flat = color(w[row + W_BASE], w[row + W_BASE + 1], w[row + W_BASE + 2]);
    if (max(flat[0], max(flat[1], flat[2])) > 1e-5)
        sum = flat * diffuse(f.z) + sum;
    return sum;
}

closure color weights_spike(Frame f, float w[], float place)
{
    closure color spike = 0;
    if (W_SPIKES > 0) {
        float along = W_SPIKES * place;
        int i = min((int)along, W_SPIKES * (W_VIEWS - 1) - 1);
        int at = W_SPIKE + 3 * i;
        spike = mix(color(w[at], w[at + 1], w[at + 2]), color(w[at + 3], w[at + 4], w[at + 5]), along - i)
              * reflection(f.z);
    }
    return spike;
}

// One splat, in the cell that the numbers u, v in 0..1 choose, at the place in it that their rests do.
closure color weights_splat(Frame f, float w[], int row, float u, float v, color share, float spread, vector up)
{
    float side = v < 0.5 ? 1.0 : -1.0;
    float ring = W_RINGS * u;
    float turn = W_AROUND * mod(2.0 * v, 1.0);
    int i = min((int)ring, W_RINGS - 1);
    int j = min((int)turn, W_AROUND - 1);
    int edge = row + W_TURNS + (W_AROUND + 1) * i + j;
    float low = w[row + W_CELLS + i];
    float high = w[row + W_CELLS + i + 1];
    float s = sqrt(mix(low * low, high * high, ring - i));
    float phi = side * mix(w[edge], w[edge + 1], turn - j);
    vector h = vector(s * cos(phi), s * sin(phi), sqrt(max(1.0 - s * s, 0.0)));
    vector light = 2.0 * dot(f.view, h) * h - f.view;
    float height = min(light[2], dot(light, up));
    closure color splat = 0;
    if (height > 0.0) {
        color weight = share * weights_colour(w, row + W_ENERGY + W_CHANNELS * (W_AROUND * i + j));
        // Lights move twice as fast as half vectors: little of a splat may reach below the horizon.
        float most = max(0.25 * height, NARROWEST);
        float radial = clamp(spread * SPLAT * (high - low) / max(h[2], 0.1), NARROWEST, most);
        float round = clamp(spread * SPLAT * s * (w[edge + 1] - w[edge]), NARROWEST, most);
        vector outward = vector(cos(phi) * h[2], sin(phi) * h[2], -s);
        splat = weights_facet(f, h, radial, round, outward, weight);
    }
    return splat;
}

closure color weights_estimate(Frame f, float w[], vector numbers, int samples, float spread, vector up)
{
    float place = weights_place(f.view[2]);
    int row = weights_row(place, numbers[2]);
    float left = w[row];
    int count = clamp((int)ceil(samples * left / MUCH_LEFT), 1, samples);
    float chance = clamp(left / LITTLE_LEFT, 0.05, 1.0);
    closure color sum = weights_spike(f, w, place);
    if (left > 1e-5 && numbers[1] < chance) {
        vector drawn = vector(numbers[0], numbers[1] / chance, 0.0);
        color share = 1.0 / (count * chance);
        for (int k = 0; k < count; k += 1)
            sum = weights_splat(f, w, row, lattice_u(drawn, k, count), lattice_v(drawn, k), share, spread, up) + sum;
    }
    return weights_base(f, w, row) + sum;
}
