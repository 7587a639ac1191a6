/* SPDX-License-Identifier: MIT
 *
 * The mean of the screen's rays over frames, counted from the first.
 */
#include "tests/renderer/screen_test.h"

enum { WIDTH = 41, HEIGHT = 27 };

/* A floor, a turned block on it, a ball of rough metal, and the sky. */
static void set_things(struct test_scene *test)
{
    test_scene_init(test);
    test->key.position_m = (struct neph_vec3){0.5, 1.2, 3.5};
    test->key.look_at_m = (struct neph_vec3){0.0, 0.5, 0.0};
    test->scene.scattering = NEPH_SCATTERING_MULTIPLE;
    test->scene.environment_light = true;
    test_add_box(test, (struct neph_vec3){-9, -1, -9}, (struct neph_vec3){9, 0, 9});
    test_add_box(test, (struct neph_vec3){-0.9, 0, -0.5}, (struct neph_vec3){-0.1, 0.9, 0.3});
    test->solids[1].turn = (struct neph_turn){1, cos(0.4), sin(0.4)};
    test_add_sphere(test, (struct neph_vec3){0.6, 0.4, 0.2}, 0.4);
    test->solids[2].surface.metalness = 1.0;
    test->solids[2].surface.roughness = 0.6;
}

/* ---- targets --------------------------------------------------------------------------------- */

struct picture {
    float *targets[SCREEN_TARGET_COUNT]; /* those that were read; owned */
};

static void read_targets(struct neph_screening *screen, const int *wanted, int count,
                         struct picture *picture)
{
    struct neph_diag diag = {0};
    *picture = (struct picture){{NULL}};
    for (int i = 0; i < count; i++) {
        float *texels = malloc(4 * WIDTH * HEIGHT * sizeof(*texels));
        neph_assert_ok(neph_screening_read(screen, wanted[i], texels, &diag), &diag);
        picture->targets[wanted[i]] = texels;
    }
}

static void drop(struct picture *picture)
{
    for (int t = 0; t < SCREEN_TARGET_COUNT; t++)
        free(picture->targets[t]);
}

static bool is_sky(const struct picture *picture, int p)
{
    return picture->targets[SCREEN_DEPTH][4 * p] >= 1e15f;
}

/* While nothing moves: the n-th frame counts 1 / n, until the history is full. */
static void test_the_mean_over_frames(void **state)
{
    struct test_scene test;
    double mean[WIDTH * HEIGHT] = {0.0};
    set_things(&test);
    struct neph_screening *screen = screen_of(*state, &test, WIDTH, HEIGHT,
                                              "ao=off ssr=off gi_smooth=0 gi_rays=1 gi_history=3");
    for (int frame = 1; frame <= 6; frame++) {
        struct picture picture;
        neph_image_destroy(screen_next(screen, &test));
        read_targets(screen,
                     (const int[]){SCREEN_DEPTH, SCREEN_GI_RAW, SCREEN_GI_MEAN, SCREEN_GI_COUNT}, 4,
                     &picture);
        const int count = frame < 4 ? frame : 4;
        for (int p = 0; p < WIDTH * HEIGHT; p++) {
            mean[p] += (picture.targets[SCREEN_GI_RAW][4 * p + 3] - mean[p]) / count;
            if (is_sky(&picture, p))
                continue;
            neph_assert_close(picture.targets[SCREEN_GI_COUNT][4 * p], count, 0.0, 0.0);
            neph_assert_close(picture.targets[SCREEN_GI_MEAN][4 * p + 3], mean[p], 0.0, 1e-3);
        }
        drop(&picture);
    }
    neph_screening_destroy(screen);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_the_mean_over_frames),
    };
    return cmocka_run_group_tests(tests, test_vulkan_setup, test_vulkan_teardown);
}
