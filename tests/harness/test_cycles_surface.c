/* SPDX-License-Identifier: MIT
 *
 * Surfaces of solids in Cycles: its input, its output and, where Blender is installed, its layers
 * against closed forms and truth/surfaces.h.
 */
#include "tests/harness/engine_test.h"
#include "tests/scene_builders.h"

#include "base/files.h"
#include "harness/engines/cycles_surface.h"
#include "harness/engines/engines.h"
#include "truth/surfaces.h"

#include <stdlib.h>
#include <unistd.h>

enum { WIDTH = 48, HEIGHT = 27, PIXELS = WIDTH * HEIGHT, SAMPLES = 256 };

static const double sigmas = 4.5;
static const double edges = 1e-3; /* one sample in a thousand is off by up to half a pixel */

/* ---- without Blender ------------------------------------------------------------------------- */

static void test_specs_of_plain_solids_are_unchanged(void **state)
{
    json_t *plain = neph_cycles_surface(&(struct neph_surface){0});
    assert_true(json_is_null(plain));
    json_decref(plain);
}

static void test_a_texture_is_an_image(void **state)
{
    struct neph_surface surface = {
        .metalness = 0.5,
        .roughness = 0.25,
        .texture = {.cell_m = 0.5, .pattern = NEPH_PATTERN_CHECKER, .other = {0.1, 0.2, 0.3}}};
    json_t *json = neph_cycles_surface(&surface);
    json_t *texture = json_object_get(json, "texture");
    json_t *pixels = json_object_get(texture, "pixels");
    assert_true(json_real_value(json_object_get(json, "roughness")) == 0.25);
    assert_int_equal(json_integer_value(json_object_get(texture, "side")), 2);
    for (size_t p = 0; p < 4; p++)
        assert_true(json_real_value(json_array_get(pixels, p)) == (p == 1 || p == 2));
    json_decref(json);
    surface.texture.pattern = NEPH_PATTERN_NOISE;
    surface.texture.seed = 7;
    json = neph_cycles_surface(&surface);
    texture = json_object_get(json, "texture");
    pixels = json_object_get(texture, "pixels");
    assert_int_equal(json_array_size(pixels), NEPH_NOISE_CELLS * NEPH_NOISE_CELLS);
    assert_true(json_real_value(json_array_get(pixels, NEPH_NOISE_CELLS + 3)) ==
                neph_noise_value(7, 3, 1));
    json_decref(json);
}

static void test_light_of_mirrors_is_refused(void **state)
{
    struct test_scene stage;
    char reason[256] = "";
    test_scene_init(&stage);
    stage.scene.scattering = NEPH_SCATTERING_MULTIPLE;
    test_add_sphere(&stage, (struct neph_vec3){0, 1, -5}, 1);
    stage.solids[0].surface.metalness = 1.0;
    assert_false(test_can_render(&neph_engine_cycles, &stage.scene, reason, sizeof(reason)));
    assert_non_null(strstr(reason, "with a mirror"));
    stage.solids[0].surface.roughness = 0.1;
    assert_true(test_can_render(&neph_engine_cycles, &stage.scene, reason, sizeof(reason)));
    stage.solids[0].surface.roughness = 0.0;
    stage.scene.sun.present = false;
    assert_true(test_can_render(&neph_engine_cycles, &stage.scene, reason, sizeof(reason)));
}

/* An image with Blender's layer names and 2 pixels, the second one sky. */
static struct neph_image *blender_picture(const char *left_out)
{
    static const char *const layers[] = {"pass.DiffDir",  "pass.DiffInd", "pass.GlossDir",
                                         "pass.GlossInd", "pass.DiffCol", "pass.GlossCol",
                                         "pass.AO"};
    struct neph_image *image = NULL;
    float *rgb[3], *depth;
    assert_int_equal(neph_image_create(2, 1, &image, NULL), NEPH_OK);
    for (size_t i = 0; i < COUNT(layers); i++) {
        if (strcmp(layers[i], left_out) == 0)
            continue;
        assert_int_equal(neph_image_add_rgb(image, layers[i], rgb, NULL), NEPH_OK);
        rgb[1][0] = rgb[1][1] = (float)(i + 1);
    }
    assert_int_equal(neph_image_add_channel(image, "pass.Depth.Z", &depth, NULL), NEPH_OK);
    depth[0] = 3.0f;
    depth[1] = 1e10f;
    return image;
}

static void test_layers_get_their_names(void **state)
{
    struct neph_diag diag = {0};
    struct neph_image *picture = blender_picture(""), *frame = NULL;
    float *rgb[3];
    assert_int_equal(neph_image_create(2, 1, &frame, NULL), NEPH_OK);
    neph_assert_ok(neph_cycles_surface_layers(picture, frame, &diag), &diag);
    assert_true(neph_image_rgb(frame, "glossy_indirect", rgb) && rgb[1][0] == 4.0f &&
                rgb[1][1] == 0.0f);
    assert_true(neph_image_rgb(frame, "diffuse_color", rgb) && rgb[1][0] == 5.0f);
    assert_true(neph_image_rgb(frame, "ao", rgb) && rgb[1][0] == 7.0f && rgb[2][1] == 1.0f);
    neph_image_destroy(frame);
    assert_true(neph_image_rgb(picture, "pass.GlossInd", rgb));
    rgb[2][1] = NAN;
    assert_int_equal(neph_image_create(2, 1, &frame, NULL), NEPH_OK);
    assert_int_equal(neph_cycles_surface_layers(picture, frame, &diag), NEPH_ERR_ENGINE);
    assert_non_null(strstr(diag.message, "pass.GlossInd"));
    neph_image_destroy(frame);
    neph_image_destroy(picture);
    picture = blender_picture("pass.AO");
    assert_int_equal(neph_image_create(2, 1, &frame, NULL), NEPH_OK);
    assert_int_equal(neph_cycles_surface_layers(picture, frame, &diag), NEPH_ERR_ENGINE);
    assert_non_null(strstr(diag.message, "pass.AO"));
    neph_image_destroy(frame);
    neph_image_destroy(picture);
}

/* ---- with Blender ---------------------------------------------------------------------------- */

static struct neph_image *render(const struct neph_scene *scene, const char *distance)
{
    struct neph_diag diag = {0};
    struct neph_cost cost = {0};
    struct neph_image *frame = NULL;
    struct neph_shot shot = {.scene = scene,
                             .settings = neph_settings_default(&neph_engine_cycles),
                             .width_px = WIDTH,
                             .height_px = HEIGHT,
                             .layers = NEPH_LAYER_RADIANCE | NEPH_LAYER_DEPTH,
                             .seed = 1,
                             .time_limit_s = 300.0};
    const char *const assignments[] = {"samples=256", "surface_layers=on", distance};
    for (size_t i = 0; i < COUNT(assignments); i++)
        neph_assert_ok(
            neph_settings_set(&neph_engine_cycles, &shot.settings, assignments[i], &diag), &diag);
    neph_assert_ok(test_render(&neph_engine_cycles, &shot, &frame, &cost, &diag), &diag);
    return frame;
}

static const double step_m = 1.0;

/* Ground and an infinite step, seen from above. */
static void make_step(struct test_scene *stage)
{
    test_scene_init(stage);
    stage->key.position_m = (struct neph_vec3){0, 4, 3};
    stage->key.look_at_m = (struct neph_vec3){0, 0, 0.2};
    stage->scene.scattering = NEPH_SCATTERING_MULTIPLE;
    test_add_box(stage, (struct neph_vec3){-1e4, -1, -1e4}, (struct neph_vec3){1e4, 0, 1e4});
    test_add_box(stage, (struct neph_vec3){-1e4, -1, -50}, (struct neph_vec3){1e4, step_m, -0.5});
}

/* A step hides half of what an infinite strip hides; up to a distance below the wall's height it
 * hides a segment of the unit disc: test_reflected.c. */
static double visible(double foot_m, double distance_m)
{
    if (isinf(distance_m))
        return 0.5 * (1 + foot_m / hypot(foot_m, step_m));
    const double c = fmin(1.0, foot_m / distance_m);
    return 1.0 - (acos(c) - c * sqrt(1 - c * c)) / M_PI;
}

static void check_ambient(const char *assignment, double distance_m)
{
    struct test_scene stage;
    make_step(&stage);
    struct neph_image *frame = render(&stage.scene, assignment);
    const struct neph_camera camera = neph_scene_camera(&stage.scene, 0.0);
    float *ao[3];
    double difference = 0.0, variance = 0.0;
    int ground = 0;
    assert_true(neph_image_rgb(frame, "ao", ao));
    for (int p = 0; p < PIXELS; p++) {
        const struct neph_pixel_ray ray = neph_camera_ray(&camera, WIDTH, HEIGHT, p % WIDTH,
                                                          p / WIDTH);
        const struct neph_hit hit = neph_scene_hit(&stage.scene, ray.origin_m, ray.direction);
        if (hit.solid != &stage.solids[0])
            continue;
        const double z_m = ray.origin_m.z + hit.t_m * ray.direction.z;
        const double expected = visible(z_m + 0.5, distance_m);
        difference += ao[1][p] - expected;
        variance += expected * (1 - expected) / SAMPLES;
        neph_assert_close(ao[1][p], expected, 0.0, 6.0 * sqrt(0.25 / SAMPLES));
        ground++;
    }
    assert_true(ground > 400);
    neph_assert_close(difference, 0.0, 0.0, sigmas * sqrt(variance));
    neph_image_destroy(frame);
}

static void test_ambient_of_a_step(void **state)
{
    check_ambient("ao_distance_m=0", INFINITY);
    check_ambient("ao_distance_m=0.9", 0.9);
}

/* Ground with noise, a block with a checker, a half-metal block, a ball of rough metal. */
static void make_things(struct test_scene *stage)
{
    test_scene_init(stage);
    stage->key.position_m = (struct neph_vec3){0.4, 1.7, 4};
    stage->key.look_at_m = (struct neph_vec3){0, 0.3, 0};
    stage->scene.scattering = NEPH_SCATTERING_MULTIPLE;
    stage->scene.environment_light = true;
    stage->scene.background_w_per_m2_sr = (struct neph_rgb){2, 2.5, 3};
    test_add_box(stage, (struct neph_vec3){-30, -1, -30}, (struct neph_vec3){30, 0, 30});
    test_add_box(stage, (struct neph_vec3){-1.4, 0, -0.9}, (struct neph_vec3){-0.6, 0.8, -0.1});
    test_add_box(stage, (struct neph_vec3){0.7, 0, -0.9}, (struct neph_vec3){1.4, 1.1, -0.2});
    test_add_sphere(stage, (struct neph_vec3){0, 0.4, 0.3}, 0.4);
    stage->solids[0].surface.texture = (struct neph_paint){
        .cell_m = 0.31, .pattern = NEPH_PATTERN_NOISE, .other = {0.1, 0.2, 0.1}, .seed = 4};
    stage->solids[1].surface.texture = (struct neph_paint){
        .cell_m = 0.22, .pattern = NEPH_PATTERN_CHECKER, .other = {0.9, 0.9, 0.9}};
    stage->solids[1].turn = (struct neph_turn){1, cos(0.4), sin(0.4)};
    stage->solids[2].surface = (struct neph_surface){.metalness = 0.5, .roughness = 0.6};
    stage->solids[3].surface = (struct neph_surface){.metalness = 1.0, .roughness = 0.4};
}

/* Contribution of a part to the frame. Cycles divides light by colour per pixel, with small
 * divisors at edges, so light per unit of colour has no useful mean. `color`: the factor; NULL:
 * none. */
static void compare_part(const struct neph_image *frame, const struct neph_image *truth,
                         const char *name, const char *color)
{
    float *a[3], *b[3], *told[3], *by_a[3], *by_b[3];
    char variance_name[NEPH_IMAGE_NAME_MAX];
    snprintf(variance_name, sizeof(variance_name), "variance.%s", name);
    assert_true(neph_image_rgb(frame, name, a) && neph_image_rgb(truth, name, b) &&
                neph_image_rgb(truth, variance_name, told));
    assert_true(!color ||
                (neph_image_rgb(frame, color, by_a) && neph_image_rgb(truth, color, by_b)));
    double difference = 0.0, variance = 0.0, sum = 0.0;
    for (int p = 0; p < PIXELS; p++) {
        const double scale_a = color ? by_a[1][p] : 1.0, scale_b = color ? by_b[1][p] : 1.0;
        difference += scale_a * a[1][p] - scale_b * b[1][p];
        variance += 2.0 * told[1][p] * scale_b * scale_b; /* both take equally many paths */
        sum += scale_b * b[1][p];
    }
    print_message("  %s: mean %.4g, off by %+.2e of it, noise %.1e\n", name, sum / PIXELS,
                  difference / sum, sqrt(variance) / sum);
    neph_assert_close(difference, 0.0, 0.0, sigmas * sqrt(variance) + edges * sum);
}

/* Patterns are in the right place. */
static void check_colors(const struct neph_image *frame, const struct neph_image *truth)
{
    static const char *const names[] = {"diffuse_color", "glossy_color"};
    for (size_t i = 0; i < COUNT(names); i++) {
        float *a[3], *b[3];
        int same = 0;
        assert_true(neph_image_rgb(frame, names[i], a) && neph_image_rgb(truth, names[i], b));
        for (int p = 0; p < PIXELS; p++)
            same += fabsf(a[1][p] - b[1][p]) < 2e-3f;
        print_message("  %s: the same at %d of %d pixels\n", names[i], same, PIXELS);
        assert_true(same > 0.97 * PIXELS);
    }
}

static void test_layers_against_the_truth(void **state)
{
    struct test_scene stage;
    struct neph_diag diag = {0};
    struct neph_image *truth = NULL;
    const struct neph_surfaces_params params = {.width_px = WIDTH,
                                                .height_px = HEIGHT,
                                                .seed = 2,
                                                .samples = SAMPLES,
                                                .limits = {NEPH_ALL_BOUNCES, 0.7, NULL}};
    make_things(&stage);
    struct neph_image *frame = render(&stage.scene, "ao_distance_m=0.7");
    neph_assert_ok(neph_surfaces_render(&stage.scene, &params, &truth, &diag), &diag);
    check_colors(frame, truth);
    compare_part(frame, truth, "ao", NULL);
    compare_part(frame, truth, "diffuse_direct", "diffuse_color");
    compare_part(frame, truth, "diffuse_indirect", "diffuse_color");
    compare_part(frame, truth, "glossy_direct", "glossy_color");
    compare_part(frame, truth, "glossy_indirect", "glossy_color");
    neph_image_destroy(frame);
    neph_image_destroy(truth);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_specs_of_plain_solids_are_unchanged),
        cmocka_unit_test(test_a_texture_is_an_image),
        cmocka_unit_test(test_light_of_mirrors_is_refused),
        cmocka_unit_test(test_layers_get_their_names),
    };
    const struct CMUnitTest engine_tests[] = {
        cmocka_unit_test(test_ambient_of_a_step),
        cmocka_unit_test(test_layers_against_the_truth),
    };
    if (neph_test_wants_engines(argc, argv))
        return test_has_engine(&neph_engine_cycles)
                   ? cmocka_run_group_tests(engine_tests, NULL, NULL)
                   : 0;
    return cmocka_run_group_tests(tests, NULL, NULL);
}
