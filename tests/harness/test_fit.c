/* SPDX-License-Identifier: MIT
 *
 * Fits of media: the model against the transport that it is made of, the coverage of intervals
 * under noise, what is not determined, and the factors of mistakes.
 */
#include "tests/scene_builders.h"

#include "harness/fit/answer.h"
#include "harness/fit/fit.h"
#include "truth/transport.h"

enum { WIDTH = 16, HEIGHT = 10, PIXELS = WIDTH * HEIGHT };

/* A coloured block with a sun, seen from the side. */
static void make_scene(struct neph_scene *scene, struct neph_camera_key *key,
                       struct neph_rgb albedo, double extinction_per_m)
{
    memset(scene, 0, sizeof(*scene));
    *key = (struct neph_camera_key){.position_m = {0, 1, 6}, .look_at_m = {0, 0.7, 0}};
    scene->camera_key_count = 1;
    scene->camera_keys = key;
    scene->camera_up = (struct neph_vec3){0, 1, 0};
    scene->vertical_fov_rad = 0.7;
    scene->frame_count = 1;
    scene->scattering = NEPH_SCATTERING_SINGLE;
    scene->sun = (struct neph_sun){
        true, neph_vec3_normalize((struct neph_vec3){0.5, 0.5, -0.7}), {3, 3, 3}};
    scene->background_w_per_m2_sr = (struct neph_rgb){0.3, 0.4, 0.5};
    scene->medium_count = 1;
    scene->media[0] = (struct neph_medium){
        .kind = NEPH_MEDIUM_HOMOGENEOUS,
        .bounds = {{-2, 0, -2}, {2, 1.5, 1}},
        .extinction_color = white,
        .albedo = albedo,
        .phase = {NEPH_PHASE_HENYEY_GREENSTEIN, 0.5},
        .extinction_per_m = extinction_per_m,
        .layer_count = 1,
        .layers = {{extinction_per_m, 0.0, 0.0}},
    };
}

/* Noise of a tenth of the mean: of each value, or (`is_shared`) the same in an eighth of a row. */
struct noise {
    double sigma;
    bool is_shared;
    uint64_t seed;
};

/* By Box and Muller. */
static double draw(uint64_t *seed)
{
    return sqrt(-2.0 * log(neph_test_uniform(seed, 1e-15, 1.0))) *
           cos(neph_test_uniform(seed, 0.0, 2.0 * M_PI));
}

static struct neph_image *make_frame(const struct neph_scene *scene, bool has_transmittance,
                                     struct noise *noise)
{
    const struct neph_camera camera = neph_scene_camera(scene, 0.0);
    struct neph_image *image;
    float *rgb[3], *transmittance[3];
    double shared = 0.0;
    neph_assert_ok(neph_image_create(WIDTH, HEIGHT, &image, NULL), NULL);
    neph_assert_ok(neph_image_add_rgb(image, NULL, rgb, NULL), NULL);
    if (has_transmittance)
        neph_assert_ok(neph_image_add_rgb(image, "transmittance", transmittance, NULL), NULL);
    for (int i = 0; i < PIXELS; i++) {
        const struct neph_pixel_ray ray = neph_camera_ray(&camera, WIDTH, HEIGHT, i % WIDTH,
                                                          i / WIDTH);
        const struct neph_ray_light light = neph_transport_ray(scene, ray.origin_m, ray.direction);
        const double radiance[3] = {light.radiance.r, light.radiance.g, light.radiance.b};
        if (i % (WIDTH / NEPH_FIT_TILES) == 0)
            shared = noise ? noise->sigma * draw(&noise->seed) : 0.0;
        for (int c = 0; c < 3; c++) {
            const double error = noise && !noise->is_shared ? noise->sigma * draw(&noise->seed)
                                                            : shared;
            rgb[c][i] = (float)(radiance[c] + error);
        }
        for (int c = 0; c < 3 && has_transmittance; c++)
            transmittance[c][i] = (float)(&light.transmittance.r)[c];
    }
    return image;
}

struct case_ {
    struct neph_fit_pixels pixels;
    struct neph_fit fit;
    struct neph_fit_verdict verdict;
};

/* Fit `scene` to a frame of `truth`. */
static void solve(const struct neph_scene *scene, const struct neph_scene *truth,
                  bool has_transmittance, struct noise *noise, struct case_ *made)
{
    struct neph_diag diag = {.message = ""};
    struct neph_image *image = make_frame(truth, has_transmittance, noise);
    const struct neph_fit_source source = {scene, image, NULL, PIXELS};
    *made = (struct case_){.fit = {.scene = scene, .pixels = &made->pixels}};
    for (int k = 0; k < NEPH_FIT_UNKNOWN_COUNT; k++)
        made->fit.is_free[k] = true;
    neph_assert_ok(neph_fit_pixels_take(&source, &made->pixels, &diag), &diag);
    neph_image_destroy(image);
    neph_assert_ok(neph_fit_solve(&made->fit, &diag), &diag);
    neph_assert_ok(neph_fit_judge(&made->fit, &made->verdict, &diag), &diag);
}

/* Whether all forms of the answer can be made. */
static void check_answer(const struct case_ *made)
{
    const struct neph_fit_answer answer = {&made->fit, &made->verdict, "frame.exr"};
    OWNED(memory) char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    assert_non_null(out);
    neph_fit_print(&answer, false, out);
    fclose(out);
    assert_non_null(strstr(text, made->verdict.agrees ? " agrees with " : " differs from "));
    assert_non_null(strstr(text, "held fixed: "));
    json_t *json = neph_fit_json(&answer);
    assert_non_null(json);
    json_decref(json);
}

static void finish(struct case_ *made)
{
    check_answer(made);
    neph_fit_finish(&made->fit);
    neph_fit_pixels_finish(&made->pixels);
}

/* A prediction with changed unknowns is the light of a scene with these values. */
static void test_the_model_is_the_transport(void **state)
{
    struct neph_scene scene, changed;
    struct neph_camera_key key;
    struct neph_fit_pixels pixels;
    struct neph_fit_model *model;
    static double predicted[PIXELS * NEPH_FIT_QUANTITY_COUNT * 3];
    make_scene(&scene, &key, (struct neph_rgb){0.5, 0.4, 0.3}, 0.8);
    make_scene(&changed, &key, (struct neph_rgb){0.6, 0.48, 0.36}, 0.8 * 1.7);
    changed.media[0].phase.g = -0.2;
    struct neph_image *image = make_frame(&scene, true, NULL);
    const struct neph_fit_source source = {&scene, image, NULL, PIXELS};
    neph_assert_ok(neph_fit_pixels_take(&source, &pixels, NULL), NULL);
    neph_assert_ok(neph_fit_model_create(&scene, &pixels, &model, NULL), NULL);
    const struct neph_fit_base base = neph_fit_scene_base();
    const struct neph_fit_point point = {{log(1.7), log(1.2), -0.2, 0.0}};
    neph_assert_ok(neph_fit_predict(model, &base, &point, NEPH_FIT_LINEAR, predicted, NULL), NULL);
    for (int i = 0; i < pixels.count; i++) {
        const struct neph_pixel_ray *ray = &pixels.list[i].ray;
        const struct neph_ray_light light = neph_transport_ray(&changed, ray->origin_m,
                                                               ray->direction);
        for (int c = 0; c < 3; c++) {
            neph_assert_close(predicted[6 * i + c], (&light.radiance.r)[c], 1e-12, 1e-15);
            neph_assert_close(predicted[6 * i + 3 + c], (&light.transmittance.r)[c], 1e-12, 0.0);
        }
    }
    neph_fit_model_destroy(model);
    neph_fit_pixels_finish(&pixels);
    neph_image_destroy(image);
}

/* Intervals of 95 % hold the truth at least as often as in 99.9 % of such experiments (normal
 * approximation of the binomial: 3.1 standard deviations). They are at most half as wide again as
 * the spread of the values needs. */
static void test_coverage(void **state)
{
    const int count = neph_test_paths(90);
    for (int is_shared = 0; is_shared < 2; is_shared++) {
        struct neph_scene scene;
        struct neph_camera_key key;
        struct noise noise = {0.01, is_shared, 48};
        int held[3] = {0};
        double squares[3] = {0.0}, widths[3] = {0.0};
        make_scene(&scene, &key, make_grey(0.8), 0.8);
        for (int i = 0; i < count; i++) {
            struct case_ made;
            solve(&scene, &scene, false, &noise, &made);
            for (int k = 0; k < 3; k++) {
                const struct neph_fit_estimate *found = &made.fit.best.list[k];
                const double own = k == NEPH_FIT_ASYMMETRY ? 0.5 : 1.0;
                assert_true(found->is_determined);
                held[k] += found->low <= own && own <= found->high;
                squares[k] += (found->value - own) * (found->value - own) / count;
                widths[k] += (found->high - found->low) / count;
            }
            finish(&made);
        }
        for (int k = 0; k < 3; k++) {
            assert_true(held[k] >= 0.95 * count - 3.1 * sqrt(0.05 * 0.95 * count));
            if (count >= 30)
                assert_true(widths[k] < 1.5 * 2.0 * 1.96 * sqrt(squares[k]));
        }
    }
}

/* Thin and black behind: only extinction times albedo, and with a transmittance both. */
static void test_a_thin_medium(void **state)
{
    struct neph_scene scene, truth;
    struct neph_camera_key key;
    struct case_ made;
    make_scene(&scene, &key, make_grey(0.8), 0.8);
    make_scene(&truth, &key, make_grey(0.8), 0.8e-3);
    scene.background_w_per_m2_sr = truth.background_w_per_m2_sr = make_grey(0.0);
    solve(&scene, &truth, false, NULL, &made);
    assert_false(made.fit.best.list[NEPH_FIT_ALBEDO].is_determined);
    assert_true(made.fit.best.scattering.is_determined && made.fit.is_held[NEPH_FIT_ALBEDO]);
    neph_assert_close(made.fit.best.scattering.value, 1e-3, 1e-3, 0.0);
    neph_assert_close(made.fit.held.list[NEPH_FIT_EXTINCTION].value, 1e-3, 1e-3, 0.0);
    assert_int_equal(made.verdict.count, 1);
    finish(&made);
    solve(&scene, &truth, true, NULL, &made);
    assert_true(made.fit.best.list[NEPH_FIT_ALBEDO].is_determined);
    neph_assert_close(made.fit.best.list[NEPH_FIT_EXTINCTION].value, 1e-3, 1e-3, 0.0);
    finish(&made);
}

/* No light comes from behind, and more extinction changes nothing: it has a smallest factor. */
static void test_an_opaque_medium(void **state)
{
    struct neph_scene scene, truth;
    struct neph_camera_key key;
    struct case_ made;
    make_scene(&scene, &key, make_grey(0.8), 0.8);
    make_scene(&truth, &key, make_grey(0.8), 800.0);
    scene.media[0].bounds = truth.media[0].bounds = (struct neph_bounds){{-9, -9, -9}, {9, 9, 1}};
    scene.sun.direction = truth.sun.direction = (struct neph_vec3){0.36, 0.48, 0.8};
    solve(&scene, &truth, true, NULL, &made);
    assert_false(made.fit.held.list[NEPH_FIT_EXTINCTION].is_determined);
    assert_true(made.fit.extinction_min > 2.5 && made.fit.extinction_min <= 1000.0);
    assert_true(isinf(made.fit.extinction_max));
    assert_int_equal(made.verdict.count, 1);
    assert_string_equal(made.verdict.list[0].name, "density in 1/km taken for 1/m");
    finish(&made);
}

/* Numbers that stand for scattering or extinction, for an albedo that differs between channels: the
 * scattering of the frame is the extinction of the scene, or the reverse. */
static void test_scattering_and_extinction(void **state)
{
    const struct neph_rgb own = {0.9, 0.6, 0.3};
    struct neph_fit_mistake mistake;
    int count = 0;
    for (int i = 0; neph_fit_mistake_at(i, own.r, &mistake); i++) {
        const bool is_scattering = !strcmp(mistake.name, "extinction taken for scattering");
        struct neph_scene scene, truth;
        struct neph_camera_key key;
        struct case_ made;
        if (!is_scattering && strcmp(mistake.name, "scattering taken for extinction") != 0)
            continue;
        make_scene(&scene, &key, own, 0.8);
        make_scene(&truth, &key, own, 0.8);
        for (int c = 0; c < 3; c++) {
            double *color = &(&truth.media[0].extinction_color.r)[c];
            double *albedo = &(&truth.media[0].albedo.r)[c];
            neph_fit_mistake_at(i, (&own.r)[c], &mistake);
            *color *= mistake.extinction;
            *albedo *= mistake.albedo;
            if (is_scattering)
                neph_assert_close(*color * *albedo, 1.0, 1e-12, 0.0);
            else
                neph_assert_close(*color, (&own.r)[c], 1e-12, 0.0);
        }
        solve(&scene, &truth, false, NULL, &made);
        assert_int_equal(made.verdict.count, 1);
        assert_string_equal(made.verdict.list[0].name, mistake.name);
        assert_string_equal(made.verdict.list[0].detail, mistake.detail);
        finish(&made);
        count++;
    }
    assert_int_equal(count, 5);
}

static void test_factors(void **state)
{
    static const struct {
        const char *name;
        double extinction, albedo;
    } expected[] = {
        {"exp2 taken for exp", 0.693147, 1},
        {"exp taken for exp2", 1.442695, 1},
        {"10^x taken for exp (base-10 optical density)", 2.302585, 1},
        {"exp taken for 10^x (base-10 optical density)", 0.43429448, 1},
        {"a missing 4 pi", 1, 12.56637},
        {"a 4 pi too much", 1, 0.0795775},
        {"density in 1/km taken for 1/m", 1000, 1},
        {"density in 1/m taken for 1/km", 0.001, 1},
    };
    for (size_t i = 0; i < COUNT(expected); i++) {
        struct neph_fit_mistake mistake;
        int at = 0;
        while (neph_fit_mistake_at(at, 0.5, &mistake) && strcmp(mistake.name, expected[i].name))
            at++;
        neph_assert_close(mistake.extinction, expected[i].extinction, 1e-6, 0.0);
        neph_assert_close(mistake.albedo, expected[i].albedo, 1e-6, 0.0);
    }
}

#include "tests/main.h"
