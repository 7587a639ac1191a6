/* SPDX-License-Identifier: MIT
 *
 * Scene files: errors are reported with line, column and value; valid files get every default; the
 * hash depends only on the physics; damaged files never crash.
 */
#include "tests/base/scratch.h"

#include "base/files.h"
#include "scenes/gates.h"
#include "scenes/grid.h"
#include "scenes/media.h"
#include "scenes/scene.h"

#include <dirent.h>
#include <unistd.h>

static const char good[] =
    "name: probe\n"
    "title: a probe\n"
    "physics: none\n"
    "camera: {position_m: [0, 1, 5], look_at_m: [0, 1, 0], vertical_fov_deg: 40}\n"
    "sun: {direction: [0, 2, 0], irradiance_w_per_m2: [3, 3, 3]}\n"
    "scattering: single\n"
    "media:\n"
    "  - homogeneous:\n"
    "      extinction_per_m: 0.5\n"
    "      albedo: [1, 0.5, 0]\n"
    "      bounds: {min_m: [-1, 0, -1], max_m: [1, 2, 1]}\n";

/* Writes `text` as probe.yaml in a new folder, loads it, removes it. */
static enum neph_status load_text(const char *text, size_t size, struct neph_scene **scene,
                                  struct neph_diag *diag)
{
    char folder[] = "/tmp/neph-load-XXXXXX";
    assert_non_null(mkdtemp(folder));
    char *path = neph_path_join(folder, "probe.yaml");
    scratch_write(path, text, size);
    *scene = NULL;
    const enum neph_status status = neph_scene_load(path, scene, diag);
    free(path);
    neph_dir_remove(folder, NULL);
    return status;
}

/* `good` with the first `from` replaced by `to`. */
static char *edited(const char *from, const char *to)
{
    const char *at = strstr(good, from);
    assert_non_null(at);
    return neph_format("%.*s%s%s", (int)(at - good), good, to, at + strlen(from));
}

/* Parts of `good` that motion replaces or follows. */
#define VIEW "position_m: [0, 1, 5], look_at_m: [0, 1, 0]"
#define LIGHT "direction: [0, 2, 0], irradiance_w_per_m2: [3, 3, 3]"
#define MODE "scattering: single\n"
#define LAMP "{position_m: [0, 1, 0], intensity_w_per_sr: [1, 1, 1], cone: "
#define LAMP_KEY(frame) "{frame: " #frame ", position_m: [0, 5, 0], intensity_w_per_sr: [1, 1, 1]"
#define BLOB                                                                                       \
    "media:\n  - gaussian: {center_m: [0, 1, 0], width_m: 1, extinction_per_m: 1, albedo: [1, 1, " \
    "1]}"

static const struct bad {
    const char *from, *to;
    int line;
    const char *words; /* must be in the message or the hint */
} bad[] = {
    {"extinction_per_m: 0.5", "extinction_per_m: -0.5", 9, "-0.5"},
    {"title: a probe", "title: \"a\\x9b2J\"", 2, "control"},
    {"title: a probe", "title: \"a\\u202eb\"", 2, "control"},
    {"title: a probe", "title: \"a\\tb\"", 2, "control"},
    {"extinction_per_m: 0.5", "extinction_per_m: nan", 9, "nan"},
    {"extinction_per_m: 0.5", "extinction_per_m: 1e999", 9, "1e999"},
    {"extinction_per_m: 0.5", "extinction_per_m: thick", 9, "thick"},
    {"extinction_per_m: 0.5", "extinktion_per_m: 0.5", 9, "extinction_per_m"},
    {"albedo: [1, 0.5, 0]", "albedo: [1, 1.5, 0]", 10, "1.5"},
    {"albedo: [1, 0.5, 0]", "albedo: [1, 0.5]", 10, "3"},
    {"vertical_fov_deg: 40", "vertical_fov_deg: 180", 4, "180"},
    {"vertical_fov_deg: 40", "orthographic_height_m: 0", 4, "0.001"},
    {"vertical_fov_deg: 40", "vertical_fov_deg: 40, orthographic_height_m: 2", 4, "either"},
    {", vertical_fov_deg: 40", "", 4, "orthographic_height_m"},
    {VIEW ", vertical_fov_deg: 40",
     "orthographic_height_m: 2, keys: [{frame: 0, " VIEW "}, {frame: 1, " VIEW "}]", 4, "static"},
    {"scattering: single", "scattering: double", 6, "multiple"},
    {"direction: [0, 2, 0]", "direction: [0, 0, 0]", 5, "direction"},
    {"look_at_m: [0, 1, 0]", "look_at_m: [0, 1, 5]", 4, "look_at_m"},
    {"max_m: [1, 2, 1]", "max_m: [1, -2, 1]", 11, "max_m"},
    {"title: a probe", "title: a probe\ntitle: again", 3, "title"},
    {"name: probe", "name: Pro be", 1, "name"},
    {"name: probe", "name: other", 1, "other"},
    {VIEW, "keys: [{frame: 0, " VIEW ", cut: true}]", 4, "none before it"},
    {VIEW, "keys: [{frame: 0, " VIEW "}, {frame: 1, " VIEW ", cut: 1}]", 4, "true or false"},
    {VIEW, "keys: [{frame: 1, " VIEW "}, {frame: 1, " VIEW ", cut: true}]", 4, "keys[1].frame"},
    {MODE, MODE "frames: {pauses: [{frame: 0, count: 0}]}\n", 7, "pauses[0].count"},
    {MODE, MODE "frames: {pauses: [{frame: 0.5, count: 1}]}\n", 7, "0.5"},
    {MODE, MODE "frames: {pauses: [{frame: 3, count: 1}, {frame: 3, count: 1}]}\n", 7,
     "pauses[1].frame"},
    {MODE, MODE "frames: {sizes: [{frame: 0, scale: 0.04}]}\n", 7, "0.05 to 4"},
    {MODE, MODE "frames: {sizes: [{frame: 9, scale: 1}, {frame: 8, scale: 2}]}\n", 7,
     "sizes[1].frame"},
    {LIGHT, "direction: [0, 1, 0]", 5, "irradiance_w_per_m2"},
    {LIGHT, LIGHT ", keys: [{frame: 0, " LIGHT "}]", 5, "not both"},
    {LIGHT, "keys: []", 5, "1 to 1024"},
    {LIGHT, "keys: [{frame: 0, " LIGHT "}, {frame: 1, direction: [0, 1, 0]}]", 5,
     "keys[1].irradiance_w_per_m2"},
    {LIGHT, "keys: [{frame: 5, " LIGHT "}, {frame: 4, " LIGHT "}]", 5, "keys[1].frame"},
    {LIGHT, "keys: [{frame: 3, direction: [0, 0, 0], irradiance_w_per_m2: [1, 1, 1]}]", 5,
     "length 0"},
    {LIGHT,
     "keys: [{frame: 3, " LIGHT "},\n"
     "  {frame: 7, direction: [1e-7, -1, 0], irradiance_w_per_m2: [1, 1, 1]}]",
     6, "at frame 7 the sun is opposite to its place at frame 3 (sun.keys[0])"},
    {MODE, MODE "wind: {velocity_m_per_s: [1, 0, 0]}\n", 7, "no medium of the scene drifts"},
    {MODE, MODE "wind: {}\n", 7, "exactly one"},
    {MODE, MODE "lights: [{position_m: [0, 1, 0]}]\n", 7, "intensity_w_per_sr"},
    {MODE, MODE "lights: [{position_m: [0, 1, 0], intensity_w_per_sr: [1, -1, 0]}]\n", 7, "-1"},
    {MODE, MODE "lights: [" LAMP "{axis: [0, 0, 0], inner_deg: 5, outer_deg: 9}}]\n", 7, "length"},
    {MODE, MODE "lights: [" LAMP "{axis: [0, 1, 0], inner_deg: 9, outer_deg: 9}}]\n", 7,
     "outer_deg"},
    {MODE, MODE "lights: [" LAMP "{axis: [0, 1, 0], inner_deg: 5, outer_deg: 180}}]\n", 7, "179.9"},
    {MODE,
     MODE "solids: [{sphere: {center_m: [0, 1, 0], radius_m: 2, albedo: [1, 1, 1]}}]\n"
          "lights: [{position_m: [0, 1, 0], intensity_w_per_sr: [1, 1, 1]}]\n",
     8, "inside a solid"},
    {MODE, MODE "lights: [{position_m: [0, 1, 0], keys: [" LAMP_KEY(0) "}]}]\n", 7, "not both"},
    {MODE, MODE "lights: [{keys: []}]\n", 7, "1 to 1024"},
    {MODE, MODE "lights: [{keys: [" LAMP_KEY(5) "},\n" LAMP_KEY(5) "}]}]\n", 8, "keys[1].frame"},
    {MODE, MODE "lights: [{keys: [" LAMP_KEY(-1) "}]}]\n", 7, "0 to 100000"},
    {MODE, MODE "lights: [{keys: [{frame: 0, position_m: [0, 5, 0]}]}]\n", 7,
     "keys[0].intensity_w_per_sr"},
    {MODE, MODE "lights: [{keys: [" LAMP_KEY(0) ", cut: true}]}]\n", 7, "none before it"},
    {MODE, MODE "lights: [{keys: [" LAMP_KEY(0) ", axis: [0, 1, 0]}]}]\n", 7, "give it a cone"},
    {MODE,
     MODE "lights: [{cone: {axis: [0, 1, 0], inner_deg: 5, outer_deg: 9},\n"
          "  keys: [" LAMP_KEY(0) ", axis: [0, 0, 0]}]}]\n",
     8, "length"},
    {MODE,
     MODE "lights: [{cone: {axis: [0, 1, 0], inner_deg: 5, outer_deg: 9},\n"
          "  keys: [" LAMP_KEY(0) "},\n" LAMP_KEY(3) ", axis: [0, -1, 0]}]}]\n",
     9, "at frame 3 the axis is opposite to the axis at frame 0 (keys[0])"},
    {MODE,
     MODE "frames: {count: 4}\n"
          "solids: [{sphere: {center_m: [0, 1, 0], radius_m: 2, albedo: [1, 1, 1],\n"
          "  motion: {keys: [{frame: 0}, {frame: 3, move_m: [0, 5.7, 0]}]}}}]\n"
          "lights: [{keys: [" LAMP_KEY(0) "},\n" LAMP_KEY(1) "}]}]\n",
     11, "at frame 2 the light is inside a solid"},
    {MODE, MODE "wind: {velocity_m_per_s: [1, 0, 1e6]}\n", 7, "1e6"},
    {MODE,
     MODE "wind: {velocity_m_per_s: [1, 0, 0], keys: [{frame: 0, velocity_m_per_s: [1, 0, 0]}]}\n",
     7, "exactly one"},
    {MODE,
     MODE "wind: {keys: [{frame: 2, velocity_m_per_s: [1, 0, 0]},\n"
          "  {frame: 2, velocity_m_per_s: [1, 0, 0]}]}\n",
     8, "keys[1].frame"},
    {"media:", "wind: {velocity_m_per_s: [1e5, 0, 0]}\nframes: {count: 22, rate_hz: 2}\n" BLOB, 7,
     "at frame 21"},
};

static void test_errors_are_named(void **state)
{
    for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
        struct neph_diag diag = {.line = 0};
        struct neph_scene *scene;
        char *text = edited(bad[i].from, bad[i].to);
        const enum neph_status status = load_text(text, strlen(text), &scene, &diag);
        if (status != NEPH_ERR_INPUT || diag.line != bad[i].line || diag.column < 1 ||
            !(strstr(diag.message, bad[i].words) || strstr(diag.hint, bad[i].words)))
            fail_msg("'%s': status %s, %d:%d: %s; hint: %s", bad[i].to, neph_status_name(status),
                     diag.line, diag.column, diag.message, diag.hint);
        free(text);
    }
}

#define OPTICS "extinction_per_m: 2, albedo: [1, 1, 1]"
#define BOUNDS "bounds: {min_m: [-1, 0, -1], max_m: [1, 2, 1]}"

#define PHASED(phase) "gaussian: {center_m: [0, 1, 0], width_m: 1, " OPTICS ", phase: " phase "}"

/* Media next to the homogeneous one of `good`, on its line 12; NULL: it loads. */
static const struct row {
    const char *medium, *words;
} media[] = {
    {"gaussian: {center_m: [0, 1, 0], width_m: 0.5, " OPTICS "}", NULL},
    {"gaussian: {center_m: [0, 1, 0], width_m: 0.5, " OPTICS ", " BOUNDS "}", NULL},
    {"gaussian: {center_m: [0, 1, 0], width_m: 0, " OPTICS "}", "width_m"},
    {"gaussian: {width_m: 1, " OPTICS "}", "center_m"},
    {"gaussian: {center_m: [0, 1, 0], width_m: 0.5, asymmetry_g: 0.5, " OPTICS "}", "phase"},
    {PHASED("henyey_greenstein"), "henyey_greenstein needs the key asymmetry_g"},
    {PHASED("draine, asymmetry_g: 0.5"), "draine needs the key draine_alpha"},
    {PHASED("draine, asymmetry_g: 0.5, draine_alpha: 2"), NULL},
    {PHASED("draine, asymmetry_g: 0.5, draine_alpha: -2"), "draine_alpha"},
    {PHASED("double_henyey_greenstein, asymmetry_g: -0.5, second_asymmetry_g: 0.2, first_share: 1"),
     "the first lobe is the forward one"},
    {PHASED("double_henyey_greenstein, asymmetry_g: 0.5, second_asymmetry_g: -0.2, first_share: 1"),
     NULL},
    {PHASED("jendersie_deon, droplet_diameter_um: 4"), "4 is outside 5 to 50 um"},
    {PHASED("jendersie_deon, droplet_diameter_um: 20"), NULL},
    {PHASED("rayleigh, first_share: 0.2"),
     "rayleigh does not have this; it is for double_henyey_greenstein"},
    {PHASED("povray_mie_hazy"), NULL},
    {PHASED("table"), "table needs the key phase_table"},
    {"gaussian: {center_m: [0, 1, 0], width_m: 0.5, extinction_color: [1, -1, 1], " OPTICS "}",
     "extinction_color[1]"},
    {"shell: {center_m: [0, -10, 0], radius_m: 9, scale_height_m: 1, " OPTICS ", " BOUNDS "}",
     NULL},
    {"shell: {center_m: [0, -10, 0], radius_m: 9, scale_height_m: 1, " OPTICS "}", "bounds"},
    {"shell: {center_m: [0, -10, 0], radius_m: 0, scale_height_m: 1, " OPTICS ", " BOUNDS "}",
     "radius_m"},
    {"grid: {size: [2, 1, 1], origin_m: [0, 0, 0], spacing_m: [1, 1, 1], values: [0, 1], " OPTICS
     "}",
     NULL},
    {"grid: {size: [2, 1, 1], origin_m: [0, 0, 0], spacing_m: [1, 1, 1], values: [0, 1], " OPTICS
     ", " BOUNDS "}",
     NULL},
    {"grid: {size: [2, 1, 1], origin_m: [0, 0, 0], spacing_m: [1, 1, 1], values: [0, 1], " OPTICS
     ", bounds: {min_m: [0, 0, 0], max_m: [1, 0, 1]}}",
     "bounds"},
    {"grid: {size: [2, 1, 1], origin_m: [0, 0, 0], spacing_m: [1, 1, 1], values: [0], " OPTICS "}",
     "1 values for 2 x 1 x 1 = 2 nodes"},
    {"grid: {size: [2, 1, 0], origin_m: [0, 0, 0], spacing_m: [1, 1, 1], values: [0], " OPTICS "}",
     "size[2]"},
    {"grid: {size: [2, 1, 1], origin_m: [0, 0, 0], spacing_m: [1, 1, 1], values: [0, nan], " OPTICS
     "}",
     "nan"},
    {"grid: {size: [2, 1, 1], origin_m: [0, 0, 0], spacing_m: [1, 0, 1], values: [0, 1], " OPTICS
     "}",
     "spacing_m[1]"},
    {"{grid: {size: [1, 1, 1], origin_m: [0, 0, 0], spacing_m: [1, 1, 1], values: [1], " OPTICS
     "}, gaussian: {center_m: [0, 1, 0], width_m: 0.5, " OPTICS "}}",
     "exactly one of"},
    {"{}", "exactly one of"},
    {"gaussian: 7", "center_m"},
    {"volume: {file: cloud.raw, center_m: [0, 0, 0], longest_side_m: 2, " OPTICS "}",
     "must end in .vdb, .df3, .nc"},
    {"volume: {file: x.vdb, center_m: [0, 0, 0], longest_side_m: 0, " OPTICS "}", "longest_side_m"},
    {"volume: {file: x.vdb, center_m: [0, 0, 0], longest_side_m: 1, memory_limit_mib: 4096, " OPTICS
     "}",
     "memory_limit_mib"},
    {"gaussian: {center_m: [0, 1, 0], width_m: 0.5, voxels: 9, " OPTICS ", " BOUNDS "}", NULL},
    {"gaussian: {center_m: [0, 1, 0], width_m: 0.5, voxels: 1, " OPTICS ", " BOUNDS "}", "voxels"},
    {"height_fog: {voxels: 8, layers: [{extinction_per_m: 1, falloff_per_m: 1, height_m: 0}], "
     "albedo: [1, 1, 1]}",
     "no end"},
    {"horizon: {" OPTICS ", " BOUNDS "}", NULL},
    {"horizon: {seed: 7, coverage: 0.3, thickness_m: 900, wind_m: [1, 0, 2], " OPTICS ", " BOUNDS
     "}",
     NULL},
    {"horizon: {" OPTICS "}", "bounds"},
    {"horizon: {coverage: 1.5, " OPTICS ", " BOUNDS "}", "coverage"},
    {"horizon: {seed: -1, " OPTICS ", " BOUNDS "}", "seed"},
    {"horizon: {thickness: 1, " OPTICS ", " BOUNDS "}", "thickness_m"},
    {"plume: {foot_m: [0, 0, 0], axis: [1, 2, 0], width_m: 1, scale_height_m: 2, " OPTICS "}",
     NULL},
    {"plume: {foot_m: [0, 0, 0], axis: [0, 0, 0], width_m: 1, scale_height_m: 2, " OPTICS "}",
     "length 0"},
};

static void test_media_of_all_kinds(void **state)
{
    char hashes[sizeof(media) / sizeof(media[0])][NEPH_HASH_HEX_SIZE] = {{0}};
    for (size_t i = 0; i < sizeof(media) / sizeof(media[0]); i++) {
        struct neph_diag diag = {.line = 0};
        struct neph_scene *scene;
        char *text = neph_format("%s  - %s\n", good, media[i].medium);
        const enum neph_status status = load_text(text, strlen(text), &scene, &diag);
        free(text);
        if (media[i].words) {
            if (status != NEPH_ERR_INPUT || diag.line != 12 || diag.column < 1 ||
                !(strstr(diag.message, media[i].words) || strstr(diag.hint, media[i].words)))
                fail_msg("'%s': status %s, %d:%d: %s; hint: %s", media[i].medium,
                         neph_status_name(status), diag.line, diag.column, diag.message, diag.hint);
            continue;
        }
        neph_assert_ok(status, &diag);
        assert_int_equal(scene->medium_count, 2);
        memcpy(hashes[i], scene->hash, NEPH_HASH_HEX_SIZE);
        for (size_t k = 0; k < i; k++) /* different files give different frames */
            assert_string_not_equal(hashes[i], hashes[k]);
        neph_scene_destroy(scene);
    }
}

/* 2 x 1 x 4 voxels of 8 bits, in the folder of the scene. */
static const char df3[] = {0, 2, 0, 1, 0, 4, 0, 51, 102, (char)153, (char)204, (char)255, 0, 0};

static enum neph_status load_volume(const char *file, struct neph_scene **scene,
                                    struct neph_diag *diag)
{
    char folder[] = "/tmp/neph-load-XXXXXX";
    assert_non_null(mkdtemp(folder));
    char *scene_path = neph_path_join(folder, "probe.yaml");
    char *volume_path = neph_path_join(folder, "voxels.df3");
    char *text = neph_format("%s  - volume: {file: %s, center_m: [1, 2, 3], longest_side_m: 8, "
                             "extinction_per_m: 2, albedo: [1, 1, 1]}\n",
                             good, file);
    assert_int_equal(neph_file_write(scene_path, text, strlen(text), NULL), NEPH_OK);
    assert_int_equal(neph_file_write(volume_path, df3, sizeof(df3), NULL), NEPH_OK);
    setenv("NEPH_TEST_VOLUMES", folder, 1);
    const enum neph_status status = neph_scene_load(scene_path, scene, diag);
    unsetenv("NEPH_TEST_VOLUMES");
    free(text);
    free(volume_path);
    free(scene_path);
    neph_dir_remove(folder, NULL);
    return status;
}

/* The environment may contain values that must not appear on a screen or in a log. */
static void test_messages_hide_the_environment(void **state)
{
    static const char *const files[] = {"$NEPH_TEST_SECRET", "$NEPH_TEST_SECRET/none.df3",
                                        "$NEPH_TEST_SECRET/none.vdb"};
    setenv("NEPH_TEST_SECRET", "hunter2", 1);
    for (size_t i = 0; i < sizeof(files) / sizeof(files[0]); i++) {
        struct neph_scene *scene = NULL;
        struct neph_diag diag = {.line = 0};
        assert_int_not_equal(load_volume(files[i], &scene, &diag), NEPH_OK);
        assert_null(strstr(diag.message, "hunter2"));
        assert_null(strstr(diag.hint, "hunter2"));
        assert_non_null(strstr(diag.message, files[i]));
    }
    unsetenv("NEPH_TEST_SECRET");
}

/* Its bounds cut a grid: of four nodes of 1 only the middle remains. */
static void test_a_grid_keeps_to_its_bounds(void **state)
{
    struct neph_scene *scene = NULL;
    struct neph_diag diag = {0};
    const char *text =
        "name: probe\ntitle: a probe\nphysics: none\n"
        "camera: {position_m: [0, 0, 9], look_at_m: [0, 0, 0], vertical_fov_deg: 40}\n"
        "scattering: none\n"
        "solids:\n  - sphere: {center_m: [0, -6371000, 0], radius_m: 6370990, albedo: [0, 0, 0]}\n"
        "media:\n  - grid: {size: [2, 1, 2], origin_m: [-1, 0, -1], spacing_m: [2, 2, 2], "
        "values: [1, 1, 1, 1], " OPTICS
        ", bounds: {min_m: [-0.5, -0.5, -0.25], max_m: [0.5, 0.5, 0.5]}}\n";
    neph_assert_ok(load_text(text, strlen(text), &scene, &diag), &diag);
    const struct neph_vec3 eye_m = {0.2, 0.0, 9.0}, ahead = {0, 0, -1};
    const double per_m = scene->media[0].extinction_per_m;
    neph_assert_close(neph_scene_optical_depth(scene, eye_m, ahead, 0.0, INFINITY).g, 0.75 * per_m,
                      1e-12, 0.0);
    neph_scene_destroy(scene);
}

static void test_volumes_are_read_and_put_in_place(void **state)
{
    static const char *const files[] = {"voxels.df3", "$NEPH_TEST_VOLUMES/voxels.df3"};
    for (int i = 0; i < 2; i++) {
        struct neph_diag diag = {.line = 0};
        struct neph_scene *scene;
        neph_assert_ok(load_volume(files[i], &scene, &diag), &diag);
        const struct neph_grid *grid = scene->media[1].grid;
        assert_true(grid->size[0] == 2 && grid->size[1] == 1 && grid->size[2] == 4);
        /* The voxels are cubes: 4 x 2 x 8 m. */
        neph_assert_close(grid->spacing_m.x, 2.0, 1e-15, 0.0);
        neph_assert_close(grid->spacing_m.y, 2.0, 1e-15, 0.0);
        neph_assert_close(grid->spacing_m.z, 2.0, 1e-15, 0.0);
        neph_assert_close(grid->origin_m.x, 1.0 - 1.0, 1e-15, 0.0);
        neph_assert_close(grid->origin_m.y, 2.0, 1e-15, 0.0);
        neph_assert_close(grid->origin_m.z, 3.0 - 3.0, 0.0, 1e-15);
        neph_assert_close((double)grid->maximum, 1.0, 1e-6, 0.0);
        neph_scene_destroy(scene);
    }
}

static void test_volumes_that_are_not_there(void **state)
{
    static const struct {
        const char *file, *words;
    } cases[] = {
        {"other.df3", "other.df3"},
        {"$NEPH_TEST_NOWHERE/voxels.df3", "NEPH_TEST_NOWHERE"},
        {"/nowhere/voxels.vdb", "/nowhere/voxels.vdb"},
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        struct neph_diag diag = {.line = 0};
        struct neph_scene *scene;
        assert_int_equal(load_volume(cases[i].file, &scene, &diag), NEPH_ERR_NOT_FOUND);
        assert_non_null(strstr(diag.message, cases[i].words));
        assert_int_equal(diag.line, 12);
    }
}

static void test_defaults_and_units(void **state)
{
    struct neph_diag diag = {.line = 0};
    struct neph_scene *scene;
    neph_assert_ok(load_text(good, strlen(good), &scene, &diag), &diag);
    assert_string_equal(scene->name, "probe");
    assert_int_equal(scene->frame_count, 1);
    assert_false(scene->environment_light);
    neph_assert_close(scene->vertical_fov_rad, 40.0 * M_PI / 180.0, 1e-15, 0.0);
    neph_assert_close(scene->sun.direction.y, 1.0, 0.0, 0.0); /* normalised */
    assert_int_equal(scene->media[0].phase.kind, NEPH_PHASE_ISOTROPIC);
    neph_assert_close(scene->media[0].albedo.g, 0.5, 0.0, 0.0);
    neph_assert_close(scene->background_w_per_m2_sr.r, 0.0, 0.0, 0.0);
    neph_scene_destroy(scene);
}

static void hash_edited_scene(const char *from, const char *to, char hash[NEPH_HASH_HEX_SIZE])
{
    struct neph_diag diag = {.line = 0};
    struct neph_scene *scene;
    char *text = edited(from, to);
    neph_assert_ok(load_text(text, strlen(text), &scene, &diag), &diag);
    memcpy(hash, scene->hash, NEPH_HASH_HEX_SIZE);
    neph_scene_destroy(scene);
    free(text);
}

static void test_hash_ignores_unrendered_keys(void **state)
{
    char base[NEPH_HASH_HEX_SIZE], other[NEPH_HASH_HEX_SIZE];
    hash_edited_scene("name: probe", "name: probe", base);
    hash_edited_scene("title: a probe", "title: another # and a comment", other);
    assert_string_equal(base, other);
    hash_edited_scene("scattering: single",
                      "scattering: single\ndisplay: {exposure_ev: 3, chain: film.yaml}", other);
    assert_string_equal(base, other);
}

/* A single key, and motion without any change, are equal to the static scene: its frames stay
 * valid. */
static void test_hash_of_static_scenes(void **state)
{
    static const char *const same[][2] = {
        {LIGHT, "keys: [{frame: 7, " LIGHT "}]"},
        {VIEW, "keys: [{frame: 0, " VIEW ", cut: false}]"},
        {MODE, MODE "frames: {count: 1, rate_hz: 30}\n"},
    };
    char base[NEPH_HASH_HEX_SIZE], other[NEPH_HASH_HEX_SIZE];
    hash_edited_scene("name: probe", "name: probe", base);
    for (size_t i = 0; i < sizeof(same) / sizeof(same[0]); i++) {
        hash_edited_scene(same[i][0], same[i][1], other);
        assert_string_equal(base, other);
    }
}

/* Written by the version of the format before motion existed: frames stored under it keep their
 * meaning. */
static void test_hash_of_old_scenes(void **state)
{
    char base[NEPH_HASH_HEX_SIZE];
    hash_edited_scene("name: probe", "name: probe", base);
    assert_string_equal(base, "b75e3fb9b2889a6decb8ff4662b5fc1f6a6ae8aa02ab8c1995a8819c13c9aa5a");
}

static void test_unreal_layers_are_mapped(void **state)
{
    static const char fog[] =
        "name: probe\ntitle: t\nphysics: p\n"
        "camera: {position_m: [0, 1, 5], look_at_m: [0, 1, 0], vertical_fov_deg: 40}\n"
        "scattering: none\n"
        "media:\n  - height_fog:\n      albedo: [0, 0, 0]\n      unreal_layers:\n"
        "        - {fog_density: 0.02, fog_height_falloff: 0.2, fog_height_m: 3}\n";
    struct neph_diag diag = {.line = 0};
    struct neph_scene *scene;
    neph_assert_ok(load_text(fog, strlen(fog), &scene, &diag), &diag);
    /* Unreal's defaults: 9.609e-4 /m and 0.01386 /m, to the digits published. */
    neph_assert_close(scene->media[0].layers[0].extinction_per_m, 9.609e-4, 1e-4, 0.0);
    neph_assert_close(scene->media[0].layers[0].falloff_per_m, 0.01386, 5e-4, 0.0);
    assert_true(isinf(scene->media[0].bounds.max_m.y));
    neph_scene_destroy(scene);
}

static void test_damaged_files_never_crash(void **state)
{
    uint64_t seed = 20261121;
    print_message("seed %llu\n", (unsigned long long)seed);
    char text[sizeof(good)];
    for (int i = 0; i < 2000; i++) {
        memcpy(text, good, sizeof(good));
        size_t size = sizeof(good) - 1;
        for (int edits = 1 + (int)(neph_test_random(&seed) % 4); edits > 0; edits--)
            text[neph_test_random(&seed) % size] = (char)neph_test_random(&seed);
        if (neph_test_random(&seed) % 4 == 0)
            size = neph_test_random(&seed) % size;
        struct neph_diag diag = {.line = 0};
        struct neph_scene *scene;
        if (load_text(text, size, &scene, &diag))
            assert_true(diag.message[0]);
        else
            neph_scene_destroy(scene);
    }
}

/* The text of a scene with an eighth of the voxels per side in its clouds; `neph scenes` loads them
 * in full resolution end to end. */
static char *with_fewer_voxels(char *text)
{
    char *value = strstr(text, "voxels: "), *rest;
    if (!value)
        return text;
    value += strlen("voxels: ");
    const long voxels = strtol(value, &rest, 10);
    char *edited_text = neph_format("%.*s%ld%s", (int)(value - text), text, voxels / 8, rest);
    free(text);
    return edited_text;
}

/* The text of a scene with absolute paths in place of those from its own folder on, after a key. */
static char *move_paths(char *text, const char *key, const char *scene_path)
{
    const int folder_length = (int)(strrchr(scene_path, '/') + 1 - scene_path);
    const char *value = text;
    while ((value = strstr(value, key))) {
        value += strlen(key);
        if (*value == '$' || *value == '/')
            continue;
        char *edited_text = neph_format("%.*s%.*s%s", (int)(value - text), text, folder_length,
                                        scene_path, value);
        value = edited_text + (value - text);
        free(text);
        text = edited_text;
    }
    return text;
}

/* A copy of a scene file in another folder. NULL if a similar one was loaded: procedural clouds
 * differ only in numbers, and each generates the same noise for seconds. */
static char *copy_scene(const char *path, const char *folder, int *cloud_count)
{
    char *text, *copy = neph_path_join(folder, strrchr(path, '/') + 1);
    size_t size;
    neph_assert_ok(neph_file_read(path, 1 << 20, &text, &size, NULL), NULL);
    text = move_paths(with_fewer_voxels(text), "phase_table: ", path);
    text = move_paths(text, " file: ", path);
    if (strstr(text, "horizon:") && (*cloud_count)++ > 0) {
        free(copy);
        copy = NULL;
    } else {
        scratch_write(copy, text, strlen(text));
    }
    free(text);
    return copy;
}

/* Returns the number of scenes. */
static int load_folder(const char *folder, const char *scratch, bool with_gates)
{
    DIR *directory = opendir(folder);
    assert_non_null(directory);
    int count = 0, cloud_count = 0;
    for (struct dirent *entry; (entry = readdir(directory));) {
        if (!strstr(entry->d_name, ".yaml"))
            continue;
        char *path = neph_path_join(folder, entry->d_name);
        char *copy = copy_scene(path, scratch, &cloud_count);
        free(path);
        if (!copy)
            continue;
        struct neph_diag diag = {.line = 0};
        struct neph_scene *scene = NULL;
        const enum neph_status status = neph_scene_load(copy, &scene, &diag);
        free(copy);
        if (status == NEPH_ERR_NOT_FOUND && strstr(diag.message, "environment variable")) {
            print_message("not loaded: %s\n", diag.message);
            continue;
        }
        neph_assert_ok(status, &diag);
        assert_true(neph_scene_gates(scene)->count > 0 || !with_gates);
        assert_true(scene->frame_count > 1 || with_gates);
        assert_true(strncmp(entry->d_name, scene->name, strlen(scene->name)) == 0);
        neph_scene_destroy(scene);
        count++;
    }
    closedir(directory);
    return count;
}

static void test_all_scenes_load(void **state)
{
    const struct scratch *scratch = *state;
    assert_true(load_folder(NEPH_SOURCE_DIR "/scenes/catalog", scratch->folder, true) >= 8);
    assert_true(load_folder(NEPH_SOURCE_DIR "/scenes/stress", scratch->folder, false) >= 7);
}

static void test_camera_rays(void **state)
{
    struct neph_diag diag = {.line = 0};
    struct neph_scene *scene;
    neph_assert_ok(load_text(good, strlen(good), &scene, &diag), &diag);
    const struct neph_camera camera = neph_scene_camera(scene, 0);
    neph_assert_close(camera.forward.z, -1.0, 1e-15, 0.0);
    neph_assert_close(camera.right.x, 1.0, 1e-15, 0.0);
    /* x = (2 (i + .5) / w - 1) t w / h, y = (1 - 2 (j + .5) / h) t, t = tan(fov / 2) */
    const double t = tan(0.5 * scene->vertical_fov_rad), w = 16, h = 9;
    const struct neph_vec3 ray = neph_camera_ray(&camera, 16, 9, 3, 1).direction;
    neph_assert_close(ray.x / -ray.z, (2 * 3.5 / w - 1) * t * w / h, 1e-14, 0.0);
    neph_assert_close(ray.y / -ray.z, (1 - 2 * 1.5 / h) * t, 1e-14, 0.0);
    neph_assert_close(neph_vec3_length(ray), 1.0, 1e-15, 0.0);
    neph_scene_destroy(scene);
}

/* A frame of 4 x 3 pixels and a height of 6 m: pixel centres are 2 m apart. */
static void test_orthographic_rays(void **state)
{
    struct neph_diag diag = {.line = 0};
    struct neph_scene *scene;
    char *text = edited("vertical_fov_deg: 40", "orthographic_height_m: 6");
    neph_assert_ok(load_text(text, strlen(text), &scene, &diag), &diag);
    const struct neph_camera camera = neph_scene_camera(scene, 0);
    for (int p = 0; p < 12; p++) {
        const struct neph_pixel_ray ray = neph_camera_ray(&camera, 4, 3, p % 4, p / 4);
        neph_assert_close(ray.origin_m.x, 2.0 * (p % 4) - 3.0, 1e-15, 0.0);
        neph_assert_close(ray.origin_m.y, 1.0 + 2.0 - 2.0 * (p / 4), 1e-15, 1e-15);
        neph_assert_close(ray.origin_m.z, 5.0, 1e-15, 0.0);
        neph_assert_close(ray.direction.z, -1.0, 1e-15, 0.0);
    }
    neph_scene_destroy(scene);
    free(text);
}

/* The pixel of a point on a pixel's ray is this pixel, for both cameras. */
static void test_pixels_of_points(void **state)
{
    struct neph_diag diag = {.line = 0};
    const char *const cameras[] = {"vertical_fov_deg: 40", "orthographic_height_m: 6"};
    for (int c = 0; c < 2; c++) {
        struct neph_scene *scene;
        char *text = edited("vertical_fov_deg: 40", cameras[c]);
        neph_assert_ok(load_text(text, strlen(text), &scene, &diag), &diag);
        const struct neph_camera camera = neph_scene_camera(scene, 0);
        for (int p = 0; p < 12; p++) {
            const struct neph_pixel_ray ray = neph_camera_ray(&camera, 16, 9, p + 0.3, p - 2.1);
            const struct neph_vec3 point_m = neph_vec3_along(ray.origin_m, ray.direction, 7.0);
            struct neph_point_in_frame found;
            assert_true(neph_camera_find_pixel(&camera, 16, 9, point_m, &found));
            neph_assert_close(found.i, p + 0.3, 0.0, 1e-12);
            neph_assert_close(found.j, p - 2.1, 0.0, 1e-12);
            neph_assert_close(found.depth_m, 7.0 * -ray.direction.z, 1e-14, 0.0);
        }
        const struct neph_vec3 behind_m = neph_vec3_along(camera.position_m, camera.forward, -1.0);
        struct neph_point_in_frame found;
        assert_int_equal(neph_camera_find_pixel(&camera, 16, 9, behind_m, &found), c == 1);
        neph_scene_destroy(scene);
        free(text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_errors_are_named),
        cmocka_unit_test(test_media_of_all_kinds),
        cmocka_unit_test(test_a_grid_keeps_to_its_bounds),
        cmocka_unit_test(test_volumes_are_read_and_put_in_place),
        cmocka_unit_test(test_volumes_that_are_not_there),
        cmocka_unit_test(test_defaults_and_units),
        cmocka_unit_test(test_hash_ignores_unrendered_keys),
        cmocka_unit_test(test_hash_of_static_scenes),
        cmocka_unit_test(test_hash_of_old_scenes),
        cmocka_unit_test(test_unreal_layers_are_mapped),
        cmocka_unit_test(test_damaged_files_never_crash),
        cmocka_unit_test(test_messages_hide_the_environment),
        scratch_test(test_all_scenes_load),
        cmocka_unit_test(test_camera_rays),
        cmocka_unit_test(test_orthographic_rays),
        cmocka_unit_test(test_pixels_of_points),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
