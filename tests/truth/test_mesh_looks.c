/* SPDX-License-Identifier: MIT
 *
 * Light on smooth, textured and cut-out meshes: closed forms, spheres, and meshes without holes,
 * in exact transport, the oracle's paths and the paths between surfaces.
 */
#include "tests/mesh_builders.h"

#include "base/image.h"
#include "scenes/solids.h"
#include "truth/oracle.h"
#include "truth/path.h"
#include "truth/reflected.h"
#include "truth/transport.h"

static const struct neph_bounds box = {{-5, -5, -5}, {5, 5, 5}};

struct estimate {
    double mean, error;
};

static struct estimate finish_estimate(double sum, double squares, int count)
{
    const double mean = sum / count;
    return (struct estimate){mean, sqrt(fmax(0.0, squares / count - mean * mean) / (count - 1))};
}

/* --- smooth ---------------------------------------------------------------------------------- */

/* The radiance of a smooth ball in the sun and beside a lamp, over that of a sphere, is 1 up to the
 * square of the triangles' size, where the triangles see both lights. */
static void test_a_smooth_ball_is_lit_as_a_sphere(void **state)
{
    double worst[2] = {0.0, 0.0};
    int count = 0;
    for (int i = 0; i < 2; i++) {
        OWNED(mesh) struct neph_mesh *mesh = make_ball(24 << i, 1.0);
        struct neph_solid solids[2] = {put_mesh(mesh), make_sphere(0, 0, 0, 1)};
        struct neph_scene scenes[2];
        uint64_t seed = 8;
        solids[0].albedo = solids[1].albedo = white;
        for (int s = 0; s < 2; s++) {
            scenes[s] = make_sunny(make_homogeneous(0.1, box), (struct neph_vec3){1, 2, 3});
            scenes[s].solid_count = 1;
            scenes[s].solids = &solids[s];
            scenes[s].light_count = 1;
            scenes[s].lights[0] = (struct neph_light){.position_m = {2, 3, 4},
                                                      .intensity_w_per_sr = {3, 2, 1}};
        }
        for (int n = 0; n < 60; n++) {
            const struct neph_vec3 eye_m = neph_vec3_add((struct neph_vec3){1.5, 3, 4},
                                                         random_point(&seed, 0.3));
            const struct neph_vec3 d = neph_vec3_normalize(
                neph_vec3_sub(random_point(&seed, 0.2), eye_m));
            const struct neph_ray_light a = neph_transport_ray(&scenes[0], eye_m, d);
            const struct neph_ray_light b = neph_transport_ray(&scenes[1], eye_m, d);
            const double own = a.radiance.g - a.volume.g, other = b.radiance.g - b.volume.g;
            assert_true(other > 0.05);
            worst[i] = fmax(worst[i], fabs(own / other - 1.0));
            count++;
        }
    }
    print_message("%d rays: off by %.1e, with four times the triangles by %.1e\n", count, worst[0],
                  worst[1]);
    assert_true(worst[0] < 0.02 && worst[1] < worst[0] / 3.0); /* 4 by theory */
}

/* A smooth ball and a sphere of metal reflect the sun alike, up to the square of the triangles'
 * size. */
static void test_a_smooth_metal_ball_shines_as_a_sphere(void **state)
{
    double worst[2] = {0.0, 0.0};
    for (int i = 0; i < 2; i++) {
        OWNED(mesh) struct neph_mesh *mesh = make_ball(24 << i, 1.0);
        struct neph_solid solids[2] = {put_mesh(mesh), make_sphere(0, 0, 0, 1)};
        struct neph_scene scenes[2];
        uint64_t seed = 9;
        for (int s = 0; s < 2; s++) {
            solids[s].albedo = white;
            solids[s].surface = (struct neph_surface){.metalness = 1.0, .roughness = 0.6};
            scenes[s] = make_sunny(make_homogeneous(0.1, box), (struct neph_vec3){1, 2, 3});
            scenes[s].medium_count = 0;
            scenes[s].solid_count = 1;
            scenes[s].solids = &solids[s];
        }
        for (int n = 0; n < 60; n++) {
            const struct neph_vec3 eye_m = neph_vec3_add((struct neph_vec3){1.5, 3, 4},
                                                         random_point(&seed, 0.3));
            const struct neph_vec3 d = neph_vec3_normalize(
                neph_vec3_sub(random_point(&seed, 0.2), eye_m));
            const struct neph_reflected_view a = neph_reflected_view(&scenes[0], eye_m, d);
            const struct neph_reflected_view b = neph_reflected_view(&scenes[1], eye_m, d);
            assert_true(b.direct[1].g > 0.05);
            worst[i] = fmax(worst[i], fabs(a.direct[1].g / b.direct[1].g - 1.0));
        }
    }
    print_message("metal: off by %.1e, with four times the triangles by %.1e\n", worst[0],
                  worst[1]);
    assert_true(worst[0] < 0.05 && worst[1] < worst[0] / 3.0); /* 4 by theory */
}

enum { TILTED_PATHS = 40000 };

/* A triangle whose normals lean by an angle t, under a sky of radiance 1: of the reflected light a
 * part (1 - cos t) / 2 would come through the triangle, and does not. */
static void test_the_light_of_a_leaning_normal(void **state)
{
    struct neph_mesh_data data = allocate_mesh(3, 1);
    data.normals = calloc(3, sizeof(*data.normals));
    assert_non_null(data.normals);
    data.positions[1] = (struct neph_vec3){1, 0, 0};
    data.positions[2] = (struct neph_vec3){0, 1, 0};
    for (int i = 0; i < 3; i++)
        data.normals[i] = (struct neph_vec3){0.96, 0, 0.28};
    set_triangle(&data, 0, 0, 1, 2);
    OWNED(mesh) struct neph_mesh *mesh = finish_mesh(data);
    mesh->material.is_smooth = true;
    struct neph_solid solid = put_mesh(mesh);
    struct neph_scene scene = {.scattering = NEPH_SCATTERING_MULTIPLE,
                               .environment_light = true,
                               .background_w_per_m2_sr = white,
                               .solid_count = 1,
                               .solids = &solid};
    char reason[200];
    struct neph_tracker *tracker = NULL;
    const struct neph_reflected_limits limits = {NEPH_ALL_BOUNCES, INFINITY, NULL};
    const struct neph_vec3 eye_m = {0.2, 0.2, 1}, ahead = {0, 0, -1};
    const double expected = solid.albedo.g * (1.0 + 0.28) / 2.0;
    neph_assert_ok(neph_tracker_create(&scene, &tracker, NULL), NULL);
    const struct neph_view view = neph_view_create(&scene, eye_m, ahead);
    const struct neph_reflected_view reflected = neph_reflected_view(&scene, eye_m, ahead);
    for (int which = 0; which < 2; which++) {
        const int paths = neph_test_paths(TILTED_PATHS);
        double sum = 0.0, squares = 0.0;
        for (int n = 0; n < paths; n++) {
            struct neph_random random = neph_random_stream(9, 0, (uint64_t)n);
            struct neph_tracking_cost cost = {0, 0};
            double value;
            if (which == 0) {
                value = neph_path_trace(&scene, tracker, &view, NULL, &random, &cost).surface.g;
            } else {
                const struct neph_reflected light = neph_reflected_sample(&scene, &reflected,
                                                                          &limits, &random);
                value = neph_reflected_radiance(&reflected, &light).g;
                assert_true(light.part[NEPH_AMBIENT].g == (value > 0.0));
            }
            sum += value;
            squares += value * value;
        }
        const struct estimate got = finish_estimate(sum, squares, paths);
        print_message("%.5f +- %.5f, expected %.5f\n", got.mean, got.error, expected);
        neph_assert_close(got.mean, expected, 0.0, 4.5 * got.error);
    }
    neph_tracker_destroy(tracker);
    assert_false(neph_transport_is_exact(&scene, reason, sizeof(reason)));
}

/* --- textures -------------------------------------------------------------------------------- */

/* A texture of one colour is that albedo, to the last bit. */
static void test_a_texture_of_one_colour_is_lit_as_an_albedo(void **state)
{
    static const float one[] = {0.3f, 0.7f, 0.9f, 1.0f};
    OWNED(mesh)
    struct neph_mesh *quad = make_quad(1.0, make_texture(1, 1, one), NEPH_ALPHA_IGNORED);
    OWNED(mesh) struct neph_mesh *plain = make_quad(1.0, NULL, NEPH_ALPHA_IGNORED);
    struct neph_solid solids[2] = {put_mesh(quad), put_mesh(plain)};
    uint64_t seed = 8;
    solids[0].albedo = white;
    solids[1].albedo = (struct neph_rgb){(double)0.3f, (double)0.7f, (double)0.9f};
    for (int n = 0; n < 40; n++) {
        const struct neph_vec3 eye_m = {0.5, 0.5, 2};
        const struct neph_vec3 at = {neph_test_uniform(&seed, 0, 1), neph_test_uniform(&seed, 0, 1),
                                     0};
        const struct neph_vec3 d = neph_vec3_normalize(neph_vec3_sub(at, eye_m));
        struct neph_ray_light light[2];
        for (int s = 0; s < 2; s++) {
            struct neph_scene scene = make_sunny(make_homogeneous(0.1, box),
                                                 (struct neph_vec3){1, 2, 3});
            scene.solid_count = 1;
            scene.solids = &solids[s];
            scene.light_count = 1;
            scene.lights[0] = (struct neph_light){.position_m = {2, 3, 4},
                                                  .intensity_w_per_sr = {3, 2, 1}};
            light[s] = neph_transport_ray(&scene, eye_m, d);
        }
        assert_true(isfinite(light[0].hit_m));
        assert_memory_equal(&light[0].radiance, &light[1].radiance, sizeof(light[0].radiance));
    }
}

/* --- cut-outs -------------------------------------------------------------------------------- */

static double trace(const struct neph_scene *scene, const struct neph_tracker *tracker, int pixel,
                    int sample)
{
    struct neph_random random = neph_random_stream(11, (uint64_t)pixel, (uint64_t)sample);
    struct neph_tracking_cost cost = {0, 0};
    const struct neph_vec3 eye_m = {0.3, 0.4, 2};
    const struct neph_vec3 at_m = {-0.2 + 0.07 * pixel, 0.1 * (pixel % 10), 0};
    const struct neph_view view = neph_view_create(scene, eye_m,
                                                   neph_vec3_normalize(neph_vec3_sub(at_m, eye_m)));
    const struct neph_path_light light = neph_path_trace(scene, tracker, &view, NULL, &random,
                                                         &cost);
    return light.volume.g + light.surface.g + view.unscattered.g;
}

/* The paths of the oracle through fog around a cut-out quad and around a half of its size are the
 * same ones: alpha is 1/2 exactly
 * where the half ends. */
static void test_paths_around_a_cut_out_quad(void **state)
{
    enum { PIXELS = 20, SAMPLES = 200 };
    OWNED(mesh)
    struct neph_mesh *cut = make_quad(1.0, make_half_texture(1.0f, 0.0f), NEPH_ALPHA_CUTOUT);
    OWNED(mesh) struct neph_mesh *half = make_quad(0.5, NULL, NEPH_ALPHA_IGNORED);
    OWNED(mesh) struct neph_mesh *whole = make_quad(1.0, NULL, NEPH_ALPHA_IGNORED);
    struct neph_solid solids[3] = {put_mesh(cut), put_mesh(half), put_mesh(whole)};
    struct neph_scene scenes[3];
    struct neph_tracker *trackers[3];
    int others[2] = {0, 0};
    char reason[200];
    for (int s = 0; s < 3; s++) {
        scenes[s] = make_sunny(make_homogeneous(0.5, box), (struct neph_vec3){-0.2, 0.3, -1});
        scenes[s].scattering = NEPH_SCATTERING_MULTIPLE;
        scenes[s].media[0].albedo = make_grey(0.9);
        scenes[s].solid_count = 1;
        scenes[s].solids = &solids[s];
        neph_assert_ok(neph_tracker_create(&scenes[s], &trackers[s], NULL), NULL);
    }
    for (int pixel = 0; pixel < PIXELS; pixel++)
        for (int sample = 0; sample < SAMPLES; sample++) {
            const double value = trace(&scenes[0], trackers[0], pixel, sample);
            for (int s = 1; s < 3; s++)
                others[s - 1] += fabs(trace(&scenes[s], trackers[s], pixel, sample) - value) >
                                 1e-9 * value;
        }
    print_message("of %d paths %d are others than at a half, %d than at the whole\n",
                  PIXELS * SAMPLES, others[0], others[1]);
    assert_true(others[0] == 0 && others[1] > PIXELS * SAMPLES / 10);
    for (int s = 0; s < 3; s++)
        neph_tracker_destroy(trackers[s]);
    scenes[0].scattering = NEPH_SCATTERING_SINGLE;
    assert_false(neph_transport_is_exact(&scenes[0], reason, sizeof(reason)));
    assert_non_null(strstr(reason, "alpha"));
    scenes[0].scattering = NEPH_SCATTERING_NONE;
    assert_true(neph_transport_is_exact(&scenes[0], reason, sizeof(reason)));
}

/* --- coverage -------------------------------------------------------------------------------- */

/* A part `alpha` of the rays meets a quad, of the rest as many meet one behind it, and of the
 * sunlight on that a part 1 - alpha arrives; the sky is behind both. */
static void test_coverage_stops_a_part_of_rays(void **state)
{
    enum { SIDE = 12, SAMPLES = 1200 };
    const double alpha = 0.25, sun = 3.0, sky = 0.5;             /* 1/4 is a float */
    const double cosine = 0.8, lit = 0.25 * sun * cosine / M_PI; /* albedo of green: 1/4 */
    OWNED(mesh)
    struct neph_mesh *mesh = make_quad(1.0, make_half_texture(0.25f, 0.25f), NEPH_ALPHA_COVERAGE);
    struct neph_camera_key key = {.position_m = {0.5, 0.5, 4}, .look_at_m = {0.5, 0.5, 0}};
    struct neph_solid solids[2] = {put_mesh(mesh), put_mesh(mesh)};
    struct neph_scene scene = {.scattering = NEPH_SCATTERING_NONE,
                               .sun = {true, {0.6, 0, 0.8}, make_grey(sun)},
                               .background_w_per_m2_sr = make_grey(sky),
                               .camera_key_count = 1,
                               .camera_keys = &key,
                               .camera_up = {0, 1, 0},
                               .vertical_fov_rad = 0.15,
                               .frame_count = 1,
                               .solid_count = 2,
                               .solids = solids,
                               .hash = "coverage"};
    const struct neph_oracle_params params = {.width_px = SIDE,
                                              .height_px = SIDE,
                                              .seed = 3,
                                              .samples = SAMPLES,
                                              .time_limit_s = INFINITY};
    const double expected = alpha * lit +
                            (1.0 - alpha) * (alpha * lit * (1.0 - alpha) + (1.0 - alpha) * sky);
    struct neph_image *frame = NULL;
    double sum = 0.0, squares = 0.0;
    char reason[200];
    solids[1].center_m.z = -0.2;
    neph_assert_ok(neph_oracle_render(&scene, &params, &frame, NULL, NULL), NULL);
    const float *value = neph_image_channel(frame, "G");
    for (int i = 0; i < SIDE * SIDE; i++) {
        sum += (double)value[i];
        squares += (double)value[i] * (double)value[i];
    }
    const struct estimate got = finish_estimate(sum, squares, SIDE * SIDE);
    print_message("%.5f +- %.5f, expected %.5f\n", got.mean, got.error, expected);
    neph_assert_close(got.mean, expected, 0.0, 4.5 * got.error);
    assert_true(got.error < 0.002 * expected);
    const float *variance = neph_image_channel(frame, "variance.G");
    double own = 0.0;
    for (int i = 0; i < SIDE * SIDE; i++)
        own += (double)variance[i] / (SIDE * SIDE);
    /* Five standard errors, each 1 / sqrt(2 * 143), of an error that 144 pixels give. */
    neph_assert_close(sqrt(own / (SIDE * SIDE)), got.error, 0.3, 0.0);
    neph_image_destroy(frame);
    assert_false(neph_transport_is_exact(&scene, reason, sizeof(reason)));
    assert_false(neph_reflected_is_supported(&scene, reason, sizeof(reason)));
    assert_non_null(strstr(reason, "coverage"));
}

#include "tests/main.h"
