/* SPDX-License-Identifier: MIT
 *
 * Scenes that tests create in memory. By default media are white, isotropic and infinite;
 * `extinction_per_m` is the largest.
 */
#ifndef NEPH_TESTS_SCENE_BUILDERS_H
#define NEPH_TESTS_SCENE_BUILDERS_H

#include "tests/neph_test.h"

#include "scenes/grid.h"
#include "scenes/horizon.h"
#include "scenes/horizon_density.h"
#include "scenes/media.h"
#include "scenes/scene.h"

static const struct neph_bounds everywhere = {{-INFINITY, -INFINITY, -INFINITY},
                                              {INFINITY, INFINITY, INFINITY}};
static const struct neph_rgb white = {1, 1, 1};

static inline struct neph_rgb make_grey(double value)
{
    return (struct neph_rgb){value, value, value};
}

/* ---- random ---------------------------------------------------------------------------------- */

static inline struct neph_vec3 random_direction(uint64_t *seed)
{
    const double y = neph_test_uniform(seed, -1.0, 1.0);
    const double azimuth = neph_test_uniform(seed, 0.0, 2.0 * M_PI);
    const double across = sqrt(1.0 - y * y);
    return (struct neph_vec3){across * cos(azimuth), y, across * sin(azimuth)};
}

static inline struct neph_vec3 random_point(uint64_t *seed, double size_m)
{
    return (struct neph_vec3){neph_test_uniform(seed, -size_m, size_m),
                              neph_test_uniform(seed, -size_m, size_m),
                              neph_test_uniform(seed, -size_m, size_m)};
}

static inline struct neph_vec3 random_place_in(const struct neph_bounds *box, uint64_t *seed)
{
    return (struct neph_vec3){neph_test_uniform(seed, box->min_m.x, box->max_m.x),
                              neph_test_uniform(seed, box->min_m.y, box->max_m.y),
                              neph_test_uniform(seed, box->min_m.z, box->max_m.z)};
}

/* No density at `count` positions in a box exceeds its bound; returns the largest ratio to the
 * bound. */
static inline double assert_bound(const struct neph_medium *medium, const struct neph_bounds *box,
                                  int count, uint64_t *seed)
{
    const double bound_per_m = neph_medium_extinction_bound_per_m(medium, box);
    const uint64_t first = *seed;
    double densest_per_m = 0.0;
    for (int n = 0; n < count; n++)
        densest_per_m = fmax(densest_per_m,
                             neph_medium_extinction_per_m(medium, random_place_in(box, seed)));
    if (!(densest_per_m <= bound_per_m))
        fail_msg("seed %llu: %.17g > %.17g", (unsigned long long)first, densest_per_m, bound_per_m);
    return bound_per_m > 0.0 ? densest_per_m / bound_per_m : 0.0;
}

/* Nodes from `low` to 1; negative ones are empty. For neph_grid_destroy(). */
static inline struct neph_grid *random_lattice(const int size[3], struct neph_vec3 origin_m,
                                               struct neph_vec3 spacing_m, double low,
                                               uint64_t *seed)
{
    struct neph_grid *grid = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_grid_create(size, origin_m, spacing_m, &grid, &diag), &diag);
    for (int i = 0; i < size[0] * size[1] * size[2]; i++)
        grid->values[i] = (float)fmax(0.0, neph_test_uniform(seed, low, 1.0));
    neph_assert_ok(neph_grid_seal(grid, &diag), &diag);
    return grid;
}

/* ---- media ----------------------------------------------------------------------------------- */

static inline struct neph_medium make_medium(enum neph_medium_kind kind, double extinction_per_m)
{
    return (struct neph_medium){.kind = kind,
                                .bounds = everywhere,
                                .albedo = white,
                                .extinction_color = white,
                                .extinction_per_m = extinction_per_m};
}

/* Decreasing with height from y = 0 on. */
static inline struct neph_medium make_height_fog(double extinction_per_m, double falloff_per_m)
{
    struct neph_medium fog = make_medium(NEPH_MEDIUM_HEIGHT_FOG, 0.0);
    fog.layer_count = 1;
    fog.layers[0] = (struct neph_fog_layer){extinction_per_m, falloff_per_m, 0.0};
    return fog;
}

static inline struct neph_medium make_homogeneous(double extinction_per_m,
                                                  struct neph_bounds bounds)
{
    struct neph_medium medium = make_height_fog(extinction_per_m, 0.0);
    medium.kind = NEPH_MEDIUM_HOMOGENEOUS;
    medium.bounds = bounds;
    return medium;
}

static inline struct neph_medium make_blob(double extinction_per_m, struct neph_vec3 center_m,
                                           double width_m)
{
    struct neph_medium medium = make_medium(NEPH_MEDIUM_GAUSSIAN, extinction_per_m);
    medium.gaussian = (struct neph_gaussian){center_m, width_m};
    return medium;
}

static inline struct neph_medium make_shell(double extinction_per_m, struct neph_vec3 center_m,
                                            double radius_m, double scale_height_m)
{
    struct neph_medium medium = make_medium(NEPH_MEDIUM_SHELL, extinction_per_m);
    medium.shell = (struct neph_shell){center_m, radius_m, scale_height_m};
    return medium;
}

static inline struct neph_medium make_tent(double extinction_per_m, struct neph_tent tent)
{
    struct neph_medium medium = make_medium(NEPH_MEDIUM_TENT, extinction_per_m);
    medium.tent = tent;
    return medium;
}

/* The caller destroys the grid. */
static inline struct neph_medium make_voxels(double extinction_per_m, struct neph_grid *grid)
{
    struct neph_medium medium = make_medium(NEPH_MEDIUM_GRID, extinction_per_m);
    medium.grid = grid;
    return medium;
}

/* A field of cumulus from 600 m to 1800 m. */
static inline struct neph_horizon_params make_cumulus(void)
{
    struct neph_horizon_params params = neph_horizon_defaults();
    params.bottom_m = 600.0;
    params.thickness_m = 1200.0;
    params.texture_scale_m = 8e3;
    params.base_repeats = 9.0;
    params.detail_repeats = 27.0;
    return params;
}

/* The height within the layer, 0 at the bottom, 1 at the top, clamped; the article's ph. */
static inline double horizon_height(const struct neph_horizon *horizon, struct neph_vec3 point_m)
{
    const double altitude_m = neph_horizon_altitude_m(&horizon->params, point_m);
    return fmin(fmax(altitude_m / horizon->params.thickness_m, 0.0), 1.0);
}

/* ---- scenes ---------------------------------------------------------------------------------- */

static inline struct neph_solid make_box(double x0, double y0, double z0, double x1, double y1,
                                         double z1)
{
    return (struct neph_solid){.kind = NEPH_SOLID_BOX, .box = {{x0, y0, z0}, {x1, y1, z1}}};
}

static inline struct neph_solid make_sphere(double x, double y, double z, double radius_m)
{
    return (struct neph_solid){
        .kind = NEPH_SOLID_SPHERE, .center_m = {x, y, z}, .radius_m = radius_m};
}

/* One medium under a white sun of irradiance 1, single scattering. */
static inline struct neph_scene make_sunny(struct neph_medium medium, struct neph_vec3 sun)
{
    return (struct neph_scene){.scattering = NEPH_SCATTERING_SINGLE,
                               .sun = {true, neph_vec3_normalize(sun), white},
                               .medium_count = 1,
                               .media = {medium}};
}

/* A scene with storage for its solids and one camera key; it must outlive `scene`. */
struct test_scene {
    struct neph_scene scene;
    struct neph_camera_key key;
    struct neph_solid solids[16];
};

/* No media, no solids; the camera at 1.6 m looks along -Z; sun at 40 degrees, ahead and right. */
static inline void test_scene_init(struct test_scene *test)
{
    memset(test, 0, sizeof(*test));
    struct neph_scene *scene = &test->scene;
    test->key.position_m = (struct neph_vec3){0.0, 1.6, 0.0};
    test->key.look_at_m = (struct neph_vec3){0.0, 1.6, -10.0};
    scene->camera_key_count = 1;
    scene->camera_keys = &test->key;
    scene->camera_up = (struct neph_vec3){0.0, 1.0, 0.0};
    scene->vertical_fov_rad = 0.9;
    scene->frame_count = 1;
    scene->frame_rate_hz = 30.0;
    scene->sun.present = true;
    scene->sun.direction = neph_vec3_normalize((struct neph_vec3){0.5, 0.7, -0.6});
    scene->sun.irradiance_w_per_m2 = (struct neph_rgb){10.0, 9.0, 8.0};
    scene->background_w_per_m2_sr = (struct neph_rgb){0.1, 0.2, 0.4};
    scene->scattering = NEPH_SCATTERING_SINGLE;
    scene->solids = test->solids;
}

/* The same scene with the additions of `build`. */
static inline void test_scene_build(struct test_scene *test, void (*build)(struct test_scene *test))
{
    test_scene_init(test);
    build(test);
}

static inline struct neph_medium *test_add(struct test_scene *test, struct neph_medium medium)
{
    struct neph_medium *added = &test->scene.media[test->scene.medium_count++];
    *added = medium;
    return added;
}

/* Reddish, forward scattering. */
static inline struct neph_medium *
test_add_cloud(struct test_scene *test, enum neph_medium_kind kind, double extinction_per_m)
{
    struct neph_medium *medium = test_add(test, make_medium(kind, extinction_per_m));
    medium->albedo = (struct neph_rgb){0.9, 0.8, 0.7};
    medium->phase = (struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN, 0.4};
    return medium;
}

static inline struct neph_medium *test_add_medium(struct test_scene *test, double extinction_per_m,
                                                  double falloff_per_m, double height_m)
{
    struct neph_medium *medium = test_add_cloud(
        test, falloff_per_m > 0.0 ? NEPH_MEDIUM_HEIGHT_FOG : NEPH_MEDIUM_HOMOGENEOUS, 0.0);
    medium->layer_count = 1;
    medium->layers[0] = (struct neph_fog_layer){extinction_per_m, falloff_per_m, height_m};
    return medium;
}

static inline void test_add_layer(struct neph_medium *medium, double extinction_per_m,
                                  double falloff_per_m, double height_m)
{
    medium->layers[medium->layer_count++] = (struct neph_fog_layer){extinction_per_m, falloff_per_m,
                                                                    height_m};
}

static inline void test_add_box(struct test_scene *test, struct neph_vec3 min_m,
                                struct neph_vec3 max_m)
{
    test->solids[test->scene.solid_count++] = (struct neph_solid){
        .kind = NEPH_SOLID_BOX, .box = {min_m, max_m}, .albedo = {0.5, 0.4, 0.3}};
}

static inline void test_add_sphere(struct test_scene *test, struct neph_vec3 center_m,
                                   double radius_m)
{
    test->solids[test->scene.solid_count++] = (struct neph_solid){.kind = NEPH_SOLID_SPHERE,
                                                                  .center_m = center_m,
                                                                  .radius_m = radius_m,
                                                                  .albedo = {0.5, 0.4, 0.3}};
}

#endif
