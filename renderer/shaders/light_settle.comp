#version 450
// SPDX-License-Identifier: MIT
//
// Temporal accumulation of traced light (traced_light.glsl): adds the results of a round's paths to
// the faded sums of earlier rounds. One thread is one texel. The earlier sums are reprojected: they
// are read where the texel's medium was in the frame before.
#extension GL_GOOGLE_include_directive : require

#include "traced_light.glsl"

layout(local_size_x = 64) in;

layout(push_constant) uniform LightFade {
    vec3 right; // camera of the frame before, as in frame.glsl
    float half_width;
    vec3 up;
    float half_height;
    vec3 forward;
    float keep; // factor of the earlier sums; 0: there are none
    // The earlier camera's position, moved on by the wind, relative to the present camera.
    vec3 position_m;
    uint paths;
    uvec2 size_px;
    uint texel_px;
    uint is_parallel;
    uint is_still; // 1: nothing has moved since the frame before
} fade;

// This frame's camera: the first fields of the block in frame.glsl.
layout(std140, binding = 0) uniform Now {
    vec3 right;
    float half_width;
    vec3 up;
    float half_height;
    vec3 forward;
} now;

layout(std430, binding = 1) readonly buffer Found {
    LightTexel found[];
};

layout(std430, binding = 2) readonly buffer Before {
    LightTexel before[];
};

layout(std430, binding = 3) writeonly buffer Settled {
    LightTexel settled[];
};

LightTexel none() { return LightTexel(vec3(0.0), 0.0, 0.0, float[3](0.0, 0.0, 0.0)); }

void add(inout LightTexel sum, LightTexel texel, float weight)
{
    sum.light += weight * texel.light;
    sum.collisions += weight * texel.collisions;
    sum.distance_m += weight * texel.distance_m;
}

// The sum over the texel's paths of this round.
LightTexel sum_round(uint texel)
{
    LightTexel sum = none();
    for (uint p = 0; p < fade.paths; p++)
        add(sum, found[texel * fade.paths + p], 1.0);
    return sum;
}

// Mean distance of the first collisions of a texel, with the earlier ones included, so that a texel
// without new collisions keeps its distance. FAR_M without any.
float texel_distance_m(uint texel, LightTexel fresh)
{
    LightTexel known = none();
    add(known, before[texel], 1.0);
    add(known, fresh, 1.0);
    return known.collisions > 0.0 ? known.distance_m / known.collisions : FAR_M;
}

// The reprojected place of a texel in the frame before, in texels.
vec2 place_before(uvec2 at, float distance_m)
{
    vec2 place = (vec2(at) + 0.5) * (2.0 * float(fade.texel_px)) / vec2(fade.size_px) - 1.0;
    vec3 aside = place.x * now.half_width * now.right - place.y * now.half_height * now.up;
    bool is_parallel = fade.is_parallel != 0u;
    vec3 point_m = is_parallel ? aside + distance_m * now.forward
                               : distance_m * normalize(now.forward + aside);
    vec3 from_m = point_m - fade.position_m;
    float depth_m = dot(from_m, fade.forward);
    if (depth_m <= 0.0 && !is_parallel)
        return vec2(-2.0); // behind the earlier camera: outside the frame
    float spread_m = is_parallel ? 1.0 : depth_m;
    vec2 then = vec2(dot(from_m, fade.right) / (spread_m * fade.half_width),
                     -dot(from_m, fade.up) / (spread_m * fade.half_height));
    return (0.5 * then + 0.5) * vec2(fade.size_px) / float(fade.texel_px) - 0.5;
}

// Bilinear lookup of the earlier sums; texels outside the frame count as 0.
LightTexel sample_history(vec2 place, uvec2 size)
{
    LightTexel sum = none();
    vec2 low = floor(place), part = place - low;
    for (int i = 0; i < 4; i++) {
        ivec2 step = ivec2(i & 1, i >> 1), at = ivec2(low) + step;
        vec2 weight = mix(1.0 - part, part, vec2(step));
        if (all(greaterThanEqual(at, ivec2(0))) && all(lessThan(at, ivec2(size))))
            add(sum, before[uint(at.x) + size.x * uint(at.y)], weight.x * weight.y);
    }
    return sum;
}

void main()
{
    uint texel = gl_GlobalInvocationID.x;
    uvec2 size = light_size(fade.size_px, fade.texel_px);
    if (texel >= size.x * size.y)
        return;
    uvec2 at = uvec2(texel % size.x, texel / size.x);
    LightTexel sum = sum_round(texel);
    if (fade.keep > 0.0) {
        LightTexel old = before[texel];
        if (fade.is_still == 0u)
            old = sample_history(clamp(place_before(at, texel_distance_m(texel, sum)), vec2(-2.0),
                                  vec2(size + 1u)), size);
        add(sum, old, fade.keep);
    }
    settled[texel] = sum;
}
