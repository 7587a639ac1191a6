/* SPDX-License-Identifier: MIT */
#include "metrics/extractors/extractors.h"

#include <string.h>

#define LISTED(name) &neph_extractor_##name,
static const struct neph_extractor *const registry[] = {NEPH_EXTRACTORS(LISTED)};
#undef LISTED

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
