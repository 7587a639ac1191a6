/* SPDX-License-Identifier: MIT
 *
 * JUnit's XML, which GitLab, Jenkins and most other CI systems read: a suite of test cases, each
 * passed, failed or skipped.
 */
#ifndef NEPH_HARNESS_DOCUMENT_JUNIT_H
#define NEPH_HARNESS_DOCUMENT_JUNIT_H

#include "base/arena.h"

enum neph_junit_result {
    NEPH_JUNIT_PASSED,
    NEPH_JUNIT_FAILED,
    NEPH_JUNIT_SKIPPED,
    NEPH_JUNIT_RESULT_COUNT,
};

struct neph_junit_case;

/* Set `name` ("neph compare") and `seconds`; all other members start as 0. Free with
 * neph_junit_finish(). Texts are copied. */
struct neph_junit {
    const char *name; /* borrowed */
    double seconds;   /* duration of the whole run */
    struct neph_arena arena;
    struct neph_junit_case *cases; /* owned by the arena, in the order of the calls */
    int count, room;
};

/* Append a case. CI systems group cases by `group`, and recognise a case of an earlier run by
 * `group` and `name`. `message` is the reason of a failure or a skip; a passed case has none. */
void neph_junit_add(struct neph_junit *junit, const char *group, const char *name,
                    enum neph_junit_result result, const char *message);

/* Attach a line of a file to the last case. CI systems show the case there if the path is relative
 * to the repository; an absolute path is left out. */
void neph_junit_set_location(struct neph_junit *junit, const char *file, int line);

/* Write the file. NEPH_ERR_MEMORY: memory was short here or in neph_junit_add(); errors of
 * neph_file_write(). */
enum neph_status neph_junit_write(const struct neph_junit *junit, const char *path,
                                  struct neph_diag *diag);

void neph_junit_finish(struct neph_junit *junit);

#endif
