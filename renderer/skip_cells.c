/* SPDX-License-Identifier: MIT */
#include "renderer/skip_cells.h"

#include "renderer/lattice.h"
#include "scenes/horizon.h"
#include "scenes/media.h"
#include "scenes/motion.h"

#include <math.h>
#include <stdlib.h>

/* Does not compile with a new kind: this file then needs a change. */
_Static_assert(NEPH_MEDIUM_KIND_COUNT == 8, "a new kind");

/* 32 KiB of bits, which fit into a GPU's caches near its threads. */
static const double cells_wanted = 64.0 * 64.0 * 64.0;

/* Margin of a cell, as a part of its side. Greater than the rounding of a shader's position, which
 * is 1e-3 of a cell at coordinates of 10^4 cells. */
static const double hair = 1e-2;

/* The binding of the majorants in frame.glsl. */
static const int binding = 3;

/* Choose about cells_wanted cubic cells; a flat box has fewer. */
static void choose_size(const struct neph_bounds *box, uint32_t size[3])
{
    double sides_m[3];
    neph_lattice_sides_m(box, sides_m);
    const double side_m = cbrt(sides_m[0] * sides_m[1] * sides_m[2] / cells_wanted);
    for (int axis = 0; axis < 3; axis++)
        size[axis] = (uint32_t)fmin(fmax(1.0, floor(sides_m[axis] / side_m)), 1024.0);
}

static void side_of(double low, double high, uint32_t count, uint32_t cell, double *from,
                    double *to)
{
    const double side = (high - low) / count;
    *from = low + (cell - hair) * side;
    *to = low + (cell + 1.0 + hair) * side;
}

static struct neph_bounds cell_box(const struct neph_bounds *box, const uint32_t size[3],
                                   const uint32_t cell[3])
{
    struct neph_bounds own;
    side_of(box->min_m.x, box->max_m.x, size[0], cell[0], &own.min_m.x, &own.max_m.x);
    side_of(box->min_m.y, box->max_m.y, size[1], cell[1], &own.min_m.y, &own.max_m.y);
    side_of(box->min_m.z, box->max_m.z, size[2], cell[2], &own.min_m.z, &own.max_m.z);
    return own;
}

static bool may_be_in(const struct neph_scene *scene, const struct neph_bounds *box)
{
    for (int i = 0; i < scene->medium_count; i++)
        if (!neph_medium_is_fog(&scene->media[i]) &&
            neph_medium_extinction_bound_per_m(&scene->media[i], box) > 0.0)
            return true;
    return false;
}

static void fill(const struct neph_scene *scene, const struct neph_bounds *box,
                 const uint32_t size[3], uint32_t *words)
{
    size_t at = 0;
    for (uint32_t k = 0; k < size[2]; k++)
        for (uint32_t j = 0; j < size[1]; j++)
            for (uint32_t i = 0; i < size[0]; i++, at++) {
                const struct neph_bounds cell = cell_box(box, size, (const uint32_t[3]){i, j, k});
                if (may_be_in(scene, &cell))
                    words[at >> 5] |= 1u << (at & 31u);
            }
}

static enum neph_status upload(const struct neph_vulkan *vulkan, const struct neph_scene *scene,
                               const struct neph_bounds *box, struct neph_skip_cells *skip,
                               struct neph_diag *diag)
{
    const size_t cells = (size_t)skip->size[0] * skip->size[1] * skip->size[2];
    const size_t bytes = (cells + 31) / 32 * sizeof(uint32_t);
    uint32_t *words = calloc(bytes, 1);
    if (!words)
        return neph_fail_memory(diag);
    fill(scene, box, skip->size, words);
    enum neph_status status = neph_buffer_create(vulkan, NEPH_BUFFER_DEVICE, bytes, "skip cells",
                                                 &skip->cells, diag);
    if (!status)
        status = neph_buffer_upload(vulkan, &skip->cells, 0, words, bytes, diag);
    free(words);
    return status;
}

static struct neph_skip_places places_of(const struct neph_scene *scene)
{
    struct neph_skip_places places = {.noise_m = {0.0, 0.0, 0.0}};
    for (int i = 0; i < scene->medium_count; i++) {
        const struct neph_medium *medium = &scene->media[i];
        if (neph_medium_is_fog(medium))
            continue;
        places.corner_m[i] = neph_medium_support(medium).min_m;
        if (medium->kind == NEPH_MEDIUM_HORIZON)
            places.noise_m = medium->horizon->params.wind_m;
    }
    return places;
}

enum neph_status neph_skip_cells_create(const struct neph_vulkan *vulkan,
                                        const struct neph_scene *scene,
                                        const struct neph_march_params *params,
                                        struct neph_skip_cells *skip, struct neph_diag *diag)
{
    struct neph_bounds box;
    if (!params->shortcuts.skip || !neph_shapes_box(scene, &box))
        return NEPH_OK;
    const enum neph_status status = neph_lattice_check(&box, "skip=majorant", "skip=off", diag);
    if (status)
        return status;
    choose_size(&box, skip->size);
    skip->places = places_of(scene);
    skip->box_min_m = box.min_m;
    return upload(vulkan, scene, &box, skip, diag);
}

void neph_skip_cells_destroy(const struct neph_vulkan *vulkan, struct neph_skip_cells *skip)
{
    if (vulkan)
        neph_buffer_destroy(vulkan, &skip->cells);
    *skip = (struct neph_skip_cells){0};
}

/* --- frames --------------------------------------------------------------------------------- */

static double length_m(struct neph_vec3 v)
{
    return sqrt(neph_vec3_dot(v, v));
}

/* The largest displacement of a medium, or of the noise, relative to the bounds. */
static double largest_shift_m(const struct neph_skip_cells *skip, const struct neph_scene *scene,
                              struct neph_vec3 box_m, struct neph_vec3 box_then_m)
{
    const struct neph_skip_places now = places_of(scene);
    const struct neph_vec3 by_m = neph_vec3_sub(box_m, box_then_m);
    double shift_m = length_m(neph_vec3_sub(now.noise_m, skip->places.noise_m));
    for (int i = 0; i < scene->medium_count; i++)
        if (!neph_medium_is_fog(&scene->media[i]))
            shift_m = fmax(shift_m,
                           length_m(neph_vec3_sub(
                               neph_vec3_sub(now.corner_m[i], skip->places.corner_m[i]), by_m)));
    return shift_m;
}

static enum neph_status check_places(const struct neph_skip_cells *skip,
                                     const struct neph_scene *scene, const struct neph_bounds *box,
                                     struct neph_diag *diag)
{
    double sides_m[3];
    neph_lattice_sides_m(box, sides_m);
    const double cell_m = fmin(sides_m[0] / skip->size[0],
                               fmin(sides_m[1] / skip->size[1], sides_m[2] / skip->size[2]));
    /* Sums of displacements in double differ by much less than this. */
    const double rounding_m = 1e-6 * cell_m;
    if (largest_shift_m(skip, scene, box->min_m, skip->box_min_m) <= rounding_m)
        return NEPH_OK;
    return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                     "skip=majorant: the wind moves only some of the media, or the noise of a "
                     "Horizon cloud within its bounds, so empty cells do not stay empty; set "
                     "skip=off, or convert the cloud to voxels");
}

enum neph_status neph_skip_cells_place(const struct neph_skip_cells *skip,
                                       const struct neph_scene *scene, double frame,
                                       struct neph_gpu_frame *gpu, struct neph_diag *diag)
{
    struct neph_bounds box;
    if (skip->size[0] == 0 || !neph_shapes_box(scene, &box))
        return NEPH_OK;
    neph_lattice_place(&box, neph_scene_camera(scene, frame).position_m, skip->size, 0,
                       &gpu->skip_lattice);
    return check_places(skip, scene, &box, diag);
}

void neph_skip_cells_bind(const struct neph_skip_cells *skip, struct neph_dispatch *dispatch)
{
    if (skip->size[0] > 0)
        dispatch->buffers[binding] = &skip->cells;
}
