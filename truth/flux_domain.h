/* SPDX-License-Identifier: MIT
 *
 * The columns of a scene whose fluxes are traced (truth/fluxes.h), and the parameters of that.
 */
#ifndef NEPH_TRUTH_FLUX_DOMAIN_H
#define NEPH_TRUTH_FLUX_DOMAIN_H

#include "scenes/scene.h"

#include <stdint.h>

#define NEPH_FLUX_COLUMNS_MAX 1024 /* along x and along z */
#define NEPH_FLUX_BATCHES 256      /* at most */
/* Photons for each path of a radiance, which costs three times as much. */
#define NEPH_FLUX_PHOTONS 8
#define NEPH_FLUX_PATHS_MIN (2 * NEPH_FLUX_PHOTONS) /* two batches */
#define NEPH_FLUX_PATHS_MAX 100000000

/* The box of the columns. Along an axis that is not open the scene repeats its box. */
struct neph_flux_domain {
    struct neph_bounds box;
    int columns_x, columns_z;
    bool is_open_x, is_open_z;
};

struct neph_fluxes_params {
    int columns_x, columns_z; /* 1..NEPH_FLUX_COLUMNS_MAX */
    /* The levels; NaN: the lowest point of media above the ground, and the highest. */
    double bottom_m, top_m;
    /* Photons that start above a column, NEPH_FLUX_PATHS_MIN to NEPH_FLUX_PATHS_MAX, rounded up to
     * whole batches. */
    int paths;
    uint64_t seed;
    /* Called between parts of the work with the finished fraction; or NULL. */
    void (*progress)(void *context, double fraction);
    void *context;
};

/* The domain of a scene: a period of endless grids, else the extent of the media, 1 m where they
 * are unbounded. NEPH_ERR_INPUT, with the remedy: a scene without sun above the horizon or without
 * media, periods that differ, media or solids beyond the levels. NEPH_ERR_USAGE: a parameter is out
 * of range. */
enum neph_status neph_flux_domain_find(const struct neph_scene *scene,
                                       const struct neph_fluxes_params *params,
                                       struct neph_flux_domain *domain, struct neph_diag *diag);

/* The scene with the sun, of irradiance 1, as its only light. A copy that borrows from `scene`. */
struct neph_scene neph_flux_scene(const struct neph_scene *scene);

/* Height of the bottom level, a hair above a ground at that level. */
double neph_flux_bottom_m(const struct neph_flux_domain *domain);

#endif
