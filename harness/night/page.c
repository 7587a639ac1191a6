/* SPDX-License-Identifier: MIT */
#include "harness/night/page.h"

#include "base/clock.h"
#include "base/path.h"
#include "harness/data.h"
#include "harness/night/output.h"
#include "harness/night/page_images.h"
#include "harness/night/readers.h"
#include "harness/report/page.h"
#include "harness/report/report_folder.h"
#include "metrics/significance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const struct neph_page_parts parts = {
    .title = "Nephelometer nightly run", .files = {"night.html", "night_accept.js", "night.js"}};

enum {
    TREND_NIGHTS = 60,
    LEAST_NIGHTS = 3 /* least number of runs for an estimate of the spread */
};

struct neph_night_page {
    struct neph_report_folder *folder; /* NULL before the first publication */
    struct neph_store *store;
    const char *output, *tier;
    struct neph_path path;
    size_t limit_bytes;
};

/* The state of one publication. */
struct work {
    struct neph_night_page *page;
    const struct neph_night *night;
    struct neph_database *index;
    struct neph_arena arena;
    struct neph_night_images pictures;
};

/* ---- a series over the runs ------------------------------------------------------------------ */

struct point {
    int64_t night;
    double value, standard_error;
    const char *environment, *judgement;
};
#define POINT(member) NEPH_RECORD_FIELD(struct point, member)
static const struct neph_record_form point_form = {
    sizeof(struct point),
    {POINT(night), NEPH_RECORD_OPTIONAL(struct point, value),
     NEPH_RECORD_OPTIONAL(struct point, standard_error), POINT(environment), POINT(judgement)}};

/* The last TREND_NIGHTS runs, oldest first. */
static enum neph_status read_series_trend(struct work *work, const char *series, json_t **trend,
                                          struct neph_diag *diag)
{
    const enum neph_status status = neph_record_list(
        work->index, &point_form, trend, diag,
        "SELECT * FROM (SELECT night, value, standard_error, environment, judgement FROM "
        "measurements JOIN series ON series.id = series WHERE name = ? AND night <= ? ORDER BY "
        "night DESC LIMIT ?) ORDER BY night",
        "sii", series, work->night->id, (int64_t)TREND_NIGHTS);
    return status ? status : neph_json_check(*trend, diag);
}

static enum neph_status read_mean_trend(struct work *work, const struct neph_finding *f,
                                        json_t **trend, struct neph_diag *diag)
{
    json_t *points = json_array();
    int at = 0;
    struct neph_query *query = neph_query(
        work->index, diag,
        "SELECT id FROM nights WHERE id >= ? AND (ended_utc != '' OR id = ?) AND id <= ? ORDER BY "
        "id",
        "iii", f->accepted, work->night->id, work->night->id);
    while (at < f->trend_count && neph_query_next(query)) {
        const struct point point = {neph_query_integer(query, 0), f->trend[at++], NAN, "", ""};
        neph_json_add(&points, neph_record_json(&point_form, &point));
    }
    const enum neph_status status = neph_query_end(query, neph_json_check(points, diag));
    if (status)
        json_decref(points);
    else
        *trend = points;
    return status;
}

/* The range that contains 95 of 100 unchanged runs: a t interval of the logarithms from the
 * baseline run to the run before this one, without regard to their correlation. JSON null for too
 * few runs. */
static json_t *range_json(const json_t *trend, int64_t accepted, int64_t tonight)
{
    double sum = 0.0, squares = 0.0;
    int count = 0;
    size_t i;
    const json_t *point;
    json_array_foreach(trend, i, point)
    {
        const int64_t night = json_integer_value(json_object_get(point, "night"));
        const double value = neph_json_real(point, "value");
        const bool counts = night >= accepted && night < tonight && value > 0.0 &&
                            !neph_json_text(point, "judgement")[0];
        sum += counts ? log(value) : 0.0;
        squares += counts ? log(value) * log(value) : 0.0;
        count += counts;
    }
    if (count < LEAST_NIGHTS)
        return json_null();
    const double mean = sum / count,
                 variance = fmax(squares - sum * mean, 0.0) / (double)(count - 1),
                 reach = neph_student_critical(0.05, count - 1) *
                         sqrt(variance * (1.0 + 1.0 / count));
    return json_pack("{s:f, s:f, s:i}", "low", exp(mean - reach), "high", exp(mean + reach),
                     "nights", count);
}

static json_t *interval_json(const struct neph_finding *f)
{
    const double reach = neph_normal_critical(0.05) * f->standard_error;
    return isfinite(reach) && isfinite(f->tonight)
               ? json_pack("[f, f]", f->tonight - reach, f->tonight + reach)
               : json_null();
}

/* ---- findings -------------------------------------------------------------------------------- */

static enum neph_status read_frame_key(struct work *work, const char *series, int64_t night,
                                       const char **key, struct neph_diag *diag)
{
    return neph_record_text(work->index, &work->arena, key, diag,
                            "SELECT frame FROM measurements JOIN series ON series.id = series "
                            "WHERE name = ? AND night = ?",
                            "si", series, night);
}

/* A text, or JSON null for "". */
static json_t *word_json(const char *text)
{
    return text[0] ? json_string(text) : json_null();
}

/* Move all members of `more` into `object`; takes ownership of `more`. */
static enum neph_status merge_object(json_t *object, json_t *more, struct neph_diag *diag)
{
    enum neph_status status = neph_json_check(more, diag);
    if (!status && json_object_update(object, more))
        status = neph_fail_memory(diag);
    json_decref(more);
    return status;
}

/* The step of a finding; for a mean over scenes the step of its example. */
static const char *find_finding_step(const struct work *work, const struct neph_finding *f)
{
    const struct neph_night_comparison *c = &work->night->comparison;
    for (int i = 0; !f->step[0] && i < c->series_count; i++)
        if (strcmp(c->series[i].series, f->example) == 0)
            return c->series[i].step;
    return f->step;
}

static enum neph_status set_trend(struct work *work, const struct neph_finding *f, json_t *json,
                                  struct neph_diag *diag)
{
    json_t *trend = NULL;
    const char *kind = "";
    enum neph_status status = f->trend ? read_mean_trend(work, f, &trend, diag)
                                       : read_series_trend(work, f->example, &trend, diag);
    if (!status)
        status = neph_record_text(work->index, &work->arena, &kind, diag,
                                  "SELECT kind FROM measurements JOIN series ON series.id = series "
                                  "WHERE name = ? AND night <= ? ORDER BY night DESC LIMIT 1",
                                  "si", f->example, work->night->id);
    if (!status && (f->trend || strcmp(kind, "timed") == 0))
        status = neph_json_put(json, "range", range_json(trend, f->accepted, work->night->id),
                               diag);
    if (!status)
        status = neph_json_put(json, "kind", word_json(f->trend ? "mean" : kind), diag);
    if (status)
        json_decref(trend);
    return status ? status : neph_json_put(json, "trend", trend, diag);
}

static enum neph_status set_pictures(struct work *work, const struct neph_finding *f,
                                     const char *scene, json_t *json, struct neph_diag *diag)
{
    const char *accepted = "", *tonight = "";
    json_t *shown = NULL;
    enum neph_status status = read_frame_key(work, f->example, work->night->id, &tonight, diag);
    if (!status && f->accepted > 0)
        status = read_frame_key(work, f->example, f->accepted, &accepted, diag);
    if (!status)
        status = neph_night_images_pair(&work->pictures, scene, accepted, tonight, &shown, diag);
    return status ? status : neph_json_put(json, "shown", shown, diag);
}

/* Add the fields that the page shows for a finding and nightly.json does not contain. */
static enum neph_status explain(struct work *work, const struct neph_finding *f, json_t *json,
                                struct neph_diag *diag)
{
    char *command = NULL;
    const struct neph_night_name name = neph_night_split(&work->arena, f->example);
    enum neph_status status = neph_night_command(work->night, find_finding_step(work, f), &command,
                                                 diag);
    if (!status)
        status = merge_object(json,
                              json_pack("{s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "command",
                                        word_json(command), "suite", word_json(name.suite), "scene",
                                        word_json(name.scene), "engine", word_json(name.engine),
                                        "metric", word_json(name.metric), "truth",
                                        word_json(name.truth), "interval", interval_json(f)),
                              diag);
    free(command);
    if (!status)
        status = set_trend(work, f, json, diag);
    return status ? status : set_pictures(work, f, name.scene, json, diag);
}

static enum neph_status explain_all(struct work *work, json_t *document, struct neph_diag *diag)
{
    const struct neph_night_comparison *c = &work->night->comparison;
    json_t *findings = json_object_get(document, "findings");
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < c->finding_count && !status; i++)
        status = explain(work, &c->findings[i], json_array_get(findings, (size_t)i), diag);
    return status;
}

/* ---- scenes ---------------------------------------------------------------------------------- */

static enum neph_status read_frames(struct work *work, json_t *frames, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    struct neph_query *query = neph_query(
        work->index, diag,
        "SELECT name, frame FROM measurements JOIN series ON series.id = series WHERE night = ? "
        "AND frame != '' ORDER BY name",
        "i", work->night->id);
    while (!status && neph_query_next(query)) {
        const struct neph_night_name name = neph_night_split(&work->arena,
                                                             neph_query_text(query, 0));
        const char *of = neph_arena_format(&work->arena, "%s/%s/%s", name.suite, name.scene,
                                           name.engine);
        status = neph_json_put(frames, of, json_string(neph_query_text(query, 1)), diag);
    }
    return neph_query_end(query, status);
}

/* Fill "pictures", the images of this run by SUITE/SCENE/ENGINE, and "scenes", their titles and
 * exposures. */
static enum neph_status draw_scenes(struct work *work, json_t *document, struct neph_diag *diag)
{
    json_t *frames = json_object(), *drawn = json_object();
    const char *of;
    json_t *key;
    enum neph_status status = frames && drawn ? read_frames(work, frames, diag)
                                              : neph_fail_memory(diag);
    json_object_foreach(frames, of, key)
    {
        json_t *picture = NULL;
        const struct neph_night_name name = neph_night_split(&work->arena, of);
        if (!status)
            status = neph_night_images_one(&work->pictures, name.scene, json_string_value(key),
                                           &picture, diag);
        if (!status)
            status = neph_json_put(drawn, of, picture, diag);
    }
    json_decref(frames);
    if (status)
        json_decref(drawn);
    else
        status = neph_json_put(document, "pictures", drawn, diag);
    return status ? status
                  : neph_json_put(document, "scenes", json_incref(work->pictures.scenes), diag);
}

/* ---- the document ---------------------------------------------------------------------------- */

static enum neph_status set_head(const struct work *work, json_t *document, struct neph_diag *diag)
{
    const struct neph_night *night = work->night;
    char created[32], *summary = NULL;
    neph_utc_now(created);
    enum neph_status status = neph_night_summary(night, work->page->tier, &summary, diag);
    if (!status)
        status = merge_object(document,
                              json_pack("{s:s, s:s, s:s, s:s, s:s, s:s, s:o}", "format",
                                        "neph-night-page-1", "output", work->page->output, "state",
                                        night->is_over          ? "finished"
                                        : night->is_interrupted ? "interrupted"
                                                                : "running",
                                        "created_utc", created, "neph_version", NEPH_VERSION,
                                        "summary", summary, "difference_colours",
                                        neph_page_difference_colours()),
                              diag);
    free(summary);
    return status;
}

static enum neph_status fill(struct work *work, json_t *document, struct neph_diag *diag)
{
    enum neph_status status = set_head(work, document, diag);
    if (!status && work->night->is_over)
        status = explain_all(work, document, diag);
    if (!status && work->night->is_over)
        status = draw_scenes(work, document, diag);
    return status ? status
                  : neph_json_put(document, "page",
                                  json_pack("{s:I, s:I, s:i}", "limit_bytes",
                                            (json_int_t)work->page->limit_bytes, "bytes",
                                            (json_int_t)work->pictures.bytes, "left_out",
                                            work->pictures.left_out),
                                  diag);
}

/* ---- the page -------------------------------------------------------------------------------- */

enum neph_status neph_night_page_open(const char *output, const char *tier,
                                      struct neph_store *store, size_t limit_bytes,
                                      struct neph_night_page **page, struct neph_diag *diag)
{
    struct neph_night_page *opened = calloc(1, sizeof(*opened));
    if (!opened)
        return neph_fail_memory(diag);
    *opened = (struct neph_night_page){
        .output = output, .store = store, .tier = tier, .limit_bytes = limit_bytes};
    opened->path = neph_path_in(output, "nightly/report");
    *page = opened;
    return NEPH_OK;
}

void neph_night_page_close(struct neph_night_page *page)
{
    if (!page)
        return;
    neph_report_folder_close(page->folder);
    free(page);
}

/* Created with the first publication, because another nightly run may use the folder before
 * that. */
static enum neph_status create_page_folder(struct neph_night_page *page, struct neph_diag *diag)
{
    if (page->folder)
        return NEPH_OK;
    const enum neph_status status = neph_report_folder_open(page->path.text, &page->folder, diag);
    return status ? status
                  : neph_page_start(neph_report_folder_work(page->folder), &parts, NULL, diag);
}

enum neph_status neph_night_page_publish(const struct neph_night *night, void *page_,
                                         struct neph_diag *diag)
{
    struct work work = {.page = page_, .night = night};
    json_t *document = neph_night_json(night, work.page->tier);
    enum neph_status status = document ? create_page_folder(work.page, diag)
                                       : neph_fail_memory(diag);
    if (!status)
        status = neph_night_images_begin(&work.pictures, work.page->store,
                                         neph_report_folder_work(work.page->folder),
                                         work.page->limit_bytes, diag);
    if (!status)
        status = neph_store_index(work.page->store, &work.index, diag);
    if (!status)
        status = fill(&work, document, diag);
    if (!status)
        status = neph_arena_check(&work.arena, diag);
    if (!status)
        status = neph_page_publish(work.page->folder, "NEPH_NIGHT", document, diag);
    neph_database_close(work.index);
    neph_night_images_end(&work.pictures);
    neph_arena_finish(&work.arena);
    json_decref(document);
    return status;
}
