/* SPDX-License-Identifier: MIT
 *
 * A radix selection: one histogram over the top 11 bits is kept, the bucket that holds a rank is
 * gathered and sorted when it is first asked for.
 */
#include "metrics/select.h"

#include "metrics/vector_math.h"

#include <stdbool.h>
#include <stdlib.h>

enum { TOP_BITS = 11, LOW_BITS = 32 - TOP_BITS, BUCKETS = 1 << TOP_BITS, DIGIT_BITS = 11 };

struct neph_selector {
    const struct neph_key_runs *runs;
    size_t counts[BUCKETS];
    double sums[BUCKETS];
    bool has_sums;
    int open_bucket; /* that `sorted` holds; -1: none */
    uint32_t *sorted, *scratch;
};

static bool count_buckets(struct neph_selector *selector)
{
    /* Four histograms: neighbouring keys are alike, and counting them in one place would wait for
     * the count before. */
    enum { WAYS = 4 };
    uint32_t(*parts)[BUCKETS] = calloc(WAYS, sizeof(*parts));
    if (!parts)
        return false;
    const struct neph_key_runs *runs = selector->runs;
    for (int r = 0; r < runs->run_count; r++) {
        const uint32_t *keys = runs->keys + runs->first[r];
        for (uint32_t i = 0; i < runs->counts[r]; i++)
            parts[i % WAYS][keys[i] >> LOW_BITS]++;
    }
    for (int b = 0; b < BUCKETS; b++)
        for (int w = 0; w < WAYS; w++)
            selector->counts[b] += parts[w][b];
    free(parts);
    return true;
}

enum neph_status neph_selector_create(const struct neph_key_runs *runs,
                                      struct neph_selector **selector, struct neph_diag *diag)
{
    struct neph_selector *created = calloc(1, sizeof(*created));
    if (!created)
        return neph_fail_memory(diag);
    created->runs = runs;
    created->open_bucket = -1;
    const bool counted = count_buckets(created);
    size_t largest = 0;
    for (int b = 0; b < BUCKETS; b++)
        largest = created->counts[b] > largest ? created->counts[b] : largest;
    created->sorted = malloc((largest + 1) * sizeof(*created->sorted));
    created->scratch = malloc((largest + 1) * sizeof(*created->scratch));
    if (!counted || !created->sorted || !created->scratch) {
        neph_selector_destroy(created);
        return neph_fail_memory(diag);
    }
    *selector = created;
    return NEPH_OK;
}

void neph_selector_destroy(struct neph_selector *selector)
{
    if (!selector)
        return;
    free(selector->sorted);
    free(selector->scratch);
    free(selector);
}

/* One pass of a radix sort, least digit first. */
static void sort_digit(const uint32_t *from, uint32_t *to, size_t count, int shift)
{
    size_t starts[1 << DIGIT_BITS] = {0};
    const uint32_t digits = (1u << DIGIT_BITS) - 1;
    for (size_t i = 0; i < count; i++)
        starts[(from[i] >> shift) & digits]++;
    size_t start = 0;
    for (uint32_t d = 0; d <= digits; d++) {
        const size_t here = starts[d];
        starts[d] = start;
        start += here;
    }
    for (size_t i = 0; i < count; i++)
        to[starts[(from[i] >> shift) & digits]++] = from[i];
}

enum { BLOCK = 32 };

/* Copy the keys of a bucket; most blocks of keys hold none of a bucket, and a look at the block is
 * cheaper than one at each key. `to` has room for one more than it gets. */
NEPH_VECTOR static size_t copy_bucket(const uint32_t *restrict keys, size_t key_count, int bucket,
                                      uint32_t *restrict to)
{
    const uint32_t wanted = (uint32_t)bucket;
    size_t count = 0, i = 0;
    for (; i + BLOCK <= key_count; i += BLOCK) {
        uint32_t any = 0;
        for (int k = 0; k < BLOCK; k++)
            any |= keys[i + (size_t)k] >> LOW_BITS == wanted ? 1u : 0u;
        for (size_t k = i; any && k < i + BLOCK; k++) {
            to[count] = keys[k];
            count += keys[k] >> LOW_BITS == wanted;
        }
    }
    for (; i < key_count; i++) {
        to[count] = keys[i];
        count += keys[i] >> LOW_BITS == wanted;
    }
    return count;
}

static void open_bucket(struct neph_selector *selector, int bucket)
{
    if (selector->open_bucket == bucket)
        return;
    const struct neph_key_runs *runs = selector->runs;
    size_t count = 0;
    for (int r = 0; r < runs->run_count; r++)
        count += copy_bucket(runs->keys + runs->first[r], runs->counts[r], bucket,
                             selector->sorted + count);
    sort_digit(selector->sorted, selector->scratch, count, 0); /* the LOW_BITS = 21 in two passes */
    sort_digit(selector->scratch, selector->sorted, count, DIGIT_BITS);
    selector->open_bucket = bucket;
}

uint32_t neph_select_rank(struct neph_selector *selector, size_t rank)
{
    int bucket = 0;
    while (rank >= selector->counts[bucket])
        rank -= selector->counts[bucket++];
    open_bucket(selector, bucket);
    return selector->sorted[rank];
}

double neph_select_percentile(struct neph_selector *selector, double share)
{
    const double position = (double)(selector->runs->key_count - 1) * share;
    const size_t rank = (size_t)position;
    const double below = neph_key_value(neph_select_rank(selector, rank));
    if (rank + 1 >= selector->runs->key_count)
        return below;
    const double above = neph_key_value(neph_select_rank(selector, rank + 1));
    return below + (position - (double)rank) * (above - below);
}

static void sum_buckets(struct neph_selector *selector)
{
    if (selector->has_sums)
        return;
    const struct neph_key_runs *runs = selector->runs;
    for (int r = 0; r < runs->run_count; r++) {
        const uint32_t *keys = runs->keys + runs->first[r];
        for (uint32_t i = 0; i < runs->counts[r]; i++)
            selector->sums[keys[i] >> LOW_BITS] += neph_key_value(keys[i]);
    }
    selector->has_sums = true;
}

double neph_select_weighted(struct neph_selector *selector, double share)
{
    sum_buckets(selector);
    double total = 0.0;
    for (int b = 0; b < BUCKETS; b++)
        total += selector->sums[b];
    int bucket = 0, last = 0;
    double running = 0.0;
    for (; bucket < BUCKETS && running + selector->sums[bucket] <= share * total; bucket++) {
        running += selector->sums[bucket];
        last = selector->counts[bucket] > 0 ? bucket : last;
    }
    if (bucket == BUCKETS) /* a share of 1, or nothing but zeros */
        bucket = last;
    open_bucket(selector, bucket);
    for (size_t i = 0; i < selector->counts[bucket]; i++) {
        running += neph_key_value(selector->sorted[i]);
        if (running > share * total)
            return neph_key_value(selector->sorted[i]);
    }
    const size_t count = selector->counts[bucket];
    return count > 0 ? neph_key_value(selector->sorted[count - 1]) : 0.0;
}
