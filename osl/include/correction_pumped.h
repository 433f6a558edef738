// D of albedo pumping-up: see addon/models/pumping.py.

#define PUMPED

#ifndef ALBEDO_FALLS
#define ALBEDO_FALLS 0  // 1 where the albedo falls towards the normal
#endif

struct Correction {
    float mu_view;
    float pumps;
    int stages;  // number of albedos that the pumps read
    int control;
    Row row;     // the exponent's row of the table
    float at_view[TABLE_CHANNELS];
};

// The correction and the tables that it reads, which no struct can hold: as parameters of a function, as its arguments,
// and as the shader's own data. CONTROLLED_TABLE is the second table, for models that have one.
#ifdef AXES_CONTROLLED
#define CORRECTION_PARAMETERS Correction c, TABLE(plain_albedos), TABLE(controlled_albedos)
#define CORRECTION c, plain_albedos, controlled_albedos
#define CORRECTION_DATA c, table_plain, table_controlled
#define CONTROLLED_TABLE controlled_albedos
#define CONTROLLED_AXES AXES_CONTROLLED
#else
#define CORRECTION_PARAMETERS Correction c, TABLE(plain_albedos)
#define CORRECTION c, plain_albedos
#define CORRECTION_DATA c, table_plain
#define CONTROLLED_TABLE plain_albedos
#define CONTROLLED_AXES AXES_PLAIN
#endif

// The albedos a_0 .. of the pumps' stages at a cosine.
void albedos(float mu, output float a[TABLE_CHANNELS], CORRECTION_PARAMETERS)
{
    if (c.control)
        table_read(CONTROLLED_TABLE, c.row, mu, c.stages, a);
    else
        table_read(plain_albedos, c.row, mu, c.stages, a);
}

// Fills in a correction that has only mu_view. Returns whether its table can be used; without pumps it always can.
int read_pumps(float exponent, float pumps, int control, output CORRECTION_PARAMETERS)
{
    c.pumps = pumps;
    c.stages = (int)ceil(pumps);
    c.control = control;
    // The exponent's row. The check compares the table with its declaration.
    if (control) {
        c.row = table_row(CONTROLLED_AXES, exponent);
        table_check(CONTROLLED_TABLE, c.row);
    } else {
        c.row = table_row(AXES_PLAIN, exponent);
        table_check(plain_albedos, c.row);
    }
    if (!c.row.valid && pumps > 0.0)
        return 0;
    albedos(c.mu_view, c.at_view, CORRECTION);
    return 1;
}

float correction(float mu_light, CORRECTION_PARAMETERS)
{
    if (c.pumps <= 0.0)
        return 1.0;
    // Phong's and Blinn's albedos grow with the cosine (but for 2e-4 at the fourth pump), so the larger albedo is the
    // view's where the light is lower than the view.
    float at_light[TABLE_CHANNELS] = {0.0, 0.0, 0.0, 0.0};
    if (ALBEDO_FALLS || mu_light > c.mu_view)
        albedos(mu_light, at_light, CORRECTION);
    // Stage by stage; the last stage may count in part.
    float d = 1.0;
    for (int stage = 0; stage < c.stages; stage += 1) {
        float share = min(c.pumps - stage, 1.0);
        float m = SPOILT_LARGER(c.at_view[stage], at_light[stage]);
        d *= share < 1.0 ? pow(m, share) : m;
        if (c.control)
            d = max(d, max(c.mu_view, mu_light));
    }
    return d;
}
