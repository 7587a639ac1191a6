/* SPDX-License-Identifier: MIT
 *
 * Common change: the mean of a plane over disks of 1, 5 and 20 degrees radius, at positions all
 * over the image, for each frame. Change with the same phase adds up, other change cancels. A disk
 * is cut at the border; its inner part counts, with its own area.
 */
#ifndef NEPH_METRICS_EXTRACTORS_SEEN_DISKS_H
#define NEPH_METRICS_EXTRACTORS_SEEN_DISKS_H

#include "base/status.h"

#include <stddef.h>

enum { NEPH_SEEN_RADII = 3 };

extern const double neph_seen_radii_deg[NEPH_SEEN_RADII];

/* A grid of disks of one radius; centres are a third of it apart. */
struct neph_seen_grid {
    double radius_px;
    int columns, rows;
    int first; /* index of its first disk; others follow row by row */
};

struct neph_seen_disks {
    int width_px, height_px;
    double pixels_per_degree;
    struct neph_seen_grid grids[NEPH_SEEN_RADII];
    int disk_count;
};

struct neph_seen_disks neph_seen_disks_make(int width_px, int height_px, double pixels_per_degree);

const struct neph_seen_grid *neph_seen_grid_find(const struct neph_seen_disks *disks, int disk);

/* Radius [deg] of the full disk with the area of this disk's inner part. */
double neph_seen_cut_radius_deg(const struct neph_seen_disks *disks, int disk);

/* Mean over each disk. `sums`: prefix sums of each row, width + 1 per row. NEPH_ERR_INTERRUPTED. */
enum neph_status neph_seen_disk_means(const struct neph_seen_disks *disks, const double *sums,
                                      float *means, struct neph_diag *diag);

/* Interpolate the values of one grid (`values`: one per disk) at a pixel, linearly between the
 * centres. */
double neph_seen_between(const struct neph_seen_disks *disks, int grid, const float *values,
                         int x_px, int y_px);

/* The disk of a grid with its centre nearest to a pixel. */
int neph_seen_nearest(const struct neph_seen_disks *disks, int grid, int x_px, int y_px);

#endif
