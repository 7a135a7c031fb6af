#include "filters/law.hpp"

namespace passo {

void Law::follow(const Machine& machine, const StepperSpec& spec, const Track& nozzle) {
  const Filters& filters = machine.filters;
  double c[3] = {0, 0, 0};
  const bool actuator = spec.drive == Drive::actuator;
  const bool linear = !actuator || machine.geometry->linear(spec.index, c);
  const bool raised = actuator && machine.height_map && (!linear || c[kZ] != 0);
  planned_.clear(filters);
  if (raised) {
    form_.emplace<RaisedNozzle>(hz_, nozzle);
  } else if (!linear) {
    form_.emplace<FollowedNozzle>(machine, spec, nozzle);
  } else if (spec.drive == Drive::extruder) {
    planned_.follow_extruder(spec.index, spec.steps_per_unit);
    choose(filters, spec.index);
  } else if (!actuator) {
    planned_.follow_axis(slot_of_axis(spec.index), spec.steps_per_unit);
    choose(filters, -1);
  } else {
    for (int j = 0; j < 3; ++j)
      if (c[j] != 0) planned_.follow_axis(j, c[j] * spec.steps_per_unit);
    choose(filters, -1);
  }
}

void Law::follow_axis(const Filters& filters, int slot) {
  planned_.clear(filters);
  planned_.follow_axis(slot, 1);
  choose(filters, -1);
}

void Law::choose(const Filters& filters, int extruder) {
  if (planned_.smooth())
    planned_.add_to(form_.emplace<SmoothLaw>());
  else if (planned_.advances())
    form_.emplace<Advance>(&planned_.all()[0], filters.smooth_s[size_t(extruder)] * hz_,
                           filters.delay(hz_));
  else
    planned_.add_to(form_.emplace<Taps>());
}

}  // namespace passo
