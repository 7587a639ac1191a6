/* SPDX-License-Identifier: MIT
 *
 * The POV-Ray engine: brackets and digits, the scene text and, where POV-Ray is installed, frames
 * against closed forms. Tolerances: the midpoint rule and the 16-bit brackets, as stated at each
 * test.
 */
#include "tests/harness/engine_test.h"
#include "tests/scene_builders.h"

#include "base/files.h"
#include "harness/engines/engines.h"
#include "harness/engines/povray_exposure.h"
#include "harness/engines/povray_lamps.h"
#include "harness/engines/povray_scene.h"
#include "harness/engines/povray_solids.h"
#include "scenes/media.h"
#include "scenes/solids.h"
#include "truth/transport.h"

#include <ctype.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

enum { WIDTH = 32, HEIGHT = 18 };

/* ---- Scenes in memory ----------------------------------------------------------------------- */

static struct neph_medium *add_medium(struct test_scene *stage, struct neph_bounds bounds,
                                      double extinction_per_m, double falloff_per_m, double albedo)
{
    struct neph_medium *medium = test_add(
        stage, falloff_per_m > 0.0 ? make_height_fog(extinction_per_m, falloff_per_m)
                                   : make_homogeneous(extinction_per_m, bounds));
    medium->bounds = bounds;
    medium->albedo = make_grey(albedo);
    return medium;
}

static struct neph_solid *add_box(struct test_scene *stage, struct neph_bounds box, double albedo)
{
    struct neph_solid *solid = &stage->solids[stage->scene.solid_count++];
    *solid = (struct neph_solid){.kind = NEPH_SOLID_BOX, .box = box, .albedo = make_grey(albedo)};
    return solid;
}

static struct neph_solid *add_sphere(struct test_scene *stage, struct neph_vec3 center,
                                     double radius, double albedo)
{
    struct neph_solid *solid = &stage->solids[stage->scene.solid_count++];
    *solid = (struct neph_solid){.kind = NEPH_SOLID_SPHERE,
                                 .center_m = center,
                                 .radius_m = radius,
                                 .albedo = make_grey(albedo)};
    return solid;
}

/* ---- Brackets ------------------------------------------------------------------------------- */

/* POV-Ray's output for a bracketed value. */
static void write_codes(double value, double gain, uint16_t codes[3])
{
    for (int i = 0; i < 3; i++)
        codes[i] = (uint16_t)lround(65535.0 *
                                    fmin(1.0, gain * neph_povray_bracket_scales[i] * value));
}

static void test_brackets_recover_values(void **state)
{
    uint64_t seed = 1;
    for (int i = 0; i < 100000; i++) {
        double value = exp(neph_test_uniform(&seed, log(1e-8), 0.0));
        double gain = exp(neph_test_uniform(&seed, log(0.1), log(1e7)));
        uint16_t codes[3];
        write_codes(value, gain, codes);
        struct neph_povray_reading reading = neph_povray_read_brackets(codes, gain);
        if (isinf(reading.error)) {
            assert_true(gain * value > 0.979);
            assert_true(reading.value <= value * (1.0 + 1e-5));
            continue;
        }
        neph_assert_close(reading.value, value, 1e-12, reading.error);
        /* In each bracket but the last: half a quantum of an eighth of full scale. */
        if (gain * value > 0.98 / 512.0)
            assert_true(reading.error <= 6.3e-5 * value);
    }
}

/* Exposes simulated pixels as the engine does; returns the number of renders. */
static int expose_simulated(const double *values, size_t count, double gain,
                            const struct neph_povray_target *target,
                            struct neph_povray_reading *readings)
{
    int renders = 0;
    for (size_t i = 0; i < count; i++)
        readings[i] = (struct neph_povray_reading){0.0, INFINITY};
    for (; gain > 0.0 && renders < 20; renders++) {
        for (size_t i = 0; i < count; i++) {
            uint16_t codes[3];
            write_codes(values[i], gain, codes);
            readings[i] = neph_povray_finer_reading(readings[i],
                                                    neph_povray_read_brackets(codes, gain));
        }
        gain = neph_povray_next_gain(readings, count, gain, target);
    }
    return renders;
}

static void test_exposures_meet_the_target(void **state)
{
    enum { COUNT = 4000 };
    static double values[COUNT];
    static struct neph_povray_reading readings[COUNT];
    const struct neph_povray_target target = {.relative = 1e-4, .absolute = 1e-12};
    uint64_t seed = 2;
    for (int i = 0; i < COUNT; i++)
        values[i] = exp(neph_test_uniform(&seed, log(1e-8), 0.0));
    const double gains[] = {0.9, 1e-3, 900.0}; /* right; too dark; clamped */
    for (int g = 0; g < 3; g++) {
        int renders = expose_simulated(values, COUNT, gains[g], &target, readings);
        assert_true(renders <= 6);
        for (int i = 0; i < COUNT; i++)
            neph_assert_close(readings[i].value, values[i], 1e-4, 1e-12);
    }
}

/* One pixel is 1e8 times as bright as the others. */
static void test_one_bright_pixel_leaves_the_others(void **state)
{
    enum { COUNT = 100 };
    double values[COUNT];
    struct neph_povray_reading readings[COUNT];
    const struct neph_povray_target target = {
        .relative = 1e-4, .absolute = 1e-20, .absolute_of_peak = 1e-6, .absolute_of_median = 1e-4};
    uint64_t seed = 4;
    for (int i = 0; i < COUNT; i++)
        values[i] = neph_test_uniform(&seed, 1e-9, 1e-8);
    values[17] = 1.0;
    assert_true(expose_simulated(values, COUNT, 0.9, &target, readings) <= 4);
    for (int i = 0; i < COUNT; i++)
        neph_assert_close(readings[i].value, values[i], 2e-4, 0.0);
}

static void test_black_frames_end(void **state)
{
    static const double values[4] = {0.0, 0.0, 0.0, 0.0};
    struct neph_povray_reading readings[4];
    const struct neph_povray_target target = {
        .relative = 1e-4, .absolute = 1e-13, .absolute_of_peak = 1e-6};
    assert_int_equal(expose_simulated(values, 4, 0.9, &target, readings), 2);
    assert_true(readings[0].value == 0.0);
}

static void test_depth_digits_recover_depth(void **state)
{
    uint64_t seed = 3;
    const double range_m = 1e6;
    for (int i = 0; i < 100000; i++) {
        double depth = neph_test_uniform(&seed, 0.0, NEPH_POVRAY_DEPTH_TOP), read_m = -1.0;
        uint16_t codes[3];
        for (int place = 0; place < 3; place++) {
            double digit = depth * pow(NEPH_POVRAY_DEPTH_BASE, place);
            codes[place] = (uint16_t)lround(65535.0 * (digit - floor(digit)));
        }
        assert_true(neph_povray_read_depth(codes, range_m, &read_m));
        /* Half a quantum of the last digit: 1 / (2 * 65535 * 65536). */
        neph_assert_close(read_m, depth * range_m, 0.0, 1.2e-10 * range_m);
    }
    const uint16_t sky[3] = {65535, 65535, 65535};
    double depth_m = 0.0;
    assert_false(neph_povray_read_depth(sky, range_m, &depth_m));
}

/* ---- Phase functions ------------------------------------------------------------------------ */

static void test_phase_constants(void **state)
{
    /* POV-Ray's k against 4 pi p times the excess, over all cosines. */
    const struct neph_phase rayleigh = {NEPH_PHASE_RAYLEIGH, 0.0};
    const struct neph_phase forward = {NEPH_PHASE_HENYEY_GREENSTEIN, 0.85};
    const struct neph_phase isotropic = {NEPH_PHASE_ISOTROPIC, 0.0};
    for (double c = -1.0; c <= 1.0; c += 0.0625) {
        double excess = neph_povray_phase_excess(NEPH_PHASE_RAYLEIGH);
        neph_assert_close(0.799372013 * (1.0 + c * c),
                          4.0 * M_PI * excess * neph_phase_per_sr(&rayleigh, c), 1e-12, 0.0);
        double k = (1.0 - 0.85 * 0.85) / pow(1.0 + 0.85 * 0.85 - 2.0 * 0.85 * c, 1.5);
        neph_assert_close(k, 4.0 * M_PI * neph_phase_per_sr(&forward, c), 1e-12, 0.0);
        neph_assert_close(1.0, 4.0 * M_PI * neph_phase_per_sr(&isotropic, c), 1e-12, 0.0);
    }
    neph_assert_close(neph_povray_phase_excess(NEPH_PHASE_RAYLEIGH), 1.06583, 1e-5, 0.0);
}

/* ---- The text ------------------------------------------------------------------------------- */

static const struct neph_bounds room = {{-5.0, 0.0, -10.0}, {5.0, 4.0, -4.0}};

/* All elements of a scene. */
static void set_full_stage(struct test_scene *stage)
{
    test_stage(stage, (struct neph_vec3){0.0, 2.0, 5.0}, (struct neph_vec3){0.0, 1.0, -5.0});
    struct neph_medium *medium = add_medium(stage, room, 0.2, 0.0, 0.8);
    medium->phase = (struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN, 0.6};
    medium->albedo = (struct neph_rgb){0.9, 0.8, 0.5};
    medium = add_medium(stage, room, 0.1, 0.5, 1.0);
    medium->phase.kind = NEPH_PHASE_RAYLEIGH;
    medium->layer_count = 2;
    medium->layers[1] = (struct neph_fog_layer){0.05, 0.1, 2.0};
    add_box(stage, (struct neph_bounds){{-20.0, -1.0, -20.0}, {20.0, 0.0, 20.0}}, 0.5);
    add_sphere(stage, (struct neph_vec3){1.0, 1.0, -7.0}, 0.7, 0.8);
    stage->scene.background_w_per_m2_sr = (struct neph_rgb){0.1, 0.2, 0.3};
}

static struct neph_povray_world make_povray_world(const struct test_scene *stage)
{
    struct neph_diag diag = {0};
    struct neph_povray_world world;
    neph_assert_ok(neph_povray_world(&stage->scene, 0, WIDTH, HEIGHT, 50, &world, &diag), &diag);
    return world;
}

static char *write_povray_text(const struct neph_povray_world *world, int kind)
{
    struct neph_diag diag = {0};
    const struct neph_povray_pass pass = {.kind = (enum neph_povray_kind)kind, .gain = 1.0};
    char *text = NULL;
    neph_assert_ok(neph_povray_text(world, &pass, &text, &diag), &diag);
    return text;
}

static bool is_known_word(const char *word, size_t length)
{
    static const char known[] =
        " version global_settings assumed_gamma max_trace_level adc_bailout declare macro end U O "
        "P "
        "A camera perspective location right up direction light_source rgb parallel point_at "
        "background box sphere hollow pigment rgbt finish ambient diffuse emission interior media "
        "method intervals samples absorption scattering eccentricity extinction density function "
        "exp x y z e texture Depth average pigment_map color_map abs mod select floor scale "
        "translate pattern density_file df interpolate noise Noise Cell radiosity count "
        "error_bound pretrace_end pretrace_start nearest_count recursion_limit low_error_factor "
        "brightness gray_threshold minimum_reuse maximum_reuse always_sample off on reflection "
        "photons autostop jitter target refraction collect difference union cone spotlight radius "
        "falloff tightness fade_distance fade_power no_image no_reflection no_shadow function Soft "
        "min "
        "max sqrt ";
    char padded[64];
    if (length > 40)
        return false;
    snprintf(padded, sizeof(padded), " %.*s ", (int)length, word);
    return strstr(known, padded);
}

/* Every word outside of comments is the engine's; every character is harmless. */
static void assert_plain(const char *text)
{
    for (const char *at = text; *at;) {
        if (at[0] == '/' && at[1] == '/') {
            at += strcspn(at, "\n");
        } else if (isalpha((unsigned char)*at)) {
            size_t length = 1;
            while (isalpha((unsigned char)at[length]) || at[length] == '_')
                length++;
            if (!is_known_word(at, length))
                fail_msg("unexpected word in the text: %.30s", at);
            at += length;
        } else {
            assert_non_null(strchr("0123456789 .,;+-*/<>(){}[]#=\"\n", *at));
            at++;
        }
    }
}

static void test_text_has_no_string_of_the_scene(void **state)
{
    struct test_scene plain, hostile;
    set_full_stage(&plain);
    set_full_stage(&hostile);
    hostile.scene.name = "x\n#include \"/etc/passwd\"\n#fopen F \"owned\" write";
    hostile.scene.title = hostile.scene.description = hostile.scene.path = hostile.scene.name;
    for (int kind = 0; kind <= NEPH_POVRAY_DEPTH; kind++) {
        const struct neph_povray_world world = make_povray_world(&plain),
                                       hostile_world = make_povray_world(&hostile);
        char *text = write_povray_text(&world, kind),
             *other = write_povray_text(&hostile_world, kind);
        assert_string_equal(text, other);
        assert_plain(text);
        free(text);
        free(other);
    }
}

/* An eye on a face, a spot light at the eye, and point lights near rays: a face moved in double
 * precision, a mask, cubes. */
static void test_text_near_eyes_and_lights(void **state)
{
    struct test_scene stage;
    struct neph_diag diag = {0};
    struct neph_povray_world world;
    test_stage(&stage, (struct neph_vec3){0.0, 2.0, -4.0}, (struct neph_vec3){0.0, 1.0, -8.0});
    add_medium(&stage, room, 0.2, 0.0, 0.8);
    stage.scene.light_count = 2;
    stage.scene.lights[0] = (struct neph_light){.position_m = {0.0, 2.0, -3.999},
                                                .intensity_w_per_sr = make_grey(1.0),
                                                .is_spot = true,
                                                .axis = {0.0, 0.0, -1.0},
                                                .inner_cosine = 0.9,
                                                .outer_cosine = 0.8};
    stage.scene.lights[1] = (struct neph_light){.position_m = {0.1, 1.4, -6.0},
                                                .intensity_w_per_sr = make_grey(1.0)};
    world = make_povray_world(&stage);
    assert_true(world.containers[0].is_near_an_eye[2][1]);
    assert_false(world.containers[0].is_near_an_eye[2][0] ||
                 world.containers[0].is_near_an_eye[0][1]);
    neph_assert_ok(neph_povray_cut_rays(&world, &diag), &diag);
    assert_true(world.lamps[0].cube_count > 0 && world.lamps[1].cube_count > 0);
    assert_false(world.lamps[1].is_masked);
    world.lamps[0].is_masked = true;
    for (int kind = 0; kind <= NEPH_POVRAY_DEPTH; kind++) {
        const bool scatters = kind == NEPH_POVRAY_BEAUTY || kind == NEPH_POVRAY_VOLUME;
        char *text = write_povray_text(&world, kind);
        assert_plain(text);
        assert_int_equal(strstr(text, "union {") != NULL, scatters);
        assert_int_equal(strstr(text, "no_image") != NULL, scatters);
        assert_int_equal(strstr(text, " spotlight ") != NULL, kind == NEPH_POVRAY_SURFACE);
        free(text);
    }
}

/* All kinds of surfaces in clear air: a mirror in the sun, noise, a checker. */
static void set_surfaces(struct test_scene *stage)
{
    test_stage(stage, (struct neph_vec3){0.0, 1.0, 5.0}, (struct neph_vec3){0.0, 1.0, -5.0});
    stage->scene.scattering = NEPH_SCATTERING_MULTIPLE;
    stage->scene.environment_light = true;
    stage->scene.background_w_per_m2_sr = make_grey(0.5);
    const struct neph_paint noise = {
        .cell_m = 0.5, .pattern = NEPH_PATTERN_NOISE, .other = {0.1, 0.2, 0.3}, .seed = 5};
    add_box(stage, (struct neph_bounds){{-20, -1, -20}, {20, 0, 20}}, 0.5)->surface.texture = noise;
    add_box(stage, (struct neph_bounds){{-3, 0, -3}, {-1, 2, -1}}, 0.6)->surface.texture = noise;
    add_box(stage, (struct neph_bounds){{1, 0, -3}, {3, 2, -1}}, 0.9)->surface.metalness = 1.0;
}

/* Noise is declared once per seed; media and light between solids are not mentioned where there are
 * none. */
static void test_text_of_surfaces(void **state)
{
    struct test_scene stage;
    struct neph_povray_world world;
    set_surfaces(&stage);
    world = make_povray_world(&stage);
    world.radiosity = (struct neph_povray_radiosity){100, 0.25, 5000};
    for (int kind = 0; kind <= NEPH_POVRAY_DEPTH; kind++) {
        const bool is_lit = kind == NEPH_POVRAY_BEAUTY || kind == NEPH_POVRAY_SURFACE;
        char *text = write_povray_text(&world, kind);
        assert_plain(text);
        const char *noise = strstr(text, "#declare Noise5 = ");
        assert_int_equal(noise != NULL, is_lit);
        assert_int_equal(strstr(text, "radiosity { count 100 ") != NULL, is_lit);
        assert_int_equal(strstr(text, "photons { count 5000 ") != NULL, is_lit);
        assert_int_equal(strstr(text, "reflection { rgb <") != NULL, is_lit);
        if (noise)
            assert_null(strstr(noise + 1, "#declare Noise5 = "));
        free(text);
    }
}

/* The noise file has the values, the first column and row repeated at the end, and zeros around. */
static void test_noise_s_file(void **state)
{
    const int n = NEPH_NOISE_CELLS;
    struct neph_diag diag = {0};
    struct neph_grid *grid = NULL;
    neph_assert_ok(neph_povray_noise(5, &grid, &diag), &diag);
    assert_int_equal(grid->size[0], n + 1);
    for (int j = 0; j <= n; j++)
        for (int i = 0; i <= n; i++)
            assert_true(grid->values[j * (n + 1) + i] == (float)neph_noise_value(5, i % n, j % n));
    neph_grid_destroy(grid);
}

static void test_text_refuses_nan(void **state)
{
    struct test_scene stage;
    set_full_stage(&stage);
    stage.scene.background_w_per_m2_sr.r = NAN;
    struct neph_povray_world world;
    char *text = NULL;
    struct neph_povray_pass pass = {.kind = NEPH_POVRAY_BEAUTY, .gain = 1.0};
    world = make_povray_world(&stage);
    assert_int_equal(neph_povray_text(&world, &pass, &text, NULL), NEPH_ERR_UNSUPPORTED);
    assert_null(text);
}

static void test_faces_of_containers_are_separate(void **state)
{
    struct test_scene stage;
    set_full_stage(&stage); /* both media share all faces and touch the ground at y = 0 */
    struct neph_povray_world world = make_povray_world(&stage);
    const struct neph_bounds *a = &world.containers[0].bounds, *b = &world.containers[1].bounds;
    double gap_m = 1e-3 / world.units_per_m;
    assert_true(a->min_m.y < -gap_m && a->min_m.y > -1e-4);
    assert_true(b->min_m.y < a->min_m.y - gap_m && b->min_m.y > -1e-4);
    assert_true(b->max_m.x > a->max_m.x + gap_m);
    assert_true(a->max_m.x == room.max_m.x); /* no other face there: not moved */
    assert_true(world.shift_error < 1e-6);
}

static const double inner_unit = 0.5 * 4e-3; /* half a step of a face, in units */

/* A face moves outward from an eye on it or inside, and inward from one outside, by one step; a
 * second medium on the same face by one more. */
static void test_faces_keep_off_the_eye(void **state)
{
    for (int out = -1; out <= 1; out++) {
        struct test_scene stage;
        struct neph_povray_world world;
        test_stage(&stage, (struct neph_vec3){0.0, 2.0, -4.0 + out * 1e-10},
                   (struct neph_vec3){0.0, 1.0, -8.0});
        add_medium(&stage, room, 0.2, 0.0, 0.8);
        add_medium(&stage, room, 0.2, 0.0, 0.8);
        world = make_povray_world(&stage);
        for (int i = 0; i < 2; i++) {
            const double moved = (world.containers[i].bounds.max_m.z - room.max_m.z) *
                                 world.units_per_m;
            neph_assert_close(moved, (out > 0 ? -4e-3 : 4e-3) * (i + 1), 0.0, inner_unit);
        }
        /* 8e-3 of 2e6 units, of a world of 10 m at 0.2/m. */
        assert_true(world.shift_error > 0.0 && world.shift_error < 1e-8);
    }
}

/* Pixels of an orthographic camera whose rays begin 1e-4 m apart, in a world of 1e5 m, on both
 * sides of a face: no position between them is left for the face. */
static void test_crowds_of_origins_are_refused(void **state)
{
    struct test_scene stage;
    struct neph_diag diag = {0};
    struct neph_povray_world world;
    test_stage(&stage, (struct neph_vec3){0.0, 0.0, 0.0}, (struct neph_vec3){0.0, -1.0, -1.0});
    add_medium(&stage, (struct neph_bounds){{-1e5, -1e5, -1e5}, {1e5, 0.0, 1e5}}, 0.2, 0.0, 0.8);
    stage.scene.vertical_fov_rad = 0.0;
    stage.scene.orthographic_height_m = 0.5;
    world = make_povray_world(&stage);
    stage.scene.orthographic_height_m = 4.0;
    assert_int_equal(neph_povray_world(&stage.scene, 0, 4000, 40000, 50, &world, &diag),
                     NEPH_ERR_UNSUPPORTED);
    assert_non_null(strstr(diag.message, "the face y = 0 m of medium 1"));
}

/* Within 1e-10 m above the ground POV-Ray does not see it; from higher up the scene is rendered. */
static void test_eye_on_a_solid_is_refused(void **state)
{
    struct test_scene stage;
    struct neph_diag diag = {0};
    struct neph_povray_world world;
    test_stage(&stage, (struct neph_vec3){0.0, 1e-10, 0.0}, (struct neph_vec3){0.0, 2.0, -3.0});
    add_box(&stage, (struct neph_bounds){{-5.0, -1.0, -5.0}, {5.0, 0.0, 5.0}}, 0.5);
    world = make_povray_world(&stage);
    stage.key.look_at_m.y = -2.0;
    assert_int_equal(neph_povray_world(&stage.scene, 0, WIDTH, HEIGHT, 50, &world, &diag),
                     NEPH_ERR_UNSUPPORTED);
    assert_non_null(strstr(diag.message, "an eye on a solid"));
}

/* A point light in fog on a pixel's ray is refused, a spot light that shines across it is not. */
static void test_lights_on_rays_are_refused(void **state)
{
    struct test_scene stage;
    struct neph_diag diag = {0};
    struct neph_povray_world world;
    test_stage(&stage, (struct neph_vec3){0.0, 2.0, 5.0}, (struct neph_vec3){0.0, 2.0, -5.0});
    add_medium(&stage, room, 0.2, 0.0, 0.8);
    const struct neph_camera camera = neph_scene_camera(&stage.scene, 0.0);
    const struct neph_pixel_ray ray = neph_camera_ray(&camera, WIDTH, HEIGHT, 20, 7);
    struct neph_light *light = &stage.scene.lights[stage.scene.light_count++];
    *light = (struct neph_light){.position_m = neph_vec3_along(ray.origin_m, ray.direction, 12.0),
                                 .intensity_w_per_sr = make_grey(1.0)};
    world = make_povray_world(&stage);
    assert_int_equal(neph_povray_cut_rays(&world, &diag), NEPH_ERR_UNSUPPORTED);
    assert_non_null(strstr(diag.message, "the ray of pixel (20, 7) passes light 1"));
    light->is_spot = true;
    light->axis = (struct neph_vec3){0.0, 1.0, 0.0};
    light->inner_cosine = 0.9;
    light->outer_cosine = 0.8;
    world = make_povray_world(&stage);
    neph_assert_ok(neph_povray_cut_rays(&world, &diag), &diag);
}

/* --- supported scenes ------------------------------------------------------------------------ */

static void test_which_surfaces_it_can_render(void **state)
{
    char reason[128] = "";
    struct test_scene stage;
    set_surfaces(&stage);
    struct neph_solid *mirror = &stage.solids[2];
    const struct {
        const char *why; /* NULL: supported */
        double roughness;
        int scattering, mirrors, lights;
    } rows[] = {
        {NULL, 0.0, NEPH_SCATTERING_MULTIPLE, 1, 0},
        {"rough metal", 0.3, NEPH_SCATTERING_MULTIPLE, 1, 0},
        {"scattered once", 0.0, NEPH_SCATTERING_SINGLE, 1, 0},
        {"several mirrors", 0.0, NEPH_SCATTERING_MULTIPLE, 2, 0},
        {"point lights with a mirror", 0.0, NEPH_SCATTERING_MULTIPLE, 1, 1},
    };
    for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
        mirror->surface.roughness = rows[i].roughness;
        stage.scene.scattering = (enum neph_scattering)rows[i].scattering;
        stage.scene.environment_light = rows[i].scattering == NEPH_SCATTERING_MULTIPLE;
        stage.solids[3] = *mirror;
        stage.scene.solid_count = 2 + rows[i].mirrors;
        stage.scene.light_count = rows[i].lights;
        const bool can = test_can_render(&neph_engine_povray, &stage.scene, reason, sizeof(reason));
        assert_int_equal(can, rows[i].why == NULL);
        if (rows[i].why)
            assert_non_null(strstr(reason, rows[i].why));
    }
    set_surfaces(&stage);
    struct neph_settings none = neph_settings_default(&neph_engine_povray);
    neph_assert_ok(neph_settings_set(&neph_engine_povray, &none, "radiosity_rays=0", NULL), NULL);
    assert_false(neph_engine_povray.can_render(&stage.scene, &none, reason, sizeof(reason)));
    assert_non_null(strstr(reason, "radiosity_rays"));
}

static void test_supported_scenes(void **state)
{
    char reason[128] = "";
    struct test_scene stage;
    set_full_stage(&stage);
    assert_true(test_can_render(&neph_engine_povray, &stage.scene, reason, sizeof(reason)));
    stage.scene.scattering = NEPH_SCATTERING_MULTIPLE;
    assert_false(test_can_render(&neph_engine_povray, &stage.scene, reason, sizeof(reason)));
    assert_string_equal(reason, "multiple scattering");
    stage.scene.scattering = NEPH_SCATTERING_SINGLE;
    stage.scene.environment_light = true;
    assert_false(test_can_render(&neph_engine_povray, &stage.scene, reason, sizeof(reason)));
    assert_string_equal(reason, "environment light on media or solids");
    stage.scene.environment_light = false;
    stage.solids[1].radius_m = 1e-12;
    assert_false(test_can_render(&neph_engine_povray, &stage.scene, reason, sizeof(reason)));
    assert_non_null(strstr(reason, "solids of"));
}

static void test_probe_without_povray(void **state)
{
    const struct neph_engine_info info = test_probe_without_path(&neph_engine_povray);
    assert_false(info.available);
    assert_non_null(strstr(info.missing, "povray"));
    assert_string_equal(info.install_line, "apt-get install povray");
}

/* ---- Frames --------------------------------------------------------------------------------- */

/* Renders with POV-Ray in a scratch folder whose name needs quoting. `assignment` may be NULL. */
static struct neph_image *render_with_setting(const struct test_scene *stage, unsigned layers,
                                              double intervals, const char *assignment)
{
    struct neph_diag diag = {0};
    struct neph_cost cost = {0};
    struct neph_image *frame = NULL;
    struct neph_shot shot = {.scene = &stage->scene,
                             .settings = neph_settings_default(&neph_engine_povray),
                             .width_px = WIDTH,
                             .height_px = HEIGHT,
                             .layers = layers,
                             .time_limit_s = 60.0};
    shot.settings.values[0] = intervals;
    if (assignment)
        neph_assert_ok(neph_settings_set(&neph_engine_povray, &shot.settings, assignment, &diag),
                       &diag);
    neph_assert_ok(test_render(&neph_engine_povray, &shot, &frame, &cost, &diag), &diag);
    print_message("  %s; %.2f s render, %.2f s wall, %.2f s cpu, %.0f MiB\n",
                  neph_image_attribute(frame, "neph.povray.passes"), cost.render_s, cost.wall_s,
                  cost.cpu_s, (double)cost.peak_memory_bytes / 1048576.0);
    assert_true(cost.wall_s >= cost.render_s);
    return frame;
}

static struct neph_image *render(const struct test_scene *stage, unsigned layers, double intervals)
{
    return render_with_setting(stage, layers, intervals, NULL);
}

/* Difference of a channel from the truth. */
struct difference {
    double mean, truth_mean, largest, largest_relative;
};

static double read_component(struct neph_rgb colour, int channel)
{
    return neph_povray_component(colour, channel);
}

enum quantity { RADIANCE, VOLUME, TRANSMITTANCE, DEPTH };

/* Exact light of each pixel's ray, for free(). Without scattering where it is not compared, as it
 * takes most of the time. */
static struct neph_ray_light *trace(const struct test_scene *stage, enum neph_scattering scattering)
{
    struct neph_ray_light *lights = calloc((size_t)WIDTH * HEIGHT, sizeof(*lights));
    struct neph_scene scene = stage->scene;
    scene.scattering = scattering;
    const struct neph_camera camera = neph_scene_camera(&scene, 0.0);
    assert_non_null(lights);
    for (int p = 0; p < WIDTH * HEIGHT; p++) {
        struct neph_pixel_ray ray = neph_camera_ray(&camera, WIDTH, HEIGHT, p % WIDTH, p / WIDTH);
        lights[p] = neph_transport_ray(&scene, ray.origin_m, ray.direction);
        lights[p].hit_m *= neph_vec3_dot(ray.direction, camera.forward); /* depth as in the file */
    }
    return lights;
}

static double true_quantity(const struct neph_ray_light *light, enum quantity quantity, int channel)
{
    switch (quantity) {
    case RADIANCE:
        return read_component(light->radiance, channel);
    case VOLUME:
        return read_component(light->volume, channel);
    case TRANSMITTANCE:
        return light->transmittance.r;
    case DEPTH:
        return light->hit_m;
    }
    return NAN;
}

static struct difference compare_with(const struct neph_ray_light *lights,
                                      const struct neph_image *frame, const char *name,
                                      enum quantity quantity, int channel)
{
    const float *samples = neph_image_channel(frame, name);
    struct difference difference = {0};
    assert_non_null(samples);
    for (int j = 0; j < HEIGHT; j++) {
        for (int i = 0; i < WIDTH; i++) {
            double truth = true_quantity(&lights[j * WIDTH + i], quantity, channel);
            double measured = samples[j * WIDTH + i];
            if (isinf(truth) && isinf(measured))
                continue;
            double off = fabs(measured - truth);
            assert_true(isfinite(off));
            difference.mean += (measured - truth) / (WIDTH * HEIGHT);
            difference.truth_mean += truth / (WIDTH * HEIGHT);
            difference.largest = fmax(difference.largest, off);
            if (truth > 0.0)
                difference.largest_relative = fmax(difference.largest_relative, off / truth);
        }
    }
    print_message("  %-15s mean %.6g, bias %+.2e, worst %.2e, worst relative %.2e\n", name,
                  difference.truth_mean, difference.mean / difference.truth_mean,
                  difference.largest, difference.largest_relative);
    return difference;
}

static struct difference compare(const struct test_scene *stage, const struct neph_image *frame,
                                 const char *name, enum quantity quantity, int channel)
{
    const bool lit = quantity == RADIANCE || quantity == VOLUME;
    struct neph_ray_light *lights = trace(stage,
                                          lit ? stage->scene.scattering : NEPH_SCATTERING_NONE);
    const struct difference difference = compare_with(lights, frame, name, quantity, channel);
    free(lights);
    return difference;
}

static void check_transmittance(const struct test_scene *stage, double intervals,
                                double largest_relative)
{
    struct neph_image *frame = render(stage, NEPH_LAYER_TRANSMITTANCE, intervals);
    for (int channel = 0; channel < 3; channel++) {
        static const char *const names[] = {"transmittance.R", "transmittance.G",
                                            "transmittance.B"};
        struct difference t = compare(stage, frame, names[channel], TRANSMITTANCE, channel);
        assert_true(t.largest_relative < largest_relative);
    }
    assert_null(neph_image_channel(frame, "R"));
    assert_null(neph_image_channel(frame, "Z"));
    neph_image_destroy(frame);
}

/* Along a side, to optical depths of 10 and 18, where the floor is 1e-8. */
static void test_transmittance_of_boxes(void **state)
{
    static const double extinctions_per_m[] = {0.5, 0.9};
    for (int i = 0; i < 2; i++) {
        struct test_scene stage;
        test_stage(&stage, (struct neph_vec3){0.0, 1.0, 12.0}, (struct neph_vec3){0.0, 1.0, 0.0});
        add_medium(&stage, (struct neph_bounds){{-3.0, 0.0, -10.0}, {3.0, 2.0, 10.0}},
                   extinctions_per_m[i], 0.0, 0.5);
        check_transmittance(&stage, 50, 1e-4);
    }
}

static void test_transmittance_of_height_fog(void **state)
{
    struct test_scene stage; /* camera inside; two layers; optical depths up to about 5 */
    test_stage(&stage, (struct neph_vec3){0.0, 2.0, 5.0}, (struct neph_vec3){0.0, 1.5, -5.0});
    struct neph_bounds bounds = {{-30.0, 0.0, -30.0}, {30.0, 10.0, 10.0}};
    struct neph_medium *fog = add_medium(&stage, bounds, 0.3, 0.5, 0.5);
    fog->layer_count = 2;
    fog->layers[1] = (struct neph_fog_layer){0.05, 0.2, 3.0};
    add_box(&stage, (struct neph_bounds){{-50.0, -1.0, -50.0}, {50.0, 0.0, 50.0}}, 0.5);
    check_transmittance(&stage, 50, 2e-4);
}

/* Fog without bounds, cut to the scene's container. */
static void test_transmittance_of_open_fog(void **state)
{
    struct test_scene stage;
    test_stage(&stage, (struct neph_vec3){0.0, 20.0, 0.0}, (struct neph_vec3){0.0, 0.0, -100.0});
    struct neph_bounds open = {{-INFINITY, -INFINITY, -INFINITY}, {INFINITY, INFINITY, INFINITY}};
    add_medium(&stage, open, 0.02, 0.05, 0.9);
    struct neph_image *frame = render(&stage, NEPH_LAYER_TRANSMITTANCE, 64);
    struct difference t = compare(&stage, frame, "transmittance.R", TRANSMITTANCE, 0);
    /* 256 midpoints across more than 16 scale heights: h^2/24 of the optical depth. */
    assert_true(t.largest < 2e-3);
    neph_image_destroy(frame);
}

/* Radiance of a plane-parallel slab with single scattering, seen from below. */
static double slab_radiance(const struct test_scene *stage, struct neph_vec3 ray,
                            double thickness_m)
{
    const struct neph_medium *slab = &stage->scene.media[0];
    double mu = ray.y, mu0 = stage->scene.sun.direction.y;
    double depth = slab->layers[0].extinction_per_m * thickness_m;
    double phase = neph_phase_per_sr(&slab->phase, neph_vec3_dot(stage->scene.sun.direction, ray));
    return slab->albedo.r * stage->scene.sun.irradiance_w_per_m2.r * phase * depth / mu *
           exp(-depth / mu0) * neph_phi(depth * (1.0 / mu - 1.0 / mu0));
}

static void check_slab(struct neph_phase phase)
{
    struct test_scene stage; /* a slab of optical depth 1 overhead */
    test_stage(&stage, (struct neph_vec3){0.0, -1.0, 0.0}, (struct neph_vec3){0.0, 2.0, -3.0});
    add_medium(&stage, (struct neph_bounds){{-500.0, 0.0, -500.0}, {500.0, 2.0, 500.0}}, 0.5, 0.0,
               0.8)
        ->phase = phase;
    struct neph_image *frame = render(&stage, NEPH_LAYER_RADIANCE, 50);
    struct neph_camera camera = neph_scene_camera(&stage.scene, 0.0);
    const float *volume = neph_image_channel(frame, "volume.R");
    double sum = 0.0, truth = 0.0, worst = 0.0;
    for (int j = 0; j < HEIGHT; j++) {
        for (int i = 0; i < WIDTH; i++) {
            struct neph_vec3 ray = neph_camera_ray(&camera, WIDTH, HEIGHT, i, j).direction;
            double expected = slab_radiance(&stage, ray, 2.0);
            sum += volume[j * WIDTH + i];
            truth += expected;
            worst = fmax(worst, fabs(volume[j * WIDTH + i] / expected - 1.0));
        }
    }
    print_message("  slab: mean %+.2e, worst %.2e\n", sum / truth - 1.0, worst);
    neph_assert_close(sum, truth, 1e-3, 0.0);
    assert_true(worst < 1e-3);
    assert_memory_equal(volume, neph_image_channel(frame, "R"), WIDTH * HEIGHT * sizeof(float));
    neph_image_destroy(frame);
}

static void test_single_scattering_slabs(void **state)
{
    check_slab((struct neph_phase){NEPH_PHASE_ISOTROPIC, 0.0});
    check_slab((struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN, 0.85});
    check_slab((struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN, -0.3});
    check_slab((struct neph_phase){NEPH_PHASE_RAYLEIGH, 0.0});
    check_slab((struct neph_phase){.kind = NEPH_PHASE_POVRAY_MIE_HAZY});
    check_slab((struct neph_phase){.kind = NEPH_PHASE_POVRAY_MIE_MURKY});
}

static void check_light(const struct test_scene *stage, const struct neph_image *frame)
{
    static const char *const names[2][3] = {{"R", "G", "B"}, {"volume.R", "volume.G", "volume.B"}};
    struct neph_ray_light *lights = trace(stage, stage->scene.scattering);
    for (int channel = 0; channel < 3; channel++) {
        struct difference all = compare_with(lights, frame, names[0][channel], RADIANCE, channel);
        struct difference volume = compare_with(lights, frame, names[1][channel], VOLUME, channel);
        assert_true(fabs(all.mean) < 1e-3 * all.truth_mean);
        assert_true(fabs(volume.mean) < 1e-3 * volume.truth_mean);
        assert_true(all.largest_relative < 0.02); /* midpoints next to shadow edges */
    }
    free(lights);
}

/* Two overlapping media with different phase functions, one of them a fog; a ground that touches
 * both, a sphere with its shadow, and coefficients with different colours. */
static void test_full_scene(void **state)
{
    struct test_scene stage;
    set_full_stage(&stage);
    struct neph_image *frame = render(&stage, NEPH_LAYERS_ALL, 50);
    check_light(&stage, frame);
    struct difference t = compare(&stage, frame, "transmittance.R", TRANSMITTANCE, 0);
    assert_true(t.largest_relative < 2e-4);
    struct difference depth = compare(&stage, frame, "Z", DEPTH, 0);
    assert_true(depth.largest_relative < 2e-7);
    neph_image_destroy(frame);
}

/* The same scene with an orthographic camera. */
static void test_orthographic_camera(void **state)
{
    struct test_scene stage;
    set_full_stage(&stage);
    stage.scene.vertical_fov_rad = 0.0;
    stage.scene.orthographic_height_m = 4.0;
    struct neph_image *frame = render(&stage, NEPH_LAYER_TRANSMITTANCE | NEPH_LAYER_DEPTH, 50);
    struct difference t = compare(&stage, frame, "transmittance.R", TRANSMITTANCE, 0);
    assert_true(t.largest_relative < 2e-4);
    struct difference depth = compare(&stage, frame, "Z", DEPTH, 0);
    assert_true(depth.largest_relative < 2e-7);
    neph_image_destroy(frame);
}

static void test_no_scattering(void **state)
{
    struct test_scene stage;
    set_full_stage(&stage);
    stage.scene.scattering = NEPH_SCATTERING_NONE;
    struct neph_image *frame = render(&stage, NEPH_LAYER_RADIANCE, 50);
    struct difference all = compare(&stage, frame, "G", RADIANCE, 1);
    assert_true(all.largest_relative < 1e-3);
    const float *volume = neph_image_channel(frame, "volume.G");
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        assert_true(volume[i] == 0.0F);
    neph_image_destroy(frame);
}

/* Slabs with emission. A bracket leaves half a quantum of an eighth of full scale, 6.3e-5. 200
 * midpoints leave h^2 / 24, where h is the optical depth between them, on rays up to a quarter
 * longer than the slab's thickness. */
static void test_emission_of_slabs(void **state)
{
    static const double extinctions_per_m[] = {0.01, 0.5, 5.0};
    for (size_t i = 0; i < COUNT(extinctions_per_m); i++) {
        struct test_scene stage;
        test_stage(&stage, (struct neph_vec3){0.0, 0.0, 3.0}, (struct neph_vec3){0.0, 0.0, 0.0});
        struct neph_medium *medium = add_medium(
            &stage, (struct neph_bounds){{-50.0, -50.0, -2.0}, {50.0, 50.0, 0.0}},
            extinctions_per_m[i], 0.0, 0.25);
        medium->emission_w_per_m2_sr = (struct neph_rgb){1.0, 2.0, 4.0};
        stage.scene.sun.present = false;
        struct neph_image *frame = render(&stage, NEPH_LAYER_RADIANCE, 50);
        const double h = 1.25 * 2.0 * extinctions_per_m[i] / 200.0;
        struct difference off = compare(&stage, frame, "B", RADIANCE, 2);
        assert_true(off.largest_relative < 6.3e-5 + h * h / 24.0);
        assert_string_equal(neph_image_attribute(frame, "neph.povray.emission_passes"), "1");
        neph_image_destroy(frame);
    }
}

/* The full scene with emission of different colours in a fog and a box. */
static void test_emission_beside_the_sun(void **state)
{
    struct test_scene stage;
    set_full_stage(&stage);
    stage.scene.media[0].emission_w_per_m2_sr = (struct neph_rgb){4.0, 2.0, 1.0};
    stage.scene.media[1].emission_w_per_m2_sr = (struct neph_rgb){0.0, 1.0, 3.0};
    struct neph_image *frame = render(&stage, NEPH_LAYER_RADIANCE, 50);
    check_light(&stage, frame);
    neph_image_destroy(frame);
}

/* An empty scene needs no render. */
static void test_empty_scene(void **state)
{
    struct test_scene stage;
    test_stage(&stage, (struct neph_vec3){0.0, 0.0, 0.0}, (struct neph_vec3){0.0, 0.0, -1.0});
    struct neph_image *frame = render(&stage, NEPH_LAYERS_ALL, 50);
    assert_true(neph_image_channel(frame, "R")[7] == 0.0F);
    assert_true(neph_image_channel(frame, "transmittance.R")[7] == 1.0F);
    assert_true(isinf(neph_image_channel(frame, "Z")[7]));
    assert_string_equal(neph_image_attribute(frame, "neph.povray.passes"),
                        "volume 0, surface 0, transmittance 0, depth 0");
    neph_image_destroy(frame);
}

/* Ground and a rotated box in the sun, each with a pattern; lines of the box's pattern lie in its
 * faces. All of the `count` pixels except `may_differ` have the true light. */
static void compare_patterns(enum neph_pattern pattern, int may_differ)
{
    struct test_scene stage;
    struct neph_diag diag = {0};
    test_stage(&stage, (struct neph_vec3){0.3, 2.1, 6}, (struct neph_vec3){0, 0.6, 0});
    stage.scene.scattering = NEPH_SCATTERING_NONE;
    stage.scene.sun.irradiance_w_per_m2 = (struct neph_rgb){3, 2, 1};
    struct neph_solid *ground = add_box(&stage, (struct neph_bounds){{-50, -1, -50}, {50, 0, 8}},
                                        0.5);
    ground->surface.texture = (struct neph_paint){
        .cell_m = 0.61, .pattern = pattern, .other = {0.1, 0.2, 0.8}, .seed = 3};
    struct neph_solid *box = add_box(
        &stage, (struct neph_bounds){{-0.75, 0.02, -1}, {0.75, 1.52, 0.5}}, 0.9);
    box->turn = (struct neph_turn){1, cos(0.4), sin(0.4)};
    box->surface.texture = (struct neph_paint){
        .cell_m = 0.25, .pattern = pattern, .other = {0.7, 0.1, 0.1}, .seed = 4};
    struct neph_image *frame = render(&stage, NEPH_LAYER_RADIANCE, 8.0);
    const struct neph_camera camera = neph_scene_camera(&stage.scene, 0.0);
    float *rgb[3];
    int same = 0, others = 0;
    neph_assert_ok(neph_image_rgb(frame, NULL, rgb) ? NEPH_OK : NEPH_ERR_ENGINE, &diag);
    for (int p = 0; p < WIDTH * HEIGHT; p++) {
        const struct neph_pixel_ray ray = neph_camera_ray(&camera, WIDTH, HEIGHT, p % WIDTH,
                                                          p / WIDTH);
        const struct neph_rgb truth =
            neph_transport_ray(&stage.scene, ray.origin_m, ray.direction).radiance;
        const bool is_same = fabs(rgb[0][p] - truth.r) < 1e-4 && fabs(rgb[2][p] - truth.b) < 1e-4;
        same += is_same;
        others += truth.b > (pattern == NEPH_PATTERN_CHECKER ? 2.0 : 0.7) * truth.r;
    }
    print_message("  %d of %d pixels the same\n", same, WIDTH * HEIGHT);
    assert_true(same >= WIDTH * HEIGHT - may_differ);
    assert_true(others > 20);
    neph_image_destroy(frame);
}

static void test_checkers(void **state)
{
    compare_patterns(NEPH_PATTERN_CHECKER, 2); /* a point on a line may be rounded to either side */
}

static void test_noise(void **state)
{
    compare_patterns(NEPH_PATTERN_NOISE, 0);
}

/* A black floor and ball in front of a white mirror, under a uniform sky. A pixel of the mirror is
 * black where the mirrored ray hits a solid, and otherwise the sky's radiance times the mirror's
 * colour. */
static void test_a_mirror(void **state)
{
    struct test_scene stage;
    float *rgb[3];
    int in_mirror = 0, dark = 0, same = 0;
    test_stage(&stage, (struct neph_vec3){0.4, 1.6, 6}, (struct neph_vec3){0, 1, 0});
    stage.scene.sun.present = false;
    stage.scene.scattering = NEPH_SCATTERING_MULTIPLE;
    stage.scene.environment_light = true;
    stage.scene.background_w_per_m2_sr = (struct neph_rgb){1, 2, 0.5};
    add_box(&stage, (struct neph_bounds){{-50, -1, -50}, {50, 0, 50}}, 0.0);
    add_box(&stage, (struct neph_bounds){{-2, 0, -1.2}, {2, 2.4, -1}}, 0.75)->surface.metalness = 1;
    add_sphere(&stage, (struct neph_vec3){0.6, 0.9, 0.4}, 0.5, 0.0);
    struct neph_image *frame = render_with_setting(&stage, NEPH_LAYER_RADIANCE, 8.0,
                                                   "radiosity_rays=4");
    const struct neph_camera camera = neph_scene_camera(&stage.scene, 0.0);
    assert_true(neph_image_rgb(frame, NULL, rgb));
    for (int p = 0; p < WIDTH * HEIGHT; p++) {
        const struct neph_pixel_ray ray = neph_camera_ray(&camera, WIDTH, HEIGHT, p % WIDTH,
                                                          p / WIDTH);
        const struct neph_hit hit = neph_scene_hit(&stage.scene, ray.origin_m, ray.direction);
        if (hit.solid != &stage.solids[1] || hit.normal.z < 0.9)
            continue;
        const struct neph_vec3 from_m = neph_hit_outside_m(
            &hit, neph_vec3_along(ray.origin_m, ray.direction, hit.t_m));
        const struct neph_vec3 back = {ray.direction.x, ray.direction.y, -ray.direction.z};
        const bool is_dark = neph_scene_hit(&stage.scene, from_m, back).solid;
        in_mirror++;
        dark += is_dark;
        same += fabs(rgb[0][p] - (is_dark ? 0.0 : 0.75)) < 1e-4 &&
                fabs(rgb[1][p] - (is_dark ? 0.0 : 1.5)) < 2e-4;
    }
    print_message("  %d of %d pixels of the mirror the same, %d dark\n", same, in_mirror, dark);
    assert_true(in_mirror > 50 && dark > 10 && dark < in_mirror - 10);
    assert_int_equal(same, in_mirror);
    neph_image_destroy(frame);
}

/* The infinite step of scenes/catalog/surface_step.yaml, nearly black. At a distance d from its
 * foot the plane sees (1 + d / sqrt(d^2 + h^2)) / 2 of the sky; its radiance is this times the
 * albedo. The other surface adds at most half the albedo of the remaining part. */
static void test_radiosity_at_a_step(void **state)
{
    const double albedo = 0.02;
    struct test_scene stage;
    float *rgb[3];
    double sum = 0.0, truth = 0.0, worst = 0.0;
    int count = 0;
    test_stage(&stage, (struct neph_vec3){0.31, 3.6, 5.2}, (struct neph_vec3){0.3, 0.4, -0.6});
    stage.scene.sun.present = false;
    stage.scene.scattering = NEPH_SCATTERING_MULTIPLE;
    stage.scene.environment_light = true;
    stage.scene.background_w_per_m2_sr = make_grey(1.0);
    add_box(&stage, (struct neph_bounds){{-20000, -5, -20000}, {20000, 0, 20000}}, albedo);
    add_box(&stage, (struct neph_bounds){{-10000, -1, -40}, {10000, 1, -1}}, albedo);
    struct neph_image *frame = render_with_setting(&stage, NEPH_LAYER_RADIANCE, 8.0,
                                                   "radiosity_rays=400");
    struct neph_image *again = render_with_setting(&stage, NEPH_LAYER_RADIANCE, 8.0,
                                                   "radiosity_rays=400");
    const struct neph_camera camera = neph_scene_camera(&stage.scene, 0.0);
    assert_true(neph_image_rgb(frame, NULL, rgb));
    for (int p = 0; p < WIDTH * HEIGHT; p++) {
        const struct neph_pixel_ray ray = neph_camera_ray(&camera, WIDTH, HEIGHT, p % WIDTH,
                                                          p / WIDTH);
        const struct neph_hit hit = neph_scene_hit(&stage.scene, ray.origin_m, ray.direction);
        if (hit.solid != &stage.solids[0])
            continue;
        const double d_m = ray.origin_m.z + hit.t_m * ray.direction.z + 1.0;
        const double light = albedo * 0.5 * (1.0 + d_m / hypot(d_m, 1.0));
        count++;
        sum += rgb[1][p];
        truth += light;
        worst = fmax(worst, fabs(rgb[1][p] / light - 1.0));
    }
    print_message("  %d pixels, mean %.4f of the truth, worst off by %.3f\n", count, sum / truth,
                  worst);
    assert_memory_equal(rgb[1], neph_image_channel(again, "G"), WIDTH * HEIGHT * sizeof(float));
    assert_true(count > 200);
    assert_true(fabs(sum / truth - 1.0) < 0.01);
    assert_true(worst < 0.1);
    neph_image_destroy(again);
    neph_image_destroy(frame);
}

static void test_export_runs_by_hand(void **state)
{
    char directory[] = "/tmp/neph-export-XXXXXX", command[256] = "";
    assert_non_null(mkdtemp(directory));
    struct neph_diag diag = {0};
    struct test_scene stage;
    set_full_stage(&stage);
    struct neph_shot shot = {.scene = &stage.scene,
                             .settings = neph_settings_default(&neph_engine_povray),
                             .width_px = WIDTH,
                             .height_px = HEIGHT};
    neph_assert_ok(
        neph_engine_povray.export_scene(&shot, directory, command, sizeof(command), &diag), &diag);
    char *line = neph_format("cd %s && %s >log 2>&1", directory, command);
    assert_int_equal(system(line), 0);
    free(line);
    char *picture = neph_path_join(directory, "scene.png");
    assert_true(neph_path_exists(picture));
    free(picture);
    neph_dir_remove(directory, NULL);
}

/* --- a POV-Ray that fails: a shell script of the same name, first in PATH -------------------- */

/* Renders the depth of a scene with the script in place of POV-Ray; returns the status. */
static enum neph_status render_with(const char *script, double time_limit_s, char message[1024])
{
    struct neph_diag diag = {0};
    struct neph_cost cost;
    struct neph_image *frame = NULL;
    struct test_scene stage;
    struct impostor impostor;
    set_full_stage(&stage);
    set_impostor(&impostor, "povray", script);
    struct neph_shot shot = {.scene = &stage.scene,
                             .settings = neph_settings_default(&neph_engine_povray),
                             .width_px = WIDTH,
                             .height_px = HEIGHT,
                             .layers = NEPH_LAYER_DEPTH,
                             .time_limit_s = time_limit_s};
    enum neph_status status = test_render(&neph_engine_povray, &shot, &frame, &cost, &diag);
    assert_null(frame);
    strcpy(message, diag.message);
    remove_impostor(&impostor);
    return status;
}

static void test_failures_are_reported(void **state)
{
    char message[1024];
    assert_int_equal(render_with("#!/bin/sh\nexit 0\n", 10.0, message), NEPH_ERR_ENGINE);
    assert_non_null(strstr(message, "wrote no image"));
    assert_int_equal(render_with("#!/bin/sh\necho broken >depth.png\n", 10.0, message),
                     NEPH_ERR_ENGINE);
    assert_int_equal(render_with("#!/bin/sh\necho 'Parse Error: x' >&2; exit 1\n", 10.0, message),
                     NEPH_ERR_ENGINE);
    assert_non_null(strstr(message, "Parse Error"));
    assert_int_equal(render_with("#!/bin/sh\nexec sleep 60\n", 0.3, message), NEPH_ERR_TIMEOUT);
}

/* A known version is not enough: the probe renders. */
static void test_probe_tries_it(void **state)
{
    const struct neph_engine *engine = &neph_engine_povray;
    struct neph_engine_info info = test_probe_impostor(engine, "povray",
                                                       "#!/bin/sh\necho 'POV-Ray 3.6.2' >&2\n");
    assert_false(info.available);
    assert_non_null(strstr(info.missing, "POV-Ray 3.6.2; versions from 3.7 on"));
    info = test_probe_impostor(engine, "povray",
                               "#!/bin/sh\necho 'POV-Ray 3.7.0.10.unofficial' >&2\n");
    assert_true(info.broken && !info.available);
    assert_string_equal(info.version, "POV-Ray 3.7.0.10");
    assert_non_null(strstr(info.missing, "wrote no image"));
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_brackets_recover_values),
        cmocka_unit_test(test_exposures_meet_the_target),
        cmocka_unit_test(test_black_frames_end),
        cmocka_unit_test(test_one_bright_pixel_leaves_the_others),
        cmocka_unit_test(test_depth_digits_recover_depth),
        cmocka_unit_test(test_phase_constants),
        cmocka_unit_test(test_text_has_no_string_of_the_scene),
        cmocka_unit_test(test_text_refuses_nan),
        cmocka_unit_test(test_text_of_surfaces),
        cmocka_unit_test(test_noise_s_file),
        cmocka_unit_test(test_faces_of_containers_are_separate),
        cmocka_unit_test(test_faces_keep_off_the_eye),
        cmocka_unit_test(test_crowds_of_origins_are_refused),
        cmocka_unit_test(test_lights_on_rays_are_refused),
        cmocka_unit_test(test_eye_on_a_solid_is_refused),
        cmocka_unit_test(test_text_near_eyes_and_lights),
        cmocka_unit_test(test_supported_scenes),
        cmocka_unit_test(test_which_surfaces_it_can_render),
        cmocka_unit_test(test_probe_without_povray),
        cmocka_unit_test(test_failures_are_reported),
        cmocka_unit_test(test_probe_tries_it),
    };
    const struct CMUnitTest engine_tests[] = {
        cmocka_unit_test(test_transmittance_of_boxes),
        cmocka_unit_test(test_transmittance_of_height_fog),
        cmocka_unit_test(test_transmittance_of_open_fog),
        cmocka_unit_test(test_single_scattering_slabs),
        cmocka_unit_test(test_full_scene),
        cmocka_unit_test(test_orthographic_camera),
        cmocka_unit_test(test_no_scattering),
        cmocka_unit_test(test_emission_of_slabs),
        cmocka_unit_test(test_emission_beside_the_sun),
        cmocka_unit_test(test_empty_scene),
        cmocka_unit_test(test_checkers),
        cmocka_unit_test(test_noise),
        cmocka_unit_test(test_a_mirror),
        cmocka_unit_test(test_radiosity_at_a_step),
        cmocka_unit_test(test_export_runs_by_hand),
    };
    if (neph_test_wants_engines(argc, argv))
        return test_has_engine(&neph_engine_povray)
                   ? cmocka_run_group_tests(engine_tests, NULL, NULL)
                   : 0;
    return cmocka_run_group_tests(tests, NULL, NULL);
}
