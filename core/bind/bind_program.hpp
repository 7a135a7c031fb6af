// Settings for reading a program, and the events of the program.
#pragma once
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include "bind/bind_machine.hpp"
#include "gcode/interpreter.hpp"

namespace passo {

// M is a word of a move only if it is one of these letters.
inline LaserWords laser_words(const nb::object& laser) {
  LaserWords words;
  if (laser.is_none()) return words;
  auto letter = [&](const char* key) {
    std::string text = get<std::string>(laser, key);
    return text.empty() ? char(0) : text[0];
  };
  words.energy = letter("energy_letter");
  words.density = letter("density_letter");
  words.full_w = get<double>(laser, "full_w");
  words.most_w = get<double>(laser, "most_w");
  return words;
}

inline std::vector<double> homes(const nb::dict& spec) {
  std::vector<double> home;
  for (nb::handle axis : spec["axes"]) home.push_back(get<double>(axis, "home"));
  return home;
}

using EventTuple = std::tuple<uint32_t, std::string, int, int, std::string, std::string>;

inline EventTuple as_tuple(const Event& e) {
  return {e.line, e.letter ? std::string(1, e.letter) : std::string(), e.number, e.minor, e.name,
          e.text};
}

}  // namespace passo
