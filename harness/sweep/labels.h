/* SPDX-License-Identifier: MIT
 *
 * Placement of names on a chart: without overlaps of names and marks, and on lines only where there
 * is no other place.
 */
#ifndef NEPH_HARNESS_SWEEP_LABELS_H
#define NEPH_HARNESS_SWEEP_LABELS_H

#include <stdbool.h>

/* A mark and its name, in pixels from the plot's upper left corner. */
struct neph_label {
    double x_px, y_px;   /* of the mark */
    double width_px;     /* of the name; 0: no name */
    double dx_px, dy_px; /* result: from the mark to the middle of the name's left edge */
    bool is_clear;       /* result: no overlap with marks, names or the edge */
    bool is_apart;       /* result: needs a leader line, from (x_px, y_px) to (lead_x_px, lead_y_px)
                            */
    double lead_x_px, lead_y_px;
};

/* A line that names should not cover: between marks, or of an interval. */
struct neph_label_line {
    double x0_px, y0_px, x1_px, y1_px;
};

#define NEPH_LABEL_HEIGHT_PX 12.0
#define NEPH_MARK_RADIUS_PX 5.0

struct neph_label_plot {
    double width_px, height_px;
    double margin_px; /* names may extend beyond the right edge by this */
    const struct neph_label_line *lines;
    int line_count;
};

/* Places the names in their order, each where it covers least. Marks, other names and space outside
 * of the plot count by area, lines by length times a few pixels; among equal places the nearest
 * one. */
void neph_labels_place(struct neph_label *labels, int count, const struct neph_label_plot *plot);

#endif
