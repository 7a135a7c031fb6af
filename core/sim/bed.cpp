#include "sim/bed.hpp"

#include <limits>

#include "base/numbers.hpp"

namespace passo::wire {

double Bed::height(double x, double y) const {
  const double u = (x - center[0]) / size[0], v = (y - center[1]) / size[1];
  double sx, cx, sy, cy;
  sincos(2 * kPi * (x - center[0]) / wave_length[0], sx, cx);
  sincos(2 * kPi * (y - center[1]) / wave_length[1], sy, cy);
  return lift + tilt[0] * u + tilt[1] * v + dome * (1 - 2 * (u * u + v * v)) + wave * sx * cy;
}

double Noise::next(double sigma) {
  double sum = 0;  // sum of twelve uniform numbers: a normal distribution up to 6 sigma
  for (int i = 0; i < 12; ++i) {
    state_ = state_ * 1664525u + 1013904223u;
    sum += double(state_ >> 8) / 16777216.0;
  }
  return (sum - 6) * sigma;
}

double BedProbe::gantry(double x, double y, double z) const {
  if (lifts.empty()) return z;
  double sum = 0;
  for (const Lift& lift : lifts) sum += lift.share(x, y);
  return sum;
}

bool BedProbe::triggered(const double* q, Ticks clock) {
  const bool reads = mechanism.reads(touches(q), clock);
  return forced >= 0 ? forced > 0 : reads;
}

double BedProbe::gap(const double* q) const {
  double p[3];
  if (!nozzle(q, p)) return std::numeric_limits<double>::infinity();
  const double x = p[0] + offset[0], y = p[1] + offset[1];
  return gantry(x, y, p[2]) - bed.height(x, y);
}

bool BedProbe::touches(const double* q) {
  double p[3];
  if (!nozzle(q, p)) return false;
  for (const Area& area : dead)
    if (area.holds(p[0], p[1])) return pressed = false;
  for (const Area& area : touchy)
    if (area.holds(p[0], p[1])) return pressed = true;
  const double above = gap(q) - trigger - error;
  if (!pressed) return pressed = above <= 0;
  if (above > hysteresis) {
    pressed = false;
    error = sigma > 0 ? noise.next(sigma) : 0;
  }
  return pressed;
}

}  // namespace passo::wire
