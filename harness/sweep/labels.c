/* SPDX-License-Identifier: MIT */
#include "harness/sweep/labels.h"

#include <math.h>

struct box {
    double left, top, right, bottom;
};

/* Directions from the mark; -1, 0, 1: the name's left edge, middle or right edge lies there. */
static const struct {
    double x, y;
} ways[] = {{1, 0}, {1, -1}, {1, 1}, {-1, 0}, {-1, -1}, {-1, 1}, {0, -1}, {0, 1}};
enum { WAYS = sizeof(ways) / sizeof(ways[0]) };

static const double distances_px[] = {9, 14, 20, 28, 38, 50};
enum { DISTANCES = sizeof(distances_px) / sizeof(distances_px[0]) };

static double overlap(const struct box *a, const struct box *b)
{
    const double width = fmin(a->right, b->right) - fmax(a->left, b->left);
    const double height = fmin(a->bottom, b->bottom) - fmax(a->top, b->top);
    return width > 0.0 && height > 0.0 ? width * height : 0.0;
}

static struct box box_of(const struct neph_label *label)
{
    const double left = label->x_px + label->dx_px, middle = label->y_px + label->dy_px;
    return (struct box){left, middle - 0.5 * NEPH_LABEL_HEIGHT_PX, left + label->width_px,
                        middle + 0.5 * NEPH_LABEL_HEIGHT_PX};
}

static struct box mark_of(const struct neph_label *label)
{
    return (struct box){label->x_px - NEPH_MARK_RADIUS_PX, label->y_px - NEPH_MARK_RADIUS_PX,
                        label->x_px + NEPH_MARK_RADIUS_PX, label->y_px + NEPH_MARK_RADIUS_PX};
}

/* The area of a name that lies on something or outside. */
static double hidden(const struct neph_label *labels, int count, int index, const struct box *plot)
{
    const struct box box = box_of(&labels[index]);
    double area = (box.right - box.left) * (box.bottom - box.top) - overlap(&box, plot);
    for (int i = 0; i < count; i++) {
        const struct box mark = mark_of(&labels[i]);
        area += overlap(&box, &mark);
        if (i < index && labels[i].width_px > 0.0) {
            const struct box name = box_of(&labels[i]);
            area += overlap(&box, &name);
        }
    }
    return area;
}

static void put(struct neph_label *label, int way, double distance_px)
{
    const double x = ways[way].x, y = ways[way].y;
    label->dx_px = x * distance_px - (x < 0.0 ? 1.0 : x > 0.0 ? 0.0 : 0.5) * label->width_px;
    label->dy_px = y * (x == 0.0 ? distance_px + 2.0 : distance_px);
}

static void place(struct neph_label *labels, int count, int index, const struct box *plot)
{
    double least = INFINITY;
    struct neph_label best = labels[index];
    for (int d = 0; d < DISTANCES && least > 0.0; d++)
        for (int way = 0; way < WAYS && least > 0.0; way++) {
            put(&labels[index], way, distances_px[d]);
            const double area = hidden(labels, count, index, plot);
            if (area < least) {
                least = area;
                best = labels[index];
            }
        }
    labels[index] = best;
    labels[index].is_clear = !(least > 0.0);
}

void neph_labels_place(struct neph_label *labels, int count, double width_px, double height_px,
                       double margin_px)
{
    const struct box plot = {0.0, 0.0, width_px + margin_px, height_px};
    for (int i = 0; i < count; i++)
        if (labels[i].width_px > 0.0)
            place(labels, count, i, &plot);
}
