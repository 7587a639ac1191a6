/* SPDX-License-Identifier: MIT */
#include "harness/fly/studio.h"

#include "harness/engines/engines.h"
#include "harness/fly/camera.h"
#include "harness/study/reference.h"
#include "scenes/motion.h"

#include <stdio.h>
#include <stdlib.h>

/* Static frames before the reference is rendered with 16 rays per pixel, which is slow. */
enum { REST_FRAMES = 4 };

/* A job with the description of its engine. */
struct studio_job {
    struct neph_job job;
    struct neph_engine_info info;
};

struct neph_studio {
    struct neph_studio_params params;
    struct neph_scene scene; /* borrows all but the camera key */
    struct neph_camera_key camera;
    struct studio_job live;
    struct neph_settings realtime; /* settings of the current preset */
    const char *preset;            /* NULL: the defaults */
    char name[64];

    struct studio_job reference; /* job.engine NULL: not opened yet */
    struct neph_settings rays[NEPH_REFERENCE_RAYS_COUNT];
    struct neph_image *picture; /* last reference frame, or NULL; owned */
    int picture_rays_per_px;    /* of `picture` */
    struct neph_camera_key picture_camera;
    int picture_frame;
    int same_count; /* number of consecutive frames equal to their predecessor */
};

/* ---- the live renderer ----------------------------------------------------------------------- */

static enum neph_status make_preset_settings(const struct neph_studio *studio, const char *preset,
                                             struct neph_settings *settings, struct neph_diag *diag)
{
    const struct neph_engine *engine = &neph_engine_realtime;
    *settings = neph_settings_default(engine);
    enum neph_status status = preset ? neph_settings_preset(engine, preset, settings, diag)
                                     : NEPH_OK;
    if (!status)
        status = neph_settings_set(engine, settings, "warm_up=0", diag);
    for (int i = 0; i < studio->params.setting_count && !status; i++)
        status = neph_settings_set(engine, settings, studio->params.settings[i], diag);
    return status;
}

/* A job of engine realtime, not opened. */
static struct studio_job make_realtime_job(const struct neph_studio *studio,
                                           const struct neph_settings *settings)
{
    struct studio_job studio_job = {.job = {.engine = &neph_engine_realtime,
                                            .shot = {.scene = &studio->scene,
                                                     .settings = *settings,
                                                     .width_px = studio->params.width_px,
                                                     .height_px = studio->params.height_px,
                                                     .frame = studio->live.job.shot.frame,
                                                     .seed = studio->params.seed,
                                                     .layers = NEPH_LAYERS_ALL,
                                                     .device = studio->params.device}}};
    return studio_job;
}

/* Open a job and replace the live one; after an error the live one stays. */
static enum neph_status replace_live_job(struct neph_studio *studio, struct studio_job *studio_job,
                                         struct neph_diag *diag)
{
    studio_job->job.info = &studio_job->info;
    const enum neph_status status = neph_job_open(&studio_job->job, diag);
    if (status)
        return neph_job_explain(&studio_job->job, status, diag);
    if (studio->live.job.engine)
        neph_job_close(&studio->live.job);
    studio->live = *studio_job;
    studio->live.job.info = &studio->live.info;
    return NEPH_OK;
}

static void forget_reference(struct neph_studio *studio)
{
    if (studio->reference.job.engine)
        neph_job_close(&studio->reference.job);
    studio->reference.job.engine = NULL;
    neph_image_destroy(studio->picture);
    studio->picture = NULL;
}

enum neph_status neph_studio_choose_preset(struct neph_studio *studio, const char *preset,
                                           struct neph_diag *diag)
{
    struct neph_settings settings;
    enum neph_status status = make_preset_settings(studio, preset, &settings, diag);
    if (status)
        return status;
    struct studio_job studio_job = make_realtime_job(studio, &settings);
    neph_engine_probe(studio_job.job.engine, studio_job.job.shot.device, &studio_job.info);
    status = replace_live_job(studio, &studio_job, diag);
    if (status)
        return status;
    forget_reference(studio);
    studio->realtime = settings;
    studio->preset = preset;
    snprintf(studio->name, sizeof(studio->name), "realtime%s%s", preset ? " " : "",
             preset ? preset : "");
    return NEPH_OK;
}

/* A job of the ray marcher with the same model: the reference of realtime with its current
 * settings. */
static enum neph_status make_march_job(const struct neph_studio *studio,
                                       enum neph_reference_rays rays, struct studio_job *studio_job,
                                       struct neph_diag *diag)
{
    const struct studio_job test = make_realtime_job(studio, &studio->realtime);
    return neph_reference_job(&test.job, rays, &studio_job->info, &studio_job->job, diag);
}

enum neph_status neph_studio_choose_march(struct neph_studio *studio, bool is_march,
                                          struct neph_diag *diag)
{
    struct studio_job studio_job;
    if (!is_march)
        return neph_studio_choose_preset(studio, studio->preset, diag);
    enum neph_status status = make_march_job(studio, NEPH_REFERENCE_CENTRE, &studio_job, diag);
    if (!status)
        status = replace_live_job(studio, &studio_job, diag);
    if (!status)
        snprintf(studio->name, sizeof(studio->name), "%s", studio_job.job.engine->name);
    return status;
}

const char *neph_studio_name(const struct neph_studio *studio)
{
    return studio->name;
}

const struct neph_job *neph_studio_job(const struct neph_studio *studio)
{
    return &studio->live.job;
}

/* ---- open and close -------------------------------------------------------------------------- */

static void borrow_scene(struct neph_studio *studio)
{
    const struct neph_scene *scene = studio->params.scene;
    studio->camera = scene->camera_keys[0];
    studio->camera.frame = 0.0;
    studio->scene = *scene;
    studio->scene.borrows = true;
    studio->scene.camera_keys = &studio->camera;
    studio->scene.camera_key_count = 1;
    studio->scene.pause_count = studio->scene.frame_scale_count = 0;
    studio->scene.advance_count = 0;
}

enum neph_status neph_studio_open(const struct neph_studio_params *params, const char *preset,
                                  struct neph_studio **studio, struct neph_diag *diag)
{
    struct neph_studio *made = calloc(1, sizeof(*made));
    if (!made)
        return neph_fail_memory(diag);
    made->params = *params;
    made->same_count = -1; /* the first frame has no predecessor */
    borrow_scene(made);
    const enum neph_status status = neph_studio_choose_preset(made, preset, diag);
    if (status)
        neph_studio_close(made);
    else
        *studio = made;
    return status;
}

void neph_studio_close(struct neph_studio *studio)
{
    if (!studio)
        return;
    forget_reference(studio);
    if (studio->live.job.engine)
        neph_job_close(&studio->live.job);
    free(studio);
}

/* ---- frames ---------------------------------------------------------------------------------- */

enum neph_status neph_studio_render(struct neph_studio *studio,
                                    const struct neph_camera_key *camera, int frame,
                                    struct neph_image **image, struct neph_cost *cost,
                                    struct neph_diag *diag)
{
    const bool is_same = neph_fly_is_same_view(&studio->camera, camera) &&
                         neph_scene_are_frames_equal(&studio->scene, studio->live.job.shot.frame,
                                                     frame);
    studio->same_count = is_same ? studio->same_count + 1 : 0;
    studio->camera.position_m = camera->position_m;
    studio->camera.look_at_m = camera->look_at_m;
    studio->live.job.shot.frame = frame;
    return neph_job_render_unchecked(&studio->live.job, image, cost, diag);
}

static enum neph_status open_reference(struct neph_studio *studio, struct neph_diag *diag)
{
    struct studio_job studio_job;
    enum neph_status status = NEPH_OK;
    for (int rays = 0; rays < NEPH_REFERENCE_RAYS_COUNT && !status; rays++) {
        status = make_march_job(studio, (enum neph_reference_rays)rays, &studio_job, diag);
        if (!status)
            studio->rays[rays] = studio_job.job.shot.settings;
    }
    if (status)
        return status;
    studio->reference = studio_job;
    studio->reference.job.info = &studio->reference.info;
    status = neph_job_open(&studio->reference.job, diag);
    if (status)
        studio->reference.job.engine = NULL;
    return status;
}

/* Whether the stored reference shows the current camera and scene time, with at least so many
 * rays. */
static bool has_picture(const struct neph_studio *studio, int rays_per_px)
{
    return studio->picture && studio->picture_rays_per_px >= rays_per_px &&
           neph_fly_is_same_view(&studio->picture_camera, &studio->camera) &&
           neph_scene_are_frames_equal(&studio->scene, studio->picture_frame,
                                       studio->live.job.shot.frame);
}

static enum neph_status take_picture(struct neph_studio *studio, enum neph_reference_rays rays,
                                     struct neph_diag *diag)
{
    struct neph_job *job = &studio->reference.job;
    struct neph_image *picture = NULL;
    struct neph_cost cost;
    job->shot.settings = studio->rays[rays];
    job->shot.frame = studio->live.job.shot.frame;
    const enum neph_status status = neph_job_render_unchecked(job, &picture, &cost, diag);
    if (status)
        return status;
    neph_image_destroy(studio->picture);
    studio->picture = picture;
    studio->picture_rays_per_px = rays == NEPH_REFERENCE_CENTRE ? 1 : NEPH_REFERENCE_RAYS_PER_PX;
    studio->picture_camera = studio->camera;
    studio->picture_frame = job->shot.frame;
    return NEPH_OK;
}

enum neph_status neph_studio_reference(struct neph_studio *studio, const struct neph_image **image,
                                       int *rays_per_px, struct neph_diag *diag)
{
    const bool rests = studio->same_count >= REST_FRAMES;
    enum neph_status status = studio->reference.job.engine ? NEPH_OK : open_reference(studio, diag);
    if (!status && !has_picture(studio, rests ? NEPH_REFERENCE_RAYS_PER_PX : 1))
        status = take_picture(studio, rests ? NEPH_REFERENCE_AVERAGED : NEPH_REFERENCE_CENTRE,
                              diag);
    if (status)
        return status;
    *image = studio->picture;
    *rays_per_px = studio->picture_rays_per_px;
    return NEPH_OK;
}
