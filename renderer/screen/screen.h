/* SPDX-License-Identifier: MIT
 *
 * What a renderer can do for solids with nothing but its picture: a G-buffer of the scene (depth,
 * normal, base colour, direct light), and passes that look at that alone. Each pass is a shader
 * (renderer/shaders/screen_*.comp), a row of the table of passes, and its settings.
 */
#ifndef NEPH_RENDERER_SCREEN_SCREEN_H
#define NEPH_RENDERER_SCREEN_SCREEN_H

#include "base/image.h"
#include "renderer/screen/options.h"
#include "renderer/vulkan.h"
#include "scenes/scene.h"

#define NEPH_SCREEN_PASSES_MAX 16

/* One pass; the table ends with a NULL name. One that is given targets reads `from`, writes `to`
 * and in `before` has what that was in the frame before; one of several turns reads `from` in the
 * first and writes `to` and the target behind it by turns. */
struct neph_screen_pass {
    const char *name, *note;
    struct {
        const char *name;
        const uint32_t *code;
        size_t code_bytes;
    } shader;
    int settings[2];        /* on where both are not 0; -1: always */
    int resolution;         /* the setting of it; 0: all pixels */
    bool makes_whole;       /* from half that resolution to all pixels */
    unsigned reads, writes; /* targets, a bit each */
    unsigned from, to, before;
    unsigned turn;     /* the number of the first */
    int turns_setting; /* how many there are; 0: one */
};

extern const struct neph_screen_pass neph_screen_passes[];

/* What targets are called. */
extern const char *const neph_screen_targets[];

bool neph_screen_is_on(const struct neph_screen_pass *pass, const struct neph_settings *settings);

/* The targets of the passes that are on, a bit each. */
unsigned neph_screen_targets_used(const struct neph_settings *settings);

/* False, with the reason in words: media, which the screen does not see. */
bool neph_screen_can(const struct neph_scene *scene, char *reason, size_t reason_size);

struct neph_screen_params {
    struct neph_settings settings; /* of neph_screen_options */
    int width_px, height_px;
};

struct neph_screen_stats {
    double gpu_s[NEPH_SCREEN_PASSES_MAX]; /* by pass; 0: off, NaN: the device has no clock */
};

/* Pictures of one scene, one after the other. For _destroy, of which NULL is fine. Errors as of
 * neph_gpu_scene_create(). */
struct neph_screening;
enum neph_status neph_screening_create(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                       const struct neph_screen_params *params,
                                       struct neph_screening **screen, struct neph_diag *diag);
void neph_screening_destroy(struct neph_screening *screen);

/* The picture of a frame of the scene, which is the one that it was made for, over time or at any
 * frame of it. Channels, where their pass is on:
 *   R G B          with everything
 *   transmittance  1
 *   Z              as in base/image.h
 *   direct.R/G/B   without indirect light
 *   ao.R/G/B       share of the hemisphere that is open, 1 for the sky
 *   diffuse_indirect.R/G/B, glossy_indirect.R/G/B
 *                  what a white surface and a white metal reflect of other surfaces
 *   diffuse_open, glossy_open
 *                  and of a sky of radiance 1
 * `image`, `stats`: NULL is fine. NEPH_ERR_ENGINE: the device was lost. */
enum neph_status neph_screening_frame(struct neph_screening *screen, const struct neph_scene *scene,
                                      double frame, struct neph_image **image,
                                      struct neph_screen_stats *stats, struct neph_diag *diag);

/* A target of the last picture, four numbers a pixel, row by row (of those that have one: four
 * times the same), for CPU references. What passes at half resolution write lies in its upper
 * left. */
enum neph_status neph_screening_read(struct neph_screening *screen, int target, float *texels,
                                     struct neph_diag *diag);

#endif
