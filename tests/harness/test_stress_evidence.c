/* SPDX-License-Identifier: MIT
 *
 * Evidence of the stress tests: the frame, row and consecutive frames that are shown from a
 * sequence, and the content of the images.
 */
#include "tests/base/scratch.h"

#include "base/exr.h"
#include "base/files.h"
#include "base/png.h"
#include "harness/stress/evidence.h"

#include <math.h>

enum { WIDTH = 6, HEIGHT = 5, FRAMES = 80, WORST = 50, ROW = 3 };

/* Dim grey frames, and one reference for all. */
struct sequence {
    struct neph_image *images[FRAMES];
    char *paths[FRAMES]; /* none is read */
    char reference_path[SCRATCH_PATH_MAX], *reference_paths[1];
    struct neph_sequence files, reference;
};

static struct neph_image *grey(float value)
{
    static const char *const names[] = {"R", "G", "B"};
    struct neph_image *image = NULL;
    neph_assert_ok(neph_image_create(WIDTH, HEIGHT, &image, NULL), NULL);
    for (int c = 0; c < 3; c++) {
        float *samples = NULL;
        neph_assert_ok(neph_image_add_channel(image, names[c], &samples, NULL), NULL);
        for (int p = 0; p < WIDTH * HEIGHT; p++)
            samples[p] = value;
    }
    return image;
}

static void put(struct sequence *sequence, int frame, int x, int y, float value)
{
    for (int c = 0; c < 3; c++)
        sequence->images[frame]->channels[c].samples[y * WIDTH + x] = value;
}

static void start(void **state, struct sequence *sequence)
{
    static char nowhere[] = "no such file";
    struct neph_image *reference = grey(0.25f);
    for (int i = 0; i < FRAMES; i++) {
        sequence->images[i] = grey(0.25f);
        sequence->paths[i] = nowhere;
    }
    scratch_path(state, sequence->reference_path, "reference.exr");
    neph_assert_ok(neph_exr_write(sequence->reference_path, reference, NULL), NULL);
    neph_image_destroy(reference);
    sequence->reference_paths[0] = sequence->reference_path;
    sequence->files = (struct neph_sequence){.count = FRAMES, .paths = sequence->paths};
    sequence->reference = (struct neph_sequence){.count = 1, .paths = sequence->reference_paths};
}

static void finish(struct sequence *sequence)
{
    for (int i = 0; i < FRAMES; i++)
        neph_image_destroy(sequence->images[i]);
}

static struct neph_evidence_source make_evidence_source(const struct sequence *sequence)
{
    return (struct neph_evidence_source){
        .files = &sequence->files,
        .images = (const struct neph_image *const *)sequence->images,
        .reference = &sequence->reference,
        .frame_step = 1,
        .exposure_ev = 1.0};
}

static struct neph_evidence find(const struct sequence *sequence)
{
    const struct neph_evidence_source source = make_evidence_source(sequence);
    struct neph_evidence evidence;
    neph_assert_ok(neph_evidence_choose(&source, &evidence, NULL), NULL);
    return evidence;
}

/* One frame has the largest error; another row has a smaller error in more frames. */
static void disturb(struct sequence *sequence)
{
    put(sequence, WORST, 1, 1, 1.25f);
    for (int i = 0; i < FRAMES; i++)
        put(sequence, i, 2, ROW, 0.5f);
}

static void test_the_worst_frame_and_the_row_of_most_energy(void **state)
{
    struct sequence sequence;
    start(state, &sequence);
    disturb(&sequence);
    struct neph_evidence evidence = find(&sequence);
    assert_int_equal(evidence.worst_frame, WORST);
    assert_int_equal(evidence.row, ROW); /* 80 / 16 against 1 */
    assert_int_equal(evidence.slice_count, NEPH_EVIDENCE_SLICE);
    assert_int_equal(evidence.slice_first, FRAMES - NEPH_EVIDENCE_SLICE); /* not 50 - 32 */
    assert_int_equal(evidence.flip_first, WORST - 1);
    assert_int_equal(evidence.flip_count, NEPH_EVIDENCE_FLIPS);
    assert_true(evidence.scale == 0.05);
    put(&sequence, FRAMES - 1, 0, 4, NAN); /* counts more than any number */
    evidence = find(&sequence);
    assert_int_equal(evidence.worst_frame, FRAMES - 1);
    assert_int_equal(evidence.row, 4);
    assert_int_equal(evidence.flip_first, FRAMES - NEPH_EVIDENCE_FLIPS);
    finish(&sequence);
}

/* A sequence of one frame, and one without a reference, where only bad values are visible. */
static void test_short_ones_and_those_without_a_reference(void **state)
{
    struct sequence sequence;
    start(state, &sequence);
    disturb(&sequence);
    sequence.files.count = 1;
    struct neph_evidence evidence = find(&sequence);
    assert_int_equal(evidence.worst_frame, 0);
    assert_int_equal(evidence.slice_count, 0);
    assert_int_equal(evidence.flip_count, 0);
    sequence.files.count = FRAMES;
    sequence.reference.count = 0;
    put(&sequence, 7, 5, 2, -1.0f);
    evidence = find(&sequence);
    assert_int_equal(evidence.worst_frame, 7);
    assert_int_equal(evidence.row, 2);
    finish(&sequence);
}

static bool is_listed(const json_t *names, const char *name)
{
    for (size_t i = 0; i < json_array_size(names); i++)
        if (strcmp(json_string_value(json_array_get(names, i)), name) == 0)
            return true;
    return false;
}

/* Linear red of a pixel of an image. */
static double red_at(void **state, const char *name, int x, int y, int width, int height)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_image *image = NULL;
    scratch_path(state, path, name);
    neph_assert_ok(neph_png_read_image(path, &image, NULL), NULL);
    assert_int_equal(image->width_px, width);
    assert_int_equal(image->height_px, height);
    const double red = neph_image_channel(image, "R")[y * width + x];
    neph_image_destroy(image);
    return red;
}

static void test_images_match_the_evidence(void **state)
{
    struct sequence sequence;
    char folder[SCRATCH_PATH_MAX];
    start(state, &sequence);
    disturb(&sequence);
    put(&sequence, WORST, 4, ROW, 0.0f); /* in the slice: black in the row of this frame */
    const struct neph_evidence evidence = find(&sequence);
    const struct neph_evidence_source source = make_evidence_source(&sequence);
    json_t *names = json_array();
    scratch_path(state, folder, "");
    neph_assert_ok(neph_evidence_draw(&source, &evidence, folder, names, NULL), NULL);
    static const char *const drawn[] = {"worst.png",  "worst_reference.png", "worst_difference.png",
                                        "slice.png",  "slice_reference.png", "slice_difference.png",
                                        "flip_0.png", "flip_1.png",          "flip_2.png",
                                        "flip_3.png", "flip_reference_0.png"};
    assert_int_equal(json_array_size(names), sizeof(drawn) / sizeof(drawn[0]));
    for (size_t i = 0; i < sizeof(drawn) / sizeof(drawn[0]); i++)
        assert_true(is_listed(names, drawn[i]));
    /* Times 2, the exposure: 0.25 is half of white, 1.25 is beyond white. */
    assert_true(red_at(state, "worst.png", 1, 1, WIDTH, HEIGHT) == 1.0);
    assert_true(fabs(red_at(state, "worst_reference.png", 1, 1, WIDTH, HEIGHT) - 0.5) < 0.005);
    assert_true(red_at(state, "flip_1.png", 1, 1, WIDTH, HEIGHT) == 1.0);
    assert_true(fabs(red_at(state, "flip_0.png", 1, 1, WIDTH, HEIGHT) - 0.5) < 0.005);
    const int at = WORST - evidence.slice_first;
    assert_true(red_at(state, "slice.png", 2, at, WIDTH, NEPH_EVIDENCE_SLICE) == 1.0);
    assert_true(red_at(state, "slice.png", 4, at, WIDTH, NEPH_EVIDENCE_SLICE) == 0.0);
    assert_true(fabs(red_at(state, "slice.png", 4, at - 1, WIDTH, NEPH_EVIDENCE_SLICE) - 0.5) <
                0.005);
    json_decref(names);
    finish(&sequence);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        scratch_test(test_the_worst_frame_and_the_row_of_most_energy),
        scratch_test(test_short_ones_and_those_without_a_reference),
        scratch_test(test_images_match_the_evidence),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
