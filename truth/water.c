/* SPDX-License-Identifier: MIT */
#include "truth/water.h"

#include <math.h>

/* Wavelengths in um and k. */
static const double absorption[][2] = {
    {0.300, 1.60e-8}, {0.325, 1.08e-8}, {0.350, 6.5e-9},   {0.375, 3.5e-9},  {0.400, 1.86e-9},
    {0.425, 1.30e-9}, {0.450, 1.02e-9}, {0.475, 9.35e-10}, {0.500, 1.00e-9}, {0.525, 1.32e-9},
    {0.550, 1.96e-9}, {0.575, 3.60e-9}, {0.600, 1.09e-8},  {0.625, 1.39e-8}, {0.650, 1.64e-8},
    {0.675, 2.23e-8}, {0.700, 3.35e-8}, {0.725, 9.15e-8},  {0.750, 1.56e-7}, {0.775, 1.48e-7},
    {0.800, 1.25e-7}, {0.825, 1.82e-7}, {0.850, 2.93e-7},  {0.875, 3.91e-7}, {0.900, 4.86e-7},
    {0.925, 1.06e-6}, {0.950, 2.93e-6}, {0.975, 3.48e-6},  {1.000, 2.89e-6},
};
enum { ROWS = sizeof(absorption) / sizeof(absorption[0]) };

static double find_absorption(double wavelength_um)
{
    int i = 1;
    while (i < ROWS - 1 && absorption[i][0] < wavelength_um)
        i++;
    const double *low = absorption[i - 1], *high = absorption[i];
    const double t = (wavelength_um - low[0]) / (high[0] - low[0]);
    return exp((1.0 - t) * log(low[1]) + t * log(high[1]));
}

/* Wavelength over 0.589 um. */
static double compute_real_part(double wavelength)
{
    const double density = NEPH_WATER_DENSITY_KG_PER_M3 / 1000.0, temperature = 293.15 / 273.15,
                 square = wavelength * wavelength, ultraviolet = 0.2292020, infrared = 5.432937;
    const double molar = 0.244257733 + 9.74634476e-3 * density - 3.73234996e-3 * temperature +
                         2.68678472e-4 * square * temperature + 1.58920570e-3 / square +
                         2.45934259e-3 / (square - ultraviolet * ultraviolet) +
                         0.900704920 / (square - infrared * infrared) -
                         1.66626219e-2 * density * density;
    const double lorentz = density * molar; /* (n^2 - 1) / (n^2 + 2) */
    return sqrt((1.0 + 2.0 * lorentz) / (1.0 - lorentz));
}

enum neph_status neph_water_index(double wavelength_m, double complex *index,
                                  struct neph_diag *diag)
{
    if (!(wavelength_m >= NEPH_WATER_WAVELENGTH_MIN_M &&
          wavelength_m <= NEPH_WATER_WAVELENGTH_MAX_M))
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "the index of water is known here from 0.3 to 1.0 um, not at %g um",
                         1e6 * wavelength_m);
    *index = compute_real_part(wavelength_m / 0.589e-6) + I * find_absorption(1e6 * wavelength_m);
    return NEPH_OK;
}
