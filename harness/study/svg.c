/* SPDX-License-Identifier: MIT */
#include "harness/study/svg.h"

void neph_svg_print_escaped(const char *text, FILE *out)
{
    for (; *text; text++) {
        if (*text == '<' || *text == '&' || *text == '"')
            fprintf(out, "&#%d;", *text);
        else
            fputc(*text, out);
    }
}
