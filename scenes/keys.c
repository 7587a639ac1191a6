/* SPDX-License-Identifier: MIT */
#include "scenes/keys.h"

#include <math.h>

static double get_key_frame(const void *keys, size_t size, int index)
{
    return *(const double *)((const char *)keys + (size_t)index * size);
}

struct neph_span neph_span_at(const void *keys, size_t size, int count, double frame)
{
    const int last = count - 1;
    if (frame <= get_key_frame(keys, size, 0))
        return (struct neph_span){0, 0, 0.0};
    if (frame >= get_key_frame(keys, size, last))
        return (struct neph_span){last, last, 0.0};
    int from = 0, to = last;
    while (to - from > 1) {
        const int middle = (from + to) / 2;
        if (get_key_frame(keys, size, middle) <= frame)
            from = middle;
        else
            to = middle;
    }
    const double start = get_key_frame(keys, size, from), end = get_key_frame(keys, size, to);
    return (struct neph_span){from, to, (frame - start) / (end - start)};
}

struct neph_vec3 neph_mix(struct neph_vec3 a, struct neph_vec3 b, double part)
{
    return neph_vec3_add(neph_vec3_scale(a, 1.0 - part), neph_vec3_scale(b, part));
}

/* The key frame of a frame with uneven advances; before frame 0 it advances evenly. */
static double advanced(const struct neph_scene *scene, double frame)
{
    double round = 0.0, sum = 0.0;
    if (frame <= 0.0)
        return frame;
    for (int i = 0; i < scene->advance_count; i++)
        round += scene->advances[i];
    const double whole = floor(frame / scene->advance_count);
    double rest = frame - whole * scene->advance_count;
    for (int i = 0; rest > 0.0; i++, rest -= 1.0)
        sum += fmin(rest, 1.0) * scene->advances[i];
    return whole * round + sum;
}

double neph_scene_time_frame(const struct neph_scene *scene, double frame)
{
    if (scene->advance_count > 0)
        return advanced(scene, frame);
    for (int i = 0; i < scene->pause_count; i++)
        if (frame > scene->pauses[i].frame)
            frame = fmax(scene->pauses[i].frame, frame - scene->pauses[i].count);
    return frame;
}
