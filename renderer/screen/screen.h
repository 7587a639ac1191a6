/* SPDX-License-Identifier: MIT
 *
 * Screen-space passes for solids: a G-buffer of the scene (depth, normal, base colour, direct
 * light), and passes that read only it. Each pass is a shader (renderer/shaders/screen_*.comp), a
 * row of the table of passes, and its settings.
 */
#ifndef NEPH_RENDERER_SCREEN_SCREEN_H
#define NEPH_RENDERER_SCREEN_SCREEN_H

#include "base/image.h"
#include "renderer/screen/options.h"
#include "renderer/vulkan.h"
#include "scenes/scene.h"

#define NEPH_SCREEN_PASSES_MAX 16

/* One pass; the table ends with a NULL name. Targets of a pass: `from` is read, `to` is written,
 * `before` is the previous frame's result. With several turns the first reads `from`, and results
 * alternate between `to` and the target after it. */
struct neph_screen_pass {
    const char *name, *note;
    struct {
        const char *name;
        const uint32_t *code;
        size_t code_bytes;
    } shader;
    int settings[2];        /* on if both are not 0; -1: always on */
    int resolution;         /* its resolution setting; 0: full resolution */
    bool makes_whole;       /* upsamples from half resolution to all pixels */
    unsigned reads, writes; /* targets, a bit each */
    unsigned from, to, before;
    unsigned turn;     /* index of the first turn */
    int turns_setting; /* setting with the number of turns; 0: one */
};

extern const struct neph_screen_pass neph_screen_passes[];

/* Names of the targets. */
extern const char *const neph_screen_targets[];

bool neph_screen_is_on(const struct neph_screen_pass *pass, const struct neph_settings *settings);

/* The targets of all enabled passes, a bit each. */
unsigned neph_screen_targets_used(const struct neph_settings *settings);

/* False, with the reason as text: scenes with media, which the passes do not support. */
bool neph_screen_can_render(const struct neph_scene *scene, char *reason, size_t reason_size);

struct neph_screen_params {
    struct neph_settings settings; /* of neph_screen_options */
    int width_px, height_px;
};

struct neph_screen_stats {
    double gpu_s[NEPH_SCREEN_PASSES_MAX]; /* by pass; 0: off, NaN: no clock */
};

/* Consecutive frames of one scene. Free with _destroy; NULL is fine there. Errors as of
 * neph_gpu_scene_create(). */
struct neph_screen_renderer;
enum neph_status neph_screen_renderer_create(struct neph_vulkan *vulkan,
                                             const struct neph_scene *scene,
                                             const struct neph_screen_params *params,
                                             struct neph_screen_renderer **screen,
                                             struct neph_diag *diag);
void neph_screen_renderer_destroy(struct neph_screen_renderer *screen);

/* Render a frame of the animated scene for which the passes were created, or of its state at any
 * frame. Channels, if their pass is on:
 *
 *   R G B           total radiance
 *   transmittance   1
 *   Z               as in base/image.h
 *   direct.R/G/B    without indirect light
 *   ao.R/G/B        open fraction of the hemisphere, 1 for the sky
 *   diffuse_indirect.R/G/B, glossy_indirect.R/G/B
 *                   light of other surfaces reflected by a white surface and by white metal
 *   diffuse_open, glossy_open
 *                   the same for a sky of radiance 1
 *
 * `image`, `stats`: NULL is fine. NEPH_ERR_ENGINE: the device was lost. */
enum neph_status neph_screen_renderer_frame(struct neph_screen_renderer *screen,
                                            const struct neph_scene *scene, double frame,
                                            struct neph_image **image,
                                            struct neph_screen_stats *stats,
                                            struct neph_diag *diag);

/* Read a target of the last frame for CPU references: four values a pixel, row by row (targets with
 * one value repeat it four times). Results of passes at half resolution are in the upper left. */
enum neph_status neph_screen_renderer_read(struct neph_screen_renderer *screen, int target,
                                           float *texels, struct neph_diag *diag);

#endif
