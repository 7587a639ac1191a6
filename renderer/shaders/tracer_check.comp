#version 450
// SPDX-License-Identifier: MIT
//
// The path tracer's kernel after the paths, if SUN_BY_TABLE: corrects the bias of the table
// (tracer_sun.glsl). One thread per batch of samples chooses one event of the batch, in proportion
// to its light by the table, computes its exact transmittance, and applies the ratio to the light
// of the whole batch. The higher orders together have one such event, and order 1, where it uses
// the table, another. The correction is added to the sample of the chosen event, so that the
// differences of pairs include its noise (tracer_sum.comp).
#extension GL_GOOGLE_include_directive : require

#include "tracer_sun.glsl"

layout(local_size_x = 64) in;

// Light is reduced by this, half a digit of float32, so that no sum of a batch becomes negative.
const float ROUNDING = 1e-6;

// Weighted reservoir of size 1: selects a sample in proportion to its light (M. T. Chao, "A General
// Purpose Unequal Probability Sampling Plan", Biometrika 69, 1982).
struct Choice {
    uint item;
    float u;    // uniform; renewed after each step
    float most; // sum over all so far
    vec3 light; // the same per channel
};

void offer(inout Choice choice, uint item, float most, vec3 light)
{
    if (most <= 0.0)
        return;
    choice.most += most;
    choice.light += light;
    float share = most / choice.most;
    bool is_taken = choice.u < share;
    choice.item = is_taken ? item : choice.item;
    choice.u = is_taken ? choice.u / share : (choice.u - share) / max(1.0 - share, 1e-30);
}

// Correction of a batch (of either sign), when the chosen light has this colour.
vec3 compute_correction(Choice choice, vec3 point_m, float guessed, vec3 color)
{
    float arrives = transmittance(scene_optical_depth(point_m, to_sun(), FAR_M).r);
    return color * (choice.most * (arrives / guessed)) - choice.light * (1.0 - ROUNDING);
}

// Whether an item has stored a result; empty items have not (tracer.comp).
bool has_stored_result(uint item) { return SURFACES || firsts[item].weight != vec3(0.0); }

void check_higher(uint first, float u)
{
    Choice choice = Choice(first, u, 0.0, vec3(0.0));
    for (uint item = first; item < first + BATCH_SAMPLES; item++)
        if (has_stored_result(item))
            offer(choice, item, sun_checks[item].most, sun_checks[item].light);
    if (choice.most == 0.0)
        return;
    SunCheck event = sun_checks[choice.item];
    results[choice.item].higher.rgb +=
        compute_correction(choice, event.point_m, event.guessed, event.color);
}

void check_first(uint first, uint pixel, float u)
{
    Choice choice = Choice(first, u, 0.0, vec3(0.0));
    for (uint item = first; item < first + BATCH_SAMPLES; item++)
        if (has_stored_result(item))
            offer(choice, item, max_channel(sun_checks[item].first_light),
                  sun_checks[item].first_light);
    if (choice.most == 0.0)
        return;
    SunCheck event = sun_checks[choice.item];
    vec3 point_m = view_point_m(pixel_ray(run.first_pixel + pixel), firsts[choice.item].t_m);
    results[choice.item].order1.rgb +=
        compute_correction(choice, point_m, event.first_guessed,
                event.first_light / max_channel(event.first_light));
}

void main()
{
    uint first = gl_GlobalInvocationID.x * BATCH_SAMPLES, pixel = first / run.samples;
    if (pixel >= run.pixel_count)
        return;
    uint batch = (run.first_sample + first % run.samples) / BATCH_SAMPLES;
    vec3 u = uniform_from(
        pcg4d(uvec4(run.first_pixel + pixel, batch, ~run.seed_low, run.seed_high)).xyz);
    check_higher(first, u.x);
    if (FIRST_BY_PATH)
        check_first(first, pixel, u.y);
}
