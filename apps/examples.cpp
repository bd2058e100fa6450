#include "apps/examples.h"

namespace sf::apps {

namespace {

struct Example {
  std::string_view subcommand;
  std::string_view arguments;
};

constexpr Example kExamples[] = {
    {"devices", "--json"},
    {"check", "worlds/cave.world"},
    {"check", "worlds/simville/simville.mdf --rndf worlds/simville/simville.rndf"},
    {"draw", "worlds/simville/simville.world -o simville.png"},
    {"field", "worlds/six_magnets.world --height 0.05 -o field.png"},
    {"sense", "worlds/rooms.world --pose 1,2,90"},
    {"sense", "worlds/rooms.world --robot roomba1 --kind laser --json"},
    {"plot", "out/run"},
    {"explain", "worlds/simville/simville.world"},
    {"run", "worlds/cave.world --robots 50 --duration 30"},
    {"run", "worlds/cave.world --robots 4 --record out/run"},
    {"run", "worlds/cave.world --robots 4 --send 127.0.0.1 --real-time"},
    {"serve", "worlds/rooms.world"},
    {"serve", "worlds/rooms.world --bind 0.0.0.0 --port 9001"},
    {"robot", "worlds/testpath/testpath.world --name roomba0 --controller lane-keeping --duration 30"},
    {"robot", "worlds/rooms.world --name roomba1 --server 192.168.1.5 --loss 0.1 --delay 0.05"},
    {"start", "--robot 2"},
    {"listen", "worlds/cave.world --robots 4"},
    {"map", "--listen 52008 -o map.png"},
    {"experiment", "--list"},
    {"experiment", "mapping -o out/mapping"},
    {"test", "experiments/mapping.toml --junit results.xml"},
    {"verify", "out/run"},
    {"tradeoff", "worlds/cave.world --max-error 5mm"},
    {"selftest", "--list"},
    {"help", "run"},
};

}  // namespace

std::string examples_of(std::string_view subcommand) {
  std::string text;
  for (const Example& example : kExamples) {
    if (example.subcommand != subcommand) continue;
    text += text.empty() ? "Examples:" : "";
    text += "\n  sensorfarm " + std::string(subcommand) + " " + std::string(example.arguments);
  }
  return text;
}

}  // namespace sf::apps
