/* The plant of a satellite that stops its tumble by B-dot, in plain C: a yardstick for the compiled Python, of the same
 * arithmetic. benchmarks/plant.py builds and calls it, with LANES = 1 (scalar) and with LANES = 8 (a satellite in every
 * lane of a vector).
 *
 *   dr/dt = v, dv/dt = g(r) (point and J2), dsigma/dt = dexp^-1(sigma) omega, I domega/dt = N - omega x I omega
 *   N = (m + m_residual) x B + 3 GM / r^5 r x I r;   m = clip(-k / B^2 dB/dt) from readings a step apart
 *
 * by the classical Runge-Kutta rule with q1 = q0 exp(sigma / 2), the harmonic field summed at every stage.
 */
#include <math.h>
#include <stddef.h>

#ifndef LANES
#define LANES 1
#endif
#if LANES == 1
typedef double real;
#define LANE(x, l) (x)
#else
typedef double real __attribute__((vector_size(8 * LANES)));
#define LANE(x, l) ((x)[l])
#endif
#define EACH for (int l = 0; l < LANES; l++)

typedef struct { real v[3]; } vector;
typedef struct { real v[4]; } quaternion;
typedef struct { double m[9]; } matrix;
typedef struct { vector r, v, sigma, omega; } motion;

typedef struct {
    double gm, j2, oblate_radius, field_radius;
    const double *recursion, *table;    /* of fieldline.environment.harmonics */
    double era_start, era_rate, node_step;
    const double *nodes;                /* (n, 9) of fieldline.environment.ephemeris */
    double inertia[9], inverse[9], residual[3];
    double gain, moment_max, gradient;  /* gradient: 0 or 1 */
    ptrdiff_t degree, order, node_count, hold; /* hold: the field once a step */
} plant;

static const vector NOTHING; /* zero */

static inline real even(double x) { return (real){0} + x; }

static inline real root(real a)
{
    EACH LANE(a, l) = sqrt(LANE(a, l));
    return a;
}

static inline vector scaled(real s, vector a) { return (vector){{s * a.v[0], s * a.v[1], s * a.v[2]}}; }
static inline vector plus(vector a, vector b) { return (vector){{a.v[0] + b.v[0], a.v[1] + b.v[1], a.v[2] + b.v[2]}}; }
static inline vector minus(vector a, vector b) { return (vector){{a.v[0] - b.v[0], a.v[1] - b.v[1], a.v[2] - b.v[2]}}; }
static inline real dot(vector a, vector b) { return a.v[0] * b.v[0] + a.v[1] * b.v[1] + a.v[2] * b.v[2]; }

static inline vector cross(vector a, vector b)
{
    return (vector){{a.v[1] * b.v[2] - a.v[2] * b.v[1], a.v[2] * b.v[0] - a.v[0] * b.v[2], a.v[0] * b.v[1] - a.v[1] * b.v[0]}};
}

static inline vector turned(const double *m, vector a)
{
    return (vector){{m[0] * a.v[0] + m[1] * a.v[1] + m[2] * a.v[2], m[3] * a.v[0] + m[4] * a.v[1] + m[5] * a.v[2],
                     m[6] * a.v[0] + m[7] * a.v[1] + m[8] * a.v[2]}};
}

static inline vector turned_back(const double *m, vector a)
{
    return (vector){{m[0] * a.v[0] + m[3] * a.v[1] + m[6] * a.v[2], m[1] * a.v[0] + m[4] * a.v[1] + m[7] * a.v[2],
                     m[2] * a.v[0] + m[5] * a.v[1] + m[8] * a.v[2]}};
}

static inline quaternion product(quaternion p, quaternion q)
{
    return (quaternion){{p.v[3] * q.v[0] + p.v[0] * q.v[3] + p.v[1] * q.v[2] - p.v[2] * q.v[1],
                         p.v[3] * q.v[1] - p.v[0] * q.v[2] + p.v[1] * q.v[3] + p.v[2] * q.v[0],
                         p.v[3] * q.v[2] + p.v[0] * q.v[1] - p.v[1] * q.v[0] + p.v[2] * q.v[3],
                         p.v[3] * q.v[3] - p.v[0] * q.v[0] - p.v[1] * q.v[1] - p.v[2] * q.v[2]}};
}

/* sin(|a|/2)/|a|, cos(|a|/2) and the coefficient of dexp^-1, of |a|^2 < 1: by the library for one satellite, by series,
 * exact to rounding, for many. */
#if LANES == 1
static inline void half_angle(real square, real *sine, real *cosine)
{
    if (square < 1e-8) {
        *sine = 0.5 - square / 48.0;
        *cosine = 1.0 - square / 8.0;
        return;
    }
    double size = sqrt(square);
    *sine = sin(0.5 * size) / size;
    *cosine = cos(0.5 * size);
}

static inline real bend(real square)
{
    if (square < 1e-4) return 1.0 / 12.0 + square / 720.0 + square * square / 30240.0;
    double half = 0.5 * sqrt(square);
    return (1.0 - half / tan(half)) / square;
}
#else
static inline void half_angle(real square, real *sine, real *cosine)
{
    real x = 0.25 * square, s = even(1.0), c = even(1.0);
    for (int k = 8; k > 0; k--) {
        s = 1.0 - x * s * (1.0 / (2.0 * k * (2.0 * k + 1.0)));
        c = 1.0 - x * c * (1.0 / (2.0 * k * (2.0 * k - 1.0)));
    }
    *sine = 0.5 * s;
    *cosine = c;
}

static inline real bend(real square)
{
    static const double term[] = {1.0 / 12,          1.0 / 720,           1.0 / 30240,           1.0 / 1209600,
                                  1.0 / 47900160,    691.0 / 1307674368000, 1.0 / 74724249600.0, 3617.0 / 10670622842880000.0,
                                  43867.0 / 5109094217170944000.0};
    real sum = even(term[8]);
    for (int k = 7; k >= 0; k--) sum = sum * square + term[k];
    return sum;
}
#endif

static inline quaternion exponential(vector a)
{
    real s, c;
    half_angle(dot(a, a), &s, &c);
    return (quaternion){{s * a.v[0], s * a.v[1], s * a.v[2], c}};
}

static inline vector to_body(quaternion q, vector a)
{
    vector v = {{q.v[0], q.v[1], q.v[2]}};
    vector t = scaled(even(2.0), cross(v, a));
    return plus(minus(a, scaled(q.v[3], t)), cross(v, t));
}

/* The Earth's attitude at t, the same for all satellites. */
static matrix earth(double t, const plant *p)
{
    double place = fmin(fmax(t / p->node_step + 1.0, 0.0), p->node_count - 1.0);
    long k = (long)place;
    k = k < 1 ? 1 : k > p->node_count - 3 ? p->node_count - 3 : k;
    double u = place - k, below = u + 1.0, above = u - 1.0, far = u - 2.0;
    double w[4] = {-u * above * far / 6.0, 0.5 * below * above * far, -0.5 * below * u * far, below * u * above / 6.0}, n[9];
    const double *row = p->nodes + 9 * (k - 1);
    for (int j = 0; j < 9; j++) n[j] = w[0] * row[j] + w[1] * row[9 + j] + w[2] * row[18 + j] + w[3] * row[27 + j];
    double angle = p->era_start + p->era_rate * t, c = cos(angle), s = sin(angle);
    return (matrix){{c * n[0] + s * n[3], c * n[1] + s * n[4], c * n[2] + s * n[5], c * n[3] - s * n[0], c * n[4] - s * n[1],
                     c * n[5] - s * n[2], n[6], n[7], n[8]}};
}

static inline vector field(vector r, const plant *p)
{
    real ratio = p->field_radius / dot(r, r);
    real s = ratio * r.v[0], t = ratio * r.v[1], u = ratio * r.v[2];
    real square = ratio * p->field_radius, first = root(square), cosine = even(1.0), sine = {0};
    vector b = NOTHING;
    const double *c = p->recursion, *k = p->table;
    for (long m = 0; m <= p->order; m++) {
        real below = {0}, here = first, sum[6];
        for (int j = 0; j < 6; j++) sum[j] = (real){0};
        for (long n = m; n <= p->degree; n++, c += 2, k += 6) {
            for (int j = 0; j < 6; j++) sum[j] += k[j] * here;
            real next = c[0] * u * here - c[1] * square * below;
            below = here;
            here = next;
        }
        for (int j = 0; j < 3; j++) b.v[j] += cosine * sum[2 * j] + sine * sum[2 * j + 1];
        real turned_cosine = cosine * s - sine * t;
        sine = cosine * t + sine * s;
        cosine = turned_cosine;
    }
    return b;
}

static inline vector gravity(vector r, const plant *p)
{
    real square = dot(r, r), inverse = p->gm / (square * root(square));
    real flat = 1.5 * p->j2 * p->oblate_radius * p->oblate_radius / square, polar = 5.0 * r.v[2] * r.v[2] / square;
    real across = -inverse * (1.0 + flat * (1.0 - polar));
    return (vector){{across * r.v[0], across * r.v[1], -inverse * (1.0 + flat * (3.0 - polar)) * r.v[2]}};
}

static motion rates(double t, motion z, quaternion start, vector moment, const vector *held, const plant *p)
{
    matrix e = earth(t, p);
    vector r_e = turned(e.m, z.r), sigma = z.sigma, omega = z.omega;
    quaternion q = product(start, exponential(sigma));
    vector field_b = to_body(q, held ? *held : turned_back(e.m, field(r_e, p)));
    for (int j = 0; j < 3; j++) moment.v[j] += p->residual[j];
    vector torque = cross(moment, field_b);
    if (p->gradient != 0.0) {
        vector r_b = to_body(q, z.r);
        real square = dot(r_b, r_b), factor = 3.0 * p->gm / (square * square * root(square));
        torque = plus(torque, scaled(factor, cross(r_b, turned(p->inertia, r_b))));
    }
    vector twist = cross(sigma, omega), change;
    change = plus(omega, plus(scaled(even(0.5), twist), scaled(bend(dot(sigma, sigma)), cross(sigma, twist))));
    torque = minus(torque, cross(omega, turned(p->inertia, omega)));
    return (motion){z.v, turned_back(e.m, gravity(r_e, p)), change, turned(p->inverse, torque)};
}

static inline motion along(motion z, double h, motion k)
{
    real s = even(h);
    return (motion){plus(z.r, scaled(s, k.r)), plus(z.v, scaled(s, k.v)), plus(z.sigma, scaled(s, k.sigma)),
                    plus(z.omega, scaled(s, k.omega))};
}

static void step(double t, double h, motion *z, quaternion *q, vector moment, const plant *p)
{
    vector middle, *held = NULL;
    if (p->hold) {
        double square_half = 0.125 * h * h;
        real square = dot(z->r, z->r);
        vector fall = scaled(-p->gm / (square * root(square)), z->r);
        matrix e = earth(t + 0.5 * h, p);
        middle = plus(plus(z->r, scaled(even(0.5 * h), z->v)), scaled(even(square_half), fall));
        middle = turned_back(e.m, field(turned(e.m, middle), p));
        held = &middle;
    }
    for (int j = 0; j < 3; j++) z->sigma.v[j] = (real){0};
    motion k1 = rates(t, *z, *q, moment, held, p);
    motion k2 = rates(t + 0.5 * h, along(*z, 0.5 * h, k1), *q, moment, held, p);
    motion k3 = rates(t + 0.5 * h, along(*z, 0.5 * h, k2), *q, moment, held, p);
    motion k4 = rates(t + h, along(*z, h, k3), *q, moment, held, p);
    *z = along(along(along(along(*z, h / 6.0, k1), h / 3.0, k2), h / 3.0, k3), h / 6.0, k4);
    quaternion q1 = product(*q, exponential(z->sigma));
    real size = root(q1.v[0] * q1.v[0] + q1.v[1] * q1.v[1] + q1.v[2] * q1.v[2] + q1.v[3] * q1.v[3]);
    for (int j = 0; j < 4; j++) q->v[j] = q1.v[j] / size;
}

/* B-dot on readings `period` apart, limited. */
static vector command(vector now, vector before, double period, const plant *p)
{
    real gain = -p->gain / (period * dot(now, now));
    vector m = scaled(gain, minus(now, before));
    for (int j = 0; j < 3; j++)
        EACH LANE(m.v[j], l) = fmin(fmax(LANE(m.v[j], l), -p->moment_max), p->moment_max);
    return m;
}

/* y: (13, LANES) r, v, q, omega, in place; a law call every step of h seconds, the first without a reading before it. */
void fly(double *y, long steps, double h, const plant *p)
{
    motion z;
    quaternion q;
    vector before = NOTHING;
    real *at[13] = {z.r.v, z.r.v + 1, z.r.v + 2, z.v.v, z.v.v + 1, z.v.v + 2, q.v, q.v + 1, q.v + 2, q.v + 3,
                    z.omega.v, z.omega.v + 1, z.omega.v + 2};
    for (int j = 0; j < 13; j++)
        EACH LANE(*at[j], l) = y[j * LANES + l];
    for (long i = 0; i < steps; i++) {
        double t = i * h;
        matrix e = earth(t, p);
        vector now = to_body(q, turned_back(e.m, field(turned(e.m, z.r), p))), moment = NOTHING;
        if (i > 0) moment = command(now, before, h, p);
        before = now;
        step(t, h, &z, &q, moment, p);
    }
    for (int j = 0; j < 13; j++)
        EACH y[j * LANES + l] = LANE(*at[j], l);
}
