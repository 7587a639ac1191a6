/* SPDX-License-Identifier: MIT
 *
 * The passes of a frame in order, one record each: bindings, size, condition, and targets that
 * become history in the next frame. All code that runs, counts or lists passes reads these records.
 */
#ifndef NEPH_RENDERER_REALTIME_PASSES_H
#define NEPH_RENDERER_REALTIME_PASSES_H

#include "renderer/realtime/layout.h"
#include "renderer/realtime/tuning.h"

/* A setting and the choice that it must have. */
struct neph_rt_condition {
    int setting, choice;
};

struct neph_rt_pass;

enum { NEPH_RT_NEEDS_MAX = 3 };

/* A shader that includes realtime/shared/view.glsl; 64 threads a group, along x. */
struct neph_rt_shader {
    const char *name;
    const uint32_t *code;
    size_t code_bytes;
    int column;   /* texels that a thread writes, one below the other; 0: one */
    int block[2]; /* texels that a work group writes together; {0}: texels are independent */
    /* A variant needs all of these conditions; ends early with {0}, which is always false. */
    struct neph_rt_condition needs[NEPH_RT_NEEDS_MAX];
    const struct neph_rt_pass *absorbs; /* pass that a variant does as well, or NULL */
};

enum { NEPH_RT_OTHERS_MAX = 3 };

/* A target of this frame that the next frame reads under another name. */
struct neph_rt_history {
    int now, before;
};

/* Kinds of rays of a pass. */
enum neph_rt_rays {
    NEPH_RT_NO_RAYS,
    NEPH_RT_RAYS_TO_SOLIDS,     /* of one step */
    NEPH_RT_POINTS_IN_MEDIA,    /* of one step */
    NEPH_RT_RAYS_THROUGH_MEDIA, /* of all steps */
    NEPH_RT_RAYS_COUNT,
};

enum { NEPH_RT_UNLESS_MAX = 4 };

/* Targets that a pass does not touch unless one condition is true. {0} is always false. */
struct neph_rt_unused_targets {
    struct neph_rt_condition unless[NEPH_RT_UNLESS_MAX];
    uint32_t targets;
};

enum { NEPH_RT_HISTORIES_MAX = 2, NEPH_RT_UNUSED_MAX = 6, NEPH_RT_PASSES_MAX = 32 };

#define NEPH_RT_BIT(target) (1u << (target))

/* Targets from which the change around a tile is computed (gradient/change_around.glsl). */
#define NEPH_RT_CHANGE_READS                                                                       \
    (NEPH_RT_BIT(RT_SAMPLE_NOW) | NEPH_RT_BIT(RT_SAMPLE_THEN) |                                    \
     NEPH_RT_BIT(RT_SAMPLE_BEHIND_NOW) | NEPH_RT_BIT(RT_SAMPLE_BEHIND_THEN) |                      \
     NEPH_RT_BIT(RT_CHANGE_BEHIND))

struct neph_rt_pass {
    const char *name;             /* "tile index" */
    const char *note;             /* its output, in a few words */
    struct neph_rt_shader shader; /* the readable one, which the CPU reference mirrors */
    /* Faster shaders with the same results, one for each kind of device; {0}: that device runs
     * `shader`. tests/renderer/test_realtime_variants.c compares both. */
    struct neph_rt_shader variants[NEPH_RT_DEVICE_KINDS];
    struct neph_rt_condition condition; /* the pass is in the frame where this is true */
    /* The pass is skipped where one of these is true; ends early with {0}, which is always false.
     * The setting of the first one is not 0 only where a variant absorbs the pass. */
    struct neph_rt_condition done_by_other[NEPH_RT_OTHERS_MAX];
    int resolution;        /* of the texels that it writes: RT_FULL, .. */
    int unread_resolution; /* in frames with output elision (output_elision.h); 0: the same */
    bool in_quads;         /* a thread writes 2x2 texels; the first may lie one before the view */
    enum neph_rt_rays rays;
    int role; /* RT_ROLE_*, of passes that share a shader; 0: the ordinary one */
    /* Where this is true the pass runs in four phases, one for each texel of 2x2, and each phase
     * reads the results of those before: four dispatches, or one dispatch of blocks where the
     * shader has them. Else, or with NULL, one dispatch of independent texels. */
    const struct neph_rt_condition *in_colours;
    uint32_t reads, writes; /* NEPH_RT_BIT() of all targets that its shader can access */
    uint32_t replaces;      /* of the written targets those that it reads first, with an oracle */
    /* exceptions; ends early with no targets */
    struct neph_rt_unused_targets spared[NEPH_RT_UNUSED_MAX];
    struct neph_rt_history histories[NEPH_RT_HISTORIES_MAX]; /* ends early with {0, 0} */
    int picture; /* the target whose R G B are the frame after this pass; 0: none */
};

/* Each record is in the folder of its pass: realtime/FOLDER/pass.c. */
extern const struct neph_rt_pass neph_rt_scene_rays;
extern const struct neph_rt_pass neph_rt_depth_map;
extern const struct neph_rt_pass neph_rt_froxel_light;
extern const struct neph_rt_pass neph_rt_froxel_sum;
extern const struct neph_rt_pass neph_rt_tile_index;
extern const struct neph_rt_pass neph_rt_ray_march;
extern const struct neph_rt_pass neph_rt_oracle_texels;
extern const struct neph_rt_pass neph_rt_oracle_spread;
extern const struct neph_rt_pass neph_rt_oracle_pixels;
extern const struct neph_rt_pass neph_rt_gradient;
extern const struct neph_rt_pass neph_rt_change;
extern const struct neph_rt_pass neph_rt_reconstruct;
extern const struct neph_rt_pass neph_rt_atrous_1;
extern const struct neph_rt_pass neph_rt_atrous_2;
extern const struct neph_rt_pass neph_rt_atrous_4;
extern const struct neph_rt_pass neph_rt_upscale;
extern const struct neph_rt_pass neph_rt_froxel_apply;
extern const struct neph_rt_pass neph_rt_lamp_peaks;
extern const struct neph_rt_pass neph_rt_compose;
extern const struct neph_rt_pass neph_rt_solid_motion;
extern const struct neph_rt_pass neph_rt_taa;
extern const struct neph_rt_pass neph_rt_taau;
extern const struct neph_rt_pass neph_rt_locks;
extern const struct neph_rt_pass neph_rt_sharpen;

/* All passes in the order of a frame. Ends with NULL; at most NEPH_RT_PASSES_MAX. */
extern const struct neph_rt_pass *const neph_rt_passes[];

/* Index of a pass in neph_rt_passes; -1: no pass has this name. */
int neph_rt_pass_index(const char *name);

const char *neph_rt_target_name(int target);

bool neph_rt_is_condition_met(const struct neph_gpu_view *view, struct neph_rt_condition condition);

/* Whether a pass is skipped because another pass computes its output or the output is known. */
bool neph_rt_is_pass_skipped(const struct neph_gpu_view *view, const struct neph_rt_pass *pass);

/* The targets that a pass reads or writes with the settings of a view: all that are bound to it. */
uint32_t neph_rt_targets_touched(const struct neph_gpu_view *view, const struct neph_rt_pass *pass);

/* All targets of the passes that are in the frame with the settings of a view. */
uint32_t neph_rt_targets_used(const struct neph_gpu_view *view);

/* The targets that a pass leaves as history, under their names in the next frame. */
uint32_t neph_rt_targets_before(const struct neph_rt_pass *pass);

/* The shader of a pass on a kind of device: its variant where the view meets the variant's needs,
 * else the readable one. */
const struct neph_rt_shader *neph_rt_shader_for(const struct neph_gpu_view *view,
                                                const struct neph_rt_pass *pass,
                                                enum neph_rt_device_kind kind);

/* Sets in a view the passes that variants on this kind of device absorb; none without variants. */
void neph_rt_absorb_passes(struct neph_gpu_view *view, enum neph_rt_device_kind kind,
                           bool has_variants);

/* Number of threads of a dispatch of a pass with one of its shaders. */
uint64_t neph_rt_thread_count(const struct neph_gpu_view *view, const struct neph_rt_pass *pass,
                              const struct neph_rt_shader *shader);

/* Number of dispatches of a pass with one of its shaders: 1 or 4. */
uint32_t neph_rt_colour_count(const struct neph_gpu_view *view, const struct neph_rt_pass *pass,
                              const struct neph_rt_shader *shader);

#endif
