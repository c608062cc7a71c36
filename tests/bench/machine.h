/* machine.h -- what this machine can do, measured: rates of fused multiply-adds, memory bandwidth,
 * what vector square roots and divisions cost. Benchmarks report their shares of it. */
#ifndef MACHINE_H
#define MACHINE_H

enum { MACHINE_128, MACHINE_256, MACHINE_512, MACHINE_WIDTHS };

/* With vectors of one width; all 0 where the processor (or the compiler) lacks them. */
struct machine_width {
    double fma_f64, fma_f32;         /* [GF/s] one thread; a multiply-add is two */
    double fma_f64_all, fma_f32_all; /* [GF/s] all threads */
    double sqrt_f64, sqrt_f32;       /* [ns] a vector, one after the other without waiting */
    double div_f64, div_f32;         /* [ns] the same */
};

struct machine {
    int threads;                     /* of the figures of all */
    double clock;                    /* [GHz] of one core, from dependent additions */
    double fma_f64, fma_f32;         /* [GF/s] of the best width, one thread */
    double fma_f64_all, fma_f32_all; /* [GF/s] all threads */
    double read_bw, triad_bw;        /* [GB/s] one thread; the triad counts 24 bytes an element */
    double read_bw_all, triad_bw_all;
    struct machine_width width[MACHINE_WIDTHS];
};

/* Measures with so many threads, or with those of OpenMP's default where 0. Takes some seconds.
 * Every figure is the best of some repetitions: what others do meanwhile only slows them. The bandwidths
 * stay 0 where there is no memory for the arrays. */
void machine_measure(struct machine *m, int threads);

void machine_print(const struct machine *m);

/* Bits of a vector. */
int machine_bits(int width);

#endif
