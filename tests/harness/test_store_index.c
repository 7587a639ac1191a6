/* SPDX-License-Identifier: MIT
 *
 * The store's database agrees with the frames, whatever happens to the database or its writer.
 */
#include "tests/harness/store_test.h"

#include "harness/run/history.h"
#include "harness/run/index.h"
#include "harness/run/store_keep.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static void name_key(char key[NEPH_HASH_HEX_SIZE], int number)
{
    snprintf(key, NEPH_HASH_HEX_SIZE, "%064x", (unsigned)number);
}

static enum neph_status publish(struct neph_store *store, int number, size_t bytes,
                                struct neph_diag *diag)
{
    char key[NEPH_HASH_HEX_SIZE];
    struct neph_scratch *scratch = NULL;
    json_t *record = json_pack("{s:s, s:s, s:s, s:f}", "scene", "fog", "engine", "exact", "version",
                               "revision 2", "wall_s", 0.5);
    char *frame = calloc(1, bytes + 1);
    name_key(key, number);
    memset(frame, 'x', bytes);
    enum neph_status status = neph_store_begin(store, &scratch, diag);
    if (!status) {
        char *path = neph_path_join(neph_scratch_path(scratch), "frame.exr");
        status = neph_file_write(path, frame, bytes, diag);
        free(path);
    }
    if (!status)
        status = neph_store_publish(store, key, scratch, record, diag);
    neph_scratch_destroy(scratch);
    json_decref(record);
    free(frame);
    return status;
}

static void must_publish(struct neph_store *store, int number, size_t bytes)
{
    struct neph_diag diag = {0};
    neph_assert_ok(publish(store, number, bytes, &diag), &diag);
}

static bool has_frame(struct neph_store *store, int number)
{
    char key[NEPH_HASH_HEX_SIZE], *path = NULL;
    json_t *record = NULL;
    name_key(key, number);
    const bool found = neph_store_find(store, key, &path, &record);
    free(path);
    json_decref(record);
    return found;
}

static json_t *export_store(struct neph_store *store)
{
    json_t *document = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_store_export(store, &document, &diag), &diag);
    return document;
}

/* The store's export equals `before`, which is freed. */
static void assert_exports(struct neph_store *store, json_t *before)
{
    json_t *after = export_store(store);
    assert_true(json_equal(before, after));
    json_decref(after);
    json_decref(before);
}

static int count_rows(struct neph_store *store, const char *list)
{
    json_t *document = export_store(store);
    const int count = (int)json_array_size(json_object_get(document, list));
    json_decref(document);
    return count;
}

static void remove_index(void **state)
{
    char path[SCRATCH_PATH_MAX];
    neph_assert_ok(neph_dir_remove(scratch_path(state, path, "store/index"), NULL), NULL);
}

/* A nightly run of two series and one frame; NULL: without a frame. */
static int64_t make_night(struct neph_store *store, const char *revision, double value,
                          const char *frame)
{
    json_t *frames = frame ? json_pack("[s]", frame) : json_array();
    struct neph_database *index = NULL;
    struct neph_diag diag = {0};
    int64_t night = 0;
    bool resumed = true;
    const struct neph_history_night who = {"quick", revision, "program", "host"};
    const struct neph_history_step step = {"validate fog", "done", "", "8x6", 1.5, NAN};
    const struct neph_measurement numbers[] = {
        {"fog/march/radiance/rel_rmse/all", "fixed", value, NAN, "device", "c0ffee"},
        {"fog/march/transmittance/max_abs/all", "fixed", NAN, NAN, "device", ""}};
    neph_assert_ok(neph_store_index(store, &index, &diag), &diag);
    neph_assert_ok(
        neph_history_begin(index, neph_store_folder(store), &who, &night, &resumed, &diag), &diag);
    assert_false(resumed);
    neph_assert_ok(neph_history_add(index, night, &step, numbers, 2, &diag), &diag);
    neph_assert_ok(neph_history_end(index, neph_store_folder(store), night, "pass", frames, &diag),
                   &diag);
    neph_database_close(index);
    json_decref(frames);
    return night;
}

static void accept(struct neph_store *store, const char *series, int64_t night,
                   enum neph_status expected)
{
    struct neph_database *index = NULL;
    neph_assert_ok(neph_store_index(store, &index, NULL), NULL);
    assert_int_equal(
        neph_history_accept(index, neph_store_folder(store), series, night, "me", "first", NULL),
        expected);
    neph_database_close(index);
}

/* ---- upgrade and damage ---------------------------------------------------------------------- */

static void test_a_store_without_a_database_is_taken_over(void **state)
{
    struct neph_store *store = open_store(state);
    for (int i = 0; i < 5; i++)
        must_publish(store, i, 100);
    accept(store, "*", make_night(store, "a", 0.25, "0000"), NEPH_OK);
    json_t *before = export_store(store);
    assert_int_equal(json_array_size(json_object_get(before, "jobs")), 5);
    assert_int_equal(json_array_size(json_object_get(before, "environments")), 1);
    neph_store_close(store);
    remove_index(state);
    store = open_store(state);
    assert_exports(store, before);
    neph_store_close(store);
}

static void damage(const char *path, uint64_t *random)
{
    struct stat info;
    assert_int_equal(stat(path, &info), 0);
    const off_t at = (off_t)(neph_test_random(random) % (uint64_t)info.st_size);
    if (neph_test_random(random) % 3 == 0) {
        assert_int_equal(truncate(path, at), 0);
        return;
    }
    char bytes[64];
    for (size_t i = 0; i < sizeof(bytes); i++)
        bytes[i] = (char)neph_test_random(random);
    const int fd = open(path, O_WRONLY | O_CLOEXEC);
    assert_int_equal(pwrite(fd, bytes, sizeof(bytes), at), sizeof(bytes));
    close(fd);
}

static void ignore_fault(const struct neph_store_fault *fault, void *context)
{
    assert_string_equal(fault->key, "");
}

/* For any damaged position, finished frames and runs are found: at once or, where SQLite cannot
 * detect a changed text, after a check. */
static void test_a_damaged_database_costs_nothing_that_was_finished(void **state)
{
    uint64_t random = 20261125;
    char path[SCRATCH_PATH_MAX];
    struct neph_store_sums sums;
    struct neph_store *store = open_store(state);
    for (int i = 0; i < 12; i++)
        must_publish(store, i, 10);
    make_night(store, "a", 0.25, NULL);
    json_t *before = export_store(store);
    neph_store_close(store);
    scratch_path(state, path, "store/index/neph.sqlite");
    for (int i = 0; i < neph_test_by_day(10, 300); i++) {
        damage(path, &random);
        store = open_store(state);
        for (int key = 0; key < 12; key++)
            assert_true(has_frame(store, key));
        neph_assert_ok(neph_store_check(store, true, ignore_fault, NULL, &sums, NULL), NULL);
        assert_exports(store, json_incref(before));
        neph_store_close(store);
    }
    json_decref(before);
}

static void test_a_database_of_a_later_neph_is_refused(void **state)
{
    static const char *const later[] = {"CREATE TABLE a (b)", "CREATE TABLE c (d)",
                                        "CREATE TABLE e (f)", "CREATE TABLE g (h)", NULL};
    char folder[SCRATCH_PATH_MAX], path[SCRATCH_PATH_MAX];
    struct neph_database *database = NULL;
    struct neph_store *store = NULL;
    struct neph_diag diag = {0};
    neph_store_close(open_store(state));
    remove_index(state);
    neph_assert_ok(neph_dir_create(scratch_path(state, folder, "store/index"), NULL), NULL);
    scratch_path(state, path, "store/index/neph.sqlite");
    neph_assert_ok(neph_database_open(path, later, &database, &diag), &diag);
    neph_database_close(database);
    assert_int_equal(neph_store_open(scratch_path(state, folder, "store"), &store, &diag),
                     NEPH_ERR_USAGE);
    assert_non_null(strstr(diag.message, "version 4"));
}

/* Failing steps leave the previous schema. */
static void test_migrations_are_whole_or_not_at_all(void **state)
{
    static const char *const first[] = {"CREATE TABLE a (b INTEGER) STRICT", NULL};
    static const char *const broken[] = {"CREATE TABLE a (b INTEGER) STRICT",
                                         "CREATE TABLE c (d INTEGER) STRICT; DROP TABLE none",
                                         NULL};
    static const char *const mended[] = {"CREATE TABLE a (b INTEGER) STRICT",
                                         "CREATE TABLE c (d INTEGER) STRICT", NULL};
    char path[SCRATCH_PATH_MAX];
    struct neph_database *database = NULL;
    struct neph_diag diag = {0};
    int64_t count = 0;
    scratch_path(state, path, "x.sqlite");
    neph_assert_ok(neph_database_open(path, first, &database, &diag), &diag);
    neph_assert_ok(neph_database_do(database, &diag, "INSERT INTO a VALUES (?)", "i", (int64_t)7),
                   &diag);
    assert_int_equal(neph_database_do(database, &diag, "INSERT INTO a VALUES (?)", "s", "seven"),
                     NEPH_ERR_INTERNAL); /* STRICT */
    neph_database_close(database);
    assert_int_equal(neph_database_open(path, broken, &database, &diag), NEPH_ERR_INTERNAL);
    neph_assert_ok(neph_database_open(path, mended, &database, &diag), &diag);
    neph_assert_ok(neph_database_count(database, &count, &diag, "SELECT b FROM a", ""), &diag);
    assert_int_equal(count, 7);
    neph_assert_ok(neph_database_count(database, &count, &diag, "PRAGMA user_version", ""), &diag);
    assert_int_equal(count, 2);
    neph_database_close(database);
}

/* ---- full disks, killed processes, other hosts ----------------------------------------------- */

static void limit_files(rlim_t bytes)
{
    struct rlimit limit;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &limit), 0);
    limit.rlim_cur = bytes;
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
}

/* Files with a size limit simulate a full disk. */
static void test_a_full_disk_is_survived(void **state)
{
    struct neph_diag diag = {0};
    signal(SIGXFSZ, SIG_IGN);
    struct neph_store *store = open_store(state);
    must_publish(store, 1, 1000);
    neph_store_close(store);
    limit_files(2000);
    store = open_store(state);
    must_publish(store, 2, 1000); /* fits; the database's page does not */
    assert_int_equal(publish(store, 3, 4000, &diag), NEPH_ERR_IO);
    assert_true(has_frame(store, 1));
    assert_true(has_frame(store, 2));
    assert_false(has_frame(store, 3));
    neph_store_close(store);
    store = open_store(state);
    assert_true(has_frame(store, 2));
    limit_files(RLIM_INFINITY);
    assert_int_equal(count_rows(store, "jobs"), 2);
    must_publish(store, 3, 4000);
    assert_int_equal(count_rows(store, "jobs"), 3);
    neph_store_close(store);
}

/* In a process of its own: publishes frames without end, five to each opened store. */
static void publish_for_ever(void **state, int first)
{
    for (;; first += 5) {
        struct neph_store *store = open_store(state);
        for (int k = 0; k < 5; k++)
            publish(store, first + k, 100, NULL);
        neph_store_close(store);
    }
}

/* Waits for a number of frames, and then for random microseconds: a slow disk has as many such
 * moments. */
static void wait_for_frames(void **state, int count, uint64_t *random)
{
    while (scratch_count_in(state, "store/frames") < count)
        usleep(200);
    usleep((useconds_t)neph_test_uniform(random, 0.0, 3000.0));
}

static void test_kills_at_random_moments_are_survived(void **state)
{
    uint64_t random = 9;
    int kept = 0;
    neph_store_close(open_store(state));
    for (int i = 0; i < neph_test_by_day(20, 100); i++) {
        const pid_t pid = fork();
        if (pid == 0)
            publish_for_ever(state, kept);
        wait_for_frames(state, kept + (int)neph_test_uniform(&random, 1.0, 8.0), &random);
        kill(pid, SIGKILL);
        waitpid(pid, NULL, 0);
        struct neph_store *store = open_store(state);
        const int frames = scratch_count_in(state, "store/frames");
        assert_true(frames > kept);
        assert_int_equal(scratch_count_in(state, "store/tmp"), 0);
        assert_int_equal(count_rows(store, "jobs"), frames);
        for (int k = 0; k < frames; k++)
            assert_true(has_frame(store, k));
        neph_store_close(store);
        kept = frames;
    }
    assert_int_equal(scratch_count_in(state, "store/index"), 1); /* none was moved away */
}

static void wait_for_all(const pid_t *pids, int count)
{
    for (int run = 0; run < count; run++) {
        int how = 1;
        waitpid(pids[run], &how, 0);
        assert_int_equal(how, 0);
    }
}

static void test_runs_at_the_same_time_lose_nothing(void **state)
{
    enum { RUNS = 4, FRAMES = 15 };
    pid_t pids[RUNS];
    for (int run = 0; run < RUNS; run++) {
        pids[run] = fork();
        if (pids[run] != 0)
            continue;
        for (int i = 0; i < FRAMES; i++) {
            struct neph_store *store = open_store(state);
            must_publish(store, 100 * run + i, 100);
            neph_store_close(store);
        }
        _exit(0);
    }
    wait_for_all(pids, RUNS);
    struct neph_store *store = open_store(state);
    assert_int_equal(count_rows(store, "jobs"), RUNS * FRAMES);
    neph_store_close(store);
}

/* ---- check and gc ---------------------------------------------------------------------------- */

static void count_fault(const struct neph_store_fault *fault, void *context)
{
    int *removed = context;
    assert_non_null(strstr(fault->why, "frame.exr was changed"));
    *removed += fault->removed;
}

static void test_check_finds_a_changed_frame_and_repairs(void **state)
{
    char folder[SCRATCH_PATH_MAX], name[128], key[NEPH_HASH_HEX_SIZE];
    struct neph_store_sums sums;
    int removed = 0;
    struct neph_store *store = open_store(state);
    must_publish(store, 1, 100);
    must_publish(store, 2, 100);
    name_key(key, 2);
    snprintf(name, sizeof(name), "store/frames/%s", key);
    scratch_put(scratch_path(state, folder, name), "frame.exr", "flipped");
    neph_assert_ok(neph_store_check(store, false, count_fault, &removed, &sums, NULL), NULL);
    assert_int_equal(sums.frames, 2);
    assert_int_equal(sums.bad, 1);
    assert_int_equal(removed, 0);
    neph_assert_ok(neph_store_check(store, true, count_fault, &removed, &sums, NULL), NULL);
    assert_int_equal(removed, 1);
    assert_false(neph_path_exists(folder));
    neph_assert_ok(neph_store_check(store, true, count_fault, &removed, &sums, NULL), NULL);
    assert_int_equal(sums.bad, 0);
    assert_int_equal(count_rows(store, "jobs"), 1);
    neph_store_close(store);
}

static void take_fault(const struct neph_store_fault *fault, void *context)
{
    int *faults = context;
    *faults += fault->key[0] == '\0' && strstr(fault->why, "night 1 ") != NULL;
}

/* SQLite has no checksums: a changed number in its file is formally valid. */
static void test_check_compares_runs_and_documents(void **state)
{
    struct neph_store_sums sums;
    struct neph_database *index = NULL;
    struct neph_store *store = open_store(state);
    int faults = 0;
    make_night(store, "a", 0.25, NULL);
    json_t *before = export_store(store);
    neph_assert_ok(neph_store_check(store, false, take_fault, &faults, &sums, NULL), NULL);
    assert_int_equal(faults + (int)sums.bad, 0);
    neph_assert_ok(neph_store_index(store, &index, NULL), NULL);
    neph_assert_ok(neph_database_do(index, NULL,
                                    "UPDATE measurements SET value = 0.26 WHERE value "
                                    "= 0.25",
                                    ""),
                   NULL);
    neph_database_close(index);
    neph_assert_ok(neph_store_check(store, false, take_fault, &faults, &sums, NULL), NULL);
    assert_int_equal(faults, 1);
    neph_assert_ok(neph_store_check(store, true, take_fault, &faults, &sums, NULL), NULL);
    neph_assert_ok(neph_store_check(store, true, take_fault, &faults, &sums, NULL), NULL);
    assert_int_equal(faults, 2);
    assert_exports(store, before);
    neph_store_close(store);
}

static void count_any_fault(const struct neph_store_fault *fault, void *context)
{
    int *removed = context;
    *removed += fault->removed;
}

/* Two nightly runs; the second is accepted and has a frame, and its document is changed. */
static json_t *spoil_a_document(void **state, struct neph_store *store, const char *text)
{
    char folder[SCRATCH_PATH_MAX], path[SCRATCH_PATH_MAX];
    make_night(store, "a", 0.25, NULL);
    accept(store, "*", make_night(store, "b", 0.5, "0000"), NEPH_OK);
    scratch_path(state, folder, "store/history");
    if (text)
        scratch_put(folder, "night-000002.json", text);
    else
        assert_int_equal(unlink(scratch_path(state, path, "store/history/night-000002.json")), 0);
    return export_store(store);
}

/* A rebuilt database would not contain the run, and eviction would remove frames of a baseline. */
static void test_a_repair_keeps_undocumented_runs(void **state)
{
    struct neph_store_sums sums;
    struct neph_diag diag = {0};
    int removed = 0;
    struct neph_store *store = open_store(state);
    json_t *before = spoil_a_document(state, store, NULL);
    assert_int_equal(neph_store_check(store, true, count_any_fault, &removed, &sums, &diag),
                     NEPH_ERR_NOT_FOUND);
    assert_non_null(strstr(diag.message, "night-000002.json"));
    assert_exports(store, before);
    assert_int_equal(removed, 0);
    neph_store_close(store);
}

static void test_a_repair_writes_a_torn_document_from_its_rows(void **state)
{
    struct neph_store_sums sums;
    int removed = 0;
    struct neph_store *store = open_store(state);
    json_t *before = spoil_a_document(state, store, "{\"torn");
    for (int repairs = 0; repairs < 2; repairs++) {
        neph_assert_ok(neph_store_check(store, repairs, count_any_fault, &removed, &sums, NULL),
                       NULL);
        assert_int_equal(sums.bad, 1);
        assert_int_equal(sums.nights, 2);
        assert_int_equal(removed, repairs);
    }
    neph_assert_ok(neph_store_check(store, true, count_any_fault, &removed, &sums, NULL), NULL);
    assert_int_equal(sums.bad, 0);
    assert_exports(store, before);
    neph_store_close(store);
}

static void set_age(void **state, int number, int hours)
{
    char path[SCRATCH_PATH_MAX], name[128], key[NEPH_HASH_HEX_SIZE];
    const time_t then = time(NULL) - 3600 * hours;
    const struct timespec times[2] = {{.tv_sec = then}, {.tv_sec = then}};
    name_key(key, number);
    snprintf(name, sizeof(name), "store/frames/%s/job.json", key);
    assert_int_equal(utimensat(AT_FDCWD, scratch_path(state, path, name), times, 0), 0);
}

static bool lies_in(void **state, int number)
{
    char path[SCRATCH_PATH_MAX], name[128], key[NEPH_HASH_HEX_SIZE];
    name_key(key, number);
    snprintf(name, sizeof(name), "store/frames/%s", key);
    return neph_path_exists(scratch_path(state, path, name));
}

static struct neph_store_gc collect(struct neph_store *store, int64_t limit_bytes)
{
    struct neph_store_gc gc;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_store_gc(store, limit_bytes, 3600.0, &gc, &diag), &diag);
    return gc;
}

/* Frame 1 is the oldest and belongs to an accepted run; frame 2 is next, but was just used; frame 6
 * is new. */
static void test_gc_takes_the_longest_unused_and_no_baseline(void **state)
{
    char key[NEPH_HASH_HEX_SIZE];
    struct neph_store *store = open_store(state);
    for (int i = 1; i <= 6; i++) {
        must_publish(store, i, 10000);
        if (i < 6)
            set_age(state, i, 20 - i);
    }
    name_key(key, 1);
    accept(store, "*", make_night(store, "a", 0.25, key), NEPH_OK);
    assert_true(has_frame(store, 2));
    struct neph_store_gc gc = collect(store, 45000);
    assert_int_equal(gc.frames_before, 6);
    assert_int_equal(gc.frames_removed, 2);
    assert_true(gc.fits);
    const bool stays[] = {true, true, false, false, true, true};
    for (int i = 1; i <= 6; i++)
        assert_int_equal(lies_in(state, i), stays[i - 1]);
    gc = collect(store, 0);
    assert_false(gc.fits);
    assert_int_equal(gc.frames_removed, 1);
    assert_true(lies_in(state, 1) && lies_in(state, 2) && lies_in(state, 6));
    assert_true(gc.bytes_of_baselines > 10000 && gc.bytes_in_use > 20000);
    neph_store_close(store);
}

static void test_gc_reports_failed_removals(void **state)
{
    char tmp[SCRATCH_PATH_MAX], away[SCRATCH_PATH_MAX];
    struct neph_store *store = open_store(state);
    must_publish(store, 1, 100);
    set_age(state, 1, 5);
    scratch_path(state, tmp, "store/tmp");
    assert_int_equal(rename(tmp, scratch_path(state, away, "store/away")), 0);
    struct neph_store_gc gc = collect(store, 0);
    assert_int_equal(rename(away, tmp), 0);
    assert_false(gc.fits);
    assert_int_equal(gc.frames_that_stayed, 1);
    assert_int_equal(gc.frames_removed + gc.bytes_in_use, 0);
    gc = collect(store, 0);
    assert_true(gc.fits && gc.frames_removed == 1 && gc.frames_that_stayed == 0);
    neph_store_close(store);
}

/* ---- several hosts --------------------------------------------------------------------------- */

/* From now on this process is the host with this folder as its disk; "": a single host. */
static void be_host(void **state, const char *disk)
{
    char path[SCRATCH_PATH_MAX];
    setenv("NEPH_STORE_INDEX", disk[0] ? scratch_path(state, path, disk) : "", 1);
}

/* Each host has a database of its own, and all databases agree. */
static void test_hosts_with_databases_of_their_own_agree(void **state)
{
    char path[SCRATCH_PATH_MAX];
    be_host(state, "disk_a");
    struct neph_store *store = open_store(state);
    must_publish(store, 1, 10);
    accept(store, "*", make_night(store, "a", 0.25, NULL), NEPH_OK);
    json_t *of_a = export_store(store);
    be_host(state, "disk_b");
    struct neph_store *other = open_store(state);
    json_t *of_b = export_store(other);
    assert_true(json_array_size(json_object_get(of_a, "nights")) == 1 && json_equal(of_a, of_b));
    must_publish(other, 2, 10);
    assert_int_equal(make_night(other, "b", 0.5, NULL), 2);
    neph_store_close(other);
    be_host(state, "disk_a");
    assert_int_equal(count_rows(store, "jobs"), 2);
    assert_int_equal(count_rows(store, "nights"), 2);
    neph_store_close(store);
    assert_false(neph_path_exists(scratch_path(state, path, "store/index")));
    be_host(state, "");
    json_decref(of_b);
    json_decref(of_a);
}

/* A new store at the path of a removed one does not inherit its rows. */
static void test_a_store_that_was_made_again_is_another(void **state)
{
    char path[SCRATCH_PATH_MAX];
    be_host(state, "disk");
    struct neph_store *store = open_store(state);
    make_night(store, "a", 0.25, NULL);
    neph_store_close(store);
    neph_assert_ok(neph_dir_remove(scratch_path(state, path, "store"), NULL), NULL);
    store = open_store(state);
    assert_int_equal(count_rows(store, "nights"), 0);
    assert_int_equal(make_night(store, "a", 0.25, NULL), 1);
    neph_store_close(store);
    be_host(state, "");
}

static void test_where_no_database_is_wanted_frames_are_made_all_the_same(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_database *index = NULL;
    struct neph_diag diag = {0};
    setenv("NEPH_STORE_INDEX", "none", 1);
    struct neph_store *store = open_store(state);
    must_publish(store, 1, 10);
    assert_true(has_frame(store, 1));
    assert_int_equal(neph_store_index(store, &index, &diag), NEPH_ERR_USAGE);
    assert_non_null(strstr(diag.message, "NEPH_STORE_INDEX is none"));
    neph_store_close(store);
    assert_false(neph_path_exists(scratch_path(state, path, "store/index")));
    be_host(state, "");
    store = open_store(state);
    assert_int_equal(count_rows(store, "jobs"), 1);
    neph_store_close(store);
}

/* A nightly run of jobs that begins on one host and ends on another. */
static void test_a_run_across_two_hosts_is_one_run(void **state)
{
    struct neph_database *index = NULL;
    const struct neph_history_night who = {"quick", "a", "program", "host"};
    const struct neph_history_step step = {"validate fog", "done", "", "8x6", 1.5, NAN};
    const struct neph_measurement number = {"fog", "fixed", 1.0, NAN, "device", ""};
    int64_t night = 0;
    bool resumed = true;
    json_t *none = json_array();
    be_host(state, "disk_a");
    struct neph_store *store = open_store(state);
    const char *folder = neph_store_folder(store);
    neph_assert_ok(neph_store_index(store, &index, NULL), NULL);
    neph_assert_ok(neph_history_begin(index, folder, &who, &night, &resumed, NULL), NULL);
    neph_database_close(index);
    be_host(state, "disk_b");
    neph_assert_ok(neph_store_index(store, &index, NULL), NULL);
    neph_assert_ok(neph_history_adopt(index, folder, &who, night, "2026-01-31T00:00:00Z", NULL),
                   NULL);
    neph_assert_ok(neph_history_add(index, night, &step, &number, 1, NULL), NULL);
    neph_assert_ok(neph_history_end(index, folder, night, "pass", none, NULL), NULL);
    assert_int_equal(neph_history_adopt(index, folder, &who, night, "2026-01-31T00:00:00Z", NULL),
                     NEPH_ERR_IO); /* the run is finished */
    neph_database_close(index);
    be_host(state, "disk_a");
    json_t *document = export_store(store);
    const json_t *nights = json_object_get(document, "nights");
    assert_int_equal(json_array_size(nights), 1);
    assert_string_equal(neph_json_text(json_array_get(nights, 0), "started_utc"),
                        "2026-01-31T00:00:00Z");
    json_decref(document);
    neph_store_close(store);
    be_host(state, "");
    json_decref(none);
}

/* ---- nightly runs ---------------------------------------------------------------------------- */

static void test_a_killed_run_resumes(void **state)
{
    struct neph_store *store = open_store(state);
    struct neph_database *index = NULL;
    const struct neph_history_night who = {"quick", "a", "program", "host"},
                                    other = {"quick", "b", "program", "host"};
    const struct neph_history_step step = {"validate fog", "done", "", "8x6", 1.5, NAN};
    const struct neph_measurement number = {"fog", "fixed", 1.0, NAN, "device", ""};
    int64_t first = 0, second = 0, count = 0;
    bool resumed = true;
    neph_assert_ok(neph_store_index(store, &index, NULL), NULL);
    neph_assert_ok(
        neph_history_begin(index, neph_store_folder(store), &who, &first, &resumed, NULL), NULL);
    assert_false(resumed);
    neph_assert_ok(neph_history_add(index, first, &step, &number, 1, NULL), NULL);
    neph_database_close(index); /* without finishing the run */
    neph_assert_ok(neph_store_index(store, &index, NULL), NULL);
    neph_assert_ok(
        neph_history_begin(index, neph_store_folder(store), &who, &second, &resumed, NULL), NULL);
    assert_true(resumed && first == second);
    neph_assert_ok(
        neph_history_begin(index, neph_store_folder(store), &other, &second, &resumed, NULL), NULL);
    assert_false(resumed);
    neph_assert_ok(
        neph_database_count(index, &count, NULL, "SELECT count(*) FROM measurements", ""), NULL);
    assert_int_equal(count, 0);
    neph_database_close(index);
    neph_store_close(store);
}

static void test_acceptances_are_added_and_never_changed(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_store *store = open_store(state);
    const int64_t first = make_night(store, "a", 0.25, NULL),
                  second = make_night(store, "b", 0.5, NULL);
    accept(store, "*", first, NEPH_OK);
    accept(store, "fog/march/radiance/rel_rmse/all", second, NEPH_OK);
    accept(store, "fog/none", second, NEPH_ERR_NOT_FOUND);
    accept(store, "*", 99, NEPH_ERR_NOT_FOUND);
    assert_int_equal(count_rows(store, "acceptances"), 2);
    assert_int_equal(count_rows(store, "nights"), 2);
    scratch_put(scratch_path(state, path, "store/history"), "night-000002.json", "{\"torn");
    neph_store_close(store);
    remove_index(state);
    store = open_store(state); /* entries that depend on a torn document are reported and skipped */
    assert_int_equal(count_rows(store, "nights"), 1);
    neph_store_close(store);
}

/* A torn document is not overwritten, and no later run gets its number: an old acceptance would
 * make that run a baseline. */
static void test_numbers_of_torn_documents_are_not_given_again(void **state)
{
    char folder[SCRATCH_PATH_MAX], path[SCRATCH_PATH_MAX], *text = NULL;
    size_t size;
    struct neph_store *store = open_store(state);
    make_night(store, "a", 0.25, NULL);
    accept(store, "*", make_night(store, "b", 0.5, NULL), NEPH_OK);
    accept(store, "*", 1, NEPH_OK);
    neph_store_close(store);
    scratch_path(state, folder, "store/history");
    scratch_put(folder, "night-000002.json", "{\"torn");
    scratch_put(folder, "accept-000002.json", "{\"torn, too");
    remove_index(state);
    store = open_store(state);
    assert_int_equal(make_night(store, "c", 0.75, NULL), 3);
    accept(store, "*", 3, NEPH_OK);
    assert_int_equal(count_rows(store, "acceptances"), 2);
    static const char *const torn[][2] = {{"store/history/night-000002.json", "{\"torn"},
                                          {"store/history/accept-000002.json", "{\"torn, too"}};
    for (size_t i = 0; i < COUNT(torn); i++) {
        neph_assert_ok(
            neph_file_read(scratch_path(state, path, torn[i][0]), 1000, &text, &size, NULL), NULL);
        assert_string_equal(text, torn[i][1]);
        free(text);
    }
    assert_true(neph_path_exists(scratch_path(state, path, "store/history/accept-000003.json")));
    neph_store_close(store);
}

/* The database would refuse its rows; a good database would be moved away at each opening. */
static void test_a_step_without_time_skips_its_run(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_store *store = open_store(state);
    make_night(store, "a", 0.25, NULL);
    scratch_put(
        scratch_path(state, path, "store/history"), "night-000002.json",
        "{\"format\": \"neph-night-1\", \"ended_utc\": \"2026\", \"steps\": [{\"name\": \"a\"}]}");
    neph_store_close(store);
    store = open_store(state);
    assert_int_equal(count_rows(store, "nights"), 1);
    neph_store_close(store);
    assert_int_equal(scratch_count_in(state, "store/index"), 1); /* none was moved away */
}

/* Each has a number and a document. */
/* On two hosts, which share only files. */
static void test_acceptances_at_the_same_time_are_all_kept(void **state)
{
    enum { RUNS = 4, EACH = 5 };
    pid_t pids[RUNS];
    struct neph_store *store = open_store(state);
    make_night(store, "a", 0.25, NULL);
    for (int run = 0; run < RUNS; run++) {
        pids[run] = fork();
        if (pids[run] != 0)
            continue;
        be_host(state, run % 2 == 0 ? "" : "disk_b");
        for (int i = 0; i < EACH; i++)
            accept(store, "*", 1, NEPH_OK);
        _exit(0);
    }
    wait_for_all(pids, RUNS);
    assert_int_equal(count_rows(store, "acceptances"), RUNS * EACH);
    neph_store_close(store);
    assert_int_equal(scratch_count_in(state, "store/index"), 1); /* none was moved away */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        scratch_test(test_a_store_without_a_database_is_taken_over),
        scratch_test(test_a_damaged_database_costs_nothing_that_was_finished),
        scratch_test(test_a_database_of_a_later_neph_is_refused),
        scratch_test(test_migrations_are_whole_or_not_at_all),
        scratch_test(test_a_full_disk_is_survived),
        scratch_test(test_kills_at_random_moments_are_survived),
        scratch_test(test_runs_at_the_same_time_lose_nothing),
        scratch_test(test_check_finds_a_changed_frame_and_repairs),
        scratch_test(test_check_compares_runs_and_documents),
        scratch_test(test_a_repair_keeps_undocumented_runs),
        scratch_test(test_a_repair_writes_a_torn_document_from_its_rows),
        scratch_test(test_gc_takes_the_longest_unused_and_no_baseline),
        scratch_test(test_gc_reports_failed_removals),
        scratch_test(test_hosts_with_databases_of_their_own_agree),
        scratch_test(test_a_store_that_was_made_again_is_another),
        scratch_test(test_where_no_database_is_wanted_frames_are_made_all_the_same),
        scratch_test(test_a_run_across_two_hosts_is_one_run),
        scratch_test(test_a_killed_run_resumes),
        scratch_test(test_acceptances_are_added_and_never_changed),
        scratch_test(test_numbers_of_torn_documents_are_not_given_again),
        scratch_test(test_a_step_without_time_skips_its_run),
        scratch_test(test_acceptances_at_the_same_time_are_all_kept),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
