/* SPDX-License-Identifier: MIT */
#include "scenes/surfaces.h"

#include "scenes/mesh.h"

#include <math.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_ALPHA_COUNT == 3, "a new kind");
_Static_assert(NEPH_SOLID_KIND_COUNT == 3, "a new kind");

/* The axis of a face, from its normal in the axes of the unrotated box. */
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
    if (hit->solid->kind == NEPH_SOLID_MESH)
        return neph_rgb_mul(albedo, neph_mesh_color(&hit->solid->mesh->material,
                                                    &hit->solid->mesh->data, &hit->place));
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

const char *neph_mesh_obstacle(const struct neph_scene *scene)
{
    for (int i = 0; i < scene->solid_count; i++)
        if (scene->solids[i].kind == NEPH_SOLID_MESH)
            return "triangle meshes: engine surfaces has them";
    return NULL;
}

unsigned neph_scene_mesh_looks(const struct neph_scene *scene)
{
    unsigned looks = 0;
    for (int i = 0; i < scene->solid_count; i++) {
        if (scene->solids[i].kind != NEPH_SOLID_MESH)
            continue;
        const struct neph_mesh_material *material = &scene->solids[i].mesh->material;
        looks |= (material->is_smooth ? NEPH_LOOK_SMOOTH : 0u) |
                 (material->texture ? NEPH_LOOK_TEXTURE : 0u) |
                 (material->alpha == NEPH_ALPHA_CUTOUT ? NEPH_LOOK_CUTOUT : 0u) |
                 (material->alpha == NEPH_ALPHA_COVERAGE ? NEPH_LOOK_COVERAGE : 0u);
    }
    return looks;
}

const char *neph_coverage_obstacle(const struct neph_scene *scene)
{
    return neph_scene_mesh_looks(scene) & NEPH_LOOK_COVERAGE
               ? "meshes with alpha as coverage: engines oracle, tracer, march, realtime, "
                 "fog_look, cycles and povray have them"
               : NULL;
}

const char *neph_surfaces_obstacle(const struct neph_scene *scene)
{
    if (neph_scene_is_textured(scene))
        return "solids with a texture: engines exact, oracle and surfaces have them";
    return neph_metal_obstacle(scene);
}
