/* SPDX-License-Identifier: MIT */
#include "harness/engines/look.h"

#include "harness/engines/engines.h"

#include <stdio.h>

/* The value of an option; 0, the first choice, for an engine without the option. */
static int choice_of(const struct neph_engine *engine, const struct neph_settings *settings,
                     const char *name)
{
    const int option = neph_option_find(engine->options, name);
    return option < 0 ? 0 : (int)settings->values[option];
}

const struct neph_engine *neph_engine_lit_like(const char *lighting)
{
    char name[96];
    snprintf(name, sizeof(name), "march_%s", lighting);
    return neph_engine_find(name);
}

static bool has_light_of_look(const struct neph_engine *engine,
                              const struct neph_settings *settings)
{
    const int option = neph_option_find(engine->options, "lighting");
    if (option < 0)
        return false;
    const int choice = (int)settings->values[option];
    const struct neph_engine *like = neph_engine_lit_like(engine->options[option].choices[choice]);
    return like && like->look;
}

const char *neph_look_of_fog(const struct neph_engine *engine, const struct neph_settings *settings)
{
    static const char *const words[] = {
        NULL,
        "fog=unreal: Unreal's non-physical fog model",
        "fog=filament: Filament's non-physical fog model",
    };
    if (engine == &neph_engine_fog_look)
        return "a game engine's non-physical fog model";
    return words[choice_of(engine, settings, "fog")];
}

bool neph_is_look(const struct neph_engine *engine, const struct neph_settings *settings)
{
    return engine->look || has_light_of_look(engine, settings) ||
           neph_look_of_fog(engine, settings);
}
