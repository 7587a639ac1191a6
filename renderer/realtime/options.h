/* SPDX-License-Identifier: MIT
 *
 * Settings of the real-time renderer, and the presets: named sets of values. Every difference
 * between two presets is a setting of this table.
 */
#ifndef NEPH_RENDERER_REALTIME_OPTIONS_H
#define NEPH_RENDERER_REALTIME_OPTIONS_H

#include "base/option.h"
#include "renderer/realtime/shared/names.h"
#include "settings/realtime_settings.h"

/* By the names RT_*; ends with a NULL name. The defaults are the preset `fixed`. */
extern const struct neph_option neph_rt_options[RT_SETTING_COUNT + 1];

/* The group of each option, a heading of docs/settings.md: "march", "anti aliasing", ... */
extern const char *const neph_rt_option_groups[RT_SETTING_COUNT];

/* Values of these options, grouped by pass. */
struct neph_rt_settings neph_rt_group_settings(const struct neph_settings *settings);

/* Whether a shortcut is replaced by what it approximates (oracle/settings.toml). */
bool neph_rt_has_oracle(const struct neph_rt_settings *settings);

/* Complete pipelines; presets.c names the source of each. */
extern const struct neph_preset neph_rt_presets[];

/* The commands that use a preset when the user names none. */
enum neph_rt_preset_use {
    NEPH_RT_STRESS_QUICK = 1 << 0, /* stress tests: the quick tier, .. */
    NEPH_RT_STRESS_FULL = 1 << 1,  /* .. and the full one */
    NEPH_RT_STRESS = NEPH_RT_STRESS_QUICK | NEPH_RT_STRESS_FULL,
    NEPH_RT_FLICKER = 1 << 2,     /* `neph study flicker` */
    NEPH_RT_CONVERGENCE = 1 << 3, /* `neph study convergence` */
    NEPH_RT_REPORT = 1 << 4,      /* the report of `neph validate`: frames over time */
    NEPH_RT_PICK = 1 << 5, /* `neph pick`: pipelines; the cheapest is the last in the table */
};

#endif
