// One solve by Spectra in a process of its own: spectra PROBLEM.bin COUNT BASIS TOLERANCE VALUES.bin
// Shift-invert around -0.01 with Eigen's LDLT (faster on these matrices than the LU that Spectra takes by itself).
#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <Spectra/MatOp/SparseSymMatProd.h>
#include <Spectra/SymEigsShiftSolver.h>
#include <Spectra/SymGEigsShiftSolver.h>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <memory>
#include <vector>

using Matrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;

// Solves with L - sigma B.
struct Inverse {
    using Scalar = double;
    const Matrix *stiffness, *mass;
    std::shared_ptr<Eigen::SimplicialLDLT<Matrix>> factor = std::make_shared<Eigen::SimplicialLDLT<Matrix>>();
    Eigen::Index rows() const { return stiffness->rows(); }
    Eigen::Index cols() const { return stiffness->cols(); }
    void set_shift(double sigma) { factor->compute(*stiffness - sigma * *mass); }
    void perform_op(const double *x, double *y) const {
        Eigen::Map<Eigen::VectorXd>(y, rows()) = factor->solve(Eigen::Map<const Eigen::VectorXd>(x, rows()));
    }
};

static double processor() {
    timespec time;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return time.tv_sec + 1e-9 * time.tv_nsec;
}

static long memory(const char *field) {
    FILE *status = fopen("/proc/self/status", "r");
    char line[256];
    long found = 0;
    while (fgets(line, sizeof line, status))
        if (!strncmp(line, field, strlen(field))) found = atol(line + strlen(field) + 1) * 1024;
    fclose(status);
    return found;
}

template <class Solver> static Eigen::VectorXd run(Solver &solver, double tolerance) {
    solver.init();
    solver.compute(Spectra::SortRule::LargestMagn, 1000, tolerance, Spectra::SortRule::SmallestAlge);
    return solver.eigenvalues();
}

int main(int, char **arguments) {
    FILE *in = fopen(arguments[1], "rb");
    int64_t sizes[3];
    if (!in || fread(sizes, 8, 3, in) != 3) return 1;
    int n = sizes[0], entries = sizes[1];
    bool unit = sizes[2];
    std::vector<int> offsets(n + 1), indices(entries);
    std::vector<double> a(entries), b(entries);
    if (fread(offsets.data(), 4, n + 1, in) != size_t(n + 1) || fread(indices.data(), 4, entries, in) != size_t(entries) ||
        fread(a.data(), 8, entries, in) != size_t(entries) || fread(b.data(), 8, entries, in) != size_t(entries))
        return 1;
    fclose(in);
    Matrix stiffness = Eigen::Map<Matrix>(n, n, entries, offsets.data(), indices.data(), a.data());
    Matrix mass;
    if (unit) {
        stiffness *= n;
        mass.resize(n, n);
        mass.setIdentity();
    } else {
        mass = Eigen::Map<Matrix>(n, n, entries, offsets.data(), indices.data(), b.data());
    }
    int count = atoi(arguments[2]), basis = atoi(arguments[3]);
    double tolerance = atof(arguments[4]), shift = -0.01;
    long before = memory("VmRSS");
    double start = processor();
    Inverse inverse{&stiffness, &mass};
    Eigen::VectorXd values;
    if (unit) {
        Spectra::SymEigsShiftSolver<Inverse> solver(inverse, count, basis, shift);
        values = run(solver, tolerance);
    } else {
        Spectra::SparseSymMatProd<double> product(mass);
        Spectra::SymGEigsShiftSolver<Inverse, Spectra::SparseSymMatProd<double>, Spectra::GEigsMode::ShiftInvert> solver(
            inverse, product, count, basis, shift);
        values = run(solver, tolerance);
    }
    double seconds = processor() - start;
    long peak = memory("VmHWM");
    FILE *out = fopen(arguments[5], "wb");
    fwrite(values.data(), 8, values.size(), out);
    fclose(out);
    printf("{\"processor\": %.6f, \"before\": %ld, \"peak\": %ld}\n", seconds, before, peak);
}
