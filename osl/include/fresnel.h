// The color factor; see addon/models/fresnel.py for sources.

#define LEAST_FACTOR 1e-6  // smallest divisor for the mirror direction's factor, summed over channels

struct Colour {
    int choice;
    color f0;
    color f90;
    color n;
    color k;
};

// Exact unpolarized reflectance of the complex index n + ik at V.H = mu.
color conductor(float mu, color n, color k)
{
    float sin2 = 1.0 - mu * mu;
    color t0 = n * n - k * k - sin2;
    // The mean of the reflectances of both polarizations: across the plane of incidence, and in it.
    color a2b2 = sqrt(t0 * t0 + 4.0 * n * n * k * k);
    color a = sqrt(max(color(0.0), 0.5 * (a2b2 + t0)));
    color t1 = a2b2 + mu * mu;
    color perpendicular = (t1 - 2.0 * a * mu) / (t1 + 2.0 * a * mu);
    color t3 = mu * mu * a2b2 + sin2 * sin2;
    color t4 = 2.0 * a * mu * sin2;
    return 0.5 * perpendicular * (1.0 + (t3 - t4) / (t3 + t4));
}

// Schlick's approximation from f0 to f90.
color schlick_factor(float mu, color f0, color f90) { return f0 + (f90 - f0) * pow(1.0 - clamp(mu, 0.0, 1.0), 5.0); }

// Fresnel factor at V.H = mu.
color fresnel_factor(Colour c, float mu)
{
    float m = clamp(mu, 0.0, 1.0);
    if (c.choice == FRESNEL_SCHLICK)
        return schlick_factor(m, c.f0, c.f90);
    if (c.choice == FRESNEL_CONDUCTOR)
        return conductor(m, c.n, c.k);
    return c.f0;
}

// The base's color factor, `least`, and how far the lobe's factor exceeds it, in parts of that. `least` is the smallest
// factor of three lights: the mirror direction, and two widths of the lobe to either side of it. So the residual is
// mostly positive. V.H is the cosine of half the angle between view and light, which is `width` to either side.
float fresnel_change(Colour c, float theta, float width, output color least)
{
    color mirror = fresnel_factor(c, cos(theta));
    least = mirror;
    if (c.choice == FRESNEL_CONSTANT)
        return 0.0;
    // To either side, within 0 and 90 degrees.
    least = min(mirror, min(fresnel_factor(c, cos(max(theta - width, 0.0))),
                            fresnel_factor(c, cos(min(theta + width, M_PI_2)))));
    color change = mirror - least;
    return (change[0] + change[1] + change[2]) / max(mirror[0] + mirror[1] + mirror[2], LEAST_FACTOR);
}
