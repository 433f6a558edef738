// How a lump gets into Cycles: bells (see bells.h) for most of it, and small bells at random places, splats, for what
// those leave over. See estimator.h for the idea.
//
// A model includes disk.h and one target_*.h before this.

#include "bells.h"

#define STEEP_BENT 0.4    // where there is no use in many narrow bells
#define WIDEST 0.15       // of a lump's standard deviation: splats; WIDER for sharp lumps, which are nearly bells,
#define WIDER 0.35
#define WIDER_FROM 8.0    // from this exponent on, more and more
#define BLUR 0.0065       // and of steep lumps no more than this over what is left,
#define LEAST_BLUR 0.6    // or this of WIDEST
#define UNSHARP 0.1       // or, where their blur is not put back, this; and at most
#define TO_EDGE 0.4       // of the way to the lump's edge,
#define AT_EDGE 0.12      // or this of the standard deviation where the edge is soft,
#define STEEP_EDGE 0.6    // and of that this part of steep lumps
#define LARGE_RESIDUAL 0.1     // of the volume: where all samples per hit are drawn
#define SMALL_RESIDUAL 0.02  // of the volume: with less, splats are drawn at fewer hits, and are heavier,
#define LEAST_CHANCE 0.05 // but not at fewer than this
#define HEAVIEST 3.0      // weight of all splats of a lump
#define UNSEEN 1e-5       // weight of a splat that is left out
#define RESIDUAL_SHARE 0.8       // share of a steep lump's splats that is drawn where its bells leave something
#define DRAWN_RADIUS 1.45  // what splats are drawn from is a lump of this radius, 1.16 times as wide as a sharp lump:
#define DRAWN_SLOPE 1.23   // its exponent is n times this, and more by
#define DRAWN_MORE 1.28
#define WIDE_FACET 0.71    // least deviation of a lump, in widths of the narrowest facet
#define OVER_EDGE 3.0      // deviations at which a lump begins to leave the disk
#define LEAST_TOTAL 1e-3   // weight of all bells that is divided by

// Draws the square of a splat's distance from the middle of the unit disk by a number u; returns the density over the
// disk's area. Most of a steep lump's lie where the row says that its bells leave something, all others as a lump does.
float draw_distance(float n, float u, int steep, float row[], output float r2)
{
    float drawn_n = DRAWN_SLOPE * n + DRAWN_MORE;
    // Where the bells leave something, or anywhere.
    float area = M_PI * DRAWN_RADIUS * DRAWN_RADIUS;
    float residual_share = steep ? RESIDUAL_SHARE : 0.0;
    if (u < residual_share) {
        float at = BELL_KNOTS * u / residual_share;
        int i = min((int)at, BELL_KNOTS - 1);
        r2 = mix(row[STEEP_KNOTS + i], row[STEEP_KNOTS + i + 1], at - i);
    } else  // eq. 28
        r2 = DRAWN_RADIUS * DRAWN_RADIUS
           * rest_of_root(max((u - residual_share) / (1.0 - residual_share), LEAST_DRAWN), drawn_n + 1.0);
    // The density of both together.
    float density = (1.0 - residual_share) * (drawn_n + 1.0) / area * power_of_rest(M_PI * r2 / area, drawn_n);
    if (steep)
        for (int i = 0; i < BELL_KNOTS; i += 1) {
            float low = row[STEEP_KNOTS + i];
            float high = row[STEEP_KNOTS + i + 1];
            if (r2 >= low && r2 < high)
                density += residual_share / (BELL_KNOTS * M_PI * (high - low));
        }
    return density;
}

// Laplacian of unit_lump, for n >= 2.
float lump_curvature(vector at, float n)
{
    float r2 = dot(at, at);
    return r2 < 1.0 ? (n + 1.0) / M_PI * 4.0 * n * power_of_rest(r2, n - 2.0) * (n * r2 - 1.0) : 0.0;
}

// A lump no narrower than Cycles' narrowest facets: a radius that is too small is enlarged.
Lump wide_enough(Disk d, Lump p)
{
    Lump wide = p;
    Spot s;
    if (disk_spot(d, p.centre, s)) {
        float deviation = lump_deviation(p.n);
        float least = WIDE_FACET * NARROWEST_FACET;
        wide.radii[0] *= max(least / length(half_step(d, s, deviation * p.radii[0] * p.along)), 1.0);
        wide.radii[1] *= max(least / length(half_step(d, s, deviation * p.radii[1] * p.across)), 1.0);
    }
    return wide;
}

// How the splats of a lump are made.
struct Aim {
    Draws draws;
    int steep;
    float deviation;  // of the lump
    float widest;     // splat, in parts of that
    float at_edge;    // the widest at a soft edge
    int sharpened;    // whether what a splat blurs away is put back
    color tint;       // of the lump
    color base_tint;  // of its bells, times that
};

Aim make_aim(Disk d, Lump p, Draws requested, float residual, int steep)
{
    Aim aim;
    // At few hits where little is left. The number that decides is uniform again below what it is held against.
    aim.draws = requested;
    aim.draws.count = clamp((int)ceil(requested.count * residual / LARGE_RESIDUAL), 1, requested.count);
    aim.draws.chance = clamp(residual / SMALL_RESIDUAL, LEAST_CHANCE, 1.0);
    aim.draws.numbers = vector(requested.numbers[0], requested.numbers[1] / aim.draws.chance, 0.0);
    aim.steep = steep;
    aim.deviation = lump_deviation(p.n);
    aim.at_edge = p.n >= 1.0 ? (steep ? STEEP_EDGE : 1.0) * AT_EDGE * aim.deviation : 0.0;
    // Over the whole lump what is put back sums up to nothing, but not over a part of it, where it leaves the disk:
    // there splats are smaller.
    int leaves = d.orthogonal && disk_room(d) < OVER_EDGE * aim.deviation * max(p.radii[0], p.radii[1]);
    aim.sharpened = p.n >= 2.0 && !leaves;
    aim.widest = leaves ? UNSHARP : mix(WIDER, WIDEST, min(WIDER_FROM / (p.n + 1.0), 1.0));
    if (steep)
        aim.widest = clamp(BLUR / residual, LEAST_BLUR * WIDEST, WIDEST);
    return aim;
}

// A point that a splat is drawn at.
struct Drawn {
    vector at;      // in the unit disk
    float radius;   // distance from its middle
    float density;  // over its area
    Spot spot;
};

// The splat at a point; what should be taken away is added to `excess`.
closure color kernel_at(Drawn from, Disk d, Lump p, Bells b, Aim aim, output color excess, TARGET_PARAMETERS)
{
    Spot s = from.spot;
    float wide = aim.draws.spread * min(aim.widest * aim.deviation, max(TO_EDGE * (1.0 - from.radius), aim.at_edge));
    // What the bells leave. What a splat blurs away from its part of the lump itself is put back.
    float based = bells_value(b, s.light, s.h) * p.radii[0] * p.radii[1] / s.stretch;
    if (aim.sharpened)
        based += max(1.0 - b.share, 0.0) * 0.5 * wide * wide * lump_curvature(from.at, p.n);
    color over = (target_density(d, p, from.at, s, TARGET) - based * aim.base_tint) / from.density;
    // No closure takes light away.
    excess -= clamp(over, color(-HEAVIEST), color(0.0)) / aim.draws.count;
    color weight = clamp(over, color(0.0), color(HEAVIEST)) / aim.draws.count;
    float shrunk;
    closure color kernel = 0;
    if (max(weight[0], max(weight[1], weight[2])) > UNSEEN && dot(s.light, d.up) > 0.0)
        kernel = weight * aim.tint * bell_closure(make_bell(d, p, s, wide, 1.0, shrunk), d.frame);
    return kernel;
}

// The splats of a hit that has them; `excess` is what should be taken away.
closure color kernels(Disk d, Lump p, Bells b, Aim aim, float row[], output color excess, TARGET_PARAMETERS)
{
    closure color sum = 0;
    for (int k = 0; k < aim.draws.count; k += 1) {
        Drawn from;
        float r2;
        from.density = aim.draws.chance
                     * draw_distance(p.n, lattice_u(aim.draws.numbers, k, aim.draws.count), aim.steep, row, r2);
        from.radius = sqrt(r2);
        float phi = M_2PI * lattice_v(aim.draws.numbers, k);
        from.at = from.radius * vector(cos(phi), sin(phi), 0.0);
        if (from.density > 0.0 && disk_spot(d, lump_point(p, from.at[0], from.at[1]), from.spot)) {
            AT_KERNEL(from.spot.light, vector(from.density / aim.draws.chance, aim.draws.chance,
                                             aim.steep ? -aim.draws.count : aim.draws.count),
                     aim.draws.count)
            sum = kernel_at(from, d, p, b, aim, excess, TARGET) + sum;
        }
    }
    return sum;
}

// Closures of one lump, times `tint`. `room_for_many` tells whether there is room for MOST_BELLS closures and the
// splats.
closure color estimate_lump(Disk d, Lump narrow, color tint, Draws draws, int room_for_many, float table[],
                            TARGET_PARAMETERS)
{
    // The bells.
    Lump p = wide_enough(d, narrow);
    Bells b;
    float gain = target_gain(d, p, TARGET);
    Lump like = target_like(d, p, TARGET);
    float bent = bending(d, like);
    float row[STEEP_ROW];
    int steep = bells_row(p.n, room_for_many && bent < STEEP_BENT, table, row);
    make_bells(d, like, gain * like.radii[0] * like.radii[1] / (p.radii[0] * p.radii[1]), bent, steep, row, b);
    // The splats.
    Aim aim = make_aim(d, p, draws, 1.0 - b.total, steep);
    aim.tint = tint;
    aim.base_tint = target_tint(TARGET);
    closure color sum = 0;
    color excess = 0.0;
    if (KERNELS && draws.numbers[1] < aim.draws.chance)
        sum = kernels(d, p, b, aim, row, excess, TARGET);
    // Closures are put before the sum: Cycles takes it apart with a short stack, which a sum put first would overflow.
    color base_weight = tint * max(aim.base_tint - excess / max(b.total, LEAST_TOTAL), color(0.0));
    for (int i = 0; i < b.count; i += 1)
        sum = base_weight * bell_closure(b.all[i], d.frame) + sum;
    return sum;
}
