/* SPDX-License-Identifier: MIT */
#include "harness/physics/scenery.h"

#include <string.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");

static enum neph_status see(const struct neph_check_view *view, struct neph_scenery_view *seen,
                            struct neph_diag *diag)
{
    seen->view = view;
    seen->pixel_count = view->width_px * view->height_px;
    enum neph_status status = neph_stage_create(&view->stage, &seen->stage, diag);
    if (status)
        return status;
    seen->truth_error = neph_stage_truth_error(seen->stage);
    const struct neph_camera camera = neph_scene_camera(&seen->stage->scene, 0.0);
    for (int p = 0; p < seen->pixel_count; p++) {
        const struct neph_vec3 ray = neph_check_ray(view, &camera, p).direction;
        seen->weight[p] = neph_check_pixel_weight(view, &camera, ray);
        seen->truth[p] = seen->weight[p] > 0.0 ? neph_stage_truth_w_per_m2_sr(seen->stage, ray)
                                               : 0.0;
    }
    return NEPH_OK;
}

void neph_scenery_leave(struct neph_scenery *scenery)
{
    for (int v = 0; v < scenery->check.view_count; v++) {
        neph_stage_destroy(scenery->views[v].stage);
        scenery->views[v].stage = NULL;
    }
}

enum neph_status neph_scenery_enter(int index, struct neph_scenery *scenery, struct neph_diag *diag)
{
    memset(scenery, 0, sizeof(*scenery));
    neph_check_get(index, &scenery->check);
    enum neph_status status = NEPH_OK;
    for (int v = 0; v < scenery->check.view_count && !status; v++)
        status = see(&scenery->check.views[v], &scenery->views[v], diag);
    if (status)
        neph_scenery_leave(scenery);
    return status;
}

enum neph_status neph_scenery_light(struct neph_scenery *scenery, enum neph_scattering scattering,
                                    bool environment_light, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int v = 0; v < scenery->check.view_count && !status; v++) {
        struct neph_scene *scene = &scenery->views[v].stage->scene;
        scene->scattering = scattering;
        scene->environment_light = environment_light;
        status = neph_scene_hash(scene, diag);
    }
    return status;
}
