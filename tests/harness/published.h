/* SPDX-License-Identifier: MIT
 *
 * Captures in memory, in all formats, everything that an experiment publishes.
 */
#ifndef NEPH_TESTS_HARNESS_PUBLISHED_H
#define NEPH_TESTS_HARNESS_PUBLISHED_H

#include "tests/neph_test.h"

#include "harness/document/publication.h"

/* End it with neph_publication_finish(). */
static inline void begin_published(struct neph_publication *publication)
{
    static const struct neph_publication_places all = {
        .markdown = "/nowhere", .csv = "/nowhere", .chart = "/nowhere", .json = true};
    neph_assert_ok(neph_publication_begin(&all, publication, NULL), NULL);
}

static inline const char *published_text(FILE *stream, const struct neph_publication *publication)
{
    FILE *const streams[NEPH_PUBLICATION_STREAMS] = {publication->text, publication->csv,
                                                     publication->chart};
    int form = 0;
    while (streams[form] != stream)
        form++;
    assert_int_equal(fflush(stream), 0);
    return publication->kept[form].text;
}

static inline int count_parts(const char *text, const char *part)
{
    int count = 0;
    for (text = strstr(text, part); text; text = strstr(text + 1, part))
        count++;
    return count;
}

#endif
