/* SPDX-License-Identifier: MIT
 *
 * The chart of what stages make of error, flicker and milliseconds: a line for each row of a study,
 * a mark for each scene, all over one of the rows. Drawn here and not by Vega, so that a study on a
 * machine without node has it.
 */
#ifndef NEPH_HARNESS_STUDY_NUMBERS_PLOT_H
#define NEPH_HARNESS_STUDY_NUMBERS_PLOT_H

#include "harness/study/post_measure.h"

#include <stdio.h>

/* All borrowed. */
struct neph_numbers_plot {
    const struct neph_post_row *rows; /* ends with a NULL name */
    int base;                         /* the row that all are over */
    const char *over;                 /* what that one is: "the curve alone" */
    int scene_count;
    const char *const *scenes;
    const struct neph_post_numbers *numbers; /* of a scene `stride` after those of the one before */
    int stride;
};

/* As SVG. Panels of light leave out rows that leave it as it is. */
void neph_numbers_plot(const struct neph_numbers_plot *plot, FILE *out);

#endif
