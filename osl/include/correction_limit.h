// D = max(N.L, N.V), where controlled pumping of Phong ends (Neumann et al. eq. 22).

struct Correction {
    float mu_view;
};

float correction(Correction c, float mu_light, TABLE(plain), TABLE(controlled)) { return max(mu_light, c.mu_view); }
