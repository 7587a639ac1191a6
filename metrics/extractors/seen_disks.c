/* SPDX-License-Identifier: MIT */
#include "metrics/extractors/seen_disks.h"

#include "base/threads.h"

#include <math.h>

const double neph_seen_radii_deg[NEPH_SEEN_RADII] = {1.0, 5.0, 20.0};

/* Number of centres along a side. */
static int count_along(int side_px, double radius_px)
{
    const double spacing_px = fmax(radius_px / 3.0, 1.0);
    return (int)fmax(round(side_px / spacing_px), 1.0);
}

struct neph_seen_disks neph_seen_disks_make(int width_px, int height_px, double pixels_per_degree)
{
    struct neph_seen_disks disks = {
        .width_px = width_px, .height_px = height_px, .pixels_per_degree = pixels_per_degree};
    for (int g = 0; g < NEPH_SEEN_RADII; g++) {
        const double radius_px = neph_seen_radii_deg[g] * pixels_per_degree;
        disks.grids[g] = (struct neph_seen_grid){radius_px, count_along(width_px, radius_px),
                                                 count_along(height_px, radius_px),
                                                 disks.disk_count};
        disks.disk_count += disks.grids[g].columns * disks.grids[g].rows;
    }
    return disks;
}

const struct neph_seen_grid *neph_seen_grid_find(const struct neph_seen_disks *disks, int disk)
{
    int g = 0;
    while (g + 1 < NEPH_SEEN_RADII && disk >= disks->grids[g + 1].first)
        g++;
    return &disks->grids[g];
}

/* Centre number `index` of `count` along a side. */
static int centre_px(int index, int count, int side_px)
{
    return (int)((index + 0.5) * side_px / count);
}

/* A row of a disk, from `begin` (included) to `end` (excluded). */
struct span {
    int begin, end;
};

static int lesser(int a, int b)
{
    return a < b ? a : b;
}

static int greater(int a, int b)
{
    return a > b ? a : b;
}

/* The extent of a disk within the image. */
struct extent {
    int x_px, y_px;
    double radius_px;
    struct span rows;
};

static struct extent compute_disk_extent(const struct neph_seen_disks *disks, int disk)
{
    const struct neph_seen_grid *grid = neph_seen_grid_find(disks, disk);
    const int place = disk - grid->first, reach_px = (int)grid->radius_px;
    const int x_px = centre_px(place % grid->columns, grid->columns, disks->width_px);
    const int y_px = centre_px(place / grid->columns, grid->rows, disks->height_px);
    return (struct extent){
        x_px,
        y_px,
        grid->radius_px,
        {greater(y_px - reach_px, 0), lesser(y_px + reach_px + 1, disks->height_px)}};
}

static struct span compute_row_span(const struct neph_seen_disks *disks,
                                    const struct extent *extent, int row)
{
    const double dy = row - extent->y_px;
    const int reach_px = (int)sqrt(extent->radius_px * extent->radius_px - dy * dy);
    return (struct span){greater(extent->x_px - reach_px, 0),
                         lesser(extent->x_px + reach_px + 1, disks->width_px)};
}

static double area_px2(const struct neph_seen_disks *disks, const struct extent *extent)
{
    double area = 0.0;
    for (int row = extent->rows.begin; row < extent->rows.end; row++) {
        const struct span span = compute_row_span(disks, extent, row);
        area += span.end - span.begin;
    }
    return area;
}

double neph_seen_cut_radius_deg(const struct neph_seen_disks *disks, int disk)
{
    const struct extent extent = compute_disk_extent(disks, disk);
    return sqrt(area_px2(disks, &extent) / M_PI) / disks->pixels_per_degree;
}

struct work {
    const struct neph_seen_disks *disks;
    const double *sums;
    float *means;
};

static void take_mean(int disk, void *context)
{
    const struct work *work = context;
    const struct extent extent = compute_disk_extent(work->disks, disk);
    double sum = 0.0, area = 0.0;
    for (int row = extent.rows.begin; row < extent.rows.end; row++) {
        const double *sums = work->sums + (size_t)row * ((size_t)work->disks->width_px + 1);
        const struct span span = compute_row_span(work->disks, &extent, row);
        sum += sums[span.end] - sums[span.begin];
        area += span.end - span.begin;
    }
    work->means[disk] = (float)(sum / area);
}

enum neph_status neph_seen_disk_means(const struct neph_seen_disks *disks, const double *sums,
                                      float *means, struct neph_diag *diag)
{
    struct work work = {disks, sums, means};
    return neph_parallel_rows(disks->disk_count, take_mean, &work, diag);
}

/* A pixel's position between two centres: the indices before and after, and the part of the
 * distance. */
struct between {
    int before, after;
    double share;
};

static struct between between_centres(int at_px, int count, int side_px)
{
    const double place = (at_px + 0.5) * count / side_px - 0.5;
    const double positive = place > 0.0 ? place : 0.0;
    const double clamped = positive < count - 1.0 ? positive : count - 1.0;
    const int before = (int)clamped;
    return (struct between){before, lesser(before + 1, count - 1), clamped - before};
}

double neph_seen_between(const struct neph_seen_disks *disks, int grid, const float *values,
                         int x_px, int y_px)
{
    const struct neph_seen_grid *g = &disks->grids[grid];
    const struct between x = between_centres(x_px, g->columns, disks->width_px);
    const struct between y = between_centres(y_px, g->rows, disks->height_px);
    const float *above = values + g->first + y.before * g->columns;
    const float *below = values + g->first + y.after * g->columns;
    const double top = (double)above[x.before] * (1.0 - x.share) + (double)above[x.after] * x.share;
    const double bottom = (double)below[x.before] * (1.0 - x.share) +
                          (double)below[x.after] * x.share;
    return top * (1.0 - y.share) + bottom * y.share;
}

int neph_seen_nearest(const struct neph_seen_disks *disks, int grid, int x_px, int y_px)
{
    const struct neph_seen_grid *g = &disks->grids[grid];
    const struct between x = between_centres(x_px, g->columns, disks->width_px);
    const struct between y = between_centres(y_px, g->rows, disks->height_px);
    return g->first + (y.share < 0.5 ? y.before : y.after) * g->columns +
           (x.share < 0.5 ? x.before : x.after);
}
