// The steps of a motor, found from the parts of its law.
#pragma once
#include <cmath>
#include <cstdint>
#include <memory>

#include "filters/law.hpp"
#include "machine/machine.hpp"
#include "steps/cubic_solver.hpp"
#include "steps/interval_solver.hpp"
#include "steps/piece_solver.hpp"
#include "steps/steps.hpp"

namespace passo {

// The sink of a law: passes each kind of part to the solver for its steps.
class LawSteps {
 public:
  LawSteps(const Machine& machine, const StepperSpec& spec) : machine_(machine), spec_(spec) {}

  // Sets the kind of the parts that follow. Call this only at standstill.
  void expect(PartKind parts) {
    parts_ = parts;
    if (parts == PartKind::quadratics && !intervals_)
      intervals_ = std::make_unique<IntervalSolver>();
    if (parts == PartKind::cubics && !cubics_) cubics_ = std::make_unique<CubicSolver>();
    if (parts == PartKind::pieces) pieces_ = std::make_unique<PieceSolver>(machine_, spec_);
  }
  // The parts start at clock t and position q.
  void begin(double t, double q) {
    if (parts_ == PartKind::quadratics) return intervals_->begin(t, q);
    count_ = std::floor(q + 0.5);
  }
  // Sets where the steps go.
  void into(Steps& out, TimedTolerances& tolerances) {
    if (parts_ == PartKind::quadratics) return intervals_->into(out, tolerances);
    if (parts_ == PartKind::cubics) return cubics_->into(out, tolerances);
    out_ = &out, tolerances_ = &tolerances;
  }
  void flush() {
    if (parts_ == PartKind::quadratics) return intervals_->flush();
    if (parts_ == PartKind::cubics) cubics_->flush();
  }
  // Step count at the end of the last part.
  int64_t count() const {
    return parts_ == PartKind::quadratics ? intervals_->count() : int64_t(count_);
  }

  void add(double t, double q, double speed0, double speed1, double accel) {
    intervals_->add(t, q, speed0, speed1, accel);
  }
  void bent(double t, double q, double speed0, double speed1, double accel, double odd,
            double even) {
    intervals_->add(t, q, speed0, speed1, accel, odd, even);
  }
  void cubic(double t, double d, double q, double v, double a, double, double end, double) {
    const double c0 = q - count_, c1 = v * d, c2 = 0.5 * a * d * d, to = end - count_;
    const double n = std::floor(to + 0.5);
    // If the four Bezier values are less than half a step from the count, the interval has no step.
    const double b1 = c0 + c1 * (1.0 / 3), b2 = c0 + (2 * c1 + c2) * (1.0 / 3);
    if ((n == 0) & (b1 < 0.5) & (b2 < 0.5) & (b1 > -0.5) & (b2 > -0.5)) return;
    counted(t, d, c0, c1, c2, to, n);
  }
  void counted(double t, double d, double c0, double c1, double c2, double end, double n) {
    cubics_->cubic(t, d, c0, c1, c2, end, n);
    count_ += n;
  }
  void piece(const Piece& p) {
    tolerances_->apply(p.start, *out_);
    const int64_t from = int64_t(count_);
    count_ = double(pieces_->solve(p, from, from, false, *out_));
  }

 private:
  const Machine& machine_;
  const StepperSpec& spec_;
  PartKind parts_ = PartKind::quadratics;
  std::unique_ptr<IntervalSolver> intervals_;
  std::unique_ptr<CubicSolver> cubics_;
  std::unique_ptr<PieceSolver> pieces_;
  double count_ = 0;  // step count, used for cubics and pieces
  Steps* out_ = nullptr;
  TimedTolerances* tolerances_ = nullptr;
};

}  // namespace passo
