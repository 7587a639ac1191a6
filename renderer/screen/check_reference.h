/* SPDX-License-Identifier: MIT
 *
 * The passes of the screen once more in C and in double precision, a pixel at a time: from what the
 * passes before have left on the device to what the pass makes of it.
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

/* RGB and a fourth. */
struct texel {
    double v[4];
};

/* A picture of a scene that stands still, before a camera that does. */
struct reference {
    const struct neph_scene *scene;
    struct neph_camera camera;
    const double *values; /* of the settings */
    int width_px, height_px;
    double half_width, half_height;
    unsigned frame;                            /* how many there were before */
    const float *targets[SCREEN_TARGET_COUNT]; /* four numbers a pixel; NULL: not read */
};

/* ---- places (references/screen.c); all in the camera's axes ---- */

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
struct vec2 reference_pixel_of(const struct reference *ref, struct neph_vec3 point_m);
struct neph_vec3 reference_to_camera(const struct reference *ref, struct neph_vec3 point_m);
struct vec2 reference_tiled_noise(const struct reference *ref, int x, int y);
struct vec2 reference_ray_noise(int x, int y, uint32_t salt, uint32_t index);
/* The pixel that a cell of the passes of a resolution (SCREEN_AO_RESOLUTION ..) looks at; without
 * one, itself. */
struct reference_pixel {
    int x, y;
};
int reference_cell_px(const struct reference *ref, int resolution);
struct reference_pixel reference_pixel_in(const struct reference *ref, int resolution, int x,
                                          int y);
/* Which target has the light of a resolution after so many turns of the smoothing (0: the mean),
 * and what its cells end up with. */
int reference_turned_at(int resolution, int turns);
int reference_cells_at(const struct reference *ref, int resolution);
/* Which target has what a pass has made of all pixels; -1: the pass is off. */
int reference_open_at(const struct reference *ref);
int reference_gi_at(const struct reference *ref);
int reference_ssr_at(const struct reference *ref);
/* What is open over a pixel; 1 where nobody looks. */
double reference_open(const struct reference *ref, int x, int y);
/* Whether a pixel has the light of a resolution at all (of occlusion: whether it is a surface). */
bool reference_has_light(const struct reference *ref, int resolution, int x, int y);
/* The sky, where it lights solids. */
struct neph_vec3 reference_sky_light(const struct reference *ref);

/* ---- passes ---- */

/* SCREEN_OPEN of a cell (references/screen_ao.c). */
struct texel reference_ao(const struct reference *ref, int x, int y);

/* SCREEN_GI_RAW, SCREEN_SSR_RAW of a cell (references/screen_rays.c). */
struct texel reference_gi(const struct reference *ref, int x, int y);
struct texel reference_ssr(const struct reference *ref, int x, int y);

/* Where a mirror's first ray meets what is seen; false: nothing. In the camera's axes. */
bool reference_mirror(const struct reference *ref, int x, int y, struct neph_vec3 *point_m);

/* SCREEN_GI_MEAN, SCREEN_SSR_MEAN of a cell (references/screen_mean.c). */
struct texel reference_mean(const struct reference *ref, int resolution, int x, int y);

/* SCREEN_OPEN_SMOOTH of a cell, and what a turn (0..) of the smoothing makes of it
 * (references/screen_smooth.c). */
struct texel reference_blur(const struct reference *ref, int x, int y);
struct texel reference_smooth(const struct reference *ref, int resolution, int turn, int x, int y);

/* What a pixel has of the cells around it (references/screen_whole.c). */
struct texel reference_whole(const struct reference *ref, int resolution, int x, int y);

/* SCREEN_LIT, SCREEN_PICTURE (references/screen.c). */
struct texel reference_lit(const struct reference *ref, int x, int y);
struct texel reference_final(const struct reference *ref, int x, int y);

#endif
