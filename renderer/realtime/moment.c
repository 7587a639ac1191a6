/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/moment.h"

#include "renderer/gpu_scene.h"
#include "renderer/realtime/jitter.h"
#include "scenes/injection.h"
#include "scenes/motion.h"

#include <string.h>

_Static_assert((int)NEPH_SCENE_MOVERS_MAX <= RT_MOVERS_MAX, "room for every mover");

static void set_vector(float out[3], struct neph_vec3 vector)
{
    out[0] = (float)vector.x;
    out[1] = (float)vector.y;
    out[2] = (float)vector.z;
}

static struct neph_gpu_view_camera camera_from(const struct neph_camera *camera,
                                               struct neph_vec3 origin_m,
                                               const uint32_t picture_px[2])
{
    const double half_height = neph_camera_half_height(camera);
    struct neph_gpu_view_camera made = {
        .half_width = (float)(half_height * picture_px[0] / picture_px[1]),
        .half_height = (float)half_height,
        .is_parallel = camera->orthographic_height_m > 0.0,
    };
    set_vector(made.right, camera->right);
    set_vector(made.up, camera->up);
    set_vector(made.forward, camera->forward);
    set_vector(made.position_m, neph_vec3_sub(camera->position_m, origin_m));
    return made;
}

/* Every `override_rest` cycles of four frames one cycle has no override. */
static bool is_override_skipped(const struct neph_gpu_view *view, uint32_t number)
{
    const uint32_t period = (uint32_t)view->settings[RT_OVERRIDE_REST];
    return period > 0 && number / 4 % period == period - 1;
}

struct neph_rt_transforms neph_rt_compute_transforms(const struct neph_gpu_view *view,
                                                     const struct neph_scene *scene, int frame,
                                                     uint32_t number, bool moves_rays)
{
    struct neph_rt_transforms now = {
        .drift_m = neph_scene_wind_displacement_m(scene, frame),
        .origin_m = neph_injected_origin_at(neph_scene_injections(scene), frame),
        .frame = frame,
        .exposure = neph_injected_exposure_at(neph_scene_injections(scene), frame),
    };
    double jitter_px[2] = {0.0, 0.0};
    if (moves_rays && view->settings[RT_TAA] != 0.0f)
        neph_rt_jitter((int)view->settings[RT_TAA_JITTER],
                       (int)view->settings[RT_TAA_JITTER_LENGTH], number, jitter_px);
    now.jitter_px[0] = (float)jitter_px[0];
    now.jitter_px[1] = (float)jitter_px[1];
    return now;
}

/* The same transforms after the origin of the world has moved. */
static struct neph_rt_transforms shift_transforms(const struct neph_rt_transforms *before,
                                                  const struct neph_rt_transforms *now)
{
    const struct neph_vec3 shift_m = neph_vec3_sub(now->origin_m, before->origin_m);
    struct neph_rt_transforms moved = *before;
    moved.camera.position_m = neph_vec3_add(before->camera.position_m, shift_m);
    moved.origin_m = now->origin_m;
    return moved;
}

/* The pivot of a mover relative to the camera of this frame. */
static struct neph_vec3 pivot_from(const struct neph_rt_transforms *now,
                                   const struct neph_rt_transforms *then,
                                   const struct neph_placing *placing)
{
    const struct neph_vec3 own_m = neph_vec3_add(placing->pivot_m, placing->move_m);
    return neph_vec3_sub(neph_vec3_add(own_m, then->origin_m), now->camera.position_m);
}

/* The rotation back is the difference of two angles in double precision: exactly 0 when static. */
static struct neph_gpu_mover mover_from(const struct neph_scene *scene,
                                        const struct neph_mover *mover,
                                        const struct neph_rt_transforms *now,
                                        const struct neph_rt_transforms *before)
{
    const struct neph_placing here = neph_mover_placing(scene, mover, now->frame);
    const struct neph_placing there = neph_mover_placing(scene, mover, before->frame);
    const struct neph_turn a = here.turn, b = there.turn;
    const bool is_static = a.cosine == b.cosine && a.sine == b.sine;
    struct neph_gpu_mover made = {
        .first = neph_gpu_solid_number(scene, mover->first, false),
        .end = neph_gpu_solid_number(scene, mover->first + mover->count, false),
        .instances_first = neph_gpu_solid_number(scene, mover->first, true),
        .instances_end = neph_gpu_solid_number(scene, mover->first + mover->count, true),
        .axis = (uint32_t)mover->axis,
        .cosine = is_static ? 1.0f : (float)(a.cosine * b.cosine + a.sine * b.sine),
        .sine = is_static ? 0.0f : (float)(b.sine * a.cosine - b.cosine * a.sine),
    };
    set_vector(made.pivot_m, pivot_from(now, now, &here));
    set_vector(made.pivot_before_m, pivot_from(now, before, &there));
    return made;
}

void neph_rt_view_set_transforms(struct neph_gpu_view *view, const struct neph_scene *scene,
                                 const struct neph_rt_transforms *now,
                                 const struct neph_rt_transforms *before, uint32_t number)
{
    const bool is_first = !before;
    struct neph_rt_transforms past = is_first ? *now : *before;
    if (view->settings[RT_ORIGIN_SHIFT] != 0.0f)
        past = shift_transforms(&past, now);
    before = &past;
    const bool is_cut = !is_first && neph_scene_is_cut(scene, before->frame, now->frame);
    view->now = camera_from(&now->camera, now->camera.position_m, view->picture_px);
    view->before = camera_from(&before->camera, now->camera.position_m, view->picture_px);
    view->frame = number;
    view->is_cut = is_cut;
    view->has_history = !is_first && !(is_cut && view->settings[RT_CUT_RESET] != 0.0f);
    view->resting = is_override_skipped(view, number);
    memcpy(view->jitter_px, now->jitter_px, sizeof(view->jitter_px));
    memcpy(view->jitter_before_px, before->jitter_px, sizeof(view->jitter_before_px));
    set_vector(view->wind_m, neph_vec3_sub(now->drift_m, before->drift_m));
    view->exposure = (float)now->exposure;
    view->exposure_before = (float)before->exposure;
    view->mover_count = (uint32_t)scene->mover_count;
    for (int i = 0; i < scene->mover_count; i++)
        view->movers[i] = mover_from(scene, &scene->movers[i], now, before);
}
