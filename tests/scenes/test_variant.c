/* SPDX-License-Identifier: MIT
 *
 * Variants of scenes: their changes, unchanged parts, and equality of file and scene.
 */
#include "tests/base/scratch.h"

#include "scenes/motion.h"
#include "scenes/variant.h"

static struct neph_scene *load(const char *path)
{
    struct neph_scene *scene = NULL;
    struct neph_diag diag = {.line = 0};
    neph_assert_ok(neph_scene_load(path, &scene, &diag), &diag);
    return scene;
}

static struct neph_scene *make(const struct neph_scene *scene, enum neph_variant_kind kind,
                               int frame, int frame_count)
{
    struct neph_scene *made = NULL;
    struct neph_diag diag = {.line = 0};
    const struct neph_variant variant = {kind, frame, frame_count};
    neph_assert_ok(neph_scene_variant(scene, &variant, &made, &diag), &diag);
    return made;
}

static const char wind_cloud[] = NEPH_SOURCE_DIR "/scenes/stress/wind_cloud.yaml";

static double irradiance_of(const struct neph_scene *scene, double frame)
{
    return neph_scene_sun(scene, frame).irradiance_w_per_m2.g;
}

/* --- changes ---------------------------------------------------------------------------------- */

static void test_sun_step(void **state)
{
    struct neph_scene *scene = load(wind_cloud);
    struct neph_scene *made = make(scene, NEPH_VARIANT_SUN_STEP, 40, 100);
    assert_string_equal(made->name, "wind_cloud_sun_step");
    assert_non_null(strstr(made->title, "from frame 40"));
    assert_string_not_equal(made->hash, scene->hash);
    assert_int_equal(made->frame_count, 100);
    const double before = irradiance_of(scene, 0);
    for (int frame = 0; frame < 100; frame++)
        assert_true(irradiance_of(made, frame) == (frame < 40 ? 1.0 : 4.0) * before);
    neph_scene_destroy(made);
    neph_scene_destroy(scene);
}

static void test_sun_sine(void **state)
{
    struct neph_scene *scene = load(wind_cloud);
    struct neph_scene *made = make(scene, NEPH_VARIANT_SUN_SINE, 0, 256);
    double least = INFINITY;
    for (int frame = 0; frame < 256; frame++) {
        const double expected = 1.0 + 0.3 * (sin(2.0 * M_PI * frame / 16.0) +
                                             sin(2.0 * M_PI * frame / 32.0) +
                                             sin(2.0 * M_PI * frame / 64.0));
        neph_assert_close(irradiance_of(made, frame), expected * irradiance_of(scene, 0), 1e-12,
                          0.0);
        least = fmin(least, expected);
    }
    assert_true(least > 0.1);
    neph_scene_destroy(made);
    neph_scene_destroy(scene);
}

/* In the frame, the former centre is then at the left by half of the height: tan(fov / 2) is the
 * upper end of the frame, and a rotation by fov / 2 moves the old centre to -tan(fov / 2). */
static void test_camera_cut(void **state)
{
    struct neph_scene *scene = load(wind_cloud);
    struct neph_scene *made = make(scene, NEPH_VARIANT_CAMERA_CUT, 7, 64);
    const struct neph_camera old = neph_scene_camera(scene, 0);
    for (int frame = 1; frame < 64; frame++) {
        const struct neph_camera camera = neph_scene_camera(made, frame);
        const double x = neph_vec3_dot(old.forward, camera.right);
        const double z = neph_vec3_dot(old.forward, camera.forward);
        assert_int_equal(neph_scene_is_cut(made, frame - 1, frame), frame == 7);
        neph_assert_close(x / z, frame < 7 ? 0.0 : -tan(0.5 * old.vertical_fov_rad), 1e-12, 1e-15);
        neph_assert_close(neph_vec3_length(neph_vec3_sub(camera.position_m, old.position_m)), 0.0,
                          0.0, 0.0);
    }
    assert_int_equal(made->sun_key_count, 0);
    neph_scene_destroy(made);
    neph_scene_destroy(scene);
}

/* Wind and media are the scene's. A static copy borrows from the variant, and the variant from the
 * scene. */
static void test_the_rest_is_as_it_was(void **state)
{
    struct neph_scene *scene = load(wind_cloud), *still = NULL;
    struct neph_scene *made = make(scene, NEPH_VARIANT_SUN_STEP, 20, 64);
    neph_assert_ok(neph_scene_at(made, 30, &still, NULL), NULL);
    assert_true(still->sun.irradiance_w_per_m2.r == 4.0 * scene->sun.irradiance_w_per_m2.r);
    assert_true(neph_scene_wind_displacement_m(made, 30).x ==
                neph_scene_wind_displacement_m(scene, 30).x);
    assert_int_equal(still->medium_count, scene->medium_count);
    neph_scene_destroy(still);
    neph_scene_destroy(made);
    neph_scene_destroy(scene);
}

/* --- impossible variants ---------------------------------------------------------------------- */

static void test_obstacles(void **state)
{
    static const struct {
        const char *scene;
        enum neph_variant_kind kind;
        const char *words;
    } cases[] = {
        {"stress/sun_step", NEPH_VARIANT_SUN_STEP, "sun moves already"},
        {"stress/sun_step", NEPH_VARIANT_SUN_SINE, "sun moves already"},
        {"stress/camera_pan", NEPH_VARIANT_CAMERA_CUT, "camera moves already"},
        {"catalog/orthographic_slab", NEPH_VARIANT_CAMERA_CUT, "orthographic"},
        {"catalog/absorbing_slab", NEPH_VARIANT_SUN_STEP, "no sun"},
        {"stress/camera_pan", NEPH_VARIANT_SUN_STEP, NULL},
        {"stress/sun_step", NEPH_VARIANT_CAMERA_CUT, NULL},
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        char *path = neph_format(NEPH_SOURCE_DIR "/scenes/%s.yaml", cases[i].scene);
        struct neph_scene *scene = load(path), *made = NULL;
        struct neph_diag diag = {.line = 0};
        const struct neph_variant variant = {cases[i].kind, 1, 2};
        const char *obstacle = neph_variant_obstacle(scene, cases[i].kind);
        assert_int_equal(neph_scene_variant(scene, &variant, &made, &diag),
                         cases[i].words ? NEPH_ERR_UNSUPPORTED : NEPH_OK);
        assert_int_equal(obstacle != NULL, cases[i].words != NULL);
        assert_true(!obstacle || (strstr(obstacle, cases[i].words) &&
                                  strstr(diag.message, obstacle) && made == NULL));
        neph_scene_destroy(made);
        neph_scene_destroy(scene);
        free(path);
    }
}

static void test_frames_out_of_range(void **state)
{
    struct neph_scene *scene = load(wind_cloud), *made = NULL;
    static const struct neph_variant wrong[] = {
        {NEPH_VARIANT_SUN_STEP, 0, 64},   {NEPH_VARIANT_SUN_STEP, 64, 64},
        {NEPH_VARIANT_CAMERA_CUT, -1, 9}, {NEPH_VARIANT_SUN_SINE, 0, 1},
        {NEPH_VARIANT_SUN_SINE, 0, 1025},
    };
    for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++)
        assert_int_equal(neph_scene_variant(scene, &wrong[i], &made, NULL), NEPH_ERR_USAGE);
    neph_scene_destroy(make(scene, NEPH_VARIANT_SUN_SINE, 0, 1024));
    neph_scene_destroy(scene);
}

static void test_time_that_stands_still(void **state)
{
    static const char text[] =
        "name: probe\ntitle: a probe\nphysics: none\nscattering: none\n"
        "camera: {position_m: [0, 1, 50], look_at_m: [0, 1, 0], vertical_fov_deg: 40}\n"
        "frames: {count: 9, pauses: [{frame: 3, count: 4}]}\n";
    char path[SCRATCH_PATH_MAX];
    scratch_write(scratch_path(state, path, "probe.yaml"), text, strlen(text));
    struct neph_scene *scene = load(path);
    assert_non_null(strstr(neph_variant_obstacle(scene, NEPH_VARIANT_CAMERA_CUT), "pauses"));
    neph_scene_destroy(scene);
}

/* --- file ------------------------------------------------------------------------------------- */

/* Each variant that a scene supports, written into the test's folder and read back. */
static int check_files(void **state, const char *path)
{
    struct neph_scene *scene = load(path);
    int count = 0;
    for (int k = 0; k < NEPH_VARIANT_KIND_COUNT; k++) {
        char *text = NULL, name[SCRATCH_PATH_MAX / 4], file[SCRATCH_PATH_MAX];
        struct neph_diag diag = {.line = 0};
        const struct neph_variant variant = {(enum neph_variant_kind)k, 3, 80};
        if (neph_variant_obstacle(scene, variant.kind))
            continue;
        struct neph_scene *made = make(scene, variant.kind, variant.frame, variant.frame_count);
        neph_assert_ok(neph_scene_variant_text(scene, &variant, &text, &diag), &diag);
        snprintf(name, sizeof(name), "%s.yaml", made->name);
        scratch_write(scratch_path(state, file, name), text, strlen(text));
        struct neph_scene *read = load(file);
        assert_string_equal(read->hash, made->hash);
        assert_string_equal(read->title, made->title);
        assert_string_equal(read->description, made->description);
        assert_int_equal(read->frame_count, made->frame_count);
        assert_true(read->frame_rate_hz == made->frame_rate_hz);
        neph_scene_destroy(read);
        neph_scene_destroy(made);
        free(text);
        count++;
    }
    neph_scene_destroy(scene);
    return count;
}

static void test_files_of_the_catalogue(void **state)
{
    static const struct {
        const char *scene;
        int variants;
    } cases[] = {
        {"catalog/height_fog_down", 3}, {"catalog/fence_backlit", 3}, {"stress/ridges", 3},
        {"catalog/camera_dolly", 2},    {"stress/sun_step", 1},       {"stress/wind_cloud", 3},
        {"catalog/white_furnace", 1},
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        char *path = neph_format(NEPH_SOURCE_DIR "/scenes/%s.yaml", cases[i].scene);
        assert_int_equal(check_files(state, path), cases[i].variants);
        free(path);
    }
}

/* Other notations of the same scene: blocks, one flow mapping, a byte order mark, other line ends,
 * letters of several bytes, quotes, keys before and after, a sun of one key, sizes. */
static void test_files_of_all_styles(void **state)
{
    static const char *const texts[] = {
        "title: \"Caf\xc3\xa9 'noir': a probe\"\n"
        "sun: # of the morning\n"
        "  direction: [0.3, 0.7, 0.1]\n"
        "  # a comment\n"
        "  irradiance_w_per_m2:\n"
        "    - 1.7\n"
        "    - 2\n"
        "    - 3\n"
        "\n"
        "physics: |\n"
        "  \xce\xb1 \xce\xb2\n"
        "camera:\n"
        "  position_m: [0, 1, 50]\n"
        "  look_at_m: [0.1, 1, 0]\n"
        "  up: [0.1, 1, 0]\n"
        "  vertical_fov_deg: 39.7\n"
        "frames:\n"
        "  rate_hz: 29.97\n"
        "  sizes:\n"
        "    - {frame: 2, scale: 0.3}\n"
        "scattering: none\n"
        "name: probe\n",
        "{name: probe, title: 'it''s', physics: none, scattering: none, sun: {direction: [1, 2, 3],"
        " irradiance_w_per_m2: [1, 1, 1]}, camera: {position_m: [0, 1, 50], look_at_m: [0, 1, 0], "
        "vertical_fov_deg: 40}}\n",
        "\xef\xbb\xbfname: probe\r\ntitle: a probe\r\nphysics: none\r\nscattering: none\r\n"
        "camera:\r\n  position_m: [0, 1, 50]\r\n  look_at_m: [0, 1, 0]\r\n"
        "  vertical_fov_deg: 40\r\nsun:\r\n  keys: [{frame: 5, direction: [0, 1, 0], "
        "irradiance_w_per_m2: [1, 0.3, 1]}]\r\n",
        "  name: probe\n"
        "  title: a probe\n"
        "  physics: none\n"
        "  scattering: none\n"
        "  sun:\n"
        "    direction: [1, 2, 3]\n"
        "    irradiance_w_per_m2: [1, 2, 3]\n"
        "  camera: {position_m: [0, 1, 50], look_at_m: [0, 1, 0], vertical_fov_deg: 40}",
    };
    for (size_t i = 0; i < sizeof(texts) / sizeof(texts[0]); i++) {
        char path[SCRATCH_PATH_MAX];
        scratch_write(scratch_path(state, path, "probe.yaml"), texts[i], strlen(texts[i]));
        assert_int_equal(check_files(state, path), 3);
    }
}

/* The variant is in another folder than the scene, and still finds the voxels. */
static void test_volumes_are_found(void **state)
{
    static const unsigned char volume[] = {0, 2, 0, 1, 0, 1, 100, 200};
    static const char text[] =
        "name: probe\ntitle: a probe\nphysics: none\nscattering: none\n"
        "camera: {position_m: [0, 1, 50], look_at_m: [0, 1, 0], vertical_fov_deg: 40}\n"
        "media:\n"
        "  - gaussian: {center_m: [0, 5, 0], width_m: 0.5, extinction_per_m: 2, albedo: [1, 1, "
        "1]}\n"
        "  - volume: {file: it's a cloud.df3, center_m: [0, 0, 0], longest_side_m: 1, "
        "extinction_per_m: 2, albedo: [1, 1, 1]}\n";
    char folder[SCRATCH_PATH_MAX], path[2 * SCRATCH_PATH_MAX];
    scratch_path(state, folder, "below");
    neph_assert_ok(neph_dir_create(folder, NULL), NULL);
    snprintf(path, sizeof(path), "%s/it's a cloud.df3", folder);
    scratch_write(path, volume, sizeof(volume));
    snprintf(path, sizeof(path), "%s/probe.yaml", folder);
    scratch_write(path, text, strlen(text));
    assert_int_equal(check_files(state, path), 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sun_step),           cmocka_unit_test(test_sun_sine),
        cmocka_unit_test(test_camera_cut),         cmocka_unit_test(test_the_rest_is_as_it_was),
        cmocka_unit_test(test_obstacles),          cmocka_unit_test(test_frames_out_of_range),
        scratch_test(test_time_that_stands_still), scratch_test(test_files_of_the_catalogue),
        scratch_test(test_files_of_all_styles),    scratch_test(test_volumes_are_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
