/* SPDX-License-Identifier: MIT
 *
 * A check that an open device can render another frame.
 */
#ifndef NEPH_RENDERER_USABLE_H
#define NEPH_RENDERER_USABLE_H

#include "renderer/vulkan.h"

/* False: the device was lost, or the validation layer has reported a message, which would fail
 * every later frame. Runs an empty batch after all submitted ones. */
bool neph_vulkan_is_usable(const struct neph_vulkan *vulkan);

#endif
