/* SPDX-License-Identifier: MIT
 *
 * Sequences of frames of the built-in GPU engines: one implementation of neph_engine_sequence, and
 * the rendering of a single frame by any engine. An engine supplies its renderer's functions
 * (neph_engine.gpu); this file opens the device, sets the renderer up for the frame size, submits,
 * collects and measures.
 */
#ifndef NEPH_HARNESS_ENGINES_GPU_FRAMES_H
#define NEPH_HARNESS_ENGINES_GPU_FRAMES_H

#include "harness/engines/engine.h"
#include "renderer/sky/sky_times.h"

struct neph_vulkan;

/* A renderer: `create` makes it, the other functions receive it. */
struct neph_gpu_renderer {
    /* Create a renderer for a shot's scene, settings and size. `vulkan` NULL: the shot runs on the
     * CPU, and `*renderer` may stay NULL. The caller destroys `*renderer`, also after an error. */
    enum neph_status (*create)(struct neph_vulkan *vulkan, const struct neph_engine *engine,
                               const struct neph_shot *shot, void **renderer,
                               struct neph_diag *diag);
    void (*destroy)(void *renderer); /* renderer may be NULL */

    /* Change the frame size to the shot's. NULL: create a new renderer instead. */
    enum neph_status (*resize)(void *renderer, const struct neph_shot *shot,
                               struct neph_diag *diag);

    /* Render a labelled frame. `*render_s` starts as NaN; set it to the render time if that is
     * known. The caller destroys `*frame`, also after an error. */
    enum neph_status (*frame)(void *renderer, const struct neph_shot *shot,
                              struct neph_image **frame, double *render_s, struct neph_diag *diag);

    /* Submit a frame that is not read back. `cost` starts empty and stays with the frame; add the
     * costs that are known already. */
    enum neph_status (*submit)(void *renderer, const struct neph_shot *shot,
                               struct neph_flight_cost *cost, struct neph_diag *diag);

    /* Wait for the oldest submitted frame and complete its cost; `cpu_s` holds the time of the
     * submission. NULL: the submission has waited and completed the cost. */
    enum neph_status (*collect)(void *renderer, struct neph_flight_cost *cost,
                                struct neph_diag *diag);

    /* As neph_engine_sequence.watch; only for neph_gpu_sequence_watched. */
    enum neph_status (*watch)(void *renderer, uint64_t *bad, struct neph_diag *diag);

    /* As neph_engine_sequence.disable_variants; only for neph_gpu_sequence_watched. */
    void (*disable_variants)(void *renderer, bool leaves);

    /* Whether a shot needs a Vulkan device; NULL: always. */
    bool (*needs_device)(const struct neph_shot *shot);

    bool set_up_is_free; /* a single frame costs as much as a frame of a sequence */
};

/* Values of neph_engine.sequence for engines with a neph_engine.gpu; the second one has `watch` and
 * `disable_variants`. */
extern const struct neph_engine_sequence neph_gpu_sequence, neph_gpu_sequence_watched;

/* Render a single frame, with the cost of its set-up (except with
 * neph_gpu_renderer.set_up_is_free). As neph_engine.render. */
enum neph_status neph_engine_render(const struct neph_engine *engine, const struct neph_shot *shot,
                                    struct neph_image **frame, struct neph_cost *cost,
                                    struct neph_diag *diag);

/* Add a pass to a frame's cost. */
void neph_flight_cost_add(struct neph_flight_cost *cost, const char *name, double gpu_s,
                          double traffic_bytes);

/* Add the passes that fill the tables of a sky, also idle ones: every frame has the same passes. */
void neph_flight_cost_add_sky(struct neph_flight_cost *cost, const struct neph_sky_times *times);

#endif
