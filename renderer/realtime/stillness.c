/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/stillness.h"

#include "renderer/realtime/layout.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void copy_light(const struct neph_light *light, struct neph_light *copy)
{
    copy->position_m = light->position_m;
    copy->intensity_w_per_sr = light->intensity_w_per_sr;
    copy->is_spot = light->is_spot;
    copy->axis = light->axis;
    copy->inner_cosine = light->inner_cosine;
    copy->outer_cosine = light->outer_cosine;
}

static void copy_content(const struct neph_scene *static_scene, struct neph_rt_content *content)
{
    memset(content, 0, sizeof(*content)); /* with the padding, for memcmp */
    content->sun.present = static_scene->sun.present;
    content->sun.direction = static_scene->sun.direction;
    content->sun.irradiance_w_per_m2 = static_scene->sun.irradiance_w_per_m2;
    content->background_w_per_m2_sr = static_scene->background_w_per_m2_sr;
    for (int i = 0; i < static_scene->light_count; i++)
        copy_light(&static_scene->lights[i], &content->lights[i]);
    neph_gpu_scene_pack_media(static_scene, content->media);
}

static bool has_same_solids(const struct neph_rt_static_content *static_content,
                            const struct neph_scene *static_scene)
{
    return static_content->solid_count == static_scene->solid_count &&
           (static_scene->solid_count == 0 ||
            memcmp(static_content->solids, static_scene->solids,
                   (size_t)static_scene->solid_count * sizeof(*static_scene->solids)) == 0);
}

static enum neph_status store_solids(struct neph_rt_static_content *static_content,
                                     const struct neph_scene *static_scene, struct neph_diag *diag)
{
    const size_t bytes = (size_t)static_scene->solid_count * sizeof(*static_scene->solids);
    struct neph_solid *solids = bytes > 0 ? malloc(bytes) : NULL;
    if (bytes > 0 && !solids)
        return neph_fail_memory(diag);
    if (bytes > 0)
        memcpy(solids, static_scene->solids, bytes);
    free(static_content->solids);
    static_content->solids = solids;
    static_content->solid_count = static_scene->solid_count;
    return NEPH_OK;
}

enum neph_status neph_rt_static_content_update(struct neph_rt_static_content *static_content,
                                               const struct neph_scene *static_scene, bool is_next,
                                               struct neph_diag *diag)
{
    struct neph_rt_content content;
    copy_content(static_scene, &content);
    const bool has_same = memcmp(&content, &static_content->content, sizeof(content)) == 0 &&
                          has_same_solids(static_content, static_scene);
    static_content->pictures = is_next && has_same ? static_content->pictures + 1 : 0;
    static_content->content = content;
    return has_same ? NEPH_OK : store_solids(static_content, static_scene, diag);
}

void neph_rt_static_content_destroy(struct neph_rt_static_content *static_content)
{
    free(static_content->solids);
    *static_content = (struct neph_rt_static_content){.pictures = 0};
}

/* Frames until a change of 1 has decayed to 0 (CHANGE_LEAST of
 * realtime/gradient/change_samples.glsl). */
static double count_decay_frames(double hold)
{
    return hold > 0.0 ? ceil(log(0x1p-14) / log(hold)) + 1.0 : 0.0;
}

/* Frames until both samples of every gradient show the present content, through the same texels. */
static double count_sample_frames(const struct neph_gpu_view *view)
{
    return fmax(fmax(4.0, (double)view->settings[RT_TAA_JITTER_LENGTH]),
                (double)view->settings[RT_OVERRIDE_WAKE] + 8.0);
}

/* A partial tile lacks texels for some of its rays and uses the samples of a neighbouring tile. */
static bool have_samples(const struct neph_gpu_view *view)
{
    const bool is_cut_twice = 2 * view->tile_count[0] > view->half_size_px[0] &&
                              2 * view->tile_count[1] > view->half_size_px[1];
    return !is_cut_twice && view->tile_count[0] > 1 && view->tile_count[1] > 1;
}

bool neph_rt_is_gradient_known_zero(const struct neph_rt_static_content *static_content,
                                    const struct neph_gpu_view *view)
{
    const double needed = count_sample_frames(view) +
                          count_decay_frames((double)view->settings[RT_CHANGE_HOLD]);
    return view->settings[RT_OVERRIDE_REST] == 0.0f && have_samples(view) &&
           (double)static_content->pictures >= needed;
}
