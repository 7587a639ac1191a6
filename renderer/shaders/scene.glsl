// SPDX-License-Identifier: MIT
//
// The questions that a renderer asks of the whole scene.
#ifndef NEPH_SCENE_GLSL
#define NEPH_SCENE_GLSL

#include "media.glsl"
#include "phase.glsl"

// What is the same in all channels of a scene without colour is computed once: the compiler drops
// what nobody reads.
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

struct Hit {
    float t_m;  // FAR_M when nothing is hit
    uint solid; // NO_SOLID when nothing is hit
};

// Where the solids of a block end that a ray has to ask within [t0, t1]: where they begin if it
// passes the block by.
uint block_end(uint block, vec3 origin_m, vec3 direction, float t0_m, float t1_m)
{
    uint first = block * BLOCK_SOLIDS;
    bool meets = clip_box(blocks[block].low_m, blocks[block].high_m, origin_m, direction, t0_m,
                          t1_m);
    return meets ? min(first + BLOCK_SOLIDS, frame.solid_count) : first;
}

uint block_count() { return (own(frame.solid_count) + BLOCK_SOLIDS - 1) / BLOCK_SOLIDS; }

#ifdef KNOWS_SOLIDS
// As scene_hit().
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

// Nearest surface with t > 0; from inside a solid that is its far side.
Hit scene_hit(vec3 origin_m, vec3 direction)
{
#ifdef KNOWS_SOLIDS
    if (ARE_KNOWN)
        return known_hit(origin_m, direction);
#endif
    Hit hit = Hit(FAR_M, NO_SOLID);
    for (uint block = 0; block < block_count(); block++) {
        uint end = block_end(block, origin_m, direction, 0.0, hit.t_m);
        for (uint s = block * BLOCK_SOLIDS; s < end; s++) {
            float t0_m, t1_m;
            if (!solid_interval(solids[s], origin_m, direction, t0_m, t1_m))
                continue;
            float t_m = t0_m > 0.0 ? t0_m : t1_m;
            if (t_m > 0.0 && t_m < hit.t_m)
                hit = Hit(t_m, s);
        }
    }
    return hit;
}

// A point found at a distance t is off by some 1e-7 t: a solid that a sun ray leaves within this
// fraction of t only touches the point and does not hide the sun.
const float SHADOW_START = 1e-6;

// `except`: the solid that the point lies on. It is convex, so where its surface faces the sun it
// cannot hide it; leaving it out spares us the choice of an offset.
bool sees_sun(vec3 point_m, uint except)
{
    float start_m = SHADOW_START * length(point_m);
#ifdef KNOWS_SOLIDS
    if (ARE_KNOWN)
        return known_let_pass(point_m, to_sun(), start_m, ENDLESS_M, except);
#endif
    for (uint block = 0; block < block_count(); block++) {
        uint end = block_end(block, point_m, to_sun(), start_m, FAR_M);
        for (uint s = block * BLOCK_SOLIDS; s < end; s++) {
            float t0_m, t1_m;
            if (s != except && solid_interval(solids[s], point_m, to_sun(), t0_m, t1_m) &&
                t1_m > start_m)
                return false;
        }
    }
    return true;
}

// Whether a point of a medium does, which is not computed where no solid is in the way of any
// medium.
const bool SHADED = (TRAITS & NEPH_GPU_SHADED) != 0u;

bool medium_sees_sun(vec3 point_m)
{
    return !SHADED || (BRANCHES_ON_FRAME && frame.solids_shade == 0u) ||
           sees_sun(point_m, NO_SOLID);
}

// Whether a point that is in no solid sees as far.
bool sees_point(vec3 point_m, vec3 direction, float distance_m, uint except)
{
    float start_m = SHADOW_START * length(point_m);
#ifdef KNOWS_SOLIDS
    if (ARE_KNOWN)
        return known_let_pass(point_m, direction, start_m, distance_m, except);
#endif
    for (uint block = 0; block < block_count(); block++) {
        uint end = block_end(block, point_m, direction, start_m, distance_m);
        for (uint s = block * BLOCK_SOLIDS; s < end; s++) {
            float t0_m, t1_m;
            if (s != except && solid_interval(solids[s], point_m, direction, t0_m, t1_m) &&
                t1_m > start_m && t0_m < distance_m)
                return false;
        }
    }
    return true;
}

// --- lamps ----------------------------------------------------------------------------------

// Irradiance across the way from a point at a distance whose inverse square is given [W/m^2], if
// nothing is in between; `direction` is from the point to the lamp (scenes/lights.h).
vec3 lamp_irradiance(Lamp lamp, vec3 direction, float inverse_square)
{
    float x = clamp((-dot(lamp.axis, direction) - lamp.outer_cosine) /
                        (lamp.inner_cosine - lamp.outer_cosine),
                    0.0, 1.0);
    return lamp.intensity * (x * x * (3.0 - 2.0 * x) * inverse_square);
}

// --- media ----------------------------------------------------------------------------------

// Extinction of the media whose kind is among `kinds`, per channel.
vec3 scene_extinction_per_m(uint kinds, vec3 point_m)
{
    vec3 extinction_per_m = vec3(0.0);
    [[unroll]] for (uint m = 0; m < media_count(); m++)
        if (is_among(kinds, m))
            extinction_per_m +=
                medium_color(m) * medium_extinction_per_m(m, point_m);
    return grey(extinction_per_m);
}

// Optical depth of everything that has a closed form, per channel.
vec3 scene_optical_depth(vec3 origin_m, vec3 direction, float length_m)
{
    vec3 optical_depth = vec3(0.0);
    [[unroll]] for (uint m = 0; m < media_count(); m++)
        optical_depth += frame.media[m].extinction_color *
                         medium_optical_depth(m, origin_m, direction, length_m);
    return grey(optical_depth);
}

// The stretch of a ray on which fixed steps are well spent: the hull of all media, without the
// ends where no medium has THIN optical depth left and without what lies behind OPAQUE of one fog
// layer. For unbounded media this is what makes the march finite. What it leaves out changes the
// optical depth by less than 1e-7 per medium or layer, or lies where 1.1e-7 of the light comes
// through. `kinds` says which media count, as KINDS does.
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
