/* SPDX-License-Identifier: MIT
 *
 * Files and folders: whole or not at all.
 */
#ifndef NEPH_BASE_FILES_H
#define NEPH_BASE_FILES_H

#include "base/arena.h"
#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Open a regular file for reading; never waits. `*fd` is for close(), `*size_bytes` may be NULL.
 * NEPH_ERR_NOT_FOUND: no such file. NEPH_ERR_INPUT: a pipe, a device or the like, which could be
 * waited for for ever and not be read twice. NEPH_ERR_IO: a folder, or anything else. */
enum neph_status neph_file_open(const char *path, int *fd, uint64_t *size_bytes,
                                struct neph_diag *diag);

/* Read a whole file of at most `limit_bytes`. `*data` is NUL-terminated (the NUL is not
 * counted in `*size`) and freed by the caller with free(). Errors as of neph_file_open();
 * NEPH_ERR_INPUT also when it is larger than the limit. */
enum neph_status neph_file_read(const char *path, size_t limit_bytes, char **data, size_t *size,
                                struct neph_diag *diag);

/* Write a file under a temporary name (.neph-*.tmp) in the same folder, fsync it, rename it into
 * place, fsync the folder. On failure, NEPH_ERR_IO, an old file of that name is still whole. */
enum neph_status neph_file_write(const char *path, const void *data, size_t size,
                                 struct neph_diag *diag);

/* For the many files of a folder that nobody knows of yet, and that is put in its place as a whole
 * after neph_file_system_sync(): write one that is not there, and do not wait for the disk. */
enum neph_status neph_file_write_unsynced(const char *path, const void *data, size_t size,
                                          struct neph_diag *diag);

/* Wait until all that was written to the file system of `path` is on the disk. NEPH_ERR_IO. */
enum neph_status neph_file_system_sync(const char *path, struct neph_diag *diag);

/* For writers that need a path or write in pieces: make an empty file (.neph-*.tmp) in the folder
 * of `path`, to be filled and given to neph_file_commit(). `*temporary` is its path, for the caller
 * to unlink() (harmless after the commit) and free(). */
enum neph_status neph_file_temporary(const char *path, char **temporary, struct neph_diag *diag);

/* fsync it, rename it to `path`, fsync the folder: the promise of neph_file_write(). */
enum neph_status neph_file_commit(const char *temporary, const char *path, struct neph_diag *diag);

/* Whether a name (without folder) is that of a file which the functions above have in work. */
bool neph_file_is_temporary(const char *name);

/* Remove from a folder the temporary files of neph_file_write() and neph_file_copy() whose writer
 * was killed; those of a writer at work are locked and stay. Not for folders in which
 * neph_file_temporary() is used: its files are not locked. */
void neph_file_sweep(const char *folder);

/* Copy a file with neph_file_write's promise. */
enum neph_status neph_file_copy(const char *from, const char *to, struct neph_diag *diag);

/* fsync a file, or a folder: the names in it. NEPH_ERR_IO. */
enum neph_status neph_file_sync(const char *path, struct neph_diag *diag);

/* The names in a folder but "." and "..", sorted by their bytes; of the arena. None after an error:
 * NEPH_ERR_IO, also where there is no such folder, NEPH_ERR_MEMORY. */
struct neph_names {
    const char **list;
    int count;
};
enum neph_status neph_dir_list(const char *path, struct neph_arena *arena, struct neph_names *names,
                               struct neph_diag *diag);

/* mkdir -p. */
enum neph_status neph_dir_create(const char *path, struct neph_diag *diag);

/* rm -rf, without following symbolic links. A path that is not there is fine. Paths of dots and
 * slashes alone ("", "/", "..") are refused: NEPH_ERR_INTERNAL. */
enum neph_status neph_dir_remove(const char *path, struct neph_diag *diag);

/* Is there no room left on the file system of `folder`, for somebody who is not root? False also
 * when that cannot be told. */
bool neph_disk_is_full(const char *folder);

/* All follow symbolic links. */
bool neph_path_exists(const char *path);
bool neph_path_is_dir(const char *path);
bool neph_path_is_same(const char *a, const char *b); /* both are there, and are one file */

/* "folder/name" ("name" for the folder "") as a new string for the caller to free; NULL when memory
 * is short. */
char *neph_path_join(const char *folder, const char *name);

/* What lies at `relative` to the folder of the running program, without ".." and links, for the
 * caller to free; NULL when there is nothing. */
char *neph_path_beside_program(const char *relative);

/* printf into a new string for the caller to free; NULL when memory is short. */
char *neph_format(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
