/* SPDX-License-Identifier: MIT
 *
 * Benchmark of engines without noise: the speed of frames in flight.
 *
 * After a second of warm-up, frames follow each other as in a game: a few are submitted ahead, and
 * none is read back. The error and the device's roofline limits (renderer/roofline.h) are measured
 * in the same run. For a static scene the warm-up goes on until the engine has detected that the
 * scene is static (renderer/realtime/stillness.h), so that all timed frames do the same work.
 */
#ifndef NEPH_HARNESS_RUN_BENCHMARK_FRAMES_H
#define NEPH_HARNESS_RUN_BENCHMARK_FRAMES_H

#include "harness/run/chain_times.h"
#include "harness/run/showing.h"
#include "renderer/roofline.h"

enum { NEPH_BENCHMARK_FRAMES_ENGINES_MAX = 4, NEPH_BENCHMARK_FRAMES_MAX = 100000 };

struct neph_benchmark_pass {
    const char *name;
    struct neph_spread gpu_s;
    double traffic_bytes;       /* of the targets; NaN: not known */
    bool is_march;              /* evaluates the media's density */
    double density_evaluations; /* of the counted frame; NaN: not a marcher, or the count includes
                                   work that has no time of its own */
    double evaluation_s;        /* sum of the median times of the passes in this count */
    double variant_gain; /* time of the readable shader, and of a pass that the device's variant
                            absorbs, over this time; NaN: no variant for this device */
    char with[64];       /* further passes in the count: "scene, cloud shadow"; empty: none */
};

struct neph_benchmark_frames_engine {
    struct neph_job job;   /* its engine, settings and shot */
    const char *preset;    /* the settings' origin (neph_settings_origin), from the caller */
    double first_s;        /* from opening the engine to the first frame on the CPU */
    uint64_t device_bytes; /* the engine's highest use of device memory up to the timed frames */
    int frame_count;       /* timed frames */
    int steady_from;       /* the first of these for which the engine skipped the gradient pass, the
                              scene being static; -1: none */
    double mean_s;         /* (last frame collected - first frame submitted) / frame_count */
    struct neph_spread frame_s; /* wall-clock time from one frame to the next */
    struct neph_spread gpu_s;   /* of all passes; NaN: the device has no timestamps */
    struct neph_spread cpu_s;   /* until a frame is submitted, with the waiting between the parts of
                                   a split dispatch */
    int pass_count;
    struct neph_benchmark_pass passes[NEPH_FLIGHT_PASSES_MAX];
    const struct neph_engine *reference; /* the marcher with the same lighting, at its defaults */
    double error; /* relative RMSE of the radiance (rel_rmse of `neph metrics error`) */
    struct neph_chain_times chain; /* of the last frame, through the display chain */
};

struct neph_benchmark_frames {
    int engine_count;
    struct neph_benchmark_frames_engine engines[NEPH_BENCHMARK_FRAMES_ENGINES_MAX];
    bool without_ceilings;              /* skip the roofline limits: all are NaN */
    struct neph_display_chain *showing; /* the display chain, borrowed; NULL: none */
    struct neph_roofline_limits ceilings;
    bool samples_grids;  /* every density evaluation of the scene is a sample of a voxel grid */
    int thread_count;    /* of a CPU device; 0: the device is a GPU */
    double cpu_clock_hz; /* of a CPU device, when the ceilings were measured; NaN: not known */
};

/* Fills in the measurements. `benchmark` comes with `engine_count` jobs. All jobs have one scene
 * and one size and share a scratch folder that no other job uses. `frame_count` frames of each
 * engine are timed, in at most 10 s. The frames are the scene's, played forwards and backwards in
 * turn. */
enum neph_status neph_benchmark_frames_run(struct neph_benchmark_frames *benchmark, int frame_count,
                                           bool quiet, struct neph_diag *diag);

/* The share of the roofline limit that a pass reaches. `*limit` names the limit, or is NULL:
 *
 *   pass                              limit
 *   marcher, scene of grids only      samples of a buffer or a texture, as the engine is set
 *   marcher, any other scene          none is measured: NaN
 *   any other pass                    copies
 *
 * NaN: not known. */
double neph_benchmark_share(const struct neph_benchmark_frames *benchmark,
                            const struct neph_benchmark_frames_engine *engine,
                            const struct neph_benchmark_pass *pass, const char **limit);

/* The cost of a density evaluation beside the roofline limits; NaN: not known, or the pass is not a
 * marcher. */
struct neph_benchmark_evaluation {
    /* of the rate of dependent samples (struct neph_roofline_limits); NaN also where some
     * evaluations are not samples of a grid */
    double chain_share;
    double multiply_adds; /* multiply-adds that the device can make in the time of one evaluation:
                             an evaluation that needs more than this around its sample is limited by
                             arithmetic */
};

struct neph_benchmark_evaluation
neph_benchmark_evaluation(const struct neph_benchmark_frames *benchmark,
                          const struct neph_benchmark_frames_engine *engine,
                          const struct neph_benchmark_pass *pass);

/* The caller frees the result. */
json_t *neph_benchmark_frames_json(const struct neph_benchmark_frames *benchmark);

#endif
