/* SPDX-License-Identifier: MIT
 *
 * What a command has found, in the forms that its user wants: an answer in ten lines, a text of all
 * numbers that is Markdown, too, CSV, a chart as SVG, and JSON.
 */
#ifndef NEPH_HARNESS_DOCUMENT_PUBLICATION_H
#define NEPH_HARNESS_DOCUMENT_PUBLICATION_H

#include "harness/document/answer.h"
#include "harness/document/table.h"

#include <stdbool.h>
#include <stdio.h>

/* Where the forms go. */
struct neph_publication_places {
    const char *markdown, *csv, *chart; /* files; NULL: not wanted; "-" of csv: stdout, in place of
                                           the text */
    const char *document;               /* a file of the JSON; NULL: not wanted */
    bool json;                          /* JSON on stdout, in place of the text */
    bool all;                           /* the text on stdout also where there is an answer */
    bool quiet;                         /* of an answer only its first line */
    struct neph_answer_rest rest;       /* printed below the answer */
};

enum { NEPH_PUBLICATION_STREAMS = 3 };

struct neph_publication {
    const struct neph_publication_places *places; /* borrowed */
    FILE *text, *csv, *chart;                     /* into memory; NULL: not wanted */
    struct neph_answer answer; /* on stdout in place of the text; empty: the text is there */
    json_t *json;              /* for places->json and ->document; owned */
    int broken_count;          /* parts that broke: an error, once all is published, .. */
    const char *broken_words;  /* .. "takes broke; their cells say why" */
    enum neph_status verdict;  /* an error of the results, once all is published, .. */
    struct neph_diag reason;   /* .. and what it says */
    struct neph_arena arena;   /* of texts, until all is published; short, where a table was, too */
    struct {
        char *text;
        size_t size;
    } kept[NEPH_PUBLICATION_STREAMS];
};

/* NEPH_ERR_MEMORY. End with _finish in any case. */
enum neph_status neph_publication_begin(const struct neph_publication_places *places,
                                        struct neph_publication *publication,
                                        struct neph_diag *diag);

/* Print a table into the text or the CSV, if that is wanted, and free it. Lines of CSV end in
 * `line_end`. _publish tells of short memory. */
void neph_publication_table(struct neph_publication *publication, struct neph_table *table);
void neph_publication_csv(struct neph_publication *publication, const char *line_end,
                          struct neph_table *table);

/* Files, each whole or not at all, a chart only if something is drawn; then stdout.
 * NEPH_ERR_MEMORY: a stream did not fit; NEPH_ERR_INTERNAL: JSON could not be made; NEPH_ERR_IO;
 * NEPH_ERR_ENGINE: parts broke; else the publication's verdict. */
enum neph_status neph_publication_publish(struct neph_publication *publication,
                                          struct neph_diag *diag);

void neph_publication_finish(struct neph_publication *publication);

#endif
