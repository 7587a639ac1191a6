/* SPDX-License-Identifier: MIT
 *
 * Adaptive Gauss-Kronrod quadrature of three functions at once (the colour channels), and a fixed
 * rule for one.
 */
#ifndef NEPH_SCENES_QUADRATURE_H
#define NEPH_SCENES_QUADRATURE_H

/* Evaluate the integrand at x into value[3]. */
typedef void neph_integrand(double x, void *context, double value[3]);

struct neph_interval {
    double low, high;
};

/* Integrate over the union of the pieces with the 10/21-point Gauss-Kronrod pair (Piessens et al.,
 * QUADPACK, 1983), halving each until its estimated error is below 1e-13 of the whole, or 20
 * times. The integrand should be analytic on each piece. Returns the sum of the estimated absolute
 * errors, worst channel. */
double neph_integrate(neph_integrand *integrand, void *context, const struct neph_interval *pieces,
                      int piece_count, double result[3]);

/* neph_integrate() for integrands with kinks inside their pieces: bisection ends at `tolerance` of
 * the whole, and errors are estimated for the 10-point rule, because QUADPACK's estimate for the
 * better rule is valid only for smooth integrands. */
double neph_integrate_rough(neph_integrand *integrand, void *context,
                            const struct neph_interval *pieces, int piece_count, double tolerance,
                            double result[3]);

/* A fixed rule: 20-point Gauss-Legendre over [a, b], exact for polynomials of degree 39. For smooth
 * integrands: e^-x over 14 units of x is exact up to rounding. */
double neph_gauss(double (*integrand)(double x, const void *context), const void *context, double a,
                  double b);

#endif
