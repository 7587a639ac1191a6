/* SPDX-License-Identifier: MIT
 *
 * Smooth shading, textures and cut-outs of meshes: closed forms on rays, and their keys in scene
 * files.
 */
#include "tests/base/scratch.h"
#include "tests/mesh_builders.h"

#include "base/png.h"
#include "scenes/motion.h"
#include "scenes/solids.h"
#include "scenes/surfaces.h"

#include <png.h>

static void test_end_scene(struct neph_scene **scene)
{
    neph_scene_destroy(*scene);
}

/* --- textures -------------------------------------------------------------------------------- */

/* 2 x 2: rows from the top. */
static const float four[] = {0.1f, 0.2f, 0.3f, 0.0f,  0.5f, 0.6f, 0.7f, 1.0f,
                             0.9f, 0.8f, 0.7f, 0.25f, 0.0f, 1.0f, 0.5f, 0.75f};

static void test_texels_are_bilinear_and_repeat(void **state)
{
    static const struct {
        double u, v;
        int texel; /* -1: the mean of all */
    } rows[] = {
        {0.25, 0.75, 0},  {0.75, 0.75, 1},  {0.25, 0.25, 2}, {0.75, 0.25, 3},   {1.25, 0.75, 0},
        {-0.25, 0.75, 1}, {0.25, -1.75, 2}, {7.75, 5.25, 3}, {0.5, 0.5, -1},    {0.0, 0.0, -1},
        {1.0, 1.0, -1},   {-3.0, 0.5, -1},  {1e30, 0.5, -1}, {-1e30, 1e30, -1}, {3e38, -3e38, -1},
    };
    struct neph_albedo_texture *texture = make_texture(2, 2, four);
    for (size_t i = 0; i < COUNT(rows); i++) {
        const struct neph_texel found = neph_albedo_texture_find(texture, rows[i].u, rows[i].v);
        const double values[4] = {found.color.r, found.color.g, found.color.b, found.alpha};
        for (int c = 0; c < 4; c++) {
            double expected = 0.0;
            for (int texel = 0; texel < 4; texel++)
                if (rows[i].texel < 0 || rows[i].texel == texel)
                    expected += (double)four[4 * texel + c] / (rows[i].texel < 0 ? 4.0 : 1.0);
            neph_assert_close(values[c], expected, 1e-15, 1e-16); /* roundings of two mixes */
        }
    }
    /* A fifth of the way between two columns. */
    neph_assert_close(neph_albedo_texture_find(texture, 0.35, 0.75).color.r,
                      0.8 * (double)four[0] + 0.2 * (double)four[4], 1e-12, 0.0);
    neph_albedo_texture_destroy(texture);
}

/* --- quads ----------------------------------------------------------------------------------- */

static struct neph_rgb color_at(const struct neph_scene *scene, double x, double y)
{
    const struct neph_vec3 eye = {x, y, 3}, ahead = {0, 0, -1};
    const struct neph_hit hit = neph_scene_hit(scene, eye, ahead);
    assert_non_null(hit.solid);
    return neph_surface_color(&hit, neph_vec3_along(eye, ahead, hit.t_m));
}

static void test_a_texture_of_one_colour_is_an_albedo(void **state)
{
    static const float one[] = {0.3f, 0.7f, 0.9f, 1.0f, 0.3f, 0.7f, 0.9f, 1.0f};
    OWNED(mesh)
    struct neph_mesh *mesh = make_quad(1.0, make_texture(1, 2, one), NEPH_ALPHA_IGNORED);
    struct neph_solid solid = put_mesh(mesh);
    const struct neph_scene scene = {.solid_count = 1, .solids = &solid};
    uint64_t seed = 3;
    solid.albedo = make_grey(1.0);
    for (int i = 0; i < 200; i++) {
        const struct neph_rgb color = color_at(&scene, neph_test_uniform(&seed, 0, 1),
                                               neph_test_uniform(&seed, 0, 1));
        assert_true(color.r == (double)0.3f && color.g == (double)0.7f && color.b == (double)0.9f);
    }
}

static void test_colours_of_two_texels_on_a_quad(void **state)
{
    static const float two[] = {0.0f, 0.2f, 0.4f, 1.0f, 1.0f, 0.6f, 0.8f, 1.0f};
    OWNED(mesh)
    struct neph_mesh *mesh = make_quad(1.0, make_texture(2, 1, two), NEPH_ALPHA_IGNORED);
    struct neph_solid solid = put_mesh(mesh);
    const struct neph_scene scene = {.solid_count = 1, .solids = &solid};
    uint64_t seed = 4;
    for (int i = 0; i < 200; i++) {
        const double x = neph_test_uniform(&seed, 0, 1), y = neph_test_uniform(&seed, 0, 1);
        const double from_first = fabs(x - 0.25) * 2.0; /* of the centres' distance */
        const double part = fmin(from_first, 2.0 - from_first);
        const struct neph_rgb color = color_at(&scene, x, y);
        neph_assert_close(color.r, 0.5 * part, 0.0, 1e-14);
        neph_assert_close(color.g, 0.25 * ((double)0.2f + part * ((double)0.6f - (double)0.2f)),
                          0.0, 1e-14);
    }
}

/* Rays meet, see and are hidden by half of the quad as by a half of its size: alpha is 1/2 exactly
 * at the middle and at the left edge. */
static void test_a_cut_out_quad_is_a_smaller_one(void **state)
{
    OWNED(mesh)
    struct neph_mesh *cut = make_quad(1.0, make_half_texture(1.0f, 0.0f), NEPH_ALPHA_CUTOUT);
    OWNED(mesh) struct neph_mesh *half = make_quad(0.5, NULL, NEPH_ALPHA_IGNORED);
    struct neph_solid solids[2] = {put_mesh(cut), put_mesh(half)};
    struct neph_scene scenes[2];
    uint64_t seed = 5;
    int counts[2] = {0, 0};
    for (int s = 0; s < 2; s++)
        scenes[s] = (struct neph_scene){
            .solid_count = 1, .solids = &solids[s], .sun = {.present = true}};
    for (int i = 0; i < 4000; i++) {
        const struct neph_vec3 at = {neph_test_uniform(&seed, -0.2, 1.2),
                                     neph_test_uniform(&seed, -0.2, 1.2), 0};
        const struct neph_vec3 eye = {neph_test_uniform(&seed, -2, 2),
                                      neph_test_uniform(&seed, -2, 2), i % 2 ? 1.5 : -1.5};
        const struct neph_vec3 far = neph_vec3_along(at, neph_vec3_sub(at, eye), 1.0);
        const struct neph_vec3 d = neph_vec3_normalize(neph_vec3_sub(at, eye));
        if (fabs(at.x) < 1e-9 || fabs(at.x - 0.5) < 1e-9)
            continue;
        struct neph_hit hits[2];
        bool sun[2], seen[2];
        for (int s = 0; s < 2; s++) {
            scenes[s].sun.direction = d;
            hits[s] = neph_scene_hit(&scenes[s], eye, d);
            sun[s] = neph_scene_is_sun_visible(&scenes[s], eye);
            seen[s] = neph_scene_is_visible(&scenes[s], eye, far);
        }
        assert_true(!hits[0].solid == !hits[1].solid && sun[0] == sun[1] && seen[0] == seen[1]);
        assert_true(!hits[0].solid == seen[0] && seen[0] == sun[0]);
        counts[seen[0]]++;
        if (hits[0].solid)
            neph_assert_close(hits[0].t_m, hits[1].t_m, 1e-14, 0.0);
    }
    assert_true(counts[0] > 500 && counts[1] > 500);
}

/* What is behind a hole is met, also of the mesh itself. */
static void test_a_hole_shows_what_is_behind(void **state)
{
    OWNED(mesh)
    struct neph_mesh *cut = make_quad(1.0, make_half_texture(1.0f, 0.0f), NEPH_ALPHA_CUTOUT);
    struct neph_solid solids[2] = {put_mesh(cut), put_mesh(cut)};
    const struct neph_scene scene = {.solid_count = 2, .solids = solids};
    const struct neph_vec3 ahead = {0, 0, -1};
    solids[1].center_m = (struct neph_vec3){0.4, 0, -1};
    assert_ptr_equal(neph_scene_hit(&scene, (struct neph_vec3){0.42, 0.3, 2}, ahead).solid,
                     &solids[0]);
    assert_ptr_equal(neph_scene_hit(&scene, (struct neph_vec3){0.7, 0.3, 2}, ahead).solid,
                     &solids[1]);
    assert_null(neph_scene_hit(&scene, (struct neph_vec3){0.97, 0.3, 2}, ahead).solid);
}

/* A part alpha of rays, and of the rays between two points; each ray has one answer, and rays that
 * differ have answers of their own. */
static void test_coverage_is_the_part_of_rays(void **state)
{
    enum { DRAWS = 40000 };
    static const float alphas[] = {0.0f, 0.125f, 0.75f, 1.0f};
    for (size_t a = 0; a < COUNT(alphas); a++) {
        OWNED(mesh)
        struct neph_mesh *mesh = make_quad(1.0, make_half_texture(alphas[a], alphas[a]),
                                           NEPH_ALPHA_COVERAGE);
        struct neph_solid solid = put_mesh(mesh);
        struct neph_scene scene = {.solid_count = 1, .solids = &solid};
        const struct neph_vec3 eye = {0.3, 0.4, 3}, ahead = {0, 0, -1}, to = {0.3, 0.4, -2};
        int met = 0, hidden = 0, same = 0;
        for (int i = 1; i <= DRAWS; i++) {
            scene.coverage_draw = (uint64_t)i;
            const bool is_met = neph_scene_hit(&scene, eye, ahead).solid;
            assert_true(!neph_scene_hit(&scene, eye, ahead).solid == !is_met);
            assert_true(neph_scene_is_visible(&scene, eye, to) == !is_met); /* one ray */
            const struct neph_vec3 beside = {0.3 + 1e-9, 0.4, 3};
            const bool is_hidden = neph_scene_hit(&scene, beside, ahead).solid;
            met += is_met;
            hidden += is_hidden;
            same += is_met == is_hidden;
        }
        const double alpha = (double)alphas[a], spread = sqrt(alpha * (1.0 - alpha) / DRAWS);
        neph_assert_close((double)met / DRAWS, alpha, 0.0, 5.0 * spread);
        neph_assert_close((double)hidden / DRAWS, alpha, 0.0, 5.0 * spread);
        neph_assert_close((double)same / DRAWS, alpha * alpha + (1 - alpha) * (1 - alpha), 0.0,
                          5.0 * sqrt(0.25 / DRAWS));
        scene.coverage_draw = 0;
        assert_true(!neph_scene_hit(&scene, eye, ahead).solid == (alpha < 0.5));
    }
}

/* --- smooth normals -------------------------------------------------------------------------- */

/* The largest difference between the cosine of a light on a ball and on its mesh, where both the
 * ball and the triangles see it. */
static double find_worst_cosine(const struct neph_mesh *mesh)
{
    struct neph_solid solids[2] = {put_mesh(mesh), make_sphere(0, 0, 0, 1)};
    const struct neph_scene scenes[2] = {{.solid_count = 1, .solids = &solids[0]},
                                         {.solid_count = 1, .solids = &solids[1]}};
    uint64_t seed = 12;
    double worst = 0.0;
    for (int i = 0; i < 2000; i++) {
        const struct neph_vec3 from = neph_vec3_scale(random_direction(&seed), 3.0);
        const struct neph_vec3 d = neph_vec3_normalize(
            neph_vec3_sub(random_point(&seed, 0.5), from));
        const struct neph_vec3 light = random_direction(&seed);
        const struct neph_hit a = neph_scene_hit(&scenes[0], from, d);
        const struct neph_hit b = neph_scene_hit(&scenes[1], from, d);
        assert_true(a.solid && b.solid);
        neph_assert_close(neph_vec3_length(a.shading), 1.0, 1e-14, 0.0);
        assert_true(neph_vec3_dot(a.shading, a.normal) > 0.0);
        const double cosine = neph_hit_cosine(&a, light);
        if (neph_vec3_dot(a.normal, light) <= 0.0)
            assert_true(cosine == 0.0);
        else
            worst = fmax(worst, fabs(cosine - neph_vec3_dot(b.normal, light)));
    }
    return worst;
}

/* Linear interpolation between normals of the ball is off by the square of the triangles' size, and
 * flat normals by the size. */
static void test_a_smooth_ball_becomes_a_sphere(void **state)
{
    double smooth[3], flat[3];
    for (int i = 0; i < 3; i++) {
        OWNED(mesh) struct neph_mesh *mesh = make_ball(16 << i, i + 0.5);
        smooth[i] = find_worst_cosine(mesh);
        mesh->material.is_smooth = false;
        flat[i] = find_worst_cosine(mesh);
        print_message("%d triangles: smooth %.2e, flat %.2e\n", mesh->data.triangle_count,
                      smooth[i], flat[i]);
        assert_true(smooth[i] < 0.2 * flat[i]);
    }
    assert_true(smooth[1] < smooth[0] / 3.0 && smooth[2] < smooth[1] / 3.0); /* 4 by theory */
    assert_true(flat[2] > flat[0] / 8.0);                                    /* 4 by theory */
}

/* Seen from either side, with normals on either side. */
static void test_shading_normals_face_the_ray(void **state)
{
    for (int flipped = 0; flipped < 2; flipped++) {
        struct neph_mesh_data data = allocate_mesh(3, 1);
        data.normals = calloc(3, sizeof(*data.normals));
        assert_non_null(data.normals);
        data.positions[1] = (struct neph_vec3){1, 0, 0};
        data.positions[2] = (struct neph_vec3){0, 1, 0};
        for (int i = 0; i < 3; i++)
            data.normals[i] = (struct neph_vec3){0.6, 0, flipped ? -0.8 : 0.8};
        set_triangle(&data, 0, 0, 1, 2);
        OWNED(mesh) struct neph_mesh *mesh = finish_mesh(data);
        mesh->material.is_smooth = true;
        struct neph_solid solid = put_mesh(mesh);
        const struct neph_scene scene = {.solid_count = 1, .solids = &solid};
        for (int side = -1; side <= 1; side += 2) {
            const struct neph_hit hit = neph_scene_hit(&scene, (struct neph_vec3){0.2, 0.2, side},
                                                       (struct neph_vec3){0, 0, -side});
            const double x = side * (flipped ? -0.6 : 0.6);
            neph_assert_close(hit.shading.x, x, 1e-15, 0.0);
            neph_assert_close(hit.shading.z, side * 0.8, 1e-15, 0.0);
            const struct neph_vec3 behind = neph_vec3_normalize(
                (struct neph_vec3){x > 0 ? 1 : -1, 0, -0.1 * side});
            assert_true(neph_vec3_dot(behind, hit.shading) > 0.3); /* but from behind */
            assert_true(neph_hit_cosine(&hit, behind) == 0.0);
        }
    }
}

/* --- scene files ----------------------------------------------------------------------------- */

static void write_text(void **state, const char *name, const char *text)
{
    char path[SCRATCH_PATH_MAX];
    scratch_write(scratch_path(state, path, name), text, strlen(text));
}

/* A PNG by libpng, whose simplified interface takes 8 bits as they are. */
static void write_png(void **state, const char *name, int width, int height, const uint8_t *bytes,
                      png_uint_32 format)
{
    char path[SCRATCH_PATH_MAX];
    png_image image = {.version = PNG_IMAGE_VERSION,
                       .width = (png_uint_32)width,
                       .height = (png_uint_32)height,
                       .format = format};
    assert_true(
        png_image_write_to_file(&image, scratch_path(state, path, name), 0, bytes, 0, NULL));
}

#define QUAD                                                                                       \
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\nvn 1 0 1\n"

static int files_setup(void **state)
{
    static const uint8_t leaf[] = {255, 0, 188, 255, 255, 0, 188, 0};
    static const uint8_t plain[] = {188, 188, 188};
    char path[SCRATCH_PATH_MAX], link_path[SCRATCH_PATH_MAX];
    if (scratch_setup(state) != 0)
        return -1;
    write_text(state, "quad.obj", QUAD "f 1/1/1 2/2/2 3/3/2 4/4/1\n");
    write_text(state, "bare.obj", QUAD "f 1 2 3 4\n");
    write_text(state, "text.png", "no image");
    write_png(state, "leaf.png", 2, 1, leaf, PNG_FORMAT_RGBA);
    write_png(state, "plain.png", 1, 1, plain, PNG_FORMAT_RGB);
    assert_int_equal(symlink("/etc/hostname", scratch_path(state, path, "link.png")), 0);
    assert_int_equal(
        symlink(scratch_path(state, path, "leaf.png"), scratch_path(state, link_path, "own.png")),
        0);
    return 0;
}

/* The mesh is on line 6. */
static enum neph_status load(void **state, const char *keys, struct neph_scene **scene,
                             struct neph_diag *diag)
{
    static const char head[] =
        "name: probe\ntitle: a probe\n"
        "camera: {position_m: [0.2, 0.3, 5], look_at_m: [0.2, 0.3, 0], vertical_fov_deg: 40}\n"
        "scattering: none\n"
        "solids:\n  - mesh: {file: ";
    char path[SCRATCH_PATH_MAX];
    char *text = neph_format("%s%s, albedo: [0.5, 0.5, 1]}\n", head, keys);
    scratch_write(scratch_path(state, path, "probe.yaml"), text, strlen(text));
    free(text);
    *scene = NULL;
    return neph_scene_load(path, scene, diag);
}

static struct neph_scene *load_good(void **state, const char *keys)
{
    struct neph_scene *scene = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(load(state, keys, &scene, &diag), &diag);
    return scene;
}

/* IEC 61966-2-1. */
static double decode(double code)
{
    return pow((code / 255.0 + 0.055) / 1.055, 2.4);
}

static void test_keys_of_a_material(void **state)
{
    OWNED(scene)
    struct neph_scene *scene = load_good(
        state, "quad.obj, shading: smooth, albedo_texture: leaf.png, alpha: cutout");
    const struct neph_vec3 ahead = {0, 0, -1};
    const struct neph_hit hit = neph_scene_hit(scene, (struct neph_vec3){0.25, 0.5, 3}, ahead);
    assert_non_null(hit.solid);
    neph_assert_close(hit.shading.x,
                      0.25 * sqrt(0.5) / hypot(0.25 * sqrt(0.5), 0.75 + 0.25 * sqrt(0.5)), 1e-6,
                      0.0); /* normals of the file are float32 */
    const struct neph_rgb color = neph_surface_color(&hit, (struct neph_vec3){0.25, 0.5, 0});
    assert_true(color.r == 0.5 && color.g == 0.0);
    neph_assert_close(color.b, decode(188.0), 1e-7, 0.0); /* float32 */
    assert_null(neph_scene_hit(scene, (struct neph_vec3){0.75, 0.5, 3}, ahead).solid);
    assert_int_equal(scene->meshes[0]->inside, NEPH_MESH_OPEN);
    assert_int_equal(neph_scene_mesh_looks(scene),
                     NEPH_LOOK_SMOOTH | NEPH_LOOK_TEXTURE | NEPH_LOOK_CUTOUT);
    OWNED(scene) struct neph_scene *linked = load_good(state, "quad.obj, albedo_texture: own.png");
    assert_non_null(neph_scene_hit(linked, (struct neph_vec3){0.75, 0.5, 3}, ahead).solid);
    assert_null(neph_surfaces_obstacle(scene));
    OWNED(scene) struct neph_scene *plain = load_good(state, "quad.obj, shading: flat");
    assert_int_equal(neph_scene_mesh_looks(plain), 0);
    OWNED(scene)
    struct neph_scene *covered = load_good(state,
                                           "quad.obj, albedo_texture: leaf.png, alpha: coverage");
    assert_non_null(strstr(neph_coverage_obstacle(covered), "alpha as coverage"));
    assert_null(neph_surfaces_obstacle(covered));
}

static void test_what_is_refused(void **state)
{
    static const struct {
        const char *keys, *words;
    } rows[] = {
        {"bare.obj, shading: smooth", "no normals"},
        {"bare.obj, albedo_texture: leaf.png", "no uv"},
        {"quad.obj, shading: round", "round"},
        {"quad.obj, alpha: cutout", "albedo_texture"},
        {"quad.obj, albedo_texture: plain.png, alpha: cutout", "opaque everywhere"},
        {"quad.obj, albedo_texture: none.png", "none.png"},
        {"quad.obj, albedo_texture: text.png", "is not a PNG"},
        {"quad.obj, albedo_texture: .", "."},
        {"quad.obj, albedo_texture: /etc/hostname", "outside the folder"},
        {"quad.obj, albedo_texture: ../../etc/hostname", "outside the folder"},
        {"quad.obj, albedo_texture: link.png", "outside the folder"},
        {"quad.obj, albedo_texture: wide.png, memory_limit_mib: 1", "the limit is 1 MiB"},
    };
    OWNED(memory) uint8_t *wide = calloc(600 * 200, 3);
    write_png(state, "wide.png", 600, 200, wide, PNG_FORMAT_RGB);
    for (size_t i = 0; i < COUNT(rows); i++) {
        struct neph_scene *scene = NULL;
        struct neph_diag diag = {0};
        const enum neph_status status = load(state, rows[i].keys, &scene, &diag);
        if (!status || diag.line != 6 ||
            (!strstr(diag.message, rows[i].words) && !strstr(diag.hint, rows[i].words)))
            fail_msg("%s: %s, line %d: %s; %s", rows[i].keys, neph_status_name(status), diag.line,
                     diag.message, diag.hint);
        print_message("%s; %s\n", diag.message, diag.hint);
    }
}

static void test_materials_are_in_the_hash(void **state)
{
    static const char *const keys[] = {
        "quad.obj",
        "quad.obj, albedo_texture: leaf.png, alpha: coverage",
        "quad.obj, shading: smooth",
        "quad.obj, albedo_texture: leaf.png",
        "quad.obj, albedo_texture: plain.png",
        "quad.obj, albedo_texture: leaf.png, alpha: cutout",
    };
    char hashes[COUNT(keys)][NEPH_HASH_HEX_SIZE];
    for (size_t i = 0; i < COUNT(keys); i++) {
        OWNED(scene) struct neph_scene *scene = load_good(state, keys[i]);
        memcpy(hashes[i], scene->hash, NEPH_HASH_HEX_SIZE);
        for (size_t k = 0; k < i; k++)
            assert_string_not_equal(hashes[i], hashes[k]);
    }
    OWNED(scene) struct neph_scene *linked = load_good(state, "quad.obj, albedo_texture: own.png");
    assert_string_equal(linked->hash, hashes[3]);
}

#define files_test(function)                                                                       \
    cmocka_unit_test_setup_teardown(function, files_setup, scratch_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_texels_are_bilinear_and_repeat),
        cmocka_unit_test(test_a_texture_of_one_colour_is_an_albedo),
        cmocka_unit_test(test_colours_of_two_texels_on_a_quad),
        cmocka_unit_test(test_a_cut_out_quad_is_a_smaller_one),
        cmocka_unit_test(test_a_hole_shows_what_is_behind),
        cmocka_unit_test(test_coverage_is_the_part_of_rays),
        cmocka_unit_test(test_a_smooth_ball_becomes_a_sphere),
        cmocka_unit_test(test_shading_normals_face_the_ray),
        files_test(test_keys_of_a_material),
        files_test(test_what_is_refused),
        files_test(test_materials_are_in_the_hash),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
