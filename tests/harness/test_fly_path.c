/* SPDX-License-Identifier: MIT
 *
 * A flight saved as a scene file has the same camera in every frame when it is loaded.
 */
#include "tests/base/scratch.h"

#include "harness/fly/camera.h"
#include "harness/fly/path.h"
#include "scenes/motion.h"

static const char text[] =
    "# a comment that stays\n"
    "name: valley\n"
    "title: A valley\n"
    "physics: a test\n"
    "camera:\n"
    "  position_m: [0, 2, 0]\n"
    "  look_at_m: [0, 2, -10]\n"
    "  vertical_fov_deg: 40\n"
    "frames: {count: 3, rate_hz: 25, pauses: [{frame: 1, count: 4}]}\n"
    "wind: {velocity_m_per_s: [1, 0, 0]}\n"
    "scattering: single\n"
    "media:\n"
    "  - gaussian: {center_m: [0, 0, -9], width_m: 2, extinction_per_m: 0.1, albedo: [1, 1, 1]}\n";

static struct neph_scene *load(const char *path)
{
    struct neph_scene *scene = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_scene_load(path, &scene, &diag), &diag);
    return scene;
}

static struct neph_scene *make_scene(void **state)
{
    char path[SCRATCH_PATH_MAX];
    scratch_write(scratch_path(state, path, "valley.yaml"), text, sizeof(text) - 1);
    return load(path);
}

static struct neph_scene *write_and_load(void **state, const struct neph_fly_path *path,
                                         const struct neph_scene *scene, const char *name)
{
    const struct scratch *scratch = *state;
    char expected[SCRATCH_PATH_MAX];
    const char *file = NULL;
    struct neph_arena arena = {0};
    struct neph_diag diag = {0};
    neph_assert_ok(neph_fly_path_write(path, scene, scratch->folder, &arena, &file, &diag), &diag);
    assert_string_equal(file, scratch_path(state, expected, name));
    neph_arena_finish(&arena);
    return load(expected);
}

static struct neph_camera_key make_key_at(double x)
{
    return (struct neph_camera_key){.position_m = {x, 2.0 + x / 3.0, 0.1},
                                    .look_at_m = {x, 2.0, -10.0 / 3.0}};
}

/* Static at 0, moves for five frames, static for five, moves on. */
static double place(int frame)
{
    return frame < 3 ? 0.0 : frame < 8 ? 0.1 * (frame - 2) : frame < 13 ? 0.5 : 0.7;
}

static void test_read_back_it_is_the_same_camera_in_every_frame(void **state)
{
    struct neph_scene *scene = make_scene(state);
    struct neph_fly_path *path = calloc(1, sizeof(*path));
    for (int frame = 0; frame < 15; frame++) {
        const struct neph_camera_key key = make_key_at(place(frame));
        assert_true(neph_fly_path_add(path, &key));
    }
    struct neph_scene *flown = write_and_load(state, path, scene, "valley_path.yaml");
    assert_string_equal(flown->name, "valley_path");
    assert_int_equal(flown->frame_count, 15);
    assert_int_equal(flown->pause_count, 0);
    assert_true(flown->frame_rate_hz == 25.0);
    assert_int_equal(flown->wind_key_count, 1);
    for (int frame = 0; frame < 15; frame++) {
        const struct neph_camera_key key = make_key_at(place(frame));
        struct neph_scene *still = NULL;
        neph_assert_ok(neph_scene_at(flown, frame, &still, NULL), NULL);
        assert_true(neph_fly_is_same_view(&still->camera_keys[0], &key));
        neph_scene_destroy(still);
    }
    neph_scene_destroy(flown);
    neph_scene_destroy(scene);
    free(path);
}

static void test_no_file_is_replaced(void **state)
{
    struct neph_scene *scene = make_scene(state);
    struct neph_fly_path *path = calloc(1, sizeof(*path));
    const struct neph_camera_key key = make_key_at(0.0);
    neph_fly_path_add(path, &key);
    neph_scene_destroy(write_and_load(state, path, scene, "valley_path.yaml"));
    neph_scene_destroy(write_and_load(state, path, scene, "valley_path_2.yaml"));
    neph_scene_destroy(write_and_load(state, path, scene, "valley_path_3.yaml"));
    assert_int_equal(scratch_count(state), 4);
    neph_scene_destroy(scene);
    free(path);
}

/* A name is free when none of its files exists; either of two files by itself takes it. */
static void test_a_name_is_free_of_all_its_files(void **state)
{
    static const char *const suffixes[] = {".exr", ".png", NULL};
    const struct scratch *scratch = *state;
    char path[SCRATCH_PATH_MAX];
    scratch_write(scratch_path(state, path, "valley_fly.png"), "", 0);
    scratch_write(scratch_path(state, path, "valley_fly_2.exr"), "", 0);
    struct neph_arena arena = {0};
    assert_string_equal(neph_fly_free_name(scratch->folder, "valley_fly", suffixes, &arena),
                        scratch_path(state, path, "valley_fly_3"));
    neph_arena_finish(&arena);
}

/* A title has room for 120 bytes, 24 of them for its end: bytes 96 and 97 here are one character.
 */
static void test_a_long_title_is_cut_between_characters(void **state)
{
    struct neph_scene *scene = make_scene(state);
    struct neph_fly_path *path = calloc(1, sizeof(*path));
    const struct neph_camera_key key = make_key_at(0.0);
    char title[121] = "";
    while (strlen(title) < 95)
        strcat(title, "v");
    while (strlen(title) < 119)
        strcat(title, "\u00e4");
    scene->title = title;
    neph_fly_path_add(path, &key);
    struct neph_scene *flown = write_and_load(state, path, scene, "valley_path.yaml");
    strcpy(title + 95, "; a camera flown by hand");
    assert_string_equal(flown->title, title);
    neph_scene_destroy(flown);
    neph_scene_destroy(scene);
    free(path);
}

static void test_a_scene_file_has_no_room_for_more_keys(void **state)
{
    struct neph_scene *scene = make_scene(state);
    struct neph_fly_path *path = calloc(1, sizeof(*path));
    int count = 0;
    for (struct neph_camera_key key = make_key_at(0.0); neph_fly_path_add(path, &key); count++)
        key = make_key_at(0.001 * (count + 1));
    assert_int_equal(count, NEPH_SCENE_KEYS_MAX);
    struct neph_scene *flown = write_and_load(state, path, scene, "valley_path.yaml");
    assert_int_equal(flown->frame_count, NEPH_SCENE_KEYS_MAX);
    neph_scene_destroy(flown);
    neph_scene_destroy(scene);
    free(path);
}

static void test_a_path_without_frames_is_refused(void **state)
{
    const struct scratch *scratch = *state;
    struct neph_scene *scene = make_scene(state);
    struct neph_fly_path *path = calloc(1, sizeof(*path));
    struct neph_arena arena = {0};
    const char *file = NULL;
    assert_int_equal(neph_fly_path_write(path, scene, scratch->folder, &arena, &file, NULL),
                     NEPH_ERR_USAGE);
    assert_null(file);
    assert_int_equal(scratch_count(state), 1);
    neph_scene_destroy(scene);
    free(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        scratch_test(test_read_back_it_is_the_same_camera_in_every_frame),
        scratch_test(test_no_file_is_replaced),
        scratch_test(test_a_name_is_free_of_all_its_files),
        scratch_test(test_a_long_title_is_cut_between_characters),
        scratch_test(test_a_scene_file_has_no_room_for_more_keys),
        scratch_test(test_a_path_without_frames_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
