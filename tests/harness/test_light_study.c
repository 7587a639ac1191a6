/* SPDX-License-Identifier: MIT
 *
 * Values of the light study against closed forms: bins, bias and rms with planted noise, a view ray
 * in a slab, and a fit that recovers the coefficients of its truth.
 */
#include "tests/scene_builders.h"

#include "harness/data.h"
#include "harness/experiments/light.h"
#include "scenes/media.h"

/* ---- statistics ------------------------------------------------------------------------------ */

static void test_bins(void **state)
{
    for (int axis = 0; axis < NEPH_LIGHT_AXES; axis++) {
        const double *edges = neph_light_axes[axis].edges;
        for (int bin = 0; bin < NEPH_LIGHT_BINS; bin++) {
            assert_true(edges[bin] < edges[bin + 1]);
            assert_int_equal(neph_light_bin((enum neph_light_axis)axis, edges[bin]), bin);
            const double inside = isinf(edges[bin + 1]) ? 2.0 * edges[bin]
                                                        : 0.5 * (edges[bin] + edges[bin + 1]);
            assert_int_equal(neph_light_bin((enum neph_light_axis)axis, inside), bin);
        }
        assert_int_equal(neph_light_bin((enum neph_light_axis)axis, edges[NEPH_LIGHT_BINS]),
                         NEPH_LIGHT_BINS - 1);
        assert_int_equal(neph_light_bin((enum neph_light_axis)axis, edges[0] - 1e-3), -1);
        assert_int_equal(neph_light_bin((enum neph_light_axis)axis, NAN), -1);
    }
    /* A transmittance of a tenth is an edge, so dense parts are whole bins. */
    assert_int_equal(neph_light_bin(NEPH_LIGHT_EYE, -log(0.1) + 1e-12), 3);
    assert_int_equal(neph_light_bin(NEPH_LIGHT_EYE, -log(0.1) - 1e-12), 2);
}

static void test_sums_without_noise(void **state)
{
    struct neph_light_sums sums = {.count = 0}, first = {.count = 0}, second = {.count = 0};
    assert_true(isnan(neph_light_bias(&sums)) && isnan(neph_light_rms(&sums)));
    neph_light_sums_add(&first, 3.0, 1.0, 1.0);  /* error 2 */
    neph_light_sums_add(&second, 2.0, 3.0, 3.0); /* error -1 */
    neph_light_sums_merge(&sums, &first);
    neph_light_sums_merge(&sums, &second);
    assert_int_equal(sums.count, 2);
    neph_assert_close(neph_light_ratio(&sums), 5.0 / 4.0, 1e-15, 0.0);
    neph_assert_close(neph_light_bias(&sums), 0.25, 1e-15, 0.0);
    neph_assert_close(neph_light_rms(&sums), sqrt(2.5) / 2.0, 1e-15, 0.0);
    assert_true(neph_light_bias_noise(&sums) == 0.0);
}

/* A model 20 % too bright, with an error of 0.1 up and down; a truth of 1 whose seeds are off by up
 * to 0.8 each, eight times the model's error of a pixel. */
static void test_noise_is_taken_out(void **state)
{
    enum { COUNT_OF_PIXELS = 40000 };
    uint64_t seed = 16;
    struct neph_light_sums sums = {.count = 0};
    for (int i = 0; i < COUNT_OF_PIXELS; i++)
        neph_light_sums_add(&sums, 1.2 + (i % 2 ? 0.1 : -0.1),
                            1.0 + neph_test_uniform(&seed, -0.8, 0.8),
                            1.0 + neph_test_uniform(&seed, -0.8, 0.8));
    /* A uniform number of +-0.8 has a variance of 0.64 / 3, the mean of two half of it. */
    const double variance = 0.64 / 3.0, error = sqrt(variance / 2.0 / COUNT_OF_PIXELS);
    neph_assert_close(neph_light_bias_noise(&sums), 1.2 * error, 0.05, 0.0);
    neph_assert_close(neph_light_bias(&sums), 0.2, 0.0, 5.0 * 1.2 * error);
    /* The product's standard deviation is at most variance + 2 * 0.3 * sqrt(variance). */
    const double wide = (variance + 0.6 * sqrt(variance)) / sqrt(COUNT_OF_PIXELS);
    neph_assert_close(pow(neph_light_rms(&sums), 2.0), 0.04 + 0.01, 0.02, 5.0 * wide);
}

/* ---- view rays ------------------------------------------------------------------------------- */

/* A slab of optical depth 6 from y = -3 to 0, and the sun at an angle. */
static struct neph_scene make_slab(void)
{
    struct neph_scene scene = {.medium_count = 1, .scattering = NEPH_SCATTERING_MULTIPLE};
    const struct neph_bounds box = {{-1e5, -3.0, -1e5}, {1e5, 0.0, 1e5}};
    scene.media[0] = make_homogeneous(2.0, box);
    scene.sun.present = true;
    scene.sun.direction = (struct neph_vec3){0.6, 0.8, 0.0};
    scene.sun.irradiance_w_per_m2 = white;
    return scene;
}

static struct neph_pixel_ray look_down(double cosine)
{
    return (struct neph_pixel_ray){{0.0, 5.0, 0.0}, {sqrt(1.0 - cosine * cosine), -cosine, 0.0}};
}

/* Single scattering with scaled optical depths towards eye and sun. */
static double slab_lit(double depth, double cosine, double scale)
{
    return depth * neph_phi(scale * (1.0 + cosine / 0.8) * depth);
}

static void test_view_of_a_slab(void **state)
{
    const struct neph_scene scene = make_slab();
    for (double cosine = 0.1; cosine < 1.0; cosine += 0.2) {
        const struct neph_pixel_ray ray = look_down(cosine);
        const struct neph_light_view view = neph_light_view_compute(&scene, &ray, true);
        const double depth = 6.0 / cosine;
        const double half = log(2.0 / (1.0 + exp(-depth)));
        neph_assert_close(view.eye_depth, depth, 1e-9, 0.0);
        neph_assert_close(view.sun_depth, half * cosine / 0.8, 1e-6, 0.0);
        neph_assert_close(view.angle_rad, acos(0.6 * ray.direction.x - 0.8 * cosine), 1e-12, 0.0);
        /* 128 steps h: the error of the sun's exponent at the middle of each is (h k)^2 / 24 and
         * h^2 k / 12 as in test_march_light; 2e-4 of the depth is left out. */
        const double h = depth / 128.0, k = cosine / 0.8;
        for (int s = 0; s < NEPH_LIGHT_SCALES; s++)
            neph_assert_close(view.lit[s], slab_lit(depth, cosine, neph_light_scale(s)),
                              h * h * k * (k / 24.0 + 1.0 / 12.0) + 3e-4, 0.0);
    }
}

static void test_view_past_media(void **state)
{
    const struct neph_scene scene = make_slab();
    const struct neph_pixel_ray up = {{0.0, 5.0, 0.0}, {0.0, 1.0, 0.0}};
    const struct neph_light_view view = neph_light_view_compute(&scene, &up, true);
    assert_true(view.eye_depth == 0.0 && isnan(view.sun_depth));
    for (int s = 0; s < NEPH_LIGHT_SCALES; s++)
        assert_true(view.lit[s] == 0.0);
}

static void test_lit_between_scales(void **state)
{
    double lit[NEPH_LIGHT_SCALES], worst = 0.0;
    for (int s = 0; s < NEPH_LIGHT_SCALES; s++)
        lit[s] = slab_lit(30.0, 1.0, neph_light_scale(s));
    for (int s = 0; s < NEPH_LIGHT_SCALES; s++)
        neph_assert_close(neph_light_interpolate_lit(lit, neph_light_scale(s)), lit[s], 1e-12, 0.0);
    for (double scale = 1.0; scale > 1e-7; scale *= 0.9)
        worst = fmax(
            worst, fabs(neph_light_interpolate_lit(lit, scale) / slab_lit(30.0, 1.0, scale) - 1.0));
    print_message("worst between scales: %g\n", worst);
    /* (ln 2)^2 / 8 of the second derivative of ln((1 - e^-x) / x) over ln x, 0.4 at most. */
    assert_true(worst < 0.025);
}

static void test_octaves_of_a_slab(void **state)
{
    const struct neph_octaves octaves = {8, 0.7, 0.25, 0.5}; /* scales of 2^-2i are known */
    const struct neph_scene scene = make_slab();
    const struct neph_pixel_ray ray = look_down(0.5);
    const struct neph_light_view view = neph_light_view_compute(&scene, &ray, true);
    double sum = 0.0;
    for (int i = 0; i < 8; i++) {
        const struct neph_phase phase = {NEPH_PHASE_HENYEY_GREENSTEIN, 0.8 * pow(0.5, i)};
        sum += pow(0.7, i) * neph_phase_per_sr(&phase, cos(view.angle_rad)) *
               slab_lit(12.0, 0.5, pow(0.25, i));
    }
    const double h = 12.0 / 128.0, k = 0.5 / 0.8; /* as above */
    neph_assert_close(neph_light_octaves(&view, &octaves, 0.8, 0.9), 0.9 * sum,
                      h * h * k * (k / 24.0 + 1.0 / 12.0) + 3e-4, 0.0);
}

/* ---- the fit --------------------------------------------------------------------------------- */

enum { CELLS = 12, PIXELS = 40 };

/* Slabs at many angles, with the radiance of given coefficients. */
static void make_cell(const struct neph_octaves_fit *truth, int index,
                      struct neph_light_pixel pixels[PIXELS], struct neph_light_cell *cell)
{
    *cell = (struct neph_light_cell){.pixels = pixels, .pixel_count = PIXELS};
    cell->light.g = 0.3 * (index % 4);
    cell->light.albedo = 1.0 - 0.05 * (index / 4);
    const struct neph_octaves octaves = neph_octaves_compute(truth, cell->light.g,
                                                             cell->light.albedo);
    const struct neph_scene scene = make_slab();
    for (int p = 0; p < PIXELS; p++) {
        const struct neph_pixel_ray ray = look_down(0.1 + 0.8 * p / PIXELS);
        pixels[p].view = neph_light_view_compute(&scene, &ray, true);
        pixels[p].first = pixels[p].second = neph_light_octaves(&pixels[p].view, &octaves,
                                                                cell->light.g, cell->light.albedo);
    }
}

static void test_fit_finds_its_truth(void **state)
{
    static const struct neph_octaves_fit truth = {.contribution = {1.0, 0.5, 0.0, -1.0, 0.0},
                                                  .attenuation = {-0.5, -1.0, 0.0, 0.5, 0.0},
                                                  .eccentricity = {-1.0, 0.0, 0.0, 0.0, 0.0}};
    static const struct neph_octaves_fit halves = {.contribution = {0.0}};
    static struct neph_light_pixel pixels[CELLS][PIXELS];
    static struct neph_light_cell cells[CELLS];
    struct neph_octaves_fit fit;
    struct neph_diag diag = {.line = 0};
    for (int i = 0; i < CELLS; i++)
        make_cell(&truth, i, pixels[i], &cells[i]);
    const struct neph_light_study study = {.cells = cells, .cell_count = CELLS};
    neph_assert_ok(neph_light_fit(&study, &fit, &diag), &diag);
    const struct neph_light_verdict before = neph_light_fit_verdict(&study, &halves,
                                                                    NEPH_LIGHT_DENSE);
    const struct neph_light_verdict after = neph_light_fit_verdict(&study, &fit, NEPH_LIGHT_DENSE),
                                    whole = neph_light_fit_verdict(&study, &fit, NEPH_LIGHT_WHOLE);
    print_message("bias %g before, %g after\n", before.mean_bias, after.mean_bias);
    assert_int_equal(after.cell_count, CELLS);
    assert_true(before.mean_bias > 0.3);
    /* The ridge term pulls coefficients of about 1 with 4e-4 for each part of a cell; the resulting
     * bias is at most its root, 0.02; half of that is reached here. */
    assert_true(after.mean_bias < 0.01 && after.mean_rms < 0.02);
    assert_true(whole.mean_bias < 0.01 && whole.mean_rms < 0.02);
}

static void test_octaves_of_a_medium(void **state)
{
    static const struct neph_octaves_fit halves = {.contribution = {0.0}};
    const struct neph_octaves half = neph_octaves_compute(&halves, 0.7, 1.0);
    assert_true(half.count == 8 && half.contribution == 0.5 && half.attenuation == 0.5 &&
                half.eccentricity == 0.5);
    assert_true(neph_octaves_compute(&halves, 0.7, 0.0).contribution ==
                0.0); /* black stays black */
    for (double g = -0.9; g <= 0.99; g += 0.1)
        for (double albedo = 0.0; albedo <= 1.0; albedo += 0.05) {
            const struct neph_octaves made = neph_octaves_compute(&neph_octaves_fitted, g, albedo);
            assert_true(made.contribution >= 0.0 && made.contribution <= 1.0);
            assert_true(made.attenuation > 0.0 && made.attenuation < 1.0);
            assert_true(made.eccentricity > 0.0 && made.eccentricity < 1.0);
        }
}

/* ---- suites ---------------------------------------------------------------------------------- */

static void test_sweeps(void **state)
{
    const struct neph_light_sweep sweep = {.sun_count = 2,
                                           .albedo_count = 3,
                                           .suns_deg = {{30, 0}, {60, 180}},
                                           .albedo = {1.0, 0.9, 0.8}};
    assert_int_equal(neph_light_sweep_count(&sweep), 6);
    for (int i = 0; i < 6; i++) {
        const struct neph_relight light = neph_light_sweep_at(&sweep, i);
        assert_true(light.albedo == sweep.albedo[i % 3]);
        neph_assert_close(light.sun_elevation_rad, sweep.suns_deg[i / 3][0] * NEPH_RAD_PER_DEG,
                          1e-15, 0.0);
        assert_true(isnan(light.g) && isnan(light.density));
    }
    assert_int_equal(neph_light_sweep_count(&(struct neph_light_sweep){.sun_count = 0}), 1);
}

/* One sweep after the other. */
static void test_entries(void **state)
{
    const struct neph_light_entry entry = {
        .sweep_count = 2,
        .sweeps = {{.g_count = 2, .g = {0.1, 0.2}}, {.g_count = 3, .g = {0.3, 0.4, 0.5}}}};
    assert_int_equal(neph_light_entry_count(&entry), 5);
    for (int i = 0; i < 5; i++)
        neph_assert_close(neph_light_entry_at(&entry, i).g, 0.1 * (i + 1), 1e-15, 0.0);
}

/* Coverage that every suite must have. */
static void test_suites_cover(void **state)
{
    static const char *const names[] = {"tuning", "test", "test2"};
    for (size_t suite = 0; suite < COUNT(names); suite++) {
        struct neph_light_entry *entries;
        struct neph_arena arena = {.last = NULL};
        struct neph_diag diag = {.line = 0};
        int count, behind = 0, beside = 0, ahead = 0;
        double g_least = 1.0, g_most = 0.0, albedo_least = 1.0, albedo_most = 0.0;
        neph_assert_ok(neph_light_suite_find(names[suite], &arena, &entries, &count, &diag), &diag);
        for (int i = 0; i < count; i++)
            for (int cell = 0; cell < neph_light_entry_count(&entries[i]); cell++) {
                const struct neph_relight light = neph_light_entry_at(&entries[i], cell);
                const double azimuth_deg = fabs(light.sun_azimuth_rad) / NEPH_RAD_PER_DEG;
                behind += azimuth_deg > 120.0;
                beside += azimuth_deg >= 60.0 && azimuth_deg <= 120.0;
                ahead += azimuth_deg < 60.0;
                g_least = fmin(g_least, light.g);
                g_most = fmax(g_most, light.g);
                albedo_least = fmin(albedo_least, light.albedo);
                albedo_most = fmax(albedo_most, light.albedo);
            }
        assert_true(behind >= 15 && beside >= 15 && ahead >= 15);
        assert_true(g_least == 0.0 && g_most == 0.9 && albedo_most == 1.0);
        assert_true(albedo_least >= 0.9 && albedo_least <= 0.93);
        neph_arena_finish(&arena);
    }
}

/* ---- verdicts -------------------------------------------------------------------------------- */

static struct neph_light_sums off_by(double bias, int count)
{
    struct neph_light_sums sums = {.count = 0};
    for (int i = 0; i < count; i++)
        neph_light_sums_add(&sums, 1.0 + bias, 1.0, 1.0);
    return sums;
}

/* Dense parts and whole frames are judged separately; too few pixels are not judged. */
static void test_verdicts_of_parts(void **state)
{
    static struct neph_light_cell cells[3];
    const struct neph_light_study study = {.cells = cells, .cell_count = 3};
    const double whole[3] = {0.04, -0.1, 0.3};
    for (int i = 0; i < 3; i++)
        cells[i].gaps[0].all = off_by(whole[i], 40);
    cells[0].gaps[0].dense = off_by(-0.5, NEPH_LIGHT_PIXELS_MIN);
    cells[1].gaps[0].dense = off_by(-0.9, NEPH_LIGHT_PIXELS_MIN - 1);
    const struct neph_light_verdict of_dense = neph_light_find_verdict(&study, 0, NEPH_LIGHT_DENSE,
                                                                       NULL, NULL);
    assert_int_equal(of_dense.cell_count, 1);
    neph_assert_close(of_dense.worst_bias, 0.5, 1e-12, 0.0);
    const struct neph_light_verdict of_whole = neph_light_find_verdict(&study, 0, NEPH_LIGHT_WHOLE,
                                                                       NULL, NULL);
    assert_int_equal(of_whole.cell_count, 3);
    neph_assert_close(of_whole.mean_bias, 0.44 / 3.0, 1e-12, 0.0);
    neph_assert_close(of_whole.share_within, 1.0 / 3.0, 1e-15, 0.0);
    neph_assert_close(of_whole.share_near, 2.0 / 3.0, 1e-15, 0.0);
    neph_assert_close(of_whole.share_smooth, 2.0 / 3.0, 1e-15, 0.0);
}

/* ---- models ---------------------------------------------------------------------------------- */

static void test_models_offered(void **state)
{
    char *words = neph_light_models_list(), *rest = words;
    assert_non_null(words);
    int count = 0, singles = 0;
    while (rest) {
        const char *word = strsep(&rest, ",");
        struct neph_light_model model;
        struct neph_diag diag = {.line = 0};
        neph_assert_ok(neph_light_model_parse(word, 99, NULL, &model, &diag), &diag);
        assert_true(neph_setting(model.engine, &model.settings, "steps") == 99.0);
        assert_null(strstr(word, "lighting=octaves")); /* march_octaves provides it */
        singles += strcmp(word, "march") == 0;
        count++;
    }
    assert_true(singles == 1 && count >= 4 && count <= NEPH_LIGHT_MODELS_MAX);
    free(words);
}

static void test_models_by_name(void **state)
{
    struct neph_light_model model;
    struct neph_diag diag = {.line = 0};
    neph_assert_ok(
        neph_light_model_parse("realtime+preset=ours+lighting=octaves", 77, NULL, &model, &diag),
        &diag);
    assert_true(neph_setting(model.engine, &model.settings, "steps") == 77.0);
    assert_true(neph_setting(model.engine, &model.settings, "warm_up") == NEPH_LIGHT_WARM_UP);
    assert_true(neph_light_model_is_non_physical(&model));
    neph_assert_ok(neph_light_model_parse("realtime+steps=5+warm_up=2", 77, NULL, &model, &diag),
                   &diag);
    assert_true(neph_setting(model.engine, &model.settings, "steps") == 5.0);
    assert_true(neph_setting(model.engine, &model.settings, "warm_up") == 2.0);
    assert_false(neph_light_model_is_non_physical(&model));
    static const char *const refused[] = {
        "tracer", "nothing", "", "march+preset=ours", "realtime+preset=none", "march+light=1"};
    for (size_t i = 0; i < sizeof(refused) / sizeof(refused[0]); i++)
        assert_int_equal(neph_light_model_parse(refused[i], 8, NULL, &model, &diag),
                         NEPH_ERR_USAGE);
}

/* Loads every scene whose data is installed, and lights every cell; under the sanitizers only the
 * fourth, a slab, as clouds take seconds of noise each. */
static void check_suite(const struct neph_light_entry *entries, int count)
{
    struct neph_diag diag = {.line = 0};
    assert_true(count >= 5);
    for (int i = NEPH_TEST_EVERY > 1 ? 3 : 0; i < count; i += NEPH_TEST_EVERY) {
        struct neph_scene *scene = NULL, *relit = NULL;
        const struct neph_light_entry *entry = &entries[i];
        const enum neph_status status = neph_data_load_scene(entry->scene, &scene, &diag);
        if (status == NEPH_ERR_NOT_FOUND && strstr(diag.message, "environment variable"))
            continue;
        neph_assert_ok(status, &diag);
        for (int cell = 0; cell < neph_light_entry_count(entry); cell++) {
            const struct neph_relight light = neph_light_entry_at(entry, cell);
            neph_assert_ok(neph_scene_relit(scene, &light, NEPH_SCATTERING_MULTIPLE, &relit, &diag),
                           &diag);
            neph_scene_destroy(relit);
        }
        neph_scene_destroy(scene);
    }
}

/* The last suite has no kind of medium beyond the others, and waits for the nightly tests. */
static void test_suites_share_nothing(void **state)
{
    enum { SUITES = 3 };
    static const char *const names[SUITES] = {"tuning", "test", "test2"};
    struct neph_diag diag = {.line = 0};
    struct neph_arena arena = {.last = NULL};
    struct neph_light_entry *suites[SUITES], *none;
    int counts[SUITES], none_count;
    for (int s = 0; s < SUITES; s++) {
        neph_assert_ok(neph_light_suite_find(names[s], &arena, &suites[s], &counts[s], &diag),
                       &diag);
        if (s < neph_test_by_day(2, SUITES))
            check_suite(suites[s], counts[s]);
        for (int other = 0; other < s; other++)
            for (int i = 0; i < counts[s]; i++)
                for (int j = 0; j < counts[other]; j++)
                    assert_string_not_equal(suites[s][i].scene, suites[other][j].scene);
    }
    assert_int_equal(neph_light_suite_find("both", &arena, &none, &none_count, &diag),
                     NEPH_ERR_USAGE);
    assert_non_null(strstr(diag.hint, "tuning"));
    neph_arena_finish(&arena);
}

#include "tests/main.h"
