/* SPDX-License-Identifier: MIT */
#include "harness/study/attribution_plan.h"

#include "harness/engines/engines.h"
#include "renderer/realtime/options.h"

#include <stdio.h>
#include <string.h>

/* Fails to compile when a part or reference is added, as the tables need a row for it. */
_Static_assert(NEPH_IDEALS == 3, "a new kind");
_Static_assert(NEPH_PARTS == 8, "a new kind");

static const neph_part_set anti_aliasing = 1U << NEPH_PART_BLUR | 1U << NEPH_PART_ALIASING;

const struct neph_attribution_part neph_attribution_parts[NEPH_PARTS] = {
    [NEPH_PART_RAYS] = {"rays", "one ray in four half-resolution texels, the others from history",
                        "oracle_rays=on"},
    [NEPH_PART_REPROJECTION] = {"reprojection", "the distance at which history is read",
                                "oracle_motion=on"},
    [NEPH_PART_DISOCCLUSION] = {"disocclusion", "history where other geometry was before",
                                "oracle_depth=on"},
    [NEPH_PART_BOX] = {"box", "the neighbourhood clamp of history", "box=none"},
    [NEPH_PART_NOISE] = {"noise", "the shift of a ray's steps", "ray_dither=none"},
    [NEPH_PART_UPSCALE] = {"upscale", "from half-resolution texels to pixels", "oracle_upscale=on"},
    [NEPH_PART_BLUR] = {"blur", "an anti-aliased frame that is less sharp than 16 rays a pixel",
                        NULL},
    [NEPH_PART_ALIASING] = {"aliasing",
                            "other effects of anti-aliasing: edges that crawl, lag, ghosts", NULL},
};

/* ---- presets without an ideal ---------------------------------------------------------------- */

static const struct {
    int option;
    double value;
    const char *why;
} refusals[] = {
    {RT_SPLIT, RT_SPLIT_NONE, "it marches every pixel in every frame (split=none)"},
    {RT_ATROUS, 1.0, "the a-trous filter (atrous=on) is in place of the ideal parts"},
};

static enum neph_status check_preset(const char *preset, int steps, struct neph_diag *diag)
{
    const struct neph_engine *engine;
    struct neph_settings settings;
    char shared[32];
    snprintf(shared, sizeof(shared), "steps=%d", steps);
    const enum neph_status status = neph_engine_parse_words(preset, shared, &engine, &settings,
                                                            diag);
    const char *why = status || !engine->is_user_engine ? NULL : "it is a user engine";
    for (size_t i = 0; i < sizeof(refusals) / sizeof(refusals[0]) && !status && !why; i++)
        if (settings.values[refusals[i].option] == refusals[i].value)
            why = refusals[i].why;
    if (status || !why)
        return status;
    neph_fail(diag, NEPH_ERR_USAGE, "flicker of '%s' cannot be attributed: %s", preset, why);
    neph_hint(diag, "choose a preset with split=four and atrous=off, such as ours or fixed");
    return NEPH_ERR_USAGE;
}

/* ---- sequences ------------------------------------------------------------------------------- */

/* Adds a state's sequence, unless it is planned. */
static void add_sequence(neph_part_set state, struct neph_arena *arena,
                         struct neph_attribution_plan *plan)
{
    const char *words = plan->preset, *label = plan->preset, *before = ", ideal ";
    if (neph_attribution_find_sequence(plan, state) < plan->count)
        return;
    for (int i = 0; i < NEPH_PARTS; i++) {
        const struct neph_attribution_part *part = &neph_attribution_parts[i];
        const bool is_moot = neph_part_needs_rays((enum neph_attribution_part_id)i) &&
                             (state >> NEPH_PART_RAYS & 1U) == 0;
        if ((state >> i & 1U) != 0 || is_moot || !part->ideal)
            continue;
        words = neph_arena_format(arena, "%s+%s", words, part->ideal);
        label = neph_arena_format(arena, "%s%s%s", label, before, part->name);
        before = ", ";
    }
    plan->words[plan->count] = words;
    plan->labels[plan->count] = label;
    plan->states[plan->count++] = state;
}

int neph_attribution_find_sequence(const struct neph_attribution_plan *plan, neph_part_set state)
{
    int index = 0;
    while (index < plan->count && plan->states[index] != (state & ~anti_aliasing))
        index++;
    return index;
}

enum neph_ideal_kind neph_attribution_find_reference(neph_part_set state)
{
    static const enum neph_ideal_kind references[] = {NEPH_IDEAL_SEQUENCE, NEPH_IDEAL_ALIASED,
                                                      NEPH_IDEAL_BLURRED, NEPH_IDEALS};
    _Static_assert(NEPH_PART_ALIASING == NEPH_PART_BLUR + 1, "references");
    return references[(state & anti_aliasing) >> NEPH_PART_BLUR];
}

const char *neph_attribution_find_ideal(const struct neph_attribution_plan *plan)
{
    return plan->words[neph_attribution_find_sequence(plan, 0)];
}

enum neph_status neph_attribution_plan_make(const char *preset, int steps, struct neph_arena *arena,
                                            struct neph_attribution_plan *plan,
                                            struct neph_diag *diag)
{
    const neph_part_set all = NEPH_PARTS_ALL & ~anti_aliasing;
    const enum neph_status status = check_preset(preset, steps, diag);
    if (status)
        return status;
    *plan = (struct neph_attribution_plan){.preset = preset};
    add_sequence(all, arena, plan);
    for (int i = 0; i < NEPH_PART_BLUR; i++)
        add_sequence(neph_part_set_without(all, (enum neph_attribution_part_id)i), arena, plan);
    for (neph_part_set state = all + 1; state-- > 0;)
        if (neph_part_set_is_state(state))
            add_sequence(state, arena, plan);
    return neph_arena_check(arena, diag);
}
