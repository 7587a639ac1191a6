/* SPDX-License-Identifier: MIT
 *
 * The position of a file's voxels in the form `volume` of a medium, for each of its keys: by the
 * transform of the file, or by a size of the block of voxels. Contradictions are refused with a way
 * out, and every key that moves a voxel changes the hash of the scene.
 */
#include "tests/base/scratch.h"
#include "tests/scene_builders.h"

#include "scenes/grid.h"
#include "scenes/media.h"
#include "scenes/volume_file.h"

#include <time.h>

enum { KEYS_BYTES = 400 };

/* 5 x 4 x 3 nodes of 0.5 x 0.25 x 2, the first at (-1, 2, 3). Its values are 1 to 7. */
static struct neph_grid *make_grid(const int size[3])
{
    const struct neph_vec3 origin = {-1, 2, 3}, spacing = {0.5, 0.25, 2};
    struct neph_grid *grid = NULL;
    neph_assert_ok(neph_grid_create(size, origin, spacing, &grid, NULL), NULL);
    for (int n = 0; n < size[0] * size[1] * size[2]; n++)
        grid->values[n] = (float)(n % 7 + 1);
    neph_assert_ok(neph_grid_seal(grid, NULL), NULL);
    return grid;
}

/* cloud.vdb and cloud.df3 in the scratch folder. */
static int files_setup(void **state)
{
    static const int size[3] = {5, 4, 3};
    char path[SCRATCH_PATH_MAX];
    if (scratch_setup(state) != 0)
        return -1;
    struct neph_grid *grid = make_grid(size);
    neph_assert_ok(neph_volume_write(scratch_path(state, path, "cloud.vdb"), grid, NULL), NULL);
    neph_assert_ok(neph_volume_write(scratch_path(state, path, "cloud.df3"), grid, NULL), NULL);
    neph_grid_destroy(grid);
    return 0;
}

/* The scene with this volume on its line 7. */
static enum neph_status load(void **state, const char *keys, struct neph_scene **scene,
                             struct neph_diag *diag)
{
    static const char head[] =
        "name: probe\ntitle: a probe\nphysics: none\n"
        "camera: {position_m: [0, 0, 50], look_at_m: [0, 0, 0], vertical_fov_deg: 40}\n"
        "scattering: none\n"
        "media:\n";
    char path[SCRATCH_PATH_MAX], text[sizeof(head) + KEYS_BYTES];
    snprintf(text, sizeof(text), "%s  - volume: {%s, extinction_per_m: 2, albedo: [0, 0, 0]}\n",
             head, keys);
    scratch_write(scratch_path(state, path, "probe.yaml"), text, strlen(text));
    *scene = NULL;
    return neph_scene_load(path, scene, diag);
}

static struct neph_scene *load_good(void **state, const char *keys)
{
    struct neph_scene *scene = NULL;
    struct neph_diag diag = {0};
    const enum neph_status status = load(state, keys, &scene, &diag);
    if (status)
        print_error("%s\n", keys);
    neph_assert_ok(status, &diag);
    return scene;
}

static void assert_vec3(const char *keys, struct neph_vec3 found, struct neph_vec3 expected)
{
    const double off = neph_vec3_length(neph_vec3_sub(found, expected));
    if (!(off <= 1e-14)) /* a few roundings of tens */
        fail_msg("%s: (%g, %g, %g), expected (%g, %g, %g)", keys, found.x, found.y, found.z,
                 expected.x, expected.y, expected.z);
}

#define BOX "index_box: {first: [1, 0, 0], last: [4, 1, 2]}"

static void test_keys_put_it_in_place(void **state)
{
    static const struct {
        const char *keys;
        struct neph_vec3 first_m, spacing_m;
    } cases[] = {
        /* the transform of the file */
        {"file: cloud.vdb", {-1, 2, 3}, {0.5, 0.25, 2}},
        {"file: cloud.vdb, placement: file", {-1, 2, 3}, {0.5, 0.25, 2}},
        {"file: cloud.vdb, origin_m: [10, 20, 30]", {9, 22, 33}, {0.5, 0.25, 2}},
        {"file: cloud.vdb, unit_m: 0.5, origin_m: [1, 1, 1]", {0.5, 2, 2.5}, {0.25, 0.125, 1}},
        {"file: cloud.vdb, " BOX, {-0.5, 2, 3}, {0.5, 0.25, 2}},
        /* the last y, 2.75, becomes the first z */
        {"file: cloud.vdb, up: z", {-1, 3, -2.75}, {0.5, 2, 0.25}},
        {"file: cloud.vdb, up: z, unit_m: 2", {-2, 6, -5.5}, {1, 4, 0.5}},
        /* a block of 2.5 x 1 x 6 becomes one of 5 x 2 x 12 */
        {"file: cloud.vdb, center_m: [0, 0, 1], longest_side_m: 12", {-2, -0.75, -3}, {1, 0.5, 4}},
        {"file: cloud.vdb, center_m: [0, 0, 1], longest_side_m: 12, up: z",
         {-2, -4, 0.25},
         {1, 4, 0.5}},
        {"file: cloud.vdb, center_m: [0, 0, 1], size_m: [10, 8, 3]", {-4, -3, 0}, {2, 2, 1}},
        {"file: cloud.vdb, placement: fit, center_m: [0, 0, 1], longest_side_m: 12, " BOX,
         {-1.5, -0.25, -3},
         {1, 0.5, 4}},
        /* 7 x 6 x 5 cubes */
        {"file: cloud.df3, center_m: [0, 0, 1], longest_side_m: 3.5",
         {-1.5, -1.25, 0},
         {.5, .5, .5}},
        {"file: cloud.df3, center_m: [0, 0, 0], longest_side_m: 3.5, up: z",
         {-1.5, -1, -1.25},
         {.5, .5, .5}},
        {"file: cloud.df3, center_m: [0, 0, 0], size_m: [7, 3, 10]", {-3, -1.25, -4}, {1, .5, 2}},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct neph_scene *scene = load_good(state, cases[i].keys);
        const struct neph_grid *grid = scene->media[0].grid;
        assert_vec3(cases[i].keys, grid->origin_m, cases[i].first_m);
        assert_vec3(cases[i].keys, grid->spacing_m, cases[i].spacing_m);
        neph_scene_destroy(scene);
    }
}

static void test_contradictions_are_refused(void **state)
{
    static const char fit[] = "center_m, and longest_side_m or size_m";
    const struct {
        const char *keys, *words, *hint;
    } cases[] = {
        {"file: cloud.vdb, placement: file, center_m: [0, 0, 0]", "center_m", "placement: fit"},
        {"file: cloud.vdb, placement: file, longest_side_m: 1", "longest_side_m", "placement: fit"},
        {"file: cloud.vdb, placement: file, size_m: [1, 1, 1]", "size_m", "unit_m"},
        {"file: cloud.vdb, placement: file, fit_to: active", "fit_to", "placement: fit"},
        {"file: cloud.vdb, placement: fit", "center_m", fit},
        {"file: cloud.vdb, center_m: [0, 0, 0]", "longest_side_m", fit},
        {"file: cloud.vdb, longest_side_m: 1", "center_m", fit},
        {"file: cloud.vdb, center_m: [0, 0, 0], longest_side_m: 1, size_m: [1, 1, 1]", "size_m",
         fit},
        {"file: cloud.vdb, center_m: [0, 0, 0], longest_side_m: 1, unit_m: 1", "unit_m",
         "leave out"},
        {"file: cloud.vdb, center_m: [0, 0, 0], longest_side_m: 1, fit_to: active, " BOX, "fit_to",
         "leave one"},
        {"file: cloud.vdb, unit_m: 1e6", "-1.5e+06 to 1.5e+06 m along x", "unit_m"},
        {"file: cloud.vdb, index_box: {first: [0, 3, 0], last: [0, 2, 0]}", "index_box.last[1]",
         ""},
        {"file: cloud.vdb, index_box: {first: [0, 0, 0]}", "index_box.last", ""},
        {"file: cloud.vdb, index_box: {first: [0, 0, 0], last: [2000, 0, 0]}", "at most 1024",
         "index_box"},
        {"file: cloud.df3", "center_m", fit},
        {"file: cloud.df3, placement: file", "has no size and place", fit},
        {"file: cloud.df3, unit_m: 1", "unit_m", ".df3 or a table has neither"},
        {"file: cloud.df3, center_m: [0, 0, 0], longest_side_m: 1, fit_to: values", "fit_to",
         "leave the key out"},
        {"file: cloud.vdb, placement: fill", "one of file, fit", ""},
        {"file: cloud.vdb, up: x", "one of y, z", ""},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct neph_scene *scene;
        struct neph_diag diag = {0};
        const enum neph_status status = load(state, cases[i].keys, &scene, &diag);
        if (status != NEPH_ERR_INPUT || diag.line != 7 || !strstr(diag.message, cases[i].words) ||
            !strstr(diag.hint, cases[i].hint))
            fail_msg("%s: %s, line %d: %s; %s", cases[i].keys, neph_status_name(status), diag.line,
                     diag.message, diag.hint);
    }
}

/* The store finds a frame by the scene's hash. */
static void test_every_key_is_in_the_hash(void **state)
{
    static const char *const keys[] = {
        "file: cloud.vdb",
        "file: cloud.vdb, up: z",
        "file: cloud.vdb, origin_m: [0, 0, 1]",
        "file: cloud.vdb, unit_m: 2",
        "file: cloud.vdb, " BOX,
        "file: cloud.vdb, center_m: [0, 0, 0], longest_side_m: 4",
        "file: cloud.vdb, center_m: [0, 0, 0], longest_side_m: 4, up: z",
        "file: cloud.vdb, center_m: [0, 0, 0], longest_side_m: 4, " BOX,
        "file: cloud.vdb, center_m: [0, 0, 0], longest_side_m: 5",
        "file: cloud.vdb, center_m: [0, 1, 0], longest_side_m: 5",
        "file: cloud.vdb, center_m: [0, 1, 0], size_m: [5, 5, 5]",
        "file: cloud.df3, center_m: [0, 1, 0], size_m: [5, 5, 5]",
    };
    char hashes[COUNT(keys)][NEPH_HASH_HEX_SIZE];
    for (size_t i = 0; i < COUNT(keys); i++) {
        struct neph_scene *scene = load_good(state, keys[i]);
        memcpy(hashes[i], scene->hash, NEPH_HASH_HEX_SIZE);
        for (size_t k = 0; k < i; k++)
            assert_string_not_equal(hashes[i], hashes[k]);
        neph_scene_destroy(scene);
    }
}

/* Two frames of a simulation: in the second the box is larger and has moved. With the file's
 * transform the common part stays at its position. */
static void test_a_sequence_keeps_its_place(void **state)
{
    static const int small[3] = {3, 3, 3}, large[3] = {6, 4, 3};
    char path[SCRATCH_PATH_MAX];
    struct neph_grid *before = make_grid(small), *after = make_grid(large);
    after->origin_m.x -= 1.0; /* two more nodes on this side, one on the other */
    for (int k = 0; k < 3; k++)
        for (int j = 0; j < 3; j++)
            for (int i = 0; i < 3; i++)
                after->values[(k * 4 + j) * 6 + i + 2] = before->values[(k * 3 + j) * 3 + i];
    neph_assert_ok(neph_grid_seal(after, NULL), NULL);
    neph_assert_ok(neph_volume_write(scratch_path(state, path, "0.vdb"), before, NULL), NULL);
    neph_assert_ok(neph_volume_write(scratch_path(state, path, "1.vdb"), after, NULL), NULL);
    struct neph_scene *first = load_good(state, "file: 0.vdb, unit_m: 4, origin_m: [1, 2, 3]");
    struct neph_scene *second = load_good(state, "file: 1.vdb, unit_m: 4, origin_m: [1, 2, 3]");
    for (int n = 0; n < 27; n++) { /* file positions times 4, moved */
        const struct neph_vec3 point_m = {1 + 4 * (-1 + 0.5 * (n % 3)),
                                          2 + 4 * (2 + 0.25 * (n / 3 % 3)),
                                          3 + 4 * (3 + 2.0 * (n / 9))};
        const double per_m = neph_medium_extinction_per_m(&first->media[0], point_m);
        neph_assert_close(per_m, 2.0 * (n % 7 + 1), 0, 0);
        neph_assert_close(neph_medium_extinction_per_m(&second->media[0], point_m), per_m, 0, 0);
    }
    neph_scene_destroy(second);
    neph_scene_destroy(first);
    neph_grid_destroy(after);
    neph_grid_destroy(before);
}

/* A block of any shape. */
static struct neph_grid *random_block(uint64_t *seed)
{
    int size[3];
    double first_m[3], spacing_m[3];
    for (int i = 0; i < 3; i++) {
        size[i] = 1 + (int)(neph_test_random(seed) % 9);
        spacing_m[i] = neph_test_uniform(seed, 0.1, 3.0);
        first_m[i] = neph_test_uniform(seed, -9.0, 9.0);
    }
    struct neph_grid *grid = NULL;
    neph_assert_ok(neph_grid_create(size, (struct neph_vec3){first_m[0], first_m[1], first_m[2]},
                                    (struct neph_vec3){spacing_m[0], spacing_m[1], spacing_m[2]},
                                    &grid, NULL),
                   NULL);
    for (int n = 0; n < size[0] * size[1] * size[2]; n++)
        grid->values[n] = (float)neph_test_uniform(seed, 0.0, 2.0);
    neph_assert_ok(neph_grid_seal(grid, NULL), NULL);
    return grid;
}

/* The keys that place a .df3, with its layer of zeros, at the block. */
static void describe_block(const struct neph_grid *grid, char keys[KEYS_BYTES])
{
    const struct neph_vec3 o = grid->origin_m, h = grid->spacing_m;
    const int *size = grid->size;
    snprintf(keys, KEYS_BYTES,
             "file: block.df3, center_m: [%.17g, %.17g, %.17g], size_m: [%.17g, %.17g, %.17g]",
             o.x + 0.5 * (size[0] - 1) * h.x, o.y + 0.5 * (size[1] - 1) * h.y,
             o.z + 0.5 * (size[2] - 1) * h.z, (size[0] + 2) * h.x, (size[1] + 2) * h.y,
             (size[2] + 2) * h.z);
}

/* Along random rays: to a float32 of a density, 2^-24, and the same again for its fraction of the
 * largest one; 200 m are rounded to 3e-14 m. */
static void assert_same_depths(const struct neph_grid *found, const struct neph_grid *expected,
                               uint64_t *seed)
{
    const struct neph_bounds box = neph_grid_support(expected);
    for (int ray = 0; ray < 20; ray++) {
        const struct neph_vec3 from_m = {neph_test_uniform(seed, -40, 40), 60.0,
                                         neph_test_uniform(seed, -40, 40)};
        const struct neph_vec3 to_m = random_place_in(&box, seed);
        const struct neph_vec3 view = neph_vec3_normalize(neph_vec3_sub(to_m, from_m));
        neph_assert_close((double)expected->maximum *
                              neph_grid_integral_m(found, from_m, view, 0.0, 200.0),
                          neph_grid_integral_m(expected, from_m, view, 0.0, 200.0), 0x1p-23, 1e-12);
    }
}

/* A medium written as a .df3 is read back as the same medium, whatever its shape. */
static void test_a_df3_comes_back(void **state)
{
    uint64_t seed = (uint64_t)time(NULL);
    print_message("blocks: seed %llu\n", (unsigned long long)seed);
    char path[SCRATCH_PATH_MAX], keys[KEYS_BYTES];
    scratch_path(state, path, "block.df3");
    for (int block = 0; block < 20; block++) {
        struct neph_grid *grid = random_block(&seed);
        neph_assert_ok(neph_volume_write(path, grid, NULL), NULL);
        describe_block(grid, keys);
        struct neph_scene *scene = load_good(state, keys);
        assert_same_depths(scene->media[0].grid, grid, &seed);
        neph_scene_destroy(scene);
        neph_grid_destroy(grid);
    }
}

#define files_test(function)                                                                       \
    cmocka_unit_test_setup_teardown(function, files_setup, scratch_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        files_test(test_keys_put_it_in_place),     files_test(test_contradictions_are_refused),
        files_test(test_every_key_is_in_the_hash), scratch_test(test_a_sequence_keeps_its_place),
        scratch_test(test_a_df3_comes_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
