/* SPDX-License-Identifier: MIT
 *
 * Fluxes of columns (truth/fluxes.h) as sums over independent batches: means, standard errors, and
 * whether these are to be trusted.
 */
#ifndef NEPH_TRUTH_FLUX_SUMS_H
#define NEPH_TRUTH_FLUX_SUMS_H

#include "truth/flux_domain.h"
#include "truth/moments.h"

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

struct neph_flux_estimate {
    double mean, standard_error;
    double doubt; /* relative variance of the variance of the mean; 0: no variance */
};

/* To be freed with neph_fluxes_finish(). */
struct neph_fluxes {
    struct neph_flux_domain domain;
    int channel_count;                /* 1: all three are equal */
    int paths;                        /* of each column */
    struct neph_moments *sums;        /* owned; [flux][column][channel]; column = x + columns_x z */
    struct neph_moments *domain_sums; /* of the means over the columns; owned; [flux][channel] */
    double wall_s;
};

/* Allocate zeroed sums. */
enum neph_status neph_fluxes_create(const struct neph_scene *scene,
                                    const struct neph_flux_domain *domain,
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
