/* SPDX-License-Identifier: MIT */
#include "harness/frame_stats.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char prefix[] = "neph.stats.";

json_t *neph_frame_stats(const struct neph_image *frame)
{
    json_t *stats = json_object();
    for (int i = 0; i < frame->attribute_count; i++) {
        const struct neph_attribute *attribute = &frame->attributes[i];
        if (strncmp(attribute->name, prefix, strlen(prefix)) == 0)
            json_object_set_new(stats, attribute->name + strlen(prefix),
                                json_real(strtod(attribute->value, NULL)));
    }
    return stats;
}

static void print_row(const json_t *frames, const char *name)
{
    double sum = 0.0, least = INFINITY, most = -INFINITY;
    size_t index, count = 0;
    json_t *frame;
    json_array_foreach(frames, index, frame)
    {
        const json_t *number = json_object_get(frame, name);
        if (!number)
            continue;
        const double value = json_number_value(number);
        sum += value;
        least = fmin(least, value);
        most = fmax(most, value);
        count++;
    }
    printf("%-32s %14.6g %14.6g %14.6g\n", name, sum / (double)count, least, most);
}

void neph_frame_stats_print(const json_t *frames)
{
    json_t *first = json_array_get(frames, 0);
    if (json_object_size(first) == 0) {
        printf("this engine counts nothing\n");
        return;
    }
    printf("%-32s %14s %14s %14s\n", "per frame", "mean", "least", "most");
    const char *name;
    json_t *value;
    json_object_foreach(first, name, value) print_row(frames, name);
}
