/* SPDX-License-Identifier: MIT
 *
 * By how much a ray marcher's frame is off because its steps are finite: an estimate from few rays,
 * marched once more in double precision with the frame's steps and with twice as many.
 */
#ifndef NEPH_HARNESS_REPORT_STEP_BIAS_H
#define NEPH_HARNESS_REPORT_STEP_BIAS_H

#include "base/image.h"
#include "harness/engines/engine.h"

/* Above this part of the mean radiance a step bias is warned of. */
#define NEPH_STEP_BIAS_MAX 0.1

/* The estimated step bias of a shot's frame over the mean radiance of the frame; above 0: too
 * bright. Of light that is scattered once, or by octaves: NaN for other lightings, for engines
 * without equal steps, for frames without light, for so many steps that the estimate would take
 * long (neph_step_bias_omission()), and without memory. */
double neph_step_bias(const struct neph_shot *shot, const struct neph_engine *engine,
                      const struct neph_image *frame);

/* Why the estimate is left out, for the caller to free; NULL: it has not too many steps, or memory
 * is short. */
char *neph_step_bias_omission(const struct neph_shot *shot, const struct neph_engine *engine);

/* The warning, for the caller to free; NULL: the bias is small or unknown, or memory is short. */
char *neph_step_bias_warning(double bias, const struct neph_engine *engine);

#endif
