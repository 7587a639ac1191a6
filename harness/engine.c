/* SPDX-License-Identifier: MIT
 *
 * The registry of engines, and the settings that their option tables describe.
 */
#include "harness/engine.h"

#include "harness/engines/engines.h"

#include "base/files.h"
#include "scenes/media.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct neph_engine *const registry[] = {
    &neph_engine_exact,  &neph_engine_oracle,        &neph_engine_tracer,
    &neph_engine_march,  &neph_engine_march_octaves, &neph_engine_march_horizon,
    &neph_engine_cycles, &neph_engine_povray,
};

static const char *const rung_names[] = {
    [NEPH_RUNG_EXACT] = "exact",
    [NEPH_RUNG_TRACER] = "tracer",
    [NEPH_RUNG_WITNESS] = "witness",
    [NEPH_RUNG_MODEL] = "model",
};

const struct neph_engine *const *neph_engines(int *count)
{
    *count = (int)(sizeof(registry) / sizeof(registry[0]));
    return registry;
}

const struct neph_engine *neph_engine_find(const char *name)
{
    int count;
    const struct neph_engine *const *engines = neph_engines(&count);
    for (int i = 0; i < count; i++)
        if (strcmp(engines[i]->name, name) == 0)
            return engines[i];
    return NULL;
}

const char *neph_rung_name(enum neph_rung rung)
{
    return rung_names[rung];
}

struct neph_settings neph_settings_default(const struct neph_engine *engine)
{
    struct neph_settings settings = {{0}};
    for (int i = 0; engine->options[i].name; i++)
        settings.values[i] = engine->options[i].default_value;
    return settings;
}

/* Index of the option whose name is the first `length` bytes of `name`, or -1. */
static int find_option(const struct neph_engine *engine, const char *name, size_t length)
{
    for (int i = 0; engine->options[i].name; i++)
        if (strlen(engine->options[i].name) == length &&
            strncmp(engine->options[i].name, name, length) == 0)
            return i;
    return -1;
}

static void hint_known_options(const struct neph_engine *engine, struct neph_diag *diag)
{
    char known[384] = "";
    for (int i = 0; engine->options[i].name; i++) {
        size_t used = strlen(known);
        snprintf(known + used, sizeof(known) - used, "%s%s", i ? ", " : "",
                 engine->options[i].name);
    }
    if (known[0])
        neph_hint(diag, "settings of %s: %s; `neph engines %s` explains them", engine->name, known,
                  engine->name);
    else
        neph_hint(diag, "%s has no settings", engine->name);
}

static enum neph_status parse_choice(const struct neph_option *option, const char *text,
                                     double *value, struct neph_diag *diag)
{
    char allowed[256] = "";
    for (int i = 0; option->choices[i]; i++) {
        if (strcmp(option->choices[i], text) == 0) {
            *value = i;
            return NEPH_OK;
        }
        size_t used = strlen(allowed);
        snprintf(allowed + used, sizeof(allowed) - used, "%s%s", i ? ", " : "", option->choices[i]);
    }
    return neph_fail(diag, NEPH_ERR_USAGE, "setting %s: '%s' is not one of: %s", option->name, text,
                     allowed);
}

static enum neph_status parse_number(const struct neph_option *option, const char *text,
                                     double *value, struct neph_diag *diag)
{
    const bool integer = option->kind == NEPH_OPTION_INTEGER;
    char *end;
    errno = 0;
    const double parsed = strtod(text, &end);
    if (end == text || *end != '\0' || !isfinite(parsed) || (integer && parsed != trunc(parsed)))
        return neph_fail(diag, NEPH_ERR_USAGE, "setting %s: '%s' is not %s", option->name, text,
                         integer ? "an integer" : "a finite number");
    if (parsed < option->minimum || parsed > option->maximum)
        return neph_fail(diag, NEPH_ERR_USAGE, "setting %s: %s is outside %g..%g", option->name,
                         text, option->minimum, option->maximum);
    *value = parsed;
    return NEPH_OK;
}

enum neph_status neph_settings_set(const struct neph_engine *engine, struct neph_settings *settings,
                                   const char *assignment, struct neph_diag *diag)
{
    const char *equals = strchr(assignment, '=');
    if (!equals)
        return neph_fail(diag, NEPH_ERR_USAGE, "setting '%s' is not of the form key=value",
                         assignment);
    const int index = find_option(engine, assignment, (size_t)(equals - assignment));
    if (index < 0) {
        neph_fail(diag, NEPH_ERR_USAGE, "engine %s has no setting '%.*s'", engine->name,
                  (int)(equals - assignment), assignment);
        hint_known_options(engine, diag);
        return NEPH_ERR_USAGE;
    }
    const struct neph_option *option = &engine->options[index];
    double *value = &settings->values[index];
    return option->kind == NEPH_OPTION_CHOICE ? parse_choice(option, equals + 1, value, diag)
                                              : parse_number(option, equals + 1, value, diag);
}

double neph_setting(const struct neph_engine *engine, const struct neph_settings *settings,
                    const char *name)
{
    const int index = find_option(engine, name, strlen(name));
    return index < 0 ? NAN : settings->values[index];
}

/* The shortest text that reads back as the same double. */
static void print_number(char text[32], double value)
{
    snprintf(text, 32, "%.15g", value);
    if (strtod(text, NULL) != value)
        snprintf(text, 32, "%.17g", value);
}

char *neph_settings_text(const struct neph_engine *engine, const struct neph_settings *settings)
{
    char *text = neph_format("%s", "");
    for (int i = 0; text && engine->options[i].name; i++) {
        const struct neph_option *option = &engine->options[i];
        char number[32];
        print_number(number, settings->values[i]);
        const char *value = option->kind == NEPH_OPTION_CHOICE
                                ? option->choices[(int)settings->values[i]]
                                : number;
        char *longer = neph_format("%s%s%s=%s", text, i ? " " : "", option->name, value);
        free(text);
        text = longer;
    }
    return text;
}
