// What one core of this machine can do: bytes per second over arrays of several sizes, of a = b + s c (stores count
// once, as what the program asks for) or of b'c (reads alone), whichever is more, and floating-point operations per
// second of multiply-adds in registers. Prints one line of JSON.
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static double now(void) {
    struct timespec time;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return time.tv_sec + 1e-9 * time.tv_nsec;
}

__attribute__((noinline)) static void triad(double *restrict a, const double *b, const double *c, size_t n, double s) {
    for (size_t i = 0; i < n; i++) a[i] = b[i] + s * c[i];
}

typedef double vector __attribute__((vector_size(64)));

__attribute__((noipa)) static double dot(const double *b, const double *c, size_t n) {
    vector sums[4] = {0};
    const vector *x = (const vector *)b, *y = (const vector *)c;
    for (size_t i = 0; i + 4 <= n / 8; i += 4)
        for (int k = 0; k < 4; k++) sums[k] += x[i + k] * y[i + k];
    double sum = 0;
    for (int k = 0; k < 4; k++)
        for (int i = 0; i < 8; i++) sum += sums[k][i];
    return sum;
}

static double operations(void) {
    vector sums[12];
    for (int k = 0; k < 12; k++)
        for (int i = 0; i < 8; i++) sums[k][i] = 1e-3 * (k + i);
    vector x = sums[3] * 1e-3 + 0.999, y = sums[5] * 1e-6;
    double best = 0;
    for (int round = 0; round < 20; round++) {
        double start = now();
        for (long i = 0; i < 2000000; i++)
            for (int k = 0; k < 12; k++) sums[k] = sums[k] * x + y;
        double rate = 2.0 * 8 * 12 * 2000000 / (now() - start);
        if (rate > best) best = rate;
    }
    double sink = 0;
    for (int k = 0; k < 12; k++) sink += sums[k][0];
    return sink == 42 ? 0 : best;
}

int main(void) {
    printf("{\"operations\": %.4g, \"bandwidth\": {", operations());
    size_t sizes[] = {1 << 20, 16 << 20, 128 << 20, 1024u << 20};
    for (int k = 0; k < 4; k++) {
        size_t n = sizes[k] / 24;
        size_t bytes = (8 * n + 63) / 64 * 64;
        double *a = aligned_alloc(64, bytes), *b = aligned_alloc(64, bytes), *c = aligned_alloc(64, bytes);
        double best = 0, sum = 0;
        for (size_t i = 0; i < n; i++) a[i] = 0, b[i] = 1, c[i] = 2;
        for (int round = 0; round < 20; round++) {
            size_t repeat = 1 + ((size_t)200 << 20) / sizes[k];
            double start = now();
            for (size_t i = 0; i < repeat; i++) triad(a, b, c, n, 0.5 + i);
            double rate = 24.0 * n * repeat / (now() - start);
            if (rate > best) best = rate;
            start = now();
            for (size_t i = 0; i < repeat; i++) sum += dot(b, c, n);
            rate = 16.0 * n * repeat / (now() - start);
            if (rate > best) best = rate;
        }
        printf("%s\"%zu\": %.4g", k ? ", " : "", sizes[k], a[n / 2] + sum == 42 ? 0 : best);
        free(a), free(b), free(c);
    }
    printf("}}\n");
}
