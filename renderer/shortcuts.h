/* SPDX-License-Identifier: MIT
 *
 * Shortcuts of a march through media (struct neph_shortcuts): what shaders are told of them, and
 * what is refused. Each is off unless asked for, and says what it costs in docs/realtime.md.
 */
#ifndef NEPH_RENDERER_SHORTCUTS_H
#define NEPH_RENDERER_SHORTCUTS_H

#include "renderer/march_params.h"

struct neph_gpu_frame; /* shaders/structs.h */

/* Words of choices of march_settings.toml that others have, too; each ends with NULL. */
extern const char *const neph_texel_formats[], *const neph_sky_refills[];

/* Bits of the specialization constant SHORTCUTS: those of settings with a `bit`. */
uint32_t neph_shortcuts_bits(const struct neph_shortcuts *shortcuts);

/* The numbers of these settings. */
void neph_shortcuts_set_frame(const struct neph_shortcuts *shortcuts, struct neph_gpu_frame *frame);

/* NEPH_ERR_USAGE: a number out of range, or a last step beyond NEPH_STEP_GROWTH_WHOLE_MAX of the
 * first. NEPH_ERR_UNSUPPORTED: the light of Horizon's clouds with a sun cache, which it has no use
 * for, or with skipping: it shines in clear air. */
enum neph_status neph_shortcuts_check(const struct neph_march_params *params,
                                      struct neph_diag *diag);

#endif
