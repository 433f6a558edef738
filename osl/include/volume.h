// The volume of a round lump about the origin that is on the disk: see VolumeTable in addon/forms/albedo/tables.py.

float lump_volume(Row row, float mu_view, float radius, TABLE(volumes))
{
    float distance = room_at(mu_view);
    float place = (1.0 - sqrt(max(1.0 - radius, 0.0))) * (VOLUME_LAYERS - 1);
    int layer = min((int)place, VOLUME_LAYERS - 2);
    // The layers of the next smaller and the next larger radius.
    float at[2];
    float radii[2];
    for (int k = 0; k < 2; k += 1) {
        int l = layer + k;
        float below = 1.0 - l / (VOLUME_LAYERS - 1.0);
        radii[k] = 1.0 - below * below;
        Row block = row;
        block.row += (l / TABLE_CHANNELS) * row.axes.rows;
        float channels[TABLE_CHANNELS];
        table_read(volumes, block, min(distance / radius, 1.0), TABLE_CHANNELS, channels);
        at[k] = channels[l - TABLE_CHANNELS * (l / TABLE_CHANNELS)];
    }
    return mix(at[0], at[1], (radius - radii[0]) / (radii[1] - radii[0]));
}
