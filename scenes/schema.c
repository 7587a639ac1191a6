/* SPDX-License-Identifier: MIT
 *
 * The two tables of the scene format. Adding a key to the format is one line here for its
 * structure, one for its range, one in scenes/README.md, and its use in load.c.
 */
#include "scenes/schema.h"

#include "scenes/bake.h"

#include <stddef.h>
#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

/* Three numbers in place, or behind a pointer when the key may be absent. */
#define FIELD_VEC3(key, type, member)                                                              \
    CYAML_FIELD_SEQUENCE_FIXED(key, CYAML_FLAG_DEFAULT, type, member, &number, 3)
#define FIELD_VEC3_OPTIONAL(key, type, member)                                                     \
    CYAML_FIELD_SEQUENCE_FIXED(key, CYAML_FLAG_POINTER | CYAML_FLAG_OPTIONAL, type, member,        \
                               &number, 3)
#define FIELD_NUMBER(key, type, member) CYAML_FIELD_FLOAT(key, CYAML_FLAG_DEFAULT, type, member)
#define FIELD_NUMBER_OPTIONAL(key, type, member)                                                   \
    CYAML_FIELD_FLOAT_PTR(key, CYAML_FLAG_OPTIONAL, type, member)
#define FIELD_WORD(key, type, member, words)                                                       \
    CYAML_FIELD_ENUM(key, CYAML_FLAG_STRICT, type, member, words, COUNT(words))
#define FIELD_WORD_OPTIONAL(key, type, member, words)                                              \
    CYAML_FIELD_ENUM_PTR(key, CYAML_FLAG_STRICT | CYAML_FLAG_OPTIONAL, type, member, words,        \
                         COUNT(words))
#define FIELD_LIST(key, type, member, entry, minimum, maximum)                                     \
    CYAML_FIELD_SEQUENCE(key, CYAML_FLAG_POINTER | CYAML_FLAG_OPTIONAL, type, member, entry,       \
                         minimum, maximum)

static const cyaml_strval_t phase_words[] = {
    {"isotropic", NEPH_PHASE_ISOTROPIC},
    {"henyey_greenstein", NEPH_PHASE_HENYEY_GREENSTEIN},
    {"rayleigh", NEPH_PHASE_RAYLEIGH},
};

static const cyaml_strval_t scattering_words[] = {
    {"none", NEPH_SCATTERING_NONE},
    {"single", NEPH_SCATTERING_SINGLE},
    {"multiple", NEPH_SCATTERING_MULTIPLE},
};

static const cyaml_strval_t quantity_words[] = {
    {"radiance", NEPH_QUANTITY_RADIANCE},
    {"transmittance", NEPH_QUANTITY_TRANSMITTANCE},
    {"depth", NEPH_QUANTITY_DEPTH},
};

/* The names of the metrics module; the values are only indices. */
static const cyaml_strval_t metric_words[] = {
    {"bias", 0},    {"rel_bias", 1}, {"mae", 2}, {"rmse", 3}, {"rel_rmse", 4}, {"rel_mse", 5},
    {"max_abs", 6}, {"max_rel", 7},  {"p50", 8}, {"p95", 9},  {"p99", 10},
};

static const cyaml_strval_t mask_words[] = {
    {"all", 0}, {"sky", 1}, {"solid", 2}, {"medium", 3}, {"depth_edge", 4},
};

static const cyaml_schema_value_t number = {CYAML_VALUE_FLOAT(CYAML_FLAG_DEFAULT, double)};

static const cyaml_schema_field_t bounds_fields[] = {
    FIELD_VEC3("min_m", struct neph_raw_bounds, min_m),
    FIELD_VEC3("max_m", struct neph_raw_bounds, max_m),
    CYAML_FIELD_END,
};

static const cyaml_schema_field_t camera_key_fields[] = {
    FIELD_NUMBER("frame", struct neph_raw_camera_key, frame),
    FIELD_VEC3("position_m", struct neph_raw_camera_key, position_m),
    FIELD_VEC3("look_at_m", struct neph_raw_camera_key, look_at_m),
    CYAML_FIELD_BOOL("cut", CYAML_FLAG_OPTIONAL, struct neph_raw_camera_key, cut),
    CYAML_FIELD_END,
};

static const cyaml_schema_value_t camera_key = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct neph_raw_camera_key, camera_key_fields),
};

static const cyaml_schema_field_t camera_fields[] = {
    FIELD_VEC3_OPTIONAL("position_m", struct neph_raw_camera, position_m),
    FIELD_VEC3_OPTIONAL("look_at_m", struct neph_raw_camera, look_at_m),
    FIELD_LIST("keys", struct neph_raw_camera, keys, &camera_key, 1, NEPH_SCENE_KEYS_MAX),
    FIELD_VEC3_OPTIONAL("up", struct neph_raw_camera, up),
    FIELD_NUMBER("vertical_fov_deg", struct neph_raw_camera, vertical_fov_deg),
    CYAML_FIELD_END,
};

static const cyaml_schema_field_t pause_fields[] = {
    CYAML_FIELD_INT("frame", CYAML_FLAG_DEFAULT, struct neph_pause, frame),
    CYAML_FIELD_INT("count", CYAML_FLAG_DEFAULT, struct neph_pause, count),
    CYAML_FIELD_END,
};

static const cyaml_schema_value_t pause = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct neph_pause, pause_fields),
};

static const cyaml_schema_field_t frame_scale_fields[] = {
    CYAML_FIELD_INT("frame", CYAML_FLAG_DEFAULT, struct neph_frame_scale, frame),
    FIELD_NUMBER("scale", struct neph_frame_scale, scale),
    CYAML_FIELD_END,
};

static const cyaml_schema_value_t frame_scale = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct neph_frame_scale, frame_scale_fields),
};

static const cyaml_schema_field_t frames_fields[] = {
    CYAML_FIELD_INT_PTR("count", CYAML_FLAG_OPTIONAL, struct neph_raw_frames, count),
    FIELD_NUMBER_OPTIONAL("rate_hz", struct neph_raw_frames, rate_hz),
    FIELD_LIST("pauses", struct neph_raw_frames, pauses, &pause, 1, NEPH_SCENE_KEYS_MAX),
    FIELD_LIST("sizes", struct neph_raw_frames, sizes, &frame_scale, 1, NEPH_SCENE_KEYS_MAX),
    CYAML_FIELD_END,
};

static const cyaml_schema_field_t sun_key_fields[] = {
    FIELD_NUMBER("frame", struct neph_raw_sun_key, frame),
    FIELD_VEC3("direction", struct neph_raw_sun_key, direction),
    FIELD_VEC3("irradiance_w_per_m2", struct neph_raw_sun_key, irradiance_w_per_m2),
    CYAML_FIELD_END,
};

static const cyaml_schema_value_t sun_key = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct neph_raw_sun_key, sun_key_fields),
};

static const cyaml_schema_field_t sun_fields[] = {
    FIELD_VEC3_OPTIONAL("direction", struct neph_raw_sun, direction),
    FIELD_VEC3_OPTIONAL("irradiance_w_per_m2", struct neph_raw_sun, irradiance_w_per_m2),
    FIELD_LIST("keys", struct neph_raw_sun, keys, &sun_key, 1, NEPH_SCENE_KEYS_MAX),
    CYAML_FIELD_END,
};

static const cyaml_schema_field_t wind_key_fields[] = {
    FIELD_NUMBER("frame", struct neph_raw_wind_key, frame),
    FIELD_VEC3("velocity_m_per_s", struct neph_raw_wind_key, velocity_m_per_s),
    CYAML_FIELD_END,
};

static const cyaml_schema_value_t wind_key = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct neph_raw_wind_key, wind_key_fields),
};

static const cyaml_schema_field_t wind_fields[] = {
    FIELD_VEC3_OPTIONAL("velocity_m_per_s", struct neph_raw_wind, velocity_m_per_s),
    FIELD_LIST("keys", struct neph_raw_wind, keys, &wind_key, 1, NEPH_SCENE_KEYS_MAX),
    CYAML_FIELD_END,
};

static const cyaml_schema_field_t box_fields[] = {
    FIELD_VEC3("min_m", struct neph_raw_box, min_m),
    FIELD_VEC3("max_m", struct neph_raw_box, max_m),
    FIELD_VEC3("albedo", struct neph_raw_box, albedo),
    CYAML_FIELD_END,
};

static const cyaml_schema_field_t sphere_fields[] = {
    FIELD_VEC3("center_m", struct neph_raw_sphere, center_m),
    FIELD_NUMBER("radius_m", struct neph_raw_sphere, radius_m),
    FIELD_VEC3("albedo", struct neph_raw_sphere, albedo),
    CYAML_FIELD_END,
};

static const cyaml_schema_field_t rails_fields[] = {
    CYAML_FIELD_SEQUENCE("heights_m", CYAML_FLAG_POINTER, struct neph_raw_rails, heights_m, &number,
                         1, 16),
    FIELD_NUMBER("width_m", struct neph_raw_rails, width_m),
    FIELD_NUMBER("depth_m", struct neph_raw_rails, depth_m),
    CYAML_FIELD_END,
};

static const cyaml_schema_field_t fence_fields[] = {
    FIELD_VEC3("origin_m", struct neph_raw_fence, origin_m),
    CYAML_FIELD_INT("bars", CYAML_FLAG_DEFAULT, struct neph_raw_fence, bars),
    FIELD_NUMBER("pitch_m", struct neph_raw_fence, pitch_m),
    FIELD_NUMBER("bar_width_m", struct neph_raw_fence, bar_width_m),
    FIELD_NUMBER("bar_depth_m", struct neph_raw_fence, bar_depth_m),
    FIELD_NUMBER("height_m", struct neph_raw_fence, height_m),
    CYAML_FIELD_INT_PTR("rows", CYAML_FLAG_OPTIONAL, struct neph_raw_fence, rows),
    FIELD_NUMBER_OPTIONAL("row_spacing_m", struct neph_raw_fence, row_spacing_m),
    CYAML_FIELD_MAPPING_PTR("rails", CYAML_FLAG_OPTIONAL, struct neph_raw_fence, rails,
                            rails_fields),
    FIELD_VEC3("albedo", struct neph_raw_fence, albedo),
    CYAML_FIELD_END,
};

static const cyaml_schema_field_t solid_fields[] = {
    CYAML_FIELD_MAPPING_PTR("box", CYAML_FLAG_OPTIONAL, struct neph_raw_solid, box, box_fields),
    CYAML_FIELD_MAPPING_PTR("sphere", CYAML_FLAG_OPTIONAL, struct neph_raw_solid, sphere,
                            sphere_fields),
    CYAML_FIELD_MAPPING_PTR("fence", CYAML_FLAG_OPTIONAL, struct neph_raw_solid, fence,
                            fence_fields),
    CYAML_FIELD_END,
};

static const cyaml_schema_value_t solid = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct neph_raw_solid, solid_fields),
};

/* struct neph_raw_optics within a medium. */
#define FIELDS_OPTICS(type)                                                                        \
    FIELD_VEC3_OPTIONAL("extinction_color", type, optics.extinction_color),                        \
        FIELD_VEC3("albedo", type, optics.albedo),                                                 \
        FIELD_WORD_OPTIONAL("phase", type, optics.phase, phase_words),                             \
        FIELD_NUMBER_OPTIONAL("asymmetry_g", type, optics.asymmetry_g),                            \
        CYAML_FIELD_INT_PTR("voxels", CYAML_FLAG_OPTIONAL, type, optics.voxels)

static const cyaml_schema_field_t homogeneous_fields[] = {
    FIELD_NUMBER("extinction_per_m", struct neph_raw_homogeneous, extinction_per_m),
    FIELDS_OPTICS(struct neph_raw_homogeneous),
    CYAML_FIELD_MAPPING("bounds", CYAML_FLAG_DEFAULT, struct neph_raw_homogeneous, bounds,
                        bounds_fields),
    CYAML_FIELD_END,
};

static const cyaml_schema_field_t layer_fields[] = {
    FIELD_NUMBER("extinction_per_m", struct neph_fog_layer, extinction_per_m),
    FIELD_NUMBER("falloff_per_m", struct neph_fog_layer, falloff_per_m),
    FIELD_NUMBER("height_m", struct neph_fog_layer, height_m),
    CYAML_FIELD_END,
};

static const cyaml_schema_value_t layer = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct neph_fog_layer, layer_fields),
};

static const cyaml_schema_field_t unreal_layer_fields[] = {
    FIELD_NUMBER("fog_density", struct neph_raw_unreal_layer, fog_density),
    FIELD_NUMBER("fog_height_falloff", struct neph_raw_unreal_layer, fog_height_falloff),
    FIELD_NUMBER("fog_height_m", struct neph_raw_unreal_layer, fog_height_m),
    CYAML_FIELD_END,
};

static const cyaml_schema_value_t unreal_layer = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct neph_raw_unreal_layer, unreal_layer_fields),
};

static const cyaml_schema_field_t height_fog_fields[] = {
    FIELD_LIST("layers", struct neph_raw_height_fog, layers, &layer, 1, NEPH_FOG_LAYERS_MAX),
    FIELD_LIST("unreal_layers", struct neph_raw_height_fog, unreal_layers, &unreal_layer, 1,
               NEPH_FOG_LAYERS_MAX),
    FIELDS_OPTICS(struct neph_raw_height_fog),
    CYAML_FIELD_MAPPING_PTR("bounds", CYAML_FLAG_OPTIONAL, struct neph_raw_height_fog, bounds,
                            bounds_fields),
    CYAML_FIELD_END,
};

static const cyaml_schema_field_t gaussian_fields[] = {
    FIELD_VEC3("center_m", struct neph_raw_gaussian, center_m),
    FIELD_NUMBER("width_m", struct neph_raw_gaussian, width_m),
    FIELD_NUMBER("extinction_per_m", struct neph_raw_gaussian, extinction_per_m),
    FIELDS_OPTICS(struct neph_raw_gaussian),
    CYAML_FIELD_MAPPING_PTR("bounds", CYAML_FLAG_OPTIONAL, struct neph_raw_gaussian, bounds,
                            bounds_fields),
    CYAML_FIELD_END,
};

static const cyaml_schema_field_t shell_fields[] = {
    FIELD_VEC3("center_m", struct neph_raw_shell, center_m),
    FIELD_NUMBER("radius_m", struct neph_raw_shell, radius_m),
    FIELD_NUMBER("scale_height_m", struct neph_raw_shell, scale_height_m),
    FIELD_NUMBER("extinction_per_m", struct neph_raw_shell, extinction_per_m),
    FIELDS_OPTICS(struct neph_raw_shell),
    CYAML_FIELD_MAPPING("bounds", CYAML_FLAG_DEFAULT, struct neph_raw_shell, bounds, bounds_fields),
    CYAML_FIELD_END,
};

static const cyaml_schema_value_t side = {CYAML_VALUE_INT(CYAML_FLAG_DEFAULT, int)};

static const cyaml_schema_field_t grid_fields[] = {
    CYAML_FIELD_SEQUENCE_FIXED("size", CYAML_FLAG_DEFAULT, struct neph_raw_grid, size, &side, 3),
    FIELD_VEC3("origin_m", struct neph_raw_grid, origin_m),
    FIELD_VEC3("spacing_m", struct neph_raw_grid, spacing_m),
    CYAML_FIELD_SEQUENCE("values", CYAML_FLAG_POINTER, struct neph_raw_grid, values, &number, 1,
                         NEPH_SCENE_VOXELS_MAX),
    FIELD_NUMBER("extinction_per_m", struct neph_raw_grid, extinction_per_m),
    FIELDS_OPTICS(struct neph_raw_grid),
    CYAML_FIELD_MAPPING_PTR("bounds", CYAML_FLAG_OPTIONAL, struct neph_raw_grid, bounds,
                            bounds_fields),
    CYAML_FIELD_END,
};

static const cyaml_schema_field_t volume_fields[] = {
    CYAML_FIELD_STRING_PTR("file", CYAML_FLAG_DEFAULT, struct neph_raw_volume, file, 1, 1000),
    CYAML_FIELD_STRING_PTR("grid", CYAML_FLAG_OPTIONAL, struct neph_raw_volume, grid, 1, 64),
    FIELD_VEC3("center_m", struct neph_raw_volume, center_m),
    FIELD_NUMBER("longest_side_m", struct neph_raw_volume, longest_side_m),
    CYAML_FIELD_INT_PTR("memory_limit_mib", CYAML_FLAG_OPTIONAL, struct neph_raw_volume,
                        memory_limit_mib),
    FIELD_NUMBER("extinction_per_m", struct neph_raw_volume, extinction_per_m),
    FIELDS_OPTICS(struct neph_raw_volume),
    CYAML_FIELD_MAPPING_PTR("bounds", CYAML_FLAG_OPTIONAL, struct neph_raw_volume, bounds,
                            bounds_fields),
    CYAML_FIELD_END,
};

static const cyaml_schema_field_t horizon_fields[] = {
    CYAML_FIELD_INT_PTR("seed", CYAML_FLAG_OPTIONAL, struct neph_raw_horizon, seed),
    FIELD_NUMBER_OPTIONAL("planet_radius_m", struct neph_raw_horizon, planet_radius_m),
    FIELD_NUMBER_OPTIONAL("bottom_m", struct neph_raw_horizon, bottom_m),
    FIELD_NUMBER_OPTIONAL("thickness_m", struct neph_raw_horizon, thickness_m),
    FIELD_NUMBER_OPTIONAL("coverage", struct neph_raw_horizon, coverage),
    FIELD_NUMBER_OPTIONAL("density", struct neph_raw_horizon, density),
    FIELD_NUMBER_OPTIONAL("texture_scale_m", struct neph_raw_horizon, texture_scale_m),
    FIELD_NUMBER_OPTIONAL("base_repeats", struct neph_raw_horizon, base_repeats),
    FIELD_NUMBER_OPTIONAL("detail_repeats", struct neph_raw_horizon, detail_repeats),
    FIELD_VEC3_OPTIONAL("wind_m", struct neph_raw_horizon, wind_m),
    FIELD_NUMBER("extinction_per_m", struct neph_raw_horizon, extinction_per_m),
    FIELDS_OPTICS(struct neph_raw_horizon),
    CYAML_FIELD_MAPPING("bounds", CYAML_FLAG_DEFAULT, struct neph_raw_horizon, bounds,
                        bounds_fields),
    CYAML_FIELD_END,
};

static const cyaml_schema_field_t medium_fields[] = {
    CYAML_FIELD_MAPPING_PTR("homogeneous", CYAML_FLAG_OPTIONAL, struct neph_raw_medium, homogeneous,
                            homogeneous_fields),
    CYAML_FIELD_MAPPING_PTR("height_fog", CYAML_FLAG_OPTIONAL, struct neph_raw_medium, height_fog,
                            height_fog_fields),
    CYAML_FIELD_MAPPING_PTR("gaussian", CYAML_FLAG_OPTIONAL, struct neph_raw_medium, gaussian,
                            gaussian_fields),
    CYAML_FIELD_MAPPING_PTR("shell", CYAML_FLAG_OPTIONAL, struct neph_raw_medium, shell,
                            shell_fields),
    CYAML_FIELD_MAPPING_PTR("grid", CYAML_FLAG_OPTIONAL, struct neph_raw_medium, grid, grid_fields),
    CYAML_FIELD_MAPPING_PTR("volume", CYAML_FLAG_OPTIONAL, struct neph_raw_medium, volume,
                            volume_fields),
    CYAML_FIELD_MAPPING_PTR("horizon", CYAML_FLAG_OPTIONAL, struct neph_raw_medium, horizon,
                            horizon_fields),
    CYAML_FIELD_END,
};

static const cyaml_schema_value_t medium = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct neph_raw_medium, medium_fields),
};

static const cyaml_schema_field_t display_fields[] = {
    FIELD_NUMBER("exposure_ev", struct neph_raw_display, exposure_ev),
    CYAML_FIELD_END,
};

static const cyaml_schema_field_t gate_fields[] = {
    CYAML_FIELD_STRING_PTR("engine", CYAML_FLAG_DEFAULT, struct neph_raw_gate, engine, 1, 64),
    FIELD_WORD("quantity", struct neph_raw_gate, quantity, quantity_words),
    FIELD_WORD("metric", struct neph_raw_gate, metric, metric_words),
    FIELD_WORD_OPTIONAL("mask", struct neph_raw_gate, mask, mask_words),
    FIELD_NUMBER("maximum", struct neph_raw_gate, maximum),
    CYAML_FIELD_STRING_PTR("reason", CYAML_FLAG_DEFAULT, struct neph_raw_gate, reason, 1, 1000),
    CYAML_FIELD_END,
};

static const cyaml_schema_value_t gate = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct neph_raw_gate, gate_fields),
};

static const cyaml_schema_field_t octaves_fields[] = {
    CYAML_FIELD_INT_PTR("count", CYAML_FLAG_OPTIONAL, struct neph_raw_octaves, count),
    FIELD_NUMBER_OPTIONAL("contribution", struct neph_raw_octaves, contribution),
    FIELD_NUMBER_OPTIONAL("attenuation", struct neph_raw_octaves, attenuation),
    FIELD_NUMBER_OPTIONAL("eccentricity", struct neph_raw_octaves, eccentricity),
    CYAML_FIELD_END,
};

static const cyaml_schema_field_t scene_fields[] = {
    CYAML_FIELD_STRING_PTR("name", CYAML_FLAG_DEFAULT, struct neph_raw_scene, name, 1, 64),
    CYAML_FIELD_STRING_PTR("title", CYAML_FLAG_DEFAULT, struct neph_raw_scene, title, 1,
                           NEPH_SCENE_TITLE_MAX),
    CYAML_FIELD_STRING_PTR("physics", CYAML_FLAG_DEFAULT, struct neph_raw_scene, physics, 1, 4000),
    CYAML_FIELD_MAPPING("camera", CYAML_FLAG_DEFAULT, struct neph_raw_scene, camera, camera_fields),
    CYAML_FIELD_MAPPING_PTR("frames", CYAML_FLAG_OPTIONAL, struct neph_raw_scene, frames,
                            frames_fields),
    CYAML_FIELD_MAPPING_PTR("sun", CYAML_FLAG_OPTIONAL, struct neph_raw_scene, sun, sun_fields),
    CYAML_FIELD_MAPPING_PTR("wind", CYAML_FLAG_OPTIONAL, struct neph_raw_scene, wind, wind_fields),
    FIELD_VEC3_OPTIONAL("background_w_per_m2_sr", struct neph_raw_scene, background_w_per_m2_sr),
    CYAML_FIELD_BOOL("environment_light", CYAML_FLAG_OPTIONAL, struct neph_raw_scene,
                     environment_light),
    FIELD_WORD("scattering", struct neph_raw_scene, scattering, scattering_words),
    CYAML_FIELD_MAPPING_PTR("octaves", CYAML_FLAG_OPTIONAL, struct neph_raw_scene, octaves,
                            octaves_fields),
    CYAML_FIELD_INT_PTR("bake_resolution", CYAML_FLAG_OPTIONAL, struct neph_raw_scene,
                        bake_resolution),
    FIELD_LIST("solids", struct neph_raw_scene, solids, &solid, 0, NEPH_SCENE_SOLIDS_MAX),
    FIELD_LIST("media", struct neph_raw_scene, media, &medium, 0, NEPH_SCENE_MEDIA_MAX),
    CYAML_FIELD_MAPPING_PTR("display", CYAML_FLAG_OPTIONAL, struct neph_raw_scene, display,
                            display_fields),
    FIELD_LIST("gates", struct neph_raw_scene, gates, &gate, 0, NEPH_SCENE_GATES_MAX),
    CYAML_FIELD_END,
};

static const cyaml_schema_value_t scene = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_POINTER, struct neph_raw_scene, scene_fields),
};

/* 1e6 m: beyond it float32 renderers resolve 6 cm and less, so no engine could be compared. */
#define FAR_M 1e6

/* Balls of ground and air may be planets. */
#define PLANET_M 1e8
#define FAST_M_PER_S 1e5 /* a time lapse: 3 km per frame at 30 Hz */
#define BRIGHT 1e9       /* one float32 pixel still holds the sum of 1e29 of them */

static const char albedo_note[] = "an albedo above 1 would make light out of nothing";
static const char color_note[] = "extinction per channel, in parts of extinction_per_m";
static const char voxels_note[] = "along the longest side of the grid that replaces the medium";
static const char g_note[] = "beyond 0.999 the phase function is a spike that Cycles clamps";

static const struct neph_field fields[] = {
    {"camera.position_m[]", "m", -FAR_M, FAR_M, NULL},
    {"camera.look_at_m[]", "m", -FAR_M, FAR_M, NULL},
    {"camera.keys[].frame", "", 0, 1e5, NULL},
    {"camera.keys[].position_m[]", "m", -FAR_M, FAR_M, NULL},
    {"camera.keys[].look_at_m[]", "m", -FAR_M, FAR_M, NULL},
    {"camera.up[]", "", -FAR_M, FAR_M, NULL},
    {"camera.vertical_fov_deg", "degrees", 0.1, 170, NULL},
    {"frames.count", "", 1, 10000, NULL},
    {"frames.rate_hz", "Hz", 0.001, 1000, NULL},
    {"frames.pauses[].frame", "", 0, 1e5, NULL},
    {"frames.pauses[].count", "frames", 1, 10000, NULL},
    {"frames.sizes[].frame", "", 0, 1e5, NULL},
    {"frames.sizes[].scale", "", 0.05, 4, "of the size that was asked for"},
    {"sun.direction[]", "", -FAR_M, FAR_M, NULL},
    {"sun.irradiance_w_per_m2[]", "W/m2", 0, BRIGHT, NULL},
    {"sun.keys[].frame", "", 0, 1e5, NULL},
    {"sun.keys[].direction[]", "", -FAR_M, FAR_M, NULL},
    {"sun.keys[].irradiance_w_per_m2[]", "W/m2", 0, BRIGHT, NULL},
    {"wind.velocity_m_per_s[]", "m/s", -FAST_M_PER_S, FAST_M_PER_S, NULL},
    {"wind.keys[].frame", "", 0, 1e5, NULL},
    {"wind.keys[].velocity_m_per_s[]", "m/s", -FAST_M_PER_S, FAST_M_PER_S, NULL},
    {"background_w_per_m2_sr[]", "W/m2/sr", 0, BRIGHT, NULL},
    {"solids[].box.min_m[]", "m", -FAR_M, FAR_M, NULL},
    {"solids[].box.max_m[]", "m", -FAR_M, FAR_M, NULL},
    {"solids[].box.albedo[]", "", 0, 1, albedo_note},
    {"solids[].sphere.center_m[]", "m", -PLANET_M, PLANET_M, NULL},
    {"solids[].sphere.radius_m", "m", 1e-4, PLANET_M, NULL},
    {"solids[].sphere.albedo[]", "", 0, 1, albedo_note},
    {"solids[].fence.origin_m[]", "m", -FAR_M, FAR_M, NULL},
    {"solids[].fence.bars", "", 1, NEPH_SCENE_SOLIDS_MAX, NULL},
    {"solids[].fence.pitch_m", "m", 1e-3, 1e3, NULL},
    {"solids[].fence.bar_width_m", "m", 1e-4, 1e3, NULL},
    {"solids[].fence.bar_depth_m", "m", 1e-4, 1e3, NULL},
    {"solids[].fence.height_m", "m", 1e-3, 1e4, NULL},
    {"solids[].fence.rows", "", 1, NEPH_SCENE_SOLIDS_MAX, NULL},
    {"solids[].fence.row_spacing_m", "m", 1e-3, 1e4, NULL},
    {"solids[].fence.rails.heights_m[]", "m", 0, 1e4, NULL},
    {"solids[].fence.rails.width_m", "m", 1e-4, 1e3, NULL},
    {"solids[].fence.rails.depth_m", "m", 1e-4, 1e3, NULL},
    {"solids[].fence.albedo[]", "", 0, 1, albedo_note},
    {"media[].homogeneous.extinction_per_m", "1/m", 0, 1e4, NULL},
    {"media[].homogeneous.albedo[]", "", 0, 1, albedo_note},
    {"media[].homogeneous.voxels", "nodes", NEPH_BAKE_RESOLUTION_MIN, NEPH_GRID_SIDE_MAX,
     voxels_note},
    {"media[].homogeneous.asymmetry_g", "", -0.999, 0.999, g_note},
    {"media[].homogeneous.bounds", "", 0, 0,
     "a homogeneous medium needs finite bounds: without them the sun, which is infinitely far "
     "away, would never arrive"},
    {"media[].homogeneous.bounds.min_m[]", "m", -FAR_M, FAR_M, NULL},
    {"media[].homogeneous.bounds.max_m[]", "m", -FAR_M, FAR_M, NULL},
    {"media[].height_fog.layers[].extinction_per_m", "1/m", 0, 1e4, NULL},
    {"media[].height_fog.layers[].falloff_per_m", "1/m", 0, 10,
     "a fog that grows denser with height is not modelled"},
    {"media[].height_fog.layers[].height_m", "m", -1e5, 1e5, NULL},
    {"media[].height_fog.unreal_layers[].fog_density", "(Unreal's UI value)", 0, 10, NULL},
    {"media[].height_fog.unreal_layers[].fog_height_falloff", "(Unreal's UI value)", 0, 10, NULL},
    {"media[].height_fog.unreal_layers[].fog_height_m", "m", -1e5, 1e5, NULL},
    {"media[].height_fog.albedo[]", "", 0, 1, albedo_note},
    {"media[].height_fog.voxels", "nodes", NEPH_BAKE_RESOLUTION_MIN, NEPH_GRID_SIDE_MAX,
     voxels_note},
    {"media[].height_fog.asymmetry_g", "", -0.999, 0.999, g_note},
    {"media[].height_fog.bounds.min_m[]", "m", -FAR_M, FAR_M, NULL},
    {"media[].height_fog.bounds.max_m[]", "m", -FAR_M, FAR_M, NULL},
    {"media[].homogeneous.extinction_color[]", "", 0, 1e3, color_note},
    {"media[].height_fog.extinction_color[]", "", 0, 1e3, color_note},
    {"media[].gaussian.center_m[]", "m", -FAR_M, FAR_M, NULL},
    {"media[].gaussian.width_m", "m", 1e-3, FAR_M, NULL},
    {"media[].gaussian.extinction_per_m", "1/m", 0, 1e4, NULL},
    {"media[].gaussian.extinction_color[]", "", 0, 1e3, color_note},
    {"media[].gaussian.albedo[]", "", 0, 1, albedo_note},
    {"media[].gaussian.voxels", "nodes", NEPH_BAKE_RESOLUTION_MIN, NEPH_GRID_SIDE_MAX, voxels_note},
    {"media[].gaussian.asymmetry_g", "", -0.999, 0.999, g_note},
    {"media[].gaussian.bounds.min_m[]", "m", -FAR_M, FAR_M, NULL},
    {"media[].gaussian.bounds.max_m[]", "m", -FAR_M, FAR_M, NULL},
    {"media[].shell.center_m[]", "m", -PLANET_M, PLANET_M, NULL},
    {"media[].shell.radius_m", "m", 1, 1e8, NULL},
    {"media[].shell.scale_height_m", "m", 1e-2, 1e7, NULL},
    {"media[].shell.extinction_per_m", "1/m", 0, 1e4, NULL},
    {"media[].shell.extinction_color[]", "", 0, 1e3, color_note},
    {"media[].shell.albedo[]", "", 0, 1, albedo_note},
    {"media[].shell.voxels", "nodes", NEPH_BAKE_RESOLUTION_MIN, NEPH_GRID_SIDE_MAX, voxels_note},
    {"media[].shell.asymmetry_g", "", -0.999, 0.999, g_note},
    {"media[].shell.bounds", "", 0, 0,
     "an atmosphere needs finite bounds: trackers and other engines must know where it ends"},
    {"media[].shell.bounds.min_m[]", "m", -PLANET_M, PLANET_M, NULL},
    {"media[].shell.bounds.max_m[]", "m", -PLANET_M, PLANET_M, NULL},
    {"media[].grid.size[]", "nodes", 1, 1024, NULL},
    {"media[].grid.origin_m[]", "m", -FAR_M, FAR_M, NULL},
    {"media[].grid.spacing_m[]", "m", 1e-4, FAR_M, NULL},
    {"media[].grid.values[]", "", 0, 1e6, NULL},
    {"media[].grid.extinction_per_m", "1/m", 0, 1e4, NULL},
    {"media[].grid.extinction_color[]", "", 0, 1e3, color_note},
    {"media[].grid.albedo[]", "", 0, 1, albedo_note},
    {"media[].grid.voxels", "nodes", NEPH_BAKE_RESOLUTION_MIN, NEPH_GRID_SIDE_MAX, voxels_note},
    {"media[].grid.asymmetry_g", "", -0.999, 0.999, g_note},
    {"media[].grid.bounds.min_m[]", "m", -FAR_M, FAR_M, NULL},
    {"media[].grid.bounds.max_m[]", "m", -FAR_M, FAR_M, NULL},
    {"media[].volume.center_m[]", "m", -FAR_M, FAR_M, NULL},
    {"media[].volume.longest_side_m", "m", 1e-3, FAR_M, NULL},
    {"media[].volume.memory_limit_mib", "MiB", 1, NEPH_GRID_NODES_MAX * sizeof(float) >> 20,
     "of voxels in memory, 4 bytes each"},
    {"media[].volume.extinction_per_m", "1/m", 0, 1e4, NULL},
    {"media[].volume.extinction_color[]", "", 0, 1e3, color_note},
    {"media[].volume.albedo[]", "", 0, 1, albedo_note},
    {"media[].volume.voxels", "nodes", NEPH_BAKE_RESOLUTION_MIN, NEPH_GRID_SIDE_MAX, voxels_note},
    {"media[].volume.asymmetry_g", "", -0.999, 0.999, g_note},
    {"media[].volume.bounds.min_m[]", "m", -FAR_M, FAR_M, NULL},
    {"media[].volume.bounds.max_m[]", "m", -FAR_M, FAR_M, NULL},
    {"media[].horizon.seed", "", 0, 1e9, NULL},
    {"media[].horizon.planet_radius_m", "m", 1e3, 1e8, NULL},
    {"media[].horizon.bottom_m", "m", -FAR_M, FAR_M, NULL},
    {"media[].horizon.thickness_m", "m", 1, 1e5, NULL},
    {"media[].horizon.coverage", "", 0, 1, NULL},
    {"media[].horizon.density", "", 0, 1e3, NULL},
    {"media[].horizon.texture_scale_m", "m", 1, FAR_M, NULL},
    {"media[].horizon.base_repeats", "", 1e-2, 1e4, NULL},
    {"media[].horizon.detail_repeats", "", 1e-2, 1e4, NULL},
    {"media[].horizon.wind_m[]", "m", -FAR_M, FAR_M, NULL},
    {"media[].horizon.extinction_per_m", "1/m", 0, 1e4, NULL},
    {"media[].horizon.extinction_color[]", "", 0, 1e3, color_note},
    {"media[].horizon.albedo[]", "", 0, 1, albedo_note},
    {"media[].horizon.voxels", "nodes", NEPH_BAKE_RESOLUTION_MIN, NEPH_GRID_SIDE_MAX, voxels_note},
    {"media[].horizon.asymmetry_g", "", -0.999, 0.999, g_note},
    {"media[].horizon.bounds", "", 0, 0,
     "a cloud layer needs finite bounds: trackers and other engines must know where it ends"},
    {"media[].horizon.bounds.min_m[]", "m", -FAR_M, FAR_M, NULL},
    {"media[].horizon.bounds.max_m[]", "m", -FAR_M, FAR_M, NULL},
    {"bake_resolution", "nodes", NEPH_BAKE_RESOLUTION_MIN, NEPH_GRID_SIDE_MAX,
     "of the grid that engines without formulas get, along its longest side"},
    {"octaves.count", "", 1, 16, NULL},
    {"octaves.contribution", "", 0, 1, NULL},
    {"octaves.attenuation", "", 0, 1, NULL},
    {"octaves.eccentricity", "", 0, 1, NULL},
    {"display.exposure_ev", "EV", -40, 40, NULL},
    {"gates[].maximum", "", 0, BRIGHT, NULL},
};

const cyaml_schema_value_t *neph_schema_root(void)
{
    return &scene;
}

const char *neph_schema_metric_name(int metric)
{
    return metric_words[metric].str;
}

const char *neph_schema_mask_name(int mask)
{
    return mask_words[mask].str;
}

const struct neph_field *neph_schema_field(const char *pattern)
{
    for (size_t i = 0; i < COUNT(fields); i++)
        if (!strcmp(fields[i].pattern, pattern))
            return &fields[i];
    return NULL;
}
