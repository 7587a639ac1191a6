/* SPDX-License-Identifier: MIT
 *
 * Single scattering towards the sun through optical depths of 12 to 100: light comes from the far
 * side as much as from the near one, where free flights end. Small samples must estimate their own
 * error: their z-scores against the exact integral have mean 0 and variance 1.
 *
 * Tolerances: the mean of N z-scores is within 4.5 / sqrt(N) (wrong once in 150 000) plus the
 * effect of the skewness g of single paths on the t-statistic of n paths, -g / (2 sqrt(n)) (P.
 * Hall, "The Bootstrap and Edgeworth Expansion", 1992, 2.6); their variance is within 4.5 sqrt(2 /
 * N) of 1, plus (2 + 7/4 g^2) / n from the same source. The skewness itself is limited to
 * `skewness_max`.
 */
#include "tests/scene_builders.h"

#include "scenes/media.h"
#include "truth/flight.h"
#include "truth/path.h"
#include "truth/transport.h"

enum { SEEDS = 400, PATHS = 64 };

static const double sigmas = 4.5;

/* With 64 paths, a shift of the mean z-score by 0.19 and a variance of up to 1.28. Free flights
 * through an optical depth of 12 have a skewness of 400. */
static const double skewness_max = 3.0;

/* ---- scenes ---- */

static struct neph_medium slab(double optical_depth)
{
    return make_homogeneous(0.1 * optical_depth,
                            (struct neph_bounds){{-300, -300, -5}, {300, 300, 5}});
}

static struct neph_medium ball(double optical_depth)
{
    const double width_m = 2.0;
    return make_blob(optical_depth / (width_m * sqrt(2.0 * M_PI)), (struct neph_vec3){0}, width_m);
}

static struct neph_medium fog(double optical_depth)
{
    struct neph_medium medium = slab(optical_depth);
    medium.kind = NEPH_MEDIUM_HEIGHT_FOG;
    medium.layers[0].falloff_per_m = 0.3;
    return medium;
}

static const struct {
    const char *what;
    struct neph_medium (*medium)(double optical_depth);
    double optical_depth;
    struct neph_vec3 sun; /* the camera looks along -z */
    bool coloured;
    bool is_two; /* another slab of the same depth overlaps it */
} cases[] = {
    {"slab of 12, the sun behind", slab, 12, {0, 0.02, -1}, false, false},
    {"slab of 16, the sun behind", slab, 16, {0, 0.02, -1}, false, false},
    {"slab of 20, the sun behind", slab, 20, {0, 0.02, -1}, false, false},
    {"slab of 100, the sun behind", slab, 100, {0, 0.02, -1}, false, false},
    {"slab of 20, the sun at 30 degrees", slab, 20, {0, 0.5, -0.866}, false, false},
    {"slab of 20, the sun at 80 degrees", slab, 20, {0, 0.985, -0.174}, false, false},
    {"slab of 20, the sun in the back", slab, 20, {0, 0.5, 0.866}, false, false},
    {"ball of 12, the sun behind", ball, 12, {0, 0.02, -1}, false, false},
    {"ball of 16, the sun behind", ball, 16, {0, 0.02, -1}, false, false},
    {"ball of 20, the sun behind", ball, 20, {0, 0.02, -1}, false, false},
    {"ball of 20, the sun at 60 degrees", ball, 20, {0, 0.866, -0.5}, false, false},
    {"fog of 20, the sun behind", fog, 20, {0, 0.02, -1}, false, false},
    {"coloured slab of 16, the sun behind", slab, 16, {0, 0.02, -1}, true, false},
    {"slab of 8 in a ball of 8", slab, 8, {0, 0.02, -1}, false, true},
};

static struct neph_scene make_scene(size_t i)
{
    struct neph_scene scene = make_sunny(cases[i].medium(cases[i].optical_depth), cases[i].sun);
    if (cases[i].coloured)
        scene.media[0].extinction_color = (struct neph_rgb){0.8, 1.0, 1.1};
    if (cases[i].is_two)
        scene.media[scene.medium_count++] = ball(cases[i].optical_depth);
    return scene;
}

/* ---- z-scores ---- */

struct moments {
    double sum, squares, cubes;
    int count;
};

static void add(struct moments *moments, double x)
{
    moments->sum += x;
    moments->squares += x * x;
    moments->cubes += x * x * x;
    moments->count++;
}

static double mean_of(const struct moments *m)
{
    return m->sum / m->count;
}

static double variance_of(const struct moments *m)
{
    return (m->squares - m->sum * m->sum / m->count) / (m->count - 1);
}

static double skewness_of(const struct moments *m)
{
    const double mean = mean_of(m), deviation = sqrt(variance_of(m));
    const double third = m->cubes / m->count - 3.0 * mean * m->squares / m->count +
                         2.0 * mean * mean * mean;
    return third / (deviation * deviation * deviation);
}

static double channel_of(struct neph_rgb rgb, int channel)
{
    return channel == 0 ? rgb.r : channel == 1 ? rgb.g : rgb.b;
}

static void hold_scores(const char *what, int channel, const struct moments *scores,
                        double skewness)
{
    const double mean = mean_of(scores), variance = variance_of(scores);
    const double mean_allowed = sigmas / sqrt(scores->count) +
                                0.5 * fabs(skewness) / sqrt((double)PATHS);
    const double variance_allowed = sigmas * sqrt(2.0 / scores->count) +
                                    (2.0 + 1.75 * skewness * skewness) / PATHS;
    if (!(fabs(skewness) <= skewness_max && fabs(mean) <= mean_allowed &&
          fabs(variance - 1.0) <= variance_allowed))
        fail_msg("%s, channel %d: z-scores %.3f (0 +- %.3f), variance %.3f (1 +- %.3f), "
                 "skewness of a path %.2f (at most %g)",
                 what, channel, mean, mean_allowed, variance, variance_allowed, skewness,
                 skewness_max);
}

/* Paths divided by the exact value. */
static void test_samples_know_their_error(void **state)
{
    for (size_t i = 0; i < COUNT(cases); i++) {
        const struct neph_scene scene = make_scene(i);
        const struct neph_vec3 eye_m = {0.3, 0.2, 40.0}, ahead = {0, 0, -1};
        const struct neph_rgb exact = neph_transport_ray(&scene, eye_m, ahead).volume;
        const struct neph_view view = neph_view_create(&scene, eye_m, ahead);
        const struct neph_ray ray = {eye_m, ahead, view.hit.t_m};
        struct neph_flight flight;
        struct neph_tracker *tracker;
        struct neph_tracking_cost cost = {0, 0};
        struct neph_diag diag = {0};
        neph_assert_ok(neph_tracker_create(&scene, &tracker, &diag), &diag);
        neph_flight_init(&flight, &scene, &ray);
        struct moments scores[3] = {{0}}, paths[3] = {{0}};
        for (int seed = 0; seed < SEEDS; seed++) {
            struct moments own[3] = {{0}};
            for (int n = 0; n < PATHS; n++) {
                struct neph_random random = neph_random_stream((uint64_t)seed, i, (uint64_t)n);
                const struct neph_rgb light =
                    neph_path_trace(&scene, tracker, &view, &flight, &random, &cost).volume;
                for (int j = 0; j < 3; j++)
                    add(&own[j], channel_of(light, j) / channel_of(exact, j));
            }
            for (int j = 0; j < 3; j++) {
                add(&scores[j], (mean_of(&own[j]) - 1.0) / sqrt(variance_of(&own[j]) / PATHS));
                paths[j].sum += own[j].sum;
                paths[j].squares += own[j].squares;
                paths[j].cubes += own[j].cubes;
                paths[j].count += own[j].count;
            }
        }
        neph_tracker_destroy(tracker);
        for (int j = 0; j < 3; j++)
            hold_scores(cases[i].what, j, &scores[j], skewness_of(&paths[j]));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_samples_know_their_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
