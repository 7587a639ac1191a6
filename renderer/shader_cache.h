/* SPDX-License-Identifier: MIT
 *
 * Specialised shaders, kept on disk for the next run: a file each, named after the hash of what it
 * was made from. It only saves time: a file that is damaged is made again, and a folder that cannot
 * be read or written is an empty one. Any number of threads and processes may use a folder. Not for
 * other folders.
 */
#ifndef NEPH_RENDERER_SHADER_CACHE_H
#define NEPH_RENDERER_SHADER_CACHE_H

#include "base/hash.h"
#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The size limit of the folder [bytes], which _destroy enforces: it removes the least recently used
 * files. Some 2,000 shaders. */
enum { NEPH_SHADER_CACHE_MAX_BYTES = 64 << 20 };

struct neph_shader_cache;

/* `folder` is made when something is written. Free with _destroy. */
enum neph_status neph_shader_cache_create(const char *folder, struct neph_shader_cache **cache,
                                          struct neph_diag *diag);

/* NULL is fine. Keeps the folder within its limit if something was written. */
void neph_shader_cache_destroy(struct neph_shader_cache *cache);

/* The name of what `code` becomes with these constants. */
enum neph_status neph_shader_cache_key(const uint32_t *code, size_t code_bytes,
                                       const uint32_t *constants, int count,
                                       char key[NEPH_HASH_HEX_SIZE], struct neph_diag *diag);

/* For the caller to free. False: it is not there, or not whole. A NULL cache has nothing. */
bool neph_shader_cache_read(struct neph_shader_cache *cache, const char *key, uint32_t **words,
                            size_t *size_bytes);

/* Whole or not at all. NULL is fine. */
void neph_shader_cache_write(struct neph_shader_cache *cache, const char *key,
                             const uint32_t *words, size_t size_bytes);

#endif
