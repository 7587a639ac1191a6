/* SPDX-License-Identifier: MIT
 *
 * Light history: sun and lights of the last frames. Gradient samples (gradient/gradient.comp)
 * compare light over a fixed number of frames, so they cannot see two cases, which are found here:
 * - a light flashes with exactly this period, and both samples see the same light;
 * - a light jumps, and texels that the slot override never marches keep the old light.
 */
#ifndef NEPH_RENDERER_REALTIME_LIGHT_HISTORY_H
#define NEPH_RENDERER_REALTIME_LIGHT_HISTORY_H

#include "scenes/scene.h"

#include <stdbool.h>
#include <stdint.h>

enum { NEPH_RT_LIGHT_HISTORY_MAX = 64 };

struct neph_rt_light_frame {
    struct neph_sun sun;
    int light_count;
    struct neph_light lights[NEPH_SCENE_LIGHTS_MAX];
};

struct neph_rt_light_history {
    struct neph_rt_light_frame frames[NEPH_RT_LIGHT_HISTORY_MAX]; /* frame n at n mod that */
    uint32_t last;                                                /* number of the latest frame */
    uint32_t count; /* consecutive frames up to it; 0: none yet */
};

/* Stores sun and lights of the static scene of a frame. The number of the latest frame replaces
 * them; a number that is not the next one restarts the history. */
void neph_rt_light_history_add(struct neph_rt_light_history *history, uint32_t number,
                               const struct neph_scene *static_scene);

/* The frame `frame_count` before the latest one; it is less than the history's count. */
const struct neph_rt_light_frame *
neph_rt_light_history_frame(const struct neph_rt_light_history *history, uint32_t frame_count);

/* Whether two suns differ by less than neph_rt_light_history_is_periodic() says. */
bool neph_rt_are_suns_similar(const struct neph_sun *a, const struct neph_sun *b);

/* Whether the latest 2 x `period` frames are one period twice, with a difference inside the period.
 * Two suns or lights differ when a channel of the irradiance or intensity differs by a tenth or the
 * direction or axis by 0.1 rad: from there on the presets with a gradient treat light as changed.
 * Places of lights are not compared: their effect depends on the distance to the lit point. A slow
 * sun is never periodic in this sense: at its turning point it differs from the sun one period
 * before. False while the history is shorter, and for periods above half of
 * NEPH_RT_LIGHT_HISTORY_MAX. */
bool neph_rt_light_history_is_periodic(const struct neph_rt_light_history *history,
                                       uint32_t period);

/* Whether sun or lights of one of the latest `frame_count` frames differ from the frame before. */
bool neph_rt_light_history_has_jump(const struct neph_rt_light_history *history,
                                    uint32_t frame_count);

#endif
