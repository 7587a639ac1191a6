/* SPDX-License-Identifier: MIT
 *
 * Radix selection. One histogram over the top 16 bits is kept, with 128 buckets per octave, so that
 * a bucket contains few keys. The bucket of a requested rank is gathered at the first request, and
 * counted by its next 8 bits, then by its last 8 bits. Nothing is sorted. A crowded bucket, such as
 * the one of values just below 1, is counted in place, and only a part of it is gathered. Buckets
 * that are expected to be needed are gathered together.
 */
#include "metrics/select.h"

#include "metrics/vector_math.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum {
    TOP_BITS = 16,
    MIDDLE_BITS = 8,
    LAST_BITS = 8,
    LOW_BITS = MIDDLE_BITS + LAST_BITS,
    BUCKETS = 1 << TOP_BITS,
    MIDDLES = 1 << MIDDLE_BITS,
    LASTS = 1 << LAST_BITS,
    CROWD_SHARE = 16, /* a bucket with more than 1 / 16 of all keys is crowded */
    TOGETHER = 3,     /* buckets that are gathered in one pass */
};

/* A set of keys: those with bits above `shift` equal to one of these. */
struct wanted {
    uint32_t upper[TOGETHER];
    int shift; /* 0: none */
};

struct neph_selector {
    const struct neph_key_runs *runs;
    size_t below[BUCKETS + 1];      /* number of keys in lower buckets */
    double sums_below[BUCKETS + 1]; /* sum of the values in lower buckets */
    bool has_sums;
    int open_bucket;        /* bucket that `middle` counts; -1: none */
    int open_middle;        /* middle digit of the open bucket that `last` counts; -1: none */
    struct wanted gathered; /* the open bucket and others; if it is crowded, only its open middle
                             * digit */
    uint32_t *members;      /* the gathered keys; owned */
    size_t member_count, member_room;
    uint32_t middle[MIDDLES], last[LASTS];
};

/* Count into two histograms alternately: neighbouring keys are often equal, and counting them in
 * one would wait for the previous count. */
static void count_run(const uint32_t *restrict keys, size_t count, uint32_t *restrict even,
                      uint32_t *restrict odd)
{
    size_t i = 0;
    for (; i + 4 <= count; i += 4) {
        even[keys[i] >> LOW_BITS]++;
        odd[keys[i + 1] >> LOW_BITS]++;
        even[keys[i + 2] >> LOW_BITS]++;
        odd[keys[i + 3] >> LOW_BITS]++;
    }
    for (; i < count; i++)
        even[keys[i] >> LOW_BITS]++;
}

/* Returns the number of keys in the fullest bucket; -1: memory is short. */
static long long count_buckets(struct neph_selector *selector)
{
    uint32_t *even = calloc(2 * (size_t)BUCKETS, sizeof(*even));
    if (!even)
        return -1;
    uint32_t *odd = even + BUCKETS;
    const struct neph_key_runs *runs = selector->runs;
    for (int r = 0; r < runs->run_count; r++)
        count_run(runs->keys + runs->first[r], runs->counts[r], even, odd);
    size_t largest = 0;
    for (int b = 0; b < BUCKETS; b++) {
        const size_t count = (size_t)even[b] + odd[b];
        selector->below[b + 1] = selector->below[b] + count;
        largest = count > largest ? count : largest;
    }
    free(even);
    return (long long)largest;
}

static size_t bucket_key_count(const struct neph_selector *selector, int bucket)
{
    return selector->below[bucket + 1] - selector->below[bucket];
}

/* Allocate memory for so many members; the current ones are lost. */
static bool make_room(struct neph_selector *selector, size_t room)
{
    if (room <= selector->member_room)
        return true;
    uint32_t *members = malloc(room * sizeof(*members));
    if (!members)
        return false;
    free(selector->members);
    selector->members = members;
    selector->member_room = room;
    selector->gathered.shift = 0;
    return true;
}

enum neph_status neph_selector_create(const struct neph_key_runs *runs,
                                      struct neph_selector **selector, struct neph_diag *diag)
{
    struct neph_selector *created = malloc(sizeof(*created)); /* large; most of it is used later */
    if (!created)
        return neph_fail_memory(diag);
    created->runs = runs;
    created->has_sums = false;
    created->open_bucket = created->open_middle = -1;
    created->gathered.shift = 0;
    created->members = NULL;
    created->member_room = 0;
    created->below[0] = 0;
    const long long largest = count_buckets(created);
    if (largest < 0 || !make_room(created, (size_t)largest + 1)) {
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
    free(selector->members);
    free(selector);
}

enum { BLOCK = 32 };

__attribute__((always_inline)) static inline bool is_wanted(uint32_t key, struct wanted wanted)
{
    const uint32_t upper = key >> wanted.shift;
    return (upper == wanted.upper[0]) | (upper == wanted.upper[1]) | (upper == wanted.upper[2]);
}

/* Copy the wanted keys of a run. Most blocks of keys contain none, and testing a block is cheaper
 * than testing each key. `to` needs space for one more key than it gets. */
NEPH_VECTOR static size_t copy_run(const uint32_t *restrict keys, size_t key_count,
                                   const struct wanted *these, uint32_t *restrict to)
{
    const struct wanted wanted = *these;
    size_t count = 0, i = 0;
    for (; i + BLOCK <= key_count; i += BLOCK) {
        uint32_t any = 0;
        for (int k = 0; k < BLOCK; k++)
            any |= is_wanted(keys[i + (size_t)k], wanted) ? 1u : 0u;
        for (size_t k = i; any && k < i + BLOCK; k++) {
            to[count] = keys[k];
            count += is_wanted(keys[k], wanted);
        }
    }
    for (; i < key_count; i++) {
        to[count] = keys[i];
        count += is_wanted(keys[i], wanted);
    }
    return count;
}

static void gather(struct neph_selector *selector, const struct wanted *wanted)
{
    const struct neph_key_runs *runs = selector->runs;
    selector->member_count = 0;
    for (int r = 0; r < runs->run_count; r++)
        selector->member_count += copy_run(runs->keys + runs->first[r], runs->counts[r], wanted,
                                           selector->members + selector->member_count);
    selector->gathered = *wanted;
}

static struct wanted only(uint32_t upper, int shift)
{
    return (struct wanted){{upper, upper, upper}, shift};
}

static bool has_gathered(const struct neph_selector *selector, int bucket)
{
    return selector->gathered.shift == LOW_BITS &&
           is_wanted((uint32_t)bucket << LOW_BITS, selector->gathered);
}

static void gather_bucket(struct neph_selector *selector, int bucket)
{
    const struct wanted wanted = only((uint32_t)bucket, LOW_BITS);
    if (!has_gathered(selector, bucket))
        gather(selector, &wanted);
}

static void count_middles(const uint32_t *keys, size_t count, uint32_t bucket, uint32_t *middles)
{
    for (size_t i = 0; i < count; i++)
        middles[(keys[i] >> LAST_BITS) & (MIDDLES - 1)] += keys[i] >> LOW_BITS == bucket;
}

static bool is_crowded(const struct neph_selector *selector, int bucket)
{
    return bucket_key_count(selector, bucket) > selector->runs->key_count / CROWD_SHARE;
}

/* Count the keys of a bucket by their next digit. */
static void open_bucket(struct neph_selector *selector, int bucket)
{
    if (selector->open_bucket == bucket)
        return;
    const struct neph_key_runs *runs = selector->runs;
    memset(selector->middle, 0, sizeof(selector->middle));
    if (is_crowded(selector, bucket)) {
        for (int r = 0; r < runs->run_count; r++)
            count_middles(runs->keys + runs->first[r], runs->counts[r], (uint32_t)bucket,
                          selector->middle);
    } else {
        gather_bucket(selector, bucket);
        count_middles(selector->members, selector->member_count, (uint32_t)bucket,
                      selector->middle);
    }
    selector->open_bucket = bucket;
    selector->open_middle = -1;
}

/* Count the keys of the open bucket with this middle digit by their last one. */
static void open_middle(struct neph_selector *selector, int middle)
{
    if (selector->open_middle == middle)
        return;
    const uint32_t upper = ((uint32_t)selector->open_bucket << MIDDLE_BITS) | (uint32_t)middle;
    const struct wanted wanted = only(upper, LAST_BITS);
    if (is_crowded(selector, selector->open_bucket))
        gather(selector, &wanted);
    memset(selector->last, 0, sizeof(selector->last));
    for (size_t i = 0; i < selector->member_count; i++)
        selector->last[selector->members[i] & (LASTS - 1)] += selector->members[i] >> LAST_BITS ==
                                                              upper;
    selector->open_middle = middle;
}

static uint32_t key_from(const struct neph_selector *selector, int last)
{
    return ((uint32_t)selector->open_bucket << LOW_BITS) |
           ((uint32_t)selector->open_middle << LAST_BITS) | (uint32_t)last;
}

/* By bisection: the last non-empty bucket with at most `rank` keys below it. */
static int bucket_of_rank(const struct neph_selector *selector, size_t rank)
{
    int first = 0, end = BUCKETS;
    while (end - first > 1) {
        const int middle = first + (end - first) / 2;
        if (selector->below[middle] <= rank)
            first = middle;
        else
            end = middle;
    }
    return first;
}

uint32_t neph_select_rank(struct neph_selector *selector, size_t rank)
{
    const int bucket = bucket_of_rank(selector, rank);
    open_bucket(selector, bucket);
    rank -= selector->below[bucket];
    int middle = 0, last = 0;
    while (rank >= selector->middle[middle])
        rank -= selector->middle[middle++];
    open_middle(selector, middle);
    while (rank >= selector->last[last])
        rank -= selector->last[last++];
    return key_from(selector, last);
}

static double percentile_position(const struct neph_selector *selector, double share)
{
    return (double)(selector->runs->key_count - 1) * share;
}

enum neph_status neph_select_expect(struct neph_selector *selector, const double *shares, int count,
                                    struct neph_diag *diag)
{
    struct wanted wanted = {.shift = LOW_BITS};
    size_t room = 1;
    int found = 0;
    for (int i = 0; i < count && found < TOGETHER; i++) {
        const int bucket = bucket_of_rank(selector,
                                          (size_t)percentile_position(selector, shares[i]));
        if (is_crowded(selector, bucket))
            continue;
        wanted.upper[found++] = (uint32_t)bucket;
        room += bucket_key_count(selector, bucket);
    }
    if (found < 2)
        return NEPH_OK;
    for (; found < TOGETHER; found++)
        wanted.upper[found] = wanted.upper[0];
    if (!make_room(selector, room))
        return neph_fail_memory(diag);
    selector->open_bucket = selector->open_middle = -1;
    gather(selector, &wanted);
    return NEPH_OK;
}

double neph_select_percentile(struct neph_selector *selector, double share)
{
    const double position = percentile_position(selector, share);
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
    double *sums = selector->sums_below + 1;
    memset(selector->sums_below, 0, sizeof(selector->sums_below));
    const struct neph_key_runs *runs = selector->runs;
    for (int r = 0; r < runs->run_count; r++) {
        const uint32_t *keys = runs->keys + runs->first[r];
        for (uint32_t i = 0; i < runs->counts[r]; i++)
            sums[keys[i] >> LOW_BITS] += neph_key_value(keys[i]);
    }
    for (int b = 1; b < BUCKETS; b++)
        sums[b] += sums[b - 1];
    selector->has_sums = true;
}

/* By bisection: the first bucket at which the running sum exceeds `target`, or BUCKETS. */
static int bucket_of_sum(const struct neph_selector *selector, double target)
{
    int first = 0, end = BUCKETS;
    while (first < end) {
        const int middle = first + (end - first) / 2;
        if (selector->sums_below[middle + 1] <= target)
            first = middle + 1;
        else
            end = middle;
    }
    return first;
}

/* In the open bucket: the first key with a running sum above `target`, or its last key. */
static double first_above(struct neph_selector *selector, double target)
{
    double sums[MIDDLES] = {0.0}, running = 0.0;
    const uint32_t bucket = (uint32_t)selector->open_bucket;
    gather_bucket(selector, selector->open_bucket);
    for (size_t i = 0; i < selector->member_count; i++) {
        const uint32_t key = selector->members[i];
        if (key >> LOW_BITS == bucket)
            sums[(key >> LAST_BITS) & (MIDDLES - 1)] += neph_key_value(key);
    }
    int middle = 0, found = 0;
    for (int m = 0; m < MIDDLES; m++)
        middle = selector->middle[m] > 0 ? m : middle;
    for (int m = 0; m < middle; m++) { /* the last one absorbs rounding errors */
        if (running + sums[m] > target) {
            middle = m;
            break;
        }
        running += sums[m];
    }
    open_middle(selector, middle);
    for (int last = 0; last < LASTS; last++) {
        if (selector->last[last] == 0)
            continue;
        found = last;
        running += (double)selector->last[last] * neph_key_value(key_from(selector, last));
        if (running > target)
            break;
    }
    return bucket_key_count(selector, selector->open_bucket) > 0
               ? neph_key_value(key_from(selector, found))
               : 0.0;
}

double neph_select_weighted(struct neph_selector *selector, double share)
{
    sum_buckets(selector);
    const double target = share * selector->sums_below[BUCKETS];
    const int bucket = bucket_of_sum(selector, target);
    if (bucket == BUCKETS) /* a share of 1, or only zeros: the largest value */
        return selector->runs->key_count > 0
                   ? neph_key_value(neph_select_rank(selector, selector->runs->key_count - 1))
                   : 0.0;
    open_bucket(selector, bucket);
    return first_above(selector, target - selector->sums_below[bucket]);
}
