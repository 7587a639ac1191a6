/* SPDX-License-Identifier: MIT
 *
 * Writes POV-Ray's language: fixed words, and numbers, colours and positions by format letters.
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
    bool not_a_number; /* an infinite or undefined number was written */
};

/* Write a text. Formats: %n a double, %i an int, %s fixed words, %v a vector, %p a position in
 * metres (the macro P converts it to units), %l a colour of light, %m a colour of matter. */
void neph_povray_write_text(struct neph_povray_writer *writer, const char *text, ...);

/* Write the rotation of a box about its middle; nothing where there is none. It only turns what is
 * written before it. */
void neph_povray_write_turn(struct neph_povray_writer *writer, const struct neph_turn *turn,
                            const struct neph_bounds *box);

/* Whether this image includes light between solids. */
bool neph_povray_has_radiosity(const struct neph_povray_writer *writer);

#endif
