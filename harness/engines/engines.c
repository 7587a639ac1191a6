/* SPDX-License-Identifier: MIT */
#include "harness/engines/engines.h"

#include <stdlib.h>
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

bool neph_engine_draws(const struct neph_engine *engine)
{
    return engine->rung == NEPH_RUNG_TRACER ||
           (engine->rung == NEPH_RUNG_WITNESS && engine->stochastic);
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

/* The guest that is named; NULL: the words are of a preset. */
static const struct neph_engine *guest_in(const char *words)
{
    int count;
    const struct neph_engine *const *engines = neph_engines_and_guests(&count);
    const size_t length = strcspn(words, "+");
    for (int i = 0; i < count; i++)
        if (engines[i]->is_guest && strncmp(engines[i]->name, words, length) == 0 &&
            engines[i]->name[length] == '\0')
            return engines[i];
    return NULL;
}

static enum neph_status set_guest(const struct neph_engine *guest, const char *words,
                                  struct neph_settings *settings, struct neph_diag *diag)
{
    char *text = strdup(words), *rest = text;
    enum neph_status status = text ? NEPH_OK : neph_fail_memory(diag);
    *settings = neph_settings_default(guest);
    strsep(&rest, "+");
    while (rest && !status)
        status = neph_settings_set(guest, settings, strsep(&rest, "+"), diag);
    free(text);
    return status;
}

enum neph_status neph_engine_words(const char *words, const char *shared,
                                   const struct neph_engine **engine,
                                   struct neph_settings *settings, struct neph_diag *diag)
{
    const struct neph_engine *guest = guest_in(words);
    *engine = guest ? guest : neph_engine_find("realtime");
    return guest ? set_guest(guest, words, settings, diag)
                 : neph_settings_words(*engine, words, shared, settings, diag);
}
