/* SPDX-License-Identifier: MIT */
#include "harness/study/attribution_study.h"

#include "metrics/series.h"

#include <math.h>
#include <stdlib.h>

/* Fails to compile when a kind is added, as fill_row() needs it. */
_Static_assert(NEPH_INTERVAL_KIND_COUNT == 5, "a new kind");

/* ---- one scene ------------------------------------------------------------------------------- */

static const struct neph_study_cell *find_cell(const struct neph_attribution_plan *plan,
                                               const struct neph_flicker_study *study, int scene,
                                               int seed, neph_part_set state)
{
    return neph_study_cell_at(study, scene, neph_attribution_find_sequence(plan, state), seed,
                              neph_study_find_headline());
}

double neph_attribution_seen(const struct neph_attribution_plan *plan,
                             const struct neph_flicker_study *study, int scene, int seed,
                             neph_part_set state)
{
    const struct neph_study_cell *cell = find_cell(plan, study, scene, seed, state);
    if (!cell->counts)
        return NAN;
    const enum neph_ideal_kind against = neph_attribution_find_reference(state);
    return against == NEPH_IDEALS ? cell->value : state ? cell->ideals[against] : 0.0;
}

/* The reason why a scene has no values; NULL: it has. */
static const char *find_obstacle(const struct neph_attribution_plan *plan,
                                 const struct neph_flicker_study *study, int scene)
{
    if (study->scenes[scene].left_out)
        return study->scenes[scene].left_out;
    for (int seed = 0; seed < study->params->seed_count; seed++)
        for (neph_part_set state = 0; state < NEPH_PART_SETS; state++)
            if (neph_part_set_is_state(state) &&
                isnan(neph_attribution_seen(plan, study, scene, seed, state)))
                return find_cell(plan, study, scene, seed, state)->because;
    return NULL;
}

static void attribute_scene(const struct neph_attribution_plan *plan,
                            const struct neph_flicker_study *study, int index,
                            struct neph_attribution_scene *scene)
{
    double values[NEPH_PART_SETS] = {0.0};
    const int seed_count = study->params->seed_count;
    scene->why = find_obstacle(plan, study, index);
    for (neph_part_set state = 0; state < NEPH_PART_SETS && !scene->why; state++)
        for (int seed = 0; seed < seed_count && neph_part_set_is_state(state); seed++)
            values[state] += pow(neph_attribution_seen(plan, study, index, seed, state), 2.0) /
                             seed_count;
    if (!scene->why && values[NEPH_PARTS_ALL] == 0.0)
        scene->why = "no flicker is seen";
    scene->values = neph_attribution_divide(values);
    for (int seed = 0; seed < seed_count; seed++)
        scene->blur_px += neph_study_cost_at(study, index, 0, seed)->blur_px / seed_count;
}

double neph_attribution_percent(const struct neph_attribution_scene *scene, int row)
{
    const struct neph_attribution_values *values = &scene->values;
    const double part = row == NEPH_ATTRIBUTION_INTERACTION ? values->interaction
                                                            : values->parts[row].share;
    return 100.0 * part / values->all;
}

/* ---- over the scenes ------------------------------------------------------------------------- */

/* The scene with the most of a part, or the largest interaction, in squared thresholds. */
static int find_worst_scene(const struct neph_attribution_study *attribution, int row)
{
    double most = 0.0;
    int worst = -1;
    for (int i = 0; i < attribution->study->params->scene_count; i++) {
        const struct neph_attribution_scene *scene = &attribution->scenes[i];
        const double share = row == NEPH_ATTRIBUTION_INTERACTION ? fabs(scene->values.interaction)
                                                                 : scene->values.parts[row].share;
        if (scene->why || share <= most)
            continue;
        most = share;
        worst = i;
    }
    return worst;
}

/* `values` has room for all scenes. */
static void fill_row(struct neph_attribution_study *attribution, int row, double *values)
{
    int count = 0;
    double falls = 0.0;
    for (int i = 0; i < attribution->study->params->scene_count; i++) {
        const struct neph_attribution_scene *scene = &attribution->scenes[i];
        if (scene->why)
            continue;
        values[count++] = neph_attribution_percent(scene, row);
        if (row < NEPH_PARTS)
            falls += 100.0 * (1.0 - sqrt(scene->values.parts[row].without / scene->values.all));
    }
    const struct neph_mean mean = neph_series_mean(values, count, NEPH_REPLICATE_RUNS);
    attribution->rows[row] = (struct neph_attribution_row){
        .percent = mean.defined ? mean.value : NAN,
        .has_interval = mean.interval != NEPH_INTERVAL_NONE,
        .low = mean.low,
        .high = mean.high,
        .worst_scene = find_worst_scene(attribution, row),
        .falls = row < NEPH_PARTS && count > 0 ? falls / count : NAN};
}

static void sort_parts(struct neph_attribution_study *attribution)
{
    int *order = attribution->order;
    for (int part = 0; part < NEPH_PARTS; part++) {
        int place = part; /* insertion sort: equal parts keep their order */
        for (; place > 0 &&
               attribution->rows[order[place - 1]].percent < attribution->rows[part].percent;
             place--)
            order[place] = order[place - 1];
        order[place] = part;
    }
}

enum neph_status neph_attribution_judge(const struct neph_attribution_plan *plan,
                                        const struct neph_flicker_study *study,
                                        struct neph_arena *arena,
                                        struct neph_attribution_study *attribution,
                                        struct neph_diag *diag)
{
    const int scene_count = study->params->scene_count;
    double *values = calloc((size_t)scene_count, sizeof(*values));
    int left_out_count = 0;
    *attribution = (struct neph_attribution_study){.plan = plan, .study = study};
    attribution->scenes = neph_arena_allocate(arena, (size_t)scene_count,
                                              sizeof(*attribution->scenes));
    const enum neph_status status = values ? neph_arena_check(arena, diag) : neph_fail_memory(diag);
    for (int i = 0; i < scene_count && !status; i++) {
        struct neph_attribution_scene *scene = &attribution->scenes[i];
        attribute_scene(plan, study, i, scene);
        left_out_count += study->scenes[i].left_out != NULL;
        attribution->scene_count += !scene->why;
        attribution->explained_count += !scene->why && neph_attribution_explains(&scene->values);
    }
    for (int row = 0; row <= NEPH_PARTS && !status; row++)
        fill_row(attribution, row, values);
    if (!status)
        sort_parts(attribution);
    free(values);
    if (!status && left_out_count == scene_count)
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "%s: %s", study->scenes[0].name,
                         study->scenes[0].left_out);
    return status;
}
