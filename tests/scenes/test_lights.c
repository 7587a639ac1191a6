/* SPDX-License-Identifier: MIT
 *
 * Lights: their cones by hand, and the exact shadow of a solid in front of a point against brute
 * force.
 */
#include "tests/scene_builders.h"

#include "scenes/bounds.h"
#include "scenes/lights.h"
#include "scenes/solids.h"

static struct neph_vec3 at_angle(double degrees)
{
    const double rad = degrees * NEPH_RAD_PER_DEG;
    return (struct neph_vec3){sin(rad), cos(rad), 0.0};
}

static void test_a_cone_by_hand(void **state)
{
    const struct neph_light spot = {.intensity_w_per_sr = {8, 4, 2},
                                    .is_spot = true,
                                    .axis = {0, 1, 0},
                                    .inner_cosine = 0.8,
                                    .outer_cosine = 0.6};
    assert_true(neph_light_falloff(&spot, at_angle(0.0)) == 1.0);
    assert_true(neph_light_falloff(&spot, at_angle(36.8)) == 1.0); /* acos 0.8 is 36.87 */
    assert_true(neph_light_falloff(&spot, at_angle(53.2)) == 0.0); /* acos 0.6 is 53.13 */
    assert_true(neph_light_falloff(&spot, at_angle(180.0)) == 0.0);
    neph_assert_close(neph_light_falloff(&spot, at_angle(acos(0.7) / NEPH_RAD_PER_DEG)), 0.5, 1e-13,
                      0.0);
    neph_assert_close(neph_light_falloff(&spot, at_angle(acos(0.65) / NEPH_RAD_PER_DEG)), 0.15625,
                      1e-13, 0.0);
    const struct neph_lit lit = neph_light_at(&spot, (struct neph_vec3){0, 2, 0});
    neph_assert_close(lit.irradiance_w_per_m2.r, 2.0, 1e-15, 0.0);
    neph_assert_close(lit.irradiance_w_per_m2.b, 0.5, 1e-15, 0.0);
    assert_true(lit.direction.y == -1.0 && lit.distance_m == 2.0);
    assert_true(neph_light_at(&spot, (struct neph_vec3){0, 0, 0}).irradiance_w_per_m2.r == 0.0);
}

static struct neph_solid random_solid(uint64_t *seed)
{
    const struct neph_vec3 c = random_point(seed, 2.0);
    const struct neph_vec3 half = {neph_test_uniform(seed, 0.05, 1.0),
                                   neph_test_uniform(seed, 0.05, 1.0),
                                   neph_test_uniform(seed, 0.05, 1.0)};
    if (neph_test_uniform(seed, 0.0, 1.0) < 0.4)
        return make_sphere(c.x, c.y, c.z, half.x);
    struct neph_solid box = make_box(c.x - half.x, c.y - half.y, c.z - half.z, c.x + half.x,
                                     c.y + half.y, c.z + half.z);
    const double turn_rad = neph_test_uniform(seed, -3.0, 3.0);
    if (turn_rad > 0.0)
        box.turn = (struct neph_turn){(int)(3.0 * neph_test_uniform(seed, 0.0, 0.999)),
                                      cos(turn_rad), sin(turn_rad)};
    return box;
}

/* Includes rays along an axis and lights in the plane of a face. */
static void test_shadows_against_brute_force(void **state)
{
    uint64_t seed = 20;
    int hidden_points = 0, rays = 0;
    for (int i = 0; i < 4000; i++) {
        struct neph_solid solid = random_solid(&seed);
        const struct neph_scene scene = {.solid_count = 1, .solids = &solid};
        struct neph_vec3 light_m = random_point(&seed, 3.0), origin_m = random_point(&seed, 4.0);
        struct neph_vec3 direction = random_direction(&seed);
        if (i % 7 == 0)
            direction = (struct neph_vec3){i % 2 ? 1 : -1, 0, 0};
        if (i % 5 == 0 && solid.kind == NEPH_SOLID_BOX)
            light_m.y = solid.box.min_m.y;
        if (neph_solid_contains(&solid, light_m))
            continue;
        double low_m = 0.0, high_m = 0.0;
        const bool any = neph_solid_point_shadow(&solid, light_m, origin_m, direction, 0.0, 9.0,
                                                 &low_m, &high_m);
        rays += any;
        assert_true(!any || (low_m >= 0.0 && low_m < high_m && high_m <= 9.0));
        for (int p = 0; p < 60; p++) {
            const double t_m = 9.0 * (p + 0.5) / 60;
            const bool hidden = !neph_scene_sees(&scene, neph_vec3_along(origin_m, direction, t_m),
                                                 light_m);
            const bool inside = any && t_m > low_m && t_m < high_m;
            const bool at_edge = any && fmin(fabs(t_m - low_m), fabs(t_m - high_m)) < 1e-7;
            hidden_points += hidden;
            if (hidden != inside && !at_edge) {
                print_error("solid %d: t %g is %s, shadow %g..%g\n", i, t_m,
                            hidden ? "hidden" : "lit", low_m, high_m);
                fail();
            }
        }
    }
    assert_true(rays > 400 && hidden_points > 5000);
}

#include "tests/main.h"
