/* SPDX-License-Identifier: MIT */
#include "renderer/screen/check_reference.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

/* ---- targets --------------------------------------------------------------------------------- */

int reference_choice(const struct reference *ref, int setting)
{
    return (int)ref->values[setting];
}

bool reference_is_inside(const struct reference *ref, int x, int y)
{
    return x >= 0 && y >= 0 && x < ref->width_px && y < ref->height_px;
}

struct texel reference_load(const struct reference *ref, int target, int x, int y)
{
    const float *texel = &ref->targets[target][4 * ((size_t)y * (size_t)ref->width_px + (size_t)x)];
    return (struct texel){{texel[0], texel[1], texel[2], texel[3]}};
}

double reference_depth_m(const struct reference *ref, int x, int y)
{
    return reference_load(ref, SCREEN_DEPTH, x, y).v[0];
}

bool reference_is_sky(const struct reference *ref, int x, int y)
{
    return reference_depth_m(ref, x, y) >= NEPH_GPU_FAR_M;
}

struct neph_vec3 reference_normal(const struct reference *ref, int x, int y)
{
    const struct texel texel = reference_load(ref, SCREEN_NORMAL, x, y);
    return neph_vec3_normalize((struct neph_vec3){texel.v[0], texel.v[1], texel.v[2]});
}

int reference_cell_px(const struct reference *ref, int resolution)
{
    return ref->values[resolution] == SCREEN_HALF ? 2 : 1;
}

/* The order of the pixels of a cell: the first in frame 0, then its diagonal neighbour, then the
 * others. */
struct reference_pixel reference_sampled_pixel(const struct reference *ref, int resolution, int x,
                                               int y)
{
    const int side = reference_cell_px(ref, resolution);
    const int history = resolution == SCREEN_GI_RESOLUTION ? SCREEN_GI_HISTORY : SCREEN_SSR_HISTORY;
    const bool turns = side > 1 && resolution != SCREEN_AO_RESOLUTION &&
                       ref->values[SCREEN_RAY_PIXEL] == SCREEN_PIXEL_TURNING &&
                       ref->values[history] > 0.0;
    const unsigned turn = turns ? ref->frame % 4 : 0;
    const int right = side * x + (turn == 1 || turn == 2), down = side * y + turn % 2;
    return (struct reference_pixel){right < ref->width_px ? right : ref->width_px - 1,
                                    down < ref->height_px ? down : ref->height_px - 1};
}

static bool is_half(const struct reference *ref, int resolution)
{
    return ref->values[resolution] == SCREEN_HALF;
}

/* Two targets alternate. */
int reference_turned_at(int resolution, int turns)
{
    const bool is_gi = resolution == SCREEN_GI_RESOLUTION;
    if (turns == 0)
        return is_gi ? SCREEN_GI_MEAN : SCREEN_SSR_MEAN;
    return (is_gi ? SCREEN_GI_A : SCREEN_SSR_A) + (turns - 1) % 2;
}

int reference_cells_at(const struct reference *ref, int resolution)
{
    if (resolution == SCREEN_AO_RESOLUTION)
        return ref->values[SCREEN_AO_BLUR_PX] > 0.0 ? SCREEN_OPEN_SMOOTH : SCREEN_OPEN;
    const bool is_gi = resolution == SCREEN_GI_RESOLUTION;
    return reference_turned_at(resolution,
                               (int)ref->values[is_gi ? SCREEN_GI_SMOOTH : SCREEN_SSR_SMOOTH]);
}

int reference_open_at(const struct reference *ref)
{
    if (ref->values[SCREEN_AO] == SCREEN_AO_OFF)
        return -1;
    return is_half(ref, SCREEN_AO_RESOLUTION) ? SCREEN_OPEN_WHOLE
                                              : reference_cells_at(ref, SCREEN_AO_RESOLUTION);
}

double reference_open(const struct reference *ref, int x, int y)
{
    const int open_at = reference_open_at(ref);
    return open_at >= 0 ? reference_load(ref, open_at, x, y).v[0] : 1.0;
}

/* At half resolution the upsampling of cells is one more target. */
static int light_at(const struct reference *ref, int resolution, int smooth)
{
    return reference_turned_at(resolution, (int)ref->values[smooth] + is_half(ref, resolution));
}

int reference_gi_at(const struct reference *ref)
{
    return ref->values[SCREEN_GI] == 0.0 ? -1
                                         : light_at(ref, SCREEN_GI_RESOLUTION, SCREEN_GI_SMOOTH);
}

int reference_ssr_at(const struct reference *ref)
{
    return ref->values[SCREEN_SSR] == 0.0 ? -1
                                          : light_at(ref, SCREEN_SSR_RESOLUTION, SCREEN_SSR_SMOOTH);
}

bool reference_has_light(const struct reference *ref, int resolution, int x, int y)
{
    if (reference_is_sky(ref, x, y))
        return false;
    if (resolution == SCREEN_AO_RESOLUTION)
        return true;
    const double metalness = reference_load(ref, SCREEN_BASE, x, y).v[3];
    return resolution == SCREEN_GI_RESOLUTION ? metalness < 1.0 : metalness > 0.0;
}

struct neph_vec3 reference_sky_light(const struct reference *ref)
{
    const struct neph_rgb sky = ref->scene->background_w_per_m2_sr;
    return ref->scene->environment_light ? (struct neph_vec3){sky.r, sky.g, sky.b}
                                         : (struct neph_vec3){0.0, 0.0, 0.0};
}

/* ---- positions ------------------------------------------------------------------------------- */

static bool is_orthographic(const struct reference *ref)
{
    return ref->camera.orthographic_height_m > 0.0;
}

struct neph_vec3 reference_place_m(const struct reference *ref, struct vec2 place_px,
                                   double depth_m)
{
    const double scale = is_orthographic(ref) ? 1.0 : depth_m;
    return (struct neph_vec3){(2.0 * place_px.x / ref->width_px - 1.0) * ref->half_width * scale,
                              (1.0 - 2.0 * place_px.y / ref->height_px) * ref->half_height * scale,
                              depth_m};
}

struct neph_vec3 reference_surface_m(const struct reference *ref, int x, int y)
{
    return reference_place_m(ref, (struct vec2){x + 0.5, y + 0.5}, reference_depth_m(ref, x, y));
}

bool reference_plane_at(const struct reference *ref, struct vec2 place_px, int x, int y,
                        struct neph_vec3 *point_m)
{
    const struct neph_vec3 own_m = reference_surface_m(ref, x, y);
    const struct neph_vec3 normal = reference_normal(ref, x, y);
    const struct neph_vec3 near_m = reference_place_m(ref, place_px, own_m.z);
    const struct neph_vec3 sight = is_orthographic(ref) ? (struct neph_vec3){0.0, 0.0, 1.0}
                                                        : neph_vec3_scale(near_m, 1.0 / near_m.z);
    const double facing = -neph_vec3_dot(normal, sight);
    const double along = neph_vec3_dot(normal, neph_vec3_sub(near_m, own_m)) / fmax(facing, 1e-4);
    *point_m = neph_vec3_along(near_m, sight, along);
    return facing > 1e-4 && along > -0.5 * own_m.z && along < 10.0 * own_m.z;
}

struct vec2 reference_project(const struct reference *ref, struct neph_vec3 point_m)
{
    const double scale = is_orthographic(ref) ? 1.0 : point_m.z;
    return (struct vec2){
        (0.5 + 0.5 * point_m.x / scale / ref->half_width) * ref->width_px,
        (0.5 - 0.5 * point_m.y / scale / ref->half_height) * ref->height_px,
    };
}

struct neph_vec3 reference_to_camera(const struct reference *ref, struct neph_vec3 point_m)
{
    return is_orthographic(ref) ? (struct neph_vec3){0.0, 0.0, -1.0}
                                : neph_vec3_scale(neph_vec3_normalize(point_m), -1.0);
}

/* ---- noise ----------------------------------------------------------------------------------- */

static const struct vec2 golden = {0.754877666, 0.569840291};

static double fraction(double value)
{
    return value - floor(value);
}

struct vec2 reference_tiled_noise(const struct reference *ref, int x, int y)
{
    const double turn = ((((x + y) & 3) << 2) + (x & 3)) / 16.0, offset = ((y - x) & 3) / 4.0;
    return (struct vec2){fraction(turn + ref->frame * golden.x),
                         fraction(offset + ref->frame * golden.y)};
}

static void pcg3d(uint32_t v[3])
{
    for (int i = 0; i < 3; i++)
        v[i] = v[i] * 1664525u + 1013904223u;
    for (int round = 0; round < 2; round++) {
        v[0] += v[1] * v[2];
        v[1] += v[2] * v[0];
        v[2] += v[0] * v[1];
        for (int i = 0; i < 3 && round == 0; i++)
            v[i] ^= v[i] >> 16;
    }
}

struct vec2 reference_ray_noise(int x, int y, uint32_t salt, uint32_t index)
{
    uint32_t bits[3] = {(uint32_t)x, (uint32_t)y, salt};
    pcg3d(bits);
    return (struct vec2){fraction(ldexp((bits[0] >> 9) + 0.5, -23) + index * golden.x),
                         fraction(ldexp((bits[1] >> 9) + 0.5, -23) + index * golden.y)};
}

/* ---- composition ----------------------------------------------------------------------------- */

/* Indirect light reflected by a white surface; `target` below 0: of the sky only. */
static struct neph_vec3 indirect(const struct reference *ref, int target, int x, int y)
{
    const struct texel sky = {{0.0, 0.0, 0.0, reference_open(ref, x, y)}};
    const struct texel light = target >= 0 ? reference_load(ref, target, x, y) : sky;
    return neph_vec3_along((struct neph_vec3){light.v[0], light.v[1], light.v[2]},
                           reference_sky_light(ref), light.v[3]);
}

static struct texel composed(const struct reference *ref, int from, int target, bool of_metal,
                             int x, int y)
{
    struct texel light = reference_load(ref, from, x, y);
    const struct texel base = reference_load(ref, SCREEN_BASE, x, y);
    const double share = of_metal ? base.v[3] : 1.0 - base.v[3];
    light.v[3] = 1.0;
    if (reference_is_sky(ref, x, y))
        return light;
    const struct neph_vec3 more = indirect(ref, target, x, y);
    light.v[0] += base.v[0] * share * more.x;
    light.v[1] += base.v[1] * share * more.y;
    light.v[2] += base.v[2] * share * more.z;
    return light;
}

struct texel reference_lit(const struct reference *ref, int x, int y)
{
    return composed(ref, SCREEN_DIRECT, reference_gi_at(ref), false, x, y);
}

struct texel reference_final(const struct reference *ref, int x, int y)
{
    return composed(ref, SCREEN_LIT, reference_ssr_at(ref), true, x, y);
}
