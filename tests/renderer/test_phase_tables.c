/* SPDX-License-Identifier: MIT
 *
 * Phase functions that reach the device as tables: the tables against the formulas, and frames of
 * the ray marcher against the exact transport for every such kind.
 */
#include "tests/renderer/fog_scenes.h"
#include "tests/renderer/frames.h"

#include "renderer/phase_tables.h"

#include <stdlib.h>

enum { HEAD = 3 }; /* values of a table before its rows */

/* Calls `check` with all trials of the kinds that have no file in shaders/. */
static void for_all(void (*check)(const struct neph_phase *phase, void *context), void *context)
{
    int count = 0;
    for (int kind = 0; kind < NEPH_PHASE_KIND_COUNT; kind++)
        for (int i = 0; i < neph_phase_row(kind)->trial_count; i++)
            if (!neph_phase_is_in_shaders(kind)) {
                check(&neph_phase_row(kind)->trials[i], context);
                count++;
            }
    assert_true(count >= 10);
}

/* 1e-4 between rows, as stated by renderer/phase_tables.h; 2^-22 for float32. */
static void check_table(const struct neph_phase *phase, void *context)
{
    const size_t size = neph_gpu_phase_table_size(phase);
    float *values = malloc(size * sizeof(*values));
    neph_gpu_phase_table_write(phase, values);
    const int count = (int)values[0];
    double worst = 0.0;
    assert_int_equal(size, HEAD + 3 * count);
    neph_assert_close((double)values[1], neph_phase_mean_cosine(phase), 1e-7, 1e-7);
    for (int i = 0; i + 1 < count; i++) {
        const float *row = values + HEAD + 3 * i;
        const double v = 0.5 * ((double)row[0] + (double)row[3]);
        const double middle = 0.5 * ((double)row[1] + (double)row[4]);
        assert_true(row[3] >= row[0] && row[5] >= row[2] && row[1] >= 0.0f);
        if (row[3] > row[0] && v > 1e-6) /* else a cosine does not resolve the angle */
            worst = fmax(worst, fabs(middle / neph_phase_per_sr(phase, 1.0 - v) - 1.0));
    }
    assert_true(values[2] == 0.0f); /* no tables of channels */
    assert_true(values[HEAD] == 0.0f && values[HEAD + 3 * (count - 1)] == 2.0f);
    neph_assert_close((double)values[HEAD + 3 * (count - 1) + 2], 1.0, 0.0, 1e-6);
    assert_true(worst < 1e-4 + 2.4e-7);
    *(double *)context = fmax(worst, *(double *)context);
    free(values);
}

static void test_tables_are_the_formulas(void **state)
{
    double worst = 0.0;
    for_all(check_table, &worst);
    print_message("between rows: at most %.1e\n", worst);
}

/* Single scattering in a fog, seen towards the sun and away from it. */
static void check_frame(const struct neph_phase *phase, void *context)
{
    const struct neph_march_params params = {.width_px = 16, .height_px = 9, .steps = 64};
    for (int away = 0; away <= 1; away++) {
        OWNED(media) struct test_scene test;
        double worst = 0.0, brightest = 0.0;
        test_scene_build(&test, scene_blob);
        test.scene.media[0].phase = *phase;
        const struct neph_vec3 ahead = neph_vec3_normalize(
            neph_vec3_sub(test.key.look_at_m, test.key.position_m));
        test.scene.sun.direction = neph_vec3_scale(ahead, away ? -1.0 : 1.0);
        OWNED(image) struct neph_image *frame = test_march(context, &test.scene, &params, NULL);
        const struct test_rgb volume = test_layer(frame, "volume");
        for (int p = 0; p < params.width_px * params.height_px; p++) {
            const struct neph_ray_light light = test_exact_ray(&test.scene, params.width_px,
                                                               params.height_px, p);
            worst = fmax(worst, fabs((double)volume.of[1][p] - light.volume.g));
            brightest = fmax(brightest, light.volume.g);
        }
        /* 2e-3 is the error of 64 steps through this blob (test_march_media.c). */
        assert_true(brightest > 0.0 && worst < 2e-3 * brightest);
    }
}

static void test_frames_are_exact(void **state)
{
    for_all(check_frame, *state);
}

#include "tests/renderer/main.h"
