/* SPDX-License-Identifier: MIT */
#include "harness/engines/gpu_frames.h"

#include "base/clock.h"
#include "harness/engines/process_cost.h"
#include "harness/engines/vulkan_device.h"

#include <math.h>
#include <stdlib.h>

struct sequence {
    const struct neph_engine *engine;
    struct neph_open_device *device; /* NULL: on the CPU */
    void *renderer;                  /* for frames of this size */
    int width_px, height_px;
    int submitted, collected;
    struct neph_flight_cost costs[NEPH_FLIGHT_FRAMES_MAX]; /* costs of submitted frames, by their
                                                              * number */
};

static void close_sequence(void *opened)
{
    struct sequence *sequence = opened;
    if (!sequence)
        return;
    sequence->engine->gpu->destroy(sequence->renderer);
    neph_device_release(sequence->device);
    free(sequence);
}

/* Create or resize the renderer if the frame size has changed. */
static enum neph_status set_up(struct sequence *sequence, const struct neph_shot *shot,
                               struct neph_diag *diag)
{
    const struct neph_gpu_renderer *gpu = sequence->engine->gpu;
    if (sequence->renderer && shot->width_px == sequence->width_px &&
        shot->height_px == sequence->height_px)
        return NEPH_OK;
    sequence->width_px = shot->width_px;
    sequence->height_px = shot->height_px;
    if (sequence->renderer && gpu->resize)
        return gpu->resize(sequence->renderer, shot, diag);
    gpu->destroy(sequence->renderer);
    sequence->renderer = NULL;
    return gpu->create(sequence->device ? sequence->device->vulkan : NULL, sequence->engine, shot,
                       &sequence->renderer, diag);
}

static enum neph_status open_sequence(const struct neph_engine *engine,
                                      const struct neph_shot *shot, void **opened,
                                      struct neph_diag *diag)
{
    struct sequence *sequence = calloc(1, sizeof(*sequence));
    if (!sequence)
        return neph_fail_memory(diag);
    sequence->engine = engine;
    enum neph_status status = NEPH_OK;
    if (!engine->gpu->needs_device || engine->gpu->needs_device(shot))
        status = neph_device_acquire(shot->device, &sequence->device, diag);
    if (!status)
        status = set_up(sequence, shot, diag);
    if (status)
        close_sequence(sequence);
    else
        *opened = sequence;
    return status;
}

static enum neph_status next_frame(void *opened, const struct neph_shot *shot,
                                   struct neph_image **frame, struct neph_cost *cost,
                                   struct neph_diag *diag)
{
    struct sequence *sequence = opened;
    const struct neph_stopwatch start = neph_stopwatch_start();
    struct neph_image *image = NULL;
    double render_s = NAN;
    sequence->collected = sequence->submitted; /* drop the costs of frames in flight */
    enum neph_status status = set_up(sequence, shot, diag);
    if (!status)
        status = sequence->engine->gpu->frame(sequence->renderer, shot, &image, &render_s, diag);
    return neph_finish_process_frame(status, image, start, render_s, frame, cost);
}

static enum neph_status submit(void *opened, const struct neph_shot *shot, struct neph_diag *diag)
{
    struct sequence *sequence = opened;
    struct neph_flight_cost cost = {.gpu_s = 0.0};
    const double start_s = neph_wall_s();
    enum neph_status status = set_up(sequence, shot, diag);
    if (!status)
        status = sequence->engine->gpu->submit(sequence->renderer, shot, &cost, diag);
    if (status)
        return status;
    cost.cpu_s = neph_wall_s() - start_s;
    sequence->costs[sequence->submitted++ % NEPH_FLIGHT_FRAMES_MAX] = cost;
    return NEPH_OK;
}

static enum neph_status collect(void *opened, struct neph_flight_cost *cost, struct neph_diag *diag)
{
    struct sequence *sequence = opened;
    const struct neph_gpu_renderer *gpu = sequence->engine->gpu;
    struct neph_flight_cost done = sequence->costs[sequence->collected % NEPH_FLIGHT_FRAMES_MAX];
    const enum neph_status status = gpu->collect ? gpu->collect(sequence->renderer, &done, diag)
                                                 : NEPH_OK;
    if (status)
        return status;
    sequence->collected++;
    *cost = done;
    return NEPH_OK;
}

static enum neph_status watch(void *opened, uint64_t *bad, struct neph_diag *diag)
{
    struct sequence *sequence = opened;
    return sequence->engine->gpu->watch(sequence->renderer, bad, diag);
}

static void disable_variants(void *opened, bool leaves)
{
    struct sequence *sequence = opened;
    sequence->engine->gpu->disable_variants(sequence->renderer, leaves);
}

const struct neph_engine_sequence neph_gpu_sequence = {.open = open_sequence,
                                                       .next = next_frame,
                                                       .submit = submit,
                                                       .collect = collect,
                                                       .close = close_sequence};

const struct neph_engine_sequence neph_gpu_sequence_watched = {.open = open_sequence,
                                                               .next = next_frame,
                                                               .submit = submit,
                                                               .collect = collect,
                                                               .watch = watch,
                                                               .disable_variants = disable_variants,
                                                               .close = close_sequence};

enum neph_status neph_engine_render(const struct neph_engine *engine, const struct neph_shot *shot,
                                    struct neph_image **frame, struct neph_cost *cost,
                                    struct neph_diag *diag)
{
    struct neph_shot own = *shot;
    own.engine = engine;
    if (engine->render)
        return engine->render(&own, frame, cost, diag);
    const struct neph_stopwatch start = neph_stopwatch_start();
    void *sequence = NULL;
    enum neph_status status = engine->sequence->open(engine, shot, &sequence, diag);
    if (!status)
        status = engine->sequence->next(sequence, shot, frame, cost, diag);
    engine->sequence->close(sequence);
    if (!status && !(engine->gpu && engine->gpu->set_up_is_free))
        *cost = neph_measure_process_cost(start, cost->render_s);
    return status;
}

void neph_flight_cost_add(struct neph_flight_cost *cost, const char *name, double gpu_s,
                          double traffic_bytes)
{
    cost->passes[cost->pass_count].name = name;
    cost->passes[cost->pass_count].gpu_s = gpu_s;
    cost->passes[cost->pass_count++].traffic_bytes = traffic_bytes;
}

void neph_flight_cost_add_sky(struct neph_flight_cost *cost, const struct neph_sky_times *times)
{
    neph_flight_cost_add(cost, "sky of the air", times->air_s, NAN);
    neph_flight_cost_add(cost, "sky views", times->view_s, NAN);
    neph_flight_cost_add(cost, "sky shadows", times->shade_s, NAN);
    neph_flight_cost_add(cost, "sky before", times->aerial_s, NAN);
}
