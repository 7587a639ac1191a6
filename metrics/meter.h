/* SPDX-License-Identifier: MIT
 *
 * The meter: measures frame pairs with chosen extractors over masks; each frame is read once. The
 * numbers of a frame are available after neph_meter_frame(), the numbers of the sequence after
 * neph_meter_finish().
 */
#ifndef NEPH_METRICS_METER_H
#define NEPH_METRICS_METER_H

#include "metrics/extractor.h"
#include "metrics/mask.h"

/* An extractor with its options. */
struct neph_meter_choice {
    const struct neph_extractor *extractor;
    struct neph_settings settings;
};

/* A number, by metric and mask. */
struct neph_meter_number {
    const char *metric, *mask;
};

struct neph_meter_params {
    const struct neph_meter_choice *choices;
    int choice_count;
    struct neph_viewing viewing;
    const struct neph_mask *const *masks; /* same size as the frames; borrowed for the meter's life;
                                           * the first is "all", which also has the numbers of whole
                                           * frames */
    int mask_count;
    const struct neph_meter_number *wanted; /* the only computed numbers, equal to those without
                                             * this list; ends with a NULL metric, borrowed for the
                                             * meter's life. NULL: all */
    int frame_count; /* number of neph_meter_frame() calls to come; 0: unknown; metrics that need it
                      * then report that */
    bool intervals;  /* bootstrap each number that allows it; doubles the cost */
    bool draws; /* with intervals: keep the draws of numbers of a sequence, or of its only frame, 8
                 * KB each */
};

struct neph_meter;

/* Whether a list of wanted numbers contains this metric and mask (NULL: any). A NULL list contains
 * all. */
bool neph_meter_is_wanted(const struct neph_meter_number *wanted, const char *metric,
                          const char *mask);

/* Create a meter. Except for masks and wanted, the params are needed only during the call.
 * NEPH_ERR_INPUT: a viewing condition is out of range. */
enum neph_status neph_meter_create(const struct neph_meter_params *params,
                                   struct neph_meter **meter, struct neph_diag *diag);

/* `meter` may be NULL. */
void neph_meter_destroy(struct neph_meter *meter);

/* Measure every quantity that both frames have; `reference_second` may be NULL. Frames come in
 * order; all have the size and the quantities of the first. Bad pixels (not finite) are counted,
 * and the numbers that use them are undefined; they are never skipped. NEPH_ERR_INPUT: sizes
 * differ. NEPH_ERR_INTERRUPTED. A frame that fails adds no numbers. */
enum neph_status neph_meter_frame(struct neph_meter *meter, const struct neph_image *reference,
                                  const struct neph_image *reference_second,
                                  const struct neph_image *test, struct neph_diag *diag);

/* The display luma (extractors/display_luma.h) of reference and test of the last frame, until the
 * next call of neph_meter_frame(). False: no extractor needed it. */
bool neph_meter_display_luma(const struct neph_meter *meter, const struct neph_quantity *quantity,
                             const double **reference, const double **test);

/* Add the numbers of the temporal extractors, and batch means of the others over the frames. */
enum neph_status neph_meter_finish(struct neph_meter *meter, struct neph_diag *diag);

/* The measurements so far, ordered by frame, quantity, extractor, mask. Owned by the meter. */
const struct neph_measurement *neph_meter_measurements(const struct neph_meter *meter, int *count);

/* Hand the `count` measurements over to the caller; the meter has none afterwards. Free them with
 * neph_measurements_destroy() (NULL is allowed). */
struct neph_measurement *neph_meter_release(struct neph_meter *meter, int *count);
void neph_measurements_destroy(struct neph_measurement *measurements, int count);

/* Get a map as an image for a file, after its frame (temporal: after neph_meter_finish()): channel
 * "Y", or R G B. NEPH_ERR_UNSUPPORTED: the extractor had an obstacle. */
enum neph_status neph_meter_map(const struct neph_meter *meter,
                                const struct neph_quantity *quantity,
                                const struct neph_extractor *extractor, int map,
                                struct neph_image **image, struct neph_diag *diag);

/* Whether an extractor measures a quantity, or has only an obstacle. */
bool neph_meter_has_extractor(const struct neph_meter *meter, const struct neph_quantity *quantity,
                              const struct neph_extractor *extractor);

/* Why a chosen extractor gave no numbers for a quantity; NULL: it did. */
const char *neph_meter_obstacle(const struct neph_meter *meter,
                                const struct neph_quantity *quantity,
                                const struct neph_extractor *extractor);

#endif
