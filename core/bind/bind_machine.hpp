// Converts the machine dict of passo.config to a Machine. A missing key raises KeyError, a wrong
// type TypeError. The configuration has already validated all values.
#pragma once
#include <nanobind/nanobind.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "geometry/registry.hpp"
#include "machine/machine.hpp"

namespace passo {

namespace nb = nanobind;

template <class T>
T get(const nb::handle& dict, const char* key) {
  return nb::cast<T>(dict[key]);
}

inline GeometryParams geometry_params(const nb::dict& dict) {
  GeometryParams params;
  for (auto [key, value] : dict) {
    std::string name = nb::cast<std::string>(key);
    if (name == "kind") continue;
    if (nb::isinstance<nb::list>(value) || nb::isinstance<nb::tuple>(value))
      params[name] = nb::cast<std::vector<double>>(value);
    else
      params[name] = {nb::cast<double>(nb::float_(value))};
  }
  return params;
}

// Makes the geometry from a dict with its kind and parameters.
inline std::unique_ptr<Geometry> geometry_of(const nb::dict& spec) {
  return make_geometry(get<std::string>(spec, "kind"), geometry_params(spec));
}

// Reads a number, or all numbers of nested sequences in their order.
inline void add_numbers(const nb::handle& value, Numbers& numbers) {
  if (nb::isinstance<nb::list>(value) || nb::isinstance<nb::tuple>(value))
    for (nb::handle part : value) add_numbers(part, numbers);
  else
    numbers.push_back(nb::cast<double>(nb::float_(value)));
}

// The machine that the dict describes.
Machine machine_of(const nb::dict& spec);

}  // namespace passo
