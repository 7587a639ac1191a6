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

static void name_file(int index, char name[NAME_BYTES])
{
    snprintf(name, NAME_BYTES, "mesh%d.bin", index + 1);
}

static enum neph_status write_mesh(const struct neph_mesh_data *data, const char *path,
                                   struct neph_diag *diag)
{
    const size_t vertices = (size_t)data->vertex_count * sizeof(float[3]),
                 triangles = (size_t)data->triangle_count * sizeof(data->triangles[0]);
    unsigned char *bytes = malloc(vertices + triangles);
    if (!bytes)
        return neph_fail_memory(diag);
    for (int i = 0; i < data->vertex_count; i++) {
        const struct neph_vec3 p = data->positions[i];
        const float at[3] = {(float)p.x, (float)-p.z, (float)p.y};
        memcpy(bytes + (size_t)i * sizeof(at), at, sizeof(at));
    }
    memcpy(bytes + vertices, data->triangles, triangles);
    const enum neph_status status = neph_file_write(path, bytes, vertices + triangles, diag);
    free(bytes);
    return status;
}

enum neph_status neph_cycles_write_meshes(const struct neph_scene *scene, const char *directory,
                                          struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < scene->mesh_count && !status; i++) {
        char name[NAME_BYTES];
        name_file(i, name);
        char *path = neph_path_join(directory, name);
        status = path ? write_mesh(&scene->meshes[i]->data, path, diag) : neph_fail_memory(diag);
        free(path);
    }
    return status;
}

json_t *neph_cycles_mesh(const struct neph_scene *scene, const struct neph_solid *solid)
{
    char name[NAME_BYTES];
    struct neph_vec3 axes[3];
    name_file(neph_mesh_index(scene, solid), name);
    neph_mesh_axes(solid, axes);
    for (int i = 0; i < 3; i++)
        axes[i] = neph_vec3_scale(axes[i], solid->scale_m);
    return json_pack("{s:s, s:s, s:i, s:[ooo], s:o}", "kind", "mesh", "file", name, "vertex_count",
                     solid->mesh->data.vertex_count, "axes_m", neph_vector_json(axes[0]),
                     neph_vector_json(axes[1]), neph_vector_json(axes[2]), "center_m",
                     neph_vector_json(solid->center_m));
}
