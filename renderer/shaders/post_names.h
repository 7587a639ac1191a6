// SPDX-License-Identifier: MIT
//
// Names shared by the post-processing shaders, their CPU references and the table of options:
// indices of settings, values of choices, sizes. This file is valid GLSL and valid C. Settings are
// described in renderer/post/options.c; `neph post --list` prints the descriptions.
#ifndef NEPH_POST_NAMES_H
#define NEPH_POST_NAMES_H

// --- settings: index in the table of options --------------------------------------------------

// Automatic exposure.
#define POST_AUTO_EXPOSURE 0
#define POST_METER_LOW_PERCENT 1
#define POST_METER_HIGH_PERCENT 2
#define POST_EXPOSURE_MIN_EV 3
#define POST_EXPOSURE_MAX_EV 4
#define POST_ADAPT_UP 5
#define POST_ADAPT_DOWN 6
#define POST_ADAPT_NEAR_EV 7
// Bloom.
#define POST_BLOOM 8
#define POST_BLOOM_SCATTERED 9
#define POST_BLOOM_INTENSITY 10
#define POST_BLOOM_THRESHOLD 11
#define POST_BLOOM_SPREAD 12
#define POST_BLOOM_LEVELS 13
// Tone mapping and display encoding.
#define POST_TONE 14
#define POST_TONE_MAP 15
#define POST_EXPOSURE_EV 16
#define POST_WHITE_TEMPERATURE_K 17
#define POST_VIGNETTE 18
#define POST_FILM_SLOPE 19
#define POST_FILM_TOE 20
#define POST_FILM_SHOULDER 21
#define POST_FILM_BLACK_CLIP 22
#define POST_FILM_WHITE_CLIP 23
#define POST_LUT 24
#define POST_GRAIN 25
#define POST_ENCODE 26
#define POST_WHITE_NITS 27
#define POST_PEAK_NITS 28
// Anti-aliasing of the encoded image.
#define POST_FXAA 29
#define POST_FXAA_SUBPIXEL 30
#define POST_FXAA_THRESHOLD 31
#define POST_FXAA_THRESHOLD_MIN 32
// Upscaling, and sharpening between the two upscales.
#define POST_UPSCALE 33
#define POST_SCREEN_PERCENT 34
#define POST_UPSCALE_SOFTNESS 35
#define POST_LANCZOS_GUARD 36
#define POST_SHARPEN 37
#define POST_SHARPEN_AMOUNT 38
#define POST_SECONDARY_UPSCALE 39
#define POST_SECONDARY_PERCENT 40
// Format of the images between stages.
#define POST_TARGETS 41
#define POST_SETTING_COUNT 42

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

#define POST_FLOAT32 0
#define POST_FLOAT16 1
#define POST_UNORM10 2

#define POST_BLOOM_OFF 0
#define POST_BLOOM_CONSERVING 1
#define POST_BLOOM_ADDITIVE 2

// --- the colour table ---------------------------------------------------------------------------

#define POST_LUT_SIDE 32

// --- automatic exposure -----------------------------------------------------------------------

// The histogram of log2 luminance. Values beyond the ends count in the outermost bins.
#define POST_METER_BINS 128
#define POST_METER_FIRST_EV (-16.0)
#define POST_METER_BINS_PER_EV 4.0
#define POST_METER_PIXELS 64 // per thread

// --- bloom ------------------------------------------------------------------------------------

#define POST_LEVELS_MAX 8 // levels of the pyramid without the image

#endif
