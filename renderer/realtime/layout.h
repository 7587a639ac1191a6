/* SPDX-License-Identifier: MIT
 *
 * Sizes and formats of the targets: RT_TARGETS of realtime/shared/names.h, as the settings want
 * them.
 */
#ifndef NEPH_RENDERER_REALTIME_LAYOUT_H
#define NEPH_RENDERER_REALTIME_LAYOUT_H

#include "base/option.h"
#include "renderer/realtime/view.h"

/* Fill in settings, sizes and targets of a view at `origin_px` (multiples of 4) within targets that
 * have room for `buffer_px`; everything else 0. It becomes a picture of `picture_px` and is that
 * large itself, or smaller with screen_percent, which leaves no room for others: the picture is the
 * buffer then. */
void neph_rt_view_init(struct neph_gpu_view *view, const struct neph_settings *settings,
                       const int picture_px[2], const int origin_px[2], const int buffer_px[2]);

/* Side of what is rendered for a picture's, rounded up. */
int neph_rt_rendered_px(int picture_px, int percent);

/* Places of the jitter where `length` of them make a picture of 100 %: as many in each of its
 * pixels. Odd stays odd, so that four slots see all of them. */
int neph_rt_jitter_length(int length, int percent);

/* Whether a target has the picture's pixels, and not those that are rendered. */
bool neph_rt_is_of_picture(int target);

/* Bytes of one target: what a GPU would have in memory for its texture. */
uint64_t neph_rt_target_bytes(const struct neph_gpu_view *view, int target);

/* The texels of a target that are the view's; of froxels all. */
struct neph_rt_rectangle {
    uint32_t left, top, width, height;
};

struct neph_rt_rectangle neph_rt_view_texels(const struct neph_gpu_view *view, int target);

/* Texels that a view has at a resolution: RT_PICTURE, RT_FULL, RT_HALF, RT_QUARTER; or its froxels
 * or columns of them: RT_FROXEL, RT_FROXEL_COLUMN. */
uint64_t neph_rt_texel_count(const struct neph_gpu_view *view, int resolution);

#endif
