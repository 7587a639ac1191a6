/* SPDX-License-Identifier: MIT
 *
 * The targets of the real-time renderer on a Vulkan device, and one way to run a pass over them.
 * Knows no pass: pipeline.c is the list of these, tests run them one by one.
 */
#ifndef NEPH_RENDERER_REALTIME_DEVICE_H
#define NEPH_RENDERER_REALTIME_DEVICE_H

#include "renderer/compute.h"
#include "renderer/gpu_scene.h"
#include "renderer/realtime/view.h"

/* Ranks of the spatial mask of 64x64 and then of the spatiotemporal one of 64x64x32; the order of
 * renderer/blue_noise.h. */
enum { NEPH_RT_NOISE_SPATIAL = 64 * 64, NEPH_RT_NOISE_COUNT = 64 * 64 * 33 };

/* Members are for pipeline.c and march.c to bind. */
struct neph_rt_device {
    struct neph_vulkan *vulkan; /* borrowed */
    struct neph_rt_view *view;  /* owned; change it between passes at will. Not the device's own:
                                   reading mapped memory of a GPU is slow */
    struct neph_buffer view_buffer; /* owned, as all that follow */
    struct neph_buffer noise;
    struct neph_buffer targets[RT_TARGET_COUNT];
    bool specialises; /* compile the choices into the shaders: faster, but a compilation (seconds on
                         lavapipe) for each set of them. Same bits. */
    struct neph_buffer readback; /* as large as the largest target */
};

/* A shader that includes realtime.glsl; 64 threads a group, along x. */
struct neph_rt_shader {
    const char *name;
    const uint32_t *spirv;
    size_t spirv_size_bytes;
};

/* push_constant Run of shaders/realtime_pass.glsl */
struct neph_rt_run {
    uint32_t first_thread;
    uint32_t colour; /* of tile_index's sequential override, 0..3 */
};

/* Buffers for the targets that `view` describes, all zero, and a copy of the view. `noise_ranks`
 * has NEPH_RT_NOISE_COUNT elements; NULL: zeros. Zero-initialise `device`; free with _destroy, also
 * after an error. NEPH_ERR_UNSUPPORTED: a target is larger than the device lets a kernel see. */
enum neph_status neph_rt_device_create(struct neph_vulkan *vulkan, const struct neph_rt_view *view,
                                       const uint32_t *noise_ranks, struct neph_rt_device *device,
                                       struct neph_diag *diag);
void neph_rt_device_destroy(struct neph_rt_device *device);

/* How many words a target has. */
size_t neph_rt_device_words(const struct neph_rt_device *device, int target);

/* All words of a target, from and to the CPU. */
enum neph_status neph_rt_device_upload(struct neph_rt_device *device, int target,
                                       const uint32_t *words, struct neph_diag *diag);
enum neph_status neph_rt_device_download(struct neph_rt_device *device, int target, uint32_t *words,
                                         struct neph_diag *diag);

/* Give the device the view as it is; _run does so itself. */
void neph_rt_device_show(struct neph_rt_device *device);

/* Specialization constants RT_CHOICE_CONSTANT - 1 and on, of shaders that include realtime.glsl;
 * returns how many constants there are in all. */
int neph_rt_constants(const struct neph_rt_device *device,
                      uint32_t constants[NEPH_KERNEL_CONSTANTS_MAX]);

/* Exchange two targets of the same shape: this frame's history becomes the next one's. */
void neph_rt_device_swap(struct neph_rt_device *device, int a, int b);

/* Run a pass for `thread_count` threads and wait; adds its time on the device to `*gpu_s` (NULL is
 * fine; NaN when there is no clock). */
enum neph_status neph_rt_device_run(struct neph_rt_device *device,
                                    const struct neph_rt_shader *shader, uint32_t colour,
                                    size_t thread_count, double *gpu_s, struct neph_diag *diag);

#endif
