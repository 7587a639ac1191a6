/* SPDX-License-Identifier: MIT */
#include "truth/directions.h"

#include <math.h>

void neph_basis(struct neph_vec3 n, struct neph_vec3 *a, struct neph_vec3 *b)
{
    const double sign = copysign(1.0, n.z);
    const double s = -1.0 / (sign + n.z);
    const double t = n.x * n.y * s;
    *a = (struct neph_vec3){1.0 + sign * n.x * n.x * s, sign * t, -sign * n.x};
    *b = (struct neph_vec3){t, sign + n.y * n.y * s, -n.y};
}

/* axis * along + sine * (a perpendicular direction at a random azimuth), normalised: errors of
 * thousands of turns would add up. */
static struct neph_vec3 around(struct neph_vec3 axis, double along, double sine,
                               struct neph_random *random)
{
    struct neph_vec3 a, b;
    neph_basis(axis, &a, &b);
    const double azimuth_rad = 2.0 * M_PI * neph_random_uniform(random);
    struct neph_vec3 turned = neph_vec3_scale(axis, along);
    turned = neph_vec3_along(turned, a, sine * cos(azimuth_rad));
    return neph_vec3_normalize(neph_vec3_along(turned, b, sine * sin(azimuth_rad)));
}

struct neph_vec3 neph_phase_sample(const struct neph_phase *phase, struct neph_vec3 direction,
                                   struct neph_random *random)
{
    const double versine = neph_phase_row(phase->kind)->versine(phase, neph_random_uniform(random));
    const double cosine = 1.0 - versine;
    return around(direction, phase->g < 0.0 ? -cosine : cosine, sqrt(versine * (2.0 - versine)),
                  random);
}

void neph_direction_ratios(struct neph_rgb drawn_per_sr, int channel, double ratio[3])
{
    const double drawn[3] = {drawn_per_sr.r, drawn_per_sr.g, drawn_per_sr.b};
    for (int j = 0; j < 3; j++)
        ratio[j] = drawn[channel] > 0.0 ? drawn[j] / drawn[channel] : 1.0;
}

struct neph_vec3 neph_cosine_sample(struct neph_vec3 normal, struct neph_random *random)
{
    const double u = neph_random_uniform(random); /* the square of the sine is uniform */
    return around(normal, sqrt(1.0 - u), sqrt(u), random);
}

struct neph_vec3 neph_direction_around(struct neph_vec3 axis, double angle_rad,
                                       struct neph_random *random)
{
    return around(axis, cos(angle_rad), sin(angle_rad), random);
}
