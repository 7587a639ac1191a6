/* SPDX-License-Identifier: MIT
 *
 * The table of extractors: what turns frames into maps. In the manner of libvmaf's feature
 * extractors, one file per extractor, options as a table, pooling elsewhere. To add one, write its
 * file in extractors/ with one table `neph_extractor_NAME` and add a line to
 * extractors/extractors.h; the command line, the help, masks, intervals, JSON, CSV and pictures
 * follow.
 *
 * The life of one: init; for each frame, in order when `temporal`, extract; then flush when
 * `temporal` and there is one; close, always, also after a failure of init. After each extract
 * (temporal: after the last) the maps are read, by strips of rows and from several threads.
 */
#ifndef NEPH_METRICS_EXTRACTOR_H
#define NEPH_METRICS_EXTRACTOR_H

#include "base/arena.h"
#include "base/option.h"
#include "metrics/metric.h"

#define NEPH_MAPS_MAX 144

/* How the frames are meant to be looked at. Part of every record: another display, other numbers.
 */
struct neph_viewing {
    double frame_rate_hz;     /* of the display, never the speed of rendering */
    double pixels_per_degree; /* 67.02: 0.7 m from a screen 0.7 m and 3840 px wide */
    double exposure_ev;       /* display value = 2^exposure_ev * radiance; frozen per scene */
    double white_cd_per_m2;   /* luminance of the display value 1 */
};

#define NEPH_VIEWING_DEFAULTS                                                                      \
    ((struct neph_viewing){.frame_rate_hz = 60.0,                                                  \
                           .pixels_per_degree = 67.0206432765823,                                  \
                           .exposure_ev = 0.0,                                                     \
                           .white_cd_per_m2 = 100.0})

struct neph_pair_codes; /* extractors/pair_codes.h */

/* For the hook `bound` of an extractor of display values. */
static inline enum neph_display_bound neph_bound_is_white(const struct neph_settings *settings)
{
    (void)settings;
    return NEPH_BOUND_WHITE;
}

/* A frame of the test beside the same frame of the reference, linear data; all pointers are
 * borrowed for the call. Every sample of the planes is finite, but for depth, where +inf is the
 * sky: bad frames do not come this far. */
struct neph_frame_pair {
    const struct neph_quantity *quantity;
    int width_px, height_px, plane_count;
    const float *reference[3], *test[3];
    const float *reference_second[3]; /* the reference by another seed, or (lag.old=second) without
                                         its step; NULL: there is none */
    const struct neph_image *reference_image, *test_image; /* their further layers */
    double scene_mean; /* mean luminance (depth: mean over the solid) of the whole reference; NaN
                          when it is not above 0 */
    int frame;         /* 0, 1, 2 ... of the measured frames; no frame is left out */
    int frame_count;   /* how many there will be; 0: nobody knows */
    const struct neph_viewing *viewing;
    struct neph_pair_codes *codes; /* of this pair, for extract() */
    struct neph_arena *memory;     /* of the extractor at work: freed after its close(); for init()
                                      and extract() */
};

/* A map that an extractor can give. */
struct neph_map {
    const char *name; /* of its file under --maps; NULL: a step on the way, not for showing */
    const char *unit; /* NULL: of the quantity */
    int plane_count;  /* 1, or 0: as many as the quantity has */
    bool is_signed;   /* shown from -scale to scale, else from 0 to scale */
    double scale;     /* of its picture, fixed, so that two nights can be compared; in display
                         values (the picture is of 2^exposure_ev * value) when the unit is NULL */
    const char *empty_because; /* what it means when it has no value in a mask; NULL: no more is
                                  known */
    unsigned quantities; /* neph_quantity_bit: only of these; 0: of all that the extractor takes */
};

struct neph_extractor {
    const char *name;
    const char *help;    /* one line */
    const char *source;  /* paper and equation, or the program whose definition it is */
    const char *details; /* lines for who asks for this one: signals, layers that are read,
                            conventions; NULL: the metrics say it all */
    unsigned quantities; /* neph_quantity_bit: of which it is taken */
    bool temporal;
    bool pointwise; /* a value depends on its own pixel alone: a bad pixel spoils only masks with it
                     */
    bool costly;    /* left out unless it is asked for by name */
    const struct neph_option *options; /* ends with a NULL name */
    const struct neph_metric *metrics; /* ends with a NULL name */
    const struct neph_map *maps;
    int map_count; /* at most NEPH_MAPS_MAX */
    size_t state_size;

    /* Why it cannot be taken of these frames ("there is no second reference"), a static string, or
     * NULL when it can. NULL hook: it always can. `first` is the first frame. */
    const char *(*obstacle)(const struct neph_frame_pair *first,
                            const struct neph_settings *settings);
    /* Beyond what all is alike to it, but to its metrics in the unit of the quantity. NULL hook:
     * NEPH_BOUND_NONE. */
    enum neph_display_bound (*bound)(const struct neph_settings *settings);
    /* `state` is zeroed memory of state_size; `first` lives for this call only. NULL hook: there is
     * nothing to set up. */
    enum neph_status (*init)(void *state, const struct neph_frame_pair *first,
                             const struct neph_settings *settings, struct neph_diag *diag);
    /* Look at a frame. What `rows` needs of a frame of an extractor that is not temporal may be
     * borrowed until the next call. NEPH_ERR_GATE of a temporal one: a further layer of the frame
     * has a bad value; it is then asked for nothing more, and the words are its obstacle. */
    enum neph_status (*extract)(void *state, const struct neph_frame_pair *pair,
                                struct neph_diag *diag);
    /* After the last frame. NULL hook: nothing is left to do then. */
    enum neph_status (*flush)(void *state, struct neph_diag *diag);
    /* Write rows first_row .. first_row + row_count - 1 of a map: width values a row, planes apart.
     * A value is finite, or NaN where the map has none (outside SSIM's valid region; the sky of a
     * depth). Called from several threads; must give the same bits whatever the strips. */
    void (*rows)(const void *state, int map, int first_row, int row_count, double *const values[3]);
    /* Why a map has no value, a static string. NULL hook: its `empty_because`. */
    const char *(*empty)(const void *state, int map);
    /* A number of the whole frame or sequence. NULL when it is defined, else why it is not. */
    const char *(*scalar)(const void *state, int which, double *value);
    /* Frees what is not in the memory of the pair. NULL hook: there is nothing else. */
    void (*close)(void *state);
};

#endif
