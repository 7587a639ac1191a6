/* SPDX-License-Identifier: MIT
 *
 * Placement of names on a chart.
 */
#include "harness/sweep/labels.h"

#include <math.h>

struct box {
    double left, top, right, bottom;
};

/* Directions from the mark; -1, 0, 1: the name's right edge, centre or left edge is at the
 * distance. */
static const struct {
    double x, y;
} ways[] = {{1, 0}, {1, -1}, {1, 1}, {-1, 0}, {-1, -1}, {-1, 1}, {0, -1}, {0, 1}};
enum { WAYS = sizeof(ways) / sizeof(ways[0]) };

static const double distances_px[] = {9, 14, 20, 28, 38, 50};
enum { DISTANCES = sizeof(distances_px) / sizeof(distances_px[0]) };

/* Costs of a place as areas: a line under a name counts with a width of line_px; each larger
 * distance adds far_px2. A name farther than near_px gets a leader line. */
static const double line_px = 3.0, far_px2 = 12.0, near_px = 10.0;

static double overlap(const struct box *a, const struct box *b)
{
    const double width = fmin(a->right, b->right) - fmax(a->left, b->left);
    const double height = fmin(a->bottom, b->bottom) - fmax(a->top, b->top);
    return width > 0.0 && height > 0.0 ? width * height : 0.0;
}

static struct box label_rectangle(const struct neph_label *label)
{
    const double left = label->x_px + label->dx_px, middle = label->y_px + label->dy_px;
    return (struct box){left, middle - 0.5 * NEPH_LABEL_HEIGHT_PX, left + label->width_px,
                        middle + 0.5 * NEPH_LABEL_HEIGHT_PX};
}

static struct box mark_rectangle(const struct neph_label *label)
{
    return (struct box){label->x_px - NEPH_MARK_RADIUS_PX, label->y_px - NEPH_MARK_RADIUS_PX,
                        label->x_px + NEPH_MARK_RADIUS_PX, label->y_px + NEPH_MARK_RADIUS_PX};
}

/* The part of a line within a box, 0..1 (C. Liang, B. Barsky, ACM TOG 3, 1984). */
static double part_within(const struct neph_label_line *line, const struct box *box)
{
    const double dx = line->x1_px - line->x0_px, dy = line->y1_px - line->y0_px;
    const double steps[] = {-dx, dx, -dy, dy};
    const double rooms[] = {line->x0_px - box->left, box->right - line->x0_px,
                            line->y0_px - box->top, box->bottom - line->y0_px};
    double enter = 0.0, leave = 1.0;
    for (int i = 0; i < 4; i++) {
        if (steps[i] == 0.0 && rooms[i] < 0.0)
            return 0.0;
        if (steps[i] < 0.0)
            enter = fmax(enter, rooms[i] / steps[i]);
        if (steps[i] > 0.0)
            leave = fmin(leave, rooms[i] / steps[i]);
    }
    return fmax(leave - enter, 0.0);
}

/* The area of a name that overlaps marks or earlier names, or is outside of the plot. */
static double compute_hidden_area(const struct neph_label *labels, int count, int index,
                                  const struct neph_label_plot *plot)
{
    const struct box box = label_rectangle(&labels[index]);
    const struct box inside = {0.0, 0.0, plot->width_px + plot->margin_px, plot->height_px};
    double area = (box.right - box.left) * (box.bottom - box.top) - overlap(&box, &inside);
    for (int i = 0; i < count; i++) {
        const struct box mark = mark_rectangle(&labels[i]);
        area += overlap(&box, &mark);
        if (i < index && labels[i].width_px > 0.0) {
            const struct box name = label_rectangle(&labels[i]);
            area += overlap(&box, &name);
        }
    }
    return area;
}

/* The area of lines under a name. */
static double compute_crossed_area(const struct neph_label *label,
                                   const struct neph_label_plot *plot)
{
    const struct box box = label_rectangle(label);
    double area = 0.0;
    for (int i = 0; i < plot->line_count; i++) {
        const struct neph_label_line *line = &plot->lines[i];
        const double length = hypot(line->x1_px - line->x0_px, line->y1_px - line->y0_px);
        area += line_px * length * part_within(line, &box);
    }
    return area;
}

static void put(struct neph_label *label, int way, double distance_px)
{
    const double x = ways[way].x, y = ways[way].y;
    label->dx_px = x * distance_px - (x < 0.0 ? 1.0 : x > 0.0 ? 0.0 : 0.5) * label->width_px;
    label->dy_px = y * (x == 0.0 ? distance_px + 2.0 : distance_px);
    label->is_apart = distance_px > near_px;
    label->lead_x_px = label->x_px + x * (distance_px - 2.0);
    label->lead_y_px = label->y_px + label->dy_px - 0.5 * y * NEPH_LABEL_HEIGHT_PX * (x == 0.0);
}

static void place(struct neph_label *labels, int count, int index,
                  const struct neph_label_plot *plot)
{
    double least = INFINITY;
    struct neph_label best = labels[index];
    for (int d = 0; d < DISTANCES && least > 0.0; d++)
        for (int way = 0; way < WAYS && least > 0.0; way++) {
            put(&labels[index], way, distances_px[d]);
            const double on_things = compute_hidden_area(labels, count, index, plot);
            const double cost = on_things + compute_crossed_area(&labels[index], plot) +
                                d * far_px2;
            if (cost < least) {
                least = cost;
                best = labels[index];
                best.is_clear = !(on_things > 0.0);
            }
        }
    labels[index] = best;
}

void neph_labels_place(struct neph_label *labels, int count, const struct neph_label_plot *plot)
{
    for (int i = 0; i < count; i++)
        if (labels[i].width_px > 0.0)
            place(labels, count, i, plot);
}
