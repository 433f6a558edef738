// How a lump gets into Cycles: Beckmann microfacets, which are bells on the disk, for most of it, and small bells at random
// places for what they leave over. See estimator.h for the idea.
//
// A bell about a point of the disk, of any covariance, is a Beckmann closure: its normal is the point's half vector, its
// slopes those that the disk's map makes of the covariance. What holds in units of the lump's radii, the shares of bells,
// their places and widths, then holds at every view, anisotropy and projection.

#define NARROWEST 5e-4   // slope: Cycles takes narrower facets for mirrors
#define RING 6           // bells of each of two rings around the middle one
#define SLENDER 0.03     // 1 / (n + 1) below which a lump is so nearly a bell that the ring is left out
#ifndef WIDEST
#define WIDEST 0.3       // of a lump's standard deviation: splats
#endif
#ifndef TO_EDGE
#define TO_EDGE 0.3      // of the way to the lump's edge
#endif
#define HEAVIEST 3.0     // weight of all splats of a lump

#ifndef EDGE_LEAST
#define EDGE_LEAST 0.2
#endif
#ifndef BENT
#define BENT 0.6
#endif
#ifndef STRAIGHT
#define STRAIGHT 0.02
#endif
#ifndef DRAWN_R
#define DRAWN_R 1.25
#define DRAWN_N 0.75
#endif

struct Bell {
    vector facet;
    vector along;
    float alpha_x;
    float alpha_y;
    float weight;
};

struct Bells {
    int count;
    Bell all[13];
    float share;     // of the lump that the bells are made for
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

// The bell of standard deviations x and y, in parts of the lump's radii, about a point that is at `s`.
Bell make_bell(Disk d, Lump p, Spot s, float x, float y, float weight)
{
    vector view = d.frame.view;
    vector a = half_step(d, s, x * p.radii[0] * p.along);
    vector b = half_step(d, s, y * p.radii[1] * p.across);
    // Lights move twice as fast: bells near a horizon are kept small enough to stay above it.
    float rise_a = 2.0 * (dot(view, a) * s.h[2] + dot(view, s.h) * a[2]);
    float rise_b = 2.0 * (dot(view, b) * s.h[2] + dot(view, s.h) * b[2]);
    float spread = sqrt(rise_a * rise_a + rise_b * rise_b);
    float small = min(1.0, s.light[2] / max(3.0 * spread, 1e-9));
    a *= small;
    b *= small;
    vector e1 = dot(a, a) > dot(b, b) ? normalize(a) : normalize(b);
    vector e2 = cross(s.h, e1);
    float xx = dot(a, e1) * dot(a, e1) + dot(b, e1) * dot(b, e1);
    float xy = dot(a, e1) * dot(a, e2) + dot(b, e1) * dot(b, e2);
    float yy = dot(a, e2) * dot(a, e2) + dot(b, e2) * dot(b, e2);
    // Microfacets are seen in proportion to V.H, and the disk's measure changes as well: the normal leans against both.
    vector growth = disk_growth(d, s);
    float g1 = dot(growth, e1);
    float g2 = dot(growth, e2);
    vector lean = (xx * g1 + xy * g2) * e1 + (xy * g1 + yy * g2) * e2;
    Bell bell;
    bell.facet = normalize(s.h - lean);
    float mean = 0.5 * (xx + yy);
    float apart = hypot(0.5 * (xx - yy), xy);
    float turn = 0.5 * atan2(2.0 * xy, xx - yy);
    bell.along = cos(turn) * e1 + sin(turn) * e2;
    bell.alpha_x = clamp(sqrt(2.0 * (mean + apart)), NARROWEST, 1.0);
    bell.alpha_y = clamp(sqrt(2.0 * max(mean - apart, 0.0)), NARROWEST, 1.0);
    bell.weight = weight;
    return bell;
}

float bell_lambda(vector v, float ax, float ay)
{
    float slope2 = (v[0] * v[0] * ax * ax + v[1] * v[1] * ay * ay) / max(v[2] * v[2], 1e-12);
    if (slope2 < 0.39)
        return 0.0;
    float a = inversesqrt(slope2);
    return ((0.396 * a - 1.259) * a + 1.0) / ((2.181 * a + 3.535) * a);
}

// f (N.L) of a bell as Cycles evaluates it (Walter et al. 2007, eq. 20, 25, and Heitz 2014).
float bell_value(Bell b, vector view, vector light)
{
    vector y = normalize(cross(b.facet, b.along));
    vector x = cross(y, b.facet);
    vector h = normalize(view + light);
    vector l = vector(dot(x, light), dot(y, light), dot(b.facet, light));
    vector v = vector(dot(x, view), dot(y, view), dot(b.facet, view));
    float hz = dot(b.facet, h);
    if (l[2] <= 0.0 || v[2] <= 0.0 || hz <= 0.0)
        return 0.0;
    float hx = dot(x, h) / (hz * b.alpha_x);
    float hy = dot(y, h) / (hz * b.alpha_y);
    float d = exp(-hx * hx - hy * hy) / (M_PI * b.alpha_x * b.alpha_y * hz * hz * hz * hz);
    return d / (4.0 * v[2] * (1.0 + bell_lambda(v, b.alpha_x, b.alpha_y) + bell_lambda(l, b.alpha_x, b.alpha_y)));
}

float bells_value(Bells b, vector view, vector light)
{
    float sum = 0.0;
    for (int i = 0; i < b.count; i += 1)
        sum += b.all[i].weight * bell_value(b.all[i], view, light);
    return sum;
}

closure color bell_closure(Bell b, Frame f, color tint)
{
    return b.weight * tint * microfacet("beckmann", normalize(to_world(f, b.facet)), normalize(to_world(f, b.along)),
                                        b.alpha_x, b.alpha_y, 0.0, 0);
}

// The standard deviation of a lump along either axis, in parts of its radius.
float lump_deviation(float n) { return inversesqrt(2.0 * (n + 2.0)); }

void add_bell(Disk d, Lump p, float x, float y, float deviation, float weight, output Bells b)
{
    Spot s;
    if (disk_spot(d, lump_point(p, x, y), s)) {
        b.all[b.count] = make_bell(d, p, s, deviation, deviation, weight);
        b.count += 1;
    }
}

// How much the disk's map changes over one standard deviation of the lump: 0 where it is affine.
float bending(Disk d, Lump p, Spot s, float deviation)
{
    vector view = d.frame.view;
    vector a = half_step(d, s, deviation * p.radii[0] * p.along);
    vector b = half_step(d, s, deviation * p.radii[1] * p.across);
    vector growth = disk_growth(d, s);
    return hypot(dot(growth, a), dot(growth, b)) + 0.3 * (dot(a, a) + dot(b, b));
}

void make_bells(Disk d, Lump p, float shares[], output Bells b)
{
    float v = 1.0 / (p.n + 1.0);
    float deviation = lump_deviation(p.n);
    b.count = 0;
    b.share = 0.0;
    Spot s;
    float bent = disk_spot(d, p.centre, s) ? bending(d, p, s, deviation) : 10.0;
    if (bent > 1.5)
        return;
    b.share = 1.0 - clamp(BENT * bent, 0.0, 0.6);
    if (v < SLENDER && bent < STRAIGHT) {
        add_bell(d, p, 0.0, 0.0, deviation, b.share * (1.0 - 0.8 * v), b);
        return;
    }
    float at = BELLS_PER_UNIT * v;
    int i = min((int)at, BELLS_PER_UNIT - 1);
    float blend = at - i;
    float q[8];
    for (int k = 0; k < 8; k += 1)
        q[k] = mix(shares[8 * i + k], shares[8 * i + 8 + k], blend);
    add_bell(d, p, 0.0, 0.0, q[1] * deviation, b.share * q[0], b);
    for (int k = 0; k < RING; k += 1) {
        float phi = M_2PI * k / RING;
        add_bell(d, p, q[3] * deviation * cos(phi), q[3] * deviation * sin(phi), q[4] * deviation, b.share * q[2] / RING, b);
        phi += M_PI / RING;
        add_bell(d, p, q[6] * deviation * cos(phi), q[6] * deviation * sin(phi), q[7] * deviation, b.share * q[5] / RING, b);
    }
}

// Laplacian of unit_lump.
float lump_curvature(vector at, float n)
{
    float r2 = dot(at, at);
    float inside = 1.0 - r2;
    if (inside <= 0.0)
        return 0.0;
    return (n + 1.0) / M_PI * 4.0 * n * pow(inside, n - 2.0) * ((n - 1.0) * r2 - inside);
}

closure color estimate_lump(Disk d, Lump p, color tint, vector numbers, int count, float spread, float shares[])
{
    Bells b;
    make_bells(d, p, shares, b);
    closure color sum = 0;
    float owed = 0.0;
    float drawn_n = DRAWN_N * p.n;
    float drawn_r = DRAWN_R;
    float deviation = lump_deviation(p.n);
    for (int k = 0; k < count; k += 1) {
        float r = drawn_r * sqrt(max(1.0 - pow(max(lattice_u(numbers, k, count), 1e-7), 1.0 / (drawn_n + 1.0)), 0.0));
        float phi = M_2PI * lattice_v(numbers, k);
        vector at = r * vector(cos(phi), sin(phi), 0.0);
        float q = unit_lump(at / drawn_r, drawn_n) / (drawn_r * drawn_r);
        Spot s;
        if (disk_spot(d, lump_point(p, at[0], at[1]), s) && q > 0.0) {
            float wide = spread * min(WIDEST * deviation, max(TO_EDGE * (1.0 - r), p.n >= 1.0 ? EDGE_LEAST * deviation : 0.0));
            float left = unit_lump(at, p.n)
                       - bells_value(b, d.frame.view, s.light) * p.radii[0] * p.radii[1] / s.stretch;
            if (p.n >= 2.0)
                left -= (1.0 - b.share) * 0.5 * wide * wide * lump_curvature(at, p.n);
            float weight = min(left / q, HEAVIEST) / count;
            if (weight > 0.0)
                sum = bell_closure(make_bell(d, p, s, wide, wide, weight), d.frame, tint) + sum;
            else
                owed -= weight;
        }
    }
    float total = 0.0;
    for (int i = 0; i < b.count; i += 1)
        total += b.all[i].weight;
    float kept = max(1.0 - owed / max(total, 1e-3), 0.0);
    for (int i = 0; i < b.count; i += 1)
        sum = bell_closure(b.all[i], d.frame, kept * tint) + sum;
    return sum;
}
