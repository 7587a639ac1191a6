/* SPDX-License-Identifier: MIT */
#include "harness/report/compare_frames.h"

#include "base/path.h"
#include "harness/compare/frame.h"
#include "harness/document/display_png.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* A rectangle of a frame. */
struct part {
    int x, y, width_px, height_px;
};

struct planes {
    float *rgb[3];
};

static void free_planes(struct planes *planes)
{
    for (int c = 0; c < 3; c++)
        free(planes->rgb[c]);
}

static enum neph_status cut(const struct neph_image *image, struct part part, struct planes *planes,
                            struct neph_diag *diag)
{
    float *rgb[3];
    *planes = (struct planes){{NULL, NULL, NULL}};
    if (!neph_image_rgb(image, NULL, rgb))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "the frames have no radiance to be shown");
    for (int c = 0; c < 3; c++) {
        planes->rgb[c] = malloc((size_t)part.width_px * (size_t)part.height_px * sizeof(float));
        if (!planes->rgb[c])
            return neph_fail_memory(diag);
        for (int y = 0; y < part.height_px; y++)
            for (int x = 0; x < part.width_px; x++)
                planes->rgb[c][y * part.width_px + x] =
                    rgb[c][(size_t)(part.y + y) * (size_t)image->width_px + (size_t)(part.x + x)];
    }
    return NEPH_OK;
}

static int clamp_index(int value, int most)
{
    return value < 0 ? 0 : value > most ? most : value;
}

/* The part around the pixel with the largest luminance difference. */
static struct part choose_part(const struct neph_image *a, const struct neph_image *b)
{
    struct part part = {0, 0, a->width_px < NEPH_WORST_WIDTH_PX ? a->width_px : NEPH_WORST_WIDTH_PX,
                        a->height_px < NEPH_WORST_HEIGHT_PX ? a->height_px : NEPH_WORST_HEIGHT_PX};
    float *x[3], *y[3];
    size_t most = 0;
    double largest = -1.0;
    if (!neph_image_rgb(a, NULL, x) || !neph_image_rgb(b, NULL, y))
        return part;
    for (size_t i = 0; i < neph_image_pixel_count(a); i++) {
        const double difference = fabs(neph_luminance_at((const float *const *)x, i) -
                                       neph_luminance_at((const float *const *)y, i));
        if (difference > largest) {
            largest = difference;
            most = i;
        }
    }
    part.x = clamp_index((int)(most % (size_t)a->width_px) - part.width_px / 2,
                         a->width_px - part.width_px);
    part.y = clamp_index((int)(most / (size_t)a->width_px) - part.height_px / 2,
                         a->height_px - part.height_px);
    return part;
}

/* ---- files ----------------------------------------------------------------------------------- */

struct drawing {
    const char *folder;
    const struct neph_comparison *asked;
    int index;
    struct part part;
    json_t *images;
};

static const char *const kinds[] = {"test", "other"};

static enum neph_status add(struct drawing *drawing, const char *name, const char *what,
                            const struct planes *planes, const struct planes *from, double scale,
                            struct neph_diag *diag)
{
    const struct neph_path file = neph_path_format("frames/%04d_%s.png", drawing->index, name);
    const struct neph_path path = neph_path_in(drawing->folder, file.text);
    const int w = drawing->part.width_px, h = drawing->part.height_px;
    const float *const *rgb = (const float *const *)planes->rgb;
    enum neph_status status =
        from ? neph_difference_png(path.text, w, h, (const float *const *)from->rgb, rgb, scale,
                                   diag)
             : neph_display_png(path.text, w, h, rgb, drawing->asked->viewing.exposure_ev, diag);
    if (!status)
        neph_json_add(&drawing->images, json_pack("{s:s, s:s, s:b}", "src", file.text, "what", what,
                                                  "is_difference", from != NULL));
    return status;
}

/* The colour scale of differences ends at a tenth of the display's white. */
static double compute_difference_scale(const struct neph_comparison *asked)
{
    return 0.1 * exp2(-asked->viewing.exposure_ev);
}

/* The index of the adjacent frame to compare with when there is no reference. */
static int neighbour(const struct drawing *drawing)
{
    const bool has_before = drawing->asked->warm_up_frames + drawing->index > 0;
    return has_before ? drawing->index - 1 : drawing->index + 1;
}

static enum neph_status draw_side(const struct neph_compare_page *page, struct drawing *drawing,
                                  enum neph_page_side side, const struct neph_image *image,
                                  const struct neph_image *from, struct neph_diag *diag)
{
    struct planes planes = {{NULL}}, before = {{NULL}};
    char name[32], what[160];
    const char *title = page->names[side] ? page->names[side] : "test";
    enum neph_status status = cut(image, drawing->part, &planes, diag);
    if (!status)
        status = cut(from, drawing->part, &before, diag);
    if (!status)
        status = add(drawing, kinds[side], title, &planes, NULL, 0.0, diag);
    snprintf(name, sizeof(name), "%s_difference", kinds[side]);
    snprintf(what, sizeof(what), "%.100s - %s", title,
             !drawing->asked->without_reference    ? "reference"
             : neighbour(drawing) < drawing->index ? "its frame before"
                                                   : "its next frame");
    if (!status)
        status = add(drawing, name, what, &planes, &before,
                     compute_difference_scale(drawing->asked), diag);
    free_planes(&planes);
    free_planes(&before);
    return status;
}

static enum neph_status read_frame(const struct neph_comparison *asked,
                                   const struct neph_sequence *sequence, int index,
                                   struct neph_image **image, struct neph_diag *diag)
{
    const int at = asked->warm_up_frames + index;
    const char *path = sequence->paths[sequence->count == 1 ? 0 : at];
    return neph_frame_read(path, &asked->frame_choice, asked->negative_allowed, image, diag);
}

static enum neph_status draw_reference(struct drawing *drawing, const struct neph_image *image,
                                       struct neph_diag *diag)
{
    struct planes planes = {{NULL}};
    enum neph_status status = cut(image, drawing->part, &planes, diag);
    if (!status)
        status = add(drawing, "reference", "reference", &planes, NULL, 0.0, diag);
    free_planes(&planes);
    return status;
}

/* Both sides show the part chosen for the first side. */
static enum neph_status draw_sides(const struct neph_compare_page *page, struct drawing *drawing,
                                   struct neph_diag *diag)
{
    const struct neph_comparison *asked = drawing->asked;
    enum neph_status status = NEPH_OK;
    for (int s = 0; s < NEPH_PAGE_SIDES && page->tests[s] && !status; s++) {
        struct neph_image *image = NULL, *from = NULL;
        const struct neph_sequence *of = asked->without_reference ? page->tests[s]
                                                                  : &asked->reference;
        const int other = asked->without_reference ? neighbour(drawing) : drawing->index;
        status = read_frame(asked, page->tests[s], drawing->index, &image, diag);
        if (!status)
            status = read_frame(asked, of, other, &from, diag);
        if (!status && s == 0)
            drawing->part = choose_part(image, from);
        if (!status && s == 0 && !asked->without_reference)
            status = draw_reference(drawing, from, diag);
        if (!status)
            status = draw_side(page, drawing, (enum neph_page_side)s, image, from, diag);
        neph_image_destroy(image);
        neph_image_destroy(from);
    }
    return status;
}

enum neph_status neph_compare_frame_draw(const struct neph_compare_page *page, const char *folder,
                                         int index, double value, json_t **frame,
                                         struct neph_diag *diag)
{
    const struct neph_comparison *asked = page->compared[NEPH_PAGE_TEST]->asked;
    struct drawing drawing = {
        .folder = folder, .asked = asked, .index = index, .images = json_array()};
    const enum neph_status status = draw_sides(page, &drawing, diag);
    if (status) {
        json_decref(drawing.images);
        return status;
    }
    const struct part *part = &drawing.part;
    const struct neph_sequence *test = page->tests[NEPH_PAGE_TEST];
    *frame = json_pack("{s:i, s:o, s:o, s:[i,i,i,i], s:f, s:o}", "frame", index, "file",
                       neph_json_cleaned(test->paths[asked->warm_up_frames + index]), "value",
                       neph_json_number(value), "part", part->x, part->y, part->width_px,
                       part->height_px, "difference_scale", compute_difference_scale(asked),
                       "images", drawing.images);
    return *frame ? NEPH_OK : neph_fail_memory(diag);
}
