/* SPDX-License-Identifier: MIT
 *
 * Metric maps for the page of `neph view`: the difference of each set from the first set.
 */
#ifndef NEPH_HARNESS_REPORT_VIEWER_MAPS_H
#define NEPH_HARNESS_REPORT_VIEWER_MAPS_H

#include "harness/json.h"
#include "harness/report/viewer.h"

/* The default overlays; the last one exists only for sequences. */
extern const char *const neph_viewer_overlays[3];

/* Check, before frames are read, that all overlays of a view are maps of radiance. NEPH_ERR_USAGE
 * names the first one that is not. */
enum neph_status neph_viewer_check_overlays(const struct neph_viewer *view, struct neph_diag *diag);

/* A callback that stores the planes of a map under the key that the page uses. */
typedef enum neph_status neph_viewer_ship(void *context, const char *key,
                                          const float *const *planes, int plane_count,
                                          struct neph_diag *diag);

/* Compute the overlays of a view, for radiance, and ship each under the key "SET_FRAME_map_NAME";
 * FRAME is "all" for a map of the whole sequence. `overlays` and `not_taken` become lists as in
 * scripts/report/README.md. NEPH_ERR_USAGE: an overlay's name is unknown. */
enum neph_status neph_viewer_maps(const struct neph_viewer *view, bool is_picture,
                                  double frame_rate_hz, neph_viewer_ship *ship, void *context,
                                  json_t **overlays, json_t **not_taken, struct neph_diag *diag);

#endif
