/* SPDX-License-Identifier: MIT */
#include "harness/engines/povray_run.h"

#include "base/files.h"
#include "base/png.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Limit of renders of one image at different gains. */
#define EXPOSURES_MAX 8

/* ---- the program ----------------------------------------------------------------------------- */

/* Find the word after "POV-Ray " that starts with a digit, such as "3.7.0.10.unofficial". */
static bool parse_version(const char *text, char version[64])
{
    static const char name[] = "POV-Ray ";
    for (const char *at = text; (at = strstr(at, name)); at += sizeof(name) - 1) {
        if (sscanf(at + sizeof(name) - 1, "%63[0-9.]", version) != 1)
            continue;
        size_t length = strlen(version);
        while (length > 0 && version[length - 1] == '.')
            version[--length] = '\0';
        return length > 0;
    }
    return false;
}

static const char *const environment[] = {"POVINI=povray.ini", NULL}; /* in the working folder */

static const char *const measured[] = {"3.7.0.", NULL};

const struct neph_external_renderer neph_povray = {
    .program = "povray",
    .variable = "NEPH_POVRAY",
    .name = "POV-Ray",
    .packages = {"povray", "povray", "povray"},
    .parse_version = parse_version,
    .measured = measured,
    .laws = "3.7.0",
    .oldest = {3, 7},
    .environment = environment,
};

/* ---- one child process ----------------------------------------------------------------------- */

/* File names of one image. `scene` and `image` are relative: POV-Ray runs in their folder. */
struct files {
    char scene[64], image[64];
    char *scene_path, *image_path, *log_path;
};

static void free_files(struct files *files)
{
    free(files->scene_path);
    free(files->image_path);
    free(files->log_path);
}

static enum neph_status name_files(const char *directory, const char *name, struct files *files,
                                   struct neph_diag *diag)
{
    char log[80];
    snprintf(files->scene, sizeof(files->scene), "%.48s.pov", name);
    snprintf(files->image, sizeof(files->image), "%.48s.png", name);
    snprintf(log, sizeof(log), "povray-%.48s.log", name);
    files->scene_path = neph_path_join(directory, files->scene);
    files->image_path = neph_path_join(directory, files->image);
    files->log_path = neph_path_join(directory, log);
    if (files->scene_path && files->image_path && files->log_path)
        return NEPH_OK;
    return neph_fail_memory(diag);
}

/* The only ini file that POV-Ray reads when POVINI names it: neither the system's, nor the user's
 * in ~/.povray, nor one in the working folder. It sets no Library_Path: images need no other files
 * than the volumes beside them. */
static const char ini_name[] = "povray.ini";
static const char ini_text[] =
    "; What decides a picture and stands on no command line; read instead of\n"
    "; any other povray.ini.\n"
    "Antialias=off\nJitter=off\nQuality=9\n"
    "Bounding=on\nBounding_Method=1\nBounding_Threshold=3\n"
    "Remove_Bounds=on\nSplit_Unions=off\n"
    "Output_to_File=on\nOutput_Alpha=off\nContinue_Trace=off\n"
    "Clock=0\nInitial_Frame=1\nFinal_Frame=1\nField_Render=off\n";

enum neph_status neph_povray_write_ini(const char *directory, struct neph_diag *diag)
{
    char *path = neph_path_join(directory, ini_name);
    const enum neph_status status = path ? neph_file_write(path, ini_text, strlen(ini_text), diag)
                                         : neph_fail_memory(diag);
    free(path);
    return status;
}

enum neph_status neph_povray_write(const struct neph_povray_session *session,
                                   const struct neph_povray_pass *pass, const char *path,
                                   struct neph_diag *diag)
{
    char *text = NULL;
    enum neph_status status = neph_povray_text(&session->world, pass, &text, diag);
    if (!status)
        status = neph_file_write(path, text, strlen(text), diag);
    free(text);
    return status;
}

static enum neph_status run_povray(struct neph_povray_session *session, const struct files *files,
                                   double *wall_s, struct neph_diag *diag)
{
    char input[72], output[72], width[16], height[16], threads[16];
    snprintf(input, sizeof(input), "+I%s", files->scene);
    snprintf(output, sizeof(output), "+O%s", files->image);
    snprintf(width, sizeof(width), "+W%d", session->shot.width_px);
    snprintf(height, sizeof(height), "+H%d", session->shot.height_px);
    snprintf(threads, sizeof(threads), "+WT%d", session->threads);
    const char *argv[] = {session->program,
                          input,
                          output,
                          "+FN16",
                          "File_Gamma=1.0",
                          "Dither=off",
                          width,
                          height,
                          "+Q9",
                          "-A",
                          "-D",
                          "-P",
                          "-C",
                          "-GA",
                          "+BS8",
                          threads,
                          NULL};
    struct neph_child_result result = {0};
    const enum neph_status status = neph_external_run(
        &neph_povray, argv, session->shot.scratch_directory, files->log_path, &session->shot,
        &result, diag);
    session->cost.cpu_s += result.cpu_s;
    if (result.peak_memory_bytes > session->cost.peak_memory_bytes)
        session->cost.peak_memory_bytes = result.peak_memory_bytes;
    *wall_s = result.wall_s;
    return status;
}

/* Read the image and check its size. No image existed before the run, so it is new. */
static enum neph_status read_image(const struct neph_povray_session *session,
                                   const struct files *files, uint16_t **codes,
                                   struct neph_diag *diag)
{
    int width_px = 0, height_px = 0;
    uint16_t *read = NULL;
    enum neph_status status = neph_external_left(&neph_povray, files->image_path, "",
                                                 files->log_path, diag);
    if (!status)
        status = neph_program_status(
            neph_png_read_rgb16(files->image_path, &width_px, &height_px, &read, diag));
    if (!status)
        status = neph_external_size(&neph_povray, "", width_px, height_px, &session->shot, diag);
    if (status)
        free(read);
    else
        *codes = read;
    return status;
}

enum neph_status neph_povray_image(struct neph_povray_session *session, const char *name,
                                   const struct neph_povray_pass *pass, uint16_t **codes,
                                   double *wall_s, struct neph_diag *diag)
{
    struct files files = {.scene_path = NULL};
    enum neph_status status = name_files(session->shot.scratch_directory, name, &files, diag);
    if (!status)
        status = neph_povray_write(session, pass, files.scene_path, diag);
    if (!status && unlink(files.image_path) && errno != ENOENT)
        status = neph_fail(diag, NEPH_ERR_IO, "cannot remove '%s': %s", files.image_path,
                           strerror(errno));
    if (!status)
        status = run_povray(session, &files, wall_s, diag);
    if (!status)
        status = read_image(session, &files, codes, diag);
    if (!status)
        session->renders[pass->kind]++;
    free_files(&files);
    return status;
}

/* ---- one quantity ---------------------------------------------------------------------------- */

/* Update the readings from an image. With photons all channels have the same value, so only the
 * first bracket is used and the others count as clamped. */
static void take_readings(const struct neph_povray_session *session, const uint16_t *codes,
                          double gain, struct neph_povray_reading *readings)
{
    const bool is_single = neph_povray_has_photons(session->shot.scene);
    for (size_t i = 0; i < session->pixel_count; i++) {
        const uint16_t first[] = {codes[3 * i], UINT16_MAX, UINT16_MAX};
        const uint16_t *brackets = is_single ? first : codes + 3 * i;
        readings[i] = neph_povray_better(readings[i], neph_povray_read_brackets(brackets, gain));
    }
}

static bool any_clamped(const struct neph_povray_reading *readings, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (isinf(readings[i].error))
            return true;
    }
    return false;
}

enum neph_status neph_povray_expose(struct neph_povray_session *session, const char *name,
                                    struct neph_povray_pass pass, double bound,
                                    const struct neph_povray_target *target,
                                    struct neph_povray_reading **readings, double *wall_s,
                                    struct neph_diag *diag)
{
    size_t count = session->pixel_count;
    struct neph_povray_reading *best = malloc(count * sizeof(*best));
    enum neph_status status = best ? NEPH_OK : neph_fail_memory(diag);
    for (size_t i = 0; !status && i < count; i++)
        best[i] = (struct neph_povray_reading){0.0, INFINITY};
    pass.gain = NEPH_POVRAY_HEADROOM / bound;
    for (int i = 1; !status && pass.gain > 0.0 && i <= EXPOSURES_MAX; i++) {
        char file[64];
        uint16_t *codes = NULL;
        snprintf(file, sizeof(file), "%.32s-%d", name, i);
        status = neph_povray_image(session, file, &pass, &codes, wall_s, diag);
        if (status)
            break;
        take_readings(session, codes, pass.gain, best);
        free(codes);
        pass.gain = neph_povray_next_gain(best, count, pass.gain, target);
    }
    if (!status && any_clamped(best, count))
        status = neph_fail(diag, NEPH_ERR_ENGINE,
                           "the image '%s' is brighter than POV-Ray's images can represent", name);
    if (status) {
        free(best);
        return status;
    }
    *readings = best;
    return NEPH_OK;
}
