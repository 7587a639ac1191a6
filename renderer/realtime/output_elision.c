/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/output_elision.h"

/* Settings and the values that output elision needs. */
static const struct {
    int setting;
    float value;
} needed[] = {
    {RT_COMPOSITION, RT_COMPOSITION_UPSCALE},
    {RT_TAA_RESPONSIVE, 0.0f},
    {RT_ATROUS, 0.0f},
    {RT_HISTORY_WEIGHT, 1.0f},
    {RT_JITTERED_DEPTH, 0.0f},
};

static bool is_whole(const struct neph_gpu_view *view, int axis)
{
    return 2 * view->tile_count[axis] == view->half_size_px[axis];
}

bool neph_rt_can_elide_output(const struct neph_gpu_view *view)
{
    const bool needs_no_box = view->settings[RT_BOX_MOTION_PX] != 0.0f &&
                              view->settings[RT_BOX_CHANGE] != 0.0f;
    bool may_be = is_whole(view, 0) && is_whole(view, 1) && needs_no_box;
    for (size_t i = 0; i < sizeof(needed) / sizeof(needed[0]); i++)
        may_be &= view->settings[needed[i].setting] == needed[i].value;
    return may_be;
}

bool neph_rt_is_output_elided(const struct neph_gpu_view *view)
{
    return view->settings[RT_STEADY] == (float)RT_STEADY_UNREAD;
}

int neph_rt_find_buffer(const struct neph_gpu_view *view, int target)
{
    int buffer = target;
    if (neph_rt_is_output_elided(view) && target == RT_HISTORY)
        buffer = RT_HISTORY_BEFORE;
    if (neph_rt_is_output_elided(view) && target == RT_HISTORY_STATE)
        buffer = RT_HISTORY_STATE_BEFORE;
    return buffer;
}
