/* SPDX-License-Identifier: MIT */
#include "renderer/fog_look.h"

#include "renderer/gpu_scene.h"
#include "renderer/in_flight.h"
#include "scenes/fog_translation.h"

#include <math.h>
#include <stdlib.h>

/* Does not compile with a new model: this file then needs a change. */
_Static_assert(NEPH_FOG_MODEL_COUNT == 2, "a new kind");

static const uint32_t fog_look_code[] = {
#include "shaders/fog_look.comp.inc"
};

enum {
    LOCAL_SIZE = 64,
    BUFFERS = NEPH_GPU_SCENE_BUFFERS + 1,
    CONSTANTS = NEPH_GPU_SCENE_CONSTANTS + 1,
    RAYS_MAX = 1 << 20, /* per dispatch */
};

_Static_assert(NEPH_FOG_UNREAL == 0 && NEPH_FOG_FILAMENT == 1, "fog_look.glsl's models");

/* --- fog parameters --------------------------------------------------------------------------- */

static void write_rgb_floats(float out[3], double r, double g, double b)
{
    out[0] = (float)r;
    out[1] = (float)g;
    out[2] = (float)b;
}

static float replace_zero_by_far(double distance_m)
{
    return distance_m > 0.0 ? (float)distance_m : 2.0f * NEPH_GPU_FAR_M;
}

static struct neph_gpu_fog_look_layer pack_fog_layer(const struct neph_fog_layer *layer,
                                                     double observer_y_m)
{
    const double ln2 = M_LN2, falloff_per_m = layer->falloff_per_m / ln2;
    const double exponent = falloff_per_m * (observer_y_m - layer->height_m);
    const double log_density = log2(layer->extinction_per_m / (ln2 * ln2)) - exponent;
    const double whole = floor(log_density) + 1.0;
    return (struct neph_gpu_fog_look_layer){
        .mantissa = (float)exp2(log_density - whole),
        .log_density = (float)whole,
        .falloff_per_m = (float)falloff_per_m,
        .exponent = (float)exponent,
    };
}

/* Layers without extinction are omitted: the shader stores logarithms. */
static void write_fog_layers(const struct neph_scene *scene, double observer_y_m,
                             struct neph_gpu_fog_look *gpu)
{
    const struct neph_medium *fog = neph_fog_look_find_medium(scene);
    for (int l = 0; fog && l < fog->layer_count; l++)
        if (fog->layers[l].extinction_per_m > 0.0)
            gpu->layers[gpu->layer_count++] = pack_fog_layer(&fog->layers[l], observer_y_m);
}

/* Filament has no end distance, no froxels and no maximum observer height. */
static void write_fog_distances(const struct neph_fog_look *look, enum neph_fog_model model,
                                double camera_y_m, struct neph_gpu_fog_look *gpu)
{
    const bool is_unreal = model == NEPH_FOG_UNREAL;
    const double hand_over_m = is_unreal ? look->volumetric_fog_distance_m : 0.0;
    const double drop_m = is_unreal ? camera_y_m - look->observer_height_max_m : 0.0;
    gpu->start_m = (float)fmax(look->start_distance_m, hand_over_m);
    gpu->end_m = replace_zero_by_far(is_unreal ? look->end_distance_m : 0.0);
    gpu->cutoff_m = replace_zero_by_far(look->cutoff_distance_m);
    gpu->observer_drop_m = (float)fmax(0.0, drop_m);
}

struct neph_gpu_fog_look neph_gpu_fog_pack(const struct neph_scene *scene,
                                           const struct neph_fog_look *look,
                                           enum neph_fog_model model, struct neph_vec3 camera_m)
{
    const struct neph_rgb own = look->inscattering_w_per_m2_sr, dim = look->sky_light,
                          sky = scene->background_w_per_m2_sr, sun = look->directional_w_per_m2_sr;
    struct neph_gpu_fog_look gpu = {
        .max_opacity = (float)look->max_opacity,
        .directional_exponent = (float)look->directional_exponent,
        .directional_start_m = (float)look->directional_start_m,
        .model = (uint32_t)model,
    };
    write_rgb_floats(gpu.inscattering, own.r + dim.r * sky.r, own.g + dim.g * sky.g,
                     own.b + dim.b * sky.b);
    if (scene->sun.present)
        write_rgb_floats(gpu.directional, sun.r, sun.g, sun.b);
    write_fog_distances(look, model, camera_m.y, &gpu);
    write_fog_layers(scene, camera_m.y - gpu.observer_drop_m, &gpu);
    return gpu;
}

/* --- frames ----------------------------------------------------------------------------------- */

struct neph_fog_renderer {
    struct neph_vulkan *vulkan; /* borrowed */
    struct neph_fog_look_params params;
    const struct neph_kernel *kernel;
    struct neph_gpu_scene gpu;
    struct neph_buffer_ring frame_ring, solid_ring;
    struct neph_buffer pixels, readback;
    struct neph_in_flight flight;
    double flights_gpu_s[NEPH_IN_FLIGHT_FRAMES];
};

static enum neph_status get_kernel(struct neph_fog_renderer *looks, struct neph_diag *diag)
{
    const struct neph_kernel_params kernel = {
        .name = "fog_look",
        .code = fog_look_code,
        .code_bytes = sizeof(fog_look_code),
        .buffer_count = BUFFERS,
        .uniform_count = NEPH_GPU_SCENE_UNIFORMS,
        .push_size_bytes = sizeof(struct neph_gpu_fog_look_run),
        .constant_count = CONSTANTS,
        .constants = {looks->gpu.constants[0], looks->gpu.constants[1], looks->params.sun_is_clear},
    };
    return neph_kernel_get(looks->vulkan, &kernel, &looks->kernel, diag);
}

static enum neph_status create_buffers(struct neph_fog_renderer *looks, struct neph_diag *diag)
{
    const size_t pixels = (size_t)looks->params.width_px * (size_t)looks->params.height_px;
    const size_t bytes = (pixels < RAYS_MAX ? pixels : RAYS_MAX) *
                         sizeof(struct neph_gpu_fog_look_pixel);
    enum neph_status status = neph_buffer_ring_create(looks->vulkan, &looks->gpu.buffers[0],
                                                      "scene frame", &looks->frame_ring, diag);
    if (!status)
        status = neph_buffer_ring_create(looks->vulkan, &looks->gpu.buffers[1], "scene solids",
                                         &looks->solid_ring, diag);
    const struct neph_buffer_row rows[] = {
        {&looks->pixels, NEPH_BUFFER_DEVICE, bytes, "fog pixels"},
        {&looks->readback, NEPH_BUFFER_READBACK, bytes, "fog readback"},
    };
    return status ? status : neph_buffers_create(looks->vulkan, rows, 2, diag);
}

enum neph_status neph_fog_renderer_create(struct neph_vulkan *vulkan,
                                          const struct neph_scene *scene,
                                          const struct neph_fog_look_params *params,
                                          struct neph_fog_renderer **looks, struct neph_diag *diag)
{
    struct neph_fog_renderer *made = calloc(1, sizeof(*made));
    if (!made)
        return neph_fail_memory(diag);
    made->vulkan = vulkan;
    made->params = *params;
    enum neph_status status = neph_gpu_scene_create(vulkan, scene, params->frame, params->width_px,
                                                    params->height_px, false, &made->gpu, diag);
    if (!status)
        status = create_buffers(made, diag);
    if (!status)
        status = get_kernel(made, diag);
    if (status)
        neph_fog_renderer_destroy(made);
    else
        *looks = made;
    return status;
}

void neph_fog_renderer_destroy(struct neph_fog_renderer *looks)
{
    if (!looks)
        return;
    neph_buffer_destroy(looks->vulkan, &looks->readback);
    neph_buffer_destroy(looks->vulkan, &looks->pixels);
    neph_buffer_ring_destroy(looks->vulkan, &looks->solid_ring);
    neph_buffer_ring_destroy(looks->vulkan, &looks->frame_ring);
    neph_gpu_scene_destroy(looks->vulkan, &looks->gpu);
    free(looks);
}

/* --- one frame -------------------------------------------------------------------------------- */

/* The channels of the frame; they point into the image. */
struct layers {
    float *radiance[3], *volume[3], *transmittance[3], *eye_depth_m;
};

struct work {
    struct neph_fog_renderer *looks;
    struct neph_gpu_fog_look_run run;
    const struct layers *layers; /* NULL: no image is returned */
    double *gpu_s;               /* borrowed; one of neph_fog_renderer.flights_gpu_s */
};

static enum neph_status create_image(const struct neph_fog_look_params *params,
                                     struct neph_image **image, struct layers *layers,
                                     struct neph_diag *diag)
{
    enum neph_status status = neph_image_create(params->width_px, params->height_px, image, diag);
    if (!status)
        status = neph_image_add_rgb(*image, NULL, layers->radiance, diag);
    if (!status)
        status = neph_image_add_rgb(*image, "volume", layers->volume, diag);
    if (!status)
        status = neph_image_add_rgb(*image, "transmittance", layers->transmittance, diag);
    return status ? status : neph_image_add_channel(*image, "Z", &layers->eye_depth_m, diag);
}

static void unpack(const struct neph_gpu_fog_look_pixel *pixel, const struct layers *layers,
                   size_t index)
{
    for (int c = 0; c < 3; c++) {
        layers->radiance[c][index] = pixel->radiance[c];
        layers->volume[c][index] = pixel->volume[c];
        layers->transmittance[c][index] = pixel->through;
    }
    layers->eye_depth_m[index] = pixel->eye_depth_m < NEPH_GPU_FAR_M ? pixel->eye_depth_m
                                                                     : INFINITY;
}

static enum neph_status read_pixels(const struct work *work, struct neph_diag *diag)
{
    const struct neph_fog_renderer *looks = work->looks;
    const enum neph_status status = neph_buffer_download(
        looks->vulkan, &looks->pixels, &looks->readback,
        work->run.ray_count * sizeof(struct neph_gpu_fog_look_pixel), diag);
    const struct neph_gpu_fog_look_pixel *pixels = looks->readback.mapped;
    for (uint32_t i = 0; i < work->run.ray_count && !status; i++)
        unpack(&pixels[i], work->layers, (size_t)work->run.first_ray + i);
    return status;
}

/* Submit the rays of one dispatch. */
static enum neph_status submit_fog_run(const struct work *work, struct neph_diag *diag)
{
    struct neph_fog_renderer *looks = work->looks;
    struct neph_dispatch dispatch = {
        .buffers = {[NEPH_GPU_SCENE_BUFFERS] = &looks->pixels},
        .push = &work->run,
        .group_count = (work->run.ray_count + LOCAL_SIZE - 1) / LOCAL_SIZE,
    };
    neph_gpu_scene_bind(&looks->gpu, &dispatch);
    const enum neph_status status = neph_dispatch_submit(looks->vulkan, looks->kernel, &dispatch,
                                                         "fog_look", work->gpu_s, diag);
    return !status && work->layers ? read_pixels(work, diag) : status;
}

static enum neph_status submit_fog_frame(struct work *work, struct neph_diag *diag)
{
    struct neph_fog_renderer *looks = work->looks;
    const uint32_t pixels = (uint32_t)(looks->params.width_px * looks->params.height_px);
    enum neph_status status = NEPH_OK;
    for (uint32_t first = 0; first < pixels && !status; first += RAYS_MAX) {
        work->run.first_ray = first;
        work->run.ray_count = pixels - first < RAYS_MAX ? pixels - first : RAYS_MAX;
        status = submit_fog_run(work, diag);
    }
    if (!status)
        status = neph_vulkan_check(looks->vulkan, diag);
    if (!status)
        neph_in_flight_end(looks->vulkan, &looks->flight);
    return status;
}

static enum neph_status read_fog_frame(struct work *work, struct neph_image **image, double *gpu_s,
                                       struct neph_diag *diag)
{
    struct layers layers = {.eye_depth_m = NULL};
    struct neph_image *made = NULL;
    work->layers = &layers;
    enum neph_status status = create_image(&work->looks->params, &made, &layers, diag);
    if (!status)
        status = submit_fog_frame(work, diag);
    if (!status)
        status = neph_in_flight_drain(work->looks->vulkan, &work->looks->flight, diag);
    if (!status)
        status = neph_gpu_scene_check(work->looks->vulkan, &work->looks->gpu, diag);
    if (status) {
        neph_image_destroy(made);
        return status;
    }
    *image = made;
    *gpu_s = *work->gpu_s;
    return NEPH_OK;
}

/* Update the scene in memory that no other frame reads. */
static enum neph_status update_fog_scene(struct neph_fog_renderer *looks,
                                         const struct neph_scene *scene, double frame,
                                         double *gpu_s, struct neph_diag *diag)
{
    neph_buffer_ring_advance(&looks->frame_ring, &looks->gpu.buffers[0]);
    neph_buffer_ring_advance(&looks->solid_ring, &looks->gpu.buffers[1]);
    looks->gpu.frame = looks->gpu.buffers[0].mapped;
    return neph_gpu_scene_update(looks->vulkan, &looks->gpu, scene, frame, looks->params.width_px,
                                 looks->params.height_px, gpu_s, diag);
}

enum neph_status neph_fog_renderer_frame(struct neph_fog_renderer *looks,
                                         const struct neph_scene *scene, double frame,
                                         struct neph_image **image, double *gpu_s,
                                         struct neph_diag *diag)
{
    const struct neph_camera camera = neph_scene_camera(scene, frame);
    struct work work = {.looks = looks};
    int slot;
    enum neph_status status = neph_in_flight_begin(looks->vulkan, &looks->flight, &slot, diag);
    if (status)
        return status;
    work.gpu_s = &looks->flights_gpu_s[slot];
    *work.gpu_s = 0.0;
    work.run.look = neph_gpu_fog_pack(scene, &looks->params.look, looks->params.model,
                                      camera.position_m);
    status = update_fog_scene(looks, scene, frame, work.gpu_s, diag);
    if (status)
        return status;
    return image ? read_fog_frame(&work, image, gpu_s, diag) : submit_fog_frame(&work, diag);
}

enum neph_status neph_fog_renderer_collect(struct neph_fog_renderer *looks, double *gpu_s,
                                           struct neph_diag *diag)
{
    int slot;
    enum neph_status status = neph_in_flight_collect(looks->vulkan, &looks->flight, &slot, diag);
    if (!status)
        status = neph_gpu_scene_check(looks->vulkan, &looks->gpu, diag);
    if (!status)
        *gpu_s = looks->flights_gpu_s[slot];
    return status;
}
