/* SPDX-License-Identifier: MIT
 *
 * Engines get static scenes: an engine that writes its input into the frame shows sun, light and
 * wind of the frame, under the scene's name, hash and frame number.
 */
#include "tests/base/scratch.h"
#include "tests/neph_test.h"

#include "harness/run/job.h"
#include "scenes/motion.h"

static bool can_render(const struct neph_scene *scene, const struct neph_settings *settings,
                       char *reason, size_t reason_size)
{
    snprintf(reason, reason_size, "time passes");
    return !neph_scene_moves(scene);
}

/* R: direction to the sun along x. G: its brightness, times the light's. B: place of the blob. */
static enum neph_status paint(const struct neph_shot *shot, struct neph_image **frame,
                              struct neph_cost *cost, struct neph_diag *diag)
{
    const struct neph_scene *scene = shot->scene;
    float *rgb[3];
    neph_assert_ok(neph_image_create(shot->width_px, shot->height_px, frame, diag), diag);
    neph_assert_ok(neph_image_add_rgb(*frame, NULL, rgb, diag), diag);
    rgb[0][0] = (float)scene->sun.direction.x;
    rgb[1][0] = (float)(scene->sun.irradiance_w_per_m2.g * scene->lights[0].intensity_w_per_sr.g);
    rgb[2][0] = (float)scene->media[0].gaussian.center_m.z;
    return NEPH_OK;
}

static const struct neph_option no_options[] = {{.name = NULL}};
static const struct neph_engine painter = {
    .name = "painter", .options = no_options, .can_render = can_render, .render = paint};

static const char text[] =
    "name: probe\n"
    "title: a probe\n"
    "physics: none\n"
    "camera: {position_m: [0, 1, 50], look_at_m: [0, 1, 0], vertical_fov_deg: 40}\n"
    "frames: {count: 9, rate_hz: 2, pauses: [{frame: 2, count: 3}]}\n"
    "sun:\n"
    "  keys:\n"
    "    - {frame: 0, direction: [0, 1, 0], irradiance_w_per_m2: [0, 0, 0]}\n"
    "    - {frame: 4, direction: [1, 0, 0], irradiance_w_per_m2: [0, 8, 0]}\n"
    "lights:\n"
    "  - keys:\n"
    "      - {frame: 0, position_m: [0, 1, 0], intensity_w_per_sr: [1, 3, 1]}\n"
    "      - {frame: 4, position_m: [9, 1, 0], intensity_w_per_sr: [1, 7, 1]}\n"
    "wind: {velocity_m_per_s: [0, 0, 10]}\n"
    "scattering: none\n"
    "media:\n"
    "  - gaussian: {center_m: [0, 1, 5], width_m: 1, extinction_per_m: 1, albedo: [1, 1, 1]}\n";

static void test_engines_see_the_scene_of_the_frame(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_diag diag = {.line = 0};
    struct neph_scene *scene = NULL;
    neph_assert_ok(
        neph_file_write(scratch_path(state, path, "probe.yaml"), text, strlen(text), NULL), NULL);
    neph_assert_ok(neph_scene_load(path, &scene, &diag), &diag);

    const struct neph_engine_info info = {.available = true};
    struct neph_job job = {
        .engine = &painter, .info = &info, .shot = {.scene = scene, .width_px = 1, .height_px = 1}};
    static const int keys[] = {0, 1, 2, 2, 2,
                               2, 3, 4, 5}; /* frame numbers, with a pause of 3 at 2
                                                              */
    for (int i = 0; i < scene->frame_count; i++) {
        struct neph_image *frame = NULL;
        struct neph_cost cost = {0};
        float *rgb[3];
        job.shot.frame = i;
        neph_assert_ok(neph_job_render(&job, &frame, &cost, &diag), &diag);
        assert_true(neph_image_rgb(frame, NULL, rgb));
        const double turned = fmin(keys[i] / 4.0, 1.0); /* of a right angle */
        /* 1e-7: one rounding to float */
        neph_assert_close((double)rgb[0][0], sin(turned * acos(0.0)), 1e-7, 1e-15);
        neph_assert_close((double)rgb[1][0], 8.0 * turned * (3.0 + 4.0 * turned), 1e-7, 0.0);
        neph_assert_close((double)rgb[2][0], 5.0 + 5.0 * keys[i], 1e-7, 0.0);
        assert_string_equal(neph_image_attribute(frame, "neph.scene"), "probe");
        assert_string_equal(neph_image_attribute(frame, "neph.scene_hash"), scene->hash);
        assert_int_equal(atoi(neph_image_attribute(frame, "neph.frame")), i);
        neph_image_destroy(frame);
    }
    assert_true(job.shot.scene == scene);
    neph_scene_destroy(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        scratch_test(test_engines_see_the_scene_of_the_frame),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
