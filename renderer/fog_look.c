/* SPDX-License-Identifier: MIT */
#include "renderer/fog_look.h"

#include "renderer/gpu_scene.h"
#include "scenes/fog_translation.h"

#include <math.h>

static const uint32_t fog_look_spirv[] = {
#include "shaders/fog_look.comp.inc"
};

enum {
    LOCAL_SIZE = 64,
    BUFFERS = NEPH_GPU_SCENE_BUFFERS + 1,
    CONSTANTS = NEPH_GPU_SCENE_CONSTANTS + 1,
    RAYS_MAX = 1 << 20, /* of a dispatch */
};

_Static_assert(NEPH_FOG_UNREAL == 0 && NEPH_FOG_FILAMENT == 1, "fog_look.glsl's models");

/* --- the look --------------------------------------------------------------------------------- */

static void put_rgb(float out[3], double r, double g, double b)
{
    out[0] = (float)r;
    out[1] = (float)g;
    out[2] = (float)b;
}

static float or_nowhere(double distance_m)
{
    return distance_m > 0.0 ? (float)distance_m : 2.0f * NEPH_GPU_FAR_M;
}

static struct neph_gpu_fog_look_layer layer_from(const struct neph_fog_layer *layer,
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

/* Layers without extinction have no logarithm, and are left out. */
static void put_layers(const struct neph_scene *scene, double observer_y_m,
                       struct neph_gpu_fog_look *gpu)
{
    if (scene->medium_count == 0)
        return;
    const struct neph_medium *fog = neph_fog_look_medium(scene);
    for (int l = 0; l < fog->layer_count; l++)
        if (fog->layers[l].extinction_per_m > 0.0)
            gpu->layers[gpu->layer_count++] = layer_from(&fog->layers[l], observer_y_m);
}

/* Filament has no end, no froxels and no highest observer. */
static void put_distances(const struct neph_fog_look *look, enum neph_fog_model model,
                          double camera_y_m, struct neph_gpu_fog_look *gpu)
{
    const bool is_unreal = model == NEPH_FOG_UNREAL;
    const double hand_over_m = is_unreal ? look->volumetric_fog_distance_m : 0.0;
    const double drop_m = is_unreal ? camera_y_m - look->observer_height_max_m : 0.0;
    gpu->start_m = (float)fmax(look->start_distance_m, hand_over_m);
    gpu->end_m = or_nowhere(is_unreal ? look->end_distance_m : 0.0);
    gpu->cutoff_m = or_nowhere(look->cutoff_distance_m);
    gpu->observer_drop_m = (float)fmax(0.0, drop_m);
}

struct neph_gpu_fog_look neph_gpu_fog_look_from(const struct neph_scene *scene,
                                                const struct neph_fog_look *look,
                                                enum neph_fog_model model,
                                                struct neph_vec3 camera_m)
{
    const struct neph_rgb own = look->inscattering_w_per_m2_sr, dim = look->sky_light,
                          sky = scene->background_w_per_m2_sr, sun = look->directional_w_per_m2_sr;
    struct neph_gpu_fog_look gpu = {
        .max_opacity = (float)look->max_opacity,
        .directional_exponent = (float)look->directional_exponent,
        .directional_start_m = (float)look->directional_start_m,
        .model = (uint32_t)model,
    };
    put_rgb(gpu.inscattering, own.r + dim.r * sky.r, own.g + dim.g * sky.g, own.b + dim.b * sky.b);
    if (scene->sun.present)
        put_rgb(gpu.directional, sun.r, sun.g, sun.b);
    put_distances(look, model, camera_m.y, &gpu);
    put_layers(scene, camera_m.y - gpu.observer_drop_m, &gpu);
    return gpu;
}

/* --- one picture ------------------------------------------------------------------------------ */

/* The channels of the frame; they point into the image. */
struct layers {
    float *radiance[3], *volume[3], *transmittance[3], *eye_depth_m;
};

struct work {
    struct neph_vulkan *vulkan;
    const struct neph_kernel *kernel;
    struct neph_gpu_scene gpu;
    struct neph_gpu_fog_look_run run;
    struct neph_buffer pixels, readback;
    struct layers layers;
    double gpu_s;
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

static enum neph_status set_up(struct work *work, const struct neph_scene *scene,
                               const struct neph_fog_look_params *params, struct neph_diag *diag)
{
    const size_t pixels = (size_t)params->width_px * (size_t)params->height_px;
    const size_t bytes = (pixels < RAYS_MAX ? pixels : RAYS_MAX) *
                         sizeof(struct neph_gpu_fog_look_pixel);
    enum neph_status status = neph_gpu_scene_create(work->vulkan, scene, params->frame,
                                                    params->width_px, params->height_px, false,
                                                    &work->gpu, diag);
    if (!status)
        status = neph_buffer_create(work->vulkan, NEPH_BUFFER_DEVICE, bytes, "fog pixels",
                                    &work->pixels, diag);
    if (!status)
        status = neph_buffer_create(work->vulkan, NEPH_BUFFER_READBACK, bytes, "fog readback",
                                    &work->readback, diag);
    if (status)
        return status;
    const struct neph_kernel_params kernel = {
        .name = "fog_look",
        .spirv = fog_look_spirv,
        .spirv_size_bytes = sizeof(fog_look_spirv),
        .buffer_count = BUFFERS,
        .uniform_count = NEPH_GPU_SCENE_UNIFORMS,
        .push_size_bytes = sizeof(struct neph_gpu_fog_look_run),
        .constant_count = CONSTANTS,
        .constants = {work->gpu.constants[0], work->gpu.constants[1], params->sun_is_clear},
    };
    return neph_kernel_get(work->vulkan, &kernel, &work->kernel, diag);
}

static void finish(struct work *work)
{
    neph_buffer_destroy(work->vulkan, &work->readback);
    neph_buffer_destroy(work->vulkan, &work->pixels);
    neph_gpu_scene_destroy(work->vulkan, &work->gpu);
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

/* The rays of one dispatch. */
static enum neph_status render_run(struct work *work, struct neph_diag *diag)
{
    struct neph_dispatch dispatch = {
        .buffers = {[NEPH_GPU_SCENE_BUFFERS] = &work->pixels},
        .push = &work->run,
        .group_count = (work->run.ray_count + LOCAL_SIZE - 1) / LOCAL_SIZE,
        .copy_from = &work->pixels,
        .copy_to = &work->readback,
        .copy_size_bytes = work->run.ray_count * sizeof(struct neph_gpu_fog_look_pixel),
    };
    double gpu_s = NAN;
    neph_gpu_scene_bind(&work->gpu, &dispatch);
    const enum neph_status status = neph_kernel_run(work->vulkan, work->kernel, &dispatch, &gpu_s,
                                                    diag);
    const struct neph_gpu_fog_look_pixel *pixels = work->readback.mapped;
    for (uint32_t i = 0; i < work->run.ray_count && !status; i++)
        unpack(&pixels[i], &work->layers, (size_t)work->run.first_ray + i);
    work->gpu_s += gpu_s;
    return status;
}

static enum neph_status render(struct work *work, uint32_t pixels, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (uint32_t first = 0; first < pixels && !status; first += RAYS_MAX) {
        work->run.first_ray = first;
        work->run.ray_count = pixels - first < RAYS_MAX ? pixels - first : RAYS_MAX;
        status = render_run(work, diag);
    }
    return status ? status : neph_vulkan_check(work->vulkan, diag);
}

enum neph_status neph_fog_look_frame(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                     const struct neph_fog_look_params *params,
                                     struct neph_image **image, double *gpu_s,
                                     struct neph_diag *diag)
{
    struct work work = {.vulkan = vulkan};
    struct neph_image *made = NULL;
    const struct neph_camera camera = neph_scene_camera(scene, params->frame);
    work.run.look = neph_gpu_fog_look_from(scene, &params->look, params->model, camera.position_m);
    enum neph_status status = create_image(params, &made, &work.layers, diag);
    if (!status)
        status = set_up(&work, scene, params, diag);
    if (!status)
        status = render(&work, (uint32_t)(params->width_px * params->height_px), diag);
    finish(&work);
    if (status) {
        neph_image_destroy(made);
        return status;
    }
    *image = made;
    *gpu_s = work.gpu_s;
    return NEPH_OK;
}
