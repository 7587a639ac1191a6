#version 450
// SPDX-License-Identifier: MIT
//
// The path tracer: light that was scattered at least once, without bias.
//
// One work group works on a pool of items, an item being one sample of one pixel. Every thread
// carries one path; where it ends, the thread takes the next item. A turn of the main loop takes
// every thread one segment further: a ray towards the sun or the next stretch of the path. So all
// threads have something to do in every part of the loop, whatever state their paths are in. Paths
// that are not at their end when the turns are over wait in a buffer for the next dispatch.
//
// An item's result depends on (seed, pixel, sample) alone, not on the thread or the dispatch.
#extension GL_GOOGLE_include_directive : require

#include "tracer.glsl"

layout(local_size_x_id = 2) in;
layout(constant_id = 3) const bool MULTIPLE = true;     // all orders of scattering
layout(constant_id = 4) const bool SURFACES = true;     // a solid reflects
layout(constant_id = 5) const bool ENVIRONMENT = true;  // the background lights media and solids
layout(constant_id = 6) const bool FORCED = true;       // tracer_first.comp has been here

// Below this part of its first throughput a path lives on by chance alone (Russian roulette).
const float ROULETTE = 0.05;

// What the thread is about to do.
const uint STAGE_IDLE = 0;     // take an item
const uint STAGE_PATH = 1;     // send a stretch of the path from `origin` along `direction`
const uint STAGE_MEDIUM = 2;   // scatter in `medium` at `origin`
const uint STAGE_SURFACE = 3;  // reflect from `solid` at `origin`
const uint STAGE_BEHIND = 4;   // start the path of the surface behind the media
const uint STAGE_NONE = 5;     // hand in the item
const uint STAGE_DONE = 6;     // no items are left

struct State {
    vec3 origin_m;
    uint stage;
    vec3 direction;
    uint item;
    vec3 throughput;
    uint drawn; // random numbers so far, in threes
    vec3 pending; // sunlight that the path would bring home if nothing were in its way
    uint medium;
    vec3 next_direction; // of the path, after the ray to the sun
    uint solid;          // that `origin` lies on, or NO_SOLID
    vec3 channels;       // probability density of the path in each channel, up to a factor
    uint hero;           // the channel that distances are drawn for
    uvec3 key;
    uint events; // scatterings and reflections
    vec3 order1;
    uint is_surface_first;
    vec3 higher;
    uint is_towards_sun;
    vec3 surface;
    float roulette; // the throughput below which it is played
};

layout(std430, binding = 5) buffer States {
    State states[];
};

State path;
uint collisions = 0, lookups = 0, closed_forms = 0, items_done = 0;

uvec3 draw()
{
    return pcg3d(uvec3(path.key.xy, path.key.z + path.drawn++));
}

// --- items --------------------------------------------------------------------------------------

uint pool() { return run.first_pool + gl_WorkGroupID.x; }

uint item_pixel() { return pool() * POOL_PIXELS + path.item / BATCH_SAMPLES; } // in the chunk

// The path of the current item from the camera, all over again.
void start_path()
{
    path.origin_m = vec3(0.0);
    path.direction = pixel_ray(run.first_pixel + item_pixel());
    path.throughput = vec3(1.0);
    path.roulette = ROULETTE;
    path.solid = NO_SOLID;
    path.channels = vec3(1.0);
    path.events = 0;
    path.is_surface_first = 0;
    path.is_towards_sun = 0;
}

// Straight to the surface behind the media, if light can come from there that is not known yet.
void start_at_surface()
{
    start_path();
    path.stage = STAGE_NONE;
    if (!SURFACES || !(MULTIPLE || ENVIRONMENT))
        return;
    Hit hit = scene_hit(vec3(0.0), path.direction);
    if (hit.solid == NO_SOLID || solids[hit.solid].albedo.rgb == vec3(0.0))
        return;
    path.solid = hit.solid;
    path.origin_m = hit.t_m * path.direction;
    path.stage = STAGE_SURFACE;
}

void start_at_first_collision()
{
    First first = firsts[pool() * POOL_ITEMS + path.item];
    start_path();
    path.origin_m = first.t_m * path.direction;
    path.throughput = vec3(first.weight);
    path.roulette = ROULETTE * first.weight;
    path.medium = first.medium;
    path.stage = first.weight > 0.0 ? STAGE_MEDIUM : STAGE_BEHIND;
}

void take_item()
{
    path.item = atomicAdd(next_items[pool()], 1);
    if (path.item >= POOL_ITEMS || item_pixel() >= run.pixel_count) {
        path.stage = STAGE_DONE;
        return;
    }
    uint result = pool() * POOL_ITEMS + path.item;
    path.key = sample_key(run.first_pixel + item_pixel(),
                          run.first_sample + path.item % BATCH_SAMPLES).xyz;
    path.drawn = 0;
    path.hero = COLOURED ? min(uint(3.0 * uniform_from(draw()).x), 2u) : 0;
    path.order1 = FORCED ? results[result].order1.rgb : vec3(0.0);
    path.higher = vec3(0.0);
    path.surface = vec3(0.0);
    if (FORCED) {
        start_at_first_collision();
    } else {
        start_path();
        path.stage = STAGE_PATH;
    }
}

// A path is at its end. With forced collisions an item has two: one from the media and one from
// the surface behind them.
void finish_path()
{
    path.stage = FORCED && path.is_surface_first == 0 ? STAGE_BEHIND : STAGE_NONE;
}

void finish_item()
{
    results[pool() * POOL_ITEMS + path.item] =
        Result(vec4(path.order1, 0.0), vec4(path.higher, 0.0), vec4(path.surface, 0.0));
    path.stage = STAGE_IDLE;
    items_done++;
}

// Light that arrives along the path. The path stands for all three channels: its density is the
// mean of theirs (single-sample multiple importance sampling; Miller, Georgiev, Jarosz 2019).
void add_light(vec3 light)
{
    if (COLOURED)
        light *= path.channels * (3.0 / (path.channels.r + path.channels.g + path.channels.b));
    if (path.is_surface_first != 0) {
        path.surface += light;
        return;
    }
    if (path.events == 1)
        path.order1 += light;
    else
        path.higher += light;
}

// --- events -------------------------------------------------------------------------------------

// Go on along `direction` with `throughput`, or end: there is nothing more to find, or by roulette.
void prepare_next(vec3 direction, float u)
{
    path.next_direction = direction;
    bool goes_on = MULTIPLE || (ENVIRONMENT && path.events == 1);
    float most = max(path.throughput.r, max(path.throughput.g, path.throughput.b));
    float survival = min(1.0, most / path.roulette);
    if (!goes_on || u >= survival)
        path.throughput = vec3(0.0);
    else
        path.throughput /= survival;
}

void scatter()
{
    uvec3 bits = draw();
    vec3 u = uniform_from(bits);
    uint m = path.medium;
    path.events++;
    path.solid = NO_SOLID;
    path.throughput *= frame.media[m].albedo;
    float phase = phase_per_sr(frame.media[m].phase_kind, frame.media[m].g, path.direction,
                               frame.sun_direction);
    bool is_lit = FORCED && path.events == 1; // by tracer_first.comp
    path.pending = is_lit ? vec3(0.0) : path.throughput * frame.sun_irradiance * phase;
    prepare_next(sample_phase(frame.media[m].phase_kind, frame.media[m].g, path.direction, u.xy),
                 u.z);
}

// The sunlight that the first surface reflects is known without chance and not sampled.
void reflect_light()
{
    vec3 u = uniform_from(draw());
    vec3 normal = solid_normal(solids[path.solid], path.origin_m);
    path.events++;
    path.throughput *= solids[path.solid].albedo.rgb;
    float cosine = max(0.0, dot(normal, frame.sun_direction));
    bool is_first = path.events == 1;
    path.pending = is_first ? vec3(0.0) : path.throughput * frame.sun_irradiance * (cosine / PI);
    path.is_surface_first |= uint(is_first);
    prepare_next(sample_cosine(normal, u.xy), u.z);
}

void happen()
{
    if (path.stage == STAGE_MEDIUM)
        scatter();
    else
        reflect_light();
    path.is_towards_sun =
        uint(path.pending != vec3(0.0) && sees_sun(path.origin_m, path.solid));
    path.direction = path.is_towards_sun != 0 ? frame.sun_direction : path.next_direction;
    path.stage = STAGE_PATH;
}

// --- segments -----------------------------------------------------------------------------------

// Nearest surface with t > 0 of any solid but the one that the origin lies on (they are convex).
Hit nearest_hit(vec3 origin_m, vec3 direction, uint except)
{
    Hit hit = Hit(FAR_M, NO_SOLID);
    for (uint s = 0; s < frame.solid_count; s++) {
        float t0_m, t1_m;
        if (s == except || !solid_interval(solids[s], origin_m, direction, t0_m, t1_m))
            continue;
        float t_m = t0_m > 0.0 ? t0_m : t1_m;
        if (t_m > 0.0 && t_m < hit.t_m)
            hit = Hit(t_m, s);
    }
    return hit;
}

// What a segment has come to.
float end_m;        // of the segment: the nearest event so far
uint end_medium;    // that has a collision there, or MEDIA_MAX
uint end_solid;     // that is met there, or NO_SOLID
vec3 sun_fraction;  // of a ray to the sun: the part that arrives

// Media with closed forms: free paths by inversion, transmittance exact.
void cross_closed_forms()
{
    for (uint m = 0; m < frame.medium_count; m++) {
        float t0_m = 0.0, t1_m = end_m;
        if (!clip_box(frame.media[m].low_m, frame.media[m].high_m, path.origin_m, path.direction,
                      t0_m, t1_m))
            continue;
        float y_m = path.origin_m.y + t0_m * path.direction.y;
        for (uint l = 0; l < frame.media[m].layer_count; l++) {
            FogLayer layer = frame.media[m].layers[l];
            if (path.is_towards_sun != 0) {
                sun_fraction *=
                    transmittance(fog_optical_depth(layer, y_m, path.direction.y, t1_m - t0_m));
                closed_forms++;
                continue;
            }
            float t_m = t0_m + fog_free_path(layer, y_m, path.direction.y,
                                             exponential_from(draw().x));
            if (t_m < min(t1_m, end_m)) {
                end_m = t_m;
                end_medium = m;
                end_solid = NO_SOLID;
            }
        }
    }
}

void end_segment()
{
    if (path.is_towards_sun != 0) {
        add_light(path.pending * sun_fraction);
        path.is_towards_sun = 0;
        path.direction = path.next_direction;
        return;
    }
    if (end_medium == MEDIA_MAX && end_solid == NO_SOLID) { // out into the sky
        if (ENVIRONMENT && path.events > 0)
            add_light(path.throughput * frame.background);
        finish_path();
        return;
    }
    // Single scattering and single reflection know one event only.
    bool may_happen = MULTIPLE || path.events == 0;
    if (end_medium != MEDIA_MAX) {
        collisions++;
        path.medium = end_medium;
        path.stage = STAGE_MEDIUM;
    } else {
        path.solid = end_solid;
        path.stage = STAGE_SURFACE;
        may_happen = may_happen && SURFACES && (MULTIPLE || ENVIRONMENT) &&
                     solids[end_solid].albedo.rgb != vec3(0.0);
    }
    path.origin_m += end_m * path.direction;
    if (!may_happen)
        finish_path();
}

void segment()
{
    end_m = FAR_M;
    end_medium = MEDIA_MAX;
    end_solid = NO_SOLID;
    sun_fraction = vec3(1.0);
    if (path.is_towards_sun == 0) {
        if (path.throughput == vec3(0.0)) {
            finish_path();
            return;
        }
        Hit hit = nearest_hit(path.origin_m, path.direction, path.solid);
        end_m = hit.t_m;
        end_solid = hit.solid;
    }
    cross_closed_forms();
    end_segment();
}

void main()
{
    uint thread = gl_GlobalInvocationID.x;
    if (run.is_fresh != 0)
        path.stage = STAGE_IDLE;
    else
        path = states[thread];
    for (uint turn = 0; turn < run.turns && path.stage != STAGE_DONE; turn++) {
        if (path.stage == STAGE_BEHIND)
            start_at_surface();
        if (path.stage == STAGE_NONE)
            finish_item();
        if (path.stage == STAGE_IDLE)
            take_item();
        if (path.stage == STAGE_MEDIUM || path.stage == STAGE_SURFACE)
            happen();
        if (path.stage == STAGE_PATH)
            segment();
    }
    states[thread] = path;
    atomicAdd(progress.items_done, items_done);
    atomicAdd(progress.collisions, collisions);
    atomicAdd(progress.lookups, lookups);
    atomicAdd(progress.closed_forms, closed_forms);
}
