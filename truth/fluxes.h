/* SPDX-License-Identifier: MIT
 *
 * Fluxes of sunlight through the columns of a scene, the quantities of intercomparisons of
 * radiation codes (R. F. Cahalan et al., "The I3RC", BAMS 86, 2005). Other light is left out, and
 * all orders of scattering count. The domain is a box between two levels, divided into columns. All
 * values are divided by mu0 E, the sunlight on a level plane, and are means over a column.
 *
 * Fluxes are by photons, light traced from the sun: as many start above each column, free paths as
 * in truth/tracking.h, directions by the phase function. A photon leaves its weight at the levels
 * that it crosses, and at each collision its absorbed part, so no flux is computed from the others.
 * Its sunlight that reaches the bottom level unscattered is exact. Radiances are by the paths of
 * truth/oracle.h, which start on a level.
 *
 * Standard errors are from independent batches, each of all columns.
 */
#ifndef NEPH_TRUTH_FLUXES_H
#define NEPH_TRUTH_FLUXES_H

#include "scenes/scene.h"

#include <stdint.h>

enum neph_flux {
    NEPH_FLUX_REFLECTED,   /* upwards through the top */
    NEPH_FLUX_TRANSMITTED, /* downwards through the bottom: diffuse and direct */
    NEPH_FLUX_DIRECT,      /* the direct part */
    NEPH_FLUX_UPWARD,      /* upwards through the bottom, from a ground */
    NEPH_FLUX_ABSORBED,    /* by media */
    /* 1 - reflected - (transmitted - upward) - absorbed: leaves through the sides. */
    NEPH_FLUX_HORIZONTAL,
    NEPH_FLUX_NADIR,  /* pi times the radiance that leaves the top straight up */
    NEPH_FLUX_ZENITH, /* pi times the radiance that leaves the bottom straight down, without the
                       * sun */
    NEPH_FLUX_COUNT,
};

#define NEPH_FLUX_COLUMNS_MAX 1024 /* along x and along z */
#define NEPH_FLUX_PATHS_MAX 100000000
#define NEPH_FLUX_BATCHES 256 /* at most */

/* From this relative variance of the variance on, an error bar is not to be trusted: a few paths
 * make most of it, or there are few batches (X-5 Monte Carlo Team, "MCNP", vol. I, LA-UR-03-1987,
 * 2003, section 2.VI.E). */
#define NEPH_FLUX_DOUBTFUL 0.1

/* The box of the columns. Along an axis that is not open the scene repeats its box. */
struct neph_flux_domain {
    struct neph_bounds box;
    int columns_x, columns_z;
    bool is_open_x, is_open_z;
};

/* The first four powers of a value less that of the first batch, summed over batches: without the
 * difference the fourth moment would cancel. */
struct neph_flux_sum {
    double count, first, powers[4];
};

struct neph_flux_estimate {
    double mean, standard_error;
    double doubt; /* relative variance of the variance of the mean; 0: no variance */
};

/* To be freed with neph_fluxes_finish(). */
struct neph_fluxes {
    struct neph_flux_domain domain;
    int channel_count;          /* 1: all three are equal */
    int paths;                  /* of each column */
    struct neph_flux_sum *sums; /* owned; [flux][column][channel]; column = x + columns_x z */
    struct neph_flux_sum *domain_sums; /* of the means over the columns; owned; [flux][channel] */
    double wall_s;
};

struct neph_fluxes_params {
    int columns_x, columns_z; /* 1..NEPH_FLUX_COLUMNS_MAX */
    double bottom_m, top_m;   /* the levels; NaN: the lowest point of media above the ground, and the
                               * highest */
    int paths;                /* photons that start above a column, and paths of each radiance; 2 to
                * NEPH_FLUX_PATHS_MAX, rounded up to whole batches */
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

/* Allocate zeroed sums. */
enum neph_status neph_fluxes_create(const struct neph_scene *scene,
                                    const struct neph_flux_domain *domain,
                                    struct neph_fluxes *fluxes, struct neph_diag *diag);

/* Trace, in double precision on all processors; the bits do not depend on their number. `fluxes` is
 * set only on success. NEPH_ERR_INTERRUPTED; errors as of neph_flux_domain_find() and
 * neph_oracle_can_render(). */
enum neph_status neph_fluxes_trace(const struct neph_scene *scene,
                                   const struct neph_fluxes_params *params,
                                   struct neph_fluxes *fluxes, struct neph_diag *diag);

void neph_fluxes_finish(struct neph_fluxes *fluxes);

/* Add a batch: `values` are [flux][column][channel], without the horizontal flux, which is filled
 * in. */
void neph_fluxes_add_batch(struct neph_fluxes *fluxes, double *values);

/* A flux of a column, and its mean over the domain. */
struct neph_flux_estimate neph_flux_of_column(const struct neph_fluxes *fluxes, enum neph_flux flux,
                                              int column, int channel);
struct neph_flux_estimate neph_flux_of_domain(const struct neph_fluxes *fluxes, enum neph_flux flux,
                                              int channel);

/* Number of columns with a doubtful error bar. */
int neph_flux_doubtful_columns(const struct neph_fluxes *fluxes, enum neph_flux flux, int channel);

#endif
