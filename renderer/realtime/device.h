/* SPDX-License-Identifier: MIT
 *
 * The images of the real-time renderer (targets) on a Vulkan device, and functions that record and
 * run one pass on them. For pipeline.c, and for tests that run a single pass.
 */
#ifndef NEPH_RENDERER_REALTIME_DEVICE_H
#define NEPH_RENDERER_REALTIME_DEVICE_H

#include "renderer/gpu_scene.h"
#include "renderer/halves.h"
#include "renderer/in_flight.h"
#include "renderer/realtime/submission.h"

/* Ranks of the spatial 64x64 mask, then of the spatiotemporal 64x64x32 mask, in the order of
 * renderer/blue_noise.h. */
enum { NEPH_RT_NOISE_COUNT = 64 * 64 * 33 };

struct neph_rt_device {
    struct neph_vulkan *vulkan; /* borrowed */
    struct neph_gpu_view *view; /* owned; may change between passes. In CPU memory: reading mapped
                                   memory of a GPU is slow */
    struct neph_buffer view_buffer; /* owned, like all buffers below */
    struct neph_buffer_ring view_turns;
    struct neph_buffer noise;
    struct neph_buffer targets[RT_TARGET_COUNT]; /* no memory for targets that are not requested */
    struct neph_buffer nothing; /* one word, bound for targets that a pass does not declare */
    bool specialises; /* compile the choices into the shaders: faster, but each set of choices is
                         compiled separately (seconds on lavapipe). Same bits. */
    bool is_dark; /* rays compute only transmittance, without noise (ray_march/ray_march.comp) */
    enum neph_rt_device_kind kind; /* selects the shader variants */
    bool has_no_variants;   /* run the readable shader of each pass, for tests and comparisons */
    uint32_t native_halves; /* NEPH_HALVES_READ, ..: conversions left to the driver; 0 on a CPU,
                               where the driver is not tested for them. Same bits. */
    struct neph_buffer readback; /* as large as the largest target */
};

/* Creates buffers for some targets (NEPH_RT_BIT() of each) with the shapes in `view`, all zero, and
 * a copy of the view. `noise_ranks` has NEPH_RT_NOISE_COUNT elements; NULL: zeros. Zero-initialise
 * `device`; free it with _destroy, also after an error. NEPH_ERR_UNSUPPORTED: a target is larger
 * than a storage buffer may be on this device. */
enum neph_status neph_rt_device_create(struct neph_vulkan *vulkan, const struct neph_gpu_view *view,
                                       uint32_t targets, const uint32_t *noise_ranks,
                                       struct neph_rt_device *device, struct neph_diag *diag);
void neph_rt_device_destroy(struct neph_rt_device *device);

/* Creates another buffer for a target, all zero. Zero-initialise `buffer`; the caller destroys it,
 * also after an error. */
enum neph_status neph_rt_device_add_target(struct neph_rt_device *device, int target,
                                           struct neph_buffer *buffer, struct neph_diag *diag);

/* The shader that runs a pass on this device: a variant or the readable one. */
const struct neph_rt_shader *neph_rt_device_shader(const struct neph_rt_device *device,
                                                   const struct neph_rt_pass *pass);

/* Number of 32-bit words of a target; 0 when it has no memory. */
size_t neph_rt_device_words(const struct neph_rt_device *device, int target);

/* Copies all words of a target from or to the CPU. */
enum neph_status neph_rt_device_upload(struct neph_rt_device *device, int target,
                                       const uint32_t *words, struct neph_diag *diag);
enum neph_status neph_rt_device_download(struct neph_rt_device *device, int target, uint32_t *words,
                                         struct neph_diag *diag);

/* Swaps the buffers of each target of a pass that is a history in the next frame. */
void neph_rt_device_swap_histories(struct neph_rt_device *device, const struct neph_rt_pass *pass);

/* Copies the view to the device, into memory that no frame in flight reads:
 * neph_buffer_ring_advance(). */
void neph_rt_device_upload_view(struct neph_rt_device *device);

/* Binds the view, the noise and the targets that a pass declares, after `first` other buffers and
 * their constants. */
void neph_rt_device_bind(struct neph_rt_device *device, const struct neph_rt_pass *pass, int first,
                         struct neph_kernel_params *params, struct neph_dispatch *dispatch);

/* Compiles a pass without rays for moving frames, for static ones and for those with RT_STEADY, so
 * that no frame waits for the compiler when the camera starts or stops. */
enum neph_status neph_rt_device_prepare(struct neph_rt_device *device,
                                        const struct neph_rt_pass *pass, struct neph_diag *diag);

/* Starts to compile the kernel of a pass without rays, in parallel with others. */
enum neph_status neph_rt_device_start_kernel(struct neph_rt_device *device,
                                             const struct neph_rt_pass *pass,
                                             struct neph_diag *diag);

/* Records a pass without rays into a submission. */
enum neph_status neph_rt_device_add(struct neph_rt_device *device, const struct neph_rt_pass *pass,
                                    struct neph_rt_submission *submission, struct neph_diag *diag);

/* Runs one pass and waits for it, with the present view. */
enum neph_status neph_rt_device_run(struct neph_rt_device *device, const struct neph_rt_pass *pass,
                                    struct neph_diag *diag);

#endif
