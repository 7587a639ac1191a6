/* SPDX-License-Identifier: MIT */
#include "scenes/motion.h"

#include "scenes/injection.h"
#include "scenes/media.h"
#include "scenes/solids.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_SOLID_KIND_COUNT == 3, "a new kind");

/* --- between keys ---------------------------------------------------------------------------- */

static struct neph_rgb mix_rgb(struct neph_rgb a, struct neph_rgb b, double part)
{
    return neph_rgb_add(neph_rgb_scale(a, 1.0 - part), neph_rgb_scale(b, part));
}

/* Shoemake, "Animating Rotation with Quaternion Curves", SIGGRAPH 1985, for unit vectors that are
 * not opposite. atan2 is accurate at any angle; the error of a small angle cancels in the
 * result. */
static struct neph_vec3 slerp(struct neph_vec3 a, struct neph_vec3 b, double part)
{
    const double angle_rad = atan2(neph_vec3_length(neph_vec3_cross(a, b)), neph_vec3_dot(a, b));
    if (angle_rad == 0.0)
        return a;
    const struct neph_vec3 start = neph_vec3_scale(a, sin((1.0 - part) * angle_rad));
    return neph_vec3_normalize(neph_vec3_along(start, b, sin(part * angle_rad)));
}

/* --- frames and key frames ------------------------------------------------------------------- */

void neph_scene_frame_size(const struct neph_scene *scene, double frame, int *width_px,
                           int *height_px)
{
    double scale = 1.0;
    for (int i = 0; i < scene->frame_scale_count && scene->frame_scales[i].frame <= frame; i++)
        scale = scene->frame_scales[i].scale;
    *width_px = (int)fmax(1.0, round(*width_px * scale));
    *height_px = (int)fmax(1.0, round(*height_px * scale));
}

/* --- camera ---------------------------------------------------------------------------------- */

bool neph_scene_is_cut(const struct neph_scene *scene, double frame_from, double frame_to)
{
    const double earlier = neph_scene_time_frame(scene, fmin(frame_from, frame_to));
    const double later = neph_scene_time_frame(scene, fmax(frame_from, frame_to));
    for (int i = 0; i < scene->camera_key_count; i++) {
        const struct neph_camera_key *key = &scene->camera_keys[i];
        if (key->cut && key->frame > earlier && key->frame <= later)
            return true;
    }
    return false;
}

/* --- sun, lights and wind -------------------------------------------------------------------- */

struct neph_sun neph_scene_sun(const struct neph_scene *scene, double frame)
{
    if (scene->sun_key_count == 0)
        return scene->sun;
    const struct neph_sun_key *keys = scene->sun_keys;
    const struct neph_span span = neph_span_at(keys, sizeof(*keys), scene->sun_key_count,
                                               neph_scene_time_frame(scene, frame));
    const struct neph_sun_key *a = &keys[span.from], *b = &keys[span.to];
    return (struct neph_sun){
        .present = true,
        .direction = slerp(a->direction, b->direction, span.part),
        .irradiance_w_per_m2 = mix_rgb(a->irradiance_w_per_m2, b->irradiance_w_per_m2, span.part),
    };
}

struct neph_light neph_place_light(const struct neph_light *light, double key_frame)
{
    struct neph_light placed = *light;
    placed.keys = NULL;
    placed.key_count = 0;
    if (light->key_count == 0)
        return placed;
    const struct neph_light_key *keys = light->keys;
    const struct neph_span span = neph_span_at(keys, sizeof(*keys), light->key_count, key_frame);
    const struct neph_light_key *a = &keys[span.from], *b = &keys[span.to];
    const double part = b->cut ? 0.0 : span.part;
    placed.position_m = neph_mix(a->position_m, b->position_m, part);
    placed.intensity_w_per_sr = mix_rgb(a->intensity_w_per_sr, b->intensity_w_per_sr, part);
    if (light->is_spot)
        placed.axis = part > 0.0 ? slerp(a->axis, b->axis, part) : a->axis;
    return placed;
}

struct neph_light neph_scene_light(const struct neph_scene *scene, int index, double frame)
{
    return neph_place_light(&scene->lights[index], neph_scene_time_frame(scene, frame));
}

static struct neph_vec3 velocity_at(const struct neph_scene *scene, double key_frame)
{
    const struct neph_wind_key *keys = scene->wind_keys;
    const struct neph_span span = neph_span_at(keys, sizeof(*keys), scene->wind_key_count,
                                               key_frame);
    return neph_mix(keys[span.from].velocity_m_per_s, keys[span.to].velocity_m_per_s, span.part);
}

/* The integral of the velocity over frames [start, end], split at the keys: the mean of a linear
 * piece is its value at the centre. */
static struct neph_vec3 integrate_wind(const struct neph_scene *scene, double start, double end)
{
    struct neph_vec3 sum = {0, 0, 0};
    for (int i = 0; i <= scene->wind_key_count && start < end; i++) {
        const double cut = i < scene->wind_key_count ? fmin(scene->wind_keys[i].frame, end) : end;
        if (cut <= start)
            continue;
        sum = neph_vec3_along(sum, velocity_at(scene, 0.5 * (start + cut)), cut - start);
        start = cut;
    }
    return sum;
}

struct neph_vec3 neph_scene_wind_displacement_m(const struct neph_scene *scene, double frame)
{
    if (scene->wind_key_count == 0)
        return (struct neph_vec3){0, 0, 0};
    const double key_frame = neph_scene_time_frame(scene, frame);
    const double frame_s = (key_frame < 0.0 ? -1.0 : 1.0) / scene->frame_rate_hz;
    return neph_vec3_scale(integrate_wind(scene, fmin(0.0, key_frame), fmax(0.0, key_frame)),
                           frame_s);
}

bool neph_scene_is_clear(const struct neph_scene *scene, double frame)
{
    const double key_frame = neph_scene_time_frame(scene, frame);
    for (int i = 0; i < scene->clear_count; i++)
        if (key_frame >= scene->clears[i].frame &&
            key_frame < (double)scene->clears[i].frame + scene->clears[i].count)
            return true;
    return false;
}

/* --- solids ---------------------------------------------------------------------------------- */

static struct neph_placing placing_at(const struct neph_mover *mover, double key_frame)
{
    const struct neph_solid_key *keys = mover->keys;
    const struct neph_span span = neph_span_at(keys, sizeof(*keys), mover->key_count, key_frame);
    const struct neph_solid_key *a = &keys[span.from], *b = &keys[span.to];
    const double turn_rad = a->turn_rad + span.part * (b->turn_rad - a->turn_rad);
    return (struct neph_placing){
        .turn = {mover->axis, cos(turn_rad), sin(turn_rad)},
        .pivot_m = mover->pivot_m,
        .move_m = neph_mix(a->move_m, b->move_m, span.part),
    };
}

struct neph_placing neph_mover_placing(const struct neph_scene *scene,
                                       const struct neph_mover *mover, double frame)
{
    return placing_at(mover, neph_scene_time_frame(scene, frame));
}

static struct neph_vec3 place_point_m(const struct neph_placing *placing, struct neph_vec3 point_m)
{
    const struct neph_vec3 arm_m = neph_vec3_sub(point_m, placing->pivot_m);
    return neph_vec3_add(neph_vec3_add(placing->pivot_m, neph_rotate(&placing->turn, arm_m)),
                         placing->move_m);
}

struct neph_vec3 neph_find_earlier_place_m(const struct neph_placing *now,
                                           const struct neph_placing *before,
                                           struct neph_vec3 point_m)
{
    const struct neph_vec3 arm_m = neph_vec3_sub(neph_vec3_sub(point_m, now->move_m), now->pivot_m);
    return place_point_m(before, neph_vec3_add(now->pivot_m, neph_rotate_back(&now->turn, arm_m)));
}

/* A solid without rotation keeps its simple form. */
static struct neph_solid place_solid(const struct neph_placing *placing, struct neph_solid solid)
{
    if (solid.kind == NEPH_SOLID_BOX) {
        const struct neph_vec3 middle_m = neph_vec3_scale(
            neph_vec3_add(solid.box.min_m, solid.box.max_m), 0.5);
        const struct neph_vec3 by_m = neph_vec3_sub(place_point_m(placing, middle_m), middle_m);
        solid.box = neph_bounds_translate(solid.box, by_m);
    } else {
        solid.center_m = place_point_m(placing, solid.center_m);
    }
    if (solid.kind == NEPH_SOLID_SPHERE)
        return solid;
    if (placing->turn.sine != 0.0 || placing->turn.cosine != 1.0)
        solid.turn = placing->turn;
    return solid;
}

struct neph_solid neph_scene_solid_at(const struct neph_scene *scene, int index, double key_frame)
{
    for (int i = 0; i < scene->mover_count; i++) {
        const struct neph_mover *mover = &scene->movers[i];
        if (index < mover->first || index >= mover->first + mover->count)
            continue;
        const struct neph_placing placing = placing_at(mover, key_frame);
        return place_solid(&placing, scene->solids[index]);
    }
    return scene->solids[index];
}

struct neph_solid neph_scene_solid(const struct neph_scene *scene, int index, double frame)
{
    return neph_scene_solid_at(scene, index, neph_scene_time_frame(scene, frame));
}

/* --- content of frames ----------------------------------------------------------------------- */

static bool has_moving_lights(const struct neph_scene *scene)
{
    for (int i = 0; i < scene->light_count; i++)
        if (scene->lights[i].key_count > 0)
            return true;
    return false;
}

bool neph_scene_moves(const struct neph_scene *scene)
{
    return scene->sun_key_count > 0 || scene->wind_key_count > 0 || scene->mover_count > 0 ||
           scene->clear_count > 0 || has_moving_lights(scene);
}

/* All content of a frame that changes over time; only doubles, so that bytes can be compared. */
struct transforms {
    struct neph_camera camera;
    struct neph_vec3 sun_direction, wind_m;
    struct neph_rgb sun_w_per_m2;
    double width_px, height_px; /* of a frame of the largest requested size */
    double is_clear;
};
_Static_assert(sizeof(struct transforms) == 26 * sizeof(double), "no padding");

static struct transforms transforms_at(const struct neph_scene *scene, double frame)
{
    const struct neph_sun sun = neph_scene_sun(scene, frame);
    int width_px = 16384, height_px = 16384;
    neph_scene_frame_size(scene, frame, &width_px, &height_px);
    return (struct transforms){
        .camera = neph_scene_camera(scene, frame),
        .sun_direction = sun.direction,
        .sun_w_per_m2 = sun.irradiance_w_per_m2,
        .wind_m = neph_scene_wind_displacement_m(scene, frame),
        .width_px = width_px,
        .height_px = height_px,
        .is_clear = neph_scene_is_clear(scene, frame),
    };
}

static bool are_solids_same(const struct neph_scene *scene, double frame_a, double frame_b)
{
    for (int i = 0; i < scene->mover_count; i++) {
        const struct neph_placing a = neph_mover_placing(scene, &scene->movers[i], frame_a);
        const struct neph_placing b = neph_mover_placing(scene, &scene->movers[i], frame_b);
        if (memcmp(&a.move_m, &b.move_m, sizeof(a.move_m)) != 0 || a.turn.sine != b.turn.sine ||
            a.turn.cosine != b.turn.cosine)
            return false;
    }
    return true;
}

static bool are_lights_same(const struct neph_scene *scene, double frame_a, double frame_b)
{
    for (int i = 0; i < scene->light_count; i++) {
        const struct neph_light a = neph_scene_light(scene, i, frame_a);
        const struct neph_light b = neph_scene_light(scene, i, frame_b);
        if (memcmp(&a.position_m, &b.position_m, sizeof(a.position_m)) != 0 ||
            memcmp(&a.axis, &b.axis, sizeof(a.axis)) != 0 ||
            memcmp(&a.intensity_w_per_sr, &b.intensity_w_per_sr, sizeof(a.intensity_w_per_sr)) != 0)
            return false;
    }
    return true;
}

bool neph_scene_are_frames_equal(const struct neph_scene *scene, double frame_a, double frame_b)
{
    const struct transforms a = transforms_at(scene, frame_a), b = transforms_at(scene, frame_b);
    return memcmp(&a, &b, sizeof(a)) == 0 && are_lights_same(scene, frame_a, frame_b) &&
           are_solids_same(scene, frame_a, frame_b);
}

bool neph_scene_is_static(const struct neph_scene *scene)
{
    for (int frame = 1; frame < scene->frame_count; frame++)
        if (!neph_scene_are_frames_equal(scene, 0, frame))
            return false;
    return true;
}

/* --- the static scene of a frame ------------------------------------------------------------- */

/* One block, freed with one call; the scene comes first. */
struct static_scene {
    struct neph_scene scene;
    struct neph_camera_key camera_key;
    /* For neph_medium_borrow() of each medium, then solids that move, and their tree. */
    max_align_t rooms[];
};

static size_t count_units(size_t bytes)
{
    return (bytes + sizeof(max_align_t) - 1) / sizeof(max_align_t);
}

static size_t count_medium_units(const struct neph_medium *medium)
{
    return count_units(neph_medium_storage_bytes(medium));
}

/* Gives the scene its own copies of the media, which can move. Returns the memory after them. */
static max_align_t *place_media(struct static_scene *static_scene, struct neph_vec3 by_m)
{
    max_align_t *room = static_scene->rooms;
    for (int i = 0; i < static_scene->scene.medium_count; i++) {
        struct neph_medium *medium = &static_scene->scene.media[i];
        neph_medium_borrow(medium, room);
        room += count_medium_units(medium);
        neph_medium_drift(medium, by_m);
    }
    return room;
}

/* Whether the scene needs its own copies of the solids, which can move. */
static bool has_own_solids(const struct neph_scene *scene)
{
    return scene->mover_count > 0 || neph_scene_injections(scene)->origin_count > 0;
}

/* Places them in the memory, and then their tree. */
static void place_solids(const struct neph_scene *scene, double frame, max_align_t *memory,
                         struct neph_scene *static_scene)
{
    const int count = scene->solid_count;
    struct neph_solid *solids = (void *)memory;
    for (int i = 0; i < count; i++)
        solids[i] = neph_scene_solid(scene, i, frame);
    static_scene->solids = solids;
    static_scene->solid_tree = NULL;
    if (neph_scene_tree_bytes(count) > 0)
        static_scene->solid_tree = neph_scene_tree_build(
            solids, count, memory + count_units((size_t)count * sizeof(*solids)));
}

/* Removes the keys, whose values are applied now. */
static void stop_time(struct neph_scene *scene)
{
    scene->pause_count = scene->frame_scale_count = scene->advance_count = 0;
    scene->sun_key_count = scene->wind_key_count = scene->clear_count = scene->mover_count = 0;
    scene->pauses = NULL;
    scene->clears = NULL;
    scene->movers = NULL;
    scene->frame_scales = NULL;
    scene->sun_keys = NULL;
    scene->wind_keys = NULL;
}

enum neph_status neph_scene_at(const struct neph_scene *scene, double frame,
                               struct neph_scene **static_scene, struct neph_diag *diag)
{
    const int solids = has_own_solids(scene) ? scene->solid_count : 0;
    size_t room = count_units((size_t)solids * sizeof(*scene->solids)) +
                  count_units(neph_scene_tree_bytes(solids));
    for (int i = 0; i < scene->medium_count; i++)
        room += count_medium_units(&scene->media[i]);
    struct static_scene *made = calloc(1, sizeof(*made) + room * sizeof(made->rooms[0]));
    if (!made)
        return neph_fail_memory(diag);
    made->scene = *scene;
    made->scene.borrows = true;
    made->camera_key = neph_camera_key_at(scene, neph_scene_time_frame(scene, frame));
    made->scene.camera_keys = &made->camera_key;
    made->scene.camera_key_count = 1;
    made->scene.sun = neph_scene_sun(scene, frame);
    for (int i = 0; i < scene->light_count; i++)
        made->scene.lights[i] = neph_scene_light(scene, i, frame);
    max_align_t *behind = place_media(made, neph_scene_wind_displacement_m(scene, frame));
    if (has_own_solids(scene))
        place_solids(scene, frame, behind, &made->scene);
    if (scene->mover_count > 0)
        made->scene.unmoved_solids = scene->solids;
    if (neph_scene_is_clear(scene, frame))
        made->scene.medium_count = 0;
    stop_time(&made->scene);
    *static_scene = &made->scene;
    return NEPH_OK;
}

void neph_scene_shift(struct neph_scene *static_scene, struct neph_vec3 by_m)
{
    struct neph_camera_key *key = static_scene->camera_keys;
    static_scene->shift_m = neph_vec3_add(static_scene->shift_m, by_m);
    key->position_m = neph_vec3_add(key->position_m, by_m);
    key->look_at_m = neph_vec3_add(key->look_at_m, by_m);
    for (int i = 0; i < static_scene->medium_count; i++)
        neph_medium_shift(&static_scene->media[i], by_m);
    for (int i = 0; i < static_scene->light_count; i++)
        static_scene->lights[i].position_m = neph_vec3_add(static_scene->lights[i].position_m,
                                                           by_m);
    for (int i = 0; i < static_scene->solid_count; i++) {
        static_scene->solids[i].center_m = neph_vec3_add(static_scene->solids[i].center_m, by_m);
        static_scene->solids[i].box = neph_bounds_translate(static_scene->solids[i].box, by_m);
    }
    if (static_scene->solid_tree)
        neph_scene_tree_build(static_scene->solids, static_scene->solid_count,
                              static_scene->solid_tree);
}
