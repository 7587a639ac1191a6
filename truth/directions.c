/* SPDX-License-Identifier: MIT */
#include "truth/directions.h"

#include <math.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_PHASE_KIND_COUNT == 3, "a new kind");

/* The textbook's 1 + g^2 - ((1 - g^2) / (1 - g + 2 g u))^2 over 2 g cancels at both ends of g. Its
 * difference to 1, multiplied out, does not, and holds at g = 0 (L. G. Henyey, J. L. Greenstein,
 * ApJ 93, 1941, for the function). */
static double henyey_greenstein_versine(double g, double u)
{
    const double size = fabs(g);
    const double scale = (1.0 - size) / (1.0 - size + 2.0 * size * u);
    return 2.0 * scale * scale * (1.0 - u) * (1.0 + size * u);
}

/* The cubic c^3 + 3 c = 8 u - 4 by its hyperbolic solution (J. R. Frisvad, JOSA A 28, 2011). */
static double rayleigh_versine(double u)
{
    return 1.0 - 2.0 * sinh(asinh(4.0 * u - 2.0) / 3.0);
}

/* That of -g is the mirror image of that of g; the caller mirrors. */
static double forward_versine(const struct neph_phase *phase, double u)
{
    switch (phase->kind) {
    case NEPH_PHASE_HENYEY_GREENSTEIN:
        return henyey_greenstein_versine(phase->g, u);
    case NEPH_PHASE_RAYLEIGH:
        return fmax(0.0, fmin(2.0, rayleigh_versine(u)));
    case NEPH_PHASE_ISOTROPIC:
        return 2.0 * (1.0 - u);
    case NEPH_PHASE_KIND_COUNT:
        break;
    }
    return NAN;
}

static bool is_backward(const struct neph_phase *phase)
{
    return phase->kind == NEPH_PHASE_HENYEY_GREENSTEIN && phase->g < 0.0;
}

double neph_phase_versine(const struct neph_phase *phase, double u)
{
    const double versine = forward_versine(phase, u);
    return is_backward(phase) ? 2.0 - versine : versine;
}

void neph_basis(struct neph_vec3 n, struct neph_vec3 *a, struct neph_vec3 *b)
{
    const double sign = copysign(1.0, n.z);
    const double s = -1.0 / (sign + n.z);
    const double t = n.x * n.y * s;
    *a = (struct neph_vec3){1.0 + sign * n.x * n.x * s, sign * t, -sign * n.x};
    *b = (struct neph_vec3){t, sign + n.y * n.y * s, -n.y};
}

/* axis * along + sine * (a direction across it at a random azimuth), made unit again: a path of
 * thousands of turns would drift. */
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
    const double versine = forward_versine(phase, neph_random_uniform(random));
    const double cosine = 1.0 - versine;
    return around(direction, is_backward(phase) ? -cosine : cosine, sqrt(versine * (2.0 - versine)),
                  random);
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
