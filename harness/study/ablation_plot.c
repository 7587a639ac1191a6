/* SPDX-License-Identifier: MIT
 *
 * The chart of an ablation, as wide as a page: a row for each part, a column for each measure, and
 * in each cell the change that the part makes. Shades of grey distinguish the bars.
 */
#include "harness/study/ablation.h"

#include "harness/study/svg.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Fails to compile when a kind is added, as draw_bar() needs a fill for it. */
_Static_assert(NEPH_ABLATION_PLACES == 2, "a new kind");

enum { WIDTH = 1000, LEFT = 130, GAP = 10, ROW = 22, BAR = 7, LINE = 17, MARGIN = 12, HEAD = 80 };

/* A bar longer than an axis of this many decades is cut and has its number beside it: an axis of a
 * whole decade would hide changes of a tenth. */
static const double most_decades = 0.5, least_decades = 0.03;

/* Mean width of a letter of the font at 12 px. */
static const double letter_px = 6.6;

struct chart {
    const struct neph_ablation *ablation;
    int measures[NEPH_ABLATION_MEASURES_MAX], measure_count;
    int rows[NEPH_ABLATION_PARTS_MAX], row_count;                  /* parts that change a measure */
    int unchanged_parts[NEPH_ABLATION_PARTS_MAX], unchanged_count; /* the other parts */
    double top_px;                                                 /* of the first row */
};

struct column {
    const struct chart *chart;
    int measure;
    double low, high; /* of the axis, decades */
    double left_px, right_px;
};

static const struct neph_ablation_effect *find_effect(const struct neph_ablation *ablation,
                                                      int measure, int part, int place)
{
    const struct neph_ablation_comparison *found = neph_ablation_find(
        ablation, part, (enum neph_ablation_place)place);
    return found && !isnan(found->effects[measure].mean) ? &found->effects[measure] : NULL;
}

/* Whether a cell needs no bar: the change is below 5 %, or it is a time whose change is not
 * certain. */
static bool has_no_row(int measure, const struct neph_ablation_effect *effect)
{
    const bool is_small = effect && fabs(effect->mean) < NEPH_ABLATION_NOTHING_DECADES;
    return !effect || effect->verdict == NEPH_ABLATION_SAME ||
           effect->verdict == NEPH_ABLATION_NOTHING ||
           (effect->verdict == NEPH_ABLATION_UNDECIDED &&
            (is_small || neph_ablation_measures[measure].is_time));
}

static bool is_drawn(const struct chart *chart, int part)
{
    for (int m = 0; m < chart->measure_count; m++)
        for (int place = 0; place < NEPH_ABLATION_PLACES; place++)
            if (!has_no_row(chart->measures[m],
                            find_effect(chart->ablation, chart->measures[m], part, place)))
                return true;
    return false;
}

/* The largest change by a part in the preset, in decades, over all measures except times. */
static double largest_change(const struct chart *chart, int part)
{
    double largest = 0.0;
    for (int m = 0; m < chart->measure_count; m++) {
        const int measure = chart->measures[m];
        const struct neph_ablation_effect *effect = find_effect(chart->ablation, measure, part,
                                                                NEPH_ABLATION_IN_PRESET);
        if (!neph_ablation_measures[measure].is_time && !has_no_row(measure, effect))
            largest = fmax(largest, fabs(effect->mean));
    }
    return largest;
}

static void sort_parts(struct chart *chart)
{
    for (int part = 0; neph_ablation_parts[part].name; part++) {
        if ((chart->ablation->asked >> part & 1) == 0)
            continue;
        if (!is_drawn(chart, part)) {
            chart->unchanged_parts[chart->unchanged_count++] = part;
            continue;
        }
        const double change = largest_change(chart, part);
        int place = chart->row_count++;
        for (; place > 0 && largest_change(chart, chart->rows[place - 1]) < change; place--)
            chart->rows[place] = chart->rows[place - 1];
        chart->rows[place] = part;
    }
}

static const struct neph_ablation_effect *cell(const struct column *column, int row, int place)
{
    const struct chart *chart = column->chart;
    return find_effect(chart->ablation, column->measure, chart->rows[row], place);
}

/* The axis covers all means, and of each interval at most 1.6 times the largest mean. */
static void fit_axis(struct column *column)
{
    double low = -least_decades, high = least_decades;
    for (int pass = 0; pass < 2; pass++) {
        const double most = pass ? 1.6 * fmax(-low, high) : 0.0;
        for (int i = 0; i < column->chart->row_count * NEPH_ABLATION_PLACES; i++) {
            const struct neph_ablation_effect *effect = cell(column, i / NEPH_ABLATION_PLACES,
                                                             i % NEPH_ABLATION_PLACES);
            if (has_no_row(column->measure, effect))
                continue;
            const bool has_interval = pass && effect->has_interval;
            low = fmin(low, has_interval ? fmax(effect->low, -most) : effect->mean);
            high = fmax(high, has_interval ? fmin(effect->high, most) : effect->mean);
        }
    }
    column->low = 1.08 * fmax(low, -most_decades);
    column->high = 1.08 * fmin(high, most_decades);
}

static double at_px(const struct column *column, double decades)
{
    const double part = (fmin(fmax(decades, column->low), column->high) - column->low) /
                        (column->high - column->low);
    return column->left_px + part * (column->right_px - column->left_px);
}

/* ---- drawing --------------------------------------------------------------------------------- */

/* Round changes, in order of preference. A tick is left out where it would meet another. */
static void draw_ticks(const struct column *column, FILE *out)
{
    static const double ratios[] = {1.0, 2.0, 0.5, 1.2, 0.8, 1.1,  0.9,  3.0,  0.3,
                                    1.5, 0.7, 0.6, 2.5, 0.4, 1.05, 0.95, 1.02, 0.98};
    enum { RATIOS = sizeof(ratios) / sizeof(ratios[0]), APART_PX = 27, EDGE_PX = 10 };
    const double top_px = column->chart->top_px,
                 bottom_px = top_px + ROW * column->chart->row_count;
    double taken[RATIOS];
    int count = 0;
    for (int i = 0; i < RATIOS; i++) {
        const double decades = log10(ratios[i]), px = at_px(column, decades);
        bool is_free = px > column->left_px + EDGE_PX && px < column->right_px - EDGE_PX;
        for (int t = 0; t < count; t++)
            is_free = is_free && fabs(px - taken[t]) >= APART_PX;
        if (!is_free && i > 0)
            continue;
        taken[count++] = px;
        char change[NEPH_ABLATION_CHANGE_SIZE];
        if (ratios[i] >= 2.0)
            snprintf(change, sizeof(change), "x%g", ratios[i]);
        else
            snprintf(change, sizeof(change), i == 0 ? "0" : "%+.0f %%", 100.0 * (ratios[i] - 1.0));
        fprintf(out,
                "<path d=\"M%.1f %.1f V%.1f\" stroke=\"%s\"/><text x=\"%.1f\" y=\"%.1f\" "
                "text-anchor=\"middle\" font-size=\"10\">%s</text>\n",
                px, top_px, bottom_px, i == 0 ? "#000" : "#ccc", px, top_px - 5.0, change);
    }
}

/* The number of a bar that the axis cuts, beside that bar. */
static void draw_number(const struct column *column, double mean, double y_px, FILE *out)
{
    char change[NEPH_ABLATION_CHANGE_SIZE];
    if (mean >= column->low && mean <= column->high)
        return;
    neph_ablation_change(mean, change);
    const bool is_up = mean > 0.0;
    fprintf(out,
            "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\" font-size=\"10\" stroke=\"#fff\" "
            "stroke-width=\"3\" paint-order=\"stroke\">",
            at_px(column, mean) + (is_up ? -4.0 : 4.0), y_px + BAR + 1.0, is_up ? "end" : "start");
    neph_svg_print_escaped(change, out);
    fprintf(out, "</text>\n");
}

/* An end beyond the axis has no mark. */
static void draw_interval(const struct column *column, const struct neph_ablation_effect *effect,
                          double y_px, FILE *out)
{
    const double ends[] = {effect->low, effect->high};
    fprintf(out, "<path d=\"M%.1f %.1f H%.1f\" stroke=\"#000\" stroke-width=\"1.2\"/>",
            at_px(column, effect->low), y_px + 0.5 * BAR, at_px(column, effect->high));
    for (int i = 0; i < 2; i++)
        if (ends[i] > column->low && ends[i] < column->high)
            fprintf(out, "<path d=\"M%.1f %.1f v5\" stroke=\"#000\" stroke-width=\"1.2\"/>",
                    at_px(column, ends[i]), y_px + 0.5 * BAR - 2.5);
}

static void draw_bar(const struct column *column, const struct neph_ablation_effect *effect,
                     int place, double y_px, FILE *out)
{
    static const char *const fills[NEPH_ABLATION_PLACES] = {"#888", "#fff"};
    if (has_no_row(column->measure, effect))
        return;
    const double zero_px = at_px(column, 0.0), end_px = at_px(column, effect->mean);
    fprintf(out,
            "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%d\" fill=\"%s\" "
            "stroke=\"#444\"/>",
            fmin(zero_px, end_px), y_px, fabs(end_px - zero_px), BAR, fills[place]);
    if (effect->has_interval)
        draw_interval(column, effect, y_px, out);
    fprintf(out, "\n");
    draw_number(column, effect->mean, y_px, out);
}

/* Breaks a text into lines of a width, in the font size of the enclosing element. Returns the foot
 * of the last line. */
static double draw_words(const char *text, double x_px, double width_px, double y_px, FILE *out)
{
    const double most = width_px / letter_px;
    double used = 0.0;
    bool is_open = false;
    while (*text) {
        const int length = (int)strcspn(text, " ");
        if (!is_open || used + length > most) {
            fprintf(out, "%s<text x=\"%.1f\" y=\"%.1f\">", is_open ? "</text>\n" : "", x_px, y_px);
            y_px += LINE;
            used = 0.0;
            is_open = true;
        }
        used += length + 1;
        fprintf(out, "%.*s ", length, text);
        text += length + (text[length] == ' ');
    }
    fprintf(out, "%s", is_open ? "</text>\n" : "");
    return y_px;
}

static void draw_column(const struct chart *chart, int number, FILE *out)
{
    const double width_px = (WIDTH - LEFT - MARGIN) / (double)chart->measure_count;
    struct column column = {.chart = chart,
                            .measure = chart->measures[number],
                            .left_px = LEFT + width_px * number + GAP,
                            .right_px = LEFT + width_px * (number + 1)};
    fit_axis(&column);
    draw_words(neph_ablation_measures[column.measure].title, column.left_px,
               column.right_px - column.left_px, chart->top_px - HEAD, out);
    draw_ticks(&column, out);
    for (int row = 0; row < chart->row_count; row++)
        for (int place = 0; place < NEPH_ABLATION_PLACES; place++)
            draw_bar(&column, cell(&column, row, place), place,
                     chart->top_px + ROW * row + 3.0 + (BAR + 1.0) * place, out);
}

static bool is_certain(const struct chart *chart, int part)
{
    for (int m = 0; m < chart->measure_count; m++) {
        const struct neph_ablation_effect *effect = find_effect(chart->ablation, chart->measures[m],
                                                                part, NEPH_ABLATION_IN_PRESET);
        if (effect &&
            (effect->verdict == NEPH_ABLATION_BUYS || effect->verdict == NEPH_ABLATION_COSTS))
            return true;
    }
    return false;
}

static void draw_names(const struct chart *chart, FILE *out)
{
    for (int row = 0; row < chart->row_count; row++) {
        const double y_px = chart->top_px + ROW * row;
        if (row % 2)
            fprintf(out, "<rect x=\"0\" y=\"%.1f\" width=\"%d\" height=\"%d\" fill=\"#f4f4f4\"/>",
                    y_px, WIDTH, ROW);
        fprintf(out, "<text x=\"%d\" y=\"%.1f\" text-anchor=\"end\"%s>%s</text>\n", LEFT - 4,
                y_px + 15.0, is_certain(chart, chart->rows[row]) ? " font-weight=\"bold\"" : "",
                neph_ablation_parts[chart->rows[row]].name);
    }
}

/* The parts without a row. Returns the foot of the last line. */
static double draw_unchanged_parts(const struct chart *chart, double y_px, FILE *out)
{
    char words[64 * NEPH_ABLATION_PARTS_MAX] = "Less than 5 % in every measure:";
    if (chart->unchanged_count == 0)
        return y_px;
    for (int i = 0; i < chart->unchanged_count; i++) {
        const size_t used = strlen(words);
        snprintf(words + used, sizeof(words) - used, " %s",
                 neph_ablation_parts[chart->unchanged_parts[i]].name);
    }
    return draw_words(words, MARGIN, WIDTH - 2 * MARGIN, y_px + LINE, out);
}

/* Title, key and conditions of the measurement. Returns the foot of the last line. */
static double draw_legend(const struct neph_ablation *ablation, FILE *out)
{
    const struct neph_flicker_study_params *params = ablation->study.params;
    fprintf(out, "<text x=\"%d\" y=\"26\" font-size=\"18\" font-weight=\"bold\">Parts of ", MARGIN);
    neph_svg_print_escaped(ablation->preset, out);
    fprintf(out,
            ": the change that each makes</text>\n"
            "<rect x=\"%d\" y=\"38\" width=\"30\" height=\"%d\" fill=\"#888\" stroke=\"#444\"/>"
            "<text x=\"%d\" y=\"46\">in the preset: with the part over without it</text>\n"
            "<rect x=\"%d\" y=\"38\" width=\"30\" height=\"%d\" fill=\"#fff\" stroke=\"#444\"/>"
            "<text x=\"%d\" y=\"46\">the part as the only one</text>\n"
            "<path d=\"M%d 42 h30\" stroke=\"#000\" stroke-width=\"1.2\"/>"
            "<text x=\"%d\" y=\"46\">95 %% interval over scenes</text>\n"
            "<text x=\"%d\" y=\"64\">A bar to the left: less, which is better. Bold: certain. No "
            "bar: less than 5 %%, or an uncertain time.</text>\n"
            "<text x=\"%d\" y=\"26\" text-anchor=\"end\">%dx%d, %d steps, %d frames, %d seed%s, %d "
            "scenes; ",
            MARGIN, BAR, MARGIN + 38, MARGIN + 350, BAR, MARGIN + 388, MARGIN + 600, MARGIN + 638,
            MARGIN, WIDTH - MARGIN, params->width_px, params->height_px, params->steps,
            params->frame_count, params->seed_count, params->seed_count == 1 ? "" : "s",
            params->scene_count);
    char device[sizeof(ablation->study.device)]; /* the tables have its driver */
    snprintf(device, sizeof(device), "%.*s", (int)strcspn(ablation->study.device, "("),
             ablation->study.device);
    neph_svg_print_escaped(device, out);
    fprintf(out, "</text>\n");
    return 64.0;
}

static bool has_numbers(const struct neph_ablation *ablation, int measure)
{
    for (int i = 0; i < ablation->comparison_count; i++)
        if (ablation->comparisons[i].effects[measure].scene_count > 0)
            return true;
    return false;
}

static double draw_chart(const struct neph_ablation *ablation, FILE *out)
{
    struct chart chart = {.ablation = ablation};
    for (int m = 0; neph_ablation_measures[m].name; m++)
        if (has_numbers(ablation, m))
            chart.measures[chart.measure_count++] = m;
    sort_parts(&chart);
    chart.top_px = draw_legend(ablation, out) + LINE + HEAD + LINE;
    draw_names(&chart, out);
    for (int i = 0; i < chart.measure_count && chart.row_count > 0; i++)
        draw_column(&chart, i, out);
    return draw_unchanged_parts(&chart, chart.top_px + ROW * chart.row_count, out) + MARGIN;
}

enum neph_status neph_ablation_plot(const struct neph_ablation *ablation, FILE *out,
                                    struct neph_diag *diag)
{
    char *body = NULL;
    size_t size;
    FILE *memory = open_memstream(&body, &size);
    if (!memory)
        return neph_fail_memory(diag);
    const double height_px = draw_chart(ablation, memory);
    const bool is_cut = ferror(memory) != 0, is_closed = fclose(memory) == 0;
    if (!is_cut && is_closed)
        fprintf(out,
                "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%.0f\" "
                "viewBox=\"0 0 %d %.0f\" font-family=\"sans-serif\" font-size=\"12\">\n"
                "<rect width=\"100%%\" height=\"100%%\" fill=\"#fff\"/>\n%s</svg>\n",
                WIDTH, height_px, WIDTH, height_px, body);
    free(body);
    return !is_cut && is_closed ? NEPH_OK : neph_fail_memory(diag);
}
