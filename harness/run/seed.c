/* SPDX-License-Identifier: MIT
 *
 * Seeds of scenes.
 */
#include "harness/run/seed.h"

/* The finalizer of splitmix64 (S. Vigna 2015). */
static uint64_t mix(uint64_t z)
{
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

uint64_t neph_seed_for_scene(const struct neph_scene *scene, int number)
{
    uint64_t hash = 0x9e3779b97f4a7c15u;
    for (const char *c = scene->hash; *c; c++)
        hash = mix(hash + (unsigned char)*c);
    return 1 + mix(hash + (uint64_t)number) % 0x7fffffff;
}
