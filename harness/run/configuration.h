/* SPDX-License-Identifier: MIT
 *
 * An engine with all its settings as a file: written by `neph pick`, read by `neph render
 * --config`.
 *
 *   {"format": "neph-configuration-1", "engine": "realtime", "scattering": "single" | null,
 *    "settings": "steps=16 ..."}
 *
 * Further keys are for the reader and are ignored.
 */
#ifndef NEPH_HARNESS_RUN_CONFIGURATION_H
#define NEPH_HARNESS_RUN_CONFIGURATION_H

#include "harness/engines/engine.h"
#include "harness/json.h"

struct neph_configuration {
    const struct neph_engine *engine;
    struct neph_settings settings;
    bool rescatters; /* `scattering` replaces the scene's scattering orders */
    enum neph_scattering scattering;
};

/* The caller decrefs the result. */
json_t *neph_configuration_json(const struct neph_configuration *configuration);

/* NEPH_ERR_INPUT, with the file and the faulty value; NEPH_ERR_NOT_FOUND. */
enum neph_status neph_configuration_read(const char *path, struct neph_configuration *configuration,
                                         struct neph_diag *diag);

#endif
