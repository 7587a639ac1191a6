// SPDX-License-Identifier: MIT
//
// The frame as the anti-aliasing takes it: the colours of 3x3 pixels, filtered about the unjittered
// centre of the pixel in the middle, and the box that its history is held in.
//
// A GPU takes as long for a pass over full resolution as that has instructions. There a work group
// makes a block of pixels, whose colours it fetches once, into shared memory. And the box of a
// variance goes row by row: the sums of a row serve the pixel above, that beside it and that below,
// because weights are products of one along x and one along y, and a variance is made of those of
// its parts. Else all goes colour by colour, which decides as the twin in C does.
#ifndef NEPH_REALTIME_FILM_GLSL
#define NEPH_REALTIME_FILM_GLSL

#extension GL_EXT_control_flow_attributes : require

#include "renderer/realtime/shared/pass.glsl"

bool guarded() { return choice(RT_TAA_GUARD) != 0; }

// 4 times the luma: what the HDR weights and the contrast law go by.
float luma_4(vec3 colour) { return colour.r + 2.0 * colour.g + colour.b; }

// Comparisons, so that NaN stays NaN; between limits that have crossed nothing is held.
float hold(float value, float low, float high)
{
    return low > high ? value : value < low ? low : value > high ? high : value;
}

vec3 hold(vec3 value, vec3 low, vec3 high)
{
    return vec3(hold(value.r, low.r, high.r), hold(value.g, low.g, high.g),
                hold(value.b, low.b, high.b));
}

// What is no number may become anything: behind a guard nobody looks at that.
vec3 guard(vec3 colour)
{
    if (!guarded())
        return colour;
    return ON_GPU ? clamp(colour, 0.0, HALF_MAX) : hold(colour, vec3(0.0), vec3(HALF_MAX));
}

bool is_finite(vec3 value)
{
    return is_finite(value.r) && is_finite(value.g) && is_finite(value.b);
}

// Bright samples count less, or a single one would shine through for many frames.
float hdr_weight(vec3 colour)
{
    return choice(RT_TAA_HDR_WEIGHT) != 0 ? 1.0 / (luma_4(colour) + 4.0) : 1.0;
}

// --- the space of the box ----------------------------------------------------------------------

vec3 to_space(vec3 colour)
{
    switch (choice(RT_TAA_SPACE)) {
    case RT_SPACE_YCOCG:
        return vec3(luma_4(colour), 2.0 * (colour.r - colour.b),
                    2.0 * colour.g - colour.r - colour.b);
    case RT_SPACE_REINHARD:
        return colour / (1.0 + abs(colour));
    default:
        return colour;
    }
}

vec3 from_space(vec3 value)
{
    switch (choice(RT_TAA_SPACE)) {
    case RT_SPACE_YCOCG:
        return 0.25 * vec3(value.x + value.y - value.z, value.x + value.z,
                           value.x - value.y - value.z);
    case RT_SPACE_REINHARD:
        return value / (1.0 - abs(value));
    default:
        return value;
    }
}

struct Box {
    vec3 low, high; // crossed when the box is of no colour
};

// What the colours around a pixel come to.
struct Film {
    vec3 colour; // filtered
    bool is_any; // whether there is one
    Box box;     // in taa_space
    vec3 own;    // the pixel's own colour
    bool has_own;
};

float box_scale = 1.0;

// Whether history is held in the box. There is none for what is at rest in the same light: on a
// GPU, elsewhere where that is known before (is_steady()), or it would be made anyhow.
bool is_held = true;

// M. Salvi, "An Excursion in Temporal Supersampling", GDC 2016; the filtered colour is in it.
Box box_about(vec3 mean, vec3 variance, vec3 filtered)
{
    vec3 reach = box_scale * setting(RT_TAA_SIGMA) * sqrt(variance);
    vec3 low = mean - reach, high = mean + reach;
    if (ON_GPU && guarded()) // all are numbers, where there is a colour
        return Box(min(low, filtered), max(high, filtered));
    return Box(mix(low, filtered, lessThan(filtered, low)),
               mix(high, filtered, greaterThan(filtered, high)));
}

// --- the colours ---------------------------------------------------------------------------------

struct Sample {
    vec3 colour;
    float hdr_weight;
    bool is_counted;
};

// As the camera exposes it. Where there is no pass for it the volume is laid over what is behind it
// here (realtime/composition/compose.comp).
vec3 composed(ivec2 pixel)
{
    if (choice(RT_COMPOSITION) != RT_COMPOSITION_TAA)
        return exposure * fetch_full(RT_COLOR, pixel).rgb;
    return exposure * over(fetch_full(RT_VOLUME, pixel), fetch_full(RT_BEHIND, pixel).rgb);
}

Sample sample_of(vec3 colour)
{
    bool is_counted = !guarded() || is_finite(colour);
    colour = guard(colour);
    return Sample(colour, hdr_weight(colour), is_counted);
}

const ivec2 BLOCK = ivec2(RT_TAA_BLOCK_WIDTH, RT_TAA_BLOCK_HEIGHT);
const ivec2 AREA = BLOCK + 2; // with the pixels around

// RGB: the colour, A: its HDR weight, which is above 0; 0 where it does not count.
shared vec4 area[AREA.x * AREA.y];
ivec2 area_corner; // its first pixel

const int ROWS_AT_ONCE = GROUP_THREADS / BLOCK.x, AREA_TURNS = AREA.y / ROWS_AT_ONCE;

// A thread's pixels of the area: those of its column, and in a last turn one at the sides.
ivec2 area_pixel(int thread, int turn)
{
    return turn < AREA_TURNS
               ? ivec2(1 + thread % BLOCK.x, thread / BLOCK.x + turn * ROWS_AT_ONCE)
               : ivec2((thread & 1) * (AREA.x - 1), min(thread >> 1, AREA.y - 1));
}

// By all threads of a group.
void fetch_area(ivec2 first_pixel)
{
    area_corner = first_pixel - 1;
    int thread = int(gl_LocalInvocationID.x);
    vec3 colours[AREA_TURNS + 1]; // all on their way before the first is looked at
    [[unroll]] for (int k = 0; k <= AREA_TURNS; k++)
        colours[k] = composed(area_corner + area_pixel(thread, k));
    [[unroll]] for (int k = 0; k <= AREA_TURNS; k++) {
        Sample seen = sample_of(colours[k]);
        ivec2 at = area_pixel(thread, k);
        area[at.x + AREA.x * at.y] =
            seen.is_counted ? vec4(seen.colour, seen.hdr_weight) : vec4(0.0);
    }
    barrier();
}

Sample sample_at(ivec2 pixel)
{
    if (!ON_GPU)
        return sample_of(composed(pixel));
    ivec2 at = pixel - area_corner;
    vec4 seen = area[at.x + AREA.x * at.y];
    return Sample(seen.rgb, seen.a, !guarded() || seen.a > 0.0);
}

// --- colour by colour --------------------------------------------------------------------------

// The 3x3 colours around a pixel, row by row.
struct Surroundings {
    vec3 colours[9];
    float hdr_weights[9];
    uint counted; // bit i: colours[i] counts
};

const int CENTRE = 4;
const uint SQUARE = 0x1ffu, PLUS = 0x0bau;

ivec2 offset_of(int i) { return ivec2(i % 3, i / 3) - 1; }

bool is_counted(uint counted, int i) { return (counted >> i & 1u) != 0u; }

// From the pixel's centre to where the source's ray went, in rendered pixels. The source is the
// rendered pixel in the middle of those that the pixel is made of: itself at 100 %.
vec2 shift_px = jitter_px;

// To where the ray of a neighbour of the source went, squared.
float distance_squared(int i)
{
    precise float x = float(offset_of(i).x) + shift_px.x;
    precise float y = float(offset_of(i).y) + shift_px.y;
    precise float sum = x * x + y * y;
    return sum;
}

void take(Sample seen, int i, inout Surroundings around)
{
    if (seen.is_counted)
        around.counted |= 1u << i;
    around.colours[i] = seen.is_counted ? seen.colour : vec3(0.0);
    around.hdr_weights[i] = seen.is_counted ? seen.hdr_weight : 0.0;
}

// A pixel whose source is no pixel of a block.
Surroundings look_around(ivec2 source)
{
    Surroundings around;
    around.counted = 0u;
    for (int i = 0; i < 9; i++)
        take(sample_of(composed(source + offset_of(i))), i, around);
    return around;
}

// One row down: two of three rows are known.
void look_down(ivec2 pixel, inout Surroundings around)
{
    around.counted >>= 3;
    for (int i = 0; i < 6; i++) {
        around.colours[i] = around.colours[i + 3];
        around.hdr_weights[i] = around.hdr_weights[i + 3];
    }
    for (int i = 6; i < 9; i++)
        take(sample_at(pixel + offset_of(i)), i, around);
}

float nearness[9]; // of the rays to the pixel's centre

const float SHARPNESS = 2.29;

// A Gaussian about the unjittered centre, the same in all pixels: Unreal's exp(-2.29 d^2), 0.47 px,
// a fit to the Blackman-Harris window of 3.3 px. (Its r.TemporalAACatmullRom, off by default, is
// another filter here, not of the history.)
void find_nearness()
{
    for (int i = 0; i < 9; i++)
        nearness[i] = exp(-SHARPNESS * distance_squared(i));
}

// False when no colour counts.
bool filter_frame(Surroundings around, out vec3 colour)
{
    colour = around.colours[CENTRE];
    if (choice(RT_TAA_FILTER) == 0)
        return is_counted(around.counted, CENTRE);
    vec3 sum = vec3(0.0);
    float weights = 0.0;
    for (int i = 0; i < 9; i++) { // those that do not count have no weight
        float weight = nearness[i] * around.hdr_weights[i];
        sum += weight * around.colours[i];
        weights += weight;
    }
    colour = sum / weights;
    return around.counted != 0u;
}

Box extremes(Surroundings around, uint among)
{
    Box box = Box(vec3(3e38), vec3(-3e38));
    for (int i = 0; i < 9; i++) {
        if (!is_counted(around.counted & among, i))
            continue;
        for (int c = 0; c < 3; c++) {
            if (around.colours[i][c] < box.low[c])
                box.low[c] = around.colours[i][c];
            if (around.colours[i][c] > box.high[c])
                box.high[c] = around.colours[i][c];
        }
    }
    return box;
}

// Halfway between the extremes of 5 colours, the plus, and of 9, the square: rounder than the
// square.
Box rounded_box(Surroundings around)
{
    Box square = extremes(around, SQUARE), plus = extremes(around, PLUS);
    if ((around.counted & PLUS) == 0u)
        return square;
    return Box(0.5 * (square.low + plus.low), 0.5 * (square.high + plus.high));
}

Box variance_box(Surroundings around, vec3 filtered)
{
    vec3 mean = vec3(0.0), variance = vec3(0.0);
    float count = float(bitCount(around.counted));
    for (int i = 0; i < 9; i++)
        if (is_counted(around.counted, i))
            mean += around.colours[i] / count;
    for (int i = 0; i < 9; i++)
        if (is_counted(around.counted, i))
            variance += (around.colours[i] - mean) * (around.colours[i] - mean) / count;
    return box_about(mean, variance, filtered);
}

float box_reach_squared = 2.2801; // 1.51 px

// Extremes of the rays that went through within a distance.
Box distance_box(Surroundings around)
{
    uint near = 0u;
    for (int i = 0; i < 9; i++)
        if (distance_squared(i) < box_reach_squared)
            near |= 1u << i;
    return extremes(around, near);
}

Box box_of(Surroundings around, vec3 filtered)
{
    for (int i = 0; i < 9; i++)
        around.colours[i] = to_space(around.colours[i]);
    switch (choice(RT_TAA_BOX)) {
    case RT_BOX_MIN_MAX:
        return rounded_box(around);
    case RT_BOX_VARIANCE:
        return variance_box(around, to_space(filtered));
    default:
        return distance_box(around);
    }
}

Film film_of(Surroundings around)
{
    Film film;
    film.own = around.colours[CENTRE];
    film.has_own = is_counted(around.counted, CENTRE);
    film.is_any = filter_frame(around, film.colour);
    if (is_held)
        film.box = box_of(around, film.colour);
    return film;
}

// --- row by row ----------------------------------------------------------------------------------

// Three colours side by side. Those that do not count are 0.
struct Row {
    vec4 weighted; // RGB: their sum by weights, A: that of the weights; of places along x alone
    vec3 mean;     // in taa_space
    vec3 scatter;  // squares of the distances from it
    float count;   // of those that count
};

vec3 near_columns, near_rows; // their product is nearness

vec3 nearness_along(float jitter)
{
    vec3 way = vec3(-1.0, 0.0, 1.0) + jitter;
    return exp(-SHARPNESS * way * way);
}

float part_of_one(float count) { return count > 0.0 ? 1.0 / count : 0.0; }

// Where all rests hardly a pixel has a box. What rows had for it would take registers from all.
bool rows_have_boxes() { return !ALL_REST; }

Row row_at(ivec2 pixel)
{
    Row row;
    row.weighted = vec4(0.0);
    vec3 seen[3], sum = vec3(0.0);
    float counts[3];
    row.count = 0.0;
    [[unroll]] for (int i = 0; i < 3; i++) {
        Sample from = sample_at(pixel + ivec2(i - 1, 0));
        counts[i] = from.is_counted ? 1.0 : 0.0;
        row.count += counts[i];
        row.weighted += near_columns[i] * from.hdr_weight * vec4(from.colour, 1.0);
        seen[i] = to_space(from.colour);
        sum += seen[i];
    }
    row.mean = row.scatter = vec3(0.0);
    if (is_held && rows_have_boxes()) {
        row.mean = part_of_one(row.count) * sum;
        [[unroll]] for (int i = 0; i < 3; i++)
            row.scatter += counts[i] * (seen[i] - row.mean) * (seen[i] - row.mean);
    }
    return row;
}

// T. Chan et al., "Updating Formulae and a Pairwise Algorithm for Computing Sample Variances",
// 1979: nothing cancels.
Box variance_box(Row rows[3], vec3 filtered)
{
    vec3 sum = vec3(0.0), scatter = vec3(0.0);
    float count = 0.0;
    [[unroll]] for (int i = 0; i < 3; i++) {
        sum += rows[i].count * rows[i].mean;
        count += rows[i].count;
    }
    float part = part_of_one(count);
    vec3 mean = part * sum;
    [[unroll]] for (int i = 0; i < 3; i++)
        scatter += rows[i].scatter +
                   rows[i].count * (rows[i].mean - mean) * (rows[i].mean - mean);
    return box_about(mean, part * scatter, filtered);
}

// That of all three at once, colour by colour.
Box variance_box(ivec2 pixel, vec3 filtered)
{
    vec3 sum = vec3(0.0), scatter = vec3(0.0);
    float count = 0.0;
    [[dont_unroll]] for (int i = 0; i < 9; i++) {
        Sample from = sample_at(pixel + offset_of(i));
        sum += to_space(from.colour);
        count += from.is_counted ? 1.0 : 0.0;
    }
    float part = part_of_one(count);
    vec3 mean = part * sum;
    [[dont_unroll]] for (int i = 0; i < 9; i++) {
        Sample from = sample_at(pixel + offset_of(i));
        vec3 difference = to_space(from.colour) - mean;
        scatter += from.is_counted ? difference * difference : vec3(0.0);
    }
    return box_about(mean, part * scatter, filtered);
}

Film film_of(ivec2 pixel, Row rows[3])
{
    Film film;
    Sample own = sample_at(pixel); // better read again than kept in registers
    film.own = own.colour;
    film.has_own = own.is_counted;
    vec4 sum = near_rows.x * rows[0].weighted + near_rows.y * rows[1].weighted +
               near_rows.z * rows[2].weighted;
    bool is_filtered = choice(RT_TAA_FILTER) != 0;
    film.colour = is_filtered ? 1.0 / sum.a * sum.rgb : film.own;
    film.is_any = is_filtered ? rows[0].count + rows[1].count + rows[2].count > 0.0 : film.has_own;
    if (is_held)
        film.box = rows_have_boxes() ? variance_box(rows, to_space(film.colour))
                                     : variance_box(pixel, to_space(film.colour));
    return film;
}

// --- both ----------------------------------------------------------------------------------------

bool goes_by_rows() { return ON_GPU && choice(RT_TAA_BOX) == RT_BOX_VARIANCE; }

// What a thread knows of the pixels around, on its way down.
struct Window {
    Surroundings around;
    Row rows[3];
};

// One row down: two of three rows are known.
void look_down(ivec2 pixel, inout Window window)
{
    if (!goes_by_rows()) {
        look_down(pixel, window.around);
        return;
    }
    window.rows[0] = window.rows[1];
    window.rows[1] = window.rows[2];
    window.rows[2] = row_at(pixel + ivec2(0, 1));
}

Window look_above(ivec2 pixel)
{
    Window window;
    if (goes_by_rows()) {
        near_columns = nearness_along(jitter_px.x);
        near_rows = nearness_along(jitter_px.y);
    } else {
        window.around.counted = 0u;
        find_nearness();
    }
    look_down(pixel - ivec2(0, 2), window);
    look_down(pixel - ivec2(0, 1), window);
    return window;
}

Film film_in(ivec2 pixel, Window window)
{
    if (goes_by_rows())
        return film_of(pixel, window.rows);
    return film_of(window.around);
}

#endif
