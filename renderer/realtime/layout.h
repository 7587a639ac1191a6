/* SPDX-License-Identifier: MIT
 *
 * Sizes and formats of the targets, from RT_TARGETS of realtime/shared/names.h and the settings.
 */
#ifndef NEPH_RENDERER_REALTIME_LAYOUT_H
#define NEPH_RENDERER_REALTIME_LAYOUT_H

#include "base/option.h"
#include "renderer/realtime/view.h"

/* Fills in settings, sizes and targets of a view at `origin_px` (multiples of 4), within targets of
 * `buffer_px`; everything else is 0. `picture_px` is the output size. With screen_percent below 100
 * fewer pixels are rendered, and the view must fill its targets. */
void neph_rt_view_init(struct neph_gpu_view *view, const struct neph_settings *settings,
                       const int picture_px[2], const int origin_px[2], const int buffer_px[2]);

/* Rendered pixels along a side of the output, rounded up. */
int neph_rt_rendered_px(int picture_px, int percent);

/* Length of the jitter sequence with screen_percent, so that each output pixel has `length` places.
 * An odd length stays odd, so that each of the four slots sees all places. */
int neph_rt_jitter_length(int length, int percent);

/* Whether a target has output resolution (and not rendered resolution). */
bool neph_rt_has_output_size(int target);

/* Bytes of one target as a texture in its format on a GPU. */
uint64_t neph_rt_target_bytes(const struct neph_gpu_view *view, int target);

/* The texels of a target that belong to the view; all of them for froxels. */
struct neph_rt_rectangle {
    uint32_t left, top, width, height;
};

struct neph_rt_rectangle neph_rt_view_texels(const struct neph_gpu_view *view, int target);

/* Number of texels of a view at a resolution: RT_OUTPUT, RT_FULL, RT_HALF, RT_QUARTER; or of its
 * froxels or froxel columns: RT_FROXEL, RT_FROXEL_COLUMN. */
uint64_t neph_rt_texel_count(const struct neph_gpu_view *view, int resolution);

#endif
