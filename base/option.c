/* SPDX-License-Identifier: MIT */
#include "base/option.h"

#include "base/files.h"

#include <errno.h>
#include <math.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Does not compile with a new kind: this file then needs a change. */
_Static_assert(NEPH_OPTION_KIND_COUNT == 3, "a new kind");

struct neph_settings neph_options_default(const struct neph_option *options)
{
    struct neph_settings settings = {{0}};
    for (int i = 0; options[i].name; i++)
        settings.values[i] = options[i].default_value;
    return settings;
}

/* Index of the option whose name is the first `length` bytes of `name`, or -1. */
static int find(const struct neph_option *options, const char *name, size_t length)
{
    for (int i = 0; options[i].name; i++)
        if (strlen(options[i].name) == length && strncmp(options[i].name, name, length) == 0)
            return i;
    return -1;
}

int neph_option_find(const struct neph_option *options, const char *name)
{
    return find(options, name, strlen(name));
}

/* Length of the longest substring common to a name and the first `length` bytes of a key. */
static size_t common_run(const char *name, const char *key, size_t length)
{
    size_t longest = 0;
    for (; *name; name++)
        for (size_t from = 0; from < length; from++) {
            size_t run = 0;
            while (from + run < length && name[run] && name[run] == key[from + run])
                run++;
            longest = run > longest ? run : longest;
        }
    return longest;
}

/* List the names that share `least_run` letters with the key. False when they do not fit. */
static bool list_names(const struct neph_option *options, const char *key, size_t length,
                       size_t least_run, char *text, size_t size)
{
    size_t used = 0;
    text[0] = '\0';
    for (; options->name && used < size; options++)
        if (common_run(options->name, key, length) >= least_run)
            used += (size_t)snprintf(text + used, size - used, "%s%s", used ? ", " : "",
                                     options->name);
    return used < size;
}

/* Hint with all names or, when these are too many, the names most similar to the key. */
static void hint_known(const struct neph_option *options, const char *owner, const char *key,
                       size_t length, struct neph_diag *diag)
{
    char names[384];
    size_t best = 3; /* shorter runs are coincidence */
    if (!options->name) {
        neph_hint(diag, "%s has no settings", owner);
        return;
    }
    if (list_names(options, key, length, 0, names, sizeof(names))) {
        neph_hint(diag, "settings of %s: %s", owner, names);
        return;
    }
    for (int i = 0; options[i].name; i++) {
        const size_t run = common_run(options[i].name, key, length);
        best = run > best ? run : best;
    }
    if (list_names(options, key, length, best, names, sizeof(names)) && names[0])
        neph_hint(diag, "settings of %s with a similar name: %s", owner, names);
}

/* The entry of a removed option, followed by its reason; NULL: no removed option has this name. */
static const char *const *find_gone(const struct neph_option *options, const char *name,
                                    size_t length)
{
    while (options->name)
        options++;
    for (const char *const *gone = options->choices; gone && *gone; gone += 2)
        if (strlen(*gone) == length && strncmp(*gone, name, length) == 0)
            return gone;
    return NULL;
}

/* Warn once in a process about each removed option: presets, sweeps and jobs parse their settings
 * many times. */
static void warn_gone(const char *owner, const char *const *gone)
{
    static _Atomic(const char *const *) warned[64];
    for (size_t i = 0; i < sizeof(warned) / sizeof(warned[0]); i++) {
        const char *const *known = NULL;
        if (atomic_compare_exchange_strong(&warned[i], &known, gone))
            break;
        if (known == gone)
            return;
    }
    fprintf(stderr, "warning: %s: setting %s was removed and is ignored: %s\n", owner, gone[0],
            gone[1]);
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
    if (isnan(option->default_value) && strcmp(text, "auto") == 0) {
        *value = NAN;
        return NEPH_OK;
    }
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

enum neph_status neph_options_set(const struct neph_option *options, const char *owner,
                                  const char *assignment, struct neph_settings *settings,
                                  struct neph_diag *diag)
{
    const char *equals = strchr(assignment, '=');
    if (!equals)
        return neph_fail(diag, NEPH_ERR_USAGE, "setting '%s' is not of the form key=value",
                         assignment);
    const int index = find(options, assignment, (size_t)(equals - assignment));
    const size_t length = (size_t)(equals - assignment);
    const char *const *gone = find_gone(options, assignment, length);
    if (index < 0 && gone) {
        warn_gone(owner, gone);
        return NEPH_OK;
    }
    if (index < 0) {
        neph_fail(diag, NEPH_ERR_USAGE, "%s has no setting '%.*s'", owner,
                  (int)(equals - assignment), assignment);
        hint_known(options, owner, assignment, length, diag);
        return NEPH_ERR_USAGE;
    }
    double *value = &settings->values[index];
    return options[index].kind == NEPH_OPTION_CHOICE
               ? parse_choice(&options[index], equals + 1, value, diag)
               : parse_number(&options[index], equals + 1, value, diag);
}

static enum neph_status apply(const struct neph_option *options, const char *owner,
                              const char *assignments, struct neph_settings *settings,
                              struct neph_diag *diag)
{
    char *words = strdup(assignments), *rest = words;
    enum neph_status status = words ? NEPH_OK : neph_fail_memory(diag);
    for (char *word; !status && (word = strsep(&rest, " ")) != NULL;)
        if (*word)
            status = neph_options_set(options, owner, word, settings, diag);
    free(words);
    return status;
}

const struct neph_preset *neph_preset_of_use(const struct neph_preset *presets, unsigned use,
                                             int index)
{
    for (; presets->name; presets++)
        if ((presets->uses & use) && index-- == 0)
            return presets;
    return NULL;
}

char *neph_preset_names(const struct neph_preset *presets, unsigned use, const char *first,
                        const char *separator)
{
    char *names = neph_format("%s", first);
    for (; names && presets->name; presets++) {
        if (use && !(presets->uses & use))
            continue;
        char *longer = neph_format("%s%s%s", names, *names ? separator : "", presets->name);
        free(names);
        names = longer;
    }
    return names;
}

enum neph_status neph_options_preset(const struct neph_option *options, const char *owner,
                                     const struct neph_preset *presets, const char *name,
                                     struct neph_settings *settings, struct neph_diag *diag)
{
    if (!presets)
        return neph_fail(diag, NEPH_ERR_USAGE, "%s has no presets, and so no '%s'", owner, name);
    for (const struct neph_preset *preset = presets; preset->name; preset++)
        if (strcmp(preset->name, name) == 0) {
            struct neph_settings made = neph_options_default(options);
            const enum neph_status status = apply(options, owner, preset->assignments, &made, diag);
            if (!status)
                *settings = made;
            return status;
        }
    char *names = neph_preset_names(presets, 0, "", ", ");
    neph_fail(diag, NEPH_ERR_USAGE, "%s has no preset '%s'", owner, name);
    neph_hint(diag, "%s has: %s", owner, names ? names : "");
    free(names);
    return NEPH_ERR_USAGE;
}

/* The shortest text that reads back as the same double. */
static void print_number(char text[32], double value)
{
    snprintf(text, 32, isnan(value) ? "auto" : "%.15g", value);
    if (!isnan(value) && strtod(text, NULL) != value)
        snprintf(text, 32, "%.17g", value);
}

static bool is_same(double a, double b)
{
    return a == b || (isnan(a) && isnan(b));
}

char *neph_options_changes(const struct neph_option *options, const struct neph_settings *settings,
                           const struct neph_settings *from)
{
    char *text = neph_format("%s", "");
    for (int i = 0; text && options[i].name; i++) {
        char number[32];
        if (from && is_same(settings->values[i], from->values[i]))
            continue;
        print_number(number, settings->values[i]);
        const char *value = options[i].kind == NEPH_OPTION_CHOICE
                                ? options[i].choices[(int)settings->values[i]]
                                : number;
        char *longer = neph_format("%s%s%s=%s", text, text[0] ? " " : "", options[i].name, value);
        free(text);
        text = longer;
    }
    return text;
}

char *neph_options_text(const struct neph_option *options, const struct neph_settings *settings)
{
    return neph_options_changes(options, settings, NULL);
}
