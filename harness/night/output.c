/* SPDX-License-Identifier: MIT */
#include "harness/night/output.h"

#include "base/files.h"
#include "base/path.h"
#include "base/written.h"
#include "harness/document/junit.h"
#include "harness/json_file.h"
#include "harness/night/readers.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TOLD = 3 }; /* findings in the paragraph */

/* ---- growing text ---------------------------------------------------------------------------- */

/* The context of the printing functions: a run, and the name of a step or tier. */
struct printed {
    const struct neph_night *night;
    const char *word;
};

static int count_found(const struct neph_night *night, enum neph_found found)
{
    int count = 0;
    for (int i = 0; i < night->comparison.finding_count; i++)
        count += night->comparison.findings[i].found == found;
    return count;
}

/* Prints the command that renders a step's numbers again; nothing for an unknown step ("" of a
 * finding over several steps). */
static void print_command(const struct neph_night *night, const char *step, FILE *out)
{
    const struct neph_night_step *s = neph_night_plan_find(&night->plan, step);
    if (s)
        fputs("neph", out);
    for (int w = 0; s && s->words[w]; w++)
        fprintf(out, " %s", s->words[w]);
}

static void write_command(const void *given, FILE *out)
{
    const struct printed *printed = given;
    print_command(printed->night, printed->word, out);
}

enum neph_status neph_night_command(const struct neph_night *night, const char *step, char **text,
                                    struct neph_diag *diag)
{
    const struct printed printed = {night, step};
    return neph_write_to_text(write_command, &printed, text, diag);
}

static void print_counts(const struct neph_night *night, FILE *out)
{
    const struct neph_night_comparison *c = &night->comparison;
    fprintf(out, " %d comparisons", c->compared);
    if (c->baseline > 0)
        fprintf(out, " with run %lld", (long long)c->baseline);
    fprintf(out, ", %d of them with chance in them;", c->chances);
    for (int found = 0; found < NEPH_FOUND_COUNT; found++) {
        const int count = count_found(night, (enum neph_found)found);
        if (count > 0)
            fprintf(out, " %d %s,", count, neph_found_word((enum neph_found)found));
    }
    fprintf(out, " %d new, %d of another environment, %d with too few runs, %d not run.", c->fresh,
            c->elsewhere, c->young, c->not_run);
    fprintf(out, " Steps: %d of %d, %d once more, in %.1f min.", night->done_count,
            night->plan.count, night->again_count, night->seconds / 60.0);
}

/* Reasons of steps that are done: some of their numbers are not used. */
static void print_reasons(const struct neph_night *night, FILE *out)
{
    for (int i = 0; i < night->plan.count; i++) {
        const struct neph_night_outcome *outcome = &night->outcomes[i];
        if (outcome->outcome && strcmp(outcome->outcome, "done") == 0 && outcome->reason[0])
            fprintf(out, " %s: %s.", night->plan.steps[i].name, outcome->reason);
    }
}

static void print_findings(const struct neph_night *night, FILE *out)
{
    const struct neph_night_comparison *c = &night->comparison;
    for (int i = 0; i < c->finding_count && i < TOLD; i++) {
        const struct neph_finding *f = &c->findings[i];
        fprintf(out, " %s: %s: %s", neph_found_word(f->found), f->series, f->words);
        if (i == 0 && neph_night_plan_find(&night->plan, f->step)) {
            fputs("; again: ", out);
            print_command(night, f->step, out);
        }
        fputc('.', out);
    }
    if (c->finding_count > TOLD)
        fprintf(out, " And %d more, in nightly.json.", c->finding_count - TOLD);
    if (c->baseline == 0)
        fprintf(out, " No run was accepted yet: check this one, and then `neph baseline accept "
                     "--why TEXT`.");
}

static void print_summary(const void *given, FILE *out)
{
    const struct neph_night *night = ((const struct printed *)given)->night;
    fprintf(out, "Night %lld (%s%s%s, %s) %s.", (long long)night->id,
            ((const struct printed *)given)->word, night->revision[0] ? ", " : "", night->revision,
            night->host, neph_night_verdict(&night->comparison).verb);
    print_counts(night, out);
    print_reasons(night, out);
    print_findings(night, out);
    fputc('\n', out);
}

enum neph_status neph_night_summary(const struct neph_night *night, const char *tier, char **text,
                                    struct neph_diag *diag)
{
    const struct printed printed = {night, tier};
    return neph_write_to_text(print_summary, &printed, text, diag);
}

/* ---- JSON ------------------------------------------------------------------------------------ */

/* This run's number of a series' floor; NaN: the series has no floor. */
static double find_floor(const struct neph_night_comparison *c, const char *series)
{
    const size_t length = strlen(series);
    for (int i = 0; i < c->series_count; i++)
        if (strncmp(c->series[i].series, series, length) == 0 &&
            strcmp(&c->series[i].series[length], NEPH_NIGHT_FLOOR) == 0)
            return c->series[i].tonight;
    return NAN;
}

/* A number over its floor; NaN where there is no ratio. */
static double divide_by_floor(double tonight, double floor)
{
    return floor > 0.0 ? tonight / floor : NAN;
}

static json_t *finding_json(const struct neph_night_comparison *c, const struct neph_finding *f)
{
    const double floor = find_floor(c, f->series);
    return json_pack("{s:s, s:b, s:s, s:s, s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:s, s:I}",
                     "found", neph_found_word(f->found), "fails", neph_found_fails(f->found),
                     "series", f->series, "step", f->step, "words", f->words, "tonight",
                     neph_json_number(f->tonight), "baseline", neph_json_number(f->baseline),
                     "change", neph_json_number(f->change), "p", neph_json_number(f->p), "floor",
                     neph_json_number(f->floor), "preset_floor", neph_json_number(floor),
                     "times_preset_floor", neph_json_number(divide_by_floor(f->tonight, floor)),
                     "example", f->example, "accepted_night", (json_int_t)f->accepted);
}

static json_t *series_json(const struct neph_night_comparison *c, const struct neph_compared *row)
{
    const struct neph_judgement *j = &row->judgement;
    const double floor = find_floor(c, row->series);
    return json_pack("{s:s, s:s, s:s, s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:i}", "series",
                     row->series, "step", row->step, "judged", neph_judged_word(j->judged), "why",
                     row->why, "tonight", neph_json_number(row->tonight), "baseline",
                     neph_json_number(j->baseline), "change", neph_json_number(j->change), "p",
                     neph_json_number(j->p), "floor", neph_json_number(j->floor), "preset_floor",
                     neph_json_number(floor), "times_preset_floor",
                     neph_json_number(divide_by_floor(row->tonight, floor)), "nights", j->nights);
}

static json_t *step_json(const struct neph_night_step *step,
                         const struct neph_night_outcome *outcome)
{
    const char *what = outcome->outcome ? outcome->outcome : "not run";
    char log[NEPH_STEP_LOG_SIZE];
    json_t *words = json_array();
    for (int w = 0; step->words[w]; w++)
        neph_json_add(&words, json_string(step->words[w]));
    neph_night_step_log(step, log);
    return json_pack("{s:s, s:b, s:s, s:s, s:o, s:o}", "name", step->name, "done",
                     strcmp(what, "done") == 0, "outcome", what, "reason",
                     outcome->reason ? outcome->reason : "", "arguments", words, "log",
                     outcome->outcome ? json_sprintf("logs/%s.log", log) : json_null());
}

static json_t *steps_json(const struct neph_night *night)
{
    json_t *list = json_array();
    for (int i = 0; i < night->plan.count; i++)
        neph_json_add(&list, step_json(&night->plan.steps[i], &night->outcomes[i]));
    return list;
}

json_t *neph_night_json(const struct neph_night *night, const char *tier)
{
    const struct neph_night_comparison *c = &night->comparison;
    json_t *findings = json_array(), *series = json_array();
    for (int i = 0; i < c->finding_count; i++)
        neph_json_add(&findings, finding_json(c, &c->findings[i]));
    for (int i = 0; i < c->series_count; i++)
        neph_json_add(&series, series_json(c, &c->series[i]));
    return json_pack("{s:s, s:I, s:I, s:s, s:s, s:s, s:s, s:b, s:b, s:f, s:i, s:i, s:i, s:i, s:i, "
                     "s:i, s:o, s:o, "
                     "s:o}",
                     "format", "neph-nightly-1", "night", (json_int_t)night->id, "baseline",
                     (json_int_t)c->baseline, "tier", tier, "revision", night->revision, "program",
                     night->program, "host", night->host, "resumed", night->resumed, "passes",
                     c->passes, "seconds", night->seconds, "compared", c->compared, "chances",
                     c->chances, "new", c->fresh, "elsewhere", c->elsewhere, "young", c->young,
                     "not_run", c->not_run, "steps", steps_json(night), "findings", findings,
                     "series", series);
}

/* ---- JUnit ----------------------------------------------------------------------------------- */

static const struct neph_finding *find_series_finding(const struct neph_night *night,
                                                      const char *series)
{
    for (int i = 0; i < night->comparison.finding_count; i++)
        if (strcmp(night->comparison.findings[i].series, series) == 0 &&
            neph_found_fails(night->comparison.findings[i].found))
            return &night->comparison.findings[i];
    return NULL;
}

static bool is_compared_series(const struct neph_night *night, const char *name)
{
    for (int i = 0; i < night->comparison.series_count; i++)
        if (strcmp(night->comparison.series[i].series, name) == 0)
            return true;
    return false;
}

/* Findings without a row in the series table: steps, references, missing numbers, means over
 * scenes. */
static void add_others(const struct neph_night *night, struct neph_junit *junit)
{
    for (int i = 0; i < night->comparison.finding_count; i++) {
        const struct neph_finding *f = &night->comparison.findings[i];
        if (neph_found_fails(f->found) && !is_compared_series(night, f->series))
            neph_junit_add(junit, neph_found_word(f->found), f->series, NEPH_JUNIT_FAILED,
                           f->words);
    }
}

static enum neph_status write_junit(const struct neph_night *night, const char *path,
                                    struct neph_diag *diag)
{
    const struct neph_night_comparison *c = &night->comparison;
    struct neph_junit junit = {.name = "neph nightly", .seconds = night->seconds};
    for (int i = 0; i < c->series_count; i++) {
        const struct neph_compared *row = &c->series[i];
        const struct neph_finding *f = find_series_finding(night, row->series);
        const bool skips = !f && row->judgement.judged == NEPH_JUDGED_NOT;
        neph_junit_add(&junit, row->step, row->series,
                       f       ? NEPH_JUNIT_FAILED
                       : skips ? NEPH_JUNIT_SKIPPED
                               : NEPH_JUNIT_PASSED,
                       f ? f->words : row->why);
    }
    add_others(night, &junit);
    if (c->compared == 0)
        neph_junit_add(&junit, "nightly", "something is compared", NEPH_JUNIT_FAILED,
                       "nothing was compared");
    const enum neph_status status = neph_junit_write(&junit, path, diag);
    neph_junit_finish(&junit);
    return status;
}

/* ---- files ----------------------------------------------------------------------------------- */

enum neph_status neph_night_write(const struct neph_night *night, const char *tier,
                                  const char *output, struct neph_diag *diag)
{
    const struct printed printed = {night, tier};
    json_t *json = neph_night_json(night, tier);
    enum neph_status status = neph_json_write(
        json, JSON_INDENT(1), neph_path_in(output, "nightly/nightly.json").text, diag);
    json_decref(json);
    if (!status)
        status = write_junit(night, neph_path_in(output, "nightly/junit.xml").text, diag);
    return status ? status
                  : neph_write_to_file(neph_path_in(output, "nightly/summary.txt").text,
                                       print_summary, &printed, diag);
}
