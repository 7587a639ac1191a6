/* SPDX-License-Identifier: MIT
 *
 * Input and output files of a nightly run's jobs: exact to the last bit, for this run only,
 * complete or absent.
 */
#include "tests/base/scratch.h"

#include "harness/night/jobs.h"

#include <time.h>

static const struct neph_history_night who = {"quick; a b", "r1", "program", "host"};
static const struct neph_night_step step = {
    .suite = NEPH_NIGHT_STRESS, .name = "failure fog", .words = {"no", "such", "verb"}};

static void begin(void **state, struct neph_arena *arena, int64_t night,
                  struct neph_night_jobs *jobs, double begin_by)
{
    const struct scratch *scratch = *state;
    struct neph_diag diag = {.line = 0};
    const struct neph_night_job job = {600.0, begin_by};
    neph_assert_ok(neph_night_jobs_begin(scratch->folder, arena, night, "2026-01-31T00:00:00Z",
                                         &who, jobs, &diag),
                   &diag);
    neph_assert_ok(neph_night_jobs_add(jobs, step.name, &job, &diag), &diag);
    neph_assert_ok(neph_night_jobs_write(jobs, &diag), &diag);
}

static void read_jobs(void **state, struct neph_arena *arena, struct neph_night_jobs *jobs)
{
    const struct scratch *scratch = *state;
    bool found = false;
    neph_assert_ok(neph_night_jobs_read(scratch->folder, arena, jobs, &found, NULL), NULL);
    assert_true(found);
}

static bool look(const struct neph_night_jobs *jobs, struct neph_history_step *record,
                 struct neph_night_numbers *numbers)
{
    bool found = false;
    neph_assert_ok(neph_night_jobs_load(jobs, &step, &found, record, numbers, NULL), NULL);
    return found;
}

static void test_results_are_exact_across_hosts(void **state)
{
    struct neph_arena arena = {NULL};
    struct neph_night_jobs here, there;
    struct neph_history_step record = {step.name, "done", "", "96x54", 1.0 / 3.0, NAN};
    struct neph_measurement list[] = {{"a", "fixed", 0.1 + 0.2, NAN, "D", "0123"},
                                      {"b", "drawn", NAN, 1e-300, "E, \"F\"", ""}};
    struct neph_night_numbers numbers = {list, 2, "96x54"}, found;
    begin(state, &arena, 7, &here, INFINITY);
    read_jobs(state, &arena, &there);
    assert_true(there.night == 7 && neph_night_jobs_match(&there, &who));
    assert_string_equal(there.name, here.name);
    assert_false(look(&there, &record, &found));
    neph_assert_ok(neph_night_jobs_store(&here, &step, &record, &numbers, NULL), NULL);
    struct neph_history_step read_back = {NULL};
    assert_true(look(&there, &read_back, &found));
    assert_string_equal(read_back.outcome, "done");
    assert_string_equal(read_back.size, "96x54");
    assert_true(read_back.wall_s == record.wall_s && isnan(read_back.calibration_s));
    assert_int_equal(found.count, 2);
    assert_true(found.list[0].value == list[0].value && isnan(found.list[0].standard_error));
    assert_true(isnan(found.list[1].value) && found.list[1].standard_error == 1e-300);
    assert_string_equal(found.list[1].environment, "E, \"F\"");
    assert_string_equal(found.list[0].frame, "0123");
    assert_string_equal(found.list[1].frame, "");
    neph_night_jobs_finish(&there);
    neph_night_jobs_finish(&here);
    neph_arena_finish(&arena);
}

static void test_foreign_or_torn_results_are_ignored(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_arena arena = {NULL};
    struct neph_night_jobs old, young;
    struct neph_history_step record = {step.name, "done", "", "", 1.0, NAN};
    struct neph_night_numbers numbers = {.count = 0};
    begin(state, &arena, 7, &old, INFINITY);
    begin(state, &arena, 8, &young, INFINITY);
    assert_string_not_equal(old.name, young.name);
    neph_assert_ok(neph_night_jobs_store(&old, &step, &record, &numbers, NULL),
                   NULL); /* too late */
    assert_false(look(&young, &record, &numbers));
    neph_assert_ok(neph_night_jobs_store(&young, &step, &record, &numbers, NULL), NULL);
    assert_true(look(&young, &record, &numbers));
    scratch_write(scratch_path(state, path, "nightly/jobs/failure_fog.json"), "{\"format", 8);
    assert_false(look(&young, &record, &numbers));
    for (int i = 0; i < 3; i++) { /* another plan, revision or program; hosts may differ */
        struct neph_history_night other = who;
        *(i == 0 ? &other.plan : i == 1 ? &other.revision : &other.program) = "x";
        assert_false(neph_night_jobs_match(&young, &other));
    }
    neph_night_jobs_finish(&young);
    neph_night_jobs_finish(&old);
    neph_arena_finish(&arena);
}

/* A step that cannot run records whether it was tried. */
static void run(void **state, double begin_by, const char *expected)
{
    char path[SCRATCH_PATH_MAX];
    const struct scratch *scratch = *state;
    struct neph_diag diag = {.line = 0};
    struct neph_arena arena = {NULL};
    struct neph_night_jobs jobs;
    struct neph_history_step record;
    struct neph_night_numbers numbers;
    struct neph_step_place place = {.arena = &arena, .program_path = "/bin/false", .host = "host"};
    neph_assert_ok(neph_dir_create(scratch_path(state, path, "store"), NULL), NULL);
    begin(state, &arena, 7, &jobs, begin_by);
    for (int i = 0; i < 2; i++) /* the second time nothing is left to do */
        neph_assert_ok(
            neph_night_jobs_run(&jobs, &step, scratch->folder, jobs.folder, &place, &diag), &diag);
    assert_true(look(&jobs, &record, &numbers));
    assert_string_equal(record.outcome, expected);
    assert_true(neph_path_is_dir(scratch_path(state, path, "store"))); /* a link to it is removed */
    neph_night_jobs_finish(&jobs);
    neph_arena_finish(&arena);
}

static void test_a_job_that_is_too_late_does_not_begin(void **state)
{
    run(state, (double)time(NULL) - 5.0, "not run");
    run(state, (double)time(NULL) + 600.0, "failed");
    run(state, INFINITY, "failed");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        scratch_test(test_results_are_exact_across_hosts),
        scratch_test(test_foreign_or_torn_results_are_ignored),
        scratch_test(test_a_job_that_is_too_late_does_not_begin),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
