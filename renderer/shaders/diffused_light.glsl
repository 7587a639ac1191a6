// SPDX-License-Identifier: MIT
//
// Diffused light (diffusion.glsl) in the ray marcher. A point sends to the camera, for each medium,
//
//   sigma_s p(g) T T_view                                      single scattering, as it is
//   sigma_s f p(g) T (T'_view - T_view)                        and then forward, into the peak
//   sigma_s (1 - f) p(g') (T' T'_view - T T_view)              one deflection, and forward
//                                                              scattering before or after it
//   sigma_s (1 - f) (phi + 3 g' F to the eye) / 4 pi T'_view   several deflections
//
// T is the transmittance towards the sun, T_view towards the eye. The primed ones belong to the
// similar medium: T' = exp(-(1 - f albedo) tau). All terms but the second are symmetric in sun and
// eye. Where media with different g or albedo mix, the factor (1 - f albedo) of the point is used
// for the whole way.
#ifndef NEPH_DIFFUSED_LIGHT_GLSL
#define NEPH_DIFFUSED_LIGHT_GLSL

#include "diffused_field.glsl"
#include "march_light.glsl"

// Radiance that a step of optical depth `step_depth`, behind the optical depth `seen_depth`, sends
// to the camera.
vec3 diffused_light(Mixture mixture, vec3 point_m, float seen_depth, float step_depth)
{
    if (mixture.extinction_per_m.x <= 0.0)
        return vec3(0.0);
    Similar similar = make_similar_medium(mixture);
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
        float peak = forward_peak_fraction(m), g = similar_mean_cosine(m);
        float scattering = scattering_per_m[m].x;
        float smooth_per_sr = henyey_greenstein_per_sr(g, view_direction, to_sun());
        float diffuse = max(field.w + 3.0 * g * to_eye, 0.0) / (4.0 * PI);
        sum += scattering * phase_towards_camera_per_sr[m].x * sun *
               mix(through, through_similar, peak);
        sum += scattering * (1.0 - peak) *
               (smooth_per_sr * (sun_similar * through_similar - sun * through) +
                diffuse * through_similar);
    }
    return sun_at(point_m) * sum / mixture.extinction_per_m.x * step_depth;
}

#endif
