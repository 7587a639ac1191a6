/* SPDX-License-Identifier: MIT
 *
 * Converts a shot to the JSON that scripts/blender_render.py reads.
 */
#include "harness/engines/cycles_spec.h"

#include "harness/engines/baked_scene.h"
#include "harness/engines/cycles_mesh.h"
#include "harness/engines/cycles_phase.h"
#include "harness/engines/cycles_surface.h"
#include "harness/engines/scene_json.h"

#include "scenes/emission.h"
#include "scenes/grid.h"
#include "scenes/lights.h"
#include "scenes/media.h"
#include "scenes/solids.h"

#include <math.h>
#include <stdio.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");
_Static_assert(NEPH_SOLID_KIND_COUNT == 3, "a new kind");

enum {
    SPEC_FORMAT = 8, /* change together with blender_render.py */
    VOLUME_STACK = 31,
    SPHERE_SEGMENTS_MIN = 256,
    SPHERE_SEGMENTS_MAX = 2048,
};
_Static_assert(NEPH_SCENE_MEDIA_MAX <= VOLUME_STACK, "Cycles drops overlapping media beyond 31");

/* Cycles drops a scattering closure with a coefficient below 1e-5 per Blender unit, and clips
 * geometry nearer to the camera than 1e-6 units. The unit is chosen so that the densest point has
 * this optical depth per unit. Then only air thinner than 1e-6 of the densest medium does not
 * scatter, and the clipping costs at most 1e-5. */
static const double optical_depth_per_unit = 10.0;
static const double thinnest_of_densest = 1e-6;

/* Far clipping distance of Blender (scripts/blender_render.py). It also cuts media: fog beyond it
 * would disappear. */
static const double clip_end_units = 1e9;

/* Some tens of ulps in single precision. */
static const double face_step = 4e-6;

static const double sphere_error_px = 0.01;
static const double sensor_mm = 24.0; /* sensor height, same as in blender_render.py */

/* Lower limit of Blender's property. The property has no upper limit: 5000 mm is only the limit of
 * the slider. */
static const double shortest_lens_mm = 1.0;

/* ---- adapting the scene ---------------------------------------------------------------------- */

static bool is_box(const struct neph_bounds *b)
{
    return isfinite(b->min_m.x) && isfinite(b->min_m.y) && isfinite(b->min_m.z) &&
           isfinite(b->max_m.x) && isfinite(b->max_m.y) && isfinite(b->max_m.z) &&
           b->min_m.x < b->max_m.x && b->min_m.y < b->max_m.y && b->min_m.z < b->max_m.z;
}

static double brightest(struct neph_rgb color)
{
    return fmax(color.r, fmax(color.g, color.b));
}

/* The largest extinction of a medium in any channel (for fog: at its bottom). */
static double densest_per_m(const struct neph_medium *medium, const struct neph_bounds *container)
{
    return neph_densest_per_m(medium, container) * brightest(medium->extinction_color);
}

static double shortest_scale_height_m(const struct neph_medium *medium)
{
    double falloff_per_m = 0.0;
    for (int i = 0; i < medium->layer_count; i++)
        if (medium->layers[i].extinction_per_m > 0.0)
            falloff_per_m = fmax(falloff_per_m, medium->layers[i].falloff_per_m);
    return 1.0 / falloff_per_m;
}

/* The feature length of a grid: steps must resolve its cells, and the error grows with the optical
 * depth of a step. */
static double grid_feature_m(const struct neph_medium *medium, double densest)
{
    const struct neph_vec3 h = medium->grid->spacing_m;
    return fmin(1.0 / densest, fmin(h.x, fmin(h.y, h.z)));
}

/* The length over which the extinction changes: the unit of the option `step`. Media that will be
 * baked have none yet. */
static double feature_m(const struct neph_medium *medium, double densest)
{
    if (neph_medium_is_fog(medium))
        return shortest_scale_height_m(medium);
    return medium->grid ? grid_feature_m(medium, densest) : INFINITY;
}

static double *vector_component(struct neph_vec3 *v, int axis)
{
    return axis == 0 ? &v->x : axis == 1 ? &v->y : &v->z;
}

/* Whether the faces of two boxes perpendicular to an axis overlap in projection along it. */
static bool faces_cover(const struct neph_bounds *a, const struct neph_bounds *b, int axis)
{
    struct neph_bounds x = *a, y = *b; /* vector_component() needs mutable vectors */
    for (int k = 0; k < 3; k++)
        if (k != axis && (*vector_component(&x.min_m, k) >= *vector_component(&y.max_m, k) ||
                          *vector_component(&y.min_m, k) >= *vector_component(&x.max_m, k)))
            return false;
    return true;
}

static bool face_is_taken(struct neph_cycles_world *world, int index, int axis, double plane_m,
                          double gap_m)
{
    for (int i = 0; i < index; i++)
        if (world->used[i] && faces_cover(&world->containers[i], &world->containers[index], axis) &&
            (fabs(*vector_component(&world->containers[i].min_m, axis) - plane_m) < gap_m ||
             fabs(*vector_component(&world->containers[i].max_m, axis) - plane_m) < gap_m))
            return true;
    return false;
}

/* Cycles loses one of two media with a common face. So the faces of fogs move outward, in steps of
 * face_step of the box size, until no other face is in the same plane. */
static void separate_faces(const struct neph_scene *scene, int index,
                           struct neph_cycles_world *world)
{
    struct neph_bounds *box = &world->containers[index];
    const double step_m = face_step * neph_vec3_length(neph_vec3_sub(box->max_m, box->min_m));
    double moved_m = 0.0;
    for (int axis = 0; axis < 3; axis++)
        for (int side = -1; side <= 1; side += 2) {
            double *face_m = vector_component(side < 0 ? &box->min_m : &box->max_m, axis);
            const double from_m = *face_m;
            while (face_is_taken(world, index, axis, *face_m, 0.5 * step_m))
                *face_m += side * step_m;
            moved_m = fmax(moved_m, fabs(*face_m - from_m));
        }
    world->cut_error += moved_m * densest_per_m(&scene->media[index], box);
}

static enum neph_status adapt_medium(const struct neph_scene *scene, int index,
                                     struct neph_cycles_world *world, struct neph_diag *diag)
{
    const struct neph_medium *medium = &scene->media[index];
    double cut_error = 0.0;
    world->containers[index] = neph_medium_container(scene, medium, &cut_error);
    if (!is_box(&world->containers[index]))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "a medium that cannot be cut to a finite box");
    if (neph_medium_is_fog(medium))
        separate_faces(scene, index, world);
    world->used[index] = true;
    world->feature_m[index] = feature_m(medium, densest_per_m(medium, &world->containers[index]));
    world->cut_error += cut_error;
    return NEPH_OK;
}

static double farthest_m(const struct neph_bounds *box, struct neph_vec3 eye_m)
{
    const struct neph_vec3 low = neph_vec3_sub(eye_m, box->min_m);
    const struct neph_vec3 high = neph_vec3_sub(box->max_m, eye_m);
    const struct neph_vec3 most = {fmax(fabs(low.x), fabs(high.x)), fmax(fabs(low.y), fabs(high.y)),
                                   fmax(fabs(low.z), fabs(high.z))};
    return neph_vec3_length(most);
}

static enum neph_status check_reach(const struct neph_scene *scene,
                                    const struct neph_cycles_world *world, struct neph_diag *diag)
{
    const struct neph_camera camera = neph_scene_camera(scene, 0.0);
    for (int i = 0; i < scene->medium_count; i++)
        if (world->used[i] &&
            farthest_m(&world->containers[i], camera.position_m) > clip_end_units * world->unit_m)
            return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                             "a medium that goes on for more than 1e10 mean free paths of its "
                             "densest point: Blender clips it away");
    return NEPH_OK;
}

static enum neph_status choose_unit(const struct neph_scene *scene, struct neph_cycles_world *world,
                                    struct neph_diag *diag)
{
    double most = 0.0, least = INFINITY; /* extinction of the densest and the thinnest medium */
    for (int i = 0; i < scene->medium_count; i++) {
        if (!world->used[i])
            continue;
        const double densest = densest_per_m(&scene->media[i], &world->containers[i]);
        most = fmax(most, densest);
        least = fmin(least, densest);
    }
    if (!isfinite(most))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "a medium of infinite extinction");
    if (most > 0.0 && least < thinnest_of_densest * most)
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "media with extinctions that differ by more than a factor of 1e6");
    world->unit_m = most > 0.0 ? optical_depth_per_unit / most : 1.0;
    return check_reach(scene, world, diag);
}

enum neph_status neph_cycles_world(const struct neph_scene *scene, struct neph_cycles_world *world,
                                   struct neph_diag *diag)
{
    struct neph_cycles_world adapted = {.unit_m = 1.0};
    enum neph_status status = NEPH_OK;
    const double lens_mm = sensor_mm / 2.0 / tan(scene->vertical_fov_rad / 2.0);
    if (scene->orthographic_height_m == 0.0 &&
        !(lens_mm >= shortest_lens_mm)) /* Blender would clamp it silently */
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "a field of view above 170.4 degrees: Blender has no lens below 1 mm");
    if (neph_cycles_surface_obstacle(scene))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "%s", neph_cycles_surface_obstacle(scene));
    if (neph_scene_has_wide_spot(scene))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "%s", neph_wide_spot_reason);
    for (int i = 0; i < scene->medium_count && !status; i++)
        if (neph_cycles_has_extinction(&scene->media[i]))
            status = adapt_medium(scene, i, &adapted, diag);
    if (!status && scene->scattering != NEPH_SCATTERING_NONE)
        status = neph_cycles_check_phases(scene, adapted.containers, diag);
    if (!status)
        status = choose_unit(scene, &adapted, diag);
    if (!status)
        *world = adapted;
    return status;
}

/* ---- JSON: each function returns a new reference, or NULL for a number that is not finite ---- */

/* Radius of a sphere's silhouette in pixels; the image height for an eye inside the sphere, which
 * sees no silhouette. */
static double sphere_radius_px(const struct neph_solid *sphere, const struct neph_camera *camera,
                               int height_px)
{
    if (camera->orthographic_height_m > 0.0)
        return height_px * sphere->radius_m / camera->orthographic_height_m;
    const struct neph_vec3 offset_m = neph_vec3_sub(sphere->center_m, camera->position_m);
    const double tangent_squared = neph_vec3_dot(offset_m, offset_m) -
                                   sphere->radius_m * sphere->radius_m;
    const double px_per_slope = height_px / (2.0 * tan(camera->vertical_fov_rad / 2.0));
    return tangent_squared > 0.0 ? px_per_slope * sphere->radius_m / sqrt(tangent_squared)
                                 : height_px;
}

/* The number of meridians of a sphere's mesh, and the remaining error in pixels. The vertices lie
 * on the sphere; between them, meridians and rings each cut (pi/n)^2 / 2 off the radius, together 2
 * (pi/n)^2 / 2. */
static int sphere_segments(const struct neph_solid *sphere, const struct neph_camera *camera,
                           int height_px, double *error_px)
{
    const double radius_px = sphere_radius_px(sphere, camera, height_px);
    double segments = 2.0 * ceil(M_PI * sqrt(radius_px / sphere_error_px) / 2.0);
    segments = fmin(fmax(segments, SPHERE_SEGMENTS_MIN), SPHERE_SEGMENTS_MAX);
    *error_px = fmax(*error_px, radius_px * M_PI * M_PI / (segments * segments));
    return (int)segments;
}

/* A rotation: world axis, cosine and sine; null: none. */
static json_t *turn_json(const struct neph_turn *turn)
{
    return neph_is_turned(turn) ? json_pack("[iff]", turn->axis, turn->cosine, turn->sine)
                                : json_null();
}

static json_t *shape_json(const struct neph_scene *scene, const struct neph_solid *solid,
                          int segments)
{
    switch (solid->kind) {
    case NEPH_SOLID_BOX:
        return json_pack("{s:s, s:o, s:o, s:o}", "kind", "box", "min_m",
                         neph_vector_json(solid->box.min_m), "max_m",
                         neph_vector_json(solid->box.max_m), "turn", turn_json(&solid->turn));
    case NEPH_SOLID_SPHERE:
        return json_pack("{s:s, s:o, s:f, s:i}", "kind", "sphere", "center_m",
                         neph_vector_json(solid->center_m), "radius_m", solid->radius_m, "segments",
                         segments);
    case NEPH_SOLID_MESH:
        return neph_cycles_mesh(scene, solid);
    case NEPH_SOLID_KIND_COUNT:
        break;
    }
    return NULL;
}

static json_t *solid_json(const struct neph_scene *scene, const struct neph_solid *solid,
                          const struct neph_camera *camera, int height_px, double *error_px)
{
    const int segments = solid->kind == NEPH_SOLID_SPHERE
                             ? sphere_segments(solid, camera, height_px, error_px)
                             : 0;
    json_t *json = shape_json(scene, solid, segments);
    neph_json_set(&json, "albedo", neph_colour_json(solid->albedo));
    neph_json_set(&json, "surface", neph_cycles_surface(&solid->surface));
    return json;
}

static json_t *solids_json(const struct neph_shot *shot, const struct neph_camera *camera,
                           double *error_px)
{
    json_t *solids = json_array();
    for (int i = 0; i < shot->scene->solid_count; i++)
        neph_json_add(&solids, solid_json(shot->scene, &shot->scene->solids[i], camera,
                                          shot->height_px, error_px));
    return solids;
}

static json_t *layers_json(const struct neph_medium *medium, double bottom_m)
{
    json_t *layers = json_array();
    for (int i = 0; i < medium->layer_count; i++) {
        const struct neph_fog_layer *layer = &medium->layers[i];
        if (layer->extinction_per_m > 0.0)
            neph_json_add(&layers, json_pack("{s:f, s:f}", "bottom_per_m",
                                             neph_fog_layer_per_m(layer, bottom_m), "falloff_per_m",
                                             layer->falloff_per_m));
    }
    return layers;
}

/* A medium; its extinction is given by layers, or by a file beside the spec
 * (neph_cycles_grid()). */
static json_t *medium_json(int index, const struct neph_medium *medium,
                           const struct neph_bounds *container, double length_m)
{
    const struct neph_bounds own = neph_own_container(medium, container);
    json_t *json = json_pack(
        "{s:o, s:o, s:o, s:f, s:o, s:o, s:o, s:o}", "min_m", neph_vector_json(own.min_m), "max_m",
        neph_vector_json(own.max_m), "turn",
        neph_is_container_turned(medium) ? turn_json(&medium->turn) : json_null(), "bottom_m",
        container->min_m.y, "extinction_color",
        neph_colour_json(medium->extinction_color), "albedo", neph_colour_json(medium->albedo),
        "lobes", neph_cycles_lobes(&medium->phase), "feature_m",
        isinf(length_m) ? json_null() : json_real(length_m));
    char file[NEPH_CYCLES_FILE_NAME_MAX];
    neph_cycles_grid_name(index, file);
    if (neph_medium_is_fog(medium))
        neph_json_set(&json, "layers", layers_json(medium, container->min_m.y));
    else
        neph_json_set(
            &json, "grid",
            json_pack("{s:s, s:f}", "file", file, "extinction_per_m", medium->extinction_per_m));
    if (neph_medium_emits(medium))
        neph_json_set(&json, "glow_w_per_m2_sr", neph_colour_json(neph_medium_glow(medium)));
    return json;
}

static json_t *media_json(const struct neph_scene *scene, const struct neph_cycles_world *world)
{
    json_t *media = json_array();
    for (int i = 0; i < scene->medium_count; i++)
        if (world->used[i])
            neph_json_add(&media, medium_json(i, &scene->media[i], &world->containers[i],
                                              world->feature_m[i]));
    return media;
}

static json_t *camera_json(const struct neph_camera *camera)
{
    const bool is_parallel = camera->orthographic_height_m > 0.0;
    return json_pack("{s:o, s:o, s:o, s:o, s:f}", "position_m",
                     neph_vector_json(camera->position_m), "right", neph_vector_json(camera->right),
                     "up", neph_vector_json(camera->up), "forward",
                     neph_vector_json(camera->forward),
                     is_parallel ? "orthographic_height_m" : "vertical_fov_rad",
                     is_parallel ? camera->orthographic_height_m : camera->vertical_fov_rad);
}

/* Fold a seed to Blender's range, non-negative 32-bit integers. */
static int fold_seed(uint64_t seed)
{
    return (int)((seed ^ (seed >> 31) ^ (seed >> 62)) & 0x7fffffff);
}

/* One render pass. `channel` below 0: all three channels. `is_unbiased`: volumes without steps. */
static json_t *pass_json(const char *kind, int channel, int samples, double step, double grid_step,
                         uint64_t seed, bool is_unbiased)
{
    return json_pack("{s:s, s:o, s:i, s:f, s:f, s:i, s:b}", "kind", kind, "channel",
                     channel < 0 ? json_null() : json_integer(channel), "samples", samples, "step",
                     step, "grid_step", grid_step, "seed", fold_seed(seed), "is_unbiased",
                     is_unbiased);
}

bool neph_cycles_is_coloured(const struct neph_scene *scene)
{
    for (int i = 0; i < scene->medium_count; i++)
        if (neph_medium_is_coloured(&scene->media[i]))
            return true;
    return false;
}

bool neph_cycles_has_emission_pictures(const struct neph_scene *scene)
{
    return neph_scene_emits(scene) && scene->scattering != NEPH_SCATTERING_MULTIPLE;
}

static json_t *passes_json(const struct neph_shot *shot, const struct neph_cycles_quality *quality)
{
    const double step = quality->step, fine = step / NEPH_CYCLES_FINE_STEPS,
                 fine_grid = step / NEPH_CYCLES_FINE_GRID_STEPS;
    const bool coloured = neph_cycles_is_coloured(shot->scene);
    const bool emits = neph_cycles_has_emission_pictures(shot->scene);
    json_t *passes = json_array();
    for (int channel = coloured ? 0 : -1;
         (shot->layers & NEPH_LAYER_RADIANCE) && channel < (coloured ? 3 : 0); channel++) {
        neph_json_add(&passes, pass_json("radiance", channel, quality->samples, step, step,
                                         shot->seed, quality->is_unbiased));
        if (emits) /* emission is free of noise: one sample, with the steps of the transmittance
                    * pass */
            neph_json_add(&passes,
                          pass_json("emission", channel, 1, fine, fine_grid, shot->seed, false));
    }
    if (shot->layers & NEPH_LAYER_TRANSMITTANCE)
        neph_json_add(&passes,
                      pass_json("transmittance", -1, 1, fine, fine_grid, shot->seed, false));
    if (shot->layers & NEPH_LAYER_DEPTH)
        neph_json_add(&passes, pass_json("depth", -1, 1, step, step, shot->seed, false));
    return passes;
}

/* The distance limit of ambient occlusion; null: no limit. */
static json_t *ambient_json(const struct neph_cycles_quality *quality)
{
    return json_pack("{s:o}", "ao_distance_m",
                     quality->ao_distance_m > 0.0 ? json_real(quality->ao_distance_m)
                                                  : json_null());
}

void neph_cycles_grid_name(int index, char name[NEPH_CYCLES_FILE_NAME_MAX])
{
    snprintf(name, NEPH_CYCLES_FILE_NAME_MAX, "medium%d.vdb", index + 1);
}

struct neph_grid neph_cycles_grid(const struct neph_grid *grid, const struct neph_camera *camera,
                                  double unit_m)
{
    struct neph_grid placed = *grid;
    placed.origin_m = neph_vec3_scale(neph_vec3_sub(grid->origin_m, camera->position_m),
                                      1.0 / unit_m);
    placed.spacing_m = neph_vec3_scale(grid->spacing_m, 1.0 / unit_m);
    return placed;
}

enum neph_status neph_cycles_spec(const struct neph_shot *shot,
                                  const struct neph_cycles_world *world,
                                  const struct neph_cycles_quality *quality, json_t **spec,
                                  double *error_px, struct neph_diag *diag)
{
    const struct neph_scene *scene = shot->scene;
    const struct neph_camera camera = neph_scene_camera(scene, shot->frame);
    double sphere_px = 0.0;
    const struct {
        const char *key;
        json_t *value;
    } members[] = {
        {"format", json_integer(SPEC_FORMAT)},
        {"scene", json_string(scene->name ? scene->name : "")},
        {"width_px", json_integer(shot->width_px)},
        {"height_px", json_integer(shot->height_px)},
        {"threads", json_integer(quality->threads)},
        {"unit_m", json_real(world->unit_m)},
        {"origin_m", neph_vector_json(camera.position_m)},
        {"camera", camera_json(&camera)},
        {"sun", neph_sun_json(&scene->sun)},
        {"lights", neph_lights_json(scene, shot->frame)},
        {"background_w_per_m2_sr", neph_colour_json(scene->background_w_per_m2_sr)},
        {"environment_light", json_boolean(scene->environment_light)},
        {"scattering", json_string(neph_scattering_name(scene->scattering))},
        {"solids", solids_json(shot, &camera, &sphere_px)},
        {"media", media_json(scene, world)},
        {"passes", passes_json(shot, quality)},
        {"surface_layers", quality->surface_layers ? ambient_json(quality) : json_null()},
    };
    json_t *made = json_object();
    for (size_t i = 0; i < sizeof(members) / sizeof(members[0]); i++)
        neph_json_set(&made, members[i].key, members[i].value);
    if (!made)
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "a scene with a number that is not finite or a name that is not UTF-8");
    *error_px = sphere_px;
    *spec = made;
    return NEPH_OK;
}
