/* SPDX-License-Identifier: MIT
 *
 * The truth along one ray, in double precision and per colour channel. Transmittance is in closed
 * form. Single scattering from the sun is so where it can be, else by adaptive Gauss-Kronrod
 * quadrature over pieces on which the integrand is smooth: cut at the faces of media, at the cells
 * of grids and at the exact edges of the shadows of solids. Its relative accuracy, of the brightest
 * channel, is 1e-12 and better for fog and Gaussians and 1e-9 for shells and grids, as long as that
 * channel is above 1e-290 of the sunlight. What lies behind an optical depth of 45
 * is left out where it is dark beside what comes from nearer, and counted where it is not: against
 * the light, and behind shadows. Light that media emit and do not scatter is in closed form where
 * all of them glow alike (scenes/emission.h), and else quadrature as accurate. Light of point
 * lights is quadrature, too, to 1e-10 (truth/airlight.h). A furnace is known in closed form too:
 * media that scatter all light or emit as their surroundings do.
 */
#ifndef NEPH_TRUTH_TRANSPORT_H
#define NEPH_TRUTH_TRANSPORT_H

#include "scenes/scene.h"

struct neph_ray_light {
    struct neph_rgb radiance;      /* with everything [W m^-2 sr^-1] */
    struct neph_rgb volume;        /* in-scattered and emitted by media [W m^-2 sr^-1] */
    struct neph_rgb transmittance; /* to the first solid, or to infinity */
    double hit_m;                  /* distance to the first solid; +inf for the sky */
    double quadrature_error;       /* estimated absolute error of `volume`, largest channel */
};

/* False, with the reason in words, when no exact answer is known for this scene: multiple
 * scattering outside a furnace; environment light in single scattering; media without a
 * closed form of their optical depth (Horizon's clouds). */
bool neph_transport_is_exact(const struct neph_scene *scene, char *reason, size_t reason_size);

/* The scene must be one that neph_transport_is_exact() accepts; `direction` is unit. */
struct neph_ray_light neph_transport_ray(const struct neph_scene *scene, struct neph_vec3 origin_m,
                                         struct neph_vec3 direction);

#endif
