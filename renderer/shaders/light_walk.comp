#version 450
// SPDX-License-Identifier: MIT
//
// The paths of traced light (traced_light.glsl): one thread, one path of a texel. A dispatch takes
// it some turns further, and another one where that left it: a turn is the way to the next face of
// a majorant cell, or to a tentative collision before it (Woodcock 1965). Free paths have no
// memory, so one may be drawn anew wherever a dispatch ends.
//
// The sunlight of the first collision is left out: single scattering is the march's. What arrives
// of sunlight at the others is found as the march finds it.
//
// Paths through the thick are under way for many pictures, and the first ones have none that began
// long ago. With LOOKS_AHEAD a path counts at once what it may yet bring home, by an estimate, and
// in the next round takes that back: over its life it has counted what it found. So the estimate
// has no part in the mean of pictures at rest, whatever it is worth, and in those after a cut it
// stands for the orders that nothing had time to find. (A potential that shapes rewards: A. Y. Ng,
// D. Harada, S. Russell, ICML 1999.) It is the radiance of diffused light that comes to the path.
// With ENDS_AHEAD the path ends there: its estimate stays, with its bias, and the noise and the lag
// of what it would have found do not come.
//
// With SIMILAR above 0 a path goes on from its second event in media of a smaller mean cosine g',
// and a part 1 - (1 - g) / (1 - g') of what is scattered counts as going on as it came: as much
// light turns round (the similarity relation of order one), with fewer collisions, whose phase
// functions are less of a peak. What order one is not is the bias that docs/light.md measures.
#extension GL_GOOGLE_include_directive : require

#include "march_light.glsl"

#include "sampling.glsl"
#include "traced_light.glsl"

layout(local_size_x = 64) in;

layout(constant_id = 6) const bool LOOKS_AHEAD = false;
layout(constant_id = 8) const bool ENDS_AHEAD = false;
layout(constant_id = 7) const float SIMILAR = 0.0; // 1: the similar medium of delta-Eddington

layout(push_constant) uniform LightRun {
    vec3 shift_m; // how far what stood still has gone past the camera since the round before
    uint seed;
    uint round; // ever
    uint paths; // of a texel
    uint turns; // of a thread, at most
    uint events; // of it, at most
    uint count; // of all paths
    uint is_fresh; // 1: no path is under way
    uint has_environment; // 1: the background lights media
} run;

// Where a path is between two dispatches.
struct LightPath {
    vec3 origin_m;
    uint events; // scatterings and reflections so far
    vec3 direction;
    uint solid; // that `origin_m` lies on, or NO_SOLID
    vec3 throughput;
    uint is_alive;
    vec3 ahead; // what it has counted and not found yet [W m^-2 sr^-1]
    float padding;
};

layout(std430, binding = 5) buffer Paths {
    LightPath paths[];
};

layout(std430, binding = 6) writeonly buffer Found {
    LightTexel found[]; // by each path, in this round
};

layout(std430, binding = 8) readonly buffer Diffused {
    vec4 higher_orders[];
};

#include "diffused_field.glsl"

// A path goes on by chance alone below this (Russian roulette).
const float ROULETTE = 0.1;

// Rays that miss all media are cheap, but texels of nothing but sky need not have many.
const uint MISSES_MAX = 4;

// How far beyond a cell's face the next turn begins, in cells: a place is known to less.
const float HAIR = 1e-3;

LightPath path;
LightTexel sums = LightTexel(vec3(0.0), 0.0, 0.0, float[3](0.0, 0.0, 0.0));
Hit solid_ahead; // on the way of the path
float fog_m;     // to the fog's next collision on it
uint fog_medium;
uint misses = 0, events = 0, drawn = 0, thread;

vec4 draw()
{
    uvec4 bits = pcg4d(uvec4(thread, run.round, run.seed, drawn++));
    return vec4(uniform_from(bits.xyz), uniform_from(bits.www).x);
}

uvec2 draw_bits() { return pcg4d(uvec4(thread, run.round, ~run.seed, drawn++)).xy; }

// --- similar media ------------------------------------------------------------------------------

// Events of a path after which media are similar ones.
const uint SIMILAR_AFTER = 2;

// Grey ones alone: a part that goes on as it came would be another for each channel.
bool is_similar(uint m, uint events)
{
    vec3 albedo = frame.media[m].albedo;
    return SIMILAR > 0.0 && events >= SIMILAR_AFTER && albedo.r == albedo.g &&
           albedo.g == albedo.b && mean_cosine_of(m) > 0.0;
}

float similar_cosine_of(uint m)
{
    return mix(frame.media[m].g, smooth_g_of(m), SIMILAR);
}

// The part of scattering that is left.
float turning_of(uint m) { return (1.0 - frame.media[m].g) / (1.0 - similar_cosine_of(m)); }

// Optical depths after so many events, by those of the medium.
float thinness(uint m, uint events)
{
    return is_similar(m, events) ? 1.0 - frame.media[m].albedo.r * (1.0 - turning_of(m)) : 1.0;
}

float extinction_color_of(uint m)
{
    return frame.media[m].extinction_color.x * thinness(m, path.events);
}

// --- segments -----------------------------------------------------------------------------------

Hit hit_but(uint except)
{
    Hit hit = Hit(FAR_M, NO_SOLID);
    for (uint s = 0; s < own(frame.solid_count); s++) {
        float t0_m, t1_m;
        if (s == except || !solid_interval(solids[s], path.origin_m, path.direction, t0_m, t1_m))
            continue;
        float t_m = t0_m > 0.0 ? t0_m : t1_m;
        if (t_m > 0.0 && t_m < hit.t_m)
            hit = Hit(t_m, s);
    }
    return hit;
}

void look_for_fog(uint m)
{
    float t0_m = 0.0, t1_m = solid_ahead.t_m;
    if (!clip_medium(m, path.origin_m, path.direction, t0_m, t1_m))
        return;
    for (uint l = 0; l < layer_count_of(m); l++) {
        float depth = -log(draw().x) / max(extinction_color_of(m), 1e-20);
        float t_m = fog_layer_free_path_m(frame.media[m].layers[l], path.origin_m, path.direction,
                                          t0_m, depth);
        if (t_m < min(t1_m, fog_m)) {
            fog_m = t_m;
            fog_medium = m;
        }
    }
}

// What a path would meet if there were no shapes.
void look_ahead()
{
    solid_ahead = hit_but(path.solid);
    fog_m = FAR_M;
    fog_medium = MEDIA_MAX;
    if (HAS_FOG)
        for (uint m = 0; m < media_count(); m++)
            if (is_fog(m))
                look_for_fog(m);
}

void start()
{
    uint texel = thread / run.paths, texel_px = frame.light_texel_px;
    uvec2 size_px = uvec2(frame.width_px, frame.height_px);
    uint wide = light_size(size_px, texel_px).x;
    uvec2 low_px = texel_px * uvec2(texel % wide, texel / wide);
    vec2 high_px = vec2(min(low_px + texel_px, size_px)); // the last may not be whole
    ViewRay ray = camera_ray_at(frame_camera(), mix(vec2(low_px), high_px, draw().xy));
    path = LightPath(ray.origin_m, 0u, ray.direction, NO_SOLID, vec3(1.0), 1u, vec3(0.0), 0.0);
    look_ahead();
}

void end()
{
    if (path.events == 0u)
        misses++;
    path.is_alive = 0u;
}

// --- events -------------------------------------------------------------------------------------

// Sunlight and the way on at the path's origin: in a medium, or on a solid where `m` is MEDIA_MAX.
void happen(uint m, uint solid)
{
    vec4 u = draw();
    float per_sr, sun_thinness = 1.0;
    vec3 next;
    events++;
    if (m == MEDIA_MAX) {
        vec3 normal = solid_normal(solids[solid], path.origin_m);
        path.throughput *= solids[solid].albedo.rgb;
        per_sr = max(0.0, dot(normal, to_sun())) / PI;
        next = sample_cosine(normal, u.xy);
    } else {
        uint kind = own(frame.media[m].phase_kind);
        float g = frame.media[m].g;
        path.throughput *= frame.media[m].albedo;
        if (is_similar(m, path.events)) {
            g = similar_cosine_of(m);
            path.throughput *= turning_of(m) / thinness(m, path.events);
        }
        per_sr = phase_per_sr(kind, g, path.direction, to_sun());
        next = sample_phase(kind, g, path.direction, u.xy);
        sun_thinness = thinness(m, path.events + 1u); // sunlight comes the way the path goes on
    }
    path.solid = solid;
    if (path.events > 0u && per_sr > 0.0 && own(frame.scatters) != 0u &&
        sees_sun(path.origin_m, solid))
        sums.light += path.throughput * per_sr * sun_at(path.origin_m) *
                      fraction_through(sun_thinness * sample_sun_depth(path.origin_m));
    path.events++;
    path.direction = next;
    float most = max(path.throughput.r, max(path.throughput.g, path.throughput.b));
    float survival = min(1.0, most / ROULETTE);
    if (u.z >= survival) {
        end();
        return;
    }
    path.throughput /= survival;
    look_ahead();
}

void collide(uint m)
{
    if (path.events == 0u) {
        sums.collisions += 1.0;
        sums.distance_m += dot(path.origin_m, path.direction);
    }
    happen(m, NO_SOLID);
}

// What the air on the way out of the media, into space or to the ground (solid 0), adds and takes,
// as it is from the middle of all media.
void meet_air()
{
    SkyLight light = sky_look_up(eye.places[1], sky_ray_along(eye.places[1], path.direction));
    sums.light += path.throughput * frame.sun_irradiance * light.volume;
    path.throughput *= light.transmittance;
}

// The end of a segment on which no shape was in the way.
void arrive()
{
    if (fog_m <= solid_ahead.t_m && fog_medium != MEDIA_MAX) {
        collide(fog_medium);
        return;
    }
    if (solid_ahead.solid == NO_SOLID && path.events > 0u && run.has_environment != 0u)
        sums.light += path.throughput * frame.background;
    bool is_out = solid_ahead.solid == NO_SOLID || solid_ahead.solid == 0u;
    if (SKY_LIGHTS && path.events > 0u && is_out)
        meet_air();
    if (solid_ahead.solid == NO_SOLID || path.events == 0u ||
        solids[solid_ahead.solid].albedo.rgb == vec3(0.0))
        end();
    else
        happen(MEDIA_MAX, solid_ahead.solid);
}

// --- turns --------------------------------------------------------------------------------------

// What is known of the next stretch: no extinction of the shapes passes the majorant on it.
struct Stride {
    float length_m, majorant_per_m;
};

void stride_in(uint m, inout Stride stride)
{
    vec3 low_m = frame.media[m].low_m, high_m = frame.media[m].high_m;
    float t0_m = 0.0, t1_m = FAR_M;
    if (!clip_box(low_m, high_m, path.origin_m, path.direction, t0_m, t1_m))
        return;
    uvec3 size = frame.media[m].majorant_size;
    vec3 cells_per_m = vec3(size) / (high_m - low_m);
    vec3 slope = path.direction * cells_per_m;
    float hair_m = HAIR / max(abs(slope.x), max(abs(slope.y), abs(slope.z)));
    if (t0_m > 0.0) {
        stride.length_m = min(stride.length_m, t0_m + hair_m);
        return;
    }
    vec3 place = (path.origin_m - low_m) * cells_per_m;
    vec3 cell = clamp(floor(place), vec3(0.0), vec3(size) - 1.0);
    vec3 ahead = cell + vec3(greaterThan(slope, vec3(0.0))) - place;
    bvec3 parallel = lessThan(abs(slope), vec3(PARALLEL));
    vec3 faces_m = mix(ahead / mix(slope, vec3(1.0), parallel), vec3(FAR_M), parallel);
    float face_m = max(0.0, min(faces_m.x, min(faces_m.y, faces_m.z)));
    uvec3 at = uvec3(cell);
    stride.length_m = min(stride.length_m, face_m + hair_m);
    stride.majorant_per_m +=
        extinction_color_of(m) *
        majorants[frame.media[m].majorant_first + at.x + size.x * (at.y + size.y * at.z)];
}

Stride next_stride(float end_m)
{
    Stride stride = Stride(end_m, 0.0);
    [[unroll]] for (uint m = 0; m < media_count(); m++)
        if (!is_fog(m))
            stride_in(m, stride);
    return stride;
}

// A tentative collision in a shape: a real one with the probability extinction / majorant.
void tentative(float majorant_per_m, float u)
{
    float left_per_m = u * majorant_per_m;
    uint by = MEDIA_MAX;
    [[unroll]] for (uint m = 0; m < media_count(); m++) {
        if (by != MEDIA_MAX || is_fog(m) || !medium_contains(m, path.origin_m))
            continue;
        left_per_m -= extinction_color_of(m) * frame.media[m].extinction_per_m *
                      shape_random_density(kind_of(m), frame.media[m].shape, path.origin_m,
                                           draw_bits());
        if (left_per_m < 0.0)
            by = m;
    }
    if (by != MEDIA_MAX)
        collide(by);
}

void advance(float way_m)
{
    path.origin_m += way_m * path.direction;
    solid_ahead.t_m -= way_m;
    fog_m -= way_m;
    path.solid = NO_SOLID;
}

void turn()
{
    float end_m = min(solid_ahead.t_m, fog_m);
    Stride stride = next_stride(end_m);
    if (stride.majorant_per_m > 0.0) {
        vec4 u = draw();
        float free_m = -log(u.x) / stride.majorant_per_m;
        if (free_m < stride.length_m) {
            advance(free_m);
            tentative(stride.majorant_per_m, u.y);
            return;
        }
    }
    if (stride.length_m < end_m) {
        advance(stride.length_m);
        return;
    }
    bool is_open = end_m >= 0.5 * FAR_M; // nothing more is met
    if (!is_open)
        path.origin_m += end_m * path.direction;
    arrive();
}

// --- what lies ahead ----------------------------------------------------------------------------

bool is_in_lattice(vec3 point_m)
{
    vec3 place = (point_m - frame.light_lattice.origin_m) * frame.light_lattice.per_m;
    vec3 size = vec3(frame.light_lattice.size);
    bvec3 is_within = equal(clamp(place, vec3(0.0), size), place);
    bvec3 is_endless = lessThanEqual(size, vec3(1.0));
    return all(bvec3(uvec3(is_within) | uvec3(is_endless)));
}

// A path that has had no collision has counted none, and owes no light. Of the sky it will find as
// much as in a white medium.
vec3 light_ahead()
{
    vec3 to_path = vec3(0.0);
    if (path.is_alive == 0u || path.events == 0u)
        return to_path;
    if (is_in_lattice(path.origin_m)) {
        vec4 field = diffused_field(path.origin_m);
        float per_sr = max(field.w - 3.0 * dot(field.xyz, path.direction), 0.0) / (4.0 * PI);
        to_path = per_sr * sun_at(path.origin_m);
    }
    if (run.has_environment != 0u)
        to_path += frame.background;
    return path.throughput * to_path;
}

void main()
{
    thread = gl_GlobalInvocationID.x;
    if (thread >= run.count)
        return;
    path.is_alive = 0u;
    path.ahead = vec3(0.0);
    if (run.is_fresh == 0u)
        path = paths[thread];
    vec3 counted = path.ahead;
    if (path.is_alive != 0u) {
        path.origin_m += run.shift_m;
        look_ahead();
    }
    for (uint i = 0; i < run.turns && events < run.events && misses < MISSES_MAX; i++) {
        if (path.is_alive == 0u)
            start();
        else
            turn();
    }
    if (LOOKS_AHEAD) {
        path.ahead = light_ahead();
        sums.light += path.ahead - counted;
        if (ENDS_AHEAD && path.events > 0u) {
            path.is_alive = 0u;
            path.ahead = vec3(0.0);
        }
    }
    paths[thread] = path;
    found[thread] = sums;
}
