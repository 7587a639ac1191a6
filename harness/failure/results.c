/* SPDX-License-Identifier: MIT */
#include "harness/failure/results.h"

#include <stdlib.h>

void neph_failure_count(struct neph_failure_suite *suite)
{
    struct neph_failure_counts *counts = &suite->counts;
    *counts = (struct neph_failure_counts){.compared = 0};
    for (int r = 0; r < suite->row_count; r++)
        for (int p = 0; p < suite->preset_count; p++) {
            const enum neph_failure_verdict verdict = suite->rows[r].cells[p].verdict;
            counts->verdicts[verdict]++;
            counts->compared += neph_failure_is_compared(verdict);
            counts->news += neph_failure_is_news(verdict);
        }
    suite->passes = counts->compared > 0 && counts->news == 0;
}

void neph_failure_finish(struct neph_failure_suite *suite)
{
    for (int s = 0; s < suite->scene_count; s++)
        neph_scene_destroy(suite->scenes[s]);
    free(suite->scenes);
    neph_arena_finish(&suite->arena);
    *suite = (struct neph_failure_suite){.scenes = NULL};
}
