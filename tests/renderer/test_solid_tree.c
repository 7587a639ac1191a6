/* SPDX-License-Identifier: MIT
 *
 * Trees around the solids of a scene: every solid is in one leaf, within the boxes of all nodes
 * above it, and whoever leaves a node out continues behind all of its children.
 */
#include "tests/neph_test.h"

#include "renderer/solid_tree.h"
#include "scenes/scene.h"

#include <math.h>
#include <stdlib.h>

static void make_solids(struct neph_gpu_solids *gpu, uint32_t count, uint64_t *seed)
{
    for (uint32_t i = 0; i < count; i++) {
        struct neph_gpu_solid *solid = &gpu->solids[i];
        const double kind = neph_test_uniform(seed, 0.0, 1.0);
        solid->kind = kind < 0.1 ? NEPH_SOLID_SPHERE : kind < 0.2 ? 2 + i % 3 : NEPH_SOLID_BOX;
        for (int axis = 0; axis < 3; axis++) {
            const double size_m = pow(10.0, neph_test_uniform(seed, -1.0, i % 50 ? 1.0 : 3.0));
            solid->low_m[axis] = (float)neph_test_uniform(seed, -100.0, 100.0);
            solid->high_m[axis] = solid->low_m[axis] + (float)size_m;
        }
        const double angle = neph_test_uniform(seed, 0.0, 2.0 * M_PI);
        const bool is_ball = solid->kind == NEPH_SOLID_SPHERE;
        solid->radius_m = is_ball ? solid->high_m[0] - solid->low_m[0] : (float)cos(angle);
        solid->albedo[3] = (float)sin(angle);
    }
}

static bool has_point(const struct neph_gpu_solid_node *node, const double point_m[3])
{
    bool has = true;
    for (int axis = 0; axis < 3; axis++)
        has = has && point_m[axis] >= node->low_m[axis] && point_m[axis] <= node->high_m[axis];
    return has;
}

/* Corners of the box, or of the box around a sphere; a rotated box turns them about its middle, by
 * the cosine in radius_m and the sine in albedo[3]. */
static bool is_within(const struct neph_gpu_solid *solid, const struct neph_gpu_solid_node *node)
{
    bool is_in = true;
    for (int corner = 0; corner < 8; corner++) {
        double from_m[3], point_m[3];
        for (int axis = 0; axis < 3; axis++) {
            const double low = (double)solid->low_m[axis], high = (double)solid->high_m[axis];
            const bool is_ball = solid->kind == NEPH_SOLID_SPHERE;
            const double half = is_ball ? (double)solid->radius_m : 0.5 * (high - low);
            from_m[axis] = corner >> axis & 1 ? half : -half;
            point_m[axis] = (is_ball ? low : 0.5 * (low + high)) + from_m[axis];
        }
        if (solid->kind >= NEPH_GPU_SOLID_TURNED) {
            const int about = (int)(solid->kind - NEPH_GPU_SOLID_TURNED), b = (about + 1) % 3,
                      c = (about + 2) % 3;
            const double cosine = (double)solid->radius_m, sine = (double)solid->albedo[3];
            point_m[b] += (cosine - 1.0) * from_m[b] - sine * from_m[c];
            point_m[c] += sine * from_m[b] + (cosine - 1.0) * from_m[c];
        }
        is_in = is_in && has_point(node, point_m);
    }
    return is_in;
}

/* Counts the solids of the leaves from node `n` to `end`, whose boxes must be within `around`. */
static void check_nodes(const struct neph_gpu_solids *gpu, uint32_t n, uint32_t end,
                        const struct neph_gpu_solid_node *around, int *found)
{
    while (n < end) {
        const struct neph_gpu_solid_node *node = &gpu->solid_nodes[n];
        const uint32_t next = node->next < end ? node->next : end;
        assert_true(next > n);
        for (int axis = 0; axis < 3 && around; axis++)
            assert_true(around->low_m[axis] <= node->low_m[axis] &&
                        around->high_m[axis] >= node->high_m[axis]);
        if (node->leaf == 0)
            check_nodes(gpu, n + 1, next, node, found);
        else
            assert_int_equal(next, n + 1);
        for (uint32_t i = 0; i < (node->leaf & 15); i++) {
            const uint32_t place = (node->leaf >> 4) + i,
                           s = gpu->solid_order[place / 4][place % 4];
            found[s]++;
            assert_true(is_within(&gpu->solids[s], node));
        }
        n = next;
    }
}

static uint32_t count_nodes(const struct neph_gpu_solids *gpu, uint32_t count)
{
    uint32_t n = 0, last = 0;
    while (n < count) {
        last = n;
        n = gpu->solid_nodes[n].leaf == 0 ? n + 1 : gpu->solid_nodes[n].next;
    }
    return last + 1;
}

static void test_every_solid_is_in_one_leaf(void **state)
{
    const uint64_t first_seed = 3;
    struct neph_gpu_solids *gpu = calloc(1, sizeof(*gpu));
    for (uint64_t trial = 0; trial < 200; trial++) {
        uint64_t seed = first_seed + trial;
        static const uint32_t counts[] = {1, 2, 3, 8, 9, 17, 36, 255, NEPH_GPU_SOLIDS_MAX};
        const uint32_t count = counts[trial % (sizeof(counts) / sizeof(counts[0]))];
        int found[NEPH_GPU_SOLIDS_MAX] = {0};
        make_solids(gpu, count, &seed);
        if (trial % 5 == 0) /* at one place */
            for (uint32_t i = 0; i < count; i++)
                gpu->solids[i] = gpu->solids[0];
        bool is_apart[NEPH_GPU_SOLIDS_MAX];
        uint32_t apart = 0;
        for (uint32_t i = 0; i < count; i++)
            apart += is_apart[i] = neph_test_uniform(&seed, 0.0, 1.0) < 0.1;
        const uint32_t apart_nodes = neph_solid_tree_build(gpu, count, is_apart);
        assert_int_equal(apart_nodes == 0, apart == 0);
        for (uint32_t n = 0; n < apart_nodes; n++) /* only solids that are apart are in front */
            for (uint32_t i = 0; i < (gpu->solid_nodes[n].leaf & 15); i++) {
                const uint32_t place = (gpu->solid_nodes[n].leaf >> 4) + i;
                assert_true(is_apart[gpu->solid_order[place / 4][place % 4]]);
                apart--;
            }
        assert_int_equal(apart, 0);
        const uint32_t nodes = count_nodes(gpu, count);
        assert_true(nodes <= neph_solid_tree_nodes(count) && nodes <= NEPH_GPU_SOLID_NODES_MAX);
        assert_true(nodes <= count);
        check_nodes(gpu, 0, nodes, NULL, found);
        for (uint32_t i = 0; i < count; i++) {
            if (found[i] != 1)
                print_message("seed %llu\n", (unsigned long long)(first_seed + trial));
            assert_int_equal(found[i], 1);
        }
    }
    free(gpu);
}

static void test_without_solids_there_are_no_nodes(void **state)
{
    struct neph_gpu_solids *gpu = calloc(1, sizeof(*gpu));
    neph_solid_tree_build(gpu, 0, NULL);
    assert_int_equal(neph_solid_tree_nodes(0), 0);
    assert_int_equal(gpu->solid_nodes[0].next, 0); /* not written */
    for (uint32_t count = 1; count <= NEPH_GPU_SOLIDS_MAX; count++)
        assert_in_range(neph_solid_tree_nodes(count), 1, NEPH_GPU_SOLID_NODES_MAX);
    free(gpu);
}

#include "tests/main.h"
