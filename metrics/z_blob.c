/* SPDX-License-Identifier: MIT */
#include "metrics/z_blob.h"

#include <math.h>
#include <stdlib.h>

enum {
    DRAWS_MAX = 3999,
    DRAWS_MIN = 199,
    AS_LARGE_MAX = 10,           /* where Besag and Clifford stop */
    NODE_VISITS_MAX = 200000000, /* about two seconds */
};

static const double beyond = 2.0;

/* The pixels with z beyond 2, and which of them are neighbours. */
struct graph {
    uint32_t count, edge_count;
    uint32_t *pixel;      /* of each node */
    uint32_t (*edges)[2]; /* pairs of nodes */
    double *size;         /* |z| */
    int8_t *sign;
    uint32_t *parent, *members; /* of the union */
    double *sum;
};

static void finish(struct graph *graph)
{
    free(graph->pixel);
    free(graph->edges);
    free(graph->size);
    free(graph->sign);
    free(graph->parent);
    free(graph->members);
    free(graph->sum);
}

static bool allocate(struct graph *graph, size_t count)
{
    const size_t room = count + 1;
    graph->pixel = malloc(room * sizeof(*graph->pixel));
    graph->edges = malloc(2 * room * sizeof(*graph->edges));
    graph->size = malloc(room * sizeof(*graph->size));
    graph->sign = malloc(room * sizeof(*graph->sign));
    graph->parent = malloc(room * sizeof(*graph->parent));
    graph->members = malloc(room * sizeof(*graph->members));
    graph->sum = malloc(room * sizeof(*graph->sum));
    return graph->pixel && graph->edges && graph->size && graph->sign && graph->parent &&
           graph->members && graph->sum;
}

static void add_edge(struct graph *graph, uint32_t a, uint32_t b)
{
    graph->edges[graph->edge_count][0] = a;
    graph->edges[graph->edge_count][1] = b;
    graph->edge_count++;
}

/* `above`: the node of each column in the row above, UINT32_MAX where there is none. */
static void fill(struct graph *graph, const double *z, int width, int height, uint32_t *above)
{
    for (int x = 0; x < width; x++)
        above[x] = UINT32_MAX;
    for (int y = 0; y < height; y++) {
        uint32_t left = UINT32_MAX;
        for (int x = 0; x < width; x++) {
            const size_t pixel = (size_t)y * (size_t)width + (size_t)x;
            if (!(fabs(z[pixel]) > beyond)) {
                above[x] = left = UINT32_MAX;
                continue;
            }
            const uint32_t node = graph->count++;
            graph->pixel[node] = (uint32_t)pixel;
            graph->size[node] = fabs(z[pixel]);
            graph->sign[node] = z[pixel] > 0.0 ? 1 : -1;
            if (left != UINT32_MAX)
                add_edge(graph, left, node);
            if (above[x] != UINT32_MAX)
                add_edge(graph, above[x], node);
            above[x] = left = node;
        }
    }
}

static uint32_t find_root(uint32_t *parent, uint32_t node)
{
    while (parent[node] != node)
        node = parent[node] = parent[parent[node]];
    return node;
}

/* The largest sum / sqrt(members) of a connected set of nodes with one sign; `root` of that set. */
static double find_largest(struct graph *graph, uint32_t *root)
{
    double largest = 0.0;
    for (uint32_t i = 0; i < graph->count; i++) {
        graph->parent[i] = i;
        graph->members[i] = 1;
        graph->sum[i] = graph->size[i];
    }
    for (uint32_t e = 0; e < graph->edge_count; e++) {
        if (graph->sign[graph->edges[e][0]] != graph->sign[graph->edges[e][1]])
            continue;
        uint32_t a = find_root(graph->parent, graph->edges[e][0]);
        uint32_t b = find_root(graph->parent, graph->edges[e][1]);
        if (a == b)
            continue;
        if (graph->members[a] < graph->members[b]) {
            const uint32_t swapped = a;
            a = b;
            b = swapped;
        }
        graph->parent[b] = a;
        graph->members[a] += graph->members[b];
        graph->sum[a] += graph->sum[b];
    }
    for (uint32_t i = 0; i < graph->count; i++) {
        if (graph->parent[i] != i)
            continue;
        const double value = graph->sum[i] / sqrt((double)graph->members[i]);
        if (value > largest) {
            largest = value;
            *root = i;
        }
    }
    return largest;
}

static uint64_t next_random(uint64_t *state) /* splitmix64 */
{
    uint64_t z = (*state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

static void shuffle_signs(struct graph *graph, uint64_t *random)
{
    for (uint32_t i = graph->count; i > 1; i--) {
        const uint32_t k = (uint32_t)(((next_random(random) >> 32) * (uint64_t)i) >> 32);
        const int8_t swapped = graph->sign[i - 1];
        graph->sign[i - 1] = graph->sign[k];
        graph->sign[k] = swapped;
    }
}

static void toss_signs(struct graph *graph, uint64_t *random)
{
    for (uint32_t i = 0; i < graph->count; i++)
        graph->sign[i] = next_random(random) >> 63 ? 1 : -1;
}

static void describe(struct graph *graph, uint32_t root, double largest, int width_px,
                     struct neph_z_blob *blob)
{
    int *box = blob->box_px;
    box[0] = box[1] = INT32_MAX;
    box[2] = box[3] = -1;
    for (uint32_t i = 0; i < graph->count; i++) {
        if (find_root(graph->parent, i) != root)
            continue;
        const int x = (int)(graph->pixel[i] % (uint32_t)width_px);
        const int y = (int)(graph->pixel[i] / (uint32_t)width_px);
        box[0] = x < box[0] ? x : box[0];
        box[1] = y < box[1] ? y : box[1];
        box[2] = x > box[2] ? x : box[2];
        box[3] = y > box[3] ? y : box[3];
    }
    blob->pixels = graph->members[root];
    blob->mean_z = graph->sign[root] * graph->sum[root] / (double)graph->members[root];
    blob->statistic = graph->sign[root] * largest;
}

/* The p-value of `largest` for signs that mean nothing. */
static double draw_signs(struct graph *graph, double largest, bool is_symmetric, uint64_t random,
                         int *draws)
{
    uint32_t root, most = NODE_VISITS_MAX / graph->count;
    most = most > DRAWS_MAX ? DRAWS_MAX : most;
    most = most < DRAWS_MIN ? DRAWS_MIN : most;
    int as_large = 0, tried = 0;
    while (tried < (int)most && as_large < AS_LARGE_MAX) {
        if (is_symmetric)
            toss_signs(graph, &random);
        else
            shuffle_signs(graph, &random);
        as_large += find_largest(graph, &root) >= largest * (1.0 - 1e-12);
        tried++;
    }
    *draws = tried;
    return as_large == AS_LARGE_MAX ? (double)as_large / tried : (as_large + 1.0) / (tried + 1.0);
}

enum neph_status neph_z_find_blob(const double *z, int width_px, int height_px, bool is_symmetric,
                                  uint64_t seed, struct neph_z_blob *blob, struct neph_diag *diag)
{
    struct graph graph = {.count = 0};
    const size_t pixels = (size_t)width_px * (size_t)height_px;
    size_t count = 0;
    for (size_t i = 0; i < pixels; i++)
        count += fabs(z[i]) > beyond;
    *blob = (struct neph_z_blob){.pixels = 0, .p = 1.0};
    if (count == 0)
        return NEPH_OK;
    uint32_t *above = malloc((size_t)width_px * sizeof(*above)), root = 0;
    enum neph_status status = above && allocate(&graph, count) ? NEPH_OK : neph_fail_memory(diag);
    if (!status) {
        fill(&graph, z, width_px, height_px, above);
        const double largest = find_largest(&graph, &root);
        describe(&graph, root, largest, width_px, blob);
        blob->p = draw_signs(&graph, largest, is_symmetric, seed, &blob->draws);
    }
    finish(&graph);
    free(above);
    return status;
}
