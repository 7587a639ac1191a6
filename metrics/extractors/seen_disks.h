/* SPDX-License-Identifier: MIT
 *
 * What changes together: the mean of a plane over disks of 1, 5 and 20 degrees radius, all over the
 * picture, frame by frame. What has the same phase adds up in it, what has not cancels. A disk is
 * cut by the border; the part that is there counts, with the area that it has.
 */
#ifndef NEPH_METRICS_EXTRACTORS_SEEN_DISKS_H
#define NEPH_METRICS_EXTRACTORS_SEEN_DISKS_H

#include "base/status.h"

#include <stddef.h>

enum { NEPH_SEEN_RADII = 3 };

extern const double neph_seen_radii_deg[NEPH_SEEN_RADII];

/* Disks of one radius, a third of it apart. */
struct neph_seen_grid {
    double radius_px;
    int columns, rows;
    int first; /* index of its first disk; by row from there */
};

struct neph_seen_disks {
    int width_px, height_px;
    double pixels_per_degree;
    struct neph_seen_grid grids[NEPH_SEEN_RADII];
    int disk_count;
};

struct neph_seen_disks neph_seen_disks_of(int width_px, int height_px, double pixels_per_degree);

const struct neph_seen_grid *neph_seen_grid_of(const struct neph_seen_disks *disks, int disk);

/* Radius [deg] of the round disk that has the area of what the picture leaves of this one. */
double neph_seen_cut_radius_deg(const struct neph_seen_disks *disks, int disk);

/* Mean over each disk. `sums`: of the values before each pixel of a row, width + 1 a row.
 * NEPH_ERR_INTERRUPTED. */
enum neph_status neph_seen_disk_means(const struct neph_seen_disks *disks, const double *sums,
                                      float *means, struct neph_diag *diag);

/* The values of one grid, `values` by disk, at a pixel: linear between the centres. */
double neph_seen_between(const struct neph_seen_disks *disks, int grid, const float *values,
                         int x_px, int y_px);

/* The disk of a grid whose centre is nearest to a pixel. */
int neph_seen_nearest(const struct neph_seen_disks *disks, int grid, int x_px, int y_px);

#endif
