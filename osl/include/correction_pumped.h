// D of albedo pumping-up: see addon/brdf/pumping.py.

#ifndef ALBEDO_FALLS
#define ALBEDO_FALLS 0  // towards the normal
#endif

struct Correction {
    float mu_view;
    float pumps;
    int stages;  // how many albedos the pumps read
    int control;
    Row row;
    float at_view[4];
};

void albedos(Row row, int control, float mu, int stages, TABLE(plain), TABLE(controlled), output float a[4])
{
    if (control)
        table_read(controlled, row, mu, stages, a);
    else
        table_read(plain, row, mu, stages, a);
}

float correction(Correction c, float mu_light, TABLE(plain), TABLE(controlled))
{
    if (c.pumps <= 0.0)
        return 1.0;
    // Phong's and Blinn's albedos grow with the cosine (but for 2e-4 at the fourth pump), so a light below the view has no
    // say in the larger.
    float at_light[4] = {0.0, 0.0, 0.0, 0.0};
    if (ALBEDO_FALLS || mu_light > c.mu_view)
        albedos(c.row, c.control, mu_light, c.stages, plain, controlled, at_light);
    float d = 1.0;
    for (int stage = 0; stage < c.stages; stage += 1) {
        float share = min(c.pumps - stage, 1.0);
        float m = max(c.at_view[stage], at_light[stage]);
        d *= share < 1.0 ? pow(m, share) : m;
        if (c.control)
            d = max(d, max(c.mu_view, mu_light));
    }
    return d;
}
