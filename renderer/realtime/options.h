/* SPDX-License-Identifier: MIT
 *
 * What the real-time renderer can be set to, and the presets: named sets of values. Every
 * difference between two presets is a setting of this table.
 */
#ifndef NEPH_RENDERER_REALTIME_OPTIONS_H
#define NEPH_RENDERER_REALTIME_OPTIONS_H

#include "base/option.h"
#include "renderer/shaders/realtime_names.h"

/* By the names RT_*; ends with a NULL name. The defaults are the preset `fixed`. */
extern const struct neph_option neph_rt_options[RT_SETTING_COUNT + 1];

/* Whole pipelines: presets.c says where each comes from. */
extern const struct neph_preset neph_rt_presets[];

#endif
