/* SPDX-License-Identifier: MIT
 *
 * Numbers of a text file, between white space, with their places.
 */
#ifndef NEPH_SCENES_TEXT_NUMBERS_H
#define NEPH_SCENES_TEXT_NUMBERS_H

#include "base/status.h"

#include <stdbool.h>
#include <stdio.h>

enum { NEPH_TEXT_WORD_SIZE = 64 };

/* Start from {.file = an open file}. */
struct neph_text_numbers {
    FILE *file;                     /* not owned */
    bool has_comments;              /* from # to the end of a line */
    int line, column;               /* from 1 on: of the word; at the end of the file, of that */
    char word[NEPH_TEXT_WORD_SIZE]; /* "" at the end of the file; the beginning of a longer one */
    int next_line, next_column;     /* how far it was read, from 0 on */
};

/* The next word. NEPH_ERR_INPUT: a byte 0; NEPH_ERR_IO. Messages here and below have no place. */
enum neph_status neph_text_next_word(struct neph_text_numbers *numbers, struct neph_diag *diag);

/* Whether the line has no further word. */
bool neph_text_is_line_read(struct neph_text_numbers *numbers);

/* Leaves out the rest of a line. */
void neph_text_skip_line(struct neph_text_numbers *numbers);

/* The number of the word that was read. `what` names it in messages: "an optical depth".
 * NEPH_ERR_INPUT: it is not a finite number in this range, or the file has ended. */
enum neph_status neph_text_to_number(const struct neph_text_numbers *numbers, const char *what,
                                     double minimum, double maximum, double *value,
                                     struct neph_diag *diag);

/* neph_text_next_word() and neph_text_to_number(). */
enum neph_status neph_text_next_number(struct neph_text_numbers *numbers, const char *what,
                                       double minimum, double maximum, double *value,
                                       struct neph_diag *diag);

/* neph_text_next_number() of a whole number. */
enum neph_status neph_text_next_whole(struct neph_text_numbers *numbers, const char *what,
                                      int minimum, int maximum, int *value, struct neph_diag *diag);

#endif
