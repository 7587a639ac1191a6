/* SPDX-License-Identifier: MIT */
#include "renderer/march.h"

#include "base/clock.h"
#include "base/interrupt.h"
#include "renderer/compute.h"
#include "renderer/gpu_scene.h"
#include "scenes/media.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const uint32_t march_spirv[] = {
#include "shaders/march.comp.inc"
};

/* struct Pixel of shaders/march.comp */
struct gpu_pixel {
    float radiance[3];
    float eye_depth_m;
    float volume[3];
    uint32_t density_evaluations;
    float transmittance[3];
    uint32_t closed_forms;
};
_Static_assert(offsetof(struct gpu_pixel, volume) == 16, "std430 Pixel.volume");
_Static_assert(offsetof(struct gpu_pixel, transmittance) == 32, "std430 Pixel.transmittance");
_Static_assert(sizeof(struct gpu_pixel) == 48, "std430 Pixel");

/* push_constant Run of shaders/march.comp */
struct gpu_run {
    uint32_t first_pixel;
    uint32_t pixel_count;
    uint32_t first_step;
    uint32_t end_step;
};

/* Bytes of struct State of shaders/march.comp */
enum { gpu_state_bytes = 80 };

enum { local_size = 64 }; /* of shaders/march.comp */

/* One dispatch: at most this much work (loop turns of all pixels, about 0.2 s on two CPU cores), so
 * that Ctrl-C is heard, and this many pixels (24 MiB of results). */
static const uint64_t dispatch_turns_max = 1u << 25;
static const uint64_t dispatch_pixels_max = 1u << 19;

/* --- what can be rendered ----------------------------------------------------------------- */

static bool is_positive(struct neph_rgb rgb)
{
    return rgb.r > 0.0 || rgb.g > 0.0 || rgb.b > 0.0;
}

/* Is there anything that the background could light? */
static bool is_lit_by_environment(const struct neph_scene *scene)
{
    if (!scene->environment_light || !is_positive(scene->background_w_per_m2_sr))
        return false;
    for (int i = 0; i < scene->solid_count; i++)
        if (is_positive(scene->solids[i].albedo))
            return true;
    if (scene->scattering != NEPH_SCATTERING_NONE)
        for (int i = 0; i < scene->medium_count; i++)
            if (is_positive(scene->media[i].albedo))
                return true;
    return false;
}

/* NULL when there is none. */
static const char *find_obstacle(const struct neph_scene *scene, enum neph_march_lighting lighting)
{
    if (lighting == NEPH_MARCH_SINGLE && scene->scattering == NEPH_SCATTERING_MULTIPLE)
        return "multiple scattering";
    if (lighting != NEPH_MARCH_SINGLE && scene->scattering == NEPH_SCATTERING_SINGLE)
        return "single scattering: this lighting stands for all orders";
    for (int i = 0; lighting == NEPH_MARCH_HORIZON && i < scene->medium_count; i++)
        if (scene->media[i].kind != NEPH_MEDIUM_HORIZON)
            return "a medium without the heights and shapes of Horizon's clouds, which this "
                   "lighting is made of";
    return is_lit_by_environment(scene) ? "background light on media and solids" : NULL;
}

bool neph_march_can_render(const struct neph_scene *scene, enum neph_march_lighting lighting,
                           char *reason, size_t reason_size)
{
    const char *obstacle = find_obstacle(scene, lighting);
    if (obstacle)
        snprintf(reason, reason_size, "%s", obstacle);
    return !obstacle;
}

static enum neph_status check_range(const char *name, int value, int maximum,
                                    struct neph_diag *diag)
{
    if (value >= 1 && value <= maximum)
        return NEPH_OK;
    return neph_fail(diag, NEPH_ERR_USAGE, "march: %s is %d, outside 1..%d", name, value, maximum);
}

static bool marches_towards_sun(const struct neph_scene *scene,
                                const struct neph_march_params *params)
{
    for (int i = 0; i < scene->medium_count; i++)
        if (!neph_medium_has_closed_form(&scene->media[i]))
            return true;
    return params->sun == NEPH_MARCH_MARCHED;
}

static int sun_steps_of(const struct neph_scene *scene, const struct neph_march_params *params)
{
    return marches_towards_sun(scene, params) ? params->sun_steps : 0;
}

static enum neph_status check(const struct neph_scene *scene,
                              const struct neph_march_params *params, struct neph_diag *diag)
{
    enum neph_status status = check_range("width", params->width_px, NEPH_MARCH_SIDE_MAX_PX, diag);
    if (!status)
        status = check_range("height", params->height_px, NEPH_MARCH_SIDE_MAX_PX, diag);
    if (!status)
        status = check_range("steps", params->steps, NEPH_MARCH_STEPS_MAX, diag);
    if (!status && marches_towards_sun(scene, params))
        status = check_range("sun_steps", params->sun_steps, NEPH_MARCH_STEPS_MAX, diag);
    if (status)
        return status;
    if ((uint64_t)params->steps * (uint64_t)(1 + sun_steps_of(scene, params)) > UINT32_MAX / 2)
        return neph_fail(diag, NEPH_ERR_USAGE,
                         "march: %d steps of %d sun steps each are more than a pixel can count",
                         params->steps, params->sun_steps);
    char reason[256];
    if (!neph_march_can_render(scene, params->lighting, reason, sizeof(reason)))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "march: cannot: %s", reason);
    return NEPH_OK;
}

/* --- one render --------------------------------------------------------------------------- */

/* How a frame is cut into dispatches. */
struct plan {
    uint64_t pixel_count, step_count; /* of the frame */
    uint64_t pixels, steps;           /* at most, in one dispatch */
};

/* Upper bound of loop turns (compute.h) of the shader, following its loops one by one. */
static void count_turns(const struct neph_scene *scene, const struct neph_gpu_scene *gpu,
                        const struct neph_march_params *params, uint64_t *per_step,
                        uint64_t *per_dispatch)
{
    const uint64_t solids = (uint64_t)scene->solid_count + 1;
    const uint64_t exact = gpu->optical_depth_turns;
    uint64_t media = (uint64_t)scene->medium_count + 1;
    for (int i = 0; i < scene->medium_count; i++)
        media += (uint64_t)scene->media[i].layer_count + 1;
    const uint64_t sun_steps = (uint64_t)sun_steps_of(scene, params);
    const uint64_t octaves = params->lighting == NEPH_MARCH_OCTAVES
                                 ? (uint64_t)scene->octaves.count * (1 + media)
                                 : 0;
    const uint64_t sunlight = solids + media + exact + sun_steps * (1 + media) + octaves + 1;
    *per_step = 1 + 2 * media + exact + sunlight;
    *per_dispatch = solids + 3 * media + exact + sunlight + 1;
}

static enum neph_status make_plan(const struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                  const struct neph_gpu_scene *gpu,
                                  const struct neph_march_params *params, struct plan *plan,
                                  struct neph_diag *diag)
{
    uint64_t turns_per_step, turns_per_dispatch;
    count_turns(scene, gpu, params, &turns_per_step, &turns_per_dispatch);
    if (turns_per_dispatch + turns_per_step > NEPH_KERNEL_LOOP_TURNS_MAX)
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "march: one step with %d sun steps, %d media and %d solids takes %llu "
                         "loop turns; a dispatch has %d",
                         sun_steps_of(scene, params), scene->medium_count, scene->solid_count,
                         (unsigned long long)(turns_per_dispatch + turns_per_step),
                         NEPH_KERNEL_LOOP_TURNS_MAX);
    plan->pixel_count = (uint64_t)params->width_px * (uint64_t)params->height_px;
    plan->step_count = (uint64_t)params->steps;
    plan->steps = (NEPH_KERNEL_LOOP_TURNS_MAX - turns_per_dispatch) / turns_per_step;
    if (plan->steps > plan->step_count)
        plan->steps = plan->step_count;
    plan->pixels = dispatch_turns_max / (plan->steps * turns_per_step + turns_per_dispatch);
    const uint64_t pixels_max = (uint64_t)vulkan->limits.maxComputeWorkGroupCount[0] * local_size;
    if (plan->pixels > pixels_max)
        plan->pixels = pixels_max;
    if (plan->pixels > dispatch_pixels_max)
        plan->pixels = dispatch_pixels_max;
    if (plan->pixels > plan->pixel_count)
        plan->pixels = plan->pixel_count;
    return NEPH_OK;
}

struct render {
    struct neph_vulkan *vulkan;
    const struct neph_kernel *kernel;
    struct plan plan;
    struct neph_gpu_scene scene;
    struct neph_buffer pixels, states, readback;
};

static enum neph_status create_buffers(struct render *render, struct neph_diag *diag)
{
    const size_t pixels_bytes = render->plan.pixels * sizeof(struct gpu_pixel);
    const size_t states_bytes = render->plan.pixels * gpu_state_bytes;
    enum neph_status status = neph_buffer_create(render->vulkan, NEPH_BUFFER_DEVICE, pixels_bytes,
                                                 "march pixels", &render->pixels, diag);
    if (!status)
        status = neph_buffer_create(render->vulkan, NEPH_BUFFER_DEVICE, states_bytes,
                                    "march states", &render->states, diag);
    if (!status)
        status = neph_buffer_create(render->vulkan, NEPH_BUFFER_READBACK, pixels_bytes,
                                    "march readback", &render->readback, diag);
    return status;
}

static enum neph_status prepare(struct render *render, const struct neph_scene *scene,
                                const struct neph_march_params *params, struct neph_diag *diag)
{
    enum neph_status status = neph_gpu_scene_create(render->vulkan, scene, params->frame,
                                                    params->width_px, params->height_px, false,
                                                    &render->scene, diag);
    if (!status)
        status = make_plan(render->vulkan, scene, &render->scene, params, &render->plan, diag);
    if (status)
        return status;
    render->scene.frame->steps = (uint32_t)params->steps;
    render->scene.frame->sun_steps = (uint32_t)sun_steps_of(scene, params);
    const struct neph_kernel_params kernel = {
        .name = "march",
        .spirv = march_spirv,
        .spirv_size_bytes = sizeof(march_spirv),
        .buffer_count = NEPH_GPU_SCENE_BUFFERS + 2,
        .push_size_bytes = sizeof(struct gpu_run),
        .constant_count = NEPH_GPU_SCENE_CONSTANTS + 3,
        .constants = {render->scene.constants[0], render->scene.constants[1], params->transmittance,
                      params->sun, params->lighting},
    };
    status = neph_kernel_get(render->vulkan, &kernel, &render->kernel, diag);
    return status ? status : create_buffers(render, diag);
}

static void finish(struct render *render)
{
    neph_buffer_destroy(render->vulkan, &render->readback);
    neph_buffer_destroy(render->vulkan, &render->states);
    neph_buffer_destroy(render->vulkan, &render->pixels);
    neph_gpu_scene_destroy(render->vulkan, &render->scene);
}

/* The channels of the frame; they point into the image. */
struct layers {
    float *radiance[3], *volume[3], *transmittance[3], *eye_depth_m;
};

static enum neph_status create_image(const struct neph_march_params *params,
                                     struct neph_image **image, struct layers *layers,
                                     struct neph_diag *diag)
{
    struct neph_image *created;
    enum neph_status status = neph_image_create(params->width_px, params->height_px, &created,
                                                diag);
    if (status)
        return status;
    status = neph_image_add_rgb(created, NULL, layers->radiance, diag);
    if (!status)
        status = neph_image_add_rgb(created, "volume", layers->volume, diag);
    if (!status)
        status = neph_image_add_rgb(created, "transmittance", layers->transmittance, diag);
    if (!status)
        status = neph_image_add_channel(created, "Z", &layers->eye_depth_m, diag);
    if (status) {
        neph_image_destroy(created);
        return status;
    }
    *image = created;
    return NEPH_OK;
}

static void unpack(const struct gpu_pixel *pixel, size_t index, const struct layers *layers,
                   struct neph_march_stats *stats)
{
    for (int c = 0; c < 3; c++) {
        layers->radiance[c][index] = pixel->radiance[c];
        layers->volume[c][index] = pixel->volume[c];
        layers->transmittance[c][index] = pixel->transmittance[c];
    }
    layers->eye_depth_m[index] = pixel->eye_depth_m < NEPH_GPU_FAR_M ? pixel->eye_depth_m
                                                                     : INFINITY;
    stats->density_evaluations += pixel->density_evaluations;
    stats->closed_forms += pixel->closed_forms;
}

/* One dispatch; the last of its pixels also brings the results. */
static enum neph_status dispatch_run(struct render *render, struct gpu_run run,
                                     struct neph_march_stats *stats, struct neph_diag *diag)
{
    if (neph_interrupted())
        return neph_fail(diag, NEPH_ERR_INTERRUPTED, "march: interrupted");
    const bool is_last = run.end_step == render->plan.step_count;
    struct neph_dispatch dispatch = {
        .push = &run,
        .group_count = (run.pixel_count + local_size - 1) / local_size,
        .copy_from = &render->pixels,
        .copy_to = is_last ? &render->readback : NULL,
        .copy_size_bytes = run.pixel_count * sizeof(struct gpu_pixel),
    };
    neph_gpu_scene_bind(&render->scene, &dispatch);
    dispatch.buffers[NEPH_GPU_SCENE_BUFFERS] = &render->pixels;
    dispatch.buffers[NEPH_GPU_SCENE_BUFFERS + 1] = &render->states;
    double gpu_s;
    const enum neph_status status = neph_kernel_run(render->vulkan, render->kernel, &dispatch,
                                                    &gpu_s, diag);
    if (status)
        return status;
    stats->gpu_s += gpu_s;
    stats->dispatches++;
    return NEPH_OK;
}

/* All steps of pixels [first, first + count) in raster order. */
static enum neph_status render_pixels(struct render *render, uint64_t first, uint64_t count,
                                      const struct layers *layers, struct neph_march_stats *stats,
                                      struct neph_diag *diag)
{
    const struct plan *plan = &render->plan;
    for (uint64_t step = 0; step < plan->step_count; step += plan->steps) {
        const uint64_t left = plan->step_count - step;
        const struct gpu_run run = {
            .first_pixel = (uint32_t)first,
            .pixel_count = (uint32_t)count,
            .first_step = (uint32_t)step,
            .end_step = (uint32_t)(step + (left < plan->steps ? left : plan->steps)),
        };
        const enum neph_status status = dispatch_run(render, run, stats, diag);
        if (status)
            return status;
    }
    const struct gpu_pixel *pixels = render->readback.mapped;
    for (uint64_t i = 0; i < count; i++)
        unpack(&pixels[i], first + i, layers, stats);
    return NEPH_OK;
}

static enum neph_status render_all(struct render *render, const struct layers *layers,
                                   struct neph_march_stats *stats, struct neph_diag *diag)
{
    const struct plan *plan = &render->plan;
    for (uint64_t first = 0; first < plan->pixel_count; first += plan->pixels) {
        const uint64_t left = plan->pixel_count - first;
        const enum neph_status status = render_pixels(
            render, first, left < plan->pixels ? left : plan->pixels, layers, stats, diag);
        if (status)
            return status;
    }
    return neph_vulkan_check(render->vulkan, diag);
}

enum neph_status neph_march_render(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                   const struct neph_march_params *params,
                                   struct neph_image **frame, struct neph_march_stats *stats,
                                   struct neph_diag *diag)
{
    const double start_s = neph_wall_s();
    enum neph_status status = check(scene, params, diag);
    if (status)
        return status;
    struct neph_image *image = NULL;
    struct layers layers;
    struct neph_march_stats counted = {0};
    struct render render = {.vulkan = vulkan};
    status = prepare(&render, scene, params, diag);
    if (!status)
        status = create_image(params, &image, &layers, diag);
    if (!status)
        status = render_all(&render, &layers, &counted, diag);
    finish(&render);
    if (status) {
        neph_image_destroy(image);
        return status;
    }
    counted.wall_s = neph_wall_s() - start_s;
    *frame = image;
    if (stats)
        *stats = counted;
    return NEPH_OK;
}
