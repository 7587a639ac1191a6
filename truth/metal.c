/* SPDX-License-Identifier: MIT */
#include "truth/metal.h"

#include "truth/directions.h"

/* The Trowbridge-Reitz (GGX) distribution; Walter et al. 2007, equation 33. */
static double facets_per_sr(double alpha, double cosine)
{
    const double squared = alpha * alpha;
    /* cos^2 (alpha^2 - 1) + 1, without its cancellation at the peak of a smooth metal. */
    const double spread = (1.0 - cosine) * (1.0 + cosine) + squared * cosine * cosine;
    return squared / (M_PI * spread * spread);
}

/* Smith's masking G1, the visible part of the facets from a direction; equation 34. */
static double seen(double alpha, double cosine)
{
    const double tangent_squared = (1.0 - cosine) * (1.0 + cosine) / (cosine * cosine);
    return 2.0 / (1.0 + sqrt(1.0 + alpha * alpha * fmax(0.0, tangent_squared)));
}

double neph_metal_per_sr(double roughness, struct neph_vec3 normal, struct neph_vec3 from,
                         struct neph_vec3 to)
{
    const double alpha = roughness * roughness;
    const double cos_from = neph_vec3_dot(normal, from), cos_to = neph_vec3_dot(normal, to);
    if (cos_from <= 0.0 || cos_to <= 0.0)
        return 0.0;
    const struct neph_vec3 facet = neph_vec3_normalize(neph_vec3_add(from, to));
    return facets_per_sr(alpha, fmin(1.0, neph_vec3_dot(normal, facet))) * seen(alpha, cos_from) *
           seen(alpha, cos_to) / (4.0 * cos_from);
}

struct neph_vec3 neph_mirrored(struct neph_vec3 direction, struct neph_vec3 normal)
{
    return neph_vec3_along(neph_vec3_scale(direction, -1.0), normal,
                           2.0 * neph_vec3_dot(direction, normal));
}

/* Sample a visible facet, in the frame with the normal as z (Heitz 2018, listing 1: a point of the
 * half disc that is the projection of the stretched hemisphere). */
static struct neph_vec3 draw_facet(double alpha, struct neph_vec3 from, struct neph_random *random)
{
    const struct neph_vec3 v = neph_vec3_normalize(
        (struct neph_vec3){alpha * from.x, alpha * from.y, from.z});
    const double across = hypot(v.x, v.y);
    const struct neph_vec3 a = across > 0.0 ? (struct neph_vec3){-v.y / across, v.x / across, 0}
                                            : (struct neph_vec3){1, 0, 0};
    const struct neph_vec3 b = neph_vec3_cross(v, a);
    const double r = sqrt(neph_random_uniform(random));
    const double azimuth_rad = 2.0 * M_PI * neph_random_uniform(random);
    const double s = r * cos(azimuth_rad), shown = 0.5 * (1.0 + v.z);
    const double t = (1.0 - shown) * sqrt(1.0 - s * s) + shown * r * sin(azimuth_rad);
    struct neph_vec3 n = neph_vec3_scale(v, sqrt(fmax(0.0, 1.0 - s * s - t * t)));
    n = neph_vec3_along(neph_vec3_along(n, a, s), b, t);
    return neph_vec3_normalize((struct neph_vec3){alpha * n.x, alpha * n.y, fmax(0.0, n.z)});
}

double neph_metal_sample(double roughness, struct neph_vec3 normal, struct neph_vec3 from,
                         struct neph_random *random, struct neph_vec3 *to)
{
    if (neph_vec3_dot(normal, from) <= 0.0)
        return 0.0;
    if (roughness == 0.0) {
        *to = neph_vec3_normalize(neph_mirrored(from, normal));
        return 1.0;
    }
    const double alpha = roughness * roughness;
    struct neph_vec3 a, b;
    neph_basis(normal, &a, &b);
    const struct neph_vec3 own = {neph_vec3_dot(from, a), neph_vec3_dot(from, b),
                                  neph_vec3_dot(from, normal)};
    const struct neph_vec3 facet = draw_facet(alpha, own, random);
    const struct neph_vec3 out = neph_mirrored(own, facet);
    if (out.z <= 0.0)
        return 0.0;
    *to = neph_vec3_scale(a, out.x);
    *to = neph_vec3_along(neph_vec3_along(*to, b, out.y), normal, out.z);
    *to = neph_vec3_normalize(*to);
    return seen(alpha, out.z);
}
