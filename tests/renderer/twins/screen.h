/* SPDX-License-Identifier: MIT
 *
 * The passes of the screen once more in C and in double precision, a pixel at a time: from what the
 * passes before have left on the device to what the pass makes of it.
 */
#ifndef NEPH_TESTS_TWINS_SCREEN_H
#define NEPH_TESTS_TWINS_SCREEN_H

#include "renderer/screen/screen.h"
#include "renderer/shaders/constants.h"

#include <stdint.h>

struct vec2 {
    double x, y;
};

/* RGB and a fourth. */
struct texel {
    double v[4];
};

/* A picture of a scene that stands still, before a camera that does. */
struct twin_screen {
    const struct neph_scene *scene;
    struct neph_camera camera;
    const double *values; /* of the settings */
    int width_px, height_px;
    double half_width, half_height;
    unsigned frame;                            /* how many there were before */
    const float *targets[SCREEN_TARGET_COUNT]; /* four numbers a pixel; NULL: not read */
};

/* ---- places (twins/screen.c); all in the camera's axes ---- */

int twin_screen_choice(const struct twin_screen *twin, int setting);
bool twin_screen_is_inside(const struct twin_screen *twin, int x, int y);
struct texel twin_screen_load(const struct twin_screen *twin, int target, int x, int y);
double twin_screen_depth_m(const struct twin_screen *twin, int x, int y);
bool twin_screen_is_sky(const struct twin_screen *twin, int x, int y);
struct neph_vec3 twin_screen_normal(const struct twin_screen *twin, int x, int y);
struct neph_vec3 twin_screen_place_m(const struct twin_screen *twin, struct vec2 place_px,
                                     double depth_m);
struct neph_vec3 twin_screen_surface_m(const struct twin_screen *twin, int x, int y);
bool twin_screen_plane_at(const struct twin_screen *twin, struct vec2 place_px, int x, int y,
                          struct neph_vec3 *point_m);
struct vec2 twin_screen_pixel_of(const struct twin_screen *twin, struct neph_vec3 point_m);
struct neph_vec3 twin_screen_to_camera(const struct twin_screen *twin, struct neph_vec3 point_m);
void twin_basis_across(struct neph_vec3 axis, struct neph_vec3 *first, struct neph_vec3 *second);
struct vec2 twin_screen_tiled_noise(const struct twin_screen *twin, int x, int y);
struct vec2 twin_screen_ray_noise(int x, int y, uint32_t salt, uint32_t index);
/* The pixel that a cell of the passes of a resolution (SCREEN_AO_RESOLUTION ..) looks at; without
 * one, itself. */
struct twin_pixel {
    int x, y;
};
int twin_screen_cell_px(const struct twin_screen *twin, int resolution);
struct twin_pixel twin_screen_pixel_in(const struct twin_screen *twin, int resolution, int x,
                                       int y);
/* Which target has the light of a resolution after so many turns of the smoothing (0: the mean),
 * and what its cells end up with. */
int twin_screen_turned_at(int resolution, int turns);
int twin_screen_cells_at(const struct twin_screen *twin, int resolution);
/* Which target has what a pass has made of all pixels; -1: the pass is off. */
int twin_screen_open_at(const struct twin_screen *twin);
int twin_screen_gi_at(const struct twin_screen *twin);
int twin_screen_ssr_at(const struct twin_screen *twin);
/* What is open over a pixel; 1 where nobody looks. */
double twin_screen_open(const struct twin_screen *twin, int x, int y);
/* Whether a pixel has the light of a resolution at all (of occlusion: whether it is a surface). */
bool twin_screen_has_light(const struct twin_screen *twin, int resolution, int x, int y);
/* The sky, where it lights solids. */
struct neph_vec3 twin_screen_sky_light(const struct twin_screen *twin);

/* ---- passes ---- */

/* SCREEN_OPEN of a cell (twins/screen_ao.c). */
double twin_screen_ao(const struct twin_screen *twin, int x, int y);

/* SCREEN_GI_RAW, SCREEN_SSR_RAW of a cell (twins/screen_rays.c). */
struct texel twin_screen_gi(const struct twin_screen *twin, int x, int y);
struct texel twin_screen_ssr(const struct twin_screen *twin, int x, int y);

/* Where a mirror's first ray meets what is seen; false: nothing. In the camera's axes. */
bool twin_screen_mirror(const struct twin_screen *twin, int x, int y, struct neph_vec3 *point_m);

/* SCREEN_GI_MEAN, SCREEN_SSR_MEAN of a cell (twins/screen_mean.c). */
struct texel twin_screen_mean(const struct twin_screen *twin, int resolution, int x, int y);

/* SCREEN_OPEN_SMOOTH of a cell, and what a turn (0..) of the smoothing makes of it
 * (twins/screen_smooth.c). */
double twin_screen_blur(const struct twin_screen *twin, int x, int y);
struct texel twin_screen_smooth(const struct twin_screen *twin, int resolution, int turn, int x,
                                int y);

/* What a pixel has of the cells around it (twins/screen_whole.c). */
struct texel twin_screen_whole(const struct twin_screen *twin, int resolution, int x, int y);

/* SCREEN_LIT, SCREEN_PICTURE (twins/screen.c). */
struct texel twin_screen_lit(const struct twin_screen *twin, int x, int y);
struct texel twin_screen_final(const struct twin_screen *twin, int x, int y);

#endif
