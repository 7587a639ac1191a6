/* SPDX-License-Identifier: MIT
 *
 * The output of an attribution: answer, tables, JSON.
 */
#include "harness/experiments/attribution.h"

#include "harness/document/table.h"

#include <math.h>
#include <stdio.h>

static const char *row_name(int row)
{
    return row == NEPH_ATTRIBUTION_INTERACTION ? "interaction" : neph_attribution_parts[row].name;
}

static const char *plural(int count)
{
    return count == 1 ? "" : "s";
}

/* ---- the answer ------------------------------------------------------------------------------ */

/* "61 % (40 to 82)" */
static const char *percent_text(const struct neph_attribution_row *row, struct neph_arena *arena)
{
    char interval[NEPH_ANSWER_INTERVAL_SIZE] = "";
    if (row->has_interval)
        neph_answer_interval(row->low, row->high, interval);
    return neph_arena_format(arena, "%.3g %%%s", row->percent, interval);
}

/* "rays: most in lattice_mast, 74 % of 7.0 thresholds; with ideal rays 3.9" */
static void answer_part(const struct neph_attribution_study *attribution, int part,
                        struct neph_answer *answer)
{
    const struct neph_attribution_row *row = &attribution->rows[part];
    const char *name = neph_attribution_parts[part].name;
    if (row->worst_scene < 0)
        return;
    const struct neph_attribution_scene *scene = &attribution->scenes[row->worst_scene];
    neph_answer_add(answer,
                    "%s: most in %s, %.3g %% of the square of %.3g thresholds; with ideal %s %.3g",
                    name, attribution->study->scenes[row->worst_scene].name,
                    neph_attribution_percent(scene, part), sqrt(scene->values.all), name,
                    sqrt(scene->values.parts[part].without));
}

static void answer_interaction(const struct neph_attribution_study *attribution,
                               struct neph_answer *answer, struct neph_arena *arena)
{
    const struct neph_attribution_row *row = &attribution->rows[NEPH_ATTRIBUTION_INTERACTION];
    const char *most = "";
    if (row->worst_scene >= 0)
        most = neph_arena_format(arena, "; most in %s, %.3g %%",
                                 attribution->study->scenes[row->worst_scene].name,
                                 neph_attribution_percent(&attribution->scenes[row->worst_scene],
                                                          NEPH_ATTRIBUTION_INTERACTION));
    neph_answer_add(answer, "the parts explain %d of %d scenes within 15 %%; interaction %s%s",
                    attribution->explained_count, attribution->scene_count,
                    percent_text(row, arena), most);
}

static void answer(const struct neph_attribution_study *attribution, struct neph_answer *answer,
                   struct neph_arena *arena)
{
    const struct neph_flicker_study_params *params = attribution->study->params;
    const char *causes = "";
    if (attribution->scene_count == 0) {
        neph_answer_add(answer, "no scene has a flicker that can be divided (see --all)");
        return;
    }
    for (int i = 0; i < NEPH_ATTRIBUTION_WORST; i++) {
        const int part = attribution->order[i];
        causes = neph_arena_format(arena, "%s%s%s %s", causes, i ? ", " : "", row_name(part),
                                   percent_text(&attribution->rows[part], arena));
    }
    neph_answer_add(answer,
                    "the worst causes of the squared flicker of %s: %s (%d scene%s, %d seed%s, 95 "
                    "%% intervals)",
                    attribution->plan->preset, causes, attribution->scene_count,
                    plural(attribution->scene_count), params->seed_count,
                    plural(params->seed_count));
    for (int i = 0; i < NEPH_ATTRIBUTION_WORST; i++)
        answer_part(attribution, attribution->order[i], answer);
    answer_interaction(attribution, answer, arena);
    for (int i = 0; i < params->scene_count; i++)
        if (attribution->scenes[i].why)
            neph_answer_add(answer, "without a number: %s: %s", attribution->study->scenes[i].name,
                            attribution->scenes[i].why);
}

/* ---- tables ---------------------------------------------------------------------------------- */

static void begin_suite(struct neph_table *table)
{
    static const struct neph_column columns[] = {
        {.key = "part", .title = "part"},
        {.key = "percent", .title = "share [%]", .format = "%.3g"},
        {.key = "interval", .title = "interval", .format = "%g"},
        {.key = "worst_scene", .title = "most in"},
        {.key = "worst_percent", .title = "there [%]", .format = "%.3g"},
        {.key = "falls_percent", .title = "flicker falls by [%]", .format = "%.3g"},
    };
    neph_table_columns(table, columns, sizeof(columns) / sizeof(columns[0]));
}

/* A row for each part, the largest share first, and for the interaction. */
static void fill_suite(const struct neph_attribution_study *attribution, struct neph_table *table)
{
    begin_suite(table);
    for (int i = 0; i <= NEPH_PARTS; i++) {
        const int part = i < NEPH_PARTS ? attribution->order[i] : i;
        const struct neph_attribution_row *row = &attribution->rows[part];
        const bool has_scene = row->worst_scene >= 0;
        neph_table_word(table, row_name(part));
        neph_table_number(table, row->percent);
        neph_table_value(table,
                         row->has_interval ? json_pack("[f,f]", row->low, row->high) : json_null());
        neph_table_shown(table, row->has_interval ? "%.3g to %.3g" : "-", row->low, row->high);
        neph_table_word(table,
                        has_scene ? attribution->study->scenes[row->worst_scene].name : NULL);
        neph_table_number(table, has_scene ? neph_attribution_percent(
                                                 &attribution->scenes[row->worst_scene], part)
                                           : NAN);
        neph_table_number(table, row->falls);
    }
}

static void begin_scene(struct neph_table *table)
{
    static const struct neph_column columns[] = {
        {.key = "scene"},
        {.key = "part", .title = "part"},
        {.key = "share", .title = "share", .format = "%.3g"},
        {.key = "percent", .title = "share [%]", .format = "%.3g"},
        {.key = "alone", .title = "alone", .format = "%.3g"},
        {.key = "seen", .title = "seen", .format = "%.3g", .forms = NEPH_TABLE_DATA},
        {.key = "seen_if_ideal", .title = "seen if ideal", .format = "%.3g"},
        {.key = "gain", .title = "gain", .format = "%.3g"},
        {.key = "blur_px", .title = "blur [px]", .format = "%.3f", .forms = NEPH_TABLE_DATA},
    };
    neph_table_columns(table, columns, sizeof(columns) / sizeof(columns[0]));
}

/* A row for each part of a scene, and for the interaction. */
static void add_scene(const struct neph_attribution_study *attribution, int index,
                      struct neph_table *table)
{
    const struct neph_attribution_scene *scene = &attribution->scenes[index];
    const double seen = sqrt(scene->values.all);
    for (int row = 0; row <= NEPH_PARTS; row++) {
        const bool is_part = row < NEPH_PARTS;
        const struct neph_part_values part = is_part ? scene->values.parts[row]
                                                     : (struct neph_part_values){
                                                           NAN, scene->values.interaction, NAN};
        neph_table_word(table, attribution->study->scenes[index].name);
        neph_table_word(table, row_name(row));
        neph_table_numbers(table, 7,
                           (const double[]){part.share, neph_attribution_percent(scene, row),
                                            part.alone, seen, sqrt(part.without),
                                            seen - sqrt(part.without), scene->blur_px});
    }
}

static void print_scene(const struct neph_attribution_study *attribution, int index,
                        struct neph_publication *publication)
{
    const struct neph_attribution_scene *scene = &attribution->scenes[index];
    const char *name = attribution->study->scenes[index].name;
    struct neph_table table = {.cells = NULL};
    if (scene->why) {
        fprintf(publication->text, "\n**%s**: no number: %s.\n", name, scene->why);
        return;
    }
    fprintf(publication->text,
            "\n**%s**: %.3g thresholds, squared %.3g; blur %.2f px; interaction %.3g %%: the parts "
            "%s it within 15 %%.\n\n",
            name, sqrt(scene->values.all), scene->values.all, scene->blur_px,
            neph_attribution_percent(scene, NEPH_ATTRIBUTION_INTERACTION),
            neph_attribution_explains(&scene->values) ? "explain" : "do not explain");
    begin_scene(&table);
    add_scene(attribution, index, &table);
    neph_publication_table(publication, &table);
}

static void print_text(const struct neph_attribution_study *attribution,
                       struct neph_publication *publication)
{
    const struct neph_flicker_study *study = attribution->study;
    const struct neph_flicker_study_params *params = study->params;
    struct neph_table suite = {.cells = NULL};
    fprintf(publication->text,
            "neph %s, %s: preset %s, %dx%d, %d steps, %d frames, %d seed%s a scene.\n"
            "Flicker seen at %g Hz and %g pixels a degree; %d sequences for each scene and seed; "
            "shares are means over %d orders of the parts.\n\n**All scenes**\n\n",
            NEPH_VERSION, study->device, attribution->plan->preset, params->width_px,
            params->height_px, params->steps, params->frame_count, params->seed_count,
            plural(params->seed_count), neph_study_displays[0].frame_rate_hz,
            neph_study_displays[0].pixels_per_degree, attribution->plan->count,
            attribution->scenes[0].values.order_count);
    fill_suite(attribution, &suite);
    neph_publication_table(publication, &suite);
    fprintf(publication->text,
            "\nMean shares of the squared flicker of a scene, 95 %% intervals over scenes. The "
            "last column is the mean fall of the flicker with only this part ideal, rays with "
            "their children.\n"
            "Below, `share` and `alone` are in squared thresholds, `seen if ideal` and `gain` in "
            "thresholds.\n");
    for (int i = 0; i < params->scene_count; i++)
        print_scene(attribution, i, publication);
}

/* ---- documents ------------------------------------------------------------------------------- */

static json_t *parts_json(void)
{
    json_t *list = json_array();
    for (int i = 0; i < NEPH_PARTS; i++) {
        const struct neph_attribution_part *part = &neph_attribution_parts[i];
        neph_json_add(&list, json_pack("{s:s, s:s, s:s?, s:b}", "part", part->name, "what",
                                       part->what, "ideal", part->ideal, "needs_rays",
                                       neph_part_needs_rays((enum neph_attribution_part_id)i)));
    }
    return list;
}

static json_t *scenes_json(const struct neph_attribution_study *attribution)
{
    json_t *list = json_array();
    for (int i = 0; i < attribution->study->params->scene_count; i++) {
        const struct neph_attribution_scene *scene = &attribution->scenes[i];
        const struct neph_attribution_values *values = &scene->values;
        neph_json_add(
            &list,
            json_pack("{s:s, s:s?, s:o, s:o, s:o, s:o, s:o}", "scene",
                      attribution->study->scenes[i].name, "why", scene->why, "seen",
                      scene->why ? json_null() : neph_json_number(sqrt(values->all)), "squared",
                      scene->why ? json_null() : neph_json_number(values->all), "blur_px",
                      scene->why ? json_null() : neph_json_number(scene->blur_px), "interaction",
                      scene->why ? json_null() : neph_json_number(values->interaction), "explained",
                      scene->why ? json_null() : json_boolean(neph_attribution_explains(values))));
    }
    return list;
}

/* The flicker seen with each set of real parts. */
static json_t *values_json(const struct neph_attribution_study *attribution)
{
    const struct neph_flicker_study_params *params = attribution->study->params;
    json_t *list = json_array();
    for (int row = 0; row < params->scene_count * params->seed_count * NEPH_PART_SETS; row++) {
        const neph_part_set state = (neph_part_set)row % NEPH_PART_SETS;
        const int seed = row / NEPH_PART_SETS % params->seed_count,
                  scene = row / NEPH_PART_SETS / params->seed_count;
        json_t *real = json_array();
        for (int i = 0; i < NEPH_PARTS; i++)
            if ((state >> i & 1U) != 0)
                neph_json_add(&real, json_string(neph_attribution_parts[i].name));
        if (neph_part_set_is_state(state) && !attribution->scenes[scene].why)
            neph_json_add(&list,
                          json_pack("{s:s, s:i, s:o, s:f}", "scene",
                                    attribution->study->scenes[scene].name, "seed",
                                    params->seeds_before + seed + 1, "real", real, "seen",
                                    neph_attribution_seen(attribution->plan, attribution->study,
                                                          scene, seed, state)));
        else
            json_decref(real);
    }
    return list;
}

static json_t *sequences_json(const struct neph_attribution_study *attribution)
{
    json_t *list = json_array();
    for (int i = 0; i < attribution->plan->count; i++)
        neph_json_add(&list, json_pack("{s:s, s:s}", "words", attribution->plan->words[i],
                                       "settings", attribution->study->settings[i]));
    return list;
}

static json_t *attribution_json(const struct neph_attribution_study *attribution,
                                const struct neph_table *results)
{
    const struct neph_flicker_study *study = attribution->study;
    const struct neph_flicker_study_params *params = study->params;
    struct neph_table suite = {.cells = NULL};
    fill_suite(attribution, &suite);
    json_t *json = json_pack(
        "{s:s, s:s, s:s, s:s, s:[i,i], s:i, s:i, s:i, s:i, s:i, s:[s,s,s], s:o, s:o, s:o, s:o, "
        "s:o, s:o}",
        "format", "neph-attribution-1", "version", NEPH_VERSION, "device", study->device, "preset",
        attribution->plan->preset, "size_px", params->width_px, params->height_px, "steps",
        params->steps, "frames", params->frame_count, "seeds", params->seed_count, "orders",
        attribution->scenes[0].values.order_count, "broken", study->failed_count, "worst",
        row_name(attribution->order[0]), row_name(attribution->order[1]),
        row_name(attribution->order[2]), "parts", parts_json(), "suite", neph_table_json(&suite),
        "scenes", scenes_json(attribution), "results", neph_table_json(results), "values",
        values_json(attribution), "sequences", sequences_json(attribution));
    neph_table_finish(&suite);
    return json;
}

enum neph_status neph_attribution_publish(const struct neph_attribution_study *attribution,
                                          struct neph_publication *publication,
                                          struct neph_diag *diag)
{
    struct neph_table results = {.cells = NULL};
    enum neph_status status = NEPH_OK;
    begin_scene(&results);
    for (int i = 0; i < attribution->study->params->scene_count; i++)
        if (!attribution->scenes[i].why)
            add_scene(attribution, i, &results);
    if (publication->text)
        print_text(attribution, publication);
    if (publication->chart && attribution->scene_count > 0)
        neph_attribution_plot(attribution, publication->chart);
    answer(attribution, &publication->answer, &publication->arena);
    if (publication->places->json) {
        publication->json = attribution_json(attribution, &results);
        status = neph_json_check(publication->json, diag);
    }
    neph_publication_csv(publication, "\r\n", &results);
    publication->broken_count = attribution->study->failed_count;
    publication->broken_words = "sequences failed; their scenes have no number";
    return status;
}
