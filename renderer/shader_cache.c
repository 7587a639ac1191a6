/* SPDX-License-Identifier: MIT */
#include "renderer/shader_cache.h"

#include "base/files.h"
#include "renderer/specialize.h"

#include <dirent.h>
#include <fcntl.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Format of a file: the hash of the words, then the words. */
enum { HASH_BYTES = NEPH_HASH_HEX_SIZE - 1, FILE_MAX_BYTES = 16 << 20 };

struct neph_shader_cache {
    char *folder;
    atomic_bool has_written;
};

enum neph_status neph_shader_cache_create(const char *folder, struct neph_shader_cache **cache,
                                          struct neph_diag *diag)
{
    struct neph_shader_cache *created = calloc(1, sizeof(*created));
    if (created)
        created->folder = neph_path_join(folder, "shaders");
    if (!created || !created->folder) {
        free(created);
        return neph_fail_memory(diag);
    }
    *cache = created;
    return NEPH_OK;
}

/* --- one file ----------------------------------------------------------------------------- */

enum neph_status neph_shader_cache_key(const uint32_t *code, size_t code_bytes,
                                       const uint32_t *constants, int count,
                                       char key[NEPH_HASH_HEX_SIZE], struct neph_diag *diag)
{
    const char *version = neph_specialize_version();
    const size_t version_bytes = strlen(version) + 1;
    const size_t constant_bytes = (size_t)count * sizeof(*constants);
    char *all = malloc(version_bytes + constant_bytes + code_bytes);
    if (!all)
        return neph_fail_memory(diag);
    memcpy(all, version, version_bytes);
    memcpy(all + version_bytes, constants, constant_bytes);
    memcpy(all + version_bytes + constant_bytes, code, code_bytes);
    const enum neph_status status = neph_hash(all, version_bytes + constant_bytes + code_bytes, key,
                                              diag);
    free(all);
    return status;
}

/* Size of the words in a file; 0 if they do not match the hash. */
static size_t check_file(const char *file, size_t size_bytes)
{
    char hash[NEPH_HASH_HEX_SIZE];
    if (size_bytes <= HASH_BYTES || (size_bytes - HASH_BYTES) % sizeof(uint32_t) != 0 ||
        neph_hash(file + HASH_BYTES, size_bytes - HASH_BYTES, hash, NULL) ||
        memcmp(file, hash, HASH_BYTES) != 0)
        return 0;
    return size_bytes - HASH_BYTES;
}

static bool read_words(const char *path, uint32_t **words, size_t *size_bytes)
{
    char *file = NULL;
    size_t file_bytes = 0;
    if (neph_file_read(path, FILE_MAX_BYTES, &file, &file_bytes, NULL))
        return false;
    const size_t bytes = check_file(file, file_bytes);
    uint32_t *read = bytes > 0 ? malloc(bytes) : NULL;
    if (read)
        memcpy(read, file + HASH_BYTES, bytes);
    free(file);
    *words = read;
    *size_bytes = bytes;
    return read != NULL;
}

bool neph_shader_cache_read(struct neph_shader_cache *cache, const char *key, uint32_t **words,
                            size_t *size_bytes)
{
    char *path = cache ? neph_path_join(cache->folder, key) : NULL;
    const bool is_there = path && read_words(path, words, size_bytes);
    if (is_there)
        utimensat(AT_FDCWD, path, NULL, 0); /* the time of the last use */
    free(path);
    return is_there;
}

void neph_shader_cache_write(struct neph_shader_cache *cache, const char *key,
                             const uint32_t *words, size_t size_bytes)
{
    char *path = cache ? neph_path_join(cache->folder, key) : NULL;
    char *file = malloc(HASH_BYTES + size_bytes);
    char hash[NEPH_HASH_HEX_SIZE];
    if (path && file && size_bytes <= FILE_MAX_BYTES - HASH_BYTES &&
        !neph_hash(words, size_bytes, hash, NULL) && !neph_dir_create(cache->folder, NULL)) {
        memcpy(file, hash, HASH_BYTES);
        memcpy(file + HASH_BYTES, words, size_bytes);
        if (!neph_file_write(path, file, HASH_BYTES + size_bytes, NULL))
            atomic_store(&cache->has_written, true);
    }
    free(file);
    free(path);
}

/* --- the size limit ----------------------------------------------------------------------- */

struct kept {
    char name[NEPH_HASH_HEX_SIZE];
    struct timespec used;
    off_t bytes;
};

struct listing {
    struct kept *files; /* owned */
    size_t count, capacity;
    off_t bytes;
};

static bool list_file(struct listing *listing, const struct kept *file)
{
    if (listing->count == listing->capacity) {
        const size_t capacity = 2 * listing->capacity + 64;
        struct kept *grown = realloc(listing->files, capacity * sizeof(*grown));
        if (!grown)
            return false;
        listing->files = grown;
        listing->capacity = capacity;
    }
    listing->files[listing->count++] = *file;
    listing->bytes += file->bytes;
    return true;
}

/* Files whose names do not have the form of a key are ignored. */
static void list_folder(DIR *directory, struct listing *listing)
{
    bool has_memory = true;
    for (const struct dirent *entry; has_memory && (entry = readdir(directory));) {
        struct stat stat;
        if (strlen(entry->d_name) != HASH_BYTES ||
            fstatat(dirfd(directory), entry->d_name, &stat, AT_SYMLINK_NOFOLLOW) != 0)
            continue;
        struct kept file = {.used = stat.st_mtim, .bytes = stat.st_size};
        memcpy(file.name, entry->d_name, sizeof(file.name));
        has_memory = list_file(listing, &file);
    }
}

static int compare_used(const void *a, const void *b)
{
    const struct timespec *x = &((const struct kept *)a)->used;
    const struct timespec *y = &((const struct kept *)b)->used;
    if (x->tv_sec != y->tv_sec)
        return x->tv_sec < y->tv_sec ? -1 : 1;
    return (x->tv_nsec > y->tv_nsec) - (x->tv_nsec < y->tv_nsec);
}

/* Several processes may do this at once; removing a file twice is harmless. */
static void enforce_size_limit(const char *folder)
{
    DIR *directory = opendir(folder);
    struct listing listing = {0};
    if (!directory)
        return;
    list_folder(directory, &listing);
    if (listing.count > 0)
        qsort(listing.files, listing.count, sizeof(*listing.files), compare_used);
    for (size_t i = 0; i < listing.count && listing.bytes > NEPH_SHADER_CACHE_MAX_BYTES; i++) {
        unlinkat(dirfd(directory), listing.files[i].name, 0);
        listing.bytes -= listing.files[i].bytes;
    }
    free(listing.files);
    closedir(directory);
}

void neph_shader_cache_destroy(struct neph_shader_cache *cache)
{
    if (!cache)
        return;
    if (atomic_load(&cache->has_written)) {
        neph_file_sweep(cache->folder);
        enforce_size_limit(cache->folder);
    }
    free(cache->folder);
    free(cache);
}
