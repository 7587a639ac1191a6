/* SPDX-License-Identifier: MIT
 *
 * The results of `neph validate`: scenes, frames of all engines, their measurements, gates and
 * verdicts. Filled while the run proceeds; the writers of text, JSON and JUnit XML only read it.
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
    struct neph_settings settings[NEPH_FIELD_MAX]; /* with the user's changes */
    /* Engines that --only-engine adds. They render only scenes without an earlier reference. */
    bool is_reference_only[NEPH_FIELD_MAX];
};

/* The quantities with difference maps. */
enum neph_shown { NEPH_SHOWN_RADIANCE, NEPH_SHOWN_TRANSMITTANCE, NEPH_SHOWN_COUNT };

const char *neph_shown_name(enum neph_shown which);

/* One engine's frame of a scene. Texts of this file's structs are allocated in the validation's
 * arena. */
struct neph_frame_result {
    const struct neph_engine *engine;
    enum neph_outcome outcome;
    const char *reason;      /* "" for a rendered frame */
    const char *note;        /* missing samples or a non-physical part, or "" */
    bool is_look;            /* a non-physical model, by its engine or its settings */
    const char *settings;    /* canonical text */
    bool reused;             /* taken from the store */
    struct neph_cost cost;   /* of the render that made it, start-up included */
    struct neph_speed speed; /* of warm frames, without start-up; repeats 0: not measured */
    struct neph_job job;     /* the job that rendered it, without the scene */
    double noise;            /* standard error of a pixel over the RMS radiance; NaN: none */
    double noise_doubt;      /* of the noise (base/doubt.h); NaN: not known */
    uint64_t seed;
    double step_optical_depth;              /* largest of a step; NaN: no fixed steps */
    const char *path;                       /* of the frame in the store; NULL: not rendered */
    const char *second_path;                /* frame of a second seed; NULL: none */
    struct neph_cost second_cost;           /* of the second frame */
    const struct neph_study *study;         /* the step study that chose its step; NULL: none */
    const struct neph_bakes_summary *bakes; /* of its voxel grids; NULL: none */
    struct neph_measurements measurements;  /* owned */
    struct neph_error_parts error_parts;    /* against the reference; all 0 for the reference */
    const char *picture, *differences[NEPH_SHOWN_COUNT]; /* paths inside the report; NULL: none, or
                                                            not yet */
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
    int line; /* in the scene file; 0: the default limit of a quantity without a gate */
};

struct neph_scene_result {
    const char *name, *title, *physics, *hash;
    const char *file;        /* path of the scene as the user gave it */
    int width_px, height_px; /* of its frames */
    struct neph_viewing viewing;
    int frame_count;    /* one for each engine of the run that renders this scene, in order */
    int left_out_count; /* engines added by --only-engine that do not render it */
    struct neph_frame_result *frames;
    int truth; /* index of the reference frame; -1: there is none */
    double difference_scales[NEPH_SHOWN_COUNT]; /* ends of the colour scales */
    int gate_count; /* the scene's gates, and one for each frame that fails its default limit */
    struct neph_gate_result *gates;
    int ungated_count; /* frames of physical engines without a gate for their radiance */
    const struct neph_attribution *attribution; /* NULL: fewer than three engines */
    const char *viewer;                         /* page inside the report; NULL: none, or not yet */
    const char *no_viewer; /* why there is none; NULL: there is one, there are no images, or not
                              yet */
    bool is_drawn;
};

/* A scene of the catalogue with missing data. */
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

/* The counts behind a verdict. */
struct neph_counts {
    int expected; /* frames: engines summed over all available scenes; rows in the physics suite */
    int reported; /* those in the report, with any outcome */
    int compared; /* those compared with the reference */
    int ungated;  /* those with only the default limit, a factor of two: harness/report/gates.c */
};

/* Start from {0}; free with neph_validation_finish(). */
struct neph_validation {
    struct neph_arena arena;
    const char *title;
    char created_utc[32];
    int width_px, height_px; /* of frames in scenes without a size of their own */
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
    int steps_done, steps_total; /* while the run proceeds, and after an interruption */
    double left_s;               /* negative: unknown */
    bool interactive;            /* the report contains the libraries for interactive charts */
    bool has_screen;             /* the report contains the page of `neph study screen` */
};

void neph_validation_finish(struct neph_validation *validation);

/* Free the members of a scene outside the arena; it becomes {0}. */
void neph_scene_result_finish(struct neph_scene_result *scene);

/* Set the counts and the verdict; `expected` is the number of frames that the run should render. A
 * failed gate, an engine failure, a lost frame, and a run without comparisons fail the run; a
 * missing engine does not. */
void neph_validation_judge(struct neph_validation *validation, int expected);

/* Judge the gates of a measured scene: result->gates, allocated in the arena. A frame without a
 * gate gets an entry there when it fails the default limit. */
void neph_gates_judge(const struct neph_scene *scene, struct neph_arena *arena,
                      struct neph_scene_result *result);

/* True when a gate of the scene limits this quantity of the engine's frame. */
bool neph_scene_is_gated(const struct neph_scene_result *scene, const char *engine,
                         const char *quantity);

/* The document data.json, described in scripts/report/README.md. NULL when memory is short or a
 * text is not UTF-8. */
json_t *neph_validation_json(const struct neph_validation *validation);

/* Add a test case for each frame and each gate of the scenes, for each row of the physics suite,
 * and for the verdict of the run. */
void neph_validation_junit(const struct neph_validation *validation, struct neph_junit *junit);

/* Print a table for people: one line for each frame, with its remarks below. */
void neph_validation_print(const struct neph_validation *validation, FILE *out);

/* Print the verdict, such as "pass", followed by the engines that it does not cover and their
 * number of scenes: not installed, over budget, with fewer samples than set, or with a doubtful
 * error bar. No line break. */
void neph_validation_print_verdict(const struct neph_validation *validation, FILE *out);

const char *neph_verdict_name(enum neph_verdict verdict);
const char *neph_gate_verdict_name(enum neph_gate_verdict verdict);

#endif
