/* SPDX-License-Identifier: MIT
 *
 * The text of which a scene's hash is computed: a name and its numbers per line, 17 digits each, so
 * that equal texts mean equal doubles. Private to scenes/.
 */
#ifndef NEPH_SCENES_HASH_TEXT_H
#define NEPH_SCENES_HASH_TEXT_H

#include "base/vec3.h"

#include <stdio.h>

void neph_put_number(FILE *text, const char *name, double value);
void neph_put_three(FILE *text, const char *name, double a, double b, double c);
void neph_put_vec3(FILE *text, const char *name, struct neph_vec3 v);
void neph_put_rgb(FILE *text, const char *name, struct neph_rgb c);

/* Preceded by its length, so that a text cannot imitate further lines; NULL is the empty text. */
void neph_put_text(FILE *text, const char *name, const char *value);

#endif
