/* SPDX-License-Identifier: MIT
 *
 * The sequences of an attribution, without a renderer.
 */
#include "tests/neph_test.h"

#include "harness/engines/engines.h"
#include "harness/study/attribution_plan.h"
#include "renderer/realtime/options.h"

static struct neph_settings parse_settings(const char *words)
{
    const struct neph_engine *engine;
    struct neph_settings settings;
    neph_assert_ok(neph_engine_parse_words(words, "steps=8", &engine, &settings, NULL), NULL);
    return settings;
}

static bool are_equal(const struct neph_settings *a, const struct neph_settings *b, int option)
{
    return memcmp(&a->values[option], &b->values[option], sizeof(a->values[option])) == 0;
}

/* The part that an option belongs to; -1: none. */
static int find_part(int option)
{
    static const int options[] = {
        [NEPH_PART_RAYS] = RT_ORACLE_RAYS,          [NEPH_PART_REPROJECTION] = RT_ORACLE_MOTION,
        [NEPH_PART_DISOCCLUSION] = RT_ORACLE_DEPTH, [NEPH_PART_BOX] = RT_BOX,
        [NEPH_PART_NOISE] = RT_RAY_DITHER,          [NEPH_PART_UPSCALE] = RT_ORACLE_UPSCALE,
    };
    for (int part = 0; part < NEPH_PART_BLUR; part++)
        if (options[part] == option)
            return part;
    return -1;
}

/* A sequence differs from the preset in the settings of exactly its ideal parts; children of ideal
 * rays keep theirs. */
static void check_sequence(const struct neph_settings *preset,
                           const struct neph_attribution_plan *plan, int index)
{
    const struct neph_settings settings = parse_settings(plan->words[index]);
    const neph_part_set state = plan->states[index];
    for (int option = 0; option < RT_SETTING_COUNT; option++) {
        const int part = find_part(option);
        const bool has_rays = (state >> NEPH_PART_RAYS & 1U) != 0;
        const bool is_ideal = part >= 0 && (state >> part & 1U) == 0 &&
                              (has_rays || part == NEPH_PART_RAYS || part == NEPH_PART_UPSCALE);
        if (are_equal(preset, &settings, option) == is_ideal)
            fail_msg("%s: %s", plan->words[index], neph_rt_options[option].name);
    }
}

static void test_34_different_sequences(void **state)
{
    const char *const presets[] = {"ours", "fixed", "seed"}; /* with a box and noise */
    for (size_t p = 0; p < sizeof(presets) / sizeof(presets[0]); p++) {
        struct neph_arena arena = {.last = NULL};
        struct neph_diag diag = {.line = 0};
        struct neph_attribution_plan plan;
        const struct neph_settings preset = parse_settings(presets[p]);
        neph_assert_ok(neph_attribution_plan_make(presets[p], 8, &arena, &plan, &diag), &diag);
        assert_int_equal(plan.count, NEPH_ATTRIBUTION_SEQUENCES);
        assert_string_equal(plan.words[0], presets[p]);
        for (int i = 0; i < plan.count; i++) {
            check_sequence(&preset, &plan, i);
            for (int k = 0; k < i; k++)
                assert_true(plan.states[i] != plan.states[k]);
        }
        neph_arena_finish(&arena);
    }
}

/* Blur and aliasing have references in place of sequences; the first sequences, which have maps,
 * are those that lack one part. */
static void test_sequences_of_states(void **state)
{
    struct neph_arena arena = {.last = NULL};
    struct neph_attribution_plan plan;
    neph_assert_ok(neph_attribution_plan_make("ours", 8, &arena, &plan, NULL), NULL);
    assert_int_equal(neph_attribution_find_sequence(&plan, NEPH_PARTS_ALL), 0);
    for (int part = 0; part < NEPH_PARTS; part++) {
        const neph_part_set without = neph_part_set_without(NEPH_PARTS_ALL,
                                                            (enum neph_attribution_part_id)part);
        assert_int_equal(neph_attribution_find_sequence(&plan, without),
                         part >= NEPH_PART_BLUR ? 0 : part + 1);
    }
    for (neph_part_set set = 0; set < NEPH_PART_SETS; set++)
        assert_int_equal(neph_attribution_find_sequence(&plan, set) < plan.count,
                         neph_part_set_is_state(set));
    assert_int_equal(neph_attribution_find_reference(NEPH_PARTS_ALL), NEPH_IDEALS);
    assert_int_equal(neph_attribution_find_reference(0), NEPH_IDEAL_SEQUENCE);
    assert_int_equal(neph_attribution_find_reference(NEPH_PARTS_ALL & ~(1U << NEPH_PART_BLUR)),
                     NEPH_IDEAL_BLURRED);
    assert_int_equal(neph_attribution_find_reference(NEPH_PARTS_ALL & ~(1U << NEPH_PART_ALIASING)),
                     NEPH_IDEAL_ALIASED);
    assert_string_equal(neph_attribution_find_ideal(&plan),
                        "ours+oracle_rays=on+oracle_upscale=on");
    neph_arena_finish(&arena);
}

static void test_presets_without_an_ideal_are_refused(void **state)
{
    static const struct {
        const char *preset, *why;
    } rows[] = {{"off", "split=none"},
                {"ours+split=none", "split=none"},
                {"svgf", "atrous=on"},
                {"command", "user engine"},
                {"nonesuch", "nonesuch"}};
    for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
        struct neph_arena arena = {.last = NULL};
        struct neph_diag diag = {.line = 0};
        struct neph_attribution_plan plan;
        assert_int_equal(neph_attribution_plan_make(rows[i].preset, 8, &arena, &plan, &diag),
                         NEPH_ERR_USAGE);
        if (!strstr(diag.message, rows[i].why))
            fail_msg("%s: %s", rows[i].preset, diag.message);
        neph_arena_finish(&arena);
    }
}

#include "tests/main.h"
