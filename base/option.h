/* SPDX-License-Identifier: MIT
 *
 * Declarative options of engines, metrics and passes. Command line, help text, range checks and the
 * keys of stored results are all made from one table.
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

/* One option. A table ends with a NULL name and has at most NEPH_OPTIONS_MAX rows. The choices of
 * that last row, if any, are removed options: by turns a name and a reason. They are accepted with
 * a warning and ignored for one release. */
struct neph_option {
    const char *name;
    enum neph_option_kind kind;
    double default_value;       /* CHOICE: index into choices; REAL: NAN means "auto": the reader of
                                   the option picks the value */
    double minimum, maximum;    /* INTEGER and REAL */
    const char *const *choices; /* CHOICE: NULL-terminated */
    const char *help;           /* one line, with the unit */
};

/* A named set of values: "key=value key=value"; other options keep their values. A table ends with
 * a NULL name. */
struct neph_preset {
    const char *name;
    const char *summary; /* one line */
    const char *assignments;
    unsigned uses; /* bits of an enum beside the table: the commands that use it by default */
};

/* Values of options, by index in their table. */
struct neph_settings {
    double values[NEPH_OPTIONS_MAX];
};

/* All options at their defaults. */
struct neph_settings neph_options_default(const struct neph_option *options);

/* Index of an option by name, or -1. */
int neph_option_find(const struct neph_option *options, const char *name);

/* Apply "key=value". NEPH_ERR_USAGE with a message that names `owner` ("engine march"), the key,
 * the value, the allowed range and the known keys (of a long table, the similar ones). A removed
 * option changes nothing; its first use in a process prints a warning to stderr. */
enum neph_status neph_options_set(const struct neph_option *options, const char *owner,
                                  const char *assignment, struct neph_settings *settings,
                                  struct neph_diag *diag);

/* All options at their defaults, then the values of a preset. NEPH_ERR_USAGE: no preset has this
 * name; the hint lists the names. */
enum neph_status neph_options_preset(const struct neph_option *options, const char *owner,
                                     const struct neph_preset *presets, const char *name,
                                     struct neph_settings *settings, struct neph_diag *diag);

/* Number `index`, from 0, of the presets with the bit `use`. NULL: there are fewer. */
const struct neph_preset *neph_preset_find_by_use(const struct neph_preset *presets, unsigned use,
                                                  int index);

/* The names of the presets with the bit `use` (0: of all), separated by `separator`, after the text
 * `first`. For the caller to free; NULL when memory is short. */
char *neph_preset_names(const struct neph_preset *presets, unsigned use, const char *first,
                        const char *separator);

/* "steps=64 sun=exact", canonical: all options, in table order, numbers that read back as the same
 * double. For the caller to free; NULL when memory is short. */
char *neph_options_text(const struct neph_option *options, const struct neph_settings *settings);

/* As neph_options_text(), with only the options that differ from `from` (NULL: all options). */
char *neph_options_changes(const struct neph_option *options, const struct neph_settings *settings,
                           const struct neph_settings *from);

#endif
