/* SPDX-License-Identifier: MIT
 *
 * Media that external renderers have no formula for, exported as voxels, and media with coloured
 * extinction: frames against exact transport. A grid is exported unchanged: an offset of half a
 * voxel, a swapped axis or a clipped boundary layer would be fully visible. The error of a baked
 * medium is at most the error that the bake reports.
 */
#include "tests/harness/engine_test.h"

#include "base/files.h"
#include "harness/engines/baked_scene.h"
#include "harness/engines/bakes.h"
#include "harness/engines/engines.h"
#include "scenes/grid.h"
#include "scenes/media.h"
#include "truth/transport.h"

#include <stdlib.h>
#include <unistd.h>

enum { WIDTH = 32, HEIGHT = 18, PIXELS = WIDTH * HEIGHT };
enum { CYCLES, POVRAY, ENGINES };

static const struct neph_engine *const engines[ENGINES] = {
    [CYCLES] = &neph_engine_cycles,
    [POVRAY] = &neph_engine_povray,
};

/* Noise of the mean of 64 paths per pixel, or of none. */
static const double noise[ENGINES] = {3e-3, 0.0};
/* Error of transmittance: jitter of 1/160 of a step; 200 midpoints through a few large cells. */
static const double march_error[ENGINES] = {1e-4, 2e-4};

static struct neph_scene *load(const char *name)
{
    struct neph_diag diag = {0};
    struct neph_scene *scene = NULL;
    char *path = neph_format("%s/scenes/catalog/%s.yaml", NEPH_SOURCE_DIR, name);
    neph_assert_ok(neph_scene_load(path, &scene, &diag), &diag);
    free(path);
    return scene;
}

/* The catalogue's few large cells, stretched so that the axes differ. */
static struct neph_scene *load_voxels(void)
{
    struct neph_scene *scene = load("voxel_grid");
    struct neph_diag diag = {0};
    neph_assert_ok(neph_grid_place(scene->media[0].grid, (struct neph_vec3){-0.8, 0.2, -1.3},
                                   (struct neph_vec3){0.5, 0.7, 0.6}, &diag),
                   &diag);
    return scene;
}

static enum neph_status try_render(int e, const struct neph_scene *scene, unsigned layers,
                                   int resolution, struct neph_image **frame,
                                   struct neph_diag *diag)
{
    char scratch[] = "/tmp/neph test '$(touch x)' XXXXXX";
    struct neph_cost cost;
    struct neph_shot shot = {.scene = scene,
                             .settings = neph_settings_default(engines[e]),
                             .width_px = WIDTH,
                             .height_px = HEIGHT,
                             .layers = layers,
                             .seed = 1,
                             .scratch_directory = scratch,
                             .time_limit_s = 120.0};
    char *assignment = neph_format("bake_resolution=%d", resolution);
    neph_assert_ok(neph_settings_set(engines[e], &shot.settings, assignment, diag), diag);
    free(assignment);
    assert_non_null(mkdtemp(scratch));
    const enum neph_status status = engines[e]->render(&shot, frame, &cost, diag);
    neph_dir_remove(scratch, NULL);
    return status;
}

static struct neph_image *render(int e, const struct neph_scene *scene, unsigned layers,
                                 int resolution)
{
    struct neph_diag diag = {0};
    struct neph_image *frame = NULL;
    neph_assert_ok(try_render(e, scene, layers, resolution, &frame, &diag), &diag);
    return frame;
}

static struct neph_ray_light truth_of(const struct neph_scene *scene, int pixel)
{
    const struct neph_camera camera = neph_scene_camera(scene, 0.0);
    const struct neph_vec3 ray =
        neph_camera_ray(&camera, WIDTH, HEIGHT, pixel % WIDTH, pixel / WIDTH).direction;
    return neph_transport_ray(scene, camera.position_m, ray);
}

/* Differences of a frame, from one pass over the truth of each pixel. */
struct difference {
    double transmittance; /* the largest of all pixels and channels */
    double volume[3];     /* relative, of the in-scattered light of the whole image */
};

static struct difference compare(const struct neph_scene *scene, const struct neph_image *frame)
{
    struct difference off = {0};
    float *transmittance[3], *volume[3];
    double sum[3] = {0}, truth_sum[3] = {0};
    assert_true(neph_image_rgb(frame, "transmittance", transmittance));
    const bool lit = neph_image_rgb(frame, "volume", volume);
    for (int i = 0; i < PIXELS; i++) {
        const struct neph_ray_light truth = truth_of(scene, i);
        const double t[3] = {truth.transmittance.r, truth.transmittance.g, truth.transmittance.b};
        const double v[3] = {truth.volume.r, truth.volume.g, truth.volume.b};
        for (int c = 0; c < 3; c++) {
            off.transmittance = fmax(off.transmittance, fabs((double)transmittance[c][i] - t[c]));
            truth_sum[c] += v[c];
            sum[c] += lit ? (double)volume[c][i] : NAN;
        }
    }
    for (int c = 0; c < 3; c++)
        off.volume[c] = sum[c] / truth_sum[c] - 1.0;
    print_message("  off by: transmittance %.2e, volume %+.2e %+.2e %+.2e\n", off.transmittance,
                  off.volume[0], off.volume[1], off.volume[2]);
    return off;
}

static void assert_scattering(const struct difference *off, double relative)
{
    for (int c = 0; c < 3; c++)
        assert_true(fabs(off->volume[c]) <= relative); /* NaN fails */
}

static double baked_error(const struct neph_image *frame)
{
    struct neph_bakes_summary bakes;
    assert_true(neph_bakes_of_frame(frame, &bakes));
    return bakes.worst.transmittance_max;
}

/* ---- grids ----------------------------------------------------------------------------------- */

/* Step bias of the defaults: 4e-4 of radiance by the study, in cells of this thickness. */
static void check_grid(int e)
{
    struct neph_scene *scene = load_voxels();
    scene->media[0].extinction_color = (struct neph_rgb){0.5, 1.0, 0.25};
    struct neph_image *frame = render(e, scene, NEPH_LAYER_RADIANCE | NEPH_LAYER_TRANSMITTANCE, 0);
    const struct difference off = compare(scene, frame);
    assert_true(off.transmittance < march_error[e]);
    assert_scattering(&off, 1e-3 + noise[e]);
    assert_float_equal(baked_error(frame), 0.0, 0.0); /* nothing was baked */
    neph_image_destroy(frame);
    neph_scene_destroy(scene);
}

/* From inside, cut by bounds: the grid is no longer complete, so it is baked. */
static void check_cut_grid(int e)
{
    struct neph_scene *scene = load_voxels();
    scene->camera_keys[0].position_m = (struct neph_vec3){0.1, 0.9, 0.2};
    scene->camera_keys[0].look_at_m = (struct neph_vec3){0.0, 1.0, -0.5};
    scene->media[0].bounds.max_m.x = 0.6;
    scene->scattering = NEPH_SCATTERING_NONE; /* only transmittance is compared */
    struct neph_image *frame = render(e, scene, NEPH_LAYER_TRANSMITTANCE, 32);
    assert_true(compare(scene, frame).transmittance < 1.25 * baked_error(frame) + march_error[e]);
    neph_image_destroy(frame);
    neph_scene_destroy(scene);
}

/* ---- baked media ----------------------------------------------------------------------------- */

/* Twice the nodes, a quarter of the error. The error is at most 1.25 times the reported one: both
 * are maxima over some thousand lines. */
static void check_blob(int e)
{
    struct neph_scene *scene = load("gaussian_blob");
    scene->scattering = NEPH_SCATTERING_NONE;
    double errors[2];
    for (int i = 0; i < 2; i++) {
        struct neph_image *frame = render(e, scene, NEPH_LAYER_TRANSMITTANCE, 24 << i);
        errors[i] = compare(scene, frame).transmittance;
        assert_true(errors[i] < 1.25 * baked_error(frame) + march_error[e]);
        neph_image_destroy(frame);
    }
    assert_true(errors[1] < 0.35 * errors[0]);
    neph_scene_destroy(scene);
}

/* A grid, a blob and a fog overlap; with different phase functions where supported. */
static void check_mixture(int e)
{
    struct neph_scene *scene = load_voxels(), *blob = load("gaussian_blob");
    if (e == CYCLES)
        scene->media[0].phase = blob->media[0].phase;
    scene->media[1] = blob->media[0];
    scene->media[1].extinction_per_m = 0.5;
    scene->media[2] = (struct neph_medium){.kind = NEPH_MEDIUM_HEIGHT_FOG,
                                           .bounds = {{-4, -0.5, -4}, {4, 3, 4}},
                                           .extinction_color = {1, 1, 1},
                                           .albedo = {0.5, 0.5, 0.5},
                                           .phase = scene->media[0].phase,
                                           .layer_count = 1,
                                           .layers = {{0.1, 0.5, 0.0}}};
    scene->medium_count = 3;
    struct neph_image *frame = render(e, scene, NEPH_LAYER_RADIANCE | NEPH_LAYER_TRANSMITTANCE, 32);
    const double baked = baked_error(frame);
    const struct difference off = compare(scene, frame);
    assert_true(off.transmittance < baked + 5.0 * march_error[e]);
    assert_scattering(&off, 2.0 * baked + 1e-3 + noise[e]);
    neph_image_destroy(frame);
    scene->medium_count = 1;
    neph_scene_destroy(scene);
    neph_scene_destroy(blob);
}

/* Cycles does not support three extinctions at a time in heterogeneous media
 * (scripts/blender_render.py). */
static void check_coloured_fog(int e)
{
    struct neph_scene *scene = load("coloured_fog");
    struct neph_image *frame = render(e, scene, NEPH_LAYER_RADIANCE | NEPH_LAYER_TRANSMITTANCE, 0);
    const struct difference off = compare(scene, frame);
    assert_true(off.transmittance < 2e-4);
    assert_scattering(&off, 1e-3 + noise[e]);
    assert_null(neph_image_attribute(frame, NEPH_BAKES_ATTRIBUTE));
    neph_image_destroy(frame);
    neph_scene_destroy(scene);
}

/* Which engines are installed: `*state` in the tests below. */
static int find_engines(void **state)
{
    bool *found = calloc(ENGINES, sizeof(*found));
    for (int e = 0; found && e < ENGINES; e++)
        found[e] = test_has_engine(engines[e]);
    *state = found;
    return found ? 0 : -1;
}

static int forget_engines(void **state)
{
    free(*state);
    return 0;
}

static void on_both(const bool *found, void (*check)(int e))
{
    for (int e = 0; e < ENGINES; e++)
        if (found[e])
            check(e);
}

static void test_grids(void **state)
{
    on_both(*state, check_grid);
}

/* One engine is enough to check the bake, and POV-Ray starts faster. */
static void test_what_is_baked(void **state)
{
    const bool *found = *state;
    if (!found[POVRAY])
        skip();
    check_cut_grid(POVRAY);
    check_blob(POVRAY);
}

static void test_mixtures(void **state)
{
    on_both(*state, check_mixture);
}

static void test_coloured_fog(void **state)
{
    on_both(*state, check_coloured_fog);
}

/* ---- unsupported media ----------------------------------------------------------------------- */

/* Whether the installed Blender was built without voxels, as Debian's Blender 5: it refuses every
 * medium on a grid, before the condition that a test examines. */
static bool is_without_voxels(int e)
{
    char reason[256] = "";
    const struct neph_settings settings = neph_settings_default(&neph_engine_cycles);
    if (e != CYCLES)
        return false;
    struct neph_scene *scene = load_voxels();
    neph_engine_cycles.can_render(scene, &settings, reason, sizeof(reason));
    neph_scene_destroy(scene);
    return strstr(reason, "built without") != NULL;
}

/* 50 km of planet with a kilometre of air: the nodes would miss it. */
static void test_what_does_not_fit_is_refused(void **state)
{
    struct neph_scene *scene = load("atmosphere_shell");
    scene->media[0].phase.kind = NEPH_PHASE_ISOTROPIC;
    for (int e = 0; e < ENGINES; e++) {
        struct neph_diag diag = {0};
        struct neph_image *frame = NULL;
        if (is_without_voxels(e))
            continue;
        assert_int_equal(try_render(e, scene, NEPH_LAYERS_ALL, 32, &frame, &diag),
                         NEPH_ERR_UNSUPPORTED);
        assert_non_null(strstr(diag.message, "medium 1: a spherical shell on a grid of 32 x"));
        assert_non_null(strstr(diag.hint, "bake_resolution"));
        assert_null(frame);
    }
    neph_scene_destroy(scene);
}

/* Where they overlap; disjoint ones are supported. */
static void test_cycles_refuses_two_phases_in_one_place(void **state)
{
    char reason[256] = "";
    struct neph_scene *scene = load_voxels(), *blob = load("gaussian_blob");
    const struct neph_settings settings = neph_settings_default(&neph_engine_cycles);
    scene->media[1] = blob->media[0];
    scene->media[1].phase = (struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN, -0.5};
    scene->medium_count = 2;
    assert_false(neph_engine_cycles.can_render(scene, &settings, reason, sizeof(reason)));
    assert_non_null(strstr(reason, "different phase functions"));
    scene->media[1].phase = scene->media[0].phase;
    assert_true(neph_engine_cycles.can_render(scene, &settings, reason, sizeof(reason)));
    scene->media[1].phase.g = -0.5;
    scene->media[1].gaussian.center_m.x += 50.0;
    assert_true(neph_engine_cycles.can_render(scene, &settings, reason, sizeof(reason)));
    scene->medium_count = 1;
    neph_scene_destroy(scene);
    neph_scene_destroy(blob);
}

static void test_missing_neph_vdb_is_told(void **state)
{
    if (is_without_voxels(CYCLES))
        skip();
    struct neph_scene *scene = load_voxels();
    struct neph_diag diag = {0};
    struct neph_image *frame = NULL;
    setenv("NEPH_VDB", "/nowhere/neph-vdb", 1);
    const enum neph_status status = try_render(CYCLES, scene, NEPH_LAYERS_ALL, 0, &frame, &diag);
    unsetenv("NEPH_VDB");
    assert_int_equal(status, NEPH_ERR_UNAVAILABLE);
    assert_non_null(strstr(diag.message, "/nowhere/neph-vdb"));
    assert_non_null(strstr(diag.hint, "copy it"));
    neph_scene_destroy(scene);
}

static void test_media_without_extinction_are_left_out(void **state)
{
    struct neph_scene *scene = load("gaussian_blob");
    struct neph_baked_scene baked;
    struct neph_diag diag = {0};
    scene->media[0].extinction_per_m = 0.0;
    neph_assert_ok(neph_baked_scene_make(scene, 16, &baked, &diag), &diag);
    assert_int_equal(baked.scene.medium_count, 0);
    assert_int_equal(baked.bake_count, 0);
    neph_baked_scene_finish(&baked);
    neph_scene_destroy(scene);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_what_does_not_fit_is_refused),
        cmocka_unit_test(test_cycles_refuses_two_phases_in_one_place),
        cmocka_unit_test(test_missing_neph_vdb_is_told),
        cmocka_unit_test(test_media_without_extinction_are_left_out),
    };
    const struct CMUnitTest engine_tests[] = {
        cmocka_unit_test(test_grids),
        cmocka_unit_test(test_what_is_baked),
        cmocka_unit_test(test_mixtures),
        cmocka_unit_test(test_coloured_fog),
    };
    if (neph_test_wants_engines(argc, argv))
        return cmocka_run_group_tests(engine_tests, find_engines, forget_engines);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
