/* SPDX-License-Identifier: MIT
 *
 * Maps of the metrics for the page of neph view: what each set is off by against the first.
 */
#ifndef NEPH_HARNESS_REPORT_VIEWER_MAPS_H
#define NEPH_HARNESS_REPORT_VIEWER_MAPS_H

#include "harness/json.h"
#include "harness/report/viewer.h"

/* The maps that are laid over pictures when none are named; the last is of sequences alone. */
extern const char *const neph_viewer_overlays[3];

/* Whether all overlays of a view are maps of radiance: to be asked before frames are read.
 * NEPH_ERR_USAGE names the first that is not. */
enum neph_status neph_viewer_check_overlays(const struct neph_viewer *view, struct neph_diag *diag);

/* Takes the planes of a map under the name that the page knows them by. */
typedef enum neph_status neph_viewer_ship(void *context, const char *key,
                                          const float *const *planes, int plane_count,
                                          struct neph_diag *diag);

/* Make the overlays of a view, of radiance, and ship each: "SET_FRAME_map_NAME", FRAME "all" of a
 * map of the whole sequence. `overlays` and `not_taken` become lists as scripts/report/README.md
 * has them. NEPH_ERR_USAGE: no extractor has a map of a name. */
enum neph_status neph_viewer_maps(const struct neph_viewer *view, bool is_picture,
                                  double frame_rate_hz, neph_viewer_ship *ship, void *context,
                                  json_t **overlays, json_t **not_taken, struct neph_diag *diag);

#endif
