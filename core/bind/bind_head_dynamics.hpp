// Reads the masses, nozzles and motors of a simulated printer from Python.
#pragma once
#include <nanobind/nanobind.h>

#include <array>
#include <utility>
#include <vector>

#include "bind/bind_numbers.hpp"
#include "sim/head_dynamics.hpp"

namespace passo::wire {

using MassPair = std::pair<double, double>;  // frequency in Hz, damping ratio

inline BeltMass mass_of(const MassPair& mass) {
  const auto [frequency_hz, damping] = mass;
  positive(frequency_hz, "the frequency of a mass");
  if (!(damping > 0 && damping < 1))
    throw nanobind::value_error("a mass needs a damping ratio above 0 and below 1");
  return BeltMass(frequency_hz, damping);
}

inline std::array<BeltMass, 3> masses_of(const std::array<MassPair, 3>& masses) {
  return {mass_of(masses[0]), mass_of(masses[1]), mass_of(masses[2])};
}

inline NozzlePressure nozzle_of(double time_constant_s) {
  return NozzlePressure(positive(time_constant_s, "the time constant of a nozzle"));
}

inline std::vector<NozzlePressure> nozzles_of(const std::vector<double>& time_constants_s) {
  std::vector<NozzlePressure> nozzles;
  for (double time_constant_s : time_constants_s) nozzles.push_back(nozzle_of(time_constant_s));
  return nozzles;
}

inline TrackedMotor motor_of(double per_step, double ratio, double offset) {
  return {finite(per_step, "the distance per step"), positive(ratio, "the ratio of clocks"),
          finite(offset, "the offset of a clock")};
}

}  // namespace passo::wire
