// How a BRDF gets into Cycles: base lobes near the target, and narrow splats for what they leave over.
//
// A Cycles shader knows the view and never the light; it returns closures, and Cycles evaluates them. So the shader
// plays a round of Monte Carlo itself: it draws directions c_1 .. c_K with the density p and returns
//
//     base(L) + sum_k (target(c_k) - base(c_k)) / (K p(c_k)) * splat about c_k
//
// whose expectation over the draws is the target f(V, L) (N.L), blurred only by the splat's width and only where the
// base is not the target. A splat is a narrow phong_ramp of energy 1, lit by every light and sampled by Cycles with its
// exact density; what it adds may be negative. p is wider than the lobe, as the remainder is. Weights are held to HEAVIEST:
// what is beyond, far out on a lobe at grazing, is lost.
//
// A model includes one lobe_*.h, hit.h, one correction_*.h and base.h before this.

#define NARROWEST 1.2e-3  // radians: in single precision narrower phong_ramps lose their shape
#define SHALLOWEST 0.15   // radians: the widest splats that take away
#define MUCH_LEFT 0.04    // of the energy: where all samples per hit are drawn
#define HEAVIEST 2.0      // weight of all splats of a hit, in parts of the light that comes in
#define UNSEEN 1e-5       // weight of a splat that is left out

// A splat blurs what is left over, most of all the crease of the target where N.L = N.V. Its radius is the least of
#define WIDEST 0.3        // of the lobe's width
#define BLUR 0.0015       // of the lobe's width, over the part of the energy that is left over
#define CREASE 0.04       // radians, over tan(theta), by which the target's slope changes at the crease
#define BROADEST 0.045    // radians

// A phong_ramp of energy 1 about c: its standard deviation is `radius`, across each of two directions.
closure color splat(Hit hit, vector c, color weight, float radius)
{
    vector h = normalize(hit.frame.view + c);
    float exponent = 1.0 / (radius * radius);
    float size = max(abs(weight[0]), max(abs(weight[1]), abs(weight[2])));
    // (e+2)/(2 pi) (R.L)^e (H.L) over the sphere is H.c. The closure's own weight must be positive.
    color shade = weight / (size * max(dot(h, c), 1e-3));
    color colours[8] = {shade, shade, shade, shade, shade, shade, shade, shade};
    return size * phong_ramp(normalize(to_world(hit.frame, h)), exponent, colours);
}

closure color splats(Hit hit, Correction c, Base base, color tint, Colour colour, vector numbers, int count,
                     float spread, float left_over, normal geometric, TABLE(plain), TABLE(controlled))
{
    closure color sum = 0;
    vector view = hit.frame.view;
    vector up = vector(dot(geometric, hit.frame.x), dot(geometric, hit.frame.y), dot(geometric, hit.frame.z));
    float widest = min(min(WIDEST, BLUR / left_over) * lobe_width(view[2], hit.n),
                       min(CREASE * view[2] / max(view[0], 1e-6), BROADEST));
    float n = BASE_DRAWN * hit.n;
    for (int k = 0; k < count; k += 1) {
        vector light = lobe_draw(view, lattice_u(numbers, k, count), lattice_v(numbers, k), n);
        float density = lobe_density(view, light, n);
        // Sines of the heights above the shading and the geometric horizon; little of a splat may reach below either.
        float height = min(light[2], dot(light, up));
        if (height > 0.0 && density > 0.0) {
            vector h = normalize(view + light);
            float value = lobe_value(view, light, hit.n) * light[2] / correction(c, light[2], plain, controlled);
            float based = base_value(base, view, light, h);
            color left = value * fresnel_factor(colour, dot(view, h)) - based * tint;
            color weight = clamp(left / density, -HEAVIEST, HEAVIEST) / count;
            float radius = min(sqrt(0.5 / (M_PI * count * density)), widest);
            // What takes away is no deeper than the base is high, mostly: together they stay positive.
            float most = max(0.0, max(-left[0] / tint[0], max(-left[1] / tint[1], -left[2] / tint[2])));
            radius = max(radius, min(sqrt(0.5 * most / (M_PI * max(based, 1e-9) * count * density)), SHALLOWEST));
            if (max(abs(weight[0]), max(abs(weight[1]), abs(weight[2]))) > UNSEEN)
                sum += splat(hit, light, weight, max(min(spread * radius, 0.5 * height), NARROWEST));
        }
    }
    return sum;
}

closure color estimate(Hit hit, Correction c, Colour colour, vector numbers, int count, float spread, normal geometric,
                       TABLE(plain), TABLE(controlled), BASE_PARAMETERS)
{
    Base base;
    make_base(base, hit, c, plain, controlled, BASE_ARGUMENTS);
    color tint = fresnel_factor(colour, cos(hit.theta));
    float left = base.left + fresnel_change(colour, hit.theta, hit.reach);
    int draws = clamp((int)ceil(count * left / MUCH_LEFT), 1, count);
    closure color sum = base_closures(base, hit.frame, tint);
    // Nothing is left over where the base is exact: plain Phong, without a Fresnel factor that changes over the lobe.
    if (left > 1e-4)
        sum += splats(hit, c, base, tint, colour, numbers, draws, spread, left, geometric, plain, controlled);
    return sum;
}
