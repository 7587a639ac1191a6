/* SPDX-License-Identifier: MIT
 *
 * Kernels: from a shader and its constants to a pipeline of the driver. Kernels are compiled on
 * other threads (base/workers.h), since all kernels of a frame are requested before the first is
 * used. Not for other folders.
 */
#ifndef NEPH_RENDERER_KERNEL_H
#define NEPH_RENDERER_KERNEL_H

#include "base/workers.h"
#include "renderer/shaders/constants.h"
#include "renderer/vulkan_device.h"

/* The number of storage buffers that lavapipe lets a kernel bind, and two uniform buffers. */
#define NEPH_KERNEL_STORAGE_MAX 32
#define NEPH_KERNEL_BUFFERS_MAX (NEPH_KERNEL_STORAGE_MAX + 2)
#define NEPH_KERNEL_CONSTANTS_MAX 96
#define NEPH_KERNEL_IMAGES_MAX NEPH_GPU_MEDIA_MAX

struct neph_kernel_params {
    const char *name;     /* unique per shader */
    const uint32_t *code; /* shaders/NAME.comp.inc; borrowed for the device's lifetime */
    size_t code_bytes;
    int buffer_count;  /* at set 0, bindings 0 .. count-1 */
    int uniform_count; /* the first of them, which are uniform buffers; the others are storage
                          buffers */
    int array_count;   /* further storage buffers, an array at binding buffer_count; 0: none */
    int image_count;   /* textures, an array at NEPH_GPU_IMAGES_BINDING; 0: none */
    /* On a CPU a kernel also reads the buffers from texels_first on as texels; the size of the
     * array of each format (neph_buffer_create_texel_views()). */
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
    /* Valid when `making` is done: */
    VkPipeline pipeline;
    enum neph_status status;
    struct neph_diag diag;
};

/* The kernel of a shader with its specialization constants. The first call starts its compilation
 * on another thread; the device keeps and owns the kernel. The first batch that uses it waits for
 * it, so request all kernels of a frame before its first batch. A failed compilation is that
 * batch's error. Constants that the shader does not have may have any value. */
enum neph_status neph_kernel_get(struct neph_vulkan *vulkan,
                                 const struct neph_kernel_params *params,
                                 const struct neph_kernel **kernel, struct neph_diag *diag);

/* For neph_vulkan_destroy(). */
void neph_kernels_destroy(struct neph_vulkan *vulkan);

/* Whether _finish would return at once. */
bool neph_kernel_is_compiled(const struct neph_kernel *kernel);

/* Wait until the kernel is compiled. NEPH_ERR_INTERNAL: the optimiser refuses the shader; the
 * message has its name and the constants. NEPH_ERR_ENGINE: the driver refuses it. */
enum neph_status neph_kernel_finish(const struct neph_kernel *kernel, struct neph_diag *diag);

/* The number of buffers that a dispatch binds, with those of the array; the number of bindings; and
 * the type of each binding. */
int neph_kernel_buffer_count(const struct neph_kernel_params *params);
int neph_kernel_binding_count(const struct neph_kernel_params *params);
VkDescriptorType neph_kernel_binding_type(const struct neph_kernel_params *params, int binding);

#endif
