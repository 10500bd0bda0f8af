// How fast the Stewart platform can be at all: everything known in advance, written out by hand.
//
// From the pose of the platform alone, in closed form: the inverse Jacobian (row i: unit vector s of leg i and
// its moment r x s about the reference point), its singular value decomposition by one-sided Jacobi, the kinematic
// efficiencies 1/sigma^2 in descending order with their axes (twists and motor rates), the force efficiencies
// sigma^2 in descending order.  Unit weights: the axes of forces are those of motions, in reverse order.  Sixteen
// configurations at once in vector registers, a thread a core.  No checks, no rank decisions, no other mechanism.
//
// A configuration gives 84 numbers: 6 kinematic, 6 force efficiencies, 6 x 6 twists, 6 x 6 motor rates (rows).
// With `both` there are 156: force axes too (6 x 6 wrenches, 6 x 6 torques), although they are the same vectors.
//
//     g++ -O3 -march=native -ffp-contract=fast -std=c++17 -shared -fPIC -pthread floor.cpp -o floor.so

#include <algorithm>
#include <cmath>
#include <cstring>
#include <thread>
#include <vector>
#ifdef __AVX512F__
#include <immintrin.h>
#endif

namespace {

constexpr int W = 8;   // lanes of one register
constexpr int H = 2;   // registers worked on side by side: hides latencies
constexpr int B = W * H;
constexpr int LEGS = 6;
constexpr int ROWS = 12;   // of a column: 6 of A V, then 6 of V
constexpr double DONE = 1e-29;   // squared cosine of two columns that count as orthogonal

typedef double Lanes __attribute__((vector_size(8 * W)));
typedef long long Bits __attribute__((vector_size(8 * W)));

inline Lanes all(double x) { return Lanes{} + x; }
inline Lanes choose(Bits mask, Lanes yes, Lanes no) { return mask ? yes : no; }
inline Lanes magnitude(Lanes x) { return choose(x < 0.0, -x, x); }

inline bool any(Bits mask) {
#ifdef __AVX512F__
    return _mm512_test_epi64_mask((__m512i)mask, (__m512i)mask) != 0;
#else
    long long found = 0;
    for (int l = 0; l < W; l++) found |= mask[l];
    return found != 0;
#endif
}

// 1 / sqrt(x): estimate of the processor and two Newton steps.
inline Lanes inverse_root(Lanes x) {
#ifdef __AVX512F__
    Lanes y = (Lanes)_mm512_rsqrt14_pd((__m512d)x);
    for (int k = 0; k < 2; k++) y += 0.5 * y * (1.0 - x * y * y);
    return y;
#else
    Lanes y;
    for (int l = 0; l < W; l++) y[l] = 1.0 / std::sqrt(x[l]);
    return y;
#endif
}

// Columns of A (6 x 6, then V below): 12 rows, H registers each.
struct Block {
    Lanes column[LEGS][ROWS][H];
    Lanes norm[LEGS][H];
};

struct Geometry {
    double base[LEGS][3], platform[LEGS][3];
};

void inverse_jacobian(const Geometry& g, const double* poses, Block& b) {
    Lanes pose[7][H];
    for (int l = 0; l < B; l++)
        for (int k = 0; k < 7; k++) pose[k][l / W][l % W] = poses[7 * l + k];
    for (int h = 0; h < H; h++) {
        const Lanes w = pose[3][h], x = pose[4][h], y = pose[5][h], z = pose[6][h];
        const Lanes r[3][3] = {
            {1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)},
            {2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)},
            {2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)}};
        for (int leg = 0; leg < LEGS; leg++) {
            const double* a = g.platform[leg];
            Lanes arm[3], s[3];
            for (int k = 0; k < 3; k++) {
                arm[k] = r[k][0] * a[0] + r[k][1] * a[1] + r[k][2] * a[2];
                s[k] = arm[k] + pose[k][h] - g.base[leg][k];
            }
            const Lanes inverse = inverse_root(s[0] * s[0] + s[1] * s[1] + s[2] * s[2]);
            for (int k = 0; k < 3; k++) s[k] *= inverse;
            // Rows of the inverse Jacobian are stored as columns here: Jacobi on its transpose.
            Lanes(*c)[H] = b.column[leg];
            for (int k = 0; k < 3; k++) c[k][h] = s[k];
            c[3][h] = arm[1] * s[2] - arm[2] * s[1];
            c[4][h] = arm[2] * s[0] - arm[0] * s[2];
            c[5][h] = arm[0] * s[1] - arm[1] * s[0];
            for (int k = 0; k < 6; k++) c[6 + k][h] = all(k == leg ? 1.0 : 0.0);
        }
    }
}

// One rotation of columns p < q; returns whether any lane needed it.  The larger column ends at p.
inline bool rotate(Block& b, int p, int q) {
    Lanes g[H];
    Bits big[H], swap[H];
    bool needed = false;
    for (int h = 0; h < H; h++) {
        g[h] = b.column[p][0][h] * b.column[q][0][h];
        for (int k = 1; k < 6; k++) g[h] += b.column[p][k][h] * b.column[q][k][h];
        const Lanes one = b.norm[p][h], two = b.norm[q][h];
        big[h] = g[h] * g[h] > DONE * one * two;
        swap[h] = two > one;
        needed |= any(big[h] | swap[h]);
    }
    if (!needed) return false;
    for (int h = 0; h < H; h++) {
        const Lanes one = b.norm[p][h], two = b.norm[q][h], d = two - one, g2 = g[h] + g[h];
        const Lanes radius = d * d + g2 * g2;
        const Bits turn = big[h] & (radius > 1e-290);
        const Lanes inverse = inverse_root(radius);
        const Lanes cosine2 = 0.5 * magnitude(d) * inverse + 0.5;
        const Lanes root = inverse_root(cosine2);
        const Lanes c = choose(turn, cosine2 * root, all(1.0));
        const Lanes s = choose(turn, 0.5 * g2 * inverse * root, all(0.0));
        const Lanes cc = choose(swap[h], s, c), ss = choose(swap[h], -c, -s);
        const Lanes grown = s * root * g[h];
        b.norm[p][h] = choose(swap[h], two, one) + choose(turn, grown, all(0.0));
        b.norm[q][h] = choose(swap[h], one, two) - choose(turn, grown, all(0.0));
        for (int k = 0; k < ROWS; k++) {
            const Lanes x = b.column[p][k][h], y = b.column[q][k][h];
            b.column[p][k][h] = cc * x - ss * y;
            b.column[q][k][h] = ss * x + cc * y;
        }
    }
    return true;
}

void decompose(Block& b) {
    for (int sweep = 0; sweep < 12; sweep++) {
        for (int p = 0; p < LEGS; p++)
            for (int h = 0; h < H; h++) {
                Lanes sum = b.column[p][0][h] * b.column[p][0][h];
                for (int k = 1; k < 6; k++) sum += b.column[p][k][h] * b.column[p][k][h];
                b.norm[p][h] = sum;
            }
        bool turned = false;
        for (int p = 0; p < LEGS - 1; p++)
            for (int q = p + 1; q < LEGS; q++) turned |= rotate(b, p, q);
        if (!turned) break;
    }
}

// Eight values of eight configurations, transposed into the rows of the result.
inline void put(const Lanes* values, int count, double* out, long stride) {
#ifdef __AVX512F__
    if (count == 8) {
        __m512d r[8], t[8], u[8];
        for (int k = 0; k < 8; k++) r[k] = (__m512d)values[k];
        for (int k = 0; k < 4; k++) {
            t[2 * k] = _mm512_unpacklo_pd(r[2 * k], r[2 * k + 1]);
            t[2 * k + 1] = _mm512_unpackhi_pd(r[2 * k], r[2 * k + 1]);
        }
        for (int k = 0; k < 2; k++)
            for (int o = 0; o < 2; o++) {
                u[4 * k + o] = _mm512_shuffle_f64x2(t[4 * k + o], t[4 * k + 2 + o], 0x88);
                u[4 * k + 2 + o] = _mm512_shuffle_f64x2(t[4 * k + o], t[4 * k + 2 + o], 0xdd);
            }
        for (int o = 0; o < 4; o++) {
            _mm512_storeu_pd(out + o * stride, _mm512_shuffle_f64x2(u[o], u[4 + o], 0x88));
            _mm512_storeu_pd(out + (o + 4) * stride, _mm512_shuffle_f64x2(u[o], u[4 + o], 0xdd));
        }
        return;
    }
#endif
    for (int l = 0; l < W; l++)
        for (int k = 0; k < count; k++) out[l * stride + k] = values[k][l];
}

void write(Block& b, double* out, int width) {
    for (int h = 0; h < H; h++) {
        Lanes row[160];
        // Column p of A V has length sigma_p, descending: the kinematic order is the reverse.
        for (int p = 0; p < LEGS; p++) {
            const int place = LEGS - 1 - p;
            Lanes square = b.column[p][0][h] * b.column[p][0][h];
            for (int k = 1; k < 6; k++) square += b.column[p][k][h] * b.column[p][k][h];
            const Lanes inverse = inverse_root(square);
            row[place] = inverse * inverse;
            row[LEGS + p] = square;
            for (int k = 0; k < 6; k++) {
                row[12 + 6 * place + k] = b.column[p][k][h] * inverse;
                row[48 + 6 * place + k] = b.column[p][6 + k][h];
            }
            if (width > 84)
                for (int k = 0; k < 6; k++) {
                    row[84 + 6 * p + k] = row[12 + 6 * place + k];
                    row[120 + 6 * p + k] = row[48 + 6 * place + k];
                }
        }
        double* start = out + (long)h * W * width;
        int k = 0;
        for (; k + 8 <= width; k += 8) put(row + k, 8, start + k, width);
        if (k < width) put(row + k, width - k, start + k, width);
    }
}

void stretch(const Geometry& g, const double* poses, long from, long to, double* out, int width) {
    Block b;
    std::vector<double> spare(7 * B), rest((long)width * B);
    for (long i = from; i < to; i += B) {
        if (i + B <= to) {
            inverse_jacobian(g, poses + 7 * i, b);
            decompose(b);
            write(b, out + i * width, width);
        } else {   // the last few, padded with copies of the last
            for (long l = 0; l < B; l++)
                std::memcpy(&spare[7 * l], poses + 7 * std::min(i + l, to - 1), 7 * sizeof(double));
            inverse_jacobian(g, spare.data(), b);
            decompose(b);
            write(b, rest.data(), width);
            std::memcpy(out + i * width, rest.data(), (to - i) * width * sizeof(double));
        }
    }
}

}  // namespace

// poses: count x 7 (x y z, quaternion w x y z); geometry: base then platform joints, 6 x 3 each; out: count x width.
extern "C" void stewart_floor(const double* poses, long count, const double* geometry, double* out, int width,
                              int threads) {
    Geometry g;
    std::memcpy(g.base, geometry, sizeof g.base);
    std::memcpy(g.platform, geometry + 18, sizeof g.platform);
    std::vector<std::thread> pool;
    for (int t = 0; t < threads; t++) {
        const long from = count * t / threads / B * B;
        const long to = t + 1 == threads ? count : count * (t + 1) / threads / B * B;
        pool.emplace_back([=, &g] { stretch(g, poses, from, to, out, width); });
    }
    for (auto& thread : pool) thread.join();
}
