/* SPDX-License-Identifier: MIT
 *
 * The results of a command, in the forms that its user wants: an answer of ten lines, a Markdown
 * text with all numbers, CSV, a chart as SVG, and JSON.
 */
#ifndef NEPH_HARNESS_DOCUMENT_PUBLICATION_H
#define NEPH_HARNESS_DOCUMENT_PUBLICATION_H

#include "harness/document/answer.h"
#include "harness/document/table.h"

#include <stdbool.h>
#include <stdio.h>

/* The destinations of the forms. */
struct neph_publication_places {
    const char *markdown, *csv, *chart; /* files; NULL: not wanted; csv "-": stdout, in place of the
                                         * text */
    const char *document;               /* file of the JSON; NULL: not wanted */
    bool json;                          /* JSON on stdout, in place of the text */
    bool all;                           /* print the text on stdout even if there is an answer */
    bool quiet;                         /* print only the first line of an answer */
    struct neph_answer_rest rest;       /* last line of the answer */
};

enum { NEPH_PUBLICATION_STREAMS = 3 };

struct neph_publication {
    const struct neph_publication_places *places; /* borrowed */
    FILE *text, *csv, *chart;                     /* streams into memory; NULL: not wanted */
    struct neph_answer answer; /* on stdout in place of the text; empty: the text is printed */
    json_t *json;              /* for places->json and ->document; owned */
    int broken_count;          /* number of broken parts: an error after all is published, .. */
    const char *broken_words;  /* .. "takes broke; their cells say why" */
    enum neph_status verdict;  /* error of the results, returned after all is published, .. */
    struct neph_diag reason;   /* .. and its message */
    struct neph_arena arena;   /* texts that live until all is published; its memory error also
                                * stands for the tables */
    struct {
        char *text;
        size_t size;
    } kept[NEPH_PUBLICATION_STREAMS];
};

/* Open the wanted streams. NEPH_ERR_MEMORY. Always end with neph_publication_finish(). */
enum neph_status neph_publication_begin(const struct neph_publication_places *places,
                                        struct neph_publication *publication,
                                        struct neph_diag *diag);

/* Print a table into the text or the CSV, if that is wanted, and free the table. CSV lines end in
 * `line_end`. Short memory is reported by neph_publication_publish(). */
void neph_publication_table(struct neph_publication *publication, struct neph_table *table);
void neph_publication_csv(struct neph_publication *publication, const char *line_end,
                          struct neph_table *table);

/* Write the files, each whole or not at all, and a chart only if something is drawn; then print to
 * stdout. NEPH_ERR_MEMORY: a stream did not fit. NEPH_ERR_INTERNAL: JSON could not be made.
 * NEPH_ERR_IO. NEPH_ERR_ENGINE: parts broke. Otherwise the publication's verdict is returned. */
enum neph_status neph_publication_publish(struct neph_publication *publication,
                                          struct neph_diag *diag);

void neph_publication_finish(struct neph_publication *publication);

#endif
