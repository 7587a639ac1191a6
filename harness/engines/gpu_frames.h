/* SPDX-License-Identifier: MIT
 *
 * Frames in a row of neph's own engines on a GPU: the functions of their sequence, written once,
 * and a frame by itself of any engine.
 * An engine gives the functions of its renderer (neph_engine.gpu), and this file opens the device,
 * sets the renderer up for the size of the frames, submits, collects and measures.
 */
#ifndef NEPH_HARNESS_ENGINES_GPU_FRAMES_H
#define NEPH_HARNESS_ENGINES_GPU_FRAMES_H

#include "harness/engines/engine.h"
#include "renderer/sky/sky_times.h"

struct neph_vulkan;

/* The functions get the renderer that `create` has made. */
struct neph_gpu_renderer {
    /* A renderer of a shot's scene, settings and size. `vulkan` NULL: the shot runs on the CPU, and
     * the renderer may be NULL. `*renderer` is destroyed by the caller, also after an error. */
    enum neph_status (*create)(struct neph_vulkan *vulkan, const struct neph_engine *engine,
                               const struct neph_shot *shot, void **renderer,
                               struct neph_diag *diag);
    void (*destroy)(void *renderer); /* NULL is fine */

    /* From here on frames have the shot's size. NULL: a new renderer is created for them. */
    enum neph_status (*resize)(void *renderer, const struct neph_shot *shot,
                               struct neph_diag *diag);

    /* A frame with its labels; `*render_s`, NaN before, is set to the time that it took where that
     * is known. `*frame` is the caller's to destroy, also after an error. */
    enum neph_status (*frame)(void *renderer, const struct neph_shot *shot,
                              struct neph_image **frame, double *render_s, struct neph_diag *diag);

    /* Submit a frame that is not read back. `cost` is empty and stays with the frame: what is
     * known by now is added. */
    enum neph_status (*submit)(void *renderer, const struct neph_shot *shot,
                               struct neph_flight_cost *cost, struct neph_diag *diag);

    /* Wait for the oldest frame submitted and complete its cost, in which `cpu_s` is the time that
     * `submit` took. NULL: `submit` has waited and completed it. */
    enum neph_status (*collect)(void *renderer, struct neph_flight_cost *cost,
                                struct neph_diag *diag);

    /* As neph_engine_sequence.watch, of neph_gpu_sequence_watched. */
    enum neph_status (*watch)(void *renderer, uint64_t *bad, struct neph_diag *diag);

    /* As neph_engine_sequence.leave_variants, of neph_gpu_sequence_watched. */
    void (*leave_variants)(void *renderer, bool leaves);

    /* Whether a shot needs the device; NULL: each does. */
    bool (*needs_device)(const struct neph_shot *shot);

    bool set_up_is_free; /* a frame by itself costs what the last of a sequence costs */
};

/* neph_engine.sequence of engines that have a neph_engine.gpu; the second has `watch` and
 * `leave_variants`. */
extern const struct neph_engine_sequence neph_gpu_sequence, neph_gpu_sequence_watched;

/* Render one frame by itself, which pays for what it is set up with (but neph_gpu_renderer
 * .set_up_is_free). As neph_engine.render. */
enum neph_status neph_engine_render(const struct neph_engine *engine, const struct neph_shot *shot,
                                    struct neph_image **frame, struct neph_cost *cost,
                                    struct neph_diag *diag);

/* Add a pass to a frame's cost. */
void neph_flight_cost_add(struct neph_flight_cost *cost, const char *name, double gpu_s,
                          double traffic_bytes);

/* Add the tables of a sky, also those of which nothing was filled: a frame has the passes of the
 * others. */
void neph_flight_cost_add_sky(struct neph_flight_cost *cost, const struct neph_sky_times *times);

#endif
