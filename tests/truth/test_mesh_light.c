/* SPDX-License-Identifier: MIT
 *
 * Light in fog around meshes: meshes of boxes against boxes in exact transport, and the oracle
 * against exact transport over hills.
 */
#include "tests/mesh_builders.h"

#include "base/image.h"
#include "scenes/solids.h"
#include "truth/oracle.h"
#include "truth/transport.h"

/* --- meshes of boxes ------------------------------------------------------------------------- */

enum { BOXES = 5 };

struct stage {
    struct neph_scene scenes[2]; /* boxes; their meshes */
    struct neph_solid boxes[BOXES], meshes[BOXES];
    struct neph_mesh *made[BOXES];
};

/* A ground, posts of 10 cm, and a block, with a low sun and two lights, in fog. */
static void make_stage(struct stage *stage, struct neph_medium fog)
{
    static const struct neph_bounds boxes[BOXES] = {{{-40, -1, -40}, {40, 0, 40}},
                                                    {{-2, 0, -3}, {-1.9, 3, -2.9}},
                                                    {{0.5, 0, -3}, {0.6, 3, -2.9}},
                                                    {{2, 0, -5}, {4, 1.5, -3}},
                                                    {{-4, 1, -6}, {-3, 1.2, 2}}};
    const struct neph_light lamps[2] = {
        {.position_m = {1.5, 2.5, -4}, .intensity_w_per_sr = {3, 2, 1}},
        {.position_m = {-1, 4, 1},
         .intensity_w_per_sr = {5, 5, 5},
         .is_spot = true,
         .axis = neph_vec3_normalize((struct neph_vec3){0.2, -1, -0.6}),
         .inner_cosine = 0.9,
         .outer_cosine = 0.7}};
    for (int i = 0; i < BOXES; i++) {
        stage->made[i] = make_box_mesh(boxes[i].min_m, boxes[i].max_m);
        stage->boxes[i] = (struct neph_solid){
            .kind = NEPH_SOLID_BOX, .box = boxes[i], .albedo = {0.5, 0.4, 0.3}};
        stage->meshes[i] = (struct neph_solid){.kind = NEPH_SOLID_MESH,
                                               .mesh = stage->made[i],
                                               .scale_m = 1.0,
                                               .albedo = {0.5, 0.4, 0.3}};
    }
    for (int i = 0; i < 2; i++) {
        stage->scenes[i] = make_sunny(fog, (struct neph_vec3){0.5, 0.3, -0.4});
        stage->scenes[i].solid_count = BOXES;
        stage->scenes[i].solids = i ? stage->meshes : stage->boxes;
        stage->scenes[i].light_count = 2;
        memcpy(stage->scenes[i].lights, lamps, sizeof(lamps));
    }
}

static void assert_same_light(struct neph_rgb a, struct neph_rgb b)
{
    /* Shadows end within roundings of each other, 1e-14 of their distance; quadrature of the lamps
     * is exact to 1e-10. */
    neph_assert_close(a.r, b.r, 1e-9, 1e-15);
    neph_assert_close(a.g, b.g, 1e-9, 1e-15);
    neph_assert_close(a.b, b.b, 1e-9, 1e-15);
}

static void test_meshes_of_boxes_are_lit_as_boxes(void **state)
{
    struct neph_medium fogs[3] = {
        make_homogeneous(0.05, everywhere), make_height_fog(0.1, 0.6),
        make_homogeneous(0.1, (struct neph_bounds){{-5, 0, -8}, {5, 4, 3}})};
    OWNED(memory) struct neph_shadows *shadows = malloc(sizeof(*shadows));
    for (size_t f = 0; f < COUNT(fogs); f++) {
        struct stage stage;
        uint64_t seed = 5 + f;
        int shaded = 0;
        make_stage(&stage, fogs[f]);
        for (int i = 0; i < neph_test_paths(360); i++) {
            const struct neph_vec3 eye_m = {neph_test_uniform(&seed, -2, 2), 1.6, 8};
            const struct neph_vec3 at_m = {neph_test_uniform(&seed, -5, 5),
                                           neph_test_uniform(&seed, -0.5, 3.5), -4};
            const struct neph_vec3 d = neph_vec3_normalize(neph_vec3_sub(at_m, eye_m));
            const struct neph_ray_light box = neph_transport_ray(&stage.scenes[0], eye_m, d);
            const struct neph_ray_light mesh = neph_transport_ray(&stage.scenes[1], eye_m, d);
            neph_assert_close(mesh.hit_m, box.hit_m, 1e-14, 0.0);
            assert_same_light(mesh.radiance, box.radiance);
            assert_same_light(mesh.volume, box.volume);
            const struct neph_shadow_ray ray = {eye_m, d,   stage.scenes[1].sun.direction,
                                                NULL,  0.0, fmin(box.hit_m, 50.0)};
            shadows->count = 0;
            neph_scene_add_shadows(&stage.scenes[1], &ray, shadows);
            shaded += shadows->count > 0;
        }
        print_message("shadows on %d of %d rays\n", shaded, neph_test_paths(360));
        assert_true(shaded > neph_test_paths(360) / 4);
        for (int i = 0; i < BOXES; i++)
            neph_mesh_destroy(stage.made[i]);
    }
}

/* --- the oracle ------------------------------------------------------------------------------ */

/* Hills with lumps on them, a low sun, fog in the valleys, a lamp. */
static void make_hilly(struct neph_scene *scene, struct neph_camera_key *key,
                       struct neph_solid solids[3], struct neph_mesh *const meshes[2])
{
    *key = (struct neph_camera_key){.position_m = {0, 3, 9}, .look_at_m = {0, 0.5, 0}};
    for (int i = 0; i < 3; i++)
        solids[i] = (struct neph_solid){.kind = NEPH_SOLID_MESH,
                                        .mesh = meshes[i > 0],
                                        .scale_m = i ? 0.4 * i : 1.0,
                                        .center_m = {i ? 3.0 - 2.0 * i : 0.0, i ? 1.2 : 0.0, i},
                                        .yaw = {1, 0.8, 0.6},
                                        .albedo = make_grey(0.6)};
    *scene = make_sunny(make_height_fog(0.15, 0.8), (struct neph_vec3){0.8, 0.35, -0.3});
    scene->media[0].albedo = make_grey(0.9);
    scene->camera_key_count = 1;
    scene->camera_keys = key;
    scene->camera_up = (struct neph_vec3){0, 1, 0};
    scene->vertical_fov_rad = 0.8;
    scene->frame_count = 1;
    scene->solid_count = 3;
    scene->solids = solids;
    scene->light_count = 1;
    scene->lights[0] = (struct neph_light){.position_m = {-1, 2.2, 2},
                                           .intensity_w_per_sr = {2, 2, 2}};
    snprintf(scene->hash, sizeof(scene->hash), "hilly");
}

/* As test_reported_noise_is_true of test_oracle.c, where the tolerances are derived. */
static void test_the_oracle_agrees_over_hills(void **state)
{
    enum { WIDTH = 48, HEIGHT = 27, SAMPLES = 512 };
    uint64_t seed = 2;
    struct neph_scene scene;
    struct neph_camera_key key;
    struct neph_solid solids[3];
    struct neph_mesh *meshes[2] = {finish_mesh(make_hills(24, 8.0, 0.4)),
                                   finish_mesh(make_lump(8, 0.3, &seed))};
    struct neph_image *frame = NULL;
    const struct neph_oracle_params params = {.width_px = WIDTH,
                                              .height_px = HEIGHT,
                                              .seed = 3,
                                              .samples = SAMPLES,
                                              .time_limit_s = INFINITY};
    make_hilly(&scene, &key, solids, meshes);
    neph_assert_ok(neph_oracle_render(&scene, &params, &frame, NULL, NULL), NULL);
    const float *value = neph_image_channel(frame, "G");
    const float *variance = neph_image_channel(frame, "variance.G");
    const struct neph_camera camera = neph_scene_camera(&scene, 0.0);
    double sum = 0.0, squares = 0.0;
    int count = 0, hits = 0;
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        const struct neph_ray_light light = neph_transport_ray(
            &scene, camera.position_m,
            neph_camera_ray(&camera, WIDTH, HEIGHT, i % WIDTH, i / WIDTH).direction);
        hits += isfinite(light.hit_m);
        if (!(sqrt((double)variance[i]) > 1e-6 * (double)value[i]))
            continue;
        const double z = ((double)value[i] - light.radiance.g) / sqrt((double)variance[i]);
        sum += z;
        squares += z * z;
        count++;
    }
    const double mean = sum / count;
    print_message("%d pixels, %d of solids: mean %+.4f, variance %.4f\n", count, hits, mean,
                  squares / count - mean * mean);
    assert_true(count > WIDTH * HEIGHT / 2 && hits > count / 3);
    neph_assert_close(mean, 0.0, 0.0, 4.0 / sqrt(count) + 0.044);
    neph_assert_close(squares / count - mean * mean, 1.0, 0.0, 4.0 * sqrt(2.0 / count) + 0.02);
    neph_image_destroy(frame);
    for (int i = 0; i < 2; i++)
        neph_mesh_destroy(meshes[i]);
}

#include "tests/main.h"
