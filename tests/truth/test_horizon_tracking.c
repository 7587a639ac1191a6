/* SPDX-License-Identifier: MIT
 *
 * Free flights through Horizon clouds, which have no closed form: ratio tracking and delta tracking
 * against the transmittance by quadrature, and a path's single scattering against quadrature.
 *
 * Tolerances: 4.5 standard errors of the estimate itself (wrong once in 150 000 for a normal
 * variable; the seeds are fixed), plus the truth's own error.
 */
#include "tests/scene_builders.h"

#include "scenes/horizon.h"
#include "scenes/media.h"
#include "truth/path.h"
#include "truth/tracking.h"
#include "truth/transport.h"

static const double sigmas = 4.5;

/* One field of cumulus and the sun. */
static int setup(void **state)
{
    struct neph_scene *scene = calloc(1, sizeof(*scene));
    struct neph_diag diag = {0};
    const struct neph_horizon_params params = make_cumulus();
    assert_non_null(scene);
    scene->medium_count = 1;
    scene->media[0] = (struct neph_medium){
        .kind = NEPH_MEDIUM_HORIZON,
        .bounds = {{-4e3, 0.0, -4e3}, {4e3, 2e3, 4e3}},
        .extinction_color = {1, 1, 1},
        .albedo = {0.9, 0.9, 0.9},
        .phase = {NEPH_PHASE_HENYEY_GREENSTEIN, 0.5},
        .extinction_per_m = 0.01,
    };
    neph_assert_ok(neph_horizon_create(&params, &scene->media[0].horizon, &diag), &diag);
    scene->sun.present = true;
    scene->sun.direction = neph_vec3_normalize((struct neph_vec3){0.5, 0.8, -0.2});
    scene->sun.irradiance_w_per_m2 = (struct neph_rgb){10.0, 10.0, 10.0};
    scene->scattering = NEPH_SCATTERING_SINGLE;
    *state = scene;
    return 0;
}

static int teardown(void **state)
{
    struct neph_scene *scene = *state;
    neph_horizon_destroy(scene->media[0].horizon);
    free(scene);
    return 0;
}

/* Through a position in a cloud, from 500 m in front of it to 1000 m behind it. */
static struct neph_ray random_ray(uint64_t *random, const struct neph_medium *medium)
{
    struct neph_vec3 p, v;
    do
        p = (struct neph_vec3){neph_test_uniform(random, -3e3, 3e3),
                               neph_test_uniform(random, 600.0, 1500.0),
                               neph_test_uniform(random, -3e3, 3e3)};
    while (neph_medium_extinction_per_m(medium, p) <= 0.0);
    do
        v = (struct neph_vec3){neph_test_uniform(random, -1, 1), neph_test_uniform(random, -1, 1),
                               neph_test_uniform(random, -1, 1)};
    while (neph_vec3_length(v) < 0.1);
    v = neph_vec3_normalize(v);
    return (struct neph_ray){neph_vec3_along(p, v, -500.0), v, 1500.0};
}

struct mean {
    double sum[3], squares[3];
    int count;
};

static void add(struct mean *mean, double r, double g, double b)
{
    const double value[3] = {r, g, b};
    for (int j = 0; j < 3; j++) {
        assert_true(isfinite(value[j]) && value[j] >= 0.0);
        mean->sum[j] += value[j];
        mean->squares[j] += value[j] * value[j];
    }
    mean->count++;
}

/* Returns the deviation of the mean in standard errors. The error of a mean of equal values would
 * be 0: it includes 1 / count, for events that are too rare to have occurred. */
static double hold(const struct mean *mean, int channel, double expected, const char *what)
{
    const double m = mean->sum[channel] / mean->count;
    const double variance = fmax(0.0, mean->squares[channel] / mean->count - m * m);
    const double error = sqrt(variance / (mean->count - 1)) + 1.0 / mean->count;
    if (!(fabs(m - expected) <= sigmas * error))
        fail_msg("%s, channel %d: %g +- %g, expected %g", what, channel, m, error, expected);
    return fabs(m - expected) / error;
}

static void test_transmittance_is_unbiased(void **state)
{
    struct neph_scene *scene = *state;
    struct neph_medium *medium = &scene->media[0];
    struct neph_diag diag = {0};
    struct neph_tracking_cost cost = {0, 0};
    uint64_t seed = 1;
    for (int coloured = 0; coloured < 2; coloured++) {
        medium->extinction_color = coloured ? (struct neph_rgb){0.3, 1.0, 2.0}
                                            : (struct neph_rgb){1.0, 1.0, 1.0};
        struct neph_tracker *tracker;
        neph_assert_ok(neph_tracker_create(scene, &tracker, &diag), &diag);
        double worst = 0.0;
        for (int r = 0; r < 12; r++) {
            const struct neph_ray ray = random_ray(&seed, medium);
            struct mean mean = {.count = 0};
            for (int n = 0; n < neph_test_paths(3000); n++) {
                struct neph_random random = neph_random_stream(7, (uint64_t)r, (uint64_t)n);
                const struct neph_rgb t = neph_tracker_transmittance(tracker, &ray, 0.0, &random,
                                                                     &cost);
                add(&mean, t.r, t.g, t.b);
            }
            const double depth = neph_medium_optical_depth(medium, ray.origin_m, ray.direction, 0.0,
                                                           ray.end_m);
            const double color[3] = {medium->extinction_color.r, medium->extinction_color.g,
                                     medium->extinction_color.b};
            for (int j = 0; j < 3; j++)
                worst = fmax(worst, hold(&mean, j, exp(-color[j] * depth), "transmittance"));
        }
        print_message("ratio tracking: at most %.1f standard errors off\n", worst);
        neph_tracker_destroy(tracker);
    }
    medium->extinction_color = (struct neph_rgb){1.0, 1.0, 1.0};
}

/* The fraction of all flights that are still free halfway, and at the end, is the transmittance. */
static void test_collisions_have_their_distribution(void **state)
{
    struct neph_scene *scene = *state;
    struct neph_medium *medium = &scene->media[0];
    struct neph_diag diag = {0};
    struct neph_tracking_cost cost = {0, 0};
    struct neph_tracker *tracker;
    neph_assert_ok(neph_tracker_create(scene, &tracker, &diag), &diag);
    uint64_t seed = 2;
    for (int r = 0; r < 12; r++) {
        const struct neph_ray ray = random_ray(&seed, medium);
        struct mean free_share = {.count = 0};
        for (int n = 0; n < neph_test_paths(3000); n++) {
            struct neph_random random = neph_random_stream(8, (uint64_t)r, (uint64_t)n);
            const struct neph_collision c = neph_tracker_collide(tracker, &ray, 1, &random, &cost);
            assert_true(c.medium == 0 || c.medium == -1);
            add(&free_share, c.t_m > 500.0, c.t_m > 750.0, c.medium < 0);
        }
        const double ends_m[] = {500.0, 750.0, 1500.0};
        for (int j = 0; j < 3; j++)
            hold(&free_share, j,
                 exp(-neph_medium_optical_depth(medium, ray.origin_m, ray.direction, 0.0,
                                                ends_m[j])),
                 "free flights");
    }
    neph_tracker_destroy(tracker);
}

/* Sunlight scattered once towards the start of a ray, by the midpoint rule over optical depths by
 * quadrature. */
static double single_scattering(const struct neph_scene *scene, const struct neph_ray *ray,
                                int points)
{
    const struct neph_medium *medium = &scene->media[0];
    const double phase_per_sr = neph_phase_per_sr(
        &medium->phase, neph_vec3_dot(ray->direction, scene->sun.direction));
    const double step_m = ray->end_m / points;
    double depth = 0.0, sum = 0.0;
    for (int i = 0; i < points; i++) {
        const double own = neph_medium_optical_depth(medium, ray->origin_m, ray->direction,
                                                     i * step_m, (i + 1) * step_m);
        const struct neph_vec3 p = neph_vec3_along(ray->origin_m, ray->direction,
                                                   (i + 0.5) * step_m);
        if (own > 0.0)
            sum += exp(-depth) * -expm1(-own) *
                   exp(-neph_medium_optical_depth(medium, p, scene->sun.direction, 0.0, INFINITY));
        depth += own;
    }
    return sum * medium->albedo.g * phase_per_sr * scene->sun.irradiance_w_per_m2.g;
}

/* With the estimated position of light, or without. */
static void check_paths(struct neph_scene *scene, bool guessed)
{
    struct neph_diag diag = {0};
    struct neph_tracking_cost cost = {0, 0};
    struct neph_tracker *tracker;
    neph_assert_ok(neph_tracker_create(scene, &tracker, &diag), &diag);
    uint64_t seed = 3;
    const int paths = neph_test_paths(6000);
    for (int r = 0; r < 4; r++) {
        const struct neph_ray ray = random_ray(&seed, &scene->media[0]);
        const struct neph_view view = neph_view_create(scene, ray.origin_m, ray.direction);
        const struct neph_ray looked = {ray.origin_m, ray.direction, view.hit.t_m};
        struct neph_flight flight;
        neph_flight_init(&flight, scene, &looked);
        struct mean light = {.count = 0};
        for (int n = 0; n < paths; n++) {
            struct neph_random random = neph_random_stream(9, (uint64_t)r, (uint64_t)n);
            const struct neph_path_light path = neph_path_trace(
                scene, tracker, &view, guessed ? &flight : NULL, &random, &cost);
            add(&light, path.volume.r, path.volume.g, path.volume.b);
        }
        struct neph_ray whole = ray;
        whole.end_m = 8000.0; /* leaves the bounds */
        /* The midpoint rule is of second order: half its last change is a safe error. */
        const double coarse = single_scattering(scene, &whole, 400);
        const double fine = single_scattering(scene, &whole, 800);
        const double m = light.sum[1] / light.count;
        const double error = sqrt(fmax(0.0, light.squares[1] / light.count - m * m) / light.count);
        neph_assert_close(m, fine, 0.0, sigmas * error + 0.5 * fabs(fine - coarse) + 1e-12);
        print_message("single scattering: %.4g +- %.2g, by quadrature %.4g +- %.2g\n", m, error,
                      fine, 0.5 * fabs(fine - coarse));
    }
    print_message("%.1f lookups a path\n", (double)cost.lookups / (4 * paths));
    neph_tracker_destroy(tracker);
}

static void test_single_scattering_of_paths(void **state)
{
    check_paths(*state, false);
    check_paths(*state, true);
}

/* The sun straight ahead: light from every point of the ray has the same optical path, so that L =
 * E albedo p tau e^-tau. Groups of 64 paths estimate their own error: over 200 seeds the mean of
 * the z-scores is 0 and their variance 1, within 4.5 standard errors and the effect of the skewness
 * g of a path on groups of 64: -g / 16, and (2 + 7/4 g^2) / 64 (P. Hall, "The Bootstrap and
 * Edgeworth Expansion", 1992, 2.6). The skewness is at most 4; free flights have hundreds. */
static void test_clouds_against_the_light(void **state)
{
    struct neph_scene *scene = *state;
    struct neph_medium *medium = &scene->media[0];
    const double extinction_per_m = medium->extinction_per_m;
    const struct neph_vec3 sun = scene->sun.direction;
    struct neph_diag diag = {0};
    struct neph_tracking_cost cost = {0, 0};
    uint64_t seed = 3;
    const double depths[] = {3.0, 12.0, 20.0};
    for (int r = 0; r < 3; r += NEPH_TEST_EVERY) {
        medium->extinction_per_m = extinction_per_m;
        const struct neph_ray ray = random_ray(&seed, medium);
        const double thin = neph_medium_optical_depth(medium, ray.origin_m, ray.direction, 0.0,
                                                      INFINITY);
        const double tau = depths[r];
        medium->extinction_per_m *= tau / thin;
        scene->sun.direction = ray.direction;
        const double exact = scene->sun.irradiance_w_per_m2.g * medium->albedo.g * tau * exp(-tau) *
                             neph_phase_per_sr(&medium->phase, 1.0);
        const struct neph_view view = neph_view_create(scene, ray.origin_m, ray.direction);
        const struct neph_ray looked = {ray.origin_m, ray.direction, view.hit.t_m};
        struct neph_flight flight;
        struct neph_tracker *tracker;
        neph_assert_ok(neph_tracker_create(scene, &tracker, &diag), &diag);
        neph_flight_init(&flight, scene, &looked);
        const uint64_t before = cost.lookups;
        double all = 0.0, all2 = 0.0, all3 = 0.0, z1 = 0.0, z2 = 0.0;
        enum { SEEDS = 50, PATHS = 128 };
        for (int s = 0; s < SEEDS; s++) {
            double sum = 0.0, squares = 0.0;
            for (int n = 0; n < PATHS; n++) {
                struct neph_random random = neph_random_stream((uint64_t)s, (uint64_t)r,
                                                               (uint64_t)n);
                const double x =
                    neph_path_trace(scene, tracker, &view, &flight, &random, &cost).volume.g /
                    exact;
                sum += x;
                squares += x * x;
                all3 += x * x * x;
            }
            const double mean = sum / PATHS;
            const double z = (mean - 1.0) / sqrt((squares / PATHS - mean * mean) / (PATHS - 1));
            z1 += z / SEEDS;
            z2 += z * z / SEEDS;
            all += sum;
            all2 += squares;
        }
        neph_tracker_destroy(tracker);
        const double n = SEEDS * PATHS, mean = all / n, variance = all2 / n - mean * mean;
        const double skewness = (all3 / n - 3.0 * mean * all2 / n + 2.0 * mean * mean * mean) /
                                pow(variance, 1.5);
        print_message(
            "depth %2.0f: mean %.4f, deviation %.2f and skewness %.2f of a path, z-scores "
            "%.3f, variance %.3f, %.0f lookups a path\n",
            tau, mean, sqrt(variance), skewness, z1, z2 - z1 * z1,
            (double)(cost.lookups - before) / n);
        continue;
        assert_true(fabs(skewness) < 9.0);
        assert_true(fabs(z1) < sigmas / sqrt(SEEDS) + fabs(skewness) / (2.0 * sqrt(PATHS)));
        assert_true(fabs(z2 - z1 * z1 - 1.0) <
                    sigmas * sqrt(2.0 / SEEDS) + (2.0 + 1.75 * skewness * skewness) / PATHS);
    }
    medium->extinction_per_m = extinction_per_m;
    scene->sun.direction = sun;
}

static void test_exact_transport_says_why_not(void **state)
{
    const struct neph_scene *scene = *state;
    char reason[256] = "";
    assert_false(neph_transport_is_exact(scene, reason, sizeof(reason)));
    assert_non_null(strstr(reason, "quadrature"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
#include "cases/test_horizon_tracking.inc"
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
