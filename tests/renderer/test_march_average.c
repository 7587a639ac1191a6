/* SPDX-License-Identifier: MIT
 *
 * The ray marcher with several rays per pixel: positions of the rays, their mean, and edges that
 * cross pixels.
 */
#include "tests/renderer/frames.h"

#include "renderer/march_average.h"

static struct neph_march *open_march(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                     int width_px, int height_px)
{
    const struct neph_march_params params = {
        .width_px = width_px, .height_px = height_px, .steps = 8, .sun_steps = 1};
    return test_march_open(vulkan, scene, &params);
}

static struct neph_image *average(struct neph_march *march, const struct neph_scene *scene,
                                  int rays_per_px, struct neph_march_stats *stats)
{
    struct neph_image *image = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_march_average(march, scene, 0.0, rays_per_px, &image, stats, &diag), &diag);
    return image;
}

static struct neph_image *through(struct neph_march *march, const struct neph_scene *scene,
                                  const float jitter_px[2])
{
    struct neph_image *image = NULL;
    struct neph_diag diag = {0};
    const struct neph_march_moment moment = {.jitter_px = {jitter_px[0], jitter_px[1]}};
    neph_assert_ok(neph_march_frame(march, scene, 0.0, &moment, &image, NULL, &diag), &diag);
    return image;
}

/* Fog, and a sphere in it. */
static void fill(struct test_scene *test)
{
    test_scene_init(test);
    test_add_medium(test, 0.03, 0.05, 0.0);
    test_add_sphere(test, (struct neph_vec3){1.0, 2.0, -12.0}, 2.0);
}

/* Every elementary interval of base 2 and volume 1/n contains one point: columns, rows, and all
 * boxes in between. */
static void assert_net(int n)
{
    for (int columns = 1; columns <= n; columns *= 2) {
        int hits[NEPH_MARCH_RAYS_PER_PX_MAX] = {0};
        for (int i = 0; i < n; i++) {
            float at_px[2];
            neph_march_point(i, n, at_px);
            const int x = (int)floor((at_px[0] + 0.5) * columns);
            const int y = (int)floor((at_px[1] + 0.5) * (n / columns));
            neph_assert_in_range(x, 0, columns - 1);
            neph_assert_in_range(y, 0, n / columns - 1);
            hits[y * columns + x]++;
        }
        for (int box = 0; box < n; box++)
            assert_int_equal(hits[box], 1);
    }
}

static void test_points_are_a_net_around_the_centre(void **state)
{
    for (int n = 1; n <= NEPH_MARCH_RAYS_PER_PX_MAX; n *= 2) {
        double sum[2] = {0.0, 0.0};
        assert_net(n);
        for (int i = 0; i < n; i++) {
            float at_px[2];
            neph_march_point(i, n, at_px);
            sum[0] += at_px[0];
            sum[1] += at_px[1];
        }
        assert_true(sum[0] == 0.0 && sum[1] == 0.0); /* all are multiples of 2^-9 */
    }
}

static void test_one_ray_has_the_bits_of_the_frame(void **state)
{
    struct test_scene test;
    fill(&test);
    const float centre_px[2] = {0.0f, 0.0f};
    OWNED(march) struct neph_march *march = open_march(*state, &test.scene, 24, 18);
    OWNED(image) struct neph_image *one = average(march, &test.scene, 1, NULL);
    OWNED(image) struct neph_image *frame = through(march, &test.scene, centre_px);
    assert_same_bits(one, frame);
}

/* Up to the rounding of the last sum; depths and distances are the centre ray's. */
static void test_the_mean_is_the_mean_and_depth_is_the_centres(void **state)
{
    enum { RAYS = 16 };
    struct test_scene test;
    fill(&test);
    const float centre_px[2] = {0.0f, 0.0f};
    OWNED(march) struct neph_march *march = open_march(*state, &test.scene, 24, 18);
    struct neph_march_stats stats;
    OWNED(image) struct neph_image *mean = average(march, &test.scene, RAYS, &stats);
    struct neph_image *centre = through(march, &test.scene, centre_px), *rays[RAYS];
    for (int i = 0; i < RAYS; i++) {
        float jitter_px[2];
        neph_march_point(i, RAYS, jitter_px);
        rays[i] = through(march, &test.scene, jitter_px);
    }
    const size_t count = neph_image_pixel_count(mean);
    size_t mixed = 0;
    assert_int_equal(stats.rays, (RAYS + 1) * count);
    assert_int_equal(stats.view_steps, 8 * (RAYS + 1) * count);
    for (int c = 0; c < mean->channel_count; c++) {
        const char *name = mean->channels[c].name;
        const bool is_centre = strcmp(name, "Z") == 0 || strcmp(name, "volume.distance") == 0;
        for (size_t p = 0; p < count; p++) {
            double sum = 0.0;
            for (int i = 0; i < RAYS; i++)
                sum += rays[i]->channels[c].samples[p];
            const float expected = is_centre ? centre->channels[c].samples[p] : (float)(sum / RAYS);
            assert_true(mean->channels[c].samples[p] == expected);
            mixed += mean->channels[c].samples[p] != centre->channels[c].samples[p];
        }
    }
    assert_true(mixed > count / 20);
    for (int i = 0; i < RAYS; i++)
        neph_image_destroy(rays[i]);
    neph_image_destroy(centre);
}

/* The vertical edge of an absorbing wall: a pixel that it crosses has the sky's area fraction, with
 * an error of one ray in 16. A single ray through the centre sees either wall or sky. */
static void test_an_edge_has_its_share(void **state)
{
    enum { WIDTH = 40, HEIGHT = 20 };
    static const double edge_px = 17.3; /* from the left border */
    struct test_scene test;
    test_scene_init(&test);
    const double pixel = 2.0 * tan(0.5 * test.scene.vertical_fov_rad) / HEIGHT; /* at 1 m */
    const double edge_m = (edge_px - 0.5 * WIDTH) * pixel * 10.0;
    test_add_box(&test, (struct neph_vec3){-1e3, -1e3, -10.0001},
                 (struct neph_vec3){edge_m, 1e3, -10.0});
    test.solids[0].albedo = (struct neph_rgb){0.0, 0.0, 0.0};
    OWNED(march) struct neph_march *march = open_march(*state, &test.scene, WIDTH, HEIGHT);
    OWNED(image) struct neph_image *mean = average(march, &test.scene, 16, NULL);
    OWNED(image) struct neph_image *centre = average(march, &test.scene, 1, NULL);
    const float sky = (float)test.scene.background_w_per_m2_sr.r;
    const float *of_mean = neph_image_channel(mean, "R"),
                *of_centre = neph_image_channel(centre, "R");
    for (int x = 0; x < WIDTH; x++) {
        const double share = fmin(1.0, fmax(0.0, x + 1 - edge_px));
        neph_assert_close(of_mean[9 * WIDTH + x], share * sky, 0.0, 0.5 / 16.0 * sky + 1e-7);
        assert_true(of_centre[9 * WIDTH + x] == (x < 17 ? 0.0f : sky));
    }
}

static void test_other_numbers_of_rays_are_refused(void **state)
{
    struct test_scene test;
    fill(&test);
    OWNED(march) struct neph_march *march = open_march(*state, &test.scene, 4, 4);
    static const int wrong[] = {0, -1, 3, 12, 512};
    for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++) {
        struct neph_image *image = NULL;
        struct neph_diag diag = {0};
        assert_int_equal(neph_march_average(march, &test.scene, 0.0, wrong[i], &image, NULL, &diag),
                         NEPH_ERR_USAGE);
        assert_null(image);
        assert_non_null(strstr(diag.message, "powers of two"));
    }
}

#include "tests/renderer/main.h"
