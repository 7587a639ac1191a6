// SPDX-License-Identifier: MIT
//
// Constants that shaders and C share. This file is valid GLSL and valid C.
#ifndef NEPH_GPU_CONSTANTS_H
#define NEPH_GPU_CONSTANTS_H

// "Infinite" distance [m]. It is finite because inf - inf and 0 * inf are NaN, and because a GLSL
// implementation need not support infinities. Its square still fits into a float32.
#define NEPH_GPU_FAR_M 1e15f

// Capacities of the uniform block of a frame.
#define NEPH_GPU_MEDIA_MAX 8
#define NEPH_GPU_LAYERS_MAX 2 // layers of a fog medium
#define NEPH_GPU_LAMPS_MAX 16
#define NEPH_GPU_LAMP_PARTS 8 // sub-steps of a march step for one light, at most (march_lamps.glsl)

// Binding of sampled images: an array with one element per medium.
#define NEPH_GPU_IMAGES_BINDING 31
// Bindings of texel buffers for kernels on a CPU device, with texels of one, two and four words
// (neph_buffer_create_texel_views()). Each binding is an array with one element per buffer.
#define NEPH_GPU_TEXELS_BINDING 28
#define NEPH_GPU_TEXEL_PAIRS_BINDING 29
#define NEPH_GPU_TEXEL_FOURS_BINDING 30
#define NEPH_GPU_TEXEL_FORMATS 3

// Bits of specialization constant 0: one for each kind of media in the scene, and further ones.
#define NEPH_GPU_KINDS_MASK 255u
#define NEPH_GPU_MESHES 256u   // the scene has triangle meshes
#define NEPH_GPU_SUN_GRID 512u // the scene has a grid across the sun
// Looks of its meshes (mesh_looks.glsl).
#define NEPH_GPU_MESH_SMOOTH 1024u
#define NEPH_GPU_MESH_TEXTURES 2048u
#define NEPH_GPU_MESH_CUTOUTS 4096u
#define NEPH_GPU_MESH_COVERAGE 8192u
#define NEPH_GPU_MESHES_MOVE 16384u // instances that move are in a tree of their own, in front
// Alpha of a mesh: enum neph_alpha.
#define NEPH_GPU_ALPHA_CUTOUT 1u
#define NEPH_GPU_ALPHA_COVERAGE 2u

// Bits of specialization constant 1: properties of a scene, beside its kinds of media, for which
// kernels are specialized.
#define NEPH_GPU_COLOURED 1u     // extinction or phase function depends on the channel
#define NEPH_GPU_ORTHOGRAPHIC 2u // the camera is orthographic
#define NEPH_GPU_ON_CPU 4u       // the device is a CPU
#define NEPH_GPU_TURNED 8u       // a box is rotated
#define NEPH_GPU_LAMPS 16u       // the scene has point or spot lights
#define NEPH_GPU_SHADED 32u      // a solid may shadow a medium
#define NEPH_GPU_ENDLESS 64u     // a voxel grid repeats without end along an axis
#define NEPH_GPU_PAIRS 128u      // grid values are stored in pairs, too
// The upper bits of the same constant describe the media, when there are at most KNOWN_MEDIA_MAX:
// their number from bit MEDIA_SHIFT on, and from bit KINDS_SHIFT on four bits per medium, which are
// its kind and, in the highest bit, whether the fog has two layers. With more media these bits are
// 0, and the kernel reads the media from the frame.
#define NEPH_GPU_KNOWN_MEDIA_MAX 4
#define NEPH_GPU_MEDIA_SHIFT 8u
// Four more between these:
#define NEPH_GPU_CONSTANT_CELLS 4096u // voxel grids are constant in their cells
#define NEPH_GPU_OWN_RAYS 8192u       // the tracer's view rays are in a buffer
#define NEPH_GPU_PHASE_TABLES 16384u  // a phase function is a table
#define NEPH_GPU_TURNED_MEDIA 32768u  // bounds of a medium are rotated
#define NEPH_GPU_KINDS_SHIFT 16u

// Consecutive steps of a view ray that share one optical depth, at most.
#define NEPH_GPU_SPAN_MAX 16

// Solids per scene, and solids per block. A block has a common bounding box.
#define NEPH_GPU_SOLIDS_MAX 1024
#define NEPH_GPU_SOLID_TURNED 2u // first kind of rotated boxes (solids.glsl)
#define NEPH_GPU_LEAF_SOLIDS 8
#define NEPH_GPU_NODE_MARGIN 4e-6f // of coordinates, some 60 roundings of float32
#define NEPH_GPU_SOLID_NODES_MAX (2 * NEPH_GPU_SOLIDS_MAX / NEPH_GPU_LEAF_SOLIDS + 4)

// The list of solids of a cell of the sun's grid: two bits for their count, up to 3, and for each
// one the bits of its number; or the word for more than three.
#define NEPH_GPU_LISTED_BITS 10
#define NEPH_GPU_MANY_LISTED 0xffffffffu // never a list: a solid is in it once

// Texels along each side of the textures of Horizon clouds.
#define NEPH_GPU_HORIZON_BASE_SIDE 64
#define NEPH_GPU_HORIZON_DETAIL_SIDE 32
#define NEPH_GPU_HORIZON_WEATHER_SIDE 256

// The path tracer: strata of a pixel's samples, and edges of a table of light (tracer_lit.glsl).
#define NEPH_GPU_STRATA 4
#define NEPH_GPU_TAKES 8 // items that a thread takes from a queue at once
#define NEPH_GPU_WALKS 24000 // loop iterations in walks through meshes, after which a dispatch ends
#define NEPH_GPU_LIT_EDGES 16

// Octaves of scattering with fitted factors (renderer/octaves_fitted.h).
#define NEPH_GPU_FITTED_OCTAVES 8

// Octaves for which the ray marcher computes phase functions once per ray, in scenes of one medium.
#define NEPH_GPU_KEPT_PHASES 8

// Diffused light: the flux through an open face over the fluence in front of it, a boundary
// condition of diffusion. Marshak's is 0.5, Milne's for a half-space 0.469. This value is the best
// over the tuning suite of `neph study light`.
#define NEPH_GPU_OUTWARD 0.4

// The table of slab light (renderer/slab_light.h). Node i of either axis has the optical depth
// (2^(OCTAVES i / (NODES - 1)) - 1) / PER_DEPTH.
#define NEPH_GPU_SLAB_NODES 20
#define NEPH_GPU_SLAB_OCTAVES 10.0
#define NEPH_GPU_SLAB_PER_DEPTH 8.0

// Result bits of halves.comp: the driver's conversion from half to float is wrong; its conversion
// from float to half is wrong (expected: round to nearest, ties to even).
#define NEPH_HALVES_READ 1u
#define NEPH_HALVES_WRITTEN 2u

// The sky: highest degree of its spherical-harmonic moments, and number of moments up to that
// degree.
#define NEPH_GPU_SKY_DEGREE_MAX 8
#define NEPH_GPU_SKY_MOMENTS_MAX 45
#define NEPH_GPU_SKY_PLACES 2          // positions that have a table of views
#define NEPH_GPU_SKY_SUN_SAMPLES 4     // samples of the sunlight in a froxel of air
#define NEPH_GPU_SKY_WALKERS 8         // threads that share a ray of a table of views
#define NEPH_GPU_SKY_SLICES_AT_ONCE 32 // slices of a column of air in parallel, one per thread

// Nested levels of the shadow map of clouds (cloud_shadow.glsl).
#define NEPH_GPU_SHADOW_LEVELS_MAX 4
#define NEPH_GPU_SHADOW_SAMPLES 16 // by which the clouds on a texel's ray are found

// Cells of an endless voxel grid that a ray crosses at most. The grid is cut off beyond them.
#define NEPH_GPU_ENDLESS_CELLS 4096

// Segments of a view ray's way through a voxel grid (tracer_way.glsl).
#define NEPH_GPU_WAY_STRETCHES 32

#endif
