/* SPDX-License-Identifier: MIT
 *
 * The identity of a scene: BLAKE2b of a text with every field that changes a rendered value, each
 * number with 17 digits, so that equal texts mean equal doubles. Comments, key order, names, title,
 * gates and exposure are not in it; how a fence or an Unreal layer was written is not either, only
 * what it came to.
 */
#include "scenes/build.h"
#include "scenes/grid.h"
#include "scenes/horizon.h"

#include <stdio.h>
#include <stdlib.h>

/* Raise it when the meaning of a field changes: old results must not be taken for new ones. */
#define HASH_VERSION 1

/* -0 and 0 render the same. */
static double plain(double value)
{
    return value + 0.0;
}

static void put_number(FILE *text, const char *name, double value)
{
    fprintf(text, "%s %.17g\n", name, plain(value));
}

static void put_three(FILE *text, const char *name, double a, double b, double c)
{
    fprintf(text, "%s %.17g %.17g %.17g\n", name, plain(a), plain(b), plain(c));
}

static void put_vec3(FILE *text, const char *name, struct neph_vec3 v)
{
    put_three(text, name, v.x, v.y, v.z);
}

static void put_rgb(FILE *text, const char *name, struct neph_rgb c)
{
    put_three(text, name, c.r, c.g, c.b);
}

static void put_camera(FILE *text, const struct neph_scene *scene)
{
    for (int i = 0; i < scene->camera_key_count; i++) {
        put_number(text, "camera_key", scene->camera_keys[i].frame);
        put_vec3(text, "position_m", scene->camera_keys[i].position_m);
        put_vec3(text, "look_at_m", scene->camera_keys[i].look_at_m);
        if (scene->camera_keys[i].cut)
            put_number(text, "cut", 1);
    }
    put_vec3(text, "up", scene->camera_up);
    put_number(text, "vertical_fov_rad", scene->vertical_fov_rad);
    put_number(text, "frame_count", scene->frame_count);
    put_number(text, "frame_rate_hz", scene->frame_rate_hz);
}

/* Nothing of a scene that has none of it: what was stored before there was motion stays valid. */
static void put_motion(FILE *text, const struct neph_scene *scene)
{
    for (int i = 0; i < scene->pause_count; i++) {
        put_number(text, "pause", scene->pauses[i].frame);
        put_number(text, "count", scene->pauses[i].count);
    }
    for (int i = 0; i < scene->frame_scale_count; i++) {
        put_number(text, "frame_scale", scene->frame_scales[i].frame);
        put_number(text, "scale", scene->frame_scales[i].scale);
    }
    for (int i = 0; i < scene->sun_key_count; i++) {
        put_number(text, "sun_key", scene->sun_keys[i].frame);
        put_vec3(text, "direction", scene->sun_keys[i].direction);
        put_rgb(text, "irradiance_w_per_m2", scene->sun_keys[i].irradiance_w_per_m2);
    }
    for (int i = 0; i < scene->wind_key_count; i++) {
        put_number(text, "wind_key", scene->wind_keys[i].frame);
        put_vec3(text, "velocity_m_per_s", scene->wind_keys[i].velocity_m_per_s);
    }
}

static void put_light(FILE *text, const struct neph_scene *scene)
{
    if (scene->sun.present) {
        put_vec3(text, "sun_direction", scene->sun.direction);
        put_rgb(text, "sun_irradiance_w_per_m2", scene->sun.irradiance_w_per_m2);
    }
    put_rgb(text, "background_w_per_m2_sr", scene->background_w_per_m2_sr);
    put_number(text, "environment_light", scene->environment_light);
    fprintf(text, "scattering %s\n", neph_scattering_name(scene->scattering));
}

static void put_solid(FILE *text, const struct neph_solid *solid)
{
    if (solid->kind == NEPH_SOLID_BOX) {
        put_vec3(text, "box_min_m", solid->box.min_m);
        put_vec3(text, "box_max_m", solid->box.max_m);
    } else {
        put_vec3(text, "sphere_center_m", solid->center_m);
        put_number(text, "sphere_radius_m", solid->radius_m);
    }
    put_rgb(text, "albedo", solid->albedo);
    put_number(text, "thin", solid->thin); /* it changes the thin-object mask of a frame */
}

static void put_grid(FILE *text, const struct neph_grid *grid)
{
    put_three(text, "size", grid->size[0], grid->size[1], grid->size[2]);
    put_vec3(text, "origin_m", grid->origin_m);
    put_vec3(text, "spacing_m", grid->spacing_m);
    fprintf(text, "values %s\n", grid->hash);
}

static void put_horizon(FILE *text, const struct neph_horizon_params *horizon)
{
    put_number(text, "horizon_version", NEPH_HORIZON_VERSION);
    put_number(text, "seed", (double)horizon->seed);
    put_three(text, "planet_radius_m bottom_m thickness_m", horizon->planet_radius_m,
              horizon->bottom_m, horizon->thickness_m);
    put_three(text, "texture_scale_m base_repeats detail_repeats", horizon->texture_scale_m,
              horizon->base_repeats, horizon->detail_repeats);
    put_number(text, "coverage", horizon->coverage);
    put_number(text, "density", horizon->density);
    put_vec3(text, "wind_m", horizon->wind_m);
}

static void put_medium(FILE *text, const struct neph_medium *medium)
{
    put_number(text, "medium", medium->kind);
    put_vec3(text, "min_m", medium->bounds.min_m);
    put_vec3(text, "max_m", medium->bounds.max_m);
    put_rgb(text, "extinction_color", medium->extinction_color);
    put_rgb(text, "albedo", medium->albedo);
    put_number(text, "phase", medium->phase.kind);
    put_number(text, "g", medium->phase.g);
    for (int i = 0; i < medium->layer_count; i++)
        put_three(text, "layer", medium->layers[i].extinction_per_m,
                  medium->layers[i].falloff_per_m, medium->layers[i].height_m);
    if (medium->layer_count == 0)
        put_number(text, "extinction_per_m", medium->extinction_per_m);
    if (medium->kind == NEPH_MEDIUM_GAUSSIAN) {
        put_vec3(text, "center_m", medium->gaussian.center_m);
        put_number(text, "width_m", medium->gaussian.width_m);
    }
    if (medium->kind == NEPH_MEDIUM_SHELL) {
        put_vec3(text, "center_m", medium->shell.center_m);
        put_number(text, "radius_m", medium->shell.radius_m);
        put_number(text, "scale_height_m", medium->shell.scale_height_m);
    }
    if (medium->kind == NEPH_MEDIUM_GRID)
        put_grid(text, medium->grid);
    if (medium->kind == NEPH_MEDIUM_HORIZON)
        put_horizon(text, &medium->horizon->params);
}

static void put_octaves(FILE *text, const struct neph_octaves *octaves)
{
    put_number(text, "octaves", octaves->count);
    put_three(text, "contribution attenuation eccentricity", octaves->contribution,
              octaves->attenuation, octaves->eccentricity);
}

enum neph_status neph_scene_hash(struct neph_scene *scene, struct neph_diag *diag)
{
    char *data = NULL;
    size_t size = 0;
    FILE *text = open_memstream(&data, &size);
    if (!text)
        return neph_fail_memory(diag);
    put_number(text, "neph_scene", HASH_VERSION);
    put_camera(text, scene);
    put_motion(text, scene);
    put_light(text, scene);
    for (int i = 0; i < scene->solid_count; i++)
        put_solid(text, &scene->solids[i]);
    for (int i = 0; i < scene->medium_count; i++)
        put_medium(text, &scene->media[i]);
    put_octaves(text, &scene->octaves);
    put_number(text, "bake_resolution", scene->bake_resolution);
    int failed = ferror(text);
    failed |= fclose(text);
    enum neph_status status = failed ? neph_fail_memory(diag)
                                     : neph_hash(data, size, scene->hash, diag);
    free(data);
    return status;
}
