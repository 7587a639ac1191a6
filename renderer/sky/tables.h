/* SPDX-License-Identifier: MIT
 *
 * The tables of the sky on a Vulkan device, in float32: those that renderer/sky/ computes in
 * double, filled by kernels. Tables of the air are filled once. Tables of views (for a position and
 * a sun) and of the air in front of a camera are filled when their inputs change from frame to
 * frame. Not for other folders.
 */
#ifndef NEPH_RENDERER_SKY_TABLES_H
#define NEPH_RENDERER_SKY_TABLES_H

#include "renderer/in_flight.h"
#include "renderer/sky/sky.h"
#include "renderer/sky/sky_times.h"
#include "shaders/structs.h" /* struct neph_gpu_sky_air, .._eye, shared with the shaders */

/* The uniform buffer and the nodes of all tables: SKY_BINDING of shaders/sky.glsl and the next
 * binding. */
enum { NEPH_SKY_BUFFERS = 2 };

enum { NEPH_SKY_KERNELS = 5 };

struct neph_sky_tables {
    struct neph_vulkan *vulkan; /* borrowed; NULL: no tables */
    struct neph_sky_params params;
    struct neph_sky_air air;
    bool media_scatter, has_field;
    const struct neph_kernel *kernels[NEPH_SKY_KERNELS]; /* owned by the device */
    struct neph_buffer told, nodes, caps, arrivals;
    struct neph_buffer_ring turns;       /* of the uniform buffer */
    bool has_air, has_views, has_aerial; /* whether each table is filled */
    struct neph_gpu_sky_eye eye;         /* inputs of the last two */
};

/* The view for which tables are filled. */
struct neph_sky_table_view {
    const struct neph_scene *scene; /* with its sun and camera, which must not be orthographic */
    double frame;
    int width_px, height_px;
    bool lights;              /* the sky lights media: a second position .. */
    struct neph_vec3 place_m; /* .. is the one of these media */
    bool is_shaded; /* the aerial table already has its shadows when it is filled (sky_shade.h) */
};

/* Upper bound of loop iterations (compute.h) of one sample of all tables, for a number of layers
 * and a degree of moments. */
uint64_t neph_sky_sample_iterations(int layers, int degree);

/* NULL: the tables support the scene; else the reason as text. */
const char *neph_sky_tables_obstacle(const struct neph_scene *scene, const struct neph_sky_air *air,
                                     const struct neph_sky_params *params);

/* Create the tables of an atmosphere for a scattering setting. Zero-initialise `tables`; free with
 * _destroy, also after an error. */
enum neph_status neph_sky_tables_create(struct neph_vulkan *vulkan, const struct neph_sky_air *air,
                                        enum neph_scattering scattering,
                                        const struct neph_sky_params *params,
                                        struct neph_sky_tables *tables, struct neph_diag *diag);

/* Set the specialization constants of kernels that use the tables (SKY_IS_KNOWN of
 * shaders/sky.glsl). */
void neph_sky_constants(const struct neph_sky_tables *tables, struct neph_kernel_params *kernel);

/* A zero-initialised struct is fine. */
void neph_sky_tables_destroy(struct neph_sky_tables *tables);

/* Set the view and submit the filling of stale tables, except the air in front of the camera.
 * Device times are added to `times` when the frame is collected (borrowed until then). Once a
 * frame, after neph_in_flight_begin(). */
enum neph_status neph_sky_tables_update(struct neph_sky_tables *tables,
                                        const struct neph_sky_table_view *look,
                                        struct neph_sky_times *times, struct neph_diag *diag);

/* Then submit the filling of the air in front of the camera. */
enum neph_status neph_sky_tables_update_aerial(struct neph_sky_tables *tables,
                                               struct neph_sky_times *times,
                                               struct neph_diag *diag);

#endif
