/* SPDX-License-Identifier: MIT
 *
 * How a scene file is written: the structure for libcyaml, and for every value its unit and range.
 * Private to scenes/. The reference for people is scenes/README.md; a test holds the two together.
 */
#ifndef NEPH_SCENES_SCHEMA_H
#define NEPH_SCENES_SCHEMA_H

#include "scenes/scene.h"

#include <cyaml/cyaml.h>

#define NEPH_SCENE_FILE_MAX_BYTES (1024 * 1024)
#define NEPH_SCENE_DEPTH_MAX 16 /* the schema itself needs 6 */
#define NEPH_SCENE_KEYS_MAX 1024
#define NEPH_SCENE_GATES_MAX 64
#define NEPH_SCENE_VOXELS_MAX 4096 /* written out in a scene file */
#define NEPH_SCENE_TITLE_MAX 120
#define NEPH_SCENE_PATH_MAX 160 /* of a value inside a file: "media[0].height_fog.albedo[2]" */

/* The file as it stands, before defaults. A NULL pointer is a key that is not there. */
struct neph_raw_bounds {
    double min_m[3], max_m[3];
};

struct neph_raw_camera_key {
    double frame;
    double position_m[3], look_at_m[3];
    bool cut;
};

struct neph_raw_camera {
    double *position_m, *look_at_m;
    struct neph_raw_camera_key *keys;
    unsigned keys_count;
    double *up;
    double vertical_fov_deg;
};

struct neph_raw_frames {
    int *count;
    double *rate_hz;
    struct neph_pause *pauses;
    unsigned pauses_count;
    struct neph_frame_scale *sizes;
    unsigned sizes_count;
};

struct neph_raw_sun_key {
    double frame;
    double direction[3];
    double irradiance_w_per_m2[3];
};

struct neph_raw_sun {
    double *direction, *irradiance_w_per_m2;
    struct neph_raw_sun_key *keys;
    unsigned keys_count;
};

struct neph_raw_wind_key {
    double frame;
    double velocity_m_per_s[3];
};

struct neph_raw_wind {
    double *velocity_m_per_s;
    struct neph_raw_wind_key *keys;
    unsigned keys_count;
};

struct neph_raw_box {
    double min_m[3], max_m[3];
    double albedo[3];
};

struct neph_raw_sphere {
    double center_m[3];
    double radius_m;
    double albedo[3];
};

struct neph_raw_rails {
    double *heights_m;
    unsigned heights_m_count;
    double width_m, depth_m;
};

struct neph_raw_fence {
    double origin_m[3];
    int bars;
    double pitch_m, bar_width_m, bar_depth_m, height_m;
    int *rows;
    double *row_spacing_m;
    struct neph_raw_rails *rails;
    double albedo[3];
};

struct neph_raw_solid {
    struct neph_raw_box *box;
    struct neph_raw_sphere *sphere;
    struct neph_raw_fence *fence;
};

/* What every medium has. */
struct neph_raw_optics {
    double *extinction_color;
    double albedo[3];
    enum neph_phase_kind *phase;
    double *asymmetry_g;
    int *voxels; /* nodes along the longest side; the medium is baked to a grid for all engines */
};

struct neph_raw_homogeneous {
    double extinction_per_m;
    struct neph_raw_optics optics;
    struct neph_raw_bounds bounds;
};

struct neph_raw_gaussian {
    double center_m[3];
    double width_m, extinction_per_m;
    struct neph_raw_optics optics;
    struct neph_raw_bounds *bounds;
};

struct neph_raw_shell {
    double center_m[3];
    double radius_m, scale_height_m, extinction_per_m;
    struct neph_raw_optics optics;
    struct neph_raw_bounds bounds;
};

struct neph_raw_grid {
    int size[3];
    double origin_m[3], spacing_m[3];
    double *values;
    unsigned values_count;
    double extinction_per_m;
    struct neph_raw_optics optics;
    struct neph_raw_bounds *bounds; /* NULL: unbounded */
};

/* Voxels from a file, put in place by the block of them (nodes times spacing). */
struct neph_raw_volume {
    char *file, *grid;
    double center_m[3];
    double longest_side_m;
    int *memory_limit_mib;
    double extinction_per_m;
    struct neph_raw_optics optics;
    struct neph_raw_bounds *bounds; /* NULL: unbounded */
};

/* NULL: the article's value, neph_horizon_defaults(). */
struct neph_raw_horizon {
    int *seed;
    double *planet_radius_m, *bottom_m, *thickness_m;
    double *coverage, *density;
    double *texture_scale_m, *base_repeats, *detail_repeats;
    double *wind_m;
    double extinction_per_m;
    struct neph_raw_optics optics;
    struct neph_raw_bounds bounds;
};

struct neph_raw_unreal_layer {
    double fog_density, fog_height_falloff, fog_height_m;
};

struct neph_raw_height_fog {
    struct neph_fog_layer *layers;
    unsigned layers_count;
    struct neph_raw_unreal_layer *unreal_layers;
    unsigned unreal_layers_count;
    struct neph_raw_optics optics;
    struct neph_raw_bounds *bounds;
};

struct neph_raw_medium {
    struct neph_raw_homogeneous *homogeneous;
    struct neph_raw_height_fog *height_fog;
    struct neph_raw_gaussian *gaussian;
    struct neph_raw_shell *shell;
    struct neph_raw_grid *grid;
    struct neph_raw_volume *volume;
    struct neph_raw_horizon *horizon;
};

struct neph_raw_octaves {
    int *count;
    double *contribution, *attenuation, *eccentricity;
};

struct neph_raw_display {
    double exposure_ev;
};

struct neph_raw_gate {
    char *engine;
    enum neph_gate_quantity quantity;
    int metric; /* index into the schema's words; neph_schema_metric_name() */
    int *mask;
    double maximum;
    char *reason;
};

struct neph_raw_scene {
    char *name, *title, *physics;
    struct neph_raw_camera camera;
    struct neph_raw_frames *frames;
    struct neph_raw_sun *sun;
    struct neph_raw_wind *wind;
    double *background_w_per_m2_sr;
    bool environment_light;
    enum neph_scattering scattering;
    struct neph_raw_octaves *octaves;
    int *bake_resolution;
    struct neph_raw_solid *solids;
    unsigned solids_count;
    struct neph_raw_medium *media;
    unsigned media_count;
    struct neph_raw_display *display;
    struct neph_raw_gate *gates;
    unsigned gates_count;
};

/* The whole file: a mapping into a new struct neph_raw_scene. */
const cyaml_schema_value_t *neph_schema_root(void);

const char *neph_schema_metric_name(int metric);
const char *neph_schema_mask_name(int mask);

/* What libcyaml does not know of a value. `pattern` is its path with empty brackets:
 * "media[].homogeneous.albedo[]". */
struct neph_field {
    const char *pattern;
    const char *unit; /* "" for a plain number */
    double minimum, maximum;
    const char *note; /* NULL, or why: told to a person whose file breaks the rule */
};

/* NULL when there is no row for the pattern. Every number of the schema has one. */
const struct neph_field *neph_schema_field(const char *pattern);

#endif
