/* SPDX-License-Identifier: MIT
 *
 * Where names stand on a chart so that they lie neither on each other nor on marks, and on lines
 * only where there is no other place.
 */
#ifndef NEPH_HARNESS_SWEEP_LABELS_H
#define NEPH_HARNESS_SWEEP_LABELS_H

#include <stdbool.h>

/* A mark and its name, in pixels of the plot from its upper left corner. */
struct neph_label {
    double x_px, y_px;   /* of the mark */
    double width_px;     /* of the name; 0: the mark has none */
    double dx_px, dy_px; /* found: from the mark to the middle of the name's left edge */
    bool is_clear;       /* found: it lies on no mark, no name and no edge */
    bool is_apart;       /* found: so far from its mark that a line has to lead there: from
                            (x_px, y_px) to (lead_x_px, lead_y_px) */
    double lead_x_px, lead_y_px;
};

/* What names should not lie on: lines between marks, bars of intervals. */
struct neph_label_line {
    double x0_px, y0_px, x1_px, y1_px;
};

#define NEPH_LABEL_HEIGHT_PX 12.0
#define NEPH_MARK_RADIUS_PX 5.0

struct neph_label_plot {
    double width_px, height_px;
    double margin_px; /* by which names may pass the right edge */
    const struct neph_label_line *lines;
    int line_count;
};

/* Place the names in their order, each where it hides least: marks, other names and the edge of the
 * plot weigh by their area, lines by a few pixels of their length; of equal places the one nearest
 * to its mark. */
void neph_labels_place(struct neph_label *labels, int count, const struct neph_label_plot *plot);

#endif
