/* SPDX-License-Identifier: MIT
 *
 * JSON of a sweep, and the command lines of its points.
 */
#include "harness/sweep/output.h"

#include "base/written.h"
#include "harness/engines/engines.h"
#include "harness/engines/non_physical.h"
#include "harness/sweep/equal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Fails to compile when a value is added, as the table of texts needs a row for it. */
_Static_assert(NEPH_SWEEP_NUMBERS == 5, "a new kind");

const struct neph_sweep_number_text neph_sweep_number_texts[NEPH_SWEEP_NUMBERS] = {
    [NEPH_SWEEP_ERROR] = {"error", "relative RMSE of radiance against the truth", "rel_rmse"},
    [NEPH_SWEEP_SHORTCUT] = {"shortcut", "relative RMSE of radiance against its own model",
                             "rel_rmse"},
    [NEPH_SWEEP_FLICKER] = {"flicker", "flicker seen, contrast over threshold", "seen_contrast"},
    [NEPH_SWEEP_FOUR] = {"four", "four-frame flicker, 95th percentile, of white", "a4_p95"},
    [NEPH_SWEEP_HALF_LIFE] = {"half_life", "half-life after a step of the sun [frames]",
                              "half_life_p50"},
};

void neph_sweep_finish(struct neph_sweep *sweep)
{
    for (int i = 0; i < sweep->point_count; i++)
        free(sweep->points[i].settings);
    free(sweep->points);
    free(sweep->infos);
    for (int i = 0; i <= NEPH_SCATTERING_MULTIPLE; i++)
        neph_scene_destroy(sweep->rescattered[i]);
    neph_scene_destroy(sweep->scene);
    *sweep = (struct neph_sweep){.plan = NULL};
}

/* --- command lines -------------------------------------------------------------------------- */

struct swept {
    const struct neph_sweep *sweep;
    const struct neph_sweep_point *point;
};

static void print_command(const void *swept, FILE *out)
{
    const struct neph_sweep *sweep = ((const struct swept *)swept)->sweep;
    const struct neph_sweep_point *point = ((const struct swept *)swept)->point;
    const struct neph_shot *shot = &point->job.shot;
    const struct neph_engine *engine = point->job.engine;
    const char *words = point->series->preset; /* preset words; their changes are printed as
                                                  settings */
    char preset[64] = "";
    fprintf(out, "neph render %s -e %s --size %dx%d", sweep->scene->name, engine->name,
            sweep->plan->width_px, sweep->plan->height_px);
    if (words) {
        snprintf(preset, sizeof(preset), "%.*s", (int)strcspn(words, "+"), words);
        fprintf(out, " --preset %s", preset);
    }
    char *changes = neph_settings_changes(engine, &shot->settings, words ? preset : NULL);
    char *rest = changes;
    for (char *word; (word = strsep(&rest, " "));)
        if (word[0])
            fprintf(out, " -s %s", word);
    free(changes);
    if (shot->scene != sweep->scene)
        fprintf(out, " --scattering %s", neph_scattering_name(shot->scene->scattering));
    if (engine->has_frame_history)
        fprintf(out, " --frames %d", sweep->frame_count);
    else if (sweep->frame > 0)
        fprintf(out, " --frame %d", sweep->frame);
    fprintf(out, " --seed %llu", (unsigned long long)shot->seed);
}

char *neph_sweep_command(const struct neph_sweep *sweep, const struct neph_sweep_point *point)
{
    char *text = NULL;
    neph_write_to_text(print_command, &(struct swept){sweep, point}, &text, NULL);
    return text;
}

const char *neph_sweep_device(const struct neph_sweep *sweep)
{
    for (int i = 0; i < sweep->point_count; i++)
        if (sweep->points[i].job.engine->rung == NEPH_LEVEL_MODEL &&
            !sweep->points[i].job.engine->is_user_engine && !sweep->points[i].missing[0])
            return sweep->points[i].job.info->device;
    return "";
}

int neph_sweep_measured_count(const struct neph_sweep *sweep)
{
    int count = 0;
    for (int i = 0; i < sweep->point_count; i++)
        count += !sweep->points[i].missing[0];
    return count;
}

/* --- JSON ----------------------------------------------------------------------------------- */

static json_t *value_json(const struct neph_sweep_point *point, enum neph_sweep_number number)
{
    const struct neph_sweep_value *value = &point->numbers[number];
    return json_pack("{s:o, s:o, s:o, s:o, s:b}", "value", neph_json_number(value->value), "low",
                     neph_json_number(value->low), "high", neph_json_number(value->high), "floor",
                     neph_json_number(point->floors[number]), "on_front", point->on_front[number]);
}

static json_t *point_json(const struct neph_sweep *sweep, const struct neph_sweep_point *point)
{
    char *command = neph_sweep_command(sweep, point);
    json_t *json = json_pack(
        "{s:s, s:s, s:s, s:s, s:i, s:s, s:o, s:o, s:o, s:i, s:o, s:b, s:b}", "series",
        point->series->name, "label", point->label, "engine", point->job.engine->name, "version",
        point->job.info->version, "place", point->place, "settings", point->settings, "seconds",
        neph_json_number(point->time.median), "seconds_low", neph_json_number(point->time.low),
        "seconds_high", neph_json_number(point->time.high), "pictures", point->timed, "evaluations",
        neph_json_number(point->evaluations), "at_floor", point->at_floor, "look",
        neph_is_non_physical(point->job.engine, &point->job.shot.settings));
    for (int n = 0; n < NEPH_SWEEP_NUMBERS; n++)
        neph_json_set(&json, neph_sweep_number_texts[n].name,
                      value_json(point, (enum neph_sweep_number)n));
    neph_json_set(&json, "to_finest",
                  json_pack("{s:o, s:o, s:o}", "value", neph_json_number(point->to_finest.value),
                            "low", neph_json_number(point->to_finest.low), "high",
                            neph_json_number(point->to_finest.high)));
    neph_json_set(&json, "frame_key", json_string(point->frame_key));
    neph_json_set(&json, "command", command ? json_string(command) : NULL);
    neph_json_set(&json, "missing",
                  point->missing[0] ? neph_json_cleaned(point->missing) : json_null());
    free(command);
    return json;
}

json_t *neph_sweep_json(const struct neph_sweep *sweep)
{
    const struct neph_sweep_plan *plan = sweep->plan;
    json_t *points = json_array();
    for (int i = 0; i < sweep->point_count; i++)
        neph_json_add(&points, point_json(sweep, &sweep->points[i]));
    return json_pack(
        "{s:s, s:s, s:s, s:s, s:i, s:i, s:i, s:i, s:i, s:s, s:o, s:s, s:s, s:i, s:s, s:o, s:i, "
        "s:i, s:o, s:o}",
        "format", "neph-sweep-1", "title", plan->title, "scene", sweep->scene->name, "scene_hash",
        sweep->scene->hash, "width_px", plan->width_px, "height_px", plan->height_px, "frames",
        sweep->frame_count, "warm_up", plan->warm_up, "seeds", plan->seed_count, "truth",
        sweep->truth, "truth_noise", neph_json_number(sweep->floor), "error_mask", sweep->clear_of,
        "flicker_mask", sweep->mask, "frame", sweep->frame, "device", neph_sweep_device(sweep),
        "load", neph_json_number(sweep->load), "measured", neph_sweep_measured_count(sweep),
        "expected", sweep->point_count, "points", points, "equal", neph_sweep_equals_json(sweep));
}
