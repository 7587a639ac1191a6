// SPDX-License-Identifier: MIT
//
// The isotropic phase function: float32 version of scenes/phase_isotropic.c.

const float ISOTROPIC_PER_SR = 1.0 / (4.0 * PI);

// Sampling: 1 - cos of the scattering angle.
float isotropic_versine(float u) { return 2.0 * (1.0 - u); }
