/* SPDX-License-Identifier: MIT
 *
 * The post-processing chain between a rendered frame and the display, on a Vulkan device. A list of
 * stages in a fixed order, each on or off; the last enabled stage writes the result. Takes frames
 * of any renderer.
 */
#ifndef NEPH_RENDERER_POST_CHAIN_H
#define NEPH_RENDERER_POST_CHAIN_H

#include "base/image.h"
#include "renderer/post/options.h"

#include <stdint.h>

#define NEPH_POST_STAGES_MAX 16

struct neph_vulkan;

/* The passes of a chain. Each has one or two stages, which are switched together. */
enum neph_post_pass {
    NEPH_POST_EXPOSURE,
    NEPH_POST_BLOOM,
    NEPH_POST_TONE_MAPPING,
    NEPH_POST_FXAA,
    NEPH_POST_UPSCALE,
    NEPH_POST_SHARPENING,
    NEPH_POST_SECONDARY_UPSCALE,
    NEPH_POST_PASS_COUNT,
};

/* Their names, NULL-terminated. */
extern const char *const neph_post_pass_names[NEPH_POST_PASS_COUNT + 1];

/* The setting that switches a pass on. */
int neph_post_switch_setting(enum neph_post_pass pass);

/* The order of passes; missing ones are off. */
struct neph_post_order {
    int count;
    enum neph_post_pass passes[NEPH_POST_PASS_COUNT];
};

/* All passes, in the order of the enumeration. */
struct neph_post_order neph_post_usual_order(void);

/* The reason why an order is invalid; NULL: valid. `*at`: index of the pass that comes too late. */
const char *neph_post_order_fault(const struct neph_post_order *order, int *at);

/* One stage; the table ends with a NULL name. */
struct neph_post_stage {
    const char *name, *note;
    enum neph_post_pass pass;
    struct {
        const char *name;
        const uint32_t *code;
        size_t code_bytes;
    } shader;
    int settings[2]; /* on if both are not 0; may be equal */
    enum {
        NEPH_POST_MAKES_PICTURE,   /* of the size of its input */
        NEPH_POST_MAKES_LARGER,    /* of the display's size */
        NEPH_POST_MAKES_TABLE,     /* POST_LUT_SIDE^3 colours */
        NEPH_POST_MAKES_HISTOGRAM, /* of the image; a thread counts POST_METER_PIXELS pixels */
        NEPH_POST_MAKES_EXPOSURE,  /* from the histogram */
        NEPH_POST_MAKES_PYRAMID,   /* one level per dispatch, the finest first */
        NEPH_POST_MAKES_BLOOM,     /* one level per dispatch, the image last */
    } makes;
    int filter, percent; /* settings of stages that make an image of the display's size */
};

extern const struct neph_post_stage neph_post_stages[];

/* Whether a stage is on. */
bool neph_post_is_on(const struct neph_post_stage *stage, const struct neph_settings *settings);

/* The enabled stages in order, and their number. `order` NULL: the usual order. */
int neph_post_sequence(const struct neph_post_order *order, const struct neph_settings *settings,
                       const struct neph_post_stage *sequence[NEPH_POST_STAGES_MAX]);

/* Change the size of a window to the size of frames that the chain enlarges to it: by the percents
 * of the enlarging stages, rounded up. */
void neph_post_frame_size(const struct neph_post_order *order, const struct neph_settings *settings,
                          int *width_px, int *height_px);

/* Whether the result is display-referred: a value of 1 is the display's white. */
bool neph_post_is_displayed(const struct neph_settings *settings);

/* Check that settings are compatible: NEPH_ERR_USAGE names those that are not. */
enum neph_status neph_post_check(const struct neph_settings *settings, struct neph_diag *diag);

/* State of automatic exposure from frame to frame. Zero-initialise it for a sequence. */
struct neph_exposure_state {
    bool is_open;      /* a frame was metered */
    double adapted_ev; /* log2 of the luminance that exposure has adapted to */
};

struct neph_post_params {
    struct neph_settings settings;       /* of neph_post_options */
    const struct neph_post_order *order; /* borrowed; NULL: the usual order */
    int frame;                           /* seed of the grain, with `seed` */
    uint64_t seed;
    double step_s;           /* time since the previous frame, >= 0 */
    int width_px, height_px; /* of the window that stages enlarge to; 0: by their percents */
    struct neph_exposure_state *eye; /* of the sequence, borrowed; NULL: no previous frame */
    /* For measurements of time: extra runs of a stage before the first one, with discarded results.
     * They keep the GPU busy between two frames, so that its clock does not drop. */
    int warm_up_runs;
};

struct neph_post_stats {
    double gpu_s[NEPH_POST_STAGES_MAX]; /* by stage; 0: off, NaN: no clock */
    double metered_ev, adapted_ev;      /* log2 of luminance; NaN without automatic exposure */
};

/* Run the channels R G B of `frame` through the chain. `*made` is a new image with the encoded R G
 * B of the last stage, the frame's attributes and, if the sizes are equal, its depth, motion and
 * masks; free it with neph_image_destroy(). `stats`: NULL is fine. NEPH_ERR_INPUT: the frame has no
 * R G B; the image would be too large. NEPH_ERR_UNSUPPORTED: larger than the device allows.
 * NEPH_ERR_ENGINE: the device was lost. */
enum neph_status neph_post_run(struct neph_vulkan *vulkan, const struct neph_post_params *params,
                               const struct neph_image *frame, struct neph_image **made,
                               struct neph_post_stats *stats, struct neph_diag *diag);

#endif
