// How a BRDF gets into Cycles: base lobes near the target, and narrow splats for what they leave over.
//
// A Cycles shader knows the view and never the light; it returns closures, and Cycles evaluates them. So the shader
// plays a round of Monte Carlo itself: it draws directions c_1 .. c_K with the density p and returns
//
//     base(L) + sum_k (target(c_k) - base(c_k)) / (K p(c_k)) * splat about c_k
//
// whose expectation over the draws is the target f(V, L) (N.L), blurred only by the splat's width and only where the
// base is not the target. A splat is a narrow phong_ramp of energy 1, lit by every light and sampled by Cycles with its
// exact density. p is wider than the lobe, as the remainder is. Weights are held to HEAVIEST.
//
// Where the base is above the target the splat is a hole: it takes away, and is kept so wide that it is nowhere deeper
// than the base is high, so that no sample of any light is negative. What no hole can take away, far out on a lobe, is
// taken from the base as a whole: light is moved within the lobe, but none is made.
//
// A model includes one lobe_*.h, hit.h, one correction_*.h, base.h and base_closures.h before this.

#define NARROWEST 1.2e-3  // radians: in single precision narrower phong_ramps lose their shape
#define LARGE_RESIDUAL 0.08    // of the energy: where all samples per hit are drawn; proportionally less for
#define WIDE 0.22         // radians: lobes wider than this, next to which splats are small
#define SMALL_RESIDUAL 0.003 // of the energy: with less, splats are drawn at fewer hits, and are heavier
#define NO_RESIDUAL 1e-4    // of the energy: there are no splats
#define HEAVIEST 2.0      // weight of all splats of a hit, in parts of the light that comes in
#define UNSEEN 1e-5       // weight of a splat that is left out

// A splat blurs what is left over. Its radius is the least of
#define WIDEST 0.2        // of the lobe's width
#define BLUR 0.004        // of the lobe's width, over the part of the energy that is left over
// and, as the target has a crease where N.L = N.V, of the greater of
#define CREASE 0.025      // radians, over tan(theta), as the slope changes there, and the root of the lobe's height
#define APART 0.3         // of the angle to the crease
#define ABOVE_HORIZON 3.0 // radii that its middle lies above the horizon

// A hole is flat and has an edge: its depth falls to SHOULDER of what it is in the middle at NEGATIVE_SHOULDER
// radii, to 0 at NEGATIVE_EDGE.
#define SHOULDER 0.57
#define NEGATIVE_SHOULDER 1.06
#define NEGATIVE_LEVEL 2.0    // of the inner four of its eight levels: their energy is a half
#define NEGATIVE_DEPTH 0.9    // of what a hole may be deep
#define NEGATIVE_WIDER 1.1    // than it must be

// Least numbers that are divided by.
#define LEAST_SINE 1e-6   // of the view
#define LEAST_HL 1e-3     // H.L
#define LEAST_LOBE 1e-9   // the lobe's height,
#define LEAST_PART 1e-6   // in parts of its peak
#define LEAST_TINT 1e-6

float largest(color c) { return max(c[0], max(c[1], c[2])); }

// A phong_ramp of energy 1 about c. Its profile is that of a bell, with the standard deviation `radius` across each of
// two directions, or, as a hole, the top of one.
closure color ramp_kernel(Hit hit, vector c, color weight, float radius, int negative)
{
    vector h = normalize(hit.frame.view + c);
    float exponent = 1.0 / (radius * radius);
    float size = largest(abs(weight));
    // (e+2)/(2 pi) (R.L)^e (H.L) over the sphere is H.c. The closure's own weight must be positive.
    color shade = weight / (size * max(dot(h, c), LEAST_HL));
    color far = negative ? color(0.0) : shade;
    color near = negative ? NEGATIVE_LEVEL * shade : shade;
    color colours[LEVELS] = {far, far, far, far, near, near, near, near};
    return size * phong_ramp(normalize(to_world(hit.frame, h)), exponent, colours);
}

// How deep a hole at c may be, 0 to 1 of the base's height there, so that its shoulders are not deeper than the base:
// it is taken to fall as the lobe does, away from the mirror direction and towards the horizon.
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

// What is the same for all splats of a hit.
struct Aim {
    Draws draws;
    color tint;      // of the base
    float n;         // exponent of the lobe that lights are drawn from
    float width;     // of the hit's lobe
    float widest;    // splat
    float peak;      // of the lobe
    float on_crease; // radius of a splat there, where the lobe is as high as its peak
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

// A light that a splat is drawn at.
struct Drawn {
    vector light;
    float density;
    float height;  // sine of the angle above the lower of the shading and the geometric horizon
};

// What no hole can take away of `weight`, which becomes what it does; `radius` becomes the hole's. `based` is the base
// at the light, and `most` the largest part of the base's colour that is to be taken away.
color limit_negative(Hit hit, Aim aim, Drawn at, float based, float most, output float radius, output color weight)
{
    int count = aim.draws.count;
    // All holes of a hit may lie upon each other: each has a part of the height.
    float wide = sqrt(most * count / (M_PI * max(based, LEAST_LOBE)));
    radius = min(max(radius, NEGATIVE_WIDER * wide), min(BASE_NEGATIVE_RADIUS * aim.width, at.height / NEGATIVE_EDGE));
    float deepest = NEGATIVE_DEPTH * max(based, 0.0) * slope(hit, at.light, radius) / count;
    float share = min(M_PI * radius * radius * deepest / most, 1.0);
    color taken = min(weight, color(0.0));
    color excess = (1.0 - share) * taken;
    weight -= excess;
    return excess;
}

// The splat at a light; what should be taken away and cannot be is added to `excess`.
closure color kernel_at(Drawn at, Hit hit, Aim aim, Colour colour, Base base, output color excess, CORRECTION_PARAMETERS)
{
    vector view = hit.frame.view;
    vector light = at.light;
    vector h = normalize(view + light);
    // What the base leaves of the target, over the density.
    float lobe = lobe_value(view, light, hit.n);
    float value = SPOILT_TARGET(lobe) * light[2] / correction(light[2], CORRECTION);
    float based = base_value(base, view, light, h);
    color residual = value * fresnel_factor(colour, dot(view, h)) - based * aim.tint;
    float drawn = aim.draws.chance * at.density;
    color weight = SPOILT_KERNEL(clamp(residual / drawn, -HEAVIEST, HEAVIEST) / aim.draws.count);
    // Its radius, by how fast the target changes.
    float crease = max(aim.on_crease * sqrt(aim.peak / max(lobe, LEAST_PART * aim.peak)),
                       APART * abs(acos(min(light[2], 1.0)) - hit.theta));
    float radius = aim.draws.spread
                 * min(sqrt(0.5 / (M_PI * aim.draws.count * at.density)), min(aim.widest, crease));
    // Little of a splat may reach below the horizon.
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

// The splats of a hit that has them; `excess` is what should be taken away and cannot be.
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
    // Nothing is left over where the base is exact: plain Phong, without a Fresnel factor that changes over the lobe.
    Draws draws = requested;
    draws.count = clamp((int)ceil(requested.count * residual / (LARGE_RESIDUAL * min(WIDE * sqrt(hit.m), 1.0))), 1, requested.count);
    draws.chance = min(residual / SMALL_RESIDUAL, 1.0);
    if (!KERNELS || residual <= NO_RESIDUAL || requested.numbers[1] >= draws.chance)
        return base_closures(base, hit.frame, tint);
    // The number that decided is uniform again below what it was held against.
    draws.numbers = vector(requested.numbers[0], requested.numbers[1] / draws.chance, 0.0);
    color excess;
    closure color sum = kernels(hit, make_aim(hit, draws, tint, residual), colour, base, excess, CORRECTION);
    if (largest(excess) > 0.0)
        tint = max(tint - excess / base_energy(base), color(0.0));
    return sum + base_closures(base, hit.frame, tint);
}
