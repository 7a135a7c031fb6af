#include "steps/piece_solver.hpp"

#include <algorithm>
#include <cstdint>
#include <stdexcept>

#include "steps/crossings.hpp"

namespace passo {

namespace {

// Position of one axis over the seconds of a piece.
struct AxisPath {
  const double* k;
  double value(double t) const { return Piece::at(k, t); }
  double slope(double t) const { return Piece::slope_at(k, t); }
};

}  // namespace

// Position in steps over the seconds of a piece.
struct PieceSolver::Straight {
  double k[Piece::kTerms];
  Straight(const PieceSolver& s, const Piece& p) {
    for (int i = 0; i < Piece::kTerms; ++i) {
      k[i] = 0;
      for (int j = 0; j < kAxes; ++j)
        if (s.row_[j] != 0) k[i] += s.row_[j] * p.c[j][i];
      k[i] *= s.spec_.steps_per_unit;
    }
  }
  double value(double t) const { return Piece::at(k, t); }
  double slope(double t) const { return Piece::slope_at(k, t); }
};
// The same for nonlinear geometries and bed correction. `bed`: the correction within one cell of
// the height map; by default the bed is flat.
struct PieceSolver::Curved {
  const PieceSolver& s;
  const Piece& p;
  HeightMap::Lift bed;
  double near = 0;  // of a motor that turns without end: its step count at the start of the piece
  double value(double t) const {
    double at[3] = {p.position(kX, t), p.position(kY, t), p.position(kZ, t)};
    at[kZ] += bed.at(at[kX], at[kY], at[kZ]);
    return nearest_turn(*s.machine_.geometry, s.spec_.index, s.spec_.steps_per_unit,
                        s.machine_.geometry->inverse(s.spec_.index, at) * s.spec_.steps_per_unit,
                        near);
  }
  // Slope along the tangent, on which the nozzle moves by one unit per second.
  double slope(double t) const {
    double x = p.position(kX, t), y = p.position(kY, t), plan_z = p.position(kZ, t);
    double vx = p.speed(kX, t), vy = p.speed(kY, t), vz = p.speed(kZ, t);
    double z = plan_z + bed.at(x, y, plan_z);
    vz += bed.slope_x(y, plan_z) * vx + bed.slope_y(x, plan_z) * vy + bed.slope_z(x, y) * vz;
    Path tangent{{x, y, z}, {x + vx, y + vy, z + vz}, 1};
    double first, second;
    s.machine_.geometry->slopes(s.spec_.index, tangent, 0, first, second);
    return first * s.spec_.steps_per_unit;
  }
};

template <class Curve>
int64_t PieceSolver::solve_along(const Curve& curve, const Piece& p, const double* span, int parts,
                                 int64_t count, Steps& out) {
  turns_.clear();
  Turns<Curve> turns(curve, kExact, turns_);
  double t = span[0], seconds = span[1] - span[0];
  for (int i = 0; i < parts; ++i)
    turns.find(span[0] + seconds * i / parts,
               i + 1 == parts ? span[1] : span[0] + seconds * (i + 1) / parts);
  double from = curve.value(t);
  for (double turn : turns_) {
    double to = curve.value(turn);
    int64_t target = int64_t(std::floor(to + 0.5));
    int dir = to > from ? 1 : -1;
    for (; (target - count) * dir > 0; count += dir) {
      t = crossing(curve, double(count) + 0.5 * dir, dir, t, turn);
      *out.extend(1, dir) = p.start + t * machine_.clock_hz;
    }
    t = turn;
    from = to;
  }
  return count;
}

PieceSolver::PieceSolver(const Machine& machine, const StepperSpec& spec)
    : machine_(machine), spec_(spec) {
  for (double& c : row_) c = 0;
  if (spec.drive == Drive::actuator)
    straight_ = machine.geometry->linear(spec.index, row_);
  else
    row_[spec.drive == Drive::extruder ? kE : slot_of_axis(spec.index)] = 1;
}

bool PieceSolver::rests(const double* from, const double* to, int64_t count) const {
  if (!straight_ || from[kZ] != to[kZ]) return false;
  const HeightMap& map = *machine_.height_map;
  for (int j : {kX, kY})
    if (map.index(j, from[j]) != map.index(j, to[j])) return false;
  const double z = from[kZ];
  const HeightMap::Lift lift = map.lift(from[kX], from[kY], z);
  // A bilinear function has its minimum and maximum at corners of a rectangle.
  for (double x : {from[kX], to[kX]})
    for (double y : {from[kY], to[kY]}) {
      double q = row_[kX] * x + row_[kY] * y + row_[kZ] * (z + lift.at(x, y, z));
      if (int64_t(std::floor(q * spec_.steps_per_unit + 0.5)) != count) return false;
    }
  return true;
}

int64_t PieceSolver::solve(const Piece& p, int64_t count, int64_t target, bool ends_path,
                           Steps& out) {
  if (!moves(p)) return count;
  const double begin = double(count);
  if (!raised()) {
    double whole[] = {0, p.seconds};
    if (straight_)
      count = solve_along(Straight(*this, p), p, whole, 1, count, out);
    else
      count = solve_along(Curved{*this, p, {}, begin}, p, whole, parts(p), count, out);
  } else {
    find_lines(p);
    for (size_t i = 1; i < lines_.size(); ++i) {
      double middle = 0.5 * (lines_[i - 1] + lines_[i]);
      Curved curve{*this, p, lift_at(p, middle), begin};
      // Above one cell, the position of a linear motor is a polynomial of degree 4 in t, if the
      // piece is part of a move. In a fade the degree is 3 at constant speed, and 6 otherwise.
      bool fades = curve.bed.factor.by_z != 0 && p.speed(kZ, middle) != 0;
      int n = straight_ && p.degree() <= (fades ? 1 : 2) ? 1 : parts(p);
      count = solve_along(curve, p, &lines_[i - 1], n, count, out);
    }
  }
  if (!ends_path) return count;
  for (int dir = target > count ? 1 : -1; count != target; count += dir)
    *out.extend(1, dir) = p.start + p.seconds * machine_.clock_hz;
  return count;
}

void PieceSolver::check(const Piece& p) const {
  if (!moves(p)) return;
  int n = std::max(parts(p), kMinSamples);
  for (int i = 0; i <= n; ++i) {
    double t = p.seconds * i / n, q, rate;
    if (straight_ && !raised()) {
      q = Straight(*this, p).value(t), rate = Straight(*this, p).slope(t);
    } else {
      Curved curve{*this, p, raised() ? lift_at(p, t) : HeightMap::Lift{}, 0};
      q = curve.value(t), rate = curve.slope(t);
    }
    q /= spec_.steps_per_unit;
    // This comparison also fails for NaN.
    if (!(q >= spec_.min - 1e-6 && q <= spec_.max + 1e-6))
      throw std::invalid_argument("a piece leaves the reach of stepper " + spec_.name);
    if (!(std::fabs(rate) <= spec_.max_rate))
      throw std::invalid_argument("a piece is too fast for stepper " + spec_.name);
  }
}

bool PieceSolver::moves(const Piece& p) const {
  return spec_.drive != Drive::extruder || p.extruder == spec_.index;
}

int PieceSolver::parts(const Piece& p) {
  return int(std::ceil(std::clamp(p.length_mm() / kSampleMm, 1.0, 4096.0)));
}

HeightMap::Lift PieceSolver::lift_at(const Piece& p, double t) const {
  return machine_.height_map->lift(p.position(kX, t), p.position(kY, t), p.position(kZ, t));
}

void PieceSolver::find_lines(const Piece& p) {
  const HeightMap& map = *machine_.height_map;
  lines_.assign(1, 0.0);
  for (int j : {kX, kY, kZ}) {
    if (j == kZ && !(map.fade().start < kInfinity)) break;
    AxisPath axis{p.c[j]};
    turns_.clear();
    Turns<AxisPath>(axis, kExact, turns_).find(0, p.seconds);
    double a = 0;
    for (double b : turns_) {
      double from = axis.value(a), to = axis.value(b), dir = to > from ? 1 : -1;
      auto cross = [&](double line) {
        if ((line - from) * (line - to) < 0) lines_.push_back(crossing(axis, line, dir, a, b));
      };
      if (j == kZ) {
        cross(map.fade().start);
        cross(map.fade().end);
      } else {
        int first = std::max(map.index(j, std::min(from, to)), 0);
        int last = std::min(map.index(j, std::max(from, to)) + 1, map.lines(j) - 1);
        for (int i = first; i <= last; ++i) cross(map.line(j, i));
      }
      a = b;
    }
  }
  lines_.push_back(p.seconds);
  std::sort(lines_.begin(), lines_.end());
  lines_.erase(std::unique(lines_.begin(), lines_.end()), lines_.end());
}

void check_pieces(const Machine& machine, const std::vector<Piece>& pieces, const double* from,
                  double filament) {
  for (const Piece& p : pieces) {
    if (!(p.seconds > 0 && p.seconds < kInfinity))
      throw std::invalid_argument("a piece needs a time above 0");
    for (int j = 0; j < kAxes; ++j) {
      bool first = &p == pieces.data() && p.extruder < machine.extruders.size();
      double before = j == kE && first ? filament : from[j];
      // This comparison also fails for NaN.
      if (!(std::fabs(p.c[j][0] - before) <= kPieceJoint))
        throw std::invalid_argument("a piece does not start where the one before it ends");
      if (!(std::fabs(p.position(j, p.seconds) - p.end[j]) <= kPieceJoint))
        throw std::invalid_argument("a piece does not end where it says");
    }
    from = p.end;
    for (const StepperSpec& spec : machine.steppers) PieceSolver(machine, spec).check(p);
  }
}

}  // namespace passo
