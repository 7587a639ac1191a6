/* SPDX-License-Identifier: MIT
 *
 * The ray marcher at full resolution: fixed steps, one ray through the centre of each pixel, no
 * antialiasing, single scattering from the sun. It is the "same model at full quality" that
 * shortcuts are measured against, and itself measured against truth/transport.h.
 *
 * Method: energy-conserving integration of each step, S (1 - e^(-sigma dt)) / sigma with S at the
 * middle of the step (S. Hillaire, "Physically Based and Unified Volumetric Rendering in
 * Frostbite", SIGGRAPH 2015 course, slide "improved integration"); second order where the scene is
 * smooth, first order at the edges of shadows and of overlapping media. Written out in
 * shaders/march.comp.
 *
 * Steps are equal in distance over the part of the ray that matters: from the first to the last
 * face of any medium, before the first solid; for fog that goes on for ever, from where 1e-7 of
 * optical depth is met to where 1e-7 is left, or to where e^-16 of the light comes through. What
 * is left out changes the transmittance by less than 1e-7 per fog layer.
 *
 * Float32: the optical depth is good to about falloff * distance * 6e-8 of itself, because that is
 * how well a float32 knows a height at that distance from the camera.
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
    double gpu_s;              /* device time of all dispatches; NaN when the device has no clock */
    struct neph_sky_times sky; /* its part for the tables of the sky; 0: none was filled */
    double wall_s; /* from call to return: uploads, copies and the first compilation included */
    /* Points at which the extinction of the media was evaluated, counted by the shader: steps of
     * view rays that meet a medium, and of their marched sun rays. */
    uint64_t density_evaluations;
    /* Closed-form optical depths, counted by the shader: whole rays, steps, sun rays. */
    uint64_t closed_forms;
    uint64_t view_steps; /* of view rays alone */
    uint64_t rays;       /* of view */
    int dispatches;
};

/* False, with the reason in words, when the scene asks for what this lighting leaves out or has not
 * got: multiple scattering of `single`, anything less of the others; background light on media or
 * solids; another medium than Horizon's clouds in their light. Or when a medium lies beyond the
 * reach of float32 (renderer/reach.h). */
bool neph_march_can_render(const struct neph_scene *scene, enum neph_march_lighting lighting,
                           char *reason, size_t reason_size);

/* What is left of a scene without its veils, in `rest`, which borrows all that the scene owns.
 * False, with the reason in words, when it has no such air (renderer/sky/split.h) or no such look
 * (scenes/fog_translation.h). */
bool neph_march_rest(const struct neph_scene *scene, struct neph_march_veils veils,
                     struct neph_scene *rest, char *reason, size_t reason_size);

/* As before where the air of a planet is tables (struct neph_march_sky), or the height fog a look:
 * also when there is no such air, or more behind it or around than tables know, and when there is
 * no such look. */
bool neph_march_can_render_under(const struct neph_scene *scene, struct neph_march_veils veils,
                                 enum neph_march_lighting lighting, char *reason,
                                 size_t reason_size);

/* Everything that neph_march_create() refuses before it looks at a device: NEPH_ERR_USAGE, a
 * parameter is out of range; NEPH_ERR_UNSUPPORTED, neph_march_can_render() says no. */
enum neph_status neph_march_check(const struct neph_scene *scene,
                                  const struct neph_march_params *params, struct neph_diag *diag);

/* A march of many frames of one scene: its grids and textures stay on the device. */
struct neph_march;

/* For neph_march_destroy(). */
enum neph_status neph_march_create(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                   const struct neph_march_params *params,
                                   struct neph_march **march, struct neph_diag *diag);
void neph_march_destroy(struct neph_march *march);

/* One frame of the scene, which may have another sun or its media moved since (neph_scene_at());
 * params.frame counts no more. `moment` NULL: a picture by itself. The image has R G B, volume.*,
 * transmittance.*, Z as in base/image.h, and where something was marched volume.distance; no
 * attributes. Same scene, params and device: same bits. `stats` may be NULL.
 *
 * NEPH_ERR_UNSUPPORTED: one step alone is more than a dispatch may hold (thousands of sun steps).
 * NEPH_ERR_INTERRUPTED: neph_interrupted() between two dispatches (well below a second each on two
 * CPU cores). NEPH_ERR_INTERNAL: the validation layer had something to say.
 *
 * `image` NULL: the frame is on its way when this returns, nothing comes back of it and `stats` is
 * left alone; up to NEPH_IN_FLIGHT_FRAMES of them are in flight. */
enum neph_status neph_march_frame(struct neph_march *march, const struct neph_scene *scene,
                                  double frame, const struct neph_march_moment *moment,
                                  struct neph_image **image, struct neph_march_stats *stats,
                                  struct neph_diag *diag);

/* The device's time for the oldest frame in flight (NaN: it has no clock), waited for. One whose
 * turn is over, or that had a frame with an image after it, is forgotten. NEPH_ERR_USAGE: none is
 * in flight. */
enum neph_status neph_march_home(struct neph_march *march, double *gpu_s, struct neph_diag *diag);

/* What the tables of the sky took of the frame that _home told last. */
struct neph_sky_times neph_march_home_sky(const struct neph_march *march);

#endif
