/* SPDX-License-Identifier: MIT
 *
 * The interface of extractors, which turn frames into maps. As with libvmaf's feature extractors,
 * there is one file per extractor and a table of options; pooling is done elsewhere. To add one,
 * write a file in extractors/ with a table `neph_extractor_NAME`, and add a line to
 * extractors/extractors.h. The command line, the help, masks, intervals, JSON, CSV and map images
 * then include it.
 *
 * Order of calls: init; extract for each frame (in order if `temporal`); flush if `temporal` and
 * not NULL; close, always, also after a failure of init. After each extract (temporal: after the
 * last) the maps are read by strips of rows, from several threads.
 */
#ifndef NEPH_METRICS_EXTRACTOR_H
#define NEPH_METRICS_EXTRACTOR_H

#include "base/arena.h"
#include "base/option.h"
#include "metrics/metric.h"

#define NEPH_MAPS_MAX 144

/* The viewing conditions of the frames. They are part of every record: with another display the
 * numbers are different.
 */
struct neph_viewing {
    double frame_rate_hz;     /* refresh rate of the display, not the rendering speed */
    double pixels_per_degree; /* 67.02: 0.7 m from a screen 0.7 m and 3840 px wide */
    double exposure_ev;       /* display value = 2^exposure_ev * radiance; fixed per scene */
    double white_cd_per_m2;   /* luminance of display value 1 */
};

#define NEPH_VIEWING_DEFAULTS                                                                      \
    ((struct neph_viewing){.frame_rate_hz = 60.0,                                                  \
                           .pixels_per_degree = 67.0206432765823,                                  \
                           .exposure_ev = 0.0,                                                     \
                           .white_cd_per_m2 = 100.0})

struct neph_pair_codes; /* extractors/pair_codes.h */

/* The hook `bound` of extractors of display values. */
static inline enum neph_display_bound neph_bound_is_white(const struct neph_settings *settings)
{
    (void)settings;
    return NEPH_BOUND_WHITE;
}

/* A frame of the test with the same frame of the reference, linear data. All pointers are borrowed
 * for the call. All samples are finite, except depth, where +inf is the sky; frames with other
 * values are rejected earlier. */
struct neph_frame_pair {
    const struct neph_quantity *quantity;
    int width_px, height_px, plane_count;
    const float *reference[3], *test[3];
    const float *reference_second[3]; /* the reference with another seed, or (lag.old=second)
                                       * without its step; NULL: none */
    const struct neph_image *reference_image, *test_image; /* all layers of both */
    double scene_mean; /* mean luminance (depth: mean over solid pixels) of the whole reference; NaN
                        * if it is not above 0 */
    int frame;         /* index of the measured frame: 0, 1, 2 ..; none is left out */
    int frame_count;   /* number of frames; 0: unknown */
    const struct neph_viewing *viewing;
    struct neph_pair_codes *codes; /* codes of this pair, for extract() */
    struct neph_arena *memory;     /* memory of the current extractor, for init() and extract();
                                    * freed after its close() */
};

/* A map of an extractor. */
struct neph_map {
    const char *name;          /* file name under --maps; NULL: an intermediate map, not shown */
    const char *unit;          /* NULL: the unit of the quantity */
    int plane_count;           /* 1, or 0: as many as the quantity has */
    bool is_signed;            /* shown from -scale to scale, else from 0 to scale */
    double scale;              /* fixed end of the colour scale, equal in all runs; in display
                                * values (the map shows 2^exposure_ev * value) if the unit is
                                * NULL */
    const char *empty_because; /* meaning of a mask without a value; NULL: not known */
    unsigned quantities;       /* neph_quantity_bit: restricts the extractor's quantities; 0: no
                                * restriction */
};

struct neph_extractor {
    const char *name;
    const char *help;    /* one line */
    const char *source;  /* paper and equation, or the program that defines it */
    const char *details; /* detailed help: signals, used layers, conventions; NULL: the metrics'
                          * texts are enough */
    unsigned quantities; /* neph_quantity_bit: supported quantities */
    bool temporal;
    bool pointwise; /* a value depends only on its own pixel: a bad pixel invalidates only masks
                     * that contain it */
    bool costly;    /* runs only if named */
    const struct neph_option *options; /* ends with a NULL name */
    const struct neph_metric *metrics; /* ends with a NULL name */
    const struct neph_map *maps;
    int map_count; /* at most NEPH_MAPS_MAX */
    size_t state_size;

    /* The reason why the extractor cannot measure these frames ("there is no second reference"), a
     * static string; NULL: it can. NULL hook: it always can. `first` is the first frame. */
    const char *(*obstacle)(const struct neph_frame_pair *first,
                            const struct neph_settings *settings);
    /* The bound beyond which its metrics see no differences (except metrics in the unit of the
     * quantity). NULL hook: NEPH_BOUND_NONE. */
    enum neph_display_bound (*bound)(const struct neph_settings *settings);
    /* Set up. `state` is zeroed memory of state_size; `first` is valid only during this call. NULL
     * hook: nothing to set up. */
    enum neph_status (*init)(void *state, const struct neph_frame_pair *first,
                             const struct neph_settings *settings, struct neph_diag *diag);
    /* Process a frame. Without `temporal`, data of the frame may be borrowed until the next call,
     * for `rows`. NEPH_ERR_GATE (temporal): an extra layer of the frame has an invalid value; the
     * extractor is not called again, and the message becomes its obstacle. */
    enum neph_status (*extract)(void *state, const struct neph_frame_pair *pair,
                                struct neph_diag *diag);
    /* After the last frame. NULL hook: nothing to do. */
    enum neph_status (*flush)(void *state, struct neph_diag *diag);
    /* Write rows first_row .. first_row + row_count - 1 of a map: width values per row, in separate
     * planes. A value is finite, or NaN where the map has none (outside SSIM's valid region; the
     * sky of a depth). Called from several threads; the bits must not depend on the strips. */
    void (*rows)(const void *state, int map, int first_row, int row_count, double *const values[3]);
    /* The reason why a map has no values, a static string. NULL hook: the map's `empty_because`. */
    const char *(*empty)(const void *state, int map);
    /* Compute a number of the whole frame or sequence. Returns NULL, or the reason why the number
     * is undefined. */
    const char *(*scalar)(const void *state, int which, double *value);
    /* Free resources that are not in the pair's memory. NULL hook: there are none. */
    void (*close)(void *state);
};

#endif
