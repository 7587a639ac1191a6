/* SPDX-License-Identifier: MIT
 *
 * A thin layer over Vulkan for the renderers of this folder: buffers, images, compute kernels,
 * batches of dispatches. Not for other folders.
 */
#ifndef NEPH_RENDERER_COMPUTE_H
#define NEPH_RENDERER_COMPUTE_H

#include "renderer/kernel.h"
#include "renderer/lane.h"

#include <stddef.h>

/* Limit of loop iterations of one thread in one dispatch: all its loops together, each with its
 * final failing test. lavapipe leaves every loop after 65535 iterations without an error (Mesa,
 * lp_bld_limits.h: LP_MAX_TGSI_LOOP_ITERATIONS, "shared between every loop"); a GPU has a watchdog
 * instead. Longer work must be split into several dispatches. */
#define NEPH_KERNEL_LOOP_ITERATIONS_MAX 65000

/* --- buffers ------------------------------------------------------------------------------ */

enum neph_buffer_use {
    NEPH_BUFFER_UPLOAD,   /* written by the CPU, read by kernels, source of copies */
    NEPH_BUFFER_DEVICE,   /* written and read by kernels, source and target of copies */
    NEPH_BUFFER_READBACK, /* target of copies, read by the CPU */
    NEPH_BUFFER_USE_COUNT,
};

/* Texel views of a buffer, with texels of one, two and four words; none on a GPU. */
struct neph_texel_views {
    VkBufferView formats[NEPH_GPU_TEXEL_FORMATS];
};

/* One storage buffer in its own allocation. */
struct neph_buffer {
    VkBuffer handle;
    VkDeviceMemory memory;
    size_t size_bytes;
    void *mapped;                   /* coherent; NULL for NEPH_BUFFER_DEVICE */
    struct neph_texel_views texels; /* made by neph_buffer_create_texel_views() */
};

/* NEPH_ERR_UNSUPPORTED: larger than the device lets a kernel bind. Zero-initialise `buffer`; free
 * with _destroy. */
enum neph_status neph_buffer_create(const struct neph_vulkan *vulkan, enum neph_buffer_use use,
                                    size_t size_bytes, const char *name, struct neph_buffer *buffer,
                                    struct neph_diag *diag);

/* On a CPU, create texel views of a NEPH_BUFFER_DEVICE buffer, with texels of one, two and four
 * words of 32 bits. lavapipe reads words of a storage buffer in a loop over the lanes, with a
 * bounds test for each, but such texels of all lanes in a few instructions. All descriptors of an
 * array must have the format of the array, so kernels have one array for each format (from
 * NEPH_GPU_TEXELS_BINDING on), and each buffer needs all three views. On a GPU this does nothing.
 * NEPH_ERR_UNSUPPORTED: the buffer has more words than a texel view may have. */
enum neph_status neph_buffer_create_texel_views(const struct neph_vulkan *vulkan,
                                                struct neph_buffer *buffer, struct neph_diag *diag);

/* The index of a memory type: the first of `allowed_types` (a bit each) with all `needed`
 * properties, preferably with the `liked` ones as well; UINT32_MAX: none. */
uint32_t neph_memory_type(const struct neph_vulkan *vulkan, uint32_t allowed_types,
                          VkMemoryPropertyFlags needed, VkMemoryPropertyFlags liked);

/* Copy `size_bytes` from the CPU to `offset_bytes` of a NEPH_BUFFER_DEVICE buffer, through a
 * staging buffer of at most 16 MiB, and wait. */
enum neph_status neph_buffer_upload(const struct neph_vulkan *vulkan,
                                    const struct neph_buffer *buffer, size_t offset_bytes,
                                    const void *data, size_t size_bytes, struct neph_diag *diag);

/* Submit a copy of the first bytes of a NEPH_BUFFER_UPLOAD buffer to `offset_bytes` of a
 * NEPH_BUFFER_DEVICE one: a batch, whose time is added to `*gpu_s` when it is collected; NULL: not
 * reported. `from` must not change until then. */
enum neph_status neph_copy_submit(const struct neph_vulkan *vulkan, const struct neph_buffer *from,
                                  const struct neph_buffer *to, size_t offset_bytes,
                                  size_t size_bytes, double *gpu_s, struct neph_diag *diag);

/* Copy the first bytes of a NEPH_BUFFER_DEVICE buffer to a NEPH_BUFFER_READBACK one, and wait. */
enum neph_status neph_buffer_download(const struct neph_vulkan *vulkan,
                                      const struct neph_buffer *buffer,
                                      const struct neph_buffer *readback, size_t size_bytes,
                                      struct neph_diag *diag);

/* A zero-initialised buffer is fine. Waits for all submitted work. */
void neph_buffer_destroy(const struct neph_vulkan *vulkan, struct neph_buffer *buffer);

/* Create buffers row by row, up to the first failure. Each is zero-initialised by the caller and
 * freed like a buffer of neph_buffer_create(). */
struct neph_buffer_row {
    struct neph_buffer *buffer;
    enum neph_buffer_use use;
    size_t size_bytes;
    const char *name;
};
enum neph_status neph_buffers_create(const struct neph_vulkan *vulkan,
                                     const struct neph_buffer_row *rows, size_t row_count,
                                     struct neph_diag *diag);

/* --- images ------------------------------------------------------------------------------- */

/* A 3D image with its sampler, for kernels. texture.h creates and destroys it. */
struct neph_texture {
    VkImage image;
    VkDeviceMemory memory;
    uint64_t memory_bytes;
    VkImageView view;
    VkSampler sampler;
};

/* --- running kernels ---------------------------------------------------------------------- */

struct neph_dispatch {
    const struct neph_buffer *buffers[NEPH_KERNEL_BUFFERS_MAX]; /* the buffers of the array come
                                                                   last */
    const struct neph_texture *images[NEPH_KERNEL_IMAGES_MAX];
    const void *push; /* of the kernel's push_size_bytes */
    uint32_t group_count;
    /* Optional copy of the first bytes of a buffer to the CPU after the dispatch; NULL: no copy. */
    const struct neph_buffer *copy_from, *copy_to;
    size_t copy_size_bytes;
};

/* A batch of dispatches, submitted together. It runs after all batches submitted before. Only one
 * batch of a device is recorded at a time, and no copy is made meanwhile; a few more may be in
 * flight (lane.h). */
struct neph_batch {
    const struct neph_vulkan *vulkan; /* borrowed */
    struct neph_lane *lane;           /* borrowed */
    const struct neph_kernel *bound;
    VkDescriptorSet bound_set;
    enum neph_status status; /* the first failure: later calls record and submit nothing */
};

/* Begin a batch; waits for an earlier batch when too many are in flight. A batch that is never
 * submitted has no effect. A caller may check the status only at _send: errors of this and of
 * _dispatch are stored in the batch. */
enum neph_status neph_batch_begin(const struct neph_vulkan *vulkan, struct neph_batch *batch,
                                  struct neph_diag *diag);

/* Add a dispatch, without its copy. If the kernel is not compiled yet, submits the dispatches so
 * far and waits for it. NEPH_ERR_INTERNAL, NEPH_ERR_ENGINE: the kernel cannot be compiled.
 * NEPH_ERR_UNSUPPORTED: more work groups than the device allows. */
enum neph_status neph_batch_dispatch(struct neph_batch *batch, const struct neph_kernel *kernel,
                                     const struct neph_dispatch *dispatch, struct neph_diag *diag);

/* A memory barrier between dispatches: later ones see the writes of earlier ones, and write only
 * after earlier ones have read. */
void neph_batch_barrier(struct neph_batch *batch);

/* Record a timestamp after the commands so far, at most NEPH_LANE_STAMPS_MAX times. When the batch
 * is collected, the time since the previous timestamp (or the start of the batch) is added to
 * `*seconds`, NaN when the device has no clock; `seconds` must stay valid until then. NULL: the
 * time is not reported. */
void neph_batch_stamp(struct neph_batch *batch, double *seconds);

/* Submit the batch, unless an earlier call failed. Memory that its kernels read must not change
 * until the batch is collected. `what` names it in errors. NEPH_ERR_ENGINE: the device was lost. */
enum neph_status neph_batch_submit(struct neph_batch *batch, const char *what,
                                   struct neph_diag *diag);

/* Submit a batch of one dispatch; its time is added to `*gpu_s` when it is collected. */
enum neph_status neph_dispatch_submit(const struct neph_vulkan *vulkan,
                                      const struct neph_kernel *kernel,
                                      const struct neph_dispatch *dispatch, const char *what,
                                      double *gpu_s, struct neph_diag *diag);

/* The number of batches submitted to the device so far, for _wait. */
uint64_t neph_batches_submitted(const struct neph_vulkan *vulkan);

/* Wait until the first `count` batches are collected: done, visible to the CPU, their times added.
 */
enum neph_status neph_batches_wait(const struct neph_vulkan *vulkan, uint64_t count,
                                   const char *what, struct neph_diag *diag);

/* Run a kernel and wait for it. `*gpu_s` receives the device time of the dispatch (timestamps; NaN
 * without a clock); NULL is fine. NEPH_ERR_ENGINE: the device was lost. */
enum neph_status neph_kernel_run(const struct neph_vulkan *vulkan, const struct neph_kernel *kernel,
                                 const struct neph_dispatch *dispatch, double *gpu_s,
                                 struct neph_diag *diag);

#endif
