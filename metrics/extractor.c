/* SPDX-License-Identifier: MIT */
#include "metrics/extractor.h"

#include "metrics/extractors/extractors.h"

#include <string.h>

static const struct neph_extractor *const registry[] = {
    &neph_extractor_error,
    &neph_extractor_stops,
    &neph_extractor_pu21,
    &neph_extractor_ssim,
    &neph_extractor_shift,
    &neph_extractor_two_seed,
    &neph_extractor_flip,
    &neph_extractor_flip40,
    &neph_extractor_hdr_flip,
    &neph_extractor_flip_alternation,
    &neph_extractor_residual_change,
    &neph_extractor_motion,
    &neph_extractor_lag,
    &neph_extractor_trail,
    &neph_extractor_flicker,
};

enum { EXTRACTOR_COUNT = sizeof(registry) / sizeof(registry[0]) };

int neph_extractor_count(void)
{
    return EXTRACTOR_COUNT;
}

const struct neph_extractor *neph_extractor_at(int index)
{
    return index >= 0 && index < EXTRACTOR_COUNT ? registry[index] : NULL;
}

const struct neph_extractor *neph_extractor_find(const char *name)
{
    for (int i = 0; i < EXTRACTOR_COUNT; i++)
        if (strcmp(registry[i]->name, name) == 0)
            return registry[i];
    return NULL;
}

const struct neph_metric *neph_metric_find(const char *name, const struct neph_extractor **owner)
{
    for (int i = 0; i < EXTRACTOR_COUNT; i++) {
        for (const struct neph_metric *metric = registry[i]->metrics; metric->name; metric++) {
            if (strcmp(metric->name, name) != 0)
                continue;
            if (owner)
                *owner = registry[i];
            return metric;
        }
    }
    return NULL;
}
