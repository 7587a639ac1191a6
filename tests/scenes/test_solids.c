/* SPDX-License-Identifier: MIT
 *
 * Solids: hits and shadows computed by hand, and the exact shadow interval against brute force.
 */
#include "tests/scene_builders.h"

#include "scenes/solids.h"

static struct neph_hit hit_one(struct neph_solid solid, struct neph_vec3 origin,
                               struct neph_vec3 direction)
{
    struct neph_scene scene = {.solid_count = 1, .solids = &solid};
    return neph_scene_hit(&scene, origin, direction);
}

static void assert_hit(struct neph_hit hit, double t_m, double nx, double ny, double nz)
{
    neph_assert_close(hit.t_m, t_m, 1e-14, 1e-14);
    neph_assert_close(hit.normal.x, nx, 0.0, 1e-14);
    neph_assert_close(hit.normal.y, ny, 0.0, 1e-14);
    neph_assert_close(hit.normal.z, nz, 0.0, 1e-14);
}

static void test_hits_by_hand(void **state)
{
    const struct neph_solid unit_box = make_box(-1, -1, -1, 1, 1, 1),
                            ball = make_sphere(0, 0, 0, 2);
    assert_hit(hit_one(unit_box, (struct neph_vec3){-5, 0.3, 0.2}, (struct neph_vec3){1, 0, 0}),
               4.0, -1, 0, 0);
    assert_hit(hit_one(unit_box, (struct neph_vec3){0.2, 5, 0.2}, (struct neph_vec3){0, -1, 0}),
               4.0, 0, 1, 0);
    assert_hit(hit_one(ball, (struct neph_vec3){0, 0, 7}, (struct neph_vec3){0, 0, -1}), 5.0, 0, 0,
               1);
    assert_hit(hit_one(ball, (struct neph_vec3){-7, 1.2, 0}, (struct neph_vec3){1, 0, 0}), 5.4,
               -0.8, 0.6, 0);
    /* From inside: the far side. */
    assert_hit(hit_one(unit_box, (struct neph_vec3){0, 0, 0}, (struct neph_vec3){0, 0, 1}), 1.0, 0,
               0, 1);
    assert_hit(hit_one(ball, (struct neph_vec3){0, 1, 0}, (struct neph_vec3){0, 1, 0}), 1.0, 0, 1,
               0);
    /* Beside, behind, and along the plane of a face. */
    assert_true(
        isinf(hit_one(unit_box, (struct neph_vec3){-5, 1.1, 0}, (struct neph_vec3){1, 0, 0}).t_m));
    assert_true(
        isinf(hit_one(unit_box, (struct neph_vec3){5, 0, 0}, (struct neph_vec3){1, 0, 0}).t_m));
    assert_true(isinf(hit_one(ball, (struct neph_vec3){0, 0, 7}, (struct neph_vec3){0, 0, 1}).t_m));
    assert_null(hit_one(ball, (struct neph_vec3){0, 3, 7}, (struct neph_vec3){0, 0, -1}).solid);
}

static void test_the_nearest_solid_is_hit(void **state)
{
    struct neph_solid solids[] = {make_box(8, -1, -1, 9, 1, 1), make_sphere(4, 0, 0, 1),
                                  make_box(6, -1, -1, 7, 1, 1)};
    const struct neph_scene scene = {.solid_count = 3, .solids = solids};
    const struct neph_hit hit = neph_scene_hit(&scene, (struct neph_vec3){0, 0, 0},
                                               (struct neph_vec3){1, 0, 0});
    assert_hit(hit, 3.0, -1, 0, 0);
    assert_ptr_equal(hit.solid, &solids[1]);
}

/* From 1000 km the hit is accurate to the rounding of the distance. */
static void test_hit_from_far_away(void **state)
{
    const double down = -0.8, across = 0.6;
    const struct neph_hit ground = hit_one(make_box(-1e7, -1, -1e7, 1e7, 0, 1e7),
                                           (struct neph_vec3){0, 1e6, 0},
                                           (struct neph_vec3){across, down, 0});
    neph_assert_close(ground.t_m, 1.25e6, 4e-16, 0.0);
    assert_true(ground.normal.y == 1.0);
    const struct neph_hit ball = hit_one(make_sphere(0, 0, 0, 1), (struct neph_vec3){0.6, 1e6, 0},
                                         (struct neph_vec3){0, -1, 0});
    neph_assert_close(ball.t_m, 1e6 - 0.8, 0.0, 1e-9);
    neph_assert_close(ball.normal.x, 0.6, 0.0, 1e-9);
}

static void assert_shadow(struct neph_solid solid, struct neph_vec3 sun, struct neph_vec3 origin,
                          struct neph_vec3 direction, double low_m, double high_m)
{
    double t0_m = NAN, t1_m = NAN;
    const bool any = neph_solid_shadow(&solid, sun, origin, direction, 0.0, 100.0, &t0_m, &t1_m);
    assert_true(any == (low_m < high_m));
    if (!any)
        return;
    neph_assert_close(t0_m, low_m, 1e-14, 1e-14);
    neph_assert_close(t1_m, high_m, 1e-14, 1e-14);
}

static void test_shadows_by_hand(void **state)
{
    const struct neph_vec3 origin = {0, 0, 0}, x = {1, 0, 0}, up = {0, 1, 0}, left = {-1, 0, 0};
    const struct neph_vec3 slanted = {0.6, 0.8, 0}; /* 3 m sideways for 4 m up */
    const struct neph_solid roof = make_box(5, 4, -1, 7, 8, 1), ball = make_sphere(6, 10, 0.6, 1);

    assert_shadow(roof, up, origin, x, 5, 7);
    assert_shadow(ball, up, origin, x, 5.2, 6.8); /* half chord sqrt(1 - 0.36) */
    /* Slanted: the lower left edge casts its shadow 3 m to the left from 4 m up, the upper left one
     * 6 m from 8 m up; the right end is the lower right edge's. */
    assert_shadow(roof, slanted, origin, x, 0, 7 - 3);
    assert_shadow(roof, slanted, (struct neph_vec3){-4, 0, 0}, x, -1 + 4, 4 + 4);
    assert_shadow(ball, slanted, (struct neph_vec3){1, 0, 0}, x, 1, 0); /* behind the origin */
    assert_shadow(ball, slanted, (struct neph_vec3){-9, 0, 0.6}, x, 7.5 - 1.25, 7.5 + 1.25);
    /* The sun below, the ray above the solid, beside it, the solid on the far side of the sun. */
    assert_shadow(roof, (struct neph_vec3){0, -1, 0}, origin, x, 1, 0);
    assert_shadow(roof, up, (struct neph_vec3){0, 9, 0}, x, 1, 0);
    assert_shadow(roof, up, (struct neph_vec3){0, 0, 2}, x, 1, 0);
    /* A sun along the ray: all points in front of the solid, or all behind it. */
    assert_shadow(roof, x, (struct neph_vec3){0, 5, 0}, x, 0, 7);
    assert_shadow(roof, left, (struct neph_vec3){0, 5, 0}, x, 5, 100);
    assert_shadow(make_sphere(6, 0, 0.6, 1), x, origin, x, 0, 6.8);
    assert_shadow(make_sphere(6, 0, 0.6, 1), left, origin, x, 5.2, 100);
    /* Along the sun but beside the solid. */
    assert_shadow(roof, up, origin, up, 1, 0);
    assert_shadow(ball, up, origin, up, 1, 0);
}

/* ---- brute force: is there a point of the solid on the sun's side? ---- */

/* An independent solution, by the quadratic and by the slabs, in long double. */
static bool hides(const struct neph_solid *solid, struct neph_vec3 p, struct neph_vec3 s)
{
    if (solid->kind == NEPH_SOLID_SPHERE) {
        const long double x = (long double)p.x - solid->center_m.x;
        const long double y = (long double)p.y - solid->center_m.y;
        const long double z = (long double)p.z - solid->center_m.z;
        const long double a = (long double)s.x * s.x + (long double)s.y * s.y +
                              (long double)s.z * s.z;
        const long double half_b = x * s.x + y * s.y + z * s.z;
        const long double c = x * x + y * y + z * z -
                              (long double)solid->radius_m * solid->radius_m;
        const long double discriminant = half_b * half_b - a * c;
        return discriminant > 0.0L && (-half_b + sqrtl(discriminant)) / a > 0.0L;
    }
    const double low[3] = {solid->box.min_m.x, solid->box.min_m.y, solid->box.min_m.z};
    const double high[3] = {solid->box.max_m.x, solid->box.max_m.y, solid->box.max_m.z};
    const double from[3] = {p.x, p.y, p.z}, sun[3] = {s.x, s.y, s.z};
    long double t0 = 0.0L, t1 = HUGE_VALL;
    for (int axis = 0; axis < 3; axis++) {
        if (sun[axis] == 0.0) {
            if (from[axis] <= low[axis] || from[axis] >= high[axis])
                return false;
            continue;
        }
        const long double a = ((long double)low[axis] - from[axis]) / sun[axis];
        const long double b = ((long double)high[axis] - from[axis]) / sun[axis];
        t0 = fmaxl(t0, fminl(a, b));
        t1 = fminl(t1, fmaxl(a, b));
    }
    return t0 < t1;
}

static struct neph_vec3 random_sight(uint64_t *seed)
{
    static const struct neph_vec3 axes[6] = {{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                             {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};
    const double kind = neph_test_uniform(seed, 0, 1);
    if (kind < 0.2) /* along an axis */
        return axes[neph_test_random(seed) % 6];
    const double y = neph_test_uniform(seed, -1, 1), across = sqrt(1.0 - y * y);
    const double azimuth = neph_test_uniform(seed, 0, 2.0 * M_PI);
    struct neph_vec3 d = {across * cos(azimuth), y, across * sin(azimuth)};
    if (kind < 0.3) /* in a coordinate plane */
        d = neph_vec3_normalize((struct neph_vec3){d.x, 0.0, d.z});
    else if (kind < 0.4) /* the pi/2 of a user's degrees: almost along an axis */
        d = (struct neph_vec3){cos(M_PI / 2.0), 1.0, 0.0};
    return d;
}

static struct neph_solid random_solid(uint64_t *seed)
{
    const struct neph_vec3 p = random_point(seed, 4.0);
    if (neph_test_uniform(seed, 0, 1) < 0.5)
        return make_sphere(p.x, p.y, p.z, neph_test_uniform(seed, 0.05, 3.0));
    return make_box(p.x, p.y, p.z, p.x + neph_test_uniform(seed, 0.02, 4.0),
                    p.y + neph_test_uniform(seed, 0.02, 4.0),
                    p.z + neph_test_uniform(seed, 0.02, 4.0));
}

struct ray {
    struct neph_vec3 origin_m, direction;
};

/* A ray through the neighbourhood of the shadow; exactly or almost parallel or opposite to the sun
 * in a third of the trials. */
static struct ray random_view(uint64_t *seed, const struct neph_solid *solid, struct neph_vec3 sun)
{
    const double kind = neph_test_uniform(seed, 0, 1);
    struct neph_vec3 d = random_sight(seed);
    if (kind < 0.1)
        d = sun;
    else if (kind < 0.2)
        d = neph_vec3_scale(sun, -1.0);
    else if (kind < 0.3)
        d = neph_vec3_normalize(
            neph_vec3_along(sun, d, pow(10.0, neph_test_uniform(seed, -14, -2))));
    const struct neph_vec3 middle =
        solid->kind == NEPH_SOLID_SPHERE
            ? solid->center_m
            : neph_vec3_scale(neph_vec3_add(solid->box.min_m, solid->box.max_m), 0.5);
    const struct neph_vec3 shaded = neph_vec3_along(middle, sun, -neph_test_uniform(seed, -2, 12));
    const struct neph_vec3 target = neph_vec3_add(shaded, random_point(seed, 1.0));
    return (struct ray){neph_vec3_along(target, d, -neph_test_uniform(seed, 0, 15)), d};
}

/* Inside the interval the sun is hidden, outside it is not: 40 random distances per pair, except
 * within 1e-7 m of an end, or of grazing along it. */
static void test_shadow_interval_against_brute_force(void **state)
{
    const uint64_t first_seed = 31415;
    long hidden = 0, tested = 0;
    for (uint64_t trial = 0; trial < 30000; trial++) {
        uint64_t seed = first_seed + trial;
        const struct neph_solid solid = random_solid(&seed);
        const struct neph_vec3 sun = random_sight(&seed);
        const struct ray view = random_view(&seed, &solid, sun);
        const struct neph_vec3 origin = view.origin_m, d = view.direction;
        double low_m = INFINITY, high_m = -INFINITY;
        if (neph_solid_shadow(&solid, sun, origin, d, 0.0, 20.0, &low_m, &high_m))
            assert_true(0.0 <= low_m && low_m < high_m && high_m <= 20.0);
        struct neph_solid scene_solid = solid;
        const struct neph_scene scene = {
            .solid_count = 1, .solids = &scene_solid, .sun = {.present = true, .direction = sun}};
        for (int i = 0; i < 40; i++) {
            const double t_m = neph_test_uniform(&seed, 0.0, 20.0);
            if (fabs(t_m - low_m) < 1e-7 || fabs(t_m - high_m) < 1e-7)
                continue;
            const struct neph_vec3 p = neph_vec3_along(origin, d, t_m);
            const bool expected = hides(&solid, p, sun);
            const bool interval = t_m > low_m && t_m < high_m;
            if (interval != expected || neph_scene_sees_sun(&scene, p) == expected)
                print_error("seed %llu, t %.17g, shadow [%.17g, %.17g], hidden %d\n",
                            (unsigned long long)(first_seed + trial), t_m, low_m, high_m, expected);
            assert_true(interval == expected);
            assert_true(neph_scene_sees_sun(&scene, p) == !expected);
            hidden += expected;
            tested++;
        }
    }
    print_message("%ld points, %.0f %% hidden\n", tested, 100.0 * (double)hidden / (double)tested);
    assert_true(hidden > tested / 10);
}

/* A ray at a rotated box equals the inversely rotated ray at the box, in all results. */
static void test_a_turned_box_is_a_turned_world(void **state)
{
    uint64_t seed = 2718;
    long met = 0;
    for (int trial = 0; trial < neph_test_paths(20000); trial++) {
        struct neph_solid box = random_solid(&seed);
        if (box.kind != NEPH_SOLID_BOX)
            continue;
        const double angle_rad = neph_test_uniform(&seed, -4.0, 4.0);
        const struct neph_turn turn = {trial % 3, cos(angle_rad), sin(angle_rad)};
        const struct neph_vec3 sun = random_sight(&seed);
        const struct ray view = random_view(&seed, &box, sun);
        const struct neph_vec3 middle_m = neph_vec3_scale(
            neph_vec3_add(box.box.min_m, box.box.max_m), 0.5);
        const struct ray turned = {
            neph_vec3_add(middle_m, neph_turned(&turn, neph_vec3_sub(view.origin_m, middle_m))),
            neph_turned(&turn, view.direction)};
        struct neph_scene scene = {.solid_count = 1, .solids = &box};
        const struct neph_hit plain = neph_scene_hit(&scene, view.origin_m, view.direction);
        double a0_m, a1_m, b0_m, b1_m;
        const bool shades = neph_solid_shadow(&box, sun, view.origin_m, view.direction, 0.0, 20.0,
                                              &a0_m, &a1_m);
        box.turn = turn;
        const struct neph_hit hit = neph_scene_hit(&scene, turned.origin_m, turned.direction);
        const bool shades_too = neph_solid_shadow(&box, neph_turned(&turn, sun), turned.origin_m,
                                                  turned.direction, 0.0, 20.0, &b0_m, &b1_m);
        if (!plain.solid || !hit.solid || !shades || !shades_too) /* or one that grazes an edge */
            continue;
        met++;
        neph_assert_close(hit.t_m, plain.t_m, 1e-9, 1e-9);
        neph_assert_close(b0_m, a0_m, 1e-6, 1e-6);
        neph_assert_close(b1_m, a1_m, 1e-6, 1e-6);
        const struct neph_vec3 normal = neph_turned_back(&turn, hit.normal);
        neph_assert_close(neph_vec3_dot(normal, plain.normal), 1.0, 1e-12, 0.0);
        const struct neph_vec3 point_m = neph_vec3_along(turned.origin_m, turned.direction,
                                                         hit.t_m);
        const struct neph_bounds around = neph_solid_bounds(&box);
        assert_true(point_m.x >= around.min_m.x - 1e-9 && point_m.x <= around.max_m.x + 1e-9);
        assert_true(point_m.y >= around.min_m.y - 1e-9 && point_m.y <= around.max_m.y + 1e-9);
        assert_true(point_m.z >= around.min_m.z - 1e-9 && point_m.z <= around.max_m.z + 1e-9);
    }
    print_message("%ld rays\n", met);
    assert_true(met > neph_test_paths(20000) / 20);
}

/* By hand: a cube of 2 m with an edge towards the eye. */
static void test_a_cube_shows_its_edge(void **state)
{
    struct neph_solid cube = make_box(-1, -1, -1, 1, 1, 1);
    cube.turn = (struct neph_turn){1, sqrt(0.5), sqrt(0.5)};
    const struct neph_scene scene = {.solid_count = 1, .solids = &cube};
    const struct neph_vec3 ahead = {0, 0, -1};
    const struct neph_hit edge = neph_scene_hit(&scene, (struct neph_vec3){0, 0, 5}, ahead);
    const struct neph_hit face = neph_scene_hit(&scene, (struct neph_vec3){0.5, 0, 5}, ahead);
    neph_assert_close(edge.t_m, 5.0 - sqrt(2.0), 1e-15, 0.0);
    neph_assert_close(face.t_m, 5.5 - sqrt(2.0), 1e-15, 0.0);
    neph_assert_close(face.normal.x, sqrt(0.5), 1e-15, 0.0);
    neph_assert_close(face.normal.z, sqrt(0.5), 1e-15, 0.0);
    assert_true(neph_solid_contains(&cube, (struct neph_vec3){1.4, 0, 0}));
    assert_false(neph_solid_contains(&cube, (struct neph_vec3){0.9, 0, 0.9}));
    const struct neph_bounds around = neph_solid_bounds(&cube);
    neph_assert_close(around.max_m.x, sqrt(2.0), 1e-15, 0.0);
    neph_assert_close(around.max_m.y, 1.0, 1e-15, 0.0);
}

/* The requested range only cuts: the result inside does not depend on the outside. */
static void test_shadow_range_only_cuts(void **state)
{
    const uint64_t first_seed = 2718;
    for (uint64_t trial = 0; trial < 5000; trial++) {
        uint64_t seed = first_seed + trial;
        const struct neph_solid solid = random_solid(&seed);
        const struct neph_vec3 sun = random_sight(&seed);
        const struct ray view = random_view(&seed, &solid, sun);
        const struct neph_vec3 origin = view.origin_m, d = view.direction;
        const double t0_m = neph_test_uniform(&seed, 0, 10);
        const double t1_m = t0_m + neph_test_uniform(&seed, 0.1, 10);
        double whole0_m = 0, whole1_m = 0, part0_m = 0, part1_m = 0;
        const bool whole = neph_solid_shadow(&solid, sun, origin, d, 0.0, INFINITY, &whole0_m,
                                             &whole1_m);
        const bool part = neph_solid_shadow(&solid, sun, origin, d, t0_m, t1_m, &part0_m, &part1_m);
        const double low_m = fmax(t0_m, whole0_m), high_m = fmin(t1_m, whole1_m);
        if (part != (whole && low_m < high_m))
            print_error("seed %llu\n", (unsigned long long)(first_seed + trial));
        assert_true(part == (whole && low_m < high_m));
        if (part) {
            neph_assert_close(part0_m, low_m, 1e-12, 1e-12);
            neph_assert_close(part1_m, high_m, 1e-12, 1e-12);
        }
    }
}

/* A point on a face towards the sun is lit: the solid does not shade itself. */
static void test_a_lit_face_sees_the_sun(void **state)
{
    struct neph_solid solid = make_box(-1, -1, -1, 1, 1, 1);
    const struct neph_scene scene = {
        .solid_count = 1, .solids = &solid, .sun = {.present = true, .direction = {0.6, 0.8, 0.0}}};
    assert_true(neph_scene_sees_sun(&scene, (struct neph_vec3){0.3, 1.0, 0.2}));
    assert_true(neph_scene_sees_sun(&scene, (struct neph_vec3){1.0, 0.1, 0.2}));
    assert_false(neph_scene_sees_sun(&scene, (struct neph_vec3){-1.0, 0.1, 0.2}));
    assert_false(neph_scene_sees_sun(&scene, (struct neph_vec3){0.3, -1.0, 0.2}));
}

/* Neither does the sphere of a planet, whose points are rounded to 1e-9 m, under a sun of 0.1
 * degrees. */
static void test_a_planet_does_not_shade_its_day(void **state)
{
    const double radius_m = 6.371e6;
    struct neph_solid ball = {
        .kind = NEPH_SOLID_SPHERE, .center_m = {0, -radius_m, 0}, .radius_m = radius_m};
    struct neph_scene scene = {.solid_count = 1, .solids = &ball, .sun = {.present = true}};
    uint64_t random = 27182;
    for (int i = 0; i < 2000; i++) {
        const double sine = i % 2 ? 2e-3 : 0.5;
        scene.sun.direction = (struct neph_vec3){sqrt(1.0 - sine * sine), sine, 0.0};
        const struct neph_vec3 eye_m = {neph_test_uniform(&random, -9.0, 9.0), 1.6, 0.0};
        const struct neph_vec3 ray = neph_vec3_normalize(
            (struct neph_vec3){neph_test_uniform(&random, -1, 1), -0.5, -1.0});
        const struct neph_hit hit = neph_scene_hit(&scene, eye_m, ray);
        /* The plane below the eye, minus the ball's drop there: d^2 / 2 R. */
        neph_assert_close(hit.t_m, 1.6 / -ray.y, 1e-5, 0.0);
        const struct neph_vec3 point_m = neph_hit_outside_m(&hit,
                                                            neph_vec3_along(eye_m, ray, hit.t_m));
        assert_true(neph_scene_sees_sun(&scene, point_m));
        const struct neph_vec3 up = {0.3, 0.1, 0.9};
        assert_null(neph_scene_hit(&scene, point_m, neph_vec3_normalize(up)).solid);
    }
}

#include "tests/main.h"
