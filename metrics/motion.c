/* SPDX-License-Identifier: MIT */
#include "metrics/motion.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_MOTION_DEPTH_COUNT == 2, "a new kind");

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Image centre, and pixels per unit of slope (offset / eye depth). */
struct lens {
    double centre_x_px, centre_y_px, px_per_slope;
};

static struct lens make_lens(const struct neph_motion_camera *camera, int width_px, int height_px)
{
    return (struct lens){.centre_x_px = 0.5 * width_px,
                         .centre_y_px = 0.5 * height_px,
                         .px_per_slope = 0.5 * height_px / tan(0.5 * camera->vertical_fov_rad)};
}

/* The direction through a pixel, with length 1 along the camera axis. */
static void compute_pixel_direction(const struct neph_motion_camera *camera,
                                    const struct lens *lens, double x_px, double y_px,
                                    double direction[3])
{
    const double right = (x_px - lens->centre_x_px) / lens->px_per_slope;
    const double up = (lens->centre_y_px - y_px) / lens->px_per_slope;
    for (int k = 0; k < 3; k++)
        direction[k] = right * camera->right[k] + up * camera->up[k] + camera->forward[k];
}

/* Vector from the previous camera to the visible point; for the sky only its direction matters. */
static void compute_previous_vector(const struct neph_motion_camera *now,
                                    const struct neph_motion_camera *before,
                                    const double direction[3], double depth_m,
                                    enum neph_motion_depth kind, double place[3])
{
    const double along = kind == NEPH_MOTION_DISTANCE ? depth_m / sqrt(dot(direction, direction))
                                                      : depth_m;
    for (int k = 0; k < 3; k++)
        place[k] = isinf(along) ? direction[k]
                                : now->position_m[k] - before->position_m[k] + along * direction[k];
}

struct moved {
    double x_px, y_px, depth_m;
};

static struct moved project_previous_point(const struct neph_motion_camera *before,
                                           const struct lens *lens, const double place[3],
                                           double depth_m, enum neph_motion_depth kind)
{
    const double axial = dot(place, before->forward);
    const double seen = kind == NEPH_MOTION_DISTANCE && axial > 0.0 ? sqrt(dot(place, place))
                                                                    : axial;
    return (struct moved){
        .x_px = lens->centre_x_px + lens->px_per_slope * dot(place, before->right) / axial,
        .y_px = lens->centre_y_px - lens->px_per_slope * dot(place, before->up) / axial,
        .depth_m = isinf(depth_m) && axial > 0.0 ? depth_m : seen,
    };
}

static float motion_from(double before_px, double now_px, bool in_front)
{
    const double motion_px = before_px - now_px;
    return in_front && fabs(motion_px) < (double)NEPH_MOTION_NOWHERE_PX ? (float)motion_px
                                                                        : NEPH_MOTION_NOWHERE_PX;
}

static enum neph_status fail_depth(double depth_m, int i, int j, struct neph_diag *diag)
{
    return neph_fail(diag, NEPH_ERR_INPUT, "the depth of the pixel (%d, %d) is %g m, not above 0",
                     i, j, depth_m);
}

enum neph_status neph_motion_from_depth(const struct neph_motion_camera *now,
                                        const struct neph_motion_camera *before, int width_px,
                                        int height_px, const float *depth_m,
                                        enum neph_motion_depth kind, float *x_px, float *y_px,
                                        float *before_m, struct neph_diag *diag)
{
    const struct lens lens_now = make_lens(now, width_px, height_px);
    const struct lens lens_before = make_lens(before, width_px, height_px);
    for (int j = 0; j < height_px; j++) {
        for (int i = 0; i < width_px; i++) {
            const size_t p = (size_t)j * (size_t)width_px + (size_t)i;
            const double depth = (double)depth_m[p], x = i + 0.5, y = j + 0.5;
            if (!(depth > 0.0))
                return fail_depth(depth, i, j, diag);
            double direction[3], place[3];
            compute_pixel_direction(now, &lens_now, x, y, direction);
            compute_previous_vector(now, before, direction, depth, kind, place);
            const struct moved moved = project_previous_point(before, &lens_before, place, depth,
                                                              kind);
            x_px[p] = motion_from(moved.x_px, x, moved.depth_m > 0.0);
            y_px[p] = motion_from(moved.y_px, y, moved.depth_m > 0.0);
            if (before_m)
                before_m[p] = (float)fmax(moved.depth_m, 0.0);
        }
    }
    return NEPH_OK;
}
