// SPDX-License-Identifier: MIT
//
// Names that the shaders of the picture chain, their twins in C and its table of options have in
// common: this file is both GLSL and C. What a setting means is said once, in
// renderer/post/options.c; `neph post --list` prints it.
#ifndef NEPH_POST_NAMES_H
#define NEPH_POST_NAMES_H

// --- settings: index in the table of options --------------------------------------------------

#define POST_TONE 0
#define POST_TONE_MAP 1
#define POST_EXPOSURE_EV 2
#define POST_WHITE_TEMPERATURE_K 3
#define POST_VIGNETTE 4
#define POST_FILM_SLOPE 5
#define POST_FILM_TOE 6
#define POST_FILM_SHOULDER 7
#define POST_FILM_BLACK_CLIP 8
#define POST_FILM_WHITE_CLIP 9
#define POST_LUT 10
#define POST_GRAIN 11
#define POST_ENCODE 12
#define POST_UPSCALE 13
#define POST_SCREEN_PERCENT 14
#define POST_UPSCALE_SOFTNESS 15
#define POST_LANCZOS_GUARD 16
// Anti-aliasing of the encoded picture, and sharpening.
#define POST_FXAA 17
#define POST_FXAA_SUBPIXEL 18
#define POST_FXAA_THRESHOLD 19
#define POST_FXAA_THRESHOLD_MIN 20
#define POST_SHARPEN 21
#define POST_SHARPEN_AMOUNT 22
// Automatic exposure.
#define POST_AUTO_EXPOSURE 23
#define POST_METER_LOW_PERCENT 24
#define POST_METER_HIGH_PERCENT 25
#define POST_EXPOSURE_MIN_EV 26
#define POST_EXPOSURE_MAX_EV 27
#define POST_ADAPT_UP 28
#define POST_ADAPT_DOWN 29
#define POST_ADAPT_NEAR_EV 30
// Bloom.
#define POST_BLOOM 31
#define POST_BLOOM_SCATTERED 32
#define POST_BLOOM_INTENSITY 33
#define POST_BLOOM_THRESHOLD 34
#define POST_BLOOM_SPREAD 35
#define POST_BLOOM_LEVELS 36
// An HDR display.
#define POST_WHITE_NITS 37
#define POST_PEAK_NITS 38
// From the size that the chain works at to that of the window.
#define POST_SECONDARY_UPSCALE 39
#define POST_SECONDARY_PERCENT 40
#define POST_SETTING_COUNT 41

// --- choices ----------------------------------------------------------------------------------

#define POST_MAP_NONE 0
#define POST_MAP_REINHARD 1
#define POST_MAP_NARKOWICZ 2
#define POST_MAP_UNREAL 3
#define POST_MAP_NEUTRAL 4
#define POST_MAP_AGX 5
#define POST_MAP_BT2390 6

#define POST_ENCODE_LINEAR 0
#define POST_ENCODE_SRGB 1
#define POST_ENCODE_PQ 2

#define POST_UPSCALE_OFF 0
#define POST_UPSCALE_NEAREST 1
#define POST_UPSCALE_BILINEAR 2
#define POST_UPSCALE_DIRECTIONAL 3
#define POST_UPSCALE_CATMULL_ROM 4
#define POST_UPSCALE_LANCZOS 5
#define POST_UPSCALE_GAUSSIAN 6
#define POST_UPSCALE_SMOOTHSTEP 7
#define POST_UPSCALE_EASU 8

#define POST_FXAA_OFF 0
#define POST_FXAA_CONSOLE 1
#define POST_FXAA_12 2
#define POST_FXAA_29 3
#define POST_FXAA_39 4

#define POST_SHARPEN_OFF 0
#define POST_SHARPEN_CAS 1
#define POST_SHARPEN_RCAS 2

#define POST_BLOOM_OFF 0
#define POST_BLOOM_CONSERVING 1
#define POST_BLOOM_ADDITIVE 2

// --- the table of colours ---------------------------------------------------------------------

#define POST_LUT_SIDE 32

// --- automatic exposure -----------------------------------------------------------------------

// The meter's histogram: log2 of luminance, bins a quarter wide. What is beyond is in the last one.
#define POST_METER_BINS 128
#define POST_METER_FIRST_EV (-16.0)
#define POST_METER_BINS_PER_EV 4.0
#define POST_METER_PIXELS 64 // that a thread looks at

// --- bloom ------------------------------------------------------------------------------------

#define POST_LEVELS_MAX 8 // of the pyramid, besides the picture

#endif
