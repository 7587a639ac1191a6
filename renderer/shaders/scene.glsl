// SPDX-License-Identifier: MIT
//
// Queries on the whole scene: ray hits, visibility, light of lamps, extinction, optical depth, and
// the useful part of a ray. Shared by the ray marcher, the path tracer and the screen passes.
#ifndef NEPH_SCENE_GLSL
#define NEPH_SCENE_GLSL

#include "meshes.glsl"
#include "phase.glsl"
#include "sun_grid.glsl"

// In a scene with grey media all channels take the first one's value, and the compiler removes the
// others.
vec3 grey(vec3 channels)
{
    return COLOURED ? channels : channels.xxx;
}

// --- solids ---------------------------------------------------------------------------------

#ifdef KNOWS_SOLIDS
#include "known_solids.glsl"
#endif

Solid solid_at(uint solid)
{
#ifdef KNOWS_SOLIDS
    if (ARE_KNOWN)
        return known_solid(solid);
#endif
    return solids[solid];
}

// Without the texture of a mesh: where it is black, so is the surface.
vec3 surface_albedo(uint solid)
{
    return is_mesh(solid) ? mesh_instance(hit_instance(solid)).albedo : solid_at(solid).albedo.rgb;
}

struct Surface {
    vec3 normal; // outward, unit; of a mesh, on the side of the hit's ray; for hit_cosine()
    vec3 albedo;
};

Surface surface_at(uint solid, vec3 point_m)
{
    if (is_mesh(solid)) {
        Surface surface = Surface(mesh_normal(solid), surface_albedo(solid));
        if (MESH_SMOOTH || MESH_TEXTURES)
            add_mesh_look(solid, point_m, surface.normal, surface.albedo);
        return surface;
    }
    Solid own = solid_at(solid);
    return Surface(solid_normal(own, point_m), own.albedo.rgb);
}

const uint SOLID_NUMBER = (1u << NEPH_GPU_LISTED_BITS) - 1u; // bits of a number in a list

uint numbered_solid(uint place) { return solid_order[place / 4][place % 4]; }

#ifdef KNOWS_SOLIDS
// scene_hit() for known solids.
Hit known_hit(vec3 origin_m, vec3 direction)
{
    Hit hit = Hit(FAR_M, NO_SOLID);
    [[unroll]] for (uint s = 0; s < KNOWN_SOLIDS; s++) {
        float t0_m, t1_m;
        bool meets = known_interval(s, origin_m, direction, t0_m, t1_m);
        float t_m = t0_m > 0.0 ? t0_m : t1_m;
        bool is_nearer = meets && t_m > 0.0 && t_m < hit.t_m;
        hit.t_m = is_nearer ? t_m : hit.t_m;
        hit.solid = is_nearer ? s : hit.solid;
    }
    return hit;
}
#endif

// The intersection of a solid with t > 0 if it is nearer than `hit`; of two at one distance that of
// the first in the scene.
void keep_nearer(uint s, vec3 origin_m, vec3 direction, inout Hit hit)
{
    float t0_m, t1_m;
    if (!solid_interval(solids[s], origin_m, direction, t0_m, t1_m))
        return;
    float t_m = t0_m > 0.0 ? t0_m : t1_m;
    bool is_first = t_m == hit.t_m && hit.solid != NO_SOLID && s < hit.solid;
    if (t_m > 0.0 && (t_m < hit.t_m || is_first))
        hit = Hit(t_m, s);
}

// Nearest surface with t > 0, except for one solid. From inside a solid this is its far side.
Hit nearest_hit(vec3 origin_m, vec3 direction, uint except)
{
    Hit hit = Hit(FAR_M, NO_SOLID);
    for (uint n = 0; n < make_nonuniform(frame.solid_count);) {
        SolidNode node = solid_nodes[n];
        float t0_m = 0.0, t1_m = FAR_M;
        bool meets = meets_node(node, origin_m, direction, t0_m, t1_m) && t0_m <= hit.t_m;
        n = is_entered(meets) && node.leaf == 0u ? n + 1 : node.next;
        for (uint i = 0; i < (meets ? leaf_count(node) : 0u); i++) {
            uint s = numbered_solid(leaf_first(node) + i);
            if (s != except)
                keep_nearer(s, origin_m, direction, hit);
        }
    }
    if (MESHES)
        keep_nearest_mesh(origin_m, direction, except, hit);
    return hit;
}

Hit scene_hit(vec3 origin_m, vec3 direction)
{
#ifdef KNOWS_SOLIDS
    if (ARE_KNOWN)
        return known_hit(origin_m, direction);
#endif
    return nearest_hit(origin_m, direction, NO_SOLID);
}

// Whether a solid is met between two distances from a point.
bool is_between(uint s, vec3 point_m, vec3 direction, float start_m, float end_m)
{
    float t0_m, t1_m;
    return solid_interval(solids[s], point_m, direction, t0_m, t1_m) && t1_m > start_m &&
           t0_m < end_m;
}

// Whether no solid but `except` is met between two distances from a point. Only of the solids whose
// trees have the nodes from `first` to the one before `behind`; meshes are behind all of them.
bool is_free(vec3 point_m, vec3 direction, float start_m, float end_m, uint except, uint first,
             uint behind)
{
    bool is_hidden = false;
    for (uint n = first; n < behind;) {
        SolidNode node = solid_nodes[n];
        float t0_m = start_m, t1_m = end_m;
        bool meets = !is_hidden && meets_node(node, point_m, direction, t0_m, t1_m);
        n = is_entered(meets) && node.leaf == 0u ? n + 1 : node.next;
        for (uint i = 0; i < (meets ? leaf_count(node) : 0u); i++) {
            uint s = numbered_solid(leaf_first(node) + i);
            if (s != except && is_between(s, point_m, direction, start_m, end_m))
                is_hidden = true;
        }
    }
    return !is_hidden;
}

// Whether no solid of a list is met.
bool is_free_of_listed(uint listed, vec3 point_m, vec3 direction, float start_m, float end_m)
{
    bool is_hidden = false;
    for (uint i = 0u; i < (listed & 3u) && !is_hidden; i++)
        is_hidden = is_between(listed >> (2u + NEPH_GPU_LISTED_BITS * i) & SOLID_NUMBER, point_m,
                               direction, start_m, end_m);
    return !is_hidden;
}

bool is_free(vec3 point_m, vec3 direction, float start_m, float end_m, uint except)
{
    bool is_free = is_free(point_m, direction, start_m, end_m, except, 0u,
                           make_nonuniform(frame.solid_count));
    if (MESHES && is_free)
        is_free = !is_mesh_met(point_m, direction, start_m, end_m, except, NO_SOLID);
    return is_free;
}

// A point at the distance t has a position error of some 1e-7 t. A solid that the sun ray leaves
// within this fraction of t only touches the point and does not shadow it.
const float SHADOW_START = 1e-6;

// With the grid across the sun, rays test only solids that are not in it, such as a ground or what
// moves, and for points between the two limits of their cell the solids that touch it.
bool sees_sun_by_grid(vec3 point_m, float start_m)
{
    uint cell, sun = sun_from_grid(point_m, cell);
    uint apart = make_nonuniform(frame.sun_grid.apart_nodes);
    uint behind = sun == SUN_UNSURE || !MESHES ? NO_SOLID : find_first_at_rest();
    bool is_seen = sun != SUN_HIDDEN;
    if (is_seen)
        is_seen = is_free(point_m, to_sun(), start_m, ENDLESS_M, NO_SOLID, 0u, apart);
    if (is_seen && sun == SUN_UNSURE) {
        uint listed = sun_grid_list(cell);
        is_seen = listed == NEPH_GPU_MANY_LISTED
                      ? is_free(point_m, to_sun(), start_m, ENDLESS_M, NO_SOLID, apart,
                                make_nonuniform(frame.solid_count))
                      : is_free_of_listed(listed, point_m, to_sun(), start_m, ENDLESS_M);
    }
    if (MESHES && is_seen && behind > 0u)
        is_seen = !is_mesh_met(point_m, to_sun(), start_m, ENDLESS_M, NO_SOLID, behind);
    return is_seen;
}

// Whether a point sees the sun. `except` is the solid that the point lies on: solids are convex, so
// where the surface faces the sun its own solid cannot shadow it. Excluding it makes an offset
// unnecessary.
bool sees_sun(vec3 point_m, uint except)
{
    float start_m = SHADOW_START * length(point_m);
#ifdef KNOWS_SOLIDS
    if (ARE_KNOWN)
        return known_sees_point(point_m, to_sun(), start_m, ENDLESS_M, except);
#endif
    if (HAS_SUN_GRID && except == NO_SOLID)
        return sees_sun_by_grid(point_m, start_m);
    return is_free(point_m, to_sun(), start_m, ENDLESS_M, except);
}

// Whether a point of a medium sees the sun; not tested where no solid can shadow a medium.
const bool SHADED = (TRAITS & NEPH_GPU_SHADED) != 0u;

bool medium_sees_sun(vec3 point_m)
{
    return !SHADED || (BRANCHES_ON_FRAME && frame.solids_shade == 0u) ||
           sees_sun(point_m, NO_SOLID);
}

// Whether the segment of a length from a point is free of solids; the point is outside of solids.
bool sees_point(vec3 point_m, vec3 direction, float distance_m, uint except)
{
    float start_m = SHADOW_START * length(point_m);
#ifdef KNOWS_SOLIDS
    if (ARE_KNOWN)
        return known_sees_point(point_m, direction, start_m, distance_m, except);
#endif
    return is_free(point_m, direction, start_m, distance_m, except);
}

// --- lamps ----------------------------------------------------------------------------------

// Irradiance by a lamp on a plane across the light's direction [W/m^2], without attenuation.
// `inverse_square` is 1/d^2 or its mean, `direction` points to the lamp (scenes/lights.h).
vec3 lamp_irradiance(Lamp lamp, vec3 direction, float inverse_square)
{
    float x = clamp((-dot(lamp.axis, direction) - lamp.outer_cosine) /
                        (lamp.inner_cosine - lamp.outer_cosine),
                    0.0, 1.0);
    return lamp.intensity * (x * x * (3.0 - 2.0 * x) * inverse_square);
}

// --- media ----------------------------------------------------------------------------------

// Extinction per channel of the media of some kinds.
vec3 scene_extinction_per_m(uint kinds, vec3 point_m)
{
    vec3 extinction_per_m = vec3(0.0);
    [[unroll]] for (uint m = 0; m < media_count(); m++)
        if (is_among(kinds, m))
            extinction_per_m +=
                medium_color(m) * medium_extinction_per_m(m, point_m);
    return grey(extinction_per_m);
}

// Optical depth per channel of all media that have a closed form.
vec3 scene_optical_depth(vec3 origin_m, vec3 direction, float length_m)
{
    vec3 optical_depth = vec3(0.0);
    [[unroll]] for (uint m = 0; m < media_count(); m++)
        optical_depth += frame.media[m].extinction_color *
                         medium_optical_depth(m, origin_m, direction, length_m);
    return grey(optical_depth);
}

// The part of a ray on which fixed steps are useful: the hull of all media of `kinds`, without the
// ends where no medium has THIN optical depth left, and without the part behind OPAQUE of one fog
// layer.
//
//    camera ---[ fog ......................]--- background
//                   [ cloud ]       OPAQUE of the fog
//              |------------------->|                        result
//
// It makes the march finite in unbounded media. The omitted parts have an optical depth below 1e-7
// per medium or layer, or a transmittance of 1.1e-7 in front of them.
Stretch scene_stretch(uint kinds, vec3 origin_m, vec3 direction, float length_m)
{
    Stretch hull = Stretch(length_m, 0.0);
    float opaque_m = length_m;
    [[unroll]] for (uint m = 0; m < media_count(); m++) {
        Stretch inside = Stretch(0.0, length_m);
        if (is_among(kinds, m) &&
            clip_medium(m, origin_m, direction, inside.t0_m, inside.t1_m))
            medium_include(m, origin_m, direction, inside, hull, opaque_m);
    }
    hull.t1_m = min(hull.t1_m, opaque_m);
    return hull;
}

Stretch scene_stretch(vec3 origin_m, vec3 direction, float length_m)
{
    return scene_stretch(KINDS, origin_m, direction, length_m);
}

#endif
