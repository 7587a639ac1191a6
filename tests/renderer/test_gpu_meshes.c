/* SPDX-License-Identifier: MIT
 *
 * Triangle meshes on the device. Rays through vertices and edges do not leak; distances and
 * sunlight equal those in double precision; a convex mesh does not hide itself; and what a device
 * cannot do is an error.
 *
 * A device rounds positions to float32. So a pixel is compared with exact rays around its own,
 * displaced by this rounding: where they differ, at edges and silhouettes, each of them is right.
 */
#include "tests/mesh_builders.h"
#include "tests/renderer/sequence_test.h"

#include "renderer/gpu_scene.h"
#include "scenes/solids.h"

/* The rounding of a position on a device, relative to its size: half a unit of the last of 24 bits,
 * for each of some four operations. */
static const double position_rounding = 0x1p-22;

/* --- meshes ---------------------------------------------------------------------------------- */

/* The number of a vertex, a new one if there is none at this position. */
static int find_vertex(struct neph_mesh_data *data, struct neph_vec3 position)
{
    int v = 0;
    while (v < data->vertex_count &&
           (data->positions[v].x != position.x || data->positions[v].y != position.y ||
            data->positions[v].z != position.z))
        v++;
    data->positions[v] = position;
    data->vertex_count += v == data->vertex_count;
    return v;
}

static struct neph_vec3 find_middle(struct neph_vec3 a, struct neph_vec3 b)
{
    return neph_vec3_normalize(neph_vec3_add(a, b));
}

static void add_patch(struct neph_mesh_data *data, struct neph_vec3 a, struct neph_vec3 b,
                      struct neph_vec3 c, int levels)
{
    if (levels == 0) {
        const int triangle = data->triangle_count++;
        set_triangle(data, triangle, find_vertex(data, a), find_vertex(data, b),
                     find_vertex(data, c));
        return;
    }
    const struct neph_vec3 ab = find_middle(a, b), bc = find_middle(b, c), ca = find_middle(c, a);
    add_patch(data, a, ab, ca, levels - 1);
    add_patch(data, b, bc, ab, levels - 1);
    add_patch(data, c, ca, bc, levels - 1);
    add_patch(data, ab, bc, ca, levels - 1);
}

/* A sphere of radius 1: an icosahedron, with each triangle cut into 4 `levels` times. */
static struct neph_mesh_data make_icosphere(int levels)
{
    static const double g = 1.618033988749895;
    static const struct neph_vec3 corners[12] = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                                                 {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                                                 {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
    static const int faces[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                     {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                     {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                     {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    const int pieces = 1 << 2 * levels;
    struct neph_mesh_data data = allocate_mesh(10 * pieces + 2, 20 * pieces);
    data.vertex_count = data.triangle_count = 0;
    for (int f = 0; f < 20; f++)
        add_patch(&data, neph_vec3_normalize(corners[faces[f][0]]),
                  neph_vec3_normalize(corners[faces[f][1]]),
                  neph_vec3_normalize(corners[faces[f][2]]), levels);
    assert_int_equal(data.vertex_count, 10 * pieces + 2);
    return data;
}

/* Turns all vertices about a random axis, and scales them. */
static void place_at_random(struct neph_mesh_data *data, double radius, uint64_t *seed)
{
    const struct neph_vec3 z = random_direction(seed);
    const struct neph_vec3 x = neph_vec3_normalize(neph_vec3_cross(z, random_direction(seed)));
    const struct neph_vec3 y = neph_vec3_cross(z, x);
    for (int v = 0; v < data->vertex_count; v++) {
        const struct neph_vec3 p = neph_vec3_scale(data->positions[v], radius), none = {0, 0, 0};
        data->positions[v] = neph_vec3_along(neph_vec3_along(neph_vec3_along(none, x, p.x), y, p.y),
                                             z, p.z);
    }
}

/* A solid of a mesh, of which the scene has only this one. */
static struct neph_solid *add_instance(struct test_scene *test, struct neph_mesh **mesh)
{
    struct neph_solid *solid = &test->solids[test->scene.solid_count++];
    *solid = (struct neph_solid){
        .kind = NEPH_SOLID_MESH, .mesh = *mesh, .scale_m = 1.0, .albedo = {0.5, 0.4, 0.3}};
    test->scene.meshes = mesh;
    test->scene.mesh_count = 1;
    return solid;
}

/* --- frames ---------------------------------------------------------------------------------- */

enum { SIDE = 64, PIXELS = SIDE * SIDE };

enum device_engine { MARCH, TRACER, DEVICE_ENGINES };

static struct neph_image *render(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                 enum device_engine engine)
{
    const struct neph_march_params march = {.width_px = SIDE, .height_px = SIDE, .steps = 1};
    const struct neph_tracer_params tracer = test_samples(SIDE, SIDE, 1, NEPH_TRACER_BATCH_SAMPLES);
    return engine == MARCH ? test_march(vulkan, scene, &march, NULL)
                           : test_trace(vulkan, scene, &tracer, NULL);
}

/* --- exact rays ------------------------------------------------------------------------------ */

enum { AROUND = 9 };

/* The exact light on rays around that of a pixel, displaced by the rounding of positions. */
struct exact_pixel {
    struct neph_ray_light rays[AROUND];
    double depth_per_m; /* the depth of a point, per metre of its ray */
    double rounding_m;
};

/* `sizes_m`: coordinates that a device computes with, beside the distance of the hit. */
static struct exact_pixel find_exact(const struct neph_scene *scene, double sizes_m, int pixel)
{
    const struct neph_camera camera = neph_scene_camera(scene, 0.0);
    const struct neph_pixel_ray ray = test_ray(scene, SIDE, SIDE, pixel);
    struct exact_pixel made = {.depth_per_m = neph_vec3_dot(ray.direction, camera.forward)};
    made.rays[0] = neph_transport_ray(scene, ray.origin_m, ray.direction);
    const double hit_m = made.rays[0].hit_m;
    made.rounding_m = position_rounding * (sizes_m + (isfinite(hit_m) ? hit_m : 0.0));
    for (int i = 1; i < AROUND; i++) {
        const double angle_rad = 2.0 * M_PI * i / (AROUND - 1);
        const struct neph_vec3 from_m = neph_vec3_along(
            neph_vec3_along(ray.origin_m, camera.right, made.rounding_m * cos(angle_rad)),
            camera.up, made.rounding_m * sin(angle_rad));
        made.rays[i] = neph_transport_ray(scene, from_m, ray.direction);
    }
    return made;
}

/* Whether a depth is on one of the rays, or between two of them on a grazed surface. */
static bool is_depth_exact(const struct exact_pixel *exact, double z_m, double relative_to_m)
{
    const double own_m = exact->rays[0].hit_m * exact->depth_per_m;
    const double allowed_m = 2e-6 * relative_to_m + exact->rounding_m;
    for (int i = 0; i < AROUND; i++) {
        const double other_m = exact->rays[i].hit_m * exact->depth_per_m;
        const bool is_jump = !(fabs(other_m - own_m) <= 1000.0 * exact->rounding_m);
        const double from_m = is_jump ? other_m : fmin(own_m, other_m);
        const double to_m = is_jump ? other_m : fmax(own_m, other_m);
        if (isinf(other_m) ? isinf(z_m) : z_m >= from_m - allowed_m && z_m <= to_m + allowed_m)
            return true;
    }
    return false;
}

static void assert_depths(const struct neph_scene *scene, const struct neph_image *frame,
                          double sizes_m)
{
    const float *z_m = neph_image_channel(frame, "Z");
    for (int p = 0; p < PIXELS; p++) {
        const struct exact_pixel exact = find_exact(scene, sizes_m, p);
        const double hit_m = exact.rays[0].hit_m;
        if (!is_depth_exact(&exact, (double)z_m[p], sizes_m + (isfinite(hit_m) ? hit_m : 0.0)))
            fail_msg("pixel (%d, %d): Z is %.9g m, expected %.9g m", p % SIDE, p / SIDE,
                     (double)z_m[p], hit_m * exact.depth_per_m);
    }
}

static int count_sky(const struct neph_image *frame)
{
    const float *z_m = neph_image_channel(frame, "Z");
    int count = 0;
    for (int p = 0; p < PIXELS; p++)
        count += isinf(z_m[p]) != 0;
    return count;
}

/* --- leaks ----------------------------------------------------------------------------------- */

/* Lengths in radii of the mesh. */
static const struct {
    const char *name;
    double away, fov_rad, height;
    int levels; /* edges are some pixels long */
    bool is_inside;
} views[] = {
    {"inside", 0.2, 1.5, 0.0, 3, true},
    {"inside, orthographic", 0.2, 0.0, 0.9, 4, true},
    {"outside", 3.0, 0.75, 0.0, 3, false},
    {"outside, orthographic", 3.0, 0.0, 2.2, 3, false},
};

static void set_view(struct test_scene *test, size_t view, double radius_m, uint64_t *seed)
{
    const struct neph_vec3 away = random_direction(seed);
    test_scene_init(test);
    test->key.position_m = neph_vec3_scale(away, views[view].away * radius_m);
    test->key.look_at_m = neph_vec3_scale(away, (views[view].away - 1.0) * radius_m);
    test->scene.vertical_fov_rad = views[view].fov_rad;
    test->scene.orthographic_height_m = views[view].height * radius_m;
}

/* Moves vertices onto the rays of pixels with even numbers, one each, at their depth. The pixel in
 * the middle between two such vertices is on the edge between them. Only where a ray meets the
 * sphere steeply: elsewhere this would fold the mesh. */
static int move_to_rays(const struct neph_scene *scene, bool is_inside, struct neph_mesh_data *data)
{
    const struct neph_camera camera = neph_scene_camera(scene, 0.0);
    bool is_taken[PIXELS] = {false};
    int moved = 0;
    for (int v = 0; v < data->vertex_count; v++) {
        struct neph_point_in_frame at;
        if (!neph_camera_find_pixel(&camera, SIDE, SIDE, data->positions[v], &at))
            continue;
        const double i = 2.0 * round(0.5 * at.i), j = 2.0 * round(0.5 * at.j);
        const int pixel = (int)(j * SIDE + i);
        if (!(i >= 0.0 && j >= 0.0 && i < SIDE && j < SIDE && at.depth_m > 0.0) || is_taken[pixel])
            continue;
        const struct neph_pixel_ray ray = neph_camera_ray(&camera, SIDE, SIDE, i, j);
        const double depth_per_m = neph_vec3_dot(ray.direction, camera.forward);
        const double cosine = neph_vec3_dot(ray.direction, neph_vec3_normalize(data->positions[v]));
        if (!(is_inside ? cosine > 0.7 : cosine < -0.7))
            continue;
        is_taken[pixel] = true;
        data->positions[v] = neph_vec3_along(ray.origin_m, ray.direction, at.depth_m / depth_per_m);
        moved++;
    }
    return moved;
}

static void test_no_ray_leaves_a_closed_mesh(void **state)
{
    uint64_t seed = 14142;
    for (size_t trial = 0; trial < COUNT(views) * (size_t)neph_test_by_day(1, 20); trial++) {
        const size_t view = trial % COUNT(views);
        struct test_scene test;
        const uint64_t first = seed;
        const double radius_m = pow(10.0, neph_test_uniform(&seed, -2.0, 3.0));
        struct neph_mesh_data data = make_icosphere(views[view].levels);
        place_at_random(&data, radius_m, &seed);
        set_view(&test, view, radius_m, &seed);
        const int moved = move_to_rays(&test.scene, views[view].is_inside, &data);
        OWNED(mesh) struct neph_mesh *mesh = finish_mesh(data);
        add_instance(&test, &mesh);
        for (int engine = MARCH; engine < (trial == 0 ? DEVICE_ENGINES : TRACER); engine++) {
            OWNED(image) struct neph_image *frame = render(*state, &test.scene, engine);
            const int sky = count_sky(frame);
            print_message("%s, seed %llu, radius %.3g m: rays meet %d vertices; %d pixels of sky\n",
                          views[view].name, (unsigned long long)first, radius_m, moved, sky);
            assert_true(moved > 40);
            assert_true(views[view].is_inside ? sky == 0 : sky > PIXELS / 20 && sky < PIXELS / 2);
            assert_depths(&test.scene, frame, (1.0 + views[view].away) * radius_m);
        }
    }
}

/* A grid of SIDE / step squares across the view and around it, seen along -z from the height 64 m.
 * Vertices are at multiples of 1 / 64 m, which float32 has exactly. */
static struct neph_mesh_data make_grid(int step, uint64_t *seed)
{
    const int row = SIDE / step + 3;
    struct neph_mesh_data data = make_hills(row - 1, 1.0, 0.0);
    for (int v = 0; v < row * row; v++) {
        const int i = step * (v % row - 1), j = step * (v / row - 1);
        data.positions[v] = (struct neph_vec3){i + 0.5 - SIDE / 2, SIDE / 2 - j - 0.5,
                                               round(64.0 * neph_test_uniform(seed, -4.0, 4.0)) /
                                                   64.0};
    }
    return data;
}

static void test_no_ray_passes_between_triangles_of_a_grid(void **state)
{
    uint64_t seed = 17320;
    for (int step = 1; step <= 2; step++) {
        struct test_scene test;
        OWNED(mesh) struct neph_mesh *mesh = finish_mesh(make_grid(step, &seed));
        test_scene_init(&test);
        test.scene.vertical_fov_rad = 0.0;
        test.scene.orthographic_height_m = SIDE;
        test.key.position_m = (struct neph_vec3){0, 0, 64};
        test.key.look_at_m = (struct neph_vec3){0, 0, 0};
        add_instance(&test, &mesh);
        OWNED(image) struct neph_image *frame = render(*state, &test.scene, MARCH);
        const float *z_m = neph_image_channel(frame, "Z");
        assert_int_equal(count_sky(frame), 0);
        assert_depths(&test.scene, frame, 64.0);
        for (int p = 0; p < PIXELS; p++)
            if (p % SIDE % step == 0 && p / SIDE % step == 0) {
                const int vertex = (p / SIDE / step + 1) * (SIDE / step + 3) + p % SIDE / step + 1;
                neph_assert_close((double)z_m[p], 64.0 - mesh->data.positions[vertex].z, 2e-6, 0);
            }
    }
}

/* Triangles in the planes of the rays of rows of pixels, which a device need not meet, in the
 * columns COLUMN to SIDE - COLUMN. */
enum { ROWS = 8, COLUMN = 24 };

static struct neph_mesh *make_edge_on(const struct neph_camera *camera, uint64_t *seed)
{
    struct neph_mesh_data data = allocate_mesh(3 * ROWS, ROWS);
    for (int v = 0; v < 3 * ROWS; v++) {
        const double i = neph_test_uniform(seed, COLUMN, SIDE - COLUMN);
        const double t_m = neph_test_uniform(seed, 20.0, 40.0);
        const struct neph_pixel_ray ray = neph_camera_ray(camera, SIDE, SIDE, i,
                                                          SIDE / ROWS * (v / 3));
        data.positions[v] = neph_vec3_along(ray.origin_m, ray.direction, t_m);
    }
    for (int i = 0; i < ROWS; i++)
        set_triangle(&data, i, 3 * i, 3 * i + 1, 3 * i + 2);
    return finish_mesh(data);
}

static void test_no_ray_meets_a_triangle_beside_it(void **state)
{
    uint64_t seed = 77;
    for (int trial = 0; trial < 40; trial++) {
        struct test_scene test;
        const uint64_t first = seed;
        test_scene_init(&test);
        test.scene.vertical_fov_rad = trial % 2 ? 0.6 : 0.0;
        test.scene.orthographic_height_m = trial % 2 ? 0.0 : 20.0;
        test.key.position_m = random_point(&seed, 30.0);
        test.key.look_at_m = neph_vec3_add(test.key.position_m, random_direction(&seed));
        const struct neph_camera camera = neph_scene_camera(&test.scene, 0.0);
        OWNED(mesh) struct neph_mesh *mesh = make_edge_on(&camera, &seed);
        add_instance(&test, &mesh);
        OWNED(image) struct neph_image *frame = render(*state, &test.scene, MARCH);
        const float *z_m = neph_image_channel(frame, "Z");
        for (int p = 0; p < PIXELS; p++)
            if ((p % SIDE < COLUMN || p % SIDE > SIDE - COLUMN) && isfinite(z_m[p]))
                fail_msg("seed %llu: pixel (%d, %d) is beside the triangles",
                         (unsigned long long)first, p % SIDE, p / SIDE);
    }
}

/* --- sunlight -------------------------------------------------------------------------------- */

/* The size of a mesh over the lowest height of its triangles. */
static double find_slimness(const struct neph_mesh *mesh)
{
    const struct neph_mesh_data *data = &mesh->data;
    double low = INFINITY, size = 0.0;
    for (int i = 0; i < data->triangle_count; i++) {
        const struct neph_vec3 a = data->positions[data->triangles[i][0]];
        const struct neph_vec3 b = neph_vec3_sub(data->positions[data->triangles[i][1]], a);
        const struct neph_vec3 c = neph_vec3_sub(data->positions[data->triangles[i][2]], a);
        const double longest = fmax(neph_vec3_length(neph_vec3_sub(b, c)),
                                    fmax(neph_vec3_length(b), neph_vec3_length(c)));
        low = fmin(low, neph_vec3_length(neph_vec3_cross(b, c)) / longest);
        size = fmax(size, neph_vec3_length(neph_vec3_sub(a, data->positions[0])));
    }
    return size / low;
}

/* The rounding of a reflected radiance, relative to a white surface that faces the sun: some eight
 * roundings of numbers up to 1, and the turn of a triangle's normal. Both ends of the triangle's
 * height move by up to sqrt(3) / 2 roundings of the size of the mesh, whose coordinates are from
 * its middle. */
static double find_light_rounding(const struct neph_mesh *mesh)
{
    return 0x1p-24 * (8.0 + sqrt(3.0) * find_slimness(mesh));
}

static double find_light_error(const struct neph_scene *scene, const struct exact_pixel *exact,
                               const struct test_rgb *found, int pixel)
{
    const struct neph_rgb sun = scene->sun.irradiance_w_per_m2;
    double least = INFINITY;
    for (int i = 0; i < AROUND; i++) {
        const struct neph_rgb expected = exact->rays[i].radiance;
        const double error = fmax(fabs((double)found->of[0][pixel] - expected.r) / sun.r,
                                  fmax(fabs((double)found->of[1][pixel] - expected.g) / sun.g,
                                       fabs((double)found->of[2][pixel] - expected.b) / sun.b));
        least = fmin(least, M_PI * error);
    }
    return least;
}

/* Depths and radiances of all pixels, also at silhouettes and beside shadow. Returns the number of
 * sunlit ones. */
static int assert_frame(const struct neph_scene *scene, const struct neph_image *frame,
                        double sizes_m)
{
    const struct test_rgb radiance = test_layer(frame, NULL);
    const double allowed = find_light_rounding(scene->meshes[0]);
    double worst = 0.0;
    int lit = 0;
    assert_depths(scene, frame, sizes_m);
    for (int p = 0; p < PIXELS; p++) {
        const struct exact_pixel exact = find_exact(scene, sizes_m, p);
        const double error = find_light_error(scene, &exact, &radiance, p);
        if (!(error <= allowed))
            fail_msg("pixel (%d, %d): radiance is %.9g, expected %.9g; off by %.2g, allowed %.2g",
                     p % SIDE, p / SIDE, (double)radiance.of[1][p], exact.rays[0].radiance.g, error,
                     allowed);
        worst = fmax(worst, error);
        lit += isfinite(exact.rays[0].hit_m) && exact.rays[0].radiance.g > 0.0;
    }
    print_message("%d sunlit pixels, largest error %.1e of %.1e\n", lit, worst, allowed);
    return lit;
}

static struct neph_mesh *make_body(int levels, struct neph_vec3 sides, struct neph_vec3 middle)
{
    struct neph_mesh_data data = make_icosphere(levels);
    for (int v = 0; v < data.vertex_count; v++) {
        struct neph_vec3 *p = &data.positions[v];
        *p = (struct neph_vec3){middle.x + sides.x * p->x, middle.y + sides.y * p->y,
                                middle.z + sides.z * p->z};
    }
    return finish_mesh(data);
}

/* One instance is 5e5 m from the world's origin, near the camera, and the other at the origin. */
static void test_instances_far_apart(void **state)
{
    const struct neph_vec3 sides = {1, 0.6, 1.5}, middle = {0.5, -0.3, 1};
    OWNED(mesh) struct neph_mesh *mesh = make_body(2, sides, middle);
    for (int engine = MARCH; engine < DEVICE_ENGINES; engine++) {
        struct test_scene test;
        test_scene_init(&test);
        test.key.position_m = (struct neph_vec3){5e5, 1e3, 0};
        test.key.look_at_m = (struct neph_vec3){0, 1e3, 0};
        test.scene.sun.direction = neph_vec3_normalize((struct neph_vec3){0.8, 0.5, 0.6});
        struct neph_solid *near = add_instance(&test, &mesh), *far = add_instance(&test, &mesh);
        near->center_m = (struct neph_vec3){5e5 - 40.0, 1e3, 8.0};
        near->scale_m = 5.0;
        near->yaw = (struct neph_turn){1, cos(0.7), sin(0.7)};
        far->scale_m = 7e4;
        far->center_m = (struct neph_vec3){0, 0, -1.2e5};
        far->albedo = (struct neph_rgb){0.2, 0.9, 0.4};
        far->yaw = (struct neph_turn){1, cos(-2.0), sin(-2.0)};
        far->turn = (struct neph_turn){2, cos(1.1), sin(1.1)};
        OWNED(image) struct neph_image *frame = render(*state, &test.scene, engine);
        assert_true(assert_frame(&test.scene, frame, 5e5) > 400);
    }
}

/* A convex body that the sun grazes, where a rounded point is behind the triangles beside its own,
 * bodies of long triangles, and one far from the camera. */
static void test_a_convex_mesh_does_not_hide_itself_from_the_sun(void **state)
{
    static const struct {
        int levels;
        struct neph_vec3 sides;
        double away; /* of the camera */
        bool is_grazed;
    } bodies[] = {{2, {1, 1, 1}, 3.0, false},
                  {4, {1, 0.02, 1}, 1000.0, true},
                  {2, {1, 1, 1}, 1000.0, false},
                  {2, {1, 0.01, 1}, 3.0, false},
                  {2, {0.05, 4, 1}, 9.0, false}};
    static const struct neph_vec3 middle = {0, 0, 0}, oblique = {0.3, 0.9, 0.4};
    uint64_t seed = 22360;
    int lit = 0;
    for (size_t b = 0; b < COUNT(bodies); b++) {
        struct test_scene test;
        OWNED(mesh) struct neph_mesh *mesh = make_body(bodies[b].levels, bodies[b].sides, middle);
        print_message("seed %llu: ", (unsigned long long)seed);
        const struct neph_vec3 away = bodies[b].is_grazed ? neph_vec3_normalize(oblique)
                                                          : random_direction(&seed);
        const struct neph_vec3 sun = neph_vec3_along(random_direction(&seed), away, 0.3);
        test_scene_init(&test);
        test.key.position_m = neph_vec3_scale(away, bodies[b].away);
        test.key.look_at_m = middle;
        test.scene.vertical_fov_rad = 2.0 * atan(1.1 / bodies[b].away);
        test.scene.sun.direction = neph_vec3_normalize(
            bodies[b].is_grazed ? (struct neph_vec3){1, 0.02, 0.2} : sun);
        add_instance(&test, &mesh);
        for (int engine = MARCH; engine < (b == 0 ? DEVICE_ENGINES : TRACER); engine++) {
            OWNED(image) struct neph_image *frame = render(*state, &test.scene, engine);
            lit += assert_frame(&test.scene, frame, bodies[b].away + 4.0);
        }
    }
    assert_true(lit > 2 * PIXELS);
}

/* --- limits ---------------------------------------------------------------------------------- */

/* A wall behind and a roof above, and slivers along the diagonal of the box around both, which no
 * ray of the fog's light comes near; but all rays meet their boxes. */
static struct neph_mesh *make_slivers(int count, uint64_t *seed)
{
    static const struct neph_vec3 low = {-10, -18, -20}, high = {10, 2, 0};
    struct neph_mesh_data data = allocate_mesh(8 + 3 * count, 4 + count);
    for (int i = 0; i < 4; i++) {
        const double x = i & 1 ? high.x : low.x, y = i & 2 ? high.y : low.y;
        data.positions[i] = (struct neph_vec3){x, y, low.z};
        data.positions[4 + i] = (struct neph_vec3){x, high.y, i & 2 ? -10.0 : low.z};
    }
    for (int quad = 0; quad < 2; quad++) {
        set_triangle(&data, 2 * quad, 4 * quad, 4 * quad + 1, 4 * quad + 2);
        set_triangle(&data, 2 * quad + 1, 4 * quad + 1, 4 * quad + 3, 4 * quad + 2);
    }
    for (int i = 0; i < count; i++) {
        const int a = 8 + 3 * i;
        const double off = i == 0 ? 0.0 : neph_test_uniform(seed, 0.0, 0.01);
        data.positions[a] = neph_vec3_along(low, (struct neph_vec3){1, 1, 1}, off);
        data.positions[a + 1] = neph_vec3_along(high, (struct neph_vec3){1, 1, 1}, -off);
        data.positions[a + 2] = neph_vec3_add((struct neph_vec3){0, -8, -10},
                                              random_point(seed, 0.1));
        set_triangle(&data, 4 + i, a, a + 1, a + 2);
    }
    return finish_mesh(data);
}

static void set_foggy_view(struct test_scene *test, struct neph_mesh **mesh)
{
    test_scene_init(test);
    test_add_medium(test, 0.05, 0.05, 0.0);
    test->key.position_m = (struct neph_vec3){0, 0, 5};
    test->key.look_at_m = (struct neph_vec3){0, 0, -5};
    test->scene.vertical_fov_rad = 0.1;
    test->scene.sun.direction = neph_vec3_normalize((struct neph_vec3){0.02, 1, 0.05});
    add_instance(test, mesh);
}

/* Where a walk through a mesh is left before its end, the frame is an error; all other frames are
 * as without slivers, to the last bit. */
static void test_a_walk_that_is_left_is_an_error(void **state)
{
    static const int counts[] = {1, 300, 400, 500, 600, 700, 800, 1000, 2000, 40000};
    const struct neph_vulkan *vulkan = *state;
    const struct neph_march_params params = {.width_px = 4, .height_px = 2, .steps = 64};
    OWNED(image) struct neph_image *first = NULL;
    uint64_t seed = 26457;
    int refused = 0;
    for (size_t i = 0; i < COUNT(counts); i++) {
        struct test_scene test;
        struct neph_diag diag = {0};
        OWNED(image) struct neph_image *frame = NULL;
        OWNED(mesh) struct neph_mesh *mesh = make_slivers(counts[i], &seed);
        set_foggy_view(&test, &mesh);
        const enum neph_status status = test_march_frame(*state, &test.scene, &params, &frame, NULL,
                                                         &diag);
        print_message("%d slivers: %s\n", counts[i], status ? diag.message : "a frame");
        if (status) {
            assert_int_equal(status, NEPH_ERR_UNSUPPORTED);
            assert_non_null(strstr(diag.message, "rays meet too many boxes"));
            assert_null(frame);
            refused++;
        } else if (i == 0) {
            first = frame;
            frame = NULL;
            assert_int_equal(neph_image_channel(first, "Z")[0] < 26.0f, 1);
        } else
            assert_same_bits(frame, first);
    }
    if (vulkan->description.is_cpu)
        neph_assert_in_range(refused, 1, COUNT(counts) - 2);
    else
        assert_int_equal(refused, 0);
}

/* The path kernel counts the iterations of its walks and ends a dispatch early: of a mesh that is
 * too much for the ray marcher's dispatches the tracer makes a frame, to the last bit as with a
 * dispatch for each segment. */
static void test_walks_end_a_dispatch_of_the_tracer(void **state)
{
    struct test_scene test;
    uint64_t seed = 26457;
    OWNED(mesh) struct neph_mesh *mesh = make_slivers(2000, &seed);
    set_foggy_view(&test, &mesh);
    test.scene.scattering = NEPH_SCATTERING_MULTIPLE;
    struct neph_tracer_params params = test_samples(4, 2, 1, NEPH_TRACER_BATCH_SAMPLES);
    OWNED(image) struct neph_image *frame = test_trace(*state, &test.scene, &params, NULL);
    params.dispatch_turns = 1;
    OWNED(image) struct neph_image *in_segments = test_trace(*state, &test.scene, &params, NULL);
    assert_same_bits(frame, in_segments);
    assert_true(neph_image_channel(frame, "R")[0] > 0.0f);
}

enum { CROWD = 8193, CROWD_CELLS = 256 }; /* over 2^13 instances of 2^17 triangles */

/* Hills, a quad, and a crowd of quads below its middle, where no ray meets them. */
struct crowd {
    struct test_scene test;
    struct neph_mesh *meshes[2];
    struct neph_solid solids[CROWD];
};

static void test_end_crowd(struct crowd **crowd)
{
    neph_mesh_destroy((*crowd)->meshes[0]);
    neph_mesh_destroy((*crowd)->meshes[1]);
    free(*crowd);
}

static struct crowd *make_crowd(void)
{
    struct crowd *crowd = calloc(1, sizeof(*crowd));
    assert_non_null(crowd);
    test_scene_init(&crowd->test);
    crowd->meshes[0] = finish_mesh(make_hills(CROWD_CELLS, 1.0, 0.1));
    crowd->meshes[1] = finish_mesh(make_hills(1, 1.0, 0.0));
    for (int i = 0; i < CROWD; i++)
        crowd->solids[i] = (struct neph_solid){.kind = NEPH_SOLID_MESH,
                                               .mesh = crowd->meshes[i > 0],
                                               .center_m = {0.0, -0.01, 0.0},
                                               .scale_m = 0.01,
                                               .albedo = {0.5, 0.4, 0.3}};
    for (int i = 0; i < CROWD; i += CROWD - 1) {
        crowd->solids[i].center_m = (struct neph_vec3){i == 0 ? 2.0 : 0.0, 0.0, 0.0};
        crowd->solids[i].scale_m = 1.0;
    }
    crowd->solids[0].albedo.g = 0.1;
    crowd->test.scene.solids = crowd->solids;
    crowd->test.scene.solid_count = CROWD;
    crowd->test.scene.meshes = crowd->meshes;
    crowd->test.scene.mesh_count = 2;
    crowd->test.key.position_m = (struct neph_vec3){1.0, 3.0, 0.1};
    crowd->test.key.look_at_m = (struct neph_vec3){1.0, 0.0, 0.0};
    return crowd;
}

/* Where numbers of hits are too few for the largest mesh in each place, hits are found all the
 * same: a crowd changes no bit of the hills and of the quad. */
static void test_hits_of_many_instances_are_found(void **state)
{
    OWNED(crowd) struct crowd *crowd = make_crowd();
    OWNED(image) struct neph_image *all = render(*state, &crowd->test.scene, MARCH);
    crowd->solids[1] = crowd->solids[CROWD - 1];
    crowd->test.scene.solid_count = 2;
    OWNED(image) struct neph_image *few = render(*state, &crowd->test.scene, MARCH);
    assert_same_bits(all, few);
    assert_true(count_sky(few) < PIXELS / 2);
}

static void test_more_triangles_than_numbers_are_refused(void **state)
{
    const struct neph_march_params params = {.width_px = 8, .height_px = 8, .steps = 1};
    struct neph_diag diag = {0};
    struct neph_image *frame = NULL;
    OWNED(crowd) struct crowd *crowd = make_crowd();
    for (int i = 0; i < CROWD; i++)
        crowd->solids[i].mesh = crowd->meshes[0];
    assert_int_equal(test_march_frame(*state, &crowd->test.scene, &params, &frame, NULL, &diag),
                     NEPH_ERR_UNSUPPORTED);
    assert_non_null(strstr(diag.message, "numbers for 2^30"));
}

/* --- motion ---------------------------------------------------------------------------------- */

enum { MOVING_FRAMES = 8, MOVING_SIDE = 40 }; /* each slot of frames in flight is used twice */

/* Hills at rest, and a box or the mesh of a box that moves and turns, in fog; the camera moves too.
 * The rays of no two pixels end at equal depths, which the anti-aliasing compares. A small box at
 * rest is turned as well, so that both scenes have the same kernels. */
struct moving {
    struct test_scene test;
    struct neph_camera_key cameras[2];
    struct neph_solid_key keys[2];
    struct neph_mover mover;
    struct neph_mesh *meshes[2];
};

static void test_end_moving(struct moving *moving)
{
    for (int i = 0; i < 2; i++)
        neph_mesh_destroy(moving->meshes[i]);
}

static void make_moving(struct moving *moving, bool is_mesh)
{
    static const struct neph_vec3 low_m = {-1.2, 0.6, -9.0}, high_m = {1.0, 2.4, -7.5};
    struct test_scene *test = &moving->test;
    test_scene_init(test);
    test_add_medium(test, 0.03, 0.05, 0.0);
    moving->meshes[0] = finish_mesh(make_hills(12, 30.0, 0.5));
    moving->meshes[1] = make_box_mesh(low_m, high_m);
    add_instance(test, &moving->meshes[0]);
    test_add_box(test, (struct neph_vec3){3.0, 0.5, -8.0}, (struct neph_vec3){3.5, 1.0, -7.5});
    test->solids[1].turn = (struct neph_turn){1, cos(0.3), sin(0.3)};
    if (is_mesh)
        *add_instance(test, &moving->meshes[1]) = put_mesh(moving->meshes[1]);
    else
        test_add_box(test, low_m, high_m);
    test->solids[2].albedo = (struct neph_rgb){0.5, 0.25, 1.0};
    test->solids[2].moves = true;
    test->scene.meshes = moving->meshes;
    test->scene.mesh_count = 2;
    moving->cameras[0] = moving->cameras[1] = test->key;
    moving->cameras[0].position_m.x = 0.3;
    moving->cameras[1].frame = MOVING_FRAMES;
    moving->cameras[1].position_m = (struct neph_vec3){1.1, 1.9, -0.5};
    test->scene.camera_keys = moving->cameras;
    test->scene.camera_key_count = 2;
    moving->keys[0] = (struct neph_solid_key){0, {0, 0, 0}, 0.1};
    moving->keys[1] = (struct neph_solid_key){MOVING_FRAMES, {0.9, 0.5, 0.4}, 1.1};
    moving->mover = (struct neph_mover){2, 1, 2, {0, 1.0, -8.0}, 2, moving->keys};
    test->scene.movers = &moving->mover;
    test->scene.mover_count = 1;
    test->scene.frame_count = MOVING_FRAMES + 1;
}

/* The mean difference of a channel is below `mean` of its mean: rounding of float32, of distances
 * and of the light that follows from them. */
static void assert_near(const struct neph_image *a, const struct neph_image *b, double mean)
{
    static const char *const channels[] = {"R", "G", "B", "transmittance.G"};
    for (size_t i = 0; i < COUNT(channels); i++) {
        const double distance = test_distance(a, b, channels[i]);
        if (!(distance < mean))
            fail_msg("channel %s: the mean differs by %.2g", channels[i], distance);
    }
}

/* The frames of one ray marcher in flight, and of one that begins with the last frame. */
static void test_a_mesh_moves_as_a_box_in_the_march(void **state)
{
    const struct neph_march_params params = {
        .width_px = MOVING_SIDE, .height_px = MOVING_SIDE, .steps = 8, .sun_steps = 1};
    OWNED(image) struct neph_image *box = NULL, *mesh = NULL, *alone = NULL;
    struct neph_diag diag = {0};
    for (int is_mesh = 0; is_mesh < 2; is_mesh++) {
        struct neph_image **image = is_mesh ? &mesh : &box;
        OWNED(moving) struct moving moving;
        make_moving(&moving, is_mesh);
        OWNED(march)
        struct neph_march *march = test_march_open(*state, &moving.test.scene, &params);
        for (int frame = 0; frame <= MOVING_FRAMES; frame++) {
            OWNED(scene) struct neph_scene *still = test_still(&moving.test.scene, frame);
            neph_assert_ok(neph_march_frame(march, still, frame, NULL,
                                            frame == MOVING_FRAMES ? image : NULL, NULL, &diag),
                           &diag);
        }
        OWNED(scene) struct neph_scene *last = test_still(&moving.test.scene, MOVING_FRAMES);
        if (is_mesh)
            alone = test_march(*state, last, &params, NULL);
    }
    assert_near(mesh, box, 1e-7);
    assert_same_bits(alone, mesh);
}

/* Frames that are read back, of the box and of its mesh; and the last of frames of the mesh in
 * flight. Colours are stored in half precision, whose rounding hides that of float32, but for a few
 * pixels. */
static void test_a_mesh_moves_as_a_box_in_realtime(void **state)
{
    const struct neph_settings settings = test_preset(
        "off", "steps=4 ray_dither=none upscale_dither=none split=four taa=on");
    struct neph_realtime *read[2], *sent;
    struct moving moving[2];
    struct neph_diag diag = {0};
    struct neph_image *frames[2] = {NULL};
    for (int is_mesh = 0; is_mesh < 2; is_mesh++) {
        make_moving(&moving[is_mesh], is_mesh);
        read[is_mesh] = test_sequence(*state, &moving[is_mesh].test.scene, &settings, MOVING_SIDE,
                                      MOVING_SIDE);
    }
    sent = test_sequence(*state, &moving[1].test.scene, &settings, MOVING_SIDE, MOVING_SIDE);
    for (int frame = 0; frame <= MOVING_FRAMES; frame++) {
        const struct neph_realtime_frame next = {&moving[1].test.scene, frame, NULL};
        for (int is_mesh = 0; is_mesh < 2; is_mesh++) {
            neph_image_destroy(frames[is_mesh]);
            frames[is_mesh] = test_next(read[is_mesh], &moving[is_mesh].test.scene, frame, NULL);
        }
        assert_near(frames[1], frames[0], 1e-6);
        if (frame < MOVING_FRAMES)
            neph_assert_ok(neph_realtime_render(sent, &next, NULL, NULL, &diag), &diag);
    }
    OWNED(image)
    struct neph_image *last = test_next(sent, &moving[1].test.scene, MOVING_FRAMES, NULL);
    assert_same_bits(last, frames[1]);
    neph_realtime_destroy(sent);
    for (int i = 0; i < 2; i++) {
        neph_realtime_destroy(read[i]);
        neph_image_destroy(frames[i]);
        test_end_moving(&moving[i]);
    }
}

/* The places of hills at rest do not depend on the frame, so their depths keep their bits; and they
 * move with the world (by a power of two, so that all its coordinates are exact). */
static void test_a_mesh_at_rest_keeps_its_bits(void **state)
{
    const struct neph_vec3 eye_m = {0, 1, 0}, by_m = {0x1p20, 0, 0};
    uint32_t(*words[2])[4] = {NULL};
    struct moving moving;
    struct neph_diag diag = {0};
    (void)state;
    make_moving(&moving, true);
    for (int i = 0; i < 2; i++) {
        OWNED(scene) struct neph_scene *still = test_still(&moving.test.scene, 3.0 * i);
        const struct neph_gpu_meshes place = neph_gpu_meshes_place(still, eye_m);
        const struct neph_gpu_meshes other = neph_gpu_meshes_place(&moving.test.scene, eye_m);
        words[i] = calloc(neph_gpu_mesh_place_words(still), sizeof(*words[i]));
        neph_assert_ok(neph_gpu_mesh_places_write(still, eye_m, words[i], &diag), &diag);
        assert_memory_equal(place.origin_m, other.origin_m, sizeof(place.origin_m));
        assert_int_equal(place.instances, NEPH_GPU_MESH_PLACES_FIRST + 12);
        neph_scene_shift(still, by_m);
        const struct neph_gpu_meshes far = neph_gpu_meshes_place(still, neph_vec3_add(eye_m, by_m));
        assert_memory_equal(far.origin_m, other.origin_m, sizeof(far.origin_m));
        assert_float_equal(far.reach_m, place.reach_m, 1e-5);
    }
    /* Six words are an instance, the first behind the nodes. */
    assert_memory_equal(words[0][12], words[1][12], 6 * sizeof(words[0][0]));
    assert_memory_not_equal(words[0][18], words[1][18], 6 * sizeof(words[0][0]));
    free(words[0]);
    free(words[1]);
    test_end_moving(&moving);
}

/* Each of three frames in flight has its own memory, and a frame whose solids are those of the
 * frame before submits nothing. */
static void test_places_are_copied_where_solids_move(void **state)
{
    struct neph_gpu_scene gpu = {.frame = NULL};
    OWNED(moving) struct moving moving;
    struct neph_diag diag = {0};
    VkBuffer used[MOVING_FRAMES];
    make_moving(&moving, true);
    moving.keys[1].frame = MOVING_FRAMES - 2;
    neph_assert_ok(neph_gpu_scene_create(*state, &moving.test.scene, 0.0, 8, 8, false, &gpu, &diag),
                   &diag);
    for (int frame = 0; frame < MOVING_FRAMES; frame++) {
        OWNED(scene) struct neph_scene *still = test_still(&moving.test.scene, frame);
        const uint64_t sent = neph_batches_submitted(*state);
        neph_assert_ok(neph_gpu_scene_update(*state, &gpu, still, frame, 8, 8, NULL, &diag), &diag);
        used[frame] = gpu.mesh_motion.places.handle;
        assert_int_equal(neph_batches_submitted(*state) - sent, frame < MOVING_FRAMES - 1);
    }
    for (int frame = NEPH_IN_FLIGHT_FRAMES; frame < MOVING_FRAMES - 1; frame++) {
        assert_ptr_equal(used[frame], used[frame - NEPH_IN_FLIGHT_FRAMES]);
        for (int back = 1; back < NEPH_IN_FLIGHT_FRAMES; back++)
            assert_ptr_not_equal(used[frame], used[frame - back]);
    }
    neph_gpu_scene_destroy(*state, &gpu);
}

#include "tests/renderer/main.h"
