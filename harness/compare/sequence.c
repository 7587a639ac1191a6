/* SPDX-License-Identifier: MIT */
#include "harness/compare/sequence.h"

#include "base/files.h"
#include "harness/compare/clips.h"
#include "harness/compare/frame_number.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* ---- order ----------------------------------------------------------------------------------- */

static int compare_paths(const void *a, const void *b)
{
    const char *first = *(char *const *)a, *second = *(char *const *)b;
    const int order = neph_frame_compare_shapes(first, second, NULL);
    return order != 0 ? order : strcmp(first, second);
}

/* The number of paths, from the first, that have the same shape; the paths are sorted. */
static int shape_count(char *const *paths, int count)
{
    int same = 1;
    while (same < count && neph_frame_compare_shapes(paths[0], paths[same], NULL) == 0)
        same++;
    return same;
}

/* Sort the files of each shape as a series. */
static enum neph_status arrange_each(char **paths, int count, bool by_position,
                                     struct neph_diag *diag)
{
    const struct neph_frame_reading plain = {.ids = 0};
    struct neph_frame_series series;
    enum neph_status status = NEPH_OK;
    for (int first = 0; first < count && !status;) {
        const int same = shape_count(paths + first, count - first);
        status = neph_frame_arrange(paths + first, same, &plain, by_position, &series, diag);
        first += same;
    }
    return status;
}

static void sort(char **paths, int count)
{
    if (count > 1)
        qsort(paths, (size_t)count, sizeof(*paths), compare_paths);
}

/* ---- the list -------------------------------------------------------------------------------- */

/* Append a path. Takes ownership of `path`, also on failure; NULL is a failed allocation of the
 * caller. */
static enum neph_status append(struct neph_sequence *list, char *path, struct neph_diag *diag)
{
    const size_t count = (size_t)list->count;
    bool is_short = !path;
    if (path && (count & (count - 1)) == 0) { /* capacity is a power of two */
        char **grown = realloc(list->paths, (count ? 2 * count : 1) * sizeof(*grown));
        list->paths = grown ? grown : list->paths;
        is_short = !grown;
    }
    if (is_short) {
        free(path);
        return neph_fail_memory(diag);
    }
    list->paths[list->count++] = path;
    return NEPH_OK;
}

void neph_sequence_finish(struct neph_sequence *sequence)
{
    for (int i = 0; i < sequence->count; i++)
        free(sequence->paths[i]);
    free(sequence->paths);
    free(sequence->numbers);
    *sequence = (struct neph_sequence){0};
}

/* ---- folders --------------------------------------------------------------------------------- */

/* A filter for names in a folder. */
typedef bool name_filter(const char *name, const void *wanted);

static bool has_extension(const char *name, const void *wanted)
{
    return name[0] != '.' && strcasecmp(name + neph_frame_extension_start(name), wanted) == 0;
}

/* Append the files of a folder that pass the filter, as folder/name; `folder` "" is the working
 * folder. */
static enum neph_status list_folder(const char *folder, name_filter *passes, const void *wanted,
                                    struct neph_sequence *list, struct neph_diag *diag)
{
    DIR *stream = opendir(*folder ? folder : ".");
    if (!stream)
        return neph_fail(diag, errno == ENOENT ? NEPH_ERR_NOT_FOUND : NEPH_ERR_IO,
                         "cannot read the folder '%s': %s", folder, strerror(errno));
    enum neph_status status = NEPH_OK;
    const struct dirent *entry;
    while (!status && (entry = readdir(stream))) {
        if (!passes(entry->d_name, wanted))
            continue;
        char *path = neph_path_join(folder, entry->d_name);
        if (path && neph_path_is_dir(path))
            free(path);
        else
            status = append(list, path, diag);
    }
    closedir(stream);
    return status;
}

static enum neph_status expand_folder(const char *word, struct neph_sequence *list,
                                      struct neph_diag *diag)
{
    static const char *const extensions[] = {".exr", ".png", ".tif", ".tiff", ".hdr",  ".pfm",
                                             ".ppm", ".pgm", ".jpg", ".jpeg", ".webp", ".dpx"};
    const int before = list->count;
    enum neph_status status = NEPH_OK;
    for (size_t i = 0; i < sizeof(extensions) / sizeof(extensions[0]) && !status; i++)
        if (list->count == before)
            status = list_folder(word, has_extension, extensions[i], list, diag);
    if (!status && list->count == before)
        status = neph_fail(diag, NEPH_ERR_NOT_FOUND,
                           "the folder '%s' has no .exr and no .png files, nor others that are "
                           "read",
                           word);
    return status;
}

/* ---- patterns -------------------------------------------------------------------------------- */

/* A file name with a placeholder for the frame number. */
struct pattern {
    const char *name;  /* of the file */
    size_t head;       /* length of the text before the placeholder */
    const char *tail;  /* text after it */
    size_t width;      /* least number of digits; 0: no padding */
    bool is_any_width; /* with or without leading zeros */
};

/* Length of a %d or %0Nd at `text`, or 0. */
static size_t percent_length(const char *text, struct pattern *pattern)
{
    pattern->width = 0;
    if (text[0] == '%' && text[1] == 'd')
        return 2;
    if (text[0] == '%' && text[1] == '0' && text[2] >= '1' && text[2] <= '9' && text[3] == 'd') {
        pattern->width = (size_t)(text[2] - '0');
        return 4;
    }
    return 0;
}

/* Length of a $F or $FN at `text`, or 0; $FF and $FOO are other variables. */
static size_t dollar_length(const char *text, struct pattern *pattern)
{
    if (text[0] != '$' || text[1] != 'F')
        return 0;
    const bool has_width = text[2] >= '1' && text[2] <= '9';
    const size_t length = has_width ? 3 : 2;
    if (isalnum((unsigned char)text[length]) || text[length] == '_')
        return 0;
    pattern->width = has_width ? (size_t)(text[2] - '0') : 0;
    return length;
}

/* Length of a run of # at `text`, or 0. A single # means four digits in some programs, one digit in
 * others. */
static size_t hash_length(const char *text, struct pattern *pattern)
{
    const size_t length = strspn(text, "#");
    pattern->width = length > 1 ? length : 0;
    pattern->is_any_width = length == 1;
    return length;
}

typedef size_t conversion_length(const char *text, struct pattern *pattern);

/* Count the placeholders of a kind in the file name of a word; `pattern` describes the last one. */
static int find_conversion(const char *word, conversion_length *length_at, struct pattern *pattern)
{
    int count = 0;
    const char *name = word + neph_frame_name_start(word);
    for (const char *at = name; *at; at++) {
        struct pattern found = {.name = name, .head = (size_t)(at - name)};
        const size_t length = length_at(at, &found);
        if (length == 0)
            continue;
        found.tail = at + length;
        *pattern = found;
        at += length - 1;
        count++;
    }
    return count;
}

static enum neph_status fail_pattern(const char *word, struct neph_diag *diag)
{
    neph_fail(diag, NEPH_ERR_USAGE, "'%s' is neither a file nor a pattern", word);
    neph_hint(diag, "a pattern has one %%d, %%04d, #### or $F4 in the name of the file, as "
                    "frame.%%04d.exr; quote it");
    return NEPH_ERR_USAGE;
}

/* Parse a word with a %, which may contain no other %. */
static enum neph_status parse_percent(const char *word, struct pattern *pattern,
                                      struct neph_diag *diag)
{
    const char *first = strchr(word, '%');
    const bool is_one = find_conversion(word, percent_length, pattern) == 1 &&
                        first == pattern->name + pattern->head && !strchr(first + 1, '%');
    return is_one ? NEPH_OK : fail_pattern(word, diag);
}

/* Parse a word with a $F or a # in the file name. A # is an ordinary character beside a $F or a
 * longer run of #. */
static enum neph_status parse_other(const char *word, struct pattern *pattern,
                                    struct neph_diag *diag)
{
    const int dollars = find_conversion(word, dollar_length, pattern);
    if (dollars > 0)
        return dollars == 1 ? NEPH_OK : fail_pattern(word, diag);
    return find_conversion(word, hash_length, pattern) == 1 ? NEPH_OK : fail_pattern(word, diag);
}

static bool is_other_pattern(const char *word)
{
    struct pattern pattern;
    return find_conversion(word, dollar_length, &pattern) > 0 ||
           find_conversion(word, hash_length, &pattern) > 0;
}

/* True when printf could have made this name. printf counts a minus sign in its width, other
 * programs do not. */
static bool matches_pattern(const char *name, const void *wanted)
{
    const struct pattern *pattern = wanted;
    if (strncmp(name, pattern->name, pattern->head) != 0)
        return false;
    const bool is_negative = name[pattern->head] == '-';
    const char *digits = name + pattern->head + is_negative;
    const size_t count = strspn(digits, "0123456789");
    const size_t width = pattern->width ? pattern->width : 1;
    const size_t least = is_negative && width > 1 ? width - 1 : width;
    const bool is_padded = count > width && digits[0] == '0';
    return count >= least && (!is_padded || pattern->is_any_width) &&
           strcmp(digits + count, pattern->tail) == 0;
}

/* True when all matching files have a hyphen after a letter or digit: then it is probably a hyphen,
 * not a minus sign. */
static bool has_hyphens_only(const struct pattern *pattern, char *const *paths, int count)
{
    const char before = pattern->head > 0 ? pattern->name[pattern->head - 1] : '.';
    if (strchr("._- ", before))
        return false;
    for (int i = 0; i < count; i++)
        if (paths[i][neph_frame_name_start(paths[i]) + pattern->head] != '-')
            return false;
    return true;
}

static enum neph_status expand_pattern(const char *word, const struct pattern *pattern,
                                       struct neph_sequence *list, struct neph_diag *diag)
{
    char *folder = strndup(word, neph_frame_name_start(word));
    if (!folder)
        return neph_fail_memory(diag);
    const int before = list->count;
    enum neph_status status = list_folder(folder, matches_pattern, pattern, list, diag);
    free(folder);
    if (!status && list->count == before)
        return neph_fail(diag, NEPH_ERR_NOT_FOUND, "no file matches '%s'", word);
    if (status || !has_hyphens_only(pattern, list->paths + before, list->count - before))
        return status;
    neph_fail(diag, NEPH_ERR_NOT_FOUND, "no file matches '%s' but with a hyphen: '%s'", word,
              list->paths[before]);
    neph_hint(diag, "if the hyphen is a part of the name, write it into the pattern; if it is a "
                    "minus, name the folder or give the files other names");
    return NEPH_ERR_NOT_FOUND;
}

static enum neph_status expand_glob(const char *word, struct neph_sequence *list,
                                    struct neph_diag *diag)
{
    glob_t found = {0};
    const int result = glob(word, GLOB_NOSORT, NULL, &found);
    enum neph_status status = NEPH_OK;
    const int before = list->count;
    if (result == GLOB_NOSPACE)
        status = neph_fail_memory(diag);
    for (size_t i = 0; !status && i < found.gl_pathc; i++)
        if (!neph_path_is_dir(found.gl_pathv[i]))
            status = append(list, strdup(found.gl_pathv[i]), diag);
    if (!status && list->count == before)
        status = neph_fail(diag, NEPH_ERR_NOT_FOUND, "no file matches '%s'", word);
    globfree(&found);
    return status;
}

/* ---- sequences ------------------------------------------------------------------------------- */

/* Refuse a folder with several sequences, such as beauty.0001.exr, depth.0001.exr, ... */
static enum neph_status check_one_series(const char *word, char *const *paths, int count,
                                         struct neph_diag *diag)
{
    const int other = count > 0 ? shape_count(paths, count) : 0;
    bool has_series = other > 1;
    for (int first = other; first < count;) {
        const int same = shape_count(paths + first, count - first);
        has_series |= same > 1;
        first += same;
    }
    if (!has_series || other == count)
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_INPUT, "'%s' has more than one sequence: '%s' and '%s'", word,
              paths[0], paths[other]);
    neph_hint(diag, "name one of them by a pattern such as frame.%%04d.exr, or by a glob");
    return NEPH_ERR_INPUT;
}

bool neph_sequence_is_frame(const char *word)
{
    struct neph_path file;
    int frame;
    return neph_clip_split(word, &file, &frame) ||
           (neph_path_exists(word) && !neph_path_is_dir(word) && !neph_clip_is(word));
}

static enum neph_status list_clip(const char *file, struct neph_sequence *list,
                                  struct neph_diag *diag)
{
    int count = 0;
    enum neph_status status = neph_clip_count(file, &count, diag);
    for (int i = 0; i < count && !status; i++)
        status = append(list, strdup(neph_clip_frame_path(file, i).text), diag);
    return status;
}

/* List the files of a word, unsorted. */
static enum neph_status list_word(const char *word, struct neph_sequence *list,
                                  struct neph_diag *diag)
{
    struct pattern pattern;
    const bool has_percent = strchr(word, '%');
    if (neph_path_is_dir(word))
        return expand_folder(word, list, diag);
    if (!has_percent && strpbrk(word, "*?["))
        return expand_glob(word, list, diag);
    if (!has_percent && !is_other_pattern(word))
        return neph_fail(diag, NEPH_ERR_NOT_FOUND, "there is no file '%s'", word);
    const enum neph_status status = has_percent ? parse_percent(word, &pattern, diag)
                                                : parse_other(word, &pattern, diag);
    return status ? status : expand_pattern(word, &pattern, list, diag);
}

/* Sort files. The files of a single word must be one sequence (`word` NULL: files of several
 * words). `*series` has a run when they are one series. */
static enum neph_status arrange(const char *word, char **paths, int count, bool by_position,
                                struct neph_frame_series *series, bool *is_series,
                                struct neph_diag *diag)
{
    struct neph_frame_reading reading;
    sort(paths, count);
    *is_series = neph_frame_find_series(paths, count, &reading);
    if (*is_series)
        return neph_frame_arrange(paths, count, &reading, by_position, series, diag);
    sort(paths, count);
    const enum neph_status status = word ? check_one_series(word, paths, count, diag) : NEPH_OK;
    return status ? status : arrange_each(paths, count, by_position, diag);
}

static enum neph_status expand(const char *word, bool by_position, struct neph_sequence *list,
                               struct neph_diag *diag)
{
    const int before = list->count;
    struct neph_frame_series series;
    bool is_series;
    if (neph_clip_is(word))
        return list_clip(word, list, diag);
    if (neph_sequence_is_frame(word))
        return append(list, strdup(word), diag);
    const enum neph_status status = list_word(word, list, diag);
    return status ? status
                  : arrange(word, list->paths + before, list->count - before, by_position, &series,
                            &is_series, diag);
}

static enum neph_status check_formats(const struct neph_sequence *list, struct neph_diag *diag)
{
    const char *first = list->paths[0];
    for (int i = 1; i < list->count; i++) {
        const char *path = list->paths[i];
        if (strcasecmp(first + neph_frame_extension_start(first),
                       path + neph_frame_extension_start(path)) != 0)
            return neph_fail(diag, NEPH_ERR_INPUT,
                             "the files are of different kinds: '%s' and '%s'", first, path);
    }
    return NEPH_OK;
}

/* Take the order and the numbers of `sorted`, which is one series. */
static enum neph_status take_order(struct neph_sequence *list, char *const *sorted,
                                   const struct neph_frame_series *series, struct neph_diag *diag)
{
    memcpy(list->paths, sorted, (size_t)list->count * sizeof(*sorted));
    struct neph_path file;
    int frame;
    if (series->run == NEPH_FRAME_NO_RUN || series->has_gaps ||
        neph_clip_split(sorted[0], &file, &frame)) /* its numbers are only places */
        return NEPH_OK;
    list->numbers = calloc((size_t)list->count, sizeof(*list->numbers));
    for (int i = 0; i < list->count && list->numbers; i++)
        list->numbers[i] = neph_frame_number(list->paths[i], series);
    return list->numbers ? NEPH_OK : neph_fail_memory(diag);
}

static enum neph_status number_all_files(struct neph_sequence *list, int word_count,
                                         bool by_position, struct neph_diag *diag)
{
    struct neph_frame_series series = {.run = NEPH_FRAME_NO_RUN};
    bool is_series;
    char **sorted = malloc((size_t)list->count * sizeof(*sorted));
    if (!sorted)
        return neph_fail_memory(diag);
    memcpy(sorted, list->paths, (size_t)list->count * sizeof(*sorted));
    enum neph_status status = arrange(NULL, sorted, list->count, by_position, &series, &is_series,
                                      diag);
    /* Several words keep their order when their numbers do not define one. */
    const bool has_order = is_series && (series.run != NEPH_FRAME_NO_RUN || word_count == 1);
    if (!status && has_order)
        status = take_order(list, sorted, &series, diag);
    free(sorted);
    return status;
}

enum neph_status neph_sequence_find(int word_count, const char *const *words, bool by_position,
                                    struct neph_sequence *sequence, struct neph_diag *diag)
{
    struct neph_sequence list = {0};
    enum neph_status status = NEPH_OK;
    if (word_count < 1)
        status = neph_fail(diag, NEPH_ERR_USAGE, "no frames are named");
    for (int i = 0; i < word_count && !status; i++)
        status = expand(words[i], by_position, &list, diag);
    if (!status)
        status = check_formats(&list, diag);
    if (!status)
        status = number_all_files(&list, word_count, by_position, diag);
    if (status)
        neph_sequence_finish(&list);
    else
        *sequence = list;
    return status;
}

enum neph_status neph_sequence_check_numbers(const struct neph_sequence *one, const char *what,
                                             const struct neph_sequence *other,
                                             const char *other_what, struct neph_diag *diag)
{
    const bool both_numbered = one->numbers && other->numbers && one->count == other->count;
    if (!both_numbered || one->numbers[0] == other->numbers[0])
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_INPUT,
              "%s has the frames %lld to %lld, %s %lld to %lld: frame by frame they do not belong "
              "together",
              what, one->numbers[0], one->numbers[one->count - 1], other_what, other->numbers[0],
              other->numbers[other->count - 1]);
    neph_hint(diag, "give frames of the same numbers; if they were counted from different starts, "
                    "use --by-position");
    return NEPH_ERR_INPUT;
}

/* ---- assignment of operands ------------------------------------------------------------------ */

/* Mark the operands in the series of a reference, if the frame number is the run `from_end`,
 * counted from the last one; without such a run, mark only the references themselves. Returns their
 * number. */
static int mark_references(int from_end, int reference_count, const char *const *references,
                           int operand_count, const char *const *operands, bool *is_reference)
{
    int marked = 0;
    for (int i = 0; i < operand_count; i++) {
        is_reference[i] = false;
        for (int r = 0;
             r < reference_count && neph_sequence_is_frame(operands[i]) && !is_reference[i]; r++)
            is_reference[i] = neph_sequence_is_frame(references[r]) &&
                              neph_frame_equal_but_for(references[r], operands[i],
                                                       neph_frame_run_count(references[r], NULL) -
                                                           1 - from_end);
        marked += is_reference[i];
    }
    return marked;
}

/* True when the remaining operands are files of one series, or a single word of any kind. `*other`
 * is an operand that does not fit. */
static bool is_one_test(int operand_count, const char *const *operands, const bool *is_reference,
                        const char **test, const char **other)
{
    int changing = NEPH_FRAME_NO_RUN;
    *test = NULL;
    for (int i = 0; i < operand_count; i++) {
        if (is_reference[i])
            continue;
        if (!*test) {
            *test = operands[i];
            continue;
        }
        *other = operands[i];
        if (!neph_sequence_is_frame(*test) || !neph_sequence_is_frame(*other) ||
            neph_frame_compare_shapes(*test, *other, NULL) != 0)
            return false;
        for (int run = neph_frame_run_count(*test, NULL) - 1; run >= 0; run--) {
            if (run == changing || !neph_frame_differs_at(*test, *other, run, NULL))
                continue;
            if (changing != NEPH_FRAME_NO_RUN)
                return false;
            changing = run;
        }
    }
    return true;
}

static enum neph_status fail_split(struct neph_diag *diag)
{
    neph_hint(diag, "put quotes around patterns: --reference 'ref/*.exr' 'test/*.exr'");
    return NEPH_ERR_USAGE;
}

/* Choose the run of the frame number, counted from the last run. Candidates: none (no operand is a
 * reference), the last run, the one before it, ... The first candidate that leaves one test is
 * chosen; candidates with one reference, or as many references as tests, are preferred. */
static int choose_frame_run(int reference_count, const char *const *references, int operand_count,
                            const char *const *operands, bool *is_reference)
{
    const char *test = NULL, *other = NULL;
    int most = 0, chosen = 0;
    bool has_chosen = false;
    for (int r = 0; r < reference_count; r++)
        most = neph_frame_run_count(references[r], NULL) > most
                   ? neph_frame_run_count(references[r], NULL)
                   : most;
    for (int from_end = 0; from_end < most; from_end++)
        if (mark_references(from_end, reference_count, references, operand_count, operands,
                            is_reference) == operand_count)
            return from_end; /* no test is left, which the caller refuses */
    for (int i = 0; i <= most; i++) {
        const int from_end = i == 0 ? most : i - 1;
        const int marked = mark_references(from_end, reference_count, references, operand_count,
                                           operands, is_reference);
        if (!is_one_test(operand_count, operands, is_reference, &test, &other))
            continue;
        if (reference_count + marked == 1 || reference_count + marked == operand_count - marked)
            return from_end;
        chosen = has_chosen ? chosen : from_end;
        has_chosen = true;
    }
    return chosen;
}

enum neph_status neph_sequence_split(int reference_count, const char *const *references,
                                     int operand_count, const char *const *operands,
                                     bool *is_reference, struct neph_diag *diag)
{
    const char *test = NULL, *other = NULL;
    const int from_end = choose_frame_run(reference_count, references, operand_count, operands,
                                          is_reference);
    mark_references(from_end, reference_count, references, operand_count, operands, is_reference);
    if (!is_one_test(operand_count, operands, is_reference, &test, &other)) {
        neph_fail(diag, NEPH_ERR_USAGE,
                  "the frames to be tested are of more than one sequence: '%s' and '%s'", test,
                  other);
        return fail_split(diag);
    }
    if (test)
        return NEPH_OK;
    if (operand_count == 0)
        neph_fail(diag, NEPH_ERR_USAGE, "no frames to be tested are named");
    else
        neph_fail(diag, NEPH_ERR_USAGE,
                  "no frames are left to be tested: '%s' and all after it look like frames of the "
                  "reference",
                  operands[0]);
    return fail_split(diag);
}
