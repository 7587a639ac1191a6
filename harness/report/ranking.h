/* SPDX-License-Identifier: MIT
 *
 * All compared frames of a run, the worst first, with where each is off and why. The measure is the
 * RMSE of the radiance, relative to the mean of the reference: a bias near 0 may be the sum of
 * large errors of both signs.
 */
#ifndef NEPH_HARNESS_REPORT_RANKING_H
#define NEPH_HARNESS_REPORT_RANKING_H

#include "harness/report/validation.h"

struct neph_ranked {
    const struct neph_scene_result *scene;
    const struct neph_frame_result *frame;
    const struct neph_measurement *number; /* that ranks it */
    bool is_failing;                       /* a gate of this engine and scene fails */
};

/* The number that ranks a frame, over the whole picture: the first of relative RMSE of radiance,
 * RMSE of transmittance, and relative RMSE of depth that was measured. NULL: none was. */
const struct neph_measurement *neph_ranking_number(const struct neph_frame_result *frame);

/* Up to `most` frames of all scenes, those with a failed gate first, then by their number, then in
 * the order of the run. Returns how many there are. */
int neph_ranking(const struct neph_validation *validation, struct neph_ranked *list, int most);

/* One or more sentences on where in the picture the error is, and what it comes from, from what was
 * measured of the frame; "" when nothing was. */
const char *neph_ranked_cause(const struct neph_ranked *ranked, struct neph_arena *arena);

/* As "ranking" in scripts/report/README.md. */
json_t *neph_ranking_json(const struct neph_validation *validation);

#endif
