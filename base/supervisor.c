/* SPDX-License-Identifier: MIT
 *
 * The child supervisor. All code here runs in a process forked from a multi-threaded neph, so any
 * lock may be held for ever: only async-signal-safe calls, no allocation, no printf.
 */
#include "base/supervisor.h"

#include "base/clock.h"
#include "base/confine.h"
#include "base/usage.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdbool.h>
#include <string.h>
#include <sys/pidfd.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum {
    CONNECTION_FD = STDERR_FILENO + 1,
    SAMPLE_FIRST_MS = 1, /* interval of memory samples, see peak_memory_bytes() */
    SAMPLE_LAST_MS = 100,
    LIMITS_EVERY_MS = 100, /* interval of limit checks; where a check is slow, */
    LIMITS_PAUSE = 20,     /* the pause after it is this many times its duration */
    EXIT_NOT_STARTED = 127,
};

static const double grace_s = 2.0; /* between SIGTERM and SIGKILL */
static const int64_t memory_noise_bytes = 1 << 20;

/* Not "neph": `killall -9 neph` must not kill the process that ends the program. */
static const char process_name[] = "engine-keeper";

struct keeper {
    const struct neph_supervisor_job *job;
    pid_t pid;                    /* of the program; also its process group */
    int fd;                       /* pidfd */
    bool alone;                   /* neph has died */
    int64_t inherited_peak_bytes; /* neph's high-water mark, which the kernel also counts for the
                                     program */
    int64_t seen_peak_bytes;
    double next_check_s; /* the next check of the limits */
    struct neph_supervisor_report report;
};

/* ---- the program's side of fork() ------------------------------------------------------------ */

/* Sent to the supervisor before execve(). When execve() succeeds, READY was the last message,
 * because the pipe is closed on exec. */
struct start_message {
    enum neph_supervisor_step step;
    int error;
    int64_t peak_memory_bytes; /* of this process, still a copy of neph */
};

static void send_start_message(int fd, enum neph_supervisor_step step, int error)
{
    struct rusage usage = {0};
    getrusage(RUSAGE_SELF, &usage);
    const struct start_message words = {step, error, (int64_t)usage.ru_maxrss * 1024};
    const ssize_t written = write(fd, &words, sizeof(words));
    (void)written; /* atomic below PIPE_BUF; a missing message is read as a failed start */
}

_Noreturn static void report_start_failure(int fd, enum neph_supervisor_step step)
{
    send_start_message(fd, step, errno);
    _exit(EXIT_NOT_STARTED);
}

/* The signals were blocked before the first fork(), so that no handler of neph runs in this
 * process. */
static void restore_signals(void)
{
    const struct sigaction standard = {.sa_handler = SIG_DFL};
    sigaction(SIGINT, &standard, NULL);
    sigaction(SIGTERM, &standard, NULL);
    sigaction(SIGPIPE, &standard, NULL);
    sigaction(SIGXFSZ, &standard, NULL);
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, NULL);
}

/* With a limit on files, a crash writes no core file. The kernel limits the size of a single file
 * only for a confined program: memory that graphics drivers share counts as files. */
static bool limit_files(const struct neph_supervisor_job *job)
{
    const struct rlimit none = {0, 0},
                        one = {(rlim_t)job->limits.folder_bytes, (rlim_t)job->limits.folder_bytes};
    return job->limits.folder_bytes <= 0 ||
           (setrlimit(RLIMIT_CORE, &none) == 0 &&
            (!job->is_confined || setrlimit(RLIMIT_FSIZE, &one) == 0));
}

/* PR_SET_PDEATHSIG comes after all calls that change the rights of the process, which reset it. */
_Noreturn static void become_program(const struct neph_supervisor_job *job, pid_t keeper,
                                     int start_fd)
{
    if (setpgid(0, 0) != 0)
        report_start_failure(start_fd, NEPH_SUPERVISOR_GROUP);
    if (job->folder && chdir(job->folder) != 0)
        report_start_failure(start_fd, NEPH_SUPERVISOR_FOLDER);
    if (job->is_confined && neph_confine(".") == NEPH_CONFINE_FAILED)
        report_start_failure(start_fd, NEPH_SUPERVISOR_CONFINE);
    if (!limit_files(job))
        report_start_failure(start_fd, NEPH_SUPERVISOR_CONFINE);
    if (prctl(PR_SET_PDEATHSIG, SIGKILL) != 0)
        report_start_failure(start_fd, NEPH_SUPERVISOR_DEATH_SIGNAL);
    if (getppid() != keeper) /* the supervisor died before the prctl() above */
        _exit(EXIT_NOT_STARTED);
    restore_signals();
    send_start_message(start_fd, NEPH_SUPERVISOR_READY, 0);
    execve(job->program, job->argv, job->environment);
    report_start_failure(start_fd, NEPH_SUPERVISOR_EXEC);
}

/* ---- starting -------------------------------------------------------------------------------- */

static bool fail_start(struct keeper *keeper, enum neph_supervisor_step step, int error)
{
    keeper->report.step = step;
    keeper->report.error = error;
    return false;
}

/* Set up the descriptors: stdin, stdout, stderr, the connection to neph; all others are closed. All
 * are first duplicated above these numbers: if neph was started with its first three closed, ours
 * may have those numbers. */
static bool set_up_descriptors(const struct neph_supervisor_job *job)
{
    const int input_fd = fcntl(job->input_fd, F_DUPFD_CLOEXEC, CONNECTION_FD);
    const int output_fd = fcntl(job->output_fd, F_DUPFD_CLOEXEC, CONNECTION_FD);
    const int connection_fd = fcntl(job->connection_fd, F_DUPFD_CLOEXEC, CONNECTION_FD + 1);
    return input_fd >= 0 && output_fd >= 0 && connection_fd >= 0 &&
           dup2(input_fd, STDIN_FILENO) >= 0 && dup2(output_fd, STDOUT_FILENO) >= 0 &&
           dup2(output_fd, STDERR_FILENO) >= 0 &&
           dup3(connection_fd, CONNECTION_FD, O_CLOEXEC) >= 0 &&
           close_range(CONNECTION_FD + 1, UINT_MAX, 0) == 0;
}

/* Read the program's messages until execve() closes the pipe; the last one counts. */
static bool await_start(struct keeper *keeper, int start_fd)
{
    struct start_message words = {.step = NEPH_SUPERVISOR_NO_MESSAGE}, next;
    for (;;) {
        const ssize_t got = read(start_fd, &next, sizeof(next));
        if (got < 0 && errno == EINTR)
            continue;
        if (got != (ssize_t)sizeof(next))
            break;
        words = next;
    }
    keeper->inherited_peak_bytes = words.peak_memory_bytes;
    return words.step == NEPH_SUPERVISOR_READY || fail_start(keeper, words.step, words.error);
}

static bool start(struct keeper *keeper)
{
    int words_fds[2];
    if (pipe2(words_fds, O_CLOEXEC) != 0)
        return fail_start(keeper, NEPH_SUPERVISOR_FILES, errno);
    const pid_t self = getpid();
    keeper->pid = fork();
    if (keeper->pid == 0)
        become_program(keeper->job, self, words_fds[1]);
    if (keeper->pid < 0)
        return fail_start(keeper, NEPH_SUPERVISOR_FORK, errno);
    close(words_fds[1]);
    const bool started = await_start(keeper, words_fds[0]);
    close(words_fds[0]);
    if (!started)
        return false;
    keeper->fd = pidfd_open(keeper->pid, 0);
    return keeper->fd >= 0 || fail_start(keeper, NEPH_SUPERVISOR_FILES, errno);
}

/* ---- numbers in /proc ------------------------------------------------------------------------ */

/* Read as much of a file as fits, as a string; false when it cannot be opened. */
static bool read_text(const char *path, char *text, size_t size)
{
    const int fd = open(path, O_RDONLY | O_CLOEXEC);
    if (fd < 0)
        return false;
    const ssize_t got = read(fd, text, size - 1);
    close(fd);
    text[got > 0 ? got : 0] = '\0';
    return true;
}

/* The number after white space; `*text` moves behind it. Negative when there is no number. */
static long long next_number(const char **text)
{
    const char *at = *text + strspn(*text, " \t\n");
    long long number = *at >= '0' && *at <= '9' ? 0 : -1;
    for (; *at >= '0' && *at <= '9'; at++)
        number = 10 * number + (*at - '0');
    *text = at;
    return number;
}

/* "/proc/<pid>/status" */
static void name_status_file(pid_t pid, char path[64])
{
    char digits[16];
    int count = 0;
    for (pid_t rest = pid; rest > 0; rest /= 10)
        digits[count++] = (char)('0' + rest % 10);
    char *at = stpcpy(path, "/proc/");
    while (count > 0)
        *at++ = digits[--count];
    stpcpy(at, "/status");
}

/* Update the high-water mark of the program's own memory, if the kernel reports it. */
static void sample_memory(struct keeper *keeper)
{
    static const char key[] = "\nVmHWM:";
    char path[64], text[4096];
    name_status_file(keeper->pid, path);
    const char *line = read_text(path, text, sizeof(text)) ? strstr(text, key) : NULL;
    if (!line)
        return;
    line += sizeof(key) - 1;
    const int64_t peak_bytes = (int64_t)next_number(&line) * 1024;
    if (peak_bytes > keeper->seen_peak_bytes)
        keeper->seen_peak_bytes = peak_bytes;
}

/* ---- waiting --------------------------------------------------------------------------------- */

/* Wait for at most `timeout_ms`. True when the program or neph has ended. */
static bool wait_for_end(struct keeper *keeper, bool *interrupted, int timeout_ms)
{
    struct pollfd fds[] = {{.fd = keeper->fd, .events = POLLIN},
                           {.fd = CONNECTION_FD, .events = POLLIN}};
    poll(fds, sizeof(fds) / sizeof(fds[0]), timeout_ms);
    if (fds[1].revents != 0) {
        char word;
        const ssize_t got = recv(CONNECTION_FD, &word, sizeof(word), MSG_DONTWAIT);
        keeper->alone = got == 0 || (got < 0 && errno != EAGAIN && errno != EINTR);
        *interrupted |= got > 0;
    }
    return fds[0].revents != 0 || keeper->alone;
}

static int timeout_ms(double deadline_s, int longest_ms)
{
    const double left_ms = ceil(1e3 * (deadline_s - neph_wall_s()));
    return left_ms < 0.0 ? 0 : left_ms < longest_ms ? (int)left_ms : longest_ms;
}

/* Kill the program and its process group, which the program may have left. */
static void kill_program(const struct keeper *keeper)
{
    kill(-keeper->pid, SIGKILL);
    kill(keeper->pid, SIGKILL);
}

/* ---- limits ---------------------------------------------------------------------------------- */

static enum neph_child_excess find_excess(const struct neph_supervisor_job *job)
{
    const struct neph_child_limits *limits = &job->limits;
    struct stat log;
    if (limits->log_bytes > 0 && fstat(STDOUT_FILENO, &log) == 0 && log.st_size > limits->log_bytes)
        return NEPH_EXCESS_LOG;
    if (limits->folder_bytes <= 0 || !job->folder)
        return NEPH_EXCESS_NONE;
    const struct neph_usage usage = neph_usage_measure(job->folder);
    return usage.bytes > limits->folder_bytes ? NEPH_EXCESS_BYTES
           : limits->folder_entries > 0 && usage.entries > limits->folder_entries
               ? NEPH_EXCESS_ENTRIES
           : !usage.is_known ? NEPH_EXCESS_HIDDEN
                             : NEPH_EXCESS_NONE;
}

/* Measure the program's files and output, if the next check is due. */
static void check_limits(struct keeper *keeper)
{
    const double start_s = neph_wall_s();
    if (start_s < keeper->next_check_s)
        return;
    keeper->report.excess = find_excess(keeper->job);
    const double end_s = neph_wall_s();
    keeper->next_check_s = end_s + fmax(1e-3 * LIMITS_EVERY_MS, LIMITS_PAUSE * (end_s - start_s));
}

/* Wait until the program ends; end it at a limit, at an interrupt, or when neph dies. */
static void supervise_program(struct keeper *keeper)
{
    const struct neph_supervisor_job *job = keeper->job;
    enum neph_status *ended_for = &keeper->report.ended_for;
    bool killed = false, interrupted = false;
    double deadline_s = job->time_limit_s > 0.0 ? job->start_s + job->time_limit_s : INFINITY;
    int pause_ms = SAMPLE_FIRST_MS;
    while (!wait_for_end(keeper, &interrupted, timeout_ms(deadline_s, pause_ms))) {
        sample_memory(keeper);
        if (!killed)
            check_limits(keeper);
        pause_ms = pause_ms * 2 < SAMPLE_LAST_MS ? pause_ms * 2 : SAMPLE_LAST_MS;
        const bool overdue = neph_wall_s() >= deadline_s;
        if (keeper->report.excess && !killed) {
            kill_program(keeper);
            killed = true;
            deadline_s = INFINITY;
        } else if (*ended_for == NEPH_OK && !killed && (overdue || interrupted)) {
            *ended_for = overdue ? NEPH_ERR_TIMEOUT : NEPH_ERR_INTERRUPTED;
            kill(-keeper->pid, SIGTERM);
            deadline_s = neph_wall_s() + grace_s;
        } else if (overdue && !killed) {
            kill_program(keeper);
            killed = true;
            deadline_s = INFINITY;
        }
    }
    keeper->report.result.wall_s = neph_wall_s() - job->start_s;
}

/* ---- the end --------------------------------------------------------------------------------- */

static double seconds(struct timeval time)
{
    return (double)time.tv_sec + 1e-6 * (double)time.tv_usec;
}

/* ru_maxrss of the program begins with the memory of neph at the fork: execve() passes the
 * high-water mark of the old image on (exec_mmap() in the kernel's fs/exec.c). Above that value
 * ru_maxrss is exact; below it, the samples of the program's own mark are the measurement. */
static int64_t peak_memory_bytes(const struct keeper *keeper, int64_t reported_bytes)
{
    if (reported_bytes > keeper->inherited_peak_bytes + memory_noise_bytes ||
        keeper->seen_peak_bytes == 0)
        return reported_bytes;
    return keeper->seen_peak_bytes < reported_bytes ? keeper->seen_peak_bytes : reported_bytes;
}

static void add_process_usage(struct keeper *keeper, pid_t pid, int wait_status,
                              const struct rusage *usage)
{
    struct neph_child_result *result = &keeper->report.result;
    int64_t peak_bytes = (int64_t)usage->ru_maxrss * 1024;
    if (pid == keeper->pid) {
        result->exit_code = WIFEXITED(wait_status) ? WEXITSTATUS(wait_status) : 0;
        result->signal = WIFSIGNALED(wait_status) ? WTERMSIG(wait_status) : 0;
        peak_bytes = peak_memory_bytes(keeper, peak_bytes);
    }
    result->cpu_s += seconds(usage->ru_utime) + seconds(usage->ru_stime);
    if (peak_bytes > result->peak_memory_bytes)
        result->peak_memory_bytes = peak_bytes;
}

/* Kill all children of this thread. False when the kernel does not list them. */
static bool kill_children(void)
{
    char text[4096]; /* children that do not fit are in the next round */
    if (!read_text("/proc/thread-self/children", text, sizeof(text)))
        return false;
    const char *rest = text;
    for (long long pid; (pid = next_number(&rest)) > 0 && *rest;)
        kill((pid_t)pid, SIGKILL);
    return true;
}

/* End all descendants of the program, also those that lose their parent by it: as this process is a
 * subreaper, they become its children. Only this process reaps them, so their process numbers are
 * not reused meanwhile. */
static void kill_descendants(struct keeper *keeper)
{
    for (;;) {
        int wait_status = 0;
        struct rusage usage;
        const pid_t pid = wait4(-1, &wait_status, WNOHANG, &usage);
        if (pid > 0)
            add_process_usage(keeper, pid, wait_status, &usage);
        else if (pid < 0 || !kill_children())
            return; /* no child is left, or none can be found */
        else
            waitid(P_ALL, 0, &(siginfo_t){0}, WEXITED | WNOWAIT);
    }
}

static void end_program(struct keeper *keeper)
{
    int wait_status = 0;
    struct rusage usage;
    kill_program(keeper);
    if (wait4(keeper->pid, &wait_status, 0, &usage) == keeper->pid)
        add_process_usage(keeper, keeper->pid, wait_status, &usage);
    kill_descendants(keeper);
}

_Noreturn void neph_supervisor_run(const struct neph_supervisor_job *job)
{
    struct keeper keeper = {.job = job, .fd = -1};
    prctl(PR_SET_NAME, process_name);
    setpgid(0, 0);            /* a signal to neph's whole group must not reach this process */
    signal(SIGCHLD, SIG_DFL); /* when ignored, exit codes would be lost */
    if (!set_up_descriptors(job))
        fail_start(&keeper, NEPH_SUPERVISOR_FILES, errno);
    else if (prctl(PR_SET_CHILD_SUBREAPER, 1) != 0)
        fail_start(&keeper, NEPH_SUPERVISOR_DEATH_SIGNAL, errno);
    else if (start(&keeper))
        supervise_program(&keeper);
    if (keeper.pid > 0)
        end_program(&keeper);
    if (keeper.report.step == NEPH_SUPERVISOR_READY && !keeper.report.excess && !keeper.alone)
        keeper.report.excess = find_excess(job);
    send(CONNECTION_FD, &keeper.report, sizeof(keeper.report), MSG_NOSIGNAL);
    _exit(0);
}
