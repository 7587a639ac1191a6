/* SPDX-License-Identifier: MIT
 *
 * The roofline limits of a device: its highest bandwidth, sampling rate and arithmetic rate, each
 * measured by a kernel that does only this. A roofline compares passes with them (S. Williams, A.
 * Waterman and D. Patterson, "Roofline: An Insightful Visual Performance Model", CACM 52(4), 2009).
 */
#ifndef NEPH_RENDERER_ROOFLINE_H
#define NEPH_RENDERER_ROOFLINE_H

#include "renderer/march_params.h"
#include "renderer/vulkan.h"

#include <stddef.h>

struct neph_roofline_limits {
    double copy_bytes_per_s; /* bytes read plus bytes written */
    size_t copy_bytes;       /* of each of the two buffers: larger than the caches */
    /* grid_density() of shaders/grid.glsl from a storage buffer. On a CPU from texels of two nodes,
     * as the ray marcher reads them. */
    double buffer_samples_per_s;
    double texture_samples_per_s[NEPH_TEXEL_FORMAT_COUNT]; /* the same samples by the texture unit;
                                                              NaN: not measured, or the format is
                                                              not filtered */
    /* Dependent samples: the position of each depends on the value before, with one ray a lane, so
     * no two samples of a lane overlap in time. */
    double buffer_chain_per_s, texture_chain_per_s[NEPH_TEXEL_FORMAT_COUNT];
    double multiply_adds_per_s, exponentials_per_s; /* float32, all lanes together */
    int grid_side; /* nodes along a side of the sampled grid, which may fit into caches */
};

/* Measure each limit for about `seconds`, after a warm-up of equal length, and report the best of
 * several runs. NaN: the device has no clock. `texel_formats`: bits 1 << format of the formats to
 * measure. */
enum neph_status neph_roofline_measure(struct neph_vulkan *vulkan, double seconds,
                                       unsigned texel_formats,
                                       struct neph_roofline_limits *ceilings,
                                       struct neph_diag *diag);

#endif
