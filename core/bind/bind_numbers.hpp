// Reads numbers from Python that must not be NaN or infinite.
#pragma once
#include <nanobind/nanobind.h>

#include <cmath>
#include <string>

namespace passo {

// Throws ValueError if the number is not finite.
inline double finite(double value, const char* name) {
  if (!std::isfinite(value))
    throw nanobind::value_error((std::string(name) + " must be a finite number").c_str());
  return value;
}

// Throws ValueError if the number is not finite, or not above 0.
inline double positive(double value, const char* name) {
  if (!(finite(value, name) > 0))
    throw nanobind::value_error((std::string(name) + " must be above 0").c_str());
  return value;
}

}  // namespace passo
