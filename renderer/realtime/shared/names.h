// SPDX-License-Identifier: MIT
//
// Names that the shaders of the real-time renderer, their twins in C and its table of options have
// in common: this file is both GLSL and C. What a setting means is said once, in
// renderer/realtime/options.c; `neph engines realtime` prints it.
#ifndef NEPH_REALTIME_NAMES_H
#define NEPH_REALTIME_NAMES_H

// --- settings: index in the table of options --------------------------------------------------

// The march.
#define RT_STEPS 0
#define RT_SUN_STEPS 1
#define RT_TRANSMITTANCE 2
#define RT_SUN 3
#define RT_LIGHTING 4
// The split of the frame.
#define RT_SPLIT 5
#define RT_DEPTH_MAP 6
#define RT_SLOT_ORDER 7
#define RT_SLOT_CHECKERBOARD 8
#define RT_OVERRIDE 9
#define RT_OVERRIDE_REST 10
#define RT_FAR 11
#define RT_SKY_M 12
#define RT_RAY_DEPTH_MAX_M 13
#define RT_CLAMP_PIXEL_DEPTH 14
#define RT_TARGET_FORMAT 15
#define RT_EDGE_TILES 16
#define RT_GATHER 17
#define RT_TILE_ORIGIN 18
#define RT_JITTERED_DEPTH 19
#define RT_RAY_DITHER 20
#define RT_RAY_DITHER_AMOUNT 21
// Reconstruction at half resolution: what a texel takes.
#define RT_FRESH_WEIGHT 22
#define RT_FRESH_SPACE 23
#define RT_HISTORY_WEIGHT 24
#define RT_HISTORY_AGE_MAX 25
#define RT_HISTORY_FADE 26
#define RT_FALLBACK 27
#define RT_FALLBACK_REJECTED 28
// The box that its history is held in.
#define RT_BOX 29
#define RT_BOX_DEPTH 30
#define RT_BOX_TRANSMITTANCE 31
#define RT_CONTRAST 32
#define RT_BOX_SAME_KIND 33
#define RT_BOX_SPACE 34
#define RT_BOX_HOLD 35
#define RT_BOX_AGE 36
#define RT_BOX_CENTRE 37
#define RT_BOX_MOTION_PX 38
#define RT_BOX_CHANGE 39
// Where its history was, and whether it is one.
#define RT_REPROJECT_DEPTH 40
#define RT_REPROJECT_MEASURE 41
#define RT_REPROJECT_JITTER 42
#define RT_WIND 43
#define RT_VALIDITY 44
#define RT_CUT_RESET 45
#define RT_REJECT_DEPTH 46
#define RT_REJECT_AROUND 47
// Upscale to full resolution.
#define RT_UPSCALE 48
#define RT_UPSCALE_DEPTH 49
#define RT_UPSCALE_CONTRAST 50
#define RT_UPSCALE_TOLERANCE_M 51
#define RT_UPSCALE_SAME_KIND 52
#define RT_UPSCALE_DITHER 53
#define RT_UPSCALE_AMOUNT_PX 54
#define RT_UPSCALE_LAW 55
#define RT_UPSCALE_PAIR 56
// Temporal anti-aliasing.
#define RT_TAA 57
#define RT_TAA_JITTER 58
#define RT_TAA_JITTER_LENGTH 59
#define RT_TAA_MOTION 60
#define RT_TAA_SPACE 61
#define RT_TAA_HDR_WEIGHT 62
#define RT_TAA_FILTER 63
#define RT_TAA_BOX 64
#define RT_TAA_SIGMA 65
#define RT_TAA_HISTORY 66
#define RT_TAA_ALPHA 67
#define RT_TAA_CONTRAST 68
#define RT_TAA_ROUNDING 69
#define RT_TAA_GUARD 70
// The sequence; no shader asks for it.
#define RT_WARM_UP 71
// Sharpening.
#define RT_SHARPEN 72
// Shortcuts of the march.
#define RT_SUN_CACHE 73
#define RT_SUN_CACHE_VOXELS 74
#define RT_SUN_CACHE_FRAMES 75
#define RT_SKIP 76
#define RT_EARLY_OUT 77
#define RT_STEP_GROWTH 78
#define RT_GRID_SAMPLING 79
#define RT_GRID_FORMAT 80
// Traced light.
#define RT_LIGHT_PATHS 81
// What has changed since the same ray was marched before.
#define RT_GRADIENT 82
// Anti-aliasing that follows the medium, and that comes to rest.
#define RT_TAA_MEDIUM 83
#define RT_TAA_AGE_MAX 84
#define RT_TAA_CHANGE 85
// Diffused light.
#define RT_DIFFUSION_CELLS 86
// What moves beside the camera and the air.
#define RT_SOLID_MOTION 87
#define RT_ORIGIN_SHIFT 88
// Traced light, once more.
#define RT_LIGHT_AHEAD 89
#define RT_LIGHT_SIMILAR 90
// The shadow map of clouds.
#define RT_CLOUD_SHADOW 91
#define RT_CLOUD_SHADOW_TEXELS 92
#define RT_CLOUD_SHADOW_LAYERS 93
#define RT_CLOUD_SHADOW_LEVELS 94
#define RT_CLOUD_SHADOW_EXTENT_M 95
#define RT_CLOUD_SHADOW_PLANE 96
// What is made of changes of the light.
#define RT_RELIGHT 97
#define RT_CHANGE_HOLD 98
// Near froxels.
#define RT_FROXEL_VOLUME 99
#define RT_FROXEL_PX 100
#define RT_FROXEL_SLICES 101
#define RT_FROXEL_NEAR_M 102
#define RT_FROXEL_END_M 103
#define RT_FROXEL_JITTER 104
#define RT_FROXEL_HISTORY 105
#define RT_FROXEL_HOLD 106
// A picture of more pixels than are rendered.
#define RT_SCREEN_PERCENT 107
// Anti-aliasing of what moves by itself, of what has no motion vectors, and of exposed colours.
#define RT_TAA_RESPONSIVE 108
#define RT_TAA_PRE_EXPOSURE 109
// Where froxels are too coarse.
#define RT_LAMP_PEAKS 110
// The sky of a planet.
#define RT_SKY 111
#define RT_SKY_COLUMNS 112
#define RT_SKY_ROWS 113
#define RT_SKY_SLICES 114
#define RT_SKY_FAR_M 115
#define RT_SKY_SHADOWS 116
// The filter of the volume in steps (atrous/atrous.glsl).
#define RT_ATROUS 117
#define RT_SKY_REFILL 118
// What two looks at the same light cannot tell.
#define RT_CHANGE_STROBE 119
// How long slots that no ray is left for are marched after the sun has jumped.
#define RT_OVERRIDE_WAKE 120
// Steps towards the sun.
#define RT_SUN_GROWTH 121
#define RT_SUN_CONE 122
// The height fog as game engines draw it.
#define RT_FOG 123
// Steps behind an optical depth.
#define RT_DEPTH_GROWTH 124
#define RT_SETTING_COUNT 125

// What the pipeline chooses for a view, behind its settings: which pass lays the volume over what is
// behind it, makes the depth map, and finds what has changed around a tile; whether the gradient is
// known to see nothing. Tests choose, too. Same bits.
#define RT_COMPOSITION 125
#define RT_DEPTH_MAP_PASS 126
#define RT_CHANGE_PASS 127
#define RT_STEADY 128
#define RT_NUMBER_COUNT 129

// Specialization constants of the shaders, behind those of the march: whether passes with rays
// leave their counters alone (rays.glsl); whether the shaders hold the choices, and the
// first that does (choices.glsl); how many solids the scene has, or that there are many,
// and which of few are balls (known_solids.glsl); which of the driver's own conversions of halves
// are taken (renderer/halves.h); which form of shared/device.glsl; what stands where it stood; whether
// rays see transmittance alone (realtime/ray_march/ray_march.comp).
#define RT_UNCOUNTED_CONSTANT 6
#define RT_SPECIALISED_CONSTANT 7
#define RT_CHOICE_CONSTANT 8
#define RT_CHOICE_CONSTANT_COUNT 20
#define RT_SOLIDS_CONSTANT 28
#define RT_SOLIDS_UNKNOWN 65 // and from there on: looked at block by block
#define RT_HALVES_CONSTANT 29
#define RT_GPU_ACCESS_CONSTANT 30
#define RT_RESTS_CONSTANT 31
#define RT_RESTS_ALL 1u // camera, air and solids
#define RT_RESTS_AIR 2u
#define RT_BALLS_CONSTANT 32 // and the next
#define RT_DARK_CONSTANT 34
#define RT_CONSTANT_COUNT 35

// Pixels below each other that a thread of the anti-aliasing takes, whole tiles: each row that it
// reads serves three of them.
#define RT_TAA_COLUMN 16
// Pixels of the block that a work group of 64 takes through it on a GPU, a tile's rows a thread.
#define RT_TAA_BLOCK_WIDTH 32
#define RT_TAA_BLOCK_HEIGHT 8

// Tiles along the side of the block that a work group of 64 marches.
#define RT_MARCH_BLOCK 8

// Texels of the block that a work group of 64 takes through the reconstruction on a GPU.
#define RT_TEXEL_BLOCK_WIDTH 16
#define RT_TEXEL_BLOCK_HEIGHT 4

// Texels along the side of the block that a work group of 64 takes on a GPU through a pass whose
// colours take turns.
#define RT_COLOUR_BLOCK 8

// --- choices ----------------------------------------------------------------------------------

#define RT_SPLIT_NONE 0 // every pixel, every frame
#define RT_SPLIT_FOUR 1 // one ray per 4x4 pixels, four frames for a whole

#define RT_DEPTH_MAP_CHECKERBOARD 0
#define RT_DEPTH_MAP_NEAREST 1
#define RT_DEPTH_MAP_FARTHEST 2
#define RT_DEPTH_MAP_REVERSED 3

#define RT_SLOT_ORDER_CLOCKWISE 0     // (0,0) (1,0) (1,1) (0,1)
#define RT_SLOT_ORDER_RASTER 1        // (0,0) (1,0) (0,1) (1,1)
#define RT_SLOT_ORDER_DIAGONAL 2      // (0,0) (1,1) (1,0) (0,1)
#define RT_SLOT_ORDER_ANTICLOCKWISE 3 // (0,0) (0,1) (1,1) (1,0)

#define RT_OVERRIDE_NONE 0
#define RT_OVERRIDE_PARALLEL 1
#define RT_OVERRIDE_SEQUENTIAL 2

#define RT_FAR_FINITE 0
#define RT_FAR_INFINITE 1

#define RT_FORMAT_HALF 0
#define RT_FORMAT_FLOAT 1

#define RT_EDGE_TILES_KEPT 0
#define RT_EDGE_TILES_DROPPED 1

#define RT_GATHER_TEXEL 0
#define RT_GATHER_NORMALISED 1

#define RT_TILE_ORIGIN_VIEW 0
#define RT_TILE_ORIGIN_BUFFER 1

// dither.glsl
#define RT_DITHER_NONE 0
#define RT_DITHER_WHITE 1
#define RT_DITHER_INTERLEAVED 2
#define RT_DITHER_BLUE 3 // from here on a mask is read
#define RT_DITHER_SPATIOTEMPORAL 4
#define RT_DITHER_SLICE 5

#define RT_FILTER_NEAREST 0
#define RT_FILTER_BILINEAR 1
#define RT_FILTER_CATMULL_ROM 2

#define RT_BOX_NONE 0
#define RT_BOX_MIN_MAX 1
#define RT_BOX_VARIANCE 2
#define RT_BOX_DISTANCE 3 // of TAA alone

#define RT_SPACE_LINEAR 0
#define RT_SPACE_REINHARD 1
#define RT_SPACE_YCOCG 2
#define RT_SPACE_CHANNELS 3 // not of TAA, whose Reinhard is that of the channels

#define RT_FALLBACK_NEAREST 0
#define RT_FALLBACK_AROUND 1
#define RT_FALLBACK_TILE 2
#define RT_FALLBACK_BILINEAR 3
#define RT_FALLBACK_BILATERAL 4

#define RT_CONTRAST_TRANSMITTANCE 0
#define RT_CONTRAST_OPACITY 1

#define RT_HOLD_CLAMP 0
#define RT_HOLD_CLIP 1

#define RT_REPROJECT_TILE 0
#define RT_REPROJECT_PIXEL 1

#define RT_MEASURE_EYE 0
#define RT_MEASURE_RADIAL 1

#define RT_UPSCALE_NEAREST 0
#define RT_UPSCALE_BILINEAR 1
#define RT_UPSCALE_MEAN 2
#define RT_UPSCALE_BILATERAL 3
#define RT_UPSCALE_INVERSE 4
#define RT_UPSCALE_SQUARE 5

#define RT_LAW_CONSTANT 0
#define RT_LAW_OPACITY 1

#define RT_PAIR_SHARED 0
#define RT_PAIR_INDEPENDENT 1

#define RT_AROUND_OFF 0
#define RT_AROUND_ON 1
#define RT_AROUND_MOVED 2

#define RT_TAA_OFF 0
#define RT_TAA_ON 1
#define RT_TAA_UPSAMPLING 2
#define RT_TAA_LOCKS 3

#define RT_JITTER_NONE 0
#define RT_JITTER_UE 1
#define RT_JITTER_HALTON 2

#define RT_RESPONSIVE_OFF 0
#define RT_RESPONSIVE_MEDIUM 1

#define RT_MOTION_CENTRE 0
#define RT_MOTION_CROSS 1
#define RT_MOTION_SQUARE 2

#define RT_DEPTH_MAP_PASS_OWN 0
#define RT_DEPTH_MAP_PASS_TILE_INDEX 1

#define RT_CHANGE_PASS_OWN 0
#define RT_CHANGE_PASS_RECONSTRUCTION 1

#define RT_STEADY_ASKED 0  // the gradient looks
#define RT_STEADY_KNOWN 1
#define RT_STEADY_UNREAD 2 // the same, and nobody reads more than the picture

#define RT_COMPOSITION_PASS 0
#define RT_COMPOSITION_TAA 1
#define RT_COMPOSITION_UPSCALE 2

#define RT_ROUNDING_NEAREST 0
#define RT_ROUNDING_STOCHASTIC 1

// --- formats: the words of 32 bits that an element of a target takes --------------------------

#define RT_R16F 0    // 1 word, the upper half unused
#define RT_R32F 1    // 1 word
#define RT_RG16F 2   // 1 word: R in the lower half
#define RT_RG32F 3   // 2 words
#define RT_RGBA16F 4 // 2 words: R and G, B and A, the first of each in the lower half
#define RT_RGBA32F 5 // 4 words
#define RT_FORMAT_COUNT 6

// --- targets: the images that passes hand to each other ---------------------------------------

// Full resolution.
#define RT_DEPTH 0  // R: eye depth of the scene [m], FAR_M for the sky; of the jittered rays
#define RT_BEHIND 1 // RGB: radiance of what is behind all media, of the same rays
// Half resolution, rounded up.
#define RT_HALF_DEPTH 2        // R: eye depth [m] chosen from 2x2 pixels
#define RT_HALF_DEPTH_BEFORE 3 // RT_HALF_DEPTH of the frame before
#define RT_HISTORY 4           // RGBA: in-scattered radiance, transmittance; of the reconstruction
#define RT_HISTORY_BEFORE 5
// R: number of rays that the history is made of, 0 where it is void; G: cloud distance [m]
#define RT_HISTORY_STATE 6
#define RT_HISTORY_STATE_BEFORE 7
// Quarter resolution, rounded up.
#define RT_TILE 8          // R: slot 0..3 of the tile's ray, G: its depth / 10000 m
#define RT_RAY 9           // RGBA: in-scattered radiance, transmittance of this frame's ray
#define RT_RAY_DISTANCE 10 // R: distance along the ray of what the medium shows [m]
// Full resolution again.
#define RT_VOLUME 11          // RGBA: in-scattered radiance, transmittance after the upscale
#define RT_VOLUME_DISTANCE 12 // R: [m]
#define RT_COLOR 13           // RGB: the composed frame
// RGB: after TAA; the history of the next frame. A: its age, with taa_age_max
#define RT_TAA_OUT 14
#define RT_TAA_BEFORE 15
// The depth that the split of the frame starts from: RT_DEPTH without its jitter, unless
// jittered_depth is on.
#define RT_STEADY_DEPTH 16
#define RT_SHARPENED 17 // RGB: the picture after sharpening
// RGB: how far what a pixel's ray meets has come since the frame before [m]; with solids that move.
// A: 1 where it is one of those, moving or not
#define RT_MOVED 18
// Froxels (froxels.glsl). RGB: light that is scattered per metre, A: extinction [1/m]; of the sums
// in-scattered radiance and transmittance
#define RT_FROXELS 19
#define RT_RAY_TARGET_COUNT 20 // passes with rays know those before, which leaves room for a scene
// What the same rays saw when they were marched before (realtime/gradient/gradient.comp).
#define RT_KEPT_RAY 20    // half resolution; RGB: radiance of the medium, A: transmittance
#define RT_KEPT_BEHIND 21 // RGB: radiance of what is behind all media
// Quarter resolution. Two looks at the same thing: RGB: what a tile's ray sees of the medium; A: a
// change that no light explains.
#define RT_LOOK_NOW 22
#define RT_LOOK_THEN 23        // RGB: what it saw; A: 1 where it was marched before, else 0
#define RT_LOOK_BEHIND_NOW 24  // the same of what is behind, sums of the pixels that were looked at
#define RT_LOOK_BEHIND_THEN 25 // A: how many there are
// What has changed around a tile (gradient/change.comp). RGB: the light of a frame over that of the
// frame before; A: the change that this does not explain.
#define RT_CHANGE 26        // of the medium
#define RT_CHANGE_BEHIND 27 // of what is behind all media
// With taa=locks. R: what is left of a lock, 0 .. 1; G: four times the luma that it was made with;
// B: the nearest eye depth of 3x3 rendered pixels [m].
#define RT_TAA_STATE 28
#define RT_TAA_STATE_BEFORE 29
#define RT_TARGET_COUNT 30

// Groups of solids that move, each as one.
#define RT_MOVERS_MAX 16

// How many pixels wide and high one of their texels is.
#define RT_FULL 1
#define RT_HALF 2
#define RT_QUARTER 4
// A target is columns of froxels wide, and three times rows times slices high; a pass has a thread
// for each froxel, or for each column of them.
#define RT_FROXEL 5
#define RT_FROXEL_COLUMN 6
#define RT_FROXEL_SECTIONS 3
// The pixels of the picture: as many as RT_FULL, or more with screen_percent.
#define RT_PICTURE 7

// The table of targets, rows for a C array or a GLSL one: resolution; the
// format with target_format=half; with float.
#define RT_TARGETS                                                                                 \
    {RT_FULL, RT_R32F, RT_R32F},                     /* RT_DEPTH */                      \
        {RT_FULL, RT_RGBA32F, RT_RGBA32F},           /* RT_BEHIND */                     \
        {RT_HALF, RT_R32F, RT_R32F},                 /* RT_HALF_DEPTH */                 \
        {RT_HALF, RT_R32F, RT_R32F},                 /* RT_HALF_DEPTH_BEFORE */          \
        {RT_HALF, RT_RGBA16F, RT_RGBA32F},    /* RT_HISTORY */                    \
        {RT_HALF, RT_RGBA16F, RT_RGBA32F},    /* RT_HISTORY_BEFORE */             \
        {RT_HALF, RT_RG16F, RT_RG32F},        /* RT_HISTORY_STATE */              \
        {RT_HALF, RT_RG16F, RT_RG32F},        /* RT_HISTORY_STATE_BEFORE */       \
        {RT_QUARTER, RT_RG16F, RT_RG32F},     /* RT_TILE */                       \
        {RT_QUARTER, RT_RGBA16F, RT_RGBA32F}, /* RT_RAY */                        \
        {RT_QUARTER, RT_R16F, RT_R32F},       /* RT_RAY_DISTANCE */               \
        {RT_FULL, RT_RGBA16F, RT_RGBA32F},    /* RT_VOLUME */                     \
        {RT_FULL, RT_R16F, RT_R32F},          /* RT_VOLUME_DISTANCE */            \
        {RT_FULL, RT_RGBA32F, RT_RGBA32F},           /* RT_COLOR */                      \
        {RT_PICTURE, RT_RGBA16F, RT_RGBA32F},   /* RT_TAA_OUT */                    \
        {RT_PICTURE, RT_RGBA16F, RT_RGBA32F},   /* RT_TAA_BEFORE */                 \
        {RT_FULL, RT_R32F, RT_R32F},                 /* RT_STEADY_DEPTH */               \
        {RT_PICTURE, RT_RGBA32F, RT_RGBA32F},        /* RT_SHARPENED */                  \
        {RT_FULL, RT_RGBA32F, RT_RGBA32F},           /* RT_MOVED */                      \
        {RT_FROXEL, RT_RGBA32F, RT_RGBA32F},         /* RT_FROXELS */                    \
        {RT_HALF, RT_RGBA16F, RT_RGBA16F},           /* RT_KEPT_RAY */                   \
        {RT_FULL, RT_RGBA16F, RT_RGBA16F},           /* RT_KEPT_BEHIND */                \
        {RT_QUARTER, RT_RGBA32F, RT_RGBA32F},        /* RT_LOOK_NOW */                   \
        {RT_QUARTER, RT_RGBA32F, RT_RGBA32F},        /* RT_LOOK_THEN */                  \
        {RT_QUARTER, RT_RGBA32F, RT_RGBA32F},        /* RT_LOOK_BEHIND_NOW */            \
        {RT_QUARTER, RT_RGBA32F, RT_RGBA32F},        /* RT_LOOK_BEHIND_THEN */           \
        {RT_QUARTER, RT_RGBA32F, RT_RGBA32F},        /* RT_CHANGE */                     \
        {RT_QUARTER, RT_RGBA32F, RT_RGBA32F},        /* RT_CHANGE_BEHIND */              \
        {RT_PICTURE, RT_RGBA32F, RT_RGBA32F},        /* RT_TAA_STATE */                  \
        {RT_PICTURE, RT_RGBA32F, RT_RGBA32F},        /* RT_TAA_STATE_BEFORE */

#endif
