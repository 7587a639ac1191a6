/* SPDX-License-Identifier: MIT */
#include "harness/physics/iprt.h"

#include "base/arena.h"
#include "base/files.h"
#include "base/path.h"
#include "base/threads.h"
#include "harness/progress.h"
#include "scenes/phase_table.h"
#include "scenes/text_numbers.h"
#include "truth/oracle.h"
#include "truth/path.h"
#include "truth/slab.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double optical_depth = 5.0, albedo = 0.999979, rad_per_deg = M_PI / 180.0;
static const char address[] = "phase function: https://github.com/hygeos/smartg, its history; "
                              "results: https://www.meteo.physik.uni-muenchen.de/~iprt";
/* With these nodes MYSTIC's radiances are met within 0.5 %, also near the sun (docs/clouds.md). */
enum { NODES = 128, DEFAULT_PATHS = 4000, BATCHES = 32, VIEWS_MAX = 4096, FILES_MAX = 16 };
enum { ANGLES_MAX = 4096 };
static const size_t limit_bytes = (size_t)16 << 20;

/* ---- files ----------------------------------------------------------------------------------- */

/* The numbers of the line behind the one that begins with a heading. */
static enum neph_status read_line(const char *text, const char *heading, int *count,
                                  double values[ANGLES_MAX], struct neph_diag *diag)
{
    const char *found = strstr(text, heading);
    const char *at = found ? strchr(found, '\n') : NULL;
    *count = 0;
    if (!at)
        return neph_fail(diag, NEPH_ERR_INPUT, "no line '%s'", heading);
    const char *end = strchr(at + 1, '\n');
    for (char *next; *count < ANGLES_MAX && (!end || at < end); at = next) {
        const double value = strtod(at, &next);
        if (next == at || (end && next > end))
            break;
        values[(*count)++] = value;
    }
    return *count >= 2 ? NEPH_OK
                       : neph_fail(diag, NEPH_ERR_INPUT, "no numbers behind '%s'", heading);
}

static enum neph_status read_phase(const char *folder, struct neph_arena *arena,
                                   struct neph_phase *phase, struct neph_diag *diag)
{
    const struct neph_path path = neph_path_in(folder, "watercloud.mie.dat");
    double *angles = calloc(2 * (size_t)ANGLES_MAX, sizeof(*angles));
    char *text = NULL;
    size_t size = 0;
    int count = 0, values = 0;
    enum neph_status status = angles ? neph_file_read(path.text, limit_bytes, &text, &size, diag)
                                     : neph_fail_memory(diag);
    if (!status)
        status = read_line(text, "# Scattering angles", &count, angles, diag);
    if (!status)
        status = read_line(text, "# Phase matrix P1:", &values, angles + ANGLES_MAX, diag);
    if (!status && values != count)
        status = neph_fail(diag, NEPH_ERR_INPUT, "%d angles, and %d values of P1", count, values);
    if (!status)
        status = neph_phase_table_make(count, angles, angles + ANGLES_MAX, arena, &phase->table,
                                       diag);
    if (status == NEPH_ERR_INPUT)
        neph_prefix(diag, "%s: ", path.text);
    phase->kind = NEPH_PHASE_TABLE;
    free(text);
    free(angles);
    return status;
}

/* Altitude [km], zenith angle and azimuth of the sun, zenith angle and azimuth of the view [deg],
 * I; further columns are left out. The altitude is 0 below the cloud. */
static enum neph_status read_row(struct neph_text_numbers *numbers, struct neph_iprt_view *view,
                                 struct neph_diag *diag)
{
    static const struct {
        const char *what;
        double low, high;
    } columns[] = {{"an altitude in km", 0, 100},
                   {"a zenith angle of the sun in degrees", 0, 89},
                   {"an azimuth of the sun in degrees", -360, 360},
                   {"a zenith angle of the view in degrees", 0, 180},
                   {"an azimuth of the view in degrees", -360, 360},
                   {"a radiance", 1e-12, 1e6}};
    double values[6] = {0.0}, stokes = 0.0;
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < 6 && !status; i++) {
        if (i > 0 && neph_text_is_line_read(numbers))
            return neph_fail(diag, NEPH_ERR_INPUT, "the line ends where %s should be",
                             columns[i].what);
        if (i > 0) /* the first word was read */
            status = neph_text_next_word(numbers, diag);
        if (!status)
            status = neph_text_to_number(numbers, columns[i].what, columns[i].low, columns[i].high,
                                         &values[i], diag);
    }
    int further = 0; /* Q, U, V and the standard deviation of I */
    for (; further < 4 && !status && !neph_text_is_line_read(numbers); further++)
        status = neph_text_next_number(numbers, "Q, U, V or a standard deviation", -1e6, 1e6,
                                       &stokes, diag);
    if (status)
        return status;
    neph_text_skip_line(numbers);
    view->is_below = values[0] == 0.0;
    view->sun_deg = values[1];
    view->view_deg = acos(fabs(cos(values[3] * rad_per_deg))) / rad_per_deg;
    view->azimuth_deg = values[4] - values[2];
    view->theirs = values[5];
    view->theirs_error = further == 4 ? stokes : NAN;
    return NEPH_OK;
}

static enum neph_status read_views(const char *path, const char *name, struct neph_iprt *suite,
                                   struct neph_diag *diag)
{
    char *text = NULL;
    size_t size = 0;
    enum neph_status status = neph_file_read(path, limit_bytes, &text, &size, diag);
    if (status)
        return status;
    struct neph_text_numbers numbers = {.file = size > 0 ? fmemopen(text, size, "r") : NULL,
                                        .has_comments = true};
    if (!numbers.file)
        status = size > 0 ? neph_fail_memory(diag) : neph_fail(diag, NEPH_ERR_INPUT, "it is empty");
    if (!status)
        status = neph_text_next_word(&numbers, diag);
    while (!status && numbers.word[0]) {
        struct neph_iprt_view view = {.file = name};
        status = suite->view_count < VIEWS_MAX
                     ? read_row(&numbers, &view, diag)
                     : neph_fail(diag, NEPH_ERR_INPUT, "more than %d directions", VIEWS_MAX);
        const bool is_level = cos(view.view_deg * rad_per_deg) < NEPH_SLAB_COSINE_MIN;
        if (!status && !is_level) /* a slab has no radiance along itself */
            suite->views[suite->view_count++] = view;
        if (!status)
            status = neph_text_next_word(&numbers, diag);
    }
    if (numbers.file)
        fclose(numbers.file);
    free(text);
    if (status == NEPH_ERR_INPUT && diag)
        neph_locate(diag, path, numbers.line, numbers.column);
    return status;
}

/* Names as IPRT publishes results, and as it wants them from contributors. */
static bool is_result(const char *name)
{
    static const char *const beginnings[] = {"a5_", "iprt_case_A5"};
    bool matches = false;
    for (size_t i = 0; i < sizeof(beginnings) / sizeof(beginnings[0]); i++)
        matches |= strncmp(name, beginnings[i], strlen(beginnings[i])) == 0;
    return matches;
}

static enum neph_status read_files(const char *folder, struct neph_iprt *suite,
                                   struct neph_diag *diag)
{
    struct neph_arena arena = {NULL};
    struct neph_names names;
    enum neph_status status = neph_dir_list(folder, &arena, &names, diag);
    for (int i = 0; i < names.count && !status; i++) {
        const char *name = names.list[i], *end = strrchr(name, '.');
        if (!is_result(name) || !end || strcmp(end, ".dat") != 0 ||
            strlen(name) >= sizeof(suite->files[0]))
            continue;
        if (suite->file_count == FILES_MAX) {
            status = neph_fail(diag, NEPH_ERR_INPUT, "%s: more than %d files a5_*.dat", folder,
                               FILES_MAX);
            break;
        }
        char *kept = suite->files[suite->file_count++];
        snprintf(kept, sizeof(suite->files[0]), "%s", name);
        status = read_views(neph_path_in(folder, name).text, kept, suite, diag);
    }
    neph_arena_finish(&arena);
    if (!status && suite->view_count == 0)
        snprintf(suite->missing, sizeof(suite->missing),
                 "no directions in %s/a5_*.dat, iprt_case_A5*.dat; %s", folder, address);
    return status;
}

/* ---- directions ------------------------------------------------------------------------------ */

/* Azimuth 0 is that of the sun, for a camera below and for one above. */
static struct neph_vec3 find_sight(const struct neph_iprt_view *view)
{
    const double angle_rad = view->view_deg * rad_per_deg;
    const double azimuth_rad = view->azimuth_deg * rad_per_deg;
    return (struct neph_vec3){sin(angle_rad) * cos(azimuth_rad),
                              (view->is_below > 0.0 ? 1.0 : -1.0) * cos(angle_rad),
                              sin(angle_rad) * sin(azimuth_rad)};
}

static struct neph_vec3 find_sun(double sun_deg)
{
    return (struct neph_vec3){sin(sun_deg * rad_per_deg), cos(sun_deg * rad_per_deg), 0.0};
}

static void find_angles(struct neph_iprt *suite)
{
    for (int v = 0; v < suite->view_count; v++) {
        struct neph_iprt_view *view = &suite->views[v];
        const struct neph_vec3 apart = neph_vec3_sub(find_sight(view), find_sun(view->sun_deg));
        view->from_sun_deg = 2.0 * asin(fmin(1.0, 0.5 * neph_vec3_length(apart))) / rad_per_deg;
    }
}

/* ---- by doubling ----------------------------------------------------------------------------- */

static int find_cosine(const double *cosines, int count, double cosine)
{
    int i = 0;
    while (i < count && cosines[i] != cosine)
        i++;
    return i;
}

/* All directions of a height of the sun, with one slab. */
static enum neph_status solve_sun(struct neph_iprt *suite, const struct neph_phase *phase,
                                  double sun_deg, struct neph_diag *diag)
{
    double *cosines = malloc((size_t)suite->view_count * sizeof(*cosines));
    struct neph_slab *slab = NULL;
    int count = 0;
    if (!cosines)
        return neph_fail_memory(diag);
    for (int v = 0; v < suite->view_count; v++) {
        const double cosine = cos(suite->views[v].view_deg * rad_per_deg);
        if (suite->views[v].sun_deg == sun_deg && find_cosine(cosines, count, cosine) == count)
            cosines[count++] = cosine;
    }
    const struct neph_slab_params params = {.optical_depth = optical_depth,
                                            .albedo = albedo,
                                            .phase = *phase,
                                            .sun_cosine = cos(sun_deg * rad_per_deg),
                                            .view_count = count,
                                            .view_cosines = cosines,
                                            .node_count = NODES};
    const enum neph_status status = neph_slab_create(&params, &slab, diag);
    for (int v = 0; v < suite->view_count && !status; v++) {
        struct neph_iprt_view *view = &suite->views[v];
        const int at = find_cosine(cosines, count, cos(view->view_deg * rad_per_deg));
        if (view->sun_deg == sun_deg)
            view->doubling = (view->is_below > 0.0 ? neph_slab_transmitted_per_sr
                                                   : neph_slab_reflected_per_sr)(
                slab, at, view->azimuth_deg * rad_per_deg);
    }
    neph_slab_destroy(slab);
    free(cosines);
    return status;
}

static enum neph_status solve(struct neph_iprt *suite, const struct neph_phase *phase,
                              struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int v = 0; v < suite->view_count && !status; v++)
        if (suite->views[v].doubling == 0.0)
            status = solve_sun(suite, phase, suite->views[v].sun_deg, diag);
    return status;
}

/* ---- by paths -------------------------------------------------------------------------------- */

struct tracing {
    const struct neph_scene *scene;
    const struct neph_tracker *tracker;
    const struct neph_iprt_view *view;
    int index, paths;
    double means[BATCHES];
};

static void trace_batch(int batch, void *context)
{
    struct tracing *tracing = context;
    const struct neph_vec3 eye_m = {0, tracing->view->is_below > 0.0 ? -1 : 2, 0};
    const struct neph_view look = neph_view_create(tracing->scene, eye_m,
                                                   find_sight(tracing->view));
    const struct neph_ray ray = {look.origin_m, look.direction, look.hit.t_m};
    struct neph_tracking_cost cost = {0, 0};
    struct neph_flight flight;
    neph_flight_init(&flight, tracing->scene, &ray);
    double sum = 0.0;
    for (int n = 0; n < tracing->paths; n++) {
        struct neph_random random = neph_random_stream(
            5, (uint64_t)tracing->index * BATCHES + (uint64_t)batch, (uint64_t)n);
        sum += neph_path_trace(tracing->scene, tracing->tracker, &look, &flight, &random, &cost)
                   .volume.g;
    }
    tracing->means[batch] = sum / tracing->paths;
}

static void summarize(const double means[BATCHES], double *mean, double *error)
{
    double sum = 0.0, squares = 0.0;
    for (int b = 0; b < BATCHES; b++)
        sum += means[b] / BATCHES;
    for (int b = 0; b < BATCHES; b++)
        squares += (means[b] - sum) * (means[b] - sum);
    *mean = sum;
    *error = sqrt(squares / (BATCHES * (BATCHES - 1)));
}

static struct neph_scene build_scene(const struct neph_phase *phase)
{
    struct neph_scene scene = {.scattering = NEPH_SCATTERING_MULTIPLE, .medium_count = 1};
    scene.media[0] = (struct neph_medium){
        .kind = NEPH_MEDIUM_HOMOGENEOUS,
        .bounds = {{-INFINITY, 0, -INFINITY}, {INFINITY, 1, INFINITY}},
        .extinction_color = {1, 1, 1},
        .albedo = {albedo, albedo, albedo},
        .phase = *phase,
        .layer_count = 1,
        .layers = {{.extinction_per_m = optical_depth}}};
    return scene;
}

static enum neph_status trace_view(struct neph_iprt *suite, int index,
                                   const struct neph_phase *phase, struct neph_diag *diag)
{
    struct neph_iprt_view *view = &suite->views[index];
    struct neph_scene scene = build_scene(phase);
    struct neph_tracker *tracker = NULL;
    scene.sun = (struct neph_sun){true, find_sun(view->sun_deg), {1, 1, 1}};
    enum neph_status status = neph_tracker_create(&scene, &tracker, diag);
    struct tracing tracing = {.scene = &scene,
                              .tracker = tracker,
                              .view = view,
                              .index = index,
                              .paths = suite->paths / BATCHES};
    if (!status)
        status = neph_parallel_rows(BATCHES, trace_batch, &tracing, diag);
    if (!status)
        summarize(tracing.means, &view->oracle, &view->oracle_error);
    neph_tracker_destroy(tracker);
    return status;
}

static enum neph_status trace(struct neph_iprt *suite, const struct neph_phase *phase, bool quiet,
                              struct neph_diag *diag)
{
    struct neph_progress progress = neph_progress_start(quiet, suite->view_count);
    enum neph_status status = NEPH_OK;
    for (int v = 0; v < suite->view_count && !status; v++) {
        neph_progress_begin(&progress, suite->views[v].file);
        status = trace_view(suite, v, phase, diag);
        if (!status)
            neph_progress_tick(&progress, suite->views[v].file);
    }
    neph_progress_end(&progress);
    return status;
}

/* ---- all ------------------------------------------------------------------------------------- */

/* Paths are heavy-tailed near the peak, so single directions have no trusted error bar: the mean of
 * all is judged by the scatter between directions. */
static void judge_oracle(struct neph_iprt *suite)
{
    double sum = 0.0, squares = 0.0;
    for (int v = 0; v < suite->view_count; v++) {
        const double ratio = suite->views[v].oracle / suite->views[v].doubling;
        sum += ratio / suite->view_count;
        squares += ratio * ratio / suite->view_count;
    }
    suite->oracle_over_doubling = sum;
    suite->oracle_error = sqrt(fmax(0.0, squares - sum * sum) / suite->view_count);
    suite->oracle_agrees = suite->view_count < 2 ||
                           fabs(sum - 1.0) <= NEPH_IPRT_SIGMAS * suite->oracle_error;
}

static void judge(struct neph_iprt *suite)
{
    for (int v = 0; v < suite->view_count; v++) {
        struct neph_iprt_view *view = &suite->views[v];
        const double limit = view->from_sun_deg <= NEPH_IPRT_NEAR_DEG ? NEPH_IPRT_NEAR
                                                                      : NEPH_IPRT_FAR;
        view->agrees = fabs(view->doubling - view->theirs) <= limit * view->theirs;
        suite->failed += !view->agrees;
    }
    judge_oracle(suite);
}

static enum neph_status run(const struct neph_iprt_params *params, struct neph_iprt *suite,
                            struct neph_arena *arena, struct neph_diag *diag)
{
    struct neph_phase phase = {.table = NULL};
    const int paths = params->paths > 0 ? params->paths : DEFAULT_PATHS;
    suite->paths = (paths + BATCHES - 1) / BATCHES * BATCHES;
    suite->views = calloc(VIEWS_MAX, sizeof(*suite->views));
    suite->files = calloc(FILES_MAX, sizeof(*suite->files));
    if (!suite->views || !suite->files)
        return neph_fail_memory(diag);
    enum neph_status status = read_phase(params->folder, arena, &phase, diag);
    if (!status)
        status = read_files(params->folder, suite, diag);
    if (status || suite->view_count == 0)
        return status;
    find_angles(suite);
    status = solve(suite, &phase, diag);
    if (!status)
        status = trace(suite, &phase, params->quiet, diag);
    if (!status)
        judge(suite);
    return status;
}

enum neph_status neph_iprt_run(const struct neph_iprt_params *params, struct neph_iprt *suite,
                               struct neph_diag *diag)
{
    struct neph_arena arena = {NULL};
    *suite = (struct neph_iprt){.views = NULL};
    if (!params->folder || !params->folder[0]) {
        snprintf(suite->missing, sizeof(suite->missing), "not here: %s names no folder; %s",
                 NEPH_IPRT_VARIABLE, address);
        return NEPH_OK;
    }
    const enum neph_status status = run(params, suite, &arena, diag);
    neph_arena_finish(&arena);
    return status;
}

void neph_iprt_finish(struct neph_iprt *suite)
{
    free(suite->views);
    free(suite->files);
    *suite = (struct neph_iprt){.views = NULL};
}
