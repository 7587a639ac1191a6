#version 450
// SPDX-License-Identifier: MIT
//
// taa.comp for a GPU, equal up to float32 rounding. A work group computes a block of pixels:
//
//     +--------------------+    32x8 pixels; a thread computes 4, one below the other
//     |o o o o .. o o o o o|
//     |o +--------------+ o|    o  the samples of the block and of the pixels around it are fetched
//     |o |              | o|       once, into shared memory
//     |o +--------------+ o|
//     |o o o o .. o o o o o|
//     +--------------------+
//
// Sums of three samples side by side are used by the pixels above, beside and below: the filter's
// weights are products of one along x and one along y, and a variance is computed from the
// variances of its parts (T. Chan et al., "Updating Formulae and a Pairwise Algorithm for Computing
// Sample Variances", 1979). The history of a pixel is fetched before its frame is computed, of a
// static pixel while the pixel above is resolved.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require

#include "history_gpu.glsl"
#include "rounding_gpu.glsl"
#include "taa.glsl"

const ivec2 BLOCK = ivec2(RT_TAA_BLOCK_WIDTH, RT_TAA_BLOCK_HEIGHT);
const ivec2 AREA = BLOCK + 2; // with the pixels around
const int COLUMN_PX = BLOCK.x * BLOCK.y / GROUP_THREADS;

// --- samples in shared memory --------------------------------------------------------------------

// RGB: the colour, A: its HDR weight, which is above 0; 0 where it is invalid.
shared vec4 area[AREA.x * AREA.y];
ivec2 area_corner; // its first pixel

const int ROWS_AT_ONCE = GROUP_THREADS / BLOCK.x, AREA_TURNS = AREA.y / ROWS_AT_ONCE;

// A thread's pixels of the area: its column, and in a last turn one pixel at the sides.
ivec2 area_pixel(int thread, int turn)
{
    return turn < AREA_TURNS
               ? ivec2(1 + thread % BLOCK.x, thread / BLOCK.x + turn * ROWS_AT_ONCE)
               : ivec2((thread & 1) * (AREA.x - 1), min(thread >> 1, AREA.y - 1));
}

// Run by all threads of a group. All fetches are issued before the first is used.
void fetch_area(ivec2 first_pixel)
{
    area_corner = first_pixel - 1;
    int thread = int(gl_LocalInvocationID.x);
    vec3 colours[AREA_TURNS + 1];
    [[unroll]] for (int k = 0; k <= AREA_TURNS; k++)
        colours[k] = fetch_colour(area_corner + area_pixel(thread, k));
    [[unroll]] for (int k = 0; k <= AREA_TURNS; k++) {
        Sample from = sample_from(colours[k]);
        ivec2 at = area_pixel(thread, k);
        area[at.x + AREA.x * at.y] =
            from.is_valid ? vec4(from.colour, from.hdr_weight) : vec4(0.0);
    }
    barrier();
}

Sample sample_at(ivec2 pixel)
{
    ivec2 at = pixel - area_corner;
    vec4 from = area[at.x + AREA.x * at.y];
    return Sample(from.rgb, from.a, !is_guarded() || from.a > 0.0);
}

// --- rows of samples -----------------------------------------------------------------------------

// Three samples side by side. Invalid ones are 0 in every colour space.
struct Row {
    vec4 weighted; // RGB: their sum, weighted along x and for HDR, A: the sum of these weights
    vec3 mean;     // in clamp_space()
    vec3 scatter;  // sum of squared deviations from the mean
    float count;   // of valid samples
};

vec3 column_weights, row_weights; // their products are filter_weights

vec3 weights_along(float jitter)
{
    vec3 way = vec3(-1.0, 0.0, 1.0) + jitter;
    return exp(-SHARPNESS * way * way);
}

float invert_count(float count) { return count > 0.0 ? 1.0 / count : 0.0; }

bool needs_box; // of this thread's column
// Few static pixels have a box: its data in the rows would take registers from all threads.
const bool ROWS_HAVE_BOXES = !IS_VIEW_STATIC;

Row row_at(ivec2 pixel)
{
    Row row;
    row.weighted = vec4(0.0);
    vec3 colours[3], sum = vec3(0.0);
    float counts[3];
    row.count = 0.0;
    [[unroll]] for (int i = 0; i < 3; i++) {
        Sample from = sample_at(pixel + ivec2(i - 1, 0));
        counts[i] = from.is_valid ? 1.0 : 0.0;
        row.count += counts[i];
        row.weighted += column_weights[i] * from.hdr_weight * vec4(from.colour, 1.0);
        colours[i] = to_space(clamp_space(), from.colour);
        sum += colours[i];
    }
    row.mean = row.scatter = vec3(0.0);
    if (needs_box && ROWS_HAVE_BOXES) {
        row.mean = invert_count(row.count) * sum;
        [[unroll]] for (int i = 0; i < 3; i++)
            row.scatter += counts[i] * (colours[i] - row.mean) * (colours[i] - row.mean);
    }
    return row;
}

Box find_row_box(Row row, vec3 filtered)
{
    vec3 variance = invert_count(row.count) * row.scatter;
    Box box = variance_box(vec4(row.mean, 0.0), vec4(variance, 0.0), setting(RT_TAA_SIGMA));
    extend(box, vec4(to_space(clamp_space(), filtered), 0.0));
    return box;
}

Box merge_row_boxes(Row rows[3], vec3 filtered)
{
    Row all = Row(vec4(0.0), vec3(0.0), vec3(0.0), 0.0);
    [[unroll]] for (int i = 0; i < 3; i++) {
        all.mean += rows[i].count * rows[i].mean;
        all.count += rows[i].count;
    }
    all.mean *= invert_count(all.count);
    [[unroll]] for (int i = 0; i < 3; i++) {
        vec3 difference = rows[i].mean - all.mean;
        all.scatter += rows[i].scatter + rows[i].count * difference * difference;
    }
    return find_row_box(all, filtered);
}

// As loops over all nine samples, which need fewer registers than rows.
Box find_sample_box(ivec2 pixel, vec3 filtered)
{
    Row all = Row(vec4(0.0), vec3(0.0), vec3(0.0), 0.0);
    [[dont_unroll]] for (int i = 0; i < 9; i++) {
        Sample from = sample_at(pixel + get_neighbour_offset(i));
        all.mean += to_space(clamp_space(), from.colour);
        all.count += from.is_valid ? 1.0 : 0.0;
    }
    all.mean *= invert_count(all.count);
    [[dont_unroll]] for (int i = 0; i < 9; i++) {
        Sample from = sample_at(pixel + get_neighbour_offset(i));
        vec3 difference = to_space(clamp_space(), from.colour) - all.mean;
        all.scatter += from.is_valid ? difference * difference : vec3(0.0);
    }
    return find_row_box(all, filtered);
}

Neighbourhood load_neighbourhood(ivec2 pixel)
{
    Neighbourhood around;
    around.valid = 0u;
    [[unroll]] for (int i = 0; i < 9; i++)
        set_sample(around, i, sample_at(pixel + get_neighbour_offset(i)));
    return around;
}

Frame frame_from_rows(ivec2 pixel, Row rows[3])
{
    Frame frame;
    Sample centre = sample_at(pixel); // better read again than kept in registers
    frame.centre = centre.colour;
    frame.is_centre_valid = centre.is_valid;
    vec4 sum = row_weights.x * rows[0].weighted + row_weights.y * rows[1].weighted +
               row_weights.z * rows[2].weighted;
    bool is_filtered = choice(RT_TAA_FILTER) != 0;
    frame.colour = is_filtered ? 1.0 / sum.a * sum.rgb : frame.centre;
    frame.is_valid = is_filtered ? rows[0].count + rows[1].count + rows[2].count > 0.0
                                 : frame.is_centre_valid;
    if (needs_box && ROWS_HAVE_BOXES)
        frame.box = merge_row_boxes(rows, frame.colour);
    else if (needs_box)
        frame.box = find_sample_box(pixel, frame.colour);
    return frame;
}

// --- down the column -----------------------------------------------------------------------------

// The other kinds of boxes are computed from all nine samples.
bool uses_rows() { return choice(RT_TAA_BOX) == RT_BOX_VARIANCE; }

// A static pixel whose light has not changed needs no box, either.
bool has_box()
{
    bool is_same = is_static && uses_gradient() && is_guarded() && light_change() == 0.0;
    return !is_unclamped && !is_same;
}

void main()
{
    ivec2 size = view_size(), block = find_block(size, BLOCK);
    int thread = int(gl_LocalInvocationID.x);
    ivec2 pixel = block + ivec2(thread % BLOCK.x, thread / BLOCK.x * COLUMN_PX);
    fetch_static_history(pixel);
    fetch_area(block);
    if (any(greaterThanEqual(pixel, size)))
        return;
    find_change(pixel / COLUMN_PX);
    needs_box = has_box();
    column_weights = weights_along(jitter_px.x);
    row_weights = weights_along(jitter_px.y);
    find_filter_weights();
    Row rows[3];
    if (uses_rows()) {
        rows[1] = row_at(pixel - ivec2(0, 1));
        rows[2] = row_at(pixel);
    }
    for (int end = min(pixel.y + COLUMN_PX, size.y); pixel.y < end; pixel.y++) {
        take_static_history(pixel + ivec2(0, 1));
        Past past = find_past(pixel, pixel);
        if (!is_static)
            fetch_texels(past.place_px);
        Frame frame;
        if (uses_rows()) {
            rows[0] = rows[1];
            rows[1] = rows[2];
            rows[2] = row_at(pixel + ivec2(0, 1));
            frame = frame_from_rows(pixel, rows);
        } else {
            frame = frame_from(load_neighbourhood(pixel), needs_box);
        }
        put_pixel(pixel, resolve(pixel, pixel, past, frame));
    }
}
