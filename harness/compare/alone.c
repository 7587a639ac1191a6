/* SPDX-License-Identifier: MIT */
#include "harness/compare/alone.h"

#include "metrics/extractors/extractors.h"

#include <string.h>

const char *const neph_alone_unknown =
    "no reference: change of the scene itself counts as flicker; bias and lag are not known";

/* Extractors of changes from frame to frame. */
static const char *const extractors[] = {"flicker", "cycles", "seen"};

/* Prefixes of their metrics that describe the reference, or levels instead of changes. */
static const char *const levels[] = {"reference_", "age_0_", "age_1_",
                                     "age_2_",     "age_3_", "phase_age_"};

bool neph_extractor_needs_no_reference(const struct neph_extractor *extractor)
{
    for (size_t i = 0; i < sizeof(extractors) / sizeof(extractors[0]); i++)
        if (strcmp(extractors[i], extractor->name) == 0)
            return true;
    return false;
}

bool neph_needs_no_reference(const struct neph_measurement *number, const void *context)
{
    const struct neph_extractor *owner = NULL;
    (void)context;
    neph_metric_find(number->metric->name, &owner);
    for (size_t i = 0; i < sizeof(levels) / sizeof(levels[0]); i++)
        if (strncmp(levels[i], number->metric->name, strlen(levels[i])) == 0)
            return false;
    return owner && neph_extractor_needs_no_reference(owner);
}
