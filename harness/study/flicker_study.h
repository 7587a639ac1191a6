/* SPDX-License-Identifier: MIT
 *
 * A flicker study: compares presets of the real-time renderer over scenes and seeds. Each captured
 * sequence is measured against the common reference of its scene (reference.h). Finished sequences
 * are in the store, so an interrupted study resumes there.
 */
#ifndef NEPH_HARNESS_STUDY_FLICKER_STUDY_H
#define NEPH_HARNESS_STUDY_FLICKER_STUDY_H

#include "base/arena.h"
#include "base/path.h"
#include "harness/run/job.h"
#include "harness/study/flicker_metrics.h"
#include "harness/study/ideal.h"

enum {
    NEPH_STUDY_PRESETS_MAX = 128,
    NEPH_STUDY_CONFIGURATIONS_MAX = 3 * NEPH_STUDY_PRESETS_MAX, /* with two floors of each preset */
    NEPH_STUDY_SEEDS_MAX = 64,
};

/* The floor of a preset: two configurations that march every pixel in every frame, with the
 * anti-aliasing of the preset and with the default one (floor_plan.h). The lower value counts. */
enum { NEPH_STUDY_FLOOR_CANDIDATES = 2 };
struct neph_study_floor {
    int candidates[NEPH_STUDY_FLOOR_CANDIDATES]; /* indices into the configurations of the study */
};

struct neph_flicker_study_params {
    const char *const *presets; /* "NAME" or "NAME+KEY=VALUE+...", then `floor_count` floors */
    const char *const *labels;  /* names in the progress; NULL: the presets */
    int preset_count;           /* 1 .. NEPH_STUDY_PRESETS_MAX */
    int floor_count; /* further configurations, which take no part in pairs and rankings */
    const struct neph_study_floor *floors; /* of each preset; NULL: the study has no floors */
    const char *const *scenes;             /* names or paths */
    int scene_count;
    int seed_count;
    int seeds_before;     /* the first seed is seeds_before + 1 */
    double frame_rate_hz; /* of scenes and displays; 0: scenes have their own */
    int frame_count;      /* a multiple of 4; a moving scene has at most its own frames */
    int steps;
    int width_px, height_px;
    bool takes[NEPH_STUDY_CAPTURES];
    bool brief;        /* only the first display, and no comparison with centre rays */
    const char *ideal; /* words of a configuration of which further references are made (ideal.h),
                          with the same seed, in place of the centre rays; only the headline metric
                          is measured. NULL: none */
    int map_count;     /* with `ideal`: the first configurations, which keep maps of the metric */
    struct neph_shared_device *device; /* like neph_shot.device */
    bool quiet;
};

enum { NEPH_STUDY_WHY_SIZE = 160 };

/* A metric of a preset in a scene with a seed. */
struct neph_study_cell {
    double value;                         /* NaN: none; `because` has the reason */
    double centre;                        /* against the centre rays; NaN: none */
    double ideals[NEPH_IDEALS];           /* against references made of the ideal; NaN: none */
    double displays[NEPH_STUDY_DISPLAYS]; /* the first is `value`; others are NaN except for the
                                             eye's metrics */
    bool is_bound;                        /* `value` is an upper bound: the metric could not be
                                             separated from other changes */
    bool counts;                          /* takes part in comparisons */
    char because[NEPH_STUDY_WHY_SIZE];    /* reason when it does not count */
};

/* Cost of the flicker sequence of a preset in a scene with a seed, without the warm-up, and its
 * place in the store. */
struct neph_study_cost {
    double density_evaluations; /* per pixel and frame, counted; NaN: not rendered */
    double traffic_bytes; /* per pixel and frame, over all passes (neph_realtime_stats); NaN: not
                             rendered, or no passes */
    double gpu_ms;        /* median of a frame; NaN: not rendered, or the device has no timestamps
                             */
    double blur_px;       /* of the ideal sequence with this seed; NaN: not rendered, or no ideal */
    const char *folder;   /* of the sequence in the store; NULL: not rendered */
};

struct neph_study_scene {
    const char *name, *title;
    bool moves;
    int frame_count;             /* of the flicker sequence */
    const char *left_out;        /* the reason why the scene was not measured; NULL: it was */
    const char *reference;       /* "march, 16 rays a pixel, 32 steps" */
    int picture_count;           /* frames of all its references */
    double reference_s, takes_s; /* processor time of the references, and of the presets' sequences
                                    */
};

struct neph_flicker_study {
    const struct neph_flicker_study_params *params; /* borrowed */
    struct neph_arena arena;                        /* owns everything that the study points to */
    char device[128];
    const char *settings[NEPH_STUDY_CONFIGURATIONS_MAX]; /* of each preset and floor */
    struct neph_study_scene *scenes;
    struct neph_study_cell *cells; /* see neph_study_cell_at() */
    struct neph_study_cost *costs; /* see neph_study_cost_at() */
    int failed_count;              /* failed sequences */
};

/* Runs the study. A scene that a preset cannot render is left out; of a floor that cannot render a
 * scene, the cells have the reason. A failed sequence is counted, and its cells have the reason.
 * NEPH_ERR_INTERRUPTED: finished sequences stay in the store. Call neph_flicker_study_finish() in
 * any case. */
enum neph_status neph_flicker_study_run(const struct neph_flicker_study_params *params,
                                        struct neph_store *store, struct neph_flicker_study *study,
                                        struct neph_diag *diag);

/* Allocates the scenes, cells and costs for `params`, all zero. Errors: NEPH_ERR_MEMORY. */
enum neph_status neph_flicker_study_begin(const struct neph_flicker_study_params *params,
                                          struct neph_flicker_study *study, struct neph_diag *diag);
void neph_flicker_study_finish(struct neph_flicker_study *study);

/* The map of the headline metric in the folder of a sequence, against a reference made of the
 * ideal; NEPH_IDEALS: against the reference. */
struct neph_path neph_study_map_path(const char *folder, enum neph_ideal_kind against);

/* The cell of a metric, and the cost, of a preset or floor in a scene with a seed. */
struct neph_study_cell *neph_study_cell_at(const struct neph_flicker_study *study, int scene,
                                           int preset, int seed, int metric);
struct neph_study_cost *neph_study_cost_at(const struct neph_flicker_study *study, int scene,
                                           int preset, int seed);

#endif
