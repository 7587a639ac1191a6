/* SPDX-License-Identifier: MIT
 *
 * Helpers for tests of extractors: an extractor that is driven through its functions, without
 * masks, pools and meter.
 */
#ifndef NEPH_TESTS_EXTRACTOR_TEST_H
#define NEPH_TESTS_EXTRACTOR_TEST_H

#include "tests/neph_test.h"

#include "metrics/extractor.h"
#include "metrics/extractors/pair_codes.h"

struct extraction {
    const struct neph_extractor *extractor;
    struct neph_settings settings;
    struct neph_viewing viewing;
    int width_px, height_px, plane_count;
    struct neph_arena *memory; /* of everything below */
    void *state;
    struct neph_pair_codes *codes;
};

/* Mean luminance of a quantity (depth: of its solid pixels), as the meter passes it. */
static inline double extraction_scene_mean(const float *const planes[3], int plane_count,
                                           size_t pixel_count)
{
    double sum = 0.0;
    size_t count = 0;
    for (size_t i = 0; i < pixel_count; i++) {
        double value = (double)planes[0][i];
        if (plane_count == 3)
            value = neph_luminance(value, (double)planes[1][i], (double)planes[2][i]);
        if (isfinite(value)) {
            sum += value;
            count++;
        }
    }
    return sum > 0.0 ? sum / (double)count : NAN;
}

/* A pair of whole images; `second` may be NULL, `viewing` must live as long as the pair. */
static inline struct neph_frame_pair extraction_pair(const struct neph_image *reference,
                                                     const struct neph_image *second,
                                                     const struct neph_image *test,
                                                     const char *quantity, int frame,
                                                     const struct neph_viewing *viewing)
{
    struct neph_frame_pair pair = {.quantity = neph_quantity_find(quantity),
                                   .width_px = reference->width_px,
                                   .height_px = reference->height_px,
                                   .reference_image = reference,
                                   .test_image = test,
                                   .frame = frame,
                                   .viewing = viewing};
    assert_non_null(pair.quantity);
    pair.plane_count = pair.quantity->plane_count;
    assert_true(neph_quantity_planes(pair.quantity, reference, pair.reference));
    assert_true(neph_quantity_planes(pair.quantity, test, pair.test));
    if (second)
        assert_true(neph_quantity_planes(pair.quantity, second, pair.reference_second));
    pair.scene_mean = extraction_scene_mean(pair.reference, pair.plane_count,
                                            neph_image_pixel_count(reference));
    return pair;
}

/* Begins an extraction. `assignments` are "key=value", NULL-terminated, or NULL. The viewing
 * conditions are the first pair's. The extractor must support the frames. */
static inline struct extraction extraction_begin(const struct neph_extractor *extractor,
                                                 const struct neph_frame_pair *first,
                                                 const char *const *assignments)
{
    struct extraction extraction = {.extractor = extractor,
                                    .settings = neph_options_default(extractor->options),
                                    .viewing = *first->viewing,
                                    .width_px = first->width_px,
                                    .height_px = first->height_px,
                                    .plane_count = first->plane_count};
    struct neph_diag diag = {0};
    for (int i = 0; assignments && assignments[i]; i++)
        neph_assert_ok(neph_options_set(extractor->options, extractor->name, assignments[i],
                                        &extraction.settings, &diag),
                       &diag);
    if (extractor->obstacle) {
        const char *obstacle = extractor->obstacle(first, &extraction.settings);
        if (obstacle)
            fail_msg("%s: %s", extractor->name, obstacle);
    }
    extraction.memory = calloc(1, sizeof(*extraction.memory));
    assert_non_null(extraction.memory);
    extraction.state = neph_arena_allocate(extraction.memory, 1, extractor->state_size);
    extraction.codes = neph_arena_allocate(extraction.memory, 1, sizeof(*extraction.codes));
    neph_assert_ok(neph_arena_check(extraction.memory, &diag), &diag);
    extraction.codes->memory = extraction.memory;
    struct neph_frame_pair pair = *first;
    pair.memory = extraction.memory;
    if (extractor->init)
        neph_assert_ok(extractor->init(extraction.state, &pair, &extraction.settings, &diag),
                       &diag);
    return extraction;
}

static inline void extraction_frame(struct extraction *extraction,
                                    const struct neph_frame_pair *pair)
{
    struct neph_diag diag = {0};
    struct neph_frame_pair with_codes = *pair;
    with_codes.codes = extraction->codes;
    with_codes.memory = extraction->memory;
    neph_pair_codes_forget(extraction->codes);
    neph_assert_ok(extraction->extractor->extract(extraction->state, &with_codes, &diag), &diag);
}

static inline void extraction_flush(struct extraction *extraction)
{
    struct neph_diag diag = {0};
    if (extraction->extractor->flush)
        neph_assert_ok(extraction->extractor->flush(extraction->state, &diag), &diag);
}

static inline int extraction_map_index(const struct neph_extractor *extractor, const char *name)
{
    for (int i = 0; i < extractor->map_count; i++)
        if (extractor->maps[i].name && strcmp(extractor->maps[i].name, name) == 0)
            return i;
    fail_msg("%s has no map '%s'", extractor->name, name);
    return -1;
}

/* Computes rows of a map in strips of `strip_rows`, planes one after another. */
static inline void extraction_fill(const struct extraction *extraction, int map, int strip_rows,
                                   double *values)
{
    size_t width = (size_t)extraction->width_px;
    size_t pixel_count = width * (size_t)extraction->height_px;
    for (int y = 0; y < extraction->height_px; y += strip_rows) {
        int row_count = y + strip_rows <= extraction->height_px ? strip_rows
                                                                : extraction->height_px - y;
        double *const planes[3] = {values + (size_t)y * width,
                                   values + pixel_count + (size_t)y * width,
                                   values + 2 * pixel_count + (size_t)y * width};
        extraction->extractor->rows(extraction->state, map, y, row_count, planes);
    }
}

/* A whole map, with memory for three planes; for the caller to free. The test fails if bits depend
 * on the strips, or if a value is infinite. */
static inline double *extraction_map(const struct extraction *extraction, int map)
{
    size_t pixel_count = (size_t)extraction->width_px * (size_t)extraction->height_px;
    int plane_count = extraction->extractor->maps[map].plane_count;
    if (plane_count == 0)
        plane_count = extraction->plane_count;
    double *values = calloc(3 * pixel_count, sizeof(*values));
    double *again = calloc(3 * pixel_count, sizeof(*again));
    assert_non_null(values);
    assert_non_null(again);
    extraction_fill(extraction, map, extraction->height_px, values);
    for (int strip_rows = 1; strip_rows <= 7; strip_rows += 6) {
        extraction_fill(extraction, map, strip_rows, again);
        assert_memory_equal(again, values, (size_t)plane_count * pixel_count * sizeof(*values));
    }
    for (size_t i = 0; i < (size_t)plane_count * pixel_count; i++)
        assert_true(isfinite(values[i]) || isnan(values[i]));
    free(again);
    return values;
}

/* The scalar of a metric by its name; fails when it is undefined. */
static inline double extraction_scalar(const struct extraction *extraction, const char *name)
{
    for (const struct neph_metric *metric = extraction->extractor->metrics; metric->name;
         metric++) {
        if (strcmp(metric->name, name) != 0)
            continue;
        assert_int_equal(metric->pool, NEPH_POOL_SCALAR);
        double value = NAN;
        const char *reason = extraction->extractor->scalar(extraction->state, metric->map, &value);
        if (reason)
            fail_msg("'%s' is undefined: %s", name, reason);
        return value;
    }
    fail_msg("%s has no metric '%s'", extraction->extractor->name, name);
    return NAN;
}

static inline void extraction_end(struct extraction *extraction)
{
    if (extraction->extractor->close)
        extraction->extractor->close(extraction->state);
    neph_pair_luma_end(extraction->codes);
    neph_arena_finish(extraction->memory);
    free(extraction->memory);
    extraction->memory = NULL;
}

/* Conditions on every table: names and help, metrics with a map, images with a scale. */
static inline void extraction_check_table(const struct neph_extractor *extractor)
{
    assert_true(extractor->name && extractor->help && extractor->source);
    assert_true(extractor->quantities != 0);
    assert_true(extractor->options && extractor->metrics);
    assert_true(extractor->map_count <= NEPH_MAPS_MAX);
    assert_non_null(extractor->extract);
    for (const struct neph_metric *metric = extractor->metrics; metric->name; metric++) {
        assert_true(metric->help && strlen(metric->help) > 0);
        assert_true(metric->low < metric->high);
        if (metric->pool == NEPH_POOL_SCALAR) {
            assert_non_null(extractor->scalar);
        } else {
            assert_true(metric->map >= 0 && metric->map < extractor->map_count);
            assert_true(metric->over >= 0 && metric->over < extractor->map_count);
        }
    }
    for (int i = 0; i < extractor->map_count; i++)
        assert_true(!extractor->maps[i].name || extractor->maps[i].scale > 0.0);
}

#endif
