/* SPDX-License-Identifier: MIT */
#include "truth/step_cloud.h"

#include "base/threads.h"
#include "scenes/media.h"
#include "truth/directions.h"
#include "truth/random.h"

#include <math.h>
#include <stdlib.h>

/* Russian roulette: below this weight a photon survives with probability 1/2, with doubled
 * weight. */
static const double roulette_weight = 0.1;

struct work {
    const struct neph_step_cloud_params *params;
    /* Sums of each batch: reflected, transmitted, absorbed, then the nadir radiance of each
     * column. */
    double *sums; /* [batch][3 + column_count] */
};

enum { REFLECTED, TRANSMITTED, ABSORBED, FLUX_COUNT };

struct photon {
    int column;
    double x_m, y_m; /* from the column's left side; from the cloud's bottom */
    struct neph_vec3 direction;
    double weight;
};

static double extinction_per_m(const struct neph_step_cloud_params *params, int column)
{
    return params->optical_depths[column] / params->thickness_m;
}

/* Move by an optical depth; false: the photon has left through the top or the bottom. */
static bool fly(const struct neph_step_cloud_params *params, struct photon *photon,
                double optical_depth)
{
    const struct neph_vec3 d = photon->direction;
    for (;;) {
        const double sigma_per_m = extinction_per_m(params, photon->column);
        const double side_m = d.x > 0.0 ? params->column_width_m : 0.0;
        const double level_m = d.y > 0.0 ? params->thickness_m : 0.0;
        const double to_side_m = d.x == 0.0 ? INFINITY : (side_m - photon->x_m) / d.x;
        const double to_level_m = d.y == 0.0 ? INFINITY : (level_m - photon->y_m) / d.y;
        const double to_face_m = fmax(0.0, fmin(to_side_m, to_level_m));
        if (sigma_per_m * to_face_m >= optical_depth) {
            photon->x_m += d.x * optical_depth / sigma_per_m;
            photon->y_m += d.y * optical_depth / sigma_per_m;
            return true;
        }
        if (to_level_m <= to_side_m)
            return false;
        optical_depth -= sigma_per_m * to_face_m;
        photon->y_m += d.y * to_face_m;
        photon->x_m = d.x > 0.0 ? 0.0 : params->column_width_m;
        photon->column += d.x > 0.0 ? 1 : params->column_count - 1;
        photon->column %= params->column_count;
    }
}

/* Light of one scattering vertically up to the camera, as a density over the column's part of the
 * level. */
static double nadir_share(const struct neph_step_cloud_params *params, const struct photon *photon)
{
    const double above = extinction_per_m(params, photon->column) *
                         (params->thickness_m - photon->y_m);
    return photon->weight * neph_phase_per_sr(&params->phase, photon->direction.y) * exp(-above);
}

static void trace(const struct neph_step_cloud_params *params, struct neph_random *random,
                  double *sums)
{
    const double start = neph_random_uniform(random) * params->column_count;
    const int column = start < params->column_count ? (int)start : params->column_count - 1;
    struct photon photon = {
        .column = column,
        .x_m = (start - column) * params->column_width_m,
        .y_m = params->thickness_m,
        .direction = {sqrt((1.0 - params->sun_cosine) * (1.0 + params->sun_cosine)),
                      -params->sun_cosine, 0.0},
        .weight = 1.0};
    while (fly(params, &photon, -log(neph_random_uniform(random)))) {
        sums[ABSORBED] += photon.weight * (1.0 - params->albedo);
        photon.weight *= params->albedo;
        sums[FLUX_COUNT + photon.column] += nadir_share(params, &photon);
        if (photon.weight < roulette_weight) {
            if (neph_random_uniform(random) < 0.5)
                return;
            photon.weight *= 2.0;
        }
        photon.direction = neph_phase_sample(&params->phase, photon.direction, random);
    }
    sums[photon.direction.y > 0.0 ? REFLECTED : TRANSMITTED] += photon.weight;
}

/* Number of photons of a batch; the first batches take the remainder. */
static int64_t batch_photons(const struct neph_step_cloud_params *params, int batch)
{
    return params->photons / NEPH_STEP_CLOUD_BATCHES +
           (batch < params->photons % NEPH_STEP_CLOUD_BATCHES);
}

static void trace_batch(int batch, void *context)
{
    const struct work *work = context;
    double *sums = work->sums + (size_t)batch * (size_t)(FLUX_COUNT + work->params->column_count);
    struct neph_random random = neph_random_stream(work->params->seed, (uint64_t)batch, 0);
    for (int64_t i = batch_photons(work->params, batch); i > 0; i--)
        trace(work->params, &random, sums);
}

/* The mean over the batches of sum `index` per photon, times `scale`. */
static struct neph_estimate estimate(const struct work *work, int index, double scale)
{
    const size_t stride = (size_t)(FLUX_COUNT + work->params->column_count);
    double mean = 0.0, square = 0.0;
    for (int pass = 0; pass < 2; pass++)
        for (int batch = 0; batch < NEPH_STEP_CLOUD_BATCHES; batch++) {
            const double value = work->sums[(size_t)batch * stride + (size_t)index] * scale /
                                 (double)batch_photons(work->params, batch);
            if (pass == 0)
                mean += value / NEPH_STEP_CLOUD_BATCHES;
            else
                square += (value - mean) * (value - mean);
        }
    return (struct neph_estimate){
        mean, sqrt(square / (NEPH_STEP_CLOUD_BATCHES * (NEPH_STEP_CLOUD_BATCHES - 1.0)))};
}

static enum neph_status check(const struct neph_step_cloud_params *params, struct neph_diag *diag)
{
    if (params->column_count < 1 || params->column_count > NEPH_STEP_CLOUD_COLUMNS_MAX)
        return neph_fail(diag, NEPH_ERR_INPUT, "step cloud: %d columns, not in 1..%d",
                         params->column_count, NEPH_STEP_CLOUD_COLUMNS_MAX);
    for (int i = 0; i < params->column_count; i++)
        if (!(params->optical_depths[i] >= 0.0 && isfinite(params->optical_depths[i])))
            return neph_fail(diag, NEPH_ERR_INPUT, "step cloud: optical depth %g of column %d",
                             params->optical_depths[i], i);
    const bool sized = params->column_width_m > 0.0 && isfinite(params->column_width_m) &&
                       params->thickness_m > 0.0 && isfinite(params->thickness_m);
    if (!sized)
        return neph_fail(diag, NEPH_ERR_INPUT, "step cloud: columns of %g m x %g m",
                         params->column_width_m, params->thickness_m);
    if (!(params->albedo >= 0.0 && params->albedo <= 1.0))
        return neph_fail(diag, NEPH_ERR_INPUT, "step cloud: albedo %g, not in 0..1",
                         params->albedo);
    if (!(params->sun_cosine > 0.0 && params->sun_cosine <= 1.0))
        return neph_fail(diag, NEPH_ERR_INPUT, "step cloud: cosine of the sun %g, not in 0..1",
                         params->sun_cosine);
    if (!(fabs(params->phase.g) < 1.0))
        return neph_fail(diag, NEPH_ERR_INPUT, "step cloud: asymmetry %g", params->phase.g);
    if (params->photons < NEPH_STEP_CLOUD_BATCHES)
        return neph_fail(diag, NEPH_ERR_INPUT, "step cloud: fewer photons than %d",
                         NEPH_STEP_CLOUD_BATCHES);
    return NEPH_OK;
}

enum neph_status neph_step_cloud_solve(const struct neph_step_cloud_params *params,
                                       struct neph_step_cloud_fluxes *fluxes,
                                       struct neph_estimate *nadir_per_sr, struct neph_diag *diag)
{
    enum neph_status status = check(params, diag);
    if (status)
        return status;
    struct work work = {
        .params = params,
        .sums = calloc(NEPH_STEP_CLOUD_BATCHES * (size_t)(FLUX_COUNT + params->column_count),
                       sizeof(double))};
    if (!work.sums)
        return neph_fail_memory(diag);
    status = neph_parallel_rows(NEPH_STEP_CLOUD_BATCHES, trace_batch, &work, diag);
    if (!status) {
        *fluxes = (struct neph_step_cloud_fluxes){.reflected = estimate(&work, REFLECTED, 1.0),
                                                  .transmitted = estimate(&work, TRANSMITTED, 1.0),
                                                  .absorbed = estimate(&work, ABSORBED, 1.0)};
        /* A column is 1 / column_count of the level, and the irradiance on the level is E
         * sun_cosine. */
        for (int i = 0; nadir_per_sr && i < params->column_count; i++)
            nadir_per_sr[i] = estimate(&work, FLUX_COUNT + i,
                                       params->sun_cosine * params->column_count);
    }
    free(work.sums);
    return status;
}
