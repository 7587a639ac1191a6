/* SPDX-License-Identifier: MIT
 *
 * Specialised shaders, kept on disk for the next run: one file each, named after the hash of its
 * inputs. It only saves time: a damaged file is written again, and a folder that cannot be read or
 * written counts as empty. Any number of threads and processes may use a folder. Not for other
 * folders.
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

/* `folder` is created at the first write. Free with _destroy. */
enum neph_status neph_shader_cache_create(const char *folder, struct neph_shader_cache **cache,
                                          struct neph_diag *diag);

/* NULL is fine. Keeps the folder within its limit if something was written. */
void neph_shader_cache_destroy(struct neph_shader_cache *cache);

/* The key of `code` with these constants. */
enum neph_status neph_shader_cache_key(const uint32_t *code, size_t code_bytes,
                                       const uint32_t *constants, int count,
                                       char key[NEPH_HASH_HEX_SIZE], struct neph_diag *diag);

/* The caller frees `*words`. False: no file, or a damaged one. A NULL cache is empty. */
bool neph_shader_cache_read(struct neph_shader_cache *cache, const char *key, uint32_t **words,
                            size_t *size_bytes);

/* Written completely or not at all. NULL is fine. */
void neph_shader_cache_write(struct neph_shader_cache *cache, const char *key,
                             const uint32_t *words, size_t size_bytes);

#endif
