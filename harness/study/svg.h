/* SPDX-License-Identifier: MIT
 *
 * What the plots of studies share.
 */
#ifndef NEPH_HARNESS_STUDY_SVG_H
#define NEPH_HARNESS_STUDY_SVG_H

#include <stdio.h>

/* Text of the user's, such as the name of a preset, for an element or an attribute of SVG. */
void neph_svg_print_escaped(const char *text, FILE *out);

#endif
