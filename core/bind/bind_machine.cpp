#include "bind/bind_machine.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace passo {

namespace {

JunctionLaw junction_law(const std::string& name) {
  if (name == "deviation") return JunctionLaw::deviation;
  if (name == "square_corner") return JunctionLaw::square_corner;
  if (name == "cornering_distance") return JunctionLaw::cornering_distance;
  if (name == "jerk") return JunctionLaw::jerk;
  throw nb::value_error("unknown junction law");
}

}  // namespace

Machine machine_of(const nb::dict& spec) {
  Machine m;
  m.name = get<std::string>(spec, "name");
  m.clock_hz = get<double>(spec, "clock_hz");
  m.tolerance = get<double>(spec, "tolerance_s") * m.clock_hz;
  for (nb::handle a : spec["axes"])
    m.axes.push_back({get<std::string>(a, "name"), get<std::string>(a, "letter").at(0),
                      get<double>(a, "min"), get<double>(a, "max"), get<double>(a, "speed"),
                      get<double>(a, "accel"), get<double>(a, "jerk"),
                      get<double>(a, "cornering_steps"),
                      nb::cast<nb::dict>(a).contains("filament") && get<bool>(a, "filament"),
                      nb::cast<nb::dict>(a).contains("by_arms") && get<bool>(a, "by_arms")});
  for (nb::handle e : spec["extruders"]) {
    m.extruders.push_back({get<std::string>(e, "name"), get<double>(e, "speed"),
                           get<double>(e, "accel"), get<double>(e, "jerk")});
    if (nb::cast<nb::dict>(e).contains("advance_s"))
      m.extruders.back().advance_s = get<double>(e, "advance_s");
  }
  for (nb::handle t : spec["tools"]) {
    auto offset = get<std::vector<double>>(t, "offset");
    m.tools.push_back({get<int>(t, "extruder"), {offset.at(0), offset.at(1), offset.at(2)}});
  }
  nb::dict geometry = get<nb::dict>(spec, "geometry");
  m.geometry = geometry_of(geometry);
  for (nb::handle s : spec["steppers"]) {
    std::string drive = get<std::string>(s, "drive");
    auto ticks = [&](const char* key) {
      return int64_t(std::ceil(get<double>(s, key) * m.clock_hz - 1e-6));
    };
    // A step pulse and the pause after it each last at least this long.
    const int64_t pulse = ticks("pulse_s");
    const double rate = std::min(get<double>(s, "max_rate_hz"), m.clock_hz / (2 * double(pulse)));
    m.steppers.push_back({get<std::string>(s, "name"),
                          drive == "actuator" ? Drive::actuator
                          : drive == "axis"   ? Drive::axis
                                              : Drive::extruder,
                          get<int>(s, "index"), get<double>(s, "steps_per_unit"), pulse,
                          ticks("dir_setup_s"), ticks("dir_hold_s"), rate, get<double>(s, "speed"),
                          get<double>(s, "accel"), get<double>(s, "min"), get<double>(s, "max")});
    if (nb::cast<nb::dict>(s).contains("board"))
      m.steppers.back().board = get<uint16_t>(s, "board");
  }
  if (spec.contains("boards")) {
    m.boards = get<size_t>(spec, "boards");
    m.output_boards = get<std::vector<uint16_t>>(spec, "output_boards");
  }
  // Settings by name: one value for the machine, or one for each axis or extruder.
  if (spec.contains("filters"))
    for (auto [key, value] : get<nb::dict>(spec, "filters")) {
      const std::string name = nb::cast<std::string>(key);
      const bool each = nb::isinstance<nb::list>(value) || nb::isinstance<nb::tuple>(value);
      const nb::list values = each ? nb::list(value) : nb::list(nb::make_tuple(value));
      for (size_t i = 0; i < values.size(); ++i) {
        Numbers numbers;
        add_numbers(values[i], numbers);
        m.filters.set(name, i, numbers);
      }
    }
  nb::dict limits = get<nb::dict>(spec, "limits");
  m.limits = {get<double>(limits, "print_accel"),
              get<double>(limits, "travel_accel"),
              get<double>(limits, "retract_accel"),
              get<double>(limits, "speed"),
              junction_law(get<std::string>(limits, "junction")),
              get<double>(limits, "junction_deviation"),
              get<double>(limits, "square_corner"),
              get<double>(limits, "minimum_cruise_ratio"),
              get<double>(limits, "least_speed_gain")};
  if (spec.contains("budgets")) {
    for (StepperSpec& s : m.steppers) s.budget = kNoBudget;
    for (nb::handle item : get<nb::list>(spec, "budgets")) {
      const nb::dict budget = nb::cast<nb::dict>(item);
      if (m.budgets.size() == kBudgets) throw std::invalid_argument("more than 4 budgets");
      for (const uint16_t board : get<std::vector<uint16_t>>(budget, "boards"))
        for (StepperSpec& s : m.steppers)
          if (s.board == board) s.budget = uint8_t(m.budgets.size());
      m.budgets.push_back({get<double>(budget, "steps_s"), get<double>(budget, "commands_s"),
                           get<double>(budget, "burst"),
                           get<std::string>(budget, "bound") == "link",
                           get<double>(budget, "commits_s")});
    }
  }
  if (spec.contains("retraction")) {
    const nb::dict found = get<nb::dict>(spec, "retraction");
    m.retraction.mm = get<double>(found, "length");
    m.retraction.feed_mm_s = get<double>(found, "speed");
    m.retraction.hop_mm = get<double>(found, "hop");
    m.retraction.recover_mm = get<double>(found, "extra");
    m.retraction.recover_feed_mm_s = get<double>(found, "return_speed");
  }
  if (spec.contains("motor_letters")) m.motor_letters = get<std::string>(spec, "motor_letters");
  if (spec.contains("macros")) {
    nb::dict macros = get<nb::dict>(spec, "macros");
    for (auto& name : get<std::vector<std::string>>(macros, "names"))
      m.macros.names.insert(std::move(name));
    for (auto [code, original] : get<nb::dict>(macros, "built_in"))
      m.macros.built_in.emplace(nb::cast<std::string>(code), nb::cast<std::string>(original));
  }
  return m;
}

}  // namespace passo
