#version 450
// SPDX-License-Identifier: MIT
//
// The path tracer's main kernel: multiple scattering, unbiased. renderer/tracer.h describes the
// estimator.
//
// A work group processes a queue of items; an item is one sample of one pixel. Every thread has one
// path, and takes the next item when the path ends. One iteration (turn) of the main loop advances
// every thread by one segment: a ray towards a light or the next segment of the path. The work is a
// state machine:
//
//   IDLE -> MEDIUM, SURFACE -> LEAVE -> ENTER <-> TRACK -> ARRIVE -> next event or segment
//
//   end of a path -> BEHIND -> SURFACE     the path of the surface behind the media
//                           -> NONE -> IDLE
//
// All threads have work in every part of the loop, in any state. (On drivers without branches,
// above all lavapipe, every part of the loop costs every thread.) Unfinished paths wait in a buffer
// for the next dispatch.
//
// The result of an item depends on (seed, pixel, sample) only, not on the thread or the dispatch.
#extension GL_GOOGLE_include_directive : require

#define DRAWS_COVERAGE
#define WALKS_ALONE // scene.glsl
#include "tracer_lamps.glsl"
#include "tracer_sun.glsl"

layout(local_size_x_id = 2) in;

// Fraction of the first throughput below which Russian roulette decides whether a path continues.
const float ROULETTE = 0.05;

// Fraction of an event's sunlight below which roulette decides whether its ray continues. Fog is
// not part of that fraction (cross_fog()): its transmittance is exact and costs no steps, and
// behind a fog of optical depth 16 a roulette at 0.2 would keep one ray in two million, a loss that
// the variance of the pixel would not show.
const float SUN_ROULETTE = 0.2;

// The threshold for light of lamps that is scattered on the view ray is lower: behind an
// optical depth of 10 a roulette at 0.2 keeps one ray in 4,000, and the variance of a pixel does
// not show the loss.
const float LAMP_ROULETTE = 0.01;

// Majorant cells per turn.
layout(constant_id = 9) const uint STEPS = 8;

// A tracked medium that starts more than this many of its free paths away is tracked with its entry
// as the origin. From 2^23 free paths on, a step would be below the last bit of the distance: the
// ray would meet one tentative collision after the other at the same place, endlessly where the
// density is 0.
const float FAR_FREE_PATHS = 1e4;

// Empty items that a thread skips per turn, at most.
const uint TAKES = NEPH_GPU_TAKES;

// State of the thread: its next action.
const uint STAGE_IDLE = 0;    // take an item
const uint STAGE_MEDIUM = 1;  // scatter in `medium` at `origin`
const uint STAGE_SURFACE = 2; // reflect from `solid` at `origin`
const uint STAGE_LEAVE = 3;   // start a segment from `origin` along `direction`
const uint STAGE_ENTER = 4;   // find the next tracked medium
const uint STAGE_TRACK = 5;   // track through its majorant cells
const uint STAGE_ARRIVE = 6;  // end of the segment
const uint STAGE_BEHIND = 7;  // start the path of the surface behind the media
const uint STAGE_NONE = 8;    // store the item's result
const uint STAGE_DONE = 9;    // no items left

// Kind of the current segment.
const uint RAY_PATH = 0;
const uint RAY_SUN = 1;   // transmittance of the sunlight
const uint RAY_VIEW = 2;  // if OPEN: transmittance of the light behind the media
const uint RAY_FIRST = 3; // if OPEN: transmittance from a first collision at a guessed place
const uint RAY_PLACE = 4; // if LAMPS: transmittance from a place on the next segment,
const uint RAY_LAMP = 5;  // and from a lamp to that place

// Some directions are drawn around the sun (turn()), which waits for the event's sunlight.
const bool SUNWARD = HAS_PHASE_TABLES && MULTIPLE;

// Transmittance of an event's sunlight that no ray of this kernel samples: a guess.
const float UNKNOWN_SUNLIT = 0.5;

// Without any other kind of ray the compiler removes their code.
const bool ONLY_PATHS = SUN_BY_TABLE && !SURFACES && !LAMPS;

struct TracerState {
    vec3 origin_m;
    uint stage;
    vec3 direction;
    uint item;
    vec3 throughput;
    uint drawn; // random numbers drawn so far, in threes
    vec3 pending; // light of the current shadow ray, before its transmittance
    uint medium;
    vec3 next_direction; // of the path, after the shadow ray
    uint solid;          // solid that `origin` lies on, or NO_SOLID
    vec3 channels;       // probability density of the path per channel, over the hero's
    uint hero;           // channel by which distances are drawn
    uvec3 key;
    uint events; // scatterings and reflections so far
    vec3 order1;
    uint is_surface_first;
    vec3 higher;
    uint ray;
    vec3 surface;
    float roulette; // throughput below which roulette is played
    // The current segment.
    vec3 sun_fraction; // transmittance of a shadow or view ray so far
    float end_m;       // nearest event so far
    uint end_medium;   // medium with a collision there, or MEDIA_MAX
    uint end_solid;    // solid that is hit there, or NO_SOLID
    uint tracked;      // index in TRACKED_ORDER
    float skipped_m;   // distance on the segment from which a far medium is tracked
    float t_m;         // position of the tracking, from there on
    ivec3 cell;
    float depth_left; // majorant optical depth to the next tentative collision
    vec3 view_fraction; // if OPEN: transmittance of the view ray
    float sun_roulette; // fraction below which roulette is played
    float reach_m;      // length of a ray to a first collision, a place or a lamp
    float raised;       // factor by which majorants are raised
    float sun_depth;    // guessed, where sunlight needs a low variance; else 0
    // If LAMPS: start of the next segment, while its lamp light is sampled.
    vec3 segment_origin_m;
    uint segment_solid;
    vec3 lamp_direction; // from the place to the lamp
    float lamp_m;
    uint is_looked_for; // 1: lamp light of the next segment is sampled already
    SunCheck check; // if SUN_BY_TABLE: of the item so far
    // If SUNWARD.
    vec3 came_along;  // direction before the event
    float sunlit_sum; // transmittance of the sunlight, summed over the events of the path
};

layout(std430, binding = 5) buffer States {
    TracerState states[];
};

TracerState path;

bool is_path() { return ONLY_PATHS || path.ray == RAY_PATH; }

// Scene data of every turn, read before the first branch or loop. Inside one, lavapipe reads a
// uniform lane by lane.
Camera camera;
vec3 sun_direction, sun_irradiance, background;
Lattice sun_lattice;
Medium only;              // in a scene with one medium
Medium tracked;           // the medium that the thread tracks in this turn
vec3 tracked_cells_per_m; // of its majorant grid

uint collisions = 0, lookups = 0, closed_forms = 0, items_done = 0;

uint tracked_medium()
{
    return (TRACKED_ORDER >> (4 * (TRACKED_COUNT > 1 ? path.tracked : 0))) & 0xfu;
}

void read_tracked()
{
    tracked = frame.media[tracked_medium()];
    tracked_cells_per_m = vec3(tracked.majorant_size) / (tracked.high_m - tracked.low_m);
}

void read_scene()
{
    camera = frame_camera();
    sun_direction = to_sun();
    sun_irradiance = make_nonuniform(frame.sun_irradiance);
    background = frame.background;
    if (SUN_BY_TABLE)
        sun_lattice = frame.sun_lattice;
    only = frame.media[0]; // of its members, those that decide branches
    only.phase_kind = make_nonuniform(only.phase_kind);
    only.g = make_nonuniform(only.g);
    only.layer_count = make_nonuniform(only.layer_count);
    read_tracked();
}

uvec3 draw()
{
    return pcg3d(uvec3(path.key.xy, path.key.z + path.drawn++));
}

uvec4 draw4()
{
    return pcg4d(uvec4(path.key, path.drawn++));
}

// The ray of a segment, or with 1 an event's shadow ray, draws its own part of meshes with alpha as
// coverage; all that start at the camera draw the same.
void draw_coverage(uint shadow)
{
    if (MESH_COVERAGE)
        set_coverage(path.key.zy + uvec2(path.events == 0u ? 0u : path.drawn + 1u, shadow), 0u);
}

// --- items --------------------------------------------------------------------------------------

uint queue() { return run.first_queue + gl_WorkGroupID.x; }

// Index of the item's pixel in the chunk.
uint item_pixel() { return queue() * run.queue_pixels + path.item / run.samples; }

// Index of the item's result.
uint item_place() { return queue() * queue_items() + path.item; }

// Resets the path to its start at the camera.
ViewRay start_path()
{
    uint pixel = run.first_pixel + item_pixel();
    ViewRay ray = pixel_ray(camera, pixel);
    path.origin_m = ray.origin_m;
    path.direction = ray.direction;
    path.throughput = vec3(1.0);
    path.roulette = ROULETTE;
    path.solid = NO_SOLID;
    path.channels = vec3(1.0);
    path.events = 0;
    path.ray = RAY_PATH;
    path.raised = 1.0;
    path.sun_depth = 0.0;
    path.is_looked_for = 0;
    path.sunlit_sum = 0.0;
    return ray;
}

// Starts at the surface behind the media, if it can contribute light that is not known yet.
void start_at_surface()
{
    path.stage = STAGE_NONE;
    if (!SURFACES || !(OPEN || MULTIPLE || ENVIRONMENT))
        return;
    ViewRay ray = start_path();
    if (OPEN) {
        path.throughput = path.view_fraction;
        path.roulette *= max_channel(path.view_fraction);
        if (path.roulette <= 0.0)
            return;
    }
    draw_coverage(0u);
    Hit hit = scene_hit(ray.origin_m, ray.direction);
    if (hit.solid == NO_SOLID || surface_albedo(hit.solid) == vec3(0.0))
        return;
    path.solid = hit.solid;
    path.origin_m = view_point_m(ray, hit.t_m);
    path.stage = STAGE_SURFACE;
}

// If OPEN: first the view ray, then a path from the camera.
void start_at_camera()
{
    start_path();
    path.ray = RAY_VIEW;
    path.sun_fraction = vec3(1.0);
    path.sun_roulette = 0.0;
    path.stage = STAGE_LEAVE;
}

// Factor for majorants on rays to a guessed place, where even small transmittances need a low
// relative variance: with tight majorants ratio tracking has the relative variance e^(optical
// depth).
float majorant_factor(float guessed_depth)
{
    const float RAISED_MAX = 16.0;
    return clamp(guessed_depth, 1.0, RAISED_MAX);
}

// Starts the ray to a first collision that is already chosen, if the guess has a lower variance
// than a free flight. Lamp light of the view ray is sampled before.
void start_for_guessed_collision()
{
    if (LAMPS && make_nonuniform(frame.scatters_lamps) != 0u && path.is_looked_for == 0)
        return;
    First first = firsts[item_place()];
    if (first.medium == MEDIA_MAX)
        return;
    path.throughput = first.weight;
    if (first.weight == vec3(0.0)) // the path ends
        return;
    path.ray = RAY_FIRST;
    path.sun_fraction = vec3(1.0);
    path.sun_roulette = 0.0;
    path.medium = first.medium;
    path.reach_m = first.t_m;
    path.raised = majorant_factor(first.view_depth);
    path.sun_depth = MULTIPLE ? 0.0 : max(first.sun_depth, 1.0);
}

void start_at_first_collision()
{
    First first = firsts[item_place()];
    path.origin_m = view_point_m(start_path(), first.t_m);
    path.throughput = first.weight;
    path.roulette = ROULETTE * max_channel(first.weight);
    path.medium = first.medium;
    path.stage = path.roulette > 0.0 ? STAGE_MEDIUM : STAGE_BEHIND;
    if (COLOURED)
        path.channels = first.channels;
}

// Whether an item has neither a medium nor a surface; its result is the sum of the first kernels.
bool is_empty_item()
{
    return !OPEN && !SURFACES && firsts[item_place()].weight == vec3(0.0);
}

// Takes the next item with a path; false without one among TAKES items, to try again next turn.
bool find_item()
{
    for (uint i = 0; i < TAKES; i++) {
        path.item = atomicAdd(next_items[queue()], 1);
        if (path.item >= queue_items() || item_pixel() >= run.pixel_count) {
            path.stage = STAGE_DONE;
            return false;
        }
        if (!is_empty_item())
            return true;
        items_done++;
    }
    return false;
}

void take_item()
{
    if (!find_item())
        return;
    path.key = sample_key(run.first_pixel + item_pixel(),
                          run.first_sample + path.item % run.samples).xyz;
    path.drawn = 0;
    path.hero = choose_hero(draw());
    path.order1 = vec3(0.0);
    if (!OPEN)
        path.order1 = results[item_place()].order1.rgb;
    path.higher = vec3(0.0);
    if (!OPEN && EMITS)
        path.higher = results[item_place()].higher.rgb;
    path.surface = vec3(0.0);
    path.is_surface_first = 0;
    path.view_fraction = vec3(0.0);
    path.check = no_sun_check();
    if (OPEN)
        start_at_camera();
    else
        start_at_first_collision();
}

// The end of a path. An item has two paths: one from the media, one from the surface behind them.
void finish_path()
{
    path.stage = path.is_surface_first == 0 ? STAGE_BEHIND : STAGE_NONE;
}

void finish_item()
{
    if (SUN_BY_TABLE)
        sun_checks[item_place()] = path.check;
    results[item_place()] =
        Result(vec4(path.order1, path.view_fraction.r), vec4(path.higher, path.view_fraction.g),
               vec4(path.surface, path.view_fraction.b));
    path.stage = STAGE_IDLE;
    items_done++;
}

void add_weighted_light(vec3 light)
{
    if (path.is_surface_first != 0)
        path.surface += light;
    else if (path.events == 1)
        path.order1 += light;
    else
        path.higher += light;
}

void add_light(vec3 light) { add_weighted_light(light * channel_weights(path.channels)); }

// Adds emission at an event of the path.
void add_emitted(vec3 glow)
{
    vec3 light = path.throughput * glow * channel_weights(path.channels);
    if (path.is_surface_first != 0)
        path.surface += light;
    else
        path.higher += light;
}

// Roulette for a shadow ray with little light.
void play_sun_roulette(float u)
{
    float most = max_channel(path.sun_fraction);
    if (most < path.sun_roulette)
        path.sun_fraction *= u * path.sun_roulette < most ? path.sun_roulette / most : 0.0;
}

// If SOBOL: a low-discrepancy pair for one of the first decisions of the item.
uvec2 first_bits(uint decision)
{
    return low_discrepancy(run.first_pixel + item_pixel(),
                           run.first_sample + path.item % run.samples, decision);
}

// --- lamps ------------------------------------------------------------------------------------

// One order more than the events so far: the place on the segment is an event, too.
void add_lamplight(vec3 light)
{
    light *= channel_weights(path.channels);
    if (path.is_surface_first != 0)
        path.surface += light;
    else if (path.events == 0)
        path.order1 += light;
    else
        path.higher += light;
}

// Whether lamp light scattered on the next segment is still to be sampled. For the view ray
// tracer_first.comp has done it, unless OPEN.
bool is_lamp_light_pending()
{
    bool counts = make_nonuniform(frame.scatters_lamps) != 0u &&
                  (path.events > 0 ? MULTIPLE : OPEN);
    return counts && path.is_looked_for == 0 && path.throughput != vec3(0.0);
}

// Chooses a place on the next segment, which ends at `end_m`, and starts the ray from there.
bool send_to_place(float end_m)
{
    path.is_looked_for = 1;
    uint pixel = path.events == 0 ? run.first_pixel + item_pixel() : NO_PIXEL;
    LampPlace place = draw_lamp_place(path.origin_m, path.direction, end_m,
                                      uniform_from(draw()).xy, pixel);
    if (place.density_per_m <= 0.0)
        return false;
    path.pending = path.throughput *
                   lamplight_at(place, path.origin_m + place.t_m * path.direction, path.direction);
    if (path.pending == vec3(0.0))
        return false;
    path.ray = RAY_PLACE;
    path.reach_m = place.t_m;
    path.next_direction = path.direction;
    path.segment_origin_m = path.origin_m;
    path.segment_solid = path.solid;
    path.lamp_direction = place.to_lamp;
    path.lamp_m = place.distance_m;
    path.sun_fraction = vec3(1.0);
    path.sun_roulette = path.events == 0 ? LAMP_ROULETTE : SUN_ROULETTE;
    return true;
}

// Continues from the place to the lamp, with the transmittance so far.
void arrive_at_place()
{
    path.origin_m += path.reach_m * path.direction;
    path.direction = path.lamp_direction;
    path.reach_m = path.lamp_m;
    path.ray = RAY_LAMP;
    path.stage = STAGE_LEAVE;
}

void arrive_from_lamp()
{
    add_lamplight(path.pending * path.sun_fraction);
    path.origin_m = path.segment_origin_m;
    path.solid = path.segment_solid;
    path.direction = path.next_direction;
    path.ray = RAY_PATH;
    path.stage = STAGE_LEAVE;
}

// At a surface one ray samples either the sun or a lamp, with equal probability if there is a sun.
bool sample_surface_lamp(vec3 normal, inout vec3 sun_per_sr)
{
    vec3 u = uniform_from(draw());
    float probability, share = sun_irradiance == vec3(0.0) ? 1.0 : 0.5;
    if (u.x >= share) {
        sun_per_sr /= 1.0 - share;
        return false;
    }
    Lamp lamp = frame.lamps[pick_lamp(path.origin_m, u.y, probability)];
    vec3 way_m = lamp.position_m - path.origin_m;
    path.lamp_m = max(length(way_m), 1e-12);
    path.lamp_direction = way_m / path.lamp_m;
    float per_sr = max(0.0, hit_cosine(path.solid, normal, path.lamp_direction)) / PI;
    bool is_known = path.events == 1 && !OPEN; // by tracer_view.comp
    path.pending = probability > 0.0 && !is_known
                       ? path.throughput *
                             lamp_irradiance(lamp, path.lamp_direction,
                                             per_sr / (path.lamp_m * path.lamp_m * share *
                                                       probability))
                       : vec3(0.0);
    path.sun_fraction = vec3(1.0);
    path.sun_roulette = SUN_ROULETTE;
    return true;
}

// Weighs the channels by the densities with which they would have drawn a direction, if phase
// functions depend on the channel. The light of the shadow ray, which arrives later, gets its
// weights before that. At the bound the hero's own weight is less than 1e-30.
void weigh_direction(vec3 drawn_per_sr)
{
    vec3 ratios = drawn_per_sr / max(drawn_per_sr[path.hero], 1e-30);
    path.channels = min(path.channels * ratios, vec3(1e30));
}

// The table by which directions are drawn around the sun: the medium's own, or the first.
float peak_table(bool is_medium, Medium by)
{
    if (MEDIA == 1 || (is_medium && by.phase_kind == PHASE_TABLE))
        return by.g;
    for (uint m = 0; m < media_count(); m++)
        if (frame.media[m].phase_kind == PHASE_TABLE)
            return frame.media[m].g;
    return 0.0;
}

// Draws some directions towards lamps, and a share around the sun by a phase function, because few
// paths meet a diffraction peak by chance (truth/path.c). `next` is drawn by the medium or the
// surface alone. The throughput gets the mixture's weight. `expected` receives the sunlight that
// the next event scatters, relative to isotropic scattering, or 1 if it is less.
vec3 turn(vec3 next, vec3 before, bool is_medium, Medium by, vec3 normal, float sun_share,
          out float expected)
{
    uvec4 bits = draw4();
    float choice = uniform_from(bits.xyz).x, peak = SUNWARD ? peak_table(is_medium, by) : 0.0;
    if (LAMPS && choice < LAMP_DIRECTIONS)
        next = draw_lamp_direction(path.origin_m, uniform_from(bits.yzw));
    else if (SUNWARD && choice < sun_share + (LAMPS ? LAMP_DIRECTIONS : 0.0))
        next = sample_phase(PHASE_TABLE, phase_channel_g(PHASE_TABLE, peak, path.hero),
                            sun_direction, uniform_from(bits.yzw).xy);
    vec3 wanted = is_medium ? phase_rgb_per_sr(by.phase_kind, by.g, before, next)
                            : vec3(max(0.0, hit_cosine(path.solid, normal, next)) / PI);
    vec3 drawn = wanted;
    expected = 1.0;
    if (LAMPS)
        drawn = mix(wanted, vec3(lamp_direction_per_sr(path.origin_m, next)), LAMP_DIRECTIONS);
    if (SUNWARD) {
        vec3 sunward = phase_rgb_per_sr(PHASE_TABLE, peak, next, sun_direction);
        drawn += sun_share * (sunward - wanted);
        if (sun_share > 0.0)
            expected = max(1.0, 4.0 * PI * max_channel(sunward));
    }
    path.throughput *= wanted / max(drawn, vec3(1e-30));
    bool is_peak_drawn = SUNWARD && PHASES_COLOURED && sun_share > 0.0;
    if (is_peak_drawn || (is_medium && is_phase_coloured(by.phase_kind)))
        weigh_direction(drawn);
    return next;
}

// --- events -------------------------------------------------------------------------------------

// Continues along `direction`, or ends the path: at the highest order, or by roulette, which
// compares the light that is expected.
void prepare_next(vec3 direction, float expected, float u)
{
    path.next_direction = direction;
    bool goes_on = MULTIPLE || (ENVIRONMENT && path.events == 1);
    float survival = min(1.0, max_channel(path.throughput) * expected / path.roulette);
    if (!goes_on || u >= survival)
        path.throughput = vec3(0.0);
    else
        path.throughput /= survival;
}

bool is_sun_in_table() { return SUN_BY_TABLE && path.is_surface_first == 0; }

// Sunlight at an event before transmittance. Roulette compares with isotropic scattering.
void prepare_sunlight(vec3 per_sr, float u)
{
    const float LEAST = SUNWARD ? 1.0 : 1e-30; // turn() needs the transmittance
    path.sun_fraction = vec3(1.0);
    path.sun_roulette = path.sun_depth > 0.0 || is_sun_in_table()
                            ? 0.0
                            : SUN_ROULETTE / max(4.0 * PI * max_channel(per_sr), LEAST);
    play_sun_roulette(u);
    path.pending = path.throughput * sun_irradiance * (per_sr * path.sun_fraction);
    path.sun_roulette /= max(path.sun_fraction.r, 1.0);
    path.sun_fraction = vec3(1.0);
    bool is_looked_for = OPEN || (FIRST_BY_PATH && path.stage == STAGE_MEDIUM);
    if (path.events == 1 && !is_looked_for)
        path.pending = vec3(0.0);
}

// Adds an event's sunlight from the table, and makes the event the checked one with a probability
// in proportion to its light (a reservoir). Order 1 has only one event. Returns the transmittance.
float look_up_sunlight(float u)
{
    float guessed = guess_sun_transmittance(sun_lattice, path.origin_m, sun_direction);
    float brightest = max_channel(path.pending), most = brightest * guessed;
    add_light(path.pending * guessed);
    if (path.events == 1) {
        path.check.first_guessed = guessed;
        path.check.first_light = path.pending * guessed;
        return guessed;
    }
    path.check.light += path.pending * guessed;
    path.check.most += most;
    if (u * path.check.most < most) {
        path.check.point_m = path.origin_m;
        path.check.guessed = guessed;
        path.check.color = path.pending / brightest;
    }
    return guessed;
}

vec3 light_direction(bool is_lamp)
{
    return LAMPS && is_lamp ? path.lamp_direction : sun_direction;
}

bool sees_light(bool is_lamp)
{
    if (LAMPS && is_lamp)
        return sees_point(path.origin_m, path.lamp_direction, path.lamp_m, path.solid);
    return sees_sun(path.origin_m, path.solid);
}

// Whether no ray of this kernel samples the sunlight of the event: an earlier kernel has it, or a
// lamp was chosen in its place.
bool is_sun_unknown(bool is_lamp)
{
    bool is_known_earlier = !OPEN && !(FIRST_BY_PATH && path.stage == STAGE_MEDIUM);
    return is_lamp || (path.events == 1 && is_known_earlier);
}

// If SUNWARD: the end of an event, when the transmittance of its sunlight is known. The share of
// the directions that are drawn around the sun raises the weight of all others, so it is small deep
// in a cloud, where the next event has no sunlight either, and after many sunlit events. Any share
// that does not depend on the direction leaves the mean as it is.
void leave_event(float sunlit)
{
    bool is_medium = !SURFACES || path.solid == NO_SOLID;
    Medium by = only;
    if (MEDIA != 1 && is_medium)
        by = frame.media[path.medium];
    vec3 normal = is_medium ? vec3(0.0) : surface_at(path.solid, path.origin_m).normal;
    path.sunlit_sum += sunlit;
    float expected, share = sun_irradiance == vec3(0.0) ? 0.0 : sunlit / (1.0 + path.sunlit_sum);
    vec3 next = turn(path.next_direction, path.came_along, is_medium, by, normal, share, expected);
    prepare_next(next, expected, uniform_from(draw()).x);
}

// One event: emission, shadow ray, next direction. Not repeated here, unless OPEN, is light that
// earlier kernels have: at a first collision the emission (tracer_first.comp) and, unless
// FIRST_BY_PATH, order 1; at a first surface the direct sunlight (tracer_view.comp).
void process_event()
{
    uvec4 bits = draw4();
    vec3 u = uniform_from(bits.xyz), next, normal = vec3(0.0);
    vec3 light_per_sr; // phase function or cosine / pi for the light's direction
    Medium by = only;
    bool is_medium = !SURFACES || path.stage == STAGE_MEDIUM, is_lamp = false;
    if (SOBOL && path.events == 0)
        u.xy = uniform_from(first_bits(path.stage == STAGE_MEDIUM ? PAIR_SCATTERED
                                                                  : PAIR_REFLECTED).xyy).xy;
    path.events++;
    if (is_medium) {
        if (MEDIA != 1)
            by = frame.media[path.medium];
        path.solid = NO_SOLID;
        if (EMITS && (OPEN || path.events > 1))
            add_emitted(by.glow);
        path.throughput *= by.albedo;
        light_per_sr = phase_rgb_per_sr(by.phase_kind, by.g, path.direction, sun_direction);
        next = sample_phase(by.phase_kind, phase_channel_g(by.phase_kind, by.g, path.hero),
                            path.direction, u.xy);
    } else {
        Surface surface = surface_at(path.solid, path.origin_m);
        normal = surface.normal;
        path.is_surface_first |= uint(path.events == 1);
        path.throughput *= surface.albedo;
        light_per_sr = vec3(max(0.0, hit_cosine(path.solid, normal, sun_direction)) / PI);
        next = sample_cosine(normal, u.xy);
    }
    if (LAMPS && !is_medium)
        is_lamp = sample_surface_lamp(normal, light_per_sr);
    if (!is_lamp)
        prepare_sunlight(light_per_sr, uniform_from(bits.www).x);
    if (PHASES_COLOURED)
        path.pending *= channel_weights(path.channels);
    float expected = 1.0, sunlit = is_sun_unknown(is_lamp) ? UNKNOWN_SUNLIT : 0.0;
    if (SUNWARD) {
        path.came_along = path.direction;
        path.next_direction = next;
    } else {
        if (LAMPS && MULTIPLE)
            next = turn(next, path.direction, is_medium, by, normal, 0.0, expected);
        else if (is_medium && is_phase_coloured(by.phase_kind))
            weigh_direction(phase_rgb_per_sr(by.phase_kind, by.g, path.direction, next));
        if (!is_medium && is_through_own(path.solid, normal, next))
            path.throughput = vec3(0.0);
        prepare_next(next, expected, u.z);
    }
    draw_coverage(1u);
    bool is_lit = path.pending != vec3(0.0) && (!SOLIDS || sees_light(is_lamp));
    if (is_sun_in_table() && is_lit && !is_lamp) {
        sunlit = look_up_sunlight(uniform_from(bits.www).x);
        is_lit = false;
    }
    if (SUNWARD && !is_lit)
        leave_event(sunlit);
    path.ray = is_lit ? RAY_SUN : RAY_PATH;
    path.raised = is_lit ? majorant_factor(path.sun_depth) : 1.0;
    path.direction = is_lit ? light_direction(is_lamp) : path.next_direction;
    if (LAMPS) {
        path.reach_m = is_lamp ? path.lamp_m : FAR_M;
        path.is_looked_for = 0;
    }
    path.stage = STAGE_LEAVE;
}

// --- segments -----------------------------------------------------------------------------------

// One fog layer within [t0, t1]: exact transmittance for shadow rays, inverted free paths for
// paths.
void cross_layer(uint m, FogLayer layer, vec3 color, float t0_m, float t1_m)
{
    if (!is_path()) {
        path.sun_fraction *= colour_transmittance(
            color * fog_layer_optical_depth(layer, path.origin_m, path.direction, t0_m, t1_m));
        closed_forms++;
        return;
    }
    float depth = exponential_from(draw().x) / max(color[path.hero], 1e-20);
    float t_m = fog_layer_free_path_m(layer, path.origin_m, path.direction, t0_m, depth);
    if (t_m < min(t1_m, path.end_m)) {
        path.end_m = t_m;
        path.end_medium = m;
        path.end_solid = NO_SOLID;
    }
}

void cross_fog_medium(uint m, Medium medium)
{
    float t0_m = 0.0, t1_m = path.end_m;
    if (!clip_box(medium.low_m, medium.high_m, path.origin_m, path.direction, t0_m, t1_m))
        return;
    if (TURNED_MEDIA && !clip_turned_bounds(m, path.origin_m, path.direction, t0_m, t1_m))
        return;
    for (uint l = 0; l < LAYERS; l++)
        if (l < medium.layer_count)
            cross_layer(m, medium.layers[l], medium.extinction_color, t0_m, t1_m);
}

// Exact transmittances of fogs also scale the roulette threshold of a shadow ray, so roulette
// depends only on tracked media.
void cross_fog()
{
    float arriving = max_channel(path.sun_fraction);
    if (MEDIA == 1)
        cross_fog_medium(0, only);
    for (uint m = 0; MEDIA != 1 && m < media_count(); m++)
        if (is_fog(m))
            cross_fog_medium(m, frame.media[m]);
    if (!is_path() && arriving > 0.0)
        path.sun_roulette *= max_channel(path.sun_fraction) / arriving;
}

// Path densities per channel after fog: e^-((color - hero's color) depth), times the color where
// fog has scattered.
void weigh_fog_channels()
{
    for (uint m = 0; m < media_count(); m++) {
        if (!is_fog(m))
            continue;
        vec3 color = frame.media[m].extinction_color;
        float depth = medium_optical_depth(m, path.origin_m, path.direction, path.end_m);
        path.channels *= exp(clamp((color[path.hero] - color) * depth, EXPONENT_MIN, 30.0));
        if (path.end_medium == m)
            path.channels *= color / color[path.hero];
    }
}

void start_segment()
{
    bool is_short = path.ray == RAY_FIRST ||
                    (LAMPS && !is_path() && path.ray != RAY_VIEW);
    path.end_m = is_short ? path.reach_m : FAR_M;
    path.end_medium = MEDIA_MAX;
    path.end_solid = NO_SOLID;
    path.tracked = 0;
    path.skipped_m = 0.0;
    path.stage = TRACKED_COUNT > 0 ? STAGE_ENTER : STAGE_ARRIVE;
    if (is_path() && path.throughput == vec3(0.0)) {
        finish_path();
        return;
    }
    draw_coverage(0u);
    if (SOLIDS && (is_path() || path.ray == RAY_VIEW)) {
        Hit hit = nearest_hit(path.origin_m, path.direction, path.solid);
        path.end_m = hit.t_m;
        path.end_solid = hit.solid;
    }
    if (LAMPS && is_path() && is_lamp_light_pending() && send_to_place(path.end_m))
        path.end_m = path.reach_m;
    else if (GUESSED && LAMPS && is_path() && path.events == 0 && path.is_looked_for != 0) {
        start_for_guessed_collision();
        if (path.throughput == vec3(0.0)) {
            finish_path();
            return;
        }
        if (path.ray == RAY_FIRST) {
            path.end_m = path.reach_m;
            path.end_solid = NO_SOLID;
        }
    }
    if (HAS_FOG)
        cross_fog();
}

// End of the view ray. Behind the media is the sky, or a surface, which start_at_surface() adds
// later.
void arrive_behind()
{
    path.view_fraction = path.sun_fraction;
    if (path.end_solid == NO_SOLID)
        path.surface = path.view_fraction * background;
    path.next_direction = path.direction;
}

// End of the ray to a guessed first collision: the path continues there.
void arrive_at_first()
{
    path.throughput *= path.sun_fraction;
    path.roulette = ROULETTE * max_channel(path.throughput);
    path.origin_m += path.end_m * path.direction;
    path.ray = RAY_PATH;
    path.stage = path.roulette > 0.0 ? STAGE_MEDIUM : STAGE_BEHIND;
    collisions++;
    lookups++; // of the density at the place
}

// End of a shadow or view ray.
void arrive_with_fraction()
{
    bool is_view = OPEN && path.ray == RAY_VIEW;
    if (is_view)
        arrive_behind();
    else if (PHASES_COLOURED)
        add_weighted_light(path.pending * path.sun_fraction);
    else
        add_light(path.pending * path.sun_fraction);
    if (SUNWARD && !is_view)
        leave_event(LAMPS && path.reach_m < FAR_M ? UNKNOWN_SUNLIT
                                                  : min(max_channel(path.sun_fraction), 1.0));
    path.ray = RAY_PATH;
    path.raised = 1.0;
    path.direction = path.next_direction;
    path.stage = STAGE_LEAVE;
    if (GUESSED && is_view)
        start_for_guessed_collision();
}

void finish_segment()
{
    if (GUESSED && path.ray == RAY_FIRST) {
        arrive_at_first();
        return;
    }
    if (LAMPS && path.ray == RAY_PLACE) {
        arrive_at_place();
        return;
    }
    if (LAMPS && path.ray == RAY_LAMP) {
        arrive_from_lamp();
        return;
    }
    if (!is_path()) {
        arrive_with_fraction();
        return;
    }
    if (COLOURED && HAS_FOG)
        weigh_fog_channels();
    bool is_sky = path.end_medium == MEDIA_MAX && path.end_solid == NO_SOLID;
    bool is_first = OPEN && path.events == 0;
    if (is_sky && ENVIRONMENT && !is_first)
        add_light(path.throughput * background);
    path.origin_m += path.end_m * path.direction;
    bool is_collision = path.end_medium != MEDIA_MAX;
    collisions += uint(is_collision);
    path.medium = path.end_medium;
    path.solid = path.end_solid;
    path.stage = is_collision ? STAGE_MEDIUM : STAGE_SURFACE;
    // In single scattering there is only one event.
    bool may_happen = MULTIPLE && (is_collision || (SURFACES && !is_sky));
    if (is_first) // the view ray has handled the surface behind the media
        may_happen = is_collision;
    if (!may_happen)
        finish_path();
}

// --- tracking -----------------------------------------------------------------------------------

vec3 cells_start, cells_slope; // the ray in units of majorant cells

vec3 tracked_from_m() { return path.origin_m + path.skipped_m * path.direction; }

void place_cells()
{
    cells_start = (tracked_from_m() - tracked.low_m) * tracked_cells_per_m;
    cells_slope = path.direction * tracked_cells_per_m;
}

void next_tracked()
{
    path.tracked++;
    path.skipped_m = 0.0;
    path.stage = path.tracked < TRACKED_COUNT ? STAGE_ENTER : STAGE_ARRIVE;
}

void enter()
{
    float t0_m = 0.0, t1_m = path.end_m;
    bool is_met = clip_box(tracked.low_m, tracked.high_m, path.origin_m, path.direction, t0_m,
                           t1_m);
    float free_paths_per_m = tracked.extinction_per_m * max_channel(tracked.extinction_color);
    if (is_met && t0_m * free_paths_per_m > FAR_FREE_PATHS) {
        path.skipped_m = t0_m;
        place_cells();
        t0_m = -path.skipped_m; // the entry point is rounded and may lie in front of the box
        t1_m = path.end_m - path.skipped_m;
        is_met = clip_box(tracked.low_m, tracked.high_m, tracked_from_m(), path.direction, t0_m,
                          t1_m);
    }
    if (!is_met) {
        next_tracked();
        return;
    }
    path.t_m = t0_m;
    path.cell = ivec3(clamp(floor(cells_start + t0_m * cells_slope), vec3(0.0),
                            vec3(tracked.majorant_size) - 1.0));
    uint bits = draw().x;
    if (SOBOL && is_path() && path.events == 1 && path.tracked == 0 &&
        path.is_surface_first == 0)
        bits = first_bits(PAIR_FREE_PATH).x;
    path.depth_left = exponential_from(bits);
    path.stage = STAGE_TRACK;
}

// A tentative collision. For a path: real with the probability extinction / majorant (delta
// tracking, E. R. Woodcock et al. 1965). For a shadow ray: a factor 1 - extinction / majorant
// (ratio tracking, J. Novak et al. 2014).
void collide(float majorant_per_m)
{
    uvec4 bits = draw4();
    lookups++;
    path.depth_left = exponential_from(bits.x);
    float u = (float(bits.y >> 9) + 0.5) * exp2(-23.0);
    vec3 point_m = tracked_from_m() + path.t_m * path.direction;
    float extinction_per_m =
        tracked.extinction_per_m *
        shape_random_density(tracked.kind, tracked.shape, point_m, bits.zw);
    if (TURNED_MEDIA && !turned_bounds_contain(tracked_medium(), point_m))
        extinction_per_m = 0.0;
    vec3 chance =
        grey(min(tracked.extinction_color * (extinction_per_m / majorant_per_m), vec3(1.0)));
    if (!is_path()) {
        path.sun_fraction *= 1.0 - chance;
        play_sun_roulette(u);
        if (path.sun_fraction == vec3(0.0))
            next_tracked();
        return;
    }
    bool is_real = u < chance[path.hero];
    if (COLOURED)
        path.channels *= is_real ? chance / max(chance[path.hero], 1e-30)
                                 : (1.0 - chance) / (1.0 - chance[path.hero]);
    if (!is_real)
        return;
    path.end_m = path.skipped_m + path.t_m;
    path.end_medium = tracked_medium();
    path.end_solid = NO_SOLID;
    next_tracked();
}

// Advances to the face of a majorant cell, or to a tentative collision before it.
void track_step(vec3 per_slope, ivec3 side, bvec3 parallel)
{
    vec3 faces_m = mix((vec3(path.cell + side) - cells_start) * per_slope, vec3(FAR_M), parallel);
    float face_m = min(faces_m.x, min(faces_m.y, faces_m.z));
    float end_m = path.end_m - path.skipped_m;
    float exit_m = max(path.t_m, min(face_m, end_m));
    uvec3 cell = uvec3(path.cell), size = tracked.majorant_size;
    float majorant_per_m =
        path.raised * max_channel(tracked.extinction_color) *
        majorants[tracked.majorant_first + cell.x + size.x * (cell.y + size.y * cell.z)];
    float depth = majorant_per_m * (exit_m - path.t_m);
    if (path.depth_left < depth) {
        path.t_m = min(path.t_m + path.depth_left / majorant_per_m, exit_m);
        collide(majorant_per_m);
        return;
    }
    path.depth_left -= depth;
    path.t_m = exit_m;
    path.cell += mix(ivec3(0), 2 * side - 1, lessThanEqual(faces_m, vec3(face_m)));
    if (exit_m >= end_m ||
        !all(lessThan(uvec3(path.cell), size))) // -1 wraps to a large number
        next_tracked();
}

void track()
{
    bvec3 parallel = lessThan(abs(cells_slope), vec3(1e-20));
    vec3 per_slope = mix(1.0 / cells_slope, vec3(0.0), parallel);
    ivec3 side = ivec3(greaterThanEqual(cells_slope, vec3(0.0)));
    for (uint step = 0; step < STEPS && path.stage == STAGE_TRACK; step++)
        track_step(per_slope, side, parallel);
}

// --- main ---------------------------------------------------------------------------------------

void main()
{
    read_scene();
    uint thread = gl_GlobalInvocationID.x;
    uint turns = make_nonuniform(run.turns);
    if (make_nonuniform(run.is_fresh) != 0)
        path.stage = STAGE_IDLE;
    else
        path = states[thread];
    for (uint turn = 0; turn < turns && path.stage != STAGE_DONE && !has_walked_enough(); turn++) {
        if (path.stage == STAGE_BEHIND)
            start_at_surface();
        if (path.stage == STAGE_NONE)
            finish_item();
        if (path.stage == STAGE_IDLE)
            take_item();
        if (path.stage == STAGE_MEDIUM || path.stage == STAGE_SURFACE)
            process_event();
        if (path.stage == STAGE_LEAVE)
            start_segment();
        if (TRACKED_COUNT > 0) {
            if (TRACKED_COUNT > 1)
                read_tracked();
            place_cells();
            if (path.stage == STAGE_ENTER)
                enter();
            track();
        }
        if (path.stage == STAGE_ARRIVE)
            finish_segment();
    }
    check_loops();
    states[thread] = path;
    atomicAdd(progress.items_done, items_done);
    atomicAdd(progress.collisions, collisions);
    atomicAdd(progress.lookups, lookups);
    atomicAdd(progress.closed_forms, closed_forms);
}
