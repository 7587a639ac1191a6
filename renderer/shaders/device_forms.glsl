// SPDX-License-Identifier: MIT
//
// Differences between CPU devices (lavapipe) and GPUs, for the ray marcher and the path tracer.
//
// This is the only file that tests the kind of device. Other files use the constants below, which
// name a form of the code and its reason, or have the other form in a separate file
// (march_texture_cpu.glsl). Both forms give the same frame up to the rounding of sums. Passes of
// the real-time renderer have variants instead (renderer/realtime/passes.h).
#ifndef NEPH_DEVICE_FORMS_GLSL
#define NEPH_DEVICE_FORMS_GLSL

const bool ON_CPU = (TRAITS & NEPH_GPU_ON_CPU) != 0u;

// Makes a value of the frame formally thread-dependent: the OR with an impossible bit of the local
// index changes nothing. lavapipe otherwise specializes the kernel for a uniform value that decides
// a branch or ends a loop, and recompiles it whenever another buffer is bound.
uint make_nonuniform(uint number)
{
    return ON_CPU ? number | gl_LocalInvocationIndex & 0x80000000u : number;
}

float make_nonuniform(float number)
{
    return uintBitsToFloat(make_nonuniform(floatBitsToUint(number)));
}

bool make_nonuniform(bool answer) { return make_nonuniform(uint(answer)) != 0u; }

vec3 make_nonuniform(vec3 v)
{
    uvec3 bits = floatBitsToUint(v);
    return uintBitsToFloat(
        uvec3(make_nonuniform(bits.x), make_nonuniform(bits.y), make_nonuniform(bits.z)));
}

// A uniform read costs lavapipe some 24 instructions, because it gathers the value per lane. Values
// that every step needs are read once per thread. On a GPU a uniform read is free.
const bool READS_FRAME_ONCE = ON_CPU;

// On lavapipe solids are also read once per thread and intersected without branches
// (known_solids.glsl). On a GPU they would exhaust the registers.
const bool READS_SOLIDS_ONCE = ON_CPU;

// lavapipe executes both sides of a branch on a uniform, and the body of a loop that no thread
// enters. Its kernels are specialized and have no such branches. A GPU uses one kernel for all
// frames of a sequence and branches on the uniform.
const bool BRANCHES_ON_FRAME = !ON_CPU;

// lavapipe executes a path for all eight lanes when one lane needs it, so the rays of a subgroup do
// the same steps together. A GPU instead hides the latency of samples by having several in flight.
const bool STEPS_TOGETHER = ON_CPU;

// Each operation on a denormal (below 2^-126) costs a CPU the time of a hundred instructions, so
// small values are set to 0.
const bool DROPS_SMALL_NUMBERS = ON_CPU;

#endif
