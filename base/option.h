/* SPDX-License-Identifier: MIT
 *
 * Declarative options: what an engine or a metric can be set to. The command line, the help text,
 * the checks and the keys of stored work all come from one table.
 */
#ifndef NEPH_BASE_OPTION_H
#define NEPH_BASE_OPTION_H

#include "base/status.h"
#include "settings/capacity.h" /* NEPH_OPTIONS_MAX: options of the longest table */

enum neph_option_kind {
    NEPH_OPTION_INTEGER,
    NEPH_OPTION_REAL,
    NEPH_OPTION_CHOICE,
    NEPH_OPTION_KIND_COUNT,
};

/* One option. A table of them ends with a NULL name and has at most NEPH_OPTIONS_MAX. The choices
 * of its last row, if any, are words that are gone: the name of an option and a reason by turns.
 * For one release they are accepted and ignored. */
struct neph_option {
    const char *name;
    enum neph_option_kind kind;
    double default_value;       /* CHOICE: index into choices; REAL: NAN: "auto", whoever has the
                                   option chooses when the value is NAN */
    double minimum, maximum;    /* INTEGER and REAL */
    const char *const *choices; /* CHOICE: NULL-terminated */
    const char *help;           /* one line, with the unit */
};

/* A named set of values: "key=value key=value"; what it does not name stays as it is. A table of
 * them ends with a NULL name. */
struct neph_preset {
    const char *name;
    const char *summary; /* one line */
    const char *assignments;
    unsigned uses; /* bits of an enum beside the table: what takes it when none is named */
};

/* Values of options, by index in their table. */
struct neph_settings {
    double values[NEPH_OPTIONS_MAX];
};

/* Every option at its default. */
struct neph_settings neph_options_default(const struct neph_option *options);

/* Index of an option by name, or -1. */
int neph_option_find(const struct neph_option *options, const char *name);

/* Apply "key=value". `owner` ("engine march") is named in errors, which also name the key, the
 * value, the allowed range and the known keys (of very many those like it, if any is):
 * NEPH_ERR_USAGE. The word of an option that is gone changes nothing; the first time in a process
 * stderr has a warning. */
enum neph_status neph_options_set(const struct neph_option *options, const char *owner,
                                  const char *assignment, struct neph_settings *settings,
                                  struct neph_diag *diag);

/* Every option at its default, then the values of a preset. NEPH_ERR_USAGE: there is none of this
 * name; the hint lists them. */
enum neph_status neph_options_preset(const struct neph_option *options, const char *owner,
                                     const struct neph_preset *presets, const char *name,
                                     struct neph_settings *settings, struct neph_diag *diag);

/* Preset `index`, from 0 on, of those that have a use. NULL: there are not so many. */
const struct neph_preset *neph_preset_of_use(const struct neph_preset *presets, unsigned use,
                                             int index);

/* The names of those that have a use, or, with a `use` of 0, of all, behind the text `first`. For
 * the caller to free; NULL when memory is short. */
char *neph_preset_names(const struct neph_preset *presets, unsigned use, const char *first,
                        const char *separator);

/* "steps=64 sun=exact", canonical: all options, table order, numbers that read back as the same
 * double. For the caller to free; NULL when memory is short. */
char *neph_options_text(const struct neph_option *options, const struct neph_settings *settings);

/* So, but only what differs from other settings; `from` NULL: all. */
char *neph_options_changes(const struct neph_option *options, const struct neph_settings *settings,
                           const struct neph_settings *from);

#endif
