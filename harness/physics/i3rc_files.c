/* SPDX-License-Identifier: MIT */
#include "harness/physics/i3rc_files.h"

#include "base/files.h"
#include "base/path.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

const char neph_i3rc_address[] =
    "the clouds: https://github.com/RobertPincus/i3rc-monte-carlo-model, I3RC-Examples/Data; the "
    "consensus: https://i3rc.gsfc.nasa.gov, or the folders i3rc/caseN/consensus_results of "
    "https://github.com/tamarloeub/MitsubaGradient";

/* 128 x 128 numbers take a quarter of a megabyte. */
static const size_t limit_bytes = (size_t)16 << 20;

/* The position in the text of a file. */
struct cursor {
    const char *at, *line_start;
    int line;
};

static void skip_space(struct cursor *cursor)
{
    for (; isspace((unsigned char)*cursor->at); cursor->at++)
        if (*cursor->at == '\n') {
            cursor->line++;
            cursor->line_start = cursor->at + 1;
        }
}

/* Locate an error at the cursor's word. */
static enum neph_status refuse(const char *path, const struct cursor *cursor,
                               struct neph_diag *diag)
{
    if (diag)
        neph_locate(diag, path, cursor->line, (int)(cursor->at - cursor->line_start) + 1);
    return NEPH_ERR_INPUT;
}

static enum neph_status read_value(const struct neph_i3rc_file *file, const char *path,
                                   struct cursor *cursor, double *value, struct neph_diag *diag)
{
    const size_t length = strcspn(cursor->at, " \t\r\n\v\f");
    char *end;
    errno = 0;
    *value = strtod(cursor->at, &end);
    if (end != cursor->at + length || !isfinite(*value) || errno == ERANGE) {
        neph_fail(diag, NEPH_ERR_INPUT, "'%.*s' is not %s", length < 40 ? (int)length : 40,
                  cursor->at, file->what);
        neph_hint(diag, "numbers such as 0.123 or 1.5E-01, with white space between them");
        return refuse(path, cursor, diag);
    }
    if (*value < file->minimum || *value > file->maximum) {
        neph_fail(diag, NEPH_ERR_INPUT, "%g is not %s: it must be %g..%g", *value, file->what,
                  file->minimum, file->maximum);
        return refuse(path, cursor, diag);
    }
    cursor->at = end;
    return NEPH_OK;
}

static enum neph_status parse(const struct neph_i3rc_file *file, const char *path, const char *text,
                              double *values, struct neph_diag *diag)
{
    struct cursor cursor = {text, text, 1};
    for (int i = 0; i < file->values; i++) {
        skip_space(&cursor);
        if (!*cursor.at) {
            neph_fail(diag, NEPH_ERR_INPUT, "the file ends after %d of %d values", i, file->values);
            return refuse(path, &cursor, diag);
        }
        const enum neph_status status = read_value(file, path, &cursor, &values[i], diag);
        if (status)
            return status;
    }
    skip_space(&cursor);
    if (!*cursor.at)
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_INPUT, "more than %d values", file->values);
    return refuse(path, &cursor, diag);
}

static enum neph_status refuse_binary(const char *path, const char *text, struct neph_diag *diag)
{
    struct cursor cursor = {text, text, 1};
    for (skip_space(&cursor); *cursor.at; skip_space(&cursor))
        cursor.at += strcspn(cursor.at, " \t\r\n\v\f");
    neph_fail(diag, NEPH_ERR_INPUT, "a byte 0: this is no text");
    return refuse(path, &cursor, diag);
}

enum neph_status neph_i3rc_file_read(const char *folder, const struct neph_i3rc_file *file,
                                     double **values, struct neph_diag *diag)
{
    const struct neph_path path = neph_path_in(folder, file->name);
    char *text = NULL;
    size_t size = 0;
    enum neph_status status = neph_file_read(path.text, limit_bytes, &text, &size, diag);
    if (status)
        return status;
    double *made = calloc((size_t)file->values, sizeof(*made));
    if (!made)
        status = neph_fail_memory(diag);
    else if (strlen(text) != size)
        status = refuse_binary(path.text, text, diag);
    else
        status = parse(file, path.text, text, made, diag);
    free(text);
    if (status)
        free(made);
    else
        *values = made;
    return status;
}

enum neph_status neph_i3rc_consensus_read(const char *folder, int case_number, int experiment,
                                          const char *quantity, int columns, double **values,
                                          struct neph_diag *diag)
{
    static const char *const prefixes[] = {"", "I3RC_cons_res_"};
    *values = NULL;
    for (size_t i = 0; i < sizeof(prefixes) / sizeof(prefixes[0]); i++) {
        const struct neph_path name = neph_path_format("%scase%d_exp%d_%s.txt", prefixes[i],
                                                       case_number, experiment, quantity);
        /* H may be of either sign. */
        const struct neph_i3rc_file file = {name.text, "a flux over the sunlight", columns, -100.0,
                                            100.0};
        const enum neph_status status = neph_i3rc_file_read(folder, &file, values, diag);
        if (status != NEPH_ERR_NOT_FOUND)
            return status;
    }
    return NEPH_OK;
}
