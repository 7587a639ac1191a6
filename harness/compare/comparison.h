/* SPDX-License-Identifier: MIT
 *
 * Comparison of frames of any renderer with reference frames, for `neph compare` and `neph
 * flicker`.
 */
#ifndef NEPH_HARNESS_COMPARE_COMPARISON_H
#define NEPH_HARNESS_COMPARE_COMPARISON_H

#include "base/arena.h"
#include "harness/compare/findings.h"
#include "harness/compare/frame_windows.h"
#include "harness/compare/movement.h"
#include "harness/compare/partner.h"
#include "harness/compare/sequence.h"
#include "harness/compare/versus.h"
#include "metrics/error_histogram.h"
#include "metrics/largest_error.h"

#include <stdio.h>

/* A callback that receives a map of a frame, or of the sequence (frame < 0), as neph_meter_map()
 * returns it. The image is freed after the call. */
typedef enum neph_status neph_map_taker(void *context, const struct neph_map *map,
                                        const struct neph_quantity *quantity, int frame,
                                        const struct neph_image *image, struct neph_diag *diag);

struct neph_comparison {
    const struct neph_frame_source *source; /* of all frames: neph_frame_files, ...; borrowed */
    struct neph_sequence reference;         /* one frame for all, or as many frames as the test */
    bool without_reference;      /* `reference` is then a frame of a test, a constant that
                                       provides masks; only metrics that do not depend on it are
                                       kept (harness/compare/alone.h) */
    struct neph_sequence second; /* reference with another seed; empty: none */
    struct neph_sequence test;
    const struct neph_image *const *test_images; /* test frames in memory by their index, as
                                                    neph_frame_read() returns them; an element NULL:
                                                    read the file. NULL: read all; borrowed */
    struct neph_meter_choice choices[NEPH_CHOICES_MAX];
    int choice_count;
    struct neph_viewing viewing;
    bool own_frame_rate; /* use the frame rate stated by the test's frames, if any */
    const struct neph_meter_number *wanted; /* the numbers to take; only their masks and "all" are
                                               made. Ends with a NULL metric; borrowed. NULL: all */
    const char *mask;                       /* a mask that must exist; NULL: none */
    struct neph_frame_choice frame_choice;  /* part, layer and data window of all frames */
    struct neph_windows windows;            /* of the files, as neph_windows_find() found them */
    const char *mask_file;                  /* image of a user's mask, inside above 0.5; or NULL */
    bool detail_masks;                      /* include the rings at depth edges */
    const char *maps_directory;             /* output folder for the extractors' maps; or NULL */
    neph_map_taker *take_map;               /* callback for the maps; or NULL */
    void *map_context;
    int warm_up_frames;       /* skipped at the start of the sequences */
    size_t negative_allowed;  /* number of negative values allowed in a frame */
    bool by_position;         /* frame numbers may differ between sequences */
    bool allow_frozen_frames; /* frozen frames are not an error */
    bool plain;               /* no confidence intervals, which double the cost */
    bool with_histogram;      /* also the histogram of errors, with the extractor `error` */
    bool with_movement;       /* also measure the movement of each frame */
    bool quiet;               /* print no progress */
};

/* A quantity that an extractor did not measure, and the reason. */
struct neph_not_taken {
    const char *extractor; /* "everything": no extractor measures it */
    const char *quantity;
    const char *because;
};

/* The result of a comparison. Start from {0}; free with neph_compared_finish(). */
struct neph_compared {
    const struct neph_comparison *asked; /* NULL: there is no result */
    struct neph_arena arena;             /* for the texts below */
    struct neph_viewing viewing;
    int frame_count;                  /* measured frames */
    int frozen_count;                 /* of these, equal to the frame before bit for bit */
    bool interrupted;                 /* by Ctrl-C; the result covers the frames before */
    struct neph_measurements numbers; /* by frame, followed by numbers of all frames; owned */
    struct neph_findings findings;    /* owned */
    struct neph_movement movement;    /* empty unless requested; owned */
    bool has_largest_error;           /* the extractor `error` was chosen */
    struct neph_largest_error largest_error;
    struct neph_error_histogram histogram; /* empty unless requested */
    struct neph_not_taken *not_taken;
    int not_taken_count;
    /* Colour spaces of the files of converted frames; NULL: not converted */
    const char *reference_space, *test_space;
    const char *reference_video, *test_video; /* NEPH_VIDEO_ATTRIBUTE of their frames; NULL: none */
    const char **maps;                        /* file names; owned */
    int map_count;
    bool has_versus;                     /* `versus` is set */
    struct neph_differences versus;      /* difference from another test; owned */
    struct neph_partner_numbers partner; /* of another program; owned */
};

/* Run a comparison. `with_draws`: the numbers keep their bootstrap draws (metrics/metric.h).
 * `compared` has a result after success, NEPH_ERR_INTERRUPTED and NEPH_ERR_GATE (frozen frames).
 * Errors:
 *
 * - NEPH_ERR_GATE: a frame contains values that are NaN, infinite or negative; names the file.
 * - NEPH_ERR_INPUT: sizes, frame counts or kinds (linear data and display images) differ. */
enum neph_status neph_comparison_run(const struct neph_comparison *comparison, bool with_draws,
                                     struct neph_compared *compared, struct neph_diag *diag);
void neph_compared_finish(struct neph_compared *compared);

/* Run several comparisons at once, at most NEPH_COMPARISONS_MAX. `compared` has a result for each,
 * with the same numbers as a separate run. Tests, warm-up, layer and allowed negative values must
 * be equal in all. Each file is read once, and masks of a common list of references are made once.
 * The memory of the extractors is needed for all comparisons at the same time. Errors as of
 * neph_comparison_run(). */
enum { NEPH_COMPARISONS_MAX = 8 };
enum neph_status neph_comparisons_run(const struct neph_comparison *comparisons, int count,
                                      bool with_draws, struct neph_compared *compared,
                                      struct neph_diag *diag);

/* The result as an object of
 *   "version"       of neph
 *   "reference", "test"  {"first": its file (the warm-up included), "count"}; the reference is null
 *                   when there is none
 *   "warm_up_frames", "frames", "frozen", "interrupted"
 *   "window"        as neph_windows_json()
 *   "converted"     only for converted colours: {"reference", "test"}, the space of each or null
 *   "video"         only for videos: {"reference", "test"}, each a text or null: base/video.h
 *   "measurements"  array of objects as neph_measurement_json(), with "viewing"
 *   "findings"      verdicts, see harness/compare/findings.h
 *   "not_taken"     array of {"extractor", "quantity", "because"}
 *   "maps"          array of file names
 *   "largest_error" only with the extractor `error`: of radiance, {"frame", "x", "y", "channel",
 *                   "reference", "test"}; null when no frame has an error
 *   "error_histogram" only if requested: {"error", "edges", "counts", "below", "above",
 *                   "not_finite"} of metrics/error_histogram.h; bin i is from edge i to before
 *                   edge i + 1
 *   "movement"      only if requested: {"frames", "cycles"} of harness/compare/movement.h
 *   "partners"      only with --partner: array of objects as neph_partner_json()
 *   "versus", "versus_movement"  only with another test: harness/compare/versus.h
 * */
json_t *neph_compared_json(const struct neph_compared *compared);

/* Print the result of a comparison on stdout. `details`: include mask kinds with many members.
 * `all`: print every number; otherwise only the most important flicker numbers. */
void neph_comparison_print(const struct neph_compared *compared, bool details, bool all);

/* Print how frames were read where that is not obvious: data windows that differ, and videos.
 * Returns the number of lines. */
int neph_comparison_print_reading(const struct neph_compared *compared, FILE *out);

/* Print the histogram of errors in one line, if there is one. Returns the number of lines. */
int neph_comparison_print_histogram(const struct neph_compared *compared, FILE *out);

/* Write the numbers as CSV (RFC 4180) with a header line; path "-" is stdout. */
enum neph_status neph_comparison_write_csv(const char *path, const struct neph_compared *compared,
                                           struct neph_diag *diag);

/* Free the sequences; a zeroed comparison is allowed. */
void neph_comparison_finish(struct neph_comparison *comparison);

#endif
