// Numbers from Python that the core must not get as NaN or infinity.
#pragma once
#include <nanobind/nanobind.h>

#include <cmath>
#include <string>

namespace passo {

// The number. Throws ValueError if it is not finite.
inline double finite(double value, const char* name) {
  if (!std::isfinite(value))
    throw nanobind::value_error((std::string(name) + " must be a finite number").c_str());
  return value;
}

// Also throws ValueError if it is not above 0.
inline double positive(double value, const char* name) {
  if (!(finite(value, name) > 0))
    throw nanobind::value_error((std::string(name) + " must be above 0").c_str());
  return value;
}

}  // namespace passo
