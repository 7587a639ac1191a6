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
    BUFFER_BYTES = 2048, /* on the stack, per level of folders */
    BLOCK_BYTES = 512,   /* unit of st_blocks, on every file system */
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

static void remove_folders(const char *folder)
{
    struct neph_arena arena = {NULL};
    struct neph_names names;
    const bool is_listed = neph_dir_list(folder, &arena, &names, NULL) == NEPH_OK;
    for (int i = 0; is_listed && i < names.count; i++) {
        const char *path = neph_arena_format(&arena, "%s/%s", folder, names.list[i]);
        struct stat info;
        if (lstat(path, &info) == 0 && S_ISDIR(info.st_mode))
            neph_dir_remove(path, NULL);
    }
    neph_arena_finish(&arena);
}

struct file {
    const char *path;
    int64_t bytes;
};

static int by_size(const void *a, const void *b)
{
    const int64_t first = ((const struct file *)a)->bytes, second = ((const struct file *)b)->bytes;
    return (first < second) - (first > second);
}

static void remove_largest(const char *folder, struct neph_usage *usage)
{
    struct neph_arena arena = {NULL};
    struct neph_names names;
    const bool is_listed = neph_dir_list(folder, &arena, &names, NULL) == NEPH_OK;
    struct file *files = neph_arena_zeroed(&arena, (size_t)names.count, sizeof(*files));
    int count = 0;
    for (int i = 0; is_listed && files && i < names.count; i++) {
        const char *path = neph_arena_format(&arena, "%s/%s", folder, names.list[i]);
        struct stat info;
        if (lstat(path, &info) == 0 && !S_ISDIR(info.st_mode))
            files[count++] = (struct file){path, (int64_t)info.st_blocks * BLOCK_BYTES};
    }
    if (count > 0)
        qsort(files, (size_t)count, sizeof(*files), by_size);
    for (int i = 0; i < count && !fits(usage); i++)
        if (unlink(files[i].path) == 0) {
            usage->bytes -= files[i].bytes;
            usage->entries--;
        }
    neph_arena_finish(&arena);
}

static void leave_note(const char *folder, const struct neph_usage *before)
{
    char *path = neph_path_join(folder, note_name);
    char *text = neph_format("This folder had %" PRId64 " MiB in %" PRId64
                             " files and folders. Of a failed frame at most %d MiB and %d entries "
                             "are kept; subfolders and the largest files were removed.\n",
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
