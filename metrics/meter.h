/* SPDX-License-Identifier: MIT
 *
 * The meter: chosen extractors over frames and masks, pair by pair, each frame read once. The
 * numbers of a frame are there when neph_meter_frame() returns, those of the sequence after
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

/* A number of some mask, by their names. */
struct neph_meter_number {
    const char *metric, *mask;
};

struct neph_meter_params {
    const struct neph_meter_choice *choices;
    int choice_count;
    struct neph_viewing viewing;
    const struct neph_mask *const *masks; /* of the size of the frames; borrowed for the life; the
                                             first is "all": numbers of a whole frame stand there */
    int mask_count;
    const struct neph_meter_number *wanted; /* the only ones that are taken, and the same as among
                                               all; ends with a NULL metric, borrowed for the life.
                                               NULL: all */
    int frame_count; /* of neph_meter_frame() to come; 0: not known, and what needs it says so */
    bool intervals;  /* bootstrap each number that allows it; costs as much as the numbers do */
    bool draws; /* with intervals: keep the draws of numbers of a sequence, or of its only frame,
                   8 KB each */
};

struct neph_meter;

/* Whether a list of wanted numbers has one of that metric and mask; NULL for any. A list NULL has
 * all. */
bool neph_meter_wants(const struct neph_meter_number *wanted, const char *metric, const char *mask);

/* Params need only live for the call, but for masks and wanted. Errors: NEPH_ERR_INPUT for a
 * viewing condition out of range. */
enum neph_status neph_meter_create(const struct neph_meter_params *params,
                                   struct neph_meter **meter, struct neph_diag *diag);

/* NULL is fine. */
void neph_meter_destroy(struct neph_meter *meter);

/* Measure every quantity that both frames have; `reference_second` may be NULL. Frames come in
 * order; all have the size and the quantities of the first. Bad pixels (not finite) are counted and
 * make what looks at them undefined; they are never skipped. NEPH_ERR_INPUT: sizes differ.
 * NEPH_ERR_INTERRUPTED. A frame that fails leaves no number. */
enum neph_status neph_meter_frame(struct neph_meter *meter, const struct neph_image *reference,
                                  const struct neph_image *reference_second,
                                  const struct neph_image *test, struct neph_diag *diag);

/* The numbers of the temporal extractors, and batch means of the others over the frames. */
enum neph_status neph_meter_finish(struct neph_meter *meter, struct neph_diag *diag);

/* What was measured so far, in order: by frame, quantity, extractor, mask. Owned by the meter. */
const struct neph_measurement *neph_meter_measurements(const struct neph_meter *meter, int *count);

/* The measurements, `count` of them, for the caller: the meter then has none. Free them with
 * neph_measurements_destroy(). */
struct neph_measurement *neph_meter_release(struct neph_meter *meter, int *count);
void neph_measurements_destroy(struct neph_measurement *measurements, int count); /* NULL is fine */

/* A map that can be shown, after its frame (temporal: after _finish), as an image for a file:
 * channel "Y", or R G B. NEPH_ERR_UNSUPPORTED when the extractor had an obstacle. */
enum neph_status neph_meter_map(const struct neph_meter *meter,
                                const struct neph_quantity *quantity,
                                const struct neph_extractor *extractor, int map,
                                struct neph_image **image, struct neph_diag *diag);

/* Whether an extractor is at work on a quantity, or would be but for an obstacle. */
bool neph_meter_takes(const struct neph_meter *meter, const struct neph_quantity *quantity,
                      const struct neph_extractor *extractor);

/* Why a chosen extractor gave nothing for a quantity; NULL when it did. */
const char *neph_meter_obstacle(const struct neph_meter *meter,
                                const struct neph_quantity *quantity,
                                const struct neph_extractor *extractor);

#endif
