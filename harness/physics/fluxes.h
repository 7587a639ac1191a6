/* SPDX-License-Identifier: MIT
 *
 * The fluxes of truth/fluxes.h by an engine that path-traces all orders.
 */
#ifndef NEPH_HARNESS_PHYSICS_FLUXES_H
#define NEPH_HARNESS_PHYSICS_FLUXES_H

#include "harness/engines/vulkan_device.h"
#include "truth/fluxes.h"

/* The name of a flux ("reflected"). */
extern const char *const neph_flux_names[NEPH_FLUX_COUNT];

struct neph_fluxes_job {
    const char *engine;               /* oracle or tracer */
    const char *what;                 /* for the progress */
    struct neph_fluxes_params params; /* without progress */
    struct neph_shared_device *device;
    bool quiet;
};

/* NEPH_ERR_USAGE: another engine. Errors of the engines; with NEPH_ERR_INTERRUPTED there are no
 * fluxes. */
enum neph_status neph_fluxes_measure(const struct neph_fluxes_job *job,
                                     const struct neph_scene *scene, struct neph_fluxes *fluxes,
                                     struct neph_diag *diag);

/* Warn on stderr of means over the domain whose error bar is not to be trusted, with that number.
 * Returns their count. */
int neph_fluxes_warn(const char *what, const struct neph_fluxes *fluxes);

#endif
