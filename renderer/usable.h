/* SPDX-License-Identifier: MIT
 *
 * Whether an open device can serve another frame.
 */
#ifndef NEPH_RENDERER_USABLE_H
#define NEPH_RENDERER_USABLE_H

#include "renderer/vulkan.h"

/* False: the device was lost, or validation has had a message, which would fail every later frame.
 * The device runs an empty batch, after all batches that were sent before. */
bool neph_vulkan_is_usable(const struct neph_vulkan *vulkan);

#endif
