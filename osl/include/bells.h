// Bells: Beckmann microfacets that make up most of a lump on the halfway vector disk; see disk_estimator.h.
//
// A bell about a point of the disk, of any covariance, is a Beckmann closure: its normal is the point's half vector,
// its slopes those that the disk's map makes of the covariance. What holds in units of the lump's radii, the shares of
// bells, their places and widths, then holds at every view, anisotropy and projection. No closure takes light away:
// where the bells are above the lump, what is too much is taken off all of them, so that no light is made.
//
// The table of bells is fitted by addon/forms/bells.py, and so are the macros BELLS_, BELL_, RING_ and STEEP_.

#include "beckmann.h"

#define MIDDLE_NUMBERS 2  // of a row of the table, of the bell in the middle: share, width,
#define RING_NUMBERS 3    // and of each ring: share, radius, width
#define FURTHEST 0.5      // of a bell's width: how far its normal leans
#define IN_SIGHT 3.0      // widths of its lights that a bell's middle lies above the horizon
#define FAR 25.0          // where a bell has e^-25 of its height, and is taken for 0
#define FAINTEST 1e-5     // weight of a bell that is left out
#define LEAST_SPREAD 1e-9    // of lights, that is divided by
#define LEAST_VARIANCE 1e-12

#define SLENDER 0.07      // 1 / (n + 1) below which a lump is so nearly a bell that one is enough,
#define STRAIGHT 0.05     // where the disk's map is as straight as this,
#define SLENDER_LOSS 0.8  // and its share falls by this times 1 / (n + 1)
#define BENT 0.9          // share that the bells leave to splats, for its bending: they follow a bent lump badly
#define MOST_RESIDUAL 0.6     // that they leave for it
#define TOO_BENT 1.0      // there is no use in bells
#define CURVED 0.8        // how much the square of a lump's width counts beside the gradient
#define STEEPEST_SHARE 0.97  // of the bells of the steepest lumps

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

// By how much a bell whose middle is at `s`, of standard deviations `a` and `b`, is made smaller to stay above the
// horizon. Lights move twice as fast as half vectors.
float shrinkage(Disk d, Spot s, vector a, vector b)
{
    vector view = d.frame.view;
    float rise_a = 2.0 * (dot(view, a) * s.h[2] + dot(view, s.h) * a[2]);
    float rise_b = 2.0 * (dot(view, b) * s.h[2] + dot(view, s.h) * b[2]);
    float spread = sqrt(rise_a * rise_a + rise_b * rise_b);
    float height = max(min(s.light[2], dot(s.light, d.up)), 0.0);
    return min(1.0, height / max(IN_SIGHT * spread, LEAST_SPREAD));
}

// How far a bell's normal leans. Microfacets are seen in proportion to V.H, and the disk's measure changes as well:
// the normal leans against both, but no further than a part of the bell's width: where it would, the bell says little
// of the lump anyway.
vector leaning(Disk d, Spot s, Ellipse e)
{
    vector growth = disk_growth(d, s);
    float g1 = dot(growth, e.e1);
    float g2 = dot(growth, e.e2);
    float far = sqrt(max(e.xx * g1 * g1 + 2.0 * e.xy * g1 * g2 + e.yy * g2 * g2, LEAST_VARIANCE));
    return min(1.0, FURTHEST / far) * ((e.xx * g1 + e.xy * g2) * e.e1 + (e.xy * g1 + e.yy * g2) * e.e2);
}

// The bell of a standard deviation, in parts of the lump's radii, about a point that is at `s`. Near a horizon it is
// smaller; `shrunk` is by how much.
Bell make_bell(Disk d, Lump p, Spot s, float deviation, float weight, output float shrunk)
{
    // The covariance of half vectors.
    vector a = half_step(d, s, deviation * p.radii[0] * p.along);
    vector b = half_step(d, s, deviation * p.radii[1] * p.across);
    shrunk = shrinkage(d, s, a, b);
    a *= shrunk;
    b *= shrunk;
    Ellipse e = ellipse_of(s.h, a, b);
    Bell bell;
    bell.facet = normalize(s.h - leaning(d, s, e));
    // Its axes: cosine and sine of half the angle whose cosine is this.
    float double_turn = 0.5 * (e.xx - e.yy) / max(e.apart, LEAST_VARIANCE);
    bell.along = sqrt(0.5 * max(1.0 + double_turn, 0.0)) * e.e1
               + (e.xy < 0.0 ? -1.0 : 1.0) * sqrt(0.5 * max(1.0 - double_turn, 0.0)) * e.e2;
    bell.alpha_x = clamp(sqrt(2.0 * (e.mean + e.apart)), NARROWEST_FACET, 1.0);
    bell.alpha_y = clamp(sqrt(2.0 * max(e.mean - e.apart, 0.0)), NARROWEST_FACET, 1.0);
    bell.weight = weight;
    return bell;
}

float bell_lambda(float x, float y, float z)
{
    return beckmann_lambda((x * x + y * y) / max(z * z, LEAST_COSINE2));
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

// f (N.L) of a bell of bell_seen, its weight included, as Cycles evaluates it (Walter et al. 2007, eq. 20, 25, and
// Heitz 2014); `h` is the unit half vector.
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
        if (bell.weight > FAINTEST) {
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
    return hypot(dot(growth, a), dot(growth, b)) + CURVED * (dot(a, a) + dot(b, b));
}

// A row of the table of bells between its nodes, see addon/forms/bells.py; with `many`, of a steep lump, with what
// they leave. Returns whether it is one of those.
int bells_row(float n, int many, float table[], output float row[])
{
    float at = BELLS_PER_UNIT / (n + 1.0);
    int steep = many && at >= STEEP_FROM;
    int size = steep ? STEEP_ROW : BELLS_ROW;
    int i = min((int)at, BELLS_PER_UNIT - 1);
    int first = steep ? STEEP_ROWS + size * (i - STEEP_FROM) : size * i;
    for (int k = 0; k < size; k += 1)
        row[k] = mix(table[first + k], table[first + size + k], at - i);
    return steep;
}

// A ring of `count` bells, every other ring turned by half a bell.
void add_ring(Disk d, Lump p, float row[], int ring, int count, output Bells b)
{
    float deviation = lump_deviation(p.n);
    int first = MIDDLE_NUMBERS + RING_NUMBERS * ring;
    float radius = row[first + 1] * deviation;
    for (int k = 0; k < count; k += 1) {
        float phi = M_2PI * (k + 0.5 * (ring == 1)) / count;
        add_bell(d, p, radius * cos(phi), radius * sin(phi), row[first + 2] * deviation, b.share * row[first] / count,
                 b);
    }
}

// The bells of a lump, `gain` times as high, by its `row` of the table.
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
    b.share = steep ? gain * mix(STEEPEST_SHARE, 1.0, clamp(4.0 * v - 1.0, 0.0, 1.0))
                    : gain * (1.0 - min(BENT * bent, MOST_RESIDUAL));
    if (v < SLENDER && bent < STRAIGHT) {
        add_bell(d, p, 0.0, 0.0, deviation, b.share * (1.0 - SLENDER_LOSS * v), b);
        return;
    }
    add_bell(d, p, 0.0, 0.0, row[1] * deviation, b.share * row[0], b);
    add_ring(d, p, row, 0, steep ? STEEP_RING_0 : RING_0, b);
    add_ring(d, p, row, 1, steep ? STEEP_RING_1 : RING_1, b);
    if (steep)
        add_ring(d, p, row, 2, STEEP_RING_2, b);
}
