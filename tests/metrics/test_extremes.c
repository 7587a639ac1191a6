/* SPDX-License-Identifier: MIT
 *
 * All extractors and masks of the tables, through the meter, at unusual sizes, with extreme values
 * and settings at their limits: every result is a finite number within its range, or a reason. New
 * extractors and masks are tested without a change here. By day and under the sanitizers sequences
 * get only a few of these values; single frames get all. Under the sanitizers every mask is
 * created, but only few are measured: a mask is a plane of bytes, whatever created it.
 */
#include "metrics/extractors/extractors.h"
#include "tests/metrics/synthetic.h"
#include "tests/neph_test.h"

#include "metrics/meter.h"

enum { CHOICES_MAX = 64, MASKS_MAX = 64, SEQUENCE_FRAMES = 180 };

/* All extractors, over every mask that the frames support. */
struct setup {
    struct neph_meter_choice choices[CHOICES_MAX];
    int choice_count;
    struct neph_mask *masks[MASKS_MAX];
    int mask_count;
};

static struct neph_image *create(struct synthetic what)
{
    struct neph_image *image = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(synthetic_create(&what, &image, &diag), &diag);
    return image;
}

static void add_mask(struct setup *setup, const struct neph_image *reference, const char *name)
{
    struct neph_diag diag = {0};
    neph_assert_in_range(setup->mask_count, 0, MASKS_MAX - 1);
    neph_assert_ok(
        neph_mask_create(reference, name, NULL, &setup->masks[setup->mask_count++], &diag), &diag);
}

static void keep_some_masks(struct setup *setup)
{
    int kept = 0;
    for (int i = 0; i < setup->mask_count; i++)
        if (i % NEPH_TEST_EVERY == 0)
            setup->masks[kept++] = setup->masks[i];
        else
            neph_mask_destroy(setup->masks[i]);
    setup->mask_count = kept;
}

/* Intervals take most of the time and are the same for all masks: only two masks get them. */
static struct setup set_up(const struct neph_image *reference, bool temporal, bool intervals)
{
    struct setup setup = {.choice_count = 0};
    for (int i = 0; i < neph_extractor_count(); i++) {
        const struct neph_extractor *extractor = neph_extractor_at(i);
        neph_assert_in_range(setup.choice_count, 0, CHOICES_MAX - 1);
        if (extractor->temporal == temporal)
            setup.choices[setup.choice_count++] = (struct neph_meter_choice){
                extractor, synthetic_settings(extractor)};
    }
    if (intervals) {
        add_mask(&setup, reference, "all");
        add_mask(&setup, reference, "depth_edge");
        return setup;
    }
    for (int i = 0; i < neph_mask_kind_count(); i++)
        add_mask(&setup, reference, neph_mask_kind_at(i)->name);
    const char *name;
    for (int i = 0; (name = neph_mask_channel_at(reference, i)); i++)
        if (!neph_mask_kind_find(name))
            add_mask(&setup, reference, name);
    keep_some_masks(&setup);
    return setup;
}

static void tear_down(struct setup *setup)
{
    for (int i = 0; i < setup->mask_count; i++)
        neph_mask_destroy(setup->masks[i]);
}

static struct neph_meter *start_meter(const struct setup *setup, int frame_count, bool intervals)
{
    struct neph_meter *meter = NULL;
    struct neph_diag diag = {0};
    const struct neph_meter_params params = {
        .choices = setup->choices,
        .choice_count = setup->choice_count,
        .viewing = NEPH_VIEWING_DEFAULTS,
        .masks = (const struct neph_mask *const *)setup->masks,
        .mask_count = setup->mask_count,
        .intervals = intervals,
        .frame_count = frame_count,
    };
    neph_assert_ok(neph_meter_create(&params, &meter, &diag), &diag);
    return meter;
}

/* ---- conditions on every value --------------------------------------------------------------- */

static void assert_sane(const struct neph_measurement *m, int width_px, int height_px)
{
    const char *wrong = NULL;
    if (!isfinite(m->value) || !isfinite(m->low) || !isfinite(m->high))
        wrong = "is not finite";
    else if (m->defined == (m->undefined_because != NULL))
        wrong = "has not either a value or a reason";
    else if (!m->defined && m->value != 0.0)
        wrong = "has a value though undefined";
    else if (m->defined && (m->value < m->metric->low || m->value > m->metric->high))
        wrong = "is outside its range";
    else if (m->defined && m->interval == NEPH_INTERVAL_TILES &&
             !(m->low <= m->value && m->value <= m->high))
        wrong = "is outside its interval";
    else if (m->pixel_count > (size_t)width_px * (size_t)height_px)
        wrong = "counts more pixels than there are";
    if (wrong)
        fail_msg("%s of %s over %s at %dx%d, frame %d, %s: %.17g in %.17g..%.17g, %s",
                 m->metric->name, m->quantity->name, m->mask, width_px, height_px, m->frame, wrong,
                 m->value, m->low, m->high,
                 m->undefined_because ? m->undefined_because : "defined");
}

static void assert_all_sane(const struct neph_meter *meter, int width_px, int height_px)
{
    int count = 0;
    const struct neph_measurement *all = neph_meter_measurements(meter, &count);
    for (int i = 0; i < count; i++)
        assert_sane(&all[i], width_px, height_px);
}

/* No displayed map has an infinity; NaN is "no value". */
static void assert_maps_sane(const struct neph_meter *meter, const struct setup *setup)
{
    for (int q = 0; q < neph_quantity_count(); q++)
        for (int c = 0; c < setup->choice_count; c++) {
            const struct neph_quantity *quantity = neph_quantity_at(q);
            const struct neph_extractor *extractor = setup->choices[c].extractor;
            for (int m = 0; m < extractor->map_count; m++) {
                struct neph_image *map = NULL;
                if (!extractor->maps[m].name || neph_meter_obstacle(meter, quantity, extractor) ||
                    (extractor->maps[m].quantities &&
                     !(extractor->maps[m].quantities & (unsigned)quantity->bit)))
                    continue;
                neph_assert_ok(neph_meter_map(meter, quantity, extractor, m, &map, NULL), NULL);
                for (int p = 0; p < map->channel_count; p++)
                    for (size_t i = 0; i < neph_image_pixel_count(map); i++)
                        if (isinf(map->channels[p].samples[i]))
                            fail_msg("map %s of %s is infinite", extractor->maps[m].name,
                                     extractor->name);
                neph_image_destroy(map);
            }
        }
}

/* ---- sizes ----------------------------------------------------------------------------------- */

static void measure_frames(int width_px, int height_px, int frame_count, bool temporal,
                           bool intervals)
{
    struct synthetic what = {width_px, height_px, 0, 1, false, true};
    struct neph_image *reference = create(what);
    struct setup setup = set_up(reference, temporal, intervals);
    struct neph_meter *meter = start_meter(&setup, frame_count, intervals);
    neph_image_destroy(reference);
    for (what.frame = 0; what.frame < frame_count; what.frame++) {
        struct neph_diag diag = {0};
        reference = create(what);
        struct neph_image *second = create(
            (struct synthetic){width_px, height_px, what.frame, 2, false, true});
        struct neph_image *test = create(
            (struct synthetic){width_px, height_px, what.frame, 3, true, true});
        neph_assert_ok(neph_meter_frame(meter, reference, second, test, &diag), &diag);
        if (!temporal)
            assert_maps_sane(meter, &setup);
        neph_image_destroy(reference);
        neph_image_destroy(second);
        neph_image_destroy(test);
    }
    struct neph_diag diag = {0};
    neph_assert_ok(neph_meter_finish(meter, &diag), &diag);
    if (temporal)
        assert_maps_sane(meter, &setup);
    assert_all_sane(meter, width_px, height_px);
    neph_meter_destroy(meter);
    tear_down(&setup);
}

static const int sizes[][2] = {{1, 1},  {1, 2},   {2, 1},   {1, 37},  {41, 1},  {2, 2},  {3, 3},
                               {2, 19}, {10, 11}, {11, 10}, {15, 17}, {16, 16}, {33, 47}};

static void test_odd_sizes_of_images(void **state)
{
    for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++)
        for (int intervals = 0; intervals < 2; intervals++)
            measure_frames(sizes[i][0], sizes[i][1], 1, false, intervals);
    measure_frames(177, 181, 1, false, false); /* just large enough for five scales of MS-SSIM */
    measure_frames(600, 3, 1, false, false);
}

static void test_odd_sizes_of_sequences(void **state)
{
    for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++)
        for (int intervals = 0; intervals < 2; intervals++)
            measure_frames(sizes[i][0], sizes[i][1], 5, true, intervals);
    measure_frames(1, 1, SEQUENCE_FRAMES, true, true);
    measure_frames(5, 7, SEQUENCE_FRAMES, true, false);
    measure_frames(33, 18, SEQUENCE_FRAMES, true, false);
}

/* ---- contents -------------------------------------------------------------------------------- */

static void fill(struct neph_image *image, const char *prefix, float value)
{
    for (int c = 0; c < image->channel_count; c++)
        if (strncmp(image->channels[c].name, prefix, strlen(prefix)) == 0)
            for (size_t i = 0; i < neph_image_pixel_count(image); i++)
                image->channels[c].samples[i] = value;
}

/* Black, uniform, the largest and the smallest floats, only sky, only ground. */
static void test_flat_and_extreme_contents(void **state)
{
    static const struct {
        float reference, test, depth;
    } cases[] = {
        {0.0f, 0.0f, INFINITY},         {0.0f, 1.0f, 1.0f},           {1.0f, 0.0f, 0.0f},
        {0x1p-149f, 0x1p-126f, 1e-30f}, {3.4e38f, 1.0f, 3.4e38f},     {1.0f, 3.4e38f, INFINITY},
        {3.4e38f, 3.4e38f, 5.0f},       {-1.0f, -2.0f, 1.0f},         {1e-20f, 1e20f, 1e20f},
        {-3.4e38f, 3.4e38f, 1.0f},      {0x1p-149f, 3.4e38f, 1e-40f}, {0.0f, -0.0f, INFINITY},
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++)
        for (int temporal = 0; temporal < 2; temporal++) {
            if (temporal && i % (size_t)neph_test_path_step() != 0)
                continue;
            struct neph_image *reference = create((struct synthetic){23, 21, 0, 0, false, true});
            struct neph_image *test = create((struct synthetic){23, 21, 0, 0, true, true});
            fill(reference, "", cases[i].reference);
            fill(test, "", cases[i].test);
            fill(reference, "Z", cases[i].depth);
            fill(test, "Z", cases[i].depth);
            struct setup setup = set_up(reference, temporal, true);
            const int frame_count = temporal ? 100 : 1;
            struct neph_meter *meter = start_meter(&setup, frame_count, true);
            for (int frame = 0; frame < frame_count; frame++) {
                struct neph_diag diag = {0};
                neph_assert_ok(neph_meter_frame(meter, reference, NULL, test, &diag), &diag);
            }
            neph_assert_ok(neph_meter_finish(meter, NULL), NULL);
            assert_maps_sane(meter, &setup);
            assert_all_sane(meter, 23, 21);
            neph_meter_destroy(meter);
            tear_down(&setup);
            neph_image_destroy(reference);
            neph_image_destroy(test);
        }
}

/* ---- values that are not finite -------------------------------------------------------------- */

enum { PLANT_WIDTH = 27, PLANT_HEIGHT = 25 };

/* Position of a bad value. */
struct plant {
    const char *channel;
    bool in_test;
    int x, y;
    float value;
};

static const struct neph_mask *mask_named(const struct setup *setup, const char *name)
{
    for (int i = 0; i < setup->mask_count; i++)
        if (strcmp(setup->masks[i]->name, name) == 0)
            return setup->masks[i];
    fail_msg("no mask '%s'", name);
    return NULL;
}

static bool holds_channel(const struct neph_quantity *quantity, const char *channel)
{
    if (quantity->plane_count == 1)
        return strcmp(quantity->layer, channel) == 0;
    if (!quantity->layer)
        return strlen(channel) == 1 && strchr("RGB", channel[0]);
    return strncmp(channel, quantity->layer, strlen(quantity->layer)) == 0;
}

/* The measurement of the same frames without the bad value, searched from *place on: measurements
 * have the same order, but a quantity with a bad value has fewer. */
static void assert_same(const struct neph_measurement *m, const struct neph_measurement *clean,
                        int clean_count, int *place)
{
    for (int tried = 0; tried < clean_count; tried++, *place = (*place + 1) % clean_count) {
        const struct neph_measurement *same = &clean[*place];
        if (same->metric == m->metric && same->quantity == m->quantity && same->frame == m->frame &&
            strcmp(same->mask, m->mask) == 0) {
            if (same->defined != m->defined || same->value != m->value)
                fail_msg("%s of %s over %s: %.17g, without the bad value elsewhere %.17g",
                         m->metric->name, m->quantity->name, m->mask, m->value, same->value);
            return;
        }
    }
    fail_msg("%s of %s over %s is not there without the bad value", m->metric->name,
             m->quantity->name, m->mask);
}

static struct neph_meter *measure_planted(const struct setup *setup, const struct plant *plant,
                                          int frame_count)
{
    struct neph_meter *meter = start_meter(setup, frame_count, false);
    struct synthetic what = {PLANT_WIDTH, PLANT_HEIGHT, 0, 1, false, true};
    for (what.frame = 0; what.frame < frame_count; what.frame++) {
        struct neph_diag diag = {0};
        struct synthetic other = what;
        other.is_test = true;
        struct neph_image *reference = create(what), *test = create(other);
        if (plant && what.frame == 1)
            neph_image_channel(plant->in_test ? test : reference,
                               plant->channel)[plant->y * PLANT_WIDTH + plant->x] = plant->value;
        neph_assert_ok(neph_meter_frame(meter, reference, NULL, test, &diag), &diag);
        neph_image_destroy(reference);
        neph_image_destroy(test);
    }
    neph_assert_ok(neph_meter_finish(meter, NULL), NULL);
    return meter;
}

/* In the quantity with the bad value, every extractor that reads it is undefined and reports the
 * number of bad pixels; every other value is unchanged. A value of a sequence depends on all of its
 * frames. */
static void assert_plant_is_told(const struct setup *setup, const struct plant *plant,
                                 const struct neph_meter *meter, const struct neph_meter *without)
{
    int count = 0, clean_count = 0, place = 0;
    const struct neph_measurement *all = neph_meter_measurements(meter, &count);
    const struct neph_measurement *clean = neph_meter_measurements(without, &clean_count);
    for (int i = 0; i < count; i++) {
        const struct neph_measurement *m = &all[i];
        const struct neph_mask *mask = mask_named(setup, m->mask);
        assert_sane(m, PLANT_WIDTH, PLANT_HEIGHT);
        const bool is_hit = holds_channel(m->quantity, plant->channel) &&
                            (m->frame == 1 || m->frame == -1);
        const bool is_inside = mask->inside[plant->y * PLANT_WIDTH + plant->x];
        if (!is_hit)
            assert_same(m, clean, clean_count, &place);
        else if (is_inside && m->defined)
            fail_msg("%s of %s over %s is %g in spite of %g in %s of the %s", m->metric->name,
                     m->quantity->name, m->mask, m->value, (double)plant->value, plant->channel,
                     plant->in_test ? "test" : "reference");
        else if (is_inside && m->frame == 1 && m->bad_count != 1 &&
                 m->metric->pool != NEPH_POOL_SCALAR)
            fail_msg("%s of %s over %s counts %zu bad pixels", m->metric->name, m->quantity->name,
                     m->mask, m->bad_count);
    }
}

static void test_bad_values_are_never_silent(void **state)
{
    static const struct plant plants[] = {
        {"R", false, 3, 4, NAN},
        {"G", true, 0, 0, INFINITY},
        {"B", true, PLANT_WIDTH - 1, PLANT_HEIGHT - 1, -INFINITY},
        {"volume.R", true, 5, 20, NAN},
        {"volume.B", false, 13, 7, -INFINITY},
        {"transmittance.G", false, 13, 8, INFINITY},
        {"transmittance.R", true, 1, 2, NAN},
        {"Z", true, 9, 20, NAN},
        {"Z", false, 9, 20, -INFINITY},
    };
    struct neph_image *reference = create(
        (struct synthetic){PLANT_WIDTH, PLANT_HEIGHT, 0, 1, false, true});
    for (int temporal = 0; temporal < 2; temporal++) {
        const int frame_count = temporal ? 100 : 3;
        struct setup setup = set_up(reference, temporal, false);
        struct neph_meter *without = measure_planted(&setup, NULL, frame_count);
        for (size_t i = 0; i < sizeof(plants) / sizeof(plants[0]);
             i += temporal ? (size_t)neph_test_path_step() : 1) {
            struct neph_meter *meter = measure_planted(&setup, &plants[i], frame_count);
            assert_plant_is_told(&setup, &plants[i], meter, without);
            neph_meter_destroy(meter);
        }
        neph_meter_destroy(without);
        tear_down(&setup);
    }
    neph_image_destroy(reference);
}

/* Layers next to the quantities: results from a bad value are valid or absent, and no mask is made
 * from a bad value. */
static void test_bad_values_in_further_layers(void **state)
{
    static const struct plant plants[] = {
        {"motion.x", false, 3, 4, NAN},         {"motion.y", true, 9, 9, INFINITY},
        {"volume.distance", false, 13, 7, NAN}, {"volume.distance", true, 13, 7, -INFINITY},
        {"mask.card", false, 2, 2, NAN},
    };
    struct neph_image *reference = create(
        (struct synthetic){PLANT_WIDTH, PLANT_HEIGHT, 0, 1, false, true});
    struct setup setup = set_up(reference, true, true);
    for (size_t i = 0; i < sizeof(plants) / sizeof(plants[0]); i++) {
        struct neph_meter *meter = measure_planted(&setup, &plants[i], 24);
        assert_all_sane(meter, PLANT_WIDTH, PLANT_HEIGHT);
        assert_maps_sane(meter, &setup);
        neph_meter_destroy(meter);
    }
    neph_image_channel(reference, "mask.cloud")[5] = NAN;
    struct neph_mask *mask = NULL;
    struct neph_diag diag = {0};
    assert_int_equal(neph_mask_create(reference, "cloud", NULL, &mask, &diag), NEPH_ERR_GATE);
    assert_null(mask);
    tear_down(&setup);
    neph_image_destroy(reference);
}

/* ---- settings -------------------------------------------------------------------------------- */

/* One extractor, which may refuse its settings with a reason. */
static void measure_with(const struct neph_extractor *extractor, struct neph_settings settings,
                         struct neph_image *const reference[2], struct neph_image *const test[2])
{
    struct setup setup = set_up(reference[0], extractor->temporal, true);
    setup.choices[0] = (struct neph_meter_choice){extractor, settings};
    setup.choice_count = 1;
    const int frame_count = extractor->temporal ? 24 : 1;
    struct neph_meter *meter = start_meter(&setup, frame_count, false);
    enum neph_status status = NEPH_OK;
    struct neph_diag diag = {0};
    for (int i = 0; i < frame_count && !status; i++)
        status = neph_meter_frame(meter, reference[i % 2], NULL, test[i % 2], &diag);
    if (!status)
        status = neph_meter_finish(meter, &diag);
    if (status && ((status != NEPH_ERR_USAGE && status != NEPH_ERR_INPUT) || !diag.message[0]))
        fail_msg("%s: %s: %s", extractor->name, neph_status_name(status), diag.message);
    if (!status)
        assert_maps_sane(meter, &setup);
    assert_all_sane(meter, reference[0]->width_px, reference[0]->height_px);
    neph_meter_destroy(meter);
    tear_down(&setup);
}

/* Each setting at its minimum and maximum, each word of a choice; the others at their defaults. */
static void test_settings_at_their_ends(void **state)
{
    struct neph_image *reference[2], *test[2];
    for (int i = 0; i < 2; i++) {
        reference[i] = create((struct synthetic){21, 18, i, 1, false, true});
        test[i] = create((struct synthetic){21, 18, i, 2, true, true});
    }
    for (int e = 0; e < neph_extractor_count(); e++) {
        const struct neph_extractor *extractor = neph_extractor_at(e);
        for (int o = 0; extractor->options[o].name; o++) {
            const struct neph_option *option = &extractor->options[o];
            struct neph_settings settings = synthetic_settings(extractor);
            const bool is_choice = option->kind == NEPH_OPTION_CHOICE;
            for (int w = 0; is_choice && option->choices[w]; w++) {
                settings.values[o] = w;
                measure_with(extractor, settings, reference, test);
            }
            for (int end = 0; !is_choice && end < 2; end++) {
                settings.values[o] = end ? option->maximum : option->minimum;
                measure_with(extractor, settings, reference, test);
            }
        }
    }
    for (int i = 0; i < 2; i++) {
        neph_image_destroy(reference[i]);
        neph_image_destroy(test[i]);
    }
}

#include "tests/main.h"
