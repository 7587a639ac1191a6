#version 450
// SPDX-License-Identifier: MIT
//
// The third and last step. The upscale reads its output.
#extension GL_GOOGLE_include_directive : require

#define ATROUS_STEP 4
#define INPUT RT_KEPT_RAY
#define OUTPUT RT_HISTORY_BEFORE
#include "atrous.glsl"
