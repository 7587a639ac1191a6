/* SPDX-License-Identifier: MIT
 *
 * Triangle meshes: a mesh of a box against the box, the tree against all triangles one by one, rays
 * at edges and vertices of closed meshes, shadows against rays to the light, and data that are no
 * mesh.
 */
#include "tests/mesh_builders.h"

#include "scenes/bounds.h"
#include "scenes/solids.h"

#include <time.h>

/* --- a mesh of a box ------------------------------------------------------------------------- */

static const struct neph_vec3 low_m = {-1, -0.5, -2}, high_m = {1, 2, 0.25};

static bool is_near_edge(struct neph_vec3 point_m)
{
    const double away_m[3] = {fmin(fabs(point_m.x - low_m.x), fabs(point_m.x - high_m.x)),
                              fmin(fabs(point_m.y - low_m.y), fabs(point_m.y - high_m.y)),
                              fmin(fabs(point_m.z - low_m.z), fabs(point_m.z - high_m.z))};
    return (away_m[0] < 1e-9) + (away_m[1] < 1e-9) + (away_m[2] < 1e-9) > 1;
}

static struct neph_vec3 draw_target(uint64_t *seed)
{
    return (struct neph_vec3){neph_test_uniform(seed, -1.3, 1.3),
                              neph_test_uniform(seed, -0.8, 2.3),
                              neph_test_uniform(seed, -2.3, 0.6)};
}

/* Hits, misses, normals and distances of rays from inside and outside. */
static void test_a_mesh_of_a_box_is_hit_as_the_box(void **state)
{
    OWNED(mesh) struct neph_mesh *mesh = make_box_mesh(low_m, high_m);
    struct neph_solid box = {.kind = NEPH_SOLID_BOX, .box = {low_m, high_m}};
    const struct neph_scene scene = {.solid_count = 1, .solids = &box};
    int hits = 0;
    for (uint64_t trial = 0; trial < (uint64_t)neph_test_paths(60000); trial++) {
        uint64_t seed = 161803 + trial;
        const struct neph_vec3 origin_m = random_point(&seed, trial % 3 ? 8.0 : 0.45);
        const struct neph_vec3 direction = neph_vec3_normalize(
            neph_vec3_sub(draw_target(&seed), origin_m));
        const struct neph_hit expected = neph_scene_hit(&scene, origin_m, direction);
        const struct neph_mesh_hit hit = neph_mesh_meet(mesh, origin_m, direction, INFINITY, 0);
        const double t_m = isfinite(hit.t) ? hit.t : expected.t_m;
        if (is_near_edge(neph_vec3_along(origin_m, direction, t_m)))
            continue;
        if ((hit.t < INFINITY) != (expected.solid != NULL))
            print_error("seed %llu\n", (unsigned long long)(161803 + trial));
        assert_true((hit.t < INFINITY) == (expected.solid != NULL));
        if (!expected.solid)
            continue;
        hits++;
        /* Both round their differences from the origin, up to 16 m. */
        neph_assert_close(hit.t, expected.t_m, 1e-14, 1e-14);
        const double facing = neph_vec3_dot(expected.normal, direction) < 0.0 ? 1.0 : -1.0;
        neph_assert_close(neph_vec3_dot(hit.normal, expected.normal), facing, 1e-15, 0.0);
        assert_true(neph_mesh_blocks(mesh, origin_m, direction, 0.0, INFINITY, 0));
        assert_false(neph_mesh_blocks(mesh, origin_m, direction, 0.0, hit.t * (1.0 - 1e-12), 0));
    }
    print_message("%d hits\n", hits);
    assert_true(hits > neph_test_paths(60000) / 3);
}

static void assert_same_shadow(bool any, double t0_m, double t1_m,
                               const struct neph_shadows *shadows)
{
    double length_m = 0.0;
    for (int i = 0; i < shadows->count; i++)
        length_m += shadows->at_m[i].high - shadows->at_m[i].low;
    /* A shadow of no length is rounding on either side. */
    neph_assert_close(length_m, any ? t1_m - t0_m : 0.0, 1e-9, 1e-9);
    if (!any || t1_m - t0_m < 1e-9 || shadows->count == 0)
        return;
    neph_assert_close(shadows->at_m[0].low, t0_m, 1e-9, 1e-9);
    neph_assert_close(shadows->at_m[shadows->count - 1].high, t1_m, 1e-9, 1e-9);
}

/* The shadows of its triangles join to the one shadow of the box. The volume of the box is within
 * that shadow, and not in the mesh's where the triangles do not hide it, so views stay outside. */
static void test_a_mesh_of_a_box_has_its_shadow(void **state)
{
    OWNED(mesh) struct neph_mesh *mesh = make_box_mesh(low_m, high_m);
    OWNED(memory) struct neph_shadows *shadows = malloc(sizeof(*shadows));
    const struct neph_solid box = {.kind = NEPH_SOLID_BOX, .box = {low_m, high_m}};
    int hidden = 0;
    for (uint64_t trial = 0; trial < (uint64_t)neph_test_paths(30000); trial++) {
        uint64_t seed = 57721 + trial;
        const struct neph_vec3 light_m = neph_vec3_scale(random_direction(&seed), 4.0);
        const struct neph_vec3 sun = neph_vec3_normalize(light_m);
        const struct neph_vec3 origin_m = random_point(&seed, 9.0);
        const struct neph_vec3 shaded = neph_vec3_along(draw_target(&seed), sun,
                                                        -neph_test_uniform(&seed, 0.0, 9.0));
        const struct neph_vec3 direction = neph_vec3_normalize(neph_vec3_sub(shaded, origin_m));
        const struct neph_mesh_hit hit = neph_mesh_meet(mesh, origin_m, direction, 20.0, 0);
        const double end_m = fmin(20.0, hit.t);
        double t0_m = 0.0, t1_m = 0.0;
        if (neph_mesh_contains(mesh, origin_m))
            continue;
        struct neph_shadow_ray ray = {origin_m, direction, sun, NULL, 0.0, end_m};
        shadows->count = 0;
        neph_mesh_add_shadows(mesh, &ray, shadows);
        bool any = neph_solid_shadow(&box, sun, origin_m, direction, 0.0, end_m, &t0_m, &t1_m);
        assert_same_shadow(any, t0_m, t1_m, shadows);
        hidden += any;
        ray.light_m = &light_m;
        shadows->count = 0;
        neph_mesh_add_shadows(mesh, &ray, shadows);
        any = neph_solid_point_shadow(&box, light_m, origin_m, direction, 0.0, end_m, &t0_m, &t1_m);
        assert_same_shadow(any, t0_m, t1_m, shadows);
        hidden += any;
    }
    print_message("%d shadows\n", hidden);
    assert_true(hidden > neph_test_paths(30000) / 2);
}

/* --- the tree -------------------------------------------------------------------------------- */

/* A mesh of one triangle of another. */
static struct neph_mesh *make_part(const struct neph_mesh *mesh, int triangle)
{
    struct neph_mesh_data data = allocate_mesh(3, 1);
    for (int corner = 0; corner < 3; corner++)
        data.positions[corner] = mesh->data.positions[mesh->data.triangles[triangle][corner]];
    set_triangle(&data, 0, 0, 1, 2);
    return finish_mesh(data);
}

static void assert_tree_is_whole(const struct neph_mesh *mesh)
{
    int items = 0;
    const struct neph_box_tree *tree = &mesh->tree;
    for (int i = 0; i < tree->node_count; i++)
        items += tree->nodes[i].count;
    assert_int_equal(items, mesh->data.triangle_count);
}

enum { SOUP = 300 };

/* Nearest hits, any hits and shadows are those of the triangles one by one, to the last bit. */
static void test_the_tree_equals_brute_force(void **state)
{
    uint64_t seed = 4669;
    OWNED(mesh) struct neph_mesh *soup = finish_mesh(make_soup(SOUP, 0.4, &seed));
    OWNED(memory) struct neph_shadows *shadows = malloc(sizeof(*shadows));
    OWNED(memory) struct neph_shadows *expected = malloc(sizeof(*expected));
    struct neph_mesh *parts[SOUP];
    int hits = 0, most = 0;
    assert_tree_is_whole(soup);
    for (int i = 0; i < SOUP; i++)
        parts[i] = make_part(soup, i);
    for (int trial = 0; trial < neph_test_paths(3000); trial++) {
        const struct neph_vec3 origin_m = random_point(&seed, 3.0), sun = random_direction(&seed);
        const struct neph_vec3 direction = neph_vec3_sub(random_point(&seed, 1.0), origin_m);
        const struct neph_vec3 light_m = random_point(&seed, 2.0);
        const struct neph_shadow_ray ray = {origin_m, direction, sun, trial % 2 ? &light_m : NULL,
                                            0.0,      2.0};
        const struct neph_mesh_hit hit = neph_mesh_meet(soup, origin_m, direction, INFINITY, 0);
        struct neph_mesh_hit nearest = {.t = INFINITY};
        expected->count = shadows->count = 0;
        for (int i = 0; i < SOUP; i++) {
            const struct neph_mesh_hit one = neph_mesh_meet(parts[i], origin_m, direction, INFINITY,
                                                            0);
            if (one.t < nearest.t) {
                nearest = one;
                nearest.place.triangle = i;
            }
            neph_mesh_add_shadows(parts[i], &ray, expected);
        }
        assert_true(hit.t == nearest.t);
        hits += hit.t < INFINITY;
        if (hit.t < INFINITY)
            assert_int_equal(hit.place.triangle, nearest.place.triangle);
        assert_true(neph_mesh_blocks(soup, origin_m, direction, 0.0, INFINITY, 0) ==
                    (nearest.t < INFINITY));
        neph_mesh_add_shadows(soup, &ray, shadows);
        assert_int_equal(shadows->count, expected->count);
        assert_memory_equal(shadows->at_m, expected->at_m,
                            (size_t)shadows->count * sizeof(shadows->at_m[0]));
        most = shadows->count > most ? shadows->count : most;
    }
    for (int i = 0; i < SOUP; i++)
        neph_mesh_destroy(parts[i]);
    print_message("%d hits, at most %d shadows\n", hits, most);
    assert_true(hits > neph_test_paths(3000) / 2 && most > 5);
}

/* Where two triangles are the same, the first of the file is hit. */
static void test_ties_go_to_the_first_triangle(void **state)
{
    struct neph_mesh_data data = allocate_mesh(4, 6);
    data.positions[1] = (struct neph_vec3){1, 0, 0};
    data.positions[2] = (struct neph_vec3){0, 1, 0};
    data.positions[3] = (struct neph_vec3){1, 1, 0};
    for (int i = 0; i < 6; i++)
        set_triangle(&data, i, i % 2 ? 1 : 0, i % 2 ? 3 : 1, 2);
    OWNED(mesh) struct neph_mesh *mesh = finish_mesh(data);
    const struct neph_vec3 ahead = {0, 0, -1};
    const struct {
        struct neph_vec3 origin;
        int number;
    } rows[] = {{{0.2, 0.2, 3}, 0}, {{0.8, 0.8, 3}, 1}, {{0.5, 0.5, 3}, 0}, {{0, 1, 3}, 0}};
    for (size_t i = 0; i < COUNT(rows); i++) {
        const struct neph_mesh_hit hit = neph_mesh_meet(mesh, rows[i].origin, ahead, INFINITY, 0);
        assert_true(hit.t == 3.0 && hit.normal.z == 1.0);
        assert_int_equal(mesh->number[hit.place.triangle], rows[i].number);
    }
}

static double find_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Only printed: no test waits for a clock. */
static void test_a_large_mesh_is_built(void **state)
{
    const int cells = NEPH_TEST_EVERY > 1 ? 60 : 317; /* 200,978 triangles */
    struct neph_mesh_data data = make_hills(cells, 500.0, 20.0);
    const double start_s = find_seconds();
    OWNED(mesh) struct neph_mesh *mesh = finish_mesh(data);
    print_message("%d triangles: %.2f s, %d nodes\n", mesh->data.triangle_count,
                  find_seconds() - start_s, mesh->tree.node_count);
    assert_tree_is_whole(mesh);
    assert_int_equal(mesh->inside, NEPH_MESH_OPEN);
}

/* --- watertightness -------------------------------------------------------------------------- */

/* Rays from inside a closed mesh to points of its edges, to its vertices, and beside both by a few
 * units in the last place: every ray meets the mesh, near the point. */
static void test_no_ray_passes_a_closed_mesh(void **state)
{
    uint64_t seed = 1442695;
    OWNED(mesh) struct neph_mesh *lump = finish_mesh(make_lump(24, 0.2, &seed));
    const struct neph_mesh_data *data = &lump->data;
    assert_int_equal(lump->inside, NEPH_MESH_ORIENTED);
    assert_int_equal(lump->dropped_count, 2 * 48); /* at the poles */
    const int rays = neph_test_paths(3000000);
    for (int i = 0; i < rays; i++) {
        const int *v = data->triangles[neph_test_random(&seed) % (uint64_t)data->triangle_count];
        const struct neph_vec3 a = data->positions[v[i % 3]], b = data->positions[v[(i + 1) % 3]];
        const double part = i % 4 == 0 ? 0.0 : neph_test_uniform(&seed, 0.0, 1.0);
        struct neph_vec3 at = neph_vec3_along(a, neph_vec3_sub(b, a), part);
        if (i % 5 == 0)
            at = neph_vec3_along(at, random_point(&seed, 1.0), 1e-16);
        const struct neph_vec3 origin = i % 7 == 0 ? (struct neph_vec3){0, 0, 0}
                                                   : random_point(&seed, 0.3);
        const struct neph_vec3 direction = neph_vec3_sub(at, origin);
        const bool is_blocked = neph_mesh_blocks(lump, origin, direction, 0.0, INFINITY, 0);
        if (!is_blocked)
            print_error("ray %d: from %.17g %.17g %.17g to %.17g %.17g %.17g\n", i, origin.x,
                        origin.y, origin.z, at.x, at.y, at.z);
        assert_true(is_blocked);
        if (i % 7 == 0) /* seen from there, the lump has no silhouettes */
            neph_assert_close(neph_mesh_meet(lump, origin, direction, INFINITY, 0).t, 1.0, 1e-13,
                              0.0);
    }
}

/* Instances far from the origin and of small size. */
static void test_points_are_inside_or_outside(void **state)
{
    OWNED(mesh) struct neph_mesh *box = make_box_mesh(low_m, high_m);
    uint64_t seed = 20067;
    OWNED(mesh) struct neph_mesh *lump = finish_mesh(make_lump(24, 0.2, &seed));
    OWNED(mesh) struct neph_mesh *hills = finish_mesh(make_hills(20, 4.0, 1.0));
    const struct neph_bounds bounds = {low_m, high_m};
    int inside = 0;
    for (int i = 0; i < neph_test_paths(60000); i++) {
        struct neph_vec3 p = random_point(&seed, 3.0);
        if (i % 2) /* in planes of the box and of its edges */
            p = (struct neph_vec3){round(p.x), round(p.y), round(p.z)};
        const bool is_in_box = neph_mesh_contains(box, p);
        inside += is_in_box;
        const bool is_on_face = p.x == low_m.x || p.x == high_m.x || p.y == high_m.y ||
                                p.z == low_m.z;
        if (!is_on_face)
            assert_true(is_in_box == neph_bounds_contain(&bounds, p));
        const double away = neph_vec3_length(p);
        if (away < 0.75)
            assert_true(neph_mesh_contains(lump, p));
        if (away > 1.2)
            assert_false(neph_mesh_contains(lump, p));
        assert_false(neph_mesh_contains(hills, p));
    }
    assert_true(inside > 100);
}

/* Triangles that are turned around still enclose; a box without one of its triangles is open. */
static void test_the_kind_of_inside(void **state)
{
    uint64_t seed = 11;
    struct neph_mesh_data data = make_lump(8, 0.1, &seed);
    set_triangle(&data, 40, data.triangles[40][0], data.triangles[40][2], data.triangles[40][1]);
    OWNED(mesh) struct neph_mesh *turned = finish_mesh(data);
    assert_int_equal(turned->inside, NEPH_MESH_EVEN);
    assert_true(neph_mesh_contains(turned, (struct neph_vec3){0.1, 0.2, 0.3}));
    assert_false(neph_mesh_contains(turned, (struct neph_vec3){1.1, 0.9, 0.3}));
    data = make_lump(8, 0.1, &seed);
    data.triangle_count = 200; /* of 256 */
    OWNED(mesh) struct neph_mesh *open = finish_mesh(data);
    assert_int_equal(open->inside, NEPH_MESH_OPEN);
    assert_false(neph_mesh_contains(open, (struct neph_vec3){0.1, 0.2, 0.3}));
}

/* --- shadows --------------------------------------------------------------------------------- */

static bool is_in(const struct neph_shadows *shadows, double t, double *away)
{
    bool inside = false;
    *away = INFINITY;
    for (int i = 0; i < shadows->count; i++) {
        inside |= t > shadows->at_m[i].low && t < shadows->at_m[i].high;
        *away = fmin(*away, fmin(fabs(t - shadows->at_m[i].low), fabs(t - shadows->at_m[i].high)));
    }
    return inside;
}

/* At points of a ray over a mesh, a ray to the light is blocked exactly in the shadows. */
static void test_shadows_equal_rays_to_the_light(void **state)
{
    uint64_t seed = 1618;
    struct neph_mesh *meshes[3];
    meshes[0] = finish_mesh(make_hills(30, 4.0, 0.4));
    meshes[1] = finish_mesh(make_lump(16, 0.3, &seed));
    meshes[2] = finish_mesh(make_soup(60, 0.5, &seed));
    OWNED(memory) struct neph_shadows *shadows = malloc(sizeof(*shadows));
    int hidden = 0, tested = 0, most = 0;
    for (int trial = 0; trial < neph_test_paths(9000); trial++) {
        const struct neph_mesh *mesh = meshes[trial % 3];
        struct neph_vec3 sun = random_direction(&seed), origin = random_point(&seed, 3.0);
        sun.y *= 0.2; /* low, for hills */
        const struct neph_vec3 light = neph_vec3_scale(sun, 3.0);
        const struct neph_vec3 direction = neph_vec3_sub(random_point(&seed, 1.0), origin);
        const bool is_lamp = trial % 2;
        const struct neph_shadow_ray ray = {origin, direction, sun, is_lamp ? &light : NULL,
                                            0.0,    2.0};
        shadows->count = 0;
        neph_mesh_add_shadows(mesh, &ray, shadows);
        most = shadows->count > most ? shadows->count : most;
        for (int i = 0; i < 20; i++) {
            double away;
            const double t = neph_test_uniform(&seed, 0.0, 2.0);
            const struct neph_vec3 p = neph_vec3_along(origin, direction, t);
            const struct neph_vec3 way = is_lamp ? neph_vec3_sub(light, p) : sun;
            const bool is_hidden = is_in(shadows, t, &away);
            if (away < 1e-9)
                continue;
            tested++;
            hidden += is_hidden;
            if (neph_mesh_blocks(mesh, p, way, 0.0, is_lamp ? 1.0 : INFINITY, 0) != is_hidden)
                print_error("trial %d, t %.17g, hidden %d\n", trial, t, is_hidden);
            assert_true(neph_mesh_blocks(mesh, p, way, 0.0, is_lamp ? 1.0 : INFINITY, 0) ==
                        is_hidden);
        }
    }
    for (int i = 0; i < 3; i++)
        neph_mesh_destroy(meshes[i]);
    print_message("%d of %d points hidden, at most %d shadows\n", hidden, tested, most);
    assert_true(hidden > tested / 10 && hidden < tested && most > 4);
}

/* A union of intervals, against points on a line of whole numbers. */
static void test_shadows_are_a_union(void **state)
{
    enum { LINE = 200 };
    OWNED(memory) struct neph_shadows *shadows = malloc(sizeof(*shadows));
    uint64_t seed = 99;
    for (int trial = 0; trial < 300; trial++) {
        bool hidden[LINE] = {false};
        shadows->count = 0;
        for (int i = 0; i < 20; i++) {
            const int low = (int)(neph_test_random(&seed) % (LINE - 10));
            const int high = low + 1 + (int)(neph_test_random(&seed) % 9);
            neph_shadows_add(shadows, low, high);
            for (int at = low; at < high; at++)
                hidden[at] = true;
            assert_true(neph_shadows_cover(shadows, low, high));
        }
        for (int at = 0; at < LINE; at++)
            assert_true(neph_shadows_cover(shadows, at, at + 1) == hidden[at]);
        for (int i = 1; i < shadows->count; i++)
            assert_true(shadows->at_m[i].low > shadows->at_m[i - 1].high);
    }
}

/* Where there are too many, the smallest gap closes: here, those of 0.1 before those of 0.5. */
static void test_too_many_shadows_close_their_smallest_gaps(void **state)
{
    OWNED(memory) struct neph_shadows *shadows = malloc(sizeof(*shadows));
    shadows->count = 0;
    double length = 0.0, covered = 0.0;
    for (int i = 0; i < NEPH_SHADOWS_MAX + 100; i++) {
        const double at = 2.0 * i, end = at + (i % 8 ? 1.5 : 1.9);
        neph_shadows_add(shadows, at, end);
        length += end - at;
    }
    assert_int_equal(shadows->count, NEPH_SHADOWS_MAX);
    for (int i = 0; i < shadows->count; i++)
        covered += shadows->at_m[i].high - shadows->at_m[i].low;
    neph_assert_close(covered - length, 100 * 0.1, 1e-6, 0.0);
}

/* --- data that are no mesh ------------------------------------------------------------------- */

static void assert_refused(struct neph_mesh_data data, const char *part)
{
    struct neph_diag diag = {0};
    struct neph_mesh *mesh = NULL;
    assert_int_equal(neph_mesh_create(&data, &mesh, &diag), NEPH_ERR_INPUT);
    assert_null(mesh);
    assert_null(data.positions);
    if (!strstr(diag.message, part))
        print_error("%s\n", diag.message);
    assert_non_null(strstr(diag.message, part));
}

static void test_data_that_are_no_mesh(void **state)
{
    uint64_t seed = 5;
    assert_refused((struct neph_mesh_data){0}, "no triangle");
    struct neph_mesh_data data = make_soup(3, 0.5, &seed);
    data.triangle_count = NEPH_MESH_TRIANGLES_MAX + 1;
    assert_refused(data, "1000001 triangles; a mesh has at most 1000000");
    data = make_soup(3, 0.5, &seed);
    data.positions[4].y = NAN;
    assert_refused(data, "vertex 4 is (");
    data = make_soup(3, 0.5, &seed);
    data.positions[8].z = -INFINITY;
    assert_refused(data, "vertex 8 is (");
    data = make_soup(3, 0.5, &seed);
    data.positions[8].x = 2e9;
    assert_refused(data, "from -1e+09 to 1e+09");
    data = make_soup(3, 0.5, &seed);
    data.triangles[1][2] = 9;
    assert_refused(data, "triangle 1 has vertex 9; the 9 vertices are 0 to 8");
    data = make_soup(3, 0.5, &seed);
    data.triangles[2][0] = -1;
    assert_refused(data, "triangle 2 has vertex -1");
    data = make_soup(3, 0.5, &seed);
    data.normals = calloc(9, sizeof(*data.normals));
    assert_refused(data, "the normal of vertex 0 has length 0");
    data = make_soup(2, 0.5, &seed);
    for (int i = 0; i < 6; i++)
        data.positions[i] = (struct neph_vec3){i, 2.0 * i, -i};
    assert_refused(data, "none of the 2 triangles has an area");
}

/* Degenerate triangles are left out and counted; the numbers of the others stay those of the
 * file. */
static void test_degenerate_triangles_are_dropped(void **state)
{
    uint64_t seed = 6;
    struct neph_mesh_data data = make_soup(4, 0.5, &seed);
    set_triangle(&data, 0, 3, 3, 4);
    data.positions[7] = neph_vec3_along(data.positions[6],
                                        neph_vec3_sub(data.positions[8], data.positions[6]), 0.5);
    OWNED(mesh) struct neph_mesh *mesh = finish_mesh(data);
    assert_int_equal(mesh->dropped_count, 2);
    assert_int_equal(mesh->data.triangle_count, 2);
    assert_int_equal(mesh->number[0] + mesh->number[1], 1 + 3);
}

/* The same data have the same hash; one changed bit changes it. */
static void test_the_hash_is_that_of_the_data(void **state)
{
    uint64_t seed = 7, again = 7, other = 7;
    OWNED(mesh) struct neph_mesh *a = finish_mesh(make_soup(9, 0.5, &seed));
    OWNED(mesh) struct neph_mesh *b = finish_mesh(make_soup(9, 0.5, &again));
    struct neph_mesh_data data = make_soup(9, 0.5, &other);
    data.positions[26].z = nextafter(data.positions[26].z, 9.0);
    OWNED(mesh) struct neph_mesh *c = finish_mesh(data);
    assert_string_equal(a->hash, b->hash);
    assert_string_not_equal(a->hash, c->hash);
}

#include "tests/main.h"
