/* SPDX-License-Identifier: MIT
 *
 * Status codes and diagnostics of every function that can fail.
 *
 * Such a function returns `enum neph_status`: the kind of error, which never changes on its way up.
 * The text for the user is in `struct neph_diag`: what happened, where in the user's input, and the
 * way out. Out-parameters are set only on success. A NULL diag is always allowed: only the status
 * is returned then.
 */
#ifndef NEPH_BASE_STATUS_H
#define NEPH_BASE_STATUS_H

#include <stddef.h>

enum neph_status {
    NEPH_OK = 0,
    NEPH_ERR_USAGE,       /* the command line names something that does not exist */
    NEPH_ERR_INPUT,       /* a file of the user has a wrong value */
    NEPH_ERR_NOT_FOUND,   /* a file that the user named does not exist */
    NEPH_ERR_IO,          /* reading or writing failed: disk full, permission, ... */
    NEPH_ERR_MEMORY,      /* an allocation failed */
    NEPH_ERR_UNAVAILABLE, /* an engine, driver or tool is missing or of a wrong version */
    NEPH_ERR_UNSUPPORTED, /* the engine is available but cannot render a feature of the scene */
    NEPH_ERR_ENGINE,      /* an engine ran and failed, or gave an unusable frame */
    NEPH_ERR_TIMEOUT,     /* a child process exceeded its time limit */
    NEPH_ERR_INTERRUPTED, /* Ctrl-C or SIGTERM */
    NEPH_ERR_GATE,        /* a measured number is outside its gate */
    NEPH_ERR_INTERNAL,    /* a bug in neph */
    NEPH_STATUS_COUNT,
};

/* The text of an error for the user. Zero-initialise it; `file` is empty and `line` 0 when there is
 * no position. The functions below escape all bytes that are unfit for terminals or JSON
 * (base/text.h). */
struct neph_diag {
    char message[1024];
    char hint[512];
    char file[512];
    int line;   /* 1-based */
    int column; /* 1-based */
    /* Further errors of the same file, as lines for the user: each with its position, message and
     * hint. Empty when the error above is the only one. */
    char more[8192];
};

/* Fill `diag` (if not NULL) with a formatted message, clear its position, and return `status`:
 * `return neph_fail(diag, NEPH_ERR_IO, "cannot write '%s': %s", path, strerror(errno));` */
enum neph_status neph_fail(struct neph_diag *diag, enum neph_status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Add the way out to a diag that already has a message. */
void neph_hint(struct neph_diag *diag, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Insert words before the message of a diag; hint and position stay: `neph_prefix(diag, "'%s': ",
 * path)`. */
void neph_prefix(struct neph_diag *diag, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Replace the path of a folder that was moved from `from` to `to` in the texts of a diag. NULL as
 * `to`: the folder was removed; a hint that names it is dropped. */
void neph_move_paths(struct neph_diag *diag, const char *from, const char *to);

/* Add the position in the user's input to a diag that already has a message. */
void neph_locate(struct neph_diag *diag, const char *file, int line, int column);

/* Write a diag as lines for the user: position, message, then the hint. Without a position the
 * lines begin with `who`. Returns the length, as snprintf(). */
int neph_diag_format(const struct neph_diag *diag, const char *who, char *text, size_t size);

/* Shorthand for an allocation failure. */
enum neph_status neph_fail_memory(struct neph_diag *diag);

/* A short stable name such as "timeout", for JSON and logs. */
const char *neph_status_name(enum neph_status status);

/* The documented exit code of the command line (sysexits(3) where one fits). */
int neph_status_exit_code(enum neph_status status);

#endif
