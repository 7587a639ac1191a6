/* SPDX-License-Identifier: MIT
 *
 * The shader of the game-engine fog model compared with its formulas in double precision
 * (truth/fog_look.h): value by value through shaders/probe_fog_look.comp, and frame by frame. Rays
 * are rounded to float32 first and given to both sides. Required is 1e-5 relative; for a
 * transmittance only above e^-16, because each unit of optical depth multiplies its error.
 */
#include "tests/renderer/probe.h"

#include "renderer/fog_look.h"
#include "scenes/media.h"
#include "truth/fog_look.h"
#include "truth/transport.h"

static const uint32_t probe_code[] = {
#include "shaders/probe_fog_look.comp.inc"
};

/* layout of shaders/probe_fog_look.comp */
struct probe {
    struct neph_gpu_fog_look look;
    float direction[3];
    float length_m;
    float to_sun[3];
    float padding;
};

_Static_assert(sizeof(struct neph_gpu_fog_look) == 96, "as the shader's array has it");

struct answer {
    float volume[3];
    float through;
};

/* Input of the CPU reference. */
struct question {
    struct neph_scene scene;
    enum neph_fog_model model;
    struct neph_vec3 eye_m, direction;
    double length_m;
};

enum { QUESTIONS_MAX = 4000 };

/* ---- evaluation
 * ------------------------------------------------------------------------------- */

static struct neph_vec3 rounded(struct neph_vec3 v)
{
    return (struct neph_vec3){(float)v.x, (float)v.y, (float)v.z};
}

static void put_vec3(float out[3], struct neph_vec3 v)
{
    out[0] = (float)v.x;
    out[1] = (float)v.y;
    out[2] = (float)v.z;
}

static struct probe make_probe(const struct question *question)
{
    struct probe probe = {
        .look = neph_gpu_fog_pack(&question->scene, &question->scene.fog_look, question->model,
                                  question->eye_m),
        .length_m = isinf(question->length_m) ? NEPH_GPU_FAR_M : (float)question->length_m,
    };
    put_vec3(probe.direction, question->direction);
    put_vec3(probe.to_sun, question->scene.sun.direction);
    return probe;
}

/* The caller frees the result. */
static struct answer *ask(struct neph_vulkan *vulkan, const struct question *questions, int count)
{
    const struct neph_kernel_params params = {.name = "probe_fog_look",
                                              .code = probe_code,
                                              .code_bytes = sizeof(probe_code),
                                              .buffer_count = 2};
    OWNED(memory) struct probe *probes = calloc((size_t)count, sizeof(*probes));
    assert_non_null(probes);
    for (int i = 0; i < count; i++)
        probes[i] = make_probe(&questions[i]);
    return test_probe(vulkan, &params, NULL, probes, sizeof(*probes), sizeof(struct answer), count);
}

static struct neph_fog_look_light compute_reference(const struct question *question)
{
    return neph_fog_look_ray(&question->scene, &question->scene.fog_look, question->model,
                             question->eye_m, question->direction, question->length_m);
}

/* ---- inputs
 * ----------------------------------------------------------------------------------- */

static float some_float(uint64_t *seed, double low, double high)
{
    return (float)neph_test_uniform(seed, low, high);
}

static struct neph_fog_look some_look(uint64_t *seed)
{
    const struct neph_fog_look full = {
        .present = true,
        .inscattering_w_per_m2_sr = {0.5, some_float(seed, 0, 2), 1.5},
        .sky_light = {0.25, 0.5, some_float(seed, 0, 1)},
        .start_distance_m = some_float(seed, 0, 60),
        .end_distance_m = some_float(seed, 60, 1500),
        .cutoff_distance_m = some_float(seed, 100, 3000),
        .max_opacity = some_float(seed, 0, 1),
        .volumetric_fog_distance_m = some_float(seed, 0, 60),
        .observer_height_max_m = some_float(seed, 0, 100),
        .directional_w_per_m2_sr = {some_float(seed, 0, 3), 1, 0},
        .directional_exponent = some_float(seed, 0, 64),
        .directional_start_m = some_float(seed, 0, 100),
    };
    return neph_fog_look_mask_controls(&full,
                                       (unsigned)neph_test_random(seed) & NEPH_FOG_CONTROLS_ALL);
}

/* Fogs of up to 16 mean free paths: e^-16 is the last digit of white. */
static struct question some_question(uint64_t *seed, int trial)
{
    struct question question = {.model = trial % 3 == 0 ? NEPH_FOG_FILAMENT : NEPH_FOG_UNREAL};
    question.scene = make_sunny(make_height_fog(pow(10.0, neph_test_uniform(seed, -5, -1)),
                                                pow(10.0, neph_test_uniform(seed, -4, -0.7))),
                                rounded(random_direction(seed)));
    question.scene.sun.direction = rounded(question.scene.sun.direction);
    if (trial % 2 && question.model == NEPH_FOG_UNREAL) {
        struct neph_medium *fog = &question.scene.media[0];
        fog->layers[fog->layer_count++] = (struct neph_fog_layer){
            neph_test_uniform(seed, 0, 1e-2), neph_test_uniform(seed, 0, 0.1), 10.0};
    }
    question.scene.background_w_per_m2_sr = (struct neph_rgb){0.25, 0.5, 0.75};
    question.scene.fog_look = some_look(seed);
    question.eye_m = (struct neph_vec3){0.0, some_float(seed, -40, 120), 0.0};
    question.direction = rounded(random_direction(seed));
    if (trial % 5 == 0)
        question.direction = (struct neph_vec3){0.6f, (float)(1e-5 * question.direction.y), 0.8f};
    question.length_m = trial % 7 == 0 ? INFINITY
                                       : (float)pow(10.0, neph_test_uniform(seed, -1, 3.3));
    return question;
}

/* ---- the shader against the CPU reference --------------------------------------------------- */

/* A millionth of a unit of radiance is negligible. */
static void check_answer(const struct question *question, const struct answer *answer,
                         double *worst)
{
    const struct neph_fog_look_light reference = compute_reference(question);
    const double *volume = &reference.volume.r, asked = 1e-5, least = 1e-7;
    if (reference.transmittance > 1.1e-7) {
        neph_assert_close(answer->through, reference.transmittance, asked, 0.0);
        *worst = fmax(*worst, fabs(answer->through / reference.transmittance - 1.0));
    } else {
        assert_true(answer->through >= 0.0f && answer->through < 1.2e-7f);
    }
    for (int c = 0; c < 3; c++) {
        neph_assert_close(answer->volume[c], volume[c], asked, least);
        if (volume[c] > 1e-2)
            *worst = fmax(*worst, fabs(answer->volume[c] / volume[c] - 1.0));
    }
}

/* At a seam of the formula or at the cutoff the two sides may take different branches. */
static bool is_at_an_edge(const struct question *question)
{
    const struct neph_fog_look *look = &question->scene.fog_look;
    const double length_m = question->length_m, near = 1e-5;
    const double level = question->model == NEPH_FOG_UNREAL ? NEPH_FOG_UNREAL_LEVEL * M_LN2
                                                            : NEPH_FOG_FILAMENT_LEVEL;
    for (int l = 0; l < question->scene.media[0].layer_count; l++) {
        const double rise = fabs(question->scene.media[0].layers[l].falloff_per_m *
                                 question->direction.y * length_m);
        if (fabs(rise / level - 1.0) < near)
            return true;
    }
    return fabs(look->cutoff_distance_m / length_m - 1.0) < near;
}

static void test_the_shader_is_the_formula(void **state)
{
    struct neph_vulkan *vulkan = *state;
    OWNED(memory) struct question *questions = calloc(QUESTIONS_MAX, sizeof(*questions));
    assert_non_null(questions);
    int count = 0;
    for (uint64_t trial = 0; count < QUESTIONS_MAX; trial++) {
        uint64_t seed = 5000 + trial;
        questions[count] = some_question(&seed, (int)trial);
        count += !is_at_an_edge(&questions[count]);
    }
    OWNED(memory) struct answer *answers = ask(vulkan, questions, count);
    double worst = 0.0;
    for (int i = 0; i < count; i++)
        check_answer(&questions[i], &answers[i], &worst);
    printf("off by %.1e at most, of %d rays\n", worst, count);
}

/* ---- inputs for which the engines' code is NaN or infinite
 * ------------------------------------ */

static struct question hard(double density, double falloff, double eye_y_m, struct neph_vec3 way,
                            double length_m)
{
    const struct neph_unreal_fog ui = {density, falloff, 0.0};
    struct question question = {.direction = way, .length_m = length_m};
    question.scene = make_sunny(make_height_fog(0.0, 0.0), (struct neph_vec3){0, 0, 1});
    question.scene.media[0].layers[0] = neph_fog_layer_from_unreal(&ui);
    question.scene.fog_look = (struct neph_fog_look){.present = true,
                                                     .inscattering_w_per_m2_sr = white,
                                                     .directional_w_per_m2_sr = white,
                                                     .max_opacity = 1.0,
                                                     .observer_height_max_m = 1e6};
    question.eye_m.y = eye_y_m;
    return question;
}

/* A receiver at the camera; 2^127 d above all floats, and below; falloff 0; density 0; straight up
 * and down; a lobe cos^0 at its edge: all values are finite and equal the CPU reference's. */
static void test_the_points_where_engines_fail(void **state)
{
    struct neph_vulkan *vulkan = *state;
    const struct neph_vec3 up = {0, 1, 0}, down = {0, -1, 0}, level = {1, 0, 0},
                           sunward = {0, 0, 1};
    struct question questions[2 * 15] = {
        hard(0.1, 0.2, 2, level, 0.0),      hard(10, 20, -1000, up, 0.0),
        hard(10, 20, -1000, level, 1.0),    hard(10, 7, -1000, down, 1e6),
        hard(4, 2, -1000, up, INFINITY),    hard(0.1, 0, 5, up, INFINITY),
        hard(0.1, 0, 5, level, 100.0),      hard(0, 0.2, 5, down, INFINITY),
        hard(0, 0, 5, sunward, 0.0),        hard(0.1, 0.2, 1e5, down, 1e5),
        hard(0.1, 0.2, 5, level, INFINITY), hard(0.1, 0.2, 5, sunward, INFINITY),
        hard(1e-30, 9, 5, down, 2000.0),    hard(0.1, 0.2, 5, level, 1e-30),
        hard(1e-37, 2, -1000, up, 1.0),
    };
    const int count = (int)(sizeof(questions) / sizeof(questions[0]));
    for (int i = 0; i < count / 2; i++) {
        questions[count / 2 + i] = questions[i];
        questions[count / 2 + i].model = NEPH_FOG_FILAMENT;
    }
    OWNED(memory) struct answer *answers = ask(vulkan, questions, count);
    for (int i = 0; i < count; i++) {
        const struct neph_fog_look_light reference = compute_reference(&questions[i]);
        neph_assert_close(answers[i].through, reference.transmittance, 1e-5, 1e-7);
        neph_assert_close(answers[i].volume[0], reference.volume.r, 1e-5, 1e-7);
    }
    assert_true(answers[0].through == 1.0f && answers[1].through == 1.0f);
    assert_true(answers[14].through > 0.1f && answers[14].through < 0.9f); /* at 2^127 d */
    assert_true(answers[7].through == 1.0f && answers[7].volume[0] == 0.0f);
}

/* ---- frames
 * ----------------------------------------------------------------------------------- */

static struct neph_fog_renderer *looks_at(struct neph_vulkan *vulkan,
                                          const struct neph_scene *scene, bool sun_is_clear)
{
    struct neph_diag diag = {0};
    struct neph_fog_renderer *looks = NULL;
    const struct neph_fog_look_params params = {
        .width_px = 40, .height_px = 24, .look = scene->fog_look, .sun_is_clear = sun_is_clear};
    neph_assert_ok(neph_fog_renderer_create(vulkan, scene, &params, &looks, &diag), &diag);
    return looks;
}

static struct neph_image *next_picture(struct neph_fog_renderer *looks,
                                       const struct neph_scene *scene)
{
    struct neph_diag diag = {0};
    struct neph_image *image = NULL;
    double gpu_s;
    neph_assert_ok(neph_fog_renderer_frame(looks, scene, 0.0, &image, &gpu_s, &diag), &diag);
    return image;
}

static struct neph_image *picture(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                  bool sun_is_clear)
{
    OWNED(fog_looks) struct neph_fog_renderer *looks = looks_at(vulkan, scene, sun_is_clear);
    return next_picture(looks, scene);
}

/* Absorbing and emitting fog over ground and a sphere. */
static void set_stage(struct test_scene *test)
{
    test_scene_init(test);
    test->key.position_m = (struct neph_vec3){3.0, 5.0, 20.0};
    test->key.look_at_m = (struct neph_vec3){0.0, 3.0, -40.0};
    struct neph_medium *fog = test_add_medium(test, 0.02, 0.05, 0.0);
    test_add_layer(fog, 0.05, 0.4, 0.0);
    fog->albedo = make_grey(0.0);
    fog->emission_w_per_m2_sr = (struct neph_rgb){0.5, 0.75, 1.0};
    test_add_box(test, (struct neph_vec3){-1e3, -1.0, -1e3}, (struct neph_vec3){1e3, 0.0, 1e3});
    test->scene.scattering = NEPH_SCATTERING_NONE;
    test->scene.background_w_per_m2_sr = (struct neph_rgb){0.2, 0.3, 0.4};
    test->scene.fog_look = (struct neph_fog_look){
        .present = true,
        .inscattering_w_per_m2_sr = fog->emission_w_per_m2_sr,
        .max_opacity = 1.0,
        .observer_height_max_m = 1e6,
    };
}

/* Engine exact, pixel by pixel: 1e-5 for float32 and the series of level rays. */
static void test_the_physical_part_is_exact(void **state)
{
    struct test_scene test;
    set_stage(&test);
    OWNED(image) struct neph_image *image = picture(*state, &test.scene, false);
    const struct neph_camera camera = neph_scene_camera(&test.scene, 0.0);
    const float *radiance = neph_image_channel(image, "G"),
                *through = neph_image_channel(image, "transmittance.G"),
                *depth_m = neph_image_channel(image, "Z");
    int grounds = 0;
    for (int i = 0; i < 40 * 24; i++) {
        const struct neph_pixel_ray ray = neph_camera_ray(&camera, 40, 24, i % 40, i / 40);
        const struct neph_ray_light exact = neph_transport_ray(&test.scene, ray.origin_m,
                                                               ray.direction);
        neph_assert_close(radiance[i], exact.radiance.g, 1e-5, 0.0);
        neph_assert_close(through[i], exact.transmittance.g, 1e-5, 1e-7);
        neph_assert_close(depth_m[i], exact.hit_m * neph_vec3_dot(ray.direction, camera.forward),
                          1e-5, 0.0);
        grounds += isfinite(exact.hit_m);
    }
    assert_true(grounds > 200 && grounds < 40 * 24 - 200);
}

/* With a clear sun the ground has the radiance albedo / pi E cos in any fog. */
static void test_a_clear_sun_is_not_dimmed(void **state)
{
    struct test_scene test;
    set_stage(&test);
    OWNED(image) struct neph_image *image = picture(*state, &test.scene, true);
    const size_t pixel = 23 * 40 + 20; /* ground in front of the camera */
    const double behind = (neph_image_channel(image, "R")[pixel] -
                           neph_image_channel(image, "volume.R")[pixel]) /
                          neph_image_channel(image, "transmittance.R")[pixel];
    const struct neph_scene *scene = &test.scene;
    const double lit = scene->solids[0].albedo.r / M_PI * scene->sun.irradiance_w_per_m2.r *
                       scene->sun.direction.y;
    assert_true(lit > 0.0);
    neph_assert_close(behind, lit, 1e-5, 0.0);
}

/* A frame with another camera and sun after others in flight equals the frame of a new renderer. */
static void test_frames_in_a_sequence(void **state)
{
    struct test_scene test;
    set_stage(&test);
    OWNED(fog_looks) struct neph_fog_renderer *looks = looks_at(*state, &test.scene, false);
    struct neph_diag diag = {0};
    double gpu_s;
    for (int i = 0; i < 5; i++)
        neph_assert_ok(neph_fog_renderer_frame(looks, &test.scene, 0.0, NULL, NULL, &diag), &diag);
    neph_assert_ok(neph_fog_renderer_collect(looks, &gpu_s, &diag), &diag);
    test.key.position_m.y += 7.0;
    test.scene.sun.irradiance_w_per_m2.g *= 2.0;
    OWNED(image) struct neph_image *later = next_picture(looks, &test.scene);
    OWNED(image) struct neph_image *alone = picture(*state, &test.scene, false);
    assert_memory_equal(neph_image_channel(later, "G"), neph_image_channel(alone, "G"),
                        40 * 24 * sizeof(float));
    assert_int_equal(neph_fog_renderer_collect(looks, &gpu_s, &diag), NEPH_ERR_USAGE);
    test.scene.medium_count = 0; /* no media */
    OWNED(image) struct neph_image *clear = next_picture(looks, &test.scene);
    for (int i = 0; i < 40 * 24; i++)
        assert_true(neph_image_channel(clear, "transmittance.G")[i] == 1.0f &&
                    neph_image_channel(clear, "volume.G")[i] == 0.0f);
}

/* Opens the device of NEPH_VULKAN_DEVICE, if set; validation layers may be missing there. */
static int open_device(void **state)
{
    const char *device = getenv("NEPH_VULKAN_DEVICE");
    struct neph_vulkan *vulkan = NULL;
    struct neph_diag diag = {0};
    if (!device)
        return test_vulkan_setup(state);
    neph_assert_ok(
        neph_vulkan_create(&(struct neph_vulkan_params){.device = device}, &vulkan, &diag), &diag);
    *state = vulkan;
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
#include "cases/test_fog_look.inc"
    };
    return cmocka_run_group_tests(tests, open_device, test_vulkan_teardown);
}
