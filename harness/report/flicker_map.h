/* SPDX-License-Identifier: MIT
 *
 * PNG maps of visible flicker on a fixed logarithmic scale, so that maps of different presets can
 * be compared: their flicker differs by factors of ten.
 */
#ifndef NEPH_HARNESS_REPORT_FLICKER_MAP_H
#define NEPH_HARNESS_REPORT_FLICKER_MAP_H

#include "harness/json.h"

/* The ends of the scale, in multiples of the threshold of visibility. */
#define NEPH_FLICKER_MAP_LOW 0.1
#define NEPH_FLICKER_MAP_HIGH 1000.0

/* Draw the map `seen_contrast` of an EXR file (channel Y) as a PNG: black at and below the low end,
 * the colours of amounts in between, one colour above the high end, one for NaN. */
enum neph_status neph_flicker_map_draw(const char *exr, const char *png, struct neph_diag *diag);

/* The scale as "map_scale" of scripts/report/README.md. */
json_t *neph_flicker_map_scale_json(void);

#endif
