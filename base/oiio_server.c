/* SPDX-License-Identifier: MIT */
#include "base/oiio_server.h"

#include "base/child_result.h"
#include "base/interrupt.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/pidfd.h>
#include <sys/wait.h>
#include <unistd.h>

enum { INTERRUPT_POLL_MS = 100 };

static const struct neph_helper helper = {
    .name = "neph-image",
    .variable = "NEPH_IMAGE",
    .built = NEPH_IMAGE_PROGRAM,
    .library = "OpenImageIO",
    .reads = "TIFF, HDR, PFM, PPM, JPEG, WebP and DPX",
    .missing = "install OpenImageIO and build neph again: sudo apt-get install libopenimageio-dev; "
               "or convert the file to EXR or PNG",
};

struct neph_oiio_server {
    pthread_mutex_t lock;
    /* The rest is guarded by the lock. */
    pid_t pid;       /* 0: none was started */
    int pid_fd;      /* these three while there is a process */
    int requests[2]; /* its end of the pipe is kept, so that a dead reader sends no SIGPIPE */
    struct neph_shared log; /* its own stderr */
};

bool neph_oiio_is_available(void)
{
    char *program = NULL;
    const bool is_there = neph_helper_find(&helper, &program, NULL) == NEPH_OK;
    free(program);
    return is_there;
}

enum neph_status neph_oiio_server_create(struct neph_oiio_server **server, struct neph_diag *diag)
{
    struct neph_oiio_server *made = calloc(1, sizeof(*made));
    if (!made)
        return neph_fail_memory(diag);
    pthread_mutex_init(&made->lock, NULL);
    *server = made;
    return NEPH_OK;
}

/* ---- the process ----------------------------------------------------------------------------- */

static void close_pipe(const int ends[2])
{
    close(ends[0]);
    close(ends[1]);
}

/* Free what belongs to the process, which has been waited for. */
static void forget(struct neph_oiio_server *server)
{
    close(server->pid_fd);
    close_pipe(server->requests);
    neph_shared_destroy(&server->log);
    server->pid = 0;
}

void neph_oiio_server_destroy(struct neph_oiio_server *server)
{
    if (!server)
        return;
    if (server->pid > 0) {
        kill(server->pid, SIGKILL);
        while (waitpid(server->pid, NULL, 0) < 0 && errno == EINTR)
            continue;
        forget(server);
    }
    pthread_mutex_destroy(&server->lock);
    free(server);
}

/* Its stdin, stdout and stderr; all other descriptors are closed. */
static int set_descriptors(const struct neph_oiio_server *server,
                           posix_spawn_file_actions_t *actions)
{
    int error = posix_spawn_file_actions_adddup2(actions, server->requests[0], STDIN_FILENO);
    if (!error)
        error = posix_spawn_file_actions_adddup2(actions, server->log.fd, STDERR_FILENO);
    if (!error)
        error = posix_spawn_file_actions_addopen(actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    return error ? error : posix_spawn_file_actions_addclosefrom_np(actions, STDERR_FILENO + 1);
}

/* A process group of its own, which Ctrl-C of a terminal does not reach, and no signal that is
 * blocked, handled or ignored. */
static int set_signals(posix_spawnattr_t *attributes)
{
    sigset_t none, all;
    sigemptyset(&none);
    sigfillset(&all);
    posix_spawnattr_setsigmask(attributes, &none);
    posix_spawnattr_setsigdefault(attributes, &all);
    posix_spawnattr_setpgroup(attributes, 0);
    return posix_spawnattr_setflags(attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK |
                                                    POSIX_SPAWN_SETSIGDEF);
}

/* Not neph_child_run(), which waits for the end of the process. */
static int spawn(struct neph_oiio_server *server, char *program, char *const *environment)
{
    char serve[] = "serve", *const argv[] = {program, serve, NULL};
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    posix_spawn_file_actions_init(&actions);
    posix_spawnattr_init(&attributes);
    int error = set_descriptors(server, &actions);
    if (!error)
        error = set_signals(&attributes);
    if (!error)
        error = posix_spawn(&server->pid, program, &actions, &attributes, argv, environment);
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    return error;
}

/* A descriptor of the same file above stderr: neph may run with its first three closed. */
static int lift(int fd)
{
    const int lifted = fd < 0 ? fd : fcntl(fd, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    if (fd >= 0)
        close(fd);
    return lifted;
}

static enum neph_status start_program(struct neph_oiio_server *server, char *program,
                                      struct neph_diag *diag)
{
    char language[] = "LANG=C.UTF-8", home[] = "HOME=/nonexistent";
    char *path = neph_helper_variable("PATH"), *libraries = neph_helper_variable("LD_LIBRARY_PATH");
    char *const environment[] = {language, home, path, libraries, NULL};
    int error = path && libraries ? 0 : ENOMEM;
    if (!error && pipe2(server->requests, O_CLOEXEC) != 0)
        error = errno;
    else if (!error) {
        server->requests[0] = lift(server->requests[0]);
        error = spawn(server, program, environment);
        if (error)
            close_pipe(server->requests);
    }
    free(path);
    free(libraries);
    return error ? neph_fail(diag, error == ENOMEM ? NEPH_ERR_MEMORY : NEPH_ERR_UNAVAILABLE,
                             "cannot start '%s': %s", program, strerror(error))
                 : NEPH_OK;
}

/* Called with the lock. */
static enum neph_status start(struct neph_oiio_server *server, struct neph_diag *diag)
{
    char *program = NULL;
    enum neph_status status = neph_helper_find(&helper, &program, diag);
    if (status)
        return status;
    status = neph_shared_create("neph-image-log", &server->log, diag);
    server->log.fd = status ? -1 : lift(server->log.fd);
    if (!status)
        status = start_program(server, program, diag);
    if (!status)
        server->pid_fd = pidfd_open(server->pid, 0);
    else
        neph_shared_destroy(&server->log);
    free(program);
    return status;
}

/* ---- a file ---------------------------------------------------------------------------------- */

/* What belongs to one file. */
struct reading {
    struct neph_oiio_request request;
    struct neph_shared log;
    int answer[2];
    int pid_fd; /* of the process that has the request */
};

/* Whether the process has ended; then it is forgotten. Called with the lock. */
static bool has_ended(struct neph_oiio_server *server, struct neph_child_result *result)
{
    int end = 0;
    if (waitpid(server->pid, &end, WNOHANG) == 0)
        return false;
    result->exit_code = WEXITSTATUS(end);
    result->signal = WIFSIGNALED(end) ? WTERMSIG(end) : 0;
    return true;
}

/* Called with the lock, so that a request is in one piece. The pipe has room: the process reads
 * each request at once. */
static enum neph_status send_request(struct neph_oiio_server *server, struct reading *reading,
                                     struct neph_diag *diag)
{
    struct neph_child_result result;
    if (server->pid > 0 && has_ended(server, &result))
        forget(server);
    if (server->pid == 0) {
        const enum neph_status status = start(server, diag);
        if (status)
            return status;
    }
    const char *from = (const char *)&reading->request;
    for (size_t sent = 0; sent < sizeof(reading->request);) {
        const ssize_t got = write(server->requests[1], from + sent,
                                  sizeof(reading->request) - sent);
        if (got < 0 && errno != EINTR)
            return neph_fail(diag, NEPH_ERR_IO, "cannot write to neph-image: %s", strerror(errno));
        sent += got > 0 ? (size_t)got : 0;
    }
    reading->pid_fd = fcntl(server->pid_fd, F_DUPFD_CLOEXEC, 0);
    return reading->pid_fd >= 0 ? NEPH_OK
                                : neph_fail(diag, NEPH_ERR_IO, "pidfd: %s", strerror(errno));
}

static enum neph_status explain_death(struct neph_oiio_server *server, struct neph_diag *diag)
{
    struct neph_child_result result = {.signal = SIGKILL};
    enum neph_status status = NEPH_ERR_UNAVAILABLE;
    pthread_mutex_lock(&server->lock);
    const bool is_known = server->pid > 0 && has_ended(server, &result);
    if (is_known && result.signal == 0)
        status = neph_helper_explain(&helper, &result, &server->log, diag);
    else
        neph_fail(diag, status, "neph-image was ended (signal %d) while it read the file",
                  result.signal);
    if (is_known)
        forget(server);
    pthread_mutex_unlock(&server->lock);
    return status;
}

/* Wait for the answer, an interrupt of neph, or the end of the process. */
static enum neph_status await_answer(struct neph_oiio_server *server, const struct reading *reading,
                                     struct neph_oiio_answer *answer, struct neph_diag *diag)
{
    bool by_clock = false; /* an interrupt that was acknowledged stays readable */
    for (;;) {
        struct pollfd fds[] = {
            {.fd = reading->answer[0], .events = POLLIN},
            {.fd = reading->pid_fd, .events = POLLIN},
            {.fd = by_clock ? -1 : neph_interrupt_fd(), .events = POLLIN},
        };
        poll(fds, sizeof(fds) / sizeof(fds[0]), by_clock ? INTERRUPT_POLL_MS : -1);
        if (fds[0].revents & POLLIN)
            return read(reading->answer[0], answer, sizeof(*answer)) == (ssize_t)sizeof(*answer)
                       ? NEPH_OK
                       : neph_fail(diag, NEPH_ERR_IO, "neph-image gave no answer");
        if (fds[1].revents)
            return explain_death(server, diag);
        by_clock |= fds[2].revents != 0;
        if (neph_interrupted())
            return neph_fail(diag, NEPH_ERR_INTERRUPTED, "reading was stopped by an interrupt");
    }
}

static enum neph_status judge(const struct neph_oiio_answer *answer, const struct reading *reading,
                              struct neph_diag *diag)
{
    const struct neph_child_result result = {
        .exit_code = answer->exit_code, .signal = answer->signal, .cpu_s = answer->cpu_s};
    if (result.signal == SIGALRM)
        return neph_fail(diag, NEPH_ERR_TIMEOUT, "%s did not end within %u s", helper.library,
                         reading->request.wall_limit_s);
    return result.signal || result.exit_code
               ? neph_helper_explain(&helper, &result, &reading->log, diag)
               : NEPH_OK;
}

static enum neph_status read_with(struct neph_oiio_server *server, struct reading *reading,
                                  struct neph_diag *diag)
{
    struct neph_oiio_answer answer;
    pthread_mutex_lock(&server->lock);
    enum neph_status status = send_request(server, reading, diag);
    pthread_mutex_unlock(&server->lock);
    if (status)
        return status;
    status = await_answer(server, reading, &answer, diag);
    close(reading->pid_fd);
    return status ? status : judge(&answer, reading, diag);
}

enum neph_status neph_oiio_server_read(struct neph_oiio_server *server,
                                       const struct neph_oiio_request *request,
                                       const struct neph_shared *stream, struct neph_diag *diag)
{
    struct reading reading = {.request = *request};
    enum neph_status status = neph_shared_create("neph-image-log", &reading.log, diag);
    if (status)
        return status;
    if (pipe2(reading.answer, O_CLOEXEC) != 0) {
        status = neph_fail(diag, NEPH_ERR_IO, "pipe2: %s", strerror(errno));
    } else {
        reading.request.magic = NEPH_OIIO_MAGIC;
        reading.request.process = getpid();
        reading.request.stream_fd = stream->fd;
        reading.request.log_fd = reading.log.fd;
        reading.request.answer_fd = reading.answer[1];
        status = read_with(server, &reading, diag);
        close_pipe(reading.answer);
    }
    neph_shared_destroy(&reading.log);
    return status;
}
