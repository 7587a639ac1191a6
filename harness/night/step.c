/* SPDX-License-Identifier: MIT */
#include "harness/night/step.h"

#include "base/child.h"
#include "base/clock.h"
#include "base/files.h"
#include "base/threads.h"
#include "metrics/statistics.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Compiles only when this file handles every suite. */
_Static_assert(NEPH_NIGHT_SUITES == 5, "a new kind");

const char neph_step_done[] = "done";

/* The largest relative difference between the calibrations before and after a step. */
static const double steadiness = 0.10;

static const size_t log_limit_bytes = 64 << 20;
enum { WORDS_MAX = NEPH_STEP_WORDS + 5 };

/* ---- a command ------------------------------------------------------------------------------- */

enum neph_status neph_step_place_settle(struct neph_step_place *place, bool has_database,
                                        struct neph_diag *diag)
{
    const char *const but[] = {has_database ? NULL : "NEPH_STORE_INDEX=", NULL};
    int count = 0;
    if (!has_database)
        place->variables[count++] = "NEPH_STORE_INDEX=none";
    if (neph_child_inherit(&place->variables[count], NEPH_STEP_VARIABLES - count, but) < 0)
        return neph_fail(diag, NEPH_ERR_USAGE, "the environment has more than %d variables",
                         NEPH_STEP_VARIABLES - 2);
    return NEPH_OK;
}

const char *neph_step_file(struct neph_arena *arena, const char *folder,
                           const struct neph_night_step *step, const char *ending)
{
    char name[NEPH_STEP_LOG_SIZE];
    neph_night_step_log(step, name);
    return neph_arena_format(arena, "%s/%s%s", folder, name, ending);
}

/* The result file of each suite; NULL: the suite prints its JSON, with warnings before and after
 * it. */
static const char *const result_files[] = {
    [NEPH_NIGHT_CATALOG] = "report/data.json",
    [NEPH_NIGHT_PHYSICS] = "report/data.json",
    [NEPH_NIGHT_STRESS] = "stress.json",
    [NEPH_NIGHT_SWEEP] = "sweep.json",
    [NEPH_NIGHT_SPEED] = NULL,
};

static enum neph_status read_results(const char *path, bool is_log, json_t **document,
                                     struct neph_diag *diag)
{
    char *text = NULL;
    size_t size;
    const enum neph_status status = neph_file_read(path, log_limit_bytes, &text, &size, diag);
    if (status)
        return status;
    *document = is_log ? neph_night_find_document(text) : json_loadb(text, size, 0, NULL);
    free(text);
    return *document ? NEPH_OK
                     : neph_fail(diag, NEPH_ERR_ENGINE, "there are no results in '%s'", path);
}

/* Exit code 1 means that gates failed. The step is done then: its numbers report the failure. */
static enum neph_status run_child(const struct neph_step_place *place,
                                  const struct neph_night_step *step, const char *output,
                                  const char *log, double limit_s, double *wall_s,
                                  struct neph_diag *diag)
{
    const char *words[WORDS_MAX] = {place->program_path};
    int count = 1;
    for (int i = 0; step->words[i]; i++)
        words[count++] = step->words[i];
    const char *const rest[] = {"-q", "-o", output, result_files[step->suite] ? NULL : "--json"};
    for (int i = 0; i < 4 && rest[i] && count < WORDS_MAX - 1; i++)
        words[count++] = rest[i];
    const struct neph_child_params child = {.argv = words,
                                            .log_path = log,
                                            .home = getenv("HOME"),
                                            .environment = place->variables,
                                            .time_limit_s = limit_s};
    struct neph_child_result result = {.exit_code = -1};
    const enum neph_status status = neph_child_run(&child, &result, diag);
    *wall_s = result.wall_s;
    const bool has_failed_gates = status == NEPH_ERR_ENGINE && result.signal == 0 &&
                                  result.exit_code == 1;
    return has_failed_gates ? NEPH_OK : status;
}

/* Removes the result file of an earlier run before it starts the command. */
static enum neph_status run_command(const struct neph_step_place *place,
                                    const struct neph_night_step *step, const char *output,
                                    const char *log, double limit_s, json_t **document,
                                    double *wall_s, struct neph_diag *diag)
{
    const char *file = result_files[step->suite];
    const char *path = file ? neph_arena_format(place->arena, "%s/%s", output, file) : log;
    enum neph_status status = neph_arena_check(place->arena, diag);
    if (!status && unlink(path) != 0 && errno != ENOENT && errno != ENOTDIR)
        status = neph_fail(diag, NEPH_ERR_IO, "cannot remove '%s': %s", path, strerror(errno));
    if (!status)
        status = run_child(place, step, output, log, limit_s, wall_s, diag);
    return status ? status : read_results(path, !file, document, diag);
}

/* ---- calibration of the host ----------------------------------------------------------------- */

enum { SIDE = 96, RAYS_PER_ROW = 64, ROWS = 96, STEPS = 192, TRIES = 5 };

struct kernel {
    float *density; /* SIDE^3 voxels, larger than a second-level cache */
    double *sums;   /* one for each row; keeps the compiler from removing the work */
};

/* Rays through a grid: each step reads a voxel and evaluates an exponential and some products. */
static void march_row(int row, void *context)
{
    struct kernel *work = context;
    double sum = 0.0;
    for (int ray = 0; ray < RAYS_PER_ROW; ray++) {
        double transmittance = 1.0;
        for (int step = 0; step < STEPS; step++) {
            const int x = (row + step) % SIDE, y = (ray * 7 + step * 3) % SIDE,
                      z = (row * 5 + ray + step * 11) % SIDE;
            const double density = work->density[((size_t)z * SIDE + (size_t)y) * SIDE + (size_t)x];
            sum += transmittance * density;
            transmittance *= exp(-0.01 * density);
        }
    }
    work->sums[row] = sum;
}

/* Measure the time of a fixed workload on all processors; durations are compared as multiples of
 * it. Its ratio of arithmetic to memory access is about the ray marcher's. The result is the median
 * of five trials of about 0.1 s. NEPH_ERR_MEMORY, NEPH_ERR_INTERRUPTED. */
static enum neph_status calibrate(double *seconds, struct neph_diag *diag)
{
    const size_t count = (size_t)SIDE * SIDE * SIDE;
    struct kernel work = {malloc(count * sizeof(*work.density)), calloc(ROWS, sizeof(*work.sums))};
    enum neph_status status = work.density && work.sums ? NEPH_OK : neph_fail_memory(diag);
    uint32_t noise = 1;
    for (size_t i = 0; !status && i < count; i++) {
        noise = noise * 1664525u + 1013904223u;
        work.density[i] = (float)(noise >> 8) * 0x1p-24f;
    }
    double times[TRIES];
    for (int i = 0; i < TRIES && !status; i++) {
        const double start_s = neph_wall_s();
        for (int k = 0; k < 4 && !status; k++)
            status = neph_parallel_rows(ROWS, march_row, &work, diag);
        times[i] = neph_wall_s() - start_s;
    }
    free(work.density);
    free(work.sums);
    if (!status)
        *seconds = neph_percentile(times, TRIES, 0.5);
    return status;
}

/* ---- a step ---------------------------------------------------------------------------------- */

bool neph_step_ends_night(enum neph_status status, const struct neph_diag *why,
                          struct neph_diag *diag)
{
    const bool ends = status == NEPH_ERR_INTERRUPTED || status == NEPH_ERR_MEMORY;
    if (ends && diag)
        *diag = *why;
    return ends;
}

enum neph_status neph_step_measure(const struct neph_step_place *place,
                                   const struct neph_night_step *step, const char *output,
                                   const char *log, double limit_s,
                                   struct neph_night_numbers *numbers, struct neph_diag *diag)
{
    json_t *document = NULL;
    double wall_s = 0.0;
    enum neph_status status = run_command(place, step, output, log, limit_s, &document, &wall_s,
                                          diag);
    if (!status)
        status = neph_night_read(step->suite, document, NAN, place->host, place->arena, numbers,
                                 diag);
    json_decref(document);
    return status;
}

enum neph_status neph_step_run(const struct neph_step_place *place,
                               const struct neph_night_step *step, const char *output,
                               const char *log, double limit_s, struct neph_history_step *record,
                               struct neph_night_numbers *numbers, struct neph_diag *diag)
{
    struct neph_arena *arena = place->arena;
    const bool is_timed = step->suite == NEPH_NIGHT_SPEED;
    struct neph_diag why = {.line = 0};
    json_t *document = NULL;
    double before_s = NAN, after_s = NAN;
    *record = (struct neph_history_step){
        .name = step->name, .reason = "", .size = "", .calibration_s = NAN};
    *numbers = (struct neph_night_numbers){.count = 0, .size = ""};
    enum neph_status status = is_timed ? calibrate(&before_s, &why) : NEPH_OK;
    if (!status)
        status = run_command(place, step, output, log, limit_s, &document, &record->wall_s, &why);
    if (!status && is_timed)
        status = calibrate(&after_s, &why);
    const bool steady = fabs(after_s / before_s - 1.0) <= steadiness;
    if (is_timed && steady)
        record->calibration_s = 0.5 * (before_s + after_s);
    if (!status)
        status = neph_night_read(step->suite, document, record->calibration_s, place->host, arena,
                                 numbers, &why);
    json_decref(document);
    if (neph_step_ends_night(status, &why, diag))
        return status;
    record->outcome = !status ? neph_step_done : status == NEPH_ERR_TIMEOUT ? "timeout" : "failed";
    record->reason = status ? neph_arena_copy_text(arena, why.message) : "";
    if (!status && is_timed && !steady)
        record->reason = neph_arena_format(arena,
                                           "the machine was busy (calibration %.3f s before, %.3f "
                                           "s after): its durations are not used",
                                           before_s, after_s);
    record->size = numbers->size;
    return NEPH_OK;
}
