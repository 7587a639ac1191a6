/* SPDX-License-Identifier: MIT
 *
 * A plume of smoke against closed forms where they exist, adaptive quadrature of its density
 * elsewhere, and its own bounds.
 */
#include "tests/scene_builders.h"

#include "scenes/bake.h"
#include "scenes/media.h"
#include "scenes/quadrature.h"

static const double width_m = 0.7, scale_height_m = 3.0;
static const struct neph_vec3 foot_m = {1.0, -2.0, 0.5};

static struct neph_medium plume(struct neph_vec3 axis)
{
    return (struct neph_medium){
        .kind = NEPH_MEDIUM_PLUME,
        .bounds = everywhere,
        .extinction_color = {1, 1, 1},
        .extinction_per_m = 2.0,
        .plume = {foot_m, neph_vec3_normalize(axis), width_m, scale_height_m},
    };
}

/* Up the axis from below the foot, parallel to it, and across it. */
static void test_closed_forms(void **state)
{
    const struct neph_medium medium = plume((struct neph_vec3){0, 1, 0});
    const struct neph_vec3 up = {0, 1, 0}, across = {0, 0, 1};
    const struct neph_vec3 below_m = neph_vec3_along(foot_m, up, -5.0);
    const struct neph_vec3 beside_m = neph_vec3_along(below_m, across, 2.0 * width_m);
    const struct neph_vec3 before_m = neph_vec3_along(neph_vec3_along(foot_m, up, 1.5), across,
                                                      -100.0);
    const double whole = 2.0 * scale_height_m;
    neph_assert_close(neph_medium_optical_depth(&medium, below_m, up, 0.0, INFINITY), whole, 1e-14,
                      0.0);
    neph_assert_close(neph_medium_optical_depth(&medium, below_m, up, 0.0, 6.5),
                      whole * -expm1(-1.5 / scale_height_m), 1e-14, 0.0);
    neph_assert_close(neph_medium_optical_depth(&medium, beside_m, up, 0.0, INFINITY),
                      whole * exp(-2.0), 1e-14, 0.0);
    neph_assert_close(neph_medium_optical_depth(&medium, before_m, across, 0.0, INFINITY),
                      2.0 * exp(-1.5 / scale_height_m) * sqrt(2.0 * acos(-1.0)) * width_m, 1e-13,
                      0.0);
    assert_true(neph_medium_optical_depth(&medium, below_m, across, 0.0, INFINITY) == 0.0);
}

struct ray {
    const struct neph_medium *medium;
    struct neph_vec3 origin_m, direction;
};

static void density(double t_m, void *context, double value[3])
{
    const struct ray *ray = context;
    value[0] = value[1] = value[2] = neph_medium_extinction_per_m(
        ray->medium, neph_vec3_along(ray->origin_m, ray->direction, t_m));
}

/* Pieces between the positions of cuts, including the one at the foot. */
static void test_lines_in_all_directions(void **state)
{
    uint64_t seed = 20261123;
    struct neph_scene scene = {.medium_count = 2, .sun = {.direction = {0.6, 0.8, 0.0}}};
    for (int trial = 0; trial < 2000; trial++) {
        const struct neph_medium medium = plume(random_point(&seed, 1.0));
        const struct ray ray = {&medium, random_point(&seed, 9.0),
                                neph_vec3_normalize(random_point(&seed, 1.0))};
        static struct neph_cuts cuts;
        cuts = (struct neph_cuts){
            .scene = &scene, .origin_m = ray.origin_m, .direction = ray.direction, .t1_m = 20.0};
        neph_medium_cut_scales(&cuts, &medium);
        struct neph_interval pieces[128];
        int count = 0;
        double sum = 0.0, value[3], from_m = 0.0;
        while (from_m < cuts.t1_m) {
            double to_m = cuts.t1_m;
            for (int i = 0; i < cuts.count; i++)
                if (cuts.at_m[i] > from_m)
                    to_m = fmin(to_m, cuts.at_m[i]);
            pieces[count++] = (struct neph_interval){from_m, to_m};
            from_m = to_m;
        }
        neph_integrate(density, (void *)&ray, pieces, count, value);
        sum = neph_medium_optical_depth(&medium, ray.origin_m, ray.direction, 0.0, cuts.t1_m);
        neph_assert_close(sum, value[0], 1e-11, 1e-15);
    }
}

/* No point of a box is denser than its bound; in a small box the bound is tight. */
static void test_bound(void **state)
{
    uint64_t seed = 20261124;
    double loosest = 1.0;
    for (int trial = 0; trial < 5000; trial++) {
        const struct neph_medium medium = plume(random_point(&seed, 1.0));
        const struct neph_vec3 low_m = random_point(&seed, 4.0);
        const double side_m = pow(10.0, neph_test_uniform(&seed, -3.0, 1.0));
        const struct neph_bounds box = {
            low_m, neph_vec3_add(low_m, (struct neph_vec3){side_m, 0.5 * side_m, side_m})};
        const double used = assert_bound(&medium, &box, 40, &seed);
        if (side_m < 0.01 && used > 0.0)
            loosest = fmax(loosest, 1.0 / used);
    }
    print_message("loosest bound of a box of a centimetre: %.3g times\n", loosest);
    assert_true(loosest < 1.3);
}

/* Engines without the formula get voxels; engines without wind get the plume at its displaced
 * position. */
static void test_box_bake_and_drift(void **state)
{
    struct neph_medium medium = plume((struct neph_vec3){0.3, 1, 0});
    const struct neph_scene scene = {.medium_count = 1, .media = {medium}};
    const struct neph_vec3 by_m = {3, 0, -2};
    double cut_error;
    struct neph_diag diag = {0};
    struct neph_bake bake;
    const struct neph_bounds box = neph_medium_container(&scene, &medium, &cut_error);
    assert_true(cut_error < 1e-9);
    neph_assert_ok(neph_medium_bake(&medium, &box, 64, &bake, &diag), &diag);
    print_message("64 voxels: extinction off by %.2g rms, optical depths by %.2g\n",
                  bake.error.extinction_rms_relative, bake.error.optical_depth_rms);
    assert_true(bake.error.extinction_rms_relative < 0.5); /* the limit of engines */
    neph_bake_finish(&bake);
    const double before_per_m = neph_medium_extinction_per_m(&medium, (struct neph_vec3){1, 0, 1});
    assert_true(neph_medium_drifts(&medium));
    neph_medium_drift(&medium, by_m);
    neph_assert_close(neph_medium_extinction_per_m(&medium, (struct neph_vec3){4, 0, -1}),
                      before_per_m, 1e-14, 0.0);
}

#include "tests/main.h"
