/* SPDX-License-Identifier: MIT
 *
 * The rule that names the engine that differs from all others, over all outcomes of pairs of three
 * and four engines.
 */
#include "tests/neph_test.h"

#include "harness/report/attribution.h"
#include "metrics/pair.h"

static const char *const names[4] = {"a", "b", "c", "d"};

/* Pairs in the order ab ac bc (ad bd cd). */
static int find_odd_engine(int count, const char *pairs, char sentence[400])
{
    static const int at[6][2] = {{0, 1}, {0, 2}, {1, 2}, {0, 3}, {1, 3}, {2, 3}};
    int verdicts[16] = {0};
    for (int k = 0; pairs[k]; k++) {
        const int verdict = pairs[k] == '='   ? NEPH_PAIR_AGREE
                            : pairs[k] == '!' ? NEPH_PAIR_DIFFER
                                              : NEPH_PAIR_CANNOT_TELL;
        verdicts[at[k][0] * count + at[k][1]] = verdicts[at[k][1] * count + at[k][0]] = verdict;
    }
    return neph_odd_one_out(names, count, verdicts, sentence);
}

static void test_rule(void **state)
{
    static const struct {
        int count;
        const char *pairs;
        int odd;
        const char *says;
    } rows[] = {
        {3, "===", -1, "all agree"},
        {3, "==?", -1, "cannot tell"},
        {3, "!!=", 0, "a is the odd one out"},
        {3, "!=!", 1, "b is the odd one out"},
        {3, "=!!", 2, "c is the odd one out"},
        {3, "!!?", 0, "beyond noise"},
        {3, "!!!", -1, "more than one"},
        {3, "!==", -1, "more than one"}, /* not transitive: a and b differ, c agrees with both */
        {3, "!=?", -1, "cannot tell"},
        {4, "===!!!", 3, "d is the odd one out"},
        {4, "!!!===", -1, "more than one"},
        {4, "=====!", -1, "more than one"},
    };
    for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
        char sentence[400];
        const int odd = find_odd_engine(rows[i].count, rows[i].pairs, sentence);
        if (odd != rows[i].odd || !strstr(sentence, rows[i].says))
            fail_msg("%s: odd %d, expected %d: '%s'", rows[i].pairs, odd, rows[i].odd, sentence);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_rule)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
