/* SPDX-License-Identifier: MIT */
#include "renderer/solid_tree.h"

#include "scenes/scene.h"

#include <math.h>

_Static_assert(NEPH_SOLID_KIND_COUNT == 3, "a new kind");

enum { LEAF = NEPH_GPU_LEAF_SOLIDS, SOLIDS_MAX = NEPH_GPU_SOLIDS_MAX };

enum tree { APART, OTHERS, TREE_COUNT };

/* A solid's box, the place of its centre, and its number. */
struct boxed {
    float low_m[3], high_m[3], center_m[3];
    uint32_t solid;
};

struct builder {
    struct boxed boxes[SOLIDS_MAX]; /* in the order of the leaves */
    struct neph_gpu_solid_node *nodes;
    uint32_t node_count;
};

/* Half the side of the box around a solid, along an axis. */
static float find_half(const struct neph_gpu_solid *solid, int axis)
{
    const int about = (int)solid->kind - (int)NEPH_GPU_SOLID_TURNED, second = (axis + 1) % 3,
              third = (axis + 2) % 3;
    float half_m[3];
    if (solid->kind == NEPH_SOLID_SPHERE)
        return solid->radius_m;
    for (int k = 0; k < 3; k++)
        half_m[k] = 0.5f * (solid->high_m[k] - solid->low_m[k]);
    if (solid->kind == NEPH_SOLID_BOX || axis == about)
        return half_m[axis];
    return fabsf(solid->radius_m) * half_m[axis] +
           fabsf(solid->albedo[3]) * half_m[second == about ? third : second];
}

/* The box around a solid; around a sphere or a rotated box, larger by a margin. */
static struct boxed find_box(const struct neph_gpu_solid *solid, uint32_t number)
{
    struct boxed boxed = {.solid = number};
    const bool is_ball = solid->kind == NEPH_SOLID_SPHERE, is_box = solid->kind == NEPH_SOLID_BOX;
    float far_m = 0.0f;
    for (int axis = 0; axis < 3; axis++) {
        const float half_m = find_half(solid, axis);
        boxed.center_m[axis] = is_ball ? solid->low_m[axis]
                                       : 0.5f * (solid->low_m[axis] + solid->high_m[axis]);
        boxed.low_m[axis] = is_box ? solid->low_m[axis] : boxed.center_m[axis] - half_m;
        boxed.high_m[axis] = is_box ? solid->high_m[axis] : boxed.center_m[axis] + half_m;
        far_m = fmaxf(far_m, fmaxf(fabsf(boxed.low_m[axis]), fabsf(boxed.high_m[axis])));
    }
    for (int axis = 0; axis < 3 && !is_box; axis++) {
        boxed.low_m[axis] -= NEPH_GPU_NODE_MARGIN * far_m;
        boxed.high_m[axis] += NEPH_GPU_NODE_MARGIN * far_m;
    }
    return boxed;
}

/* Extend a box by another. */
static void include(struct boxed *around, const struct boxed *box)
{
    for (int axis = 0; axis < 3; axis++) {
        around->low_m[axis] = fminf(around->low_m[axis], box->low_m[axis]);
        around->high_m[axis] = fmaxf(around->high_m[axis], box->high_m[axis]);
    }
}

static const struct boxed nothing = {.low_m = {INFINITY, INFINITY, INFINITY},
                                     .high_m = {-INFINITY, -INFINITY, -INFINITY}};

/* The axis along which the centres are spread most. */
static int choose_axis(const struct boxed *boxes, int count)
{
    float spread_m[3];
    int widest = 0;
    for (int axis = 0; axis < 3; axis++) {
        float least_m = INFINITY, most_m = -INFINITY;
        for (int i = 0; i < count; i++) {
            least_m = fminf(least_m, boxes[i].center_m[axis]);
            most_m = fmaxf(most_m, boxes[i].center_m[axis]);
        }
        spread_m[axis] = most_m - least_m;
        widest = spread_m[axis] > spread_m[widest] ? axis : widest;
    }
    return widest;
}

static bool is_before(const struct boxed *a, const struct boxed *b, int axis)
{
    return a->center_m[axis] < b->center_m[axis] ||
           (a->center_m[axis] == b->center_m[axis] && a->solid < b->solid);
}

/* Exchange boxes until the first `part` are before all others along an axis (C. A. R. Hoare,
 * "Algorithm 65: Find", CACM 4, 1961). */
static void divide(struct boxed *boxes, int count, int part, int axis)
{
    int low = 0, high = count - 1;
    while (low < high) {
        const struct boxed pivot = boxes[(low + high) / 2];
        int i = low, j = high;
        while (i <= j) {
            while (is_before(&boxes[i], &pivot, axis))
                i++;
            while (is_before(&pivot, &boxes[j], axis))
                j--;
            if (i > j)
                break;
            const struct boxed kept = boxes[i];
            boxes[i++] = boxes[j];
            boxes[j--] = kept;
        }
        if (part <= j)
            high = j;
        else if (part >= i)
            low = i;
        else
            return;
    }
}

static struct boxed find_hull(const struct boxed *boxes, int count)
{
    struct boxed hull = nothing;
    for (int i = 0; i < count; i++)
        include(&hull, &boxes[i]);
    return hull;
}

static float squared_distance(const struct boxed *box)
{
    float sum = 0.0f;
    for (int axis = 0; axis < 3; axis++) {
        const float from_m = fmaxf(0.0f, fmaxf(box->low_m[axis], -box->high_m[axis]));
        sum += from_m * from_m;
    }
    return sum;
}

/* The part of the boxes that is nearer to the camera is first: view rays meet near solids first
 * then, and pass the boxes of far ones. */
static void build(struct builder *builder, int first, int count)
{
    struct neph_gpu_solid_node *node = &builder->nodes[builder->node_count++];
    struct boxed *boxes = &builder->boxes[first];
    const struct boxed all = find_hull(boxes, count);
    for (int axis = 0; axis < 3; axis++) {
        node->low_m[axis] = all.low_m[axis];
        node->high_m[axis] = all.high_m[axis];
    }
    node->leaf = count <= LEAF ? (uint32_t)first << 4 | (uint32_t)count : 0;
    if (count > LEAF) {
        const int leaves = (count + LEAF - 1) / LEAF, part = LEAF * ((leaves + 1) / 2);
        divide(boxes, count, part, choose_axis(boxes, count));
        const struct boxed low = find_hull(boxes, part),
                           high = find_hull(boxes + part, count - part);
        const bool swaps = squared_distance(&high) < squared_distance(&low);
        if (swaps)
            build(builder, first + part, count - part);
        build(builder, first, part);
        if (!swaps)
            build(builder, first + part, count - part);
    }
    node->next = builder->node_count;
}

uint32_t neph_solid_tree_build(struct neph_gpu_solids *gpu, uint32_t count, const bool *is_apart)
{
    struct builder builder = {.nodes = gpu->solid_nodes};
    uint32_t apart_nodes = 0;
    int placed = 0;
    for (int tree = APART; tree < TREE_COUNT; tree++) {
        const int first = placed;
        for (uint32_t i = 0; i < count; i++) {
            if (is_apart[i] == (tree == APART))
                builder.boxes[placed++] = find_box(&gpu->solids[i], i);
        }
        if (placed > first)
            build(&builder, first, placed - first);
        apart_nodes = tree == APART ? builder.node_count : apart_nodes;
    }
    for (uint32_t i = 0; i < count; i++)
        gpu->solid_order[i / 4][i % 4] = builder.boxes[i].solid;
    for (uint32_t n = 0; n < builder.node_count; n++)
        if (gpu->solid_nodes[n].next == builder.node_count)
            gpu->solid_nodes[n].next = UINT32_MAX;
    return apart_nodes;
}
