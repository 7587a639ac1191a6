/* SPDX-License-Identifier: MIT */
#include "harness/sequence.h"

#include "base/files.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* ---- names ----------------------------------------------------------------------------------- */

/* A path cut at its frame number: path[0, head) digits path[tail, end). Without a number, head and
 * tail are the end and `number` is -1. Paths are cut anew whenever they are compared: it is cheap,
 * and nothing has to be kept beside them. */
struct parts {
    const char *path;
    size_t head, tail, length;
    long long number;
};

enum { DIGITS_MAX = 18 }; /* more do not fit a long long, and are no frame number */

static size_t name_start(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? (size_t)(slash - path) + 1 : 0;
}

/* The last dot of the name, or its end; a name that starts with its only dot has no extension. */
static size_t extension_start(const char *path)
{
    const size_t start = name_start(path);
    const char *dot = strrchr(path + start, '.');
    return dot && dot > path + start ? (size_t)(dot - path) : strlen(path);
}

static struct parts cut(const char *path)
{
    struct parts parts = {.path = path, .length = strlen(path), .number = -1};
    const size_t start = name_start(path);
    size_t tail = extension_start(path);
    while (tail > start && !isdigit((unsigned char)path[tail - 1]))
        tail--;
    size_t head = tail;
    while (head > start && isdigit((unsigned char)path[head - 1]))
        head--;
    const bool has_number = head < tail && tail - head <= DIGITS_MAX;
    parts.head = has_number ? head : parts.length;
    parts.tail = has_number ? tail : parts.length;
    if (has_number)
        parts.number = strtoll(path + head, NULL, 10);
    return parts;
}

/* 0: the same series. */
static int compare_series(const struct parts *a, const struct parts *b)
{
    const int order = memcmp(a->path, b->path, a->head < b->head ? a->head : b->head);
    if (order != 0)
        return order;
    if (a->head != b->head)
        return a->head < b->head ? -1 : 1;
    return strcmp(a->path + a->tail, b->path + b->tail);
}

static bool is_same_series(const char *a, const char *b)
{
    const struct parts cut_a = cut(a), cut_b = cut(b);
    return compare_series(&cut_a, &cut_b) == 0;
}

static int compare_paths(const void *a, const void *b)
{
    const struct parts first = cut(*(char *const *)a), second = cut(*(char *const *)b);
    const int order = compare_series(&first, &second);
    return order != 0 ? order : (first.number > second.number) - (first.number < second.number);
}

static void sort(char **paths, int count)
{
    if (count > 1)
        qsort(paths, (size_t)count, sizeof(*paths), compare_paths);
}

/* ---- the list -------------------------------------------------------------------------------- */

/* Takes `path` over, also on failure; NULL is a failed allocation of the caller. */
static enum neph_status append(struct neph_sequence *list, char *path, struct neph_diag *diag)
{
    const size_t count = (size_t)list->count;
    if (path && (count & (count - 1)) == 0) { /* full at every power of two */
        char **grown = realloc(list->paths, (count ? 2 * count : 1) * sizeof(*grown));
        if (!grown) {
            free(path);
            path = NULL;
        } else {
            list->paths = grown;
        }
    }
    if (!path)
        return neph_fail_memory(diag);
    list->paths[list->count++] = path;
    return NEPH_OK;
}

void neph_sequence_finish(struct neph_sequence *sequence)
{
    for (int i = 0; i < sequence->count; i++)
        free(sequence->paths[i]);
    free(sequence->paths);
    *sequence = (struct neph_sequence){0};
}

/* ---- folders --------------------------------------------------------------------------------- */

/* What is wanted of a name in a folder. */
typedef bool name_filter(const char *name, const void *wanted);

static bool has_extension(const char *name, const void *wanted)
{
    return name[0] != '.' && strcasecmp(name + extension_start(name), wanted) == 0;
}

/* The files of a folder that pass, as folder/name; `folder` may be "" for the working one. */
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
    const int before = list->count;
    enum neph_status status = list_folder(word, has_extension, ".exr", list, diag);
    if (!status && list->count == before)
        status = list_folder(word, has_extension, ".png", list, diag);
    if (!status && list->count == before)
        status = neph_fail(diag, NEPH_ERR_NOT_FOUND,
                           "the folder '%s' holds neither .exr nor .png files", word);
    return status;
}

/* ---- patterns -------------------------------------------------------------------------------- */

/* A name with a %d or %0Nd in it. */
struct pattern {
    const char *name; /* of the file */
    size_t head;      /* before the % */
    const char *tail; /* behind the d */
    size_t width;     /* N; 0 for %d */
};

/* The length of the %d or %0Nd at `text`, or 0. */
static size_t conversion_length(const char *text, size_t *width)
{
    *width = 0;
    if (text[0] == '%' && text[1] == 'd')
        return 2;
    if (text[0] == '%' && text[1] == '0' && text[2] >= '1' && text[2] <= '9' && text[3] == 'd') {
        *width = (size_t)(text[2] - '0');
        return 4;
    }
    return 0;
}

static enum neph_status parse_pattern(const char *word, struct pattern *pattern,
                                      struct neph_diag *diag)
{
    pattern->name = word + name_start(word);
    const char *percent = strchr(pattern->name, '%');
    const size_t length = percent ? conversion_length(percent, &pattern->width) : 0;
    if (length == 0 || strchr(percent + length, '%') || percent > strchr(word, '%')) {
        neph_fail(diag, NEPH_ERR_USAGE, "'%s' is neither a file nor a pattern", word);
        neph_hint(diag,
                  "a pattern has one %%d or %%04d in the name of the file, as frame.%%04d.exr");
        return NEPH_ERR_USAGE;
    }
    pattern->head = (size_t)(percent - pattern->name);
    pattern->tail = percent + length;
    return NEPH_OK;
}

/* Could printf have made this name? */
static bool matches_pattern(const char *name, const void *wanted)
{
    const struct pattern *pattern = wanted;
    if (strncmp(name, pattern->name, pattern->head) != 0)
        return false;
    const char *digits = name + pattern->head;
    const size_t count = strspn(digits, "0123456789");
    const size_t least = pattern->width ? pattern->width : 1;
    const bool is_padded = count > least && digits[0] == '0';
    return count >= least && !is_padded && strcmp(digits + count, pattern->tail) == 0;
}

static enum neph_status expand_pattern(const char *word, struct neph_sequence *list,
                                       struct neph_diag *diag)
{
    struct pattern pattern;
    enum neph_status status = parse_pattern(word, &pattern, diag);
    if (status)
        return status;
    char *folder = strndup(word, name_start(word));
    if (!folder)
        return neph_fail_memory(diag);
    const int before = list->count;
    status = list_folder(folder, matches_pattern, &pattern, list, diag);
    free(folder);
    if (!status && list->count == before)
        status = neph_fail(diag, NEPH_ERR_NOT_FOUND, "no file matches '%s'", word);
    return status;
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

/* ---- the whole ------------------------------------------------------------------------------- */

/* A folder of beauty.0001.exr, depth.0001.exr, ... is not one sequence. */
static enum neph_status check_one_series(const char *word, char *const *paths, int count,
                                         struct neph_diag *diag)
{
    bool has_series = false, has_other = false;
    int other = 0;
    for (int i = 1; i < count; i++) {
        const bool is_next = is_same_series(paths[i - 1], paths[i]);
        has_series |= is_next;
        if (!is_next && !has_other)
            other = i;
        has_other |= !is_next;
    }
    if (!has_series || !has_other)
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_INPUT, "'%s' holds more than one sequence: '%s' and '%s'", word,
              paths[0], paths[other]);
    neph_hint(diag, "name one of them by a pattern such as frame.%%04d.exr");
    return NEPH_ERR_INPUT;
}

static enum neph_status expand(const char *word, struct neph_sequence *list, struct neph_diag *diag)
{
    const int before = list->count;
    if (neph_path_exists(word) && !neph_path_is_dir(word))
        return append(list, strdup(word), diag);
    enum neph_status status;
    if (neph_path_is_dir(word))
        status = expand_folder(word, list, diag);
    else if (strchr(word, '%'))
        status = expand_pattern(word, list, diag);
    else if (strpbrk(word, "*?["))
        status = expand_glob(word, list, diag);
    else
        status = neph_fail(diag, NEPH_ERR_NOT_FOUND, "there is no file '%s'", word);
    if (status)
        return status;
    sort(list->paths + before, list->count - before);
    return check_one_series(word, list->paths + before, list->count - before, diag);
}

static enum neph_status check_formats(const struct neph_sequence *list, struct neph_diag *diag)
{
    const char *first = list->paths[0];
    for (int i = 1; i < list->count; i++) {
        const char *path = list->paths[i];
        if (strcasecmp(first + extension_start(first), path + extension_start(path)) != 0)
            return neph_fail(diag, NEPH_ERR_INPUT,
                             "the files are of different kinds: '%s' and '%s'", first, path);
    }
    return NEPH_OK;
}

/* Two neighbours of the sorted list. */
static enum neph_status check_step(const char *path, const char *next, struct neph_diag *diag)
{
    const struct parts a = cut(path), b = cut(next);
    if (compare_series(&a, &b) != 0)
        return NEPH_OK;
    if (strcmp(path, next) == 0)
        return neph_fail(diag, NEPH_ERR_INPUT, "'%s' is there twice", path);
    if (a.number == b.number)
        return neph_fail(diag, NEPH_ERR_INPUT, "'%s' and '%s' have the same frame number", path,
                         next);
    if (b.number == a.number + 1)
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_INPUT, "frame '%.*s%0*lld%s' is missing (%lld from %lld to %lld)",
              (int)a.head, path, (int)(a.tail - a.head), a.number + 1, path + a.tail,
              b.number - a.number - 1, a.number + 1, b.number - 1);
    neph_hint(diag, "a sequence has no gaps: render what is missing, or number the files anew");
    return NEPH_ERR_INPUT;
}

static enum neph_status check_numbers(struct neph_sequence *list, struct neph_diag *diag)
{
    char **sorted = malloc((size_t)list->count * sizeof(*sorted));
    if (!sorted)
        return neph_fail_memory(diag);
    memcpy(sorted, list->paths, (size_t)list->count * sizeof(*sorted));
    sort(sorted, list->count);
    enum neph_status status = NEPH_OK;
    for (int i = 1; i < list->count && !status; i++)
        status = check_step(sorted[i - 1], sorted[i], diag);
    if (!status && is_same_series(sorted[0], sorted[list->count - 1]))
        memcpy(list->paths, sorted, (size_t)list->count * sizeof(*sorted));
    free(sorted);
    return status;
}

enum neph_status neph_sequence_find(int word_count, const char *const *words,
                                    struct neph_sequence *sequence, struct neph_diag *diag)
{
    struct neph_sequence list = {0};
    enum neph_status status = NEPH_OK;
    if (word_count < 1)
        status = neph_fail(diag, NEPH_ERR_USAGE, "no frames are named");
    for (int i = 0; i < word_count && !status; i++)
        status = expand(words[i], &list, diag);
    if (!status)
        status = check_formats(&list, diag);
    if (!status)
        status = check_numbers(&list, diag);
    if (status)
        neph_sequence_finish(&list);
    else
        *sequence = list;
    return status;
}

/* ---- whose operands -------------------------------------------------------------------------- */

static bool is_file(const char *word)
{
    return neph_path_exists(word) && !neph_path_is_dir(word);
}

static bool belongs_to(const char *operand, int reference_count, const char *const *references)
{
    for (int i = 0; i < reference_count; i++)
        if (is_file(references[i]) && is_same_series(references[i], operand))
            return true;
    return false;
}

static enum neph_status fail_split(struct neph_diag *diag)
{
    neph_hint(diag, "put quotes around patterns: --reference 'ref/*.exr' 'test/*.exr'");
    return NEPH_ERR_USAGE;
}

enum neph_status neph_sequence_split(int reference_count, const char *const *references,
                                     int operand_count, const char *const *operands,
                                     bool *is_reference, struct neph_diag *diag)
{
    const char *test = NULL;
    for (int i = 0; i < operand_count; i++) {
        is_reference[i] = is_file(operands[i]) &&
                          belongs_to(operands[i], reference_count, references);
        if (is_reference[i])
            continue;
        if (test && !(is_file(operands[i]) && is_same_series(test, operands[i]))) {
            neph_fail(diag, NEPH_ERR_USAGE,
                      "the frames to be tested are of more than one sequence: '%s' and '%s'", test,
                      operands[i]);
            return fail_split(diag);
        }
        test = operands[i];
    }
    if (test)
        return NEPH_OK;
    if (operand_count == 0)
        neph_fail(diag, NEPH_ERR_USAGE, "no frames to be tested are named");
    else
        neph_fail(diag, NEPH_ERR_USAGE,
                  "no frames are left to be tested: '%s' and all behind it look like frames of "
                  "the reference",
                  operands[0]);
    return fail_split(diag);
}
