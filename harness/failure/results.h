/* SPDX-License-Identifier: MIT
 *
 * A run of the failure suite: what it was asked for, and what it found. Filled while it runs;
 * whoever prints it or writes it as JSON only reads.
 */
#ifndef NEPH_HARNESS_FAILURE_RESULTS_H
#define NEPH_HARNESS_FAILURE_RESULTS_H

#include "base/arena.h"
#include "harness/failure/verdict.h"
#include "scenes/scene.h"

enum { NEPH_FAILURE_PRESETS_MAX = 16, NEPH_FAILURE_JOBS_MAX = 64 };

struct neph_failure_params {
    bool full;               /* all scenarios, presets and points of sweeps; else the quick tier */
    const char *const *only; /* scenarios by name, whatever their tier; only_count 0: of the tier */
    int only_count;
    const char *const *presets; /* "NAME" or "NAME+KEY=VALUE+..."; preset_count 0: of the tier */
    int preset_count;
    int width_px, height_px; /* 0: those of the scenarios. Of another size bad values alone are
                                judged: limits hold at their own */
    int jobs;                /* processes that render at the same time, 1 .. */
    bool quiet;
};

/* One number over a preset. */
struct neph_failure_cell {
    double value; /* NaN: none; may be infinite */
    enum neph_failure_verdict verdict;
    const char *why; /* of what is expected, or why there is no number; or "" */
};

/* One measure of one point of a scenario. Texts are of the arena or of the scene. */
struct neph_failure_row {
    const struct neph_scene *scene; /* the scenario as its file is */
    int point_index;
    const char *point;
    const struct neph_failing_limit *limit;
    struct neph_failure_cell *cells; /* one per preset */
};

struct neph_failure_counts {
    int verdicts[NEPH_FAILURE_VERDICTS];
    int compared, news;
};

/* Start from {0}; free with _finish. */
struct neph_failure_suite {
    struct neph_arena arena;
    char device[128];
    int preset_count;
    const char *presets[NEPH_FAILURE_PRESETS_MAX];
    int scene_count, row_count;
    struct neph_scene **scenes; /* owned */
    struct neph_failure_row *rows;
    struct neph_failure_counts counts;
    bool passes; /* nothing new, and something was compared */
    double seconds;
    int frame_count; /* of all takes, rendered now or taken from the store */
};

void neph_failure_finish(struct neph_failure_suite *suite);

/* Count the verdicts. */
void neph_failure_count(struct neph_failure_suite *suite);

#endif
