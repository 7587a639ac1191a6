/* SPDX-License-Identifier: MIT
 *
 * The sky's tables compared with closed forms, with the exact light of one order, with
 * adding-doubling, and with the oracle.
 */
#include "tests/renderer/frames.h"

#include "renderer/sky/device.h"
#include "scenes/media.h"
#include "scenes/skyward.h"
#include "scenes/solids.h"
#include "truth/slab.h"

static const struct neph_sky_params usual = {
    .steps = 48,
    .sun_altitudes = 64,
    .sun_cosines = 256,
    .field = {.altitudes = 12,
              .suns = 32,
              .degree = 2,
              .orders = 6,
              .above = 6,
              .below = 3,
              .around = 4,
              .steps = 12},
};

static struct neph_scene *look(const struct neph_scene *earth, double sun_deg, double altitude_m,
                               enum neph_scattering scattering)
{
    struct neph_scene *made = NULL;
    struct neph_diag diag = {0};
    const struct neph_skyward view = {.sun_elevation_rad = sun_deg * NEPH_RAD_PER_DEG,
                                      .altitude_m = altitude_m,
                                      .azimuth_rad = 0.4,
                                      .pitch_rad = 0.4,
                                      .vertical_fov_rad = 1.8};
    neph_assert_ok(neph_scene_skyward(earth, &view, &made, &diag), &diag);
    made->scattering = scattering;
    return made;
}

/* --- harmonics -------------------------------------------------------------------------------- */

/* Integrated by a product rule that is exact for products of harmonics: many midpoints in z (to
 * 1e-5), and equal steps of azimuth. */
static void test_harmonics_are_orthonormal(void **state)
{
    enum { COUNT_Z = 2000, COUNT_PHI = 32, DEGREE = 5, MOMENTS = 21 };
    double sums[MOMENTS][MOMENTS] = {{0.0}};
    assert_int_equal(neph_sky_moments(DEGREE), MOMENTS);
    for (int i = 0; i < COUNT_Z * COUNT_PHI; i++) {
        const double z = 2.0 * (i / COUNT_PHI + 0.5) / COUNT_Z - 1.0;
        const double phi = 2.0 * M_PI * (i % COUNT_PHI + 0.5) / COUNT_PHI;
        double values[NEPH_SKY_MOMENTS_MAX];
        neph_sky_harmonics(DEGREE, sqrt(1.0 - z * z) * cos(phi), z, values);
        for (int a = 0; a < MOMENTS; a++)
            for (int b = 0; b < MOMENTS; b++)
                sums[a][b] += values[a] * values[b] * 4.0 * M_PI / (COUNT_Z * COUNT_PHI);
    }
    for (int a = 0; a < MOMENTS; a++)
        for (int b = 0; b < MOMENTS; b++)
            assert_true(fabs(sums[a][b] - (a == b)) < 3e-5);
}

/* In the plane of z and x the sine terms vanish from the addition theorem: the sum over degrees of
 * coefficient times the harmonics of two directions is the phase function. */
static void test_phase_functions_are_their_series(void **state)
{
    struct neph_sky_air air;
    char reason[200];
    OWNED(scene) struct neph_scene *earth = test_load("catalog/sky_earth");
    assert_true(neph_sky_air_of(earth, &air, reason, sizeof(reason)));
    for (int n = 0; n < 50; n++) {
        const double a = 0.13 * n, b = 1.0 + 0.29 * n;
        double at_a[NEPH_SKY_MOMENTS_MAX], at_b[NEPH_SKY_MOMENTS_MAX];
        neph_sky_harmonics(8, sin(a), cos(a), at_a);
        neph_sky_harmonics(8, sin(b), cos(b), at_b);
        double rayleigh = 0.0, henyey = 0.0, left = 0.0;
        for (int l = 0; l <= 8; l++) {
            for (int k = neph_sky_moments(l - 1); k < neph_sky_moments(l); k++) {
                rayleigh += air.layers[0].legendre[l] * at_a[k] * at_b[k];
                henyey += pow(0.3, l) * at_a[k] * at_b[k];
            }
            left = (2.0 * l + 3.0) / (4.0 * M_PI) * pow(0.3, l + 1) * 1.5;
        }
        const struct neph_phase hg = {NEPH_PHASE_HENYEY_GREENSTEIN, 0.3};
        neph_assert_close(rayleigh, neph_phase_per_sr(&air.layers[0].phase, cos(a - b)), 1e-12,
                          0.0);
        neph_assert_close(henyey, neph_phase_per_sr(&hg, cos(a - b)), 0.0, left);
        neph_assert_close(air.layers[1].legendre[3], 0.8 * 0.8 * 0.8, 1e-14, 0.0);
    }
}

/* --- the table of transmittance --------------------------------------------------------------- */

/* Linear interpolation with the usual number of nodes and with half of them: the largest error is
 * at sunset, where the transmittance falls from a tenth to 0 within a degree. */
static void test_sun_table(void **state)
{
    struct neph_sky_air air;
    char reason[200];
    struct neph_diag diag = {0};
    OWNED(scene) struct neph_scene *earth = test_load("catalog/sky_earth");
    assert_true(neph_sky_air_of(earth, &air, reason, sizeof(reason)));
    double worst[2] = {0.0, 0.0};
    for (int fine = 0; fine < 2; fine++) {
        struct neph_sky_sun_table table;
        neph_assert_ok(
            neph_sky_sun_table_create(&air, fine ? 63 : 32, fine ? 255 : 128, &table, &diag),
            &diag);
        uint64_t seed = 5;
        for (int n = 0; n < 2000; n++) {
            const double altitude_m = 60e3 * pow(neph_test_uniform(&seed, 0.0, 1.0), 2.0);
            const double r_m = air.radius_m + altitude_m;
            const double horizon = -sqrt(1.0 - pow(air.radius_m / r_m, 2.0));
            const double cosine = neph_test_uniform(&seed, horizon, n % 2 ? 1.0 : horizon + 0.1);
            double depth[3], light[3];
            neph_sky_depth_to_space(&air, altitude_m, cosine, depth);
            neph_sky_sun_transmittance(&air, &table, altitude_m, cosine, light);
            for (int c = 0; c < 3; c++)
                worst[fine] = fmax(worst[fine], fabs(light[c] - exp(-depth[c])));
            neph_sky_sun_transmittance(&air, &table, altitude_m, horizon - 1e-3, light);
            assert_true(light[0] == 0.0 && light[1] == 0.0 && light[2] == 0.0);
        }
        neph_sky_sun_table_destroy(&table);
    }
    print_message("transmittance to the sun: off by %.2g, with twice the nodes by %.2g\n", worst[0],
                  worst[1]);
    assert_true(worst[0] < 2.5e-2 && worst[1] < 8e-3);
}

/* --- one order -------------------------------------------------------------------------------- */

/* Largest relative difference to the exact light; below 1e-4 of the sunlight per sr (the light of
 * the air above the tables' top) relative to that. */
static double off_by(const struct neph_scene *scene, int steps, double *transmittance)
{
    struct neph_sky_params params = usual;
    params.steps = steps;
    params.sun_altitudes = 128;
    params.sun_cosines = 512;
    OWNED(sky) struct neph_sky *sky = test_sky(scene, &params);
    double worst = 0.0;
    *transmittance = 0.0;
    for (int i = 0; i < 6 * 7; i++) {
        const struct neph_pixel_ray ray = test_ray(scene, 6, 7, i);
        const struct neph_ray_light exact = neph_transport_ray(scene, ray.origin_m, ray.direction);
        const struct neph_sky_light seen = neph_sky_see(sky, ray.origin_m, ray.direction);
        const double *through = &exact.transmittance.r, *light = &exact.radiance.r;
        assert_true(isinf(exact.hit_m) == isinf(seen.length_m));
        if (isfinite(exact.hit_m))
            neph_assert_close(seen.length_m, exact.hit_m, 1e-6, 1e-3);
        for (int c = 0; c < 3; c++) {
            *transmittance = fmax(*transmittance, fabs(seen.transmittance[c] - through[c]));
            worst = fmax(worst, fabs(seen.radiance[c] - light[c]) / fmax(light[c], 1e-4));
        }
    }
    return worst;
}

/* Several places, horizontal and vertical rays, to the ground and past it: second order in the
 * steps. */
static void test_one_order_is_exact_in_the_limit(void **state)
{
    OWNED(scene) struct neph_scene *earth = test_load("catalog/sky_earth");
    static const struct {
        double sun_deg, altitude_m;
    } places[] = {{60.0, 2.0}, {5.0, 10e3}, {40.0, 300e3}};
    for (size_t i = 0; i < sizeof(places) / sizeof(places[0]); i++) {
        OWNED(scene)
        struct neph_scene *scene = look(earth, places[i].sun_deg, places[i].altitude_m,
                                        NEPH_SCATTERING_SINGLE);
        double through[2];
        const double coarse = off_by(scene, 32, &through[0]);
        const double fine = off_by(scene, 128, &through[1]);
        print_message("sun %g, %g m: light off by %.2g, with four times the steps by %.2g; "
                      "transmittance by %.2g, %.2g\n",
                      places[i].sun_deg, places[i].altitude_m, coarse, fine, through[0],
                      through[1]);
        assert_true(coarse < 0.02 && fine < 0.003);
        assert_true(through[0] < 5e-3 && through[1] < through[0] / 6.0);
    }
}

/* --- all orders ------------------------------------------------------------------------------- */

/* Air of 100 m on a large black sphere (the caller's solid), with all orders of sunlight. */
static struct neph_scene thin_air(double radius_m, double depth, double albedo,
                                  struct neph_phase phase, double sun_cosine,
                                  struct neph_solid *ground)
{
    static const double height_m = 100.0;
    *ground = make_sphere(0.0, -radius_m, 0.0, radius_m);
    struct neph_medium medium = make_shell(depth / height_m, ground->center_m, radius_m, height_m);
    medium.albedo = make_grey(albedo);
    medium.phase = phase;
    struct neph_scene scene = make_sunny(
        medium, (struct neph_vec3){sqrt(1.0 - sun_cosine * sun_cosine), sun_cosine, 0.0});
    scene.solids = ground;
    scene.solid_count = 1;
    scene.scattering = NEPH_SCATTERING_MULTIPLE;
    return scene;
}

/* A thin atmosphere on a large black sphere: plane-parallel up to sqrt(H / R), 3e-3, because
 * horizontal light sees the curvature. */
static void check_slab(struct neph_phase phase, int degree, double tolerance)
{
    static const double cosines[] = {0.9, 0.6, 0.35};
    struct neph_solid ground;
    const struct neph_sky_params params = {.steps = 96,
                                           .sun_altitudes = 24,
                                           .sun_cosines = 4096,
                                           .field = {.altitudes = 32,
                                                     .suns = 9,
                                                     .degree = degree,
                                                     .orders = 10,
                                                     .above = 8,
                                                     .below = 8,
                                                     .around = 5,
                                                     .steps = 16}};
    const struct neph_sky_field axis = {.altitudes = 32, .suns = 9};
    const double sun_cosine = neph_sky_node_sun_cosine(&axis, 6);
    const struct neph_scene scene = thin_air(1e7, 0.5, 0.95, phase, sun_cosine, &ground);
    struct neph_diag diag = {0};
    OWNED(slab) struct neph_slab *slab = NULL;
    neph_assert_ok(neph_slab_create(&(struct neph_slab_params){.optical_depth = 0.5,
                                                               .albedo = 0.95,
                                                               .phase = phase,
                                                               .sun_cosine = sun_cosine,
                                                               .view_count = 3,
                                                               .view_cosines = cosines},
                                    &slab, &diag),
                   &diag);
    OWNED(sky) struct neph_sky *sky = test_sky(&scene, &params);
    double worst = 0.0;
    for (int i = 0; i < 12; i++) {
        const double azimuth_rad = 0.3 + 0.8 * (i / 3), y = cosines[i % 3], x = sqrt(1.0 - y * y);
        /* Sunlight travels to -x: light in the same direction comes from +x. */
        const struct neph_vec3 up = {x * cos(azimuth_rad), y, x * sin(azimuth_rad)};
        const struct neph_vec3 down = {up.x, -y, up.z};
        const struct neph_vec3 foot_m = {0, 1e-3, 0}, high_m = {0, 1390.0, 0};
        const double from_below = neph_sky_see(sky, foot_m, up).radiance[1];
        const double from_above = neph_sky_see(sky, high_m, down).radiance[1];
        const double through = neph_slab_transmitted_per_sr(slab, i % 3, azimuth_rad);
        const double back = neph_slab_reflected_per_sr(slab, i % 3, azimuth_rad);
        worst = fmax(worst, fabs(from_below / through - 1.0));
        worst = fmax(worst, fabs(from_above / back - 1.0));
    }
    print_message("against a slab, degree %d: off by %.2g\n", degree, worst);
    assert_true(worst < tolerance);
}

/* Isotropic and Rayleigh scattering have moments of degree 0, and of 0 and 2, only: the remaining
 * errors are from steps, nodes and directions. Henyey-Greenstein needs more degrees, and improves
 * with them. */
static void test_all_orders_in_a_slab(void **state)
{
    check_slab((struct neph_phase){NEPH_PHASE_ISOTROPIC, 0.0}, 0, 3e-3);
    check_slab((struct neph_phase){NEPH_PHASE_RAYLEIGH, 0.0}, 2, 3e-3);
    if (neph_test_is_night())
        check_slab((struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN, 0.5}, 4, 8e-3);
}

/* --- published values ------------------------------------------------------------------------- */

/* All orders in a slab with Rayleigh scattering without polarization, optical depth 0.2, sun at 4.6
 * degrees, in the plane of the sun, from below and from above: A. Sweigart, "Radiative Transfer in
 * Atmospheres Scattering According to the Rayleigh Phase Function with Absorption" (Astrophys. J.
 * Suppl. 22, 1970), table 1, as printed in the second test of DISORT (K. Stamnes et al., Appl. Opt.
 * 27, 1988). The irradiance perpendicular to the sunlight is pi. */
static const struct {
    double albedo, below[3], above[3];
} sweigart[] = {
    {1.0, {6.77603e-2, 4.64061e-2, 1.86027e-2}, {3.47678e-1, 4.87120e-2, 1.89387e-2}},
    {0.5, {2.57685e-2, 2.00778e-2, 7.71897e-3}, {1.61796e-1, 2.11501e-2, 7.86713e-3}},
};
static const double sweigart_sun_cosine = 0.080442;
static const double sweigart_cosines[3] = {0.018014, 0.538263, 0.981986};

/* A sphere so large that the first direction, a degree above the horizon, has hardly any curvature:
 * 1e-3 of its length. */
static void test_sweigarts_rayleigh_sky(void **state)
{
    const struct neph_sky_params params = {.steps = 192,
                                           .sun_altitudes = 24,
                                           .sun_cosines = 4096,
                                           .field = {.altitudes = 32,
                                                     .suns = 20,
                                                     .degree = 2,
                                                     .orders = 10,
                                                     .above = 16,
                                                     .below = 8,
                                                     .around = 5,
                                                     .steps = 16}};
    double worst = 0.0, grazing = 0.0;
    for (size_t n = 0; n < (size_t)neph_test_by_day(1, COUNT(sweigart)); n++) {
        struct neph_solid ground;
        struct neph_scene scene = thin_air(3e8, 0.2, sweigart[n].albedo,
                                           (struct neph_phase){NEPH_PHASE_RAYLEIGH, 0.0},
                                           sweigart_sun_cosine, &ground);
        scene.sun.irradiance_w_per_m2 = make_grey(M_PI);
        OWNED(sky) struct neph_sky *sky = test_sky(&scene, &params);
        for (int i = 0; i < 3; i++) {
            const double y = sweigart_cosines[i], x = sqrt(1.0 - y * y);
            const double below = neph_sky_see(sky, (struct neph_vec3){0, 1e-3, 0},
                                              (struct neph_vec3){x, y, 0})
                                     .radiance[1];
            const double above = neph_sky_see(sky, (struct neph_vec3){0, 1390.0, 0},
                                              (struct neph_vec3){x, -y, 0})
                                     .radiance[1];
            print_message("albedo %.1f, cosine %.3f: %+.2f %% from below, %+.2f %% from above\n",
                          sweigart[n].albedo, y, 1e2 * (below / sweigart[n].below[i] - 1.0),
                          1e2 * (above / sweigart[n].above[i] - 1.0));
            double *of = i == 0 ? &grazing : &worst;
            *of = fmax(*of, fabs(below / sweigart[n].below[i] - 1.0));
            *of = fmax(*of, fabs(above / sweigart[n].above[i] - 1.0));
        }
    }
    assert_true(worst < 5e-3 && grazing < 1.5e-2);
}

/* The mean of a wide frame compared with the oracle, to 1 %; at night every pixel. */
static void test_all_orders_of_the_earth(void **state)
{
    const int samples = neph_test_by_day(400, 20000);
    enum { WIDTH = 12, HEIGHT = 8 };
    OWNED(scene) struct neph_scene *earth = test_load("catalog/sky_earth");
    OWNED(scene) struct neph_scene *scene = look(earth, 5.0, 2.0, NEPH_SCATTERING_MULTIPLE);
    OWNED(image) struct neph_image *frame = test_oracle(scene, WIDTH, HEIGHT, 3, samples);
    const struct test_rgb rgb = test_layer(frame, NULL), variance = test_layer(frame, "variance");
    OWNED(sky) struct neph_sky *sky = test_sky(scene, &usual);
    double seen = 0.0, truth = 0.0, noise2 = 0.0;
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        const struct neph_pixel_ray ray = test_ray(scene, WIDTH, HEIGHT, i);
        const struct neph_sky_light light = neph_sky_see(sky, ray.origin_m, ray.direction);
        for (int c = 0; c < 3; c++) {
            seen += light.radiance[c];
            truth += (double)rgb.of[c][i];
            noise2 += (double)variance.of[c][i];
        }
    }
    print_message("sun at 5 degrees: %.4f of the oracle's light, whose noise is %.4f\n",
                  seen / truth, sqrt(3.0 * noise2) / truth);
    /* A path's channels are correlated: at most 3 times the sum of their variances. */
    neph_assert_close(seen, truth, 0.015, 3.0 * sqrt(3.0 * noise2));
}

/* --- solids ----------------------------------------------------------------------------------- */

/* Boxes and a sphere at 50 m to 40 km, one in the shadow of another. */
static struct neph_scene *with_solids(const struct neph_scene *earth, struct neph_solid solids[5],
                                      enum neph_scattering scattering)
{
    struct neph_scene *scene = look(earth, 35.0, 300.0, scattering);
    solids[0] = earth->solids[0];
    solids[1] = make_box(-60.0, -1.0, -200.0, -20.0, 310.0, -170.0);
    solids[2] = make_box(-30.0, -1.0, -160.0, -20.0, 330.0, -140.0);
    solids[3] = make_box(-30e3, -500.0, -41e3, 30e3, 9e3, -40e3);
    solids[4] = make_sphere(1500.0, 900.0, -5e3, 400.0);
    for (int i = 1; i < 5; i++)
        solids[i].albedo = (struct neph_rgb){0.5, 0.3, 0.2};
    scene->solids = solids;
    scene->solid_count = 5;
    scene->sun.direction = neph_vec3_normalize((struct neph_vec3){-0.1, 0.5, 0.8});
    return scene;
}

/* Without scattering everything but the sky's table is exact. With one order the air in front of a
 * distant solid is, too, except for the shadow of the sphere, which few rays cross. */
static void test_solids_behind_air(void **state)
{
    enum { WIDTH = 36, HEIGHT = 24 };
    static const struct {
        enum neph_scattering scattering;
        double from_m, limit;
    } cases[] = {{NEPH_SCATTERING_NONE, 0.0, 2e-3}, {NEPH_SCATTERING_SINGLE, 3e3, 0.05}};
    OWNED(scene) struct neph_scene *earth = test_load("catalog/sky_earth");
    for (size_t n = 0; n < sizeof(cases) / sizeof(cases[0]); n++) {
        struct neph_solid solids[5];
        OWNED(scene) struct neph_scene *scene = with_solids(earth, solids, cases[n].scattering);
        OWNED(sky) struct neph_sky *sky = test_sky(scene, &usual);
        int hits = 0, close = 0;
        double worst = 0.0;
        for (int i = 0; i < WIDTH * HEIGHT; i++) {
            const struct neph_pixel_ray ray = test_ray(scene, WIDTH, HEIGHT, i);
            const struct neph_hit hit = neph_scene_hit(scene, ray.origin_m, ray.direction);
            if (!hit.solid || hit.solid == &solids[0] || hit.t_m < cases[n].from_m)
                continue;
            const struct neph_ray_light exact = neph_transport_ray(scene, ray.origin_m,
                                                                   ray.direction);
            const struct neph_sky_light seen = neph_sky_see(sky, ray.origin_m, ray.direction);
            const double *light = &exact.radiance.r, *through = &exact.transmittance.r;
            double off = 0.0;
            hits++;
            neph_assert_close(seen.length_m, hit.t_m, 1e-12, 0.0);
            for (int c = 0; c < 3; c++) {
                assert_true(fabs(seen.transmittance[c] - through[c]) < 1e-3);
                off = fmax(off, fabs(seen.radiance[c] - light[c]) / fmax(light[c], 1e-3));
            }
            close += off < 1e-3;
            worst = fmax(worst, off);
        }
        print_message("%d pixels with solids: off by %.2g\n", hits, worst);
        assert_true(hits > 30 && close >= 0.8 * hits && worst < cases[n].limit);
    }
}

/* Irradiance of a horizontal surface at the ground, from the moments and as summed for the ground.
 * They agree up to degrees above 4 and the few directions of the sum: 4 %. */
static void test_moments_light_surfaces(void **state)
{
    struct neph_sky_air air;
    struct neph_diag diag = {0};
    char reason[200];
    OWNED(scene) struct neph_scene *earth = test_load("catalog/sky_earth");
    assert_true(neph_sky_air_of(earth, &air, reason, sizeof(reason)));
    struct neph_sky_sun_table sun;
    struct neph_sky_field field;
    struct neph_sky_solve_params params = usual.field;
    params.orders = 2;
    params.degree = 4;
    neph_assert_ok(neph_sky_sun_table_create(&air, 32, 64, &sun, &diag), &diag);
    neph_assert_ok(neph_sky_solve(&air, &sun, &params, &field, &diag), &diag);
    const struct neph_sky_sources sources = {.sun = &sun, .field = &field, .media_scatter = true};
    static const double suns_deg[] = {60.0, 20.0, 5.0, -2.0};
    for (size_t i = 0; i < sizeof(suns_deg) / sizeof(suns_deg[0]); i++) {
        const double cosine = sin(suns_deg[i] * NEPH_RAD_PER_DEG);
        double by_moments[3], summed[3];
        neph_sky_irradiance(&air, &sources, 0.0, cosine, (struct neph_vec3){0, 0, 1}, false,
                            by_moments);
        neph_sky_field_ground(&field, cosine, summed);
        for (int c = 0; c < 3; c++)
            neph_assert_close(by_moments[c], summed[c], 0.06, 0.0);
    }
    neph_sky_field_destroy(&field);
    neph_sky_sun_table_destroy(&sun);
}

/* --- a table of views ------------------------------------------------------------------------- */

/* Linear interpolation between nodes at half the distance: a quarter of the error. Sun and horizon
 * in view. */
static void test_view_table_is_the_walk_in_the_limit(void **state)
{
    enum { WIDTH = 13, HEIGHT = 11, TABLES = 2 };
    OWNED(scene) struct neph_scene *earth = test_load("catalog/sky_earth");
    OWNED(scene) struct neph_scene *scene = look(earth, 14.0, 1000.0, NEPH_SCATTERING_MULTIPLE);
    struct neph_sky_params params = usual;
    params.steps = 16;
    params.field.orders = 2;
    const struct neph_camera camera = neph_scene_camera(scene, 0.0);
    double worst[TABLES] = {0.0, 0.0};
    OWNED(sky) struct neph_sky *walk = test_sky(scene, &params);
    for (int n = 0; n < TABLES; n++) {
        struct neph_diag diag = {0};
        params.view = (struct neph_sky_view_params){true, n ? 47 : 24, n ? 39 : 20};
        OWNED(sky) struct neph_sky *table = test_sky(scene, &params);
        neph_assert_ok(neph_sky_stand(table, camera.position_m, &diag), &diag);
        for (int i = 0; i < WIDTH * HEIGHT; i++) {
            const struct neph_pixel_ray ray = test_ray(scene, WIDTH, HEIGHT, i);
            const struct neph_sky_light a = neph_sky_see(walk, ray.origin_m, ray.direction);
            const struct neph_sky_light b = neph_sky_see(table, ray.origin_m, ray.direction);
            assert_true(a.length_m == b.length_m);
            for (int c = 0; c < 3; c++) {
                worst[n] = fmax(worst[n], fabs(b.radiance[c] / a.radiance[c] - 1.0));
                worst[n] = fmax(worst[n], fabs(b.volume[c] / a.volume[c] - 1.0));
                worst[n] = fmax(worst[n], fabs(b.transmittance[c] - a.transmittance[c]));
            }
        }
    }
    print_message("table of views: off by %.2g, with twice the nodes by %.2g\n", worst[0],
                  worst[1]);
    assert_true(worst[0] < 0.03 && worst[1] < 0.3 * worst[0]);
}

/* The ground from a few metres above it: through 100 m to 4 km of air, with distances between two
 * nodes; towards the sun and away from it. */
static void test_view_table_sees_the_ground_near(void **state)
{
    OWNED(scene) struct neph_scene *earth = test_load("catalog/sky_earth");
    OWNED(scene) struct neph_scene *scene = look(earth, 5.0, 2.0, NEPH_SCATTERING_SINGLE);
    struct neph_sky_params params = usual;
    struct neph_diag diag = {0};
    const struct neph_camera camera = neph_scene_camera(scene, 0.0);
    const struct neph_vec3 sun = scene->sun.direction;
    const double across = hypot(sun.x, sun.z);
    OWNED(sky) struct neph_sky *walk = test_sky(scene, &params);
    params.view = (struct neph_sky_view_params){true, 48, 48};
    OWNED(sky) struct neph_sky *table = test_sky(scene, &params);
    double worst = 0.0;
    neph_assert_ok(neph_sky_stand(table, camera.position_m, &diag), &diag);
    for (int i = 0; i < 80; i++) {
        const double down = 2.0 / (100.0 * pow(40.0, (i / 2) / 39.0)), side = i % 2 ? -1.0 : 1.0;
        const struct neph_vec3 direction = neph_vec3_normalize(
            (struct neph_vec3){side * sun.x / across, -down, side * sun.z / across});
        const struct neph_sky_light a = neph_sky_see(walk, camera.position_m, direction);
        const struct neph_sky_light b = neph_sky_see(table, camera.position_m, direction);
        for (int c = 0; c < 3; c++) {
            worst = fmax(worst, fabs(b.volume[c] / a.volume[c] - 1.0));
            worst = fmax(worst, fabs(b.radiance[c] / a.radiance[c] - 1.0));
        }
    }
    print_message("air before the ground near: off by %.2g\n", worst);
    assert_true(worst < 0.01);
}

/* --- layers ----------------------------------------------------------------------------------- */

/* Splitting a medium and reordering the parts changes nothing but the rounding of sums, which is
 * that in float32 of the transmittance table. */
static void test_splitting_a_medium_changes_nothing(void **state)
{
    OWNED(scene) struct neph_scene *earth = test_load("catalog/sky_earth");
    OWNED(scene) struct neph_scene *whole = look(earth, 8.0, 2000.0, NEPH_SCATTERING_MULTIPLE);
    struct neph_scene split = *whole;
    split.medium_count = 5; /* air 0.3, haze, ozone, air 0.5, air 0.2; then in another order */
    split.media[3] = split.media[4] = split.media[0];
    split.media[0].extinction_per_m *= 0.3;
    split.media[3].extinction_per_m *= 0.5;
    split.media[4].extinction_per_m *= 0.2;
    struct neph_scene mixed = split;
    for (int i = 0; i < 5; i++)
        mixed.media[i] = split.media[(2 * i + 1) % 5];
    struct neph_sky_params params = usual;
    params.field.orders = 2;
    struct neph_sky *skies[3] = {test_sky(whole, &params), test_sky(&split, &params),
                                 test_sky(&mixed, &params)};
    uint64_t seed = 77;
    for (int n = 0; n < 40; n++) {
        const struct neph_vec3 eye_m = {0.0, pow(10.0, neph_test_uniform(&seed, 0.0, 5.0)), 0.0};
        const struct neph_vec3 direction = random_direction(&seed);
        const struct neph_sky_light one = neph_sky_see(skies[0], eye_m, direction);
        for (int other = 1; other < 3; other++) {
            const struct neph_sky_light light = neph_sky_see(skies[other], eye_m, direction);
            for (int c = 0; c < 3; c++) {
                neph_assert_close(light.radiance[c], one.radiance[c], 1e-6, 0.0);
                neph_assert_close(light.transmittance[c], one.transmittance[c], 1e-11, 0.0);
            }
        }
    }
    for (int i = 0; i < 3; i++)
        neph_sky_destroy(skies[i]);
}

/* --- on a device ------------------------------------------------------------------------------ */

/* In float32 altitudes along a ray are accurate to 1e-7 of its length, and light to that over a
 * scale height: 4e-5 of the darkest pixel; measured 3e-6. */
static void test_device_equals_the_cpu_reference(void **state)
{
    struct neph_vulkan *vulkan = *state;
    enum { WIDTH = 9, HEIGHT = 7 };
    static const struct {
        double sun_deg, altitude_m;
        enum neph_scattering scattering;
        int degree;
        bool is_table;
    } cases[] = {{30.0, 2.0, NEPH_SCATTERING_NONE, 2, false},
                 {3.0, 10e3, NEPH_SCATTERING_SINGLE, 2, false},
                 {12.0, 10e3, NEPH_SCATTERING_MULTIPLE, 2, true},
                 {10.0, 2.0, NEPH_SCATTERING_MULTIPLE, 3, false},
                 {-1.0, 400e3, NEPH_SCATTERING_MULTIPLE, 2, false}};
    struct neph_sky_params params = usual;
    params.sun_altitudes = 16;
    params.sun_cosines = 64;
    params.field.altitudes = 6;
    params.field.suns = 16;
    params.field.orders = 3;
    OWNED(scene) struct neph_scene *earth = test_load("catalog/sky_earth");
    for (size_t n = 0; n < sizeof(cases) / sizeof(cases[0]); n++) {
        OWNED(scene)
        struct neph_scene *scene = look(earth, cases[n].sun_deg, cases[n].altitude_m,
                                        cases[n].scattering);
        OWNED(image) struct neph_image *image = NULL;
        struct neph_sky_stats stats;
        struct neph_diag diag = {0};
        params.field.degree = cases[n].degree;
        params.view = (struct neph_sky_view_params){cases[n].is_table, 12, 10};
        struct neph_sky_pictures *pictures = NULL;
        neph_assert_ok(
            neph_sky_pictures_create(vulkan, scene, &params, WIDTH, HEIGHT, &pictures, &diag),
            &diag);
        neph_assert_ok(neph_sky_pictures_frame(pictures, scene, 0.0, &image, &stats, &diag), &diag);
        neph_sky_pictures_destroy(pictures);
        const struct test_rgb rgb = test_layer(image, NULL), volume = test_layer(image, "volume"),
                              through = test_layer(image, "transmittance");
        const float *depth = neph_image_channel(image, "Z");
        OWNED(sky) struct neph_sky *sky = test_sky(scene, &params);
        const struct neph_camera camera = neph_scene_camera(scene, 0.0);
        double worst = 0.0;
        neph_assert_ok(neph_sky_stand(sky, camera.position_m, &diag), &diag);
        for (int i = 0; i < WIDTH * HEIGHT; i++) {
            const struct neph_pixel_ray ray = test_ray(scene, WIDTH, HEIGHT, i);
            const struct neph_sky_light light = neph_sky_see(sky, ray.origin_m, ray.direction);
            assert_true(isinf(light.length_m) == isinf((double)depth[i]));
            for (int c = 0; c < 3; c++) {
                const double floor = 1e-7;
                worst = fmax(worst, fabs((double)rgb.of[c][i] - light.radiance[c]) /
                                        (light.radiance[c] + floor));
                worst = fmax(worst, fabs((double)volume.of[c][i] - light.volume[c]) /
                                        (light.volume[c] + floor));
                worst = fmax(worst, fabs((double)through.of[c][i] - light.transmittance[c]));
            }
        }
        print_message("on a device, sun at %g degrees: off by %.2g\n", cases[n].sun_deg, worst);
        assert_true(worst < 4e-5);
    }
}

static void test_device_says_what_it_cannot(void **state)
{
    char reason[200];
    OWNED(scene) struct neph_scene *earth = test_load("catalog/sky_earth");
    struct neph_sky_params params = usual;
    assert_true(neph_sky_device_can(earth, &params, reason, sizeof(reason)));
    params.field.closure = true;
    assert_false(neph_sky_device_can(earth, &params, reason, sizeof(reason)));
    assert_non_null(strstr(reason, "closure"));
    params = usual;
    params.steps = 4000;
    assert_false(neph_sky_device_can(earth, &params, reason, sizeof(reason)));
    assert_non_null(strstr(reason, "steps"));
    struct neph_scene more = *earth;
    more.solid_count = 2;
    params = usual;
    assert_false(neph_sky_device_can(&more, &params, reason, sizeof(reason)));
    assert_non_null(strstr(reason, "solids"));
}

/* --- refusals --------------------------------------------------------------------------------- */

static void refuses(const struct neph_scene *scene, const char *words)
{
    struct neph_sky_air air;
    struct neph_sky *sky = NULL;
    struct neph_diag diag = {0};
    char reason[200] = "";
    assert_false(neph_sky_air_of(scene, &air, reason, sizeof(reason)));
    assert_non_null(strstr(reason, words));
    assert_int_equal(neph_sky_create(scene, &usual, &sky, &diag), NEPH_ERR_UNSUPPORTED);
    assert_null(sky);
}

static void test_says_what_it_cannot(void **state)
{
    OWNED(scene) struct neph_scene *earth = test_load("catalog/sky_earth");
    struct neph_scene scene = *earth;
    scene.medium_count = 0;
    refuses(&scene, "without an atmosphere");
    scene = *earth;
    scene.solid_count = 0;
    refuses(&scene, "not a sphere, the ground");
    scene = *earth;
    scene.background_w_per_m2_sr.g = 0.1;
    refuses(&scene, "background");
    scene = *earth;
    scene.light_count = 1;
    refuses(&scene, "lights other than the sun");
    scene = *earth;
    scene.media[2].tent.radius_m += 10.0;
    refuses(&scene, "not around the sphere");
    scene = *earth;
    scene.media[0].kind = NEPH_MEDIUM_HOMOGENEOUS;
    refuses(&scene, "not a layer around a sphere");
    scene = *earth;
    scene.media[1].bounds.max_m.y = 5e3;
    refuses(&scene, "bounds that cut");
    scene = *earth;
    scene.media[1].emission_w_per_m2_sr.g = 1.0;
    refuses(&scene, "emits");
}

#include "tests/renderer/main.h"
