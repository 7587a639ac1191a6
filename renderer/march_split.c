/* SPDX-License-Identifier: MIT */
#include "renderer/march_split.h"

#include "base/interrupt.h"
#include "renderer/octaves_fitted.h"
#include "renderer/shortcuts.h"
#include "renderer/sky/tables.h"
#include "scenes/media.h"

#include <math.h>

/* Does not compile with a new kind: this file then needs a change. */
_Static_assert(NEPH_MARCH_LIGHTING_COUNT == 8, "a new kind");
_Static_assert(NEPH_MARCH_MODE_COUNT == 2, "a new kind");

/* Loop iterations of all rays in a dispatch before the device's speed is measured: about 0.2 s on
 * two CPU cores. A GPU does 500 times as much in one or two milliseconds; with the limit of a CPU
 * it would run a few hundred rays at a time instead of the 100,000 that fill it. */
static const uint64_t cpu_first_turns = 1ull << 25;
static const uint64_t gpu_first_turns = 1ull << 34;

/* Minimum of a dispatch, about 30 ms on an idle device. On a shared device all work appears slow,
 * and smaller dispatches would be slower still. */
static const uint64_t cpu_least_turns = 1ull << 22;
static const uint64_t gpu_least_turns = 1ull << 28;

/* Limit of one thread. A GPU has only a watchdog: this is about 0.1 s of one thread. */
static const uint64_t gpu_thread_turns_max = 1ull << 20;

/* Limit of rays in a dispatch: 32 MiB of results. */
static const uint64_t dispatch_rays_max = 1u << 19;

static uint64_t least(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

static uint64_t most(uint64_t a, uint64_t b)
{
    return a > b ? a : b;
}

bool neph_march_has_sun_rays(const struct neph_scene *scene, const struct neph_march_params *params)
{
    for (int i = 0; i < scene->medium_count; i++)
        if (!neph_medium_has_closed_form(&scene->media[i]))
            return true;
    return params->sun == NEPH_MARCH_MARCHED;
}

int neph_march_sun_steps(const struct neph_scene *scene, const struct neph_march_params *params)
{
    return neph_march_has_sun_rays(scene, params) ? params->sun_steps : 0;
}

/* Octaves of the medium similar to one of mean cosine g (octaves_fitted.h). */
static void fit_similar(double g, struct neph_gpu_medium *medium)
{
    const double smooth_g = neph_similar_g(g);
    double mean = 0.0;
    for (int c = 0; c < 3; c++) {
        const double albedo = neph_similar_albedo((double)medium->albedo[c], g);
        medium->octave_contribution[c] =
            (float)neph_octaves_compute(&neph_octaves_fitted, smooth_g, albedo).contribution;
        mean += albedo / 3.0;
    }
    const struct neph_octaves octaves = neph_octaves_compute(&neph_octaves_fitted, smooth_g, mean);
    medium->octave_attenuation = (float)octaves.attenuation;
    medium->octave_eccentricity = (float)octaves.eccentricity;
}

static void fit_similar_media(const struct neph_scene *scene, struct neph_gpu_frame *frame)
{
    const struct neph_medium *media[NEPH_GPU_MEDIA_MAX];
    const uint32_t count = neph_gpu_scene_list_media(scene, media);
    for (uint32_t m = 0; m < count && m < frame->medium_count; m++)
        fit_similar(neph_phase_mean_cosine(&media[m]->phase), &frame->media[m]);
}

/* The first length of a geometric series of lengths, relative to their sum. */
static double compute_first_length(double growth, uint32_t count)
{
    return growth > 1.0 ? (growth - 1.0) / (pow(growth, count) - 1.0) : 1.0 / fmax(1.0, count);
}

void neph_march_set_frame(const struct neph_scene *scene, const struct neph_march_params *params,
                          struct neph_gpu_frame *frame)
{
    if (params->picture_px[0] > 0)
        frame->half_width = frame->half_height * (float)params->picture_px[0] /
                            (float)params->picture_px[1];
    frame->steps = (uint32_t)params->steps;
    frame->sun_steps = (uint32_t)neph_march_sun_steps(scene, params);
    frame->sun_first_part = (float)compute_first_length(params->shortcuts.sun_growth,
                                                        frame->sun_steps);
    frame->light_texel_px = (uint32_t)params->light.texel_px;
    neph_shortcuts_set_frame(&params->shortcuts, frame);
    if (params->lighting == NEPH_MARCH_SIMILARITY)
        fit_similar_media(scene, frame);
}

bool neph_march_has_sky_light(const struct neph_march_params *params)
{
    return params->sky.is_on && params->lighting == NEPH_MARCH_TRACED;
}

static uint64_t octave_count(const struct neph_scene *scene, enum neph_march_lighting lighting)
{
    if (lighting == NEPH_MARCH_OCTAVES_FITTED || lighting == NEPH_MARCH_SIMILARITY)
        return NEPH_OCTAVES_FITTED_COUNT;
    if (lighting == NEPH_MARCH_DIFFUSED || lighting == NEPH_MARCH_SLAB)
        return 2; /* loops over media */
    return lighting == NEPH_MARCH_OCTAVES ? (uint64_t)scene->octaves.count : 0;
}

/* Upper bounds of loop iterations (compute.h), loop by loop of the shader. */
struct turns {
    uint64_t solids, media, exact;
    uint64_t empties; /* of one step that may be skipped */
    uint64_t sun;     /* of a sun ray through media */
};

/* Whether some optical depths have closed forms; otherwise all are sums over steps. */
static bool has_closed_forms(const struct neph_march_params *params)
{
    return params->transmittance == NEPH_MARCH_EXACT || params->sun == NEPH_MARCH_EXACT;
}

static struct turns count_loop_iterations(const struct neph_scene *scene,
                                          const struct neph_gpu_scene *gpu,
                                          const struct neph_march_params *params)
{
    struct turns turns = {
        .solids = gpu->solid_iterations,
        .media = (uint64_t)scene->medium_count + 1,
        .exact = has_closed_forms(params) ? gpu->optical_depth_iterations : 0,
    };
    for (int i = 0; i < scene->medium_count; i++)
        turns.media += (uint64_t)scene->media[i].layer_count + 1;
    const uint64_t sun_steps = (uint64_t)neph_march_sun_steps(scene, params);
    turns.empties = params->shortcuts.skip ? 1 + turns.media : 0;
    turns.sun = turns.media + turns.exact + sun_steps * (1 + turns.media + 2 * turns.empties) + 1;
    return turns;
}

static bool is_scene_on_cpu(const struct neph_gpu_scene *gpu)
{
    return (gpu->constants[1] & NEPH_GPU_ON_CPU) != 0;
}

/* Upper bound of the sub-steps for one light, over all steps of a ray, in addition to one per step
 * (shaders/march_lamp_steps.glsl): 7 for each four steps but at least 112, limited to 3/4 of a
 * thread's loop iterations but at least 8. 0: no light. */
static uint64_t count_light_substeps(const struct neph_gpu_scene *gpu,
                                     const struct neph_march_params *params, uint64_t lamps,
                                     uint64_t media)
{
    const uint64_t medium_turns = 1 + 3 * media; /* two layers each */
    const bool marches = params->sun == NEPH_MARCH_MARCHED ||
                         (gpu->constants[0] >> NEPH_MEDIUM_HORIZON & 1u) != 0;
    const uint64_t sun_steps = marches ? (uint64_t)params->sun_steps : 0;
    const uint64_t turns = gpu->solid_iterations + 3 * medium_turns +
                           2 * gpu->optical_depth_iterations + sun_steps * (3 + 3 * medium_turns);
    const uint64_t all = is_scene_on_cpu(gpu) ? NEPH_KERNEL_LOOP_ITERATIONS_MAX
                                              : gpu_thread_turns_max;
    const uint64_t wanted = 7 * (uint64_t)params->steps / 4;
    if (lamps == 0)
        return 0;
    return most(8, least(most(112, least(wanted, 0xffff)), all / 4 * 3 / (lamps * turns)));
}

/* Loop iterations of the whole shader. */
static void count_shader_iterations(const struct neph_scene *scene,
                                    const struct neph_gpu_scene *gpu,
                                    const struct neph_march_params *params, uint64_t *per_step,
                                    uint64_t *per_dispatch)
{
    const struct turns turns = count_loop_iterations(scene, gpu, params);
    uint64_t sunlight = turns.solids + turns.sun +
                        octave_count(scene, params->lighting) * (1 + turns.media);
    if (params->lighting == NEPH_MARCH_SLAB)
        sunlight *= 2; /* a second ray, away from the sun */
    /* Each light needs the work of the sun for each sub-step, and a sub-step is a step. */
    const uint64_t lamplight = (uint64_t)scene->light_count *
                               (turns.solids + turns.sun + 2 * turns.media + turns.exact);
    sunlight += lamplight;
    if (params->sky.is_on)
        sunlight += 2 * neph_sky_sample_iterations(scene->medium_count,
                                                   params->sky.tables.field.degree);
    if (params->fog.is_look)
        sunlight += 2 * NEPH_GPU_LAYERS_MAX; /* towards the eye and towards the sun */
    *per_step = 2 + 2 * turns.media + turns.exact + sunlight + 3 * turns.empties;
    *per_dispatch = turns.solids + 3 * turns.media + turns.exact + sunlight +
                    count_light_substeps(gpu, params, (uint64_t)scene->light_count,
                                         (uint64_t)scene->medium_count) *
                        lamplight +
                    1;
}

/* Whether media emit nothing and the number of octaves is at most the number of cached phase values
 * of a ray, with grids as textures. */
static bool has_only_sunlight(const struct neph_gpu_scene *gpu,
                              const struct neph_march_params *params)
{
    return params->shortcuts.grid_texture && gpu->frame->scatters && !gpu->frame->emits &&
           (params->lighting != NEPH_MARCH_OCTAVES ||
            gpu->frame->octave_count <= NEPH_GPU_KEPT_PHASES);
}

void neph_march_constants(const struct neph_gpu_scene *gpu, const struct neph_march_params *params,
                          uint32_t constants[NEPH_MARCH_CONSTANTS])
{
    constants[0] = gpu->constants[0];
    constants[1] = gpu->constants[1];
    constants[2] = params->transmittance;
    constants[3] = params->sun;
    constants[4] = params->lighting;
    constants[5] = neph_shortcuts_bits(&params->shortcuts) | (params->sky.is_on ? 64u : 0u) |
                   (neph_march_has_sky_light(params) ? 128u : 0u) |
                   (params->fog.is_look ? 1024u : 0u) |
                   (has_only_sunlight(gpu, params) ? 2048u : 0u) |
                   (gpu->frame->octave_count > NEPH_GPU_KEPT_PHASES ? 4096u : 0u) |
                   (uint32_t)count_light_substeps(gpu, params, gpu->frame->lamp_count,
                                                  gpu->frame->medium_count)
                       << 16;
}

static uint64_t count_ray_iterations(const struct neph_march_split *cut, uint64_t steps)
{
    return steps * cut->iterations_per_step + cut->iterations_per_dispatch;
}

/* Whole work groups, at least one. */
static void set_rays(struct neph_march_split *cut, uint64_t turns)
{
    const uint64_t enough = turns > cut->iterations_least ? turns : cut->iterations_least;
    const uint64_t rays = enough / count_ray_iterations(cut, cut->steps);
    const uint64_t groups = rays / NEPH_MARCH_LOCAL_SIZE;
    cut->rays = least(groups > 0 ? groups * NEPH_MARCH_LOCAL_SIZE : NEPH_MARCH_LOCAL_SIZE,
                      cut->rays_max);
}

static uint64_t thread_turns_max(const struct neph_vulkan *vulkan)
{
    return vulkan->description.is_cpu ? NEPH_KERNEL_LOOP_ITERATIONS_MAX : gpu_thread_turns_max;
}

static enum neph_status refuse_step(const struct neph_vulkan *vulkan,
                                    const struct neph_scene *scene,
                                    const struct neph_march_params *params, uint64_t turns,
                                    struct neph_diag *diag)
{
    return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                     "march: one step with %d sun steps, %d media and %d solids takes %llu loop "
                     "iterations; the limit of a dispatch is %llu",
                     neph_march_sun_steps(scene, params), scene->medium_count, scene->solid_count,
                     (unsigned long long)turns, (unsigned long long)thread_turns_max(vulkan));
}

enum neph_status neph_march_split_events(const struct neph_vulkan *vulkan,
                                         const struct neph_scene *scene,
                                         const struct neph_gpu_scene *gpu,
                                         const struct neph_march_params *params, uint64_t turns,
                                         uint64_t *events, struct neph_diag *diag)
{
    uint64_t per_event, whole_ray;
    count_shader_iterations(scene, gpu, params, &per_event, &whole_ray);
    per_event += gpu->solid_iterations;
    const uint64_t beside = turns * (3 + 2 * (uint64_t)scene->medium_count);
    const uint64_t most = thread_turns_max(vulkan);
    if (beside + per_event > most)
        return refuse_step(vulkan, scene, params, beside + per_event, diag);
    *events = (most - beside) / per_event;
    return NEPH_OK;
}

/* Split rays with known loop iterations. */
static void split_rays(const struct neph_vulkan *vulkan, struct neph_march_split *cut)
{
    const bool is_cpu = vulkan->description.is_cpu;
    const uint64_t groups_max = vulkan->limits.maxComputeWorkGroupCount[0];
    cut->rays_max = least(least(groups_max * NEPH_MARCH_LOCAL_SIZE, dispatch_rays_max),
                          cut->ray_count);
    cut->iterations_least = is_cpu ? cpu_least_turns : gpu_least_turns;
    set_rays(cut, is_cpu ? cpu_first_turns : gpu_first_turns);
}

enum neph_status neph_march_split_make(const struct neph_vulkan *vulkan,
                                       const struct neph_scene *scene,
                                       const struct neph_gpu_scene *gpu,
                                       const struct neph_march_params *params, uint64_t ray_count,
                                       struct neph_march_split *cut, struct neph_diag *diag)
{
    const uint64_t thread_max = thread_turns_max(vulkan);
    struct neph_march_split made = {.ray_count = ray_count, .step_count = (uint64_t)params->steps};
    count_shader_iterations(scene, gpu, params, &made.iterations_per_step,
                            &made.iterations_per_dispatch);
    if (count_ray_iterations(&made, 1) > thread_max)
        return refuse_step(vulkan, scene, params, count_ray_iterations(&made, 1), diag);
    made.steps = least((thread_max - made.iterations_per_dispatch) / made.iterations_per_step,
                       made.step_count);
    split_rays(vulkan, &made);
    *cut = made;
    return NEPH_OK;
}

enum neph_status neph_march_split_make_whole(
    const struct neph_vulkan *vulkan, const struct neph_scene *scene,
    const struct neph_gpu_scene *gpu, const struct neph_march_params *params, uint64_t samples,
    uint64_t sun_rays, uint64_t ray_count, struct neph_march_split *cut, struct neph_diag *diag)
{
    const struct turns turns = count_loop_iterations(scene, gpu, params);
    struct neph_march_split made = {.ray_count = ray_count, .step_count = 1, .steps = 1};
    made.iterations_per_step = samples * (1 + turns.media) + sun_rays * (1 + turns.sun);
    if (made.iterations_per_step > thread_turns_max(vulkan))
        return refuse_step(vulkan, scene, params, made.iterations_per_step, diag);
    split_rays(vulkan, &made);
    *cut = made;
    return NEPH_OK;
}

void neph_march_split_adapt(struct neph_march_split *cut, double gpu_s)
{
    const double turns = (double)cut->ray_count *
                         (double)count_ray_iterations(cut, cut->step_count);
    neph_pace_update(&cut->pace, turns, gpu_s);
    if (cut->pace.work_per_s > 0.0)
        set_rays(cut, neph_pace_work(&cut->pace, 0));
}

bool neph_march_split_is_whole(const struct neph_march_split *cut)
{
    return cut->rays >= cut->ray_count && cut->steps >= cut->step_count;
}

enum neph_status neph_march_split_run(const struct neph_march_split *cut, neph_march_body *body,
                                      void *context, struct neph_diag *diag)
{
    for (uint64_t ray = 0; ray < cut->ray_count; ray += cut->rays)
        for (uint64_t step = 0; step < cut->step_count; step += cut->steps) {
            const struct neph_gpu_march_run run = {
                .first_ray = (uint32_t)ray,
                .ray_count = (uint32_t)least(cut->rays, cut->ray_count - ray),
                .first_step = (uint32_t)step,
                .end_step = (uint32_t)least(step + cut->steps, cut->step_count),
            };
            if (neph_interrupted())
                return neph_fail(diag, NEPH_ERR_INTERRUPTED, "march: interrupted");
            const enum neph_status status = body(&run, context, diag);
            if (status)
                return status;
        }
    return NEPH_OK;
}
