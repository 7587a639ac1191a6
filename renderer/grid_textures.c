/* SPDX-License-Identifier: MIT */
#include "renderer/grid_textures.h"

#include "renderer/media/grid.h"
#include "renderer/texture.h"
#include "scenes/grid.h"
#include "scenes/media.h"

/* Does not compile with a new kind: this file then needs a change. */
_Static_assert(NEPH_MEDIUM_KIND_COUNT == 8, "a new kind");

static void write_grid_slab(const void *context, int z, float *values)
{
    const struct neph_medium *medium = context;
    const float full = neph_gpu_grid_maximum(medium);
    int size[3];
    neph_gpu_grid_size(medium->grid, size);
    neph_gpu_grid_slab(medium, z, values);
    for (size_t i = 0; i < (size_t)size[0] * (size_t)size[1]; i++)
        values[i] /= full;
}

static void write_empty_slab(const void *context, int z, float *values)
{
    (void)context;
    (void)z;
    values[0] = 0.0f;
}

static enum neph_status create_empty_texture(const struct neph_vulkan *vulkan,
                                             struct neph_texture *texture, struct neph_diag *diag)
{
    const struct neph_texture_params params = {
        .format = NEPH_TEXEL_R8, /* supported by every device */
        .size = {1, 1, 1},
        .slab = write_empty_slab,
        .name = "no grid",
    };
    return neph_texture_create(vulkan, &params, texture, diag);
}

static enum neph_status create(const struct neph_vulkan *vulkan, const struct neph_medium *medium,
                               enum neph_texel_format format, struct neph_texture *texture,
                               struct neph_diag *diag)
{
    struct neph_texture_params params = {
        .format = format, .slab = write_grid_slab, .context = medium, .name = "grid texture"};
    neph_gpu_grid_size(medium->grid, params.size);
    return neph_texture_create(vulkan, &params, texture, diag);
}

enum neph_status neph_grid_textures_create(const struct neph_vulkan *vulkan,
                                           const struct neph_scene *scene,
                                           const struct neph_shortcuts *shortcuts,
                                           struct neph_gpu_scene *gpu, struct neph_diag *diag)
{
    const struct neph_medium *media[NEPH_GPU_MEDIA_MAX];
    const uint32_t count = shortcuts->grid_texture ? neph_gpu_scene_list_media(scene, media) : 0;
    if (shortcuts->grid_texture && neph_scene_has_constant_cells(scene))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "grid_sampling=texture is trilinear, and a grid has interpolation: "
                         "constant; grid_sampling=buffer reads its cells");
    enum neph_status status = create_empty_texture(vulkan, &gpu->no_texture, diag);
    for (uint32_t m = 0; m < count && !status; m++)
        if (media[m]->kind == NEPH_MEDIUM_GRID)
            status = create(vulkan, media[m], shortcuts->grid_format, &gpu->textures[m], diag);
    return status;
}
