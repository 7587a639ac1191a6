/* SPDX-License-Identifier: MIT
 *
 * Text from outside (paths, logs of programs, names of devices, other people's files) made fit for
 * a terminal and for JSON: valid UTF-8 (RFC 3629) without characters that act instead of showing.
 * Those are the controls C0 and C1 but for newline and tab, the line separators U+2028 and U+2029,
 * what turns the direction of text or is not seen at all (U+061C, U+200E, U+200F, U+202A..U+202E,
 * U+2066..U+206F, U+FEFF, U+FFF9..U+FFFB, the tags from U+E0000; see Unicode TR #36).
 */
#ifndef NEPH_BASE_TEXT_H
#define NEPH_BASE_TEXT_H

#include <stdbool.h>
#include <stddef.h>

/* Is it valid UTF-8? A NUL inside is none. */
bool neph_text_is_utf8(const char *text, size_t length);

/* The first byte of `text` that neph_text_clean would change; `length` when there is none. */
size_t neph_text_first_unfit(const char *text, size_t length);

/* Clean, in place, a text in a buffer of `size` bytes: a byte that is not UTF-8 and a control
 * become "\xNN", other characters that act "\uNNNN". What no longer fits is cut, never inside a
 * character or an escape; so is a character that was cut when a full buffer was filled. */
void neph_text_clean(char *text, size_t size);

/* printf into a buffer of `size` bytes (at least 1), cleaned. */
void neph_text_format(char *text, size_t size, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* A cleaned copy for the caller to free; NULL when memory is short. */
char *neph_text_clean_copy(const char *text);

#endif
