/* SPDX-License-Identifier: MIT
 *
 * One scene of the main job: a picture by each engine, a second seed where chance plays a part, all
 * measured against the highest rung of truth, and the gates.
 */
#ifndef NEPH_HARNESS_REPORT_SCENE_RUN_H
#define NEPH_HARNESS_REPORT_SCENE_RUN_H

#include "harness/experiment/pool.h"
#include "harness/progress.h"
#include "harness/report/validation.h"

struct neph_report;

/* How a scene of a run differs from the others of the run. */
struct neph_scene_plan {
    const char *name;              /* of the catalogue */
    int width_px, height_px;       /* of its frames; 0: those of the run */
    const char *const *engines;    /* that render it, NULL-terminated; NULL: all of the run */
    const char *const *settings;   /* "ENGINE:KEY=VALUE", NULL-terminated, before those of the user;
                                      NULL: none */
    const char *const *light_only; /* engines that render radiance and no transmittance or depth,
                                      NULL-terminated; NULL: none */
};

struct neph_validate_params {
    const char *const *scenes;           /* paths or names of the catalogue */
    const struct neph_scene_plan *plans; /* of each of these; NULL: the scenes do not differ */
    int scene_count;
    const char *const *engines; /* names; engine_count 0: all that are no shortcut */
    int engine_count;
    bool only_engines;           /* beside `engines` only the reference of each scene is rendered */
    const char *const *settings; /* "ENGINE:KEY=VALUE"; charts and the sequence have their own */
    int setting_count;
    int width_px, height_px;
    int seed;        /* the how-manieth of engines that draw paths, from 1 */
    double budget_s; /* of each picture of another project's renderer: see budget.h */
    struct neph_shared_device *device; /* as neph_shot.device */
    int jobs; /* processes that render scenes at the same time; results do not depend on it */
    bool quiet;
    bool skip_absent;         /* a scene whose data is not there goes into `absent` */
    struct neph_times *times; /* speeds of frames are measured and kept there; NULL: they are not */
    const struct neph_charts_params *charts; /* NULL: none */
    bool over_time;                          /* the sequence of over_time.h too */
    struct neph_report *report;              /* published after each scene; NULL: none is */
};

enum { NEPH_SCENE_RUN_KINDS = 2 * NEPH_FIELD_MAX };

/* Steps of a scene that worker processes have told of, as bits by their kind. */
struct neph_scene_told {
    uint64_t steps; /* all whose frames are in the store */
    uint64_t made;  /* those that a worker rendered for this run */
};
_Static_assert((int)NEPH_SCENE_RUN_KINDS <= 64, "a bit for each kind");

/* What all scenes of a run have in common; borrowed. */
struct neph_scene_run {
    const struct neph_validate_params *params;
    const struct neph_run_engines *field;
    struct neph_store *store;
    struct neph_progress *progress;     /* its kinds 0 .. NEPH_SCENE_RUN_KINDS - 1 are ours */
    struct neph_arena *arena;           /* of the results */
    const struct neph_scene_plan *plan; /* of the scene at hand; NULL: as the run */
    /* A worker's: called after each step whose frame is in the store; else NULL. */
    void (*tell)(const struct neph_scene_run *run, const char *step, bool reused, double seconds);
    const struct neph_worker *worker; /* for `tell`: itself .. */
    int scene;                        /* .. and the index of its scene */
    struct neph_scene_told told;      /* by workers, of the scene at hand; its steps are counted */
};

/* There will be `count` more scenes of the plan at hand; negative: fewer. */
void neph_scene_run_expect(const struct neph_scene_run *run, int count);

/* How many engines of the run render the scene at hand. */
int neph_scene_run_engine_count(const struct neph_scene_run *run);

/* Run one. `*result`, {0} before, is for neph_scene_result_finish() in any case. */
enum neph_status neph_scene_run(const struct neph_scene_run *run, const struct neph_scene *scene,
                                struct neph_scene_result *result, struct neph_diag *diag);

/* In a worker: only render, into the store, where neph_scene_run() finds the frames. `*is_late`: an
 * engine broke, or a frame of an external renderer did not fit into its budget beside those of
 * other workers; neph_scene_run() has to try again, when no worker shares the cores. `result` as
 * there. */
enum neph_status neph_scene_render(const struct neph_scene_run *run, const struct neph_scene *scene,
                                   struct neph_scene_result *result, bool *is_late,
                                   struct neph_diag *diag);

#endif
