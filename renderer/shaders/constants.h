// SPDX-License-Identifier: MIT
//
// Numbers that shaders and C have in common: this file is both GLSL and C.
#ifndef NEPH_GPU_CONSTANTS_H
#define NEPH_GPU_CONSTANTS_H

// "Infinitely far" [m]. Finite, because inf - inf and 0 * inf are NaN and shaders need not even
// honour inf; its square still fits a float32.
#define NEPH_GPU_FAR_M 1e15f

// Room in a frame.
#define NEPH_GPU_MEDIA_MAX 8
#define NEPH_GPU_LAYERS_MAX 2 // of a fog
#define NEPH_GPU_LAMPS_MAX 16
#define NEPH_GPU_LAMP_PARTS 8 // of a step, at most (march_lamps.glsl)

// Where kernels that sample images find them, an array of one for each medium.
#define NEPH_GPU_IMAGES_BINDING 31
// And where kernels of a CPU find texels of one, two and four words (neph_buffer_see_texels()): an
// array each, of one texel buffer for each buffer that is seen as such.
#define NEPH_GPU_TEXELS_BINDING 28
#define NEPH_GPU_TEXEL_PAIRS_BINDING 29
#define NEPH_GPU_TEXEL_FOURS_BINDING 30
#define NEPH_GPU_TEXEL_FORMATS 3

// Bits of specialization constant 1, what is known of a scene beside its kinds of media.
#define NEPH_GPU_COLOURED 1u // some medium's extinction depends on the channel
#define NEPH_GPU_ORTHOGRAPHIC 2u // the camera is orthographic
#define NEPH_GPU_ON_CPU 4u // the device is a CPU
#define NEPH_GPU_TURNED 8u // some box has turned
#define NEPH_GPU_LAMPS 16u // there are lights beside the sun
#define NEPH_GPU_SHADED 32u // some solid may stand between a medium and the sun
#define NEPH_GPU_ENDLESS 64u // some voxel grid has no end along some axis
#define NEPH_GPU_PAIRS 128u // values of grids are there in pairs, too
// Behind these, where there are no more than so many media: how many, and from KINDS_SHIFT on four
// bits for each, the kind and above it 1 for two layers. Else 0, and the frame says.
#define NEPH_GPU_KNOWN_MEDIA_MAX 4
#define NEPH_GPU_MEDIA_SHIFT 8u
#define NEPH_GPU_KINDS_SHIFT 16u

// Steps of a view ray that are one behind an optical depth, at most.
#define NEPH_GPU_SPAN_MAX 16

// Solids, and those of a block, which has a box around all of them.
#define NEPH_GPU_SOLIDS_MAX 1024
#define NEPH_GPU_BLOCK_SOLIDS 8
#define NEPH_GPU_BLOCKS_MAX (NEPH_GPU_SOLIDS_MAX / NEPH_GPU_BLOCK_SOLIDS)

// Texels along each side of the textures of Horizon clouds.
#define NEPH_GPU_HORIZON_BASE_SIDE 64
#define NEPH_GPU_HORIZON_DETAIL_SIDE 32
#define NEPH_GPU_HORIZON_WEATHER_SIDE 256

// The path tracer: strata of a pixel's samples, edges of a table of light (tracer_lit.glsl).
#define NEPH_GPU_STRATA 4
#define NEPH_GPU_TAKES 8 // of items, in a turn of a thread
#define NEPH_GPU_LIT_EDGES 16

// Octaves of scattering whose factors are fitted (renderer/octaves_fitted.h).
#define NEPH_GPU_FITTED_OCTAVES 8

// The first octaves of an only medium, whose phase functions a march keeps for a ray.
#define NEPH_GPU_KEPT_PHASES 8

// Diffused light: of fluence, what leaves where nothing comes in. Marshak has 0.5, Milne 0.469 of a
// half-space; this is best over the tuning suite of `neph study light`.
#define NEPH_GPU_OUTWARD 0.4

// The table of slab light (renderer/slab_light.h): optical depths along both axes are
// (2^(OCTAVES i / (NODES - 1)) - 1) / PER_DEPTH.
#define NEPH_GPU_SLAB_NODES 20
#define NEPH_GPU_SLAB_OCTAVES 10.0
#define NEPH_GPU_SLAB_PER_DEPTH 8.0

// Bits of what halves.comp is asked: whether the driver reads halves as they are, and writes the
// nearest, of two the even one.
#define NEPH_HALVES_READ 1u
#define NEPH_HALVES_WRITTEN 2u

// The sky: the highest degree of its moments, and how many there are up to it.
#define NEPH_GPU_SKY_DEGREE_MAX 8
#define NEPH_GPU_SKY_MOMENTS_MAX 45
#define NEPH_GPU_SKY_PLACES 2 // with a table of views
#define NEPH_GPU_SKY_SUN_SAMPLES 4 // of a froxel of air
#define NEPH_GPU_SKY_WALKERS 8 // threads that share a ray of a table of views
#define NEPH_GPU_SKY_SLICES_AT_ONCE 32 // of a column of air, a thread each

// Maps of the shadow of clouds, one within the other (cloud_shadow.glsl).
#define NEPH_GPU_SHADOW_LEVELS_MAX 4
#define NEPH_GPU_SHADOW_SAMPLES 16 // by which a texel's ray finds where clouds begin and end

// Cells that a ray goes through in a voxel grid without end, at most: what is farther is not seen.
#define NEPH_GPU_ENDLESS_CELLS 4096

// Stretches of a view ray's way through a voxel grid (tracer_way.glsl).
#define NEPH_GPU_WAY_STRETCHES 32

#endif
