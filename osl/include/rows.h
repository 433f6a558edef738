// Which rows of lobe rows a hit takes: see addon/forms/weights.py, which makes them.
//
// A row is what a view sees: base closures, and cells of half vectors that hold what those leave over. A set is rows
// for all views, after a head: the stretch of its rings along x and y, and about how bright it is. There is one set,
// or one for each combination of steps of driven parameters.

#define W_BASE (1 + W_FACET * W_FACETS)  // first the share that is left over, then microfacets, then
#define W_CELLS (W_BASE + 3)             // the diffuse closure's colour, edges of rings, edges of cells, energies
#define W_TURNS (W_CELLS + W_RINGS + 1)
#define W_ENERGY (W_TURNS + W_RINGS * (W_AROUND + 1))
#define W_ROW (W_ENERGY + W_RINGS * W_AROUND * W_CHANNELS)
// After all rows, the colour of a perfect mirror, at W_SPIKES angles from row to row.
#define W_SPIKE (W_HEAD + W_AZIMUTHS * W_VIEWS * W_ROW)
#define W_SET (W_SPIKE + (W_SPIKES > 0 ? 3 * (W_SPIKES * (W_VIEWS - 1) + 1) : 0))

#define LEAST_FRACTION 1e-6      // of a place, that is divided by
#define BELOW_ONE 0.999999   // the largest uniform number

// Where a view is among the rows, 0 to W_VIEWS - 1.
float view_place(float mu)
{
    float along = clamp(acos(clamp(mu, 0.0, 1.0)) / W_STEEPEST, 0.0, 1.0);
    return (W_VIEWS - 1) * (1.0 - pow(1.0 - along, 1.0 / W_CROWDED));
}

// One of the two whole numbers beside a place, up to `last`, by the number `chance`, which is stretched for another
// use.
int beside(float place, int last, output float chance)
{
    int low = clamp((int)place, 0, last - 1);
    float fraction = clamp(place - low, 0.0, 1.0);
    int up = chance < fraction;
    chance = up ? chance / fraction : (chance - fraction) / max(1.0 - fraction, LEAST_FRACTION);
    return low + up;
}

#if W_RANGES
// Where a driven parameter is among its steps, 0 to steps - 1, in each channel.
color range_place(color value, float least, float most, int steps, int geometric)
{
    color at = clamp(value, color(least), color(most));
    color along = geometric ? log(at / least) / log(most / least) : (at - least) / (most - least);
    return (steps - 1) * along;
}

// The share, in each channel, that a set has in what is between sets: sets of the last parameter's steps are
// neighbours.
color set_share(int set, color places[W_RANGES], int steps[W_RANGES])
{
    color share = 1.0;
    int rest = set;
    for (int i = W_RANGES - 1; i >= 0; i -= 1) {
        int step = rest % steps[i];
        rest = rest / steps[i];
        share *= max(color(1.0) - abs(places[i] - color(step)), color(0.0));
    }
    return share;
}

// Where the set begins that a hit takes, by `chance`, which is stretched for another use, and what it weighs in each
// channel. Sets are taken as often as they are bright; `slots` tells where each is, -1 of those that are black.
int choose_set(float w[], color places[W_RANGES], int steps[W_RANGES], int storage_index[W_SETS], output float chance,
                output color weight)
{
    // How much light each set has at this hit.
    float likely[W_SETS];
    float all = 0.0;
    for (int i = 0; i < W_SETS; i += 1) {
        color share = set_share(i, places, steps);
        likely[i] = storage_index[i] < 0 ? 0.0 : (share[0] + share[1] + share[2]) * w[W_SET * storage_index[i] + W_HEAD - 1];
        all += likely[i];
    }
    // The set that `chance` falls on.
    float remaining = chance * all;
    int set = 0;
    while (set < W_SETS - 1 && remaining >= likely[set]) {
        remaining -= likely[set];
        set += 1;
    }
    weight = 0.0;
    if (likely[set] > 0.0) {
        weight = set_share(set, places, steps) * (all / likely[set]);
        chance = min(remaining / likely[set], BELOW_ONE);
    }
    return W_SET * max(storage_index[set], 0);
}
#endif

// Where the row begins that a view is given, in the set that begins at `set`.
int choose_row(int set, vector view, float place, float number)
{
    float chance = number;
    int row = beside(place, W_VIEWS - 1, chance);
#if W_WHOLE
    float turn = mod(atan2(view[1], view[0]) / M_2PI, 1.0);
    row += W_VIEWS * (int)mod(beside(W_AZIMUTHS * turn, W_AZIMUTHS, chance), W_AZIMUTHS);
#elif W_AZIMUTHS > 1
    row += W_VIEWS * beside((W_AZIMUTHS - 1) * atan2(view[1], view[0]) / M_PI_2, W_AZIMUTHS - 1, chance);
#endif
    return set + W_HEAD + W_ROW * row;
}

#if W_AZIMUTHS > 1 && !W_WHOLE
// A frame turned so that the view is on the positive side of both axes, as rows of views are: what is stretched along
// axes is the same on either side of them.
Frame first_quadrant(Frame frame)
{
    Frame f = frame;
    if (f.view[0] < 0.0)
        f.x = -f.x;
    if (f.view[1] < 0.0)
        f.y = -f.y;
    f.view = vector(abs(f.view[0]), abs(f.view[1]), f.view[2]);
    return f;
}
#endif
