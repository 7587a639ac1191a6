/* SPDX-License-Identifier: MIT
 *
 * Helper programs of neph: each runs a library that trusts its files in a process of its own, with
 * limits on memory and time. A helper writes its result into memory that neph has made, and ends
 * with an exit code of sysexits(3); EX_DATAERR is the fault of the file. The last line of its
 * stderr is the reason, followed after a tab by the way out, if there is one.
 */
#ifndef NEPH_BASE_HELPER_H
#define NEPH_BASE_HELPER_H

#include "base/child_result.h"
#include "base/status.h"

#include <stddef.h>

enum { NEPH_HELPER_ARGUMENTS_MAX = 16 };

struct neph_helper {
    const char *name;     /* of the program: "neph-vdb" */
    const char *variable; /* of the environment, with a path to it: "NEPH_VDB" */
    const char *built;    /* its path in the build folder; "": it was not built */
    const char *library;  /* "OpenVDB" */
    const char *reads;    /* "OpenVDB files" */
    const char *missing;  /* the way out where there is no such program */
};

/* The path of a helper: that of its variable, else beside the running program, else where it was
 * built. The caller frees it. NEPH_ERR_UNAVAILABLE: there is no such program. */
enum neph_status neph_helper_find(const struct neph_helper *helper, char **program,
                                  struct neph_diag *diag);

/* Run a helper with these arguments and wait for its end; argv[0] is filled in, the last argument
 * is NULL. NEPH_ERR_INPUT: the helper refuses the file, crashes on it, or does not end in the time
 * that it has given itself. NEPH_ERR_UNAVAILABLE: there is no such program, or it does not start.
 * */
enum neph_status neph_helper_run(const struct neph_helper *helper,
                                 const char *argv[NEPH_HELPER_ARGUMENTS_MAX], double time_limit_s,
                                 struct neph_diag *diag);

/* Anonymous memory that a helper opens by its path. */
struct neph_shared {
    int fd;
    char path[64];
};

enum neph_status neph_shared_create(const char *name, struct neph_shared *shared,
                                    struct neph_diag *diag);

/* Map all of the memory for reading; NULL and 0 if it is empty. To be unmapped by munmap(2). */
enum neph_status neph_shared_map(const struct neph_shared *shared, const void **bytes, size_t *size,
                                 struct neph_diag *diag);

void neph_shared_destroy(struct neph_shared *shared);

/* The error of a helper that ended with an exit code other than 0 or by a signal; `log` is its
 * stderr. */
enum neph_status neph_helper_explain(const struct neph_helper *helper,
                                     const struct neph_child_result *result,
                                     const struct neph_shared *log, struct neph_diag *diag);

/* "NAME=value" of this process, for the environment of a helper: LD_LIBRARY_PATH, so that it finds
 * the same libraries. The caller frees it. NULL: memory is short. */
char *neph_helper_variable(const char *name);

#endif
