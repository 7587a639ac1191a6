// SPDX-License-Identifier: MIT
//
// Names that the shaders of the real-time renderer, their CPU references and the table of options
// share: this file is both GLSL and C.
#ifndef NEPH_REALTIME_NAMES_H
#define NEPH_REALTIME_NAMES_H

// The settings of the files settings.toml by their index in the table of options, then the values
// that the pipeline selects for a view, and the words of choices (renderer/settings.py).
#include "settings/realtime_names.h"

// Specialization constants of the shaders, after those of the march:
//   UNCOUNTED    passes with rays do not count (rays.glsl)
//   SPECIALISED  choices are constants (choices.glsl)
//   SOLIDS       number of solids of the scene, or RT_SOLIDS_UNKNOWN (known_solids.glsl)
//   HALVES       the driver's conversions of halves that are used (renderer/halves.h)
//   GPU_ACCESS   the form of shared/device.glsl
//   STATIC_PARTS the static parts of the frame
//   BALLS        which of few solids are spheres, in two constants
//   DARK         rays compute only transmittance (realtime/ray_march/ray_march.comp)
//   ROLE         which of the passes with this shader runs, RT_ROLE_*
//   CHOICE       the first constant with choices
#define RT_UNCOUNTED_CONSTANT 6
#define RT_SPECIALISED_CONSTANT 7
#define RT_SOLIDS_CONSTANT 8
#define RT_SOLIDS_UNKNOWN 65 // this many and more: tested block by block
#define RT_HALVES_CONSTANT 9
#define RT_GPU_ACCESS_CONSTANT 10
#define RT_STATIC_CONSTANT 11
#define RT_STATIC_VIEW 1u // camera, air and solids
#define RT_STATIC_MEDIUM 2u
#define RT_BALLS_CONSTANT 12 // and 13
#define RT_DARK_CONSTANT 14
#define RT_ROLE_CONSTANT 15
#define RT_ROLE_ORDINARY 0
#define RT_ROLE_ORACLE 1 // of the upscale; of the march: texels
#define RT_ROLE_PIXELS 2
#define RT_CHOICE_CONSTANT 16
#define RT_CONSTANT_COUNT (RT_CHOICE_CONSTANT + RT_CHOICE_CONSTANT_COUNT)
// Pixels of a column that a thread of the anti-aliasing processes, a multiple of a tile's side:
// each row that it reads serves three of them.
#define RT_TAA_COLUMN 16
// Block of pixels of a work group of 64 in the anti-aliasing on a GPU; a thread has 4 rows.
#define RT_TAA_BLOCK_WIDTH 32
#define RT_TAA_BLOCK_HEIGHT 8

// Tiles along the side of the block that a work group of 64 marches.
#define RT_MARCH_BLOCK 8

// Block of texels of a work group of 64 in the reconstruction on a GPU.
#define RT_TEXEL_BLOCK_WIDTH 16
#define RT_TEXEL_BLOCK_HEIGHT 4

// Side of the block of texels of a work group of 64 on a GPU in a pass that runs in four phases.
#define RT_COLOUR_BLOCK 8

// --- formats: the words of 32 bits that an element of a target takes --------------------------

#define RT_R16F 0    // 1 word, the upper half unused
#define RT_R32F 1    // 1 word
#define RT_RG16F 2   // 1 word: R in the lower half
#define RT_RG32F 3   // 2 words
#define RT_RGBA16F 4 // 2 words: R and G, B and A, the first of each in the lower half
#define RT_RGBA32F 5 // 4 words
#define RT_FORMAT_COUNT 6

// --- targets: the images that passes hand to each other ---------------------------------------
//
// Sorted by the number of words of an element. A CPU reads targets as texels through three arrays,
// which are only as long as needed (device.glsl): elements of one word only in the first
// RT_WORD_TARGET_COUNT targets, elements of two only in the first RT_PAIR_TARGET_COUNT.

// One word.
#define RT_DEPTH 0 // full; R: eye depth of the scene [m], FAR_M for the sky; of the jittered rays
// Full; the depth at the start of the split frame: RT_DEPTH without jitter, unless jittered_depth
// is on.
#define RT_STEADY_DEPTH 1
#define RT_HALF_DEPTH 2        // half, rounded up; R: eye depth [m] chosen from 2x2 pixels
#define RT_HALF_DEPTH_BEFORE 3 // RT_HALF_DEPTH of the frame before
// Half; R: number of rays in the history, 0 where it is invalid; G: cloud distance [m]
#define RT_HISTORY_STATE 4
#define RT_HISTORY_STATE_BEFORE 5
#define RT_TILE 6 // quarter, rounded up; R: slot 0..3 of the tile's ray, G: its depth / 10000 m
#define RT_RAY_DISTANCE 7    // quarter; R: distance along the ray of the medium's light [m]
#define RT_VOLUME_DISTANCE 8 // full; R: the same after the upscale [m]
#define RT_WORD_TARGET_COUNT 9
// Two words.
#define RT_HISTORY 9 // half; RGBA: in-scattered radiance, transmittance; of the reconstruction
#define RT_HISTORY_BEFORE 10
#define RT_RAY 11    // quarter; RGBA: in-scattered radiance, transmittance of this frame's ray
#define RT_VOLUME 12 // full; RGBA: in-scattered radiance, transmittance after the upscale
// Full; RGB: after TAA; the history of the next frame. A: its age, with taa_age_max
#define RT_TAA_OUT 13
#define RT_TAA_BEFORE 14
// Four words.
#define RT_BEHIND 15    // full; RGB: radiance behind all media, of the same rays
#define RT_COLOR 16     // full; RGB: the composed frame
#define RT_SHARPENED 17 // full; RGB: the frame after sharpening
// Full; with moving solids. RGB: displacement of the point that a pixel's ray meets since the frame
// before [m]. A: 1 where it belongs to a solid that may move
#define RT_MOVED 18
// Froxels (froxels.glsl). RGB: scattered light per metre, A: extinction [1/m]; for the sums
// in-scattered radiance and transmittance
#define RT_FROXELS 19
#define RT_RAY_TARGET_COUNT 20 // passes with rays bind only those before, for room for a scene
// Two words. The earlier samples of rays that are marched twice (gradient/gradient.comp).
#define RT_KEPT_RAY 20    // half; RGB: radiance of the medium, A: transmittance
#define RT_KEPT_BEHIND 21 // full; RGB: radiance behind all media
#define RT_PAIR_TARGET_COUNT 22
// Four words. Quarter; the two samples of a tile's gradient. RGB: the medium's radiance along the
// tile's ray; A: a change that light does not explain.
#define RT_SAMPLE_NOW 22
#define RT_SAMPLE_THEN 23        // RGB: the earlier sample; A: 1 where there is one, else 0
#define RT_SAMPLE_BEHIND_NOW 24  // the same behind the media, as sums over the sampled pixels
#define RT_SAMPLE_BEHIND_THEN 25 // A: the number of sampled pixels
// Quarter; the change around a tile (gradient/change.comp). RGB: light of this frame over light of
// the frame before; A: the change that this ratio does not explain.
#define RT_CHANGE 26        // of the medium
#define RT_CHANGE_BEHIND 27 // behind all media
// With taa=locks. R: remaining strength of a lock, 0 .. 1; G: four times the luma at its creation;
// B: the nearest eye depth of 3x3 rendered pixels [m].
#define RT_TAA_STATE 28
#define RT_TAA_STATE_BEFORE 29
#define RT_TARGET_COUNT 30

// Groups of solids that move together.
#define RT_MOVERS_MAX 16

// Side of a texel of each resolution, in pixels.
#define RT_FULL 1
#define RT_HALF 2
#define RT_QUARTER 4
// The width of a froxel target is the number of froxel columns; its height is three times rows
// times slices. A pass has a thread for each froxel, or for each column.
#define RT_FROXEL 5
#define RT_FROXEL_COLUMN 6
#define RT_FROXEL_SECTIONS 3
// Output resolution: as many pixels as RT_FULL, or more with screen_percent.
#define RT_OUTPUT 7

// The table of targets, rows for a C array or a GLSL one: resolution, format with
// target_format=half, format with target_format=float.
#define RT_TARGETS                                                                                 \
    {RT_FULL, RT_R32F, RT_R32F},              /* RT_DEPTH */                                       \
        {RT_FULL, RT_R32F, RT_R32F},          /* RT_STEADY_DEPTH */                                \
        {RT_HALF, RT_R32F, RT_R32F},          /* RT_HALF_DEPTH */                                  \
        {RT_HALF, RT_R32F, RT_R32F},          /* RT_HALF_DEPTH_BEFORE */                           \
        {RT_HALF, RT_RG16F, RT_RG32F},        /* RT_HISTORY_STATE */                               \
        {RT_HALF, RT_RG16F, RT_RG32F},        /* RT_HISTORY_STATE_BEFORE */                        \
        {RT_QUARTER, RT_RG16F, RT_RG32F},     /* RT_TILE */                                        \
        {RT_QUARTER, RT_R16F, RT_R32F},       /* RT_RAY_DISTANCE */                                \
        {RT_FULL, RT_R16F, RT_R32F},          /* RT_VOLUME_DISTANCE */                             \
        {RT_HALF, RT_RGBA16F, RT_RGBA32F},    /* RT_HISTORY */                                     \
        {RT_HALF, RT_RGBA16F, RT_RGBA32F},    /* RT_HISTORY_BEFORE */                              \
        {RT_QUARTER, RT_RGBA16F, RT_RGBA32F}, /* RT_RAY */                                         \
        {RT_FULL, RT_RGBA16F, RT_RGBA32F},    /* RT_VOLUME */                                      \
        {RT_OUTPUT, RT_RGBA16F, RT_RGBA32F},  /* RT_TAA_OUT */                                     \
        {RT_OUTPUT, RT_RGBA16F, RT_RGBA32F},  /* RT_TAA_BEFORE */                                  \
        {RT_FULL, RT_RGBA32F, RT_RGBA32F},    /* RT_BEHIND */                                      \
        {RT_FULL, RT_RGBA32F, RT_RGBA32F},    /* RT_COLOR */                                       \
        {RT_OUTPUT, RT_RGBA32F, RT_RGBA32F},  /* RT_SHARPENED */                                   \
        {RT_FULL, RT_RGBA32F, RT_RGBA32F},    /* RT_MOVED */                                       \
        {RT_FROXEL, RT_RGBA32F, RT_RGBA32F},  /* RT_FROXELS */                                     \
        {RT_HALF, RT_RGBA16F, RT_RGBA16F},    /* RT_KEPT_RAY */                                    \
        {RT_FULL, RT_RGBA16F, RT_RGBA16F},    /* RT_KEPT_BEHIND */                                 \
        {RT_QUARTER, RT_RGBA32F, RT_RGBA32F}, /* RT_SAMPLE_NOW */                                  \
        {RT_QUARTER, RT_RGBA32F, RT_RGBA32F}, /* RT_SAMPLE_THEN */                                 \
        {RT_QUARTER, RT_RGBA32F, RT_RGBA32F}, /* RT_SAMPLE_BEHIND_NOW */                           \
        {RT_QUARTER, RT_RGBA32F, RT_RGBA32F}, /* RT_SAMPLE_BEHIND_THEN */                          \
        {RT_QUARTER, RT_RGBA32F, RT_RGBA32F}, /* RT_CHANGE */                                      \
        {RT_QUARTER, RT_RGBA32F, RT_RGBA32F}, /* RT_CHANGE_BEHIND */                               \
        {RT_OUTPUT, RT_RGBA32F, RT_RGBA32F},  /* RT_TAA_STATE */                                   \
        {RT_OUTPUT, RT_RGBA32F, RT_RGBA32F},  /* RT_TAA_STATE_BEFORE */

#endif
