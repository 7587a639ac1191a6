/* SPDX-License-Identifier: MIT
 *
 * The files of the Intercomparison of 3D Radiation Codes (R. F. Cahalan et al., "The I3RC: bringing
 * together the most advanced radiative transfer tools for cloudy atmospheres", BAMS 86, 2005):
 * clouds and results as plain numbers. They are not part of neph.
 */
#ifndef NEPH_HARNESS_PHYSICS_I3RC_FILES_H
#define NEPH_HARNESS_PHYSICS_I3RC_FILES_H

#include "base/status.h"

#include <stdbool.h>

/* The variable of the environment with their folder, and where a user gets them. */
#define NEPH_I3RC_VARIABLE "NEPH_I3RC_DATA"
extern const char neph_i3rc_address[];

/* What a file has to contain. */
struct neph_i3rc_file {
    const char *name; /* in the folder */
    const char *what; /* of a value: "an optical depth", for messages */
    int values;
    double minimum, maximum;
};

/* Read a file: exactly so many numbers in ranges, between white space, whatever its lines. The
 * caller frees `*values`. NEPH_ERR_NOT_FOUND: the folder has no such file. NEPH_ERR_INPUT, with
 * file, line and column: a word that is no number, a value out of range, too few or too many. */
enum neph_status neph_i3rc_file_read(const char *folder, const struct neph_i3rc_file *file,
                                     double **values, struct neph_diag *diag);

/* Read the consensus of a quantity ("R"), `case2_exp1_R.txt` or, as published,
 * `I3RC_cons_res_case2_exp1_R.txt`. `*values` is NULL where the folder has neither. Errors as
 * above. */
enum neph_status neph_i3rc_consensus_read(const char *folder, int case_number, int experiment,
                                          const char *quantity, int columns, double **values,
                                          struct neph_diag *diag);

#endif
