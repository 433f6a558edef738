// The half-vector lobe f_0 = (n+8)/(8 pi) (N.H)^n: see HalfVectorLobe in addon/models/lobes.py.

#include "power.h"

#define LEAST_VIEW_HALF 1e-6  // smallest divisor for V.H

// (N.H)^n
float half_power(vector h, float n) { return power_of_rest((h[0] * h[0] + h[1] * h[1]) / (1.0 + max(h[2], 0.0)), n); }

float lobe_value(vector view, vector light, float n)
{
    vector h = normalize(view + light);
    return (n + 8.0) / (4.0 * M_2PI) * half_power(h, n);
}

float lobe_density(vector view, vector light, float n)
{
    vector h = normalize(view + light);
    return (n + 1.0) / M_2PI * half_power(h, n) / (4.0 * max(dot(view, h), LEAST_VIEW_HALF));
}

vector lobe_draw(vector view, float u, float v, float n)
{
    vector h = around(vector(0.0, 0.0, 1.0), rest_of_root(u, n + 1.0), M_2PI * v);
    return 2.0 * dot(view, h) * h - view;
}

// Exponent of the Phong lobe of equal width; the base lobes are scaled by it.
float lobe_phong_exponent(float n) { return PHONG_PER_HALF * n; }

// Width of the lobe where it is narrowest, in radians: across the plane of incidence it shrinks with N.V.
float lobe_width(float mu_view, float n)
{
    float scale = HALF_WIDTH / sqrt(n);
    return scale * min(mu_view + GRAZING_WIDTH * scale, 1.0);
}
