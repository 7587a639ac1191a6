/* SPDX-License-Identifier: MIT */
#include "harness/engines/program.h"

#include "base/child.h"
#include "base/files.h"
#include "base/hash.h"
#include "base/threads.h"
#include "harness/data.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const char scratch_prefix[] = "neph-probe-";
static const double probe_limit_s = 30.0; /* Blender answers in less than 1 s */
static const size_t text_limit_bytes = 1 << 16;
static const int64_t folder_bytes = (int64_t)512 << 20, folder_bytes_per_px = 256,
                     folder_entries = 16384, log_bytes = (int64_t)16 << 20;

enum neph_status neph_program_home(const char *prefix, struct neph_scratch **home,
                                   struct neph_diag *diag)
{
    const char *folder = getenv("TMPDIR");
    folder = folder && folder[0] ? folder : "/tmp";
    neph_scratch_sweep(folder, prefix);
    struct neph_diag why = {.line = 0};
    const enum neph_status status = neph_scratch_create(folder, prefix, home, &why);
    return status ? neph_fail(diag, status, "%s (the folder of TMPDIR)", why.message) : NEPH_OK;
}

/* ---- its files ------------------------------------------------------------------------------- */

struct neph_child_limits neph_program_limits(const struct neph_usage *before, int width_px,
                                             int height_px)
{
    return (struct neph_child_limits){
        .folder_bytes = before->bytes + folder_bytes +
                        folder_bytes_per_px * (int64_t)width_px * (int64_t)height_px,
        .folder_entries = before->entries + folder_entries,
        .log_bytes = log_bytes,
    };
}

static const char *name_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

enum neph_status neph_program_left(const char *path, bool *is_left, struct neph_diag *diag)
{
    struct stat info;
    *is_left = lstat(path, &info) == 0;
    const bool is_link = *is_left && S_ISLNK(info.st_mode);
    if (!*is_left && (errno == ENOENT || errno == ENOTDIR))
        return NEPH_OK;
    if (!*is_left || (is_link && stat(path, &info) != 0))
        return neph_fail(diag, NEPH_ERR_ENGINE, "the program's file '%s' cannot be read: %s",
                         name_of(path), strerror(errno));
    if (S_ISREG(info.st_mode))
        return NEPH_OK;
    return neph_fail(diag, NEPH_ERR_ENGINE, "the program's output '%s' is %s%s, not a file",
                     name_of(path), is_link ? "a link to " : "",
                     S_ISDIR(info.st_mode)    ? "a folder"
                     : S_ISFIFO(info.st_mode) ? "a pipe"
                     : S_ISSOCK(info.st_mode) ? "a socket"
                                              : "a device");
}

enum neph_status neph_program_status(enum neph_status status)
{
    switch (status) {
    case NEPH_OK:
    case NEPH_ERR_MEMORY:
    case NEPH_ERR_TIMEOUT:
    case NEPH_ERR_INTERRUPTED:
    case NEPH_ERR_INTERNAL:
        return status;
    case NEPH_ERR_USAGE:
    case NEPH_ERR_INPUT:
    case NEPH_ERR_NOT_FOUND:
    case NEPH_ERR_IO:
    case NEPH_ERR_UNAVAILABLE:
    case NEPH_ERR_UNSUPPORTED:
    case NEPH_ERR_ENGINE:
    case NEPH_ERR_GATE:
    case NEPH_STATUS_COUNT:
        return NEPH_ERR_ENGINE;
    }
    return NEPH_ERR_ENGINE;
}

/* ---- its version ----------------------------------------------------------------------------- */

static enum neph_status run_version(const char *program, const char *home, double time_limit_s,
                                    char **text, struct neph_diag *diag)
{
    const char *argv[] = {program, "--version", NULL};
    char *log = neph_path_join(home, "version.log");
    if (!log)
        return neph_fail_memory(diag);
    const struct neph_usage nothing = {.bytes = 0};
    struct neph_child_params params = {.argv = argv,
                                       .working_directory = home,
                                       .log_path = log,
                                       .home = home,
                                       .is_confined = true,
                                       .limits = neph_program_limits(&nothing, 0, 0),
                                       .time_limit_s = time_limit_s};
    params.limits.log_bytes = (int64_t)text_limit_bytes;
    struct neph_child_result result;
    size_t size = 0;
    enum neph_status status = neph_child_run(&params, &result, diag);
    if (!status)
        status = neph_program_status(neph_file_read(log, text_limit_bytes, text, &size, diag));
    free(log);
    return status;
}

/* Drop the text before the program's name: it depends on the folder. */
static void start_with(const char *name, char *text)
{
    const char *start = strstr(text, name);
    if (start)
        memmove(text, start, strlen(start) + 1);
}

static enum neph_status digest(const char *program, const char *text, char build[NEPH_BUILD_SIZE],
                               struct neph_diag *diag)
{
    char hex[NEPH_HASH_HEX_SIZE];
    char *path = neph_child_find_program(program), *both = NULL;
    enum neph_status status = path ? neph_hash_file(path, hex, diag) : neph_fail_memory(diag);
    if (!status) {
        both = neph_format("%s\n%s", hex, text);
        status = both ? neph_hash(both, strlen(both), hex, diag) : neph_fail_memory(diag);
    }
    if (!status) {
        memcpy(build, hex, NEPH_BUILD_SIZE - 1);
        build[NEPH_BUILD_SIZE - 1] = '\0';
    }
    free(both);
    free(path);
    return status;
}

enum neph_status neph_program_ask(const char *program, const char *name, double time_limit_s,
                                  char **text, char build[NEPH_BUILD_SIZE], struct neph_diag *diag)
{
    struct neph_scratch *home = NULL;
    char *said = NULL;
    enum neph_status status = neph_program_home(scratch_prefix, &home, diag);
    if (!status)
        status = run_version(program, neph_scratch_path(home), time_limit_s, &said, diag);
    if (status && home)
        neph_move_paths(diag, neph_scratch_path(home), NULL);
    neph_scratch_destroy(home);
    if (!status) {
        start_with(name, said);
        status = digest(program, said, build, diag);
    }
    if (status) {
        free(said);
        return status;
    }
    *text = said;
    return NEPH_OK;
}

/* ---- external renderers ---------------------------------------------------------------------- */

/* The `index`-th non-empty entry of the environment variable; NULL: there is none. */
static char *entry_of(const struct neph_external_renderer *renderer, int index)
{
    const char *list = getenv(renderer->variable);
    const char *const separator = renderer->is_list ? ":" : "";
    for (int count = 0; list && *list;) {
        const size_t length = strcspn(list, separator);
        if (length > 0 && count++ == index)
            return strndup(list, length);
        list += length + (list[length] != '\0');
    }
    return NULL;
}

int neph_external_count(const struct neph_external_renderer *renderer)
{
    for (int count = 0;; count++) {
        char *entry = entry_of(renderer, count);
        if (!entry)
            return count > 0 ? count : 1;
        free(entry);
    }
}

static char *find_named(const struct neph_external_renderer *renderer, const char *entry,
                        char *missing, size_t missing_size)
{
    const bool is_folder = neph_path_is_dir(entry);
    char *named = is_folder ? neph_path_join(entry, renderer->program) : strdup(entry);
    char *path = named ? neph_child_find_program(named) : NULL;
    free(named);
    if (!path && is_folder)
        snprintf(missing, missing_size, "%s: there is no program '%s' in folder '%.300s'",
                 renderer->variable, renderer->program, entry);
    else if (!path)
        snprintf(missing, missing_size, "%s: '%.300s' is no program that can be run",
                 renderer->variable, entry);
    return path;
}

char *neph_external_find(const struct neph_external_renderer *renderer, int index, char *missing,
                         size_t missing_size)
{
    char *entry = entry_of(renderer, index), *path = NULL;
    if (neph_external_count(renderer) > NEPH_EXTERNAL_PROGRAMS_MAX)
        snprintf(missing, missing_size, "%s names %d programs; %d are taken at most",
                 renderer->variable, neph_external_count(renderer), NEPH_EXTERNAL_PROGRAMS_MAX);
    else if (entry)
        path = find_named(renderer, entry, missing, missing_size);
    else if (!(path = neph_child_find_program(renderer->program)))
        snprintf(missing, missing_size, "there is no program '%s' in PATH", renderer->program);
    free(entry);
    return path;
}

static enum neph_status ask_version(const struct neph_external_renderer *renderer,
                                    const char *program, char **text, char build[NEPH_BUILD_SIZE],
                                    struct neph_diag *diag)
{
    char name[64];
    snprintf(name, sizeof(name), "%s ", renderer->name);
    return neph_program_ask(program, name, probe_limit_s, text, build, diag);
}

bool neph_external_version(const struct neph_external_renderer *renderer, int index,
                           char version[64])
{
    char missing[512], build[NEPH_BUILD_SIZE], *text = NULL;
    char *program = neph_external_find(renderer, index, missing, sizeof(missing));
    const bool is_told = program && !ask_version(renderer, program, &text, build, NULL) &&
                         renderer->parse_version(text, version);
    free(text);
    free(program);
    return is_told;
}

bool neph_version_is_from(const char *version, int major, int minor)
{
    int numbers[2] = {0, 0};
    sscanf(version, "%d.%d", &numbers[0], &numbers[1]);
    return numbers[0] > major || (numbers[0] == major && numbers[1] >= minor);
}

static bool is_measured(const struct neph_external_renderer *renderer, const char *version)
{
    for (const char *const *start = renderer->measured; *start; start++)
        if (strncmp(version, *start, strlen(*start)) == 0)
            return true;
    return false;
}

static void judge_version(const struct neph_external_renderer *renderer, const char *program,
                          const char *text, struct neph_engine_info *info)
{
    char version[64];
    if (!renderer->parse_version(text, version)) {
        snprintf(info->missing, sizeof(info->missing),
                 "'%.300s --version' does not print a version", program);
        return;
    }
    info->broken = false;
    if (!neph_version_is_from(version, renderer->oldest[0], renderer->oldest[1])) {
        snprintf(info->missing, sizeof(info->missing),
                 "wrong version: '%.300s' is %s %s; versions from %d.%d on are taken", program,
                 renderer->name, version, renderer->oldest[0], renderer->oldest[1]);
        return;
    }
    info->available = true;
    snprintf(info->version, sizeof(info->version), "%s %s", renderer->name, version);
    snprintf(info->device, sizeof(info->device), "CPU, %d threads", neph_processor_count());
    if (!is_measured(renderer, version))
        snprintf(info->warning, sizeof(info->warning),
                 "%s %s was not measured; its media were measured for %s", renderer->name, version,
                 renderer->laws);
}

static void try_version(const struct neph_external_renderer *renderer, const char *program,
                        struct neph_engine_info *info)
{
    struct neph_diag diag = {0};
    char *text = NULL;
    if (ask_version(renderer, program, &text, info->build, &diag))
        snprintf(info->missing, sizeof(info->missing), "'%.120s --version' failed: %.380s", program,
                 diag.message);
    else
        judge_version(renderer, program, text, info);
    free(text);
}

static bool has_data_file(const struct neph_external_renderer *renderer,
                          struct neph_engine_info *info)
{
    if (!renderer->data_file)
        return true;
    char *path = neph_data_path(renderer->data_file);
    const bool is_there = path && neph_path_exists(path);
    if (!is_there)
        snprintf(info->missing, sizeof(info->missing),
                 "'%.300s' is missing; set NEPH_DATA_DIR to the folder with scripts/",
                 path ? path : renderer->data_file);
    free(path);
    return is_there;
}

void neph_external_probe(const struct neph_external_renderer *renderer, int index,
                         struct neph_engine_info *info)
{
    *info = (struct neph_engine_info){.available = false};
    neph_install_line(&renderer->packages, info->install_line, sizeof(info->install_line));
    char *program = neph_external_find(renderer, index, info->missing, sizeof(info->missing));
    if (!program)
        return;
    info->broken = true;
    if (has_data_file(renderer, info))
        try_version(renderer, program, info);
    free(program);
}

enum neph_status neph_external_missing(const struct neph_external_renderer *renderer,
                                       const char *why, struct neph_diag *diag)
{
    char line[256];
    neph_install_line(&renderer->packages, line, sizeof(line));
    if (why)
        neph_fail(diag, NEPH_ERR_UNAVAILABLE, "%s", why);
    neph_hint(diag, "%s", line);
    return NEPH_ERR_UNAVAILABLE;
}

enum neph_status neph_external_run(const struct neph_external_renderer *renderer,
                                   const char *const argv[], const char *folder, const char *log,
                                   const struct neph_shot *shot, struct neph_child_result *result,
                                   struct neph_diag *diag)
{
    const struct neph_usage before = neph_usage_measure(folder);
    const struct neph_child_params params = {
        .argv = argv,
        .working_directory = folder,
        .log_path = log,
        .home = folder,
        .environment = renderer->environment,
        .limits = neph_program_limits(&before, shot->width_px, shot->height_px),
        .time_limit_s = shot->time_limit_s};
    const enum neph_status status = neph_child_run(&params, result, diag);
    return status == NEPH_ERR_UNAVAILABLE ? neph_external_missing(renderer, NULL, diag) : status;
}

enum neph_status neph_external_left(const struct neph_external_renderer *renderer, const char *path,
                                    const char *which, const char *log, struct neph_diag *diag)
{
    bool is_left = false;
    const enum neph_status status = neph_program_left(path, &is_left, diag);
    if (status || is_left)
        return status;
    neph_fail(diag, NEPH_ERR_ENGINE, "%s ended well but wrote no %simage", renderer->name, which);
    neph_hint(diag, "its whole log is '%s'", log);
    return NEPH_ERR_ENGINE;
}

enum neph_status neph_external_size(const struct neph_external_renderer *renderer,
                                    const char *which, int width_px, int height_px,
                                    const struct neph_shot *shot, struct neph_diag *diag)
{
    if (width_px == shot->width_px && height_px == shot->height_px)
        return NEPH_OK;
    return neph_fail(diag, NEPH_ERR_ENGINE, "%s's %simage is %d x %d pixels, not %d x %d",
                     renderer->name, which, width_px, height_px, shot->width_px, shot->height_px);
}

enum neph_status neph_external_cannot(const char *name, enum neph_status status,
                                      const struct neph_diag *why, struct neph_diag *diag)
{
    if (!status)
        return NEPH_OK;
    neph_fail(diag, status, "%s%s%s", status == NEPH_ERR_UNSUPPORTED ? name : "",
              status == NEPH_ERR_UNSUPPORTED ? " cannot: " : "", why->message);
    neph_hint(diag, "%s", why->hint);
    return status;
}
