// The target on the disk: a lump itself, eq. 27.

struct Target {
    float share;  // share of the volume
};

// The target and the table that it reads, which no struct can hold: as parameters of a function, as its arguments, and
// as the shader's own data.
#define TARGET_PARAMETERS Target t
#define TARGET t
#define TARGET_DATA t

color target_tint(TARGET_PARAMETERS) { return color(1.0); }

float target_gain(Disk d, Lump p, TARGET_PARAMETERS) { return 1.0; }

color target_density(Disk d, Lump p, vector at, Spot s, TARGET_PARAMETERS) { return color(unit_lump(at, p.n)); }

// The lump that the bells follow.
Lump target_like(Disk d, Lump p, TARGET_PARAMETERS) { return p; }
