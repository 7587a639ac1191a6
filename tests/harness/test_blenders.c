/* SPDX-License-Identifier: MIT
 *
 * Faulty Blenders, simulated by a shell script that leaves prepared images: each is reported with
 * its cause, and none produces a frame. The images are exact transport of the trial scene, changed
 * by each test.
 */
#include "tests/harness/engine_test.h"

#include "base/exr.h"
#include "harness/engines/cycles_probe.h"
#include "harness/engines/cycles_spec.h"
#include "harness/engines/engines.h"
#include "harness/engines/frame_check.h"
#include "harness/engines/gpu_frames.h"
#include "harness/engines/program.h"
#include "harness/engines/trial.h"
#include "truth/transport.h"

#include <stdlib.h>

enum { WIDTH = NEPH_TRIAL_WIDTH_PX, HEIGHT = NEPH_TRIAL_HEIGHT_PX, PIXELS = WIDTH * HEIGHT };

/* The images of a simulated Blender. */
struct fake {
    const char *version;
    double brightness; /* factor of the radiance */
    bool has_voxels, is_multipart, has_long_names, lacks_spots;
    const char *phases;
};

static const struct fake good = {
    .version = "3.4.1", .brightness = 1.0, .has_voxels = true, .phases = "[]"};

struct bench {
    struct impostor impostor;
    struct neph_trial trial;
};

static int set_up(void **state)
{
    struct bench *bench = calloc(1, sizeof(*bench));
    struct neph_diag diag = {0};
    neph_assert_ok(neph_trial_open(true, &bench->trial, &diag), &diag);
    set_impostor(&bench->impostor, "blender", "");
    setenv("XDG_CACHE_HOME", bench->impostor.directory, 1);
    *state = bench;
    return 0;
}

static int tear_down(void **state)
{
    struct bench *bench = *state;
    unsetenv("NEPH_BLENDER");
    remove_impostor(&bench->impostor);
    unsetenv("XDG_CACHE_HOME");
    neph_trial_close(&bench->trial);
    free(bench);
    return 0;
}

/* ---- its images ------------------------------------------------------------------------------ */

static void write_file(const struct bench *bench, const char *name, const char *text)
{
    char *path = neph_path_join(bench->impostor.directory, name);
    neph_assert_ok(neph_file_write(path, text, strlen(text), NULL), NULL);
    free(path);
}

static struct neph_ray_light trace_pixel(const struct neph_scene *scene, int pixel)
{
    const struct neph_camera camera = neph_scene_camera(scene, 0.0);
    const struct neph_pixel_ray ray = neph_camera_ray(&camera, WIDTH, HEIGHT, pixel % WIDTH,
                                                      pixel / WIDTH);
    return neph_transport_ray(scene, ray.origin_m, ray.direction);
}

static void add_layer(struct neph_image *image, const char *name, double scale,
                      const struct neph_rgb *values)
{
    float *layer[3];
    neph_assert_ok(neph_image_add_rgb(image, name, layer, NULL), NULL);
    for (int i = 0; i < PIXELS; i++) {
        layer[0][i] = (float)(scale * values[i].r);
        layer[1][i] = (float)(scale * values[i].g);
        layer[2][i] = (float)(scale * values[i].b);
    }
}

/* Marks a file as multi-part in its fifth to eighth byte; it then lacks what parts need. */
static void mark_multipart(const char *path)
{
    char *bytes = NULL;
    size_t size = 0;
    neph_assert_ok(neph_file_read(path, 1 << 20, &bytes, &size, NULL), NULL);
    bytes[5] = (char)(bytes[5] | 0x10);
    neph_assert_ok(neph_file_write(path, bytes, size, NULL), NULL);
    free(bytes);
}

static void save(const struct bench *bench, const char *name, struct neph_image *image,
                 bool is_multipart)
{
    struct neph_diag diag = {0};
    char *path = neph_path_join(bench->impostor.directory, name);
    neph_assert_ok(neph_exr_write(path, image, &diag), &diag);
    if (is_multipart)
        mark_multipart(path);
    neph_image_destroy(image);
    free(path);
}

static struct neph_image *empty_image(void)
{
    struct neph_image *image = NULL;
    neph_assert_ok(neph_image_create(WIDTH, HEIGHT, &image, NULL), NULL);
    return image;
}

static void write_images(const struct bench *bench, const struct fake *fake)
{
    struct neph_scene scene = bench->trial.scene;
    struct neph_cycles_world world;
    struct neph_rgb all[PIXELS], volume[PIXELS], through[PIXELS];
    struct neph_image *radiance = empty_image(), *transmittance = empty_image(),
                      *depth = empty_image();
    float *units;
    neph_assert_ok(neph_cycles_world(&scene, &world, NULL), NULL);
    scene.medium_count = fake->has_voxels ? 2 : 1;
    neph_assert_ok(neph_image_add_channel(depth, "pass.Depth.Z", &units, NULL), NULL);
    for (int i = 0; i < PIXELS; i++) {
        const struct neph_ray_light light = trace_pixel(&scene, i);
        const struct neph_camera camera = neph_scene_camera(&scene, 0.0);
        const struct neph_vec3 ray =
            neph_camera_ray(&camera, WIDTH, HEIGHT, i % WIDTH, i / WIDTH).direction;
        all[i] = light.radiance;
        volume[i] = light.volume;
        through[i] = light.transmittance;
        units[i] = isinf(light.hit_m)
                       ? 1e10f
                       : (float)(light.hit_m * neph_vec3_dot(ray, camera.forward) / world.unit_m);
    }
    add_layer(radiance, "pass.Combined", fake->brightness, all);
    add_layer(radiance, fake->has_long_names ? "pass.Volume Direct" : "pass.VolumeDir",
              fake->brightness, volume);
    add_layer(radiance, fake->has_long_names ? "pass.Volume Indirect" : "pass.VolumeInd", 0.0,
              volume);
    add_layer(transmittance, "pass.Combined", 1.0, through);
    save(bench, "radiance.exr", radiance, fake->is_multipart);
    save(bench, "transmittance.exr", transmittance, false);
    save(bench, "depth.exr", depth, false);
}

static void install(const struct bench *bench, const struct fake *fake)
{
    char *script = neph_format("#!/bin/sh\n"
                               "[ \"$1\" = --version ] && exec echo 'Blender %s'\n"
                               "cp '%s'/*.exr '%s'/*.json .\n",
                               fake->version, bench->impostor.directory, bench->impostor.directory);
    char *about = neph_format("{\"has_unbiased\": false, \"has_spots\": %s, \"phases\": %s}",
                              fake->lacks_spots ? "false" : "true", fake->phases);
    write_images(bench, fake);
    write_file(bench, "about.json", about);
    write_file(bench, "timing.json", "{\"radiance\": 0.5}");
    write_file(bench, "blender", script);
    char *path = neph_path_join(bench->impostor.directory, "blender");
    assert_int_equal(chmod(path, 0755), 0);
    free(path);
    free(about);
    free(script);
}

static struct neph_engine_info run_probe(const struct bench *bench, const struct fake *fake)
{
    struct neph_engine_info info;
    install(bench, fake);
    neph_engine_probe(&neph_engine_cycles, NULL, &info);
    print_message("  %s%s%s\n", info.missing, info.can, info.warning);
    return info;
}

static void assert_says(const char *text, const char *words)
{
    if (!strstr(text, words))
        fail_msg("'%s' does not say '%s'", text, words);
}

/* ---- the trial ------------------------------------------------------------------------------- */

static void test_one_that_works(void **state)
{
    const struct neph_engine_info info = run_probe(*state, &good);
    assert_true(info.available);
    assert_string_equal(info.version, "Blender 3.4.1");
    assert_string_equal(info.warning, "");
    assert_string_equal(info.can, "voxels; volumes in steps; Henyey-Greenstein only");
    assert_false(info.is_unstepped);
}

static void assert_broken(const struct bench *bench, const struct fake *fake, const char *words)
{
    const struct neph_engine_info info = run_probe(bench, fake);
    assert_true(info.broken && !info.available);
    assert_says(info.missing, words);
    struct neph_diag diag = {0};
    struct neph_cycles_features features;
    assert_int_equal(neph_cycles_features(0, &features, &diag), NEPH_ERR_ENGINE);
}

static void test_black(void **state)
{
    struct fake fake = good;
    fake.brightness = 0.0;
    assert_broken(*state, &fake, "black");
    fake.brightness = 3.0;
    assert_broken(*state, &fake, "3 times as much light");
}

static void test_several_parts(void **state)
{
    struct fake fake = good;
    fake.is_multipart = true;
    assert_broken(*state, &fake, "truncated or damaged");
}

static void test_layers_in_full(void **state)
{
    struct fake fake = good;
    fake.has_long_names = true;
    fake.phases = "[\"RAYLEIGH\",\"DRAINE\",\"MIE\"]";
    const struct neph_engine_info info = run_probe(*state, &fake);
    assert_true(info.available);
    assert_says(info.can, "Rayleigh, Draine");
}

/* A version newer than all tested ones is tried. */
static void test_version_9(void **state)
{
    struct fake fake = good;
    fake.version = "9.0.2";
    const struct neph_engine_info info = run_probe(*state, &fake);
    assert_true(info.available);
    assert_says(info.warning, "Blender 9.0.2 was not measured");
    fake.brightness = 0.0;
    fake.version = "9.0.3";
    assert_broken(*state, &fake, "black");
    fake = good;
    fake.version = "3.3.9";
    const struct neph_engine_info old = run_probe(*state, &fake);
    assert_false(old.available);
    assert_says(old.missing, "versions from 3.4 on");
}

/* ---- frames ---------------------------------------------------------------------------------- */

static enum neph_status try_frame(const struct neph_scene *scene, struct neph_diag *diag)
{
    char folder[] = "/tmp/neph-blenders-XXXXXX";
    struct neph_image *frame = NULL;
    struct neph_cost cost;
    const struct neph_shot shot = {.scene = scene,
                                   .settings = neph_settings_default(&neph_engine_cycles),
                                   .width_px = WIDTH,
                                   .height_px = HEIGHT,
                                   .layers = NEPH_LAYERS_ALL,
                                   .seed = 1,
                                   .scratch_directory = folder,
                                   .time_limit_s = 60.0};
    assert_non_null(mkdtemp(folder));
    const enum neph_status status = neph_engine_render(&neph_engine_cycles, &shot, &frame, &cost,
                                                       diag);
    neph_image_destroy(frame);
    neph_dir_remove(folder, NULL);
    return status;
}

/* Fog is rendered, voxels fail. */
static void test_no_volumes(void **state)
{
    const struct bench *bench = *state;
    struct fake fake = good;
    struct neph_diag diag = {0};
    char reason[512] = "";
    struct neph_scene fog = bench->trial.scene;
    const struct neph_settings settings = neph_settings_default(&neph_engine_cycles);
    fog.medium_count = 1;
    fake.has_voxels = false;
    const struct neph_engine_info info = run_probe(bench, &fake);
    assert_true(info.available);
    assert_says(info.can, "no voxels");
    neph_assert_ok(try_frame(&fog, &diag), &diag);
    assert_true(neph_engine_can_render(&neph_engine_cycles, &fog, &settings, reason, 512));
    assert_false(
        neph_engine_can_render(&neph_engine_cycles, &bench->trial.scene, &settings, reason, 512));
    assert_says(reason, "NanoVDB");
    assert_int_equal(try_frame(&bench->trial.scene, &diag), NEPH_ERR_UNSUPPORTED);
    assert_says(diag.message, "NanoVDB");
}

/* Passes its trial and fails later. */
static void test_worse_after_its_trial(void **state)
{
    const struct bench *bench = *state;
    struct fake fake = good;
    struct neph_diag diag = {0};
    assert_true(run_probe(bench, &fake).available);
    neph_assert_ok(try_frame(&bench->trial.scene, &diag), &diag);
    fake.brightness = 0.0;
    write_images(bench, &fake);
    assert_int_equal(try_frame(&bench->trial.scene, &diag), NEPH_ERR_ENGINE);
    assert_says(diag.message, "Blender gave a black frame");
    fake = good;
    fake.has_voxels = false;
    write_images(bench, &fake);
    struct neph_scene voxels = bench->trial.scene; /* without the fog */
    voxels.media[0] = voxels.media[1];
    voxels.medium_count = 1;
    assert_int_equal(try_frame(&voxels, &diag), NEPH_ERR_ENGINE);
    assert_says(diag.message, "Blender has left a medium out");
}

static void test_missing_features_of_a_blender(void **state)
{
    const struct bench *bench = *state;
    struct neph_diag diag = {0};
    char reason[512] = "";
    struct neph_settings settings = neph_settings_default(&neph_engine_cycles);
    struct neph_scene scene = bench->trial.scene;
    assert_true(run_probe(bench, &good).available);
    scene.media[0].phase.kind = NEPH_PHASE_RAYLEIGH;
    assert_false(neph_engine_can_render(&neph_engine_cycles, &scene, &settings, reason, 512));
    assert_says(reason, "Blender has from 4.3 on");
    scene.scattering = NEPH_SCATTERING_NONE;
    assert_true(neph_engine_can_render(&neph_engine_cycles, &scene, &settings, reason, 512));
    neph_assert_ok(neph_settings_set(&neph_engine_cycles, &settings, "volume_biased=off", &diag),
                   &diag);
    assert_false(neph_engine_can_render(&neph_engine_cycles, &scene, &settings, reason, 512));
    assert_says(reason, "in steps only");
    struct fake fake = good;
    fake.version = "4.0.1";
    fake.lacks_spots = true;
    assert_true(run_probe(bench, &fake).available);
    scene.lights[0] = (struct neph_light){.intensity_w_per_sr = {1.0, 1.0, 1.0}};
    scene.light_count = 1;
    settings = neph_settings_default(&neph_engine_cycles);
    assert_true(neph_engine_can_render(&neph_engine_cycles, &scene, &settings, reason, 512));
    scene.lights[0].is_spot = true;
    assert_false(neph_engine_can_render(&neph_engine_cycles, &scene, &settings, reason, 512));
    assert_says(reason, "spots");
}

/* --- search for Blenders ---------------------------------------------------------------------- */

static void assert_missing(const char *variable, const char *words)
{
    struct neph_engine_info info;
    setenv("NEPH_BLENDER", variable, 1);
    neph_engine_probe(&neph_engine_cycles, NULL, &info);
    assert_false(info.available || info.broken);
    assert_says(info.missing, words);
}

static void test_named_programs(void **state)
{
    const struct bench *bench = *state;
    struct neph_engine_info info;
    install(bench, &good);
    char *several = neph_format(":%s:/nonexistent", bench->impostor.directory);
    setenv("NEPH_BLENDER", several, 1);
    neph_engine_probe(&neph_engine_cycles, NULL, &info);
    assert_true(info.available);
    free(several);
    assert_missing("/nonexistent/blender", "'/nonexistent/blender' is no program");
    assert_missing("/tmp", "no program 'blender' in folder '/tmp'");
    assert_missing("a:b:c:d:e:f:g:h:i", "9 programs; 8 are taken at most");
    assert_int_equal(neph_external_count(&(const struct neph_external_renderer){
                         .variable = "NEPH_BLENDER", .is_list = true}),
                     9);
}

static void test_versions(void **state)
{
    assert_true(neph_version_is_from("3.4.1", 3, 4) && neph_version_is_from("4.0", 3, 4));
    assert_true(neph_version_is_from("10.1", 9, 2));
    assert_false(neph_version_is_from("3.3.9", 3, 4) || neph_version_is_from("2.93", 3, 4));
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        TEST(test_one_that_works),
        TEST(test_black),
        TEST(test_several_parts),
        TEST(test_layers_in_full),
        TEST(test_version_9),
        TEST(test_no_volumes),
        TEST(test_worse_after_its_trial),
        TEST(test_missing_features_of_a_blender),
        TEST(test_named_programs),
        cmocka_unit_test(test_versions),
    };
#undef TEST
    return cmocka_run_group_tests(tests, NULL, NULL);
}
