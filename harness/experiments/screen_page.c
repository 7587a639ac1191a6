/* SPDX-License-Identifier: MIT */
#include "base/path.h"
#include "harness/experiments/screen.h"

#include "base/files.h"
#include "base/owned.h"
#include "base/png.h"
#include "base/written.h"
#include "harness/study/numbers_plot.h"
#include "harness/study/svg.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Compiles only when this file handles every kind. */
_Static_assert(NEPH_SCREEN_LOSSES == 3, "a new kind");
_Static_assert(NEPH_SCREEN_PARTS == 3, "a new kind");

/* Frames are small, so each pixel is enlarged to a square of this side. */
enum { SQUARE_PX = 4 };

/* Colours of Okabe and Ito, chosen to differ in grey as well. */
static const struct {
    uint8_t rgb[3];
    const char *css, *name, *why;
} reasons[NEPH_SCREEN_REASONS] = {
    [NEPH_LOST_OFF] = {{240, 228, 66},
                       "#f0e442",
                       "off",
                       "most rays meet surfaces outside the frame"},
    [NEPH_LOST_BEHIND] = {{0, 114, 178},
                          "#0072b2",
                          "behind",
                          "they meet surfaces hidden by others in the frame"},
    [NEPH_LOST_THIN] = {{213, 94, 0},
                        "#d55e00",
                        "thin",
                        "they pass behind something that is seen, and meet nothing"},
    [NEPH_SCREEN_LOSSES] = {{60, 60, 60},
                            "#3c3c3c",
                            "else",
                            "neither: noise, or on rough metal another ray than the mirror's"},
};

static const char *const part_files[NEPH_SCREEN_PARTS] = {
    [NEPH_SCREEN_AO] = "ao",
    [NEPH_SCREEN_DIFFUSE] = "indirect",
    [NEPH_SCREEN_GLOSSY] = "reflections",
};

/* ---- frames ---------------------------------------------------------------------------------- */

/* A lost pixel is a quarter grey image, three quarters colour of its reason. */
static void paint(uint8_t grey, uint8_t mark, uint8_t rgb[3])
{
    for (int c = 0; c < 3; c++)
        rgb[c] = mark == 0 ? grey : (uint8_t)((3 * reasons[mark - 1].rgb[c] + grey) / 4);
}

static enum neph_status write_frame(const struct neph_screen_scene *scene, int part, int width_px,
                                    int height_px, const char *path, struct neph_diag *diag)
{
    const int wide_px = width_px * SQUARE_PX, high_px = height_px * SQUARE_PX;
    uint8_t *rgb = malloc(3 * (size_t)wide_px * (size_t)high_px);
    if (!rgb)
        return neph_fail_memory(diag);
    for (int y = 0; y < high_px; y++)
        for (int x = 0; x < wide_px; x++) {
            const int p = y / SQUARE_PX * width_px + x / SQUARE_PX;
            paint(scene->seen[p], scene->marks[part][p], rgb + 3 * ((size_t)y * wide_px + x));
        }
    const enum neph_status status = neph_png_write_rgb8(path, wide_px, high_px, rgb, diag);
    free(rgb);
    return status;
}

static enum neph_status write_frames(const struct neph_screen_study *study, const char *folder,
                                     struct neph_diag *diag)
{
    const struct neph_cli_size *size = &study->request->shared.size;
    enum neph_status status = NEPH_OK;
    for (int s = 0; s < study->request->scene_count; s++)
        for (int part = 0; part < NEPH_SCREEN_PARTS && !status; part++) {
            if (study->scenes[s].truths[part].pixels == 0)
                continue;
            const struct neph_path path = neph_path_format(
                "%s/%s_%s.png", folder, study->request->scenes[s]->name, part_files[part]);
            status = write_frame(&study->scenes[s], part, size->width_px, size->height_px,
                                 path.text, diag);
        }
    return status;
}

/* ---- the chart ------------------------------------------------------------------------------- */

/* A short model name: its settings, or only those that it adds to the first model. Labels have
 * little space. */
static const char *short_name(const char *model, const char *first)
{
    static const char engine[] = "screen+";
    const size_t same = strlen(first), name = strlen(engine);
    if (strncmp(model, first, same) == 0 && model[same] == '+')
        return model + same + 1;
    return strncmp(model, engine, name) == 0 ? model + name : model;
}

static void draw_chart(const void *what, FILE *out)
{
    const struct neph_screen_study *study = what;
    const struct neph_screen_request *request = study->request;
    struct neph_post_row rows[NEPH_LIGHT_MODELS_MAX + 1] = {{.name = NULL}};
    const char *scenes[NEPH_SCREEN_SCENES_MAX];
    for (int m = 0; m < request->models.count; m++)
        rows[m].name = short_name(request->models.words[m], request->models.words[0]);
    for (int s = 0; s < request->scene_count; s++)
        scenes[s] = request->scenes[s]->name;
    const struct neph_numbers_plot plot = {
        .rows = rows,
        .over = rows[0].name,
        .scene_count = request->scene_count,
        .scenes = scenes,
        .numbers = study->flicker[0],
        .stride = NEPH_LIGHT_MODELS_MAX,
    };
    neph_numbers_plot(&plot, out);
}

/* ---- the page -------------------------------------------------------------------------------- */

static const char head[] =
    "<!DOCTYPE html>\n"
    "<html lang=\"en\">\n"
    "<head>\n"
    "<meta charset=\"utf-8\">\n"
    "<!-- Opened from disk: nothing may come from a network, and no text is run as code. -->\n"
    "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src "
    "'unsafe-inline'; img-src 'self' file: data:\">\n"
    "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
    "<meta name=\"color-scheme\" content=\"light dark\">\n"
    "<title>Limits of screen-space methods</title>\n"
    "<link rel=\"icon\" href=\"data:,\">\n"
    "<style>body{font:16px/1.5 sans-serif;max-width:80rem;margin:1rem auto;padding:0 "
    "1rem}.row{display:flex;flex-wrap:wrap;gap:1rem}figure{margin:0;flex:1 1 "
    "20rem;max-width:30rem}img{width:100%;height:auto;image-rendering:pixelated;display:block}."
    "chart{max-width:430px}figcaption{font-size:.9rem}i{display:inline-block;width:1em;height:1em;"
    "margin-right:.4em;vertical-align:-.15em;border:1px solid "
    "#888}li{list-style:none}ul{padding:0}</style>\n"
    "</head>\n"
    "<body>\n"
    "<h1>Limits of screen-space methods</h1>\n";

static void print_key(FILE *out)
{
    fprintf(out, "<ul>\n");
    for (int i = 0; i < NEPH_SCREEN_REASONS; i++)
        fprintf(out, "<li><i style=\"background:%s\"></i><b>%s</b>: %s</li>\n", reasons[i].css,
                reasons[i].name, reasons[i].why);
    fprintf(out, "</ul>\n");
}

static void print_caption(const char *part, const struct neph_screen_truth *truth, FILE *out)
{
    fprintf(out, "<figcaption>%s: %d of %d px lost", part, truth->lost, truth->pixels);
    for (int i = 0; i < NEPH_SCREEN_REASONS; i++)
        if (truth->lost_by[i] > 0)
            fprintf(out, ", %d %s", truth->lost_by[i], reasons[i].name);
    fprintf(out, "; its visible part differs by %.2g %%</figcaption>", 100.0 * truth->beyond);
}

static void print_scene(const struct neph_scene *scene, const struct neph_screen_scene *found,
                        FILE *out)
{
    fprintf(out, "<h2>");
    neph_svg_print_escaped(scene->name, out);
    fprintf(out, "</h2>\n<div class=\"row\">\n");
    for (int part = 0; part < NEPH_SCREEN_PARTS; part++) {
        if (found->truths[part].pixels == 0)
            continue;
        fprintf(out, "<figure><img src=\"");
        neph_svg_print_escaped(scene->name, out);
        fprintf(out, "_%s.png\" alt=\"%s: lost pixels in colour\">", part_files[part],
                neph_screen_part_names[part]);
        print_caption(neph_screen_part_names[part], &found->truths[part], out);
        fprintf(out, "</figure>\n");
    }
    fprintf(out, "</div>\n");
}

static void print_page(const void *what, FILE *out)
{
    const struct neph_screen_study *study = what;
    const struct neph_screen_request *request = study->request;
    fprintf(out,
            "%s<p>Coloured pixels are lost to every method with only this frame as input: the "
            "visible part of their truth differs by more than %g %% (ambient occlusion within %g "
            "m: of the hemisphere, %g %%). The colour gives the reason for most of their rays; for "
            "reflections, of the mirror ray. Engine surfaces, %d samples a pixel, neph %s.</p>\n",
            head, 100.0 * NEPH_SCREEN_LOST, request->radius_m, 50.0 * NEPH_SCREEN_LOST,
            request->samples, NEPH_VERSION);
    print_key(out);
    for (int s = 0; s < request->scene_count; s++)
        print_scene(request->scenes[s], &study->scenes[s], out);
    if (request->frame_count > 0)
        fprintf(out,
                "<h2>Over frames</h2>\n"
                "<p>Each changed model over the first; a mark a scene.</p>\n"
                "<img class=\"chart\" src=\"screen.svg\" alt=\"error, flicker, milliseconds\">\n");
    fprintf(out, "</body>\n</html>\n");
}

enum neph_status neph_screen_page_claim(const char *folder, struct neph_diag *diag)
{
    static const struct neph_owned_kind kind = {.name = "screen", .version = 1};
    return neph_owned_claim(folder, &kind, diag);
}

static enum neph_status write_text(const struct neph_screen_study *study, neph_writer *write,
                                   const char *folder, const char *name, struct neph_diag *diag)
{
    char *text = NULL;
    enum neph_status status = neph_write_to_text(write, study, &text, diag);
    if (!status)
        status = neph_file_write(neph_path_in(folder, name).text, text, strlen(text), diag);
    free(text);
    return status;
}

enum neph_status neph_screen_page_write(const struct neph_screen_study *study, const char *folder,
                                        struct neph_diag *diag)
{
    enum neph_status status = write_frames(study, folder, diag);
    if (!status && study->request->frame_count > 0)
        status = write_text(study, draw_chart, folder, "screen.svg", diag);
    return status ? status : write_text(study, print_page, folder, "index.html", diag);
}
