/* SPDX-License-Identifier: MIT
 *
 * A job: one engine renders one frame of one scene with given settings. Finished frames are taken
 * from the store; new ones are checked, labelled and published there.
 */
#ifndef NEPH_HARNESS_RUN_JOB_H
#define NEPH_HARNESS_RUN_JOB_H

#include "harness/engines/engine.h"
#include "harness/run/store.h"

struct neph_job {
    const struct neph_engine *engine;
    const struct neph_engine_info *info; /* of its probe */
    struct neph_shot shot;               /* scratch_directory is set by neph_job_run */
    void *sequence; /* opened by the engine, which then renders its next picture; NULL: a single
                       one; borrowed */
    int repeat;     /* tells repeated timings of one job apart */
};

/* What became of a job. */
enum neph_outcome {
    NEPH_OUTCOME_RENDERED,
    NEPH_OUTCOME_CANNOT,  /* the engine cannot model the scene */
    NEPH_OUTCOME_MISSING, /* the engine is not installed */
    NEPH_OUTCOME_FAILED,  /* it ran and failed, or its frame is not usable */
    NEPH_OUTCOME_TIMEOUT,
    NEPH_OUTCOME_INTERRUPTED,
    NEPH_OUTCOME_OVER_BUDGET, /* it works, but not in the time it was given: see budget.h */
    NEPH_OUTCOME_COUNT,
};

enum { NEPH_JOB_NOTE_SIZE = 400 };

struct neph_job_result {
    enum neph_outcome outcome;
    char reason[1600];             /* why it was not rendered */
    char note[NEPH_JOB_NOTE_SIZE]; /* what a rendered frame lacks of what was asked for, or "" */
    char *settings;                /* canonical text; owned */
    char *frame_path;              /* owned; NULL when not rendered */
    bool reused;                   /* taken from the store, not rendered now */
    struct neph_cost cost;
};

/* Render or reuse. The status is NEPH_OK whatever the engine did (the outcome says it), except when
 * the store itself fails, memory is short, or the run was interrupted. Free the result with
 * neph_job_result_finish. */
enum neph_status neph_job_run(const struct neph_job *job, struct neph_store *store,
                              struct neph_job_result *result, struct neph_diag *diag);

void neph_job_result_finish(struct neph_job_result *result);

/* The first half of neph_job_run(): `*found` tells whether the store had the frame; else `result`
 * has settings alone. */
enum neph_status neph_job_reuse(const struct neph_job *job, struct neph_store *store,
                                struct neph_job_result *result, bool *found,
                                struct neph_diag *diag);

/* Begin a sequence of the job's engine, with the job's shot as its first picture: job->sequence is
 * set where the engine has sequences, and each neph_job_render() is its next picture. Errors as of
 * rendering. End it with _close, which is fine without a sequence too. */
enum neph_status neph_job_open(struct neph_job *job, struct neph_diag *diag);
void neph_job_close(struct neph_job *job);

/* Render without a store: for `neph render`. The frame carries all attributes and is checked. */
enum neph_status neph_job_render(const struct neph_job *job, struct neph_image **frame,
                                 struct neph_cost *cost, struct neph_diag *diag);

/* neph_job_render() for who counts what is wrong with a frame: its values are not checked. */
enum neph_status neph_job_render_unchecked(const struct neph_job *job, struct neph_image **frame,
                                           struct neph_cost *cost, struct neph_diag *diag);

/* How many values of a frame no engine may hand over: not finite (but +inf where that is an
 * answer), or negative; in all channels. */
size_t neph_job_count_bad(const struct neph_image *frame);

/* The content address: scene, engine, version, device, settings, size, frame, layers, seed. */
enum neph_status neph_job_key(const struct neph_job *job, char key[NEPH_HASH_HEX_SIZE],
                              struct neph_diag *diag);

const char *neph_outcome_name(enum neph_outcome outcome);

/* Whether the engine was there and ought to have rendered it: that fails a run. */
bool neph_outcome_is_broken(enum neph_outcome outcome);

/* Whether the engine is there and models the scene of the shot's frame, before anything is
 * rendered: NEPH_ERR_UNSUPPORTED ("cannot: multiple scattering"), _UNAVAILABLE or _ENGINE. */
enum neph_status neph_job_check(const struct neph_job *job, struct neph_diag *diag);

/* For a verb of one engine, after a job has failed: where the engine cannot render the scene, the
 * words say which engine, and with which setting it could. Returns `status`. */
enum neph_status neph_job_explain(const struct neph_job *job, enum neph_status status,
                                  struct neph_diag *diag);

/* For who cannot do without the frame: NEPH_OK when it was rendered, else NEPH_ERR_UNSUPPORTED,
 * _UNAVAILABLE, _ENGINE, _TIMEOUT or _INTERRUPTED, with the reason as its words. */
enum neph_status neph_outcome_check(enum neph_outcome outcome, const char *reason,
                                    struct neph_diag *diag);

#endif
