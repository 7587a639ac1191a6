/* SPDX-License-Identifier: MIT
 *
 * What takes the noise out of the screen, pass by pass against its formula in double precision from
 * what the pass before has left: the blur of occlusion, the mean over frames, the smoothing.
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
    double half_width, half_height;
};

static void read_targets(struct neph_screening *screen, const struct test_scene *test,
                         const int *wanted, int count, struct picture *picture)
{
    struct neph_diag diag = {0};
    const struct neph_camera camera = neph_scene_camera(&test->scene, 0.0);
    *picture = (struct picture){.half_height = neph_camera_half_height(&camera)};
    picture->half_width = picture->half_height * WIDTH / HEIGHT;
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

/* In the camera's axes. */
static struct neph_vec3 place_of(const struct picture *picture, int p)
{
    const double depth_m = picture->targets[SCREEN_DEPTH][4 * p];
    return (struct neph_vec3){
        (2.0 * (p % WIDTH + 0.5) / WIDTH - 1.0) * picture->half_width * depth_m,
        (1.0 - 2.0 * (p / WIDTH + 0.5) / HEIGHT) * picture->half_height * depth_m, depth_m};
}

static struct neph_vec3 normal_of(const struct picture *picture, int p)
{
    const float *normal = &picture->targets[SCREEN_NORMAL][4 * p];
    return neph_vec3_normalize((struct neph_vec3){normal[0], normal[1], normal[2]});
}

/* 1 in the plane, 0 from a slope of 1:10 on. */
static double in_plane(const struct picture *picture, int p, int neighbour)
{
    const struct neph_vec3 way_m = neph_vec3_sub(place_of(picture, neighbour),
                                                 place_of(picture, p));
    const double off_m = fabs(neph_vec3_dot(way_m, normal_of(picture, p)));
    return p == neighbour ? 1.0 : fmax(0.0, 1.0 - off_m / (0.1 * neph_vec3_length(way_m)));
}

/* The pixel beside another; -1: none, or the sky. */
static int beside(const struct picture *picture, int p, int dx, int dy)
{
    const int x = p % WIDTH + dx, y = p / WIDTH + dy;
    const bool inside = x >= 0 && y >= 0 && x < WIDTH && y < HEIGHT;
    return inside && !is_sky(picture, y * WIDTH + x) ? y * WIDTH + x : -1;
}

/* ---- twins ----------------------------------------------------------------------------------- */

static double blurred(const struct picture *picture, int p, int radius)
{
    double sum = 0.0, weights = 0.0;
    for (int dy = -radius; dy <= radius; dy++)
        for (int dx = -radius; dx <= radius; dx++) {
            const int q = beside(picture, p, dx, dy);
            if (q < 0)
                continue;
            const double rim = (abs(dx) == radius ? 0.5 : 1.0) * (abs(dy) == radius ? 0.5 : 1.0);
            const double weight = rim * in_plane(picture, p, q);
            sum += weight * picture->targets[SCREEN_OPEN][4 * q];
            weights += weight;
        }
    return sum / weights;
}

/* One turn of the smoothing of a target's channel. */
static double smoothed(const struct picture *picture, int from, int p, int turn, int channel)
{
    static const double b3[3] = {0.375, 0.25, 0.0625};
    const double alpha = pow(picture->targets[SCREEN_NORMAL][4 * p + 3], 2.0);
    const double reach_px = from == SCREEN_SSR_MEAN ? 0.25 * alpha * HEIGHT / picture->half_height
                                                    : INFINITY;
    double sum = 0.0, weights = 0.0;
    for (int i = 0; i < 25; i++) {
        const int dx = i % 5 - 2, dy = i / 5 - 2;
        const int q = beside(picture, p, dx * (1 << turn), dy * (1 << turn));
        if (q < 0)
            continue;
        if (from == SCREEN_SSR_MEAN && !(picture->targets[SCREEN_BASE][4 * q + 3] > 0.0f))
            continue;
        const double facing = fmax(0.0,
                                   neph_vec3_dot(normal_of(picture, q), normal_of(picture, p)));
        const double far = hypot(dx, dy) * (1 << turn) / reach_px;
        const double near = q == p ? 1.0 : exp(-fmin(80.0, 0.5 * far * far));
        const double weight = b3[abs(dx)] * b3[abs(dy)] * in_plane(picture, p, q) *
                              pow(facing, 32.0) * near;
        sum += weight * picture->targets[from][4 * q + channel];
        weights += weight;
    }
    return weights > 0.0 ? sum / weights : picture->targets[from][4 * p + channel];
}

/* ---- tests ----------------------------------------------------------------------------------- */

static void test_the_blur(void **state)
{
    struct test_scene test;
    struct picture picture;
    set_things(&test);
    for (int radius = 1; radius <= 3; radius++) {
        char settings[64];
        snprintf(settings, sizeof(settings), "gi=off ssr=off ao_blur_px=%d", radius);
        struct neph_screening *screen = screen_of(*state, &test, WIDTH, HEIGHT, settings);
        neph_image_destroy(screen_next(screen, &test));
        read_targets(screen, &test,
                     (const int[]){SCREEN_DEPTH, SCREEN_NORMAL, SCREEN_OPEN, SCREEN_OPEN_SMOOTH}, 4,
                     &picture);
        for (int p = 0; p < WIDTH * HEIGHT; p++)
            neph_assert_close(picture.targets[SCREEN_OPEN_SMOOTH][4 * p],
                              is_sky(&picture, p) ? 1.0 : blurred(&picture, p, radius), 0.0, 2e-5);
        drop(&picture);
        neph_screening_destroy(screen);
    }
}

/* Either signal, by the targets that its first turn reads and writes. */
static void check_smoothing(const struct picture *picture, int from, int to)
{
    int count = 0;
    for (int p = 0; p < WIDTH * HEIGHT; p++) {
        const bool is_metal = picture->targets[SCREEN_BASE][4 * p + 3] > 0.0f;
        if (is_sky(picture, p) || (from == SCREEN_SSR_MEAN && !is_metal))
            continue;
        for (int c = 0; c < 4; c++)
            neph_assert_close(picture->targets[to][4 * p + c], smoothed(picture, from, p, 0, c),
                              2e-4, 2e-5);
        count++;
    }
    assert_true(count > 30);
}

static void test_the_smoothing(void **state)
{
    struct test_scene test;
    struct picture picture;
    set_things(&test);
    struct neph_screening *screen = screen_of(*state, &test, WIDTH, HEIGHT,
                                              "ao=off gi_smooth=1 ssr_smooth=1 gi_rays=1");
    neph_image_destroy(screen_next(screen, &test));
    read_targets(screen, &test,
                 (const int[]){SCREEN_DEPTH, SCREEN_NORMAL, SCREEN_BASE, SCREEN_GI_MEAN,
                               SCREEN_GI_A, SCREEN_SSR_MEAN, SCREEN_SSR_A},
                 7, &picture);
    check_smoothing(&picture, SCREEN_GI_MEAN, SCREEN_GI_A);
    check_smoothing(&picture, SCREEN_SSR_MEAN, SCREEN_SSR_A);
    drop(&picture);
    neph_screening_destroy(screen);
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
        read_targets(screen, &test,
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
        cmocka_unit_test(test_the_blur),
        cmocka_unit_test(test_the_smoothing),
        cmocka_unit_test(test_the_mean_over_frames),
    };
    return cmocka_run_group_tests(tests, test_vulkan_setup, test_vulkan_teardown);
}
