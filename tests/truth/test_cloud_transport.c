/* SPDX-License-Identifier: MIT
 *
 * Light along one ray through Gaussian blobs, shells and grids, in colour: against values of 17
 * digits, against cases that are exact for any density (towards the sun and away from it), against
 * an independent quadrature, and with small bodies far away.
 */
#include "tests/scene_builders.h"

#include "base/sort.h"
#include "scenes/grid.h"
#include "scenes/media.h"
#include "scenes/solids.h"
#include "tests/truth/cloud_reference.h"
#include "truth/doubling.h"
#include "truth/transport.h"

/* A third of the nodes are empty. Free with neph_grid_destroy. */
static struct neph_medium lattice(double extinction_per_m, int side, struct neph_vec3 origin_m,
                                  struct neph_vec3 spacing_m, uint64_t seed)
{
    const int size[3] = {side, side, side};
    return make_voxels(extinction_per_m, random_lattice(size, origin_m, spacing_m, -0.5, &seed));
}

/* ---- values ----- */

/* The same lines as in cloud_reference.py. Grids and shells are integrated to 1e-10. */
static void test_reference(void **state)
{
    struct neph_medium tent = lattice(3.0, 1, (struct neph_vec3){0}, (struct neph_vec3){1, 1, 1},
                                      1);
    struct neph_diag diag = {.message = ""};
    tent.grid->values[0] = 1.0f;
    neph_assert_ok(neph_grid_seal(tent.grid, &diag), &diag);
    const struct {
        struct neph_medium medium;
        struct neph_vec3 origin, direction, sun;
        double radiance, relative;
    } cases[] = {
        {make_blob(0.7, (struct neph_vec3){0}, 1.5),
         {-9, 0.5, 1},
         {1, 0.05, -0.1},
         {0.3, 0.9, 0.2},
         reference_gaussian,
         1e-13},
        {make_blob(30, (struct neph_vec3){0}, 1.5),
         {-9, 0.5, 1},
         {1, 0.05, -0.1},
         {-0.6, 0.5, 0.4},
         reference_dense_gaussian,
         1e-13},
        {make_shell(1e-5, (struct neph_vec3){0}, 6.4e6, 8e3),
         {0, 6.402e6, 0},
         {1, 0.02, 0},
         {0.4, 0.6, 0.3},
         reference_shell,
         1e-10},
        {tent, {-2, 0.3, 0.2}, {1, -0.13, 0.07}, {0.25, 0.8, 0.4}, reference_one_node, 1e-10},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        const struct neph_scene scene = make_sunny(cases[i].medium, cases[i].sun);
        const struct neph_ray_light light = neph_transport_ray(
            &scene, cases[i].origin, neph_vec3_normalize(cases[i].direction));
        const double error = fabs(light.volume.r - cases[i].radiance);
        print_message("case %zu: relative error %.2g, estimated %.2g\n", i,
                      error / cases[i].radiance, light.quadrature_error / cases[i].radiance);
        neph_assert_close(light.volume.r, cases[i].radiance, cases[i].relative, 0.0);
        assert_true(error <= light.quadrature_error + 1e-14 * cases[i].radiance);
    }
    neph_grid_destroy(tent.grid);
}

/* ---- exact for any density ---- */

static const struct neph_bounds fog_box = {{-12, -12, -12}, {12, 12, 12}};
static const struct neph_vec3 shell_center_m = {0.0, -60.0, 0.0};
static const double shell_radius_m = 59.0;
static const struct neph_rgb tint = {1.0, 0.3, 2.5};
static const struct neph_rgb albedo = {0.9, 0.5, 1.0};

/* One of every kind, coloured, about 0; extinctions times `scale`. */
static void make_media(struct neph_medium media[3], double scale, uint64_t seed)
{
    media[0] = make_blob(0.2 * scale, (struct neph_vec3){1.0, -0.5, 0.3}, 1.2);
    media[1] = make_shell(0.3 * scale, shell_center_m, shell_radius_m, 0.8);
    media[2] = lattice(0.4 * scale, 6, (struct neph_vec3){-2, -1.5, -2},
                       (struct neph_vec3){0.7, 0.6, 0.8}, seed);
    for (int m = 0; m < 3; m++) {
        media[m].extinction_color = tint;
        media[m].albedo = albedo;
    }
}

static double channel(struct neph_rgb color, int c)
{
    return c == 0 ? color.r : c == 1 ? color.g : color.b;
}

/* Towards the sun the optical path is the same wherever light is scattered: L = w p E tau e^-tau.
 * With the sun behind and nothing in between: L = w p E (1 - e^(-2 tau)) / 2. The largest channel's
 * error over the largest channel. */
static double error_along_the_sun(const struct neph_ray_light *light, struct neph_rgb depth,
                                  bool away, double *largest)
{
    double error = 0.0;
    *largest = 0.0;
    for (int c = 0; c < 3; c++) {
        const double tau = channel(depth, c);
        const double expected = channel(albedo, c) / (4.0 * M_PI) *
                                (away ? -0.5 * expm1(-2.0 * tau) : tau * exp(-tau));
        *largest = fmax(*largest, expected);
        error = fmax(error, fabs(channel(light->volume, c) - expected));
    }
    return error;
}

static void test_towards_and_away_from_the_sun(void **state)
{
    static const double scales[] = {1e-6, 1.0, 1e3, 1e6};
    const double distance_m = 300.0;
    double worst = 0.0;
    for (uint64_t trial = 0; trial < 40; trial += (uint64_t)neph_test_path_step()) {
        uint64_t seed = 271828 + trial;
        const double scale = scales[trial % COUNT(scales)];
        /* Four roundings of the coordinates, in cells of 0.6 m or in depths of the lit layer. */
        const double rounding = 4.0 * 0x1p-53 * distance_m / 0.6 * fmax(1.0, sqrt(scale));
        struct neph_medium media[3];
        make_media(media, scale, seed);
        const struct neph_vec3 d = random_direction(&seed);
        for (int i = 0; i < 6; i++) {
            const bool away = i % 2;
            struct neph_scene scene = make_sunny(media[i / 2], d);
            scene.sun.direction = neph_vec3_scale(d, away ? -1.0 : 1.0);
            const struct neph_vec3 origin = neph_vec3_along(random_point(&seed, 2.0), d,
                                                            -distance_m);
            const struct neph_ray_light light = neph_transport_ray(&scene, origin, d);
            double largest;
            const double error = error_along_the_sun(
                &light, neph_scene_optical_depth(&scene, origin, d, 0.0, INFINITY), away, &largest);
            if (largest < 1e-3 * fmin(scale, 1e-3)) /* almost missed, or opaque */
                continue;
            if (!(error <= light.quadrature_error + rounding * largest))
                print_error("seed %llu, medium %d, scale %g, %s the sun\n",
                            (unsigned long long)(271828 + trial), i / 2, scale,
                            away ? "away from" : "towards");
            neph_assert_close(error, 0.0, 0.0, light.quadrature_error + rounding * largest);
            assert_true(light.quadrature_error < 1e-9 * largest);
            worst = fmax(worst, error / largest);
        }
        neph_grid_destroy(media[2].grid);
    }
    print_message("worst relative error along the sun's line: %.2g\n", worst);
}

/* ---- an independent quadrature ---- */

enum { GAUSS = 16 };

/* The definition, with 16 nodes on each of many equal pieces. */
static struct neph_rgb composite(const struct neph_scene *scene, struct neph_vec3 origin,
                                 struct neph_vec3 d, double t0_m, double t1_m, int piece_count)
{
    double x[GAUSS], weight[GAUSS];
    struct neph_rgb sum = {0, 0, 0};
    const double cosine = neph_vec3_dot(d, scene->sun.direction);
    neph_gauss_legendre(GAUSS, x, weight);
    for (int i = 0; i < piece_count * GAUSS; i++) {
        const double step_m = (t1_m - t0_m) / piece_count;
        const double t_m = t0_m + step_m * (i / GAUSS + x[i % GAUSS]);
        const struct neph_vec3 p = neph_vec3_along(origin, d, t_m);
        const struct neph_rgb tau = neph_rgb_add(
            neph_scene_optical_depth(scene, origin, d, 0.0, t_m),
            neph_scene_optical_depth(scene, p, scene->sun.direction, 0.0, INFINITY));
        const struct neph_rgb light = {exp(-tau.r), exp(-tau.g), exp(-tau.b)};
        for (int m = 0; m < scene->medium_count; m++) {
            const struct neph_medium *medium = &scene->media[m];
            const double factor = weight[i % GAUSS] * step_m *
                                  neph_phase_per_sr(&medium->phase, cosine) *
                                  neph_medium_extinction_per_m(medium, p);
            const struct neph_rgb scattered = neph_rgb_mul(medium->albedo,
                                                           medium->extinction_color);
            sum = neph_rgb_add(sum, neph_rgb_scale(neph_rgb_mul(scattered, light), factor));
        }
    }
    return neph_rgb_mul(sum, scene->sun.irradiance_w_per_m2);
}

/* The positions of jumps of the density along a ray, ascending: the box of the fogs, the ground of
 * the shells, and the end of the media. */
static const double nothing_left_m = 250.0;

static void jumps_on_ray(struct neph_vec3 origin, struct neph_vec3 d, double at_m[5])
{
    const struct neph_vec3 from_center_m = neph_vec3_sub(origin, shell_center_m);
    const double middle_m = -neph_vec3_dot(from_center_m, d);
    const double low_m = neph_vec3_length(neph_vec3_along(from_center_m, d, middle_m));
    const double half_m = sqrt(fmax(0.0, shell_radius_m * shell_radius_m - low_m * low_m));
    double start_m = 0.0, end_m = INFINITY;
    assert_true(neph_bounds_clip(&fog_box, origin, d, &start_m, &end_m));
    at_m[0] = 0.0;
    at_m[1] = end_m;
    at_m[2] = fmax(0.0, middle_m - half_m);
    at_m[3] = fmax(0.0, middle_m + half_m);
    at_m[4] = nothing_left_m;
    neph_sort_doubles(at_m, 5);
}

static struct neph_rgb composite_parts(const struct neph_scene *scene, struct neph_vec3 origin,
                                       struct neph_vec3 d, int piece_count)
{
    double at_m[5];
    struct neph_rgb sum = {0, 0, 0};
    jumps_on_ray(origin, d, at_m);
    for (int i = 0; i < 4; i++)
        if (at_m[i + 1] > at_m[i])
            sum = neph_rgb_add(sum, composite(scene, origin, d, at_m[i], at_m[i + 1], piece_count));
    return sum;
}

static double difference(struct neph_rgb a, struct neph_rgb b)
{
    return fmax(fabs(a.r - b.r), fmax(fabs(a.g - b.g), fabs(a.b - b.b)));
}

/* Against the composite rule with its error from halvings: with kinks at any position between the
 * nodes one halving may change little by chance, two will not, and the error may be a few times the
 * change. */
static double assert_composite(const struct neph_scene *scene, struct neph_vec3 origin,
                               struct neph_vec3 d, int piece_count)
{
    const struct neph_ray_light light = neph_transport_ray(scene, origin, d);
    const struct neph_rgb fine = composite_parts(scene, origin, d, piece_count);
    const struct neph_rgb coarse = composite_parts(scene, origin, d, piece_count / 2);
    const struct neph_rgb coarser = composite_parts(scene, origin, d, piece_count / 4);
    const double largest = fmax(fine.r, fmax(fine.g, fine.b));
    const double allowed = 4.0 * (difference(fine, coarse) + difference(coarse, coarser)) +
                           light.quadrature_error + 1e-10 * largest;
    neph_assert_close(difference(light.volume, fine), 0.0, 0.0, allowed);
    assert_true(allowed < 2e-3 * largest); /* the comparison has power */
    return difference(light.volume, fine) / largest;
}

/* All kinds, overlapping, some with a fog in a box. Kinks limit the composite rule: its error is a
 * power of the step between 1.5 (sun rays that graze the ground of a shell) and 4. */
static void test_random_clouds(void **state)
{
    double worst = 0.0;
    for (uint64_t trial = 0; trial < 24; trial += NEPH_TEST_EVERY) {
        uint64_t seed = 314159 + trial;
        struct neph_medium media[3];
        make_media(media, pow(10.0, neph_test_uniform(&seed, -1.0, 1.0)), seed);
        struct neph_scene scene = make_sunny(media[trial % 3], random_direction(&seed));
        scene.sun.irradiance_w_per_m2 = (struct neph_rgb){2.0, 1.0, 3.0};
        scene.medium_count = 1 + (int)(trial / 3 % 3);
        scene.media[1] = trial % 2 ? make_height_fog(0.05, 0.1) : media[(trial + 1) % 3];
        scene.media[1].phase = (struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN, 0.6};
        scene.media[2] = media[(trial + 2) % 3];
        if (trial % 2)
            scene.media[1].bounds = fog_box;
        const struct neph_vec3 origin = random_point(&seed, 9.0);
        const struct neph_vec3 d = neph_vec3_normalize(
            neph_vec3_sub(random_point(&seed, 2.0), origin));
        worst = fmax(worst, assert_composite(&scene, origin, d, 250));
        neph_grid_destroy(media[2].grid);
    }
    print_message("worst relative difference from the composite rule: %.2g\n", worst);
}

/* ---- colour ---- */

/* Each channel of a coloured scene is a grey scene with this channel's extinction. Also with a
 * closed form: boxes that overlap, and one height fog. */
static void test_a_channel_is_a_grey_scene(void **state)
{
    uint64_t seed = 577215;
    struct neph_medium media[3];
    make_media(media, 2.0, seed);
    struct neph_medium box = make_height_fog(0.3, 0.0);
    box.bounds = (struct neph_bounds){{-2, -1, -3}, {1, 2, 3}};
    struct neph_medium other_box = make_height_fog(0.5, 0.0);
    other_box.bounds = (struct neph_bounds){{-1, -2, -2}, {3, 3, 2}};
    const struct neph_medium pairs[][2] = {{media[0], media[2]},
                                           {media[1], box},
                                           {make_height_fog(0.2, 0.3), make_height_fog(0.0, 0.0)},
                                           {box, other_box}};
    for (size_t i = 0; i < 2 * COUNT(pairs); i++) {
        struct neph_scene scene = make_sunny(pairs[i / 2][0], random_direction(&seed));
        scene.sun.direction.y = fabs(scene.sun.direction.y);
        scene.medium_count = i / 2 == 2 ? 1 : 2;
        scene.media[1] = pairs[i / 2][1];
        scene.media[0].extinction_color = (struct neph_rgb){1.0, 0.25, 0.0};
        scene.media[1].extinction_color = (struct neph_rgb){0.5, 3.0, 1.0};
        const struct neph_vec3 origin = random_point(&seed, 3.0);
        const struct neph_vec3 d = neph_vec3_normalize(
            neph_vec3_sub(random_point(&seed, 1.0), origin));
        const struct neph_ray_light light = neph_transport_ray(&scene, origin, d);
        for (int c = 0; c < 3; c++) {
            struct neph_scene grey = scene;
            for (int m = 0; m < scene.medium_count; m++) {
                const double color = channel(scene.media[m].extinction_color, c);
                grey.media[m].extinction_color = (struct neph_rgb){color, color, color};
            }
            const struct neph_ray_light expected = neph_transport_ray(&grey, origin, d);
            neph_assert_close(channel(light.volume, c), channel(expected.volume, c), 1e-12,
                              light.quadrature_error + expected.quadrature_error);
            neph_assert_close(channel(light.transmittance, c), expected.transmittance.r, 1e-14,
                              0.0);
        }
    }
    neph_grid_destroy(media[2].grid);
}

static void test_coloured_surface_and_furnace(void **state)
{
    /* A lit floor under a coloured blob, sun and view vertical through its middle. */
    struct neph_solid floor = {
        .kind = NEPH_SOLID_BOX, .box = {{-50, -21, -50}, {50, -20, 50}}, .albedo = {0.5, 0.6, 0.7}};
    struct neph_scene scene = make_sunny(make_blob(0.2, (struct neph_vec3){0}, 1.5),
                                         (struct neph_vec3){0, 1, 0});
    scene.media[0].extinction_color = tint;
    scene.solid_count = 1;
    scene.solids = &floor;
    scene.scattering = NEPH_SCATTERING_NONE;
    const struct neph_ray_light light = neph_transport_ray(&scene, (struct neph_vec3){0, 20, 0},
                                                           (struct neph_vec3){0, -1, 0});
    const double tau = 0.2 * 1.5 * sqrt(2.0 * M_PI);
    for (int c = 0; c < 3; c++) {
        const double t = exp(-channel(tint, c) * tau);
        neph_assert_close(channel(light.transmittance, c), t, 1e-14, 0.0);
        neph_assert_close(channel(light.radiance, c), channel(floor.albedo, c) / M_PI * t * t,
                          1e-13, 0.0);
    }
    scene.scattering = NEPH_SCATTERING_MULTIPLE;
    scene.sun.present = false;
    scene.environment_light = true;
    scene.background_w_per_m2_sr = (struct neph_rgb){1, 2, 3};
    scene.solid_count = 0;
    const struct neph_ray_light furnace = neph_transport_ray(&scene, (struct neph_vec3){0, 20, 0},
                                                             (struct neph_vec3){0, -1, 0});
    for (int c = 0; c < 3; c++) {
        assert_true(channel(furnace.radiance, c) == 1.0 + c);
        neph_assert_close(channel(furnace.volume, c), -(1.0 + c) * expm1(-channel(tint, c) * tau),
                          1e-14, 0.0);
    }
}

/* ---- small bodies far away ----- */

/* The same cloud from near and from a million metres: the distance does not change its light. Four
 * roundings of the coordinates, in widths or cells, and a factor of 3 for optical depth 3. */
static void test_clouds_far_away(void **state)
{
    for (uint64_t trial = 0; trial < 20; trial += NEPH_TEST_EVERY) {
        uint64_t seed = 141421 + trial;
        const struct neph_medium media[2] = {make_blob(1.0, (struct neph_vec3){0}, 0.5),
                                             lattice(1.0, 4, (struct neph_vec3){-1, -1, -1},
                                                     (struct neph_vec3){0.6, 0.6, 0.6}, seed)};
        struct neph_scene scene = make_sunny(media[trial % 2], random_direction(&seed));
        const struct neph_vec3 d = random_direction(&seed), through = random_point(&seed, 0.8);
        const struct neph_ray_light near_by = neph_transport_ray(
            &scene, neph_vec3_along(through, d, -10.0), d);
        const struct neph_ray_light far_away = neph_transport_ray(
            &scene, neph_vec3_along(through, d, -1e6), d);
        assert_true(near_by.volume.r > 1e-3);
        neph_assert_close(far_away.volume.r, near_by.volume.r, 12.0 * 0x1p-53 * 1e6 / 0.5,
                          far_away.quadrature_error + near_by.quadrature_error);
        neph_grid_destroy(media[1].grid);
    }
}

/* A level ray of 1e5 m through thin fog, and a small black body of width 1 next to it, which casts
 * its shadow on the ray: a few metres of the ray are unlit. */
static void test_shadow_of_a_small_cloud(void **state)
{
    for (int kind = 0; kind < 2; kind++) {
        struct neph_medium cloud = kind == 0 ? make_blob(50.0, (struct neph_vec3){4e4, 300, 0}, 1.0)
                                             : lattice(50.0, 9, (struct neph_vec3){4e4, 300, -4},
                                                       (struct neph_vec3){1, 1, 1}, 7);
        cloud.albedo = (struct neph_rgb){0, 0, 0};
        struct neph_scene scene = make_sunny(make_height_fog(1e-5, 1e-3),
                                             (struct neph_vec3){0.2, 0.9, 0});
        const struct neph_vec3 origin = {0, 2, 0}, d = {1, 0, 0};
        const double clear = neph_transport_ray(&scene, origin, d).volume.r;
        scene.media[1] = cloud;
        scene.medium_count = 2;
        const struct neph_ray_light shaded = neph_transport_ray(&scene, origin, d);
        /* The shadow is 300 m below and 67 m in front of the cloud; elsewhere nothing changes. */
        const struct neph_rgb with = composite(&scene, origin, d, 39900.0, 39970.0, 700);
        scene.medium_count = 1;
        const struct neph_rgb without = composite(&scene, origin, d, 39900.0, 39970.0, 700);
        assert_true(without.r - with.r > 1e-7 * clear);
        neph_assert_close(clear - shaded.volume.r, without.r - with.r, 1e-6,
                          shaded.quadrature_error + 1e-12 * clear);
        if (kind == 1)
            neph_grid_destroy(cloud.grid);
    }
}

/* ---- extremes --- */

/* Finite, not negative, T in [0, 1], at most the sun's light: any scale, any ray. */
static void test_never_nonsense(void **state)
{
    static const double scales[] = {0.0, 1e-300, 1e-9, 1.0, 1e9, 1e300};
    static const struct neph_vec3 axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, -1}, {0, -1, 0}};
    uint64_t seed = 123;
    for (size_t i = 0; i < 3 * COUNT(scales) * COUNT(axes) * COUNT(axes); i++) {
        struct neph_medium media[3];
        make_media(media, scales[i / 3 % COUNT(scales)], seed);
        struct neph_scene scene = make_sunny(media[i % 3],
                                             axes[i / (3 * COUNT(scales)) % COUNT(axes)]);
        scene.media[1] = make_height_fog(0.01, 0.1);
        scene.medium_count = 1 + (int)(i % 2);
        const struct neph_vec3 d = axes[i / (3 * COUNT(scales) * COUNT(axes))];
        const struct neph_vec3 origins[] = {{0, 0, 0}, {-2, -1.5, -2}, neph_vec3_scale(d, -50.0)};
        for (size_t o = 0; o < COUNT(origins); o++) {
            const struct neph_ray_light light = neph_transport_ray(&scene, origins[o], d);
            for (int c = 0; c < 3; c++) {
                const double t = channel(light.transmittance, c), l = channel(light.volume, c);
                if (!(t >= 0.0 && t <= 1.0 && l >= 0.0 && l <= 1.0 / (4.0 * M_PI) + 1e-9))
                    print_error("case %zu, origin %zu, channel %d: T %g, L %g\n", i, o, c, t, l);
                assert_true(t >= 0.0 && t <= 1.0 && l >= 0.0 && l <= 1.0 / (4.0 * M_PI) + 1e-9);
            }
            assert_true(light.quadrature_error >= 0.0 && light.quadrature_error < 1e-9);
        }
        neph_grid_destroy(media[2].grid);
    }
}

#include "tests/main.h"
