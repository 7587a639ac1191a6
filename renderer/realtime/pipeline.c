/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/pipeline.h"

#include "base/clock.h"
#include "renderer/march_cut.h"
#include "renderer/realtime/images.h"
#include "renderer/realtime/jitter.h"
#include "renderer/realtime/layout.h"
#include "renderer/realtime/noise.h"
#include "renderer/realtime/shaders.h"
#include "scenes/media.h"
#include "scenes/motion.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const uint32_t scene_spirv[] = {
#include "shaders/rt_scene.comp.inc"
};
static const uint32_t march_spirv[] = {
#include "shaders/rt_march.comp.inc"
};

/* Counters of shaders/realtime_march.glsl */
struct gpu_counters {
    uint32_t rays;
    uint32_t view_steps[2];
    uint32_t density_evaluations[2];
    uint32_t closed_forms[2];
};
_Static_assert(sizeof(struct gpu_counters) == 28, "std430 Counters");

/* Where the camera was. */
struct past {
    struct neph_camera camera;
    struct neph_vec3 drift_m;
    int frame;
    float jitter_px[2];
};

struct neph_realtime {
    struct neph_vulkan *vulkan; /* borrowed */
    struct neph_settings settings;
    uint32_t seed;
    uint32_t *noise_ranks; /* owned */
    struct neph_march_params march;
    struct neph_gpu_scene scene;
    struct neph_march *whole;     /* owned; without a split the march of every pixel, else NULL */
    struct neph_march_cut pixels; /* of the scene pass */
    struct neph_march_cut tiles;  /* of the march */
    struct neph_buffer states, counters;
    struct neph_rt_device device;
    uint32_t frame_count; /* that it has rendered */
    uint32_t touched;     /* targets that this frame has read or written */
    bool has_past;
    struct past past;
    neph_realtime_observer *observer;
    void *observer_context;
};

/* --- the passes --------------------------------------------------------------------------- */

typedef enum neph_status run_pass(struct neph_realtime *realtime, int pass, double *gpu_s,
                                  struct neph_diag *diag);
static run_pass run_scene, run_tile_index, run_march, run_shader;

enum extent { FULL, HALF, TILES };

#define BIT(target) (1u << (target))

/* The pipeline. */
static const struct {
    const char *name;
    run_pass *run;
    const struct neph_rt_shader *shader; /* of run_shader and run_tile_index */
    enum extent extent;                  /* one thread for each element of it */
    uint32_t reads, writes;              /* targets */
} passes[NEPH_REALTIME_PASS_COUNT] = {
    {"scene", run_scene, NULL, FULL, 0, BIT(RT_DEPTH) | BIT(RT_BEHIND) | BIT(RT_STEADY_DEPTH)},
    {"depth map", run_shader, &neph_rt_shader_min_max, HALF, BIT(RT_STEADY_DEPTH),
     BIT(RT_HALF_DEPTH)},
    {"tile index", run_tile_index, &neph_rt_shader_tile_index, TILES, BIT(RT_HALF_DEPTH),
     BIT(RT_TILE)},
    {"march", run_march, NULL, TILES, BIT(RT_TILE) | BIT(RT_HALF_DEPTH),
     BIT(RT_RAY) | BIT(RT_RAY_DISTANCE)},
    {"reconstruction", run_shader, &neph_rt_shader_reconstruct, HALF,
     BIT(RT_TILE) | BIT(RT_RAY) | BIT(RT_RAY_DISTANCE) | BIT(RT_HALF_DEPTH) |
         BIT(RT_HALF_DEPTH_BEFORE) | BIT(RT_HISTORY_BEFORE) | BIT(RT_HISTORY_STATE_BEFORE),
     BIT(RT_HISTORY) | BIT(RT_HISTORY_STATE)},
    {"upscale", run_shader, &neph_rt_shader_upscale, FULL,
     BIT(RT_DEPTH) | BIT(RT_HALF_DEPTH) | BIT(RT_HISTORY) | BIT(RT_HISTORY_STATE),
     BIT(RT_VOLUME) | BIT(RT_VOLUME_DISTANCE)},
    {"composition", run_shader, &neph_rt_shader_compose, FULL, BIT(RT_VOLUME) | BIT(RT_BEHIND),
     BIT(RT_COLOR)},
    {"anti-aliasing", run_shader, &neph_rt_shader_taa, FULL,
     BIT(RT_COLOR) | BIT(RT_DEPTH) | BIT(RT_TAA_BEFORE), BIT(RT_TAA_OUT)},
};
enum { PASS_SCENE, PASS_DEPTH_MAP, PASS_TILE_INDEX, PASS_MARCH, PASS_TAA = 7 };

/* What a frame leaves for the next: written as the first, read as the second. */
static const int handed_on[][2] = {
    {RT_HALF_DEPTH, RT_HALF_DEPTH_BEFORE},
    {RT_HISTORY, RT_HISTORY_BEFORE},
    {RT_HISTORY_STATE, RT_HISTORY_STATE_BEFORE},
    {RT_TAA_OUT, RT_TAA_BEFORE},
};

const char *neph_realtime_pass_name(int pass)
{
    return pass >= 0 && pass < NEPH_REALTIME_PASS_COUNT ? passes[pass].name : NULL;
}

static int choice_of(const struct neph_realtime *realtime, int setting)
{
    return (int)realtime->settings.values[setting];
}

static size_t thread_count(const struct neph_rt_view *view, enum extent extent)
{
    switch (extent) {
    case FULL:
        return (size_t)view->size_px[0] * view->size_px[1];
    case HALF:
        return (size_t)view->half_size_px[0] * view->half_size_px[1];
    default:
        return (size_t)view->tile_count[0] * view->tile_count[1];
    }
}

static enum neph_status run_shader(struct neph_realtime *realtime, int pass, double *gpu_s,
                                   struct neph_diag *diag)
{
    return neph_rt_device_run(&realtime->device, passes[pass].shader, 0,
                              thread_count(realtime->device.view, passes[pass].extent), gpu_s,
                              diag);
}

/* Four dispatches where tiles see what others chose, one elsewhere. */
static enum neph_status run_tile_index(struct neph_realtime *realtime, int pass, double *gpu_s,
                                       struct neph_diag *diag)
{
    const uint32_t colours = choice_of(realtime, RT_OVERRIDE) == RT_OVERRIDE_SEQUENTIAL ? 4 : 1;
    enum neph_status status = NEPH_OK;
    for (uint32_t colour = 0; colour < colours && !status; colour++)
        status = neph_rt_device_run(&realtime->device, passes[pass].shader, colour,
                                    thread_count(realtime->device.view, passes[pass].extent), gpu_s,
                                    diag);
    return status;
}

/* A kernel that looks at the scene, in dispatches as the march needs them. */
struct scene_run {
    struct neph_realtime *realtime;
    const struct neph_kernel *kernel;
    double *gpu_s;
};

static enum neph_status run_scene_dispatch(const struct neph_gpu_march_run *run, void *context,
                                           struct neph_diag *diag)
{
    struct scene_run *work = context;
    struct neph_realtime *realtime = work->realtime;
    struct neph_dispatch dispatch = {
        .push = run,
        .group_count = (run->ray_count + NEPH_MARCH_LOCAL_SIZE - 1) / NEPH_MARCH_LOCAL_SIZE,
    };
    neph_gpu_scene_bind(&realtime->scene, &dispatch);
    int next = NEPH_GPU_SCENE_BUFFERS;
    dispatch.buffers[next++] = &realtime->states;
    dispatch.buffers[next++] = &realtime->counters;
    dispatch.buffers[next++] = &realtime->device.view_buffer;
    dispatch.buffers[next++] = &realtime->device.noise;
    for (int t = 0; t < RT_TARGET_COUNT; t++)
        dispatch.buffers[next++] = &realtime->device.targets[t];
    double spent_s;
    const enum neph_status status = neph_kernel_run(realtime->vulkan, work->kernel, &dispatch,
                                                    &spent_s, diag);
    if (!status)
        *work->gpu_s += spent_s;
    return status;
}

static enum neph_status run_on_scene(struct neph_realtime *realtime,
                                     const struct neph_rt_shader *shader,
                                     const struct neph_march_cut *cut, double *gpu_s,
                                     struct neph_diag *diag)
{
    struct neph_kernel_params params = {
        .name = shader->name,
        .spirv = shader->spirv,
        .spirv_size_bytes = shader->spirv_size_bytes,
        .buffer_count = NEPH_GPU_SCENE_BUFFERS + 4,
        .array_count = RT_TARGET_COUNT,
        .push_size_bytes = sizeof(struct neph_gpu_march_run),
    };
    params.constant_count = neph_rt_constants(&realtime->device, params.constants);
    neph_march_constants(&realtime->scene, &realtime->march, params.constants);
    neph_rt_device_show(&realtime->device);
    struct scene_run work = {.realtime = realtime, .gpu_s = gpu_s};
    const enum neph_status status = neph_kernel_get(realtime->vulkan, &params, &work.kernel, diag);
    return status ? status : neph_march_cut_run(cut, run_scene_dispatch, &work, diag);
}

static enum neph_status run_scene(struct neph_realtime *realtime, int pass, double *gpu_s,
                                  struct neph_diag *diag)
{
    (void)pass;
    const struct neph_rt_shader shader = {"rt_scene", scene_spirv, sizeof(scene_spirv)};
    return run_on_scene(realtime, &shader, &realtime->pixels, gpu_s, diag);
}

static enum neph_status run_march(struct neph_realtime *realtime, int pass, double *gpu_s,
                                  struct neph_diag *diag)
{
    (void)pass;
    const struct neph_rt_shader shader = {"rt_march", march_spirv, sizeof(march_spirv)};
    return run_on_scene(realtime, &shader, &realtime->tiles, gpu_s, diag);
}

/* --- what can be rendered ------------------------------------------------------------------ */

bool neph_realtime_can_render(const struct neph_scene *scene, const struct neph_settings *settings,
                              char *reason, size_t reason_size)
{
    for (int i = 0; i < scene->medium_count; i++) {
        if (!neph_medium_is_coloured(&scene->media[i]))
            continue;
        snprintf(reason, reason_size,
                 "extinction that differs between the channels: rays and histories have one "
                 "transmittance");
        return false;
    }
    return neph_march_can_render(
        scene, (enum neph_march_lighting)(int)settings->values[RT_LIGHTING], reason, reason_size);
}

/* --- making -------------------------------------------------------------------------------- */

static struct neph_march_params march_params(const struct neph_realtime_params *params)
{
    const double *values = params->settings->values;
    return (struct neph_march_params){
        .width_px = params->width_px,
        .height_px = params->height_px,
        .steps = (int)values[RT_STEPS],
        .transmittance = (enum neph_march_mode)(int)values[RT_TRANSMITTANCE],
        .sun = (enum neph_march_mode)(int)values[RT_SUN],
        .lighting = (enum neph_march_lighting)(int)values[RT_LIGHTING],
        .sun_steps = (int)values[RT_SUN_STEPS],
    };
}

/* Everything that depends on the size. */
static enum neph_status create_sized(struct neph_realtime *realtime, const struct neph_scene *scene,
                                     struct neph_diag *diag)
{
    struct neph_march_params one_step = realtime->march;
    one_step.steps = 1;
    struct neph_rt_view view;
    const int size_px[2] = {realtime->march.width_px, realtime->march.height_px};
    const int origin_px[2] = {0, 0};
    neph_rt_view_init(&view, &realtime->settings, size_px, origin_px, size_px);
    view.seed = realtime->seed;
    enum neph_status status = neph_march_cut_make(realtime->vulkan, scene, &realtime->scene,
                                                  &one_step, thread_count(&view, FULL),
                                                  &realtime->pixels, diag);
    if (!status)
        status = neph_march_cut_make(realtime->vulkan, scene, &realtime->scene, &realtime->march,
                                     thread_count(&view, TILES), &realtime->tiles, diag);
    if (!status)
        status = neph_buffer_create(realtime->vulkan, NEPH_BUFFER_DEVICE,
                                    realtime->tiles.rays * NEPH_MARCH_STATE_BYTES, "march states",
                                    &realtime->states, diag);
    if (!status)
        status = neph_rt_device_create(realtime->vulkan, &view, realtime->noise_ranks,
                                       &realtime->device, diag);
    realtime->device.specialises = true;
    if (!status && choice_of(realtime, RT_SPLIT) == RT_SPLIT_NONE)
        status = neph_march_create(realtime->vulkan, scene, &realtime->march, &realtime->whole,
                                   diag);
    return status;
}

static void destroy_sized(struct neph_realtime *realtime)
{
    neph_march_destroy(realtime->whole);
    realtime->whole = NULL;
    neph_rt_device_destroy(&realtime->device);
    neph_buffer_destroy(realtime->vulkan, &realtime->states);
}

/* Whether any dither reads the masks of blue noise, which take seconds to make for a new seed. */
static bool needs_masks(const struct neph_realtime *realtime)
{
    static const int dithers[] = {RT_RAY_DITHER, RT_UPSCALE_DITHER};
    bool needs = false;
    for (size_t i = 0; i < sizeof(dithers) / sizeof(dithers[0]); i++) {
        const int dither = choice_of(realtime, dithers[i]);
        needs |= dither >= RT_DITHER_BLUE;
    }
    return needs && choice_of(realtime, RT_SPLIT) == RT_SPLIT_FOUR;
}

static enum neph_status create_once(struct neph_realtime *realtime, const struct neph_scene *scene,
                                    const struct neph_realtime_params *params,
                                    struct neph_diag *diag)
{
    realtime->noise_ranks = calloc(NEPH_RT_NOISE_COUNT, sizeof(*realtime->noise_ranks));
    if (!realtime->noise_ranks)
        return neph_fail_memory(diag);
    enum neph_status status = NEPH_OK;
    if (needs_masks(realtime))
        status = neph_rt_noise_ranks(params->seed, params->cache_folder, realtime->noise_ranks,
                                     diag);
    if (!status)
        status = neph_gpu_scene_create(realtime->vulkan, scene, 0.0, params->width_px,
                                       params->height_px, false, &realtime->scene, diag);
    if (!status)
        status = neph_buffer_create(realtime->vulkan, NEPH_BUFFER_UPLOAD,
                                    sizeof(struct gpu_counters), "counters", &realtime->counters,
                                    diag);
    return status;
}

enum neph_status neph_realtime_create(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                      const struct neph_realtime_params *params,
                                      struct neph_realtime **realtime, struct neph_diag *diag)
{
    const struct neph_march_params march = march_params(params);
    char reason[256];
    enum neph_status status = neph_march_check(scene, &march, diag);
    if (status)
        return status;
    if (!neph_realtime_can_render(scene, params->settings, reason, sizeof(reason)))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "realtime: cannot: %s", reason);
    struct neph_realtime *made = calloc(1, sizeof(*made));
    if (!made)
        return neph_fail_memory(diag);
    made->vulkan = vulkan;
    made->settings = *params->settings;
    made->seed = params->seed;
    made->march = march;
    status = create_once(made, scene, params, diag);
    if (!status)
        status = create_sized(made, scene, diag);
    if (status)
        neph_realtime_destroy(made);
    else
        *realtime = made;
    return status;
}

void neph_realtime_destroy(struct neph_realtime *realtime)
{
    if (!realtime)
        return;
    destroy_sized(realtime);
    neph_buffer_destroy(realtime->vulkan, &realtime->counters);
    neph_gpu_scene_destroy(realtime->vulkan, &realtime->scene);
    free(realtime->noise_ranks);
    free(realtime);
}

enum neph_status neph_realtime_resize(struct neph_realtime *realtime,
                                      const struct neph_scene *scene, int width_px, int height_px,
                                      struct neph_diag *diag)
{
    struct neph_march_params march = realtime->march;
    march.width_px = width_px;
    march.height_px = height_px;
    const enum neph_status status = neph_march_check(scene, &march, diag);
    if (status)
        return status;
    destroy_sized(realtime);
    realtime->march = march;
    realtime->has_past = false;
    return create_sized(realtime, scene, diag);
}

void neph_realtime_observe(struct neph_realtime *realtime, neph_realtime_observer *observer,
                           void *context)
{
    realtime->observer = observer;
    realtime->observer_context = context;
}

/* --- the view of a frame ------------------------------------------------------------------- */

static void set_vector(float out[3], struct neph_vec3 vector)
{
    out[0] = (float)vector.x;
    out[1] = (float)vector.y;
    out[2] = (float)vector.z;
}

static struct neph_rt_camera camera_from(const struct neph_camera *camera,
                                         struct neph_vec3 origin_m, const uint32_t size_px[2])
{
    const double tan_half_height = tan(0.5 * camera->vertical_fov_rad);
    struct neph_rt_camera made = {
        .tan_half_width = (float)(tan_half_height * size_px[0] / size_px[1]),
        .tan_half_height = (float)tan_half_height,
    };
    set_vector(made.right, camera->right);
    set_vector(made.up, camera->up);
    set_vector(made.forward, camera->forward);
    set_vector(made.position_m, neph_vec3_sub(camera->position_m, origin_m));
    return made;
}

/* Every so many cycles of four frames one without override. */
static bool is_resting(const struct neph_realtime *realtime)
{
    const uint32_t period = (uint32_t)choice_of(realtime, RT_OVERRIDE_REST);
    return period > 0 && realtime->frame_count / 4 % period == period - 1;
}

static struct past present_of(const struct neph_realtime *realtime,
                              const struct neph_realtime_frame *frame)
{
    struct past now = {
        .camera = neph_scene_camera(frame->scene, frame->frame),
        .drift_m = neph_scene_wind_displacement_m(frame->scene, frame->frame),
        .frame = frame->frame,
    };
    double jitter_px[2] = {0.0, 0.0};
    if (choice_of(realtime, RT_TAA))
        neph_rt_jitter(choice_of(realtime, RT_TAA_JITTER),
                       choice_of(realtime, RT_TAA_JITTER_LENGTH), realtime->frame_count, jitter_px);
    if (!frame->given) { /* rays that are not ours do not move */
        now.jitter_px[0] = (float)jitter_px[0];
        now.jitter_px[1] = (float)jitter_px[1];
    }
    return now;
}

static void set_view(struct neph_realtime *realtime, const struct neph_scene *scene,
                     const struct past *now)
{
    struct neph_rt_view *view = realtime->device.view;
    const struct past *before = realtime->has_past ? &realtime->past : now;
    const bool is_cut = realtime->has_past && neph_scene_is_cut(scene, before->frame, now->frame);
    view->now = camera_from(&now->camera, now->camera.position_m, view->size_px);
    view->before = camera_from(&before->camera, now->camera.position_m, view->size_px);
    view->frame = realtime->frame_count;
    view->is_cut = is_cut;
    view->has_history = realtime->has_past && !(is_cut && choice_of(realtime, RT_CUT_RESET));
    view->resting = is_resting(realtime);
    memcpy(view->jitter_px, now->jitter_px, sizeof(view->jitter_px));
    memcpy(view->jitter_before_px, before->jitter_px, sizeof(view->jitter_before_px));
    set_vector(view->wind_m, neph_vec3_sub(now->drift_m, before->drift_m));
}

/* --- frames -------------------------------------------------------------------------------- */

static uint64_t targets_bytes(const struct neph_rt_view *view, uint32_t targets)
{
    uint64_t bytes = 0;
    for (int t = 0; t < RT_TARGET_COUNT; t++)
        if (targets & BIT(t))
            bytes += neph_rt_target_bytes(view, t);
    return bytes;
}

static enum neph_status run_one(struct neph_realtime *realtime, int pass,
                                struct neph_realtime_stats *stats, struct neph_diag *diag)
{
    const enum neph_status status = passes[pass].run(realtime, pass, &stats->pass_gpu_s[pass],
                                                     diag);
    if (status)
        return status;
    stats->gpu_s += stats->pass_gpu_s[pass];
    realtime->touched |= passes[pass].reads | passes[pass].writes;
    stats->traffic_bytes += targets_bytes(realtime->device.view, passes[pass].reads) +
                            targets_bytes(realtime->device.view, passes[pass].writes);
    if (realtime->observer)
        realtime->observer(&realtime->device, pass, realtime->observer_context);
    return NEPH_OK;
}

static uint64_t whole_number(const uint32_t halves[2])
{
    return halves[0] | (uint64_t)halves[1] << 32;
}

static void take_counters(const struct neph_realtime *realtime, struct neph_realtime_stats *stats)
{
    const struct gpu_counters *counters = realtime->counters.mapped;
    stats->rays = counters->rays;
    stats->view_steps = whole_number(counters->view_steps);
    stats->density_evaluations = whole_number(counters->density_evaluations);
    stats->closed_forms = whole_number(counters->closed_forms);
}

/* The split frame, pass by pass. */
static enum neph_status render_split(struct neph_realtime *realtime,
                                     const struct neph_realtime_frame *frame,
                                     const struct neph_scene *still, struct neph_image **image,
                                     struct neph_realtime_stats *stats, struct neph_diag *diag)
{
    memset(realtime->counters.mapped, 0, sizeof(struct gpu_counters));
    neph_gpu_scene_move(&realtime->scene, still, frame->frame, realtime->march.width_px,
                        realtime->march.height_px);
    realtime->scene.frame->steps = (uint32_t)realtime->march.steps;
    realtime->scene.frame->sun_steps = (uint32_t)neph_march_sun_steps(still, &realtime->march);
    enum neph_status status = NEPH_OK;
    if (frame->given)
        status = neph_rt_give_frame(&realtime->device, frame->given, diag);
    for (int pass = frame->given ? PASS_DEPTH_MAP : PASS_SCENE; pass < PASS_TAA && !status; pass++)
        status = run_one(realtime, pass, stats, diag);
    if (!status && choice_of(realtime, RT_TAA))
        status = run_one(realtime, PASS_TAA, stats, diag);
    if (!status)
        take_counters(realtime, stats);
    const int picture = choice_of(realtime, RT_TAA) ? RT_TAA_OUT : RT_COLOR;
    return status ? status : neph_rt_bring_frame(&realtime->device, picture, image, diag);
}

static enum neph_status anti_alias(struct neph_realtime *realtime, struct neph_image *image,
                                   struct neph_realtime_stats *stats, struct neph_diag *diag)
{
    float *rgb[3];
    neph_image_rgb(image, NULL, rgb);
    enum neph_status status = neph_rt_give(&realtime->device, RT_COLOR, rgb, diag);
    if (!status)
        status = neph_rt_give(&realtime->device, RT_DEPTH,
                              (float *[3]){neph_image_channel(image, "Z")}, diag);
    if (!status)
        status = run_one(realtime, PASS_TAA, stats, diag);
    return status ? status
                  : neph_rt_bring(&realtime->device, RT_TAA_OUT,
                                  (float *[4]){rgb[0], rgb[1], rgb[2]}, diag);
}

/* Every pixel, every frame: the march itself. */
static enum neph_status render_whole(struct neph_realtime *realtime,
                                     const struct neph_realtime_frame *frame,
                                     const struct neph_scene *still, struct neph_image **image,
                                     struct neph_realtime_stats *stats, struct neph_diag *diag)
{
    if (frame->given)
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "a given depth needs the split frame: set split=four");
    struct neph_image *made = NULL;
    struct neph_march_stats march;
    enum neph_status status = neph_march_frame(realtime->whole, still, frame->frame,
                                               realtime->device.view->jitter_px, &made, &march,
                                               diag);
    if (status)
        return status;
    stats->pass_gpu_s[PASS_MARCH] = stats->gpu_s = march.gpu_s;
    stats->density_evaluations = march.density_evaluations;
    stats->closed_forms = march.closed_forms;
    stats->view_steps = march.view_steps;
    stats->rays = thread_count(realtime->device.view, FULL);
    if (choice_of(realtime, RT_TAA))
        status = anti_alias(realtime, made, stats, diag);
    if (status)
        neph_image_destroy(made);
    else
        *image = made;
    return status;
}

enum { HANDED_ON = sizeof(handed_on) / sizeof(handed_on[0]) };

static void hand_on(struct neph_realtime *realtime)
{
    for (int i = 0; i < HANDED_ON; i++)
        neph_rt_device_swap(&realtime->device, handed_on[i][0], handed_on[i][1]);
}

static void count_bytes(const struct neph_realtime *realtime, struct neph_realtime_stats *stats)
{
    uint32_t past = 0;
    for (int i = 0; i < HANDED_ON; i++)
        past |= BIT(handed_on[i][1]);
    stats->target_bytes = targets_bytes(realtime->device.view, realtime->touched);
    stats->history_bytes = targets_bytes(realtime->device.view, realtime->touched & past);
}

enum neph_status neph_realtime_render(struct neph_realtime *realtime,
                                      const struct neph_realtime_frame *frame,
                                      struct neph_image **image, struct neph_realtime_stats *stats,
                                      struct neph_diag *diag)
{
    const double start_s = neph_wall_s();
    const struct past now = present_of(realtime, frame);
    struct neph_realtime_stats counted = {.gpu_s = 0.0};
    realtime->touched = 0;
    struct neph_scene *still = NULL;
    enum neph_status status = neph_scene_at(frame->scene, frame->frame, &still, diag);
    if (status)
        return status;
    set_view(realtime, frame->scene, &now);
    status = (realtime->whole ? render_whole : render_split)(realtime, frame, still, image,
                                                             &counted, diag);
    if (!status)
        status = neph_vulkan_check(realtime->vulkan, diag);
    neph_scene_destroy(still);
    if (status)
        return status;
    hand_on(realtime);
    realtime->past = now;
    realtime->has_past = true;
    realtime->frame_count++;
    count_bytes(realtime, &counted);
    counted.wall_s = neph_wall_s() - start_s;
    if (stats)
        *stats = counted;
    return NEPH_OK;
}
