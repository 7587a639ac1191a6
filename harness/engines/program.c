/* SPDX-License-Identifier: MIT */
#include "harness/engines/program.h"

#include "base/child.h"
#include "base/files.h"
#include "base/hash.h"

#include <stdlib.h>
#include <string.h>

static const char scratch_prefix[] = "neph-probe-";
static const size_t text_limit_bytes = 1 << 16;

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

static enum neph_status run_version(const char *program, const char *home, double time_limit_s,
                                    char **text, struct neph_diag *diag)
{
    const char *argv[] = {program, "--version", NULL};
    char *log = neph_path_join(home, "version.log");
    if (!log)
        return neph_fail_memory(diag);
    const struct neph_child_params params = {
        .argv = argv, .log_path = log, .home = home, .time_limit_s = time_limit_s};
    struct neph_child_result result;
    size_t size = 0;
    enum neph_status status = neph_child_run(&params, &result, diag);
    if (!status)
        status = neph_file_read(log, text_limit_bytes, text, &size, diag);
    free(log);
    return status;
}

/* What comes before its name is about the folder it runs in. */
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
