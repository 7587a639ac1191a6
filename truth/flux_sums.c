/* SPDX-License-Identifier: MIT */
#include "truth/flux_sums.h"

#include "base/doubt.h"
#include "scenes/media.h"
#include "scenes/phase_colour.h"

#include <math.h>
#include <stdlib.h>

static bool is_coloured(struct neph_rgb rgb)
{
    return rgb.r != rgb.g || rgb.g != rgb.b;
}

static bool is_scene_coloured(const struct neph_scene *scene)
{
    for (int m = 0; m < scene->medium_count; m++)
        if (is_coloured(scene->media[m].albedo) || neph_medium_is_coloured(&scene->media[m]) ||
            neph_phase_is_coloured(&scene->media[m].phase))
            return true;
    for (int i = 0; i < scene->solid_count; i++)
        if (is_coloured(scene->solids[i].albedo))
            return true;
    return false;
}

enum neph_status neph_fluxes_create(const struct neph_scene *scene,
                                    const struct neph_flux_domain *domain,
                                    struct neph_fluxes *fluxes, struct neph_diag *diag)
{
    const int channels = is_scene_coloured(scene) ? 3 : 1;
    const size_t columns = (size_t)domain->columns_x * (size_t)domain->columns_z;
    struct neph_fluxes made = {.domain = *domain, .channel_count = channels};
    made.sums = calloc(NEPH_FLUX_COUNT * columns * (size_t)channels, sizeof(*made.sums));
    made.domain_sums = calloc(NEPH_FLUX_COUNT * (size_t)channels, sizeof(*made.domain_sums));
    if (!made.sums || !made.domain_sums) {
        neph_fluxes_finish(&made);
        return neph_fail_memory(diag);
    }
    *fluxes = made;
    return NEPH_OK;
}

static int column_count(const struct neph_fluxes *fluxes)
{
    return fluxes->domain.columns_x * fluxes->domain.columns_z;
}

static size_t find_place(const struct neph_fluxes *fluxes, int flux, int column, int channel)
{
    return ((size_t)flux * (size_t)column_count(fluxes) + (size_t)column) *
               (size_t)fluxes->channel_count +
           (size_t)channel;
}

/* What does not leave through the levels and is not absorbed leaves through the sides. */
static void fill_horizontal(const struct neph_fluxes *fluxes, double *values)
{
    for (int column = 0; column < column_count(fluxes); column++)
        for (int c = 0; c < fluxes->channel_count; c++)
            values[find_place(fluxes, NEPH_FLUX_HORIZONTAL, column, c)] =
                1.0 - values[find_place(fluxes, NEPH_FLUX_REFLECTED, column, c)] -
                values[find_place(fluxes, NEPH_FLUX_TRANSMITTED, column, c)] +
                values[find_place(fluxes, NEPH_FLUX_UPWARD, column, c)] -
                values[find_place(fluxes, NEPH_FLUX_ABSORBED, column, c)];
}

void neph_fluxes_add_batch(struct neph_fluxes *fluxes, double *values)
{
    const int columns = column_count(fluxes);
    fill_horizontal(fluxes, values);
    for (int flux = 0; flux < NEPH_FLUX_COUNT; flux++)
        for (int c = 0; c < fluxes->channel_count; c++) {
            double mean = 0.0;
            for (int column = 0; column < columns; column++) {
                const size_t place = find_place(fluxes, flux, column, c);
                neph_moments_add(&fluxes->sums[place], values[place]);
                mean += values[place] / columns;
            }
            neph_moments_add(&fluxes->domain_sums[flux * fluxes->channel_count + c], mean);
        }
}

static struct neph_flux_estimate estimate(const struct neph_moments *sum)
{
    const struct neph_moments_estimate made = neph_moments_estimate(sum);
    return (struct neph_flux_estimate){made.mean, made.standard_error, made.doubt};
}

struct neph_flux_estimate neph_flux_of_column(const struct neph_fluxes *fluxes, enum neph_flux flux,
                                              int column, int channel)
{
    return estimate(&fluxes->sums[find_place(fluxes, (int)flux, column, channel)]);
}

struct neph_flux_estimate neph_flux_of_domain(const struct neph_fluxes *fluxes, enum neph_flux flux,
                                              int channel)
{
    return estimate(&fluxes->domain_sums[(int)flux * fluxes->channel_count + channel]);
}

int neph_flux_doubtful_columns(const struct neph_fluxes *fluxes, enum neph_flux flux, int channel)
{
    int count = 0;
    for (int column = 0; column < column_count(fluxes); column++)
        count += neph_flux_of_column(fluxes, flux, column, channel).doubt > NEPH_DOUBTFUL;
    return count;
}

void neph_fluxes_finish(struct neph_fluxes *fluxes)
{
    free(fluxes->sums);
    free(fluxes->domain_sums);
    fluxes->sums = fluxes->domain_sums = NULL;
}
