/* SPDX-License-Identifier: MIT */
#include "harness/engines/cycles_mesh.h"

#include "base/files.h"
#include "scenes/mesh_place.h"
#include "harness/engines/scene_json.h"
#include "scenes/mesh.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NAME_BYTES = 32 };

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_ALPHA_COUNT == 3, "a new kind");

static void name_file(const char *what, int index, char name[NAME_BYTES])
{
    snprintf(name, NAME_BYTES, "%s%d.bin", what, index + 1);
}

/* In Blender's axes; returns the end. */
static unsigned char *put_vector(struct neph_vec3 v, unsigned char *to)
{
    const float at[3] = {(float)v.x, (float)-v.z, (float)v.y};
    memcpy(to, at, sizeof(at));
    return to + sizeof(at);
}

static enum neph_status write_mesh(const struct neph_mesh *mesh, const char *path,
                                   struct neph_diag *diag)
{
    const struct neph_mesh_data *data = &mesh->data;
    const size_t vertices = (size_t)data->vertex_count,
                 triangles = (size_t)data->triangle_count * sizeof(data->triangles[0]),
                 uv = mesh->material.texture ? vertices * sizeof(data->uv[0]) : 0;
    const size_t room = 2 * vertices * sizeof(float[3]) + triangles + uv;
    unsigned char *bytes = malloc(room);
    if (!bytes)
        return neph_fail_memory(diag);
    unsigned char *end = bytes;
    for (int i = 0; i < data->vertex_count; i++)
        end = put_vector(data->positions[i], end);
    memcpy(end, data->triangles, triangles);
    end += triangles;
    for (int i = 0; i < data->vertex_count && mesh->material.is_smooth; i++)
        end = put_vector(neph_vec3_normalize(data->normals[i]), end);
    if (uv > 0)
        memcpy(end, data->uv, uv);
    const enum neph_status status = neph_file_write(path, bytes, (size_t)(end - bytes) + uv, diag);
    free(bytes);
    return status;
}

/* Blender's rows begin at the bottom. */
static enum neph_status write_texture(const struct neph_albedo_texture *texture, const char *path,
                                      struct neph_diag *diag)
{
    const size_t row = (size_t)texture->width_px * 4, height = (size_t)texture->height_px;
    float *values = malloc(row * height * sizeof(*values));
    if (!values)
        return neph_fail_memory(diag);
    for (size_t y = 0; y < height; y++)
        memcpy(values + y * row, texture->rgba + (height - 1 - y) * row, row * sizeof(*values));
    const enum neph_status status = neph_file_write(path, values, row * height * sizeof(*values),
                                                    diag);
    free(values);
    return status;
}

static enum neph_status write_files(const struct neph_mesh *mesh, int index, const char *directory,
                                    struct neph_diag *diag)
{
    char name[NAME_BYTES];
    name_file("mesh", index, name);
    char *path = neph_path_join(directory, name);
    enum neph_status status = path ? write_mesh(mesh, path, diag) : neph_fail_memory(diag);
    free(path);
    if (status || !mesh->material.texture)
        return status;
    name_file("texture", index, name);
    path = neph_path_join(directory, name);
    status = path ? write_texture(mesh->material.texture, path, diag) : neph_fail_memory(diag);
    free(path);
    return status;
}

enum neph_status neph_cycles_write_meshes(const struct neph_scene *scene, const char *directory,
                                          struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < scene->mesh_count && !status; i++)
        status = write_files(scene->meshes[i], i, directory, diag);
    return status;
}

static const char *const alphas[NEPH_ALPHA_COUNT] = {"ignored", "cutout", "coverage"};

static json_t *texture_json(const struct neph_mesh_material *material, int index)
{
    char name[NAME_BYTES];
    name_file("texture", index, name);
    return material->texture
               ? json_pack("{s:s, s:i, s:i, s:s}", "file", name, "width_px",
                           material->texture->width_px, "height_px", material->texture->height_px,
                           "alpha", alphas[material->alpha])
               : json_null();
}

json_t *neph_cycles_mesh(const struct neph_scene *scene, const struct neph_solid *solid)
{
    char name[NAME_BYTES];
    struct neph_vec3 axes[3];
    const int index = neph_mesh_index(scene, solid);
    name_file("mesh", index, name);
    neph_mesh_axes(solid, axes);
    for (int i = 0; i < 3; i++)
        axes[i] = neph_vec3_scale(axes[i], solid->scale_m);
    return json_pack("{s:s, s:s, s:i, s:i, s:b, s:o, s:[ooo], s:o}", "kind", "mesh", "file", name,
                     "vertex_count", solid->mesh->data.vertex_count, "triangle_count",
                     solid->mesh->data.triangle_count, "is_smooth", solid->mesh->material.is_smooth,
                     "texture", texture_json(&solid->mesh->material, index), "axes_m",
                     neph_vector_json(axes[0]), neph_vector_json(axes[1]),
                     neph_vector_json(axes[2]), "center_m", neph_vector_json(solid->center_m));
}
