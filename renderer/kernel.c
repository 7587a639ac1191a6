/* SPDX-License-Identifier: MIT */
#include "renderer/kernel.h"

#include "renderer/pipeline_cache.h"
#include "renderer/shader_cache.h"
#include "renderer/shader_code.h"
#include "renderer/specialize.h"
#include "renderer/spirv_loops.h"
#include "renderer/spirv_split.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --- layouts ------------------------------------------------------------------------------ */

int neph_kernel_buffer_count(const struct neph_kernel_params *params)
{
    return params->buffer_count + params->array_count;
}

int neph_kernel_binding_count(const struct neph_kernel_params *params)
{
    return params->buffer_count + (params->array_count > 0 ? 1 : 0);
}

VkDescriptorType neph_kernel_binding_type(const struct neph_kernel_params *params, int binding)
{
    return binding < params->uniform_count ? VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER
                                           : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
}

static VkResult create_layouts(const struct neph_vulkan *vulkan, struct neph_kernel *kernel)
{
    VkDescriptorSetLayoutBinding bindings[NEPH_KERNEL_BUFFERS_MAX + 1 + NEPH_GPU_TEXEL_FORMATS];
    const int array = kernel->params.buffer_count, image_count = kernel->params.image_count;
    int binding_count = neph_kernel_binding_count(&kernel->params);
    for (int i = 0; i < binding_count; i++)
        bindings[i] = (VkDescriptorSetLayoutBinding){
            .binding = (uint32_t)i,
            .descriptorType = neph_kernel_binding_type(&kernel->params, i),
            .descriptorCount = i == array ? (uint32_t)kernel->params.array_count : 1,
            .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT,
        };
    if (image_count > 0)
        bindings[binding_count++] = (VkDescriptorSetLayoutBinding){
            .binding = NEPH_GPU_IMAGES_BINDING,
            .descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
            .descriptorCount = (uint32_t)image_count,
            .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT,
        };
    for (int f = 0; f < NEPH_GPU_TEXEL_FORMATS; f++) {
        if (kernel->params.texels_count[f] == 0)
            continue;
        bindings[binding_count++] = (VkDescriptorSetLayoutBinding){
            .binding = (uint32_t)(NEPH_GPU_TEXELS_BINDING + f),
            .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER,
            .descriptorCount = (uint32_t)kernel->params.texels_count[f],
            .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT,
        };
    }
    const VkDescriptorSetLayoutCreateInfo set = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
        .bindingCount = (uint32_t)binding_count,
        .pBindings = bindings,
    };
    const VkResult result = vulkan->api.vkCreateDescriptorSetLayout(vulkan->device, &set, NULL,
                                                                    &kernel->set_layout);
    if (result != VK_SUCCESS)
        return result;
    const VkPushConstantRange push = {
        .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT,
        .size = (uint32_t)kernel->params.push_size_bytes,
    };
    const VkPipelineLayoutCreateInfo layout = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
        .setLayoutCount = 1,
        .pSetLayouts = &kernel->set_layout,
        .pushConstantRangeCount = push.size > 0 ? 1 : 0,
        .pPushConstantRanges = &push,
    };
    return vulkan->api.vkCreatePipelineLayout(vulkan->device, &layout, NULL, &kernel->layout);
}

/* --- compilation, on another thread --------------------------------------------------------- */

/* Report loops that lavapipe executes wrongly (spirv_loops.h) like a validation message. */
static void check_loops(struct neph_vulkan *vulkan, const char *name, const uint32_t *words,
                        size_t size_bytes)
{
    struct neph_spirv_lost lost;
    if (!neph_spirv_find_lost(words, size_bytes, &lost) || !lost.value)
        return;
    if (atomic_fetch_add(&vulkan->message_count, 1) == 0)
        snprintf(vulkan->first_message, sizeof(vulkan->first_message),
                 "shader %s: value %%%u of the loop at %%%u is used after the loop, where lavapipe "
                 "has lost it: carry it by a variable of the loop, or leave the loop at its start "
                 "(renderer/spirv_loops.h)",
                 name, lost.value, lost.header);
}

/* Prefix a diag with the name of the shader and the constants that it reads. */
static enum neph_status blame(const struct neph_kernel *kernel, enum neph_status status,
                              struct neph_diag *diag)
{
    char constants[512] = "";
    size_t length = 0;
    for (int i = 0; i < kernel->params.constant_count && length + 24 < sizeof(constants); i++)
        if (neph_shader_constant_bits(kernel->params.code, i))
            length += (size_t)snprintf(constants + length, sizeof(constants) - length, " %d:%u", i,
                                       kernel->params.constants[i]);
    neph_prefix(diag, "shader %s with the constants%s: ", kernel->params.name, constants);
    return status;
}

static enum neph_status specialize(const struct neph_kernel_params *params, uint32_t **words,
                                   size_t *size_bytes, struct neph_diag *diag)
{
    uint32_t *whole = NULL;
    size_t whole_bytes = 0;
    enum neph_status status = neph_shader_unpack(params->code, params->code_bytes, &whole,
                                                 &whole_bytes, diag);
    if (!status)
        status = neph_specialize(whole, whole_bytes, params->constants, params->constant_count,
                                 words, size_bytes, diag);
    free(whole);
    return status;
}

/* The specialised SPIR-V, from the cache or newly made. */
static enum neph_status get_words(const struct neph_kernel *kernel, uint32_t **words,
                                  size_t *size_bytes, struct neph_diag *diag)
{
    const struct neph_kernel_params *params = &kernel->params;
    struct neph_shader_cache *cache = kernel->vulkan->shaders;
    char key[NEPH_HASH_HEX_SIZE];
    enum neph_status status = neph_shader_cache_key(
        params->code, params->code_bytes, params->constants, params->constant_count, key, diag);
    if (status || neph_shader_cache_read(cache, key, words, size_bytes))
        return status;
    status = specialize(params, words, size_bytes, diag);
    if (status)
        return blame(kernel, status, diag);
    neph_shader_cache_write(cache, key, *words, *size_bytes);
    return NEPH_OK;
}

/* Rewrite the loops for checks by a validation layer (spirv_split.h). */
static enum neph_status split_loops(uint32_t **words, size_t *size_bytes, struct neph_diag *diag)
{
    uint32_t *split = NULL;
    if (!neph_spirv_split_loops(*words, *size_bytes, &split, size_bytes))
        return neph_fail_memory(diag);
    free(*words);
    *words = split;
    return NEPH_OK;
}

/* lavapipe (Mesa 22.3.6) numbers its shaders without a lock, so its pipelines are made one at a
 * time. */
static VkResult create_pipeline(struct neph_kernel *kernel, const VkComputePipelineCreateInfo *info)
{
    struct neph_vulkan *vulkan = kernel->vulkan;
    if (vulkan->description.is_cpu)
        pthread_mutex_lock(&vulkan->pipeline_lock);
    const VkResult result = vulkan->api.vkCreateComputePipelines(
        vulkan->device, neph_pipeline_cache_handle(vulkan), 1, info, NULL, &kernel->pipeline);
    if (vulkan->description.is_cpu)
        pthread_mutex_unlock(&vulkan->pipeline_lock);
    return result;
}

static VkResult compile(struct neph_kernel *kernel, const uint32_t *words, size_t size_bytes)
{
    const struct neph_vulkan *vulkan = kernel->vulkan;
    const VkShaderModuleCreateInfo module = {
        .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
        .codeSize = size_bytes,
        .pCode = words,
    };
    VkComputePipelineCreateInfo pipeline = {
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
        .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                  .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                  .pName = "main"},
        .layout = kernel->layout,
    };
    VkResult result = vulkan->api.vkCreateShaderModule(vulkan->device, &module, NULL,
                                                       &pipeline.stage.module);
    if (result == VK_SUCCESS)
        result = create_pipeline(kernel, &pipeline);
    vulkan->api.vkDestroyShaderModule(vulkan->device, pipeline.stage.module, NULL);
    return result;
}

static void make(void *context)
{
    struct neph_kernel *kernel = context;
    struct neph_vulkan *vulkan = kernel->vulkan;
    uint32_t *words = NULL;
    size_t size_bytes = 0;
    if (atomic_load(&vulkan->is_ending)) {
        kernel->status = neph_fail(&kernel->diag, NEPH_ERR_INTERRUPTED, "the device is closed");
        return;
    }
    kernel->status = get_words(kernel, &words, &size_bytes, &kernel->diag);
    if (kernel->status)
        return;
    if (vulkan->messenger && vulkan->description.is_cpu)
        check_loops(vulkan, kernel->params.name, words, size_bytes);
    if (vulkan->checks_shaders)
        kernel->status = split_loops(&words, &size_bytes, &kernel->diag);
    if (kernel->status) {
        free(words);
        return;
    }
    const VkResult result = compile(kernel, words, size_bytes);
    free(words);
    if (result != VK_SUCCESS)
        kernel->status = neph_vulkan_fail(result, kernel->params.name, &kernel->diag);
    else
        neph_vulkan_name(vulkan, VK_OBJECT_TYPE_PIPELINE, (uint64_t)kernel->pipeline,
                         kernel->params.name);
}

bool neph_kernel_is_made(const struct neph_kernel *kernel)
{
    return neph_workers_have_done(kernel->vulkan->makers, &kernel->making);
}

enum neph_status neph_kernel_finish(const struct neph_kernel *kernel, struct neph_diag *diag)
{
    neph_workers_wait(kernel->vulkan->makers, &kernel->making);
    if (kernel->status && diag)
        *diag = kernel->diag;
    return kernel->status;
}

/* --- the kernels of a device -------------------------------------------------------------- */

/* Canonical params: texels only on a CPU; bits of constants that the shader does not read become 0,
 * so that they do not lead to a second kernel. */
static struct neph_kernel_params own_params(const struct neph_vulkan *vulkan,
                                            const struct neph_kernel_params *params)
{
    struct neph_kernel_params own = *params;
    if (!vulkan->description.is_cpu)
        memset(own.texels_count, 0, sizeof(own.texels_count));
    for (int i = 0; i < NEPH_KERNEL_CONSTANTS_MAX; i++)
        own.constants[i] &= i < params->constant_count ? neph_shader_constant_bits(params->code, i)
                                                       : 0u;
    return own;
}

static bool same_kernel(const struct neph_kernel_params *a, const struct neph_kernel_params *b)
{
    return strcmp(a->name, b->name) == 0 && a->constant_count == b->constant_count &&
           memcmp(a->constants, b->constants,
                  (size_t)a->constant_count * sizeof(a->constants[0])) == 0;
}

static void kernel_destroy(struct neph_kernel *kernel)
{
    const struct neph_vulkan *vulkan = kernel->vulkan;
    vulkan->api.vkDestroyPipeline(vulkan->device, kernel->pipeline, NULL);
    vulkan->api.vkDestroyPipelineLayout(vulkan->device, kernel->layout, NULL);
    vulkan->api.vkDestroyDescriptorSetLayout(vulkan->device, kernel->set_layout, NULL);
    free(kernel);
}

static enum neph_status create_kernel(struct neph_vulkan *vulkan,
                                      const struct neph_kernel_params *own,
                                      struct neph_kernel **kernel, struct neph_diag *diag)
{
    struct neph_kernel *created = calloc(1, sizeof(*created));
    if (!created)
        return neph_fail_memory(diag);
    created->vulkan = vulkan;
    created->params = *own;
    created->making = (struct neph_task){.work = make, .context = created};
    const VkResult result = create_layouts(vulkan, created);
    if (result != VK_SUCCESS) {
        kernel_destroy(created);
        return neph_vulkan_fail(result, own->name, diag);
    }
    neph_vulkan_name(vulkan, VK_OBJECT_TYPE_PIPELINE_LAYOUT, (uint64_t)created->layout, own->name);
    *kernel = created;
    return NEPH_OK;
}

enum neph_status neph_kernel_get(struct neph_vulkan *vulkan,
                                 const struct neph_kernel_params *params,
                                 const struct neph_kernel **kernel, struct neph_diag *diag)
{
    const struct neph_kernel_params own = own_params(vulkan, params);
    for (struct neph_kernel *known = vulkan->kernels; known; known = known->next)
        if (same_kernel(&known->params, &own)) {
            *kernel = known;
            return NEPH_OK;
        }
    struct neph_kernel *created = NULL;
    const enum neph_status status = create_kernel(vulkan, &own, &created, diag);
    if (status)
        return status;
    created->next = vulkan->kernels;
    vulkan->kernels = created;
    neph_workers_add(vulkan->makers, &created->making);
    *kernel = created;
    return NEPH_OK;
}

/* Kernels still in the queue are not compiled: so Ctrl-C ends a cold start at once. */
void neph_kernels_destroy(struct neph_vulkan *vulkan)
{
    atomic_store(&vulkan->is_ending, true);
    neph_workers_destroy(vulkan->makers);
    while (vulkan->kernels) {
        struct neph_kernel *kernel = vulkan->kernels;
        vulkan->kernels = kernel->next;
        kernel_destroy(kernel);
    }
}
