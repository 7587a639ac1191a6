/* SPDX-License-Identifier: MIT */
#include "harness/physics/phases.h"

#include "scenes/quadrature.h"

#include <math.h>

/* Divide [0, length] into pieces that halve towards both ends, where the peaks are. */
enum { HALVINGS = 30, PIECES = 2 * HALVINGS };

static void cut(double length, struct neph_interval pieces[PIECES])
{
    double far = 0.5 * length;
    for (int i = 0; i < HALVINGS; i++) {
        const double near = i == HALVINGS - 1 ? 0.0 : 0.5 * far;
        pieces[2 * i] = (struct neph_interval){near, far};
        pieces[2 * i + 1] = (struct neph_interval){length - far, length - near};
        far = near;
    }
}

/* Integrand over the versine v = 1 - cosine; the solid angle is 2 pi dv. */
static void over_versine(double v, void *context, double value[3])
{
    const double density = 2.0 * M_PI * neph_phase_per_sr(context, 1.0 - v);
    value[0] = density;
    value[1] = density * (1.0 - v);
    value[2] = 0.0;
}

static void over_number(double u, void *context, double value[3])
{
    value[0] = 1.0 - neph_phase_versine(context, u);
    value[1] = value[2] = 0.0;
}

struct neph_phase_finding neph_phase_check(const struct neph_phase *phase)
{
    struct neph_phase copy = *phase;
    struct neph_interval pieces[PIECES];
    double density[3], drawn[3];
    cut(2.0, pieces);
    neph_integrate(over_versine, &copy, pieces, PIECES, density);
    cut(1.0, pieces);
    neph_integrate(over_number, &copy, pieces, PIECES, drawn);
    const double g = neph_phase_mean_cosine(phase);
    return (struct neph_phase_finding){
        .phase = *phase,
        .integral = density[0],
        .mean_cosine = density[1],
        .sampled_mean_cosine = drawn[0],
        .agrees = fabs(density[0] - 1.0) < NEPH_PHASE_TOLERANCE &&
                  fabs(density[1] - g) < NEPH_PHASE_TOLERANCE &&
                  fabs(drawn[0] - g) < NEPH_PHASE_TOLERANCE,
    };
}

/* Check one kind with all its trials, as far as there is room. */
static int check_kind(enum neph_phase_kind kind, int room, struct neph_phase_finding *found)
{
    const struct neph_phase_row *row = neph_phase_row(kind);
    const int count = row->trial_count < room ? row->trial_count : room;
    for (int i = 0; i < count; i++)
        found[i] = neph_phase_check(&row->trials[i]);
    return count;
}

int neph_phases_check(struct neph_phase_finding found[NEPH_PHASES_MAX])
{
    int count = 0;
    for (int has_asymmetry = 0; has_asymmetry <= 1; has_asymmetry++)
        for (int kind = 0; kind < NEPH_PHASE_KIND_COUNT; kind++)
            if (neph_phase_has(kind, NEPH_PHASE_PARAMETER_G) == (has_asymmetry == 1))
                count += check_kind(kind, NEPH_PHASES_MAX - count, &found[count]);
    return count;
}
