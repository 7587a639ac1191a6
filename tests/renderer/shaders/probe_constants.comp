#version 450
// SPDX-License-Identifier: MIT
//
// Control flow that depends on specialization constants, for tests/renderer/test_specialize.c,
// which has the same functions in C.
layout(local_size_x = 64) in;

layout(constant_id = 0) const uint KIND = 3;
layout(constant_id = 1) const bool IS_ON = true;
layout(constant_id = 2) const uint TURNS = 2;
layout(constant_id = 3) const float FACTOR = 0.5;
layout(constant_id = 4) const uint KEPT = 11; // keeps its default

const bool IS_BOTH = IS_ON && KIND == 2;
const uint SHIFTED = (KIND << 3) | (IS_ON ? 1u : 0u);

layout(std430, set = 0, binding = 0) readonly buffer Asked
{
    uint asked[];
};
layout(std430, set = 0, binding = 1) buffer Answers
{
    uvec4 answers[];
};

// Early returns, which become a switch with one case in SPIR-V.
uint early(uint x)
{
    if (KIND == 1)
        return x + 1;
    if (IS_ON && x > 40)
        return 7;
    for (uint i = 0; i < TURNS; i++) {
        if (KIND == 4)
            return i;
        if (x % 3 == i)
            return 100 + i;
    }
    return x * 2;
}

uint chosen(uint x)
{
    uint result = x;
    switch (KIND) {
    case 0:
        result += 5;
        break;
    case 2:
        result *= 3;
        // falls through
    case 3:
        result ^= 9;
        break;
    default:
        result = 1;
    }
    return result;
}

// Loops that end at once, that a break ends, and with exits that are never taken.
uint turns(uint x)
{
    uint sum = 0;
    do {
        sum += x & 3;
        if (KIND == 3)
            break;
        for (uint i = 0; IS_ON && i < x; i++) {
            if (i == KIND)
                continue;
            if (!IS_ON)
                return 3;
            sum += i;
        }
    } while (!IS_ON && sum < 6 && x % 4 != 0);
    while (IS_BOTH) {
        sum += 11;
        if (sum > 60)
            break;
    }
    return sum;
}

float scaled(uint x)
{
    float value = IS_ON ? float(x) * FACTOR : float(x) + FACTOR;
    bool is_large = KIND > 2 || value > 9.0;
    return is_large ? value : KIND == 2 ? FACTOR : 3.0;
}

void main()
{
    uint i = gl_GlobalInvocationID.x, x = asked[i];
    answers[i] = uvec4(early(x) + KEPT, chosen(x) + SHIFTED, turns(x), floatBitsToUint(scaled(x)));
}
