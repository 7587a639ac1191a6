/* SPDX-License-Identifier: MIT */
#include "harness/fly/times.h"

#include "harness/engines/frame_stats.h"
#include "metrics/statistics.h"

#include <math.h>
#include <string.h>

static const double weight_of_new = 1.0 / 8.0;
static const char pass_end[] = "_gpu_ms";

void neph_fly_times_add(struct neph_fly_times *times, double seconds)
{
    if (isfinite(seconds))
        times->seconds[times->count++ % NEPH_FLY_TIMES_MAX] = seconds;
}

double neph_fly_times_median_s(const struct neph_fly_times *times)
{
    const int count = times->count < NEPH_FLY_TIMES_MAX ? times->count : NEPH_FLY_TIMES_MAX;
    double values[NEPH_FLY_TIMES_MAX];
    if (count == 0)
        return NAN;
    memcpy(values, times->seconds, (size_t)count * sizeof(values[0]));
    return neph_percentile(values, (size_t)count, 0.5);
}

/* The pass name in a statistic, "march" of "march_gpu_ms"; false: not the time of a pass. */
static bool parse_pass_name(const char *number, char name[NEPH_IMAGE_NAME_MAX])
{
    const size_t length = strlen(number), end = sizeof(pass_end) - 1;
    if (length <= end || length >= NEPH_IMAGE_NAME_MAX || strcmp(number + length - end, pass_end))
        return false;
    memset(name, 0, NEPH_IMAGE_NAME_MAX);
    memcpy(name, number, length - end);
    for (char *c = name; *c; c++)
        *c = *c == '_' ? ' ' : *c;
    return true;
}

static void mix(struct neph_fly_passes *passes, const char *name, double seconds)
{
    int i = 0;
    while (i < passes->count && strcmp(passes->passes[i].name, name) != 0)
        i++;
    if (i == NEPH_FLY_PASSES_MAX)
        return;
    double *mean_s = &passes->passes[i].mean_s;
    if (i < passes->count) {
        *mean_s += weight_of_new * (seconds - *mean_s);
        return;
    }
    memcpy(passes->passes[i].name, name, NEPH_IMAGE_NAME_MAX);
    *mean_s = seconds;
    passes->count++;
}

void neph_fly_passes_add_frame(struct neph_fly_passes *passes, const struct neph_image *frame)
{
    json_t *stats = neph_frame_stats(frame), *value;
    const char *key;
    char name[NEPH_IMAGE_NAME_MAX];
    json_object_foreach(stats, key, value) if (parse_pass_name(key, name))
        mix(passes, name, 1e-3 * json_number_value(value));
    json_decref(stats);
}
