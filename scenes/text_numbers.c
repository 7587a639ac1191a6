/* SPDX-License-Identifier: MIT */
#include "scenes/text_numbers.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* EOF, or the next byte, which remains to be read. */
static int peek(const struct neph_text_numbers *numbers)
{
    return ungetc(getc_unlocked(numbers->file), numbers->file);
}

static void step(struct neph_text_numbers *numbers)
{
    const bool is_line_end = getc_unlocked(numbers->file) == '\n';
    numbers->next_line += is_line_end;
    numbers->next_column = is_line_end ? 0 : numbers->next_column + 1;
}

static bool is_line_rest(int byte)
{
    return byte != EOF && byte != '\n';
}

/* White space and comments, up to a word; with `in_line` up to the end of the line. */
static void skip_space(struct neph_text_numbers *numbers, bool in_line)
{
    bool in_comment = false;
    for (int byte = peek(numbers); byte != EOF; byte = peek(numbers)) {
        in_comment = byte != '\n' && (in_comment || (numbers->has_comments && byte == '#'));
        if ((!in_comment && !isspace(byte)) || (in_line && byte == '\n'))
            return;
        step(numbers);
    }
}

enum neph_status neph_text_next_word(struct neph_text_numbers *numbers, struct neph_diag *diag)
{
    size_t length = 0;
    skip_space(numbers, false);
    numbers->line = numbers->next_line + 1;
    numbers->column = numbers->next_column + 1;
    for (int byte = peek(numbers); byte != EOF && !isspace(byte); byte = peek(numbers)) {
        if (byte == 0) {
            numbers->column = numbers->next_column + 1;
            return neph_fail(diag, NEPH_ERR_INPUT, "a byte 0: this is no text");
        }
        if (length < NEPH_TEXT_WORD_SIZE - 1)
            numbers->word[length++] = (char)byte;
        step(numbers);
    }
    numbers->word[length] = '\0';
    return ferror(numbers->file) ? neph_fail(diag, NEPH_ERR_IO, "%s", strerror(errno)) : NEPH_OK;
}

bool neph_text_is_line_read(struct neph_text_numbers *numbers)
{
    skip_space(numbers, true);
    return !is_line_rest(peek(numbers));
}

void neph_text_skip_line(struct neph_text_numbers *numbers)
{
    while (is_line_rest(peek(numbers)))
        step(numbers);
}

enum neph_status neph_text_to_number(const struct neph_text_numbers *numbers, const char *what,
                                     double minimum, double maximum, double *value,
                                     struct neph_diag *diag)
{
    const char *word = numbers->word;
    char *end;
    if (!*word)
        return neph_fail(diag, NEPH_ERR_INPUT, "the file ends where %s should be", what);
    errno = 0;
    *value = strtod(word, &end);
    if (*end || strlen(word) == NEPH_TEXT_WORD_SIZE - 1 || !isfinite(*value) || errno == ERANGE) {
        neph_fail(diag, NEPH_ERR_INPUT, "'%.40s' is not %s", word, what);
        neph_hint(diag, "numbers such as 0.123 or 1.5E-01, with white space between them");
        return NEPH_ERR_INPUT;
    }
    if (*value < minimum || *value > maximum)
        return neph_fail(diag, NEPH_ERR_INPUT, "%g is not %s: it must be %g..%g", *value, what,
                         minimum, maximum);
    return NEPH_OK;
}

enum neph_status neph_text_next_number(struct neph_text_numbers *numbers, const char *what,
                                       double minimum, double maximum, double *value,
                                       struct neph_diag *diag)
{
    const enum neph_status status = neph_text_next_word(numbers, diag);
    return status ? status : neph_text_to_number(numbers, what, minimum, maximum, value, diag);
}

enum neph_status neph_text_next_whole(struct neph_text_numbers *numbers, const char *what,
                                      int minimum, int maximum, int *value, struct neph_diag *diag)
{
    double number = 0.0;
    const enum neph_status status = neph_text_next_number(numbers, what, minimum, maximum, &number,
                                                          diag);
    if (status)
        return status;
    if (number != floor(number))
        return neph_fail(diag, NEPH_ERR_INPUT, "%g is not %s: it must be whole", number, what);
    *value = (int)number;
    return NEPH_OK;
}
