/* SPDX-License-Identifier: MIT
 *
 * Meshes in Cycles and POV-Ray: the input of these programs, and, where they are installed, frames
 * of boxes as meshes against the same boxes as boxes.
 */
#include "tests/harness/engine_test.h"
#include "tests/mesh_builders.h"

#include "harness/engines/cycles_mesh.h"
#include "harness/engines/engines.h"
#include "harness/engines/povray_mesh.h"
#include "scenes/mesh_place.h"

#include <math.h>
#include <stdlib.h>
#include <unistd.h>

enum { WIDTH = 48, HEIGHT = 27, PIXELS = WIDTH * HEIGHT, GROUND = 0, TILTED, TURNED };

static const double tilt_rad = 0.3, yaw_rad = 0.5;

struct meshes {
    struct test_scene stage;
    struct neph_mesh *mesh, *ground;
    struct neph_mesh *list[2];
};

static struct neph_turn make_turn(int axis, double angle_rad)
{
    return (struct neph_turn){axis, cos(angle_rad), sin(angle_rad)};
}

static struct neph_bounds bounds_around(struct neph_vec3 middle_m, struct neph_vec3 half_m)
{
    return (struct neph_bounds){neph_vec3_sub(middle_m, half_m), neph_vec3_add(middle_m, half_m)};
}

/* A ground and two boxes of 1 x 1.6 x 1.2 m in thin fog, the first tilted to its side. */
static void set_boxes(struct test_scene *stage)
{
    const struct neph_vec3 half_m = {0.5, 0.8, 0.6};
    test_stage(stage, (struct neph_vec3){0.3, 1.7, 6}, (struct neph_vec3){0, 0.8, 0});
    stage->scene.sun.irradiance_w_per_m2 = (struct neph_rgb){2, 1, 4};
    struct neph_medium *fog = test_add_medium(stage, 0.06, 0.0, 0.0);
    fog->bounds = (struct neph_bounds){{-8, -1, -9}, {8, 4, 7}};
    test_add_box(stage, (struct neph_vec3){-20, -2, -20}, (struct neph_vec3){20, 0, 8});
    for (int i = 0; i < 2; i++)
        test_add_box(stage, (struct neph_vec3){0}, (struct neph_vec3){0});
    stage->solids[TILTED].box = bounds_around((struct neph_vec3){-1.0, 1.1, -0.4}, half_m);
    stage->solids[TILTED].turn = make_turn(2, tilt_rad);
    stage->solids[TURNED].box = bounds_around((struct neph_vec3){0.9, 0.9, -0.4}, half_m);
    stage->solids[TURNED].turn = make_turn(1, yaw_rad);
    stage->solids[TURNED].albedo = (struct neph_rgb){0.8, 0.4, 0.2};
}

static void place(struct neph_solid *solid, struct neph_mesh *mesh, double scale_m, double yaw,
                  double tilt)
{
    solid->kind = NEPH_SOLID_MESH;
    solid->mesh = mesh;
    solid->center_m = neph_vec3_scale(neph_vec3_add(solid->box.min_m, solid->box.max_m), 0.5);
    solid->scale_m = scale_m;
    solid->yaw = make_turn(1, yaw);
    solid->turn = tilt != 0.0 ? make_turn(2, tilt) : (struct neph_turn){0};
}

/* set_boxes() with meshes in place of boxes: one for the ground; one for the two boxes, half as
 * large as they are and turned by 90 degrees. */
static void set_meshes(struct meshes *meshes)
{
    struct test_scene *stage = &meshes->stage;
    set_boxes(stage);
    meshes->mesh = make_box_mesh((struct neph_vec3){-0.3, -0.4, -0.25},
                                 (struct neph_vec3){0.3, 0.4, 0.25});
    meshes->ground = make_box_mesh((struct neph_vec3){-20, -1, -14}, (struct neph_vec3){20, 1, 14});
    meshes->list[0] = meshes->ground;
    meshes->list[1] = meshes->mesh;
    stage->scene.meshes = meshes->list;
    stage->scene.mesh_count = 2;
    place(&stage->solids[GROUND], meshes->ground, 1.0, 0.0, 0.0);
    place(&stage->solids[TILTED], meshes->mesh, 2.0, M_PI / 2.0, tilt_rad);
    place(&stage->solids[TURNED], meshes->mesh, 2.0, M_PI / 2.0 + yaw_rad, 0.0);
}

static void finish_meshes(struct meshes *meshes)
{
    neph_mesh_destroy(meshes->mesh);
    neph_mesh_destroy(meshes->ground);
}

/* ---- without the programs -------------------------------------------------------------------- */

static void test_axes_of_a_mesh(void **state)
{
    struct neph_solid solid = {.kind = NEPH_SOLID_MESH};
    struct neph_vec3 axes[3];
    neph_mesh_axes(&solid, axes);
    assert_true(axes[0].x == 1.0 && axes[1].y == 1.0 && axes[2].z == 1.0);
    solid.yaw = (struct neph_turn){1, 0.0, 1.0};  /* x to -z, z to x */
    solid.turn = (struct neph_turn){2, 0.0, 1.0}; /* then x to y, y to -x */
    neph_mesh_axes(&solid, axes);
    assert_true(axes[0].z == -1.0 && axes[1].x == -1.0 && axes[2].y == 1.0);
}

static char *read_file(const char *folder, const char *name, size_t *size)
{
    char *path = neph_path_join(folder, name), *text = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_file_read(path, 1 << 20, &text, size, &diag), &diag);
    free(path);
    return text;
}

static void test_files_of_meshes(void **state)
{
    struct meshes meshes;
    struct neph_diag diag = {0};
    size_t size = 0;
    char folder[] = "/tmp/neph-test-XXXXXX";
    assert_non_null(mkdtemp(folder));
    set_meshes(&meshes);
    const struct neph_scene *scene = &meshes.stage.scene;
    neph_assert_ok(neph_cycles_write_meshes(scene, folder, &diag), &diag);
    char *bytes = read_file(folder, "mesh2.bin", &size);
    float first[3];
    memcpy(first, bytes, sizeof(first));
    assert_int_equal(size, 8 * 12 + 12 * 12);
    assert_true(first[0] == -0.3f && first[1] == 0.25f && first[2] == -0.4f);
    free(bytes);

    json_t *json = neph_cycles_mesh(scene, &scene->solids[TILTED]);
    assert_string_equal(neph_json_text(json, "file"), "mesh2.bin");
    json_decref(json);

    const struct neph_povray_world world = {.scene = scene, .units_per_m = 100.0};
    neph_assert_ok(neph_povray_put_meshes(&world, folder, &diag), &diag);
    char *text = read_file(folder, "mesh2.inc", &size);
    assert_non_null(strstr(text, "#declare Mesh2 = mesh2 {\nvertex_vectors { 8,\n<-60,-80,-50>"));
    assert_non_null(strstr(text, "face_indices { 12,\n<"));
    free(text);
    neph_dir_remove(folder, NULL);
    finish_meshes(&meshes);
}

/* ---- frames ---------------------------------------------------------------------------------- */

static struct neph_image *render(const struct neph_engine *engine, const struct test_scene *stage,
                                 const char *assignment)
{
    struct neph_diag diag = {0};
    struct neph_cost cost = {0};
    struct neph_image *frame = NULL;
    struct neph_shot shot = {.scene = &stage->scene,
                             .settings = neph_settings_default(engine),
                             .width_px = WIDTH,
                             .height_px = HEIGHT,
                             .layers = NEPH_LAYERS_ALL,
                             .seed = 1,
                             .time_limit_s = 120.0};
    if (assignment)
        neph_assert_ok(neph_settings_set(engine, &shot.settings, assignment, &diag), &diag);
    neph_assert_ok(test_render(engine, &shot, &frame, &cost, &diag), &diag);
    return frame;
}

static void render_both(const struct neph_engine *engine, const char *assignment,
                        struct neph_image *frames[2])
{
    struct meshes meshes;
    struct test_scene boxes;
    set_boxes(&boxes);
    set_meshes(&meshes);
    frames[0] = render(engine, &boxes, assignment);
    frames[1] = render(engine, &meshes.stage, assignment);
    finish_meshes(&meshes);
}

/* The number of pixels whose values differ by more than this part of the larger one. */
static int count_others(struct neph_image *const frames[2], const char *channel, double relative)
{
    const float *a = neph_image_channel(frames[0], channel),
                *b = neph_image_channel(frames[1], channel);
    int others = 0;
    double largest = 0.0;
    assert_true(a && b);
    for (int p = 0; p < PIXELS; p++) {
        const double larger = fmax(fabs((double)a[p]), fabs((double)b[p]));
        const double off = a[p] == b[p] ? 0.0 : fabs((double)a[p] - (double)b[p]) / larger;
        others += !(off <= relative);
        largest = off <= relative ? fmax(largest, off) : largest;
    }
    print_message("  %s: %d others; the rest within %.1e\n", channel, others, largest);
    return others;
}

static double mean_value(const struct neph_image *frame, const char *channel)
{
    const float *values = neph_image_channel(frame, channel);
    double sum = 0.0;
    assert_non_null(values);
    for (int p = 0; p < PIXELS; p++)
        sum += (double)values[p];
    return sum / PIXELS;
}

/* POV-Ray keeps the vertices of a mesh in float32. 1e-4: a quantum of its 16-bit images. A ray at
 * an edge may pass it. */
static void test_boxes_as_meshes_in_povray(void **state)
{
    struct neph_image *frames[2];
    if (!test_has_engine(&neph_engine_povray))
        return;
    render_both(&neph_engine_povray, "intervals=30", frames);
    assert_true(count_others(frames, "Z", 2e-7) <= 3);
    assert_true(count_others(frames, "transmittance.R", 1e-4) <= 3);
    assert_true(count_others(frames, "R", 1e-4) <= 3);
    assert_true(count_others(frames, "volume.B", 1e-4) <= 3);
    neph_image_destroy(frames[0]);
    neph_image_destroy(frames[1]);
}

/* The same seed, so only rays that pass an edge differ: each changes a mean by less than 1e-3. */
static void test_boxes_as_meshes_in_cycles(void **state)
{
    struct neph_image *frames[2];
    if (!test_has_engine(&neph_engine_cycles))
        return;
    render_both(&neph_engine_cycles, "samples=32", frames);
    assert_true(count_others(frames, "Z", 1e-5) <= 3);
    assert_true(count_others(frames, "transmittance.R", 1e-4) <= 3);
    neph_assert_close(mean_value(frames[1], "R"), mean_value(frames[0], "R"), 2e-3, 0.0);
    neph_assert_close(mean_value(frames[1], "volume.B"), mean_value(frames[0], "volume.B"), 2e-3,
                      0.0);
    assert_true(count_others(frames, "R", 1e-3) <= 10);
    neph_image_destroy(frames[0]);
    neph_image_destroy(frames[1]);
}

/* ---- looks ----------------------------------------------------------------------------------- */

enum { LOOKS_GROUND, BALL, QUAD, LOOKS };

/* A smooth ball and a textured quad with holes, over a ground, sunlit, in a thin fog that scatters
 * no light. The quad's normals are equal, and not its plane's. */
struct looks {
    struct test_scene stage;
    struct neph_mesh *list[2];
};

/* 8 x 6 colours, with holes in columns. */
static struct neph_albedo_texture *make_colours(void)
{
    enum { COLUMNS = 8, ROWS = 6 };
    float rgba[COLUMNS * ROWS * 4];
    for (int i = 0; i < COLUMNS * ROWS; i++) {
        const int x = i % COLUMNS, y = i / COLUMNS;
        rgba[4 * i] = 0.2f + 0.1f * (float)x;
        rgba[4 * i + 1] = 0.9f - 0.15f * (float)y;
        rgba[4 * i + 2] = (x + y) % 2 ? 0.9f : 0.1f;
        rgba[4 * i + 3] = x % 4 < 2 ? 1.0f : 0.2f;
    }
    return make_texture(COLUMNS, ROWS, rgba);
}

static void tilt_normals(struct neph_mesh *mesh)
{
    mesh->material.is_smooth = true;
    mesh->data.normals = calloc((size_t)mesh->data.vertex_count, sizeof(*mesh->data.normals));
    assert_non_null(mesh->data.normals);
    for (int i = 0; i < mesh->data.vertex_count; i++)
        mesh->data.normals[i] = neph_vec3_normalize((struct neph_vec3){0.3, 0.4, 1.0});
}

static void set_looks(struct looks *looks)
{
    struct test_scene *stage = &looks->stage;
    test_stage(stage, (struct neph_vec3){0.3, 1.7, 6}, (struct neph_vec3){0, 0.8, 0});
    stage->scene.scattering = NEPH_SCATTERING_NONE;
    stage->scene.background_w_per_m2_sr = (struct neph_rgb){0.1, 0.2, 0.3};
    test_add_medium(stage, 0.06, 0.0, 0.0)->bounds = (struct neph_bounds){{-8, -1, -9}, {8, 4, 7}};
    looks->list[0] = make_ball(24, 3.0);
    looks->list[1] = make_quad(1.0, make_colours(), NEPH_ALPHA_CUTOUT);
    tilt_normals(looks->list[1]);
    stage->scene.meshes = looks->list;
    stage->scene.mesh_count = 2;
    test_add_box(stage, (struct neph_vec3){-20, -2, -20}, (struct neph_vec3){20, 0, 8});
    for (int i = 0; i < 2; i++) {
        test_add_box(stage, (struct neph_vec3){0}, (struct neph_vec3){0});
        stage->solids[BALL + i] = put_mesh(looks->list[i]);
    }
    stage->solids[BALL].center_m = (struct neph_vec3){-1.1, 1.0, -0.5};
    stage->solids[QUAD].center_m = (struct neph_vec3){0.2, 0.1, 0};
    stage->solids[QUAD].scale_m = 1.5;
    stage->solids[QUAD].yaw = make_turn(1, 0.3);
    stage->solids[QUAD].albedo = (struct neph_rgb){0.9, 0.8, 0.7};
}

static void render_looks(const struct neph_engine *engine, const char *assignment,
                         struct neph_image *frames[2])
{
    struct looks looks;
    set_looks(&looks);
    frames[0] = render(&neph_engine_exact, &looks.stage, NULL);
    frames[1] = render(engine, &looks.stage, assignment);
    for (int i = 0; i < 2; i++)
        neph_mesh_destroy(looks.list[i]);
}

/* 1e-3: float32 normals and quanta of 16 bits in the image and in its texture. A ray at an edge or
 * at the edge of a hole may pass it. */
static void test_looks_in_povray(void **state)
{
    struct neph_image *frames[2];
    if (!test_has_engine(&neph_engine_povray))
        return;
    render_looks(&neph_engine_povray, "intervals=30", frames);
    assert_true(count_others(frames, "Z", 2e-7) <= 8);
    assert_true(count_others(frames, "transmittance.R", 1e-3) <= 8);
    assert_true(count_others(frames, "R", 1e-3) <= 8);
    assert_true(count_others(frames, "G", 1e-3) <= 8);
    assert_true(count_others(frames, "B", 1e-3) <= 8);
    neph_image_destroy(frames[0]);
    neph_image_destroy(frames[1]);
}

static void test_looks_in_cycles(void **state)
{
    struct neph_image *frames[2];
    if (!test_has_engine(&neph_engine_cycles))
        return;
    render_looks(&neph_engine_cycles, "samples=16", frames);
    assert_true(count_others(frames, "Z", 1e-5) <= 8);
    assert_true(count_others(frames, "transmittance.R", 1e-3) <= 8);
    assert_true(count_others(frames, "R", 1e-3) <= 8);
    assert_true(count_others(frames, "G", 1e-3) <= 8);
    assert_true(count_others(frames, "B", 1e-3) <= 8);
    neph_image_destroy(frames[0]);
    neph_image_destroy(frames[1]);
}

/* The mean of a part of the frame that the quad and its shadow fill. */
static double mean_of_quad(const struct neph_image *frame, const char *channel)
{
    const float *values = neph_image_channel(frame, channel);
    double sum = 0.0;
    int count = 0;
    for (int p = 0; p < PIXELS; p++)
        if (p % WIDTH >= 22 && p % WIDTH < 38 && p / WIDTH >= 6 && p / WIDTH < 22) {
            sum += (double)values[p];
            count++;
        }
    return sum / count;
}

/* Alpha as coverage, in fog that scatters once, against the oracle. 5e-3: noise of the oracle and
 * of Cycles, steps of POV-Ray through the fog; the differences found were below 1e-3. */
static void test_coverage(void **state)
{
    static const struct {
        const struct neph_engine *engine;
        const char *assignment;
    } rows[] = {{&neph_engine_povray, "intervals=30"}, {&neph_engine_cycles, "samples=128"}};
    struct looks looks;
    set_looks(&looks);
    looks.list[1]->material.alpha = NEPH_ALPHA_COVERAGE;
    looks.stage.scene.scattering = NEPH_SCATTERING_SINGLE;
    looks.stage.scene.media[0].albedo = make_grey(0.9);
    struct neph_image *truth = render(&neph_engine_oracle, &looks.stage, "samples=1024");
    for (size_t i = 0; i < COUNT(rows); i++) {
        if (!test_has_engine(rows[i].engine))
            continue;
        struct neph_image *frame = render(rows[i].engine, &looks.stage, rows[i].assignment);
        for (int c = 0; c < 3; c++) {
            const char *channel = (const char *[]){"R", "G", "B"}[c];
            const double got = mean_of_quad(frame, channel), own = mean_of_quad(truth, channel);
            print_message("  %s: %s %.5f, oracle %.5f\n", channel, rows[i].engine->name, got, own);
            neph_assert_close(got, own, 5e-3, 0.0);
        }
        neph_image_destroy(frame);
    }
    neph_image_destroy(truth);
    for (int i = 0; i < 2; i++)
        neph_mesh_destroy(looks.list[i]);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_axes_of_a_mesh),
        cmocka_unit_test(test_files_of_meshes),
    };
    const struct CMUnitTest engine_tests[] = {
        cmocka_unit_test(test_boxes_as_meshes_in_povray),
        cmocka_unit_test(test_boxes_as_meshes_in_cycles),
        cmocka_unit_test(test_looks_in_povray),
        cmocka_unit_test(test_looks_in_cycles),
        cmocka_unit_test(test_coverage),
    };
    if (neph_test_wants_engines(argc, argv))
        return cmocka_run_group_tests(engine_tests, NULL, NULL);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
