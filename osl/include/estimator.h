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
// A model includes one lobe_*.h, hit.h, one correction_*.h and base.h before this.

#define NARROWEST 1.2e-3  // radians: in single precision narrower phong_ramps lose their shape
#define MUCH_LEFT 0.08    // of the energy: where all samples per hit are drawn; proportionally less for
#define WIDE 0.22         // radians: lobes wider than this, next to which splats are small
#define LITTLE_LEFT 0.003 // of the energy: with less, splats are drawn at fewer hits, and are heavier
#define HEAVIEST 2.0      // weight of all splats of a hit, in parts of the light that comes in
#define UNSEEN 1e-5       // weight of a splat that is left out

// A splat blurs what is left over. Its radius is the least of
#define WIDEST 0.2        // of the lobe's width
#define BLUR 0.004        // of the lobe's width, over the part of the energy that is left over
// and, as the target has a crease where N.L = N.V, of the greater of
#define CREASE 0.025      // radians, over tan(theta), by which the slope changes there, and the root of the lobe's height
#define APART 0.3         // of the angle to the crease

// A hole is flat and has an edge: its depth falls to SHOULDER of what it is in the middle at 1.06 radii, to 0 at 1.30.
#define SHOULDER 0.57
#define HOLE_SHOULDER 1.06
#define HOLE_EDGE 1.30

float largest(color c) { return max(c[0], max(c[1], c[2])); }

// A phong_ramp of energy 1 about c. Its profile is that of a bell, with the standard deviation `radius` across each of
// two directions, or, as a hole, the top of one.
closure color splat(Hit hit, vector c, color weight, float radius, int hole)
{
    vector h = normalize(hit.frame.view + c);
    float exponent = 1.0 / (radius * radius);
    float size = largest(abs(weight));
    // (e+2)/(2 pi) (R.L)^e (H.L) over the sphere is H.c. The closure's own weight must be positive.
    color shade = weight / (size * max(dot(h, c), 1e-3));
    color far = hole ? color(0.0) : shade;
    color near = hole ? 2.0 * shade : shade;  // the energy of the inner four of eight levels is a half
    color colours[8] = {far, far, far, far, near, near, near, near};
    return size * phong_ramp(normalize(to_world(hit.frame, h)), exponent, colours);
}

// How deep a hole at c may be, 0 to 1 of the base's height there, so that its shoulders are not deeper than the base: it
// is taken to fall as the lobe does, away from the mirror direction and towards the horizon.
float slope(Hit hit, vector c, float radius)
{
    vector outward = c - mirror_of(hit.frame.view);
    vector down = vector(c[0] * c[2], c[1] * c[2], c[2] * c[2] - 1.0);
    float low = SHOULDER;
    for (int side = 0; side < 2; side += 1) {
        vector way = side ? down : outward;
        vector shoulder = normalize(c + HOLE_SHOULDER * radius * normalize(way - dot(way, c) * c));
        low = min(low, lobe_value(hit.frame.view, shoulder, hit.n) * shoulder[2]
                       / max(lobe_value(hit.frame.view, c, hit.n) * c[2], 1e-9));
    }
    return max(low, 0.0) / SHOULDER;
}

// The splats of a hit that has them, by `chance`; `owed` is what should be taken away and cannot be.
closure color splats(Hit hit, Correction c, Base base, color tint, Colour colour, vector numbers, int count,
                     float chance, float spread, float left_over, normal geometric, output color owed,
                     TABLE(plain), TABLE(controlled))
{
    closure color sum = 0;
    owed = 0.0;
    vector view = hit.frame.view;
    vector up = vector(dot(geometric, hit.frame.x), dot(geometric, hit.frame.y), dot(geometric, hit.frame.z));
    float width = lobe_width(view[2], hit.n);
    float widest = min(WIDEST, BLUR / left_over) * width;
    float peak = lobe_value(view, mirror_of(view), hit.n);
    float on_crease = CREASE * view[2] / max(view[0], 1e-6);
    float n = BASE_DRAWN * hit.n;
    for (int k = 0; k < count; k += 1) {
        vector light = lobe_draw(view, lattice_u(numbers, k, count), lattice_v(numbers, k), n);
        float density = lobe_density(view, light, n);
        // Sines of the heights above the shading and the geometric horizon; little of a splat may reach below either.
        float height = min(light[2], dot(light, up));
        if (height > 0.0 && density > 0.0) {
            vector h = normalize(view + light);
            float lobe = lobe_value(view, light, hit.n);
            float value = lobe * light[2] / correction(c, light[2], plain, controlled);
            float based = base_value(base, view, light, h);
            color left = value * fresnel_factor(colour, dot(view, h)) - based * tint;
            float drawn = chance * density;
            color weight = clamp(left / drawn, -HEAVIEST, HEAVIEST) / count;
            float crease = max(on_crease * sqrt(peak / max(lobe, 1e-6 * peak)),
                               APART * abs(acos(min(light[2], 1.0)) - hit.theta));
            float radius = spread * min(sqrt(0.5 / (M_PI * count * density)), min(widest, crease));
            // The largest part of the base's colour that is to be taken away.
            float most = largest(max(-weight / max(tint, color(1e-6)), color(0.0)));
            int hole = most > 0.0;
            if (hole && spread > 0.0) {
                // All holes of a hit may lie upon each other: each has a part of the height.
                float wide = sqrt(most * count / (M_PI * max(based, 1e-9)));
                radius = min(max(radius, 1.1 * wide), min(BASE_HOLE * width, height / HOLE_EDGE));
                float deepest = 0.9 * max(based, 0.0) * slope(hit, light, radius) / count;
                float kept = min(M_PI * radius * radius * deepest / most, 1.0);
                color taken = min(weight, color(0.0));
                owed -= (1.0 - kept) * taken;
                weight -= (1.0 - kept) * taken;
            } else
                radius = min(radius, height / 3.0);
            if (largest(abs(weight)) > UNSEEN)
                sum += splat(hit, light, weight, max(radius, NARROWEST), hole);
        }
    }
    return sum;
}

closure color estimate(Hit hit, Correction c, Colour colour, vector numbers, int count, float spread, normal geometric,
                       TABLE(plain), TABLE(controlled), BASE_PARAMETERS)
{
    Base base;
    make_base(base, hit, c, plain, controlled, BASE_ARGUMENTS);
    color tint;
    float left = base.left + fresnel_change(colour, hit.theta, inversesqrt(hit.m), tint);
    int draws = clamp((int)ceil(count * left / (MUCH_LEFT * min(WIDE * sqrt(hit.m), 1.0))), 1, count);
    // Nothing is left over where the base is exact: plain Phong, without a Fresnel factor that changes over the lobe.
    float chance = min(left / LITTLE_LEFT, 1.0);
    if (left <= 1e-4 || numbers[1] >= chance)
        return base_closures(base, hit.frame, tint);
    vector drawn = vector(numbers[0], numbers[1] / chance, 0.0);
    color owed;
    closure color sum = splats(hit, c, base, tint, colour, drawn, draws, chance, spread, left, geometric, owed,
                               plain, controlled);
    if (largest(owed) > 0.0)
        tint = max(tint - owed / base_energy(base), color(0.0));
    return sum + base_closures(base, hit.frame, tint);
}
