/* SPDX-License-Identifier: MIT
 *
 * Shared by the CPU references of anti-aliasing and of upsampling with locks; not for tests.
 */
#ifndef NEPH_CHECK_REFERENCE_TAA_H
#define NEPH_CHECK_REFERENCE_TAA_H

#include "renderer/realtime/shared/check_reference.h"

/* A colour in double precision. */
struct colour {
    double c[3];
};

/* 3x3 colours, row by row; invalid ones are ignored everywhere. */
struct neighbourhood {
    struct colour colours[9];
    bool is_valid[9];
    float off_px[9][2]; /* offsets of their rays from the pixel's centre, in rendered pixels */
};

/* An output pixel and its rendered source pixel: itself at 100 %. */
struct place {
    int x, y, source_x, source_y;
};

double taa_clamp(double value, double low, double high);
bool taa_is_finite(struct colour colour);
struct colour taa_guard(const struct reference *cpu, struct colour colour);
struct colour taa_fetch_colour(const struct reference *cpu, int target, int x, int y);
double taa_luma_4(struct colour colour);

/* Decisions, in the shader's float32. */
float taa_dot(const float a[3], const float b[3]);
void taa_ray_through(const struct neph_gpu_view *view, int x, int y, float ray[3]);
bool taa_find_before(const struct reference *cpu, struct place at, float place_px[2],
                     double *speed_px);
struct place taa_find_source(const struct reference *cpu, int x, int y);
float taa_shift_px(const struct reference *cpu, int pixel, int source, int axis);

bool taa_fetch_history(const struct reference *cpu, const float place_px[2],
                       struct colour *history);
struct neighbourhood taa_fetch_neighbourhood(const struct reference *cpu, struct place at);
double taa_coverage(const struct reference *cpu, const struct neighbourhood *around);
bool taa_filter_samples(const struct reference *cpu, const struct neighbourhood *around,
                        struct colour *filtered);

/* `scale`: factor of the deviations of taa_box=variance. */
struct colour taa_clamp_history(const struct reference *cpu, struct colour history,
                                struct neighbourhood around, struct colour filtered, double scale);

struct colour taa_blend(const struct reference *cpu, struct colour frame, struct colour history,
                        double alpha);

/* A pixel of RT_TAA_OUT. */
void taa_put_pixel(const struct reference *cpu, int x, int y, struct colour colour, double age);

#endif
