/* SPDX-License-Identifier: MIT
 *
 * Tornado charts of an ablation: a panel for each measure, the part with the largest change on top.
 * Readable on a phone and in grey: the font size is a 32nd of the width, and no information is in
 * colours only.
 */
#include "harness/study/ablation.h"

#include "harness/study/svg.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Fails to compile when a kind is added, as draw_bar() needs a fill for it. */
_Static_assert(NEPH_ABLATION_PLACES == 2, "a new kind");

enum { WIDTH = 520, LEFT = 140, RIGHT = 14, ROW = 36, BAR = 12, LINE = 21, MARGIN = 12 };

/* Longest and shortest half of an axis, in decades. Longer bars are cut and labelled, as an axis
 * over a decade would make a change of a tenth invisible. */
static const double most_decades = 0.5, least_decades = 0.03;

/* Average width of a character at a font size of 16 px. */
static const double letter_px = 8.4;

struct panel {
    const struct neph_ablation *ablation;
    int measure;
    int rows[NEPH_ABLATION_PARTS_MAX], row_count;    /* parts with a change */
    int quiet[NEPH_ABLATION_PARTS_MAX], quiet_count; /* parts without one */
    double low, high;                                /* of the axis */
    double top_px, bottom_px;                        /* of the rows */
};

static const struct neph_ablation_effect *effect_of(const struct panel *panel, int part, int place)
{
    const struct neph_ablation_comparison *of = neph_ablation_find(panel->ablation, part,
                                                                   (enum neph_ablation_place)place);
    return of && !isnan(of->effects[panel->measure].mean) ? &of->effects[panel->measure] : NULL;
}

/* Whether a part gets no row: its change is small, certain or not; for times also when it is
 * uncertain. */
static bool is_quiet(const struct panel *panel, const struct neph_ablation_effect *effect)
{
    const bool is_small = effect && fabs(effect->mean) < NEPH_ABLATION_NOTHING_DECADES;
    return !effect || effect->verdict == NEPH_ABLATION_SAME ||
           effect->verdict == NEPH_ABLATION_NOTHING ||
           (effect->verdict == NEPH_ABLATION_UNDECIDED &&
            (is_small || neph_ablation_measures[panel->measure].is_time));
}

static double size_of(const struct panel *panel, int part)
{
    const struct neph_ablation_effect *effect = effect_of(panel, part, NEPH_ABLATION_IN_PRESET);
    return effect ? fabs(effect->mean) : 0.0;
}

static void sort_parts(struct panel *panel)
{
    for (int part = 0; neph_ablation_parts[part].name; part++) {
        if ((panel->ablation->asked >> part & 1) == 0)
            continue;
        if (is_quiet(panel, effect_of(panel, part, NEPH_ABLATION_IN_PRESET)) &&
            is_quiet(panel, effect_of(panel, part, NEPH_ABLATION_ALONE))) {
            panel->quiet[panel->quiet_count++] = part;
            continue;
        }
        int place = panel->row_count++;
        for (; place > 0 && size_of(panel, panel->rows[place - 1]) < size_of(panel, part); place--)
            panel->rows[place] = panel->rows[place - 1];
        panel->rows[place] = part;
    }
}

/* Fits the axis to all means, and to intervals up to 1.6 times the largest mean. */
static void fit_axis(struct panel *panel)
{
    double low = -least_decades, high = least_decades;
    for (int pass = 0; pass < 2; pass++) {
        const double most = pass ? 1.6 * fmax(-low, high) : 0.0;
        for (int i = 0; i < panel->row_count * NEPH_ABLATION_PLACES; i++) {
            const struct neph_ablation_effect *effect = effect_of(
                panel, panel->rows[i / NEPH_ABLATION_PLACES], i % NEPH_ABLATION_PLACES);
            if (!effect)
                continue;
            low = fmin(low, pass && effect->has_interval ? fmax(effect->low, -most) : effect->mean);
            high = fmax(high,
                        pass && effect->has_interval ? fmin(effect->high, most) : effect->mean);
        }
    }
    panel->low = 1.08 * fmax(low, -most_decades);
    panel->high = 1.08 * fmin(high, most_decades);
}

static double at_px(const struct panel *panel, double decades)
{
    const double part = (fmin(fmax(decades, panel->low), panel->high) - panel->low) /
                        (panel->high - panel->low);
    return LEFT + part * (WIDTH - RIGHT - LEFT);
}

/* ---- drawing --------------------------------------------------------------------------------- */

/* Draws ticks at round changes, the most useful ones first; a tick that would overlap is left out.
 */
static void draw_ticks(const struct panel *panel, FILE *out)
{
    static const double ratios[] = {1.0, 2.0, 0.5, 1.2, 0.8, 1.1,  0.9,  3.0,  0.3,
                                    1.5, 0.7, 0.6, 2.5, 0.4, 1.05, 0.95, 1.02, 0.98};
    enum { RATIOS = sizeof(ratios) / sizeof(ratios[0]), APART_PX = 56, EDGE_PX = 20 };
    double taken[RATIOS];
    int count = 0;
    for (int i = 0; i < RATIOS; i++) {
        const double decades = log10(ratios[i]), px = at_px(panel, decades);
        bool is_free = decades > panel->low && decades < panel->high && px < WIDTH - EDGE_PX;
        for (int t = 0; t < count; t++)
            is_free = is_free && fabs(px - taken[t]) >= APART_PX;
        if (!is_free)
            continue;
        taken[count++] = px;
        char change[NEPH_ABLATION_CHANGE_SIZE];
        if (ratios[i] >= 2.0)
            snprintf(change, sizeof(change), "x%g", ratios[i]);
        else
            snprintf(change, sizeof(change), i == 0 ? "0" : "%+.0f %%", 100.0 * (ratios[i] - 1.0));
        fprintf(out,
                "<path d=\"M%.1f %.1f V%.1f\" stroke=\"%s\"/><text x=\"%.1f\" y=\"%.1f\" "
                "text-anchor=\"middle\" font-size=\"14\">%s</text>\n",
                px, panel->top_px, panel->bottom_px, i == 0 ? "#000" : "#ccc", px,
                panel->top_px - 5.0, change);
    }
}

/* Labels a bar that is cut with its number. */
static void draw_number(const struct panel *panel, double mean, double y_px, FILE *out)
{
    char change[NEPH_ABLATION_CHANGE_SIZE];
    if (mean >= panel->low && mean <= panel->high)
        return;
    neph_ablation_change(mean, change);
    const bool is_up = mean > 0.0;
    fprintf(out,
            "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\" font-size=\"13\" stroke=\"#fff\" "
            "stroke-width=\"4\" paint-order=\"stroke\">",
            at_px(panel, mean) + (is_up ? -6.0 : 6.0), y_px + BAR - 1.5, is_up ? "end" : "start");
    neph_svg_print_escaped(change, out);
    fprintf(out, "</text>\n");
}

/* Draws an interval; an end beyond the axis gets no cap. */
static void draw_interval(const struct panel *panel, const struct neph_ablation_effect *effect,
                          double y_px, FILE *out)
{
    const double ends[] = {effect->low, effect->high};
    fprintf(out, "<path d=\"M%.1f %.1f H%.1f\" stroke=\"#000\" stroke-width=\"2\"/>",
            at_px(panel, effect->low), y_px + 0.5 * BAR, at_px(panel, effect->high));
    for (int i = 0; i < 2; i++)
        if (ends[i] > panel->low && ends[i] < panel->high)
            fprintf(out, "<path d=\"M%.1f %.1f v8\" stroke=\"#000\" stroke-width=\"2\"/>",
                    at_px(panel, ends[i]), y_px + 0.5 * BAR - 4.0);
}

static void draw_bar(const struct panel *panel, const struct neph_ablation_effect *effect,
                     int place, double y_px, FILE *out)
{
    static const char *const fills[NEPH_ABLATION_PLACES] = {"#999", "#fff"};
    if (!effect)
        return;
    const double zero_px = at_px(panel, 0.0), end_px = at_px(panel, effect->mean);
    fprintf(out,
            "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%d\" fill=\"%s\" "
            "stroke=\"#444\"/>",
            fmin(zero_px, end_px), y_px, fabs(end_px - zero_px), BAR, fills[place]);
    if (effect->has_interval)
        draw_interval(panel, effect, y_px, out);
    fprintf(out, "\n");
    draw_number(panel, effect->mean, y_px, out);
}

static void draw_row(const struct panel *panel, int row, FILE *out)
{
    const int part = panel->rows[row];
    const double y_px = panel->top_px + ROW * row;
    const struct neph_ablation_effect *effect = effect_of(panel, part, NEPH_ABLATION_IN_PRESET);
    const bool is_bold = effect && (effect->verdict == NEPH_ABLATION_BUYS ||
                                    effect->verdict == NEPH_ABLATION_COSTS);
    fprintf(out, "<text x=\"%d\" y=\"%.1f\" text-anchor=\"end\"%s>", LEFT - 8, y_px + 23.0,
            is_bold ? " font-weight=\"bold\"" : "");
    neph_svg_print_escaped(neph_ablation_parts[part].name, out);
    fprintf(out, "</text>\n");
    for (int place = 0; place < NEPH_ABLATION_PLACES; place++)
        draw_bar(panel, effect_of(panel, part, place), place, y_px + 5.0 + (BAR + 2.0) * place,
                 out);
}

/* Breaks words into lines of the chart's width; returns the y of the next line. */
static double draw_words(const char *const *words, int count, double y_px, FILE *out)
{
    const double most = (WIDTH - 2 * MARGIN) / letter_px;
    double used = 0.0;
    for (int i = 0; i < count; i++) {
        const double length = (double)strlen(words[i]) + 1.0;
        if (i == 0 || used + length > most) {
            fprintf(out, "%s<text x=\"%d\" y=\"%.1f\">", i ? "</text>\n" : "", MARGIN, y_px);
            y_px += LINE;
            used = 0.0;
        }
        used += length;
        neph_svg_print_escaped(words[i], out);
        fputc(' ', out);
    }
    fprintf(out, "%s", count ? "</text>\n" : "");
    return y_px;
}

static double draw_quiet(const struct panel *panel, double y_px, FILE *out)
{
    static const char *const heads[][5] = {{"Less", "than", "5 %:"}, {"Not", "told", "from", "0:"}};
    const char *const *head = heads[neph_ablation_measures[panel->measure].is_time];
    const char *words[NEPH_ABLATION_PARTS_MAX + 5];
    int count = 0;
    if (panel->quiet_count == 0)
        return y_px;
    while (*head)
        words[count++] = *head++;
    for (int i = 0; i < panel->quiet_count; i++)
        words[count++] = neph_ablation_parts[panel->quiet[i]].name;
    return draw_words(words, count, y_px + LINE, out);
}

/* Draws a panel from `y_px` on; returns the y below it. */
static double draw_panel(const struct neph_ablation *ablation, int measure, double y_px, FILE *out)
{
    struct panel panel = {.ablation = ablation, .measure = measure};
    sort_parts(&panel);
    fit_axis(&panel);
    fprintf(out, "<text x=\"%d\" y=\"%.1f\" font-size=\"18\" font-weight=\"bold\">%s</text>\n",
            MARGIN, y_px + 20.0, neph_ablation_measures[measure].title);
    panel.top_px = panel.bottom_px = y_px + 50.0;
    if (panel.row_count == 0)
        return draw_quiet(&panel, y_px + 24.0, out) + 14.0;
    panel.bottom_px += ROW * panel.row_count;
    draw_ticks(&panel, out);
    for (int row = 0; row < panel.row_count; row++)
        draw_row(&panel, row, out);
    return draw_quiet(&panel, panel.bottom_px, out) + 14.0;
}

static double draw_legend(const struct neph_ablation *ablation, FILE *out)
{
    const struct neph_flicker_study_params *params = ablation->study.params;
    fprintf(out, "<text x=\"%d\" y=\"30\" font-size=\"20\" font-weight=\"bold\">What parts of ",
            MARGIN);
    neph_svg_print_escaped(ablation->preset, out);
    fprintf(
        out,
        " change</text>\n<rect x=\"%d\" y=\"47\" width=\"30\" height=\"%d\" fill=\"#999\" "
        "stroke=\"#444\"/><text x=\"%d\" y=\"58\">in the preset: with the part over without "
        "it</text>\n<rect x=\"%d\" y=\"69\" width=\"30\" height=\"%d\" fill=\"#fff\" "
        "stroke=\"#444\"/><text x=\"%d\" y=\"80\">alone: added to the plain pipeline</text>\n<path "
        "d=\"M%d 97 h30\" stroke=\"#000\" stroke-width=\"2\"/><text x=\"%d\" y=\"102\">95 %% "
        "interval over scenes</text>\n<text x=\"%d\" y=\"124\">Left of 0: the part lowers the "
        "measure. Bold: significant, of %d numbers.</text>\n<text x=\"%d\" y=\"146\" "
        "font-size=\"13\">%dx%d, %d steps, %d frames, %d seed%s, %d scenes; ",
        MARGIN, BAR, MARGIN + 40, MARGIN, BAR, MARGIN + 40, MARGIN, MARGIN + 40, MARGIN,
        ablation->judged_count, MARGIN, params->width_px, params->height_px, params->steps,
        params->frame_count, params->seed_count, params->seed_count == 1 ? "" : "s",
        params->scene_count);
    char device[sizeof(ablation->study.device)]; /* without the driver, which the tables have */
    snprintf(device, sizeof(device), "%.*s", (int)strcspn(ablation->study.device, "("),
             ablation->study.device);
    neph_svg_print_escaped(device, out);
    fprintf(out, "</text>\n");
    return 164.0;
}

static bool has_numbers(const struct neph_ablation *ablation, int measure)
{
    for (int i = 0; i < ablation->comparison_count; i++)
        if (ablation->comparisons[i].effects[measure].scene_count > 0)
            return true;
    return false;
}

enum neph_status neph_ablation_plot(const struct neph_ablation *ablation, FILE *out,
                                    struct neph_diag *diag)
{
    char *panels = NULL;
    size_t size;
    FILE *memory = open_memstream(&panels, &size);
    if (!memory)
        return neph_fail_memory(diag);
    double height_px = draw_legend(ablation, memory);
    for (int m = 0; neph_ablation_measures[m].name; m++)
        if (has_numbers(ablation, m))
            height_px = draw_panel(ablation, m, height_px, memory);
    const bool is_cut = ferror(memory) != 0, is_closed = fclose(memory) == 0;
    if (!is_cut && is_closed)
        fprintf(out,
                "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%.0f\" "
                "viewBox=\"0 0 %d %.0f\" font-family=\"sans-serif\" font-size=\"16\">\n"
                "<rect width=\"100%%\" height=\"100%%\" fill=\"#fff\"/>\n%s</svg>\n",
                WIDTH, height_px, WIDTH, height_px, panels);
    free(panels);
    return !is_cut && is_closed ? NEPH_OK : neph_fail_memory(diag);
}
