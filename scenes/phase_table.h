/* SPDX-License-Identifier: MIT
 *
 * A phase function as a table: linear in the cosine of the scattering angle between its rows,
 * so that its integral, the inverse of its distribution and its Legendre moments are closed forms.
 */
#ifndef NEPH_SCENES_PHASE_TABLE_H
#define NEPH_SCENES_PHASE_TABLE_H

#include "base/arena.h"
#include "base/status.h"

#include <stdbool.h>
#include <stdio.h>

enum {
    NEPH_TABULATED_ROWS_MAX = 8192,
    NEPH_TABULATED_MOMENTS = 1024, /* the highest degree */
};

/* A row: versine 1 - cos of the scattering angle, phase function [1/sr], and the light scattered
 * by smaller angles, 0..1. */
struct neph_phase_node {
    double versine, per_sr, within;
};

struct neph_phase_table {
    int count;                     /* 2..NEPH_TABULATED_ROWS_MAX */
    struct neph_phase_node *nodes; /* from versine 0 to 2, ascending */
    double *moments;               /* by degree, 0..NEPH_TABULATED_MOMENTS */
    double given_integral;         /* of the values over the sphere, before they were normalised */
    /* Tables of red, green and blue, whose mean this table is; NULL where they do not differ. */
    const struct neph_phase_table *channels[3];
};

/* A table from scattering angles [degrees], 0 to 180 or 180 to 0 in order, and values >= 0; it is
 * normalised and lives in the arena. The values must have the integral 1 over the sphere, or 4 pi,
 * the other convention, each within 1 %; else NEPH_ERR_INPUT names the row, or the integral. */
enum neph_status neph_phase_table_make(int count, const double *angles_deg, const double *values,
                                       struct neph_arena *arena,
                                       const struct neph_phase_table **table,
                                       struct neph_diag *diag);

/* A table of three channels; `values` has the three of each row together. */
enum neph_status neph_phase_table_make_coloured(int count, const double *angles_deg,
                                                const double *values, struct neph_arena *arena,
                                                const struct neph_phase_table **table,
                                                struct neph_diag *diag);

/* The same from a text file: one row a line, an angle and a value, or an angle and the values of
 * red, green and blue, separated by white space or a comma; empty lines and what follows a # are
 * left out, and so is a first line of words. Errors name file and line. */
enum neph_status neph_phase_table_read(const char *path, struct neph_arena *arena,
                                       const struct neph_phase_table **table,
                                       struct neph_diag *diag);

double neph_phase_table_per_sr(const struct neph_phase_table *table, double versine);
/* The versine for a uniform number u in (0, 1); u = 1 is straight ahead. */
double neph_phase_table_versine(const struct neph_phase_table *table, double u);

/* Whether all rows are equal; NULL is only equal to NULL. */
bool neph_phase_table_is_same(const struct neph_phase_table *a, const struct neph_phase_table *b);

/* Writes its rows for the hash of a scene. */
void neph_phase_table_hash(const struct neph_phase_table *table, FILE *text);

#endif
