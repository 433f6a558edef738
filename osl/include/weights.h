// Rendering by rows of baked weights: the base closures of a row, and splats in its cells. See rows.h.

#include "beckmann.h"

#define KERNEL_WIDTH 1.2         // width of a splat's facet, of its cell's size
#define OVER_HORIZON 0.25 // most width of a splat, of its light's height: little of it may reach below
#define POINTED 1.25      // about the middle of rings cells end in a point: within this many of their lengths
#define POINTED_SLOPE 0.25   // splats are wide across, less and less
#define LARGE_RESIDUAL 0.05    // of the light: where all samples per hit are drawn
#define SMALL_RESIDUAL 0.02  // of the light: with less, splats are drawn at fewer hits, and are heavier,
#define LEAST_CHANCE 0.05 // but not at fewer than this
#define UNSEEN 1e-5       // weight of what is left out
#define LEAST_UP 0.1      // cosine of a half vector, that is divided by

color row_color(float w[], int at)
{
    return W_CHANNELS == 3 ? color(w[at], w[at + 1], w[at + 2]) : color(w[at]);
}

closure color row_facet(Frame f, vector slopes, float alpha_x, float alpha_y, vector along, color weight)
{
    vector facet = normalize(slopes);
    vector across = normalize(cross(facet, along));
    return weight * microfacet("beckmann", normalize(to_world(f, facet)), normalize(to_world(f, cross(across, facet))),
                               alpha_x, alpha_y, 0.0, 0);
}

closure color row_base(Frame f, float w[], int row)
{
    closure color sum = 0;
    for (int i = 0; i < W_FACETS; i += 1) {
        int at = row + 1 + W_FACET * i;
        color weight = color(w[at + 4], w[at + 5], w[at + 6]);
        if (max(weight[0], max(weight[1], weight[2])) > UNSEEN) {
            vector x = vector(1.0, 0.0, 0.0);
            sum = row_facet(f, vector(w[at], w[at + 1], 1.0), w[at + 2], w[at + 3], x, weight) + sum;
            if (W_AZIMUTHS == 1 && w[at + 1] != 0.0)  // a pair, on either side of the plane of incidence
                sum = row_facet(f, vector(w[at], -w[at + 1], 1.0), w[at + 2], w[at + 3], x, weight) + sum;
        }
    }
    color flat = color(w[row + W_BASE], w[row + W_BASE + 1], w[row + W_BASE + 2]);
    if (max(flat[0], max(flat[1], flat[2])) > UNSEEN)
        sum = flat * diffuse(f.z) + sum;
    return sum;
}

closure color row_spike(Frame f, float w[], int set, float place)
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
    return step - vector(0.0, 0.0, dot(step, h) / max(h[2], LEAST_UP));
}

// A cell of a row, and the place in it where a splat is put.
struct Cell {
    int at;         // of its energy in the row
    float s;        // size of the ring through the place,
    float low;      // of the cell's edges,
    float high;
    float around;   // and the angle that the cell spans
    vector out;     // half vectors move so, along the plane, with s, and with the angle
    vector turned;
    vector h;       // half vector of the place
    vector light;
};

// The cell that the numbers u, v in 0..1 choose, at the place in it that their rests do.
Cell draw_cell(Frame f, float w[], int set, int row, float u, float v)
{
    Cell c;
    // Of round formulas cells are on both sides of the plane of incidence.
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
    c.at = row + W_ENERGY + W_CHANNELS * (W_AROUND * i + j);
    // The place: even in area, and in the angle.
    int edge = row + W_TURNS + (W_AROUND + 1) * i + j;
    c.low = w[row + W_CELLS + i];
    c.high = w[row + W_CELLS + i + 1];
    c.s = sqrt(mix(c.low * c.low, c.high * c.high, ring - i));
    float phi = side * mix(w[edge], w[edge + 1], turn - j);
    c.around = w[edge + 1] - w[edge];
    // Rings are ellipses.
    c.out = vector(cos(phi) * w[set], sin(phi) * w[set + 1], 0.0);
    c.turned = vector(-sin(phi) * w[set], cos(phi) * w[set + 1], 0.0);
    c.h = vector(c.s * c.out[0], c.s * c.out[1], sqrt(max(1.0 - c.s * c.s * dot(c.out, c.out), 0.0)));
    c.light = 2.0 * dot(f.view, c.h) * c.h - f.view;
    return c;
}

// A facet of a weight about a cell's place, whose light is above the horizon by the sine `height`.
closure color row_kernel(Frame f, Cell c, float height, float spread, color weight)
{
    // Lights move twice as fast as half vectors: little of a splat may reach below the horizon.
    float most = max(OVER_HORIZON * height, NARROWEST_FACET);
    // The ellipse that two sides of the cell span, of half vectors. About the middle of rings cells end in a point:
    // splats that are narrow across and reach over it would all pile up there, by as much as they are longer.
    float length = c.high - c.low;
    float across = max(c.s * c.around, length * clamp(POINTED - POINTED_SLOPE * c.s / length, 0.0, 1.0));
    vector a = spread * KERNEL_WIDTH * length * on_sphere(c.h, c.out);
    vector b = spread * KERNEL_WIDTH * across * on_sphere(c.h, c.turned);
    Ellipse e = ellipse_of(c.h, a, b);
    float angle = 0.5 * atan2(2.0 * e.xy, e.xx - e.yy);
    return row_facet(f, c.h, clamp(sqrt(e.mean + e.apart), NARROWEST_FACET, most),
                         clamp(sqrt(max(e.mean - e.apart, 0.0)), NARROWEST_FACET, most),
                         cos(angle) * e.e1 + sin(angle) * e.e2, weight);
}

// Splats in cells of the row that begins at `row`, put before the `spike`.
closure color row_kernels(Frame f, float w[], int set, int row, Draws draws, vector up, closure color spike)
{
    closure color sum = spike;
    color share = 1.0 / (draws.count * draws.chance);
    for (int k = 0; k < draws.count; k += 1) {
        Cell c = draw_cell(f, w, set, row, lattice_u(draws.numbers, k, draws.count), lattice_v(draws.numbers, k));
        float height = min(c.light[2], dot(c.light, up));
        if (height > 0.0) {
            AT_KERNEL(c.light, vector(1.0), draws.count)
            sum = row_kernel(f, c, height, draws.spread, share * row_color(w, c.at)) + sum;
        }
    }
    return sum;
}

closure color estimate_rows(Frame f, float w[], int set, Draws requested, vector up)
{
    float place = view_place(f.view[2]);
    int row = choose_row(set, f.view, place, requested.numbers[2]);
    closure color sum = row_spike(f, w, set, place);
    // At few hits where little is left. The number that decides is uniform again below what it is held against.
    float residual = w[row];
    Draws draws = requested;
    draws.count = clamp((int)ceil(requested.count * residual / LARGE_RESIDUAL), 1, requested.count);
    draws.chance = clamp(residual / SMALL_RESIDUAL, LEAST_CHANCE, 1.0);
    draws.numbers = vector(requested.numbers[0], requested.numbers[1] / draws.chance, 0.0);
    if (KERNELS && residual > UNSEEN && requested.numbers[1] < draws.chance)
        sum = row_kernels(f, w, set, row, draws, up, sum);
    return row_base(f, w, row) + sum;
}
