/* SPDX-License-Identifier: MIT */
#include "scenes/failing.h"

#include <stdio.h>

int neph_failing_axis_count(const struct neph_failing_axis *axis)
{
    return axis->to_count + axis->by_count;
}

int neph_failing_point_count(const struct neph_failing *failing)
{
    int product = 1;
    for (int i = 0; i < failing->axis_count; i++)
        product *= neph_failing_axis_count(&failing->axes[i]);
    return failing->axis_count > 0 ? 1 + product : 1;
}

int neph_failing_value_index(const struct neph_failing *failing, int point, int axis)
{
    int rest = point - 1;
    for (int i = failing->axis_count - 1; i > axis; i--)
        rest /= neph_failing_axis_count(&failing->axes[i]);
    return rest % neph_failing_axis_count(&failing->axes[axis]);
}

static double value_at(const struct neph_failing_axis *axis, int index)
{
    return axis->to_count > 0 ? axis->to[index] : axis->by[index];
}

void neph_failing_point_name(const struct neph_failing *failing, int point, char *text, size_t size)
{
    size_t used = 0;
    text[0] = '\0';
    for (int i = 0; i < failing->axis_count && point > 0 && used < size; i++) {
        const struct neph_failing_axis *axis = &failing->axes[i];
        const double value = value_at(axis, neph_failing_value_index(failing, point, i));
        used += (size_t)snprintf(text + used, size - used, "%s%s%s%g", i ? " " : "", axis->name,
                                 axis->to_count > 0 ? "=" : "+=", value);
    }
}
