/* SPDX-License-Identifier: MIT
 *
 * The study of the display chain: its chains are valid, and sequences with known error and flicker
 * give these values.
 */
#include "tests/harness/image_test.h"

#include "harness/engines/vulkan_device.h"
#include "harness/study/post_measure.h"
#include "harness/study/svg.h"

enum { width = 24, height = 16, pixels = width * height, frames = 24, warm_up = 8 };

static struct neph_settings parse_test_settings(const char *text)
{
    struct neph_settings settings = neph_options_default(neph_post_options);
    char *copy = strdup(text), *rest = copy;
    for (char *word; (word = strsep(&rest, " "));) {
        struct neph_diag diag = {0};
        if (word[0])
            neph_assert_ok(neph_options_set(neph_post_options, "test", word, &settings, &diag),
                           &diag);
    }
    free(copy);
    return settings;
}

static void test_the_chains_make_sense(void **state)
{
    for (const struct neph_post_row *row = neph_post_rows; row->name; row++) {
        struct neph_settings settings = parse_test_settings(row->settings);
        struct neph_diag diag = {0};
        settings.values[POST_TONE] = 1.0;
        neph_assert_ok(neph_post_check(&settings, &diag), &diag);
        for (const struct neph_post_row *other = neph_post_rows; other < row; other++)
            assert_string_not_equal(row->name, other->name);
        assert_true(row->is_of_whole || row == neph_post_rows || !row[-1].is_of_whole);
    }
}

/* A mark as SVG, with all colours except white replaced by one. */
static char *grey_mark(int number)
{
    char *text = NULL;
    size_t size;
    FILE *file = open_memstream(&text, &size);
    neph_svg_print_mark(number, 1.0, 2.0, file);
    fclose(file);
    for (char *c = strchr(text, '#'); c; c = strchr(c + 1, '#'))
        if (c[4] != '"')
            memset(c + 1, '0', 6);
    return text;
}

static void test_marks_differ_without_their_colours(void **state)
{
    char *marks[NEPH_SVG_MARKS];
    for (int i = 0; i < NEPH_SVG_MARKS; i++) {
        marks[i] = grey_mark(i);
        for (int other = 0; other < i; other++)
            assert_string_not_equal(marks[i], marks[other]);
    }
    for (int i = 0; i < NEPH_SVG_MARKS; i++)
        free(marks[i]);
}

/* --- sequences -------------------------------------------------------------------------------- */

struct film {
    struct neph_vulkan *vulkan;
    struct neph_image *tests[frames], *reference;
    struct neph_post_sequence_pair film;
};

/* A reference of 0.2, and a test with alternating errors. */
static void open_film(struct film *f, double even, double odd)
{
    struct neph_diag diag = {0};
    *f = (struct film){.reference = grey_image(width, height, 0.2)};
    for (int i = 0; i < frames; i++)
        f->tests[i] = grey_image(width, height, i % 2 ? odd : even);
    neph_assert_ok(neph_vulkan_open(&f->vulkan, &diag), &diag);
    f->film = (struct neph_post_sequence_pair){
        .tests = (const struct neph_image *const *)f->tests,
        .references = (const struct neph_image *const *)&f->reference,
        .count = frames,
        .reference_count = 1,
        .warm_up = warm_up,
        .frame_rate_hz = 30.0,
        .seed = 3};
}

static void close_film(struct film *f)
{
    for (int i = 0; i < frames; i++)
        neph_image_destroy(f->tests[i]);
    neph_image_destroy(f->reference);
    neph_vulkan_destroy(f->vulkan);
}

static struct neph_post_numbers measured(struct film *f, const char *text)
{
    const struct neph_settings settings = parse_test_settings(text);
    struct neph_post_numbers numbers;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_post_measure(f->vulkan, &f->film, &settings, &numbers, &diag), &diag);
    return numbers;
}

/* An error of 10 % with alternating sign: an rms of 10 % with a change of 20 % from frame to frame.
 */
static void test_known_values_are_measured(void **state)
{
    struct film f;
    open_film(&f, 0.22, 0.18);
    const struct neph_post_numbers numbers = measured(&f, "tone=on tone_map=none");
    neph_assert_close(numbers.scene_error, 0.1, 1e-5, 0.0);
    neph_assert_close(numbers.scene_change, 0.2, 1e-5, 0.0);
    assert_true(numbers.flip > 0.0 && numbers.seen > 1.0);
    /* A flatter curve hides a part; the light before it is unchanged. */
    const struct neph_post_numbers flatter = measured(&f, "tone=on tone_map=agx exposure_ev=3");
    assert_true(flatter.seen < 0.5 * numbers.seen && flatter.flip < numbers.flip);
    assert_true(flatter.scene_error == numbers.scene_error);
    /* Twice the brightness at the same contrast is at least as visible. */
    const struct neph_post_numbers hdr = measured(&f, "tone=on tone_map=none encode=pq");
    assert_true(isnan(hdr.flip) && hdr.seen > numbers.seen);
    close_film(&f);
}

static void test_a_true_sequence_has_only_grain(void **state)
{
    struct film f;
    open_film(&f, 0.2, 0.2);
    const struct neph_post_numbers still = measured(&f, "tone=on tone_map=unreal bloom=conserving "
                                                        "auto_exposure=on upscale=bilinear");
    assert_true(still.scene_error == 0.0 && still.flip == 0.0 && still.luma_change == 0.0);
    /* Uniform noise of 8 steps of 8 bits, new in each frame: sqrt(2 / 12) times its range. */
    const struct neph_post_numbers grain = measured(&f, "tone=on tone_map=none grain=8");
    neph_assert_close(grain.luma_change, 8.0 / 255.0 * sqrt(1.0 / 6.0), 0.03, 0.0);
    close_film(&f);
}

/* A frame brighter than the reference is displayed equally bright once the exposure has adapted. */
static void test_adaptation_removes_a_gain(void **state)
{
    struct film f;
    open_film(&f, 0.3, 0.3);
    const struct neph_post_numbers fixed = measured(&f, "tone=on tone_map=none");
    const struct neph_post_numbers adapted = measured(&f, "tone=on tone_map=none auto_exposure=on");
    assert_true(fixed.flip > 0.05 && adapted.flip < 0.01);
    close_film(&f);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_the_chains_make_sense),
        cmocka_unit_test(test_marks_differ_without_their_colours),
    };
    const struct CMUnitTest engines[] = {
        cmocka_unit_test(test_known_values_are_measured),
        cmocka_unit_test(test_a_true_sequence_has_only_grain),
        cmocka_unit_test(test_adaptation_removes_a_gain),
    };
    return neph_test_wants_engines(argc, argv) ? cmocka_run_group_tests(engines, NULL, NULL)
                                               : cmocka_run_group_tests(tests, NULL, NULL);
}
