// The estimator: base lobes near the target, and narrow kernels for the residual, target minus base.
//
// A Cycles shader knows the view and never the light. It returns closures, and Cycles evaluates them. So the shader
// does Monte Carlo itself: it samples directions c_1 .. c_K with the density p and returns
//
//     base(L) + sum_k (target(c_k) - base(c_k)) / (K p(c_k)) * kernel about c_k
//
// The expectation over the samples is the target f(V, L) (N.L). Only the residual is blurred, by the kernel's width.
// A kernel (a "splat" of computer graphics) is a narrow phong_ramp of energy 1. Every light reaches it, and Cycles
// samples it with its exact density. p is wider than the lobe, as the residual is. Weights are clamped to HEAVIEST.
//
// Where the base is above the target, the kernel is negative. It is so wide that it is nowhere deeper than the base is
// high: no sample of any light is negative. The excess that negative kernels cannot take away, far out on a lobe, is
// taken from the whole base. This moves light within the lobe, and makes none.
//
// A model includes one lobe_*.h, hit.h, one correction_*.h, base.h and base_closures.h before this.

#define NARROWEST 1.2e-3      // radius in radians: single precision loses the shape of narrower phong_ramps
#define LARGE_RESIDUAL 0.08   // share of the energy from which on a hit takes all samples; for wide lobes it is smaller
#define WIDE 0.22             // width in radians from which on a lobe is wide: kernels are small in comparison
#define SMALL_RESIDUAL 0.003  // share of the energy below which fewer hits have kernels, and these are heavier
#define NO_RESIDUAL 1e-4      // share of the energy below which no hit has kernels
#define HEAVIEST 2.0          // largest weight of all kernels of a hit, in parts of the incident light
#define UNSEEN 1e-5           // kernels with a smaller weight are skipped

// A kernel blurs the residual. Its radius is the smallest of WIDEST, BLUR and a bound from the crease: the target has a
// crease where N.L = N.V. That bound is the larger of CREASE and APART.
#define WIDEST 0.2         // in parts of the lobe's width
#define BLUR 0.004         // in parts of the lobe's width, divided by the residual's share of the energy
#define CREASE 0.025       // radians on the crease: divided by tan(theta), as the slope changes there, and by the root
                           // of the lobe's height
#define APART 0.3          // in parts of the angle to the crease
#define ABOVE_HORIZON 3.0  // least height of a kernel's middle above the horizon, in radii

// A negative kernel is flat and has an edge. At NEGATIVE_SHOULDER radii its depth is SHOULDER of the depth in the
// middle, and at NEGATIVE_EDGE radii it is 0.
#define SHOULDER 0.57
#define NEGATIVE_SHOULDER 1.06
#define NEGATIVE_LEVEL 2.0  // the inner four of its eight levels, in which half of the energy lies
#define NEGATIVE_DEPTH 0.9  // its depth, in parts of the allowed depth
#define NEGATIVE_WIDER 1.1  // its radius, in parts of the smallest allowed radius

// Smallest divisors.
#define LEAST_SINE 1e-6  // the view's sine
#define LEAST_HL 1e-3    // H.L
#define LEAST_LOBE 1e-9  // the lobe's height
#define LEAST_PART 1e-6  // the lobe's height, in parts of its peak
#define LEAST_TINT 1e-6  // the base's color

float largest(color c) { return max(c[0], max(c[1], c[2])); }

// A phong_ramp of energy 1 about c. Its profile is a bell with the standard deviation `radius` along each of two
// directions. The profile of a negative kernel is the bell's top.
closure color ramp_kernel(Hit hit, vector c, color weight, float radius, int negative)
{
    vector h = normalize(hit.frame.view + c);
    float exponent = 1.0 / (radius * radius);
    float size = largest(abs(weight));
    // The integral of (e+2)/(2 pi) (R.L)^e (H.L) over the sphere is H.c.
    // The sign goes into the levels: the closure's own weight must be positive.
    color shade = weight / (size * max(dot(h, c), LEAST_HL));
    color far = negative ? color(0.0) : shade;
    color near = negative ? NEGATIVE_LEVEL * shade : shade;
    color colours[LEVELS] = {far, far, far, far, near, near, near, near};
    return size * phong_ramp(normalize(to_world(hit.frame, h)), exponent, colours);
}

// The allowed depth of a negative kernel at c, 0 to 1 of the base's height there: its shoulders must not be deeper than
// the base. The base is assumed to fall as the lobe does, away from the mirror direction and towards the horizon.
float slope(Hit hit, vector c, float radius)
{
    vector outward = c - mirror_of(hit.frame.view);
    vector down = vector(c[0] * c[2], c[1] * c[2], c[2] * c[2] - 1.0);
    float low = SHOULDER;
    for (int side = 0; side < 2; side += 1) {
        vector way = side ? down : outward;
        vector shoulder = normalize(c + NEGATIVE_SHOULDER * radius * normalize(way - dot(way, c) * c));
        low = min(low, lobe_value(hit.frame.view, shoulder, hit.n) * shoulder[2]
                       / max(lobe_value(hit.frame.view, c, hit.n) * c[2], LEAST_LOBE));
    }
    return max(low, 0.0) / SHOULDER;
}

// The numbers that all kernels of a hit share.
struct Aim {
    Draws draws;
    color tint;       // color factor of the base
    float n;          // exponent of the lobe that lights are sampled from
    float width;      // width of the hit's lobe
    float widest;     // radius of the widest kernel
    float peak;       // the lobe's height in the mirror direction
    float on_crease;  // radius of a kernel on the crease, where the lobe is as high as its peak
};

Aim make_aim(Hit hit, Draws draws, color tint, float residual)
{
    vector view = hit.frame.view;
    Aim aim;
    aim.draws = draws;
    aim.tint = tint;
    aim.n = BASE_DRAWN * hit.n;
    aim.width = lobe_width(view[2], hit.n);
    aim.widest = min(WIDEST, BLUR / residual) * aim.width;
    aim.peak = lobe_value(view, mirror_of(view), hit.n);
    aim.on_crease = CREASE * view[2] / max(view[0], LEAST_SINE);
    return aim;
}

// The light direction about which a kernel lies.
struct Drawn {
    vector light;
    float density; // probability density of the direction
    float height;  // sine of the angle above the lower of the shading and the geometric horizon
};

// Limits a negative kernel's `weight` and `radius` so that the kernel is nowhere deeper than the base. Returns the
// excess: the part of `weight` that the kernel cannot take away. `based` is the base's value at the light, and `most`
// the largest channel of -`weight`, in parts of the base's color.
color limit_negative(Hit hit, Aim aim, Drawn at, float based, float most, output float radius, output color weight)
{
    int count = aim.draws.count;
    // All negative kernels of a hit may overlap: each may use a part of the base's height.
    float wide = sqrt(most * count / (M_PI * max(based, LEAST_LOBE)));
    radius = min(max(radius, NEGATIVE_WIDER * wide), min(BASE_NEGATIVE_RADIUS * aim.width, at.height / NEGATIVE_EDGE));
    // The share of the weight that a kernel of this radius and depth holds.
    float deepest = NEGATIVE_DEPTH * max(based, 0.0) * slope(hit, at.light, radius) / count;
    float share = min(M_PI * radius * radius * deepest / most, 1.0);
    color taken = min(weight, color(0.0));
    color excess = (1.0 - share) * taken;
    weight -= excess;
    return excess;
}

// The kernel at a light. The part of its negative weight that it cannot take away is added to `excess`.
closure color kernel_at(Drawn at, Hit hit, Aim aim, Colour colour, Base base, output color excess,
                        CORRECTION_PARAMETERS)
{
    vector view = hit.frame.view;
    vector light = at.light;
    vector h = normalize(view + light);
    // The weight: the residual over the density, and over the number of kernels.
    float lobe = lobe_value(view, light, hit.n);
    float value = SPOILT_TARGET(lobe) * light[2] / correction(light[2], CORRECTION);
    float based = base_value(base, view, light, h);
    color residual = value * fresnel_factor(colour, dot(view, h)) - based * aim.tint;
    float drawn = aim.draws.chance * at.density;
    color weight = SPOILT_KERNEL(clamp(residual / drawn, -HEAVIEST, HEAVIEST) / aim.draws.count);
    // The radius: small where the target changes fast.
    float crease = max(aim.on_crease * sqrt(aim.peak / max(lobe, LEAST_PART * aim.peak)),
                       APART * abs(acos(min(light[2], 1.0)) - hit.theta));
    float radius = aim.draws.spread
                 * min(sqrt(0.5 / (M_PI * aim.draws.count * at.density)), min(aim.widest, crease));
    // A negative kernel is limited by the base. Of the others little may reach below the horizon.
    float most = largest(max(-weight / max(aim.tint, color(LEAST_TINT)), color(0.0)));
    int negative = most > 0.0;
    if (negative && aim.draws.spread > 0.0)
        excess -= limit_negative(hit, aim, at, based, most, radius, weight);
    else
        radius = min(radius, at.height / ABOVE_HORIZON);
    closure color kernel = 0;
    if (largest(abs(weight)) > UNSEEN)
        kernel = ramp_kernel(hit, light, weight, max(radius, NARROWEST), negative);
    return kernel;
}

// The kernels of a hit. `excess` is the sum of the negative weights that they cannot take away.
closure color kernels(Hit hit, Aim aim, Colour colour, Base base, output color excess, CORRECTION_PARAMETERS)
{
    closure color sum = 0;
    excess = 0.0;
    vector view = hit.frame.view;
    for (int k = 0; k < aim.draws.count; k += 1) {
        vector light = lobe_draw(view, lattice_u(aim.draws.numbers, k, aim.draws.count),
                                 lattice_v(aim.draws.numbers, k), aim.n);
        float density = lobe_density(view, light, aim.n);
        AT_KERNEL(light, vector(density, aim.draws.chance, aim.draws.count), aim.draws.count)
        Drawn at = { light, density, min(light[2], dot(light, hit.up)) };
        if (at.height > 0.0 && density > 0.0)
            sum += kernel_at(at, hit, aim, colour, base, excess, CORRECTION);
    }
    return sum;
}

closure color estimate(Hit hit, Colour colour, Draws requested, CORRECTION_PARAMETERS, BASE_PARAMETERS)
{
    Base base;
    make_base(base, hit, CORRECTION, BASE_ARGUMENTS);
    color tint;
    float residual = base.residual + fresnel_change(colour, hit.theta, inversesqrt(hit.m), tint);
    // The residual is 0 where the base is exact: plain Phong, without a Fresnel factor that changes over the lobe.
    // Hits with a small residual take fewer samples, and some of them none.
    Draws draws = requested;
    draws.count = clamp((int)ceil(requested.count * residual / (LARGE_RESIDUAL * min(WIDE * sqrt(hit.m), 1.0))), 1,
                        requested.count);
    draws.chance = min(residual / SMALL_RESIDUAL, 1.0);
    if (!KERNELS || residual <= NO_RESIDUAL || requested.numbers[1] >= draws.chance)
        return base_closures(base, hit.frame, tint);
    // The number that chose whether the hit has kernels is uniform below `chance`: it is stretched for another use.
    draws.numbers = vector(requested.numbers[0], requested.numbers[1] / draws.chance, 0.0);
    // The kernels. The whole base pays for their excess.
    color excess;
    closure color sum = kernels(hit, make_aim(hit, draws, tint, residual), colour, base, excess, CORRECTION);
    if (largest(excess) > 0.0)
        tint = max(tint - excess / base_energy(base), color(0.0));
    return sum + base_closures(base, hit.frame, tint);
}
