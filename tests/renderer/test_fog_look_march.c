/* SPDX-License-Identifier: MIT
 *
 * The game-engine fog model in the ray marcher, in front of, between and behind marched media. It
 * is compared with the exact light of a fog that only emits, for which the model is physically
 * exact; with the engine fog_look; and between frames that must be equal.
 */
#include "tests/renderer/frames.h"

#include "renderer/fog_look.h"
#include "scenes/fog_translation.h"
#include "truth/fog_look.h"

enum { WIDTH = 24, HEIGHT = 16, PIXELS = WIDTH * HEIGHT };

/* Over ground, with a distant box; a thick blob in the fog, and a thin one above it. */
static void set_stage(struct test_scene *test)
{
    test_scene_init(test);
    test->key.position_m = (struct neph_vec3){3.0, 5.0, 20.0};
    test->key.look_at_m = (struct neph_vec3){0.0, 12.0, -40.0};
    test_add_box(test, (struct neph_vec3){-1e3, -1.0, -1e3}, (struct neph_vec3){1e3, 0.0, 1e3});
    test_add_box(test, (struct neph_vec3){10.0, 0.0, -220.0},
                 (struct neph_vec3){60.0, 70.0, -200.0});
    struct neph_medium *fog = test_add_medium(test, 0.01, 0.05, 0.0);
    test_add_layer(fog, 0.02, 0.4, 0.0);
    fog->albedo = make_grey(0.0);
    fog->emission_w_per_m2_sr = (struct neph_rgb){0.5, 0.75, 1.0};
    test_add(test, make_blob(0.08, (struct neph_vec3){-20.0, 20.0, -90.0}, 12.0));
    test_add(test, make_blob(0.02, (struct neph_vec3){15.0, 45.0, -110.0}, 15.0));
    test->scene.fog_look = neph_fog_look_of_physics(&test->scene, fog);
}

/* Moves clouds out of view: a scene with fog only then has the kernels of one with clouds. */
static void hide_clouds(struct test_scene *test)
{
    for (int m = 1; m < test->scene.medium_count; m++)
        test->scene.media[m].gaussian.center_m = (struct neph_vec3){0.0, -400.0, 900.0};
}

static struct neph_march_params params_of(int fog)
{
    return (struct neph_march_params){.width_px = WIDTH,
                                      .height_px = HEIGHT,
                                      .steps = 256,
                                      .lighting = NEPH_MARCH_SINGLE,
                                      .fog = neph_fog_for_march(fog)};
}

/* Mean over pixels of |a - b|, over the mean of b. */
static double distance(const float *a, const float *b)
{
    double off = 0.0, sum = 0.0;
    for (int i = 0; i < PIXELS; i++) {
        off += fabs((double)a[i] - (double)b[i]);
        sum += (double)b[i];
    }
    return off / sum;
}

/* A fog that absorbs and emits, with clouds in it and above it that scatter the remaining sunlight:
 * the ray marcher with the fog model equals `exact`, as it does with the fog as a medium. */
static void test_a_glowing_fog_and_clouds_are_exact(void **state)
{
    struct test_scene test;
    set_stage(&test);
    float radiance[PIXELS], through[PIXELS];
    for (int i = 0; i < PIXELS; i++) {
        const struct neph_ray_light light = test_exact_ray(&test.scene, WIDTH, HEIGHT, i);
        radiance[i] = (float)light.radiance.g;
        through[i] = (float)light.transmittance.g;
    }
    for (int fog = neph_test_by_day(1, 0); fog < 2; fog++) {
        const struct neph_march_params params = params_of(fog);
        OWNED(image) struct neph_image *image = test_march(*state, &test.scene, &params, NULL);
        const double off = distance(neph_image_channel(image, "G"), radiance);
        print_message("fog as a %s: off by %.2g\n", fog ? "look" : "medium", off);
        assert_true(off < (fog ? 1e-5 : 5e-3)); /* steps through the fog are longer */
        assert_true(distance(neph_image_channel(image, "transmittance.G"), through) < 1e-5);
    }
}

/* Splits a medium into two of half the extinction. */
static void cut_in_two(struct neph_scene *scene, int medium)
{
    scene->media[medium].extinction_per_m *= 0.5;
    scene->media[scene->medium_count++] = scene->media[medium];
}

static void swap(struct neph_medium *a, struct neph_medium *b)
{
    const struct neph_medium c = *a;
    *a = *b;
    *b = c;
}

/* Media split, in reverse order, with the fog's layers reversed, and all controls except positions
 * off: the same frame up to the rounding of sums. */
static void test_any_order_of_layers_is_the_same(void **state)
{
    struct test_scene test;
    set_stage(&test);
    test.scene.fog_look.max_opacity = 0.8;
    test.scene.fog_look.directional_w_per_m2_sr = make_grey(0.5);
    const struct neph_march_params params = params_of(1);
    OWNED(image) struct neph_image *whole = test_march(*state, &test.scene, &params, NULL);
    struct neph_medium *media = test.scene.media;
    cut_in_two(&test.scene, 1);
    cut_in_two(&test.scene, 2);
    swap(&media[0], &media[4]);
    swap(&media[1], &media[2]);
    const struct neph_fog_layer layer = media[4].layers[0];
    media[4].layers[0] = media[4].layers[1];
    media[4].layers[1] = layer;
    OWNED(image) struct neph_image *cut = test_march(*state, &test.scene, &params, NULL);
    const double off = test_distance(cut, whole, "G");
    print_message("cut and turned round: off by %.2g\n", off);
    assert_true(off < 3e-6);
}

/* Includes the near fog, which a march has nowhere to put. */
static struct neph_image *look_at(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                  enum neph_fog_model model)
{
    struct neph_fog_look_params params = {
        .width_px = WIDTH, .height_px = HEIGHT, .look = scene->fog_look, .model = model};
    params.look.volumetric_fog_distance_m = 0.0;
    OWNED(fog_looks) struct neph_fog_looks *looks = NULL;
    struct neph_image *image = NULL;
    struct neph_diag diag = {0};
    double gpu_s;
    neph_assert_ok(neph_fog_looks_create(vulkan, scene, &params, &looks, &diag), &diag);
    neph_assert_ok(neph_fog_looks_frame(looks, scene, 0.0, &image, &gpu_s, &diag), &diag);
    return image;
}

/* Without clouds the frame equals engine fog_look's, with every control that the scenes use. */
static void test_without_clouds_it_is_the_look(void **state)
{
    static const struct {
        const char *scene;
        enum neph_fog_model model;
    } looks[] = {{"catalog/fog_look_evening", NEPH_FOG_UNREAL},
                 {"catalog/fog_look_ridge", NEPH_FOG_UNREAL},
                 {"catalog/fog_look_ridge", NEPH_FOG_FILAMENT}};
    for (int n = 0; n < neph_test_by_day(1, 3); n++) {
        OWNED(scene) struct neph_scene *scene = test_load(looks[n].scene);
        const struct neph_march_params params = params_of(1 + (int)looks[n].model);
        OWNED(image)
        struct neph_image *marched = test_march(*state, scene, &params, NULL),
                          *look = look_at(*state, scene, looks[n].model);
        assert_true(test_distance(marched, look, "R") < 1e-5);
        assert_true(test_distance(marched, look, "volume.B") < 1e-5);
        assert_true(test_distance(marched, look, "transmittance.G") < 1e-5);
    }
}

/* ---- in real time ---------------------------------------------------------------------------- */

static struct neph_image *render_realtime(struct neph_vulkan *vulkan,
                                          const struct neph_scene *scene, const char *words)
{
    const struct neph_settings settings = test_preset("off", words);
    const struct neph_realtime_params params = {WIDTH, HEIGHT, &settings, 7, NULL};
    return test_film(vulkan, scene, &params, 1, NULL);
}

/* Without a split the frame equals the march. With one ray per sixteen pixels the clouds' light is
 * as coarse, and the background is not. Clouds in froxels are seen through the fog, too. */
static void test_realtime_has_the_same_fog(void **state)
{
    static const struct {
        const char *words;
        bool has_clouds;
        double most;
    } cases[] = {
        {"split=none fog=unreal steps=256", true, 1e-6},
        {"split=four ray_dither=none upscale_dither=none fog=unreal steps=64", false, 1e-3},
        {"split=four ray_dither=none upscale_dither=none fog=unreal steps=16 froxels=on "
         "froxel_px=1 froxel_near_m=100 froxel_slices=128 froxel_end_m=400 froxel_history=0 "
         "froxel_jitter=off",
         true, 1e-3},
    };
    for (int n = 0; n < neph_test_by_day(1, 3); n++) {
        struct test_scene test;
        set_stage(&test);
        if (!cases[n].has_clouds)
            test.scene.medium_count = 1;
        const struct neph_march_params params = params_of(1);
        OWNED(image)
        struct neph_image *marched = test_march(*state, &test.scene, &params, NULL),
                          *image = render_realtime(*state, &test.scene, cases[n].words);
        const double off = test_distance(image, marched, "G");
        print_message("fog in real time, %s: off by %.2g\n", cases[n].words, off);
        assert_true(off < cases[n].most);
    }
}

/* ---- near fog by froxels --------------------------------------------------------------------- */

static const char handed_over[] =
    "split=four ray_dither=none upscale_dither=none fog=unreal steps=64 froxels=on froxel_px=1 "
    "froxel_slices=128 froxel_history=0 froxel_jitter=off froxel_end_m=1 target_format=float";

/* An emitting fog is the same as a medium and in closed form, wherever the froxels end, before or
 * behind the visible points. All clouds are in froxels, with the froxels' errors. */
static void test_a_glow_is_handed_over_anywhere(void **state)
{
    static const struct {
        double handed_m;
        bool is_clear;
    } cases[] = {{60.0, true}, {300.0, false}, {15.0, true}, {300.0, true}};
    for (int n = 0; n < neph_test_by_day(2, 4); n++) {
        struct test_scene test;
        set_stage(&test);
        if (cases[n].is_clear)
            hide_clouds(&test);
        test.scene.fog_look.volumetric_fog_distance_m = cases[n].handed_m;
        const struct neph_march_params params = params_of(1);
        OWNED(image)
        struct neph_image *whole = test_march(*state, &test.scene, &params, NULL),
                          *image = render_realtime(*state, &test.scene, handed_over);
        const double off = test_distance(image, whole, "G");
        print_message("handed over at %g m, %s: off by %.2g\n", cases[n].handed_m,
                      cases[n].is_clear ? "fog alone" : "with clouds", off);
        assert_true(off < (cases[n].is_clear ? 1e-5 : 2e-3));
    }
}

/* Both fog models of a ray, one in front of the other, in double. */
static double handed_over_ray(const struct neph_scene *scene, const struct neph_pixel_ray *ray,
                              double handed_m)
{
    const struct neph_ray_light whole = neph_transport_ray(scene, ray->origin_m, ray->direction);
    const double behind = (whole.radiance.g - whole.volume.g) / whole.transmittance.g;
    struct neph_fog_look look = scene->fog_look;
    if (whole.hit_m <= handed_m)
        return whole.radiance.g;
    const struct neph_ray_light far = neph_transport_ray(
        scene, neph_vec3_along(ray->origin_m, ray->direction, handed_m), ray->direction);
    const double through = whole.transmittance.g / far.transmittance.g;
    look.volumetric_fog_distance_m = handed_m;
    const struct neph_fog_look_light beyond = neph_fog_look_ray(
        scene, &look, NEPH_FOG_UNREAL, ray->origin_m, ray->direction, whole.hit_m);
    return whole.volume.g - through * far.volume.g +
           through * (beyond.volume.g + beyond.transmittance * behind);
}

/* A sunlit fog with a different closed form: a medium up to the plane, the closed form behind it,
 * without a gap or an overlap. */
static void test_near_fog_is_physics(void **state)
{
    static const double handed_m = 60.0;
    struct test_scene test;
    set_stage(&test);
    hide_clouds(&test);
    test.scene.media[0].albedo = make_grey(0.9);
    test.scene.scattering = NEPH_SCATTERING_SINGLE;
    test.scene.fog_look.volumetric_fog_distance_m = handed_m;
    test.scene.fog_look.max_opacity = 0.7;
    const struct neph_camera camera = neph_scene_camera(&test.scene, 0.0);
    OWNED(image) struct neph_image *image = render_realtime(*state, &test.scene, handed_over);
    float expected[PIXELS];
    for (int i = 0; i < PIXELS; i++) {
        const struct neph_pixel_ray ray = test_ray(&test.scene, WIDTH, HEIGHT, i);
        const double slope = 1.0 / neph_vec3_dot(ray.direction, camera.forward);
        expected[i] = (float)handed_over_ray(&test.scene, &ray, handed_m * slope);
    }
    const double off = distance(neph_image_channel(image, "G"), expected);
    const struct neph_march_params params = params_of(1);
    OWNED(image) struct neph_image *looked = test_march(*state, &test.scene, &params, NULL);
    const double look_off = distance(neph_image_channel(looked, "G"), expected);
    print_message("near fog by physics: off by %.2g; by its look: by %.2g\n", off, look_off);
    assert_true(off < 1e-5);
    assert_true(look_off > 0.05);
}

/* ---- with the air of a planet ---------------------------------------------------------------- */

/* Black fog over the Earth's ground attenuates the sky's frame; emitting fog adds light that no air
 * attenuates. */
static void test_fog_before_the_sky(void **state)
{
    neph_test_waits_for_the_night();
    OWNED(scene) struct neph_scene *scene = test_load("catalog/sky_earth");
    struct neph_march_params params = params_of(0);
    params.steps = 8;
    params.sky = neph_sky_for_march((struct neph_march_sky_choices){true, false, 8, 8, 8, 6e4, 0});
    params.sky.tables.field.altitudes = 6;
    params.sky.tables.field.suns = 16;
    params.sky.tables.field.orders = 1;
    scene->scattering = NEPH_SCATTERING_SINGLE;
    OWNED(image) struct neph_image *clear = test_march(*state, scene, &params, NULL);
    scene->media[scene->medium_count++] = make_height_fog(1e-4, 0.01);
    scene->fog_look = neph_fog_look_only(&(struct neph_fog_look){.present = true}, 0);
    scene->fog_look.inscattering_w_per_m2_sr.g = 0.5;
    params.fog = neph_fog_for_march(1);
    OWNED(image) struct neph_image *fogged = test_march(*state, scene, &params, NULL);
    const float *clear_r = neph_image_channel(clear, "R"),
                *clear_g = neph_image_channel(clear, "G"), *r = neph_image_channel(fogged, "R"),
                *g = neph_image_channel(fogged, "G");
    const struct neph_camera camera = neph_scene_camera(scene, 0.0);
    int skies = 0;
    for (int i = 0; i < PIXELS; i++) {
        const struct neph_pixel_ray ray = test_ray(scene, WIDTH, HEIGHT, i);
        if (isfinite(neph_image_channel(fogged, "Z")[i]))
            continue; /* the ground's sunlight has crossed the fog */
        const double above = ray.direction.y,
                     depth = 1e-4 * exp(-0.01 * camera.position_m.y) / (0.01 * above);
        neph_assert_close(r[i], clear_r[i] * exp(-depth), 1e-4, 0.0);
        neph_assert_close(g[i], clear_g[i] * exp(-depth) - 0.5 * expm1(-depth), 1e-4, 0.0);
        skies++;
    }
    assert_true(skies > 100);
}

/* ---- refusals -------------------------------------------------------------------------------- */

static void refuses_under(const struct neph_scene *scene, struct neph_march_veils veils,
                          enum neph_march_lighting lighting, const char *words)
{
    char reason[256] = "";
    assert_false(neph_march_can_render_under(scene, veils, lighting, reason, sizeof(reason)));
    if (!strstr(reason, words))
        print_error("no '%s' in '%s'\n", words, reason);
    assert_non_null(strstr(reason, words));
}

static void refuses(const struct neph_scene *scene, int fog, enum neph_march_lighting lighting,
                    const char *words)
{
    refuses_under(scene, (struct neph_march_veils){.fog = neph_fog_for_march(fog)}, lighting,
                  words);
}

static void test_says_what_it_cannot(void **state)
{
    struct test_scene test;
    set_stage(&test);
    refuses(&test.scene, 2, NEPH_MARCH_SINGLE, "Filament has one");
    refuses(&test.scene, 1, NEPH_MARCH_HORIZON, "Horizon");
    struct neph_scene other = test.scene;
    other.fog_look.present = false;
    refuses(&other, 1, NEPH_MARCH_SINGLE, "without the key fog_look");
    other = test.scene;
    other.orthographic_height_m = 100.0;
    refuses(&other, 1, NEPH_MARCH_SINGLE, "orthographic");
    other = test.scene;
    other.media[0].extinction_color.g = 0.5;
    refuses(&other, 1, NEPH_MARCH_SINGLE, "one opacity");
    other = test.scene;
    other.scattering = NEPH_SCATTERING_MULTIPLE; /* of clouds */
    refuses(&other, 1, NEPH_MARCH_SINGLE, "multiple scattering");
    OWNED(scene) struct neph_scene *earth = test_load("catalog/sky_earth");
    earth->media[earth->medium_count++] = make_height_fog(1e-4, 0.01);
    earth->fog_look = (struct neph_fog_look){.present = true, .sky_light = white};
    refuses_under(earth, (struct neph_march_veils){true, neph_fog_for_march(1)}, NEPH_MARCH_OCTAVES,
                  "sky_light with sky=tables");
    other.medium_count = 1; /* nothing remains to march */
    char reason[256];
    const struct neph_march_veils look = {.fog = neph_fog_for_march(1)};
    assert_true(
        neph_march_can_render_under(&other, look, NEPH_MARCH_SINGLE, reason, sizeof(reason)));
}

#include "tests/renderer/main.h"
