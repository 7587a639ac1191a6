/* SPDX-License-Identifier: MIT
 *
 * Participating media in double precision: extinction at a point, exact optical depth along a
 * segment, phase functions. Closed forms: notes of each function. Never NaN, never negative.
 */
#ifndef NEPH_SCENES_MEDIA_H
#define NEPH_SCENES_MEDIA_H

#include "scenes/bounds.h"
#include "scenes/cuts.h"

#include <stdio.h>

/* (1 - e^-x)/x, 1 at x = 0, for any sign; no cancellation. The phi of all exponential integrals. */
double neph_phi(double x);

/* Optical depth of one fog layer from a point at height y_m along a direction with vertical
 * component k_y, over length_m (may be +inf). Evaluated at the denser end, so that neither
 * 0 * inf nor cancellation can arise. +inf where the integral diverges. */
double neph_fog_layer_optical_depth(const struct neph_fog_layer *layer, double y_m, double k_y,
                                    double length_m);

/* The inverse: distance from height y_m along k_y at which the layer reaches an optical depth > 0
 * [m]; +inf if it never does. */
double neph_fog_layer_distance_m(const struct neph_fog_layer *layer, double y_m, double k_y,
                                 double optical_depth);

const struct neph_medium_facts *neph_medium_facts(enum neph_medium_kind kind);

/* Two frequently used facts. */
bool neph_medium_is_fog(const struct neph_medium *medium);
bool neph_medium_has_closed_form(const struct neph_medium *medium);

/* Extinction [1/m] at a point; 0 outside the bounds. */
double neph_medium_extinction_per_m(const struct neph_medium *medium, struct neph_vec3 point_m);

/* An upper bound of the extinction [1/m] in the box, the majorant of tracking methods. Not always
 * the smallest. */
double neph_medium_extinction_bound_per_m(const struct neph_medium *medium,
                                          const struct neph_bounds *box);

/* Whether wind moves the medium: media with a place (blobs, plumes, voxels) move with their bounds,
 * the textures of Horizon layers move within theirs. Other media are uniform along the wind. */
bool neph_medium_drifts(const struct neph_medium *medium);

/* Moves the medium with the wind; no effect on media that do not drift. Writes to its grid or
 * horizon. */
void neph_medium_drift(struct neph_medium *medium, struct neph_vec3 by_m);

/* Translates the medium with its bounds; not possible for Horizon layers, whose planet is fixed
 * below the world's origin. Writes to its grid or horizon. */
bool neph_medium_can_shift(const struct neph_medium *medium);
void neph_medium_shift(struct neph_medium *medium, struct neph_vec3 by_m);

/* Frees the memory that the medium owns. */
void neph_medium_finish(struct neph_medium *medium);

/* Makes the medium use `room` in place of owned memory, so that this copy can drift independently;
 * voxels and textures are borrowed. */
size_t neph_medium_storage_bytes(const struct neph_medium *medium);
void neph_medium_borrow(struct neph_medium *medium, void *room);

/* Splits a ray at the scale of the density, on the ray itself and in the shadow that the medium
 * casts on it; and at the kinks of the density, of which there may be more than fit. */
void neph_medium_cut_scales(struct neph_cuts *cuts, const struct neph_medium *medium);
void neph_medium_cut_kinks(struct neph_cuts *cuts, const struct neph_medium *medium);

/* Whether its extinction differs between the channels. */
bool neph_medium_is_coloured(const struct neph_medium *medium);

/* A grid that repeats endlessly, without bounds within half of the world on an endless axis. */
bool neph_medium_is_endless(const struct neph_medium *medium);
bool neph_scene_is_endless(const struct neph_scene *scene); /* some medium of it is */
extern const char neph_endless_reason[]; /* reason for other engines to refuse it */

/* Whether grids of the scene have constant cells, and whether others are trilinear beside them. */
bool neph_scene_has_constant_cells(const struct neph_scene *scene);
bool neph_scene_mixes_cells(const struct neph_scene *scene);

/* The finite box that contains the medium: its bounds, narrowed to the support of its density
 * (grids) or to the region where extinction is at least 1e-12 of its largest (Gaussian). Sides stay
 * infinite where there is no such end (height fog, homogeneous, shell). Minimum = maximum on an
 * axis where the bounds exclude the medium. */
struct neph_bounds neph_medium_support(const struct neph_medium *medium);

/* Optical depth [1] (of extinction_color 1) of a medium along origin + t direction, t in [t0_m,
 * t1_m] (t1 may be +inf). `direction` is unit. The segment is clipped to the bounds.
 *
 * A closed form or a finite sum of exact pieces for all kinds but HORIZON, where it is quadrature
 * with an error below 1e-10 of a unit of density, and slow. A shell's pieces are Gauss rules that
 * are exact to rounding: within 1e-12 of 40-digit references, plus R / H times the rounding of long
 * double, plus, in metres at the ground, the rounding of the place where a grazing ray meets it (a
 * few R^2 / d times that, d from there to its lowest point). */
double neph_medium_optical_depth(const struct neph_medium *medium, struct neph_vec3 origin_m,
                                 struct neph_vec3 direction, double t0_m, double t1_m);

/* The sum over all media of a scene, per channel, each multiplied by its extinction_color. */
struct neph_rgb neph_scene_optical_depth(const struct neph_scene *scene, struct neph_vec3 origin_m,
                                         struct neph_vec3 direction, double t0_m, double t1_m);

/* Unreal Engine's ExponentialHeightFog (UI values; height in metres) <-> natural exponent.
 *   sigma_t = a e^{-b (y-h)},  a = (ln 2)^2 density_ui / 10,  b = ln 2 falloff_ui / 10  [1/m].
 * Source: HeightFogCommon.ush and FogRendering.cpp: the shader's missing 1/ln 2 in the line
 * integral and its base-2 transmittance give the two factors. */
struct neph_unreal_fog {
    double fog_density;        /* UI value, default 0.02 */
    double fog_height_falloff; /* UI value, default 0.2 */
    double fog_height_m;
};
struct neph_fog_layer neph_fog_layer_from_unreal(const struct neph_unreal_fog *unreal);
struct neph_unreal_fog neph_fog_layer_to_unreal(const struct neph_fog_layer *layer);

/* A finite box in place of the bounds of `medium`, for an engine without unbounded media, chosen
 * for the cameras of all frames. `*cut_error` is the absolute error in transmittance that the box
 * causes, at most 1:
 * - finite and small bounds, which are the box, and grids, whose box is their support: 0.
 * - Fog: the largest error found over slopes and heights of view rays, times 1.1. Level rays
 *   through thin fog may need more than the 1000 km that the box may reach; the error is then near
 *   1.
 * - Gaussian, shell: no line from anywhere loses more; below 1e-8 for a shell's whole planet. */
struct neph_bounds neph_medium_container(const struct neph_scene *scene,
                                         const struct neph_medium *medium, double *cut_error);

#endif
