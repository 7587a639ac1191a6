#version 450
// SPDX-License-Identifier: MIT
//
// The ray marcher at full resolution: one ray per pixel, samples in the middle of the steps. The
// method is in march.glsl; march_run.glsl has the part of the work of one dispatch.
//
// A work group covers a square of 8x8 pixels, so that its rays read the same voxels and diverge
// late. Threads outside the image are idle.
#extension GL_GOOGLE_include_directive : require

#define DRAWS_COVERAGE
#define SEES_GRID_TEXELS

#include "march.glsl"

const uint SQUARE_PX = 8;

struct MarchPixel {
    vec3 radiance; // of media and background
    float eye_depth_m; // FAR_M for the sky
    vec3 volume; // of the media only
    uint density_evaluations;
    vec3 transmittance;
    uint closed_forms;
    float volume_distance_m;
    uint view_steps;
    uint padding[2];
};

layout(std430, binding = 6) writeonly buffer Pixels {
    MarchPixel pixels[];
};

MarchPixel finished_pixel(ViewRay ray, vec2 place_px, Hit hit, Sums sums)
{
    vec3 optical_depth = view_optical_depth(ray, hit.t_m, sums);
    vec3 behind = radiance_behind(hit, ray);
    MarchPixel pixel;
    pixel.volume = view_scattered(sums, optical_depth, ray, place_px);
    pixel.transmittance = fraction_through(optical_depth);
    // `precise`: the same rounding as in realtime/composition/compose.comp.
    precise vec3 radiance = pixel.volume + pixel.transmittance * behind;
    pixel.radiance = radiance;
    if (HAS_VEIL) { // the air and the closed-form fog count as media
        Behind all = veiled_behind(hit, ray);
        pixel.volume += pixel.transmittance * all.veil;
        pixel.transmittance *= all.through;
    }
    pixel.eye_depth_m = hit_eye_depth_m(hit, ray);
    pixel.volume_distance_m = view_distance_m(sums);
    pixel.density_evaluations = density_evaluations;
    pixel.closed_forms = closed_forms;
    pixel.view_steps = view_steps;
    return pixel;
}

// Pixel of a ray; the same as find_ray_pixel() in renderer/march.c. Rays fill a square in this
// order, so eight consecutive rays (a subgroup of lavapipe) are 4x2 pixels and 32 are 8x4:
//
//    0  1  2  3   8  9 10 11
//    4  5  6  7  12 13 14 15
//   16 17 18 19  24 25 26 27
//   20 21 22 23  28 29 30 31    ...
uvec2 find_ray_pixel(uint ray)
{
    uint columns = (frame.width_px + SQUARE_PX - 1) / SQUARE_PX;
    uint square = ray / (SQUARE_PX * SQUARE_PX), own_ray = ray % (SQUARE_PX * SQUARE_PX);
    uvec2 in_square = uvec2((own_ray & 3u) | (own_ray >> 1u & 4u),
                            (own_ray >> 2u & 1u) | (own_ray >> 3u & 6u));
    return SQUARE_PX * uvec2(square % columns, square / columns) + in_square;
}

void main()
{
    uint thread = gl_GlobalInvocationID.x;
    uvec2 pixel = find_ray_pixel(run.first_ray + thread);
    if (thread >= run.ray_count || pixel.x >= frame.width_px || pixel.y >= frame.height_px)
        return;
    vec2 place_px = vec2(pixel) + 0.5 + frame.jitter_px;
    ViewRay ray = camera_ray_at(frame_camera(), place_px);
    set_coverage(pixel, frame.meshes.frame_number);
    Hit hit = scene_hit(ray.origin_m, ray.direction);

    Sums sums = sums_at_start(thread);
    // With a closed-form transmittance and no light from the media, no step is needed.
    if (!IS_SOLVED || HAS_VEIL ||
        make_nonuniform(frame.scatters | frame.emits | frame.scatters_lamps) != 0)
        march(ray, hit.t_m, 0.5, sums);

    if (run.end_step < make_nonuniform(frame.steps))
        sums_keep(thread, sums);
    else
        pixels[thread] = finished_pixel(ray, place_px, hit, sums);
    check_loops();
}
