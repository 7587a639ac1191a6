#version 450
// SPDX-License-Identifier: MIT
//
// Motion vectors of solids: the displacement since the frame before of the point that a pixel's ray
// meets, without the camera's motion, in metres of the world. The rays are the frame's jittered
// rays (realtime/scene_rays/scene_rays.comp).
#extension GL_GOOGLE_include_directive : require

#define DRAWS_COVERAGE
#define KNOWS_SOLIDS

#include "renderer/shaders/march_run.glsl"
#include "renderer/shaders/scene.glsl"

#define REALTIME_BINDING 11 // as in realtime/shared/rays.glsl, whose other declarations are unused
#include "renderer/realtime/shared/view.glsl"

#include "renderer/realtime/shared/coverage.glsl"

// Rotates about the mover's axis, back to the frame before.
vec3 turned_back(Mover mover, vec3 v)
{
    float c = mover.cosine, s = mover.sine;
    if (mover.axis == 0u)
        return vec3(v.x, c * v.y - s * v.z, s * v.y + c * v.z);
    if (mover.axis == 1u)
        return vec3(c * v.x + s * v.z, v.y, c * v.z - s * v.x);
    return vec3(c * v.x - s * v.y, s * v.x + c * v.y, v.z);
}

bool is_moved(Mover mover, uint solid)
{
    return is_mesh(solid) ? hit_instance(solid) >= mover.instances_first &&
                                hit_instance(solid) < mover.instances_end
                          : solid >= mover.first && solid < mover.end;
}

// The displacement of a point x of a solid, with the mover's rotation R back to the frame before:
//
//     x - x_before = (a - R a) + (pivot - pivot_before),   a = x - pivot
//
// A static mover gives exactly 0: both differences are between equal numbers.
vec3 moved_m(uint solid, vec3 point_m, out float is_mover)
{
    vec3 displacement_m = vec3(0.0);
    is_mover = 0.0;
    for (uint m = 0; m < view.mover_count; m++) {
        Mover mover = view.movers[m];
        if (!is_moved(mover, solid))
            continue;
        precise vec3 arm_m = point_m - mover.pivot_m;
        precise vec3 own_m = arm_m - turned_back(mover, arm_m);
        is_mover = 1.0;
        displacement_m = own_m + (mover.pivot_m - mover.pivot_before_m);
    }
    return displacement_m;
}

void main()
{
    load_known_solids();
    uint thread = min(gl_GlobalInvocationID.x, run.ray_count - 1u);
    ivec2 pixel = element_at(int(run.first_ray + thread), view_size().x);
    ViewRay ray = camera_ray_at(frame_camera(), vec2(pixel) + 0.5 + jitter_px);
    draw_view_coverage(pixel);
    Hit hit = scene_hit(ray.origin_m, ray.direction);
    vec3 displacement_m = vec3(0.0);
    float is_mover = 0.0;
    if (hit.solid != NO_SOLID)
        displacement_m = moved_m(hit.solid, view_point_m(ray, hit.t_m), is_mover);
    if (gl_GlobalInvocationID.x >= run.ray_count)
        return;
    put_full(RT_MOVED, pixel, vec4(displacement_m, is_mover));
}
