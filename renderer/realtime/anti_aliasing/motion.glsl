// SPDX-License-Identifier: MIT
//
// Motion vectors: the place in the frame before of the point that a pixel shows now. In a static
// scene with a static camera they are 0; otherwise the pixel follows the nearest solid around it,
// or the medium in front, which the wind moves.
#ifndef NEPH_REALTIME_MOTION_GLSL
#define NEPH_REALTIME_MOTION_GLSL

#include "renderer/realtime/gradient/change.glsl"
#include "renderer/realtime/tile_index/slots.glsl"

// --- the temporal gradient -----------------------------------------------------------------------

// The temporal gradient (gradient/) of this thread's tile of 4x4 pixels, for the media and for the
// scene behind them: `gain`, the light of this frame over the light of the frame before, and
// `residue`, the relative change that the gain does not explain. Computed once in main().
Change medium_change, behind_change;

bool keeps_age() { return is_set(RT_TAA_AGE_MAX); }

bool uses_gradient() { return choice(RT_GRADIENT) != 0 && keeps_age(); }

void find_change(ivec2 tile)
{
    if (!uses_gradient())
        return;
    medium_change = load_change(RT_CHANGE, tile);
    behind_change = load_change(RT_CHANGE_BEHIND, tile);
}

float largest_residue() { return max(medium_change.residue, behind_change.residue); }

const float LEAST_CHANGE_WIDTH = 1e-6; // of the ramp, which is divided by its width

// 0: same light as in the frame before, 1: different light. A ramp from taa_change to
// taa_change_full.
float light_change()
{
    float residue = largest_residue();
    if (!is_set(RT_TAA_CHANGE_FULL))
        return beyond(residue, setting(RT_TAA_CHANGE));
    float width = setting(RT_TAA_CHANGE_FULL) - setting(RT_TAA_CHANGE);
    return clamp((residue - setting(RT_TAA_CHANGE)) / max(width, LEAST_CHANGE_WIDTH), 0.0, 1.0);
}

bool follows_solids() { return choice(RT_SOLID_MOTION) != 0; }

// The motion of solids follows from their distance. The medium's distance is a mean along the ray:
// accurate enough for the wind, which moves the whole medium, but not for camera motion. In
// constant light the medium is not followed: a homogeneous haze looks the same under any wind, and
// the scene behind it keeps its history.
bool follows_medium()
{
    return choice(RT_TAA_MEDIUM) != 0 && !is_medium_static() &&
           (!uses_gradient() || light_change() > 0.0);
}

// Whether the history of each pixel is the pixel of the same place: camera, media and solids are
// where they were in the frame before. It is a specialization constant (IS_VIEW_STATIC), so that
// the kernel of a static frame has no code of find_before() but for its first lines.
bool is_static = IS_VIEW_STATIC && !follows_solids();

// --- places --------------------------------------------------------------------------------------

float dot_in_order(vec3 a, vec3 b)
{
    precise float sum = a.x * b.x + a.y * b.y + a.z * b.z;
    return sum;
}

// The point at eye depth 1 on the ray through a pixel's centre, without jitter.
vec3 ray_through(vec2 centre_px)
{
    precise float x = (2.0 * centre_px.x / float(picture_px.x) - 1.0) * view_now.half_width;
    precise float y = (1.0 - 2.0 * centre_px.y / float(picture_px.y)) * view_now.half_height;
    precise vec3 ray = view_now.forward + x * view_now.right + y * view_now.up;
    return ray;
}

// Projects a point into a camera's image, in pixels from the centre of the image.
vec2 project_from_middle(ViewCamera camera, vec3 point, float depth)
{
    float spread = view_spread(camera, depth);
    precise vec2 place_px;
    place_px.x = 0.5 * float(picture_px.x) *
                 (dot_in_order(point, camera.right) / (spread * camera.half_width));
    place_px.y = -0.5 * float(picture_px.y) *
                 (dot_in_order(point, camera.up) / (spread * camera.half_height));
    return place_px;
}

// Motion in pixels since the frame before of a point at eye depth `depth_m`. `from_m`: its motion
// relative to the camera of that frame. False when the point was behind that camera.
//
// Relative to the camera the point is at depth ray now, and was at depth ray - from_m, in the
// direction ray - from_m / depth. With the projections P of the two cameras
//
//     motion = P_now(ray) - P_before(ray - from_m / depth)
//
// Lengths are divided by the depth, so the sky needs no special case and loses no precision. The
// difference of two projections is exactly 0 for a static camera. In an orthographic frame all
// depths move alike, because its camera never turns (scenes/load_motion.c).
bool find_motion(vec3 ray, float depth_m, vec3 from_m, out vec2 motion_px)
{
    precise vec3 ray_before = ray - from_m / view_spread(view_now, depth_m);
    float depth_before = view_spread(view_before, dot_in_order(ray_before, view_before.forward));
    precise vec2 moved_px =
        project_from_middle(view_now, ray, dot_in_order(ray, view_now.forward)) -
        project_from_middle(view_before, ray_before, depth_before);
    motion_px = moved_px;
    return depth_before > 0.0;
}

// --- depth and motion of the surface -------------------------------------------------------------

const ivec2 CROSS_2PX[4] = {ivec2(-2, -2), ivec2(2, -2), ivec2(-2, 2), ivec2(2, 2)};
const ivec2 SQUARE_RING[8] = {ivec2(-1, -1), ivec2(0, -1), ivec2(1, -1), ivec2(-1, 0),
                              ivec2(1, 0),   ivec2(-1, 1), ivec2(0, 1),  ivec2(1, 1)};

// The nearest of the depths of the pixel p and of four or eight around it (x), so that the edge of
// an object moves with the object; and the object's own motion.
//
//     x . . . x
//     . . . . .                x x x
//     . . p . .     cross      x p x     square
//     . . . . .                x x x
//     x . . . x
//
// As in Unreal the motion is computed at the pixel's place with this depth, not at the neighbour's
// place.
float nearest_depth(ivec2 pixel, out vec3 moved_m)
{
    moved_m = vec3(0.0);
    ivec2 nearest = pixel;
    float nearest_m = fetch_full(RT_DEPTH, pixel).x;
    bool is_cross = choice(RT_TAA_MOTION) == RT_MOTION_CROSS;
    int others = is_cross ? 4 : choice(RT_TAA_MOTION) == RT_MOTION_SQUARE ? 8 : 0;
    for (int i = 0; i < others; i++) {
        ivec2 other = pixel + (is_cross ? CROSS_2PX[i] : SQUARE_RING[i]);
        float depth_m = fetch_full(RT_DEPTH, other).x;
        if (depth_m < nearest_m) {
            nearest_m = depth_m;
            nearest = other;
        }
    }
    if (follows_solids())
        moved_m = fetch_full(RT_MOVED, nearest).xyz;
    return nearest_m;
}

// Transmittance below which the motion of the medium is used: a moving solid must be almost hidden,
// a static one half hidden. The sky has no features that could smear.
const float HIDES_MOVER = 0.0625, HIDES_STATIC = 0.5, HIDES_SKY = 1.0;

// The motion of the medium, where it hides the scene behind it and is nearer than the solids
// around. One of the two motions is used, never a mean, which would drag solids along with the haze
// before them.
bool find_medium_motion(ivec2 pixel, vec3 ray, float scene_m, bool is_mover, out vec2 motion_px)
{
    float transmittance = fetch_full(RT_VOLUME, pixel).a;
    float distance_m = fetch_full(RT_VOLUME_DISTANCE, pixel).x;
    float hides = is_mover ? HIDES_MOVER : is_sky(scene_m) ? HIDES_SKY : HIDES_STATIC;
    bool is_seen = transmittance >= 0.0 && transmittance < hides && distance_m > 0.0 &&
                   distance_m < FAR_M;
    precise float depth_m = distance_m / sqrt(dot_in_order(ray, ray));
    precise vec3 from_m = view_before.position_m + wind_m();
    return is_seen && depth_m < scene_m && find_motion(ray, depth_m, from_m, motion_px);
}

// The place of a pixel in the frame before, in pixels, from the depths around its source; false
// when it was outside the frame.
bool find_before(ivec2 pixel, ivec2 source, out vec2 place_px, out float speed_px)
{
    precise vec2 centre_px = vec2(pixel) + 0.5;
    if (is_static) {
        place_px = centre_px;
        speed_px = 0.0;
        return true;
    }
    vec3 ray = ray_through(centre_px), moved_m = vec3(0.0);
    vec2 motion_px;
    // A camera that only turns moves all depths alike.
    bool needs_depth = view_before.position_m != vec3(0.0) || follows_solids();
    float scene_m = needs_depth || follows_medium() ? nearest_depth(source, moved_m) : FAR_M;
    precise vec3 from_m = view_before.position_m + moved_m;
    bool is_mover = moved_m != vec3(0.0);
    bool is_before = (follows_medium() &&
                      find_medium_motion(source, ray, scene_m, is_mover, motion_px)) ||
                     find_motion(ray, needs_depth ? scene_m : FAR_M, from_m, motion_px);
    precise vec2 before_px = centre_px - motion_px;
    place_px = before_px;
    speed_px = length(motion_px);
    return is_before && before_px.x > 0.0 && before_px.x < float(picture_px.x) &&
           before_px.y > 0.0 && before_px.y < float(picture_px.y);
}

#endif
