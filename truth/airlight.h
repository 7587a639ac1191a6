/* SPDX-License-Identifier: MIT
 *
 * The airlight of point lights: light that media scatter once into a ray,
 *   L = integral of sum_m sigma_s,m(t) p_m(cos) I(direction) / d^2 e^(-tau_view - tau_light) V dt,
 * with d the distance from the light. The peak of 1 / d^2, which is sharp if the ray passes close
 * to the light, is removed by the substitution t = foot + h tan(theta), dt / d^2 = dtheta / h (B.
 * Sun, R. Ramamoorthi, S. G. Narasimhan, S. K. Nayar, "A Practical Analytic Single Scattering Model
 * for Real Time Rendering", SIGGRAPH 2005; C. Kulla, M. Fajardo, EGSR 2012, sample distances by
 * it). The new integrand is smooth between the edges of shadows, cones and media, where the ray is
 * cut exactly.
 */
#ifndef NEPH_TRUTH_AIRLIGHT_H
#define NEPH_TRUTH_AIRLIGHT_H

#include "scenes/solids.h"

/* Add to `radiance` the airlight of all lights along origin + t direction (unit), t in [t0_m,
 * t1_m], both finite. All media must have closed forms. Adaptive quadrature as in
 * truth/transport.h, with a relative accuracy better than 1e-10. Returns the estimated absolute
 * error. The radiance of a ray straight through a light is infinite. */
double neph_airlight(const struct neph_scene *scene, struct neph_vec3 origin_m,
                     struct neph_vec3 direction, double t0_m, double t1_m,
                     struct neph_rgb *radiance);

/* Radiance of all lights reflected by a Lambertian surface of albedo 1, at the point of a hit,
 * just outside of it. */
struct neph_rgb neph_reflect_lights(const struct neph_scene *scene, struct neph_vec3 point_m,
                                    const struct neph_hit *hit);

#endif
