/* SPDX-License-Identifier: MIT */
#include "scenes/skyward.h"

#include <stdlib.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_SOLID_KIND_COUNT == 3, "a new kind");

/* One block, freed with one call; the scene comes first. */
struct made {
    struct neph_scene scene;
    struct neph_camera_key key;
};

static enum neph_status check(const struct neph_scene *scene, const struct neph_skyward *view,
                              struct neph_diag *diag)
{
    if (!scene->sun.present || scene->solid_count == 0 ||
        scene->solids[0].kind != NEPH_SOLID_SPHERE)
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "%s is no planet: it needs a sun, and a sphere as its first solid",
                         scene->name);
    if (!(fabs(view->sun_elevation_rad) <= M_PI / 2.0))
        return neph_fail(diag, NEPH_ERR_USAGE,
                         "a sun %g degrees above the horizon, outside the range",
                         view->sun_elevation_rad / NEPH_RAD_PER_DEG);
    if (!(view->altitude_m > 0.0 && view->altitude_m <= 1e8))
        return neph_fail(diag, NEPH_ERR_USAGE, "an altitude of %g m, outside 0..1e8",
                         view->altitude_m);
    return NEPH_OK;
}

static struct neph_vec3 direction(double elevation_rad, double azimuth_rad)
{
    return (struct neph_vec3){cos(elevation_rad) * sin(azimuth_rad), sin(elevation_rad),
                              -cos(elevation_rad) * cos(azimuth_rad)};
}

static void set_camera(struct made *made, const struct neph_skyward *view)
{
    const struct neph_solid *ground = &made->scene.solids[0];
    struct neph_vec3 *eye_m = &made->key.position_m;
    *eye_m = ground->center_m;
    eye_m->y += ground->radius_m + view->altitude_m;
    made->key.look_at_m = neph_vec3_add(*eye_m, direction(view->pitch_rad, view->azimuth_rad));
    made->scene.camera_keys = &made->key;
    made->scene.camera_key_count = 1;
    made->scene.camera_up = (struct neph_vec3){0, 1, 0};
    made->scene.vertical_fov_rad = view->vertical_fov_rad;
    made->scene.orthographic_height_m = 0.0;
}

enum neph_status neph_scene_skyward(const struct neph_scene *scene, const struct neph_skyward *view,
                                    struct neph_scene **made, struct neph_diag *diag)
{
    enum neph_status status = check(scene, view, diag);
    if (status)
        return status;
    struct made *created = calloc(1, sizeof(*created));
    if (!created)
        return neph_fail_memory(diag);
    created->scene = *scene;
    created->scene.borrows = true;
    created->scene.is_as_filed = false;
    created->scene.frame_count = 1;
    created->scene.pause_count = created->scene.frame_scale_count = 0;
    created->scene.advance_count = created->scene.clear_count = 0;
    created->scene.sun_key_count = created->scene.wind_key_count = 0;
    created->scene.sun.direction = direction(view->sun_elevation_rad, 0.0);
    set_camera(created, view);
    status = neph_scene_hash(&created->scene, diag);
    if (status)
        neph_scene_destroy(&created->scene);
    else
        *made = &created->scene;
    return status;
}
