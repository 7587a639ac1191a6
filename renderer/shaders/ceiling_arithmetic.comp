#version 450
// SPDX-License-Identifier: MIT
//
// Micro-benchmark of arithmetic throughput, for the roofline limits of renderer/roofline.h.
//
// Each thread computes ROWS independent chains of fused multiply-adds (or of exponentials with
// EXPONENTIALS), so that the latency of one chain is hidden by the others. It reads no memory and
// writes one float.

layout(local_size_x = 64) in;

layout(std430, binding = 0) writeonly buffer Results {
    float results[];
};

layout(push_constant) uniform CeilingTurns {
    uint turns; // operations per chain
    float factor, term; // push constants, so that the compiler cannot fold them
} run;

layout(constant_id = 0) const bool EXPONENTIALS = false;

const uint ROWS = 8; // independent chains per thread; roofline.c has the same number

void main()
{
    float rows[ROWS];
    for (uint k = 0; k < ROWS; k++)
        rows[k] = float(gl_GlobalInvocationID.x % 64u + k) * run.factor;
    for (uint i = 0; i < run.turns; i++)
        for (uint k = 0; k < ROWS; k++)
            rows[k] = EXPONENTIALS ? exp2(-rows[k]) : fma(rows[k], run.factor, run.term);
    float sum = 0.0;
    for (uint k = 0; k < ROWS; k++)
        sum += rows[k];
    results[gl_GlobalInvocationID.x] = sum;
}
