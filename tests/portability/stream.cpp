// The stream of a program on one machine of each family, without Python: for builds of other CPUs.
// Usage: stream FILE EXAMPLE... Prints a line a machine, then one for each example on a cartesian
// machine: name, commands, stream hash.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "geometry/registry.hpp"
#include "link/stream_hash.hpp"
#include "motion/job.hpp"

using namespace passo;

static Machine machine(const std::string& kind, const GeometryParams& params, double steps,
                       double unit_speed) {
  Machine m;
  m.name = kind;
  m.clock_hz = 16e6;
  m.tolerance = 32;
  m.geometry = make_geometry(kind, params);
  const char* names[] = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i) {
    m.axes.push_back({names[i], char('X' + i), -300, 300, i == 2 ? 20.0 : 250.0,
                      i == 2 ? 200.0 : 2500.0, 10, 40});
    m.steppers.push_back({names[i], Drive::actuator, i, steps, 32, 4, 4, 400000, unit_speed,
                          20 * unit_speed, -1e6, 1e6});
  }
  m.extruders.push_back({"e", 80, 4000, 1});
  m.steppers.push_back({"e", Drive::extruder, 0, 95.5, 32, 4, 4, 400000, kInfinity, kInfinity,
                        -kInfinity, kInfinity});
  m.tools.push_back({0, {0, 0, 0}});
  m.limits = {2000, 2500, 3000, 250, JunctionLaw::deviation, 0.02, 5, 0.0, 0.1};
  return m;
}

// With every filter: shapers of three kinds, advance with knees, and gaps in the drives.
static Machine filtered(Machine m, const char* name, double box_s) {
  Filters& f = m.filters;
  m.name = name;
  f.set("shapers", 0, {0.365, 0, 0.407, 0.0075, 0.228, 0.015});
  f.set("shapers", 1, {0.58, 0, 0.42, 0.01});
  f.set("shapers", 2, {0.22, 0, 0.28, 0.0108, 0.26, 0.0206, 0.165, 0.0301, 0.075, 0.0397});
  f.set("smooth_s", 0, {0.02});
  f.set("knees", 0, {1.0, 0.5, 3.0, 0.1});
  f.set("gaps", 0, {0.1, 1.5});
  f.set("gaps", 2, {0.05, 0.5});
  f.set("box_s", 0, {box_s});
  m.extruders[0].advance_s = 0.05;
  return m;
}

static void run(const Machine& m, const std::string& program) {
  Job job(m, {0, 0, 0}, {}, true, nullptr);
  job.interpreter.clamp = true;
  job.interpreter.feed(program.data(), program.size());
  job.interpreter.finish();
  std::vector<uint64_t> names;
  for (const StepperSpec& s : m.steppers) names.push_back(wire::StreamHash::of_name(s.name));
  wire::StreamHash hash;
  long commands = 0;
  auto take = [&] {
    MessageQueue& queue = job.motion.stream().messages(0);
    for (; !queue.empty(); queue.pop(), ++commands)
      hash.add(queue.front(), names[queue.front().target]);
  };
  for (Job::Status status; (status = job.advance(kInfinity, 4096)) != Job::Status::end;) {
    if (status == Job::Status::error) {
      std::printf("%s: error in line %u\n", m.name.c_str(), job.error().line);
      return;
    }
    take();
  }
  job.motion.flush();
  take();
  std::printf("%s %ld %016llx\n", m.name.c_str(), commands, (unsigned long long)hash.value());
}

static std::string text_of(const char* path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

int main(int files, char** argv) {
  std::string program = text_of(argv[1]);
  run(machine("cartesian", {}, 80, 300), program);
  run(machine("corexy", {}, 80, 500), program);
  GeometryParams towers{{"radius", {174.75}},
                        {"rods", {333, 333, 333}},
                        {"angles", {210, 330, 90}},
                        {"limit_radius", {170}}};
  run(machine("delta", towers, 80, 600), program);
  run(machine("rotary_delta",
              {{"effector_length", {10}},
               {"base_length", {127.43}},
               {"rod_length", {320}},
               {"arm_length", {170}},
               {"z_offset", {412.9}}},
              222.917, 1000),
      program);
  run(machine("scara",
              {{"arm1", {150}},
               {"arm2", {150}},
               {"external_motor", {1}},
               {"x_offset", {-60}},
               {"y_offset", {-60}},
               {"middles", {0, 0}}},
              100, 600),
      program);
  Machine short_of_commands = machine("cartesian", {}, 80, 300);
  short_of_commands.name = "short of commands";
  short_of_commands.budgets = {{20000, 600, 40, true}};
  run(short_of_commands, program);
  Machine bent = machine("delta", towers, 80, 600);
  bent.name = "above a bent bed";
  std::vector<double> heights{0.1, -0.2, 0.3, 0.5, 0, -0.4, 0.2, 0.2, -0.1};
  bent.height_map = std::make_shared<HeightMap>(-70, -50, 61, 47, 3, 3, heights);
  run(bent, program);
  run(filtered(machine("cartesian", {}, 80, 300), "filtered", 0), program);
  run(filtered(machine("cartesian", {}, 80, 300), "filtered, of limited jerk", 0.03), program);
  run(filtered(machine("corexy", {}, 80, 500), "filtered corexy", 0), program);
  run(filtered(machine("delta", towers, 80, 600), "filtered delta", 0), program);
  for (int i = 2; i < files; ++i) {
    Machine plain = machine("cartesian", {}, 80, 300);
    plain.name = std::filesystem::path(argv[i]).stem().string();
    run(plain, text_of(argv[i]));
  }
  return 0;
}
