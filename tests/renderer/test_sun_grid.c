/* SPDX-License-Identifier: MIT
 *
 * The grid across the sun: where a cell decides, it decides as rays in double do, and it decides
 * for most points.
 */
#include "tests/mesh_builders.h"

#include "renderer/shaders/constants.h"
#include "renderer/sun_grid.h"
#include "scenes/solids.h"

enum { SOLIDS = 60, POINTS = 4000 };

static void test_end_grid(struct neph_sun_grid *grid)
{
    neph_sun_grid_destroy(grid);
}

struct world {
    struct neph_scene scene;
    struct neph_solid solids[SOLIDS];
    struct neph_mesh *meshes[2];
};

static void test_end_world(struct world *world)
{
    for (int i = 0; i < world->scene.mesh_count; i++)
        neph_mesh_destroy(world->meshes[i]);
}

static struct neph_turn random_turn(uint64_t *seed)
{
    const double angle = neph_test_uniform(seed, 0.0, 2.0 * M_PI);
    return (struct neph_turn){(int)neph_test_uniform(seed, 0.0, 3.0), cos(angle), sin(angle)};
}

/* Boxes, some of them rotated and some wide; balls; and instances of the world's meshes. */
static struct neph_solid random_solid(const struct world *world, uint64_t *seed)
{
    const double kind = neph_test_uniform(seed, 0.0, world->scene.mesh_count > 0 ? 1.0 : 0.7);
    const struct neph_vec3 at_m = random_point(seed, 100.0);
    const struct neph_vec3 to_m = neph_vec3_add(
        at_m,
        (struct neph_vec3){neph_test_uniform(seed, 0.01, 12.0), neph_test_uniform(seed, 0.01, 12.0),
                           neph_test_uniform(seed, 0.01, kind < 0.05 ? 120.0 : 12.0)});
    struct neph_solid solid = {.kind = NEPH_SOLID_BOX, .box = {at_m, to_m}};
    if (kind < 0.2)
        return solid;
    if (kind < 0.4) {
        solid.turn = random_turn(seed);
        return solid;
    }
    solid.center_m = at_m;
    solid.radius_m = neph_test_uniform(seed, 0.1, 10.0);
    solid.kind = NEPH_SOLID_SPHERE;
    if (kind < 0.7)
        return solid;
    return (struct neph_solid){.kind = NEPH_SOLID_MESH,
                               .mesh = world->meshes[kind < 0.85],
                               .center_m = at_m,
                               .scale_m = neph_test_uniform(seed, 1.0, 12.0),
                               .turn = random_turn(seed),
                               .yaw = random_turn(seed)};
}

/* An open sheet: hills over the square from -1 to 1. */
static struct neph_mesh *make_sheet(uint64_t *seed)
{
    enum { SIDE = 12 };
    struct neph_mesh_data data = allocate_mesh((SIDE + 1) * (SIDE + 1), 2 * SIDE * SIDE);
    for (int i = 0; i < data.vertex_count; i++)
        data.positions[i] = (struct neph_vec3){2.0 * (i % (SIDE + 1)) / SIDE - 1.0,
                                               neph_test_uniform(seed, -0.1, 0.1),
                                               2.0 * (i / (SIDE + 1)) / SIDE - 1.0};
    for (int i = 0; i < SIDE * SIDE; i++) {
        const int a = i / SIDE * (SIDE + 1) + i % SIDE, below = a + SIDE + 1;
        set_triangle(&data, 2 * i, a, below, a + 1);
        set_triangle(&data, 2 * i + 1, a + 1, below, below + 1);
    }
    return finish_mesh(data);
}

/* A sheet of make_sheet() with square holes, over a quarter of it and softly cut. */
static struct neph_mesh *make_sieve(uint64_t *seed)
{
    struct neph_mesh *sheet = make_sheet(seed);
    struct neph_mesh_data *data = &sheet->data;
    float *rgba = calloc(4 * 4 * 4, sizeof(*rgba));
    data->uv = calloc((size_t)data->vertex_count, sizeof(*data->uv));
    assert_true(rgba && data->uv);
    for (int i = 0; i < data->vertex_count; i++) {
        data->uv[i][0] = (float)data->positions[i].x;
        data->uv[i][1] = (float)data->positions[i].z;
    }
    for (int i = 0; i < 16; i++)
        rgba[4 * i + 3] = i % 4 < 2 && i < 8 ? 0.0F : 1.0F;
    neph_assert_ok(neph_albedo_texture_create(4, 4, rgba, true, &sheet->material.texture, NULL),
                   NULL);
    sheet->material.alpha = NEPH_ALPHA_CUTOUT;
    return sheet;
}

enum meshes { NO_MESHES, WHOLE_MESHES, MESHES_WITH_HOLES };

static void make_world(struct world *world, enum meshes meshes, uint64_t *seed)
{
    *world = (struct world){.scene = {.solid_count = SOLIDS, .medium_count = 1}};
    if (meshes != NO_MESHES) {
        world->meshes[0] = finish_mesh(make_lump(6, 0.2, seed));
        world->meshes[1] = meshes == WHOLE_MESHES ? make_sheet(seed) : make_sieve(seed);
        world->scene.mesh_count = 2;
    }
    world->scene.meshes = world->meshes;
    world->scene.sun.present = true;
    world->scene.sun.direction = random_direction(seed);
    for (int i = 0; i < SOLIDS; i++) {
        world->solids[i] = random_solid(world, seed);
        world->solids[i].moves = neph_test_uniform(seed, 0.0, 1.0) < 0.1;
    }
    world->scene.solids = world->solids;
}

/* The world without solids that are wide or move, which are not in the grid. */
static struct neph_scene leave_out_apart(const struct world *world, struct neph_solid *solids)
{
    const struct neph_bounds hull = neph_plain_hull(&world->scene);
    struct neph_scene rest = world->scene;
    rest.solids = solids;
    rest.solid_count = 0;
    for (int i = 0; i < SOLIDS; i++)
        if (!neph_is_apart(&world->solids[i], &hull))
            solids[rest.solid_count++] = world->solids[i];
    return rest;
}

/* 0: it does not decide, and the solids that may hide the sun are listed; 1: lit; 2: hidden. As in
 * shaders/sun_grid.glsl. */
static int decide(const struct neph_sun_grid *grid, struct neph_vec3 point_m, uint32_t *listed)
{
    const struct neph_sun_point at = neph_sun_point(&grid->axes, point_m);
    const int column = (int)floor((at.u - grid->low_u_m) / grid->cell_m);
    const int row = (int)floor((at.v - grid->low_v_m) / grid->cell_m);
    if (column < 0 || column >= grid->width || row < 0 || row >= grid->height)
        return 1;
    const float *limits_m = grid->limits_m[row * grid->width + column];
    *listed = grid->listed[row * grid->width + column];
    return at.w >= (double)limits_m[1] ? 1 : at.w <= (double)limits_m[0] ? 2 : 0;
}

/* The solids of a list, with all meshes. */
static struct neph_scene take_listed(const struct neph_scene *scene, uint32_t listed,
                                     struct neph_solid *solids)
{
    struct neph_scene taken = *scene;
    uint32_t number = 0;
    taken.solids = solids;
    taken.solid_count = 0;
    for (int i = 0; i < scene->solid_count; i++) {
        const bool is_mesh = scene->solids[i].kind == NEPH_SOLID_MESH;
        bool is_taken = is_mesh && !scene->solids[i].moves;
        for (uint32_t k = 0; k < (listed & 3) && !is_mesh; k++)
            is_taken |= (listed >> (2 + NEPH_GPU_LISTED_BITS * k) & 1023) == number;
        number += !is_mesh;
        if (is_taken)
            solids[taken.solid_count++] = scene->solids[i];
    }
    return taken;
}

static void check_worlds(enum meshes meshes)
{
    uint64_t seed = 61;
    int decided = 0, hidden = 0, known_hidden = 0, all = 0, by_list = 0;
    for (int n = 0; n < 6; n++) {
        OWNED(world) struct world world;
        OWNED(grid) struct neph_sun_grid grid = {.cell_m = 0.0};
        struct neph_solid solids[SOLIDS];
        struct neph_diag diag = {0};
        make_world(&world, meshes, &seed);
        assert_true(neph_sun_grid_room(&world.scene) > 0);
        neph_assert_ok(neph_sun_grid_create(&world.scene, &grid, &diag), &diag);
        assert_true((size_t)grid.width * (size_t)grid.height <= neph_sun_grid_room(&world.scene));
        const struct neph_scene rest = leave_out_apart(&world, solids);
        for (int i = 0; i < POINTS; i++) {
            const struct neph_vec3 point_m = random_point(&seed, 130.0);
            const bool sees = neph_scene_is_sun_visible(&rest, point_m);
            uint32_t listed = 0;
            const int said = decide(&grid, point_m, &listed);
            if (said == 0 && listed != NEPH_GPU_MANY_LISTED) {
                struct neph_solid few[SOLIDS];
                const struct neph_scene taken = take_listed(&world.scene, listed, few);
                assert_int_equal(neph_scene_is_sun_visible(&taken, point_m), sees);
                by_list++;
            }
            if (said != 0) {
                if (said != (sees ? 1 : 2))
                    print_error("world %d, point %d\n", n, i);
                assert_int_equal(said, sees ? 1 : 2);
            }
            all++;
            hidden += !sees;
            decided += said != 0;
            known_hidden += said == 2;
        }
    }
    print_message("%d of %d decided and %d by few solids, %d of %d hidden known\n", decided, all,
                  by_list, known_hidden, hidden);
    assert_true(decided > 0.9 * all && by_list > 0.5 * (all - decided));
    assert_true(known_hidden > 0.5 * hidden);
}

static void test_the_grid_of_boxes_and_balls_decides_as_rays_do(void **state)
{
    check_worlds(NO_MESHES);
}

static void test_the_grid_of_meshes_decides_as_rays_do(void **state)
{
    check_worlds(WHOLE_MESHES);
}

static void test_the_grid_of_meshes_with_holes_decides_as_rays_do(void **state)
{
    check_worlds(MESHES_WITH_HOLES);
}

/* A change of sun or solids makes the grid unfit, but not of a solid that moves. */
static void test_a_grid_is_for_one_sun_and_its_solids(void **state)
{
    uint64_t seed = 5;
    OWNED(world) struct world world;
    OWNED(grid) struct neph_sun_grid grid = {.cell_m = 0.0};
    make_world(&world, NO_MESHES, &seed);
    world.solids[7].moves = false;
    world.solids[8].moves = true;
    assert_false(neph_sun_grid_fits(&grid, &world.scene));
    neph_assert_ok(neph_sun_grid_create(&world.scene, &grid, NULL), NULL);
    assert_true(neph_sun_grid_fits(&grid, &world.scene));
    world.solids[7].box.max_m.y += 1e-9;
    assert_false(neph_sun_grid_fits(&grid, &world.scene));
    world.solids[7].box.max_m.y -= 1e-9;
    world.solids[8].box.max_m.y += 1.0;
    world.solids[8].center_m.y += 1.0;
    assert_true(neph_sun_grid_fits(&grid, &world.scene));
    world.solids[8].moves = false;
    assert_false(neph_sun_grid_fits(&grid, &world.scene));
    world.solids[8].moves = true;
    world.scene.sun.direction = random_direction(&seed);
    assert_false(neph_sun_grid_fits(&grid, &world.scene));
    world.scene.solid_count = 4;
    assert_int_equal(neph_sun_grid_room(&world.scene), 0);
}

#include "tests/main.h"
