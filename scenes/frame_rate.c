/* SPDX-License-Identifier: MIT */
#include "scenes/frame_rate.h"

#include <math.h>
#include <stddef.h>

static bool has_rate(const struct neph_scene *scene, double rate_hz)
{
    return rate_hz == 0.0 || rate_hz == scene->frame_rate_hz;
}

const char *neph_frame_rate_obstacle(const struct neph_scene *scene, double rate_hz)
{
    const bool counts_frames = scene->pause_count > 0 || scene->advance_count > 0 ||
                               scene->clear_count > 0 || scene->frame_scale_count > 0;
    return counts_frames && !has_rate(scene, rate_hz)
               ? "it has one frame rate: frames.pauses, advance, clear and sizes count whole frames"
               : NULL;
}

/* Each kind of keys begins with its frame (scene.h). */
static void stretch_keys(void *keys, int count, size_t size, double ratio)
{
    for (int i = 0; i < count; i++)
        *(double *)((char *)keys + (size_t)i * size) *= ratio;
}

enum neph_status neph_scene_set_frame_rate(struct neph_scene *scene, double rate_hz,
                                           struct neph_diag *diag)
{
    const double ratio = rate_hz / scene->frame_rate_hz;
    if (has_rate(scene, rate_hz))
        return NEPH_OK;
    stretch_keys(scene->camera_keys, scene->camera_key_count, sizeof(*scene->camera_keys), ratio);
    stretch_keys(scene->sun_keys, scene->sun_key_count, sizeof(*scene->sun_keys), ratio);
    stretch_keys(scene->wind_keys, scene->wind_key_count, sizeof(*scene->wind_keys), ratio);
    for (int i = 0; i < scene->light_count; i++)
        stretch_keys(scene->lights[i].keys, scene->lights[i].key_count,
                     sizeof(*scene->lights[i].keys), ratio);
    for (int i = 0; i < scene->mover_count; i++)
        stretch_keys(scene->movers[i].keys, scene->movers[i].key_count,
                     sizeof(*scene->movers[i].keys), ratio);
    scene->frame_count = (int)fmax(1.0, round(scene->frame_count * ratio));
    scene->frame_rate_hz = rate_hz;
    return neph_scene_hash(scene, diag);
}
