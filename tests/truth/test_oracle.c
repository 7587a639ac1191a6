/* SPDX-License-Identifier: MIT
 *
 * Whole frames of the oracle: the reported noise is the true noise, equal bits with any number of
 * threads and any interruption, and refusals with a message.
 */
#include "tests/scene_builders.h"

#include "base/files.h"
#include "base/interrupt.h"
#include "tests/base/scratch.h"
#include "truth/oracle.h"
#include "truth/transport.h"

#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

/* ---- scenes ---- */

struct stage {
    struct neph_scene scene;
    struct neph_camera_key key;
    struct neph_solid solids[2];
};

/* A block and a fog in sunlight, above ground, a ball in the block. */
static void make_stage(struct stage *stage, enum neph_scattering scattering)
{
    *stage = (struct stage){.key = {.position_m = {0.5, 2.0, 7.0}, .look_at_m = {0, 1.2, 0}}};
    stage->solids[0] = make_box(-50, -2, -50, 50, -0.5, 50);
    stage->solids[0].albedo = (struct neph_rgb){0.3, 0.5, 0.2};
    stage->solids[1] = make_sphere(0.5, 1.5, 1.0, 0.6);
    stage->solids[1].albedo = make_grey(0.8);
    stage->scene = (struct neph_scene){
        .camera_key_count = 1,
        .camera_keys = &stage->key,
        .camera_up = {0, 1, 0},
        .vertical_fov_rad = 0.9,
        .frame_count = 1,
        .sun = {true, neph_vec3_normalize((struct neph_vec3){0.5, 0.7, 0.3}), {3, 2, 1}},
        .background_w_per_m2_sr = {0.1, 0.2, 0.4},
        .scattering = scattering,
        .solid_count = 2,
        .solids = stage->solids,
        .medium_count = 2,
    };
    snprintf(stage->scene.hash, sizeof(stage->scene.hash), "stage-%d", (int)scattering);
    struct neph_medium *block = &stage->scene.media[0];
    *block = make_homogeneous(0.5, (struct neph_bounds){{-2, 0, -2}, {2, 2.5, 2}});
    block->extinction_color = (struct neph_rgb){0.7, 1, 1.3};
    block->albedo = (struct neph_rgb){0.9, 0.8, 0.95};
    block->phase = (struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN, 0.3};
    stage->scene.media[1] = make_height_fog(0.05, 0.5);
    stage->scene.media[1].albedo = make_grey(0.9);
}

static struct neph_oracle_params make_oracle_params(int width_px, int height_px, int samples)
{
    return (struct neph_oracle_params){.width_px = width_px,
                                       .height_px = height_px,
                                       .seed = 3,
                                       .samples = samples,
                                       .time_limit_s = INFINITY};
}

static struct neph_image *render(const struct neph_scene *scene,
                                 const struct neph_oracle_params *params,
                                 struct neph_oracle_stats *stats)
{
    struct neph_diag diag = {0};
    struct neph_image *frame = NULL;
    neph_assert_ok(neph_oracle_render(scene, params, &frame, stats, &diag), &diag);
    return frame;
}

static void assert_same_bits(const struct neph_image *a, const struct neph_image *b)
{
    assert_int_equal(a->channel_count, b->channel_count);
    for (int i = 0; i < a->channel_count; i++) {
        assert_string_equal(a->channels[i].name, b->channels[i].name);
        assert_memory_equal(a->channels[i].samples, b->channels[i].samples,
                            neph_image_pixel_count(a) * sizeof(float));
    }
}

/* ---- reported noise --------------- */

/* Pixels of one colour channel. */
struct scores {
    double mean, variance;
    int count;
};

static struct scores scores_against(const double *truth, const struct neph_image *frame,
                                    const char *channel, const char *variance_channel)
{
    const float *value = neph_image_channel(frame, channel);
    const float *variance = neph_image_channel(frame, variance_channel);
    double sum = 0.0, squares = 0.0;
    int count = 0;
    for (size_t i = 0; i < neph_image_pixel_count(frame); i++) {
        /* Below float rounding of the value there is no noise to judge. */
        if (!(sqrt((double)variance[i]) > 1e-6 * (double)value[i]))
            continue;
        const double z = ((double)value[i] - truth[i]) / sqrt((double)variance[i]);
        sum += z;
        squares += z * z;
        count++;
    }
    const double mean = sum / count;
    return (struct scores){mean, squares / count - mean * mean, count};
}

/* Against exact single scattering, pixel by pixel. Of n independent normal scores the mean has the
 * standard error 1/sqrt(n) and the variance sqrt(2/n). As the variance is itself estimated from N
 * samples of skewness g, the mean shifts by g / (2 sqrt N) and the variance by about (2 + 2 g^2)/N:
 * with g <= 2, measured for this scene, and N = 512, these are 0.044 and 0.02. */
static void test_reported_noise_is_true(void **state)
{
    enum { WIDTH = 64, HEIGHT = 36, SAMPLES = 512 };
    struct stage stage;
    make_stage(&stage, NEPH_SCATTERING_SINGLE);
    stage.scene.media[0].extinction_color = white;
    const struct neph_oracle_params params = make_oracle_params(WIDTH, HEIGHT, SAMPLES);
    struct neph_image *frame = render(&stage.scene, &params, NULL);
    double *truth = test_malloc(WIDTH * HEIGHT * sizeof(*truth));
    const struct neph_camera camera = neph_scene_camera(&stage.scene, 0.0);
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        truth[i] = neph_transport_ray(
                       &stage.scene, camera.position_m,
                       neph_camera_ray(&camera, WIDTH, HEIGHT, i % WIDTH, i / WIDTH).direction)
                       .radiance.g;
    const struct scores scores = scores_against(truth, frame, "G", "variance.G");
    print_message("z-scores of %d pixels: mean %+.4f, variance %.4f\n", scores.count, scores.mean,
                  scores.variance);
    assert_true(scores.count > WIDTH * HEIGHT / 2);
    neph_assert_close(scores.mean, 0.0, 0.0, 4.0 / sqrt(scores.count) + 0.044);
    neph_assert_close(scores.variance, 1.0, 0.0, 4.0 * sqrt(2.0 / scores.count) + 0.02);
    test_free(truth);
    neph_image_destroy(frame);
}

/* All orders, colour, surfaces: the difference of two seeds has the sum of their variances. It is
 * symmetric, so its mean is not shifted. */
static void test_two_seeds_differ_by_their_noise(void **state)
{
    enum { WIDTH = 48, HEIGHT = 27, SAMPLES = 256 };
    struct stage stage;
    make_stage(&stage, NEPH_SCATTERING_MULTIPLE);
    stage.scene.environment_light = true;
    struct neph_oracle_params params = make_oracle_params(WIDTH, HEIGHT, SAMPLES);
    struct neph_image *a = render(&stage.scene, &params, NULL);
    params.seed = 4;
    struct neph_image *b = render(&stage.scene, &params, NULL);
    const char *const channels[] = {"R", "G", "B"};
    const char *const variances[] = {"variance.R", "variance.G", "variance.B"};
    for (int j = 0; j < 3; j++) {
        double truth[WIDTH * HEIGHT];
        float *variance = neph_image_channel(a, variances[j]);
        for (int i = 0; i < WIDTH * HEIGHT; i++) {
            truth[i] = (double)neph_image_channel(b, channels[j])[i];
            variance[i] += neph_image_channel(b, variances[j])[i];
        }
        const struct scores scores = scores_against(truth, a, channels[j], variances[j]);
        print_message("%s: z-scores of %d pixels: mean %+.4f, variance %.4f\n", channels[j],
                      scores.count, scores.mean, scores.variance);
        assert_int_equal(scores.count, WIDTH * HEIGHT);
        neph_assert_close(scores.mean, 0.0, 0.0, 4.0 / sqrt(scores.count));
        /* The tails of estimated variances: (2 + 2 g^2) / N again, g <= 2. */
        neph_assert_close(scores.variance, 1.0, 0.0, 4.0 * sqrt(2.0 / scores.count) + 0.04);
    }
    neph_image_destroy(a);
    neph_image_destroy(b);
}

/* ---- layers ---- */

static void test_layers(void **state)
{
    enum { WIDTH = 32, HEIGHT = 18 };
    struct stage stage;
    make_stage(&stage, NEPH_SCATTERING_SINGLE);
    const struct neph_oracle_params params = make_oracle_params(WIDTH, HEIGHT, 64);
    struct neph_oracle_stats stats;
    struct neph_image *single = render(&stage.scene, &params, &stats);
    assert_int_equal(stats.samples, 64);
    assert_true(stats.collisions > 0 && stats.error > 0.0 && stats.error < 1.0);
    stage.scene.scattering = NEPH_SCATTERING_MULTIPLE;
    struct neph_image *multiple = render(&stage.scene, &params, NULL);
    stage.scene.scattering = NEPH_SCATTERING_NONE;
    struct neph_image *none = render(&stage.scene, &params, NULL);
    float *all[3], *volume[3], *order1[3], *through[3], *dark[3], *first[3], *transmittance[3];
    neph_image_rgb(single, NULL, all);
    neph_image_rgb(single, "volume", volume);
    neph_image_rgb(single, "order1", order1);
    neph_image_rgb(multiple, "volume", through);
    neph_image_rgb(multiple, "order1", first);
    neph_image_rgb(none, NULL, dark);
    neph_image_rgb(none, "transmittance", transmittance);
    const struct neph_camera camera = neph_scene_camera(&stage.scene, 0.0);
    double more = 0.0, single_sum = 0.0, first_sum = 0.0;
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        const struct neph_vec3 direction =
            neph_camera_ray(&camera, WIDTH, HEIGHT, i % WIDTH, i / WIDTH).direction;
        stage.scene.media[0].extinction_color = white; /* the transport code supports grey media */
        stage.scene.scattering = NEPH_SCATTERING_NONE;
        const struct neph_ray_light exact = neph_transport_ray(&stage.scene, camera.position_m,
                                                               direction);
        /* Only the green channel of the stage is grey: rounding to float, twice. */
        neph_assert_close((double)transmittance[1][i], exact.transmittance.g, 1.2e-7, 0.0);
        neph_assert_close((double)dark[1][i], exact.radiance.g, 1.2e-7, 1e-30);
        const double z_m = exact.hit_m * neph_vec3_dot(direction, camera.forward);
        neph_assert_close((double)neph_image_channel(single, "Z")[i], z_m, 1.2e-7, 0.0);
        for (int j = 0; j < 3; j++) {
            assert_true(volume[j][i] == order1[j][i]);
            neph_assert_close((double)all[j][i], (double)dark[j][i] + (double)volume[j][i], 2e-7,
                              0.0);
            assert_true(through[j][i] >= first[j][i]);
            more += (double)(through[j][i] - first[j][i]);
            single_sum += (double)order1[j][i];
            first_sum += (double)first[j][i];
        }
    }
    assert_true(more > 0.1 * first_sum); /* there is a visible part of multiple scattering */
    /* The first order is the same in both; its estimates have the noise of 64 * 576 paths. */
    neph_assert_close(first_sum, single_sum, 0.05, 0.0);
    neph_image_destroy(single);
    neph_image_destroy(multiple);
    neph_image_destroy(none);
}

/* Uniform light, no absorption: each pixel has this radiance, for any thickness of the cloud. */
static void test_white_furnace_frame(void **state)
{
    struct stage stage;
    make_stage(&stage, NEPH_SCATTERING_MULTIPLE);
    stage.scene.sun.present = false;
    stage.scene.environment_light = true;
    stage.scene.background_w_per_m2_sr = white;
    stage.solids[0].albedo = stage.solids[1].albedo = white;
    stage.scene.media[0].albedo = stage.scene.media[1].albedo = white;
    stage.scene.media[0].extinction_color = white;
    stage.scene.media[0].layers[0].extinction_per_m = 20.0;
    const struct neph_oracle_params params = make_oracle_params(32, 18, 16);
    struct neph_oracle_stats stats;
    struct neph_image *frame = render(&stage.scene, &params, &stats);
    assert_true(neph_doubt_of_frame(&stats.doubt) < NEPH_DOUBTFUL);
    for (size_t i = 0; i < neph_image_pixel_count(frame); i++)
        /* A roulette that starts below 0.05 may lose or add a path that enters by the surface. */
        neph_assert_close((double)neph_image_channel(frame, "G")[i], 1.0, 0.0,
                          4.5 * sqrt((double)neph_image_channel(frame, "variance.G")[i]) + 0.05);
    neph_image_destroy(frame);
}

/* ---- equal bits ------- */

static void test_threads_change_no_bit(void **state)
{
    struct stage stage;
    make_stage(&stage, NEPH_SCATTERING_MULTIPLE);
    const struct neph_oracle_params params = make_oracle_params(24, 20, 20);
    struct neph_image *together = render(&stage.scene, &params, NULL);
    cpu_set_t before, one;
    assert_int_equal(sched_getaffinity(0, sizeof(before), &before), 0);
    CPU_ZERO(&one);
    for (int cpu = 0; cpu < CPU_SETSIZE && CPU_COUNT(&one) == 0; cpu++)
        if (CPU_ISSET(cpu, &before))
            CPU_SET(cpu, &one);
    assert_int_equal(sched_setaffinity(0, sizeof(one), &one), 0);
    struct neph_image *alone = render(&stage.scene, &params, NULL);
    assert_int_equal(sched_setaffinity(0, sizeof(before), &before), 0);
    assert_same_bits(together, alone);
    neph_image_destroy(together);
    neph_image_destroy(alone);
}

/* 13, then up to 50 samples from the checkpoint: the same as 50 at once. */
static void test_resumed_render_has_the_same_bits(void **state)
{
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "sums");
    struct stage stage;
    make_stage(&stage, NEPH_SCATTERING_MULTIPLE);
    struct neph_oracle_params params = make_oracle_params(20, 11, 50);
    struct neph_oracle_stats whole_stats, stats;
    struct neph_image *whole = render(&stage.scene, &params, &whole_stats);
    params.checkpoint = path;
    params.samples = 13;
    struct neph_image *part = render(&stage.scene, &params, NULL);
    params.samples = 50;
    struct neph_image *resumed = render(&stage.scene, &params, &stats);
    assert_same_bits(whole, resumed);
    assert_int_equal(stats.collisions, whole_stats.collisions);
    assert_true(neph_doubt_of_frame(&stats.doubt) == neph_doubt_of_frame(&whole_stats.doubt));
    assert_true(stats.doubt.noisy > 0 && neph_doubt_of_frame(&stats.doubt) < NEPH_DOUBTFUL);
    /* The old sums are really used. */
    neph_image_destroy(part);
    part = render(&stage.scene, &params, &stats);
    assert_same_bits(whole, part);
    neph_image_destroy(whole);
    neph_image_destroy(part);
    neph_image_destroy(resumed);
}

static void assert_refused(const struct neph_scene *scene, const struct neph_oracle_params *params,
                           enum neph_status expected, const char *words)
{
    struct neph_diag diag = {0};
    struct neph_image *frame = NULL;
    assert_int_equal(neph_oracle_render(scene, params, &frame, NULL, &diag), expected);
    assert_null(frame);
    if (!strstr(diag.message, words))
        print_error("'%s' lacks '%s'\n", diag.message, words);
    assert_non_null(strstr(diag.message, words));
}

static void test_foreign_and_damaged_checkpoints_are_refused(void **state)
{
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "sums");
    struct stage stage;
    make_stage(&stage, NEPH_SCATTERING_SINGLE);
    struct neph_oracle_params params = make_oracle_params(8, 6, 4);
    params.checkpoint = path;
    neph_image_destroy(render(&stage.scene, &params, NULL));
    struct neph_oracle_params other = params;
    other.seed++;
    assert_refused(&stage.scene, &other, NEPH_ERR_INPUT, "belongs to");
    other = params;
    other.width_px++;
    assert_refused(&stage.scene, &other, NEPH_ERR_INPUT, "belongs to");
    stage.scene.hash[0] = 'x';
    assert_refused(&stage.scene, &params, NEPH_ERR_INPUT, "belongs to");
    stage.scene.hash[0] = 's';

    char *data;
    size_t size;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_file_read(path, 1 << 20, &data, &size, &diag), &diag);
    data[size - 20] ^= 1;
    neph_assert_ok(neph_file_write(path, data, size, &diag), &diag);
    assert_refused(&stage.scene, &params, NEPH_ERR_INPUT, "damaged");
    data[size - 20] ^= 1;
    neph_assert_ok(neph_file_write(path, data, size - 8, &diag), &diag);
    assert_refused(&stage.scene, &params, NEPH_ERR_INPUT, "damaged");
    neph_assert_ok(neph_file_write(path, data, size, &diag), &diag);
    neph_image_destroy(render(&stage.scene, &params, NULL));
    free(data);
}

/* ---- stopping -- */

static void test_target_and_limit(void **state)
{
    struct stage stage;
    make_stage(&stage, NEPH_SCATTERING_SINGLE);
    struct neph_oracle_params params = make_oracle_params(16, 9, 4096);
    params.target_error = 0.05;
    struct neph_oracle_stats stats;
    neph_image_destroy(render(&stage.scene, &params, &stats));
    assert_true(stats.error <= 0.05 && stats.samples < 4096 && stats.samples % 16 == 0);
    const int samples = stats.samples;
    params.target_error = 0.025; /* four times the samples, within the noise of the estimate */
    neph_image_destroy(render(&stage.scene, &params, &stats));
    assert_true(stats.error <= 0.025 && stats.samples > 2 * samples);
    params = make_oracle_params(64, 36, 1 << 30);
    params.time_limit_s = 0.2;
    neph_image_destroy(render(&stage.scene, &params, &stats));
    assert_true(stats.samples >= 2 && stats.samples < 1 << 30);
}

static void test_refused_scenes(void **state)
{
    struct stage stage;
    make_stage(&stage, NEPH_SCATTERING_MULTIPLE);
    struct neph_oracle_params params = make_oracle_params(8, 8, 1);
    assert_refused(&stage.scene, &params, NEPH_ERR_USAGE, "samples");
    params = make_oracle_params(0, 8, 2);
    assert_refused(&stage.scene, &params, NEPH_ERR_USAGE, "pixels");
    params = make_oracle_params(8, 8, 2);
    params.target_error = NAN;
    assert_refused(&stage.scene, &params, NEPH_ERR_USAGE, "target");
    params = make_oracle_params(8, 8, 2);
    params.time_limit_s = 0.0;
    assert_refused(&stage.scene, &params, NEPH_ERR_USAGE, "time limit");

    /* White fog without a ground. */
    char reason[200] = "";
    params = make_oracle_params(8, 8, 2);
    assert_true(neph_oracle_can_render(&stage.scene, reason, sizeof(reason)));
    stage.scene.media[1].albedo = (struct neph_rgb){0.5, 1, 0.5};
    assert_true(neph_oracle_can_render(&stage.scene, reason, sizeof(reason)));
    stage.scene.solid_count = 0;
    assert_false(neph_oracle_can_render(&stage.scene, reason, sizeof(reason)));
    assert_non_null(strstr(reason, "no end"));
    assert_refused(&stage.scene, &params, NEPH_ERR_UNSUPPORTED, "no end");
    stage.scene.media[1].bounds.min_m.y = -3.0;
    assert_true(neph_oracle_can_render(&stage.scene, reason, sizeof(reason)));
}

static void *interrupt_soon(void *unused)
{
    usleep(150000);
    raise(SIGINT);
    return unused;
}

/* Last, as an interrupted process stays so. In a child process. */
static void test_interrupted_render_is_resumed(void **state)
{
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "sums");
    struct stage stage;
    make_stage(&stage, NEPH_SCATTERING_MULTIPLE);
    struct neph_oracle_params params = make_oracle_params(40, 22, 400000);
    params.checkpoint = path;
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        pthread_t thread;
        struct neph_image *frame = NULL;
        neph_interrupt_install();
        pthread_create(&thread, NULL, interrupt_soon, NULL);
        const enum neph_status status = neph_oracle_render(&stage.scene, &params, &frame, NULL,
                                                           NULL);
        _exit(status == NEPH_ERR_INTERRUPTED && !frame ? 42 : 1);
    }
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 42);
    /* Some rows may be ahead by a round of 64 samples: all are brought to the same count. */
    params.samples = 2;
    struct neph_oracle_stats stats;
    struct neph_image *resumed = render(&stage.scene, &params, &stats);
    params.samples = stats.samples + 64;
    struct neph_image *longer = render(&stage.scene, &params, &stats);
    params.checkpoint = NULL;
    struct neph_image *whole = render(&stage.scene, &params, NULL);
    assert_int_equal(stats.samples, params.samples);
    assert_same_bits(longer, whole);
    neph_image_destroy(resumed);
    neph_image_destroy(longer);
    neph_image_destroy(whole);
}

/* ---- orthographic cameras ---- */

/* A slab has the same optical depth, sigma d / cos, in all pixels; a ball covers the pixels with
 * centres within its radius, at any distance. */
static void test_parallel_rays(void **state)
{
    enum { WIDTH = 80, HEIGHT = 60 };
    struct stage stage;
    make_stage(&stage, NEPH_SCATTERING_NONE);
    stage.key = (struct neph_camera_key){.position_m = {0, 30, 40}, .look_at_m = {0, 0, 0}};
    stage.scene.vertical_fov_rad = 0.0;
    stage.scene.orthographic_height_m = 6.0;
    stage.scene.medium_count = 1;
    stage.scene.media[0] = make_homogeneous(0.5, (struct neph_bounds){{-50, 3, -50}, {50, 4, 50}});
    stage.solids[0] = make_sphere(0, 0, 0, 2);
    stage.scene.solid_count = 1;
    const struct neph_oracle_params params = make_oracle_params(WIDTH, HEIGHT, 2);
    struct neph_image *frame = render(&stage.scene, &params, NULL);
    const float *transmittance = neph_image_channel(frame, "transmittance.G");
    const float *depth_m = neph_image_channel(frame, "Z");
    double nearest_m = INFINITY;
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        neph_assert_close(transmittance[i], exp(-0.5 / 0.6), 1e-6, 0.0);
        /* Pixels are 0.1 m; no centre is on the circle: two odd squares never sum to 1600. */
        const double x_m = 0.1 * (i % WIDTH + 0.5 - WIDTH / 2);
        const double y_m = 0.1 * (i / WIDTH + 0.5 - HEIGHT / 2);
        assert_int_equal(isfinite(depth_m[i]) != 0, x_m * x_m + y_m * y_m < 4.0);
        nearest_m = fmin(nearest_m, depth_m[i]);
    }
    neph_assert_close(nearest_m, 50.0 - 2.0, 0.0, 2.0 - sqrt(4.0 - 2.0 * 0.05 * 0.05) + 1e-5);
    neph_image_destroy(frame);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_parallel_rays),
        cmocka_unit_test(test_reported_noise_is_true),
        cmocka_unit_test(test_two_seeds_differ_by_their_noise),
        cmocka_unit_test(test_layers),
        cmocka_unit_test(test_white_furnace_frame),
        cmocka_unit_test(test_threads_change_no_bit),
        scratch_test(test_resumed_render_has_the_same_bits),
        scratch_test(test_foreign_and_damaged_checkpoints_are_refused),
        cmocka_unit_test(test_target_and_limit),
        cmocka_unit_test(test_refused_scenes),
        scratch_test(test_interrupted_render_is_resumed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
