// D = max(N.L, N.V), the limit of controlled pumping of Phong (Neumann et al. eq. 22).

struct Correction {
    float mu_view;
};

// See correction_none.h.
#define CORRECTION_PARAMETERS Correction c
#define CORRECTION c
#define CORRECTION_DATA c

float correction(float mu_light, CORRECTION_PARAMETERS) { return max(mu_light, c.mu_view); }
