/* SPDX-License-Identifier: MIT
 *
 * Real-time methods of the ray marcher (struct neph_shortcuts): their values for the shaders, and
 * the checks of their settings. All are off by default; docs/realtime.md has their errors.
 */
#ifndef NEPH_RENDERER_SHORTCUTS_H
#define NEPH_RENDERER_SHORTCUTS_H

#include "renderer/march_params.h"

struct neph_gpu_frame; /* shaders/structs.h */

/* Choices of march_settings.toml that other tables use as well; NULL-terminated. */
extern const char *const neph_texel_formats[], *const neph_sky_refills[];

/* Bits of the specialization constant SHORTCUTS: those of settings with a `bit`. */
uint32_t neph_shortcuts_bits(const struct neph_shortcuts *shortcuts);

/* Write the numeric settings to the frame. */
void neph_shortcuts_set_frame(const struct neph_shortcuts *shortcuts, struct neph_gpu_frame *frame);

/* NEPH_ERR_USAGE: a number out of range, or a last step above NEPH_STEP_GROWTH_WHOLE_MAX times the
 * first. NEPH_ERR_UNSUPPORTED: the lighting of Horizon clouds with a sun cache, which it does not
 * use, or with skipping: it also emits in clear air. */
enum neph_status neph_shortcuts_check(const struct neph_march_params *params,
                                      struct neph_diag *diag);

#endif
