// The colour factor; see addon/brdf/fresnel.py for sources.

#define FRESNEL_CONSTANT 0
#define FRESNEL_SCHLICK 1
#define FRESNEL_CONDUCTOR 2

struct Colour {
    int choice;
    color f0;
    color f90;
    color n;
    color k;
};

color conductor(float mu, color n, color k)
{
    float sin2 = 1.0 - mu * mu;
    color t0 = n * n - k * k - sin2;
    color a2b2 = sqrt(t0 * t0 + 4.0 * n * n * k * k);
    color a = sqrt(max(color(0.0), 0.5 * (a2b2 + t0)));
    color t1 = a2b2 + mu * mu;
    color perpendicular = (t1 - 2.0 * a * mu) / (t1 + 2.0 * a * mu);
    color t3 = mu * mu * a2b2 + sin2 * sin2;
    color t4 = 2.0 * a * mu * sin2;
    return 0.5 * perpendicular * (1.0 + (t3 - t4) / (t3 + t4));
}

// Fresnel factor at V.H = mu.
color fresnel_factor(Colour c, float mu)
{
    float m = clamp(mu, 0.0, 1.0);
    if (c.choice == FRESNEL_SCHLICK)
        return c.f0 + (c.f90 - c.f0) * pow(1.0 - m, 5.0);
    if (c.choice == FRESNEL_CONDUCTOR)
        return conductor(m, c.n, c.k);
    return c.f0;
}

// How much the factor changes over a lobe that falls to 1e-4 at the angle reach, in parts of what it is at the mirror
// direction of a view at theta: at one width of the lobe to either side. V.H is the cosine of half the angle between
// view and light.
float fresnel_change(Colour c, float theta, float reach)
{
    if (c.choice == FRESNEL_CONSTANT)
        return 0.0;
    color mirror = fresnel_factor(c, cos(theta));
    color change = abs(fresnel_factor(c, cos(max(theta - 0.125 * reach, 0.0))) - mirror)
                 + abs(fresnel_factor(c, cos(min(theta + 0.125 * reach, M_PI_2))) - mirror);
    return 0.5 * (change[0] + change[1] + change[2]) / max(mirror[0] + mirror[1] + mirror[2], 1e-6);
}
