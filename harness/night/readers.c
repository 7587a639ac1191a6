/* SPDX-License-Identifier: MIT */
#include "harness/night/readers.h"

#include "base/exr.h"
#include "harness/data.h"
#include "harness/engines/engines.h"
#include "harness/run/store.h"
#include "metrics/significance.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Compiles only when this file handles every suite. */
_Static_assert(NEPH_NIGHT_SUITES == 5, "a new kind");

enum { NUMBERS_MAX = 4096 };

/* Smaller values are compared with the unit instead of themselves: an error of 1e-7 may triple for
 * any reason. The first row whose name ends the metric applies. */
static const struct neph_night_metric metrics[] = {
    {"rel_bias", 1e-3, true},     {"deviation", 1e-4, true}, {"gates failed", 1.0, false},
    {"evaluations", 1e-3, false}, {"", 1e-5, false}, /* all others */
};

const struct neph_night_metric *neph_night_metric(const char *metric)
{
    const struct neph_night_metric *row = metrics;
    const size_t length = strlen(metric);
    while (strlen(row->name) > length || strcmp(metric + length - strlen(row->name), row->name))
        row++;
    return row;
}

/* ---- names ----------------------------------------------------------------------------------- */

struct neph_night_name neph_night_split(struct neph_arena *arena, const char *series)
{
    struct neph_night_name name = {"", "", "", "", ""};
    const char **const parts[] = {&name.suite, &name.scene, &name.engine, &name.metric,
                                  &name.truth};
    const char *rest = series;
    for (size_t i = 0; i < sizeof(parts) / sizeof(parts[0]) && rest; i++) {
        const size_t length = strcspn(rest, "/");
        *parts[i] = neph_arena_format(arena, "%.*s", (int)length, rest);
        rest = rest[length] ? rest + length + 1 : NULL;
    }
    return name;
}

/* ---- a document ------------------------------------------------------------------------------ */

enum { LEVELS = 4 };

/* `levels`: the document at index 0, then the current items of the nested lists. */
struct reading {
    enum neph_night_suite suite;
    const json_t *levels[LEVELS];
    double calibration_s;
    const char *host;
    struct neph_arena *arena;
    struct neph_night_numbers *numbers;
    bool overflows; /* more than NUMBERS_MAX numbers */
};

/* Find the value of a path such as "1.frame_s.median", which starts at the item of level 1. NULL:
 * none. */
static const json_t *find(const struct reading *reading, const char *path)
{
    static const char ends[] = ".:?}";
    const json_t *value = reading->levels[*path - '0'];
    while (*++path == '.') {
        char key[64];
        const size_t length = strcspn(++path, ends);
        snprintf(key, sizeof(key), "%.*s", (int)length, path);
        value = json_object_get(value, key);
        path += length - 1;
    }
    return value;
}

static const char *text_or_empty(const json_t *value)
{
    const char *text = json_string_value(value);
    return text ? text : "";
}

/* Version and device of an engine, from the document's list of engines. */
static const char *find_engine_version(const struct reading *reading, const char *engine)
{
    size_t i;
    const json_t *row;
    json_array_foreach(json_object_get(reading->levels[0], "engines"), i, row)
    {
        if (strcmp(neph_json_text(row, "name"), engine) == 0)
            return neph_arena_format(reading->arena, "%s, %s", neph_json_text(row, "version"),
                                     neph_json_text(row, "device"));
    }
    return "";
}

/* Evaluate a value in braces. "{1.hash:8}": its first eight letters. "{1.engine:version}": version
 * and device of the engine. "{; |1.note}": the text before the bar precedes a non-empty value.
 * "{1.truth?none}": "none" replaces an empty value. */
static const char *fill_value(const struct reading *reading, const char *form, size_t length)
{
    const char *bar = memchr(form, '|', length), *path = bar ? bar + 1 : form;
    const char *colon = memchr(form, ':', length), *word = memchr(form, '?', length);
    const char *value = text_or_empty(find(reading, path));
    if (colon && colon[1] == 'v')
        value = find_engine_version(reading, value);
    if (!value[0])
        return word ? neph_arena_format(reading->arena, "%.*s", (int)(form + length - word - 1),
                                        word + 1)
                    : "";
    return neph_arena_format(reading->arena, "%.*s%.*s", bar ? (int)(bar - form) : 0, form,
                             colon && isdigit(colon[1]) ? atoi(colon + 1) : -1, value);
}

/* Evaluate a form: a text with values in braces. NULL gives "". */
static const char *fill(const struct reading *reading, const char *form)
{
    const char *text = "";
    while (form && *form) {
        const size_t plain = strcspn(form, "{"), end = strcspn(form, "}");
        const bool has_value = form[plain] == '{';
        text = neph_arena_format(reading->arena, "%s%.*s%s", text, (int)plain, form,
                                 has_value ? fill_value(reading, &form[plain + 1], end - plain - 1)
                                           : "");
        form += has_value ? end + 1 : plain;
    }
    return text;
}

/* ---- derived values -------------------------------------------------------------------------- */

/* (maximum - minimum) / mean of all values of R, G and B; NaN when the frame cannot be read. A
 * value that is NaN or infinite makes the sum NaN or infinite. */
static double measure_contrast(const struct reading *reading, const json_t *path)
{
    struct neph_image *image = NULL;
    double sum = 0.0, low = INFINITY, high = -INFINITY;
    size_t count = 0;
    (void)reading;
    if (neph_exr_read(text_or_empty(path), &image, NULL))
        return NAN;
    for (int c = 0; c < image->channel_count; c++) {
        const struct neph_channel *channel = &image->channels[c];
        for (size_t p = 0; strchr("RGB", channel->name[0]) && !channel->name[1] &&
                           p < neph_image_pixel_count(image);
             p++, count++) {
            const double value = channel->samples[p];
            sum += value;
            low = fmin(low, value);
            high = fmax(high, value);
        }
    }
    neph_image_destroy(image);
    if (count == 0)
        return NAN;
    if (!isfinite(sum))
        return NEPH_NIGHT_BROKEN_PICTURE;
    return sum > 0.0 ? (high - low) / (sum / (double)count) : 0.0;
}

static double count_failed(const struct reading *reading, const json_t *gates)
{
    size_t i;
    const json_t *gate;
    int failed = 0;
    (void)reading;
    json_array_foreach(gates, i, gate)
        failed += strcmp(neph_json_text(gate, "verdict"), "fail") == 0;
    return failed;
}

static double sum_evaluations(const struct reading *reading, const json_t *passes)
{
    size_t i;
    const json_t *pass;
    double sum = 0.0;
    (void)reading;
    json_array_foreach(passes, i, pass) sum += neph_json_real(pass, "density_evaluations");
    return sum;
}

/* A duration in units of the host's speed: the calibration time, or on a GPU the time of a thousand
 * buffer samples. NaN when the machine was busy. */
static double relative_time(const struct reading *reading, const json_t *row)
{
    const json_t *ceilings = json_object_get(reading->levels[0], "ceilings");
    const bool is_cpu = strstr(neph_json_text(row, "device"), "llvmpipe") != NULL;
    const double unit_s = is_cpu ? reading->calibration_s
                          : isfinite(reading->calibration_s)
                              ? 1e3 / neph_json_real(ceilings, "buffer_samples_per_s")
                              : NAN;
    return neph_json_real(json_object_get(row, "frame_s"), "median") / unit_s;
}

static double number_or_nan(const json_t *value)
{
    return json_is_number(value) ? json_number_value(value) : NAN;
}

/* A standard error, or half the width of a 95 % interval divided by 1.96. NaN: there is none. */
static double error_at(const struct reading *reading, const char *path)
{
    const json_t *error = path ? find(reading, path) : NULL;
    return json_is_array(error) ? (json_number_value(json_array_get(error, 1)) -
                                   json_number_value(json_array_get(error, 0))) /
                                      (2.0 * neph_normal_critical(0.05))
                                : number_or_nan(error);
}

/* Stress test results contain no scene hash, so it is computed from the scene's current file. */
static const char *stress_scene(const struct reading *reading)
{
    struct neph_scene *scene = NULL;
    const char *name = fill(reading, "{1.scene}");
    if (neph_data_load_scene(name, &scene, NULL))
        return name;
    const char *text = neph_arena_format(reading->arena, "%s@%.8s",
                                         fill(reading, "{1.scene}{ |1.point}"), scene->hash);
    neph_scene_destroy(scene);
    return text;
}

/* ---- the numbers of each suite --------------------------------------------------------------- */

/* The measurements of a frame that become series; all are over the whole frame. */
static const char *const rendered[] = {"rendered", NULL};
static const char *const followed[] = {
    "rendered all radiance rel_bias", "rendered all radiance rel_rmse", "rendered all radiance p99",
    "rendered all transmittance max_abs", NULL};

/* Which numbers to read from a list of a suite's document. Texts are forms, see fill(). */
static const struct results {
    enum neph_night_suite suite;
    const char *lists;                /* keys of the nested lists */
    const char *const *only;          /* read items with a `which` of this list; NULL: all */
    const char *which, *scene;        /* scene NULL: stress_scene() */
    const char *engine, *environment; /* the host is appended for durations */
    const char *frame;                /* a store key, or a path in the store */
    struct number {
        /* `kind`: a kind of judge.h, NEPH_NIGHT_PICTURE, or an engine's name; NULL: drawn with a
         * standard error, else fixed. */
        const char *metric, *kind;
        const char *value, *error, *truth; /* value and error: paths; truth: a form; NULL: none */
        double (*measure)(const struct reading *reading, const json_t *value); /* NULL: a number */
    } numbers[6];
} results[] = {
    {NEPH_NIGHT_CATALOG,
     "scenes.frames",
     rendered,
     "{2.status}",
     "{1.name}@{1.hash:8}",
     "{2.engine}",
     "{2.engine:version}{; |2.note}",
     "{2.exr}",
     {{"contrast", NEPH_NIGHT_PICTURE, "2.exr", .measure = measure_contrast}}},
    {NEPH_NIGHT_CATALOG,
     "scenes.frames.measurements",
     followed,
     "{2.status} {3.mask} {3.quantity} {3.metric}",
     "{1.name}@{1.hash:8}",
     "{2.engine}",
     "{2.engine:version}{; |2.note}{; against |1.truth.engine:version}",
     "{2.exr}",
     {{"{3.quantity} {3.metric}", "{2.engine}", "3.value", "3.interval", "{1.truth.engine?none}",
       NULL}}},
    {NEPH_NIGHT_CATALOG,
     "scenes",
     NULL,
     NULL,
     "{1.name}@{1.hash:8}",
     "all",
     NULL,
     NULL,
     {{"gates failed", "fixed", "1.gates", .measure = count_failed}}},
    {NEPH_NIGHT_PHYSICS,
     "rows",
     NULL,
     NULL,
     "{1.check}",
     "{1.participant}",
     "{1.engine:version}",
     NULL,
     {{"deviation", NULL, "1.deviation", "1.standard_error", "theory", NULL}}},
    {NEPH_NIGHT_STRESS,
     "results",
     NULL,
     NULL,
     NULL,
     "{1.column}",
     "{0.device}",
     "{1.frame_key}",
     {{"{1.measure} over {1.over}", "fixed", .value = "1.value"},
      {"{1.measure} over {1.over}" NEPH_NIGHT_FLOOR, "fixed", .value = "1.floor"}}},
    {NEPH_NIGHT_SWEEP,
     "points",
     NULL,
     NULL,
     "{0.scene}@{0.scene_hash:8}",
     "{1.series} {1.label}",
     "{1.version}, {0.device}",
     "{1.frame_key}",
     {{"error", "{1.engine}", "1.error.value", NULL, "{0.truth}", NULL},
      {"shortcut", "{1.engine}", .value = "1.shortcut.value"},
      {"flicker", "{1.engine}", .value = "1.flicker.value"},
      {"half_life", "{1.engine}", .value = "1.half_life.value"},
      {"evaluations", "fixed", .value = "1.evaluations"}}},
    {NEPH_NIGHT_SPEED,
     "engines",
     NULL,
     NULL,
     "{0.scene}@{0.scene_hash:8}",
     "{1.engine}",
     "{1.version}, {1.device}",
     NULL,
     {{"evaluations", "fixed", "1.passes", .measure = sum_evaluations},
      {"time", "timed", "1", .measure = relative_time}}},
};

/* With the same seed and program every engine gives the same bits. Only path tracers draw other
 * samples when the program changes. */
static const char *find_series_kind(const struct reading *reading, const struct number *number,
                                    double error)
{
    const char *word = number->kind      ? fill(reading, number->kind)
                       : isfinite(error) ? "drawn"
                                         : "fixed";
    if (strcmp(word, NEPH_NIGHT_PICTURE) == 0 || neph_find_series_kind(word) < NEPH_SERIES_KINDS)
        return word;
    const struct neph_engine *engine = neph_engine_find(word);
    return engine && neph_engine_is_random(engine) ? "drawn" : "fixed";
}

static const char *fill_frame_key(const struct reading *reading, const struct results *of)
{
    char key[NEPH_HASH_HEX_SIZE];
    const char *frame = fill(reading, of->frame);
    if (!strchr(frame, '/'))
        return frame;
    neph_store_key_from_path(frame, key);
    return neph_arena_copy_text(reading->arena, key);
}

/* Add one number. A value that is not finite was not measured and is skipped. */
static void add(struct reading *reading, const struct results *of, const struct number *number)
{
    struct neph_night_numbers *numbers = reading->numbers;
    const json_t *found = find(reading, number->value);
    const double value = number->measure ? number->measure(reading, found) : number_or_nan(found),
                 error = error_at(reading, number->error);
    if (!isfinite(value))
        return;
    reading->overflows = reading->overflows || numbers->count == NUMBERS_MAX;
    if (reading->overflows)
        return;
    struct neph_measurement *m = &numbers->list[numbers->count++];
    *m = (struct neph_measurement){
        .series = neph_arena_format(
            reading->arena, "%s/%s/%s/%s%s%s", neph_night_suite_name(reading->suite),
            of->scene ? fill(reading, of->scene) : stress_scene(reading), fill(reading, of->engine),
            fill(reading, number->metric), number->truth ? "/" : "", fill(reading, number->truth)),
        .kind = find_series_kind(reading, number, error),
        .value = value,
        .standard_error = error,
        .environment = fill(reading, of->environment),
        .frame = fill_frame_key(reading, of)};
    if (strcmp(m->kind, "timed") == 0)
        m->environment = neph_arena_format(reading->arena, "%s; on %s", m->environment,
                                           reading->host);
}

/* ---- reading --------------------------------------------------------------------------------- */

static bool is_wanted(const struct reading *reading, const struct results *of)
{
    bool wanted = !of->only;
    for (int i = 0; !wanted && of->only[i]; i++)
        wanted = strcmp(fill(reading, of->which), of->only[i]) == 0;
    return wanted;
}

/* Read the numbers of all items of the nested `lists`; the first list is a member of `within`.
 * NEPH_ERR_ENGINE: that list is missing. */
static enum neph_status visit(struct reading *reading, const struct results *of,
                              const json_t *within, const char *lists, int level,
                              struct neph_diag *diag)
{
    const size_t length = strcspn(lists, ".");
    const char *name = neph_arena_format(reading->arena, "%.*s", (int)length, lists);
    const json_t *list = json_object_get(within, name), *item;
    size_t i;
    json_array_foreach(list, i, item)
    {
        reading->levels[level] = item;
        if (lists[length])
            visit(reading, of, item, &lists[length + 1], level + 1, NULL);
        else if (is_wanted(reading, of))
            for (const struct number *number = of->numbers; number->metric; number++)
                add(reading, of, number);
    }
    return json_is_array(list) ? NEPH_OK
                               : neph_fail(diag, NEPH_ERR_ENGINE, "its JSON has no %s", name);
}

static const char *format_frame_size(const struct reading *reading)
{
    const json_t *document = reading->levels[0], *size = json_object_get(document, "size_px");
    const bool is_sweep = reading->suite == NEPH_NIGHT_SWEEP;
    if (reading->suite == NEPH_NIGHT_PHYSICS || reading->suite == NEPH_NIGHT_STRESS)
        return "";
    const json_t *width = is_sweep ? json_object_get(document, "width_px")
                                   : json_array_get(size, 0),
                 *height = is_sweep ? json_object_get(document, "height_px")
                                    : json_array_get(size, 1);
    return neph_arena_format(reading->arena, "%lldx%lld", (long long)json_integer_value(width),
                             (long long)json_integer_value(height));
}

enum neph_status neph_night_read(enum neph_night_suite suite, const json_t *document,
                                 double calibration_s, const char *host, struct neph_arena *arena,
                                 struct neph_night_numbers *numbers, struct neph_diag *diag)
{
    struct reading reading = {suite, {document}, calibration_s, host, arena, numbers, false};
    const json_t *physics = json_object_get(document, "physics"); /* embedded in a report */
    const json_t *within = suite == NEPH_NIGHT_PHYSICS && physics ? physics : document;
    *numbers = (struct neph_night_numbers){
        .list = neph_arena_allocate(arena, NUMBERS_MAX, sizeof(*numbers->list)),
        .size = format_frame_size(&reading)};
    enum neph_status status = neph_arena_check(arena, diag);
    for (size_t i = 0; i < sizeof(results) / sizeof(results[0]) && !status; i++)
        if (results[i].suite == suite)
            status = visit(&reading, &results[i], within, results[i].lists, 1, diag);
    if (!status && reading.overflows)
        status = neph_fail(diag, NEPH_ERR_ENGINE, "it has more than %d numbers", NUMBERS_MAX);
    return status ? status : neph_arena_check(arena, diag);
}

json_t *neph_night_find_document(const char *printed)
{
    const char *start = strncmp(printed, "{\n", 2) == 0 ? printed : strstr(printed, "\n{\n");
    return start ? json_loads(start, JSON_DISABLE_EOF_CHECK | JSON_REJECT_DUPLICATES, NULL) : NULL;
}
