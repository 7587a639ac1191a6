/* SPDX-License-Identifier: MIT */
#include "renderer/march.h"

#include "base/clock.h"
#include "renderer/float32_range.h"
#include "renderer/in_flight.h"
#include "renderer/march_scene.h"
#include "renderer/march_split.h"
#include "renderer/shortcuts.h"
#include "renderer/sky/split.h"
#include "scenes/emission.h"
#include "scenes/fog_translation.h"
#include "scenes/lights.h"
#include "scenes/media.h"
#include "scenes/phase_colour.h"
#include "scenes/phase_same.h"
#include "scenes/surfaces.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Does not compile with a new kind: this file then needs a change. */
_Static_assert(NEPH_MARCH_LIGHTING_COUNT == 8, "a new kind");
_Static_assert(NEPH_MEDIUM_KIND_COUNT == 8, "a new kind");
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");

static const uint32_t march_code[] = {
#include "shaders/march.comp.inc"
};

/* --- supported scenes --------------------------------------------------------------------- */

static bool is_positive(struct neph_rgb rgb)
{
    return rgb.r > 0.0 || rgb.g > 0.0 || rgb.b > 0.0;
}

/* Whether the background lights any solid or medium. */
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

/* Paths of traced light start in media, so it does not light solids. */
static const char *find_obstacle_to_traced(const struct neph_scene *scene)
{
    for (int i = 0; i < scene->medium_count; i++)
        if (neph_medium_is_coloured(&scene->media[i]))
            return "extinction that differs between the channels: traced light has one opacity";
    if (neph_scene_emits(scene))
        return neph_emission_reason;
    for (int i = 0; i < scene->solid_count && scene->environment_light; i++)
        if (is_positive(scene->solids[i].albedo) && is_positive(scene->background_w_per_m2_sr))
            return "background light on solids";
    return NULL;
}

/* Diffusion is solved once for all channels, in cells that are inside or outside solids. */
static const char *find_obstacle_to_diffused(const struct neph_scene *scene)
{
    if (neph_mesh_obstacle(scene))
        return "triangle meshes: cells of diffused light are inside or outside convex solids";
    if (neph_scene_is_endless(scene))
        return neph_endless_reason;
    for (int i = 0; i < scene->medium_count; i++) {
        const struct neph_rgb albedo = scene->media[i].albedo;
        if (neph_medium_is_coloured(&scene->media[i]))
            return "extinction that differs between the channels: diffusion is solved once for all "
                   "channels";
        if (neph_phase_is_coloured(&scene->media[i].phase))
            return "a phase function that differs between the channels: diffusion is solved once "
                   "for all channels";
        if (albedo.r != albedo.g || albedo.g != albedo.b)
            return "an albedo that differs between the channels: diffusion is solved once for all "
                   "channels";
    }
    return NULL;
}

/* There is one table for all media. */
static const char *find_obstacle_to_slab(const struct neph_scene *scene)
{
    for (int i = 0; i < scene->medium_count; i++) {
        const struct neph_medium *own = &scene->media[i], *first = &scene->media[0];
        if (neph_medium_is_coloured(own))
            return "extinction that differs between the channels: slabs have one optical depth for "
                   "all channels";
        if (!neph_phase_is_same(&own->phase, &first->phase) || own->albedo.r != first->albedo.r ||
            own->albedo.g != first->albedo.g || own->albedo.b != first->albedo.b)
            return "media with different albedo or phase function: there is one table of slabs";
    }
    return NULL;
}

/* The first unsupported feature; NULL: none. */
static const char *find_obstacle(const struct neph_scene *scene, enum neph_march_lighting lighting)
{
    if (neph_surfaces_obstacle(scene))
        return neph_surfaces_obstacle(scene);
    if (lighting == NEPH_MARCH_SINGLE && scene->scattering == NEPH_SCATTERING_MULTIPLE)
        return "multiple scattering";
    if (lighting != NEPH_MARCH_SINGLE && scene->scattering == NEPH_SCATTERING_SINGLE)
        return "single scattering: this lighting includes all orders";
    if (lighting != NEPH_MARCH_SINGLE && scene->light_count > 0)
        return neph_lights_reason;
    for (int i = 0; lighting == NEPH_MARCH_HORIZON && i < scene->medium_count; i++)
        if (scene->media[i].kind != NEPH_MEDIUM_HORIZON)
            return "a medium other than Horizon clouds: this lighting needs their heights and "
                   "shapes";
    if (neph_scene_emits(scene) &&
        (lighting == NEPH_MARCH_HORIZON || scene->scattering == NEPH_SCATTERING_MULTIPLE))
        return neph_emission_reason;
    if (lighting == NEPH_MARCH_TRACED)
        return find_obstacle_to_traced(scene);
    if (is_lit_by_environment(scene))
        return "background light on media and solids";
    if (lighting == NEPH_MARCH_DIFFUSED)
        return find_obstacle_to_diffused(scene);
    return lighting == NEPH_MARCH_SLAB ? find_obstacle_to_slab(scene) : NULL;
}

bool neph_march_can_render(const struct neph_scene *scene, enum neph_march_lighting lighting,
                           char *reason, size_t reason_size)
{
    const char *obstacle = find_obstacle(scene, lighting);
    if (!obstacle)
        return neph_is_in_float32_range(scene, reason, reason_size);
    snprintf(reason, reason_size, "%s", obstacle);
    return false;
}

static const char *find_obstacle_to_veils(const struct neph_scene *scene,
                                          struct neph_march_veils veils,
                                          enum neph_march_lighting lighting)
{
    if (veils.sky && scene->orthographic_height_m > 0.0)
        return "an orthographic camera under sky=tables";
    if (veils.sky && veils.fog.is_look &&
        neph_fog_control_is_on(&scene->fog_look, NEPH_FOG_SKY_LIGHT))
        return "fog_look.sky_light with sky=tables: it is a part of the background, which such a "
               "scene does not have; add it to inscattering_w_per_m2_sr";
    if (lighting == NEPH_MARCH_HORIZON)
        return veils.sky ? "the lighting of Horizon clouds, which has no unit, with sky=tables"
                         : "the lighting of Horizon clouds, which has no unit, with a fog model";
    return NULL;
}

bool neph_march_remove_veils(const struct neph_scene *scene, struct neph_march_veils veils,
                             struct neph_scene *rest, char *reason, size_t reason_size)
{
    struct neph_sky_split split;
    if (veils.sky && !neph_sky_split(scene, &split, reason, reason_size))
        return false;
    if (veils.fog.is_look &&
        !neph_fog_look_can_model_fog_only(scene, veils.fog.model, reason, reason_size))
        return false;
    *rest = *scene;
    rest->borrows = true;
    if (veils.sky)
        *rest = neph_sky_remove_air(rest, &split);
    if (veils.fog.is_look)
        *rest = neph_fog_look_remove_fog(rest);
    return true;
}

bool neph_march_can_render_with(const struct neph_scene *scene, struct neph_march_veils veils,
                                enum neph_march_lighting lighting, char *reason, size_t reason_size)
{
    struct neph_scene rest;
    if (!veils.sky && !veils.fog.is_look)
        return neph_march_can_render(scene, lighting, reason, reason_size);
    if (!neph_march_remove_veils(scene, veils, &rest, reason, reason_size))
        return false;
    const char *obstacle = find_obstacle_to_veils(scene, veils, lighting);
    if (!obstacle)
        return neph_march_can_render(&rest, lighting, reason, reason_size);
    snprintf(reason, reason_size, "%s", obstacle);
    return false;
}

static enum neph_status check_range(const char *name, int value, int maximum,
                                    struct neph_diag *diag)
{
    if (value >= 1 && value <= maximum)
        return NEPH_OK;
    return neph_fail(diag, NEPH_ERR_USAGE, "march: %s is %d, outside 1..%d", name, value, maximum);
}

static enum neph_status check_real(const char *name, double value, double maximum,
                                   struct neph_diag *diag)
{
    if (value >= 0.0 && value <= maximum)
        return NEPH_OK;
    return neph_fail(diag, NEPH_ERR_USAGE, "march: %s is %g, outside 0..%g", name, value, maximum);
}

static enum neph_status check_light(const struct neph_light_paths *light, struct neph_diag *diag)
{
    enum neph_status status = check_range("light_texel_px", light->texel_px,
                                          NEPH_LIGHT_TEXEL_PX_MAX, diag);
    if (!status)
        status = check_range("light_paths", light->paths, NEPH_LIGHT_PATHS_MAX, diag);
    if (!status)
        status = check_range("light_rounds", light->rounds, NEPH_LIGHT_ROUNDS_MAX, diag);
    if (!status)
        status = check_range("light_memory", light->memory, NEPH_LIGHT_MEMORY_MAX, diag);
    if (!status)
        status = check_real("light_blur", light->blur_texels, NEPH_LIGHT_BLUR_MAX, diag);
    return status ? status : check_real("light_similar", light->similar, 1.0, diag);
}

static enum neph_status check_diffusion(const struct neph_light_diffusion *diffusion,
                                        struct neph_diag *diag)
{
    if (diffusion->cells < NEPH_DIFFUSION_CELLS_MIN || diffusion->cells > NEPH_DIFFUSION_CELLS_MAX)
        return neph_fail(diag, NEPH_ERR_USAGE, "march: diffusion_cells is %d, outside %d..%d",
                         diffusion->cells, NEPH_DIFFUSION_CELLS_MIN, NEPH_DIFFUSION_CELLS_MAX);
    return check_range("diffusion_cycles", diffusion->cycles, NEPH_DIFFUSION_CYCLES_MAX, diag);
}

static bool looks_ahead(const struct neph_march_params *params)
{
    return params->lighting == NEPH_MARCH_TRACED && params->light.looks_ahead;
}

/* Refuse unbounded media with tables over the bounds of all media. */
static enum neph_status check_tables_bounded(const struct neph_scene *scene,
                                             const struct neph_march_params *params,
                                             struct neph_diag *diag)
{
    const struct neph_shortcuts *shortcuts = &params->shortcuts;
    const struct {
        bool is_chosen;
        const char *setting;
    } tables[] = {
        {shortcuts->sun_cache, "sun_cache=grid"},
        {shortcuts->cloud_shadow, "cloud_shadow=map"},
        {shortcuts->grid_texture, "grid_sampling=texture"},
        {looks_ahead(params), "light_ahead"},
    };
    for (size_t i = 0; i < sizeof(tables) / sizeof(tables[0]); i++)
        if (tables[i].is_chosen && neph_scene_is_endless(scene))
            return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "march: %s cannot have %s",
                             tables[i].setting, neph_endless_reason);
    return NEPH_OK;
}

enum neph_status neph_march_check(const struct neph_scene *scene,
                                  const struct neph_march_params *params, struct neph_diag *diag)
{
    enum neph_status status = check_range("width", params->width_px, NEPH_MARCH_SIDE_MAX_PX, diag);
    if (!status)
        status = check_range("height", params->height_px, NEPH_MARCH_SIDE_MAX_PX, diag);
    if (!status)
        status = check_range("steps", params->steps, NEPH_MARCH_STEPS_MAX, diag);
    if (!status && neph_march_has_sun_rays(scene, params))
        status = check_range("sun_steps", params->sun_steps, NEPH_MARCH_STEPS_MAX, diag);
    if (status)
        return status;
    if ((uint64_t)params->steps * (uint64_t)(1 + neph_march_sun_steps(scene, params)) >
        UINT32_MAX / 2)
        return neph_fail(diag, NEPH_ERR_USAGE,
                         "march: %d steps of %d sun steps each exceed the counter of a pixel",
                         params->steps, params->sun_steps);
    status = neph_shortcuts_check(params, diag);
    if (!status && params->lighting == NEPH_MARCH_TRACED)
        status = check_light(&params->light, diag);
    if (!status && (params->lighting == NEPH_MARCH_DIFFUSED || looks_ahead(params)))
        status = check_diffusion(&params->diffusion, diag);
    if (status)
        return status;
    status = check_tables_bounded(scene, params, diag);
    if (status)
        return status;
    char reason[256];
    const struct neph_march_veils veils = {params->sky.is_on, params->fog};
    if (!neph_march_can_render_with(scene, veils, params->lighting, reason, sizeof(reason)))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "march: cannot: %s", reason);
    return NEPH_OK;
}

/* --- order of rays ------------------------------------------------------------------------ */

enum { square_px = 8 }; /* a work group of shaders/march.comp */

static uint64_t count_squares(int side_px)
{
    return ((uint64_t)side_px + square_px - 1) / square_px;
}

static uint64_t count_rays(const struct neph_march_params *params)
{
    return count_squares(params->width_px) * count_squares(params->height_px) * square_px *
           square_px;
}

/* The pixel of a ray: squares in raster order, and in a square by the bits of the ray's index, as
 * in shaders/march.comp. -1: outside the image. */
static int64_t find_ray_pixel(const struct neph_march_params *params, uint64_t ray)
{
    const uint64_t side = square_px, columns = count_squares(params->width_px);
    const uint64_t square = ray / (side * side), own = ray % (side * side);
    const uint64_t x = side * (square % columns) + ((own & 3) | (own >> 1 & 4));
    const uint64_t y = side * (square / columns) + ((own >> 2 & 1) | (own >> 3 & 6));
    return x < (uint64_t)params->width_px && y < (uint64_t)params->height_px
               ? (int64_t)(y * (uint64_t)params->width_px + x)
               : -1;
}

/* --- the ray marcher ---------------------------------------------------------------------- */

struct neph_march {
    struct neph_vulkan *vulkan; /* borrowed */
    struct neph_march_params params;
    struct neph_march_split cut;
    struct neph_march_scene scene;
    struct neph_buffer pixels, states, readback;
    struct neph_in_flight flight;
    double flights_gpu_s[NEPH_IN_FLIGHT_FRAMES];            /* dispatches of the frames in flight */
    struct neph_sun_fill_cost fills[NEPH_IN_FLIGHT_FRAMES]; /* fillings before them */
    double lights_gpu_s[NEPH_IN_FLIGHT_FRAMES];             /* traced light before them */
    double places_gpu_s[NEPH_IN_FLIGHT_FRAMES];             /* copies of places of meshes */
    struct neph_sky_times skies[NEPH_IN_FLIGHT_FRAMES];     /* tables of the sky before them */
    int home_slot;
};

static enum neph_status create_buffers(struct neph_march *march, struct neph_diag *diag)
{
    const size_t pixels_bytes = march->cut.rays_max * sizeof(struct neph_gpu_march_pixel);
    const size_t states_bytes = march->cut.rays_max * NEPH_MARCH_STATE_BYTES;
    const struct neph_buffer_row rows[] = {
        {&march->pixels, NEPH_BUFFER_DEVICE, pixels_bytes, "march pixels"},
        {&march->states, NEPH_BUFFER_DEVICE, states_bytes, "march states"},
        {&march->readback, NEPH_BUFFER_READBACK, pixels_bytes, "march readback"},
    };
    return neph_buffers_create(march->vulkan, rows, sizeof(rows) / sizeof(rows[0]), diag);
}

enum neph_status neph_march_create(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                   const struct neph_march_params *params,
                                   struct neph_march **march, struct neph_diag *diag)
{
    enum neph_status status = neph_march_check(scene, params, diag);
    if (status)
        return status;
    struct neph_march *made = calloc(1, sizeof(*made));
    if (!made)
        return neph_fail_memory(diag);
    made->vulkan = vulkan;
    made->params = *params;
    status = neph_march_scene_create(vulkan, scene, params, &made->scene, diag);
    if (!status)
        status = neph_march_split_make(vulkan, scene, &made->scene.gpu, params, count_rays(params),
                                       &made->cut, diag);
    if (!status)
        status = create_buffers(made, diag);
    if (status)
        neph_march_destroy(made);
    else
        *march = made;
    return status;
}

void neph_march_destroy(struct neph_march *march)
{
    if (!march)
        return;
    neph_buffer_destroy(march->vulkan, &march->readback);
    neph_buffer_destroy(march->vulkan, &march->states);
    neph_buffer_destroy(march->vulkan, &march->pixels);
    neph_march_scene_destroy(march->vulkan, &march->scene);
    free(march);
}

/* --- frames ------------------------------------------------------------------------------- */

/* The channels of the frame; they point into the image. */
struct layers {
    float *radiance[3], *volume[3], *transmittance[3], *eye_depth_m;
    float *volume_distance_m; /* NULL: nothing was marched */
};

static enum neph_status create_image(const struct neph_march *march, struct neph_image **image,
                                     struct layers *layers, struct neph_diag *diag)
{
    struct neph_image *created;
    enum neph_status status = neph_image_create(march->params.width_px, march->params.height_px,
                                                &created, diag);
    if (status)
        return status;
    *layers = (struct layers){.eye_depth_m = NULL};
    status = neph_image_add_rgb(created, NULL, layers->radiance, diag);
    if (!status)
        status = neph_image_add_rgb(created, "volume", layers->volume, diag);
    if (!status)
        status = neph_image_add_rgb(created, "transmittance", layers->transmittance, diag);
    if (!status)
        status = neph_image_add_channel(created, "Z", &layers->eye_depth_m, diag);
    const struct neph_gpu_frame *frame = march->scene.gpu.frame;
    if (!status && (frame->scatters || frame->scatters_lamps || frame->emits))
        status = neph_image_add_channel(created, "volume.distance", &layers->volume_distance_m,
                                        diag);
    if (status) {
        neph_image_destroy(created);
        return status;
    }
    *image = created;
    return NEPH_OK;
}

static float convert_distance_m(float distance_m)
{
    return distance_m < NEPH_GPU_FAR_M ? distance_m : INFINITY;
}

static void unpack(const struct neph_gpu_march_pixel *pixel, size_t index,
                   const struct layers *layers, struct neph_march_stats *stats)
{
    for (int c = 0; c < 3; c++) {
        layers->radiance[c][index] = pixel->radiance[c];
        layers->volume[c][index] = pixel->volume[c];
        layers->transmittance[c][index] = pixel->transmittance[c];
    }
    layers->eye_depth_m[index] = convert_distance_m(pixel->eye_depth_m);
    if (layers->volume_distance_m)
        layers->volume_distance_m[index] = convert_distance_m(pixel->volume_distance_m);
    stats->density_evaluations += pixel->density_evaluations;
    stats->closed_forms += pixel->closed_forms;
    stats->view_steps += pixel->view_steps;
}

/* The work of a frame. */
struct work {
    struct neph_march *march;
    const struct neph_kernel *kernel;
    bool is_read; /* finished rays are read back into the layers */
    struct layers layers;
    struct neph_march_stats stats;
    double *gpu_s;                     /* borrowed; one of neph_march.flights_gpu_s */
    struct neph_march_scene_cost cost; /* work before the march */
};

static struct neph_dispatch make_march_dispatch(const struct neph_march *march,
                                                const struct neph_gpu_march_run *run)
{
    struct neph_dispatch dispatch = {
        .push = run,
        .group_count = (run->ray_count + NEPH_MARCH_LOCAL_SIZE - 1) / NEPH_MARCH_LOCAL_SIZE,
    };
    neph_march_scene_bind(&march->scene, &dispatch);
    dispatch.buffers[NEPH_GPU_SCENE_BUFFERS] = &march->states;
    dispatch.buffers[NEPH_GPU_SCENE_BUFFERS + 1] = &march->pixels;
    return dispatch;
}

static enum neph_status read_pixels(struct work *work, const struct neph_gpu_march_run *run,
                                    struct neph_diag *diag)
{
    struct neph_march *march = work->march;
    const enum neph_status status = neph_buffer_download(
        march->vulkan, &march->pixels, &march->readback,
        run->ray_count * sizeof(struct neph_gpu_march_pixel), diag);
    const struct neph_gpu_march_pixel *pixels = march->readback.mapped;
    for (uint32_t i = 0; i < run->ray_count && !status; i++) {
        const int64_t pixel = find_ray_pixel(&march->params, (uint64_t)run->first_ray + i);
        if (pixel >= 0)
            unpack(&pixels[i], (size_t)pixel, &work->layers, &work->stats);
    }
    return status;
}

/* Submit one dispatch; the last dispatch of its rays also returns the results. */
static enum neph_status submit_march_run(const struct neph_gpu_march_run *run, void *context,
                                         struct neph_diag *diag)
{
    struct work *work = context;
    struct neph_march *march = work->march;
    const struct neph_dispatch dispatch = make_march_dispatch(march, run);
    const enum neph_status status = neph_dispatch_submit(march->vulkan, work->kernel, &dispatch,
                                                         "march", work->gpu_s, diag);
    work->stats.dispatches++;
    const bool is_last = run->end_step == march->cut.step_count;
    return !status && is_last && work->is_read ? read_pixels(work, run, diag) : status;
}

static enum neph_status get_kernel(struct neph_march *march, const struct neph_kernel **kernel,
                                   struct neph_diag *diag)
{
    struct neph_kernel_params params = {
        .name = "march",
        .code = march_code,
        .code_bytes = sizeof(march_code),
        .buffer_count = NEPH_MARCH_BUFFERS,
        .uniform_count = NEPH_GPU_SCENE_UNIFORMS,
        .image_count = NEPH_GPU_MEDIA_MAX,
        .texels_first = NEPH_GPU_VALUES_BUFFER,
        .texels_count = {[1] = 1}, /* pairs */
        .push_size_bytes = sizeof(struct neph_gpu_march_run),
        .constant_count = NEPH_MARCH_CONSTANTS,
    };
    neph_march_constants(&march->scene.gpu, &march->params, params.constants);
    return neph_kernel_get(march->vulkan, &params, kernel, diag);
}

/* Submit all dispatches of a frame. */
static enum neph_status submit_march_frame(struct neph_march *march, struct work *work,
                                           struct neph_diag *diag)
{
    enum neph_status status = get_kernel(march, &work->kernel, diag);
    if (!status)
        status = neph_march_split_run(&march->cut, submit_march_run, work, diag);
    if (!status)
        status = neph_vulkan_check(march->vulkan, diag);
    if (!status)
        neph_in_flight_end(march->vulkan, &march->flight);
    return status;
}

/* Render a frame into an image and wait for it. */
static enum neph_status read_frame(struct neph_march *march, struct work *work,
                                   struct neph_image **image, struct neph_diag *diag)
{
    struct neph_image *made = NULL;
    work->is_read = true;
    enum neph_status status = create_image(march, &made, &work->layers, diag);
    if (!status)
        status = submit_march_frame(march, work, diag);
    if (!status)
        status = neph_in_flight_drain(march->vulkan, &march->flight, diag);
    if (!status)
        status = neph_gpu_scene_check(march->vulkan, &march->scene.gpu, diag);
    if (status) {
        neph_image_destroy(made);
        return status;
    }
    work->stats.rays = (uint64_t)march->params.width_px * (uint64_t)march->params.height_px;
    uint64_t evaluations, closed_forms;
    neph_sun_fill_counts(work->cost.fill, &evaluations, &closed_forms);
    work->stats.gpu_s = *work->gpu_s + neph_sun_fill_gpu_s(work->cost.fill) +
                        *work->cost.light_gpu_s + *work->cost.places_gpu_s +
                        neph_sky_gpu_s(work->cost.sky);
    work->stats.sky = *work->cost.sky;
    work->stats.density_evaluations += evaluations;
    work->stats.closed_forms += closed_forms;
    work->stats.dispatches += work->cost.fill->dispatches;
    neph_march_split_adapt(&march->cut, *work->gpu_s);
    *image = made;
    return NEPH_OK;
}

enum neph_status neph_march_frame(struct neph_march *march, const struct neph_scene *scene,
                                  double frame, const struct neph_march_frame_state *moment,
                                  struct neph_image **image, struct neph_march_stats *stats,
                                  struct neph_diag *diag)
{
    const double start_s = neph_wall_s();
    static const struct neph_march_frame_state alone;
    struct work work = {.march = march};
    int slot;
    moment = moment ? moment : &alone;
    enum neph_status status = neph_in_flight_begin(march->vulkan, &march->flight, &slot, diag);
    if (status)
        return status;
    work.gpu_s = &march->flights_gpu_s[slot];
    *work.gpu_s = 0.0;
    work.cost.fill = &march->fills[slot];
    work.cost.light_gpu_s = &march->lights_gpu_s[slot];
    *work.cost.light_gpu_s = 0.0;
    work.cost.places_gpu_s = &march->places_gpu_s[slot];
    *work.cost.places_gpu_s = 0.0;
    work.cost.sky = &march->skies[slot];
    *work.cost.sky = (struct neph_sky_times){.air_s = 0.0};
    status = neph_march_scene_update(scene, &march->params, frame, moment, &march->scene,
                                     &work.cost, diag);
    if (status)
        return status;
    memcpy(march->scene.gpu.frame->jitter_px, moment->jitter_px, sizeof(moment->jitter_px));
    if (!image)
        return submit_march_frame(march, &work, diag);
    status = read_frame(march, &work, image, diag);
    work.stats.wall_s = neph_wall_s() - start_s;
    if (!status && stats)
        *stats = work.stats;
    return status;
}

enum neph_status neph_march_collect(struct neph_march *march, double *gpu_s, struct neph_diag *diag)
{
    int slot;
    enum neph_status status = neph_in_flight_collect(march->vulkan, &march->flight, &slot, diag);
    if (!status)
        status = neph_gpu_scene_check(march->vulkan, &march->scene.gpu, diag);
    if (status)
        return status;
    march->home_slot = slot;
    neph_march_split_adapt(&march->cut, march->flights_gpu_s[slot]);
    *gpu_s = march->flights_gpu_s[slot] + neph_sun_fill_gpu_s(&march->fills[slot]) +
             march->lights_gpu_s[slot] + march->places_gpu_s[slot] +
             neph_sky_gpu_s(&march->skies[slot]);
    return NEPH_OK;
}

struct neph_sky_times neph_march_collected_sky(const struct neph_march *march)
{
    return march->skies[march->home_slot];
}
