// The Phong lobe f_0 = (n+2)/(2 pi) max(R.L, 0)^n: see PhongLobe in addon/models/lobes.py.

#include "power.h"

// max(R.L, 0)^n
float mirror_power(vector view, vector light, float n)
{
    vector away = mirror_of(view) - light;
    return power_of_rest(0.5 * dot(away, away), n);
}

float lobe_value(vector view, vector light, float n) { return (n + 2.0) / M_2PI * mirror_power(view, light, n); }

float lobe_density(vector view, vector light, float n) { return (n + 1.0) / M_2PI * mirror_power(view, light, n); }

vector lobe_draw(vector view, float u, float v, float n)
{
    return around(mirror_of(view), rest_of_root(u, n + 1.0), M_2PI * v);
}

// Exponent of the Phong lobe of equal width; the base lobes are scaled by it.
float lobe_phong_exponent(float n) { return n; }

// Width of the lobe where it is narrowest, in radians.
float lobe_width(float mu_view, float n) { return 1.0 / sqrt(n); }
