// The estimator of a lump: bells (see bells.h) for most of it, and kernels, small bells at random points, for the
// residual, the lump minus the bells. estimator.h explains the idea.
//
// A model includes disk.h and one target_*.h before this file.

#include "bells.h"

#define STEEP_BENT 0.4  // bending from which on a steep lump has no many narrow bells

// The standard deviation of a kernel, in parts of the lump's.
#define WIDEST 0.15       // at most, for blunt lumps
#define WIDER 0.35        // at most, for sharp lumps, which are nearly bells
#define WIDER_FROM 8.0    // n + 1 from which on WIDEST goes over to WIDER
#define BLUR 0.0065       // at most for steep lumps, divided by the residual
#define LEAST_BLUR 0.6    // in parts of WIDEST: BLUR goes no lower
#define UNSHARP 0.1       // at most where the kernels' blur is not compensated
#define TO_EDGE 0.4       // at most, in parts of the distance to the lump's edge
#define AT_EDGE 0.12      // or at most, near the edge, where that is soft
#define STEEP_EDGE 0.6    // AT_EDGE is multiplied by this for steep lumps

// The number of kernels, and their weights.
#define LARGE_RESIDUAL 0.1   // share of the volume from which on a hit takes all samples
#define SMALL_RESIDUAL 0.02  // share of the volume below which fewer hits have kernels, and these are heavier
#define LEAST_CHANCE 0.05    // least share of hits that have kernels
#define HEAVIEST 3.0         // largest weight of all kernels of a lump
#define UNSEEN 1e-5          // kernels with a smaller weight are skipped

// Kernels are sampled from a lump of its own, 1.16 times as wide as a sharp lump.
#define RESIDUAL_SHARE 0.8  // share of a steep lump's kernels that are sampled by its bells' residual instead
#define DRAWN_RADIUS 1.45   // its radius
#define DRAWN_SLOPE 1.23    // its exponent is DRAWN_SLOPE n + DRAWN_MORE
#define DRAWN_MORE 1.28

#define WIDE_FACET 0.71   // least standard deviation of a lump, in widths of the narrowest facet
#define OVER_EDGE 3.0     // standard deviations from the disk's edge below which a lump leaves the disk
#define LEAST_TOTAL 1e-3  // smallest divisor for the weight of all bells

// Samples the square of a kernel's distance from the middle of the unit disk by a uniform number u. Returns the density
// over the disk's area. Most kernels of a steep lump follow the residual of its bells, by the knots of the row; all
// others follow a lump.
float draw_distance(float n, float u, int steep, float row[], output float r2)
{
    float drawn_n = DRAWN_SLOPE * n + DRAWN_MORE;
    // Sample either the bells' residual or the wider lump.
    float area = M_PI * DRAWN_RADIUS * DRAWN_RADIUS;
    float residual_share = steep ? RESIDUAL_SHARE : 0.0;
    if (u < residual_share) {
        float at = BELL_KNOTS * u / residual_share;
        int i = min((int)at, BELL_KNOTS - 1);
        r2 = mix(row[STEEP_KNOTS + i], row[STEEP_KNOTS + i + 1], at - i);
    } else  // eq. 28
        r2 = DRAWN_RADIUS * DRAWN_RADIUS
           * rest_of_root(max((u - residual_share) / (1.0 - residual_share), LEAST_DRAWN), drawn_n + 1.0);
    // The density of the mixture of both.
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

// The lump with each radius enlarged, where needed, to what Cycles' narrowest facets can show.
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

// The numbers that all kernels of a lump share.
struct Aim {
    Draws draws;
    int steep;        // whether the lump has the many bells of steep lumps
    float deviation;  // the lump's standard deviation, in parts of its radii
    float widest;     // standard deviation of the widest kernel, in parts of `deviation`
    float at_edge;    // standard deviation of the widest kernel at a soft edge, in parts of the radii
    int sharpened;    // whether the kernels' blur is compensated
    color tint;       // color factor of the lump
    color base_tint;  // further color factor of its bells
};

Aim make_aim(Disk d, Lump p, Draws requested, float residual, int steep)
{
    Aim aim;
    // Few hits have kernels where the residual is small. The number that chooses is uniform below `chance`: it is
    // stretched for another use.
    aim.draws = requested;
    aim.draws.count = clamp((int)ceil(requested.count * residual / LARGE_RESIDUAL), 1, requested.count);
    aim.draws.chance = clamp(residual / SMALL_RESIDUAL, LEAST_CHANCE, 1.0);
    aim.draws.numbers = vector(requested.numbers[0], requested.numbers[1] / aim.draws.chance, 0.0);
    // The kernels' widths.
    aim.steep = steep;
    aim.deviation = lump_deviation(p.n);
    aim.at_edge = p.n >= 1.0 ? (steep ? STEEP_EDGE : 1.0) * AT_EDGE * aim.deviation : 0.0;
    // The compensation of the blur sums up to 0 over the whole lump, but not over the part that is on the disk. So
    // lumps that leave the disk have smaller kernels, and no compensation.
    int leaves = d.orthogonal && disk_room(d) < OVER_EDGE * aim.deviation * max(p.radii[0], p.radii[1]);
    aim.sharpened = p.n >= 2.0 && !leaves;
    aim.widest = leaves ? UNSHARP : mix(WIDER, WIDEST, min(WIDER_FROM / (p.n + 1.0), 1.0));
    if (steep)
        aim.widest = clamp(BLUR / residual, LEAST_BLUR * WIDEST, WIDEST);
    return aim;
}

// The point about which a kernel lies.
struct Drawn {
    vector at;      // the point on the unit disk
    float radius;   // its distance from the middle
    float density;  // probability density over the unit disk's area
    Spot spot;
};

// The kernel at a point. A negative weight is added to `excess` instead.
closure color kernel_at(Drawn from, Disk d, Lump p, Bells b, Aim aim, output color excess, TARGET_PARAMETERS)
{
    Spot s = from.spot;
    float wide = aim.draws.spread * min(aim.widest * aim.deviation, max(TO_EDGE * (1.0 - from.radius), aim.at_edge));
    // The residual: the lump minus the bells. The part that the kernel's blur takes from the lump is added back.
    float based = bells_value(b, s.light, s.h) * p.radii[0] * p.radii[1] / s.stretch;
    if (aim.sharpened)
        based += max(1.0 - b.share, 0.0) * 0.5 * wide * wide * lump_curvature(from.at, p.n);
    color over = (target_density(d, p, from.at, s, TARGET) - based * aim.base_tint) / from.density;
    // Microfacets cannot be negative: the excess of the bells goes to `excess`, and the kernel gets the rest.
    excess -= clamp(over, color(-HEAVIEST), color(0.0)) / aim.draws.count;
    color weight = clamp(over, color(0.0), color(HEAVIEST)) / aim.draws.count;
    float shrunk;
    closure color kernel = 0;
    if (max(weight[0], max(weight[1], weight[2])) > UNSEEN && dot(s.light, d.up) > 0.0)
        kernel = weight * aim.tint * bell_closure(make_bell(d, p, s, wide, 1.0, shrunk), d.frame);
    return kernel;
}

// The kernels of a lump. `excess` is the sum of the negative weights.
closure color kernels(Disk d, Lump p, Bells b, Aim aim, float row[], output color excess, TARGET_PARAMETERS)
{
    closure color sum = 0;
    for (int k = 0; k < aim.draws.count; k += 1) {
        // Sample a point on the disk.
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

// Closures of one lump, times `tint`. `room_for_many` is 1 where Cycles has room for MOST_BELLS closures and the
// kernels.
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
    // The kernels.
    Aim aim = make_aim(d, p, draws, 1.0 - b.total, steep);
    aim.tint = tint;
    aim.base_tint = target_tint(TARGET);
    closure color sum = 0;
    color excess = 0.0;
    if (KERNELS && draws.numbers[1] < aim.draws.chance)
        sum = kernels(d, p, b, aim, row, excess, TARGET);
    // The bells pay for the excess. Each closure is put before the sum: Cycles walks the sum with a short stack, which
    // `sum + closure` would overflow.
    color base_weight = tint * max(aim.base_tint - excess / max(b.total, LEAST_TOTAL), color(0.0));
    for (int i = 0; i < b.count; i += 1)
        sum = base_weight * bell_closure(b.all[i], d.frame) + sum;
    return sum;
}
