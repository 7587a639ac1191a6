/* SPDX-License-Identifier: MIT
 *
 * Common parts of the fuzz targets. A target is one function of bytes that must return; it reports
 * a violation by abort(). Two programs are built from each:
 *
 *   fuzz_NAME    with clang's libFuzzer, when configured with -DNEPH_FUZZ=ON (preset fuzz);
 *                scripts/fuzz builds them, gives each its share of the time and stores their
 *                findings
 *   replay_NAME  in every build, a test: all files of corpus/NAME.
 *
 * A finding is fixed, and its input, reduced with -minimize_crash=1, is added to the corpus under a
 * name that describes it.
 */
#ifndef NEPH_TESTS_FUZZ_H
#define NEPH_TESTS_FUZZ_H

#include "base/files.h"

#include <fcntl.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The entry point of libFuzzer; returns 0. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* The readers take paths: a folder in memory (in $TMPDIR, if set), common to all inputs of a
 * process and removed at its end, with the input as a file. */
struct fuzz_file {
    char folder[192];
    char path[256];
};

/* Whether this is a search for new inputs, in contrast to a replay of the corpus. */
static inline bool fuzz_is_searching(void)
{
#ifdef NEPH_FUZZ
    return true;
#else
    return false;
#endif
}

static inline void fuzz_require(bool holds, const char *what)
{
    if (holds)
        return;
    fprintf(stderr, "does not hold: %s\n", what);
    abort();
}

static char fuzz_folder[192];

static inline void fuzz_folder_remove(void)
{
    neph_dir_remove(fuzz_folder, NULL);
}

static inline void fuzz_folder_make(void)
{
    const char *parent = getenv("TMPDIR");
    if (fuzz_folder[0])
        return;
    if (!parent || !parent[0])
        parent = neph_path_is_dir("/dev/shm") ? "/dev/shm" : "/tmp";
    snprintf(fuzz_folder, sizeof(fuzz_folder), "%.160s/neph-fuzz-XXXXXX", parent);
    fuzz_require(mkdtemp(fuzz_folder), "a temporary folder can be made");
    atexit(fuzz_folder_remove);
}

static inline struct fuzz_file fuzz_file_make(const char *name, const uint8_t *data, size_t size)
{
    struct fuzz_file file;
    fuzz_folder_make();
    snprintf(file.folder, sizeof(file.folder), "%s", fuzz_folder);
    snprintf(file.path, sizeof(file.path), "%s/%s", file.folder, name);
    const int fd = open(file.path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    fuzz_require(fd >= 0 && write(fd, data, size) == (ssize_t)size, "a file can be written");
    close(fd);
    return file;
}

static inline void fuzz_file_remove(const struct fuzz_file *file)
{
    unlink(file->path);
}

/* A failure has a reason in words and no result; a success has a result. */
static inline void fuzz_require_outcome(enum neph_status status, const struct neph_diag *diag,
                                        const void *result)
{
    fuzz_require(status == NEPH_OK || diag->message[0], "a failure says why");
    fuzz_require((status == NEPH_OK) == (result != NULL), "there is a result after success alone");
    fuzz_require(status != NEPH_ERR_INTERNAL, "a file cannot cause a bug");
}

#endif
