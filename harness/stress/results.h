/* SPDX-License-Identifier: MIT
 *
 * A run of the stress tests: its parameters, and its results, which are filled in during the run.
 */
#ifndef NEPH_HARNESS_STRESS_RESULTS_H
#define NEPH_HARNESS_STRESS_RESULTS_H

#include "base/arena.h"
#include "harness/engines/engine.h"
#include "harness/study/flicker_study.h"
#include "scenes/failing.h"
#include "scenes/scene.h"

enum {
    NEPH_STRESS_COLUMNS_MAX = 24,
    NEPH_STRESS_TRIAL_COLUMNS_MAX = (1 + NEPH_STUDY_FLOOR_CANDIDATES) * NEPH_STRESS_COLUMNS_MAX,
    NEPH_STRESS_JOBS_MAX = 64
};

/* ---- verdicts --------------------------------------------------------------------------------
 *
 * The verdict on a value follows from its limit and its expectation. Known failures are listed with
 * their reasons; a known failure that passes is as unexpected as a new failure (as in dEQP). */

enum neph_stress_expected {
    NEPH_STRESS_PASSES, /* no expectation is listed */
    NEPH_STRESS_FAILS,
    NEPH_STRESS_FLAKES, /* passes on some devices and fails on others */
    NEPH_STRESS_SKIPS,  /* not measured */
    NEPH_STRESS_EXPECTED_COUNT,
};

enum neph_stress_verdict {
    NEPH_STRESS_NOT_PLANNED, /* not a preset or engine of the scenario */
    NEPH_STRESS_NOT_YET,     /* not measured yet, in a run that continues */
    NEPH_STRESS_PASS,
    NEPH_STRESS_FAIL,
    NEPH_STRESS_KNOWN_FAIL,
    NEPH_STRESS_NEW_PASS, /* expected to fail, but passes */
    NEPH_STRESS_FLAKE,    /* failed, as a flake may */
    NEPH_STRESS_SKIP,
    NEPH_STRESS_NO_NUMBER,    /* no value: nothing to measure, or rendering failed */
    NEPH_STRESS_CANNOT,       /* the engine does not model the scene */
    NEPH_STRESS_MISSING,      /* the engine is not installed */
    NEPH_STRESS_NOT_RENDERED, /* the engine exceeded its time limit */
    NEPH_STRESS_VERDICTS,
};

struct neph_stress_verdict_info {
    const char *name, *mark; /* name in documents; mark beside a value in the table, or in place of
                                one */
    bool is_unexpected;      /* unexpected: fails a run */
    bool is_compared;        /* a value was compared with its limit */
    bool is_failure;         /* the value exceeds its limit, expected or not; evidence is drawn */
    int rank;                /* order by severity, 0 is the worst */
};

extern const struct neph_stress_verdict_info neph_stress_verdicts[NEPH_STRESS_VERDICTS];

/* `value` <= `limit` passes; NaN: no value. */
enum neph_stress_verdict neph_stress_judge(double value, double limit,
                                           enum neph_stress_expected expected);

/* ---- a run ----------------------------------------------------------------------------------- */

/* Cells with evidence images. */
enum neph_stress_images {
    NEPH_STRESS_IMAGES_FAILED,  /* failures, known or not, and unexpected passes */
    NEPH_STRESS_IMAGES_CHANGED, /* unexpected results */
    NEPH_STRESS_IMAGES_ALL,
    NEPH_STRESS_IMAGES_NONE,
    NEPH_STRESS_IMAGES_COUNT,
};

struct neph_stress_page;

/* State of a run. */
enum neph_stress_state {
    NEPH_STRESS_RUNNING,
    NEPH_STRESS_FINISHED,
    NEPH_STRESS_INTERRUPTED,
    NEPH_STRESS_STATE_COUNT,
};

struct neph_stress_params {
    bool full;               /* all scenarios, presets and sweep points; otherwise the quick tier */
    const char *const *only; /* scenarios by name, of any tier; only_count 0: all of the tier */
    int only_count;
    const char *const *presets; /* "NAME" or "NAME+KEY=VALUE+..." */
    int preset_count;
    const char *const *engines; /* with or without presets; without both: the tier's columns */
    int engine_count;
    enum neph_stress_images pictures;
    int width_px, height_px; /* 0: the scenarios' sizes. At other sizes only bad values are judged,
                                as limits apply to the scenario's size */
    bool on_device; /* only bad values, counted on the device in all images of all passes; nothing
                       is kept or stored */
    int jobs;       /* number of rendering processes, from 1 on */
    struct neph_shared_device *device; /* like neph_shot.device */
    bool quiet;
    const struct neph_stress_page *page; /* published during the run; NULL: no page */
};

/* A preset of `realtime`; a user engine ("command"), treated like a preset; or an engine that
 * renders each frame independently. */
struct neph_stress_column {
    const char *name;
    const struct neph_engine *engine;
    bool is_preset;
};

/* One value in a column. */
struct neph_stress_cell {
    double value; /* NaN: none; can be infinite */
    enum neph_stress_verdict verdict;
    const char *why;       /* the expectation's reason, the reason for a missing value, or "" */
    const char *evidence;  /* folder of the evidence of this column and point (evidence.h); NULL:
                              none */
    const char *frame_key; /* store key of the sequence of this column and point; NULL: none */
};

/* One measure at one sweep point of a scenario. Texts are in the arena or belong to the scene. */
struct neph_stress_row {
    const struct neph_scene *scene; /* the scenario as in its file */
    int point_index;
    const char *point;
    const struct neph_failing_limit *limit;
    bool is_moving;                 /* camera, light, media or solids move: it can have floors */
    struct neph_stress_cell *cells; /* one per column, then one per floor */
};

struct neph_stress_counts {
    int verdicts[NEPH_STRESS_VERDICTS];
    int compared, news;
};

/* Initialise with {0}; free with neph_stress_finish(). */
struct neph_stress_suite {
    struct neph_arena arena;
    enum neph_stress_state state;
    bool full;
    int width_px, height_px; /* 0: the scenarios' sizes */
    bool on_device;          /* only bad values were counted, on the device */
    char device[128];
    int column_count, floor_count;
    struct neph_stress_column columns[NEPH_STRESS_TRIAL_COLUMNS_MAX]; /* then the floors */
    struct neph_study_floor floors[NEPH_STRESS_COLUMNS_MAX]; /* of presets: columns (floors.h) */
    bool has_floors;                                         /* false: floors are not measured */
    int scene_count, row_count;
    struct neph_scene **scenes; /* owned; the list is in the arena */
    struct neph_stress_row *rows;
    struct neph_stress_counts counts;
    bool passes; /* no unexpected result, and at least one comparison */
    double seconds;
    int frame_count; /* frames of all sequences, rendered or from the store */
    int steps_done, steps_total;
    double left_s; /* estimated remaining time; negative: not known */
};

/* Destroys the scenes and frees all results. */
void neph_stress_finish(struct neph_stress_suite *suite);

/* Updates `counts` and `passes`. */
void neph_stress_count(struct neph_stress_suite *suite);

/* The value relative to its limit: 1 at the limit; infinite above a limit of 0; NaN without a
 * value. */
double neph_stress_excess(const struct neph_stress_row *row, const struct neph_stress_cell *cell);

/* A cell of a run. */
struct neph_stress_cell_id {
    const struct neph_stress_row *row;
    int column;
};

/* All cells that belong to presets or engines of their scenario, worst first, for free(); NULL: out
 * of memory. Sorted by verdict, then by excess over the limit, then in the order of the run. */
struct neph_stress_cell_id *neph_stress_worst(const struct neph_stress_suite *suite, int *count);

#endif
