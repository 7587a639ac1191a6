/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/pipeline.h"

#include "base/clock.h"
#include "renderer/blue_noise.h"
#include "renderer/march.h"
#include "renderer/march_scene.h"
#include "renderer/march_split.h"
#include "renderer/realtime/images.h"
#include "renderer/realtime/injection.h"
#include "renderer/realtime/lamp_changes.h"
#include "renderer/realtime/light_history.h"
#include "renderer/realtime/march_settings.h"
#include "renderer/realtime/moment.h"
#include "renderer/realtime/output_elision.h"
#include "renderer/realtime/scene_cache.h"
#include "renderer/realtime/stillness.h"
#include "renderer/realtime/watch.h"
#include "scenes/motion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_RT_RAYS_COUNT == 4, "a new kind");
_Static_assert(NEPH_MARCH_LIGHTING_COUNT == 8, "a new kind");
_Static_assert(NEPH_MARCH_MODE_COUNT == 2, "a new kind");
_Static_assert(NEPH_SOLID_KIND_COUNT == 3, "a new kind");

_Static_assert(NEPH_MARCH_BUFFERS + 2 + RT_RAY_TARGET_COUNT - NEPH_GPU_SCENE_UNIFORMS <=
                   NEPH_KERNEL_STORAGE_MAX,
               "room for all that a pass with rays is bound to");
_Static_assert(2 + RT_TARGET_COUNT <= NEPH_KERNEL_STORAGE_MAX, "and a pass without");
_Static_assert((int)NEPH_RT_NOISE_COUNT == (int)NEPH_BLUE_NOISE_COUNT, "all ranks");

struct neph_realtime {
    struct neph_vulkan *vulkan; /* borrowed */
    struct neph_settings values;
    struct neph_rt_settings settings; /* the same values, grouped by pass */
    uint32_t seed;
    uint32_t *noise_ranks; /* owned; NULL: no dither reads them */
    int picture_px[2];
    struct neph_march_params march; /* at rendered resolution */
    struct neph_march_scene scene;  /* of the split frame */
    struct neph_march *whole;       /* owned; split=none: the march of every pixel, else NULL */
    struct neph_march_split cuts[NEPH_RT_PASSES_MAX]; /* splits of passes with rays */
    struct neph_buffer states, counters;
    struct neph_rt_device device;
    uint32_t frame_count; /* frames rendered so far */
    bool has_past;
    struct neph_rt_transforms past;
    struct neph_rt_light_history lights;
    struct neph_rt_static_content stillness;
    struct neph_rt_scene_cache kept;
    bool has_mirrored_past; /* of the mirrored camera (inject.mirror) */
    struct neph_rt_transforms mirrored_past;
    uint64_t injected_values;  /* since the last frame */
    bool has_injected_rays;    /* in the last frame */
    bool has_injected_history; /* in any frame */
    struct neph_in_flight flight;
    struct neph_realtime_stats flights[NEPH_IN_FLIGHT_FRAMES]; /* of the frames in flight */
    struct neph_sun_fill_cost fills[NEPH_IN_FLIGHT_FRAMES];    /* sun tables of these frames */
    neph_realtime_observer *observer;
    void *observer_context;
    struct neph_realtime_test_hooks hooks;
};

/* Whether fewer pixels are rendered than the output has. */
static bool is_upsampled(const struct neph_realtime *realtime)
{
    return realtime->settings.shared.screen_percent < 100;
}

static enum neph_rt_device_kind find_device_kind(const struct neph_vulkan *vulkan)
{
    return vulkan->description.is_cpu ? NEPH_RT_CPU : NEPH_RT_GPU;
}

/* --- passes with rays ------------------------------------------------------------------------ */

/* The dispatches of one pass, split as the cost of its rays requires. */
struct ray_pass {
    const struct neph_rt_pass *pass;
    const struct neph_kernel *kernel;
    struct neph_dispatch dispatch;
    struct neph_rt_submission *submission;
    bool is_cut;
    double *gpu_s; /* borrowed; one of neph_realtime.flights */
};

/* Records one part of a split pass and submits it: a part is the most that the device may get in
 * one submission. */
static enum neph_status add_rays(const struct neph_gpu_march_run *run, void *context,
                                 struct neph_diag *diag)
{
    struct ray_pass *work = context;
    work->dispatch.push = run;
    work->dispatch.group_count = (run->ray_count + NEPH_MARCH_LOCAL_SIZE - 1) /
                                 NEPH_MARCH_LOCAL_SIZE;
    const enum neph_status status = neph_rt_submission_add(work->submission, work->pass,
                                                           work->kernel, &work->dispatch, diag);
    if (status || !work->is_cut)
        return status;
    neph_rt_submission_mark(work->submission, work->gpu_s);
    return neph_rt_submission_submit(work->submission, diag);
}

/* The largest counts that shaders are compiled for; on a GPU the loop over them is unrolled. */
enum { GPU_SOLIDS_MAX = 32 };

static uint32_t count_known_solids(const struct neph_gpu_scene *scene)
{
    const uint32_t count = scene->frame->solid_count;
    const uint32_t most = scene->is_on_cpu ? RT_SOLIDS_UNKNOWN - 1 : GPU_SOLIDS_MAX;
    const bool has_meshes = (scene->constants[0] & NEPH_GPU_MESHES) != 0;
    return count <= most && !has_meshes ? count : RT_SOLIDS_UNKNOWN;
}

/* Bit masks of the solids that are spheres. */
static void set_known_balls(const struct neph_gpu_scene *scene, uint32_t balls[2])
{
    const struct neph_gpu_solids *all = scene->buffers[1].mapped;
    for (uint32_t s = 0; s < scene->frame->solid_count && s < RT_SOLIDS_UNKNOWN - 1; s++)
        balls[s / 32] |= (all->solids[s].kind == NEPH_SOLID_SPHERE ? 1u : 0u) << s % 32;
}

/* Froxels have their own copy of the scene: there a fog that is handed over to them is a medium. */
static bool is_froxel_pass(const struct neph_rt_pass *pass)
{
    return pass->resolution == RT_FROXEL;
}

static const struct neph_gpu_scene *scene_for_pass(const struct neph_realtime *realtime,
                                                   const struct neph_rt_pass *pass)
{
    const struct neph_march_scene *scene = &realtime->scene;
    return is_froxel_pass(pass) ? neph_froxel_scene_select(&scene->froxels, &scene->gpu)
                                : &scene->gpu;
}

static struct neph_march_params make_march_params(const struct neph_realtime *realtime,
                                                  const struct neph_rt_pass *pass)
{
    struct neph_march_params march = realtime->march;
    if (is_froxel_pass(pass) && march.fog.is_handed_over)
        march.fog.is_look = false;
    if (pass->rays != NEPH_RT_RAYS_THROUGH_MEDIA)
        march.steps = 1;
    return march;
}

static enum neph_status bind_ray_pass(struct neph_realtime *realtime,
                                      const struct neph_rt_pass *pass, bool counts,
                                      struct neph_dispatch *dispatch,
                                      const struct neph_kernel **kernel, struct neph_diag *diag)
{
    struct neph_kernel_params params = {
        .uniform_count = NEPH_GPU_SCENE_UNIFORMS,
        .image_count = NEPH_GPU_MEDIA_MAX,
        .texels_first = NEPH_GPU_VALUES_BUFFER,
        .texels_count = {[1] = 1}, /* pairs */
        .push_size_bytes = sizeof(struct neph_gpu_march_run),
    };
    if (is_froxel_pass(pass))
        neph_march_scene_bind_froxels(&realtime->scene, dispatch);
    else
        neph_march_scene_bind(&realtime->scene, dispatch);
    dispatch->buffers[NEPH_GPU_SCENE_BUFFERS] = &realtime->states;
    dispatch->buffers[NEPH_GPU_SCENE_BUFFERS + 1] = &realtime->counters;
    neph_rt_device_bind(&realtime->device, pass, NEPH_MARCH_BUFFERS, &params, dispatch);
    const struct neph_march_params march = make_march_params(realtime, pass);
    neph_march_constants(scene_for_pass(realtime, pass), &march, params.constants);
    params.constants[RT_UNCOUNTED_CONSTANT] = !counts;
    params.constants[RT_SOLIDS_CONSTANT] = count_known_solids(&realtime->scene.gpu);
    set_known_balls(&realtime->scene.gpu, &params.constants[RT_BALLS_CONSTANT]);
    return neph_kernel_get(realtime->vulkan, &params, kernel, diag);
}

static enum neph_status add_ray_pass(struct neph_realtime *realtime,
                                     const struct neph_rt_pass *pass, bool counts,
                                     struct neph_rt_submission *submission, double *gpu_s,
                                     struct neph_diag *diag)
{
    const struct neph_march_split *cut = &realtime->cuts[neph_rt_pass_index(pass->name)];
    struct ray_pass work = {
        .pass = pass,
        .submission = submission,
        .is_cut = !neph_march_split_is_whole(cut),
        .gpu_s = gpu_s,
    };
    const enum neph_status status = bind_ray_pass(realtime, pass, counts, &work.dispatch,
                                                  &work.kernel, diag);
    return status ? status : neph_march_split_run(cut, add_rays, &work, diag);
}

/* --- making -------------------------------------------------------------------------------- */

/* Sets the size of the output, and the rendered size from it. */
static void set_size(struct neph_realtime *realtime, int width_px, int height_px)
{
    const int percent = realtime->settings.shared.screen_percent;
    struct neph_march_params *march = &realtime->march;
    march->width_px = neph_rt_rendered_px(width_px, percent);
    march->height_px = neph_rt_rendered_px(height_px, percent);
    realtime->picture_px[0] = width_px;
    realtime->picture_px[1] = height_px;
    if (is_upsampled(realtime))
        memcpy(march->picture_px, realtime->picture_px, sizeof(march->picture_px));
}

/* Computes the splits of all passes with rays, and creates buffers for the state of the rays. */
static enum neph_status create_rays(struct neph_realtime *realtime, const struct neph_scene *scene,
                                    const struct neph_gpu_view *view, struct neph_diag *diag)
{
    const enum neph_rt_device_kind kind = find_device_kind(realtime->vulkan);
    uint64_t most_rays = 1;
    enum neph_status status = NEPH_OK;
    for (int i = 0; neph_rt_passes[i] && !status; i++) {
        const struct neph_rt_pass *pass = neph_rt_passes[i];
        const struct neph_march_params march = make_march_params(realtime, pass);
        if (!pass->rays || !neph_rt_is_condition_met(view, pass->condition))
            continue;
        const struct neph_rt_shader *shader = neph_rt_shader_for(view, pass, kind);
        status = neph_march_split_make(realtime->vulkan, scene, scene_for_pass(realtime, pass),
                                       &march, neph_rt_thread_count(view, pass, shader),
                                       &realtime->cuts[i], diag);
        if (pass->rays == NEPH_RT_RAYS_THROUGH_MEDIA && realtime->cuts[i].rays_max > most_rays)
            most_rays = realtime->cuts[i].rays_max;
    }
    return status ? status
                  : neph_buffer_create(realtime->vulkan, NEPH_BUFFER_DEVICE,
                                       most_rays * NEPH_MARCH_STATE_BYTES, "march states",
                                       &realtime->states, diag);
}

static bool has_taa(const struct neph_realtime *realtime)
{
    return realtime->settings.anti_aliasing.kind != 0 &&
           realtime->settings.shared.split != RT_SPLIT_NONE;
}

/* Whether solids may move and the anti-aliasing uses their motion. */
static bool follows_solids(const struct neph_realtime *realtime, const struct neph_scene *scene)
{
    return realtime->settings.solid_motion.is_on && scene->mover_count > 0 && has_taa(realtime);
}

/* The pass that composes the volume with the background. */
static int find_composition_pass(const struct neph_realtime *realtime,
                                 const struct neph_gpu_view *view)
{
    const struct neph_rt_tuning *tuning = neph_rt_get_tuning(find_device_kind(realtime->vulkan));
    const bool has_froxels = view->settings[RT_FROXEL_VOLUME] != 0.0f;
    const bool has_plain_taa = has_taa(realtime) && view->settings[RT_TAA] == (float)RT_TAA_ON;
    if (tuning->composition == RT_COMPOSITION_TAA)
        return has_plain_taa ? RT_COMPOSITION_TAA : RT_COMPOSITION_PASS;
    return has_froxels ? RT_COMPOSITION_PASS : RT_COMPOSITION_UPSCALE;
}

/* Sets the far end of the froxels where they carry the scene's fog. */
static void set_hand_over(const struct neph_realtime *realtime, const struct neph_scene *scene,
                          struct neph_gpu_view *view)
{
    if (realtime->march.fog.is_handed_over)
        view->settings[RT_FROXEL_END_M] = (float)scene->fog_look.volumetric_fog_distance_m;
}

/* Settings that the pipeline selects by scene and device. */
static void choose_settings(const struct neph_realtime *realtime, const struct neph_scene *scene,
                            struct neph_gpu_view *view)
{
    view->settings[RT_SOLID_MOTION] = follows_solids(realtime, scene);
    view->settings[RT_ORACLE] = neph_rt_has_oracle(&realtime->settings);
    view->settings[RT_COMPOSITION] = (float)find_composition_pass(realtime, view);
    neph_rt_absorb_passes(view, find_device_kind(realtime->vulkan), true);
}

/* Compiles all kernels in advance on devices where this is fast. */
static enum neph_status prepare_passes(struct neph_realtime *realtime, struct neph_diag *diag)
{
    const struct neph_gpu_view *view = realtime->device.view;
    enum neph_status status = NEPH_OK;
    if (!neph_rt_get_tuning(realtime->device.kind)->prepares_kernels)
        return NEPH_OK;
    for (int p = 0; neph_rt_passes[p] && !status; p++) {
        const struct neph_rt_pass *pass = neph_rt_passes[p];
        if (!pass->rays && neph_rt_is_condition_met(view, pass->condition) &&
            !neph_rt_is_pass_skipped(view, pass))
            status = neph_rt_device_prepare(&realtime->device, pass, diag);
    }
    return status;
}

/* Whether rays compute only a transmittance in closed form, by the same rule as march.comp: no
 * medium sends light, so there is no noise either. Needs a gradient; without one nothing
 * changes. */
static bool is_dark(const struct neph_realtime *realtime)
{
    const struct neph_gpu_view *view = realtime->device.view;
    const struct neph_march_params *march = &realtime->march;
    const struct neph_gpu_scene *gpu = &realtime->scene.gpu;
    const bool is_solved = march->transmittance == NEPH_MARCH_EXACT &&
                           !(gpu->constants[0] & 1u << NEPH_MEDIUM_HORIZON);
    const bool has_more = march->sky.is_on || march->fog.is_look ||
                          march->lighting == NEPH_MARCH_TRACED;
    return is_solved && !has_more && !gpu->frame->scatters && !gpu->frame->scatters_lamps &&
           !gpu->frame->emits && view->settings[RT_GRADIENT] != 0.0f &&
           view->settings[RT_JITTERED_DEPTH] == 0.0f && view->settings[RT_FROXEL_VOLUME] == 0.0f;
}

/* Creates all objects that depend on the size. */
static enum neph_status create_sized(struct neph_realtime *realtime, const struct neph_scene *scene,
                                     struct neph_diag *diag)
{
    struct neph_gpu_view view;
    const struct neph_injected_view *around = &neph_scene_injections(scene)->view;
    const int *size_px = realtime->picture_px;
    const int origin_px[2] = {around->left_px, around->top_px};
    const int buffer_px[2] = {around->left_px + size_px[0] + around->right_px,
                              around->top_px + size_px[1] + around->bottom_px};
    neph_rt_view_init(&view, &realtime->values, size_px, origin_px, buffer_px);
    view.seed = realtime->seed;
    choose_settings(realtime, scene, &view);
    set_hand_over(realtime, scene, &view);
    if (scene->light_count == 0)
        view.settings[RT_LAMP_PEAKS] = 0.0f;
    enum neph_status status = create_rays(realtime, scene, &view, diag);
    if (!status)
        status = neph_rt_device_create(realtime->vulkan, &view, neph_rt_targets_used(&view),
                                       realtime->noise_ranks, &realtime->device, diag);
    realtime->device.specialises = true;
    realtime->device.is_dark = !status && is_dark(realtime);
    if (!status)
        status = prepare_passes(realtime, diag);
    if (!status && (buffer_px[0] > size_px[0] || buffer_px[1] > size_px[1]))
        status = neph_rt_inject_outside_view(&realtime->device, around->value,
                                             &realtime->injected_values, diag);
    if (!status && realtime->settings.shared.split == RT_SPLIT_NONE)
        status = neph_march_create(realtime->vulkan, scene, &realtime->march, &realtime->whole,
                                   diag);
    return status;
}

static void destroy_sized(struct neph_realtime *realtime)
{
    neph_march_destroy(realtime->whole);
    realtime->whole = NULL;
    neph_rt_scene_cache_destroy(realtime->vulkan, &realtime->kept);
    neph_rt_device_destroy(&realtime->device);
    neph_buffer_destroy(realtime->vulkan, &realtime->states);
}

/* Whether a dither reads the masks of blue noise. */
static bool needs_masks(const struct neph_realtime *realtime)
{
    const struct neph_rt_settings *settings = &realtime->settings;
    const bool needs = settings->ray_march.ray_dither >= RT_DITHER_BLUE ||
                       settings->upscale.dither >= RT_DITHER_BLUE;
    return needs && settings->shared.split == RT_SPLIT_FOUR;
}

static enum neph_status load_noise(struct neph_realtime *realtime, const char *path,
                                   struct neph_diag *diag)
{
    if (!needs_masks(realtime))
        return NEPH_OK;
    realtime->noise_ranks = calloc(NEPH_RT_NOISE_COUNT, sizeof(*realtime->noise_ranks));
    return realtime->noise_ranks
               ? neph_blue_noise_load(path, realtime->seed, realtime->noise_ranks, diag)
               : neph_fail_memory(diag);
}

static enum neph_status create_once(struct neph_realtime *realtime, const struct neph_scene *scene,
                                    const struct neph_realtime_params *params,
                                    struct neph_diag *diag)
{
    enum neph_status status = load_noise(realtime, params->blue_noise_path, diag);
    if (!status)
        status = neph_march_scene_create(realtime->vulkan, scene, &realtime->march,
                                         &realtime->scene, diag);
    if (!status)
        status = neph_buffer_create(realtime->vulkan, NEPH_BUFFER_UPLOAD,
                                    sizeof(struct neph_gpu_counters), "counters",
                                    &realtime->counters, diag);
    return status;
}

enum neph_status neph_realtime_create(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                      const struct neph_realtime_params *params,
                                      struct neph_realtime **realtime, struct neph_diag *diag)
{
    const struct neph_march_params march = neph_rt_march_params(
        scene, params->settings, params->width_px, params->height_px, params->seed);
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
    made->values = *params->settings;
    made->settings = neph_rt_group_settings(params->settings);
    made->seed = params->seed;
    made->march = march;
    set_size(made, params->width_px, params->height_px);
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
    neph_rt_static_content_destroy(&realtime->stillness);
    neph_buffer_destroy(realtime->vulkan, &realtime->counters);
    neph_march_scene_destroy(realtime->vulkan, &realtime->scene);
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
    set_size(realtime, width_px, height_px);
    realtime->has_past = realtime->has_mirrored_past = false;
    return create_sized(realtime, scene, diag);
}

void neph_realtime_observe(struct neph_realtime *realtime, neph_realtime_observer *observer,
                           void *context)
{
    realtime->observer = observer;
    realtime->observer_context = context;
}

void neph_realtime_use_readable_shaders(struct neph_realtime *realtime, bool is_readable)
{
    realtime->device.has_no_variants = is_readable;
    neph_rt_absorb_passes(realtime->device.view, realtime->device.kind, !is_readable);
}

void neph_realtime_set_test_hooks(struct neph_realtime *realtime,
                                  struct neph_realtime_test_hooks hooks)
{
    realtime->hooks = hooks;
}

/* --- the passes of a frame ------------------------------------------------------------------ */

/* The state of a frame while its passes are recorded. Targets are NEPH_RT_BIT() of each. */
struct progress {
    uint32_t given;                        /* targets that no pass has to write */
    uint32_t touched;                      /* targets that passes have read or written so far */
    uint32_t past;                         /* histories for the next frame, under its names */
    int picture;                           /* the target that shows the frame */
    bool counts;                           /* whether passes with rays count their work */
    const struct neph_injected_rays *rays; /* to inject, or NULL */
    struct neph_sun_fill_cost *fill;       /* borrowed, like stats: the split frame's sun tables */
    struct neph_march_frame_state moment;
    struct neph_realtime_stats *stats; /* borrowed; one of neph_realtime.flights */
};

static uint64_t targets_bytes(const struct neph_gpu_view *view, uint32_t targets)
{
    uint64_t bytes = 0;
    for (int t = 0; t < RT_TARGET_COUNT; t++)
        if (targets & NEPH_RT_BIT(t))
            bytes += neph_rt_target_bytes(view, t);
    return bytes;
}

/* Waits for the pass, so that an observer sees its results. The observer may change the view. */
static enum neph_status observe(struct neph_realtime *realtime, const struct neph_rt_pass *pass,
                                struct neph_rt_submission *submission, struct neph_diag *diag)
{
    const enum neph_status status = neph_rt_submission_wait(submission, diag);
    if (!status)
        realtime->observer(&realtime->device, pass, realtime->observer_context);
    neph_rt_device_upload_view(&realtime->device);
    return status;
}

/* After the march, before another pass reads its rays. */
static enum neph_status inject_rays(struct neph_realtime *realtime, const struct neph_rt_pass *pass,
                                    const struct neph_injected_rays *rays,
                                    struct neph_rt_submission *submission, struct neph_diag *diag)
{
    if (!rays || !(pass->writes & NEPH_RT_BIT(RT_RAY)))
        return NEPH_OK;
    const enum neph_status status = neph_rt_submission_wait(submission, diag);
    return status ? status
                  : neph_rt_inject_rays(&realtime->device, rays, &realtime->injected_values, diag);
}

static enum neph_status add_pass(struct neph_realtime *realtime, const struct neph_rt_pass *pass,
                                 struct neph_rt_submission *submission, struct progress *made,
                                 struct neph_diag *diag)
{
    double *gpu_s = &made->stats->pass_gpu_s[neph_rt_pass_index(pass->name)];
    const uint32_t touched = neph_rt_targets_touched(realtime->device.view, pass);
    enum neph_status status =
        pass->rays ? add_ray_pass(realtime, pass, made->counts, submission, gpu_s, diag)
                   : neph_rt_device_add(&realtime->device, pass, submission, diag);
    if (status)
        return status;
    neph_rt_submission_mark(submission, gpu_s);
    status = inject_rays(realtime, pass, made->rays, submission, diag);
    if (status)
        return status;
    made->stats->pass_traffic_bytes[neph_rt_pass_index(pass->name)] = targets_bytes(
        realtime->device.view, touched);
    made->stats->traffic_bytes += made->stats->pass_traffic_bytes[neph_rt_pass_index(pass->name)];
    made->touched |= touched;
    made->past |= neph_rt_targets_before(pass);
    made->picture = pass->picture ? pass->picture : made->picture;
    return realtime->observer ? observe(realtime, pass, submission, diag) : NEPH_OK;
}

/* Whether the settings enable a pass and it writes a target that is not given. */
static bool is_wanted(const struct neph_realtime *realtime, const struct neph_rt_pass *pass,
                      const struct progress *made)
{
    return neph_rt_is_condition_met(realtime->device.view, pass->condition) &&
           (pass->writes & ~made->given);
}

/* Starts to compile all kernels of the first frame in parallel. */
static enum neph_status begin_passes(struct neph_realtime *realtime, const struct progress *made,
                                     struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int p = 0; neph_rt_passes[p] && !status; p++) {
        const struct neph_rt_pass *pass = neph_rt_passes[p];
        struct neph_dispatch dispatch = {.group_count = 0};
        const struct neph_kernel *kernel;
        if (!is_wanted(realtime, pass, made) ||
            neph_rt_is_pass_skipped(realtime->device.view, pass))
            continue;
        status = pass->rays ? bind_ray_pass(realtime, pass, made->counts, &dispatch, &kernel, diag)
                            : neph_rt_device_start_kernel(&realtime->device, pass, diag);
    }
    return status;
}

static enum neph_status run_passes(struct neph_realtime *realtime, struct progress *made,
                                   struct neph_diag *diag)
{
    const enum neph_status begun = realtime->frame_count == 0 ? begin_passes(realtime, made, diag)
                                                              : NEPH_OK;
    if (begun)
        return begun;
    struct neph_rt_submission submission = {.vulkan = realtime->vulkan};
    enum neph_status status = NEPH_OK;
    for (int p = 0; neph_rt_passes[p] && !status; p++) {
        const struct neph_rt_pass *pass = neph_rt_passes[p];
        if (neph_rt_is_pass_skipped(realtime->device.view, pass))
            made->past |= neph_rt_targets_before(pass);
        else if (is_wanted(realtime, pass, made))
            status = add_pass(realtime, pass, &submission, made, diag);
    }
    return status ? status : neph_rt_submission_submit(&submission, diag);
}

static void swap_histories(struct neph_realtime *realtime)
{
    for (int p = 0; neph_rt_passes[p]; p++) {
        const struct neph_rt_pass *pass = neph_rt_passes[p];
        if (neph_rt_is_condition_met(realtime->device.view, pass->condition))
            neph_rt_device_swap_histories(&realtime->device, pass);
    }
}

static uint64_t whole_number(const uint32_t halves[2])
{
    return halves[0] | (uint64_t)halves[1] << 32;
}

static void read_counters(const struct neph_realtime *realtime, struct neph_realtime_stats *stats)
{
    const struct neph_gpu_counters *counters = realtime->counters.mapped;
    stats->rays = counters->rays;
    stats->view_steps = whole_number(counters->view_steps);
    stats->density_evaluations = whole_number(counters->density_evaluations);
    stats->closed_forms = whole_number(counters->closed_forms);
}

/* The split frame: one ray for each tile, or as the settings define it. */
static enum neph_status render_split(struct neph_realtime *realtime,
                                     const struct neph_realtime_frame *frame,
                                     const struct neph_scene *static_scene,
                                     struct neph_image **image, struct progress *made,
                                     struct neph_diag *diag)
{
    struct neph_march_scene_cost cost = {made->fill, &made->stats->places_gpu_s,
                                         &made->stats->light_gpu_s, &made->stats->sky};
    made->counts = image;
    if (made->counts)
        memset(realtime->counters.mapped, 0, sizeof(struct neph_gpu_counters));
    enum neph_status status = neph_march_scene_update(static_scene, &realtime->march, frame->frame,
                                                      &made->moment, &realtime->scene, &cost, diag);
    realtime->device.is_dark = is_dark(realtime);
    if (!status && frame->given && is_upsampled(realtime))
        status = neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                           "a given depth has output resolution: set screen_percent=100");
    if (!status && frame->given)
        status = neph_rt_upload_frame(&realtime->device, frame->given, &made->given, diag);
    if (!status)
        status = run_passes(realtime, made, diag);
    if (status || !image)
        return status;
    status = neph_rt_download_frame(&realtime->device, made->picture, image, diag);
    read_counters(realtime, made->stats);
    return status;
}

/* Runs the passes after the march of every pixel. `image`: the marched frame in, the finished frame
 * out. */
static enum neph_status finish(struct neph_realtime *realtime, struct neph_image **image,
                               struct progress *made, struct neph_diag *diag)
{
    float *rgb[3];
    neph_image_rgb(*image, NULL, rgb);
    float *const depth_m[3] = {neph_image_channel(*image, "Z")};
    made->given = NEPH_RT_BIT(RT_COLOR) | NEPH_RT_BIT(RT_DEPTH);
    enum neph_status status = neph_rt_upload_image(&realtime->device, RT_COLOR, rgb, diag);
    if (!status)
        status = neph_rt_upload_image(&realtime->device, RT_DEPTH, depth_m, diag);
    if (!status)
        status = run_passes(realtime, made, diag);
    if (!status && is_upsampled(realtime))
        status = neph_rt_resample_image(&realtime->device, image, diag);
    neph_image_rgb(*image, NULL, rgb);
    if (!status && made->picture)
        status = neph_rt_download_image(&realtime->device, made->picture,
                                        (float *[4]){rgb[0], rgb[1], rgb[2]}, diag);
    return status;
}

/* The passes after the march read an image on the CPU, which a frame in flight lacks. */
static enum neph_status submit_frame(struct neph_realtime *realtime,
                                     const struct neph_realtime_frame *frame,
                                     const struct neph_scene *static_scene,
                                     const struct neph_march_frame_state *moment,
                                     struct neph_diag *diag)
{
    const struct neph_gpu_view *view = realtime->device.view;
    for (int p = 0; neph_rt_passes[p]; p++) {
        const struct neph_rt_pass *pass = neph_rt_passes[p];
        if (neph_rt_is_condition_met(view, pass->condition))
            return neph_fail(
                diag, NEPH_ERR_UNSUPPORTED,
                "split=none copies its frame to the CPU and back for the pass '%s', so its frames "
                "cannot be in flight: switch the pass off, or set split=four",
                pass->name);
    }
    return neph_march_frame(realtime->whole, static_scene, frame->frame, moment, NULL, NULL, diag);
}

/* Marches every pixel in every frame. */
static enum neph_status render_whole(struct neph_realtime *realtime,
                                     const struct neph_realtime_frame *frame,
                                     const struct neph_scene *static_scene,
                                     struct neph_image **image, struct progress *made,
                                     struct neph_diag *diag)
{
    if (frame->given)
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "a given depth needs the split frame: set split=four");
    if (!image)
        return submit_frame(realtime, frame, static_scene, &made->moment, diag);
    struct neph_image *marched = NULL;
    struct neph_march_stats march;
    enum neph_status status = neph_march_frame(realtime->whole, static_scene, frame->frame,
                                               &made->moment, &marched, &march, diag);
    if (status)
        return status;
    struct neph_realtime_stats *stats = made->stats;
    stats->pass_gpu_s[neph_rt_pass_index("march")] = march.gpu_s;
    stats->density_evaluations = march.density_evaluations;
    stats->closed_forms = march.closed_forms;
    stats->view_steps = march.view_steps;
    stats->rays = neph_rt_texel_count(realtime->device.view, RT_FULL);
    status = finish(realtime, &marched, made, diag);
    if (status)
        neph_image_destroy(marched);
    else
        *image = marched;
    return status;
}

/* Makes a finished frame the past of the next one. */
static void finish_frame(struct neph_realtime *realtime, const struct neph_rt_transforms *now,
                         struct progress *made)
{
    const struct neph_gpu_view *view = realtime->device.view;
    swap_histories(realtime);
    realtime->past = *now;
    realtime->has_past = true;
    realtime->frame_count++;
    made->stats->target_bytes = targets_bytes(view, made->touched);
    made->stats->history_bytes = targets_bytes(view, made->touched & made->past);
    neph_in_flight_end(realtime->vulkan, &realtime->flight);
}

/* Adds up the device times of a finished frame, and adapts the splits of the next frame to them. */
static void add_device_times(struct neph_realtime *realtime, struct neph_realtime_stats *stats)
{
    stats->gpu_s = stats->places_gpu_s + stats->light_gpu_s + neph_sky_gpu_s(&stats->sky);
    for (int i = 0; neph_rt_passes[i]; i++) {
        stats->gpu_s += stats->pass_gpu_s[i];
        if (realtime->cuts[i].ray_count > 0)
            neph_march_split_adapt(&realtime->cuts[i], stats->pass_gpu_s[i]);
    }
}

/* Filling a sun cache counts as time of the march, but not for the split of its dispatches. */
static void add_fill(struct neph_realtime_stats *stats, const struct neph_sun_fill_cost *fill)
{
    uint64_t evaluations, closed_forms;
    neph_sun_fill_counts(fill, &evaluations, &closed_forms);
    stats->gpu_s += neph_sun_fill_gpu_s(fill);
    stats->pass_gpu_s[neph_rt_pass_index("march")] += fill->gpu_s[NEPH_SUN_CACHE];
    stats->shadow_gpu_s = fill->gpu_s[NEPH_SUN_MAP];
    stats->density_evaluations += evaluations;
    stats->closed_forms += closed_forms;
}

/* The transforms of a frame in the form that the marcher needs. */
static struct neph_march_frame_state make_march_transforms(const struct neph_gpu_view *view,
                                                           const struct neph_rt_transforms *now)
{
    return (struct neph_march_frame_state){
        .jitter_px = {view->jitter_px[0], view->jitter_px[1]},
        .continues = view->has_history,
        .drift_m = now->drift_m,
    };
}

/* The static scene of a frame at the world's present origin, with its own or the mirrored
 * camera. */
static enum neph_status make_static_scene(const struct neph_realtime_frame *frame, bool is_mirrored,
                                          struct neph_scene **static_scene, struct neph_diag *diag)
{
    const struct neph_injections *injections = neph_scene_injections(frame->scene);
    const enum neph_status status = neph_scene_at(frame->scene, frame->frame, static_scene, diag);
    if (status)
        return status;
    struct neph_camera_key *key = (*static_scene)->camera_keys;
    if (is_mirrored) {
        key->position_m.y = 2.0 * injections->mirror.height_m - key->position_m.y;
        key->look_at_m.y = 2.0 * injections->mirror.height_m - key->look_at_m.y;
    }
    if (injections->origin_count > 0)
        neph_scene_shift(*static_scene, neph_injected_origin_at(injections, frame->frame));
    return NEPH_OK;
}

/* Injects values into the history of a frame. Sets `*past` to NULL where the frame shall have no
 * past. */
static enum neph_status inject_history(struct neph_realtime *realtime,
                                       const struct neph_realtime_frame *frame,
                                       const struct neph_rt_transforms **past,
                                       struct neph_diag *diag)
{
    const struct neph_injected_history *history = neph_injected_history_at(
        neph_scene_injections(frame->scene), frame->frame);
    if (!history)
        return NEPH_OK;
    realtime->has_injected_history = true;
    if (history->first)
        *past = NULL;
    const enum neph_status status = neph_batches_wait(
        realtime->vulkan, neph_batches_submitted(realtime->vulkan), "frames in flight", diag);
    return status ? status
                  : neph_rt_inject_history(&realtime->device, history->value,
                                           &realtime->injected_values, diag);
}

static struct neph_rt_transforms compute_transforms(const struct neph_realtime *realtime,
                                                    const struct neph_realtime_frame *frame,
                                                    const struct neph_scene *static_scene)
{
    struct neph_rt_transforms now = neph_rt_compute_transforms(
        realtime->device.view, frame->scene, frame->frame, realtime->frame_count, !frame->given);
    now.camera = neph_scene_camera(static_scene, frame->frame);
    return now;
}

/* Where no solid has moved since the frame before, all motion vectors would be 0. */
static void set_solid_motion(struct neph_realtime *realtime, const struct neph_scene *scene)
{
    struct neph_gpu_view *view = realtime->device.view;
    view->settings[RT_SOLID_MOTION] = !neph_rt_are_movers_static(view) &&
                                      follows_solids(realtime, scene);
}

/* Flags from the light history that rays cannot find: whether the two samples of a gradient see the
 * same phase of a flashing light (samples of the medium are 4 frames apart, samples behind it as
 * many as the jitter has places), or no froxels, in which the light has changed; and whether texels
 * that the override leaves out have old light. */
static void set_light_flags(struct neph_realtime *realtime, const struct neph_scene *static_scene,
                            const struct neph_rt_transforms *now)
{
    struct neph_gpu_view *view = realtime->device.view;
    const uint32_t number = realtime->frame_count;
    const bool is_tested = view->settings[RT_CHANGE_STROBE] != 0.0f;
    const uint32_t places = (uint32_t)view->settings[RT_TAA_JITTER_LENGTH];
    const uint32_t awake = (uint32_t)view->settings[RT_OVERRIDE_WAKE];
    neph_rt_light_history_add(&realtime->lights, number, static_scene);
    neph_rt_view_set_lamp_changes(view, &realtime->lights,
                                  neph_vec3_sub(now->origin_m, realtime->past.origin_m),
                                  now->camera.position_m);
    view->strobes_medium = is_tested && neph_rt_light_history_is_periodic(&realtime->lights, 4);
    view->strobes_behind = is_tested &&
                           neph_rt_light_history_is_periodic(&realtime->lights, places);
    view->resting |= number / 4 % 2 == 1 &&
                     neph_rt_light_history_has_jump(&realtime->lights, awake);
    if (view->settings[RT_FROXEL_VOLUME] == 0.0f ||
        (view->lamps_changed == 0 && view->sun_jumped == 0))
        return;
    view->strobes_medium = 1;
    view->strobes_behind = 1;
}

/* Whether rays see only the content that neph_rt_static_content_update() compares: no light that is
 * accumulated over frames, no table that is filled over several frames, no injection, no given
 * frame and no observer. */
static bool has_only_scene_content(const struct neph_realtime *realtime,
                                   const struct neph_realtime_frame *frame)
{
    const struct neph_injections *in = neph_scene_injections(frame->scene);
    const enum neph_march_lighting lighting = realtime->march.lighting;
    const struct neph_shortcuts *shortcuts = &realtime->march.shortcuts;
    const int injected = in->history_count + in->ray_count + in->size_count + in->origin_count +
                         in->exposure_count;
    return lighting != NEPH_MARCH_TRACED && lighting != NEPH_MARCH_DIFFUSED &&
           shortcuts->sun_cache_frames <= 1 && shortcuts->shadow.frames <= 1 && !frame->given &&
           !realtime->observer && injected == 0;
}

/* Decides whether the gradient is known to be 0 (RT_STEADY), and which targets the cache
 * provides. */
static enum neph_status update_static_state(struct neph_realtime *realtime,
                                            const struct neph_realtime_frame *frame,
                                            bool is_mirrored, bool is_read,
                                            const struct neph_scene *static_scene, uint32_t *given,
                                            struct neph_diag *diag)
{
    const bool elides = neph_rt_get_tuning(realtime->device.kind)->elides_outputs;
    struct neph_gpu_view *view = realtime->device.view;
    const bool has_only_scene = !is_mirrored && has_only_scene_content(realtime, frame);
    const bool is_next = view->has_history && !view->is_cut && neph_rt_is_view_static(view) &&
                         has_only_scene;
    view->settings[RT_STEADY] = RT_STEADY_ASKED;
    if (view->settings[RT_GRADIENT] == 0.0f || view->settings[RT_ORACLE] != 0.0f ||
        realtime->hooks.always_asks_gradient)
        return NEPH_OK;
    enum neph_status status = neph_rt_static_content_update(&realtime->stillness, static_scene,
                                                            is_next, diag);
    if (!status)
        status = neph_rt_scene_cache_bind(&realtime->kept, &realtime->device, realtime->frame_count,
                                          realtime->stillness.pictures, has_only_scene, given,
                                          diag);
    if (!status && neph_rt_is_gradient_known_zero(&realtime->stillness, view))
        view->settings[RT_STEADY] = !is_read && elides && neph_rt_can_elide_output(view)
                                        ? RT_STEADY_UNREAD
                                        : RT_STEADY_KNOWN;
    if (!status)
        status = neph_rt_scene_cache_bind_composed(&realtime->kept, &realtime->device,
                                                   realtime->frame_count,
                                                   realtime->stillness.pictures, given, diag);
    return status;
}

static enum neph_status render_size(struct neph_realtime *realtime,
                                    const struct neph_realtime_frame *frame, bool is_mirrored,
                                    struct neph_image **image, struct neph_realtime_stats *stats,
                                    struct neph_diag *diag)
{
    const double start_s = neph_wall_s();
    struct neph_gpu_view *view = realtime->device.view;
    const struct neph_rt_transforms *past = realtime->has_past ? &realtime->past : NULL;
    struct progress made = {.given = 0};
    struct neph_scene *static_scene = NULL;
    int slot;
    enum neph_status status = neph_in_flight_begin(realtime->vulkan, &realtime->flight, &slot,
                                                   diag);
    if (!status)
        status = inject_history(realtime, frame, &past, diag);
    if (!status)
        status = make_static_scene(frame, is_mirrored, &static_scene, diag);
    if (status)
        return status;
    const struct neph_rt_transforms now = compute_transforms(realtime, frame, static_scene);
    made.stats = &realtime->flights[slot];
    made.rays = neph_injected_rays_at(neph_scene_injections(frame->scene), frame->frame);
    *made.stats = (struct neph_realtime_stats){.gpu_s = 0.0};
    made.fill = &realtime->fills[slot];
    *made.fill = (struct neph_sun_fill_cost){.dispatches = 0};
    neph_rt_view_set_transforms(view, frame->scene, &now, past, realtime->frame_count);
    set_solid_motion(realtime, frame->scene);
    set_light_flags(realtime, static_scene, &now);
    status = update_static_state(realtime, frame, is_mirrored, image, static_scene, &made.given,
                                 diag);
    made.moment = make_march_transforms(view, &now);
    neph_buffer_ring_advance(&realtime->device.view_turns, &realtime->device.view_buffer);
    neph_rt_device_upload_view(&realtime->device);
    if (!status)
        status = (realtime->whole ? render_whole : render_split)(realtime, frame, static_scene,
                                                                 image, &made, diag);
    if (!status)
        status = neph_vulkan_check(realtime->vulkan, diag);
    neph_scene_destroy(static_scene);
    if (status)
        return status;
    finish_frame(realtime, &now, &made);
    made.stats->wall_s = neph_wall_s() - start_s;
    made.stats->injected_values = realtime->injected_values;
    realtime->injected_values = 0;
    realtime->has_injected_rays = made.rays;
    if (!image)
        return NEPH_OK;
    status = neph_in_flight_drain(realtime->vulkan, &realtime->flight, diag);
    add_device_times(realtime, made.stats);
    add_fill(made.stats, made.fill);
    if (stats)
        *stats = *made.stats;
    return status;
}

static void change_view(struct neph_realtime *realtime)
{
    const struct neph_rt_transforms past = realtime->past;
    const bool has_past = realtime->has_past;
    realtime->past = realtime->mirrored_past;
    realtime->has_past = realtime->has_mirrored_past;
    realtime->mirrored_past = past;
    realtime->has_mirrored_past = has_past;
}

/* Renders the mirrored view, which is not output: only its history and its counts are used. Both
 * views have the same phase because they belong to one frame. */
static enum neph_status render_mirrored(struct neph_realtime *realtime,
                                        const struct neph_realtime_frame *frame,
                                        struct neph_diag *diag)
{
    const struct neph_realtime_frame own = {frame->scene, frame->frame, NULL};
    const uint32_t frame_count = realtime->frame_count;
    struct neph_realtime_stats stats = {.injected_values = 0};
    struct neph_image *image = NULL;
    change_view(realtime);
    const enum neph_status status = render_size(realtime, &own, true, &image, &stats, diag);
    change_view(realtime);
    realtime->frame_count = frame_count;
    realtime->injected_values += stats.injected_values;
    neph_image_destroy(image);
    return status;
}

static int scaled_px(int side_px, double scale)
{
    return (int)fmin(fmax(1.0, round(side_px * scale)), NEPH_MARCH_SIDE_MAX_PX);
}

/* Renders a frame in another size, which is not output, and changes back. */
static enum neph_status render_resized(struct neph_realtime *realtime,
                                       const struct neph_realtime_frame *frame, double scale,
                                       struct neph_diag *diag)
{
    const struct neph_realtime_frame own = {frame->scene, frame->frame, NULL};
    const int width_px = realtime->picture_px[0], height_px = realtime->picture_px[1];
    struct neph_image *image = NULL;
    enum neph_status status = neph_realtime_resize(
        realtime, frame->scene, scaled_px(width_px, scale), scaled_px(height_px, scale), diag);
    if (!status)
        status = render_size(realtime, &own, false, &image, NULL, diag);
    if (!status)
        status = neph_realtime_resize(realtime, frame->scene, width_px, height_px, diag);
    neph_image_destroy(image);
    return status;
}

enum neph_status neph_realtime_render(struct neph_realtime *realtime,
                                      const struct neph_realtime_frame *frame,
                                      struct neph_image **image, struct neph_realtime_stats *stats,
                                      struct neph_diag *diag)
{
    const struct neph_injections *injections = neph_scene_injections(frame->scene);
    const struct neph_injected_size *size = neph_injected_size_at(injections, frame->frame);
    const bool is_mirrored = neph_injected_mirror_at(injections, frame->frame);
    enum neph_status status = NEPH_OK;
    if (!image && (size || is_mirrored))
        return neph_fail(
            diag, NEPH_ERR_UNSUPPORTED,
            "a frame with another one before it cannot be in flight: leave out inject.%s",
            size ? "sizes" : "mirror");
    if (size)
        status = render_resized(realtime, frame, size->scale, diag);
    if (!status && is_mirrored)
        status = render_mirrored(realtime, frame, diag);
    if (!status)
        status = render_size(realtime, frame, false, image, stats, diag);
    return status || !image ? status
                            : neph_gpu_scene_check(realtime->vulkan, &realtime->scene.gpu, diag);
}

enum neph_status neph_realtime_collect(struct neph_realtime *realtime,
                                       struct neph_realtime_stats *stats, struct neph_diag *diag)
{
    int slot;
    enum neph_status status = neph_in_flight_collect(realtime->vulkan, &realtime->flight, &slot,
                                                     diag);
    if (!status)
        status = neph_gpu_scene_check(realtime->vulkan, &realtime->scene.gpu, diag);
    if (status)
        return status;
    struct neph_realtime_stats *home = &realtime->flights[slot];
    if (realtime->whole)
        status = neph_march_collect(realtime->whole, &home->pass_gpu_s[neph_rt_pass_index("march")],
                                    diag);
    add_device_times(realtime, home);
    add_fill(home, &realtime->fills[slot]);
    if (!status)
        *stats = *home;
    return status;
}

enum neph_status neph_realtime_watch(struct neph_realtime *realtime, uint64_t *bad,
                                     struct neph_diag *diag)
{
    uint32_t targets = neph_rt_find_watched_targets(realtime->device.view);
    if (targets == 0)
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "split=none has no intermediate images: count bad values in its frames");
    if (realtime->has_injected_rays)
        targets &= ~NEPH_RT_BIT(RT_RAY);
    if (realtime->has_injected_history) /* updated in place, bit by bit */
        targets &= ~(NEPH_RT_BIT(RT_KEPT_RAY) | NEPH_RT_BIT(RT_KEPT_BEHIND));
    return neph_rt_watch(&realtime->device, targets, bad, diag);
}
