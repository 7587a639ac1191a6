/* SPDX-License-Identifier: MIT
 *
 * The participants of the physics suite: engines with their settings, and the known causes of their
 * errors.
 */
#ifndef NEPH_HARNESS_PHYSICS_PARTICIPANTS_H
#define NEPH_HARNESS_PHYSICS_PARTICIPANTS_H

#include "harness/engines/engine.h"
#include "harness/physics/checks.h"

#include <stdbool.h>

enum { NEPH_PARTICIPANT_SETTINGS_MAX = 2 };

struct neph_participant {
    const char *name;                                    /* unique name for reports */
    const char *engine;                                  /* name in the registry of engines */
    const char *settings[NEPH_PARTICIPANT_SETTINGS_MAX]; /* "key=value"; NULL: none */
    /* A deterministic engine runs twice, the second time with this setting. The difference bounds
     * its step error by Richardson's rule of order `order`. NULL: the engine is stochastic and runs
     * with two seeds. */
    const char *refined;
    int order;
    /* Relative error of a mean that rounding in the engine's output may cause. */
    double rounding;
};

enum { NEPH_PARTICIPANTS = 8 };
extern const struct neph_participant neph_participants[NEPH_PARTICIPANTS];

/* Circumstances of a participant's result in a check. */
struct neph_participation {
    bool lowered; /* rendered single scattering of the sun instead of the full scene */
    bool baked;   /* rendered voxels that only approximate the medium */
    bool stepped; /* the deviation has the size of its measured step error */
};

/* The known cause of a participant's deviation in a check, as text after "because"; NULL:
 * unknown. */
const char *neph_participant_cause(const struct neph_participant *participant,
                                   const struct neph_check *check,
                                   const struct neph_participation *part);

#endif
