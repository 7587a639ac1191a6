/* SPDX-License-Identifier: MIT */
#include "scenes/surface.h"

#include "scenes/solids.h"

#include <math.h>
#include <stdint.h>

static uint32_t pcg3d_first(uint32_t x, uint32_t y, uint32_t z)
{
    uint32_t v[3] = {x, y, z};
    for (int k = 0; k < 3; k++)
        v[k] = v[k] * 1664525u + 1013904223u;
    for (int k = 0; k < 3; k++)
        v[k] += v[(k + 1) % 3] * v[(k + 2) % 3];
    for (int k = 0; k < 3; k++)
        v[k] ^= v[k] >> 16;
    return v[0] + v[1] * v[2];
}

static uint32_t wrap(int cell)
{
    return (uint32_t)cell % NEPH_NOISE_CELLS; /* which divides 2^32: right of negative ones, too */
}

double neph_noise_value(int seed, int i, int j)
{
    return (double)(pcg3d_first(wrap(i), wrap(j), (uint32_t)seed) >> 8) * 0x1p-24;
}

static double noise(int seed, double u, double v)
{
    const int i = (int)floor(u), j = (int)floor(v);
    const double x = u - i, y = v - j;
    return (1.0 - y) *
               ((1.0 - x) * neph_noise_value(seed, i, j) + x * neph_noise_value(seed, i + 1, j)) +
           y * ((1.0 - x) * neph_noise_value(seed, i, j + 1) +
                x * neph_noise_value(seed, i + 1, j + 1));
}

double neph_paint_value(const struct neph_paint *texture, double u, double v)
{
    if (texture->pattern == NEPH_PATTERN_NOISE)
        return noise(texture->seed, u, v);
    return fabs(fmod(floor(u) + floor(v), 2.0)) == 1.0;
}

/* The axis of a face, of its normal as the box would have it if it had not turned. */
static int axis_across(struct neph_vec3 normal)
{
    const double x = fabs(normal.x), y = fabs(normal.y), z = fabs(normal.z);
    if (x >= y && x >= z)
        return 0;
    return y >= z ? 1 : 2;
}

struct neph_rgb neph_surface_color(const struct neph_hit *hit, struct neph_vec3 point_m)
{
    const struct neph_paint *texture = &hit->solid->surface.texture;
    const struct neph_rgb albedo = hit->solid->albedo;
    if (!(texture->cell_m > 0.0))
        return albedo;
    const struct neph_vec3 p = neph_vec3_scale(neph_box_place_m(hit->solid, point_m),
                                               1.0 / texture->cell_m);
    const int across = axis_across(neph_box_direction(hit->solid, hit->normal));
    const double value = neph_paint_value(texture, across == 0 ? p.y : p.x,
                                          across == 2 ? p.y : p.z);
    return neph_rgb_add(neph_rgb_scale(albedo, 1.0 - value), neph_rgb_scale(texture->other, value));
}

bool neph_scene_is_textured(const struct neph_scene *scene)
{
    for (int i = 0; i < scene->solid_count; i++)
        if (neph_is_textured(&scene->solids[i].surface))
            return true;
    return false;
}

bool neph_scene_has_metal(const struct neph_scene *scene)
{
    for (int i = 0; i < scene->solid_count; i++)
        if (scene->solids[i].surface.metalness > 0.0)
            return true;
    return false;
}

const char *neph_metal_obstacle(const struct neph_scene *scene)
{
    return neph_scene_has_metal(scene) ? "solids of metal: engine surfaces has them" : NULL;
}

const char *neph_surfaces_obstacle(const struct neph_scene *scene)
{
    if (neph_scene_is_textured(scene))
        return "solids with a texture: engines exact, oracle and surfaces have them";
    return neph_metal_obstacle(scene);
}
