/* SPDX-License-Identifier: MIT */
#include "harness/study/ablation_output.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_ABLATION_ADVICES == 7, "a new kind");
_Static_assert(NEPH_ABLATION_PLACES == 2, "a new kind");
_Static_assert(NEPH_ABLATION_VERDICTS == 8, "a new kind");

/* What was printed into memory, unless memory was short on the way. */
static enum neph_status close_text(FILE *out, char **text, struct neph_diag *diag)
{
    const bool cut = ferror(out) != 0, closed = fclose(out) == 0;
    if (!cut && closed)
        return NEPH_OK;
    free(*text);
    *text = NULL;
    return neph_fail_memory(diag);
}

static enum neph_status open_text(char **text, size_t *size, FILE **out, struct neph_diag *diag)
{
    *text = NULL;
    *out = open_memstream(text, size);
    return *out ? NEPH_OK : neph_fail_memory(diag);
}

void neph_ablation_change(double decades, char text[NEPH_ABLATION_CHANGE_SIZE])
{
    const double ratio = pow(10.0, decades), percent = 100.0 * (ratio - 1.0);
    if (decades == 0.0)
        snprintf(text, NEPH_ABLATION_CHANGE_SIZE, "0 %%");
    else if (ratio > 100.0 || ratio < 0.01) /* one of both is as good as nothing */
        snprintf(text, NEPH_ABLATION_CHANGE_SIZE, ratio > 1.0 ? ">x100" : "<-99 %%");
    else if (ratio >= 2.95)
        snprintf(text, NEPH_ABLATION_CHANGE_SIZE, "x%.2g", ratio);
    else
        snprintf(text, NEPH_ABLATION_CHANGE_SIZE, fabs(percent) < 9.95 ? "%+.1f %%" : "%+.0f %%",
                 percent);
}

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

enum neph_status neph_ablation_list(const struct neph_ablation *ablation, char **text,
                                    struct neph_diag *diag)
{
    size_t size;
    FILE *out;
    const enum neph_status status = open_text(text, &size, &out, diag);
    if (status)
        return status;
    for (int i = 0; neph_ablation_parts[i].name; i++)
        print_part(ablation, i, out);
    return close_text(out, text, diag);
}

/* ---- sentences ------------------------------------------------------------------------------- */

/* "; lowers flicker seen (-12 %), half-life (-3.1 %)": the measures with a verdict. How many. */
static int print_verdict(const struct neph_ablation_comparison *of,
                         enum neph_ablation_verdict verdict, const char *before, FILE *out)
{
    static const char *const verbs[NEPH_ABLATION_VERDICTS] = {
        [NEPH_ABLATION_BUYS] = "lowers",
        [NEPH_ABLATION_MAY_BUY] = "may lower",
        [NEPH_ABLATION_COSTS] = "raises",
        [NEPH_ABLATION_MAY_COST] = "may raise",
    };
    int count = 0;
    for (int m = 0; neph_ablation_measures[m].name; m++) {
        char change[NEPH_ABLATION_CHANGE_SIZE];
        if (of->effects[m].verdict != verdict || neph_ablation_measures[m].is_time)
            continue;
        neph_ablation_change(of->effects[m].mean, change);
        if (count++ == 0)
            fprintf(out, "%s%s ", before, verbs[verdict]);
        else
            fprintf(out, ", ");
        fprintf(out, "%s (%s)", neph_ablation_measures[m].title, change);
    }
    return count;
}

/* What a part does in a single scene is worth a word from a fifth on. */
static const double worth_naming_decades = 0.1;

/* The first measure that a part lowers by so much in a scene; -1: none. */
static int worth_naming(const struct neph_ablation_comparison *of)
{
    for (int m = 0; neph_ablation_measures[m].metric; m++) {
        const struct neph_ablation_effect *effect = &of->effects[m];
        if (effect->best_scene >= 0 && effect->scenes[effect->best_scene] < -worth_naming_decades)
            return m;
    }
    return -1;
}

static void print_best_scene(const struct neph_ablation *ablation,
                             const struct neph_ablation_comparison *of, const char *before,
                             FILE *out)
{
    char change[NEPH_ABLATION_CHANGE_SIZE];
    const int measure = worth_naming(of);
    if (measure < 0)
        return;
    const struct neph_ablation_effect *effect = &of->effects[measure];
    neph_ablation_change(effect->scenes[effect->best_scene], change);
    fprintf(out, "%s %s (%s %s)", before, ablation->study.scenes[effect->best_scene].name,
            neph_ablation_measures[measure].title, change);
}

void neph_ablation_sentence(const struct neph_ablation *ablation,
                            const struct neph_ablation_comparison *in_preset, FILE *out)
{
    static const enum neph_ablation_verdict order[] = {NEPH_ABLATION_BUYS, NEPH_ABLATION_MAY_BUY,
                                                       NEPH_ABLATION_COSTS, NEPH_ABLATION_MAY_COST};
    static const struct {
        const char *end, *scene;
    } words[NEPH_ABLATION_ADVICES] = {
        [NEPH_ABLATION_KEEP] = {NULL, "; most in"},
        [NEPH_ABLATION_PERHAPS] = {NULL, "; most in"},
        [NEPH_ABLATION_UNTOLD] = {"what it buys cannot be told from nothing: could be left out",
                                  ", but for scenes like"},
        [NEPH_ABLATION_LEAVE_OUT] = {"buys nothing: leave it out", ", but for scenes like"},
        [NEPH_ABLATION_LITTLE] = {"changes nothing by 5 %: could be left out",
                                  ", but for scenes like"},
        [NEPH_ABLATION_IDLE] = {"changes no number in these scenes: could be left out in such", ""},
        [NEPH_ABLATION_UNMEASURED] = {"no scene has a number", ""},
    };
    const enum neph_ablation_advice advice = neph_ablation_advise(in_preset);
    int count = 0;
    for (size_t i = 0; i < sizeof(order) / sizeof(order[0]); i++)
        count += print_verdict(in_preset, order[i], count ? "; " : "", out);
    if (words[advice].end)
        fprintf(out, "%s%s", count ? "; " : "", words[advice].end);
    print_best_scene(ablation, in_preset, words[advice].scene, out);
}

/* ---- the head -------------------------------------------------------------------------------- */

static void print_scenes(const struct neph_ablation *ablation, FILE *out)
{
    const struct neph_flicker_study *study = &ablation->study;
    fprintf(out, "Scenes:");
    for (int i = 0; i < ablation->params.scene_count; i++)
        if (!study->scenes[i].left_out)
            fprintf(out, " %s", study->scenes[i].name);
    fprintf(out, ".\n");
    for (int i = 0; i < ablation->params.scene_count; i++)
        if (study->scenes[i].left_out)
            fprintf(out, "Left out: %s: %s.\n", study->scenes[i].name, study->scenes[i].left_out);
}

static void print_head(const struct neph_ablation *ablation, FILE *out)
{
    const struct neph_flicker_study_params *params = &ablation->params;
    fprintf(out,
            "neph %s, %s: preset %s, %dx%d, %d step%s, %d frames, %d seed%s a scene.\n"
            "%d configurations, reference: march, 16 rays a pixel, %d steps.\n",
            NEPH_VERSION, ablation->study.device, ablation->preset, params->width_px,
            params->height_px, params->steps, params->steps == 1 ? "" : "s", params->frame_count,
            params->seed_count, params->seed_count == 1 ? "" : "s", params->preset_count,
            params->steps);
    print_scenes(ablation, out);
    fprintf(out,
            "\nA change is with the part over without it, below 0 the part buys. Means and 95 %% "
            "intervals over scenes, seeds of a scene averaged; %d numbers were judged together "
            "(S. Holm, 5 %%): **certain**, plain: its own interval alone says so, (undecided), ~ "
            "within 5 %% either way, = the same in every scene. Milliseconds are of the device "
            "above and decide nothing.\n",
            ablation->judged_count);
}

/* ---- a line for each part -------------------------------------------------------------------- */

static void print_short(const struct neph_ablation_effect *effect, bool is_time, FILE *out)
{
    static const char *const forms[NEPH_ABLATION_VERDICTS] = {
        [NEPH_ABLATION_NO_NUMBER] = " - |", [NEPH_ABLATION_SAME] = " = |",
        [NEPH_ABLATION_NOTHING] = " ~ |",   [NEPH_ABLATION_BUYS] = " **%s** |",
        [NEPH_ABLATION_MAY_BUY] = " %s |",  [NEPH_ABLATION_COSTS] = " **%s** |",
        [NEPH_ABLATION_MAY_COST] = " %s |", [NEPH_ABLATION_UNDECIDED] = " (%s) |",
    };
    char change[NEPH_ABLATION_CHANGE_SIZE];
    neph_ablation_change(effect->mean, change);
    const char *form = is_time && !isnan(effect->mean) ? " %s |" : forms[effect->verdict];
    for (; *form; form++) {
        if (form[0] == '%')
            fputs(change, out), form++;
        else
            fputc(*form, out);
    }
}

static void print_row(const struct neph_ablation *ablation,
                      const struct neph_ablation_comparison *of, const char *name, FILE *out)
{
    fprintf(out, "| %s |", name);
    for (int m = 0; neph_ablation_measures[m].name; m++)
        if (neph_ablation_has_measure(ablation, m))
            print_short(&of->effects[m], neph_ablation_measures[m].is_time, out);
    fprintf(out, "\n");
}

static void print_columns(const struct neph_ablation *ablation, const char *first, FILE *out)
{
    fprintf(out, "\n| %s |", first);
    for (int m = 0; neph_ablation_measures[m].name; m++)
        if (neph_ablation_has_measure(ablation, m))
            fprintf(out, " %s |", neph_ablation_measures[m].column);
    fprintf(out, "\n| --- |");
    for (int m = 0; neph_ablation_measures[m].name; m++)
        if (neph_ablation_has_measure(ablation, m))
            fprintf(out, " ---: |");
    fprintf(out, "\n");
}

static void print_place(const struct neph_ablation *ablation, enum neph_ablation_place place,
                        FILE *out)
{
    print_columns(ablation, "part", out);
    for (int i = 0; neph_ablation_parts[i].name; i++) {
        const struct neph_ablation_comparison *of = neph_ablation_find(ablation, i, place);
        if (of)
            print_row(ablation, of, neph_ablation_parts[i].name, out);
    }
}

static void print_overview(const struct neph_ablation *ablation, FILE *out)
{
    fprintf(out, "\n**What each part does in %s**\n", ablation->preset);
    print_place(ablation, NEPH_ABLATION_IN_PRESET, out);
    print_row(ablation, neph_ablation_find(ablation, -1, NEPH_ABLATION_IN_PRESET),
              "all but those that stay", out);
    fprintf(out, "\n**What each part does alone, in the plain pipeline**\n");
    print_place(ablation, NEPH_ABLATION_ALONE, out);
}

static void print_verdicts(const struct neph_ablation *ablation, FILE *out)
{
    fprintf(out, "\n**Verdicts**\n\n");
    for (int i = 0; neph_ablation_parts[i].name; i++) {
        const struct neph_ablation_comparison *of = neph_ablation_find(ablation, i,
                                                                       NEPH_ABLATION_IN_PRESET);
        if (!of)
            continue;
        fprintf(out, "- %s: ", neph_ablation_parts[i].name);
        neph_ablation_sentence(ablation, of, out);
        fprintf(out, ".\n");
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

/* ---- a table for each part ------------------------------------------------------------------- */

static void print_effect(const struct neph_ablation_effect *effect, bool is_time, FILE *out)
{
    char mean[NEPH_ABLATION_CHANGE_SIZE], low[NEPH_ABLATION_CHANGE_SIZE],
        high[NEPH_ABLATION_CHANGE_SIZE];
    if (isnan(effect->mean)) {
        fprintf(out, " - | - | - |");
        return;
    }
    neph_ablation_change(effect->mean, mean);
    neph_ablation_change(effect->low, low);
    neph_ablation_change(effect->high, high);
    fprintf(out, " %s", mean);
    if (effect->has_interval)
        fprintf(out, " [%s, %s]", low, high);
    fprintf(out, " | %d, %d, %d | %s |", effect->better, effect->worse, effect->alike,
            is_time ? "" : neph_ablation_verdict_words[effect->verdict]);
}

static void print_scene(const struct neph_ablation *ablation,
                        const struct neph_ablation_effect *effect, int scene, FILE *out)
{
    char change[NEPH_ABLATION_CHANGE_SIZE];
    if (scene < 0) {
        fprintf(out, " - |");
        return;
    }
    neph_ablation_change(effect->scenes[scene], change);
    fprintf(out, " %s %s |", ablation->study.scenes[scene].name, change);
}

static void print_details_of(const struct neph_ablation *ablation,
                             const struct neph_ablation_comparison *of, const char *place,
                             FILE *out)
{
    for (int m = 0; of && neph_ablation_measures[m].name; m++) {
        const struct neph_ablation_effect *effect = &of->effects[m];
        if (!neph_ablation_has_measure(ablation, m))
            continue;
        fprintf(out, "| %s | %s |", neph_ablation_measures[m].title, place);
        print_effect(effect, neph_ablation_measures[m].is_time, out);
        print_scene(ablation, effect, effect->best_scene, out);
        print_scene(ablation, effect, effect->worst_scene, out);
        fprintf(out, "\n");
    }
}

static void print_details(const struct neph_ablation *ablation, int part, FILE *out)
{
    const struct neph_ablation_comparison *of = neph_ablation_find(ablation, part,
                                                                   NEPH_ABLATION_IN_PRESET);
    if (!of)
        return;
    fprintf(out, "\n**%s**: %s (%s). %s; without it: ", neph_ablation_parts[part].name,
            neph_ablation_parts[part].what, neph_ablation_parts[part].claim,
            ablation->values[part]);
    print_off(neph_ablation_parts[part].off, out);
    fprintf(out, ".\n\n| measure | where | change, interval | better, worse, alike | | most down | "
                 "most up |\n| --- | --- | ---: | ---: | --- | --- | --- |\n");
    print_details_of(ablation, of, ablation->preset, out);
    print_details_of(ablation, neph_ablation_find(ablation, part, NEPH_ABLATION_ALONE), "alone",
                     out);
}

enum neph_status neph_ablation_text(const struct neph_ablation *ablation, char **text,
                                    struct neph_diag *diag)
{
    size_t size;
    FILE *out;
    const enum neph_status status = open_text(text, &size, &out, diag);
    if (status)
        return status;
    print_head(ablation, out);
    print_overview(ablation, out);
    print_verdicts(ablation, out);
    for (int i = 0; neph_ablation_parts[i].name; i++)
        print_details(ablation, i, out);
    return close_text(out, text, diag);
}

/* ---- CSV ------------------------------------------------------------------------------------- */

static const char *const place_names[NEPH_ABLATION_PLACES] = {"in_preset", "alone"};

static const char *name_of(const struct neph_ablation_comparison *of)
{
    return of->part < 0 ? "all" : neph_ablation_parts[of->part].name;
}

static void print_csv(const struct neph_ablation *ablation,
                      const struct neph_ablation_comparison *of, int measure, FILE *out)
{
    const struct neph_ablation_effect *effect = &of->effects[measure];
    const char *name = neph_ablation_measures[measure].name;
    if (!isnan(effect->mean) && effect->has_interval)
        fprintf(out, "%s,%s,%s,,%.9g,%.9g,%.9g,%.9g,%.9g,%s\r\n", name_of(of),
                place_names[of->place], name, effect->mean, effect->low, effect->high, effect->p,
                effect->p_holm, neph_ablation_verdict_words[effect->verdict]);
    else if (!isnan(effect->mean))
        fprintf(out, "%s,%s,%s,,%.9g,,,,,%s\r\n", name_of(of), place_names[of->place], name,
                effect->mean, neph_ablation_verdict_words[effect->verdict]);
    for (int scene = 0; scene < ablation->params.scene_count; scene++)
        if (!isnan(effect->scenes[scene]))
            fprintf(out, "%s,%s,%s,\"%s\",%.9g,,,,,\r\n", name_of(of), place_names[of->place], name,
                    ablation->study.scenes[scene].name, effect->scenes[scene]);
}

enum neph_status neph_ablation_csv(const struct neph_ablation *ablation, char **text,
                                   struct neph_diag *diag)
{
    size_t size;
    FILE *out;
    const enum neph_status status = open_text(text, &size, &out, diag);
    if (status)
        return status;
    fputs("part,place,measure,scene,decades,low,high,p,p_holm,verdict\r\n", out);
    for (int c = 0; c < ablation->comparison_count; c++)
        for (int m = 0; neph_ablation_measures[m].name; m++)
            print_csv(ablation, &ablation->comparisons[c], m, out);
    return close_text(out, text, diag);
}

/* ---- JSON ------------------------------------------------------------------------------------ */

static json_t *scenes_json(const struct neph_ablation *ablation,
                           const struct neph_ablation_effect *effect)
{
    json_t *scenes = json_object();
    for (int scene = 0; scene < ablation->params.scene_count; scene++)
        if (!isnan(effect->scenes[scene]))
            neph_json_set(&scenes, ablation->study.scenes[scene].name,
                          json_real(effect->scenes[scene]));
    return scenes;
}

static json_t *effect_json(const struct neph_ablation *ablation,
                           const struct neph_ablation_comparison *of, int measure)
{
    const struct neph_ablation_effect *effect = &of->effects[measure];
    return json_pack(
        "{s:s, s:s, s:o, s:o, s:f, s:f, s:i, s:i, s:i, s:s, s:o}", "place", place_names[of->place],
        "measure", neph_ablation_measures[measure].name, "decades", neph_json_number(effect->mean),
        "interval",
        effect->has_interval ? json_pack("[f,f]", effect->low, effect->high) : json_null(), "p",
        effect->p, "p_holm", effect->p_holm, "better", effect->better, "worse", effect->worse,
        "alike", effect->alike, "verdict", neph_ablation_verdict_words[effect->verdict], "scenes",
        scenes_json(ablation, effect));
}

static json_t *effects_json(const struct neph_ablation *ablation, int part)
{
    json_t *list = json_array();
    for (int place = 0; place < NEPH_ABLATION_PLACES; place++) {
        const struct neph_ablation_comparison *of = neph_ablation_find(
            ablation, part, (enum neph_ablation_place)place);
        for (int m = 0; of && neph_ablation_measures[m].name; m++)
            if (neph_ablation_has_measure(ablation, m))
                neph_json_add(&list, effect_json(ablation, of, m));
    }
    return list;
}

static json_t *sentence_json(const struct neph_ablation *ablation,
                             const struct neph_ablation_comparison *of)
{
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return NULL;
    neph_ablation_sentence(ablation, of, out);
    json_t *sentence = fclose(out) == 0 ? json_string(text) : NULL;
    free(text);
    return sentence;
}

static json_t *part_json(const struct neph_ablation *ablation, int part)
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
    neph_json_set(&json, "verdict", sentence_json(ablation, in_preset));
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
    for (int i = 0; i < ablation->params.scene_count; i++)
        if (ablation->study.scenes[i].left_out)
            neph_json_set(&scenes, ablation->study.scenes[i].name,
                          json_string(ablation->study.scenes[i].left_out));
    return scenes;
}

json_t *neph_ablation_json(const struct neph_ablation *ablation)
{
    const struct neph_flicker_study_params *params = &ablation->params;
    json_t *parts = json_array();
    for (int i = 0; neph_ablation_parts[i].name; i++)
        neph_json_add(&parts, part_json(ablation, i));
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
