/* SPDX-License-Identifier: MIT
 *
 * The command line of a verb as data: a table of options, each with the place in the verb's request
 * that its argument goes to, and how many operands there are.
 */
#ifndef NEPH_HARNESS_OPTIONS_H
#define NEPH_HARNESS_OPTIONS_H

#include "base/option.h"
#include "base/status.h"

#include <argp.h>
#include <stdbool.h>
#include <stddef.h>

enum { NEPH_CLI_WORDS_MAX = 1024, NEPH_CLI_LIST_MAX = 128 };

struct neph_cli_words {
    int count;
    const char *list[NEPH_CLI_WORDS_MAX]; /* of argv */
};

/* Words of "A,B", of an option that may be given several times. */
struct neph_cli_list {
    int count;
    const char *words[NEPH_CLI_LIST_MAX]; /* of argv, or of `text` */
    double numbers[NEPH_CLI_LIST_MAX];    /* of NEPH_CLI_NUMBERS */
    char *text; /* of the words that stand for a list that is not given; owned */
};

struct neph_cli_size {
    int width_px, height_px;
};

/* What an option makes of its argument, and how its place tells that it was not given. What cannot
 * be read, or lies outside minimum..maximum, is a usage error. */
enum neph_cli_kind {
    NEPH_CLI_SHARED,  /* as the option of that name in the table of options.c has it. An option of
                         another kind with a name of that table has the table's letter, too, and its
                         argument and help where the row has none */
    NEPH_CLI_FLAG,    /* bool */
    NEPH_CLI_WORD,    /* const char *; NULL */
    NEPH_CLI_FILE,    /* const char *, to write to; NULL. Not empty, as -o "$UNSET" is: that would
                         be the root or the working folder */
    NEPH_CLI_OUTPUT,  /* a file or folder as above that results name: UTF-8, for JSON */
    NEPH_CLI_WORDS,   /* struct neph_cli_words */
    NEPH_CLI_INTEGER, /* int; -1 */
    NEPH_CLI_REAL,    /* double; NaN. Any, when minimum and maximum are 0 */
    NEPH_CLI_SIZE,    /* struct neph_cli_size; 0 x 0 */
    NEPH_CLI_ONE,   /* const char *; NULL. One name: a second one, by comma or by another option of
                        the name, is refused */
    NEPH_CLI_NAMES, /* struct neph_cli_list, of at most `maximum` different words; empty */
    NEPH_CLI_LIST,  /* the same; `otherwise` and `presets` are its words after
                         neph_cli_split_lists() when none was given */
    NEPH_CLI_NUMBERS, /* the same, each word a finite number */
    NEPH_CLI_KIND_COUNT,
};

struct neph_cli_option {
    const char *name;
    int letter;           /* 0: none */
    const char *argument; /* what the help calls it; NULL: a flag */
    const char *help;
    enum neph_cli_kind kind;
    size_t at;             /* the place in the request */
    const char *otherwise; /* the argument when none is given, which the help tells; NULL: none */
    double minimum, maximum;
    int group; /* in the help, which sorts by name within each */
    /* The presets with one of these uses, behind `otherwise`, stand for a list that is not given;
     * the help names them. NULL: none. */
    const struct neph_preset *presets;
    unsigned uses;
    const char *between; /* before each name; NULL: "," */
};

/* What several verbs have; the request of a verb begins with it. */
struct neph_cli_shared {
    const char *const *operands; /* of argv */
    int operand_count;
    const char *engine, *blender, *output, *csv, *markdown;
    struct neph_cli_words settings;
    struct neph_cli_size size;
    int time_limit_s, jobs;
    bool json, quiet, all;
};

struct neph_cli_operands {
    const char *shown; /* "SCENE": what the help calls them */
    int minimum, maximum;
    const char *missing; /* what is said of fewer: "which scene?" */
    const char *surplus; /* what there may be, said of more: "one scene"; NULL: there is no end */
};

extern const struct neph_cli_operands neph_cli_one_scene, neph_cli_one_name_or_none;

struct neph_cli_syntax {
    const struct neph_cli_option *options;    /* ends with a NULL name */
    const struct neph_cli_option *more;       /* a second such table; or NULL */
    const struct neph_cli_operands *operands; /* NULL: none */
    const char *doc; /* what is before a \v stands above the options, the rest below */
    /* Ends in argp_error() where the whole makes no sense. NULL: it always does. */
    void (*check)(const void *request, const struct argp_state *state);
};

/* Fill a zeroed request; its first member is a struct neph_cli_shared. Ends the process after a
 * wrong use (EX_USAGE) and after --help. Complaints quote the command line with its bytes made fit
 * for a terminal (base/text.h). */
void neph_cli_parse(const struct neph_cli_syntax *syntax, int argc, char **argv, void *request);

/* Leave operand `index` only. False: there is none. */
bool neph_cli_only_operand(struct neph_cli_shared *shared, int index);

/* Whether a number is in the range that it has here: NEPH_ERR_USAGE. */
enum neph_status neph_cli_check_range(const char *option, int value, int minimum, int maximum,
                                      struct neph_diag *diag);

/* Complete the lists of a request. NEPH_ERR_USAGE: a word is no number.
 * To be freed in any case. */
enum neph_status neph_cli_split_lists(const struct neph_cli_syntax *syntax, void *request,
                                      struct neph_diag *diag);
void neph_cli_free_lists(const struct neph_cli_syntax *syntax, void *request);

/* Words of "A,B" into `words`, which point into `text`. NEPH_ERR_USAGE: one is there twice, or
 * there are more than `most`; `what` names them. */
enum neph_status neph_cli_split(char *text, const char *what, int most, const char **words,
                                int *count, struct neph_diag *diag);

#endif
