/* SPDX-License-Identifier: MIT
 *
 * The cost of each extractor: CPU seconds and memory, single and together, on synthetic frames; and
 * frames a second of the command `neph flicker` with files. Not a test. Each row is measured in a
 * process of its own, so that the peak of memory belongs to the row.
 *
 *   bench_metrics                                960x540 and 1920x1080
 *   bench_metrics --frames 64 neph_flicker       only the command
 *   bench_metrics --size 3840x2160 --frames 4 error flip
 *   bench_metrics --json > costs.json
 *   bench_metrics --size 8192x8192 --frames 2 error ssim flip      the largest supported size
 */
#include "tests/metrics/bench_program.h"
#include "tests/metrics/synthetic.h"

#include "base/clock.h"
#include "metrics/extractors/extractors.h"
#include "metrics/meter.h"

#include <argp.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

enum { SIZES_MAX = 8, CHOICES_MAX = 64, TURNS_MAX = 4, IMAGE_FRAMES = 4, KEY_JSON = 1 };

struct request {
    int sizes[SIZES_MAX][2], size_count;
    int frame_count; /* of temporal extractors */
    bool json;
    const char *names[CHOICES_MAX]; /* extractors; none: all */
    int name_count;
};

/* One line of the table: some extractors at a size. */
struct row {
    const char *name;
    const struct neph_extractor *extractors[CHOICES_MAX];
    int extractor_count;
    int width_px, height_px, frame_count;
    bool intervals;
    bool all_layers; /* frames also have depth, motion, ...; otherwise only radiance */
};

/* The results of a row, sent by its process. */
struct cost {
    enum neph_status status;
    double cpu_s_per_frame, finish_cpu_s, wall_s_per_frame;
    long frames_kib; /* resident before the meter is created: the frames */
    int measured;
    char obstacle[160]; /* why an extractor gave nothing for radiance; empty: all did */
};

/* ---- in a process of its own ----------------------------------------------------------------- */

static long resident_kib(void)
{
    long total = 0, pages = 0;
    FILE *file = fopen("/proc/self/statm", "re");
    if (file && fscanf(file, "%ld %ld", &total, &pages) != 2)
        pages = 0;
    if (file)
        fclose(file);
    return pages * (sysconf(_SC_PAGESIZE) / 1024);
}

/* A few frames that are used in turn, so that long sequences need no more memory. */
struct frames {
    struct neph_image *reference[TURNS_MAX], *second[TURNS_MAX], *test[TURNS_MAX];
};

static int count_frame_turns(const struct row *row)
{
    const size_t pixels = (size_t)row->width_px * (size_t)row->height_px;
    const int turns = pixels > (size_t)1 << 24 ? 1 : TURNS_MAX;
    return row->frame_count < turns ? row->frame_count : turns;
}

static enum neph_status make_frames(const struct row *row, struct frames *frames,
                                    struct neph_diag *diag)
{
    struct synthetic what = {
        .width_px = row->width_px, .height_px = row->height_px, .all = row->all_layers};
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < count_frame_turns(row) && !status; i++) {
        what.frame = i;
        what.seed = 1;
        what.is_test = false;
        status = synthetic_create(&what, &frames->reference[i], diag);
        what.seed = 2;
        if (!status)
            status = synthetic_create(&what, &frames->second[i], diag);
        what.seed = (uint64_t)i + 3;
        what.is_test = true;
        if (!status)
            status = synthetic_create(&what, &frames->test[i], diag);
    }
    return status;
}

static enum neph_status make_meter(const struct row *row, const struct neph_mask *mask,
                                   struct neph_meter **meter, struct neph_diag *diag)
{
    struct neph_meter_choice choices[CHOICES_MAX];
    for (int i = 0; i < row->extractor_count; i++)
        choices[i] = (struct neph_meter_choice){row->extractors[i],
                                                synthetic_settings(row->extractors[i])};
    return neph_meter_create(&(struct neph_meter_params){.choices = choices,
                                                         .choice_count = row->extractor_count,
                                                         .viewing = NEPH_VIEWING_DEFAULTS,
                                                         .masks = &mask,
                                                         .mask_count = 1,
                                                         .intervals = row->intervals,
                                                         .frame_count = row->frame_count},
                             meter, diag);
}

static const char *find_obstacle(const struct row *row, const struct neph_meter *meter)
{
    const struct neph_quantity *radiance = neph_quantity_find("radiance");
    for (int i = 0; i < row->extractor_count; i++) {
        const char *why = neph_meter_obstacle(meter, radiance, row->extractors[i]);
        if (why)
            return why;
    }
    return "";
}

static struct cost measure_here(const struct row *row, struct neph_diag *diag)
{
    struct cost cost = {.status = NEPH_OK};
    struct frames frames = {.reference = {NULL}};
    struct neph_mask *mask = NULL;
    struct neph_meter *meter = NULL;
    cost.status = make_frames(row, &frames, diag);
    if (!cost.status)
        cost.status = neph_mask_create(frames.reference[0], "all", NULL, &mask, diag);
    if (cost.status)
        return cost;
    const int turns = count_frame_turns(row);
    cost.frames_kib = resident_kib();
    const double cpu_s = neph_cpu_s(), wall_s = neph_wall_s();
    cost.status = make_meter(row, mask, &meter, diag);
    for (int i = 0; i < row->frame_count && !cost.status; i++)
        cost.status = neph_meter_frame(meter, frames.reference[i % turns], frames.second[i % turns],
                                       frames.test[i % turns], diag);
    cost.cpu_s_per_frame = (neph_cpu_s() - cpu_s) / row->frame_count;
    cost.wall_s_per_frame = (neph_wall_s() - wall_s) / row->frame_count;
    if (!cost.status) {
        const double before_s = neph_cpu_s();
        cost.status = neph_meter_finish(meter, diag);
        cost.finish_cpu_s = neph_cpu_s() - before_s;
        snprintf(cost.obstacle, sizeof(cost.obstacle), "%s", find_obstacle(row, meter));
        neph_meter_measurements(meter, &cost.measured);
    }
    return cost; /* the process ends: nothing is freed, so that freeing is not measured */
}

static struct cost measure(const struct row *row, long *peak_kib)
{
    struct cost cost = {.status = NEPH_ERR_INTERNAL};
    int pipe_fds[2];
    if (pipe(pipe_fds) != 0)
        return cost;
    const pid_t child = fork();
    if (child == 0) {
        struct neph_diag diag = {0};
        const struct cost measured = measure_here(row, &diag);
        if (measured.status)
            fprintf(stderr, "%s: %s\n", row->name, diag.message);
        _exit(write(pipe_fds[1], &measured, sizeof(measured)) == sizeof(measured) ? 0 : 1);
    }
    close(pipe_fds[1]);
    if (child < 0 || read(pipe_fds[0], &cost, sizeof(cost)) != sizeof(cost))
        cost.status = NEPH_ERR_INTERNAL;
    close(pipe_fds[0]);
    struct rusage usage = {.ru_maxrss = 0};
    if (child > 0)
        wait4(child, NULL, 0, &usage);
    *peak_kib = usage.ru_maxrss;
    return cost;
}

/* ---- table ----------------------------------------------------------------------------------- */

static void print_row(const struct row *row, const struct cost *cost, long peak_kib)
{
    char size[24];
    snprintf(size, sizeof(size), "%dx%d", row->width_px, row->height_px);
    printf("%-28s %-10s %-9s %-8s %6d %12.3f %12.3f %12.3f %10.1f %10.1f  %s\n", row->name, size,
           row->intervals ? "yes" : "no", row->all_layers ? "all" : "radiance", row->frame_count,
           1e3 * cost->cpu_s_per_frame, 1e3 * cost->wall_s_per_frame, 1e3 * cost->finish_cpu_s,
           (double)(peak_kib - cost->frames_kib) / 1024.0, (double)peak_kib / 1024.0,
           cost->obstacle);
    fflush(stdout);
}

static json_t *row_as_json(const struct row *row, const struct cost *cost, long peak_kib)
{
    return json_pack("{s:s, s:i, s:i, s:b, s:b, s:s, s:i, s:f, s:f, s:f, s:I, s:I}", "name",
                     row->name, "width_px", row->width_px, "height_px", row->height_px, "intervals",
                     (int)row->intervals, "all_layers", (int)row->all_layers, "obstacle",
                     cost->obstacle, "frames", row->frame_count, "cpu_s_per_frame",
                     cost->cpu_s_per_frame, "wall_s_per_frame", cost->wall_s_per_frame,
                     "finish_cpu_s", cost->finish_cpu_s, "own_bytes",
                     (json_int_t)(peak_kib - cost->frames_kib) * 1024, "peak_bytes",
                     (json_int_t)peak_kib * 1024);
}

static bool run_row(struct row *row, const struct request *request, json_t *list)
{
    const bool is_temporal = row->extractors[0]->temporal;
    row->frame_count = request->frame_count;
    if (!is_temporal && row->frame_count > IMAGE_FRAMES)
        row->frame_count = IMAGE_FRAMES;
    row->all_layers = false;
    long peak_kib = 0;
    struct cost cost = measure(row, &peak_kib);
    if (!cost.status && cost.obstacle[0]) { /* it needs more than radiance */
        row->all_layers = true;
        cost = measure(row, &peak_kib);
    }
    if (cost.status)
        return false;
    if (request->json)
        json_array_append_new(list, row_as_json(row, &cost, peak_kib));
    else
        print_row(row, &cost, peak_kib);
    return true;
}

static bool is_wanted(const struct request *request, const char *name)
{
    for (int i = 0; i < request->name_count; i++)
        if (strcmp(request->names[i], name) == 0)
            return true;
    return request->name_count == 0;
}

/* The sums that have a budget: these extractors in one meter, each frame read once. */
static const struct total {
    const char *name;
    bool temporal;
    const char *without; /* in the name; NULL: all */
    const char *with;
} totals[] = {
    {"all image metrics but FLIP", false, "flip", NULL},
    {"flicker", true, "flip", "flicker"},
};

static bool belongs(const struct total *total, const struct neph_extractor *extractor)
{
    return extractor->temporal == total->temporal && !strstr(extractor->name, total->without) &&
           (!total->with || strstr(extractor->name, total->with));
}

static bool run_totals(const struct request *request, struct row *row, json_t *list)
{
    bool ran = true;
    for (size_t t = 0; t < sizeof(totals) / sizeof(totals[0]) && request->name_count == 0; t++) {
        row->name = totals[t].name;
        row->extractor_count = 0;
        for (int i = 0; i < neph_extractor_count(); i++)
            if (belongs(&totals[t], neph_extractor_at(i)))
                row->extractors[row->extractor_count++] = neph_extractor_at(i);
        if (row->extractor_count > 0)
            ran = run_row(row, request, list) && ran;
    }
    return ran;
}

static void print_program(const struct bench_program *bench, const struct bench_program_cost *cost)
{
    printf("neph flicker %dx%d, %d frames: %.1f frames a second, %.4f CPU-seconds a frame, %.0f %% "
           "of them in the system\n",
           bench->width_px, bench->height_px, bench->frame_count, bench->frame_count / cost->wall_s,
           (cost->user_s + cost->system_s) / bench->frame_count,
           100.0 * cost->system_s / (cost->user_s + cost->system_s));
    fflush(stdout);
}

/* The command with its files, at one size. */
static bool run_program(const struct request *request, const int size[2], json_t *list)
{
    const int given = request->frame_count / 4 * 4;
    const struct bench_program bench = {size[0], size[1], given < 16 ? 16 : given};
    struct bench_program_cost cost;
    struct neph_diag diag = {0};
    const enum neph_status status = bench_program_run(&bench, &cost, &diag);
    if (status)
        fprintf(stderr, "neph flicker: %s\n", diag.message);
    else if (request->json)
        json_array_append_new(
            list, json_pack("{s:s, s:i, s:i, s:i, s:f, s:f, s:f}", "name", "neph flicker",
                            "width_px", bench.width_px, "height_px", bench.height_px, "frames",
                            bench.frame_count, "frames_per_s", bench.frame_count / cost.wall_s,
                            "cpu_s_per_frame", (cost.user_s + cost.system_s) / bench.frame_count,
                            "system_s_per_frame", cost.system_s / bench.frame_count));
    else
        print_program(&bench, &cost);
    return !status;
}

static bool run_all(const struct request *request, json_t *list)
{
    bool ran = true;
    for (int s = 0; s < request->size_count && is_wanted(request, "neph_flicker"); s++)
        ran = run_program(request, request->sizes[s], list) && ran;
    for (int s = 0; s < request->size_count; s++)
        for (int intervals = 0; intervals < 2; intervals++) {
            struct row row = {.width_px = request->sizes[s][0],
                              .height_px = request->sizes[s][1],
                              .intervals = intervals == 1};
            for (int i = 0; i < neph_extractor_count(); i++) {
                row.extractors[0] = neph_extractor_at(i);
                row.extractor_count = 1;
                row.name = row.extractors[0]->name;
                if (is_wanted(request, row.name))
                    ran = run_row(&row, request, list) && ran;
            }
            ran = run_totals(request, &row, list) && ran;
        }
    return ran;
}

/* ---- command line ---------------------------------------------------------------------------- */

static const struct argp_option options[] = {
    {"size", 's', "WxH", 0, "A size in pixels; may be given several times", 0},
    {"frames", 'n', "N", 0, "Frames for what looks at sequences (24); of them at most 4 for images",
     0},
    {"json", KEY_JSON, NULL, 0, "Results as JSON on stdout", 0},
    {0},
};

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct request *request = state->input;
    int *size = request->sizes[request->size_count];
    switch (key) {
    case 's':
        if (request->size_count == SIZES_MAX - 1 ||
            sscanf(argument, "%dx%d", &size[0], &size[1]) != 2)
            argp_error(state, "'%s' is not a size WxH", argument);
        request->size_count++;
        return 0;
    case 'n':
        request->frame_count = atoi(argument);
        if (request->frame_count < 1)
            argp_error(state, "'%s' is not a count of frames", argument);
        return 0;
    case KEY_JSON:
        request->json = true;
        return 0;
    case ARGP_KEY_ARG:
        if ((!neph_extractor_find(argument) && strcmp(argument, "neph_flicker") != 0) ||
            request->name_count == CHOICES_MAX)
            argp_error(state, "there is no extractor '%s'", argument);
        request->names[request->name_count++] = argument;
        return 0;
    }
    return ARGP_ERR_UNKNOWN;
}

static const struct argp argp = {.options = options,
                                 .parser = parse,
                                 .args_doc = "[EXTRACTOR...]",
                                 .doc = "What the metrics cost, on synthetic frames of radiance "
                                        "(all layers for what needs more)."};

int main(int argc, char **argv)
{
    struct request request = {.frame_count = 24};
    argp_parse(&argp, argc, argv, 0, NULL, &request);
    if (request.size_count == 0) {
        static const int usual[2][2] = {{960, 540}, {1920, 1080}};
        memcpy(request.sizes, usual, sizeof(usual));
        request.size_count = 2;
    }
    json_t *list = json_array();
    if (!request.json)
        printf("%-28s %-10s %-9s %-8s %6s %12s %12s %12s %10s %10s\n", "extractor", "size",
               "intervals", "layers", "frames", "CPU ms/frame", "wall ms/frame", "finish ms",
               "own MiB", "peak MiB");
    const bool ran = run_all(&request, list);
    if (request.json)
        json_dumpf(list, stdout, JSON_INDENT(2));
    json_decref(list);
    return ran ? EXIT_SUCCESS : EXIT_FAILURE;
}
