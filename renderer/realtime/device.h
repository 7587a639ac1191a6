/* SPDX-License-Identifier: MIT
 *
 * The targets of the real-time renderer on a Vulkan device, and one way to run a pass over them,
 * for pipeline.c and for tests that run one alone.
 */
#ifndef NEPH_RENDERER_REALTIME_DEVICE_H
#define NEPH_RENDERER_REALTIME_DEVICE_H

#include "renderer/gpu_scene.h"
#include "renderer/halves.h"
#include "renderer/in_flight.h"
#include "renderer/realtime/submission.h"

/* Ranks of the spatial mask of 64x64 and then of the spatiotemporal one of 64x64x32; the order of
 * renderer/blue_noise.h. */
enum { NEPH_RT_NOISE_COUNT = 64 * 64 * 33 };

struct neph_rt_device {
    struct neph_vulkan *vulkan; /* borrowed */
    struct neph_gpu_view *view; /* owned; change it between passes at will. Not the device's own:
                                   reading mapped memory of a GPU is slow */
    struct neph_buffer view_buffer; /* owned, as all that follow */
    struct neph_turns view_turns;
    struct neph_buffer noise;
    struct neph_buffer targets[RT_TARGET_COUNT]; /* without memory where not asked for */
    struct neph_buffer nothing; /* one word, where a pass does not declare a target */
    bool specialises; /* compile the choices into the shaders: faster, but a compilation (seconds on
                         lavapipe) for each set of them. Same bits. */
    bool is_dark; /* rays see transmittance alone, and have no noise (ray_march/ray_march.comp) */
    enum neph_rt_device_kind kind; /* kernels are compiled for it */
    bool has_no_variants;   /* run the readable shader of each pass, for tests and comparisons */
    uint32_t native_halves; /* NEPH_HALVES_READ, ..: what the driver may do itself; 0 on a CPU, so
                               that nobody has to be asked there. Same bits. */
    struct neph_buffer readback; /* as large as the largest target */
};

/* Buffers for some targets (NEPH_RT_BIT() of each) as `view` describes them, all zero, and a copy
 * of the view. `noise_ranks` has NEPH_RT_NOISE_COUNT elements; NULL: zeros. Zero-initialise
 * `device`; free with _destroy, also after an error. NEPH_ERR_UNSUPPORTED: a target is larger than
 * the device lets a kernel see. */
enum neph_status neph_rt_device_create(struct neph_vulkan *vulkan, const struct neph_gpu_view *view,
                                       uint32_t targets, const uint32_t *noise_ranks,
                                       struct neph_rt_device *device, struct neph_diag *diag);
void neph_rt_device_destroy(struct neph_rt_device *device);

/* Another buffer for a target, all zero. Zero-initialise `buffer`; its owner destroys it, also
 * after an error. */
enum neph_status neph_rt_device_add_target(struct neph_rt_device *device, int target,
                                           struct neph_buffer *buffer, struct neph_diag *diag);

/* The shader of a pass on this device. */
const struct neph_rt_shader *neph_rt_device_shader(const struct neph_rt_device *device,
                                                   const struct neph_rt_pass *pass);

/* How many words a target has; 0 where it has no memory. */
size_t neph_rt_device_words(const struct neph_rt_device *device, int target);

/* All words of a target, from and to the CPU. */
enum neph_status neph_rt_device_upload(struct neph_rt_device *device, int target,
                                       const uint32_t *words, struct neph_diag *diag);
enum neph_status neph_rt_device_download(struct neph_rt_device *device, int target, uint32_t *words,
                                         struct neph_diag *diag);

/* What a pass hands on gets its name in the next frame. */
void neph_rt_device_hand_on(struct neph_rt_device *device, const struct neph_rt_pass *pass);

/* Show the device the view as it is, in memory of which nothing that is on its way may be in need:
 * neph_turns_take(). */
void neph_rt_device_show(struct neph_rt_device *device);

/* Fill in what a pass needs behind `first` other buffers and the constants of theirs: the view, the
 * noise and the targets that it declares. */
void neph_rt_device_bind(struct neph_rt_device *device, const struct neph_rt_pass *pass, int first,
                         struct neph_kernel_params *params, struct neph_dispatch *dispatch);

/* Compile a pass without rays for pictures at rest, for those that are known to be steady and for
 * others, so that none waits for that when the camera starts or stops. */
enum neph_status neph_rt_device_prepare(struct neph_rt_device *device,
                                        const struct neph_rt_pass *pass, struct neph_diag *diag);

/* Ask for the kernel of a pass without rays, which is made while others are asked for. */
enum neph_status neph_rt_device_ask(struct neph_rt_device *device, const struct neph_rt_pass *pass,
                                    struct neph_diag *diag);

/* Add a pass without rays to what is on its way. */
enum neph_status neph_rt_device_add(struct neph_rt_device *device, const struct neph_rt_pass *pass,
                                    struct neph_rt_submission *submission, struct neph_diag *diag);

/* Run it alone, with the view as it is. */
enum neph_status neph_rt_device_run(struct neph_rt_device *device, const struct neph_rt_pass *pass,
                                    struct neph_diag *diag);

#endif
