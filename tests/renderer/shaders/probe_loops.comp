#version 450
// SPDX-License-Identifier: MIT
//
// Values read after a loop that threads leave at different times, for
// tests/renderer/test_spirv_loops.c, which has the same functions in C.
#extension GL_KHR_shader_subgroup_vote : require

layout(local_size_x = 64) in;

layout(constant_id = 0) const uint WAY = 0;
layout(constant_id = 1) const bool WRAPS = false;

layout(std430, set = 0, binding = 0) readonly buffer Asked
{
    uint asked[];
};
layout(std430, set = 0, binding = 1) buffer Answers
{
    uint answers[];
};

uint carried(uint x)
{
    uint sum = 0, i = 0;
    do
        sum += asked[i++] + 1;
    while (sum < x);
    return sum;
}

uint left_at_its_start(uint x)
{
    uint i = 1, value = asked[0];
    while (value < x)
        value = asked[i++];
    return value;
}

uint last_read(uint x)
{
    uint i = 0, value;
    do
        value = asked[i++];
    while (value < x);
    return value;
}

// The condition is a vote: all threads continue until the last one's value is large enough.
uint last_read_together(uint x)
{
    uint i = 0, value;
    do
        value = asked[i++];
    while (subgroupAny(value < x));
    return uint(value >= x);
}

uint last_made(uint x)
{
    uint i = 0, value;
    do
        value = 3 * i++;
    while (value < x);
    return value;
}

uint wrapped(uint i)
{
    if (!WRAPS)
        return i;
    return i % 7;
}

uint place_before(uint x)
{
    uint at = x % 7, before = at, value = 0;
    while (value < x && at < 60) {
        before = at;
        value = asked[wrapped(at)];
        at += 1 + (x & 1);
    }
    return before;
}

// Always left in its first iteration.
uint once(uint x)
{
    do {
        uint value = asked[x & 7];
        if (value > 3)
            return value + x;
        if (value > 1)
            break;
        return value;
    } while (true);
    return x;
}

void main()
{
    uint i = gl_GlobalInvocationID.x, x = asked[i];
    switch (WAY) {
    case 0:
        answers[i] = carried(x);
        break;
    case 1:
        answers[i] = left_at_its_start(x);
        break;
    case 2:
        answers[i] = last_read(x);
        break;
    case 3:
        answers[i] = last_made(x);
        break;
    case 4:
        answers[i] = last_read_together(x);
        break;
    case 5:
        answers[i] = place_before(x);
        break;
    default:
        answers[i] = once(x);
    }
}
