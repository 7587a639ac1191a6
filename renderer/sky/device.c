/* SPDX-License-Identifier: MIT */
#include "renderer/sky/device.h"

#include "base/interrupt.h"
#include "renderer/compute.h"
#include "renderer/relative.h"
#include "scenes/radial.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const uint32_t sun_spirv[] = {
#include "shaders/sky_sun.comp.inc"
};
static const uint32_t gather_spirv[] = {
#include "shaders/sky_gather.comp.inc"
};
static const uint32_t sum_spirv[] = {
#include "shaders/sky_sum.comp.inc"
};
static const uint32_t view_spirv[] = {
#include "shaders/sky_view.comp.inc"
};
static const uint32_t picture_spirv[] = {
#include "shaders/sky_picture.comp.inc"
};

enum { local_size = 64, PART_PIXELS = 1 << 20 };

/* Kernels, in the order in which they run. */
enum kernel { SUN, GATHER, SUM, VIEW, PICTURE, KERNELS };

static const struct {
    const char *name;
    const uint32_t *spirv;
    size_t bytes;
    int buffers;
    size_t push_bytes;
} kernels[KERNELS] = {
    [SUN] = {"sky_sun", sun_spirv, sizeof(sun_spirv), 2, 0},
    [GATHER] = {"sky_gather", gather_spirv, sizeof(gather_spirv), 5,
                sizeof(struct neph_gpu_sky_pass)},
    [SUM] = {"sky_sum", sum_spirv, sizeof(sum_spirv), 5, sizeof(struct neph_gpu_sky_pass)},
    [VIEW] = {"sky_view", view_spirv, sizeof(view_spirv), 6, 0},
    [PICTURE] = {"sky_picture", picture_spirv, sizeof(picture_spirv), 6,
                 sizeof(struct neph_gpu_sky_part)},
};

struct work {
    struct neph_vulkan *vulkan;
    const struct neph_scene *scene;
    const struct neph_sky_params *params;
    struct neph_sky_air sky_air;
    const struct neph_kernel *kernels[KERNELS];
    struct neph_buffer air, sun, field, caps, arrivals, view, views, pixels, readback;
    int width_px, height_px;
    struct neph_sky_stats stats;
};

/* --- sizes ------------------------------------------------------------------------------------ */

static size_t node_count(const struct work *work)
{
    return (size_t)work->params->field.altitudes * (size_t)work->params->field.suns;
}

static size_t direction_count(const struct neph_sky_solve_params *field)
{
    return ((size_t)field->above + (size_t)field->below) * (size_t)field->around;
}

static size_t field_size(const struct work *work)
{
    return node_count(work) * (size_t)neph_sky_moments(work->params->field.degree) +
           (size_t)work->params->field.suns;
}

static size_t view_count(const struct work *work)
{
    const struct neph_sky_view_params *view = &work->params->view;
    return view->is_table ? 2 * (size_t)view->elevations * (size_t)view->azimuths : 0;
}

static size_t part_pixels(const struct work *work)
{
    const size_t pixels = (size_t)work->width_px * (size_t)work->height_px;
    return pixels < PART_PIXELS ? pixels : PART_PIXELS;
}

/* --- what can be rendered --------------------------------------------------------------------- */

/* Loop turns of a step, following sky_step() loop by loop. */
static uint64_t turns_of_step(const struct neph_sky_air *air, int degree)
{
    const uint64_t degrees = (uint64_t)degree + 2;
    return NEPH_SKY_DEGREE_MAX + 4 + (uint64_t)air->layer_count * (degrees + 1) +
           degrees * (degrees + 1);
}

static const char *obstacle_of(const struct neph_scene *scene, const struct neph_sky_air *air,
                               const struct neph_sky_params *params)
{
    const uint64_t steps = (uint64_t)(params->steps > params->field.steps ? params->steps
                                                                          : params->field.steps);
    const uint64_t sum = direction_count(&params->field) * (NEPH_SKY_DEGREE_MAX + 3);
    if (scene->solid_count > 1)
        return "solids beside the ground, on a device";
    if (scene->orthographic_height_m > 0.0)
        return "an orthographic camera, on a device";
    if (params->field.closure && scene->scattering == NEPH_SCATTERING_MULTIPLE)
        return "multiple=closure on a device";
    if ((steps + 2) * turns_of_step(air, params->field.degree) > NEPH_KERNEL_LOOP_TURNS_MAX ||
        sum > NEPH_KERNEL_LOOP_TURNS_MAX)
        return "so many steps or directions in one dispatch";
    return NULL;
}

bool neph_sky_device_can(const struct neph_scene *scene, const struct neph_sky_params *params,
                         char *reason, size_t reason_size)
{
    struct neph_sky_air air;
    if (!neph_sky_air_of(scene, &air, reason, reason_size))
        return false;
    const char *obstacle = obstacle_of(scene, &air, params);
    if (obstacle)
        snprintf(reason, reason_size, "%s", obstacle);
    return !obstacle;
}

/* --- what the device is told ------------------------------------------------------------------ */

static void copy_rgb(float to[3], const double from[3])
{
    for (int c = 0; c < 3; c++)
        to[c] = (float)from[c];
}

static struct neph_gpu_sky_air air_of(const struct work *work)
{
    const struct neph_sky_air *from = &work->sky_air;
    const struct neph_sky_params *params = work->params;
    struct neph_gpu_sky_air air = {
        .radius_m = (float)from->radius_m,
        .top_m = (float)from->top_m,
        .layer_count = (uint32_t)from->layer_count,
        .degree = (uint32_t)params->field.degree,
        .altitudes = (uint32_t)params->field.altitudes,
        .suns = (uint32_t)params->field.suns,
        .sun_altitudes = (uint32_t)params->sun_altitudes,
        .sun_cosines = (uint32_t)params->sun_cosines,
        .deepest_root = (float)neph_sky_deepest_root(),
    };
    copy_rgb(air.ground_albedo, from->ground_albedo);
    for (int i = 0; i < from->layer_count; i++) {
        const struct neph_sky_layer *layer = &from->layers[i];
        air.layers[i] = (struct neph_gpu_sky_layer){.is_tent = layer->is_tent,
                                                    .middle_m = (float)layer->middle_m,
                                                    .scale_m = (float)layer->scale_m,
                                                    .phase_kind = layer->phase.kind,
                                                    .g = (float)layer->phase.g};
        copy_rgb(air.layers[i].extinction_per_m, layer->extinction_per_m);
        copy_rgb(air.layers[i].scattering_per_m, layer->scattering_per_m);
    }
    for (int l = 0; l <= NEPH_SKY_DEGREE_MAX; l++)
        for (int m = 0; m <= l; m++)
            air.norms[neph_sky_moments(l - 1) + m] = (float)neph_sky_norm(l, m);
    return air;
}

static void write_caps(const struct neph_sky_solve_params *field, float (*caps)[2])
{
    const int counts[2] = {field->above, field->below};
    for (int half = 0; half < 2; half++) {
        double nodes[NEPH_SKY_DIRECTIONS_MAX], weights[NEPH_SKY_DIRECTIONS_MAX];
        neph_sky_gauss(counts[half], nodes, weights);
        for (int i = 0; i < counts[half]; i++, caps++) {
            (*caps)[0] = (float)nodes[i];
            (*caps)[1] = (float)weights[i];
        }
    }
}

static struct neph_gpu_sky_view view_of(const struct work *work, double frame)
{
    const struct neph_scene *scene = work->scene;
    const struct neph_sky_view_params *params = &work->params->view;
    const struct neph_camera camera = neph_scene_camera(scene, frame);
    const struct neph_vec3 center_m = work->sky_air.center_m;
    const double half_height = neph_camera_half_height(&camera);
    const double altitude_m = (double)(neph_radial_distance_m(center_m, camera.position_m) -
                                       (long double)work->sky_air.radius_m);
    struct neph_gpu_sky_view view = {
        .half_width = (float)(half_height * work->width_px / work->height_px),
        .half_height = (float)half_height,
        .width_px = (uint32_t)work->width_px,
        .height_px = (uint32_t)work->height_px,
        .altitude_m = (float)fmax(0.0, altitude_m),
        .steps = (uint32_t)work->params->steps,
        .scatters = scene->scattering != NEPH_SCATTERING_NONE,
        .has_field = scene->scattering == NEPH_SCATTERING_MULTIPLE,
        .elevations = params->is_table ? (uint32_t)params->elevations : 0u,
        .azimuths = (uint32_t)params->azimuths,
    };
    neph_gpu_direction(view.right, camera.right);
    neph_gpu_direction(view.up, camera.up);
    neph_gpu_direction(view.forward, camera.forward);
    neph_gpu_direction(view.vertical,
                       neph_vec3_normalize(neph_vec3_sub(camera.position_m, center_m)));
    neph_gpu_direction(view.sun_direction, scene->sun.direction);
    const struct neph_rgb sun = scene->sun.irradiance_w_per_m2;
    if (scene->sun.present)
        copy_rgb(view.sun_irradiance, (const double[3]){sun.r, sun.g, sun.b});
    return view;
}

/* --- buffers ---------------------------------------------------------------------------------- */

static enum neph_status create_buffers(struct work *work, struct neph_diag *diag)
{
    const struct neph_sky_params *params = work->params;
    const size_t texel = 4 * sizeof(float), directions = direction_count(&params->field);
    const struct {
        struct neph_buffer *buffer;
        const char *name;
        enum neph_buffer_use use;
        size_t bytes;
    } rows[] = {
        {&work->air, "sky air", NEPH_BUFFER_UPLOAD, sizeof(struct neph_gpu_sky_air)},
        {&work->sun, "sky sun", NEPH_BUFFER_DEVICE,
         (size_t)params->sun_altitudes * (size_t)params->sun_cosines * texel},
        {&work->field, "sky field", NEPH_BUFFER_DEVICE, field_size(work) * texel},
        {&work->caps, "sky caps", NEPH_BUFFER_UPLOAD,
         (size_t)(params->field.above + params->field.below) * 2 * sizeof(float)},
        {&work->arrivals, "sky arrivals", NEPH_BUFFER_DEVICE,
         node_count(work) * directions * texel},
        {&work->view, "sky view", NEPH_BUFFER_UPLOAD, sizeof(struct neph_gpu_sky_view)},
        {&work->views, "sky views", NEPH_BUFFER_DEVICE,
         (1 + view_count(work) * (size_t)(work->sky_air.layer_count + NEPH_SKY_SLICES)) * texel},
        {&work->pixels, "sky pixels", NEPH_BUFFER_DEVICE,
         part_pixels(work) * sizeof(struct neph_gpu_sky_pixel)},
        {&work->readback, "sky readback", NEPH_BUFFER_READBACK,
         part_pixels(work) * sizeof(struct neph_gpu_sky_pixel)},
    };
    enum neph_status status = NEPH_OK;
    for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]) && !status; i++)
        status = neph_buffer_create(work->vulkan, rows[i].use, rows[i].bytes, rows[i].name,
                                    rows[i].buffer, diag);
    return status;
}

static enum neph_status get_kernels(struct work *work, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < KERNELS && !status; i++) {
        const struct neph_kernel_params params = {.name = kernels[i].name,
                                                  .spirv = kernels[i].spirv,
                                                  .spirv_size_bytes = kernels[i].bytes,
                                                  .buffer_count = kernels[i].buffers,
                                                  .push_size_bytes = kernels[i].push_bytes};
        status = neph_kernel_get(work->vulkan, &params, &work->kernels[i], diag);
    }
    return status;
}

static void destroy_buffers(struct work *work)
{
    struct neph_buffer *const buffers[] = {&work->air,      &work->sun,      &work->field,
                                           &work->caps,     &work->view,     &work->pixels,
                                           &work->arrivals, &work->readback, &work->views};
    for (size_t i = 0; i < sizeof(buffers) / sizeof(buffers[0]); i++)
        neph_buffer_destroy(work->vulkan, buffers[i]);
}

/* --- dispatches ------------------------------------------------------------------------------- */

/* All kernels find the same things at the same bindings. */
static enum neph_status run(struct work *work, enum kernel kernel, size_t threads, const void *push,
                            double *sum_s, struct neph_diag *diag)
{
    double gpu_s = 0.0;
    const bool shows = kernel == VIEW || kernel == PICTURE;
    const struct neph_dispatch dispatch = {
        .buffers = {&work->air, &work->sun, &work->field, shows ? &work->view : &work->caps,
                    shows ? &work->pixels : &work->arrivals, &work->views},
        .push = push,
        .group_count = (uint32_t)((threads + local_size - 1) / local_size),
    };
    if (neph_interrupted())
        return neph_fail(diag, NEPH_ERR_INTERRUPTED, "the sky: interrupted");
    const enum neph_status status = neph_kernel_run(work->vulkan, work->kernels[kernel], &dispatch,
                                                    &gpu_s, diag);
    *sum_s += gpu_s;
    return status;
}

static enum neph_status make_tables(struct work *work, struct neph_diag *diag)
{
    const struct neph_sky_params *params = work->params;
    const struct neph_sky_solve_params *field = &params->field;
    struct neph_gpu_sky_pass pass = {.above = (uint32_t)field->above,
                                     .below = (uint32_t)field->below,
                                     .around = (uint32_t)field->around,
                                     .steps = (uint32_t)field->steps};
    const size_t rays = node_count(work) * direction_count(field);
    double *sum_s = &work->stats.tables_s;
    enum neph_status status = run(
        work, SUN, (size_t)params->sun_altitudes * (size_t)params->sun_cosines, NULL, sum_s, diag);
    if (work->scene->scattering != NEPH_SCATTERING_MULTIPLE)
        return status;
    for (int order = 0; order < field->orders && !status; order++) {
        pass.has_field = order > 0;
        status = run(work, GATHER, rays, &pass, sum_s, diag);
        if (!status)
            status = run(work, SUM, field_size(work), &pass, sum_s, diag);
    }
    return status;
}

/* --- a picture -------------------------------------------------------------------------------- */

struct layers {
    float *radiance[3], *volume[3], *transmittance[3], *depth;
};

static enum neph_status add_layers(struct neph_image *image, struct layers *layers,
                                   struct neph_diag *diag)
{
    enum neph_status status = neph_image_add_rgb(image, NULL, layers->radiance, diag);
    if (!status)
        status = neph_image_add_rgb(image, "volume", layers->volume, diag);
    if (!status)
        status = neph_image_add_rgb(image, "transmittance", layers->transmittance, diag);
    if (!status)
        status = neph_image_add_channel(image, "Z", &layers->depth, diag);
    return status;
}

static void take_part(const struct neph_gpu_sky_pixel *pixels, size_t first, size_t count,
                      const struct layers *layers)
{
    for (size_t i = 0; i < count; i++) {
        for (int c = 0; c < 3; c++) {
            layers->radiance[c][first + i] = pixels[i].radiance[c];
            layers->volume[c][first + i] = pixels[i].volume[c];
            layers->transmittance[c][first + i] = pixels[i].transmittance[c];
        }
        const float depth_m = pixels[i].radiance[3];
        layers->depth[first + i] = depth_m < NEPH_GPU_FAR_M ? depth_m : INFINITY;
    }
}

static enum neph_status show(struct work *work, struct neph_image *image, struct neph_diag *diag)
{
    struct layers layers;
    const size_t pixels = (size_t)work->width_px * (size_t)work->height_px;
    enum neph_status status = add_layers(image, &layers, diag);
    if (!status && view_count(work) > 0)
        status = run(work, VIEW, view_count(work) * (size_t)(work->sky_air.layer_count + 1), NULL,
                     &work->stats.view_s, diag);
    for (size_t first = 0; first < pixels && !status; first += PART_PIXELS) {
        const size_t left = pixels - first, count = left < PART_PIXELS ? left : PART_PIXELS;
        const struct neph_gpu_sky_part part = {(uint32_t)first, (uint32_t)count};
        status = run(work, PICTURE, count, &part, &work->stats.picture_s, diag);
        if (!status)
            status = neph_buffer_download(work->vulkan, &work->pixels, &work->readback,
                                          count * sizeof(struct neph_gpu_sky_pixel), diag);
        if (!status)
            take_part(work->readback.mapped, first, count, &layers);
    }
    return status;
}

enum neph_status neph_sky_device_render(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                        const struct neph_sky_params *params, double frame,
                                        int width_px, int height_px, struct neph_image **image,
                                        struct neph_sky_stats *stats, struct neph_diag *diag)
{
    char reason[200];
    struct neph_image *made = NULL;
    struct work work = {.vulkan = vulkan,
                        .scene = scene,
                        .params = params,
                        .width_px = width_px,
                        .height_px = height_px};
    if (!neph_sky_device_can(scene, params, reason, sizeof(reason)))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "engine sky has nothing for %s", reason);
    neph_sky_air_of(scene, &work.sky_air, reason, sizeof(reason));
    enum neph_status status = neph_image_create(width_px, height_px, &made, diag);
    if (!status)
        status = create_buffers(&work, diag);
    if (!status)
        status = get_kernels(&work, diag);
    if (!status) {
        *(struct neph_gpu_sky_air *)work.air.mapped = air_of(&work);
        *(struct neph_gpu_sky_view *)work.view.mapped = view_of(&work, frame);
        write_caps(&params->field, work.caps.mapped);
        status = make_tables(&work, diag);
    }
    if (!status)
        status = show(&work, made, diag);
    destroy_buffers(&work);
    if (status) {
        neph_image_destroy(made);
        return status;
    }
    *stats = work.stats;
    *image = made;
    return NEPH_OK;
}
