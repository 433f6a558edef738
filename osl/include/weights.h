// The closures of lobe rows: a row's base, and kernels in the cells of its residual. See rows.h.

#include "beckmann.h"

#define KERNEL_WIDTH 1.2     // width of a kernel's facet, in parts of its cell's size
#define OVER_HORIZON 0.25    // largest width of a kernel, in parts of the sine of its light's height
// Cells in the middle of the rings end in a point. At the distance s from the middle a kernel is at least
// POINTED - POINTED_SLOPE s / length times as wide as it is long, clamped to 0..1.
#define POINTED 1.25
#define POINTED_SLOPE 0.25
#define LARGE_RESIDUAL 0.05  // albedo of the residual from which on a hit takes all samples
#define SMALL_RESIDUAL 0.02  // albedo of the residual below which fewer hits have kernels, and these are heavier
#define LEAST_CHANCE 0.05    // least share of hits that have kernels
#define UNSEEN 1e-5          // closures with a smaller weight are skipped
#define LEAST_UP 0.1         // smallest divisor for a half vector's cosine

// The color at an offset: one number, or three.
color row_color(float w[], int at)
{
    return W_CHANNELS == 3 ? color(w[at], w[at + 1], w[at + 2]) : color(w[at]);
}

// A Beckmann closure whose normal leans by `slopes`, of widths along and across the tangent `along`.
closure color row_facet(Frame f, vector slopes, float alpha_x, float alpha_y, vector along, color weight)
{
    vector facet = normalize(slopes);
    vector across = normalize(cross(facet, along));
    return weight * microfacet("beckmann", normalize(to_world(f, facet)), normalize(to_world(f, cross(across, facet))),
                               alpha_x, alpha_y, 0.0, 0);
}

// The base of the row that begins at `row`.
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

// The perfect mirror of a set, between the two angles beside the position `place` of the view.
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

// The step on the sphere of half vectors for a `step` in the plane across the normal.
vector on_sphere(vector h, vector step)
{
    return step - vector(0.0, 0.0, dot(step, h) / max(h[2], LEAST_UP));
}

// A cell of a row, and the point in it about which a kernel lies.
struct Cell {
    int at;         // offset of the cell's energy
    float s;        // size of the ring through the point
    float low;      // size of the cell's inner edge
    float high;     // size of the cell's outer edge
    float around;   // angle that the cell spans
    vector out;     // derivative of the half vector by s, in the plane across the normal
    vector turned;  // the same by the angle, in parts of s
    vector h;       // half vector of the point
    vector light;   // its light direction
};

// The cell that the uniform numbers u, v choose, and the point in it that their fractions choose.
Cell draw_cell(Frame f, float w[], int set, int row, float u, float v)
{
    Cell c;
    // Round formulas have the same cells on both sides of the plane of incidence: v chooses the side.
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
    // The point: uniform in area, and in the angle.
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

// The kernel about a cell's point: a microfacet closure. `height` is the sine of the light's height above the horizon.
closure color row_kernel(Frame f, Cell c, float height, float spread, color weight)
{
    // Little of a kernel may reach below the horizon. Lights move twice as fast as half vectors.
    float most = max(OVER_HORIZON * height, NARROWEST_FACET);
    // The ellipse of half vectors that two sides of the cell span. Cells in the middle of the rings end in a point:
    // kernels that are narrow across and reach over that point would all overlap there.
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

// Kernels in cells of the row that begins at `row`, put before the `spike`.
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

// All closures of a hit: the base, kernels, and the spike, of the set that begins at `set`.
closure color estimate_rows(Frame f, float w[], int set, Draws requested, vector up)
{
    float place = view_place(f.view[2]);
    int row = choose_row(set, f.view, place, requested.numbers[2]);
    closure color sum = row_spike(f, w, set, place);
    // Few hits have kernels where the residual is small. The number that chooses is uniform below `chance`: it is
    // stretched for another use.
    float residual = w[row];
    Draws draws = requested;
    draws.count = clamp((int)ceil(requested.count * residual / LARGE_RESIDUAL), 1, requested.count);
    draws.chance = clamp(residual / SMALL_RESIDUAL, LEAST_CHANCE, 1.0);
    draws.numbers = vector(requested.numbers[0], requested.numbers[1] / draws.chance, 0.0);
    if (KERNELS && residual > UNSEEN && requested.numbers[1] < draws.chance)
        sum = row_kernels(f, w, set, row, draws, up, sum);
    return row_base(f, w, row) + sum;
}
