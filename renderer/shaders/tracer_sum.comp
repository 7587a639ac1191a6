#version 450
// SPDX-License-Identifier: MIT
//
// The path tracer's last kernel: adds the samples of a round to the pixel's sums, in order, one
// thread per pixel, and resets the queues. Sums are compensated, so the division into rounds does
// not change them.
//
// Variance. The two samples of a pair are in the same stratum. Half their squared difference
// estimates the variance within the stratum, which is the whole variance of a stratified mean. If
// SOBOL, samples of one sequence are correlated, but the two sequences of the pairs are
// independent. The estimate is then the difference of the two means, squared after all samples are
// added.
//
// A few rare paths may make most of the variance. The sum of the squared squares shows that
// (base/doubt.h).
#extension GL_GOOGLE_include_directive : require

#include "tracer.glsl"

layout(local_size_x = 64) in;

Sum load_sum(uint pixel, uint i)
{
    if (make_nonuniform(run.first_sample) == 0)
        return sum_zero();
    return Sum(pixels[pixel].sums[i], pixels[pixel].excess[i]);
}

void keep_sum(uint pixel, uint i, Sum sum)
{
    pixels[pixel].sums[i] = sum.value;
    pixels[pixel].excess[i] = sum.excess;
}

void main()
{
    uint thread = gl_GlobalInvocationID.x;
    if (thread >= run.pixel_count)
        return;
    next_items[thread] = 0;
    uint pixel = run.first_pixel + thread - run.part_pixel;
    vec4 transmitted = OPEN ? vec4(1.0) : pixels[pixel].transmittance;
    Sum order1 = load_sum(pixel, 0), higher = load_sum(pixel, 1);
    Sum surface = load_sum(pixel, 2), spread = load_sum(pixel, 3);
    uint samples = make_nonuniform(run.samples);
    for (uint s = 0; s < samples; s += 2) {
        Result a = results[thread * samples + s];
        Result b = results[thread * samples + s + 1];
        sum_add(order1, a.order1);
        sum_add(order1, b.order1);
        sum_add(higher, a.higher);
        sum_add(higher, b.higher);
        sum_add(surface, a.surface);
        sum_add(surface, b.surface);
        vec4 difference = (a.order1 - b.order1) + (a.higher - b.higher) +
                          transmitted * (a.surface - b.surface);
        vec3 square = difference.rgb * difference.rgb;
        float scaled = run.noise_scale * (square.r + square.g + square.b);
        sum_add(spread, SOBOL ? difference : vec4(square, scaled * scaled));
    }
    keep_sum(pixel, 0, order1);
    keep_sum(pixel, 1, higher);
    keep_sum(pixel, 2, surface);
    keep_sum(pixel, 3, spread);
}
