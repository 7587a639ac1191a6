/* SPDX-License-Identifier: MIT */
#include "renderer/sky/view_table.h"

#include "base/threads.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Distance of the outermost directions from the horizon [rad]: a grazing ray would belong to both
 * halves. */
static const double horizon_gap_rad = 1e-5;

/* Length by which values below the horizon are divided. Near the ground the distance to it varies
 * most between nodes, so nodes store the light scattered per metre of that distance. */
static double way_m(double length_m)
{
    static const double least_m = 1e-3; /* for a position on the ground */
    return isfinite(length_m) ? fmax(length_m, least_m) : 1.0;
}

static double horizon_rad(const struct neph_sky_air *air, double altitude_m)
{
    const double growth_m2 = altitude_m * (2.0 * air->radius_m + altitude_m);
    return -asin(sqrt(growth_m2) / (air->radius_m + altitude_m));
}

/* Angular range of a half, from the horizon up or down. */
static double range_rad(double horizon, bool is_below)
{
    return (is_below ? M_PI / 2.0 + horizon : M_PI / 2.0 - horizon) - horizon_gap_rad;
}

/* --- nodes ------------------------------------------------------------------------------------ */

struct filling {
    const struct neph_sky_air *air;
    const struct neph_sky_sources *sources;
    struct neph_sky_view_table *table;
    int steps;
};

/* The share of a layer is computed with a phase function of 1 for it and 0 for the others. */
static void fill_node(const struct filling *filling, struct neph_sky_ray ray, double (*slices)[3])
{
    const int layers = filling->air->layer_count;
    struct neph_sky_sources once = *filling->sources;
    once.field = NULL;
    for (int i = 0; i < layers; i++) {
        memset(ray.phases, 0, sizeof(ray.phases));
        ray.phases[i] = 1.0;
        const struct neph_sky_light light = neph_sky_walk(filling->air, &once, &ray,
                                                          filling->steps);
        for (int c = 0; c < 3; c++)
            slices[i][c] = light.volume[c] / way_m(light.length_m);
    }
    memset(ray.phases, 0, sizeof(ray.phases));
    const struct neph_sky_light light = neph_sky_walk(filling->air, filling->sources, &ray,
                                                      filling->steps);
    for (int c = 0; c < 3; c++) {
        slices[layers + NEPH_SKY_HIGHER][c] = light.volume[c] / way_m(light.length_m);
        slices[layers + NEPH_SKY_GROUND][c] = light.radiance[c] - light.volume[c];
        slices[layers + NEPH_SKY_THROUGH][c] = light.transmittance[c];
    }
}

static void fill_row(int row, void *context)
{
    const struct filling *filling = context;
    const struct neph_sky_view_table *table = filling->table;
    const bool is_below = row >= table->elevations;
    const double horizon = horizon_rad(filling->air, table->altitude_m);
    const double part = row % table->elevations / (table->elevations - 1.0);
    const double off_rad = horizon_gap_rad + range_rad(horizon, is_below) * part * part;
    const double elevation = is_below ? horizon - off_rad : horizon + off_rad;
    const double sun_sine = sqrt(fmax(0.0, 1.0 - table->sun_cosine * table->sun_cosine));
    for (int i = 0; i < table->azimuths; i++) {
        const double turn = i / (table->azimuths - 1.0), azimuth = M_PI * turn * turn;
        const struct neph_sky_ray ray = {
            .altitude_m = table->altitude_m,
            .cosine = sin(elevation),
            .sun_cosine = table->sun_cosine,
            .toward_sun = sin(elevation) * table->sun_cosine +
                          cos(elevation) * sun_sine * cos(azimuth),
        };
        fill_node(filling, ray, &table->nodes[(row * table->azimuths + i) * table->slices]);
    }
}

enum neph_status neph_sky_view_table_create(const struct neph_sky_air *air,
                                            const struct neph_sky_sources *sources,
                                            const struct neph_sky_view_params *params, int steps,
                                            double altitude_m, double sun_cosine,
                                            struct neph_sky_view_table *table,
                                            struct neph_diag *diag)
{
    *table = (struct neph_sky_view_table){.elevations = params->elevations,
                                          .azimuths = params->azimuths,
                                          .slices = air->layer_count + NEPH_SKY_SLICES,
                                          .altitude_m = altitude_m,
                                          .sun_cosine = sun_cosine};
    const size_t nodes = 2 * (size_t)params->elevations * (size_t)params->azimuths;
    table->nodes = calloc(nodes * (size_t)table->slices, sizeof(*table->nodes));
    if (!table->nodes)
        return neph_fail_memory(diag);
    struct filling filling = {air, sources, table, steps};
    return neph_parallel_rows(2 * params->elevations, fill_row, &filling, diag);
}

void neph_sky_view_table_destroy(struct neph_sky_view_table *table)
{
    free(table->nodes);
    *table = (struct neph_sky_view_table){0};
}

/* --- interpolation ---------------------------------------------------------------------------- */

static double locate_table_node(double part, int nodes, int *low)
{
    const double place = fmin(fmax(part, 0.0), 1.0) * (nodes - 1);
    *low = (int)fmin(floor(place), nodes - 2.0);
    return place - *low;
}

static double locate_azimuth(const struct neph_sky_view_table *table,
                             const struct neph_sky_ray *ray, int *low)
{
    const double across2 = (1.0 - ray->cosine * ray->cosine) *
                           (1.0 - ray->sun_cosine * ray->sun_cosine);
    const double x = (ray->toward_sun - ray->cosine * ray->sun_cosine) / sqrt(fmax(across2, 1e-12));
    return locate_table_node(sqrt(acos(fmin(1.0, fmax(-1.0, x))) / M_PI), table->azimuths, low);
}

/* Add the light of a node with its interpolation weight. */
static void add_node_light(const struct neph_sky_view_table *table, const struct neph_sky_ray *ray,
                           int node, double weight, struct neph_sky_light *light)
{
    const int layers = table->slices - NEPH_SKY_SLICES;
    const double(*slices)[3] = (const double(*)[3]) & table->nodes[node * table->slices];
    for (int c = 0; c < 3; c++) {
        double volume = slices[layers + NEPH_SKY_HIGHER][c];
        for (int i = 0; i < layers; i++)
            volume += ray->phases[i] * slices[i][c];
        volume *= way_m(light->length_m);
        light->volume[c] += weight * volume;
        light->radiance[c] += weight * (volume + slices[layers + NEPH_SKY_GROUND][c]);
        light->transmittance[c] += weight * slices[layers + NEPH_SKY_THROUGH][c];
    }
}

struct neph_sky_light neph_sky_view(const struct neph_sky_air *air,
                                    const struct neph_sky_view_table *table,
                                    const struct neph_sky_ray *ray)
{
    struct neph_sky_light light = {.length_m = neph_sky_length_m(air, ray)};
    const bool is_below = isfinite(light.length_m);
    const double horizon = horizon_rad(air, table->altitude_m);
    const double off_rad = fabs(asin(fmin(1.0, fmax(-1.0, ray->cosine))) - horizon);
    int i, j;
    const double x = locate_azimuth(table, ray, &i);
    const double y = locate_table_node(
        sqrt(fmax(0.0, off_rad - horizon_gap_rad) / range_rad(horizon, is_below)),
        table->elevations, &j);
    const int first = ((is_below ? table->elevations : 0) + j) * table->azimuths + i;
    add_node_light(table, ray, first, (1.0 - x) * (1.0 - y), &light);
    add_node_light(table, ray, first + 1, x * (1.0 - y), &light);
    add_node_light(table, ray, first + table->azimuths, (1.0 - x) * y, &light);
    add_node_light(table, ray, first + table->azimuths + 1, x * y, &light);
    return light;
}
