/* The filter of fieldline/estimation/kalman.py in plain C: attitude and rate from one vector a sample, rate a random walk,
 * no coloured error. A yardstick for the compiled Python; benchmarks/filter.py builds and calls it.
 *
 *   state q (scalar last), w;  P = [[aa, ar], [ar^T, rr]];  H = [[A B_i x], 0];  R = r^2 I + t^2 (w x b)(w x b)^T
 */
#include <math.h>
#include <stdbool.h>

typedef struct { double v[3]; } vector;
typedef struct { double v[4]; } quaternion;
typedef struct { double m[3][3]; } matrix;

static const matrix IDENTITY = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

static inline double dot(vector a, vector b) { return a.v[0] * b.v[0] + a.v[1] * b.v[1] + a.v[2] * b.v[2]; }

static inline vector cross(vector a, vector b)
{
    return (vector){{a.v[1] * b.v[2] - a.v[2] * b.v[1], a.v[2] * b.v[0] - a.v[0] * b.v[2], a.v[0] * b.v[1] - a.v[1] * b.v[0]}};
}

static inline vector along(double s, vector a, vector b)
{
    return (vector){{s * a.v[0] + b.v[0], s * a.v[1] + b.v[1], s * a.v[2] + b.v[2]}};
}

static inline matrix product(matrix a, matrix b)
{
    matrix c;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            c.m[i][j] = a.m[i][0] * b.m[0][j] + a.m[i][1] * b.m[1][j] + a.m[i][2] * b.m[2][j];
    return c;
}

static inline matrix transpose(matrix a)
{
    matrix c;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) c.m[i][j] = a.m[j][i];
    return c;
}

static inline matrix sum(matrix a, double s, matrix b)
{
    matrix c;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) c.m[i][j] = a.m[i][j] + s * b.m[i][j];
    return c;
}

static inline matrix symmetric(matrix a)
{
    matrix c;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) c.m[i][j] = 0.5 * (a.m[i][j] + a.m[j][i]);
    return c;
}

static inline vector turned(matrix a, vector b)
{
    vector c;
    for (int i = 0; i < 3; i++) c.v[i] = a.m[i][0] * b.v[0] + a.m[i][1] * b.v[1] + a.m[i][2] * b.v[2];
    return c;
}

static inline matrix skew(vector a) { return (matrix){{{0, -a.v[2], a.v[1]}, {a.v[2], 0, -a.v[0]}, {-a.v[1], a.v[0], 0}}}; }

static inline double determinant(matrix a)
{
    return a.m[0][0] * (a.m[1][1] * a.m[2][2] - a.m[1][2] * a.m[2][1]) - a.m[0][1] * (a.m[1][0] * a.m[2][2] - a.m[1][2] * a.m[2][0])
           + a.m[0][2] * (a.m[1][0] * a.m[2][1] - a.m[1][1] * a.m[2][0]);
}

static inline matrix inverse(matrix a)
{
    double s = 1.0 / determinant(a);
    matrix c;
    for (int i = 0; i < 3; i++) {
        int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
        for (int j = 0; j < 3; j++) {
            int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            c.m[j][i] = s * (a.m[i1][j1] * a.m[i2][j2] - a.m[i1][j2] * a.m[i2][j1]);
        }
    }
    return c;
}

static inline quaternion hamilton(quaternion p, quaternion q)
{
    return (quaternion){{p.v[3] * q.v[0] + p.v[0] * q.v[3] + p.v[1] * q.v[2] - p.v[2] * q.v[1],
                         p.v[3] * q.v[1] - p.v[0] * q.v[2] + p.v[1] * q.v[3] + p.v[2] * q.v[0],
                         p.v[3] * q.v[2] + p.v[0] * q.v[1] - p.v[1] * q.v[0] + p.v[2] * q.v[3],
                         p.v[3] * q.v[3] - p.v[0] * q.v[0] - p.v[1] * q.v[1] - p.v[2] * q.v[2]}};
}

static inline quaternion unit(quaternion q)
{
    double s = 1.0 / sqrt(q.v[0] * q.v[0] + q.v[1] * q.v[1] + q.v[2] * q.v[2] + q.v[3] * q.v[3]);
    return (quaternion){{s * q.v[0], s * q.v[1], s * q.v[2], s * q.v[3]}};
}

/* the unit quaternion of a rotation vector */
static inline quaternion turn(vector a)
{
    double square = dot(a, a);
    if (square < 1e-8) {
        double s = 0.5 - square / 48.0;
        return unit((quaternion){{s * a.v[0], s * a.v[1], s * a.v[2], 1.0 - square / 8.0}});
    }
    double size = sqrt(square), s = sin(0.5 * size) / size;
    return (quaternion){{s * a.v[0], s * a.v[1], s * a.v[2], cos(0.5 * size)}};
}

/* v_b = A(q) v_i */
static inline matrix dcm(quaternion q)
{
    double x = q.v[0], y = q.v[1], z = q.v[2], w = q.v[3];
    return (matrix){{{w * w + x * x - y * y - z * z, 2 * (x * y + w * z), 2 * (x * z - w * y)},
                     {2 * (x * y - w * z), w * w - x * x + y * y - z * z, 2 * (y * z + w * x)},
                     {2 * (x * z + w * y), 2 * (y * z - w * x), w * w - x * x - y * y + z * z}}};
}

/* Filter n samples. start (7): q, w; prior (27): aa, ar, rr; both at the first sample, left at the last. states (n, 7) may be
 * null. Returns the log-likelihood. */
double filter_forward(int n, const double *seconds, const double *field_b, const double *field_i, const bool *used, double white,
                      double jitter, double gate, double walk, double *start, double *prior, double *states)
{
    quaternion q = {{start[0], start[1], start[2], start[3]}};
    vector w = {{start[4], start[5], start[6]}};
    matrix aa, ar, rr;
    for (int j = 0; j < 9; j++) {
        aa.m[j / 3][j % 3] = prior[j];
        ar.m[j / 3][j % 3] = prior[9 + j];
        rr.m[j / 3][j % 3] = prior[18 + j];
    }
    double total = 0.0;
    for (int k = 0; k < n; k++) {
        if (k > 0) {
            double h = seconds[k] - seconds[k - 1];
            quaternion half = turn((vector){{0.5 * h * w.v[0], 0.5 * h * w.v[1], 0.5 * h * w.v[2]}});
            quaternion full = hamilton(half, half);
            matrix phi = dcm(full), psi = sum(sum(IDENTITY, 4.0, dcm(half)), 1.0, phi);
            for (int j = 0; j < 9; j++) psi.m[j / 3][j % 3] *= h / 6.0;
            q = unit(hamilton(q, full));
            double s2 = walk * walk;
            matrix phi_t = transpose(phi), psi_t = transpose(psi);
            matrix left = sum(product(phi, aa), 1.0, product(psi, transpose(ar)));
            matrix right = sum(product(phi, ar), 1.0, product(psi, rr));
            aa = symmetric(sum(sum(product(left, phi_t), 1.0, product(right, psi_t)), s2 * h * h * h / 3.0, IDENTITY));
            ar = sum(right, 0.5 * s2 * h * h, IDENTITY);
            rr = symmetric(sum(rr, s2 * h, IDENTITY));
        }
        if (used[k]) {
            vector reference = {{field_i[3 * k], field_i[3 * k + 1], field_i[3 * k + 2]}};
            vector body = turned(dcm(q), reference), u = cross(w, body), residual, z;
            for (int j = 0; j < 3; j++) residual.v[j] = field_b[3 * k + j] - body.v[j];
            matrix h = skew(body), h_t = transpose(h), r;
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 3; j++) r.m[i][j] = jitter * jitter * u.v[i] * u.v[j] + (i == j) * white * white;
            matrix ga = product(aa, h_t), gr = product(transpose(ar), h_t);
            matrix s = symmetric(sum(product(h, ga), 1.0, r));
            double a = sqrt(s.m[0][0]), b = s.m[1][0] / a, c = s.m[2][0] / a, d = sqrt(s.m[1][1] - b * b);
            double e = (s.m[2][1] - b * c) / d, f = sqrt(s.m[2][2] - c * c - e * e);
            z.v[0] = residual.v[0] / a;
            z.v[1] = (residual.v[1] - b * z.v[0]) / d;
            z.v[2] = (residual.v[2] - c * z.v[0] - e * z.v[1]) / f;
            double nis = dot(z, z), cost = nis;
            if (nis > gate) {
                cost = gate * (1.0 + log(nis / gate));
                s = sum(s, nis / gate - 1.0, r);
            }
            matrix s_inv = symmetric(inverse(s)), ka = product(ga, s_inv), kr = product(gr, s_inv);
            total -= 0.5 * (cost + log(determinant(s)) + 3.0 * log(2.0 * M_PI));
            vector gained = turned(s_inv, residual);
            q = unit(hamilton(q, turn(turned(ga, gained))));
            w = along(1.0, turned(gr, gained), w);
            aa = symmetric(sum(aa, -1.0, product(ka, transpose(ga))));
            ar = sum(ar, -1.0, product(ka, transpose(gr)));
            rr = symmetric(sum(rr, -1.0, product(kr, transpose(gr))));
            if (!isfinite(total)) return -INFINITY;
        }
        if (states) {
            for (int j = 0; j < 4; j++) states[7 * k + j] = q.v[j];
            for (int j = 0; j < 3; j++) states[7 * k + 4 + j] = w.v[j];
        }
    }
    for (int j = 0; j < 4; j++) start[j] = q.v[j];
    for (int j = 0; j < 3; j++) start[4 + j] = w.v[j];
    for (int j = 0; j < 9; j++) {
        prior[j] = aa.m[j / 3][j % 3];
        prior[9 + j] = ar.m[j / 3][j % 3];
        prior[18 + j] = rr.m[j / 3][j % 3];
    }
    return total;
}
