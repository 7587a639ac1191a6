/* SPDX-License-Identifier: MIT
 *
 * The command line, the files and the output are of ColorVideoVDP 0.5.6 (gfxdisp/ColorVideoVDP,
 * commit 7ca201a): pycvvdp/run_cvvdp.py, video_source_file.py, display_model.py; --result and
 * numbered frames are there since 0.4.2. Frames are EXR in 32-bit floats, which nothing rounds:
 * its reader of PNG wants FreeImage, which it downloads. Display models apply their transfer
 * function to what a file has, whatever the format.
 */
#include "harness/compare/partner.h"

#include "base/child.h"
#include "base/exr.h"
#include "base/files.h"
#include "base/interrupt.h"
#include "base/path.h"
#include "base/scratch.h"
#include "base/text.h"
#include "metrics/extractors/display_luma.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
    FRAMES_MAX = 10000, /* as many numbers cvvdp tries */
    VARIABLES_MAX = 1024,
    WORDS_BEHIND = 12
}; /* options and the NULL */

static const char program[] = "cvvdp", scratch_prefix[] = ".neph-cvvdp-",
                  result_name[] = "result.csv", log_name[] = "cvvdp.log",
                  full_name[] = "\"ColorVideoVDP v";

/* Ten times what version 0.5.6 takes on one core. */
static const double start_s = 300.0, s_per_pixel = 1e-4;

static const size_t text_max_bytes = (size_t)16 << 20;

static const double jod_max = 10.0 + 1e-4; /* the largest JOD is 10, in single precision */

static const struct neph_partner_display displays[] = {
    {"standard_4k", false},
    {"standard_fhd", false},
    {"standard_hdr_linear", true},
    {"standard_hdr_linear_dark", true},
};
enum { DISPLAYS = sizeof(displays) / sizeof(displays[0]) };

enum neph_status neph_partner_find(const char *word, const struct neph_partner_display **display,
                                   struct neph_diag *diag)
{
    const size_t length = strlen(program);
    const bool is_program = strncmp(word, program, length) == 0;
    *display = NULL;
    if (is_program && !word[length])
        *display = &displays[0];
    for (int i = 0; i < DISPLAYS && is_program && word[length] == ':'; i++)
        if (strcmp(word + length + 1, displays[i].name) == 0)
            *display = &displays[i];
    if (*display)
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_USAGE, "--partner '%s': no such program or display", word);
    neph_hint(diag,
              "cvvdp, or with another display than its standard_4k: cvvdp:%s, cvvdp:%s, "
              "cvvdp:%s",
              displays[1].name, displays[2].name, displays[3].name);
    return NEPH_ERR_USAGE;
}

/* ---- the frames ------------------------------------------------------------------------------ */

enum side { REFERENCE, TEST, OTHER, SIDES };

static const char *const side_names[SIDES] = {"reference", "test", "other"};

/* Name of a file in the folder. */
static struct neph_path name_frame(enum side side, int frame)
{
    return neph_path_format("%s_%05d.exr", side_names[side], frame);
}

struct run {
    const struct neph_partner_job *job;
    struct neph_scratch *scratch;
    const char *folder;
    int frame_count;
    double pixel_count; /* of all frames of a side */
    double gain;
};

static const struct neph_sequence *find_sequence(const struct run *run, enum side side)
{
    const struct neph_sequence *const sequences[SIDES] = {run->job->reference, run->job->test,
                                                          run->job->other};
    return sequences[side];
}

static void fill(const struct run *run, const float *from, size_t count, float *to)
{
    enum { PIECE_PX = 256 };
    const double scale = run->gain * run->job->viewing.white_cd_per_m2;
    double codes[PIECE_PX];
    for (size_t done = 0; done < count; done += PIECE_PX) {
        const size_t piece = count - done < PIECE_PX ? count - done : PIECE_PX;
        neph_display_codes(from + done, piece, run->gain, codes);
        for (size_t i = 0; i < piece; i++)
            to[done + i] = (float)(run->job->display->is_linear
                                       ? fmax(scale * (double)from[done + i], 0.0)
                                       : codes[i]);
    }
}

static enum neph_status convert(const struct run *run, const struct neph_image *from,
                                const char *path, struct neph_diag *diag)
{
    float *in[3], *out[3];
    struct neph_image *made = NULL;
    const char *encoding = neph_image_attribute(from, "encoding");
    if (encoding && strcmp(encoding, "sRGB") != 0)
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "the frames are for an HDR display (%s)",
                         encoding);
    if (!neph_image_rgb(from, NULL, in))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "the frames have no R, G and B");
    enum neph_status status = neph_image_create(from->width_px, from->height_px, &made, diag);
    if (!status)
        status = neph_image_add_rgb(made, NULL, out, diag);
    for (int c = 0; c < 3 && !status; c++)
        fill(run, in[c], neph_image_pixel_count(from), out[c]);
    if (!status)
        status = neph_exr_write_plain(path, made, diag);
    neph_image_destroy(made);
    return status;
}

/* Write a frame of a side; of a single reference, links to its first frame. */
static enum neph_status write_frame(struct run *run, enum side side, int frame,
                                    struct neph_diag *diag)
{
    const struct neph_partner_job *job = run->job;
    const struct neph_sequence *sequence = find_sequence(run, side);
    const struct neph_path path = neph_path_in(run->folder, name_frame(side, frame).text);
    struct neph_image *image = NULL;
    if (neph_interrupted())
        return neph_fail(diag, NEPH_ERR_INTERRUPTED, "interrupted");
    if (sequence->count == 1 && frame > 0)
        return symlink(name_frame(side, 0).text, path.text) == 0
                   ? NEPH_OK
                   : neph_fail(diag, NEPH_ERR_IO, "cannot write '%s': %s", path.text,
                               strerror(errno));
    const char *file = sequence->paths[sequence->count == 1 ? 0 : job->first + frame];
    enum neph_status status = neph_frame_read(file, &job->choice, job->negative_allowed, &image,
                                              diag);
    if (!status && side == TEST)
        run->pixel_count += (double)neph_image_pixel_count(image);
    if (!status)
        status = convert(run, image, path.text, diag);
    neph_image_destroy(image);
    return status;
}

/* Write all frames; nothing without the program. */
static enum neph_status write_frames(struct run *run, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    if (!neph_child_program_exists(program)) {
        neph_fail(diag, NEPH_ERR_UNAVAILABLE, "cvvdp is not installed");
        neph_hint(diag, "pip install cvvdp (ColorVideoVDP, needs PyTorch), and put it in PATH");
        return NEPH_ERR_UNAVAILABLE;
    }
    if (run->frame_count > FRAMES_MAX)
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "%d frames, and cvvdp reads at most %d",
                         run->frame_count, FRAMES_MAX);
    for (int side = 0; side < SIDES; side++)
        for (int f = 0; f < run->frame_count && find_sequence(run, side)->count > 0 && !status; f++)
            status = write_frame(run, side, f, diag);
    return status;
}

/* ---- the command ----------------------------------------------------------------------------- */

/* A pair of files that the program compares: a frame, or a sequence (frame < 0). */
struct pair {
    enum side side;
    int frame;
};

static int count_pairs(const struct run *run)
{
    const int sides = run->job->other->count > 0 ? 2 : 1;
    return run->job->is_sequence ? sides : sides * run->frame_count;
}

/* The pairs in the order of the command line: first all of the test. */
static struct pair find_pair(const struct run *run, int index)
{
    const int each = run->job->is_sequence ? 1 : run->frame_count;
    return (struct pair){index < each ? TEST : OTHER, run->job->is_sequence ? -1 : index % each};
}

static struct neph_path name_pair(const struct pair *pair, enum side side)
{
    return pair->frame < 0 ? neph_path_format("%s_%%05d.exr", side_names[side])
                           : name_frame(side, pair->frame);
}

/* The words of the command, NULL-terminated, in `arena`. */
static const char **make_words(const struct run *run, struct neph_arena *arena)
{
    const struct neph_viewing *viewing = &run->job->viewing;
    const int pairs = count_pairs(run);
    const char **words = neph_arena_allocate(arena, (size_t)(2 * pairs + WORDS_BEHIND),
                                             sizeof(*words));
    int count = 0;
    if (!words)
        return NULL;
    words[count++] = program;
    for (int side = TEST; side >= REFERENCE; side--) {
        words[count++] = side == TEST ? "--test" : "--ref";
        for (int i = 0; i < pairs; i++) {
            const struct pair pair = find_pair(run, i);
            words[count++] = neph_arena_copy_text(
                arena, name_pair(&pair, side == TEST ? pair.side : REFERENCE).text);
        }
    }
    words[count++] = "--display";
    words[count++] = run->job->display->name;
    words[count++] = "--result";
    words[count++] = result_name;
    if (run->job->is_sequence) {
        words[count++] = "--fps";
        words[count++] = neph_arena_format(arena, "%.17g", viewing->frame_rate_hz);
    }
    if (run->job->with_pixels_per_degree) {
        words[count++] = "--pix-per-deg";
        words[count++] = neph_arena_format(arena, "%.17g", viewing->pixels_per_degree);
    }
    return words;
}

/* Run it with the user's environment, which finds the Python packages and the GPU. The folder is
 * its home; packages that pip installed for the user are found by PYTHONUSERBASE. */
static enum neph_status start(const struct run *run, const char *const *words,
                              struct neph_diag *diag)
{
    static const char *const nothing[] = {NULL};
    const char *variables[VARIABLES_MAX + 1];
    const int inherited = neph_child_inherit(variables, VARIABLES_MAX, nothing);
    const struct neph_path log = neph_path_in(run->folder, log_name);
    const char *home = getenv("HOME");
    const struct neph_path packages = neph_path_format("PYTHONUSERBASE=%s/.local",
                                                       home ? home : "");
    struct neph_child_result result;
    if (inherited < 0)
        return neph_fail(diag, NEPH_ERR_USAGE, "the environment has more than %d variables",
                         VARIABLES_MAX - 1);
    if (home && !getenv("PYTHONUSERBASE")) {
        variables[inherited] = packages.text;
        variables[inherited + 1] = NULL;
    }
    const double size_s = run->pixel_count * (run->job->other->count > 0 ? 2.0 : 1.0) * s_per_pixel;
    const struct neph_child_params params = {
        .argv = words,
        .working_directory = run->folder,
        .log_path = log.text,
        .home = run->folder,
        .limits = {.log_bytes = (int64_t)text_max_bytes},
        .environment = variables,
        .time_limit_s = run->job->time_limit_s > 0.0 ? run->job->time_limit_s : start_s + size_s};
    return neph_child_run(&params, &result, diag);
}

static enum neph_status start_program(const struct run *run, struct neph_diag *diag)
{
    struct neph_arena arena = {.last = NULL};
    const char *const *words = make_words(run, &arena);
    /* cvvdp_metric.py, get_temporal_filters(); it reads as many frames ahead */
    const int needed = 2 * (int)ceil(fmin(run->job->viewing.frame_rate_hz, 1e6) / 8.0) + 1;
    enum neph_status status = neph_arena_check(&arena, diag);
    if (!status)
        status = start(run, words, diag);
    if (status == NEPH_ERR_ENGINE && run->job->is_sequence && run->frame_count < needed)
        neph_hint(diag, "version 0.5.6 needs %d frames at %g Hz: its filters are 250 ms long",
                  needed, run->job->viewing.frame_rate_hz);
    neph_arena_finish(&arena);
    return status;
}

/* ---- its output ------------------------------------------------------------------------------ */

/* The file's text for the caller to free; "" of one that is missing or too long. */
static enum neph_status read_text(const struct run *run, const char *name, char **text,
                                  struct neph_diag *diag)
{
    size_t size = 0;
    const enum neph_status status = neph_file_read(neph_path_in(run->folder, name).text,
                                                   text_max_bytes, text, &size, NULL);
    if (status)
        *text = calloc(1, 1);
    return *text ? NEPH_OK : neph_fail_memory(diag);
}

/* Failures without an exit code are in the last line of the log. */
static enum neph_status fail_output(const char *log, const char *what, struct neph_diag *diag)
{
    size_t end = strlen(log), first;
    while (end > 0 && log[end - 1] == '\n')
        end--;
    for (first = end; first > 0 && log[first - 1] != '\n'; first--)
        ;
    return neph_fail(diag, NEPH_ERR_ENGINE,
                     "cvvdp ended without %s; the last line of its output: "
                     "%.*s",
                     what, (int)(end - first < 300 ? end - first : 300), log + first);
}

/* `"ColorVideoVDP v0.5.6, 75.4 [pix/deg], ..."` in the log. */
static enum neph_status parse_conditions(const char *log, struct neph_partner_numbers *numbers,
                                         struct neph_diag *diag)
{
    const char *found = strstr(log, full_name);
    const size_t length = found ? strcspn(found + 1, "\"\n") : 0;
    if (length == 0 || found[1 + length] != '"' || length >= sizeof(numbers->conditions))
        return fail_output(log, "a line with its version", diag);
    neph_text_format(numbers->conditions, sizeof(numbers->conditions), "%.*s", (int)length,
                     found + 1);
    const char *version = numbers->conditions + strlen(full_name) - 1;
    snprintf(numbers->version, sizeof(numbers->version), "%.*s", (int)strcspn(version, ", "),
             version);
    return NEPH_OK;
}

/* A line of the result, "test_00000.exr, reference_00000.exr, 9.1"; `*line` moves behind it. */
static bool parse_line(const struct pair *pair, const char **line, double *jod)
{
    const struct neph_path names = neph_path_format("%s, %s, ", name_pair(pair, pair->side).text,
                                                    name_pair(pair, REFERENCE).text);
    const size_t length = strlen(names.text);
    char *end;
    if (strncmp(*line, names.text, length) != 0)
        return false;
    *jod = strtod(*line + length, &end);
    const bool is_number = end != *line + length && isfinite(*jod) && *jod <= jod_max;
    *line = end + (*end == '\n');
    return is_number && (end[0] == '\n' || !end[0]);
}

static enum neph_status parse_result(const struct run *run, const char *text, const char *log,
                                     struct neph_partner_numbers *numbers, struct neph_diag *diag)
{
    const char *line = text + strcspn(text, "\n"); /* after the names of the columns */
    const int each = run->job->is_sequence ? 1 : run->frame_count;
    line += *line == '\n';
    for (int i = 0; i < count_pairs(run); i++) {
        const struct pair pair = find_pair(run, i);
        struct neph_partner_value *value = &numbers->list[i % each];
        double jod;
        if (!parse_line(&pair, &line, &jod))
            return fail_output(log, "the JOD of each pair", diag);
        if (pair.side == TEST)
            *value = (struct neph_partner_value){pair.frame, jod, NAN};
        else
            value->other = jod;
    }
    numbers->count = each;
    return *line ? fail_output(log, "the JOD of each pair, and nothing else", diag) : NEPH_OK;
}

static enum neph_status read_output(const struct run *run, struct neph_partner_numbers *numbers,
                                    struct neph_diag *diag)
{
    char *log = NULL, *result = NULL;
    numbers->list = calloc((size_t)run->frame_count, sizeof(*numbers->list));
    enum neph_status status = numbers->list ? NEPH_OK : neph_fail_memory(diag);
    if (!status)
        status = read_text(run, log_name, &log, diag);
    if (!status)
        status = read_text(run, result_name, &result, diag);
    if (!status)
        status = parse_conditions(log, numbers, diag);
    if (!status)
        status = parse_result(run, result, log, numbers, diag);
    free(log);
    free(result);
    return status;
}

/* ---- all of it ------------------------------------------------------------------------------- */

static enum neph_status run_in_folder(struct run *run, struct neph_partner_numbers *numbers,
                                      struct neph_diag *diag)
{
    enum neph_status status = write_frames(run, diag);
    if (!status)
        status = start_program(run, diag);
    if (!status)
        status = read_output(run, numbers, diag);
    return status;
}

enum neph_status neph_partner_run(const struct neph_partner_job *job,
                                  struct neph_partner_numbers *numbers, struct neph_diag *diag)
{
    const char *parent = getenv("TMPDIR");
    struct run run = {.job = job,
                      .frame_count = job->test->count - job->first,
                      .gain = exp2(job->viewing.exposure_ev)};
    struct neph_diag why = {.line = 0};
    *numbers = (struct neph_partner_numbers){.display = job->display, .viewing = job->viewing};
    parent = parent && parent[0] ? parent : "/tmp";
    neph_scratch_sweep(parent, scratch_prefix);
    enum neph_status status = neph_scratch_create(parent, scratch_prefix, &run.scratch, &why);
    if (!status) {
        run.folder = neph_scratch_path(run.scratch);
        status = run_in_folder(&run, numbers, &why);
        neph_move_paths(&why, run.folder, NULL);
    }
    neph_scratch_destroy(run.scratch);
    if (!status)
        return NEPH_OK;
    numbers->count = 0;
    snprintf(numbers->not_measured, sizeof(numbers->not_measured), "%s", why.message);
    snprintf(numbers->hint, sizeof(numbers->hint), "%s", why.hint);
    if (diag)
        *diag = why;
    neph_prefix(diag, "cvvdp_jod was not measured: ");
    return status;
}

void neph_partner_finish(struct neph_partner_numbers *numbers)
{
    free(numbers->list);
    *numbers = (struct neph_partner_numbers){.display = NULL};
}

/* What the frames are in the files. */
static const char *frames_as(const struct neph_partner_numbers *numbers, char text[64])
{
    if (numbers->display->is_linear)
        snprintf(text, 64, "cd/m2, white %g, %g EV", numbers->viewing.white_cd_per_m2,
                 numbers->viewing.exposure_ev);
    else
        snprintf(text, 64, "sRGB codes, %g EV", numbers->viewing.exposure_ev);
    return text;
}

int neph_partner_print(const struct neph_partner_numbers *numbers, FILE *out)
{
    const struct neph_partner_value *lowest = numbers->list;
    char as[64];
    if (!numbers->display)
        return 0;
    if (numbers->not_measured[0]) {
        fprintf(out, "not measured: cvvdp_jod: %.*s%s%s%s\n",
                (int)strcspn(numbers->not_measured, "\n"), numbers->not_measured,
                numbers->hint[0] ? " (" : "", numbers->hint, numbers->hint[0] ? ")" : "");
        return 1;
    }
    for (int i = 1; i < numbers->count; i++)
        if (numbers->list[i].test < lowest->test)
            lowest = &numbers->list[i];
    fprintf(out, "cvvdp_jod %.4f JOD", lowest->test);
    if (!isnan(lowest->other))
        fprintf(out, ", of the other test %.4f", lowest->other);
    if (numbers->count > 1)
        fprintf(out, " (frame %d, the lowest of %d)", lowest->frame, numbers->count);
    fprintf(out, ": %s; of %s\n", numbers->conditions, frames_as(numbers, as));
    return 1;
}

json_t *neph_partner_json(const struct neph_partner_numbers *numbers)
{
    json_t *values = json_array();
    char as[64];
    for (int i = 0; i < numbers->count; i++) {
        const struct neph_partner_value *value = &numbers->list[i];
        json_t *row = json_pack("{s:f}", "test", value->test);
        if (value->frame >= 0)
            neph_json_set(&row, "frame", json_integer(value->frame));
        if (!isnan(value->other))
            neph_json_set(&row, "other", json_real(value->other));
        neph_json_add(&values, row);
    }
    const bool is_there = !numbers->not_measured[0];
    return json_pack("{s:s, s:s, s:s, s:s, s:s, s:s?, s:s?, s:o, s:s?}", "name", "cvvdp_jod",
                     "unit", "JOD", "program", "ColorVideoVDP", "display", numbers->display->name,
                     "frames_as", frames_as(numbers, as), "version",
                     is_there ? numbers->version : NULL, "conditions",
                     is_there ? numbers->conditions : NULL, "values", values, "not_measured",
                     is_there ? NULL : numbers->not_measured);
}
