/* SPDX-License-Identifier: MIT
 *
 * Ranking of all compared frames of a run, largest error first, with the location and the cause of
 * each error. The measure is the RMSE of the radiance relative to the mean of the reference: a bias
 * near 0 may be the sum of large errors of both signs.
 */
#ifndef NEPH_HARNESS_REPORT_RANKING_H
#define NEPH_HARNESS_REPORT_RANKING_H

#include "harness/report/validation.h"

struct neph_ranked {
    const struct neph_scene_result *scene;
    const struct neph_frame_result *frame;
    const struct neph_measurement *number; /* the measurement that ranks it */
    bool is_failing;                       /* a gate of this engine and scene failed */
};

/* The measurement that ranks a frame, over the whole frame: the first available one of relative
 * RMSE of radiance, RMSE of transmittance, and relative RMSE of depth. NULL: there is none. */
const struct neph_measurement *neph_ranking_number(const struct neph_frame_result *frame);

/* List up to `most` frames of all scenes: frames with a failed gate first, then by their
 * measurement, then in the order of the run. Returns the number of frames. */
int neph_ranking(const struct neph_validation *validation, struct neph_ranked *list, int most);

/* One or more sentences about the location and the cause of a frame's error, derived from its
 * measurements. */
const char *neph_ranked_cause(const struct neph_ranked *ranked, struct neph_arena *arena);

/* The "ranking" of scripts/report/README.md. */
json_t *neph_ranking_json(const struct neph_validation *validation);

#endif
