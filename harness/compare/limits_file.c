/* SPDX-License-Identifier: MIT */
#include "harness/compare/limits_file.h"

#include "base/files.h"
#include "base/hash.h"
#include "harness/compare/frame.h"
#include "harness/compare/verdict.h"
#include "harness/json_file.h"
#include "harness/progress.h"
#include "metrics/extractors/extractors.h"
#include "metrics/run_limit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FORMAT = 1, FAILURES_SHOWN = 3 };

static const size_t file_limit_bytes = 16 << 20;

void neph_limits_finish(struct neph_limits *limits)
{
    neph_arena_finish(&limits->arena);
    *limits = (struct neph_limits){.path = NULL};
}

/* ---- writing --------------------------------------------------------------------------------- */

static json_t *limit_json(const struct neph_limits *limits, const struct neph_measured_limit *limit)
{
    return json_pack("{s:s, s:s, s:s, s:s, s:f, s:s, s:i, s:o, s:f, s:f}", "quantity",
                     limit->limit.quantity, "metric", limit->limit.metric, "mask",
                     limit->limit.mask, "unit", limit->unit, "limit", limit->limit.value, "fails",
                     limit->limit.below ? "below" : "above", "runs", limits->run_count,
                     "confidence", neph_json_number(limit->is_equal ? NAN : limits->confidence),
                     "lowest", limit->lowest, "highest", limit->highest);
}

static json_t *list_json(const struct neph_limits *limits)
{
    json_t *list = json_array();
    for (int i = 0; i < limits->count; i++)
        neph_json_add(&list, limit_json(limits, &limits->list[i]));
    return list;
}

static json_t *unlimited_json(const struct neph_limits *limits)
{
    json_t *list = json_array();
    for (int i = 0; i < limits->unlimited_count; i++)
        neph_json_add(&list, json_pack("{s:s, s:s, s:s, s:s}", "quantity",
                                       limits->unlimited[i].limit.quantity, "metric",
                                       limits->unlimited[i].limit.metric, "mask",
                                       limits->unlimited[i].limit.mask, "because",
                                       limits->unlimited[i].because));
    return list;
}

static json_t *settings_json(const struct neph_limits *limits)
{
    json_t *list = json_array();
    for (int i = 0; i < limits->setting_count; i++)
        neph_json_add(&list, neph_json_cleaned(limits->settings[i]));
    return list;
}

int neph_limits_count_noisy(const struct neph_limits *limits)
{
    int count = 0;
    for (int i = 0; i < limits->count; i++)
        count += !limits->list[i].is_equal;
    return count;
}

static double alarm_rate(const struct neph_limits *limits)
{
    const struct neph_run_limit_family family = {limits->share, limits->confidence, 1};
    return neph_limits_count_noisy(limits) > 0 ? neph_run_limit_alarm_rate(&family) : 0.0;
}

json_t *neph_limits_json(const struct neph_limits *limits)
{
    json_t *reference = limits->reference
                            ? json_pack("{s:o, s:s}", "first", neph_json_cleaned(limits->reference),
                                        "digest", limits->reference_digest)
                            : json_null();
    return json_pack("{s:i, s:s, s:o, s:o, s:[i,i], s:i, s:i, s:i, s:f, s:f, s:f, s:o, s:o, s:o, "
                     "s:o}",
                     "neph_limits", FORMAT, "version", NEPH_VERSION, "environment",
                     neph_json_cleaned(limits->environment), "reference", reference, "size",
                     limits->width_px, limits->height_px, "frames", limits->frame_count,
                     "warm_up_frames", limits->warm_up_frames, "runs", limits->run_count, "share",
                     limits->share, "confidence", limits->confidence, "alarm_rate",
                     alarm_rate(limits), "viewing", neph_viewing_json(&limits->viewing), "settings",
                     settings_json(limits), "limits", list_json(limits), "left_out",
                     unlimited_json(limits));
}

enum neph_status neph_limits_write(const struct neph_limits *limits, const char *path,
                                   struct neph_diag *diag)
{
    json_t *json = neph_limits_json(limits);
    const enum neph_status status = neph_json_write(json, JSON_INDENT(1), path, diag);
    json_decref(json);
    return status;
}

/* ---- reading --------------------------------------------------------------------------------- */

static enum neph_status refuse(const char *path, struct neph_diag *diag, const char *why)
{
    neph_fail(diag, NEPH_ERR_INPUT, "'%s' is not a file of limits: %s", path, why);
    neph_hint(diag, "`neph limits` writes such files");
    return NEPH_ERR_INPUT;
}

static enum neph_status parse_file(const char *path, json_t **json, struct neph_diag *diag)
{
    char *text = NULL;
    size_t size;
    json_error_t error;
    const enum neph_status status = neph_file_read(path, file_limit_bytes, &text, &size, diag);
    if (!status)
        *json = json_loadb(text, size, JSON_REJECT_DUPLICATES, &error);
    free(text);
    if (status || *json)
        return status;
    refuse(path, diag, error.text);
    neph_locate(diag, path, error.line, error.column);
    return NEPH_ERR_INPUT;
}

/* Copy a name that has to fit. */
static bool copy_name(char *to, size_t size, const char *from)
{
    const bool fits = strlen(from) < size;
    if (fits)
        memcpy(to, from, strlen(from) + 1);
    return fits;
}

static bool read_limit(json_t *json, struct neph_limits *limits, struct neph_measured_limit *limit,
                       json_error_t *error)
{
    const char *quantity, *metric, *mask, *unit, *fails;
    json_t *confidence;
    struct neph_limit *made = &limit->limit;
    if (json_unpack_ex(json, error, 0, "{s:s, s:s, s:s, s:s, s:F, s:s, s:F, s:F, s:o}", "quantity",
                       &quantity, "metric", &metric, "mask", &mask, "unit", &unit, "limit",
                       &made->value, "fails", &fails, "lowest", &limit->lowest, "highest",
                       &limit->highest, "confidence", &confidence))
        return false;
    made->below = strcmp(fails, "below") == 0;
    limit->is_equal = json_is_null(confidence);
    limit->unit = neph_arena_copy_text(&limits->arena, unit);
    snprintf(error->text, sizeof(error->text), "%.60s:%.60s@%.60s", quantity, metric, mask);
    return copy_name(made->quantity, sizeof(made->quantity), quantity) &&
           copy_name(made->metric, sizeof(made->metric), metric) &&
           copy_name(made->mask, sizeof(made->mask), mask) && neph_quantity_find(quantity) &&
           neph_metric_find(metric, NULL) && made->value >= 0.0 &&
           (made->below || strcmp(fails, "above") == 0);
}

static enum neph_status read_list(const char *path, json_t *list, struct neph_limits *limits,
                                  struct neph_diag *diag)
{
    const size_t count = json_array_size(list);
    if (count == 0)
        return refuse(path, diag, "it has no limits");
    limits->list = neph_arena_allocate(&limits->arena, count, sizeof(*limits->list));
    for (size_t i = 0; limits->list && i < count; i++) {
        json_error_t error = {.line = 0};
        if (read_limit(json_array_get(list, i), limits, &limits->list[i], &error)) {
            limits->count++;
            continue;
        }
        neph_fail(diag, NEPH_ERR_INPUT, "'%s': limit %zu is not valid: %s", path, i + 1,
                  error.text);
        neph_hint(diag, "\"quantity\", \"metric\" and \"mask\" as `neph metrics` lists them, "
                        "\"limit\" >= 0, \"fails\" above or below");
        return NEPH_ERR_INPUT;
    }
    return neph_arena_check(&limits->arena, diag);
}

static const char *text_or_null(struct neph_limits *limits, const json_t *object, const char *key)
{
    return neph_arena_copy_text(&limits->arena, json_string_value(json_object_get(object, key)));
}

static void read_settings(const json_t *list, struct neph_limits *limits)
{
    const size_t count = json_array_size(list);
    const char **settings = neph_arena_allocate(&limits->arena, count + 1, sizeof(*settings));
    for (size_t i = 0; settings && i < count; i++) {
        const char *text = json_string_value(json_array_get(list, i));
        settings[i] = neph_arena_copy_text(&limits->arena, text ? text : "");
    }
    limits->settings = settings;
    limits->setting_count = settings ? (int)count : 0;
}

static enum neph_status read_all(const char *path, json_t *json, struct neph_limits *limits,
                                 struct neph_diag *diag)
{
    int format = 0;
    const char *environment;
    json_t *reference, *settings, *list;
    json_error_t error;
    struct neph_viewing *viewing = &limits->viewing;
    if (json_unpack_ex(
            json, &error, 0,
            "{s:i, s:s, s:o, s:[i,i], s:i, s:i, s:i, s:F, s:F, s:{s:F, s:F, s:F, s:F}, "
            "s:o, s:o}",
            "neph_limits", &format, "environment", &environment, "reference", &reference, "size",
            &limits->width_px, &limits->height_px, "frames", &limits->frame_count, "warm_up_frames",
            &limits->warm_up_frames, "runs", &limits->run_count, "share", &limits->share,
            "confidence", &limits->confidence, "viewing", "frame_rate_hz", &viewing->frame_rate_hz,
            "pixels_per_degree", &viewing->pixels_per_degree, "exposure_ev", &viewing->exposure_ev,
            "white_cd_per_m2", &viewing->white_cd_per_m2, "settings", &settings, "limits", &list))
        return refuse(path, diag, error.text);
    if (format != FORMAT)
        return refuse(path, diag, "\"neph_limits\", the version of the format, is not 1");
    limits->path = neph_arena_copy_text(&limits->arena, path);
    limits->environment = neph_arena_copy_text(&limits->arena, environment);
    limits->reference = text_or_null(limits, reference, "first");
    limits->reference_digest = text_or_null(limits, reference, "digest");
    read_settings(settings, limits);
    return read_list(path, list, limits, diag);
}

enum neph_status neph_limits_read(const char *path, struct neph_limits *limits,
                                  struct neph_diag *diag)
{
    json_t *json = NULL;
    enum neph_status status = parse_file(path, &json, diag);
    if (!status)
        status = read_all(path, json, limits, diag);
    json_decref(json);
    return status;
}

/* ---- frames ---------------------------------------------------------------------------------- */

/* Texts that programs write into their frames: neph; Blender and OpenImageIO; Arnold and others;
 * Mitsuba; Houdini. The first that a frame has is its program. */
static const char *const programs[] = {"neph.engine_version", "Software", "software",
                                       "generatedBy",         "renderer", "writer"};
static const char *const devices[] = {"neph.device", "HostComputer", "Hostname"};

static const char *find_attribute(const struct neph_image *image, const char *const *names,
                                  size_t count)
{
    const char *text = NULL;
    for (size_t i = 0; i < count && !text; i++)
        text = neph_image_attribute(image, names[i]);
    return text;
}

enum neph_status neph_frame_origin_read(const char *path, const struct neph_frame_choice *choice,
                                        size_t negative_allowed, struct neph_frame_origin *origin,
                                        struct neph_diag *diag)
{
    struct neph_image *image = NULL;
    const enum neph_status status = neph_frame_read(path, choice, negative_allowed, &image, diag);
    if (status)
        return status;
    const char *program = find_attribute(image, programs, sizeof(programs) / sizeof(programs[0]));
    const char *device = find_attribute(image, devices, sizeof(devices) / sizeof(devices[0]));
    snprintf(origin->environment, sizeof(origin->environment), "%s%s%s", program ? program : "",
             program && device ? ", " : "", device ? device : "");
    origin->width_px = image->width_px;
    origin->height_px = image->height_px;
    neph_image_destroy(image);
    return NEPH_OK;
}

/* ---- use ------------------------------------------------------------------------------------- */

static enum neph_status check_counts(const struct neph_limits *limits,
                                     const struct neph_compared *compared, struct neph_diag *diag)
{
    if (compared->frame_count == limits->frame_count &&
        compared->asked->warm_up_frames == limits->warm_up_frames)
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_INPUT,
              "the limits of '%s' are for %d frames after a warm-up of %d, the comparison has %d "
              "after %d",
              limits->path, limits->frame_count, limits->warm_up_frames, compared->frame_count,
              compared->asked->warm_up_frames);
    neph_hint(diag, "compare as many frames, or measure the limits again with `neph limits`");
    return NEPH_ERR_INPUT;
}

static enum neph_status check_viewing(const struct neph_limits *limits,
                                      const struct neph_compared *compared, struct neph_diag *diag)
{
    const struct neph_viewing *is = &compared->viewing, *was = &limits->viewing;
    const struct {
        const char *option;
        double is, was;
    } conditions[] = {
        {"fps", is->frame_rate_hz, was->frame_rate_hz},
        {"ppd", is->pixels_per_degree, was->pixels_per_degree},
        {"exposure", is->exposure_ev, was->exposure_ev},
        {"white", is->white_cd_per_m2, was->white_cd_per_m2},
    };
    for (size_t i = 0; i < sizeof(conditions) / sizeof(conditions[0]); i++) {
        if (conditions[i].is == conditions[i].was)
            continue;
        neph_fail(diag, NEPH_ERR_INPUT,
                  "the limits of '%s' are for --%s %.17g, the comparison has "
                  "%.17g",
                  limits->path, conditions[i].option, conditions[i].was, conditions[i].is);
        neph_hint(diag, "say --%s %.17g", conditions[i].option, conditions[i].was);
        return NEPH_ERR_INPUT;
    }
    return NEPH_OK;
}

static void warn_of_reference(const struct neph_limits *limits, const struct neph_comparison *asked)
{
    char digest[NEPH_HASH_HEX_SIZE];
    if (asked->without_reference || !limits->reference_digest)
        return;
    if (neph_hash_file(asked->reference.paths[0], digest, NULL) == NEPH_OK &&
        strcmp(digest, limits->reference_digest) != 0)
        neph_progress_warn("the limits of '%s' are for the reference '%s', not for '%s'",
                           limits->path, limits->reference, asked->reference.paths[0]);
}

enum neph_status neph_limits_check_use(const struct neph_limits *limits,
                                       const struct neph_compared *compared, struct neph_diag *diag)
{
    const struct neph_comparison *asked = compared->asked;
    struct neph_frame_origin origin;
    enum neph_status status = check_counts(limits, compared, diag);
    if (!status)
        status = check_viewing(limits, compared, diag);
    if (!status)
        status = neph_frame_origin_read(asked->test.paths[asked->warm_up_frames],
                                        &asked->frame_choice, asked->negative_allowed, &origin,
                                        diag);
    if (status)
        return status;
    if (origin.width_px != limits->width_px || origin.height_px != limits->height_px)
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "the limits of '%s' are for frames of %dx%d pixels, the test has %dx%d",
                         limits->path, limits->width_px, limits->height_px, origin.width_px,
                         origin.height_px);
    if (limits->environment[0] && origin.environment[0] &&
        strcmp(limits->environment, origin.environment) != 0)
        neph_progress_warn("the limits of '%s' were measured in '%s', the test is from '%s'",
                           limits->path, limits->environment, origin.environment);
    warn_of_reference(limits, asked);
    return NEPH_OK;
}

int neph_limits_print(const struct neph_limits *limits, const struct neph_measurements *numbers,
                      FILE *out)
{
    int failed = 0;
    for (int i = 0; i < limits->count; i++) {
        if (neph_limit_check(numbers, &limits->list[i].limit, NULL) == NEPH_OK)
            continue;
        if (failed++ < FAILURES_SHOWN)
            neph_verdict_limit(numbers, &limits->list[i].limit, out);
    }
    if (failed > 0) {
        fprintf(out, "FAIL %d of %d limits of '%s'\n", failed, limits->count, limits->path);
        return 1 + (failed < FAILURES_SHOWN ? failed : FAILURES_SHOWN);
    }
    fprintf(out, "PASS all %d limits of '%s', from %d runs\n", limits->count, limits->path,
            limits->run_count);
    return 1;
}

json_t *neph_limits_result_json(const struct neph_limits *limits,
                                const struct neph_measurements *numbers)
{
    json_t *failed = json_array();
    for (int i = 0; i < limits->count; i++) {
        const struct neph_limit *limit = &limits->list[i].limit;
        if (neph_limit_check(numbers, limit, NULL) == NEPH_OK)
            continue;
        const struct neph_measurement *worst = neph_limit_worst(numbers, limit);
        neph_json_add(&failed,
                      json_pack("{s:s, s:s, s:s, s:f, s:o}", "quantity", limit->quantity, "metric",
                                limit->metric, "mask", limit->mask, "limit", limit->value, "value",
                                neph_json_number(worst ? worst->value : NAN)));
    }
    return json_pack("{s:o, s:o, s:i, s:f, s:f, s:i, s:o}", "file", neph_json_cleaned(limits->path),
                     "environment", neph_json_cleaned(limits->environment), "runs",
                     limits->run_count, "share", limits->share, "confidence", limits->confidence,
                     "count", limits->count, "failed", failed);
}
