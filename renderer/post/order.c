/* SPDX-License-Identifier: MIT
 *
 * The order of passes in the post-processing chain, and which orders are valid.
 */
#include "renderer/post/chain.h"

#include <stddef.h>

/* Does not compile with a new pass: this file then needs a change. */
_Static_assert(NEPH_POST_PASS_COUNT == 7, "a new kind");

const char *const neph_post_pass_names[NEPH_POST_PASS_COUNT + 1] = {
    [NEPH_POST_EXPOSURE] = "exposure",
    [NEPH_POST_BLOOM] = "bloom",
    [NEPH_POST_TONE_MAPPING] = "tone_mapping",
    [NEPH_POST_FXAA] = "fxaa",
    [NEPH_POST_UPSCALE] = "upscale",
    [NEPH_POST_SHARPENING] = "sharpening",
    [NEPH_POST_SECONDARY_UPSCALE] = "secondary_upscale",
};

static const struct {
    enum neph_post_pass before, after;
    const char *why;
} rules[] = {
    {NEPH_POST_EXPOSURE, NEPH_POST_BLOOM, "bloom's threshold applies to exposed light"},
    {NEPH_POST_EXPOSURE, NEPH_POST_TONE_MAPPING, "tone_mapping applies the automatic exposure"},
    {NEPH_POST_BLOOM, NEPH_POST_TONE_MAPPING, "bloom spreads light, not display codes"},
    {NEPH_POST_TONE_MAPPING, NEPH_POST_FXAA, "fxaa works on display codes"},
    {NEPH_POST_TONE_MAPPING, NEPH_POST_SHARPENING, "sharpening works on display codes"},
    {NEPH_POST_UPSCALE, NEPH_POST_SECONDARY_UPSCALE, "the second upscale starts from the first"},
};

struct neph_post_order neph_post_usual_order(void)
{
    struct neph_post_order order = {.count = NEPH_POST_PASS_COUNT};
    for (int i = 0; i < NEPH_POST_PASS_COUNT; i++)
        order.passes[i] = (enum neph_post_pass)i;
    return order;
}

static int place_of(const struct neph_post_order *order, enum neph_post_pass pass)
{
    for (int i = 0; i < order->count; i++)
        if (order->passes[i] == pass)
            return i;
    return -1;
}

const char *neph_post_order_fault(const struct neph_post_order *order, int *at)
{
    for (*at = 0; *at < order->count; ++*at)
        if (place_of(order, order->passes[*at]) != *at)
            return "it is listed twice";
    for (size_t i = 0; i < sizeof(rules) / sizeof(rules[0]); i++) {
        *at = place_of(order, rules[i].before);
        const int after = place_of(order, rules[i].after);
        if (*at >= 0 && after >= 0 && *at > after)
            return rules[i].why;
    }
    return NULL;
}

int neph_post_sequence(const struct neph_post_order *order, const struct neph_settings *settings,
                       const struct neph_post_stage *sequence[NEPH_POST_STAGES_MAX])
{
    const struct neph_post_order usual = neph_post_usual_order();
    const struct neph_post_order *taken = order ? order : &usual;
    int count = 0;
    for (int i = 0; i < taken->count; i++)
        for (const struct neph_post_stage *stage = neph_post_stages; stage->name; stage++)
            if (stage->pass == taken->passes[i] && neph_post_is_on(stage, settings))
                sequence[count++] = stage;
    return count;
}

int neph_post_switch(enum neph_post_pass pass)
{
    const struct neph_post_stage *stage = neph_post_stages;
    while (stage->pass != pass)
        stage++;
    return stage->settings[0];
}
