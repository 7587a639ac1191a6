// SPDX-License-Identifier: MIT
//
// Near froxels: a volume in front of the camera, divided into columns and rows of the frame and
// into slices of eye depth that grow with depth (B. Wronski, "Volumetric Fog: Unified Compute
// Shader-Based Solution to Atmospheric Scattering", SIGGRAPH 2014; S. Hillaire, "Physically Based
// and Unified Volumetric Rendering in Frostbite", SIGGRAPH 2015). Slice edges are at
//
//     e_k = near ((1 + end / near)^(k / slices) - 1),   k = 0 .. slices
//
// so e_0 = 0 is the camera and e_slices = end. Below `near` slices are about uniform,
// near ln(1 + end / near) / slices long; beyond it they grow by a constant factor:
//
//     camera |-|-|--|---|-----|--------|-------------| end
//            e_0 e_1 ..
//
// One target has three sections of slices, one below the other: light and extinction of the froxels
// of even frames, of odd frames, and the sums in front of the far edge of each slice.
#ifndef NEPH_FROXELS_GLSL
#define NEPH_FROXELS_GLSL

int froxel_px = int(settings[RT_FROXEL_PX]);
ivec3 froxel_count = ivec3((size_px + froxel_px - 1) / froxel_px, settings[RT_FROXEL_SLICES]);

const int FROXEL_SUMS = 2; // the section; 0 and 1: light of even and odd frames

int froxel_section_now() { return int(view_frame & 1u); }
int froxel_section_before() { return 1 - froxel_section_now(); }

// Eye depth of the far end, where the march begins [m].
float froxel_end_m() { return setting(RT_FROXEL_END_M); }

float froxel_log_ratio() { return log(1.0 + froxel_end_m() / setting(RT_FROXEL_NEAR_M)); }

float froxel_edge_m(int edge)
{
    if (edge >= froxel_count.z)
        return froxel_end_m();
    return setting(RT_FROXEL_NEAR_M) *
           (exp(froxel_log_ratio() * (float(edge) / float(froxel_count.z))) - 1.0);
}

// The inverse of froxel_edge_m(), in slices.
float froxel_place(float depth_m)
{
    return float(froxel_count.z) * log(1.0 + depth_m / setting(RT_FROXEL_NEAR_M)) /
           froxel_log_ratio();
}

ivec2 froxel_texel(int section, ivec3 froxel)
{
    return ivec2(froxel.x, froxel.y + froxel_count.y * (froxel.z + froxel_count.z * section));
}

// Clamped to the sides and ends of the volume.
vec4 fetch_froxel(int section, ivec3 froxel)
{
    return fetch(RT_FROXELS, froxel_texel(section, clamp(froxel, ivec3(0), froxel_count - 1)));
}

// Transmittance of a homogeneous length, and its in-scattered radiance per light per metre [m].
float froxel_through(float extinction_per_m, float length_m)
{
    return transmittance(extinction_per_m * length_m);
}

float froxel_reach_m(float extinction_per_m, float length_m)
{
    return length_m * phi(extinction_per_m * length_m);
}

// Light and transmittance of a length l of one froxel, which is homogeneous with scattered light j
// per metre and extinction sigma:
//
//     integral 0 .. l of j e^(-sigma t) dt = j (1 - e^(-sigma l)) / sigma = j l phi(sigma l),
//     phi(x) = (1 - e^-x) / x
//
// Unlike j l, it conserves energy for any optical depth (Hillaire 2015).
vec4 froxel_stretch(vec4 froxel, float length_m)
{
    return vec4(froxel.rgb * froxel_reach_m(froxel.a, length_m),
                froxel_through(froxel.a, length_m));
}

// `behind` seen through `before`.
vec4 froxel_over(vec4 before, vec4 behind)
{
    return vec4(before.rgb + before.a * behind.rgb, before.a * behind.a);
}

// Light and transmittance in front of a depth in a slice of one column; the last froxel in part.
vec4 column_before(ivec2 column, int slice, float length_m)
{
    vec4 before = vec4(0.0, 0.0, 0.0, 1.0);
    if (slice > 0)
        before = fetch_froxel(FROXEL_SUMS, ivec3(column, slice - 1));
    vec4 last = fetch_froxel(froxel_section_now(), ivec3(column, slice));
    return froxel_over(before, froxel_stretch(last, length_m));
}

// Light and transmittance in front of a depth at a place of the frame, from the four columns
// around.
vec4 froxels_before(vec2 place_px, float depth_m, float slope)
{
    int slice = clamp(int(froxel_place(depth_m)), 0, froxel_count.z - 1);
    float length_m = max(depth_m - froxel_edge_m(slice), 0.0) * slope;
    vec2 place = place_px / float(froxel_px) - 0.5;
    vec2 low = floor(place), part = place - low;
    vec4 before = vec4(0.0);
    for (int i = 0; i < 4; i++) {
        ivec2 step = ivec2(i & 1, i >> 1);
        vec2 weight = mix(1.0 - part, part, vec2(step));
        before += weight.x * weight.y * column_before(ivec2(low) + step, slice, length_m);
    }
    return before;
}

// The light of a point light or spot light peaks with 1/d^2, more sharply than froxel columns can
// resolve. Within a ball of radius R around the light, the peak is left out of the froxels
// (march_lamps.glsl) and computed per pixel (lamp_peaks.comp):
//
//     1/d^2 = (1 - (1 - d^2/R^2)^2) / d^2     froxels: 2/R^2 - d^2/R^4, finite at the light
//           + (1 - d^2/R^2)^2 / d^2           lamp_peaks.comp: 0 at the ball's surface
//
// R is FROXEL_BALL columns: over one column the froxels' part changes by an eighth.
const float FROXEL_BALL = 4.0;

float froxel_ball_m(vec3 lamp_m)
{
    float column = float(froxel_px) * 2.0 * view_now.half_width / float(size_px.x);
    return FROXEL_BALL * column * view_spread(view_now, max(dot(lamp_m, view_now.forward), 0.0));
}

#endif
