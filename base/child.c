/* SPDX-License-Identifier: MIT
 *
 * fork() and not posix_spawn(), because the child has to ask the kernel to die with us
 * (PR_SET_PDEATHSIG) before it becomes the program. Between fork() and execve() it makes only
 * async-signal-safe calls: other threads of neph may have held any lock.
 */
#include "base/child.h"

#include "base/clock.h"
#include "base/files.h"
#include "base/interrupt.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/pidfd.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <linux/close_range.h>

enum {
    QUOTE_BYTES = 640, /* of the end of the log, so that it fits into a diag */
    QUOTE_LINES = 8,
    SAMPLE_FIRST_MS = 1, /* of the memory high-water mark, see peak_memory_bytes() */
    SAMPLE_LAST_MS = 100,
    EXIT_NOT_STARTED = 127,
};

static const double grace_s = 2.0; /* between SIGTERM and SIGKILL */
static const int64_t memory_noise_bytes = 1 << 20;

/* ---- finding the program --------------------------------------------------------------------- */

static bool is_executable(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0 && S_ISREG(info.st_mode) && access(path, X_OK) == 0;
}

/* The program in one folder of PATH, an empty one meaning the current folder; NULL: not there. */
static char *program_in(const char *folder, int length, const char *program)
{
    char *path = length > 0 ? neph_format("%.*s/%s", length, folder, program)
                            : neph_format("./%s", program);
    if (path && is_executable(path))
        return path;
    free(path);
    return NULL;
}

/* The path of a program for the caller to free; NULL when there is none. */
static char *find_program(const char *program)
{
    if (strchr(program, '/'))
        return is_executable(program) ? strdup(program) : NULL;
    const char *folders = getenv("PATH");
    if (!folders)
        folders = "/usr/local/bin:/usr/bin:/bin";
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
    char *path = find_program(program);
    free(path);
    return path != NULL;
}

/* A relative path means neph's working folder, not the one that the child is about to enter. */
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

/* ---- the child's side of fork() -------------------------------------------------------------- */

enum step {
    STEP_READY, /* everything is set, execve() is next */
    STEP_DEATH_SIGNAL,
    STEP_GROUP,
    STEP_FOLDER,
    STEP_FILES,
    STEP_EXEC,
};

/* What the child tells before it becomes the program. When execve() succeeds, STEP_READY was the
 * last report, because the pipe closes itself. */
struct report {
    enum step step;
    int error;                 /* errno of the step that failed */
    int64_t peak_memory_bytes; /* of the copy of neph that it still is */
};

struct launch {
    const char *program;
    char *const *argv;
    char *const *environment;
    const char *folder;
    int input_fd, output_fd, report_fd;
    pid_t parent;
};

static void send_report(const struct launch *launch, enum step step, int error)
{
    struct rusage usage = {0};
    getrusage(RUSAGE_SELF, &usage);
    struct report report = {step, error, (int64_t)usage.ru_maxrss * 1024};
    ssize_t written = write(launch->report_fd, &report, sizeof(report));
    (void)written; /* below PIPE_BUF it is all or nothing; nothing reads as a failed start */
}

_Noreturn static void give_up(const struct launch *launch, enum step step)
{
    send_report(launch, step, errno);
    _exit(EXIT_NOT_STARTED);
}

/* fork() was called with all signals blocked, so that none of neph's handlers runs in here. */
static void restore_signals(void)
{
    struct sigaction standard = {.sa_handler = SIG_DFL};
    sigaction(SIGINT, &standard, NULL);
    sigaction(SIGTERM, &standard, NULL);
    sigaction(SIGPIPE, &standard, NULL);
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, NULL);
}

_Noreturn static void become_program(const struct launch *launch)
{
    if (prctl(PR_SET_PDEATHSIG, SIGKILL) != 0)
        give_up(launch, STEP_DEATH_SIGNAL);
    if (getppid() != launch->parent) /* neph died before the line above */
        _exit(EXIT_NOT_STARTED);
    if (setpgid(0, 0) != 0)
        give_up(launch, STEP_GROUP);
    if (launch->folder && chdir(launch->folder) != 0)
        give_up(launch, STEP_FOLDER);
    if (dup2(launch->input_fd, STDIN_FILENO) < 0 || dup2(launch->output_fd, STDOUT_FILENO) < 0 ||
        dup2(launch->output_fd, STDERR_FILENO) < 0)
        give_up(launch, STEP_FILES);
    close_range(STDERR_FILENO + 1, UINT_MAX, CLOSE_RANGE_CLOEXEC); /* whatever libraries left */
    restore_signals();
    send_report(launch, STEP_READY, 0);
    execve(launch->program, launch->argv, launch->environment);
    give_up(launch, STEP_EXEC);
}

/* ---- starting -------------------------------------------------------------------------------- */

struct child {
    pid_t pid; /* also its process group */
    int fd;    /* pidfd */
    double start_s;
    int64_t inherited_peak_bytes; /* of neph, which the kernel counts as the child's */
    int64_t seen_peak_bytes;
};

static enum neph_status fail_start(const char *program, const char *what, int error,
                                   struct neph_diag *diag)
{
    return neph_fail(diag, error == ENOMEM ? NEPH_ERR_MEMORY : NEPH_ERR_IO,
                     "cannot start '%s': %s: %s", program, what, strerror(error));
}

static enum neph_status explain_report(const struct neph_child_params *params,
                                       const struct report *report, struct neph_diag *diag)
{
    const char *program = params->argv[0];
    switch (report->step) {
    case STEP_DEATH_SIGNAL:
        return fail_start(program, "prctl", report->error, diag);
    case STEP_GROUP:
        return fail_start(program, "setpgid", report->error, diag);
    case STEP_FOLDER:
        return fail_start(program, params->working_directory, report->error, diag);
    case STEP_FILES:
        return fail_start(program, "dup2", report->error, diag);
    case STEP_EXEC:
        return neph_fail(diag, NEPH_ERR_UNAVAILABLE, "cannot run '%s': %s", program,
                         strerror(report->error));
    case STEP_READY:
        break;
    }
    return NEPH_OK;
}

/* Read reports until execve() closes the pipe; the last one counts. */
static enum neph_status await_start(int report_fd, const struct neph_child_params *params,
                                    struct child *child, struct neph_diag *diag)
{
    bool heard = false;
    struct report report = {0}, next;
    for (;;) {
        ssize_t got = read(report_fd, &next, sizeof(next));
        if (got < 0 && errno == EINTR)
            continue;
        if (got != (ssize_t)sizeof(next))
            break;
        report = next;
        heard = true;
    }
    if (!heard)
        return neph_fail(diag, NEPH_ERR_ENGINE, "'%s' was killed before it started",
                         params->argv[0]);
    child->inherited_peak_bytes = report.peak_memory_bytes;
    return explain_report(params, &report, diag);
}

static pid_t fork_without_signals(void)
{
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    pid_t pid = fork();
    if (pid != 0)
        pthread_sigmask(SIG_SETMASK, &before, NULL);
    return pid;
}

/* Open what the child will have as stdin, stdout and stderr. */
static enum neph_status open_files(const struct neph_child_params *params, struct launch *launch,
                                   struct neph_diag *diag)
{
    /* Not neph's stdin: a child in the background of a terminal would be stopped on reading it. */
    launch->input_fd = open("/dev/null", O_RDONLY | O_CLOEXEC);
    if (launch->input_fd < 0)
        return fail_start(params->argv[0], "/dev/null", errno, diag);
    const char *output = params->log_path ? params->log_path : "/dev/null";
    launch->output_fd = open(output, O_WRONLY | O_CREAT | O_TRUNC | O_APPEND | O_CLOEXEC, 0666);
    if (launch->output_fd < 0)
        return neph_fail(diag, NEPH_ERR_IO, "cannot write '%s': %s", output, strerror(errno));
    return NEPH_OK;
}

static void close_if_open(int *fd)
{
    if (*fd >= 0)
        close(*fd);
    *fd = -1;
}

/* fork() and wait until the program runs. On failure nothing is left behind. */
static enum neph_status fork_and_exec(const struct neph_child_params *params, struct launch *launch,
                                      struct child *child, struct neph_diag *diag)
{
    int report_fds[2];
    if (pipe2(report_fds, O_CLOEXEC) != 0)
        return fail_start(params->argv[0], "pipe2", errno, diag);
    launch->report_fd = report_fds[1];
    launch->parent = getpid();
    child->start_s = neph_wall_s();
    child->pid = fork_without_signals();
    if (child->pid == 0)
        become_program(launch);

    enum neph_status status = NEPH_OK;
    if (child->pid < 0)
        status = fail_start(params->argv[0], "fork", errno, diag);
    close(report_fds[1]);
    if (!status) {
        status = await_start(report_fds[0], params, child, diag);
        child->fd = status ? -1 : pidfd_open(child->pid, 0);
        if (!status && child->fd < 0) {
            status = fail_start(params->argv[0], "pidfd_open", errno, diag);
            kill(-child->pid, SIGKILL);
        }
        if (status)
            waitpid(child->pid, NULL, 0);
    }
    close(report_fds[0]);
    return status;
}

static enum neph_status start(const struct neph_child_params *params, struct child *child,
                              struct neph_diag *diag)
{
    struct launch launch = {.input_fd = -1, .output_fd = -1};
    enum neph_status status = NEPH_OK;
    char *found = find_program(params->argv[0]);
    if (!found) {
        status = neph_fail(diag, NEPH_ERR_UNAVAILABLE, "there is no program '%s'", params->argv[0]);
        neph_hint(diag, "install it, or add its folder to PATH");
        return status;
    }
    char *program = make_absolute(found);
    if (!program) {
        status = neph_fail_memory(diag);
        goto done;
    }
    launch.program = program;
    launch.folder = params->working_directory;
    /* execve() takes pointers to non-const for historical reasons and changes nothing. */
    launch.argv = (char *const *)params->argv;
    launch.environment = params->environment ? (char *const *)params->environment : environ;
    status = open_files(params, &launch, diag);
    if (!status)
        status = fork_and_exec(params, &launch, child, diag);
done:
    close_if_open(&launch.output_fd);
    close_if_open(&launch.input_fd);
    free(program);
    return status;
}

/* ---- waiting --------------------------------------------------------------------------------- */

/* The high-water mark of the program's own memory so far; 0 when it cannot be told. */
static int64_t sample_peak_bytes(pid_t pid)
{
    char path[64], text[4096];
    snprintf(path, sizeof(path), "/proc/%d/status", (int)pid);
    int fd = open(path, O_RDONLY | O_CLOEXEC);
    if (fd < 0)
        return 0;
    ssize_t got = read(fd, text, sizeof(text) - 1);
    close(fd);
    text[got > 0 ? got : 0] = '\0';
    const char *line = strstr(text, "\nVmHWM:");
    long long peak_kib = 0;
    if (!line || sscanf(line, "\nVmHWM: %lld kB", &peak_kib) != 1)
        return 0;
    return (int64_t)peak_kib * 1024;
}

static void sample_memory(struct child *child)
{
    int64_t peak_bytes = sample_peak_bytes(child->pid);
    if (peak_bytes > child->seen_peak_bytes)
        child->seen_peak_bytes = peak_bytes;
}

/* Wait for at most `timeout_ms`. True when the child has ended. */
static bool wait_for_end(const struct child *child, bool mind_interrupt, int timeout_ms)
{
    struct pollfd fds[] = {
        {.fd = child->fd, .events = POLLIN},
        {.fd = mind_interrupt ? neph_interrupt_fd() : -1, .events = POLLIN},
    };
    poll(fds, sizeof(fds) / sizeof(fds[0]), timeout_ms);
    return fds[0].revents != 0;
}

static int timeout_ms(double deadline_s, int longest_ms)
{
    double left_ms = ceil(1e3 * (deadline_s - neph_wall_s()));
    return left_ms < 0.0 ? 0 : left_ms < longest_ms ? (int)left_ms : longest_ms;
}

/* Wait until the child ends, ending it when it must. The reason for ending it, or NEPH_OK. */
static enum neph_status watch(struct child *child, double time_limit_s)
{
    enum neph_status ended_for = NEPH_OK;
    bool killed = false;
    double deadline_s = time_limit_s > 0.0 ? child->start_s + time_limit_s : INFINITY;
    int pause_ms = SAMPLE_FIRST_MS;
    while (!wait_for_end(child, ended_for == NEPH_OK, timeout_ms(deadline_s, pause_ms))) {
        sample_memory(child);
        pause_ms = pause_ms * 2 < SAMPLE_LAST_MS ? pause_ms * 2 : SAMPLE_LAST_MS;
        bool overdue = neph_wall_s() >= deadline_s;
        if (ended_for == NEPH_OK && (overdue || neph_interrupted())) {
            ended_for = overdue ? NEPH_ERR_TIMEOUT : NEPH_ERR_INTERRUPTED;
            kill(-child->pid, SIGTERM);
            deadline_s = neph_wall_s() + grace_s;
        } else if (overdue && !killed) {
            kill(-child->pid, SIGKILL);
            killed = true;
            deadline_s = INFINITY;
        }
    }
    return ended_for;
}

/* ru_maxrss starts with the memory of neph itself at the fork: execve() hands the high-water mark
 * of the old image on (exec_mmap() in the kernel's fs/exec.c). Above that it is exact; below, the
 * samples of the program's own mark are what has been measured. */
static int64_t peak_memory_bytes(const struct child *child, const struct rusage *usage)
{
    int64_t reported_bytes = (int64_t)usage->ru_maxrss * 1024;
    if (reported_bytes > child->inherited_peak_bytes + memory_noise_bytes ||
        child->seen_peak_bytes == 0)
        return reported_bytes;
    return child->seen_peak_bytes < reported_bytes ? child->seen_peak_bytes : reported_bytes;
}

static double seconds(struct timeval time)
{
    return (double)time.tv_sec + 1e-6 * (double)time.tv_usec;
}

static enum neph_status reap(const struct child *child, struct neph_child_result *result,
                             struct neph_diag *diag)
{
    /* While the leader is not reaped its number is not given away, so the group is still ours. */
    double wall_s = neph_wall_s() - child->start_s;
    kill(-child->pid, SIGKILL);
    int wait_status = 0;
    struct rusage usage;
    pid_t reaped;
    do
        reaped = wait4(child->pid, &wait_status, 0, &usage);
    while (reaped < 0 && errno == EINTR);
    if (reaped < 0)
        return neph_fail(diag, NEPH_ERR_INTERNAL, "wait4: %s", strerror(errno));
    *result = (struct neph_child_result){
        .exit_code = WIFEXITED(wait_status) ? WEXITSTATUS(wait_status) : 0,
        .signal = WIFSIGNALED(wait_status) ? WTERMSIG(wait_status) : 0,
        .wall_s = wall_s,
        .cpu_s = seconds(usage.ru_utime) + seconds(usage.ru_stime),
        .peak_memory_bytes = peak_memory_bytes(child, &usage),
    };
    return NEPH_OK;
}

/* ---- explaining ------------------------------------------------------------------------------ */

/* Progress bars and colours are not for a diag; neph_fail() sees to what is not UTF-8. */
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

/* The start of the last QUOTE_LINES lines that say something. */
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
        start++; /* the rest of a UTF-8 character that was cut, or an empty line */
    return start;
}

/* The end of the log in `quote`, empty when there is none. */
static void quote_log(const char *log_path, char quote[QUOTE_BYTES + 64])
{
    quote[0] = '\0';
    int fd = log_path ? open(log_path, O_RDONLY | O_CLOEXEC) : -1;
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
        snprintf(quote, QUOTE_BYTES + 64, "; its last words:\n%s", lines);
}

static enum neph_status explain_end(const struct neph_child_params *params,
                                    const struct neph_child_result *result,
                                    enum neph_status ended_for, struct neph_diag *diag)
{
    const char *program = params->argv[0];
    if (ended_for == NEPH_ERR_INTERRUPTED)
        return neph_fail(diag, NEPH_ERR_INTERRUPTED, "'%s' was stopped by an interrupt", program);
    if (!ended_for && !result->signal && result->exit_code == 0)
        return NEPH_OK;

    char quote[QUOTE_BYTES + 64];
    quote_log(params->log_path, quote);
    enum neph_status status;
    if (ended_for == NEPH_ERR_TIMEOUT)
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
    struct child child = {.fd = -1};
    enum neph_status status = start(params, &child, diag);
    if (status)
        return status;
    enum neph_status ended_for = watch(&child, params->time_limit_s);
    status = reap(&child, result, diag);
    close(child.fd);
    return status ? status : explain_end(params, result, ended_for, diag);
}
