/* SPDX-License-Identifier: MIT
 *
 * Places a scene in POV-Ray's units. POV-Ray's tolerances are fixed lengths, and its bounding boxes
 * are floats; both restrict the position of a container's faces (POV-Ray 3.7.0.10, measured and
 * read in its tracepixel.cpp, boxes.cpp and trace.cpp):
 * - A ray ignores hits nearer than 1e-4 units; a shadow ray ignores hits nearer than 1e-3 units to
 *   either of its ends.
 * - The media around the eye are those with the eye inside their float bounding box and inside
 *   their shape. In a world of 2e6 units the float box is off by up to 0.25 units. An eye inside
 *   the shape but outside the float box sees the scene without this medium.
 */
#include "harness/engines/povray_world.h"

#include "harness/engines/baked_scene.h"
#include "harness/engines/povray_exposure.h"
#include "scenes/bounds.h"
#include "scenes/lights.h"
#include "scenes/media.h"
#include "scenes/solids.h"

#include <math.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_SOLID_KIND_COUNT == 3, "a new kind");

/* The radius of the scaled world. POV-Ray ends rays at 1e7 units; the sun is at twice the radius,
 * so no distance exceeds 6e6. With photons the world is small. */
static const double world_radius_units = 2e6;
static const double photon_world_radius_units = 1e4;

/* Twice the distances that POV-Ray ignores. */
static const double hit_units = 2e-4;
static const double face_gap_units = 2e-3;
static const double face_step_units = 4e-3;
enum { face_steps_max = 1000 };
/* More than the error of float bounding boxes: 1/4 for coordinates up to 2e6, and 1/8 more for each
 * rounded coordinate of a ray. */
static const double float_units = 2.0;
static const double solid_minimum_units = 0.02;

static const double extinction_maximum_per_unit = 1e30; /* colours are floats */

/* ---- the world ------------------------------------------------------------------------------- */

static const struct neph_bounds nothing = {{INFINITY, INFINITY, INFINITY},
                                           {-INFINITY, -INFINITY, -INFINITY}};

static struct neph_bounds join(struct neph_bounds a, struct neph_bounds b)
{
    for (int axis = 0; axis < 3; axis++) {
        neph_povray_set_axis(
            &a.min_m, axis, fmin(neph_povray_axis(a.min_m, axis), neph_povray_axis(b.min_m, axis)));
        neph_povray_set_axis(
            &a.max_m, axis, fmax(neph_povray_axis(a.max_m, axis), neph_povray_axis(b.max_m, axis)));
    }
    return a;
}

static bool has_inside(const struct neph_bounds *bounds)
{
    for (int axis = 0; axis < 3; axis++) {
        if (!(neph_povray_axis(bounds->min_m, axis) < neph_povray_axis(bounds->max_m, axis)))
            return false;
    }
    return true;
}

static bool is_finite(const struct neph_bounds *bounds)
{
    struct neph_vec3 size = neph_vec3_sub(bounds->max_m, bounds->min_m);
    return isfinite(size.x) && isfinite(size.y) && isfinite(size.z);
}

static bool is_uniform(const struct neph_medium *medium)
{
    if (!neph_medium_is_fog(medium))
        return false;
    for (int i = 0; i < medium->layer_count; i++) {
        if (medium->layers[i].extinction_per_m > 0.0 && medium->layers[i].falloff_per_m > 0.0)
            return false;
    }
    return true;
}

static bool is_empty(const struct neph_medium *medium)
{
    const struct neph_bounds support = neph_medium_support(medium);
    if (!neph_medium_is_fog(medium))
        return !(neph_medium_extinction_bound_per_m(medium, &support) > 0.0);
    for (int i = 0; i < medium->layer_count; i++) {
        if (medium->layers[i].extinction_per_m > 0.0)
            return !has_inside(&medium->bounds);
    }
    return true;
}

static enum neph_status place_containers(struct neph_povray_world *world, struct neph_diag *diag)
{
    const struct neph_scene *scene = world->scene;
    for (int i = 0; i < scene->medium_count; i++) {
        struct neph_povray_container *container = &world->containers[i];
        if (is_empty(&scene->media[i]))
            continue;
        double cut_error = 0.0;
        container->bounds = neph_medium_container(scene, &scene->media[i], &cut_error);
        if (!is_finite(&container->bounds) || !has_inside(&container->bounds))
            return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "medium %d has no finite bounding box",
                             i + 1);
        container->used = true;
        container->uniform = is_uniform(&scene->media[i]);
        world->cut_error += cut_error;
    }
    return NEPH_OK;
}

static double farthest_corner_m(const struct neph_bounds *bounds, struct neph_vec3 from_m)
{
    double squared = 0.0;
    for (int axis = 0; axis < 3; axis++) {
        double low = neph_povray_axis(bounds->min_m, axis) - neph_povray_axis(from_m, axis);
        double high = neph_povray_axis(bounds->max_m, axis) - neph_povray_axis(from_m, axis);
        squared += fmax(low * low, high * high);
    }
    return sqrt(squared);
}

bool neph_povray_has_photons(const struct neph_scene *scene)
{
    for (int i = 0; i < scene->solid_count; i++)
        if (scene->sun.present && neph_is_mirror(&scene->solids[i].surface))
            return true;
    return false;
}

/* Choose the scale and the origin. The origin is among the solids, where POV-Ray's float bounding
 * boxes must be finest. */
static void choose_units(struct neph_povray_world *world)
{
    struct neph_bounds solids = nothing;
    for (int i = 0; i < world->scene->solid_count; i++)
        solids = join(solids, neph_solid_bounds(&world->scene->solids[i]));
    struct neph_bounds all = solids;
    for (int corner = 0; corner < 4; corner++) {
        const struct neph_pixel_ray ray = neph_camera_ray(
            &world->camera, world->width_px, world->height_px, corner & 1 ? world->width_px - 1 : 0,
            corner & 2 ? world->height_px - 1 : 0);
        all = join(all, (struct neph_bounds){ray.origin_m, ray.origin_m});
    }
    for (int i = 0; i < world->scene->light_count; i++) {
        const struct neph_vec3 at_m = world->scene->lights[i].position_m;
        all = join(all, (struct neph_bounds){at_m, at_m});
    }
    for (int i = 0; i < world->scene->medium_count; i++) {
        if (world->containers[i].used)
            all = join(all, world->containers[i].bounds);
    }
    const struct neph_bounds *middle = world->scene->solid_count > 0 ? &solids : &all;
    world->origin_m = neph_vec3_scale(neph_vec3_add(middle->min_m, middle->max_m), 0.5);
    double radius_m = farthest_corner_m(&all, world->origin_m);
    world->radius_units = neph_povray_has_photons(world->scene) ? photon_world_radius_units
                                                                : world_radius_units;
    world->units_per_m = world->radius_units / (radius_m > 0.0 ? radius_m : 1.0);
}

static enum neph_status check_solids(const struct neph_povray_world *world, struct neph_diag *diag)
{
    for (int i = 0; i < world->scene->solid_count; i++) {
        struct neph_bounds bounds = neph_solid_bounds(&world->scene->solids[i]);
        struct neph_vec3 size_m = neph_vec3_sub(bounds.max_m, bounds.min_m);
        double smallest_m = fmin(size_m.x, fmin(size_m.y, size_m.z));
        if (world->scene->solids[i].kind == NEPH_SOLID_MESH) /* it may be flat */
            smallest_m = fmax(size_m.x, fmax(size_m.y, size_m.z));
        if (!(smallest_m * world->units_per_m >= solid_minimum_units))
            return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "solids of %g m in a world of %g m radius",
                             smallest_m, world->radius_units / world->units_per_m);
    }
    return NEPH_OK;
}

/* The smallest distances of ray origins from the plane of a face, on either side of it [m]. */
struct nearness {
    double inside_m, outside_m; /* an origin on the plane counts as inside; INFINITY: no origin on
                                 * that side */
};

static void add_origin_distance(struct nearness *near, double outward_m)
{
    if (outward_m > 0.0)
        near->outside_m = fmin(near->outside_m, outward_m);
    else
        near->inside_m = fmin(near->inside_m, -outward_m);
}

/* Coordinate `axis` of the origin of a pixel's ray, which is linear in column and row. */
static double origin_m(const struct neph_povray_world *world, int axis, int column, int row)
{
    const struct neph_pixel_ray ray = neph_camera_ray(&world->camera, world->width_px,
                                                      world->height_px, column, row);
    return neph_povray_axis(ray.origin_m, axis);
}

/* The nearest origins on both sides of a plane. A perspective camera has one origin. An
 * orthographic camera has one per pixel; in each image row, the pixels next to the plane are the
 * nearest. */
static struct nearness nearest_origins(const struct neph_povray_world *world, int axis,
                                       double plane_m, double outward)
{
    struct nearness near = {INFINITY, INFINITY};
    const bool is_parallel = world->camera.orthographic_height_m > 0.0;
    const int last = is_parallel ? world->width_px - 1 : 0;
    const int rows = is_parallel ? world->height_px : 1;
    for (int row = 0; row < rows; row++) {
        const double first_m = origin_m(world, axis, 0, row);
        const double end_m = origin_m(world, axis, last, row);
        const double part = end_m == first_m ? 0.0 : (plane_m - first_m) / (end_m - first_m);
        const int column = (int)floor(fmin(1.0, fmax(0.0, part)) * last);
        add_origin_distance(&near, outward * (origin_m(world, axis, column, row) - plane_m));
        if (column < last)
            add_origin_distance(&near,
                                outward * (origin_m(world, axis, column + 1, row) - plane_m));
    }
    return near;
}

static bool is_near(const struct neph_bounds *bounds, int axis, double plane_m, double gap_m)
{
    return fabs(neph_povray_axis(bounds->min_m, axis) - plane_m) < gap_m ||
           fabs(neph_povray_axis(bounds->max_m, axis) - plane_m) < gap_m;
}

/* Whether a container's face in this plane is too near to a solid's face, to an eye or to the face
 * of an earlier container. */
static bool is_crowded(const struct neph_povray_world *world, int container, int axis,
                       double plane_m)
{
    const double gap_m = face_gap_units / world->units_per_m;
    const struct nearness near = nearest_origins(world, axis, plane_m, 1.0);
    if (fmin(near.inside_m, near.outside_m) < gap_m)
        return true;
    for (int i = 0; i < world->scene->solid_count; i++) {
        const struct neph_bounds bounds = neph_solid_bounds(&world->scene->solids[i]);
        if (is_near(&bounds, axis, plane_m, gap_m))
            return true;
    }
    for (int i = 0; i < container; i++)
        if (world->containers[i].used &&
            is_near(&world->containers[i].bounds, axis, plane_m, gap_m))
            return true;
    return false;
}

/* Find a free plane for a face, in steps. The face moves outward, which keeps the visible length of
 * the medium; it moves inward if an eye is just outside, which would otherwise end up inside. */
static enum neph_status find_free_plane(const struct neph_povray_world *world, int container,
                                        int axis, double outward, double *plane_m,
                                        struct neph_diag *diag)
{
    const double gap_m = face_gap_units / world->units_per_m;
    const struct nearness near = nearest_origins(world, axis, *plane_m, outward);
    const bool is_inward = near.outside_m < gap_m && !(near.inside_m < gap_m);
    const double step_m = (is_inward ? -outward : outward) * face_step_units / world->units_per_m;
    for (int i = 0; i <= face_steps_max; i++) {
        if (is_crowded(world, container, axis, *plane_m + i * step_m))
            continue;
        *plane_m += i * step_m;
        return NEPH_OK;
    }
    return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                     "the face %c = %g m of medium %d's box has a pixel's ray beginning or a "
                     "solid's face within %.2g m wherever it is moved within %.2g m",
                     "xyz"[axis], *plane_m, container + 1, gap_m, face_steps_max * fabs(step_m));
}

/* Whether a face of the box around a container is none of its own. */
static bool is_face_turned(const struct neph_medium *medium, int axis)
{
    return neph_is_container_turned(medium) && axis != medium->turn.axis;
}

/* Move the faces of a container until no other face is near: to the inside of a solid that they
 * touch, where they are invisible, or by a few 1e-9 of the world's size. */
static enum neph_status separate_faces(struct neph_povray_world *world, int index,
                                       struct neph_diag *diag)
{
    struct neph_povray_container *container = &world->containers[index];
    const struct neph_medium *medium = &world->scene->media[index];
    const struct neph_bounds before = container->bounds;
    const double float_m = float_units / world->units_per_m;
    double shift_m = 0.0;
    for (int axis = 0; axis < 3; axis++) {
        for (int side = 0; side < 2; side++) {
            const double from_m = neph_povray_axis(side ? before.max_m : before.min_m, axis);
            double plane_m = from_m;
            const enum neph_status status = find_free_plane(world, index, axis, side ? 1.0 : -1.0,
                                                            &plane_m, diag);
            if (status)
                return status;
            neph_povray_set_axis(side ? &container->bounds.max_m : &container->bounds.min_m, axis,
                                 plane_m);
            shift_m = fmax(shift_m, fabs(plane_m - from_m));
            const struct nearness near = nearest_origins(world, axis, plane_m, 1.0);
            container->is_near_an_eye[axis][side] =
                fmin(near.inside_m, near.outside_m) < float_m && !is_face_turned(medium, axis);
        }
    }
    if (!has_inside(&container->bounds))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "medium %d is thinner than the %.2g m by which a face must keep off the "
                         "eye",
                         index + 1, shift_m);
    const double per_m = neph_densest_per_m(medium, &container->bounds);
    container->extinction_per_m = per_m;
    world->shift_error = fmax(world->shift_error, per_m * shift_m);
    return NEPH_OK;
}

static enum neph_status separate_all_faces(struct neph_povray_world *world, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < world->scene->medium_count && !status; i++)
        if (world->containers[i].used)
            status = separate_faces(world, i, diag);
    return status;
}

static enum neph_status check_extinctions(const struct neph_povray_world *world,
                                          struct neph_diag *diag)
{
    for (int i = 0; i < world->scene->medium_count; i++) {
        double per_m = world->containers[i].extinction_per_m;
        if (world->containers[i].used &&
            !(per_m / world->units_per_m < extinction_maximum_per_unit))
            return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                             "medium %d reaches an extinction of %g per metre at the bottom", i + 1,
                             per_m);
    }
    return NEPH_OK;
}

/* Refuse scenes in which a pixel's ray hits a solid nearer than POV-Ray's smallest hit distance:
 * the solid would be invisible. */
static enum neph_status check_hits(const struct neph_povray_world *world, struct neph_diag *diag)
{
    const double nearest_m = hit_units / world->units_per_m;
    for (int pixel = 0; pixel < world->width_px * world->height_px; pixel++) {
        const int column = pixel % world->width_px, row = pixel / world->width_px;
        const struct neph_pixel_ray ray = neph_camera_ray(&world->camera, world->width_px,
                                                          world->height_px, column, row);
        const double hit_m = neph_scene_hit(world->scene, ray.origin_m, ray.direction).t_m;
        if (hit_m < nearest_m)
            return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                             "an eye on a solid: a pixel's ray meets it at %.3g m, nearer than "
                             "%.2g m",
                             hit_m, nearest_m);
    }
    return NEPH_OK;
}

/* Planar depth of the farthest corner of a solid's box. */
static double solid_depth_m(const struct neph_solid *solid, const struct neph_camera *camera)
{
    struct neph_bounds bounds = neph_solid_bounds(solid);
    double depth_m = 0.0;
    for (int axis = 0; axis < 3; axis++) {
        double forward = neph_povray_axis(camera->forward, axis);
        double eye_m = neph_povray_axis(camera->position_m, axis);
        depth_m += fmax(forward * (neph_povray_axis(bounds.min_m, axis) - eye_m),
                        forward * (neph_povray_axis(bounds.max_m, axis) - eye_m));
    }
    return depth_m;
}

static void choose_depth_range(struct neph_povray_world *world)
{
    double depth_m = 0.0;
    for (int i = 0; i < world->scene->solid_count; i++)
        depth_m = fmax(depth_m, solid_depth_m(&world->scene->solids[i], &world->camera));
    world->depth_range_m = depth_m / NEPH_POVRAY_DEPTH_TOP;
}

enum neph_status neph_povray_world(const struct neph_scene *scene, int frame, int width_px,
                                   int height_px, int intervals, struct neph_povray_world *world,
                                   struct neph_diag *diag)
{
    struct neph_povray_world made = {.scene = scene,
                                     .camera = neph_scene_camera(scene, frame),
                                     .width_px = width_px,
                                     .height_px = height_px,
                                     .intervals = intervals};
    if (neph_scene_has_wide_spot(scene))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "%s", neph_wide_spot_reason);
    enum neph_status status = place_containers(&made, diag);
    if (status)
        return status;
    choose_units(&made);
    status = check_solids(&made, diag);
    if (status)
        return status;
    status = separate_all_faces(&made, diag);
    if (status)
        return status;
    status = check_extinctions(&made, diag);
    if (!status && scene->solid_count > 0)
        status = check_hits(&made, diag);
    if (status)
        return status;
    choose_depth_range(&made);
    *world = made;
    return NEPH_OK;
}
