/* SPDX-License-Identifier: MIT
 *
 * Procedural clouds as a medium: scenes/horizon.h.
 */
#include "scenes/hash_text.h"
#include "scenes/horizon.h"
#include "scenes/medium_kind.h"

static double extinction_per_m(const struct neph_medium *medium, struct neph_vec3 point_m)
{
    return medium->extinction_per_m * neph_horizon_density(medium->horizon, point_m, NULL);
}

static double optical_depth(const struct neph_medium *medium, struct neph_vec3 origin_m,
                            struct neph_vec3 direction, double t0_m, double t1_m)
{
    return medium->extinction_per_m *
           neph_horizon_integral_m(medium->horizon, origin_m, direction, t0_m, t1_m, NULL);
}

static double bound_per_m(const struct neph_medium *medium, const struct neph_bounds *box)
{
    return medium->extinction_per_m * neph_horizon_bound(medium->horizon, box);
}

static void drift(struct neph_medium *medium, struct neph_vec3 by_m)
{
    struct neph_vec3 *wind_m = &medium->horizon->params.wind_m;
    *wind_m = neph_vec3_add(*wind_m, by_m);
}

static struct neph_bounds support(const struct neph_medium *medium)
{
    return neph_horizon_support(medium->horizon, &medium->bounds);
}

static void hash(const struct neph_medium *medium, FILE *text)
{
    const struct neph_horizon_params *params = &medium->horizon->params;
    neph_put_number(text, "extinction_per_m", medium->extinction_per_m);
    neph_put_number(text, "horizon_version", NEPH_HORIZON_VERSION);
    neph_put_number(text, "seed", (double)params->seed);
    neph_put_three(text, "planet_radius_m bottom_m thickness_m", params->planet_radius_m,
                   params->bottom_m, params->thickness_m);
    neph_put_three(text, "texture_scale_m base_repeats detail_repeats", params->texture_scale_m,
                   params->base_repeats, params->detail_repeats);
    neph_put_number(text, "coverage", params->coverage);
    neph_put_number(text, "density", params->density);
    neph_put_vec3(text, "wind_m", params->wind_m);
}

static void destroy(struct neph_medium *medium)
{
    neph_horizon_destroy(medium->horizon);
}

static void borrow(struct neph_medium *medium, void *room)
{
    struct neph_horizon *horizon = room;
    *horizon = *medium->horizon;
    medium->horizon = horizon;
}

const struct neph_medium_row neph_medium_horizon = {
    .facts = {.name = "Horizon cloud layer",
              .needs_majorants = true,
              .majorant_cells = 48 * 48 * 48},
    .extinction_per_m = extinction_per_m,
    .optical_depth = optical_depth,
    .bound_per_m = bound_per_m,
    .support = support,
    .drift = drift,
    .hash = hash,
    .destroy = destroy,
    .borrow = borrow,
    .room_size = sizeof(struct neph_horizon),
};
