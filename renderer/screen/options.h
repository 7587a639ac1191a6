/* SPDX-License-Identifier: MIT
 *
 * What the passes of the screen can be set to, and the presets: named sets of values.
 */
#ifndef NEPH_RENDERER_SCREEN_OPTIONS_H
#define NEPH_RENDERER_SCREEN_OPTIONS_H

#include "base/option.h"
#include "renderer/shaders/screen_names.h"

/* By the names SCREEN_*; ends with a NULL name. */
extern const struct neph_option neph_screen_options[SCREEN_SETTING_COUNT + 1];

extern const struct neph_preset neph_screen_presets[];

/* What takes a preset when none is named. */
enum neph_screen_preset_use {
    NEPH_SCREEN_STUDY = 1, /* `neph study screen` */
};

#endif
