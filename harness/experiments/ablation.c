/* SPDX-License-Identifier: MIT
 *
 * `neph ablate [SCENE...]`: benefit and cost of each part of the real-time renderer.
 */
#include "harness/experiments/ablation.h"

#include "harness/document/table.h"
#include "harness/experiments/experiments.h"
#include "harness/experiments/flicker.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Compiles only when this file handles every kind. */
_Static_assert(NEPH_ABLATION_ADVICES == 7, "a new kind");
_Static_assert(NEPH_ABLATION_PLACES == 2, "a new kind");
_Static_assert(NEPH_ABLATION_VERDICTS == 8, "a new kind");
_Static_assert(NEPH_STUDY_TAKES == 4, "a new kind");

struct request {
    struct neph_flicker_request flicker;
    const char *preset;
    struct neph_cli_list only;
    bool list;
    struct neph_ablation ablation; /* planned; a part of the job borrows it */
};

#define AT(member) .at = offsetof(struct request, member)
static const struct neph_cli_option options[] = {
    {"preset", 0, NULL, "Preset with the measured parts; PRESET+KEY=VALUE changes it", NEPH_CLI_ONE,
     AT(preset), "ours"},
    {"suite", 0, "NAME",
     "tuning: the scenes of the choice of presets; test, test2: other scenes, for reported "
     "results; air: near fog, lamps, shafts, cirrus and shadows of clouds (default without a "
     "SCENE: tuning)",
     NEPH_CLI_WORD, AT(flicker.suite)},
    {"only", 0, NULL, "Only these parts, in place of all that the preset has", NEPH_CLI_NAMES,
     AT(only), .maximum = NEPH_ABLATION_PARTS_MAX},
    {"list", 0, NULL, "List the parts, their sources and their settings; renders nothing",
     NEPH_CLI_FLAG, AT(list)},
    {"seed", 0, NULL, "The first seed of the dithers", NEPH_CLI_INTEGER, AT(flicker.first_seed),
     "1", 1, 1000000},
    {"seeds", 0, NULL, "Seeds of the dithers, for each scene", NEPH_CLI_INTEGER,
     AT(flicker.seed_count), "2", 1, NEPH_STUDY_SEEDS_MAX},
    {"frames", 0, NULL,
     "Frames that error and flicker are measured in, a multiple of 4; a scene that moves has as "
     "many as it has",
     NEPH_CLI_INTEGER, AT(flicker.frame_count), "32", 16, 4096},
    {.name = "size", .otherwise = "192x108"},
    {"steps", 0, NULL, "Steps of every ray, of the reference's too", NEPH_CLI_INTEGER,
     AT(flicker.steps), "8", 1, 65536},
    {"takes", 0, NULL,
     "Sequences of a scene: flicker (the scene as it is: error, flicker, cost), step (of the sun: "
     "half-life)",
     NEPH_CLI_LIST, AT(flicker.takes), "flicker,step", .maximum = NEPH_STUDY_TAKES},
    {.name = "jobs", .otherwise = "1"},
    {.name = "output",
     .help = "Folder of the store and of ablation.json, ablation.csv, ablation.svg",
     .otherwise = "out/ablate"},
    {.name = "all", .help = "The tables of all parts and measures"},
    {.name = "json", .help = "All numbers as JSON on stdout"},
    {.name = "quiet"},
    {.name = NULL},
};
#undef AT

static const struct neph_cli_operands operands = {.shown = "[SCENE...]"};

static void check(const void *request_, const struct argp_state *state)
{
    const struct neph_flicker_request *request = request_;
    neph_flicker_check_scenes(request, state);
    if (request->frame_count % 4 != 0)
        argp_error(state,
                   "%d frames are not a multiple of 4: frames repeat after four, and 16, 20, 24 .. "
                   "are whole cycles",
                   request->frame_count);
}

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &operands,
    .check = check,
    .doc =
        "Switch off each part of the real-time renderer in a preset, and switch it on by itself in "
        "a pipeline without any parts; print how error, flicker, half-life and cost change, with "
        "95 % intervals over scenes.\vA change compares the number with the part to the number "
        "without it: -12 % means that the part lowers the number. `in the preset` is the change "
        "with all other parts; `alone` is the change with no other parts but those that it needs. "
        "Where the two differ, other parts do the same work. Seeds of a scene are averaged; scenes "
        "are the sample of the statistics, and p is corrected for all numbers that are judged (S. "
        "Holm).\n"
        "\n"
        "Every configuration is compared with one reference, the ray marcher at the same time with "
        "16 rays a pixel (neph study flicker --help). Evaluations and bytes are counted and exact. "
        "Milliseconds are measured on NEPH_VULKAN_DEVICE while the machine renders. Small frames "
        "have more edges than large ones. Finished frames stay in DIR/store, and the same command "
        "continues from there. Runs may share DIR. Use --jobs on a machine with many cores.\n"
        "\n"
        "Examples:\n"
        "  neph ablate --list\n"
        "  neph ablate fence_backlit foliage --only override,box,gradients\n"
        "  neph ablate --suite tuning --size 96x54    # an hour on two cores\n"
        "  neph ablate --suite test --preset fixed --size 320x180 --frames 64 --seeds 3",
};

static bool has_part(const struct neph_ablation *ablation, int part)
{
    return (ablation->parts >> part & 1) != 0;
}

/* ---- parts ----------------------------------------------------------------------------------- */

static void print_off(const char *off, FILE *out)
{
    for (; *off; off++)
        fputc(*off == '+' ? ' ' : *off, out);
}

static void print_part(const struct neph_ablation *ablation, int part, FILE *out)
{
    const struct neph_ablation_part *of = &neph_ablation_parts[part];
    fprintf(out, "%-14s %s\n%14s %s\n%14s %s; without it: ", of->name, of->what, "", of->claim, "",
            ablation->values[part]);
    print_off(of->off, out);
    if (of->needs)
        fprintf(out, "; needs %s", of->needs);
    fprintf(out, "%s\n", has_part(ablation, part) ? "" : "\n               not in this preset");
}

void neph_ablation_list(const struct neph_ablation *ablation, FILE *out)
{
    for (int i = 0; neph_ablation_parts[i].name; i++)
        print_part(ablation, i, out);
}

/* ---- sentences ------------------------------------------------------------------------------- */

/* Append the measures with a verdict to `text`: "; lowers flicker seen (-12 %), half-life (-3.1
 * %)". */
static const char *add_verdict(const struct neph_ablation_comparison *of,
                               enum neph_ablation_verdict verdict, const char *text,
                               struct neph_arena *arena)
{
    static const char *const verbs[NEPH_ABLATION_VERDICTS] = {
        [NEPH_ABLATION_BUYS] = "lowers",
        [NEPH_ABLATION_MAY_BUY] = "may lower",
        [NEPH_ABLATION_COSTS] = "raises",
        [NEPH_ABLATION_MAY_COST] = "may raise",
    };
    const char *before = text[0] ? "; " : "", *verb = verbs[verdict], *blank = " ";
    for (int m = 0; neph_ablation_measures[m].name; m++) {
        char change[NEPH_ABLATION_CHANGE_SIZE];
        if (of->effects[m].verdict != verdict || neph_ablation_measures[m].is_time)
            continue;
        neph_ablation_change(of->effects[m].mean, change);
        text = neph_arena_format(arena, "%s%s%s%s%s (%s)", text, before, verb, blank,
                                 neph_ablation_measures[m].title, change);
        before = ", ", verb = blank = "";
    }
    return text;
}

/* Least change in a single scene that is mentioned: 0.1 decades, about a fifth. */
static const double worth_naming_decades = 0.1;

/* The first measure that a part lowers by at least that much in some scene; -1: none. */
static int worth_naming(const struct neph_ablation_comparison *of)
{
    for (int m = 0; neph_ablation_measures[m].metric; m++) {
        const struct neph_ablation_effect *effect = &of->effects[m];
        if (effect->best_scene >= 0 && effect->scenes[effect->best_scene] < -worth_naming_decades)
            return m;
    }
    return -1;
}

/* The effect of a part in the preset, as a sentence without its full stop. */
static const char *sentence(const struct neph_ablation *ablation,
                            const struct neph_ablation_comparison *in_preset,
                            struct neph_arena *arena)
{
    static const enum neph_ablation_verdict order[] = {NEPH_ABLATION_BUYS, NEPH_ABLATION_MAY_BUY,
                                                       NEPH_ABLATION_COSTS, NEPH_ABLATION_MAY_COST};
    static const struct {
        const char *end, *scene;
    } words[NEPH_ABLATION_ADVICES] = {
        [NEPH_ABLATION_KEEP] = {NULL, "; most in"},
        [NEPH_ABLATION_PERHAPS] = {NULL, "; most in"},
        [NEPH_ABLATION_UNTOLD] = {"its effect is within the noise: could be left out",
                                  ", but for scenes like"},
        [NEPH_ABLATION_LEAVE_OUT] = {"buys nothing: leave it out", ", but for scenes like"},
        [NEPH_ABLATION_LITTLE] = {"changes nothing by 5 %: could be left out",
                                  ", but for scenes like"},
        [NEPH_ABLATION_IDLE] = {"changes no number in these scenes: could be left out in such", ""},
        [NEPH_ABLATION_UNMEASURED] = {"no scene has a number", ""},
    };
    const enum neph_ablation_advice advice = neph_ablation_advise(in_preset);
    const int best = worth_naming(in_preset);
    const char *text = "";
    for (size_t i = 0; i < sizeof(order) / sizeof(order[0]); i++)
        text = add_verdict(in_preset, order[i], text, arena);
    if (words[advice].end)
        text = neph_arena_format(arena, "%s%s%s", text, text[0] ? "; " : "", words[advice].end);
    if (best < 0)
        return text;
    char change[NEPH_ABLATION_CHANGE_SIZE];
    const struct neph_ablation_effect *effect = &in_preset->effects[best];
    neph_ablation_change(effect->scenes[effect->best_scene], change);
    return neph_arena_format(arena, "%s%s %s (%s %s)", text, words[advice].scene,
                             ablation->study.scenes[effect->best_scene].name,
                             neph_ablation_measures[best].title, change);
}

/* ---- the head -------------------------------------------------------------------------------- */

static void print_scenes(const struct neph_ablation *ablation, FILE *out)
{
    const struct neph_flicker_study *study = &ablation->study;
    fprintf(out, "Scenes:");
    for (int i = 0; i < study->params->scene_count; i++)
        if (!study->scenes[i].left_out)
            fprintf(out, " %s", study->scenes[i].name);
    fprintf(out, ".\n");
    for (int i = 0; i < study->params->scene_count; i++)
        if (study->scenes[i].left_out)
            fprintf(out, "Left out: %s: %s.\n", study->scenes[i].name, study->scenes[i].left_out);
}

static void print_head(const struct neph_ablation *ablation, FILE *out)
{
    const struct neph_flicker_study_params *params = ablation->study.params;
    fprintf(out,
            "neph %s, %s: preset %s, %dx%d, %d step%s, %d frames, %d seed%s a scene.\n"
            "%d configurations, reference: march, 16 rays a pixel, %d steps.\n",
            NEPH_VERSION, ablation->study.device, ablation->preset, params->width_px,
            params->height_px, params->steps, params->steps == 1 ? "" : "s", params->frame_count,
            params->seed_count, params->seed_count == 1 ? "" : "s", params->preset_count,
            params->steps);
    print_scenes(ablation, out);
    fprintf(out,
            "\n"
            "A change is with the part over without it, below 0 the part buys. Means and 95 %% "
            "intervals over scenes, seeds of a scene averaged; %d numbers were judged together (S. "
            "Holm, 5 %%): **certain**, plain: only its own interval says so, (undecided), ~ within "
            "5 %% either way, = the same in every scene. Milliseconds are of the device above and "
            "decide nothing.\n",
            ablation->judged_count);
}

/* ---- a line for each part -------------------------------------------------------------------- */

static void add_short(const struct neph_ablation_effect *effect, bool is_time,
                      struct neph_table *table)
{
    static const char *const forms[NEPH_ABLATION_VERDICTS] = {
        [NEPH_ABLATION_NO_NUMBER] = "-", [NEPH_ABLATION_SAME] = "=",
        [NEPH_ABLATION_NOTHING] = "~",   [NEPH_ABLATION_BUYS] = "**%s**",
        [NEPH_ABLATION_MAY_BUY] = "%s",  [NEPH_ABLATION_COSTS] = "**%s**",
        [NEPH_ABLATION_MAY_COST] = "%s", [NEPH_ABLATION_UNDECIDED] = "(%s)",
    };
    char change[NEPH_ABLATION_CHANGE_SIZE];
    neph_ablation_change(effect->mean, change);
    neph_table_word(table, NULL);
    neph_table_shown(table, is_time && !isnan(effect->mean) ? "%s" : forms[effect->verdict],
                     change);
}

static void add_row(const struct neph_ablation *ablation, const struct neph_ablation_comparison *of,
                    const char *name, struct neph_table *table)
{
    neph_table_word(table, name);
    for (int m = 0; neph_ablation_measures[m].name; m++)
        if (neph_ablation_has_measure(ablation, m))
            add_short(&of->effects[m], neph_ablation_measures[m].is_time, table);
}

static void print_place(const struct neph_ablation *ablation, enum neph_ablation_place place,
                        struct neph_publication *publication)
{
    struct neph_table table = {.cells = NULL};
    neph_table_column(&table, (struct neph_column){.title = "part"});
    for (int m = 0; neph_ablation_measures[m].name; m++)
        if (neph_ablation_has_measure(ablation, m))
            neph_table_column(
                &table,
                (struct neph_column){.title = neph_ablation_measures[m].column, .format = "%g"});
    for (int i = 0; neph_ablation_parts[i].name; i++) {
        const struct neph_ablation_comparison *of = neph_ablation_find(ablation, i, place);
        if (of)
            add_row(ablation, of, neph_ablation_parts[i].name, &table);
    }
    if (place == NEPH_ABLATION_IN_PRESET)
        add_row(ablation, neph_ablation_find(ablation, -1, place), "all but those that stay",
                &table);
    neph_publication_table(publication, &table);
}

static void print_verdicts(const struct neph_ablation *ablation,
                           struct neph_publication *publication)
{
    FILE *out = publication->text;
    fprintf(out, "\n**Verdicts**\n\n");
    for (int i = 0; neph_ablation_parts[i].name; i++) {
        const struct neph_ablation_comparison *of = neph_ablation_find(ablation, i,
                                                                       NEPH_ABLATION_IN_PRESET);
        if (of)
            fprintf(out, "- %s: %s.\n", neph_ablation_parts[i].name,
                    sentence(ablation, of, &publication->arena));
    }
    int all = 0;
    fprintf(out, "- not in this preset:");
    for (int i = 0, count = 0; neph_ablation_parts[i].name; i++) {
        all += has_part(ablation, i);
        if (!has_part(ablation, i))
            fprintf(out, "%s %s", count++ ? "," : "", neph_ablation_parts[i].name);
    }
    fprintf(out, "%s.\n", all == neph_ablation_part_count() ? " none" : "");
}

/* ---- the answer ------------------------------------------------------------------------------ */

/* Appends "; keep: history, jitter". */
static void append_advice(const struct neph_ablation *ablation, enum neph_ablation_advice advice,
                          char *text, size_t size)
{
    int count = 0;
    for (int i = 0; neph_ablation_parts[i].name; i++) {
        const struct neph_ablation_comparison *of = neph_ablation_find(ablation, i,
                                                                       NEPH_ABLATION_IN_PRESET);
        const size_t used = strlen(text);
        if (!of || neph_ablation_advise(of) != advice)
            continue;
        if (count++ == 0)
            snprintf(text + used, size - used, "; %s: %s", neph_ablation_advice_words[advice],
                     neph_ablation_parts[i].name);
        else
            snprintf(text + used, size - used, ", %s", neph_ablation_parts[i].name);
    }
}

static void answer(const struct neph_ablation *ablation, struct neph_answer *answer,
                   struct neph_arena *arena)
{
    const struct neph_flicker_study_params *params = ablation->study.params;
    char text[800] = "";
    for (int advice = 0; advice < NEPH_ABLATION_ADVICES; advice++)
        append_advice(ablation, (enum neph_ablation_advice)advice, text, sizeof(text));
    neph_answer_add(answer, "%s:%s (%d scenes, %d seed%s, 95 %% intervals)", ablation->preset,
                    text[0] ? text + 1 : " no part was measured", params->scene_count,
                    params->seed_count, params->seed_count == 1 ? "" : "s");
    for (int i = 0; neph_ablation_parts[i].name; i++) {
        const struct neph_ablation_comparison *of = neph_ablation_find(ablation, i,
                                                                       NEPH_ABLATION_IN_PRESET);
        if (of)
            neph_answer_add(answer, "%s: %s", neph_ablation_parts[i].name,
                            sentence(ablation, of, arena));
    }
}

/* ---- a row for each part, place and measure -------------------------------------------------- */

static const char *const place_names[NEPH_ABLATION_PLACES] = {"in_preset", "alone"};

static void begin_effects(struct neph_table *table)
{
    static const struct neph_column columns[] = {
        {.key = "place"},
        {.key = "measure"},
        {.title = "measure"},
        {.title = "where"},
        {.key = "decades"},
        {.key = "interval", .title = "change, interval", .format = "%g"},
        {.key = "p"},
        {.key = "p_holm"},
        {.key = "better"},
        {.key = "worse"},
        {.key = "alike"},
        {.title = "better, worse, alike", .format = "%g"},
        {.key = "verdict", .title = ""},
        {.key = "scenes", .title = "most down"},
        {.title = "most up"},
    };
    neph_table_columns(table, columns, sizeof(columns) / sizeof(columns[0]));
}

/* Formats "-12 % [-20 %, -3.1 %]". */
static const char *change_text(const struct neph_ablation_effect *effect, struct neph_arena *arena)
{
    char mean[NEPH_ABLATION_CHANGE_SIZE], low[NEPH_ABLATION_CHANGE_SIZE],
        high[NEPH_ABLATION_CHANGE_SIZE];
    neph_ablation_change(effect->mean, mean);
    neph_ablation_change(effect->low, low);
    neph_ablation_change(effect->high, high);
    return isnan(effect->mean)    ? "-"
           : effect->has_interval ? neph_arena_format(arena, "%s [%s, %s]", mean, low, high)
                                  : neph_arena_text(arena, mean);
}

static const char *scene_text(const struct neph_ablation *ablation,
                              const struct neph_ablation_effect *effect, int scene,
                              struct neph_arena *arena)
{
    char change[NEPH_ABLATION_CHANGE_SIZE];
    if (scene < 0)
        return "-";
    neph_ablation_change(effect->scenes[scene], change);
    return neph_arena_format(arena, "%s %s", ablation->study.scenes[scene].name, change);
}

static json_t *scenes_json(const struct neph_ablation *ablation,
                           const struct neph_ablation_effect *effect)
{
    json_t *scenes = json_object();
    for (int scene = 0; scene < ablation->study.params->scene_count; scene++)
        if (!isnan(effect->scenes[scene]))
            neph_json_set(&scenes, ablation->study.scenes[scene].name,
                          json_real(effect->scenes[scene]));
    return scenes;
}

static void add_effect(const struct neph_ablation *ablation,
                       const struct neph_ablation_comparison *of, int measure,
                       struct neph_table *table)
{
    const struct neph_ablation_effect *effect = &of->effects[measure];
    const struct neph_ablation_measure *what = &neph_ablation_measures[measure];
    struct neph_arena *arena = &table->arena;
    const bool has_number = !isnan(effect->mean);
    neph_table_word(table, place_names[of->place]);
    neph_table_word(table, what->name);
    neph_table_word(table, what->title);
    neph_table_word(table, of->place == NEPH_ABLATION_ALONE ? "alone" : ablation->preset);
    neph_table_number(table, effect->mean);
    neph_table_value(table, effect->has_interval ? json_pack("[f,f]", effect->low, effect->high)
                                                 : json_null());
    neph_table_shown(table, "%s", change_text(effect, arena));
    neph_table_numbers(table, 2, (const double[]){effect->p, effect->p_holm});
    neph_table_count(table, effect->better);
    neph_table_count(table, effect->worse);
    neph_table_count(table, effect->alike);
    neph_table_word(table, has_number ? neph_arena_format(arena, "%d, %d, %d", effect->better,
                                                          effect->worse, effect->alike)
                                      : "-");
    neph_table_word(table, neph_ablation_verdict_words[effect->verdict]);
    if (!has_number || what->is_time)
        neph_table_shown(table, has_number ? "" : "-");
    neph_table_value(table, scenes_json(ablation, effect));
    neph_table_shown(table, "%s", scene_text(ablation, effect, effect->best_scene, arena));
    neph_table_word(table, scene_text(ablation, effect, effect->worst_scene, arena));
}

/* Fill the rows of a part in all places; part -1: all parts at once. */
static void fill_effects(const struct neph_ablation *ablation, int part, struct neph_table *table)
{
    begin_effects(table);
    for (int place = 0; place < NEPH_ABLATION_PLACES; place++) {
        const struct neph_ablation_comparison *of = neph_ablation_find(
            ablation, part, (enum neph_ablation_place)place);
        for (int m = 0; of && neph_ablation_measures[m].name; m++)
            if (neph_ablation_has_measure(ablation, m))
                add_effect(ablation, of, m, table);
    }
}

static void print_details(const struct neph_ablation *ablation, int part,
                          struct neph_publication *publication)
{
    FILE *out = publication->text;
    struct neph_table table = {.cells = NULL};
    fill_effects(ablation, part, &table);
    fprintf(out, "\n**%s**: %s (%s). %s; without it: ", neph_ablation_parts[part].name,
            neph_ablation_parts[part].what, neph_ablation_parts[part].claim,
            ablation->values[part]);
    print_off(neph_ablation_parts[part].off, out);
    fprintf(out, ".\n\n");
    neph_publication_table(publication, &table);
}

static void print_text(const struct neph_ablation *ablation, struct neph_publication *publication)
{
    FILE *out = publication->text;
    print_head(ablation, out);
    fprintf(out,
            "\n"
            "**Effect of each part in %s**\n"
            "\n",
            ablation->preset);
    print_place(ablation, NEPH_ABLATION_IN_PRESET, publication);
    fprintf(out, "\n"
                 "**Effect of each part by itself, in the plain pipeline**\n"
                 "\n");
    print_place(ablation, NEPH_ABLATION_ALONE, publication);
    print_verdicts(ablation, publication);
    for (int i = 0; neph_ablation_parts[i].name; i++)
        if (ablation->asked >> i & 1)
            print_details(ablation, i, publication);
}

/* ---- CSV ------------------------------------------------------------------------------------- */

/* Add a number of one scene; `scene` NULL: of all scenes. */
static void add_number(const struct neph_ablation_comparison *of, int measure, const char *scene,
                       double decades, struct neph_table *table)
{
    const struct neph_ablation_effect *effect = &of->effects[measure];
    const bool has_interval = !scene && effect->has_interval;
    if (isnan(decades))
        return;
    neph_table_word(table, of->part < 0 ? "all" : neph_ablation_parts[of->part].name);
    neph_table_word(table, place_names[of->place]);
    neph_table_word(table, neph_ablation_measures[measure].name);
    neph_table_word(table, scene);
    neph_table_numbers(table, 5,
                       (const double[]){decades, has_interval ? effect->low : NAN,
                                        has_interval ? effect->high : NAN,
                                        has_interval ? effect->p : NAN,
                                        has_interval ? effect->p_holm : NAN});
    neph_table_word(table, scene ? NULL : neph_ablation_verdict_words[effect->verdict]);
}

static void print_csv(const struct neph_ablation *ablation, struct neph_publication *publication)
{
    static const struct neph_column columns[] = {
        {.key = "part"},    {.key = "place"},  {.key = "measure"}, {.key = "scene"},
        {.key = "decades"}, {.key = "low"},    {.key = "high"},    {.key = "p"},
        {.key = "p_holm"},  {.key = "verdict"}};
    const struct neph_flicker_study *study = &ablation->study;
    struct neph_table table = {.cells = NULL};
    neph_table_columns(&table, columns, sizeof(columns) / sizeof(columns[0]));
    for (int c = 0; c < ablation->comparison_count; c++)
        for (int m = 0; neph_ablation_measures[m].name; m++) {
            const struct neph_ablation_comparison *of = &ablation->comparisons[c];
            add_number(of, m, NULL, of->effects[m].mean, &table);
            for (int scene = 0; scene < study->params->scene_count; scene++)
                add_number(of, m, study->scenes[scene].name, of->effects[m].scenes[scene], &table);
        }
    neph_publication_csv(publication, "\r\n", &table);
}

/* ---- JSON ------------------------------------------------------------------------------------ */

static json_t *effects_json(const struct neph_ablation *ablation, int part)
{
    struct neph_table table = {.cells = NULL};
    fill_effects(ablation, part, &table);
    json_t *list = neph_table_json(&table);
    neph_table_finish(&table);
    return list;
}

static json_t *part_json(const struct neph_ablation *ablation, int part, struct neph_arena *arena)
{
    const struct neph_ablation_part *of = &neph_ablation_parts[part];
    const struct neph_ablation_comparison *in_preset = neph_ablation_find(ablation, part,
                                                                          NEPH_ABLATION_IN_PRESET);
    json_t *json = json_pack("{s:s, s:s, s:s, s:s, s:s, s:s?, s:b}", "part", of->name, "what",
                             of->what, "claim", of->claim, "settings", ablation->values[part],
                             "without", of->off, "needs", of->needs, "in_preset",
                             has_part(ablation, part));
    if (!in_preset)
        return json;
    neph_json_set(&json, "advice",
                  json_string(neph_ablation_advice_words[neph_ablation_advise(in_preset)]));
    neph_json_set(&json, "verdict", json_string(sentence(ablation, in_preset, arena)));
    neph_json_set(&json, "effects", effects_json(ablation, part));
    return json;
}

static json_t *measures_json(const struct neph_ablation *ablation)
{
    json_t *list = json_array();
    for (int m = 0; neph_ablation_measures[m].name; m++) {
        const struct neph_ablation_measure *measure = &neph_ablation_measures[m];
        if (neph_ablation_has_measure(ablation, m))
            neph_json_add(&list, json_pack("{s:s, s:s, s:s?, s:s?}", "measure", measure->name,
                                           "title", measure->title, "metric", measure->metric,
                                           "mask", measure->mask));
    }
    return list;
}

static json_t *left_out_json(const struct neph_ablation *ablation)
{
    json_t *scenes = json_object();
    for (int i = 0; i < ablation->study.params->scene_count; i++)
        if (ablation->study.scenes[i].left_out)
            neph_json_set(&scenes, ablation->study.scenes[i].name,
                          json_string(ablation->study.scenes[i].left_out));
    return scenes;
}

static json_t *ablation_json(const struct neph_ablation *ablation, struct neph_arena *arena)
{
    const struct neph_flicker_study_params *params = ablation->study.params;
    json_t *parts = json_array();
    for (int i = 0; neph_ablation_parts[i].name; i++)
        neph_json_add(&parts, part_json(ablation, i, arena));
    return json_pack("{s:s, s:s, s:s, s:s, s:s, s:[i,i], s:i, s:i, s:i, s:i, s:i, s:o, s:o, s:o, "
                     "s:o}",
                     "format", "neph-ablation-1", "version", NEPH_VERSION, "device",
                     ablation->study.device, "preset", ablation->preset, "plain",
                     ablation->words[1], "size_px", params->width_px, params->height_px, "steps",
                     params->steps, "frames", params->frame_count, "seeds", params->seed_count,
                     "broken", ablation->study.failed_count, "judged", ablation->judged_count,
                     "measures", measures_json(ablation), "left_out", left_out_json(ablation),
                     "all", effects_json(ablation, -1), "parts", parts);
}

/* ---- the experiment -------------------------------------------------------------------------- */

enum neph_status neph_ablation_publish(const struct neph_ablation *ablation,
                                       struct neph_publication *publication, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    publication->broken_count = ablation->study.failed_count;
    publication->broken_words = "sequences failed; their scenes have no number";
    publication->json = ablation_json(ablation, &publication->arena);
    if (publication->text)
        print_text(ablation, publication);
    answer(ablation, &publication->answer, &publication->arena);
    print_csv(ablation, publication);
    if (publication->chart)
        status = neph_ablation_plot(ablation, publication->chart, diag);
    return status ? status : neph_json_check(publication->json, diag);
}

static enum neph_status plan(struct request *request, struct neph_diag *diag)
{
    return neph_ablation_plan(request->preset, request->only.words, request->only.count,
                              &request->ablation, diag);
}

/* Only flicker and step have measures, sine and cut have none. */
enum { TAKES = NEPH_STUDY_STEP + 1 };

static enum neph_status prepare(void *request_, struct neph_diag *diag)
{
    struct request *request = request_;
    struct neph_cli_shared *shared = &request->flicker.shared;
    if (request->list) { /* needs neither scenes nor a store, and has no JSON */
        shared->operand_count = 0;
        shared->output = NULL;
        shared->json = false;
    }
    const enum neph_status status = neph_flicker_prepare(&request->flicker, TAKES, "tuning", diag);
    return status ? status : plan(request, diag);
}

static bool part(void *request_, int index)
{
    struct request *request = request_;
    return neph_flicker_part(&request->flicker, request->ablation.configuration_count, index);
}

static enum neph_status run(void *request_, const struct neph_experiment_run *run,
                            struct neph_publication *publication, struct neph_diag *diag)
{
    struct request *request = request_;
    struct neph_ablation *ablation = &request->ablation;
    struct neph_flicker_study_params params = neph_flicker_params(
        &request->flicker, ablation->words, ablation->configuration_count, run);
    params.labels = ablation->labels + request->flicker.part_preset;
    params.brief = true;
    if (request->list) {
        neph_ablation_list(ablation, publication->text);
        return NEPH_OK;
    }
    enum neph_status status = neph_flicker_study_run(&params, run->store, &ablation->study, diag);
    if (!status && !request->flicker.is_part)
        status = neph_ablation_judge(ablation, diag);
    if (!status && !request->flicker.is_part)
        status = neph_ablation_publish(ablation, publication, diag);
    neph_flicker_study_finish(&ablation->study);
    return status;
}

static void finish(void *request_)
{
    struct request *request = request_;
    neph_ablation_finish(&request->ablation);
    neph_flicker_free(&request->flicker);
}

const struct neph_experiment neph_experiment_ablation = {.syntax = &syntax,
                                                         .request_size = sizeof(struct request),
                                                         .chart = "ablation.svg",
                                                         .csv = "ablation.csv",
                                                         .document = "ablation.json",
                                                         .prepare = prepare,
                                                         .part = part,
                                                         .run = run,
                                                         .finish = finish};
