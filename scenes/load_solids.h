/* SPDX-License-Identifier: MIT
 *
 * An entry of `solids` while it is read. Private to scenes/.
 */
#ifndef NEPH_SCENES_LOAD_SOLIDS_H
#define NEPH_SCENES_LOAD_SOLIDS_H

#include "scenes/load.h"

#include <stddef.h>

struct neph_instance {
    struct neph_vec3 position_m;
    double turn_deg, scale;
};

/* Instances at random places. */
struct neph_scatter {
    int count, seed; /* count 0: none */
    double x_m[2], z_m[2], scale[2];
    int x_count, z_count, scale_count; /* 0 or 2 */
    double height_m;
    bool on_ground; /* instead of the height */
};

/* The keys of a mesh or a height field that are not those of its solids. */
struct neph_written_mesh {
    bool is_height_field;
    const char *file, *object, *channel;
    int up;             /* 0 y, 1 z */
    int shading, alpha; /* 0 flat, 1 smooth; enum neph_alpha */
    const char *albedo_texture;
    int memory_limit_mib;
    double turn_deg;
    int instance_count; /* 0: one, at the entry's place */
    struct neph_instance *instances;
    struct neph_scatter scatter;
};

enum { NEPH_RAILS_MAX = 16 };

struct neph_fence {
    struct neph_vec3 origin_m;
    int bars;
    double pitch_m, bar_width_m, bar_depth_m, height_m;
    int rows;
    double row_spacing_m;
    int rail_count;
    double rail_heights_m[NEPH_RAILS_MAX], rail_width_m, rail_depth_m;
    struct neph_rgb albedo;
};

/* One entry; either a solid, a fence, or the solids of a mesh. */
struct neph_written_solid {
    struct neph_solid solid;
    struct neph_fence fence; /* 0 bars: no fence */
    struct neph_written_mesh mesh;
    struct neph_mover mover; /* without keys: static */
};

#define NEPH_SOLID_AT(member) offsetof(struct neph_written_solid, solid.member)

#define NEPH_ALBEDO_NOTE "an albedo above 1 would create energy"

#define NEPH_SURFACE_FIELDS                                                                        \
    {"albedo", NEPH_THREE, NEPH_SOLID_AT(albedo), "", 0, 1, .note = NEPH_ALBEDO_NOTE},             \
        {"metalness",                                                                              \
         NEPH_NUMBER,                                                                              \
         NEPH_SOLID_AT(surface.metalness),                                                         \
         "",                                                                                       \
         0,                                                                                        \
         1,                                                                                        \
         .note = "part of the reflection that is a metal of that colour; the other part is "       \
                 "Lambertian",                                                                     \
         .standard = "0",                                                                          \
         .hashing = NEPH_HASHED_IF_SET},                                                           \
    {                                                                                              \
        "roughness", NEPH_NUMBER, NEPH_SOLID_AT(surface.roughness), "", 0, 1,                      \
            .note = "of the metal, the root of GGX's alpha; 0 is a mirror, else at least 0.02",    \
            .standard = "0", .hashing = NEPH_HASHED_WITH_LAST                                      \
    }

#define NEPH_MOTION_FIELD                                                                          \
    {                                                                                              \
        "motion", NEPH_RECORD, offsetof(struct neph_written_solid, mover),                         \
            .record = &neph_motion_record, .standard = "", .hashing = NEPH_HASHED_AS_MADE          \
    }

/* Into the `mover` of an entry, and into an entry. */
extern const struct neph_record neph_motion_record, neph_mesh_record, neph_height_field_record;

/* Checks the surface of an entry, after its keys were read. */
enum neph_status neph_check_surface(const struct neph_reader *reader, const yaml_node_t *node,
                                    const struct neph_surface *surface);

/* The number of solids of an entry with a mesh. */
int neph_count_instances(const struct neph_written_mesh *mesh);

/* Reads the mesh of entry `index` and makes its solids, behind the `count` solids of the entries
 * before. The scene owns the mesh, also on errors. */
enum neph_status neph_make_mesh_solids(struct neph_reader *reader,
                                       struct neph_written_scene *written, int index, int count);

/* Rows of a solid of kind MESH, for its hash. */
extern const struct neph_field neph_mesh_fields[];

#endif
