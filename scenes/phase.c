/* SPDX-License-Identifier: MIT */
#include "scenes/phase.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>

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

bool neph_phase_has(enum neph_phase_kind kind, enum neph_phase_parameter parameter)
{
    return (rows[kind]->parameters & parameter) != 0;
}

bool neph_phase_is_in_shaders(enum neph_phase_kind kind)
{
    return (int)kind < NEPH_PHASES_IN_SHADERS(NEPH_PHASE_ONE);
}

void neph_phase_describe(const struct neph_phase *phase, char *text, size_t size)
{
    const unsigned parameters = rows[phase->kind]->parameters;
    int used = snprintf(text, size, "%s", neph_phase_words[phase->kind]);
    const struct {
        bool is_shown;
        const char *name;
        double value;
    } shown[] = {
        {parameters == 0 || parameters & NEPH_PHASE_PARAMETER_G, "g", phase->g},
        {parameters & NEPH_PHASE_PARAMETER_LOBES, "second g", phase->second_g},
        {parameters & NEPH_PHASE_PARAMETER_LOBES, "first share", phase->first_share},
        {parameters & NEPH_PHASE_PARAMETER_ALPHA, "alpha", phase->draine_alpha},
        {parameters & NEPH_PHASE_PARAMETER_DIAMETER, "diameter um", phase->droplet_diameter_um},
    };
    for (size_t i = 0; i < sizeof(shown) / sizeof(shown[0]); i++)
        if (shown[i].is_shown && used >= 0 && (size_t)used < size)
            used += snprintf(text + used, size - (size_t)used, " %s %g", shown[i].name,
                             shown[i].value);
}

double neph_phase_per_sr(const struct neph_phase *phase, double cosine)
{
    return rows[phase->kind]->per_sr(phase, cosine);
}

double neph_phase_versine(const struct neph_phase *phase, double u)
{
    const double versine = rows[phase->kind]->versine(phase, u);
    return phase->g < 0.0 ? 2.0 - versine : versine;
}

double neph_phase_mean_cosine(const struct neph_phase *phase)
{
    return rows[phase->kind]->mean_cosine(phase);
}

double neph_phase_moment(const struct neph_phase *phase, int degree)
{
    return degree == 0 ? 1.0 : rows[phase->kind]->moment(phase, degree);
}
