/* SPDX-License-Identifier: MIT */
#include "base/files.h"

#include "base/lock.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

enum {
    FIRST_READ_BYTES = 1 << 14,
    COPY_BYTES = 1 << 18,
    TEMPORARY_TRIES = 16, /* a try fails only if a sweep comes between two system calls */
};

static enum neph_status fail_read(const char *path, struct neph_diag *diag)
{
    int error = errno;
    return neph_fail(diag, error == ENOENT ? NEPH_ERR_NOT_FOUND : NEPH_ERR_IO,
                     "cannot read '%s': %s", path, strerror(error));
}

static enum neph_status fail_write(const char *path, struct neph_diag *diag)
{
    return neph_fail(diag, NEPH_ERR_IO, "cannot write '%s': %s", path, strerror(errno));
}

static ssize_t read_some(int fd, void *data, size_t size)
{
    ssize_t got;
    do
        got = read(fd, data, size);
    while (got < 0 && errno == EINTR);
    return got;
}

static bool write_all(int fd, const void *data, size_t size)
{
    const char *rest = data;
    while (size > 0) {
        ssize_t put = write(fd, rest, size);
        if (put < 0 && errno == EINTR)
            continue;
        if (put < 0)
            return false;
        rest += put;
        size -= (size_t)put;
    }
    return true;
}

/* ---- reading --------------------------------------------------------------------------------- */

/* Read to the end of the file, not st_size bytes: st_size is 0 in /proc. */
static enum neph_status read_to_end(int fd, const char *path, size_t limit_bytes, char **data,
                                    size_t *size, struct neph_diag *diag)
{
    size_t capacity = FIRST_READ_BYTES, used = 0;
    struct stat info;
    if (fstat(fd, &info) == 0 && S_ISREG(info.st_mode) && info.st_size > 0 &&
        (uintmax_t)info.st_size <= limit_bytes)
        capacity = (size_t)info.st_size + 2; /* one to detect the end of the file, one for the NUL
                                              */

    char *bytes = NULL;
    for (;;) {
        if (!bytes || used + 1 >= capacity) {
            if (bytes)
                capacity *= 2;
            char *grown = realloc(bytes, capacity);
            if (!grown) {
                free(bytes);
                return neph_fail_memory(diag);
            }
            bytes = grown;
        }
        ssize_t got = read_some(fd, bytes + used, capacity - used - 1);
        if (got < 0) {
            enum neph_status status = fail_read(path, diag);
            free(bytes);
            return status;
        }
        if (got == 0)
            break;
        used += (size_t)got;
        if (used > limit_bytes) {
            free(bytes);
            return neph_fail(diag, NEPH_ERR_INPUT, "'%s' is larger than %zu bytes", path,
                             limit_bytes);
        }
    }
    bytes[used] = '\0';
    *data = bytes;
    *size = used;
    return NEPH_OK;
}

static enum neph_status refuse_kind(const char *path, mode_t mode, struct neph_diag *diag)
{
    if (S_ISDIR(mode)) {
        errno = EISDIR;
        return fail_read(path, diag);
    }
    neph_fail(diag, NEPH_ERR_INPUT, "cannot read '%s': %s is not a regular file", path,
              S_ISFIFO(mode)   ? "a pipe"
              : S_ISSOCK(mode) ? "a socket"
                               : "a device");
    neph_hint(diag, "write it to a file first");
    return NEPH_ERR_INPUT;
}

enum neph_status neph_file_open(const char *path, int *fd, uint64_t *size_bytes,
                                struct neph_diag *diag)
{
    /* O_NONBLOCK: opening a pipe without a writer must not block. */
    const int opened = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    struct stat info;
    if (opened < 0)
        return fail_read(path, diag);
    enum neph_status status = NEPH_OK;
    if (fstat(opened, &info) != 0)
        status = fail_read(path, diag);
    else if (!S_ISREG(info.st_mode))
        status = refuse_kind(path, info.st_mode, diag);
    if (status) {
        close(opened);
        return status;
    }
    if (size_bytes)
        *size_bytes = (uint64_t)info.st_size;
    *fd = opened;
    return NEPH_OK;
}

enum neph_status neph_file_read(const char *path, size_t limit_bytes, char **data, size_t *size,
                                struct neph_diag *diag)
{
    int fd;
    enum neph_status status = neph_file_open(path, &fd, NULL, diag);
    if (status)
        return status;
    status = read_to_end(fd, path, limit_bytes, data, size, diag);
    close(fd);
    return status;
}

/* ---- writing: temporary file, fsync, rename, fsync of the folder ----------------------------- */

struct temporary {
    char *folder;
    char *path; /* exists on disk while fd >= 0 */
    int fd;
};

static char *copy_folder_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    if (!slash)
        return strdup(".");
    return slash == path ? strdup("/") : strndup(path, (size_t)(slash - path));
}

/* A short name, so that a final name of NAME_MAX bytes is possible. Not mkstemp(): its files are
 * readable only by their owner. */
static enum neph_status temporary_try(struct temporary *file, const char *path,
                                      struct neph_diag *diag)
{
    uint64_t tag = 0;
    if (getrandom(&tag, sizeof(tag), 0) != (ssize_t)sizeof(tag))
        return fail_write(path, diag);
    free(file->path);
    file->path = neph_format("%s/.neph-%016" PRIx64 ".tmp", file->folder, tag);
    if (!file->path)
        return neph_fail_memory(diag);
    file->fd = neph_lock_create(file->path); /* the lock tells neph_file_sweep() that the writer is
                                                running */
    return file->fd < 0 ? fail_write(path, diag) : NEPH_OK;
}

static enum neph_status temporary_open(struct temporary *file, const char *path,
                                       struct neph_diag *diag)
{
    *file = (struct temporary){.fd = -1, .folder = copy_folder_name(path)};
    if (!file->folder)
        return neph_fail_memory(diag);
    enum neph_status status = temporary_try(file, path, diag);
    for (int i = 1; status == NEPH_ERR_IO && errno == EEXIST && i < TEMPORARY_TRIES; i++)
        status = temporary_try(file, path, diag);
    return status;
}

bool neph_file_is_temporary(const char *name)
{
    static const char prefix[] = ".neph-";
    if (strncmp(name, prefix, strlen(prefix)) != 0)
        return false;
    const char *tag = name + strlen(prefix);
    return strspn(tag, "0123456789abcdef") == 16 && strcmp(tag + 16, ".tmp") == 0;
}

void neph_file_sweep(const char *folder)
{
    DIR *directory = opendir(folder);
    if (!directory)
        return;
    for (const struct dirent *entry; (entry = readdir(directory));) {
        char *path = neph_file_is_temporary(entry->d_name) ? neph_path_join(folder, entry->d_name)
                                                           : NULL;
        const int fd = path ? neph_lock_take_over(path) : -1;
        if (fd >= 0) {
            unlink(path);
            close(fd);
        }
        free(path);
    }
    closedir(directory);
}

/* Free, and remove the file unless it was committed. */
static void temporary_finish(struct temporary *file)
{
    if (file->fd >= 0) {
        unlink(file->path);
        close(file->fd);
    }
    free(file->path);
    free(file->folder);
}

/* fsync a file or folder. Without it a power failure may undo the rename. */
static bool sync_path(const char *path)
{
    int fd = open(path, O_RDONLY | O_CLOEXEC);
    if (fd < 0)
        return false;
    /* EINVAL: a file system that cannot sync folders (some FUSE and network ones). */
    bool synced = fsync(fd) == 0 || errno == EINVAL;
    int error = errno;
    close(fd);
    errno = error;
    return synced;
}

enum neph_status neph_file_sync(const char *path, struct neph_diag *diag)
{
    return sync_path(path) ? NEPH_OK : fail_write(path, diag);
}

static enum neph_status temporary_commit(struct temporary *file, const char *path,
                                         struct neph_diag *diag)
{
    if (fsync(file->fd) != 0 || rename(file->path, path) != 0)
        return fail_write(path, diag);
    /* NFS and quotas may report a full disk only here. */
    int closed = close(file->fd);
    file->fd = -1;
    if (closed != 0 || !sync_path(file->folder))
        return fail_write(path, diag);
    return NEPH_OK;
}

enum neph_status neph_file_write(const char *path, const void *data, size_t size,
                                 struct neph_diag *diag)
{
    struct temporary file;
    enum neph_status status = temporary_open(&file, path, diag);
    if (!status && !write_all(file.fd, data, size))
        status = fail_write(path, diag);
    if (!status)
        status = temporary_commit(&file, path, diag);
    temporary_finish(&file);
    return status;
}

enum neph_status neph_file_write_unsynced(const char *path, const void *data, size_t size,
                                          struct neph_diag *diag)
{
    const int fd = open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd < 0)
        return fail_write(path, diag);
    const bool written = write_all(fd, data, size);
    const int error = errno;
    const bool closed = close(fd) == 0;
    if (!written)
        errno = error;
    return written && closed ? NEPH_OK : fail_write(path, diag);
}

enum neph_status neph_file_system_sync(const char *path, struct neph_diag *diag)
{
    const int fd = open(path, O_RDONLY | O_CLOEXEC);
    if (fd < 0)
        return fail_write(path, diag);
    const bool synced = syncfs(fd) == 0;
    const int error = errno;
    close(fd);
    errno = error;
    return synced ? NEPH_OK : fail_write(path, diag);
}

enum neph_status neph_file_temporary(const char *path, char **temporary, struct neph_diag *diag)
{
    struct temporary file;
    enum neph_status status = temporary_open(&file, path, diag);
    if (!status) {
        close(file.fd);
        file.fd = -1;
        *temporary = file.path;
        file.path = NULL;
    }
    temporary_finish(&file);
    return status;
}

enum neph_status neph_file_commit(const char *temporary, const char *path, struct neph_diag *diag)
{
    struct temporary file = {.folder = copy_folder_name(path), .path = strdup(temporary), .fd = -1};
    enum neph_status status = file.folder && file.path ? NEPH_OK : neph_fail_memory(diag);
    if (!status && (file.fd = open(temporary, O_RDONLY | O_CLOEXEC)) < 0)
        status = fail_write(path, diag);
    if (!status)
        status = temporary_commit(&file, path, diag);
    temporary_finish(&file);
    return status;
}

static enum neph_status copy_bytes(int from_fd, const char *from, int to_fd, const char *to,
                                   struct neph_diag *diag)
{
    char *buffer = malloc(COPY_BYTES);
    if (!buffer)
        return neph_fail_memory(diag);
    enum neph_status status = NEPH_OK;
    for (;;) {
        ssize_t got = read_some(from_fd, buffer, COPY_BYTES);
        if (got < 0)
            status = fail_read(from, diag);
        else if (got > 0 && !write_all(to_fd, buffer, (size_t)got))
            status = fail_write(to, diag);
        if (got <= 0 || status)
            break;
    }
    free(buffer);
    return status;
}

enum neph_status neph_file_copy(const char *from, const char *to, struct neph_diag *diag)
{
    int from_fd;
    enum neph_status status = neph_file_open(from, &from_fd, NULL, diag);
    if (status)
        return status;
    struct temporary file;
    status = temporary_open(&file, to, diag);
    if (!status)
        status = copy_bytes(from_fd, from, file.fd, to, diag);
    if (!status)
        status = temporary_commit(&file, to, diag);
    temporary_finish(&file);
    close(from_fd);
    return status;
}

/* ---- folders --------------------------------------------------------------------------------- */

static int is_name(const struct dirent *entry)
{
    return strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0;
}

static int compare_entry_names(const struct dirent **a, const struct dirent **b)
{
    return strcmp((*a)->d_name, (*b)->d_name);
}

enum neph_status neph_dir_list(const char *path, struct neph_arena *arena, struct neph_names *names,
                               struct neph_diag *diag)
{
    struct dirent **entries = NULL;
    const int count = scandir(path, &entries, is_name, compare_entry_names);
    *names = (struct neph_names){NULL, 0};
    if (count < 0)
        return neph_fail(diag, NEPH_ERR_IO, "cannot open '%s': %s", path, strerror(errno));
    names->list = neph_arena_allocate(arena, (size_t)count + 1, sizeof(*names->list));
    for (int i = 0; i < count; i++) {
        if (names->list)
            names->list[names->count++] = neph_arena_copy_text(arena, entries[i]->d_name);
        free(entries[i]);
    }
    free(entries);
    return neph_arena_check(arena, diag);
}

static enum neph_status make_one_folder(const char *path, struct neph_diag *diag)
{
    if (mkdir(path, 0777) == 0 || (errno == EEXIST && neph_path_is_dir(path)))
        return NEPH_OK;
    return neph_fail(diag, NEPH_ERR_IO, "cannot make the folder '%s': %s", path, strerror(errno));
}

enum neph_status neph_dir_create(const char *path, struct neph_diag *diag)
{
    char *prefix = strdup(path);
    if (!prefix)
        return neph_fail_memory(diag);
    enum neph_status status = NEPH_OK;
    for (char *at = prefix + 1; *prefix && *at && !status; at++) {
        if (*at != '/')
            continue;
        *at = '\0';
        status = make_one_folder(prefix, diag);
        *at = '/';
    }
    if (!status)
        status = make_one_folder(prefix, diag);
    free(prefix);
    return status;
}

static bool remove_at(int parent_fd, const char *name);

static bool remove_entries(DIR *folder)
{
    for (;;) {
        errno = 0;
        const struct dirent *entry = readdir(folder);
        if (!entry)
            return errno == 0;
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0)
            continue;
        if (!remove_at(dirfd(folder), entry->d_name))
            return false;
    }
}

/* Open a folder to remove its entries. A program may have removed its own access rights to it. */
static int open_for_removal(int parent_fd, const char *name)
{
    const int flags = O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC;
    const int fd = openat(parent_fd, name, O_RDONLY | flags);
    if (fd >= 0) {
        struct stat info;
        if (fstat(fd, &info) == 0 && (info.st_mode & S_IRWXU) != S_IRWXU)
            fchmod(fd, S_IRWXU);
        return fd;
    }
    const int path_fd = errno == EACCES ? openat(parent_fd, name, O_PATH | flags) : -1;
    if (path_fd < 0)
        return -1;
    char path[64];
    snprintf(path, sizeof(path), "/proc/self/fd/%d", path_fd);
    const bool is_changed = chmod(path, S_IRWXU) == 0;
    close(path_fd);
    if (!is_changed)
        errno = EACCES;
    return is_changed ? openat(parent_fd, name, O_RDONLY | flags) : -1;
}

/* Uses file descriptors throughout, so that no folder can be replaced by a symbolic link meanwhile.
 */
static bool remove_at(int parent_fd, const char *name)
{
    if (unlinkat(parent_fd, name, 0) == 0 || errno == ENOENT)
        return true;
    if (errno != EISDIR)
        return false;
    int fd = open_for_removal(parent_fd, name);
    if (fd < 0)
        return false;
    DIR *folder = fdopendir(fd);
    if (!folder) {
        close(fd);
        return false;
    }
    bool removed = remove_entries(folder);
    int error = errno;
    closedir(folder);
    errno = error;
    return removed && unlinkat(parent_fd, name, AT_REMOVEDIR) == 0;
}

/* An empty variable in a caller must not remove the user's home or the whole disk. */
static bool is_protected_path(const char *path)
{
    size_t length = strlen(path);
    return strspn(path, "./") == length; /* "", "/", ".", "..", "../..", ... */
}

enum neph_status neph_dir_remove(const char *path, struct neph_diag *diag)
{
    if (is_protected_path(path))
        return neph_fail(diag, NEPH_ERR_INTERNAL, "refusing to remove the folder '%s'", path);
    if (!remove_at(AT_FDCWD, path))
        return neph_fail(diag, NEPH_ERR_IO, "cannot remove '%s': %s", path, strerror(errno));
    return NEPH_OK;
}

bool neph_disk_is_full(const char *folder)
{
    static const uint64_t room_bytes = 1 << 16; /* the failed write was larger than the free space
                                                 */
    struct statvfs info;
    if (statvfs(folder, &info) != 0 || info.f_blocks == 0)
        return false;
    return (uint64_t)info.f_bavail * info.f_frsize < room_bytes ||
           (info.f_files > 0 && info.f_favail == 0);
}

/* ---- paths ----------------------------------------------------------------------------------- */

bool neph_path_exists(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0;
}

bool neph_path_is_dir(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0 && S_ISDIR(info.st_mode);
}

bool neph_path_is_same(const char *a, const char *b)
{
    struct stat first, second;
    return stat(a, &first) == 0 && stat(b, &second) == 0 && first.st_dev == second.st_dev &&
           first.st_ino == second.st_ino;
}

char *neph_path_join(const char *folder, const char *name)
{
    size_t length = strlen(folder);
    bool needs_slash = length > 0 && folder[length - 1] != '/';
    return neph_format("%s%s%s", folder, needs_slash ? "/" : "", name);
}

char *neph_path_beside_program(const char *relative)
{
    char *program = realpath("/proc/self/exe", NULL);
    if (!program)
        return NULL;
    *strrchr(program, '/') = '\0';
    char *joined = neph_path_join(program, relative);
    char *path = joined ? realpath(joined, NULL) : NULL;
    free(joined);
    free(program);
    return path;
}

char *neph_format(const char *format, ...)
{
    char *text = NULL;
    va_list arguments;
    va_start(arguments, format);
    int length = vasprintf(&text, format, arguments);
    va_end(arguments);
    return length < 0 ? NULL : text;
}
