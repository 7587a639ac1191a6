/* SPDX-License-Identifier: MIT */
#include "renderer/screen/screen.h"

#include "base/half.h"
#include "renderer/gpu_scene.h"
#include "renderer/vulkan_device.h"
#include "scenes/motion.h"
#include "scenes/surfaces.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Does not compile with a new kind: this file then needs a change. */
_Static_assert(NEPH_PATTERN_COUNT == 2, "a new kind");
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");

enum { TILE_PX = 8, BUFFERS = NEPH_GPU_SCENE_BUFFERS + 2, CHANNELS = 4 };

/* The current frame and the previous one. */
struct moment {
    double frame, frame_before;
    bool has_before;
    struct neph_camera now, before;
};

/* Targets that become the previous frame's. */
static const int history_targets[][2] = {
    {SCREEN_DEPTH, SCREEN_DEPTH_BEFORE},       {SCREEN_NORMAL, SCREEN_NORMAL_BEFORE},
    {SCREEN_GI_MEAN, SCREEN_GI_BEFORE},        {SCREEN_SSR_MEAN, SCREEN_SSR_BEFORE},
    {SCREEN_GI_COUNT, SCREEN_GI_COUNT_BEFORE}, {SCREEN_SSR_COUNT, SCREEN_SSR_COUNT_BEFORE}};

struct neph_screen_renderer {
    struct neph_vulkan *vulkan; /* borrowed */
    struct neph_screen_params params;
    struct neph_gpu_scene gpu;
    struct neph_buffer view, surfaces, targets[SCREEN_TARGET_COUNT], readback;
    const struct neph_kernel *kernels[NEPH_SCREEN_PASSES_MAX];
    double frame_before; /* of the scene */
    unsigned used;       /* targets in use, a bit each */
    uint32_t frame;      /* number of frames; seed of the noise */
};

/* --- supported scenes ------------------------------------------------------------------------- */

bool neph_screen_can_render(const struct neph_scene *scene, char *reason, size_t reason_size)
{
    const char *cannot = scene->medium_count > 0 ? "media: the screen passes support only solids"
                                                 : neph_mesh_obstacle(scene);
    if (cannot)
        snprintf(reason, reason_size, "%s", cannot);
    return !cannot;
}

/* --- sizes ------------------------------------------------------------------------------------ */

static size_t pixel_count(const struct neph_screen_renderer *screen)
{
    return (size_t)screen->params.width_px * (size_t)screen->params.height_px;
}

static bool is_half(const struct neph_screen_renderer *screen)
{
    return screen->params.settings.values[SCREEN_TARGETS] == SCREEN_FLOAT16;
}

static size_t target_bytes(const struct neph_screen_renderer *screen, int target)
{
    const size_t words = target < SCREEN_FIRST_OF_FOUR ? 1
                         : is_half(screen)             ? SCREEN_WORDS_16
                                                       : SCREEN_WORDS_32;
    return pixel_count(screen) * words * sizeof(uint32_t);
}

/* --- creation --------------------------------------------------------------------------------- */

/* Targets that no enabled pass uses have the size of one word, because they must be bound. */
unsigned neph_screen_targets_used(const struct neph_settings *settings)
{
    unsigned used = 0;
    for (const struct neph_screen_pass *pass = neph_screen_passes; pass->name; pass++)
        if (neph_screen_is_on(pass, settings))
            used |= pass->reads | pass->writes;
    return used;
}

static enum neph_status create_buffers(struct neph_screen_renderer *screen, struct neph_diag *diag)
{
    screen->used = neph_screen_targets_used(&screen->params.settings);
    const struct neph_buffer_row rows[] = {
        {&screen->view, NEPH_BUFFER_UPLOAD, sizeof(struct neph_gpu_screen_view), "screen view"},
        {&screen->surfaces, NEPH_BUFFER_UPLOAD,
         NEPH_SCENE_SOLIDS_MAX * sizeof(struct neph_gpu_screen_surface), "screen surfaces"},
        {&screen->readback, NEPH_BUFFER_READBACK,
         pixel_count(screen) * SCREEN_WORDS_32 * sizeof(uint32_t), "screen readback"},
    };
    enum neph_status status = neph_buffers_create(screen->vulkan, rows,
                                                  sizeof(rows) / sizeof(rows[0]), diag);
    for (int t = 0; t < SCREEN_TARGET_COUNT && !status; t++)
        status = neph_buffer_create(screen->vulkan, NEPH_BUFFER_DEVICE,
                                    screen->used >> t & 1u ? target_bytes(screen, t)
                                                           : sizeof(uint32_t),
                                    neph_screen_targets[t], &screen->targets[t], diag);
    return status;
}

static enum neph_status get_kernels(struct neph_screen_renderer *screen, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; neph_screen_passes[i].name && !status; i++) {
        const struct neph_screen_pass *pass = &neph_screen_passes[i];
        const struct neph_kernel_params params = {
            .name = pass->shader.name,
            .code = pass->shader.code,
            .code_bytes = pass->shader.code_bytes,
            .buffer_count = BUFFERS,
            .uniform_count = NEPH_GPU_SCENE_UNIFORMS,
            .array_count = SCREEN_TARGET_COUNT,
            .push_size_bytes = sizeof(struct neph_gpu_screen_run),
            .constant_count = NEPH_GPU_SCENE_CONSTANTS,
            .constants = {screen->gpu.constants[0], screen->gpu.constants[1]},
        };
        if (neph_screen_is_on(pass, &screen->params.settings))
            status = neph_kernel_get(screen->vulkan, &params, &screen->kernels[i], diag);
    }
    return status;
}

enum neph_status neph_screen_renderer_create(struct neph_vulkan *vulkan,
                                             const struct neph_scene *scene,
                                             const struct neph_screen_params *params,
                                             struct neph_screen_renderer **screen,
                                             struct neph_diag *diag)
{
    struct neph_screen_renderer *made = calloc(1, sizeof(*made));
    if (!made)
        return neph_fail_memory(diag);
    made->vulkan = vulkan;
    made->params = *params;
    enum neph_status status = neph_gpu_scene_create(vulkan, scene, 0.0, params->width_px,
                                                    params->height_px, false, &made->gpu, diag);
    if (scene->mover_count > 0) /* boxes that have not turned yet will turn when they move */
        made->gpu.constants[1] |= NEPH_GPU_TURNED;
    if (!status)
        status = create_buffers(made, diag);
    if (!status)
        status = get_kernels(made, diag);
    if (status)
        neph_screen_renderer_destroy(made);
    else
        *screen = made;
    return status;
}

void neph_screen_renderer_destroy(struct neph_screen_renderer *screen)
{
    if (!screen)
        return;
    neph_buffer_destroy(screen->vulkan, &screen->readback);
    for (int t = SCREEN_TARGET_COUNT - 1; t >= 0; t--)
        neph_buffer_destroy(screen->vulkan, &screen->targets[t]);
    neph_buffer_destroy(screen->vulkan, &screen->surfaces);
    neph_buffer_destroy(screen->vulkan, &screen->view);
    neph_gpu_scene_destroy(screen->vulkan, &screen->gpu);
    free(screen);
}

/* --- parameters of the shaders ---------------------------------------------------------------- */

/* The target of the last of `turns` smoothing passes that alternate from `first` on. */
static uint32_t last_target(double turns, uint32_t none, uint32_t first)
{
    return turns == 0.0 ? none : first + ((uint32_t)turns + 1) % 2;
}

/* The target with the final cells of the passes with this resolution setting. */
static uint32_t found_target(const double *values, int resolution)
{
    switch (resolution) {
    case SCREEN_AO_RESOLUTION:
        return values[SCREEN_AO_BLUR_PX] > 0.0 ? SCREEN_OPEN_SMOOTH : SCREEN_OPEN;
    case SCREEN_GI_RESOLUTION:
        return last_target(values[SCREEN_GI_SMOOTH], SCREEN_GI_MEAN, SCREEN_GI_A);
    default:
        return last_target(values[SCREEN_SSR_SMOOTH], SCREEN_SSR_MEAN, SCREEN_SSR_A);
    }
}

/* The target after upsampling to all pixels: the free one of two alternating targets. */
static uint32_t whole_target(const double *values, int resolution)
{
    const uint32_t found = found_target(values, resolution);
    if (values[resolution] == SCREEN_FULL)
        return found;
    switch (resolution) {
    case SCREEN_AO_RESOLUTION:
        return SCREEN_OPEN_WHOLE;
    case SCREEN_GI_RESOLUTION:
        return found == SCREEN_GI_A ? SCREEN_GI_B : SCREEN_GI_A;
    default:
        return found == SCREEN_SSR_A ? SCREEN_SSR_B : SCREEN_SSR_A;
    }
}

static uint32_t open_target(const double *values)
{
    return values[SCREEN_AO] == SCREEN_AO_OFF ? SCREEN_NONE
                                              : whole_target(values, SCREEN_AO_RESOLUTION);
}

static uint32_t gi_target(const double *values)
{
    return values[SCREEN_GI] == 0.0 ? SCREEN_NONE : whole_target(values, SCREEN_GI_RESOLUTION);
}

static uint32_t ssr_target(const double *values)
{
    return values[SCREEN_SSR] == 0.0 ? SCREEN_NONE : whole_target(values, SCREEN_SSR_RESOLUTION);
}

static uint32_t cell_px(const double *values, int resolution)
{
    return resolution && values[resolution] == SCREEN_HALF ? 2 : 1;
}

static void fill_sky(const struct neph_scene *scene, float sky[3])
{
    const struct neph_rgb light = scene->background_w_per_m2_sr;
    sky[0] = scene->environment_light ? (float)light.r : 0.0f;
    sky[1] = scene->environment_light ? (float)light.g : 0.0f;
    sky[2] = scene->environment_light ? (float)light.b : 0.0f;
}

static void fill_view(struct neph_screen_renderer *screen, const struct neph_scene *scene,
                      const struct moment *moment)
{
    const struct neph_camera camera = moment->now;
    const struct neph_screen_params *params = &screen->params;
    const double *values = params->settings.values;
    const double half_height = neph_camera_half_height(&camera);
    struct neph_gpu_screen_view *view = screen->view.mapped;
    for (int i = 0; i < SCREEN_SETTING_COUNT; i++)
        view->settings[i] = (float)values[i];
    view->size_px[0] = (uint32_t)params->width_px;
    view->size_px[1] = (uint32_t)params->height_px;
    view->half_size[0] = (float)(half_height * params->width_px / params->height_px);
    view->half_size[1] = (float)half_height;
    view->is_orthographic = camera.orthographic_height_m > 0.0;
    view->has_before = moment->has_before;
    view->has_bounces = scene->scattering == NEPH_SCATTERING_MULTIPLE;
    fill_sky(scene, view->sky_light);
    view->open_at = open_target(values);
    view->gi_at = gi_target(values);
    view->ssr_at = ssr_target(values);
    view->gi_cell_px = cell_px(values, SCREEN_GI_RESOLUTION);
    view->ssr_cell_px = cell_px(values, SCREEN_SSR_RESOLUTION);
    view->frame = screen->frame;
}

/* The previous position, in axes of the previous camera, of a point in axes of the current camera,
 * on a solid that has moved between two placements. */
static struct neph_vec3 reproject_position_m(const struct moment *moment,
                                             const struct neph_placing *now,
                                             const struct neph_placing *before,
                                             struct neph_vec3 own_m)
{
    const struct neph_camera *here = &moment->now, *there = &moment->before;
    struct neph_vec3 point_m = neph_vec3_along(here->position_m, here->right, own_m.x);
    point_m = neph_vec3_along(point_m, here->up, own_m.y);
    point_m = neph_vec3_along(point_m, here->forward, own_m.z);
    if (now)
        point_m = neph_find_earlier_place_m(now, before, point_m);
    const struct neph_vec3 way_m = neph_vec3_sub(point_m, there->position_m);
    return (struct neph_vec3){neph_vec3_dot(way_m, there->right), neph_vec3_dot(way_m, there->up),
                              neph_vec3_dot(way_m, there->forward)};
}

static void fill_to_before(const struct moment *moment, const struct neph_placing *now,
                           const struct neph_placing *before, float rows[12])
{
    const struct neph_vec3 units[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const struct neph_vec3 origin = reproject_position_m(moment, now, before,
                                                         (struct neph_vec3){0});
    for (int c = 0; c < 3; c++) {
        const struct neph_vec3 column = neph_vec3_sub(
            reproject_position_m(moment, now, before, units[c]), origin);
        rows[c] = (float)column.x;
        rows[4 + c] = (float)column.y;
        rows[8 + c] = (float)column.z;
    }
    rows[3] = (float)origin.x;
    rows[7] = (float)origin.y;
    rows[11] = (float)origin.z;
}

static void fill_surface(const struct neph_surface *from, struct neph_gpu_screen_surface *surface)
{
    const struct neph_rgb other = from->texture.other;
    *surface = (struct neph_gpu_screen_surface){
        .other = {(float)other.r, (float)other.g, (float)other.b},
        .roughness = (float)from->roughness,
        .metalness = (float)from->metalness,
        .cell_m = (float)from->texture.cell_m,
        .is_noise = from->texture.pattern == NEPH_PATTERN_NOISE,
        .seed = (uint32_t)from->texture.seed,
    };
}

/* `scene` is the animated scene, with the motion of its solids. */
static void fill_surfaces(struct neph_screen_renderer *screen, const struct neph_scene *scene,
                          const struct moment *moment)
{
    struct neph_gpu_screen_surface *surfaces = screen->surfaces.mapped;
    for (int i = 0; i < scene->solid_count; i++) {
        fill_surface(&scene->solids[i].surface, &surfaces[i]);
        fill_to_before(moment, NULL, NULL, surfaces[i].to_before);
    }
    for (int m = 0; m < scene->mover_count; m++) {
        const struct neph_mover *mover = &scene->movers[m];
        const struct neph_placing now = neph_mover_placing(scene, mover, moment->frame);
        const struct neph_placing before = neph_mover_placing(scene, mover, moment->frame_before);
        for (int i = mover->first; i < mover->first + mover->count; i++)
            fill_to_before(moment, &now, &before, surfaces[i].to_before);
    }
}

/* --- passes ----------------------------------------------------------------------------------- */

/* Whether each frame samples another pixel of each cell. */
static bool is_pixel_turning(const double *values, int resolution)
{
    const int history = resolution == SCREEN_GI_RESOLUTION ? SCREEN_GI_HISTORY : SCREEN_SSR_HISTORY;
    return resolution && resolution != SCREEN_AO_RESOLUTION && values[resolution] == SCREEN_HALF &&
           values[SCREEN_RAY_PIXEL] == SCREEN_PIXEL_TURNING && values[history] > 0.0;
}

/* The pixel of a cell that a pass samples in a frame. */
static void find_pixel(const double *values, int resolution, uint32_t frame, uint32_t pixel[2])
{
    static const uint32_t order[4][2] = {{0, 0}, {1, 1}, {1, 0}, {0, 1}};
    const uint32_t *at = order[is_pixel_turning(values, resolution) ? frame % 4 : 0];
    pixel[0] = at[0];
    pixel[1] = at[1];
}

static struct neph_gpu_screen_run make_pass_run(const struct neph_screen_renderer *screen,
                                                int index, unsigned turn)
{
    const struct neph_screen_pass *pass = &neph_screen_passes[index];
    const double *values = screen->params.settings.values;
    struct neph_gpu_screen_run run = {.turn = pass->turn + turn,
                                      .from = pass->from,
                                      .to = pass->to,
                                      .before = pass->before,
                                      .cell_px = cell_px(values, pass->resolution)};
    find_pixel(values, pass->resolution, screen->frame - 1, run.own_px); /* the number includes the
                                                                            current frame */
    find_pixel(values, pass->resolution, screen->frame - 2, run.before_px);
    if (pass->turns_setting) {
        run.from = turn == 0 ? pass->from : pass->to + (turn - 1) % 2;
        run.to = pass->to + turn % 2;
    }
    if (pass->makes_whole) {
        run.from = found_target(values, pass->resolution);
        run.to = whole_target(values, pass->resolution);
    }
    return run;
}

/* Work groups along an axis: one thread per cell; when upsampling, one per gap between cells and
 * beyond the last. */
static uint32_t tile_count(int size_px, const struct neph_gpu_screen_run *run, bool makes_whole,
                           int axis)
{
    const uint32_t cells = ((uint32_t)size_px + run->cell_px - 1) / run->cell_px;
    return (cells + (makes_whole ? run->own_px[axis] : 0) + TILE_PX - 1) / TILE_PX;
}

static void add_turn(struct neph_screen_renderer *screen, int pass, unsigned turn,
                     struct neph_batch *batch, struct neph_diag *diag)
{
    const uint32_t groups_max = screen->vulkan->limits.maxComputeWorkGroupCount[0];
    struct neph_gpu_screen_run run = make_pass_run(screen, pass, turn);
    const bool makes_whole = neph_screen_passes[pass].makes_whole;
    const uint32_t groups = tile_count(screen->params.width_px, &run, makes_whole, 0) *
                            tile_count(screen->params.height_px, &run, makes_whole, 1);
    struct neph_dispatch dispatch = {.push = &run};
    neph_gpu_scene_bind(&screen->gpu, &dispatch);
    dispatch.buffers[NEPH_GPU_SCENE_BUFFERS] = &screen->view;
    dispatch.buffers[NEPH_GPU_SCENE_BUFFERS + 1] = &screen->surfaces;
    for (int t = 0; t < SCREEN_TARGET_COUNT; t++)
        dispatch.buffers[BUFFERS + t] = &screen->targets[t];
    for (; run.first_group < groups; run.first_group += dispatch.group_count) {
        const uint32_t left = groups - run.first_group;
        dispatch.group_count = left < groups_max ? left : groups_max;
        neph_batch_dispatch(batch, screen->kernels[pass], &dispatch, diag);
    }
    neph_batch_barrier(batch);
}

static unsigned get_turn_count(const struct neph_screen_renderer *screen, int pass)
{
    const int setting = neph_screen_passes[pass].turns_setting;
    return setting ? (unsigned)screen->params.settings.values[setting] : 1;
}

static enum neph_status run_passes(struct neph_screen_renderer *screen,
                                   struct neph_screen_stats *stats, struct neph_diag *diag)
{
    struct neph_batch batch;
    neph_batch_begin(screen->vulkan, &batch, diag);
    for (int i = 0; neph_screen_passes[i].name; i++) {
        if (!screen->kernels[i])
            continue;
        for (unsigned turn = 0; turn < get_turn_count(screen, i); turn++)
            add_turn(screen, i, turn, &batch, diag);
        neph_batch_stamp(&batch, &stats->gpu_s[i]);
    }
    const enum neph_status status = neph_batch_submit(&batch, "screen", diag);
    return status ? status
                  : neph_batches_wait(screen->vulkan, neph_batches_submitted(screen->vulkan),
                                      "screen", diag);
}

static void swap_history_targets(struct neph_screen_renderer *screen)
{
    for (size_t i = 0; i < sizeof(history_targets) / sizeof(history_targets[0]); i++) {
        if (!(screen->used >> history_targets[i][1] & 1u))
            continue;
        const struct neph_buffer now = screen->targets[history_targets[i][0]];
        screen->targets[history_targets[i][0]] = screen->targets[history_targets[i][1]];
        screen->targets[history_targets[i][1]] = now;
    }
}

/* --- read-back -------------------------------------------------------------------------------- */

static void unpack(const struct neph_screen_renderer *screen, int target, const uint32_t *words,
                   float *texels)
{
    const size_t count = pixel_count(screen) * CHANNELS;
    for (size_t i = 0; i < count; i++)
        if (target < SCREEN_FIRST_OF_FOUR)
            memcpy(&texels[i], &words[i / CHANNELS], sizeof(float));
        else if (is_half(screen))
            texels[i] = neph_half_to_float((uint16_t)(words[i / 2] >> 16 * (i % 2)));
        else
            memcpy(&texels[i], &words[i], sizeof(float));
}

enum neph_status neph_screen_renderer_read(struct neph_screen_renderer *screen, int target,
                                           float *texels, struct neph_diag *diag)
{
    const enum neph_status status = neph_buffer_download(screen->vulkan, &screen->targets[target],
                                                         &screen->readback,
                                                         target_bytes(screen, target), diag);
    if (!status)
        unpack(screen, target, screen->readback.mapped, texels);
    return status;
}

/* --- the image -------------------------------------------------------------------------------- */

static enum neph_status read_rgb_layer(struct neph_screen_renderer *screen, int target,
                                       const char *layer, float *texels, struct neph_image *image,
                                       struct neph_diag *diag)
{
    float *rgb[3];
    enum neph_status status = neph_image_add_rgb(image, layer, rgb, diag);
    if (!status)
        status = neph_screen_renderer_read(screen, target, texels, diag);
    for (size_t i = 0; i < pixel_count(screen) && !status; i++)
        for (int c = 0; c < 3; c++)
            rgb[c][i] = texels[CHANNELS * i + (size_t)c];
    return status;
}

/* Copy one channel of a target to the image. */
static enum neph_status read_one_channel(struct neph_screen_renderer *screen, int target,
                                         int channel, const char *name, float *texels,
                                         struct neph_image *image, struct neph_diag *diag)
{
    float *samples;
    enum neph_status status = neph_image_add_channel(image, name, &samples, diag);
    if (!status)
        status = neph_screen_renderer_read(screen, target, texels, diag);
    for (size_t i = 0; i < pixel_count(screen) && !status; i++) {
        const float value = texels[CHANNELS * i + (size_t)channel];
        samples[i] = value < NEPH_GPU_FAR_M ? value : INFINITY;
    }
    return status;
}

/* Indirect light of other surfaces, and the response to a sky of radiance 1. */
static enum neph_status read_ray_layers(struct neph_screen_renderer *screen, uint32_t target,
                                        const char *layer, const char *open, float *texels,
                                        struct neph_image *image, struct neph_diag *diag)
{
    if (target == SCREEN_NONE)
        return NEPH_OK;
    const enum neph_status status = read_rgb_layer(screen, (int)target, layer, texels, image, diag);
    return status ? status : read_one_channel(screen, (int)target, 3, open, texels, image, diag);
}

static enum neph_status add_transmittance(struct neph_image *image, struct neph_diag *diag)
{
    float *rgb[3];
    const enum neph_status status = neph_image_add_rgb(image, "transmittance", rgb, diag);
    for (size_t i = 0; i < neph_image_pixel_count(image) && !status; i++)
        rgb[0][i] = rgb[1][i] = rgb[2][i] = 1.0f;
    return status;
}

static enum neph_status read_image_layers(struct neph_screen_renderer *screen,
                                          struct neph_image *image, struct neph_diag *diag)
{
    const double *values = screen->params.settings.values;
    const uint32_t open = open_target(values);
    float *texels = malloc(pixel_count(screen) * CHANNELS * sizeof(*texels));
    if (!texels)
        return neph_fail_memory(diag);
    enum neph_status status = read_rgb_layer(screen, SCREEN_PICTURE, NULL, texels, image, diag);
    if (!status)
        status = add_transmittance(image, diag);
    if (!status)
        status = read_one_channel(screen, SCREEN_DEPTH, 0, "Z", texels, image, diag);
    if (!status)
        status = read_rgb_layer(screen, SCREEN_DIRECT, "direct", texels, image, diag);
    if (!status && open != SCREEN_NONE)
        status = read_rgb_layer(screen, (int)open, "ao", texels, image, diag);
    if (!status)
        status = read_ray_layers(screen, gi_target(values), "diffuse_indirect", "diffuse_open",
                                 texels, image, diag);
    if (!status)
        status = read_ray_layers(screen, ssr_target(values), "glossy_indirect", "glossy_open",
                                 texels, image, diag);
    free(texels);
    return status;
}

/* --- a frame ---------------------------------------------------------------------------------- */

static struct moment make_moment(const struct neph_screen_renderer *screen,
                                 const struct neph_scene *scene, double frame)
{
    const double before = screen->frame > 0 ? screen->frame_before : frame;
    return (struct moment){
        .frame = frame,
        .frame_before = before,
        .has_before = screen->frame > 0 && !neph_scene_is_cut(scene, before, frame),
        .now = neph_scene_camera(scene, frame),
        .before = neph_scene_camera(scene, before),
    };
}

/* Upload the scene at a frame. */
static enum neph_status upload_scene(struct neph_screen_renderer *screen,
                                     const struct neph_scene *scene, double frame,
                                     struct neph_diag *diag)
{
    const struct moment moment = make_moment(screen, scene, frame);
    struct neph_scene *still = NULL;
    enum neph_status status = neph_scene_at(scene, frame, &still, diag);
    if (status)
        return status;
    if (screen->frame > 0)
        swap_history_targets(screen);
    status = neph_gpu_scene_update(screen->vulkan, &screen->gpu, still, frame,
                                   screen->params.width_px, screen->params.height_px, NULL, diag);
    fill_view(screen, still, &moment);
    fill_surfaces(screen, scene, &moment);
    screen->frame++;
    screen->frame_before = frame;
    neph_scene_destroy(still);
    return status;
}

enum neph_status neph_screen_renderer_frame(struct neph_screen_renderer *screen,
                                            const struct neph_scene *scene, double frame,
                                            struct neph_image **image,
                                            struct neph_screen_stats *stats, struct neph_diag *diag)
{
    struct neph_screen_stats own_stats = {{0}};
    struct neph_image *made = NULL;
    enum neph_status status = upload_scene(screen, scene, frame, diag);
    if (!status)
        status = run_passes(screen, &own_stats, diag);
    if (!status && image)
        status = neph_image_create(screen->params.width_px, screen->params.height_px, &made, diag);
    if (!status && image)
        status = read_image_layers(screen, made, diag);
    if (!status)
        status = neph_vulkan_check(screen->vulkan, diag);
    if (status) {
        neph_image_destroy(made);
        return status;
    }
    if (stats)
        *stats = own_stats;
    if (image)
        *image = made;
    return NEPH_OK;
}
