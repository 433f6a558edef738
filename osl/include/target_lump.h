// What is estimated on the disk: a lump itself, eq. 27.

struct Target {
    float share;  // of the volume
};

color target_tint(Target t) { return color(1.0); }

float target_gain(Target t, Disk d, Lump p, TABLE(albedos)) { return 1.0; }

color target_density(Target t, Disk d, Lump p, vector at, Spot s, TABLE(albedos)) { return color(unit_lump(at, p.n)); }

// The lump that the bells are made for.
Lump target_like(Target t, Disk d, Lump p) { return p; }
