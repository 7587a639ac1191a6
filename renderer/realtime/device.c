/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/device.h"

#include "renderer/realtime/options.h"

#include <stdlib.h>
#include <string.h>

enum { local_size = 64 }; /* of shaders/realtime_pass.glsl */

size_t neph_rt_device_words(const struct neph_rt_device *device, int target)
{
    const struct neph_rt_target *shape = &device->view->targets[target];
    return (size_t)shape->width * shape->height * neph_rt_format_words(shape->format);
}

static enum neph_status create_noise(struct neph_rt_device *device, const uint32_t *ranks,
                                     struct neph_diag *diag)
{
    const size_t size_bytes = NEPH_RT_NOISE_COUNT * sizeof(*ranks);
    const enum neph_status status = neph_buffer_create(device->vulkan, NEPH_BUFFER_UPLOAD,
                                                       size_bytes, "noise", &device->noise, diag);
    if (status)
        return status;
    if (ranks)
        memcpy(device->noise.mapped, ranks, size_bytes);
    else
        memset(device->noise.mapped, 0, size_bytes);
    return NEPH_OK;
}

static enum neph_status create_targets(struct neph_rt_device *device, struct neph_diag *diag)
{
    size_t most = 1;
    enum neph_status status = NEPH_OK;
    for (int t = 0; t < RT_TARGET_COUNT && !status; t++) {
        const size_t words = neph_rt_device_words(device, t);
        most = words > most ? words : most;
        uint32_t *zeros = calloc(words, sizeof(*zeros));
        if (!zeros)
            return neph_fail_memory(diag);
        status = neph_buffer_create(device->vulkan, NEPH_BUFFER_DEVICE, words * sizeof(*zeros),
                                    "target", &device->targets[t], diag);
        if (!status)
            status = neph_rt_device_upload(device, t, zeros, diag);
        free(zeros);
    }
    if (!status)
        status = neph_buffer_create(device->vulkan, NEPH_BUFFER_READBACK, most * sizeof(uint32_t),
                                    "target readback", &device->readback, diag);
    return status;
}

enum neph_status neph_rt_device_create(struct neph_vulkan *vulkan, const struct neph_rt_view *view,
                                       const uint32_t *noise_ranks, struct neph_rt_device *device,
                                       struct neph_diag *diag)
{
    device->vulkan = vulkan;
    enum neph_status status = neph_buffer_create(vulkan, NEPH_BUFFER_UPLOAD, sizeof(*view), "view",
                                                 &device->view_buffer, diag);
    if (status)
        return status;
    device->view = malloc(sizeof(*device->view));
    if (!device->view)
        return neph_fail_memory(diag);
    *device->view = *view;
    status = create_noise(device, noise_ranks, diag);
    return status ? status : create_targets(device, diag);
}

void neph_rt_device_destroy(struct neph_rt_device *device)
{
    if (!device->vulkan)
        return;
    neph_buffer_destroy(device->vulkan, &device->readback);
    for (int t = 0; t < RT_TARGET_COUNT; t++)
        neph_buffer_destroy(device->vulkan, &device->targets[t]);
    neph_buffer_destroy(device->vulkan, &device->noise);
    neph_buffer_destroy(device->vulkan, &device->view_buffer);
    free(device->view);
    *device = (struct neph_rt_device){0};
}

enum neph_status neph_rt_device_upload(struct neph_rt_device *device, int target,
                                       const uint32_t *words, struct neph_diag *diag)
{
    return neph_buffer_upload(device->vulkan, &device->targets[target], 0, words,
                              neph_rt_device_words(device, target) * sizeof(*words), diag);
}

enum neph_status neph_rt_device_download(struct neph_rt_device *device, int target, uint32_t *words,
                                         struct neph_diag *diag)
{
    const size_t size_bytes = neph_rt_device_words(device, target) * sizeof(*words);
    const enum neph_status status = neph_buffer_download(device->vulkan, &device->targets[target],
                                                         &device->readback, size_bytes, diag);
    if (!status)
        memcpy(words, device->readback.mapped, size_bytes);
    return status;
}

void neph_rt_device_show(struct neph_rt_device *device)
{
    memcpy(device->view_buffer.mapped, device->view, sizeof(*device->view));
}

void neph_rt_device_swap(struct neph_rt_device *device, int a, int b)
{
    const struct neph_buffer kept = device->targets[a];
    device->targets[a] = device->targets[b];
    device->targets[b] = kept;
}

int neph_rt_constants(const struct neph_rt_device *device,
                      uint32_t constants[NEPH_KERNEL_CONSTANTS_MAX])
{
    constants[RT_CHOICE_CONSTANT - 1] = device->specialises;
    for (int s = 0; s < RT_SETTING_COUNT && device->specialises; s++) {
        const float value = device->view->settings[s];
        const bool is_choice = neph_rt_options[s].kind == NEPH_OPTION_CHOICE;
        constants[RT_CHOICE_CONSTANT + s] = is_choice ? (uint32_t)value : value != 0.0f;
    }
    return RT_CHOICE_CONSTANT + RT_SETTING_COUNT;
}

enum neph_status neph_rt_device_run(struct neph_rt_device *device,
                                    const struct neph_rt_shader *shader, uint32_t colour,
                                    size_t thread_count, double *gpu_s, struct neph_diag *diag)
{
    struct neph_kernel_params params = {
        .name = shader->name,
        .spirv = shader->spirv,
        .spirv_size_bytes = shader->spirv_size_bytes,
        .buffer_count = 2,
        .array_count = RT_TARGET_COUNT,
        .push_size_bytes = sizeof(struct neph_rt_run),
    };
    params.constant_count = neph_rt_constants(device, params.constants);
    const struct neph_kernel *kernel;
    neph_rt_device_show(device);
    enum neph_status status = neph_kernel_get(device->vulkan, &params, &kernel, diag);
    const size_t groups_max = device->vulkan->limits.maxComputeWorkGroupCount[0];
    for (size_t first = 0; first < thread_count && !status; first += groups_max * local_size) {
        const size_t left = (thread_count - first + local_size - 1) / local_size;
        const struct neph_rt_run run = {(uint32_t)first, colour};
        struct neph_dispatch dispatch = {
            .buffers = {&device->view_buffer, &device->noise},
            .push = &run,
            .group_count = (uint32_t)(left < groups_max ? left : groups_max),
        };
        for (int t = 0; t < RT_TARGET_COUNT; t++)
            dispatch.buffers[2 + t] = &device->targets[t];
        double spent_s;
        status = neph_kernel_run(device->vulkan, kernel, &dispatch, &spent_s, diag);
        if (!status && gpu_s)
            *gpu_s += spent_s;
    }
    return status;
}
