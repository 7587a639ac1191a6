/* SPDX-License-Identifier: MIT
 *
 * Light between solids against closed forms: form factors of planes, walls and rectangles, the
 * mirrored camera, mirrored lights, the white furnace, the energy in a closed room.
 *
 * Tolerances: 4.5 standard errors of the estimate itself, as in test_path.c; without noise, double
 * precision.
 */
#include "tests/scene_builders.h"

#include "truth/directions.h"
#include "truth/metal.h"
#include "truth/path.h"
#include "truth/reflected.h"
#include "truth/transport.h"

static const double sigmas = 4.5;
static const double far_m = 1e6;
static const struct neph_reflected_limits all_light = {.bounces = NEPH_ALL_BOUNCES,
                                                       .ao_distance_m = INFINITY};

/* ---- estimates ------------------------------------------------------------------------------- */

struct estimate {
    double mean, error;
};

static void assert_mean(struct estimate estimate, double expected)
{
    neph_assert_close(estimate.mean, expected, 1e-12, sigmas * estimate.error);
}

static struct estimate estimate_of(double sum, double squares, int n)
{
    const double mean = sum / n;
    return (struct estimate){mean, sqrt(fmax(0.0, squares / n - mean * mean) / (n - 1))};
}

/* The mean of the green channel of a part; NEPH_REFLECTED_PARTS: of the total. */
static struct estimate part_seen(const struct neph_scene *scene, struct neph_vec3 origin_m,
                                 struct neph_vec3 direction, struct neph_reflected_limits limits,
                                 int part, int all_samples)
{
    const int samples = neph_test_paths(all_samples);
    const struct neph_reflected_view view = neph_reflected_view(scene, origin_m,
                                                                neph_vec3_normalize(direction));
    double sum = 0.0, squares = 0.0;
    assert_non_null(view.hit.solid);
    for (int n = 0; n < samples; n++) {
        struct neph_random random = neph_random_stream(3, 0, (uint64_t)n);
        const struct neph_reflected light = neph_reflected_sample(scene, &view, &limits, &random);
        const double value = part < NEPH_REFLECTED_PARTS ? light.part[part].g
                                                         : neph_reflected_radiance(&view, &light).g;
        assert_true(isfinite(value) && value >= 0.0);
        sum += value;
        squares += value * value;
    }
    return estimate_of(sum, squares, samples);
}

static struct neph_solid grey_box(double x0, double y0, double z0, double x1, double y1, double z1,
                                  double albedo)
{
    struct neph_solid box = make_box(x0, y0, z0, x1, y1, z1);
    box.albedo = make_grey(albedo);
    return box;
}

static struct neph_solid floor_of(double albedo)
{
    return grey_box(-far_m, -1, -far_m, far_m, 0, far_m, albedo);
}

static struct neph_scene scene_of(struct neph_solid *solids, int count)
{
    return (struct neph_scene){.scattering = NEPH_SCATTERING_MULTIPLE,
                               .environment_light = true,
                               .background_w_per_m2_sr = white,
                               .solid_count = count,
                               .solids = solids};
}

/* Seen from the floor's point (x, 0, z). */
static struct estimate ambient(struct neph_solid *solids, int count, double x, double z,
                               double distance_m)
{
    const struct neph_scene scene = scene_of(solids, count);
    return part_seen(&scene, (struct neph_vec3){x, 0.5, z}, (struct neph_vec3){0, -1, 0},
                     (struct neph_reflected_limits){0, distance_m, NULL}, NEPH_AMBIENT, 40000);
}

/* ---- ambient occlusion ----------------------------------------------------------------------- */

static void test_ambient_of_a_plane_is_one(void **state)
{
    struct neph_solid plane = floor_of(0.5);
    const struct estimate open = ambient(&plane, 1, 3, 4, INFINITY);
    assert_true(open.mean == 1.0 && open.error == 0.0);
}

/* Walls to the sky: one leaves half of it, two leave a quarter. */
static void test_ambient_of_a_corner(void **state)
{
    struct neph_solid solids[] = {floor_of(0.5), grey_box(-far_m, 0, -far_m, 0, far_m, far_m, 0.5),
                                  grey_box(0, 0, -far_m, far_m, far_m, 0, 0.5)};
    assert_mean(ambient(solids, 2, 0.2, 5, INFINITY), 0.5);
    assert_mean(ambient(solids, 3, 0.2, 5, INFINITY), 0.25);
    assert_mean(ambient(solids, 3, 0.2, 0.01, INFINITY), 0.25);
}

/* An infinite strip hides (1 - cos elevation) / 2 of the cosine-weighted sky. */
static void test_ambient_of_a_step(void **state)
{
    static const double distances_m[] = {0.05, 0.5, 1, 3, 20};
    const double height_m = 1.5;
    struct neph_solid solids[] = {floor_of(0.5),
                                  grey_box(-far_m, 0, -far_m, 0, height_m, far_m, 0.5)};
    for (size_t i = 0; i < COUNT(distances_m); i++) {
        const double d = distances_m[i];
        assert_mean(ambient(solids, 2, d, 0, INFINITY), 0.5 * (1 + d / hypot(d, height_m)));
    }
}

/* Within a distance D a wall hides a segment of the unit disc, of the directions whose component
 * perpendicular to the wall is above d / D (Nusselt's analogue). */
static void test_ambient_within_a_distance(void **state)
{
    static const double distances_m[] = {0.5, 0.9, 1.1, 2, 10};
    const double d = 1.0;
    struct neph_solid solids[] = {floor_of(0.5), grey_box(-far_m, 0, -far_m, 0, far_m, far_m, 0.5)};
    for (size_t i = 0; i < COUNT(distances_m); i++) {
        const double c = fmin(1.0, d / distances_m[i]);
        assert_mean(ambient(solids, 2, d, 0, distances_m[i]),
                    1.0 - (acos(c) - c * sqrt(1 - c * c)) / M_PI);
    }
}

/* The fraction of the cosine-weighted hemisphere that a rectangle perpendicular to the ground
 * covers, of height h and from the nearest point b to one side (Howell, catalogue of configuration
 * factors, B-4). */
static double rectangle_factor(double b, double h, double d)
{
    const double slant = hypot(d, h);
    return (atan(b / d) - d / slant * atan(b / slant)) / (2.0 * M_PI);
}

static void test_ambient_of_a_board(void **state)
{
    struct neph_solid solids[] = {floor_of(0.5), grey_box(-1, 0, -2, 0, 1.2, 3, 0.5)};
    assert_mean(ambient(solids, 2, 0.7, 0, INFINITY),
                1.0 - rectangle_factor(2, 1.2, 0.7) - rectangle_factor(3, 1.2, 0.7));
}

/* ---- diffuse light --------------------------------------------------------------------------- */

/* A board in the sun lights the ground uniformly: its radiance times its form factor. */
static void test_one_bounce_off_a_board(void **state)
{
    const double albedo = 0.6, irradiance = 5.0, d = 0.7;
    struct neph_solid solids[] = {floor_of(0.5), grey_box(-1, 0, -2, 0, 1.2, 3, albedo)};
    struct neph_scene scene = scene_of(solids, 2);
    scene.environment_light = false;
    scene.sun = (struct neph_sun){true, {0.8, 0.6, 0}, make_grey(irradiance)};
    const struct neph_vec3 eye_m = {d, 0.5, 0}, down = {0, -1, 0};
    const struct neph_reflected_limits one = {1, INFINITY, NULL}, none = {0, INFINITY, NULL};
    assert_mean(part_seen(&scene, eye_m, down, one, NEPH_DIFFUSE_INDIRECT, 40000),
                albedo * irradiance * 0.8 / M_PI *
                    (rectangle_factor(2, 1.2, d) + rectangle_factor(3, 1.2, d)));
    assert_mean(part_seen(&scene, eye_m, down, none, NEPH_DIFFUSE_INDIRECT, 100), 0.0);
    assert_mean(part_seen(&scene, eye_m, down, one, NEPH_DIFFUSE_DIRECT, 100),
                irradiance * 0.6 / M_PI);
    assert_mean(part_seen(&scene, eye_m, down, none, NEPH_REFLECTED_PARTS, 100),
                0.5 * irradiance * 0.6 / M_PI);
}

/* A board that is completely visible on the screen, or from half its height on, or not at all: the
 * fraction of its light, and of its occlusion, that the screen provides. The camera looks along x.
 */
static void test_what_a_screen_knows(void **state)
{
    const double d = 0.7, height_m = 1.2;
    struct neph_solid solids[] = {floor_of(0.5), grey_box(-1, 0, -2, 0, height_m, 2, 0.6)};
    struct neph_scene scene = scene_of(solids, 2);
    scene.environment_light = false;
    scene.sun = (struct neph_sun){true, {0.8, 0.6, 0}, white};
    struct neph_screen screen = {.camera = {.position_m = {10, 0.5 * height_m, 0},
                                            .right = {0, 0, -1},
                                            .up = {0, 1, 0},
                                            .forward = {-1, 0, 0},
                                            .vertical_fov_rad = 0.5},
                                 .aspect = 1.0};
    const struct neph_reflected_limits limits = {1, INFINITY, &screen};
    const struct neph_vec3 eye_m = {d, 0.5, 0}, down = {0, -1, 0};
    const double radiance = 0.6 * 0.8 / M_PI, whole = 2 * rectangle_factor(2, height_m, d);
    assert_mean(part_seen(&scene, eye_m, down, limits, NEPH_DIFFUSE_ON_SCREEN, 40000),
                radiance * whole);
    assert_mean(part_seen(&scene, eye_m, down, limits, NEPH_AMBIENT_ON_SCREEN, 40000), 1 - whole);

    screen.camera.orthographic_height_m = height_m; /* the screen was from 0 to height, now it
                                                       begins at half of it */
    screen.camera.position_m.y = 0;
    screen.aspect = 100.0;
    const double half = 2 * rectangle_factor(2, 0.5 * height_m, d);
    assert_mean(part_seen(&scene, eye_m, down, limits, NEPH_DIFFUSE_ON_SCREEN, 40000),
                radiance * half);
    assert_mean(part_seen(&scene, eye_m, down, limits, NEPH_AMBIENT_ON_SCREEN, 40000), 1 - half);
    assert_mean(part_seen(&scene, eye_m, down, limits, NEPH_AMBIENT, 40000), 1 - whole);

    /* Behind the camera, and behind a solid: nothing. */
    screen.camera.position_m = (struct neph_vec3){-2, 0, 0};
    assert_mean(part_seen(&scene, eye_m, down, limits, NEPH_DIFFUSE_ON_SCREEN, 400), 0.0);
    screen.camera.position_m = (struct neph_vec3){10, 0, 0};
    struct neph_solid hidden[] = {solids[0], solids[1], grey_box(5, 0, -9, 6, 9, 9, 0.6)};
    scene.solids = hidden;
    scene.solid_count = 3;
    scene.sun.direction = (struct neph_vec3){0.6, 0.8, 0};
    assert_mean(part_seen(&scene, eye_m, down, limits, NEPH_DIFFUSE_ON_SCREEN, 400), 0.0);
}

static const double room_m[3] = {2, 3, 4};

static void make_room(struct neph_solid solids[6], double albedo)
{
    const double x = room_m[0], y = room_m[1], z = room_m[2];
    solids[0] = grey_box(-1, -1, -1, 0, y + 1, z + 1, albedo);
    solids[1] = grey_box(x, -1, -1, x + 1, y + 1, z + 1, albedo);
    solids[2] = grey_box(0, -1, -1, x, 0, z + 1, albedo);
    solids[3] = grey_box(0, y, -1, x, y + 1, z + 1, albedo);
    solids[4] = grey_box(0, 0, -1, x, y, 0, albedo);
    solids[5] = grey_box(0, 0, z, x, y, z + 1, albedo);
}

/* A uniformly distributed point of a wall, with the eye slightly in front of it. */
static struct neph_vec3 before_a_wall(uint64_t *seed, struct neph_vec3 *direction)
{
    const double areas[3] = {room_m[1] * room_m[2], room_m[0] * room_m[2], room_m[0] * room_m[1]};
    double pick = neph_test_uniform(seed, 0, areas[0] + areas[1] + areas[2]);
    int axis = 0;
    while (axis < 2 && pick >= areas[axis])
        pick -= areas[axis++];
    const bool high = neph_test_uniform(seed, -1, 1) > 0;
    double at[3], way[3] = {0, 0, 0};
    for (int k = 0; k < 3; k++)
        at[k] = neph_test_uniform(seed, 0, room_m[k]);
    at[axis] = high ? room_m[axis] - 1e-3 : 1e-3;
    way[axis] = high ? 1 : -1;
    *direction = (struct neph_vec3){way[0], way[1], way[2]};
    return (struct neph_vec3){at[0], at[1], at[2]};
}

/* The mean irradiance of all walls: power / area of the point light, times the albedo for each
 * bounce, times 1 / (1 - albedo) for all. */
static void test_energy_in_a_room(void **state)
{
    const double albedo = 0.7, intensity = 2.0;
    const double area = 2 * (room_m[1] * room_m[2] + room_m[0] * room_m[2] + room_m[0] * room_m[1]);
    const double once = 4 * M_PI * intensity / area;
    struct neph_solid solids[6];
    make_room(solids, albedo);
    struct neph_scene scene = scene_of(solids, 6);
    scene.light_count = 1;
    scene.lights[0] = (struct neph_light){.position_m = {0.6, 2.1, 2.9},
                                          .intensity_w_per_sr = make_grey(intensity)};
    static const int bounces[] = {0, 1, NEPH_ALL_BOUNCES};
    const double expected[] = {once, once * (1 + albedo), once / (1 - albedo)};
    const int points = neph_test_paths(30000);
    for (int i = 0; i < 3; i++) {
        const struct neph_reflected_limits limits = {bounces[i], INFINITY, NULL};
        uint64_t seed = 11;
        double sum = 0.0, squares = 0.0;
        for (int n = 0; n < points; n++) {
            struct neph_vec3 direction;
            const struct neph_vec3 eye_m = before_a_wall(&seed, &direction);
            const struct neph_reflected_view view = neph_reflected_view(&scene, eye_m, direction);
            struct neph_random random = neph_random_stream(7, (uint64_t)n, 0);
            const struct neph_reflected light = neph_reflected_sample(&scene, &view, &limits,
                                                                      &random);
            const double value = M_PI * (light.part[NEPH_DIFFUSE_DIRECT].r +
                                         light.part[NEPH_DIFFUSE_INDIRECT].r);
            sum += value;
            squares += value * value;
        }
        const struct estimate all = estimate_of(sum, squares, points);
        assert_true(all.error < neph_test_noise(0.02 * expected[i]));
        assert_mean(all, expected[i]);
    }
}

/* ---- textures -------------------------------------------------------------------------------- */

static int make_textured(struct neph_solid *solids)
{
    solids[0] = floor_of(0.6);
    solids[0].surface.texture = (struct neph_paint){
        .cell_m = 0.37, .pattern = NEPH_PATTERN_NOISE, .other = {0.1, 0.4, 0.05}, .seed = 2};
    solids[1] = grey_box(-1, 0, -1, 1, 1.5, 0.5, 0.8);
    solids[1].turn = (struct neph_turn){1, cos(0.5), sin(0.5)};
    solids[1].surface.texture = (struct neph_paint){
        .cell_m = 0.31, .pattern = NEPH_PATTERN_CHECKER, .other = {0.9, 0.1, 0.3}};
    return 2;
}

/* The closed form, the oracle and light between solids, each with its own code. */
static void test_textures_in_the_sun(void **state)
{
    struct neph_solid solids[2];
    struct neph_scene scene = scene_of(solids, make_textured(solids));
    scene.environment_light = false;
    scene.scattering = NEPH_SCATTERING_NONE;
    scene.sun = (struct neph_sun){true, {0.48, 0.6, 0.64}, {3, 2, 4}};
    scene.light_count = 1;
    scene.lights[0] = (struct neph_light){.position_m = {1, 3, 2}, .intensity_w_per_sr = white};
    uint64_t seed = 5;
    int lit = 0;
    for (int i = 0; i < 500; i++) {
        const struct neph_vec3 eye_m = {neph_test_uniform(&seed, -1, 1), 2, 5};
        const struct neph_vec3 way = neph_vec3_normalize((struct neph_vec3){
            neph_test_uniform(&seed, -0.4, 0.4), neph_test_uniform(&seed, -0.6, -0.05), -1});
        const struct neph_rgb exact = neph_transport_ray(&scene, eye_m, way).radiance;
        const struct neph_rgb oracle = neph_view_create(&scene, eye_m, way).unscattered;
        const struct neph_reflected_view view = neph_reflected_view(&scene, eye_m, way);
        const struct neph_rgb own = neph_rgb_mul(view.color[0], view.direct[0]);
        neph_assert_close(oracle.r, exact.r, 1e-12, 1e-15);
        neph_assert_close(own.r, exact.r, 1e-9, 1e-12);
        neph_assert_close(own.g, exact.g, 1e-9, 1e-12);
        neph_assert_close(own.b, exact.b, 1e-9, 1e-12);
        lit += exact.g > 0.0;
    }
    assert_true(lit > 300);
}

/* All bounces, by the oracle's paths. */
static void test_textures_in_all_light(void **state)
{
    struct neph_solid solids[2];
    struct neph_scene scene = scene_of(solids, make_textured(solids));
    scene.sun = (struct neph_sun){true, {0.48, 0.6, 0.64}, {3, 2, 4}};
    const struct neph_vec3 eye_m = {1.9, 0.5, 0.4}, down = {0, -1, 0};
    const int samples = neph_test_paths(40000);
    const struct estimate own = part_seen(&scene, eye_m, down, all_light, NEPH_REFLECTED_PARTS,
                                          40000);
    struct neph_diag diag = {0};
    struct neph_tracker *tracker;
    struct neph_tracking_cost cost = {0, 0};
    neph_assert_ok(neph_tracker_create(&scene, &tracker, &diag), &diag);
    const struct neph_view view = neph_view_create(&scene, eye_m, down);
    double sum = 0.0, squares = 0.0;
    for (int n = 0; n < samples; n++) {
        struct neph_random random = neph_random_stream(99, 0, (uint64_t)n);
        const double value =
            view.unscattered.g +
            neph_path_trace(&scene, tracker, &view, NULL, &random, &cost).surface.g;
        sum += value;
        squares += value * value;
    }
    neph_tracker_destroy(tracker);
    const struct estimate oracle = estimate_of(sum, squares, samples);
    assert_true(own.mean > 1.02 * view.unscattered.g);
    neph_assert_close(own.mean, oracle.mean, 0.0, sigmas * hypot(own.error, oracle.error));
}

/* ---- metal ----------------------------------------------------------------------------------- */

/* Surfaces that scatter all light are as bright as their surroundings, whatever their shape. */
static void test_white_furnace(void **state)
{
    struct neph_solid solids[] = {floor_of(1), make_sphere(0, 1, 0, 1),
                                  grey_box(1.2, 0, -2, 1.6, 3, 2, 1),
                                  grey_box(-3, 0, -2, -2, 3, 2, 1)};
    solids[1].albedo = white;
    solids[2].surface.metalness = 1.0;
    solids[3].surface.metalness = 0.4;
    const struct neph_scene scene = scene_of(solids, 4);
    const struct neph_vec3 eye_m = {0, 1.5, 6};
    for (double x = -0.5; x <= 0.5; x += 0.05) {
        const struct estimate seen = part_seen(&scene, eye_m, (struct neph_vec3){x, -0.1, -1},
                                               all_light, NEPH_REFLECTED_PARTS, 200);
        neph_assert_close(seen.mean, 1.0, 1e-12, 0.0);
    }
}

static double seen(double alpha, double cosine)
{
    const double tangent = sqrt(1 - cosine * cosine) / cosine;
    return 1 / (1 + 0.5 * (sqrt(1 + alpha * alpha * tangent * tangent) - 1));
}

/* The light that facets reflect once, by quadrature over facets; with `all`, also the light that
 * other facets intercept, which makes it 1 (the weak white furnace of Heitz, JCGT 3(2), 2014). */
static double reflected_once(double alpha, double cos_from, bool all)
{
    const int n = 600;
    const struct neph_vec3 from = {sqrt(1 - cos_from * cos_from), 0, cos_from};
    double sum = 0.0;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            /* tan^2 of the facet's angle is alpha^2 x / (1 - x) of a uniform x; 1 - x = rest^2
             * resolves the steepest facets. */
            const double rest = (i + 0.5) / n, tangent = alpha * sqrt(1 - rest * rest) / rest;
            const double cosine = 1 / sqrt(1 + tangent * tangent), sine = tangent * cosine;
            const double azimuth = M_PI * (j + 0.5) / n;
            const struct neph_vec3 h = {sine * cos(azimuth), sine * sin(azimuth), cosine};
            const double across = neph_vec3_dot(from, h);
            const double cos_to = 2 * across * h.z - from.z;
            if (across <= 0.0 || (!all && cos_to <= 0.0))
                continue;
            /* D cos dw = dx dazimuth / (2 pi) */
            sum += 2 * rest * across * seen(alpha, cos_from) * (all ? 1 : seen(alpha, cos_to)) /
                   (cosine * cos_from);
        }
    return sum / n / n;
}

/* A plane of rough metal under a uniform sky, by sampling and by the reflectance itself. */
static void test_rough_metal_under_an_even_sky(void **state)
{
    static const double roughnesses[] = {0.3, 0.6, 1.0}, cosines[] = {0.95, 0.3};
    for (size_t i = 0; i < COUNT(roughnesses); i++)
        for (size_t k = 0; k < COUNT(cosines); k++) {
            const double alpha = roughnesses[i] * roughnesses[i], c = cosines[k];
            struct neph_solid metal = floor_of(0.8);
            metal.surface = (struct neph_surface){.metalness = 1, .roughness = roughnesses[i]};
            const struct neph_scene scene = scene_of(&metal, 1);
            const struct neph_vec3 down = {sqrt(1 - c * c), -c, 0};
            neph_assert_close(reflected_once(alpha, c, true), 1.0, 0.0, 2e-5);
            const struct estimate drawn = part_seen(&scene, (struct neph_vec3){0, 1, 0}, down,
                                                    all_light, NEPH_GLOSSY_DIRECT, 20000);
            neph_assert_close(drawn.mean, reflected_once(alpha, c, false), 1e-5,
                              sigmas * drawn.error);
        }
}

/* The same light by cosine-sampled directions times the reflectance. */
static void test_reflectance_of_rough_metal(void **state)
{
    const struct neph_vec3 up = {0, 1, 0};
    const struct neph_vec3 from = neph_vec3_normalize((struct neph_vec3){0.8, 0.6, 0});
    const int samples = neph_test_paths(200000);
    struct neph_random random = neph_random_stream(1, 2, 3);
    double sum = 0.0, squares = 0.0;
    for (int n = 0; n < samples; n++) {
        const struct neph_vec3 to = neph_cosine_sample(up, &random);
        const double value = neph_metal_per_sr(0.6, up, from, to) * M_PI / to.y;
        sum += value;
        squares += value * value;
    }
    const struct estimate once = estimate_of(sum, squares, samples);
    neph_assert_close(once.mean, reflected_once(0.36, 0.6, false), 1e-4, sigmas * once.error);
    /* Reciprocity: f(a, b) = f(b, a). */
    const struct neph_vec3 to = neph_vec3_normalize((struct neph_vec3){-0.1, 0.4, 0.7});
    neph_assert_close(neph_metal_per_sr(0.6, up, from, to) / to.y,
                      neph_metal_per_sr(0.6, up, to, from) / from.y, 1e-13, 0.0);
}

/* ---- mirrors --------------------------------------------------------------------------------- */

/* A mirror in the plane z = 0, solids in front of it, the sun in its plane. */
static int make_mirror_stage(struct neph_solid *solids)
{
    solids[0] = floor_of(0.5);
    solids[0].surface.texture = (struct neph_paint){/* no pixel crosses a line of it */
                                                    .cell_m = 0.2917,
                                                    .pattern = NEPH_PATTERN_CHECKER,
                                                    .other = make_grey(0.1)};
    solids[1] = make_sphere(0.4, 0.6, 1.2, 0.5);
    solids[1].albedo = make_grey(0.7);
    solids[2] = grey_box(-1.2, 0, 0.8, -0.6, 0.9, 1.5, 0.3);
    solids[3] = grey_box(-2, 0, -0.3, 2, 2, 0, 0.9);
    solids[3].surface.metalness = 1.0;
    return 4;
}

/* The view of a mirrored camera, times the mirror's colour. */
static void test_a_mirror_is_a_mirrored_camera(void **state)
{
    struct neph_solid solids[4];
    struct neph_scene scene = scene_of(solids, make_mirror_stage(solids));
    scene.sun = (struct neph_sun){true, {0.6, 0.8, 0}, white};
    scene.background_w_per_m2_sr = make_grey(0);
    struct neph_scene before = scene;
    before.solid_count = 3;
    const struct neph_vec3 eye_m = {0.5, 1.43, 3.5}, image_m = {0.5, 1.43, -3.5};
    const struct neph_reflected_limits one = {1, INFINITY, NULL};
    int mirrored = 0, lit = 0;
    for (int i = 0; i < 400; i++) {
        const struct neph_vec3 way = neph_vec3_normalize(
            (struct neph_vec3){-0.5 + 0.05 * (i % 20) + 0.003, -0.45 + 0.04 * (i / 20), -1});
        const struct neph_hit hit = neph_scene_hit(&scene, eye_m, way);
        if (hit.solid != &solids[3] || hit.normal.z < 0.5)
            continue;
        const struct neph_reflected_view beyond = neph_reflected_view(
            &before, image_m, (struct neph_vec3){way.x, way.y, -way.z});
        const double expected = beyond.hit.solid ? beyond.color[0].g * beyond.direct[0].g : 0.0;
        const struct estimate seen_there = part_seen(&scene, eye_m, way, one, NEPH_REFLECTED_PARTS,
                                                     4);
        neph_assert_close(seen_there.mean, 0.9 * expected, 1e-9, 1e-12);
        mirrored++;
        lit += expected > 0.0;
    }
    assert_true(mirrored > 100 && lit > 50);
}

/* Sunlight and a point light's light that a half-metal mirror reflects to the ground, but not
 * beyond its outline. */
static void test_light_that_a_mirror_throws(void **state)
{
    struct neph_solid solids[] = {floor_of(0.5), grey_box(-9, 0, -1, 9, 3, 0, 0.9)};
    solids[1].surface.metalness = 0.5;
    struct neph_scene scene = scene_of(solids, 2);
    scene.environment_light = false;
    const struct neph_vec3 down = {0, -1, 0}, near_m = {1, 0.5, 1}, beyond_m = {1, 0.5, 3};

    scene.sun = (struct neph_sun){true, {0, 0.8, 0.6}, white};
    const double sun = 0.8 / M_PI;
    struct neph_reflected_view view = neph_reflected_view(&scene, near_m, down);
    neph_assert_close(view.direct[0].g, sun * (1 + 0.5 * 0.9), 1e-11, 0.0);
    view = neph_reflected_view(&scene, beyond_m, down);
    neph_assert_close(view.direct[0].g, sun, 1e-11, 0.0);
    /* A block between the two: the mirror's light arrives, the sun's does not; and vice versa. */
    struct neph_solid shaded[3] = {solids[0], solids[1], grey_box(-9, 0.5, 1.5, 9, 9, 1.6, 0.5)};
    scene.solids = shaded;
    scene.solid_count = 3;
    view = neph_reflected_view(&scene, near_m, down); /* it hides the sun from both points */
    neph_assert_close(view.direct[0].g, 0.0, 0.0, 0.0);
    shaded[2] = grey_box(-9, 0.4, 0.3, 9, 1.2, 0.4, 0.5);
    view = neph_reflected_view(&scene, near_m, down); /* it hides the mirror */
    neph_assert_close(view.direct[0].g, sun, 1e-11, 0.0);

    scene.solids = solids;
    scene.solid_count = 2;
    scene.sun.present = false;
    scene.light_count = 1;
    scene.lights[0] = (struct neph_light){.position_m = {1, 2, 1}, .intensity_w_per_sr = white};
    view = neph_reflected_view(&scene, (struct neph_vec3){1, 0.5, 1.5}, down);
    const double straight = 2 / pow(4 + 0.25, 1.5), thrown = 2 / pow(4 + 6.25, 1.5);
    neph_assert_close(view.direct[0].g, (straight + 0.45 * thrown) / M_PI, 1e-11, 0.0);
}

/* Rotating the world rotates the mirror with it. */
static void test_a_turned_mirror(void **state)
{
    struct neph_solid solids[] = {floor_of(0.5), grey_box(-9, 0, -1, 9, 3, 1, 0.9)};
    solids[1].surface.metalness = 1.0;
    const double turn_rad = 0.4;
    solids[1].turn = (struct neph_turn){1, cos(turn_rad), sin(turn_rad)};
    struct neph_scene scene = scene_of(solids, 2);
    scene.environment_light = false;
    const struct neph_vec3 sun = neph_turned(&solids[1].turn, (struct neph_vec3){0, 0.8, 0.6});
    scene.sun = (struct neph_sun){true, sun, white};
    const struct neph_vec3 at_m = neph_turned(&solids[1].turn, (struct neph_vec3){1, 0.5, 2});
    const struct neph_reflected_view view = neph_reflected_view(&scene, at_m,
                                                                (struct neph_vec3){0, -1, 0});
    neph_assert_close(view.direct[0].g, 0.8 / M_PI * 1.9, 1e-11, 0.0);
}

/* ---- refusals -------------------------------------------------------------------------------- */

static void test_what_no_path_finds_is_refused(void **state)
{
    char reason[256] = "";
    struct neph_solid solids[] = {floor_of(0.5), make_sphere(0, 1, 0, 1), make_sphere(3, 1, 0, 1)};
    struct neph_scene scene = scene_of(solids, 3);
    scene.sun = (struct neph_sun){true, {0, 1, 0}, white};
    assert_true(neph_reflected_can(&scene, reason, sizeof(reason)));
    solids[0].surface.metalness = 1.0;
    assert_true(neph_reflected_can(&scene, reason, sizeof(reason)));
    solids[0].surface.metalness = 0.0;
    solids[1].surface.metalness = 1.0;
    assert_false(neph_reflected_can(&scene, reason, sizeof(reason)));
    assert_non_null(strstr(reason, "give them a roughness"));
    solids[1].surface.roughness = 0.1;
    assert_true(neph_reflected_can(&scene, reason, sizeof(reason)));
    solids[1].surface.roughness = 0.0;
    scene.sun.present = false;
    assert_true(neph_reflected_can(&scene, reason, sizeof(reason)));
    scene.medium_count = 1;
    assert_false(neph_reflected_can(&scene, reason, sizeof(reason)));
    assert_non_null(strstr(reason, "media"));
}

#include "tests/main.h"
