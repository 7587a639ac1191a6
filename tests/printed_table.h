/* SPDX-License-Identifier: MIT
 *
 * A table in a README that a test prints from the program's own tables: compared with the file, or
 * written by `test_... --write`.
 */
#ifndef NEPH_TESTS_PRINTED_TABLE_H
#define NEPH_TESTS_PRINTED_TABLE_H

#include "tests/neph_test.h"

#include "base/files.h"

struct printed_table {
    const char *path;           /* of the README */
    const char *before, *after; /* the lines around the table */
    void (*print)(FILE *out);
};

static inline char *printed(void (*print)(FILE *out))
{
    char *text = NULL;
    size_t size = 0;
    FILE *file = open_memstream(&text, &size);
    assert_non_null(file);
    print(file);
    assert_int_equal(fclose(file), 0);
    return text;
}

/* The expected README.md; for the caller to free. */
static inline char *wanted_readme(const struct printed_table *table, const char *text)
{
    const char *start = strstr(text, table->before);
    const char *end = start ? strstr(start, table->after) : NULL;
    assert_non_null(end);
    char *rows = printed(table->print);
    char *wanted = neph_format("%.*s%s%s", (int)(start - text + (ptrdiff_t)strlen(table->before)),
                               text, rows, end);
    free(rows);
    return wanted;
}

static inline void check_readme(const struct printed_table *table, bool writes)
{
    char *text = NULL;
    size_t size = 0;
    neph_assert_ok(neph_file_read(table->path, 1 << 20, &text, &size, NULL), NULL);
    char *wanted = wanted_readme(table, text);
    if (writes)
        neph_assert_ok(neph_file_write(table->path, wanted, strlen(wanted), NULL), NULL);
    else
        assert_string_equal(text, wanted);
    free(wanted);
    free(text);
}

/* For `main`: the prestate of the test, NULL unless it writes. */
static inline void *writes_readme(int count, char **arguments)
{
    return count > 1 && !strcmp(arguments[1], "--write") ? arguments : NULL;
}

#endif
