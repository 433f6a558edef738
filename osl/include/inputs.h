// From the sockets to what the estimator takes: every input is held to its range, so that no value, however driven,
// renders a NaN.

float exponent_of_roughness(float roughness)
{
    float alpha = max(roughness, 1e-4) * max(roughness, 1e-4);
    return 2.0 / (alpha * alpha) - 2.0;
}

float input_exponent(float exponent, int use_roughness, float roughness)
{
    return clamp(use_roughness ? exponent_of_roughness(roughness) : exponent, 1.0, 100000.0);
}

// A number held to its range; what is none is `otherwise`.
float input_number(float value, float least, float most, float otherwise)
{
    return isnan(value) ? otherwise : clamp(value, least, most);
}

Colour input_colour(int choice, color f0, color f90, color n, color k)
{
    Colour c;
    c.choice = clamp(choice, 0, 2);
    c.f0 = clamp(f0, color(0.0), color(1.0));
    c.f90 = clamp(f90, color(0.0), color(1.0));
    c.n = clamp(n, color(1e-3), color(20.0));
    c.k = clamp(k, color(0.0), color(40.0));
    return c;
}

// What a hit shows when its numbers cannot be used: magenta and black stripes. Not emission: a shader that could emit
// makes Cycles sample the whole mesh as a lamp, at the cost of all the others.
closure color stripes()
{
    color stripe = mod(floor(8.0 * (P[0] + P[1] + P[2])), 2.0) < 1.0 ? color(1.0, 0.0, 1.0) : color(0.0);
    return stripe * diffuse(N);
}

closure color broken_table(string file)
{
    warning("Plausible BRDF: albedo table %s is missing, stale, unreadable or not baked for this exponent; bake it or choose its file\n", file);
    return stripes();
}

closure color stale_weights(string model)
{
    warning("Plausible BRDF: %s was baked for other parameters than its sockets have; bake its weights again\n", model);
    return stripes();
}

float input_spread(float light_spread) { return input_number(light_spread, 0.0, 2.0, 1.0); }

color input_color(color value) { return clamp(value, color(0.0), color(1.0)); }
