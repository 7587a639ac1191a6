/* SPDX-License-Identifier: MIT */
#include "harness/report/flicker_map.h"

#include "base/exr.h"
#include "base/image.h"
#include "base/png.h"
#include "harness/report/page.h"
#include "metrics/display.h"

#include <math.h>
#include <stdlib.h>

/* Position on the scale: 0 at and below its low end, 1 at its high end; NaN stays NaN. */
static float place_on_scale(float value)
{
    const double decades = log10(NEPH_FLICKER_MAP_HIGH / NEPH_FLICKER_MAP_LOW);
    if ((double)value <= NEPH_FLICKER_MAP_LOW)
        return 0.0f;
    return (float)(log10((double)value / NEPH_FLICKER_MAP_LOW) / decades);
}

static enum neph_status draw(const struct neph_image *image, const char *png,
                             struct neph_diag *diag)
{
    const float *values = neph_image_channel(image, "Y");
    const size_t count = neph_image_pixel_count(image);
    if (!values)
        return neph_fail(diag, NEPH_ERR_INTERNAL, "a map of flicker has no channel Y");
    float *places = malloc(count * sizeof(*places));
    uint8_t *rgb = malloc(3 * count);
    enum neph_status status = places && rgb ? NEPH_OK : neph_fail_memory(diag);
    for (size_t i = 0; i < count && !status; i++)
        places[i] = place_on_scale(values[i]);
    if (!status)
        status = neph_display_map((const float *const[]){places}, 1, count, false, 1.0, rgb, diag);
    if (!status)
        status = neph_png_write_rgb8(png, image->width_px, image->height_px, rgb, diag);
    free(places);
    free(rgb);
    return status;
}

enum neph_status neph_flicker_map_draw(const char *exr, const char *png, struct neph_diag *diag)
{
    struct neph_image *image = NULL;
    enum neph_status status = neph_exr_read(exr, &image, diag);
    if (!status)
        status = draw(image, png, diag);
    neph_image_destroy(image);
    return status;
}

json_t *neph_flicker_map_scale_json(void)
{
    const struct neph_display_legend *legend = neph_display_amount_legend();
    return json_pack("{s:f, s:f, s:s, s:o, s:o}", "low", NEPH_FLICKER_MAP_LOW, "high",
                     NEPH_FLICKER_MAP_HIGH, "unit", "times the threshold", "colours",
                     neph_page_colours(legend), "beyond", neph_page_colours_beyond(legend));
}
