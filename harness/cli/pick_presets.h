/* SPDX-License-Identifier: MIT
 *
 * `neph pick --presets`: a preset out of several, over many scenes.
 */
#ifndef NEPH_HARNESS_CLI_PICK_PRESETS_H
#define NEPH_HARNESS_CLI_PICK_PRESETS_H

#include "harness/sweep/choice.h"

/* All is borrowed. */
struct neph_cli_pick_presets {
    const char *presets, *least; /* "A,B"; a name of neph_choice_measures */
    const char *suite;           /* NULL: the scenes, or "tuning" without any */
    const char *const *scenes;
    int scene_count;
    double budget[NEPH_CHOICE_NUMBERS]; /* NaN: any */
    int seed_count, frame_count, steps, width_px, height_px;
    const char *output;
    bool json, quiet;
};

/* Measure, print, write OUTPUT/pick.json and OUTPUT/flicker_lag.svg. NEPH_ERR_GATE: none is within
 * the budget. */
enum neph_status neph_cli_pick_presets(const struct neph_cli_pick_presets *asked,
                                       struct neph_diag *diag);

#endif
