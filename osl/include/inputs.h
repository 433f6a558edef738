// The sockets' values, clamped to their ranges: no value, however driven, renders a NaN. The assembler writes LEAST_,
// MOST_ and DEFAULT_ of each parameter from the model's declaration.

// HELD: a count, a choice, or a number. NUMBER: a number whose NaN becomes the default. COLOR: a color.
#define HELD(id) clamp(id, LEAST_##id, MOST_##id)
#define NUMBER(id) input_number(id, LEAST_##id, MOST_##id, DEFAULT_##id)
#define COLOR(id) clamp(id, color(LEAST_##id), color(MOST_##id))

// Values that several models compute from the same sockets.
#define DRAWS(numbers) input_draws(numbers, HELD(samples), NUMBER(light_spread))
#define INPUT_COLOUR { HELD(fresnel_type), COLOR(base_color), COLOR(f90), \
                       clamp(ior, color(LEAST_IOR), color(MOST_ior)), COLOR(extinction) }

#define STRIPES_PER_UNIT 8.0  // stripes of an error, per unit of the scene

float exponent_of_roughness(float roughness)
{
    float alpha = max(roughness, LEAST_ROUGHNESS) * max(roughness, LEAST_ROUGHNESS);
    return BECKMANN_POWER / (alpha * alpha) - BECKMANN_POWER;
}

float input_exponent(float exponent, int use_roughness, float roughness)
{
    return clamp(use_roughness ? exponent_of_roughness(roughness) : exponent, MIN_EXPONENT, MAX_EXPONENT);
}

// Clamps to [least, most]; NaN becomes `otherwise`.
float input_number(float value, float least, float most, float otherwise)
{
    return isnan(value) ? otherwise : clamp(value, least, most);
}

// The shading normal. An unlinked socket holds zeros, which stand for the surface's own normal.
normal input_normal(normal shading)
{
    return dot(shading, shading) > NO_LENGTH2 ? normalize(shading) : N;
}

Draws input_draws(vector numbers, int count, float spread)
{
    Draws draws = { numbers, count, 1.0, spread };
    return draws;
}

// Magenta and black stripes, for a hit whose numbers cannot be used. They are not emission: a shader that could emit
// makes Cycles sample the whole mesh as a lamp, at the cost of all other lamps.
closure color stripes()
{
    color stripe = mod(floor(STRIPES_PER_UNIT * (P[0] + P[1] + P[2])), 2.0) < 1.0 ? color(1.0, 0.0, 1.0) : color(0.0);
    return stripe * diffuse(N);
}

closure color broken_table(string file)
{
    warning("Plausible BRDF: albedo table %s is missing, stale, unreadable or not baked for this exponent; bake it or choose its file\n", file);
    return stripes();
}

closure color stale_rows(string model)
{
    warning("Plausible BRDF: %s was baked for other parameters than its sockets have; bake it again\n", model);
    return stripes();
}
