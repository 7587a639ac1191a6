/* SPDX-License-Identifier: MIT
 *
 * Comparisons that share a pass over the frames, use frames in memory, or keep selected values
 * only: equal to the last bit to a comparison of files by itself.
 */
#include "tests/base/scratch.h"
#include "tests/metrics/synthetic.h"

#include "base/exr.h"
#include "harness/compare/comparison.h"
#include "metrics/extractors/extractors.h"

#include <unistd.h>

enum { WIDTH = 48, HEIGHT = 32, FRAMES = 16, TOGETHER = 3 };

static const struct neph_meter_number wanted[] = {{"seen_contrast", "all"},
                                                  {"seen_contrast", "depth_edge"},
                                                  {"seen_hz", "all"},
                                                  {"rel_rmse", "all"},
                                                  {"p95", "depth_edge"},
                                                  {"std_p95", "depth_edge"},
                                                  {"cycle_noise", "depth_edge"},
                                                  {.metric = NULL}};

/* ---- frames ---------------------------------------------------------------------------------- */

static struct neph_image *make_frame(int frame, bool is_test)
{
    const struct synthetic what = {.width_px = WIDTH,
                                   .height_px = HEIGHT,
                                   .frame = frame,
                                   .seed = is_test ? (uint64_t)frame + 2 : 1,
                                   .is_test = is_test,
                                   .all = !is_test};
    struct neph_image *image = NULL;
    neph_assert_ok(synthetic_create(&what, &image, NULL), NULL);
    return image;
}

static struct neph_sequence make_files(void **state, const char *name, int count, bool is_test)
{
    struct neph_sequence files = {.paths = calloc(FRAMES, sizeof(char *))};
    assert_non_null(files.paths);
    for (; files.count < count; files.count++) {
        char file[32], path[SCRATCH_PATH_MAX];
        struct neph_image *image = make_frame(files.count, is_test);
        snprintf(file, sizeof(file), "%s_%02d.exr", name, files.count);
        files.paths[files.count] = strdup(scratch_path(state, path, file));
        neph_assert_ok(neph_exr_write_plain(path, image, NULL), NULL);
        neph_image_destroy(image);
    }
    return files;
}

static void choose(struct neph_comparison *comparison)
{
    comparison->source = &neph_frame_files;
    static const char *const names[] = {"seen", "cycles", "flicker", "error"};
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
        const struct neph_extractor *extractor = neph_extractor_find(names[i]);
        assert_non_null(extractor);
        comparison->choices[comparison->choice_count++] = (struct neph_meter_choice){
            extractor, neph_options_default(extractor->options)};
    }
}

/* --- values ----------------------------------------------------------------------------------- */

static bool is_same_number(const struct neph_measurement *a, const struct neph_measurement *b)
{
    return a->metric == b->metric && a->quantity == b->quantity && a->frame == b->frame &&
           strcmp(a->mask, b->mask) == 0;
}

static void assert_same_bits(const struct neph_measurement *a, const struct neph_measurement *b)
{
    assert_int_equal(a->defined, b->defined);
    assert_ptr_equal(a->undefined_because, b->undefined_because);
    assert_memory_equal(&a->value, &b->value, sizeof(a->value));
    assert_int_equal(a->interval, b->interval);
    assert_memory_equal(&a->low, &b->low, sizeof(a->low));
    assert_memory_equal(&a->high, &b->high, sizeof(a->high));
    assert_int_equal(a->n, b->n);
    assert_int_equal(a->pixel_count, b->pixel_count);
    assert_int_equal(a->clipped.bound, b->clipped.bound);
    assert_memory_equal(&a->clipped.test, &b->clipped.test, sizeof(a->clipped.test));
    assert_memory_equal(&a->clipped.reference, &b->clipped.reference, sizeof(a->clipped.reference));
}

/* Every requested value of `all` follows in `some`, in order. */
static void assert_wanted_separately(const struct neph_measurements *all,
                                     const struct neph_measurements *some)
{
    int next = 0;
    for (int i = 0; i < all->count; i++) {
        if (!neph_meter_is_wanted(wanted, all->list[i].metric->name, all->list[i].mask))
            continue;
        assert_true(next < some->count);
        assert_true(is_same_number(&all->list[i], &some->list[next]));
        assert_same_bits(&all->list[i], &some->list[next++]);
    }
    assert_int_equal(next, some->count);
    assert_true(next >= 7);
}

/* ---- tests ----------------------------------------------------------------------------------- */

/* Moving and static references; several displays; every third frame is only in a file. */
static void test_joint_and_separate_runs_are_equal(void **state)
{
    struct neph_sequence moving = make_files(state, "moving", FRAMES, false);
    struct neph_sequence still = make_files(state, "still", 1, false);
    struct neph_sequence test = make_files(state, "test", FRAMES, true);
    struct neph_image *images[FRAMES] = {NULL};
    struct neph_comparison comparisons[TOGETHER] = {
        {.reference = moving}, {.reference = still}, {.reference = moving}};
    struct neph_compared alone[TOGETHER] = {{.asked = NULL}},
                         together[TOGETHER] = {{.asked = NULL}};
    for (int i = 0; i < TOGETHER; i++) {
        comparisons[i].test = test;
        comparisons[i].viewing = NEPH_VIEWING_DEFAULTS;
        comparisons[i].viewing.pixels_per_degree = i == 2 ? 20.0 : 60.0;
        comparisons[i].quiet = true;
        choose(&comparisons[i]);
        neph_assert_ok(neph_comparison_run(&comparisons[i], false, &alone[i], NULL), NULL);
    }
    for (int f = 0; f < FRAMES; f++) {
        images[f] = f % 3 ? make_frame(f, true) : NULL;
        if (images[f])
            assert_int_equal(unlink(test.paths[f]), 0);
    }
    for (int i = 0; i < TOGETHER; i++) {
        comparisons[i].test_images = (const struct neph_image *const *)images;
        comparisons[i].wanted = wanted;
    }
    neph_assert_ok(neph_comparisons_run(comparisons, TOGETHER, false, together, NULL), NULL);
    for (int i = 0; i < TOGETHER; i++) {
        assert_wanted_separately(&alone[i].numbers, &together[i].numbers);
        assert_int_equal(alone[i].frozen_count, together[i].frozen_count);
        assert_int_equal(together[i].frame_count, FRAMES);
        neph_compared_finish(&alone[i]);
        neph_compared_finish(&together[i]);
    }
    for (int f = 0; f < FRAMES; f++)
        neph_image_destroy(images[f]);
    neph_sequence_finish(&moving);
    neph_sequence_finish(&still);
    neph_sequence_finish(&test);
}

/* A missing frame ends all comparisons, without results. */
static void test_one_unreadable_file_ends_all(void **state)
{
    struct neph_sequence moving = make_files(state, "moving", FRAMES, false);
    struct neph_sequence test = make_files(state, "test", FRAMES, true);
    struct neph_comparison comparisons[2] = {{.reference = moving}, {.reference = moving}};
    struct neph_compared compared[2] = {{.asked = NULL}};
    struct neph_diag diag = {.line = 0};
    for (int i = 0; i < 2; i++) {
        comparisons[i].test = test;
        comparisons[i].viewing = NEPH_VIEWING_DEFAULTS;
        comparisons[i].quiet = true;
        choose(&comparisons[i]);
    }
    assert_int_equal(unlink(test.paths[5]), 0);
    assert_int_equal(neph_comparisons_run(comparisons, 2, false, compared, &diag),
                     NEPH_ERR_NOT_FOUND);
    assert_non_null(strstr(diag.message, "test_05.exr"));
    for (int i = 0; i < 2; i++) {
        assert_null(compared[i].asked);
        neph_compared_finish(&compared[i]);
    }
    neph_sequence_finish(&moving);
    neph_sequence_finish(&test);
}

/* Writes a frame of a sequence again, with one more channel. */
static void add_channel(const char *path, int frame, const char *name)
{
    struct neph_image *image = make_frame(frame, true);
    float *values = NULL;
    neph_assert_ok(neph_image_add_channel(image, name, &values, NULL), NULL);
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        values[i] = 10.0f;
    neph_assert_ok(neph_exr_write_plain(path, image, NULL), NULL);
    neph_image_destroy(image);
}

/* Channels that must be in all frames of a sequence. The distance of the medium is not in a frame
 * without a medium (stress scene `clouds_away`). */
static void test_channels_that_some_frames_lack(void **state)
{
    static const struct {
        const char *name;
        enum neph_status status;
    } cases[] = {{"volume.distance", NEPH_OK}, {"volume.R", NEPH_ERR_INPUT}};
    struct neph_sequence moving = make_files(state, "moving", FRAMES, false);
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        struct neph_sequence test = make_files(state, cases[i].name, FRAMES, true);
        struct neph_comparison comparison = {.source = &neph_frame_files,
                                             .reference = moving,
                                             .test = test,
                                             .viewing = NEPH_VIEWING_DEFAULTS,
                                             .quiet = true};
        struct neph_compared compared = {.asked = NULL};
        struct neph_diag diag = {.line = 0};
        choose(&comparison);
        add_channel(test.paths[5], 5, cases[i].name);
        assert_int_equal(neph_comparisons_run(&comparison, 1, false, &compared, &diag),
                         cases[i].status);
        assert_true(!cases[i].status || strstr(diag.message, cases[i].name));
        neph_compared_finish(&compared);
        neph_sequence_finish(&test);
    }
    neph_sequence_finish(&moving);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        scratch_test(test_joint_and_separate_runs_are_equal),
        scratch_test(test_one_unreadable_file_ends_all),
        scratch_test(test_channels_that_some_frames_lack),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
