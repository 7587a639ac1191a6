/* SPDX-License-Identifier: MIT */
#include "renderer/requirements.h"

#include "renderer/kernel.h"
#include "renderer/realtime/shared/names.h"

#include "shaders/structs.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

/* Does not compile with a new kind: this file then needs a change. */
_Static_assert(NEPH_REQUIREMENT_KIND_COUNT == 4, "a new kind");
_Static_assert(NEPH_REQUIREMENT_NECESSITY_COUNT == 3, "a new kind");

static const char install_driver[] = "apt-get install mesa-vulkan-drivers";

#define FACT(member) offsetof(struct neph_device_facts, member)

static const struct neph_requirement rows[] = {
    {"apiVersion", NEPH_REQUIREMENT_VERSION, NEPH_REQUIRED, FACT(api_version), VK_API_VERSION_1_2,
     "SPIR-V 1.5 and the guaranteed features of Vulkan 1.2", NULL},
    {"VK_QUEUE_COMPUTE_BIT", NEPH_REQUIREMENT_LEAST, NEPH_REQUIRED, FACT(has_compute_queue), 1,
     "every kernel", NULL},
    {"uniformBufferStandardLayout", NEPH_REQUIREMENT_FEATURE, NEPH_REQUIRED,
     FACT(features_12.uniformBufferStandardLayout), 1,
     "arrays of numbers in uniform buffers with the layout of C", NULL},
    {"hostQueryReset", NEPH_REQUIREMENT_FEATURE, NEPH_REQUIRED, FACT(features_12.hostQueryReset), 1,
     "timestamp queries reset by the CPU", NULL},
    {"shaderStorageBufferArrayDynamicIndexing", NEPH_REQUIREMENT_FEATURE, NEPH_REQUIRED,
     FACT(features.shaderStorageBufferArrayDynamicIndexing), 1,
     "targets indexed dynamically by a pass of realtime", NULL},
    {"subgroupSupportedOperations", NEPH_REQUIREMENT_BITS, NEPH_REQUIRED,
     FACT(subgroup.supportedOperations), VK_SUBGROUP_FEATURE_VOTE_BIT,
     "votes of a subgroup on the end of its rays", NULL},
    {"subgroupSupportedStages", NEPH_REQUIREMENT_BITS, NEPH_REQUIRED,
     FACT(subgroup.supportedStages), VK_SHADER_STAGE_COMPUTE_BIT, "the same", NULL},
    {"maxPerStageDescriptorStorageBuffers", NEPH_REQUIREMENT_LEAST, NEPH_REQUIRED,
     FACT(limits.maxPerStageDescriptorStorageBuffers), NEPH_KERNEL_STORAGE_MAX,
     "the targets of realtime and the scene in one kernel", NULL},
    {"maxDescriptorSetStorageBuffers", NEPH_REQUIREMENT_LEAST, NEPH_REQUIRED,
     FACT(limits.maxDescriptorSetStorageBuffers), NEPH_KERNEL_STORAGE_MAX, "the same", NULL},
    {"maxUniformBufferRange", NEPH_REQUIREMENT_LEAST, NEPH_REQUIRED,
     FACT(limits.maxUniformBufferRange), sizeof(struct neph_gpu_solids), "the solids of a scene",
     NULL},
    {"shaderInt64", NEPH_REQUIREMENT_FEATURE, NEPH_REQUIRED_OF_CPU, FACT(features.shaderInt64), 1,
     "writes of two words at once by a CPU", NULL},
    {"shaderStorageImageExtendedFormats", NEPH_REQUIREMENT_FEATURE, NEPH_REQUIRED_OF_CPU,
     FACT(features.shaderStorageImageExtendedFormats), 1, "pairs of words as texels", NULL},
    {"maxPerStageDescriptorStorageImages", NEPH_REQUIREMENT_LEAST, NEPH_REQUIRED_OF_CPU,
     FACT(limits.maxPerStageDescriptorStorageImages),
     RT_WORD_TARGET_COUNT + RT_PAIR_TARGET_COUNT + RT_TARGET_COUNT,
     "the targets of realtime also as texels of one, two and four words", NULL},
    {"timestampValidBits", NEPH_REQUIREMENT_LEAST, NEPH_OPTIONAL, FACT(timestamp_bits), 1,
     "device times",
     "frames have no device time, and long marches are split by their number of steps"},
    {"VK_FORMAT_R32_SFLOAT", NEPH_REQUIREMENT_BITS, NEPH_OPTIONAL, FACT(r32f_features),
     VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT,
     "voxels from a 32-bit texture (grid_format=r32f)",
     "r32f is refused; grid_format=r16f, r8 and grid_sampling=exact are available"},
};

enum { ROWS = sizeof(rows) / sizeof(rows[0]) };
_Static_assert(sizeof(rows) / sizeof(rows[0]) <= NEPH_VULKAN_REQUIREMENTS_MAX, "room for answers");

const struct neph_requirement *neph_requirements(int *count)
{
    *count = ROWS;
    return rows;
}

static uint32_t number_of(const struct neph_requirement *row, const struct neph_device_facts *facts)
{
    uint32_t number;
    memcpy(&number, (const char *)facts + row->offset, sizeof(number));
    return number;
}

bool neph_requirement_applies(const struct neph_requirement *row,
                              const struct neph_device_facts *facts)
{
    return row->necessity != NEPH_REQUIRED_OF_CPU || facts->is_cpu;
}

bool neph_requirement_is_met(const struct neph_requirement *row,
                             const struct neph_device_facts *facts)
{
    const uint32_t number = number_of(row, facts);
    return row->kind == NEPH_REQUIREMENT_BITS ? (number & row->needed) == row->needed
                                              : number >= row->needed;
}

static void print_number(const struct neph_requirement *row, uint32_t number, char text[32])
{
    switch (row->kind) {
    case NEPH_REQUIREMENT_FEATURE:
    case NEPH_REQUIREMENT_LEAST:
    case NEPH_REQUIREMENT_KIND_COUNT:
        snprintf(text, 32, "%u", number);
        break;
    case NEPH_REQUIREMENT_BITS:
        snprintf(text, 32, "0x%x", number);
        break;
    case NEPH_REQUIREMENT_VERSION:
        snprintf(text, 32, "%u.%u.%u", VK_API_VERSION_MAJOR(number), VK_API_VERSION_MINOR(number),
                 VK_API_VERSION_PATCH(number));
    }
}

struct neph_vulkan_requirement neph_requirement_answer(const struct neph_requirement *row,
                                                       const struct neph_device_facts *facts)
{
    struct neph_vulkan_requirement answer = {
        .name = row->name,
        .purpose = row->purpose,
        .without = row->without,
        .is_required = row->necessity != NEPH_OPTIONAL,
        .is_met = neph_requirement_is_met(row, facts),
    };
    print_number(row, number_of(row, facts), answer.value);
    print_number(row, row->needed, answer.needed);
    return answer;
}

void neph_requirements_features(const struct neph_device_facts *facts,
                                VkPhysicalDeviceFeatures *features,
                                VkPhysicalDeviceVulkan12Features *features_12)
{
    struct neph_device_facts enabled = {.is_cpu = VK_FALSE};
    const VkBool32 on = VK_TRUE;
    for (int i = 0; i < ROWS; i++)
        if (rows[i].kind == NEPH_REQUIREMENT_FEATURE && neph_requirement_is_met(&rows[i], facts))
            memcpy((char *)&enabled + rows[i].offset, &on, sizeof(on));
    *features = enabled.features;
    *features_12 = enabled.features_12;
    features_12->sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
}

/* --- refusal ------------------------------------------------------------------------------ */

static bool is_lacking(const struct neph_requirement *row, const struct neph_device_facts *facts)
{
    return row->necessity != NEPH_OPTIONAL && neph_requirement_applies(row, facts) &&
           !neph_requirement_is_met(row, facts);
}

enum neph_status neph_requirements_check(const struct neph_device_facts *facts,
                                         struct neph_diag *diag)
{
    const struct neph_requirement *first = NULL;
    char others[400] = "";
    for (int i = 0; i < ROWS; i++) {
        if (!is_lacking(&rows[i], facts))
            continue;
        const size_t used = strlen(others);
        if (first)
            snprintf(others + used, sizeof(others) - used, "%s%s",
                     used ? ", " : "; it also lacks: ", rows[i].name);
        else
            first = &rows[i];
    }
    if (!first)
        return NEPH_OK;
    const struct neph_vulkan_requirement answer = neph_requirement_answer(first, facts);
    neph_fail(diag, NEPH_ERR_UNAVAILABLE,
              "the Vulkan device '%.100s' cannot be used: its %s is %s, needed is %s, for %s%s",
              facts->device, answer.name, answer.value, answer.needed, answer.purpose, others);
    neph_hint(
        diag,
        "update its driver, or set NEPH_VULKAN_DEVICE to another device, such as llvmpipe: %s",
        install_driver);
    return NEPH_ERR_UNAVAILABLE;
}

/* --- choice of a device ------------------------------------------------------------------- */

static bool is_named(const struct neph_device_facts *facts, const char *wanted)
{
    return !wanted || strcasestr(facts->device, wanted);
}

static enum neph_status refuse_all(const struct neph_device_facts *facts, int count,
                                   const char *wanted, struct neph_diag *diag)
{
    char names[600] = "";
    for (int i = 0; i < count; i++) {
        const size_t used = strlen(names);
        snprintf(names + used, sizeof(names) - used, "%s'%s'", used ? ", " : "", facts[i].device);
    }
    for (int i = 0; i < count; i++)
        if (is_named(&facts[i], wanted))
            return neph_requirements_check(&facts[i], diag);
    if (wanted) {
        neph_fail(diag, NEPH_ERR_UNAVAILABLE, "no Vulkan device is named like '%s'", wanted);
        neph_hint(diag, "the devices are: %s", names[0] ? names : "none");
    } else {
        neph_fail(diag, NEPH_ERR_UNAVAILABLE, "there is no Vulkan device");
        neph_hint(diag, "%s", install_driver);
    }
    return NEPH_ERR_UNAVAILABLE;
}

enum neph_status neph_requirements_choose(const struct neph_device_facts *facts, int count,
                                          const char *wanted, int *chosen, struct neph_diag *diag)
{
    int best = -1;
    for (int i = 0; i < count; i++) {
        if (!is_named(&facts[i], wanted) || neph_requirements_check(&facts[i], NULL))
            continue;
        if (best < 0 || (facts[i].is_cpu && !facts[best].is_cpu))
            best = i;
    }
    if (best < 0)
        return refuse_all(facts, count, wanted, diag);
    *chosen = best;
    return NEPH_OK;
}
