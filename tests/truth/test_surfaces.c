/* SPDX-License-Identifier: MIT
 *
 * Frames of light between solids: layers that add up, reported noise, refusals.
 */
#include "tests/scene_builders.h"

#include "truth/surfaces.h"

enum { WIDTH = 24, HEIGHT = 14, PIXELS = WIDTH * HEIGHT };

static void make_stage(struct test_scene *stage)
{
    test_scene_init(stage);
    stage->scene.scattering = NEPH_SCATTERING_MULTIPLE;
    stage->scene.environment_light = true;
    test_add_box(stage, (struct neph_vec3){-50, -1, -50}, (struct neph_vec3){50, 0, 50});
    test_add_box(stage, (struct neph_vec3){-1.5, 0, -7}, (struct neph_vec3){-0.5, 2, -6});
    test_add_sphere(stage, (struct neph_vec3){0.6, 1, -6}, 0.8);
    stage->solids[0].surface = (struct neph_surface){.metalness = 0.5, .roughness = 0.6};
}

static struct neph_surfaces_params make_params(void)
{
    return (struct neph_surfaces_params){.width_px = WIDTH,
                                         .height_px = HEIGHT,
                                         .seed = 5,
                                         .samples = 64,
                                         .limits = {NEPH_ALL_BOUNCES, INFINITY, NULL}};
}

static struct neph_image *rendered(const struct neph_scene *scene,
                                   const struct neph_surfaces_params *params)
{
    struct neph_image *image = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_surfaces_render(scene, params, &image, &diag), &diag);
    return image;
}

static float *const *layer(const struct neph_image *image, const char *name, float *samples[3])
{
    assert_true(neph_image_rgb(image, name, samples));
    return samples;
}

static void test_parts_make_the_picture(void **state)
{
    struct test_scene stage;
    make_stage(&stage);
    const struct neph_surfaces_params params = make_params();
    struct neph_image *image = rendered(&stage.scene, &params);
    float *all[3], *part[4][3], *color[2][3], *ao[3];
    layer(image, NULL, all);
    layer(image, "diffuse_direct", part[0]);
    layer(image, "diffuse_indirect", part[1]);
    layer(image, "glossy_direct", part[2]);
    layer(image, "glossy_indirect", part[3]);
    layer(image, "diffuse_color", color[0]);
    layer(image, "glossy_color", color[1]);
    layer(image, "ao", ao);
    const float *depth_m = neph_image_channel(image, "Z");
    const float *up = neph_image_channel(image, "normal.y");
    int ground = 0, sky = 0, hidden = 0;
    for (int p = 0; p < PIXELS; p++) {
        if (isinf(depth_m[p])) {
            assert_true(all[2][p] == 0.4f && ao[0][p] == 1.0f && color[0][0][p] == 0.0f);
            sky++;
            continue;
        }
        for (int j = 0; j < 3; j++)
            neph_assert_close(all[j][p],
                              color[0][j][p] * (part[0][j][p] + part[1][j][p]) +
                                  color[1][j][p] * (part[2][j][p] + part[3][j][p]),
                              1e-6, 0.0);
        assert_true(ao[0][p] >= 0.0f && ao[0][p] <= 1.0f);
        hidden += ao[0][p] < 1.0f;
        ground += up[p] == 1.0f;
    }
    assert_true(ground > 40 && sky > 40 && hidden > 20);
    neph_image_destroy(image);
}

/* The reported noise of a frame is the scatter between frames of different seeds. */
static void test_noise_is_told(void **state)
{
    static const char *const names[] = {"diffuse_indirect", "glossy_direct", "ao", NULL};
    struct test_scene stage;
    make_stage(&stage);
    struct neph_surfaces_params params = make_params();
    struct neph_image *first = rendered(&stage.scene, &params);
    params.seed = 6;
    struct neph_image *second = rendered(&stage.scene, &params);
    for (size_t i = 0; i < COUNT(names); i++) {
        float *a[3], *b[3], *told[3];
        char variance[NEPH_IMAGE_NAME_MAX];
        snprintf(variance, sizeof(variance), names[i] ? "variance.%s" : "variance", names[i]);
        layer(first, names[i], a);
        layer(second, names[i], b);
        layer(first, variance, told);
        double between = 0.0, sum = 0.0;
        for (int p = 0; p < PIXELS; p++) {
            between += pow(a[1][p] - b[1][p], 2) / 2;
            sum += told[1][p];
        }
        assert_true(sum > 0.0);
        neph_assert_close(between / sum, 1.0, 0.0, 0.5); /* about 150 pixels with heavy tails */
    }
    neph_image_destroy(first);
    neph_image_destroy(second);
}

/* Single scattering is only direct light. */
static void test_orders_of_scattering(void **state)
{
    struct test_scene stage;
    make_stage(&stage);
    stage.solids[0].surface = (struct neph_surface){0};
    stage.scene.scattering = NEPH_SCATTERING_SINGLE;
    const struct neph_surfaces_params params = make_params();
    struct neph_image *image = rendered(&stage.scene, &params);
    float *direct[3], *indirect[3];
    layer(image, "diffuse_direct", direct);
    layer(image, "diffuse_indirect", indirect);
    double sum = 0.0;
    for (int p = 0; p < PIXELS; p++) {
        assert_true(indirect[0][p] == 0.0f);
        sum += direct[0][p];
    }
    assert_true(sum > 0.0);
    neph_image_destroy(image);
}

static void test_what_is_out_of_range_is_refused(void **state)
{
    struct test_scene stage;
    struct neph_image *image = NULL;
    make_stage(&stage);
    struct neph_surfaces_params params = make_params();
    struct neph_diag diag = {0};
    params.samples = 1;
    assert_int_equal(neph_surfaces_render(&stage.scene, &params, &image, &diag), NEPH_ERR_USAGE);
    params = make_params();
    params.limits.bounces = -1;
    assert_int_equal(neph_surfaces_render(&stage.scene, &params, &image, &diag), NEPH_ERR_USAGE);
    params = make_params();
    params.limits.ao_distance_m = 0.0;
    assert_int_equal(neph_surfaces_render(&stage.scene, &params, &image, &diag), NEPH_ERR_USAGE);
    params = make_params();
    test_add(&stage, make_height_fog(0.1, 0.1));
    assert_int_equal(neph_surfaces_render(&stage.scene, &params, &image, &diag),
                     NEPH_ERR_UNSUPPORTED);
    assert_null(image);
}

#include "tests/main.h"
