/* SPDX-License-Identifier: MIT
 *
 * Part of `neph study phase`: engines that render plane clouds, compared with doubling in ranges of
 * the angle between the sunlight and the light that leaves the cloud.
 */
#ifndef NEPH_HARNESS_EXPERIMENTS_PHASE_ENGINES_H
#define NEPH_HARNESS_EXPERIMENTS_PHASE_ENGINES_H

#include "harness/experiment/experiment.h"
#include "harness/physics/stage.h"

/* Ranges of that angle [degrees]: 0 is the aureole around the sun, 180 the glory. */
struct neph_angle_range {
    double from_deg, to_deg;
    const char *name;
};
enum { NEPH_ANGLE_RANGES = 6 };
extern const struct neph_angle_range neph_angle_ranges[NEPH_ANGLE_RANGES];

/* Over the directions of a range. */
struct neph_phase_difference {
    double mean;  /* sum of the differences over the sum of the truth */
    double error; /* standard error of that, over seeds; NaN: no noise or one seed */
    double rms;   /* of the relative difference */
    int count;
};

struct neph_phase_cloud {
    double optical_depth, albedo, sun_elevation_deg;
    struct neph_phase droplets;
    int node_count; /* as of struct neph_slab_params */
};

/* Two wide frames, from below towards the sun and from above towards the point opposite to it, with
 * the light of the droplets by doubling in each pixel. */
struct neph_phase_frames;
enum neph_status neph_phase_frames_create(const struct neph_phase_cloud *cloud, int width_px,
                                          int height_px, struct neph_phase_frames **frames,
                                          struct neph_diag *diag);
void neph_phase_frames_destroy(struct neph_phase_frames *frames); /* NULL is allowed */

/* An engine with its settings. */
struct neph_phase_engine {
    const char *words; /* "ENGINE+KEY=VALUE+...": its name in the results; borrowed */
    const struct neph_engine *engine;
    struct neph_settings settings;
    struct neph_engine_info info;
};

/* Choose an engine by words, and probe it. Errors as of neph_settings_set(). */
enum neph_status neph_phase_engine_find(const char *words, struct neph_shared_device *device,
                                        struct neph_phase_engine *engine, struct neph_diag *diag);

/* Render the cloud with a phase function and compare. Engines without multiple scattering get the
 * scene with single scattering, and `note` says so. If there is no frame, all differences are NaN,
 * and `note` has the reason. An engine with noise renders `seed_count` times. */
enum neph_status neph_phase_engine_measure(const struct neph_phase_engine *engine,
                                           const struct neph_phase_frames *frames,
                                           const struct neph_phase *phase, int seed_count,
                                           const struct neph_experiment_run *run,
                                           struct neph_phase_difference found[NEPH_ANGLE_RANGES],
                                           char note[256], struct neph_diag *diag);

#endif
