// The simulated bed, and a probe on the head that measures it.
#pragma once
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "geometry/geometry.hpp"
#include "sim/probe_mechanism.hpp"

namespace passo::wire {

// A bed that is not flat: its height at X, Y in nozzle coordinates, mm.
struct Bed {
  double center[2], size[2];  // X and Y
  double tilt[2] = {0, 0};    // rise over the width and over the depth; zero at the centre
  double dome = 0;            // height of the centre above the corners
  double wave = 0, wave_length[2] = {120, 160};
  double lift = 0;  // rise of the whole bed

  double height(double x, double y) const;
};

// Noise with a normal distribution, the same on every computer.
class Noise {
 public:
  explicit Noise(uint32_t seed) : state_(seed * 2654435761u + 1) {}
  double next(double sigma);

 private:
  uint32_t state_;
};

// A rectangle of the bed, mm.
struct Area {
  double from[2], to[2];
  bool holds(double x, double y) const {
    return x >= from[0] && x <= to[0] && y >= from[1] && y <= to[1];
  }
};

// One of several motors that lift the gantry or the bed, and so tilt it. For the nozzle at X, Y its
// position has the weight c · (1, x, y, x y). The weights of all motors add up to 1.
struct Lift {
  uint32_t motor;  // step pin
  double c[4];
  double position = 0;
  double share(double x, double y) const {
    return (c[0] + c[1] * x + c[2] * y + c[3] * x * y) * position;
  }
};

// A probe that triggers when the nozzle's height above the bed, at the place of the probe, is at
// most `trigger`. It opens when it is `hysteresis` higher. Each approach has its own random error.
struct BedProbe {
  uint32_t pin;
  std::vector<uint32_t> motors;  // one step pin for each actuator
  std::shared_ptr<const Geometry> geometry;
  Bed bed;
  double offset[2], trigger;
  bool pressed_level;
  std::vector<Lift> lifts;  // empty: Z of the geometry is the same everywhere
  double hysteresis = 0, sigma = 0;
  Noise noise{1};
  int forced = -1;  // a fault: 0 is never triggered, 1 always
  std::vector<Area> dead,
      touchy;  // faults: never or always triggered while the nozzle is in these areas
  ProbeMechanism mechanism;
  bool pressed = false;
  double error = 0;

  // The nozzle position for these actuator positions. Returns false if the machine cannot reach
  // them.
  bool nozzle(const double* q, double p[3]) const { return geometry->forward(q, p); }
  // Z of the gantry at X, Y, if the geometry's Z is `z`.
  double gantry(double x, double y, double z) const;
  // The height of the nozzle above the bed at the place of the probe, mm; infinite where the
  // machine cannot be.
  double gap(const double* q) const;
  // Whether the probe is triggered. The clock must not decrease from call to call.
  bool triggered(const double* q, Ticks clock);

 private:
  bool touches(const double* q);
};

}  // namespace passo::wire
