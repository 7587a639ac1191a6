/* SPDX-License-Identifier: MIT */
#include "harness/engines/frame_stats.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char prefix[] = "neph.stats.";

enum neph_status neph_frame_stats_set(struct neph_image *frame, const char *name, double value,
                                      struct neph_diag *diag)
{
    char full[NEPH_IMAGE_NAME_MAX];
    if (!isfinite(value))
        return NEPH_OK;
    snprintf(full, sizeof(full), "%s%s", prefix, name);
    return neph_image_set_attribute(frame, full, diag, "%.15g", value);
}

enum neph_status neph_frame_stats_set_all(struct neph_image *frame,
                                          const struct neph_frame_stat *stats, size_t count,
                                          struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (size_t i = 0; i < count && !status; i++)
        status = neph_frame_stats_set(frame, stats[i].name, stats[i].value, diag);
    return status;
}

enum neph_status neph_frame_stats_set_pass(struct neph_image *frame, const char *pass,
                                           const char *ending, double gpu_s, struct neph_diag *diag)
{
    char name[NEPH_IMAGE_NAME_MAX];
    snprintf(name, sizeof(name), "%s_%s", pass, ending);
    for (char *c = name; *c; c++)
        *c = *c == ' ' || *c == '-' ? '_' : *c;
    return gpu_s > 0.0 ? neph_frame_stats_set(frame, name, 1e3 * gpu_s, diag) : NEPH_OK;
}

/* Integers stay integers. */
static json_t *parse_stat_number(const char *text)
{
    char *end;
    const long long whole = strtoll(text, &end, 10);
    return *end ? json_real(strtod(text, NULL)) : json_integer(whole);
}

json_t *neph_frame_stats(const struct neph_image *frame)
{
    json_t *stats = json_object();
    for (int i = 0; i < frame->attribute_count; i++) {
        const struct neph_attribute *attribute = &frame->attributes[i];
        if (strncmp(attribute->name, prefix, strlen(prefix)) == 0)
            neph_json_set(&stats, attribute->name + strlen(prefix),
                          parse_stat_number(attribute->value));
    }
    return stats;
}

/* Print integers with all digits. */
static void print_number(double value)
{
    if (value == trunc(value) && fabs(value) < 1e15)
        printf(" %15.0f", value);
    else
        printf(" %15.6g", value);
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
    printf("%-30s", name);
    print_number(sum / (double)count);
    print_number(least);
    print_number(most);
    putchar('\n');
}

void neph_frame_stats_print(const json_t *frames)
{
    json_t *first = json_array_get(frames, 0);
    if (json_object_size(first) == 0) {
        printf("this engine counts nothing\n");
        return;
    }
    printf("%-30s %15s %15s %15s\n", "per frame", "mean", "least", "most");
    const char *name;
    json_t *value;
    json_object_foreach(first, name, value) print_row(frames, name);
}
