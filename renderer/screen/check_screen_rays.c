/* SPDX-License-Identifier: MIT
 *
 * Tests of screen-space rays against closed forms: a plane mirror, light of a wall on a floor; and
 * of the temporal mean with a moving camera.
 */
#include "renderer/screen/check_screen.h"

#include "scenes/motion.h"
#include "truth/reflected.h"

enum { WIDTH = 97, HEIGHT = 61 };

/* ---- a plane mirror -------------------------------------------------------------------------- */

/* A mirror as floor, and behind it a wall with a light in front. */
static void set_mirror(struct test_scene *test)
{
    test_scene_init(test);
    test->key.position_m = (struct neph_vec3){0.3, 1.5, 5.0};
    test->key.look_at_m = (struct neph_vec3){0.0, 0.7, 0.0};
    test->scene.scattering = NEPH_SCATTERING_MULTIPLE;
    test->scene.sun.present = false;
    screen_add_light(test, (struct neph_vec3){0.5, 1.2, 0.4});
    test_add_box(test, (struct neph_vec3){-9, -1, -9}, (struct neph_vec3){9, 0, 9});
    test->solids[0].surface.metalness = 1.0;
    test_add_box(test, (struct neph_vec3){-9, 0, -1}, (struct neph_vec3){9, 9, -0.5});
    test_add_sphere(test, (struct neph_vec3){-0.7, 0.6, 0.6}, 0.4);
}

/* Whether a point is visible, at least `edge_px` pixels from the frame's edge. */
static bool is_seen(const struct neph_scene *scene, struct neph_vec3 point_m, double edge_px)
{
    const struct neph_camera camera = neph_scene_camera(scene, 0.0);
    const struct neph_vec3 way_m = neph_vec3_sub(point_m, camera.position_m);
    const double depth_m = neph_vec3_dot(way_m, camera.forward);
    const double half_height = neph_camera_half_height(&camera);
    const double x = neph_vec3_dot(way_m, camera.right) / (depth_m * half_height * WIDTH / HEIGHT);
    const double y = neph_vec3_dot(way_m, camera.up) / (depth_m * half_height);
    const double distance_m = neph_vec3_length(way_m);
    const struct neph_hit hit = neph_scene_hit(scene, camera.position_m,
                                               neph_vec3_scale(way_m, 1.0 / distance_m));
    return depth_m > 0.0 && fabs(x) < 1.0 - 2.0 * edge_px / WIDTH &&
           fabs(y) < 1.0 - 2.0 * edge_px / HEIGHT && hit.t_m > distance_m * (1.0 - 1e-6);
}

/* Expected radiance of a mirror pixel, if screen-space rays can find it: the direct light of
 * another surface. */
static bool in_mirror(const struct test_scene *test, int p, struct neph_rgb *light)
{
    struct neph_vec3 point_m;
    const struct neph_hit hit = screen_hit(test, WIDTH, HEIGHT, p % WIDTH, p / WIDTH, &point_m);
    const struct neph_camera camera = neph_scene_camera(&test->scene, 0.0);
    if (hit.solid != &test->solids[0])
        return false;
    struct neph_vec3 way = neph_vec3_normalize(neph_vec3_sub(point_m, camera.position_m));
    way.y = -way.y;
    const struct neph_vec3 from_m = neph_hit_outside_m(&hit, point_m);
    struct test_scene dull = *test; /* without the light that the mirror reflects onto the others */
    dull.scene.solids = dull.solids;
    dull.solids[0].surface.metalness = 0.0;
    const struct neph_reflected_view view = neph_reflected_view(&dull.scene, from_m, way);
    *light = neph_rgb_mul(view.color[0], view.direct[0]);
    return view.hit.solid && is_seen(&test->scene, neph_vec3_along(from_m, way, view.hit.t_m), 1.5);
}

struct gap {
    int count, lost;
    double off, sum;
};

static struct gap mirror_gap(struct neph_vulkan *vulkan, const char *settings)
{
    struct test_scene test;
    set_mirror(&test);
    OWNED(image) struct neph_image *image = screen_picture(vulkan, &test, WIDTH, HEIGHT, settings);
    const float *seen = neph_image_channel(image, "glossy_indirect.R"),
                *open = neph_image_channel(image, "glossy_open");
    struct gap gap = {0};
    for (int p = 0; p < WIDTH * HEIGHT; p++) {
        struct neph_rgb light;
        if (!in_mirror(&test, p, &light))
            continue;
        gap.count++;
        gap.lost += open[p] > 0.5f;
        gap.off += open[p] > 0.5f ? 0.0 : fabs(seen[p] - light.r);
        gap.sum += open[p] > 0.5f ? 0.0 : light.r;
    }
    printf("%d pixels, %d lost, off by %.2f %%: %s\n", gap.count, gap.lost,
           100.0 * gap.off / gap.sum, settings);
    return gap;
}

static void test_a_plane_mirror(void **state)
{
    struct gap gap = mirror_gap(*state, "gi=off ssr_steps=512 ray_refine=8");
    assert_true(gap.count > 1500 && gap.lost <= 0.01 * gap.count && gap.off < 0.02 * gap.sum);
    gap = mirror_gap(*state, "gi=off ssr_steps=16");
    assert_true(gap.lost <= 0.05 * gap.count && gap.off < 0.05 * gap.sum);
    gap = mirror_gap(*state, "gi=off ssr_steps=16 ssr_resolution=half");
    assert_true(gap.lost <= 0.05 * gap.count && gap.off < 0.05 * gap.sum);
    if (!neph_test_is_night())
        return;
    gap = mirror_gap(*state, "gi=off ssr_steps=512 ray_refine=8 ray_thickness_m=0");
    assert_true(gap.lost <= 0.01 * gap.count && gap.off < 0.03 * gap.sum);
}

/* ---- light of a wall on a floor -------------------------------------------------------------- */

static const double wall_half_m = 0.9, wall_height_m = 0.8;

/* The sun shines along the floor, so it lights only a wall. */
static void set_lit_wall(struct test_scene *test)
{
    test_scene_init(test);
    test->key.position_m = (struct neph_vec3){0.5, 3.0, 6.0};
    test->key.look_at_m = (struct neph_vec3){0.0, 0.5, 0.3};
    test->scene.scattering = NEPH_SCATTERING_MULTIPLE;
    test->scene.background_w_per_m2_sr = make_grey(0.0);
    test->scene.sun.direction = (struct neph_vec3){0.0, 0.0, 1.0};
    test->scene.sun.irradiance_w_per_m2 = make_grey(M_PI);
    test_add_box(test, (struct neph_vec3){-50, -1, -50}, (struct neph_vec3){50, 0, 50});
    test_add_box(test, (struct neph_vec3){-wall_half_m, 0, -0.3},
                 (struct neph_vec3){wall_half_m, wall_height_m, 0});
    test->solids[1].albedo = make_grey(0.8);
}

/* Error of the first bounce on a white floor, over pixels in front of the wall, relative to the
 * total light: rms and bias. */
struct floor_gap {
    double off, bias;
};

static struct floor_gap lit_floor_gap(struct neph_vulkan *vulkan, const char *settings, int frames)
{
    struct test_scene test;
    set_lit_wall(&test);
    OWNED(screening)
    struct neph_screen_renderer *screen = create_screen(vulkan, &test, WIDTH, HEIGHT, settings);
    struct neph_image *image = NULL;
    for (int i = 0; i < frames; i++) {
        neph_image_destroy(image);
        image = screen_next(screen, &test);
    }
    const float *light = neph_image_channel(image, "diffuse_indirect.G");
    double off = 0.0, sum = 0.0, bias = 0.0;
    for (int p = 0; p < WIDTH * HEIGHT; p++) {
        struct neph_vec3 point_m;
        const struct neph_hit hit = screen_hit(&test, WIDTH, HEIGHT, p % WIDTH, p / WIDTH,
                                               &point_m);
        if (hit.solid != &test.solids[0] || point_m.z < 0.1 || point_m.z > 2.0 ||
            fabs(point_m.x) > 0.8)
            continue;
        const double exact =
            0.8 * (standing_rectangle(point_m.z, wall_half_m - point_m.x, wall_height_m) +
                   standing_rectangle(point_m.z, wall_half_m + point_m.x, wall_height_m));
        off += fabs(light[p] - exact);
        bias += light[p] - exact;
        sum += exact;
    }
    printf("off by %.2f %%, bias %+.2f %%: %s, %d frames\n", 100.0 * off / sum, 100.0 * bias / sum,
           settings, frames);
    neph_image_destroy(image);
    return (struct floor_gap){off / sum, bias / sum};
}

/* The wall covers few pixels, and rays miss some at its foot and edges. The remaining error is
 * noise, reduced by frames and smoothing. */
static void test_light_of_a_wall(void **state)
{
    const char *const rays = "gi_bounces=one gi_smooth=0 gi_history=1024 gi_rays=4 gi_steps=128 "
                             "ray_step_power=1.5";
    const struct floor_gap once = lit_floor_gap(*state, rays, 1);
    const struct floor_gap often = lit_floor_gap(*state, rays, 16);
    assert_true(often.off < 0.2 * once.off && often.bias > -0.05 && often.bias < 0.01);
    const struct floor_gap smooth = lit_floor_gap(*state, "gi_bounces=one gi_steps=128", 1);
    assert_true(smooth.off < 0.6 * once.off);
}

/* ---- the mean over frames -------------------------------------------------------------------- */

/* The lit wall, translated and rotated, with a camera that moves sideways. */
struct moving {
    struct test_scene test;
    struct neph_camera_key camera_keys[2];
    struct neph_solid_key solid_keys[2];
    struct neph_mover mover;
};

static void set_moving(struct moving *moving)
{
    set_lit_wall(&moving->test);
    struct neph_scene *scene = &moving->test.scene;
    moving->camera_keys[0] = moving->camera_keys[1] = moving->test.key;
    moving->camera_keys[1].frame = 1.0;
    moving->camera_keys[1].position_m.x += 0.4;
    moving->camera_keys[1].look_at_m.x += 0.3;
    moving->solid_keys[0] = (struct neph_solid_key){.frame = 0.0};
    moving->solid_keys[1] = (struct neph_solid_key){
        .frame = 1.0, .move_m = {0.5, 0.0, 0.4}, .turn_rad = 0.2};
    moving->mover = (struct neph_mover){
        .first = 1, .count = 1, .axis = 1, .key_count = 2, .keys = moving->solid_keys};
    scene->frame_count = 2;
    scene->camera_key_count = 2;
    scene->camera_keys = moving->camera_keys;
    scene->mover_count = 1;
    scene->movers = &moving->mover;
}

static struct neph_scene *still_at(const struct neph_scene *scene, double frame)
{
    struct neph_diag diag = {0};
    struct neph_scene *still = NULL;
    neph_assert_ok(neph_scene_at(scene, frame, &still, &diag), &diag);
    return still;
}

/* The previous position of the surface point visible at pixel p in the second frame; false for the
 * sky. */
static bool was_at(const struct neph_scene *scene, const struct neph_scene *now, int p,
                   struct neph_vec3 *point_m, bool *is_mover)
{
    const struct neph_camera camera = neph_scene_camera(now, 0.0);
    const struct neph_pixel_ray ray = neph_camera_ray(&camera, WIDTH, HEIGHT, p % WIDTH, p / WIDTH);
    const struct neph_hit hit = neph_scene_hit(now, ray.origin_m, ray.direction);
    if (!hit.solid)
        return false;
    const struct neph_placing here = neph_mover_placing(scene, scene->movers, 1.0);
    const struct neph_placing there = neph_mover_placing(scene, scene->movers, 0.0);
    *point_m = neph_vec3_along(ray.origin_m, ray.direction, hit.t_m);
    *is_mover = hit.solid == &now->solids[1];
    if (*is_mover)
        *point_m = neph_find_earlier_place_m(&here, &there, *point_m);
    return true;
}

/* Disoccluded points (at the frame's edge, or from behind the wall) have no history; all others
 * have, reprojected by their own motion, except one or two pixels at edges. */
static void test_history_goes_with_the_surface(void **state)
{
    struct moving moving;
    struct neph_diag diag = {0};
    set_moving(&moving);
    const struct neph_scene *scene = &moving.test.scene;
    OWNED(screening)
    struct neph_screen_renderer *screen = create_screen(
        *state, &moving.test, WIDTH, HEIGHT, "gi_rays=1 gi_smooth=0 gi_history=3 ssr=off");
    for (int i = -5; i <= 1; i++)
        neph_assert_ok(neph_screen_renderer_frame(screen, scene, i, NULL, NULL, &diag), &diag);
    OWNED(memory) float *counts = screen_read(screen, WIDTH, HEIGHT, SCREEN_GI_COUNT);
    OWNED(scene) struct neph_scene *now = still_at(scene, 1.0), *before = still_at(scene, 0.0);
    int kept[2] = {0}, forgotten[2] = {0}, fresh = 0, strange = 0;
    for (int p = 0; p < WIDTH * HEIGHT; p++) {
        struct neph_vec3 point_m;
        bool is_mover;
        if (!was_at(scene, now, p, &point_m, &is_mover))
            continue;
        const bool was_seen = is_seen(before, point_m, 0.0);
        assert_true(counts[4 * p] >= 1.0f && counts[4 * p] <= 4.0f);
        kept[is_mover] += was_seen && counts[4 * p] == 4.0f;
        forgotten[is_mover] += was_seen && counts[4 * p] == 1.0f;
        fresh += !was_seen && counts[4 * p] == 1.0f;
        strange += !was_seen && counts[4 * p] > 1.0f; /* nearly all at the frame's edge */
    }
    printf("kept %d of the floor and %d of the wall, forgotten %d and %d; new %d, old %d\n",
           kept[0], kept[1], forgotten[0], forgotten[1], fresh, strange);
    assert_true(kept[0] > 3000 && forgotten[0] < 0.03 * kept[0]);
    assert_true(kept[1] > 70 && forgotten[1] < 0.1 * kept[1]);
    assert_true(fresh > 120 && strange < 120);
}

#include "tests/renderer/main.h"
