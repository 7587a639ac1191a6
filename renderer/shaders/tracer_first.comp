#version 450
// SPDX-License-Identifier: MIT
//
// The path tracer's second kernel: forced first collisions, one thread per item. Every sample
// collides on the view ray, and weighs as much as the ray absorbs; where, is stratified over the
// samples of a batch. The sunlight scattered there towards the camera is order 1, with the exact
// transmittance to the sun.
//
// A fog layer or another medium is chosen in proportion to what it would absorb alone, the collision
// is drawn as if it were alone, and the transmittance of the others up to there is a weight:
//   L = sum_k integral sigma_k T_k (prod_(j != k) T_j) J dt.
// The weight is at most the number of layers and media.
#extension GL_GOOGLE_include_directive : require

#include "tracer.glsl"
#include "free_path.glsl"

layout(local_size_x = 64) in;

struct Choice {
    uint medium, layer;
    float depth; // of the view ray in it, scalar
    float u;     // uniform once more
    vec3 total;  // sum over all of what they would absorb alone, per channel
};

uint layers_of(uint m) { return is_fog(m) ? frame.media[m].layer_count : 1u; }

Choice choose(uint pixel, uint hero, float u)
{
    Choice choice = Choice(0, 0, 0.0, 0.5, vec3(0.0));
    for (uint m = 0; m < frame.medium_count; m++)
        for (uint l = 0; l < layers_of(m); l++)
            choice.total += colour_absorbed_fraction(frame.media[m].extinction_color *
                                                     depths[pixel * PARTS + m * LAYERS_MAX + l]);
    float target = u * choice.total[hero];
    bool is_found = false;
    for (uint m = 0; m < frame.medium_count; m++)
        for (uint l = 0; l < layers_of(m); l++) {
            float depth = depths[pixel * PARTS + m * LAYERS_MAX + l];
            float part = absorbed_fraction(frame.media[m].extinction_color[hero] * depth);
            if (is_found || part <= 0.0)
                continue;
            is_found = target < part;
            choice.medium = m;
            choice.layer = l;
            choice.depth = depth;
            choice.u = clamp(target / part, 1e-9, 1.0 - exp2(-24.0));
            target -= part;
        }
    return choice;
}

// Optical depth of all but the choice up to a distance on the view ray.
vec3 others_depth(Choice choice, vec3 direction, float length_m)
{
    vec3 sum = vec3(0.0);
    if (frame.medium_count == 1 && layers_of(0) == 1)
        return sum;
    for (uint m = 0; m < frame.medium_count; m++) {
        float depth = 0.0;
        for (uint l = 0; l < frame.media[m].layer_count; l++)
            if (m != choice.medium || l != choice.layer)
                depth += layer_optical_depth(m, l, vec3(0.0), direction, length_m);
        if (!is_fog(m) && m != choice.medium)
            depth = medium_optical_depth(m, vec3(0.0), direction, length_m);
        sum += frame.media[m].extinction_color * depth;
    }
    return sum;
}

First first_collision(uint pixel, vec3 direction, uint hero, float u)
{
    First first = First(vec3(0.0), 0.0, vec3(1.0), 0);
    Choice choice = choose(pixel, hero, u);
    if (choice.total[hero] <= 0.0 || choice.depth <= 0.0)
        return first;
    uint m = choice.medium;
    vec3 color = frame.media[m].extinction_color;
    float t0_m = 0.0, t1_m = scene_hit(vec3(0.0), direction).t_m;
    if (!clip_medium(m, vec3(0.0), direction, t0_m, t1_m))
        return first;
    float part = absorbed_fraction(color[hero] * choice.depth);
    float depth = min(-log_1_plus(-choice.u * part) / color[hero], choice.depth);
    first.medium = m;
    first.t_m = medium_free_path(m, choice.layer, direction, t0_m, t1_m, depth);
    first.weight = choice.total * colour_transmittance(others_depth(choice, direction, first.t_m));
    if (COLOURED) { // p = color e^(-color depth) / total; e^30 is more than chance allows
        vec3 density = color / max(choice.total, vec3(1e-30)) *
                       exp(min((color[hero] - color) * depth, vec3(30.0)));
        first.channels = density / density[hero];
    }
    return first;
}

// Sunlight scattered once, at a first collision.
vec3 scattered_once(First first, vec3 direction)
{
    vec3 point_m = first.t_m * direction;
    if (first.weight == vec3(0.0) || frame.sun_irradiance == vec3(0.0) ||
        !sees_sun(point_m, NO_SOLID))
        return vec3(0.0);
    uint m = first.medium;
    float phase = phase_per_sr(frame.media[m].phase_kind, frame.media[m].g, direction,
                               frame.sun_direction);
    vec3 arriving = colour_transmittance(scene_optical_depth(point_m, frame.sun_direction, FAR_M));
    return first.weight * channel_weights(first.channels) * frame.media[m].albedo *
           frame.sun_irradiance * (phase * arriving);
}

void main()
{
    uint item = gl_GlobalInvocationID.x;
    uint pixel = item / BATCH_SAMPLES;
    if (pixel >= run.pixel_count)
        return;
    uint sample_index = item % BATCH_SAMPLES;
    vec3 direction = pixel_ray(run.first_pixel + pixel);
    uvec3 bits = pcg3d(sample_key(run.first_pixel + pixel, run.first_sample + sample_index).xyz);
    float u = (float(sample_index / 2) + uniform_from(bits).x) / float(STRATA);
    First first = first_collision(pixel, direction, hero_of(bits), u);
    firsts[item] = first;
    results[item] = Result(vec4(scattered_once(first, direction), 0.0), vec4(0.0), vec4(0.0));
}
