/* SPDX-License-Identifier: MIT
 *
 * The picture chain: what stands between a finished frame and the display, on a Vulkan device. A
 * list of stages in a fixed order, each on or off; the last that is on writes the picture. It takes
 * frames of any renderer.
 */
#ifndef NEPH_RENDERER_POST_CHAIN_H
#define NEPH_RENDERER_POST_CHAIN_H

#include "base/image.h"
#include "renderer/post/options.h"

#include <stdint.h>

#define NEPH_POST_STAGES_MAX 16

struct neph_vulkan;

/* What a chain is made of: each is one stage or two, which are on and off together. */
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

/* Their names, and NULL. */
extern const char *const neph_post_pass_names[NEPH_POST_PASS_COUNT + 1];

/* The setting that a pass is off without. */
int neph_post_switch(enum neph_post_pass pass);

/* Which come after which; those that are not named are off. */
struct neph_post_order {
    int count;
    enum neph_post_pass passes[NEPH_POST_PASS_COUNT];
};

/* All of them, in the order of the enumeration. */
struct neph_post_order neph_post_usual_order(void);

/* Why an order makes no sense; NULL: it does. `*at`: the pass that comes too late, of the order. */
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
    int settings[2]; /* on where both are not 0; the second may be the same */
    enum {
        NEPH_POST_MAKES_PICTURE,   /* of the size of the one before */
        NEPH_POST_MAKES_LARGER,    /* of the display's size */
        NEPH_POST_MAKES_TABLE,     /* POST_LUT_SIDE^3 colours */
        NEPH_POST_MAKES_HISTOGRAM, /* of the picture; a thread counts POST_METER_PIXELS */
        NEPH_POST_MAKES_EXPOSURE,  /* out of the histogram */
        NEPH_POST_MAKES_PYRAMID,   /* a level a run, the finest first */
        NEPH_POST_MAKES_BLOOM,     /* a level a run, the picture last */
    } makes;
    int filter, percent; /* settings of what makes a picture of the display's size */
};

extern const struct neph_post_stage neph_post_stages[];

/* Whether a stage is on. */
bool neph_post_is_on(const struct neph_post_stage *stage, const struct neph_settings *settings);

/* The stages that are on, in their order; NULL: the usual one. How many. */
int neph_post_sequence(const struct neph_post_order *order, const struct neph_settings *settings,
                       const struct neph_post_stage *sequence[NEPH_POST_STAGES_MAX]);

/* From the size of a window to that of frames which the chain enlarges to it: by the percents of
 * what enlarges, rounded up. */
void neph_post_frame_size(const struct neph_post_order *order, const struct neph_settings *settings,
                          int *width_px, int *height_px);

/* Where the picture is one for a display, values of 1 being its white. */
bool neph_post_is_displayed(const struct neph_settings *settings);

/* Whether settings make sense together: NEPH_ERR_USAGE names those that do not. */
enum neph_status neph_post_check(const struct neph_settings *settings, struct neph_diag *diag);

/* What automatic exposure remembers from a frame to the next. Zero-initialise it for a sequence. */
struct neph_post_eye {
    bool is_open;      /* it has seen a frame */
    double adapted_ev; /* log2 of the luminance that it is adapted to */
};

struct neph_post_params {
    struct neph_settings settings;       /* of neph_post_options */
    const struct neph_post_order *order; /* borrowed; NULL: the usual one */
    int frame;                           /* of the grain */
    uint64_t seed;
    double step_s;             /* since the frame before, >= 0 */
    int width_px, height_px;   /* of the window that stages enlarge to; 0: by their percents */
    struct neph_post_eye *eye; /* of the sequence, borrowed; NULL: each frame is the first */
    /* For times: runs of a stage just before the first, whose results nobody sees. What lies
     * between two pictures is no work for a GPU, and lets its clock fall. */
    int heat_runs;
};

struct neph_post_stats {
    double gpu_s[NEPH_POST_STAGES_MAX]; /* by stage; 0: off, NaN: the device has no clock */
    double metered_ev, adapted_ev;      /* log2 of luminance; NaN without automatic exposure */
};

/* The channels R G B of `frame`, through the chain. `*made` is a new image with R G B, what the
 * last stage wrote, as it is encoded, the frame's attributes and, if it has its size, its depth,
 * motion and masks; free it with neph_image_destroy(). `stats`: NULL is fine.
 * NEPH_ERR_INPUT: the frame has no R G B; the picture would be too large. NEPH_ERR_UNSUPPORTED:
 * larger than the device allows. NEPH_ERR_ENGINE: the device was lost. */
enum neph_status neph_post_run(struct neph_vulkan *vulkan, const struct neph_post_params *params,
                               const struct neph_image *frame, struct neph_image **made,
                               struct neph_post_stats *stats, struct neph_diag *diag);

#endif
