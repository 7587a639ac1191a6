/* SPDX-License-Identifier: MIT */
#include "base/helper.h"

#include "base/child.h"
#include "base/files.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sysexits.h>
#include <unistd.h>

enum { REASON_BYTES = 1000 };

enum neph_status neph_helper_find(const struct neph_helper *helper, char **program,
                                  struct neph_diag *diag)
{
    const char *named = getenv(helper->variable);
    char *path = named && named[0] ? strdup(named) : neph_path_beside_program(helper->name);
    if (!path)
        path = strdup(helper->built);
    if (!path)
        return neph_fail_memory(diag);
    if (path[0] && neph_child_program_exists(path)) {
        *program = path;
        return NEPH_OK;
    }
    neph_fail(diag, NEPH_ERR_UNAVAILABLE, "the program '%s', which reads %s, is missing",
              path[0] ? path : helper->name, helper->reads);
    neph_hint(diag, "%s", helper->missing);
    free(path);
    return NEPH_ERR_UNAVAILABLE;
}

/* ---- shared memory --------------------------------------------------------------------------- */

enum neph_status neph_shared_create(const char *name, struct neph_shared *shared,
                                    struct neph_diag *diag)
{
    shared->fd = memfd_create(name, MFD_CLOEXEC);
    if (shared->fd < 0)
        return neph_fail(diag, NEPH_ERR_MEMORY, "memfd_create: %s", strerror(errno));
    snprintf(shared->path, sizeof(shared->path), "/proc/%ld/fd/%d", (long)getpid(), shared->fd);
    return NEPH_OK;
}

enum neph_status neph_shared_map(const struct neph_shared *shared, const void **bytes, size_t *size,
                                 struct neph_diag *diag)
{
    struct stat info;
    if (fstat(shared->fd, &info) != 0)
        return neph_fail(diag, NEPH_ERR_IO, "fstat: %s", strerror(errno));
    const size_t length = (size_t)info.st_size;
    void *mapped = length > 0 ? mmap(NULL, length, PROT_READ, MAP_SHARED, shared->fd, 0) : NULL;
    if (mapped == MAP_FAILED)
        return neph_fail(diag, NEPH_ERR_MEMORY, "mmap: %s", strerror(errno));
    *bytes = mapped;
    *size = length;
    return NEPH_OK;
}

void neph_shared_destroy(struct neph_shared *shared)
{
    if (shared->fd >= 0)
        close(shared->fd);
}

/* ---- the log --------------------------------------------------------------------------------- */

/* The last line of the log: the reason, and the way out ("" if there is none). */
struct reason {
    char text[REASON_BYTES];
    const char *hint;
};

/* Splits the line, in printable ASCII: names in damaged files may contain any bytes. */
static void find_hint(struct reason *reason)
{
    char *tab = strchr(reason->text, '\t');
    reason->hint = tab ? tab + 1 : "";
    if (tab)
        *tab = '\0';
    for (char *at = reason->text; at < reason->text + sizeof(reason->text); at++)
        if (*at && ((unsigned char)*at < ' ' || (unsigned char)*at > '~'))
            *at = '?';
}

static void read_last_line(int log_fd, char reason[REASON_BYTES])
{
    struct stat info = {.st_size = 0};
    fstat(log_fd, &info);
    const off_t start = info.st_size > REASON_BYTES - 1 ? info.st_size - (REASON_BYTES - 1) : 0;
    ssize_t length = pread(log_fd, reason, REASON_BYTES - 1, start);
    while (length > 0 && reason[length - 1] == '\n')
        length--;
    reason[length > 0 ? length : 0] = '\0';
    const char *newline = strrchr(reason, '\n');
    if (newline)
        memmove(reason, newline + 1, strlen(newline + 1) + 1);
}

enum neph_status neph_helper_explain(const struct neph_helper *helper,
                                     const struct neph_child_result *result,
                                     const struct neph_shared *log, struct neph_diag *diag)
{
    struct reason reason = {.text = ""};
    read_last_line(log->fd, reason.text);
    find_hint(&reason);
    if (result->signal == SIGXCPU)
        return neph_fail(diag, NEPH_ERR_INPUT, "damaged: %s did not end within %.0f s",
                         helper->library, result->cpu_s);
    if (result->signal)
        return neph_fail(diag, NEPH_ERR_INPUT, "damaged: %s crashed on it (signal %d)",
                         helper->library, result->signal);
    switch (result->exit_code) {
    case EX_DATAERR:
        neph_fail(diag, NEPH_ERR_INPUT, "%s", reason.text);
        if (*reason.hint)
            neph_hint(diag, "%s", reason.hint);
        return NEPH_ERR_INPUT;
    case EX_IOERR:
        return neph_fail(diag, NEPH_ERR_IO, "%s", reason.text);
    case EX_OSERR:
        return neph_fail(diag, NEPH_ERR_MEMORY, "%s", reason.text);
    }
    return neph_fail(diag, NEPH_ERR_UNAVAILABLE, "%s does not work: exit code %d, '%s'",
                     helper->name, result->exit_code, reason.text);
}

/* ---- the run --------------------------------------------------------------------------------- */

char *neph_helper_variable(const char *name)
{
    const char *value = getenv(name);
    return neph_format("%s=%s", name, value ? value : "");
}

enum neph_status neph_helper_run(const struct neph_helper *helper,
                                 const char *argv[NEPH_HELPER_ARGUMENTS_MAX], double time_limit_s,
                                 struct neph_diag *diag)
{
    char *program = NULL, *libraries = NULL;
    struct neph_shared log;
    enum neph_status status = neph_helper_find(helper, &program, diag);
    if (!status && !(libraries = neph_helper_variable("LD_LIBRARY_PATH")))
        status = neph_fail_memory(diag);
    if (!status)
        status = neph_shared_create("neph-helper-log", &log, diag);
    if (!status) {
        argv[0] = program;
        const struct neph_child_params params = {
            .argv = argv,
            .log_path = log.path,
            .environment = (const char *const[]){libraries, NULL},
            .time_limit_s = time_limit_s};
        struct neph_child_result result = {0};
        status = neph_child_run(&params, &result, diag);
        if (status == NEPH_ERR_ENGINE)
            status = neph_helper_explain(helper, &result, &log, diag);
        neph_shared_destroy(&log);
    }
    free(libraries);
    free(program);
    return status;
}
