/* SPDX-License-Identifier: MIT
 *
 * Phase functions: the distribution of scattered light over directions [1/sr], normalised over the
 * sphere. The kinds are listed in scenes/phase_kinds.h.
 */
#ifndef NEPH_SCENES_PHASE_H
#define NEPH_SCENES_PHASE_H

#include "scenes/phase_kinds.h"

#include <stdbool.h>

#define NEPH_PHASE_NUMBER(number, NAME, name) NEPH_PHASE_##NAME = number,
#define NEPH_PHASE_ONE(number, NAME, name) +1
enum neph_phase_kind { NEPH_PHASE_KINDS(NEPH_PHASE_NUMBER) };
enum { NEPH_PHASE_KIND_COUNT = NEPH_PHASE_KINDS(NEPH_PHASE_ONE) };

struct neph_phase {
    enum neph_phase_kind kind;
    double g; /* the asymmetry, -0.999..0.999; 0 of a kind without one */
};

enum { NEPH_PHASE_TRIALS_MAX = 12 };

/* A kind. Functions get g, or 0 for kinds without asymmetry. The phase function for -g is the
 * mirror image of the one for g. */
struct neph_phase_row {
    const char *title;  /* "Rayleigh": for sentences */
    bool has_asymmetry; /* g is a parameter */
    /* Values of g for the checks of `neph validate --suite physics`. */
    int trial_count;
    double trials[NEPH_PHASE_TRIALS_MAX];
    /* The phase function [1/sr] of the cosine between the directions of travel before and after. */
    double (*per_sr)(double g, double cosine);
    /* 1 - cos of that angle for a uniform number u in (0, 1), g >= 0: the inverse of its
     * distribution, without cancellation at the forward peak. In 0..2. */
    double (*versine)(double g, double u);
    /* The mean of that cosine. */
    double (*mean_cosine)(double g);
    /* The mean of the Legendre polynomial of that degree >= 1 of that cosine. */
    double (*moment)(double g, int degree);
};

const struct neph_phase_row *neph_phase_row(enum neph_phase_kind kind);

/* By kind: "isotropic", "henyey_greenstein", ..., the words of scene files; ends with NULL. */
extern const char *const neph_phase_words[];

/* The functions of the rows; `versine` for g < 0, too. */
double neph_phase_per_sr(const struct neph_phase *phase, double cosine);
double neph_phase_versine(const struct neph_phase *phase, double u);
double neph_phase_mean_cosine(const struct neph_phase *phase);
double neph_phase_moment(const struct neph_phase *phase, int degree); /* >= 0 */

#endif
