/* SPDX-License-Identifier: MIT
 *
 * Exact transport along one ray, in double precision and per colour channel.
 * - Transmittance: closed form.
 * - Single scattering from the sun: closed form if possible, else adaptive Gauss-Kronrod quadrature
 *   over pieces with a smooth integrand, cut at the faces of media, at the cells of grids and at
 *   the exact edges of the shadows of solids. Relative accuracy, of the brightest channel: 1e-12 or
 *   better for fog and Gaussians, 1e-9 for shells and grids, if that channel is above 1e-290 of the
 *   sunlight.
 * - Light from behind an optical depth of 45 is left out if it is negligible beside light from
 *   nearer, and otherwise included: against the light, and behind shadows.
 * - Emission of media, unscattered: closed form if all have the same glow (scenes/emission.h), else
 *   quadrature with the same accuracy.
 * - Point lights: quadrature with relative accuracy 1e-10 (truth/airlight.h).
 * - Furnaces (media that scatter all light or emit like their surroundings): closed form.
 */
#ifndef NEPH_TRUTH_TRANSPORT_H
#define NEPH_TRUTH_TRANSPORT_H

#include "scenes/scene.h"

struct neph_ray_light {
    struct neph_rgb radiance;      /* total [W m^-2 sr^-1] */
    struct neph_rgb volume;        /* in-scattered and emitted by media [W m^-2 sr^-1] */
    struct neph_rgb transmittance; /* to the first solid, or to infinity */
    double hit_m;                  /* distance to the first solid; +inf for the sky */
    double quadrature_error;       /* estimated absolute error of `volume`, largest channel */
};

/* Whether an exact answer is known for this scene; else the reason as text: multiple scattering
 * outside a furnace; environment light in single scattering; media without a closed form of their
 * optical depth (Horizon's clouds). */
bool neph_transport_is_exact(const struct neph_scene *scene, char *reason, size_t reason_size);

/* The light along a ray. neph_transport_is_exact() must accept the scene; `direction` is unit. */
struct neph_ray_light neph_transport_ray(const struct neph_scene *scene, struct neph_vec3 origin_m,
                                         struct neph_vec3 direction);

#endif
