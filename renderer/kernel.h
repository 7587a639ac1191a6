/* SPDX-License-Identifier: MIT
 *
 * A kernel on its way from a shader and its constants to a pipeline of the driver. It is made on
 * another thread (base/workers.h), since all of a frame's are asked for before the first is used.
 * Not for other folders.
 */
#ifndef NEPH_RENDERER_KERNEL_H
#define NEPH_RENDERER_KERNEL_H

#include "base/workers.h"
#include "renderer/compute.h"

struct neph_kernel_sets; /* kernel_sets.h */

struct neph_kernel {
    struct neph_kernel *next;
    struct neph_vulkan *vulkan; /* borrowed */
    struct neph_kernel_params params;
    VkDescriptorSetLayout set_layout;
    VkPipelineLayout layout;
    struct neph_kernel_sets *sets; /* owned; grows where the kernel itself is const */
    struct neph_task making;
    /* When that is done: */
    VkPipeline pipeline;
    enum neph_status status;
    struct neph_diag diag;
};

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
