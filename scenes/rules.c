/* SPDX-License-Identifier: MIT
 *
 * What ties the values of a scene file to each other.
 */
#include "base/text.h"
#include "scenes/build.h"
#include "scenes/check.h"
#include "scenes/media.h"
#include "scenes/motion.h"
#include "scenes/volume_file.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

/* Shorter directions are refused: their normalised form would be noise. */
#define DIRECTION_MIN 1e-9
/* A camera nearer to its target than this has no direction of view worth the name. */
#define VIEW_DISTANCE_MIN_M 1e-3
/* Sine of the smallest angle between the view and `up`: below it the picture could turn by any
 * angle with the last bits of the input. */
#define VIEW_SINE_MIN 1e-6
/* Nearer to opposite than this, directions of the sun do not say which way it goes between them. */
#define SUN_SINE_MIN 1e-6
/* As far as a scene file may put a medium itself. */
#define DRIFT_MAX_M 1e6

struct rules {
    struct neph_document *document;
    struct neph_diag *diag;
};

/* A path inside the file, made on the spot: at("media[%d].height_fog", i).text */
struct path {
    char text[NEPH_SCENE_PATH_MAX];
};

static struct path at(const char *format, ...) __attribute__((format(printf, 1, 2)));

static struct path at(const char *format, ...)
{
    struct path path;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(path.text, sizeof(path.text), format, arguments);
    va_end(arguments);
    return path;
}

#define FAIL(rules, path, ...)                                                                     \
    neph_check_fail((rules)->document, (path).text, (rules)->diag, __VA_ARGS__)

static struct neph_vec3 vec3(const double v[3])
{
    return (struct neph_vec3){v[0], v[1], v[2]};
}

/* --- Texts --- */

static bool is_identifier(const char *text)
{
    return strspn(text, "abcdefghijklmnopqrstuvwxyz0123456789_") == strlen(text);
}

static bool has_control(const char *text, const char *except)
{
    const size_t length = strlen(text);
    const bool has_line = strchr(text, '\n') && !strchr(except, '\n');
    return has_line || strchr(text, '\t') || neph_text_first_unfit(text, length) < length;
}

static enum neph_status check_names(const struct rules *rules, const struct neph_raw_scene *raw,
                                    const char *stem)
{
    char quote[NEPH_QUOTE_SIZE];
    if (!is_identifier(raw->name)) {
        return FAIL(rules, at("name"), "'%s' is not a name; use a-z, 0-9 and _ alone",
                    neph_document_quote(raw->name, quote));
    }
    if (strcmp(raw->name, stem)) {
        char stem_quote[NEPH_QUOTE_SIZE];
        return FAIL(rules, at("name"), "'%s' differs from the name of the file, '%s.yaml'",
                    neph_document_quote(raw->name, quote), neph_document_quote(stem, stem_quote));
    }
    if (has_control(raw->title, ""))
        return FAIL(rules, at("title"), "a title is one line without control characters");
    if (has_control(raw->physics, "\n"))
        return FAIL(rules, at("physics"), "control characters in the text");
    return NEPH_OK;
}

static enum neph_status check_gates(const struct rules *rules, const struct neph_raw_scene *raw)
{
    char quote[NEPH_QUOTE_SIZE];
    for (unsigned i = 0; i < raw->gates_count; i++) {
        const struct neph_raw_gate *gate = &raw->gates[i];
        if (!is_identifier(gate->engine)) {
            return FAIL(rules, at("gates[%u].engine", i), "'%s' is not the name of an engine",
                        neph_document_quote(gate->engine, quote));
        }
        if (has_control(gate->reason, "\n"))
            return FAIL(rules, at("gates[%u].reason", i), "control characters in the text");
    }
    return NEPH_OK;
}

/* --- Shared pieces --- */

static enum neph_status check_extent(const struct rules *rules, const char *owner,
                                     const double min_m[3], const double max_m[3])
{
    for (int axis = 0; axis < 3; axis++) {
        if (max_m[axis] > min_m[axis])
            continue;
        return FAIL(rules, at("%s.max_m[%d]", owner, axis), "%g m is not above min_m, %g m",
                    max_m[axis], min_m[axis]);
    }
    return NEPH_OK;
}

static enum neph_status check_optics(const struct rules *rules, const char *owner,
                                     const struct neph_raw_optics *optics)
{
    bool wants_g = optics->phase && *optics->phase == NEPH_PHASE_HENYEY_GREENSTEIN;
    if (wants_g && !optics->asymmetry_g)
        return FAIL(rules, at("%s.phase", owner), "henyey_greenstein needs the key asymmetry_g");
    if (!wants_g && optics->asymmetry_g) {
        return FAIL(rules, at("%s.asymmetry_g", owner),
                    "only phase: henyey_greenstein has an asymmetry");
    }
    const double *color = optics->extinction_color;
    if (color && color[0] + color[1] + color[2] == 0.0)
        return FAIL(rules, at("%s.extinction_color", owner),
                    "a medium that no channel sees; leave it out instead");
    return NEPH_OK;
}

/* --- Frames, camera, sun and wind --- */

static enum neph_status check_order(const struct rules *rules, const char *owner, double before,
                                    double frame)
{
    if (frame > before)
        return NEPH_OK;
    return FAIL(rules, at("%s.frame", owner), "%g is not above the frame of the one before, %g",
                frame, before);
}

static enum neph_status check_frames(const struct rules *rules,
                                     const struct neph_raw_frames *frames)
{
    enum neph_status status = NEPH_OK;
    for (unsigned i = 1; frames && i < frames->pauses_count && !status; i++)
        status = check_order(rules, at("frames.pauses[%u]", i).text, frames->pauses[i - 1].frame,
                             frames->pauses[i].frame);
    for (unsigned i = 1; frames && i < frames->sizes_count && !status; i++)
        status = check_order(rules, at("frames.sizes[%u]", i).text, frames->sizes[i - 1].frame,
                             frames->sizes[i].frame);
    return status;
}

static enum neph_status check_camera(const struct rules *rules,
                                     const struct neph_raw_camera *camera)
{
    if (camera->keys && (camera->position_m || camera->look_at_m)) {
        return FAIL(rules, at("camera.keys"),
                    "give either keys or position_m and look_at_m, "
                    "not both");
    }
    if (!camera->keys && (!camera->position_m || !camera->look_at_m))
        return FAIL(rules, at("camera"), "give position_m and look_at_m, or keys");
    enum neph_status status = NEPH_OK;
    for (unsigned i = 1; i < camera->keys_count && !status; i++)
        status = check_order(rules, at("camera.keys[%u]", i).text, camera->keys[i - 1].frame,
                             camera->keys[i].frame);
    if (status)
        return status;
    if (camera->keys && camera->keys[0].cut)
        return FAIL(rules, at("camera.keys[0].cut"),
                    "the first key has none before it to cut from");
    if (camera->up && neph_vec3_length(vec3(camera->up)) < DIRECTION_MIN)
        return FAIL(rules, at("camera.up"), "a direction of length 0");
    return NEPH_OK;
}

static enum neph_status check_direction(const struct rules *rules, const char *owner,
                                        const double direction[3])
{
    if (neph_vec3_length(vec3(direction)) < DIRECTION_MIN)
        return FAIL(rules, at("%s", owner), "a direction of length 0");
    return NEPH_OK;
}

static enum neph_status check_sun_key(const struct rules *rules,
                                      const struct neph_raw_sun_key *keys, unsigned index)
{
    const struct neph_raw_sun_key *key = &keys[index];
    enum neph_status status = check_direction(rules, at("sun.keys[%u].direction", index).text,
                                              key->direction);
    if (status || index == 0)
        return status;
    status = check_order(rules, at("sun.keys[%u]", index).text, key[-1].frame, key->frame);
    if (status)
        return status;
    const struct neph_vec3 sum = neph_vec3_add(neph_vec3_normalize(vec3(key->direction)),
                                               neph_vec3_normalize(vec3(key[-1].direction)));
    if (neph_vec3_length(sum) >= SUN_SINE_MIN)
        return NEPH_OK;
    return FAIL(rules, at("sun.keys[%u].direction", index),
                "at frame %g the sun is opposite to where it is at frame %g (sun.keys[%u]); give a "
                "key between them that says which way it goes",
                key->frame, key[-1].frame, index - 1);
}

static enum neph_status check_sun(const struct rules *rules, const struct neph_raw_sun *sun)
{
    if (!sun)
        return NEPH_OK;
    if (sun->keys && (sun->direction || sun->irradiance_w_per_m2))
        return FAIL(rules, at("sun.keys"),
                    "give either keys or direction and irradiance_w_per_m2, not both");
    if (!sun->keys && (!sun->direction || !sun->irradiance_w_per_m2))
        return FAIL(rules, at("sun"), "give direction and irradiance_w_per_m2, or keys");
    if (!sun->keys)
        return check_direction(rules, "sun.direction", sun->direction);
    enum neph_status status = NEPH_OK;
    for (unsigned i = 0; i < sun->keys_count && !status; i++)
        status = check_sun_key(rules, sun->keys, i);
    return status;
}

static enum neph_status check_wind(const struct rules *rules, const struct neph_raw_wind *wind)
{
    if (!wind)
        return NEPH_OK;
    if (!wind->keys == !wind->velocity_m_per_s)
        return FAIL(rules, at("wind"), "give exactly one of velocity_m_per_s, keys");
    enum neph_status status = NEPH_OK;
    for (unsigned i = 1; i < wind->keys_count && !status; i++)
        status = check_order(rules, at("wind.keys[%u]", i).text, wind->keys[i - 1].frame,
                             wind->keys[i].frame);
    return status;
}

/* --- Solids --- */

static enum neph_status check_rails(const struct rules *rules, const char *owner,
                                    const struct neph_raw_fence *fence)
{
    const struct neph_raw_rails *rails = fence->rails;
    if (fence->bars < 2)
        return FAIL(rules, at("%s.rails", owner), "rails need at least two bars to join");
    if (rails->depth_m >= fence->bar_depth_m) {
        return FAIL(rules, at("%s.rails.depth_m", owner),
                    "%g m must be below bar_depth_m, %g m, so that no two faces coincide",
                    rails->depth_m, fence->bar_depth_m);
    }
    for (unsigned i = 0; i < rails->heights_m_count; i++) {
        double low = rails->heights_m[i] - 0.5 * rails->width_m;
        double high = rails->heights_m[i] + 0.5 * rails->width_m;
        double floor = i ? rails->heights_m[i - 1] + 0.5 * rails->width_m : 0;
        if (low > floor && high < fence->height_m)
            continue;
        return FAIL(rules, at("%s.rails.heights_m[%u]", owner, i),
                    "the rail spans %g to %g m; it must lie above %g m (the ground or the rail "
                    "before) and below the top of the bars, %g m",
                    low, high, floor, fence->height_m);
    }
    return NEPH_OK;
}

static enum neph_status check_fence(const struct rules *rules, const char *owner,
                                    const struct neph_raw_fence *fence)
{
    if (fence->bars > 1 && fence->bar_width_m >= fence->pitch_m) {
        return FAIL(rules, at("%s.bar_width_m", owner), "%g m leaves no gap at a pitch_m of %g m",
                    fence->bar_width_m, fence->pitch_m);
    }
    if (fence->row_spacing_m && !fence->rows)
        return FAIL(rules, at("%s.row_spacing_m", owner), "a spacing needs the key rows");
    if (fence->rows && !fence->row_spacing_m)
        return FAIL(rules, at("%s.rows", owner), "rows need the key row_spacing_m");
    if (fence->rows && *fence->row_spacing_m <= fence->bar_depth_m) {
        return FAIL(rules, at("%s.row_spacing_m", owner),
                    "%g m leaves no gap between rows that are %g m deep", *fence->row_spacing_m,
                    fence->bar_depth_m);
    }
    return fence->rails ? check_rails(rules, owner, fence) : NEPH_OK;
}

static enum neph_status check_solid(const struct rules *rules, const char *owner,
                                    const struct neph_raw_solid *solid)
{
    if (!!solid->box + !!solid->sphere + !!solid->fence != 1)
        return FAIL(rules, at("%s", owner), "a solid is exactly one of box, sphere, fence");
    if (solid->box) {
        return check_extent(rules, at("%s.box", owner).text, solid->box->min_m, solid->box->max_m);
    }
    if (solid->fence)
        return check_fence(rules, at("%s.fence", owner).text, solid->fence);
    return NEPH_OK;
}

static enum neph_status check_solids(const struct rules *rules, const struct neph_raw_scene *raw)
{
    int count = 0;
    for (unsigned i = 0; i < raw->solids_count; i++) {
        const struct neph_raw_solid *solid = &raw->solids[i];
        enum neph_status status = check_solid(rules, at("solids[%u]", i).text, solid);
        if (status)
            return status;
        count += solid->fence ? neph_fence_solid_count(solid->fence) : 1;
        if (count > NEPH_SCENE_SOLIDS_MAX) {
            return FAIL(rules, at("solids[%u]", i),
                        "the scene would have %d solids with its bars and rails; at most %d are "
                        "allowed",
                        count, NEPH_SCENE_SOLIDS_MAX);
        }
    }
    return NEPH_OK;
}

/* --- Media --- */

/* `bounds` may be NULL. */
static enum neph_status check_optional_bounds(const struct rules *rules, const char *owner,
                                              const struct neph_raw_bounds *bounds)
{
    return bounds ? check_extent(rules, at("%s.bounds", owner).text, bounds->min_m, bounds->max_m)
                  : NEPH_OK;
}

static enum neph_status check_homogeneous(const struct rules *rules, const char *owner,
                                          const struct neph_raw_homogeneous *medium)
{
    enum neph_status status = check_extent(rules, at("%s.bounds", owner).text, medium->bounds.min_m,
                                           medium->bounds.max_m);
    return status ? status : check_optics(rules, owner, &medium->optics);
}

static enum neph_status refuse_level_fog(const struct rules *rules, const char *owner,
                                         const char *key)
{
    enum neph_status status = FAIL(rules, at("%s.%s", owner, key),
                                   "0 makes the layer the same at all heights, and the fog has no "
                                   "bounds");
    neph_hint(rules->diag, "give bounds: without them the sun, which is infinitely far away, would "
                           "never arrive");
    return status;
}

static enum neph_status check_unbounded(const struct rules *rules, const char *owner,
                                        const struct neph_raw_height_fog *fog)
{
    for (unsigned i = 0; i < fog->layers_count; i++)
        if (fog->layers[i].falloff_per_m == 0 && fog->layers[i].extinction_per_m > 0)
            return refuse_level_fog(rules, owner, at("layers[%u].falloff_per_m", i).text);
    for (unsigned i = 0; i < fog->unreal_layers_count; i++)
        if (fog->unreal_layers[i].fog_height_falloff == 0 && fog->unreal_layers[i].fog_density > 0)
            return refuse_level_fog(rules, owner,
                                    at("unreal_layers[%u].fog_height_falloff", i).text);
    return NEPH_OK;
}

static enum neph_status check_height_fog(const struct rules *rules, const char *owner,
                                         const struct neph_raw_height_fog *fog)
{
    if (!fog->layers == !fog->unreal_layers)
        return FAIL(rules, at("%s", owner), "give exactly one of layers, unreal_layers");
    enum neph_status status = fog->bounds ? check_optional_bounds(rules, owner, fog->bounds)
                                          : check_unbounded(rules, owner, fog);
    return status ? status : check_optics(rules, owner, &fog->optics);
}

static enum neph_status check_gaussian(const struct rules *rules, const char *owner,
                                       const struct neph_raw_gaussian *gaussian)
{
    const enum neph_status status = check_optional_bounds(rules, owner, gaussian->bounds);
    return status ? status : check_optics(rules, owner, &gaussian->optics);
}

static enum neph_status check_shell(const struct rules *rules, const char *owner,
                                    const struct neph_raw_shell *shell)
{
    enum neph_status status = check_extent(rules, at("%s.bounds", owner).text, shell->bounds.min_m,
                                           shell->bounds.max_m);
    return status ? status : check_optics(rules, owner, &shell->optics);
}

static enum neph_status check_grid(const struct rules *rules, const char *owner,
                                   const struct neph_raw_grid *grid)
{
    const long wanted = (long)grid->size[0] * grid->size[1] * grid->size[2];
    if (wanted != (long)grid->values_count)
        return FAIL(rules, at("%s.values", owner), "%u values for %d x %d x %d = %ld nodes",
                    grid->values_count, grid->size[0], grid->size[1], grid->size[2], wanted);
    const enum neph_status status = check_optional_bounds(rules, owner, grid->bounds);
    return status ? status : check_optics(rules, owner, &grid->optics);
}

static enum neph_status check_volume(const struct rules *rules, const char *owner,
                                     const struct neph_raw_volume *volume)
{
    if (volume->file[0] != '$' && !neph_volume_has_known_extension(volume->file))
        return FAIL(rules, at("%s.file", owner), "'%s' must end in .vdb or .df3", volume->file);
    const enum neph_status status = check_optional_bounds(rules, owner, volume->bounds);
    return status ? status : check_optics(rules, owner, &volume->optics);
}

static enum neph_status check_horizon(const struct rules *rules, const char *owner,
                                      const struct neph_raw_horizon *horizon)
{
    enum neph_status status = check_extent(rules, at("%s.bounds", owner).text,
                                           horizon->bounds.min_m, horizon->bounds.max_m);
    return status ? status : check_optics(rules, owner, &horizon->optics);
}

static enum neph_status check_medium(const struct rules *rules, const char *owner,
                                     const struct neph_raw_medium *medium)
{
    const int kinds = !!medium->homogeneous + !!medium->height_fog + !!medium->gaussian +
                      !!medium->shell + !!medium->grid + !!medium->volume + !!medium->horizon;
    if (kinds != 1)
        return FAIL(rules, at("%s", owner),
                    "a medium is exactly one of homogeneous, height_fog, gaussian, shell, grid, "
                    "volume, horizon");
    if (medium->homogeneous)
        return check_homogeneous(rules, at("%s.homogeneous", owner).text, medium->homogeneous);
    if (medium->height_fog)
        return check_height_fog(rules, at("%s.height_fog", owner).text, medium->height_fog);
    if (medium->gaussian)
        return check_gaussian(rules, at("%s.gaussian", owner).text, medium->gaussian);
    if (medium->shell)
        return check_shell(rules, at("%s.shell", owner).text, medium->shell);
    if (medium->volume)
        return check_volume(rules, at("%s.volume", owner).text, medium->volume);
    if (medium->horizon)
        return check_horizon(rules, at("%s.horizon", owner).text, medium->horizon);
    return check_grid(rules, at("%s.grid", owner).text, medium->grid);
}

static enum neph_status check_media(const struct rules *rules, const struct neph_raw_scene *raw)
{
    for (unsigned i = 0; i < raw->media_count; i++) {
        enum neph_status status = check_medium(rules, at("media[%u]", i).text, &raw->media[i]);
        if (status)
            return status;
    }
    return NEPH_OK;
}

enum neph_status neph_check_rules(struct neph_document *document, const struct neph_raw_scene *raw,
                                  const char *stem, struct neph_diag *diag)
{
    const struct rules rules = {document, diag};
    enum neph_status status = check_names(&rules, raw, stem);
    if (!status)
        status = check_frames(&rules, raw->frames);
    if (!status)
        status = check_camera(&rules, &raw->camera);
    if (!status)
        status = check_sun(&rules, raw->sun);
    if (!status)
        status = check_wind(&rules, raw->wind);
    if (!status)
        status = check_solids(&rules, raw);
    if (!status)
        status = check_media(&rules, raw);
    if (!status)
        status = check_gates(&rules, raw);
    return status;
}

/* --- Camera and wind in the finished scene --- */

static bool is_inside(const struct neph_solid *solid, struct neph_vec3 p)
{
    if (solid->kind == NEPH_SOLID_SPHERE)
        return neph_vec3_length(neph_vec3_sub(p, solid->center_m)) <= solid->radius_m;
    const struct neph_vec3 *low = &solid->box.min_m, *high = &solid->box.max_m;
    return p.x >= low->x && p.x <= high->x && p.y >= low->y && p.y <= high->y && p.z >= low->z &&
           p.z <= high->z;
}

/* Where the file says how the camera stands at a frame of the keys: the last one not after it. */
static struct path camera_path(const struct neph_scene *scene, struct neph_document *document,
                               double frame, const char *key)
{
    if (neph_document_find(document, "camera.keys")->type != YAML_SEQUENCE_NODE)
        return at("camera.%s", key);
    int index = 0;
    while (index + 1 < scene->camera_key_count && scene->camera_keys[index + 1].frame <= frame)
        index++;
    return at("camera.keys[%d].%s", index, key);
}

static enum neph_status check_view(const struct rules *rules, const struct neph_scene *scene,
                                   double frame)
{
    struct neph_camera_key key = neph_camera_key_at(scene, frame);
    struct neph_vec3 view = neph_vec3_sub(key.look_at_m, key.position_m);
    double distance_m = neph_vec3_length(view);
    if (distance_m < VIEW_DISTANCE_MIN_M) {
        return FAIL(rules, camera_path(scene, rules->document, frame, "look_at_m"),
                    "at frame %g the camera is %g m from the point it looks at; at least %g m are "
                    "needed",
                    frame, distance_m, VIEW_DISTANCE_MIN_M);
    }
    double sine = neph_vec3_length(neph_vec3_cross(view, scene->camera_up)) / distance_m;
    if (sine < VIEW_SINE_MIN) {
        return FAIL(rules, camera_path(scene, rules->document, frame, "look_at_m"),
                    "at frame %g the camera looks along its up direction; turn the view or give "
                    "another camera.up",
                    frame);
    }
    for (int i = 0; i < scene->solid_count; i++) {
        if (is_inside(&scene->solids[i], key.position_m)) {
            return FAIL(rules, camera_path(scene, rules->document, frame, "position_m"),
                        "at frame %g the camera is inside a solid (number %d of the %d in the "
                        "scene, bars counted)",
                        frame, i + 1, scene->solid_count);
        }
    }
    return NEPH_OK;
}

/* The wind must have something to move, and must leave it where renderers can still see it. */
static enum neph_status check_drift(const struct rules *rules, const struct neph_scene *scene)
{
    bool any = false;
    for (int i = 0; i < scene->medium_count; i++)
        any |= neph_medium_drifts(&scene->media[i]);
    if (!any)
        return FAIL(rules, at("wind"),
                    "no medium of the scene drifts: wind moves gaussian, grid, "
                    "volume and horizon media and those with voxels");
    for (int frame = 0; frame < scene->frame_count; frame++) {
        const double way_m = neph_vec3_length(neph_scene_wind_displacement_m(scene, frame));
        if (way_m > DRIFT_MAX_M)
            return FAIL(rules, at("wind"),
                        "at frame %d it has carried the media %g m far; at most %g m are allowed",
                        frame, way_m, DRIFT_MAX_M);
    }
    return NEPH_OK;
}

enum neph_status neph_check_scene(struct neph_document *document, const struct neph_scene *scene,
                                  struct neph_diag *diag)
{
    const struct rules rules = {document, diag};
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < scene->camera_key_count && !status; i++)
        status = check_view(&rules, scene, scene->camera_keys[i].frame);
    for (int frame = 0; frame < scene->frame_count && !status; frame++)
        status = check_view(&rules, scene, neph_scene_time_frame(scene, frame));
    if (!status && scene->wind_key_count > 0)
        status = check_drift(&rules, scene);
    return status;
}
