/* SPDX-License-Identifier: MIT
 *
 * The experiments of the Intercomparison of 3D Radiation Codes as a suite: fluxes and radiances of
 * each column, compared with the consensus where its files are in the folder.
 *
 * Means over the domain must be within 0.3 % of the consensus, the agreement that its codes have,
 * or within three standard errors. Columns: the rms difference from the consensus falls with the
 * number of paths to a constant, since the consensus is a mean of Monte Carlo codes with noise of
 * its own: rms^2 = our variance + constant^2. Each number of paths has random numbers of its own,
 * so each gives the squared constant by itself; what fits all is their mean, weighted by the
 * inverse of their variances, which are those of a mean over columns. Noise has no correlation from
 * column to column: a correlation would be a difference of the methods.
 */
#ifndef NEPH_HARNESS_PHYSICS_I3RC_H
#define NEPH_HARNESS_PHYSICS_I3RC_H

#include "harness/document/table.h"
#include "harness/physics/fluxes.h"
#include "harness/physics/i3rc_case.h"

#include "base/arena.h"

#include <stdio.h>

enum { NEPH_I3RC_QUANTITIES = 6, NEPH_I3RC_STAGES = 3 };

/* The numbers of paths are these parts of all, in turn. */
extern const double neph_i3rc_stages[NEPH_I3RC_STAGES];

/* A quantity's name in file names, and what it is. */
struct neph_i3rc_quantity {
    const char *name;
    enum neph_flux flux;
};
extern const struct neph_i3rc_quantity neph_i3rc_quantities[NEPH_I3RC_QUANTITIES];

/* Columns against their consensus. */
struct neph_i3rc_columns {
    double rms[NEPH_I3RC_STAGES];
    double noise;                       /* rms of our standard errors with all paths */
    double constant;                    /* NaN: not told apart from 0 */
    double constant_low, constant_high; /* its 95 % interval */
    double fall; /* rms with fewer paths against that of the constant and our noise, in standard
                    errors: the larger one */
    double correlation[2];       /* of the differences of neighbours along x, z; NaN: one column */
    double correlation_error[2]; /* standard errors of these for noise */
    int worst_x, worst_z;        /* the column that differs most, in standard errors */
    double worst, worst_error, worst_consensus;
    double worst_score, worst_p; /* its difference in standard errors of both; probability of such a
                                    column among as many columns of normal noise */
};

struct neph_i3rc_number {
    struct neph_flux_estimate ours; /* mean over the domain */
    int doubtful_columns;
    bool has_consensus, agrees;
    double consensus, consensus_error; /* its mean; its standard error from the constant */
    struct neph_i3rc_columns columns;
};

struct neph_i3rc_row {
    const struct neph_i3rc_experiment *experiment;
    const char *missing; /* why there are no numbers; NULL: there are. Owned by the arena. */
    double optical_depth;
    /* Reflected, absorbed by media and by the ground, of the consensus: 1 without errors. NaN: not
     * all of it is here. */
    double consensus_balance;
    int paths;
    double wall_s;
    struct neph_i3rc_number numbers[NEPH_I3RC_QUANTITIES];
};

/* Start from {0}; free with neph_i3rc_finish(). */
struct neph_i3rc {
    struct neph_arena arena;
    struct neph_i3rc_row *rows; /* owned by the arena */
    int row_count, compared, failed;
};

struct neph_i3rc_params {
    const char *folder;      /* NULL: none was given */
    const char *engine;      /* oracle or tracer */
    const char *const *only; /* "case2", "case2_exp1": parts of names; or none */
    int only_count;
    int paths; /* photons of a column; 0: each experiment's own number */
    struct neph_shared_device *device;
    bool quiet;
};

/* Run the experiments. A file that is not there is no error: its row says so. NEPH_ERR_USAGE: no
 * experiment has that name; errors of files, and of neph_fluxes_measure(). */
enum neph_status neph_i3rc_run(const struct neph_i3rc_params *params, struct neph_i3rc *suite,
                               struct neph_diag *diag);

/* Compare the columns of a flux with a consensus. `stages`: the same columns with the numbers of
 * paths of neph_i3rc_stages, the last with all. */
enum neph_status neph_i3rc_compare(const struct neph_fluxes stages[NEPH_I3RC_STAGES],
                                   enum neph_flux flux, const double *consensus,
                                   struct neph_i3rc_number *number, struct neph_diag *diag);

/* Print for a terminal; fill a table for CSV and JSON, a row for each quantity of an experiment. */
void neph_i3rc_print(const struct neph_i3rc *suite, FILE *out);
void neph_i3rc_fill_table(const struct neph_i3rc *suite, struct neph_table *table);

void neph_i3rc_finish(struct neph_i3rc *suite);

#endif
