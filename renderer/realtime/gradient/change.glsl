// SPDX-License-Identifier: MIT
//
// What the temporal gradient (gradient.comp, change.comp) says of the surroundings of a tile.
#ifndef NEPH_REALTIME_CHANGE_GLSL
#define NEPH_REALTIME_CHANGE_GLSL

#include "renderer/realtime/shared/view.glsl"

struct Change {
    vec3 gain;     // the light of this frame over that of the frame before
    float residue; // what that does not explain, between two looks
};

// Nothing has changed for so long that this is known (renderer/realtime/stillness.h).
bool is_unchanged() { return choice(RT_STEADY) >= RT_STEADY_KNOWN; }

// And of the picture's parts nobody asks for more than the next picture does.
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
