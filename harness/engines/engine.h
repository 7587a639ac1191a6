/* SPDX-License-Identifier: MIT
 *
 * Engines: one interface for everything that turns a scene into frames. An engine is one file
 * under harness/engines/ with one table, and a line in engines.h.
 */
#ifndef NEPH_HARNESS_ENGINES_ENGINE_H
#define NEPH_HARNESS_ENGINES_ENGINE_H

#include "base/image.h"
#include "base/option.h"
#include "scenes/scene.h"

#include <stdint.h>

/* The rungs of the ladder of truth, highest first. */
enum neph_rung {
    NEPH_RUNG_EXACT,   /* closed forms and converged double-precision quadrature */
    NEPH_RUNG_TRACER,  /* our unbiased tracers */
    NEPH_RUNG_WITNESS, /* other people's renderers */
    NEPH_RUNG_MODEL,   /* our real-time models: the thing under test */
    NEPH_RUNG_COUNT,
};

struct neph_shared_device; /* vulkan_device.h */

#define NEPH_BUILD_SIZE 17 /* 16 hexadecimal digits and the NUL */

/* What is installed. */
struct neph_engine_info {
    bool available;
    bool broken;                 /* not available although it is installed: the probe failed */
    char version[128];           /* such as "Blender 3.4.1"; part of the job key */
    char build[NEPH_BUILD_SIZE]; /* a digest of the program; part of the job key */
    char device[128];       /* where it runs, and what of its surroundings decides bits; job key */
    char missing[512];      /* why it is not available or is broken, in words */
    char install_line[256]; /* the exact command that would mend it */
    char warning[256];      /* available, but of a version that was not measured: in words */
    char can[160];          /* of an external program: what it was seen to do, in words */
    bool is_unstepped;      /* it takes no steps through media unless a setting asks for them */
};

/* Which layers of the frame are wanted; what is not wanted is not paid for. */
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
    const char *scratch_directory; /* exists, empty, is ours: inputs, logs and outputs go there */
    double time_limit_s;           /* per child process */
    struct neph_shared_device *device; /* that engines on Vulkan share; NULL: each opens its own */
    const struct neph_engine *engine;  /* that renders; set by neph_engine_render(). NULL: the first
                                         of its kind */
    const struct neph_image *given; /* engines that take one: Z and R G B in place of the solids */
    const char *checkpoint; /* engines that `rests`: file to leave unfinished work in and to go on
                               from; NULL: none */
};

/* The attribute of a frame whose radiance may be below 0 where noise makes it so; its text says how
 * often it is. */
#define NEPH_SIGNED_NOISE_ATTRIBUTE "neph.signed_noise"

/* What it cost. */
struct neph_cost {
    double render_s; /* the radiance pass alone, without start-up where the engine can tell */
    double wall_s;   /* all passes and children, start-up included */
    double cpu_s;
    int64_t peak_memory_bytes;
};

/* How an engine's march through uneven media is refined, for the step-halving study. */
struct neph_engine_step {
    const char *option; /* name in the table of options; NULL: no steps */
    double coarsest;    /* setting of the first level */
    double refine;      /* factor from one level to the next: 0.5 for lengths, 2 for counts */
    int level_count;
    double order; /* error ~ step^order */
    /* Whether steps are taken with these settings; NULL: always. */
    bool (*is_taken)(const struct neph_engine_info *info, const struct neph_settings *settings);
};

enum { NEPH_FLIGHT_PASSES_MAX = 32, NEPH_FLIGHT_PICTURES_MAX = 3 };

/* What a picture in flight has cost on the device. */
struct neph_flight_cost {
    double gpu_s;   /* of all passes; NaN: the device has no clock */
    double cpu_s;   /* until it was on its way */
    int pass_count; /* the same passes in every picture */
    struct {
        const char *name;
        double gpu_s;         /* 0: it did not run */
        double traffic_bytes; /* NaN: not known */
    } passes[NEPH_FLIGHT_PASSES_MAX];
};

struct neph_engine;
struct neph_gpu_renderer; /* gpu_frames.h */

/* Pictures in a row, from what is set up once. */
struct neph_engine_sequence {
    /* Before the first picture, which is the shot's. `*sequence` is for _close. */
    enum neph_status (*open)(const struct neph_engine *engine, const struct neph_shot *shot,
                             void **sequence, struct neph_diag *diag);

    /* The next picture; its size may be another. As neph_engine.render. */
    enum neph_status (*next)(void *sequence, const struct neph_shot *shot,
                             struct neph_image **frame, struct neph_cost *cost,
                             struct neph_diag *diag);

    /* The next picture goes on its way and nothing of it comes back; NULL: this engine's cannot. At
     * most NEPH_FLIGHT_PICTURES_MAX may be. NEPH_ERR_UNSUPPORTED: not with these settings. */
    enum neph_status (*send)(void *sequence, const struct neph_shot *shot, struct neph_diag *diag);

    /* What the oldest of them has cost, waited for. NULL where `send` is. */
    enum neph_status (*home)(void *sequence, struct neph_flight_cost *cost, struct neph_diag *diag);

    /* How many values of the last picture are bad, in all images that it was made of, waited for
     * and counted on the device. NULL: nobody can tell. */
    enum neph_status (*watch)(void *sequence, uint64_t *bad, struct neph_diag *diag);

    /* From the next picture on leave out shaders that are faster on this device and have the same
     * results, or take them again. NULL: the engine has none. */
    void (*leave_variants)(void *sequence, bool leaves);

    /* NULL is fine. */
    void (*close)(void *sequence);
};

/* One pass of an engine's frame in words. Images are joined by ", "; empty: none. */
struct neph_engine_pass {
    const char *name, *note;
    const char *resolution; /* of what it writes */
    char condition[64];     /* the setting that it needs: "split=four" */
    char reads[256], writes[256];
    char hands_on[256]; /* what the next frame reads of it */
};

/* So long a study or a suite waits for a picture of a user's program [s]. A choice, no measurement:
 * enough for a path tracer at the size of a study, and one that hangs costs a night one column. */
#define NEPH_GUEST_LIMIT_S 600.0

struct neph_engine {
    const char *name;
    const char *summary; /* one line */
    enum neph_rung rung;
    const char *bias; /* its known bias, in words, printed beside its numbers; NULL: none known */
    const struct neph_option *options;           /* ends with a NULL name */
    const struct neph_preset *presets;           /* ends with a NULL name; NULL: none */
    const struct neph_engine_sequence *sequence; /* NULL: each picture is set up anew */
    const struct neph_gpu_renderer *gpu; /* behind neph_gpu_sequence; NULL where that is not it */
    int lighting;                        /* enum neph_march_lighting, of the engines that march */
    bool remembers;   /* its pictures follow from those before. Its shots have the scene over time,
                         where others get the scene of the picture (scenes/motion.h) */
    bool takes_given; /* a depth and radiance of the solids from a file */
    bool injects;     /* what the scene wants put into a running renderer: scenes/injection.h */
    uint32_t version; /* of our own driver; raise it when its output changes */
    bool look; /* a lighting model that is no physics and does not claim to be: what it is off by is
                  the gap of a model */
    const char *shortcut_of; /* the engine of whose model it is a cheaper rendering, which is what
                                it is measured against; it takes part in comparisons with physics
                                only when it is named. NULL: it is no shortcut */
    bool is_narrow; /* it is for one kind of scene alone: no study of models in all scenes offers
                       it */
    bool rests;     /* it leaves its work in a checkpoint and goes on from there */
    bool is_guest;  /* a program of the user's: takes part where it is named, and nobody lacks it */
    double typical_s; /* about how long a picture of the catalogue takes on two cores: for the time
                         left, before anything is measured */
    int side_max_px;  /* the largest side of a frame; 0: as large as images are */
    bool stochastic;  /* another seed gives another frame of the same mean */
    const struct neph_engine
        *first;  /* of several programs of a kind, the engine of the first; NULL:
                                        this one */
    int program; /* which of them, from 0 on */
    struct neph_engine_step step;

    /* The passes of a frame in their order; false beyond the last. NULL: it is not made of
     * passes. */
    bool (*describe_pass)(int index, struct neph_engine_pass *pass);

    /* Look for the engine. Never fails and ends in bounded time: `available`, `broken` and
     * `missing` say how it is. `device`: as neph_shot.device. Called through
     * neph_engine_probe(). */
    void (*probe)(const struct neph_engine *engine, struct neph_shared_device *device,
                  struct neph_engine_info *info);

    /* Fills `reason` with what it cannot model with these settings ("multiple scattering") and
     * returns false, or returns true. */
    bool (*can_render)(const struct neph_scene *scene, const struct neph_settings *settings,
                       char *reason, size_t reason_size);

    /* As can_render, of the installed program: true, with the reason, where it lacks what other
     * versions or builds of it have. NULL: it lacks nothing. May run the program, once. */
    bool (*lacks)(const struct neph_engine *engine, const struct neph_scene *scene,
                  const struct neph_settings *settings, char *reason, size_t reason_size);

    /* Render one frame; NULL: the first of a sequence (neph_engine_render() in gpu_frames.h). The
     * caller adds the common attributes (scene hash, engine, settings, seed, seconds) and checks
     * the frame; the engine adds only what it alone knows. Attributes "neph.stats.NAME" are numbers
     * of what the frame has cost, for `neph render --stats` (frame_stats.h). */
    enum neph_status (*render)(const struct neph_shot *shot, struct neph_image **frame,
                               struct neph_cost *cost, struct neph_diag *diag);

    /* Leave files in `directory` that a person can open and render by hand; NULL: not offered.
     * `command` receives the one-line command. */
    enum neph_status (*export_scene)(const struct neph_shot *shot, const char *directory,
                                     char *command, size_t command_size, struct neph_diag *diag);
};

/* Look for an engine. The texts of `info` are fit for terminals and JSON (base/text.h), whatever a
 * driver or program is called. */
void neph_engine_probe(const struct neph_engine *engine, struct neph_shared_device *device,
                       struct neph_engine_info *info);

/* Whether the engine models the scene, and the installed program, if it is one, has what that
 * takes; else `reason` says what is missing. */
bool neph_engine_can_render(const struct neph_engine *engine, const struct neph_scene *scene,
                            const struct neph_settings *settings, char *reason, size_t reason_size);

/* NEPH_ERR_USAGE: a side of the frame is larger than the engine renders. */
enum neph_status neph_engine_check_size(const struct neph_engine *engine, int width_px,
                                        int height_px, struct neph_diag *diag);

/* Whether media are marched in steps with these settings. */
bool neph_engine_has_steps(const struct neph_engine *engine, const struct neph_engine_info *info,
                           const struct neph_settings *settings);

/* Whether an engine is `name`, or another program of that kind: "cycles@5.2" is a "cycles". */
bool neph_engine_is(const struct neph_engine *engine, const char *name);

/* The first choice of its option "lighting" with which an engine can render a scene that it cannot
 * with these settings: "octaves". NULL: there is none. */
const char *neph_engine_other_lighting(const struct neph_engine *engine,
                                       const struct neph_scene *scene,
                                       const struct neph_settings *settings);

/* Every option at its default. */
struct neph_settings neph_settings_default(const struct neph_engine *engine);

/* Apply "key=value", or "ENGINE:key=value" with the name of this engine. Errors name the key, the
 * value, the allowed range and the known keys. */
enum neph_status neph_settings_set(const struct neph_engine *engine, struct neph_settings *settings,
                                   const char *assignment, struct neph_diag *diag);

/* What stands behind the colon of "ENGINE:KEY=VALUE", when it is for this engine; else NULL. */
const char *neph_settings_for(const struct neph_engine *engine, const char *text);

/* Every option as a preset has it. Errors name the presets there are. */
enum neph_status neph_settings_preset(const struct neph_engine *engine, const char *name,
                                      struct neph_settings *settings, struct neph_diag *diag);

/* "NAME" or "NAME+KEY=VALUE+...": a preset, then `shared` ("steps=8"; or NULL), then its changes.
 * Errors as of both. */
enum neph_status neph_settings_words(const struct neph_engine *engine, const char *words,
                                     const char *shared, struct neph_settings *settings,
                                     struct neph_diag *diag);

/* What studies and sweeps leave to the scene: the air of a planet comes from tables (sky=tables)
 * where the engine refuses it as a medium. */
void neph_settings_meet(const struct neph_engine *engine, const struct neph_scene *scene,
                        struct neph_settings *settings);

/* The value of an option by name; the name must exist in the table. */
double neph_setting(const struct neph_engine *engine, const struct neph_settings *settings,
                    const char *name);

/* Index of the option that says how many samples are drawn; -1: the engine draws none. */
int neph_engine_samples(const struct neph_engine *engine);

/* "steps=64 sun=exact", canonical: all options, table order. For the caller to free. */
char *neph_settings_text(const struct neph_engine *engine, const struct neph_settings *settings);

/* The preset that an engine's settings began as: the one of this name, or for NULL the one that is
 * its defaults. NULL: that has no name. */
const char *neph_settings_origin(const struct neph_engine *engine, const char *preset);

/* "steps=64 sun=exact": what differs from a preset, or for NULL from the defaults. For the caller
 * to free; NULL when memory is short. */
char *neph_settings_changes(const struct neph_engine *engine, const struct neph_settings *settings,
                            const char *preset);

const char *neph_rung_name(enum neph_rung rung);

#endif
