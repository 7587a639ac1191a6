/* SPDX-License-Identifier: MIT */
#include "harness/night/plan.h"

#include "harness/data.h"
#include "harness/engines/engines.h"
#include "harness/physics/checks.h"
#include "renderer/realtime/options.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

/* Compiles only when this file handles every suite. */
_Static_assert(NEPH_NIGHT_SUITES == 5, "a new kind");

enum { STEPS_MAX = 512 };

/* First words of series and steps. Documents of earlier runs contain these words and are never
 * rewritten, so the stress tests keep their first name, "failure". */
static const char *const suite_names[] = {
    [NEPH_NIGHT_CATALOG] = "catalog", [NEPH_NIGHT_PHYSICS] = "physics",
    [NEPH_NIGHT_STRESS] = "failure",  [NEPH_NIGHT_SWEEP] = "sweep",
    [NEPH_NIGHT_SPEED] = "speed",
};

/* For each suite: the arguments before and after the name of a scene or check, and the estimated
 * cost and number of series before any measurement. The full tier only adds steps: the steps of the
 * quick tier are identical in it, so their series continue. */
static const struct {
    const char *before, *after;
    const char *size; /* NULL: the suite's own size */
    double guess_s;
    int guess_series;
} suites[] = {
    [NEPH_NIGHT_CATALOG] = {"validate",
                            "-e exact -e surfaces -e tracer -e march -e realtime -e fog_look "
                            "-e sky -e cycles -e povray --no-charts --budget 60",
                            "96x54", 20.0, 12},
    [NEPH_NIGHT_PHYSICS] = {"validate --suite physics --only",
                            "-e exact -e oracle -e tracer -e march -e povray --samples 64", NULL,
                            30.0, 5},
    [NEPH_NIGHT_STRESS] = {"validate --suite stress --only", "", NULL, 20.0, 9},
    [NEPH_NIGHT_SWEEP] = {"sweep", "--untimed --plan sweep --only march,ours", "96x54", 60.0, 16},
    [NEPH_NIGHT_SPEED] = {"benchmark", "-e march,realtime", "192x108", 30.0, 2},
};

/* Arguments after the scene of the catalogue with --only-engine; the engines follow. */
static const char only_engine_words[] = "--only-engine --no-charts --budget 60";

/* A step of a tier. `words`: arguments after the name; NULL: the suite's arguments. `variant`: for
 * a stress test, a variant of a preset in addition to the presets of the quick tier. */
struct listed {
    enum neph_night_suite suite;
    const char *name, *words, *variant;
};

/* Steps of the quick tier. The full tier adds `full_steps`, the whole catalogue, all checks and all
 * stress tests. */
static const struct listed quick_steps[] = {
    {NEPH_NIGHT_CATALOG, "height_fog_down", NULL, NULL},
    {NEPH_NIGHT_CATALOG, "scattering_slab_above", NULL, NULL},
    {NEPH_NIGHT_CATALOG, "grid_cloud_single", NULL, NULL},
    {NEPH_NIGHT_CATALOG, "voxel_grid", NULL, NULL},
    {NEPH_NIGHT_CATALOG, "fog_look_physical", NULL, NULL},
    {NEPH_NIGHT_CATALOG, "sky_earth", NULL, NULL},
    {NEPH_NIGHT_PHYSICS, "single_slab_thin", NULL, NULL},
    {NEPH_NIGHT_STRESS, "ridge_far", NULL, NULL},
    {NEPH_NIGHT_STRESS, "blob_sky", NULL, NULL},
    {NEPH_NIGHT_STRESS, "fog_none", NULL, NULL},
    {NEPH_NIGHT_STRESS, "edge_halo", NULL, NULL},
    {NEPH_NIGHT_STRESS, "froxel_leak", .variant = "fixed+froxels=on"},
    {NEPH_NIGHT_SWEEP, "voxel_grid", NULL, NULL},
    {NEPH_NIGHT_SWEEP, "spot_fence", "--untimed --plan sweep --only march,tracer", NULL},
    {NEPH_NIGHT_SWEEP, "cirrus", "--untimed --plan sweep --only march", NULL},
    {NEPH_NIGHT_SWEEP, "cloud_gaps", "--untimed --plan shadows --only map", NULL},
    {NEPH_NIGHT_SPEED, "voxel_grid", NULL, NULL},
};
static const struct listed full_steps[] = {
    {NEPH_NIGHT_STRESS, "froxel_seam", .variant = "fixed+froxels=on"},
    {NEPH_NIGHT_STRESS, "shadow_crawl", "--preset off --preset fixed --preset off+cloud_shadow=map",
     NULL},
    {NEPH_NIGHT_SWEEP, "cloud_below", NULL, NULL},
    {NEPH_NIGHT_SWEEP, "fence_backlit", NULL, NULL},
    {NEPH_NIGHT_SPEED, "grid_cloud_single", NULL, NULL},
    {NEPH_NIGHT_SPEED, "fence_backlit", NULL, NULL},
};

const char *neph_night_suite_name(enum neph_night_suite suite)
{
    return suite_names[suite];
}

bool neph_night_is_named(const char *step, const char *text)
{
    static const char now[] = "stress";
    const size_t length = strlen(now);
    const char *stored = suite_names[NEPH_NIGHT_STRESS];
    if (strncmp(text, now, length) != 0 || (text[length] && text[length] != ' '))
        return strstr(step, text) != NULL;
    return strncmp(step, stored, strlen(stored)) == 0 && strstr(step, &text[length]);
}

void neph_night_step_log(const struct neph_night_step *step, char name[NEPH_STEP_LOG_SIZE])
{
    size_t i = 0;
    for (; step->name[i] && i < NEPH_STEP_LOG_SIZE - 1; i++)
        name[i] = isalnum((unsigned char)step->name[i]) ? step->name[i] : '_';
    name[i] = '\0';
}

/* ---- steps ----------------------------------------------------------------------------------- */

struct plan_builder {
    const struct neph_night_plan_params *params;
    struct neph_arena *arena;
    struct neph_night_plan *plan;
    bool full;
    bool too_many_words, too_many_steps; /* an error of the caller: nothing is left out silently */
};

static bool is_wanted(const struct plan_builder *plan_builder, const char *name)
{
    if (neph_night_plan_find(plan_builder->plan, name))
        return false;
    for (int i = 0; i < plan_builder->params->only_count; i++)
        if (neph_night_is_named(name, plan_builder->params->only[i]))
            return true;
    return plan_builder->params->only_count == 0;
}

/* NULL adds nothing. */
static void add_word(struct plan_builder *plan_builder, struct neph_night_step *step,
                     const char *word)
{
    int count = 0;
    while (step->words[count])
        count++;
    if (word && count < NEPH_STEP_WORDS - 1)
        step->words[count] = word;
    else
        plan_builder->too_many_words = plan_builder->too_many_words || word;
}

/* Adds the words of a text, separated by blanks. */
static void add_words(struct plan_builder *plan_builder, struct neph_night_step *step,
                      const char *words)
{
    for (size_t length; *words; words += length + strspn(words + length, " ")) {
        length = strcspn(words, " ");
        add_word(plan_builder, step,
                 neph_arena_format(plan_builder->arena, "%.*s", (int)length, words));
    }
}

static void add_settings(struct plan_builder *plan_builder, struct neph_night_step *step)
{
    const struct neph_night_plan_params *params = plan_builder->params;
    if (step->suite != NEPH_NIGHT_CATALOG)
        return;
    if (params->seed > 1)
        add_words(plan_builder, step,
                  neph_arena_format(plan_builder->arena, "--seed %d", params->seed));
    int known;
    const struct neph_engine *const *engines = neph_engines(&known);
    for (int i = 0; i < known && !params->only_engines; i++)
        if (engines[i]->first) /* further Blender versions */
            add_words(plan_builder, step,
                      neph_arena_format(plan_builder->arena, "-e %s", engines[i]->name));
    for (int i = 0; i < params->engine_count; i++) {
        add_word(plan_builder, step, "-e");
        add_word(plan_builder, step, params->engines[i]);
    }
    for (int i = 0; i < params->setting_count; i++) {
        add_word(plan_builder, step, "-s");
        add_word(plan_builder, step, params->settings[i]);
    }
}

/* `words` as in struct listed; NULL: the suite's words. */
static void add_step(struct plan_builder *plan_builder, enum neph_night_suite suite, const char *of,
                     const char *words)
{
    const char *name = neph_arena_format(plan_builder->arena, "%s %s", suite_names[suite], of);
    const char *size = suites[suite].size;
    const bool only_engines = plan_builder->params->only_engines;
    if (!is_wanted(plan_builder, name) || (only_engines && suite != NEPH_NIGHT_CATALOG))
        return;
    plan_builder->too_many_steps = plan_builder->too_many_steps ||
                                   plan_builder->plan->count == STEPS_MAX;
    if (plan_builder->too_many_steps)
        return;
    if (size && plan_builder->params->width_px > 0)
        size = neph_arena_format(plan_builder->arena, "%dx%d", plan_builder->params->width_px,
                                 plan_builder->params->height_px);
    struct neph_night_step *step = &plan_builder->plan->steps[plan_builder->plan->count++];
    *step = (struct neph_night_step){
        .suite = suite,
        .name = name,
        .scene = suite == NEPH_NIGHT_PHYSICS ? NULL : neph_arena_copy_text(plan_builder->arena, of),
        .guess_s = suites[suite].guess_s,
        .guess_series = suites[suite].guess_series};
    add_words(plan_builder, step, suites[suite].before);
    add_word(plan_builder, step, neph_arena_copy_text(plan_builder->arena, of));
    add_word(plan_builder, step, size ? "--size" : NULL);
    add_word(plan_builder, step, size);
    add_words(plan_builder, step,
              only_engines ? only_engine_words
              : words      ? words
                           : suites[suite].after);
    add_settings(plan_builder, step);
}

static enum neph_status add_scenes(struct plan_builder *plan_builder, enum neph_data_scenes which,
                                   enum neph_night_suite suite, struct neph_diag *diag)
{
    char **names = NULL;
    int count = 0;
    const enum neph_status status = neph_data_list_scenes(which, &names, &count, diag);
    if (status)
        return status;
    for (int i = 0; i < count; i++)
        add_step(plan_builder, suite, names[i], NULL);
    neph_data_free_names(names);
    return NEPH_OK;
}

static void add_checks(struct plan_builder *plan_builder)
{
    for (int i = 0; i < neph_check_count(); i++) {
        struct neph_check check;
        neph_check_get(i, &check);
        add_step(plan_builder, NEPH_NIGHT_PHYSICS, check.name, NULL);
    }
}

static const char *format_listed_words(const struct plan_builder *plan_builder,
                                       const struct listed *step)
{
    const struct neph_preset *preset;
    const char *words = "";
    if (!step->variant)
        return step->words;
    for (int i = 0; (preset = neph_preset_find_by_use(neph_rt_presets, NEPH_RT_STRESS_QUICK, i));
         i++)
        words = neph_arena_format(plan_builder->arena, "%s--preset %s ", words, preset->name);
    return neph_arena_format(plan_builder->arena, "%s--preset %s", words, step->variant);
}

static void add_listed(struct plan_builder *plan_builder, const struct listed *steps, size_t count)
{
    for (size_t i = 0; i < count; i++)
        add_step(plan_builder, steps[i].suite, steps[i].name,
                 format_listed_words(plan_builder, &steps[i]));
}

static enum neph_status add_steps(struct plan_builder *plan_builder, struct neph_diag *diag)
{
    add_listed(plan_builder, quick_steps, sizeof(quick_steps) / sizeof(quick_steps[0]));
    if (!plan_builder->full)
        return NEPH_OK;
    add_listed(plan_builder, full_steps, sizeof(full_steps) / sizeof(full_steps[0]));
    enum neph_status status = add_scenes(plan_builder, NEPH_DATA_CATALOG, NEPH_NIGHT_CATALOG, diag);
    if (!status)
        status = add_scenes(plan_builder, NEPH_DATA_STRESS, NEPH_NIGHT_STRESS, diag);
    if (!status)
        add_checks(plan_builder);
    return status;
}

/* The concatenated command lines of all steps: a different word makes a different plan. */
static const char *format_plan_identity(struct neph_arena *arena, const char *tier,
                                        const struct neph_night_plan *plan)
{
    const char *text = neph_arena_copy_text(arena, tier);
    for (int i = 0; i < plan->count; i++)
        for (int w = 0; plan->steps[i].words[w]; w++)
            text = neph_arena_format(arena, "%s%s%s", text, w ? " " : "; ",
                                     plan->steps[i].words[w]);
    return text;
}

enum neph_status neph_night_plan_make(const struct neph_night_plan_params *params,
                                      struct neph_arena *arena, struct neph_night_plan *plan,
                                      struct neph_diag *diag)
{
    *plan = (struct neph_night_plan){
        .steps = neph_arena_allocate(arena, STEPS_MAX, sizeof(*plan->steps))};
    struct plan_builder plan_builder = {params, arena, plan, strcmp(params->tier, "full") == 0,
                                        false,  false};
    if (!plan->steps)
        return neph_fail_memory(diag);
    if (!plan_builder.full && strcmp(params->tier, "quick") != 0)
        return neph_fail(diag, NEPH_ERR_USAGE, "there is no tier '%s': quick or full",
                         params->tier);
    enum neph_status status = add_steps(&plan_builder, diag);
    if (!status && plan->count == 0) {
        status = neph_fail(diag, NEPH_ERR_USAGE, "no step of tier %s has --only in its name",
                           params->tier);
        neph_hint(diag, "`neph nightly --list` lists them");
    }
    if (!status && plan_builder.too_many_words)
        status = neph_fail(diag, NEPH_ERR_USAGE,
                           "with so many settings a step has more than %d words",
                           NEPH_STEP_WORDS - 1);
    if (!status && plan_builder.too_many_steps)
        status = neph_fail(diag, NEPH_ERR_USAGE, "tier %s has more than %d steps", params->tier,
                           STEPS_MAX);
    plan->identity = format_plan_identity(arena, params->tier, plan);
    return status ? status : neph_arena_check(arena, diag);
}

const struct neph_night_step *neph_night_plan_find(const struct neph_night_plan *plan,
                                                   const char *name)
{
    for (int i = 0; i < plan->count; i++)
        if (strcmp(plan->steps[i].name, name) == 0)
            return &plan->steps[i];
    return NULL;
}

/* ---- order ----------------------------------------------------------------------------------- */

double neph_night_step_cost(const struct neph_night_step *step,
                            const struct neph_step_history *history)
{
    return isfinite(history->cost_s) ? history->cost_s : step->guess_s;
}

static double estimate_value_per_second(const struct neph_night_step *step,
                                        const struct neph_step_history *history)
{
    const int series = history->series > 0 ? history->series : step->guess_series;
    const double least_s = 0.1; /* shorter durations are dominated by noise */
    return (double)series * history->nights / fmax(neph_night_step_cost(step, history), least_s);
}

int neph_night_plan_next(const struct neph_night_plan *plan,
                         const struct neph_step_history *history, const bool *done, double left_s,
                         bool first)
{
    int best = -1;
    for (int i = 0; i < plan->count; i++) {
        const bool fits = first || neph_night_step_cost(&plan->steps[i], &history[i]) <= left_s;
        if (done[i] || !fits)
            continue;
        if (best < 0 || estimate_value_per_second(&plan->steps[i], &history[i]) >
                            estimate_value_per_second(&plan->steps[best], &history[best]))
            best = i;
    }
    return best;
}
