/* SPDX-License-Identifier: MIT
 *
 * Fluxes by the path tracer on the device: paths from the columns to the sun, while the photons of
 * truth/fluxes.h come from it, so both agree only if both are right. A path of
 *
 *   reflected    starts on the column's top, downwards, by the cosine law: pi times its radiance
 *   transmitted  on its bottom, upwards, by the cosine law, plus the attenuated sunlight there
 *   upward       on its bottom, downwards, by the cosine law: the light of the ground
 *   absorbed     at a point in its volume, in any direction: absorption coefficient times
 *                (4 pi times its radiance + attenuated sunlight). The point is one of 8, chosen by
 *                absorption (J. Talbot, D. Cline, P. Egbert, "Importance Resampling for Global
 *                Illumination", EGSR 2005)
 *   nadir        on its top, straight down: pi times the radiance that leaves upwards
 *   zenith       on its bottom, straight up
 *
 * and NEPH_TRACER_BATCH_SAMPLES paths share a start.
 */
#ifndef NEPH_HARNESS_PHYSICS_FLUXES_TRACER_H
#define NEPH_HARNESS_PHYSICS_FLUXES_TRACER_H

#include "renderer/vulkan.h"
#include "truth/fluxes.h"

/* As neph_fluxes_trace(), in float32 on the device. `paths` is rounded up to whole starts. The
 * same device gives the same bits. NEPH_ERR_UNSUPPORTED: media without a closed form, whose
 * sunlight on a level is not exact; scenes beyond the tracer. */
enum neph_status neph_fluxes_trace_on_device(struct neph_vulkan *vulkan,
                                             const struct neph_scene *scene,
                                             const struct neph_fluxes_params *params,
                                             struct neph_fluxes *fluxes, struct neph_diag *diag);

#endif
