/* SPDX-License-Identifier: MIT
 *
 * A kernel on its way from a shader and its constants to a pipeline of the driver. It is made on
 * another thread (base/workers.h), since all of a frame's are asked for before the first is used.
 * Not for other folders.
 */
#ifndef NEPH_RENDERER_KERNEL_H
#define NEPH_RENDERER_KERNEL_H

#include "base/workers.h"
#include "renderer/shaders/constants.h"
#include "renderer/vulkan_device.h"

/* As many storage buffers as lavapipe lets a kernel see, and two uniform ones. */
#define NEPH_KERNEL_STORAGE_MAX 32
#define NEPH_KERNEL_BUFFERS_MAX (NEPH_KERNEL_STORAGE_MAX + 2)
#define NEPH_KERNEL_CONSTANTS_MAX 96
#define NEPH_KERNEL_IMAGES_MAX NEPH_GPU_MEDIA_MAX

struct neph_kernel_params {
    const char *name;     /* unique to the shader */
    const uint32_t *code; /* shaders/NAME.comp.inc; borrowed while the device lives */
    size_t code_bytes;
    int buffer_count;  /* at set 0, bindings 0 .. count-1: storage buffers but for .. */
    int uniform_count; /* .. the first of them, which are uniform ones */
    int array_count;   /* more of them, an array at binding buffer_count; 0: none */
    int image_count;   /* textures, an array at NEPH_GPU_IMAGES_BINDING; 0: none */
    /* On a CPU a kernel sees buffers from texels_first on as texels, too, so many of them in the
     * array of each format (neph_buffer_see_texels()). */
    int texels_first, texels_count[NEPH_GPU_TEXEL_FORMATS];
    size_t push_size_bytes; /* push constants, from offset 0 */
    int constant_count;     /* specialization constants 0 .. count-1 */
    uint32_t constants[NEPH_KERNEL_CONSTANTS_MAX];
};

struct neph_kernel {
    struct neph_kernel *next;
    struct neph_vulkan *vulkan; /* borrowed */
    struct neph_kernel_params params;
    VkDescriptorSetLayout set_layout;
    VkPipelineLayout layout;
    struct neph_task making;
    /* When that is done: */
    VkPipeline pipeline;
    enum neph_status status;
    struct neph_diag diag;
};

/* The kernel of a shader and its specialization constants: asked for by the first call, kept and
 * owned by the device. It is made on another thread, and the first batch that needs it waits: ask
 * for all that a frame needs before its first batch. What goes wrong meanwhile is that batch's
 * error. Constants that the shader does not have may have any value. */
enum neph_status neph_kernel_get(struct neph_vulkan *vulkan,
                                 const struct neph_kernel_params *params,
                                 const struct neph_kernel **kernel, struct neph_diag *diag);

/* For neph_vulkan_destroy(). */
void neph_kernels_destroy(struct neph_vulkan *vulkan);

/* Whether _finish would not wait. */
bool neph_kernel_is_made(const struct neph_kernel *kernel);

/* Wait until it is made. NEPH_ERR_INTERNAL: the optimiser refuses the shader, with its name and the
 * constants. NEPH_ERR_ENGINE: the driver does. */
enum neph_status neph_kernel_finish(const struct neph_kernel *kernel, struct neph_diag *diag);

/* How many buffers a dispatch binds, those of the array included; how many bindings they are; and
 * what each binding holds. */
int neph_kernel_buffer_count(const struct neph_kernel_params *params);
int neph_kernel_binding_count(const struct neph_kernel_params *params);
VkDescriptorType neph_kernel_binding_type(const struct neph_kernel_params *params, int binding);

#endif
