// SPDX-License-Identifier: MIT
//
// Names that the shaders of the screen, their twins in C and its table of options have in common:
// this file is both GLSL and C. What a setting means is said once, in renderer/screen/options.c;
// `neph engines screen` prints it.
#ifndef NEPH_SCREEN_NAMES_H
#define NEPH_SCREEN_NAMES_H

// --- settings: index in the table of options --------------------------------------------------

#define SCREEN_AO 0
#define SCREEN_AO_RADIUS_M 1
#define SCREEN_AO_FALLOFF 2
#define SCREEN_AO_DIRECTIONS 3
#define SCREEN_AO_STEPS 4
#define SCREEN_AO_STEP_POWER 5
#define SCREEN_AO_THICKNESS 6
#define SCREEN_AO_SLICES 7
#define SCREEN_AO_NOISE 8
#define SCREEN_AO_BIAS 9
#define SCREEN_AO_BLUR_PX 10
#define SCREEN_AO_POWER 11
#define SCREEN_AO_INTENSITY 12
#define SCREEN_AO_PLACES 13
#define SCREEN_AO_SUM 14
// Rays of the two passes below.
#define SCREEN_RAY_THICKNESS_M 15
#define SCREEN_RAY_REFINE 16
#define SCREEN_RAY_NOISE 17
// Indirect light of diffuse surfaces.
#define SCREEN_GI 18
#define SCREEN_GI_RAYS 19
#define SCREEN_GI_STEPS 20
#define SCREEN_GI_REACH_M 21
#define SCREEN_GI_BOUNCES 22
#define SCREEN_GI_HISTORY 23
#define SCREEN_GI_SMOOTH 24
// Reflections of metal.
#define SCREEN_SSR 25
#define SCREEN_SSR_RAYS 26
#define SCREEN_SSR_STEPS 27
#define SCREEN_SSR_HISTORY 28
#define SCREEN_SSR_SMOOTH 29
#define SCREEN_TARGETS 30
#define SCREEN_FRAMES 31
#define SCREEN_SETTING_COUNT 32

// --- choices ----------------------------------------------------------------------------------

#define SCREEN_AO_OFF 0
#define SCREEN_AO_SSAO 1
#define SCREEN_AO_UNREAL 2
#define SCREEN_AO_GTAO 3

#define SCREEN_SLICES_RAY 0
#define SCREEN_SLICES_AXIS 1

#define SCREEN_PLACES_PIXEL 0
#define SCREEN_PLACES_PLANE 1

#define SCREEN_SUM_RATIO 0
#define SCREEN_SUM_MEAN 1

#define SCREEN_FLOAT32 0
#define SCREEN_FLOAT16 1

#define SCREEN_BOUNCES_ONE 0
#define SCREEN_BOUNCES_ALL 1

// --- targets, a pixel each ----------------------------------------------------------------------

#define SCREEN_DEPTH 0  // linear eye depth [m], always 32 bits; FAR_M for the sky
#define SCREEN_NORMAL 1 // of the surface, in the camera's axes (right, up, forward); w: roughness
#define SCREEN_BASE 2   // RGB: base colour; w: metalness
#define SCREEN_DIRECT 3 // RGB: radiance towards the camera without any indirect light
#define SCREEN_OPEN 4   // x: share of the hemisphere that is open, by cosine
#define SCREEN_OPEN_SMOOTH 5 // x: after the blur
#define SCREEN_GI_RAW 6      // RGB: radiance of a white surface by indirect light; w: rays found
#define SCREEN_GI_MEAN 7     // the same, over frames; w: how many
#define SCREEN_GI_A 8        // after the first, third, .. smoothing
#define SCREEN_GI_B 9        // after the second, fourth, ..
#define SCREEN_LIT 10        // RGB: radiance with all light of diffuse surfaces
#define SCREEN_SSR_RAW 11    // RGB: radiance of a white metal by indirect light; w: rays found
#define SCREEN_SSR_MEAN 12
#define SCREEN_SSR_A 13
#define SCREEN_SSR_B 14
#define SCREEN_PICTURE 15 // RGB: with everything
// Of the frame before.
#define SCREEN_DEPTH_BEFORE 16
#define SCREEN_NORMAL_BEFORE 17
#define SCREEN_GI_BEFORE 18
#define SCREEN_SSR_BEFORE 19
#define SCREEN_TARGET_COUNT 20
#define SCREEN_NONE 0xffffffffu

// Words of a texel where it has four channels, by SCREEN_TARGETS.
#define SCREEN_WORDS_32 4
#define SCREEN_WORDS_16 2

#endif
