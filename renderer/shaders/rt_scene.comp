#version 450
// SPDX-License-Identifier: MIT
//
// What a game's other passes would hand over: the depth of each pixel and what is seen there behind
// all media, by one ray through the scene's solids. The depth that the split of the frame starts
// from comes from a ray of its own when the picture's rays are jittered: a depth map that moves
// with the jitter (jittered_depth = on) makes the choice of slots flicker in front of a camera at
// rest.
#extension GL_GOOGLE_include_directive : require

#include "realtime_march.glsl"

ViewRay ray_through(ivec2 pixel, vec2 jitter_px)
{
    return camera_ray_at(frame_camera(), vec2(pixel) + 0.5 + jitter_px);
}

void main()
{
    uint thread = gl_GlobalInvocationID.x;
    if (thread >= run.ray_count)
        return;
    uint index = run.first_ray + thread;
    ivec2 pixel = ivec2(index % view.size_px[0], index / view.size_px[0]);
    vec2 jitter_px = vec2(view.jitter_px[0], view.jitter_px[1]);
    ViewRay ray = ray_through(pixel, jitter_px);
    Hit hit = scene_hit(ray.origin_m, ray.direction);
    put_full(RT_DEPTH, pixel, vec4(hit_eye_depth_m(hit, ray)));
    put_full(RT_BEHIND, pixel, vec4(radiance_behind(hit, ray), 0.0));
    if (choice(RT_JITTERED_DEPTH) == 0) {
        ray = ray_through(pixel, vec2(0.0));
        hit = scene_hit(ray.origin_m, ray.direction);
    }
    put_full(RT_STEADY_DEPTH, pixel, vec4(hit_eye_depth_m(hit, ray)));
    count_cost();
}
