// The target on the disk: the lump made symmetric, pumped up, times the color; see ReciprocalDiskLobe in
// addon/models/lobes.py.

struct Target {
    Correction c;
    Colour colour;
};

// See target_lump.h.
#define TARGET_PARAMETERS Target t, TABLE(plain_albedos)
#define TARGET t, plain_albedos
#define TARGET_DATA t, table_plain

#define LEAST_LIKE 0.2  // least half angle of the lump that the bells follow, in parts of the lump's half angle

// Square root of the profile of the largest lump at a cosine, over its slope R / cosine = tan(45 deg - theta / 2).
float root_profile(float mu, float tan2, float n)
{
    float slope = room_at(mu) / mu;
    float r2 = tan2 / (slope * slope);
    return r2 < 1.0 ? power_of_rest(r2, 0.5 * n) / slope : 0.0;
}

color target_density(Disk d, Lump p, vector at, Spot s, TARGET_PARAMETERS)
{
    float mu = d.frame.view[2];
    float tan2 = (s.h[0] * s.h[0] + s.h[1] * s.h[1]) / (s.h[2] * s.h[2]);
    float symmetric = (p.n + 1.0) / M_PI * root_profile(mu, tan2, p.n) * root_profile(s.light[2], tan2, p.n);
    // f (N.L) over dh / dL, in units of the radii. Their common factors cancel.
    float density = symmetric * sqrt(s.light[2] / mu) / (mu * mu) * p.radii[0] * p.radii[1];
    return density / correction(s.light[2], t.c, plain_albedos) * fresnel_factor(t.colour, dot(d.frame.view, s.h));
}

color target_tint(TARGET_PARAMETERS) { return fresnel_factor(t.colour, t.c.mu_view); }

// The target's height in the mirror direction over that of the view's lump: the bells are no higher.
float target_gain(Disk d, Lump p, TARGET_PARAMETERS)
{
    return 1.0 / correction(d.frame.view[2], t.c, plain_albedos);
}

// The lump that the bells follow. Beside the mirror direction, away from the normal, the light's own lump is narrower
// than the view's. The bells follow the lump of a light one standard deviation away.
Lump target_like(Disk d, Lump p, TARGET_PARAMETERS)
{
    Lump like = p;
    float slope = p.radii[0] / d.frame.view[2];
    float half_room = max(atan(slope) - atan(slope * lump_deviation(p.n)), LEAST_LIKE * atan(slope));
    like.radii[0] = tan(half_room) * d.frame.view[2];
    like.radii[1] = like.radii[0];
    return like;
}
