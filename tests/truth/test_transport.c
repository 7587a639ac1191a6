/* SPDX-License-Identifier: MIT
 *
 * Light along one ray against 50-digit references, shadows by hand, brute force, and scenes with a
 * result that needs no integral.
 */
#include "tests/scene_builders.h"

#include "scenes/media.h"
#include "scenes/solids.h"
#include "tests/scenes/reference_values.h"
#include "truth/transport.h"

static const double unit_roundoff = 0x1p-53;

/* ---- closed forms ---- */

/* Below the range of a double. */
static const double invisible_per_sr = 1e-290;

/* Slabs from above and below (with mu = mu0), height fog at all heights (up, level, down, from 1e6
 * m), boxes, fog in boxes, two layers, two media, thin fogs 1e6 m away; three phase functions;
 * optical depths 1e-10 .. 1e3. 1e-12, or four roundings of the coordinates. */
static void test_single_scattering_against_reference(void **state)
{
    double worst = 0.0;
    int failures = 0;
    for (size_t i = 0; i < COUNT(reference_view); i++) {
        const struct reference_view *r = &reference_view[i];
        struct neph_scene scene = make_sunny(reference_medium[r->media[0]], r->sun);
        scene.medium_count = r->medium_count;
        scene.media[1] = reference_medium[r->media[1]];
        const struct neph_ray_light light = neph_transport_ray(&scene, r->origin_m, r->direction);
        const double relative = fmax(1e-12, 4.0 * unit_roundoff * r->condition);
        const double error = fabs(light.volume.r - r->radiance);
        if (r->radiance > 1e-12 && relative < 2e-12)
            worst = fmax(worst, error / r->radiance);
        if (!(error <= relative * r->radiance + invisible_per_sr)) {
            print_error("%s: %.17g, expected %.17g, relative error %.2g, allowed %.2g\n", r->name,
                        light.volume.r, r->radiance, error / r->radiance, relative);
            failures++;
        }
        /* The estimate is valid, up to the rounding that `relative` allows. */
        if (!(error <= light.quadrature_error + relative * r->radiance + invisible_per_sr))
            failures++;
    }
    print_message("worst relative error, single scattering (%zu views): %.2g\n",
                  COUNT(reference_view), worst);
    assert_int_equal(failures, 0);
}

/* ---- towards the sun ------ */

/* The sun straight ahead: from every point of the ray the optical path is the same, through the
 * whole medium, of any shape, so that L = E p tau e^-tau. The phase function is isotropic. 1e-12,
 * or four roundings of the exponent. */
static void test_the_sun_behind_an_opaque_medium(void **state)
{
    const struct neph_vec3 ahead = {0, 0, -1};
    const struct neph_vec3 steep = neph_vec3_normalize((struct neph_vec3){0.2, 0.5, -1});
    struct neph_medium fog_in_box = make_height_fog(30.0, 0.25);
    fog_in_box.bounds = (struct neph_bounds){{-20, -20, -1}, {20, 20, 1}};
    const struct {
        struct neph_medium medium;
        struct neph_vec3 view;
    } cases[] = {
        {make_homogeneous(50.0, (struct neph_bounds){{-20, -20, -1}, {20, 20, 1}}), ahead},
        {make_homogeneous(300.0, (struct neph_bounds){{-20, -20, -1}, {20, 20, 1}}), ahead},
        {fog_in_box, ahead},
        {fog_in_box, steep},
        {make_blob(20.0, (struct neph_vec3){0}, 2.0), ahead},
        {make_blob(80.0, (struct neph_vec3){0}, 2.0), steep},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct neph_scene scene = make_sunny(cases[i].medium, cases[i].view);
        const struct neph_vec3 eye_m = neph_vec3_along((struct neph_vec3){0.3, 0.1, 0},
                                                       cases[i].view, -40.0);
        const double depth =
            neph_scene_optical_depth(&scene, eye_m, cases[i].view, 0.0, INFINITY).r;
        const struct neph_ray_light light = neph_transport_ray(&scene, eye_m, cases[i].view);
        assert_true(depth > 50.0);
        neph_assert_close(light.volume.r, depth * exp(-depth) / (4.0 * M_PI),
                          1e-12 + 4.0 * unit_roundoff * depth, 0.0);
    }
}

/* A slab of optical depth 100 and a slanted sun behind it: L = E p tau e^(-tau / mu0) phi(tau (1 -
 * 1 / mu0)). */
static void test_a_slanting_sun_behind_a_slab(void **state)
{
    const double cosine = 0.8, depth = 100.0, far_m = 1e5;
    const struct neph_scene scene = make_sunny(
        make_homogeneous(50.0, (struct neph_bounds){{-far_m, -far_m, -1}, {far_m, far_m, 1}}),
        (struct neph_vec3){0.6, 0, -cosine});
    const struct neph_ray_light light = neph_transport_ray(&scene, (struct neph_vec3){0.3, 0.1, 40},
                                                           (struct neph_vec3){0, 0, -1});
    const double phi = expm1(depth / cosine - depth) / (depth / cosine - depth);
    neph_assert_close(light.volume.r, depth * exp(-depth / cosine) * phi / (4.0 * M_PI),
                      1e-12 + 4.0 * unit_roundoff * depth, 0.0);
}

/* The first 60 optical depths are in the shadow of a plate. */
static void test_light_behind_an_opaque_shadow(void **state)
{
    const double extinction_per_m = 10.0;
    struct neph_scene scene = make_sunny(
        make_homogeneous(extinction_per_m, (struct neph_bounds){{-50, -50, -10}, {50, 1, 0}}),
        (struct neph_vec3){0, 1, 0});
    struct neph_solid plate = make_box(-60, 2, -6, 60, 3, 100);
    scene.solid_count = 1;
    scene.solids = &plate;
    const struct neph_ray_light light = neph_transport_ray(&scene, (struct neph_vec3){0, 0.5, 20},
                                                           (struct neph_vec3){0, 0, -1});
    neph_assert_close(light.volume.r,
                      exp(-0.5 * extinction_per_m) * (exp(-60.0) - exp(-100.0)) / (4.0 * M_PI),
                      1e-12 + 4.0 * unit_roundoff * 100.0, 0.0);
}

/* ---- shadows computed by hand -- */

/* Integral of sigma e^{-sigma t} over [low, high]: the light of a uniformly lit segment. */
static double stretch(double extinction_per_m, double low_m, double high_m)
{
    return exp(-extinction_per_m * low_m) - exp(-extinction_per_m * high_m);
}

static const struct neph_bounds layer_10m = {{-INFINITY, 0, -INFINITY}, {INFINITY, 10, INFINITY}};

/* The view is along x at height 4 in a layer of 10 m, the sun `slant` to the side per metre up;
 * light crosses 6 m of height to reach a point. */
static void assert_one_shadow(struct neph_solid solid, double slant, double low_m, double high_m)
{
    const double sigma = 0.07, secant = sqrt(1.0 + slant * slant);
    const struct neph_vec3 sun = {slant / secant, 1.0 / secant, 0.0};
    struct neph_scene scene = make_sunny(make_homogeneous(sigma, layer_10m), sun);
    scene.solid_count = 1;
    scene.solids = &solid;
    const struct neph_ray_light light = neph_transport_ray(&scene, (struct neph_vec3){0, 4, 0},
                                                           (struct neph_vec3){1, 0, 0});
    const double lit = stretch(sigma, 0.0, low_m) + stretch(sigma, high_m, INFINITY);
    neph_assert_close(light.volume.r, exp(-sigma * 6.0 * secant) / (4.0 * M_PI) * lit, 1e-13, 0.0);
}

static void test_shadow_of_one_solid(void **state)
{
    /* Above the layer, from 20 to 24 m: 16 and 20 m above the ray. */
    assert_one_shadow(make_box(30, 20, -1, 33, 24, 1), 0.0, 30, 33);
    assert_one_shadow(make_box(30, 20, -1, 33, 24, 1), 0.75, 30 - 15, 33 - 12);
    assert_one_shadow(make_box(30, 20, -1, 33, 24, 1), -0.75, 30 + 12, 33 + 15);
    assert_one_shadow(make_box(30, 20, 1, 33, 24, 2), 0.0, 30, 30); /* beside it: nothing */
    struct neph_solid ball = {.kind = NEPH_SOLID_SPHERE, .center_m = {30, 20, 0.6}, .radius_m = 1};
    assert_one_shadow(ball, 0.0, 30 - 0.8, 30 + 0.8);
    /* An obliquely cut cylinder: longer by the secant of the sun, 1.25. */
    assert_one_shadow(ball, 0.75, 30 - 12 - 1.0, 30 - 12 + 1.0);
}

/* Two overlapping shadows count once; a solid that the ray hits ends it. */
static void test_shadows_overlap_and_rays_end(void **state)
{
    const double sigma = 0.07;
    struct neph_solid solids[] = {make_box(10, 20, -1, 14, 24, 1), make_box(12, 15, -1, 17, 16, 1),
                                  make_box(11, 30, -1, 13, 31, 1), make_box(40, 0, -9, 50, 5, 9)};
    struct neph_scene scene = make_sunny(make_homogeneous(sigma, layer_10m),
                                         (struct neph_vec3){0.0, 1.0, 0.0});
    scene.solid_count = 4;
    scene.solids = solids;
    const struct neph_ray_light light = neph_transport_ray(&scene, (struct neph_vec3){0, 4, 0},
                                                           (struct neph_vec3){1, 0, 0});
    neph_assert_close(light.volume.r,
                      exp(-sigma * 6.0) / (4.0 * M_PI) *
                          (stretch(sigma, 0, 10) + stretch(sigma, 17, 40)),
                      1e-13, 0.0);
    neph_assert_close(light.transmittance.r, exp(-40.0 * sigma), 1e-14, 0.0);
    assert_true(light.hit_m == 40.0);
}

/* Height fog, sun overhead, a roof above part of a level ray: density is constant along it. */
static void test_shadow_in_height_fog(void **state)
{
    struct neph_solid roof = make_box(30, 20, -1, 33, 24, 1);
    struct neph_scene scene = make_sunny(make_height_fog(0.02, 0.05),
                                         (struct neph_vec3){0.0, 1.0, 0.0});
    scene.solid_count = 1;
    scene.solids = &roof;
    const struct neph_ray_light light = neph_transport_ray(&scene, (struct neph_vec3){0, 4, 0},
                                                           (struct neph_vec3){1, 0, 0});
    const double sigma = 0.02 * exp(-0.05 * 4.0);
    neph_assert_close(light.volume.r,
                      exp(-sigma / 0.05) / (4.0 * M_PI) *
                          (stretch(sigma, 0, 30) + stretch(sigma, 33, INFINITY)),
                      1e-13, 0.0);
}

/* ---- brute force ---- */

enum { BRUTE_STEPS = 200000 };

/* The midpoint rule on the definition, with the textbook density, and visibility tested at each
 * point. Returns the radiance and a bound of the rule's error: half a step's worst change at each
 * edge of light, and h^2/24 times the integral of |f''|, from second differences. */
static double brute_force(const struct neph_scene *scene, struct neph_vec3 origin,
                          struct neph_vec3 direction, double end_m, double *error)
{
    const double step_m = end_m / BRUTE_STEPS;
    const double cosine = neph_vec3_dot(direction, scene->sun.direction);
    double sum = 0.0, curvature = 0.0, jumps = 0.0, before = 0.0, before2 = 0.0;
    for (int i = 0; i < BRUTE_STEPS; i++) {
        const double t_m = (i + 0.5) * step_m;
        const struct neph_vec3 p = neph_vec3_along(origin, direction, t_m);
        double scattered = 0.0;
        if (neph_scene_sees_sun(scene, p)) {
            for (int m = 0; m < scene->medium_count; m++)
                scattered += scene->media[m].albedo.r *
                             neph_phase_per_sr(&scene->media[m].phase, cosine) *
                             neph_medium_extinction_per_m(&scene->media[m], p);
            scattered *= exp(
                -neph_scene_optical_depth(scene, origin, direction, 0.0, t_m).r -
                neph_scene_optical_depth(scene, p, scene->sun.direction, 0.0, INFINITY).r);
        }
        sum += scattered;
        const double second = fabs(scattered - 2.0 * before + before2);
        if (second > 0.01 * fmax(scattered, before2))
            jumps += second;
        else
            curvature += second;
        before2 = before;
        before = scattered;
    }
    *error = step_m * (0.25 * jumps + curvature / 12.0) + 1e-11 * sum * step_m;
    return sum * step_m;
}

enum { BARS = 60 };

/* Bars of 10 cm every half metre, 2 m high, 8 m ahead; two walls end the rays. */
static void build_fence(struct neph_solid *solids)
{
    for (int i = 0; i < BARS; i++) {
        const double x = -15.0 + 0.5 * i;
        solids[i] = make_box(x, 0, -8.05, x + 0.1, 2, -8);
        solids[i].thin = true;
    }
    solids[BARS] = make_box(21, -3, -32, 22, 3, 20);
    solids[BARS + 1] = make_box(-21, -3, -32, 21, 3, -31);
}

struct fence {
    const char *name;
    struct neph_scene scene;
    struct neph_solid solids[BARS + 2];
};

/* The low sun is behind the fence, so that a ray meets up to 60 shadows. */
static void make_fence(struct fence *fence, const char *name, struct neph_medium medium)
{
    fence->name = name;
    fence->scene = make_sunny(medium, neph_vec3_normalize((struct neph_vec3){0.4, 0.35, -0.8}));
    fence->scene.solid_count = BARS + 2;
    fence->scene.solids = fence->solids;
    build_fence(fence->solids);
}

static struct neph_medium two_layers(void)
{
    struct neph_medium fog = make_height_fog(9.609e-3, 0.0139);
    fog.layer_count = 2;
    fog.layers[1] = (struct neph_fog_layer){0.02, 0.4, 0.5};
    return fog;
}

static struct neph_medium fog_in_a_box(void)
{
    struct neph_medium fog = make_height_fog(0.02, 0.2);
    fog.bounds = (struct neph_bounds){{-20, 0, -30}, {20, 6, 20}};
    return fog;
}

static void make_fences(struct fence fences[4])
{
    make_fence(&fences[0], "one height fog", make_height_fog(9.609e-3, 0.0139));
    make_fence(&fences[1], "two layers", two_layers());
    make_fence(&fences[2], "fog in a box", fog_in_a_box());
    make_fence(&fences[3], "homogeneous box",
               make_homogeneous(0.02, (struct neph_bounds){{-20, 0, -30}, {20, 6, 20}}));
}

/* Along the fence just in front of it, across its shadows, and past its end. */
static void test_fence_against_brute_force(void **state)
{
    struct fence *fences = test_malloc(4 * sizeof(*fences));
    make_fences(fences);
    static const struct neph_vec3 origins[] = {{-18, 0.8, -7.5}, {0, 1.7, 0}, {-18, 1.2, -3}};
    static const struct neph_vec3 targets[] = {{20, 1.1, -7}, {9, 0.2, -7}, {15, 0.4, -6}};
    for (int f = 0; f < 4; f++)
        for (size_t i = 0; i < COUNT(origins); i++) {
            if ((f + (int)i) % neph_test_path_step() != 0)
                continue;
            const struct neph_vec3 d = neph_vec3_normalize(neph_vec3_sub(targets[i], origins[i]));
            const struct neph_ray_light light = neph_transport_ray(&fences[f].scene, origins[i], d);
            double allowed;
            const double expected = brute_force(&fences[f].scene, origins[i], d, light.hit_m,
                                                &allowed);
            print_message("%-16s ray %zu: relative difference %8.1e, allowed %7.1e\n",
                          fences[f].name, i, light.volume.r / expected - 1.0, allowed / expected);
            neph_assert_close(light.volume.r, expected, 0.0, allowed);
            /* The bound is small enough to detect one bar of sixty without a shadow. */
            assert_true(allowed < 1e-2 * expected);
        }
    test_free(fences);
}

static struct neph_medium random_medium(uint64_t *seed)
{
    const struct neph_vec3 low = random_point(seed, 6.0);
    const struct neph_vec3 size = {neph_test_uniform(seed, 1, 9), neph_test_uniform(seed, 1, 9),
                                   neph_test_uniform(seed, 1, 9)};
    struct neph_medium medium = make_homogeneous(
        pow(10.0, neph_test_uniform(seed, -3, 0.5)),
        (struct neph_bounds){low, neph_vec3_add(low, size)});
    medium.phase = (struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN, 0.5};
    medium.albedo.r = neph_test_uniform(seed, 0, 1);
    if (neph_test_uniform(seed, 0, 1) < 0.5) {
        medium.kind = NEPH_MEDIUM_HEIGHT_FOG;
        medium.layers[0].falloff_per_m = neph_test_uniform(seed, 0, 1);
    }
    return medium;
}

/* Overlapping media, boxes and spheres, any sun, any ray. */
static void test_random_scenes_against_brute_force(void **state)
{
    const uint64_t first_seed = 161803;
    double worst = 0.0;
    for (uint64_t trial = 0; trial < 60; trial += (uint64_t)neph_test_path_step()) {
        uint64_t seed = first_seed + trial;
        struct neph_solid solids[4];
        for (int i = 0; i < 4; i++) {
            const struct neph_vec3 p = random_point(&seed, 8.0);
            solids[i] = make_box(p.x, p.y, p.z, p.x + neph_test_uniform(&seed, 0.1, 3),
                                 p.y + neph_test_uniform(&seed, 0.1, 3),
                                 p.z + neph_test_uniform(&seed, 0.1, 3));
            if (i % 2)
                solids[i] = (struct neph_solid){.kind = NEPH_SOLID_SPHERE,
                                                .center_m = p,
                                                .radius_m = neph_test_uniform(&seed, 0.1, 3)};
        }
        struct neph_scene scene = make_sunny(random_medium(&seed), random_direction(&seed));
        scene.medium_count = 2;
        scene.media[1] = random_medium(&seed);
        scene.solid_count = 4;
        scene.solids = solids;
        const struct neph_vec3 origin = random_point(&seed, 9.0);
        const struct neph_vec3 d = neph_vec3_normalize(
            neph_vec3_sub(random_point(&seed, 4.0), origin));
        const struct neph_ray_light light = neph_transport_ray(&scene, origin, d);
        double allowed;
        const double expected = brute_force(&scene, origin, d, fmin(light.hit_m, 60.0), &allowed);
        if (!(fabs(light.volume.r - expected) <= allowed))
            print_error("seed %llu\n", (unsigned long long)(first_seed + trial));
        neph_assert_close(light.volume.r, expected, 0.0, allowed);
        if (expected > 1e-6)
            worst = fmax(worst, fabs(light.volume.r / expected - 1.0));
    }
    print_message("worst relative difference from 2e5 midpoints, random scenes: %.2g\n", worst);
}

/* --- surfaces, switches, furnace ----- */

/* albedo / pi E cos(theta) T_sun, attenuated by T_view. */
static void test_lambert_through_fog(void **state)
{
    const double a = 0.02, b = 0.05, mu0 = 0.8, k = -0.6;
    struct neph_solid ground = make_box(-1e6, -1, -1e6, 1e6, 0, 1e6);
    ground.albedo = (struct neph_rgb){0.5, 0.25, 0.125};
    struct neph_scene scene = make_sunny(make_height_fog(a, b), (struct neph_vec3){0.6, mu0, 0.0});
    scene.sun.irradiance_w_per_m2 = (struct neph_rgb){3.0, 2.0, 1.0};
    scene.solid_count = 1;
    scene.solids = &ground;
    scene.scattering = NEPH_SCATTERING_NONE;
    scene.background_w_per_m2_sr = white; /* only visible in the sky */
    const struct neph_ray_light light = neph_transport_ray(&scene, (struct neph_vec3){1, 12, 2},
                                                           (struct neph_vec3){0.8, k, 0.0});
    const double to_sun = exp(-a / (b * mu0));
    const double to_eye = exp(-a / b * (exp(-b * 12.0) - 1.0) / k);
    neph_assert_close(light.hit_m, 20.0, 1e-15, 0.0);
    neph_assert_close(light.transmittance.r, to_eye, 1e-13, 0.0);
    neph_assert_close(light.radiance.r, 0.5 / M_PI * 3.0 * mu0 * to_sun * to_eye, 1e-11, 0.0);
    neph_assert_close(light.radiance.g, 0.25 / M_PI * 2.0 * mu0 * to_sun * to_eye, 1e-11, 0.0);
    neph_assert_close(light.radiance.b, 0.125 / M_PI * 1.0 * mu0 * to_sun * to_eye, 1e-11, 0.0);
    assert_true(light.volume.r == 0.0 && light.volume.g == 0.0 && light.volume.b == 0.0);
}

static void test_a_surface_turned_away_or_shaded_is_black(void **state)
{
    struct neph_solid solids[] = {make_box(-9, -1, -9, 9, 0, 9), make_box(-1, 3, -1, 1, 4, 1)};
    solids[0].albedo = solids[1].albedo = white;
    struct neph_scene scene = make_sunny(make_height_fog(0.0, 0.0), (struct neph_vec3){0, 1, 0});
    scene.solid_count = 2;
    scene.solids = solids;
    const struct neph_vec3 eye = {0, 1, 5};
    const struct neph_vec3 shaded = neph_vec3_normalize((struct neph_vec3){0, -1, -5});
    const struct neph_vec3 lit = neph_vec3_normalize((struct neph_vec3){3, -1, -5});
    const struct neph_vec3 underside = neph_vec3_normalize((struct neph_vec3){0, 2, -5});
    const struct neph_vec3 side = neph_vec3_normalize((struct neph_vec3){0, 2.5, -4});
    neph_assert_close(neph_transport_ray(&scene, eye, shaded).radiance.r, 0.0, 0.0, 0.0);
    neph_assert_close(neph_transport_ray(&scene, eye, lit).radiance.r, 1.0 / M_PI, 1e-14, 0.0);
    neph_assert_close(neph_transport_ray(&scene, eye, underside).radiance.r, 0.0, 0.0, 0.0);
    neph_assert_close(neph_transport_ray(&scene, eye, side).radiance.r, 0.0, 0.0, 0.0);
}

/* The ground below 1000 km of air does not shadow itself by rounding. */
static void test_a_surface_far_away_is_lit(void **state)
{
    struct neph_solid ground = make_box(-1e7, -10, -1e7, 1e7, 0, 1e7);
    ground.albedo = white;
    struct neph_scene scene = make_sunny(make_height_fog(0.0, 0.0),
                                         (struct neph_vec3){0.6, 0.8, 0});
    scene.solid_count = 1;
    scene.solids = &ground;
    uint64_t seed = 8;
    for (int i = 0; i < 1000; i++) {
        struct neph_vec3 d = random_direction(&seed);
        d.y = -fabs(d.y) - 0.3;
        d = neph_vec3_normalize(d);
        const struct neph_ray_light light = neph_transport_ray(&scene,
                                                               (struct neph_vec3){3, 1e6, 7}, d);
        neph_assert_close(light.radiance.r, 0.8 / M_PI, 1e-13, 0.0);
    }
}

/* radiance = volume + T background; each channel has its own albedo and sun. */
static void test_parts_add_up(void **state)
{
    struct neph_medium fog = make_homogeneous(0.3, (struct neph_bounds){{-1, -1, -1}, {1, 1, 1}});
    struct neph_scene scene = make_sunny(fog, (struct neph_vec3){0, 1, 0});
    const struct neph_vec3 eye = {-3, 0.2, 0.1}, d = {1, 0, 0};
    const double grey = neph_transport_ray(&scene, eye, d).volume.r;
    scene.media[0].albedo = (struct neph_rgb){0.5, 0.25, 0.0};
    scene.sun.irradiance_w_per_m2 = (struct neph_rgb){1, 3, 5};
    scene.background_w_per_m2_sr = (struct neph_rgb){0.1, 0.2, 0.3};
    const struct neph_ray_light light = neph_transport_ray(&scene, eye, d);
    neph_assert_close(light.transmittance.r, exp(-0.6), 1e-15, 0.0);
    assert_true(isinf(light.hit_m));
    neph_assert_close(light.volume.r, 0.5 * grey, 1e-15, 0.0);
    neph_assert_close(light.volume.g, 0.75 * grey, 1e-15, 0.0);
    neph_assert_close(light.volume.b, 0.0, 0.0, 0.0);
    neph_assert_close(light.radiance.r, light.volume.r + 0.1 * light.transmittance.r, 1e-15, 0.0);
    neph_assert_close(light.radiance.g, light.volume.g + 0.2 * light.transmittance.r, 1e-15, 0.0);
    neph_assert_close(light.radiance.b, 0.3 * light.transmittance.r, 1e-15, 0.0);

    scene.sun.present = false;
    assert_true(neph_transport_ray(&scene, eye, d).volume.g == 0.0);
    scene.sun.present = true;
    scene.scattering = NEPH_SCATTERING_NONE;
    assert_true(neph_transport_ray(&scene, eye, d).volume.g == 0.0);
    /* Looking away from it. */
    scene.scattering = NEPH_SCATTERING_SINGLE;
    const struct neph_ray_light away = neph_transport_ray(&scene, eye,
                                                          (struct neph_vec3){-1, 0, 0});
    assert_true(away.transmittance.r == 1.0 && away.volume.r == 0.0 && away.radiance.r == 0.1);
}

static void test_white_furnace(void **state)
{
    struct neph_solid ball = {
        .kind = NEPH_SOLID_SPHERE, .center_m = {0, 0, -5}, .radius_m = 1, .albedo = white};
    struct neph_scene scene = {.scattering = NEPH_SCATTERING_MULTIPLE,
                               .environment_light = true,
                               .background_w_per_m2_sr = {1, 2, 3},
                               .solid_count = 1,
                               .solids = &ball,
                               .medium_count = 1,
                               .media = {make_height_fog(0.1, 0.2)}};
    char reason[100] = "untouched";
    assert_true(neph_transport_is_exact(&scene, reason, sizeof(reason)));
    assert_string_equal(reason, "untouched");
    for (int i = 0; i < 2; i++) {
        const struct neph_vec3 d = {0, i, i - 1}; /* onto the ball, and up into the sky */
        const struct neph_ray_light light = neph_transport_ray(&scene, (struct neph_vec3){0}, d);
        assert_true(light.radiance.r == 1.0 && light.radiance.g == 2.0 && light.radiance.b == 3.0);
        neph_assert_close(light.transmittance.r, i ? exp(-0.5) : exp(-0.4), 1e-14, 0.0);
        neph_assert_close(light.volume.g, 2.0 * (1.0 - light.transmittance.r), 1e-14, 0.0);
    }
}

static void assert_refused(const struct neph_scene *scene, const char *because)
{
    char reason[100] = "";
    assert_false(neph_transport_is_exact(scene, reason, sizeof(reason)));
    assert_non_null(strstr(reason, because));
}

static void test_what_is_refused(void **state)
{
    char reason[100];
    struct neph_solid wall = make_box(0, 0, 0, 1, 1, 1);
    wall.albedo = white;
    struct neph_scene scene = make_sunny(make_height_fog(0.1, 0.2), (struct neph_vec3){0, 1, 0});
    scene.solid_count = 1;
    scene.solids = &wall;
    assert_true(neph_transport_is_exact(&scene, reason, sizeof(reason)));
    scene.scattering = NEPH_SCATTERING_MULTIPLE;
    assert_refused(&scene, "multiple scattering");
    scene.environment_light = true; /* a furnace, except for its sun */
    scene.background_w_per_m2_sr = white;
    assert_refused(&scene, "multiple scattering");
    scene.sun.present = false; /* a furnace, except for a grey wall */
    wall.albedo.g = 0.99;
    assert_refused(&scene, "multiple scattering");
    wall.albedo.g = 1.0; /* a furnace, except for a grey fog */
    scene.media[0].albedo.b = 0.5;
    assert_refused(&scene, "multiple scattering");
    scene.scattering = NEPH_SCATTERING_SINGLE;
    assert_refused(&scene, "surroundings");
    scene.scattering = NEPH_SCATTERING_NONE; /* the wall is still lit */
    assert_refused(&scene, "surroundings");
    /* Only attenuation remains: exact for any setting. */
    wall.albedo = scene.media[0].albedo = (struct neph_rgb){0, 0, 0};
    for (int s = NEPH_SCATTERING_NONE; s <= NEPH_SCATTERING_MULTIPLE; s++) {
        scene.scattering = (enum neph_scattering)s;
        assert_true(neph_transport_is_exact(&scene, reason, sizeof(reason)));
    }
}

/* Finite, not negative, T in [0, 1], volume at most all of the sun's light: all extremes. */
static void test_never_nonsense(void **state)
{
    static const double extinctions[] = {0.0, 1e-300, 1e-10, 1e-3, 1.0, 1e3, 1e300};
    static const double falloffs[] = {0.0, 1e-300, 1e-4, 0.1, 10.0};
    static const double heights[] = {-1e6, -100.0, 0.0, 2.0, 1e3, 1e6};
    static const double slopes[] = {0.0,   1e-300, -1e-300, 1e-9, -1e-9, 0.01,
                                    -0.01, 0.6,    -0.6,    1,    -1};
    static const double suns[] = {1.0, 0.6, 0.05, 1e-9, 1e-300, 0.0, -0.3, -1.0};
    struct neph_solid ground = make_box(-1e5, -10, -1e5, 1e5, -1, 1e5);
    ground.albedo = white;
    const size_t every = (size_t)neph_test_path_step();
    for (size_t n = 0; n < COUNT(extinctions) * COUNT(falloffs) * COUNT(heights); n++)
        for (size_t k = n % every; k < COUNT(slopes) * COUNT(suns); k += every) {
            const size_t a = n % COUNT(extinctions), b = n / COUNT(extinctions) % COUNT(falloffs);
            const double eye_m = heights[n / (COUNT(extinctions) * COUNT(falloffs))];
            const double k_y = slopes[k % COUNT(slopes)], s_y = suns[k / COUNT(slopes)];
            struct neph_scene scene = make_sunny(
                make_height_fog(extinctions[a], falloffs[b]),
                (struct neph_vec3){sqrt(1.0 - s_y * s_y), s_y, 0.0});
            scene.solid_count = (int)(k % 2);
            scene.solids = &ground;
            if (k % 3 == 0) { /* and a second layer, for the quadrature */
                scene.media[0].layer_count = 2;
                scene.media[0].layers[1] = (struct neph_fog_layer){1e-3, 0.02, 5.0};
            }
            const struct neph_ray_light light = neph_transport_ray(
                &scene, (struct neph_vec3){0.5, eye_m, 0.25},
                (struct neph_vec3){0.0, k_y, -sqrt(1.0 - k_y * k_y)});
            const bool sane = light.transmittance.r >= 0.0 && light.transmittance.r <= 1.0 &&
                              light.volume.r >= 0.0 &&
                              light.volume.r <= 1.0 / (4.0 * M_PI) + 1e-12 &&
                              light.radiance.r >= light.volume.r && light.radiance.r <= 1.0 &&
                              light.quadrature_error >= 0.0 && light.quadrature_error < 1e-9;
            if (!sane)
                print_error(
                    "a %g, b %g, eye %g, view %g, sun %g, %d layers, %d solids: T %g, L %g, "
                    "error %g\n",
                    extinctions[a], falloffs[b], eye_m, k_y, s_y, scene.media[0].layer_count,
                    scene.solid_count, light.transmittance.r, light.volume.r,
                    light.quadrature_error);
            assert_true(sane);
        }
}

#include "tests/main.h"
