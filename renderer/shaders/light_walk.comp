#version 450
// SPDX-License-Identifier: MIT
//
// Traces the paths of traced light (traced_light.glsl). One thread is one path of a texel.
//
// A path takes many dispatches, each of at most run.turns turns. A turn is a segment of delta
// tracking (E. R. Woodcock et al., 1965): it ends at the next face of a majorant cell, at a
// tentative collision before that, at a fog collision, or at a solid. Free paths are memoryless, so
// a new one may be drawn wherever a dispatch ends.
//
// Single scattering is left to the ray marcher: sunlight of the first collision is not counted. At
// all further collisions the sunlight is computed as the ray marcher does.
//
// LOOKS_AHEAD. Long paths in thick media take many frames, and after a cut no long path has
// finished yet. With this option a path counts at once an estimate of its future light, and
// subtracts it in the next round:
//
//   counted in round n  =  found in n  +  estimate after n  -  estimate after n - 1
//
// The sum over a finished path telescopes to the light that it has found. So the estimate does not
// bias the mean of a static sequence, and after a cut it stands for the orders that could not be
// found yet. (Potential-based shaping: A. Y. Ng, D. Harada, S. Russell, ICML 1999.) The estimate is
// the radiance of diffused light that arrives at the path. ENDS_AHEAD ends the path there: the
// estimate stays, with its bias, in exchange for less noise and less lag.
//
// SIMILAR > 0. From its second event on a path is in media with a smaller mean cosine g', and the
// fraction 1 - (1 - g) / (1 - g') of the scattered light counts as unscattered: first-order
// similarity. Transport is the same to first order in the angle, with fewer collisions and less
// peaked phase functions. docs/light.md measures the bias of the higher orders.
#extension GL_GOOGLE_include_directive : require

#define DRAWS_COVERAGE
#define WALKS_ALONE // scene.glsl
#include "march_light.glsl"

#include "sampling.glsl"
#include "traced_light.glsl"

layout(local_size_x = 64) in;

layout(constant_id = 6) const bool LOOKS_AHEAD = false;
layout(constant_id = 8) const bool ENDS_AHEAD = false;
// Interpolates g': 0 is g, 1 is delta-Eddington's g / (1 + g).
layout(constant_id = 7) const float SIMILAR = 0.0;

layout(push_constant) uniform LightRun {
    vec3 shift_m; // motion of static things relative to the camera since the round before
    uint seed;
    uint round; // number of the round, since the start
    uint paths; // paths per texel
    uint turns; // turns per thread and dispatch, at most
    uint events; // events per thread and dispatch, at most
    uint count; // number of all paths
    uint is_fresh; // 1: there are no unfinished paths
    uint has_environment; // 1: the background illuminates media
} run;

// State of a path between two dispatches.
struct LightPath {
    vec3 origin_m;
    uint events; // scatterings and reflections so far
    vec3 direction;
    uint solid; // solid that `origin_m` lies on, or NO_SOLID
    vec3 throughput;
    uint is_alive;
    vec3 ahead; // estimate that is counted and not yet found [W m^-2 sr^-1]
    float padding;
};

layout(std430, binding = 5) buffer Paths {
    LightPath paths[];
};

layout(std430, binding = 6) writeonly buffer Found {
    LightTexel found[]; // per path, in this round
};

layout(std430, binding = 8) readonly buffer Diffused {
    vec4 higher_orders[];
};

#include "diffused_field.glsl"

// Throughput below which Russian roulette decides whether a path goes on.
const float ROULETTE = 0.1;

// Camera rays without a collision that a thread traces per dispatch, at most: they are cheap, but
// texels of pure sky do not need many.
const uint MISSES_MAX = 4;

// Distance beyond a cell's face at which the next turn starts, in cells. It exceeds the rounding
// error of a position.
const float HAIR = 1e-3;

LightPath path;
LightTexel sums = LightTexel(vec3(0.0), 0.0, 0.0, float[3](0.0, 0.0, 0.0));
Hit solid_ahead; // next solid along the path
float fog_m;     // distance to the next fog collision
uint fog_medium;
uint misses = 0, events = 0, drawn = 0, thread;

vec4 draw()
{
    uvec4 bits = pcg4d(uvec4(thread, run.round, run.seed, drawn++));
    return vec4(uniform_from(bits.xyz), uniform_from(bits.www).x);
}

uvec2 draw_bits() { return pcg4d(uvec4(thread, run.round, ~run.seed, drawn++)).xy; }

// --- similar media ------------------------------------------------------------------------------

// Events of a path after which it is in similar media.
const uint SIMILAR_AFTER = 2;

// Grey media only: otherwise the fraction that goes straight on would depend on the channel.
bool is_similar(uint m, uint events)
{
    vec3 albedo = frame.media[m].albedo;
    return SIMILAR > 0.0 && events >= SIMILAR_AFTER && albedo.r == albedo.g &&
           albedo.g == albedo.b && medium_mean_cosine(m) > 0.0;
}

float path_similar_cosine(uint m)
{
    return mix(medium_mean_cosine(m), similar_mean_cosine(m), SIMILAR);
}

// The fraction of scattering that remains in the similar medium: (1 - g) / (1 - g').
float turning_fraction(uint m)
{
    return (1.0 - medium_mean_cosine(m)) / (1.0 - path_similar_cosine(m));
}

// Optical depth of the similar medium over the original one, after a number of events.
float thinness(uint m, uint events)
{
    return is_similar(m, events) ? 1.0 - frame.media[m].albedo.r * (1.0 - turning_fraction(m))
                                 : 1.0;
}

float path_extinction_color(uint m)
{
    return frame.media[m].extinction_color.x * thinness(m, path.events);
}

// --- segments -----------------------------------------------------------------------------------

// Draws a free path in a fog's layers and keeps the nearest collision.
void find_fog_collision(uint m)
{
    float t0_m = 0.0, t1_m = solid_ahead.t_m;
    if (!clip_medium(m, path.origin_m, path.direction, t0_m, t1_m))
        return;
    for (uint l = 0; l < fog_layer_count(m); l++) {
        float depth = -log(draw().x) / max(path_extinction_color(m), 1e-20);
        float t_m = fog_layer_free_path_m(frame.media[m].layers[l], path.origin_m, path.direction,
                                          t0_m, depth);
        if (t_m < min(t1_m, fog_m)) {
            fog_m = t_m;
            fog_medium = m;
        }
    }
}

// Next solid and next fog collision along the path; shapes are left to turn().
void find_next_events()
{
    if (MESH_COVERAGE)
        set_coverage(draw_bits(), 0u);
    solid_ahead = nearest_hit(path.origin_m, path.direction, path.solid);
    fog_m = FAR_M;
    fog_medium = MEDIA_MAX;
    if (HAS_FOG)
        for (uint m = 0; m < media_count(); m++)
            if (is_fog(m))
                find_fog_collision(m);
}

// If phase functions depend on the channel, directions are drawn for one channel, and the path has
// light of this one only, three times as much.
vec3 first_throughput()
{
    vec3 only = vec3(0.0);
    if (!PHASES_COLOURED)
        return vec3(1.0);
    only[min(uint(3.0 * draw().x), 2u)] = 3.0;
    return only;
}

uint path_channel() { return path.throughput.r > 0.0 ? 0u : path.throughput.g > 0.0 ? 1u : 2u; }

void start()
{
    uint texel = thread / run.paths, texel_px = frame.light_texel_px;
    uvec2 size_px = uvec2(frame.width_px, frame.height_px);
    uint wide = light_size(size_px, texel_px).x;
    uvec2 low_px = texel_px * uvec2(texel % wide, texel / wide);
    // The last texel of a row or column may be smaller.
    vec2 high_px = vec2(min(low_px + texel_px, size_px));
    ViewRay ray = camera_ray_at(frame_camera(), mix(vec2(low_px), high_px, draw().xy));
    path = LightPath(ray.origin_m, 0u, ray.direction, NO_SOLID, first_throughput(), 1u, vec3(0.0),
                     0.0);
    find_next_events();
}

void end()
{
    if (path.events == 0u)
        misses++;
    path.is_alive = 0u;
}

// --- events -------------------------------------------------------------------------------------

// A scattering event or reflection at the path's origin: counts the sunlight there and samples the
// new direction. `m` is the medium, or MEDIA_MAX on `solid`.
void process_event(uint m, uint solid)
{
    vec4 u = draw();
    float sun_thinness = 1.0;
    vec3 per_sr, next;
    bool is_lost = false;
    events++;
    if (m == MEDIA_MAX) {
        Surface surface = surface_at(solid, path.origin_m);
        path.throughput *= surface.albedo;
        per_sr = vec3(max(0.0, hit_cosine(solid, surface.normal, to_sun())) / PI);
        next = sample_cosine(surface.normal, u.xy);
        is_lost = is_through_own(solid, surface.normal, next);
    } else {
        uint kind = make_nonuniform(frame.media[m].phase_kind);
        float g = frame.media[m].g;
        path.throughput *= frame.media[m].albedo;
        if (is_similar(m, path.events)) {
            kind = PHASE_HENYEY_GREENSTEIN;
            g = path_similar_cosine(m);
            path.throughput *= turning_fraction(m) / thinness(m, path.events);
        }
        per_sr = phase_rgb_per_sr(kind, g, path.direction, to_sun());
        next = sample_phase(kind, phase_channel_g(kind, g, path_channel()), path.direction, u.xy);
        // Sunlight arrives in the medium of the next segment.
        sun_thinness = thinness(m, path.events + 1u);
    }
    path.solid = solid;
    if (path.events > 0u && per_sr != vec3(0.0) && make_nonuniform(frame.scatters) != 0u &&
        sees_sun(path.origin_m, solid))
        sums.light += path.throughput * per_sr * sun_at(path.origin_m) *
                      fraction_through(sun_thinness * sample_sun_depth(path.origin_m));
    path.events++;
    path.direction = next;
    if (is_lost)
        path.throughput = vec3(0.0);
    float most = max(path.throughput.r, max(path.throughput.g, path.throughput.b));
    float survival = min(1.0, most / ROULETTE);
    if (u.z >= survival) {
        end();
        return;
    }
    path.throughput /= survival;
    find_next_events();
}

void collide(uint m)
{
    if (path.events == 0u) {
        sums.collisions += 1.0;
        sums.distance_m += dot(path.origin_m, path.direction);
    }
    process_event(m, NO_SOLID);
}

// Adds the air's light and applies its transmittance on the way out of the media, to space or to
// the ground (solid 0), as seen from the centre of all media.
void add_air_light()
{
    SkyLight light = sky_look_up(eye.places[1], sky_ray_along(eye.places[1], path.direction));
    sums.light += path.throughput * frame.sun_irradiance * light.volume;
    path.throughput *= light.transmittance;
}

// The end of a segment without a collision in a shape.
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
        add_air_light();
    if (solid_ahead.solid == NO_SOLID || path.events == 0u ||
        surface_albedo(solid_ahead.solid) == vec3(0.0))
        end();
    else
        process_event(MEDIA_MAX, solid_ahead.solid);
}

// --- turns --------------------------------------------------------------------------------------

// A segment with a constant majorant: the extinction of the shapes does not exceed it.
struct Stride {
    float length_m, majorant_per_m;
};

// Shortens the stride to the next face of a medium's majorant cell and adds the cell's majorant.
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
        path_extinction_color(m) *
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

// A tentative collision: it is real with probability extinction / majorant, in a medium chosen by
// its part of the extinction.
void try_collision(float majorant_per_m, float u)
{
    float left_per_m = u * majorant_per_m;
    uint by = MEDIA_MAX;
    [[unroll]] for (uint m = 0; m < media_count(); m++) {
        if (by != MEDIA_MAX || is_fog(m) || !medium_contains(m, path.origin_m))
            continue;
        left_per_m -= path_extinction_color(m) * frame.media[m].extinction_per_m *
                      shape_random_density(get_medium_kind(m), frame.media[m].shape, path.origin_m,
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
            try_collision(stride.majorant_per_m, u.y);
            return;
        }
    }
    if (stride.length_m < end_m) {
        advance(stride.length_m);
        return;
    }
    bool is_open = end_m >= 0.5 * FAR_M; // nothing is met any more
    if (!is_open)
        path.origin_m += end_m * path.direction;
    arrive();
}

// --- estimates ahead ----------------------------------------------------------------------------

bool is_in_light_grid(vec3 point_m)
{
    vec3 place = (point_m - frame.light_lattice.origin_m) * frame.light_lattice.per_m;
    vec3 size = vec3(frame.light_lattice.size);
    bvec3 is_within = equal(clamp(place, vec3(0.0), size), place);
    bvec3 is_endless = lessThanEqual(size, vec3(1.0));
    return all(bvec3(uvec3(is_within) | uvec3(is_endless)));
}

// The estimate of a path's future light, from diffused light. A path without a collision counts
// none: its light is single scattering. The sky's part is estimated as in a white medium.
vec3 light_ahead()
{
    vec3 to_path = vec3(0.0);
    if (path.is_alive == 0u || path.events == 0u)
        return to_path;
    if (is_in_light_grid(path.origin_m)) {
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
        find_next_events();
    }
    for (uint i = 0; i < run.turns && events < run.events && misses < MISSES_MAX &&
                     !has_walked_enough();
         i++) {
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
    check_loops();
    paths[thread] = path;
    found[thread] = sums;
}
