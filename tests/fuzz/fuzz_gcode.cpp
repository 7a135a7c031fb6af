// Hostile programs: the interpreter must end, and stay within the machine's bounds. The first byte
// chooses the policies and the size of the chunks.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "gcode/interpreter.hpp"
#include "gcode/survey.hpp"
#include "geometry/cartesian.hpp"

using namespace passo;

namespace {

Machine cartesian_machine() {
  Machine machine{};
  machine.name = "fuzz";
  machine.clock_hz = 16e6;
  for (char letter : {'X', 'Y', 'Z'})
    machine.axes.push_back({std::string(1, char(letter + 32)), letter, 0, 200, 300, 3000, 10, 40});
  machine.extruders.push_back({"e", 100, 5000, 1});
  machine.extruders.push_back({"e1", 100, 5000, 1});
  machine.tools.push_back({0, {0, 0, 0}});
  machine.tools.push_back({1, {20, 0, 0}});
  machine.macros.names = {"FOO", "T0", "G28", "M600"};
  machine.macros.built_in = {{"G28.1", "G28"}, {"T0.1", "T0"}, {"_FOO", "FOO"}};
  machine.geometry = std::make_shared<LinearGeometry>(cartesian());
  return machine;
}

void drain(Interpreter& interpreter, int& moves, int& macros) {
  for (;;) {
    ParseResult found = interpreter.next();
    if (found == ParseResult::need_input || found == ParseResult::end) return;
    if (found == ParseResult::macro && ++macros < 1000 && interpreter.macro_depth() < 4) {
      const std::string text = interpreter.event().text;  // of the call: it may call more
      interpreter.insert(macros % 2 ? text : "T0.1\n" + text + "\nM99\nG1 X1");
    }
    if (found != ParseResult::move) continue;
    for (int j = 0; j < 3; ++j)
      if (!(interpreter.move().target[j] > -1e-5 && interpreter.move().target[j] < 200 + 1e-5))
        std::abort();
    if (!(std::fabs(interpreter.move().target[kE]) < 1e15)) std::abort();
    if (!(interpreter.move().feed_mm_s > 0)) std::abort();
    if (++moves > 100000) return;  // a few arcs of many turns are no fault
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size == 0) return 0;
  static const Machine machine = cartesian_machine();
  const LaserWords words = data[0] & 1 ? LaserWords{'L', 'M', 100, 80} : LaserWords{};
  Interpreter interpreter(machine, {0, 0, 0}, words);
  interpreter.clamp = data[0] & 2;
  interpreter.ignore_tools = data[0] & 4;
  Survey survey(machine, {0, 0, 0}, words);
  survey.feed(reinterpret_cast<const char*>(data) + 1, size - 1);
  survey.finish();
  interpreter.subprograms = survey.subprograms();
  interpreter.objects().learn(survey.objects());
  const size_t chunk = data[0] & 8 ? size : 1 + (data[0] >> 4);
  int moves = 0, macros = 0;
  for (size_t i = 1; i < size && moves <= 100000; i += chunk) {
    interpreter.feed(reinterpret_cast<const char*>(data) + i, std::min(chunk, size - i));
    drain(interpreter, moves, macros);
  }
  if (moves > 100000) return 0;
  interpreter.finish();
  drain(interpreter, moves, macros);
  return 0;
}
