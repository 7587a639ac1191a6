/* SPDX-License-Identifier: MIT
 *
 * An engine with all its settings as a file: what `neph pick` writes and `neph render --config`
 * takes. {"format": "neph-configuration-1", "engine": "realtime", "scattering": "single" | null,
 * "settings": "steps=16 ..."}; what else is in it is for people.
 */
#ifndef NEPH_HARNESS_RUN_CONFIGURATION_H
#define NEPH_HARNESS_RUN_CONFIGURATION_H

#include "harness/engines/engine.h"
#include "harness/json.h"

struct neph_configuration {
    const struct neph_engine *engine;
    struct neph_settings settings;
    bool rescatters;                 /* the scene gets other orders of scattering: */
    enum neph_scattering scattering; /* these */
};

/* For the caller to json_decref. */
json_t *neph_configuration_json(const struct neph_configuration *configuration);

/* NEPH_ERR_INPUT names the file and what in it is wrong; NEPH_ERR_NOT_FOUND. */
enum neph_status neph_configuration_read(const char *path, struct neph_configuration *configuration,
                                         struct neph_diag *diag);

#endif
