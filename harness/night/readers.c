/* SPDX-License-Identifier: MIT */
#include "harness/night/readers.h"

#include "base/exr.h"
#include "harness/data.h"
#include "harness/engines/engines.h"
#include "harness/run/store.h"
#include "metrics/significance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_NIGHT_SUITES == 5, "a new kind");

enum { NUMBERS_MAX = 4096 };

/* Below the unit, changes are relative to it: an error of 1e-7 may triple for any reason. */
static const struct neph_night_metric metrics[] = {
    {"rel_bias", 1e-3, true},     {"deviation", 1e-4, true}, {"gates failed", 1.0, false},
    {"evaluations", 1e-3, false}, {"", 1e-5, false}, /* all others */
};

/* A frame has many numbers; a night follows these, over the whole picture. */
static const struct {
    const char *quantity, *metric;
} followed[] = {
    {"radiance", "rel_bias"},
    {"radiance", "rel_rmse"},
    {"radiance", "p99"},
    {"transmittance", "max_abs"},
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

/* ---- adding ---------------------------------------------------------------------------------- */

struct reading {
    enum neph_night_suite suite;
    const json_t *document;
    double calibration_s;
    const char *host;
    struct neph_arena *arena;
    struct neph_night_numbers *numbers;
    const char *frame; /* the key of the picture that the numbers to come are of; "" */
    bool overflows;    /* there are more than NUMBERS_MAX */
};

/* One whose value is no number was not measured. `truth` NULL: there is none. */
static void add(struct reading *reading, const char *scene, const char *engine, const char *metric,
                const char *truth, const char *kind, double value, double standard_error,
                const char *environment)
{
    struct neph_night_numbers *numbers = reading->numbers;
    if (!isfinite(value))
        return;
    reading->overflows = reading->overflows || numbers->count == NUMBERS_MAX;
    if (reading->overflows)
        return;
    numbers->list[numbers->count++] = (struct neph_measurement){
        .series = neph_arena_format(reading->arena, "%s/%s/%s/%s%s%s",
                                    neph_night_suite_name(reading->suite), scene, engine, metric,
                                    truth ? "/" : "", truth ? truth : ""),
        .kind = kind,
        .value = value,
        .standard_error = standard_error,
        .environment = environment,
        .frame = reading->frame};
}

static const char *kind_word(enum neph_series_kind kind)
{
    return neph_series_rule(kind)->word;
}

/* With the same seed and program all engines give the same bits; what is drawn anew with every
 * change of a program are the paths of tracers. */
static const char *kind_of_engine(const char *name)
{
    const struct neph_engine *engine = neph_engine_find(name);
    return kind_word(engine && neph_engine_draws(engine) ? NEPH_SERIES_DRAWN : NEPH_SERIES_FIXED);
}

static const char *scene_at(struct reading *reading, const char *name, const char *hash)
{
    return neph_arena_format(reading->arena, "%s@%.8s", name, hash);
}

static const char *size_at(struct reading *reading, const json_t *size)
{
    return neph_arena_format(reading->arena, "%lldx%lld",
                             (long long)json_integer_value(json_array_get(size, 0)),
                             (long long)json_integer_value(json_array_get(size, 1)));
}

/* ---- the catalogue --------------------------------------------------------------------------- */

/* Range over mean of all values of R, G and B; NaN when the frame cannot be read. A value that is
 * not finite makes the sum so. */
static double contrast_of(const char *path)
{
    struct neph_image *image = NULL;
    double sum = 0.0, low = INFINITY, high = -INFINITY;
    size_t count = 0;
    if (neph_exr_read(path, &image, NULL))
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

static const char *version_of(struct reading *reading, const char *engine)
{
    size_t i;
    const json_t *row;
    json_array_foreach(json_object_get(reading->document, "engines"), i,
                       row) if (strcmp(neph_json_text(row, "name"), engine) ==
                                0) return neph_arena_format(reading->arena, "%s, %s",
                                                            neph_json_text(row, "version"),
                                                            neph_json_text(row, "device"));
    return "";
}

static bool is_followed(const json_t *measurement)
{
    if (strcmp(neph_json_text(measurement, "mask"), "all") != 0)
        return false;
    for (size_t i = 0; i < sizeof(followed) / sizeof(followed[0]); i++)
        if (strcmp(neph_json_text(measurement, "quantity"), followed[i].quantity) == 0 &&
            strcmp(neph_json_text(measurement, "metric"), followed[i].metric) == 0)
            return true;
    return false;
}

/* From a 95 % interval; NaN: there is none. */
static double error_of(const json_t *measurement)
{
    const json_t *interval = json_object_get(measurement, "interval");
    return json_is_array(interval) ? (json_number_value(json_array_get(interval, 1)) -
                                      json_number_value(json_array_get(interval, 0))) /
                                         (2.0 * neph_normal_critical(0.05))
                                   : NAN;
}

static const char *key_at(const struct reading *reading, const char *path)
{
    char key[NEPH_HASH_HEX_SIZE];
    neph_store_key_of(path, key);
    return neph_arena_text(reading->arena, key);
}

static void read_frame(struct reading *reading, const char *scene, const char *truth,
                       const json_t *frame)
{
    const char *engine = neph_json_text(frame, "engine"), *note = neph_json_text(frame, "note");
    const char *environment = neph_arena_format(
        reading->arena, "%s%s%s", version_of(reading, engine), note[0] ? "; " : "", note);
    const char *held = truth ? neph_arena_format(reading->arena, "%s; against %s", environment,
                                                 version_of(reading, truth))
                             : environment;
    size_t i;
    const json_t *m;
    reading->frame = key_at(reading, neph_json_text(frame, "exr"));
    add(reading, scene, engine, "contrast", NULL, NEPH_NIGHT_PICTURE,
        contrast_of(neph_json_text(frame, "exr")), NAN, environment);
    json_array_foreach(json_object_get(frame, "measurements"), i, m) if (is_followed(m))
        add(reading, scene, engine,
            neph_arena_format(reading->arena, "%s %s", neph_json_text(m, "quantity"),
                              neph_json_text(m, "metric")),
            truth ? truth : "none", kind_of_engine(engine), neph_json_real(m, "value"), error_of(m),
            held);
}

static void read_scene(struct reading *reading, const json_t *scene)
{
    const char *name = scene_at(reading, neph_json_text(scene, "name"),
                                neph_json_text(scene, "hash"));
    const json_t *truth = json_object_get(scene, "truth"), *item;
    const char *truth_name = json_is_object(truth)
                                 ? neph_arena_text(reading->arena, neph_json_text(truth, "engine"))
                                 : NULL;
    size_t i;
    int failed = 0;
    json_array_foreach(json_object_get(scene, "frames"), i,
                       item) if (strcmp(neph_json_text(item, "status"), "rendered") == 0)
        read_frame(reading, name, truth_name, item);
    json_array_foreach(json_object_get(scene, "gates"), i, item)
        failed += strcmp(neph_json_text(item, "verdict"), "fail") == 0;
    reading->frame = "";
    add(reading, name, "all", "gates failed", NULL, kind_word(NEPH_SERIES_FIXED), failed, NAN, "");
}

static void read_catalog(struct reading *reading)
{
    size_t i;
    const json_t *scene;
    reading->numbers->size = size_at(reading, json_object_get(reading->document, "size_px"));
    json_array_foreach(json_object_get(reading->document, "scenes"), i, scene)
        read_scene(reading, scene);
}

/* ---- physics --------------------------------------------------------------------------------- */

static void read_physics(struct reading *reading)
{
    size_t i;
    const json_t *row, *physics = json_object_get(reading->document, "physics");
    json_array_foreach(json_object_get(physics ? physics : reading->document, "rows"), i, row)
    {
        const double error = neph_json_real(row, "standard_error");
        const enum neph_series_kind kind = isfinite(error) ? NEPH_SERIES_DRAWN : NEPH_SERIES_FIXED;
        add(reading, neph_json_text(row, "check"), neph_json_text(row, "participant"), "deviation",
            "theory", kind_word(kind), neph_json_real(row, "deviation"), error,
            version_of(reading, neph_json_text(row, "engine")));
    }
}

/* ---- failure --------------------------------------------------------------------------------- */

static const char *failure_scene(struct reading *reading, const json_t *row)
{
    struct neph_scene *scene = NULL;
    const char *point = neph_json_text(row, "point");
    if (neph_data_load_scene(neph_json_text(row, "scene"), &scene, NULL))
        return neph_json_text(row, "scene");
    const char *name = neph_arena_format(reading->arena, "%s%s%s@%.8s",
                                         neph_json_text(row, "scene"), point[0] ? " " : "", point,
                                         scene->hash);
    neph_scene_destroy(scene);
    return name;
}

static void read_failure(struct reading *reading)
{
    size_t i;
    const json_t *row;
    const char *device = neph_arena_text(reading->arena,
                                         neph_json_text(reading->document, "device"));
    json_array_foreach(json_object_get(reading->document, "results"), i, row)
    {
        reading->frame = neph_arena_text(reading->arena, neph_json_text(row, "frame_key"));
        add(reading, failure_scene(reading, row), neph_json_text(row, "column"),
            neph_arena_format(reading->arena, "%s over %s", neph_json_text(row, "measure"),
                              neph_json_text(row, "over")),
            NULL, kind_word(NEPH_SERIES_FIXED), neph_json_real(row, "value"), NAN, device);
    }
}

/* ---- sweep ----------------------------------------------------------------------------------- */

static void read_point(struct reading *reading, const char *scene, const json_t *point)
{
    static const char *const measures[] = {"error", "shortcut", "flicker", "half_life"};
    const char *engine = neph_arena_format(reading->arena, "%s %s", neph_json_text(point, "series"),
                                           neph_json_text(point, "label"));
    const char *environment = neph_arena_format(reading->arena, "%s, %s",
                                                neph_json_text(point, "version"),
                                                neph_json_text(reading->document, "device"));
    const char *truth = neph_arena_text(reading->arena, neph_json_text(reading->document, "truth"));
    reading->frame = neph_arena_text(reading->arena, neph_json_text(point, "frame_key"));
    for (size_t i = 0; i < sizeof(measures) / sizeof(measures[0]); i++)
        add(reading, scene, engine, measures[i], i == 0 ? truth : NULL,
            kind_of_engine(neph_json_text(point, "engine")),
            neph_json_real(json_object_get(point, measures[i]), "value"), NAN, environment);
    add(reading, scene, engine, "evaluations", NULL, kind_word(NEPH_SERIES_FIXED),
        neph_json_real(point, "evaluations"), NAN, environment);
}

static void read_sweep(struct reading *reading)
{
    const json_t *d = reading->document, *point;
    const char *scene = scene_at(reading, neph_json_text(d, "scene"),
                                 neph_json_text(d, "scene_hash"));
    size_t i;
    reading->numbers->size = neph_arena_format(
        reading->arena, "%lldx%lld", (long long)json_integer_value(json_object_get(d, "width_px")),
        (long long)json_integer_value(json_object_get(d, "height_px")));
    json_array_foreach(json_object_get(d, "points"), i, point) read_point(reading, scene, point);
}

/* ---- speed ----------------------------------------------------------------------------------- */

/* A unit of time that goes with the machine: the calibration kernel, or on a device that is not the
 * CPU a thousand samples of a buffer there. NaN when the machine was busy. */
static double time_unit_s(const struct reading *reading, const json_t *row)
{
    const json_t *ceilings = json_object_get(reading->document, "ceilings");
    const bool is_cpu = strstr(neph_json_text(row, "device"), "llvmpipe") != NULL;
    return is_cpu ? reading->calibration_s
           : isfinite(reading->calibration_s)
               ? 1e3 / neph_json_real(ceilings, "buffer_samples_per_s")
               : NAN;
}

static void read_speed(struct reading *reading)
{
    const json_t *d = reading->document, *row, *pass;
    const char *scene = scene_at(reading, neph_json_text(d, "scene"),
                                 neph_json_text(d, "scene_hash"));
    size_t i, p;
    reading->numbers->size = size_at(reading, json_object_get(d, "size_px"));
    json_array_foreach(json_object_get(d, "engines"), i, row)
    {
        const char *versions = neph_arena_format(reading->arena, "%s, %s",
                                                 neph_json_text(row, "version"),
                                                 neph_json_text(row, "device"));
        const char *timed_on = neph_arena_format(reading->arena, "%s; on %s", versions,
                                                 reading->host);
        double evaluations = 0.0;
        json_array_foreach(json_object_get(row, "passes"), p, pass)
            evaluations += neph_json_real(pass, "density_evaluations");
        add(reading, scene, neph_json_text(row, "engine"), "evaluations", NULL,
            kind_word(NEPH_SERIES_FIXED), evaluations, NAN, versions);
        add(reading, scene, neph_json_text(row, "engine"), "time", NULL,
            kind_word(NEPH_SERIES_TIMED),
            neph_json_real(json_object_get(row, "frame_s"), "median") / time_unit_s(reading, row),
            NAN, timed_on);
    }
}

/* ---- documents ------------------------------------------------------------------------------- */

static void (*const read_suite[])(struct reading *) = {
    [NEPH_NIGHT_CATALOG] = read_catalog, [NEPH_NIGHT_PHYSICS] = read_physics,
    [NEPH_NIGHT_FAILURE] = read_failure, [NEPH_NIGHT_SWEEP] = read_sweep,
    [NEPH_NIGHT_SPEED] = read_speed,
};

/* The list that a document of a suite has. */
static const char *const lists[] = {
    [NEPH_NIGHT_CATALOG] = "scenes",  [NEPH_NIGHT_PHYSICS] = "rows",
    [NEPH_NIGHT_FAILURE] = "results", [NEPH_NIGHT_SWEEP] = "points",
    [NEPH_NIGHT_SPEED] = "engines",
};

static bool has_list(const json_t *document, enum neph_night_suite suite)
{
    const json_t *physics = json_object_get(document, "physics");
    return json_is_array(json_object_get(document, lists[suite])) ||
           json_is_array(json_object_get(physics, lists[suite]));
}

enum neph_status neph_night_read(enum neph_night_suite suite, const json_t *document,
                                 double calibration_s, const char *host, struct neph_arena *arena,
                                 struct neph_night_numbers *numbers, struct neph_diag *diag)
{
    *numbers = (struct neph_night_numbers){
        .list = neph_arena_zeroed(arena, NUMBERS_MAX, sizeof(*numbers->list)), .size = ""};
    if (!numbers->list)
        return neph_fail_memory(diag);
    if (!has_list(document, suite))
        return neph_fail(diag, NEPH_ERR_ENGINE, "its JSON has no %s", lists[suite]);
    struct reading reading = {suite, document, calibration_s, host, arena, numbers, "", false};
    read_suite[suite](&reading);
    if (reading.overflows)
        return neph_fail(diag, NEPH_ERR_ENGINE, "it has more than %d numbers", NUMBERS_MAX);
    return neph_arena_check(arena, diag);
}

json_t *neph_night_find_document(const char *printed)
{
    const char *start = strncmp(printed, "{\n", 2) == 0 ? printed : strstr(printed, "\n{\n");
    return start ? json_loads(start, JSON_DISABLE_EOF_CHECK | JSON_REJECT_DUPLICATES, NULL) : NULL;
}
