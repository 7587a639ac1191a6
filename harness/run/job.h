/* SPDX-License-Identifier: MIT
 *
 * A job: one engine renders one frame of one scene with given settings. Finished frames come from
 * the store; new ones are checked, labelled and published there.
 */
#ifndef NEPH_HARNESS_RUN_JOB_H
#define NEPH_HARNESS_RUN_JOB_H

#include "harness/engines/engine.h"
#include "harness/run/store.h"

struct neph_job {
    const struct neph_engine *engine;
    const struct neph_engine_info *info; /* from the engine's probe */
    struct neph_shot shot;               /* scratch_directory is set by neph_job_run() */
    void *sequence; /* the engine's open sequence, borrowed: a render is its next frame; NULL:
                       single frames */
    int repeat;     /* number that distinguishes repeated timings of one job */
};

/* Outcome of a job. */
enum neph_outcome {
    NEPH_OUTCOME_RENDERED,
    NEPH_OUTCOME_CANNOT,  /* the engine cannot model the scene */
    NEPH_OUTCOME_MISSING, /* the engine is not installed */
    NEPH_OUTCOME_FAILED,  /* the engine failed, or its frame is unusable */
    NEPH_OUTCOME_TIMEOUT,
    NEPH_OUTCOME_INTERRUPTED,
    NEPH_OUTCOME_OVER_BUDGET, /* the engine works, but not within its time: see budget.h */
    NEPH_OUTCOME_COUNT,
};

enum { NEPH_JOB_NOTE_SIZE = 400 };

struct neph_job_result {
    enum neph_outcome outcome;
    char reason[1600];             /* of an outcome other than RENDERED */
    char note[NEPH_JOB_NOTE_SIZE]; /* difference between the request and the rendered frame (fewer
                                      samples), or "" */
    char *settings;                /* canonical text; owned */
    char *frame_path;              /* owned; NULL when not rendered */
    bool reused;                   /* from the store, not rendered now */
    struct neph_cost cost;
};

/* Renders the frame, or reuses it from the store. The status is NEPH_OK even when the engine fails
 * (see the outcome); it is an error when the store fails, memory is short or the run was
 * interrupted. Free the result with neph_job_result_finish(). */
enum neph_status neph_job_run(const struct neph_job *job, struct neph_store *store,
                              struct neph_job_result *result, struct neph_diag *diag);

void neph_job_result_finish(struct neph_job_result *result);

/* The first half of neph_job_run(): looks in the store. `*found`: the frame was there; otherwise
 * `result` has only the settings. */
enum neph_status neph_job_reuse(const struct neph_job *job, struct neph_store *store,
                                struct neph_job_result *result, bool *found,
                                struct neph_diag *diag);

/* Opens a sequence of the job's engine, with the job's shot as its first frame. job->sequence is
 * set for engines with sequences; each neph_job_render() is then the sequence's next frame. Errors
 * as of neph_job_render(). End it with neph_job_close(), which is allowed without a sequence, too.
 */
enum neph_status neph_job_open(struct neph_job *job, struct neph_diag *diag);
void neph_job_close(struct neph_job *job);

/* Renders without a store, for `neph render`. The frame is labelled and checked. */
enum neph_status neph_job_render(const struct neph_job *job, struct neph_image **frame,
                                 struct neph_cost *cost, struct neph_diag *diag);

/* Like neph_job_render(), without the check of the values: for callers that count invalid values.
 */
enum neph_status neph_job_render_unchecked(const struct neph_job *job, struct neph_image **frame,
                                           struct neph_cost *cost, struct neph_diag *diag);

/* Number of invalid values of a frame, over all channels: not finite (except +inf where a distance
 * is infinite), or negative. */
size_t neph_job_count_bad(const struct neph_image *frame);

/* The store key: hash of scene, engine, version, device, settings, size, frame, layers, seed. */
enum neph_status neph_job_key(const struct neph_job *job, char key[NEPH_HASH_HEX_SIZE],
                              struct neph_diag *diag);

const char *neph_outcome_name(enum neph_outcome outcome);

/* Whether the engine was available and should have rendered the frame; such an outcome fails a run.
 */
bool neph_outcome_is_broken(enum neph_outcome outcome);

/* Checks, before any rendering, that the engine is available and models the scene of the shot's
 * frame: NEPH_ERR_UNSUPPORTED ("cannot: multiple scattering"), _UNAVAILABLE or _ENGINE. */
enum neph_status neph_job_check(const struct neph_job *job, struct neph_diag *diag);

/* For verbs that run one engine: extends the message of NEPH_ERR_UNSUPPORTED by the engine's name
 * and the setting that can render the scene. Returns `status`. */
enum neph_status neph_job_explain(const struct neph_job *job, enum neph_status status,
                                  struct neph_diag *diag);

/* For callers that need the frame: NEPH_OK when it was rendered, else NEPH_ERR_UNSUPPORTED,
 * _UNAVAILABLE, _ENGINE, _TIMEOUT or _INTERRUPTED, with `reason` as the message. */
enum neph_status neph_outcome_check(enum neph_outcome outcome, const char *reason,
                                    struct neph_diag *diag);

#endif
