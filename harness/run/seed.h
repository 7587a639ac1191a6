/* SPDX-License-Identifier: MIT
 *
 * Seeds that differ between scenes, so that the errors of two scenes are independent.
 */
#ifndef NEPH_HARNESS_RUN_SEED_H
#define NEPH_HARNESS_RUN_SEED_H

#include "scenes/scene.h"

#include <stdint.h>

/* The number-th seed (from 1) of a scene: a hash of the scene's hash and the number, in
 * 1..0x7fffffff, the range of `neph render --seed`. */
uint64_t neph_seed_for_scene(const struct neph_scene *scene, int number);

#endif
