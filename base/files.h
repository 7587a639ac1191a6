/* SPDX-License-Identifier: MIT
 *
 * Files and folders: whole or not at all.
 */
#ifndef NEPH_BASE_FILES_H
#define NEPH_BASE_FILES_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>

/* Read a whole file of at most `limit_bytes`. `*data` is NUL-terminated (the NUL is not counted in
 * `*size`) and freed by the caller with free(). */
enum neph_status neph_file_read(const char *path, size_t limit_bytes, char **data, size_t *size,
                                struct neph_diag *diag);

/* Write a file under a temporary name in the same folder, fsync it, rename it into place. */
enum neph_status neph_file_write(const char *path, const void *data, size_t size,
                                 struct neph_diag *diag);

/* Copy a file with neph_file_write's promise. */
enum neph_status neph_file_copy(const char *from, const char *to, struct neph_diag *diag);

/* mkdir -p. */
enum neph_status neph_dir_create(const char *path, struct neph_diag *diag);

/* rm -rf, without following symbolic links. A path that is not there is fine. */
enum neph_status neph_dir_remove(const char *path, struct neph_diag *diag);

bool neph_path_exists(const char *path);
bool neph_path_is_dir(const char *path);

/* "folder/name" as a new string for the caller to free; NULL when memory is short. */
char *neph_path_join(const char *folder, const char *name);

/* printf into a new string for the caller to free; NULL when memory is short. */
char *neph_format(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
