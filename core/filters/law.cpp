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
  } else if (!actuator) {
    planned_.follow_axis(slot_of_axis(spec.index), spec.steps_per_unit);
  } else {
    for (int j = 0; j < 3; ++j)
      if (c[j] != 0) planned_.follow_axis(j, c[j] * spec.steps_per_unit);
  }
  if (!follows_nozzle()) choose(filters.delay(hz_));
}

void Law::follow_axis(const Filters& filters, int slot) {
  planned_.clear(filters);
  planned_.follow_axis(slot, 1);
  choose(filters.delay(hz_));
}

void Law::choose(double delay) {
  size_t copies = 0;
  bool boxes = false, advances = false;
  for (size_t i = 0; i < planned_.all().size(); ++i) {
    copies += planned_.kernel(i).copies.size();
    boxes |= planned_.kernel(i).box_s > 0;
    advances |= planned_.kernel(i).advances();
  }
  if (advances && !boxes && copies == 1) {
    form_.emplace<Advance>(&planned_.all()[0], planned_.kernel(0).narrow_s * hz_, delay);
  } else if (boxes || advances || copies > Taps::kMost) {
    SmoothLaw& law = form_.emplace<SmoothLaw>();
    for (size_t i = 0; i < planned_.all().size(); ++i)
      law.add(&planned_.all()[i], planned_.kernel(i), delay, hz_);
  } else {
    Taps& taps = form_.emplace<Taps>();
    for (size_t i = 0; i < planned_.all().size(); ++i)
      for (const Impulse& copy : planned_.kernel(i).copies)
        taps.add(&planned_.all()[i], copy.weight, delay + copy.at * hz_);
  }
}

}  // namespace passo
