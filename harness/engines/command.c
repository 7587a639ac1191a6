/* SPDX-License-Identifier: MIT
 *
 * Engine `command`: a renderer of the user, the program that NEPH_COMMAND names. `PROGRAM
 * --version` prints its name. `PROGRAM job.json` renders a frame; it runs in a folder with job.json
 * and depth.exr and writes frame.exr there. Frames of a sequence use the same folder.
 */
#include "harness/engines/command_job.h"
#include "harness/engines/engines.h"

#include "base/child.h"
#include "base/exr.h"
#include "base/files.h"
#include "base/text.h"
#include "base/threads.h"
#include "harness/engines/frame_stats.h"
#include "harness/engines/program.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double probe_limit_s = 30.0;
static const char install_line[] = "export NEPH_COMMAND=/path/to/your/program";
static const char scratch_prefix[] = "neph-command-";
static const size_t reason_max_bytes = 4096;

enum { WARM_UP };

#define PARAMETER(letter)                                                                          \
    {                                                                                              \
        .name = letter, .kind = NEPH_OPTION_REAL, .minimum = -1e30, .maximum = 1e30,               \
        .help = "a number for the program to do with as it likes",                                 \
    }

static const struct neph_option options[] = {
    [WARM_UP] =
        {.name = "warm_up",
         .kind = NEPH_OPTION_INTEGER,
         .minimum = 0,
         .maximum = 1024,
         .help =
             "frames rendered before the first one, to fill the program's history; not measured"},
    PARAMETER("a"),
    PARAMETER("b"),
    PARAMETER("c"),
    PARAMETER("d"),
    {.name = NULL},
};

/* ---- the program ----------------------------------------------------------------------------- */

/* The program; NULL: none is named. */
static const char *program_of_the_user(void)
{
    const char *program = getenv("NEPH_COMMAND");
    return program && program[0] ? program : NULL;
}

static void probe(const struct neph_engine *engine, struct neph_shared_device *device,
                  struct neph_engine_info *info)
{
    (void)engine, (void)device;
    *info = (struct neph_engine_info){.available = false};
    const char *program = program_of_the_user();
    snprintf(info->install_line, sizeof(info->install_line), "%s", install_line);
    if (!program) {
        snprintf(info->missing, sizeof(info->missing), "NEPH_COMMAND names no program");
        return;
    }
    struct neph_diag diag = {0};
    char *text = NULL;
    info->broken = neph_program_ask(program, "", probe_limit_s, &text, info->build, &diag) !=
                   NEPH_OK;
    if (info->broken) {
        snprintf(info->missing, sizeof(info->missing), "'%.120s --version' failed: %.350s", program,
                 diag.message);
        return;
    }
    text[strcspn(text, "\n")] = '\0';
    snprintf(info->version, sizeof(info->version), "%.120s", text);
    info->broken = !text[0];
    if (info->broken)
        snprintf(info->missing, sizeof(info->missing), "'%.120s --version' says nothing", program);
    free(text);
    info->available = !info->broken;
    snprintf(info->device, sizeof(info->device), "its own, %d processors", neph_processor_count());
}

/* ---- one frame ------------------------------------------------------------------------------- */

/* A sequence: the folder of its frames, and the number of frames so far. */
struct sequence {
    struct neph_scratch *scratch; /* NULL: the folder has another owner */
    const char *folder;
    struct neph_usage before; /* disk usage of the folder before the first frame */
    int pictures;
    bool keeps; /* an error message refers to a file in the folder, so it stays */
};

/* Paths of the program's files, owned. */
struct files {
    char *frame, *cannot, *log;
};

static void free_files(struct files *files)
{
    free(files->frame);
    free(files->cannot);
    free(files->log);
}

/* Remove old files: the program may have replaced one by a folder, or by a link that would make
 * neph overwrite another file. */
static enum neph_status remove_old(const char *folder, struct neph_diag *diag)
{
    static const char *const names[] = {"frame.exr", "cannot.txt", "program.log", "job.json",
                                        "depth.exr"};
    enum neph_status status = NEPH_OK;
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]) && !status; i++) {
        char *path = neph_path_join(folder, names[i]);
        status = path ? neph_dir_remove(path, diag) : neph_fail_memory(diag);
        free(path);
    }
    return status;
}

/* Remove old files and name the new ones: a file that exists after the run is new. */
static enum neph_status name_files(const char *folder, struct files *files, struct neph_diag *diag)
{
    *files = (struct files){neph_path_join(folder, "frame.exr"),
                            neph_path_join(folder, "cannot.txt"),
                            neph_path_join(folder, "program.log")};
    if (!files->frame || !files->cannot || !files->log)
        return neph_fail_memory(diag);
    return remove_old(folder, diag);
}

static enum neph_status run(const struct sequence *sequence, const struct neph_shot *shot,
                            const char *log, struct neph_cost *cost, struct neph_diag *diag)
{
    const char *folder = sequence->folder;
    const char *program = program_of_the_user();
    if (!program)
        return neph_fail(diag, NEPH_ERR_UNAVAILABLE, "NEPH_COMMAND names no program");
    const char *argv[] = {program, "job.json", NULL};
    const struct neph_child_params params = {
        .argv = argv,
        .working_directory = folder,
        .log_path = log,
        .home = folder,
        .is_confined = true,
        .limits = neph_program_limits(&sequence->before, shot->width_px, shot->height_px),
        .time_limit_s = shot->time_limit_s};
    struct neph_child_result result = {0};
    const enum neph_status status = neph_child_run(&params, &result, diag);
    *cost = (struct neph_cost){.render_s = result.wall_s,
                               .wall_s = result.wall_s,
                               .cpu_s = result.cpu_s,
                               .peak_memory_bytes = result.peak_memory_bytes};
    return status;
}

static enum neph_status refuse(const char *path, struct neph_diag *diag)
{
    char *reason = NULL;
    size_t size = 0;
    enum neph_status status = neph_program_status(
        neph_file_read(path, reason_max_bytes, &reason, &size, diag));
    if (status)
        return status;
    reason[strcspn(reason, "\n")] = '\0';
    neph_text_clean(reason, size + 1);
    status = neph_fail(diag, NEPH_ERR_UNSUPPORTED, "cannot: %.300s", reason);
    free(reason);
    return status;
}

/* Copy the attributes "stats.NAME", which are costs of the frame. Other attributes of the program
 * are ignored. */
static enum neph_status take_stats(const struct neph_image *from, struct neph_image *frame,
                                   struct neph_cost *cost, struct neph_diag *diag)
{
    static const char start[] = "stats.";
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < from->attribute_count && !status; i++) {
        const struct neph_attribute *attribute = &from->attributes[i];
        if (strncmp(attribute->name, start, sizeof(start) - 1) != 0)
            continue;
        const char *name = attribute->name + sizeof(start) - 1;
        char *end;
        const double value = strtod(attribute->value, &end);
        if (end == attribute->value || *end)
            return neph_fail(diag, NEPH_ERR_ENGINE, "frame.exr: '%s' is '%s' and no number",
                             attribute->name, attribute->value);
        status = neph_frame_stats_set(frame, name, value, diag);
        if (strcmp(name, "render_s") == 0 && value > 0.0 && value <= cost->wall_s)
            cost->render_s = value;
    }
    return status;
}

static enum neph_status take_channels(const struct neph_image *from, struct neph_image *frame,
                                      struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int c = 0; c < from->channel_count && !status; c++) {
        float *samples = NULL;
        status = neph_image_add_channel(frame, from->channels[c].name, &samples, diag);
        if (!status)
            memcpy(samples, from->channels[c].samples,
                   neph_image_pixel_count(from) * sizeof(*samples));
    }
    return status;
}

/* Check properties of the file in addition to those that every engine's frame must have. */
static enum neph_status check_file(const struct neph_image *image, const struct neph_shot *shot,
                                   struct neph_diag *diag)
{
    static const char *const unusual[] = {"primaries", "colour_space", "crop", "pixel_aspect"};
    float *rgb[3];
    for (size_t i = 0; i < sizeof(unusual) / sizeof(unusual[0]); i++)
        if (neph_image_attribute(image, unusual[i]))
            return neph_fail(diag, NEPH_ERR_ENGINE,
                             "frame.exr has %s %s; expected is a whole image with square pixels in "
                             "linear Rec.709",
                             unusual[i], neph_image_attribute(image, unusual[i]));
    if (image->width_px != shot->width_px || image->height_px != shot->height_px)
        return neph_fail(diag, NEPH_ERR_ENGINE, "frame.exr is %d x %d pixels, not %d x %d",
                         image->width_px, image->height_px, shot->width_px, shot->height_px);
    if ((shot->layers & NEPH_LAYER_RADIANCE) && !neph_image_rgb(image, NULL, rgb))
        return neph_fail(diag, NEPH_ERR_ENGINE, "frame.exr lacks one of the channels R, G, B");
    return NEPH_OK;
}

static enum neph_status read_frame(const struct files *files, const struct neph_shot *shot,
                                   struct neph_image **frame, struct neph_cost *cost,
                                   struct neph_diag *diag)
{
    struct neph_image *image = NULL, *taken = NULL;
    bool refuses = false, is_left = false;
    enum neph_status status = neph_program_left(files->cannot, &refuses, diag);
    if (!status && refuses)
        return refuse(files->cannot, diag);
    if (!status)
        status = neph_program_left(files->frame, &is_left, diag);
    if (!status && !is_left)
        status = neph_fail(diag, NEPH_ERR_ENGINE, "the program ended well and left no frame.exr");
    if (!status)
        status = neph_program_status(neph_exr_read(files->frame, &image, diag));
    if (!status)
        status = check_file(image, shot, diag);
    if (!status)
        status = neph_image_create(image->width_px, image->height_px, &taken, diag);
    if (!status)
        status = take_channels(image, taken, diag);
    if (!status)
        status = take_stats(image, taken, cost, diag);
    neph_image_destroy(image);
    if (status) {
        neph_image_destroy(taken);
        return status;
    }
    *frame = taken;
    return NEPH_OK;
}

static enum neph_status next_picture(void *opened, const struct neph_shot *shot,
                                     struct neph_image **frame, struct neph_cost *cost,
                                     struct neph_diag *diag)
{
    struct sequence *sequence = opened;
    struct files files;
    enum neph_status status = name_files(sequence->folder, &files, diag);
    if (!status)
        status = neph_command_job_write(&neph_engine_command, shot, sequence->pictures++,
                                        sequence->folder, diag);
    if (!status)
        status = run(sequence, shot, files.log, cost, diag);
    if (!status)
        status = read_frame(&files, shot, frame, cost, diag);
    free_files(&files);
    if (status == NEPH_ERR_ENGINE || status == NEPH_ERR_TIMEOUT) {
        sequence->keeps = true;
        neph_hint(diag, "its input, output and log are in '%s'", sequence->folder);
    }
    return status;
}

/* ---- sequences ------------------------------------------------------------------------------- */

static enum neph_status warm_up(struct sequence *sequence, const struct neph_shot *shot,
                                struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int left = (int)shot->settings.values[WARM_UP]; left > 0 && !status; left--) {
        struct neph_shot before = *shot;
        struct neph_image *image = NULL;
        struct neph_cost cost;
        before.frame -= left;
        status = next_picture(sequence, &before, &image, &cost, diag);
        neph_image_destroy(image);
    }
    return status;
}

static void close_sequence(void *opened)
{
    struct sequence *sequence = opened;
    if (!sequence)
        return;
    if (sequence->keeps)
        neph_scratch_keep(sequence->scratch);
    else
        neph_scratch_destroy(sequence->scratch);
    free(sequence);
}

static enum neph_status open_sequence(const struct neph_engine *engine,
                                      const struct neph_shot *shot, void **opened,
                                      struct neph_diag *diag)
{
    (void)engine;
    struct sequence *sequence = calloc(1, sizeof(*sequence));
    if (!sequence)
        return neph_fail_memory(diag);
    enum neph_status status = neph_program_home(scratch_prefix, &sequence->scratch, diag);
    if (!status) {
        sequence->folder = neph_scratch_path(sequence->scratch);
        sequence->before = neph_usage_measure(sequence->folder);
        status = warm_up(sequence, shot, diag);
    }
    if (status)
        close_sequence(sequence);
    else
        *opened = sequence;
    return status;
}

static enum neph_status render(const struct neph_shot *shot, struct neph_image **frame,
                               struct neph_cost *cost, struct neph_diag *diag)
{
    struct sequence sequence = {.folder = shot->scratch_directory,
                                .before = neph_usage_measure(shot->scratch_directory)};
    const enum neph_status status = warm_up(&sequence, shot, diag);
    return status ? status : next_picture(&sequence, shot, frame, cost, diag);
}

/* Refuse a scene that was changed after it was read: the program reads the scene's file. The
 * program reports its other limits at run time. */
static bool can_render(const struct neph_scene *scene, const struct neph_settings *settings,
                       char *reason, size_t reason_size)
{
    (void)settings;
    const bool is_of_the_file = !scene->borrows || scene->is_as_filed;
    if (!is_of_the_file && reason_size > 0)
        snprintf(reason, reason_size,
                 "the scene was changed after it was read, and a program reads the file");
    return is_of_the_file;
}

static const struct neph_engine_sequence sequence_of = {
    .open = open_sequence,
    .next = next_picture,
    .close = close_sequence,
};

const struct neph_engine neph_engine_command = {
    .name = "command",
    .summary = "a renderer of your own: the program that NEPH_COMMAND names",
    .rung = NEPH_RUNG_MODEL,
    .typical_s = 5.0,
    .bias = "unknown: the program is yours",
    .options = options,
    .sequence = &sequence_of,
    .remembers = true,
    .version = 1,
    .is_guest = true,
    .stochastic = true,
    .step = {.option = NULL},
    .probe = probe,
    .can_render = can_render,
    .render = render,
};
