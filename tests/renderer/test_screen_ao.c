/* SPDX-License-Identifier: MIT
 *
 * Ambient occlusion of the screen against closed forms: a plane, a plane and a wall, a step.
 */
#include "tests/renderer/screen_test.h"

enum { WIDTH = 129, HEIGHT = 73 };

/* What is open of the hemisphere of a plane, as far as a radius, at a distance from a wall that
 * goes on for ever: the cap of Nusselt's disk beyond k = distance / radius is not. */
static double open_by_wall(double distance_m, double radius_m)
{
    const double k = distance_m / radius_m;
    return k >= 1.0 ? 1.0 : 1.0 - (acos(k) - k * sqrt(1.0 - k * k)) / M_PI;
}

/* At the foot of a step of some height, as far as one sees. */
static double open_by_step(double distance_m, double height_m)
{
    return 0.5 + 0.5 * distance_m / hypot(distance_m, height_m);
}

/* The camera looks down at the foot of a wall, which is the plane z = 0. */
static void set_corner(struct test_scene *test, double wall_m)
{
    test_scene_init(test);
    test->key.position_m = (struct neph_vec3){1.0, 4.0, 7.0};
    test->key.look_at_m = (struct neph_vec3){0.0, 0.8, 0.0};
    test_add_box(test, (struct neph_vec3){-1e3, -1.0, -1e3}, (struct neph_vec3){1e3, 0.0, 1e3});
    test_add_box(test, (struct neph_vec3){-1e3, 0.0, -10.0}, (struct neph_vec3){1e3, wall_m, 0.0});
}

struct gap {
    double mean, worst;
    int count;
};

/* Of ground pixels whose neighbourhood is in the picture. */
static struct gap ground_gap(const struct test_scene *test, const struct neph_image *image,
                             double (*open)(double, double), double length_m, double reach_m)
{
    const float *ao = neph_image_channel(image, "ao.R");
    struct gap gap = {0};
    for (int p = 0; p < image->width_px * image->height_px; p++) {
        struct neph_vec3 point_m;
        const struct neph_hit hit = screen_hit(test, image->width_px, image->height_px,
                                               p % image->width_px, p / image->width_px, &point_m);
        if (!hit.solid || hit.normal.y < 0.5 || point_m.z < 0.02 || point_m.z > reach_m ||
            fabs(point_m.x) > 0.7)
            continue;
        const double off = fabs(ao[p] - open(point_m.z, length_m));
        gap.mean += off;
        gap.worst = fmax(gap.worst, off);
        gap.count++;
    }
    gap.mean /= gap.count;
    return gap;
}

static void print_gap(const char *what, const char *settings, struct gap gap)
{
    printf("%-8s mean %.4f worst %.4f of %d: %s\n", what, gap.mean, gap.worst, gap.count, settings);
}

static void test_a_plane_is_open(void **state)
{
    struct test_scene test;
    set_corner(&test, 1.0);
    test.scene.solid_count = 1;
    static const char *const settings[] = {"ao=gtao","ao=gtao ao_sum=mean", "ao=gtao ao_places=pixel", "ao=gtao ao_slices=axis", "ao=ssao", "ao=unreal", "ao=unreal ao_places=pixel",
                                           "ao=gtao ao_radius_m=5 ao_directions=32 ao_steps=64 ao_noise=off ao_blur_px=0"};
    for (size_t i = 0; i < COUNT(settings); i++) {
        struct neph_image *image = screen_picture(*state, &test, WIDTH, HEIGHT, settings[i]);
        const float *ao = neph_image_channel(image, "ao.R");
        double least = 1.0;
        for (int p = 0; p < WIDTH * HEIGHT; p++)
            least = fmin(least, ao[p]);
        printf("%.6f %s\n", least, settings[i]);
        neph_image_destroy(image);
    }
}

static void test_the_foot_of_a_wall(void **state)
{
    struct test_scene test;
    set_corner(&test, 100.0);
    static const char *const settings[] = {
        "ao=gtao", "ao=gtao ao_blur_px=0 ao_noise=off ao_directions=6", "ao=gtao ao_sum=mean ao_blur_px=0", "ao=gtao ao_sum=mean", "ao=gtao ao_places=pixel", "ao=gtao ao_slices=axis", "ao=ssao", "ao=unreal",
        "ao=gtao ao_directions=32 ao_steps=64 ao_noise=off ao_blur_px=0 ao_sum=mean",
        "ao=gtao ao_directions=32 ao_steps=64 ao_noise=off ao_blur_px=0",
        "ao=gtao ao_directions=32 ao_steps=64 ao_noise=off ao_blur_px=0 ao_places=pixel",
        "ao=gtao ao_directions=32 ao_steps=64 ao_noise=off ao_blur_px=0 ao_slices=axis",
        "ao=ssao ao_directions=32 ao_steps=64 ao_noise=off ao_blur_px=0",
        "ao=unreal ao_directions=32 ao_steps=64 ao_noise=off ao_blur_px=0",
    };
    for (size_t i = 0; i < COUNT(settings); i++) {
        struct neph_image *image = screen_picture(*state, &test, WIDTH, HEIGHT, settings[i]);
        print_gap("wall", settings[i], ground_gap(&test, image, open_by_wall, 1.0, 1.5));
        neph_image_destroy(image);
    }
}

static void test_the_foot_of_a_step(void **state)
{
    struct test_scene test;
    set_corner(&test, 1.0);
    static const char *const settings[] = {
        "ao=gtao ao_radius_m=1000",
        "ao=gtao ao_directions=32 ao_steps=64 ao_noise=off ao_blur_px=0 ao_radius_m=1000",
        "ao=gtao ao_directions=32 ao_steps=64 ao_noise=off ao_blur_px=0 ao_radius_m=1000 ao_slices=axis",
    };
    for (size_t i = 0; i < COUNT(settings); i++) {
        struct neph_image *image = screen_picture(*state, &test, WIDTH, HEIGHT, settings[i]);
        print_gap("step", settings[i], ground_gap(&test, image, open_by_step, 1.0, 1.5));
        neph_image_destroy(image);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_plane_is_open),
        cmocka_unit_test(test_the_foot_of_a_wall),
        cmocka_unit_test(test_the_foot_of_a_step),
    };
    return cmocka_run_group_tests(tests, test_vulkan_setup, test_vulkan_teardown);
}
