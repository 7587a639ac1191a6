/* SPDX-License-Identifier: MIT */
#include "scenes/spelling.h"

#include <stddef.h>
#include <string.h>

enum { WORD_MAX = 40 };

static int minimum(int a, int b)
{
    return a < b ? a : b;
}

/* Edits (insert, delete, replace, swap neighbours) from one word to another. Damerau 1964,
 * "optimal string alignment" form. */
static int edit_distance(const char *a, const char *b)
{
    const int size_a = (int)strlen(a), size_b = (int)strlen(b);
    if (size_a > WORD_MAX || size_b > WORD_MAX)
        return WORD_MAX;
    int table[WORD_MAX + 1][WORD_MAX + 1];
    for (int i = 0; i <= size_a; i++) {
        for (int j = 0; j <= size_b; j++) {
            if (!i || !j) {
                table[i][j] = i + j;
                continue;
            }
            const int replace = table[i - 1][j - 1] + (a[i - 1] != b[j - 1]);
            int best = minimum(replace, 1 + minimum(table[i - 1][j], table[i][j - 1]));
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                best = minimum(best, table[i - 2][j - 2] + 1);
            table[i][j] = best;
        }
    }
    return table[size_a][size_b];
}

/* "extinction" stands for "extinction_per_m": a missing unit has distance 0. */
static int distance(const char *word, const char *known)
{
    const size_t size = strlen(word);
    return size >= 3 && !strncasecmp(word, known, size) ? 0 : edit_distance(word, known);
}

struct neph_spelling neph_spelling_init(const char *word)
{
    return (struct neph_spelling){word, NULL, WORD_MAX};
}

void neph_spelling_offer(struct neph_spelling *spelling, const char *known)
{
    const int edits = distance(spelling->word, known);
    if (edits >= spelling->distance || edits > 1 + (int)strlen(known) / 4)
        return;
    spelling->distance = edits;
    spelling->nearest = known;
}
