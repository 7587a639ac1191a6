#version 450
// SPDX-License-Identifier: MIT
//
// The scene pass, in place of a game's own passes: the depth of each pixel, and the radiance behind
// all media, by one ray through the scene's solids. With jitter the depth at the start of the split
// frame comes from a second ray without jitter: a depth map that moves with the jitter
// (jittered_depth = on) makes the choice of slots flicker with a static camera. For the same reason
// the second ray meets the same parts of meshes with alpha as coverage in all frames.
//
// With few solids the loop over them is unrolled (known_solids.glsl), and threads without a pixel
// repeat the work of the last one.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require

#define DRAWS_COVERAGE
#define SEES_GRID_TEXELS
#define KNOWS_SOLIDS

#include "renderer/realtime/shared/rays.glsl"

#include "renderer/realtime/shared/coverage.glsl"

struct SightLine {
    ViewRay ray;
    Hit hit;
};

SightLine sight_line(Camera camera, vec2 place_px)
{
    return SightLine(camera_ray_at(camera, place_px), Hit(FAR_M, NO_SOLID));
}

// Keeps the nearest intersection, by the same rule as scene_hit().
void intersect_solid(Solid solid, uint s, inout SightLine line)
{
    float t0_m, t1_m;
    bool meets = solid_interval(solid, line.ray.origin_m, line.ray.direction, t0_m, t1_m);
    float t_m = t0_m > 0.0 ? t0_m : t1_m;
    if (meets && t_m > 0.0 && t_m < line.hit.t_m)
        line.hit = Hit(t_m, s);
}

// Few solids on a GPU are read once for both rays.
void intersect_solids(ivec2 pixel, inout SightLine picture, inout SightLine steady)
{
    if (!ARE_KNOWN && KNOWN_SOLIDS != RT_SOLIDS_UNKNOWN) {
        [[unroll]] for (uint s = 0; s < KNOWN_SOLIDS; s++) {
            intersect_solid(solids[s], s, picture);
            if (choice(RT_JITTERED_DEPTH) == 0)
                intersect_solid(solids[s], s, steady);
        }
    } else {
        draw_view_coverage(pixel);
        picture.hit = scene_hit(picture.ray.origin_m, picture.ray.direction);
        set_coverage(uvec2(pixel), 0u);
        if (choice(RT_JITTERED_DEPTH) == 0)
            steady.hit = scene_hit(steady.ray.origin_m, steady.ray.direction);
        draw_view_coverage(pixel); // for shadows
    }
}

// With many solids, the 32 threads of a GPU that walk through their trees together have 8 x 4
// pixels, whose rays meet nearly the same boxes. Tiles at the right and the lower edge are smaller.
ivec2 find_tiled_pixel(int ray)
{
    ivec2 size = view_size();
    int band = ray / (4 * size.x), in_band = ray - 4 * size.x * band;
    int height = min(4, size.y - 4 * band), column = in_band / (8 * height);
    int width = min(8, size.x - 8 * column), in_tile = in_band - 8 * height * column;
    return ivec2(8 * column + in_tile % width, 4 * band + in_tile / width);
}

void main()
{
    load_known_solids();
    uint thread = min(gl_GlobalInvocationID.x, run.ray_count - 1u);
    int ray = int(run.first_ray + thread);
    if (KNOWN_SOLIDS != 0u)
        ray = deal_ray(ray, view_size().x * view_size().y);
    bool is_tiled = GPU_ACCESS && KNOWN_SOLIDS == RT_SOLIDS_UNKNOWN;
    ivec2 pixel = is_tiled ? find_tiled_pixel(ray) : element_at(ray, view_size().x);
    Camera camera = frame_camera();
    vec3 background = frame.background;
    SightLine picture = sight_line(camera, vec2(pixel) + 0.5 + jitter_px);
    SightLine steady = sight_line(camera, vec2(pixel) + 0.5);
    intersect_solids(pixel, picture, steady);
    if (choice(RT_JITTERED_DEPTH) != 0)
        steady = picture;
    if (gl_GlobalInvocationID.x >= run.ray_count)
        return;
    bool is_sky = picture.hit.solid == NO_SOLID;
    put_full(RT_DEPTH, pixel, vec4(hit_eye_depth_m(picture.hit, picture.ray)));
    put_full(RT_BEHIND, pixel,
             vec4(is_sky && !HAS_VEIL ? background : radiance_behind(picture.hit, picture.ray),
                  0.0));
    put_full(RT_STEADY_DEPTH, pixel, vec4(hit_eye_depth_m(steady.hit, steady.ray)));
    check_loops();
    count_cost();
}
