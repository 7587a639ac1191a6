/* SPDX-License-Identifier: MIT
 *
 * The tables of the sky on a Vulkan device, in float32: what renderer/sky/ computes in double,
 * filled by kernels. Those of the air are made once; of what is seen from a place under a sun, and
 * of the air before a camera, for each picture that sees something else than the one before. Not
 * for other folders.
 */
#ifndef NEPH_RENDERER_SKY_TABLES_H
#define NEPH_RENDERER_SKY_TABLES_H

#include "renderer/in_flight.h"
#include "renderer/sky/sky.h"
#include "renderer/sky/sky_times.h"
#include "shaders/structs.h" /* struct neph_gpu_sky_air, .._eye, from the shaders */

/* What shaders are told, and the nodes of all tables: SKY_BINDING of shaders/sky.glsl and the
 * binding after it. */
enum { NEPH_SKY_BUFFERS = 2 };

enum { NEPH_SKY_KERNELS = 5 };

struct neph_sky_tables {
    struct neph_vulkan *vulkan; /* borrowed; NULL: there are none */
    struct neph_sky_params params;
    struct neph_sky_air air;
    bool media_scatter, has_field;
    const struct neph_kernel *kernels[NEPH_SKY_KERNELS]; /* owned by the device */
    struct neph_buffer told, nodes, caps, arrivals;
    struct neph_turns turns;             /* of what shaders are told */
    bool has_air, has_views, has_aerial; /* the tables that are filled */
    struct neph_gpu_sky_eye eye;         /* what the latter two are for */
};

/* Who looks, from where, and at what. */
struct neph_sky_look {
    const struct neph_scene *scene; /* its sun and camera, not orthographic */
    double frame;
    int width_px, height_px;
    bool lights;              /* there is a second place, .. */
    struct neph_vec3 place_m; /* .. of what the sky lights */
    bool is_shaded; /* shadows on the air are in its table before that is filled (sky_shade.h) */
};

/* Loop turns (compute.h) of one look into all tables, at most, by layers of the air and the degree
 * of its moments. */
uint64_t neph_sky_look_turns(int layers, int degree);

/* NULL: they can be filled; else what they have not, in words. */
const char *neph_sky_tables_obstacle(const struct neph_scene *scene, const struct neph_sky_air *air,
                                     const struct neph_sky_params *params);

/* Tables of an atmosphere in a scene's orders of scattering. Zero-initialise `tables`; free
 * with _destroy, also after an error. */
enum neph_status neph_sky_tables_create(struct neph_vulkan *vulkan, const struct neph_sky_air *air,
                                        enum neph_scattering scattering,
                                        const struct neph_sky_params *params,
                                        struct neph_sky_tables *tables, struct neph_diag *diag);

/* What kernels of tables are made for (SKY_IS_KNOWN of shaders/sky.glsl). */
void neph_sky_constants(const struct neph_sky_tables *tables, struct neph_kernel_params *kernel);

/* A zero one is fine. */
void neph_sky_tables_destroy(struct neph_sky_tables *tables);

/* Tell shaders who looks, and fill what is not filled of that but for the air before the camera: on
 * its way when this returns, its times added when it is home (borrowed until then). Once a frame,
 * after neph_in_flight_begin(). */
enum neph_status neph_sky_tables_look(struct neph_sky_tables *tables,
                                      const struct neph_sky_look *look,
                                      struct neph_sky_times *times, struct neph_diag *diag);

/* And then the air before the camera. */
enum neph_status neph_sky_tables_veil(struct neph_sky_tables *tables, struct neph_sky_times *times,
                                      struct neph_diag *diag);

#endif
