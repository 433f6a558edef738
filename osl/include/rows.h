// The choice of a hit's row among lobe rows; addon/forms/rows makes the rows, and `_flat` in
// addon/backends/osl/assembler.py writes their numbers.
//
// A row is the formula seen from one view: base closures, and the residual in cells of half vectors. A set is the rows
// of all views, after a head: the stretch of the rings along x and y, and the set's brightness. There is one set, or
// one for each combination of the steps of driven parameters.

// Offsets in a row. The residual's albedo comes first, at 0, and the base's microfacets follow, at 1.
#define W_BASE (1 + W_FACET * W_FACETS)                     // color of the diffuse closure
#define W_CELLS (W_BASE + 3)                                // edges of the rings
#define W_TURNS (W_CELLS + W_RINGS + 1)                     // edges of the cells
#define W_ENERGY (W_TURNS + W_RINGS * (W_AROUND + 1))       // energies of the cells
#define W_ROW (W_ENERGY + W_RINGS * W_AROUND * W_CHANNELS)  // numbers of a row
// The colors of a perfect mirror follow all rows of a set, at W_SPIKES angles from row to row.
#define W_SPIKE (W_HEAD + W_AZIMUTHS * W_VIEWS * W_ROW)
// Numbers of a set.
#define W_SET (W_SPIKE + (W_SPIKES > 0 ? 3 * (W_SPIKES * (W_VIEWS - 1) + 1) : 0))

#define LEAST_FRACTION 1e-6  // smallest divisor for a position's fraction
#define BELOW_ONE 0.999999   // the largest uniform number

// The position of a view among the rows, 0 to W_VIEWS - 1.
float view_place(float mu)
{
    float along = clamp(acos(clamp(mu, 0.0, 1.0)) / W_STEEPEST, 0.0, 1.0);
    return (W_VIEWS - 1) * (1.0 - pow(1.0 - along, 1.0 / W_CROWDED));
}

// One of the two whole numbers beside the position `place`, at most `last`. The uniform number `chance` chooses, in
// proportion to how near they are, and is then stretched to 0..1 for another use.
int beside(float place, int last, output float chance)
{
    int low = clamp((int)place, 0, last - 1);
    float fraction = clamp(place - low, 0.0, 1.0);
    int up = chance < fraction;
    chance = up ? chance / fraction : (chance - fraction) / max(1.0 - fraction, LEAST_FRACTION);
    return low + up;
}

#if W_RANGES
// The position of a driven parameter among its steps, 0 to steps - 1, in each channel.
color range_place(color value, float least, float most, int steps, int geometric)
{
    color at = clamp(value, color(least), color(most));
    color along = geometric ? log(at / least) / log(most / least) : (at - least) / (most - least);
    return (steps - 1) * along;
}

// The weight of a set, in each channel, in the linear interpolation between sets. The last parameter's step changes
// fastest from set to set.
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

// Chooses a hit's set. Returns the offset of its first number, and its `weight` in each channel. The uniform number
// `chance` chooses, in proportion to the sets' light at this hit, and is then stretched to 0..1 for another use.
// `storage_index` has the index of each set among the stored ones; that of a black set, which is not stored, is -1.
int choose_set(float w[], color places[W_RANGES], int steps[W_RANGES], int storage_index[W_SETS], output float chance,
                output color weight)
{
    // The light of each set at this hit.
    float likely[W_SETS];
    float all = 0.0;
    for (int i = 0; i < W_SETS; i += 1) {
        color share = set_share(i, places, steps);
        likely[i] = storage_index[i] < 0 ? 0.0 : (share[0] + share[1] + share[2])
                                                     * w[W_SET * storage_index[i] + W_HEAD - 1];
        all += likely[i];
    }
    // The set that `chance` falls on, in the cumulative sum.
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

// Chooses a view's row in the set that begins at `set`. Returns the offset of its first number.
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
// The frame with axes flipped so that the view is on the positive side of both, as the rows' views are. A stretched
// formula is its own mirror image about both axes.
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
