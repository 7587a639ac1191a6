/* SPDX-License-Identifier: MIT
 *
 * What a command has found, in the forms that its user wants: a text that is Markdown, too, CSV,
 * a chart as SVG, and JSON.
 */
#ifndef NEPH_HARNESS_DOCUMENT_PUBLICATION_H
#define NEPH_HARNESS_DOCUMENT_PUBLICATION_H

#include "harness/json.h"

#include <stdbool.h>
#include <stdio.h>

/* Where the forms go. */
struct neph_publication_places {
    const char *markdown, *csv, *chart; /* files; NULL: not wanted */
    bool json;                          /* JSON on stdout, in place of the text */
};

enum { NEPH_PUBLICATION_STREAMS = 3 };

struct neph_publication {
    const struct neph_publication_places *places; /* borrowed */
    FILE *text, *csv, *chart;                     /* into memory; NULL: not wanted */
    json_t *json;                                 /* for places->json; owned */
    int broken_count;         /* parts that broke: an error, once all is published, .. */
    const char *broken_words; /* .. "takes broke; their cells say why" */
    struct {
        char *text;
        size_t size;
    } kept[NEPH_PUBLICATION_STREAMS];
};

/* NEPH_ERR_MEMORY. End with _finish in any case. */
enum neph_status neph_publication_begin(const struct neph_publication_places *places,
                                        struct neph_publication *publication,
                                        struct neph_diag *diag);

/* Files, each whole or not at all; then stdout. NEPH_ERR_MEMORY: a stream did not fit;
 * NEPH_ERR_INTERNAL: JSON could not be made; NEPH_ERR_IO; NEPH_ERR_ENGINE: parts broke. */
enum neph_status neph_publication_publish(struct neph_publication *publication,
                                          struct neph_diag *diag);

void neph_publication_finish(struct neph_publication *publication);

#endif
