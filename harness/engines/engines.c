/* SPDX-License-Identifier: MIT */
#include "harness/engines/engines.h"

#include <string.h>

#define LISTED(name) &neph_engine_##name,
static const struct neph_engine *const registry[] = {NEPH_ENGINES(LISTED)};
#undef LISTED

const struct neph_engine *const *neph_engines_and_guests(int *count)
{
    *count = (int)(sizeof(registry) / sizeof(registry[0]));
    return registry;
}

const struct neph_engine *const *neph_engines(int *count)
{
    neph_engines_and_guests(count);
    while (registry[*count - 1]->is_guest)
        (*count)--;
    return registry;
}

const struct neph_engine *neph_engine_find(const char *name)
{
    int count;
    const struct neph_engine *const *engines = neph_engines_and_guests(&count);
    for (int i = 0; i < count; i++)
        if (strcmp(engines[i]->name, name) == 0)
            return engines[i];
    return NULL;
}
