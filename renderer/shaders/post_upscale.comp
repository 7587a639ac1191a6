#version 450
// SPDX-License-Identifier: MIT
//
// Upscaling from the rendered size to the output size, with the filters of Unreal Engine 4.26 and
// AMD's EASU. Texel centres are at integers + 1/2, and lengths are in texels of the input.
//
//   nearest      the texel that contains the pixel's centre
//   bilinear     2x2 texels
//   directional  two samples along the edge, sharpened by a quarter of the difference to the mean
//                of four samples around
//   catmull_rom  4x4 texels without the corners, as in Unreal
//   lanczos      6x6 texels in 5x5 samples, without their corners: 13 samples
//   gaussian     6x6 texels, variance 1/2, minus their Laplacian (unsharp mask)
//   smoothstep   bilinear at positions that are moved towards texel centres
//   easu         edge-adaptive (AMD FSR 1, 2021): 12 texels, a Lanczos-like kernel stretched along
//                the edge, clamped to the range of the nearest four
//
// The Laplacian of `gaussian` does not sum to 0 over so few texels, so it changes a constant image
// by up to 0.25 % (softness 0.3). Samples between texels are bilinear in float32, because texture
// units have 8-bit weights. Filters with negative weights may overshoot; negative results are set
// to 0.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require

#include "post_sampling.glsl"

// The edge is perpendicular to the luma gradient. In flat areas the gradient is 0, and so is the
// offset.
vec3 directional(vec2 place)
{
    const float UNSHARP = 0.25, LEAST = 6e-8, REACH = 0.125;
    vec3 upper_left = bilinear(place + vec2(-0.5, -0.5));
    vec3 upper_right = bilinear(place + vec2(0.5, -0.5));
    vec3 lower_left = bilinear(place + vec2(-0.5, 0.5));
    vec3 lower_right = bilinear(place + vec2(0.5, 0.5));
    float rising = luma(lower_left) - luma(upper_right);
    float falling = luma(lower_right) - luma(upper_left);
    vec2 along = vec2(rising + falling, rising - falling);
    along *= REACH * inversesqrt(dot(along, along) + LEAST);
    vec3 mean = 0.25 * (upper_left + upper_right + lower_left + lower_right);
    vec3 edge = 0.5 * (bilinear(place - along) + bilinear(place + along));
    return edge + UNSHARP * (edge - mean);
}

// Weights of four texels in a row, for a place at `x` of the way from the second to the third.
vec4 catmull_rom_weights(float x)
{
    return vec4(x * (-0.5 + x * (1.0 - 0.5 * x)), 1.0 + x * x * (-2.5 + 1.5 * x),
                x * (0.5 + x * (2.0 - 1.5 * x)), x * x * (-0.5 + 0.5 * x));
}

vec3 catmull_rom(vec2 place)
{
    vec2 corner = floor(place - 0.5);
    vec2 way = place - 0.5 - corner;
    vec4 columns = catmull_rom_weights(way.x), rows = catmull_rom_weights(way.y);
    vec3 sum = vec3(0.0);
    float total = 0.0;
    [[unroll]] for (int i = 0; i < 16; i++) {
        bool is_corner = (i % 4 == 0 || i % 4 == 3) && (i / 4 == 0 || i / 4 == 3);
        float weight = is_corner ? 0.0 : columns[i % 4] * rows[i / 4];
        sum += weight * fetch(ivec2(corner) + ivec2(i % 4, i / 4) - 1);
        total += weight;
    }
    return sum / total;
}

// sinc(x) sinc(x / 3) without the constant factor 3 / pi^2. At 0 it is 0 / 0; the guard returns the
// limit.
float lanczos(float x)
{
    bool is_centre = choice(POST_LANCZOS_GUARD) != 0 && abs(x) < 1e-4;
    return is_centre ? PI * PI / 3.0 : sin(PI * x) * sin(PI / 3.0 * x) / (x * x);
}

// Weights of five samples along an axis. The third sample is a linear interpolation of two texels
// at `middle`.
//
//   texel   -2    -1     0     1     2     3
//   sample   0     1     [  2  ]     3     4
void lanczos_weights(float x, out float weights[5], out float middle)
{
    float second = lanczos(x), third = lanczos(x - 1.0);
    weights[0] = lanczos(x + 2.0);
    weights[1] = lanczos(x + 1.0);
    weights[2] = second + third;
    weights[3] = lanczos(x - 2.0);
    weights[4] = lanczos(x - 3.0);
    middle = third / weights[2];
}

vec3 lanczos_13(vec2 place)
{
    vec2 centre = floor(place - 0.5) + 0.5;
    float columns[5], rows[5], column, row;
    lanczos_weights(place.x - centre.x, columns, column);
    lanczos_weights(place.y - centre.y, rows, row);
    float xs[5] = float[5](-2.0, -1.0, column, 2.0, 3.0);
    float ys[5] = float[5](-2.0, -1.0, row, 2.0, 3.0);
    vec3 sum = vec3(0.0);
    float total = 0.0;
    [[unroll]] for (int i = 0; i < 25; i++) {
        if (abs(i % 5 - 2) + abs(i / 5 - 2) > 2)
            continue;
        float weight = columns[i % 5] * rows[i / 5];
        sum += weight * bilinear(centre + vec2(xs[i % 5], ys[i / 5]));
        total += weight;
    }
    return sum / total;
}

// Sharpening is proportional to the enlargement of the area.
vec3 gaussian(vec2 place)
{
    const float RADIUS_SQUARED = 9.0;
    vec2 centre = floor(place) + 0.5;
    vec3 sum = vec3(0.0), laplacian = vec3(0.0);
    float total = 0.0;
    [[unroll]] for (int i = 0; i < 36; i++) {
        vec2 offset = vec2(i % 6, i / 6) - 2.5;
        if (dot(offset, offset) > RADIUS_SQUARED)
            continue;
        vec2 texel = centre + offset;
        vec2 from = place - texel;
        float distance_squared = 2.0 * dot(from, from); // in units of the variance, 1/2
        vec3 weighted = exp(-0.5 * distance_squared) * bilinear(texel);
        sum += weighted;
        total += exp(-0.5 * distance_squared);
        laplacian += (distance_squared - 2.0) * weighted;
    }
    vec2 ratio = vec2(from_size()) / vec2(to_size());
    return (sum - setting(POST_UPSCALE_SOFTNESS) * (1.0 - ratio.x * ratio.y) * laplacian) / total;
}

// Bilinear at smoothstep(way), so texel centres attract.
vec3 smooth_steps(vec2 place)
{
    vec2 corner = floor(place - 0.5);
    vec2 way = place - 0.5 - corner;
    return bilinear(corner + way * way * (3.0 - 2.0 * way) + 0.5);
}

// --- EASU ----------------------------------------------------------------------------------------

// FSR 1's luma, times 2: green once, red and blue one half each.
float luma_2(vec3 c) { return 0.5 * c.b + 0.5 * c.r + c.g; }

// Adds the edge at a texel to the sums, with the weight `share`: the gradient, and the sharpness
// from the texel's and its four neighbours' luma. Per axis the sharpness is 1 where luma changes in
// one step and 0 where it has an extremum at the texel.
void add_edge(float share, float up, float left, float own, float right, float down,
              inout vec2 direction, inout float sharpness)
{
    vec2 slope = vec2(right - left, down - up);
    vec2 steepest = max(abs(vec2(right, down) - own), abs(own - vec2(left, up)));
    vec2 straight = clamp(abs(slope) / steepest, 0.0, 1.0);
    straight = mix(straight, vec2(0.0), equal(steepest, vec2(0.0))); // 0 / 0 in flat areas
    direction += share * slope;
    sharpness += share * dot(straight, straight);
}

vec3 easu(vec2 place)
{
    ivec2 corner = ivec2(floor(place - 0.5));
    vec2 way = place - 0.5 - vec2(corner);
    vec3 colours[16]; // 4x4 around the place, row by row; the corners are not used
    float lumas[16];
    [[unroll]] for (int i = 0; i < 16; i++) {
        colours[i] = fetch(corner + ivec2(i % 4, i / 4) - 1);
        lumas[i] = luma_2(colours[i]);
    }
    vec2 direction = vec2(0.0);
    float sharpness = 0.0;
    [[unroll]] for (int i = 0; i < 4; i++) {
        int at = 5 + (i & 1) + 4 * (i >> 1);
        vec2 side = mix(1.0 - way, way, equal(ivec2(i & 1, i >> 1), ivec2(1)));
        add_edge(side.x * side.y, lumas[at - 4], lumas[at - 1], lumas[at], lumas[at + 1],
                 lumas[at + 4], direction, sharpness);
    }
    // Bound for the squared gradient: in flat areas any direction will do.
    const float LEAST = 1.0 / 32768.0;
    float length_squared = dot(direction, direction);
    direction = length_squared < LEAST ? vec2(1.0, 0.0) : direction * inversesqrt(length_squared);
    sharpness = 0.25 * sharpness * sharpness;
    // Length of the unit square's extent in the edge's direction: 1 along an axis, sqrt(2)
    // diagonally.
    float stretch = dot(direction, direction) / max(abs(direction.x), abs(direction.y));
    vec2 scale = vec2(1.0 + (stretch - 1.0) * sharpness, 1.0 - 0.5 * sharpness);
    float lobe = 0.5 + (0.25 - 0.04 - 0.5) * sharpness, reach_squared = 1.0 / lobe;

    vec3 sum = vec3(0.0), least = colours[5], most = colours[5];
    float total = 0.0;
    [[unroll]] for (int i = 0; i < 16; i++) {
        bool is_corner = (i % 4 == 0 || i % 4 == 3) && (i / 4 == 0 || i / 4 == 3);
        bool is_near = !(i % 4 == 0 || i % 4 == 3 || i / 4 == 0 || i / 4 == 3);
        if (is_corner)
            continue;
        vec2 from = vec2(i % 4, i / 4) - 1.0 - way;
        vec2 turned = scale * vec2(dot(from, direction),
                                   from.y * direction.x - from.x * direction.y);
        float d = min(dot(turned, turned), reach_squared);
        // Lanczos 2 without sines: (25/16 (2/5 d - 1)^2 - 9/16) (lobe d - 1)^2
        float base = 0.4 * d - 1.0, window = lobe * d - 1.0;
        float weight = (25.0 / 16.0 * base * base - 9.0 / 16.0) * window * window;
        sum += weight * colours[i];
        total += weight;
        least = is_near ? min(least, colours[i]) : least;
        most = is_near ? max(most, colours[i]) : most;
    }
    return clamp(sum / total, least, most);
}

vec3 filtered(vec2 place)
{
    switch (int(view.upscale_filter)) {
    case POST_UPSCALE_NEAREST:
        return fetch(ivec2(floor(place)));
    case POST_UPSCALE_DIRECTIONAL:
        return directional(place);
    case POST_UPSCALE_CATMULL_ROM:
        return catmull_rom(place);
    case POST_UPSCALE_LANCZOS:
        return lanczos_13(place);
    case POST_UPSCALE_GAUSSIAN:
        return gaussian(place);
    case POST_UPSCALE_EASU:
        return easu(place);
    case POST_UPSCALE_SMOOTHSTEP:
        return smooth_steps(place);
    default:
        return bilinear(place);
    }
}

void main()
{
    ivec2 pixel;
    if (!get_thread_pixel(pixel))
        return;
    vec2 place = (vec2(pixel) + 0.5) * vec2(from_size()) / vec2(to_size());
    vec3 colour = filtered(place);
    put(pixel, mix(colour, vec3(0.0), lessThan(colour, vec3(0.0)))); // max() could hide a NaN
}
