/* SPDX-License-Identifier: MIT
 *
 * Meshes as solids of a scene: placed, turned and scaled, beside boxes and spheres; points that
 * their own triangle must not hide; and the tree over all solids against testing each.
 */
#include "tests/mesh_builders.h"

#include "scenes/motion.h"
#include "scenes/solids.h"
#include "scenes/surfaces.h"

static const struct neph_vec3 low_m = {-1, -0.5, -2}, high_m = {1, 2, 0.25};

static struct neph_solid draw_placed(const struct neph_mesh *mesh, double far_m, uint64_t *seed)
{
    const double yaw_rad = neph_test_uniform(seed, -4, 4),
                 turn_rad = neph_test_uniform(seed, -4, 4);
    struct neph_solid solid = {
        .kind = NEPH_SOLID_MESH,
        .mesh = mesh,
        .center_m = random_point(seed, far_m),
        .scale_m = pow(10.0, neph_test_uniform(seed, -1.5, 1.5)),
        .yaw = {1, cos(yaw_rad), sin(yaw_rad)},
    };
    if (neph_test_random(seed) % 2)
        solid.turn = (struct neph_turn){(int)(neph_test_random(seed) % 3), cos(turn_rad),
                                        sin(turn_rad)};
    return solid;
}

/* The same mesh, with the placement in its vertices. */
static struct neph_mesh *make_copy(const struct neph_solid *solid)
{
    const struct neph_mesh_data *from = &solid->mesh->data;
    struct neph_mesh_data data = allocate_mesh(from->vertex_count, from->triangle_count);
    memcpy(data.triangles, from->triangles,
           (size_t)from->triangle_count * sizeof(*from->triangles));
    for (int i = 0; i < from->vertex_count; i++) {
        struct neph_vec3 p = neph_rotate(&solid->yaw,
                                         neph_vec3_scale(from->positions[i], solid->scale_m));
        if (neph_is_turned(&solid->turn))
            p = neph_rotate(&solid->turn, p);
        data.positions[i] = neph_vec3_add(solid->center_m, p);
    }
    return finish_mesh(data);
}

/* Hits, bounds, shadows and the inside of a placed mesh are those of its copy in the world. */
static void test_a_placed_mesh_equals_its_copy(void **state)
{
    uint64_t seed = 141421;
    OWNED(mesh) struct neph_mesh *lump = finish_mesh(make_lump(12, 0.2, &seed));
    OWNED(memory) struct neph_shadows *shadows = malloc(2 * sizeof(*shadows));
    int hits = 0;
    for (int trial = 0; trial < 30; trial++) {
        struct neph_solid both[2] = {draw_placed(lump, 50.0, &seed)};
        const double size_m = both[0].scale_m;
        OWNED(mesh) struct neph_mesh *copy = make_copy(&both[0]);
        both[1] = (struct neph_solid){.kind = NEPH_SOLID_MESH, .mesh = copy, .scale_m = 1.0};
        struct neph_scene scenes[2];
        for (int i = 0; i < 2; i++)
            scenes[i] = (struct neph_scene){.solid_count = 1, .solids = &both[i]};
        const struct neph_bounds a = neph_solid_bounds(&both[0]), b = neph_solid_bounds(&both[1]);
        assert_true(a.min_m.x <= b.min_m.x + 1e-9 && a.min_m.y <= b.min_m.y + 1e-9 &&
                    a.min_m.z <= b.min_m.z + 1e-9 && a.max_m.x >= b.max_m.x - 1e-9 &&
                    a.max_m.y >= b.max_m.y - 1e-9 && a.max_m.z >= b.max_m.z - 1e-9);
        for (int i = 0; i < 40; i++) {
            const struct neph_vec3 from_m = neph_vec3_along(both[0].center_m,
                                                            random_point(&seed, 3.0), size_m);
            const struct neph_vec3 to_m = neph_vec3_along(both[0].center_m,
                                                          random_point(&seed, 1.0), size_m);
            const struct neph_vec3 d = neph_vec3_normalize(neph_vec3_sub(to_m, from_m));
            const struct neph_hit hit = neph_scene_hit(&scenes[0], from_m, d);
            const struct neph_hit expected = neph_scene_hit(&scenes[1], from_m, d);
            /* Both round coordinates of up to 150 m; silhouettes may differ. */
            if (isfinite(hit.t_m) && isfinite(expected.t_m) &&
                neph_vec3_dot(hit.normal, expected.normal) > 0.999) {
                neph_assert_close(hit.t_m, expected.t_m, 1e-9, 1e-9);
                neph_assert_close(hit.plane_m, expected.plane_m, 1e-9, 1e-9);
                hits++;
            }
            assert_true(neph_solid_contains(&both[0], to_m) == neph_solid_contains(&both[1], to_m));
            const struct neph_vec3 sun = random_direction(&seed), lamp_m = from_m;
            struct neph_shadow_ray ray = {
                neph_vec3_along(to_m, d, -size_m), d, sun, i % 2 ? &lamp_m : NULL, 0.0, size_m};
            double length_m[2] = {0.0, 0.0};
            for (int s = 0; s < 2; s++) {
                shadows[s].count = 0;
                neph_scene_add_shadows(&scenes[s], &ray, &shadows[s]);
                for (int k = 0; k < shadows[s].count; k++)
                    length_m[s] += shadows[s].at_m[k].high - shadows[s].at_m[k].low;
            }
            neph_assert_close(length_m[0], length_m[1], 1e-7, 1e-7);
        }
    }
    print_message("%d hits\n", hits);
    assert_true(hits > 300);
}

/* A mover displaces and turns a mesh about its pivot, as it does a box. */
static void test_keys_move_a_mesh_as_a_box(void **state)
{
    OWNED(mesh) struct neph_mesh *mesh = make_box_mesh(low_m, high_m);
    struct neph_solid_key keys[2] = {{0, {0, 0, 0}, 0.0}, {10, {3, 1, -2}, 2.5}};
    struct neph_solid solids[2] = {{.kind = NEPH_SOLID_BOX, .box = {low_m, high_m}},
                                   {.kind = NEPH_SOLID_MESH, .mesh = mesh, .scale_m = 1.0}};
    struct neph_mover movers[2] = {{0, 1, 2, {0.3, -1, 2}, 2, keys},
                                   {1, 1, 2, {0.3, -1, 2}, 2, keys}};
    const struct neph_scene scene = {.solid_count = 2,
                                     .solids = solids,
                                     .mover_count = 2,
                                     .movers = movers,
                                     .frame_count = 11,
                                     .frame_rate_hz = 30};
    uint64_t seed = 5;
    int hits = 0;
    for (int frame = 0; frame <= 10; frame += 5) {
        struct neph_solid box = neph_scene_solid(&scene, 0, frame);
        struct neph_solid moved = neph_scene_solid(&scene, 1, frame);
        const struct neph_scene a = {.solid_count = 1, .solids = &box};
        const struct neph_scene b = {.solid_count = 1, .solids = &moved};
        for (int i = 0; i < 200; i++) {
            const struct neph_vec3 from_m = random_point(&seed, 12.0);
            const struct neph_vec3 d = neph_vec3_normalize(
                neph_vec3_sub(random_point(&seed, 3.0), from_m));
            const struct neph_hit hit = neph_scene_hit(&a, from_m, d);
            const struct neph_hit met = neph_scene_hit(&b, from_m, d);
            assert_true((hit.solid != NULL) == (met.solid != NULL));
            hits += hit.solid != NULL;
            if (hit.solid)
                neph_assert_close(met.t_m, hit.t_m, 1e-12, 1e-12);
        }
    }
    assert_true(hits > 60);
}

/* A convex mesh hides no point of its own on the side of a light, however small, far, long or thin
 * its triangles are, and the ray goes on from there without meeting them. */
static void test_a_convex_mesh_does_not_hide_itself(void **state)
{
    uint64_t seed = 2236;
    long lit = 0;
    for (int trial = 0; trial < 60; trial++) {
        struct neph_mesh_data data = make_lump(trial % 2 ? 40 : 6, 0.0, &seed);
        const struct neph_vec3 sides = {1.0, trial % 3 ? 1.0 : 1e-4, trial % 5 ? 1.0 : 1e5};
        for (int i = 0; i < data.vertex_count; i++) { /* an ellipsoid, of thin triangles */
            data.positions[i].x *= sides.x;
            data.positions[i].y *= sides.y;
            data.positions[i].z *= sides.z;
        }
        OWNED(mesh) struct neph_mesh *mesh = finish_mesh(data);
        struct neph_solid solid = draw_placed(mesh, trial % 4 ? 10.0 : 1e5, &seed);
        struct neph_scene scene = {.solid_count = 1, .solids = &solid, .sun = {.present = true}};
        const struct neph_bounds bounds = neph_solid_bounds(&solid);
        for (int i = 0; i < neph_test_paths(900); i++) {
            const struct neph_vec3 to_m = random_place_in(&bounds, &seed);
            const struct neph_vec3 from_m = neph_vec3_along(
                to_m, random_direction(&seed),
                neph_vec3_length(neph_vec3_sub(bounds.max_m, bounds.min_m)));
            const struct neph_vec3 d = neph_vec3_normalize(neph_vec3_sub(to_m, from_m));
            const struct neph_hit hit = neph_scene_hit(&scene, from_m, d);
            if (!hit.solid)
                continue;
            const struct neph_vec3 at_m = neph_hit_outside_m(&hit,
                                                             neph_vec3_along(from_m, d, hit.t_m));
            struct neph_vec3 sun = random_direction(&seed);
            if (i % 2) /* grazing */
                sun = neph_vec3_normalize(neph_vec3_along(
                    neph_vec3_along(sun, hit.normal, -neph_vec3_dot(sun, hit.normal)), hit.normal,
                    1e-6));
            scene.sun.direction = sun;
            if (neph_vec3_dot(sun, hit.normal) <= 1e-9)
                continue;
            lit++;
            assert_true(neph_scene_is_sun_visible(&scene, at_m));
            assert_null(neph_scene_hit(&scene, at_m, sun).solid);
        }
    }
    print_message("%ld lit points\n", lit);
    assert_true(lit > neph_test_paths(900) * 12L);
}

enum { MANY = 150 };

static void draw_solids(struct neph_solid solids[MANY], struct neph_mesh *const meshes[2],
                        uint64_t *seed)
{
    for (int i = 0; i < MANY; i++) {
        const struct neph_vec3 p = random_point(seed, 15.0);
        const double size_m = neph_test_uniform(seed, 0.2, 1.0);
        solids[i] = make_box(p.x, p.y, p.z, p.x + size_m, p.y + 1.0, p.z + 2.0 * size_m);
        if (i % 3 == 1)
            solids[i] = make_sphere(p.x, p.y, p.z, size_m);
        if (i % 3 == 2)
            solids[i] = draw_placed(meshes[i % 2], 15.0, seed);
        solids[i].scale_m *= 0.1;
        if (i % 9 == 0)
            solids[i].turn = (struct neph_turn){i % 3, cos(i), sin(i)};
    }
    solids[100] = solids[20]; /* ties */
    solids[101] = solids[21];
    solids[102] = make_sphere(0, -1e6, 0, 1e6 - 30.0);
}

/* With and without the tree the same solids are hit at the same distance, to the last bit. */
static void test_the_tree_of_solids_changes_nothing(void **state)
{
    uint64_t seed = 1732;
    struct neph_mesh *meshes[2] = {finish_mesh(make_lump(6, 0.2, &seed)),
                                   make_box_mesh(low_m, high_m)};
    struct neph_solid solids[MANY];
    OWNED(memory) void *memory = malloc(neph_scene_tree_bytes(MANY));
    OWNED(memory) struct neph_shadows *shadows = malloc(2 * sizeof(*shadows));
    draw_solids(solids, meshes, &seed);
    assert_int_equal(neph_scene_tree_bytes(3), 0);
    struct neph_scene scene = {
        .solid_count = MANY, .solids = solids, .sun = {.present = true, .direction = {0, 1, 0}}};
    struct neph_box_tree *tree = neph_scene_tree_build(solids, MANY, memory);
    int hits = 0, most = 0;
    for (int trial = 0; trial < neph_test_paths(9000); trial++) {
        const struct neph_vec3 from_m = random_point(&seed, 25.0), to_m = random_point(&seed, 25.0);
        const struct neph_vec3 d = neph_vec3_normalize(neph_vec3_sub(to_m, from_m));
        struct neph_shadow_ray ray = {
            from_m, d, random_direction(&seed), trial % 2 ? &to_m : NULL, 0.0, 60.0};
        struct neph_hit hit[2];
        bool is_lit[2], is_seen[2];
        ray.sun.y = fabs(ray.sun.y); /* above the ball */
        scene.sun.direction = ray.sun;
        for (int i = 0; i < 2; i++) {
            scene.solid_tree = i ? tree : NULL;
            hit[i] = neph_scene_hit(&scene, from_m, d);
            is_lit[i] = neph_scene_is_sun_visible(&scene, from_m);
            is_seen[i] = neph_scene_is_visible(&scene, from_m, to_m);
            shadows[i].count = 0;
            neph_scene_add_shadows(&scene, &ray, &shadows[i]);
        }
        assert_true(hit[0].t_m == hit[1].t_m && hit[0].solid == hit[1].solid);
        assert_true(hit[0].solid != &solids[100] && hit[0].solid != &solids[101]);
        assert_true(is_lit[0] == is_lit[1] && is_seen[0] == is_seen[1]);
        assert_int_equal(shadows[0].count, shadows[1].count);
        assert_memory_equal(shadows[0].at_m, shadows[1].at_m,
                            (size_t)shadows[0].count * sizeof(shadows[0].at_m[0]));
        hits += hit[0].solid != NULL;
        most = shadows[0].count > most ? shadows[0].count : most;
    }
    print_message("%d hits, at most %d shadows\n", hits, most);
    assert_true(hits > neph_test_paths(9000) / 5 && most > 5);
    for (int i = 0; i < 2; i++)
        neph_mesh_destroy(meshes[i]);
}

static void test_engines_without_meshes_say_so(void **state)
{
    OWNED(mesh) struct neph_mesh *mesh = make_box_mesh(low_m, high_m);
    struct neph_solid solid = {.kind = NEPH_SOLID_MESH, .mesh = mesh, .scale_m = 1.0};
    const struct neph_scene scene = {.solid_count = 1, .solids = &solid};
    assert_non_null(strstr(neph_mesh_obstacle(&scene), "triangle meshes"));
    assert_null(neph_surfaces_obstacle(&scene));
    assert_null(neph_metal_obstacle(&scene));
}

#include "tests/main.h"
