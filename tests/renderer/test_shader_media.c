/* SPDX-License-Identifier: MIT
 *
 * The shaders of media, value by value through shaders/probe_media.comp, compared with
 * scenes/media.h in double precision. A ray is rounded to float32 first and given to both sides.
 * Tolerances follow from float32: positions are accurate to `place` roundings of their size,
 * functions to a few roundings, both times the derivative of the result.
 */
#include "tests/renderer/probe.h"

#include "scenes/grid.h"
#include "scenes/horizon.h"
#include "scenes/media.h"

#include <float.h>

static const uint32_t probe_code[] = {
#include "shaders/probe_media.comp.inc"
};

/* layout of shaders/probe_media.comp */
struct probe {
    float origin_m[3];
    float length_m;
    float direction[3];
    uint32_t medium;
};

struct answer {
    float extinction_per_m, optical_depth, stretch_t0_m, stretch_t1_m;
    float without_detail, height;
};

static const double epsilon = 0x1p-24;   /* unit roundoff */
static const double smallest = 0x1p-126; /* smaller densities may be flushed to 0 */
static const uint64_t seed = 20240611;

enum { PROBES_MAX = 4000 };

/* Sets the camera, the origin of all probes. */
static void look_from(struct test_scene *test, struct neph_vec3 camera_m)
{
    test_scene_init(test);
    test->key.position_m = camera_m;
    test->key.look_at_m = neph_vec3_add(camera_m, (struct neph_vec3){0.0, 0.0, -1.0});
}

/* The caller frees the result. */
static struct answer *ask(struct neph_vulkan *vulkan, const struct test_scene *test,
                          const struct probe *probes, int count)
{
    struct neph_diag diag = {0};
    struct neph_gpu_scene gpu = {0};
    neph_assert_ok(neph_gpu_scene_create(vulkan, &test->scene, 0.0, 8, 8, false, &gpu, &diag),
                   &diag);
    const struct neph_kernel_params params = {
        .name = "probe_media",
        .code = probe_code,
        .code_bytes = sizeof(probe_code),
        .buffer_count = NEPH_GPU_SCENE_BUFFERS + 2,
        .uniform_count = NEPH_GPU_SCENE_UNIFORMS,
        .constant_count = NEPH_GPU_SCENE_CONSTANTS,
        .constants = {gpu.constants[0], gpu.constants[1]},
    };
    struct answer *answers = test_probe(vulkan, &params, &gpu, probes, sizeof(*probes),
                                        sizeof(*answers), count);
    neph_gpu_scene_destroy(vulkan, &gpu);
    return answers;
}

/* --- rays --------------------------------------------------------------------------------- */

static double pick(uint64_t *random, const double *values, size_t count)
{
    return values[neph_test_random(random) % count];
}
#define PICK(random, values) pick((random), (values), sizeof(values) / sizeof((values)[0]))

/* Often along an axis, in a plane of two axes, or nearly so. */
static struct neph_vec3 odd_direction(uint64_t *random)
{
    static const double components[] = {0.0, 0.0, 1.0, -1.0, 1e-7, -1e-7, 1e-30, 0.5};
    struct neph_vec3 v;
    do {
        const bool special = neph_test_random(random) % 3 == 0;
        v.x = special ? PICK(random, components) : neph_test_uniform(random, -1, 1);
        v.y = special ? PICK(random, components) : neph_test_uniform(random, -1, 1);
        v.z = special ? PICK(random, components) : neph_test_uniform(random, -1, 1);
    } while (neph_vec3_length(v) < 1e-3);
    return neph_vec3_normalize(v);
}

static struct neph_vec3 point_near(uint64_t *random, struct neph_vec3 center_m, double reach_m)
{
    return (struct neph_vec3){center_m.x + reach_m * neph_test_uniform(random, -1, 1),
                              center_m.y + reach_m * neph_test_uniform(random, -1, 1),
                              center_m.z + reach_m * neph_test_uniform(random, -1, 1)};
}

/* A ray from a world-space point, rounded to float32 relative to the camera. */
static struct probe probe_from(const struct test_scene *test, struct neph_vec3 origin_m,
                               struct neph_vec3 direction, double length_m)
{
    const struct neph_vec3 from_m = neph_vec3_sub(origin_m, test->key.position_m);
    return (struct probe){
        .origin_m = {(float)from_m.x, (float)from_m.y, (float)from_m.z},
        .length_m = (float)length_m,
        .direction = {(float)direction.x, (float)direction.y, (float)direction.z},
    };
}

static struct neph_vec3 vec3(const float v[3])
{
    return (struct neph_vec3){v[0], v[1], v[2]};
}

/* The ray of the reference. A rounded direction is not exactly unit; the double side scales the ray
 * by its length, which differs from 1 by 6e-8. */
struct ray {
    struct neph_vec3 origin_m, direction;
    double length_m;
    double place_m; /* float32 error of positions near its ends */
};

static struct ray ray_of(const struct test_scene *test, const struct probe *p)
{
    const double size_m = fabs((double)p->origin_m[0]) + fabs((double)p->origin_m[1]) +
                          fabs((double)p->origin_m[2]);
    return (struct ray){neph_vec3_add(test->key.position_m, vec3(p->origin_m)),
                        neph_vec3_normalize(vec3(p->direction)), p->length_m,
                        4.0 * epsilon * size_m};
}

/* Worst errors relative to the tolerance, for the printed summary; probes left out, and probes that
 * met the medium. */
struct worst {
    double extinction, depth;
    int left_out, met;
};

static void hold(double actual, double expected, double allowed, double *worst, const char *what,
                 int i)
{
    if (!(actual >= 0.0) || isinf(actual))
        fail_msg("probe %d: %s is %g", i, what, actual);
    /* A device may flush a result below the smallest normal number to 0. */
    if (!(fabs(actual - expected) <= allowed + FLT_MIN))
        fail_msg("probe %d: %s is %.9g, expected %.9g +- %.2g", i, what, actual, expected, allowed);
    if (allowed > 0.0)
        *worst = fmax(*worst, fabs(actual - expected) / allowed);
}

/* A march may omit an optical depth of 1e-7 per medium, and more only by rounding. */
static void hold_stretch(const struct answer *answer, const struct ray *ray,
                         const struct neph_medium *medium, double allowed, int i)
{
    const double t0_m = fmin(answer->stretch_t0_m, ray->length_m), t1_m = answer->stretch_t1_m;
    double left_out = neph_medium_optical_depth(medium, ray->origin_m, ray->direction, 0.0,
                                                t1_m > t0_m ? t0_m : ray->length_m);
    if (t1_m > t0_m && t1_m < ray->length_m)
        left_out += neph_medium_optical_depth(medium, ray->origin_m, ray->direction, t1_m,
                                              ray->length_m);
    if (!(left_out <= 2e-7 + allowed))
        fail_msg("probe %d: the stretch %g..%g leaves out %.3g", i, t0_m, t1_m, left_out);
}

/* A kind of medium, the first of the scene: draws a probe, and checks a result. */
typedef struct probe draw_probe(const struct test_scene *test, uint64_t *random, int i);
typedef void check_answer(const struct test_scene *test, const struct ray *ray,
                          const struct answer *answer, int i, struct worst *worst);

static void check_probes(struct neph_vulkan *vulkan, const struct test_scene *test,
                         uint64_t *random, draw_probe *draw, check_answer *check,
                         struct worst *worst)
{
    static struct probe probes[PROBES_MAX];
    for (int i = 0; i < PROBES_MAX; i++)
        probes[i] = draw(test, random, i);
    OWNED(memory) struct answer *answers = ask(vulkan, test, probes, PROBES_MAX);
    for (int i = 0; i < PROBES_MAX; i++) {
        const struct ray ray = ray_of(test, &probes[i]);
        check(test, &ray, &answers[i], i, worst);
    }
}

static double extinction_at(const struct test_scene *test, const struct ray *ray)
{
    return neph_medium_extinction_per_m(&test->scene.media[0], ray->origin_m);
}

static double depth_along(const struct test_scene *test, const struct ray *ray)
{
    return neph_medium_optical_depth(&test->scene.media[0], ray->origin_m, ray->direction, 0.0,
                                     ray->length_m);
}

static void print_worst(const char *name, const struct worst *worst)
{
    print_message("%s: worst error is %.2f of what is allowed at points, %.2f on rays\n", name,
                  worst->extinction, worst->depth);
}

/* --- Gaussian blobs ----------------------------------------------------------------------- */

/* extinction at which neph_medium_support() ends */
static const double support_cut = 1e-12;

static struct probe draw_gaussian(const struct test_scene *test, uint64_t *random, int i)
{
    static const double lengths[] = {1e-4, 0.01, 0.3, 1.0, 3.0, 20.0, 1e4, 1e12};
    const struct neph_gaussian *blob = &test->scene.media[0].gaussian;
    const double reach_m = blob->width_m * (i % 3 ? 3.0 : 10.0);
    const struct neph_vec3 origin_m = i % 50 ? point_near(random, blob->center_m, reach_m)
                                             : blob->center_m;
    return probe_from(test, origin_m, odd_direction(random), blob->width_m * PICK(random, lengths));
}

static void check_gaussian(const struct test_scene *test, const struct ray *ray,
                           const struct answer *answer, int i, struct worst *worst)
{
    const struct neph_medium *medium = &test->scene.media[0];
    const struct neph_gaussian *blob = &medium->gaussian;
    const double w_m = blob->width_m;
    const struct neph_vec3 to_center_m = neph_vec3_sub(blob->center_m, ray->origin_m);
    const double far_m = neph_vec3_length(neph_vec3_sub(blob->center_m, test->key.position_m));
    const double place_m = ray->place_m + 4.0 * epsilon * far_m;
    const double r = neph_vec3_length(to_center_m) / w_m;
    const double extinction = extinction_at(test, ray);
    /* e^-x: its own rounding, the rounding of x = r^2 / 2, and the derivative r / w of x. */
    const double relative = epsilon * (16.0 + 8.0 * r * r) + place_m / w_m * r;
    hold(answer->extinction_per_m, extinction,
         extinction * expm1(relative) + support_cut * medium->extinction_per_m, &worst->extinction,
         "extinction", i);
    const double depth = depth_along(test, ray);
    const double nearest_m = fmax(0.0,
                                  fmin(ray->length_m, neph_vec3_dot(to_center_m, ray->direction)));
    const double peak = neph_medium_extinction_per_m(
        medium, neph_vec3_along(ray->origin_m, ray->direction, nearest_m));
    const double q = log(medium->extinction_per_m / fmax(peak, 1e-300));
    const double here_m = place_m + 8.0 * epsilon * fmin(ray->length_m, r * w_m + 6.0 * w_m);
    /* Ends and line have an error of `here`: times the density for the ends, times the derivative
     * for the line. */
    const double allowed = depth * epsilon * (24.0 + 8.0 * q) +
                           here_m * (2.0 * peak + depth / w_m * sqrt(2.0 * q)) +
                           8.0 * support_cut * medium->extinction_per_m * w_m;
    hold(answer->optical_depth, depth, allowed, &worst->depth, "optical depth", i);
    hold_stretch(answer, ray, medium, allowed + depth * 1e-6, i);
}

static void test_gaussian_blobs(void **state)
{
    uint64_t random = seed;
    struct worst worst = {0};
    static const double widths_m[] = {0.01, 3.0, 500.0};
    static const double depths[] = {1e-9, 0.5, 300.0};
    for (int round = 0; round < 9; round++) {
        struct test_scene test;
        look_from(&test, (struct neph_vec3){round < 6 ? 3.0 : 1e6, 2.0, round % 2 ? -5.0 : -3e5});
        const double width_m = widths_m[round % 3];
        struct neph_medium *blob = test_add_cloud(&test, NEPH_MEDIUM_GAUSSIAN,
                                                  depths[round / 3] / width_m);
        blob->gaussian = (struct neph_gaussian){
            point_near(&random, test.key.position_m, 20.0 * width_m), width_m};
        check_probes(*state, &test, &random, draw_gaussian, check_gaussian, &worst);
    }
    print_worst("Gaussian", &worst);
}

/* --- plumes of smoke ---------------------------------------------------------------------- */

/* Derivative of the exponent at a point [1/m]; `folds` receives the exponent. */
static double plume_slope_per_m(const struct neph_plume *plume, struct neph_vec3 point_m,
                                double *folds)
{
    const struct neph_vec3 from_foot_m = neph_vec3_sub(point_m, plume->foot_m);
    const double along_m = neph_vec3_dot(from_foot_m, plume->axis);
    const double across_m = neph_vec3_length(neph_vec3_along(from_foot_m, plume->axis, -along_m));
    const double width2_m2 = plume->width_m * plume->width_m;
    *folds = fmax(0.0, along_m) / plume->scale_height_m + 0.5 * across_m * across_m / width2_m2;
    return 1.0 / plume->scale_height_m + across_m / width2_m2;
}

static struct probe draw_plume(const struct test_scene *test, uint64_t *random, int i)
{
    static const double lengths[] = {1e-4, 0.01, 0.3, 1.0, 3.0, 20.0, 1e4, 1e12};
    const struct neph_plume *plume = &test->scene.media[0].plume;
    const double scale_m = fmax(plume->width_m, plume->scale_height_m);
    const struct neph_vec3 origin_m = point_near(random, plume->foot_m,
                                                 scale_m * (i % 3 ? 1.0 : 6.0));
    return probe_from(test, origin_m, i % 7 ? random_direction(random) : plume->axis,
                      scale_m * PICK(random, lengths));
}

static void check_plume(const struct test_scene *test, const struct ray *ray,
                        const struct answer *answer, int i, struct worst *worst)
{
    const struct neph_medium *medium = &test->scene.media[0];
    const struct neph_plume *plume = &medium->plume;
    const double scale_m = fmax(plume->width_m, plume->scale_height_m);
    const double far_m = neph_vec3_length(neph_vec3_sub(plume->foot_m, test->key.position_m));
    const double place_m = ray->place_m + 4.0 * epsilon * far_m;
    const struct neph_vec3 from_foot_m = neph_vec3_sub(ray->origin_m, plume->foot_m);
    const double cut = support_cut * medium->extinction_per_m;
    double folds;
    const double slope_per_m = plume_slope_per_m(plume, ray->origin_m, &folds);
    const double extinction = extinction_at(test, ray);
    if (fabs(neph_vec3_dot(from_foot_m, plume->axis)) > place_m) /* above or below */
        hold(answer->extinction_per_m, extinction,
             extinction * expm1(epsilon * (16.0 + 16.0 * folds) + place_m * slope_per_m) + cut,
             &worst->extinction, "extinction", i);
    /* The quadrature, the rounding of the exponent, and positions: times the density at the ends,
     * times the derivative beside the ray where the density is relevant. */
    const double depth = depth_along(test, ray);
    const double here_m = place_m + 16.0 * epsilon * (neph_vec3_length(from_foot_m) + scale_m);
    const double steepest_per_m = 1.0 / plume->scale_height_m + 6.0 / plume->width_m;
    const double allowed = depth * (1e-6 + 64.0 * epsilon + here_m * steepest_per_m) +
                           2.0 * here_m * medium->extinction_per_m + 8.0 * cut * scale_m;
    hold(answer->optical_depth, depth, allowed, &worst->depth, "optical depth", i);
    hold_stretch(answer, ray, medium, allowed, i);
}

static void test_plumes(void **state)
{
    uint64_t random = seed;
    struct worst worst = {0};
    static const double widths_m[] = {0.1, 3.0, 500.0}, heights[] = {0.2, 1.0, 30.0};
    for (int round = 0; round < 9; round++) {
        struct test_scene test;
        look_from(&test, (struct neph_vec3){round < 6 ? 3.0 : 1e5, 2.0, round % 2 ? -5.0 : -3e4});
        const double width_m = widths_m[round % 3], height_m = width_m * heights[round / 3];
        struct neph_medium *plume = test_add_cloud(&test, NEPH_MEDIUM_PLUME, 0.5 / width_m);
        plume->plume = (struct neph_plume){point_near(&random, test.key.position_m, 10.0 * width_m),
                                           random_direction(&random), width_m, height_m};
        check_probes(*state, &test, &random, draw_plume, check_plume, &worst);
    }
    print_worst("plumes", &worst);
}

/* --- shells ------------------------------------------------------------------------------- */

/* Length from a ray's lowest point over which the density, and so the position, is relevant. */
static double relevant_m(const struct neph_shell *shell, double r_m, double lowest_m,
                         double length_m)
{
    const double reach_m = sqrt(2.0 * 20.0 * shell->scale_height_m *
                                (r_m + 20.0 * shell->scale_height_m));
    return fmin(length_m, fabs(lowest_m) + reach_m);
}

static struct probe draw_shell(const struct test_scene *test, uint64_t *random, int i)
{
    static const double lengths[] = {1e-3, 0.1, 1.0, 10.0, 1e3, 1e12};
    const struct neph_shell *shell = &test->scene.media[0].shell;
    const double h_m = shell->scale_height_m;
    const double reach_m = i % 7 == 0 ? 0.0 : i % 3 ? 5.0 * h_m : 2.0 * sqrt(shell->radius_m * h_m);
    return probe_from(test, point_near(random, test->key.position_m, reach_m),
                      odd_direction(random), h_m * PICK(random, lengths));
}

static void check_shell(const struct test_scene *test, const struct ray *ray,
                        const struct answer *answer, int i, struct worst *worst)
{
    const struct neph_medium *medium = &test->scene.media[0];
    const struct neph_shell *shell = &medium->shell;
    const double r_m = shell->radius_m, h_m = shell->scale_height_m;
    const struct neph_vec3 from_center_m = neph_vec3_sub(ray->origin_m, shell->center_m);
    const double height_m = neph_vec3_length(from_center_m) - r_m;
    const double lowest_m = -neph_vec3_dot(from_center_m, ray->direction);
    const double low_m =
        neph_vec3_length(neph_vec3_along(from_center_m, ray->direction, lowest_m)) - r_m;
    const double extinction = extinction_at(test, ray);
    const double place_m = 2.0 * ray->place_m + 4.0 * epsilon * fabs(height_m);
    if (fabs(height_m) > place_m)
        hold(answer->extinction_per_m, extinction,
             extinction * expm1(epsilon * (16.0 + 4.0 * fabs(height_m) / h_m) + place_m / h_m) +
                 smallest,
             &worst->extinction, "extinction", i);
    const double seen_m = relevant_m(shell, r_m, lowest_m, ray->length_m);
    const double here_m = place_m + 16.0 * epsilon * seen_m;
    assert_true(answer->optical_depth >= 0.0f && isfinite(answer->optical_depth));
    /* Tangent to the ground within rounding: in the densest air, or below the ground. */
    if (fabs(low_m) <= 4.0 * here_m || fabs(height_m) <= 4.0 * here_m) {
        worst->left_out++;
        return;
    }
    const double depth = depth_along(test, ray);
    const double ends = extinction +
                        neph_medium_extinction_per_m(
                            medium, neph_vec3_along(ray->origin_m, ray->direction, ray->length_m));
    /* Where a ray meets the ground at a slant, an altitude error `here` moves the point by here /
     * slant. */
    const double slant = low_m < 0.0 ? sqrt(-low_m * (2.0 * r_m + low_m)) / r_m : 1.0;
    const double ground = low_m < 0.0 ? medium->extinction_per_m / slant : 0.0;
    const double allowed = depth * (1e-6 + expm1(2.0 * here_m / h_m)) +
                           here_m * (ends + 2.0 * ground) + smallest * seen_m;
    hold(answer->optical_depth, depth, allowed, &worst->depth, "optical depth", i);
    hold_stretch(answer, ray, medium, allowed + depth * 1e-6, i);
}

static void test_shells(void **state)
{
    uint64_t random = seed;
    struct worst worst = {0};
    static const struct {
        double radius_m, scale_height_m, altitude_m;
    } cases[] = {
        {6.371e6, 8000.0, 1.6},   {6.371e6, 8000.0, 12000.0}, {6.371e6, 8000.0, 4e5},
        {6.371e6, 1200.0, 500.0}, {2e5, 100.0, 50.0},         {1000.0, 100.0, 30.0},
        {100.0, 100.0, 20.0},     {6.371e6, 8000.0, -50.0},
    };
    for (size_t c = 0; c < sizeof(cases) / sizeof(cases[0]); c++) {
        struct test_scene test;
        const struct neph_vec3 center_m = {c % 2 ? 3e6 : 0.0, -cases[c].radius_m, 0.0};
        const struct neph_vec3 up = c % 3 == 2 ? neph_vec3_normalize((struct neph_vec3){1, 2, -1})
                                               : (struct neph_vec3){0, 1, 0};
        look_from(&test, neph_vec3_along(center_m, up, cases[c].radius_m + cases[c].altitude_m));
        struct neph_medium *medium = test_add_cloud(&test, NEPH_MEDIUM_SHELL,
                                                    0.3 / cases[c].scale_height_m);
        medium->shell = (struct neph_shell){center_m, cases[c].radius_m, cases[c].scale_height_m};
        worst.left_out = 0;
        check_probes(*state, &test, &random, draw_shell, check_shell, &worst);
        print_message("shell of %g m, %g m high, from %g m: %d of %d graze the ground\n",
                      cases[c].radius_m, cases[c].scale_height_m, cases[c].altitude_m,
                      worst.left_out, PROBES_MAX);
        assert_true(worst.left_out < PROBES_MAX / 2);
    }
    print_worst("shells", &worst);
}

/* --- tents -------------------------------------------------------------------------------- */

/* Length of the ray below the top of the tent. */
static double below_top_m(const struct neph_tent *tent, const struct ray *ray, double more_m)
{
    const struct neph_vec3 from_center_m = neph_vec3_sub(ray->origin_m, tent->center_m);
    const double middle_m = -neph_vec3_dot(from_center_m, ray->direction);
    const double low_m = neph_vec3_length(neph_vec3_along(from_center_m, ray->direction, middle_m));
    const double top_m = tent->radius_m + tent->altitude_m + tent->half_width_m + more_m;
    const double half_m = low_m < top_m ? sqrt((top_m - low_m) * (top_m + low_m)) : 0.0;
    return fmax(0.0, fmin(ray->length_m, middle_m + half_m) - fmax(0.0, middle_m - half_m));
}

static struct probe draw_tent(const struct test_scene *test, uint64_t *random, int i)
{
    static const double lengths[] = {1e-2, 1.0, 10.0, 1e3, 1e12};
    const struct neph_tent *tent = &test->scene.media[0].tent;
    const double reach_m = i % 7 == 0 ? 0.0
                           : i % 3    ? 2.0 * tent->half_width_m
                                      : sqrt(tent->radius_m * tent->altitude_m);
    return probe_from(test, point_near(random, test->key.position_m, reach_m),
                      odd_direction(random), tent->half_width_m * PICK(random, lengths));
}

static void check_tent(const struct test_scene *test, const struct ray *ray,
                       const struct answer *answer, int i, struct worst *worst)
{
    const struct neph_tent *tent = &test->scene.media[0].tent;
    const double per_m = test->scene.media[0].extinction_per_m;
    const double off_m = fabs(neph_vec3_length(neph_vec3_sub(ray->origin_m, tent->center_m)) -
                              tent->radius_m);
    const double place_m = 2.0 * ray->place_m + 8.0 * epsilon * (off_m + tent->altitude_m);
    hold(answer->extinction_per_m, extinction_at(test, ray),
         per_m * (place_m / tent->half_width_m + 8.0 * epsilon), &worst->extinction, "extinction",
         i);
    /* Altitudes along the ray have rounding errors of its length, for every position of the
     * tent. */
    const double inside_m = below_top_m(tent, ray, place_m);
    const double height_m = place_m + 16.0 * epsilon * inside_m;
    const double depth = depth_along(test, ray);
    const double allowed = 2e-6 * depth +
                           per_m * (inside_m * height_m / tent->half_width_m + 4.0 * height_m);
    hold(answer->optical_depth, depth, allowed, &worst->depth, "optical depth", i);
}

static void test_tents(void **state)
{
    uint64_t random = seed;
    struct worst worst = {0};
    static const struct {
        double radius_m, altitude_m, half_width_m, camera_m;
    } cases[] = {
        {6.36e6, 25e3, 15e3, 1.6},    {6.36e6, 25e3, 15e3, 25e3}, {6.36e6, 25e3, 15e3, 4e5},
        {1000.0, 200.0, 100.0, 30.0}, {100.0, 60.0, 50.0, 80.0},
    };
    for (size_t c = 0; c < sizeof(cases) / sizeof(cases[0]); c++) {
        struct test_scene test;
        const struct neph_vec3 center_m = {c % 2 ? 3e6 : 0.0, -cases[c].radius_m, 0.0};
        look_from(&test, neph_vec3_along(center_m, (struct neph_vec3){0, 1, 0},
                                         cases[c].radius_m + cases[c].camera_m));
        struct neph_medium *medium = test_add_cloud(&test, NEPH_MEDIUM_TENT,
                                                    0.3 / cases[c].half_width_m);
        medium->tent = (struct neph_tent){center_m, cases[c].radius_m, cases[c].altitude_m,
                                          cases[c].half_width_m};
        check_probes(*state, &test, &random, draw_tent, check_tent, &worst);
    }
    print_worst("tents", &worst);
}

/* --- grids -------------------------------------------------------------------------------- */

static struct neph_vec3 random_node(uint64_t *random, const struct neph_grid *grid)
{
    const double half[] = {0.0, 0.5};
    return (struct neph_vec3){
        grid->origin_m.x +
            grid->spacing_m.x *
                ((double)(neph_test_random(random) % (uint64_t)grid->size[0]) + PICK(random, half)),
        grid->origin_m.y +
            grid->spacing_m.y *
                ((double)(neph_test_random(random) % (uint64_t)grid->size[1]) + PICK(random, half)),
        grid->origin_m.z +
            grid->spacing_m.z * ((double)(neph_test_random(random) % (uint64_t)grid->size[2]) +
                                 PICK(random, half))};
}

static bool is_near_face(const struct neph_bounds *bounds, struct neph_vec3 p, double place_m)
{
    return fabs(p.x - bounds->min_m.x) < place_m || fabs(p.x - bounds->max_m.x) < place_m ||
           fabs(p.y - bounds->min_m.y) < place_m || fabs(p.y - bounds->max_m.y) < place_m ||
           fabs(p.z - bounds->min_m.z) < place_m || fabs(p.z - bounds->max_m.z) < place_m;
}

/* Effect on the optical depth when the faces of the bounds move: for rays along a face. */
static double edge_effect(const struct neph_medium *medium, const struct ray *ray, double by_m)
{
    struct neph_medium wide = *medium, narrow = *medium;
    const struct neph_vec3 by = {by_m, by_m, by_m};
    wide.bounds.min_m = neph_vec3_sub(wide.bounds.min_m, by);
    wide.bounds.max_m = neph_vec3_add(wide.bounds.max_m, by);
    narrow.bounds.min_m = neph_vec3_add(narrow.bounds.min_m, by);
    narrow.bounds.max_m = neph_vec3_sub(narrow.bounds.max_m, by);
    return neph_medium_optical_depth(&wide, ray->origin_m, ray->direction, 0.0, ray->length_m) -
           neph_medium_optical_depth(&narrow, ray->origin_m, ray->direction, 0.0, ray->length_m);
}

static double extent_of(const struct neph_grid *grid, struct neph_vec3 *center_m)
{
    const struct neph_bounds support = neph_grid_support(grid);
    *center_m = neph_vec3_scale(neph_vec3_add(support.min_m, support.max_m), 0.5);
    return neph_vec3_length(neph_vec3_sub(support.max_m, support.min_m));
}

static struct probe draw_grid(const struct test_scene *test, uint64_t *random, int i)
{
    static const double lengths[] = {1e-4, 0.03, 0.2, 1.0, 3.0, 1e6};
    const struct neph_grid *grid = test->scene.media[0].grid;
    struct neph_vec3 center_m;
    const double extent_m = extent_of(grid, &center_m);
    struct neph_vec3 origin_m = i % 4 ? point_near(random, center_m, 0.6 * extent_m)
                                      : random_node(random, grid); /* on faces and edges */
    struct neph_vec3 direction = odd_direction(random);
    if (i % 5 == 0) /* from outside, aimed at a node */
        direction = neph_vec3_normalize(neph_vec3_sub(
            random_node(random, grid), origin_m = point_near(random, center_m, 3.0 * extent_m)));
    return probe_from(test, origin_m, direction, extent_m * PICK(random, lengths));
}

static void check_grid(const struct test_scene *test, const struct ray *ray,
                       const struct answer *answer, int i, struct worst *worst)
{
    const struct neph_medium *medium = &test->scene.media[0];
    const struct neph_grid *grid = medium->grid;
    const struct neph_vec3 h = grid->spacing_m;
    const double per_m = 1.0 / h.x + 1.0 / h.y + 1.0 / h.z;
    const double nodes = grid->size[0] + grid->size[1] + grid->size[2] + 6.0;
    const double peak = medium->extinction_per_m * (double)grid->maximum;
    struct neph_vec3 center_m;
    const double extent_m = extent_of(grid, &center_m);
    const double corner_m = neph_vec3_length(neph_vec3_sub(center_m, test->key.position_m)) +
                            extent_m;
    /* A position has a few roundings of its size and of the corner's, and one of its node number;
     * times the largest slope of the density. */
    const double place_m = ray->place_m + 4.0 * epsilon * corner_m;
    const double slope = peak * (place_m * per_m + 4.0 * epsilon * nodes);
    if (!is_near_face(&medium->bounds, ray->origin_m, place_m)) /* certainly inside or outside */
        hold(answer->extinction_per_m, extinction_at(test, ray), slope + 8.0 * epsilon * peak,
             &worst->extinction, "extinction", i);
    const double depth = depth_along(test, ray);
    const double allowed = slope * fmin(ray->length_m, extent_m) + 4.0 * place_m * peak +
                           24.0 * epsilon * depth + edge_effect(medium, ray, 2.0 * place_m);
    hold(answer->optical_depth, depth, allowed, &worst->depth, "optical depth", i);
    hold_stretch(answer, ray, medium, allowed, i);
}

static void test_grids(void **state)
{
    uint64_t random = seed;
    static const struct {
        int size[3];
        struct neph_vec3 spacing_m;
        double distance_m; /* of the camera */
    } cases[] = {
        {{7, 6, 5}, {1.0, 0.9, 1.3}, 10.0},      {{1, 1, 1}, {2.0, 3.0, 4.0}, 5.0},
        {{64, 64, 64}, {0.5, 0.5, 0.5}, 100.0},  {{300, 2, 1}, {0.1, 7.0, 3.0}, 20.0},
        {{40, 30, 20}, {25.0, 50.0, 25.0}, 1e5},
    };
    struct worst worst = {0};
    for (size_t c = 0; c < sizeof(cases) / sizeof(cases[0]); c++) {
        OWNED(media) struct test_scene test;
        const struct neph_vec3 origin_m = {1000.0 + (double)c, 17.0, -3.0};
        look_from(&test, neph_vec3_add(origin_m, neph_vec3_scale(odd_direction(&random),
                                                                 cases[c].distance_m)));
        struct neph_medium *medium = test_add_cloud(&test, NEPH_MEDIUM_GRID, 0.7);
        medium->grid = random_lattice(cases[c].size, origin_m, cases[c].spacing_m, -0.5, &random);
        if (c == 2) /* bounds that cut the grid */
            medium->bounds = (struct neph_bounds){{1005.0, 20.0, -INFINITY}, {1030.0, 40.0, 20.0}};
        check_probes(*state, &test, &random, draw_grid, check_grid, &worst);
    }
    print_worst("grids", &worst);
}

/* Several media with data: each reads its own. */
static void test_grids_beside_each_other(void **state)
{
    uint64_t random = seed;
    OWNED(media) struct test_scene test;
    look_from(&test, (struct neph_vec3){0.0, 0.0, 0.0});
    for (int m = 0; m < 4; m++) {
        struct neph_medium *medium = test_add_cloud(&test, NEPH_MEDIUM_GRID, 1.0 + m);
        medium->grid = random_lattice((const int[3]){3 + m, 4, 5},
                                      (struct neph_vec3){-2.0, -2.0, -2.0},
                                      (struct neph_vec3){1.0, 1.0, 1.0}, -0.5, &random);
    }
    struct probe probes[400];
    for (int i = 0; i < 400; i++) {
        probes[i] = probe_from(&test, point_near(&random, (struct neph_vec3){0, 0, 0}, 3.0),
                               odd_direction(&random), 4.0);
        probes[i].medium = (uint32_t)i % 4;
    }
    OWNED(memory) struct answer *answers = ask(*state, &test, probes, 400);
    for (int i = 0; i < 400; i++) {
        const struct ray ray = ray_of(&test, &probes[i]);
        const struct neph_medium *medium = &test.scene.media[i % 4];
        neph_assert_close(answers[i].extinction_per_m,
                          neph_medium_extinction_per_m(medium, ray.origin_m), 0.0, 3e-5);
        neph_assert_close(answers[i].optical_depth,
                          neph_medium_optical_depth(medium, ray.origin_m, ray.direction, 0.0, 4.0),
                          0.0, 3e-5);
    }
}

/* An endless grid seen from far away, compared with double precision: one period away and many,
 * along faces and through them. */
static void test_endless_grids(void **state)
{
    uint64_t random = seed;
    OWNED(media) struct test_scene test;
    const struct neph_vec3 eye_m = {-40123.0, 30.0, 77001.0}, h = {3.0, 2.0, 7.0};
    look_from(&test, eye_m);
    struct neph_medium *medium = test_add_cloud(&test, NEPH_MEDIUM_GRID, 0.1);
    medium->grid = random_lattice((const int[3]){5, 6, 3}, (struct neph_vec3){11.0, 20.0, -4.0}, h,
                                  -0.5, &random);
    medium->grid->is_endless[0] = medium->grid->is_endless[2] = true;
    struct probe probes[600];
    for (int i = 0; i < 600; i++) {
        const struct neph_vec3 at_m = point_near(&random, eye_m, i % 2 ? 20.0 : 400.0);
        probes[i] = probe_from(&test, (struct neph_vec3){at_m.x, 15.0 + (i % 20), at_m.z},
                               odd_direction(&random), i % 3 ? 15.0 : 300.0);
    }
    OWNED(memory) struct answer *answers = ask(*state, &test, probes, 600);
    const double peak = 0.1 * (double)medium->grid->maximum;
    int met = 0;
    for (int i = 0; i < 600; i++) {
        const struct ray ray = ray_of(&test, &probes[i]);
        const double place_m = ray.place_m + 4.0 * epsilon * 1e3, /* of periods from the camera */
            slope = peak * place_m * (1.0 / h.x + 1.0 / h.y + 1.0 / h.z);
        const double depth = neph_medium_optical_depth(medium, ray.origin_m, ray.direction, 0.0,
                                                       ray.length_m);
        neph_assert_close(answers[i].extinction_per_m,
                          neph_medium_extinction_per_m(medium, ray.origin_m), 1e-5,
                          4.0 * slope + 1e-6 * peak);
        neph_assert_close(answers[i].optical_depth, depth, 1e-4,
                          4.0 * slope * ray.length_m + 8.0 * place_m * peak);
        met += depth > 0.0;
    }
    assert_true(met > 300);
}

/* --- Horizon clouds ----------------------------------------------------------------------- */

/* A point at an altitude above the bottom of the layer, at horizontal distances from its pole. */
static struct neph_vec3 point_in_layer(const struct neph_horizon_params *params, double x_m,
                                       double z_m, double altitude_m)
{
    const double r_m = params->planet_radius_m + altitude_m;
    const double level_squared = x_m * x_m + z_m * z_m;
    const double sag_m = level_squared / (r_m + sqrt(r_m * r_m - level_squared));
    return (struct neph_vec3){x_m, params->bottom_m + altitude_m - sag_m, z_m};
}

/* The weather map at a point; shapes are divided by it, times gc. */
static double coverage_at(const struct neph_horizon *horizon, struct neph_vec3 point_m)
{
    enum { SIDE = NEPH_HORIZON_WEATHER_SIDE };
    const struct neph_horizon_params *params = &horizon->params;
    const double x = (point_m.x - params->wind_m.x) / params->texture_scale_m * SIDE - 0.5;
    const double z = (point_m.z - params->wind_m.z) / params->texture_scale_m * SIDE - 0.5;
    double sum = 0.0;
    for (int corner = 0; corner < 4; corner++) {
        const double i = floor(x) + (corner & 1), k = floor(z) + (corner >> 1);
        const double weight = (1.0 - fabs(x - i)) * (1.0 - fabs(z - k));
        const int at_x = (int)(i - SIDE * floor(i / SIDE)),
                  at_z = (int)(k - SIDE * floor(k / SIDE));
        sum += weight * (double)horizon->weather[4 * (at_z * SIDE + at_x)];
    }
    return sum;
}

/* Changes of the density, with and without detail, among the positions to which float32 may round a
 * point. */
static void change_nearby(const struct neph_horizon *horizon, struct neph_vec3 point_m,
                          double place_m, double change[2])
{
    double without_detail;
    const double density = neph_horizon_density(horizon, point_m, &without_detail);
    change[0] = change[1] = 0.0;
    for (int i = 0; i < 27; i++) {
        const struct neph_vec3 step = {i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1};
        double near_without_detail;
        const double near = neph_horizon_density(horizon, neph_vec3_along(point_m, step, place_m),
                                                 &near_without_detail);
        change[0] = fmax(change[0], fabs(near - density));
        change[1] = fmax(change[1], fabs(near_without_detail - without_detail));
    }
}

/* Rays up to the distance of the camera's target. */
static struct probe draw_horizon(const struct test_scene *test, uint64_t *random, int i)
{
    const struct neph_horizon_params *params = &test->scene.media[0].horizon->params;
    const double altitude_m = params->thickness_m * neph_test_uniform(random, -0.05, 1.05);
    const double look_m = neph_vec3_length(
        neph_vec3_sub(test->key.look_at_m, test->key.position_m));
    const double reach_m = look_m * (i % 3 ? 1.0 : 0.05);
    const double x_m = test->key.position_m.x + reach_m * neph_test_uniform(random, -1, 1);
    const double z_m = test->key.position_m.z + reach_m * neph_test_uniform(random, -1, 1);
    return probe_from(test, point_in_layer(params, x_m, z_m, altitude_m), odd_direction(random),
                      1e4);
}

/* Positions: a few roundings of the distance from the camera, of the camera's height and of one
 * repeat of the weather map. Formulas: a few roundings of numbers up to 1, over the coverage and
 * over 1 - erosion, which is at least 0.2; times the largest mass. */
static void check_horizon(const struct test_scene *test, const struct ray *ray,
                          const struct answer *answer, int i, struct worst *worst)
{
    const struct neph_medium *medium = &test->scene.media[0];
    const struct neph_horizon *horizon = medium->horizon;
    const struct neph_horizon_params *params = &horizon->params;
    const double camera_m = fabs(test->key.position_m.y - params->bottom_m);
    const double place_m = 2.0 * ray->place_m +
                           8.0 * epsilon * (camera_m + params->texture_scale_m);
    double without_detail, change[2];
    const double density = neph_horizon_density(horizon, ray->origin_m, &without_detail);
    change_nearby(horizon, ray->origin_m, place_m, change);
    const double coverage = params->coverage * coverage_at(horizon, ray->origin_m);
    const double rounding = 64.0 * epsilon * 2.0 * params->density *
                            (1.0 + 1.0 / fmax(coverage, epsilon));
    const double scale = medium->extinction_per_m;
    hold(answer->extinction_per_m, scale * density, scale * (2.0 * change[0] + rounding),
         &worst->extinction, "extinction", i);
    hold(answer->without_detail, without_detail, 2.0 * change[1] + rounding, &worst->extinction,
         "density without detail", i);
    hold(answer->height, horizon_height(horizon, ray->origin_m),
         place_m / params->thickness_m + 4.0 * epsilon, &worst->extinction, "height", i);
    worst->met += density > 0.0;
    if (i % 20 == 0)
        hold_stretch(answer, ray, medium, 4.0 * place_m * scale * params->density + 1e-6, i);
}

static void test_horizon_clouds(void **state)
{
    static const struct {
        double planet_radius_m, bottom_m, thickness_m, coverage, texture_scale_m;
        struct neph_vec3 wind_m, camera_m;
        double reach_m;
    } cases[] = {
        {2e5, 80.0, 280.0, 0.58, 6e3, {0, 0, 0}, {0.0, 2.0, 0.0}, 1e4},
        {2e5, 80.0, 280.0, 1.0, 6e3, {123.0, -7.0, 4e4}, {900.0, 200.0, 50.0}, 3e3},
        {6.371e6, 1500.0, 2500.0, 0.7, 4e4, {0, 0, 0}, {1e5, 9000.0, -2e5}, 5e4},
        {1e4, 0.0, 500.0, 0.9, 1e3, {1e7, 1e7, 1e7}, {5e3, 100.0, 0.0}, 4e3},
    };
    uint64_t random = seed;
    struct worst worst = {0};
    for (size_t c = 0; c < sizeof(cases) / sizeof(cases[0]); c++) {
        OWNED(media) struct test_scene test;
        struct neph_diag diag = {0};
        look_from(&test, cases[c].camera_m);
        struct neph_medium *medium = test_add_cloud(&test, NEPH_MEDIUM_HORIZON, 0.05);
        struct neph_horizon_params params = neph_horizon_defaults();
        params.planet_radius_m = cases[c].planet_radius_m;
        params.bottom_m = cases[c].bottom_m;
        params.thickness_m = cases[c].thickness_m;
        params.coverage = cases[c].coverage;
        params.texture_scale_m = cases[c].texture_scale_m;
        params.wind_m = cases[c].wind_m;
        params.seed = c + 1;
        neph_assert_ok(neph_horizon_create(&params, &medium->horizon, &diag), &diag);
        test.key.look_at_m.z = test.key.position_m.z - cases[c].reach_m;
        worst.met = 0;
        check_probes(*state, &test, &random, draw_horizon, check_horizon, &worst);
        print_message("Horizon clouds of coverage %g: density in %d of %d points\n",
                      params.coverage, worst.met, PROBES_MAX);
        assert_true(worst.met > PROBES_MAX / 100);
    }
    print_worst("Horizon clouds", &worst);
}

/* --- extreme media -------------------------------------------------------------------------- */

/* Extremes of every parameter: all results are finite. */
static void test_extreme_media_give_no_nonsense(void **state)
{
    static const double sizes[] = {1e-9, 1e-3, 1.0, 1e5, 1e12};
    static const double extinctions[] = {1e-40, 1e-12, 1.0, 1e20, 1e30};
    static const double places[] = {0.0, 1.0, -1e3, 1e7, -1e12};
    uint64_t random = seed;
    for (int round = 0; round < 60; round++) {
        OWNED(media) struct test_scene test;
        look_from(&test, (struct neph_vec3){PICK(&random, places), PICK(&random, places), 0.0});
        const enum neph_medium_kind kinds[] = {NEPH_MEDIUM_GAUSSIAN, NEPH_MEDIUM_SHELL,
                                               NEPH_MEDIUM_GRID};
        struct neph_medium *medium = test_add_cloud(&test, kinds[round % 3],
                                                    PICK(&random, extinctions));
        const struct neph_vec3 center_m = {PICK(&random, places), PICK(&random, places),
                                           PICK(&random, places)};
        medium->gaussian = (struct neph_gaussian){center_m, PICK(&random, sizes)};
        medium->shell = (struct neph_shell){center_m, PICK(&random, sizes), PICK(&random, sizes)};
        if (kinds[round % 3] == NEPH_MEDIUM_GRID) {
            const double spacing_m = fmax(PICK(&random, sizes), /* finer spacings are refused */
                                          1e-12 * neph_vec3_length(center_m));
            medium->grid = random_lattice((const int[3]){3, 2, 4}, center_m,
                                          (struct neph_vec3){spacing_m, spacing_m, 2.0 * spacing_m},
                                          -0.5, &random);
            medium->grid->values[3] = 3e38f;
        }
        struct probe probes[256];
        for (int i = 0; i < 256; i++)
            probes[i] = probe_from(&test,
                                   point_near(&random, i % 2 ? center_m : test.key.position_m,
                                              i % 4 ? PICK(&random, sizes) : 0.0),
                                   odd_direction(&random), i % 3 ? PICK(&random, sizes) : 1e15);
        OWNED(memory) struct answer *answers = ask(*state, &test, probes, 256);
        for (int i = 0; i < 256; i++)
            if (!(answers[i].extinction_per_m >= 0.0f) || isinf(answers[i].extinction_per_m) ||
                !(answers[i].optical_depth >= 0.0f) || isnan(answers[i].stretch_t0_m) ||
                isnan(answers[i].stretch_t1_m))
                fail_msg("round %d, probe %d: extinction %g, optical depth %g, stretch %g..%g",
                         round, i, (double)answers[i].extinction_per_m,
                         (double)answers[i].optical_depth, (double)answers[i].stretch_t0_m,
                         (double)answers[i].stretch_t1_m);
    }
}

static struct neph_horizon_params extreme_horizon_params(uint64_t *random)
{
    static const double sizes_m[] = {1e-9, 1e-3, 1.0, 1e5, 1e9};
    static const double repeats[] = {1e-9, 1.0, 40.0, 1e6};
    static const double heights_m[] = {0.0, 80.0, -1e9, 1e9};
    static const double parts[] = {0.0, 1e-30, 0.5, 1.0};
    static const double densities[] = {0.0, 1e-30, 1.0, 1e9};
    return (struct neph_horizon_params){
        .seed = 1,
        .planet_radius_m = PICK(random, sizes_m),
        .bottom_m = PICK(random, heights_m),
        .thickness_m = PICK(random, sizes_m),
        .coverage = PICK(random, parts),
        .density = PICK(random, densities),
        .texture_scale_m = PICK(random, sizes_m),
        .base_repeats = PICK(random, repeats),
        .detail_repeats = PICK(random, repeats),
        .wind_m = {PICK(random, heights_m), PICK(random, heights_m), PICK(random, heights_m)},
    };
}

/* All parameters within their ranges, most of them absurd. */
static void test_extreme_horizon_clouds_give_no_nonsense(void **state)
{
    static const double sizes_m[] = {1e-6, 1.0, 300.0, 1e6};
    static const double extinctions[] = {1e-40, 0.05, 1e30};
    uint64_t random = seed;
    struct neph_diag diag = {0};
    const struct neph_horizon_params defaults = neph_horizon_defaults();
    struct neph_horizon *horizon; /* its textures depend on the seed only */
    neph_assert_ok(neph_horizon_create(&defaults, &horizon, &diag), &diag);
    for (int round = 0; round < 60; round++) {
        struct test_scene test;
        horizon->params = extreme_horizon_params(&random);
        const double y_m = horizon->params.bottom_m;
        look_from(&test, (struct neph_vec3){0.0, round % 4 ? y_m : 0.0, round % 3 ? 0.0 : 1e12});
        struct neph_medium *medium = test_add_cloud(&test, NEPH_MEDIUM_HORIZON,
                                                    PICK(&random, extinctions));
        medium->horizon = horizon;
        struct probe probes[256];
        for (int i = 0; i < 256; i++)
            probes[i] = probe_from(
                &test,
                point_near(&random, test.key.position_m, i % 4 ? PICK(&random, sizes_m) : 0.0),
                odd_direction(&random), i % 3 ? 1e3 : 1e15);
        OWNED(memory) struct answer *answers = ask(*state, &test, probes, 256);
        for (int i = 0; i < 256; i++) {
            const double depth_max = (double)answers[i].extinction_per_m * 1e15;
            if (!(answers[i].extinction_per_m >= 0.0f && depth_max < 3e38) ||
                !(answers[i].without_detail >= 0.0f && answers[i].without_detail < 3e9f) ||
                !(answers[i].height >= 0.0f && answers[i].height <= 1.0f) ||
                isnan(answers[i].stretch_t0_m) || isnan(answers[i].stretch_t1_m))
                fail_msg("round %d, probe %d: extinction %g, %g without detail, height %g, stretch "
                         "%g..%g",
                         round, i, (double)answers[i].extinction_per_m,
                         (double)answers[i].without_detail, (double)answers[i].height,
                         (double)answers[i].stretch_t0_m, (double)answers[i].stretch_t1_m);
        }
    }
    neph_horizon_destroy(horizon);
}

int main(void)
{
    print_message("seed %llu\n", (unsigned long long)seed);
    const struct CMUnitTest tests[] = {
#include "cases/test_shader_media.inc"
    };
    return cmocka_run_group_tests(tests, test_vulkan_setup, test_vulkan_teardown);
}
