/* SPDX-License-Identifier: MIT */
#include "harness/compare/frame_number.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

/* ---- names ----------------------------------------------------------------------------------- */

/* A run of digits in a path, path[head, tail), before the extension; folder names included. A minus
 * sign before it is at path[head]. Runs are recomputed for every comparison, which is cheap and
 * needs no storage. */
struct run {
    size_t head, digits, tail;
};

enum {
    DIGITS_MAX = 18, /* more do not fit into a long long */
    WORDS_MAX = 64   /* bits of neph_frame_reading.ids */
};

size_t neph_frame_name_start(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? (size_t)(slash - path) + 1 : 0;
}

/* A name that starts with its only dot has no extension, and an extension starts with a letter. */
size_t neph_frame_extension_start(const char *path)
{
    const size_t start = neph_frame_name_start(path);
    const char *dot = strrchr(path + start, '.');
    const bool is_extension = dot && dot > path + start && !isdigit((unsigned char)dot[1]);
    return is_extension ? (size_t)(dot - path) : strlen(path);
}

static bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

static bool is_word_character(char c)
{
    return is_letter(c) || is_digit(c);
}

/* True when the character before path[digits] is the minus sign of the number that starts there. */
static bool has_minus(const char *path, size_t digits, const struct neph_frame_reading *reading)
{
    if (digits == 0 || path[digits - 1] != '-')
        return false;
    if (digits == 1)
        return true;
    const char before = path[digits - 2];
    return strchr("._-/ ", before) || (reading && reading->hyphen_is_minus && is_letter(before));
}

/* ---- identifiers ----------------------------------------------------------------------------- */

/* A word of letters and digits: path[head, tail). */
struct word {
    size_t head, tail;
};

/* Find a word by its index from the left; false when the path has fewer words. */
static bool find_word(const char *path, int index, struct word *word)
{
    const size_t end = neph_frame_extension_start(path);
    size_t at = 0;
    for (int i = 0; i <= index; i++) {
        while (at < end && !is_word_character(path[at]))
            at++;
        word->head = at;
        while (at < end && is_word_character(path[at]))
            at++;
        word->tail = at;
        if (word->head == word->tail)
            return false;
    }
    return true;
}

/* End of the identifier that starts at path[at]; `at` when there is none. */
static size_t id_end(const char *path, size_t at, const struct neph_frame_reading *reading)
{
    struct word word;
    if (!reading || !reading->ids || (at > 0 && is_word_character(path[at - 1])))
        return at;
    for (int i = 0; i < WORDS_MAX && find_word(path, i, &word) && word.head <= at; i++)
        if (word.head == at && (reading->ids >> i & 1))
            return word.tail;
    return at;
}

/* ---- runs ------------------------------------------------------------------------------------ */

/* Find the first run from path[from]; false when there is none before path[end]. */
static bool next_run(const char *path, size_t from, size_t end,
                     const struct neph_frame_reading *reading, struct run *run)
{
    while (from < end) {
        const size_t behind = id_end(path, from, reading);
        if (behind > from) {
            from = behind;
            continue;
        }
        size_t tail = from;
        while (tail < end && is_digit(path[tail]))
            tail++;
        if (tail > from && tail - from <= DIGITS_MAX) {
            *run = (struct run){from - has_minus(path, from, reading), from, tail};
            return true;
        }
        from = tail > from ? tail : from + 1;
    }
    return false;
}

/* Find a run by its index from the left; false when the path has fewer runs. */
static bool find_run(const char *path, int index, const struct neph_frame_reading *reading,
                     struct run *run)
{
    const size_t end = neph_frame_extension_start(path);
    size_t from = 0;
    for (int i = 0; i <= index; i++) {
        if (!next_run(path, from, end, reading, run))
            return false;
        from = run->tail;
    }
    return index >= 0;
}

int neph_frame_run_count(const char *path, const struct neph_frame_reading *reading)
{
    int count = 0;
    struct run run;
    while (find_run(path, count, reading, &run))
        count++;
    return count;
}

static long long number_at(const char *path, int index, const struct neph_frame_reading *reading)
{
    struct run run;
    return find_run(path, index, reading, &run) ? strtoll(path + run.head, NULL, 10) : 0;
}

static int compare_text(const char *a, size_t a_length, const char *b, size_t b_length)
{
    const int order = memcmp(a, b, a_length < b_length ? a_length : b_length);
    return order != 0 ? order : (a_length > b_length) - (a_length < b_length);
}

/* A part of the text between the runs of a path, without identifiers. */
struct piece {
    size_t head, tail;
};

static struct piece next_piece(const char *path, size_t from, size_t end,
                               const struct neph_frame_reading *reading)
{
    size_t tail = from;
    while (tail < end && id_end(path, tail, reading) == tail)
        tail++;
    return (struct piece){from, tail};
}

/* Compare the texts a[a_from, a_end) and b[b_from, b_end) without identifiers. */
static int compare_between(const char *a, size_t a_from, size_t a_end, const char *b, size_t b_from,
                           size_t b_end, const struct neph_frame_reading *reading)
{
    for (;;) {
        const struct piece of_a = next_piece(a, a_from, a_end, reading),
                           of_b = next_piece(b, b_from, b_end, reading);
        const int order = compare_text(a + of_a.head, of_a.tail - of_a.head, b + of_b.head,
                                       of_b.tail - of_b.head);
        const bool a_ends = of_a.tail == a_end, b_ends = of_b.tail == b_end;
        if (order != 0 || a_ends || b_ends)
            return order != 0 ? order : (int)b_ends - (int)a_ends;
        a_from = id_end(a, of_a.tail, reading);
        b_from = id_end(b, of_b.tail, reading);
    }
}

int neph_frame_compare_shapes(const char *a, const char *b,
                              const struct neph_frame_reading *reading)
{
    const size_t a_end = neph_frame_extension_start(a), b_end = neph_frame_extension_start(b);
    size_t a_from = 0, b_from = 0;
    for (;;) {
        struct run of_a = {.head = strlen(a)}, of_b = {.head = strlen(b)};
        const bool a_has = next_run(a, a_from, a_end, reading, &of_a);
        const bool b_has = next_run(b, b_from, b_end, reading, &of_b);
        const int order = compare_between(a, a_from, of_a.head, b, b_from, of_b.head, reading);
        if (order != 0 || !a_has || !b_has)
            return order != 0 ? order : (int)a_has - (int)b_has;
        a_from = of_a.tail;
        b_from = of_b.tail;
    }
}

bool neph_frame_differs_at(const char *a, const char *b, int index,
                           const struct neph_frame_reading *reading)
{
    struct run of_a, of_b;
    return find_run(a, index, reading, &of_a) && find_run(b, index, reading, &of_b) &&
           compare_text(a + of_a.head, of_a.tail - of_a.head, b + of_b.head,
                        of_b.tail - of_b.head) != 0;
}

bool neph_frame_equal_but_for(const char *a, const char *b, int index)
{
    if (neph_frame_compare_shapes(a, b, NULL) != 0)
        return false;
    for (int i = neph_frame_run_count(a, NULL) - 1; i >= 0; i--)
        if (i != index && neph_frame_differs_at(a, b, i, NULL))
            return false;
    return true;
}

/* ---- interpretation of a series -------------------------------------------------------------- */

static bool have_one_shape(char *const *paths, int count, const struct neph_frame_reading *reading)
{
    for (int i = 1; i < count; i++)
        if (neph_frame_compare_shapes(paths[0], paths[i], reading) != 0)
            return false;
    return true;
}

static bool is_mixed(const char *path, const struct word *word)
{
    bool has_letter = false, has_digit = false;
    for (size_t i = word->head; i < word->tail; i++) {
        has_letter |= is_letter(path[i]);
        has_digit |= is_digit(path[i]);
    }
    return has_letter && has_digit;
}

static bool is_hex(const char *path, const struct word *word)
{
    return strspn(path + word->head, "0123456789abcdefABCDEF") >= word->tail - word->head;
}

/* True when two words differ only in digits. */
static bool are_alike(const char *a, struct word of_a, const char *b, struct word of_b)
{
    size_t i = of_a.head, k = of_b.head;
    while (i < of_a.tail && k < of_b.tail) {
        if (is_digit(a[i]) != is_digit(b[k]) || (is_letter(a[i]) && a[i] != b[k]))
            return false;
        const bool in_run = is_digit(a[i]);
        do
            i++;
        while (in_run && i < of_a.tail && is_digit(a[i]));
        do
            k++;
        while (in_run && k < of_b.tail && is_digit(b[k]));
    }
    return i == of_a.tail && k == of_b.tail;
}

/* Kind of the words at one position of all names. */
enum place {
    PLACE_MISSING, /* some names have fewer words */
    PLACE_ALIKE,   /* they differ only in digits */
    PLACE_NAMES,   /* letters differ, and few have digits */
    PLACE_MAYBE_IDS,
    PLACE_IDS, /* of one length or hexadecimal, with different first letters */
};

static enum place classify_place(char *const *paths, int count, int index)
{
    enum { ID_LENGTH_MIN = 4 };
    struct word first, word;
    size_t shortest = SIZE_MAX;
    int mixed = 0, found = 0;
    bool alike = true, same_length = true, same_start = true, are_hex = true;
    if (!find_word(paths[0], index, &first))
        first = (struct word){0, 0};
    for (int i = 0; i < count; i++) {
        if (!find_word(paths[i], index, &word))
            continue;
        found++;
        alike &= are_alike(paths[0], first, paths[i], word);
        const size_t length = word.tail - word.head;
        shortest = length < shortest ? length : shortest;
        same_length &= length == first.tail - first.head;
        same_start &= paths[i][word.head] == paths[0][first.head];
        mixed += is_mixed(paths[i], &word);
        are_hex &= is_hex(paths[i], &word);
    }
    if (found < count)
        return PLACE_MISSING;
    if (alike)
        return PLACE_ALIKE;
    if (2 * mixed < count && !(are_hex && mixed > 0))
        return PLACE_NAMES;
    const bool are_ids = shortest >= ID_LENGTH_MIN && (same_length || are_hex) && !same_start;
    return are_ids ? PLACE_IDS : PLACE_MAYBE_IDS;
}

/* Treat words that are unique to each file as identifiers. False: the names have no common shape
 * without them. */
static bool read_with_ids(char *const *paths, int count, struct neph_frame_reading *reading)
{
    *reading = (struct neph_frame_reading){.ids = 0};
    for (int i = 0; i < WORDS_MAX; i++) {
        const enum place place = classify_place(paths, count, i);
        if (place == PLACE_MISSING)
            break;
        if (place == PLACE_NAMES)
            return false;
        if (place != PLACE_ALIKE)
            reading->ids |= UINT64_C(1) << i;
        reading->is_guess |= place == PLACE_MAYBE_IDS;
    }
    return reading->ids && have_one_shape(paths, count, reading);
}

/* ---- order ----------------------------------------------------------------------------------- */

static int compare_numbers(const void *a, const void *b, void *series_)
{
    const char *first = *(char *const *)a, *second = *(char *const *)b;
    const struct neph_frame_series *series = series_;
    const long long x = neph_frame_number(first, series), y = neph_frame_number(second, series);
    return x != y ? (x > y) - (x < y) : strcmp(first, second);
}

static void sort_by_number(char **paths, int count, const struct neph_frame_series *series)
{
    struct neph_frame_series key = *series;
    qsort_r(paths, (size_t)count, sizeof(*paths), compare_numbers, &key);
}

/* Compare by all numbers, from the left. */
static int compare_all_numbers(const void *a, const void *b, void *reading)
{
    const char *first = *(char *const *)a, *second = *(char *const *)b;
    const int count = neph_frame_run_count(first, reading);
    for (int i = 0; i < count; i++) {
        const long long x = number_at(first, i, reading), y = number_at(second, i, reading);
        if (x != y)
            return (x > y) - (x < y);
    }
    return strcmp(first, second);
}

static bool changes_at(char *const *paths, int count, int index,
                       const struct neph_frame_reading *reading)
{
    for (int i = 1; i < count; i++)
        if (neph_frame_differs_at(paths[0], paths[i], index, reading))
            return true;
    return false;
}

static bool counts_up(char *const *paths, int count, const struct neph_frame_series *series)
{
    for (int i = 1; i < count; i++)
        if (neph_frame_number(paths[i], series) != neph_frame_number(paths[i - 1], series) + 1)
            return false;
    return true;
}

/* ---- series ---------------------------------------------------------------------------------- */

long long neph_frame_number(const char *path, const struct neph_frame_series *series)
{
    return number_at(path, series->run, &series->reading);
}

static enum neph_status fail_ambiguous(char *const *paths, int count, const int changing[2],
                                       const struct neph_frame_reading *reading,
                                       struct neph_diag *diag)
{
    const int one = changing[1], other = changing[0];
    int unlike = 1; /* a file in which both runs change */
    while (unlike + 1 < count && !(neph_frame_differs_at(paths[0], paths[unlike], one, reading) &&
                                   neph_frame_differs_at(paths[0], paths[unlike], other, reading)))
        unlike++;
    struct run first = {.head = 0}, second = {.head = 0};
    find_run(paths[0], one, reading, &first);
    find_run(paths[0], other, reading, &second);
    neph_fail(diag, NEPH_ERR_INPUT,
              "which number of '%s' counts the frames, '%.*s' or '%.*s'? Both change: '%s'",
              paths[0], (int)(first.tail - first.head), paths[0] + first.head,
              (int)(second.tail - second.head), paths[0] + second.head, paths[unlike]);
    neph_hint(diag, "name one sequence by a pattern that has %%d in place of its frame number");
    return NEPH_ERR_INPUT;
}

/* The runs that change between files of one shape; `runs`: the last and the first of them. */
struct changes {
    int count, runs[2];
    int counting_count, counting; /* number of runs that increase by one, and the first of these */
};

static struct changes find_changes(char **paths, int count,
                                   const struct neph_frame_reading *reading)
{
    struct changes changes = {.runs = {NEPH_FRAME_NO_RUN, NEPH_FRAME_NO_RUN},
                              .counting = NEPH_FRAME_NO_RUN};
    for (int i = neph_frame_run_count(paths[0], reading) - 1; i >= 0; i--) {
        const struct neph_frame_series series = {.reading = *reading, .run = i};
        if (!changes_at(paths, count, i, reading))
            continue;
        changes.runs[changes.count++ > 0] = i;
        sort_by_number(paths, count, &series);
        if (counts_up(paths, count, &series)) {
            changes.counting = i;
            changes.counting_count++;
        }
    }
    return changes;
}

static bool has_frame_run(const struct changes *changes, int *run)
{
    *run = changes->count > 1 ? changes->counting : changes->runs[0];
    return changes->count <= 1 || changes->counting_count == 1;
}

/* True when the paths are a series without gaps in this interpretation. Sorts the paths. */
static bool counts_up_read(char **paths, int count, const struct neph_frame_reading *reading)
{
    struct neph_frame_series series = {.reading = *reading};
    const struct changes changes = find_changes(paths, count, reading);
    if (!has_frame_run(&changes, &series.run) || series.run == NEPH_FRAME_NO_RUN)
        return false;
    sort_by_number(paths, count, &series);
    return counts_up(paths, count, &series);
}

static bool has_changing_run(char *const *paths, int count,
                             const struct neph_frame_reading *reading)
{
    for (int i = neph_frame_run_count(paths[0], reading) - 1; i >= 0; i--)
        if (changes_at(paths, count, i, reading))
            return true;
    return false;
}

bool neph_frame_find_series(char **paths, int count, struct neph_frame_reading *reading)
{
    const struct neph_frame_reading with_minus = {.hyphen_is_minus = true};
    struct neph_frame_reading with_ids;
    *reading = (struct neph_frame_reading){.ids = 0};
    if (have_one_shape(paths, count, NULL))
        return true;
    if (have_one_shape(paths, count, &with_minus) && counts_up_read(paths, count, &with_minus)) {
        *reading = with_minus;
        return true;
    }
    if (!read_with_ids(paths, count, &with_ids) || !has_changing_run(paths, count, &with_ids) ||
        (with_ids.is_guess && !counts_up_read(paths, count, &with_ids)))
        return false;
    *reading = with_ids;
    return true;
}

/* Report missing frames between two consecutive files of a series. */
static enum neph_status fail_missing(const char *path, long long number, long long next,
                                     const struct neph_frame_series *series, struct neph_diag *diag)
{
    struct run run = {.head = 0};
    const long long missing = number + 1, count = next - missing;
    find_run(path, series->run, &series->reading, &run);
    if (series->reading.ids) /* the identifier of a missing file is unknown */
        neph_fail(diag, NEPH_ERR_INPUT,
                  "frame %lld is missing (%lld from %lld to %lld), the one behind '%s'", missing,
                  count, missing, next - 1, path);
    else
        neph_fail(diag, NEPH_ERR_INPUT,
                  "frame '%.*s%s%0*lld%s' is missing (%lld from %lld to %lld)", (int)run.head, path,
                  missing < 0 ? "-" : "", (int)(run.tail - run.digits), llabs(missing),
                  path + run.tail, count, missing, next - 1);
    neph_hint(diag, "a sequence has no gaps: render the missing frames, or renumber the files; "
                    "`neph compare`, `flicker` and `view` take it as it is with --by-position");
    return NEPH_ERR_INPUT;
}

/* Check two consecutive paths of a sorted series. */
static enum neph_status check_step(const char *path, const char *next,
                                   const struct neph_frame_series *series, struct neph_diag *diag)
{
    if (strcmp(path, next) == 0)
        return neph_fail(diag, NEPH_ERR_INPUT, "'%s' is there twice", path);
    const long long number = neph_frame_number(path, series),
                    number_of_next = neph_frame_number(next, series);
    if (number == number_of_next)
        return neph_fail(diag, NEPH_ERR_INPUT, "'%s' and '%s' have the same frame number", path,
                         next);
    return number_of_next == number + 1 ? NEPH_OK
                                        : fail_missing(path, number, number_of_next, series, diag);
}

enum neph_status neph_frame_arrange(char **paths, int count,
                                    const struct neph_frame_reading *reading, bool by_position,
                                    struct neph_frame_series *series, struct neph_diag *diag)
{
    struct neph_frame_reading key = *reading;
    const struct changes changes = find_changes(paths, count, reading);
    *series = (struct neph_frame_series){.reading = *reading};
    const bool is_clear = has_frame_run(&changes, &series->run);
    if (!is_clear && !by_position)
        return fail_ambiguous(paths, count, changes.runs, reading, diag);
    if (!is_clear) {
        series->run = NEPH_FRAME_NO_RUN;
        series->has_gaps = true;
        qsort_r(paths, (size_t)count, sizeof(*paths), compare_all_numbers, &key);
        return NEPH_OK;
    }
    sort_by_number(paths, count, series);
    series->has_gaps = !counts_up(paths, count, series);
    enum neph_status status = NEPH_OK;
    for (int i = 1; i < count && !status && !by_position; i++)
        status = check_step(paths[i - 1], paths[i], series, diag);
    return status;
}
