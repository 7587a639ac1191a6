/* SPDX-License-Identifier: MIT
 *
 * docs/pipeline.svg is drawn from the records of the passes: a row for each pass of preset `ours`,
 * a column for each target, a mark where the pass reads or writes it.
 * `test_pipeline_figure --write` renews the file.
 */
#include "tests/printed_table.h"
#include "tests/renderer/realtime_test.h"

#include "renderer/realtime/options.h"
#include "renderer/realtime/passes.h"

#include <stdio.h>

enum { LEFT = 200, HEAD = 150, ROW = 26, COLUMN = 29, FOOT = 64, SIDE_PX = 64 };

/* The passes and the targets of the figure. */
struct figure {
    struct neph_gpu_view view;
    const struct neph_rt_pass *rows[NEPH_RT_PASSES_MAX];
    int row_count;
    int columns[RT_TARGET_COUNT], column_count;
    uint32_t before; /* targets that the frame before wrote, under this frame's names */
};

static bool touches(const struct figure *figure, int row, int target)
{
    return neph_rt_targets_touched(&figure->view, figure->rows[row]) & NEPH_RT_BIT(target);
}

static void choose(struct figure *figure)
{
    const struct neph_preset *preset = neph_rt_presets;
    while (strcmp(preset->name, "ours") != 0)
        preset++;
    const struct neph_settings settings = test_settings(preset->assignments);
    const int size_px[2] = {SIDE_PX, SIDE_PX}, origin_px[2] = {0, 0};
    neph_rt_view_init(&figure->view, &settings, size_px, origin_px, size_px);
    for (int p = 0; neph_rt_passes[p]; p++)
        if (neph_rt_is_condition_met(&figure->view, neph_rt_passes[p]->condition)) {
            figure->rows[figure->row_count++] = neph_rt_passes[p];
            figure->before |= neph_rt_targets_before(neph_rt_passes[p]);
        }
    /* Columns in the order of their first use. */
    uint32_t placed = 0;
    for (int r = 0; r < figure->row_count; r++)
        for (int t = 0; t < RT_TARGET_COUNT; t++)
            if (touches(figure, r, t) && !(placed & NEPH_RT_BIT(t))) {
                figure->columns[figure->column_count++] = t;
                placed |= NEPH_RT_BIT(t);
            }
}

/* Texels that share a side with SIDE_PX pixels, in words. */
static const char *resolution_words(const struct figure *figure, int target)
{
    const uint32_t side = SIDE_PX / figure->view.targets[target].width;
    return side == RT_FULL ? "full" : side == RT_HALF ? "half" : "quarter";
}

static const char *pass_resolution(const struct neph_rt_pass *pass)
{
    switch (pass->resolution) {
    case RT_FULL:
    case RT_OUTPUT:
        return "full";
    case RT_HALF:
        return "half";
    default:
        return pass->resolution == RT_QUARTER ? "quarter" : "froxels";
    }
}

/* Name, resolution, and a line over the passes between the first and the last use. The line of a
 * target of the frame before starts at the top; that of one that becomes history goes on below. */
static void draw_column(const struct figure *figure, int column, FILE *out)
{
    const int target = figure->columns[column], x = LEFT + COLUMN * column + COLUMN / 2;
    int first = figure->row_count, last = -1;
    bool is_kept = false;
    for (int r = 0; r < figure->row_count; r++) {
        if (touches(figure, r, target)) {
            first = first < r ? first : r;
            last = r;
        }
        for (int i = 0; i < NEPH_RT_HISTORIES_MAX && figure->rows[r]->histories[i].before; i++)
            is_kept |= figure->rows[r]->histories[i].now == target;
    }
    const bool is_before = figure->before & NEPH_RT_BIT(target);
    const int top = is_before ? HEAD - 12 : HEAD + ROW * first + ROW / 2;
    const int bottom = is_kept ? HEAD + ROW * figure->row_count + 8 : HEAD + ROW * last + ROW / 2;
    fprintf(out, "<text transform=\"translate(%d %d) rotate(-50)\">%s", x, HEAD - 16,
            neph_rt_target_name(target));
    fprintf(out, " <tspan fill=\"#666\">%s</tspan></text>", resolution_words(figure, target));
    fprintf(out, "<path d=\"M%d %d V%d\" stroke=\"#888\"%s/>\n", x, top, bottom,
            is_before || is_kept ? " stroke-dasharray=\"4 3\"" : "");
    if (is_kept)
        fprintf(out, "<path d=\"M%d %d l4 0 l-4 7 l-4 -7 z\" fill=\"#444\"/>\n", x, bottom);
}

static void draw_row(const struct figure *figure, int row, FILE *out)
{
    const struct neph_rt_pass *pass = figure->rows[row];
    const int y = HEAD + ROW * row + ROW / 2;
    fprintf(out,
            "<text x=\"%d\" y=\"%d\" text-anchor=\"end\"><tspan font-weight=\"bold\">%s</tspan> "
            "<tspan fill=\"#666\">%s</tspan></text>\n",
            LEFT - 6, y + 4, pass->name, pass_resolution(pass));
    for (int c = 0; c < figure->column_count; c++) {
        const int target = figure->columns[c], x = LEFT + COLUMN * c + COLUMN / 2;
        if (!touches(figure, row, target))
            continue;
        if (pass->writes & NEPH_RT_BIT(target))
            fprintf(out, "<rect x=\"%d\" y=\"%d\" width=\"14\" height=\"14\" fill=\"#222\"/>\n",
                    x - 7, y - 7);
        if (pass->reads & NEPH_RT_BIT(target))
            fprintf(out, "<circle cx=\"%d\" cy=\"%d\" r=\"4.5\" fill=\"#fff\" stroke=\"#222\"/>\n",
                    x, y);
    }
}

static void draw_key(const struct figure *figure, int y, FILE *out)
{
    fprintf(out,
            "<circle cx=\"20\" cy=\"%d\" r=\"4.5\" fill=\"#fff\" stroke=\"#222\"/>"
            "<text x=\"32\" y=\"%d\">the pass reads the target</text>"
            "<rect x=\"223\" y=\"%d\" width=\"14\" height=\"14\" fill=\"#222\"/>"
            "<text x=\"244\" y=\"%d\">it writes the target</text>"
            "<path d=\"M430 %d h40\" stroke=\"#888\" stroke-dasharray=\"4 3\"/>"
            "<text x=\"478\" y=\"%d\">kept from one frame to the next; ",
            y, y + 4, y - 7, y + 4, y, y + 4);
    for (int r = 0, count = 0; r < figure->row_count; r++)
        for (int i = 0; i < NEPH_RT_HISTORIES_MAX && figure->rows[r]->histories[i].before; i++)
            fprintf(out, "%s%s", count++ ? ", " : "arrow: ",
                    neph_rt_target_name(figure->rows[r]->histories[i].now));
    fprintf(out, "</text>\n");
}

static void print_figure(FILE *out)
{
    struct figure figure = {.row_count = 0};
    choose(&figure);
    const int width = LEFT + COLUMN * figure.column_count + 80,
              height = HEAD + ROW * figure.row_count + FOOT;
    fprintf(out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" "
            "viewBox=\"0 0 %d %d\" font-family=\"sans-serif\" font-size=\"12\">\n"
            "<rect width=\"100%%\" height=\"100%%\" fill=\"#fff\"/>\n",
            width, height, width, height);
    for (int r = 1; r < figure.row_count; r += 2)
        fprintf(out, "<rect x=\"0\" y=\"%d\" width=\"%d\" height=\"%d\" fill=\"#f2f2f2\"/>\n",
                HEAD + ROW * r, width, ROW);
    for (int c = 0; c < figure.column_count; c++)
        draw_column(&figure, c, out);
    for (int r = 0; r < figure.row_count; r++)
        draw_row(&figure, r, out);
    draw_key(&figure, height - 24, out);
    fprintf(out, "</svg>\n");
}

static void test_the_figure_is_the_table_of_passes(void **state)
{
    const struct printed_table table = {NEPH_SOURCE_DIR "/docs/pipeline.svg",
                                        "<!-- drawn by tests/test_pipeline_figure -->\n",
                                        "<!-- end -->\n", print_figure};
    check_readme(&table, *state);
}

int main(int count, char **arguments)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_prestate(test_the_figure_is_the_table_of_passes,
                                  writes_readme(count, arguments)),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
