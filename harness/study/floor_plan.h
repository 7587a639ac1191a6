/* SPDX-License-Identifier: MIT
 *
 * The floors of a flicker study: for each preset, configurations of the real-time renderer that
 * march every pixel in every frame, as preset `off` does, with anti-aliasing. What such a
 * configuration flickers and lags has other causes than the preset's division over frames.
 */
#ifndef NEPH_HARNESS_STUDY_FLOOR_PLAN_H
#define NEPH_HARNESS_STUDY_FLOOR_PLAN_H

#include "harness/study/flicker_study.h"

/* The settings of a preset's floor: preset `off` with the preset's group "march" and [0] its group
 * "anti aliasing", [1] that of the defaults. Errors as of neph_engine_parse_words(). */
enum neph_status neph_floor_settings(const struct neph_settings *preset,
                                     struct neph_settings floors[NEPH_STUDY_FLOOR_CANDIDATES],
                                     struct neph_diag *diag);

/* The presets of a study and the floors that are no preset of it, each of them once. */
struct neph_floor_plan {
    const char *words[NEPH_STUDY_CONFIGURATIONS_MAX]; /* the presets, then the floors */
    int preset_count, floor_count;
    struct neph_study_floor floors[NEPH_STUDY_PRESETS_MAX]; /* of each preset */
};

/* Plans the floors of presets that march `steps` steps: `off` with the settings of the group
 * "march" of the preset, and with those of the group "anti aliasing" of the preset or of the
 * defaults. A user engine has the default floor twice. Errors as of neph_engine_parse_words(), and
 * NEPH_ERR_MEMORY. */
enum neph_status neph_floor_plan_make(const char *const *presets, int preset_count, int steps,
                                      struct neph_arena *arena, struct neph_floor_plan *plan,
                                      struct neph_diag *diag);

#endif
