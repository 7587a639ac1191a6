/* SPDX-License-Identifier: MIT */
#include "renderer/post/chain.h"

#include "renderer/compute.h"
#include "renderer/post/colour.h"
#include "renderer/post/film.h"
#include "renderer/vulkan_device.h"
#include "shaders/structs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { local_size = 64, channels = 4, bindings = 4 };

static const size_t texel_bytes = channels * sizeof(float);

struct size {
    int width_px, height_px;
};

static size_t texel_count(struct size size)
{
    return (size_t)size.width_px * (size_t)size.height_px;
}

/* A chain at work. Pictures change places from stage to stage. */
struct work {
    struct neph_vulkan *vulkan;
    const struct neph_post_params *params;
    struct size size; /* of pictures[0], the newest */
    struct neph_buffer pictures[2], table, readback;
    struct neph_buffer views[NEPH_POST_STAGES_MAX];
    struct neph_batch batch;
};

/* ---- sizes ----------------------------------------------------------------------------------- */

static int enlarged(int side_px, double percent)
{
    return (int)fmin(round(side_px * 100.0 / percent), NEPH_IMAGE_SIDE_MAX_PX + 1.0);
}

static struct size size_after(const struct neph_post_stage *stage,
                              const struct neph_settings *settings, struct size size)
{
    const double percent = settings->values[POST_SCREEN_PERCENT];
    if (stage->makes == NEPH_POST_MAKES_LARGER)
        return (struct size){enlarged(size.width_px, percent), enlarged(size.height_px, percent)};
    return size;
}

static struct size last_size(const struct neph_settings *settings, struct size size)
{
    for (const struct neph_post_stage *stage = neph_post_stages; stage->name; stage++)
        if (neph_post_is_on(stage, settings))
            size = size_after(stage, settings, size);
    return size;
}

/* ---- what the shaders are told --------------------------------------------------------------- */

static void put_matrix(float rows[9], struct neph_matrix3 matrix)
{
    for (int i = 0; i < 9; i++)
        rows[i] = (float)matrix.m[i / 3][i % 3];
}

static void fill_colours(const struct neph_settings *settings, struct neph_gpu_post_view *view)
{
    const double *values = settings->values;
    const struct neph_film_joints joints = neph_film_joints(&(struct neph_film){
        .slope = values[POST_FILM_SLOPE],
        .toe = values[POST_FILM_TOE],
        .shoulder = values[POST_FILM_SHOULDER],
        .black_clip = values[POST_FILM_BLACK_CLIP],
        .white_clip = values[POST_FILM_WHITE_CLIP],
    });
    view->toe_match = (float)joints.toe_match;
    view->straight_match = (float)joints.straight_match;
    view->shoulder_match = (float)joints.shoulder_match;
    put_matrix(view->white_balance, neph_white_balance(values[POST_WHITE_TEMPERATURE_K]));
    put_matrix(view->rec709_to_ap1, neph_colour_matrix(&neph_rec709, &neph_ap1));
    put_matrix(view->ap1_to_rec709, neph_colour_matrix(&neph_ap1, &neph_rec709));
    put_matrix(view->ap1_to_ap0, neph_colour_matrix(&neph_ap1, &neph_ap0));
    put_matrix(view->ap0_to_ap1, neph_colour_matrix(&neph_ap0, &neph_ap1));
}

static void fill_view(const struct work *work, struct size to, struct neph_gpu_post_view *view)
{
    const struct neph_post_params *params = work->params;
    for (int i = 0; i < POST_SETTING_COUNT; i++)
        view->settings[i] = (float)params->settings.values[i];
    view->from_px[0] = (uint32_t)work->size.width_px;
    view->from_px[1] = (uint32_t)work->size.height_px;
    view->to_px[0] = (uint32_t)to.width_px;
    view->to_px[1] = (uint32_t)to.height_px;
    view->frame = (uint32_t)params->frame;
    view->seed = (uint32_t)(params->seed ^ params->seed >> 32);
    fill_colours(&params->settings, view);
}

/* ---- a stage --------------------------------------------------------------------------------- */

static enum neph_status dispatch(struct work *work, const struct neph_kernel *kernel,
                                 struct neph_dispatch *whole, size_t thread_count,
                                 struct neph_diag *diag)
{
    const size_t groups_max = work->vulkan->limits.maxComputeWorkGroupCount[0];
    enum neph_status status = NEPH_OK;
    for (size_t first = 0; first < thread_count && !status; first += groups_max * local_size) {
        const size_t groups = (thread_count - first + local_size - 1) / local_size;
        const struct neph_gpu_post_run run = {.first_thread = (uint32_t)first};
        whole->push = &run;
        whole->group_count = (uint32_t)(groups < groups_max ? groups : groups_max);
        status = neph_batch_dispatch(&work->batch, kernel, whole, diag);
    }
    return status;
}

static enum neph_status add_stage(struct work *work, const struct neph_post_stage *stage,
                                  struct neph_buffer *view, double *gpu_s, struct neph_diag *diag)
{
    const bool makes_table = stage->makes == NEPH_POST_MAKES_TABLE;
    const struct size table = {POST_LUT_SIDE, POST_LUT_SIDE * POST_LUT_SIDE};
    const struct size to = makes_table ? table
                                       : size_after(stage, &work->params->settings, work->size);
    const struct neph_kernel_params params = {
        .name = stage->shader.name,
        .spirv = stage->shader.spirv,
        .spirv_size_bytes = stage->shader.spirv_size_bytes,
        .buffer_count = bindings,
        .push_size_bytes = sizeof(struct neph_gpu_post_run),
    };
    struct neph_dispatch whole = {
        .buffers = {view, &work->pictures[0], makes_table ? &work->table : &work->pictures[1],
                    makes_table ? &work->pictures[1] : &work->table},
    };
    const struct neph_kernel *kernel;
    enum neph_status status = neph_buffer_create(work->vulkan, NEPH_BUFFER_UPLOAD,
                                                 sizeof(struct neph_gpu_post_view), "post view",
                                                 view, diag);
    if (status)
        return status;
    fill_view(work, to, view->mapped);
    status = neph_kernel_get(work->vulkan, &params, &kernel, diag);
    if (!status)
        status = dispatch(work, kernel, &whole, texel_count(to), diag);
    if (status)
        return status;
    neph_batch_stamp(&work->batch, gpu_s);
    neph_batch_barrier(&work->batch);
    if (!makes_table) {
        const struct neph_buffer newest = work->pictures[1];
        work->pictures[1] = work->pictures[0];
        work->pictures[0] = newest;
        work->size = to;
    }
    return NEPH_OK;
}

static enum neph_status run_stages(struct work *work, struct neph_post_stats *stats,
                                   struct neph_diag *diag)
{
    enum neph_status status = neph_batch_begin(work->vulkan, &work->batch, diag);
    for (int i = 0; neph_post_stages[i].name && !status; i++)
        if (neph_post_is_on(&neph_post_stages[i], &work->params->settings))
            status = add_stage(work, &neph_post_stages[i], &work->views[i], &stats->gpu_s[i], diag);
    if (!status)
        status = neph_batch_send(&work->batch, "picture chain", diag);
    return status ? status
                  : neph_batches_wait(work->vulkan, neph_batches_sent(work->vulkan),
                                      "picture chain", diag);
}

/* ---- in and out ------------------------------------------------------------------------------ */

static enum neph_status put_in(struct work *work, float *const rgb[3], struct neph_diag *diag)
{
    const size_t count = texel_count(work->size);
    float *texels = malloc(count * texel_bytes);
    if (!texels)
        return neph_fail_memory(diag);
    for (size_t i = 0; i < count; i++) {
        for (int c = 0; c < 3; c++)
            texels[channels * i + (size_t)c] = rgb[c][i];
        texels[channels * i + 3] = 1.0f;
    }
    const enum neph_status status = neph_buffer_upload(work->vulkan, &work->pictures[0], 0, texels,
                                                       count * texel_bytes, diag);
    free(texels);
    return status;
}

static enum neph_status take_out(struct work *work, struct neph_image *image,
                                 struct neph_diag *diag)
{
    const size_t count = texel_count(work->size);
    float *rgb[3];
    enum neph_status status = neph_buffer_download(work->vulkan, &work->pictures[0],
                                                   &work->readback, count * texel_bytes, diag);
    if (!status)
        status = neph_image_add_rgb(image, NULL, rgb, diag);
    const float *texels = work->readback.mapped;
    for (size_t i = 0; i < count && !status; i++)
        for (int c = 0; c < 3; c++)
            rgb[c][i] = texels[channels * i + (size_t)c];
    return status;
}

/* Depth and masks, which metrics look at; in another size they would be of other pixels. */
static enum neph_status copy_others(const struct neph_image *from, struct neph_image *to,
                                    struct neph_diag *diag)
{
    const bool fits = from->width_px == to->width_px && from->height_px == to->height_px;
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < from->channel_count && fits && !status; i++) {
        const struct neph_channel *channel = &from->channels[i];
        float *samples;
        if (strcmp(channel->name, "Z") != 0 && strncmp(channel->name, "mask.", 5) != 0 &&
            strncmp(channel->name, "motion.", 7) != 0)
            continue;
        status = neph_image_add_channel(to, channel->name, &samples, diag);
        if (!status)
            memcpy(samples, channel->samples, neph_image_pixel_count(from) * sizeof(*samples));
    }
    return status;
}

static enum neph_status copy_attributes(const struct neph_image *from, struct neph_image *to,
                                        struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < from->attribute_count && !status; i++)
        status = neph_image_set_attribute(to, from->attributes[i].name, diag, "%s",
                                          from->attributes[i].value);
    return status;
}

static enum neph_status make_room(struct work *work, struct size last, struct neph_diag *diag)
{
    const size_t first_bytes = texel_count(work->size) * texel_bytes;
    const size_t last_bytes = texel_count(last) * texel_bytes;
    const size_t bytes = first_bytes > last_bytes ? first_bytes : last_bytes;
    const size_t table_bytes = (size_t)POST_LUT_SIDE * POST_LUT_SIDE * POST_LUT_SIDE * texel_bytes;
    const struct {
        struct neph_buffer *buffer;
        enum neph_buffer_use use;
        size_t bytes;
    } all[] = {{&work->pictures[0], NEPH_BUFFER_DEVICE, bytes},
               {&work->pictures[1], NEPH_BUFFER_DEVICE, bytes},
               {&work->table, NEPH_BUFFER_DEVICE, table_bytes},
               {&work->readback, NEPH_BUFFER_READBACK, bytes}};
    enum neph_status status = NEPH_OK;
    for (size_t i = 0; i < sizeof(all) / sizeof(all[0]) && !status; i++)
        status = neph_buffer_create(work->vulkan, all[i].use, all[i].bytes, "picture",
                                    all[i].buffer, diag);
    return status;
}

static void finish(struct work *work)
{
    for (int i = 0; i < NEPH_POST_STAGES_MAX; i++)
        neph_buffer_destroy(work->vulkan, &work->views[i]);
    neph_buffer_destroy(work->vulkan, &work->readback);
    neph_buffer_destroy(work->vulkan, &work->table);
    neph_buffer_destroy(work->vulkan, &work->pictures[1]);
    neph_buffer_destroy(work->vulkan, &work->pictures[0]);
}

enum neph_status neph_post_run(struct neph_vulkan *vulkan, const struct neph_post_params *params,
                               const struct neph_image *frame, struct neph_image **made,
                               struct neph_post_stats *stats, struct neph_diag *diag)
{
    struct work work = {.vulkan = vulkan, .params = params};
    struct neph_post_stats own_stats = {{0}};
    struct neph_image *image = NULL;
    float *rgb[3];
    work.size = (struct size){frame->width_px, frame->height_px};
    if (!neph_image_rgb(frame, NULL, rgb))
        return neph_fail(diag, NEPH_ERR_INPUT, "the frame has no channels R, G and B");
    const struct size last = last_size(&params->settings, work.size);
    enum neph_status status = neph_image_create(last.width_px, last.height_px, &image, diag);
    if (!status)
        status = make_room(&work, last, diag);
    if (!status)
        status = put_in(&work, rgb, diag);
    if (!status)
        status = run_stages(&work, &own_stats, diag);
    if (!status)
        status = copy_attributes(frame, image, diag);
    if (!status)
        status = copy_others(frame, image, diag);
    if (!status)
        status = take_out(&work, image, diag);
    finish(&work);
    if (status) {
        neph_image_destroy(image);
        return status;
    }
    if (stats)
        *stats = own_stats;
    *made = image;
    return NEPH_OK;
}
