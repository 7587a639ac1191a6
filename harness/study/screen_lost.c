/* SPDX-License-Identifier: MIT
 *
 * Traces the parts of a hemisphere that screen-space methods cannot see.
 */
#include "harness/study/screen_lost.h"

#include "scenes/solids.h"

#include <math.h>

/* A surface point seen through a pixel. */
struct site {
    const struct neph_scene *scene;
    const struct neph_camera *camera;
    double half_width, half_height; /* of the frame; as tangents, or in metres for a parallel
                                       projection */
    struct neph_vec3 point_m;
};

/* Distance at which a ray leaves the frame through one of its four sides. */
static double compute_exit_distance_m(const struct site *site, struct neph_vec3 direction)
{
    const struct neph_camera *camera = site->camera;
    const bool is_parallel = camera->orthographic_height_m > 0.0;
    const struct neph_vec3 from_m = neph_vec3_sub(site->point_m, camera->position_m);
    const double depth_m = neph_vec3_dot(from_m, camera->forward);
    const double deeper = neph_vec3_dot(direction, camera->forward);
    const struct {
        struct neph_vec3 axis;
        double half;
    } sides[4] = {{camera->right, site->half_width},
                  {neph_vec3_scale(camera->right, -1.0), site->half_width},
                  {camera->up, site->half_height},
                  {neph_vec3_scale(camera->up, -1.0), site->half_height}};
    double nearest_m = INFINITY;
    for (int i = 0; i < 4; i++) { /* inside while room + opening t >= 0 */
        const double room = sides[i].half * (is_parallel ? 1.0 : depth_m) -
                            neph_vec3_dot(from_m, sides[i].axis);
        const double opening = (is_parallel ? 0.0 : sides[i].half * deeper) -
                               neph_vec3_dot(direction, sides[i].axis);
        if (opening < 0.0)
            nearest_m = fmin(nearest_m, fmax(0.0, -room / opening));
    }
    return nearest_m;
}

/* Distance from which on the ray is hidden from the camera; +inf: not before its end. The inside of
 * a solid counts as hidden, so a ray that hits a front face is hidden only from its end on. */
static double compute_hidden_distance_m(const struct site *site, struct neph_vec3 direction,
                                        double end_m)
{
    const double touch = 1e-6; /* tolerance, relative to the distance and to the distance from the
                                  camera */
    const struct neph_camera *camera = site->camera;
    const struct neph_vec3 backward = neph_vec3_scale(camera->forward, -1.0);
    const double eye_m = neph_vec3_length(neph_vec3_sub(site->point_m, camera->position_m));
    const struct neph_shadow_ray ray = {
        site->point_m, direction,
        backward,      camera->orthographic_height_m > 0.0 ? NULL : &camera->position_m,
        0.0,           end_m};
    double first_m = INFINITY;
    struct neph_shadows shadows; /* not zero-initialised: it is large */
    for (int i = 0; i < site->scene->solid_count; i++) {
        const struct neph_solid *solid = &site->scene->solids[i];
        shadows.count = 0;
        neph_solid_add_shadows(solid, &ray, &shadows);
        for (int k = 0; k < shadows.count; k++) {
            const struct neph_interval at_m = shadows.at_m[k];
            if (at_m.high - at_m.low > touch * (eye_m + fmin(at_m.high, eye_m)))
                first_m = fmin(first_m, at_m.low);
        }
    }
    return first_m < end_m * (1.0 - touch) ? first_m : INFINITY;
}

static void classify_ray(const struct site *site, struct neph_vec3 direction, double reach_m,
                         double share, double shares[NEPH_SCREEN_LOSSES])
{
    const double far_m = 1e7; /* replaces infinity in the shadow tests */
    const struct neph_hit hit = neph_scene_hit(site->scene, site->point_m, direction);
    const bool meets = hit.solid && hit.t_m <= reach_m;
    const double end_m = fmin(meets ? hit.t_m : reach_m, far_m);
    const double leaves_m = compute_exit_distance_m(site, direction);
    const double hidden_m = compute_hidden_distance_m(site, direction, end_m);
    if (hidden_m < fmin(leaves_m, end_m))
        shares[meets ? NEPH_LOST_BEHIND : NEPH_LOST_THIN] += share;
    else if (meets && leaves_m < end_m)
        shares[NEPH_LOST_OFF] += share;
}

/* Direction `i` of `n`, cosine-distributed about an axis (T. Duff et al., "Building an Orthonormal
 * Basis, Revisited", JCGT 6(1), 2017) and turned by the golden angle. */
static struct neph_vec3 cosine_direction(struct neph_vec3 axis, int i, int n)
{
    const double golden_rad = M_PI * (3.0 - sqrt(5.0));
    const double side = axis.z >= 0.0 ? 1.0 : -1.0, a = -1.0 / (side + axis.z);
    const double b = axis.x * axis.y * a;
    const struct neph_vec3 first = {1.0 + side * axis.x * axis.x * a, side * b, -side * axis.x};
    const struct neph_vec3 second = {b, side + axis.y * axis.y * a, -axis.y};
    const double u = (i + 0.5) / n, radius = sqrt(u), angle = i * golden_rad;
    struct neph_vec3 direction = neph_vec3_scale(axis, sqrt(1.0 - u));
    direction = neph_vec3_along(direction, first, radius * cos(angle));
    return neph_vec3_normalize(neph_vec3_along(direction, second, radius * sin(angle)));
}

void neph_screen_compute_lost_shares(const struct neph_scene *scene,
                                     const struct neph_camera *camera, int width_px, int height_px,
                                     int column, int row, double reach_m, int rays,
                                     double shares[NEPH_SCREEN_LOSSES])
{
    const struct neph_pixel_ray ray = neph_camera_ray(camera, width_px, height_px, column, row);
    const struct neph_hit hit = neph_scene_hit(scene, ray.origin_m, ray.direction);
    const double half_height = neph_camera_half_height(camera);
    for (int i = 0; i < NEPH_SCREEN_LOSSES; i++)
        shares[i] = 0.0;
    if (!hit.solid)
        return;
    const struct site site = {
        .scene = scene,
        .camera = camera,
        .half_width = half_height * width_px / height_px,
        .half_height = half_height,
        .point_m = neph_hit_outside_m(&hit, neph_vec3_along(ray.origin_m, ray.direction, hit.t_m)),
    };
    const double into = neph_vec3_dot(ray.direction, hit.normal);
    if (rays == NEPH_SCREEN_MIRROR)
        classify_ray(&site, neph_vec3_along(ray.direction, hit.normal, -2.0 * into), reach_m, 1.0,
                     shares);
    for (int i = 0; i < rays; i++)
        classify_ray(&site, cosine_direction(hit.normal, i, rays), reach_m, 1.0 / rays, shares);
}
