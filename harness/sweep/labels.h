/* SPDX-License-Identifier: MIT
 *
 * Where names stand on a chart so that they lie neither on each other nor on marks.
 */
#ifndef NEPH_HARNESS_SWEEP_LABELS_H
#define NEPH_HARNESS_SWEEP_LABELS_H

#include <stdbool.h>

/* A mark and its name, in pixels of the plot from its upper left corner. */
struct neph_label {
    double x_px, y_px;   /* of the mark */
    double width_px;     /* of the name; 0: the mark has none */
    double dx_px, dy_px; /* found: from the mark to the middle of the name's left edge */
    bool is_clear;       /* found: it lies on nothing */
};

#define NEPH_LABEL_HEIGHT_PX 12.0
#define NEPH_MARK_RADIUS_PX 5.0

/* Place the names in their order, each at the nearest of the places around its mark that is clear
 * of all marks, of the names before it and of the plot's edges; where there is none, at the one
 * that lies on least. The right edge may be passed by `margin_px`. */
void neph_labels_place(struct neph_label *labels, int count, double width_px, double height_px,
                       double margin_px);

#endif
