/* SPDX-License-Identifier: MIT */
#include "harness/compare/frame_number.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

/* ---- names ----------------------------------------------------------------------------------- */

/* A run of digits in a path, before the extension, in a folder's name too: path[head, tail). Paths
 * are cut anew whenever they are compared: it is cheap, and nothing has to be kept beside them. */
struct run {
    size_t head, tail;
};

enum { DIGITS_MAX = 18 }; /* more do not fit a long long, and are no frame number */

size_t neph_frame_name_start(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? (size_t)(slash - path) + 1 : 0;
}

/* The last dot of the name, or its end; a name that starts with its only dot has no extension, and
 * digits alone are none. */
size_t neph_frame_extension_start(const char *path)
{
    const size_t start = neph_frame_name_start(path);
    const char *dot = strrchr(path + start, '.');
    const bool is_extension = dot && dot > path + start && !isdigit((unsigned char)dot[1]);
    return is_extension ? (size_t)(dot - path) : strlen(path);
}

/* The first run from path[from] on; false when there is none before path[end]. */
static bool next_run(const char *path, size_t from, size_t end, struct run *run)
{
    while (from < end) {
        size_t tail = from;
        while (tail < end && isdigit((unsigned char)path[tail]))
            tail++;
        if (tail > from && tail - from <= DIGITS_MAX) {
            *run = (struct run){from, tail};
            return true;
        }
        from = tail > from ? tail : from + 1;
    }
    return false;
}

/* The run of that index, counted from the left; false when there are not as many. */
static bool find_run(const char *path, int index, struct run *run)
{
    const size_t end = neph_frame_extension_start(path);
    size_t from = 0;
    for (int i = 0; i <= index; i++) {
        if (!next_run(path, from, end, run))
            return false;
        from = run->tail;
    }
    return index >= 0;
}

int neph_frame_run_count(const char *path)
{
    int count = 0;
    struct run run;
    while (find_run(path, count, &run))
        count++;
    return count;
}

/* -1: there is no such run. */
long long neph_frame_number_at(const char *path, int index)
{
    struct run run;
    return find_run(path, index, &run) ? strtoll(path + run.head, NULL, 10) : -1;
}

static int compare_text(const char *a, size_t a_length, const char *b, size_t b_length)
{
    const int order = memcmp(a, b, a_length < b_length ? a_length : b_length);
    return order != 0 ? order : (a_length > b_length) - (a_length < b_length);
}

/* 0: the same path but for the values of its runs. */
int neph_frame_compare_shapes(const char *a, const char *b)
{
    const size_t a_end = neph_frame_extension_start(a), b_end = neph_frame_extension_start(b);
    size_t a_from = 0, b_from = 0;
    for (;;) {
        struct run of_a = {strlen(a), strlen(a)}, of_b = {strlen(b), strlen(b)};
        const bool a_has = next_run(a, a_from, a_end, &of_a);
        const bool b_has = next_run(b, b_from, b_end, &of_b);
        const int order = compare_text(a + a_from, of_a.head - a_from, b + b_from,
                                       of_b.head - b_from);
        if (order != 0 || !a_has || !b_has)
            return order != 0 ? order : (int)a_has - (int)b_has;
        a_from = of_a.tail;
        b_from = of_b.tail;
    }
}

/* Whether paths of one shape have different digits there. */
bool neph_frame_differs_at(const char *a, const char *b, int index)
{
    struct run of_a, of_b;
    return find_run(a, index, &of_a) && find_run(b, index, &of_b) &&
           compare_text(a + of_a.head, of_a.tail - of_a.head, b + of_b.head,
                        of_b.tail - of_b.head) != 0;
}

bool neph_frame_equal_but_for(const char *a, const char *b, int index)
{
    if (neph_frame_compare_shapes(a, b) != 0)
        return false;
    for (int i = neph_frame_run_count(a) - 1; i >= 0; i--)
        if (i != index && neph_frame_differs_at(a, b, i))
            return false;
    return true;
}

/* ---- series ---------------------------------------------------------------------------------- */

/* `index` points at that of a run. */
static int compare_numbers(const void *a, const void *b, void *index)
{
    const char *first = *(char *const *)a, *second = *(char *const *)b;
    const long long x = neph_frame_number_at(first, *(int *)index),
                    y = neph_frame_number_at(second, *(int *)index);
    return x != y ? (x > y) - (x < y) : strcmp(first, second);
}

static void sort_by_number(char **paths, int count, int index)
{
    qsort_r(paths, (size_t)count, sizeof(*paths), compare_numbers, &index);
}

static bool changes_at(char *const *paths, int count, int index)
{
    for (int i = 1; i < count; i++)
        if (neph_frame_differs_at(paths[0], paths[i], index))
            return true;
    return false;
}

/* Sorts them by it. */
static bool counts_up_at(char **paths, int count, int index)
{
    sort_by_number(paths, count, index);
    for (int i = 1; i < count; i++)
        if (neph_frame_number_at(paths[i], index) != neph_frame_number_at(paths[i - 1], index) + 1)
            return false;
    return true;
}

static enum neph_status fail_ambiguous(char *const *paths, int count, int one, int other,
                                       struct neph_diag *diag)
{
    int unlike = 1; /* a file that shows it */
    while (unlike + 1 < count && !(neph_frame_differs_at(paths[0], paths[unlike], one) &&
                                   neph_frame_differs_at(paths[0], paths[unlike], other)))
        unlike++;
    struct run first = {0, 0}, second = {0, 0};
    find_run(paths[0], one, &first);
    find_run(paths[0], other, &second);
    neph_fail(diag, NEPH_ERR_INPUT,
              "which number of '%s' is that of the frame, '%.*s' or '%.*s'? Both change: '%s'",
              paths[0], (int)(first.tail - first.head), paths[0] + first.head,
              (int)(second.tail - second.head), paths[0] + second.head, paths[unlike]);
    neph_hint(diag, "name one sequence by a pattern that has %%d in place of its frame number");
    return NEPH_ERR_INPUT;
}

/* Which run of files of one shape is their frame number: the one that changes. When several do, the
 * one that counts up by one and has each value once. NEPH_FRAME_NO_RUN: none changes. */
static enum neph_status find_frame_run(char **paths, int count, int *found, struct neph_diag *diag)
{
    int changing_count = 0, counting_count = 0,
        changing[2] = {NEPH_FRAME_NO_RUN, NEPH_FRAME_NO_RUN}, counting = NEPH_FRAME_NO_RUN;
    for (int i = neph_frame_run_count(paths[0]) - 1; i >= 0; i--) {
        if (!changes_at(paths, count, i))
            continue;
        changing[changing_count++ > 0] = i;
        if (counts_up_at(paths, count, i)) {
            counting = i;
            counting_count++;
        }
    }
    if (changing_count > 1 && counting_count != 1)
        return fail_ambiguous(paths, count, changing[1], changing[0], diag);
    *found = changing_count > 1 ? counting : changing[0];
    return NEPH_OK;
}

/* Two neighbours of a sorted series. */
static enum neph_status check_step(const char *path, const char *next, int index,
                                   struct neph_diag *diag)
{
    if (strcmp(path, next) == 0)
        return neph_fail(diag, NEPH_ERR_INPUT, "'%s' is there twice", path);
    const long long number = neph_frame_number_at(path, index),
                    number_of_next = neph_frame_number_at(next, index);
    if (number == number_of_next)
        return neph_fail(diag, NEPH_ERR_INPUT, "'%s' and '%s' have the same frame number", path,
                         next);
    if (number_of_next == number + 1)
        return NEPH_OK;
    struct run run = {0, 0};
    find_run(path, index, &run);
    neph_fail(diag, NEPH_ERR_INPUT, "frame '%.*s%0*lld%s' is missing (%lld from %lld to %lld)",
              (int)run.head, path, (int)(run.tail - run.head), number + 1, path + run.tail,
              number_of_next - number - 1, number + 1, number_of_next - 1);
    neph_hint(diag, "a sequence has no gaps: render what is missing, or number the files anew");
    return NEPH_ERR_INPUT;
}

/* Put files of one shape in the order of their frame numbers, and look at these. */
enum neph_status neph_frame_arrange(char **paths, int count, int *index, struct neph_diag *diag)
{
    enum neph_status status = find_frame_run(paths, count, index, diag);
    if (!status)
        sort_by_number(paths, count, *index);
    for (int i = 1; i < count && !status; i++)
        status = check_step(paths[i - 1], paths[i], *index, diag);
    return status;
}
