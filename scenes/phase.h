/* SPDX-License-Identifier: MIT
 *
 * Phase functions: the distribution of scattered light over directions [1/sr], normalised over the
 * sphere. The kinds are listed in scenes/phase_kinds.h.
 */
#ifndef NEPH_SCENES_PHASE_H
#define NEPH_SCENES_PHASE_H

#include "scenes/phase_kinds.h"

#include <stdbool.h>
#include <stddef.h>

#define NEPH_PHASE_NUMBER(number, NAME, name) NEPH_PHASE_##NAME = number,
#define NEPH_PHASE_ONE(number, NAME, name) +1
enum neph_phase_kind { NEPH_PHASE_KINDS(NEPH_PHASE_NUMBER) };
enum { NEPH_PHASE_KIND_COUNT = NEPH_PHASE_KINDS(NEPH_PHASE_ONE) };

struct neph_phase_table; /* scenes/phase_table.h */

/* A kind and its parameters; those that the kind has not are 0. */
struct neph_phase {
    enum neph_phase_kind kind;
    double g;                   /* the asymmetry, of two lobes the first one's; -0.999..0.999 */
    double second_g;            /* of the second lobe, -0.999..0.999 */
    double first_share;         /* of the light, 0..1: in the first lobe */
    double draine_alpha;        /* 0: Henyey-Greenstein; 1: Cornette-Shanks */
    double droplet_diameter_um; /* 5..50 */
    const struct neph_phase_table *table; /* borrowed */
};

/* The parameters of struct neph_phase, as bits. */
enum neph_phase_parameter {
    NEPH_PHASE_PARAMETER_G = 1,
    NEPH_PHASE_PARAMETER_LOBES = 2, /* second_g and first_share */
    NEPH_PHASE_PARAMETER_ALPHA = 4,
    NEPH_PHASE_PARAMETER_DIAMETER = 8,
    NEPH_PHASE_PARAMETER_TABLE = 16,
};

/* A kind. The phase function for -g is the mirror image of the one for g, except with two lobes. */
struct neph_phase_row {
    const char *title;   /* "Rayleigh": for sentences */
    unsigned parameters; /* enum neph_phase_parameter */
    /* Cases for the checks of `neph validate --suite physics`. */
    int trial_count;
    const struct neph_phase *trials;
    /* The phase function [1/sr] of the cosine between the directions of travel before and after. */
    double (*per_sr)(const struct neph_phase *phase, double cosine);
    /* 1 - cos of that angle for a uniform number u in (0, 1), with |g| in place of g: the inverse
     * of its distribution, without cancellation at the forward peak. In 0..2. */
    double (*versine)(const struct neph_phase *phase, double u);
    /* The mean of that cosine. */
    double (*mean_cosine)(const struct neph_phase *phase);
    /* The mean of the Legendre polynomial of that degree >= 1 of that cosine. */
    double (*moment)(const struct neph_phase *phase, int degree);
};

const struct neph_phase_row *neph_phase_row(enum neph_phase_kind kind);

/* By kind: "isotropic", "henyey_greenstein", ..., the words of scene files; ends with NULL. */
extern const char *const neph_phase_words[];

bool neph_phase_has(enum neph_phase_kind kind, enum neph_phase_parameter parameter);
/* Whether it has a file in renderer/shaders/; all others reach the device as tables. */
bool neph_phase_is_in_shaders(enum neph_phase_kind kind);

/* Its word and parameters: "draine g 0.5 alpha 2". */
void neph_phase_describe(const struct neph_phase *phase, char *text, size_t size);

/* The functions of the rows; `versine` for g < 0, too. */
double neph_phase_per_sr(const struct neph_phase *phase, double cosine);
double neph_phase_versine(const struct neph_phase *phase, double u);
double neph_phase_mean_cosine(const struct neph_phase *phase);
/* `degree` >= 0; of a table at most NEPH_TABULATED_MOMENTS, else NaN. */
double neph_phase_moment(const struct neph_phase *phase, int degree);

#endif
