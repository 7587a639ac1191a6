/* SPDX-License-Identifier: MIT
 *
 * Tests of screen-space ambient occlusion against closed forms: a plane, the foot of an infinite
 * wall, the foot of a box. Methods that approximate no integral are compared with their CPU
 * reference in check_screen.c.
 */
#include "renderer/screen/check_screen.h"

enum { WIDTH = 81, HEIGHT = 45 };

#define MANY "ao_directions=16 ao_steps=32 ao_noise=off ao_blur_px=0 "

/* ---- closed forms ---------------------------------------------------------------------------- */

/* Openness of a plane's hemisphere within 1 m at a distance from an infinite wall: Nusselt's disk
 * without the cap beyond k = distance / radius. */
static double open_by_wall(struct neph_vec3 point_m)
{
    const double k = point_m.z / 1.0;
    return k >= 1.0 ? 1.0 : 1.0 - (acos(k) - k * sqrt(1.0 - k * k)) / M_PI;
}

static const double block_half_m = 0.9, block_height_m = 0.8;

static double open_by_block(struct neph_vec3 point_m)
{
    return 1.0 - standing_rectangle(point_m.z, block_half_m - point_m.x, block_height_m) -
           standing_rectangle(point_m.z, block_half_m + point_m.x, block_height_m);
}

/* ---- scenes ---------------------------------------------------------------------------------- */

/* The camera looks down at the intersection of the ground and the plane z = 0. */
static void set_ground(struct test_scene *test)
{
    test_scene_init(test);
    test->key.position_m = (struct neph_vec3){1.0, 4.0, 7.0};
    test->key.look_at_m = (struct neph_vec3){0.0, 0.8, 0.0};
    test_add_box(test, (struct neph_vec3){-1e3, -1.0, -1e3}, (struct neph_vec3){1e3, 0.0, 1e3});
}

static void set_wall(struct test_scene *test)
{
    set_ground(test);
    test_add_box(test, (struct neph_vec3){-1e3, 0.0, -10.0}, (struct neph_vec3){1e3, 100.0, 0.0});
}

static void set_block(struct test_scene *test)
{
    set_ground(test);
    test_add_box(test, (struct neph_vec3){-block_half_m, 0.0, -1.0},
                 (struct neph_vec3){block_half_m, block_height_m, 0.0});
}

struct gap {
    double mean, worst;
    int count;
};

/* Over pixels of the ground near x = 0 and in front of the plane z = 0. */
static struct gap measure_gap(double (*open)(struct neph_vec3 point_m),
                              void (*set)(struct test_scene *), struct neph_vulkan *vulkan,
                              const char *settings)
{
    struct test_scene test;
    set(&test);
    OWNED(image) struct neph_image *image = screen_picture(vulkan, &test, WIDTH, HEIGHT, settings);
    const float *ao = neph_image_channel(image, "ao.R");
    struct gap gap = {0};
    for (int p = 0; p < WIDTH * HEIGHT; p++) {
        struct neph_vec3 point_m;
        const struct neph_hit hit = screen_hit(&test, WIDTH, HEIGHT, p % WIDTH, p / WIDTH,
                                               &point_m);
        if (!hit.solid || hit.normal.y < 0.5 || point_m.z < 0.02 || point_m.z > 1.5 ||
            fabs(point_m.x) > 0.7)
            continue;
        const double off = fabs(ao[p] - open(point_m));
        gap.mean += off;
        gap.worst = fmax(gap.worst, off);
        gap.count++;
    }
    assert_true(gap.count > 35);
    gap.mean /= gap.count;
    printf("mean %.4f worst %.4f of %d: %s\n", gap.mean, gap.worst, gap.count, settings);
    return gap;
}

/* ---- tests ----------------------------------------------------------------------------------- */

/* At any viewing angle. A mean over few slices does not reach 1, nor do samples at pixel centres,
 * as in the paper. */
static void test_a_plane_is_open(void **state)
{
    static const struct {
        const char *settings;
        double least, most;
    } cases[] = {
        {"ao=gtao", 0.9999, 1.0},
        {"ao=gtao ao_slices=axis ao_directions=1", 0.9999, 1.0},
        {"ao=gtao ao_sum=mean", 0.95, 0.99},
        {"ao=gtao ao_places=pixel", 0.9, 0.98},
        {"ao=ssao", 0.9999, 1.0},
        {"ao=unreal", 0.9999, 1.0},
        {"ao=gtao ao_radius_m=5 " MANY, 0.9999, 1.0}, /* nightly only */
    };
    struct test_scene test;
    set_ground(&test);
    for (int i = 0; i < neph_test_by_day(COUNT(cases) - 1, COUNT(cases)); i++) {
        OWNED(image)
        struct neph_image *image = screen_picture(*state, &test, WIDTH, HEIGHT, cases[i].settings);
        const float *ao = neph_image_channel(image, "ao.R");
        double least = 1.0;
        for (int p = 0; p < WIDTH * HEIGHT; p++)
            least = fmin(least, ao[p]);
        printf("%.6f %s\n", least, cases[i].settings);
        assert_true(least >= cases[i].least && least <= cases[i].most);
    }
}

/* With many slices the result converges to the integral; errors come from the steps and from the
 * angles between slices. The box is only a dozen pixels high, so half a pixel matters beside it. */
static void test_many_slices_are_the_integral(void **state)
{
    struct gap gap = measure_gap(open_by_wall, set_wall, *state, MANY "ao=gtao");
    assert_true(gap.mean < 0.005 && gap.worst < 0.01);
    gap = measure_gap(open_by_wall, set_wall, *state, MANY "ao=gtao ao_slices=axis ao_sum=mean");
    assert_true(gap.mean < 0.005 && gap.worst < 0.01);
    gap = measure_gap(open_by_block, set_block, *state, MANY "ao=gtao ao_radius_m=3");
    assert_true(gap.mean < 0.01 && gap.worst < 0.04);
}

/* The same point through an orthographic camera. */
static void test_an_orthographic_camera(void **state)
{
    struct test_scene test;
    set_wall(&test);
    test.scene.vertical_fov_rad = 0.0;
    test.scene.orthographic_height_m = 6.0;
    OWNED(image)
    struct neph_image *image = screen_picture(*state, &test, WIDTH, HEIGHT, MANY "ao=gtao");
    const float *ao = neph_image_channel(image, "ao.R");
    int count = 0;
    for (int p = 0; p < WIDTH * HEIGHT; p++) {
        struct neph_vec3 point_m;
        const struct neph_hit hit = screen_hit(&test, WIDTH, HEIGHT, p % WIDTH, p / WIDTH,
                                               &point_m);
        if (hit.normal.y < 0.5 || fabs(point_m.x) > 1.5 || point_m.z < 0.05 || point_m.z > 1.4)
            continue;
        neph_assert_close(ao[p], open_by_wall(point_m), 0.0, 0.015);
        count++;
    }
    assert_true(count > 60);
}

#include "tests/renderer/main.h"
