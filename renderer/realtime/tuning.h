/* SPDX-License-Identifier: MIT
 *
 * What the pipeline does on one kind of device and not on the other. Frames keep their bits, but
 * for freely rounded values. Shaders that differ between devices: `variants` in passes.h.
 */
#ifndef NEPH_RENDERER_REALTIME_TUNING_H
#define NEPH_RENDERER_REALTIME_TUNING_H

#include <stdbool.h>

enum neph_rt_device_kind { NEPH_RT_CPU, NEPH_RT_GPU, NEPH_RT_DEVICE_KINDS };

struct neph_rt_tuning {
    int composition; /* the pass that lays the volume over what is behind it: RT_COMPOSITION_TAA,
                        _UPSCALE; where it cannot, a pass of its own */
    bool has_driver_halves; /* converts halves as the driver does where that is right (halves.h) */
    bool prepares_kernels;  /* before the first frame; on a CPU that takes seconds */
    bool has_air_kernels;   /* for still air before a moving camera */
    bool elides_outputs;    /* that no later frame reads (unread.h), and keeps static scenes
                               (kept_scene.h) */
};

const struct neph_rt_tuning *neph_rt_tuning_of(enum neph_rt_device_kind kind);

#endif
