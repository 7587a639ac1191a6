/* SPDX-License-Identifier: MIT
 *
 * Ablations: planning the configurations, effects over scenes, verdicts and advice.
 */
#include "harness/study/ablation.h"

#include "base/files.h"
#include "harness/study/flicker_pairs.h"
#include "metrics/series.h"
#include "metrics/significance.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Fails to compile when a kind is added, as the tables and verdicts of this file need it. */
_Static_assert(NEPH_INTERVAL_KIND_COUNT == 5, "a new kind");
_Static_assert(NEPH_ABLATION_ADVICES == 7, "a new kind");
_Static_assert(NEPH_ABLATION_VERDICTS == 8, "a new kind");

const struct neph_ablation_measure neph_ablation_measures[] = {
    {"error", "error", "relative RMSE", "rel_rmse", .mask = "all"},
    {"flicker", "flicker", "flicker seen", "seen_contrast", .mask = "all"},
    {"edge_flicker", "at edges", "flicker seen at depth edges", "seen_contrast",
     .mask = "depth_edge"},
    {"four_frame", "four-frame", "four-frame flicker at depth edges", "a4_p95",
     .mask = "depth_edge"},
    {"half_life", "half-life", "half-life after a step of the sun", "half_life_p50", .mask = "all"},
    {"evaluations", "evaluations", "density evaluations per pixel",
     .cost = offsetof(struct neph_study_cost, density_evaluations)},
    {"traffic", "bytes", "bytes that passes read and write per pixel",
     .cost = offsetof(struct neph_study_cost, traffic_bytes)},
    {"gpu_ms", "ms", "milliseconds of the device", .cost = offsetof(struct neph_study_cost, gpu_ms),
     .is_time = true},
    {.name = NULL},
};
_Static_assert(sizeof(neph_ablation_measures) / sizeof(neph_ablation_measures[0]) <=
                   (size_t)NEPH_ABLATION_MEASURES_MAX + 1,
               "measures");

const char *const neph_ablation_verdict_words[NEPH_ABLATION_VERDICTS] = {
    [NEPH_ABLATION_NO_NUMBER] = "no number", [NEPH_ABLATION_SAME] = "same",
    [NEPH_ABLATION_NOTHING] = "nothing",     [NEPH_ABLATION_BUYS] = "buys",
    [NEPH_ABLATION_MAY_BUY] = "may buy",     [NEPH_ABLATION_COSTS] = "costs",
    [NEPH_ABLATION_MAY_COST] = "may cost",   [NEPH_ABLATION_UNDECIDED] = "undecided",
};

const char *const neph_ablation_advice_words[NEPH_ABLATION_ADVICES] = {
    [NEPH_ABLATION_KEEP] = "keep",
    [NEPH_ABLATION_PERHAPS] = "perhaps",
    [NEPH_ABLATION_UNCERTAIN] = "untold",
    [NEPH_ABLATION_LEAVE_OUT] = "leave out",
    [NEPH_ABLATION_LITTLE] = "little",
    [NEPH_ABLATION_IDLE] = "idle",
    [NEPH_ABLATION_UNMEASURED] = "not measured",
};

_Static_assert(2 * NEPH_ABLATION_PARTS_MAX + 2 <= (int)NEPH_STUDY_PRESETS_MAX, "configurations");

static const double family_alpha = 0.05;

int neph_ablation_measure_count(void)
{
    int count = 0;
    while (neph_ablation_measures[count].name)
        count++;
    return count;
}

/* ---- the plan -------------------------------------------------------------------------------- */

/* Adds a configuration unless it exists; returns its index. `label` is in the arena or constant. */
static int add_configuration(struct neph_ablation *ablation, neph_ablation_set without,
                             const char *label)
{
    const int count = ablation->configuration_count;
    for (int i = 0; i < count; i++)
        if (ablation->without[i] == without)
            return i;
    ablation->without[count] = without;
    ablation->words[count] = neph_ablation_words(&ablation->arena, ablation->preset, without);
    ablation->labels[count] = label;
    return ablation->configuration_count++;
}

static void add_comparison(struct neph_ablation *ablation, int part, enum neph_ablation_place place,
                           neph_ablation_set with, neph_ablation_set without)
{
    struct neph_arena *arena = &ablation->arena;
    const char *name = part < 0 ? "all" : neph_ablation_parts[part].name;
    const int first = add_configuration(ablation, with, neph_arena_format(arena, "%s alone", name));
    const char *label = place == NEPH_ABLATION_ALONE
                            ? neph_arena_format(arena, "what %s needs", name)
                            : neph_arena_format(arena, "without %s", name);
    ablation->comparisons[ablation->comparison_count++] = (struct neph_ablation_comparison){
        .part = part,
        .place = place,
        .with = first,
        .without = add_configuration(ablation, without, label)};
}

/* The parts of the preset that the plain pipeline does not have. */
static neph_ablation_set parts_missing_in_plain(const struct neph_ablation *ablation)
{
    neph_ablation_set set = ablation->parts;
    for (int i = 0; neph_ablation_parts[i].name; i++)
        if (neph_ablation_parts[i].stays)
            set &= ~((neph_ablation_set)1 << i);
    return set;
}

static void plan_part(struct neph_ablation *ablation, int part)
{
    const neph_ablation_set own = (neph_ablation_set)1 << part;
    const neph_ablation_set plain = parts_missing_in_plain(ablation);
    const neph_ablation_set needed = neph_ablation_with_needs(part) & ~own;
    add_comparison(ablation, part, NEPH_ABLATION_IN_PRESET, 0, own);
    if (!neph_ablation_parts[part].stays)
        add_comparison(ablation, part, NEPH_ABLATION_ALONE, plain & ~needed & ~own,
                       plain & ~needed);
}

static enum neph_status refuse_part(struct neph_ablation *ablation, const char *name,
                                    struct neph_diag *diag)
{
    const char *names = neph_ablation_parts[0].name;
    for (int i = 1; neph_ablation_parts[i].name; i++)
        names = neph_arena_format(&ablation->arena, "%s, %s", names, neph_ablation_parts[i].name);
    neph_fail(diag, NEPH_ERR_USAGE, "there is no part '%s'", name);
    neph_hint(diag, "parts are %s", names);
    return NEPH_ERR_USAGE;
}

static enum neph_status refuse_absent(const struct neph_ablation *ablation, int part,
                                      struct neph_diag *diag)
{
    const struct neph_ablation_part *of = &neph_ablation_parts[part];
    neph_fail(diag, NEPH_ERR_USAGE, "preset %s does not have '%s': %s", ablation->preset, of->name,
              ablation->values[part]);
    neph_hint(diag, "list its parts with `neph ablate --list --preset %s`%s%s", ablation->preset,
              of->needs ? "; this part needs " : "", of->needs ? of->needs : "");
    return NEPH_ERR_USAGE;
}

static enum neph_status choose_parts(struct neph_ablation *ablation, const char *const *only,
                                     int only_count, struct neph_diag *diag)
{
    ablation->asked = only_count > 0 ? 0 : ablation->parts;
    for (int i = 0; i < only_count; i++) {
        const int part = neph_ablation_part_find(only[i]);
        if (part < 0)
            return refuse_part(ablation, only[i], diag);
        if ((ablation->parts >> part & 1) == 0)
            return refuse_absent(ablation, part, diag);
        ablation->asked |= (neph_ablation_set)1 << part;
    }
    return NEPH_OK;
}

enum neph_status neph_ablation_plan(const char *preset, const char *const *only, int only_count,
                                    struct neph_ablation *ablation, struct neph_diag *diag)
{
    ablation->preset = preset;
    enum neph_status status = neph_ablation_find_parts(preset, &ablation->parts, diag);
    for (int i = 0; neph_ablation_parts[i].name && !status; i++)
        status = neph_ablation_part_values(&ablation->arena, preset, i, &ablation->values[i], diag);
    if (!status)
        status = choose_parts(ablation, only, only_count, diag);
    if (status)
        return status;
    add_configuration(ablation, 0, preset);
    add_configuration(ablation, parts_missing_in_plain(ablation), "plain");
    add_comparison(ablation, -1, NEPH_ABLATION_IN_PRESET, 0, parts_missing_in_plain(ablation));
    for (int i = 0; neph_ablation_parts[i].name; i++)
        if (ablation->asked >> i & 1)
            plan_part(ablation, i);
    return neph_arena_check(&ablation->arena, diag);
}

/* ---- one comparison -------------------------------------------------------------------------- */

static double difference(const struct neph_ablation *ablation,
                         const struct neph_ablation_comparison *of, int measure, int scene)
{
    const struct neph_ablation_measure *what = &neph_ablation_measures[measure];
    if (what->metric)
        return neph_study_difference(&ablation->study,
                                     neph_study_metric_find(what->metric, what->mask), 0, of->with,
                                     of->without, scene);
    return neph_study_cost_decades(&ablation->study, what->cost, scene, of->with) -
           neph_study_cost_decades(&ablation->study, what->cost, scene, of->without);
}

static void count_scene(struct neph_ablation_effect *effect, int scene)
{
    const double change = effect->scenes[scene];
    const int best = effect->best_scene, worst = effect->worst_scene;
    effect->scene_count++;
    effect->better += change < 0.0;
    effect->worse += change > 0.0;
    effect->alike += change == 0.0;
    if (change < (best < 0 ? 0.0 : effect->scenes[best]))
        effect->best_scene = scene;
    if (change > (worst < 0 ? 0.0 : effect->scenes[worst]))
        effect->worst_scene = scene;
}

static struct neph_ablation_effect summarise(const double *changes, int count, double *room)
{
    struct neph_ablation_effect effect = {.scenes = changes,
                                          .mean = NAN,
                                          .p = 1.0,
                                          .p_holm = 1.0,
                                          .best_scene = -1,
                                          .worst_scene = -1};
    for (int scene = 0; scene < count; scene++)
        if (!isnan(changes[scene])) {
            room[effect.scene_count] = changes[scene];
            count_scene(&effect, scene);
        }
    const struct neph_mean mean = neph_series_mean(room, effect.scene_count, NEPH_REPLICATE_RUNS);
    if (!mean.defined)
        return effect;
    effect.mean = mean.value;
    effect.has_interval = mean.interval != NEPH_INTERVAL_NONE;
    effect.low = mean.low;
    effect.high = mean.high;
    if (effect.has_interval && mean.value != 0.0)
        effect.p = mean.standard_error == 0.0
                       ? 0.0 /* the same change in all scenes */
                       : neph_student_p(mean.value / mean.standard_error, mean.n - 1);
    return effect;
}

static enum neph_ablation_verdict judge_effect(const struct neph_ablation_effect *effect)
{
    if (effect->scene_count == 0)
        return NEPH_ABLATION_NO_NUMBER;
    if (effect->alike == effect->scene_count)
        return NEPH_ABLATION_SAME;
    if (!effect->has_interval)
        return NEPH_ABLATION_UNDECIDED;
    if (effect->low > -NEPH_ABLATION_NOTHING_DECADES &&
        effect->high < NEPH_ABLATION_NOTHING_DECADES)
        return NEPH_ABLATION_NOTHING;
    const bool is_certain = effect->p_holm < family_alpha;
    if (effect->high < 0.0)
        return is_certain ? NEPH_ABLATION_BUYS : NEPH_ABLATION_MAY_BUY;
    if (effect->low > 0.0)
        return is_certain ? NEPH_ABLATION_COSTS : NEPH_ABLATION_MAY_COST;
    return NEPH_ABLATION_UNDECIDED;
}

enum neph_ablation_advice neph_ablation_advise(const struct neph_ablation_comparison *in_preset)
{
    int counts[NEPH_ABLATION_VERDICTS] = {0};
    for (int m = 0; neph_ablation_measures[m].name; m++)
        if (!neph_ablation_measures[m].is_time)
            counts[in_preset->effects[m].verdict]++;
    if (counts[NEPH_ABLATION_BUYS] > 0)
        return NEPH_ABLATION_KEEP;
    if (counts[NEPH_ABLATION_MAY_BUY] > 0)
        return NEPH_ABLATION_PERHAPS;
    if (counts[NEPH_ABLATION_UNDECIDED] > 0)
        return NEPH_ABLATION_UNCERTAIN;
    if (counts[NEPH_ABLATION_COSTS] + counts[NEPH_ABLATION_MAY_COST] > 0)
        return NEPH_ABLATION_LEAVE_OUT;
    if (counts[NEPH_ABLATION_NOTHING] > 0)
        return NEPH_ABLATION_LITTLE;
    return counts[NEPH_ABLATION_SAME] > 0 ? NEPH_ABLATION_IDLE : NEPH_ABLATION_UNMEASURED;
}

/* ---- all comparisons ------------------------------------------------------------------------- */

/* Holm's family: numbers with an interval, except those equal in all scenes and those of a clock. A
 * number that cannot be wrong by chance must not weaken the others. */
static bool in_holm_family(const struct neph_ablation_effect *effect, int measure)
{
    return effect->has_interval && effect->alike < effect->scene_count &&
           !neph_ablation_measures[measure].is_time;
}

/* Computes Holm's adjusted p over the family. */
static void adjust(struct neph_ablation *ablation)
{
    enum { MOST = (2 * NEPH_ABLATION_PARTS_MAX + 1) * NEPH_ABLATION_MEASURES_MAX };
    struct neph_ablation_effect *family[MOST];
    double p[MOST], adjusted[MOST];
    int count = 0;
    for (int c = 0; c < ablation->comparison_count; c++)
        for (int m = 0; neph_ablation_measures[m].name; m++) {
            struct neph_ablation_effect *effect = &ablation->comparisons[c].effects[m];
            if (!in_holm_family(effect, m))
                continue;
            p[count] = effect->p;
            family[count++] = effect;
        }
    neph_holm(p, count, adjusted);
    for (int i = 0; i < count; i++)
        family[i]->p_holm = adjusted[i];
    ablation->judged_count = count;
}

bool neph_ablation_has_measure(const struct neph_ablation *ablation, int measure)
{
    const struct neph_ablation_measure *what = &neph_ablation_measures[measure];
    return ablation->study.params
        ->takes[what->metric
                    ? neph_study_metrics[neph_study_metric_find(what->metric, what->mask)].take
                    : NEPH_STUDY_FLICKER];
}

static void measure_comparison(struct neph_ablation *ablation,
                               struct neph_ablation_comparison *comparison, double *changes,
                               double *room)
{
    const int scene_count = ablation->study.params->scene_count;
    for (int m = 0; neph_ablation_measures[m].name; m++, changes += scene_count) {
        for (int scene = 0; scene < scene_count; scene++)
            changes[scene] = difference(ablation, comparison, m, scene);
        comparison->effects[m] = summarise(changes, scene_count, room);
    }
}

/* Fails unless at least one scene could be rendered. */
static enum neph_status check_scenes(const struct neph_ablation *ablation, struct neph_diag *diag)
{
    const struct neph_study_scene *scenes = ablation->study.scenes;
    for (int i = 0; i < ablation->study.params->scene_count; i++)
        if (!scenes[i].left_out)
            return NEPH_OK;
    neph_fail(diag, NEPH_ERR_UNSUPPORTED, "%s: %s", scenes[0].name, scenes[0].left_out);
    neph_hint(diag, "no scene is left to measure; change the preset with --preset %s+KEY=VALUE",
              ablation->preset);
    return NEPH_ERR_UNSUPPORTED;
}

enum neph_status neph_ablation_judge(struct neph_ablation *ablation, struct neph_diag *diag)
{
    const size_t scene_count = (size_t)ablation->study.params->scene_count;
    const size_t size = scene_count * (size_t)neph_ablation_measure_count();
    const size_t count = (size_t)ablation->comparison_count;
    const enum neph_status status = check_scenes(ablation, diag);
    if (status)
        return status;
    double *changes = neph_arena_allocate(&ablation->arena, count * size + scene_count,
                                          sizeof(*changes));
    if (!changes)
        return neph_fail_memory(diag);
    for (size_t c = 0; c < count; c++)
        measure_comparison(ablation, &ablation->comparisons[c], changes + c * size,
                           changes + count * size);
    adjust(ablation);
    for (size_t c = 0; c < count; c++)
        for (int m = 0; neph_ablation_measures[m].name; m++)
            ablation->comparisons[c].effects[m].verdict = judge_effect(
                &ablation->comparisons[c].effects[m]);
    return NEPH_OK;
}

const struct neph_ablation_comparison *neph_ablation_find(const struct neph_ablation *ablation,
                                                          int part, enum neph_ablation_place place)
{
    for (int i = 0; i < ablation->comparison_count; i++)
        if (ablation->comparisons[i].part == part && ablation->comparisons[i].place == place)
            return &ablation->comparisons[i];
    return NULL;
}

void neph_ablation_change(double decades, char text[NEPH_ABLATION_CHANGE_SIZE])
{
    const double ratio = pow(10.0, decades), percent = 100.0 * (ratio - 1.0);
    if (decades == 0.0)
        snprintf(text, NEPH_ABLATION_CHANGE_SIZE, "0 %%");
    else if (ratio > 100.0 || ratio < 0.01) /* one side is close to 0 */
        snprintf(text, NEPH_ABLATION_CHANGE_SIZE, ratio > 1.0 ? ">x100" : "<-99 %%");
    else if (ratio >= 2.95)
        snprintf(text, NEPH_ABLATION_CHANGE_SIZE, "x%.2g", ratio);
    else
        snprintf(text, NEPH_ABLATION_CHANGE_SIZE, fabs(percent) < 9.95 ? "%+.1f %%" : "%+.0f %%",
                 percent);
}

void neph_ablation_finish(struct neph_ablation *ablation)
{
    neph_flicker_study_finish(&ablation->study);
    neph_arena_finish(&ablation->arena);
    *ablation = (struct neph_ablation){.preset = NULL};
}
