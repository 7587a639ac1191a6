/* SPDX-License-Identifier: MIT */
#include "scenes/relit.h"

#include "scenes/emission.h"
#include "scenes/media.h"
#include "scenes/motion.h"

#include <stdlib.h>

/* One block, freed with one call; the scene comes first. */
struct made {
    struct neph_scene scene;
    struct neph_sun_key sun_keys[2];
    struct neph_solid solids[];
};

static const struct neph_rgb black = {0, 0, 0}, white = {1, 1, 1};

/* --- obstacles -------------------------------------------------------------------------------- */

static const char *find_obstacle(const struct neph_scene *scene, const struct neph_relight *light)
{
    if (!scene->sun.present && (isnan(light->sun_elevation_rad) || isnan(light->sun_azimuth_rad)))
        return "it has no sun, and is given none";
    if (neph_scene_emits(scene))
        return "a medium emits light of its own";
    if (scene->light_count > 0)
        return "it has lights beside the sun";
    for (int m = 0; m < scene->medium_count; m++)
        if (neph_medium_is_coloured(&scene->media[m]))
            return "the extinction of a medium has a colour";
    return NULL;
}

static bool is_outside(double value, double least, double most)
{
    return !isnan(value) && !(value >= least && value <= most);
}

static enum neph_status check(const struct neph_scene *scene, const struct neph_relight *light,
                              struct neph_diag *diag)
{
    const char *obstacle = find_obstacle(scene, light);
    if (obstacle)
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "%s cannot be relit: %s", scene->name,
                         obstacle);
    if (is_outside(light->sun_elevation_rad, -0.5 * M_PI, 0.5 * M_PI))
        return neph_fail(diag, NEPH_ERR_USAGE,
                         "a sun %g degrees above the horizon, outside the range",
                         light->sun_elevation_rad / NEPH_RAD_PER_DEG);
    if (!(light->sun_sinks_rad >= 0.0 && light->sun_sinks_rad <= 0.5))
        return neph_fail(diag, NEPH_ERR_USAGE, "a sun that sinks by %g radians, outside 0..0.5",
                         light->sun_sinks_rad);
    if (is_outside(light->g, -0.999, 0.999))
        return neph_fail(diag, NEPH_ERR_USAGE, "g is %g, outside -0.999..0.999", light->g);
    if (is_outside(light->albedo, 0.0, 1.0))
        return neph_fail(diag, NEPH_ERR_USAGE, "the albedo is %g, outside 0..1", light->albedo);
    if (is_outside(light->density, 1e-6, 1e6))
        return neph_fail(diag, NEPH_ERR_USAGE,
                         "the density is %g times the scene's, outside "
                         "1e-6..1e6",
                         light->density);
    return NEPH_OK;
}

/* --- the light -------------------------------------------------------------------------------- */

/* The horizontal direction of the view; for a vertical view the direction of the image's top. */
static struct neph_vec3 ahead_of(const struct neph_scene *scene)
{
    const struct neph_camera camera = neph_scene_camera(scene, 0.0);
    struct neph_vec3 ahead = {camera.forward.x, 0.0, camera.forward.z};
    if (neph_vec3_length(ahead) < 1e-9)
        ahead = (struct neph_vec3){camera.up.x, 0.0, camera.up.z};
    if (neph_vec3_length(ahead) < 1e-9)
        ahead = (struct neph_vec3){0.0, 0.0, -1.0};
    return neph_vec3_normalize(ahead);
}

static struct neph_vec3 right_of(struct neph_vec3 ahead)
{
    return neph_vec3_cross(ahead, (struct neph_vec3){0.0, 1.0, 0.0});
}

static double elevation_rad_of(struct neph_vec3 sun)
{
    return asin(fmin(fmax(sun.y, -1.0), 1.0));
}

static double azimuth_rad_of(const struct neph_scene *scene, struct neph_vec3 sun)
{
    const struct neph_vec3 ahead = ahead_of(scene);
    return atan2(neph_vec3_dot(sun, right_of(ahead)), neph_vec3_dot(sun, ahead));
}

struct neph_relight neph_relight_of(const struct neph_scene *scene)
{
    struct neph_relight light = {NAN, NAN, NAN, NAN, NAN, 0.0};
    if (scene->sun.present) {
        light.sun_elevation_rad = elevation_rad_of(scene->sun.direction);
        light.sun_azimuth_rad = azimuth_rad_of(scene, scene->sun.direction);
    }
    if (scene->medium_count > 0) {
        const struct neph_medium *medium = &scene->media[0];
        light.g = neph_phase_mean_cosine(&medium->phase);
        light.albedo = medium->albedo.g;
        light.density = medium->extinction_color.g;
    }
    return light;
}

static struct neph_vec3 sun_direction(const struct neph_scene *scene,
                                      const struct neph_relight *light)
{
    const struct neph_vec3 up = {0.0, 1.0, 0.0}, ahead = ahead_of(scene);
    const struct neph_vec3 old = scene->sun.direction;
    const double elevation_rad = isnan(light->sun_elevation_rad) ? elevation_rad_of(old)
                                                                 : light->sun_elevation_rad;
    const double azimuth_rad = isnan(light->sun_azimuth_rad) ? azimuth_rad_of(scene, old)
                                                             : light->sun_azimuth_rad;
    const struct neph_vec3 across = neph_vec3_along(neph_vec3_scale(ahead, cos(azimuth_rad)),
                                                    right_of(ahead), sin(azimuth_rad));
    return neph_vec3_along(neph_vec3_scale(across, cos(elevation_rad)), up, sin(elevation_rad));
}

static void light_scene(struct neph_scene *scene, const struct neph_relight *light)
{
    const bool has_new_sun = !isnan(light->sun_elevation_rad) || !isnan(light->sun_azimuth_rad);
    if (has_new_sun)
        scene->sun.direction = sun_direction(scene, light);
    scene->sun.present = true;
    scene->sun.irradiance_w_per_m2 = white;
    scene->background_w_per_m2_sr = black;
    scene->environment_light = false;
}

static void change_medium(struct neph_medium *medium, const struct neph_relight *light)
{
    const double mean = (medium->albedo.r + medium->albedo.g + medium->albedo.b) / 3.0;
    medium->albedo = neph_rgb_scale(white, isnan(light->albedo) ? mean : light->albedo);
    if (!isnan(light->g))
        medium->phase = (struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN, light->g};
    if (!isnan(light->density))
        medium->extinction_color = neph_rgb_scale(medium->extinction_color, light->density);
}

static void hold_still(struct neph_scene *scene)
{
    scene->frame_count = 1;
    scene->pause_count = scene->frame_scale_count = 0;
    scene->advance_count = scene->clear_count = 0;
    scene->sun_key_count = scene->wind_key_count = 0;
    scene->camera_key_count = 1;
}

/* Lets the sun sink to its present place, along the circle through the zenith. */
static void let_sink(struct made *made, const struct neph_relight *light)
{
    struct neph_scene *scene = &made->scene;
    const double elevation_rad = elevation_rad_of(scene->sun.direction);
    const struct neph_relight before = {
        .sun_elevation_rad = elevation_rad + light->sun_sinks_rad,
        .sun_azimuth_rad = azimuth_rad_of(scene, scene->sun.direction),
    };
    for (int i = 0; i < 2; i++)
        made->sun_keys[i] = (struct neph_sun_key){.frame = i * (NEPH_RELIT_FRAMES - 1),
                                                  .direction = i ? scene->sun.direction
                                                                 : sun_direction(scene, &before),
                                                  .irradiance_w_per_m2 = white};
    scene->sun_keys = made->sun_keys;
    scene->sun_key_count = 2;
    scene->frame_count = NEPH_RELIT_FRAMES;
    scene->frame_rate_hz = 60.0;
}

enum neph_status neph_scene_relit(const struct neph_scene *scene, const struct neph_relight *light,
                                  enum neph_scattering scattering, struct neph_scene **made,
                                  struct neph_diag *diag)
{
    enum neph_status status = check(scene, light, diag);
    if (status)
        return status;
    const size_t solids_size = (size_t)scene->solid_count * sizeof(*scene->solids);
    struct made *created = calloc(1, sizeof(*created) + solids_size);
    if (!created)
        return neph_fail_memory(diag);
    created->scene = *scene;
    created->scene.borrows = true;
    created->scene.is_as_filed = false;
    created->scene.scattering = scattering;
    created->scene.solids = created->solids;
    for (int i = 0; i < scene->solid_count; i++) {
        created->solids[i] = scene->solids[i];
        created->solids[i].albedo = black;
        created->solids[i].surface = (struct neph_surface){0};
    }
    hold_still(&created->scene);
    light_scene(&created->scene, light);
    if (light->sun_sinks_rad > 0.0)
        let_sink(created, light);
    for (int m = 0; m < scene->medium_count; m++)
        change_medium(&created->scene.media[m], light);
    status = neph_scene_hash(&created->scene, diag);
    if (status)
        neph_scene_destroy(&created->scene);
    else
        *made = &created->scene;
    return status;
}
