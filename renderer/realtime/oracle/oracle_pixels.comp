#version 450
// SPDX-License-Identifier: MIT
//
// The oracle of the upscale: the ray of each pixel minus the upscale of the texels' own rays
// (oracle_spread.comp), which is the error of the upscale. The upscale adds it.
#extension GL_GOOGLE_include_directive : require

#include "renderer/realtime/ray_march/medium_ray.glsl"

void main()
{
    load_known_solids();
    uint thread = gl_GlobalInvocationID.x;
    ivec2 pixel = element_at(int(run.first_ray + thread), view_size().x);
    if (thread >= run.ray_count)
        return;
    MarchedRay marched;
    vec2 place_px = vec2(pixel) + 0.5 + jitter_px;
    if (!march_ray(thread, make_ray(place_px, fetch_full(RT_DEPTH, pixel).x, 0.5), marched))
        return;
    put_full(RT_VOLUME, pixel, marched.value - fetch_full(RT_VOLUME, pixel));
}
