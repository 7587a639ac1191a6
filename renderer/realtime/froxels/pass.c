/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/passes.h"

static const uint32_t froxel_light_code[] = {
#include "realtime/froxels/froxel_light.comp.inc"
};

const struct neph_rt_pass neph_rt_froxel_light = {
    .name = "froxel light",
    .note = "scattered light and extinction of media near the camera, per froxel",
    .shader = {"froxel_light", froxel_light_code, sizeof(froxel_light_code)},
    .condition = {RT_FROXEL_VOLUME, 1},
    .resolution = RT_FROXEL,
    .rays = NEPH_RT_POINTS_IN_MEDIA,
    .reads = NEPH_RT_BIT(RT_STEADY_DEPTH) | NEPH_RT_BIT(RT_FROXELS),
    .writes = NEPH_RT_BIT(RT_FROXELS),
};

static const uint32_t froxel_sum_code[] = {
#include "realtime/froxels/froxel_sum.comp.inc"
};

const struct neph_rt_pass neph_rt_froxel_sum = {
    .name = "froxel sum",
    .note = "light and transmittance in front of each slice, front to back",
    .shader = {"froxel_sum", froxel_sum_code, sizeof(froxel_sum_code)},
    .condition = {RT_FROXEL_VOLUME, 1},
    .resolution = RT_FROXEL_COLUMN,
    .reads = NEPH_RT_BIT(RT_FROXELS),
    .writes = NEPH_RT_BIT(RT_FROXELS),
};

static const uint32_t froxel_apply_code[] = {
#include "realtime/froxels/froxel_apply.comp.inc"
};

const struct neph_rt_pass neph_rt_froxel_apply = {
    .name = "froxel composition",
    .note = "froxels composed with the marched volume behind them",
    .shader = {"froxel_apply", froxel_apply_code, sizeof(froxel_apply_code)},
    .condition = {RT_FROXEL_VOLUME, 1},
    .resolution = RT_FULL,
    .reads = NEPH_RT_BIT(RT_FROXELS) | NEPH_RT_BIT(RT_DEPTH) | NEPH_RT_BIT(RT_VOLUME),
    .writes = NEPH_RT_BIT(RT_VOLUME),
};

static const uint32_t lamp_peaks_code[] = {
#include "realtime/froxels/lamp_peaks.comp.inc"
};

const struct neph_rt_pass neph_rt_lamp_peaks = {
    .name = "lamp peaks",
    .note = "light near each point light that froxels leave out, a ray per pixel",
    .shader = {"lamp_peaks", lamp_peaks_code, sizeof(lamp_peaks_code)},
    .condition = {RT_LAMP_PEAKS, 1},
    .resolution = RT_FULL,
    .rays = NEPH_RT_POINTS_IN_MEDIA,
    .reads = NEPH_RT_BIT(RT_FROXELS) | NEPH_RT_BIT(RT_DEPTH) | NEPH_RT_BIT(RT_VOLUME),
    .writes = NEPH_RT_BIT(RT_VOLUME),
};
