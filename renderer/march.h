/* SPDX-License-Identifier: MIT
 *
 * The ray marcher at full resolution: fixed steps, one ray through the centre of each pixel, no
 * anti-aliasing, single scattering from the sun. Real-time methods are compared with it to measure
 * their shortcut error; truth/transport.h is its own reference.
 *
 * Method: energy-conserving integration of each step, S (1 - e^(-sigma dt)) / sigma with S at the
 * middle of the step (S. Hillaire, "Physically Based and Unified Volumetric Rendering in
 * Frostbite", SIGGRAPH 2015 course, slide "improved integration"). Second order where the scene is
 * smooth, first order at edges of shadows and of overlapping media. Derived in shaders/march.comp.
 *
 * Steps are equal in distance over the relevant part of the ray: from the first to the last face of
 * any medium, before the first solid. In unbounded fog from the point before which the optical
 * depth is 1e-7 to the point after which it is 1e-7, or to a transmittance of e^-16. The omitted
 * parts change the transmittance by less than 1e-7 per fog layer.
 *
 * Precision: the relative error of an optical depth is about falloff * distance * 6e-8, from the
 * rounding of a float32 height at that distance from the camera.
 */
#ifndef NEPH_RENDERER_MARCH_H
#define NEPH_RENDERER_MARCH_H

#include "base/image.h"
#include "renderer/march_params.h"
#include "renderer/sky/sky_times.h"
#include "renderer/vulkan.h"
#include "scenes/scene.h"

#include <stddef.h>
#include <stdint.h>

struct neph_march_stats {
    double gpu_s;              /* device time of all dispatches; NaN without a clock */
    struct neph_sky_times sky; /* part of gpu_s for the tables of the sky; 0: none was filled */
    double wall_s; /* from call to return, with uploads, copies and the first compilation */
    /* Evaluations of the media's extinction, counted by the shader: steps of view rays inside a
     * medium, and of their marched sun rays. */
    uint64_t density_evaluations;
    /* Closed-form optical depths, counted by the shader: of whole rays, steps, sun rays. */
    uint64_t closed_forms;
    uint64_t view_steps; /* steps of view rays */
    uint64_t rays;       /* view rays */
    int dispatches;
};

/* Whether this lighting can render the scene. False, with the reason as text:
 *
 * - multiple scattering with `single`, single scattering with any other lighting,
 * - background light on media or solids,
 * - for the lighting of Horizon clouds: another kind of medium,
 * - a medium outside the float32 range (renderer/float32_range.h). */
bool neph_march_can_render(const struct neph_scene *scene, enum neph_march_lighting lighting,
                           char *reason, size_t reason_size);

/* Copy the scene without its veils to `rest`, which borrows everything that `scene` owns. False,
 * with the reason as text, when the scene has no such air (renderer/sky/split.h) or no such fog
 * (scenes/fog_translation.h). */
bool neph_march_remove_veils(const struct neph_scene *scene, struct neph_march_veils veils,
                             struct neph_scene *rest, char *reason, size_t reason_size);

/* As neph_march_can_render(), with the veils rendered from tables (struct neph_march_sky) or as a
 * fog model. False also when the scene has no such air or fog, or its surroundings are outside the
 * range of the tables. */
bool neph_march_can_render_with(const struct neph_scene *scene, struct neph_march_veils veils,
                                enum neph_march_lighting lighting, char *reason,
                                size_t reason_size);

/* All checks of neph_march_create() that need no device. NEPH_ERR_USAGE: a parameter is out of
 * range; NEPH_ERR_UNSUPPORTED: neph_march_can_render() is false. */
enum neph_status neph_march_check(const struct neph_scene *scene,
                                  const struct neph_march_params *params, struct neph_diag *diag);

/* The ray marcher for many frames of one scene; grids and textures stay on the device. */
struct neph_march;

/* Free with neph_march_destroy(). */
enum neph_status neph_march_create(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                   const struct neph_march_params *params,
                                   struct neph_march **march, struct neph_diag *diag);
void neph_march_destroy(struct neph_march *march);

/* Render one frame of the scene, which may have another sun, and media and solids that have moved
 * (neph_scene_at()); params.frame is ignored. `moment` NULL: a frame without a sequence. The image
 * has R G B, volume.*, transmittance.*, Z as in base/image.h, and volume.distance if anything was
 * marched; no attributes. Same scene, params and device: same bits. `stats` may be NULL.
 *
 * NEPH_ERR_UNSUPPORTED: a single step exceeds the limits of a dispatch (thousands of sun steps).
 * NEPH_ERR_INTERRUPTED: neph_interrupted() between two dispatches (well below a second each on two
 * CPU cores). NEPH_ERR_INTERNAL: a message of the validation layer.
 *
 * With `image` NULL the frame is only submitted: no image is returned and `stats` is unchanged. Up
 * to NEPH_IN_FLIGHT_FRAMES frames are in flight. */
enum neph_status neph_march_frame(struct neph_march *march, const struct neph_scene *scene,
                                  double frame, const struct neph_march_frame_state *moment,
                                  struct neph_image **image, struct neph_march_stats *stats,
                                  struct neph_diag *diag);

/* Wait for the oldest frame in flight and return its device time (NaN without a clock). Frames
 * whose slot was reused, or that were followed by a frame with an image, are dropped.
 * NEPH_ERR_USAGE: none is in flight. */
enum neph_status neph_march_collect(struct neph_march *march, double *gpu_s,
                                    struct neph_diag *diag);

/* Device time of the sky's tables in the frame that _home returned last. */
struct neph_sky_times neph_march_collected_sky(const struct neph_march *march);

#endif
