/* SPDX-License-Identifier: MIT */
#include "harness/cli/render_shown.h"

#include "base/files.h"
#include "base/text.h"
#include "harness/cli/cli.h"
#include "harness/engines/frame_stats.h"
#include "harness/engines/vulkan_device.h"
#include "scenes/display.h"

#include <stdio.h>
#include <string.h>

/* ---- the chain ------------------------------------------------------------------------------- */

static enum neph_status check(struct neph_shown *shown, const char *path, struct neph_diag *diag)
{
    const struct neph_display_chain *showing = &shown->showing;
    const struct neph_post_stage *stages[NEPH_POST_STAGES_MAX];
    enum neph_status status = neph_display_chain_check(&shown->showing, diag);
    if (!status)
        status = neph_display_chain_check_size(showing, diag);
    if (status || showing->plan.volume_count > 0 ||
        neph_post_sequence(showing->params.order, &showing->settings, stages) > 0)
        return status;
    neph_fail(diag, NEPH_ERR_USAGE, "all stages of the chain '%s' are off", path);
    neph_hint(diag, "`neph post --list` explains them; --chain off renders without one");
    return NEPH_ERR_USAGE;
}

enum neph_status neph_shown_open(struct neph_shown *shown, const char *chain,
                                 const struct neph_shot *shot, const char *output,
                                 struct neph_diag *diag)
{
    const struct neph_scene *scene = shot->scene;
    const char *path = chain ? chain : neph_scene_display(scene)->chain;
    if (!path || (chain && strcmp(chain, "off") == 0))
        return NEPH_OK;
    shown->is_on = true;
    shown->showing.scene = scene;
    shown->folder = neph_path_in(output, "shown");
    enum neph_status status = neph_display_chain_load(&shown->showing, path, diag);
    if (!status)
        status = check(shown, path, diag);
    if (!status)
        status = neph_cli_open_folder(shown->folder.text, diag);
    return status ? status : neph_device_acquire(shot->device, &shown->device, diag);
}

void neph_shown_close(struct neph_shown *shown)
{
    neph_device_release(shown->device);
    neph_display_chain_finish(&shown->showing);
}

void neph_shown_frame_size(const struct neph_shown *shown, int *width_px, int *height_px)
{
    if (shown->is_on)
        neph_post_frame_size(shown->showing.params.order, &shown->showing.settings, width_px,
                             height_px);
}

/* ---- one frame ------------------------------------------------------------------------------- */

/* Label the image with the times of the stages: "shown_bloom_up_gpu_ms". */
static enum neph_status label(struct neph_image *picture, const struct neph_post_params *params,
                              const struct neph_post_stats *stats, struct neph_diag *diag)
{
    const struct neph_post_stage *stages[NEPH_POST_STAGES_MAX];
    const int count = neph_post_sequence(params->order, &params->settings, stages);
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < count && !status; i++) {
        char name[64], *end = name + snprintf(name, sizeof(name), "shown_");
        for (const char *c = stages[i]->name; *c; c++)
            if (*c != ',')
                *end++ = (char)(*c == ' ' ? '_' : *c);
        strcpy(end, "_gpu_ms");
        status = neph_frame_stats_set(picture, name,
                                      1e3 * stats->gpu_s[stages[i] - neph_post_stages], diag);
    }
    return status;
}

enum neph_status neph_shown_make(struct neph_shown *shown, const struct neph_image *frame,
                                 const char *name, int number, int width_px, int height_px,
                                 uint64_t seed, struct neph_path *path, json_t **stats,
                                 struct neph_diag *diag)
{
    struct neph_post_params *params = &shown->showing.params;
    struct neph_image *picture = NULL;
    struct neph_post_stats cost;
    path->text[0] = '\0';
    *stats = shown->is_on ? NULL : neph_frame_stats(frame);
    if (!shown->is_on)
        return NEPH_OK;
    const struct neph_path png = neph_path_format("%s/%s.png", shown->folder.text, name);
    *path = neph_path_format("%s/%s.exr", shown->folder.text, name);
    params->seed = seed;
    params->step_s = 1.0 / shown->showing.scene->frame_rate_hz;
    params->width_px = width_px;
    params->height_px = height_px;
    params->eye = &shown->showing.eye;
    enum neph_status status = neph_display_chain_set_frame(&shown->showing, number, diag);
    if (!status)
        status = neph_post_run(shown->device->vulkan, params, frame, &picture, &cost, diag);
    if (!status)
        status = label(picture, params, &cost, diag);
    if (!status)
        status = neph_display_chain_write(&shown->showing, picture, path->text, png.text, diag);
    if (!status)
        *stats = neph_frame_stats(picture);
    neph_image_destroy(picture);
    return status;
}
