// Complete outputs of commands that need no network, compared with golden records: both streams, exit codes and files.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>

#include "tests/apps/golden.h"
#include "tests/apps/program.h"

namespace sf {

namespace {

struct Case {
  const char* name;
  std::vector<const char*> commands;  ///< run one after another; words are separated by spaces
  std::vector<const char*> files;     ///< in the folder, added to the record
  std::size_t every = 1;              ///< keeps every n-th line of a file
};

void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }

/// A small world with every kind of object: walls, a lane, magnets, a light, a dock, holes, two robots and all sensor
/// types.
constexpr const char* kYard = R"(
name "yard"
interval_sim 100
model( name "room" size [8 6 1] boundary 1 noblocks 0 )
model( name "box, red" pose [2 1 0 30] size [0.6 0.4 0.5] )
model( name "low" pose [-2 -1.5 0 0] size [1 0.5 0.05] )
position( name "anna" pose [-1 0 0 15] size [0.4 0.3 0.2]
  laser( samples 7 fov 120 range_max 6 size [0 0 0.1] noise [0.01 0 0] )
  ranger( sensor( pose [0.2 0 0 0] fov 30 range [0 4] ) )
  encoder( ) gyro( ) gps( rate 2 ) bumper( ) cliff( ) infrared( samples 3 ) )
position( name "bert" pose [1 -1.5 0 90] size [0.4 0.3 0.2] laser( samples 5 fov 360 range_max 3 ) )
)";

const Case kCases[] = {
    {"check", {"check FOLDER/yard.world", "check FOLDER/yard.world --json", "check W/simville/simville.world"}, {}},
    {"check_roads",
     {"check W/simville/simville.rndf", "check W/simville/simville.rndf --json",
      "check W/simville/simville.mdf --rndf W/simville/simville.rndf",
      "check W/simville/simville.mdf --rndf W/simville/simville.rndf --json",
      "check W/cave.world --accuracy near3 --rate 5", "check W/six_magnets.world --json --accuracy near3"},
     {}},
    {"sense",
     {"sense FOLDER/yard.world", "sense FOLDER/yard.world --json", "sense FOLDER/yard.world --robot bert --json",
      "sense FOLDER/yard.world --robot bert --no-return inf --pose 0,0,10",
      "sense W/simville/simville.world --type magnetometer --json", "sense W/simville/simville.world --type laneedge",
      "sense W/simville/simville.world --type infrared --json", "sense W/simville/simville.world --type cliff",
      "sense W/simville/simville.world --type irreceiver --json", "sense W/simville/simville.world --type gps",
      "sense W/simville/simville.world --type bumper --json", "sense W/simville/simville.world --type gyro --json",
      "sense W/simville/simville.world --type encoder"},
     {}},
    {"explain", {"explain FOLDER/yard.world", "explain W/simville/simville.world --json"}, {}},
    {"run",
     {"run FOLDER/yard.world --duration 3 --seed 5 --record FOLDER/r --record-readings",
      "run FOLDER/yard.world --duration 1 --json --robots 5 --of bert", "verify FOLDER/r",
      "verify FOLDER/r --json --all", "verify FOLDER/r --sample 10"},
     {}},
    {"run_lane",
     {"run W/testpath/testpath.world --controller lane-keeping --duration 20 --record FOLDER/r",
      "run W/testpath/testpath.world --controller magnet-keeping --duration 20 --json"},
     {}},
    {"run_town",
     {"run W/simville/simville.world --controller route --set mission=simville.mdf --drive roomba0 --duration 12",
      "run W/simville/simville.world --controller route --set tour=true --drive roomba0 --drive roomba3 --duration 6 "
      "--json"},
     {}},
    {"export",
     {"run FOLDER/yard.world --duration 1 --record FOLDER/r --record-readings", "export FOLDER/r -o FOLDER/x",
      "export FOLDER/r -o FOLDER/y --robots bert --from 0.3 --to 0.6"},
     {"x/trajectories.csv", "x/laser.csv", "x/infrared.csv", "y/trajectories.csv", "y/laser.csv"},
     12},
    {"export_town",
     {"run W/simville/simville.world --duration 3 --record FOLDER/r --record-readings", "export FOLDER/r -o FOLDER/x"},
     {"x/lights.csv", "x/magnetometer.csv", "x/laneedge.csv", "x/infrared.csv", "x/gps.csv", "x/gyro.csv",
      "x/encoder.csv"},
     93},
    {"plot",
     {"run FOLDER/yard.world --duration 2 --record FOLDER/r --record-readings",
      "plot FOLDER/r --csv -o FOLDER/p --format svg",
      "plot FOLDER/r -o FOLDER/q --robots bert --from 0.5 --to 1.5 --csv"},
     {"p/trajectories.csv", "p/infrared.csv", "p/gps.csv", "q/trajectories.csv"},
     40},
    {"field",
     {"field W/six_magnets.world --height 0.05 -o FOLDER/f.svg --csv FOLDER/f.csv",
      "field W/six_magnets.world --height 0.1 -o FOLDER/g.svg --csv FOLDER/g.csv --line 0,0.1,1,0.2 --extent "
      "-1,-1,3,2"},
     {"f.csv", "g.csv"},
     155},
    {"v2x",
     {"v2x export W/simville/simville.world --time 9",
      "v2x export W/simville/simville.world --latitude 40.7 --longitude -112"},
     {}},
    {"tests", {"test W/../experiments/mapping.toml --junit FOLDER/j.xml", "experiment --list"}, {"j.xml"}},
    {"selftest", {"selftest numbers --json", "selftest times numbers"}, {}},
    {"sweep",
     {"sweep W/../experiments/sweeps/lane-edge.toml --list",
      "sweep W/../experiments/sweeps/lane-edge.toml -o FOLDER/s --slurm --tasks 4 --sbatch=--time=1:00:00"},
     {"s/sweep.sbatch"}},
};

std::string some_lines(const std::string& text, std::size_t every) {
  std::string some, line;
  std::size_t number = 0;
  for (const char c : text) {
    line += c;
    if (c != '\n') continue;
    if (number % every == 0) some += line;
    ++number;
    line.clear();
  }
  return some + line + (every > 1 ? fmt::format("({} lines in all)\n", number) : "");
}

Words words_of(const std::string& command, const Folder& folder) {
  Words words;
  for (std::size_t at = 0, end = 0; at < command.size(); at = end + 1) {
    end = std::min(command.find(' ', at), command.size());
    std::string word = command.substr(at, end - at);
    if (const std::size_t own = word.find("FOLDER/"); own != std::string::npos) word.replace(own, 7, folder.path());
    if (word.starts_with("W/")) word = our_world(word.substr(2));
    words.push_back(word);
  }
  return words;
}

class CommandRecords : public testing::TestWithParam<Case> {};

}  // namespace

TEST_P(CommandRecords, MatchTheirRecord) {
  const Folder folder;
  folder.write("yard.world", kYard);
  std::string text;
  for (const char* const command : GetParam().commands) {
    const Outcome outcome = run_program(words_of(command, folder), {{"SENSORFARM_CASTER", "host"}});
    text += fmt::format("===== {}\n{}--- exit {}\n{}", command, outcome.out, outcome.code, outcome.err);
  }
  for (const char* const name : GetParam().files)
    text += fmt::format("===== file {}\n{}", name, some_lines(read_file(folder.path(name)), GetParam().every));
  expect_golden(GetParam().name, without_machine(text, folder.path()));
}

INSTANTIATE_TEST_SUITE_P(Apps, CommandRecords, testing::ValuesIn(kCases),
                         [](const auto& one) { return std::string(one.param.name); });

}  // namespace sf
