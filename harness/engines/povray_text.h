/* SPDX-License-Identifier: MIT
 *
 * Writes the language of POV-Ray: fixed words, and numbers, colours and places by their kind.
 */
#ifndef NEPH_HARNESS_ENGINES_POVRAY_TEXT_H
#define NEPH_HARNESS_ENGINES_POVRAY_TEXT_H

#include "harness/engines/povray_pass.h"
#include "harness/engines/povray_world.h"

#include <stdio.h>

struct neph_povray_writer {
    FILE *stream;
    const struct neph_povray_world *world;
    const struct neph_povray_pass *pass;
    bool not_a_number; /* something infinite or undefined was to be written */
};

/* Write a text. In it stand for a value: %n a double, %i an int, %s fixed words, %v a vector, %p a
 * position in metres, which the macro P brings to units, %l the colour of light, and %m that of
 * matter. */
void neph_povray_put(struct neph_povray_writer *writer, const char *text, ...);

/* Whether light between solids is part of this image. */
bool neph_povray_has_radiosity(const struct neph_povray_writer *writer);

#endif
