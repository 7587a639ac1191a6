/* SPDX-License-Identifier: MIT
 *
 * The identity of a scene: BLAKE2b of a text with every field that changes a rendered value, each
 * number with 17 digits. Comments, key order, names, title,
 * gates and exposure are not in it; how a fence or an Unreal layer was written is not either, only
 * what it came to.
 */
#include "scenes/hash_text.h"
#include "scenes/load.h"
#include "scenes/media.h"

#include <stdio.h>
#include <stdlib.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_SOLID_KIND_COUNT == 2, "a new kind");

/* Raise it when the meaning of a field changes: old results must not be taken for new ones. */
#define HASH_VERSION 1

static void put_camera(FILE *text, const struct neph_scene *scene)
{
    for (int i = 0; i < scene->camera_key_count; i++) {
        neph_put_number(text, "camera_key", scene->camera_keys[i].frame);
        neph_put_vec3(text, "position_m", scene->camera_keys[i].position_m);
        neph_put_vec3(text, "look_at_m", scene->camera_keys[i].look_at_m);
        if (scene->camera_keys[i].cut)
            neph_put_number(text, "cut", 1);
    }
    neph_put_vec3(text, "up", scene->camera_up);
    neph_put_number(text, "vertical_fov_rad", scene->vertical_fov_rad);
    if (scene->orthographic_height_m > 0.0)
        neph_put_number(text, "orthographic_height_m", scene->orthographic_height_m);
    neph_put_number(text, "frame_count", scene->frame_count);
    neph_put_number(text, "frame_rate_hz", scene->frame_rate_hz);
}

static void put_mover(FILE *text, const struct neph_mover *mover)
{
    neph_put_number(text, "mover", mover->first);
    neph_put_number(text, "count", mover->count);
    neph_put_number(text, "axis", mover->axis);
    neph_put_vec3(text, "pivot_m", mover->pivot_m);
    for (int i = 0; i < mover->key_count; i++) {
        neph_put_number(text, "solid_key", mover->keys[i].frame);
        neph_put_vec3(text, "move_m", mover->keys[i].move_m);
        neph_put_number(text, "turn_rad", mover->keys[i].turn_rad);
    }
}

static void put_lamp(FILE *text, const struct neph_light *light)
{
    neph_put_vec3(text, "light_position_m", light->position_m);
    neph_put_rgb(text, "intensity_w_per_sr", light->intensity_w_per_sr);
    if (!light->is_spot)
        return;
    neph_put_vec3(text, "axis", light->axis);
    neph_put_number(text, "inner_cosine", light->inner_cosine);
    neph_put_number(text, "outer_cosine", light->outer_cosine);
}

/* Nothing of a scene that has none of it: what was stored before there was motion stays valid. */
static void put_motion(FILE *text, const struct neph_scene *scene)
{
    for (int i = 0; i < scene->pause_count; i++) {
        neph_put_number(text, "pause", scene->pauses[i].frame);
        neph_put_number(text, "count", scene->pauses[i].count);
    }
    for (int i = 0; i < scene->advance_count; i++)
        neph_put_number(text, "advance", scene->advances[i]);
    for (int i = 0; i < scene->clear_count; i++) {
        neph_put_number(text, "clear", scene->clears[i].frame);
        neph_put_number(text, "count", scene->clears[i].count);
    }
    for (int i = 0; i < scene->mover_count; i++)
        put_mover(text, &scene->movers[i]);
    for (int i = 0; i < scene->frame_scale_count; i++) {
        neph_put_number(text, "frame_scale", scene->frame_scales[i].frame);
        neph_put_number(text, "scale", scene->frame_scales[i].scale);
    }
    for (int i = 0; i < scene->sun_key_count; i++) {
        neph_put_number(text, "sun_key", scene->sun_keys[i].frame);
        neph_put_vec3(text, "direction", scene->sun_keys[i].direction);
        neph_put_rgb(text, "irradiance_w_per_m2", scene->sun_keys[i].irradiance_w_per_m2);
    }
    for (int i = 0; i < scene->wind_key_count; i++) {
        neph_put_number(text, "wind_key", scene->wind_keys[i].frame);
        neph_put_vec3(text, "velocity_m_per_s", scene->wind_keys[i].velocity_m_per_s);
    }
}

static void put_light(FILE *text, const struct neph_scene *scene)
{
    if (scene->sun.present) {
        neph_put_vec3(text, "sun_direction", scene->sun.direction);
        neph_put_rgb(text, "sun_irradiance_w_per_m2", scene->sun.irradiance_w_per_m2);
    }
    for (int i = 0; i < scene->light_count; i++)
        put_lamp(text, &scene->lights[i]);
    neph_put_rgb(text, "background_w_per_m2_sr", scene->background_w_per_m2_sr);
    neph_put_number(text, "environment_light", scene->environment_light);
    fprintf(text, "scattering %s\n", neph_scattering_name(scene->scattering));
}

/* Nothing of a plain one: what was stored before there were others stays valid. */
static void put_surface(FILE *text, const struct neph_surface *surface)
{
    if (surface->metalness > 0.0) {
        neph_put_number(text, "metalness", surface->metalness);
        neph_put_number(text, "roughness", surface->roughness);
    }
    if (neph_is_textured(surface)) {
        neph_put_number(text, "pattern", surface->texture.pattern);
        neph_put_number(text, "cell_m", surface->texture.cell_m);
        neph_put_rgb(text, "other", surface->texture.other);
        neph_put_number(text, "seed", surface->texture.seed);
    }
}

static void put_solid(FILE *text, const struct neph_solid *solid)
{
    if (solid->kind == NEPH_SOLID_BOX) {
        neph_put_vec3(text, "box_min_m", solid->box.min_m);
        neph_put_vec3(text, "box_max_m", solid->box.max_m);
    } else {
        neph_put_vec3(text, "sphere_center_m", solid->center_m);
        neph_put_number(text, "sphere_radius_m", solid->radius_m);
    }
    neph_put_rgb(text, "albedo", solid->albedo);
    put_surface(text, &solid->surface);
    neph_put_number(text, "thin", solid->thin); /* it changes the thin-object mask of a frame */
}

static void put_octaves(FILE *text, const struct neph_octaves *octaves)
{
    neph_put_number(text, "octaves", octaves->count);
    neph_put_three(text, "contribution attenuation eccentricity", octaves->contribution,
                   octaves->attenuation, octaves->eccentricity);
}

enum neph_status neph_scene_hash(struct neph_scene *scene, struct neph_diag *diag)
{
    char *data = NULL;
    size_t size = 0;
    FILE *text = open_memstream(&data, &size);
    if (!text)
        return neph_fail_memory(diag);
    neph_put_number(text, "neph_scene", HASH_VERSION);
    put_camera(text, scene);
    put_motion(text, scene);
    put_light(text, scene);
    for (int i = 0; i < scene->solid_count; i++)
        put_solid(text, &scene->solids[i]);
    for (int i = 0; i < scene->medium_count; i++)
        neph_medium_hash(&scene->media[i], text);
    neph_fog_look_hash(&scene->fog_look, text);
    put_octaves(text, &scene->octaves);
    neph_put_number(text, "bake_resolution", scene->bake_resolution);
    int failed = ferror(text);
    failed |= fclose(text);
    enum neph_status status = failed ? neph_fail_memory(diag)
                                     : neph_hash(data, size, scene->hash, diag);
    free(data);
    return status;
}
