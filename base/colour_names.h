/* SPDX-License-Identifier: MIT
 *
 * The names that programs give to the three channels of a colour image.
 */
#ifndef NEPH_BASE_COLOUR_NAMES_H
#define NEPH_BASE_COLOUR_NAMES_H

#include <stdbool.h>

/* Names of the channels of red, green and blue; of a grey image three times the same name. */
struct neph_colour_names {
    const char *names[3];
    bool is_grey;
};

/* The names at an index, those with the highest priority first; NULL: there are no more. */
const struct neph_colour_names *neph_colour_names_at(int index);

/* Whether `has(context, name)` is true for all three of these names. Of a grey image also: no
 * other colour channel exists (R, G, B, Y, L, or the chroma RY, BY). */
bool neph_colour_names_fit(const struct neph_colour_names *names,
                           bool (*has)(const void *context, const char *name), const void *context);

#endif
