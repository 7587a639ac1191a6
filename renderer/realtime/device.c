/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/device.h"

#include "renderer/realtime/options.h"
#include "renderer/realtime/output_elision.h"

#include <stdlib.h>
#include <string.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_OPTION_KIND_COUNT == 3, "a new kind");

enum { local_size = 64 }; /* of realtime/shared/pass.glsl */

size_t neph_rt_device_words(const struct neph_rt_device *device, int target)
{
    return device->targets[target].size_bytes / sizeof(uint32_t);
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

enum neph_status neph_rt_device_add_target(struct neph_rt_device *device, int target,
                                           struct neph_buffer *buffer, struct neph_diag *diag)
{
    const struct neph_gpu_target *shape = &device->view->targets[target];
    const size_t words = (size_t)shape->width * shape->height * neph_rt_format_words(shape->format);
    uint32_t *zeros = calloc(words, sizeof(*zeros));
    if (!zeros)
        return neph_fail_memory(diag);
    enum neph_status status = neph_buffer_create(device->vulkan, NEPH_BUFFER_DEVICE,
                                                 words * sizeof(*zeros),
                                                 neph_rt_target_name(target), buffer, diag);
    if (!status)
        status = neph_buffer_create_texel_views(device->vulkan, buffer, diag);
    if (!status)
        status = neph_buffer_upload(device->vulkan, buffer, 0, zeros, words * sizeof(*zeros), diag);
    free(zeros);
    return status;
}

static enum neph_status create_targets(struct neph_rt_device *device, uint32_t targets,
                                       struct neph_diag *diag)
{
    size_t most_bytes = sizeof(uint32_t);
    enum neph_status status = NEPH_OK;
    for (int t = 0; t < RT_TARGET_COUNT && !status; t++) {
        if (!(targets & NEPH_RT_BIT(t)))
            continue;
        status = neph_rt_device_add_target(device, t, &device->targets[t], diag);
        const size_t bytes = device->targets[t].size_bytes;
        most_bytes = bytes > most_bytes ? bytes : most_bytes;
    }
    if (!status)
        status = neph_buffer_create(device->vulkan, NEPH_BUFFER_DEVICE, sizeof(uint32_t), "nothing",
                                    &device->nothing, diag);
    if (!status)
        status = neph_buffer_create_texel_views(device->vulkan, &device->nothing, diag);
    if (!status)
        status = neph_buffer_create(device->vulkan, NEPH_BUFFER_READBACK, most_bytes,
                                    "target readback", &device->readback, diag);
    return status;
}

enum neph_status neph_rt_device_create(struct neph_vulkan *vulkan, const struct neph_gpu_view *view,
                                       uint32_t targets, const uint32_t *noise_ranks,
                                       struct neph_rt_device *device, struct neph_diag *diag)
{
    device->vulkan = vulkan;
    enum neph_status status = neph_buffer_create(vulkan, NEPH_BUFFER_UPLOAD, sizeof(*view), "view",
                                                 &device->view_buffer, diag);
    if (!status)
        status = neph_buffer_ring_create(vulkan, &device->view_buffer, "view", &device->view_turns,
                                         diag);
    if (status)
        return status;
    device->view = malloc(sizeof(*device->view));
    if (!device->view)
        return neph_fail_memory(diag);
    *device->view = *view;
    status = create_noise(device, noise_ranks, diag);
    device->kind = vulkan->description.is_cpu ? NEPH_RT_CPU : NEPH_RT_GPU;
    if (!status && neph_rt_get_tuning(device->kind)->has_driver_halves)
        status = neph_halves_test(vulkan, &device->native_halves, diag);
    return status ? status : create_targets(device, targets, diag);
}

void neph_rt_device_destroy(struct neph_rt_device *device)
{
    if (!device->vulkan)
        return;
    neph_buffer_destroy(device->vulkan, &device->readback);
    neph_buffer_destroy(device->vulkan, &device->nothing);
    for (int t = 0; t < RT_TARGET_COUNT; t++)
        neph_buffer_destroy(device->vulkan, &device->targets[t]);
    neph_buffer_destroy(device->vulkan, &device->noise);
    neph_buffer_ring_destroy(device->vulkan, &device->view_turns);
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

/* --- passes --------------------------------------------------------------------------------- */

void neph_rt_device_swap_histories(struct neph_rt_device *device, const struct neph_rt_pass *pass)
{
    for (int i = 0; i < NEPH_RT_HISTORIES_MAX && pass->histories[i].before; i++) {
        const struct neph_rt_history history = pass->histories[i];
        if (neph_rt_find_buffer(device->view, history.now) == history.before)
            continue; /* it is there */
        const struct neph_buffer before = device->targets[history.before];
        device->targets[history.before] = device->targets[history.now];
        device->targets[history.now] = before;
    }
}

const struct neph_rt_shader *neph_rt_device_shader(const struct neph_rt_device *device,
                                                   const struct neph_rt_pass *pass)
{
    return device->has_no_variants ? &pass->shader
                                   : neph_rt_shader_for(device->view, pass, device->kind);
}

/* The digit of a setting for the shaders (realtime/shared/choices.glsl). */
static uint32_t encode_digit(int setting, float value)
{
    if (setting >= RT_SETTING_COUNT || neph_rt_options[setting].kind == NEPH_OPTION_CHOICE)
        return (uint32_t)value;
    if (setting == RT_TAA_JITTER_LENGTH)
        return value < 15.0f ? (uint32_t)value : 15;
    return value != 0.0f;
}

static uint32_t find_static_parts(const struct neph_rt_device *device)
{
    const bool all_rest = neph_rt_is_view_static(device->view);
    const bool is_medium_static = all_rest || (neph_rt_get_tuning(device->kind)->has_air_kernels &&
                                               neph_rt_is_medium_static(device->view));
    return (all_rest ? RT_STATIC_VIEW : 0u) | (is_medium_static ? RT_STATIC_MEDIUM : 0u);
}

static bool is_static_setting(int setting)
{
    return setting == RT_STEADY || setting == RT_SOLID_MOTION;
}

/* Specialization constants of realtime/shared/choices.glsl. Passes with rays take longest to
 * compile and do not depend on motion: they have one kernel for static and moving frames. */
static void set_choices(const struct neph_rt_device *device, const struct neph_rt_pass *pass,
                        struct neph_kernel_params *params)
{
    const float *values = device->view->settings;
    params->constant_count = RT_CONSTANT_COUNT;
    params->constants[RT_HALVES_CONSTANT] = device->native_halves;
    params->constants[RT_GPU_ACCESS_CONSTANT] = device->kind == NEPH_RT_GPU;
    params->constants[RT_STATIC_CONSTANT] = pass->rays ? 0u : find_static_parts(device);
    params->constants[RT_SPECIALISED_CONSTANT] = device->specialises;
    params->constants[RT_DARK_CONSTANT] = device->is_dark;
    params->constants[RT_ROLE_CONSTANT] = (uint32_t)pass->role;
    for (int s = 0; s < RT_NUMBER_COUNT && device->specialises; s++)
        if (!pass->rays || !is_static_setting(s))
            params->constants[RT_CHOICE_CONSTANT + s / 8] |= encode_digit(s, values[s])
                                                             << 4 * (s % 8);
}

void neph_rt_device_upload_view(struct neph_rt_device *device)
{
    memcpy(device->view_buffer.mapped, device->view, sizeof(*device->view));
}

void neph_rt_device_bind(struct neph_rt_device *device, const struct neph_rt_pass *pass, int first,
                         struct neph_kernel_params *params, struct neph_dispatch *dispatch)
{
    const struct neph_rt_shader *shader = neph_rt_device_shader(device, pass);
    params->name = shader->name;
    params->code = shader->code;
    params->code_bytes = shader->code_bytes;
    params->buffer_count = first + 2;
    params->array_count = pass->rays ? RT_RAY_TARGET_COUNT : RT_TARGET_COUNT;
    if (first == 0) { /* no scene before the view */
        params->uniform_count = 1;
        params->texels_first = 2;
        const int counts[] = {RT_WORD_TARGET_COUNT, RT_PAIR_TARGET_COUNT, RT_TARGET_COUNT};
        _Static_assert(sizeof(counts) == sizeof(params->texels_count), "a count each");
        memcpy(params->texels_count, counts, sizeof(counts));
    }
    set_choices(device, pass, params);
    dispatch->buffers[first] = &device->view_buffer;
    dispatch->buffers[first + 1] = &device->noise;
    const uint32_t touched = neph_rt_targets_touched(device->view, pass);
    for (int t = 0; t < (int)params->array_count; t++)
        dispatch->buffers[first + 2 + t] =
            touched & NEPH_RT_BIT(t) ? &device->targets[neph_rt_find_buffer(device->view, t)]
                                     : &device->nothing;
}

static enum neph_status add_colour(struct neph_rt_device *device, const struct neph_rt_pass *pass,
                                   const struct neph_kernel *kernel, struct neph_dispatch *dispatch,
                                   uint32_t colour, struct neph_rt_submission *submission,
                                   struct neph_diag *diag)
{
    const uint64_t groups_max = device->vulkan->limits.maxComputeWorkGroupCount[0];
    const uint64_t count = neph_rt_thread_count(device->view, pass,
                                                neph_rt_device_shader(device, pass));
    enum neph_status status = NEPH_OK;
    for (uint64_t first = 0; first < count && !status; first += groups_max * local_size) {
        const uint64_t groups = (count - first + local_size - 1) / local_size;
        const struct neph_gpu_pass_run run = {(uint32_t)first, colour};
        dispatch->push = &run;
        dispatch->group_count = (uint32_t)(groups < groups_max ? groups : groups_max);
        status = neph_rt_submission_add(submission, pass, kernel, dispatch, diag);
    }
    return status;
}

/* Kinds of frames with separate kernels. */
enum { SOLIDS_MOVING, MOVING, STATIC, KNOWN_STATIC, KINDS };

enum neph_status neph_rt_device_prepare(struct neph_rt_device *device,
                                        const struct neph_rt_pass *pass, struct neph_diag *diag)
{
    const struct neph_kernel *kernel;
    enum neph_status status = NEPH_OK;
    float *settings = device->view->settings;
    const float steady = settings[RT_STEADY], solid_motion = settings[RT_SOLID_MOTION];
    for (int kind = solid_motion == 0.0f ? MOVING : SOLIDS_MOVING; kind < KINDS && !status;
         kind++) {
        settings[RT_STEADY] = kind == KNOWN_STATIC ? RT_STEADY_KNOWN : steady;
        settings[RT_SOLID_MOTION] = kind == SOLIDS_MOVING ? solid_motion : 0.0f;
        if ((kind == KNOWN_STATIC && neph_rt_is_pass_skipped(device->view, pass)) ||
            !neph_rt_is_condition_met(device->view, pass->condition))
            continue;
        struct neph_kernel_params params = {.push_size_bytes = sizeof(struct neph_gpu_pass_run)};
        struct neph_dispatch dispatch = {.group_count = 0};
        neph_rt_device_bind(device, pass, 0, &params, &dispatch);
        params.constants[RT_STATIC_CONSTANT] = kind >= STATIC ? RT_STATIC_VIEW | RT_STATIC_MEDIUM
                                                              : 0u;
        status = neph_kernel_get(device->vulkan, &params, &kernel, diag);
    }
    settings[RT_STEADY] = steady;
    settings[RT_SOLID_MOTION] = solid_motion;
    return status;
}

static enum neph_status bind_pass(struct neph_rt_device *device, const struct neph_rt_pass *pass,
                                  struct neph_dispatch *dispatch, const struct neph_kernel **kernel,
                                  struct neph_diag *diag)
{
    struct neph_kernel_params params = {.push_size_bytes = sizeof(struct neph_gpu_pass_run)};
    neph_rt_device_bind(device, pass, 0, &params, dispatch);
    return neph_kernel_get(device->vulkan, &params, kernel, diag);
}

enum neph_status neph_rt_device_start_kernel(struct neph_rt_device *device,
                                             const struct neph_rt_pass *pass,
                                             struct neph_diag *diag)
{
    struct neph_dispatch dispatch = {.group_count = 0};
    const struct neph_kernel *kernel;
    return bind_pass(device, pass, &dispatch, &kernel, diag);
}

enum neph_status neph_rt_device_add(struct neph_rt_device *device, const struct neph_rt_pass *pass,
                                    struct neph_rt_submission *submission, struct neph_diag *diag)
{
    struct neph_dispatch dispatch = {.group_count = 0};
    const struct neph_kernel *kernel;
    enum neph_status status = bind_pass(device, pass, &dispatch, &kernel, diag);
    const uint32_t colours = neph_rt_colour_count(device->view, pass,
                                                  neph_rt_device_shader(device, pass));
    for (uint32_t colour = 0; colour < colours && !status; colour++)
        status = add_colour(device, pass, kernel, &dispatch, colour, submission, diag);
    return status;
}

enum neph_status neph_rt_device_run(struct neph_rt_device *device, const struct neph_rt_pass *pass,
                                    struct neph_diag *diag)
{
    struct neph_rt_submission submission = {.vulkan = device->vulkan};
    neph_rt_device_upload_view(device);
    const enum neph_status status = neph_rt_device_add(device, pass, &submission, diag);
    return status ? status : neph_rt_submission_wait(&submission, diag);
}
