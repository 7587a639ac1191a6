/* SPDX-License-Identifier: MIT
 *
 * POV-Ray where its fixed tolerances matter: eyes on and next to faces of containers, lights at the
 * eye and next to rays of pixels. Frames are compared with the truth pixel by pixel.
 */
#include "tests/harness/engine_test.h"
#include "tests/scene_builders.h"

#include "harness/engines/engines.h"
#include "truth/transport.h"

#include <stdlib.h>

enum { WIDTH = 12, HEIGHT = 7 };

/* ---- scenes ---------------------------------------------------------------------------------- */

static const struct neph_bounds cube = {{-1, -1, -1}, {1, 1, 1}};

static void set_axis(struct neph_vec3 *v, int axis, double value)
{
    *(axis == 0 ? &v->x : axis == 1 ? &v->y : &v->z) = value;
}

/* A box of fog below a sun, seen from `eye`. */
static void set_stage(struct test_scene *stage, struct neph_vec3 eye, struct neph_vec3 look_at)
{
    test_stage(stage, eye, look_at);
    stage->scene.vertical_fov_rad = 20.0 * NEPH_RAD_PER_DEG;
    stage->scene.sun = (struct neph_sun){true, {0, 1, 0}, make_grey(1.0)};
    test_add(stage, make_homogeneous(1.0, cube))->albedo = make_grey(0.8);
}

static void add_wall(struct test_scene *stage)
{
    struct neph_solid *wall = &stage->solids[stage->scene.solid_count++];
    *wall = make_box(-4, -3, -2.6, 4, 3, -2.1);
    wall->albedo = make_grey(0.5);
}

static struct neph_light *add_light(struct test_scene *stage, struct neph_vec3 at_m)
{
    struct neph_light *light = &stage->scene.lights[stage->scene.light_count++];
    *light = (struct neph_light){.position_m = at_m, .intensity_w_per_sr = make_grey(1.0)};
    return light;
}

static void make_spot(struct neph_light *light, struct neph_vec3 axis, double inner_deg,
                      double outer_deg)
{
    light->is_spot = true;
    light->axis = neph_vec3_normalize(axis);
    light->inner_cosine = cos(inner_deg * NEPH_RAD_PER_DEG);
    light->outer_cosine = cos(outer_deg * NEPH_RAD_PER_DEG);
}

/* ---- frames ---------------------------------------------------------------------------------- */

static enum neph_status render(const struct test_scene *stage, unsigned layers, double intervals,
                               struct neph_image **frame, double *cpu_s, struct neph_diag *diag)
{
    struct neph_cost cost = {0};
    struct neph_shot shot = {.scene = &stage->scene,
                             .settings = neph_settings_default(&neph_engine_povray),
                             .width_px = WIDTH,
                             .height_px = HEIGHT,
                             .layers = layers,
                             .time_limit_s = 60.0};
    shot.settings.values[0] = intervals;
    const enum neph_status status = test_render(&neph_engine_povray, &shot, frame, &cost, diag);
    *cpu_s += cost.cpu_s;
    return status;
}

struct difference {
    double mean, truth_mean;
    double worst; /* of a pixel, in its tolerance; see compare() */
    double worst_transmittance;
};

/* Tolerances of a pixel: a fraction of its value, an absolute radiance, and a radiance per unit of
 * the ray's length in the medium, which is longer along a face. */
struct tolerance {
    double relative, absolute, across_a_face;
};

static double allowed(const struct tolerance *tolerance, struct neph_vec3 direction, double truth)
{
    const double slope = fmin(fabs(direction.x), fmin(fabs(direction.y), fabs(direction.z)));
    return tolerance->relative * truth + tolerance->absolute +
           (tolerance->across_a_face > 0.0 ? tolerance->across_a_face / slope : 0.0);
}

static struct difference compare(const struct test_scene *stage, const struct neph_image *frame,
                                 const struct tolerance *tolerance)
{
    const struct neph_camera camera = neph_scene_camera(&stage->scene, 0.0);
    const float *radiance = neph_image_channel(frame, "R");
    const float *transmittance = neph_image_channel(frame, "transmittance.R");
    struct difference off = {0};
    for (int p = 0; p < WIDTH * HEIGHT; p++) {
        const struct neph_pixel_ray ray = neph_camera_ray(&camera, WIDTH, HEIGHT, p % WIDTH,
                                                          p / WIDTH);
        const struct neph_ray_light truth = neph_transport_ray(&stage->scene, ray.origin_m,
                                                               ray.direction);
        const double apart = fabs(radiance[p] - truth.radiance.r);
        off.mean += radiance[p] / (WIDTH * HEIGHT);
        off.truth_mean += truth.radiance.r / (WIDTH * HEIGHT);
        off.worst = fmax(off.worst, apart / allowed(tolerance, ray.direction, truth.radiance.r));
        if (transmittance)
            off.worst_transmittance = fmax(off.worst_transmittance,
                                           fabs(transmittance[p] - truth.transmittance.r));
    }
    return off;
}

/* ---- eyes on faces --------------------------------------------------------------------------- */

/* 50 midpoints of a path of optical depth 4 at most: (4/50)^2 / 24, and the same for the ray to the
 * sun. The brackets leave 1e-4, or 1e-6 of the brightest pixel. A face is moved by 4e-3 units, 1e-8
 * m in these scenes, and 1 m of their media scatters less than 0.1 of the sun's 1 W/m^2. */
static const struct tolerance on_a_face = {6.5e-4, 5e-8, 1e-9};
/* Fog without bounds is cut at 16 scale heights, more along a slanted ray; 250 midpoints are few
 * for such a length. A pixel of these frames is off by 9e-3, and by 25 times as much with 50
 * midpoints. */
static const struct tolerance without_bounds = {2e-2, 5e-8, 1e-9};
/* Half a quantum of an eighth of full scale, from the brackets. */
static const double coarse_transmittance = 6.3e-5;

/* Eyes on faces of the box, and next to faces, see its fog. */
static void test_eye_on_a_face(void **state)
{
    static const struct {
        double out_m;
        int axis;
        bool has_wall;
    } rows[] = {{0.0, 2, false}, {1e-9, 2, false},  {-1e-9, 2, false}, {-1e-7, 2, true},
                {0.0, 1, false}, {-2e-8, 0, false}, {1e-6, 0, false}};
    double cpu_s = 0.0;
    for (size_t i = 0; i < COUNT(rows); i++) {
        struct test_scene stage;
        struct neph_diag diag = {0};
        struct neph_image *frame = NULL;
        struct neph_vec3 eye = {0, 0, 0};
        set_axis(&eye, rows[i].axis, 1.0 + rows[i].out_m);
        set_stage(&stage, eye, (struct neph_vec3){0.1, -0.2, -3.0});
        if (rows[i].has_wall)
            add_wall(&stage);
        neph_assert_ok(render(&stage, NEPH_LAYER_RADIANCE | NEPH_LAYER_TRANSMITTANCE, 50.0, &frame,
                              &cpu_s, &diag),
                       &diag);
        const struct difference off = compare(&stage, frame, &on_a_face);
        print_message("  axis %d, %+.0e m outside: mean %.6g of %.6g, worst %.2f, T %.1e\n",
                      rows[i].axis, rows[i].out_m, off.mean, off.truth_mean, off.worst,
                      off.worst_transmittance);
        assert_true(off.worst < 1.0);
        assert_true(off.worst_transmittance < coarse_transmittance);
        neph_image_destroy(frame);
    }
    print_message("  %.2f s cpu\n", cpu_s);
}

enum media_kind { EVEN, THINNING, TWO, VOXELS, WITHOUT_BOUNDS, MEDIA_KINDS };

/* Media with their faces at the faces of the cube above. */
static void set_media(struct test_scene *stage, enum media_kind kind, struct neph_grid *grid)
{
    struct neph_medium *medium = &stage->scene.media[0];
    if (kind == THINNING || kind == TWO) {
        *medium = make_height_fog(0.5, 0.7);
        medium->bounds = cube;
    }
    if (kind == TWO)
        test_add(stage, make_homogeneous(0.3, cube))->albedo = make_grey(0.5);
    if (kind == VOXELS)
        *medium = make_voxels(1.0, grid);
    if (kind == WITHOUT_BOUNDS) {
        *medium = make_height_fog(0.1, 0.7);
        medium->bounds.min_m.y = -1.0;
    }
}

/* Eyes on, in front of and behind faces, edges and corners, with both cameras. Every second scene
 * has a wall, which changes the units. */
static void test_eyes_on_random_faces(void **state)
{
    neph_test_waits_for_the_night();
    uint64_t seed = 36;
    double cpu_s = 0.0;
    int wrong = 0;
    print_message("  seed %llu\n", (unsigned long long)seed);
    /* The medium ends at the cube: one more node on each side is 0. */
    struct neph_grid *grid = random_lattice((const int[3]){5, 5, 5},
                                            (struct neph_vec3){-2. / 3, -2. / 3, -2. / 3},
                                            (struct neph_vec3){1. / 3, 1. / 3, 1. / 3}, 0.2, &seed);
    for (int i = 0; i < 120; i++) {
        struct test_scene stage;
        struct neph_diag diag = {0};
        struct neph_image *frame = NULL;
        struct neph_vec3 eye = random_point(&seed, 1.0);
        const int first = (int)neph_test_uniform(&seed, 0.0, 3.0);
        const int faces = 1 + (int)neph_test_uniform(&seed, 0.0, 3.0);
        double out_m = 0.0;
        for (int k = 0; k < faces; k++) {
            const double exponent = neph_test_uniform(&seed, -13.0, -3.0);
            const double sign = neph_test_uniform(&seed, 0.0, 3.0);
            out_m = sign < 1.0 ? 0.0 : sign < 2.0 ? pow(10.0, exponent) : -pow(10.0, exponent);
            const double side = neph_test_uniform(&seed, -1.0, 1.0) < 0.0 ? -1.0 : 1.0;
            set_axis(&eye, (first + k) % 3, side * (1.0 + out_m));
        }
        set_stage(&stage, eye, neph_vec3_add(eye, random_direction(&seed)));
        set_media(&stage, (enum media_kind)(i % MEDIA_KINDS), grid);
        if (i % 2)
            add_wall(&stage);
        /* The plane of ray origins lies in the face, or crosses it. Parallel rays need bounds. */
        if (i % 4 >= 2 && i % MEDIA_KINDS != WITHOUT_BOUNDS) {
            const struct neph_vec3 axes[3] = {{-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
            stage.scene.camera_up = (struct neph_vec3){0.3, 0.4, 0.5};
            stage.scene.vertical_fov_rad = 0.0;
            stage.scene.orthographic_height_m = 0.5;
            if (i % 8 >= 4)
                stage.key.look_at_m = neph_vec3_add(eye, axes[first]);
        }
        const bool is_open = i % MEDIA_KINDS == WITHOUT_BOUNDS;
        neph_assert_ok(render(&stage, NEPH_LAYER_RADIANCE | NEPH_LAYER_TRANSMITTANCE,
                              is_open ? 250.0 : 50.0, &frame, &cpu_s, &diag),
                       &diag);
        const struct difference off = compare(&stage, frame,
                                              is_open ? &without_bounds : &on_a_face);
        const bool is_right = off.worst < 1.0 &&
                              off.worst_transmittance < coarse_transmittance * (is_open ? 10 : 1);
        if (!is_right)
            print_message("  %d: %d faces from axis %d, %+.1e m: mean %.6g of %.6g, worst %.2f, "
                          "T %.1e\n",
                          i, faces, first, out_m, off.mean, off.truth_mean, off.worst,
                          off.worst_transmittance);
        wrong += !is_right;
        neph_image_destroy(frame);
    }
    neph_grid_destroy(grid);
    print_message("  %d wrong, %.2f s cpu\n", wrong, cpu_s);
    assert_int_equal(wrong, 0);
}

/* ---- lights ---------------------------------------------------------------------------------- */

/* A segment of a ray has an error of at most 1/12 of (1/10)^2 at its beginning (povray_lamps.c),
 * and the same error as on a face from absorption. Brackets leave 1e-4 of the median, which is 1e-3
 * or more here. */
static const struct tolerance near_a_light = {.relative = 1.5e-3, .absolute = 1e-7};
/* The ramp between the two angles of a cone may be only a few steps wide. */
static const struct tolerance near_a_spot = {.relative = 6e-3, .absolute = 1e-7};

/* A spot light at the eye in front of the fog; the same with a wall behind the fog; a point light
 * on the ray of the middle pixel in front of the fog; a spot light next to this ray in the fog. */
static void test_lights_near_rays(void **state)
{
    static const struct {
        const char *name;
        struct neph_vec3 at_m;
        bool is_spot, has_wall;
    } rows[] = {{"spot at the eye", {0, 0, 5}, true, false},
                {"spot at the eye, wall", {0, 0, 5}, true, true},
                {"spot behind the eye", {0, 0, 6}, true, false},
                {"lamp on a ray", {0, 0, 3}, false, false},
                {"lamp 1e-3 m from a ray", {0.001, 0, 0}, false, false},
                {"spot 1e-5 m from a ray", {0, 1e-5, 0.3}, true, true}};
    double cpu_s = 0.0;
    for (size_t i = 0; i < COUNT(rows); i++) {
        struct test_scene stage;
        struct neph_diag diag = {0};
        struct neph_image *frame = NULL;
        set_stage(&stage, (struct neph_vec3){0, 0, 5}, (struct neph_vec3){0, 0, 0});
        stage.scene.sun.present = false;
        if (rows[i].has_wall)
            add_wall(&stage);
        struct neph_light *light = add_light(&stage, rows[i].at_m);
        if (rows[i].is_spot)
            make_spot(light, (struct neph_vec3){0, 0, -1}, 20.0, 30.0);
        neph_assert_ok(render(&stage, NEPH_LAYER_RADIANCE, 50.0, &frame, &cpu_s, &diag), &diag);
        const struct difference off = compare(&stage, frame, &near_a_light);
        print_message("  %s: mean %.6g of %.6g, worst %.2f\n", rows[i].name, off.mean,
                      off.truth_mean, off.worst);
        assert_true(off.worst < 1.0);
        neph_image_destroy(frame);
    }
    print_message("  %.2f s cpu\n", cpu_s);
}

/* The position of a random light. */
enum place {
    AT_THE_EYE,
    NEAR_THE_EYE,
    BEFORE_THE_FOG,
    IN_THE_FOG,
    BEHIND_THE_FOG,
    ON_A_FACE,
    PLACES
};

/* A random light next to the ray of a random pixel. */
struct trial {
    enum place place;
    double distance_m; /* from the ray; on a face: from the face, outward */
    bool is_inside;    /* the eye is in the fog */
    bool is_spot, has_wall, is_thinning, has_more_lights;
};

static struct trial draw_trial(enum place place, uint64_t *seed)
{
    const double size_m = pow(10.0, neph_test_uniform(seed, -7.0, -1.0));
    const uint64_t bits = neph_test_random(seed);
    struct trial trial = {.place = place,
                          .distance_m = place == AT_THE_EYE ? 0.0 : size_m,
                          .is_inside = (bits & 3) == 0 && place != AT_THE_EYE,
                          .is_spot = bits & 4,
                          .has_wall = bits & 8,
                          .is_thinning = bits & 16,
                          .has_more_lights = (bits & 0xe0) == 0};
    if (place == ON_A_FACE)
        trial.distance_m = (bits & 256 ? 1e-4 : -1e-4) * size_m * (double)(bits >> 9 & 1);
    return trial;
}

static double light_z_m(const struct trial *trial, double eye_z_m, uint64_t *seed)
{
    switch (trial->place) {
    case BEFORE_THE_FOG:
        return neph_test_uniform(seed, 1.0, eye_z_m);
    case IN_THE_FOG:
        return neph_test_uniform(seed, -1.0, 1.0);
    case BEHIND_THE_FOG:
        return neph_test_uniform(seed, -2.0, -1.0);
    case ON_A_FACE:
        return 1.0 + trial->distance_m;
    default:
        return eye_z_m;
    }
}

static void set_trial(struct test_scene *stage, const struct trial *trial, uint64_t *seed)
{
    const struct neph_vec3 eye = {0.1, 0.2, trial->is_inside ? 0.5 : 4.0};
    set_stage(stage, eye, (struct neph_vec3){0.05, -0.1, -3.0});
    stage->scene.sun.present = false;
    set_media(stage, trial->is_thinning ? THINNING : EVEN, NULL);
    if (trial->has_wall)
        add_wall(stage);
    const struct neph_camera camera = neph_scene_camera(&stage->scene, 0.0);
    const struct neph_pixel_ray ray = neph_camera_ray(&camera, WIDTH, HEIGHT,
                                                      floor(neph_test_uniform(seed, 0.0, WIDTH)),
                                                      floor(neph_test_uniform(seed, 0.0, HEIGHT)));
    const double t_m = (light_z_m(trial, eye.z, seed) - eye.z) / ray.direction.z;
    struct neph_vec3 across = neph_vec3_cross(ray.direction, random_direction(seed));
    if (trial->place == ON_A_FACE)
        across.z = 0.0;
    struct neph_light *light = add_light(
        stage,
        neph_vec3_along(neph_vec3_along(eye, ray.direction, t_m), neph_vec3_normalize(across),
                        trial->place == ON_A_FACE ? 0.03 : trial->distance_m));
    if (trial->is_spot)
        make_spot(light, neph_vec3_along(ray.direction, random_direction(seed), 0.5),
                  neph_test_uniform(seed, 5.0, 30.0), neph_test_uniform(seed, 31.0, 60.0));
    while (trial->has_more_lights && stage->scene.light_count < NEPH_SCENE_LIGHTS_MAX)
        add_light(stage, random_point(seed, 1.0));
}

static void test_random_lights(void **state)
{
    neph_test_waits_for_the_night();
    static const char *const names[PLACES] = {"at the eye", "near the eye",   "before the fog",
                                              "in the fog", "behind the fog", "on a face"};
    uint64_t seed = 3601;
    double cpu_s = 0.0;
    int wrong = 0, refused = 0;
    print_message("  seed %llu\n", (unsigned long long)seed);
    for (int i = 0; i < 90; i++) {
        struct test_scene stage;
        struct neph_diag diag = {0};
        struct neph_image *frame = NULL;
        const struct trial trial = draw_trial((enum place)(i % PLACES), &seed);
        set_trial(&stage, &trial, &seed);
        const enum neph_status status = render(&stage, NEPH_LAYER_RADIANCE, 50.0, &frame, &cpu_s,
                                               &diag);
        if (status) {
            print_message("  %2d %s\n", i, diag.message);
            assert_int_equal(status, NEPH_ERR_UNSUPPORTED);
            assert_non_null(strstr(diag.message, "within a medium"));
            refused++;
            continue;
        }
        const struct difference off = compare(&stage, frame,
                                              trial.is_spot ? &near_a_spot : &near_a_light);
        print_message("  %2d %2d %s %-14s %+.1e m, eye %s, %s, %s: mean %.6g of %.6g, worst %.2f\n",
                      i, stage.scene.light_count, trial.is_spot ? "spot" : "lamp",
                      names[trial.place], trial.distance_m, trial.is_inside ? "in " : "out",
                      trial.has_wall ? "wall" : "sky ", trial.is_thinning ? "thinning" : "even    ",
                      off.mean, off.truth_mean, off.worst);
        wrong += !(off.worst < 1.0);
        neph_image_destroy(frame);
    }
    print_message("  %d wrong, %d refused, %.2f s cpu\n", wrong, refused, cpu_s);
    assert_int_equal(wrong, 0);
    assert_true(refused < 9);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest engine_tests[] = {
#include "cases/test_povray_near.inc"
    };
    if (neph_test_wants_engines(argc, argv))
        return test_has_engine(&neph_engine_povray)
                   ? cmocka_run_group_tests(engine_tests, NULL, NULL)
                   : 0;
    return 0;
}
