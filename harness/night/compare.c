/* SPDX-License-Identifier: MIT */
#include "harness/night/compare.h"

#include "harness/night/environment.h"
#include "harness/night/readers.h"

#include <math.h>
#include <string.h>

/* Compiles only when this file handles every kind. */
_Static_assert(NEPH_FOUND_COUNT == 14, "a new kind");
_Static_assert(NEPH_JUDGED_COUNT == 5, "a new kind");

/* One number of this run, with the earlier numbers that it is compared with. */
struct candidate {
    const char *name, *step, *environment;
    bool is_picture;
    int64_t accepted; /* number of the baseline run; 0: none */
    struct neph_series series;
    double *past, *errors; /* allocated in the arena, as is `aside` */
    bool *aside;
    bool was_measured;               /* by the baseline run */
    const char *other_environment;   /* the baseline run's environment, if different */
    double other_value, other_error; /* the baseline's number in that environment */
    bool other_size;
};

struct work {
    struct neph_database *index;
    struct neph_night_comparison *comparison;
    struct candidate *candidates;
    int count;
    int64_t against;
    double alpha;
    const struct neph_night_scope *scope; /* NULL: the whole plan */
};

/* ---- findings -------------------------------------------------------------------------------- */

static void report_finding(struct work *work, enum neph_found found, const char *series,
                           const char *step, const char *words)
{
    const struct neph_finding finding = neph_finding(found, series, step, words);
    neph_night_add_finding(work->comparison, &finding);
}

/* Add a finding that the page illustrates by the series `example` ("": none) and compares with the
 * run `accepted`. */
static void report_finding_with_example(struct work *work, enum neph_found found,
                                        const char *series, const char *step, const char *words,
                                        const char *example, int64_t accepted)
{
    struct neph_finding finding = neph_finding(found, series, step, words);
    finding.example = example;
    finding.accepted = accepted;
    neph_night_add_finding(work->comparison, &finding);
}

static void report_number(struct work *work, enum neph_found found, const struct candidate *c,
                          const char *words, const struct neph_judgement *j)
{
    struct neph_finding finding = neph_finding(found, c->name, c->step, words);
    finding.tonight = c->series.tonight;
    finding.baseline = j->baseline;
    finding.change = j->change;
    finding.p = j->p;
    finding.floor = j->floor;
    finding.standard_error = c->series.standard_error;
    finding.example = c->name;
    finding.accepted = c->accepted;
    neph_night_add_finding(work->comparison, &finding);
}

/* ---- reading --------------------------------------------------------------------------------- */

static enum neph_status read_accepted_night(struct work *work, const char *series, int64_t *night,
                                            struct neph_diag *diag)
{
    return neph_accepted_night(work->index, work->comparison->night, work->against, series, night,
                               diag);
}

/* A number in the database. */
struct row {
    const char *name, *step, *kind, *environment;
    double value, standard_error;
};
#define ROW(member) NEPH_RECORD_FIELD(struct row, member)
static const struct neph_record_form row_form = {
    sizeof(struct row),
    {ROW(name), ROW(step), ROW(kind), ROW(value), ROW(standard_error), ROW(environment)}};

static void take_row(struct neph_arena *arena, const struct row *row, struct candidate *c)
{
    const struct neph_night_name parts = neph_night_split(arena, row->name);
    const struct neph_night_metric *metric = neph_night_metric(parts.metric);
    *c = (struct candidate){
        .name = row->name,
        .step = row->step,
        .environment = row->environment,
        .is_picture = strcmp(row->kind, NEPH_NIGHT_PICTURE) == 0,
        .series = {.name = row->name,
                   .engine = parts.engine,
                   .metric = parts.metric,
                   .truth = parts.truth[0] ? parts.truth : NULL,
                   /* Engines of one version and device are one program. */
                   .family = neph_arena_format(arena, "%.*s", (int)strcspn(row->environment, ";"),
                                               row->environment),
                   .kind = neph_find_series_kind(row->kind),
                   .is_signed = metric->is_signed,
                   .unit = metric->unit,
                   .tonight = row->value,
                   .standard_error = row->standard_error}};
}

static enum neph_status read_candidates(struct work *work, struct neph_diag *diag)
{
    struct neph_arena *arena = &work->comparison->arena;
    struct neph_records rows;
    const enum neph_status status = neph_record_select(
        work->index, arena, &row_form, &rows, diag,
        "SELECT name, step, kind, value, standard_error, environment FROM "
        "measurements JOIN series ON series.id = series WHERE night = ? "
        "ORDER BY name",
        "i", work->comparison->night);
    const struct row *list = rows.list;
    work->candidates = neph_arena_allocate(arena, (size_t)rows.count + 1,
                                           sizeof(*work->candidates));
    for (; work->candidates && work->count < rows.count; work->count++)
        take_row(arena, &list[work->count], &work->candidates[work->count]);
    return status ? status : neph_arena_check(arena, diag);
}

/* The kind of the baseline run applies, so that a program cannot weaken its test by declaring a
 * fixed number as drawn. */
static void take_accepted_kind(struct candidate *c, const char *word)
{
    const enum neph_series_kind kind = neph_find_series_kind(word);
    if (!c->is_picture && kind < NEPH_SERIES_KINDS)
        c->series.kind = kind;
}

/* Read the earlier numbers of a candidate: one element for its baseline run and for each run after
 * the overall baseline; NaN for a run without the number. All series thus cover the same runs, as
 * means over scenes require. */
static enum neph_status read_past(struct work *work, struct candidate *c, struct neph_diag *diag)
{
    struct neph_arena *arena = &work->comparison->arena;
    int64_t nights = 0;
    const enum neph_status status = neph_database_count(
        work->index, &nights, diag,
        "SELECT count(*) FROM nights WHERE ended_utc != '' AND (id = ? OR id > max(?, ?)) AND id < "
        "?",
        "iiii", c->accepted, c->accepted, work->comparison->baseline, work->comparison->night);
    if (status)
        return status;
    const size_t count = (size_t)nights + 1;
    c->past = neph_arena_allocate(arena, count, sizeof(*c->past));
    c->errors = neph_arena_allocate(arena, count, sizeof(*c->errors));
    c->aside = neph_arena_allocate(arena, count, sizeof(*c->aside));
    if (!c->past || !c->errors || !c->aside)
        return neph_fail_memory(diag);
    struct neph_query *query = neph_query(
        work->index, diag,
        "SELECT m.value, m.standard_error, m.environment, m.judgement, m.night IS NOT NULL, "
        "m.kind FROM "
        "nights LEFT JOIN measurements AS m ON m.night = nights.id AND m.series = (SELECT id "
        "FROM series WHERE name = ?) WHERE ended_utc != '' AND (nights.id = ? OR nights.id > "
        "max(?, ?)) AND nights.id < ? ORDER BY nights.id",
        "siiii", c->name, c->accepted, c->accepted, work->comparison->baseline,
        work->comparison->night);
    int at = 0;
    for (; at < nights && neph_query_next(query); at++) {
        const bool is_there = neph_query_integer(query, 4) != 0;
        const bool same = is_there &&
                          neph_is_same_environment(neph_query_text(query, 2), c->environment);
        c->past[at] = same ? neph_query_real(query, 0) : NAN;
        c->errors[at] = same ? neph_query_real(query, 1) : NAN;
        c->aside[at] = neph_query_text(query, 3)[0] != '\0';
        if (at == 0) {
            c->was_measured = is_there;
            c->other_environment = is_there && !same
                                       ? neph_arena_copy_text(arena, neph_query_text(query, 2))
                                       : NULL;
            c->aside[0] = false; /* accepted by the user, changed or not */
            c->other_value = neph_query_real(query, 0);
            c->other_error = neph_query_real(query, 1);
            take_accepted_kind(c, neph_query_text(query, 5));
        }
    }
    c->series.past = c->past;
    c->series.past_errors = c->errors;
    c->series.set_aside = c->aside;
    c->series.past_count = at;
    return neph_query_end(query, NEPH_OK);
}

static enum neph_status compare_sizes(struct work *work, struct candidate *c,
                                      struct neph_diag *diag)
{
    int64_t other = 0;
    const enum neph_status status = neph_database_count(
        work->index, &other, diag,
        "SELECT count(*) FROM steps AS a JOIN steps AS b ON a.name = b.name WHERE a.name = ? AND "
        "a.night = ? AND b.night = ? AND a.size != b.size",
        "sii", c->step, c->accepted, work->comparison->night);
    c->other_size = other > 0;
    return status;
}

static enum neph_status check_against(struct work *work, struct neph_diag *diag)
{
    bool has = true;
    enum neph_status status = NEPH_OK;
    if (work->against > 0)
        status = neph_history_has(work->index, work->against, &has, diag);
    return status || has
               ? status
               : neph_fail(diag, NEPH_ERR_NOT_FOUND, "there is no finished nightly run %lld",
                           (long long)work->against);
}

static enum neph_status read_all(struct work *work, struct neph_diag *diag)
{
    enum neph_status status = read_accepted_night(work, "*", &work->comparison->baseline, diag);
    if (!status)
        status = read_candidates(work, diag);
    for (int i = 0; i < work->count && !status; i++) {
        struct candidate *c = &work->candidates[i];
        c->accepted = work->against;
        if (work->against == 0)
            status = neph_accepted_night_in(work->index, work->comparison->night, c->name,
                                            c->environment, &c->accepted, diag);
        if (!status && c->accepted > 0)
            status = read_past(work, c, diag);
        if (!status && c->accepted > 0)
            status = compare_sizes(work, c, diag);
    }
    return status;
}

/* ---- findings that are not about a number ---------------------------------------------------- */

static enum neph_status report_failed_steps(struct work *work, struct neph_diag *diag)
{
    struct neph_arena *arena = &work->comparison->arena;
    struct neph_records rows;
    const enum neph_status status = neph_record_select(
        work->index, arena, &neph_history_step_form, &rows, diag,
        "SELECT name, outcome, reason, size, wall_s, calibration_s FROM steps WHERE night = ? AND "
        "outcome NOT IN ('done', 'not run')",
        "i", work->comparison->night);
    const struct neph_history_step *steps = rows.list;
    for (int i = 0; i < rows.count; i++)
        report_finding(work, NEPH_FOUND_STEP, steps[i].name, steps[i].name,
                       neph_arena_format(arena, "%s: %s", steps[i].outcome, steps[i].reason));
    return status;
}

static const char *format_loss(struct neph_arena *arena, const struct neph_lost_series *lost)
{
    switch (lost->loss) {
    case NEPH_LOSS_STEP:
        return lost->other
                   ? neph_arena_format(arena,
                                       "the accepted run measured it, but this run's plan has no "
                                       "step '%s'; this run measures the same scene as '%s'",
                                       lost->step, lost->other)
                   : neph_arena_format(
                         arena,
                         "the accepted run measured it, but this run's plan has no step '%s'",
                         lost->step);
    case NEPH_LOSS_SERIES:
        return "the accepted run measured it, and this run did not";
    case NEPH_LOSS_OVERDUE:
        return neph_arena_format(arena, "the last %lld runs did not measure it",
                                 (long long)lost->nights);
    case NEPH_LOSS_EDITED:
        break; /* reported once for the scene, by report_edited_scenes() */
    }
    return NULL;
}

static enum neph_status report_missing_series(struct work *work, struct neph_diag *diag)
{
    struct neph_night_comparison *comparison = work->comparison;
    struct neph_lost_list lost;
    int64_t not_run = 0;
    enum neph_status status = neph_lost_find(work->index, comparison->night, work->against,
                                             work->scope, &comparison->arena, &lost, diag);
    for (int i = 0; i < lost.count && !status; i++) {
        const struct neph_lost_series *s = &lost.list[i];
        const char *words = format_loss(&comparison->arena, s);
        if (words)
            report_finding_with_example(
                work, s->loss == NEPH_LOSS_SERIES ? NEPH_FOUND_MISSING : NEPH_FOUND_LOST, s->name,
                s->step, words, s->name, s->accepted);
    }
    if (!status)
        status = neph_database_count(
            work->index, &not_run, diag,
            "SELECT count(*) FROM measurements WHERE night = ? AND NOT instr(step, ?) AND step NOT "
            "IN (SELECT name FROM steps WHERE night = ?)",
            "isi", comparison->baseline, neph_as_accepted, comparison->night);
    comparison->not_run = (int)not_run - lost.left_out;
    return status;
}

/* The result of rendering the accepted version of an edited scene. */
static const char *find_edit_text(const struct work *work, const struct neph_night_edit *edit)
{
    for (int i = 0; work->scope && i < work->scope->edit_count; i++) {
        const struct neph_night_edit *done = &work->scope->edits[i];
        if (strcmp(done->step, edit->step) == 0 && done->accepted == edit->accepted && done->words)
            return done->words;
    }
    return "the accepted version was not rendered once more";
}

static enum neph_status report_edited_scenes(struct work *work, struct neph_diag *diag)
{
    struct neph_arena *arena = &work->comparison->arena;
    struct neph_night_edit *edits = NULL;
    int count = 0;
    const enum neph_status status = neph_lost_edits(work->index, work->comparison->night,
                                                    work->against, arena, &edits, &count, diag);
    for (int i = 0; i < count && !status; i++)
        report_finding_with_example(
            work, NEPH_FOUND_EDITED, edits[i].before, edits[i].step,
            neph_arena_format(arena, "its scene was edited, and %d numbers belong to %s: %s",
                              edits[i].count, edits[i].after, find_edit_text(work, &edits[i])),
            "", edits[i].accepted);
    return status;
}

/* True when the scene's terms equal the terms in the baseline run of its gates. Gates may have been
 * accepted separately from other series. */
static enum neph_status are_terms_accepted(struct work *work, const char *step, const char *version,
                                           const char *terms, bool *accepted,
                                           struct neph_diag *diag)
{
    int64_t night = 0, count = 0;
    const char *gates = neph_arena_format(&work->comparison->arena, "%s/all/gates failed", version);
    enum neph_status status = read_accepted_night(work, gates, &night, diag);
    if (!status)
        status = neph_database_count(
            work->index, &count, diag,
            "SELECT count(*) FROM night_scenes WHERE night = ? AND step = ? AND terms = ?", "iss",
            night, step, terms);
    *accepted = count > 0;
    return status;
}

/* Report changed terms: gates, exposure and the like are not in the scene's hash, so they start no
 * new series. */
static enum neph_status report_changed_terms(struct work *work, struct neph_diag *diag)
{
    struct neph_arena *arena = &work->comparison->arena;
    struct neph_records rows;
    enum neph_status status = neph_record_select(
        work->index, arena, &neph_history_scene_form, &rows, diag,
        "SELECT t.step, t.scene, t.hash, t.terms FROM night_scenes AS t JOIN night_scenes AS b ON "
        "b.step = t.step WHERE t.night = ? AND b.night = ? AND b.hash = t.hash AND b.terms != "
        "t.terms ORDER BY t.step",
        "ii", work->comparison->night, work->comparison->baseline);
    for (int i = 0; i < rows.count && !status; i++) {
        const struct neph_history_scene *s = (const struct neph_history_scene *)rows.list + i;
        const char *version = neph_arena_format(arena, "%.*s/%s@%.8s", (int)strcspn(s->step, " "),
                                                s->step, s->scene, s->hash);
        bool accepted = false;
        status = are_terms_accepted(work, s->step, version, s->terms, &accepted, diag);
        if (!status && !accepted)
            report_finding_with_example(
                work, NEPH_FOUND_EDITED, version, s->step,
                "its gates, its exposure or its measurements over time were edited", "",
                work->comparison->baseline);
    }
    return status;
}

/* A changed size is reported once for each step. */
static bool is_first_in_step(const struct work *work, int at)
{
    for (int i = 0; i < at; i++)
        if (work->candidates[i].other_size &&
            strcmp(work->candidates[i].step, work->candidates[at].step) == 0)
            return false;
    return true;
}

static void report_changed_frames(struct work *work)
{
    for (int i = 0; i < work->count; i++) {
        const struct candidate *c = &work->candidates[i];
        if (c->other_size && is_first_in_step(work, i))
            report_finding(work, NEPH_FOUND_SIZE, c->step, c->step,
                           "its frames differ in size from the frames of the accepted run");
        const double before = c->other_environment ? c->other_value : c->past ? c->past[0] : NAN;
        if (c->is_picture && c->series.past_count > 0 && before > 0.0 && !(c->series.tonight > 0.0))
            report_finding_with_example(
                work, NEPH_FOUND_BLANK, c->name, c->step,
                c->series.tonight < 0.0
                    ? "it has pixels that are not numbers, and had none in the accepted run"
                    : "all its pixels are equal, and they were not in the accepted run",
                c->name, c->accepted);
    }
}

/* ---- texts of findings ----------------------------------------------------------------------- */

/* "+3.00 %"; "+3.00 % of 0.001" when the baseline is smaller than its unit; "by 3.00 % further from
 * 0" for a signed number. */
static const char *format_relative_change(struct neph_arena *arena, const struct candidate *c,
                                          const struct neph_judgement *j)
{
    const bool of_unit = c->series.kind != NEPH_SERIES_TIMED && fabs(j->baseline) < c->series.unit;
    const char *of = of_unit ? neph_arena_format(arena, " of %g", c->series.unit) : "";
    if (!c->series.is_signed)
        return neph_arena_format(arena, "%+.2f %%%s", 100.0 * j->change, of);
    const bool nearer = fabs(c->series.tonight) < fabs(j->baseline);
    return neph_arena_format(arena, "by %.2f %%%s %s 0", 100.0 * fabs(j->change), of,
                             nearer ? "nearer to" : "further from");
}

static const char *format_judgement(struct neph_arena *arena, const struct candidate *c,
                                    const struct neph_judgement *j)
{
    const char *unit = c->series.kind == NEPH_SERIES_TIMED ? " of the calibration" : "",
               *chance = j->p > 0.0 ? neph_arena_format(arena, ", p %.1g", j->p) : "";
    return neph_arena_format(arena, "%.6g%s, accepted %.6g: %s%s", c->series.tonight, unit,
                             j->baseline, format_relative_change(arena, c, j), chance);
}

/* ---- another environment --------------------------------------------------------------------- */

/* A number that is worse in another environment fails the run: a raised version must not hide a
 * regression. */
static void compare_environments(struct work *work, const struct candidate *c)
{
    struct neph_arena *arena = &work->comparison->arena;
    struct neph_judgement change;
    if (c->is_picture ||
        !neph_is_worse_elsewhere(&c->series, c->environment, c->other_value, c->other_error,
                                 c->other_environment, work->alpha, &change))
        return;
    const char *words = neph_arena_format(arena, "%s; another environment: %s, accepted was %s",
                                          format_judgement(arena, c, &change), c->environment,
                                          c->other_environment);
    change.p = NAN;
    report_number(work, NEPH_FOUND_WORSE_ELSEWHERE, c, words, &change);
}

/* Report a number that has not been comparable for more than neph_lost_after_nights runs. */
static void report_overdue(struct work *work, const struct candidate *c)
{
    int last = c->series.past_count - 1;
    while (last > 0 && !isfinite(c->past[last]))
        last--;
    const int nights = c->series.past_count - last;
    if (c->other_environment && nights > neph_lost_after_nights)
        report_finding_with_example(
            work, NEPH_FOUND_LOST, c->name, c->step,
            neph_arena_format(&work->comparison->arena,
                              "the last %d runs did not compare it: %s, accepted was %s", nights,
                              c->environment, c->other_environment),
            c->name, c->accepted);
}

static void compare_all_environments(struct work *work)
{
    for (int i = 0; i < work->count; i++) {
        const struct candidate *c = &work->candidates[i];
        if (!c->other_environment || c->other_size)
            continue;
        compare_environments(work, c);
        report_overdue(work, c);
    }
}

/* ---- numbers --------------------------------------------------------------------------------- */

/* The reason why a number is not judged; NULL: it is judged. */
static const char *explain_no_judgement(struct neph_night_comparison *comparison,
                                        const struct candidate *c)
{
    if (c->accepted == 0 || !c->was_measured) {
        comparison->fresh++;
        return "new: not in an accepted run";
    }
    if (c->other_size)
        return "another size";
    if (c->other_environment) {
        comparison->elsewhere++;
        return neph_arena_format(&comparison->arena,
                                 "another environment: %s; no run of it is accepted, the last "
                                 "accepted was %s",
                                 c->environment, c->other_environment);
    }
    return NULL;
}

static const enum neph_found found_of[] = {
    [NEPH_JUDGED_NOT] = NEPH_FOUND_COUNT,   [NEPH_JUDGED_SAME] = NEPH_FOUND_COUNT,
    [NEPH_JUDGED_MOVED] = NEPH_FOUND_MOVED, [NEPH_JUDGED_BETTER] = NEPH_FOUND_BETTER,
    [NEPH_JUDGED_WORSE] = NEPH_FOUND_WORSE,
};

static void take_judgement(struct work *work, const struct candidate *c,
                           const struct neph_judgement *j, struct neph_compared *row)
{
    struct neph_night_comparison *comparison = work->comparison;
    row->judgement = *j;
    if (j->judged == NEPH_JUDGED_NOT) {
        comparison->young++;
        row->why = neph_arena_format(&comparison->arena, "%d of %d runs", j->nights,
                                     neph_series_rule(c->series.kind)->nights);
    }
    if (found_of[j->judged] != NEPH_FOUND_COUNT)
        report_number(work, found_of[j->judged], c, format_judgement(&comparison->arena, c, j), j);
}

/* The scene with the largest change; the first one of equals. */
static const struct neph_series *find_largest_change(const struct neph_series *series, int count,
                                                     const struct neph_pool *pool,
                                                     const struct neph_verdicts *verdicts)
{
    int most = -1;
    for (int i = 0; i < count; i++)
        if (neph_pool_has(pool, &series[i]) && isfinite(verdicts->series[i].change) &&
            (most < 0 || fabs(verdicts->series[i].change) > fabs(verdicts->series[most].change)))
            most = i;
    return most < 0 ? NULL : &series[most];
}

static void take_pool(struct work *work, const struct neph_pool *pool,
                      const struct neph_series *series, int count,
                      const struct neph_verdicts *verdicts)
{
    struct neph_arena *arena = &work->comparison->arena;
    const struct neph_judgement *j = &pool->judgement;
    const struct neph_series *example = find_largest_change(series, count, pool, verdicts);
    struct neph_finding finding = neph_finding(
        found_of[j->judged],
        neph_arena_format(arena, "%s, %s, mean of %d scenes", pool->engine, pool->metric,
                          pool->scenes),
        "", neph_arena_format(arena, "%+.2f %%, p %.1g", 100.0 * j->change, j->p));
    finding.change = j->change;
    finding.p = j->p;
    finding.floor = j->floor;
    finding.example = example ? example->name : "";
    finding.accepted = work->comparison->baseline;
    finding.trend = neph_arena_copy(arena, pool->nights,
                                    (size_t)pool->night_count * sizeof(*pool->nights));
    finding.trend_count = pool->night_count;
    neph_night_add_finding(work->comparison, &finding);
}

static void take_pools(struct work *work, const struct neph_series *series, int count,
                       const struct neph_verdicts *verdicts)
{
    struct neph_arena *arena = &work->comparison->arena;
    for (int i = 0; i < verdicts->pool_count; i++)
        if (found_of[verdicts->pools[i].judgement.judged] != NEPH_FOUND_COUNT)
            take_pool(work, &verdicts->pools[i], series, count, verdicts);
    for (int i = 0; i < verdicts->stale_count; i++) {
        const struct neph_stale *stale = &verdicts->stale[i];
        report_finding(
            work, NEPH_FOUND_STALE, stale->truth, "",
            neph_arena_format(
                arena,
                "%d of %d series against %s moved, of %d independent renderers: check %s first",
                stale->moved, stale->all, stale->truth, stale->families, stale->truth));
    }
}

/* Report each changed environment once, with the number of its series. */
static void report_environments(struct work *work)
{
    struct neph_arena *arena = &work->comparison->arena;
    for (int i = 0; i < work->count; i++) {
        const struct candidate *c = &work->candidates[i];
        int before = 0, all = 0;
        for (int k = 0; c->other_environment && k < work->count; k++) {
            const struct candidate *other = &work->candidates[k];
            const bool same = other->other_environment &&
                              strcmp(other->other_environment, c->other_environment) == 0 &&
                              strcmp(other->environment, c->environment) == 0;
            before += same && k < i;
            all += same;
        }
        if (c->other_environment && before == 0)
            report_finding(work, NEPH_FOUND_ENVIRONMENT, c->environment, "",
                           neph_arena_format(arena,
                                             "%d series are not compared: no run of this "
                                             "environment is accepted, the last accepted was %s",
                                             all, c->other_environment));
    }
}

/* Collect the series to judge. rows[i] is the index of series[i] in the comparison. */
static int choose_judged(struct work *work, struct neph_series *series, int *rows)
{
    int count = 0;
    for (int i = 0; i < work->count; i++) {
        const struct candidate *c = &work->candidates[i];
        struct neph_compared *row = &work->comparison->series[i];
        *row = (struct neph_compared){
            .series = c->name,
            .step = c->step,
            .why = c->is_picture ? "a picture" : explain_no_judgement(work->comparison, c),
            .tonight = c->series.tonight,
            .judgement = {NEPH_JUDGED_NOT, NAN, NAN, NAN, NAN, 0}};
        if (row->why)
            continue;
        row->why = "";
        series[count] = c->series;
        rows[count++] = i;
    }
    return count;
}

static enum neph_status judge_numbers(struct work *work, struct neph_diag *diag)
{
    struct neph_night_comparison *comparison = work->comparison;
    const size_t room = (size_t)work->count + 1;
    struct neph_verdicts verdicts;
    struct neph_series *series = neph_arena_allocate(&comparison->arena, room, sizeof(*series));
    int *rows = neph_arena_allocate(&comparison->arena, room, sizeof(*rows));
    comparison->series = neph_arena_allocate(&comparison->arena, room, sizeof(*comparison->series));
    if (!series || !rows || !comparison->series)
        return neph_fail_memory(diag);
    const int count = choose_judged(work, series, rows);
    const enum neph_status status = neph_judge(series, count, work->alpha, &verdicts, diag);
    if (status)
        return status;
    comparison->series_count = work->count;
    comparison->compared = verdicts.compared;
    comparison->chances = verdicts.chances;
    for (int i = 0; i < count; i++)
        take_judgement(work, &work->candidates[rows[i]], &verdicts.series[i],
                       &comparison->series[rows[i]]);
    take_pools(work, series, count, &verdicts);
    neph_verdicts_finish(&verdicts);
    return NEPH_OK;
}

/* ---- all ------------------------------------------------------------------------------------- */

enum neph_status neph_night_compare(struct neph_database *index, int64_t night, int64_t against,
                                    const struct neph_night_scope *scope, double alpha,
                                    struct neph_night_comparison *comparison,
                                    struct neph_diag *diag)
{
    static enum neph_status (*const parts[])(struct work *, struct neph_diag *) = {
        check_against,         read_all,
        judge_numbers,         report_failed_steps,
        report_missing_series, report_edited_scenes,
        report_changed_terms};
    struct work work = {index, comparison, NULL, 0, against, alpha, scope};
    enum neph_status status = NEPH_OK;
    comparison->night = night;
    for (size_t i = 0; i < sizeof(parts) / sizeof(parts[0]) && !status; i++)
        status = parts[i](&work, diag);
    if (status)
        return status;
    compare_all_environments(&work);
    report_changed_frames(&work);
    report_environments(&work);
    neph_night_settle(comparison);
    return neph_arena_check(&comparison->arena, diag);
}
