/* SPDX-License-Identifier: MIT
 *
 * Lights that have changed since the frame before, for the history of froxels, which follows them
 * (froxels/froxel_light.comp).
 */
#ifndef NEPH_RENDERER_REALTIME_LAMP_CHANGES_H
#define NEPH_RENDERER_REALTIME_LAMP_CHANGES_H

#include "renderer/realtime/light_history.h"
#include "renderer/realtime/view.h"

/* Writes lamps_changed, lamps_before and sun_jumped of a view. `origin_shift_m` is added to places
 * of the frame before, `camera_m` is the place of this frame's camera. Without a frame before
 * nothing has changed. A different number of lights counts as a jump of the sun. */
void neph_rt_view_set_lamp_changes(struct neph_gpu_view *view,
                                   const struct neph_rt_light_history *history,
                                   struct neph_vec3 origin_shift_m, struct neph_vec3 camera_m);

#endif
