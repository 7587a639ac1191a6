/* SPDX-License-Identifier: MIT
 *
 * The summary lines of `neph pick`.
 */
#include "harness/sweep/pick_answer.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

/* Fails to compile when a measure is added, as the lines of a preset list all of them. */
_Static_assert(NEPH_CHOICE_NUMBERS == 6, "a new kind");

enum { TEXT_SIZE = 256, VARIANT_LINES = 3, RIVAL_LINES = 4 };

static void append(char text[TEXT_SIZE], const char *format, ...)
    __attribute__((format(printf, 2, 3)));
static void append(char text[TEXT_SIZE], const char *format, ...)
{
    const size_t used = strlen(text);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text + used, TEXT_SIZE - used, format, arguments);
    va_end(arguments);
}

/* ---- a configuration ------------------------------------------------------------------------- */

/* "error 0.83 %, flicker 0.4 of the threshold, 1.2 density evaluations a pixel, 12 ms" */
static const char *format_point_values(const struct neph_pick_point *point, char text[TEXT_SIZE])
{
    text[0] = '\0';
    append(text, "error %.3g %%", 100.0 * point->error);
    if (!isnan(point->error_floor))
        append(text, " (floor %.3g %%)", 100.0 * point->error_floor);
    if (isnan(point->flicker))
        append(text, ", flicker not measured");
    else
        append(text, ", flicker %.3g of the threshold", point->flicker);
    if (!isnan(point->flicker_floor))
        append(text, " (floor %.3g)", point->flicker_floor);
    if (point->is_closed)
        append(text, ", no marched samples");
    else if (isnan(point->evaluations))
        append(text, ", density evaluations not counted");
    else
        append(text, ", %.3g density evaluations per pixel", point->evaluations);
    if (!isnan(point->time.median))
        append(text, ", %.3g ms a frame", 1e3 * point->time.median);
    return text;
}

static const char *format_limits(const struct neph_pick_params *params, char text[TEXT_SIZE])
{
    text[0] = '\0';
    if (!isnan(params->error))
        append(text, "error %.3g %%", 100.0 * params->error);
    if (!isnan(params->flicker))
        append(text, "%sflicker %.3g", text[0] ? ", " : "", params->flicker);
    if (!isnan(params->time_s))
        append(text, "%s%.3g ms", text[0] ? ", " : "", 1e3 * params->time_s);
    return text;
}

/* Adds lines for parts that the measurements decided about. */
static void answer_variants(const struct neph_pick *pick, struct neph_answer *answer)
{
    int lines = 0;
    for (int i = 0; i < pick->left_out_count && lines < VARIANT_LINES; i++) {
        const struct neph_pick_variant *left = &pick->left_out[i];
        char numbers[TEXT_SIZE];
        if (left->because || isnan(left->with.error))
            continue;
        neph_answer_add(answer, "%s %s: %s", left->is_kept ? "without" : "with", left->what,
                        format_point_values(&left->with, numbers));
        lines++;
    }
}

void neph_pick_answer(const struct neph_pick_params *params, const struct neph_pick *pick,
                      const char *config, struct neph_answer *answer)
{
    char numbers[TEXT_SIZE], asked[TEXT_SIZE];
    const bool is_uncertain = !isnan(params->error) && pick->floor > 0.5 * params->error;
    if (pick->found)
        neph_answer_add(answer, "%s: %s; the cheapest of %d configurations within %s",
                        pick->chosen.name, format_point_values(&pick->chosen, numbers),
                        pick->candidate_total, format_limits(params, asked));
    else
        neph_answer_add(answer,
                        "nothing is good enough for %s: the best of %d configurations is "
                        "%s: %s",
                        format_limits(params, asked), pick->candidate_total, pick->chosen.name,
                        format_point_values(&pick->chosen, numbers));
    neph_answer_add(answer, "neph render %s --config %s", params->scene, config);
    answer_variants(pick, answer);
    neph_answer_add(answer, "truth: %s with a noise of %.2g %%%s; %d x %d pixels; %s", pick->truth,
                    100.0 * pick->floor,
                    is_uncertain ? ", more than half of the requested error: the error is uncertain"
                                 : "",
                    params->width_px, params->height_px, pick->device);
}

/* ---- a preset -------------------------------------------------------------------------------- */

static const char *format_levels(const struct neph_choice *choice, int candidate,
                                 char text[TEXT_SIZE])
{
    text[0] = '\0';
    for (int n = 0; n < NEPH_CHOICE_NUMBERS; n++) {
        const struct neph_choice_candidate *of = &choice->candidates[candidate];
        if (isnan(of->levels[n]))
            continue;
        append(text, "%s%s %.3g", text[0] ? ", " : "", neph_choice_measures[n].name, of->levels[n]);
        if (!isnan(of->floors[n]))
            append(text, " (floor %.3g)", of->floors[n]);
    }
    return text;
}

/* "flicker 0.81 times (0.7 to 0.95), better" */
static void append_pair(const char *name, const struct neph_study_pair *pair, char text[TEXT_SIZE])
{
    char interval[NEPH_ANSWER_INTERVAL_SIZE];
    if (isnan(pair->mean))
        return;
    append(text, "%s%s %.3g times%s, %s", text[0] ? "; " : "", name, pow(10.0, pair->mean),
           pair->has_interval
               ? neph_answer_interval(pow(10.0, pair->low), pow(10.0, pair->high), interval)
               : "",
           neph_answer_difference_word(pair->has_interval ? pair->low : NAN,
                                       pair->has_interval ? pair->high : NAN));
}

/* Adds the difference of the choice from another candidate. */
static enum neph_status answer_rival(const struct neph_choice *choice,
                                     const struct neph_flicker_study *study, int rival,
                                     struct neph_answer *answer, struct neph_diag *diag)
{
    char text[TEXT_SIZE] = "";
    enum neph_status status = NEPH_OK;
    for (int n = 0; n < NEPH_CHOICE_WORK && !status; n++) {
        const struct neph_choice_measure *of = &neph_choice_measures[n];
        struct neph_study_pair pair;
        status = neph_study_pair(study, neph_study_metric_find(of->metric, of->mask), 0,
                                 choice->nearest, rival, &pair, diag);
        if (!status)
            append_pair(of->name, &pair, text);
    }
    neph_answer_add(answer, "over %s: %s", study->params->presets[rival],
                    text[0] ? text : "no scene has both");
    return status;
}

static void answer_chosen(const struct neph_choice *choice, const struct neph_flicker_study *study,
                          struct neph_answer *answer)
{
    char numbers[TEXT_SIZE];
    const struct neph_flicker_study_params *params = study->params;
    const char *name = params->presets[choice->nearest];
    format_levels(choice, choice->nearest, numbers);
    if (choice->scene_counts[choice->least] == 0)
        neph_answer_add(answer, "no choice: no scene has '%s' of all presets",
                        neph_choice_measures[choice->least].name);
    else
        neph_answer_add(answer, "%s%s%s: %s; %d presets over %d scenes and %d seed%s",
                        choice->chosen >= 0 ? "" : "nothing is good enough: the nearest is ", name,
                        choice->chosen >= 0 ? " is the choice" : "", numbers, params->preset_count,
                        params->scene_count, params->seed_count,
                        params->seed_count == 1 ? "" : "s");
}

enum neph_status neph_choice_answer(const struct neph_choice *choice,
                                    const struct neph_flicker_study *study, const char *config,
                                    struct neph_answer *answer, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    answer_chosen(choice, study, answer);
    neph_answer_add(answer, "neph render SCENE --config %s", config);
    for (int i = 0, lines = 0; i < choice->candidate_count && lines < RIVAL_LINES && !status; i++) {
        if (i == choice->nearest)
            continue;
        status = answer_rival(choice, study, i, answer, diag);
        lines++;
    }
    return status;
}
