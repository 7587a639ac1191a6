/* SPDX-License-Identifier: MIT
 *
 * The settings of the screen passes, and their presets.
 */
#ifndef NEPH_RENDERER_SCREEN_OPTIONS_H
#define NEPH_RENDERER_SCREEN_OPTIONS_H

#include "base/option.h"
#include "renderer/shaders/screen_names.h"

/* Indexed by SCREEN_*; ends with a NULL name. */
extern const struct neph_option neph_screen_options[SCREEN_SETTING_COUNT + 1];

extern const struct neph_preset neph_screen_presets[];

/* The commands that use a preset by default. */
enum neph_screen_preset_use {
    NEPH_SCREEN_STUDY = 1, /* `neph study screen` */
};

#endif
