/* SPDX-License-Identifier: MIT
 *
 * Text from outside (paths, logs of programs, names of devices, files of others) made safe for a
 * terminal and for JSON: valid UTF-8 (RFC 3629) without control characters. These are the controls
 * C0 and C1 except newline and tab, the line separators U+2028 and U+2029, and characters that
 * change the direction of text or are invisible (U+061C, U+200E, U+200F, U+202A..U+202E,
 * U+2066..U+206F, U+FEFF, U+FFF9..U+FFFB, the tags from U+E0000; see Unicode TR #36).
 */
#ifndef NEPH_BASE_TEXT_H
#define NEPH_BASE_TEXT_H

#include <stdbool.h>
#include <stddef.h>

/* Whether a text is valid UTF-8 without a NUL inside. */
bool neph_text_is_utf8(const char *text, size_t length);

/* Index of the first byte that neph_text_clean() would change; `length` when there is none. */
size_t neph_text_first_unfit(const char *text, size_t length);

/* Clean a text in place, in a buffer of `size` bytes: an invalid byte or a C0 or C1 control becomes
 * "\xNN", any other control character "\uNNNN". A text that no longer fits is truncated, never
 * inside a character or an escape. A character that is incomplete at the end of a full buffer is
 * dropped. */
void neph_text_clean(char *text, size_t size);

/* printf into a buffer of `size` bytes (at least 1), cleaned. */
void neph_text_format(char *text, size_t size, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* A cleaned copy for the caller to free; NULL when memory is short. */
char *neph_text_clean_copy(const char *text);

#endif
