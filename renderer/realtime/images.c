/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/images.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static size_t rendered_count(const struct neph_rt_device *device)
{
    return (size_t)device->view->size_px[0] * device->view->size_px[1];
}

static size_t count_output_pixels(const struct neph_rt_device *device)
{
    return (size_t)device->view->picture_px[0] * device->view->picture_px[1];
}

/* Index of the texel of a full-resolution target for a rendered pixel. */
static size_t find_rendered_texel(const struct neph_rt_device *device, int target, size_t pixel)
{
    const struct neph_gpu_view *view = device->view;
    const size_t x = pixel % view->size_px[0] + view->origin_px[0];
    const size_t y = pixel / view->size_px[0] + view->origin_px[1];
    return y * view->targets[target].width + x;
}

/* The rendered pixel that contains the centre of an output pixel: the pixel itself at 100 %. */
static size_t rendered_pixel(const struct neph_rt_device *device, size_t pixel)
{
    const uint32_t *size = device->view->size_px, *picture = device->view->picture_px;
    const size_t x = (2 * (pixel % picture[0]) + 1) * size[0] / (2 * (size_t)picture[0]);
    const size_t y = (2 * (pixel / picture[0]) + 1) * size[1] / (2 * (size_t)picture[1]);
    return y * size[0] + x;
}

/* Index of the texel of a target for an output pixel. */
static size_t find_output_texel(const struct neph_rt_device *device, int target, size_t pixel)
{
    const struct neph_gpu_view *view = device->view;
    if (!neph_rt_has_output_size(target))
        return find_rendered_texel(device, target, rendered_pixel(device, pixel));
    const size_t x = pixel % view->picture_px[0] + view->origin_px[0];
    const size_t y = pixel / view->picture_px[0] + view->origin_px[1];
    return y * view->targets[target].width + x;
}

enum neph_status neph_rt_upload_image(struct neph_rt_device *device, int target,
                                      float *const channels[3], struct neph_diag *diag)
{
    const size_t word_count = neph_rt_device_words(device, target);
    if (word_count == 0)
        return NEPH_OK;
    uint32_t *words = calloc(word_count, sizeof(*words));
    if (!words)
        return neph_fail_memory(diag);
    const size_t count = rendered_count(device);
    for (size_t i = 0; i < count; i++) {
        float value[4] = {0.0f};
        for (int c = 0; c < 3; c++)
            if (channels[c])
                value[c] = fminf(channels[c][i], NEPH_GPU_FAR_M);
        neph_rt_store(&device->view->targets[target], words, find_rendered_texel(device, target, i),
                      value);
    }
    const enum neph_status status = neph_rt_device_upload(device, target, words, diag);
    free(words);
    return status;
}

/* Outputs of the anti-aliasing are multiplied by the exposure. */
static float get_exposure(const struct neph_gpu_view *view, int target)
{
    return neph_rt_has_output_size(target) && view->settings[RT_TAA] != 0.0f ? view->exposure
                                                                             : 1.0f;
}

enum neph_status neph_rt_download_image(struct neph_rt_device *device, int target,
                                        float *const channels[4], struct neph_diag *diag)
{
    const float exposure = get_exposure(device->view, target);
    uint32_t *words = malloc(neph_rt_device_words(device, target) * sizeof(*words));
    if (!words)
        return neph_fail_memory(diag);
    const enum neph_status status = neph_rt_device_download(device, target, words, diag);
    const size_t count = count_output_pixels(device);
    for (size_t i = 0; i < count && !status; i++) {
        float value[4];
        neph_rt_load(&device->view->targets[target], words, find_output_texel(device, target, i),
                     value);
        for (int c = 0; c < 4; c++)
            if (channels[c])
                channels[c][i] = value[c] / exposure;
    }
    free(words);
    return status;
}

enum neph_status neph_rt_resample_image(const struct neph_rt_device *device,
                                        struct neph_image **image, struct neph_diag *diag)
{
    const struct neph_image *rendered = *image;
    struct neph_image *made = NULL;
    enum neph_status status = neph_image_create((int)device->view->picture_px[0],
                                                (int)device->view->picture_px[1], &made, diag);
    for (int c = 0; c < rendered->channel_count && !status; c++) {
        float *samples;
        status = neph_image_add_channel(made, rendered->channels[c].name, &samples, diag);
        for (size_t i = 0; i < count_output_pixels(device) && !status; i++)
            samples[i] = rendered->channels[c].samples[rendered_pixel(device, i)];
    }
    if (status) {
        neph_image_destroy(made);
        return status;
    }
    neph_image_destroy(*image);
    *image = made;
    return NEPH_OK;
}

/* --- given frames -------------------------------------------------------------------------- */

static enum neph_status check_given(const struct neph_gpu_view *view,
                                    const struct neph_image *given, struct neph_diag *diag)
{
    const int width_px = (int)view->size_px[0], height_px = (int)view->size_px[1];
    if (given->width_px != width_px || given->height_px != height_px)
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "the given depth is %dx%d px, the frame to render %dx%d", given->width_px,
                         given->height_px, width_px, height_px);
    const float *depth_m = neph_image_channel(given, "Z");
    if (!depth_m)
        return neph_fail(diag, NEPH_ERR_INPUT, "the given frame has no channel Z");
    for (size_t i = 0; i < neph_image_pixel_count(given); i++)
        if (!(depth_m[i] > 0.0f))
            return neph_fail(diag, NEPH_ERR_INPUT,
                             "the given depth at pixel %zu,%zu is %g m, not above 0",
                             i % (size_t)width_px, i / (size_t)width_px, (double)depth_m[i]);
    float *rgb[3];
    const bool shines = neph_image_rgb(given, NULL, rgb);
    for (int c = 0; shines && c < 3; c++)
        for (size_t i = 0; i < neph_image_pixel_count(given); i++)
            if (!(isfinite(rgb[c][i]) && rgb[c][i] >= 0.0f))
                return neph_fail(diag, NEPH_ERR_INPUT,
                                 "the given radiance at pixel %zu,%zu is %g, not finite and 0 or "
                                 "above",
                                 i % (size_t)width_px, i / (size_t)width_px, (double)rgb[c][i]);
    return NEPH_OK;
}

enum neph_status neph_rt_upload_frame(struct neph_rt_device *device, const struct neph_image *frame,
                                      uint32_t *given, struct neph_diag *diag)
{
    enum neph_status status = check_given(device->view, frame, diag);
    if (status)
        return status;
    float *const depth_m[3] = {neph_image_channel(frame, "Z")};
    float *rgb[3], *const dark[3] = {NULL, NULL, NULL};
    const bool shines = neph_image_rgb(frame, NULL, rgb);
    status = neph_rt_upload_image(device, RT_DEPTH, depth_m, diag);
    if (!status)
        status = neph_rt_upload_image(device, RT_STEADY_DEPTH, depth_m, diag);
    if (!status)
        status = neph_rt_upload_image(device, RT_BEHIND, shines ? rgb : dark, diag);
    if (!status)
        *given |= NEPH_RT_BIT(RT_DEPTH) | NEPH_RT_BIT(RT_STEADY_DEPTH) | NEPH_RT_BIT(RT_BEHIND);
    return status;
}

/* --- finished frames ----------------------------------------------------------------------- */

/* Files have infinity for the sky's depth, and for the distance of a medium without effect. */
static void finish_distances(struct neph_image *image)
{
    float *depth_m = neph_image_channel(image, "Z");
    float *distance_m = neph_image_channel(image, "volume.distance");
    const float *transmittance = neph_image_channel(image, "transmittance.R");
    float *volume[3];
    neph_image_rgb(image, "volume", volume);
    for (size_t i = 0; i < neph_image_pixel_count(image); i++) {
        if (depth_m[i] >= NEPH_GPU_FAR_M)
            depth_m[i] = INFINITY;
        if (transmittance[i] == 1.0f && volume[0][i] + volume[1][i] + volume[2][i] == 0.0f)
            distance_m[i] = INFINITY;
    }
}

struct layers {
    float *rgb[3], *volume[3], *transmittance[3], *depth_m, *distance_m;
};

static enum neph_status add_layers(struct neph_image *frame, struct layers *layers,
                                   struct neph_diag *diag)
{
    enum neph_status status = neph_image_add_rgb(frame, NULL, layers->rgb, diag);
    if (!status)
        status = neph_image_add_rgb(frame, "volume", layers->volume, diag);
    if (!status)
        status = neph_image_add_rgb(frame, "transmittance", layers->transmittance, diag);
    if (!status)
        status = neph_image_add_channel(frame, "Z", &layers->depth_m, diag);
    if (!status)
        status = neph_image_add_channel(frame, "volume.distance", &layers->distance_m, diag);
    return status;
}

static enum neph_status download_layers(struct neph_rt_device *device, int picture,
                                        const struct layers *layers, struct neph_diag *diag)
{
    const struct {
        int target;
        float *channels[4];
    } parts[] = {
        {picture, {layers->rgb[0], layers->rgb[1], layers->rgb[2]}},
        {RT_VOLUME,
         {layers->volume[0], layers->volume[1], layers->volume[2], layers->transmittance[0]}},
        {RT_DEPTH, {layers->depth_m}},
        {RT_VOLUME_DISTANCE, {layers->distance_m}},
    };
    enum neph_status status = NEPH_OK;
    for (size_t i = 0; i < sizeof(parts) / sizeof(parts[0]) && !status; i++)
        status = neph_rt_download_image(device, parts[i].target, parts[i].channels, diag);
    for (int c = 1; c < 3 && !status; c++)
        memcpy(layers->transmittance[c], layers->transmittance[0],
               count_output_pixels(device) * sizeof(float));
    return status;
}

enum neph_status neph_rt_download_frame(struct neph_rt_device *device, int picture,
                                        struct neph_image **frame, struct neph_diag *diag)
{
    struct neph_image *made = NULL;
    struct layers layers;
    enum neph_status status = neph_image_create((int)device->view->picture_px[0],
                                                (int)device->view->picture_px[1], &made, diag);
    if (!status)
        status = add_layers(made, &layers, diag);
    if (!status)
        status = download_layers(device, picture, &layers, diag);
    if (status) {
        neph_image_destroy(made);
        return status;
    }
    finish_distances(made);
    *frame = made;
    return NEPH_OK;
}
