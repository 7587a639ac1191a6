/* SPDX-License-Identifier: MIT
 *
 * A run of the stress tests: its parameters and its results, which are filled while it runs.
 */
#ifndef NEPH_HARNESS_STRESS_RESULTS_H
#define NEPH_HARNESS_STRESS_RESULTS_H

#include "base/arena.h"
#include "harness/engines/engine.h"
#include "scenes/failing.h"
#include "scenes/scene.h"

enum { NEPH_STRESS_COLUMNS_MAX = 24, NEPH_STRESS_JOBS_MAX = 64 };

/* ---- verdicts --------------------------------------------------------------------------------
 *
 * On a number, by its limit and by the expectation for it: failures that are known are written down
 * with their reason, and a known failure that passes is as new as a failure that was not known (as
 * in dEQP). */

enum neph_stress_expected {
    NEPH_STRESS_PASSES, /* without an expectation */
    NEPH_STRESS_FAILS,
    NEPH_STRESS_FLAKES, /* passes on some devices and fails on others */
    NEPH_STRESS_SKIPS,  /* is not measured */
    NEPH_STRESS_EXPECTED_COUNT,
};

enum neph_stress_verdict {
    NEPH_STRESS_NOT_ASKED, /* no preset or engine of the scene */
    NEPH_STRESS_NOT_YET,   /* of a run that goes on */
    NEPH_STRESS_PASS,
    NEPH_STRESS_FAIL,
    NEPH_STRESS_KNOWN_FAIL,
    NEPH_STRESS_NEW_PASS, /* expected to fail, and does not */
    NEPH_STRESS_FLAKE,    /* failed, as it may */
    NEPH_STRESS_SKIP,
    NEPH_STRESS_NO_NUMBER,    /* there is nothing to measure, or it broke */
    NEPH_STRESS_CANNOT,       /* an engine that does not model the scene */
    NEPH_STRESS_MISSING,      /* an engine that is not installed */
    NEPH_STRESS_NOT_RENDERED, /* an engine that took longer than its limit */
    NEPH_STRESS_VERDICTS,
};

struct neph_stress_verdict_info {
    const char *name, *mark; /* of documents; behind a number of the table, or in its place */
    bool is_news;            /* it fails a run */
    bool is_compared;        /* a number was compared with a limit */
    bool is_failure;         /* the number is over its limit, expected or not: it is drawn */
    int rank;                /* the less, the worse */
};

extern const struct neph_stress_verdict_info neph_stress_verdicts[NEPH_STRESS_VERDICTS];

/* `value` <= `limit` passes; NaN: there is no number. */
enum neph_stress_verdict neph_stress_judge(double value, double limit,
                                           enum neph_stress_expected expected);

/* ---- a run ----------------------------------------------------------------------------------- */

/* Cells that there is evidence of. */
enum neph_stress_pictures {
    NEPH_STRESS_PICTURES_FAILED,  /* failures, known or not, and known ones that pass */
    NEPH_STRESS_PICTURES_CHANGED, /* verdicts that are not expected */
    NEPH_STRESS_PICTURES_ALL,
    NEPH_STRESS_PICTURES_NONE,
    NEPH_STRESS_PICTURES_COUNT,
};

struct neph_stress_page;

/* How far a run is. */
enum neph_stress_state {
    NEPH_STRESS_RUNNING,
    NEPH_STRESS_FINISHED,
    NEPH_STRESS_INTERRUPTED,
    NEPH_STRESS_STATE_COUNT,
};

struct neph_stress_params {
    bool full;               /* all scenarios, presets and points of sweeps; else the quick tier */
    const char *const *only; /* scenarios by name, whatever their tier; only_count 0: of the tier */
    int only_count;
    const char *const *presets; /* "NAME" or "NAME+KEY=VALUE+..." */
    int preset_count;
    const char *const *engines; /* beside or without presets; of both none: those of the tier */
    int engine_count;
    enum neph_stress_pictures pictures;
    int width_px, height_px; /* 0: sizes of the scenarios. At another size only bad values are
                                judged: limits hold at their own */
    bool on_device; /* only bad values, in all images of all passes, counted on the device; nothing
                       is kept, not even in the store */
    int jobs;       /* processes that render at the same time, 1 .. */
    struct neph_shared_device *device; /* as neph_shot.device */
    bool quiet;
    const struct neph_stress_page *page; /* published while the run goes on; NULL: none is */
};

/* A preset of `realtime`; a user engine ("command"), which takes part as one; or an engine that
 * renders each frame independently. */
struct neph_stress_column {
    const char *name;
    const struct neph_engine *engine;
    bool is_preset;
};

/* One number over a column. */
struct neph_stress_cell {
    double value; /* NaN: none; may be infinite */
    enum neph_stress_verdict verdict;
    const char *why;      /* the expectation's reason, or why there is no number; or "" */
    const char *evidence; /* folder of the evidence of its column and point (evidence.h), or NULL */
    const char *frame_key; /* in the store, of the last frame of its column and point, or NULL */
};

/* One measure of one point of a scenario. Texts are of the arena or of the scene. */
struct neph_stress_row {
    const struct neph_scene *scene; /* the scenario as its file is */
    int point_index;
    const char *point;
    const struct neph_failing_limit *limit;
    struct neph_stress_cell *cells; /* one per column */
};

struct neph_stress_counts {
    int verdicts[NEPH_STRESS_VERDICTS];
    int compared, news;
};

/* Start from {0}; free with _finish. */
struct neph_stress_suite {
    struct neph_arena arena;
    enum neph_stress_state state;
    bool full;
    int width_px, height_px; /* 0: those of the scenarios */
    bool on_device;          /* only bad values were counted, there */
    char device[128];
    int column_count;
    struct neph_stress_column columns[NEPH_STRESS_COLUMNS_MAX];
    int scene_count, row_count;
    struct neph_scene **scenes; /* owned, and their list in the arena */
    struct neph_stress_row *rows;
    struct neph_stress_counts counts;
    bool passes; /* nothing new, and something was compared */
    double seconds;
    int frame_count; /* of all takes, rendered now or taken from the store */
    int steps_done, steps_total;
    double left_s; /* until all is done; negative: not known */
};

void neph_stress_finish(struct neph_stress_suite *suite);

/* Count the verdicts. */
void neph_stress_count(struct neph_stress_suite *suite);

/* How far a cell is over its limit, 1 at the limit; of limit 0 infinite, and NaN where there is no
 * number. */
double neph_stress_excess(const struct neph_stress_row *row, const struct neph_stress_cell *cell);

/* A cell of a run. */
struct neph_stress_spot {
    const struct neph_stress_row *row;
    int column;
};

/* All cells of presets and engines of their scene, for the caller to free; NULL when memory is
 * short. The worst is first: by its verdict, then by how far it is over its limit, then
 * as in the run. */
struct neph_stress_spot *neph_stress_worst(const struct neph_stress_suite *suite, int *count);

#endif
