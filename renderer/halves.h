/* SPDX-License-Identifier: MIT
 *
 * Tests of a driver's conversions between float and half. Vulkan leaves their rounding open;
 * emulating one with integers takes about twenty instructions instead of one. Not for other
 * folders.
 */
#ifndef NEPH_RENDERER_HALVES_H
#define NEPH_RENDERER_HALVES_H

#include "renderer/compute.h"
#include "renderer/shaders/constants.h"

/* Run a kernel that tests the conversions. `*right` receives NEPH_HALVES_READ if unpackHalf2x16()
 * is exact for every half, and NEPH_HALVES_WRITTEN if packHalf2x16() rounds to nearest even at all
 * values where the rounding decides. */
enum neph_status neph_halves_test(struct neph_vulkan *vulkan, uint32_t *right,
                                  struct neph_diag *diag);

#endif
