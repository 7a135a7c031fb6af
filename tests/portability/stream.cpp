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
  m.limits = {2000, 2500, 3000, 250, JunctionLaw::deviation, 0.02, 0.0, 0.1};
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
  short_of_commands.budget = {20000, 600, 40, true};
  run(short_of_commands, program);
  Machine bent = machine("delta", towers, 80, 600);
  bent.name = "above a bent bed";
  std::vector<double> heights{0.1, -0.2, 0.3, 0.5, 0, -0.4, 0.2, 0.2, -0.1};
  bent.height_map = std::make_shared<HeightMap>(-70, -50, 61, 47, 3, 3, heights);
  run(bent, program);
  for (int i = 2; i < files; ++i) {
    Machine plain = machine("cartesian", {}, 80, 300);
    plain.name = std::filesystem::path(argv[i]).stem().string();
    run(plain, text_of(argv[i]));
  }
  return 0;
}
