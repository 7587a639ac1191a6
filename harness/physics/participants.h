/* SPDX-License-Identifier: MIT
 *
 * Who takes part in the physics suite, with which settings, and what is known about why they err.
 */
#ifndef NEPH_HARNESS_PHYSICS_PARTICIPANTS_H
#define NEPH_HARNESS_PHYSICS_PARTICIPANTS_H

#include "harness/engines/engine.h"
#include "harness/physics/checks.h"

#include <stdbool.h>

enum { NEPH_PARTICIPANT_SETTINGS_MAX = 2 };

struct neph_participant {
    const char *name;                                    /* unique, for reports */
    const char *engine;                                  /* of the registry */
    const char *settings[NEPH_PARTICIPANT_SETTINGS_MAX]; /* "key=value"; NULL: none */
    /* A deterministic engine is run twice, the second time with this setting: by Richardson's rule
     * of `order` the difference bounds its step error. NULL: stochastic, run with two seeds. */
    const char *refined;
    int order;
    /* Its numbers are rounded: what a mean may be off by, relative, for that alone. */
    double rounding;
};

enum { NEPH_PARTICIPANTS = 8 };
extern const struct neph_participant neph_participants[NEPH_PARTICIPANTS];

/* How a participant took part in a check. */
struct neph_participation {
    bool lowered; /* it was given the scene with single scattering from the sun alone */
    bool baked;   /* it was given voxels that are not quite the medium */
    bool stepped; /* its deviation is of the size of its own step error, as measured */
};

/* Why a participant is known to be off in a check, in words that follow "because"; NULL when
 * nothing is known. */
const char *neph_participant_cause(const struct neph_participant *participant,
                                   const struct neph_check *check,
                                   const struct neph_participation *part);

#endif
