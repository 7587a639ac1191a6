/* SPDX-License-Identifier: MIT
 *
 * Decisions of the pipeline that differ between a CPU and a GPU. Frames keep their bits, except for
 * values with free rounding. Shaders that differ between devices: `variants` in passes.h.
 */
#ifndef NEPH_RENDERER_REALTIME_TUNING_H
#define NEPH_RENDERER_REALTIME_TUNING_H

#include <stdbool.h>

enum neph_rt_device_kind { NEPH_RT_CPU, NEPH_RT_GPU, NEPH_RT_DEVICE_KINDS };

struct neph_rt_tuning {
    int composition; /* the pass that composes volume and background where it can, else a pass of
                        its own: RT_COMPOSITION_TAA, _UPSCALE */
    bool has_driver_halves; /* leave conversion of halves to the driver where correct (halves.h) */
    bool prepares_kernels;  /* compile before the first frame; takes seconds on a CPU */
    bool has_air_kernels;   /* kernels for static media with a moving camera */
    /* Skip outputs that no later frame reads (output_elision.h), and cache static scenes
     * (scene_cache.h). */
    bool elides_outputs;
};

const struct neph_rt_tuning *neph_rt_get_tuning(enum neph_rt_device_kind kind);

#endif
