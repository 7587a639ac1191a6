#version 450
// SPDX-License-Identifier: MIT
//
// As many fused multiply-adds, or exponentials, as the device can make: each thread makes eight
// rows of them that do not wait for each other, and nothing else (renderer/ceilings.h).

layout(local_size_x = 64) in;

layout(std430, binding = 0) writeonly buffer Results {
    float results[];
};

layout(push_constant) uniform CeilingTurns {
    uint turns; // of ROWS operations each
    float factor, term; // that a compiler does not know
} run;

layout(constant_id = 0) const bool EXPONENTIALS = false;

const uint ROWS = 8; // ceilings.c has it, too

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
