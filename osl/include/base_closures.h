// The base lobes of base.h: their value towards a light, their energy, and their closures.

#define LEAST_COSINE 1e-9  // least squared cosine of a half vector to a facet
#define LEAST_ENERGY 1e-3  // smallest divisor for the base's energy
// Cycles samples closures in proportion to their weights. A ramp's weight is its energy, with these bounds:
#define DRAWN_SIZE 0.1     // at least this part of its absolute size
#define DRAWN_MENDING 0.3  // times this, for all ramps but the first: they only correct the first one's shape
#define DRAWN_LEAST 2e-3   // at least this

// f (N.L) of one microfacet closure.
float beckmann(vector facet, float alpha2, vector view, vector light, vector h)
{
    float nl = dot(facet, light);
    float nv = max(dot(facet, view), LEAST_VIEW);
    float cos2 = dot(facet, h) * dot(facet, h);
    if (nl <= 0.0 || cos2 < LEAST_COSINE)
        return 0.0;
    // Slopes of the light and of the view; D G2 / (4 N.V).
    float hidden = 1.0 + beckmann_lambda(alpha2 * max(1.0 / (nl * nl) - 1.0, 0.0))
                 + beckmann_lambda(alpha2 * max(1.0 / (nv * nv) - 1.0, 0.0));
    return exp((1.0 - 1.0 / cos2) / alpha2) / (4.0 * nv * M_PI * alpha2 * cos2 * cos2 * hidden);
}

// Sum of the base's closures towards a light, N.L included, as Cycles evaluates them.
float base_value(Base b, vector view, vector light, vector h)
{
    float sum = 0.0;
    for (int i = 0; i < BASE_RAMPS; i += 1) {
        if (b.sets[i] >= 0) {
            float e = b.exponent[i];
            vector away = b.axis[i] - light;
            float power = power_of_rest(0.5 * dot(away, away), e);
            float x = (LEVELS - 1) * min(power, 1.0);
            int k = min((int)x, LEVELS - 2);
            int at = SLOTS * b.sets[i] + k;
            sum += mix(b.level[at], b.level[at + 1], x - k) * (e + 2.0) / M_2PI * power
                 * max(dot(b.facet[i], light), 0.0);
        }
    }
    for (int i = 0; i < BASE_FACETS; i += 1)
        if (b.weight[i] > 0.0)
            sum += b.weight[i] * beckmann(b.tilted[i], b.alpha2[i], view, light, h);
    return sum;
}

// The cosine factor of a ramp: its energy is the mean of its colors times this.
float ramp_cosine(Base b, int i)
{
    return min(dot(b.facet[i], b.axis[i]) + BASE_GRAZING * inversesqrt(b.exponent[i]), 1.0);
}

// Albedo of all base lobes together.
float base_energy(Base b)
{
    float sum = 0.0;
    for (int i = 0; i < BASE_RAMPS; i += 1)
        if (b.sets[i] >= 0)
            sum += b.mean[b.sets[i]] * ramp_cosine(b, i);
    for (int i = 0; i < BASE_FACETS; i += 1)
        sum += b.weight[i];
    return max(sum, LEAST_ENERGY);
}

closure color base_closures(Base b, Frame f, color tint)
{
    closure color sum = 0;
    for (int i = 0; i < BASE_RAMPS; i += 1) {
        if (b.sets[i] >= 0) {
            int first = SLOTS * b.sets[i];
            // Cycles samples closures by their weights, not their colors: the weight is the energy, and smaller where
            // the closure only corrects the first one's shape. Negative ones are sampled as well: where they have
            // positive values, no other closure may have any.
            float drawn = max(b.mean[b.sets[i]], DRAWN_SIZE * b.size[b.sets[i]]) * ramp_cosine(b, i);
            float weight = max(i == 0 ? drawn : DRAWN_MENDING * drawn, DRAWN_LEAST);
            float share = 1.0 / weight;
            color colours[LEVELS];
            for (int k = 0; k < LEVELS; k += 1)
                colours[k] = share * b.level[first + k];
            sum += SPOILT_BASE(weight) * tint * phong_ramp(normalize(to_world(f, b.facet[i])), b.exponent[i], colours);
        }
    }
    for (int i = 0; i < BASE_FACETS; i += 1)
        if (b.weight[i] > 0.0)
            sum += b.weight[i] * tint
                 * microfacet("beckmann", normalize(to_world(f, b.tilted[i])), sqrt(b.alpha2[i]), 0.0, 0);
    return sum;
}
