/* SPDX-License-Identifier: MIT
 *
 * What a run of the main job found: scenes, the frames of all engines, their numbers, gates and
 * verdicts. Filled while it runs; whoever prints it or writes it as JSON only reads.
 */
#ifndef NEPH_HARNESS_REPORT_VALIDATION_H
#define NEPH_HARNESS_REPORT_VALIDATION_H

#include "base/arena.h"
#include "harness/compare/measure.h"
#include "harness/document/junit.h"
#include "harness/engines/bakes.h"
#include "harness/engines/engines.h"
#include "harness/physics/results.h"
#include "harness/report/attribution.h"
#include "harness/report/charts.h"
#include "harness/report/error_parts.h"
#include "harness/report/over_time.h"
#include "harness/run/job.h"
#include "harness/run/speed.h"
#include "harness/study/study.h"

#include <stdio.h>

enum { NEPH_FIELD_MAX = NEPH_ENGINE_COUNT };

/* The engines of a run, probed once. */
struct neph_run_engines {
    int count;
    const struct neph_engine *engines[NEPH_FIELD_MAX];
    struct neph_engine_info infos[NEPH_FIELD_MAX];
    struct neph_settings settings[NEPH_FIELD_MAX]; /* those that the user wants */
    /* Engines that --only-engine adds: each renders only scenes without an earlier reference. */
    bool is_reference_only[NEPH_FIELD_MAX];
};

/* What difference maps are drawn of. */
enum neph_shown { NEPH_SHOWN_RADIANCE, NEPH_SHOWN_TRANSMITTANCE, NEPH_SHOWN_COUNT };

const char *neph_shown_name(enum neph_shown which);

/* One engine's picture of a scene. Texts are of the validation's arena, here as below. */
struct neph_frame_result {
    const struct neph_engine *engine;
    enum neph_outcome outcome;
    const char *reason;    /* "" of a rendered frame */
    const char *note;      /* what it lacks of what was asked for or claims no physics in, or "" */
    bool is_look;          /* it claims no physics: its engine, or by its settings */
    const char *settings;  /* canonical */
    bool reused;           /* taken from the store */
    struct neph_cost cost; /* of the one render that made it, start-up included */
    struct neph_speed speed; /* of warm frames, start-up apart; repeats 0: not measured */
    struct neph_job job;     /* that rendered it; without the scene */
    double noise;            /* standard error of a pixel over the rms radiance; NaN: it has none */
    uint64_t seed;
    double step_optical_depth;      /* the most that a step spans; NaN: it has no fixed steps */
    const char *path;               /* of the frame in the store; NULL unless rendered */
    const char *second_path;        /* by a second seed; NULL: none */
    struct neph_cost second_cost;   /* of that one */
    const struct neph_study *study; /* that chose its step; NULL: none */
    const struct neph_bakes_summary *bakes; /* of the grids that it saw; NULL: none */
    struct neph_measurements measurements;  /* owned */
    struct neph_error_parts error_parts;    /* against the truth; all 0 of the truth itself */
    const char *picture, *differences[NEPH_SHOWN_COUNT]; /* inside the report; NULL: none (yet) */
};

enum neph_gate_verdict {
    NEPH_GATE_PASS,
    NEPH_GATE_FAIL,
    NEPH_GATE_NOT_MEASURED,
    NEPH_GATE_VERDICT_COUNT
};

struct neph_gate_result {
    const char *engine, *quantity, *metric, *mask;
    double value; /* NaN: not measured */
    double maximum;
    enum neph_gate_verdict verdict;
    const char *reason;
    int line; /* in the scene file; 0: it is the limit of what no gate of the scene names */
};

struct neph_scene_result {
    const char *name, *title, *physics, *hash;
    const char *file;        /* of the scene, as it was named */
    int width_px, height_px; /* of its frames */
    struct neph_viewing viewing;
    int frame_count;    /* one per engine of the field that renders this scene, in its order */
    int left_out_count; /* engines that --only-engine added, and that render it not */
    struct neph_frame_result *frames;
    int truth; /* index of the frame that the others are measured against; -1: there is none */
    double difference_scales[NEPH_SHOWN_COUNT]; /* the ends of the colour scales */
    int gate_count; /* those of the scene; and one for each ungated frame that is far off */
    struct neph_gate_result *gates;
    int ungated_count; /* frames that claim physics and have a radiance that no gate limits */
    const struct neph_attribution *attribution; /* NULL: nobody to tell apart */
    const char *viewer;                         /* its page inside the report; NULL: none (yet) */
    const char *no_viewer; /* why there is none; NULL: there is one, or no picture, or not yet */
    bool is_drawn;
};

/* A scene of the catalogue whose data is not here. */
struct neph_absent_scene {
    const char *scene, *reason, *hint;
};

enum neph_verdict {
    NEPH_VERDICT_PASS,
    NEPH_VERDICT_FAIL,
    NEPH_VERDICT_RUNNING,
    NEPH_VERDICT_INTERRUPTED,
    NEPH_VERDICT_COUNT,
};

/* What a verdict stands on. */
struct neph_counts {
    int expected; /* frames: over all scenes that are here, their engines; in the physics suite,
                     rows */
    int reported; /* of them in the report, with their outcome */
    int compared; /* of these, measured against the truth */
    int ungated;  /* of these, limited by a factor of two only: harness/report/gates.c */
};

/* Start from {0}; free with neph_validation_finish(). */
struct neph_validation {
    struct neph_arena arena;
    const char *title;
    char created_utc[32];
    int width_px, height_px; /* of frames of scenes that have no size of their own */
    struct neph_run_engines field;
    int scene_count, absent_count, chart_count;
    struct neph_scene_result *scenes;
    struct neph_absent_scene *absent;
    struct neph_chart *charts;
    struct neph_over_time *over_time; /* NULL: none */
    struct neph_physics *physics;     /* owned by the caller; NULL: none */
    enum neph_verdict verdict;
    struct neph_counts counts;
    double seconds;
    int steps_done, steps_total; /* while it is running, and when it was interrupted */
    double left_s;               /* negative: not known */
    bool interactive;            /* the report has what interactive charts need */
    bool has_screen;             /* and the page of `neph study screen` */
};

void neph_validation_finish(struct neph_validation *validation);

/* What of a scene is not the arena's; it becomes {0}. */
void neph_scene_result_finish(struct neph_scene_result *scene);

/* Count and judge what is there; `expected` frames were to be rendered. A failed gate or an engine
 * that broke fails the run, a missing one does not. Nor does a run pass that lost a frame or
 * compared none. */
void neph_validation_judge(struct neph_validation *validation, int expected);

/* Judge the gates of a scene whose frames are measured: result->gates, in the arena. A frame that
 * no gate of the scene limits has one there when it fails. */
void neph_gates_judge(const struct neph_scene *scene, struct neph_arena *arena,
                      struct neph_scene_result *result);

/* Whether a gate of the scene limits this quantity of an engine's frame. */
bool neph_scene_is_gated(const struct neph_scene_result *scene, const char *engine,
                         const char *quantity);

/* As data.json, whose form is written down in scripts/report/README.md. NULL when memory is short
 * or a text is not UTF-8. */
json_t *neph_validation_json(const struct neph_validation *validation);

/* A test case for each frame and each gate of the scenes, for each row of the physics suite, and
 * for the verdict of the run. */
void neph_validation_junit(const struct neph_validation *validation, struct neph_junit *junit);

/* For people: a line for each frame, and what is to be said of it below. */
void neph_validation_print(const struct neph_validation *validation, FILE *out);

/* "pass", and which engines the verdict is without, and in how many scenes: those that are not
 * installed, did not fit their budget, or have fewer samples than were set. No line break. */
void neph_validation_print_verdict(const struct neph_validation *validation, FILE *out);

const char *neph_verdict_name(enum neph_verdict verdict);
const char *neph_gate_verdict_name(enum neph_gate_verdict verdict);

#endif
