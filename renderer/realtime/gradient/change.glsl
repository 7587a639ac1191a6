// SPDX-License-Identifier: MIT
//
// The change around a tile, as the temporal gradient has it (gradient.comp, change.comp).
#ifndef NEPH_REALTIME_CHANGE_GLSL
#define NEPH_REALTIME_CHANGE_GLSL

#include "renderer/realtime/shared/view.glsl"

struct Change {
    vec3 gain;     // the light of this frame over that of the frame before
    float residue; // what that does not explain, between two looks
};

// Nothing has changed for so long that this is known (renderer/realtime/stillness.h).
bool is_unchanged() { return choice(RT_STEADY) >= RT_STEADY_KNOWN; }

// Only the next frame reads this one (renderer/realtime/unread.h).
bool is_unread() { return choice(RT_STEADY) == RT_STEADY_UNREAD; }

Change change_of(int target, ivec2 tile)
{
    if (is_unchanged())
        return Change(vec3(1.0), 0.0);
    vec4 found = fetch_tile(target, tile);
    return Change(found.rgb, found.a);
}

// 0 up to `least`, 1 from twice that on.
float beyond(float value, float least)
{
    return least > 0.0 ? clamp(value / least - 1.0, 0.0, 1.0) : 1.0;
}

// How many times the frames between two looks at the light it takes to change by `most`: a mean of
// more would lag behind slow light.
float lasting(float change, float most)
{
    return change > 0.0 ? most / change : FAR_M;
}

#endif
