/* SPDX-License-Identifier: MIT
 *
 * A flicker study: presets of the real-time renderer side by side over scenes and seeds, each take
 * held against the one reference of its scene (reference.h). What is finished is in the store, and
 * the same study goes on from there.
 */
#ifndef NEPH_HARNESS_STUDY_FLICKER_STUDY_H
#define NEPH_HARNESS_STUDY_FLICKER_STUDY_H

#include "base/arena.h"
#include "harness/run/job.h"
#include "harness/study/flicker_metrics.h"

enum { NEPH_STUDY_PRESETS_MAX = 128, NEPH_STUDY_SEEDS_MAX = 64 };

struct neph_flicker_study_params {
    const char *const *presets; /* "NAME" or "NAME+KEY=VALUE+..." */
    const char *const *labels;  /* what progress calls each; NULL: as it is */
    int preset_count;           /* 1 .. NEPH_STUDY_PRESETS_MAX */
    const char *const *scenes;  /* names or paths */
    int scene_count;
    int seed_count;
    int seeds_before; /* the first seed is one more */
    int frame_count;  /* a multiple of 4; of a scene that moves, as many as it has */
    int steps;
    int width_px, height_px;
    bool takes[NEPH_STUDY_TAKES];
    bool brief; /* nothing at the displays but the first, nor against centre rays */
    struct neph_shared_device *device; /* as neph_shot.device */
    bool quiet;
};

enum { NEPH_STUDY_WHY_SIZE = 160 };

/* A metric of a preset in a scene with a seed. */
struct neph_study_cell {
    double value;                         /* NaN: `because` says why there is none */
    double centre;                        /* against centre rays; NaN: none */
    double displays[NEPH_STUDY_DISPLAYS]; /* the first is `value`; NaN but of the eye's metrics */
    bool is_bound;                        /* the number cannot be told from the rest, and is no
                                             more than `value` */
    bool counts;                          /* takes part in comparisons */
    char because[NEPH_STUDY_WHY_SIZE];    /* why it does not, when it does not */
};

/* What the flicker's take of a preset in a scene with a seed has cost, warm-up left out. */
struct neph_study_cost {
    double density_evaluations; /* per pixel and frame, counted; NaN: not rendered */
    double traffic_bytes; /* per pixel and frame, of all passes (neph_realtime_stats); NaN, too,
                             where there are no passes */
    double gpu_ms;        /* of a frame, the median; NaN, too, where the device has no clock */
};

struct neph_study_scene {
    const char *name, *title;
    bool moves;
    int frame_count;             /* of the flicker's take */
    const char *left_out;        /* why nothing was measured; NULL when it was */
    const char *reference;       /* "march, 16 rays a pixel, 32 steps" */
    int picture_count;           /* of all its references */
    double reference_s, takes_s; /* processor time of these, and of the presets' frames */
};

struct neph_flicker_study {
    const struct neph_flicker_study_params *params; /* borrowed */
    struct neph_arena arena;                        /* has all that the study points to */
    char device[128];
    const char *settings[NEPH_STUDY_PRESETS_MAX]; /* of each preset */
    struct neph_study_scene *scenes;
    struct neph_study_cell *cells; /* by neph_study_cell_at() */
    struct neph_study_cost *costs; /* by neph_study_cost_at() */
    int failed_count;              /* takes that broke */
};

/* Run it. What an engine cannot render leaves its scene out; what breaks is counted, and its cells
 * say why. NEPH_ERR_INTERRUPTED: what is finished stays in the store. For _finish in any case. */
enum neph_status neph_flicker_study_run(const struct neph_flicker_study_params *params,
                                        struct neph_store *store, struct neph_flicker_study *study,
                                        struct neph_diag *diag);

/* Room for the scenes, cells and costs of the params, all zero. Errors: NEPH_ERR_MEMORY. */
enum neph_status neph_flicker_study_begin(const struct neph_flicker_study_params *params,
                                          struct neph_flicker_study *study, struct neph_diag *diag);
void neph_flicker_study_finish(struct neph_flicker_study *study);

struct neph_study_cell *neph_study_cell_at(const struct neph_flicker_study *study, int scene,
                                           int preset, int seed, int metric);
struct neph_study_cost *neph_study_cost_at(const struct neph_flicker_study *study, int scene,
                                           int preset, int seed);

#endif
