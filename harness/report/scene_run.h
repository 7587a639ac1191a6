/* SPDX-License-Identifier: MIT
 *
 * One scene of `neph validate`: a frame by each engine, a second seed of each stochastic engine,
 * all measured against the frame of the highest reference level, and the gates.
 */
#ifndef NEPH_HARNESS_REPORT_SCENE_RUN_H
#define NEPH_HARNESS_REPORT_SCENE_RUN_H

#include "harness/experiment/pool.h"
#include "harness/progress.h"
#include "harness/report/validation.h"

struct neph_report;

/* Deviations of a scene from the parameters of the run. */
struct neph_scene_plan {
    const char *name;              /* name in the catalogue */
    int width_px, height_px;       /* size of its frames; 0: the run's size */
    const char *const *engines;    /* engines that render it, NULL-terminated; NULL: the run's */
    const char *const *settings;   /* "ENGINE:KEY=VALUE", NULL-terminated; the user's settings
                                      override them; NULL: none */
    const char *const *light_only; /* engines that render radiance without transmittance and depth,
                                      NULL-terminated; NULL: none */
};

struct neph_validate_params {
    const char *const *scenes;           /* paths or names of the catalogue */
    const struct neph_scene_plan *plans; /* one for each scene; NULL: no deviations */
    int scene_count;
    const char *const *engines; /* names; engine_count 0: all but the real-time methods */
    int engine_count;
    bool only_engines;           /* in addition to `engines` render only each scene's reference */
    const char *const *settings; /* "ENGINE:KEY=VALUE"; not used by charts and the sequence */
    int setting_count;
    int width_px, height_px;
    int seed;                          /* number of the seed of engines that draw paths, from 1 */
    double budget_s;                   /* for each frame of an external renderer: see budget.h */
    struct neph_shared_device *device; /* as neph_shot.device */
    int jobs; /* number of processes that render scenes at the same time; does not change results */
    bool quiet;
    bool skip_absent;         /* a scene with missing data is listed in `absent` */
    struct neph_times *times; /* cache for the speeds of frames; NULL: speeds are not measured */
    const struct neph_charts_params *charts; /* NULL: none */
    bool over_time;                          /* include the sequence of over_time.h */
    bool over_time_floors;                   /* .. with the floors of its presets */
    struct neph_report *report;              /* published after each scene; NULL: no report */
};

enum { NEPH_SCENE_RUN_KINDS = 2 * NEPH_FIELD_MAX };

/* Progress steps of a scene that worker processes have reported, as bit sets over their kinds. */
struct neph_scene_steps_done {
    uint64_t steps; /* steps with a frame in the store */
    uint64_t made;  /* those that a worker rendered in this run */
};
_Static_assert((int)NEPH_SCENE_RUN_KINDS <= 64, "a bit for each kind");

/* The common state of all scenes of a run; all pointers are borrowed. */
struct neph_scene_run {
    const struct neph_validate_params *params;
    const struct neph_run_engines *field;
    struct neph_store *store;
    struct neph_progress *progress;     /* uses the kinds 0 .. NEPH_SCENE_RUN_KINDS - 1 */
    struct neph_arena *arena;           /* for the results */
    const struct neph_scene_plan *plan; /* of the current scene; NULL: no deviations */
    /* In a worker: called after each step with a frame in the store; otherwise NULL. */
    void (*tell)(const struct neph_scene_run *run, const char *step, bool reused, double seconds);
    const struct neph_worker *worker;  /* for `tell`: the worker */
    int scene;                         /* for `tell`: index of its scene */
    struct neph_scene_steps_done told; /* reported by workers for the current scene; already counted
                                         as progress */
};

/* Add `count` scenes of the current plan to the expected progress; a negative count removes
 * them. */
void neph_scene_run_expect(const struct neph_scene_run *run, int count);

/* The number of engines of the run that render the current scene. */
int neph_scene_run_engine_count(const struct neph_scene_run *run);

/* Run one scene. `*result` must be {0} before; always free it with neph_scene_result_finish(). */
enum neph_status neph_scene_run(const struct neph_scene_run *run, const struct neph_scene *scene,
                                struct neph_scene_result *result, struct neph_diag *diag);

/* For workers: only render into the store, where neph_scene_run() finds the frames. `*is_late`
 * becomes true when an engine failed or an external renderer exceeded its budget while other
 * workers used the cores; neph_scene_run() then tries again without other workers. `result` as for
 * neph_scene_run(). */
enum neph_status neph_scene_render(const struct neph_scene_run *run, const struct neph_scene *scene,
                                   struct neph_scene_result *result, bool *is_late,
                                   struct neph_diag *diag);

#endif
