/* SPDX-License-Identifier: MIT
 *
 * Measurements of pairs of frames in the form of a report.
 */
#ifndef NEPH_HARNESS_COMPARE_MEASURE_H
#define NEPH_HARNESS_COMPARE_MEASURE_H

#include "harness/json.h"
#include "metrics/meter.h"

enum { NEPH_MASKS_MAX = 64, NEPH_CHOICES_MAX = 64 };

/* Make every mask that the reference allows: "all", then the kinds, then its channels "mask.NAME";
 * with `details` also kinds with many members (rings at edges). Free with neph_masks_destroy(). */
enum neph_status neph_masks_create(const struct neph_image *reference, bool details,
                                   struct neph_mask *masks[NEPH_MASKS_MAX], int *count,
                                   struct neph_diag *diag);
void neph_masks_destroy(struct neph_mask **masks, int count);

/* Add to each mask the pixels of the same mask in another frame. */
enum neph_status neph_masks_unite(const struct neph_image *reference, struct neph_mask **masks,
                                  int count, struct neph_diag *diag);

/* Destroy the masks without a pixel and those that cover the whole frame. Returns the number of
 * masks left; "all" is always kept. */
int neph_masks_trim(struct neph_mask **masks, int count);

/* Numbers in the order of measurement. Start from {0}; free with neph_measurements_finish(). */
struct neph_measurements {
    struct neph_measurement *list; /* owned */
    int count;
};

void neph_measurements_finish(struct neph_measurements *measurements);

/* Remove all numbers but the wanted ones; the order is kept. */
void neph_measurements_select(struct neph_measurements *measurements,
                              bool (*is_wanted)(const struct neph_measurement *number,
                                                const void *context),
                              const void *context);

/* Measure every quantity of both frames over all masks and append the numbers to `list`. Uses the
 * inexpensive extractors of single frames, or the one named `only`. */
enum neph_status neph_measure(const struct neph_image *reference, const struct neph_image *test,
                              const char *only, const struct neph_viewing *viewing,
                              struct neph_measurements *list, struct neph_diag *diag);

/* A number in the form of scripts/report/README.md, and a list of them; NULL when memory is
 * short. */
json_t *neph_measurement_json(const struct neph_measurement *m);
json_t *neph_measurements_json(const struct neph_measurements *list);
const char *neph_interval_name(enum neph_interval_kind kind);
bool neph_interval_is_bounded(enum neph_interval_kind kind); /* it has two finite ends */
/* The largest brightness that a metric distinguishes; NULL for NEPH_BOUND_NONE. */
const char *neph_bound_name(enum neph_display_bound bound);
json_t *neph_clipped_json(const struct neph_clipped *clipped);
json_t *neph_viewing_json(const struct neph_viewing *viewing);

/* All metrics that can occur in those lists, as an array of {"name", "help"} from the tables of
 * metrics. */
json_t *neph_measured_metrics_json(void);

/* An element of that array. */
json_t *neph_metric_json(const struct neph_metric *metric);

/* True for a mask of a kind with many members. */
bool neph_mask_is_detail(const char *mask);

/* Append the number of NaN or infinite values of a frame, and the number of negative values. */
enum neph_status neph_measure_validity(const struct neph_image *frame,
                                       struct neph_measurements *list, struct neph_diag *diag);

/* The last number of this quantity, metric and mask; of a sequence this is the number of all
 * frames. NULL: there is none. Borrowed. */
const struct neph_measurement *neph_measurement_find(const struct neph_measurements *list,
                                                     const char *quantity, const char *metric,
                                                     const char *mask);

#endif
