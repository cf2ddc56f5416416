/* A line with nodes between two point masses in orbit, in plain C: a yardstick for the compiled Python, of the same
 * arithmetic. benchmarks/line.py builds and calls it.
 *
 *   m_j dv_j/dt = -GM m_j r_j / |r_j|^3 + T_j e_j - T_(j-1) e_(j-1),    T = max(0, (EA (l - l0) + c dl/dt) / l0) where l > l0
 *
 * by the classical Runge-Kutta rule. y: places and velocities of all points, six numbers each, from end to end.
 */
#include <math.h>

#define MOST 1100

typedef struct {
    double gm, rest, stiffness, damping;
    const double *mass; /* of each point */
    long points;
} line;

static void rates(const double *restrict y, const line *restrict p, double *restrict out)
{
    double behind[3] = {0.0, 0.0, 0.0};
    for (long i = 0; i < p->points; i++) {
        const double *a = y + 6 * i;
        double *rate = out + 6 * i, ahead[3] = {0.0, 0.0, 0.0};
        if (i + 1 < p->points) {
            const double *b = a + 6;
            double d[3], w[3], square = 0.0, product = 0.0;
            for (int k = 0; k < 3; k++) {
                d[k] = b[k] - a[k];
                w[k] = b[3 + k] - a[3 + k];
                square += d[k] * d[k];
                product += d[k] * w[k];
            }
            double length = sqrt(square);
            if (length > p->rest) {
                double tension = (p->stiffness * (length - p->rest) + p->damping * product / length) / p->rest;
                double pull = fmax(0.0, tension) / length;
                for (int k = 0; k < 3; k++) ahead[k] = pull * d[k];
            }
        }
        double square = a[0] * a[0] + a[1] * a[1] + a[2] * a[2];
        double weight = p->gm / (square * sqrt(square)), inverse = 1.0 / p->mass[i];
        for (int k = 0; k < 3; k++) {
            rate[k] = a[3 + k];
            rate[3 + k] = inverse * (ahead[k] - behind[k]) - weight * a[k];
            behind[k] = ahead[k];
        }
    }
}

void fly(double *restrict y, long steps, double h, const line *p)
{
    static double k1[6 * MOST], k2[6 * MOST], k3[6 * MOST], k4[6 * MOST], stage[6 * MOST];
    long n = 6 * p->points;
    for (long s = 0; s < steps; s++) {
        rates(y, p, k1);
        for (long i = 0; i < n; i++) stage[i] = y[i] + 0.5 * h * k1[i];
        rates(stage, p, k2);
        for (long i = 0; i < n; i++) stage[i] = y[i] + 0.5 * h * k2[i];
        rates(stage, p, k3);
        for (long i = 0; i < n; i++) stage[i] = y[i] + h * k3[i];
        rates(stage, p, k4);
        for (long i = 0; i < n; i++) y[i] += h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
    }
}
