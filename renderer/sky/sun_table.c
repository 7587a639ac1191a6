/* SPDX-License-Identifier: MIT */
#include "renderer/sky/sun_table.h"

#include "base/threads.h"

#include <math.h>
#include <stdlib.h>

/* r^2 - radius^2 without cancellation. */
static double growth_m2(const struct neph_sky_air *air, double altitude_m)
{
    return altitude_m * (2.0 * air->radius_m + altitude_m);
}

/* Lengths of rays from an altitude to the top of the atmosphere. */
struct ray_lengths {
    double horizon_m; /* from the altitude to its geometric horizon, */
    double most_m;    /* and from the horizon to the top */
    double shortest_m, longest_m;
};

static struct ray_lengths compute_ray_lengths(const struct neph_sky_air *air, double altitude_m)
{
    const double horizon_m = sqrt(growth_m2(air, altitude_m));
    const double most_m = sqrt(growth_m2(air, air->top_m));
    return (struct ray_lengths){horizon_m, most_m, air->top_m - altitude_m, horizon_m + most_m};
}

static double length_to_top_m(const struct neph_sky_air *air, double altitude_m, double cosine)
{
    const double rise_m = (air->radius_m + altitude_m) * cosine;
    const double left_m2 = growth_m2(air, air->top_m) - growth_m2(air, altitude_m);
    const double root_m = sqrt(rise_m * rise_m + left_m2);
    return rise_m > 0.0 ? left_m2 / (rise_m + root_m) : root_m - rise_m;
}

/* --- nodes ------------------------------------------------------------------------------------ */

struct filling {
    const struct neph_sky_air *air;
    struct neph_sky_sun_table *table;
};

static double node_altitude_m(const struct neph_sky_air *air, double part)
{
    const double horizon_m = part * sqrt(growth_m2(air, air->top_m));
    const double growth = horizon_m * horizon_m;
    return growth / (air->radius_m + sqrt(air->radius_m * air->radius_m + growth));
}

static double node_cosine(const struct neph_sky_air *air, double altitude_m, double part)
{
    const struct ray_lengths ray_lengths = compute_ray_lengths(air, altitude_m);
    const double length_m = ray_lengths.shortest_m +
                            part * (ray_lengths.longest_m - ray_lengths.shortest_m);
    const double left_m2 = growth_m2(air, air->top_m) - growth_m2(air, altitude_m);
    const double rise_m = length_m > 0.0 ? 0.5 * (left_m2 / length_m - length_m)
                                         : air->radius_m + altitude_m;
    return fmin(1.0, rise_m / (air->radius_m + altitude_m));
}

static void fill_row(int row, void *context)
{
    const struct filling *filling = context;
    const struct neph_sky_sun_table *table = filling->table;
    const double altitude_m = node_altitude_m(filling->air, row / (table->altitudes - 1.0));
    for (int i = 0; i < table->cosines; i++) {
        double depth[3];
        const double cosine = node_cosine(filling->air, altitude_m, i / (table->cosines - 1.0));
        neph_sky_depth_to_space(filling->air, altitude_m, cosine, depth);
        for (int c = 0; c < 3; c++)
            table->nodes[row * table->cosines + i][c] = (float)exp(-depth[c]);
    }
}

enum neph_status neph_sky_sun_table_create(const struct neph_sky_air *air, int altitudes,
                                           int cosines, struct neph_sky_sun_table *table,
                                           struct neph_diag *diag)
{
    *table = (struct neph_sky_sun_table){.altitudes = altitudes, .cosines = cosines};
    table->nodes = calloc((size_t)altitudes * (size_t)cosines, sizeof(*table->nodes));
    if (!table->nodes)
        return neph_fail_memory(diag);
    struct filling filling = {air, table};
    return neph_parallel_rows(altitudes, fill_row, &filling, diag);
}

void neph_sky_sun_table_destroy(struct neph_sky_sun_table *table)
{
    free(table->nodes);
    *table = (struct neph_sky_sun_table){0};
}

/* --- interpolation ---------------------------------------------------------------------------- */

static double locate_sun_node(double part, int nodes, int *low)
{
    const double place = fmin(fmax(part, 0.0), 1.0) * (nodes - 1);
    *low = (int)fmin(floor(place), nodes - 2.0);
    return place - *low;
}

void neph_sky_sun_transmittance(const struct neph_sky_air *air,
                                const struct neph_sky_sun_table *table, double altitude_m,
                                double sun_cosine, double transmittance[3])
{
    const double r_m = air->radius_m + altitude_m;
    const double horizon_m = sqrt(growth_m2(air, altitude_m));
    if (sun_cosine * r_m < -horizon_m) {
        transmittance[0] = transmittance[1] = transmittance[2] = 0.0;
        return;
    }
    const struct ray_lengths ray_lengths = compute_ray_lengths(air, altitude_m);
    const double length_m = length_to_top_m(air, altitude_m, sun_cosine);
    const double spread_m = fmax(ray_lengths.longest_m - ray_lengths.shortest_m, 1e-9);
    int i, j;
    const double x = locate_sun_node((length_m - ray_lengths.shortest_m) / spread_m, table->cosines,
                                     &i);
    const double y = locate_sun_node(ray_lengths.horizon_m / ray_lengths.most_m, table->altitudes,
                                     &j);
    const float(*low)[3] = (const float(*)[3]) & table->nodes[j * table->cosines + i];
    const float(*high)[3] = low + table->cosines;
    for (int c = 0; c < 3; c++) {
        const double below = low[0][c] + x * ((double)low[1][c] - low[0][c]);
        const double above = high[0][c] + x * ((double)high[1][c] - high[0][c]);
        transmittance[c] = below + y * (above - below);
    }
}
