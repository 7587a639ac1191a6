// SPDX-License-Identifier: MIT
//
// Meshes with alpha as coverage in the real-time renderer: which parts of them a pixel's view ray
// meets. For passes with the scene and the view.
#ifndef NEPH_REALTIME_COVERAGE_GLSL
#define NEPH_REALTIME_COVERAGE_GLSL

// By the number of the frame. With gradient=on the numbers repeat with the jitter, because frames
// with the same jitter are compared and cached.
void draw_view_coverage(ivec2 pixel)
{
    uint period = uint(setting(RT_TAA_JITTER_LENGTH));
    set_coverage(uvec2(pixel), choice(RT_GRADIENT) == 0 ? view_frame : view_frame % period);
}

#endif
