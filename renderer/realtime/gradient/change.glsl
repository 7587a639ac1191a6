// SPDX-License-Identifier: MIT
//
// The change around a tile, the result of the temporal gradient (gradient.comp, change.comp).
#ifndef NEPH_REALTIME_CHANGE_GLSL
#define NEPH_REALTIME_CHANGE_GLSL

#include "renderer/realtime/shared/view.glsl"

struct Change {
    vec3 gain;     // light of this frame over light of the frame before
    float residue; // the change between two samples that the gain does not explain
};

// Known: no change for many frames (renderer/realtime/stillness.h).
bool is_unchanged() { return choice(RT_STEADY) >= RT_STEADY_KNOWN; }

// Only the next frame reads this one (renderer/realtime/output_elision.h).
bool is_output_elided() { return choice(RT_STEADY) == RT_STEADY_UNREAD; }

Change load_change(int target, ivec2 tile)
{
    if (is_unchanged())
        return Change(vec3(1.0), 0.0);
    vec4 found = fetch_tile(target, tile);
    return Change(found.rgb, found.a);
}

// A ramp: 0 up to `least`, 1 from 2 `least` on, linear between; 1 for `least` = 0.
float beyond(float value, float least)
{
    return least > 0.0 ? clamp(value / least - 1.0, 0.0, 1.0) : 1.0;
}

// The time in which light changes by `most`, in units of the time between two samples: a longer
// mean would lag behind slow light.
float compute_change_time(float change, float most)
{
    return change > 0.0 ? most / change : FAR_M;
}

#endif
