/* SPDX-License-Identifier: MIT
 *
 * The chart of a flicker study. Drawn in C instead of Vega, so that a machine without node has it,
 * too.
 */
#ifndef NEPH_HARNESS_STUDY_FLICKER_PLOT_H
#define NEPH_HARNESS_STUDY_FLICKER_PLOT_H

#include "harness/study/flicker_study.h"

#include <stdio.h>

/* Writes flicker against lag as an SVG, with a point and intervals for each preset and floor.
 * Errors: NEPH_ERR_MEMORY. */
enum neph_status neph_flicker_study_plot(const struct neph_flicker_study *study, FILE *out,
                                         struct neph_diag *diag);

#endif
