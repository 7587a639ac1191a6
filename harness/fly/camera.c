/* SPDX-License-Identifier: MIT */
#include "harness/fly/camera.h"

#include "scenes/bounds.h"
#include "scenes/solids.h"

#include <math.h>
#include <string.h>

static const double crossing_s = 2.0;
/* Limit of the elevation: at 90 degrees the right-hand direction is undefined. */
static const double elevation_max_rad = 89.0 * NEPH_RAD_PER_DEG;
static const double speed_min_m_per_s = 1e-3, speed_max_m_per_s = 1e5;
/* The largest camera coordinate that a scene file may have. */
static const double far_m = 1e6;

/* ---- speed ----------------------------------------------------------------------------------- */

/* Distance to the box, or, inside it, its shortest side; +inf for an unbounded side. */
static double distance_to_bounds_m(const struct neph_bounds *bounds, struct neph_vec3 point_m)
{
    const struct neph_vec3 sides_m = neph_vec3_sub(bounds->max_m, bounds->min_m);
    if (neph_bounds_contain(bounds, point_m))
        return fmin(sides_m.x, fmin(sides_m.y, sides_m.z));
    return neph_vec3_length(neph_vec3_sub(neph_bounds_nearest(bounds, point_m), point_m));
}

static double choose_travel_distance_m(const struct neph_scene *scene,
                                       const struct neph_camera_key *key)
{
    double nearest_m = INFINITY;
    for (int i = 0; i < scene->medium_count; i++)
        nearest_m = fmin(nearest_m, distance_to_bounds_m(&scene->media[i].bounds, key->position_m));
    const double view_m = neph_vec3_length(neph_vec3_sub(key->look_at_m, key->position_m));
    return isfinite(nearest_m) ? fmax(view_m, nearest_m) : view_m;
}

static double limit_speed(double speed_m_per_s)
{
    return fmin(speed_max_m_per_s, fmax(speed_min_m_per_s, speed_m_per_s));
}

struct neph_fly_camera neph_fly_camera_from_scene(const struct neph_scene *scene)
{
    const struct neph_camera_key *key = &scene->camera_keys[0];
    return (struct neph_fly_camera){
        .key = {.position_m = key->position_m, .look_at_m = key->look_at_m},
        .speed_m_per_s = limit_speed(choose_travel_distance_m(scene, key) / crossing_s),
    };
}

/* ---- motion ---------------------------------------------------------------------------------- */

/* Rotate about a unit axis (Rodrigues' formula). */
static struct neph_vec3 rotate(struct neph_vec3 v, struct neph_vec3 axis, double angle_rad)
{
    const struct neph_vec3 across = neph_vec3_cross(axis, v);
    const double along = neph_vec3_dot(axis, v) * (1.0 - cos(angle_rad));
    return neph_vec3_along(
        neph_vec3_along(neph_vec3_scale(v, cos(angle_rad)), across, sin(angle_rad)), axis, along);
}

static struct neph_vec3 turn(struct neph_vec3 forward, struct neph_vec3 up,
                             const struct neph_fly_motion *motion)
{
    forward = rotate(forward, up, -motion->turn_right_rad);
    const double sine = neph_vec3_dot(forward, up);
    const struct neph_vec3 level = neph_vec3_normalize(neph_vec3_along(forward, up, -sine));
    double elevation_rad = asin(fmin(1.0, fmax(-1.0, sine))) + motion->turn_up_rad;
    elevation_rad = fmin(elevation_max_rad, fmax(-elevation_max_rad, elevation_rad));
    return neph_vec3_along(neph_vec3_scale(level, cos(elevation_rad)), up, sin(elevation_rad));
}

static bool is_far(struct neph_vec3 point_m)
{
    return fmax(fabs(point_m.x), fmax(fabs(point_m.y), fabs(point_m.z))) > far_m;
}

static bool is_position_allowed(const struct neph_scene *scene, const struct neph_camera_key *key)
{
    for (int i = 0; i < scene->solid_count; i++)
        if (neph_solid_contains(&scene->solids[i], key->position_m))
            return false;
    return !is_far(key->position_m) && !is_far(key->look_at_m);
}

static struct neph_camera_key turned(const struct neph_camera_key *key, struct neph_vec3 up,
                                     const struct neph_fly_motion *motion)
{
    const struct neph_vec3 view_m = neph_vec3_sub(key->look_at_m, key->position_m);
    const double distance_m = neph_vec3_length(view_m);
    const struct neph_vec3 forward = turn(neph_vec3_normalize(view_m), up, motion);
    struct neph_camera_key made = *key;
    made.look_at_m = neph_vec3_along(key->position_m, forward, distance_m);
    return made;
}

static struct neph_camera_key moved(const struct neph_camera_key *key, struct neph_vec3 up,
                                    const struct neph_fly_motion *motion, double speed_m_per_s)
{
    const struct neph_vec3 forward = neph_vec3_normalize(
        neph_vec3_sub(key->look_at_m, key->position_m));
    const struct neph_vec3 right = neph_vec3_normalize(neph_vec3_cross(forward, up));
    const struct neph_vec3 way = neph_vec3_along(
        neph_vec3_along(neph_vec3_scale(right, motion->right), up, motion->up), forward,
        motion->forward);
    const double step_m = speed_m_per_s * motion->time_s;
    struct neph_camera_key made = *key;
    made.position_m = neph_vec3_along(key->position_m, way, step_m);
    made.look_at_m = neph_vec3_along(key->look_at_m, way, step_m);
    return made;
}

void neph_fly_camera_move(struct neph_fly_camera *camera, const struct neph_scene *scene,
                          const struct neph_fly_motion *motion)
{
    struct neph_camera_key key = camera->key;
    camera->speed_m_per_s = limit_speed(camera->speed_m_per_s * motion->speed_factor);
    if (motion->turn_right_rad != 0.0 || motion->turn_up_rad != 0.0)
        key = turned(&key, scene->camera_up, motion);
    if (is_position_allowed(scene, &key))
        camera->key = key;
    if (motion->right != 0.0 || motion->up != 0.0 || motion->forward != 0.0)
        key = moved(&camera->key, scene->camera_up, motion, camera->speed_m_per_s);
    if (is_position_allowed(scene, &key))
        camera->key = key;
}

bool neph_fly_is_same_view(const struct neph_camera_key *a, const struct neph_camera_key *b)
{
    return memcmp(&a->position_m, &b->position_m, sizeof(a->position_m)) == 0 &&
           memcmp(&a->look_at_m, &b->look_at_m, sizeof(a->look_at_m)) == 0;
}
