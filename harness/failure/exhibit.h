/* SPDX-License-Identifier: MIT
 *
 * Evidence in the store: an entry of pictures under the key of the take that they are of, with the
 * map of the flicker that is seen. It is made where the frames are, and read by whoever shows it.
 */
#ifndef NEPH_HARNESS_FAILURE_EXHIBIT_H
#define NEPH_HARNESS_FAILURE_EXHIBIT_H

#include "harness/failure/evidence.h"
#include "harness/run/job.h"
#include "harness/run/store.h"
#include "metrics/meter.h"

/* Name of the map among the pictures. */
#define NEPH_EXHIBIT_FLICKER_MAP "seen_contrast_radiance.png"

/* The key of a take's exhibit, whose pictures are shown at an exposure. */
enum neph_status neph_exhibit_key(const char *take_key, double exposure_ev,
                                  char key[NEPH_HASH_HEX_SIZE], struct neph_diag *diag);

/* Its folder in the store, for the caller to free, or NULL. The folder has the images that its
 * job.json names in "pictures", beside "frame_step", "worst_frame", "row", "slice_first",
 * "slice_count", "flip_first", "flip_count" and "scale". */
char *neph_exhibit_find(struct neph_store *store, const char *key);

/* Make and publish it, as of the engine and device of `job`. Frames with bad values, fewer than
 * what is seen needs, or without a reference have no map. */
enum neph_status neph_exhibit_make(struct neph_store *store, const char *key,
                                   const struct neph_job *job,
                                   const struct neph_evidence_source *source,
                                   const struct neph_viewing *viewing, bool with_map,
                                   struct neph_diag *diag);

#endif
