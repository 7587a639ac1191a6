/* SPDX-License-Identifier: MIT
 *
 * Tiers: how much of the main job is run. One table; what a tier has is what its report shows.
 */
#ifndef NEPH_HARNESS_REPORT_TIER_H
#define NEPH_HARNESS_REPORT_TIER_H

#include <stdbool.h>

struct neph_tier {
    const char *name;
    const char *const *scenes;  /* of the catalogue, NULL-terminated; NULL: all of it */
    const char *const *engines; /* NULL-terminated; NULL: every engine that is no shortcut */
    int width_px, height_px;    /* of the scenes' pictures */
    double budget_s;            /* of each picture of another project's renderer */
    const char *const *charts;  /* ids, NULL-terminated; NULL: all */
    int chart_repeats;          /* runs of each point of a chart */
};

/* All tiers, the default first; ends with a NULL name. */
const struct neph_tier *neph_tiers(void);

/* By name; NULL when there is none. */
const struct neph_tier *neph_tier_find(const char *name);

#endif
