/* SPDX-License-Identifier: MIT
 *
 * Estimate of a ray marcher's bias from its finite steps: a few rays are marched again in double
 * precision, with the frame's steps and with twice as many.
 */
#ifndef NEPH_HARNESS_REPORT_STEP_BIAS_H
#define NEPH_HARNESS_REPORT_STEP_BIAS_H

#include "base/image.h"
#include "harness/engines/engine.h"

/* A step bias above this share of the mean radiance causes a warning. */
#define NEPH_STEP_BIAS_MAX 0.1

/* The estimated step bias of a shot's frame, divided by the frame's mean radiance; positive: too
 * bright. Covers single scattering and octaves. NaN for other lighting models, for engines without
 * equal steps, for frames without light, for so many steps that the estimate would take too long
 * (neph_step_bias_omission()), and when memory is short. */
double neph_step_bias(const struct neph_shot *shot, const struct neph_engine *engine,
                      const struct neph_image *frame);

/* The reason why the estimate is left out, to be freed by the caller; NULL: the number of steps
 * allows the estimate, or memory is short. */
char *neph_step_bias_omission(const struct neph_shot *shot, const struct neph_engine *engine);

/* The warning, to be freed by the caller; NULL: the bias is small or unknown, or memory is
 * short. */
char *neph_step_bias_warning(double bias, const struct neph_engine *engine);

#endif
