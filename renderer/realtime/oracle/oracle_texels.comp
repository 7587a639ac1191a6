#version 450
// SPDX-License-Identifier: MIT
//
// The oracle of the reconstruction: each half-resolution texel has its own ray, marched as the
// tile's, without noise. The reconstruction finds it in its own output and replaces it.
#extension GL_GOOGLE_include_directive : require

#include "renderer/realtime/ray_march/medium_ray.glsl"

void main()
{
    load_known_solids();
    uint thread = gl_GlobalInvocationID.x;
    ivec2 half_pixel = element_at(int(run.first_ray + thread), half_size().x);
    if (thread >= run.ray_count)
        return;
    vec2 place_px = vec2(2 * half_pixel + 1);
    if (choice(RT_JITTERED_DEPTH) != 0)
        place_px += jitter_px;
    MarchedRay marched;
    if (!march_ray(thread, make_ray(place_px, fetch_half(RT_HALF_DEPTH, half_pixel).x, 0.5),
                   marched))
        return;
    if (choice(RT_TARGET_FORMAT) == RT_FORMAT_HALF)
        marched.value = min(marched.value, vec4(HALF_MAX));
    put_half(RT_HISTORY, half_pixel, marched.value);
    put_half(RT_HISTORY_STATE, half_pixel, vec4(1.0, marched.distance_m, 0.0, 0.0));
}
