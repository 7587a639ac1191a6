/* SPDX-License-Identifier: MIT */
#include "harness/night/lost.h"

#include "harness/night/environment.h"
#include "harness/night/judge.h"
#include "harness/night/plan.h"
#include "harness/run/record.h"

#include <stdlib.h>
#include <string.h>

const int neph_lost_after_nights = NEPH_JUDGE_WINDOW;
const char neph_as_accepted[] = ", as accepted";

struct search {
    struct neph_database *index;
    int64_t night, against, baseline;
    const struct neph_night_scope *scope;
    struct neph_arena *arena;
    const char **tonight; /* sorted names; of the arena */
    int tonight_count;
    struct neph_lost_list *lost;
    int room;
    bool of_plan; /* use only numbers of this run's own steps, without those of the accepted
                     versions of edited scenes */
};

/* Acceptances "a" that count for series ?1 in run ?2. */
#define COUNTED                                                                                    \
    "a.series IN ('*', ?1) AND a.night < ?2 AND a.night IN (SELECT id FROM nights) AND NOT "       \
    "(a.series = '*' AND EXISTS (SELECT 1 FROM steps AS t WHERE t.night = a.night AND t.outcome "  \
    "!= 'done' AND t.name IN (SELECT step FROM measurements WHERE series = (SELECT id FROM "       \
    "series WHERE name = ?1))))"

enum neph_status neph_accepted_night(struct neph_database *index, int64_t night, int64_t against,
                                     const char *series, int64_t *accepted, struct neph_diag *diag)
{
    if (against > 0) {
        *accepted = against;
        return NEPH_OK;
    }
    *accepted = 0;
    return neph_database_count(index, accepted, diag,
                               "SELECT a.night FROM acceptances AS a WHERE " COUNTED
                               " ORDER BY a.id DESC LIMIT 1",
                               "si", series, night);
}

enum neph_status neph_accepted_night_in(struct neph_database *index, int64_t night,
                                        const char *series, const char *environment,
                                        int64_t *accepted, struct neph_diag *diag)
{
    int64_t last = 0, same = 0;
    struct neph_query *query = neph_query(
        index, diag,
        "SELECT a.night, m.environment, m.night IS NOT NULL FROM acceptances AS a LEFT JOIN "
        "measurements AS m ON m.night = a.night AND m.series = (SELECT id FROM series WHERE name "
        "= ?1) WHERE " COUNTED " ORDER BY a.id DESC",
        "si", series, night);
    for (bool measured = true; same == 0 && measured && neph_query_next(query);) {
        measured = neph_query_integer(query, 2) != 0; /* else it was accepted as lost */
        last = last ? last : neph_query_integer(query, 0);
        if (measured && neph_is_same_environment(neph_query_text(query, 1), environment))
            same = neph_query_integer(query, 0);
    }
    const enum neph_status status = neph_query_end(query, NEPH_OK);
    if (!status)
        *accepted = same ? same : last;
    return status;
}

/* ---- names ----------------------------------------------------------------------------------- */

static int by_name(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

static enum neph_status read_tonight(struct search *search, struct neph_diag *diag)
{
    struct neph_records names;
    const enum neph_status status = neph_record_select(
        search->index, search->arena, &neph_record_text_form, &names, diag,
        "SELECT name FROM measurements JOIN series ON series.id = series "
        "WHERE night = ? AND NOT (? AND instr(step, ?)) ORDER BY name",
        "iis", search->night, (int64_t)search->of_plan, neph_as_accepted);
    search->tonight = names.list;
    search->tonight_count = names.count;
    return status;
}

static bool is_measured_tonight(const struct search *search, const char *name)
{
    return search->tonight_count > 0 &&
           bsearch(&name, search->tonight, (size_t)search->tonight_count, sizeof(name), by_name);
}

/* Split "catalog/fog@15da7c6d/march/..." into the part before the hash, the hash, and the rest. */
static bool split(const char *name, size_t *head, const char **hash, const char **rest)
{
    const char *at = strchr(name, '@');
    *rest = at ? strchr(at, '/') : NULL;
    *hash = at;
    *head = at ? (size_t)(at - name) : 0;
    return *rest != NULL;
}

/* A series of this run that replaces `name`: the same series of another version of the scene; with
 * `of_version` any series of the same version under another name or in another suite. NULL:
 * none. */
static const char *find_other(const struct search *search, const char *name, bool of_version)
{
    size_t head, other_head;
    const char *hash, *rest, *other_hash, *other_rest;
    for (int i = 0; split(name, &head, &hash, &rest) && i < search->tonight_count; i++) {
        const char *other = search->tonight[i];
        if (split(other, &other_head, &other_hash, &other_rest) &&
            (of_version ? strcmp(hash, other_hash) == 0
                        : strncmp(other, name, head + 1) == 0 && other_head == head &&
                              strcmp(rest, other_rest) == 0))
            return other;
    }
    return NULL;
}

/* ---- lost series ----------------------------------------------------------------------------- */

/* A baseline series that this run has not measured. */
struct absent {
    const char *name, *step;
    int64_t accepted, last; /* number of the baseline run, and of the last run that measured it */
    bool is_timed;
};

/* `*expected` is false when the baseline run of the series has not measured it. */
static enum neph_status read_absent(const struct search *search, const char *name,
                                    struct absent *absent, bool *expected, struct neph_diag *diag)
{
    *absent = (struct absent){.name = name};
    *expected = false;
    const enum neph_status status = neph_accepted_night(
        search->index, search->night, search->against, name, &absent->accepted, diag);
    if (status)
        return status;
    struct neph_query *query = neph_query(
        search->index, diag,
        "SELECT step, kind, (SELECT max(night) FROM measurements AS n WHERE n.series = "
        "m.series AND n.night < ?) FROM measurements AS m WHERE night = ? AND series = (SELECT "
        "id FROM series WHERE name = ?)",
        "iis", search->night, absent->accepted, name);
    if (neph_query_next(query)) {
        const char *step = neph_query_text(query, 0), *end = strstr(step, neph_as_accepted);
        /* Acceptance of an edit ends the comparison with the version before it. */
        *expected = !end || absent->accepted != search->baseline;
        absent->step = end ? neph_arena_format(search->arena, "%.*s", (int)(end - step), step)
                           : neph_arena_copy_text(search->arena, step);
        absent->is_timed = strcmp(neph_query_text(query, 1),
                                  neph_series_rule(NEPH_SERIES_TIMED)->word) == 0;
        absent->last = neph_query_integer(query, 2);
    }
    return neph_query_end(query, NEPH_OK);
}

/* The state of a step in this run. */
struct step_state {
    bool is_there, is_done, is_calibrated;
};

static enum neph_status read_step(const struct search *search, const char *name,
                                  struct step_state *state, struct neph_diag *diag)
{
    *state = (struct step_state){false, false, false};
    struct neph_query *query = neph_query(
        search->index, diag,
        "SELECT outcome = 'done', calibration_s IS NOT NULL "
        "FROM steps WHERE night = ? AND name = ? AND outcome != 'not run'",
        "is", search->night, name);
    if (neph_query_next(query))
        *state = (struct step_state){true, neph_query_integer(query, 0) != 0,
                                     neph_query_integer(query, 1) != 0};
    return neph_query_end(query, NEPH_OK);
}

static bool is_planned(const struct neph_night_scope *scope, const char *step)
{
    bool planned = !scope || !scope->planned;
    for (int i = 0; !planned && i < scope->planned_count; i++)
        planned = strcmp(scope->planned[i], step) == 0;
    return planned;
}

static bool is_step_selected(const struct neph_night_scope *scope, const char *step)
{
    bool asked = !scope || scope->only_count == 0;
    for (int i = 0; !asked && i < scope->only_count; i++)
        asked = neph_night_is_named(step, scope->only[i]);
    return asked;
}

static enum neph_status add(struct search *search, const struct absent *absent, enum neph_loss loss,
                            const char *other, struct neph_diag *diag)
{
    struct neph_lost_list *lost = search->lost;
    struct neph_lost_series *grown = neph_arena_grow_list(search->arena, lost->list, lost->count,
                                                          &search->room, sizeof(*grown));
    if (!grown)
        return neph_fail_memory(diag);
    lost->list = grown;
    lost->list[lost->count++] = (struct neph_lost_series){
        absent->name, absent->step, loss, absent->accepted, search->night - absent->last, other};
    lost->left_out += loss == NEPH_LOSS_STEP && absent->accepted == search->baseline;
    return NEPH_OK;
}

/* `*accepted` is true when the series that replaces an edited one was accepted by its own name. */
static enum neph_status is_accepted(const struct search *search, const char *name, bool *accepted,
                                    struct neph_diag *diag)
{
    int64_t night = 0, count = 0;
    enum neph_status status = neph_accepted_night(search->index, search->night, search->against,
                                                  name, &night, diag);
    if (!status)
        status = neph_database_count(search->index, &count, diag,
                                     "SELECT count(*) FROM measurements WHERE night = ? AND series "
                                     "= (SELECT id FROM series WHERE name = ?)",
                                     "is", night, name);
    *accepted = count > 0;
    return status;
}

/* This run has also rendered the accepted version of an edited scene. A number that is absent there
 * is missing, not merely edited. Durations of accepted versions are not measured. */
static enum neph_status classify_edited(struct search *search, const struct absent *absent,
                                        const char *successor, struct neph_diag *diag)
{
    bool accepted = false;
    struct step_state again;
    const char *step = neph_arena_format(search->arena, "%s%s", absent->step, neph_as_accepted);
    enum neph_status status = is_accepted(search, successor, &accepted, diag);
    if (!status)
        status = read_step(search, step, &again, diag);
    if (status || accepted)
        return status;
    if (again.is_done && !absent->is_timed && !search->of_plan)
        return add(search, absent, NEPH_LOSS_SERIES, NULL, diag);
    return add(search, absent, NEPH_LOSS_EDITED, successor, diag);
}

static enum neph_status classify(struct search *search, const struct absent *absent,
                                 struct neph_diag *diag)
{
    struct step_state step;
    const char *successor = find_other(search, absent->name, false);
    const enum neph_status status = read_step(search, absent->step, &step, diag);
    if (status || (step.is_there && !step.is_done))
        return status; /* a failed step is reported once, by itself */
    if (successor)
        return classify_edited(search, absent, successor, diag);
    if (step.is_done && (!absent->is_timed || step.is_calibrated))
        return add(search, absent, NEPH_LOSS_SERIES, NULL, diag);
    if (!step.is_there && !is_step_selected(search->scope, absent->step))
        return NEPH_OK;
    if (!step.is_there && !is_planned(search->scope, absent->step))
        return add(search, absent, NEPH_LOSS_STEP, find_other(search, absent->name, true), diag);
    return search->night - absent->last > neph_lost_after_nights
               ? add(search, absent, NEPH_LOSS_OVERDUE, NULL, diag)
               : NEPH_OK;
}

static enum neph_status check_expected_series(struct search *search, const char *name,
                                              struct neph_diag *diag)
{
    struct absent absent;
    bool expected = false;
    const enum neph_status status = read_absent(search, name, &absent, &expected, diag);
    return status || !expected ? status : classify(search, &absent, diag);
}

/* Check three groups of series: in the baseline run; accepted by name after it; and of steps that
 * the baseline run had not finished, for which an earlier acceptance counts. */
static enum neph_status list_expected(struct search *search, struct neph_diag *diag)
{
    struct neph_records names;
    enum neph_status status = neph_record_select(
        search->index, search->arena, &neph_record_text_form, &names, diag,
        "SELECT name FROM measurements AS m JOIN series ON series.id = m.series WHERE m.night = ? "
        "UNION SELECT series FROM acceptances WHERE ? = 0 AND night < ? AND series != '*' AND id > "
        "(SELECT coalesce(max(id), 0) FROM acceptances WHERE series = '*' AND night < ? AND night "
        "IN (SELECT id FROM nights)) UNION SELECT name FROM measurements AS m JOIN series ON "
        "series.id = m.series WHERE ? = 0 AND m.night IN (SELECT night FROM acceptances WHERE "
        "series = '*' AND night < ?) AND m.step IN (SELECT name FROM steps WHERE night = ? AND "
        "outcome != 'done') ORDER BY 1",
        "iiiiiii", search->baseline, search->against, search->night, search->night, search->against,
        search->night, search->baseline);
    const char *const *list = names.list;
    for (int i = 0; i < names.count && !status; i++)
        if (!is_measured_tonight(search, list[i]))
            status = check_expected_series(search, list[i], diag);
    return status ? status : neph_arena_check(search->arena, diag);
}

static enum neph_status run(struct search *search, struct neph_diag *diag)
{
    *search->lost = (struct neph_lost_list){.count = 0};
    enum neph_status status = neph_accepted_night(search->index, search->night, search->against,
                                                  "*", &search->baseline, diag);
    if (!status)
        status = read_tonight(search, diag);
    if (!status)
        status = list_expected(search, diag);
    return status;
}

enum neph_status neph_lost_find(struct neph_database *index, int64_t night, int64_t against,
                                const struct neph_night_scope *scope, struct neph_arena *arena,
                                struct neph_lost_list *lost, struct neph_diag *diag)
{
    struct search search = {.index = index,
                            .night = night,
                            .against = against,
                            .scope = scope,
                            .arena = arena,
                            .lost = lost};
    return run(&search, diag);
}

/* ---- edits ----------------------------------------------------------------------------------- */

/* "catalog/fog@15da7c6d": suite, scene and version in the name of a series. */
static const char *format_scene_version(struct neph_arena *arena, const char *series)
{
    size_t head;
    const char *hash, *rest;
    split(series, &head, &hash, &rest);
    return neph_arena_format(arena, "%.*s", (int)(rest - series), series);
}

enum neph_status neph_lost_edits(struct neph_database *index, int64_t night, int64_t against,
                                 struct neph_arena *arena, struct neph_night_edit **edits,
                                 int *count, struct neph_diag *diag)
{
    struct neph_lost_list lost;
    struct search search = {.index = index,
                            .night = night,
                            .against = against,
                            .arena = arena,
                            .lost = &lost,
                            .of_plan = true};
    const enum neph_status status = run(&search, diag);
    struct neph_night_edit *made =
        status ? NULL : neph_arena_allocate(arena, (size_t)lost.count + 1, sizeof(*made));
    if (!made)
        return status ? status : neph_fail_memory(diag);
    *count = 0;
    for (int i = 0; i < lost.count; i++) {
        const struct neph_lost_series *s = &lost.list[i];
        int at = 0;
        while (at < *count &&
               (strcmp(made[at].step, s->step) != 0 || made[at].accepted != s->accepted))
            at++;
        if (s->loss != NEPH_LOSS_EDITED)
            continue;
        if (at == (*count))
            made[(*count)++] = (struct neph_night_edit){
                .step = s->step,
                .before = format_scene_version(arena, s->name),
                .after = format_scene_version(arena, s->other),
                .accepted = s->accepted};
        made[at].count++;
    }
    *edits = made;
    return neph_arena_check(arena, diag);
}
