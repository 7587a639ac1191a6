// SPDX-License-Identifier: MIT
//
// What the temporal gradient (rt_gradient.comp) says of the surroundings of a tile.
#ifndef NEPH_REALTIME_CHANGE_GLSL
#define NEPH_REALTIME_CHANGE_GLSL

#include "realtime.glsl"

// 0 up to `least`, 1 from twice that on.
float beyond(float value, float least)
{
    return least > 0.0 ? clamp(value / least - 1.0, 0.0, 1.0) : 1.0;
}

// The most that has changed in 3x3 tiles, of the medium and behind it. Where no ray of them was
// marched before with the same number, all of the medium may have changed.
vec2 change_around(ivec2 tile)
{
    vec2 most = vec2(-1.0);
    for (int i = 0; i < 9; i++) {
        vec2 change = fetch_tile(RT_CHANGE, tile + ivec2(i % 3, i / 3) - 1).xy;
        most = mix(most, change, greaterThan(change, most));
    }
    return most.x < 0.0 ? vec2(1.0, most.y) : most;
}

// How many times the frames between two looks at the light it takes to change by `most`: a mean of
// more would lag behind slow light.
float lasting(float change, float most)
{
    return change > 0.0 ? most / change : FAR_M;
}

#endif
