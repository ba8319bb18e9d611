// Pins: whatever is asked wrongly gets one line on standard error that says what to do, nothing on standard
// output, and the exit code of its kind: 2 for the command line, 1 for what this machine or a file refuses.
#include <doctest/doctest.h>

#include <algorithm>
#include <sstream>
#include <string>

#include "command_support.h"

using namespace pcphys::test;

namespace {

const Refused cases[] = {
    {"", 2, "A subcommand is required"},
    {"fly", 2, "fly"},
    {"run", 2, "SCENE"},
    {"run marbles", 2, "choose one of balls, ragdolls"},
    {"plan marbles", 2, "choose one of balls"},
    {"run balls --colour red", 2, "--colour"},
    {"run balls 60", 2, "60"},
    {"run balls --count", 2, "--count"},
    {"run balls --count -1", 2, "--count is -1"},
    {"run balls --count many", 2, "many"},
    {"run balls --count 1.5", 2, "1.5"},
    {"run balls --count 900000000", 2, "from 0 to"},
    {"run balls --steps 0", 2, "--steps is 0"},
    {"run balls --steps -3", 2, "--steps is -3"},
    {"run balls --dt 0", 2, "--dt is '0'"},
    {"run balls --dt -0.01", 2, "--dt"},
    {"run balls --dt nan", 2, "time step above 0"},
    {"run balls --dt 1/0", 2, "--dt"},
    {"run balls --dt inf", 2, "--dt"},
    {"run balls --dt soon", 2, "--dt"},
    {"run balls --substeps 0", 2, "--substeps is 0"},
    {"run balls --warmup 600", 2, "--warmup is 600"},
    {"run balls --precision half", 2, "float, double"},
    {"run balls --lanes 3", 2, "auto, 1, 4, 8"},
    {"run balls --lanes 8 --precision double", 2, "1 and 4 lanes"},
    {"run balls --threads 257", 2, "--threads is 257"},
    {"run balls --threads -1", 2, "--threads is -1"},
    {"compare balls --sleep on", 2, "keep everything awake"},
    {"run balls --sleep maybe", 2, "on, off"},
    {"run balls --integrator rk4", 2, "verlet"},
    {"run balls --backend cuda", 2, "cpu or gl"},
    {"run balls --joints gpu", 2, "--joints is 'gpu'"},
    {"run balls --narrow wide", 2, "native, fcl"},
    {"run balls --device -2", 2, "--device is -2"},
    {"run balls --seed -1", 2, "--seed is -1"},
    {"run chain --ratio 0", 2, "above 0"},
    {"run chain --ratio nan", 2, "above 0"},
    {"run balls --friction -1", 2, "friction"},
    {"run balls --restitution nan", 2, "restitution"},
    {"run balls --drag -1", 2, "drag"},
    {"run ragdolls --joint-damping -1", 2, "joint-damping"},
    {"run balls --gltf motion.obj", 2, ".gltf or .glb"},
    {"run balls --json - --hash", 2, "Standard output is asked for by --json and by --hash"},
    {"run balls --json - --csv -", 2, "Standard output is asked for by --json and by --csv"},
    {"run balls --json - --json a.json", 2, "--json"},
    {"run balls --json ''", 2, "--json: The value is empty"},
    {"run balls --dt ''", 2, "--dt: The value is empty"},
    {"run ''", 2, "SCENE: The value is empty"},
    {"run balls --json .", 1, "Is a directory"},
    {"run balls --steps 1 --json /dev/full", 1, "No space left on device"},
    {"run balls --json /no/such/folder/a.json", 1, "/no/such/folder/a.json"},
    {"run balls --csv /no/such/folder/a.csv", 1, "folder that exists"},
    {"run balls --gltf /no/such/folder/a.glb", 1, "folder that exists"},
    {"tables --json /no/such/folder/a.json", 1, "folder that exists"},
    {"scenes --json /no/such/folder/a.json", 1, "folder that exists"},
    {"doctor --csv /no/such/folder/a.csv", 1, "folder that exists"},
    {"plan balls --json /no/such/folder/a.json", 1, "folder that exists"},
    {"run balls --backend gl --device 99", 1, "99"},
    {"plan balls --steps 1 --backend gl --device 99", 1, "99"},
    {"accuracy A99", 2, "no case 'A99' here; choose of A1, "},
    {"accuracy B1", 2, "no case 'B1'"},
    {"stability A1", 2, "no case 'A1'"},
    {"accuracy A2 --precision half", 2, "float, double, both"},
    {"accuracy A2 --dt soon", 2, "--dt is 'soon'"},
    {"accuracy A2 --repeats 0", 2, "--repeats is 0"},
    {"accuracy A2 --backend cuda", 2, "cpu, gl"},
    {"accuracy A2 --json /no/such/folder/a.json", 1, "folder that exists"},
    {"compare marbles", 2, "choose one of balls"},
    {"compare balls:many", 2, "balls:1000"},
    {"compare balls:-1", 2, "--count is -1"},
    {"compare balls --peers havok", 2, "mujoco-rk4"},
    {"compare balls --peer-substeps -1", 2, "--peer-substeps is -1"},
    {"compare balls --peer-iterations -1", 2, "--peer-iterations is -1"},
    {"compare balls --budget 0", 2, "--budget"},
    {"compare balls --budget inf", 2, "--budget"},
    {"compare balls --steps 0", 2, "--steps is 0"},
    {"compare balls --json - --csv -", 2, "--json and by --csv"},
    {"compare balls --json /no/such/folder/a.json", 1, "folder that exists"},
};

}  // namespace

TEST_CASE("errors: one line, the right code, nothing on standard output") { check_refused(cases); }

TEST_CASE("errors: every option that takes a number refuses what is none, or has no place in 64 bits") {
  std::size_t tried = 0;
  for (const char* sub_command :
       {"run balls", "plan balls", "tables", "accuracy A1", "stability B1", "compare balls", "wild floor"}) {
    std::istringstream help(command(std::string(sub_command) + " --help").out);
    for (std::string line; std::getline(help, line);) {
      std::istringstream words(line);
      std::string option, type;
      words >> option >> type;
      const bool whole = type.starts_with("INT"), real = type.starts_with("FLOAT");
      if (!whole && !real) continue;
      tried++;
      for (const char* value : {"''", "' '", "1x", "1,5", whole ? "36893488147419103232" : "1e400"}) {
        const std::string arguments = std::string(sub_command) + " " + option + " " + value;
        const Refused refused{arguments.c_str(), 2, option.c_str()};
        check_refused({&refused, 1});
      }
    }
  }
  CHECK(tried > 50);
}

TEST_CASE("errors: numbers are decimal, with leading zeros too") {
  const std::string run = "run balls --steps 1 --hash --count ";
  CHECK(command(run + "010").out == command(run + "10").out);
}

TEST_CASE("errors: an unwritable file is noticed before the run, and a failed run leaves no file behind") {
  Folder folder;
  const Ran ran = command("run balls --steps 1000000000 --json /no/such/folder/a.json");  // would take days
  CHECK(ran.code == 1);
  const std::string json = folder.file("a.json");
  CHECK(command("run marbles --json " + json).code == 2);
  CHECK_FALSE(std::filesystem::exists(json));
  std::ofstream(json) << "kept";
  CHECK(command("run marbles --json " + json).code == 2);
  CHECK(read_file(json) == "kept");
}

TEST_CASE("errors: gl never falls back to the CPU in silence") {
  const Ran ran = command("run balls --count 1 --steps 1 --impulses gl --device 99 --json -");
  CHECK(ran.code == 1);
  CHECK(ran.out.empty());
}
