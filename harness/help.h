/* SPDX-License-Identifier: MIT
 *
 * The help of a verb as text: usage, options by group and name, paragraphs. Lines that begin with
 * two blanks, such as examples, are printed as they are, so that a shell takes them when pasted.
 */
#ifndef NEPH_HARNESS_HELP_H
#define NEPH_HARNESS_HELP_H

#include <stdio.h>

struct neph_help_option {
    const char *name;
    int letter;           /* 0: none */
    const char *argument; /* NULL: a flag */
    const char *text;
    const char *otherwise; /* the default, printed behind the text; NULL: none */
    int group;             /* groups are printed in ascending order, negative ones last */
};

struct neph_help {
    const char *verb;     /* "neph compare" */
    const char *operands; /* "SCENE", a line for each form; NULL: none */
    const char *doc;      /* what is before a \v stands above the options, the rest below */
    struct neph_help_option *options;
    int option_count;
};

/* Print it; the options are sorted in place. */
void neph_help_print(const struct neph_help *help, FILE *out);

#endif
