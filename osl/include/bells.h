// Bells: Beckmann microfacets that together are most of a lump on the halfway vector disk; see disk_estimator.h.
//
// A bell is a normal distribution about a point of the disk, with any covariance. It is a Beckmann closure: its normal
// is the point's half vector, and its widths follow from the covariance by the disk's map. So one table serves every
// view, anisotropy and projection: it has the bells' shares, positions and widths in units of the lump's radii. No
// closure takes light away: the bells' excess over the lump is taken from all of them, so that no light is made.
//
// addon/forms/bells.py fits the table of bells; the macros BELLS_, BELL_, RING_ and STEEP_ come from there.

#include "beckmann.h"

#define MIDDLE_NUMBERS 2      // numbers of the middle bell in a row of the table: share, width
#define RING_NUMBERS 3        // numbers of each ring there: share, radius, width
#define FURTHEST 0.5          // largest lean of a bell's normal, in parts of the bell's width
#define IN_SIGHT 3.0          // least height of a bell's light above the horizon, in widths of its lights
#define FAR 25.0              // exponent from which on a bell, e^-25 of its height, is taken as 0
#define FAINTEST 1e-5         // bells with a smaller weight are skipped
#define LEAST_SPREAD 1e-9     // smallest divisor for the spread of lights
#define LEAST_VARIANCE 1e-12  // smallest divisor for a variance

// A lump that is nearly a bell, with 1 / (n + 1) below SLENDER and a bending below STRAIGHT, has one bell. Its share is
// smaller by SLENDER_LOSS / (n + 1).
#define SLENDER 0.07
#define STRAIGHT 0.05
#define SLENDER_LOSS 0.8
// Bells follow a bent lump badly: BENT times the bending, at most MOST_RESIDUAL, of it is the kernels' share.
#define BENT 0.9
#define MOST_RESIDUAL 0.6
#define TOO_BENT 1.0          // bending from which on a lump has no bells
#define CURVED 0.8            // factor of the square of a lump's width in the bending, beside the gradient
#define STEEPEST_SHARE 0.97   // share of the bells of the steepest lumps

struct Bell {
    vector facet;
    vector along;
    float alpha_x;
    float alpha_y;
    float weight;
    // These are filled by bell_seen:
    vector across;
    float shadowed;  // 1 + Lambda of the view
    float height;    // the factor of the value that does not depend on the light; 0 where the view is below the facet
};

struct Bells {
    int count;
    Bell all[MOST_BELLS];
    float share;  // share of the lump that the bells stand for
    float total;  // sum of the bells' weights
};

// Gradient, over slopes of the half vector, of the logarithm of a microfacet's value in the disk's measure.
vector disk_growth(Disk d, Spot s)
{
    vector view = d.frame.view;
    vector across_view = view - dot(view, s.h) * s.h;
    vector across_normal = vector(0.0, 0.0, 1.0) - s.h[2] * s.h;
    if (d.orthogonal)
        return -2.0 * (s.h[2] * across_view + dot(view, s.h) * across_normal) / s.light[2];
    return across_view / dot(view, s.h) + 3.0 * across_normal / s.h[2];
}

// The factor, 0..1, that shrinks a bell about `s` with the standard deviations `a` and `b` so that it stays above the
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

// The lean of a bell's normal. A microfacet's value is proportional to V.H, and the disk's measure changes as well:
// the normal leans against both. The lean is at most FURTHEST of the bell's width: a bell with a larger one follows the
// lump badly anyway.
vector leaning(Disk d, Spot s, Ellipse e)
{
    vector growth = disk_growth(d, s);
    float g1 = dot(growth, e.e1);
    float g2 = dot(growth, e.e2);
    float far = sqrt(max(e.xx * g1 * g1 + 2.0 * e.xy * g1 * g2 + e.yy * g2 * g2, LEAST_VARIANCE));
    return min(1.0, FURTHEST / far) * ((e.xx * g1 + e.xy * g2) * e.e1 + (e.xy * g1 + e.yy * g2) * e.e2);
}

// The bell about the point at `s`, with a standard deviation in parts of the lump's radii. Near a horizon the bell is
// smaller, by the factor `shrunk`.
Bell make_bell(Disk d, Lump p, Spot s, float deviation, float weight, output float shrunk)
{
    // The covariance of the half vectors.
    vector a = half_step(d, s, deviation * p.radii[0] * p.along);
    vector b = half_step(d, s, deviation * p.radii[1] * p.across);
    shrunk = shrinkage(d, s, a, b);
    a *= shrunk;
    b *= shrunk;
    Ellipse e = ellipse_of(s.h, a, b);
    Bell bell;
    bell.facet = normalize(s.h - leaning(d, s, e));
    // The ellipse's axes: cosine and sine of half the angle whose cosine is `double_turn`.
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

// The bell with the numbers of bell_value that are the same for all lights.
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
    return SPOILT_BELL(b.weight) * microfacet("beckmann", normalize(to_world(f, b.facet)), normalize(to_world(f, b.along)),
                                 b.alpha_x, b.alpha_y, 0.0, 0);
}

void add_bell(Disk d, Lump p, float x, float y, float deviation, float weight, output Bells b)
{
    Spot s;
    if (disk_spot(d, lump_point(p, x, y), s)) {
        float shrunk;
        Bell bell = make_bell(d, p, s, deviation, weight, shrunk);
        bell.weight *= shrunk * shrunk;  // as high as the whole bell
        if (bell.weight > FAINTEST) {
            b.all[b.count] = bell_seen(bell, d.frame.view);
            b.count += 1;
            b.total += bell.weight;
        }
    }
}

// The bending of a lump: the change of the disk's map over one standard deviation; 0 where the map is affine. In the
// scaling projection the factor V.H of microfacets, which the normal leans against, does not count.
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

// Reads a row of the table of bells between its nodes, see addon/forms/bells.py. With `many`, and a small exponent, it
// is a row of steep lumps, which ends with the knots of the residual. Returns whether it is one.
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

// Adds a ring of `count` bells. Every other ring is turned by half a bell.
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

// The bells of a lump that is `gain` times as high, by its `row` of the table.
void make_bells(Disk d, Lump p, float gain, float bent, int steep, float row[], output Bells b)
{
    float v = 1.0 / (p.n + 1.0);
    float deviation = lump_deviation(p.n);
    b.count = 0;
    b.share = 0.0;
    b.total = 0.0;
    if (bent > TOO_BENT)
        return;
    // The many bells of a steep lump are narrow, and follow a small bending.
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
