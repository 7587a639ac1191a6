/* SPDX-License-Identifier: MIT
 *
 * The settings of the post-processing chain, and its presets.
 */
#ifndef NEPH_RENDERER_POST_OPTIONS_H
#define NEPH_RENDERER_POST_OPTIONS_H

#include "base/option.h"
#include "renderer/shaders/post_names.h"

/* Indexed by POST_*; ends with a NULL name. By default every stage is off. */
extern const struct neph_option neph_post_options[POST_SETTING_COUNT + 1];

extern const struct neph_preset neph_post_presets[];

#endif
