/* SPDX-License-Identifier: MIT
 *
 * Tests of near froxels: each pass against its CPU reference, and the frame against the exact
 * transport with ever thinner slices, at a wall and at the seam to the march.
 */
#include "tests/renderer/sequence_test.h"

#include "scenes/lights.h"
#include "scenes/media.h"
#include "scenes/solids.h"
#include "truth/transport.h"

enum { WIDTH_PX = 32, HEIGHT_PX = 18 };

/* ---- passes without the scene ---- */

/* exp and log of the device have about 3 units in the last place, and thin slices cancel. */
static const double passes_relative = 2e-4, passes_absolute = 1e-6;

static void assert_same(struct test_passes *test, int target, size_t first, size_t count)
{
    OWNED(memory) uint32_t *words = test_download(test, target);
    const struct neph_gpu_target *shape = &test->view.targets[target];
    for (size_t i = first; i < first + count; i++) {
        float found[4], expected[4];
        neph_rt_load(shape, words, i, found);
        test_get(test, target, i, expected);
        for (int c = 0; c < 4; c++)
            neph_assert_close((double)found[c], (double)expected[c], passes_relative,
                              passes_absolute);
    }
}

static void fill_froxels(struct test_passes *test, uint64_t *seed)
{
    for (size_t i = 0; i < test_elements(test, RT_FROXELS); i++) {
        const float bright = i % 7 ? 0.3f : 30.0f, dense = i % 5 ? 0.2f : i % 3 ? 0.0f : 20.0f;
        test_set(test, RT_FROXELS, i,
                 (float[4]){bright * (float)test_uniform(seed), bright * (float)test_uniform(seed),
                            bright * (float)test_uniform(seed), dense * (float)test_uniform(seed)});
    }
}

static void test_passes_equal_their_cpu_references(void **state)
{
    for (uint64_t k = 0; k < 3; k++) {
        const struct neph_settings settings = test_settings(
            "froxels=on froxel_px=4 froxel_slices=13 froxel_end_m=20 "
            "target_format=float");
        OWNED(passes) struct test_passes test;
        uint64_t seed = 20261125 + k;
        test_passes_open(*state, &settings, (int[2]){37, 21}, (int[2]){4, 8}, seed, &test);
        test.view.frame = (uint32_t)k;
        test.view.jitter_px[0] = 0.25f;
        if (k == 2)
            test_make_parallel(&test.view, 5.0f);
        fill_froxels(&test, &seed);
        for (size_t i = 0; i < test_elements(&test, RT_DEPTH); i++) {
            const float depth_m = i % 4 ? 30.0f * (float)test_uniform(&seed) + 0.01f
                                        : NEPH_GPU_FAR_M;
            test_set(&test, RT_DEPTH, i, (float[4]){depth_m});
            test_set(
                &test, RT_VOLUME, i,
                (float[4]){(float)test_uniform(&seed), 0.5f, 2.0f, (float)test_uniform(&seed)});
        }
        test_passes_run(&test, "froxel sum");
        cpu_froxel_sum(&test.cpu);
        assert_same(&test, RT_FROXELS, 0, test_elements(&test, RT_FROXELS));
        test_passes_run(&test, "froxel composition");
        cpu_froxel_apply(&test.cpu);
        for (size_t y = 0; y < 21; y++)
            assert_same(&test, RT_VOLUME, (y + 8) * test.view.targets[RT_VOLUME].width + 4, 37);
    }
}

/* ---- frames ---- */

/* The pipeline's most exact settings apart from froxels: one per pixel, no history, no dither. */
#define PLAIN                                                                                      \
    "froxels=on froxel_px=1 froxel_jitter=off froxel_history=0 taa=off "                           \
    "target_format=float ray_dither_amount=0 upscale_amount_px=0 steps=64 "

static struct neph_image *render_last_frame(struct neph_vulkan *vulkan,
                                            const struct neph_scene *scene, const char *assignments,
                                            int frames, neph_realtime_observer *observer,
                                            void *context)
{
    const struct neph_settings settings = test_settings(assignments);
    OWNED(realtime)
    struct neph_realtime *realtime = test_sequence(vulkan, scene, &settings, WIDTH_PX, HEIGHT_PX);
    struct neph_image *image = NULL;
    neph_realtime_observe(realtime, observer, context);
    for (int frame = 0; frame < frames; frame++) { /* the scene's last frame repeats */
        neph_image_destroy(image);
        image = test_next(realtime, scene, frame, NULL);
    }
    return image;
}

/* Fog over the ground up to the end of the froxels, a level camera at 1.6 m. */
static void scene_fog(struct test_scene *test)
{
    test_scene_init(test);
    test->scene.background_w_per_m2_sr = make_grey(0.0);
    struct neph_medium *fog = test_add_medium(test, 0.08, 0.0, 0.0);
    fog->bounds = (struct neph_bounds){{-200, -2, -23}, {200, 20, 1}};
    test_add_box(test, (struct neph_vec3){-40, -3, -60}, (struct neph_vec3){40, -1, 3});
}

static void scene_fence(struct test_scene *test)
{
    scene_fog(test);
    test->scene.sun.direction = neph_vec3_normalize((struct neph_vec3){0.2, 0.5, -0.8});
    for (int i = 0; i < 8; i++)
        test_add_box(test, (struct neph_vec3){-4.0 + i, -1.0, -9.0},
                     (struct neph_vec3){-3.6 + i, 3.0, -8.7});
}

static void scene_point_lights(struct test_scene *test)
{
    scene_fog(test);
    test->scene.sun.present = false;
    test->scene.light_count = 2;
    test->scene.lights[0] = (struct neph_light){.position_m = {-1.3, 2.2, -7.0},
                                                .intensity_w_per_sr = {9, 8, 7}};
    test->scene.lights[1] = (struct neph_light){.position_m = {2.0, 3.0, -12.0},
                                                .intensity_w_per_sr = {20, 30, 40},
                                                .is_spot = true,
                                                .axis = {0, -1, 0},
                                                .inner_cosine = 0.9,
                                                .outer_cosine = 0.8};
    test_add_box(test, (struct neph_vec3){-1.0, -1.0, -5.0}, (struct neph_vec3){-0.8, 2.0, -4.8});
}

struct error {
    double bias, rms; /* of the media's radiance, over its mean */
};

/* Errors of the last frame, with its camera. */
static struct error measure_error(const struct test_scene *test, const struct neph_image *image)
{
    const struct neph_camera camera = neph_scene_camera(&test->scene, 1e6);
    float *volume[3];
    assert_true(neph_image_rgb(image, "volume", volume));
    double sum = 0.0, expected_sum = 0.0, squares = 0.0;
    for (int p = 0; p < WIDTH_PX * HEIGHT_PX; p++) {
        const struct neph_pixel_ray ray = neph_camera_ray(&camera, WIDTH_PX, HEIGHT_PX,
                                                          p % WIDTH_PX, p / WIDTH_PX);
        const double expected =
            neph_transport_ray(&test->scene, ray.origin_m, ray.direction).volume.g;
        const double found = (double)volume[1][p];
        sum += found;
        expected_sum += expected;
        squares += (found - expected) * (found - expected);
    }
    return (struct error){sum / expected_sum - 1.0,
                          sqrt(squares * WIDTH_PX * HEIGHT_PX) / expected_sum};
}

/* Prints the table of docs/lights.md. */
static void converges(struct neph_vulkan *vulkan, const char *name,
                      void (*make)(struct test_scene *test), double most_rms)
{
    struct test_scene test;
    make(&test);
    struct error last = {1.0, 1.0};
    for (int slices = neph_test_by_day(64, 8); slices <= neph_test_by_day(64, 256); slices *= 2) {
        char settings[400];
        snprintf(settings, sizeof(settings),
                 PLAIN "froxel_end_m=24 lamp_peaks=off froxel_slices=%d", slices);
        OWNED(image)
        struct neph_image *image = render_last_frame(vulkan, &test.scene, settings, 1, NULL, NULL);
        const struct error error = measure_error(&test, image);
        print_message("%s, %3d slices: bias %+.1e, rms %.1e\n", name, slices, error.bias,
                      error.rms);
        assert_true(error.rms < 0.8 * last.rms);
        if (slices >= 64)
            assert_true(error.rms < most_rms);
        last = error;
    }
}

static void test_shafts_of_a_fence(void **state)
{
    converges(*state, "fence", scene_fence, 0.03);
}

static void test_point_lights(void **state)
{
    converges(*state, "lamps", scene_point_lights, 0.03);
}

/* Columns as wide as four pixels; the peaks of lights are computed per pixel, or are lost. */
static void test_light_peaks_have_pixel_resolution(void **state)
{
    struct test_scene test;
    struct error errors[2];
    scene_point_lights(&test);
    for (int peaks = 0; peaks < 2; peaks++) {
        char settings[400];
        snprintf(settings, sizeof(settings),
                 PLAIN "froxel_px=4 froxel_end_m=24 froxel_slices=64 lamp_peaks=%s",
                 peaks ? "on" : "off");
        OWNED(image)
        struct neph_image *image = render_last_frame(*state, &test.scene, settings, 1, NULL, NULL);
        errors[peaks] = measure_error(&test, image);
        print_message("lamps, columns of 4 pixels, peaks %s: bias %+.1e, rms %.1e\n",
                      peaks ? "on" : "off", errors[peaks].bias, errors[peaks].rms);
    }
    assert_true(errors[1].rms < 0.25 * errors[0].rms && fabs(errors[1].bias) < 0.02);
}

/* ---- light ---- */

/* Scattered light per metre at a point, and the extinction. */
static void light_at(const struct neph_scene *scene, struct neph_vec3 point_m,
                     struct neph_vec3 direction, double light[2])
{
    const struct neph_medium *fog = &scene->media[0];
    const double per_m = neph_medium_extinction_per_m(fog, point_m);
    light[0] = 0.0;
    light[1] = per_m;
    if (!neph_scene_is_sun_visible(scene, point_m))
        return;
    const double depth =
        neph_scene_optical_depth(scene, point_m, scene->sun.direction, 0.0, INFINITY).g;
    light[0] = per_m * fog->albedo.g *
               neph_phase_per_sr(&fog->phase, neph_vec3_dot(direction, scene->sun.direction)) *
               scene->sun.irradiance_w_per_m2.g * exp(-depth);
}

struct lit_check {
    const struct neph_scene *scene;
    int lit, dark, wrong;
};

static double extinction_at(const struct neph_scene *scene, struct neph_vec3 point_m,
                            struct neph_vec3 direction, double along_m)
{
    return neph_medium_extinction_per_m(&scene->media[0],
                                        neph_vec3_along(point_m, direction, along_m));
}

/* Compares each froxel at its centre, except those that a face of the fog cuts or whose shadow
 * changes within a millimetre. */
static void check_light(struct neph_rt_device *device, const struct neph_rt_pass *pass,
                        void *context)
{
    struct lit_check *check = context;
    if (strcmp(pass->name, "froxel light") != 0)
        return;
    const struct reference cpu = {.view = device->view};
    const struct neph_gpu_target *shape = &device->view->targets[RT_FROXELS];
    OWNED(memory) uint32_t *words = test_words(device, RT_FROXELS);
    const struct neph_camera camera = neph_scene_camera(check->scene, 0.0);
    const int slices = (int)device->view->settings[RT_FROXEL_SLICES];
    for (int i = 0; i < WIDTH_PX * HEIGHT_PX * slices; i++) {
        const int column = i % WIDTH_PX, row = i / WIDTH_PX % HEIGHT_PX;
        const int slice = i / (WIDTH_PX * HEIGHT_PX);
        const struct neph_pixel_ray ray = neph_camera_ray(&camera, WIDTH_PX, HEIGHT_PX, column,
                                                          row);
        const double slope = 1.0 / neph_vec3_dot(ray.direction, camera.forward);
        const double middle_m = 0.5 * (cpu_froxel_edge_m(&cpu, slice) +
                                       cpu_froxel_edge_m(&cpu, slice + 1));
        double light[2], near[2], far[2];
        const struct neph_vec3 point_m = neph_vec3_along(ray.origin_m, ray.direction,
                                                         middle_m * slope);
        light_at(check->scene, point_m, ray.direction, light);
        const double half_m = 0.5 * slope *
                              (cpu_froxel_edge_m(&cpu, slice + 1) - cpu_froxel_edge_m(&cpu, slice));
        if (extinction_at(check->scene, point_m, ray.direction, -half_m) != light[1] ||
            extinction_at(check->scene, point_m, ray.direction, half_m) != light[1])
            continue;
        light_at(check->scene, neph_vec3_along(point_m, ray.direction, -1e-3), ray.direction, near);
        light_at(check->scene, neph_vec3_along(point_m, ray.direction, 1e-3), ray.direction, far);
        if ((near[0] > 0.0) != (far[0] > 0.0))
            continue;
        float found[4];
        neph_rt_load(shape, words, (size_t)i, found);
        check->lit += light[0] > 0.0;
        check->dark += light[0] <= 0.0;
        check->wrong += !(fabs((double)found[1] - light[0]) <= 1e-4 * light[0] + 1e-9) ||
                        !(fabs((double)found[3] - light[1]) <= 1e-5 * light[1]);
    }
}

static void test_each_froxel_has_its_light(void **state)
{
    struct test_scene test;
    scene_fence(&test);
    struct lit_check check = {.scene = &test.scene};
    struct neph_image *image = render_last_frame(
        *state, &test.scene, PLAIN "froxel_hold=off froxel_end_m=24 froxel_slices=16", 1,
        check_light, &check);
    neph_image_destroy(image);
    assert_true(check.lit > 1000 && check.dark > 500);
    assert_int_equal(check.wrong, 0);
}

/* ---- walls and seams ---- */

/* A dark room; behind its wall, 6 m away, a light in the same fog. For the scene without a wall the
 * wall is behind the camera: equal numbers of solids have the same kernels. */
static void scene_room(struct test_scene *test, bool wall)
{
    scene_fog(test);
    test->scene.sun.present = false;
    test->scene.light_count = 1;
    test->scene.lights[0] = (struct neph_light){.position_m = {0.3, 1.8, -6.6},
                                                .intensity_w_per_sr = {10, 10, 10}};
    const double z_m = wall ? -6.0 : 60.0;
    test_add_box(test, (struct neph_vec3){-20, -3, z_m - 0.3}, (struct neph_vec3){20, 12, z_m});
}

/* The largest light through the wall, over the light without a wall. */
static double leak(struct neph_vulkan *vulkan, const char *assignments)
{
    struct test_scene room, open;
    scene_room(&room, true);
    scene_room(&open, false);
    OWNED(image)
    struct neph_image *dark = render_last_frame(vulkan, &room.scene, assignments, 8, NULL, NULL);
    OWNED(image)
    struct neph_image *lit = render_last_frame(vulkan, &open.scene, assignments, 8, NULL, NULL);
    float *a[3], *b[3];
    assert_true(neph_image_rgb(dark, "volume", a) && neph_image_rgb(lit, "volume", b));
    double most = 0.0;
    for (int p = 0; p < WIDTH_PX * HEIGHT_PX; p++)
        most = fmax(most, (double)a[1][p] / (double)b[1][p]);
    return most;
}

static void test_no_light_leaks_through_a_wall(void **state)
{
#define ROOM_SCENE                                                                                 \
    "froxels=on froxel_px=2 froxel_end_m=24 taa=off froxel_slices=32 target_format=float "
    const double held = leak(*state, ROOM_SCENE), alone = leak(*state, ROOM_SCENE "lamp_peaks=off"),
                 let = leak(*state, ROOM_SCENE "lamp_peaks=off froxel_hold=off");
    print_message("through a wall: %.1e of the light, all in froxels %.1e, and %.1e with "
                  "froxel_hold=off\n",
                  held, alone, let);
    assert_true(held < 0.01 && alone < 0.01);
    assert_true(let > 0.01);
}

/* For any place of the seam to the march the frame is as good as without froxels. After sixteen
 * frames every texel has been marched. */
static void test_seam_is_invisible(void **state)
{
    neph_test_waits_for_the_night();
    struct test_scene test;
    scene_fog(&test);
    test.scene.solid_count = 0;
    test.scene.media[0].bounds = (struct neph_bounds){{-200, -50, -60}, {200, 50, 1}};
    const char *const ends[] = {"froxel_end_m=5", "froxel_end_m=11", "froxel_end_m=24",
                                "froxels=off"};
    struct error errors[COUNT(ends)];
    for (size_t i = 0; i < COUNT(ends); i++) {
        char settings[400];
        snprintf(settings, sizeof(settings), PLAIN "froxel_slices=64 %s", ends[i]);
        OWNED(image)
        struct neph_image *image = render_last_frame(*state, &test.scene, settings, 16, NULL, NULL);
        errors[i] = measure_error(&test, image);
        print_message("%s: bias %+.1e, rms %.1e\n", ends[i], errors[i].bias, errors[i].rms);
    }
    for (size_t i = 0; i + 1 < COUNT(ends); i++)
        assert_true(errors[i].rms < 1.1 * errors[COUNT(ends) - 1].rms + 1e-3);
}

/* With a static camera the mean over jittered frames is no worse than the froxels' centres. */
static void test_jitter_and_history(void **state)
{
    neph_test_waits_for_the_night();
    struct test_scene test;
    scene_fence(&test);
    OWNED(image)
    struct neph_image *image = render_last_frame(
        *state, &test.scene,
        PLAIN "froxel_slices=32 froxel_end_m=24 froxel_jitter=on froxel_history=0.95", 64, NULL,
        NULL);
    const struct error error = measure_error(&test, image);
    print_message("64 pictures with jitter and history: bias %+.1e, rms %.1e\n", error.bias,
                  error.rms);
    assert_true(fabs(error.bias) < 0.01 && error.rms < 0.04);
}

static void history_follows(struct neph_vulkan *vulkan, const char *name,
                            void (*make)(struct test_scene *test), struct neph_phase phase,
                            double most_more)
{
    struct test_scene test;
    make(&test);
    test.scene.media[0].phase = phase;
    struct neph_camera_key keys[2] = {test.key, test.key};
    keys[1].frame = 8.0;
    keys[1].position_m.x += 2.4;
    keys[1].position_m.z -= 1.2;
    test.scene.camera_keys = keys;
    test.scene.camera_key_count = 2;
    test.scene.frame_count = 9;
    struct error errors[2];
    for (int i = 0; i < 2; i++) {
        char settings[400];
        snprintf(settings, sizeof(settings),
                 PLAIN "froxel_slices=64 froxel_end_m=24 froxel_history=%g", i ? 0.8 : 0.0);
        OWNED(image)
        struct neph_image *image = render_last_frame(vulkan, &test.scene, settings, 9, NULL, NULL);
        errors[i] = measure_error(&test, image);
        print_message("%s, moving, history %g: bias %+.1e, rms %.1e\n", name, i ? 0.8 : 0.0,
                      errors[i].bias, errors[i].rms);
    }
    assert_true(errors[1].rms < errors[0].rms + most_more);
}

/* A camera moves past shafts at 0.3 m a frame: the history of a place of the world is read where
 * that place was in the frame before. Two errors remain: from the new camera the place may scatter
 * another part of its light, and a column that has come close to a light keeps its earlier light
 * for some frames. */
static void test_history_follows_the_world(void **state)
{
    neph_test_waits_for_the_night();
    const struct neph_phase even = {NEPH_PHASE_ISOTROPIC, 0.0};
    const struct neph_phase forward = {NEPH_PHASE_HENYEY_GREENSTEIN, 0.4};
    history_follows(*state, "fence, isotropic", scene_fence, even, 0.05);
    history_follows(*state, "fence, g 0.4", scene_fence, forward, 0.15);
    history_follows(*state, "lamps, isotropic", scene_point_lights, even, 0.6);
}

/* ---- lights that change ---- */

enum { BEFORE_CHANGE = 20, AFTER_CHANGE = 6 };

/* Sets the lights of a frame; frame 0 is the first after the change. */
typedef void change(struct neph_scene *scene, int frame);

static const struct neph_rgb bright = {40, 30, 20}, faint = {4, 3, 2}, dark = {0, 0, 0};

static void end_lamp(struct neph_scene *scene, int frame)
{
    scene->lights[0].intensity_w_per_sr = frame < 0 ? bright : dark;
}

static void start_lamp(struct neph_scene *scene, int frame)
{
    scene->lights[0].intensity_w_per_sr = frame < 0 ? dark : bright;
}

static void dim_lamp(struct neph_scene *scene, int frame)
{
    scene->lights[0].intensity_w_per_sr = frame < 0 ? bright : faint;
}

static void move_lamp(struct neph_scene *scene, int frame)
{
    scene->lights[0].intensity_w_per_sr = bright;
    scene->lights[0].position_m.x = -1.3 + 0.2 * frame;
}

static void end_sun(struct neph_scene *scene, int frame)
{
    scene->sun.present = frame < 0;
}

static void start_sun(struct neph_scene *scene, int frame)
{
    scene->sun.present = frame >= 0;
}

/* The largest rms error of the frames after a change; `is_held`: of the first of them, with the
 * lights of the last from the start. */
static double measure_change(struct neph_vulkan *vulkan, change *set, bool has_sun, bool is_held)
{
    struct test_scene test;
    double most_rms = 0.0;
    const struct neph_settings settings = test_settings(
        "froxels=on froxel_px=2 froxel_end_m=24 froxel_slices=64 taa=off target_format=float "
        "ray_dither_amount=0 upscale_amount_px=0 steps=64");
    const int last = is_held ? 0 : AFTER_CHANGE - 1;
    scene_point_lights(&test);
    test.scene.sun.present = has_sun;
    set(&test.scene, is_held ? AFTER_CHANGE - 1 : -BEFORE_CHANGE);
    OWNED(realtime)
    struct neph_realtime *realtime = test_sequence(vulkan, &test.scene, &settings, WIDTH_PX,
                                                   HEIGHT_PX);
    for (int frame = -BEFORE_CHANGE; frame <= last; frame++) {
        set(&test.scene, is_held ? AFTER_CHANGE - 1 : frame);
        OWNED(image)
        struct neph_image *image = test_next(realtime, &test.scene, frame + BEFORE_CHANGE, NULL);
        if (frame >= 0)
            most_rms = fmax(most_rms, measure_error(&test, image).rms);
    }
    return most_rms;
}

/* In each frame after a change of lights the error is at most that of the same lights without
 * history: the mean of samples with weights 0.1 0.9^k has 0.1 / 1.9 of the variance of one sample.
 */
static void test_history_follows_lights(void **state)
{
    static const struct {
        const char *name;
        change *set;
        bool has_sun;
    } cases[] = {
        {"lamp ends", end_lamp, false},
        {"lamp starts", start_lamp, false},
        {"lamp ends in the sun", end_lamp, true},
        {"lamp starts in the sun", start_lamp, true},
        {"lamp dims", dim_lamp, false},
        {"lamp moves", move_lamp, false},
        {"sun ends", end_sun, true},
        {"sun starts", start_sun, true},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        const double held = measure_change(*state, cases[i].set, cases[i].has_sun, true);
        const double most = measure_change(*state, cases[i].set, cases[i].has_sun, false);
        print_message("%s: rms at most %.3f, with constant lights %.3f\n", cases[i].name, most,
                      held);
        assert_true(most < sqrt(1.9 / 0.1) * held);
    }
}

/* Scenes that froxels do not support are refused. */
static void test_refusals(void **state)
{
    struct test_scene test;
    char reason[256] = "";
    scene_fence(&test);
    test.scene.scattering = NEPH_SCATTERING_MULTIPLE;
    const struct neph_settings settings = test_settings("froxels=on lighting=slab");
    assert_false(neph_realtime_can_render(&test.scene, &settings, reason, sizeof(reason)));
    assert_non_null(strstr(reason, "froxels"));
}

#include "tests/renderer/main.h"
