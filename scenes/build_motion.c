/* SPDX-License-Identifier: MIT
 *
 * Frames and keys from a scene file: defaults, units.
 */
#include "scenes/build.h"
#include "scenes/motion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define RAD_PER_DEG (M_PI / 180.0)

static struct neph_vec3 vec3(const double v[3])
{
    return (struct neph_vec3){v[0], v[1], v[2]};
}

static struct neph_rgb rgb(const double v[3])
{
    return (struct neph_rgb){v[0], v[1], v[2]};
}

static enum neph_status build_camera(const struct neph_raw_camera *raw, struct neph_scene *scene,
                                     struct neph_diag *diag)
{
    int count = raw->keys ? (int)raw->keys_count : 1;
    struct neph_camera_key *keys = calloc((size_t)count, sizeof(*keys));
    if (!keys)
        return neph_fail_memory(diag);
    for (int i = 0; i < count; i++) {
        const struct neph_raw_camera_key *key = raw->keys ? &raw->keys[i] : NULL;
        keys[i].frame = key ? key->frame : 0;
        keys[i].position_m = vec3(key ? key->position_m : raw->position_m);
        keys[i].look_at_m = vec3(key ? key->look_at_m : raw->look_at_m);
        keys[i].cut = key && key->cut;
    }
    scene->camera_keys = keys;
    scene->camera_key_count = count;
    scene->camera_up = raw->up ? neph_vec3_normalize(vec3(raw->up)) : (struct neph_vec3){0, 1, 0};
    scene->vertical_fov_rad = raw->vertical_fov_deg * RAD_PER_DEG;
    return NEPH_OK;
}

static void *copy_of(const void *from, size_t size)
{
    void *copy = malloc(size);
    return copy ? memcpy(copy, from, size) : NULL;
}

static enum neph_status build_pauses(const struct neph_raw_frames *raw, struct neph_scene *scene,
                                     struct neph_diag *diag)
{
    if (!raw || raw->pauses_count == 0)
        return NEPH_OK;
    scene->pauses = copy_of(raw->pauses, raw->pauses_count * sizeof(*raw->pauses));
    scene->pause_count = (int)raw->pauses_count;
    return scene->pauses ? NEPH_OK : neph_fail_memory(diag);
}

static enum neph_status build_sizes(const struct neph_raw_frames *raw, struct neph_scene *scene,
                                    struct neph_diag *diag)
{
    if (!raw || raw->sizes_count == 0)
        return NEPH_OK;
    scene->frame_scales = copy_of(raw->sizes, raw->sizes_count * sizeof(*raw->sizes));
    scene->frame_scale_count = (int)raw->sizes_count;
    return scene->frame_scales ? NEPH_OK : neph_fail_memory(diag);
}

/* A single key is a sun that stands still. */
static enum neph_status build_sun(const struct neph_raw_sun *raw, struct neph_scene *scene,
                                  struct neph_diag *diag)
{
    scene->sun = (struct neph_sun){.direction = {0, 1, 0}};
    if (!raw)
        return NEPH_OK;
    const int count = raw->keys ? (int)raw->keys_count : 1;
    struct neph_sun_key *keys = calloc((size_t)count, sizeof(*keys));
    if (!keys)
        return neph_fail_memory(diag);
    for (int i = 0; i < count; i++) {
        const struct neph_raw_sun_key *key = raw->keys ? &raw->keys[i] : NULL;
        keys[i].frame = key ? key->frame : 0;
        keys[i].direction = neph_vec3_normalize(vec3(key ? key->direction : raw->direction));
        keys[i].irradiance_w_per_m2 = rgb(key ? key->irradiance_w_per_m2
                                              : raw->irradiance_w_per_m2);
    }
    scene->sun = (struct neph_sun){true, keys[0].direction, keys[0].irradiance_w_per_m2};
    if (count == 1) {
        free(keys);
        return NEPH_OK;
    }
    scene->sun_keys = keys;
    scene->sun_key_count = count;
    scene->sun = neph_scene_sun(scene, 0.0);
    return NEPH_OK;
}

static enum neph_status build_wind(const struct neph_raw_wind *raw, struct neph_scene *scene,
                                   struct neph_diag *diag)
{
    if (!raw)
        return NEPH_OK;
    const int count = raw->keys ? (int)raw->keys_count : 1;
    scene->wind_keys = calloc((size_t)count, sizeof(*scene->wind_keys));
    if (!scene->wind_keys)
        return neph_fail_memory(diag);
    scene->wind_key_count = count;
    for (int i = 0; i < count; i++) {
        const struct neph_raw_wind_key *key = raw->keys ? &raw->keys[i] : NULL;
        scene->wind_keys[i].frame = key ? key->frame : 0;
        scene->wind_keys[i].velocity_m_per_s = vec3(key ? key->velocity_m_per_s
                                                        : raw->velocity_m_per_s);
    }
    return NEPH_OK;
}

enum neph_status neph_build_motion(const struct neph_raw_scene *raw, struct neph_scene *scene,
                                   struct neph_diag *diag)
{
    const struct neph_raw_frames *frames = raw->frames;
    scene->frame_count = frames && frames->count ? *frames->count : 1;
    scene->frame_rate_hz = frames && frames->rate_hz ? *frames->rate_hz : 30;
    enum neph_status status = build_pauses(frames, scene, diag);
    if (!status)
        status = build_sizes(frames, scene, diag);
    if (!status)
        status = build_camera(&raw->camera, scene, diag);
    if (!status)
        status = build_sun(raw->sun, scene, diag);
    if (!status)
        status = build_wind(raw->wind, scene, diag);
    return status;
}
