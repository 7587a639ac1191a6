/* SPDX-License-Identifier: MIT */
#include "scenes/shadows.h"

#include <math.h>
#include <string.h>

/* The first shadow that ends at t or behind it. */
static int find_first_ending(const struct neph_shadows *shadows, double t_m)
{
    int low = 0, high = shadows->count;
    while (low < high) {
        const int middle = (low + high) / 2;
        if (shadows->at_m[middle].high < t_m)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* Replaces `removed` entries from `at` on by one. */
static void replace(struct neph_shadows *shadows, int at, int removed, struct neph_interval by_m)
{
    struct neph_interval *place = &shadows->at_m[at];
    memmove(place + 1, place + removed,
            (size_t)(shadows->count - at - removed) * sizeof(shadows->at_m[0]));
    *place = by_m;
    shadows->count += 1 - removed;
}

static void join_nearest(struct neph_shadows *shadows)
{
    int nearest = 0;
    double least_m = INFINITY;
    for (int i = 0; i + 1 < shadows->count; i++) {
        const double gap_m = shadows->at_m[i + 1].low - shadows->at_m[i].high;
        if (gap_m < least_m) {
            least_m = gap_m;
            nearest = i;
        }
    }
    replace(shadows, nearest, 2,
            (struct neph_interval){shadows->at_m[nearest].low, shadows->at_m[nearest + 1].high});
}

void neph_shadows_add(struct neph_shadows *shadows, double low_m, double high_m)
{
    if (shadows->count == NEPH_SHADOWS_MAX)
        join_nearest(shadows);
    const int first = find_first_ending(shadows, low_m);
    int behind = first;
    while (behind < shadows->count && shadows->at_m[behind].low <= high_m)
        behind++;
    if (behind > first) {
        low_m = fmin(low_m, shadows->at_m[first].low);
        high_m = fmax(high_m, shadows->at_m[behind - 1].high);
    }
    replace(shadows, first, behind - first, (struct neph_interval){low_m, high_m});
}

bool neph_shadows_cover(const struct neph_shadows *shadows, double low_m, double high_m)
{
    const int first = find_first_ending(shadows, high_m);
    return first < shadows->count && shadows->at_m[first].low <= low_m;
}
