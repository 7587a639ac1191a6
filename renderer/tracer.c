/* SPDX-License-Identifier: MIT */
#include "renderer/tracer.h"

#include "base/checkpoint.h"
#include "base/clock.h"
#include "base/files.h"
#include "base/interrupt.h"
#include "renderer/compute.h"
#include "renderer/float32_range.h"
#include "renderer/gpu_scene.h"
#include "renderer/lattice.h"
#include "renderer/light_projection.h"
#include "renderer/media/kind.h"
#include "renderer/relative.h"
#include "renderer/tracer_parts.h"
#include "renderer/tracer_sums.h"
#include "scenes/emission.h"
#include "scenes/media.h"
#include "scenes/motion.h"
#include "scenes/sources.h"
#include "scenes/surfaces.h"
#include "scenes/trapped_light.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Does not compile with a new kind: this file then needs a change. */
_Static_assert(NEPH_MEDIUM_KIND_COUNT == 8, "a new kind");
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");

static const uint32_t path_code[] = {
#include "shaders/tracer.comp.inc"
};
static const uint32_t view_code[] = {
#include "shaders/tracer_view.comp.inc"
};
static const uint32_t lit_code[] = {
#include "shaders/tracer_lit.comp.inc"
};
static const uint32_t guess_code[] = {
#include "shaders/tracer_guess.comp.inc"
};
static const uint32_t first_code[] = {
#include "shaders/tracer_first.comp.inc"
};
static const uint32_t sun_code[] = {
#include "shaders/tracer_sun.comp.inc"
};
static const uint32_t check_code[] = {
#include "shaders/tracer_check.comp.inc"
};
static const uint32_t sum_code[] = {
#include "shaders/tracer_sum.comp.inc"
};

enum {
    depths_bytes = 4 * NEPH_GPU_MEDIA_MAX * NEPH_GPU_LAYERS_MAX,
    track_steps = 8,       /* steps through majorant cells in one loop iteration */
    pixel_local_size = 64, /* work group size of tracer_view.comp and tracer_sum.comp */
    round_batches_max = 8,
    window_queues_max = 1 << 12,
};

/* --- supported scenes --------------------------------------------------------------------- */

static bool is_positive(struct neph_rgb rgb)
{
    return rgb.r > 0.0 || rgb.g > 0.0 || rgb.b > 0.0;
}

static double max_channel(struct neph_rgb rgb)
{
    return fmax(rgb.r, fmax(rgb.g, rgb.b));
}

static bool lights(const struct neph_scene *scene)
{
    return scene->environment_light && is_positive(scene->background_w_per_m2_sr);
}

static bool has_coverage(const struct neph_scene *scene)
{
    return neph_scene_mesh_looks(scene) & NEPH_LOOK_COVERAGE;
}

/* Whether the view ray is tracked too: the optical depth of some medium has no closed form, or the
 * ray ends at random. */
static bool is_open(const struct neph_scene *scene)
{
    if (has_coverage(scene))
        return true;
    for (int i = 0; i < scene->medium_count; i++)
        if (!neph_medium_has_closed_form(&scene->media[i]))
            return true;
    return false;
}

/* Whether more is needed than single scattering with known optical depths. */
static bool needs_paths(const struct neph_scene *scene)
{
    return scene->scattering == NEPH_SCATTERING_MULTIPLE || lights(scene) || is_open(scene);
}

/* Whether all sunlight is scattered once: first collisions are then sampled in proportion to that
 * light, or to a guess of it (without point and spot lights). */
static bool is_lit_once(const struct neph_scene *scene)
{
    if ((is_open(scene) && scene->light_count > 0) || has_coverage(scene))
        return false;
    return scene->scattering == NEPH_SCATTERING_SINGLE && scene->sun.present &&
           is_positive(scene->sun.irradiance_w_per_m2) && scene->medium_count > 0;
}

/* Whether first collisions are sampled in proportion to the light that arrives there. Also with
 * media of different emission, each of which is sampled by its own. */
static bool samples_by_light(const struct neph_scene *scene)
{
    return is_lit_once(scene) || (neph_scene_sources_differ(scene) && !has_coverage(scene));
}

/* Number of light tables of a pixel: one per medium, or two if a fog may have two layers; a single
 * one for all media if the light is guessed. */
static size_t lit_tables(const struct neph_scene *scene)
{
    int layers = 1;
    for (int i = 0; i < scene->medium_count; i++)
        if (neph_gpu_get_kind(&scene->media[i])->layers_max > layers)
            layers = neph_gpu_get_kind(&scene->media[i])->layers_max;
    if (!samples_by_light(scene))
        return 0;
    return is_open(scene) ? 1 : (size_t)scene->medium_count * (size_t)layers;
}

/* Number of ray segments through media of a pixel (shaders/tracer_way.glsl): one per medium if some
 * are grids. */
static size_t ways(const struct neph_scene *scene, const struct neph_gpu_frame *frame)
{
    for (int i = 0; i < scene->medium_count; i++)
        if (scene->media[i].kind == NEPH_MEDIUM_GRID && !is_open(scene))
            return frame->medium_count;
    return 0;
}

static bool is_bounded(const struct neph_medium *medium)
{
    const struct neph_bounds b = neph_medium_support(medium);
    return isfinite(b.min_m.x) && isfinite(b.min_m.y) && isfinite(b.min_m.z) &&
           isfinite(b.max_m.x) && isfinite(b.max_m.y) && isfinite(b.max_m.z);
}

bool neph_tracer_can_render(const struct neph_scene *scene, char *reason, size_t reason_size)
{
    const char *cannot = neph_surfaces_obstacle(scene);
    int coloured_clouds = 0, coloured_fogs = 0;
    for (int i = 0; i < scene->medium_count; i++) {
        const struct neph_medium *medium = &scene->media[i];
        coloured_clouds += !neph_medium_is_fog(medium) && neph_medium_is_coloured(medium);
        coloured_fogs += neph_medium_is_fog(medium) && neph_medium_is_coloured(medium);
        if (needs_paths(scene) && !neph_medium_is_fog(medium) && !is_bounded(medium))
            cannot = "more than single scattering in a shell without finite bounds";
    }
    if (needs_paths(scene) && coloured_clouds > 1 && coloured_fogs > 0)
        cannot = "more than single scattering in a fog and several clouds of coloured extinction";
    if (neph_scene_traps_light(scene))
        cannot = neph_trapped_light_reason;
    if (!cannot)
        return neph_is_in_float32_range(scene, reason, reason_size);
    snprintf(reason, reason_size, "%s", cannot);
    return false;
}

static enum neph_status check(const struct neph_scene *scene,
                              const struct neph_tracer_params *params, struct neph_diag *diag)
{
    const struct {
        const char *name;
        int value, minimum, maximum;
    } ranges[] = {
        {"width", params->width_px, 1, NEPH_TRACER_SIDE_MAX_PX},
        {"height", params->height_px, 1, NEPH_TRACER_SIDE_MAX_PX},
        {"samples", params->samples, 2, NEPH_TRACER_SAMPLES_MAX},
        {"sun_nodes", params->sun_nodes, 0, NEPH_TRACER_SUN_NODES_MAX},
    };
    for (size_t i = 0; i < sizeof(ranges) / sizeof(ranges[0]); i++)
        if (ranges[i].value < ranges[i].minimum || ranges[i].value > ranges[i].maximum)
            return neph_fail(diag, NEPH_ERR_USAGE, "tracer: %s is %d, outside %d..%d",
                             ranges[i].name, ranges[i].value, ranges[i].minimum, ranges[i].maximum);
    if (!(params->target_error >= 0.0) || !(params->time_limit_s > 0.0))
        return neph_fail(diag, NEPH_ERR_USAGE,
                         "tracer: the target error is %g (>= 0), the time limit %g s (> 0)",
                         params->target_error, params->time_limit_s);
    char reason[256];
    if (!neph_tracer_can_render(scene, reason, sizeof(reason)))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "tracer: cannot: %s", reason);
    return NEPH_OK;
}

/* Everything on which the sums depend. */
static char *make_render_identity(const struct neph_scene *scene,
                                  const struct neph_tracer_params *params,
                                  const struct neph_vulkan *vulkan)
{
    return neph_format(
        "tracer 10%s, %d sun nodes, scene %s, frame %.17g, %d x %d, seed %llu, on %s, %s",
        params->sobol ? " sobol" : "", params->sun_nodes, scene->hash, params->frame,
        params->width_px, params->height_px, (unsigned long long)params->seed,
        vulkan->description.device, vulkan->description.driver);
}

/* --- one render --------------------------------------------------------------------------- */

enum binding {
    BINDING_STATES = NEPH_GPU_SCENE_BUFFERS,
    BINDING_RESULTS,
    BINDING_QUEUES,
    BINDING_PIXELS,
    BINDING_PROGRESS,
    BINDING_FIRSTS,
    BINDING_DEPTHS,
    BINDING_LITS,
    BINDING_GUESSES,
    BINDING_WAYS,
    BINDING_SUN,
    BINDING_CHECKS,
    BINDING_LAMPS,
    BINDING_RAYS,
    BINDING_COUNT,
};

/* Work for the device at a time. More items improve utilisation: the threads of a work group with
 * many items are busy for longer. They cost memory, 100 bytes an item, and 64 more with a table of
 * sunlight. */
struct sizes {
    uint32_t chunk_items;               /* limit of pixels of a chunk times samples of a round */
    uint32_t queue_items, least_queues; /* per work group, about; minimum number of queues */
    uint32_t first_window;
};

static const struct sizes cpu_sizes = {1 << 19, 512, 64, 64};
static const struct sizes gpu_sizes = {1 << 22, 1024, 4096, 1024};

struct render {
    struct neph_vulkan *vulkan;
    const struct neph_tracer_params *params;
    double start_s;
    const struct neph_kernel *path, *view, *lit, *first, *sun, *check, *sum; /* NULL: not needed */
    struct neph_gpu_scene scene;
    struct neph_buffer buffers[BINDING_COUNT], progress_readback; /* all except BINDING_PIXELS */
    struct neph_tracer_parts parts;
    struct sizes sizes;
    uint32_t local_size; /* of the path kernel */
    bool needs_paths, is_open, has_sun_table;
    size_t lit_tables; /* per pixel; 0: not needed */
    size_t ways;       /* per pixel; 0: not needed */
    bool is_lit;       /* some medium may scatter light */
    uint32_t turns;    /* limit of loop iterations in one dispatch */
    uint32_t window;   /* queues in one dispatch; adapted to the device's speed */
    size_t pixel_count, chunk_pixels;
    size_t viewed_first; /* first pixel of the chunk on the device; SIZE_MAX: none */
    int round_batches;   /* of the next round; adapted to the device's speed */
    int most_batches;    /* limit of a round */
    double round_max_s;  /* limit of the time of a round with several batches */
    struct neph_gpu_progress progress;
    struct neph_tracer_sums sums;      /* of complete rounds; its pixels (owned) are from the last
                                          read-back */
    double round_head[NEPH_SUMS_HEAD]; /* counters of the current round */
    char *identity;
    struct neph_tracer_stats stats;
};

/* Upper bound of loop iterations (compute.h) in one iteration of the path kernel's main loop: three
 * loops over the solids, two over fog layers, tracking (each step may choose a node in a loop), and
 * one over finished items. With lights, six more over the lights, two over media and two over
 * solids. The meshes' iterations are `of_meshes` for each loop over the solids. */
static uint32_t count_inner_iterations(const struct neph_scene *scene, uint64_t of_meshes)
{
    uint32_t fog = 1;
    for (int i = 0; i < scene->medium_count; i++)
        fog += 3 + 2 * (uint32_t)scene->media[i].layer_count;
    const uint32_t solids = (uint32_t)(neph_gpu_solid_iterations(scene) -
                                       neph_gpu_mesh_iterations(scene) + of_meshes);
    const uint32_t lights = scene->light_count > 0
                                ? 6 * ((uint32_t)scene->light_count + 1) + 2 * fog + 2 * solids
                                : 0;
    return 1 + 3 * solids + 2 * fog + track_steps * 5 + 1 + NEPH_GPU_TAKES + 1 + lights;
}

/* On a CPU the kernel itself ends a dispatch after NEPH_GPU_WALKS loop iterations in meshes. All
 * other loops get a third of that, and the rest is for the walks of the last turn. */
static uint32_t choose_turns(const struct neph_scene *scene,
                             const struct neph_tracer_params *params, bool is_cpu)
{
    const uint32_t comfortable = 4096; /* a few milliseconds of a work group on a CPU core */
    const uint64_t of_meshes = neph_gpu_mesh_iterations(scene);
    const bool counts_walks = is_cpu && of_meshes > 0;
    const uint32_t limit = counts_walks ? NEPH_GPU_WALKS / 3 : NEPH_KERNEL_LOOP_ITERATIONS_MAX - 1;
    uint32_t turns = limit / count_inner_iterations(scene, counts_walks ? 0 : of_meshes);
    if (turns > comfortable)
        turns = comfortable;
    if (turns == 0)
        turns = 1;
    if (params->dispatch_turns > 0 && params->dispatch_turns < turns)
        turns = params->dispatch_turns;
    return turns;
}

static bool has_reflection(const struct neph_scene *scene)
{
    for (int i = 0; i < scene->solid_count; i++)
        if (is_positive(scene->solids[i].albedo))
            return true;
    return false;
}

/* The order of tracked media, for the constants 7 and 8 of shaders/tracer.glsl. Coloured ones come
 * last, so that weights of the channels depend less on media behind a collision that is found
 * later. Such media do not bias the result: they are part of the sampling probability, and each
 * channel's density integrates to 1. Only a coloured fog would bias it: the distance to which it
 * lets other media be tracked depends on the channel, which weigh_fog() omits. */
static uint32_t list_tracked_media(const struct neph_gpu_frame *frame, uint32_t *order)
{
    uint32_t count = 0;
    *order = 0;
    for (int coloured = 0; coloured < 2; coloured++)
        for (uint32_t m = 0; m < frame->medium_count; m++) {
            const struct neph_gpu_medium *medium = &frame->media[m];
            const float *color = medium->extinction_color;
            if (medium->majorant_size[0] > 0 &&
                (color[0] != color[1] || color[1] != color[2]) == coloured)
                *order |= m << (4 * count++);
        }
    return count;
}

static enum neph_status get_kernels(struct render *render, const struct neph_scene *scene,
                                    struct neph_diag *diag)
{
    const struct neph_vulkan_description *device = &render->vulkan->description;
    render->local_size = device->is_cpu ? device->subgroup_size : 64;
    uint32_t tracked_order;
    const uint32_t tracked_count = list_tracked_media(render->scene.frame, &tracked_order);
    struct neph_kernel_params params = {
        .buffer_count = BINDING_COUNT,
        .uniform_count = NEPH_GPU_SCENE_UNIFORMS,
        .push_size_bytes = sizeof(struct neph_gpu_tracer_run),
        .constant_count = 16,
        .constants = {render->scene.constants[0], render->scene.constants[1], render->local_size,
                      scene->scattering == NEPH_SCATTERING_MULTIPLE, has_reflection(scene),
                      lights(scene), render->scene.frame->medium_count, tracked_count,
                      tracked_order, track_steps, scene->solid_count > 0, samples_by_light(scene),
                      neph_scene_emits(scene), render->params->sobol, render->has_sun_table,
                      neph_scene_sources_differ(scene)},
    };
    const bool is_lit = render->lit_tables > 0, is_open = render->is_open;
    const struct {
        const struct neph_kernel **kernel;
        const char *name;
        const uint32_t *code;
        size_t code_bytes;
        bool is_needed; /* compilation is most of the time of a short render */
    } wanted[] = {
        {&render->view, "tracer_view", view_code, sizeof(view_code), true},
        {&render->lit, "tracer_lit", lit_code, sizeof(lit_code), is_lit && !is_open},
        {&render->lit, "tracer_guess", guess_code, sizeof(guess_code), is_lit && is_open},
        {&render->first, "tracer_first", first_code, sizeof(first_code), is_lit || !is_open},
        {&render->path, "tracer", path_code, sizeof(path_code), render->needs_paths},
        {&render->sun, "tracer_sun", sun_code, sizeof(sun_code), render->has_sun_table},
        {&render->check, "tracer_check", check_code, sizeof(check_code), render->has_sun_table},
        {&render->sum, "tracer_sum", sum_code, sizeof(sum_code), true},
    };
    enum neph_status status = NEPH_OK;
    for (size_t i = 0; !status && i < sizeof(wanted) / sizeof(wanted[0]); i++) {
        if (!wanted[i].is_needed)
            continue;
        params.name = wanted[i].name;
        params.code = wanted[i].code;
        params.code_bytes = wanted[i].code_bytes;
        status = neph_kernel_get(render->vulkan, &params, wanted[i].kernel, diag);
    }
    return status;
}

static size_t sun_nodes(const struct render *render)
{
    const uint32_t *size = render->scene.frame->sun_lattice.size;
    return (size_t)size[0] * size[1] * size[2];
}

static enum neph_status create_buffers(struct render *render, struct neph_diag *diag)
{
    const size_t queues = render->chunk_pixels; /* upper limit */
    const size_t items = render->chunk_pixels * (size_t)render->most_batches *
                         NEPH_TRACER_BATCH_SAMPLES;
    const size_t threads = (queues < window_queues_max ? queues : window_queues_max) *
                           render->local_size;
    const struct neph_buffer_row rows[] = {
        {&render->buffers[BINDING_STATES], NEPH_BUFFER_DEVICE,
         threads * sizeof(struct neph_gpu_tracer_state), "tracer states"},
        {&render->buffers[BINDING_RESULTS], NEPH_BUFFER_DEVICE,
         items * sizeof(struct neph_gpu_result), "tracer results"},
        {&render->buffers[BINDING_FIRSTS], NEPH_BUFFER_DEVICE,
         items * sizeof(struct neph_gpu_first), "tracer first collisions"},
        {&render->buffers[BINDING_DEPTHS], NEPH_BUFFER_DEVICE, render->chunk_pixels * depths_bytes,
         "tracer depths"},
        {&render->buffers[BINDING_LITS], NEPH_BUFFER_DEVICE,
         (render->lit_tables > 0 ? render->chunk_pixels * render->lit_tables : 1) *
             sizeof(struct neph_gpu_lit_table),
         "tracer light"},
        {&render->buffers[BINDING_GUESSES], NEPH_BUFFER_DEVICE,
         (render->lit_tables > 0 && render->is_open ? render->chunk_pixels : 1) *
             sizeof(struct neph_gpu_guess),
         "tracer guesses"},
        {&render->buffers[BINDING_WAYS], NEPH_BUFFER_DEVICE,
         (render->ways > 0 ? render->chunk_pixels * render->ways : 1) * sizeof(struct neph_gpu_way),
         "tracer ways"},
        {&render->buffers[BINDING_SUN], NEPH_BUFFER_DEVICE,
         (render->has_sun_table ? sun_nodes(render) : 1) * sizeof(float), "tracer sun"},
        {&render->buffers[BINDING_CHECKS], NEPH_BUFFER_DEVICE,
         (render->has_sun_table ? items : 1) * sizeof(struct neph_gpu_sun_check),
         "tracer sun checks"},
        {&render->buffers[BINDING_LAMPS], NEPH_BUFFER_DEVICE,
         NEPH_SCENE_LIGHTS_MAX * sizeof(struct neph_gpu_lamp_sight), "tracer lamps"},
        {&render->buffers[BINDING_RAYS], NEPH_BUFFER_DEVICE,
         (render->params->rays ? render->pixel_count : 1) * sizeof(struct neph_gpu_own_ray),
         "tracer rays"},
        {&render->buffers[BINDING_QUEUES], NEPH_BUFFER_DEVICE, queues * sizeof(uint32_t),
         "tracer queues"},
        {&render->buffers[BINDING_PROGRESS], NEPH_BUFFER_DEVICE, sizeof(struct neph_gpu_progress),
         "tracer progress"},
        {&render->progress_readback, NEPH_BUFFER_READBACK, sizeof(struct neph_gpu_progress),
         "tracer progress readback"},
    };
    const enum neph_status status = neph_tracer_parts_create(
        render->vulkan, render->pixel_count, render->chunk_pixels, render->params->part_pixels,
        &render->parts, diag);
    return status ? status
                  : neph_buffers_create(render->vulkan, rows, sizeof(rows) / sizeof(rows[0]), diag);
}

/* Resume from the checkpoint, if there is one. */
static enum neph_status load_checkpoint(struct render *render, struct neph_diag *diag)
{
    const char *checkpoint = render->params->checkpoint;
    if (!checkpoint || !neph_path_exists(checkpoint))
        return NEPH_OK;
    const size_t count = neph_tracer_sums_count(&render->sums);
    double *values = malloc(count * sizeof(*values));
    if (!values)
        return neph_fail_memory(diag);
    enum neph_status status = neph_checkpoint_read(checkpoint, render->identity, values, count,
                                                   diag);
    if (!status) {
        neph_tracer_sums_load(&render->sums, values);
        status = neph_tracer_parts_upload(render->vulkan, &render->parts, render->sums.pixels,
                                          diag);
    }
    free(values);
    return status;
}

/* 1 / the square of the largest radiance or irradiance of a light, so that fourth powers of
 * radiances stay within float32. */
static double choose_noise_scale(const struct neph_scene *scene)
{
    double brightest = scene->sun.present ? max_channel(scene->sun.irradiance_w_per_m2) : 0.0;
    brightest = fmax(brightest, max_channel(scene->background_w_per_m2_sr));
    for (int i = 0; i < scene->light_count; i++)
        brightest = fmax(brightest, max_channel(scene->lights[i].intensity_w_per_sr));
    for (int m = 0; m < scene->medium_count; m++)
        brightest = fmax(brightest, max_channel(neph_medium_glow(&scene->media[m])));
    return brightest > 0.0 ? 1.0 / (brightest * brightest) : 1.0;
}

static enum neph_status create_sums(struct render *render, const struct neph_scene *scene,
                                    struct neph_diag *diag)
{
    render->sums.pixel_count = render->pixel_count;
    render->sums.is_sobol = render->params->sobol;
    render->sums.noise_scale = choose_noise_scale(scene);
    render->sums.pixels = calloc(render->pixel_count, sizeof(*render->sums.pixels));
    render->identity = make_render_identity(scene, render->params, render->vulkan);
    return render->sums.pixels && render->identity ? load_checkpoint(render, diag)
                                                   : neph_fail_memory(diag);
}

/* Choose the size of a chunk. The threads of a dispatch are the samples of its pixels, or the edges
 * of their tables. */
static size_t choose_chunk(const struct render *render)
{
    const size_t samples = (size_t)render->most_batches * NEPH_TRACER_BATCH_SAMPLES;
    const size_t edges = render->lit_tables * NEPH_GPU_LIT_EDGES;
    const size_t groups = render->vulkan->limits.maxComputeWorkGroupCount[0];
    const size_t limits[] = {
        render->pixel_count,
        render->sizes.chunk_items / samples,
        groups * pixel_local_size / (samples > edges ? samples : edges),
        render->params->part_pixels > 0 ? render->params->part_pixels : SIZE_MAX,
    };
    size_t pixels = limits[0];
    for (size_t i = 1; i < sizeof(limits) / sizeof(limits[0]); i++)
        pixels = limits[i] < pixels ? limits[i] : pixels;
    return pixels;
}

/* Choose the sizes of rounds. Without an early stop they have the maximum size; otherwise the first
 * is short. */
static void choose_sizes(struct render *render)
{
    const struct neph_tracer_params *params = render->params;
    const int batches = 1 + (params->samples - 1) / NEPH_TRACER_BATCH_SAMPLES;
    const bool is_open_ended = params->target_error > 0.0 || params->time_limit_s < INFINITY ||
                               params->checkpoint;
    render->sizes = render->vulkan->description.is_cpu ? cpu_sizes : gpu_sizes;
    render->most_batches = batches < round_batches_max ? batches : round_batches_max;
    render->round_batches = is_open_ended ? 1 : render->most_batches;
    render->round_max_s = is_open_ended ? 1.0 : INFINITY;
    render->window = render->sizes.first_window;
    render->chunk_pixels = choose_chunk(render);
}

static void scatter_nothing(struct neph_gpu_frame *frame)
{
    for (uint32_t m = 0; m < frame->medium_count; m++)
        memset(frame->media[m].albedo, 0, sizeof(frame->media[m].albedo));
}

/* --- the table of sunlight ------------------------------------------------------------------- */

/* The largest grid of cubic cells with at most `nodes` nodes. */
static void sun_table_size(const struct neph_bounds *box, int nodes, uint32_t size[3])
{
    int fits = 2, beyond = nodes;
    while (beyond - fits > 1) {
        const int middle = fits + (beyond - fits) / 2;
        neph_lattice_nodes(box, middle, size);
        const double count = (double)size[0] * size[1] * size[2];
        if (count <= nodes)
            fits = middle;
        else
            beyond = middle;
    }
    neph_lattice_nodes(box, fits, size);
}

/* The largest optical depth between two nodes, in the densest medium. */
static double depth_between_nodes(const struct neph_scene *scene, const struct neph_bounds *box,
                                  const uint32_t size[3])
{
    double sides_m[3], spacing_m = 0.0, largest_per_m = 0.0;
    neph_lattice_sides_m(box, sides_m);
    for (int axis = 0; axis < 3; axis++)
        spacing_m = fmax(spacing_m, sides_m[axis] / (size[axis] - 1));
    for (int i = 0; i < scene->medium_count; i++)
        if (!neph_medium_is_fog(&scene->media[i]))
            largest_per_m = fmax(largest_per_m, neph_gpu_largest_per_m(&scene->media[i]));
    return largest_per_m * spacing_m;
}

/* Place the sunlight table. Used only for multiple scattering of sunlight in grey bounded media
 * with closed-form optical depths: only there it saves time, and its error can be estimated. */
static bool place_sun_table(const struct render *render, const struct neph_scene *scene)
{
    const double coarsest = 8.0; /* with coarser cells its noise costs more than its speed gains */
    struct neph_bounds box;
    uint32_t size[3];
    if (render->params->sun_nodes == 0 || render->is_open || !scene->sun.present ||
        scene->light_count > 0 || scene->scattering != NEPH_SCATTERING_MULTIPLE ||
        (render->scene.constants[1] & NEPH_GPU_COLOURED) || !neph_find_media_bounds(scene, &box) ||
        neph_lattice_check(&box, "", "", NULL))
        return false;
    sun_table_size(&box, render->params->sun_nodes, size);
    if (depth_between_nodes(scene, &box, size) > coarsest)
        return false;
    neph_lattice_place(&box, neph_scene_camera(scene, render->params->frame).position_m, size, 1,
                       &render->scene.frame->sun_lattice);
    return true;
}

/* --- creation -------------------------------------------------------------------------------- */

/* Refuse scenes that exceed the limit of loop iterations. The kernel of first collisions passes the
 * grids three times, the kernel of paths never. Each edge of a segment may cost one extra
 * iteration, and so may the end of the walk. */
static enum neph_status check_turns(const struct render *render, struct neph_diag *diag)
{
    const uint64_t turns = 3 * render->scene.optical_depth_iterations +
                           3 * NEPH_GPU_WAY_STRETCHES * render->ways +
                           4 * render->scene.solid_iterations + 64;
    if (turns > NEPH_KERNEL_LOOP_ITERATIONS_MAX)
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "tracer: the voxel grids are too fine: a ray may take %llu loop "
                         "iterations, the limit of a kernel is %d",
                         (unsigned long long)turns, NEPH_KERNEL_LOOP_ITERATIONS_MAX);
    return NEPH_OK;
}

static enum neph_status upload_lamp_sights(struct render *render, const struct neph_scene *scene,
                                           struct neph_diag *diag)
{
    const struct neph_tracer_params *params = render->params;
    const struct neph_camera camera = neph_scene_camera(scene, params->frame);
    struct neph_gpu_lamp_sight sights[NEPH_SCENE_LIGHTS_MAX];
    for (int i = 0; i < scene->light_count; i++)
        sights[i] = neph_project_light(&camera, params->width_px, params->height_px,
                                       scene->lights[i].position_m);
    return scene->light_count == 0
               ? NEPH_OK
               : neph_buffer_upload(render->vulkan, &render->buffers[BINDING_LAMPS], 0, sights,
                                    (size_t)scene->light_count * sizeof(sights[0]), diag);
}

/* Upload the caller's rays. */
static enum neph_status upload_rays(const struct render *render, const struct neph_scene *scene,
                                    struct neph_diag *diag)
{
    const double *from = render->params->rays;
    const struct neph_vec3 camera_m = neph_scene_camera(scene, render->params->frame).position_m;
    if (!from)
        return NEPH_OK;
    struct neph_gpu_own_ray *rays = calloc(render->pixel_count, sizeof(*rays));
    if (!rays)
        return neph_fail_memory(diag);
    for (size_t i = 0; i < render->pixel_count; i++, from += 6) {
        neph_relative_position(rays[i].origin_m, (struct neph_vec3){from[0], from[1], from[2]},
                               camera_m);
        for (int axis = 0; axis < 3; axis++)
            rays[i].direction[axis] = (float)from[3 + axis];
    }
    const enum neph_status status = neph_buffer_upload(render->vulkan,
                                                       &render->buffers[BINDING_RAYS], 0, rays,
                                                       render->pixel_count * sizeof(*rays), diag);
    free(rays);
    return status;
}

static enum neph_status prepare(struct render *render, const struct neph_scene *scene,
                                struct neph_diag *diag)
{
    const struct neph_tracer_params *params = render->params;
    render->pixel_count = (size_t)params->width_px * (size_t)params->height_px;
    render->viewed_first = SIZE_MAX;
    render->turns = choose_turns(scene, params, render->vulkan->description.is_cpu);
    render->needs_paths = needs_paths(scene);
    render->is_open = is_open(scene);
    render->lit_tables = lit_tables(scene);
    choose_sizes(render);
    enum neph_status status = neph_gpu_scene_create(render->vulkan, scene, params->frame,
                                                    params->width_px, params->height_px,
                                                    needs_paths(scene), &render->scene, diag);
    if (!status) {
        render->ways = ways(scene, render->scene.frame);
        render->has_sun_table = place_sun_table(render, scene);
        status = check_turns(render, diag);
    }
    if (!status && scene->scattering == NEPH_SCATTERING_NONE)
        scatter_nothing(render->scene.frame);
    if (render->params->rays)
        render->scene.constants[1] |= NEPH_GPU_OWN_RAYS;
    if (!status)
        status = get_kernels(render, scene, diag);
    if (!status)
        status = create_buffers(render, diag);
    if (!status)
        status = upload_lamp_sights(render, scene, diag);
    if (!status)
        status = upload_rays(render, scene, diag);
    if (!status)
        status = create_sums(render, scene, diag);
    return status;
}

static void finish(struct render *render)
{
    neph_gpu_scene_destroy(render->vulkan, &render->scene);
    for (int i = 0; i < BINDING_COUNT; i++)
        neph_buffer_destroy(render->vulkan, &render->buffers[i]);
    neph_tracer_parts_destroy(render->vulkan, &render->parts);
    neph_buffer_destroy(render->vulkan, &render->progress_readback);
    free(render->sums.pixels);
    free(render->identity);
}

/* --- dispatches --------------------------------------------------------------------------- */

static enum neph_status run_kernel(struct render *render, const struct neph_kernel *kernel,
                                   struct neph_gpu_tracer_run run, uint32_t group_count,
                                   const struct neph_buffer *progress, struct neph_diag *diag)
{
    if (neph_interrupted())
        return neph_fail(diag, NEPH_ERR_INTERRUPTED, "tracer: interrupted");
    struct neph_dispatch dispatch = {
        .push = &run,
        .group_count = group_count,
        .copy_from = &render->buffers[BINDING_PROGRESS],
        .copy_to = progress,
        .copy_size_bytes = progress ? progress->size_bytes : 0,
    };
    neph_gpu_scene_bind(&render->scene, &dispatch);
    for (int i = NEPH_GPU_SCENE_BUFFERS; i < BINDING_COUNT; i++)
        dispatch.buffers[i] = &render->buffers[i];
    dispatch.buffers[BINDING_PIXELS] = neph_tracer_find_part(&render->parts, run.first_pixel,
                                                             &run.part_pixel);
    double gpu_s;
    const enum neph_status status = neph_kernel_run(render->vulkan, kernel, &dispatch, &gpu_s,
                                                    diag);
    if (status)
        return status;
    render->stats.gpu_s += gpu_s;
    render->stats.dispatches++;
    return NEPH_OK;
}

static uint32_t pixel_groups(uint32_t pixel_count)
{
    return (pixel_count + pixel_local_size - 1) / pixel_local_size;
}

/* Compute the view data of a chunk, unless the device has them already. */
static enum neph_status view_chunk(struct render *render, const struct neph_gpu_tracer_run *run,
                                   struct neph_diag *diag)
{
    if (render->viewed_first == run->first_pixel)
        return NEPH_OK;
    enum neph_status status = run_kernel(render, render->view, *run, pixel_groups(run->pixel_count),
                                         NULL, diag);
    if (!status && render->lit)
        status = run_kernel(
            render, render->lit, *run,
            pixel_groups((uint32_t)render->lit_tables * NEPH_GPU_LIT_EDGES * run->pixel_count),
            NULL, diag);
    if (status)
        return status;
    render->viewed_first = run->first_pixel;
    render->progress = (struct neph_gpu_progress){0}; /* tracer_view.comp resets it */
    return NEPH_OK;
}

/* Run one dispatch of the path kernel and add the finished items to `*items_done`. */
static enum neph_status run_window(struct render *render, const struct neph_gpu_tracer_run *run,
                                   uint32_t queue_count, uint32_t *items_done,
                                   struct neph_diag *diag)
{
    const enum neph_status status = run_kernel(render, render->path, *run, queue_count,
                                               &render->progress_readback, diag);
    if (status)
        return status;
    /* Counters increase modulo 2^32. */
    const struct neph_gpu_progress *now = render->progress_readback.mapped;
    double *head = render->round_head;
    *items_done += now->items_done - render->progress.items_done;
    head[NEPH_SUMS_COLLISIONS] += now->collisions - render->progress.collisions;
    head[NEPH_SUMS_LOOKUPS] += now->lookups - render->progress.lookups;
    head[NEPH_SUMS_CLOSED_FORMS] += now->closed_forms - render->progress.closed_forms;
    render->progress = *now;
    return NEPH_OK;
}

/* Adapt the dispatch: long enough to amortise its overhead, short enough for Ctrl-C. */
static void adapt_window(struct render *render, double dispatch_s)
{
    if (dispatch_s < 0.08 && render->window < window_queues_max)
        render->window *= 2;
    if (dispatch_s > 0.3 && render->window > 2)
        render->window /= 2;
}

/* Trace all paths of a round for the queues of the chunk. */
static enum neph_status trace_paths(struct render *render, struct neph_gpu_tracer_run run,
                                    struct neph_diag *diag)
{
    const uint32_t queues = (run.pixel_count + run.queue_pixels - 1) / run.queue_pixels;
    for (uint32_t first = 0, count; first < queues; first += count) {
        count = queues - first < render->window ? queues - first : render->window;
        const uint32_t pixels_left = run.pixel_count - first * run.queue_pixels;
        const uint32_t pixels = pixels_left < count * run.queue_pixels ? pixels_left
                                                                       : count * run.queue_pixels;
        uint32_t items_done = 0;
        run.first_queue = first;
        for (run.is_fresh = 1; items_done < pixels * run.samples; run.is_fresh = 0) {
            const double start_s = neph_wall_s();
            const enum neph_status status = run_window(render, &run, count, &items_done, diag);
            if (status)
                return status;
            if (run.is_fresh)
                adapt_window(render, neph_wall_s() - start_s);
        }
    }
    return NEPH_OK;
}

static enum neph_status trace_chunk(struct render *render, const struct neph_gpu_tracer_run *run,
                                    struct neph_diag *diag)
{
    enum neph_status status = view_chunk(render, run, diag);
    if (!status && render->first)
        status = run_kernel(render, render->first, *run,
                            pixel_groups(run->pixel_count * run->samples), NULL, diag);
    if (!status && render->needs_paths)
        status = trace_paths(render, *run, diag);
    if (!status && render->check)
        status = run_kernel(
            render, render->check, *run,
            pixel_groups(run->pixel_count * (run->samples / NEPH_TRACER_BATCH_SAMPLES)), NULL,
            diag);
    if (!status)
        status = run_kernel(render, render->sum, *run, pixel_groups(run->pixel_count), NULL, diag);
    return status;
}

/* Pixels of a queue; fewer when a small frame would otherwise have too few work groups. */
static uint32_t queue_pixels(const struct render *render, uint32_t samples)
{
    const uint32_t wanted = render->sizes.queue_items / samples;
    const uint32_t most = (uint32_t)render->chunk_pixels / render->sizes.least_queues;
    return wanted < most ? wanted : most > 1 ? most : 1;
}

static struct neph_gpu_tracer_run chunk_run(const struct render *render, size_t first, int batches)
{
    const size_t left = render->pixel_count - first;
    const uint32_t samples = (uint32_t)(batches * NEPH_TRACER_BATCH_SAMPLES);
    return (struct neph_gpu_tracer_run){
        .seed_low = (uint32_t)render->params->seed,
        .seed_high = (uint32_t)(render->params->seed >> 32),
        .first_pixel = (uint32_t)first,
        .pixel_count = (uint32_t)(left < render->chunk_pixels ? left : render->chunk_pixels),
        .first_sample = (uint32_t)render->sums.head[NEPH_SUMS_SAMPLES],
        .samples = samples,
        .queue_pixels = queue_pixels(render, samples),
        .turns = render->turns,
        .noise_scale = (float)render->sums.noise_scale,
    };
}

static enum neph_status read_back(struct render *render, struct neph_diag *diag)
{
    return neph_tracer_parts_download(render->vulkan, &render->parts, render->sums.pixels, diag);
}

/* For a checkpoint that already has all samples. */
static enum neph_status view_all(struct render *render, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (size_t first = 0; !status && first < render->pixel_count; first += render->chunk_pixels) {
        const struct neph_gpu_tracer_run run = chunk_run(render, first, 1);
        status = view_chunk(render, &run, diag);
    }
    return status;
}

/* Trace a round. The sums are read back only if a checkpoint or an early stop may need them. */
static enum neph_status trace_round(struct render *render, int batches, struct neph_diag *diag)
{
    const struct neph_tracer_params *params = render->params;
    enum neph_status status = NEPH_OK;
    memset(render->round_head, 0, sizeof(render->round_head));
    for (size_t first = 0; !status && first < render->pixel_count; first += render->chunk_pixels) {
        const struct neph_gpu_tracer_run run = chunk_run(render, first, batches);
        status = trace_chunk(render, &run, diag);
    }
    if (!status)
        status = neph_gpu_scene_check(render->vulkan, &render->scene, diag);
    if (!status && (params->checkpoint || params->target_error > 0.0))
        status = read_back(render, diag);
    if (status)
        return status;
    render->round_head[NEPH_SUMS_SAMPLES] = batches * NEPH_TRACER_BATCH_SAMPLES;
    for (int i = 0; i < NEPH_SUMS_HEAD; i++)
        render->sums.head[i] += render->round_head[i];
    return NEPH_OK;
}

/* --- progress ----------------------------------------------------------------------------- */

/* Save the complete rounds: sums of an interrupted round have not been read back. */
static enum neph_status save_checkpoint(const struct render *render, struct neph_diag *diag)
{
    if (!render->params->checkpoint)
        return NEPH_OK;
    const size_t count = neph_tracer_sums_count(&render->sums);
    double *values = malloc(count * sizeof(*values));
    if (!values)
        return neph_fail_memory(diag);
    neph_tracer_sums_save(&render->sums, values);
    const enum neph_status status = neph_checkpoint_write(render->params->checkpoint,
                                                          render->identity, values, count, diag);
    free(values);
    return status;
}

/* With fewer paths per pixel their variance cannot be estimated. */
static const double samples_min = 16.0;

static bool is_done(struct render *render, double batch_s)
{
    const struct neph_tracer_params *params = render->params;
    const double samples = render->sums.head[NEPH_SUMS_SAMPLES];
    if (samples <= 0.0)
        return false;
    if (samples >= params->samples)
        return true;
    if (params->target_error > 0.0 && samples >= samples_min &&
        neph_tracer_sums_error(&render->sums, render->is_lit) <= params->target_error)
        return true;
    return neph_wall_s() - render->start_s + batch_s > params->time_limit_s;
}

/* By the measured time: twice the last number, half of it, or equal. */
static int batches_in_time(const struct render *render, double batch_s)
{
    const int last = render->round_batches;
    if (2.0 * last * batch_s < render->round_max_s && batch_s > 0.0)
        return 2 * last <= render->most_batches ? 2 * last : last;
    return last > 1 && last * batch_s > render->round_max_s ? last / 2 : last;
}

/* With a target error, by the number of samples so far: a repeated render must stop at the same
 * sample. */
static int batches_on_target(const struct render *render)
{
    const double batches = render->sums.head[NEPH_SUMS_SAMPLES] / NEPH_TRACER_BATCH_SAMPLES;
    return (int)fmax(1.0, fmin(batches / 4.0, render->most_batches));
}

/* Choose the batches of the next round, within the time limit. */
static int choose_batches(struct render *render, double batch_s)
{
    const struct neph_tracer_params *params = render->params;
    const double samples_left = params->samples - render->sums.head[NEPH_SUMS_SAMPLES];
    const double time_left_s = params->time_limit_s - (neph_wall_s() - render->start_s);
    const int left = (int)ceil(samples_left / NEPH_TRACER_BATCH_SAMPLES);
    int batches = params->target_error > 0.0 ? batches_on_target(render)
                                             : batches_in_time(render, batch_s);
    while (batches > 1 && batches * batch_s > time_left_s)
        batches /= 2;
    render->round_batches = batches;
    return batches < left ? batches : left;
}

static enum neph_status trace_rounds(struct render *render, struct neph_diag *diag)
{
    const double save_every_s = 60.0;
    double saved_s = neph_wall_s();
    for (double batch_s = 0.0; !is_done(render, batch_s);) {
        const double start_s = neph_wall_s();
        const int batches = choose_batches(render, batch_s);
        enum neph_status status = trace_round(render, batches, diag);
        batch_s = (neph_wall_s() - start_s) / batches;
        if (!status && neph_wall_s() - saved_s > save_every_s) {
            status = save_checkpoint(render, diag);
            saved_s = neph_wall_s();
        }
        if (status)
            return status;
    }
    return NEPH_OK;
}

static enum neph_status fill_sun_table(struct render *render, struct neph_diag *diag)
{
    const struct neph_gpu_tracer_run run = chunk_run(render, 0, 1);
    return render->sun ? run_kernel(render, render->sun, run,
                                    pixel_groups((uint32_t)sun_nodes(render)), NULL, diag)
                       : NEPH_OK;
}

static enum neph_status trace(struct render *render, struct neph_diag *diag)
{
    const bool is_whole = is_done(render, 0.0);
    enum neph_status status = is_whole ? view_all(render, diag) : fill_sun_table(render, diag);
    if (!status && !is_whole)
        status = trace_rounds(render, diag);
    if (!status)
        status = read_back(render, diag);
    if (!status)
        return save_checkpoint(render, diag);
    if (status == NEPH_ERR_INTERRUPTED && render->sums.head[NEPH_SUMS_SAMPLES] > 0.0 &&
        save_checkpoint(render, NULL))
        return neph_fail(diag, NEPH_ERR_IO, "tracer: interrupted, and cannot write '%s'",
                         render->params->checkpoint);
    return status;
}

/* --- entry point -------------------------------------------------------------------------- */

static void count(struct render *render)
{
    const double *head = render->sums.head;
    struct neph_tracer_stats *stats = &render->stats;
    stats->samples = (int)head[NEPH_SUMS_SAMPLES];
    stats->collisions = (uint64_t)head[NEPH_SUMS_COLLISIONS];
    stats->lookups = (uint64_t)head[NEPH_SUMS_LOOKUPS];
    stats->closed_forms = (uint64_t)head[NEPH_SUMS_CLOSED_FORMS];
    stats->error = neph_tracer_sums_error(&render->sums, render->is_lit);
    stats->doubt = neph_tracer_sums_doubt(&render->sums);
    stats->wall_s = neph_wall_s() - render->start_s;
}

enum neph_status neph_tracer_render(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                    const struct neph_tracer_params *params,
                                    struct neph_image **frame, struct neph_tracer_stats *stats,
                                    struct neph_diag *diag)
{
    enum neph_status status = check(scene, params, diag);
    if (status)
        return status;
    struct render render = {.vulkan = vulkan,
                            .params = params,
                            .start_s = neph_wall_s(),
                            .is_lit = scene->scattering != NEPH_SCATTERING_NONE};
    struct neph_image *image = NULL;
    status = prepare(&render, scene, diag);
    if (!status)
        status = trace(&render, diag);
    if (!status)
        status = neph_tracer_sums_frame(&render.sums, render.is_open, params->width_px,
                                        params->height_px, &image, diag);
    if (!status)
        status = neph_vulkan_check(vulkan, diag);
    if (!status) {
        count(&render);
        *frame = image;
        if (stats)
            *stats = render.stats;
    } else {
        neph_image_destroy(image);
    }
    finish(&render);
    return status;
}
