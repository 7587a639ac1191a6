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

/* Numbers in the order in which they were taken. Start from {0}; free with _finish. */
struct neph_measurements {
    struct neph_measurement *list; /* owned */
    int count;
};

void neph_measurements_finish(struct neph_measurements *measurements);

/* Leave only those that are wanted, in their order. */
void neph_measurements_select(struct neph_measurements *measurements,
                              bool (*is_wanted)(const struct neph_measurement *number,
                                                const void *context),
                              const void *context);

/* Measure every quantity that both frames have over all masks, by the extractors of single frames
 * that are cheap enough to be taken always, or `only` the one of that name, and append the numbers
 * to `list`. */
enum neph_status neph_measure(const struct neph_image *reference, const struct neph_image *test,
                              const char *only, const struct neph_viewing *viewing,
                              struct neph_measurements *list, struct neph_diag *diag);

/* One number in the form of scripts/report/README.md, and a list of them; NULL when memory is
 * short. */
json_t *neph_measurement_json(const struct neph_measurement *m);
json_t *neph_measurements_json(const struct neph_measurements *list);
const char *neph_interval_name(enum neph_interval_kind kind);
bool neph_interval_is_bounded(enum neph_interval_kind kind); /* has an end on each side */
/* What nothing is brighter than to a metric; NULL for NEPH_BOUND_NONE. */
const char *neph_bound_name(enum neph_display_bound bound);
json_t *neph_clipped_json(const struct neph_clipped *clipped);
json_t *neph_viewing_json(const struct neph_viewing *viewing);

/* What may stand in those lists, as an array of {"name", "help"} from the tables of the metrics. */
json_t *neph_measured_metrics_json(void);

/* One such entry. */
json_t *neph_metric_json(const struct neph_metric *metric);

/* Whether a mask is of a kind of which there are many. */
bool neph_mask_is_detail(const char *mask);

/* Append how many values of a frame are not finite, and how many negative. */
enum neph_status neph_measure_validity(const struct neph_image *frame,
                                       struct neph_measurements *list, struct neph_diag *diag);

/* The last number of that quantity, metric and mask, which is the one of all frames where there are
 * several; NULL when there is none. Borrowed. */
const struct neph_measurement *neph_measurement_find(const struct neph_measurements *list,
                                                     const char *quantity, const char *metric,
                                                     const char *mask);

#endif
