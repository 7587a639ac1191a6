#version 450
// SPDX-License-Identifier: MIT
//
// The path tracer's second kernel: forced first collisions, one thread per item. Every sample
// collides on the view ray, and weighs as much as the ray absorbs; where, is stratified over the
// samples of a batch. The sunlight scattered there towards the camera is order 1, with the exact
// transmittance to the sun.
//
// With several layers, one is chosen in proportion to what it would absorb alone, the collision is
// drawn as if it were alone, and the transmittance of the others up to there is a weight:
//   L = sum_k integral sigma_k T_k (prod_(j != k) T_j) J dt.
// The weight is at most the number of layers.
#extension GL_GOOGLE_include_directive : require

#include "tracer.glsl"

layout(local_size_x = 64) in;

struct Choice {
    uint medium, layer;
    float within; // (0, 1): uniform again
    float part;   // that the layer absorbs
    float total;  // all layers' parts
};

Choice choose_layer(uint pixel, float u)
{
    float total = 0.0;
    for (uint m = 0; m < frame.medium_count; m++)
        for (uint l = 0; l < frame.media[m].layer_count; l++)
            total += absorbed[pixel * PARTS + m * LAYERS_MAX + l];
    Choice choice = Choice(0, 0, 0.5, 0.0, total);
    float target = u * total;
    bool is_found = false;
    for (uint m = 0; m < frame.medium_count; m++)
        for (uint l = 0; l < frame.media[m].layer_count; l++) {
            float part = absorbed[pixel * PARTS + m * LAYERS_MAX + l];
            if (is_found || part <= 0.0)
                continue;
            is_found = target < part;
            choice = Choice(m, l, clamp(target / part, 1e-9, 1.0 - exp2(-24.0)), part, total);
            target -= part;
        }
    return choice;
}

// How much the other layers leave of the light from a distance on the view ray.
float others_transmittance(Choice choice, vec3 direction, float length_m)
{
    float depth = 0.0;
    for (uint m = 0; m < frame.medium_count; m++) {
        float t0_m = 0.0, t1_m = length_m;
        if (!clip_box(frame.media[m].low_m, frame.media[m].high_m, vec3(0.0), direction, t0_m,
                      t1_m))
            continue;
        for (uint l = 0; l < frame.media[m].layer_count; l++)
            if (m != choice.medium || l != choice.layer)
                depth += fog_optical_depth(frame.media[m].layers[l], t0_m * direction.y,
                                           direction.y, t1_m - t0_m);
    }
    return transmittance(depth);
}

First first_collision(uint pixel, vec3 direction, float u)
{
    Choice choice = choose_layer(pixel, u);
    if (choice.part <= 0.0)
        return First(0.0, 0.0, 0, 0);
    float t0_m = 0.0, t1_m = scene_hit(vec3(0.0), direction).t_m;
    clip_box(frame.media[choice.medium].low_m, frame.media[choice.medium].high_m, vec3(0.0),
             direction, t0_m, t1_m);
    float depth = -log_1_plus(-choice.within * choice.part);
    float t_m = t0_m + fog_free_path(frame.media[choice.medium].layers[choice.layer],
                                     t0_m * direction.y, direction.y, depth);
    t_m = min(t_m, t1_m);
    float weight = choice.total * others_transmittance(choice, direction, t_m);
    return First(t_m, weight, choice.medium, 0);
}

// Sunlight scattered once, at a first collision.
vec3 scattered_once(First first, vec3 direction)
{
    vec3 point_m = first.t_m * direction;
    if (first.weight <= 0.0 || frame.sun_irradiance == vec3(0.0) || !sees_sun(point_m, NO_SOLID))
        return vec3(0.0);
    uint m = first.medium;
    float phase = phase_per_sr(frame.media[m].phase_kind, frame.media[m].g, direction,
                               frame.sun_direction);
    vec3 arriving = transmittance(scene_optical_depth(point_m, frame.sun_direction, FAR_M));
    return frame.media[m].albedo * frame.sun_irradiance * (first.weight * phase * arriving);
}

void main()
{
    uint item = gl_GlobalInvocationID.x;
    uint pixel = item / BATCH_SAMPLES;
    if (pixel >= run.pixel_count)
        return;
    uint sample_index = item % BATCH_SAMPLES;
    vec3 direction = pixel_ray(run.first_pixel + pixel);
    uvec4 key = sample_key(run.first_pixel + pixel, run.first_sample + sample_index);
    float jitter = uniform_from(pcg3d(uvec3(key.xy, key.z ^ KEY_FIRST))).x;
    float u = (float(sample_index / 2) + jitter) / float(STRATA);
    First first = first_collision(pixel, direction, u);
    firsts[item] = first;
    results[item] = Result(vec4(scattered_once(first, direction), 0.0), vec4(0.0), vec4(0.0));
}
