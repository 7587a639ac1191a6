/* SPDX-License-Identifier: MIT */
#include "harness/options.h"

#include "base/files.h"
#include "base/image.h"
#include "base/text.h"
#include "harness/help.h"
#include "harness/old_options.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_CLI_KIND_COUNT == 13, "a new kind");

enum {
    ROWS_MAX = 48,
    OLD_MAX = 8,       /* old names of a verb's options */
    KEY_FIRST = 0x100, /* keys of options without a letter lie above those */
    KEY_OLD = 0x1000,  /* of an old name; its row in neph_old_options behind that */
    KEY_USAGE = 0x2000,
};

/* Options that two verbs or more have, so that each has one letter, one form of its argument and,
 * unless a verb has words of its own, one help: docs/flags.md. Rows without a kind have no place of
 * their own: the row of the verb says where it is. */
static const struct neph_cli_option shared_options[] = {
    {"all", 0, NULL, "All numbers in place of the answer in ten lines", NEPH_CLI_FLAG,
     .at = offsetof(struct neph_cli_shared, all)},
    {"blender", 0, "PATH",
     "Blender of engine cycles in place of NEPH_BLENDER: a program, or the folder of an unpacked "
     "archive; further ones, behind colons, are further engines",
     NEPH_CLI_WORD, .at = offsetof(struct neph_cli_shared, blender)},
    {"by-position", 0, NULL,
     .help = "Frames belong together by their place in the sequence, whatever their numbers"},
    {"chain", 0, "FILE", .help = "Picture chain in place of the scene's; off: none"},
    {"convert", 0, NULL,
     .help = "Convert frames of other colour spaces (by chromaticities, colorInteropID or "
             "oiio:ColorSpace, with --ocio by its names, too) to linear Rec.709"},
    {"csv", 0, "FILE", "Results as CSV", NEPH_CLI_FILE,
     .at = offsetof(struct neph_cli_shared, csv)},
    {"depth", 0, "SOURCE",
     .help = "Depth is the channel of that full name, such as ViewLayer.Depth.Z (a file without "
             "it: its Z)"},
    {"engine", 'e', "NAME[,NAME]", "Engine; `neph engines` lists them", NEPH_CLI_ONE,
     .at = offsetof(struct neph_cli_shared, engine)},
    {"error", 0, "E", .help = "Relative RMSE of radiance against the truth"},
    {"exposure", 0, "EV", .help = "Display value = 2^EV times radiance"},
    {"fps", 0, "HZ", .help = "Frame rate of the display (default: the frames' attribute, else 60)"},
    {"frames", 0, "N", .help = "Frames of the sequence"},
    {"jobs", 'j', "N", "Processes that render at the same time; results do not depend on it",
     NEPH_CLI_INTEGER, .at = offsetof(struct neph_cli_shared, jobs), .minimum = 1, .maximum = 256},
    {"json", 0, NULL, "Results as JSON on stdout", NEPH_CLI_FLAG,
     .at = offsetof(struct neph_cli_shared, json)},
    {"junit", 0, "FILE", .help = "Results as JUnit XML"},
    {"layer", 0, "NAME",
     .help = "Radiance, depth and masks are the channels NAME.R and so on (Blender: "
             "ViewLayer.Combined)"},
    {"list", 0, NULL, .help = "Print what there is to choose from, and do nothing else"},
    {"markdown", 0, "FILE", "The tables into a file, too", NEPH_CLI_FILE,
     .at = offsetof(struct neph_cli_shared, markdown)},
    {"model", 0, "NAME[,NAME]", .help = "Models to compare with the truth"},
    {"ocio", 0, "FILE", .help = "An OpenColorIO config, with its colour spaces for --convert"},
    {"only", 0, "NAME[,NAME]", .help = "Only these parts"},
    {"output", 'o', "DIR", "Folder to write to", NEPH_CLI_OUTPUT,
     .at = offsetof(struct neph_cli_shared, output)},
    {"page", 0, "DIR", .help = "An HTML page that opens from disk"},
    {"page-limit", 0, "MB", .help = "The most that the page may take"},
    {"part", 0, "NAME",
     .help = "Part of OpenEXR files with several, by its name or its number from 0 (default: the "
             "only one with colour)"},
    {"plot", 0, "FILE", .help = "A chart as SVG"},
    {"ppd", 0, "N",
     .help =
         "Pixels per degree of the display (default: 67.02, 0.7 m from a screen 0.7 m and 3840 px "
         "wide; a desk monitor has 40)"},
    {"preset", 'p', "NAME[,NAME]", .help = "Preset: a set of settings by name, before any --set"},
    {"quiet", 'q', NULL, "No progress; of an answer in ten lines only the first", NEPH_CLI_FLAG,
     .at = offsetof(struct neph_cli_shared, quiet)},
    {"reference", 'r', "FILES", .help = "Frames that the others are compared with"},
    {"repeat", 0, "N", .help = "How often the same work is timed"},
    {"resolution", 0, "N", .help = "Nodes along the longest side of a voxel grid"},
    {"retime", 0, NULL, .help = "Time again what DIR/times.json has times of"},
    {"samples", 0, "N", .help = "Samples a pixel of the truth"},
    {"seed", 0, "S", .help = "The first seed"},
    {"seeds", 0, "N", .help = "How many seeds, from the first on"},
    {"set", 's', "[ENGINE:]KEY=VALUE", "A setting of the engine; may be given several times",
     NEPH_CLI_WORDS, .at = offsetof(struct neph_cli_shared, settings)},
    {"size", 0, "WxH", "Size in pixels", NEPH_CLI_SIZE,
     .at = offsetof(struct neph_cli_shared, size)},
    {"space", 0, "NAME",
     .help = "Name of linear Rec.709 in the config (default: by the role aces_interchange)"},
    {"stats", 0, NULL, .help = "What each frame has cost"},
    {"steps", 0, "N", .help = "Steps of every view ray"},
    {"suite", 0, "NAME", .help = "A set of scenes or tests by name"},
    {"takes", 0, "NAME[,NAME]", .help = "What is rendered of a scene"},
    {"tier", 0, "NAME", .help = "quick or full"},
    {"time-limit", 0, "S", "Seconds per child process", NEPH_CLI_INTEGER,
     .at = offsetof(struct neph_cli_shared, time_limit_s), .minimum = 1, .maximum = 1000000},
    {"untimed", 0, NULL, .help = "No times: evaluations of density in place of them"},
    {"warm-up", 0, "N", .help = "Frames before the first that is measured"},
    {"window", 0, "MODE",
     .help = "Frames with different data windows: union (inside the display window; outside a "
             "window is 0 and transparent), intersection (the pixels that all have), or strict "
             "(refused)"},
    {"white", 0, "CD_PER_M2", .help = "Luminance of the display value 1 (default: 100)"},
    {.name = NULL},
};

const struct neph_cli_operands neph_cli_one_scene = {
    .shown = "SCENE",
    .minimum = 1,
    .maximum = 1,
    .missing = "which scene? `neph scenes` lists the catalogue",
    .surplus = "one scene",
};

const struct neph_cli_operands neph_cli_one_name_or_none = {
    .shown = "[NAME]",
    .maximum = 1,
    .surplus = "one name",
};

struct parse {
    const struct neph_cli_syntax *syntax;
    struct neph_cli_option rows[ROWS_MAX]; /* complete */
    int row_count;
    char *request;    /* as bytes, for the offsets */
    const char *verb; /* "neph compare" */
};

/* ---- what arguments are made of -------------------------------------------------------------- */

typedef void take_function(const struct neph_cli_option *row, const char *argument, void *place,
                           const struct argp_state *state);

static void take_flag(const struct neph_cli_option *row, const char *argument, void *place,
                      const struct argp_state *state)
{
    (void)row;
    (void)argument;
    (void)state;
    *(bool *)place = true;
}

static void take_word(const struct neph_cli_option *row, const char *argument, void *place,
                      const struct argp_state *state)
{
    (void)row;
    (void)state;
    *(const char **)place = argument;
}

static void take_file(const struct neph_cli_option *row, const char *argument, void *place,
                      const struct argp_state *state)
{
    if (argument[0] == '\0')
        argp_error(state, "--%s is empty: it names nothing to write to", row->name);
    *(const char **)place = argument;
}

static void take_output(const struct neph_cli_option *row, const char *argument, void *place,
                        const struct argp_state *state)
{
    if (!neph_text_is_utf8(argument, strlen(argument)))
        argp_error(state,
                   "--%s '%s' is not UTF-8: results could not say where their frames are; choose "
                   "another name",
                   row->name, argument);
    take_file(row, argument, place, state);
}

static void take_words(const struct neph_cli_option *row, const char *argument, void *place,
                       const struct argp_state *state)
{
    struct neph_cli_words *words = place;
    if (words->count == NEPH_CLI_WORDS_MAX)
        argp_error(state, "--%s is there more than %d times", row->name, NEPH_CLI_WORDS_MAX);
    words->list[words->count++] = argument;
}

static void take_integer(const struct neph_cli_option *row, const char *argument, void *place,
                         const struct argp_state *state)
{
    char *end;
    errno = 0;
    const long value = strtol(argument, &end, 10);
    if (end == argument || *end || errno || (double)value < row->minimum ||
        (double)value > row->maximum)
        argp_error(state, "--%s '%s' is not an integer in %.0f..%.0f", row->name, argument,
                   row->minimum, row->maximum);
    *(int *)place = (int)value;
}

static void take_real(const struct neph_cli_option *row, const char *argument, void *place,
                      const struct argp_state *state)
{
    char *end;
    const double value = strtod(argument, &end);
    const bool is_bounded = row->minimum < row->maximum;
    const bool is_number = end != argument && !*end && !isnan(value);
    if (!is_number && !is_bounded)
        argp_error(state, "--%s '%s' is not a number", row->name, argument);
    if (is_bounded && (!is_number || value < row->minimum || value > row->maximum))
        argp_error(state, "--%s '%s' is not a number in %g..%g", row->name, argument, row->minimum,
                   row->maximum);
    *(double *)place = value;
}

static void take_size(const struct neph_cli_option *row, const char *argument, void *place,
                      const struct argp_state *state)
{
    char rest;
    struct neph_cli_size size = {0, 0};
    if (sscanf(argument, "%5dx%5d%c", &size.width_px, &size.height_px, &rest) != 2 ||
        size.width_px < 1 || size.height_px < 1 || size.width_px > NEPH_IMAGE_SIDE_MAX_PX ||
        size.height_px > NEPH_IMAGE_SIDE_MAX_PX)
        argp_error(state, "--%s '%s' is not WIDTHxHEIGHT with sides of 1..%d pixels", row->name,
                   argument, NEPH_IMAGE_SIDE_MAX_PX);
    *(struct neph_cli_size *)place = size;
}

static void take_one(const struct neph_cli_option *row, const char *argument, void *place,
                     const struct argp_state *state)
{
    const char **word = place;
    const bool is_default = !*word || (row->otherwise && *word == row->otherwise);
    if (!is_default || strchr(argument, ','))
        argp_error(state, "--%s '%s': there is one, not several, in this verb", row->name,
                   argument);
    *word = argument;
}

/* Splits the argument where it lies in argv, behind which nothing reads it whole. */
static void take_list(const struct neph_cli_option *row, const char *argument, void *place,
                      const struct argp_state *state)
{
    struct neph_cli_list *list = place;
    char *rest = (char *)argument;
    const int most = row->maximum > 0 ? (int)row->maximum : NEPH_CLI_LIST_MAX;
    while (rest) {
        if (list->count == most)
            argp_error(state, "--%s has more than %d names", row->name, most);
        const char *word = strsep(&rest, ",");
        for (int i = 0; i < list->count; i++)
            if (strcmp(list->words[i], word) == 0)
                argp_error(state, "--%s: '%s' is twice in the list", row->name, word);
        list->words[list->count++] = word;
    }
}

static take_function *const take[] = {
    [NEPH_CLI_FLAG] = take_flag,    [NEPH_CLI_WORD] = take_word,
    [NEPH_CLI_FILE] = take_file,    [NEPH_CLI_OUTPUT] = take_output,
    [NEPH_CLI_WORDS] = take_words,  [NEPH_CLI_INTEGER] = take_integer,
    [NEPH_CLI_REAL] = take_real,    [NEPH_CLI_SIZE] = take_size,
    [NEPH_CLI_NAMES] = take_list,   [NEPH_CLI_LIST] = take_list,
    [NEPH_CLI_NUMBERS] = take_list, [NEPH_CLI_ONE] = take_one,
};

/* ---- the table ------------------------------------------------------------------------------- */

static bool is_list(const struct neph_cli_option *row)
{
    return row->kind == NEPH_CLI_LIST || row->kind == NEPH_CLI_NUMBERS;
}

static struct neph_cli_option complete(const struct neph_cli_option *row)
{
    const struct neph_cli_option *shared = shared_options;
    while (shared->name && strcmp(shared->name, row->name) != 0)
        shared++;
    if (!shared->name)
        return *row;
    struct neph_cli_option whole = row->kind == NEPH_CLI_SHARED ? *shared : *row;
    whole.letter = shared->letter;
    whole.argument = row->argument ? row->argument : shared->argument;
    whole.help = row->help ? row->help : shared->help;
    whole.otherwise = row->otherwise;
    whole.group = row->group;
    return whole;
}

/* Complete a table's rows, and set their places to what they are when nothing is given. */
static void add_rows(struct parse *parse, const struct neph_cli_option *rows)
{
    for (; rows && rows->name && parse->row_count < ROWS_MAX; rows++) {
        const struct neph_cli_option row = complete(rows);
        void *place = parse->request + row.at;
        parse->rows[parse->row_count++] = row;
        if (row.kind == NEPH_CLI_INTEGER)
            *(int *)place = -1;
        if (row.kind == NEPH_CLI_REAL)
            *(double *)place = NAN;
        if (row.otherwise && !is_list(&row) && row.kind != NEPH_CLI_NAMES)
            take[row.kind](&row, row.otherwise, place, NULL);
    }
}

static int row_key(const struct parse *parse, int row)
{
    const struct neph_cli_option *option = &parse->rows[row];
    return option->letter ? option->letter : KEY_FIRST + row;
}

static const struct neph_cli_option *find_row(const struct parse *parse, int key)
{
    for (int i = 0; i < parse->row_count; i++)
        if (row_key(parse, i) == key)
            return &parse->rows[i];
    return NULL;
}

static const struct neph_cli_option *row_named(const struct parse *parse, const char *name)
{
    for (int i = 0; i < parse->row_count; i++)
        if (strcmp(parse->rows[i].name, name) == 0)
            return &parse->rows[i];
    return NULL;
}

/* ---- argp ------------------------------------------------------------------------------------ */

static void check_operands(const struct neph_cli_operands *operands,
                           const struct neph_cli_shared *shared, const struct argp_state *state)
{
    if (shared->operand_count < operands->minimum)
        argp_error(state, "%s", operands->missing);
    if (operands->surplus && shared->operand_count > operands->maximum)
        argp_error(state, "%s, not '%s' as well", operands->surplus,
                   shared->operands[operands->maximum]);
}

/* What stands for an option of presets; to free. NULL: memory is short. */
static char *preset_names(const struct neph_cli_option *row)
{
    return neph_preset_names(row->presets, row->uses, row->otherwise ? row->otherwise : "",
                             row->between ? row->between : ",");
}

static void print_help(const struct parse *parse)
{
    const struct neph_cli_syntax *syntax = parse->syntax;
    struct neph_help_option options[ROWS_MAX + 2] = {
        {.name = "help", .letter = '?', .text = "Give this help list", .group = -1},
        {.name = "usage", .text = "Give a short usage message", .group = -1}};
    char *names[ROWS_MAX] = {NULL};
    for (int i = 0; i < parse->row_count; i++) {
        const struct neph_cli_option *row = &parse->rows[i];
        names[i] = row->presets ? preset_names(row) : NULL;
        options[2 + i] = (struct neph_help_option){.name = row->name,
                                                   .letter = row->letter,
                                                   .argument = row->argument,
                                                   .text = row->help,
                                                   .otherwise = names[i] ? names[i]
                                                                         : row->otherwise,
                                                   .group = row->group};
    }
    const struct neph_help help = {
        .verb = parse->verb,
        .operands = syntax->operands ? syntax->operands->shown : NULL,
        .doc = syntax->doc,
        .options = options,
        .option_count = parse->row_count + 2,
    };
    neph_help_print(&help, stdout);
    for (int i = 0; i < parse->row_count; i++)
        free(names[i]);
}

/* The row of a key; a warning where it is that of an old name. NULL: there is none. */
static const struct neph_cli_option *row_of_key(const struct parse *parse, int key)
{
    if (key < KEY_OLD || key >= KEY_USAGE) /* keys of argp's own are above those here, or 0 */
        return find_row(parse, key);
    const struct neph_old_option *old = &neph_old_options[key - KEY_OLD];
    char was[64], is[64];
    snprintf(was, sizeof(was), "--%s", old->old);
    snprintf(is, sizeof(is), "--%s", old->name);
    neph_old_option_warn(parse->verb, was, is);
    return row_named(parse, old->name);
}

static error_t parse_key(int key, char *argument, struct argp_state *state)
{
    struct parse *parse = state->input;
    struct neph_cli_shared *shared = (void *)parse->request;
    const struct neph_cli_syntax *syntax = parse->syntax;
    if (key == ARGP_KEY_ARGS && syntax->operands) {
        shared->operands = (const char *const *)state->argv + state->next;
        shared->operand_count = state->argc - state->next;
        return 0;
    }
    if (key == ARGP_KEY_END) {
        if (syntax->operands)
            check_operands(syntax->operands, shared, state);
        if (syntax->check)
            syntax->check(parse->request, state);
        return 0;
    }
    if (key == '?') {
        print_help(parse);
        exit(0);
    }
    if (key == KEY_USAGE)
        argp_state_help(state, stdout, ARGP_HELP_USAGE | ARGP_HELP_EXIT_OK);
    const struct neph_cli_option *row = row_of_key(parse, key);
    if (!row)
        return ARGP_ERR_UNKNOWN;
    take[row->kind](row, argument, parse->request + row->at, state);
    return 0;
}

static ssize_t write_clean(void *cookie, const char *bytes, size_t size)
{
    char *text = malloc(size + 1);
    if (!text)
        return 0;
    for (size_t i = 0; i < size; i++)
        text[i] = bytes[i] ? bytes[i] : '?';
    text[size] = '\0';
    char *clean = neph_text_clean_copy(text);
    if (clean)
        fputs(clean, cookie);
    free(clean);
    free(text);
    return clean ? (ssize_t)size : 0;
}

static void run_argp(const struct argp *argp, int argc, char **argv, struct parse *parse)
{
    /* getopt(3) inside argp knows no stream but stderr, which is a variable in glibc. */
    FILE *terminal = stderr;
    FILE *clean = fopencookie(terminal, "w", (cookie_io_functions_t){.write = write_clean});
    if (clean) {
        setvbuf(clean, NULL, _IOLBF, 0); /* whole lines: no character is cut in two */
        stderr = clean;
    }
    argp_parse(argp, argc, argv, ARGP_NO_HELP, NULL, parse);
    stderr = terminal;
    if (clean)
        fclose(clean);
}

/* Options of a verb as argp takes them, and the old names, which no help shows. */
static void list_options(const struct parse *parse, struct argp_option *options)
{
    const char *verb = strchr(parse->verb, ' ');
    for (int i = 0; i < parse->row_count; i++) {
        const struct neph_cli_option *row = &parse->rows[i];
        *options++ = (struct argp_option){.name = row->name,
                                          .key = row_key(parse, i),
                                          .arg = row->argument,
                                          .doc = row->help,
                                          .group = row->group};
    }
    for (int i = 0, count = 0; verb && neph_old_options[i].verb && count < OLD_MAX; i++) {
        const struct neph_old_option *old = &neph_old_options[i];
        const struct neph_cli_option *row = row_named(parse, old->name);
        if (strcmp(old->verb, verb + 1) != 0 || !row)
            continue;
        count++;
        *options++ = (struct argp_option){
            .name = old->old, .key = KEY_OLD + i, .arg = row->argument, .flags = OPTION_HIDDEN};
    }
    *options++ = (struct argp_option){.name = "help", .key = '?', .doc = "", .group = -1};
    *options++ = (struct argp_option){.name = "usage", .key = KEY_USAGE, .doc = "", .group = -1};
}

void neph_cli_parse(const struct neph_cli_syntax *syntax, int argc, char **argv, void *request)
{
    struct parse parse = {.syntax = syntax, .request = request, .verb = argv[0]};
    struct argp_option options[ROWS_MAX + OLD_MAX + 3] = {{0}};
    add_rows(&parse, syntax->options);
    add_rows(&parse, syntax->more);
    list_options(&parse, options);
    const struct argp argp = {.options = options,
                              .parser = parse_key,
                              .args_doc = syntax->operands ? syntax->operands->shown : NULL};
    run_argp(&argp, argc, argv, &parse);
    const struct neph_cli_shared *shared = request;
    if (shared->blender && setenv("NEPH_BLENDER", shared->blender, 1) != 0)
        fprintf(stderr, "neph: --blender is ignored: %s\n", strerror(errno));
}

bool neph_cli_only_operand(struct neph_cli_shared *shared, int index)
{
    if (index >= shared->operand_count)
        return false;
    shared->operands += index;
    shared->operand_count = 1;
    return true;
}

enum neph_status neph_cli_check_range(const char *option, int value, int minimum, int maximum,
                                      struct neph_diag *diag)
{
    if (value >= minimum && value <= maximum)
        return NEPH_OK;
    return neph_fail(diag, NEPH_ERR_USAGE, "%s %d is not in %d..%d", option, value, minimum,
                     maximum);
}

enum neph_status neph_cli_split(char *text, const char *what, int most, const char **words,
                                int *count, struct neph_diag *diag)
{
    for (*count = 0; text;) {
        if (*count == most)
            return neph_fail(diag, NEPH_ERR_USAGE, "more than %d %s", most, what);
        const char *word = strsep(&text, ",");
        for (int i = 0; i < *count; i++)
            if (strcmp(words[i], word) == 0)
                return neph_fail(diag, NEPH_ERR_USAGE, "'%s' is twice among the %s", word, what);
        words[(*count)++] = word;
    }
    return NEPH_OK;
}

/* ---- lists ----------------------------------------------------------------------------------- */

static enum neph_status read_numbers(const char *name, struct neph_cli_list *list,
                                     struct neph_diag *diag)
{
    for (int i = 0; i < list->count; i++) {
        char *end;
        list->numbers[i] = strtod(list->words[i], &end);
        if (end == list->words[i] || *end || !isfinite(list->numbers[i]))
            return neph_fail(diag, NEPH_ERR_USAGE, "--%s: '%s' is no number", name, list->words[i]);
    }
    return NEPH_OK;
}

/* What stands for a list that is not given; numbers. */
static enum neph_status split_list(const struct neph_cli_option *row, struct neph_cli_list *list,
                                   struct neph_diag *diag)
{
    const int most = row->maximum > 0 ? (int)row->maximum : NEPH_CLI_LIST_MAX;
    enum neph_status status = NEPH_OK;
    if (list->count == 0 && (row->presets || row->otherwise)) {
        list->text = row->presets ? preset_names(row) : strdup(row->otherwise);
        status = list->text
                     ? neph_cli_split(list->text, row->name, most, list->words, &list->count, diag)
                     : neph_fail_memory(diag);
    }
    if (!status && row->kind == NEPH_CLI_NUMBERS)
        status = read_numbers(row->name, list, diag);
    return status;
}

enum neph_status neph_cli_split_lists(const struct neph_cli_syntax *syntax, void *request,
                                      struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (const struct neph_cli_option *row = syntax->options; row->name && !status; row++)
        if (is_list(row))
            status = split_list(row, (void *)((char *)request + row->at), diag);
    return status;
}

void neph_cli_free_lists(const struct neph_cli_syntax *syntax, void *request)
{
    for (const struct neph_cli_option *row = syntax->options; row->name; row++)
        if (is_list(row)) {
            struct neph_cli_list *list = (void *)((char *)request + row->at);
            free(list->text);
            list->text = NULL;
        }
}
