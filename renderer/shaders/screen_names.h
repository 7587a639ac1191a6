// SPDX-License-Identifier: MIT
//
// Names shared by the screen-space shaders, their CPU references and the table of options: indices
// of settings, values of choices, targets. This file is valid GLSL and valid C. Settings are
// described in renderer/screen/options.c; `neph engines screen` prints the descriptions.
#ifndef NEPH_SCREEN_NAMES_H
#define NEPH_SCREEN_NAMES_H

// --- settings: index in the table of options --------------------------------------------------

#define SCREEN_AO 0
#define SCREEN_AO_RESOLUTION 1
#define SCREEN_AO_RADIUS_M 2
#define SCREEN_AO_FALLOFF 3
#define SCREEN_AO_DIRECTIONS 4
#define SCREEN_AO_STEPS 5
#define SCREEN_AO_STEP_POWER 6
#define SCREEN_AO_THICKNESS 7
#define SCREEN_AO_SLICES 8
#define SCREEN_AO_NOISE 9
#define SCREEN_AO_BIAS 10
#define SCREEN_AO_BLUR_PX 11
#define SCREEN_AO_POWER 12
#define SCREEN_AO_INTENSITY 13
#define SCREEN_AO_PLACES 14
#define SCREEN_AO_SUM 15
// Rays of the two passes below.
#define SCREEN_RAY_THICKNESS_M 16
#define SCREEN_RAY_REFINE 17
#define SCREEN_RAY_STEP_POWER 18
#define SCREEN_RAY_METAL 19
#define SCREEN_RAY_NOISE 20
#define SCREEN_RAY_PIXEL 21
// Indirect light of diffuse surfaces.
#define SCREEN_GI 22
#define SCREEN_GI_RESOLUTION 23
#define SCREEN_GI_RAYS 24
#define SCREEN_GI_STEPS 25
#define SCREEN_GI_REACH_M 26
#define SCREEN_GI_BOUNCES 27
#define SCREEN_GI_HISTORY 28
#define SCREEN_GI_SMOOTH 29
// Reflections of metal.
#define SCREEN_SSR 30
#define SCREEN_SSR_RESOLUTION 31
#define SCREEN_SSR_RAYS 32
#define SCREEN_SSR_STEPS 33
#define SCREEN_SSR_ROUGHEST 34
#define SCREEN_SSR_HISTORY 35
#define SCREEN_SSR_SMOOTH 36
#define SCREEN_TARGETS 37
#define SCREEN_WARM_UP 38
#define SCREEN_SETTING_COUNT 39

// --- choices ----------------------------------------------------------------------------------

#define SCREEN_AO_OFF 0
#define SCREEN_AO_SSAO 1
#define SCREEN_AO_UNREAL 2
#define SCREEN_AO_GTAO 3

#define SCREEN_FULL 0
#define SCREEN_HALF 1

#define SCREEN_SLICES_RAY 0
#define SCREEN_SLICES_AXIS 1

#define SCREEN_PLACES_PIXEL 0
#define SCREEN_PLACES_PLANE 1

#define SCREEN_SUM_RATIO 0
#define SCREEN_SUM_MEAN 1

#define SCREEN_FLOAT32 0
#define SCREEN_FLOAT16 1

#define SCREEN_METAL_RELIT 0
#define SCREEN_METAL_CAMERA 1

#define SCREEN_PIXEL_FIRST 0
#define SCREEN_PIXEL_TURNING 1

#define SCREEN_BOUNCES_ONE 0
#define SCREEN_BOUNCES_ALL 1

// --- targets: one texel per pixel ---------------------------------------------------------------

// Targets with one 32-bit word.
#define SCREEN_DEPTH 0 // linear eye depth [m]; FAR_M for the sky
#define SCREEN_MARKS 1 // visibility bits of sun and lamps, and the number of the solid
#define SCREEN_GI_COUNT 2 // frames in the running mean
#define SCREEN_SSR_COUNT 3
// The same in the frame before.
#define SCREEN_DEPTH_BEFORE 4
#define SCREEN_GI_COUNT_BEFORE 5
#define SCREEN_SSR_COUNT_BEFORE 6
// Targets with four channels.
#define SCREEN_NORMAL 7 // normal in camera axes (right, up, forward); w: roughness
#define SCREEN_BASE 8 // RGB: base colour; w: metalness
#define SCREEN_DIRECT 9 // RGB: radiance towards the camera without indirect light
#define SCREEN_OPEN 10 // x: cosine-weighted unoccluded fraction of the hemisphere
#define SCREEN_OPEN_SMOOTH 11 // x: after the filter
#define SCREEN_OPEN_WHOLE 12 // x: at full resolution, when the ones above are at half resolution
// RGB: light of other surfaces that a white surface reflects; w: fraction of the sky's light. After
// the smoothing passes, A or B also contains the result at full resolution.
#define SCREEN_GI_RAW 13
#define SCREEN_GI_MEAN 14 // running mean over frames
#define SCREEN_GI_A 15 // after smoothing pass 1, 3, ..
#define SCREEN_GI_B 16 // after smoothing pass 2, 4, ..
#define SCREEN_LIT 17 // RGB: radiance with all light of diffuse surfaces
// Light of a white metal: the buffers of the reflections, as above.
#define SCREEN_SSR_RAW 18
#define SCREEN_SSR_MEAN 19
#define SCREEN_SSR_A 20
#define SCREEN_SSR_B 21
#define SCREEN_PICTURE 22 // RGB: final radiance
// Targets of the frame before.
#define SCREEN_NORMAL_BEFORE 23
#define SCREEN_GI_BEFORE 24
#define SCREEN_SSR_BEFORE 25
#define SCREEN_TARGET_COUNT 26
#define SCREEN_FIRST_OF_FOUR SCREEN_NORMAL
#define SCREEN_LIGHT_BITS 17
#define SCREEN_NONE 0xffffffffu

// Words of a four-channel texel, by SCREEN_TARGETS.
#define SCREEN_WORDS_32 4
#define SCREEN_WORDS_16 2

#endif
