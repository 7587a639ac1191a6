#version 450
// SPDX-License-Identifier: MIT
//
// Temporal anti-aliasing as in Unreal Engine 4.26, after B. Karis, "High Quality Temporal
// Supersampling", SIGGRAPH 2014. Each frame's rays have another sub-pixel place; a pixel is a
// running mean of them all. The frame, filtered about the unjittered centre of the pixel, is
// blended into the history. That is read where the frame before showed the same thing, and held in
// the box of the colours around the pixel, so that what is no longer there cannot stay.
//
// Done differently:
// - Speed is in pixels. Unreal's is in halves of pixels (device coordinates are 2 wide), so its 40
//   are VELOCITY_PX, 20.
// - Catmull-Rom takes all 4x4 texels. Unreal leaves out the corners, whose weights sum to up to
//   1/64, and divides by the rest.
// - The variance is the mean square of deviations. Unreal's mean of squares less square of the mean
//   cancels: in float32 a flat colour has a deviation of up to 3e-4 of itself.
// - Filter and blend are linear anyway: only the box is taken in taa_space, and a history that it
//   does not move keeps its last bit.
// - Stochastic rounding picks one of the two neighbouring halves with the probability that is right
//   on average. Unreal adds up to one step and leaves the rest to the hardware's rounding.
// - taa_guard: a colour that is not finite does not count. The filter and the box are made of the
//   others of 3x3; where there are none the history stays; where that is void too the pixel is 0. A
//   history that is not finite is void. Colours are held to 0 .. 65504. Where the history is black
//   the contrast law is off: its 0 / 0 would be NaN for ever after.
// Unreal's, and off unless asked for: the responsive mask (taa_responsive), whose stencil is here
// where media hide what is behind, and the ratio of exposures (taa_pre_exposure).
// Ours, and off in what follows Unreal: with taa_age_max a pixel that is at rest and in the same
// light, by the temporal gradient, is the mean of its frames; with taa_medium its history is looked
// up where the medium was.
// Left out: the anti-ghosting flag of movers, depth of field, and the unfiltered frame that is mixed in where a bilinear history
// blurs. Upsampling is rt_taau.comp.
#extension GL_GOOGLE_include_directive : require

#include "taa.glsl"

// A thread goes down a column of pixels, tile by tile: on a GPU a tile alone, its share of the
// block; lavapipe, which has threads enough, reads the rows between two tiles once.
const int TILE_PX = 4;
const int COLUMN_PX = ON_GPU ? BLOCK.x * BLOCK.y / GROUP_THREADS : RT_TAA_COLUMN;

// A GPU waits for a pixel's history while it makes the pixel above, where it knows its place.
bool fetches_ahead() { return ON_GPU && ALL_REST; }

vec4 next_history;

void fetch_next(ivec2 pixel)
{
    if (fetches_ahead())
        next_history = fetch_picture(RT_TAA_BEFORE, pixel);
}

// The first pixel of this thread's column; false when there is none left.
bool own_column(ivec2 size, out ivec2 pixel)
{
    if (ON_GPU) {
        ivec2 block = own_block(size, BLOCK);
        int thread = int(gl_LocalInvocationID.x);
        pixel = block + ivec2(thread % BLOCK.x, thread / BLOCK.x * COLUMN_PX);
        fetch_next(pixel);
        fetch_area(block);
        return all(lessThan(pixel, size));
    }
    bool is_left = own_element(ivec2(size.x, (size.y - 1) / COLUMN_PX + 1), pixel);
    pixel.y *= COLUMN_PX;
    return is_left;
}

void look_at_tile(ivec2 tile)
{
    if (asks_for_change())
        find_change(tile);
    is_at_rest = rests();
    is_held = !is_steady();
}

// A picture at rest whose history is fetched once, for its colour and its age.
void find_history(ivec2 pixel)
{
    is_ahead = fetches_ahead() || (!ON_GPU && ALL_REST);
    history_ahead = next_history;
    if (!ON_GPU && ALL_REST)
        history_ahead = fetch_picture(RT_TAA_BEFORE, pixel);
    fetch_next(pixel + ivec2(0, 1));
}

void resolve(ivec2 pixel, bool is_there, inout Window window)
{
    find_history(pixel);
    look_down(pixel, window);
    vec4 made = resolved(pixel, pixel, film_in(pixel, window));
    if (is_there)
        put_picture(RT_TAA_OUT, pixel, vec4(round_to_format(made.rgb, pixel), made.a));
}

// On lavapipe a loop carries all that a thread knows of the pixels around through memory. Where
// there is little else to do four turns are written out.
bool unrolls() { return !ON_GPU && ALL_REST && is_unchanged(); }

void main()
{
    ivec2 pixel, size = view_size();
    if (!own_column(size, pixel))
        return;
    int end = min(pixel.y + COLUMN_PX, size.y);
    if (ON_GPU)
        look_at_tile(pixel / TILE_PX);
    Window window = look_above(pixel);
    do {
        if (!ON_GPU)
            look_at_tile(pixel / TILE_PX);
        int last = min(pixel.y + TILE_PX, end);
        if (unrolls()) {
            [[unroll]] for (int k = 0; k < TILE_PX; k++) {
                resolve(pixel, pixel.y < last, window);
                pixel.y++;
            }
        } else {
            for (; pixel.y < last; pixel.y++)
                resolve(pixel, true, window);
        }
    } while (!ON_GPU && pixel.y < end);
}
