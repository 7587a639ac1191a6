/* SPDX-License-Identifier: MIT
 *
 * The experiments that come with neph, one file each.
 */
#ifndef NEPH_HARNESS_EXPERIMENTS_EXPERIMENTS_H
#define NEPH_HARNESS_EXPERIMENTS_EXPERIMENTS_H

#include "harness/experiment/experiment.h"

extern const struct neph_experiment neph_experiment_ablation;
extern const struct neph_experiment neph_experiment_attribution;
extern const struct neph_experiment neph_experiment_convergence;
extern const struct neph_experiment neph_experiment_flicker;
extern const struct neph_experiment neph_experiment_fog;
extern const struct neph_experiment neph_experiment_light;
extern const struct neph_experiment neph_experiment_phase;
extern const struct neph_experiment neph_experiment_pick;
extern const struct neph_experiment neph_experiment_post;
extern const struct neph_experiment neph_experiment_scaling;
extern const struct neph_experiment neph_experiment_screen;
extern const struct neph_experiment neph_experiment_sky;
extern const struct neph_experiment neph_experiment_steps;
extern const struct neph_experiment neph_experiment_sweep;
extern const struct neph_experiment neph_experiment_validate;

#endif
