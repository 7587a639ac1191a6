/* SPDX-License-Identifier: MIT
 *
 * From a shot to the JSON that scripts/blender_render.py reads.
 */
#include "harness/engines/cycles_spec.h"

#include "scenes/media.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

enum {
    SPEC_FORMAT = 1, /* raised together with blender_render.py */
    VOLUME_STACK = 31,
    SPHERE_SEGMENTS_MIN = 256,
    SPHERE_SEGMENTS_MAX = 2048,
};
_Static_assert(NEPH_SCENE_MEDIA_MAX <= VOLUME_STACK, "Cycles drops overlapping media beyond 31");

/* Cycles drops a scattering closure whose coefficient is below 1e-5 per Blender unit, and clips
 * what is nearer to the camera than 1e-6 units. With this optical depth per unit at the densest
 * point, air thinner than 1e-6 of that does not scatter, and the clip costs at most 1e-5. */
static const double optical_depth_per_unit = 10.0;
static const double thinnest_of_densest = 1e-6;

static const double sphere_error_px = 0.01;
static const double sensor_mm = 24.0; /* height; in blender_render.py too */

/* ---- adapting the scene ---------------------------------------------------------------------- */

static bool is_box(const struct neph_bounds *b)
{
    return isfinite(b->min_m.x) && isfinite(b->min_m.y) && isfinite(b->min_m.z) &&
           isfinite(b->max_m.x) && isfinite(b->max_m.y) && isfinite(b->max_m.z) &&
           b->min_m.x < b->max_m.x && b->min_m.y < b->max_m.y && b->min_m.z < b->max_m.z;
}

static double layer_at_per_m(const struct neph_fog_layer *layer, double y_m)
{
    if (layer->extinction_per_m <= 0.0)
        return 0.0; /* not 0 * inf */
    return layer->extinction_per_m * exp(-layer->falloff_per_m * (y_m - layer->height_m));
}

/* The largest extinction of a medium: that of its bottom. */
static double densest_per_m(const struct neph_medium *medium, const struct neph_bounds *container)
{
    double densest = 0.0;
    for (int i = 0; i < medium->layer_count; i++)
        densest += layer_at_per_m(&medium->layers[i], container->min_m.y);
    return densest;
}

static double shortest_scale_height_m(const struct neph_medium *medium)
{
    double falloff_per_m = 0.0;
    for (int i = 0; i < medium->layer_count; i++)
        if (medium->layers[i].extinction_per_m > 0.0)
            falloff_per_m = fmax(falloff_per_m, medium->layers[i].falloff_per_m);
    return 1.0 / falloff_per_m;
}

static bool has_extinction(const struct neph_medium *medium)
{
    for (int i = 0; i < medium->layer_count; i++)
        if (medium->layers[i].extinction_per_m > 0.0)
            return true;
    return false;
}

static enum neph_status adapt_medium(const struct neph_scene *scene, int index,
                                     struct neph_cycles_world *world, struct neph_diag *diag)
{
    const struct neph_medium *medium = &scene->media[index];
    double cut_error = 0.0;
    if (medium->phase.kind == NEPH_PHASE_RAYLEIGH && scene->scattering != NEPH_SCATTERING_NONE)
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "Rayleigh phase function");
    world->containers[index] = neph_medium_container(scene, medium, &cut_error);
    if (!is_box(&world->containers[index]))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "a medium that cannot be cut to a finite box");
    world->used[index] = true;
    world->scale_height_m[index] = shortest_scale_height_m(medium);
    world->cut_error += cut_error;
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
                         "media whose extinctions differ by more than a factor of 1e6");
    world->unit_m = most > 0.0 ? optical_depth_per_unit / most : 1.0;
    return NEPH_OK;
}

enum neph_status neph_cycles_world(const struct neph_scene *scene, struct neph_cycles_world *world,
                                   struct neph_diag *diag)
{
    struct neph_cycles_world adapted = {.unit_m = 1.0};
    enum neph_status status = NEPH_OK;
    const double lens_mm = sensor_mm / 2.0 / tan(scene->vertical_fov_rad / 2.0);
    if (!(lens_mm >= 1.0 && lens_mm <= 5000.0)) /* Blender would clamp it without a word */
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "a field of view outside 0.3..170 degrees");
    for (int i = 0; i < scene->medium_count && !status; i++)
        if (has_extinction(&scene->media[i]))
            status = adapt_medium(scene, i, &adapted, diag);
    if (!status)
        status = choose_unit(scene, &adapted, diag);
    if (!status)
        *world = adapted;
    return status;
}

/* ---- JSON: every function returns a new reference, or NULL when a number is not finite ---------
 */

static json_t *vector_json(struct neph_vec3 v)
{
    return json_pack("[fff]", v.x, v.y, v.z);
}

static json_t *color_json(struct neph_rgb c)
{
    return json_pack("[fff]", c.r, c.g, c.b);
}

/* How many meridians a sphere needs, and what error is left. The mesh has its corners on the
 * sphere; between them both its meridians and its rings cut 2 (pi/n)^2 / 2 of the radius off. */
static int sphere_segments(const struct neph_solid *sphere, const struct neph_camera *camera,
                           int height_px, double *error_px)
{
    const struct neph_vec3 offset_m = neph_vec3_sub(sphere->center_m, camera->position_m);
    const double tangent_squared = neph_vec3_dot(offset_m, offset_m) -
                                   sphere->radius_m * sphere->radius_m;
    const double px_per_slope = height_px / (2.0 * tan(camera->vertical_fov_rad / 2.0));
    double radius_px = height_px; /* the camera is inside: the silhouette is out of sight */
    if (tangent_squared > 0.0)
        radius_px = px_per_slope * sphere->radius_m / sqrt(tangent_squared);
    double segments = 2.0 * ceil(pi * sqrt(radius_px / sphere_error_px) / 2.0);
    segments = fmin(fmax(segments, SPHERE_SEGMENTS_MIN), SPHERE_SEGMENTS_MAX);
    *error_px = fmax(*error_px, radius_px * pi * pi / (segments * segments));
    return (int)segments;
}

static json_t *solid_json(const struct neph_solid *solid, const struct neph_camera *camera,
                          int height_px, double *error_px)
{
    if (solid->kind == NEPH_SOLID_BOX)
        return json_pack("{s:s, s:o, s:o, s:o}", "kind", "box", "min_m",
                         vector_json(solid->box.min_m), "max_m", vector_json(solid->box.max_m),
                         "albedo", color_json(solid->albedo));
    const int segments = sphere_segments(solid, camera, height_px, error_px);
    return json_pack("{s:s, s:o, s:f, s:i, s:o}", "kind", "sphere", "center_m",
                     vector_json(solid->center_m), "radius_m", solid->radius_m, "segments",
                     segments, "albedo", color_json(solid->albedo));
}

static json_t *solids_json(const struct neph_shot *shot, const struct neph_camera *camera,
                           double *error_px)
{
    json_t *solids = json_array();
    for (int i = 0; i < shot->scene->solid_count; i++) {
        json_t *solid = solid_json(&shot->scene->solids[i], camera, shot->height_px, error_px);
        if (json_array_append_new(solids, solid)) {
            json_decref(solids);
            return NULL;
        }
    }
    return solids;
}

static json_t *layers_json(const struct neph_medium *medium, double bottom_m)
{
    json_t *layers = json_array();
    for (int i = 0; i < medium->layer_count; i++) {
        const struct neph_fog_layer *layer = &medium->layers[i];
        if (layer->extinction_per_m <= 0.0)
            continue;
        if (json_array_append_new(layers, json_pack("{s:f, s:f}", "bottom_per_m",
                                                    layer_at_per_m(layer, bottom_m),
                                                    "falloff_per_m", layer->falloff_per_m))) {
            json_decref(layers);
            return NULL;
        }
    }
    return layers;
}

static json_t *medium_json(const struct neph_medium *medium, const struct neph_bounds *container,
                           double scale_height_m)
{
    const bool isotropic = medium->phase.kind == NEPH_PHASE_ISOTROPIC;
    return json_pack("{s:o, s:o, s:o, s:f, s:o, s:o}", "min_m", vector_json(container->min_m),
                     "max_m", vector_json(container->max_m), "albedo", color_json(medium->albedo),
                     "g", isotropic ? 0.0 : medium->phase.g, "scale_height_m",
                     isinf(scale_height_m) ? json_null() : json_real(scale_height_m), "layers",
                     layers_json(medium, container->min_m.y));
}

static json_t *media_json(const struct neph_scene *scene, const struct neph_cycles_world *world)
{
    json_t *media = json_array();
    for (int i = 0; i < scene->medium_count; i++) {
        if (!world->used[i])
            continue;
        json_t *medium = medium_json(&scene->media[i], &world->containers[i],
                                     world->scale_height_m[i]);
        if (json_array_append_new(media, medium)) {
            json_decref(media);
            return NULL;
        }
    }
    return media;
}

static json_t *sun_json(const struct neph_sun *sun)
{
    if (!sun->present)
        return json_null();
    return json_pack("{s:o, s:o}", "direction", vector_json(sun->direction), "irradiance_w_per_m2",
                     color_json(sun->irradiance_w_per_m2));
}

static json_t *camera_json(const struct neph_camera *camera)
{
    return json_pack("{s:o, s:o, s:o, s:o, s:f}", "position_m", vector_json(camera->position_m),
                     "right", vector_json(camera->right), "up", vector_json(camera->up), "forward",
                     vector_json(camera->forward), "vertical_fov_rad", camera->vertical_fov_rad);
}

/* Blender's seed is a non-negative 32-bit integer. */
static int fold_seed(uint64_t seed)
{
    return (int)((seed ^ (seed >> 31) ^ (seed >> 62)) & 0x7fffffff);
}

static json_t *pass_json(const char *kind, int samples, double step, uint64_t seed)
{
    return json_pack("{s:s, s:i, s:f, s:i}", "kind", kind, "samples", samples, "step", step, "seed",
                     fold_seed(seed));
}

static json_t *passes_json(const struct neph_shot *shot, const struct neph_cycles_quality *quality)
{
    json_t *passes = json_array();
    int failed = 0;
    if (shot->layers & NEPH_LAYER_RADIANCE)
        failed |= json_array_append_new(
            passes, pass_json("radiance", quality->samples, quality->step, shot->seed));
    if (shot->layers & NEPH_LAYER_TRANSMITTANCE)
        failed |= json_array_append_new(
            passes,
            pass_json("transmittance", 1, quality->step / NEPH_CYCLES_FINE_STEPS, shot->seed));
    if (shot->layers & NEPH_LAYER_DEPTH)
        failed |= json_array_append_new(passes, pass_json("depth", 1, quality->step, shot->seed));
    if (!failed)
        return passes;
    json_decref(passes);
    return NULL;
}

/* Adds all members; false when one could not be made. */
static bool fill_spec(json_t *spec, const struct neph_shot *shot,
                      const struct neph_cycles_world *world,
                      const struct neph_cycles_quality *quality, double *error_px)
{
    const struct neph_scene *scene = shot->scene;
    const struct neph_camera camera = neph_scene_camera(scene, shot->frame);
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
        {"origin_m", vector_json(camera.position_m)},
        {"camera", camera_json(&camera)},
        {"sun", sun_json(&scene->sun)},
        {"background_w_per_m2_sr", color_json(scene->background_w_per_m2_sr)},
        {"environment_light", json_boolean(scene->environment_light)},
        {"scattering", json_string(neph_scattering_name(scene->scattering))},
        {"solids", solids_json(shot, &camera, error_px)},
        {"media", media_json(scene, world)},
        {"passes", passes_json(shot, quality)},
    };
    bool complete = true;
    for (size_t i = 0; i < sizeof(members) / sizeof(members[0]); i++)
        if (json_object_set_new(spec, members[i].key, members[i].value))
            complete = false;
    return complete;
}

enum neph_status neph_cycles_spec(const struct neph_shot *shot,
                                  const struct neph_cycles_world *world,
                                  const struct neph_cycles_quality *quality, json_t **spec,
                                  double *error_px, struct neph_diag *diag)
{
    double sphere_px = 0.0;
    json_t *made = json_object();
    if (!fill_spec(made, shot, world, quality, &sphere_px)) {
        json_decref(made);
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "a scene with a number that is not finite or a name that is not UTF-8");
    }
    *error_px = sphere_px;
    *spec = made;
    return NEPH_OK;
}
