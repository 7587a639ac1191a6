/* SPDX-License-Identifier: MIT
 *
 * The findings of a comparison, sorted worst first, and the verdict that follows from them.
 */
#include "harness/night/compare.h"

#include <math.h>
#include <string.h>

/* Compiles only when this file handles every kind. */
_Static_assert(NEPH_FOUND_COUNT == 14, "a new kind");

static const char *const found_words[] = {
    [NEPH_FOUND_STEP] = "step failed",
    [NEPH_FOUND_HISTORY] = "history damaged",
    [NEPH_FOUND_BITS] = "not the same bits",
    [NEPH_FOUND_STALE] = "reference stale",
    [NEPH_FOUND_BLANK] = "blank picture",
    [NEPH_FOUND_MISSING] = "missing",
    [NEPH_FOUND_LOST] = "lost",
    [NEPH_FOUND_SIZE] = "another size",
    [NEPH_FOUND_WORSE] = "worse",
    [NEPH_FOUND_WORSE_ELSEWHERE] = "worse elsewhere",
    [NEPH_FOUND_EDITED] = "edited",
    [NEPH_FOUND_BETTER] = "better",
    [NEPH_FOUND_ENVIRONMENT] = "environment",
    [NEPH_FOUND_MOVED] = "moved",
};

const char *neph_found_word(enum neph_found found)
{
    return found_words[found];
}

bool neph_found_fails(enum neph_found found)
{
    return found < NEPH_FOUND_BETTER;
}

/* Order: worst kind first; within a kind by change divided by floor, largest first. */
static int by_weight(const struct neph_finding *a, const struct neph_finding *b)
{
    if (a->found != b->found)
        return a->found < b->found ? -1 : 1;
    const double of_a = isfinite(a->change) ? fabs(a->change) / fmax(a->floor, 1e-9) : 0.0;
    const double of_b = isfinite(b->change) ? fabs(b->change) / fmax(b->floor, 1e-9) : 0.0;
    return of_a != of_b ? (of_a > of_b ? -1 : 1) : strcmp(a->series, b->series);
}

void neph_night_settle(struct neph_night_comparison *comparison)
{
    comparison->passes = comparison->compared > 0 &&
                         (comparison->finding_count == 0 ||
                          !neph_found_fails(comparison->findings[0].found));
}

void neph_night_add_finding(struct neph_night_comparison *comparison,
                            const struct neph_finding *finding)
{
    struct neph_finding *grown = neph_arena_grow_list(&comparison->arena, comparison->findings,
                                                      comparison->finding_count,
                                                      &comparison->finding_room, sizeof(*grown));
    if (!grown)
        return;
    comparison->findings = grown;
    int at = comparison->finding_count++;
    for (; at > 0 && by_weight(&comparison->findings[at - 1], finding) > 0; at--)
        comparison->findings[at] = comparison->findings[at - 1];
    comparison->findings[at] = *finding;
    neph_night_settle(comparison);
}

struct neph_finding neph_finding(enum neph_found found, const char *series, const char *step,
                                 const char *words)
{
    return (struct neph_finding){.found = found,
                                 .series = series,
                                 .step = step,
                                 .words = words,
                                 .tonight = NAN,
                                 .baseline = NAN,
                                 .change = NAN,
                                 .p = NAN,
                                 .floor = NAN,
                                 .standard_error = NAN,
                                 .example = ""};
}

struct neph_night_verdict neph_night_verdict(const struct neph_night_comparison *comparison)
{
    if (comparison->passes)
        return (struct neph_night_verdict){"pass", "passes"};
    if (comparison->compared == 0)
        return (struct neph_night_verdict){"nothing compared", "compared nothing"};
    return (struct neph_night_verdict){"fail", "fails"};
}

void neph_night_comparison_finish(struct neph_night_comparison *comparison)
{
    neph_arena_finish(&comparison->arena);
    *comparison = (struct neph_night_comparison){.night = 0};
}
