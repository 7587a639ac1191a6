/* SPDX-License-Identifier: MIT */
#include "harness/report/tier.h"

#include <stddef.h>
#include <string.h>

/* A fog with lit ground, a slab, a cloud of optical depths of tens: every engine can do them, and
 * there is an exact answer to each. */
static const char *const quick_scenes[] = {"height_fog_down", "scattering_slab_above",
                                           "grid_cloud_single", NULL};
static const char *const quick_engines[] = {"exact",  "tracer", "march", "realtime",
                                            "cycles", "povray", NULL};
static const char *const quick_charts[] = {"slab", NULL};

static const struct neph_tier tiers[] = {
    {
        .name = "quick",
        .scenes = quick_scenes,
        .engines = quick_engines,
        .width_px = 128,
        .height_px = 72,
        .budget_s = 30.0,
        .charts = quick_charts,
        .chart_repeats = 1,
    },
    {
        .name = "full",
        .width_px = 192,
        .height_px = 108,
        .budget_s = 300.0,
        .chart_repeats = 3,
    },
    {.name = NULL},
};

const struct neph_tier *neph_tiers(void)
{
    return tiers;
}

const struct neph_tier *neph_tier_find(const char *name)
{
    for (const struct neph_tier *tier = tiers; tier->name; tier++)
        if (strcmp(tier->name, name) == 0)
            return tier;
    return NULL;
}
