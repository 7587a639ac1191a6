/* SPDX-License-Identifier: MIT */
#include "harness/physics/fluxes.h"

#include "base/doubt.h"
#include "harness/physics/fluxes_tracer.h"
#include "harness/progress.h"

#include <stdio.h>
#include <string.h>

/* A new flux breaks the build here until this file handles it. */
_Static_assert(NEPH_FLUX_COUNT == 8, "a new flux");

const char *const neph_flux_names[NEPH_FLUX_COUNT] = {
    [NEPH_FLUX_REFLECTED] = "reflected", [NEPH_FLUX_TRANSMITTED] = "transmitted",
    [NEPH_FLUX_DIRECT] = "direct",       [NEPH_FLUX_UPWARD] = "upward",
    [NEPH_FLUX_ABSORBED] = "absorbed",   [NEPH_FLUX_HORIZONTAL] = "horizontal",
    [NEPH_FLUX_NADIR] = "nadir",         [NEPH_FLUX_ZENITH] = "zenith",
};

enum { PARTS = 100 }; /* of the progress */

struct teller {
    struct neph_progress progress;
    const char *what;
};

static void tell(void *context, double fraction)
{
    struct teller *teller = context;
    struct neph_progress *progress = &teller->progress;
    const int finished = (int)(fraction * PARTS) - progress->kinds[0].done;
    if (finished < 1)
        return;
    neph_progress_credit(progress, 0, finished - 1, 0.0);
    neph_progress_tick(progress, teller->what);
    neph_progress_begin(progress, teller->what);
}

static enum neph_status trace_by_oracle(const struct neph_fluxes_job *job,
                                        const struct neph_fluxes_params *params,
                                        const struct neph_scene *scene, struct neph_fluxes *fluxes,
                                        struct neph_diag *diag)
{
    (void)job;
    return neph_fluxes_trace(scene, params, fluxes, diag);
}

static enum neph_status trace_by_tracer(const struct neph_fluxes_job *job,
                                        const struct neph_fluxes_params *params,
                                        const struct neph_scene *scene, struct neph_fluxes *fluxes,
                                        struct neph_diag *diag)
{
    struct neph_open_device *device = NULL;
    enum neph_status status = neph_device_acquire(job->device, &device, diag);
    if (!status)
        status = neph_fluxes_trace_on_device(device->vulkan, scene, params, fluxes, diag);
    neph_device_release(device);
    return status;
}

static const struct {
    const char *name;
    enum neph_status (*trace)(const struct neph_fluxes_job *job,
                              const struct neph_fluxes_params *params,
                              const struct neph_scene *scene, struct neph_fluxes *fluxes,
                              struct neph_diag *diag);
} engines[] = {{"oracle", trace_by_oracle}, {"tracer", trace_by_tracer}};
enum { ENGINES = sizeof(engines) / sizeof(engines[0]) };

enum neph_status neph_fluxes_measure(const struct neph_fluxes_job *job,
                                     const struct neph_scene *scene, struct neph_fluxes *fluxes,
                                     struct neph_diag *diag)
{
    struct teller teller = {neph_progress_start(job->quiet, PARTS), job->what};
    struct neph_fluxes_params params = job->params;
    params.progress = tell;
    params.context = &teller;
    for (int i = 0; i < ENGINES; i++)
        if (strcmp(job->engine, engines[i].name) == 0) {
            neph_progress_begin(&teller.progress, job->what);
            const enum neph_status status = engines[i].trace(job, &params, scene, fluxes, diag);
            neph_progress_end(&teller.progress);
            return status;
        }
    neph_fail(diag, NEPH_ERR_USAGE, "fluxes are not by %s", job->engine);
    neph_hint(diag, "-e oracle: double precision on the CPU; -e tracer: on the Vulkan device");
    return NEPH_ERR_USAGE;
}

int neph_fluxes_warn(const char *what, const struct neph_fluxes *fluxes)
{
    int count = 0;
    for (int flux = 0; flux < NEPH_FLUX_COUNT; flux++) {
        struct neph_flux_estimate mean = neph_flux_of_domain(fluxes, (enum neph_flux)flux, 0);
        for (int c = 1; c < fluxes->channel_count; c++) {
            const struct neph_flux_estimate own = neph_flux_of_domain(fluxes, (enum neph_flux)flux,
                                                                      c);
            mean = own.doubt > mean.doubt ? own : mean;
        }
        if (flux != NEPH_FLUX_HORIZONTAL && mean.doubt > NEPH_DOUBTFUL) {
            count++;
            neph_progress_warn("%s: the error of %s, %.2g, is not to be trusted: a few paths make "
                               "most of it (its square has a relative variance of %.2g, above %g); "
                               "--samples takes more",
                               what, neph_flux_names[flux], mean.standard_error, mean.doubt,
                               NEPH_DOUBTFUL);
        }
    }
    return count;
}
