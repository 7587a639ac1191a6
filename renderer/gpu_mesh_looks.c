/* SPDX-License-Identifier: MIT */
#include "renderer/gpu_mesh_looks.h"

#include "renderer/shaders/constants.h"
#include "scenes/mesh.h"
#include "scenes/surfaces.h"

#include <string.h>

/* Does not compile with a new kind: this file then needs a change. */
_Static_assert(NEPH_ALPHA_COUNT == 3, "a new kind");

enum { LOOK_WORDS = 1, NORMAL_WORDS = 3 };

uint32_t neph_gpu_mesh_look_bits(const struct neph_scene *scene)
{
    const unsigned looks = neph_scene_mesh_looks(scene);
    return looks & NEPH_LOOK_SMOOTH ? NEPH_GPU_MESH_SMOOTH : 0u;
}

static size_t count_normals(const struct neph_mesh *mesh)
{
    return mesh->material.is_smooth ? NORMAL_WORDS * (size_t)mesh->data.triangle_count : 0;
}

size_t neph_gpu_mesh_look_words(const struct neph_mesh *mesh)
{
    return mesh->material.is_smooth ? LOOK_WORDS + count_normals(mesh) : 0;
}

static void write_normals(const struct neph_mesh_data *data, uint32_t (*to)[4])
{
    for (int i = 0; i < data->triangle_count; i++)
        for (int corner = 0; corner < 3; corner++) {
            const struct neph_vec3 normal = neph_vec3_normalize(
                data->normals[data->triangles[i][corner]]);
            const float rounded[3] = {(float)normal.x, (float)normal.y, (float)normal.z};
            memcpy(to[NORMAL_WORDS * i + corner], rounded, sizeof(rounded));
        }
}

void neph_gpu_mesh_look_write(const struct neph_mesh *mesh, uint32_t first, uint32_t (*words)[4])
{
    uint32_t *look = words[first];
    first += LOOK_WORDS;
    if (mesh->material.is_smooth) {
        look[0] = first;
        write_normals(&mesh->data, words + first);
    }
}
