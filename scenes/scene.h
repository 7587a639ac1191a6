/* SPDX-License-Identifier: MIT
 *
 * What is rendered: the scene in memory. Every number is in SI units and every default is already
 * applied, so nothing downstream needs to know how the scene was written.
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
#include <stdio.h>

#define NEPH_SCENE_MEDIA_MAX 8
#define NEPH_SCENE_LIGHTS_MAX 16
#define NEPH_SCENE_SOLIDS_MAX 1024 /* after fences are expanded into their bars */
#define NEPH_SCENE_KEYS_MAX 1024
#define NEPH_FOG_LAYERS_MAX 2
#define NEPH_SCENE_MOVERS_MAX 16
#define NEPH_SCENE_ADVANCES_MAX 16

/* Axis-aligned; a side at -inf or +inf is open. */
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

/* What is known of a kind. */
struct neph_medium_facts {
    const char *name;     /* "height fog", ...: for messages */
    bool is_fog;          /* layers that thin out with height, and nothing else */
    bool is_even;         /* the same everywhere within its bounds */
    bool has_closed_form; /* see neph_medium_optical_depth() */
    bool has_kinks;       /* inside its bounds: quadrature along a ray must bisect */
    bool needs_majorants; /* collisions are found among the candidates of a majorant grid, */
    int majorant_cells;   /* of about so many cells: fewer cost candidates, more cost steps */
};

/* sigma_t(y) = extinction * exp(-falloff * (y - height)); falloff >= 0, 0 is homogeneous. */
struct neph_fog_layer {
    double extinction_per_m;
    double falloff_per_m;
    double height_m;
};

/* Infinitely wide in principle; the medium's bounds cut it. */
struct neph_gaussian {
    struct neph_vec3 center_m;
    double width_m; /* > 0: the standard deviation along any line through the centre */
};

/* Nothing below the radius. */
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

/* Nothing below the foot. */
struct neph_plume {
    struct neph_vec3 foot_m, axis;  /* unit */
    double width_m, scale_height_m; /* > 0 */
};

struct neph_grid;    /* scenes/grid.h */
struct neph_horizon; /* scenes/horizon.h */

/* sigma_t(x, channel) = extinction_color[channel] * extinction(x), sigma_s = albedo * sigma_t. All
 * functions of scenes/media.h speak of the scalar extinction(x); only transmittance has colour. */
struct neph_medium {
    enum neph_medium_kind kind;
    struct neph_bounds bounds;            /* the medium exists inside only */
    struct neph_rgb extinction_color;     /* >= 0 per channel; 1 1 1 is grey */
    struct neph_rgb albedo;               /* 0..1 per channel */
    struct neph_rgb emission_w_per_m2_sr; /* >= 0; of what is absorbed: scenes/emission.h */
    struct neph_phase phase;
    /* Gaussian: at the centre. Shell: at its radius. Tent: at its peak. Grid and Horizon: per unit
     * of density. */
    double extinction_per_m;
    struct neph_gaussian gaussian;
    struct neph_shell shell;
    struct neph_plume plume;
    struct neph_tent tent;
    struct neph_grid *grid;       /* owned by the scene; kind GRID alone */
    struct neph_horizon *horizon; /* owned by the scene; kind HORIZON alone */
    /* Homogeneous: one layer with falloff 0. Height fog: the layers add. */
    int layer_count;
    struct neph_fog_layer layers[NEPH_FOG_LAYERS_MAX];
};

enum neph_solid_kind {
    NEPH_SOLID_BOX,
    NEPH_SOLID_SPHERE,
    NEPH_SOLID_KIND_COUNT,
};

/* About an axis of the world, by the right hand. */
struct neph_turn {
    int axis;            /* 0 x, 1 y, 2 z */
    double cosine, sine; /* of its angle; 0, 0: it does not turn at all */
};

/* Opaque; Lambertian, but for what its surface says. Lit by the sun directly when its albedo is not
 * 0. */
struct neph_solid {
    enum neph_solid_kind kind;
    struct neph_bounds box; /* kind BOX; finite */
    struct neph_turn turn;  /* of a box, about its middle; it has none before it moves */
    struct neph_vec3 center_m;
    double radius_m;
    struct neph_rgb albedo; /* its base colour */
    struct neph_surface surface;
    bool thin; /* a bar of a fence: for the thin-object mask */
};

struct neph_sun {
    bool present;
    struct neph_vec3 direction;          /* unit, from the scene towards the sun */
    struct neph_rgb irradiance_w_per_m2; /* on a plane across the direction */
};

/* A point that shines, all around or into a cone: scenes/lights.h says how brightly. */
struct neph_light {
    struct neph_vec3 position_m;
    struct neph_rgb intensity_w_per_sr; /* of a spot: within its inner angle */
    bool is_spot;
    struct neph_vec3 axis; /* unit, from the light */
    /* Cosines of the angles from the axis up to which it shines in full, and from which on not. */
    double inner_cosine, outer_cosine; /* inner > outer */
};

/* What light does. The same switch means the same thing in all engines. */
enum neph_scattering {
    NEPH_SCATTERING_NONE,   /* media only attenuate; solids are lit by attenuated sun and lights */
    NEPH_SCATTERING_SINGLE, /* plus light of these scattered exactly once by a medium */
    NEPH_SCATTERING_MULTIPLE, /* everything: all orders, surface bounces included */
    NEPH_SCATTERING_COUNT,
};

/* Multiple scattering as a sum of scaled single scatterings, a look and not physics: octave i has
 * sigma_s a^i, phase asymmetry g c^i and extinction towards the sun sigma_t b^i (Wrenninge, Kulla,
 * Lundqvist, "Oz: The Great and Volumetric", SIGGRAPH 2013; Hillaire, SIGGRAPH 2016). */
struct neph_octaves {
    int count;           /* 1..16; 1 is single scattering */
    double contribution; /* a, 0..1 */
    double attenuation;  /* b, 0..1 */
    double eccentricity; /* c, 0..1 */
};

/* Keys of all kinds begin with their frame, and stand in ascending order of it. They are held
 * before the first and after the last; scenes/motion.h tells what is between them. */
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

/* Where a solid is from where it was built: moved, and turned about the axis and pivot of its
 * mover. */
struct neph_solid_key {
    double frame;
    struct neph_vec3 move_m;
    double turn_rad;
};

/* Solids that move as one: those of one entry of the file. */
struct neph_mover {
    int first, count; /* of the scene's solids */
    int axis;         /* 0 x, 1 y, 2 z, through the pivot, which moves along */
    struct neph_vec3 pivot_m;
    int key_count; /* >= 1 */
    struct neph_solid_key *keys;
};

/* The keys' frame stands still for so many more pictures. */
struct neph_pause {
    int frame; /* of the keys */
    int count;
};

/* In so many frames of the keys from this one on there are no media. */
struct neph_clear {
    int frame;
    int count;
};

/* From this picture on pictures have the asked-for size times the scale. */
struct neph_frame_scale {
    int frame; /* of the pictures */
    double scale;
};

/* The camera of one frame. Unit axes, right-handed: right x up = -forward. */
struct neph_camera {
    struct neph_vec3 position_m;
    struct neph_vec3 right, up, forward;
    double vertical_fov_rad;      /* perspective */
    double orthographic_height_m; /* of the picture, at any distance; 0: perspective */
};

/* What is seen in a pixel lies along it; the direction is unit. */
struct neph_pixel_ray {
    struct neph_vec3 origin_m, direction;
};

/* What others keep beside a scene, from its file. */
struct neph_gates;         /* limits of engines: scenes/gates.h */
struct neph_scene_display; /* exposure: scenes/display.h */
struct neph_failing;       /* stress tests: scenes/failing.h */
struct neph_injections;    /* the real-time renderer: scenes/injection.h */

struct neph_scene {
    struct neph_arena arena; /* has what follows, but for grids and horizons */

    const char *path;        /* the file it came from */
    const char *name;        /* a plain identifier [a-z0-9_]+ */
    const char *title;       /* one line */
    const char *description; /* what the scene isolates and which truth applies; "": none */
    const char *warning;     /* of an older spelling in the file, for a person; NULL: none */

    int camera_key_count; /* >= 1 */
    struct neph_camera_key *camera_keys;
    struct neph_vec3 camera_up;
    double vertical_fov_rad; /* one of the two, the other is 0; see struct neph_camera */
    double orthographic_height_m;

    int frame_count; /* >= 1 */
    double frame_rate_hz;
    int pause_count;
    struct neph_pause *pauses; /* ascending frames */
    int advance_count;         /* 0: from picture to picture the keys go on by 1 frame */
    double advances[NEPH_SCENE_ADVANCES_MAX]; /* by so many frames, by turns; >= 0 */
    int clear_count;
    struct neph_clear *clears; /* ascending frames */
    int frame_scale_count;
    struct neph_frame_scale *frame_scales; /* ascending frames */

    struct neph_sun sun; /* of frame 0 */
    int sun_key_count;   /* 0: the sun stands still; else >= 2 */
    struct neph_sun_key *sun_keys;
    int wind_key_count; /* 0: no wind */
    struct neph_wind_key *wind_keys;
    int light_count;
    struct neph_light lights[NEPH_SCENE_LIGHTS_MAX];
    struct neph_rgb background_w_per_m2_sr; /* uniform radiance of the sky */
    bool environment_light; /* the background lights media and solids; else it is only seen */
    enum neph_scattering scattering;
    struct neph_octaves octaves; /* for lighting models that use them; physics does not */
    int bake_resolution; /* nodes along the longest side of a grid made for engines without formulas
                          */

    int solid_count;
    struct neph_solid *solids;
    int mover_count;
    struct neph_mover *movers; /* of some of the solids */
    int medium_count;
    struct neph_medium media[NEPH_SCENE_MEDIA_MAX];
    struct neph_fog_look fog_look; /* of the height fog among them; physics does not look at it */

    /* All are NULL in a scene that was built in memory. */
    const struct neph_gates *gates;           /* ask neph_scene_gates() */
    const struct neph_scene_display *display; /* ask neph_scene_display() */
    const struct neph_failing *failing;
    const struct neph_injections *injections; /* ask neph_scene_injections() */
    bool borrows;     /* made by neph_scene_at() or neph_scene_variant(): all pointers belong to the
                     scene it came from */
    bool is_as_filed; /* of one that borrows: media, solids and scattering are those of its file */

    /* BLAKE2b of everything above that changes a rendered value (not names, gates, display,
     * failures, injections). */
    char hash[NEPH_HASH_HEX_SIZE];
};

/* Read and check a scene file. A .vdb in its place is the scene of neph_volume_scene_text(). All
 * errors of the file are in the diag, by their lines: the first as its message, the others in
 * `more`. Each names file, line, column, value and allowed range. */
enum neph_status neph_scene_load(const char *path, struct neph_scene **scene,
                                 struct neph_diag *diag);

/* Whether a gate may limit the metric of this name; if not, `why` says the reason: "is no metric".
 */
typedef bool neph_gate_metric_check(const char *metric, char *why, size_t size);

/* The same, with a check of the metrics of gates, which scenes do not know. */
enum neph_status neph_scene_load_checked(const char *path, neph_gate_metric_check *check,
                                         struct neph_scene **scene, struct neph_diag *diag);

/* The file of `scene` read anew, at a point of its sweep (scenes/failing.h). Errors as of loading:
 * a point may be no scene. */
enum neph_status neph_scene_load_point(const struct neph_scene *scene, int point,
                                       struct neph_scene **made, struct neph_diag *diag);

/* All keys of a scene file, as a table of Markdown: what scenes/README.md holds. */
void neph_scene_print_keys(FILE *file);

/* The name that the scene in this file must have: "folder/name.yaml" -> "name". That of a .vdb is
 * in lower case, with _ in place of other characters: "Cloud-1.vdb" -> "cloud_1". For the caller to
 * free; NULL when memory is short. */
char *neph_scene_name_of(const char *path);

/* Fill scene->hash from everything that changes a rendered value: loading does it; a scene that was
 * built in memory needs it before it is rendered through the store. */
enum neph_status neph_scene_hash(struct neph_scene *scene, struct neph_diag *diag);

/* NULL is fine. */
void neph_scene_destroy(struct neph_scene *scene);

/* The camera of a picture (0-based; may be fractional). */
struct neph_camera neph_scene_camera(const struct neph_scene *scene, double frame);

/* Half the height of the picture: of a perspective camera in its image plane at distance 1, of an
 * orthographic one [m]. */
double neph_camera_half_height(const struct neph_camera *camera);

/* The ray through the centre of pixel (i, j), row 0 on top. It begins at the camera's position;
 * rays of an orthographic camera are parallel to `forward` and begin on the plane through it. */
struct neph_pixel_ray neph_camera_ray(const struct neph_camera *camera, int width_px, int height_px,
                                      double i, double j);

/* The inverse of neph_camera_ray(): the ray through pixel (i, j), a real number each, meets the
 * point. `depth_m` is the point's distance from the camera's plane along `forward`. */
struct neph_point_in_frame {
    double i, j, depth_m;
};

/* False when no ray of the camera goes through the point: it lies in or behind the plane of a
 * perspective camera. */
bool neph_camera_find_pixel(const struct neph_camera *camera, int width_px, int height_px,
                            struct neph_vec3 point_m, struct neph_point_in_frame *found);

const char *neph_scattering_name(enum neph_scattering scattering);

#endif
