/* SPDX-License-Identifier: MIT
 *
 * Out of memory in masks, validity and every extractor through the meter: see tests/allocation.h.
 */
#include "metrics/extractors/extractors.h"
#include "tests/allocation.h"
#include "tests/metrics/synthetic.h"

#include "metrics/meter.h"
#include "metrics/pair.h"
#include "metrics/validity.h"
#include "metrics/z_test.h"

enum { WIDTH = 17, HEIGHT = 4, FRAMES_MAX = 20 };

/* Frames, created without failures, and the requested measurements. */
struct job {
    struct neph_image *reference[FRAMES_MAX], *second[FRAMES_MAX], *test[FRAMES_MAX];
    int frame_count;
    const struct neph_extractor *extractor;
    bool intervals;
    const struct neph_mask_kind *mask_kind;
};

static struct job create_job(int frame_count, bool all_layers)
{
    struct job job = {.frame_count = frame_count};
    struct synthetic what = {WIDTH, HEIGHT, 0, 1, false, all_layers};
    for (what.frame = 0; what.frame < frame_count; what.frame++) {
        struct synthetic second = what, test = what;
        second.seed = 2;
        test.is_test = true;
        neph_assert_ok(synthetic_create(&what, &job.reference[what.frame], NULL), NULL);
        neph_assert_ok(synthetic_create(&second, &job.second[what.frame], NULL), NULL);
        neph_assert_ok(synthetic_create(&test, &job.test[what.frame], NULL), NULL);
    }
    return job;
}

static void destroy_job(struct job *job)
{
    for (int i = 0; i < job->frame_count; i++) {
        neph_image_destroy(job->reference[i]);
        neph_image_destroy(job->second[i]);
        neph_image_destroy(job->test[i]);
    }
}

static enum neph_status make_mask(void *context, struct neph_diag *diag)
{
    const struct job *job = context;
    struct neph_mask *mask = NULL;
    const enum neph_status status = neph_mask_create(job->reference[0], job->mask_kind->name, NULL,
                                                     &mask, diag);
    assert_int_equal(mask != NULL, status == NEPH_OK);
    neph_mask_destroy(mask);
    return status;
}

static enum neph_status look_at_maps(const struct neph_meter *meter,
                                     const struct neph_extractor *extractor, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int m = 0; m < extractor->map_count && !status; m++) {
        struct neph_image *map = NULL;
        const struct neph_quantity *radiance = neph_quantity_find("radiance");
        if (neph_meter_obstacle(meter, radiance, extractor) ||
            (extractor->maps[m].quantities && !(extractor->maps[m].quantities & NEPH_RADIANCE)))
            continue;
        status = neph_meter_map(meter, radiance, extractor, m, &map, diag);
        neph_image_destroy(map);
    }
    return status;
}

static enum neph_status measure(void *context, struct neph_diag *diag)
{
    const struct job *job = context;
    struct neph_mask *mask = NULL;
    struct neph_meter *meter = NULL;
    const struct neph_meter_choice choice = {job->extractor, synthetic_settings(job->extractor)};
    enum neph_status status = neph_mask_create(job->reference[0], "all", NULL, &mask, diag);
    if (!status)
        status = neph_meter_create(
            &(struct neph_meter_params){.choices = &choice,
                                        .choice_count = 1,
                                        .viewing = NEPH_VIEWING_DEFAULTS,
                                        .masks = (const struct neph_mask *const *)&mask,
                                        .mask_count = 1,
                                        .intervals = job->intervals,
                                        .draws = job->intervals,
                                        .frame_count = job->frame_count},
            &meter, diag);
    for (int i = 0; i < job->frame_count && !status; i++)
        status = neph_meter_frame(meter, job->reference[i], job->second[i], job->test[i], diag);
    if (!status)
        status = neph_meter_finish(meter, diag);
    if (!status)
        status = look_at_maps(meter, job->extractor, diag);
    neph_meter_destroy(meter);
    neph_mask_destroy(mask);
    return status;
}

static enum neph_status check_validity(void *context, struct neph_diag *diag)
{
    const struct job *job = context;
    struct neph_validity validity = {0};
    const enum neph_status status = neph_validity_count(job->test[0], &validity, diag);
    neph_validity_finish(&validity);
    return status;
}

/* Noise of two repeats on one side, of a constant variance on the other; some z are beyond 2. */
static enum neph_status test_noise(void *context, struct neph_diag *diag)
{
    enum { PIXELS = WIDTH * HEIGHT };
    (void)context;
    float first[PIXELS], second[PIXELS];
    double means[2][PIXELS], variances[2][PIXELS];
    const float *const repeats[2] = {first, second};
    struct neph_z_plane plane;
    struct neph_z_side sides[2] = {
        {.rounding = 1e-6},
        {.mean = means[1], .variance = variances[1], .correlation = 1.0, .rounding = 1e-6}};
    for (int i = 0; i < PIXELS; i++) {
        first[i] = 1.0f + 0.1f * (float)(i % 3);
        second[i] = 1.0f + 0.1f * (float)(i % 5);
        means[1][i] = i < 8 ? 5.0 : 1.0;
        variances[1][i] = 0.01;
    }
    enum neph_status status = neph_z_from_repeats(repeats, 2, WIDTH, HEIGHT, means[0], variances[0],
                                                  &sides[0], diag);
    if (!status)
        status = neph_z_test(&sides[0], &sides[1], WIDTH, HEIGHT, 1, NULL, &plane, diag);
    return status;
}

static void test_noise_or_bias(void **state)
{
    assert_every_failure_is_reported("z_test", test_noise, NULL);
}

static void test_masks_and_validity(void **state)
{
    struct job job = create_job(1, true);
    for (int i = 0; i < neph_mask_kind_count(); i++) {
        job.mask_kind = neph_mask_kind_at(i);
        assert_every_failure_is_reported(job.mask_kind->name, make_mask, &job);
    }
    assert_every_failure_is_reported("validity", check_validity, &job);
    destroy_job(&job);
}

static void test_extractors(void **state)
{
    for (int i = 0; i < neph_extractor_count(); i++) {
        const struct neph_extractor *extractor = neph_extractor_at(i);
        struct job job = create_job(extractor->temporal ? FRAMES_MAX : 1, true);
        job.extractor = extractor;
        assert_every_failure_is_reported(extractor->name, measure, &job);
        destroy_job(&job);
    }
}

/* Intervals take most of the time and are the same for all. */
static void test_intervals(void **state)
{
    struct job job = create_job(1, false);
    job.extractor = neph_extractor_find("error");
    job.intervals = true;
    assert_every_failure_is_reported("intervals", measure, &job);
    destroy_job(&job);
}

#include "tests/main.h"
