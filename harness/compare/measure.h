/* SPDX-License-Identifier: MIT
 *
 * From two frames to the measurements of a report.
 */
#ifndef NEPH_HARNESS_COMPARE_MEASURE_H
#define NEPH_HARNESS_COMPARE_MEASURE_H

#include "harness/json.h"
#include "metrics/meter.h"

enum { NEPH_MASKS_MAX = 64, NEPH_CHOICES_MAX = 64 };

/* Every mask that the reference allows, "all" first, then the kinds, then its channels "mask.NAME";
 * with `details` also those of which there are many (rings at edges). Destroy them with
 * neph_masks_destroy(). */
enum neph_status neph_masks_create(const struct neph_image *reference, bool details,
                                   struct neph_mask *masks[NEPH_MASKS_MAX], int *count,
                                   struct neph_diag *diag);
void neph_masks_destroy(struct neph_mask **masks, int count);

/* Add the pixels that the same masks have in another frame. */
enum neph_status neph_masks_unite(const struct neph_image *reference, struct neph_mask **masks,
                                  int count, struct neph_diag *diag);

/* Destroy the masks that say nothing of their own: without a pixel, or equal to the whole image.
 * Returns how many are left; "all" always is. */
int neph_masks_trim(struct neph_mask **masks, int count);

/* The extractors of single frames that are cheap enough to be taken always, or `only` the one of
 * that name, at their defaults; room for NEPH_CHOICES_MAX. Returns their number. */
int neph_measure_usual(const char *only, struct neph_meter_choice *choices);

/* Measure every quantity that both frames have over all masks with neph_measure_usual(), and
 * add one object per number to the array `list`. */
enum neph_status neph_measure(const struct neph_image *reference, const struct neph_image *test,
                              const char *only, const struct neph_viewing *viewing, json_t *list,
                              struct neph_diag *diag);

/* One number in the form of scripts/report/README.md; NULL when memory is short. */
json_t *neph_measurement_json(const struct neph_measurement *m);
const char *neph_interval_name(enum neph_interval_kind kind);
/* What nothing is brighter than to a metric; NULL for NEPH_BOUND_NONE. */
const char *neph_bound_name(enum neph_display_bound bound);
json_t *neph_viewing_json(const struct neph_viewing *viewing);

/* Whether a mask is of a kind of which there are many. */
bool neph_mask_is_detail(const char *mask);

/* Counts of non-finite and negative values of a frame, in the same form. */
enum neph_status neph_measure_validity(const struct neph_image *frame, json_t *list,
                                       struct neph_diag *diag);

/* The measurement of that quantity, metric and mask; NULL when there is none. Borrowed. */
const json_t *neph_measurement_find(const json_t *list, const char *quantity, const char *metric,
                                    const char *mask);

#endif
