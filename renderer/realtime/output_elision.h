/* SPDX-License-Identifier: MIT
 *
 * Output elision: static frames in flight (stillness.h) whose outputs only the next frame reads.
 * - Half-resolution texels: only those with a ray are computed, in place; a full frame would copy
 *   the others.
 * - The full-resolution volume is composed with the background while it is computed, and is not
 *   stored.
 * The bits stay the same, with two exceptions: the distances in files, and the results where nine
 * neighbouring rays are NaN.
 */
#ifndef NEPH_RENDERER_REALTIME_OUTPUT_ELISION_H
#define NEPH_RENDERER_REALTIME_OUTPUT_ELISION_H

#include "renderer/realtime/layout.h"

/* Whether a static view may become RT_STEADY_UNREAD when its frame is not read back: no partial
 * tiles, no setting that changes texels without a ray, no other pass that reads the volume. */
bool neph_rt_can_elide_output(const struct neph_gpu_view *view);

bool neph_rt_is_output_elided(const struct neph_gpu_view *view);

/* The target whose buffer is bound for `target`: with output elision the history is updated in
 * place. */
int neph_rt_find_buffer(const struct neph_gpu_view *view, int target);

#endif
