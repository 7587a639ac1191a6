/* SPDX-License-Identifier: MIT
 *
 * What a device can do at most, measured on it by kernels that do one thing alone: what passes get
 * of it is the other half of a roofline (S. Williams, A. Waterman and D. Patterson, "Roofline: An
 * Insightful Visual Performance Model", CACM 52(4), 2009).
 */
#ifndef NEPH_RENDERER_CEILINGS_H
#define NEPH_RENDERER_CEILINGS_H

#include "renderer/march_params.h"
#include "renderer/vulkan.h"

#include <stddef.h>

struct neph_ceilings {
    double copy_bytes_per_s; /* read and written, each counted */
    size_t copy_bytes;       /* of each of the two buffers: more than caches hold */
    /* grid_density() of shaders/grid.glsl, from a storage buffer; of a CPU from texels of two
     * nodes, as marches read them. */
    double buffer_samples_per_s;
    double texture_samples_per_s[NEPH_TEXEL_FORMAT_COUNT]; /* of the same, by the texture unit; NaN:
                                                              not measured, or it does not filter
                                                              that format */
    /* Where each sample's place depends on the one before, one ray a lane: no look-up is on its way
     * together with the next. */
    double buffer_chain_per_s, texture_chain_per_s[NEPH_TEXEL_FORMAT_COUNT];
    double multiply_adds_per_s, exponentials_per_s; /* of float32, of all lanes */
    int grid_side; /* nodes of the grid that it samples, which caches may hold */
};

/* The best of several runs in about `seconds` for each, after as long a warm-up. NaN: the device
 * has no clock. `texel_formats`: 1 << format of each that is measured. */
enum neph_status neph_ceilings_measure(struct neph_vulkan *vulkan, double seconds,
                                       unsigned texel_formats, struct neph_ceilings *ceilings,
                                       struct neph_diag *diag);

#endif
