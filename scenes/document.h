/* SPDX-License-Identifier: MIT
 *
 * A YAML file as a tree with lines and columns. Private to scenes/.
 */
#ifndef NEPH_SCENES_DOCUMENT_H
#define NEPH_SCENES_DOCUMENT_H

#include "base/status.h"

#include <stddef.h>
#include <yaml.h>

#define NEPH_DOCUMENT_MAX_BYTES (1024 * 1024)
#define NEPH_DOCUMENT_DEPTH_MAX 16 /* a scene needs 6 */

struct neph_document {
    const char *file; /* borrowed; for diagnostics */
    yaml_document_t yaml;
};

/* Parses one YAML document. Refuses features that scenes do not use: an empty file, a second
 * document, anchors and aliases, tags, keys that are lists, NUL characters, deep nesting. Free with
 * neph_document_finish(). */
enum neph_status neph_document_init(struct neph_document *document, const char *file,
                                    const char *text, size_t size, int depth_max,
                                    struct neph_diag *diag);

void neph_document_finish(struct neph_document *document);

yaml_node_t *neph_document_root(struct neph_document *document);

/* The node of a path such as "media[0].homogeneous.albedo[2]", or of its longest existing part. */
yaml_node_t *neph_document_find(struct neph_document *document, const char *path);

/* The node of exactly that path; NULL when the file has only a part of it. */
yaml_node_t *neph_document_find_exact(struct neph_document *document, const char *path);

/* Replaces a scalar by a number. NEPH_ERR_MEMORY. */
enum neph_status neph_document_put_number(yaml_node_t *scalar, double number,
                                          struct neph_diag *diag);

/* The value of a key of a mapping; NULL when the key is absent. */
yaml_node_t *neph_document_value(struct neph_document *document, const yaml_node_t *mapping,
                                 const char *key, size_t key_size);

/* A scalar's text; always NUL-terminated, without inner NUL. */
const char *neph_document_text(const yaml_node_t *scalar);

/* Adds the position of a node to a diag that has a message. */
void neph_document_locate(const struct neph_document *document, const yaml_node_t *node,
                          struct neph_diag *diag);

/* A short printable copy of a user's text for a message: no control characters, no bidirectional
 * formatting characters, at most 60 bytes. Returns `buffer`. */
#define NEPH_QUOTE_SIZE 72
const char *neph_document_quote(const char *text, char buffer[NEPH_QUOTE_SIZE]);

#endif
