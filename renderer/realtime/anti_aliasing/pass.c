/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/passes.h"

/* Targets that anti-aliasing and upsampling are bound to. */
#define TAA_READS                                                                                  \
    NEPH_RT_BIT(RT_COLOR) | NEPH_RT_BIT(RT_DEPTH) | NEPH_RT_BIT(RT_TAA_BEFORE) |                   \
        NEPH_RT_BIT(RT_VOLUME) | NEPH_RT_BIT(RT_BEHIND) | NEPH_RT_BIT(RT_VOLUME_DISTANCE) |        \
        NEPH_RT_BIT(RT_CHANGE) | NEPH_RT_BIT(RT_CHANGE_BEHIND) | NEPH_RT_BIT(RT_MOVED)
/* Targets that are not read unless one of these choices is set (passes.h). */
#define TAA_SPARED                                                                                 \
    {                                                                                              \
        {{{RT_COMPOSITION, RT_COMPOSITION_PASS}, {RT_COMPOSITION, RT_COMPOSITION_UPSCALE}},        \
         NEPH_RT_BIT(RT_COLOR)},                                                                   \
            {{{RT_COMPOSITION, RT_COMPOSITION_TAA}}, NEPH_RT_BIT(RT_BEHIND)},                      \
            {{{RT_TAA_MEDIUM, 1}}, NEPH_RT_BIT(RT_VOLUME_DISTANCE)},                               \
            {{{RT_TAA_MEDIUM, 1},                                                                  \
              {RT_GRADIENT, 1},                                                                    \
              {RT_COMPOSITION, RT_COMPOSITION_TAA},                                                \
              {RT_TAA_RESPONSIVE, RT_RESPONSIVE_MEDIUM}},                                          \
             NEPH_RT_BIT(RT_VOLUME)},                                                              \
            {{{RT_GRADIENT, 1}}, NEPH_RT_BIT(RT_CHANGE) | NEPH_RT_BIT(RT_CHANGE_BEHIND)},          \
            {{{RT_SOLID_MOTION, 1}}, NEPH_RT_BIT(RT_MOVED)},                                       \
    }

static const uint32_t taa_code[] = {
#include "realtime/anti_aliasing/taa.comp.inc"
};
static const uint32_t taa_cpu_code[] = {
#include "realtime/anti_aliasing/taa_cpu.comp.inc"
};
static const uint32_t taa_gpu_code[] = {
#include "realtime/anti_aliasing/taa_gpu.comp.inc"
};

const struct neph_rt_pass neph_rt_taa = {
    .name = "anti-aliasing",
    .note = "the mean over jittered frames, with a neighbourhood clamp",
    .shader = {"taa", taa_code, sizeof(taa_code)},
    .variants = {[NEPH_RT_CPU] = {"taa_cpu", taa_cpu_code, sizeof(taa_cpu_code),
                                  .column = RT_TAA_COLUMN},
                 [NEPH_RT_GPU] = {"taa_gpu", taa_gpu_code, sizeof(taa_gpu_code),
                                  .block = {RT_TAA_BLOCK_WIDTH, RT_TAA_BLOCK_HEIGHT}}},
    .condition = {RT_TAA, RT_TAA_ON},
    .resolution = RT_PICTURE,
    .reads = TAA_READS,
    .spared = TAA_SPARED,
    .writes = NEPH_RT_BIT(RT_TAA_OUT),
    .histories = {{RT_TAA_OUT, RT_TAA_BEFORE}},
    .picture = RT_TAA_OUT,
};

static const uint32_t taau_code[] = {
#include "realtime/anti_aliasing/taau.comp.inc"
};

const struct neph_rt_pass neph_rt_taau = {
    .name = "upsampling",
    .note = "anti-aliasing with more output pixels than rendered pixels",
    .shader = {"taau", taau_code, sizeof(taau_code)},
    .condition = {RT_TAA, RT_TAA_UPSAMPLING},
    .resolution = RT_PICTURE,
    .reads = TAA_READS,
    .spared = TAA_SPARED,
    .writes = NEPH_RT_BIT(RT_TAA_OUT),
    .histories = {{RT_TAA_OUT, RT_TAA_BEFORE}},
    .picture = RT_TAA_OUT,
};

static const uint32_t locks_code[] = {
#include "realtime/anti_aliasing/locks.comp.inc"
};

const struct neph_rt_pass neph_rt_locks = {
    .name = "locks",
    .note = "upsampling with locks on thin features, after FSR 2",
    .shader = {"locks", locks_code, sizeof(locks_code)},
    .condition = {RT_TAA, RT_TAA_LOCKS},
    .resolution = RT_PICTURE,
    .reads = TAA_READS | NEPH_RT_BIT(RT_TAA_STATE_BEFORE),
    .spared = TAA_SPARED,
    .writes = NEPH_RT_BIT(RT_TAA_OUT) | NEPH_RT_BIT(RT_TAA_STATE),
    .histories = {{RT_TAA_OUT, RT_TAA_BEFORE}, {RT_TAA_STATE, RT_TAA_STATE_BEFORE}},
    .picture = RT_TAA_OUT,
};
