/* SPDX-License-Identifier: MIT
 *
 * Procedural clouds as a medium: scenes/horizon.h.
 */
#include "scenes/hash_text.h"
#include "scenes/horizon.h"
#include "scenes/medium_kind.h"

#include <stddef.h>

#define AT(member) offsetof(struct neph_medium, member)
#define HORIZON(member) offsetof(struct written_horizon, member)

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

/* --- in a scene file --- */

struct written_horizon {
    struct neph_written_medium common;
    int seed;
    struct neph_horizon_params params;
};

/* The defaults are the article's values. */
static const struct neph_field fields[] = {
    {"extinction_per_m", NEPH_NUMBER, AT(extinction_per_m), "1/m", 0, 1e4, .note = "at density 1",
     .standard = NEPH_OR_ANOTHER_DENSITY},
    {"seed", NEPH_WHOLE, HORIZON(seed), "", 0, 1e9, .standard = "1"},
    {"planet_radius_m", NEPH_NUMBER, HORIZON(params.planet_radius_m), "m", 1e3, 1e8,
     .standard = "2e5"},
    {"bottom_m", NEPH_NUMBER, HORIZON(params.bottom_m), "m", -NEPH_FAR_M, NEPH_FAR_M,
     .standard = "80"},
    {"thickness_m", NEPH_NUMBER, HORIZON(params.thickness_m), "m", 1, 1e5, .standard = "280"},
    {"coverage", NEPH_NUMBER, HORIZON(params.coverage), "", 0, 1, .standard = "0.58"},
    {"density", NEPH_NUMBER, HORIZON(params.density), "", 0, 1e3, .standard = "1.5"},
    {"texture_scale_m", NEPH_NUMBER, HORIZON(params.texture_scale_m), "m", 1, NEPH_FAR_M,
     .standard = "6e3"},
    {"base_repeats", NEPH_NUMBER, HORIZON(params.base_repeats), "", 1e-2, 1e4, .standard = "40"},
    {"detail_repeats", NEPH_NUMBER, HORIZON(params.detail_repeats), "", 1e-2, 1e4,
     .standard = "60"},
    {"wind_m", NEPH_THREE, HORIZON(params.wind_m), "m", -NEPH_FAR_M, NEPH_FAR_M,
     .note = "displacement of the patterns", .standard = "[0, 0, 0]"},
    {"bounds", NEPH_RECORD, AT(bounds),
     .note = "a cloud layer needs finite bounds, for trackers and other engines",
     .record = &neph_bounds_record},
    {0},
};

struct neph_horizon_params neph_horizon_defaults(void)
{
    struct written_horizon horizon;
    neph_fields_default(fields, &horizon);
    horizon.params.seed = (uint64_t)horizon.seed;
    return horizon.params;
}

static enum neph_status finish(struct neph_reader *reader, const yaml_node_t *node, void *written)
{
    struct written_horizon *horizon = written;
    (void)node;
    horizon->params.seed = (uint64_t)horizon->seed;
    return neph_horizon_create(&horizon->params, &horizon->common.medium.horizon, reader->diag);
}

const struct neph_medium_row neph_medium_horizon = {
    .facts = {.name = "Horizon cloud layer",
              .place = "at density 1",
              .needs_majorants = true,
              /* measured on cumulus 100 m and more across in 10 km of sky */
              .majorant_cells = 48 * 48 * 48},
    .forms = {{"horizon", "procedural clouds (scenes/horizon.h)", fields,
               sizeof(struct written_horizon), finish}},
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
