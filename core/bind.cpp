// The Python module passo._core: each part of the core binds itself.
#include <nanobind/nanobind.h>

void bind_wire(nanobind::module_& m);
void bind_gcode(nanobind::module_& m);
void bind_geometry(nanobind::module_& m);
void bind_motion(nanobind::module_& m);

NB_MODULE(_core, m) {
  m.doc() = "Native core of Passo: parse, plan, solve step times, compress, frame, virtual board.";
#ifdef PASSO_BIND_wire
  bind_wire(m);
#endif
#ifdef PASSO_BIND_gcode
  bind_gcode(m);
#endif
#ifdef PASSO_BIND_geometry
  bind_geometry(m);
#endif
#ifdef PASSO_BIND_motion
  bind_motion(m);
#endif
}
