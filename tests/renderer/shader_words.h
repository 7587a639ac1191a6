/* SPDX-License-Identifier: MIT
 *
 * A shader as SPIR-V with all functions inlined and its constants applied, for tests that read
 * SPIR-V.
 */
#ifndef NEPH_TESTS_SHADER_WORDS_H
#define NEPH_TESTS_SHADER_WORDS_H

#include "tests/neph_test.h"

#include "renderer/shader_code.h"
#include "renderer/specialize.h"

/* The words; the caller frees them. `constants` may be NULL: the shader's defaults. */
static inline uint32_t *test_shader_words(const uint32_t *code, size_t code_bytes,
                                          const uint32_t *constants, int count, size_t *word_count)
{
    struct neph_diag diag = {0};
    uint32_t *whole = NULL, *words = NULL;
    size_t whole_bytes = 0, bytes = 0;
    neph_assert_ok(neph_shader_unpack(code, code_bytes, &whole, &whole_bytes, &diag), &diag);
    neph_assert_ok(neph_specialize(whole, whole_bytes, constants, count, &words, &bytes, &diag),
                   &diag);
    free(whole);
    *word_count = bytes / sizeof(*words);
    return words;
}

#endif
