// Base lobes: Cycles' own closures that together are nearly the target; see addon/baking/base.py, which fits them.
// The BASE_* macros and the arrays base_* come from its file.
//
// Most are phong_ramp, whose colours make it any function of (R.L)^e: equidistant levels, which Cycles interpolates, and
// which it lets be negative.

#define LEVELS 8
#define SLOTS 9  // numbers of a ramp in the table: the levels and one more
#define BASE_PARAMETERS float widths[], float ramps[], float facets[], vector table[]
#define BASE_ARGUMENTS widths, ramps, facets, table
#define BASE_DATA base_widths, base_ramps, base_facets, base_table
#define SHARPEST 5e5  // exponent of a crease's phong_ramp
#define LEANEST 0.02  // lean of a facet times the lobe's width
#define FAINT 1e-4  // of the mirror direction's gain: closures with less are left out

struct Base {
    float left;                            // size of what the base leaves over, in parts of the target's energy
    int sets[BASE_RAMPS];                  // which levels a ramp has, -1: none
    vector axis[BASE_RAMPS];               // mirror direction of its normal
    vector facet[BASE_RAMPS];              // its normal
    float exponent[BASE_RAMPS];
    float level[BASE_LEVELS];              // SLOTS of each
    float mean[BASE_SETS];                 // of the ramp, and of its size
    float size[BASE_SETS];
    float weight[BASE_FACET_ROOM];         // Beckmann microfacets
    vector tilted[BASE_FACET_ROOM];        // their normals
    float alpha2[BASE_FACET_ROOM];
};

// The gain over the mirror direction's side of the lobe, where N.L is the larger cosine. A part of it that grows with
// N.L is Cycles' own phong_ramp times `plain`, exactly; it is taken off the gains. Returns the mirror direction's gain.
float read_gains(Hit hit, Correction c, float scale, float widths[], output float gains[BASE_FEATURES],
                 output float plain, TABLE(table_p), TABLE(table_c))
{
    float cosines[BASE_FEATURES];
    float least = 1e9;
    for (int q = 0; q < BASE_FEATURES; q += 1) {
        cosines[q] = q > 0 ? cos(max(hit.theta - widths[q] * scale, 0.0)) : hit.frame.view[2];
        gains[q] = 1.0 / correction(c, cosines[q], table_p, table_c);
        least = min(least, gains[q]);
    }
    float mirror = gains[0] * cosines[0];
    plain = BASE_PLAIN ? least : 0.0;
    for (int q = 0; q < BASE_FEATURES; q += 1)
        gains[q] = (gains[q] - plain) * cosines[q];
    return mirror;
}

// Blends the table's nodes around this hit, coefficients times gains: in each cell between the three nodes of the half
// that the hit lies in, which is as good as between four and faster.
void blend_nodes(Hit hit, float scale, float gains[BASE_FEATURES], vector table[], output vector sums[BASE_STRIDE])
{
    float w = hit.frame.view[0] / max(hit.frame.view[2], 1e-6) * scale;
    float u = (BASE_U - 1) * (0.5 * w / (1.0 + w) + hit.theta / M_PI);
    float v = (BASE_V - 1) * pow(hit.n, -BASE_POWER);
    int i = min((int)u, BASE_U - 2);
    int j = min((int)v, BASE_V - 2);
    u -= i;
    v -= j;
    // Corners of the triangle: the way along the greater of u and v first.
    int middle = u > v ? (i + 1) * BASE_V + j : i * BASE_V + j + 1;
    int begin = (i * BASE_V + j) * BASE_FEATURES;
    int end = begin + (BASE_V + 1) * BASE_FEATURES;
    for (int e = 0; e < BASE_STRIDE; e += 1)
        sums[e] = 0.0;
    for (int q = 0; q < BASE_FEATURES; q += 1) {
        if (gains[q] > 1e-6) {
            float a = gains[q] * (1.0 - max(u, v));
            float b = gains[q] * abs(u - v);
            float c = gains[q] * min(u, v);
            int at_a = (begin + q) * BASE_STRIDE;
            int at_b = (middle * BASE_FEATURES + q) * BASE_STRIDE;
            int at_c = (end + q) * BASE_STRIDE;
            for (int e = 0; e < BASE_STRIDE; e += 1)
                sums[e] += a * table[at_a + e] + b * table[at_b + e] + c * table[at_c + e];
        }
    }
}

void make_base(output Base b, Hit hit, Correction c, TABLE(table_p), TABLE(table_c), BASE_PARAMETERS)
{
    float scale = 1.0 / sqrt(hit.m);
    float mean = hit.frame.view[2] + BASE_GRAZING * scale;
    float gains[BASE_FEATURES];
    float plain;
    float mirror = read_gains(hit, c, scale, widths, gains, plain, table_p, table_c);
    vector sums[BASE_STRIDE];
    blend_nodes(hit, scale, gains, table, sums);
    b.left = max(sums[2][2], 0.0) / max(mirror, 1e-9);
    int faint[BASE_SETS];
    float unit = 1.0 / mean;
    for (int i = 0; i < BASE_SETS; i += 1) {
        vector least = i == 0 ? vector(plain) : vector(0.0);
        vector low = unit * sums[3 * i] + least;
        vector middle = unit * sums[3 * i + 1] + least;
        vector high = unit * sums[3 * i + 2] + least;
        int at = SLOTS * i;
        b.level[at] = low[0];
        b.level[at + 1] = low[1];
        b.level[at + 2] = low[2];
        b.level[at + 3] = middle[0];
        b.level[at + 4] = middle[1];
        b.level[at + 5] = middle[2];
        b.level[at + 6] = high[0];
        b.level[at + 7] = high[1];
        vector one = vector(1.0);
        vector last = vector(high[0], high[1], 0.0);
        b.mean[i] = (dot(low + middle + last, one) - 0.5 * (low[0] + high[1])) / (LEVELS - 1);
        b.size[i] = dot(abs(low) + abs(middle) + abs(last), one) / (LEVELS - 1);
        faint[i] = b.size[i] * mean < FAINT * mirror;
    }
    float height = M_PI_2 - hit.theta;
    for (int i = 0; i < BASE_RAMPS; i += 1) {
        int at = 5 * i;
        int s = (int)ramps[at + 4];
        b.sets[i] = faint[s] ? -1 : s;
        if (!faint[s]) {
            // Held back near the horizons: Cycles bends closures that mirror into the surface.
            float lean = clamp(ramps[at] * scale, -0.6 * max(height - 0.03, 0.0), M_PI - height - 0.3);
            b.exponent[i] = hit.m * ramps[at + 1];
            if (ramps[at + 3] > 0.0) {
                // The circle of one of its colours, where it has a kink, goes through the mirror direction.
                lean = max(min(ramps[at] * scale, hit.theta), 0.1 * scale);
                float rise = log((LEVELS - 1) / ramps[at + 3]);
                b.exponent[i] = rise / max(-log(max(cos(lean), 0.03)), rise / SHARPEST);
                float lower = (hit.m + 2.0) / (b.exponent[i] + 2.0);
                for (int k = 0; k < LEVELS; k += 1)
                    b.level[SLOTS * s + k] *= lower;
                b.mean[s] *= lower;
                b.size[s] *= lower;
            }
            b.axis[i] = vector(sin(lean - hit.theta), 0.0, cos(lean - hit.theta));
            if (ramps[at + 2] != 0.0) {
                float side = ramps[at + 2] * scale;
                b.axis[i] = cos(side) * b.axis[i] + vector(0.0, sin(side), 0.0);
            }
            b.facet[i] = normalize(b.axis[i] + hit.frame.view);
        }
    }
    for (int i = 0; i < BASE_FACETS; i += 1) {
        int e = i / 3;
        float weight = sums[3 * BASE_SETS + e][i - 3 * e] * mean;
        b.weight[i] = weight < FAINT * mirror ? 0.0 : weight;
        float lean = min(facets[2 * i] * scale, LEANEST / scale);
        b.tilted[i] = vector(sin(lean), 0.0, cos(lean));
        b.alpha2[i] = min(0.5 / (hit.m * facets[2 * i + 1]), 1.0);
    }
}

// Smith's Lambda of Beckmann microfacets, as Cycles fits it.
float beckmann_lambda(float alpha2, float cosine)
{
    float tan2 = alpha2 * max(1.0 / (cosine * cosine) - 1.0, 0.0);
    if (tan2 < 0.39)
        return 0.0;
    float a = inversesqrt(tan2);
    return ((0.396 * a - 1.259) * a + 1.0) / ((2.181 * a + 3.535) * a);
}

float beckmann(vector facet, float alpha2, vector view, vector light, vector h)
{
    float nl = dot(facet, light);
    float nv = max(dot(facet, view), 1e-6);
    float cos2 = dot(facet, h) * dot(facet, h);
    if (nl <= 0.0 || cos2 < 1e-9)
        return 0.0;
    return exp((1.0 - 1.0 / cos2) / alpha2)
         / (4.0 * nv * M_PI * alpha2 * cos2 * cos2 * (1.0 + beckmann_lambda(alpha2, nl) + beckmann_lambda(alpha2, nv)));
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

// The cosine that a ramp carries: its energy is the mean of its colours times that.
float ramp_cosine(Base b, int i)
{
    return min(dot(b.facet[i], b.axis[i]) + BASE_GRAZING * inversesqrt(b.exponent[i]), 1.0);
}

float base_energy(Base b)
{
    float sum = 0.0;
    for (int i = 0; i < BASE_RAMPS; i += 1)
        if (b.sets[i] >= 0)
            sum += b.mean[b.sets[i]] * ramp_cosine(b, i);
    for (int i = 0; i < BASE_FACETS; i += 1)
        sum += b.weight[i];
    return max(sum, 1e-3);
}

closure color base_closures(Base b, Frame f, color tint)
{
    closure color sum = 0;
    for (int i = 0; i < BASE_RAMPS; i += 1) {
        if (b.sets[i] >= 0) {
            int first = SLOTS * b.sets[i];
            // Cycles draws closures by their weights, not their colours: the weight is the energy, and less where
            // the closure only mends the first one's shape. Those that take away are drawn as well: where they add
            // something, they may be alone.
            float drawn = max(b.mean[b.sets[i]], 0.1 * b.size[b.sets[i]]) * ramp_cosine(b, i);
            float weight = max(i == 0 ? drawn : 0.3 * drawn, 2e-3);
            float share = 1.0 / weight;
            color colours[LEVELS];
            for (int k = 0; k < LEVELS; k += 1)
                colours[k] = share * b.level[first + k];
            sum += weight * tint * phong_ramp(normalize(to_world(f, b.facet[i])), b.exponent[i], colours);
        }
    }
    for (int i = 0; i < BASE_FACETS; i += 1)
        if (b.weight[i] > 0.0)
            sum += b.weight[i] * tint
                 * microfacet("beckmann", normalize(to_world(f, b.tilted[i])), sqrt(b.alpha2[i]), 0.0, 0);
    return sum;
}
