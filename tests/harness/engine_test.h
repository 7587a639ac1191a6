/* SPDX-License-Identifier: MIT
 *
 * Helpers for tests of external programs: is the program installed, and a shell script in its
 * place.
 */
#ifndef NEPH_TESTS_ENGINE_TEST_H
#define NEPH_TESTS_ENGINE_TEST_H

#include "tests/neph_test.h"
#include "tests/scene_builders.h"

#include "base/files.h"
#include "base/text.h"
#include "harness/engines/engine.h"

#include <sys/stat.h>

static inline bool test_has_engine(const struct neph_engine *engine)
{
    struct neph_engine_info info;
    engine->probe(engine, NULL, &info);
    if (!info.available)
        print_message("SKIPPED, %s is not measured here: %s\n", engine->name, info.missing);
    return info.available;
}

static inline struct neph_engine_info test_probe_without_path(const struct neph_engine *engine)
{
    struct neph_engine_info info;
    char *path = strdup(getenv("PATH") ? getenv("PATH") : "");
    char *named = getenv("NEPH_BLENDER") ? strdup(getenv("NEPH_BLENDER")) : NULL;
    setenv("PATH", "/nonexistent", 1);
    unsetenv("NEPH_BLENDER");
    engine->probe(engine, NULL, &info);
    setenv("PATH", path, 1);
    if (named)
        setenv("NEPH_BLENDER", named, 1);
    free(named);
    free(path);
    return info;
}

static inline bool test_can_render(const struct neph_engine *engine, const struct neph_scene *scene,
                                   char *reason, size_t reason_size)
{
    const struct neph_settings settings = neph_settings_default(engine);
    return neph_engine_can_render(engine, scene, &settings, reason, reason_size);
}

/* A camera at `eye`, a sun, no media, no solids, black sky, single scattering. */
static inline void test_stage(struct test_scene *stage, struct neph_vec3 eye,
                              struct neph_vec3 look_at)
{
    test_scene_init(stage);
    stage->key = (struct neph_camera_key){.position_m = eye, .look_at_m = look_at};
    stage->scene.path = "scene.yaml";
    stage->scene.name = "stage";
    stage->scene.vertical_fov_rad = 0.7;
    stage->scene.frame_rate_hz = 25.0;
    stage->scene.sun.direction = neph_vec3_normalize((struct neph_vec3){0.48, 0.6, 0.64});
    stage->scene.sun.irradiance_w_per_m2 = make_grey(2.0);
    stage->scene.background_w_per_m2_sr = make_grey(0.0);
}

/* Renders in a scratch folder whose name needs quoting. */
static inline enum neph_status test_render(const struct neph_engine *engine, struct neph_shot *shot,
                                           struct neph_image **frame, struct neph_cost *cost,
                                           struct neph_diag *diag)
{
    char scratch[] = "/tmp/neph \"test\" #1 '$(touch x)' %d XXXXXX";
    assert_non_null(mkdtemp(scratch));
    shot->scratch_directory = scratch;
    const enum neph_status status = engine->render(shot, frame, cost, diag);
    neph_dir_remove(scratch, NULL);
    shot->scratch_directory = NULL;
    return status;
}

/* A fake program, first in PATH; NEPH_BLENDER names no other Blender. */
struct impostor {
    char directory[64];
    char *path, *named; /* PATH and NEPH_BLENDER before the test */
};

static inline void set_impostor(struct impostor *impostor, const char *program, const char *script)
{
    strcpy(impostor->directory, "/tmp/neph-impostor-XXXXXX");
    assert_non_null(mkdtemp(impostor->directory));
    char *file = neph_path_join(impostor->directory, program);
    neph_assert_ok(neph_file_write(file, script, strlen(script), NULL), NULL);
    assert_int_equal(chmod(file, 0755), 0);
    free(file);
    impostor->path = strdup(getenv("PATH") ? getenv("PATH") : "/usr/bin:/bin");
    impostor->named = getenv("NEPH_BLENDER") ? strdup(getenv("NEPH_BLENDER")) : NULL;
    unsetenv("NEPH_BLENDER");
    char *path = neph_format("%s:%s", impostor->directory, impostor->path);
    setenv("PATH", path, 1);
    free(path);
}

static inline void remove_impostor(struct impostor *impostor)
{
    setenv("PATH", impostor->path, 1);
    if (impostor->named)
        setenv("NEPH_BLENDER", impostor->named, 1);
    free(impostor->named);
    free(impostor->path);
    neph_dir_remove(impostor->directory, NULL);
}

static inline struct neph_engine_info test_probe_impostor(const struct neph_engine *engine,
                                                          const char *program, const char *script)
{
    struct neph_engine_info info;
    struct impostor impostor;
    set_impostor(&impostor, program, script);
    engine->probe(engine, NULL, &info);
    remove_impostor(&impostor);
    return info;
}

#endif
