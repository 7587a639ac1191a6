/* SPDX-License-Identifier: MIT
 *
 * The fields are sums over electric and magnetic multipoles of order n with coefficients a_n, b_n
 * (equation 4.88). They need the Riccati-Bessel functions psi_n(x) = x j_n(x) and xi_n = psi_n - i
 * chi_n with chi_n(x) = -x y_n(x) of the size parameter x, and the logarithmic derivative D_n(m x)
 * of psi_n at m x with the refractive index m.
 *
 * - D_n is computed by downward recurrence, which forgets its starting value; upward it diverges
 *   for absorbing spheres (J. V. Dave 1969; W. J. Lentz 1976).
 * - chi_n is computed by upward recurrence, and so is psi_n up to n = x. Above, where psi_n falls,
 *   that diverges, and psi_n follows from its ratios to psi_(n-1), which are computed downward.
 *
 * Coefficients fall as exp(-1.9 c^(3/2)) at n = x + c x^(1/3). The usual end of the sums, c = 4 (W.
 * J. Wiscombe, Appl. Opt. 19, 1980), omits resonances of weakly absorbing spheres: 9e-6 of the
 * extinction for x = 100, m = 1.33 + 1e-5 i. Here c = 8, where coefficients are 1e-18. */
#include "truth/mie.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct multipoles {
    int count; /* orders 1..count; element 0 of a list is order 1 */
    double complex *a, *b;
    double complex *plus, *minus; /* (2 n + 1) / (n (n + 1)) times a + b and a - b */
    double *inverse;              /* 1 / n */
};

static enum neph_status create_multipoles(int count, struct multipoles *poles,
                                          struct neph_diag *diag)
{
    const size_t size = (size_t)count;
    double complex *lists = malloc(4 * size * sizeof(*lists));
    double *inverse = malloc(size * sizeof(*inverse));
    *poles = (struct multipoles){count,  lists, lists + size, lists + 2 * size, lists + 3 * size,
                                 inverse};
    return lists && inverse ? NEPH_OK : neph_fail_memory(diag);
}

static void finish_multipoles(struct multipoles *poles)
{
    free(poles->a);
    free(poles->inverse);
}

static int count_orders(double size_parameter)
{
    return (int)(size_parameter + 8.0 * cbrt(size_parameter) + 8.0);
}

/* D_n(z) for n = 0..count-1. The recurrence forgets its starting value 0 only where n exceeds |z|,
 * and within some |z|^(1/3) orders: started 16 orders above |z| the extinction of x = 10,000 is
 * wrong by 1e-4. */
static void compute_log_derivatives(double complex z, int count, double complex *derivative)
{
    const double highest = fmax((double)count, cabs(z) + 8.0 * cbrt(cabs(z))) + 16.0;
    double complex d = 0.0;
    for (int n = (int)highest; n > 0; n--) {
        const double complex ratio = (double)n / z;
        d = ratio - 1.0 / (d + ratio); /* D_(n-1) from D_n */
        if (n - 1 < count)
            derivative[n - 1] = d;
    }
}

/* psi_n / psi_(n-1) for n = 1..count, in ratios[n]. Downward as above. */
static void compute_psi_ratios(double x, int count, double *ratios)
{
    double ratio = 0.0;
    for (int n = count + 16; n > 0; n--) {
        ratio = 1.0 / ((2.0 * n + 1.0) / x - ratio);
        if (n <= count)
            ratios[n] = ratio;
    }
}

static void sum_multipoles(double x, double complex m, const double complex *derivative,
                           const double *ratios, struct multipoles *poles)
{
    double psi_before = cos(x), psi = sin(x), chi_before = -sin(x), chi = cos(x);
    for (int n = 1; n <= poles->count; n++) {
        const double step = (2.0 * n - 1.0) / x;
        const double psi_next = n > x ? psi * ratios[n] : step * psi - psi_before,
                     chi_next = step * chi - chi_before;
        const double complex xi = psi - I * chi, xi_next = psi_next - I * chi_next;
        const double complex electric = derivative[n] / m + n / x,
                             magnetic = derivative[n] * m + n / x;
        poles->a[n - 1] = (electric * psi_next - psi) / (electric * xi_next - xi);
        poles->b[n - 1] = (magnetic * psi_next - psi) / (magnetic * xi_next - xi);
        psi_before = psi, psi = psi_next, chi_before = chi, chi = chi_next;
    }
}

static void weigh_multipoles(struct multipoles *poles)
{
    for (int i = 0; i < poles->count; i++) {
        const double n = i + 1.0, weight = (2.0 * n + 1.0) / (n * (n + 1.0));
        poles->inverse[i] = 1.0 / n;
        poles->plus[i] = weight * (poles->a[i] + poles->b[i]);
        poles->minus[i] = weight * (poles->a[i] - poles->b[i]);
    }
}

static enum neph_status compute_multipoles(double x, double complex m, struct multipoles *poles,
                                           struct neph_diag *diag)
{
    const int count = count_orders(x);
    double complex *derivative = malloc((size_t)(count + 1) * sizeof(*derivative));
    double *ratios = malloc((size_t)(count + 1) * sizeof(*ratios));
    enum neph_status status = create_multipoles(count, poles, diag);
    if (!status && (!derivative || !ratios))
        status = neph_fail_memory(diag);
    if (!status) {
        compute_log_derivatives(m * x, count + 1, derivative);
        compute_psi_ratios(x, count, ratios);
        sum_multipoles(x, m, derivative, ratios, poles);
        weigh_multipoles(poles);
    }
    free(ratios);
    free(derivative);
    return status;
}

static double norm(double complex z)
{
    return creal(z) * creal(z) + cimag(z) * cimag(z);
}

/* Equations 4.61 and 4.62, and the asymmetry of section 4.5. */
static struct neph_mie_efficiency sum_efficiencies(double x, const struct multipoles *poles)
{
    double extinction = 0.0, scattering = 0.0, forward = 0.0;
    for (int i = 0; i < poles->count; i++) {
        const double n = i + 1.0;
        const double complex a = poles->a[i], b = poles->b[i];
        extinction += (2.0 * n + 1.0) * creal(a + b);
        scattering += (2.0 * n + 1.0) * (norm(a) + norm(b));
        forward += (2.0 * n + 1.0) / (n * (n + 1.0)) * creal(a * conj(b));
        if (i + 1 < poles->count)
            forward += n * (n + 2.0) / (n + 1.0) *
                       creal(a * conj(poles->a[i + 1]) + b * conj(poles->b[i + 1]));
    }
    return (struct neph_mie_efficiency){2.0 / (x * x) * extinction, 2.0 / (x * x) * scattering,
                                        2.0 * forward / scattering};
}

/* Angles that are computed together: the recurrence of one is a chain of dependent operations,
 * those of several overlap. */
enum { BLOCK = 8 };

/* Equation 4.74, with the angular functions pi_n and tau_n by upward recurrence (4.47). The sums
 * are S1 + S2 and S1 - S2, which need half the products: |S1|^2 + |S2|^2 is half of the sum of
 * their squares. */
static void compute_intensities(const double cosines[BLOCK], const struct multipoles *poles,
                                double intensities[BLOCK])
{
    double plus_re[BLOCK] = {0.0}, plus_im[BLOCK] = {0.0}, minus_re[BLOCK] = {0.0},
           minus_im[BLOCK] = {0.0}, pi_before[BLOCK] = {0.0}, pi_now[BLOCK];
    for (int b = 0; b < BLOCK; b++)
        pi_now[b] = 1.0;
    for (int i = 0; i < poles->count; i++) {
        const double n = i + 1.0, inverse = poles->inverse[i], p_re = creal(poles->plus[i]),
                     p_im = cimag(poles->plus[i]), m_re = creal(poles->minus[i]),
                     m_im = cimag(poles->minus[i]);
        for (int b = 0; b < BLOCK; b++) {
            const double part = cosines[b] * pi_now[b], rise = part - pi_before[b],
                         tau = n * rise - pi_before[b], sum = pi_now[b] + tau,
                         difference = pi_now[b] - tau;
            plus_re[b] += p_re * sum;
            plus_im[b] += p_im * sum;
            minus_re[b] += m_re * difference;
            minus_im[b] += m_im * difference;
            pi_before[b] = pi_now[b];
            pi_now[b] = part + rise + rise * inverse;
        }
    }
    for (int b = 0; b < BLOCK; b++)
        intensities[b] = 0.25 * (plus_re[b] * plus_re[b] + plus_im[b] * plus_im[b] +
                                 minus_re[b] * minus_re[b] + minus_im[b] * minus_im[b]);
}

/* The last block is filled up with its first angle. */
static void compute_angles(const double *cosines, int count, const struct multipoles *poles,
                           double *intensities)
{
    for (int i = 0; i < count; i += BLOCK) {
        const int filled = count - i < BLOCK ? count - i : BLOCK;
        double block[BLOCK], found[BLOCK];
        for (int b = 0; b < BLOCK; b++)
            block[b] = cosines[b < filled ? i + b : i];
        compute_intensities(block, poles, found);
        memcpy(intensities + i, found, (size_t)filled * sizeof(*found));
    }
}

static enum neph_status check(double x, double complex m, struct neph_diag *diag)
{
    if (!(x >= NEPH_MIE_SIZE_MIN && x <= NEPH_MIE_SIZE_MAX))
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "the size parameter 2 pi radius / wavelength is %g, not in %g..%g", x,
                         NEPH_MIE_SIZE_MIN, NEPH_MIE_SIZE_MAX);
    if (!(creal(m) > 0.0 && cimag(m) >= 0.0 && cabs(m) <= NEPH_MIE_INDEX_MAX))
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "the refractive index is %g + %g i: n is above 0, k at least 0, and the "
                         "modulus at most %g",
                         creal(m), cimag(m), NEPH_MIE_INDEX_MAX);
    return NEPH_OK;
}

enum neph_status neph_mie_sphere(double size_parameter, double complex index, int angle_count,
                                 const double *cosines, struct neph_mie_efficiency *efficiency,
                                 double *intensities, struct neph_diag *diag)
{
    struct multipoles poles = {.count = 0};
    enum neph_status status = check(size_parameter, index, diag);
    if (!status)
        status = compute_multipoles(size_parameter, index, &poles, diag);
    if (!status) {
        *efficiency = sum_efficiencies(size_parameter, &poles);
        compute_angles(cosines, angle_count, &poles, intensities);
    }
    finish_multipoles(&poles);
    return status;
}
