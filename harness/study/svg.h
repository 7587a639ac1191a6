/* SPDX-License-Identifier: MIT
 *
 * SVG output that the charts of studies share.
 */
#ifndef NEPH_HARNESS_STUDY_SVG_H
#define NEPH_HARNESS_STUDY_SVG_H

#include <stdio.h>

/* Prints a text, such as the name of a preset, escaped for an SVG element or attribute. */
void neph_svg_print_escaped(const char *text, FILE *out);

/* Prints a mark of about 9 px. Marks differ by shape, readable in grey and with any colour vision,
 * and by colour as well. After NEPH_SVG_MARKS they repeat. */
enum { NEPH_SVG_MARKS = 16 };
void neph_svg_print_mark(int number, double x_px, double y_px, FILE *out);

#endif
