/* SPDX-License-Identifier: MIT
 *
 * Text files of radiation codes as voxels: place, unit and value of each, and errors with their
 * lines.
 */
#include "tests/base/scratch.h"

#include "scenes/grid.h"
#include "scenes/media.h"
#include "scenes/volume_file.h"

/* 2 x 3 voxels of 100 x 200 m in layers of 100 and 300 m. */
static const char mystic[] = "# a cloud\n"
                             "2 3 2 3\n"
                             "0.1 0.2 1.0 1.1 1.4\n"
                             "1 1 1 0.5 10 # at the corner\n"
                             "2 1 2 0.25 5\n"
                             "\n"
                             "2 3 2 1e-30 1000\n";
static const char i3rc[] = "2 parameter LWC file\n"
                           "2 3 2\n"
                           "0.1 0.2\n"
                           "1.0 1.1 1.2\n"
                           "290 289 288\n"
                           "1 1 1 0.5 10\n"
                           "2 1 2 0.25 5\n";

static enum neph_status read_text(void **state, const char *name, const char *text,
                                  struct neph_volume_request request, struct neph_grid **grid,
                                  struct neph_diag *diag)
{
    char path[SCRATCH_PATH_MAX];
    scratch_write(scratch_path(state, path, name), text, strlen(text));
    request.path = path;
    request.shown = name;
    request.is_z_up = true;
    if (!request.memory_limit_bytes)
        request.memory_limit_bytes = (size_t)1 << 20;
    *grid = NULL;
    return neph_volume_read(&request, grid, diag);
}

static const struct neph_volume_request water = {.density = NEPH_DENSITY_WATER};
static const struct neph_volume_request droplets = {
    .density = NEPH_DENSITY_WATER, .radius_name = "reff", .droplets = {.unit = NEPH_DENSITY_WATER}};

static struct neph_grid *read_good(void **state, const char *name, const char *text,
                                   const struct neph_volume_request *request)
{
    struct neph_grid *grid;
    struct neph_diag diag = {0};
    neph_assert_ok(read_text(state, name, text, *request, &grid, &diag), &diag);
    return grid;
}

/* Voxel (x, y, z) of the file, from 0 on: y becomes -z of the world, z its y. */
static double value(const struct neph_grid *grid, int x, int y, int z)
{
    const int *size = grid->size;
    return (double)grid->values[((size[2] - 1 - y) * size[1] + z) * size[0] + x];
}

static void assert_place(const struct neph_grid *grid, struct neph_vec3 origin_m,
                         struct neph_vec3 spacing_m)
{
    neph_assert_close(neph_vec3_length(neph_vec3_sub(grid->origin_m, origin_m)), 0.0, 0.0, 1e-9);
    neph_assert_close(neph_vec3_length(neph_vec3_sub(grid->spacing_m, spacing_m)), 0.0, 0.0, 1e-9);
}

/* The upper layer becomes three, as thick as the lower one; nothing is lost. */
static void test_a_cloud_of_mystic(void **state)
{
    struct neph_grid *grid = read_good(state, "cloud.dat", mystic, &water);
    assert_int_equal(grid->size[0] + 10 * grid->size[1] + 100 * grid->size[2], 342);
    assert_place(grid, (struct neph_vec3){50, 1050, -500}, (struct neph_vec3){100, 100, 200});
    assert_true(grid->is_constant);
    assert_non_null(strstr(grid->note, "2 uneven places along 'z' became 4, 100 m apart: their sum "
                                       "times thickness changed by"));
    double sum = 0.0;
    for (int i = 0; i < 2 * 3 * 4; i++)
        sum += (double)grid->values[i];
    neph_assert_close(value(grid, 0, 0, 0), 0.5, 0.0, 0.0);
    for (int z = 1; z < 4; z++)
        neph_assert_close(value(grid, 1, 0, z), 0.25, 1e-7, 0.0);
    neph_assert_close(sum, 0.5 + 3 * 0.25, 1e-7, 0.0);
    neph_grid_destroy(grid);
}

static double expected(double g_per_m3, double radius_um)
{
    const struct neph_droplet_radii radii = {radius_um, 0.1};
    return neph_density_to_extinction_per_m(NEPH_DENSITY_WATER, g_per_m3, radii, NAN);
}

/* Cells of I3RC and nodes of SHDOM, with the radius of each voxel. */
static void test_clouds_of_i3rc_and_shdom(void **state)
{
    struct neph_grid *grid = read_good(state, "cloud.lwc", i3rc, &droplets);
    assert_place(grid, (struct neph_vec3){50, 1050, -500}, (struct neph_vec3){100, 100, 200});
    assert_true(grid->is_constant);
    assert_string_equal(grid->note, "");
    neph_assert_close(value(grid, 0, 0, 0), expected(0.5, 10.0), 1e-6, 0.0);
    neph_assert_close(value(grid, 1, 0, 1), expected(0.25, 5.0), 1e-6, 0.0);
    neph_assert_close(value(grid, 1, 2, 1), 0.0, 0.0, 0.0);
    neph_grid_destroy(grid);
    static const char shdom[] = "1\n2 1 2\n0.1 0.2\n1.0 1.1\n290 289\n2 1 2 0.25\n";
    grid = read_good(state, "cloud.txt", shdom, &water);
    assert_place(grid, (struct neph_vec3){0, 1000, 0}, (struct neph_vec3){100, 100, 200});
    assert_false(grid->is_constant);
    neph_assert_close(value(grid, 1, 0, 1), 0.25, 0.0, 0.0);
    neph_grid_destroy(grid);
}

/* 1/km; a column that the scene has as a key is said, not used. */
static void test_extinction(void **state)
{
    const struct neph_volume_request request = {.density = NEPH_DENSITY_EXTINCTION};
    struct neph_grid *grid = read_good(
        state, "a.dat", "1 1 2 1\n1 1 0 1 2\n1 1 1 30 0.85 0.99\n1 1 2 60 0.85 0.99\n", &request);
    neph_assert_close(value(grid, 0, 0, 1), 0.06, 1e-7, 0.0);
    assert_string_equal(grid->note, "g is 0.85 in the file; ssa is 0.99 in the file");
    neph_grid_destroy(grid);
    grid = read_good(state, "a.dat", "1 1 1 2\n1 1 0 1\n1 1 1 30 10\n", &request);
    neph_assert_close(value(grid, 0, 0, 0), 0.03, 1e-7, 0.0);
    neph_grid_destroy(grid);
}

/* The first line of the table is the uppermost. */
static void test_a_table_and_a_part(void **state)
{
    static const int size[3] = {3, 1, 2};
    static const struct neph_volume_box box = {{1, 0, 1}, {2, 0, 1}};
    struct neph_volume_request request = {.table_size = size};
    struct neph_grid *grid = read_good(state, "mmcr", "1 2 3\n4 5 6\n", &request);
    assert_true(grid->is_constant);
    assert_place(grid, (struct neph_vec3){0, 0, 0}, (struct neph_vec3){1, 1, 1});
    for (int x = 0; x < 3; x++) {
        neph_assert_close(value(grid, x, 0, 1), 1.0 + x, 0.0, 0.0);
        neph_assert_close(value(grid, x, 0, 0), 4.0 + x, 0.0, 0.0);
    }
    neph_grid_destroy(grid);
    request.index_box = &box;
    request.interpolation = NEPH_INTERPOLATION_TRILINEAR;
    grid = read_good(state, "mmcr", "1 2 3\n4 5 6\n", &request);
    assert_false(grid->is_constant);
    assert_int_equal(grid->size[0] * grid->size[1], 2);
    neph_assert_close(value(grid, 1, 0, 0), 3.0, 0.0, 0.0);
    neph_grid_destroy(grid);
    static const struct neph_volume_box upper = {{1, 0, 1}, {1, 1, 1}};
    request = water;
    request.index_box = &upper;
    grid = read_good(state, "cloud.dat", mystic, &request);
    assert_place(grid, (struct neph_vec3){150, 1250, -300}, (struct neph_vec3){100, 300, 200});
    neph_grid_destroy(grid);
}

static void test_errors_name_their_line(void **state)
{
    static const int size[3] = {2, 1, 1};
    static const struct neph_volume_request table = {.table_size = size};
    static const struct neph_volume_request extinction = {.density = NEPH_DENSITY_EXTINCTION};
    static const struct neph_volume_request small = {.density = NEPH_DENSITY_WATER,
                                                     .memory_limit_bytes = 16};
    static const struct neph_volume_request other = {.density = NEPH_DENSITY_WATER,
                                                     .grid_name = "ext"};
    static const struct {
        const char *text, *words, *hint;
        const struct neph_volume_request *request; /* NULL: water */
    } cases[] = {
        {"", "line 1: the file ends where a number of voxels or parameters should be", "table_size",
         NULL},
        {"cloud\n", "line 1: 'cloud' is not a number of voxels", "table_size", NULL},
        {"2 2 2 4\n", "line 1: 4 is not a flag: it must be 1..3", "", NULL},
        {"2 2 2 0 3\n", "line 1: 0 is not a flag", "", NULL},
        {"2 2 1 3 1\n", "line 1: more than \"Nx Ny Nz flag\"", "", NULL},
        {"2 2 2.5 3\n", "line 1: 2.5 is not a number of voxels: it must be whole", "", NULL},
        {"2 2 0 3\n", "line 1: 0 is not a number of voxels: it must be 1..65535", "", NULL},
        {"2 1 2 3\n1 1 0 1\n", "line 2: 2 heights for 2 layers", "the 3 ends", NULL},
        {"2 1 2 3\n1 1 0 1 2 3\n", "line 2: 4 heights for 2 layers", "the 3 ends", NULL},
        {"2 1 2 3\n1 1 0 1 1\n", "line 2: heights do not ascend: 1 km after 1 km", "", NULL},
        {"2 1 1 3\n0 1 0 1\n", "line 2: 0 is not a distance in km", "", NULL},
        {"2 1 1 3\n1 1 0 1\n", "line 3: no voxels after its header", "", NULL},
        {"2 1 1 3\n1 1 0 1\n3 1 1 1 5\n", "line 3: 3 is not an index of a voxel: it must be 1..2",
         "", NULL},
        {"2 1 1 3\n1 1 0 1\n0 1 1 1 5\n", "line 3: 0 is not an index of a voxel", "", NULL},
        {"2 1 1 3\n1 1 0 1\n1.5 1 1 1 5\n", "line 3: 1.5 is not an index of a voxel", "", NULL},
        {"2 1 1 3\n1 1 0 1\n1 1 1 -1 5\n", "line 3: -1 is not lwc: it must be 0..1e+06", "", NULL},
        {"2 1 1 3\n1 1 0 1\n1 1 1 nan 5\n", "line 3: 'nan' is not lwc", "", NULL},
        {"2 1 1 3\n1 1 0 1\n1 1 1 1\n2 1 1 1 5\n", "line 4: more numbers than a row has", "", NULL},
        {"2 1 1 3\n1 1 0 1\n1 1 1 1", "line 3: the file ends where reff should be", "", NULL},
        {"2 1 1 3\n1 1 0 1\n1 1 1 1 5\n1 1 1 1 5\n", "line 4: voxel (1, 1, 1) has a second row", "",
         NULL},
        {"2 1 1 1\n1 1 0 1\n1 1 1 1 0.8 1\n2 1 1 1 0.7 1\n", "line 4: g changes from 0.8 to 0.7",
         "a file for each", &extinction},
        {"2 1 1 3\n1 1 0 1\n1 1 1 1 5\n",
         "variable 'lwc' has the unit 'g/m3', and extinction_per_m", "value_unit", &extinction},
        {"2 1 1 3\n1 1 0 1\n1 1 1 1 1\n",
         "voxel (0, 0, 0) has 1 g/m3 and an effective radius of 1 "
         "um; 2 to 1000 um",
         "radius_unit_um", &droplets},
        {"2 1 1 1\n1 1 0 1\n1 1 1 1 0 1\n", "it has no 'reff'; its rows have no radius", "",
         &droplets},
        {"2 1 1 3\n1 1 0 1\n1 1 1 1 5\n", "it has no 'ext'; its values are 'lwc'", "", &other},
        {"9 9 9 3\n1 1 0 1 2 3 4 5 6 7 8 9\n1 1 1 1 5\n", "9 x 9 x 9 nodes need", "index_box",
         &small},
        {"3 kinds\n2 1 1\n", "line 1: a cloud of 3 parameters, not 1 or 2", "several kinds", NULL},
        {"1\n1 1 1\n1 1\n1\n290\n1 1 1 1\n", "one level, which has no thickness", "", NULL},
        {"1\n1 1 1\n1 1\n1 2\n290\n1 1 1 1\n", "line 5: 1 temperatures for 2 heights", "", NULL},
        {"1\n2", "line 2: the file ends where a number of voxels should be", "", NULL},
        {"1 2 3\n", "line 1: more than 2 x 1 x 1 numbers", "", &table},
        {"1\n", "line 2: the file ends where value should be", "", &table},
        {"1 x\n", "line 1: 'x' is not value", "", &table},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        const struct neph_volume_request *request = cases[i].request ? cases[i].request : &water;
        struct neph_grid *grid;
        struct neph_diag diag = {0};
        if (read_text(state, "bad.dat", cases[i].text, *request, &grid, &diag) != NEPH_ERR_INPUT ||
            !strstr(diag.message, cases[i].words) || !strstr(diag.message, "'bad.dat'") ||
            !strstr(diag.hint, cases[i].hint) || grid)
            fail_msg("%s: %s; %s", cases[i].text, diag.message, diag.hint);
    }
}

/* ---- in a scene ---- */

static enum neph_status load(void **state, const char *keys, struct neph_scene **scene,
                             struct neph_diag *diag)
{
    char path[SCRATCH_PATH_MAX];
    char *text = neph_format(
        "title: a probe\n"
        "camera: {position_m: [0, 1, 50], look_at_m: [0, 1, 0], vertical_fov_deg: 40}\n"
        "scattering: none\nmedia:\n  - volume: {%s, albedo: [1, 1, 1]}\n",
        keys);
    scratch_write(scratch_path(state, path, "cloud.lwc"), i3rc, strlen(i3rc));
    scratch_write(scratch_path(state, path, "table"), "1 2\n3 4\n", 8);
    scratch_write(scratch_path(state, path, "probe.yaml"), text, strlen(text));
    free(text);
    *scene = NULL;
    return neph_scene_load(path, scene, diag);
}

static void test_keys_of_a_scene(void **state)
{
    static const struct {
        const char *keys, *words; /* NULL: it is good */
    } cases[] = {
        {"file: cloud.lwc, water_g_per_m3: 1, radius_grid: reff", NULL},
        {"file: cloud.lwc, water_g_per_m3: 1, radius_grid: reff, interpolation: trilinear", NULL},
        {"file: cloud.lwc, water_g_per_m3: 1, radius_grid: reff, repeat: [0, 1, 0]", NULL},
        {"file: cloud.lwc, grid: lwc, water_g_per_m3: 1, effective_radius_um: 10", NULL},
        {"file: table, table_size: [2, 1, 2], center_m: [0, 0, 0], size_m: [2, 2, 1], "
         "extinction_per_m: 0.5, repeat: [0, 1, 1]",
         NULL},
        {"file: table, table_size: [1, 2, 2], center_m: [0, 0, 0], size_m: [2, 2, 1], "
         "extinction_per_m: 0.5",
         NULL},
        {"file: table, extinction_per_m: 1", "'table' must end in"},
        {"file: table, table_size: [2, 1, 2], extinction_per_m: 1", "missing key 'center_m'"},
        {"file: table, table_size: [2, 1, 2], placement: file, extinction_per_m: 1",
         "a .df3 or a table has no size and place"},
        {"file: table, table_size: [2, 1, 2], center_m: [0, 0, 0], size_m: [2, 2, 1], "
         "radius_grid: reff, water_g_per_m3: 1",
         "a .df3 or a table has only one grid"},
        {"file: table, table_size: [2, 1, 2], center_m: [0, 0, 0], size_m: [2, 2, 1], "
         "extinction_per_m: 1, value_unit: 1/km",
         "volume.value_unit: only a .nc or a text with a header has it"},
        {"file: table, table_size: [2, 1, 2], center_m: [0, 0, 0], size_m: [0.01, 2, 1], "
         "extinction_per_m: 1, repeat: [0, 1, 1]",
         "volume.repeat: nodes 0.005 m apart"},
    };
    char hashes[COUNT(cases)][NEPH_HASH_HEX_SIZE];
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct neph_scene *scene;
        struct neph_diag diag = {0};
        const enum neph_status status = load(state, cases[i].keys, &scene, &diag);
        if ((status == NEPH_OK) != !cases[i].words ||
            (cases[i].words && (!strstr(diag.message, cases[i].words) || diag.line != 5)))
            fail_msg("%s: line %d: %s", cases[i].keys, diag.line, diag.message);
        memcpy(hashes[i], scene ? scene->hash : "-", scene ? NEPH_HASH_HEX_SIZE : 2);
        for (size_t k = 0; k < i && scene; k++)
            assert_string_not_equal(hashes[i], hashes[k]);
        neph_scene_destroy(scene);
    }
}

/* The table without end along x: (4 + 1) / 2 of the two columns of a layer. */
static void test_a_table_without_end(void **state)
{
    struct neph_scene *scene;
    struct neph_diag diag = {0};
    neph_assert_ok(load(state,
                        "file: table, table_size: [2, 1, 2], center_m: [0, 0, 0], size_m: [2, 2, 1]"
                        ", extinction_per_m: 0.5, repeat: [0, 1, 0]",
                        &scene, &diag),
                   &diag);
    const struct neph_vec3 at[] = {{-0.5, 0.5, 0}, {0.5, 0.5, 0}, {-0.5, -0.5, 0}, {0.5, -0.5, 0}};
    for (int i = 0; i < 4; i++)
        for (int turn = -3; turn <= 3; turn++) {
            const struct neph_vec3 point_m = {at[i].x + 2.0 * turn, at[i].y, 7.0 * turn};
            neph_assert_close(neph_medium_extinction_per_m(&scene->media[0], point_m),
                              0.5 * (i + 1), 1e-7, 0.0);
        }
    neph_scene_destroy(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        scratch_test(test_a_cloud_of_mystic),
        scratch_test(test_clouds_of_i3rc_and_shdom),
        scratch_test(test_extinction),
        scratch_test(test_a_table_and_a_part),
        scratch_test(test_errors_name_their_line),
        scratch_test(test_keys_of_a_scene),
        scratch_test(test_a_table_without_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
