/* SPDX-License-Identifier: MIT
 *
 * The scene in memory, the input of all renderers. Every number is in SI units and every default is
 * applied, so its users do not depend on the file's syntax.
 *
 * World: metres, right-handed, +Y up. Extinction in 1/m. Radiance in W m^-2 sr^-1, scene-linear
 * Rec.709. albedo = scattering / extinction. HG asymmetry g > 0 is forward.
 */
#ifndef NEPH_SCENES_SCENE_H
#define NEPH_SCENES_SCENE_H

#include "base/arena.h"
#include "base/hash.h"
#include "base/status.h"
#include "base/vec3.h"
#include "scenes/fog_look.h"
#include "scenes/phase.h"
#include "scenes/surface.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#define NEPH_SCENE_MEDIA_MAX 8
#define NEPH_SCENE_LIGHTS_MAX 16
#define NEPH_SCENE_SOLIDS_MAX 1024     /* after fences are expanded into their bars */
#define NEPH_SCENE_INSTANCES_MAX 10000 /* solids of meshes, beside these */
#define NEPH_SCENE_KEYS_MAX 1024
#define NEPH_FOG_LAYERS_MAX 2
#define NEPH_SCENE_MOVERS_MAX 16
#define NEPH_SCENE_ADVANCES_MAX 16

/* Axis-aligned box; a side at -inf or +inf is open. */
struct neph_bounds {
    struct neph_vec3 min_m, max_m;
};

enum neph_medium_kind {
    NEPH_MEDIUM_HOMOGENEOUS,
    NEPH_MEDIUM_HEIGHT_FOG,
    NEPH_MEDIUM_GAUSSIAN, /* a blob: extinction * exp(-r^2 / (2 width^2)) */
    NEPH_MEDIUM_SHELL,    /* an atmosphere: extinction * exp(-(r - radius) / scale height) */
    NEPH_MEDIUM_GRID,     /* voxels, trilinear (scenes/grid.h) */
    NEPH_MEDIUM_HORIZON,  /* procedural clouds (scenes/horizon.h) */
    NEPH_MEDIUM_PLUME,    /* smoke: thinner along an axis and across it (scenes/plume.c) */
    NEPH_MEDIUM_TENT,     /* a layer around a ball, such as ozone (scenes/tent.c) */
    NEPH_MEDIUM_KIND_COUNT,
};

/* Properties of a kind. */
struct neph_medium_facts {
    const char *name;     /* "height fog", ...: for messages */
    const char *place;    /* "at the centre", ...: where it has its extinction_per_m */
    bool is_fog;          /* consists only of layers that thin out with height */
    bool is_even;         /* homogeneous within its bounds */
    bool has_closed_form; /* see neph_medium_optical_depth() */
    bool has_kinks;       /* inside its bounds: quadrature along a ray must bisect */
    bool needs_majorants; /* collisions are found among the candidates of a majorant grid */
    int majorant_cells;   /* about this many cells: fewer cost candidates, more cost steps */
};

/* sigma_t(y) = extinction * exp(-falloff * (y - height)); falloff >= 0, 0 is homogeneous. */
struct neph_fog_layer {
    double extinction_per_m;
    double falloff_per_m;
    double height_m;
};

/* Without a boundary; the medium's bounds clip it. */
struct neph_gaussian {
    struct neph_vec3 center_m;
    double width_m; /* > 0: the standard deviation along any line through the centre */
};

/* Empty below the radius. */
struct neph_shell {
    struct neph_vec3 center_m;
    double radius_m; /* of the ground, > 0 */
    double scale_height_m;
};

/* Density 1 at the peak, 0 at half_width_m above and below it. */
struct neph_tent {
    struct neph_vec3 center_m;
    double radius_m;                 /* of the ground, > 0 */
    double altitude_m, half_width_m; /* of the peak; > 0 */
};

/* Empty below the foot. */
struct neph_plume {
    struct neph_vec3 foot_m, axis;  /* unit */
    double width_m, scale_height_m; /* > 0 */
};

/* Droplets of a gamma distribution (scenes/density_units.h); 0: not given. */
struct neph_droplet_radii {
    double effective_radius_um; /* NAN: it varies, and the extinction of each voxel has it */
    double effective_variance;
};

/* Rotation about an axis of the world, right-handed. */
struct neph_turn {
    int axis;            /* 0 x, 1 y, 2 z */
    double cosine, sine; /* of its angle; 0, 0: no rotation */
};

struct neph_grid;    /* scenes/grid.h */
struct neph_horizon; /* scenes/horizon.h */

/* sigma_t(x, channel) = extinction_color[channel] * extinction(x), sigma_s = albedo * sigma_t. All
 * functions of scenes/media.h use the scalar extinction(x); only transmittance has colour. */
struct neph_medium {
    enum neph_medium_kind kind;
    /* The medium exists inside its bounds only. If they are turned, `bounds` is the box around
     * them, and `box`, finite, is what is turned about its middle. */
    struct neph_bounds bounds, box;
    struct neph_turn turn;                /* none: `box` is not used */
    struct neph_rgb extinction_color;     /* >= 0 per channel; 1 1 1 is grey */
    struct neph_rgb albedo;               /* 0..1 per channel */
    struct neph_rgb emission_w_per_m2_sr; /* >= 0; per absorption: scenes/emission.h */
    struct neph_phase phase;
    /* Gaussian: at the centre. Shell: at its radius. Tent: at its peak. Grid and Horizon: per unit
     * of density. */
    double extinction_per_m;
    struct neph_gaussian gaussian;
    struct neph_shell shell;
    struct neph_plume plume;
    struct neph_tent tent;
    struct neph_grid *grid;       /* owned by the scene; only for kind GRID */
    struct neph_horizon *horizon; /* owned by the scene; only for kind HORIZON */
    /* Homogeneous: one layer with falloff 0. Height fog: the layers add. */
    int layer_count;
    struct neph_fog_layer layers[NEPH_FOG_LAYERS_MAX];
    /* The droplets of each layer; other kinds have only the first. With them the extinction is
     * translated into other units; no rendered value depends on them. */
    struct neph_droplet_radii droplets[NEPH_FOG_LAYERS_MAX];
};

enum neph_solid_kind {
    NEPH_SOLID_BOX,
    NEPH_SOLID_SPHERE,
    NEPH_SOLID_MESH, /* of triangles; several solids may share a mesh (scenes/mesh.h) */
    NEPH_SOLID_KIND_COUNT,
};

struct neph_mesh; /* scenes/mesh.h */

/* Opaque; Lambertian unless its surface differs. The sun lights it directly when its albedo is not
 * 0. */
struct neph_solid {
    enum neph_solid_kind kind;
    struct neph_bounds box; /* kind BOX; finite */
    /* The turn of a box about its centre, or of a mesh about center_m; none for a static solid. */
    struct neph_turn turn;
    struct neph_vec3 center_m; /* of a mesh: the place of its origin */
    double radius_m;
    const struct neph_mesh *mesh; /* kind MESH; owned by the scene */
    double scale_m;               /* > 0: the mesh's unit of length */
    struct neph_turn yaw;         /* of a mesh, about its y axis, before `turn` */
    struct neph_rgb albedo;       /* base colour */
    struct neph_surface surface;
    bool thin;  /* a bar of a fence: for the thin-object mask */
    bool moves; /* a mover has several keys for it */
};

struct neph_sun {
    bool present;
    struct neph_vec3 direction;          /* unit, from the scene towards the sun */
    struct neph_rgb irradiance_w_per_m2; /* on a plane perpendicular to the direction */
};

struct neph_light_key {
    double frame;
    struct neph_vec3 position_m;
    struct neph_rgb intensity_w_per_sr;
    struct neph_vec3 axis; /* unit; unused for a point light */
    bool cut;              /* the light jumps here; until then it stays at the key before */
};

/* A point light or a spot light (scenes/lights.h); with keys as it is in frame 0. */
struct neph_light {
    struct neph_vec3 position_m;
    struct neph_rgb intensity_w_per_sr; /* of a spot: within its inner angle */
    bool is_spot;
    struct neph_vec3 axis; /* unit, from the light */
    /* Cosines of the angles from the axis at which the falloff begins and ends. */
    double inner_cosine, outer_cosine; /* inner > outer */
    int key_count;                     /* 0: the light is static; else >= 2 */
    struct neph_light_key *keys;
};

/* Orders of scattering; the same meaning in all engines. */
enum neph_scattering {
    NEPH_SCATTERING_NONE,   /* media only attenuate; solids are lit by attenuated sun and lights */
    NEPH_SCATTERING_SINGLE, /* also their light, scattered exactly once by a medium */
    NEPH_SCATTERING_MULTIPLE, /* all orders, with surface bounces */
    NEPH_SCATTERING_COUNT,
};

/* Multiple scattering as a sum of scaled single scatterings, a non-physical model: octave i has
 * sigma_s a^i, phase asymmetry g c^i and extinction towards the sun sigma_t b^i (Wrenninge, Kulla,
 * Lundqvist, "Oz: The Great and Volumetric", SIGGRAPH 2013; Hillaire, SIGGRAPH 2016). */
struct neph_octaves {
    int count;           /* 1..16; 1 is single scattering */
    double contribution; /* a, 0..1 */
    double attenuation;  /* b, 0..1 */
    double eccentricity; /* c, 0..1 */
};

/* Keys of all kinds begin with their frame and are in ascending order. Before the first and after
 * the last key that key is used; scenes/motion.h defines the values between keys. */
struct neph_camera_key {
    double frame;
    struct neph_vec3 position_m;
    struct neph_vec3 look_at_m;
    bool cut; /* the camera jumps here; until then it stays at the key before */
};

struct neph_sun_key {
    double frame;
    struct neph_vec3 direction; /* unit */
    struct neph_rgb irradiance_w_per_m2;
};

struct neph_wind_key {
    double frame;
    struct neph_vec3 velocity_m_per_s;
};

/* Displacement of a solid from its place in the file, and rotation about the axis and pivot of its
 * mover. */
struct neph_solid_key {
    double frame;
    struct neph_vec3 move_m;
    double turn_rad;
};

/* Solids that move together: the solids of one entry of the file. */
struct neph_mover {
    int first, count; /* of the scene's solids */
    int axis;         /* 0 x, 1 y, 2 z, through the pivot, which moves as well */
    struct neph_vec3 pivot_m;
    int key_count; /* >= 1 */
    struct neph_solid_key *keys;
};

/* The key frame stands still for `count` more frames. */
struct neph_pause {
    int frame; /* of the keys */
    int count;
};

/* The media are absent in `count` key frames from this one on. */
struct neph_clear {
    int frame;
    int count;
};

/* From this frame on frames have the requested size times the scale. */
struct neph_frame_scale {
    int frame; /* not of the keys */
    double scale;
};

/* The camera of one frame. Unit axes, right-handed: right x up = -forward. */
struct neph_camera {
    struct neph_vec3 position_m;
    struct neph_vec3 right, up, forward;
    double vertical_fov_rad;      /* perspective */
    double orthographic_height_m; /* of the image, at any distance; 0: perspective */
};

/* The line of sight of a pixel; the direction is unit. */
struct neph_pixel_ray {
    struct neph_vec3 origin_m, direction;
};

/* Data for other modules, from the scene's file. */
struct neph_gates;         /* limits of engines: scenes/gates.h */
struct neph_scene_display; /* exposure: scenes/display.h */
struct neph_failing;       /* stress tests: scenes/failing.h */
struct neph_injections;    /* the real-time renderer: scenes/injection.h */

struct neph_scene {
    struct neph_arena arena; /* memory of all members, except grids, horizons, meshes */

    const char *path;        /* the file it came from */
    const char *name;        /* a plain identifier [a-z0-9_]+ */
    const char *title;       /* one line */
    const char *description; /* what the scene isolates and its reference; "": none */
    const char *warning;     /* about a deprecated key in the file; NULL: none */

    int camera_key_count; /* >= 1 */
    struct neph_camera_key *camera_keys;
    struct neph_vec3 camera_up;
    double vertical_fov_rad; /* one of the two, the other is 0; see struct neph_camera */
    double orthographic_height_m;

    int frame_count; /* >= 1 */
    double frame_rate_hz;
    int pause_count;
    struct neph_pause *pauses;                /* ascending frames */
    int advance_count;                        /* 0: the key frame advances by 1 per frame */
    double advances[NEPH_SCENE_ADVANCES_MAX]; /* else by these numbers in turn; >= 0 */
    int clear_count;
    struct neph_clear *clears; /* ascending frames */
    int frame_scale_count;
    struct neph_frame_scale *frame_scales; /* ascending frames */

    struct neph_sun sun; /* of frame 0 */
    int sun_key_count;   /* 0: the sun is static; else >= 2 */
    struct neph_sun_key *sun_keys;
    int wind_key_count; /* 0: no wind */
    struct neph_wind_key *wind_keys;
    int light_count;
    struct neph_light lights[NEPH_SCENE_LIGHTS_MAX];
    struct neph_rgb background_w_per_m2_sr; /* uniform radiance of the sky */
    bool environment_light; /* the background lights media and solids; else it is only visible */
    enum neph_scattering scattering;
    struct neph_octaves octaves; /* for non-physical lighting models only */
    int bake_resolution; /* nodes along the longest side of a grid made for engines without formulas
                          */

    int solid_count;
    struct neph_solid *solids;
    struct neph_box_tree *solid_tree; /* over their bounds (scenes/solids.h); NULL: none */
    int mesh_count;
    struct neph_mesh **meshes; /* of its solids */
    /* Which parts of a mesh with `alpha: coverage` a ray meets: a random number of this and of the
     * ray decides. 0: the parts of 1/2 and more. Not in the hash. */
    uint64_t coverage_draw;
    int mover_count;
    struct neph_mover *movers; /* of some of the solids */
    /* The solids without motion, the same in all frames, if neph_scene_at() has placed solids that
     * move; else NULL. neph_scene_shift() has moved the scene by `shift_m` from there. */
    const struct neph_solid *unmoved_solids;
    struct neph_vec3 shift_m;
    int medium_count;
    struct neph_medium media[NEPH_SCENE_MEDIA_MAX];
    struct neph_fog_look fog_look; /* of its height fog; for non-physical models only */

    /* All are NULL in a scene that was built in memory. */
    const struct neph_gates *gates;           /* use neph_scene_gates() */
    const struct neph_scene_display *display; /* use neph_scene_display() */
    const struct neph_failing *failing;
    const struct neph_injections *injections; /* use neph_scene_injections() */
    bool borrows;     /* made by neph_scene_at() or neph_scene_variant(): all pointers belong to the
                     scene it came from */
    bool is_as_filed; /* with `borrows`: media, solids and scattering are unchanged from the file */

    /* BLAKE2b of everything above that changes a rendered value (not names, gates, display,
     * failures, injections). */
    char hash[NEPH_HASH_HEX_SIZE];
};

/* Reads and checks a scene file. A .vdb in its place gives the scene of neph_volume_scene_text().
 * The diag has all errors of the file in the order of lines: the first as its message, the others
 * in `more`. Each names file, line, column, value and allowed range. */
enum neph_status neph_scene_load(const char *path, struct neph_scene **scene,
                                 struct neph_diag *diag);

/* Whether a gate may limit the metric of this name; if not, `why` receives the reason: "is no
 * metric". */
typedef bool neph_gate_metric_check(const char *metric, char *why, size_t size);

/* The same, with a check of the metrics of gates, which scenes/ cannot know. */
enum neph_status neph_scene_load_checked(const char *path, neph_gate_metric_check *check,
                                         struct neph_scene **scene, struct neph_diag *diag);

/* Reads the file of `scene` again at a point of its sweep (scenes/failing.h). Errors as for
 * loading: a point may be an invalid scene. */
enum neph_status neph_scene_load_point(const struct neph_scene *scene, int point,
                                       struct neph_scene **made, struct neph_diag *diag);

/* Prints all keys of a scene file as a Markdown table, which is part of scenes/README.md. */
void neph_scene_print_keys(FILE *file);

/* The name that the scene in this file must have: "folder/name.yaml" -> "name". The name of a .vdb
 * is in lower case, with _ in place of other characters: "Cloud-1.vdb" -> "cloud_1". The caller
 * frees it; NULL when memory is short. */
char *neph_scene_name_from_path(const char *path);

/* Computes scene->hash from everything that changes a rendered value. Loading does it; a scene that
 * was built in memory needs it before it is rendered through the store. */
enum neph_status neph_scene_hash(struct neph_scene *scene, struct neph_diag *diag);

/* NULL is fine. */
void neph_scene_destroy(struct neph_scene *scene);

/* The camera of a frame (0-based; may be fractional). */
struct neph_camera neph_scene_camera(const struct neph_scene *scene, double frame);

/* Half the height of the image: at distance 1 for a perspective camera, in metres for an
 * orthographic one. */
double neph_camera_half_height(const struct neph_camera *camera);

/* The ray through the centre of pixel (i, j), row 0 on top. It begins at the camera's position;
 * rays of an orthographic camera are parallel to `forward` and begin on the plane through it. */
struct neph_pixel_ray neph_camera_ray(const struct neph_camera *camera, int width_px, int height_px,
                                      double i, double j);

/* The inverse of neph_camera_ray(): the pixel (i, j), real numbers, whose ray meets the point.
 * `depth_m` is the point's distance from the camera's plane along `forward`. */
struct neph_point_in_frame {
    double i, j, depth_m;
};

/* False when no ray of the camera passes through the point: it is in or behind the plane of a
 * perspective camera. */
bool neph_camera_find_pixel(const struct neph_camera *camera, int width_px, int height_px,
                            struct neph_vec3 point_m, struct neph_point_in_frame *found);

const char *neph_scattering_name(enum neph_scattering scattering);

#endif
