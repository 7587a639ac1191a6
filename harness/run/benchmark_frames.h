/* SPDX-License-Identifier: MIT
 *
 * How fast engines without noise make pictures in a row: after a second of warm-up pictures follow
 * each other as in a game, a few on their way to the device at once and nothing of them read back.
 * Beside each speed stand its error and what the device can do at most (renderer/ceilings.h), both
 * measured in the same run. Where a scene rests the warm-up goes on until the engine knows it
 * (renderer/realtime/stillness.h), so that a median is not of two kinds of pictures.
 */
#ifndef NEPH_HARNESS_RUN_BENCHMARK_FRAMES_H
#define NEPH_HARNESS_RUN_BENCHMARK_FRAMES_H

#include "harness/run/chain_times.h"
#include "harness/run/showing.h"
#include "renderer/ceilings.h"

enum { NEPH_BENCHMARK_FRAMES_ENGINES_MAX = 4, NEPH_BENCHMARK_FRAMES_MAX = 100000 };

struct neph_benchmark_pass {
    const char *name;
    struct neph_spread gpu_s;
    double traffic_bytes;       /* of targets; NaN: not known */
    bool is_march;              /* it evaluates the media's density */
    double density_evaluations; /* of the picture that was counted; NaN: it has none, or with those
                                   of something that has no time of its own */
    double evaluation_s;        /* median time of the passes that made these */
    double
        variant_gain; /* time of the readable shader, and of a pass that the variant for the device
                            absorbs, over this time; NaN: it has no variant for the device */
    char with[64];    /* those beside this one: "scene, cloud shadow"; empty: none */
};

struct neph_benchmark_frames_engine {
    struct neph_job job;   /* its engine, settings and shot */
    const char *preset;    /* the caller's: what its settings began as (neph_settings_origin) */
    double first_s;        /* from nothing to the first picture on the CPU */
    uint64_t device_bytes; /* the most memory of the device that it had until these were timed */
    int frame_count;       /* timed */
    int steady_from;       /* the first of these from which on the engine knew that nothing changes;
                              -1: none */
    double mean_s;         /* from the first's departure to the last at home, by their number */
    struct neph_spread frame_s; /* of the wall clock, from one picture to the next */
    struct neph_spread gpu_s;   /* of all passes; NaN: the device has no clock */
    struct neph_spread cpu_s;   /* until one is sent, with waiting where it is cut into pieces */
    int pass_count;
    struct neph_benchmark_pass passes[NEPH_FLIGHT_PASSES_MAX];
    const struct neph_engine *reference; /* the march of the same lighting, at its defaults */
    double error; /* of the radiance against the reference's: rel_rmse of `neph metrics error` */
    struct neph_chain_times chain; /* of the last picture through the chain to the display */
};

struct neph_benchmark_frames {
    int engine_count;
    struct neph_benchmark_frames_engine engines[NEPH_BENCHMARK_FRAMES_ENGINES_MAX];
    bool without_ceilings;        /* nobody asks what the device can do: all of them are NaN */
    struct neph_showing *showing; /* the chain to the display, borrowed; NULL: there is none */
    struct neph_ceilings ceilings;
    bool samples_grids;  /* density evaluations of the scene are samples of voxel grids */
    int thread_count;    /* of a CPU device; 0: it is none */
    double cpu_clock_hz; /* of a CPU device, when the ceilings were measured; NaN: not known */
};

/* Fill in the measurements. `benchmark` comes with `engine_count` jobs, all of one scene and size,
 * with a scratch folder that is theirs; `frame_count` pictures of each are timed, in 10 s at most.
 * The pictures are those of the scene's frames, to and fro. */
enum neph_status neph_benchmark_frames_run(struct neph_benchmark_frames *benchmark, int frame_count,
                                           bool quiet, struct neph_diag *diag);

/* What part a pass of an engine gets of the ceiling that limits it: a march through grids alone of
 * samples, by a buffer or by the texture unit as the engine is set, any other march of none that is
 * measured, all else of copies; NaN: not known. `*limit` names it, or is NULL. */
double neph_benchmark_share(const struct neph_benchmark_frames *benchmark,
                            const struct neph_benchmark_frames_engine *engine,
                            const struct neph_benchmark_pass *pass, const char **limit);

/* What a density evaluation of a march takes, beside what the device can do; NaN: not known, or no
 * such pass. */
struct neph_benchmark_evaluation {
    double chain_share;   /* of the rate of samples that wait for each other (struct neph_ceilings);
                           NaN where not all evaluations are samples of grids, too */
    double multiply_adds; /* that the device can make in the time of one: what all else around the
                             sample may cost before arithmetic is what the pass waits for */
};

struct neph_benchmark_evaluation
neph_benchmark_evaluation(const struct neph_benchmark_frames *benchmark,
                          const struct neph_benchmark_frames_engine *engine,
                          const struct neph_benchmark_pass *pass);

/* For the caller to free. */
json_t *neph_benchmark_frames_json(const struct neph_benchmark_frames *benchmark);

#endif
