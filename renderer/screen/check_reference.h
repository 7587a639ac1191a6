/* SPDX-License-Identifier: MIT
 *
 * CPU reference of the screen passes in double precision, pixel by pixel: each takes the targets
 * that earlier passes left on the device and computes the pass's result.
 */
#ifndef NEPH_SCREEN_CHECK_REFERENCE_H
#define NEPH_SCREEN_CHECK_REFERENCE_H

#include "renderer/screen/screen.h"
#include "renderer/shaders/constants.h"
#include "truth/directions.h"

#include <stdint.h>

struct vec2 {
    double x, y;
};

/* RGB and a fourth value. */
struct texel {
    double v[4];
};

/* A frame of a static scene with a static camera. */
struct reference {
    const struct neph_scene *scene;
    struct neph_camera camera;
    const double *values; /* of the settings */
    int width_px, height_px;
    double half_width, half_height;
    unsigned frame;                            /* number of earlier frames */
    const float *targets[SCREEN_TARGET_COUNT]; /* four values a pixel; NULL: not read back */
};

/* ---- positions, all in camera axes (check_reference.c) --------- */

int reference_choice(const struct reference *ref, int setting);
bool reference_is_inside(const struct reference *ref, int x, int y);
struct texel reference_load(const struct reference *ref, int target, int x, int y);
double reference_depth_m(const struct reference *ref, int x, int y);
bool reference_is_sky(const struct reference *ref, int x, int y);
struct neph_vec3 reference_normal(const struct reference *ref, int x, int y);
struct neph_vec3 reference_place_m(const struct reference *ref, struct vec2 place_px,
                                   double depth_m);
struct neph_vec3 reference_surface_m(const struct reference *ref, int x, int y);
bool reference_plane_at(const struct reference *ref, struct vec2 place_px, int x, int y,
                        struct neph_vec3 *point_m);
struct vec2 reference_project(const struct reference *ref, struct neph_vec3 point_m);
struct neph_vec3 reference_to_camera(const struct reference *ref, struct neph_vec3 point_m);
struct vec2 reference_tiled_noise(const struct reference *ref, int x, int y);
struct vec2 reference_ray_noise(int x, int y, uint32_t salt, uint32_t index);
/* The sampled pixel of a cell of the passes with a resolution setting (SCREEN_AO_RESOLUTION ..);
 * without a setting, the pixel itself. */
struct reference_pixel {
    int x, y;
};
int reference_cell_px(const struct reference *ref, int resolution);
struct reference_pixel reference_sampled_pixel(const struct reference *ref, int resolution, int x,
                                               int y);
/* The target with the light of a resolution after a number of smoothing passes (0: the mean), and
 * the target with the final cells. */
int reference_turned_at(int resolution, int turns);
int reference_cells_at(const struct reference *ref, int resolution);
/* The target with the final result of a pass for all pixels; -1: the pass is off. */
int reference_open_at(const struct reference *ref);
int reference_gi_at(const struct reference *ref);
int reference_ssr_at(const struct reference *ref);
/* Openness of a pixel; 1 when occlusion is off. */
double reference_open(const struct reference *ref, int x, int y);
/* Whether a pixel has light of a resolution at all (for occlusion: whether it is a surface). */
bool reference_has_light(const struct reference *ref, int resolution, int x, int y);
/* Radiance of the sky, where it lights solids. */
struct neph_vec3 reference_sky_light(const struct reference *ref);

/* ---- passes ---- */

/* SCREEN_OPEN of a cell (check_reference_ao.c). */
struct texel reference_ao(const struct reference *ref, int x, int y);

/* SCREEN_GI_RAW, SCREEN_SSR_RAW of a cell (check_reference_rays.c). */
struct texel reference_gi(const struct reference *ref, int x, int y);
struct texel reference_ssr(const struct reference *ref, int x, int y);

/* The point where the mirrored ray of a pixel meets the depth buffer, in camera axes; false: none.
 */
bool reference_mirror(const struct reference *ref, int x, int y, struct neph_vec3 *point_m);

/* SCREEN_GI_MEAN, SCREEN_SSR_MEAN of a cell (check_reference_mean.c). */
struct texel reference_mean(const struct reference *ref, int resolution, int x, int y);

/* SCREEN_OPEN_SMOOTH of a cell, and the result of smoothing pass `turn`, from 0
 * (check_reference_smooth.c). */
struct texel reference_blur(const struct reference *ref, int x, int y);
struct texel reference_smooth(const struct reference *ref, int resolution, int turn, int x, int y);

/* A pixel's value upsampled from the cells around it (check_reference_whole.c). */
struct texel reference_whole(const struct reference *ref, int resolution, int x, int y);

/* SCREEN_LIT, SCREEN_PICTURE (check_reference.c). */
struct texel reference_lit(const struct reference *ref, int x, int y);
struct texel reference_final(const struct reference *ref, int x, int y);

#endif
