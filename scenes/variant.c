/* SPDX-License-Identifier: MIT */
#include "scenes/variant.h"

#include "scenes/motion.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_VARIANT_KIND_COUNT == 3, "a new kind");

const int neph_variant_periods[NEPH_VARIANT_PERIOD_COUNT] = {16, 32, 64};

/* A step of two stops is far above noise and dither and fits on a display. Three sines of 0.3 of
 * the light leave at least a tenth of it. */
static const double step_factor = 4.0, sine_share = 0.3;

/* --- kinds ------------------------------------------------------------------------------------ */

static const char *sun_obstacle(const struct neph_scene *scene)
{
    if (!scene->sun.present)
        return "it has no sun";
    return scene->sun_key_count > 0 ? "its sun moves already (sun.keys)" : NULL;
}

static const char *camera_obstacle(const struct neph_scene *scene)
{
    if (scene->orthographic_height_m > 0.0)
        return "its camera is orthographic, without an angle to turn by";
    return scene->camera_key_count > 1 ? "its camera moves already (camera.keys)" : NULL;
}

static const struct {
    const char *name;
    const char *title; /* appended to the scene's title */
    const char *(*obstacle)(const struct neph_scene *scene);
} kinds[NEPH_VARIANT_KIND_COUNT] = {
    [NEPH_VARIANT_SUN_STEP] = {"sun_step", "its sun four times as bright from frame", sun_obstacle},
    [NEPH_VARIANT_SUN_SINE] = {"sun_sine",
                               "its sun oscillates with periods of 16, 32 and 64 frames",
                               sun_obstacle},
    [NEPH_VARIANT_CAMERA_CUT] = {"camera_cut", "its camera turned at once at frame",
                                 camera_obstacle},
};

const char *neph_variant_name(enum neph_variant_kind kind)
{
    return kinds[kind].name;
}

const char *neph_variant_obstacle(const struct neph_scene *scene, enum neph_variant_kind kind)
{
    if (scene->advance_count > 0)
        return "its time is uneven (frames.advance), and so is its light";
    if (scene->pause_count > 0)
        return "its time stands still in pauses (frames.pauses), and its light with it";
    return kinds[kind].obstacle(scene);
}

/* --- the keys --------------------------------------------------------------------------------- */

/* One block, freed with one call; the scene comes first. There is at most one key a frame. */
_Static_assert(NEPH_VARIANT_FRAMES_MAX <= NEPH_SCENE_KEYS_MAX, "a key a frame");
struct made {
    struct neph_scene scene;
    struct neph_camera_key camera_keys[2];
    struct neph_sun_key sun_keys[NEPH_VARIANT_FRAMES_MAX];
    char texts[]; /* name, then title */
};

static double brightness(const struct neph_variant *variant, int frame)
{
    double sum = 0.0;
    if (variant->kind == NEPH_VARIANT_SUN_STEP)
        return frame < variant->frame ? 1.0 : step_factor;
    for (int k = 0; k < NEPH_VARIANT_PERIOD_COUNT; k++) {
        const int period = neph_variant_periods[k];
        sum += sin(2.0 * M_PI * (frame % period) / period);
    }
    return 1.0 + sine_share * sum;
}

static void add_sun_key(struct neph_scene *scene, const struct neph_variant *variant, int frame)
{
    scene->sun_keys[scene->sun_key_count++] = (struct neph_sun_key){
        .frame = frame,
        .direction = scene->sun.direction,
        .irradiance_w_per_m2 = neph_rgb_scale(scene->sun.irradiance_w_per_m2,
                                              brightness(variant, frame)),
    };
}

static void key_sun(struct made *made, const struct neph_variant *variant)
{
    const bool steps = variant->kind == NEPH_VARIANT_SUN_STEP;
    const int first = steps ? variant->frame - 1 : 0;
    const int last = steps ? variant->frame : variant->frame_count - 1;
    made->scene.sun_keys = made->sun_keys;
    for (int frame = first; frame <= last; frame++)
        add_sun_key(&made->scene, variant, frame);
}

static void key_camera(struct made *made, const struct neph_variant *variant)
{
    const struct neph_camera camera = neph_scene_camera(&made->scene, 0.0);
    const struct neph_camera_key *key = &made->scene.camera_keys[0];
    const double distance_m = neph_vec3_length(neph_vec3_sub(key->look_at_m, key->position_m));
    const double turn_rad = 0.5 * camera.vertical_fov_rad;
    const struct neph_vec3 ahead = neph_vec3_along(neph_vec3_scale(camera.forward, cos(turn_rad)),
                                                   camera.right, sin(turn_rad));
    made->camera_keys[0] = *key;
    made->camera_keys[1] = (struct neph_camera_key){
        .frame = variant->frame,
        .position_m = key->position_m,
        .look_at_m = neph_vec3_along(key->position_m, ahead, distance_m),
        .cut = true,
    };
    made->scene.camera_keys = made->camera_keys;
    made->scene.camera_key_count = 2;
}

/* --- the scene -------------------------------------------------------------------------------- */

static enum neph_status check(const struct neph_scene *scene, const struct neph_variant *variant,
                              struct neph_diag *diag)
{
    const char *obstacle = neph_variant_obstacle(scene, variant->kind);
    if (obstacle)
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "%s has no variant %s: %s", scene->name,
                         kinds[variant->kind].name, obstacle);
    if (variant->frame_count < 2 || variant->frame_count > NEPH_VARIANT_FRAMES_MAX)
        return neph_fail(diag, NEPH_ERR_USAGE, "a variant has 2..%d frames, not %d",
                         NEPH_VARIANT_FRAMES_MAX, variant->frame_count);
    if (variant->kind != NEPH_VARIANT_SUN_SINE &&
        (variant->frame < 1 || variant->frame >= variant->frame_count))
        return neph_fail(diag, NEPH_ERR_USAGE,
                         "of %d frames the %s can be at frame 1..%d, not at %d",
                         variant->frame_count, kinds[variant->kind].name, variant->frame_count - 1,
                         variant->frame);
    return NEPH_OK;
}

static struct made *create(const struct neph_scene *scene, const struct neph_variant *variant)
{
    const char *what = kinds[variant->kind].name, *words = kinds[variant->kind].title;
    char frame[16] = "";
    if (variant->kind != NEPH_VARIANT_SUN_SINE)
        snprintf(frame, sizeof(frame), " %d", variant->frame);
    const int name_size = snprintf(NULL, 0, "%s_%s", scene->name, what) + 1;
    const int title_size = snprintf(NULL, 0, "%s; %s%s", scene->title, words, frame) + 1;
    struct made *made = calloc(1, sizeof(*made) + (size_t)(name_size + title_size));
    if (!made)
        return NULL;
    made->scene = *scene;
    made->scene.borrows = true;
    made->scene.is_as_filed = !scene->borrows || scene->is_as_filed;
    made->scene.name = made->texts;
    made->scene.title = made->texts + name_size;
    snprintf(made->texts, (size_t)name_size, "%s_%s", scene->name, what);
    snprintf(made->texts + name_size, (size_t)title_size, "%s; %s%s", scene->title, words, frame);
    return made;
}

enum neph_status neph_scene_variant(const struct neph_scene *scene,
                                    const struct neph_variant *variant, struct neph_scene **made,
                                    struct neph_diag *diag)
{
    enum neph_status status = check(scene, variant, diag);
    if (status)
        return status;
    struct made *created = create(scene, variant);
    if (!created)
        return neph_fail_memory(diag);
    created->scene.frame_count = variant->frame_count;
    if (variant->kind == NEPH_VARIANT_CAMERA_CUT)
        key_camera(created, variant);
    else
        key_sun(created, variant);
    status = neph_scene_hash(&created->scene, diag);
    if (status)
        neph_scene_destroy(&created->scene);
    else
        *made = &created->scene;
    return status;
}
