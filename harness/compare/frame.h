/* SPDX-License-Identifier: MIT
 *
 * Reading of a frame of any renderer from an OpenEXR or PNG file.
 */
#ifndef NEPH_HARNESS_COMPARE_FRAME_H
#define NEPH_HARNESS_COMPARE_FRAME_H

#include "base/image_window.h"
#include "base/oiio_server.h"
#include "harness/compare/clips.h"

/* Attribute of a frame of a sequence: its frame rate in Hz. */
#define NEPH_FRAME_RATE_ATTRIBUTE "neph.frame_rate_hz"

/* Attribute of an image for a display (`neph post`): "sRGB", or "PQ" for an HDR display. Its values
 * are the linear light that the display emits; 1 is its white, or an HDR display's peak. */
#define NEPH_DISPLAY_ATTRIBUTE "neph.display"

/* The frame rate that the file of a frame states: NEPH_FRAME_RATE_ATTRIBUTE, else OpenEXR's
 * framesPerSecond. NaN: the file states none. */
double neph_frame_rate_hz(const struct neph_image *image);

/* What to take of a file. */
struct neph_frame_choice {
    /* Name or number of a part of an OpenEXR file with several (base/exr.h). NULL: its only part
     * with colour. */
    const char *part;
    /* Its channels "<layer>.R" become R, and so on; other colours are dropped. NULL: names are
     * unchanged. */
    const char *layer;
    /* Full name of the channel that becomes Z, before a layer is taken. A file without it keeps its
     * Z. NULL: Z. */
    const char *depth;
    /* After the gate, other colour spaces become linear Rec. 709 (base/colour_convert.h). */
    bool convert;
    /* Names of colour spaces beside those of base/colour_convert.h, for `convert`. NULL: none. */
    const struct neph_colour_source *colours;
    /* Open files with several frames. NULL: a file is opened for each frame, and read from its
     * start. */
    struct neph_clips *clips;
    /* The process that reads formats of OpenImageIO. NULL: one is started for each file. */
    struct neph_oiio_server *server;
    /* The data window of the frame (harness/compare/frame_windows.h): pixels that the file does not
     * have are 0, in depth the sky, and transparent. Size 0: the file's. */
    struct neph_window window;
};

/* Read an OpenEXR or PNG file, recognized by its content, or a frame of an animated PNG
 * (harness/compare/clips.h), and check it with gate G0
 * (metrics/validity.h); the diag names the file.
 *
 * - Display images have the attribute "encoding": "sRGB" for a PNG, else the value of
 *   NEPH_DISPLAY_ATTRIBUTE.
 * - `choice` NULL: no part, no layer.
 * - Other names of colours (base/colour_names.h) become R, G and B; one channel Y, L or R without
 *   other colours is a grey image. X, Y and Z beside R G B are a vector and become vector.X, ...;
 *   without R G B they are CIE XYZ with white D65 if `choice->convert` is true.
 * - A depth of 0, 65504, 65535, 1e9, or at least 1e10 is the sky and becomes +inf.
 * - Unknown channels with NaN or infinite values (identifiers) are removed.
 * - `negative_allowed`: accepted number of negative values, as for neph_validity_gate().
 *
 * NEPH_ERR_GATE: a value is NaN or infinite (depth may be +inf), or too many are negative.
 * NEPH_ERR_INPUT: another or damaged format, no channel of the depth's name, colours that are not
 * Rec.709 (such as CIE XYZ), or another display window than that of `choice->window`.
 * NEPH_ERR_NOT_FOUND, NEPH_ERR_IO. */
enum neph_status neph_frame_read(const char *path, const struct neph_frame_choice *choice,
                                 size_t negative_allowed, struct neph_image **image,
                                 struct neph_diag *diag);

/* The steps of neph_frame_read() after the file: make a frame of `image`, which is consumed. `path`
 * names it in messages. Errors as of neph_frame_read(). */
enum neph_status neph_frame_make(const char *path, struct neph_image *image,
                                 const struct neph_frame_choice *choice, size_t negative_allowed,
                                 struct neph_image **frame, struct neph_diag *diag);

/* Read the image of a mask, which may have the data window of a frame or of the file: it is placed
 * in `choice->window` if its display window is that of the frames. The layer is not used. */
enum neph_status neph_frame_read_mask(const char *path, const struct neph_frame_choice *choice,
                                      struct neph_image **image, struct neph_diag *diag);

/* As neph_frame_read(), but depth keeps the values of the file, all channels are kept, and the data
 * window is the file's. */
enum neph_status neph_frame_read_as_written(const char *path,
                                            const struct neph_frame_choice *choice,
                                            size_t negative_allowed, struct neph_image **image,
                                            struct neph_diag *diag);

/* Where the frames of a comparison come from. Functions are called by several threads. */
struct neph_frame_source {
    const void *context;
    /* As neph_frame_read(). */
    enum neph_status (*read)(const void *context, const char *path,
                             const struct neph_frame_choice *choice, size_t negative_allowed,
                             struct neph_image **image, struct neph_diag *diag);
    /* As neph_frame_read_mask(); NULL: there are no such masks. */
    enum neph_status (*read_mask)(const void *context, const char *path,
                                  const struct neph_frame_choice *choice, struct neph_image **image,
                                  struct neph_diag *diag);
};

/* The files of the paths. */
extern const struct neph_frame_source neph_frame_files;

#endif
