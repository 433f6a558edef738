// Base lobes: Cycles' own closures that together are nearly the target. addon/forms/base_lobes fits them; the BASE_
// macros and the base_ arrays come from its file, base_lobes.json.
//
// Most base lobes are phong_ramp, whose colors make it any function of (R.L)^e. The colors are equidistant levels.
// Cycles interpolates between them, and allows negative ones.

#include "beckmann.h"

// The arrays of the fit, which no struct can hold: as parameters of a function, as its arguments, and as the shader's
// own arrays.
#define BASE_PARAMETERS float widths[], float ramps[], float facets[], vector table[]
#define BASE_ARGUMENTS widths, ramps, facets, table
#define BASE_DATA base_widths, base_ramps, base_facets, base_table

#define LEVEL_VECTORS 3    // vectors of the table that hold the SLOTS of a ramp
#define RAMP_NUMBERS 5     // numbers of a ramp in its array: lean, sharpness, side, level of the crease, set of levels
#define FACET_NUMBERS 2    // numbers of a facet in its array: lean, sharpness
#define FAINT 1e-4         // closures with less than this part of the mirror direction's gain are skipped
#define LARGEST_GAIN 1e9   // larger than any gain
#define LEAST_GAIN 1e-6    // the table is not read for smaller gains
#define LEAST_VIEW 1e-6    // smallest divisor for a view's cosine
#define LEAST_MIRROR 1e-9  // smallest divisor for the mirror direction's gain

struct Base {
    float residual;                  // size of the residual, in parts of the target's energy
    // The ramps, closures phong_ramp.
    int sets[BASE_RAMPS];            // set of levels of a ramp; -1: the ramp is skipped
    vector axis[BASE_RAMPS];         // mirror direction of the ramp's normal
    vector facet[BASE_RAMPS];        // the ramp's normal
    float exponent[BASE_RAMPS];
    // The sets of levels.
    float level[BASE_LEVELS];        // SLOTS of each set
    float mean[BASE_SETS];           // mean of the ramp
    float size[BASE_SETS];           // mean of the ramp's absolute value
    // The Beckmann microfacets.
    float weight[BASE_FACET_ROOM];
    vector tilted[BASE_FACET_ROOM];  // their normals
    float alpha2[BASE_FACET_ROOM];   // their squared widths
};

// Reads the gains on the mirror direction's side of the lobe where N.L is the larger cosine. The part of the gain that
// grows with N.L is exactly Cycles' own phong_ramp times `plain`; it is subtracted from the gains. Returns the mirror
// direction's gain.
float read_gains(Hit hit, float scale, float widths[], output float gains[BASE_FEATURES], output float plain,
                 CORRECTION_PARAMETERS)
{
    float cosines[BASE_FEATURES];
    float least = LARGEST_GAIN;
    for (int q = 0; q < BASE_FEATURES; q += 1) {
        cosines[q] = q > 0 ? cos(max(hit.theta - widths[q] * scale, 0.0)) : hit.frame.view[2];
        gains[q] = 1.0 / correction(cosines[q], CORRECTION);
        least = min(least, gains[q]);
    }
    float mirror = gains[0] * cosines[0];
    plain = BASE_PLAIN ? least : 0.0;
    for (int q = 0; q < BASE_FEATURES; q += 1)
        gains[q] = (gains[q] - plain) * cosines[q];
    return mirror;
}

// Interpolates the table's nodes around this hit: sums of coefficients times gains. A cell is two triangles, and the
// interpolation is between the three nodes of the hit's triangle: as good as between four nodes, and faster.
void blend_nodes(Hit hit, float scale, float gains[BASE_FEATURES], vector table[], output vector sums[BASE_STRIDE])
{
    // The hit's position among the nodes: see `Family` in addon/forms/base_lobes/closures.py.
    float w = hit.frame.view[0] / max(hit.frame.view[2], LEAST_VIEW) * scale;
    float u = (BASE_U - 1) * (VIEW_SLOPE_SHARE * w / (1.0 + w) + hit.theta / M_PI);
    float v = (BASE_V - 1) * pow(hit.n, -BASE_POWER);
    int i = min((int)u, BASE_U - 2);
    int j = min((int)v, BASE_V - 2);
    u -= i;
    v -= j;
    // Corners of the triangle, along the larger of u and v first.
    int middle = u > v ? (i + 1) * BASE_V + j : i * BASE_V + j + 1;
    int begin = (i * BASE_V + j) * BASE_FEATURES;
    int end = begin + (BASE_V + 1) * BASE_FEATURES;
    for (int e = 0; e < BASE_STRIDE; e += 1)
        sums[e] = 0.0;
    for (int q = 0; q < BASE_FEATURES; q += 1) {
        if (gains[q] > LEAST_GAIN) {
            float a = gains[q] * (1.0 - max(u, v));
            float b = gains[q] * abs(u - v);
            float c = gains[q] * min(u, v);
            int at_a = (begin + q) * BASE_STRIDE;
            int at_b = (middle * BASE_FEATURES + q) * BASE_STRIDE;
            int at_c = (end + q) * BASE_STRIDE;
            for (int e = 0; e < BASE_STRIDE; e += 1)
                sums[e] += a * table[at_a + e] + b * table[at_b + e] + c * table[at_c + e];
        }
    }
}

// The levels of a set, from (R.L)^e = 0 to 1, their mean and size. `least` is added to each level.
void make_levels(output Base b, int set, float unit, vector sums[BASE_STRIDE], vector least)
{
    vector low = unit * sums[LEVEL_VECTORS * set] + least;
    vector middle = unit * sums[LEVEL_VECTORS * set + 1] + least;
    vector high = unit * sums[LEVEL_VECTORS * set + 2] + least;
    int at = SLOTS * set;
    b.level[at] = low[0];
    b.level[at + 1] = low[1];
    b.level[at + 2] = low[2];
    b.level[at + 3] = middle[0];
    b.level[at + 4] = middle[1];
    b.level[at + 5] = middle[2];
    b.level[at + 6] = high[0];
    b.level[at + 7] = high[1];
    // Mean and size, by trapezoids. The last slot is no level.
    vector one = vector(1.0);
    vector last = vector(high[0], high[1], 0.0);
    b.mean[set] = (dot(low + middle + last, one) - 0.5 * (low[0] + high[1])) / (LEVELS - 1);
    b.size[set] = dot(abs(low) + abs(middle) + abs(last), one) / (LEVELS - 1);
}

// Puts a ramp's crease, the circle where its colors have a kink, through the mirror direction. Returns the axis' lean.
float lay_crease(output Base b, int i, Hit hit, float scale, float ramps[])
{
    int at = RAMP_NUMBERS * i;
    int set = b.sets[i];
    float lean = max(min(ramps[at] * scale, hit.theta), CREASE_LEAN * scale);
    float rise = log((LEVELS - 1) / ramps[at + 3]);
    b.exponent[i] = rise / max(-log(max(cos(lean), CREASE_COSINE)), rise / SHARPEST);
    // The exponent is large where the circle is small: scaled colors have the same effect.
    float lower = (hit.m + 2.0) / (b.exponent[i] + 2.0);
    for (int k = 0; k < LEVELS; k += 1)
        b.level[SLOTS * set + k] *= lower;
    b.mean[set] *= lower;
    b.size[set] *= lower;
    return lean;
}

// A ramp's exponent and axis. Its levels exist already.
void make_ramp(output Base b, int i, Hit hit, float scale, float ramps[])
{
    int at = RAMP_NUMBERS * i;
    float height = M_PI_2 - hit.theta;
    // The lean is limited near the horizons: Cycles bends closures that mirror into the surface.
    float lean = clamp(ramps[at] * scale, -LEAN_DOWN * max(height - LEAN_MARGIN, 0.0), M_PI - height - LEAN_UP);
    b.exponent[i] = hit.m * ramps[at + 1];
    if (ramps[at + 3] > 0.0)
        lean = lay_crease(b, i, hit, scale, ramps);
    // One of a pair is turned out of the plane of incidence.
    b.axis[i] = vector(sin(lean - hit.theta), 0.0, cos(lean - hit.theta));
    if (ramps[at + 2] != 0.0) {
        float side = ramps[at + 2] * scale;
        b.axis[i] = cos(side) * b.axis[i] + vector(0.0, sin(side), 0.0);
    }
    b.facet[i] = normalize(b.axis[i] + hit.frame.view);
}

void make_base(output Base b, Hit hit, CORRECTION_PARAMETERS, BASE_PARAMETERS)
{
    float scale = 1.0 / sqrt(hit.m);
    float mean = hit.frame.view[2] + BASE_GRAZING * scale;
    // The fit's numbers for this hit's gains.
    float gains[BASE_FEATURES];
    float plain;
    float mirror = read_gains(hit, scale, widths, gains, plain, CORRECTION);
    vector sums[BASE_STRIDE];
    blend_nodes(hit, scale, gains, table, sums);
    b.residual = max(sums[2][2], 0.0) / max(mirror, LEAST_MIRROR);
    // The sets of levels come before the ramps: two ramps may share a set.
    int faint[BASE_SETS];
    float unit = 1.0 / mean;
    for (int i = 0; i < BASE_SETS; i += 1) {
        make_levels(b, i, unit, sums, i == 0 ? vector(plain) : vector(0.0));
        faint[i] = b.size[i] * mean < FAINT * mirror;
    }
    for (int i = 0; i < BASE_RAMPS; i += 1) {
        int s = (int)ramps[RAMP_NUMBERS * i + 4];
        b.sets[i] = faint[s] ? -1 : s;
        if (!faint[s])
            make_ramp(b, i, hit, scale, ramps);
    }
    // Microfacets.
    for (int i = 0; i < BASE_FACETS; i += 1) {
        int e = i / 3;
        float weight = sums[LEVEL_VECTORS * BASE_SETS + e][i - 3 * e] * mean;
        b.weight[i] = weight < FAINT * mirror ? 0.0 : weight;
        float lean = min(facets[FACET_NUMBERS * i] * scale, LEANEST / scale);
        b.tilted[i] = vector(sin(lean), 0.0, cos(lean));
        b.alpha2[i] = min(0.5 / (hit.m * facets[FACET_NUMBERS * i + 1]), 1.0);
    }
}
