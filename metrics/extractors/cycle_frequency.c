/* SPDX-License-Identifier: MIT */
#include "metrics/extractors/cycle_frequency.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PERIOD_LIMIT = 65536, CYCLES_NEEDED = 8, DECLARED_CYCLES_NEEDED = 4 };

const char neph_cycle_not_apart[] =
    "these frames do not separate it from another period that was found: use more frames";

int neph_cycle_longest(int frame_count)
{
    const int longest = frame_count / CYCLES_NEEDED;
    return longest < NEPH_CYCLE_PERIOD_MAX ? longest : NEPH_CYCLE_PERIOD_MAX;
}

/* ---- declared periods ------------------------------------------------------------------------ */

/* Copy a name without surrounding spaces. */
static void copy_name(const char *begin, const char *end, char name[NEPH_CYCLE_NAME_MAX])
{
    while (begin < end && isspace((unsigned char)*begin))
        begin++;
    while (end > begin && isspace((unsigned char)end[-1]))
        end--;
    snprintf(name, NEPH_CYCLE_NAME_MAX, "%.*s", (int)(end - begin), begin);
}

enum neph_status neph_cycle_parse(const char *text, struct neph_cycle_declared *declared,
                                  struct neph_diag *diag)
{
    struct neph_cycle_declared parsed = {.count = 0};
    for (const char *item = text; *item; item += *item == ',') {
        const size_t length = strcspn(item, ",");
        const char *end = item + length, *number = end;
        while (number > item && isdigit((unsigned char)number[-1]))
            number--;
        const long period = number < end ? strtol(number, NULL, 10) : 0;
        if (period < NEPH_CYCLE_PERIOD_MIN || period > PERIOD_LIMIT ||
            parsed.count == NEPH_CYCLE_DECLARED_MAX)
            return neph_fail(diag, NEPH_ERR_INPUT,
                             "cycles are declared as at most %d of 'NAME FRAMES' with commas "
                             "between, 2 to %d frames each, not '%s'",
                             NEPH_CYCLE_DECLARED_MAX, PERIOD_LIMIT, text);
        copy_name(item, number, parsed.names[parsed.count]);
        parsed.periods[parsed.count++] = (int)period;
        item = end;
    }
    *declared = parsed;
    return NEPH_OK;
}

static int common_divisor(int a, int b)
{
    while (b > 0) {
        const int rest = a % b;
        a = b;
        b = rest;
    }
    return a;
}

static long long beat_of(int a, int b)
{
    return (long long)a / common_divisor(a, b) * b;
}

void neph_cycle_explain(const struct neph_cycle_declared *declared, int period, char *text,
                        size_t size)
{
    const int count = declared->count, *periods = declared->periods;
    long long shortest = 0;
    text[0] = '\0';
    for (int i = 0; i < count; i++)
        if (periods[i] % period == 0 && (shortest == 0 || periods[i] < shortest)) {
            shortest = periods[i];
            snprintf(text, size, "%s", declared->names[i]);
        }
    const bool is_known = shortest > 0;
    for (int i = 0; i < count && !is_known; i++)
        for (int j = 0; j < i; j++) {
            const long long beat = beat_of(periods[i], periods[j]);
            if (beat % period == 0 && (shortest == 0 || beat < shortest)) {
                shortest = beat;
                snprintf(text, size, "beat of %s and %s", declared->names[j], declared->names[i]);
            }
        }
}

/* ---- candidates ------------------------------------------------------------------------------ */

static int by_frequency(const void *a, const void *b)
{
    const struct neph_cycle_frequency *x = a, *y = b;
    const long long left = (long long)x->m * y->period, right = (long long)y->m * x->period;
    return (left > right) - (left < right);
}

/* Set wanted[P] for the declared periods and their beats up to `limit`. */
static void want_declared(int limit, const struct neph_cycle_declared *declared, bool *wanted)
{
    for (int i = 0; i < declared->count; i++)
        for (int j = 0; j <= i; j++) {
            const long long beat = beat_of(declared->periods[i], declared->periods[j]);
            if (beat <= limit)
                wanted[beat] = true;
        }
}

enum neph_status neph_cycle_candidates(int frame_count, const struct neph_cycle_declared *declared,
                                       struct neph_arena *memory,
                                       struct neph_cycle_frequencies *frequencies,
                                       struct neph_diag *diag)
{
    const int limit = frame_count / DECLARED_CYCLES_NEEDED;
    bool *wanted = neph_arena_zeroed(memory, (size_t)limit + 1, sizeof(*wanted));
    if (!wanted)
        return neph_fail_memory(diag);
    for (int period = NEPH_CYCLE_PERIOD_MIN; period <= neph_cycle_longest(frame_count); period++)
        wanted[period] = true;
    want_declared(limit, declared, wanted);
    size_t room = 0;
    for (int period = NEPH_CYCLE_PERIOD_MIN; period <= limit; period++)
        room += wanted[period] ? (size_t)period / 2 : 0;
    struct neph_cycle_frequency *items = neph_arena_zeroed(memory, room + 1, sizeof(*items));
    if (!items)
        return neph_fail_memory(diag);
    int count = 0;
    for (int period = NEPH_CYCLE_PERIOD_MIN; period <= limit; period++)
        for (int m = 1; wanted[period] && 2 * m <= period; m++)
            if (common_divisor(period, m) == 1)
                items[count++] = (struct neph_cycle_frequency){m, period};
    qsort(items, (size_t)count, sizeof(*items), by_frequency);
    *frequencies = (struct neph_cycle_frequencies){items, count};
    return NEPH_OK;
}
