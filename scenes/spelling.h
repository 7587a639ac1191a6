/* SPDX-License-Identifier: MIT
 *
 * Suggestions for misspelled words. Private to scenes/.
 */
#ifndef NEPH_SCENES_SPELLING_H
#define NEPH_SCENES_SPELLING_H

struct neph_spelling {
    const char *word;    /* as the user wrote it */
    const char *nearest; /* of the words that were offered; NULL: none is near */
    int distance;        /* of the nearest */
};

struct neph_spelling neph_spelling_init(const char *word);

/* Keeps the known word if it is nearer than those before. */
void neph_spelling_offer(struct neph_spelling *spelling, const char *known);

#endif
