/* SPDX-License-Identifier: MIT
 *
 * Volume files: files written by neph are read back bit by bit; files of other programs are
 * interpreted correctly; damaged and inconsistent files are refused with a message.
 *
 * The mutations take their seed from NEPH_TEST_SEED, or from the clock, and print it. The Disney
 * cloud (Walt Disney Animation Studios, CC BY-SA 3.0) is read when NEPH_DISNEY_CLOUD names it.
 */
#include "tests/base/scratch.h"

#include "base/child.h"
#include "scenes/grid.h"
#include "scenes/volume_file.h"

#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { MIB = 1 << 20, LIMIT = 64 * MIB };

static int node_count(const struct neph_grid *grid)
{
    return grid->size[0] * grid->size[1] * grid->size[2];
}

static struct neph_grid *make_grid(const int size[3], uint64_t seed)
{
    const struct neph_vec3 origin_m = {-1.7, 1e3 / 3.0, 0.1}, spacing_m = {0.3, 1.0 / 3.0, 7.0};
    struct neph_grid *grid = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_grid_create(size, origin_m, spacing_m, &grid, &diag), &diag);
    for (int n = 0; n < node_count(grid); n++)
        grid->values[n] = (float)fmax(0.0, neph_test_uniform(&seed, -0.5, 3.0));
    neph_assert_ok(neph_grid_seal(grid, &diag), &diag);
    return grid;
}

static struct neph_grid *read_request(const struct neph_volume_request *request)
{
    struct neph_grid *grid = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_volume_read(request, &grid, &diag), &diag);
    return grid;
}

static struct neph_grid *read_grid(const char *path, const char *name)
{
    return read_request(&(struct neph_volume_request){
        .path = path, .grid_name = name, .memory_limit_bytes = LIMIT});
}

static void assert_refused(const char *path, const char *name, size_t limit_bytes,
                           enum neph_status expected, const char *words)
{
    struct neph_grid *grid = NULL;
    struct neph_diag diag = {0};
    const struct neph_volume_request request = {
        .path = path, .grid_name = name, .memory_limit_bytes = limit_bytes};
    const enum neph_status status = neph_volume_read(&request, &grid, &diag);
    assert_null(grid);
    if (status == expected && strstr(diag.message, words) && strstr(diag.message, path))
        return;
    print_error("%s: %s; expected '%s'\n", neph_status_name(status), diag.message, words);
    fail();
}

/* ---- OpenVDB: written by neph ---------------------------------------------------------------- */

static void test_vdb_round_trip(void **state)
{
    static const int sizes[][3] = {{1, 1, 1}, {2, 1, 3}, {8, 8, 8}, {17, 9, 30}, {1, 200, 2}};
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "grid.vdb");
    for (size_t i = 0; i < COUNT(sizes); i++) {
        struct neph_diag diag = {0};
        struct neph_grid *grid = make_grid(sizes[i], i);
        neph_assert_ok(neph_volume_write_vdb(path, grid, NEPH_VDB_WORLD, &diag), &diag);
        struct neph_grid *found = read_grid(path, NULL);
        assert_memory_equal(found->size, grid->size, sizeof(grid->size));
        assert_memory_equal(&found->origin_m, &grid->origin_m, sizeof(grid->origin_m));
        assert_memory_equal(&found->spacing_m, &grid->spacing_m, sizeof(grid->spacing_m));
        assert_memory_equal(found->values, grid->values, sizeof(float) * (size_t)node_count(grid));
        assert_string_equal(found->hash, grid->hash);
        neph_grid_destroy(found);
        neph_grid_destroy(grid);
    }
    assert_int_equal(scratch_count(state), 1); /* no temporary file is left */
}

static void assert_same_bytes(const char *path_a, const char *path_b)
{
    char *a = NULL, *b = NULL;
    size_t size_a = 0, size_b = 0;
    neph_assert_ok(neph_file_read(path_a, LIMIT, &a, &size_a, NULL), NULL);
    neph_assert_ok(neph_file_read(path_b, LIMIT, &b, &size_b, NULL), NULL);
    assert_int_equal(size_a, size_b);
    assert_memory_equal(a, b, size_a);
    free(a);
    free(b);
}

static void test_same_grid_gives_same_bytes(void **state)
{
    const int size[3] = {11, 12, 13};
    char first[SCRATCH_PATH_MAX], second[SCRATCH_PATH_MAX];
    scratch_path(state, first, "first.vdb");
    scratch_path(state, second, "second.vdb");
    struct neph_grid *grid = make_grid(size, 1);
    struct neph_diag diag = {0};
    neph_assert_ok(neph_volume_write_vdb(first, grid, NEPH_VDB_WORLD, &diag), &diag);
    neph_assert_ok(neph_volume_write_vdb(second, grid, NEPH_VDB_WORLD, &diag), &diag);
    assert_same_bytes(first, second);
    neph_grid_destroy(grid);
}

static float at(const struct neph_grid *grid, int i, int j, int k)
{
    return grid->values[(k * grid->size[1] + j) * grid->size[0] + i];
}

/* Node (i, j, k) becomes (i + 1, nz - k, j + 1). Blender displays a voxel half a voxel further than
 * OpenVDB's index: there the position must be the node's, as (x, -z, y). */
static void test_vdb_for_blender(void **state)
{
    const int size[3] = {4, 5, 6};
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "grid.vdb");
    struct neph_grid *grid = make_grid(size, 2);
    struct neph_diag diag = {0};
    neph_assert_ok(neph_volume_write_vdb(path, grid, NEPH_VDB_BLENDER, &diag), &diag);
    struct neph_grid *found = read_grid(path, NULL);
    assert_int_equal(found->size[0], size[0] + 2);
    assert_int_equal(found->size[1], size[2] + 2);
    assert_int_equal(found->size[2], size[1] + 2);
    for (int k = 0; k < size[2]; k++)
        for (int j = 0; j < size[1]; j++)
            for (int i = 0; i < size[0]; i++)
                assert_float_equal(at(found, i + 1, size[2] - k, j + 1), at(grid, i, j, k), 0);
    const struct neph_vec3 o = found->origin_m, h = found->spacing_m;
    neph_assert_close(o.x + 1.5 * h.x, grid->origin_m.x, 1e-15, 0);
    neph_assert_close(o.y + (size[2] + 0.5) * h.y, -grid->origin_m.z, 0, 1e-13);
    neph_assert_close(o.z + 1.5 * h.z, grid->origin_m.y, 1e-15, 0);
    assert_float_equal(at(found, 0, 3, 3), 1e-9f, 0);
    assert_float_equal(at(found, 5, 7, 6), 1e-9f, 0);
    neph_grid_destroy(found);
    neph_grid_destroy(grid);
}

/* ---- OpenVDB: by other programs -------------------------------------------------------------- */

/* A folder with the samples of make_vdb.cpp. */
static int samples_setup(void **state)
{
    if (scratch_setup(state) != 0)
        return -1;
    const struct scratch *scratch = *state;
    const char *const argv[] = {NEPH_MAKE_VDB, scratch->folder, NULL};
    const struct neph_child_params params = {.argv = argv};
    struct neph_child_result result;
    return neph_child_run(&params, &result, NULL) == NEPH_OK ? 0 : -1;
}

static void assert_ramp(const struct neph_grid *grid)
{
    const int size[3] = {5, 4, 3};
    assert_memory_equal(grid->size, size, sizeof(size));
    for (int k = 0; k < 3; k++)
        for (int j = 0; j < 4; j++)
            for (int i = 0; i < 5; i++)
                assert_float_equal(at(grid, i, j, k), i + 10 * j + 100 * k, 0);
}

static void test_readable_samples(void **state)
{
    static const struct {
        const char *file, *grid;
        struct neph_vec3 origin_m, spacing_m;
    } samples[] = {
        {"plain.vdb", NULL, {-3, 2, 7}, {1, 1, 1}},
        {"half.vdb", NULL, {-3, 2, 7}, {1, 1, 1}},
        {"one_of_another_name.vdb", NULL, {-3, 2, 7}, {1, 1, 1}},
        {"several.vdb", NULL, {-3, 2, 7}, {1, 1, 1}},
        {"several.vdb", "smoke", {-3, 2, 7}, {1, 1, 1}},
        {"placed.vdb", "density", {8.5, -16.0, 31.75}, {0.5, 2.0, 0.25}},
    };
    char path[SCRATCH_PATH_MAX];
    for (size_t i = 0; i < COUNT(samples); i++) {
        struct neph_grid *grid = read_grid(scratch_path(state, path, samples[i].file),
                                           samples[i].grid);
        assert_ramp(grid);
        assert_memory_equal(&grid->origin_m, &samples[i].origin_m, sizeof(grid->origin_m));
        assert_memory_equal(&grid->spacing_m, &samples[i].spacing_m, sizeof(grid->spacing_m));
        neph_grid_destroy(grid);
    }
}

static void test_tiles_are_read(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_grid *grid = read_grid(scratch_path(state, path, "tile.vdb"), NULL);
    const int size[3] = {9, 8, 8};
    assert_memory_equal(grid->size, size, sizeof(size));
    assert_float_equal(at(grid, 0, 0, 0), 0.5, 0);
    assert_float_equal(at(grid, 7, 7, 7), 0.5, 0);
    assert_float_equal(at(grid, 8, 0, 0), 0.25, 0);
    assert_float_equal(at(grid, 8, 1, 0), 0, 0);
    neph_grid_destroy(grid);
}

static void test_refused_samples(void **state)
{
    static const struct {
        const char *file, *grid, *words;
    } samples[] = {
        {"plain.vdb", "smoke", "no grid 'smoke'; it has 'density'"},
        {"several_without_density.vdb", NULL, "no grid 'density'; it has 'heat', 'smoke'"},
        {"none.vdb", NULL, "no grid"},
        {"rotated.vdb", NULL, "other angles"},
        {"turned_too_far.vdb", NULL, "other angles"},
        {"two_of_one_name.vdb", NULL, "2 grids 'density'"},
        {"two_of_one_name.vdb", "density", "2 grids 'density'"},
        {"frustum.vdb", NULL, "frustum"},
        {"vast.vdb", NULL, "a side may have at most 1024"},
        {"outside.vdb", NULL, "everywhere outside"},
        {"empty.vdb", NULL, "no active voxel"},
        {"vectors.vdb", NULL, "vec3s"},
        {"level_set.vdb", NULL, "is a Level Set"},
        {"instance.vdb", "again", "an instance of grid 'density'"},
        {"nan.vdb", NULL, "nan"},
        {"infinite.vdb", NULL, "inf"},
        {"negative.vdb", NULL, "-0.5"},
    };
    char path[SCRATCH_PATH_MAX];
    for (size_t i = 0; i < COUNT(samples); i++)
        assert_refused(scratch_path(state, path, samples[i].file), samples[i].grid, LIMIT,
                       NEPH_ERR_INPUT, samples[i].words);
    /* 60 nodes of 4 bytes */
    assert_refused(scratch_path(state, path, "plain.vdb"), NULL, 239, NEPH_ERR_INPUT, "the limit");
    neph_grid_destroy(
        read_request(&(struct neph_volume_request){.path = path, .memory_limit_bytes = 240}));
}

/* ---- OpenVDB: positions and selection of voxels ---------------------------------------------- */

/* The positions of nodes are sums of powers of two and whole numbers: nothing is rounded. */
static void assert_turned_ramp(const struct neph_grid *grid, int turn, bool is_z_up)
{
    static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                     {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    static const double scales[3] = {0.5, 2.0, 0.25}, offsets[3] = {10.0, -20.0, 30.0};
    for (int node = 0; node < 60; node++) {
        const int index[3] = {node % 5 - 3, node / 5 % 4 + 2, node / 20 + 7};
        double file[3] = {offsets[0], offsets[1], offsets[2]};
        for (int i = 0; i < 3; i++)
            file[orders[turn / 8][i]] += (turn >> i) % 2 == 0 ? scales[i] * index[i]
                                                              : -scales[i] * index[i];
        const struct neph_vec3 point = is_z_up ? (struct neph_vec3){file[0], file[2], -file[1]}
                                               : (struct neph_vec3){file[0], file[1], file[2]};
        const double expected = index[0] + 3 + 10 * (index[1] - 2) + 100 * (index[2] - 7);
        neph_assert_close(neph_grid_density(grid, point), expected, 0, 0);
    }
}

static void test_turns_and_mirrors_are_followed(void **state)
{
    char path[SCRATCH_PATH_MAX], name[16];
    scratch_path(state, path, "turned.vdb");
    for (int turn = 0; turn < 48; turn += neph_test_by_day(5, 1)) { /* all orders, all signs */
        snprintf(name, sizeof(name), "turn%d", turn);
        const bool is_z_up = turn % 2 == 0;
        struct neph_grid *grid = read_request(&(struct neph_volume_request){
            .path = path, .grid_name = name, .memory_limit_bytes = LIMIT, .is_z_up = is_z_up});
        assert_int_equal(node_count(grid), 60);
        assert_turned_ramp(grid, turn, is_z_up);
        neph_grid_destroy(grid);
    }
}

/* Node (i, j, k) becomes (i, -k, j): y is against the third index, z along the second. */
static void test_turns_in_float32_are_turns(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_grid *grid = read_grid(scratch_path(state, path, "turned_in_float.vdb"), NULL);
    assert_true(grid->size[0] == 5 && grid->size[1] == 3 && grid->size[2] == 4);
    for (int k = 0; k < 3; k++)
        for (int j = 0; j < 4; j++)
            for (int i = 0; i < 5; i++)
                assert_float_equal(at(grid, i, 2 - k, j), i + 10 * j + 100 * k, 0);
    neph_assert_close(grid->origin_m.y, -9, 0, 1e-6); /* 4.4e-8 of nine voxels */
    neph_assert_close(grid->origin_m.z, 2, 0, 1e-6);
    neph_grid_destroy(grid);
}

/* Zeros around the cloud do not belong to its block, and neither stretch nor move it. */
static void test_active_zeros_do_not_count(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_grid *grid = read_grid(scratch_path(state, path, "padded.vdb"), NULL);
    assert_ramp(grid);
    assert_true(grid->origin_m.x == -3 && grid->origin_m.y == 2 && grid->origin_m.z == 7);
    neph_grid_destroy(grid);
    grid = read_request(&(struct neph_volume_request){
        .path = path, .memory_limit_bytes = LIMIT, .counts_zeros = true});
    assert_true(grid->size[0] == 13 && grid->size[1] == 12 && grid->size[2] == 11);
    neph_grid_destroy(grid);
}

/* A key that the message names excludes them. */
static void test_stray_voxels_have_a_way_out(void **state)
{
    static const struct neph_volume_box ramp = {{-3, 2, 7}, {1, 5, 9}};
    static const char key[] = "index_box: {first: [-3, 2, 7], last: [1, 5, 9]}";
    static const char *const files[] = {"grown.vdb", "stray.vdb"};
    char path[SCRATCH_PATH_MAX];
    for (size_t i = 0; i < COUNT(files); i++) {
        struct neph_volume_request request = {.path = scratch_path(state, path, files[i]),
                                              .memory_limit_bytes = LIMIT,
                                              .is_fitted = true};
        struct neph_grid *grid = NULL;
        struct neph_diag diag = {0};
        assert_int_equal(neph_volume_read(&request, &grid, &diag), NEPH_ERR_INPUT);
        assert_non_null(strstr(diag.message, "stray"));
        assert_non_null(strstr(diag.hint, key));
        request.index_box = &ramp;
        grid = read_request(&request);
        assert_ramp(grid);
        neph_grid_destroy(grid);
    }
    /* Without fitting the block may be larger. */
    struct neph_grid *grid = read_grid(scratch_path(state, path, "grown.vdb"), NULL);
    assert_int_equal(grid->size[0], 16);
    assert_float_equal(at(grid, 15, 1, 1), 1e-6f, 0);
    neph_grid_destroy(grid);
}

/* A part of the voxels, and a box that exceeds them. */
static void test_index_boxes(void **state)
{
    char path[SCRATCH_PATH_MAX];
    const struct neph_volume_box box = {{-1, -2, 8}, {0, 4, 11}};
    struct neph_grid *grid = read_request(
        &(struct neph_volume_request){.path = scratch_path(state, path, "placed.vdb"),
                                      .memory_limit_bytes = LIMIT,
                                      .index_box = &box});
    assert_true(grid->size[0] == 2 && grid->size[1] == 7 && grid->size[2] == 4);
    neph_assert_close(grid->origin_m.x, 10.0 - 0.5, 0, 0);
    neph_assert_close(grid->origin_m.y, -20.0 - 4.0, 0, 0);
    neph_assert_close(grid->origin_m.z, 30.0 + 2.0, 0, 0);
    assert_float_equal(at(grid, 0, 4, 0), 2 + 100, 0);
    assert_float_equal(at(grid, 1, 6, 1), 3 + 20 + 200, 0);
    assert_float_equal(at(grid, 1, 3, 1), 0, 0);
    assert_float_equal(at(grid, 1, 6, 2), 0, 0);
    neph_grid_destroy(grid);
}

static void test_grids_of_one_name_are_told_apart(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_grid *grid = read_grid(scratch_path(state, path, "two_of_one_name.vdb"),
                                       "density[0]");
    assert_float_equal(at(grid, 1, 1, 0), 7, 0);
    neph_grid_destroy(grid);
    grid = read_grid(path, "density[1]");
    assert_ramp(grid);
    neph_grid_destroy(grid);
}

/* ---- no volume ------------------------------------------------------------------------------- */

static void test_files_that_are_none(void **state)
{
    char path[SCRATCH_PATH_MAX];
    static const char *const extensions[] = {"vdb", "df3"};
    for (size_t i = 0; i < COUNT(extensions); i++) {
        char name[32];
        snprintf(name, sizeof(name), "file.%s", extensions[i]);
        scratch_path(state, path, name);
        assert_refused(path, NULL, LIMIT, NEPH_ERR_NOT_FOUND, "No such file");
        neph_assert_ok(neph_file_write(path, "", 0, NULL), NULL);
        assert_refused(path, NULL, LIMIT, NEPH_ERR_INPUT, "");
        neph_assert_ok(neph_file_write(path, "Not a volume, but a text.", 25, NULL), NULL);
        assert_refused(path, NULL, LIMIT, NEPH_ERR_INPUT, "");
        unlink(path);
        assert_int_equal(mkdir(path, 0700), 0);
        assert_refused(path, NULL, LIMIT, NEPH_ERR_INPUT, "not a regular file");
        rmdir(path);
        assert_int_equal(mkfifo(path, 0600), 0);
        assert_refused(path, NULL, LIMIT, NEPH_ERR_INPUT, "not a regular file");
        unlink(path);
    }
    assert_refused("cloud.raw", NULL, LIMIT, NEPH_ERR_INPUT, "not a volume file");
    assert_refused("folder.vdb/cloud", NULL, LIMIT, NEPH_ERR_INPUT, "not a volume file");
    assert_true(neph_volume_has_known_extension("a.b/Cloud.VDB"));
    assert_false(neph_volume_has_known_extension("vdb"));
}

static void test_missing_program(void **state)
{
    const int size[3] = {2, 2, 2};
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "grid.vdb");
    struct neph_grid *grid = make_grid(size, 3);
    struct neph_diag diag = {0};
    setenv("NEPH_VDB", "/nowhere/neph-vdb", 1);
    const enum neph_status status = neph_volume_write_vdb(path, grid, NEPH_VDB_WORLD, &diag);
    unsetenv("NEPH_VDB");
    assert_int_equal(status, NEPH_ERR_UNAVAILABLE);
    assert_non_null(strstr(diag.message, "/nowhere/neph-vdb"));
    assert_non_null(strstr(diag.hint, "NEPH_VDB"));
    assert_int_equal(scratch_count(state), 0);
    neph_grid_destroy(grid);
}

/* neph found its libraries by it, and the program must, too. */
static void test_library_folders(void **state)
{
    static const char script[] = "#!/bin/sh\necho \"folders: $LD_LIBRARY_PATH\" >&2\nexit 1\n";
    const int size[3] = {2, 2, 2};
    char path[SCRATCH_PATH_MAX], program[SCRATCH_PATH_MAX];
    scratch_path(state, path, "grid.vdb");
    scratch_path(state, program, "program");
    struct neph_grid *grid = make_grid(size, 3);
    struct neph_diag diag = {0};
    neph_assert_ok(neph_file_write(program, script, sizeof(script) - 1, &diag), &diag);
    assert_int_equal(chmod(program, 0700), 0);
    setenv("NEPH_VDB", program, 1);
    setenv("LD_LIBRARY_PATH", "/opt/one:/opt/two", 1);
    neph_volume_write_vdb(path, grid, NEPH_VDB_WORLD, &diag);
    unsetenv("LD_LIBRARY_PATH");
    unsetenv("NEPH_VDB");
    assert_non_null(strstr(diag.message, "folders: /opt/one:/opt/two"));
    neph_grid_destroy(grid);
}

/* ---- DF3 ------------------------------------------------------------------------------------- */

static void write_df3(const char *path, const int size[3], int width_bytes, uint64_t seed)
{
    const size_t count = (size_t)size[0] * (size_t)size[1] * (size_t)size[2];
    const size_t total = 6 + count * (size_t)width_bytes;
    char *bytes = malloc(total);
    for (int axis = 0; axis < 3; axis++) {
        bytes[2 * axis] = (char)(size[axis] >> 8);
        bytes[2 * axis + 1] = (char)size[axis];
    }
    for (size_t i = 6; i < total; i++)
        bytes[i] = (char)neph_test_random(&seed);
    neph_assert_ok(neph_file_write(path, bytes, total, NULL), NULL);
    free(bytes);
}

static void test_df3_widths(void **state)
{
    const int size[3] = {3, 300, 2};
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "grid.df3");
    static const int widths[] = {1, 2, 4};
    for (size_t w = 0; w < COUNT(widths); w++) {
        write_df3(path, size, widths[w], w);
        char *bytes = NULL;
        size_t total = 0;
        neph_assert_ok(neph_file_read(path, LIMIT, &bytes, &total, NULL), NULL);
        struct neph_grid *grid = read_grid(path, NULL);
        assert_memory_equal(grid->size, size, sizeof(size));
        assert_true(grid->origin_m.x == 0 && grid->origin_m.y == 0 && grid->origin_m.z == 0);
        assert_true(grid->spacing_m.x == 1 && grid->spacing_m.y == 1 && grid->spacing_m.z == 1);
        const unsigned char *code = (const unsigned char *)bytes + 6;
        for (int n = 0; n < node_count(grid); n++) {
            double value = 0.0, largest = 0.0;
            for (int b = 0; b < widths[w]; b++) {
                value = 256.0 * value + *code++;
                largest = 256.0 * largest + 255.0;
            }
            assert_float_equal(grid->values[n], (float)(value / largest), 0);
        }
        free(bytes);
        neph_grid_destroy(grid);
    }
}

/* 32-bit codes are finer than floats of 2^-8 and more, which are read back bit by bit. */
static void test_df3_round_trip(void **state)
{
    const int size[3] = {7, 6, 5};
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "grid.df3");
    struct neph_grid *grid = make_grid(size, 4);
    struct neph_diag diag = {0};
    for (int n = 0; n < node_count(grid); n++)
        grid->values[n] = grid->values[n] < 0.0625f ? 0.0f : grid->values[n];
    grid->values[3] = 4.0f; /* a power of two: dividing by it is exact */
    neph_assert_ok(neph_grid_seal(grid, &diag), &diag);
    neph_assert_ok(neph_volume_write_df3(path, grid, &diag), &diag);
    struct neph_grid *found = read_grid(path, NULL);
    for (int axis = 0; axis < 3; axis++)
        assert_int_equal(found->size[axis], size[axis] + 2);
    for (int k = -1; k <= size[2]; k++)
        for (int j = -1; j <= size[1]; j++)
            for (int i = -1; i <= size[0]; i++) {
                const bool inside = i >= 0 && j >= 0 && k >= 0 && i < size[0] && j < size[1] &&
                                    k < size[2];
                const float expected = inside ? at(grid, i, j, k) : 0.0f;
                assert_float_equal(4.0f * at(found, i + 1, j + 1, k + 1), expected, 0);
            }
    neph_grid_destroy(found);
    neph_grid_destroy(grid);
    assert_int_equal(scratch_count(state), 1);
}

/* A part of the nodes, with z of the file up: node (i, j, k) becomes (i, k, -j). */
static void test_df3_boxes_and_turns(void **state)
{
    const int size[3] = {5, 4, 3};
    const struct neph_volume_box box = {{1, 0, 1}, {3, 2, 2}}, outside = {{0, 0, 0}, {4, 4, 2}};
    char path[SCRATCH_PATH_MAX];
    write_df3(scratch_path(state, path, "grid.df3"), size, 2, 6);
    struct neph_grid *whole = read_grid(path, NULL);
    struct neph_volume_request request = {
        .path = path, .memory_limit_bytes = LIMIT, .is_z_up = true, .index_box = &box};
    struct neph_grid *part = read_request(&request);
    assert_true(part->size[0] == 3 && part->size[1] == 2 && part->size[2] == 3);
    for (int k = 1; k <= 2; k++)
        for (int j = 0; j <= 2; j++)
            for (int i = 1; i <= 3; i++) {
                const struct neph_vec3 point = {i, k, -j};
                neph_assert_close(neph_grid_density(part, point), at(whole, i, j, k), 0, 0);
            }
    neph_grid_destroy(part);
    neph_grid_destroy(whole);
    struct neph_diag diag = {0};
    request.index_box = &outside;
    assert_int_equal(neph_volume_read(&request, &part, &diag), NEPH_ERR_INPUT);
    assert_non_null(strstr(diag.message, "index_box"));
    assert_non_null(strstr(diag.hint, "0 to 3"));
}

static void test_df3_that_lies(void **state)
{
    const int size[3] = {4, 4, 4}, none[3] = {4, 0, 4};
    static const unsigned char giant[6 + 8] = {255, 255, 255, 255, 255, 255};
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "grid.df3");
    write_df3(path, size, 2, 5);
    assert_int_equal(truncate(path, 6 + 127), 0);
    assert_refused(path, NULL, LIMIT, NEPH_ERR_INPUT, "truncated");
    write_df3(path, size, 3, 5);
    assert_refused(path, NULL, LIMIT, NEPH_ERR_INPUT, "neither 1, 2 nor 4");
    write_df3(path, none, 1, 5);
    assert_refused(path, NULL, LIMIT, NEPH_ERR_INPUT, "an empty block");
    neph_assert_ok(neph_file_write(path, (const char *)giant, sizeof(giant), NULL), NULL);
    assert_refused(path, NULL, LIMIT, NEPH_ERR_INPUT, "65535 x 65535 x 65535");
    write_df3(path, size, 4, 5);
    assert_refused(path, NULL, 255, NEPH_ERR_INPUT, "the limit");
}

/* ---- damage ---------------------------------------------------------------------------------- */

static uint64_t chosen_seed(void)
{
    const char *text = getenv("NEPH_TEST_SEED");
    const uint64_t seed = text ? strtoull(text, NULL, 10) : (uint64_t)time(NULL);
    print_message("mutations of files: NEPH_TEST_SEED=%llu\n", (unsigned long long)seed);
    return seed;
}

/* Truncates it, or overwrites one to eight bytes, half of the time near the start with the
 * structure; sometimes with values that break sizes. */
static size_t mutate(char *bytes, size_t size, uint64_t *seed)
{
    if (neph_test_random(seed) % 4 == 0)
        return neph_test_random(seed) % size;
    const int count = 1 + (int)(neph_test_random(seed) % 8);
    const size_t range = neph_test_random(seed) % 2 == 0 && size > 1500 ? 1500 : size;
    for (int i = 0; i < count; i++) {
        static const char extremes[] = {0, 1, 0x7f, (char)0x80, (char)0xff};
        const size_t place = neph_test_random(seed) % range;
        bytes[place] = neph_test_random(seed) % 2 == 0 ? (char)neph_test_random(seed)
                                                       : extremes[neph_test_random(seed) % 5];
    }
    return size;
}

/* The result is a valid grid or an error with a reason; and takes little time. */
static void read_damaged(const char *path)
{
    struct neph_grid *grid = NULL;
    struct neph_diag diag = {0};
    const struct neph_volume_request request = {
        .path = path, .memory_limit_bytes = MIB, .is_fitted = true};
    const enum neph_status status = neph_volume_read(&request, &grid, &diag);
    if (!status) {
        assert_true(sizeof(float) * (size_t)node_count(grid) <= MIB);
        for (int n = 0; n < node_count(grid); n++)
            assert_true(isfinite(grid->values[n]) && grid->values[n] >= 0.0f);
    } else {
        assert_int_equal(status, NEPH_ERR_INPUT);
        assert_non_null(strstr(diag.message, path));
    }
    neph_grid_destroy(grid);
}

static void damage(const char *original, const char *path, int count, uint64_t *seed)
{
    char *bytes = NULL;
    size_t size = 0;
    neph_assert_ok(neph_file_read(original, LIMIT, &bytes, &size, NULL), NULL);
    char *copy = malloc(size);
    for (int i = 0; i < count; i++) {
        memcpy(copy, bytes, size);
        const size_t kept = mutate(copy, size, seed);
        scratch_write(path, copy, kept);
        read_damaged(path);
    }
    free(copy);
    free(bytes);
}

static void test_damaged_files(void **state)
{
    static const struct {
        const char *original, *damaged;
        int count;
    } files[] = {
        {"plain.vdb", "damaged.vdb", 30},   {"tile.vdb", "damaged.vdb", 15},
        {"several.vdb", "damaged.vdb", 15}, {"level_set.vdb", "damaged.vdb", 15},
        {"plain.df3", "damaged.df3", 300},
    };
    const int size[3] = {5, 4, 3};
    char original[SCRATCH_PATH_MAX], damaged[SCRATCH_PATH_MAX];
    uint64_t seed = chosen_seed();
    write_df3(scratch_path(state, original, "plain.df3"), size, 2, seed);
    for (size_t i = 0; i < COUNT(files); i++)
        damage(scratch_path(state, original, files[i].original),
               scratch_path(state, damaged, files[i].damaged),
               neph_test_by_day(files[i].count / 3, files[i].count), &seed);
}

/* ---- production data ------------------------------------------------------------------------- */

static void test_disney_cloud(void **state)
{
    const char *path = getenv("NEPH_DISNEY_CLOUD");
    if (!path || !path[0]) {
        print_message("not run: NEPH_DISNEY_CLOUD names no wdas_cloud_sixteenth.vdb\n");
        skip();
    }
    struct neph_grid *grid = read_grid(path, NULL);
    print_message("%d x %d x %d nodes, spacing %g, maximum %g\n", grid->size[0], grid->size[1],
                  grid->size[2], grid->spacing_m.x, (double)grid->maximum);
    neph_assert_close(grid->maximum, 1.0, 0.2, 0);
    neph_grid_destroy(grid);
    assert_refused(path, NULL, MIB, NEPH_ERR_INPUT, "the limit is 1 MiB");
    assert_refused(path, "smoke", LIMIT, NEPH_ERR_INPUT, "it has 'density'");
}

#define samples_test(function)                                                                     \
    cmocka_unit_test_setup_teardown(function, samples_setup, scratch_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        scratch_test(test_vdb_round_trip),
        scratch_test(test_same_grid_gives_same_bytes),
        scratch_test(test_vdb_for_blender),
        samples_test(test_readable_samples),
        samples_test(test_tiles_are_read),
        samples_test(test_refused_samples),
        scratch_test(test_files_that_are_none),
        scratch_test(test_missing_program),
        scratch_test(test_library_folders),
        scratch_test(test_df3_widths),
        scratch_test(test_df3_round_trip),
        scratch_test(test_df3_boxes_and_turns),
        scratch_test(test_df3_that_lies),
        samples_test(test_turns_and_mirrors_are_followed),
        samples_test(test_turns_in_float32_are_turns),
        samples_test(test_active_zeros_do_not_count),
        samples_test(test_stray_voxels_have_a_way_out),
        samples_test(test_index_boxes),
        samples_test(test_grids_of_one_name_are_told_apart),
        samples_test(test_damaged_files),
        cmocka_unit_test(test_disney_cloud),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
