// What is estimated on the disk: a lump itself, eq. 27.

struct Target {
    float share;  // of the volume
};

// The target, and the table that it reads, which no struct can hold: as parameters of functions, passed on, and from
// the shader.
#define TARGET_PARAMETERS Target t
#define TARGET t
#define TARGET_DATA t

color target_tint(TARGET_PARAMETERS) { return color(1.0); }

float target_gain(Disk d, Lump p, TARGET_PARAMETERS) { return 1.0; }

color target_density(Disk d, Lump p, vector at, Spot s, TARGET_PARAMETERS) { return color(unit_lump(at, p.n)); }

// The lump that the bells are made for.
Lump target_like(Disk d, Lump p, TARGET_PARAMETERS) { return p; }
