/* SPDX-License-Identifier: MIT
 *
 * References of sequences: choice of the marcher, its settings, its frames.
 */
#include "harness/study/reference.h"

#include "base/files.h"
#include "harness/engines/engines.h"
#include "renderer/march_params.h"
#include "scenes/motion.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Fails to compile when a kind is added, as the tables of this file need it. */
_Static_assert(NEPH_REFERENCE_RAYS_COUNT == 2, "a new kind");
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");

static const char *const rays_settings[NEPH_REFERENCE_RAYS_COUNT] = {
    [NEPH_REFERENCE_AVERAGED] = "rays_per_px=16",
    [NEPH_REFERENCE_CENTRE] = "rays_per_px=1",
};
_Static_assert(NEPH_REFERENCE_RAYS_PER_PX == 16, "rays_settings");

/* ---- the marcher of a test ------------------------------------------------------------------- */

/* Chooses the marcher by the test's setting "lighting". A marcher is its own reference. The model
 * of a user engine is not known; its reference has the scene's orders of scattering. */
static const struct neph_engine *find_marcher(const struct neph_job *test)
{
    static const char *const marches[] = {
        "march",        "march_octaves",  "march_horizon",    "march_octaves_fitted",
        "march_traced", "march_diffused", "march_similarity", "march_slab"};
    _Static_assert(sizeof(marches) / sizeof(marches[0]) == NEPH_MARCH_SLAB + 1, "one each");
    const int lighting = neph_option_find(test->engine->options, "lighting");
    if (lighting >= 0)
        return neph_engine_find(marches[(int)test->shot.settings.values[lighting]]);
    for (size_t i = 0; i < sizeof(marches) / sizeof(marches[0]); i++)
        if (strcmp(test->engine->name, marches[i]) == 0)
            return test->engine;
    return neph_engine_find(
        test->shot.scene->scattering == NEPH_SCATTERING_MULTIPLE ? "march_octaves" : "march");
}

/* False for settings that the reference does not take over. The number of light paths is the
 * test's: its light accumulates over frames, and a single frame with so few paths would be noisy or
 * dark. The cloud shadow map is a shortcut, and its error is to be measured. */
static bool is_shared(const struct neph_option *option)
{
    static const char *const own[] = {"light_paths",   "light_rounds",     "light_ahead",
                                      "light_similar", "diffusion_cycles", "cloud_shadow"};
    for (size_t i = 0; i < sizeof(own) / sizeof(own[0]); i++)
        if (strcmp(option->name, own[i]) == 0)
            return false;
    return true;
}

/* The test's values of all settings that both engines have and share: steps, transmittance, sun. */
static struct neph_settings make_shared_settings(const struct neph_job *test,
                                                 const struct neph_engine *march)
{
    struct neph_settings settings = neph_settings_default(march);
    for (int i = 0; march->options[i].name; i++) {
        const int same = neph_option_find(test->engine->options, march->options[i].name);
        if (same >= 0 && is_shared(&march->options[i]))
            settings.values[i] = test->shot.settings.values[same];
    }
    return settings;
}

enum neph_status neph_reference_job(const struct neph_job *test, enum neph_reference_rays rays,
                                    struct neph_engine_info *info, struct neph_job *job,
                                    struct neph_diag *diag)
{
    const struct neph_engine *march = find_marcher(test);
    neph_engine_probe(march, test->shot.device, info);
    *job = (struct neph_job){.engine = march, .info = info, .shot = test->shot};
    job->shot.settings = make_shared_settings(test, march);
    job->shot.seed = 1; /* the marcher draws no random numbers */
    job->shot.layers = NEPH_LAYERS_ALL;
    return neph_settings_set(march, &job->shot.settings, rays_settings[rays], diag);
}

/* ---- frames ---------------------------------------------------------------------------------- */

/* The first frame, from `first` on, with the same scene state as `frame`. */
static int find_equal_frame(const struct neph_scene *scene, int first, int frame)
{
    int same = first;
    while (!neph_scene_are_frames_equal(scene, same, frame))
        same++;
    return same;
}

/* 1 for a static scene, else `frame_count`. */
static int count_reference_frames(const struct neph_scene *scene, int first, int frame_count)
{
    for (int i = 1; i < frame_count; i++)
        if (!neph_scene_are_frames_equal(scene, first, first + i))
            return frame_count;
    return 1;
}

int neph_reference_frame_count(const struct neph_scene *scene, int first, int frame_count)
{
    int count = 0;
    for (int frame = first; frame < first + frame_count; frame++)
        count += find_equal_frame(scene, first, frame) == frame;
    return NEPH_REFERENCE_RAYS_COUNT * count;
}

void neph_cost_add(struct neph_cost *sum, const struct neph_cost *cost)
{
    sum->render_s += cost->render_s;
    sum->wall_s += cost->wall_s;
    sum->cpu_s += cost->cpu_s;
    if (cost->peak_memory_bytes > sum->peak_memory_bytes)
        sum->peak_memory_bytes = cost->peak_memory_bytes;
}

/* Opens the sequence, and with it the device, at the first frame that the store does not have. */
static enum neph_status render_reference_frame(struct neph_job *job, struct neph_store *store,
                                               struct neph_job_result *result,
                                               struct neph_diag *diag)
{
    bool found = false;
    enum neph_status status = neph_job_reuse(job, store, result, &found, diag);
    if (status || found)
        return status;
    neph_job_result_finish(result);
    if (!job->sequence)
        status = neph_job_open(job, diag);
    if (!status)
        status = neph_job_run(job, store, result, diag);
    return status ? status : neph_outcome_check(result->outcome, result->reason, diag);
}

/* Gets the frame of a job; `*path` is its file in the store, owned by the caller. */
static enum neph_status find_reference_frame(struct neph_job *job, struct neph_store *store,
                                             struct neph_progress *progress,
                                             struct neph_reference *reference, char **path,
                                             struct neph_diag *diag)
{
    struct neph_job_result result = {.settings = NULL};
    char what[160];
    snprintf(what, sizeof(what), "reference of %s, frame %d", job->shot.scene->name,
             job->shot.frame);
    neph_progress_begin(progress, what);
    const enum neph_status status = render_reference_frame(job, store, &result, diag);
    if (!status) {
        *path = result.frame_path;
        result.frame_path = NULL;
        neph_cost_add(&reference->cost, &result.cost);
        reference->picture_count++;
        neph_progress_tick(progress, what);
    }
    neph_job_result_finish(&result);
    return status;
}

static enum neph_status make_frames(struct neph_job *job, int frame_count, struct neph_store *store,
                                    struct neph_progress *progress,
                                    struct neph_reference *reference, struct neph_sequence *frames,
                                    struct neph_diag *diag)
{
    const int first = job->shot.frame;
    const struct neph_scene *scene = job->shot.scene;
    frames->paths = calloc((size_t)frame_count, sizeof(*frames->paths));
    enum neph_status status = frames->paths ? NEPH_OK : neph_fail_memory(diag);
    for (int i = 0; i < frame_count && !status; i++) {
        const int same = find_equal_frame(scene, first, first + i) - first;
        job->shot.frame = first + i;
        if (same == i)
            status = find_reference_frame(job, store, progress, reference, &frames->paths[i], diag);
        else if (!(frames->paths[i] = strdup(frames->paths[same])))
            status = neph_fail_memory(diag);
        frames->count += !status;
    }
    neph_job_close(job);
    job->shot.frame = first;
    return status;
}

/* ---- the whole reference --------------------------------------------------------------------- */

static enum neph_status describe(const struct neph_job *averaged, struct neph_reference *reference,
                                 struct neph_diag *diag)
{
    reference->text = neph_format(
        "%s, %d rays a pixel, %g steps", averaged->engine->name, NEPH_REFERENCE_RAYS_PER_PX,
        neph_setting(averaged->engine, &averaged->shot.settings, "steps"));
    reference->settings = neph_settings_text(averaged->engine, &averaged->shot.settings);
    return reference->text && reference->settings ? NEPH_OK : neph_fail_memory(diag);
}

/* The key of the first averaged frame covers all settings; the number of frames completes it. */
enum neph_status neph_reference_key(const struct neph_job *test, int frame_count,
                                    char key[NEPH_HASH_HEX_SIZE], struct neph_diag *diag)
{
    struct neph_engine_info info;
    struct neph_job job;
    char first[NEPH_HASH_HEX_SIZE];
    enum neph_status status = neph_reference_job(test, NEPH_REFERENCE_AVERAGED, &info, &job, diag);
    if (!status)
        status = neph_job_key(&job, first, diag);
    if (status)
        return status;
    char *text = neph_format("neph-reference-1\nfirst %s\nframes %d\n", first, frame_count);
    status = text ? neph_hash(text, strlen(text), key, diag) : neph_fail_memory(diag);
    free(text);
    return status;
}

enum neph_status neph_reference_make(const struct neph_job *test, int frame_count,
                                     struct neph_store *store, struct neph_progress *progress,
                                     struct neph_reference *reference, struct neph_diag *diag)
{
    const int count = count_reference_frames(test->shot.scene, test->shot.frame, frame_count);
    struct neph_reference made = {.text = NULL};
    enum neph_status status = neph_reference_key(test, frame_count, made.key, diag);
    for (int rays = 0; rays < NEPH_REFERENCE_RAYS_COUNT && !status; rays++) {
        struct neph_engine_info info;
        struct neph_job job;
        status = neph_reference_job(test, (enum neph_reference_rays)rays, &info, &job, diag);
        if (!status)
            status = make_frames(&job, count, store, progress, &made, &made.frames[rays], diag);
        if (!status && rays == NEPH_REFERENCE_AVERAGED)
            status = describe(&job, &made, diag);
    }
    if (status)
        neph_reference_finish(&made);
    else
        *reference = made;
    return status;
}

void neph_reference_finish(struct neph_reference *reference)
{
    for (int rays = 0; rays < NEPH_REFERENCE_RAYS_COUNT; rays++)
        neph_sequence_finish(&reference->frames[rays]);
    free(reference->text);
    free(reference->settings);
    *reference = (struct neph_reference){.text = NULL};
}
