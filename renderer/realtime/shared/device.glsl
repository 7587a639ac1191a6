// SPDX-License-Identifier: MIT
//
// Access to memory and registers, in the form that is fast on a CPU (lavapipe) and in the form that
// is fast on a GPU. Both forms give the same bits. Only this file reads which form a kernel has: an
// algorithm that differs between devices is another shader (`variants` in passes.h).
#ifndef NEPH_REALTIME_DEVICE_GLSL
#define NEPH_REALTIME_DEVICE_GLSL

layout(constant_id = RT_GPU_ACCESS_CONSTANT) const bool GPU_ACCESS = false;

// --- branches and loops -----------------------------------------------------------------------

// A number that is the same in all threads, hidden from the compiler: lavapipe recompiles a kernel,
// for milliseconds in each frame, when a number of the view decides a branch. The bit is 0 in every
// thread index.
uint force_nonuniform(uint number)
{
    return GPU_ACCESS ? number : number | gl_LocalInvocationIndex & 0x80000000u;
}

float force_nonuniform(float number)
{
    return uintBitsToFloat(force_nonuniform(floatBitsToUint(number)));
}

vec3 force_nonuniform(vec3 v)
{
    return vec3(force_nonuniform(v.x), force_nonuniform(v.y), force_nonuniform(v.z));
}

// The first and the last of four taps in a row that a loop visits. lavapipe leaves out taps at the
// ends that have no weight, all but one of four before a static camera. A GPU visits all four: it
// keeps values in registers only where loops have fixed ends.
int first_tap(vec4 weights)
{
    return GPU_ACCESS || weights.x != 0.0 ? 0 : weights.y != 0.0 ? 1 : 2;
}

int last_tap(vec4 weights)
{
    return GPU_ACCESS || weights.w != 0.0 ? 3 : weights.z != 0.0 ? 2 : 1;
}

// --- threads ----------------------------------------------------------------------------------

// Column and row of an element of an image that is `width` wide. lavapipe divides integers one
// thread after the other. The quotient of floats is off by at most one row, up to 2^20 rows.
ivec2 element_at(int index, int width)
{
    int row = int(float(index) / float(width));
    int column = index - row * width;
    if (column < 0)
        return ivec2(column + width, row - 1);
    return column < width ? ivec2(column, row) : ivec2(column - width, row + 1);
}

// Index of the ray of a thread, of `count` rays of a frame; a permutation. lavapipe gives each core
// a contiguous range of work groups, so one core can have only sky and wait for another that has
// only clouds. Interleaving the groups gives each core groups from all parts of the frame.
int deal_ray(int thread, int count)
{
    const int group_rays = 64, hands = 16;
    int rows = count / group_rays / hands, group = thread / group_rays;
    if (GPU_ACCESS || group >= hands * rows)
        return thread;
    ivec2 place = element_at(group, max(rows, 1));
    return group_rays * (hands * place.x + place.y) + thread % group_rays;
}

// --- words of targets -------------------------------------------------------------------------

// lavapipe reads texels faster than words of a buffer. The number of words of an element is a
// constant only where the formats are.
const bool READS_TEXELS = SPECIALISED && !GPU_ACCESS;

uint load_word(int target, uint index)
{
#ifdef SEES_TEXELS
    if (READS_TEXELS)
        return imageLoad(target_texels[target], int(index)).x;
#endif
    return targets[target].words[index];
}

uvec2 load_word_pair(int target, uint index)
{
#ifdef SEES_TEXELS
    if (READS_TEXELS)
        return imageLoad(target_texel_pairs[target], int(index)).xy;
#endif
    if (GPU_ACCESS)
        return target_pairs[target].words[index];
    return unpackUint2x32(target_longs[target].words[index]);
}

uvec4 load_word_four(int target, uint index)
{
#ifdef SEES_TEXELS
    if (READS_TEXELS)
        return imageLoad(target_texel_fours[target], int(index));
#endif
    return target_fours[target].words[index];
}

void store_word_pair(int target, uint index, uvec2 pair)
{
    if (GPU_ACCESS)
        target_pairs[target].words[index] = pair;
    else
        target_longs[target].words[index] = packUint2x32(pair);
}

#endif
