// SPDX-License-Identifier: MIT
//
// The neighbourhood clamp of the reconstruction: the choice of rays around a texel, the box around
// their values, and the clamp of history to it. A texel without a ray in this frame has no value of
// its own, so the box takes the rays of 3x3 tiles that show the same medium as the texel:
//
//     - the nearest ray in depth (nearest_ray()), always;
//     - rays with about the texel's depth: |z - z_ray| < box_depth z_ray;
//     - rays with about the nearest ray's transmittance: |T - T_ray| < box_transmittance, or with
//       contrast = opacity that part of the smaller of the two opacities.
//
// The box of `min_max` reaches from the least to the largest value of these rays, the box of
// `variance` a standard deviation to either side of their mean, extended to the nearest ray.
#ifndef NEPH_REALTIME_CLAMP_HISTORY_GLSL
#define NEPH_REALTIME_CLAMP_HISTORY_GLSL

#include "rays_around.glsl"

bool in_box[9]; // of the rays around

const float OPACITY_LEAST = 1e-6; // against 0 / 0; as in c52e/SkyRendering

// Whether two transmittances are about equal.
bool is_alike(float transmittance, float other)
{
    precise float difference = abs(transmittance - other);
    precise float opacity = 1.0 - (transmittance > other ? transmittance : other);
    precise float allowed = setting(RT_BOX_TRANSMITTANCE) *
                            (choice(RT_CONTRAST) == RT_CONTRAST_TRANSMITTANCE ? 1.0
                             : opacity > OPACITY_LEAST                        ? opacity
                                                                              : OPACITY_LEAST);
    return difference < allowed;
}

// Whether the box includes a ray.
bool is_accepted(int ray, int nearest, float nearest_through, float center_depth_m,
                 bool is_center_sky)
{
    precise float allowed_m = setting(RT_BOX_DEPTH) * ray_at(ray).depth_m;
    bool is_candidate = ray_at(ray).is_usable && (ray != 0 || choice(RT_BOX_CENTRE) != 0) &&
                        (choice(RT_BOX_SAME_KIND) == 0 || ray_at(ray).is_sky == is_center_sky);
    return ray == nearest ||
           (is_candidate && (depth_difference_m(center_depth_m, ray) < allowed_m ||
                             is_alike(ray_at(ray).value.a, nearest_through)));
}

void choose_rays(int nearest, float nearest_through, float center_depth_m, bool is_center_sky)
{
    [[unroll]] for (int i = 0; i < 9; i++)
        in_box[i] = is_accepted(i, nearest, nearest_through, center_depth_m, is_center_sky);
}

void extend_by_rays(inout Box box, int space)
{
    [[unroll]] for (int i = 0; i < 9; i++)
        if (in_box[i])
            extend(box, to_space(space, ray_at(i).value));
}

// The mean and the variance are computed in two passes: in one pass, E[v^2] - E[v]^2 would lose its
// digits for values that differ little.
void extend_by_variance(inout Box box, int space)
{
    float count = 0.0;
    vec4 mean = vec4(0.0), variance = vec4(0.0);
    [[unroll]] for (int i = 0; i < 9; i++)
        if (in_box[i]) {
            count += 1.0;
            mean += to_space(space, ray_at(i).value);
        }
    mean /= count;
    [[unroll]] for (int i = 0; i < 9; i++)
        if (in_box[i]) {
            vec4 difference = to_space(space, ray_at(i).value) - mean;
            variance += difference * difference;
        }
    Box about = variance_box(mean, variance / count, 1.0);
    extend(box, about.low);
    extend(box, about.high);
}

// Clamps history to the box of the accepted rays, which always includes the nearest ray.
vec4 clamp_to_rays(vec4 value, int nearest, float center_depth_m, bool is_center_sky)
{
    if (choice(RT_BOX) == RT_BOX_NONE)
        return value;
    int space = choice(RT_BOX_SPACE);
    vec4 nearest_value = ray_value(nearest), first = to_space(space, nearest_value);
    Box box = Box(first, first);
    choose_rays(nearest, nearest_value.a, center_depth_m, is_center_sky);
    if (choice(RT_BOX) == RT_BOX_MIN_MAX)
        extend_by_rays(box, space);
    else
        extend_by_variance(box, space);
    return clamp_in_space(space, value, nearest_value, box);
}

#endif
