/* SPDX-License-Identifier: MIT */
#include "scenes/phase.h"

#include <math.h>
#include <stddef.h>

#define DECLARED(number, NAME, name) extern const struct neph_phase_row neph_phase_##name;
NEPH_PHASE_KINDS(DECLARED)

#define ROW(number, NAME, name) [NEPH_PHASE_##NAME] = &neph_phase_##name,
static const struct neph_phase_row *const rows[NEPH_PHASE_KIND_COUNT] = {NEPH_PHASE_KINDS(ROW)};

#define WORD(number, NAME, name) [NEPH_PHASE_##NAME] = #name,
const char *const neph_phase_words[NEPH_PHASE_KIND_COUNT + 1] = {NEPH_PHASE_KINDS(WORD)};

const struct neph_phase_row *neph_phase_row(enum neph_phase_kind kind)
{
    return rows[kind];
}

double neph_phase_per_sr(const struct neph_phase *phase, double cosine)
{
    return rows[phase->kind]->per_sr(phase->g, cosine);
}

double neph_phase_versine(const struct neph_phase *phase, double u)
{
    const double versine = rows[phase->kind]->versine(fabs(phase->g), u);
    return phase->g < 0.0 ? 2.0 - versine : versine;
}

double neph_phase_mean_cosine(const struct neph_phase *phase)
{
    return rows[phase->kind]->mean_cosine(phase->g);
}

double neph_phase_moment(const struct neph_phase *phase, int degree)
{
    return degree == 0 ? 1.0 : rows[phase->kind]->moment(phase->g, degree);
}
