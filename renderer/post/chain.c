/* SPDX-License-Identifier: MIT */
#include "renderer/post/chain.h"

#include "renderer/compute.h"
#include "renderer/post/colour.h"
#include "renderer/post/film.h"
#include "renderer/post/metadata.h"
#include "renderer/vulkan_device.h"
#include "shaders/structs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { local_size = 64, channels = 4, bindings = 6 };

static const size_t texel_bytes = channels * sizeof(float);

struct size {
    int width_px, height_px;
};

static size_t texel_count(struct size size)
{
    return (size_t)size.width_px * (size_t)size.height_px;
}

/* The buffer shared with the shaders of automatic exposure (eye.glsl). */
struct eye {
    float adapted_ev, target_ev;
    uint32_t counts[POST_METER_BINS], offsets[POST_METER_BINS];
};

/* A run of the chain. The two image buffers swap after each stage. */
struct work {
    struct neph_vulkan *vulkan;
    const struct neph_post_params *params;
    struct size size; /* of pictures[0], the current image */
    const struct neph_post_stage *stages[NEPH_POST_STAGES_MAX];
    int stage_count;
    struct neph_buffer pictures[2], table, eye, pyramid, readback, eye_readback;
    struct neph_buffer views[NEPH_POST_STAGES_MAX], warm_up_view;
    struct neph_batch batch;
};

/* ---- sizes ----------------------------------------------------------------------------------- */

static int compute_enlarged_side(int side_px, double percent)
{
    return (int)fmin(round(side_px * 100.0 / percent), NEPH_IMAGE_SIDE_MAX_PX + 1.0);
}

static int compute_reduced_side(int side_px, double percent)
{
    const double rounding = 1e-9; /* 50 % of 38 is 19 in spite of rounding */
    return (int)ceil(side_px * percent / 100.0 - rounding);
}

/* The input size for which the given stages produce an image of the window's size. */
static struct size size_before(const struct neph_post_stage *const *stages, int count,
                               const struct neph_settings *settings, struct size window)
{
    for (int i = count - 1; i >= 0; i--) {
        const double percent = settings->values[stages[i]->percent];
        if (stages[i]->makes == NEPH_POST_MAKES_LARGER)
            window = (struct size){compute_reduced_side(window.width_px, percent),
                                   compute_reduced_side(window.height_px, percent)};
    }
    return window;
}

static struct size size_after(const struct work *work, int at, struct size size)
{
    const struct neph_post_params *params = work->params;
    const double percent = params->settings.values[work->stages[at]->percent];
    const struct size window = {params->width_px, params->height_px};
    if (work->stages[at]->makes != NEPH_POST_MAKES_LARGER)
        return size;
    if (window.width_px > 0)
        return size_before(&work->stages[at + 1], work->stage_count - at - 1, &params->settings,
                           window);
    return (struct size){compute_enlarged_side(size.width_px, percent),
                         compute_enlarged_side(size.height_px, percent)};
}

static struct size last_size(const struct work *work)
{
    struct size size = work->size;
    for (int i = 0; i < work->stage_count; i++)
        size = size_after(work, i, size);
    return size;
}

void neph_post_frame_size(const struct neph_post_order *order, const struct neph_settings *settings,
                          int *width_px, int *height_px)
{
    const struct neph_post_stage *stages[NEPH_POST_STAGES_MAX];
    const int count = neph_post_sequence(order, settings, stages);
    const struct size size = size_before(stages, count, settings,
                                         (struct size){*width_px, *height_px});
    *width_px = size.width_px;
    *height_px = size.height_px;
}

/* ---- the pyramid of bloom ------------------------------------------------------------------- */

static struct size compute_half_size(struct size size)
{
    return (struct size){(size.width_px + 1) / 2, (size.height_px + 1) / 2};
}

/* Sizes of the pyramid levels, beginning with the image: at most the configured number, down to one
 * texel. */
static int level_sizes(const struct neph_settings *settings, struct size picture,
                       struct size sizes[POST_LEVELS_MAX + 1])
{
    const int most = (int)settings->values[POST_BLOOM_LEVELS];
    int level = 0;
    sizes[0] = picture;
    do {
        sizes[level + 1] = compute_half_size(sizes[level]);
        level++;
    } while (level < most && texel_count(sizes[level]) > 1);
    return level;
}

static size_t pyramid_texels(const struct neph_settings *settings, struct size picture)
{
    struct size sizes[POST_LEVELS_MAX + 1];
    size_t sum = 0;
    for (int level = level_sizes(settings, picture, sizes); level > 0; level--)
        sum += texel_count(sizes[level]);
    return sum;
}

static void fill_levels(const struct work *work, struct neph_gpu_post_view *view)
{
    struct size sizes[POST_LEVELS_MAX + 1];
    uint32_t at = 0;
    view->level_count = (uint32_t)level_sizes(&work->params->settings, work->size, sizes);
    for (uint32_t level = 0; level <= view->level_count; level++) {
        view->level_px[2 * level] = (uint32_t)sizes[level].width_px;
        view->level_px[2 * level + 1] = (uint32_t)sizes[level].height_px;
        view->level_at[level] = at;
        at += level ? (uint32_t)texel_count(sizes[level]) : 0;
    }
}

/* ---- parameters of the shaders --------------------------------------------------------------- */

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
    put_matrix(view->rec709_to_rec2020, neph_colour_matrix(&neph_rec709, &neph_rec2020));
}

/* Subdivisions of a bin's width: as many as can be summed over all pixels without overflow. */
static uint32_t meter_units(size_t pixel_count)
{
    const size_t most = UINT32_MAX / pixel_count;
    return most < 65536 ? (uint32_t)most : 65536;
}

static void fill_exposure(const struct neph_post_params *params, size_t pixel_count,
                          struct neph_gpu_post_view *view)
{
    view->step_s = (float)params->step_s;
    view->is_eye_open = params->eye && params->eye->is_open;
    view->eye_ev = view->is_eye_open ? (float)params->eye->adapted_ev : 0.0f;
    view->meter_units = meter_units(pixel_count);
}

/* Format of a stage's output: radiance does not fit 10-bit formats, the output of tone mapping
 * does. */
static uint32_t choose_target_format(const struct work *work, int at)
{
    const int targets = (int)work->params->settings.values[POST_TARGETS];
    for (int i = 0; i <= at; i++)
        if (work->stages[i]->pass == NEPH_POST_TONE_MAPPING)
            return (uint32_t)targets;
    return targets == POST_UNORM10 ? POST_FLOAT16 : (uint32_t)targets;
}

static void fill_view(const struct work *work, int at, struct size to,
                      struct neph_gpu_post_view *view)
{
    const struct neph_post_stage *stage = work->stages[at];
    const struct neph_post_params *params = work->params;
    for (int i = 0; i < POST_SETTING_COUNT; i++)
        view->settings[i] = (float)params->settings.values[i];
    view->from_px[0] = (uint32_t)work->size.width_px;
    view->from_px[1] = (uint32_t)work->size.height_px;
    view->to_px[0] = (uint32_t)to.width_px;
    view->to_px[1] = (uint32_t)to.height_px;
    view->frame = (uint32_t)params->frame;
    view->seed = (uint32_t)(params->seed ^ params->seed >> 32);
    fill_exposure(params, texel_count(work->size), view);
    view->upscale_filter = (uint32_t)params->settings.values[stage->filter];
    view->target = choose_target_format(work, at);
    fill_levels(work, view);
    fill_colours(&params->settings, view);
}

/* ---- a stage --------------------------------------------------------------------------------- */

static void dispatch(struct work *work, const struct neph_kernel *kernel,
                     struct neph_dispatch *whole, size_t thread_count, int level,
                     struct neph_diag *diag)
{
    const size_t groups_max = work->vulkan->limits.maxComputeWorkGroupCount[0];
    for (size_t first = 0; first < thread_count; first += groups_max * local_size) {
        const size_t groups = (thread_count - first + local_size - 1) / local_size;
        const struct neph_gpu_post_run run = {.first_thread = (uint32_t)first,
                                              .level = (uint32_t)level};
        whole->push = &run;
        whole->group_count = (uint32_t)(groups < groups_max ? groups : groups_max);
        neph_batch_dispatch(&work->batch, kernel, whole, diag);
    }
}

/* Threads of the stage's dispatch for a level; `level` is used only by the bloom stages. */
static size_t thread_count(const struct work *work, const struct neph_post_stage *stage,
                           struct size to, int level)
{
    struct size sizes[POST_LEVELS_MAX + 1];
    switch (stage->makes) {
    case NEPH_POST_MAKES_TABLE:
        return (size_t)POST_LUT_SIDE * POST_LUT_SIDE * POST_LUT_SIDE;
    case NEPH_POST_MAKES_HISTOGRAM:
        return (texel_count(work->size) + POST_METER_PIXELS - 1) / POST_METER_PIXELS;
    case NEPH_POST_MAKES_EXPOSURE:
        return 1;
    case NEPH_POST_MAKES_PYRAMID:
    case NEPH_POST_MAKES_BLOOM:
        level_sizes(&work->params->settings, work->size, sizes);
        return texel_count(sizes[level]);
    case NEPH_POST_MAKES_PICTURE:
    case NEPH_POST_MAKES_LARGER:
        break;
    }
    return texel_count(to);
}

static bool makes_image(const struct neph_post_stage *stage)
{
    return stage->makes == NEPH_POST_MAKES_PICTURE || stage->makes == NEPH_POST_MAKES_LARGER ||
           stage->makes == NEPH_POST_MAKES_BLOOM;
}

/* Dispatch a stage once, or once per level. */
static void run_stage(struct work *work, const struct neph_post_stage *stage,
                      const struct neph_kernel *kernel, struct neph_dispatch *whole, struct size to,
                      struct neph_diag *diag)
{
    struct size sizes[POST_LEVELS_MAX + 1];
    const int levels = level_sizes(&work->params->settings, work->size, sizes);
    const bool is_down = stage->makes == NEPH_POST_MAKES_PYRAMID;
    const int runs = is_down || stage->makes == NEPH_POST_MAKES_BLOOM ? levels : 1;
    for (int i = 0; i < runs; i++) {
        const int level = is_down ? i + 1 : runs - 1 - i;
        dispatch(work, kernel, whole, thread_count(work, stage, to, level), level, diag);
        neph_batch_barrier(&work->batch);
    }
}

/* Prepare a stage: its kernel, its bindings, and the uniform buffer `*view` for its position `at`
 * in the chain. */
static enum neph_status prepare_stage(struct work *work, int at, struct size to,
                                      struct neph_buffer *view, struct neph_dispatch *whole,
                                      const struct neph_kernel **kernel, struct neph_diag *diag)
{
    const struct neph_post_stage *stage = work->stages[at];
    const struct neph_kernel_params params = {
        .name = stage->shader.name,
        .code = stage->shader.code,
        .code_bytes = stage->shader.code_bytes,
        .buffer_count = bindings,
        .push_size_bytes = sizeof(struct neph_gpu_post_run),
    };
    *whole = (struct neph_dispatch){
        .buffers = {view, &work->pictures[0], &work->pictures[1], &work->table, &work->eye,
                    &work->pyramid},
    };
    const enum neph_status status = neph_buffer_create(work->vulkan, NEPH_BUFFER_UPLOAD,
                                                       sizeof(struct neph_gpu_post_view),
                                                       "post view", view, diag);
    if (status)
        return status;
    fill_view(work, at, to, view->mapped);
    return neph_kernel_get(work->vulkan, &params, kernel, diag);
}

/* Warm-up: run the first stage that makes an image repeatedly, into the buffer of the next image.
 */
static enum neph_status warm_up_stage(struct work *work, struct neph_diag *diag)
{
    struct neph_dispatch whole;
    const struct neph_kernel *kernel;
    int at = 0;
    while (at < work->stage_count && work->stages[at]->makes != NEPH_POST_MAKES_PICTURE)
        at++;
    if (work->params->warm_up_runs == 0 || at == work->stage_count)
        return NEPH_OK;
    const enum neph_status status = prepare_stage(work, at, work->size, &work->warm_up_view, &whole,
                                                  &kernel, diag);
    for (int i = 0; i < work->params->warm_up_runs && !status; i++)
        run_stage(work, work->stages[at], kernel, &whole, work->size, diag);
    neph_batch_stamp(&work->batch, NULL);
    return status;
}

static enum neph_status add_stage(struct work *work, int at, double *gpu_s, struct neph_diag *diag)
{
    const struct neph_post_stage *stage = work->stages[at];
    const struct size to = size_after(work, at, work->size);
    struct neph_dispatch whole;
    const struct neph_kernel *kernel;
    const enum neph_status status = prepare_stage(work, at, to, &work->views[at], &whole, &kernel,
                                                  diag);
    if (status)
        return status;
    run_stage(work, stage, kernel, &whole, to, diag);
    neph_batch_stamp(&work->batch, gpu_s);
    if (makes_image(stage)) {
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
    if (!status)
        status = warm_up_stage(work, diag);
    for (int i = 0; i < work->stage_count && !status; i++)
        status = add_stage(work, i, &stats->gpu_s[work->stages[i] - neph_post_stages], diag);
    if (!status)
        status = neph_batch_submit(&work->batch, "picture chain", diag);
    return status ? status
                  : neph_batches_wait(work->vulkan, neph_batches_submitted(work->vulkan),
                                      "picture chain", diag);
}

/* ---- upload and read-back -------------------------------------------------------------------- */

static enum neph_status upload_frame(struct work *work, float *const rgb[3], struct neph_diag *diag)
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

static enum neph_status download_image(struct work *work, struct neph_image *image,
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

static enum neph_status reset_exposure(struct work *work, struct neph_diag *diag)
{
    static const struct eye closed;
    return neph_buffer_upload(work->vulkan, &work->eye, 0, &closed, sizeof(closed), diag);
}

/* Read the exposure state back for the next frame and for the statistics. */
static enum neph_status read_exposure_state(struct work *work, struct neph_post_stats *stats,
                                            struct neph_diag *diag)
{
    struct neph_exposure_state *eye = work->params->eye;
    if (work->params->settings.values[POST_AUTO_EXPOSURE] == 0.0)
        return NEPH_OK;
    const enum neph_status status = neph_buffer_download(
        work->vulkan, &work->eye, &work->eye_readback, sizeof(struct eye), diag);
    if (status)
        return status;
    const struct eye *seen = work->eye_readback.mapped;
    stats->metered_ev = seen->target_ev;
    stats->adapted_ev = seen->adapted_ev;
    if (eye)
        *eye = (struct neph_exposure_state){.is_open = true, .adapted_ev = seen->adapted_ev};
    return NEPH_OK;
}

static enum neph_status create_chain_buffers(struct work *work, struct size last,
                                             struct neph_diag *diag)
{
    const size_t first_bytes = texel_count(work->size) * texel_bytes;
    const size_t last_bytes = texel_count(last) * texel_bytes;
    const size_t bytes = first_bytes > last_bytes ? first_bytes : last_bytes;
    const size_t table_bytes = (size_t)POST_LUT_SIDE * POST_LUT_SIDE * POST_LUT_SIDE * texel_bytes;
    const bool blooms = work->params->settings.values[POST_BLOOM] != 0.0;
    const size_t levels = blooms ? pyramid_texels(&work->params->settings, last) : 1;
    const struct neph_buffer_row rows[] = {
        {&work->pictures[0], NEPH_BUFFER_DEVICE, bytes, "picture"},
        {&work->pictures[1], NEPH_BUFFER_DEVICE, bytes, "picture"},
        {&work->table, NEPH_BUFFER_DEVICE, table_bytes, "picture"},
        {&work->eye, NEPH_BUFFER_DEVICE, sizeof(struct eye), "picture"},
        {&work->pyramid, NEPH_BUFFER_DEVICE, levels * texel_bytes, "picture"},
        {&work->readback, NEPH_BUFFER_READBACK, bytes, "picture"},
        {&work->eye_readback, NEPH_BUFFER_READBACK, sizeof(struct eye), "picture"},
    };
    return neph_buffers_create(work->vulkan, rows, sizeof(rows) / sizeof(rows[0]), diag);
}

static void finish(struct work *work)
{
    for (int i = 0; i < NEPH_POST_STAGES_MAX; i++)
        neph_buffer_destroy(work->vulkan, &work->views[i]);
    neph_buffer_destroy(work->vulkan, &work->warm_up_view);
    neph_buffer_destroy(work->vulkan, &work->eye_readback);
    neph_buffer_destroy(work->vulkan, &work->readback);
    neph_buffer_destroy(work->vulkan, &work->pyramid);
    neph_buffer_destroy(work->vulkan, &work->eye);
    neph_buffer_destroy(work->vulkan, &work->table);
    neph_buffer_destroy(work->vulkan, &work->pictures[1]);
    neph_buffer_destroy(work->vulkan, &work->pictures[0]);
}

enum neph_status neph_post_run(struct neph_vulkan *vulkan, const struct neph_post_params *params,
                               const struct neph_image *frame, struct neph_image **made,
                               struct neph_post_stats *stats, struct neph_diag *diag)
{
    struct work work = {.vulkan = vulkan, .params = params};
    struct neph_post_stats own_stats = {.metered_ev = NAN, .adapted_ev = NAN};
    struct neph_image *image = NULL;
    float *rgb[3];
    work.size = (struct size){frame->width_px, frame->height_px};
    if (!neph_image_rgb(frame, NULL, rgb))
        return neph_fail(diag, NEPH_ERR_INPUT, "the frame has no channels R, G and B");
    work.stage_count = neph_post_sequence(params->order, &params->settings, work.stages);
    const struct size last = last_size(&work);
    enum neph_status status = neph_image_create(last.width_px, last.height_px, &image, diag);
    if (!status)
        status = create_chain_buffers(&work, last, diag);
    if (!status)
        status = upload_frame(&work, rgb, diag);
    if (!status)
        status = reset_exposure(&work, diag);
    if (!status)
        status = run_stages(&work, &own_stats, diag);
    if (!status)
        status = read_exposure_state(&work, &own_stats, diag);
    if (!status)
        status = neph_post_copy_metadata(frame, image, diag);
    if (!status)
        status = download_image(&work, image, diag);
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
