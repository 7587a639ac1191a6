/* SPDX-License-Identifier: MIT */
#include "truth/fluxes.h"

#include "base/clock.h"
#include "base/interrupt.h"
#include "base/threads.h"
#include "truth/oracle.h"
#include "truth/path.h"
#include "truth/photons.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The values of the batches that are traced at the same time, at most. */
static const size_t wave_bytes = (size_t)256 << 20;

struct work {
    const struct neph_fluxes_params *params;
    struct neph_photons photons;
    int batches, paths; /* of a radiance, in a batch and column */
    int first;          /* batch of the present wave */
    size_t numbers;     /* values of a batch */
    double *values;     /* [batch of the wave][flux][column][channel] */
};

/* ---- radiances ---- */

static struct neph_rgb trace_radiance(const struct neph_photons *photons, struct neph_vec3 from_m,
                                      struct neph_vec3 direction, struct neph_random *random)
{
    const struct neph_scene *scene = photons->scene;
    struct neph_tracking_cost cost = {0, 0};
    struct neph_view view = {.origin_m = from_m, .direction = direction, .hit = {.t_m = INFINITY}};
    if (scene->solid_count > 0)
        view = neph_view_create(scene, from_m, direction);
    const struct neph_path_light light = neph_path_trace(scene, photons->tracker, &view, NULL,
                                                         random, &cost);
    return neph_rgb_add(view.unscattered, neph_rgb_add(light.volume, light.surface));
}

/* The radiance of one column, straight up (`side` -1: the paths go down from the top) or down. */
static void trace_column(const struct work *work, int column, int side, struct neph_random *random,
                         double *values)
{
    const struct neph_flux_domain *domain = &work->photons.domain;
    const struct neph_bounds *box = &domain->box;
    const struct neph_vec3 direction = {0.0, side, 0.0};
    const double y_m = side < 0 ? box->max_m.y : neph_flux_bottom_m(domain);
    struct neph_rgb sum = {0, 0, 0};
    for (int i = 0; i < work->paths && !(i % 64 == 0 && neph_interrupted()); i++) {
        const double x = column % domain->columns_x + neph_random_uniform(random),
                     z = column / domain->columns_x + neph_random_uniform(random);
        const struct neph_vec3 from_m = {
            box->min_m.x + (box->max_m.x - box->min_m.x) * x / domain->columns_x, y_m,
            box->min_m.z + (box->max_m.z - box->min_m.z) * z / domain->columns_z};
        sum = neph_rgb_add(sum, trace_radiance(&work->photons, from_m, direction, random));
    }
    const double scale = M_PI / work->photons.scene->sun.direction.y / work->paths;
    const double light[3] = {sum.r, sum.g, sum.b};
    for (int c = 0; c < work->photons.channel_count; c++)
        values[c] = scale * light[c];
}

static void trace_radiances(const struct work *work, int batch, double *values)
{
    static const struct {
        enum neph_flux flux;
        int side;
    } cameras[] = {{NEPH_FLUX_NADIR, -1}, {NEPH_FLUX_ZENITH, 1}};
    const int columns = work->photons.domain.columns_x * work->photons.domain.columns_z;
    const int channels = work->photons.channel_count;
    for (int i = 0; i < 2; i++)
        for (int column = 0; column < columns; column++) {
            /* Photons have the streams of the same seed. */
            struct neph_random random = neph_random_stream(
                ~work->params->seed, (uint64_t)(2 * column + i), (uint64_t)batch);
            trace_column(work, column, cameras[i].side, &random,
                         values + ((size_t)cameras[i].flux * (size_t)columns + (size_t)column) *
                                      (size_t)channels);
        }
}

/* ---- batches ---- */

static void trace_batch(int index, void *context)
{
    const struct work *work = context;
    double *values = work->values + (size_t)index * work->numbers;
    memset(values, 0, work->numbers * sizeof(*values));
    neph_photons_trace(&work->photons, work->params->seed, work->first + index,
                       NEPH_FLUX_PHOTONS * work->paths, values);
    trace_radiances(work, work->first + index, values);
}

/* Batches are added in their order, so the number of threads changes no bit. */
static enum neph_status trace_waves(struct work *work, int wave, struct neph_fluxes *fluxes,
                                    struct neph_diag *diag)
{
    const struct neph_fluxes_params *params = work->params;
    enum neph_status status = NEPH_OK;
    for (work->first = 0; work->first < work->batches && !status; work->first += wave) {
        const int left = work->batches - work->first, count = left < wave ? left : wave;
        status = neph_parallel_rows(count, trace_batch, work, diag);
        if (!status && neph_interrupted()) /* in the last batches, which are then incomplete */
            status = neph_fail(diag, NEPH_ERR_INTERRUPTED, "interrupted");
        for (int i = 0; i < count && !status; i++)
            neph_fluxes_add_batch(fluxes, work->values + (size_t)i * work->numbers);
        if (!status && params->progress)
            params->progress(params->context, (double)(work->first + count) / work->batches);
    }
    return status;
}

static enum neph_status trace(struct work *work, struct neph_fluxes *fluxes, struct neph_diag *diag)
{
    const struct neph_flux_domain *domain = &work->photons.domain;
    const int paths = work->params->paths;
    const int all = (paths + NEPH_FLUX_PHOTONS - 1) / NEPH_FLUX_PHOTONS;
    work->paths = (all + NEPH_FLUX_BATCHES - 1) / NEPH_FLUX_BATCHES;
    work->batches = (all + work->paths - 1) / work->paths;
    work->numbers = (size_t)NEPH_FLUX_COUNT * (size_t)domain->columns_x *
                    (size_t)domain->columns_z * (size_t)work->photons.channel_count;
    const size_t room = wave_bytes / (work->numbers * sizeof(*work->values));
    const size_t wanted = (size_t)neph_thread_count();
    const size_t wave = room < 1 ? 1 : room < wanted ? room : wanted;
    work->values = malloc(wave * work->numbers * sizeof(*work->values));
    if (!work->values)
        return neph_fail_memory(diag);
    fluxes->paths = NEPH_FLUX_PHOTONS * work->batches * work->paths;
    const enum neph_status status = trace_waves(work, (int)wave, fluxes, diag);
    free(work->values);
    return status;
}

enum neph_status neph_fluxes_trace(const struct neph_scene *scene,
                                   const struct neph_fluxes_params *params,
                                   struct neph_fluxes *fluxes, struct neph_diag *diag)
{
    const double start_s = neph_wall_s();
    const struct neph_scene lit = neph_flux_scene(scene);
    struct neph_fluxes made = {.sums = NULL};
    struct neph_tracker *tracker = NULL;
    struct neph_flux_domain domain;
    struct work work = {.params = params};
    char reason[256];
    enum neph_status status = neph_flux_domain_find(scene, params, &domain, diag);
    if (!status && !neph_oracle_can_render(&lit, reason, sizeof(reason)))
        status = neph_fail(diag, NEPH_ERR_UNSUPPORTED, "the oracle cannot: %s", reason);
    if (!status)
        status = neph_tracker_create(&lit, &tracker, diag);
    if (!status)
        status = neph_fluxes_create(&lit, &domain, &made, diag);
    if (!status)
        status = neph_photons_init(&work.photons, &lit, tracker, &domain, made.channel_count, diag);
    if (!status)
        status = trace(&work, &made, diag);
    neph_tracker_destroy(tracker);
    if (status) {
        neph_fluxes_finish(&made);
        return status;
    }
    made.wall_s = neph_wall_s() - start_s;
    *fluxes = made;
    return NEPH_OK;
}
