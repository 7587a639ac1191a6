/* SPDX-License-Identifier: MIT
 *
 * The table of extractors in docs/metrics.md, which this test prints from the registry.
 */
#include "tests/printed_table.h"

#include "metrics/extractors/extractors.h"
#include "metrics/metric.h"

/* Metric names in a row; `neph metrics NAME` lists all. */
enum { NAMES_MAX = 6 };

static void print_names(FILE *file, const struct neph_extractor *extractor)
{
    int count = 0;
    for (const struct neph_metric *metric = extractor->metrics; metric->name; metric++, count++)
        if (count < NAMES_MAX)
            fprintf(file, "%s`%s`", count ? ", " : "", metric->name);
    if (count > NAMES_MAX)
        fprintf(file, " and %d more", count - NAMES_MAX);
}

static void print_quantities(FILE *file, const struct neph_extractor *extractor)
{
    const char *separator = "";
    for (int q = 0; q < neph_quantity_count(); q++)
        if (extractor->quantities & (unsigned)neph_quantity_at(q)->bit) {
            fprintf(file, "%s%s", separator, neph_quantity_at(q)->name);
            separator = ", ";
        }
}

static void print_extractors(FILE *file)
{
    fprintf(file, "| extractor | what it measures | quantities | metrics |\n"
                  "| --- | --- | --- | --- |\n");
    for (int i = 0; i < neph_extractor_count(); i++) {
        const struct neph_extractor *extractor = neph_extractor_at(i);
        fprintf(file, "| `%s`%s%s | %s | ", extractor->name,
                extractor->temporal ? ", sequences" : "", extractor->costly ? ", by name only" : "",
                extractor->help);
        print_quantities(file, extractor);
        fprintf(file, " | ");
        print_names(file, extractor);
        fprintf(file, " |\n");
    }
}

static void test_docs_have_the_extractors(void **state)
{
    const struct printed_table table = {NEPH_SOURCE_DIR "/docs/metrics.md",
                                        "<!-- written by tests/test_metric_table --write -->\n",
                                        "<!-- end -->\n", print_extractors};
    check_readme(&table, *state);
}

int main(int count, char **arguments)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_prestate(test_docs_have_the_extractors, writes_readme(count, arguments)),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
