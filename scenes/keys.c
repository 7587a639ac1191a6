/* SPDX-License-Identifier: MIT */
#include "scenes/keys.h"

static double frame_of(const void *keys, size_t size, int index)
{
    return *(const double *)((const char *)keys + (size_t)index * size);
}

struct neph_span neph_span_at(const void *keys, size_t size, int count, double frame)
{
    const int last = count - 1;
    if (frame <= frame_of(keys, size, 0))
        return (struct neph_span){0, 0, 0.0};
    if (frame >= frame_of(keys, size, last))
        return (struct neph_span){last, last, 0.0};
    int from = 0, to = last;
    while (to - from > 1) {
        const int middle = (from + to) / 2;
        if (frame_of(keys, size, middle) <= frame)
            from = middle;
        else
            to = middle;
    }
    const double start = frame_of(keys, size, from), end = frame_of(keys, size, to);
    return (struct neph_span){from, to, (frame - start) / (end - start)};
}

struct neph_vec3 neph_mix(struct neph_vec3 a, struct neph_vec3 b, double part)
{
    return neph_vec3_add(neph_vec3_scale(a, 1.0 - part), neph_vec3_scale(b, part));
}
