/* SPDX-License-Identifier: MIT */
#include "tests/renderer/twins/screen.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

/* ---- targets --------------------------------------------------------------------------------- */

int twin_screen_choice(const struct twin_screen *twin, int setting)
{
    return (int)twin->values[setting];
}

bool twin_screen_is_inside(const struct twin_screen *twin, int x, int y)
{
    return x >= 0 && y >= 0 && x < twin->width_px && y < twin->height_px;
}

struct texel twin_screen_load(const struct twin_screen *twin, int target, int x, int y)
{
    const float *texel =
        &twin->targets[target][4 * ((size_t)y * (size_t)twin->width_px + (size_t)x)];
    return (struct texel){{texel[0], texel[1], texel[2], texel[3]}};
}

double twin_screen_depth_m(const struct twin_screen *twin, int x, int y)
{
    return twin_screen_load(twin, SCREEN_DEPTH, x, y).v[0];
}

bool twin_screen_is_sky(const struct twin_screen *twin, int x, int y)
{
    return twin_screen_depth_m(twin, x, y) >= NEPH_GPU_FAR_M;
}

struct neph_vec3 twin_screen_normal(const struct twin_screen *twin, int x, int y)
{
    const struct texel texel = twin_screen_load(twin, SCREEN_NORMAL, x, y);
    return neph_vec3_normalize((struct neph_vec3){texel.v[0], texel.v[1], texel.v[2]});
}

int twin_screen_cell_px(const struct twin_screen *twin, int resolution)
{
    return twin->values[resolution] == SCREEN_HALF ? 2 : 1;
}

/* In frame 0 the first of four, then the one across, and the other two. */
struct twin_pixel twin_screen_pixel_in(const struct twin_screen *twin, int resolution, int x, int y)
{
    const int side = twin_screen_cell_px(twin, resolution);
    const int history = resolution == SCREEN_GI_RESOLUTION ? SCREEN_GI_HISTORY : SCREEN_SSR_HISTORY;
    const bool turns = side > 1 && resolution != SCREEN_AO_RESOLUTION &&
                       twin->values[SCREEN_RAY_PIXEL] == SCREEN_PIXEL_TURNING &&
                       twin->values[history] > 0.0;
    const unsigned turn = turns ? twin->frame % 4 : 0;
    const int right = side * x + (turn == 1 || turn == 2), down = side * y + turn % 2;
    return (struct twin_pixel){right < twin->width_px ? right : twin->width_px - 1,
                               down < twin->height_px ? down : twin->height_px - 1};
}

static bool is_half(const struct twin_screen *twin, int resolution)
{
    return twin->values[resolution] == SCREEN_HALF;
}

/* Two take turns. */
int twin_screen_turned_at(int resolution, int turns)
{
    const bool is_gi = resolution == SCREEN_GI_RESOLUTION;
    if (turns == 0)
        return is_gi ? SCREEN_GI_MEAN : SCREEN_SSR_MEAN;
    return (is_gi ? SCREEN_GI_A : SCREEN_SSR_A) + (turns - 1) % 2;
}

int twin_screen_cells_at(const struct twin_screen *twin, int resolution)
{
    if (resolution == SCREEN_AO_RESOLUTION)
        return twin->values[SCREEN_AO_BLUR_PX] > 0.0 ? SCREEN_OPEN_SMOOTH : SCREEN_OPEN;
    const bool is_gi = resolution == SCREEN_GI_RESOLUTION;
    return twin_screen_turned_at(resolution,
                                 (int)twin->values[is_gi ? SCREEN_GI_SMOOTH : SCREEN_SSR_SMOOTH]);
}

int twin_screen_open_at(const struct twin_screen *twin)
{
    if (twin->values[SCREEN_AO] == SCREEN_AO_OFF)
        return -1;
    return is_half(twin, SCREEN_AO_RESOLUTION) ? SCREEN_OPEN_WHOLE
                                               : twin_screen_cells_at(twin, SCREEN_AO_RESOLUTION);
}

double twin_screen_open(const struct twin_screen *twin, int x, int y)
{
    const int open_at = twin_screen_open_at(twin);
    return open_at >= 0 ? twin_screen_load(twin, open_at, x, y).v[0] : 1.0;
}

/* What makes cells whole is one turn more. */
static int light_at(const struct twin_screen *twin, int resolution, int smooth)
{
    return twin_screen_turned_at(resolution, (int)twin->values[smooth] + is_half(twin, resolution));
}

int twin_screen_gi_at(const struct twin_screen *twin)
{
    return twin->values[SCREEN_GI] == 0.0 ? -1
                                          : light_at(twin, SCREEN_GI_RESOLUTION, SCREEN_GI_SMOOTH);
}

int twin_screen_ssr_at(const struct twin_screen *twin)
{
    return twin->values[SCREEN_SSR] == 0.0
               ? -1
               : light_at(twin, SCREEN_SSR_RESOLUTION, SCREEN_SSR_SMOOTH);
}

bool twin_screen_has_light(const struct twin_screen *twin, int resolution, int x, int y)
{
    if (twin_screen_is_sky(twin, x, y))
        return false;
    if (resolution == SCREEN_AO_RESOLUTION)
        return true;
    const double metalness = twin_screen_load(twin, SCREEN_BASE, x, y).v[3];
    return resolution == SCREEN_GI_RESOLUTION ? metalness < 1.0 : metalness > 0.0;
}

struct neph_vec3 twin_screen_sky_light(const struct twin_screen *twin)
{
    const struct neph_rgb sky = twin->scene->background_w_per_m2_sr;
    return twin->scene->environment_light ? (struct neph_vec3){sky.r, sky.g, sky.b}
                                          : (struct neph_vec3){0.0, 0.0, 0.0};
}

/* ---- places ---------------------------------------------------------------------------------- */

static bool is_orthographic(const struct twin_screen *twin)
{
    return twin->camera.orthographic_height_m > 0.0;
}

struct neph_vec3 twin_screen_place_m(const struct twin_screen *twin, struct vec2 place_px,
                                     double depth_m)
{
    const double scale = is_orthographic(twin) ? 1.0 : depth_m;
    return (struct neph_vec3){
        (2.0 * place_px.x / twin->width_px - 1.0) * twin->half_width * scale,
        (1.0 - 2.0 * place_px.y / twin->height_px) * twin->half_height * scale, depth_m};
}

struct neph_vec3 twin_screen_surface_m(const struct twin_screen *twin, int x, int y)
{
    return twin_screen_place_m(twin, (struct vec2){x + 0.5, y + 0.5},
                               twin_screen_depth_m(twin, x, y));
}

bool twin_screen_plane_at(const struct twin_screen *twin, struct vec2 place_px, int x, int y,
                          struct neph_vec3 *point_m)
{
    const struct neph_vec3 own_m = twin_screen_surface_m(twin, x, y);
    const struct neph_vec3 normal = twin_screen_normal(twin, x, y);
    const struct neph_vec3 near_m = twin_screen_place_m(twin, place_px, own_m.z);
    const struct neph_vec3 sight = is_orthographic(twin) ? (struct neph_vec3){0.0, 0.0, 1.0}
                                                         : neph_vec3_scale(near_m, 1.0 / near_m.z);
    const double facing = -neph_vec3_dot(normal, sight);
    const double along = neph_vec3_dot(normal, neph_vec3_sub(near_m, own_m)) / fmax(facing, 1e-4);
    *point_m = neph_vec3_along(near_m, sight, along);
    return facing > 1e-4 && along > -0.5 * own_m.z && along < 10.0 * own_m.z;
}

struct vec2 twin_screen_pixel_of(const struct twin_screen *twin, struct neph_vec3 point_m)
{
    const double scale = is_orthographic(twin) ? 1.0 : point_m.z;
    return (struct vec2){
        (0.5 + 0.5 * point_m.x / scale / twin->half_width) * twin->width_px,
        (0.5 - 0.5 * point_m.y / scale / twin->half_height) * twin->height_px,
    };
}

struct neph_vec3 twin_screen_to_camera(const struct twin_screen *twin, struct neph_vec3 point_m)
{
    return is_orthographic(twin) ? (struct neph_vec3){0.0, 0.0, -1.0}
                                 : neph_vec3_scale(neph_vec3_normalize(point_m), -1.0);
}

void twin_basis_across(struct neph_vec3 axis, struct neph_vec3 *first, struct neph_vec3 *second)
{
    const double side = axis.z >= 0.0 ? 1.0 : -1.0;
    const double a = -1.0 / (side + axis.z), b = axis.x * axis.y * a;
    *first = (struct neph_vec3){1.0 + side * axis.x * axis.x * a, side * b, -side * axis.x};
    *second = (struct neph_vec3){b, side + axis.y * axis.y * a, -axis.y};
}

/* ---- noise ----------------------------------------------------------------------------------- */

static const struct vec2 golden = {0.754877666, 0.569840291};

static double fraction(double value)
{
    return value - floor(value);
}

struct vec2 twin_screen_tiled_noise(const struct twin_screen *twin, int x, int y)
{
    const double turn = ((((x + y) & 3) << 2) + (x & 3)) / 16.0, offset = ((y - x) & 3) / 4.0;
    return (struct vec2){fraction(turn + twin->frame * golden.x),
                         fraction(offset + twin->frame * golden.y)};
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

struct vec2 twin_screen_ray_noise(int x, int y, uint32_t salt, uint32_t index)
{
    uint32_t bits[3] = {(uint32_t)x, (uint32_t)y, salt};
    pcg3d(bits);
    return (struct vec2){fraction(ldexp((bits[0] >> 9) + 0.5, -23) + index * golden.x),
                         fraction(ldexp((bits[1] >> 9) + 0.5, -23) + index * golden.y)};
}

/* ---- composition ----------------------------------------------------------------------------- */

/* Light of other surfaces and of the sky off a white one; `target` below 0: of the sky alone. */
static struct neph_vec3 indirect(const struct twin_screen *twin, int target, int x, int y)
{
    const struct texel sky = {{0.0, 0.0, 0.0, twin_screen_open(twin, x, y)}};
    const struct texel light = target >= 0 ? twin_screen_load(twin, target, x, y) : sky;
    return neph_vec3_along((struct neph_vec3){light.v[0], light.v[1], light.v[2]},
                           twin_screen_sky_light(twin), light.v[3]);
}

static struct texel composed(const struct twin_screen *twin, int from, int target, bool of_metal,
                             int x, int y)
{
    struct texel light = twin_screen_load(twin, from, x, y);
    const struct texel base = twin_screen_load(twin, SCREEN_BASE, x, y);
    const double share = of_metal ? base.v[3] : 1.0 - base.v[3];
    light.v[3] = 1.0;
    if (twin_screen_is_sky(twin, x, y))
        return light;
    const struct neph_vec3 more = indirect(twin, target, x, y);
    light.v[0] += base.v[0] * share * more.x;
    light.v[1] += base.v[1] * share * more.y;
    light.v[2] += base.v[2] * share * more.z;
    return light;
}

struct texel twin_screen_lit(const struct twin_screen *twin, int x, int y)
{
    return composed(twin, SCREEN_DIRECT, twin_screen_gi_at(twin), false, x, y);
}

struct texel twin_screen_final(const struct twin_screen *twin, int x, int y)
{
    return composed(twin, SCREEN_LIT, twin_screen_ssr_at(twin), true, x, y);
}
