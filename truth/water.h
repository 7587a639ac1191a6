/* SPDX-License-Identifier: MIT
 *
 * The refractive index of liquid water at 20 degrees Celsius, density 998.2 kg/m3.
 */
#ifndef NEPH_TRUTH_WATER_H
#define NEPH_TRUTH_WATER_H

#include "base/status.h"
#include "scenes/density_units.h" /* NEPH_WATER_DENSITY_KG_PER_M3 */

#include <complex.h>

#define NEPH_WATER_WAVELENGTH_MIN_M 0.3e-6
#define NEPH_WATER_WAVELENGTH_MAX_M 1.0e-6

/* n + i k at a wavelength in vacuum. n: IAPWS R9-97 (1997), equation 1, whose error is below 1e-4.
 * k: G. M. Hale, M. R. Querry, Appl. Opt. 12, 555 (1973), table 1, its logarithm interpolated.
 * NEPH_ERR_INPUT: the wavelength is out of the bounds above. */
enum neph_status neph_water_index(double wavelength_m, double complex *index,
                                  struct neph_diag *diag);

#endif
