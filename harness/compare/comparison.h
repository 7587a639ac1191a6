/* SPDX-License-Identifier: MIT
 *
 * Frames of any renderer held against reference frames: what `neph compare` and `neph flicker` do.
 */
#ifndef NEPH_HARNESS_COMPARE_COMPARISON_H
#define NEPH_HARNESS_COMPARE_COMPARISON_H

#include "base/arena.h"
#include "harness/compare/findings.h"
#include "harness/compare/movement.h"
#include "harness/compare/sequence.h"
#include "harness/compare/versus.h"

/* Takes a map that an extractor gave of a frame, or (frame < 0) of the sequence, as
 * neph_meter_map() has it; the image is gone after the call. */
typedef enum neph_status neph_map_taker(void *context, const struct neph_map *map,
                                        const struct neph_quantity *quantity, int frame,
                                        const struct neph_image *image, struct neph_diag *diag);

struct neph_comparison {
    struct neph_sequence reference; /* one frame for all, or as many as the test has */
    bool without_reference;         /* `reference` is a frame of a test: it gives masks and a
                                       constant that no metric of change depends on; only such
                                       metrics are kept (harness/compare/alone.h) */
    struct neph_sequence second;    /* the reference by another seed; empty: there is none */
    struct neph_sequence test;
    const struct neph_image *const *test_images; /* those of its frames that are in memory, by their
                                                    place, as neph_frame_read() gives them, NULL for
                                                    one to be read; borrowed. NULL: all are read */
    struct neph_meter_choice choices[NEPH_CHOICES_MAX];
    int choice_count;
    struct neph_viewing viewing;
    bool own_frame_rate; /* the rate is that of the test's frames, where they tell it */
    const struct neph_meter_number *wanted; /* the only numbers that are taken, and masks that are
                                               made beside "all"; ends with a NULL metric,
                                               borrowed. NULL: all */
    const char *mask;                       /* the one that has to be there; NULL: any */
    const char *layer;     /* whose channels are R G B Z ...; NULL: names are as they are */
    const char *mask_file; /* a picture that is above 0.5 inside a mask of the user's; or NULL */
    bool detail_masks;     /* also the rings at depth edges */
    const char *maps_directory; /* for the maps of the extractors; or NULL */
    neph_map_taker *take_map;   /* gets them, too; or NULL */
    void *map_context;
    int warm_up_frames;      /* at the start of the sequences: read by nobody */
    size_t negative_allowed; /* values below 0 that a frame may hold */
    bool by_position;        /* numbers of frames need not agree */
    bool frozen_is_fine;     /* frames equal to the one before are no reason to fail */
    bool plain;              /* numbers without intervals, which cost as much again */
    bool with_movement;      /* also a series of how much each frame moves */
    bool quiet;              /* no progress */
};

/* What was not measured of what, and why. */
struct neph_not_taken {
    const char *extractor; /* "everything": no extractor's fault */
    const char *quantity;
    const char *because;
};

/* What came of a comparison. Start from {0}; free with neph_compared_finish(). */
struct neph_compared {
    const struct neph_comparison *asked; /* NULL: nothing came of it */
    struct neph_arena arena;             /* of the texts below */
    struct neph_viewing viewing;
    int frame_count;                  /* how many were measured */
    int frozen_count;                 /* of them, bit for bit the frame before */
    bool interrupted;                 /* by Ctrl-C: what is there is of the frames before */
    struct neph_measurements numbers; /* by frame, and then of all frames; owned */
    struct neph_findings findings;    /* owned */
    struct neph_movement movement;    /* empty unless it was asked for; owned */
    struct neph_not_taken *not_taken;
    int not_taken_count;
    const char **maps; /* names of files; owned */
    int map_count;
    bool has_versus;                /* somebody set the next */
    struct neph_differences versus; /* against another test; owned */
};

/* Measure; `with_draws`: the numbers keep theirs (metrics/metric.h). `compared` has something in it
 * on success, and with NEPH_ERR_INTERRUPTED and NEPH_ERR_GATE (frozen frames) too. Errors:
 * NEPH_ERR_GATE when a frame holds values that are not finite or negative, with the file;
 * NEPH_ERR_INPUT when sizes, counts or kinds (linear data against pictures) differ. */
enum neph_status neph_comparison_run(const struct neph_comparison *comparison, bool with_draws,
                                     struct neph_compared *compared, struct neph_diag *diag);
void neph_compared_finish(struct neph_compared *compared);

/* Several at once, at most NEPH_COMPARISONS_MAX: `compared` has one for each, with the same numbers
 * as alone. Of all, tests, warm-up, layer and negative values allowed are the same; a file that
 * several name is read once, and so are the masks of one list of references made. What extractors
 * keep of the frames they keep for all at a time. Errors as of one. */
enum { NEPH_COMPARISONS_MAX = 8 };
enum neph_status neph_comparisons_run(const struct neph_comparison *comparisons, int count,
                                      bool with_draws, struct neph_compared *compared,
                                      struct neph_diag *diag);

/* As an object of
 *   "version"       of neph
 *   "reference", "test"  {"first": its file (the warm-up included), "count": of all}; the reference
 *                   is null where there is none
 *   "warm_up_frames", "frames", "frozen", "interrupted"
 *   "measurements"  array of objects as neph_measurement_json(), with "viewing"
 *   "findings"      verdicts, see harness/compare/findings.h
 *   "not_taken"     array of {"extractor", "quantity", "because"}
 *   "maps"          array of file names
 *   "movement"      only where it was asked for: {"frames", "cycles"} of harness/compare/movement.h
 *   "versus", "versus_movement"  only when there is another test: harness/compare/versus.h */
json_t *neph_compared_json(const struct neph_compared *compared);

/* Print what came of a comparison on stdout. `details`: masks of which there are many too. `all`:
 * every number, else of flicker those that stand for the rest. */
void neph_comparison_print(const struct neph_compared *compared, bool details, bool all);

/* Write the numbers as CSV (RFC 4180), a line of names first; "-" is stdout. */
enum neph_status neph_comparison_write_csv(const char *path, const struct neph_compared *compared,
                                           struct neph_diag *diag);

/* Free the sequences; a zeroed comparison is fine. */
void neph_comparison_finish(struct neph_comparison *comparison);

#endif
