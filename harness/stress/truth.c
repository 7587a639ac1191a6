/* SPDX-License-Identifier: MIT
 *
 * References of the stress tests.
 */
#include "harness/stress/truth.h"

#include "harness/engines/engines.h"
#include "scenes/failing.h"
#include "scenes/motion.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Fails to compile when a kind is added, as neph_stress_preset_truth() chooses by it. */
_Static_assert(NEPH_FAILING_REFERENCE_COUNT == 2, "a new kind");

bool neph_stress_is_static(const struct neph_scene *scene)
{
    for (int frame = 1; frame < scene->failing->frame_count; frame++)
        if (!neph_scene_are_frames_equal(scene, 0, frame))
            return false;
    return true;
}

struct neph_stress_frames neph_stress_engine_frames(const struct neph_scene *scene)
{
    return neph_stress_is_static(scene)
               ? (struct neph_stress_frames){1, 1}
               : (struct neph_stress_frames){3, (scene->failing->frame_count - 1) / 2};
}

/* ---- engine exact ---------------------------------------------------------------------------- */

static enum neph_status render_exact_frame(const struct neph_job *job, struct neph_store *store,
                                           struct neph_sequence *frames, struct neph_diag *diag)
{
    struct neph_job_result result = {.settings = NULL};
    enum neph_status status = neph_job_run(job, store, &result, diag);
    if (!status)
        status = neph_outcome_check(result.outcome, result.reason, diag);
    if (!status) {
        frames->paths[frames->count++] = result.frame_path;
        result.frame_path = NULL;
    }
    neph_job_result_finish(&result);
    return status;
}

/* The key of several frames; a single frame keeps its own key. */
static enum neph_status make_key(const struct neph_job *first,
                                 const struct neph_stress_frames *frames,
                                 char key[NEPH_HASH_HEX_SIZE], struct neph_diag *diag)
{
    const enum neph_status status = neph_job_key(first, key, diag);
    if (status || frames->count == 1)
        return status;
    char text[160];
    snprintf(text, sizeof(text), "neph-exact-frames-1\nfirst %s\nframes %d every %d\n", key,
             frames->count, frames->step);
    return neph_hash(text, strlen(text), key, diag);
}

static enum neph_status make_exact(const struct neph_job *test,
                                   const struct neph_stress_frames *frames,
                                   struct neph_store *store, struct neph_reference *reference,
                                   struct neph_diag *diag)
{
    const struct neph_engine *exact = neph_engine_find("exact");
    struct neph_engine_info info;
    struct neph_job job = {.engine = exact, .info = &info, .shot = test->shot};
    struct neph_reference made = {.text = NULL};
    struct neph_sequence *pictures = &made.frames[NEPH_REFERENCE_AVERAGED];
    neph_engine_probe(exact, test->shot.device, &info);
    job.shot.settings = neph_settings_default(exact);
    job.shot.seed = 1; /* `exact` draws no random numbers */
    job.shot.layers = NEPH_LAYERS_ALL;
    job.shot.time_limit_s = 0.0;
    pictures->paths = calloc((size_t)frames->count, sizeof(*pictures->paths));
    enum neph_status status = pictures->paths ? make_key(&job, frames, made.key, diag)
                                              : neph_fail_memory(diag);
    for (int i = 0; i < frames->count && !status; i++) {
        job.shot.frame = test->shot.frame + i * frames->step;
        status = render_exact_frame(&job, store, pictures, diag);
    }
    if (status)
        neph_reference_finish(&made);
    else
        *reference = made;
    return status;
}

/* ---- references of presets and engines ------------------------------------------------------- */

enum neph_status neph_stress_preset_truth(const struct neph_job *test, struct neph_store *store,
                                          struct neph_progress *progress,
                                          struct neph_reference *reference, struct neph_diag *diag)
{
    static const struct neph_stress_frames one = {1, 1};
    const struct neph_scene *scene = test->shot.scene;
    if (scene->failing->truth == NEPH_FAILING_MARCH)
        return neph_reference_make(test, scene->failing->frame_count, store, progress, reference,
                                   diag);
    if (!neph_stress_is_static(scene))
        return neph_fail(diag, NEPH_ERR_INPUT, "%s moves: `truth: exact` needs a static scene",
                         scene->name);
    return make_exact(test, &one, store, reference, diag);
}

enum neph_status neph_stress_engine_truth(const struct neph_job *test,
                                          const struct neph_stress_frames *frames,
                                          struct neph_store *store,
                                          struct neph_reference *reference, struct neph_diag *diag)
{
    const enum neph_status status = make_exact(test, frames, store, reference, diag);
    if (status != NEPH_ERR_UNSUPPORTED && status != NEPH_ERR_UNAVAILABLE)
        return status;
    neph_prefix(diag, "there is no reference: exact ");
    return NEPH_ERR_ENGINE;
}
