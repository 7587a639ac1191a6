/* SPDX-License-Identifier: MIT
 *
 * The floors of a flicker study, derived from the groups of the option table.
 */
#include "harness/study/floor_plan.h"

#include "harness/engines/engines.h"
#include "renderer/realtime/options.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void copy_group(const struct neph_settings *from, const char *group,
                       struct neph_settings *to)
{
    for (int i = 0; i < RT_SETTING_COUNT; i++)
        if (strcmp(neph_rt_option_groups[i], group) == 0)
            to->values[i] = from->values[i];
}

static bool are_settings_equal(const struct neph_settings *a, const struct neph_settings *b)
{
    return memcmp(a->values, b->values, RT_SETTING_COUNT * sizeof(a->values[0])) == 0;
}

/* The settings of preset words at the steps of the study; false for a user engine, which has
 * none of them. */
static enum neph_status parse_words(const char *words, int steps, bool *is_realtime,
                                    struct neph_settings *settings, struct neph_diag *diag)
{
    const struct neph_engine *engine;
    char shared[32];
    snprintf(shared, sizeof(shared), "steps=%d", steps);
    const enum neph_status status = neph_engine_parse_words(words, shared, &engine, settings, diag);
    *is_realtime = !status && !engine->is_user_engine;
    return status;
}

/* "off+KEY=VALUE+...": the settings as changes of `off`. */
static const char *make_words(const struct neph_settings *settings, const struct neph_settings *off,
                              struct neph_arena *arena)
{
    char *changes = neph_options_changes(neph_rt_options, settings, off);
    for (char *space = changes; space && (space = strchr(space, ' '));)
        *space = '+';
    const char *words = neph_arena_format(arena, "off%s%s", changes && *changes ? "+" : "",
                                          changes ? changes : "");
    arena->is_short |= !changes;
    free(changes);
    return words;
}

/* The configuration of the plan with these settings, which is added if there is none. */
static enum neph_status find_or_add(const struct neph_settings *settings,
                                    const struct neph_settings *off, int steps,
                                    struct neph_arena *arena, struct neph_floor_plan *plan,
                                    int *index, struct neph_diag *diag)
{
    const int count = plan->preset_count + plan->floor_count;
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < count && !status; i++) {
        struct neph_settings other;
        bool is_realtime;
        status = parse_words(plan->words[i], steps, &is_realtime, &other, diag);
        if (is_realtime && are_settings_equal(settings, &other)) {
            *index = i;
            return NEPH_OK;
        }
    }
    if (status)
        return status;
    plan->words[count] = make_words(settings, off, arena);
    plan->floor_count++;
    *index = count;
    return neph_arena_check(arena, diag);
}

enum neph_status neph_floor_settings(const struct neph_settings *preset,
                                     struct neph_settings floors[NEPH_STUDY_FLOOR_CANDIDATES],
                                     struct neph_diag *diag)
{
    const struct neph_settings defaults = neph_options_default(neph_rt_options);
    struct neph_settings off;
    const struct neph_engine *engine;
    const enum neph_status status = neph_engine_parse_words("off", NULL, &engine, &off, diag);
    for (int i = 0; i < NEPH_STUDY_FLOOR_CANDIDATES && !status; i++) {
        floors[i] = off;
        copy_group(preset, "march", &floors[i]);
        copy_group(i == 0 ? preset : &defaults, "anti aliasing", &floors[i]);
    }
    return status;
}

/* Plans both floors of a preset. A user engine has those of the defaults. */
static enum neph_status plan_preset(int preset, int steps, struct neph_arena *arena,
                                    struct neph_floor_plan *plan, struct neph_diag *diag)
{
    struct neph_settings off, of_preset, floors[NEPH_STUDY_FLOOR_CANDIDATES];
    bool is_realtime;
    enum neph_status status = parse_words("off", steps, &is_realtime, &off, diag);
    if (!status)
        status = parse_words(plan->words[preset], steps, &is_realtime, &of_preset, diag);
    if (!status && !is_realtime)
        status = parse_words("off+taa=on", steps, &is_realtime, &of_preset, diag);
    if (!status)
        status = neph_floor_settings(&of_preset, floors, diag);
    for (int i = 0; i < NEPH_STUDY_FLOOR_CANDIDATES && !status; i++)
        status = find_or_add(&floors[i], &off, steps, arena, plan,
                             &plan->floors[preset].candidates[i], diag);
    return status;
}

enum neph_status neph_floor_plan_make(const char *const *presets, int preset_count, int steps,
                                      struct neph_arena *arena, struct neph_floor_plan *plan,
                                      struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    *plan = (struct neph_floor_plan){.preset_count = preset_count};
    for (int i = 0; i < preset_count; i++)
        plan->words[i] = presets[i];
    for (int i = 0; i < preset_count && !status; i++)
        status = plan_preset(i, steps, arena, plan, diag);
    return status;
}
