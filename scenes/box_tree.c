/* SPDX-License-Identifier: MIT */
#include "scenes/box_tree.h"

#include "scenes/bounds.h"
#include "scenes/box_shadow.h"
#include "scenes/shadows.h"

#include <math.h>
#include <stdlib.h>

enum {
    BINS = 16,
    LEAF_MAX = 8,
    HEURISTIC_DEPTH = 56, /* below it, halves: 2^24 items end within DEPTH_MAX */
    DEPTH_MAX = 80,
};

static const double step_cost = 1.0, item_cost = 1.5; /* of a node and of an item, relative */

/* --- construction ---------------------------------------------------------------------------- */

struct building {
    const struct neph_bounds *boxes;
    struct neph_tree_node *nodes;
    int *order;
    int node_count;
};

static const struct neph_bounds no_bounds = {{INFINITY, INFINITY, INFINITY},
                                             {-INFINITY, -INFINITY, -INFINITY}};

static double get_component(struct neph_vec3 v, int axis)
{
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

static void extend(struct neph_bounds *bounds, const struct neph_bounds *by)
{
    bounds->min_m.x = by->min_m.x < bounds->min_m.x ? by->min_m.x : bounds->min_m.x;
    bounds->min_m.y = by->min_m.y < bounds->min_m.y ? by->min_m.y : bounds->min_m.y;
    bounds->min_m.z = by->min_m.z < bounds->min_m.z ? by->min_m.z : bounds->min_m.z;
    bounds->max_m.x = by->max_m.x > bounds->max_m.x ? by->max_m.x : bounds->max_m.x;
    bounds->max_m.y = by->max_m.y > bounds->max_m.y ? by->max_m.y : bounds->max_m.y;
    bounds->max_m.z = by->max_m.z > bounds->max_m.z ? by->max_m.z : bounds->max_m.z;
}

/* Twice the middle of a box. */
static struct neph_vec3 find_middle(const struct neph_bounds *box)
{
    return neph_vec3_add(box->min_m, box->max_m);
}

/* Half the surface of a box; 0 for an empty one. */
static double half_surface(const struct neph_bounds *box)
{
    const struct neph_vec3 side = neph_vec3_sub(box->max_m, box->min_m);
    return side.x < 0.0 ? 0.0 : side.x * side.y + side.y * side.z + side.z * side.x;
}

struct bin {
    struct neph_bounds bounds;
    int count;
};

/* Items are on the left where their bin is below `bin`. */
struct split {
    int axis, bin;
    double low, per_bin; /* of the middles */
    double cost;         /* +inf: none */
};

static int find_bin(const struct split *split, const struct neph_bounds *box)
{
    const double at = (get_component(find_middle(box), split->axis) - split->low) * split->per_bin;
    return at < BINS - 1 ? (int)at : BINS - 1;
}

/* Fills the bins of the split's axis, and lowers its cost to that of its best place. */
static void find_place(const struct building *b, const struct neph_tree_node *node,
                       struct split *split)
{
    struct bin bins[BINS];
    double right_cost[BINS];
    for (int i = 0; i < BINS; i++)
        bins[i] = (struct bin){no_bounds, 0};
    for (int i = 0; i < node->count; i++) {
        const struct neph_bounds *box = &b->boxes[b->order[node->first + i]];
        struct bin *bin = &bins[find_bin(split, box)];
        extend(&bin->bounds, box);
        bin->count++;
    }
    struct bin sum = {no_bounds, 0};
    for (int i = BINS - 1; i > 0; i--) {
        extend(&sum.bounds, &bins[i].bounds);
        sum.count += bins[i].count;
        right_cost[i] = half_surface(&sum.bounds) * sum.count;
    }
    sum = (struct bin){no_bounds, 0};
    for (int i = 1; i < BINS; i++) {
        extend(&sum.bounds, &bins[i - 1].bounds);
        sum.count += bins[i - 1].count;
        const double cost = half_surface(&sum.bounds) * sum.count + right_cost[i];
        if (sum.count > 0 && sum.count < node->count && cost < split->cost) {
            split->cost = cost;
            split->bin = i;
        }
    }
}

static struct split find_split(const struct building *b, const struct neph_tree_node *node)
{
    struct neph_bounds middles = no_bounds;
    for (int i = 0; i < node->count; i++) {
        const struct neph_vec3 at = find_middle(&b->boxes[b->order[node->first + i]]);
        extend(&middles, &(struct neph_bounds){at, at});
    }
    struct split best = {.cost = INFINITY};
    for (int axis = 0; axis < 3; axis++) {
        const double low = get_component(middles.min_m, axis);
        const double extent = get_component(middles.max_m, axis) - low;
        struct split split = {axis, 0, low, BINS / extent, INFINITY};
        if (extent > 0.0 && isfinite(split.per_bin))
            find_place(b, node, &split);
        if (split.cost < best.cost)
            best = split;
    }
    return best;
}

/* Puts the items of the left before the others, whose order changes. Returns their number. */
static int part_items(const struct building *b, const struct neph_tree_node *node,
                      const struct split *split)
{
    int *items = &b->order[node->first];
    int low = 0, high = node->count;
    while (low < high) {
        if (find_bin(split, &b->boxes[items[low]]) < split->bin) {
            low++;
            continue;
        }
        const int swap = items[--high];
        items[high] = items[low];
        items[low] = swap;
    }
    return low;
}

static void build_node(struct building *b, int at, int depth)
{
    struct neph_tree_node *node = &b->nodes[at];
    node->bounds = no_bounds;
    for (int i = 0; i < node->count; i++)
        extend(&node->bounds, &b->boxes[b->order[node->first + i]]);
    if (node->count == 1)
        return;
    const struct split split = depth < HEURISTIC_DEPTH ? find_split(b, node)
                                                       : (struct split){.cost = INFINITY};
    const double surface = half_surface(&node->bounds);
    const bool gains = step_cost * surface + item_cost * split.cost <
                       item_cost * surface * node->count;
    if (!gains && node->count <= LEAF_MAX)
        return;
    const int left_count = isfinite(split.cost) ? part_items(b, node, &split) : node->count / 2;
    const int child = b->node_count;
    b->node_count += 2;
    b->nodes[child] = (struct neph_tree_node){.first = node->first, .count = left_count};
    b->nodes[child + 1] = (struct neph_tree_node){.first = node->first + left_count,
                                                  .count = node->count - left_count};
    node->first = child;
    node->count = 0;
    build_node(b, child, depth + 1);
    build_node(b, child + 1, depth + 1);
}

static double find_largest(struct neph_vec3 v)
{
    return fmax(fabs(v.x), fmax(fabs(v.y), fabs(v.z)));
}

struct neph_box_tree neph_box_tree_build(const struct neph_bounds *boxes, int count,
                                         struct neph_tree_node *nodes, int *order)
{
    struct building building = {boxes, nodes, order, 1};
    for (int i = 0; i < count; i++)
        order[i] = i;
    nodes[0] = (struct neph_tree_node){.count = count};
    build_node(&building, 0, 0);
    return (struct neph_box_tree){
        .nodes = nodes,
        .order = order,
        .node_count = building.node_count,
        .item_count = count,
        .reach_m = fmax(find_largest(nodes[0].bounds.min_m), find_largest(nodes[0].bounds.max_m)),
    };
}

/* --- rays ------------------------------------------------------------------------------------ */

/* Boxes are larger by this part of all lengths, which is more than tests of boxes and of items
 * round. */
static const double margin_part = 1e-12;

struct slabs {
    double origin[3], inverse[3], margin_m;
    double t_min_m;
};

/* The entry into a box; +inf when the ray misses it. A ray in a face of the enlarged box (0 * inf
 * is NaN) may miss it, because it is outside the box itself. */
static double find_entry(const struct slabs *s, const struct neph_bounds *box, double limit_m)
{
    const double *low = &box->min_m.x, *high = &box->max_m.x;
    double near = s->t_min_m, far = limit_m;
    for (int axis = 0; axis < 3; axis++) {
        const double a = (low[axis] - s->margin_m - s->origin[axis]) * s->inverse[axis];
        const double b = (high[axis] + s->margin_m - s->origin[axis]) * s->inverse[axis];
        const double first = a < b ? a : b, last = a < b ? b : a;
        near = first > near ? first : near;
        far = last < far ? last : far;
    }
    return near <= far ? near : INFINITY;
}

struct waiting {
    int node;
    double entry;
};

bool neph_tree_walk_ray(const struct neph_box_tree *tree, const struct neph_tree_ray *ray,
                        neph_tree_visit *visit, void *context)
{
    const struct neph_vec3 o = ray->origin_m, d = ray->direction;
    const struct slabs slabs = {{o.x, o.y, o.z},
                                {1.0 / d.x, 1.0 / d.y, 1.0 / d.z},
                                margin_part * (tree->reach_m + find_largest(o)),
                                ray->t_min_m};
    struct waiting stack[DEPTH_MAX];
    int waiting = 0;
    stack[waiting++] = (struct waiting){0,
                                        find_entry(&slabs, &tree->nodes[0].bounds, ray->limit_m)};
    while (waiting > 0) {
        const struct waiting next = stack[--waiting];
        const struct neph_tree_node *node = &tree->nodes[next.node];
        if (!(next.entry <= ray->limit_m && next.entry < INFINITY))
            continue;
        for (int i = 0; i < node->count; i++)
            if (visit(node->first + i, context))
                return true;
        if (node->count > 0)
            continue;
        struct waiting near = {node->first, 0.0}, far = {node->first + 1, 0.0};
        near.entry = find_entry(&slabs, &tree->nodes[near.node].bounds, ray->limit_m);
        far.entry = find_entry(&slabs, &tree->nodes[far.node].bounds, ray->limit_m);
        const bool is_ordered = near.entry <= far.entry;
        stack[waiting++] = is_ordered ? far : near;
        stack[waiting++] = is_ordered ? near : far;
    }
    return false;
}

/* --- shadows --------------------------------------------------------------------------------- */

struct shadow_walk {
    const struct neph_shadow_ray *ray;
    const struct neph_shadows *known;
    double margin_m;
    /* The plane of the ray and the light: it contains all rays of light that meet the ray. */
    struct neph_vec3 normal, size; /* of any length; its absolute values */
    double at, rounding;           /* of normal . point */
};

static struct shadow_walk start_shadow_walk(const struct neph_box_tree *tree,
                                            const struct neph_shadow_ray *ray)
{
    const struct neph_vec3 o = ray->origin_m, d = ray->direction;
    const struct neph_vec3 way = ray->light_m ? neph_vec3_sub(*ray->light_m, o) : ray->sun;
    const struct neph_vec3 n = neph_vec3_cross(d, way);
    const double light_m = ray->light_m ? find_largest(*ray->light_m) : 0.0;
    const double end_m = isfinite(ray->t1_m) ? ray->t1_m * find_largest(d) : 0.0;
    const double margin_m = margin_part * (tree->reach_m + find_largest(o) + light_m + end_m);
    return (struct shadow_walk){
        .ray = ray,
        .margin_m = margin_m,
        .normal = n,
        .size = {fabs(n.x), fabs(n.y), fabs(n.z)},
        .at = neph_vec3_dot(n, o),
        .rounding = 2.0 * neph_vec3_length(d) * neph_vec3_length(way) * margin_m,
    };
}

static bool meets_light_plane(const struct shadow_walk *walk, const struct neph_bounds *box)
{
    const struct neph_vec3 side = neph_vec3_sub(box->max_m, box->min_m);
    const double from = 0.5 * neph_vec3_dot(walk->normal, find_middle(box)) - walk->at;
    return fabs(from) <= 0.5 * neph_vec3_dot(walk->size, side) + walk->rounding;
}

/* Whether a box may hide the light where no known shadow is. */
static bool may_hide(const struct shadow_walk *walk, const struct neph_bounds *box)
{
    const struct neph_shadow_ray *ray = walk->ray;
    const struct neph_vec3 margin_m = {walk->margin_m, walk->margin_m, walk->margin_m};
    const struct neph_bounds larger = {neph_vec3_sub(box->min_m, margin_m),
                                       neph_vec3_add(box->max_m, margin_m)};
    double t0_m = ray->t0_m, t1_m = ray->t1_m;
    if (!meets_light_plane(walk, box))
        return false;
    const bool hides = ray->light_m ? neph_box_point_shadow(&larger, *ray->light_m, ray->origin_m,
                                                            ray->direction, &t0_m, &t1_m)
                                    : neph_box_shadow(&larger, ray->sun, ray->origin_m,
                                                      ray->direction, &t0_m, &t1_m);
    return hides && !neph_shadows_cover(walk->known, t0_m, t1_m);
}

void neph_tree_walk_shadow(const struct neph_box_tree *tree, const struct neph_shadow_ray *ray,
                           const struct neph_shadows *known, neph_tree_visit *visit, void *context)
{
    struct shadow_walk walk = start_shadow_walk(tree, ray);
    walk.known = known;
    int stack[DEPTH_MAX], waiting = 0;
    stack[waiting++] = 0;
    while (waiting > 0) {
        const struct neph_tree_node *node = &tree->nodes[stack[--waiting]];
        if (!may_hide(&walk, &node->bounds))
            continue;
        for (int i = 0; i < node->count; i++)
            if (visit(node->first + i, context))
                return;
        if (node->count > 0)
            continue;
        stack[waiting++] = node->first + 1;
        stack[waiting++] = node->first;
    }
}
