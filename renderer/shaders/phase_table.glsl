// SPDX-License-Identifier: MIT
//
// Phase functions as tables, linear in the versine 1 - cos between their rows: float32 version of
// scenes/phase_table.c. The tables are in front of the voxels in grid_values[]; the g of such a
// medium is the index of its table. renderer/phase_tables.c writes them.

// The number of rows, the mean cosine, and the distance to the next table.
const uint PHASE_TABLE_HEAD = 3;
const uint PHASE_TABLE_ROW = 3;  // the versine, the phase function, the light within that angle
const uint PHASE_TABLE_VERSINE = 0, PHASE_TABLE_PER_SR = 1, PHASE_TABLE_WITHIN = 2;

float phase_table_value(uint first, uint row, uint column)
{
    return grid_values[first + PHASE_TABLE_HEAD + PHASE_TABLE_ROW * row + column];
}

// The last row, except the last of all, whose column is at most `value`. Tables have 8192 rows at
// most (NEPH_TABULATED_ROWS_MAX).
uint find_phase_row(uint first, uint column, float value)
{
    uint low = 0, end = uint(grid_values[first]) - 1;
    [[unroll]] for (uint part = 4096; part > 0; part >>= 1) {
        uint row = low + part;
        if (row < end && phase_table_value(first, row, column) <= value)
            low = row;
    }
    return low;
}

// The table of a channel. Behind the mean of the channels are theirs, if they differ; else the
// distance is 0.
float phase_channel_table(float table, uint channel)
{
    return table + float(1 + channel) * grid_values[uint(table) + 2];
}

float phase_table_mean_cosine(float table) { return grid_values[uint(table) + 1]; }

float phase_table_per_sr(float table, vec3 view, vec3 sun)
{
    uint first = uint(table);
    vec3 off_peak = view - sun;
    float versine = 0.5 * dot(off_peak, off_peak); // keeps its digits where 1 - cos does not
    uint row = find_phase_row(first, PHASE_TABLE_VERSINE, versine);
    float near = phase_table_value(first, row, PHASE_TABLE_VERSINE);
    float far = phase_table_value(first, row + 1, PHASE_TABLE_VERSINE);
    float part = clamp((versine - near) / (far - near), 0.0, 1.0);
    return mix(phase_table_value(first, row, PHASE_TABLE_PER_SR),
               phase_table_value(first, row + 1, PHASE_TABLE_PER_SR), part);
}

// Sampling: 1 - cos for a uniform number u. Within an interval of width w, whose phase function
// goes from p to q, the light within t of its start is 2 pi (p t + (q - p) / (2 w) t^2). The root
// is written without cancellation, for any sign of q - p.
float phase_table_versine(float table, float u)
{
    uint first = uint(table);
    float light = 1.0 - u;
    uint row = find_phase_row(first, PHASE_TABLE_WITHIN, light);
    float near = phase_table_value(first, row, PHASE_TABLE_VERSINE);
    float width = phase_table_value(first, row + 1, PHASE_TABLE_VERSINE) - near;
    float p = phase_table_value(first, row, PHASE_TABLE_PER_SR);
    float q = phase_table_value(first, row + 1, PHASE_TABLE_PER_SR);
    float rest = max(0.0, light - phase_table_value(first, row, PHASE_TABLE_WITHIN)) / (2.0 * PI);
    float root = sqrt(max(0.0, p * p + 2.0 * (q - p) / width * rest));
    float t = 2.0 * rest / max(p + root, 1e-30);
    return near + min(t, width);
}
