/* SPDX-License-Identifier: MIT */
#include "scenes/mesh_material.h"

struct neph_vec3 neph_mesh_shading_normal(const struct neph_mesh_material *material,
                                          const struct neph_mesh_data *data,
                                          const struct neph_mesh_place *place,
                                          struct neph_vec3 normal)
{
    struct neph_vec3 sum = {0, 0, 0};
    if (!material->is_smooth)
        return normal;
    for (int i = 0; i < 3; i++)
        sum = neph_vec3_along(
            sum, neph_vec3_normalize(data->normals[data->triangles[place->triangle][i]]),
            place->weights[i]);
    const double side = neph_vec3_dot(sum, normal);
    if (!(neph_vec3_length(sum) > 1e-6) || side == 0.0)
        return normal; /* opposite normals leave no direction */
    return neph_vec3_scale(neph_vec3_normalize(sum), side > 0.0 ? 1.0 : -1.0);
}

static struct neph_texel find_texel(const struct neph_mesh_material *material,
                                    const struct neph_mesh_data *data,
                                    const struct neph_mesh_place *place)
{
    double uv[2] = {0, 0};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 2; k++)
            uv[k] += place->weights[i] * (double)data->uv[data->triangles[place->triangle][i]][k];
    return neph_albedo_texture_find(material->texture, uv[0], uv[1]);
}

struct neph_rgb neph_mesh_color(const struct neph_mesh_material *material,
                                const struct neph_mesh_data *data,
                                const struct neph_mesh_place *place)
{
    return material->texture ? find_texel(material, data, place).color : (struct neph_rgb){1, 1, 1};
}

double neph_mesh_alpha(const struct neph_mesh_material *material, const struct neph_mesh_data *data,
                       const struct neph_mesh_place *place)
{
    return find_texel(material, data, place).alpha;
}
