// SPDX-License-Identifier: MIT
//
// The forms that a kernel has on a CPU (lavapipe) and on a GPU, for march and tracer. Only this
// file reads for which of them a kernel is: others read the constants here, which say what a form
// does and why, or have the other form in a file of its own (march_texture_cpu.glsl). Both forms
// give the same frame, to the rounding of sums. Passes of the real-time renderer have variants
// (renderer/realtime/passes.h).
#ifndef NEPH_DEVICE_FORMS_GLSL
#define NEPH_DEVICE_FORMS_GLSL

const bool ON_CPU = (TRAITS & NEPH_GPU_ON_CPU) != 0u;

// A number of the frame that alone decides a branch or ends a loop. lavapipe would compile the
// kernel anew for its value whenever another buffer is bound; a number of the thread's own, which
// this is by an index that has no such bit, it leaves alone.
uint own(uint number)
{
    return ON_CPU ? number | gl_LocalInvocationIndex & 0x80000000u : number;
}

bool own(bool answer) { return own(uint(answer)) != 0u; }

vec3 own(vec3 v)
{
    uvec3 bits = floatBitsToUint(v);
    return uintBitsToFloat(uvec3(own(bits.x), own(bits.y), own(bits.z)));
}

// A number of the frame costs lavapipe some 24 instructions, for it is gathered for each lane: what
// every step reads is read once for a thread. To a GPU it costs nothing.
const bool READS_FRAME_ONCE = ON_CPU;

// Few solids are read once, too, and are met without branches (known_solids.glsl). They would fill
// the registers of a GPU.
const bool READS_SOLIDS_ONCE = ON_CPU;

// lavapipe would run both sides of a branch on a number of the frame, and the body of a loop that
// no thread enters: what is not needed is not in its kernels. A GPU has one kernel for all frames
// of a sequence, and decides in it.
const bool BRANCHES_ON_FRAME = !ON_CPU;

// lavapipe goes through what one of its eight lanes needs with all of them: rays of a subgroup do
// the same steps together. A GPU waits for a sample: it has several on their way.
const bool STEPS_TOGETHER = ON_CPU;

// Numbers below 2^-126 each cost a CPU the time of a hundred instructions: small ones become 0.
const bool DROPS_SMALL_NUMBERS = ON_CPU;

#endif
