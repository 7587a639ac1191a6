/* SPDX-License-Identifier: MIT
 *
 * The blur and the aliasing of anti-aliased frames, with sequences of closed form. A grating that
 * moves has, blurred by a Gaussian, m = exp(-2 pi^2 sigma^2 f^2) of its amplitude; against itself
 * it flickers 1 - m times as much as against grey, and all of that is the part `blur`.
 */
#include "tests/base/scratch.h"

#include "base/exr.h"
#include "harness/compare/comparison.h"
#include "harness/study/attribution_plan.h"
#include "harness/study/blurred.h"
#include "metrics/extractors/extractors.h"

enum { WIDTH = 64, HEIGHT = 8, FRAMES = 32, PERIOD_PX = 5, MIDDLE = WIDTH / 2 };

static const double mean = 0.4, contrast = 0.3, sigma_px = 0.7, cycles_per_frame = 0.125;

/* A sum of gratings around the mean. */
struct gratings {
    double amplitude;  /* of a moving one of five pixels */
    double flickering; /* of one of 16 pixels that alternates at twice the rate, at rest */
};

static double blur_factor(double period_px)
{
    return exp(-2.0 * pow(M_PI * sigma_px / period_px, 2.0));
}

static struct neph_image *make_frame(const struct gratings *gratings, int frame)
{
    struct neph_image *image = NULL;
    float *planes[3];
    neph_assert_ok(neph_image_create(WIDTH, HEIGHT, &image, NULL), NULL);
    neph_assert_ok(neph_image_add_rgb(image, NULL, planes, NULL), NULL);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        const double x = i % WIDTH - MIDDLE, turns = cycles_per_frame * frame;
        const double value =
            mean + gratings->amplitude * cos(2.0 * M_PI * (x / PERIOD_PX - turns)) +
            gratings->flickering * cos(2.0 * M_PI * x / 16.0) * cos(4.0 * M_PI * turns);
        planes[0][i] = planes[1][i] = planes[2][i] = (float)value;
    }
    return image;
}

static struct neph_sequence make_files(void **state, const char *name,
                                       const struct gratings *gratings)
{
    struct neph_sequence files = {.paths = calloc(FRAMES, sizeof(char *))};
    assert_non_null(files.paths);
    for (; files.count < FRAMES; files.count++) {
        char file[32], path[SCRATCH_PATH_MAX];
        struct neph_image *image = make_frame(gratings, files.count);
        snprintf(file, sizeof(file), "%s_%02d.exr", name, files.count);
        files.paths[files.count] = strdup(scratch_path(state, path, file));
        neph_assert_ok(neph_exr_write_plain(path, image, NULL), NULL);
        neph_image_destroy(image);
    }
    return files;
}

static enum neph_status keep_middle(void *context, const struct neph_map *map,
                                    const struct neph_quantity *quantity, int frame,
                                    const struct neph_image *image, struct neph_diag *diag)
{
    double *seen = context;
    (void)frame, (void)diag;
    if (quantity == neph_quantity_find("radiance") && strcmp(map->name, "seen_contrast") == 0)
        *seen = (double)neph_image_channel(image, "Y")[HEIGHT / 2 * WIDTH + MIDDLE];
    return NEPH_OK;
}

/* Flicker seen in the middle, far from the mirrored borders. */
static double measure_seen(const struct neph_sequence *test, const struct neph_sequence *reference)
{
    const struct neph_extractor *extractor = neph_extractor_find("seen");
    double seen = NAN;
    const struct neph_comparison comparison = {
        .source = &neph_frame_files,
        .reference = *reference,
        .test = *test,
        .choices = {{extractor, neph_options_default(extractor->options)}},
        .choice_count = 1,
        .viewing = NEPH_VIEWING_DEFAULTS,
        .take_map = keep_middle,
        .map_context = &seen,
        .allow_frozen_frames = true,
        .plain = true,
        .by_position = true,
        .quiet = true};
    struct neph_compared compared = {.asked = NULL};
    neph_assert_ok(neph_comparison_run(&comparison, false, &compared, NULL), NULL);
    neph_compared_finish(&compared);
    return seen;
}

/* A reference, an anti-aliased sequence, and what is made of them. */
struct fixture {
    struct neph_sequence grey, reference, sequence, blurred, aliased;
    double blur_px;
};

static void begin(void **state, const struct gratings *sequence, struct fixture *fixture)
{
    const struct scratch *scratch = *state;
    *fixture = (struct fixture){
        .grey = make_files(state, "grey", &(struct gratings){0.0, 0.0}),
        .reference = make_files(state, "reference", &(struct gratings){contrast * mean, 0.0}),
        .sequence = make_files(state, "sequence", sequence)};
    neph_assert_ok(
        neph_blurred_fit(&fixture->reference, &fixture->sequence, &fixture->blur_px, NULL), NULL);
    neph_assert_ok(neph_blurred_write(&fixture->reference, &fixture->sequence, fixture->blur_px,
                                      scratch->folder, &fixture->blurred, &fixture->aliased, NULL),
                   NULL);
}

static void end(struct fixture *fixture)
{
    neph_sequence_finish(&fixture->grey);
    neph_sequence_finish(&fixture->reference);
    neph_sequence_finish(&fixture->sequence);
    neph_sequence_finish(&fixture->blurred);
    neph_sequence_finish(&fixture->aliased);
}

/* The shares with all other parts ideal: those have no effect. */
static struct neph_attribution_values divide(const struct fixture *fixture)
{
    const struct neph_sequence *const against[NEPH_IDEALS + 1] = {
        [NEPH_IDEAL_SEQUENCE] = &fixture->sequence,
        [NEPH_IDEAL_BLURRED] = &fixture->blurred,
        [NEPH_IDEAL_ALIASED] = &fixture->aliased,
        [NEPH_IDEALS] = &fixture->reference};
    double seen[NEPH_IDEALS + 1], values[NEPH_PART_SETS];
    for (int i = 0; i <= NEPH_IDEALS; i++)
        seen[i] = measure_seen(&fixture->sequence, against[i]);
    for (neph_part_set set = 0; set < NEPH_PART_SETS; set++)
        values[set] = pow(seen[neph_attribution_find_reference(set)], 2.0);
    return neph_attribution_divide(values);
}

static void test_a_blurred_grating_flickers_by_its_loss(void **state)
{
    const double m = blur_factor(PERIOD_PX);
    struct fixture fixture;
    begin(state, &(struct gratings){m * contrast * mean, 0.0}, &fixture);
    const struct neph_attribution_values values = divide(&fixture);
    const double whole = measure_seen(&fixture.reference, &fixture.grey);
    assert_true(whole > 10.0);
    neph_assert_close(fixture.blur_px, sigma_px, 0.0, 0.01);
    neph_assert_close(sqrt(values.all), (1.0 - m) * whole, 0.01, 0.0);
    neph_assert_close(values.parts[NEPH_PART_BLUR].share, values.all, 0.01, 0.0);
    neph_assert_close(values.parts[NEPH_PART_ALIASING].share, 0.0, 0.0, 0.01 * values.all);
    end(&fixture);
}

/* Flicker at another rate beside the blur: the squares add up. */
static void test_flicker_beside_the_blur_is_aliasing(void **state)
{
    const double m = blur_factor(PERIOD_PX), beside = 0.1 * mean;
    struct fixture fixture;
    begin(state, &(struct gratings){m * contrast * mean, beside}, &fixture);
    struct neph_sequence flickering = make_files(state, "flickering",
                                                 &(struct gratings){0.0, beside});
    const struct neph_attribution_values values = divide(&fixture);
    const double blur = (1.0 - m) * measure_seen(&fixture.reference, &fixture.grey),
                 aliasing = measure_seen(&flickering, &fixture.grey);
    assert_true(fmin(blur, aliasing) > 3.0);
    neph_assert_close(fixture.blur_px, sigma_px, 0.0, 0.01);
    neph_assert_close(values.parts[NEPH_PART_BLUR].share, blur * blur, 0.02, 0.0);
    neph_assert_close(values.parts[NEPH_PART_ALIASING].share, aliasing * aliasing, 0.02, 0.0);
    neph_sequence_finish(&flickering);
    end(&fixture);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        scratch_test(test_a_blurred_grating_flickers_by_its_loss),
        scratch_test(test_flicker_beside_the_blur_is_aliasing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
