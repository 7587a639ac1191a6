/* SPDX-License-Identifier: MIT
 *
 * The chart of error, flicker and milliseconds of post-processing stages: a line for each row of a
 * study, a mark for each scene, all relative to one of the rows. Drawn in C instead of Vega, so
 * that a machine without node has it, too.
 */
#ifndef NEPH_HARNESS_STUDY_NUMBERS_PLOT_H
#define NEPH_HARNESS_STUDY_NUMBERS_PLOT_H

#include "harness/study/post_measure.h"

#include <stdio.h>

/* All pointers are borrowed. */
struct neph_numbers_plot {
    const struct neph_post_row *rows; /* ends with a NULL name */
    int base;                         /* the row that all values are divided by */
    const char *over;                 /* its name in the chart: "the curve alone" */
    int scene_count;
    const char *const *scenes;
    const struct neph_post_numbers *numbers; /* `stride` entries per scene */
    int stride;
};

/* Writes the chart as SVG. The panels of light leave out rows without a change. */
void neph_numbers_plot(const struct neph_numbers_plot *plot, FILE *out);

#endif
