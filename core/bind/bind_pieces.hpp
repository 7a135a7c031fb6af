// Reads pieces of motion that are already planned from Python.
#pragma once
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <optional>
#include <tuple>
#include <vector>

#include "machine/machine.hpp"
#include "plan/pieces.hpp"

namespace passo {

// Seconds, and rows of coefficients: one for each axis, then one for E.
using PieceSpec = std::tuple<double, std::vector<std::vector<double>>>;

inline constexpr const char* kPiecesText =
    "Adds motion that is planned already, after the moves pushed so far. Each piece has its "
    "duration in s and, for each axis, then E, up to six coefficients of a polynomial of time: mm, "
    "mm/s, mm/s^2 and so on. Pieces must join to 1e-6 mm. `end` is the exact end of the last "
    "piece; by default, the end of its polynomials. Raises ValueError.";

inline Piece piece_of(const Machine& machine, const PieceSpec& spec, int extruder) {
  const auto& [seconds, coefficients] = spec;
  if (coefficients.size() != machine.axes.size() + 1)
    throw nanobind::value_error("a piece needs one row of coefficients an axis, then E");
  if (extruder < 0 || (size_t(extruder) >= machine.extruders.size() && !machine.extruders.empty()))
    throw nanobind::value_error("no such extruder");
  Piece p{};
  p.seconds = seconds;
  p.extruder = uint16_t(extruder);
  for (size_t i = 0; i < coefficients.size(); ++i) {
    if (coefficients[i].empty() || coefficients[i].size() > Piece::kTerms)
      throw nanobind::value_error("an axis of a piece has 1 to 6 coefficients");
    int j = i < machine.axes.size() ? slot_of_axis(int(i)) : int(kE);
    std::copy(coefficients[i].begin(), coefficients[i].end(), p.c[j]);
  }
  for (int j = 0; j < kAxes; ++j) p.end[j] = p.position(j, seconds);
  return p;
}

inline std::vector<Piece> pieces_of(const Machine& machine, const std::vector<PieceSpec>& pieces,
                                    const std::optional<std::vector<double>>& end, int extruder) {
  std::vector<Piece> list;
  for (const PieceSpec& spec : pieces) {
    list.push_back(piece_of(machine, spec, extruder));
    if (list.size() > 1)
      for (int j = 0; j < kAxes; ++j) list[list.size() - 2].end[j] = list.back().c[j][0];
  }
  if (end && !list.empty()) {
    if (end->size() != machine.axes.size() + 1)
      throw nanobind::value_error("an end needs one number an axis, then E");
    for (size_t i = 0; i < machine.axes.size(); ++i)
      list.back().end[slot_of_axis(int(i))] = (*end)[i];
    list.back().end[kE] = end->back();
  }
  return list;
}

}  // namespace passo
