/* SPDX-License-Identifier: MIT */
#include "harness/report/scene_layers.h"

#include "metrics/motion.h"
#include "scenes/media.h"
#include "scenes/motion.h"
#include "scenes/solids.h"

#include <math.h>
#include <stdlib.h>

/* The threshold of the mask `medium` of metrics/mask.h. */
static const double least_optical_depth = 1e-3;

static const double sun_radius_rad = 0.00465; /* half the angular diameter of the sun seen from the
                                                 Earth */

struct view {
    const struct neph_scene *scene;
    struct neph_camera camera;
    int width_px, height_px;
};

static struct neph_pixel_ray ray_of(const struct view *view, int x, int y)
{
    return neph_camera_ray(&view->camera, view->width_px, view->height_px, x, y);
}

static bool has_media(const struct neph_scene *scene, bool fog)
{
    for (int m = 0; m < scene->medium_count; m++)
        if (neph_medium_is_fog(&scene->media[m]) == fog)
            return true;
    return false;
}

/* Add the channel `name` (such as "mask.fog"); samples are NULL when the image has it already. */
static enum neph_status add_mask(struct neph_image *image, const char *name, float **samples,
                                 struct neph_diag *diag)
{
    *samples = NULL;
    return neph_image_channel(image, name) ? NEPH_OK
                                           : neph_image_add_channel(image, name, samples, diag);
}

/* ---- media ----------------------------------------------------------------------------------- */

/* Optical depth of the fogs up to the pixel's solid, by channel. */
static struct neph_rgb fog_optical_depth(const struct neph_scene *scene,
                                         const struct neph_pixel_ray *ray, double distance_m)
{
    struct neph_rgb total = {0.0, 0.0, 0.0};
    for (int m = 0; m < scene->medium_count; m++) {
        const struct neph_medium *medium = &scene->media[m];
        if (!neph_medium_is_fog(medium))
            continue;
        const double depth = neph_medium_optical_depth(medium, ray->origin_m, ray->direction, 0.0,
                                                       distance_m);
        total.r += depth * medium->extinction_color.r;
        total.g += depth * medium->extinction_color.g;
        total.b += depth * medium->extinction_color.b;
    }
    return total;
}

/* Limited to 80: a float transmittance cannot represent larger optical depths. */
static double optical_depth_of(float transmittance)
{
    return fmin(-log((double)transmittance), 80.0);
}

static bool is_seen(double r, double g, double b)
{
    return fmax(r, fmax(g, b)) > least_optical_depth;
}

/* The optical depth of clouds is the frame's optical depth minus the optical depth of the fogs. */
static enum neph_status add_media(const struct view *view, struct neph_image *image,
                                  struct neph_diag *diag)
{
    float *transmittance[3], *fog = NULL, *cloud = NULL;
    const float *depth_m = neph_image_channel(image, "Z");
    if (!depth_m || !neph_image_rgb(image, "transmittance", transmittance))
        return NEPH_OK;
    const bool with_fog = has_media(view->scene, true), with_cloud = has_media(view->scene, false);
    enum neph_status status = with_fog ? add_mask(image, "mask.fog", &fog, diag) : NEPH_OK;
    if (!status && with_cloud)
        status = add_mask(image, "mask.cloud", &cloud, diag);
    for (int y = 0; !status && (fog || cloud) && y < view->height_px; y++)
        for (int x = 0; x < view->width_px; x++) {
            const size_t i = (size_t)y * (size_t)view->width_px + (size_t)x;
            const struct neph_pixel_ray ray = ray_of(view, x, y);
            const double cosine = neph_vec3_dot(ray.direction, view->camera.forward);
            const struct neph_rgb of_fog = fog_optical_depth(view->scene, &ray,
                                                             (double)depth_m[i] / cosine);
            if (fog)
                fog[i] = is_seen(of_fog.r, of_fog.g, of_fog.b) ? 1.0f : 0.0f;
            if (cloud)
                cloud[i] = is_seen(optical_depth_of(transmittance[0][i]) - of_fog.r,
                                   optical_depth_of(transmittance[1][i]) - of_fog.g,
                                   optical_depth_of(transmittance[2][i]) - of_fog.b)
                               ? 1.0f
                               : 0.0f;
        }
    return status;
}

/* ---- thin objects and the sun ---------------------------------------------------------------- */

static void mark_around(const struct view *view, int x, int y, float *samples)
{
    for (int v = y - 1; v <= y + 1; v++)
        for (int u = x - 1; u <= x + 1; u++)
            if (u >= 0 && v >= 0 && u < view->width_px && v < view->height_px)
                samples[(size_t)v * (size_t)view->width_px + (size_t)u] = 1.0f;
}

static enum neph_status add_thin(const struct view *view, struct neph_image *image,
                                 struct neph_diag *diag)
{
    bool any = false;
    for (int s = 0; s < view->scene->solid_count; s++)
        any |= view->scene->solids[s].thin;
    float *thin = NULL;
    enum neph_status status = any ? add_mask(image, "mask.thin", &thin, diag) : NEPH_OK;
    for (int y = 0; thin && y < view->height_px; y++)
        for (int x = 0; x < view->width_px; x++) {
            const struct neph_pixel_ray ray = ray_of(view, x, y);
            const struct neph_hit hit = neph_scene_hit(view->scene, ray.origin_m, ray.direction);
            if (hit.solid && hit.solid->thin)
                mark_around(view, x, y, thin);
        }
    return status;
}

static enum neph_status add_sun(const struct view *view, struct neph_image *image,
                                struct neph_diag *diag)
{
    const struct neph_sun *sun = &view->scene->sun;
    const double pixel_rad = view->camera.vertical_fov_rad / view->height_px;
    const double least_cosine = cos(sun_radius_rad + 0.5 * pixel_rad);
    float *samples = NULL;
    enum neph_status status = sun->present ? add_mask(image, "mask.sun", &samples, diag) : NEPH_OK;
    for (int y = 0; samples && y < view->height_px; y++)
        for (int x = 0; x < view->width_px; x++) {
            const struct neph_pixel_ray ray = ray_of(view, x, y);
            const bool near = neph_vec3_dot(ray.direction, sun->direction) >= least_cosine;
            if (near && !neph_scene_hit(view->scene, ray.origin_m, ray.direction).solid)
                samples[(size_t)y * (size_t)view->width_px + (size_t)x] = 1.0f;
        }
    return status;
}

/* ---- motion ---------------------------------------------------------------------------------- */

static struct neph_motion_camera motion_camera(const struct neph_camera *camera)
{
    return (struct neph_motion_camera){
        .position_m = {camera->position_m.x, camera->position_m.y, camera->position_m.z},
        .right = {camera->right.x, camera->right.y, camera->right.z},
        .up = {camera->up.x, camera->up.y, camera->up.z},
        .forward = {camera->forward.x, camera->forward.y, camera->forward.z},
        .vertical_fov_rad = camera->vertical_fov_rad,
    };
}

/* Across a cut no point has a previous position, although depth and cameras would yield one for
 * some points. */
static void mark_without_past(const struct neph_image *image, float *x_px, float *y_px)
{
    for (size_t i = 0; i < neph_image_pixel_count(image); i++)
        x_px[i] = y_px[i] = NEPH_MOTION_NOWHERE_PX;
}

/* The motion vector of a point: its pixel position in the previous camera minus its current
 * position. `*depth_m` is its eye depth in the previous camera. */
static void follow_point(const struct view *view, const struct neph_camera *before,
                         struct neph_vec3 point_m, int x, int y, float motion_px[2], float *depth_m)
{
    const struct neph_vec3 from_m = neph_vec3_sub(point_m, before->position_m);
    const double depth = neph_vec3_dot(from_m, before->forward);
    const double half_height_px = 0.5 * view->height_px / neph_camera_half_height(before);
    motion_px[0] = motion_px[1] = NEPH_MOTION_NOWHERE_PX;
    *depth_m = (float)fmax(depth, 0.0);
    if (depth <= 0.0)
        return;
    const double right_px = neph_vec3_dot(from_m, before->right) / depth * half_height_px;
    const double up_px = neph_vec3_dot(from_m, before->up) / depth * half_height_px;
    motion_px[0] = (float)(0.5 * view->width_px + right_px - (x + 0.5));
    motion_px[1] = (float)(0.5 * view->height_px - up_px - (y + 0.5));
}

static const struct neph_mover *mover_of(const struct neph_scene *scene, int solid)
{
    for (int i = 0; i < scene->mover_count; i++)
        if (solid >= scene->movers[i].first &&
            solid < scene->movers[i].first + scene->movers[i].count)
            return &scene->movers[i];
    return NULL;
}

/* Replace the motion vectors of moving solids, which depth and cameras do not describe. */
static void follow_solids(const struct neph_scene *scene, const struct view *view, int frame,
                          float *x_px, float *y_px, float *before_m)
{
    const struct neph_camera before = neph_scene_camera(scene, frame - 1);
    for (int y = 0; y < view->height_px && scene->mover_count > 0; y++)
        for (int x = 0; x < view->width_px; x++) {
            const size_t i = (size_t)y * (size_t)view->width_px + (size_t)x;
            const struct neph_pixel_ray ray = ray_of(view, x, y);
            const struct neph_hit hit = neph_scene_hit(view->scene, ray.origin_m, ray.direction);
            const struct neph_mover *mover =
                hit.solid ? mover_of(scene, (int)(hit.solid - view->scene->solids)) : NULL;
            if (!mover)
                continue;
            const struct neph_placing here = neph_mover_placing(scene, mover, frame);
            const struct neph_placing there = neph_mover_placing(scene, mover, frame - 1);
            const struct neph_vec3 point_m = neph_vec3_along(ray.origin_m, ray.direction, hit.t_m);
            float motion_px[2];
            follow_point(view, &before, neph_placed_before_m(&here, &there, point_m), x, y,
                         motion_px, &before_m[i]);
            x_px[i] = motion_px[0];
            y_px[i] = motion_px[1];
        }
}

static enum neph_status add_motion(const struct neph_scene *scene, const struct view *view,
                                   int frame, struct neph_image *image, struct neph_diag *diag)
{
    const float *depth_m = neph_image_channel(image, "Z");
    float *x_px = NULL, *y_px = NULL, *before_m = NULL;
    const bool moves = scene->camera_key_count > 1 || scene->mover_count > 0;
    const bool is_parallel = scene->orthographic_height_m > 0.0; /* motion.h requires a perspective
                                                                    camera */
    if (!depth_m || !moves || is_parallel || neph_image_channel(image, "motion.x"))
        return NEPH_OK;
    const struct neph_camera camera_before = neph_scene_camera(scene, frame - 1);
    const struct neph_motion_camera now = motion_camera(&view->camera);
    const struct neph_motion_camera before = motion_camera(&camera_before);
    enum neph_status status = neph_image_add_channel(image, "motion.x", &x_px, diag);
    if (!status)
        status = neph_image_add_channel(image, "motion.y", &y_px, diag);
    if (!status)
        status = neph_image_add_channel(image, "motion.depth", &before_m, diag);
    if (status)
        return status;
    if (neph_scene_is_cut(scene, frame - 1, frame)) {
        mark_without_past(image, x_px, y_px);
        return NEPH_OK;
    }
    status = neph_motion_of_depth(&now, &before, view->width_px, view->height_px, depth_m,
                                  NEPH_MOTION_EYE_DEPTH, x_px, y_px, before_m, diag);
    if (!status)
        follow_solids(scene, view, frame, x_px, y_px, before_m);
    return status;
}

enum neph_status neph_scene_layers_add(const struct neph_scene *scene, int frame,
                                       struct neph_image *image, struct neph_diag *diag)
{
    struct neph_scene *still = NULL; /* sun and media at the time of this frame */
    enum neph_status status = neph_scene_at(scene, frame, &still, diag);
    if (status)
        return status;
    const struct view view = {still, neph_scene_camera(still, frame), image->width_px,
                              image->height_px};
    status = add_media(&view, image, diag);
    if (!status)
        status = add_thin(&view, image, diag);
    if (!status)
        status = add_sun(&view, image, diag);
    if (!status)
        status = add_motion(scene, &view, frame, image, diag);
    neph_scene_destroy(still);
    return status;
}
