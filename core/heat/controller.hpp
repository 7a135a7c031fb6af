// The controller of a heater, one of four kinds. It takes a reading and returns the power.
#pragma once
#include <variant>

#include "heat/on_off.hpp"
#include "heat/pid.hpp"
#include "heat/predictive.hpp"
#include "heat/relay.hpp"

namespace passo::heat {

using Control = std::variant<PidControl, OnOffControl, ModelControl, RelayControl>;

class Controller {
 public:
  explicit Controller(const Control& control) : control_(control), law_(law_of(control)) {}
  const Control& control() const { return control_; }

  // A controller of the same kind keeps its state. One of another kind starts again.
  void set(const Control& control) {
    control_ = control;
    bool same = control.index() == law_.index();
    if (!same) law_ = law_of(control);
    std::visit(
        [&](auto& law) {
          std::visit(
              [&](const auto& options) {
                if constexpr (requires { law.set(options); }) law.set(options);
              },
              control);
        },
        law_);
  }
  double update(const Reading& reading) {
    return std::visit([&](auto& law) { return law.update(reading); }, law_);
  }
  const Terms& terms() const {
    return std::visit([](const auto& law) -> const Terms& { return law.terms(); }, law_);
  }

 private:
  using Law = std::variant<Pid, OnOff, Predictive, Relay>;  // in the order of Control
  Control control_;
  Law law_;

  static Law law_of(const Control& control) {
    switch (control.index()) {
      case 0:
        return Pid(std::get<0>(control));
      case 1:
        return OnOff(std::get<1>(control));
      case 2:
        return Predictive(std::get<2>(control));
      default:
        return Relay(std::get<3>(control));
    }
  }
};

}  // namespace passo::heat
