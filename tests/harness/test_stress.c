/* SPDX-License-Identifier: MIT
 *
 * The stress tests without a renderer: verdicts, failure of a run, expectations, reading measures
 * from documents, and consistency of the project's files.
 */
#include "tests/base/scratch.h"

#include "base/files.h"
#include "harness/data.h"
#include "harness/engines/engines.h"
#include "harness/experiment/pool.h"
#include "harness/run/job.h"
#include "harness/stress/expectations.h"
#include "harness/stress/measures.h"
#include "harness/stress/suite.h"
#include "harness/stress/trial.h"
#include "harness/stress/truth.h"
#include "metrics/extractors/extractors.h"

#include <math.h>
#include <unistd.h>

/* ---- verdicts -------------------------------------------------------------------------------- */

static void test_verdicts(void **state)
{
    static const struct {
        double value;
        enum neph_stress_expected expected;
        enum neph_stress_verdict verdict;
    } cases[] = {
        {0.5, NEPH_STRESS_PASSES, NEPH_STRESS_PASS},
        {1.0, NEPH_STRESS_PASSES, NEPH_STRESS_PASS}, /* the limit itself passes */
        {1.5, NEPH_STRESS_PASSES, NEPH_STRESS_FAIL},
        {INFINITY, NEPH_STRESS_PASSES, NEPH_STRESS_FAIL},
        {NAN, NEPH_STRESS_PASSES, NEPH_STRESS_NO_NUMBER},
        {1.5, NEPH_STRESS_FAILS, NEPH_STRESS_KNOWN_FAIL},
        {0.5, NEPH_STRESS_FAILS, NEPH_STRESS_NEW_PASS},
        {NAN, NEPH_STRESS_FAILS, NEPH_STRESS_NO_NUMBER},
        {1.5, NEPH_STRESS_FLAKES, NEPH_STRESS_FLAKE},
        {0.5, NEPH_STRESS_FLAKES, NEPH_STRESS_PASS},
        {NAN, NEPH_STRESS_FLAKES, NEPH_STRESS_NO_NUMBER},
        {NAN, NEPH_STRESS_SKIPS, NEPH_STRESS_SKIP},
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++)
        assert_int_equal(neph_stress_judge(cases[i].value, 1.0, cases[i].expected),
                         cases[i].verdict);
}

/* A run of one row and two presets. A run without comparisons does not pass. */
static void test_failures_of_a_run(void **state)
{
    static const struct {
        enum neph_stress_verdict verdicts[2];
        bool passes;
        int compared;
    } cases[] = {
        {{NEPH_STRESS_PASS, NEPH_STRESS_KNOWN_FAIL}, true, 2},
        {{NEPH_STRESS_FLAKE, NEPH_STRESS_SKIP}, true, 1},
        {{NEPH_STRESS_PASS, NEPH_STRESS_FAIL}, false, 2},
        {{NEPH_STRESS_PASS, NEPH_STRESS_NEW_PASS}, false, 2},
        {{NEPH_STRESS_PASS, NEPH_STRESS_NO_NUMBER}, false, 1},
        {{NEPH_STRESS_PASS, NEPH_STRESS_CANNOT}, true, 1},
        {{NEPH_STRESS_MISSING, NEPH_STRESS_PASS}, true, 1},
        {{NEPH_STRESS_PASS, NEPH_STRESS_NOT_RENDERED}, true, 1},
        {{NEPH_STRESS_CANNOT, NEPH_STRESS_MISSING}, false, 0},
        {{NEPH_STRESS_SKIP, NEPH_STRESS_NOT_PLANNED}, false, 0},
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        struct neph_stress_cell cells[] = {{.value = 1.0, .verdict = cases[i].verdicts[0]},
                                           {.value = 1.0, .verdict = cases[i].verdicts[1]}};
        struct neph_stress_row row = {.cells = cells};
        struct neph_stress_suite suite = {.column_count = 2, .row_count = 1, .rows = &row};
        neph_stress_count(&suite);
        assert_int_equal(suite.passes, cases[i].passes);
        assert_int_equal(suite.counts.compared, cases[i].compared);
    }
}

/* ---- expectations ---------------------------------------------------------------------------- */

#define LIST(entries)                                                                              \
    "{\"format\": \"neph-failure-expectations-1\", \"expectations\": [" entries "]}"
#define ENTRY(more, is, reason)                                                                    \
    "{\"scene\": \"s\", \"presets\": [\"seed\", \"ue\"], \"measure\": \"error\", " more            \
    "\"is\": \"" is "\", \"reason\": \"" reason "\"}"

static enum neph_status load_list(void **state, const char *text, json_t **list,
                                  struct neph_diag *diag)
{
    char path[SCRATCH_PATH_MAX];
    scratch_write(scratch_path(state, path, "list.json"), text, strlen(text));
    return neph_stress_expectations_load(path, list, diag);
}

static void assert_expected(const json_t *list, struct neph_stress_place place,
                            enum neph_stress_expected expected, const char *reason)
{
    const char *found;
    assert_int_equal(neph_stress_expected_at(list, &place, &found), expected);
    assert_string_equal(found, reason);
}

static void test_the_first_entry_that_fits_counts(void **state)
{
    json_t *list = NULL;
    struct neph_diag diag = {.line = 0};
    neph_assert_ok(load_list(state,
                             LIST(ENTRY("\"points\": [\"x=1\"], ", "skips", "a") "," ENTRY(
                                 "\"over\": \"sky\", ", "flakes", "b") "," ENTRY("", "fails", "c")),
                             &list, &diag),
                   &diag);
    typedef struct neph_stress_place at;
    assert_expected(list, (at){"s", "x=1", "ue", "error", "sky"}, NEPH_STRESS_SKIPS, "a");
    assert_expected(list, (at){"s", "", "ue", "error", "sky"}, NEPH_STRESS_FLAKES, "b");
    assert_expected(list, (at){"s", "", "seed", "error", "all"}, NEPH_STRESS_FAILS, "c");
    assert_expected(list, (at){"s", "", "ours", "error", "all"}, NEPH_STRESS_PASSES, "");
    assert_expected(list, (at){"s", "", "seed+taa=off", "error", "all"}, NEPH_STRESS_PASSES, "");
    assert_expected(list, (at){"s", "", "seed", "lag", "all"}, NEPH_STRESS_PASSES, "");
    assert_expected(list, (at){"t", "", "seed", "error", "all"}, NEPH_STRESS_PASSES, "");
    json_decref(list);
}

static void test_lists_that_are_none(void **state)
{
    static const char *const bad[] = {
        "[",
        "{}",
        "{\"format\": \"other\", \"expectations\": []}",
        LIST(ENTRY("", "passes", "a")),
        LIST(ENTRY("", "breaks", "a")),
        LIST(ENTRY("", "fails", "")),
        LIST("{\"scene\": \"s\", \"presets\": [], \"measure\": \"error\", \"is\": \"fails\", "
             "\"reason\": \"a\"}")};
    for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
        json_t *list = NULL;
        struct neph_diag diag = {.line = 0};
        assert_int_equal(load_list(state, bad[i], &list, &diag), NEPH_ERR_INPUT);
        assert_null(list);
        assert_true(diag.line > 0);
    }
}

/* ---- measures -------------------------------------------------------------------------------- */

static json_t *document(const char *const metrics[2], const double values[2], const char *mask)
{
    json_t *list = json_array();
    for (int i = 0; i < 2 && metrics[i]; i++)
        neph_json_add(&list,
                      json_pack("{s:s, s:s, s:s, s:o, s:s}", "metric", metrics[i], "mask", mask,
                                "quantity", "radiance", "value", neph_json_number(values[i]),
                                "undefined_because", isnan(values[i]) ? "it cannot be told" : ""));
    return json_pack("{s:o}", "measurements", list);
}

static double read_off(enum neph_failing_measure measure, const char *first, double a,
                       const char *second, double b, char why[NEPH_STRESS_WHY_SIZE])
{
    json_t *json = document((const char *const[]){first, second}, (double[]){a, b}, "all");
    const struct neph_failing_limit limit = {.measure = measure, .over = (char[]){"all"}};
    const double value = neph_stress_read(&limit, json, why);
    json_decref(json);
    return value;
}

static void test_measures_are_read(void **state)
{
    char why[NEPH_STRESS_WHY_SIZE];
    assert_true(read_off(NEPH_FAILING_ERROR, "rel_rmse", 0.25, NULL, 0, why) == 0.25);
    assert_true(read_off(NEPH_FAILING_ENERGY, "rel_bias", -0.25, NULL, 0, why) == 0.25);
    assert_true(read_off(NEPH_FAILING_PERIOD_4, "repeats_4", 1, "cycle_std", 2, why) == 1.0);
    assert_true(read_off(NEPH_FAILING_PERIOD_4, "repeats_4", NAN, "cycle_std", 2, why) == 2.0);
    assert_string_equal(why, "");
    assert_true(
        read_off(NEPH_FAILING_LAG, "frames_to_10_p95", 3, "share_unsettled_10", 0.05, why) == 3.0);
    assert_true(
        isinf(read_off(NEPH_FAILING_LAG, "frames_to_10_p95", 3, "share_unsettled_10", 0.06, why)));
    assert_true(isnan(read_off(NEPH_FAILING_FLICKER, "seen_contrast", NAN, NULL, 0, why)));
    assert_string_equal(why, "it cannot be told");
    assert_true(isnan(read_off(NEPH_FAILING_FLICKER, "other", 1, NULL, 0, why)));
    assert_string_equal(why, "the mask is empty, or the whole frame");
}

static void test_measures_are_of_metrics_that_there_are(void **state)
{
    for (int m = 0; m < NEPH_FAILING_MEASURES; m++) {
        const struct neph_stress_measure *measure = neph_stress_measure(
            (enum neph_failing_measure)m);
        for (int n = 0; n < NEPH_STRESS_NUMBERS && measure->metrics[n]; n++) {
            const struct neph_extractor *owner = NULL;
            assert_non_null(neph_metric_find(measure->metrics[n], &owner));
            assert_string_equal(owner->name, measure->extractor);
        }
    }
}

/* Infinity is valid only as a distance; -inf is one value, though it is invalid in two ways. */
static void test_bad_values_are_counted_in_all_channels(void **state)
{
    static const float values[] = {NAN, INFINITY, -INFINITY, -1.0f, 0.0f, 1.0f};
    static const struct {
        const char *name;
        size_t bad;
    } channels[] = {{"R", 4}, {"Z", 3}, {"volume.distance", 3}, {"transmittance.G", 4}};
    for (size_t i = 0; i < sizeof(channels) / sizeof(channels[0]); i++) {
        struct neph_image *image = NULL;
        float *samples = NULL;
        neph_assert_ok(neph_image_create(6, 1, &image, NULL), NULL);
        neph_assert_ok(neph_image_add_channel(image, channels[i].name, &samples, NULL), NULL);
        memcpy(samples, values, sizeof(values));
        assert_int_equal(neph_job_count_bad(image), channels[i].bad);
        neph_image_destroy(image);
    }
}

/* ---- the project's files --------------------------------------------------------------------- */

static void plan(struct neph_stress_suite *suite, bool full)
{
    const struct neph_stress_params params = {.full = full};
    struct neph_diag diag = {.line = 0};
    *suite = (struct neph_stress_suite){.scenes = NULL};
    neph_assert_ok(neph_stress_plan(&params, suite, &diag), &diag);
}

/* As in a run: a preset, or an engine. */
static struct neph_stress_column make_column(const char *name)
{
    const struct neph_engine *engine = neph_engine_find(name);
    return (struct neph_stress_column){name, engine ? engine : neph_engine_find("realtime"),
                                       !engine};
}

static bool has_row(const struct neph_stress_suite *suite, const struct neph_stress_place *place)
{
    for (int r = 0; r < suite->row_count; r++) {
        const struct neph_stress_row *row = &suite->rows[r];
        const struct neph_stress_column column = make_column(place->preset);
        if (strcmp(row->scene->name, place->scene) == 0 &&
            (!place->point || strcmp(row->point, place->point) == 0) &&
            strcmp(neph_failing_measure_name(row->limit->measure), place->measure) == 0 &&
            (!*place->over || strcmp(row->limit->over, place->over) == 0) &&
            neph_stress_measures(row->scene->failing, row->limit, &column))
            return true;
    }
    return false;
}

static bool is_column(const char *name)
{
    if (neph_engine_find(name))
        return true;
    const struct neph_preset *preset = neph_engine_find("realtime")->presets;
    while (preset->name && strcmp(preset->name, name) != 0)
        preset++;
    return preset->name != NULL;
}

/* An expectation that matches nothing would hide that its failure no longer exists. */
static void test_every_expectation_is_of_something(void **state)
{
    struct neph_stress_suite suite;
    json_t *list = NULL;
    struct neph_diag diag = {.line = 0};
    plan(&suite, true);
    neph_assert_ok(neph_stress_expectations_load(NULL, &list, &diag), &diag);
    for (size_t i = 0; i < json_array_size(list); i++) {
        const json_t *entry = json_array_get(list, i);
        const json_t *presets = json_object_get(entry, "presets");
        const json_t *points = json_object_get(entry, "points");
        for (size_t p = 0; p < json_array_size(presets); p++)
            for (size_t k = 0; k < (points ? json_array_size(points) : 1); k++) {
                const struct neph_stress_place place = {
                    neph_json_text(entry, "scene"), json_string_value(json_array_get(points, k)),
                    json_string_value(json_array_get(presets, p)), neph_json_text(entry, "measure"),
                    neph_json_text(entry, "over")};
                if (!is_column(place.preset) || !has_row(&suite, &place))
                    fail_msg("expectation %zu: %s, %s, %s is of nothing", i, place.scene,
                             place.preset, place.measure);
            }
    }
    json_decref(list);
    neph_stress_finish(&suite);
}

/* A preset that a scenario lists, or an engine. */
static const char *find_any_column(const struct neph_failing *failing)
{
    if (strcmp(failing->presets, "none") == 0)
        return "march";
    return strstr(failing->presets, "off") ? "off" : "fixed";
}

/* Every scene states its failure, every scene has a count of bad values, and every point of a
 * parameter is a scene. */
static void test_every_scenario_can_be_run(void **state)
{
    struct neph_stress_suite full, quick;
    char **names = NULL;
    int count = 0;
    assert_int_equal(neph_data_list_scenes(NEPH_DATA_STRESS, &names, &count, NULL), NEPH_OK);
    plan(&full, true);
    plan(&quick, false);
    assert_int_equal(full.scene_count, count);
    assert_true(quick.scene_count > 0 && quick.scene_count < full.scene_count);
    for (int s = 0; s < full.scene_count; s++) {
        const struct neph_stress_place place = {full.scenes[s]->name, "",
                                                find_any_column(full.scenes[s]->failing),
                                                "bad_values", "all"};
        assert_true(has_row(&full, &place));
        for (int p = 1; p < neph_failing_point_count(full.scenes[s]->failing); p++) {
            struct neph_scene *at = NULL;
            struct neph_diag diag = {.line = 0};
            neph_assert_ok(neph_scene_load_point(full.scenes[s], p, &at, &diag), &diag);
            /* a point moves only if its file does, by which its floors are planned */
            assert_true(neph_stress_is_static(at) || !neph_stress_is_static(full.scenes[s]));
            neph_scene_destroy(at);
        }
    }
    neph_data_free_names(names);
    neph_stress_finish(&full);
    neph_stress_finish(&quick);
}

static int count_columns(const struct neph_stress_suite *suite, bool presets)
{
    int count = 0;
    for (int c = 0; c < suite->column_count; c++)
        count += suite->columns[c].is_preset == presets;
    return count;
}

/* Only presets, only engines, both, or neither: the presets of the tier, and engines where a
 * scenario supports them. */
static void test_presets_and_engines_choose_columns(void **state)
{
    static const char *const ours[] = {"ours"}, *const march[] = {"march"};
    static const char *const fence[] = {"fence_tiles"}, *const fog[] = {"fog_seam"};
    const struct {
        struct neph_stress_params params;
        int presets, engines;
    } cases[] = {
        {{.only = fog, .only_count = 1}, 3, 4},
        {{.only = fog, .only_count = 1, .full = true}, 9, 4},
        {{.only = fence, .only_count = 1}, 3, 0},
        {{.only = fog, .only_count = 1, .presets = ours, .preset_count = 1}, 1, 0},
        {{.only = fog, .only_count = 1, .engines = march, .engine_count = 1}, 0, 1},
        {{.presets = ours, .preset_count = 1, .engines = march, .engine_count = 1}, 1, 1},
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        struct neph_stress_suite suite = {.scenes = NULL};
        struct neph_diag diag = {.line = 0};
        neph_assert_ok(neph_stress_plan(&cases[i].params, &suite, &diag), &diag);
        assert_int_equal(count_columns(&suite, true), cases[i].presets);
        assert_int_equal(count_columns(&suite, false), cases[i].engines);
        neph_stress_finish(&suite);
    }
}

/* Engines have only measures of single frames, and only in scenarios with fog. */
static void test_engines_have_single_frame_measures(void **state)
{
    struct neph_stress_suite suite;
    int asked = 0;
    plan(&suite, true);
    const struct neph_stress_column march = make_column("march");
    for (int r = 0; r < suite.row_count; r++) {
        const struct neph_stress_row *row = &suite.rows[r];
        if (!neph_stress_measures(row->scene->failing, row->limit, &march))
            continue;
        assert_true(row->scene->failing->engines);
        assert_true(row->limit->measure == NEPH_FAILING_ERROR ||
                    row->limit->measure == NEPH_FAILING_ENERGY ||
                    row->limit->measure == NEPH_FAILING_BAD_VALUES);
        asked++;
    }
    assert_true(asked > 8);
    neph_stress_finish(&suite);
}

/* ---- order ----------------------------------------------------------------------------------- */

/* New failures before known ones, larger excess over the limit before smaller. */
static void test_the_worst_is_first(void **state)
{
    const struct neph_failing_limit limit = {.limit = 2.0}, zero = {.limit = 0.0};
    struct neph_stress_cell cells[][2] = {
        {{1.0, NEPH_STRESS_PASS, "", NULL, NULL}, {3.0, NEPH_STRESS_KNOWN_FAIL, "", NULL, NULL}},
        {{3.0, NEPH_STRESS_FAIL, "", NULL, NULL}, {NAN, NEPH_STRESS_NOT_PLANNED, "", NULL, NULL}},
        {{1.0, NEPH_STRESS_FAIL, "", NULL, NULL}, {NAN, NEPH_STRESS_NO_NUMBER, "", NULL, NULL}},
        {{9.0, NEPH_STRESS_FAIL, "", NULL, NULL}, {0.5, NEPH_STRESS_NEW_PASS, "", NULL, NULL}},
    };
    struct neph_stress_row rows[] = {{.limit = &limit, .cells = cells[0]},
                                     {.limit = &limit, .cells = cells[1]},
                                     {.limit = &zero, .cells = cells[2]},
                                     {.limit = &limit, .cells = cells[3]}};
    const struct neph_stress_suite suite = {.column_count = 2, .row_count = 4, .rows = rows};
    static const int expected[][2] = {{2, 0}, {3, 0}, {1, 0}, {2, 1}, {3, 1}, {0, 1}, {0, 0}};
    int count = 0;
    struct neph_stress_cell_id *spots = neph_stress_worst(&suite, &count);
    assert_int_equal(count, sizeof(expected) / sizeof(expected[0]));
    for (int i = 0; i < count; i++) {
        assert_int_equal(spots[i].row - rows, expected[i][0]);
        assert_int_equal(spots[i].column, expected[i][1]);
    }
    assert_true(isinf(neph_stress_excess(&rows[2], &cells[2][0])));
    assert_true(neph_stress_excess(&rows[1], &cells[1][0]) == 1.5);
    free(spots);
}

/* ---- trials ---------------------------------------------------------------------------------- */

static bool is_requested_at(const struct neph_stress_suite *suite, int row, int column)
{
    const struct neph_stress_point point = neph_stress_point_at(suite, row);
    return neph_stress_has_trial(suite, &point, column);
}

/* Each requested trial occurs exactly once. */
static void assert_all_once(const struct neph_stress_suite *suite,
                            const struct neph_stress_trials *trials)
{
    int asked = 0;
    for (int row = 0; row < suite->row_count; row += neph_stress_point_at(suite, row).row_count)
        for (int c = 0; c < suite->column_count + suite->floor_count; c++)
            asked += is_requested_at(suite, row, c);
    assert_int_equal(trials->count, asked);
    for (int i = 0; i < trials->count; i++) {
        assert_true(is_requested_at(suite, trials->list[i].row, trials->list[i].column));
        for (int k = 0; k < i; k++)
            assert_true(trials->list[i].row != trials->list[k].row ||
                        trials->list[i].column != trials->list[k].column);
    }
}

static void test_one_process_goes_from_point_to_point(void **state)
{
    struct neph_stress_suite suite = {.scenes = NULL};
    struct neph_stress_trials trials;
    plan(&suite, false);
    assert_int_equal(neph_stress_list_trials(&suite, false, &trials, NULL), NEPH_OK);
    assert_all_once(&suite, &trials);
    for (int i = 1; i < trials.count; i++)
        assert_true(trials.list[i].row >= trials.list[i - 1].row);
    neph_stress_finish(&suite);
}

static void test_workers_begin_with_long_trials(void **state)
{
    struct neph_stress_suite suite = {.scenes = NULL};
    struct neph_stress_trials trials;
    int later_count = 0;
    plan(&suite, false);
    assert_int_equal(neph_stress_list_trials(&suite, true, &trials, NULL), NEPH_OK);
    assert_all_once(&suite, &trials);
    for (int i = 1; i < trials.count; i++) {
        const struct neph_stress_trial *a = &trials.list[i - 1], *b = &trials.list[i];
        assert_true(b->is_later || !a->is_later);
        assert_true(a->is_later != b->is_later || a->cost >= b->cost);
    }
    for (int i = 0; i < trials.count; i++) {
        const struct neph_stress_trial *later = &trials.list[i];
        bool has_truth = !later->is_later;
        for (int k = 0; k < i && !has_truth; k++)
            has_truth = trials.list[k].row == later->row && !trials.list[k].is_later &&
                        suite.columns[trials.list[k].column].is_preset ==
                            suite.columns[later->column].is_preset;
        assert_true(has_truth);
        later_count += later->is_later;
    }
    assert_true(later_count > 0 && later_count < trials.count);
    neph_stress_finish(&suite);
}

/* ---- shares ---------------------------------------------------------------------------------- */

enum { PIECES = 10 };

/* Results received here; a file has one line for each trial, wherever it ran. */
struct heard {
    char path[SCRATCH_PATH_MAX];
    int times[PIECES];
    int whole; /* trials that ran here, at the end */
};

/* The last trial ends its process before it sends its result. */
static enum neph_status note(struct neph_worker *worker, void *context, struct neph_diag *diag)
{
    struct heard *heard = context;
    int number;
    while ((number = neph_worker_take_job(worker)) < PIECES) {
        char text[40];
        FILE *file = fopen(heard->path, "a");
        assert_non_null(file);
        fprintf(file, "%d;", number); /* by one write, which does not interleave */
        fclose(file);
        if (worker->index > 0 && number == PIECES - 1)
            _exit(1);
        snprintf(text, sizeof(text), "%d", number);
        neph_worker_send_message(worker, text);
        heard->whole += worker->index == 0 && heard->times[number] == 0;
    }
    return NEPH_OK;
}

static enum neph_status hear(const char *text, void *context, struct neph_diag *diag)
{
    struct heard *heard = context;
    if (text)
        heard->times[atoi(text)]++;
    return NEPH_OK;
}

static int count_in(const char *path, const char *line)
{
    char *text = NULL;
    size_t size = 0;
    int count = 0;
    assert_int_equal(neph_file_read(path, 1 << 20, &text, &size, NULL), NEPH_OK);
    for (const char *at = text; (at = strstr(at, line)); at++)
        count++;
    free(text);
    return count;
}

static void test_workers_receive_all_results(void **state)
{
    struct heard heard = {.whole = 0};
    scratch_path(state, heard.path, "notes");
    assert_int_equal(neph_pool_run(3, NULL, note, hear, &heard, NULL), NEPH_OK);
    for (int number = 0; number < PIECES; number++)
        assert_int_equal(heard.times[number], number < PIECES - 1);
    assert_int_equal(heard.whole, 1);
    assert_int_equal(count_in(heard.path, ";"), 2 * PIECES); /* each by one part, and the whole */
}

static void test_one_worker_sends_nothing(void **state)
{
    struct heard heard = {.whole = 0};
    scratch_path(state, heard.path, "notes");
    assert_int_equal(neph_pool_run(1, NULL, note, hear, &heard, NULL), NEPH_OK);
    assert_int_equal(heard.whole, PIECES);
    assert_int_equal(count_in(heard.path, ";"), PIECES);
}

static enum neph_status hear_nothing(const char *text, void *context, struct neph_diag *diag)
{
    return text ? neph_fail(diag, NEPH_ERR_IO, "the page cannot be written") : NEPH_OK;
}

/* A process that fails ends all others, also ones that are about to send. */
static void test_a_failed_worker_ends_all(void **state)
{
    struct heard heard = {.whole = 0};
    struct neph_diag diag = {.line = 0};
    scratch_path(state, heard.path, "notes");
    assert_int_equal(neph_pool_run(3, NULL, note, hear_nothing, &heard, &diag), NEPH_ERR_IO);
    assert_int_equal(heard.whole, 0);
}

/* ---- messages -------------------------------------------------------------------------------- */

static void assert_same_cell(const struct neph_stress_cell *a, const struct neph_stress_cell *b)
{
    assert_memory_equal(&a->value, &b->value, isnan(a->value) ? 0 : sizeof(a->value));
    assert_int_equal(isnan(a->value), isnan(b->value));
    assert_int_equal(a->verdict, b->verdict);
    assert_string_equal(a->why, b->why);
    assert_string_equal(a->evidence ? a->evidence : "none", b->evidence ? b->evidence : "none");
    assert_string_equal(a->frame_key ? a->frame_key : "none", b->frame_key ? b->frame_key : "none");
}

static void test_a_message_has_all_of_its_cells(void **state)
{
    struct neph_stress_cell told[3][1] = {
        {{0.1, NEPH_STRESS_KNOWN_FAIL, "\"why\"\n", "/store/a", "key"}},
        {{INFINITY, NEPH_STRESS_FAIL, "", NULL, "key"}},
        {{NAN, NEPH_STRESS_NO_NUMBER, "it broke", NULL, NULL}},
    };
    struct neph_stress_cell heard[3][1] = {{{NAN, NEPH_STRESS_NOT_YET, "", NULL, NULL}}};
    struct neph_stress_row from[3] = {{.cells = NULL}}, to[3] = {{.cells = NULL}};
    for (int r = 0; r < 3; r++) {
        from[r].cells = told[r];
        to[r].cells = heard[r];
    }
    const struct neph_stress_suite teller = {.column_count = 1, .row_count = 3, .rows = from};
    struct neph_stress_suite hearer = {.column_count = 1, .row_count = 3, .rows = to};
    const struct neph_stress_message message = {
        .row_count = 3,
        .frame_count = 32,
        .seconds = 1.5,
        .reference_count = 7,
        .reference_s = 0.25,
    };
    struct neph_stress_message read;
    struct neph_diag diag = {.line = 0};
    char *text = neph_stress_write_message(&message, &teller);
    neph_assert_ok(neph_stress_read_message(text, &hearer, &read, &diag), &diag);
    assert_int_equal(read.first_row, 0);
    assert_int_equal(read.row_count, 3);
    assert_int_equal(read.column, 0);
    assert_int_equal(read.frame_count, 32);
    assert_true(read.seconds == 1.5 && read.reference_s == 0.25);
    assert_int_equal(read.reference_count, 7);
    for (int r = 0; r < 3; r++)
        assert_same_cell(&told[r][0], &heard[r][0]);
    hearer.row_count = 2; /* from another plan */
    assert_int_equal(neph_stress_read_message(text, &hearer, &read, &diag), NEPH_ERR_INTERNAL);
    assert_int_equal(neph_stress_read_message("{}", &hearer, &read, &diag), NEPH_ERR_INTERNAL);
    assert_int_equal(neph_stress_read_message("no", &hearer, &read, &diag), NEPH_ERR_INTERNAL);
    free(text);
    neph_arena_finish(&hearer.arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_verdicts),
        cmocka_unit_test(test_failures_of_a_run),
        scratch_test(test_the_first_entry_that_fits_counts),
        scratch_test(test_lists_that_are_none),
        cmocka_unit_test(test_measures_are_read),
        cmocka_unit_test(test_measures_are_of_metrics_that_there_are),
        cmocka_unit_test(test_bad_values_are_counted_in_all_channels),
        cmocka_unit_test(test_every_expectation_is_of_something),
        cmocka_unit_test(test_every_scenario_can_be_run),
        cmocka_unit_test(test_presets_and_engines_choose_columns),
        cmocka_unit_test(test_engines_have_single_frame_measures),
        cmocka_unit_test(test_the_worst_is_first),
        cmocka_unit_test(test_one_process_goes_from_point_to_point),
        cmocka_unit_test(test_workers_begin_with_long_trials),
        scratch_test(test_workers_receive_all_results),
        scratch_test(test_one_worker_sends_nothing),
        scratch_test(test_a_failed_worker_ends_all),
        cmocka_unit_test(test_a_message_has_all_of_its_cells),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
