/* SPDX-License-Identifier: MIT */
#include "renderer/gpu_mesh_looks.h"

#include "renderer/shaders/constants.h"
#include "scenes/mesh.h"
#include "scenes/surfaces.h"

#include <math.h>
#include <string.h>

/* Does not compile with a new kind: this file then needs a change. */
_Static_assert(NEPH_ALPHA_COUNT == 3, "a new kind");
_Static_assert(NEPH_GPU_ALPHA_CUTOUT == NEPH_ALPHA_CUTOUT &&
                   NEPH_GPU_ALPHA_COVERAGE == NEPH_ALPHA_COVERAGE,
               "equal in shaders and C");

enum {
    LOOK_WORDS = 2,
    NORMAL_WORDS = 3, /* of a triangle */
    UV_WORDS = 2,
};

/* How often a triangle repeats its texture, at most: interpolation stays finite. At so many repeats
 * float32 has no fractions. */
static const double repeats_max = 1e9;

uint32_t neph_gpu_mesh_look_bits(const struct neph_scene *scene)
{
    const unsigned looks = neph_scene_mesh_looks(scene);
    return (looks & NEPH_LOOK_SMOOTH ? NEPH_GPU_MESH_SMOOTH : 0u) |
           (looks & NEPH_LOOK_TEXTURE ? NEPH_GPU_MESH_TEXTURES : 0u) |
           (looks & NEPH_LOOK_CUTOUT ? NEPH_GPU_MESH_CUTOUTS : 0u) |
           (looks & NEPH_LOOK_COVERAGE ? NEPH_GPU_MESH_COVERAGE : 0u);
}

static size_t count_normals(const struct neph_mesh *mesh)
{
    return mesh->material.is_smooth ? NORMAL_WORDS * (size_t)mesh->data.triangle_count : 0;
}

static size_t count_uv(const struct neph_mesh *mesh)
{
    return mesh->material.texture ? UV_WORDS * (size_t)mesh->data.triangle_count : 0;
}

size_t neph_gpu_mesh_look_words(const struct neph_mesh *mesh)
{
    return mesh->material.is_smooth || mesh->material.texture
               ? LOOK_WORDS + count_normals(mesh) + count_uv(mesh)
               : 0;
}

/* --- textures -------------------------------------------------------------------------------- */

static size_t count_texels(const struct neph_albedo_texture *texture)
{
    return (size_t)texture->width_px * (size_t)texture->height_px;
}

/* The first mesh with the same texture. */
static int find_first_user(const struct neph_scene *scene, int index)
{
    const struct neph_albedo_texture *texture = scene->meshes[index]->material.texture;
    int i = 0;
    while (i < index && !(scene->meshes[i]->material.texture &&
                          strcmp(scene->meshes[i]->material.texture->hash, texture->hash) == 0))
        i++;
    return i;
}

/* The words of the textures of the meshes before one. */
static size_t count_textures_before(const struct neph_scene *scene, int index)
{
    size_t count = 0;
    for (int i = 0; i < index; i++)
        if (scene->meshes[i]->material.texture && find_first_user(scene, i) == i)
            count += count_texels(scene->meshes[i]->material.texture);
    return count;
}

size_t neph_gpu_mesh_texture_words(const struct neph_scene *scene)
{
    return count_textures_before(scene, scene->mesh_count);
}

/* --- writing --------------------------------------------------------------------------------- */

static void set_floats(uint32_t *word, int count, const float *values)
{
    memcpy(word, values, (size_t)count * sizeof(*values));
}

static void write_normals(const struct neph_mesh_data *data, uint32_t (*to)[4])
{
    for (int i = 0; i < data->triangle_count; i++)
        for (int corner = 0; corner < 3; corner++) {
            const struct neph_vec3 normal = neph_vec3_normalize(
                data->normals[data->triangles[i][corner]]);
            set_floats(to[NORMAL_WORDS * i + corner], 3,
                       (const float[3]){(float)normal.x, (float)normal.y, (float)normal.z});
        }
}

/* Textures repeat, so whole numbers are taken off the coordinates of a triangle: float32 keeps more
 * of the digits that remain. The second one is down, as rows are. */
static void write_uv(const struct neph_mesh_data *data, uint32_t (*to)[4])
{
    for (int i = 0; i < data->triangle_count; i++) {
        float places[6];
        for (int k = 0; k < 2; k++) {
            double at[3];
            for (int corner = 0; corner < 3; corner++)
                at[corner] = (k == 0 ? 1.0 : -1.0) *
                             (double)data->uv[data->triangles[i][corner]][k];
            const double whole = floor(fmin(at[0], fmin(at[1], at[2])));
            for (int corner = 0; corner < 3; corner++)
                places[2 * corner + k] = (float)fmin(at[corner] - whole, repeats_max);
        }
        set_floats(to[UV_WORDS * i], 4, places);
        set_floats(to[UV_WORDS * i + 1], 2, places + 4);
    }
}

void neph_gpu_mesh_look_write(const struct neph_scene *scene, int index, uint32_t first,
                              uint32_t textures, uint32_t (*words)[4])
{
    const struct neph_mesh *mesh = scene->meshes[index];
    const struct neph_albedo_texture *texture = mesh->material.texture;
    uint32_t(*look)[4] = words + first;
    first += LOOK_WORDS;
    if (mesh->material.is_smooth) {
        look[0][0] = first;
        write_normals(&mesh->data, words + first);
    }
    if (texture) {
        const int user = find_first_user(scene, index);
        look[0][1] = first + (uint32_t)count_normals(mesh);
        look[0][2] = textures + (uint32_t)count_textures_before(scene, user);
        look[0][3] = (uint32_t)mesh->material.alpha;
        look[1][0] = (uint32_t)texture->width_px;
        look[1][1] = (uint32_t)texture->height_px;
        write_uv(&mesh->data, words + look[0][1]);
        if (user == index)
            memcpy(words + look[0][2], texture->rgba, count_texels(texture) * sizeof(*words));
    }
}
