// SPDX-License-Identifier: MIT
//
// scenes/phase_linear.c in float32.

// 1 + g cos = 1 - |g| + |g| (1 + |cos|): a sum of what is not negative keeps its digits.
float linear_per_sr(float g, vec3 view, vec3 sun)
{
    vec3 sum = g >= 0.0 ? view + sun : view - sun;
    float a = abs(g);
    return (1.0 - a + 0.5 * a * dot(sum, sum)) / (4.0 * PI);
}

float linear_versine(float g, float u)
{
    return 4.0 * (1.0 - u) / (1.0 + g + sqrt((1.0 - g) * (1.0 - g) + 4.0 * g * u));
}
