/* SPDX-License-Identifier: MIT
 *
 * What a driver's own conversions between floats and halves are worth. Vulkan leaves their rounding
 * open, and by whole numbers each takes some twenty instructions in place of one. Not for other
 * folders.
 */
#ifndef NEPH_RENDERER_HALVES_H
#define NEPH_RENDERER_HALVES_H

#include "renderer/compute.h"
#include "renderer/shaders/constants.h"

/* `*right` receives NEPH_HALVES_READ where unpackHalf2x16() gives every half's own value, and
 * NEPH_HALVES_WRITTEN where packHalf2x16() rounds to the nearest half, of two to the even one, at
 * every place where that decides. Runs a kernel. */
enum neph_status neph_halves_ask(struct neph_vulkan *vulkan, uint32_t *right,
                                 struct neph_diag *diag);

#endif
