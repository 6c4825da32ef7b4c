/* Euler's step with the isotropy correction of order 2 for the free rigid body on S^2, written by hand.

   xi = h (-I m + s m) with s = <X, I X>/<X, X>, X = m x I m = (-I m) x m;  m <- exp(xi) m by Rodrigues' formula with
   sin(r)/r and (1 - cos r)/r^2 as power series in r^2, for steps that turn by less than one radian.
   Structure of arrays: x[i * lanes + lane]; all steps of a block of lanes before the next block. */
#include <stddef.h>

#define BLOCK 16

void steps(double *x, size_t lanes, long count, double h, double a, double b, double c) {
    for (size_t first = 0; first < lanes; first += BLOCK) {
        double m0[BLOCK], m1[BLOCK], m2[BLOCK];
        for (int k = 0; k < BLOCK; k++) {
            m0[k] = x[first + k];
            m1[k] = x[lanes + first + k];
            m2[k] = x[2 * lanes + first + k];
        }
        for (long n = 0; n < count; n++) {
#pragma GCC ivdep
            for (int k = 0; k < BLOCK; k++) {
                double p = m0[k], q = m1[k], r = m2[k];
                double w0 = a * p, w1 = b * q, w2 = c * r;
                double X0 = q * w2 - r * w1, X1 = r * w0 - p * w2, X2 = p * w1 - q * w0;
                double v = X0 * X0 + X1 * X1 + X2 * X2;
                double u = a * X0 * X0 + b * X1 * X1 + c * X2 * X2;
                double s = u / (v + 1e-300);
                double e0 = h * (s * p - w0), e1 = h * (s * q - w1), e2 = h * (s * r - w2);
                double t = e0 * e0 + e1 * e1 + e2 * e2;
                double S = 1 + t * (-1. / 6 + t * (1. / 120 + t * (-1. / 5040 + t * (1. / 362880 +
                           t * (-1. / 39916800 + t * (1. / 6227020800. - t / 1307674368000.))))));
                double C = 0.5 + t * (-1. / 24 + t * (1. / 720 + t * (-1. / 40320 + t * (1. / 3628800 +
                           t * (-1. / 479001600 + t * (1. / 87178291200. - t / 20922789888000.))))));
                double Y0 = h * X0, Y1 = h * X1, Y2 = h * X2; /* xi x m: the part along m does not move m */
                m0[k] = p + S * Y0 + C * (e1 * Y2 - e2 * Y1);
                m1[k] = q + S * Y1 + C * (e2 * Y0 - e0 * Y2);
                m2[k] = r + S * Y2 + C * (e0 * Y1 - e1 * Y0);
            }
        }
        for (int k = 0; k < BLOCK; k++) {
            x[first + k] = m0[k];
            x[lanes + first + k] = m1[k];
            x[2 * lanes + first + k] = m2[k];
        }
    }
}
