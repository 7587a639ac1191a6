/* SPDX-License-Identifier: MIT */
#include "scenes/fog_translation.h"

#include "scenes/emission.h"
#include "scenes/media.h"

#include <stdio.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_FOG_MODEL_COUNT == 2, "a new kind");
_Static_assert(NEPH_MEDIUM_KIND_COUNT == 8, "a new kind");
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");

const struct neph_medium *neph_fog_look_medium(const struct neph_scene *scene)
{
    for (int m = 0; m < scene->medium_count; m++)
        if (scene->media[m].kind == NEPH_MEDIUM_HEIGHT_FOG)
            return &scene->media[m];
    return NULL;
}

/* albedo times the sun's irradiance times a phase function. */
static struct neph_rgb scattered_once(const struct neph_scene *scene, struct neph_rgb albedo,
                                      double per_sr)
{
    const struct neph_rgb sun = scene->sun.irradiance_w_per_m2;
    if (!scene->sun.present || scene->scattering == NEPH_SCATTERING_NONE)
        return (struct neph_rgb){0.0, 0.0, 0.0};
    return (struct neph_rgb){albedo.r * sun.r * per_sr, albedo.g * sun.g * per_sr,
                             albedo.b * sun.b * per_sr};
}

struct neph_fog_look neph_fog_look_of_physics(const struct neph_scene *scene,
                                              const struct neph_medium *fog)
{
    const struct neph_fog_look none = {.present = true, .directional_exponent = 4.0};
    struct neph_fog_look look = neph_fog_look_only(&none, 0);
    const double g = neph_phase_mean_cosine(&fog->phase);
    const struct neph_rgb glow = neph_medium_glow(fog);
    look.inscattering_w_per_m2_sr = glow;
    if (g > 0.5) {
        look.directional_exponent = fmin((2.0 * g - 1.0) / (1.0 - g), NEPH_FOG_EXPONENT_MAX);
        look.directional_w_per_m2_sr = scattered_once(
            scene, fog->albedo, (look.directional_exponent + 1.0) / (2.0 * M_PI));
        return look;
    }
    const struct neph_rgb even = scattered_once(scene, fog->albedo, 0.25 / M_PI);
    look.inscattering_w_per_m2_sr = (struct neph_rgb){glow.r + even.r, glow.g + even.g,
                                                      glow.b + even.b};
    return look;
}

static bool has_ends(const struct neph_bounds *bounds)
{
    return isfinite(bounds->min_m.x) || isfinite(bounds->min_m.y) || isfinite(bounds->min_m.z) ||
           isfinite(bounds->max_m.x) || isfinite(bounds->max_m.y) || isfinite(bounds->max_m.z);
}

/* The reason for which the model does not support the fog itself; NULL: it does. */
static const char *find_obstacle_in_fog(const struct neph_medium *fog, enum neph_fog_model model)
{
    if (has_ends(&fog->bounds))
        return "fog with bounds: non-physical fog fills all space";
    if (neph_medium_is_coloured(fog))
        return "extinction that differs between the channels: non-physical fog has one opacity";
    if (model == NEPH_FOG_FILAMENT && fog->layer_count > 1)
        return "a second layer of fog: Filament has one";
    return NULL;
}

/* The reason for which the model does not support the scene; NULL: it does. In some frames all
 * media may be absent. */
static const char *find_obstacle(const struct neph_scene *scene, enum neph_fog_model model)
{
    const struct neph_medium *fog = neph_fog_look_medium(scene);
    if (!scene->fog_look.present)
        return "a scene without the key fog_look, which has the controls of non-physical fog";
    if (scene->light_count > 0)
        return "lights: non-physical fog supports only the sun";
    if (scene->orthographic_height_m > 0.0)
        return "an orthographic camera: distances of non-physical fog need one camera position";
    return fog ? find_obstacle_in_fog(fog, model) : NULL;
}

static bool says(const char *obstacle, char *reason, size_t reason_size)
{
    if (obstacle)
        snprintf(reason, reason_size, "%s", obstacle);
    return obstacle;
}

bool neph_fog_look_is_among(const struct neph_scene *scene, enum neph_fog_model model, char *reason,
                            size_t reason_size)
{
    return !says(find_obstacle(scene, model), reason, reason_size);
}

bool neph_fog_look_is_of(const struct neph_scene *scene, enum neph_fog_model model, char *reason,
                         size_t reason_size)
{
    const char *beside = scene->fog_look.present && scene->medium_count > 1
                             ? "media beside the fog, which this engine does not render: use march "
                               "or realtime with fog=unreal or fog=filament"
                             : NULL;
    return !says(beside, reason, reason_size) &&
           neph_fog_look_is_among(scene, model, reason, reason_size);
}

struct neph_scene neph_fog_look_rest(const struct neph_scene *scene)
{
    struct neph_scene rest = *scene;
    rest.borrows = true;
    rest.medium_count = 0;
    for (int m = 0; m < scene->medium_count; m++)
        if (scene->media[m].kind != NEPH_MEDIUM_HEIGHT_FOG)
            rest.media[rest.medium_count++] = scene->media[m];
    if (rest.medium_count == 0)
        rest.scattering = NEPH_SCATTERING_NONE;
    return rest;
}
