/* SPDX-License-Identifier: MIT
 *
 * What the plots of studies share.
 */
#ifndef NEPH_HARNESS_STUDY_SVG_H
#define NEPH_HARNESS_STUDY_SVG_H

#include <stdio.h>

/* Text of the user's, such as the name of a preset, for an element or an attribute of SVG. */
void neph_svg_print_escaped(const char *text, FILE *out);

/* Marks that differ by shape, so that they are told apart in grey and by any eye, and by a colour
 * beside: NEPH_SVG_MARKS of them, then all over again. About 9 px wide. */
enum { NEPH_SVG_MARKS = 16 };
void neph_svg_print_mark(int number, double x_px, double y_px, FILE *out);

#endif
