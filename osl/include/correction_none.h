// No correction: f = f_0.

struct Correction {
    float mu_view;
};

// The correction and the tables that it reads, which no struct can hold: as parameters of a function, as its arguments,
// and as the shader's own data.
#define CORRECTION_PARAMETERS Correction c
#define CORRECTION c
#define CORRECTION_DATA c

float correction(float mu_light, CORRECTION_PARAMETERS) { return 1.0; }
