/* SPDX-License-Identifier: MIT */
#include "harness/engines/povray_lamps.h"

#include "scenes/bounds.h"
#include "scenes/lights.h"
#include "scenes/solids.h"

#include <math.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");

/* Rays inside a medium that pass a light at less than this are refused: then the hole of 1e-2 units
 * around the light and its fade distance of 1e-3 units cost more than 1e-4 of the value. */
static const double nearest_units = 0.1;

/* Spots within this distance of a ray's line are masked. POV-Ray's b^2 - a c has a rounding error
 * of about 1e-2 units^2 in a world of 4e6 units; for a cone the term itself is the squared distance
 * of apex and ray. */
static const double mask_reach_units = 4.0;

/* The midpoint rule with step s over 1 / (h^2 + t^2) has the relative error 2 exp(-2 pi h / s). */
static const double heights_per_step = 2.0; /* 7e-6 */
/* A ray's part in a medium may end near the light, at distance a from it: less than `end_heights` a
 * from the closest point. Then steps of `step_part` a have the relative error step_part^2 / 12. */
static const double end_heights = 3.0;
static const double step_part = 0.1;
static const double cube_ratio = 4.0;
static const double face_gap_units = 1.0;
static const double widening = 1.01;

/* The rays that need cubes around a light. */
struct need {
    double resolved_m;     /* longest step that resolves all of them; INFINITY: no ray needs
                            * cubes */
    double longest_step_m; /* longest step of these rays */
};

static double line_distance_m(struct neph_vec3 way_m, struct neph_vec3 direction)
{
    return neph_vec3_length(neph_vec3_cross(way_m, direction));
}

/* Distance from the light to the part t0..t1 of a ray; `way_m`: vector from the ray's origin to the
 * light. */
static double part_distance_m(struct neph_vec3 way_m, struct neph_vec3 direction, double t0_m,
                              double t1_m)
{
    const double foot_m = neph_vec3_dot(way_m, direction);
    const double beyond_m = foot_m - fmin(t1_m, fmax(t0_m, foot_m));
    return hypot(line_distance_m(way_m, direction), beyond_m);
}

/* Whether a light's emission along the ray is not zero near the closest point. */
static bool shines_along(const struct neph_light *light, struct neph_vec3 direction)
{
    return neph_light_falloff(light, direction) > 0.0 ||
           neph_light_falloff(light, neph_vec3_scale(direction, -1.0)) > 0.0;
}

static enum neph_status refuse(const struct neph_povray_world *world, int light, int pixel,
                               double distance_m, struct neph_diag *diag)
{
    neph_fail(diag, NEPH_ERR_UNSUPPORTED,
              "the ray of pixel (%d, %d) passes light %d within a medium at %.3g m, nearer than "
              "%.2g m",
              pixel % world->width_px, pixel / world->width_px, light + 1, distance_m,
              nearest_units / world->units_per_m);
    neph_hint(diag, "move light %d off the ray, or make the scene smaller", light + 1);
    return NEPH_ERR_UNSUPPORTED;
}

/* Add the step that one ray needs around one light. */
static enum neph_status add_ray_need(const struct neph_povray_world *world, int index, int pixel,
                                     struct neph_pixel_ray ray, double hit_m, struct need *need,
                                     struct neph_diag *diag)
{
    const struct neph_light *light = &world->scene->lights[index];
    const struct neph_vec3 way_m = neph_vec3_sub(light->position_m, ray.origin_m);
    for (int i = 0; i < world->scene->medium_count; i++) {
        double t0_m = 0.0, t1_m = hit_m;
        if (!world->containers[i].used ||
            !neph_bounds_clip(&world->containers[i].bounds, ray.origin_m, ray.direction, &t0_m,
                              &t1_m))
            continue;
        const double near_m = part_distance_m(way_m, ray.direction, t0_m, t1_m);
        const double step_m = (t1_m - t0_m) / world->intervals;
        if (near_m * world->units_per_m < nearest_units && shines_along(light, ray.direction))
            return refuse(world, index, pixel, near_m, diag);
        const double foot_m = neph_vec3_dot(way_m, ray.direction);
        const bool ends_near = fmin(foot_m - t0_m, t1_m - foot_m) < end_heights * near_m;
        const double resolved_m = near_m * (ends_near ? step_part : 1.0 / heights_per_step);
        if (step_m < resolved_m)
            continue;
        need->resolved_m = fmin(need->resolved_m, resolved_m);
        need->longest_step_m = fmax(need->longest_step_m, step_m);
    }
    return NEPH_OK;
}

/* Whether faces of a cube and a box coincide: POV-Ray would treat them as one. */
static bool shares_face_plane(const struct neph_bounds *cube, const struct neph_bounds *box,
                              double gap_m)
{
    for (int axis = 0; axis < 3; axis++) {
        const double faces_m[2] = {neph_povray_axis(box->min_m, axis),
                                   neph_povray_axis(box->max_m, axis)};
        for (int side = 0; side < 2; side++)
            if (fabs(neph_povray_axis(cube->min_m, axis) - faces_m[side]) < gap_m ||
                fabs(neph_povray_axis(cube->max_m, axis) - faces_m[side]) < gap_m)
                return true;
    }
    return false;
}

static bool shares_any_face_plane(const struct neph_povray_world *world,
                                  const struct neph_bounds *cube)
{
    const double gap_m = face_gap_units / world->units_per_m;
    for (int i = 0; i < world->scene->medium_count; i++)
        if (world->containers[i].used &&
            shares_face_plane(cube, &world->containers[i].bounds, gap_m))
            return true;
    for (int i = 0; i < world->scene->solid_count; i++) {
        const struct neph_bounds box = neph_solid_bounds(&world->scene->solids[i]);
        if (shares_face_plane(cube, &box, gap_m))
            return true;
    }
    return false;
}

/* Choose the cubes: the smallest one is so small that a step within its longest chord resolves the
 * nearest ray; outside of the largest one, steps of an uncut ray are fine enough. */
static void choose_cubes(struct neph_povray_world *world, int index, const struct need *need)
{
    struct neph_povray_point_light *lamp = &world->lamps[index];
    const struct neph_vec3 at_m = world->scene->lights[index].position_m;
    const double last_m = need->longest_step_m / step_part;
    double half_m = need->resolved_m * world->intervals / (2.0 * sqrt(3.0));
    while (lamp->cube_count < NEPH_POVRAY_CUBES_MAX) {
        struct neph_bounds cube = neph_bounds_around(at_m, half_m);
        for (int tries = 0; tries < 100 && shares_any_face_plane(world, &cube); tries++) {
            half_m *= widening;
            cube = neph_bounds_around(at_m, half_m);
        }
        lamp->half_sides_m[lamp->cube_count++] = half_m;
        if (half_m >= last_m)
            break;
        half_m *= cube_ratio;
    }
}

enum neph_status neph_povray_cut_rays(struct neph_povray_world *world, struct neph_diag *diag)
{
    const struct neph_scene *scene = world->scene;
    if (scene->scattering == NEPH_SCATTERING_NONE || scene->light_count == 0)
        return NEPH_OK;
    struct need needs[NEPH_SCENE_LIGHTS_MAX];
    for (int l = 0; l < scene->light_count; l++)
        needs[l] = (struct need){.resolved_m = INFINITY};
    for (int pixel = 0; pixel < world->width_px * world->height_px; pixel++) {
        const struct neph_pixel_ray ray = neph_camera_ray(&world->camera, world->width_px,
                                                          world->height_px, pixel % world->width_px,
                                                          pixel / world->width_px);
        const double hit_m = neph_scene_hit(scene, ray.origin_m, ray.direction).t_m;
        for (int l = 0; l < scene->light_count; l++) {
            const struct neph_light *light = &scene->lights[l];
            const struct neph_vec3 way_m = neph_vec3_sub(light->position_m, ray.origin_m);
            const enum neph_status status = add_ray_need(world, l, pixel, ray, hit_m, &needs[l],
                                                         diag);
            if (status)
                return status;
            world->lamps[l].is_masked |= light->is_spot && line_distance_m(way_m, ray.direction) *
                                                                   world->units_per_m <
                                                               mask_reach_units;
        }
    }
    for (int l = 0; l < scene->light_count; l++)
        if (isfinite(needs[l].resolved_m))
            choose_cubes(world, l, &needs[l]);
    return NEPH_OK;
}
