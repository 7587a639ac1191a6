/* SPDX-License-Identifier: MIT */
#include "base/usage.h"

#include "base/arena.h"
#include "base/files.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum {
    DEPTH_MAX = 64,
    BUFFER_BYTES = 2048, /* on the stack, for each level */
    BLOCK_BYTES = 512,   /* of struct stat, on every file system */
};

static const char note_name[] = "removed.txt";

/* ---- measuring ------------------------------------------------------------------------------- */

static bool is_entry(const char *name)
{
    return strcmp(name, ".") != 0 && strcmp(name, "..") != 0;
}

static void measure_below(int folder_fd, int depth, struct neph_usage *usage);

static void measure_entry(int folder_fd, const char *name, int depth, struct neph_usage *usage)
{
    struct stat info;
    if (fstatat(folder_fd, name, &info, AT_SYMLINK_NOFOLLOW) != 0)
        return;
    usage->entries++;
    usage->bytes += (int64_t)info.st_blocks * BLOCK_BYTES;
    if (!S_ISDIR(info.st_mode))
        return;
    const int fd = depth < DEPTH_MAX
                       ? openat(folder_fd, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC)
                       : -1;
    if (fd >= 0) {
        measure_below(fd, depth + 1, usage);
        close(fd);
    } else if (depth >= DEPTH_MAX || errno != ENOENT)
        usage->is_known = false;
}

/* getdents64() and not readdir(), which allocates. */
static void measure_below(int folder_fd, int depth, struct neph_usage *usage)
{
    _Alignas(struct dirent64) char buffer[BUFFER_BYTES];
    ssize_t got;
    while ((got = getdents64(folder_fd, buffer, sizeof(buffer))) > 0)
        for (ssize_t at = 0; at < got;) {
            const struct dirent64 *entry = (const struct dirent64 *)(buffer + at);
            if (is_entry(entry->d_name))
                measure_entry(folder_fd, entry->d_name, depth, usage);
            at += entry->d_reclen;
        }
    if (got < 0)
        usage->is_known = false;
}

struct neph_usage neph_usage_measure(const char *folder)
{
    struct neph_usage usage = {.is_known = true};
    const int fd = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (fd < 0)
        return (struct neph_usage){.is_known = false};
    measure_below(fd, 0, &usage);
    close(fd);
    return usage;
}

/* ---- trimming -------------------------------------------------------------------------------- */

static bool fits(const struct neph_usage *usage)
{
    return usage->is_known && usage->bytes <= NEPH_KEPT_BYTES &&
           usage->entries <= NEPH_KEPT_ENTRIES;
}

struct file {
    const char *name;
    int64_t bytes;
};

struct files {
    struct neph_arena arena;
    struct file *list;
    int count, room;
};

static bool add_file(struct files *files, const char *name, int64_t bytes)
{
    const char *copy = neph_arena_text(&files->arena, name);
    files->list = neph_arena_grown(&files->arena, files->list, files->count, &files->room,
                                   sizeof(*files->list));
    if (files->arena.is_short)
        return false;
    files->list[files->count++] = (struct file){copy, bytes};
    return true;
}

/* List the files of `folder` itself. */
static bool list_files(const char *folder, struct files *files)
{
    DIR *directory = opendir(folder);
    bool is_listed = directory != NULL;
    for (const struct dirent *entry; is_listed && (entry = readdir(directory));) {
        struct stat info;
        if (is_entry(entry->d_name) &&
            fstatat(dirfd(directory), entry->d_name, &info, AT_SYMLINK_NOFOLLOW) == 0 &&
            !S_ISDIR(info.st_mode))
            is_listed = add_file(files, entry->d_name, (int64_t)info.st_blocks * BLOCK_BYTES);
    }
    if (directory)
        closedir(directory);
    return is_listed;
}

static int by_size(const void *a, const void *b)
{
    const int64_t first = ((const struct file *)a)->bytes, second = ((const struct file *)b)->bytes;
    return (first < second) - (first > second);
}

static void remove_folders(const char *folder)
{
    DIR *directory = opendir(folder);
    for (const struct dirent *entry; directory && (entry = readdir(directory));) {
        char *path = is_entry(entry->d_name) ? neph_path_join(folder, entry->d_name) : NULL;
        struct stat info;
        if (path && lstat(path, &info) == 0 && S_ISDIR(info.st_mode))
            neph_dir_remove(path, NULL);
        free(path);
    }
    if (directory)
        closedir(directory);
}

static void remove_largest(const char *folder, struct neph_usage *usage)
{
    struct files files = {.list = NULL};
    if (list_files(folder, &files))
        qsort(files.list, (size_t)files.count, sizeof(*files.list), by_size);
    for (int i = 0; i < files.count && !fits(usage) && files.list; i++) {
        char *path = neph_path_join(folder, files.list[i].name);
        if (path && unlink(path) == 0) {
            usage->bytes -= files.list[i].bytes;
            usage->entries--;
        }
        free(path);
    }
    neph_arena_finish(&files.arena);
}

static void leave_note(const char *folder, const struct neph_usage *before)
{
    char *path = neph_path_join(folder, note_name);
    char *text = neph_format("This folder held %" PRId64 " MiB in %" PRId64
                             " files and folders. Of a failed frame %d MiB and %d are kept; the "
                             "folders in it and the largest files were removed.\n",
                             before->bytes >> 20, before->entries, (int)(NEPH_KEPT_BYTES >> 20),
                             NEPH_KEPT_ENTRIES);
    if (path && text)
        neph_file_write(path, text, strlen(text), NULL);
    free(text);
    free(path);
}

void neph_usage_trim(const char *folder)
{
    const struct neph_usage before = neph_usage_measure(folder);
    if (fits(&before))
        return;
    remove_folders(folder);
    struct neph_usage after = neph_usage_measure(folder);
    if (!fits(&after))
        remove_largest(folder, &after);
    leave_note(folder, &before);
}
