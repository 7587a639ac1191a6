/* SPDX-License-Identifier: MIT
 *
 * Out of memory in the loader of scenes, in the static copy of a scene, in variants and in volume
 * files: see tests/allocation.h.
 */
#include "tests/allocation.h"
#include "tests/base/scratch.h"
#include "tests/mesh_builders.h"

#include "scenes/mesh_file.h"
#include "scenes/mesh_program.h"
#include "scenes/motion.h"
#include "scenes/phase_table.h"
#include "scenes/scene.h"
#include "scenes/variant.h"
#include "scenes/volume_file.h"
#include "scenes/volume_format.h"
#include "scenes/volume_netcdf.h"

struct loading {
    char *path;
    char hash[NEPH_HASH_HEX_SIZE]; /* of the first load: all later ones must be equal */
};

static enum neph_status load(void *context, struct neph_diag *diag)
{
    struct loading *loading = context;
    struct neph_scene *scene = NULL, *still = NULL;
    enum neph_status status = neph_scene_load(loading->path, &scene, diag);
    assert_int_equal(scene != NULL, status == NEPH_OK);
    if (scene && !loading->hash[0])
        memcpy(loading->hash, scene->hash, sizeof(loading->hash));
    if (scene)
        assert_string_equal(scene->hash, loading->hash);
    if (!status)
        status = neph_scene_at(scene, 1.0, &still, diag);
    assert_int_equal(still != NULL, status == NEPH_OK);
    neph_scene_destroy(still);
    neph_scene_destroy(scene);
    return status;
}

static void assert_scene(const char *name)
{
    struct loading loading = {.path = neph_format(NEPH_SOURCE_DIR "/scenes/catalog/%s.yaml", name)};
    assert_every_failure_is_reported(name, load, &loading);
    free(loading.path);
}

static void test_catalogue(void **state)
{
    assert_scene("two_layer_fog");
    assert_scene("fence_backlit");
    assert_scene("voxel_grid");
    assert_scene("atmosphere_shell");
}

static void assert_text(void **state, const char *what, const char *scene)
{
    char path[SCRATCH_PATH_MAX];
    neph_assert_ok(
        neph_file_write(scratch_path(state, path, "probe.yaml"), scene, strlen(scene), NULL), NULL);
    struct loading loading = {.path = path};
    assert_every_failure_is_reported(what, load, &loading);
}

static void test_motion(void **state)
{
    static const char scene[] =
        "name: probe\n"
        "title: a probe\n"
        "physics: none\n"
        "camera:\n"
        "  vertical_fov_deg: 40\n"
        "  keys:\n"
        "    - {frame: 0, position_m: [0, 1, 50], look_at_m: [0, 1, 0]}\n"
        "    - {frame: 1, position_m: [0, 1, 40], look_at_m: [0, 1, 0], cut: true}\n"
        "frames: {pauses: [{frame: 0, count: 1}], sizes: [{frame: 0, scale: 0.5}]}\n"
        "sun:\n"
        "  keys:\n"
        "    - {frame: 0, direction: [0, 1, 0], irradiance_w_per_m2: [1, 1, 1]}\n"
        "    - {frame: 1, direction: [1, 1, 0], irradiance_w_per_m2: [1, 1, 1]}\n"
        "wind: {keys: [{frame: 0, velocity_m_per_s: [1, 0, 0]}]}\n"
        "scattering: none\n"
        "media:\n"
        "  - grid: {size: [2, 1, 1], origin_m: [0, 0, 0], spacing_m: [1, 1, 1], values: [0, 1], "
        "extinction_per_m: 2, albedo: [1, 1, 1]}\n";
    assert_text(state, "motion", scene);
}

/* Moving solids, frames without media, and all values that can be injected into a renderer. */
static void test_injections(void **state)
{
    static const char scene[] =
        "name: probe\n"
        "title: a probe\n"
        "physics: none\n"
        "camera: {position_m: [0, 1, 50], look_at_m: [0, 1, 0], vertical_fov_deg: 40}\n"
        "frames: {advance: [1, 2], clear: [{frame: 0, count: 1}]}\n"
        "scattering: none\n"
        "solids:\n"
        "  - box: {min_m: [0, 0, 0], max_m: [1, 1, 1], albedo: [0, 0, 0],\n"
        "          motion: {axis: y, keys: [{frame: 0}, {frame: 1, turn_deg: 9}]}}\n"
        "  - sphere: {center_m: [9, 9, 9], radius_m: 1, albedo: [0, 0, 0],\n"
        "             motion: {keys: [{frame: 0, move_m: [1, 0, 0]}]}}\n"
        "inject:\n"
        "  history: [{frame: 1, value: nan}]\n"
        "  rays: [{frame: 1, value: nan}]\n"
        "  sizes: [{frame: 1, scale: 2}]\n"
        "  origin: [{frame: 1, by_m: [1, 0, 0]}]\n";
    assert_text(state, "injections", scene);
}

/* A volume from a file, and a medium that is baked into voxels. */
static void test_voxels(void **state)
{
    static const unsigned char volume[] = {0, 2, 0, 1, 0, 1, 100, 200};
    static const char scene[] =
        "name: probe\n"
        "title: a probe\n"
        "physics: none\n"
        "camera: {position_m: [0, 1, 50], look_at_m: [0, 1, 0], vertical_fov_deg: 40}\n"
        "scattering: none\n"
        "media:\n"
        "  - volume: {file: cloud.df3, center_m: [0, 0, 0], longest_side_m: 1, "
        "extinction_per_m: 2, albedo: [1, 1, 1]}\n"
        "  - gaussian: {center_m: [0, 5, 0], width_m: 0.5, voxels: 4, extinction_per_m: 2, "
        "albedo: [1, 1, 1]}\n";
    char path[SCRATCH_PATH_MAX];
    neph_assert_ok(
        neph_file_write(scratch_path(state, path, "cloud.df3"), volume, sizeof(volume), NULL),
        NULL);
    neph_assert_ok(
        neph_file_write(scratch_path(state, path, "probe.yaml"), scene, strlen(scene), NULL), NULL);
    struct loading loading = {.path = path};
    assert_every_failure_is_reported("voxels", load, &loading);
}

/* A height field and so many solids that they get a tree, also in the static copy. */
static void test_height_fields(void **state)
{
    static const char scene[] =
        "name: probe\n"
        "title: a probe\n"
        "camera: {position_m: [0, 1, 50], look_at_m: [0, 1, 0], vertical_fov_deg: 40}\n"
        "scattering: none\n"
        "solids:\n"
        "  - height_field: {file: hills.png, min_m: [0, 0, 0], max_m: [9, 1, 9], "
        "albedo: [0, 0, 0],\n"
        "                   shading: smooth, albedo_texture: hills.png,\n"
        "                   motion: {axis: y, keys: [{frame: 0}, {frame: 1, turn_deg: 9}]}}\n"
        "  - fence: {origin_m: [0, 0, 9], bars: 20, pitch_m: 0.5, bar_width_m: 0.1, "
        "bar_depth_m: 0.1, height_m: 1, albedo: [0, 0, 0]}\n";
    char path[SCRATCH_PATH_MAX];
    scratch_write(scratch_path(state, path, "hills.png"), hills_png, sizeof(hills_png));
    assert_text(state, "a height field", scene);
}

static enum neph_status vary(void *context, struct neph_diag *diag)
{
    const struct neph_scene *scene = context;
    struct neph_scene *made = NULL;
    char *text = NULL;
    const struct neph_variant variant = {NEPH_VARIANT_SUN_STEP, 1, 4};
    enum neph_status status = neph_scene_variant(scene, &variant, &made, diag);
    assert_int_equal(made != NULL, status == NEPH_OK);
    if (!status)
        status = neph_scene_variant_text(scene, &variant, &text, diag);
    neph_scene_destroy(made);
    free(text);
    return status;
}

static void test_variants(void **state)
{
    struct neph_scene *scene = NULL;
    neph_assert_ok(
        neph_scene_load(NEPH_SOURCE_DIR "/scenes/catalog/fence_backlit.yaml", &scene, NULL), NULL);
    assert_every_failure_is_reported("a variant", vary, scene);
    neph_scene_destroy(scene);
}

/* Water and radii of 3 x 2 x 3 nodes; those along z are uneven. */
struct netcdf {
    struct neph_netcdf_header header;
    double x[3], y[2], z[3];
    float water[18], radii[18];
};

static struct netcdf make_netcdf(void)
{
    struct netcdf made = {.header = {.axes = {{"x", "m", 3, 1}, {"y", "m", 2, 1}, {"z", "m", 3, 1}},
                                     .names = {"lwc", "re"},
                                     .units = {"g m-3", "um"},
                                     .variable_count = 2},
                          .x = {0, 100, 200},
                          .y = {0, 100},
                          .z = {300, 200, 0}};
    for (int i = 0; i < 18; i++) {
        made.water[i] = 0.1f * (float)i;
        made.radii[i] = 10.0f;
    }
    return made;
}

static enum neph_status sweep(void *context, struct neph_diag *diag)
{
    struct neph_scene *at = NULL;
    const enum neph_status status = neph_scene_load_point(context, 3, &at, diag);
    assert_int_equal(at != NULL, status == NEPH_OK);
    neph_scene_destroy(at);
    return status;
}

/* The description of failures, and a point of a sweep. */
static void test_points(void **state)
{
    struct neph_scene *scene = NULL;
    neph_assert_ok(neph_scene_load(NEPH_SOURCE_DIR "/scenes/stress/fog_none.yaml", &scene, NULL),
                   NULL);
    assert_every_failure_is_reported("a point", sweep, scene);
    neph_scene_destroy(scene);
}

static enum neph_status copy_volume(void *context, struct neph_diag *diag)
{
    struct neph_grid *grid = NULL;
    const struct neph_volume_request request = {.path = context, .memory_limit_bytes = 1 << 20};
    enum neph_status status = neph_volume_read(&request, &grid, diag);
    if (!status)
        status = neph_volume_write(context, grid, diag);
    neph_grid_destroy(grid);
    return status;
}

static void test_volume_files(void **state)
{
    static const unsigned char volume[] = {0, 1, 0, 1, 0, 1, 100};
    char path[SCRATCH_PATH_MAX];
    neph_assert_ok(
        neph_file_write(scratch_path(state, path, "cloud.df3"), volume, sizeof(volume), NULL),
        NULL);
    assert_every_failure_is_reported("a .df3", copy_volume, path);
    assert_int_equal(scratch_count(state), 1);
}

static enum neph_status read_table(void *context, struct neph_diag *diag)
{
    struct neph_arena arena = {NULL};
    const struct neph_phase_table *table = NULL;
    const enum neph_status status = neph_phase_table_read(context, &arena, &table, diag);
    assert_int_equal(table != NULL, status == NEPH_OK);
    neph_arena_finish(&arena);
    return status;
}

static void test_phase_tables(void **state)
{
    static char path[] = NEPH_SOURCE_DIR "/tests/fuzz/corpus/phase/isotropic";
    assert_every_failure_is_reported("a phase function", read_table, path);
    assert_scene("fogbow");
}

/* What neph-netcdf wrote, in an operation without the program. */
static enum neph_status take_netcdf(void *context, struct neph_diag *diag)
{
    struct neph_grid *grid = NULL;
    const struct neph_volume_request request = {
        .path = "les.nc",
        .radius_name = "re",
        .density = NEPH_DENSITY_WATER,
        .droplets = {.unit = NEPH_DENSITY_WATER},
        .memory_limit_bytes = 1 << 20,
    };
    enum neph_status status = neph_volume_take_netcdf(&request, context, sizeof(struct netcdf),
                                                      &grid, diag);
    if (!status)
        status = neph_grid_seal(grid, diag);
    neph_grid_destroy(grid);
    return status;
}

static void test_netcdf(void **state)
{
    struct netcdf output = make_netcdf();
    assert_every_failure_is_reported("a NetCDF file", take_netcdf, &output);
}

/* A triangle, as neph-mesh wrote it. */
struct mesh {
    struct neph_mesh_header header;
    struct neph_mesh_corner corners[3];
    int32_t triangle[3];
};

static enum neph_status take_mesh(void *context, struct neph_diag *diag)
{
    struct neph_mesh_data data = {0};
    const size_t size = offsetof(struct mesh, triangle) + sizeof(int32_t[3]);
    const enum neph_status status = neph_mesh_take(context, size, &data, diag);
    assert_int_equal(data.positions != NULL, status == NEPH_OK);
    neph_mesh_data_finish(&data);
    return status;
}

static void test_meshes(void **state)
{
    struct mesh output = {.header = {3, 1, 1, 1}, .triangle = {0, 1, 2}};
    for (int v = 0; v < 3; v++)
        output.corners[v] = (struct neph_mesh_corner){{v, v * v, 0}, {0, 0, 1}, {0, 1}};
    assert_every_failure_is_reported("a mesh", take_mesh, &output);
}

static enum neph_status read_texture(void *context, struct neph_diag *diag)
{
    struct neph_albedo_texture *texture = NULL;
    const enum neph_status status = neph_albedo_texture_read(context, 1 << 20, &texture, diag);
    assert_int_equal(texture != NULL, status == NEPH_OK);
    neph_albedo_texture_destroy(texture);
    return status;
}

static void test_textures(void **state)
{
    static char path[] = NEPH_SOURCE_DIR "/tests/fuzz/corpus/png/rgba_8.png";
    assert_every_failure_is_reported("a texture", read_texture, path);
}

/* A cloud of MYSTIC with radii and uneven layers. */
static void test_text(void **state)
{
    static const char cloud[] = "1 1 2 3\n1 1 0 1 3\n1 1 1 0.5 10\n";
    static const char scene[] =
        "title: a probe\n"
        "camera: {position_m: [0, 1, 50], look_at_m: [0, 1, 0], vertical_fov_deg: 40}\n"
        "scattering: none\n"
        "media:\n"
        "  - volume: {file: cloud.dat, radius_grid: reff, water_g_per_m3: 1, albedo: [1, 1, 1]}\n";
    char path[SCRATCH_PATH_MAX];
    neph_assert_ok(
        neph_file_write(scratch_path(state, path, "cloud.dat"), cloud, strlen(cloud), NULL), NULL);
    assert_text(state, "a text file", scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        scratch_test(test_catalogue),     scratch_test(test_motion),
        scratch_test(test_injections),    scratch_test(test_voxels),
        cmocka_unit_test(test_variants),  cmocka_unit_test(test_points),
        scratch_test(test_volume_files),  cmocka_unit_test(test_phase_tables),
        cmocka_unit_test(test_netcdf),    cmocka_unit_test(test_meshes),
        scratch_test(test_height_fields), scratch_test(test_text),
        cmocka_unit_test(test_textures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
