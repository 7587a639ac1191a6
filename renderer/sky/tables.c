/* SPDX-License-Identifier: MIT */
#include "renderer/sky/tables.h"

#include "base/interrupt.h"
#include "renderer/relative.h"
#include "scenes/radial.h"

#include <math.h>
#include <string.h>

/* Does not compile with a new kind: this file then needs a change. */
_Static_assert(NEPH_SKY_REFILL_COUNT == 3, "a new kind");
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");

static const uint32_t sun_code[] = {
#include "shaders/sky_sun.comp.inc"
};
static const uint32_t gather_code[] = {
#include "shaders/sky_gather.comp.inc"
};
static const uint32_t sum_code[] = {
#include "shaders/sky_sum.comp.inc"
};
static const uint32_t view_code[] = {
#include "shaders/sky_view.comp.inc"
};
static const uint32_t aerial_code[] = {
#include "shaders/sky_aerial.comp.inc"
};

/* VEIL_PARTS: values of a node of air in front of the camera, in shaders/sky_aerial.glsl. */
enum { local_size = 64, VEIL_PARTS = 3 };

enum kernel { SUN, GATHER, SUM, VIEW, AERIAL };

static const struct {
    const char *name;
    const uint32_t *code;
    size_t bytes;
    int buffers; /* parameters, nodes, directions, light from these */
    size_t push_bytes;
} kernels[NEPH_SKY_KERNELS] = {
    [SUN] = {"sky_sun", sun_code, sizeof(sun_code), 2, 0},
    [GATHER] = {"sky_gather", gather_code, sizeof(gather_code), 4,
                sizeof(struct neph_gpu_sky_pass)},
    [SUM] = {"sky_sum", sum_code, sizeof(sum_code), 4, sizeof(struct neph_gpu_sky_pass)},
    [VIEW] = {"sky_view", view_code, sizeof(view_code), 2, 0},
    [AERIAL] = {"sky_aerial", aerial_code, sizeof(aerial_code), 2, 0},
};

/* The uniform buffer of the shaders. */
struct told {
    struct neph_gpu_sky_air air;
    struct neph_gpu_sky_eye eye;
};

/* --- sizes ------------------------------------------------------------------------------------ */

static size_t sun_count(const struct neph_sky_params *params)
{
    return (size_t)params->sun_altitudes * (size_t)params->sun_cosines;
}

static size_t place_count(const struct neph_sky_params *params)
{
    return (size_t)params->field.altitudes * (size_t)params->field.suns;
}

static size_t direction_count(const struct neph_sky_solve_params *field)
{
    return ((size_t)field->above + (size_t)field->below) * (size_t)field->around;
}

static size_t field_count(const struct neph_sky_params *params)
{
    return place_count(params) * (size_t)neph_sky_moments(params->field.degree) +
           (size_t)params->field.suns;
}

static size_t view_count(const struct neph_sky_params *params)
{
    const struct neph_sky_view_params *view = &params->view;
    return view->is_table ? 2 * (size_t)view->elevations * (size_t)view->azimuths : 0;
}

static size_t slice_count(const struct neph_sky_air *air)
{
    return (size_t)air->layer_count + NEPH_SKY_SLICES;
}

static size_t column_count(const struct neph_sky_params *params)
{
    const struct neph_sky_aerial_params *aerial = &params->aerial;
    return aerial->slices > 0 ? (size_t)aerial->columns * (size_t)aerial->rows : 0;
}

static size_t views_first(const struct neph_sky_params *params)
{
    return sun_count(params) + field_count(params);
}

static size_t aerial_first(const struct neph_sky_air *air, const struct neph_sky_params *params)
{
    return views_first(params) + NEPH_GPU_SKY_PLACES * view_count(params) * slice_count(air);
}

static size_t node_count(const struct neph_sky_air *air, const struct neph_sky_params *params)
{
    return aerial_first(air, params) +
           VEIL_PARTS * column_count(params) * (size_t)params->aerial.slices;
}

/* --- supported scenes ------------------------------------------------------------------------- */

/* Loop iterations of a step, loop by loop of sky_step(). */
static uint64_t turns_of_step(int layers, int degree)
{
    const uint64_t degrees = (uint64_t)degree + 2;
    return NEPH_SKY_DEGREE_MAX + 4 + (uint64_t)layers * (degrees + 1) + degrees * (degrees + 1);
}

uint64_t neph_sky_look_turns(int layers, int degree)
{
    return turns_of_step(layers, degree) + 5 * ((uint64_t)layers + 1);
}

const char *neph_sky_tables_obstacle(const struct neph_scene *scene, const struct neph_sky_air *air,
                                     const struct neph_sky_params *params)
{
    uint64_t steps = (uint64_t)fmax(params->steps, params->field.steps);
    steps = (uint64_t)fmax((double)steps, 4.0 * params->aerial.slices);
    const uint64_t sum = direction_count(&params->field) * (NEPH_SKY_DEGREE_MAX + 3);
    if (scene->orthographic_height_m > 0.0)
        return "an orthographic camera, on a device";
    if (params->field.closure && scene->scattering == NEPH_SCATTERING_MULTIPLE)
        return "multiple=closure on a device";
    if ((steps + 2) * (2 + turns_of_step(air->layer_count, params->field.degree)) >
            NEPH_KERNEL_LOOP_TURNS_MAX ||
        sum > NEPH_KERNEL_LOOP_TURNS_MAX)
        return "more steps or directions than a dispatch may have";
    return NULL;
}

/* --- parameters of the shaders ---------------------------------------------------------------- */

static void copy_rgb(float to[3], const double from[3])
{
    for (int c = 0; c < 3; c++)
        to[c] = (float)from[c];
}

static struct neph_gpu_sky_layer layer_of(const struct neph_sky_layer *from)
{
    struct neph_gpu_sky_layer layer = {.is_tent = from->is_tent,
                                       .middle_m = (float)from->middle_m,
                                       .scale_m = (float)from->scale_m,
                                       .phase_kind = from->phase.kind,
                                       .g = (float)from->phase.g};
    copy_rgb(layer.extinction_per_m, from->extinction_per_m);
    copy_rgb(layer.scattering_per_m, from->scattering_per_m);
    for (int l = 0; l <= NEPH_SKY_DEGREE_MAX; l++)
        layer.legendre[l] = (float)from->legendre[l];
    return layer;
}

static struct neph_gpu_sky_air air_of(const struct neph_sky_tables *tables)
{
    const struct neph_sky_air *from = &tables->air;
    const struct neph_sky_params *params = &tables->params;
    struct neph_gpu_sky_air air = {
        .radius_m = (float)from->radius_m,
        .top_m = (float)from->top_m,
        .layer_count = (uint32_t)from->layer_count,
        .degree = (uint32_t)params->field.degree,
        .altitudes = (uint32_t)params->field.altitudes,
        .suns = (uint32_t)params->field.suns,
        .sun_altitudes = (uint32_t)params->sun_altitudes,
        .sun_cosines = (uint32_t)params->sun_cosines,
        .deepest_root = (float)neph_sky_deepest_root(),
        .field_first = (uint32_t)sun_count(params),
    };
    copy_rgb(air.ground_albedo, from->ground_albedo);
    for (int i = 0; i < from->layer_count; i++)
        air.layers[i] = layer_of(&from->layers[i]);
    for (int l = 0; l <= NEPH_SKY_DEGREE_MAX; l++)
        for (int m = 0; m <= l; m++)
            air.norms[neph_sky_moments(l - 1) + m] = (float)neph_sky_norm(l, m);
    return air;
}

/* Relative to the current position of the ground: the world may have been shifted. */
static struct neph_gpu_sky_place place_of(const struct neph_sky_tables *tables,
                                          const struct neph_sky_look *look,
                                          struct neph_vec3 place_m, size_t index)
{
    const struct neph_sky_air *air = &tables->air;
    const struct neph_vec3 center_m = look->scene->solids[0].center_m;
    const double altitude_m = (double)(neph_radial_distance_m(center_m, place_m) -
                                       (long double)air->radius_m);
    const size_t nodes = view_count(&tables->params) * slice_count(air);
    struct neph_gpu_sky_place place = {
        .altitude_m = (float)fmax(0.0, altitude_m),
        .first = (uint32_t)(views_first(&tables->params) + index * nodes),
    };
    neph_gpu_direction(place.vertical, neph_vec3_normalize(neph_vec3_sub(place_m, center_m)));
    return place;
}

static struct neph_gpu_sky_eye eye_of(const struct neph_sky_tables *tables,
                                      const struct neph_sky_look *look)
{
    const struct neph_scene *scene = look->scene;
    const struct neph_sky_params *params = &tables->params;
    const struct neph_camera camera = neph_scene_camera(scene, look->frame);
    const double half_height = neph_camera_half_height(&camera);
    struct neph_gpu_sky_eye eye = {
        .half_width = (float)(half_height * look->width_px / look->height_px),
        .half_height = (float)half_height,
        .width_px = (uint32_t)look->width_px,
        .height_px = (uint32_t)look->height_px,
        .steps = (uint32_t)params->steps,
        .scatters = tables->media_scatter,
        .has_field = tables->has_field,
        .elevations = params->view.is_table ? (uint32_t)params->view.elevations : 0u,
        .azimuths = (uint32_t)params->view.azimuths,
        .aerial_columns = (uint32_t)params->aerial.columns,
        .aerial_rows = (uint32_t)params->aerial.rows,
        .aerial_slices = (uint32_t)params->aerial.slices,
        .aerial_far_m = (float)params->aerial.far_m,
        .aerial_first = (uint32_t)aerial_first(&tables->air, params),
        .is_shaded = look->is_shaded,
        .place_count = look->lights ? 2 : 1,
        .places = {place_of(tables, look, camera.position_m, 0),
                   place_of(tables, look, look->place_m, 1)},
    };
    neph_gpu_direction(eye.right, camera.right);
    neph_gpu_direction(eye.up, camera.up);
    neph_gpu_direction(eye.forward, camera.forward);
    neph_gpu_direction(eye.sun_direction, scene->sun.direction);
    const struct neph_rgb sun = scene->sun.irradiance_w_per_m2;
    if (scene->sun.present)
        copy_rgb(eye.sun_irradiance, (const double[3]){sun.r, sun.g, sun.b});
    return eye;
}

static void write_caps(const struct neph_sky_solve_params *field, float (*caps)[2])
{
    const int counts[2] = {field->above, field->below};
    for (int half = 0; half < 2; half++) {
        double nodes[NEPH_SKY_DIRECTIONS_MAX], weights[NEPH_SKY_DIRECTIONS_MAX];
        neph_sky_gauss(counts[half], nodes, weights);
        for (int i = 0; i < counts[half]; i++, caps++) {
            (*caps)[0] = (float)nodes[i];
            (*caps)[1] = (float)weights[i];
        }
    }
}

/* --- creation --------------------------------------------------------------------------------- */

static enum neph_status create_buffers(struct neph_sky_tables *tables, struct neph_diag *diag)
{
    const struct neph_sky_params *params = &tables->params;
    const size_t texel = 4 * sizeof(float);
    const struct neph_buffer_row rows[] = {
        {&tables->told, NEPH_BUFFER_UPLOAD, sizeof(struct told), "sky"},
        {&tables->nodes, NEPH_BUFFER_DEVICE, node_count(&tables->air, params) * texel, "sky nodes"},
        {&tables->caps, NEPH_BUFFER_UPLOAD,
         (size_t)(params->field.above + params->field.below) * 2 * sizeof(float), "sky caps"},
        {&tables->arrivals, NEPH_BUFFER_DEVICE,
         place_count(params) * direction_count(&params->field) * texel, "sky arrivals"},
    };
    const enum neph_status status = neph_buffers_create(tables->vulkan, rows,
                                                        sizeof(rows) / sizeof(rows[0]), diag);
    return status ? status
                  : neph_turns_create(tables->vulkan, &tables->told, "sky", &tables->turns, diag);
}

void neph_sky_constants(const struct neph_sky_tables *tables, struct neph_kernel_params *kernel)
{
    kernel->constant_count = 2;
    kernel->constants[0] = (uint32_t)tables->air.layer_count;
    kernel->constants[1] = (uint32_t)tables->params.field.degree;
}

static enum neph_status get_kernels(struct neph_sky_tables *tables, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < NEPH_SKY_KERNELS && !status; i++) {
        struct neph_kernel_params params = {.name = kernels[i].name,
                                            .code = kernels[i].code,
                                            .code_bytes = kernels[i].bytes,
                                            .buffer_count = kernels[i].buffers,
                                            .push_size_bytes = kernels[i].push_bytes};
        neph_sky_constants(tables, &params);
        status = neph_kernel_get(tables->vulkan, &params, &tables->kernels[i], diag);
    }
    return status;
}

enum neph_status neph_sky_tables_create(struct neph_vulkan *vulkan, const struct neph_sky_air *air,
                                        enum neph_scattering scattering,
                                        const struct neph_sky_params *params,
                                        struct neph_sky_tables *tables, struct neph_diag *diag)
{
    tables->vulkan = vulkan;
    tables->air = *air;
    tables->params = *params;
    tables->media_scatter = scattering != NEPH_SCATTERING_NONE;
    tables->has_field = scattering == NEPH_SCATTERING_MULTIPLE;
    enum neph_status status = create_buffers(tables, diag);
    if (!status)
        status = get_kernels(tables, diag);
    if (!status)
        write_caps(&params->field, tables->caps.mapped);
    return status;
}

void neph_sky_tables_destroy(struct neph_sky_tables *tables)
{
    if (!tables->vulkan)
        return;
    neph_buffer_destroy(tables->vulkan, &tables->arrivals);
    neph_buffer_destroy(tables->vulkan, &tables->caps);
    neph_buffer_destroy(tables->vulkan, &tables->nodes);
    neph_turns_destroy(tables->vulkan, &tables->turns);
    neph_buffer_destroy(tables->vulkan, &tables->told);
    *tables = (struct neph_sky_tables){.vulkan = NULL};
}

/* --- filling ---------------------------------------------------------------------------------- */

static void add(const struct neph_sky_tables *tables, struct neph_batch *batch, enum kernel kernel,
                size_t threads, const void *push, struct neph_diag *diag)
{
    const struct neph_dispatch dispatch = {
        .buffers = {&tables->told, &tables->nodes, &tables->caps, &tables->arrivals},
        .push = push,
        .group_count = (uint32_t)((threads + local_size - 1) / local_size),
    };
    neph_batch_dispatch(batch, tables->kernels[kernel], &dispatch, diag);
    neph_batch_barrier(batch);
}

/* Fill one table in a batch of its own. */
static enum neph_status fill(const struct neph_sky_tables *tables, enum kernel kernel,
                             size_t threads, double *gpu_s, struct neph_diag *diag)
{
    struct neph_batch batch;
    if (threads == 0)
        return NEPH_OK;
    neph_batch_begin(tables->vulkan, &batch, diag);
    add(tables, &batch, kernel, threads, NULL, diag);
    neph_batch_stamp(&batch, gpu_s);
    return neph_batch_send(&batch, "the sky", diag);
}

/* Add an order of scattering. */
static enum neph_status add_order(const struct neph_sky_tables *tables, bool is_first,
                                  double *gpu_s, struct neph_diag *diag)
{
    const struct neph_sky_solve_params *field = &tables->params.field;
    const struct neph_gpu_sky_pass pass = {.has_field = !is_first,
                                           .above = (uint32_t)field->above,
                                           .below = (uint32_t)field->below,
                                           .around = (uint32_t)field->around,
                                           .steps = (uint32_t)field->steps};
    const size_t rays = place_count(&tables->params) * direction_count(field);
    struct neph_batch batch;
    if (neph_interrupted())
        return neph_fail(diag, NEPH_ERR_INTERRUPTED, "the sky: interrupted");
    neph_batch_begin(tables->vulkan, &batch, diag);
    add(tables, &batch, GATHER, rays, &pass, diag);
    add(tables, &batch, SUM, field_count(&tables->params), &pass, diag);
    neph_batch_stamp(&batch, gpu_s);
    return neph_batch_send(&batch, "the sky", diag);
}

static enum neph_status fill_air(struct neph_sky_tables *tables, double *gpu_s,
                                 struct neph_diag *diag)
{
    enum neph_status status = fill(tables, SUN, sun_count(&tables->params), gpu_s, diag);
    for (int order = 0; tables->has_field && order < tables->params.field.orders && !status;
         order++)
        status = add_order(tables, order == 0, gpu_s, diag);
    tables->has_air = !status;
    return status;
}

/* Mark tables as stale that were filled for another camera or sun. */
static void take_eye(struct neph_sky_tables *tables, const struct neph_gpu_sky_eye *eye)
{
    tables->has_air = tables->has_air && tables->params.refill != NEPH_SKY_REFILL_ALL;
    if (tables->params.refill == NEPH_SKY_REFILL_STALE &&
        memcmp(&tables->eye, eye, sizeof(*eye)) == 0)
        return;
    tables->eye = *eye;
    tables->has_views = tables->has_aerial = false;
}

enum neph_status neph_sky_tables_look(struct neph_sky_tables *tables,
                                      const struct neph_sky_look *look,
                                      struct neph_sky_times *times, struct neph_diag *diag)
{
    const struct told told = {air_of(tables), eye_of(tables, look)};
    const size_t parts = (size_t)tables->air.layer_count + 1;
    neph_turns_take(&tables->turns, &tables->told);
    memcpy(tables->told.mapped, &told, sizeof(told));
    take_eye(tables, &told.eye);
    enum neph_status status = tables->has_air ? NEPH_OK : fill_air(tables, &times->air_s, diag);
    if (status || tables->has_views)
        return status;
    status = fill(tables, VIEW,
                  told.eye.place_count * view_count(&tables->params) * parts * NEPH_GPU_SKY_WALKERS,
                  &times->view_s, diag);
    tables->has_views = !status;
    return status;
}

enum neph_status neph_sky_tables_veil(struct neph_sky_tables *tables, struct neph_sky_times *times,
                                      struct neph_diag *diag)
{
    if (tables->has_aerial)
        return NEPH_OK;
    const enum neph_status status = fill(
        tables, AERIAL, column_count(&tables->params) * NEPH_GPU_SKY_SLICES_AT_ONCE,
        &times->aerial_s, diag);
    tables->has_aerial = !status;
    return status;
}
