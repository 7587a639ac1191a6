/* SPDX-License-Identifier: MIT
 *
 * The page of a sweep and its charts.
 */
#include "harness/sweep/output.h"

#include "base/files.h"
#include "harness/report/page.h"
#include "harness/report/report_folder.h"
#include "harness/report/vega.h"
#include "harness/sweep/chart.h"

#include <stdio.h>
#include <stdlib.h>

static const struct neph_page_parts parts = {
    .title = "Nephelometer sweep",
    .files = {"sweep.html", "sweep.js"},
    .folders = {"charts", "vendor"},
};

/* --- charts --------------------------------------------------------------------------------- */

/* The charts with points, and their files. */
struct drawings {
    json_t *specs[NEPH_VEGA_CHARTS_MAX];
    char *stems[NEPH_VEGA_CHARTS_MAX]; /* the sizes of a chart are consecutive */
    const struct neph_sweep_chart *charts[NEPH_VEGA_CHARTS_MAX];
    int count;
    bool drawn;
};

static void finish(struct drawings *drawings)
{
    for (int i = 0; i < drawings->count; i++) {
        json_decref(drawings->specs[i]);
        free(drawings->stems[i]);
    }
}

static enum neph_status specify(const struct neph_sweep *sweep,
                                const struct neph_sweep_chart *chart,
                                const struct neph_sweep_chart_size *size, const char *folder,
                                struct drawings *drawings, struct neph_diag *diag)
{
    json_t *spec = NULL;
    enum neph_status status = neph_sweep_chart_spec(sweep, chart, size, &spec, diag);
    if (status || !spec)
        return status;
    const int index = drawings->count++;
    drawings->specs[index] = spec;
    drawings->charts[index] = chart;
    drawings->stems[index] = neph_format("%s/charts/%s-%s", folder, chart->id, size->name);
    return drawings->stems[index] ? neph_vega_write(spec, drawings->stems[index], diag)
                                  : neph_fail_memory(diag);
}

static enum neph_status draw_all(const struct neph_sweep *sweep, const char *folder,
                                 struct drawings *drawings, char told[512], struct neph_diag *diag)
{
    struct neph_diag why = {.line = 0};
    enum neph_status status = NEPH_OK;
    for (const struct neph_sweep_chart *chart = neph_sweep_charts; chart->id && !status; chart++)
        for (int i = 0; i < NEPH_SWEEP_CHART_SIZES && !status; i++)
            status = specify(sweep, chart, &neph_sweep_chart_sizes[i], folder, drawings, diag);
    if (status || drawings->count == 0)
        return status;
    status = neph_vega_draw(drawings->stems, drawings->count, &drawings->drawn, &why, diag);
    if (!status && !drawings->drawn)
        snprintf(told, 512,
                 "charts are not drawn: %.300s (apt-get install nodejs npm; npm ci --omit=dev in "
                 "scripts/report)",
                 why.message);
    return status;
}

static json_t *size_json(const struct drawings *drawings, int index, int size)
{
    const struct neph_sweep_chart_size *of = &neph_sweep_chart_sizes[size];
    return json_pack(
        "{s:o, s:i, s:i, s:O}", "svg",
        drawings->drawn ? json_sprintf("charts/%s-%s.svg", drawings->charts[index]->id, of->name)
                        : json_null(),
        "width_px", of->width_px, "height_px", of->height_px, "spec", drawings->specs[index]);
}

static json_t *charts_json(const struct neph_sweep *sweep, const struct drawings *drawings)
{
    json_t *list = json_array();
    for (int i = 0; i < drawings->count; i += NEPH_SWEEP_CHART_SIZES) {
        const struct neph_sweep_chart *chart = drawings->charts[i];
        char *caption = neph_sweep_chart_caption(sweep, chart);
        json_t *entry = json_pack("{s:s, s:s, s:s}", "id", chart->id, "title", chart->title,
                                  "caption", caption ? caption : "");
        for (int size = 0; size < NEPH_SWEEP_CHART_SIZES; size++)
            neph_json_set(&entry, neph_sweep_chart_sizes[size].name,
                          size_json(drawings, i + size, size));
        neph_json_add(&list, entry);
        free(caption);
    }
    return list;
}

/* --- the page ------------------------------------------------------------------------------- */

enum neph_status neph_sweep_page_write(const struct neph_sweep *sweep,
                                       const struct neph_report_folder *folder, char told[512],
                                       struct neph_diag *diag)
{
    bool is_interactive;
    const char *work = neph_report_folder_work(folder);
    struct drawings drawings = {.count = 0};
    json_t *document = NULL;
    told[0] = '\0';
    enum neph_status status = neph_page_start(work, &parts, &is_interactive, diag);
    if (!status)
        status = draw_all(sweep, work, &drawings, told, diag);
    if (!status) {
        document = neph_sweep_json(sweep);
        neph_json_set(&document, "charts", charts_json(sweep, &drawings));
        neph_json_set(&document, "interactive", json_boolean(is_interactive));
        status = neph_json_check(document, diag);
    }
    if (!status)
        status = neph_page_publish(folder, "NEPH_SWEEP", document, diag);
    json_decref(document);
    finish(&drawings);
    return status;
}
