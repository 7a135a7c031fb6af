// The Python module passo._core. Each part of the core has a function that binds it.
#include <nanobind/nanobind.h>

void bind_heat(nanobind::module_& m);
void bind_chips(nanobind::module_& m);
void bind_frames(nanobind::module_& m);
void bind_link(nanobind::module_& m);
void bind_board(nanobind::module_& m);
void bind_nozzle_gap(nanobind::module_& m);
void bind_head_dynamics(nanobind::module_& m);
void bind_print_quality(nanobind::module_& m);
void bind_step_recording(nanobind::module_& m);
void bind_wire(nanobind::module_& m);
void bind_geometry(nanobind::module_& m);
void bind_motion(nanobind::module_& m);
void bind_gcode(nanobind::module_& m);
void bind_job(nanobind::module_& m);

NB_MODULE(_core, m) {
  m.doc() = "Native core of Passo: parse, plan, solve step times, compress, frame, virtual board.";
  bind_heat(m);
  bind_frames(m);
  bind_link(m);
  bind_board(m);
  bind_nozzle_gap(m);
  bind_head_dynamics(m);
  bind_print_quality(m);
  bind_step_recording(m);
  bind_wire(m);
  bind_chips(m);
  bind_geometry(m);
  bind_motion(m);
  bind_gcode(m);
  bind_job(m);
}
