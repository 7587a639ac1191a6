/* SPDX-License-Identifier: MIT
 *
 * Child processes: the part that runs in neph. fork() and not posix_spawn(), because a supervisor
 * has to be between neph and the program (keeper.h). All allocations and messages are made here,
 * before the fork.
 */
#include "base/child.h"

#include "base/clock.h"
#include "base/files.h"
#include "base/interrupt.h"
#include "base/keeper.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum {
    QUOTE_BYTES = 640, /* of the end of the log, so that it fits into a diag */
    QUOTE_LINES = 8,
    INTERRUPT_LOOK_MS = 100,
};

/* ---- finding the program --------------------------------------------------------------------- */

static bool is_executable(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0 && S_ISREG(info.st_mode) && access(path, X_OK) == 0;
}

/* The program in one folder of PATH; an empty folder means the current one. NULL: not found. */
static char *program_in(const char *folder, int length, const char *program)
{
    char *path = length > 0 ? neph_format("%.*s/%s", length, folder, program)
                            : neph_format("./%s", program);
    if (path && is_executable(path))
        return path;
    free(path);
    return NULL;
}

static const char *program_folders(void)
{
    const char *folders = getenv("PATH");
    return folders ? folders : "/usr/local/bin:/usr/bin:/bin";
}

char *neph_child_find_program(const char *program)
{
    if (strchr(program, '/'))
        return is_executable(program) ? strdup(program) : NULL;
    const char *folders = program_folders();
    while (*program) {
        int length = (int)strcspn(folders, ":");
        char *path = program_in(folders, length, program);
        if (path || folders[length] == '\0')
            return path;
        folders += length + 1;
    }
    return NULL;
}

bool neph_child_program_exists(const char *program)
{
    char *path = neph_child_find_program(program);
    free(path);
    return path != NULL;
}

/* A relative path is relative to neph's working folder, not to the folder that the child enters. */
static char *make_absolute(char *path)
{
    if (!path || path[0] == '/')
        return path;
    char *folder = getcwd(NULL, 0);
    char *absolute = folder ? neph_path_join(folder, path) : NULL;
    free(folder);
    free(path);
    return absolute;
}

/* ---- the environment ------------------------------------------------------------------------- */

/* The child's environment. Of the user's variables it has only PATH, so that no other one changes
 * results. */
struct environment {
    char **entries; /* NULL-terminated */
    size_t count, capacity;
};

static void free_environment(struct environment *environment)
{
    for (size_t i = 0; i < environment->count; i++)
        free(environment->entries[i]);
    free(environment->entries);
}

static bool add_variable(struct environment *environment, char *entry)
{
    if (entry)
        environment->entries[environment->count++] = entry;
    return entry != NULL;
}

static bool add_variables(const struct neph_child_params *params, struct environment *environment)
{
    bool added = add_variable(environment, neph_format("PATH=%s", program_folders())) &&
                 add_variable(environment, strdup("LANG=C.UTF-8"));
    if (params->home) {
        char *home = make_absolute(strdup(params->home));
        added = added && home && add_variable(environment, neph_format("HOME=%s", home)) &&
                add_variable(environment, neph_format("TMPDIR=%s", home));
        free(home);
    } else
        added = added && add_variable(environment, strdup("HOME=/nonexistent"));
    for (const char *const *more = params->environment; added && more && *more; more++)
        added = add_variable(environment, strdup(*more));
    return added;
}

static bool begins_with_one_of(const char *variable, const char *const *names)
{
    for (; *names; names++)
        if (strncmp(variable, *names, strlen(*names)) == 0)
            return true;
    return false;
}

int neph_child_inherit(const char **variables, int room, const char *const *but)
{
    static const char *const made_anew[] = {"PATH=", "LANG=", "HOME=", "TMPDIR=", NULL};
    int count = 0;
    for (char **entry = environ; entry && *entry; entry++) {
        if (begins_with_one_of(*entry, made_anew) || begins_with_one_of(*entry, but))
            continue;
        if (count == room - 1)
            return -1;
        variables[count++] = *entry;
    }
    variables[count] = NULL;
    return count;
}

/* The caller calls free_environment() whatever the status. */
static enum neph_status make_environment(const struct neph_child_params *params,
                                         struct environment *environment, struct neph_diag *diag)
{
    size_t count = 4 + 1; /* PATH, LANG, HOME, TMPDIR; the NULL */
    for (const char *const *more = params->environment; more && *more; more++)
        count++;
    *environment = (struct environment){.entries = calloc(count, sizeof(char *))};
    return environment->entries && add_variables(params, environment) ? NEPH_OK
                                                                      : neph_fail_memory(diag);
}

/* ---- starting -------------------------------------------------------------------------------- */

static enum neph_status fail_start(const char *program, const char *what, int error,
                                   struct neph_diag *diag)
{
    return neph_fail(diag, error == ENOMEM ? NEPH_ERR_MEMORY : NEPH_ERR_IO,
                     "cannot start '%s': %s: %s", program, what, strerror(error));
}

static enum neph_status explain_start(const struct neph_child_params *params,
                                      const struct neph_keeper_report *report,
                                      struct neph_diag *diag)
{
    const char *program = params->argv[0];
    switch (report->step) {
    case NEPH_KEEPER_SILENCE:
        return neph_fail(diag, NEPH_ERR_ENGINE, "'%s' was killed before it started", program);
    case NEPH_KEEPER_DEATH_SIGNAL:
        return fail_start(program, "prctl", report->error, diag);
    case NEPH_KEEPER_GROUP:
        return fail_start(program, "setpgid", report->error, diag);
    case NEPH_KEEPER_FOLDER:
        return fail_start(program, params->working_directory, report->error, diag);
    case NEPH_KEEPER_CONFINE:
        return fail_start(program, "confining it to its folder", report->error, diag);
    case NEPH_KEEPER_FILES:
        return fail_start(program, "its files", report->error, diag);
    case NEPH_KEEPER_FORK:
        return fail_start(program, "fork", report->error, diag);
    case NEPH_KEEPER_EXEC:
        return neph_fail(diag, NEPH_ERR_UNAVAILABLE, "cannot run '%s': %s", program,
                         strerror(report->error));
    case NEPH_KEEPER_READY:
        break;
    }
    return NEPH_OK;
}

/* Open the child's stdin, stdout and stderr. */
static enum neph_status open_files(const struct neph_child_params *params,
                                   struct neph_keeper_job *job, struct neph_diag *diag)
{
    /* Not neph's stdin: a background child that reads from a terminal would be stopped. */
    job->input_fd = open("/dev/null", O_RDONLY | O_CLOEXEC);
    if (job->input_fd < 0)
        return fail_start(params->argv[0], "/dev/null", errno, diag);
    const char *output = params->log_path ? params->log_path : "/dev/null";
    job->output_fd = open(output, O_WRONLY | O_CREAT | O_TRUNC | O_APPEND | O_CLOEXEC, 0666);
    if (job->output_fd < 0)
        return neph_fail(diag, NEPH_ERR_IO, "cannot write '%s': %s", output, strerror(errno));
    return NEPH_OK;
}

static void close_if_open(int *fd)
{
    if (*fd >= 0)
        close(*fd);
    *fd = -1;
}

static pid_t fork_without_signals(void)
{
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    const pid_t pid = fork();
    if (pid != 0)
        pthread_sigmask(SIG_SETMASK, &before, NULL);
    return pid;
}

/* ---- waiting --------------------------------------------------------------------------------- */

/* Wait for the supervisor's report, and send it an interrupt that arrives meanwhile. False when the
 * supervisor died without a report. */
static bool await_report(int talk_fd, struct neph_keeper_report *report)
{
    /* The descriptor of an acknowledged interrupt stays readable; from then on the flag is polled
     * every INTERRUPT_LOOK_MS. */
    bool told = false, by_clock = false;
    for (;;) {
        struct pollfd fds[] = {
            {.fd = talk_fd, .events = POLLIN},
            {.fd = told || by_clock ? -1 : neph_interrupt_fd(), .events = POLLIN},
        };
        poll(fds, sizeof(fds) / sizeof(fds[0]), by_clock ? INTERRUPT_LOOK_MS : -1);
        if (!told && neph_interrupted())
            told = send(talk_fd, "", 1, MSG_NOSIGNAL) == 1;
        else if (fds[1].revents != 0)
            by_clock = true;
        if (fds[0].revents == 0)
            continue;
        const ssize_t got = recv(talk_fd, report, sizeof(*report), 0);
        if (got >= 0 || errno != EINTR)
            return got == (ssize_t)sizeof(*report);
    }
}

/* Run the program under a supervisor until both have ended. */
static enum neph_status run_kept(const struct neph_child_params *params,
                                 struct neph_keeper_job *job, struct neph_keeper_report *report,
                                 struct neph_diag *diag)
{
    int talk_fds[2];
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, talk_fds) != 0)
        return fail_start(params->argv[0], "socketpair", errno, diag);
    job->talk_fd = talk_fds[1];
    job->start_s = neph_wall_s();
    const pid_t keeper = fork_without_signals();
    if (keeper == 0)
        neph_keeper_run(job);
    const int error = errno;
    close(talk_fds[1]);
    enum neph_status status = NEPH_OK;
    if (keeper < 0)
        status = fail_start(params->argv[0], "fork", error, diag);
    else if (!await_report(talk_fds[0], report))
        status = neph_fail(diag, NEPH_ERR_ENGINE,
                           "the supervisor process of '%s' was killed, and with it the program",
                           params->argv[0]);
    close(talk_fds[0]);
    while (keeper > 0 && waitpid(keeper, NULL, 0) < 0 && errno == EINTR)
        continue;
    return status;
}

static enum neph_status run(const struct neph_child_params *params,
                            struct neph_keeper_report *report, struct neph_diag *diag)
{
    struct neph_keeper_job job = {.input_fd = -1, .output_fd = -1};
    struct environment environment = {.entries = NULL};
    enum neph_status status = NEPH_OK;
    char *found = neph_child_find_program(params->argv[0]);
    if (!found) {
        status = neph_fail(diag, NEPH_ERR_UNAVAILABLE, "there is no program '%s'", params->argv[0]);
        neph_hint(diag, "install it, or add its folder to PATH");
        return status;
    }
    char *program = make_absolute(found);
    status = program ? make_environment(params, &environment, diag) : neph_fail_memory(diag);
    job.program = program;
    job.folder = params->working_directory;
    job.is_confined = params->is_confined;
    job.limits = params->limits;
    job.time_limit_s = params->time_limit_s;
    /* execve() takes pointers to non-const for historical reasons and modifies nothing. */
    job.argv = (char *const *)params->argv;
    job.environment = environment.entries;
    if (!status)
        status = open_files(params, &job, diag);
    if (!status)
        status = run_kept(params, &job, report, diag);
    if (!status && report->excess == NEPH_EXCESS_LOG &&
        ftruncate(job.output_fd, params->limits.log_bytes) != 0)
        status = neph_fail(diag, NEPH_ERR_IO, "cannot truncate '%s': %s", params->log_path,
                           strerror(errno));
    close_if_open(&job.output_fd);
    close_if_open(&job.input_fd);
    free_environment(&environment);
    free(program);
    return status;
}

/* ---- error messages -------------------------------------------------------------------------- */

/* Replace control characters of progress bars and colours; neph_fail() escapes invalid UTF-8. */
static void make_printable(char *text, size_t size)
{
    for (char *at = text; at < text + size; at++) {
        unsigned char byte = (unsigned char)*at;
        if (byte == '\r')
            *at = '\n';
        else if ((byte < ' ' && byte != '\n' && byte != '\t') || byte == 0x7f)
            *at = '?';
    }
}

/* The start of the last QUOTE_LINES lines, without blank lines at the end. */
static const char *last_lines(char *text)
{
    size_t length = strlen(text);
    while (length > 0 && strchr(" \t\n", text[length - 1]))
        text[--length] = '\0';
    int line_count = 0;
    while (length > 0 && !(text[length - 1] == '\n' && ++line_count == QUOTE_LINES))
        length--;
    const char *start = text + length;
    while (((unsigned char)*start & 0xc0) == 0x80 || *start == '\n')
        start++; /* the tail of a truncated UTF-8 character, or an empty line */
    return start;
}

/* The end of the log in `quote`; empty when there is no log. */
static void quote_log(const char *log_path, char quote[QUOTE_BYTES + 64])
{
    quote[0] = '\0';
    /* O_NONBLOCK: the child may have replaced the log by a pipe. */
    int fd = log_path ? open(log_path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY) : -1;
    if (fd < 0)
        return;
    char text[QUOTE_BYTES + 1];
    off_t size = lseek(fd, 0, SEEK_END);
    ssize_t got = pread(fd, text, QUOTE_BYTES, size > QUOTE_BYTES ? size - QUOTE_BYTES : 0);
    close(fd);
    const size_t length = got > 0 ? (size_t)got : 0;
    make_printable(text, length);
    text[length] = '\0';
    const char *lines = last_lines(text);
    if (*lines)
        snprintf(quote, QUOTE_BYTES + 64, "; the end of its log:\n%s", lines);
}

static enum neph_status explain_excess(const struct neph_child_params *params,
                                       enum neph_child_excess excess, const char *quote,
                                       struct neph_diag *diag)
{
    const struct neph_child_limits *limits = &params->limits;
    const char *program = params->argv[0];
    switch (excess) {
    case NEPH_EXCESS_NONE:
        break;
    case NEPH_EXCESS_BYTES:
        return neph_fail(diag, NEPH_ERR_ENGINE,
                         "'%s' was stopped: its folder has more than %" PRId64 " MiB%s", program,
                         limits->folder_bytes >> 20, quote);
    case NEPH_EXCESS_ENTRIES:
        return neph_fail(diag, NEPH_ERR_ENGINE,
                         "'%s' was stopped: its folder has more than %" PRId64
                         " files and folders%s",
                         program, limits->folder_entries, quote);
    case NEPH_EXCESS_HIDDEN:
        return neph_fail(diag, NEPH_ERR_ENGINE,
                         "'%s' was stopped: its folder has subfolders that cannot be read, or are "
                         "more than 64 levels deep%s",
                         program, quote);
    case NEPH_EXCESS_LOG:
        return neph_fail(diag, NEPH_ERR_ENGINE,
                         "'%s' was stopped: it printed more than %" PRId64 " MiB%s", program,
                         limits->log_bytes >> 20, quote);
    }
    return NEPH_OK;
}

static enum neph_status explain_end(const struct neph_child_params *params,
                                    const struct neph_child_result *result,
                                    enum neph_status ended_for, enum neph_child_excess excess,
                                    struct neph_diag *diag)
{
    const char *program = params->argv[0];
    if (ended_for == NEPH_ERR_INTERRUPTED)
        return neph_fail(diag, NEPH_ERR_INTERRUPTED, "'%s' was stopped by an interrupt", program);
    if (!ended_for && !excess && !result->signal && result->exit_code == 0)
        return NEPH_OK;

    char quote[QUOTE_BYTES + 64];
    quote_log(params->log_path, quote);
    enum neph_status status;
    if (excess)
        status = explain_excess(params, excess, quote, diag);
    else if (ended_for == NEPH_ERR_TIMEOUT)
        status = neph_fail(diag, NEPH_ERR_TIMEOUT, "'%s' was stopped at its time limit of %g s%s",
                           program, params->time_limit_s, quote);
    else if (result->signal) {
        const char *meaning = sigdescr_np(result->signal);
        status = neph_fail(diag, NEPH_ERR_ENGINE, "'%s' was ended by signal %d (%s)%s", program,
                           result->signal, meaning ? meaning : "unknown", quote);
    } else
        status = neph_fail(diag, NEPH_ERR_ENGINE, "'%s' ended with exit code %d%s", program,
                           result->exit_code, quote);
    if (params->log_path)
        neph_hint(diag, "its whole log is '%s'", params->log_path);
    return status;
}

enum neph_status neph_child_run(const struct neph_child_params *params,
                                struct neph_child_result *result, struct neph_diag *diag)
{
    struct neph_keeper_report report;
    enum neph_status status = run(params, &report, diag);
    if (!status)
        status = explain_start(params, &report, diag);
    if (status)
        return status;
    *result = report.result;
    return explain_end(params, result, report.ended_for, report.excess, diag);
}
