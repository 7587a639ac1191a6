/* SPDX-License-Identifier: MIT */
#include "harness/engines/engines.h"

#include "harness/engines/blender.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LISTED(name) &neph_engine_##name,
static const struct neph_engine *const builtin_engines[] = {NEPH_ENGINES(LISTED)};
#undef LISTED
enum { OWN_COUNT = sizeof(builtin_engines) / sizeof(builtin_engines[0]) };
_Static_assert((int)NEPH_ENGINE_PROGRAMS_MAX + 1 == (int)NEPH_EXTERNAL_PROGRAMS_MAX, "Blenders");

/* The engines of this process: the built-in ones, then one engine for each further Blender. Made
 * once: the environment lists the Blenders, and an engine name needs the version that the program
 * reports. */
static struct registry {
    pthread_once_t once;
    int count, further_count;
    const struct neph_engine *engines[NEPH_ENGINE_COUNT];
    struct neph_engine further[NEPH_ENGINE_PROGRAMS_MAX];
    char names[NEPH_ENGINE_PROGRAMS_MAX][32];
} registry = {.once = PTHREAD_ONCE_INIT};

static bool has_name(const char *name)
{
    for (int i = 0; i < registry.count; i++)
        if (strcmp(registry.engines[i]->name, name) == 0)
            return true;
    return false;
}

/* Name a further program: "cycles@5.2"; a second one of that version is "cycles@5.2-2". */
static void name_program(const struct neph_engine *first, int program, char name[32])
{
    char version[64] = "unknown";
    int major, minor;
    if (neph_external_version(&neph_blender, program, version) &&
        sscanf(version, "%3d.%3d", &major, &minor) == 2)
        snprintf(version, sizeof(version), "%d.%d", major, minor);
    snprintf(name, 32, "%s@%.16s", first->name, version);
    for (int twin = 2; has_name(name); twin++)
        snprintf(name, 32, "%s@%.12s-%d", first->name, version, twin);
}

static void add_further_programs(const struct neph_engine *first)
{
    const int most = NEPH_EXTERNAL_PROGRAMS_MAX, named = neph_external_count(&neph_blender);
    for (int program = 1; program < (named < most ? named : most); program++) {
        const int i = registry.further_count++;
        name_program(first, program, registry.names[i]);
        registry.further[i] = *first;
        registry.further[i].name = registry.names[i];
        registry.further[i].first = first;
        registry.further[i].program = program;
        registry.engines[registry.count++] = &registry.further[i];
    }
}

static void make_registry(void)
{
    for (int i = 0; i < OWN_COUNT; i++) {
        registry.engines[registry.count++] = builtin_engines[i];
        if (builtin_engines[i] == &neph_engine_cycles)
            add_further_programs(builtin_engines[i]);
    }
}

const struct neph_engine *const *neph_engines_with_user_engines(int *count)
{
    pthread_once(&registry.once, make_registry);
    *count = registry.count;
    return registry.engines;
}

const struct neph_engine *const *neph_engines(int *count)
{
    neph_engines_with_user_engines(count);
    while (registry.engines[*count - 1]->is_user_engine)
        (*count)--;
    return registry.engines;
}

bool neph_engine_is_random(const struct neph_engine *engine)
{
    return engine->rung == NEPH_LEVEL_TRACER ||
           (engine->rung == NEPH_LEVEL_EXTERNAL && engine->stochastic);
}

/* Find an engine. Blender is run only if no built-in engine has the name. */
const struct neph_engine *neph_engine_find(const char *name)
{
    for (int i = 0; i < OWN_COUNT; i++)
        if (strcmp(builtin_engines[i]->name, name) == 0)
            return builtin_engines[i];
    if (!strchr(name, '@'))
        return NULL;
    int count;
    const struct neph_engine *const *engines = neph_engines_with_user_engines(&count);
    for (int i = 0; i < count; i++)
        if (strcmp(engines[i]->name, name) == 0)
            return engines[i];
    return NULL;
}

/* The user engine that the words name; NULL: the words name a preset. */
static const struct neph_engine *find_user_engine(const char *words)
{
    const size_t length = strcspn(words, "+");
    for (int i = 0; i < OWN_COUNT; i++)
        if (builtin_engines[i]->is_user_engine &&
            strncmp(builtin_engines[i]->name, words, length) == 0 &&
            builtin_engines[i]->name[length] == '\0')
            return builtin_engines[i];
    return NULL;
}

static enum neph_status set_user_engine(const struct neph_engine *guest, const char *words,
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

enum neph_status neph_engine_parse_words(const char *words, const char *shared,
                                         const struct neph_engine **engine,
                                         struct neph_settings *settings, struct neph_diag *diag)
{
    const struct neph_engine *guest = find_user_engine(words);
    *engine = guest ? guest : neph_engine_find("realtime");
    return guest ? set_user_engine(guest, words, settings, diag)
                 : neph_settings_parse_words(*engine, words, shared, settings, diag);
}
