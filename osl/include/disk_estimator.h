// How a lump gets into Cycles: Beckmann microfacets, which are bells on the disk, for most of it, and small bells at random
// places for what those leave over. See estimator.h for the idea.
//
// A bell about a point of the disk, of any covariance, is a Beckmann closure: its normal is the point's half vector, its
// slopes those that the disk's map makes of the covariance. What holds in units of the lump's radii, the shares of bells,
// their places and widths, then holds at every view, anisotropy and projection. No closure takes light away: where the
// bells are above the lump, what is too much is taken off all of them, so that no light is made.
//
// A model includes disk.h and one target_*.h before this. The table of bells is fitted by addon/baking/bells.py.

#define NARROWEST 5e-4    // slope: Cycles takes narrower facets for mirrors
#define FURTHEST 0.5      // of a bell's width: how far its normal leans
#define MOST_BELLS 37     // of a steep lump: one, and rings of 6, 12 and 18; of others one and two rings of 6
#define SLENDER 0.07      // 1 / (n + 1) below which a lump is so nearly a bell that one is enough,
#define STRAIGHT 0.05     // where the disk's map is as straight as this
#define BENT 0.9          // share that the bells leave to splats, for its bending: they follow a bent lump badly
#define TOO_BENT 1.0      // there is no use in bells
#define STEEP_BENT 0.4    // nor, here, in many narrow ones
#define WIDEST 0.15       // of a lump's standard deviation: splats; WIDER for sharp lumps, which are nearly bells,
#define WIDER 0.35
#define BLUR 0.0065       // and of steep lumps no more than this over what is left
#define UNSHARP 0.1       // or, where their blur is not put back, this; and at most
#define TO_EDGE 0.4       // of the way to the lump's edge,
#define AT_EDGE 0.12      // or this of the standard deviation where the edge is soft
#define MUCH_LEFT 0.1     // of the volume: where all samples per hit are drawn
#define LITTLE_LEFT 0.02  // of the volume: with less, splats are drawn at fewer hits, and are heavier
#define HEAVIEST 3.0      // weight of all splats of a lump
#define AT_REST 0.8       // share of a steep lump's splats that is drawn where its bells leave something
#define FAR 25.0          // where a bell has e^-25 of its height, and is taken for 0
#define DRAWN_RADIUS 1.45  // what splats are drawn from is a lump of this radius, 1.16 times as wide as a sharp lump

struct Bell {
    vector facet;
    vector along;
    float alpha_x;
    float alpha_y;
    float weight;
    // Of those whose value is asked for, see bell_seen:
    vector across;
    float shadowed;  // 1 + Lambda of the view
    float height;    // what of the value does not depend on the light; 0 where the bell is not seen
};

struct Bells {
    int count;
    Bell all[MOST_BELLS];
    float share;  // of the lump that the bells are made for
    float total;  // weight of all
};

// Gradient, over slopes of the half vector, of the logarithm of what a microfacet shows in the disk's measure.
vector disk_growth(Disk d, Spot s)
{
    vector view = d.frame.view;
    vector across_view = view - dot(view, s.h) * s.h;
    vector across_normal = vector(0.0, 0.0, 1.0) - s.h[2] * s.h;
    if (d.orthogonal)
        return -2.0 * (s.h[2] * across_view + dot(view, s.h) * across_normal) / s.light[2];
    return across_view / dot(view, s.h) + 3.0 * across_normal / s.h[2];
}

// The bell of a standard deviation, in parts of the lump's radii, about a point that is at `s`. Near a horizon it is
// smaller; `shrunk` is by how much.
Bell make_bell(Disk d, Lump p, Spot s, float deviation, float weight, output float shrunk)
{
    vector view = d.frame.view;
    vector a = half_step(d, s, deviation * p.radii[0] * p.along);
    vector b = half_step(d, s, deviation * p.radii[1] * p.across);
    // Lights move twice as fast: bells near a horizon are kept small enough to stay above it.
    float rise_a = 2.0 * (dot(view, a) * s.h[2] + dot(view, s.h) * a[2]);
    float rise_b = 2.0 * (dot(view, b) * s.h[2] + dot(view, s.h) * b[2]);
    float spread = sqrt(rise_a * rise_a + rise_b * rise_b);
    float height = max(min(s.light[2], dot(s.light, d.up)), 0.0);
    shrunk = min(1.0, height / max(3.0 * spread, 1e-9));
    a *= shrunk;
    b *= shrunk;
    vector e1 = dot(a, a) > dot(b, b) ? normalize(a) : normalize(b);
    vector e2 = cross(s.h, e1);
    float xx = dot(a, e1) * dot(a, e1) + dot(b, e1) * dot(b, e1);
    float xy = dot(a, e1) * dot(a, e2) + dot(b, e1) * dot(b, e2);
    float yy = dot(a, e2) * dot(a, e2) + dot(b, e2) * dot(b, e2);
    // Microfacets are seen in proportion to V.H, and the disk's measure changes as well: the normal leans against both.
    vector growth = disk_growth(d, s);
    float g1 = dot(growth, e1);
    float g2 = dot(growth, e2);
    // No further than a part of the bell's width: where it would, the bell says little of the lump anyway.
    float far = sqrt(max(xx * g1 * g1 + 2.0 * xy * g1 * g2 + yy * g2 * g2, 1e-12));
    vector lean = min(1.0, FURTHEST / far) * ((xx * g1 + xy * g2) * e1 + (xy * g1 + yy * g2) * e2);
    Bell bell;
    bell.facet = normalize(s.h - lean);
    float mean = 0.5 * (xx + yy);
    float apart = hypot(0.5 * (xx - yy), xy);
    // Cosine and sine of half the angle whose cosine is this.
    float double_turn = 0.5 * (xx - yy) / max(apart, 1e-12);
    bell.along = sqrt(0.5 * max(1.0 + double_turn, 0.0)) * e1
               + (xy < 0.0 ? -1.0 : 1.0) * sqrt(0.5 * max(1.0 - double_turn, 0.0)) * e2;
    bell.alpha_x = clamp(sqrt(2.0 * (mean + apart)), NARROWEST, 1.0);
    bell.alpha_y = clamp(sqrt(2.0 * max(mean - apart, 0.0)), NARROWEST, 1.0);
    bell.weight = weight;
    return bell;
}

float bell_lambda(float x, float y, float z)
{
    float slope2 = (x * x + y * y) / max(z * z, 1e-12);
    if (slope2 < 0.39)
        return 0.0;
    float a = inversesqrt(slope2);
    return ((0.396 * a - 1.259) * a + 1.0) / ((2.181 * a + 3.535) * a);
}

// The bell with what bell_value needs that is the same for all lights.
Bell bell_seen(Bell bell, vector view)
{
    Bell b = bell;
    b.across = normalize(cross(b.facet, b.along));
    b.along = cross(b.across, b.facet);
    float z = dot(b.facet, view);
    b.shadowed = 1.0 + bell_lambda(dot(b.along, view) * b.alpha_x, dot(b.across, view) * b.alpha_y, z);
    b.height = z > 0.0 ? b.weight / (4.0 * M_PI * b.alpha_x * b.alpha_y * z) : 0.0;
    return b;
}

// f (N.L) of a bell of bell_seen, its weight included, as Cycles evaluates it (Walter et al. 2007, eq. 20, 25, and Heitz
// 2014); `h` is the unit half vector.
float bell_value(Bell b, vector light, vector h)
{
    float z = dot(b.facet, light);
    float hz = dot(b.facet, h);
    if (z <= 0.0 || hz <= 0.0)
        return 0.0;
    float hx = dot(b.along, h) / (hz * b.alpha_x);
    float hy = dot(b.across, h) / (hz * b.alpha_y);
    float away = hx * hx + hy * hy;
    if (away > FAR)
        return 0.0;
    float lambda = bell_lambda(dot(b.along, light) * b.alpha_x, dot(b.across, light) * b.alpha_y, z);
    return b.height * exp(-away) / (hz * hz * hz * hz * (b.shadowed + lambda));
}

float bells_value(Bells b, vector light, vector h)
{
    float sum = 0.0;
    for (int i = 0; i < b.count; i += 1)
        sum += bell_value(b.all[i], light, h);
    return sum;
}

closure color bell_closure(Bell b, Frame f)
{
    return b.weight * microfacet("beckmann", normalize(to_world(f, b.facet)), normalize(to_world(f, b.along)),
                                 b.alpha_x, b.alpha_y, 0.0, 0);
}

void add_bell(Disk d, Lump p, float x, float y, float deviation, float weight, output Bells b)
{
    Spot s;
    if (disk_spot(d, lump_point(p, x, y), s)) {
        float shrunk;
        Bell bell = make_bell(d, p, s, deviation, weight, shrunk);
        bell.weight *= shrunk * shrunk;  // no higher than a whole bell
        if (bell.weight > 1e-5) {
            b.all[b.count] = bell_seen(bell, d.frame.view);
            b.count += 1;
            b.total += bell.weight;
        }
    }
}

// How much the disk's map changes over one standard deviation of the lump: 0 where it is affine. What the scaling
// projection's bells lean against, that microfacets are seen in proportion to V.H, bends nothing.
float bending(Disk d, Lump p)
{
    float deviation = lump_deviation(p.n);
    Spot s;
    if (!disk_spot(d, p.centre, s))
        return 2.0 * TOO_BENT;
    vector a = half_step(d, s, deviation * p.radii[0] * p.along);
    vector b = half_step(d, s, deviation * p.radii[1] * p.across);
    vector growth = disk_growth(d, s);
    if (!d.orthogonal)
        growth -= d.frame.view / dot(d.frame.view, s.h);
    return hypot(dot(growth, a), dot(growth, b)) + 0.8 * (dot(a, a) + dot(b, b));
}

// A row of the table of bells between its nodes, see addon/baking/bells.py; with `many`, of a steep lump, with what they
// leave. Returns whether it is one of those.
int bells_row(float n, int many, float table[], output float row[])
{
    float at = BELLS_PER_UNIT / (n + 1.0);
    int steep = many && at >= STEEP_FROM;
    int size = steep ? STEEP_ROW : 8;
    int i = min((int)at, BELLS_PER_UNIT - 1);
    int first = steep ? STEEP_ROWS + size * (i - STEEP_FROM) : size * i;
    for (int k = 0; k < size; k += 1)
        row[k] = mix(table[first + k], table[first + size + k], at - i);
    return steep;
}

void add_ring(Disk d, Lump p, float row[], int ring, int count, float deviation, float share, output Bells b)
{
    int first = 2 + 3 * ring;
    float radius = row[first + 1] * deviation;
    for (int k = 0; k < count; k += 1) {
        float phi = M_2PI * (k + 0.5 * (ring == 1)) / count;
        add_bell(d, p, radius * cos(phi), radius * sin(phi), row[first + 2] * deviation, share * row[first] / count, b);
    }
}

void make_bells(Disk d, Lump p, float gain, float bent, int steep, float row[], output Bells b)
{
    float v = 1.0 / (p.n + 1.0);
    float deviation = lump_deviation(p.n);
    b.count = 0;
    b.share = 0.0;
    b.total = 0.0;
    if (bent > TOO_BENT)
        return;
    // The many bells of a steep lump are narrow, and follow one that is bent a little.
    b.share = steep ? gain * mix(0.97, 1.0, clamp(4.0 * v - 1.0, 0.0, 1.0)) : gain * (1.0 - min(BENT * bent, 0.6));
    if (v < SLENDER && bent < STRAIGHT) {
        add_bell(d, p, 0.0, 0.0, deviation, b.share * (1.0 - 0.8 * v), b);
        return;
    }
    add_bell(d, p, 0.0, 0.0, row[1] * deviation, b.share * row[0], b);
    add_ring(d, p, row, 0, 6, deviation, b.share, b);
    add_ring(d, p, row, 1, steep ? 12 : 6, deviation, b.share, b);
    if (steep)
        add_ring(d, p, row, 2, 18, deviation, b.share, b);
}

// Draws the square of a splat's distance from the middle of the unit disk by a number u; returns the density over the
// disk's area. Most of a steep lump's lie where the row says that its bells leave something, all others as a lump does.
float draw_distance(float n, float u, int steep, float row[], output float r2)
{
    float drawn_n = 1.23 * n + 1.28;
    float area = M_PI * DRAWN_RADIUS * DRAWN_RADIUS;
    float at_rest = steep ? AT_REST : 0.0;
    if (u < at_rest) {
        float at = BELL_KNOTS * u / at_rest;
        int i = min((int)at, BELL_KNOTS - 1);
        r2 = mix(row[STEEP_KNOTS + i], row[STEEP_KNOTS + i + 1], at - i);
    } else  // eq. 28
        r2 = DRAWN_RADIUS * DRAWN_RADIUS * rest_of_root(max((u - at_rest) / (1.0 - at_rest), 1e-7), drawn_n + 1.0);
    float density = (1.0 - at_rest) * (drawn_n + 1.0) / area * power_of_rest(M_PI * r2 / area, drawn_n);
    if (steep)
        for (int i = 0; i < BELL_KNOTS; i += 1) {
            float low = row[STEEP_KNOTS + i];
            float high = row[STEEP_KNOTS + i + 1];
            if (r2 >= low && r2 < high)
                density += at_rest / (BELL_KNOTS * M_PI * (high - low));
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
        float least = 0.71 * NARROWEST;
        wide.radii[0] *= max(least / length(half_step(d, s, deviation * p.radii[0] * p.along)), 1.0);
        wide.radii[1] *= max(least / length(half_step(d, s, deviation * p.radii[1] * p.across)), 1.0);
    }
    return wide;
}

// Closures of one lump, times `tint`. `room_for_many` tells whether there is room for MOST_BELLS closures and the splats.
closure color estimate_lump(Disk d, Lump given, Target t, color tint, vector numbers, int samples, float spread,
                            int room_for_many, float table[], TABLE(albedos))
{
    Lump p = wide_enough(d, given);
    Bells b;
    color base_tint = target_tint(t);
    float gain = target_gain(t, d, p, albedos);
    Lump like = target_like(t, d, p);
    float bent = bending(d, like);
    float row[STEEP_ROW];
    int steep = bells_row(p.n, room_for_many && bent < STEEP_BENT, table, row);
    make_bells(d, like, gain * like.radii[0] * like.radii[1] / (p.radii[0] * p.radii[1]), bent, steep, row, b);
    float left = 1.0 - b.total;
    int count = clamp((int)ceil(samples * left / MUCH_LEFT), 1, samples);
    float chance = clamp(left / LITTLE_LEFT, 0.05, 1.0);
    closure color sum = 0;
    color owed = 0.0;
    float deviation = lump_deviation(p.n);
    float at_edge = p.n >= 1.0 ? (steep ? 0.6 : 1.0) * AT_EDGE * deviation : 0.0;
    // Over the whole lump what is put back sums up to nothing, but not over a part of it, where it leaves the disk: there
    // splats are smaller.
    int leaves = d.orthogonal && disk_room(d) < 3.0 * deviation * max(p.radii[0], p.radii[1]);
    int sharpened = p.n >= 2.0 && !leaves;
    float widest = leaves ? UNSHARP : mix(WIDER, WIDEST, min(8.0 / (p.n + 1.0), 1.0));
    if (steep)
        widest = clamp(BLUR / left, 0.6 * WIDEST, WIDEST);
    vector drawn = vector(numbers[0], numbers[1] / chance, 0.0);
    for (int k = 0; k < count && numbers[1] < chance; k += 1) {
        float r2;
        float density = chance * draw_distance(p.n, lattice_u(drawn, k, count), steep, row, r2);
        float r = sqrt(r2);
        float phi = M_2PI * lattice_v(drawn, k);
        vector at = r * vector(cos(phi), sin(phi), 0.0);
        Spot s;
        float shrunk;
        if (density > 0.0 && disk_spot(d, lump_point(p, at[0], at[1]), s)) {
            float wide = spread * min(widest * deviation, max(TO_EDGE * (1.0 - r), at_edge));
            float based = bells_value(b, s.light, s.h) * p.radii[0] * p.radii[1] / s.stretch;
            // What a splat blurs away from its part of the lump itself is put back.
            if (sharpened)
                based += max(1.0 - b.share, 0.0) * 0.5 * wide * wide * lump_curvature(at, p.n);
            color over = (target_density(t, d, p, at, s, albedos) - based * base_tint) / density;
            owed -= clamp(over, color(-HEAVIEST), color(0.0)) / count;
            color weight = clamp(over, color(0.0), color(HEAVIEST)) / count;
            if (max(weight[0], max(weight[1], weight[2])) > 1e-5 && dot(s.light, d.up) > 0.0)
                sum = weight * tint * bell_closure(make_bell(d, p, s, wide, 1.0, shrunk), d.frame) + sum;
        }
    }
    // Closures are put before the sum: Cycles takes it apart with a short stack, which a sum put first would overflow.
    color kept = tint * max(base_tint - owed / max(b.total, 1e-3), color(0.0));
    for (int i = 0; i < b.count; i += 1)
        sum = kept * bell_closure(b.all[i], d.frame) + sum;
    return sum;
}
