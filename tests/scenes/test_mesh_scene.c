/* SPDX-License-Identifier: MIT
 *
 * Meshes and height fields in scene files: their places, their instances, scattered ones, what is
 * refused, and the hash.
 */
#include "tests/base/scratch.h"
#include "tests/mesh_builders.h"

#include "base/exr.h"
#include "scenes/mesh.h"
#include "scenes/motion.h"
#include "scenes/solids.h"
#include "scenes/surfaces.h"

#include <png.h>

enum { COLUMNS = 5, ROWS = 4 };

/* Multiples of 1/8, which text and float32 hold exactly. */
static float find_height(int i, int j)
{
    return (float)((i * 5 + j * 3) % 7) / 8.0f;
}

static void test_end_scene(struct neph_scene **scene)
{
    neph_scene_destroy(*scene);
}

static void write_exr(const char *path)
{
    struct neph_image *image = NULL;
    float *heights = NULL;
    neph_assert_ok(neph_image_create(COLUMNS, ROWS, &image, NULL), NULL);
    neph_assert_ok(neph_image_add_channel(image, "height", &heights, NULL), NULL);
    for (int n = 0; n < COLUMNS * ROWS; n++)
        heights[n] = find_height(n % COLUMNS, n / COLUMNS);
    neph_assert_ok(neph_exr_write(path, image, NULL), NULL);
    neph_image_destroy(image);
}

/* The triangles of the height field in the box (0 0 0) to (4 8 3), and a box. */
static void write_objs(void **state)
{
    char path[SCRATCH_PATH_MAX], *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    for (int n = 0; n < COLUMNS * ROWS; n++)
        fprintf(out, "v %d %g %d\n", n % COLUMNS,
                8.0 * (double)find_height(n % COLUMNS, n / COLUMNS), n / COLUMNS);
    for (int j = 0; j + 1 < ROWS; j++)
        for (int i = 0; i + 1 < COLUMNS; i++) {
            const int a = j * COLUMNS + i + 1;
            fprintf(out, "f %d %d %d\nf %d %d %d\n", a, a + COLUMNS, a + 1, a + 1, a + COLUMNS,
                    a + COLUMNS + 1);
        }
    fclose(out);
    scratch_write(scratch_path(state, path, "hills.obj"), text, size);
    free(text);
    static const char box[] =
        "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 1 2 0\nv 0 0 3\nv 1 0 3\nv 0 2 3\nv 1 2 3\n"
        "f 1 5 7 3\nf 2 4 8 6\nf 1 2 6 5\nf 3 7 8 4\nf 1 3 4 2\nf 5 6 8 7\n";
    scratch_write(scratch_path(state, path, "box.obj"), box, sizeof(box) - 1);
}

static int files_setup(void **state)
{
    char path[SCRATCH_PATH_MAX];
    if (scratch_setup(state) != 0)
        return -1;
    write_exr(scratch_path(state, path, "hills.exr"));
    write_objs(state);
    scratch_write(scratch_path(state, path, "hills.png"), hills_png, sizeof(hills_png));
    static const uint8_t corners[] = {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 0, 0, 0, 0};
    png_image image = {
        .version = PNG_IMAGE_VERSION, .width = 2, .height = 2, .format = PNG_FORMAT_RGBA};
    if (!png_image_write_to_file(&image, scratch_path(state, path, "corners.png"), 0, corners, 0,
                                 NULL))
        return -1;
    static const char flat[] = "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n";
    scratch_write(scratch_path(state, path, "flat.obj"), flat, sizeof(flat) - 1);
    return 0;
}

/* The scene with these entries, of which the first is on line 7. */
static enum neph_status load(void **state, const char *solids, struct neph_scene **scene,
                             struct neph_diag *diag)
{
    static const char head[] =
        "name: probe\ntitle: a probe\n"
        "camera: {position_m: [0, 60, 50], look_at_m: [0, 0, 0], vertical_fov_deg: 40}\n"
        "frames: {count: 11}\n"
        "scattering: none\n"
        "solids:\n";
    char path[SCRATCH_PATH_MAX];
    char *text = neph_format("%s%s", head, solids);
    scratch_write(scratch_path(state, path, "probe.yaml"), text, strlen(text));
    free(text);
    *scene = NULL;
    return neph_scene_load(path, scene, diag);
}

static struct neph_scene *load_good(void **state, const char *solids)
{
    struct neph_scene *scene = NULL;
    struct neph_diag diag = {0};
    const enum neph_status status = load(state, solids, &scene, &diag);
    if (status)
        print_error("%s%s; %s\n", solids, diag.message, diag.hint);
    neph_assert_ok(status, &diag);
    return scene;
}

#define GREY ", albedo: [0.5, 0.5, 0.5]}\n"
#define FIELD "  - height_field: {file: hills.exr, min_m: [0, 0, 0], max_m: [4, 8, 3]" GREY
#define BOX "  - mesh: {file: box.obj"

/* On rays to their solids, `a` and `b` are the same; returns the hits. */
static int assert_same_hits(const struct neph_scene *a, const struct neph_scene *b)
{
    uint64_t seed = 31;
    int hits = 0;
    for (int i = 0; i < 400; i++) {
        const struct neph_bounds bounds = neph_solid_bounds(&a->solids[i % a->solid_count]);
        const struct neph_vec3 from_m = random_point(&seed, 20.0);
        const struct neph_vec3 d = neph_vec3_normalize(
            neph_vec3_sub(random_place_in(&bounds, &seed), from_m));
        const struct neph_hit hit = neph_scene_hit(a, from_m, d);
        const struct neph_hit other = neph_scene_hit(b, from_m, d);
        assert_true((hit.solid != NULL) == (other.solid != NULL));
        if (!hit.solid)
            continue;
        hits++;
        neph_assert_close(hit.t_m, other.t_m, 1e-12, 1e-12);
        neph_assert_close(fabs(neph_vec3_dot(hit.normal, other.normal)), 1.0, 1e-12, 0.0);
    }
    return hits;
}

/* --- height fields --------------------------------------------------------------------------- */

static void test_a_height_field_equals_its_mesh(void **state)
{
    OWNED(scene) struct neph_scene *field = load_good(state, FIELD);
    OWNED(scene) struct neph_scene *mesh = load_good(state, "  - mesh: {file: hills.obj" GREY);
    assert_int_equal(field->mesh_count, 1);
    const struct neph_mesh_data *data = &field->meshes[0]->data;
    assert_int_equal(data->triangle_count, 2 * (COLUMNS - 1) * (ROWS - 1));
    for (int n = 0; n < COLUMNS * ROWS; n++) {
        assert_true(data->positions[n].x == n % COLUMNS && data->positions[n].z == n / COLUMNS);
        assert_true(data->positions[n].y == 8.0 * (double)find_height(n % COLUMNS, n / COLUMNS));
    }
    assert_int_equal(mesh->meshes[0]->data.triangle_count, data->triangle_count);
    assert_true(assert_same_hits(field, mesh) > 100);
}

static void test_a_png_is_a_height_field(void **state)
{
    OWNED(scene)
    struct neph_scene *scene = load_good(
        state, "  - height_field: {file: hills.png, min_m: [-1, 10, 2], max_m: [1, 20, 3]" GREY);
    const double expected[] = {10, 20, 12, 14, 16, 18};
    const struct neph_mesh_data *data = &scene->meshes[0]->data;
    assert_int_equal(data->vertex_count, 6);
    for (int i = 0; i < 6; i++) {
        assert_true(data->positions[i].x == i % 3 - 1.0 && data->positions[i].z == 2.0 + i / 3);
        neph_assert_close(data->positions[i].y, expected[i], 1e-7, 0.0); /* of a float32 */
    }
    assert_true(neph_mesh_normal(scene->meshes[0], 0).y > 0.0);
}

static double find_height_m(int i, int j)
{
    return 8.0 * (double)find_height(i, j);
}

/* The slopes of the six triangles around a vertex; two of them share each edge along an axis. */
static struct neph_vec3 find_grid_normal(int i, int j)
{
    const double right = find_height_m(i + 1, j), left = find_height_m(i - 1, j);
    const double below = find_height_m(i, j + 1), above = find_height_m(i, j - 1);
    const double left_below = find_height_m(i - 1, j + 1);
    const double right_above = find_height_m(i + 1, j - 1);
    const double slope_x = (2.0 * (right - left) + below - left_below + right_above - above) / 6.0;
    const double slope_z = (2.0 * (below - above) + left_below - left + right - right_above) / 6.0;
    return neph_vec3_normalize((struct neph_vec3){-slope_x, 1.0, -slope_z});
}

static void test_a_height_field_is_smooth(void **state)
{
    OWNED(scene)
    struct neph_scene *scene = load_good(state, "  - height_field: {file: hills.exr, shading: "
                                                "smooth, min_m: [0, 0, 0], max_m: [4, 8, 3]" GREY);
    const struct neph_mesh *mesh = scene->meshes[0];
    assert_true(mesh->material.is_smooth && !mesh->data.uv);
    for (int j = 1; j < ROWS - 1; j++)
        for (int i = 1; i < COLUMNS - 1; i++) {
            const struct neph_vec3 own = neph_vec3_normalize(mesh->data.normals[j * COLUMNS + i]);
            const struct neph_vec3 expected = find_grid_normal(i, j);
            neph_assert_close(own.x, expected.x, 0.0, 1e-14);
            neph_assert_close(own.y, expected.y, 0.0, 1e-14);
            neph_assert_close(own.z, expected.z, 0.0, 1e-14);
        }
    OWNED(scene) struct neph_scene *flat = load_good(state, FIELD);
    assert_true(!flat->meshes[0]->data.normals && !flat->meshes[0]->data.uv);
}

/* The texture lies as the image of heights: its first pixel is at the lowest x and z. It is met in
 * the middles of its pixels. */
static void test_a_height_field_has_a_texture(void **state)
{
    OWNED(scene)
    struct neph_scene *scene = load_good(
        state, "  - height_field: {file: hills.exr, albedo_texture: corners.png, alpha: cutout, "
               "min_m: [0, 0, 0], max_m: [4, 8, 3]" GREY);
    for (int k = 0; k < 4; k++) {
        const struct neph_vec3 above_m = {k % 2 ? 3.0 : 1.0, 20.0, k / 2 ? 2.25 : 0.75};
        const struct neph_hit hit = neph_scene_hit(scene, above_m, (struct neph_vec3){0, -1, 0});
        assert_true((hit.solid != NULL) == (k < 3));
        if (!hit.solid)
            continue;
        const struct neph_rgb color = neph_surface_color(&hit, above_m);
        const double channels[3] = {color.r, color.g, color.b};
        for (int c = 0; c < 3; c++)
            neph_assert_close(channels[c], c == k ? 0.5 : 0.0, 0.0, 1e-6); /* uv are float32 */
    }
}

/* --- places ---------------------------------------------------------------------------------- */

static void test_a_mesh_of_a_box_is_placed(void **state)
{
    static const char *const rows[][2] = {
        {"}", "[0, 0, 0], max_m: [1, 2, 3]"},
        {", position_m: [5, 6, 7], scale_m: 2}", "[5, 6, 7], max_m: [7, 10, 13]"},
        {", up: z, position_m: [1, 0, 0]}", "[1, 0, -2], max_m: [2, 3, 0]"},
        {", turn_deg: 90, position_m: [0, 1, 0]}", "[0, 1, -1], max_m: [3, 3, 0]"},
    };
    for (size_t i = 0; i < COUNT(rows); i++) {
        char *mesh = neph_format(BOX "%.*s" GREY, (int)strlen(rows[i][0]) - 1, rows[i][0]);
        char *box = neph_format("  - box: {min_m: %s" GREY, rows[i][1]);
        OWNED(scene) struct neph_scene *a = load_good(state, mesh);
        OWNED(scene) struct neph_scene *b = load_good(state, box);
        assert_true(assert_same_hits(a, b) > 100);
        free(mesh);
        free(box);
    }
}

static void test_instances_equal_copies(void **state)
{
    OWNED(scene)
    struct neph_scene *shared = load_good(
        state, BOX ", scale_m: 2, turn_deg: 10, instances: [{position_m: [1, 2, 3]}, "
                   "{position_m: [-4, 0, 1], turn_deg: 20, scale: 0.5}, "
                   "{position_m: [0, -3, 0], turn_deg: -10}]" GREY);
    OWNED(scene)
    struct neph_scene *copies = load_good(
        state, BOX ", position_m: [1, 2, 3], scale_m: 2, turn_deg: 10" GREY BOX
                   ", position_m: [-4, 0, 1], scale_m: 1, turn_deg: 30" GREY BOX
                   ", position_m: [0, -3, 0], scale_m: 2" GREY);
    assert_true(shared->solid_count == 3 && shared->mesh_count == 1);
    assert_true(copies->solid_count == 3 && copies->mesh_count == 3);
    assert_true(shared->solids[0].mesh == shared->solids[2].mesh);
    assert_true(assert_same_hits(shared, copies) > 100);
    assert_string_equal(shared->hash, copies->hash); /* the same solids */
}

/* Scattered instances are in their ranges, the same for the same seed, and stand on the ground. */
static void test_scattered_instances_stand_on_the_ground(void **state)
{
    static const char scattered[] = FIELD BOX
        ", scale_m: 0.1, scatter: {count: 500, seed: 4, x_m: [1, 3], z_m: [0.5, 2.5], "
        "scale: [0.5, 2], on_ground: true}" GREY;
    OWNED(scene) struct neph_scene *scene = load_good(state, scattered);
    OWNED(scene) struct neph_scene *again = load_good(state, scattered);
    OWNED(scene) struct neph_scene *ground = load_good(state, FIELD);
    assert_int_equal(scene->solid_count, 501);
    assert_non_null(scene->solid_tree);
    assert_string_equal(scene->hash, again->hash);
    double low = 1.0, high = 0.0, mean_x_m = 0.0;
    for (int i = 1; i <= 500; i++) {
        const struct neph_solid *solid = &scene->solids[i];
        const struct neph_vec3 p = solid->center_m;
        const struct neph_vec3 above_m = {p.x, 100.0, p.z};
        assert_true(p.x >= 1 && p.x <= 3 && p.z >= 0.5 && p.z <= 2.5);
        neph_assert_close(p.y,
                          100.0 - neph_scene_hit(ground, above_m, (struct neph_vec3){0, -1, 0}).t_m,
                          0.0, 1e-9); /* from 1e6 m above */
        low = fmin(low, solid->scale_m);
        high = fmax(high, solid->scale_m);
        mean_x_m += p.x / 500.0;
    }
    assert_true(low >= 0.05 && low < 0.06 && high <= 0.2 && high > 0.19);
    neph_assert_close(mean_x_m, 2.0, 0.0, 4.0 * 2.0 / sqrt(12.0 * 500.0)); /* standard errors */
}

/* A key displaces and turns all instances of an entry about one pivot, with their tree. */
static void test_keys_move_instances(void **state)
{
    OWNED(scene)
    struct neph_scene *scene = load_good(
        state, BOX ", scatter: {count: 40, x_m: [-9, 9], z_m: [-9, 9]}, motion: {axis: y, keys: "
                   "[{frame: 0}, {frame: 10, move_m: [0, 5, 0], turn_deg: 90}]}" GREY);
    struct neph_scene *end = NULL;
    neph_assert_ok(neph_scene_at(scene, 10, &end, NULL), NULL);
    assert_true(end->solid_tree && end->solid_tree != scene->solid_tree);
    uint64_t seed = 3;
    int hits = 0;
    for (int i = 0; i < 300; i++) {
        const struct neph_bounds bounds = neph_solid_bounds(&scene->solids[i % 40]);
        const struct neph_vec3 p = random_point(&seed, 20.0);
        const struct neph_vec3 d = neph_vec3_normalize(
            neph_vec3_sub(random_place_in(&bounds, &seed), p));
        const struct neph_hit before = neph_scene_hit(scene, p, d);
        const struct neph_hit after = neph_scene_hit(end, (struct neph_vec3){p.z, p.y + 5.0, -p.x},
                                                     (struct neph_vec3){d.z, d.y, -d.x});
        assert_true((before.solid != NULL) == (after.solid != NULL));
        hits += before.solid != NULL;
        if (before.solid)
            neph_assert_close(after.t_m, before.t_m, 1e-12, 1e-12);
    }
    assert_true(hits > 20);
    neph_scene_destroy(end);
}

/* --- errors ---------------------------------------------------------------------------------- */

static void test_what_is_refused(void **state)
{
    static const struct {
        const char *solids, *words;
    } rows[] = {
        {"  - mesh: {file: none.obj" GREY, "none.obj"},
        {"  - mesh: {file: box.fbx" GREY, "box.fbx"},
        {"  - mesh: {file: flat.obj" GREY, "'flat.obj': none of the 1 triangles has an area"},
        {BOX ", object: roof" GREY, "roof"},
        {BOX ", scale_m: 0" GREY, "1e-06 to 1e+06"},
        {BOX ", scale_m: 1e6, position_m: [0, 0, -5]" GREY, "0 to 2e+06 m along y"},
        {BOX ", position_m: [0, 0, 0], instances: [{position_m: [0, 0, 0]}]" GREY,
         "instances have the places"},
        {BOX ", instances: [{position_m: [0, 0, 0]}], scatter: {count: 1, x_m: [0, 1], z_m: [0, "
             "1]}" GREY,
         "leave one of them out"},
        {BOX ", scatter: {count: 1, x_m: [0], z_m: [0, 1]}" GREY, "a list of 2 to 2 numbers"},
        {BOX ", scatter: {count: 1, x_m: [1, 0], z_m: [0, 1]}" GREY, "above the second"},
        {BOX ", scatter: {count: 10001, x_m: [0, 1], z_m: [0, 1]}" GREY, "1 to 10000"},
        {BOX ", scatter: {count: 1, x_m: [5, 6], z_m: [0, 1], on_ground: true, height_m: 3}" GREY,
         "scatter.height_m: on_ground gives the heights"},
        {BOX ", scatter: {count: 1, x_m: [5, 6], z_m: [0, 1], on_ground: true}" GREY,
         "no solid of an entry before is below the place of instance 0"},
        {BOX ", roughness: 0.5" GREY, "roughness"},
        {BOX ", metalness: 0.5" GREY, "solids[0].mesh.metalness"},
        {"  - height_field: {file: hills.exr, min_m: [0, 0, 0], max_m: [4, 0, 3]" GREY, "max_m"},
        {"  - height_field: {file: hills.obj, min_m: [0, 0, 0], max_m: [4, 1, 3]" GREY,
         "must end in .png or .exr"},
        {"  - height_field: {file: hills.exr, channel: R, min_m: [0, 0, 0], max_m: [4, 1, 3]" GREY,
         "has no channel 'R'"},
        {"  - height_field: {file: hills.exr, alpha: cutout, min_m: [0, 0, 0], max_m: [4, 1, "
         "3]" GREY,
         "solids[0].height_field.alpha"},
        {"  - height_field: {file: hills.exr, albedo_texture: /corners.png, min_m: [0, 0, 0], "
         "max_m: [4, 1, 3]" GREY,
         "outside the folder"},
        {"  - height_field: {file: none.exr, min_m: [0, 0, 0], max_m: [4, 1, 3]" GREY, "none.exr"},
        {"  - mesh: {file: $NEPH_NO_SUCH_VARIABLE/a.obj" GREY, "NEPH_NO_SUCH_VARIABLE"},
    };
    for (size_t i = 0; i < COUNT(rows); i++) {
        struct neph_scene *scene = NULL;
        struct neph_diag diag = {0};
        const enum neph_status status = load(state, rows[i].solids, &scene, &diag);
        if (!status || diag.line != 7 ||
            (!strstr(diag.message, rows[i].words) && !strstr(diag.hint, rows[i].words)))
            fail_msg("%s: %s, line %d: %s; %s", rows[i].solids, neph_status_name(status), diag.line,
                     diag.message, diag.hint);
    }
}

/* Cameras inside a closed mesh see nothing; an open one has no inside. */
static void test_a_camera_inside_a_mesh_is_refused(void **state)
{
    struct neph_scene *scene = NULL;
    struct neph_diag diag = {0};
    assert_int_equal(load(state, BOX ", position_m: [-0.5, 59, 49]" GREY, &scene, &diag),
                     NEPH_ERR_INPUT);
    assert_non_null(strstr(diag.message, "inside a solid"));
    OWNED(scene)
    struct neph_scene *under = load_good(
        state, "  - height_field: {file: hills.exr, min_m: [-9, 61, 40], max_m: [9, 70, 60]" GREY);
    assert_int_equal(under->solid_count, 1);
}

/* --- the hash -------------------------------------------------------------------------------- */

/* It depends on the mesh and its places, and not on the path. */
static void test_every_key_is_in_the_hash(void **state)
{
    static const char *const solids[] = {
        BOX GREY,
        BOX ", up: z" GREY,
        BOX ", position_m: [0, 0, 1]" GREY,
        BOX ", turn_deg: 1" GREY,
        BOX ", scale_m: 2" GREY,
        BOX ", instances: [{position_m: [0, 0, 2]}]" GREY,
        BOX ", instances: [{position_m: [0, 0, 2], turn_deg: 5}]" GREY,
        BOX ", instances: [{position_m: [0, 0, 2], scale: 5}]" GREY,
        BOX ", scatter: {count: 2, x_m: [0, 1], z_m: [0, 1]}" GREY,
        BOX ", scatter: {count: 3, x_m: [0, 1], z_m: [0, 1]}" GREY,
        BOX ", scatter: {count: 2, seed: 1, x_m: [0, 1], z_m: [0, 1]}" GREY,
        BOX ", scatter: {count: 2, x_m: [0, 2], z_m: [0, 1]}" GREY,
        BOX ", scatter: {count: 2, x_m: [0, 1], z_m: [0, 2]}" GREY,
        BOX ", scatter: {count: 2, x_m: [0, 1], z_m: [0, 1], scale: [1, 2]}" GREY,
        BOX ", scatter: {count: 2, x_m: [0, 1], z_m: [0, 1], height_m: 2}" GREY,
        BOX ", motion: {keys: [{frame: 0, move_m: [1, 0, 0]}]}" GREY,
        BOX ", albedo: [0.5, 0.5, 0.6]}\n",
        "  - mesh: {file: hills.obj" GREY,
        FIELD,
        "  - height_field: {file: hills.exr, min_m: [0, 0, 0], max_m: [4, 9, 3]" GREY,
        "  - height_field: {file: hills.png, min_m: [0, 0, 0], max_m: [4, 8, 3]" GREY,
        "  - height_field: {file: hills.exr, shading: smooth, min_m: [0, 0, 0], max_m: [4, 8, "
        "3]" GREY,
        "  - height_field: {file: hills.exr, albedo_texture: corners.png, min_m: [0, 0, 0], "
        "max_m: [4, 8, 3]" GREY,
        "  - height_field: {file: hills.exr, albedo_texture: corners.png, alpha: coverage, min_m: "
        "[0, 0, 0], max_m: [4, 8, 3]" GREY,
    };
    char hashes[COUNT(solids)][NEPH_HASH_HEX_SIZE], path[SCRATCH_PATH_MAX], other[SCRATCH_PATH_MAX];
    for (size_t i = 0; i < COUNT(solids); i++) {
        OWNED(scene) struct neph_scene *scene = load_good(state, solids[i]);
        memcpy(hashes[i], scene->hash, NEPH_HASH_HEX_SIZE);
        for (size_t k = 0; k < i; k++)
            assert_string_not_equal(hashes[i], hashes[k]);
    }
    assert_int_equal(
        rename(scratch_path(state, path, "box.obj"), scratch_path(state, other, "renamed.obj")), 0);
    OWNED(scene) struct neph_scene *renamed = load_good(state, "  - mesh: {file: renamed.obj" GREY);
    assert_string_equal(renamed->hash, hashes[0]);
}

#define files_test(function)                                                                       \
    cmocka_unit_test_setup_teardown(function, files_setup, scratch_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        files_test(test_a_height_field_equals_its_mesh),
        files_test(test_a_png_is_a_height_field),
        files_test(test_a_height_field_is_smooth),
        files_test(test_a_height_field_has_a_texture),
        files_test(test_a_mesh_of_a_box_is_placed),
        files_test(test_instances_equal_copies),
        files_test(test_scattered_instances_stand_on_the_ground),
        files_test(test_keys_move_instances),
        files_test(test_what_is_refused),
        files_test(test_a_camera_inside_a_mesh_is_refused),
        files_test(test_every_key_is_in_the_hash),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
