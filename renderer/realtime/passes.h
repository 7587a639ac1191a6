/* SPDX-License-Identifier: MIT
 *
 * The passes of a frame, in its order, each one record: what it is bound to, how large it is, when
 * it runs and what it leaves for the next frame. All who run, count or list passes read it here.
 */
#ifndef NEPH_RENDERER_REALTIME_PASSES_H
#define NEPH_RENDERER_REALTIME_PASSES_H

#include "renderer/realtime/layout.h"
#include "renderer/realtime/tuning.h"

/* The choice that a setting must have. */
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
    int column;   /* texels, one below the other, that a thread writes; 0: one */
    int block[2]; /* texels that a work group writes together; {0}: texels are independent */
    /* A variant runs where all of these hold; ends early with {0}, which never does. */
    struct neph_rt_condition needs[NEPH_RT_NEEDS_MAX];
    const struct neph_rt_pass *absorbs; /* a pass whose targets a variant writes, too; or NULL */
};

enum { NEPH_RT_OTHERS_MAX = 3 };

/* A target of this frame that is another one's name in the next. */
struct neph_rt_history {
    int now, before;
};

/* What rays of a pass meet. */
enum neph_rt_rays {
    NEPH_RT_NO_RAYS,
    NEPH_RT_RAYS_TO_SOLIDS,     /* of one step */
    NEPH_RT_POINTS_IN_MEDIA,    /* of one step */
    NEPH_RT_RAYS_THROUGH_MEDIA, /* of all steps */
    NEPH_RT_RAYS_COUNT,
};

enum { NEPH_RT_UNLESS_MAX = 4 };

/* Targets that a pass leaves alone unless one of these holds. {0} never does: there is a step. */
struct neph_rt_spared {
    struct neph_rt_condition unless[NEPH_RT_UNLESS_MAX];
    uint32_t targets;
};

enum { NEPH_RT_HISTORIES_MAX = 2, NEPH_RT_SPARED_MAX = 6, NEPH_RT_PASSES_MAX = 32 };

#define NEPH_RT_BIT(target) (1u << (target))

/* The change around a tile is found from these (gradient/change_around.glsl). */
#define NEPH_RT_CHANGE_READS                                                                       \
    (NEPH_RT_BIT(RT_LOOK_NOW) | NEPH_RT_BIT(RT_LOOK_THEN) | NEPH_RT_BIT(RT_LOOK_BEHIND_NOW) |      \
     NEPH_RT_BIT(RT_LOOK_BEHIND_THEN) | NEPH_RT_BIT(RT_CHANGE_BEHIND))

struct neph_rt_pass {
    const char *name;             /* "tile index" */
    const char *note;             /* what it makes, in a few words */
    struct neph_rt_shader shader; /* the readable one, which the CPU reference mirrors */
    /* Faster shaders with the same results, each for one kind of device, where `shader` does not
     * run; {0}: it does. tests/renderer/test_realtime_variants.c compares both. */
    struct neph_rt_shader variants[NEPH_RT_DEVICE_KINDS];
    struct neph_rt_condition condition; /* of being in the frame */
    /* Where one of these holds; ends early with {0}, which never does (above). The setting of the
     * first is 0 but where a variant absorbs the pass. */
    struct neph_rt_condition done_by_other[NEPH_RT_OTHERS_MAX];
    int resolution;        /* RT_FULL, ..: of the texels that it makes */
    int unread_resolution; /* of those in pictures that nobody reads (unread.h); 0: the same */
    bool in_quads;         /* a thread makes 2x2, the first of which may be one before the view */
    enum neph_rt_rays rays;
    /* Where this holds colours of 2x2 texels take turns, each of which sees what those before it
     * wrote: by four dispatches, or by one of blocks where the shader has them. Else, or NULL, one
     * dispatch of independent texels. */
    const struct neph_rt_condition *in_colours;
    uint32_t reads, writes; /* targets, NEPH_RT_BIT() of each: all that its shader can touch */
    struct neph_rt_spared spared[NEPH_RT_SPARED_MAX]; /* of these; ends early with no targets */
    struct neph_rt_history histories[NEPH_RT_HISTORIES_MAX]; /* ends early with {0, 0} */
    int picture; /* the target whose R G B are the frame as far as it has come; 0: none */
};

/* Each is in the folder of its pass: realtime/FOLDER/pass.c. */
extern const struct neph_rt_pass neph_rt_scene_rays;
extern const struct neph_rt_pass neph_rt_depth_map;
extern const struct neph_rt_pass neph_rt_froxel_light;
extern const struct neph_rt_pass neph_rt_froxel_sum;
extern const struct neph_rt_pass neph_rt_tile_index;
extern const struct neph_rt_pass neph_rt_ray_march;
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

/* All, in the order of a frame. Ends with NULL; at most NEPH_RT_PASSES_MAX. */
extern const struct neph_rt_pass *const neph_rt_passes[];

/* The place of a pass among them; -1: none has this name. */
int neph_rt_pass_index(const char *name);

const char *neph_rt_target_name(int target);

bool neph_rt_holds(const struct neph_gpu_view *view, struct neph_rt_condition condition);

/* Whether what a pass makes is made elsewhere, or known. */
bool neph_rt_is_done_by_other(const struct neph_gpu_view *view, const struct neph_rt_pass *pass);

/* What a pass reads and writes with the settings of a view: all that it is bound to. */
uint32_t neph_rt_targets_touched(const struct neph_gpu_view *view, const struct neph_rt_pass *pass);

/* All targets of the passes that are in the frame with the settings of a view. */
uint32_t neph_rt_targets_used(const struct neph_gpu_view *view);

/* The targets that a pass hands on, under the names that they have in the next frame. */
uint32_t neph_rt_targets_before(const struct neph_rt_pass *pass);

/* The shader of a pass on a kind of device: its variant where the view has what that needs, or the
 * readable one. */
const struct neph_rt_shader *neph_rt_shader_for(const struct neph_gpu_view *view,
                                                const struct neph_rt_pass *pass,
                                                enum neph_rt_device_kind kind);

/* Set in a view which passes are done by others, because variants on this kind of device absorb
 * them: none if the variants do not run. */
void neph_rt_absorb_passes(struct neph_gpu_view *view, enum neph_rt_device_kind kind,
                           bool has_variants);

/* Threads of a dispatch of a pass with one of its shaders. */
uint64_t neph_rt_thread_count(const struct neph_gpu_view *view, const struct neph_rt_pass *pass,
                              const struct neph_rt_shader *shader);

/* Dispatches of a pass with one of its shaders: 1 or 4. */
uint32_t neph_rt_colour_count(const struct neph_gpu_view *view, const struct neph_rt_pass *pass,
                              const struct neph_rt_shader *shader);

#endif
