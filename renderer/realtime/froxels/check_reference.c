/* SPDX-License-Identifier: MIT
 *
 * The CPU reference of near froxels: froxels.glsl, froxel_sum.comp and froxel_apply.comp, in
 * double.
 */
#include "renderer/realtime/shared/check_reference.h"

#include <math.h>

struct volume {
    int px, columns, rows, slices;
    double near_m, end_m;
};

static struct volume make_volume(const struct reference *cpu)
{
    const float *settings = cpu->view->settings;
    const int px = (int)settings[RT_FROXEL_PX];
    return (struct volume){
        .px = px,
        .columns = ((int)cpu->view->size_px[0] + px - 1) / px,
        .rows = ((int)cpu->view->size_px[1] + px - 1) / px,
        .slices = (int)settings[RT_FROXEL_SLICES],
        .near_m = (double)settings[RT_FROXEL_NEAR_M],
        .end_m = (double)settings[RT_FROXEL_END_M],
    };
}

double cpu_froxel_edge_m(const struct reference *cpu, int edge)
{
    const struct volume v = make_volume(cpu);
    return v.near_m * (pow(1.0 + v.end_m / v.near_m, (double)edge / v.slices) - 1.0);
}

/* The slice of a depth; at an edge either slice is correct. */
static int find_slice(const struct reference *cpu, double depth_m)
{
    const int slices = make_volume(cpu).slices;
    int slice = 0;
    while (slice + 1 < slices && cpu_froxel_edge_m(cpu, slice + 1) <= depth_m)
        slice++;
    return slice;
}

/* Section 0 and 1: light of even and odd frames; 2: sums. */
static void fetch(const struct reference *cpu, int section, int column, int row, int slice,
                  double value[4])
{
    const struct volume v = make_volume(cpu);
    float word[4];
    column = column < 0 ? 0 : column >= v.columns ? v.columns - 1 : column;
    row = row < 0 ? 0 : row >= v.rows ? v.rows - 1 : row;
    cpu_fetch(cpu, RT_FROXELS, column, row + v.rows * (slice + v.slices * section), word);
    for (int c = 0; c < 4; c++)
        value[c] = (double)word[c];
}

/* Adds L (1 - e^(-sigma t)) / sigma and e^(-sigma t) of a froxel behind the sum so far. */
static void put_behind(double sum[4], const double froxel[4], double length_m)
{
    const double depth = froxel[3] * length_m;
    const double reach_m = depth > 0.0 ? -expm1(-depth) / froxel[3] : length_m;
    for (int c = 0; c < 3; c++)
        sum[c] += sum[3] * froxel[c] * reach_m;
    sum[3] *= exp(-depth);
}

/* Length per depth of the ray through a place of the view. */
static double slope_at(const struct reference *cpu, double x_px, double y_px)
{
    const struct neph_gpu_view *view = cpu->view;
    const double x = (2.0 * x_px / view->size_px[0] - 1.0) * (double)view->now.half_width;
    const double y = (1.0 - 2.0 * y_px / view->size_px[1]) * (double)view->now.half_height;
    return view->now.is_parallel ? 1.0 : sqrt(1.0 + x * x + y * y);
}

void cpu_froxel_sum(const struct reference *cpu)
{
    const struct volume v = make_volume(cpu);
    const struct neph_gpu_target *shape = &cpu->view->targets[RT_FROXELS];
    for (int row = 0; row < v.rows; row++)
        for (int column = 0; column < v.columns; column++) {
            const double slope = slope_at(cpu, (column + 0.5) * v.px, (row + 0.5) * v.px);
            double sum[4] = {0.0, 0.0, 0.0, 1.0}, froxel[4];
            for (int slice = 0; slice < v.slices; slice++) {
                fetch(cpu, (int)(cpu->view->frame & 1u), column, row, slice, froxel);
                put_behind(sum, froxel,
                           (cpu_froxel_edge_m(cpu, slice + 1) - cpu_froxel_edge_m(cpu, slice)) *
                               slope);
                const float rounded[4] = {(float)sum[0], (float)sum[1], (float)sum[2],
                                          (float)sum[3]};
                const int y = row + v.rows * (slice + v.slices * 2);
                neph_rt_store(shape, cpu->targets[RT_FROXELS],
                              (size_t)y * shape->width + (size_t)column, rounded);
            }
        }
}

static void column_before(const struct reference *cpu, int column, int row, int slice,
                          double length_m, double sum[4])
{
    double froxel[4];
    sum[0] = sum[1] = sum[2] = 0.0;
    sum[3] = 1.0;
    if (slice > 0)
        fetch(cpu, 2, column, row, slice - 1, sum);
    fetch(cpu, (int)(cpu->view->frame & 1u), column, row, slice, froxel);
    put_behind(sum, froxel, length_m);
}

static void apply_to(const struct reference *cpu, int x, int y)
{
    const struct volume v = make_volume(cpu);
    const struct neph_gpu_view *view = cpu->view;
    const double x_px = x + 0.5 + (double)view->jitter_px[0];
    const double y_px = y + 0.5 + (double)view->jitter_px[1];
    float depth[4], volume[4];
    cpu_fetch_full(cpu, RT_DEPTH, x, y, depth);
    cpu_fetch_full(cpu, RT_VOLUME, x, y, volume);
    const double clipped_depth_m = fmin((double)depth[0], v.end_m);
    const int slice = find_slice(cpu, clipped_depth_m);
    const double length_m = fmax(clipped_depth_m - cpu_froxel_edge_m(cpu, slice), 0.0) *
                            slope_at(cpu, x_px, y_px);
    const double u = x_px / v.px - 0.5;
    const double w = y_px / v.px - 0.5;
    double before[4] = {0.0};
    for (int i = 0; i < 4; i++) {
        const double wx = i & 1 ? u - floor(u) : 1.0 - (u - floor(u));
        const double wy = i >> 1 ? w - floor(w) : 1.0 - (w - floor(w));
        double sum[4];
        column_before(cpu, (int)floor(u) + (i & 1), (int)floor(w) + (i >> 1), slice, length_m, sum);
        for (int c = 0; c < 4; c++)
            before[c] += wx * wy * sum[c];
    }
    float made[4];
    for (int c = 0; c < 3; c++)
        made[c] = (float)(before[c] + before[3] * (double)volume[c]);
    made[3] = (float)(before[3] * (double)volume[3]);
    cpu_put_full(cpu, RT_VOLUME, x, y, made);
}

void cpu_froxel_apply(const struct reference *cpu)
{
    for (int y = 0; y < (int)cpu->view->size_px[1]; y++)
        for (int x = 0; x < (int)cpu->view->size_px[0]; x++)
            apply_to(cpu, x, y);
}
