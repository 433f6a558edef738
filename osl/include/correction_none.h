// No correction: f = f_0.

struct Correction {
    float mu_view;
};

float correction(Correction c, float mu_light, TABLE(plain), TABLE(controlled)) { return 1.0; }
