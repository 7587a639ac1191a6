/* SPDX-License-Identifier: MIT
 *
 * The chart of a flicker study. It is drawn here and not by Vega, so that a study on a machine
 * without node has it.
 */
#ifndef NEPH_HARNESS_STUDY_FLICKER_PLOT_H
#define NEPH_HARNESS_STUDY_FLICKER_PLOT_H

#include "harness/study/flicker_study.h"

#include <stdio.h>

/* Flicker seen against lag as an SVG picture, a point with intervals for each preset. Errors:
 * NEPH_ERR_MEMORY. */
enum neph_status neph_flicker_study_plot(const struct neph_flicker_study *study, FILE *out,
                                         struct neph_diag *diag);

#endif
