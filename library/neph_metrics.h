/* SPDX-License-Identifier: MIT
 *
 * libneph_metrics: the numbers of `neph compare` and `neph flicker` for images in memory.
 *
 *     nephm_image_create(), nephm_image_set_...()    images
 *     nephm_task_create(), nephm_task_set()          what to measure
 *     nephm_task_run()                               numbers
 *
 * The numbers are those that the commands print for files with the same values, to the bit.
 *
 * - A function that can fail returns a status, 0 without an error, and then has the reason in
 *   `error`, which may be NULL. Results are set on success only, except where it is said.
 * - Handles belong to the caller, and are destroyed by it; NULL may be destroyed.
 * - Different handles may be used on different threads at the same time. An image may be used by
 *   several tasks at the same time, while it is not changed. A task measures on as many threads as
 *   there are processors, or as NEPH_THREADS says; the numbers do not depend on it.
 * - Nothing is written to stdout or stderr, no file is opened but those that options name, no
 *   signal is handled and the process is never ended.
 *
 * Names and meanings of metrics, masks, quantities and channels: `neph metrics`, docs/metrics.md.
 */
#ifndef NEPH_METRICS_H
#define NEPH_METRICS_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define NEPHM_API __attribute__((visibility("default")))
#else
#define NEPHM_API
#endif

/* The version of the interface in this header. Programs built with another major version must be
 * built again. */
enum { NEPHM_VERSION_MAJOR = 0, NEPHM_VERSION_MINOR = 1 };

/* Kinds of errors. Further ones may be added. */
enum nephm_status {
    NEPHM_OK = 0,
    NEPHM_ERR_USAGE = 1,       /* an option, a metric or an argument is not valid */
    NEPHM_ERR_INPUT = 2,       /* the images do not fit each other, or lack what is needed */
    NEPHM_ERR_NOT_FOUND = 3,   /* a file that an option names does not exist */
    NEPHM_ERR_IO = 4,          /* it cannot be read */
    NEPHM_ERR_MEMORY = 5,      /* an allocation failed */
    NEPHM_ERR_UNSUPPORTED = 7, /* a metric or mask that was asked for cannot be measured here */
    NEPHM_ERR_GATE = 11,       /* a value is NaN, infinite or negative; or frames are frozen */
    NEPHM_ERR_INTERNAL = 12,   /* a fault of this library */
};

/* The reason of an error: one or two sentences in UTF-8, what is wrong and the way out. */
struct nephm_error {
    char text[2048];
};

/* The version of the library in use, such as "0.1.0". */
NEPHM_API const char *nephm_version(void);

/* A short name of a status, such as "input". */
NEPHM_API const char *nephm_status_name(int status);

/* ---- images ---------------------------------------------------------------------------------- */

/* Named planes of 32-bit floats, row 0 on top. R G B are radiance, scene-linear Rec.709
 * [W m^-2 sr^-1 or any unit]; R alone is grey. Z is linear eye depth [m], +inf the sky. Further
 * channels as in EXR files that neph writes: volume.R, transmittance.R, motion.x, mask.NAME, ... */
typedef struct nephm_image nephm_image;

/* An image without channels, of 1 to 16384 px a side. NEPHM_ERR_INPUT: another size. */
NEPHM_API int nephm_image_create(int width_px, int height_px, nephm_image **image,
                                 struct nephm_error *error);
NEPHM_API void nephm_image_destroy(nephm_image *image);

/* Set a channel, or replace it. The sample at column x of row y is the float at `samples`
 * + x * pixel_stride + y * row_stride bytes; strides may be negative, or 0. The samples are copied.
 * NEPHM_ERR_USAGE: the name is empty or longer than 255 bytes. */
NEPHM_API int nephm_image_set_floats(nephm_image *image, const char *channel, const void *samples,
                                     ptrdiff_t pixel_stride_bytes, ptrdiff_t row_stride_bytes,
                                     struct nephm_error *error);

/* As nephm_image_set_floats(), from codes of sRGB of 8 bits (code_bytes 1) or 16 bits (2): the
 * image is for a display, and has the values that a PNG file with these codes has. Channels of such
 * an image are R, G and B. NEPHM_ERR_USAGE: another size of codes. */
NEPHM_API int nephm_image_set_srgb_codes(nephm_image *image, const char *channel, const void *codes,
                                         int code_bytes, ptrdiff_t pixel_stride_bytes,
                                         ptrdiff_t row_stride_bytes, struct nephm_error *error);

/* Set a text, as of the header of an EXR file: "neph.frame_rate_hz", "neph.cycle", "encoding"
 * ("sRGB": values are linear light relative to the white of a display, not radiance). */
NEPHM_API int nephm_image_set_text(nephm_image *image, const char *name, const char *value,
                                   struct nephm_error *error);

/* ---- tasks ----------------------------------------------------------------------------------- */

/* What to measure. */
typedef struct nephm_task nephm_task;

enum nephm_task_kind {
    NEPHM_COMPARE = 0, /* the error of each frame, as `neph compare` */
    NEPHM_FLICKER = 1, /* unwanted change of a sequence over time, as `neph flicker` */
};

/* A task with the defaults of the command. NEPHM_ERR_USAGE: another kind. */
NEPHM_API int nephm_task_create(int kind, nephm_task **task, struct nephm_error *error);
NEPHM_API void nephm_task_destroy(nephm_task *task);

/* Set an option of the command, by its name without the dashes. Options that may be given several
 * times add to what is set. NEPHM_ERR_USAGE: no such option, or a value out of its range.
 *
 *   metric       extractors, some of their metrics, or "all", with commas between them
 *   set          EXTRACTOR:KEY=VALUE
 *   mask         only this mask, by its name
 *   rings        "on": also the rings at depth edges
 *   warm-up      number of frames to leave out at the start
 *   fps, ppd, exposure, white    viewing: frames per second, pixels per degree, EV, cd/m2
 *   negative-ok, frozen-ok       "on": no error
 */
NEPHM_API int nephm_task_set(nephm_task *task, const char *option, const char *value,
                             struct nephm_error *error);

/* ---- numbers --------------------------------------------------------------------------------- */

/* What a task measured. */
typedef struct nephm_result nephm_result;

/* Measure. `reference_count` is 1 (one frame for all), `test_count`, or for NEPHM_FLICKER 0: no
 * reference. The images are borrowed during the call; they all have the size and the channels of
 * the first of their sequence. Several calls of one task are independent.
 *
 * NEPHM_ERR_GATE because of frozen frames also sets `*result`. */
NEPHM_API int nephm_task_run(const nephm_task *task, const nephm_image *const *reference,
                             size_t reference_count, const nephm_image *const *test,
                             size_t test_count, nephm_result **result, struct nephm_error *error);
NEPHM_API void nephm_result_destroy(nephm_result *result);

/* A number. All texts belong to the result. */
struct nephm_number {
    const char *extractor, *metric, *quantity, *mask, *unit;
    int frame; /* index in the sequence, without those left out; -1: all frames together */
    int is_defined;
    const char *undefined_because; /* NULL: it is defined */
    double value;                  /* NaN: undefined */
    double low, high;              /* 95 % interval; NaN: none */
};

/* The number of numbers, by frame, and then those of all frames. */
NEPHM_API size_t nephm_result_count(const nephm_result *result);

/* The number at `index`. NEPHM_ERR_USAGE: there is none. */
NEPHM_API int nephm_result_number(const nephm_result *result, size_t index,
                                  struct nephm_number *number, struct nephm_error *error);

/* The whole result as the JSON of the command's --json, UTF-8. It belongs to the result. */
NEPHM_API const char *nephm_result_json(const nephm_result *result);

#ifdef __cplusplus
}
#endif

#endif
