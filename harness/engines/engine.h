/* SPDX-License-Identifier: MIT
 *
 * Engines: one interface for everything that renders a scene. Each engine is one file under
 * harness/engines/ with one table, and a line in engines.h.
 */
#ifndef NEPH_HARNESS_ENGINES_ENGINE_H
#define NEPH_HARNESS_ENGINES_ENGINE_H

#include "base/image.h"
#include "base/option.h"
#include "scenes/scene.h"

#include <stdint.h>

/* The levels of the reference hierarchy, highest first. */
enum neph_reference_level {
    NEPH_LEVEL_EXACT,    /* closed forms and converged quadrature in double precision */
    NEPH_LEVEL_TRACER,   /* unbiased path tracers of neph */
    NEPH_LEVEL_EXTERNAL, /* external renderers */
    NEPH_LEVEL_MODEL,    /* real-time models, which are under test */
    NEPH_LEVEL_COUNT,
};

struct neph_shared_device; /* vulkan_device.h */

#define NEPH_BUILD_SIZE 17 /* 16 hexadecimal digits and the NUL */

/* The result of a probe: the installed program or device. */
struct neph_engine_info {
    bool available;
    bool broken;                 /* installed, but the probe failed; implies !available */
    char version[128];           /* such as "Blender 3.4.1"; part of the job key */
    char build[NEPH_BUILD_SIZE]; /* a digest of the program; part of the job key */
    char device[128];       /* where it runs, with the environment that changes bits; part of the
                             * job key */
    char missing[512];      /* why it is unavailable or broken, as text */
    char install_line[256]; /* the command that installs it */
    char warning[256];      /* text; available, but the version was not measured */
    char can[160];          /* observed features of an external program, as text */
    bool is_unstepped;      /* needs no steps through media unless a setting requests them */
};

/* The requested layers of a frame; other layers cost nothing. */
enum neph_layers {
    NEPH_LAYER_RADIANCE = 1,      /* R G B and volume.* */
    NEPH_LAYER_TRANSMITTANCE = 2, /* transmittance.* */
    NEPH_LAYER_DEPTH = 4,         /* Z */
    NEPH_LAYERS_ALL = 7,
};

/* One frame to render. All pointers are borrowed. */
struct neph_shot {
    const struct neph_scene *scene;
    struct neph_settings settings;
    int width_px, height_px;
    int frame;       /* 0-based */
    unsigned layers; /* enum neph_layers */
    uint64_t seed;
    const char *scratch_directory;     /* exists, empty, owned by neph: inputs, logs and outputs go
                                        * there */
    double time_limit_s;               /* per child process */
    struct neph_shared_device *device; /* shared by the Vulkan engines; NULL: each opens its own */
    const struct neph_engine *engine;  /* the rendering engine, set by neph_engine_render(). NULL:
                                        * the first of its kind */
    const struct neph_image *given; /* for engines with accepts_given_frame: Z and R G B replace the
                                        * solids */
    const char *checkpoint; /* for engines that can checkpoint: a file for unfinished work, to
                             * continue from; NULL: none */
};

/* Attribute of a frame whose radiance may be below 0 because of noise; its text says how often. */
#define NEPH_SIGNED_NOISE_ATTRIBUTE "neph.signed_noise"

/* The cost of a frame. */
struct neph_cost {
    double render_s; /* only the radiance pass, without start-up if the engine can separate it */
    double wall_s;   /* all passes and child processes, with start-up */
    double cpu_s;
    int64_t peak_memory_bytes;
};

/* The step setting of an engine's ray marching, for the step study. */
struct neph_engine_step {
    const char *option; /* name of the option; NULL: no steps */
    double coarsest;    /* setting of the first level */
    double refine;      /* factor between levels: 0.5 for lengths, 2 for counts */
    int level_count;
    double order; /* error ~ step^order */
    /* Whether these settings use steps; NULL: always. */
    bool (*is_taken)(const struct neph_engine_info *info, const struct neph_settings *settings);
};

enum { NEPH_FLIGHT_PASSES_MAX = 32, NEPH_FLIGHT_FRAMES_MAX = 3 };

/* The device cost of a frame in flight. */
struct neph_flight_cost {
    double gpu_s;   /* of all passes; NaN: no timestamps on this device */
    double cpu_s;   /* until it was submitted */
    int pass_count; /* same passes in every frame */
    struct {
        const char *name;
        double gpu_s;         /* 0: did not run */
        double traffic_bytes; /* NaN: not known */
    } passes[NEPH_FLIGHT_PASSES_MAX];
};

struct neph_engine;
struct neph_gpu_renderer; /* gpu_frames.h */

/* A sequence of frames with one set-up. */
struct neph_engine_sequence {
    /* Open for a first frame, given by the shot. `*sequence` is freed by `close`. */
    enum neph_status (*open)(const struct neph_engine *engine, const struct neph_shot *shot,
                             void **sequence, struct neph_diag *diag);

    /* Render the next frame, whose size may differ. As neph_engine.render. */
    enum neph_status (*next)(void *sequence, const struct neph_shot *shot,
                             struct neph_image **frame, struct neph_cost *cost,
                             struct neph_diag *diag);

    /* Submit the next frame without reading it back; at most NEPH_FLIGHT_FRAMES_MAX may be in
     * flight. NULL: not supported by this engine. NEPH_ERR_UNSUPPORTED: not with these settings. */
    enum neph_status (*submit)(void *sequence, const struct neph_shot *shot,
                               struct neph_diag *diag);

    /* Wait for the oldest submitted frame and return its cost. NULL: not supported. */
    enum neph_status (*collect)(void *sequence, struct neph_flight_cost *cost,
                                struct neph_diag *diag);

    /* Wait for the last frame, and count on the device the invalid values of all its images. NULL:
     * not supported. */
    enum neph_status (*watch)(void *sequence, uint64_t *bad, struct neph_diag *diag);

    /* With `leaves`, the next frames do not use shader variants that are faster on this device and
     * give the same results; without it they use them again. NULL: there are none. */
    void (*disable_variants)(void *sequence, bool leaves);

    /* `sequence` may be NULL. */
    void (*close)(void *sequence);
};

/* The description of one pass of an engine's frame. Images are joined by ", "; empty: none. */
struct neph_engine_pass {
    const char *name, *note;
    const char *resolution; /* resolution of its output */
    char condition[64];     /* required setting: "split=four" */
    char reads[256], writes[256];
    char hands_on[256]; /* images that the next frame reads */
};

/* Time limit of a frame of a user engine in studies and suites [s]. Chosen, not measured: enough
 * for a path tracer at the size of a study; a program that hangs costs a nightly run one column. */
#define NEPH_USER_ENGINE_LIMIT_S 600.0

struct neph_engine {
    const char *name;
    const char *summary; /* one line */
    enum neph_reference_level rung;
    const char *bias; /* known bias as text, printed beside its numbers; NULL: none known */
    const struct neph_option *options;           /* ends with a NULL name */
    const struct neph_preset *presets;           /* ends with a NULL name; NULL: none */
    const struct neph_engine_sequence *sequence; /* NULL: each frame has its own set-up */
    const struct neph_gpu_renderer *gpu; /* used by neph_gpu_sequence; NULL: another sequence */
    int lighting;                        /* enum neph_march_lighting, for the ray-marching
                                          * engines */
    /* Its frames depend on earlier frames. Its shots have the scene over time;
     * other engines get the scene of the frame (scenes/motion.h) */
    bool has_frame_history;
    bool accepts_given_frame; /* can replace the solids by depth and radiance from a file */
    bool injects;             /* can apply changes to a running renderer: scenes/injection.h */
    uint32_t version;         /* version of this driver; raise it when its output changes */
    bool look; /* a non-physical lighting model: its difference from physics is model error, not a
                * fault */
    const char *shortcut_of; /* of a real-time method: the engine with the same model, which is its
                              * reference. The method takes part in comparisons with physics only
                              * when it is named. NULL: not a real-time method */
    bool is_narrow; /* for one kind of scene only: excluded from studies of models in all scenes */
    bool can_checkpoint; /* can save its work in a checkpoint and continue from it */
    bool is_user_engine; /* a user engine: takes part only when named, and is never reported as
                     * missing */
    double typical_s; /* typical time of a frame of the catalogue on two cores [s], for the estimate
                       * of remaining time before anything is measured */
    int side_max_px;  /* largest side of a frame; 0: the limit of images */
    bool stochastic;  /* another seed gives another frame with the same mean */
    const struct neph_engine
        *first;  /* of several programs of a kind, the engine of the first program; NULL: this one
                  * is the first */
    int program; /* index of the program, from 0 on */
    struct neph_engine_step step;

    /* Describe the passes of a frame in order; false beyond the last one. NULL: the engine has no
     * passes. */
    bool (*describe_pass)(int index, struct neph_engine_pass *pass);

    /* Fill `info`: `available`, `broken` and `missing`. Never fails, and ends in bounded time.
     * `device`: as neph_shot.device. Call it through neph_engine_probe(). */
    void (*probe)(const struct neph_engine *engine, struct neph_shared_device *device,
                  struct neph_engine_info *info);

    /* Whether the engine can render the scene with these settings; if not, `reason` names the
     * unsupported part ("multiple scattering"). */
    bool (*can_render)(const struct neph_scene *scene, const struct neph_settings *settings,
                       char *reason, size_t reason_size);

    /* Like can_render, but about the installed program: true if it lacks a needed feature that
     * other versions or builds have; `reason` names the feature. NULL: nothing is lacking. May run
     * the program once. */
    bool (*lacks)(const struct neph_engine *engine, const struct neph_scene *scene,
                  const struct neph_settings *settings, char *reason, size_t reason_size);

    /* Render one frame; NULL: render the first of a sequence (neph_engine_render() in
     * gpu_frames.h). The caller adds the common attributes (scene hash, engine, settings, seed,
     * seconds) and checks the frame; the engine adds its own attributes. Attributes
     * "neph.stats.NAME" are costs of the frame, for `neph render --stats` (frame_stats.h). */
    enum neph_status (*render)(const struct neph_shot *shot, struct neph_image **frame,
                               struct neph_cost *cost, struct neph_diag *diag);

    /* Write files into `directory` that a user can open and render without neph; NULL: not
     * supported. `command` receives the one-line command for it. */
    enum neph_status (*export_scene)(const struct neph_shot *shot, const char *directory,
                                     char *command, size_t command_size, struct neph_diag *diag);
};

/* Probe an engine. The texts of `info` are safe for terminals and JSON (base/text.h), whatever a
 * driver or program reports. */
void neph_engine_probe(const struct neph_engine *engine, struct neph_shared_device *device,
                       struct neph_engine_info *info);

/* Whether the engine, and its installed program if it has one, can render the scene; else `reason`
 * names the missing part. */
bool neph_engine_can_render(const struct neph_engine *engine, const struct neph_scene *scene,
                            const struct neph_settings *settings, char *reason, size_t reason_size);

/* NEPH_ERR_USAGE: a side of the frame is larger than the engine renders. */
enum neph_status neph_engine_check_size(const struct neph_engine *engine, int width_px,
                                        int height_px, struct neph_diag *diag);

/* Whether these settings take steps through media. */
bool neph_engine_has_steps(const struct neph_engine *engine, const struct neph_engine_info *info,
                           const struct neph_settings *settings);

/* Whether an engine is `name`, or another program of that kind: "cycles@5.2" is a "cycles". */
bool neph_engine_is_kind(const struct neph_engine *engine, const char *name);

/* The first value of option "lighting" that makes a refused scene renderable: "octaves". NULL: none
 * does. */
const char *neph_engine_other_lighting(const struct neph_engine *engine,
                                       const struct neph_scene *scene,
                                       const struct neph_settings *settings);

/* Every option at its default. */
struct neph_settings neph_settings_default(const struct neph_engine *engine);

/* Apply "key=value", or "ENGINE:key=value" if ENGINE is this engine. Errors name the key, the
 * value, the allowed range and the known keys. */
enum neph_status neph_settings_set(const struct neph_engine *engine, struct neph_settings *settings,
                                   const char *assignment, struct neph_diag *diag);

/* The part after the colon of "ENGINE:KEY=VALUE" if ENGINE is this engine; else NULL. */
const char *neph_settings_match_engine(const struct neph_engine *engine, const char *text);

/* Set every option to the value of a preset. Errors list the presets. */
enum neph_status neph_settings_preset(const struct neph_engine *engine, const char *name,
                                      struct neph_settings *settings, struct neph_diag *diag);

/* Apply "NAME" or "NAME+KEY=VALUE+...": the preset NAME, then `shared` ("steps=8"; or NULL), then
 * the changes. Errors as of both. */
enum neph_status neph_settings_parse_words(const struct neph_engine *engine, const char *words,
                                           const char *shared, struct neph_settings *settings,
                                           struct neph_diag *diag);

/* Adapt settings to a scene, for studies and sweeps: if the engine cannot treat a planet's air as a
 * medium, use tables for it (sky=tables). */
void neph_settings_adapt_to_scene(const struct neph_engine *engine, const struct neph_scene *scene,
                                  struct neph_settings *settings);

/* The value of an option by name; the name must exist in the table. */
double neph_setting(const struct neph_engine *engine, const struct neph_settings *settings,
                    const char *name);

/* Index of the option with the number of samples; -1: the engine takes no samples. */
int neph_engine_samples(const struct neph_engine *engine);

/* "steps=64 sun=exact": all options in table order. For the caller to free. */
char *neph_settings_text(const struct neph_engine *engine, const struct neph_settings *settings);

/* The preset that settings started from: `preset`, or for NULL the preset equal to the defaults.
 * NULL: that one has no name. */
const char *neph_settings_origin(const struct neph_engine *engine, const char *preset);

/* The differences from a preset, or from the defaults for NULL: "steps=64 sun=exact". For the
 * caller to free; NULL: memory is short. */
char *neph_settings_changes(const struct neph_engine *engine, const struct neph_settings *settings,
                            const char *preset);

const char *neph_reference_level_name(enum neph_reference_level rung);

#endif
