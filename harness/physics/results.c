/* SPDX-License-Identifier: MIT */
#include "harness/physics/results.h"

#include "base/doubt.h"
#include "harness/document/table.h"

#include <math.h>
#include <stdio.h>

/* Compiles only when this file handles every verdict. */
_Static_assert(NEPH_PHYSICS_VERDICT_COUNT == 3, "a new kind");

void neph_physics_finish(struct neph_physics *physics)
{
    neph_arena_finish(&physics->arena);
    *physics = (struct neph_physics){.expected = 0};
}

static const char *const verdict_names[] = {[NEPH_PHYSICS_NOT_MEASURED] = "not_measured",
                                            [NEPH_PHYSICS_AGREES] = "agrees",
                                            [NEPH_PHYSICS_OFF] = "off"};

/* ---- JSON ------------------------------------------------------------------------------------ */

/* The texts before the first NULL. */
static json_t *texts_json(const char *const texts[NEPH_CHECK_VIEWS_MAX])
{
    json_t *list = json_array();
    for (int v = 0; v < NEPH_CHECK_VIEWS_MAX && texts[v]; v++)
        neph_json_add(&list, json_string(texts[v]));
    return list;
}

static json_t *row_json(const struct neph_physics_row *row)
{
    const bool has_interval = row->verdict != NEPH_PHYSICS_NOT_MEASURED;
    return json_pack(
        "{s:s, s:s, s:s, s:s, s:s, s:s, s:s, s:b, s:b, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:s?, "
        "s:f, s:f, s:o, s:o, s:o, s:o, s:o, s:s, s:s, s:o}",
        "check", row->check->name, "rung", row->check->rung, "participant", row->participant->name,
        "engine", row->engine->name, "status", neph_outcome_name(row->outcome), "reason",
        row->reason, "settings", row->settings, "lowered", row->lowered, "look", row->engine->look,
        "deviation", neph_json_number(row->deviation), "standard_error",
        neph_json_number(row->standard_error), "doubt", neph_json_number(row->doubt), "step_bound",
        neph_json_number(row->step_bound), "z", neph_json_number(row->z), "pixel_z_mean",
        neph_json_number(row->pixel_z_mean), "pixel_z_variance",
        neph_json_number(row->pixel_z_variance), "cause", row->cause, "rounding",
        row->participant->rounding, "wall_s", row->wall_s, "exr", texts_json(row->paths),
        "pictures", texts_json(row->pictures), "differences", texts_json(row->differences), "bake",
        row->bakes ? neph_bakes_summary_json(row->bakes) : json_null(), "study",
        row->study ? neph_study_json(row->study) : json_null(), "verdict",
        verdict_names[row->verdict], "sentence", row->sentence, "interval",
        has_interval ? json_pack("[f,f]", row->low, row->high) : json_null());
}

static json_t *check_json(const struct neph_physics_check *check)
{
    json_t *views = json_array();
    for (int v = 0; v < check->view_count; v++) {
        const struct neph_physics_view *view = &check->views[v];
        neph_json_add(&views, json_pack("{s:s, s:[i,i], s:f, s:f, s:s?}", "what", view->what,
                                        "size_px", view->width_px, view->height_px, "exposure_ev",
                                        view->exposure_ev, "difference_scale",
                                        view->difference_scale, "picture", view->picture));
    }
    return json_pack("{s:s, s:s, s:s, s:o}", "name", check->name, "rung", check->rung, "what",
                     check->what, "views", views);
}

static json_t *phase_json(const struct neph_phase_finding *found)
{
    return json_pack("{s:s, s:f, s:f, s:f, s:f, s:s}", "phase", neph_phase_words[found->phase.kind],
                     "g", found->phase.g, "integral", found->integral, "mean_cosine",
                     found->mean_cosine, "sampled_mean_cosine", found->sampled_mean_cosine,
                     "verdict", found->agrees ? "agrees" : "off");
}

static json_t *rungs_json(void)
{
    json_t *list = json_array();
    for (int i = 0; i < NEPH_CHECK_RUNGS; i++)
        neph_json_add(&list, json_pack("{s:s, s:s}", "name", neph_check_rungs[i].name, "title",
                                       neph_check_rungs[i].title));
    return list;
}

json_t *neph_physics_json(const struct neph_physics *physics)
{
    json_t *phases = json_array(), *checks = json_array(), *rows = json_array();
    for (int i = 0; i < physics->phase_count; i++)
        neph_json_add(&phases, phase_json(&physics->phases[i]));
    for (int i = 0; i < physics->check_count; i++)
        neph_json_add(&checks, check_json(&physics->checks[i]));
    for (int i = 0; i < physics->row_count; i++)
        neph_json_add(&rows, row_json(&physics->rows[i]));
    return json_pack(
        "{s:f, s:i, s:f, s:s, s:{s:i, s:i, s:i}, s:f, s:o, s:o, s:o, s:o}", "family_alpha",
        NEPH_PHYSICS_FAMILY_ALPHA, "tests", physics->tests, "critical_z", physics->critical_z,
        "verdict", physics->passes ? "pass" : "fail", "counts", "expected", physics->expected,
        "reported", physics->row_count, "compared", physics->tests, "seconds", physics->seconds,
        "rungs", rungs_json(), "phase_functions", phases, "checks", checks, "rows", rows);
}

/* ---- for a terminal -------------------------------------------------------------------------- */

/* Infinite numbers are printed as missing. */
static void add_number(struct neph_table *table, double value)
{
    neph_table_number(table, isfinite(value) ? value : NAN);
}

static void fill_rows(const struct neph_physics *physics, struct neph_table *table)
{
    const struct neph_column columns[] = {
        {NULL, "check", .width = -22},
        {NULL, "participant", .width = -14},
        {NULL, "outcome", .width = -9},
        {NULL, "deviation", "%+.3e", .width = 11},
        {NULL, "error", "%.1e", .width = 10},
        {NULL, "z", "%+.2f", .width = 8},
        {.title = " verdict"},
    };
    neph_table_columns(table, columns, sizeof(columns) / sizeof(columns[0]));
    for (int i = 0; i < physics->row_count; i++) {
        const struct neph_physics_row *row = &physics->rows[i];
        neph_table_word(table, row->check->name);
        neph_table_word(table, row->participant->name);
        neph_table_word(table, neph_outcome_name(row->outcome));
        add_number(table, row->deviation);
        add_number(table, isfinite(row->standard_error) ? row->standard_error : row->step_bound);
        add_number(table, row->z);
        neph_table_word(table, "");
        neph_table_shown(table, " %s%s", verdict_names[row->verdict],
                         row->lowered ? " (single scattering only)" : "");
    }
}

void neph_physics_print(const struct neph_physics *physics, FILE *out)
{
    struct neph_table table = {.cells = NULL};
    fprintf(out, "%-64s %8s %14s %14s %14s  %s\n", "phase function", "cosine", "integral - 1",
            "cosine - g", "sampled - g", "verdict");
    for (int i = 0; i < physics->phase_count; i++) {
        const struct neph_phase_finding *found = &physics->phases[i];
        const double mean = neph_phase_mean_cosine(&found->phase);
        char name[128];
        neph_phase_describe(&found->phase, name, sizeof(name));
        fprintf(out, "%-64s %8.3f %+14.1e %+14.1e %+14.1e  %s\n", name, mean, found->integral - 1.0,
                found->mean_cosine - mean, found->sampled_mean_cosine - mean,
                found->agrees ? "agrees" : "off");
    }
    fill_rows(physics, &table);
    neph_table_print_aligned(&table, out);
    neph_table_finish(&table);
    for (int i = 0; i < physics->row_count; i++)
        if (physics->rows[i].verdict == NEPH_PHYSICS_OFF || physics->rows[i].doubt > NEPH_DOUBTFUL)
            fprintf(out, "%s: %s\n", physics->rows[i].check->name, physics->rows[i].sentence);
}
