/* SPDX-License-Identifier: MIT */
#include "harness/study/attribution_value.h"

#include <math.h>

/* Fails to compile when a part is added, as the children of rays are listed here. */
_Static_assert(NEPH_PARTS == 8, "a new kind");

static const neph_part_set rays = 1U << NEPH_PART_RAYS;
static const neph_part_set children = 1U << NEPH_PART_REPROJECTION | 1U << NEPH_PART_DISOCCLUSION |
                                      1U << NEPH_PART_BOX | 1U << NEPH_PART_NOISE;
static const double explained_interaction = 0.15;

bool neph_part_needs_rays(enum neph_attribution_part_id part)
{
    return (children >> part & 1U) != 0;
}

bool neph_part_set_is_state(neph_part_set set)
{
    return (set & rays) != 0 || (set & children) == 0;
}

neph_part_set neph_part_set_without(neph_part_set set, enum neph_attribution_part_id part)
{
    return set & ~(1U << part | (part == NEPH_PART_RAYS ? children : 0U));
}

/* Counts the orders in which parts become real from none to each state, and from each state to all
 * parts; both are 0 for other sets. */
static void count_orders(double before[NEPH_PART_SETS], double after[NEPH_PART_SETS])
{
    before[0] = after[NEPH_PARTS_ALL] = 1.0;
    for (neph_part_set set = 0; set < NEPH_PART_SETS; set++)
        for (int i = 0; i < NEPH_PARTS; i++)
            if (neph_part_set_is_state(set | 1U << i) && (set >> i & 1U) == 0)
                before[set | 1U << i] += before[set];
    for (neph_part_set set = NEPH_PARTS_ALL; set-- > 0;)
        for (int i = 0; i < NEPH_PARTS; i++)
            if (neph_part_set_is_state(set) && (set >> i & 1U) == 0)
                after[set] += after[set | 1U << i];
}

struct neph_attribution_values neph_attribution_divide(const double values[NEPH_PART_SETS])
{
    double before[NEPH_PART_SETS] = {0.0}, after[NEPH_PART_SETS] = {0.0};
    count_orders(before, after);
    const double order_count = before[NEPH_PARTS_ALL];
    struct neph_attribution_values of = {.all = values[NEPH_PARTS_ALL],
                                         .interaction = values[NEPH_PARTS_ALL],
                                         .order_count = (int)order_count};
    for (int i = 0; i < NEPH_PARTS; i++) {
        struct neph_part_values *part = &of.parts[i];
        const neph_part_set own = 1U << i;
        for (neph_part_set set = 0; set < NEPH_PART_SETS; set++) {
            const double orders = (set & own) != 0 ? 0.0 : before[set] * after[set | own];
            if (orders > 0.0)
                part->share += orders / order_count *
                               (values[set | own] - (set ? values[set] : 0.0));
        }
        part->alone = neph_part_needs_rays((enum neph_attribution_part_id)i)
                          ? values[rays | own] - values[rays]
                          : values[own];
        part->without =
            values[neph_part_set_without(NEPH_PARTS_ALL, (enum neph_attribution_part_id)i)];
        of.interaction -= part->alone;
    }
    return of;
}

bool neph_attribution_explains(const struct neph_attribution_values *values)
{
    return fabs(values->interaction) <= explained_interaction * values->all;
}
