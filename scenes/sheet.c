/* SPDX-License-Identifier: MIT */
#include "scenes/sheet.h"

#include "scenes/noise.h"

#include <math.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_SHEET_PATTERN_COUNT == 2, "a new kind");

/* The period exceeds the number of wisps of a sheet, so no pattern repeats. */
enum { PERIOD = 1 << 16, OCTAVES = 5 };

/* Wisps sway sideways by this part of their distance, with this wavelength in distances. */
static const double sway = 0.6, sway_wisps = 3.0;

/* Perlin noise of several octaves rarely leaves this part of its range. */
static const double noise_reach = 0.5;

static double clamp(double value)
{
    return value < 0.0 ? 0.0 : value > 1.0 ? 1.0 : value;
}

/* Only + - * / and sqrt: the same bits on every machine. */
static double streaks(const struct neph_sheet *sheet, struct neph_vec3 point_m)
{
    const struct neph_vec3 flat = neph_vec3_normalize(
        (struct neph_vec3){sheet->along.x, 0.0, sheet->along.z});
    const struct neph_noise noise = {(uint64_t)sheet->seed, 2, PERIOD};
    const struct neph_vec3 from_m = neph_vec3_sub(point_m, sheet->center_m);
    double at[2] = {neph_vec3_dot(from_m, flat) / (sheet->wisp_m * sheet->stretch),
                    (flat.x * from_m.z - flat.z * from_m.x) / sheet->wisp_m};
    const double slow[2] = {at[0] / sway_wisps, at[1] / sway_wisps};
    at[1] += sway * sway_wisps * neph_noise_perlin(&noise, slow);
    const double rank = clamp(0.5 + 0.5 * neph_noise_perlin_sum(&noise, OCTAVES, at) / noise_reach);
    const double dense = clamp((rank - 1.0 + sheet->coverage) / fmax(sheet->coverage, 1e-3));
    return dense * dense * (3.0 - 2.0 * dense);
}

double neph_sheet_value(const struct neph_sheet *sheet, struct neph_vec3 point_m)
{
    return sheet->pattern == NEPH_SHEET_EVEN ? 1.0 : streaks(sheet, point_m);
}

/* The layer has the same distance from the planet's centre everywhere. */
double neph_sheet_drop_m(const struct neph_sheet *sheet, double x_m, double z_m)
{
    if (sheet->planet_radius_m == 0.0)
        return 0.0;
    const double radius_m = sheet->planet_radius_m + sheet->center_m.y;
    const double square = x_m * x_m + z_m * z_m;
    return square / (radius_m + sqrt(radius_m * radius_m - square));
}

/* A column of nodes, each half a thickness above the one before, the highest at the middle
 * height. */
static void fill_column(const struct neph_sheet *sheet, int height, struct neph_vec3 from_m,
                        float *values, size_t step)
{
    const double value = neph_sheet_value(sheet, neph_vec3_add(sheet->center_m, from_m));
    const double down = neph_sheet_drop_m(sheet, from_m.x, from_m.z) / (0.5 * sheet->thickness_m);
    for (int j = 0; j < height; j++)
        values[(size_t)j * step] = (float)(value * clamp(1.0 - fabs(height - 1 - j - down)));
}

enum neph_status neph_sheet_make(const struct neph_sheet *sheet, struct neph_grid **grid,
                                 struct neph_diag *diag)
{
    const int nodes = sheet->nodes;
    const double spacing_m = sheet->side_m / nodes, first_m = 0.5 * (nodes - 1) * spacing_m;
    const double half_m = 0.5 * sheet->thickness_m;
    const double levels = neph_sheet_drop_m(sheet, first_m, first_m) / half_m;
    const int height = sheet->planet_radius_m == 0.0 ? 1
                       : levels < NEPH_GRID_SIDE_MAX ? (int)levels + 2
                                                     : NEPH_GRID_SIDE_MAX + 1; /* refused */
    const struct neph_vec3 corner_m = neph_vec3_sub(
        sheet->center_m, (struct neph_vec3){first_m, (height - 1) * half_m, first_m});
    struct neph_grid *made = NULL;
    enum neph_status status = neph_grid_create((const int[3]){nodes, height, nodes}, corner_m,
                                               (struct neph_vec3){spacing_m, half_m, spacing_m},
                                               &made, diag);
    if (status)
        return status;
    for (int k = 0; k < nodes; k++)
        for (int i = 0; i < nodes; i++)
            fill_column(sheet, height,
                        (struct neph_vec3){i * spacing_m - first_m, 0.0, k * spacing_m - first_m},
                        &made->values[(size_t)k * (size_t)height * (size_t)nodes + (size_t)i],
                        (size_t)nodes);
    status = neph_grid_seal(made, diag);
    if (status)
        neph_grid_destroy(made);
    else
        *grid = made;
    return status;
}

double neph_sheet_extinction_per_m(const struct neph_sheet *sheet, double optical_depth)
{
    return optical_depth / (0.5 * sheet->thickness_m);
}
