/* SPDX-License-Identifier: MIT
 *
 * Files and folders. Files are written completely or not at all.
 */
#ifndef NEPH_BASE_FILES_H
#define NEPH_BASE_FILES_H

#include "base/arena.h"
#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Open a regular file for reading; never blocks. The caller closes `*fd`; `*size_bytes` may be
 * NULL. NEPH_ERR_NOT_FOUND: no such file. NEPH_ERR_INPUT: a pipe, a device or the like, which could
 * block for ever and cannot be read twice. NEPH_ERR_IO: a folder, or any other failure. */
enum neph_status neph_file_open(const char *path, int *fd, uint64_t *size_bytes,
                                struct neph_diag *diag);

/* Read a whole file of at most `limit_bytes`. `*data` is NUL-terminated (the NUL is not counted in
 * `*size`) and freed by the caller with free(). Errors as of neph_file_open(); NEPH_ERR_INPUT also
 * when the file is larger than the limit. */
enum neph_status neph_file_read(const char *path, size_t limit_bytes, char **data, size_t *size,
                                struct neph_diag *diag);

/* Write a file under a temporary name (.neph-*.tmp) in the same folder, fsync it, rename it to
 * `path`, fsync the folder. On failure, NEPH_ERR_IO, an existing file of that name is unchanged. */
enum neph_status neph_file_write(const char *path, const void *data, size_t size,
                                 struct neph_diag *diag);

/* Create a file without waiting for the disk. For folders with many files that are not visible to
 * others yet: the writer calls neph_file_system_sync() once and then renames the whole folder. */
enum neph_status neph_file_write_unsynced(const char *path, const void *data, size_t size,
                                          struct neph_diag *diag);

/* Wait until all writes to the file system of `path` are on the disk. NEPH_ERR_IO. */
enum neph_status neph_file_system_sync(const char *path, struct neph_diag *diag);

/* For writers that need a path, or that write in pieces: create an empty file (.neph-*.tmp) in the
 * folder of `path`. The caller fills it and passes it to neph_file_commit(). `*temporary` is its
 * path, for the caller to unlink() (harmless after the commit) and free(). */
enum neph_status neph_file_temporary(const char *path, char **temporary, struct neph_diag *diag);

/* fsync the file, rename it to `path`, fsync the folder: the same guarantee as neph_file_write().
 */
enum neph_status neph_file_commit(const char *temporary, const char *path, struct neph_diag *diag);

/* Whether a file name (without folder) has the form of the temporary names above. */
bool neph_file_is_temporary(const char *name);

/* Remove from a folder the temporary files of neph_file_write() and neph_file_copy() whose writer
 * was killed. Files of a running writer are locked and stay. Not for folders in which
 * neph_file_temporary() is used: its files are not locked. */
void neph_file_sweep(const char *folder);

/* Copy a file, with the guarantee of neph_file_write(). */
enum neph_status neph_file_copy(const char *from, const char *to, struct neph_diag *diag);

/* fsync a file, or the names in a folder. NEPH_ERR_IO. */
enum neph_status neph_file_sync(const char *path, struct neph_diag *diag);

/* The names in a folder without "." and "..", sorted by bytes; the arena owns them. Empty after an
 * error: NEPH_ERR_IO, also for a folder that does not exist, NEPH_ERR_MEMORY. */
struct neph_names {
    const char **list;
    int count;
};
enum neph_status neph_dir_list(const char *path, struct neph_arena *arena, struct neph_names *names,
                               struct neph_diag *diag);

/* mkdir -p. */
enum neph_status neph_dir_create(const char *path, struct neph_diag *diag);

/* rm -rf, without following symbolic links. A missing path is fine. Paths that consist only of dots
 * and slashes ("", "/", "..") are refused: NEPH_ERR_INTERNAL. */
enum neph_status neph_dir_remove(const char *path, struct neph_diag *diag);

/* Whether an ordinary user (not root) can write no more to the file system of `folder`. False also
 * when that is unknown. */
bool neph_disk_is_full(const char *folder);

/* These three follow symbolic links. */
bool neph_path_exists(const char *path);
bool neph_path_is_dir(const char *path);
bool neph_path_is_same(const char *a, const char *b); /* both exist and are the same file */

/* "folder/name" ("name" for the folder "") as a new string for the caller to free; NULL when memory
 * is short. */
char *neph_path_join(const char *folder, const char *name);

/* The path `relative` to the folder of the running program, without ".." and links, for the caller
 * to free; NULL when nothing exists there. */
char *neph_path_beside_program(const char *relative);

/* printf into a new string for the caller to free; NULL when memory is short. */
char *neph_format(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
