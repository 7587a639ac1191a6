/* SPDX-License-Identifier: MIT */
#include "renderer/diffused_light.h"

#include "base/interrupt.h"
#include "renderer/lattice.h"
#include "scenes/media.h"
#include "scenes/motion.h"
#include "scenes/solids.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Does not compile with a new kind: this file then needs a change. */
_Static_assert(NEPH_MARCH_LIGHTING_COUNT == 8, "a new kind");
_Static_assert(NEPH_SOLID_KIND_COUNT == 3, "a new kind");

static const uint32_t fill_code[] = {
#include "shaders/diffuse_fill.comp.inc"
};
static const uint32_t links_code[] = {
#include "shaders/diffuse_links.comp.inc"
};
static const uint32_t cycle_code[] = {
#include "shaders/diffuse_cycle.comp.inc"
};
static const uint32_t field_code[] = {
#include "shaders/diffuse_field.comp.inc"
};

enum { local_size = 64 };

/* The operations of shaders/diffuse_cycle.comp. */
enum job { CLEAR, COARSEN, RED, BLACK, LEAVE, CORRECT, LIMIT };

/* Red-black sweeps before and after a coarser level, and on the coarsest level. */
enum { SWEEPS = 2, COARSEST_SWEEPS = 8 };

/* SETTLED: cycles after which a static scene is considered converged (the residual is then 1.5e-4
 * of the source, with 24 cells a side). COLD: cycles of a first frame, at least. */
enum { SETTLED = 48, COLD = 16 };

/* Sample points of a cell, at most (shaders/diffuse_fill.comp). */
enum { POINTS = 8 };

/* Resolution of a column relative to a 3D grid with the same setting. */
enum { COLUMN_FINER = 8 };

/* --- bounds of the grid ---------------------------------------------------------------------- */

/* Optical depths from above at the lower and the upper end of the column. */
static const double column_depth_max = 200.0, column_depth_min = 1e-4;

/* Fogs with a larger ratio of width to height are treated as an infinite layer. */
static const double layer_aspect = 16.0;

/* Vertical range in which fogs are searched [m]. */
static const double column_reach_m = 1e5;

static double depth_above(const struct neph_scene *scene, struct neph_vec3 at_m)
{
    const struct neph_vec3 up = {0.0, 1.0, 0.0};
    double depth = 0.0;
    for (int i = 0; i < scene->medium_count; i++)
        depth += neph_medium_optical_depth(&scene->media[i], at_m, up, 0.0, INFINITY);
    return depth;
}

/* The height above which the optical depth is at most `depth`, by bisection. */
static double find_height(const struct neph_scene *scene, struct neph_vec3 at_m, double low_m,
                          double high_m, double depth)
{
    for (int i = 0; i < 64; i++) {
        at_m.y = 0.5 * (low_m + high_m);
        *(depth_above(scene, at_m) > depth ? &low_m : &high_m) = at_m.y;
    }
    return 0.5 * (low_m + high_m);
}

/* The top of the highest box on the vertical line through a point. */
static double find_ground_m(const struct neph_scene *scene, struct neph_vec3 at_m)
{
    double ground = -column_reach_m;
    for (int i = 0; i < scene->solid_count; i++) {
        const struct neph_bounds box = neph_solid_bounds(&scene->solids[i]);
        if (scene->solids[i].kind == NEPH_SOLID_BOX && box.min_m.x <= at_m.x &&
            at_m.x <= box.max_m.x && box.min_m.z <= at_m.z && at_m.z <= box.max_m.z)
            ground = fmax(ground, box.max_m.y);
    }
    return ground;
}

static struct neph_bounds compute_support(const struct neph_scene *scene)
{
    struct neph_bounds all = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (int i = 0; i < scene->medium_count; i++)
        all = neph_bounds_hull(all, neph_medium_support(&scene->media[i]));
    return all;
}

/* The column at the camera of frame 0: from the top of the fogs down to column_depth_max. */
static struct neph_bounds compute_column(const struct neph_scene *scene)
{
    const struct neph_vec3 at_m = neph_scene_camera(scene, 0.0).position_m;
    const double ground = find_ground_m(scene, at_m);
    struct neph_bounds box = {at_m, at_m}, support;
    box.max_m.y = find_height(scene, at_m, ground, column_reach_m, column_depth_min);
    box.min_m.y = find_height(scene, at_m, ground, box.max_m.y, column_depth_max);
    support = compute_support(scene);
    box.min_m.y = fmin(fmax(box.min_m.y, support.min_m.y), box.max_m.y);
    return box;
}

/* The bounds of bounded media, or of fogs that are not an infinite layer. */
static bool find_grid_bounds(const struct neph_scene *scene, struct neph_bounds *box)
{
    double sides_m[3];
    if (neph_find_media_bounds(scene, box))
        return true;
    *box = compute_support(scene);
    neph_lattice_sides_m(box, sides_m);
    return fmax(sides_m[0], sides_m[2]) <= layer_aspect * sides_m[1] && isfinite(sides_m[1]);
}

/* Sizes for cells as near to cubes as whole numbers allow, at least two along each axis. */
static void choose_size(const struct neph_bounds *box, int cells, uint32_t size[3])
{
    double sides_m[3];
    neph_lattice_sides_m(box, sides_m);
    const double longest_m = fmax(sides_m[0], fmax(sides_m[1], sides_m[2]));
    for (int axis = 0; axis < 3; axis++)
        size[axis] = (uint32_t)fmax(2.0, round(cells * sides_m[axis] / longest_m));
}

void neph_diffused_light_place(struct neph_diffused_light *light, const struct neph_scene *scene,
                               double frame, const struct neph_gpu_scene *gpu)
{
    const struct neph_vec3 camera_m = neph_scene_camera(scene, frame).position_m;
    if (!light->is_column)
        find_grid_bounds(scene, &light->box); /* the wind moves it */
    struct neph_bounds box = light->box;
    if (light->is_column) {
        box.min_m.x = camera_m.x;
        box.min_m.z = camera_m.z;
        box.max_m.x = camera_m.x + 1.0;
        box.max_m.z = camera_m.z + 1.0;
    }
    neph_lattice_place(&box, camera_m, light->levels[0].size, 0, &gpu->frame->light_lattice);
}

/* --- creation -------------------------------------------------------------------------------- */

static uint32_t cell_count(const struct neph_gpu_diffusion_level *level)
{
    return level->size[0] * level->size[1] * level->size[2];
}

static uint32_t count_all_cells(const struct neph_diffused_light *light)
{
    const struct neph_gpu_diffusion_level *last = &light->levels[light->level_count - 1];
    return last->first + cell_count(last);
}

/* Coarsen by two from level to level, until a few sweeps solve the coarsest. */
static void make_levels(struct neph_diffused_light *light)
{
    light->level_count = 1;
    while (light->level_count < NEPH_DIFFUSED_LEVELS_MAX) {
        const struct neph_gpu_diffusion_level *fine = &light->levels[light->level_count - 1];
        struct neph_gpu_diffusion_level coarse = {.first = fine->first + cell_count(fine)};
        if (cell_count(fine) <= 8)
            return;
        for (int axis = 0; axis < 3; axis++)
            coarse.size[axis] = (fine->size[axis] + 1) / 2;
        light->levels[light->level_count++] = coarse;
    }
}

static enum neph_status find_box(struct neph_diffused_light *light, const struct neph_scene *scene,
                                 struct neph_diag *diag)
{
    light->is_column = !find_grid_bounds(scene, &light->box);
    if (light->is_column)
        light->box = compute_column(scene);
    if (light->is_column)
        return NEPH_OK;
    return light->is_shown
               ? neph_lattice_check(&light->box, "lighting=diffused", "lighting=octaves_fitted",
                                    diag)
               : neph_lattice_check(&light->box, "light_ahead=diffusion", "light_ahead=none", diag);
}

/* The sample points of a cell are the steps of its march and must fit into one dispatch. */
static enum neph_status plan_cell_dispatches(struct neph_diffused_light *light,
                                             const struct neph_scene *scene,
                                             const struct neph_gpu_scene *gpu,
                                             struct neph_diag *diag)
{
    light->params.steps = POINTS;
    const enum neph_status status = neph_march_split_make(light->vulkan, scene, gpu, &light->params,
                                                          cell_count(&light->levels[0]),
                                                          &light->cut, diag);
    if (status || light->cut.steps == light->cut.step_count)
        return status;
    return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                     "diffused light: sunlight at the %d points of a cell exceeds the loop "
                     "iterations of a dispatch; reduce sun_steps (now %d)",
                     POINTS, light->params.sun_steps);
}

static enum neph_status clear_buffers(const struct neph_diffused_light *light,
                                      struct neph_diag *diag)
{
    const size_t bytes = count_all_cells(light) * sizeof(struct neph_gpu_diffusion_cell);
    void *zeros = calloc(1, bytes);
    const enum neph_status status = zeros ? neph_buffer_upload(light->vulkan, &light->cells, 0,
                                                               zeros, bytes, diag)
                                          : neph_fail_memory(diag);
    free(zeros);
    return status;
}

static enum neph_status create_buffers(struct neph_diffused_light *light, struct neph_diag *diag)
{
    const struct neph_buffer_row rows[] = {
        {&light->cells, NEPH_BUFFER_DEVICE,
         count_all_cells(light) * sizeof(struct neph_gpu_diffusion_cell), "diffusion cells"},
        {&light->field, NEPH_BUFFER_DEVICE, cell_count(&light->levels[0]) * 4 * sizeof(float),
         "diffused light"},
    };
    const enum neph_status status = neph_buffers_create(light->vulkan, rows, 2, diag);
    return status ? status : clear_buffers(light, diag);
}

enum neph_status
neph_diffused_light_create(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                           const struct neph_gpu_scene *gpu, const struct neph_march_params *params,
                           struct neph_diffused_light *light, struct neph_diag *diag)
{
    light->is_shown = params->lighting == NEPH_MARCH_DIFFUSED;
    if (!light->is_shown && !(params->lighting == NEPH_MARCH_TRACED && params->light.looks_ahead))
        return NEPH_OK;
    light->vulkan = vulkan;
    light->params = *params;
    light->params.lighting = NEPH_MARCH_DIFFUSED; /* the lighting of the kernels that fill the cells
                                                   */
    enum neph_status status = find_box(light, scene, diag);
    if (status)
        return status;
    uint32_t *size = light->levels[0].size;
    if (light->is_column)
        memcpy(size, (uint32_t[3]){1, (uint32_t)params->diffusion.cells * COLUMN_FINER, 1},
               3 * sizeof(*size));
    else
        choose_size(&light->box, params->diffusion.cells, size);
    make_levels(light);
    status = plan_cell_dispatches(light, scene, gpu, diag);
    return status ? status : create_buffers(light, diag);
}

void neph_diffused_light_destroy(struct neph_diffused_light *light)
{
    if (!light->vulkan)
        return;
    neph_buffer_destroy(light->vulkan, &light->field);
    neph_buffer_destroy(light->vulkan, &light->cells);
    free(light->solids);
    *light = (struct neph_diffused_light){0};
}

/* --- filling --------------------------------------------------------------------------------- */

/* The work of a frame. */
struct work {
    struct neph_diffused_light *light;
    const struct neph_dispatch *bound;
    const struct neph_kernel *fill, *links, *cycle, *field;
    struct neph_gpu_diffusion_run run;
    struct neph_batch batch;
    double *gpu_s;
};

static enum neph_status get_fill(struct work *work, const struct neph_gpu_scene *gpu,
                                 struct neph_diag *diag)
{
    struct neph_kernel_params params = {
        .name = "diffuse_fill",
        .code = fill_code,
        .code_bytes = sizeof(fill_code),
        .buffer_count = NEPH_GPU_SCENE_BUFFERS + 3,
        .uniform_count = NEPH_GPU_SCENE_UNIFORMS,
        .image_count = NEPH_GPU_MEDIA_MAX,
        .push_size_bytes = sizeof(struct neph_gpu_march_run),
        .constant_count = NEPH_MARCH_CONSTANTS,
    };
    neph_march_constants(gpu, &work->light->params, params.constants);
    return neph_kernel_get(work->light->vulkan, &params, &work->fill, diag);
}

static enum neph_status get_kernels(struct work *work, const struct neph_gpu_scene *gpu,
                                    struct neph_diag *diag)
{
    const struct {
        const char *name;
        const uint32_t *code;
        size_t bytes;
        int buffers;
        const struct neph_kernel **kernel;
    } rows[] = {
        {"diffuse_links", links_code, sizeof(links_code), 1, &work->links},
        {"diffuse_cycle", cycle_code, sizeof(cycle_code), 1, &work->cycle},
        {"diffuse_field", field_code, sizeof(field_code), 2, &work->field},
    };
    enum neph_status status = get_fill(work, gpu, diag);
    for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]) && !status; i++) {
        const struct neph_kernel_params params = {
            .name = rows[i].name,
            .code = rows[i].code,
            .code_bytes = rows[i].bytes,
            .buffer_count = rows[i].buffers,
            .push_size_bytes = sizeof(struct neph_gpu_diffusion_run),
        };
        status = neph_kernel_get(work->light->vulkan, &params, rows[i].kernel, diag);
    }
    return status;
}

static enum neph_status begin_batch_work(struct work *work, struct neph_diag *diag)
{
    if (neph_interrupted())
        return neph_fail(diag, NEPH_ERR_INTERRUPTED, "diffused light: interrupted");
    return neph_batch_begin(work->light->vulkan, &work->batch, diag);
}

static enum neph_status end_batch_work(struct work *work, struct neph_diag *diag)
{
    neph_batch_stamp(&work->batch, work->gpu_s);
    return neph_batch_submit(&work->batch, "diffused light", diag);
}

static enum neph_status fill_run(const struct neph_gpu_march_run *run, void *context,
                                 struct neph_diag *diag)
{
    struct work *work = context;
    struct neph_dispatch dispatch = *work->bound;
    dispatch.buffers[NEPH_GPU_SCENE_BUFFERS] = &work->light->cells;
    dispatch.buffers[NEPH_GPU_SCENE_BUFFERS + 1] = &work->light->cells; /* unused binding */
    dispatch.push = run;
    dispatch.group_count = (run->ray_count + local_size - 1) / local_size;
    const enum neph_status status = begin_batch_work(work, diag);
    if (status)
        return status;
    neph_batch_dispatch(&work->batch, work->fill, &dispatch, diag);
    return end_batch_work(work, diag);
}

/* --- passes over levels ---------------------------------------------------------------------- */

static void add_pass(struct work *work, const struct neph_kernel *kernel, int level, int other,
                     enum job job, struct neph_diag *diag)
{
    struct neph_diffused_light *light = work->light;
    const struct neph_dispatch dispatch = {
        .buffers = {&light->cells, &light->field},
        .push = &work->run,
        .group_count = (cell_count(&light->levels[level]) + local_size - 1) / local_size,
    };
    work->run.level = light->levels[level];
    work->run.other = light->levels[other];
    work->run.job = job;
    neph_batch_dispatch(&work->batch, kernel, &dispatch, diag);
    neph_batch_barrier(&work->batch);
}

static void add_sweeps(struct work *work, int level, int count, struct neph_diag *diag)
{
    for (int i = 0; i < 2 * count; i++)
        add_pass(work, work->cycle, level, level, i % 2 ? BLACK : RED, diag);
}

static void add_cycle(struct work *work, struct neph_diag *diag)
{
    const int last = work->light->level_count - 1;
    add_pass(work, work->cycle, 0, 0, LIMIT, diag);
    for (int level = 1; level <= last; level++)
        add_pass(work, work->cycle, level, level - 1, COARSEN, diag);
    for (int level = 0; level < last; level++) {
        add_sweeps(work, level, SWEEPS, diag);
        add_pass(work, work->cycle, level + 1, level, LEAVE, diag);
    }
    add_sweeps(work, last, COARSEST_SWEEPS, diag);
    for (int level = last - 1; level >= 0; level--) {
        add_pass(work, work->cycle, level, level + 1, CORRECT, diag);
        add_sweeps(work, level, SWEEPS, diag);
    }
}

static enum neph_status run_cycles(struct work *work, int count, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < count && !status; i++) {
        status = begin_batch_work(work, diag);
        if (status)
            break;
        add_cycle(work, diag);
        if (i + 1 == count)
            add_pass(work, work->field, 0, 0, CLEAR, diag);
        status = end_batch_work(work, diag);
    }
    return status;
}

/* Run `kernel` on all cells of the finest level: links between cells, or a reset of the fluence. */
static enum neph_status run_cells(struct work *work, const struct neph_kernel *kernel,
                                  struct neph_diag *diag)
{
    const enum neph_status status = begin_batch_work(work, diag);
    if (status)
        return status;
    add_pass(work, kernel, 0, 0, CLEAR, diag);
    return end_batch_work(work, diag);
}

/* --- a frame --------------------------------------------------------------------------------- */

/* Whether the solids are unchanged: they cast shadows on cells and block them. */
static bool has_unchanged_solids(const struct neph_diffused_light *light,
                                 const struct neph_scene *scene)
{
    return scene->solid_count == light->solid_count &&
           (scene->solid_count == 0 ||
            memcmp(scene->solids, light->solids,
                   (size_t)scene->solid_count * sizeof(*scene->solids)) == 0);
}

static enum neph_status store_solids(struct neph_diffused_light *light,
                                     const struct neph_scene *scene, struct neph_diag *diag)
{
    const size_t bytes = (size_t)scene->solid_count * sizeof(*scene->solids);
    struct neph_solid *solids = bytes > 0 ? malloc(bytes) : NULL;
    if (bytes > 0 && !solids)
        return neph_fail_memory(diag);
    if (bytes > 0)
        memcpy(solids, scene->solids, bytes);
    free(light->solids);
    light->solids = solids;
    light->solid_count = scene->solid_count;
    return NEPH_OK;
}

static bool has_same_inputs(const struct neph_diffused_light *light, const struct neph_scene *scene)
{
    struct neph_gpu_medium media[NEPH_GPU_MEDIA_MAX];
    neph_gpu_scene_pack_media(scene, media);
    return light->is_filled && neph_gpu_is_same_sun(&scene->sun, &light->sun) &&
           memcmp(media, light->media, sizeof(media)) == 0 && has_unchanged_solids(light, scene);
}

static enum neph_status fill(struct work *work, const struct neph_scene *scene,
                             struct neph_diag *diag)
{
    struct neph_diffused_light *light = work->light;
    if (has_same_inputs(light, scene))
        return NEPH_OK;
    enum neph_status status = neph_march_split_run(&light->cut, fill_run, work, diag);
    if (!status)
        status = run_cells(work, work->links, diag);
    if (!status)
        status = store_solids(light, scene, diag);
    light->is_filled = !status;
    light->settled = 0;
    light->sun = scene->sun;
    neph_gpu_scene_pack_media(scene, light->media);
    return status;
}

/* The boundary coefficient for estimates of unfinished paths: by R. E. Marshak, Phys. Rev. 71,
 * 1947, for the right transmission of a thick slab. For rendered radiance NEPH_GPU_OUTWARD is
 * better. */
static const float marshak_outward = 0.5f;

static struct neph_gpu_diffusion_run make_diffusion_run(const struct neph_diffused_light *light,
                                                        const struct neph_scene *scene,
                                                        const struct neph_gpu_lattice *lattice)
{
    struct neph_gpu_diffusion_run run = {
        .job = CLEAR,
        .outward = light->is_shown ? (float)NEPH_GPU_OUTWARD : marshak_outward,
    };
    float to_sun[3];
    neph_gpu_direction(to_sun, scene->sun.direction);
    for (int axis = 0; axis < 3; axis++) {
        run.sides_m[axis] = 1.0f / lattice->per_m[axis];
        run.beam[axis] = -to_sun[axis];
    }
    return run;
}

static int choose_cycle_count(const struct neph_diffused_light *light, bool continues)
{
    const int wanted = light->params.diffusion.cycles;
    if (!continues)
        return wanted > COLD ? wanted : COLD;
    return light->settled >= SETTLED ? 0 : wanted;
}

enum neph_status neph_diffused_light_solve(struct neph_diffused_light *light,
                                           const struct neph_scene *scene, double frame,
                                           const struct neph_gpu_scene *gpu,
                                           const struct neph_dispatch *bound, bool continues,
                                           bool will_change, double *gpu_s, struct neph_diag *diag)
{
    if (light->level_count == 0)
        return NEPH_OK;
    struct work work = {.light = light, .bound = bound, .gpu_s = gpu_s};
    neph_diffused_light_place(light, scene, frame, gpu);
    if (!continues && light->is_alone && has_same_inputs(light, scene))
        return NEPH_OK; /* an independent frame with equal inputs */
    work.run = make_diffusion_run(light, scene, &gpu->frame->light_lattice);
    enum neph_status status = get_kernels(&work, gpu, diag);
    if (!continues)
        light->settled = 0;
    if (!status && !continues)
        status = run_cells(&work, work.cycle, diag);
    if (!status)
        status = fill(&work, scene, diag);
    light->is_filled &= !will_change;
    const int cycles = choose_cycle_count(light, continues);
    if (!status)
        status = run_cycles(&work, cycles, diag);
    light->settled += status ? 0 : cycles;
    light->is_alone = !continues && !status;
    return status;
}
