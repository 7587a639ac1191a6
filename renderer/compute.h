/* SPDX-License-Identifier: MIT
 *
 * The little of Vulkan that the renderers of this folder need: buffers, compute kernels, and one
 * way to run them that waits for the end. Not for other folders.
 */
#ifndef NEPH_RENDERER_COMPUTE_H
#define NEPH_RENDERER_COMPUTE_H

#include "renderer/kernel.h"
#include "renderer/lane.h"

#include <stddef.h>

/* Loop turns that one thread may make in one dispatch, all its loops together, the last failing
 * test of each included. lavapipe leaves every loop after 65535 of them, in silence (Mesa,
 * lp_bld_limits.h: LP_MAX_TGSI_LOOP_ITERATIONS, "shared between every loop"); a GPU has a watchdog
 * instead. Longer work must be cut into several dispatches. */
#define NEPH_KERNEL_LOOP_TURNS_MAX 65000

/* --- buffers ------------------------------------------------------------------------------ */

enum neph_buffer_use {
    NEPH_BUFFER_UPLOAD,   /* written by the CPU, read by kernels, source of copies */
    NEPH_BUFFER_DEVICE,   /* written and read by kernels, source and target of copies */
    NEPH_BUFFER_READBACK, /* target of copies, read by the CPU */
    NEPH_BUFFER_USE_COUNT,
};

/* A buffer as texels of one, two and four words; none on a GPU. */
struct neph_texel_views {
    VkBufferView formats[NEPH_GPU_TEXEL_FORMATS];
};

/* One storage buffer in its own allocation. */
struct neph_buffer {
    VkBuffer handle;
    VkDeviceMemory memory;
    size_t size_bytes;
    void *mapped;                   /* coherent; NULL for NEPH_BUFFER_DEVICE */
    struct neph_texel_views texels; /* by neph_buffer_see_texels() */
};

/* NEPH_ERR_UNSUPPORTED: larger than the device allows a kernel to see. Zero-initialise `buffer`;
 * free with _destroy. */
enum neph_status neph_buffer_create(const struct neph_vulkan *vulkan, enum neph_buffer_use use,
                                    size_t size_bytes, const char *name, struct neph_buffer *buffer,
                                    struct neph_diag *diag);

/* On a CPU, let kernels see a NEPH_BUFFER_DEVICE buffer as texels of one, two and four words of 32
 * bits, too: lavapipe reads a word of a buffer in a loop over its lanes, with a test for each, and
 * such a texel in a few instructions for all. All descriptors of an array must have the array's
 * format, so kernels have an array of each (from NEPH_GPU_TEXELS_BINDING on), and a buffer all
 * three views: none stands in for another. On a GPU nothing is done.
 * NEPH_ERR_UNSUPPORTED: it has more words than the device lets a kernel see. */
enum neph_status neph_buffer_see_texels(const struct neph_vulkan *vulkan,
                                        struct neph_buffer *buffer, struct neph_diag *diag);

/* Among `allowed_types`, a bit each, the first type of memory that has what is needed, and what is
 * liked if there is such a one; UINT32_MAX: there is none. */
uint32_t neph_memory_type(const struct neph_vulkan *vulkan, uint32_t allowed_types,
                          VkMemoryPropertyFlags needed, VkMemoryPropertyFlags liked);

/* Copy `size_bytes` from the CPU to `offset_bytes` of a NEPH_BUFFER_DEVICE buffer, through a
 * staging buffer of at most 16 MiB, and wait. */
enum neph_status neph_buffer_upload(const struct neph_vulkan *vulkan,
                                    const struct neph_buffer *buffer, size_t offset_bytes,
                                    const void *data, size_t size_bytes, struct neph_diag *diag);

/* Copy the first bytes of a NEPH_BUFFER_DEVICE buffer into a NEPH_BUFFER_READBACK one, and wait. */
enum neph_status neph_buffer_download(const struct neph_vulkan *vulkan,
                                      const struct neph_buffer *buffer,
                                      const struct neph_buffer *readback, size_t size_bytes,
                                      struct neph_diag *diag);

/* A zero buffer is fine. Waits for all that is on its way to the device. */
void neph_buffer_destroy(const struct neph_vulkan *vulkan, struct neph_buffer *buffer);

/* Buffers row by row, up to the first that cannot be had; each is zero-initialised and freed like
 * one of neph_buffer_create(). */
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

/* One 3D image that kernels sample, with its sampler: made and destroyed by texture.h. */
struct neph_texture {
    VkImage image;
    VkDeviceMemory memory;
    uint64_t memory_bytes;
    VkImageView view;
    VkSampler sampler;
};

/* --- running kernels ---------------------------------------------------------------------- */

struct neph_dispatch {
    const struct neph_buffer *buffers[NEPH_KERNEL_BUFFERS_MAX]; /* those of the array come last */
    const struct neph_texture *images[NEPH_KERNEL_IMAGES_MAX];
    const void *push; /* of the kernel's push_size_bytes */
    uint32_t group_count;
    /* Afterwards copy the first bytes of a buffer for the CPU; NULL: no copy. */
    const struct neph_buffer *copy_from, *copy_to;
    size_t copy_size_bytes;
};

/* Dispatches that the device gets at once, after all batches before. One batch of a device is made
 * at a time, and nothing is copied meanwhile; a few more may be on their way (lane.h). */
struct neph_batch {
    const struct neph_vulkan *vulkan; /* borrowed */
    struct neph_lane *lane;           /* borrowed */
    const struct neph_kernel *bound;
    VkDescriptorSet bound_set;
    enum neph_status status; /* the first failure: after it nothing is recorded, and nothing sent */
};

/* Waits for an earlier batch when there are too many on their way. A batch that is not sent leaves
 * nothing behind. A caller may leave the status of this and of _dispatch to _send. */
enum neph_status neph_batch_begin(const struct neph_vulkan *vulkan, struct neph_batch *batch,
                                  struct neph_diag *diag);

/* Add a dispatch; its copy is left out. Waits for its kernel, and meanwhile sends what the batch
 * has. NEPH_ERR_INTERNAL, _ENGINE: the kernel cannot be made. NEPH_ERR_UNSUPPORTED: there are more
 * work groups than the device allows. */
enum neph_status neph_batch_dispatch(struct neph_batch *batch, const struct neph_kernel *kernel,
                                     const struct neph_dispatch *dispatch, struct neph_diag *diag);

/* What comes after sees what kernels wrote before, and writes what they read no sooner. */
void neph_batch_barrier(struct neph_batch *batch);

/* Take the time when all before is done, at most NEPH_LANE_STAMPS_MAX times. What has passed since
 * the stamp before it, or since the batch began, is added to `*seconds` when the batch is home (NaN
 * when the device has no clock); borrowed until then; NULL: nobody wants it. */
void neph_batch_stamp(struct neph_batch *batch, double *seconds);

/* Send it on its way, unless something failed before. What its kernels read must stay as it is
 * until the batch is home. `what` names it in errors. NEPH_ERR_ENGINE: the device was lost. */
enum neph_status neph_batch_send(struct neph_batch *batch, const char *what,
                                 struct neph_diag *diag);

/* A batch of one dispatch, sent on its way; its time is added to `*gpu_s` when it is home. */
enum neph_status neph_dispatch_send(const struct neph_vulkan *vulkan,
                                    const struct neph_kernel *kernel,
                                    const struct neph_dispatch *dispatch, const char *what,
                                    double *gpu_s, struct neph_diag *diag);

/* How many batches the device was ever sent: for _wait. */
uint64_t neph_batches_sent(const struct neph_vulkan *vulkan);

/* Wait until `count` of them are home: done, seen by the CPU, their times added. */
enum neph_status neph_batches_wait(const struct neph_vulkan *vulkan, uint64_t count,
                                   const char *what, struct neph_diag *diag);

/* Run a kernel and wait for it. `*gpu_s` receives the time the device spent on the dispatch alone
 * (timestamps; NaN when the device has none); NULL is fine. NEPH_ERR_ENGINE: the device was lost.
 */
enum neph_status neph_kernel_run(const struct neph_vulkan *vulkan, const struct neph_kernel *kernel,
                                 const struct neph_dispatch *dispatch, double *gpu_s,
                                 struct neph_diag *diag);

#endif
