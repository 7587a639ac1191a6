/* SPDX-License-Identifier: MIT
 *
 * The I3RC suite as text, CSV and JSON.
 */
#include "harness/physics/i3rc.h"
#include "harness/physics/i3rc_files.h"

#include "base/doubt.h"

#include <math.h>
#include <stdio.h>

/* A row of the tables; NaN: no number. */
struct line {
    double optical_depth, paths, seconds, balance;
    double mean, error, doubt, doubtful_columns;
    double consensus, consensus_error, difference;
    double rms[NEPH_I3RC_STAGES], noise, constant, constant_low, constant_high, fall;
    double correlation[2], correlation_error[2];
    double worst_x, worst_z, worst, worst_error, worst_consensus, worst_score, worst_p;
};

static const struct line no_numbers = {.balance = NAN,
                                       .optical_depth = NAN,
                                       .paths = NAN,
                                       .seconds = NAN,
                                       .mean = NAN,
                                       .error = NAN,
                                       .doubt = NAN,
                                       .doubtful_columns = NAN,
                                       .consensus = NAN,
                                       .consensus_error = NAN,
                                       .difference = NAN,
                                       .rms = {NAN, NAN, NAN},
                                       .noise = NAN,
                                       .constant = NAN,
                                       .constant_low = NAN,
                                       .constant_high = NAN,
                                       .fall = NAN,
                                       .correlation = {NAN, NAN},
                                       .correlation_error = {NAN, NAN},
                                       .worst_x = NAN,
                                       .worst_z = NAN,
                                       .worst = NAN,
                                       .worst_error = NAN,
                                       .worst_consensus = NAN,
                                       .worst_score = NAN,
                                       .worst_p = NAN};

#define LINE(member) offsetof(struct line, member)

static const struct neph_field mean_fields[] = {
    {{"mean", "mean", "%.5f", .width = 9}, LINE(mean)},
    {{"standard_error", "+-", "%.5f", .width = 8}, LINE(error)},
    {{"consensus", "consensus", "%.5f", .width = 9}, LINE(consensus)},
    {{"consensus_error", "+-", "%.5f", .width = 8}, LINE(consensus_error)},
    {{"difference", "percent", "%+.3f", 100.0, .width = 8}, LINE(difference)},
};
static const struct neph_field column_fields[] = {
    {{"rms_16th", "rms N/16", "%.4f", .width = 8}, LINE(rms[0])},
    {{"rms_4th", "N/4", "%.4f", .width = 7}, LINE(rms[1])},
    {{"rms", "N", "%.4f", .width = 7}, LINE(rms[2])},
    {{"noise", "noise", "%.4f", .width = 7}, LINE(noise)},
    {{"doubtful_columns", "doubtful", "%.0f", .width = 7}, LINE(doubtful_columns)},
    {{"constant", "constant", "%.4f", .none = "none", .width = 8}, LINE(constant)},
    {{"constant_low", "from", "%.4f", .width = 7}, LINE(constant_low)},
    {{"constant_high", "to", "%.4f", .width = 7}, LINE(constant_high)},
    {{"fall", "fall", "%+.1f", .width = 5}, LINE(fall)},
    {{"correlation_x", "corr. x", "%+.3f", .width = 8}, LINE(correlation[0])},
    {{"correlation_x_error", "+-", "%.3f", .width = 6}, LINE(correlation_error[0])},
    {{"correlation_z", "z", "%+.3f", .width = 7}, LINE(correlation[1])},
    {{"correlation_z_error", "+-", "%.3f", .width = 6}, LINE(correlation_error[1])},
    {{"worst_x", "worst x", "%.0f", .width = 7}, LINE(worst_x)},
    {{"worst_z", "z", "%.0f", .width = 4}, LINE(worst_z)},
    {{"worst", "there", "%.4f", .width = 7}, LINE(worst)},
    {{"worst_error", "+-", "%.4f", .width = 7}, LINE(worst_error)},
    {{"worst_consensus", "consensus", "%.4f", .width = 9}, LINE(worst_consensus)},
    {{"worst_score", "score", "%+.1f", .width = 6}, LINE(worst_score)},
    {{"worst_p", "p", "%.1g", .width = 6}, LINE(worst_p)},
};
static const struct neph_field more_fields[] = {
    {{.key = "optical_depth"}, LINE(optical_depth)},
    {{.key = "consensus_balance"}, LINE(balance)},
    {{.key = "paths"}, LINE(paths)},
    {{.key = "seconds"}, LINE(seconds)},
    {{.key = "doubt"}, LINE(doubt)},
};
#define COUNT_OF(table) ((int)(sizeof(table) / sizeof((table)[0])))

static struct line make_line(const struct neph_i3rc_row *row, int quantity)
{
    const struct neph_i3rc_number *number = &row->numbers[quantity];
    const struct neph_i3rc_columns *columns = &number->columns;
    struct line line = no_numbers;
    if (row->missing)
        return line;
    line.optical_depth = row->optical_depth;
    line.balance = row->consensus_balance;
    line.paths = row->paths;
    line.seconds = row->wall_s;
    line.mean = number->ours.mean;
    line.error = number->ours.standard_error;
    line.doubt = number->ours.doubt;
    line.doubtful_columns = number->doubtful_columns;
    if (!number->has_consensus)
        return line;
    line.consensus = number->consensus;
    line.consensus_error = number->consensus_error;
    line.difference = line.mean / line.consensus - 1.0;
    for (int s = 0; s < NEPH_I3RC_STAGES; s++)
        line.rms[s] = columns->rms[s];
    line.noise = columns->noise;
    line.constant = columns->constant;
    line.constant_low = columns->constant_low;
    line.constant_high = columns->constant_high;
    line.fall = columns->fall;
    for (int along = 0; along < 2; along++) {
        line.correlation[along] = columns->correlation[along];
        line.correlation_error[along] = columns->correlation_error[along];
    }
    line.worst_x = columns->worst_x;
    line.worst_z = columns->worst_z;
    line.worst = columns->worst;
    line.worst_error = columns->worst_error;
    line.worst_consensus = columns->worst_consensus;
    line.worst_score = columns->worst_score;
    line.worst_p = columns->worst_p;
    return line;
}

static const char *verdict_word(const struct neph_i3rc_row *row,
                                const struct neph_i3rc_number *number)
{
    if (row->missing)
        return row->missing;
    if (!number->has_consensus)
        return "no consensus here";
    return number->agrees ? "agrees" : "DIFFERS";
}

/* "case 2, 5" and the quantity. */
static void fill_names(const struct neph_i3rc_row *row, const char *quantity,
                       struct neph_table *table)
{
    char name[32];
    snprintf(name, sizeof(name), "case%d_exp%d", row->experiment->case_number,
             row->experiment->number);
    neph_table_word(table, name);
    neph_table_word(table, quantity);
}

static void add_names(struct neph_table *table)
{
    static const struct neph_column names[] = {{"experiment", "experiment", NULL, .width = -10},
                                               {"quantity", "", NULL, .width = -3}};
    neph_table_columns(table, names, COUNT_OF(names));
}

void neph_i3rc_fill_table(const struct neph_i3rc *suite, struct neph_table *table)
{
    static const struct neph_column verdict = {.key = "verdict", .title = "verdict"};
    add_names(table);
    neph_table_column(table, verdict);
    neph_table_fields(table, mean_fields, COUNT_OF(mean_fields));
    neph_table_fields(table, column_fields, COUNT_OF(column_fields));
    neph_table_fields(table, more_fields, COUNT_OF(more_fields));
    for (int r = 0; r < suite->row_count; r++)
        for (int q = 0; q < NEPH_I3RC_QUANTITIES; q++) {
            const struct neph_i3rc_row *row = &suite->rows[r];
            const struct line line = make_line(row, q);
            fill_names(row, neph_i3rc_quantities[q].name, table);
            neph_table_word(table, verdict_word(row, &row->numbers[q]));
            neph_table_field_cells(table, mean_fields, COUNT_OF(mean_fields), &line);
            neph_table_field_cells(table, column_fields, COUNT_OF(column_fields), &line);
            neph_table_field_cells(table, more_fields, COUNT_OF(more_fields), &line);
        }
}

static void print_means(const struct neph_i3rc *suite, FILE *out)
{
    static const struct neph_column verdict = {.title = " verdict"};
    struct neph_table table = {.columns = NULL};
    add_names(&table);
    neph_table_fields(&table, mean_fields, COUNT_OF(mean_fields));
    neph_table_column(&table, verdict);
    for (int r = 0; r < suite->row_count; r++) {
        const struct neph_i3rc_row *row = &suite->rows[r];
        for (int q = 0; q < (row->missing ? 1 : NEPH_I3RC_QUANTITIES); q++) {
            const struct line line = make_line(row, q);
            fill_names(row, row->missing ? "" : neph_i3rc_quantities[q].name, &table);
            neph_table_field_cells(&table, mean_fields, COUNT_OF(mean_fields), &line);
            neph_table_word(&table, "");
            neph_table_shown(&table, " %s%s", verdict_word(row, &row->numbers[q]),
                             row->numbers[q].has_consensus &&
                                     row->numbers[q].ours.doubt > NEPH_DOUBTFUL
                                 ? ", our error bar is not to be trusted"
                                 : "");
        }
    }
    fputs("means over the domain, parts of the sunlight on a level plane:\n", out);
    neph_table_print_aligned(&table, out);
    neph_table_finish(&table);
}

static void print_columns(const struct neph_i3rc *suite, FILE *out)
{
    struct neph_table table = {.columns = NULL};
    add_names(&table);
    neph_table_fields(&table, column_fields, COUNT_OF(column_fields));
    for (int r = 0; r < suite->row_count; r++)
        for (int q = 0; q < NEPH_I3RC_QUANTITIES; q++)
            if (suite->rows[r].numbers[q].has_consensus) {
                const struct line line = make_line(&suite->rows[r], q);
                fill_names(&suite->rows[r], neph_i3rc_quantities[q].name, &table);
                neph_table_field_cells(&table, column_fields, COUNT_OF(column_fields), &line);
            }
    fputs(
        "\ncolumns against the consensus: rms difference with N/16, N/4 and N paths, our noise in "
        "the last, its\ncolumns with a doubtful error bar, the constant without noise and its 95 "
        "% interval, how many standard\nerrors the fall is off from it, correlation of "
        "neighbours, the column that differs most, its score in\nstandard errors of both, and "
        "the probability of such a column by chance:\n",
        out);
    neph_table_print_aligned(&table, out);
    neph_table_finish(&table);
    for (int r = 0; r < suite->row_count; r++)
        if (!suite->rows[r].missing && isfinite(suite->rows[r].consensus_balance))
            fprintf(out, "case%d_exp%d: the light of the consensus adds up to %.4f\n",
                    suite->rows[r].experiment->case_number, suite->rows[r].experiment->number,
                    suite->rows[r].consensus_balance);
}

void neph_i3rc_print(const struct neph_i3rc *suite, FILE *out)
{
    bool is_missing = false;
    print_means(suite, out);
    if (suite->compared > 0)
        print_columns(suite, out);
    for (int r = 0; r < suite->row_count; r++)
        is_missing |= suite->rows[r].missing != NULL;
    if (is_missing)
        fprintf(out, "\n%s names the folder of the files; %s\n", NEPH_I3RC_VARIABLE,
                neph_i3rc_address);
    fprintf(out, "verdict: %d of %d means agree with the consensus\n",
            suite->compared - suite->failed, suite->compared);
}
