#version 450
// SPDX-License-Identifier: MIT
//
// Screen-space ambient occlusion: the unoccluded fraction of the hemisphere above a surface, within
// a radius and weighted with the cosine. 1 where nothing is near. Output SCREEN_OPEN, by one of:
//
//   ssao    random points in the hemisphere; a point is hidden where the depth buffer is nearer
//           (M. Mittring, "Finding Next Gen", 2007; with normals as in D. Filion, R. McNaughton,
//           "Effects & Techniques", 2008)
//   unreal  pairs of steps in opposite directions; the squared steepest angle above the surface
//           (Unreal Engine 4.26, after the article on its post-processing)
//   gtao    horizons of slices through the line of sight, and the closed-form integral between them
//           (J. Jimenez et al., "Practical Real-Time Strategies for Accurate Indirect Occlusion",
//           2016)
//
// Occluders outside the image are missing. Objects are taken to extend backwards without end.
#extension GL_GOOGLE_include_directive : require

#include "screen.glsl"

struct Site {
    ivec2 pixel;
    vec3 point_m, normal, to_camera;
    float radius_m;
    vec2 noise;
};

// The visible point at an image position, or in the pixel that contains it (setting ao_places);
// false for the sky and outside the image.
bool seen_at(vec2 place_px, out vec3 point_m)
{
    ivec2 pixel = ivec2(floor(place_px));
    if (!is_inside(pixel))
        return false;
    point_m = surface_m(pixel);
    if (is_sky(point_m.z))
        return false;
    return choice(SCREEN_AO_PLACES) == SCREEN_PLACES_PIXEL || plane_at(place_px, pixel, point_m);
}

// Weight of an occluder by distance: 1, fading to 0 in the last fraction of the radius.
float near_weight(float distance_m, float radius_m)
{
    float fade_m = setting(SCREEN_AO_FALLOFF) * radius_m;
    if (distance_m >= radius_m)
        return 0.0;
    return fade_m > 0.0 ? min(1.0, (radius_m - distance_m) / fade_m) : 1.0;
}

// --- gtao -------------------------------------------------------------------------------------

// A slice: the plane through the line of sight and `across`. In the image it is a line through the
// pixel.
struct Slice {
    vec3 across;     // unit, perpendicular to the line of sight
    vec2 screen_way; // direction of the slice in the image, unit [px]
    float forward_px, back_px; // distances to which points within the radius can appear [px]
};

// Derivative of the image position when a point moves along a vector [px/m].
vec2 screen_change(vec3 point_m, vec3 move)
{
    vec2 change = is_orthographic()
                      ? move.xy
                      : (move.xy * point_m.z - point_m.xy * move.z) / (point_m.z * point_m.z);
    return 0.5 * vec2(1.0, -1.0) * change / half_size() * vec2(size_px());
}

// Distance from an image position to the image's edge in a direction [px].
float to_edge_px(vec2 from_px, vec2 way)
{
    vec2 edge = mix(vec2(0.0), vec2(size_px()), greaterThan(way, vec2(0.0)));
    vec2 t = (edge - from_px) / way;
    vec2 finite = mix(t, vec2(FAR_M), lessThan(abs(way), vec2(1e-6)));
    return max(0.0, min(finite.x, finite.y));
}

// Search distance of a slice. A point within the radius appears at most at the tangent from the
// camera to the ball around the site; `across` selects one of the tangents.
float reach_px(Site site, vec3 across, vec2 way)
{
    vec2 from_px = pixel_centre_px(site.pixel);
    float edge_px = to_edge_px(from_px, way);
    if (is_orthographic())
        return min(edge_px,
                   length(project_to_pixel(site.point_m + site.radius_m * across) - from_px));
    float sine = site.radius_m / length(site.point_m);
    if (sine >= 1.0)
        return edge_px;
    vec3 tangent = sine * across - sqrt(1.0 - sine * sine) * site.to_camera;
    const float LEAST = 1e-3; // lower bound for z of a tangent that meets the image plane
    return tangent.z > LEAST ? min(edge_px, length(project_to_pixel(tangent) - from_px)) : edge_px;
}

// Slice number `turn` in [0, 1) of half a rotation. Slices are distributed evenly about the line of
// sight, or about the camera's axis as in the paper; both agree at the image's centre.
Slice make_slice(Site site, float turn)
{
    Slice slice;
    if (choice(SCREEN_AO_SLICES) == SCREEN_SLICES_AXIS) {
        vec3 way = vec3(cos(PI * turn), sin(PI * turn), 0.0);
        slice.across = normalize(way - dot(way, site.to_camera) * site.to_camera);
    } else {
        vec3 first, second;
        basis_across(site.to_camera, first, second);
        slice.across = cos(PI * turn) * first + sin(PI * turn) * second;
    }
    slice.screen_way = normalize(screen_change(site.point_m, slice.across));
    slice.forward_px = reach_px(site, slice.across, slice.screen_way);
    slice.back_px = reach_px(site, -slice.across, -slice.screen_way);
    return slice;
}

// Horizon on one side: the largest cosine between the line of sight and a visible point. `lowest`
// is the cosine of the surface's own plane.
float horizon_cosine(Site site, vec2 way, float reach, float lowest)
{
    const float NEAREST_PX = 1.0;
    int steps = choice(SCREEN_AO_STEPS);
    float highest = lowest;
    for (int s = 0; s < steps && reach > NEAREST_PX; s++) {
        float share = pow((float(s) + site.noise.y) / float(steps), setting(SCREEN_AO_STEP_POWER));
        vec3 seen_m;
        if (!seen_at(pixel_centre_px(site.pixel) + mix(NEAREST_PX, reach, share) * way, seen_m))
            continue;
        vec3 offset_m = seen_m - site.point_m;
        float distance_m = length(offset_m);
        if (!(distance_m > 0.0))
            continue;
        float cosine = dot(offset_m, site.to_camera) / distance_m;
        float held = mix(lowest, cosine, near_weight(distance_m, site.radius_m));
        highest = held > highest ? held : mix(highest, held, setting(SCREEN_AO_THICKNESS));
    }
    return highest;
}

// Equation 7 of the paper: the cosine-weighted integral from the line of sight to a horizon.
float open_arc(float horizon, float tilt)
{
    return 0.25 * (cos(tilt) + 2.0 * horizon * sin(tilt) - cos(2.0 * horizon - tilt));
}

// The open part of a slice, and the whole of it without occluders.
//
//              to camera
//                  ^    . normal      tilt: angle between them in the slice
//       low  \     |   .
//             \    |  .   / high      horizons, limited to the hemisphere of the normal
//              \   | .   /
//               ---o-----
vec2 open_slice(Site site, Slice slice)
{
    vec3 axis = cross(slice.across, site.to_camera);
    vec3 in_slice = site.normal - dot(site.normal, axis) * axis;
    float share = length(in_slice);
    if (!(share > 1e-6))
        return vec2(0.0); // a slice along the surface has no cosine-weighted light
    float tilt = atan(dot(in_slice, slice.across), dot(in_slice, site.to_camera));
    float ahead = horizon_cosine(site, slice.screen_way, slice.forward_px, cos(tilt + 0.5 * PI));
    float behind = horizon_cosine(site, -slice.screen_way, slice.back_px, cos(tilt - 0.5 * PI));
    float high = min(acos(clamp(ahead, -1.0, 1.0)), tilt + 0.5 * PI);
    float low = max(-acos(clamp(behind, -1.0, 1.0)), tilt - 0.5 * PI);
    return share * vec2(open_arc(high, tilt) + open_arc(low, tilt), cos(tilt) + tilt * sin(tilt));
}

// The mean over slices converges to the integral only for many: surfaces at grazing angles need
// dozens, and with fewer a plane does not give 1. The ratio of the two sums gives 1 for any number.
float gtao(Site site)
{
    int slices = choice(SCREEN_AO_DIRECTIONS);
    vec2 sums = vec2(0.0);
    for (int i = 0; i < slices; i++)
        sums += open_slice(site, make_slice(site, (float(i) + site.noise.x) / float(slices)));
    bool is_ratio = choice(SCREEN_AO_SUM) == SCREEN_SUM_RATIO;
    return is_ratio ? sums.x / max(sums.y, 1e-6) : sums.x / float(slices);
}

// --- unreal -----------------------------------------------------------------------------------

// A sample beside the site: the cosine between normal and visible point, and its weight, which
// fades out at twice the radius. (Unreal's fade also depends on the depth and so on the distance of
// the camera; here lengths are in metres.)
bool sample_beside(Site site, vec2 place_px, out float cosine, out float weight)
{
    vec3 seen_m;
    cosine = 0.0;
    weight = 0.0;
    if (!seen_at(place_px, seen_m))
        return false;
    vec3 offset_m = seen_m - site.point_m;
    float distance_m = length(offset_m);
    weight = max(0.0, 1.0 - distance_m / (2.0 * site.radius_m));
    cosine = distance_m > 0.0 ? clamp(dot(offset_m, site.normal) / distance_m, 0.0, 1.0) : 0.0;
    return true;
}

float unreal_ao(Site site)
{
    const float LEAST = 1e-4, GOLDEN_ANGLE = 2.39996323;
    int pairs = choice(SCREEN_AO_DIRECTIONS), steps = choice(SCREEN_AO_STEPS);
    vec2 unit_px = is_orthographic() ? vec2(1.0) : vec2(1.0 / site.point_m.z);
    unit_px *= 0.5 * vec2(size_px()) / half_size() * site.radius_m;
    vec2 sums = vec2(LEAST);
    for (int i = 0; i < pairs; i++) {
        float angle = GOLDEN_ANGLE * float(i) + 2.0 * PI * site.noise.x;
        float far = sqrt((float(i) + 0.5) / float(pairs));
        vec2 offset_px = far * unit_px * vec2(cos(angle), sin(angle));
        vec3 most = vec3(0.0);
        for (int s = 1; s <= steps; s++) {
            vec2 way_px = float(s) / float(steps) * offset_px;
            vec2 cosines, weights;
            vec2 centre_px = pixel_centre_px(site.pixel);
            bool both = sample_beside(site, centre_px + way_px, cosines.x, weights.x);
            both = sample_beside(site, centre_px - way_px, cosines.y, weights.y) && both;
            most = mix(most, vec3(max(most.xy, cosines), 1.0), both ? weights.x * weights.y : 0.0);
        }
        vec2 open = (1.0 - most.xy) * (1.0 - most.xy);
        sums += vec2((open.x + open.y) * most.z, 2.0 * most.z);
    }
    return sums.x / sums.y;
}

// --- ssao -------------------------------------------------------------------------------------

// A point in the half ball of radius 1 about an axis, uniform by volume.
vec3 in_half_ball(vec3 axis, vec3 u)
{
    vec3 first, second;
    basis_across(axis, first, second);
    float height = u.x, side = sqrt(max(0.0, 1.0 - height * height)), angle = 2.0 * PI * u.y;
    vec3 direction = height * axis + side * (cos(angle) * first + sin(angle) * second);
    return pow(u.z, 1.0 / 3.0) * direction;
}

float ssao(Site site)
{
    const vec3 R3 = vec3(0.819172513, 0.671043607, 0.549700478); // R3 sequence (M. Roberts, 2018)
    int count = choice(SCREEN_AO_DIRECTIONS) * choice(SCREEN_AO_STEPS);
    float hidden = 0.0;
    for (int i = 0; i < count; i++) {
        vec3 u = fract(float(i + 1) * R3 + vec3(0.0, site.noise));
        vec3 point_m = site.point_m + site.radius_m * in_half_ball(site.normal, u);
        vec3 seen_m;
        if (!(point_m.z > 0.0) || !seen_at(project_to_pixel(point_m), seen_m))
            continue;
        bool is_before = seen_m.z < point_m.z * (1.0 - setting(SCREEN_AO_BIAS));
        bool is_near = site.point_m.z - seen_m.z < site.radius_m;
        hidden += is_before && is_near ? 1.0 : 0.0;
    }
    return 1.0 - hidden / float(count);
}

// ----------------------------------------------------------------------------------------------

float open_share(Site site)
{
    switch (choice(SCREEN_AO)) {
    case SCREEN_AO_SSAO:
        return ssao(site);
    case SCREEN_AO_UNREAL:
        return unreal_ao(site);
    default:
        return gtao(site);
    }
}

void main()
{
    ivec2 cell;
    if (!get_thread_cell(cell))
        return;
    ivec2 pixel = pixel_in(cell);
    float depth_m = depth_at_m(pixel), open = 1.0;
    if (!is_sky(depth_m)) {
        vec3 point_m = place_m(pixel_centre_px(pixel), depth_m);
        vec2 noise = choice(SCREEN_AO_NOISE) != 0 ? tiled_noise(cell) : vec2(0.5);
        Site site = Site(pixel, point_m, normal_at(pixel), to_camera(point_m),
                         setting(SCREEN_AO_RADIUS_M), noise);
        open = clamp(open_share(site), 0.0, 1.0);
    }
    float shaped = pow(open, setting(SCREEN_AO_POWER));
    store(SCREEN_OPEN, cell, vec4(1.0 - setting(SCREEN_AO_INTENSITY) * (1.0 - shaped)));
}
