/* SPDX-License-Identifier: MIT
 *
 * Pictures in flight of which it is known that nothing changes (stillness.h): nobody reads more of
 * them than the next picture does. Of the half-resolution texels those alone that have a ray are
 * made, in place, for the others would be copied; and the volume at full resolution, which is laid
 * over what is behind it as it is made, is not kept. The same bits, but for the distance of what is
 * in files, and where nine rays beside each other are no numbers.
 */
#ifndef NEPH_RENDERER_REALTIME_UNREAD_H
#define NEPH_RENDERER_REALTIME_UNREAD_H

#include "renderer/realtime/layout.h"

/* Whether a view that is known to be static may be RT_STEADY_UNREAD if its frame is not read: not
 * with tiles that are cut, with settings that change texels without a ray, nor where another pass
 * reads the volume. */
bool neph_rt_may_be_unread(const struct neph_gpu_view *view);

bool neph_rt_is_unread(const struct neph_gpu_view *view);

/* The target whose buffer a pass finds under a name: history is made in its place then. */
int neph_rt_buffer_of(const struct neph_gpu_view *view, int target);

#endif
