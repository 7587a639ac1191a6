// SPDX-License-Identifier: MIT
//
// Diffused light (diffusion.glsl says what it is) in a march. What a point sends to the camera is,
// for each medium, all of it symmetric between sun and eye but for the second term,
//
//   sigma_s p(g) T T_view                                    sunlight scattered once, as it is
//   sigma_s f p(g) T (T'_view - T_view)                      and then forward, into the peak
//   sigma_s (1 - f) p(g') (T' T'_view - T T_view)            once off, forward before or after
//   sigma_s (1 - f) (phi + 3 g' F to the eye) / 4 pi T'_view   off more than once
//
// with T towards the sun and T_view towards the eye, and T' = exp(-(1 - f albedo) tau) in the
// similar medium. Where media of other g or albedo mix, that factor is the one of the place.
#ifndef NEPH_DIFFUSED_LIGHT_GLSL
#define NEPH_DIFFUSED_LIGHT_GLSL

#include "diffused_field.glsl"
#include "march_light.glsl"

// What a step of optical depth `step_depth`, met after `seen_depth`, sends to the camera.
vec3 diffused_light(Mixture mixture, vec3 point_m, float seen_depth, float step_depth)
{
    if (mixture.extinction_per_m.x <= 0.0)
        return vec3(0.0);
    Similar similar = similar_of(mixture);
    bool is_lit = medium_sees_sun(point_m);
    float scale = similar_scale(similar), sun_depth = is_lit ? sample_sun_depth(point_m).x : 0.0;
    float through = transmittance(seen_depth) * phi(step_depth);
    float through_similar = transmittance(scale * seen_depth) * phi(scale * step_depth);
    float sun = is_lit ? transmittance(sun_depth) : 0.0;
    float sun_similar = is_lit ? transmittance(scale * sun_depth) : 0.0;
    vec4 field = diffused_field(point_m);
    float to_eye = -dot(field.xyz, view_direction);
    float sum = 0.0;
    [[unroll]] for (uint m = 0; m < media_count(); m++) {
        float peak = peak_of(m), g = smooth_g_of(m), scattering = scattering_per_m[m].x;
        float smooth_per_sr = henyey_greenstein_per_sr(g, view_direction, to_sun());
        float diffuse = max(field.w + 3.0 * g * to_eye, 0.0) / (4.0 * PI);
        sum += scattering * phase_towards_camera_per_sr[m] * sun *
               mix(through, through_similar, peak);
        sum += scattering * (1.0 - peak) *
               (smooth_per_sr * (sun_similar * through_similar - sun * through) +
                diffuse * through_similar);
    }
    return sun_at(point_m) * sum / mixture.extinction_per_m.x * step_depth;
}

#endif
