#version 450
// SPDX-License-Identifier: MIT
//
// The path tracer's last kernel: the samples of a batch become sums, in the order of the samples,
// one thread per pixel; and every queue starts anew.
//
// The two samples of a pair lie in the same stratum: half their squared difference estimates the
// variance inside the stratum, which is all the variance that a stratified mean has.
#extension GL_GOOGLE_include_directive : require

#include "tracer.glsl"

layout(local_size_x = 64) in;

void main()
{
    uint thread = gl_GlobalInvocationID.x;
    if (thread >= run.pixel_count)
        return;
    if (thread % QUEUE_PIXELS == 0)
        next_items[thread / QUEUE_PIXELS] = 0;
    vec4 transmitted = OPEN ? vec4(1.0) : pixels[thread].transmittance;
    Sum order1 = sum_zero(), higher = sum_zero(), surface = sum_zero();
    vec4 spread = vec4(0.0);
    for (uint s = 0; s < STRATA; s++) {
        Result a = results[thread * BATCH_SAMPLES + 2 * s];
        Result b = results[thread * BATCH_SAMPLES + 2 * s + 1];
        sum_add(order1, a.order1);
        sum_add(order1, b.order1);
        sum_add(higher, a.higher);
        sum_add(higher, b.higher);
        sum_add(surface, a.surface);
        sum_add(surface, b.surface);
        vec4 difference = (a.order1 - b.order1) + (a.higher - b.higher) +
                          transmitted * (a.surface - b.surface);
        spread += difference * difference;
    }
    pixels[thread].sums[0] = order1.value;
    pixels[thread].sums[1] = higher.value;
    pixels[thread].sums[2] = surface.value;
    pixels[thread].spread = spread;
}
