// SPDX-License-Identifier: MIT
//
// scenes/phase_isotropic.c in float32.

const float ISOTROPIC_PER_SR = 1.0 / (4.0 * PI);

float isotropic_versine(float u) { return 2.0 * (1.0 - u); }
