/* SPDX-License-Identifier: MIT
 *
 * A random scene before it is written as YAML: plain numbers, which the reduction changes one by
 * one. A recipe is a pure function of a seed, an index and an attempt; the loader refuses some
 * recipes (a camera inside a solid), which are drawn again.
 */
#ifndef NEPH_TESTS_RANDOM_SCENES_RECIPE_H
#define NEPH_TESTS_RANDOM_SCENES_RECIPE_H

#include "scenes/scene.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

/* Ways in which a medium is written. Every pair and triple of them is drawn in turn. */
enum recipe_form {
    FORM_HOMOGENEOUS,
    FORM_FOG_OPEN, /* height fog without bounds */
    FORM_FOG_BOXED,
    FORM_FOG_TWO_LAYERS, /* without bounds */
    FORM_GAUSSIAN,
    FORM_GAUSSIAN_BOXED,
    FORM_SHELL,
    FORM_TENT,
    FORM_GRID,
    FORM_GRID_ENDLESS, /* `repeat: [0, 1, 0]` */
    FORM_SHEET,
    FORM_PLUME,
    FORM_HORIZON,
    FORM_COUNT,
};

enum {
    RECIPE_MEDIA_MAX = 3,
    RECIPE_LIGHTS_MAX = 3,
    RECIPE_SOLIDS_MAX = 4,
    RECIPE_MESHES_MAX = 3,
    RECIPE_CORNERS_MAX = 9,
    RECIPE_VALUES_MAX = 64,
    RECIPE_WIDTH_PX = 6,
    RECIPE_HEIGHT_PX = 4,
};

struct recipe_medium {
    enum recipe_form form;
    double extinction_per_m; /* of a sheet: its optical depth */
    struct neph_rgb color, albedo, emission_w_per_m2_sr;
    struct neph_phase phase;
    bool is_bounded;
    struct neph_bounds bounds;
    int layer_count;
    struct neph_fog_layer layers[NEPH_FOG_LAYERS_MAX];
    struct neph_vec3 center_m; /* Gaussian, sheet; plume: its foot; shell and tent: of the planet */
    struct neph_vec3 axis;     /* of a plume */
    double width_m;            /* Gaussian, plume; side of a sheet */
    double scale_m;            /* scale height; half width of a tent; thickness of a sheet */
    double radius_m, altitude_m;
    int nodes[3], repeat[3]; /* of a grid */
    struct neph_vec3 origin_m, spacing_m;
    double values[RECIPE_VALUES_MAX];
    int seed;                /* of sheets and Horizon clouds */
    bool is_streaked;        /* a sheet */
    int voxels;              /* nodes of the grid that replaces the medium; 0: none */
    struct neph_vec3 wind_m; /* displacement of a Horizon pattern */
};

struct recipe_light {
    struct neph_vec3 position_m, axis;
    struct neph_rgb intensity_w_per_sr;
    bool is_spot;
    double inner_deg, outer_deg;
};

enum recipe_solid_kind { RECIPE_BOX, RECIPE_SPHERE, RECIPE_FENCE };

struct recipe_solid {
    enum recipe_solid_kind kind;
    struct neph_bounds box; /* of a fence: its origin in min_m */
    struct neph_vec3 center_m;
    double radius_m;
    struct neph_rgb albedo;
    bool moves;
    struct neph_vec3 move_m; /* at frame RECIPE_KEY_FRAME */
    double turn_deg;         /* likewise */
    char axis;
    int bars; /* of a fence, of size pitch_m / 2 */
    double pitch_m, height_m;
};

/* Meshes, each a file of its own beside the scene's. */
enum recipe_mesh_kind {
    RECIPE_TETRAHEDRON,
    RECIPE_BLOCK,   /* a box */
    RECIPE_SURFACE, /* open: 2 x 2 bent squares */
    RECIPE_MESH_KINDS,
};

struct recipe_mesh {
    enum recipe_mesh_kind kind;
    struct neph_vec3 corners[RECIPE_CORNERS_MAX]; /* in units of scale_m */
    struct neph_vec3 position_m;
    double scale_m, turn_deg;
    struct neph_rgb albedo;
};

enum { RECIPE_KEY_FRAME = 20 };

struct recipe {
    uint64_t seed;
    int index;
    double scale_m; /* of everything near the camera */
    struct neph_vec3 eye_m, look_at_m, up;
    double vertical_fov_deg, orthographic_height_m; /* one of the two is 0 */
    int frame;                                      /* the rendered frame */
    bool has_sun, has_wind, is_wind_keyed;
    struct neph_vec3 sun_direction;
    struct neph_rgb sun_w_per_m2, background_w_per_m2_sr;
    struct neph_vec3 wind_m_per_s; /* at frame 0; keyed: twice this at RECIPE_KEY_FRAME */
    bool environment_light, has_near_light;
    enum neph_scattering scattering;
    int medium_count, light_count, solid_count, mesh_count;
    struct recipe_medium media[RECIPE_MEDIA_MAX];
    struct recipe_light lights[RECIPE_LIGHTS_MAX];
    struct recipe_solid solids[RECIPE_SOLIDS_MAX];
    struct recipe_mesh meshes[RECIPE_MESHES_MAX];
};

/* Draws a recipe. The indices 0 .. RECIPE_PERIOD - 1, and any range of this length, contain every
 * single form, every pair of different and of equal forms and every triple of different forms once.
 */
struct recipe recipe_draw(uint64_t seed, int index, int attempt);
int recipe_period(void);
const char *recipe_form_name(enum recipe_form form);

/* The camera of frame 0, as in the loaded scene. */
struct neph_camera recipe_camera(const struct recipe *recipe);

/* The same scene at its frame without wind: media are at their displaced positions, by a sum that
 * shares no code with scenes/motion.c. */
struct recipe recipe_without_wind(const struct recipe *recipe);

/* Writes the scene as YAML. `note` becomes comment lines at the top; each line of it must begin
 * with "# ". It names the files NAME_0.obj, NAME_1.obj, ... of its meshes. */
void recipe_write(const struct recipe *recipe, const char *name, const char *note, FILE *file);

/* Writes a mesh as Wavefront OBJ, with `prefix` in front of each line. */
void recipe_write_mesh(const struct recipe_mesh *mesh, const char *prefix, FILE *file);

/* Applies one simplification to a recipe; false if change number `change` does not apply. Changes
 * end at recipe_change_count(). */
bool recipe_simplify(struct recipe *recipe, int change);
int recipe_change_count(void);

#endif
