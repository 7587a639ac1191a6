/* SPDX-License-Identifier: MIT
 *
 * Guarantees of the store: an entry matches its key or is absent, simultaneous runs do not disturb
 * each other, and killed or failed runs leave nothing. All of this runs in one process: as in
 * containers, all runs have the same process number, which therefore identifies none.
 */
#include "tests/harness/store_test.h"

#include "base/lock.h"
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

static const char key_a[] = "aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa";
static const char key_b[] = "bbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbb";

static void publish(struct neph_store *store, const char *key, const char *frame, double seconds)
{
    struct neph_scratch *scratch = NULL;
    struct neph_diag diag = {0};
    json_t *record = json_pack("{s:f, s:s}", "wall_s", seconds, "engine", "none");
    neph_assert_ok(neph_store_begin(store, &scratch, &diag), &diag);
    scratch_put(neph_scratch_path(scratch), "frame.exr", frame);
    scratch_put(neph_scratch_path(scratch), "engine.log", "fine");
    scratch_put(neph_scratch_path(scratch), "beauty.png", "large");
    neph_assert_ok(neph_store_publish(store, key, scratch, record, &diag), &diag);
    neph_scratch_destroy(scratch);
    json_decref(record);
}

/* The seconds of an entry, or -1 if it is absent. */
static double find(struct neph_store *store, const char *key)
{
    char *path = NULL;
    json_t *record = NULL;
    if (!neph_store_find(store, key, &path, &record))
        return -1.0;
    assert_true(neph_path_exists(path));
    const double seconds = json_number_value(json_object_get(record, "wall_s"));
    free(path);
    json_decref(record);
    return seconds;
}

static void entry_path(void **state, const char *part, const char *key, char path[SCRATCH_PATH_MAX])
{
    char name[160];
    snprintf(name, sizeof(name), "store/%s/%s", part, key);
    scratch_path(state, path, name);
}

static void assert_gone(void **state, const char *part, const char *key)
{
    char path[SCRATCH_PATH_MAX];
    entry_path(state, part, key, path);
    assert_false(neph_path_exists(path));
}

/* Replaces text in the record of an entry by another of the same length. */
static void edit_record(void **state, const char *key, const char *old, const char *new)
{
    char folder[SCRATCH_PATH_MAX], *text = NULL;
    size_t size;
    entry_path(state, "frames", key, folder);
    char *path = neph_path_join(folder, "job.json");
    neph_assert_ok(neph_file_read(path, 65536, &text, &size, NULL), NULL);
    char *place = strstr(text, old);
    assert_non_null(place);
    memcpy(place, new, strlen(new));
    neph_assert_ok(neph_file_write(path, text, size, NULL), NULL);
    free(text);
    free(path);
}

static void test_published_entries_are_found(void **state)
{
    struct neph_store *store = open_store(state);
    char path[SCRATCH_PATH_MAX];
    neph_assert_close(find(store, key_a), -1.0, 0.0, 0.0);
    publish(store, key_a, "frame of a", 0.1);
    neph_assert_close(find(store, key_a), 0.1, 0.0, 0.0);
    neph_assert_close(find(store, key_b), -1.0, 0.0, 0.0);
    assert_int_equal(scratch_count_in(state, "store/tmp"), 0);
    snprintf(path, sizeof(path), "store/frames/%s", key_a);
    assert_int_equal(scratch_count_in(state, path), 3); /* frame, record, log */
    neph_store_close(store);
}

static void test_swapped_entries_are_absent(void **state)
{
    struct neph_store *store = open_store(state);
    char a[SCRATCH_PATH_MAX], b[SCRATCH_PATH_MAX], aside[SCRATCH_PATH_MAX];
    publish(store, key_a, "frame of a", 1.0);
    publish(store, key_b, "frame of b", 2.0);
    entry_path(state, "frames", key_a, a);
    entry_path(state, "frames", key_b, b);
    scratch_path(state, aside, "aside");
    assert_int_equal(rename(a, aside) | rename(b, a) | rename(aside, b), 0);
    neph_assert_close(find(store, key_a), -1.0, 0.0, 0.0);
    neph_assert_close(find(store, key_b), -1.0, 0.0, 0.0);
    assert_gone(state, "frames", key_a);
    assert_int_equal(scratch_count_in(state, "store/tmp"), 0);
    publish(store, key_a, "frame of a", 1.0);
    neph_assert_close(find(store, key_a), 1.0, 0.0, 0.0);
    neph_store_close(store);
}

static void test_edited_records_are_absent(void **state)
{
    static const char *const edits[][2] = {{"1.5", "0.5"}, {"none", "ours"}};
    struct neph_store *store = open_store(state);
    for (int i = 0; i < 2; i++) {
        publish(store, key_a, "frame", 1.5);
        edit_record(state, key_a, edits[i][0], edits[i][1]);
        neph_assert_close(find(store, key_a), -1.0, 0.0, 0.0);
        assert_gone(state, "frames", key_a);
    }
    neph_store_close(store);
}

static void test_records_without_signature_are_absent(void **state)
{
    struct neph_store *store = open_store(state);
    publish(store, key_a, "frame", 1.5);
    edit_record(state, key_a, "record_blake2b", "record_blake3b");
    neph_assert_close(find(store, key_a), -1.0, 0.0, 0.0);
    neph_store_close(store);
}

static void test_damaged_and_missing_files_are_absent(void **state)
{
    struct neph_store *store = open_store(state);
    static const char *const names[] = {"frame.exr", "job.json"};
    char folder[SCRATCH_PATH_MAX];
    entry_path(state, "frames", key_a, folder);
    for (int i = 0; i < 4; i++) {
        publish(store, key_a, "frame", 1.5);
        char *path = neph_path_join(folder, names[i / 2]);
        if (i % 2)
            unlink(path);
        else
            scratch_put(folder, names[i / 2], "torn");
        neph_assert_close(find(store, key_a), -1.0, 0.0, 0.0);
        free(path);
    }
    neph_store_close(store);
}

/* Values and images next to the frame are results, too; other images are not stored. */
static void test_edited_results_are_absent(void **state)
{
    static const char *const results[] = {"flicker.json", "flip_0.png"};
    struct neph_store *store = open_store(state);
    char folder[SCRATCH_PATH_MAX];
    entry_path(state, "frames", key_a, folder);
    for (int i = 0; i < 2; i++) {
        struct neph_scratch *scratch = NULL;
        json_t *record = json_pack("{s:f, s:[s]}", "wall_s", 1.0, "pictures", "flip_0.png");
        neph_assert_ok(neph_store_begin(store, &scratch, NULL), NULL);
        scratch_put(neph_scratch_path(scratch), "frame.exr", "frame");
        scratch_put(neph_scratch_path(scratch), "flicker.json", "{\"a4_p95\": 0.0191}");
        scratch_put(neph_scratch_path(scratch), "flip_0.png", "picture");
        scratch_put(neph_scratch_path(scratch), "pass_0.png", "large");
        neph_assert_ok(neph_store_publish(store, key_a, scratch, record, NULL), NULL);
        neph_scratch_destroy(scratch);
        json_decref(record);
        neph_assert_close(find(store, key_a), 1.0, 0.0, 0.0);
        char *dropped = neph_path_join(folder, "pass_0.png");
        assert_false(neph_path_exists(dropped));
        free(dropped);
        scratch_put(folder, results[i], "edited");
        neph_assert_close(find(store, key_a), -1.0, 0.0, 0.0);
    }
    neph_store_close(store);
}

static void test_the_first_good_entry_stays(void **state)
{
    struct neph_store *store = open_store(state);
    publish(store, key_a, "frame", 1.0);
    publish(store, key_a, "frame", 2.0);
    neph_assert_close(find(store, key_a), 1.0, 0.0, 0.0);
    edit_record(state, key_a, "1.0", "0.1");
    publish(store, key_a, "frame", 3.0);
    neph_assert_close(find(store, key_a), 3.0, 0.0, 0.0);
    assert_int_equal(scratch_count_in(state, "store/tmp"), 0);
    neph_store_close(store);
}

/* Two containers on a shared volume: both have process number 1. */
static void test_runs_at_the_same_time_have_folders_of_their_own(void **state)
{
    struct neph_store *first = open_store(state);
    struct neph_scratch *of_first = NULL, *of_second = NULL;
    neph_assert_ok(neph_store_begin(first, &of_first, NULL), NULL);
    scratch_put(neph_scratch_path(of_first), "frame.exr", "half");
    struct neph_store *second = open_store(state); /* opening it removes leftovers */
    neph_assert_ok(neph_store_begin(second, &of_second, NULL), NULL);
    char *half = neph_path_join(neph_scratch_path(of_first), "frame.exr");
    assert_true(neph_path_exists(half));
    assert_string_not_equal(neph_scratch_path(of_first), neph_scratch_path(of_second));
    neph_scratch_destroy(of_second);
    assert_true(neph_path_exists(half));
    neph_scratch_destroy(of_first);
    assert_int_equal(scratch_count_in(state, "store/tmp"), 0);
    free(half);
    neph_store_close(first);
    neph_store_close(second);
}

static void abandon(struct neph_store *store, const char *key)
{
    struct neph_scratch *scratch = NULL;
    char *kept = NULL;
    neph_assert_ok(neph_store_begin(store, &scratch, NULL), NULL);
    scratch_put(neph_scratch_path(scratch), "engine.log", "why");
    neph_store_abandon(store, key, scratch, &kept);
    neph_scratch_destroy(scratch);
    assert_non_null(kept);
    assert_true(neph_path_is_dir(kept));
    free(kept);
}

static void test_failed_tries_stay_until_their_key_succeeds(void **state)
{
    struct neph_store *store = open_store(state);
    abandon(store, key_a);
    abandon(store, key_a);
    abandon(store, key_b);
    neph_store_close(store);
    store = open_store(state);
    assert_int_equal(scratch_count_in(state, "store/failed"), 2);
    publish(store, key_a, "frame", 1.0);
    assert_gone(state, "failed", key_a);
    assert_int_equal(scratch_count_in(state, "store/failed"), 1);
    neph_store_close(store);
}

/* The leftovers of a killed process: a lock file without an owner and a folder, temporary files,
 * suspended work. */
static void leave_leftovers(void **state, const char *work)
{
    char path[SCRATCH_PATH_MAX];
    struct timespec long_ago[2] = {{.tv_sec = 1000000000}, {.tv_sec = 1000000000}};
    snprintf(path, sizeof(path), "%s.lock", work);
    close(neph_lock_create(path));
    neph_assert_ok(neph_dir_create(work, NULL), NULL);
    scratch_put(work, "frame.exr", "half");
    entry_path(state, "tmp", key_a, path);
    strcat(path, ".1"); /* from a version that used process numbers */
    neph_assert_ok(neph_dir_create(path, NULL), NULL);
    scratch_path(state, path, "store");
    scratch_put(path, ".neph-0123456789abcdef.tmp", "half");
    scratch_path(state, path, "store/resting");
    scratch_put(path, ".neph-0123456789abcdef.tmp", "half");
    scratch_put(path, key_a, "of a finished key");
    scratch_put(path, key_b, "old");
    entry_path(state, "resting", key_b, path);
    assert_int_equal(utimensat(AT_FDCWD, path, long_ago, 0), 0);
    entry_path(state, "failed", key_a, path);
    neph_assert_ok(neph_dir_create(path, NULL), NULL);
}

static void test_leftovers_are_swept(void **state)
{
    char work[SCRATCH_PATH_MAX], path[SCRATCH_PATH_MAX];
    struct neph_store *store = open_store(state);
    publish(store, key_a, "frame", 1.0);
    neph_store_close(store);
    const int count = scratch_count_in(state, "store");
    leave_leftovers(state, scratch_path(state, work, "store/tmp/work-0123456789abcdef"));
    store = open_store(state);
    assert_int_equal(scratch_count_in(state, "store/tmp"), 0);
    assert_int_equal(scratch_count_in(state, "store/resting"), 0);
    assert_int_equal(scratch_count_in(state, "store/failed"), 0);
    assert_int_equal(scratch_count_in(state, "store"), count);
    neph_assert_close(find(store, key_a), 1.0, 0.0, 0.0);
    neph_store_close(store);

    scratch_path(state, path, "store/resting"); /* work that can still be resumed stays */
    scratch_put(path, key_b, "yesterday's");
    neph_store_close(open_store(state));
    assert_int_equal(scratch_count_in(state, "store/resting"), 1);
}

static void test_folders_of_others_are_refused(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_store *store = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_dir_create(scratch_path(state, path, "store/frames"), NULL), NULL);
    scratch_put(path, "photo.jpg", "mine");
    assert_int_equal(neph_store_open(scratch_path(state, path, "store"), &store, &diag),
                     NEPH_ERR_USAGE);
    assert_int_equal(scratch_count_in(state, "store"), 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        scratch_test(test_published_entries_are_found),
        scratch_test(test_swapped_entries_are_absent),
        scratch_test(test_edited_records_are_absent),
        scratch_test(test_records_without_signature_are_absent),
        scratch_test(test_damaged_and_missing_files_are_absent),
        scratch_test(test_edited_results_are_absent),
        scratch_test(test_the_first_good_entry_stays),
        scratch_test(test_runs_at_the_same_time_have_folders_of_their_own),
        scratch_test(test_failed_tries_stay_until_their_key_succeeds),
        scratch_test(test_leftovers_are_swept),
        scratch_test(test_folders_of_others_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
