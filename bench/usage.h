#pragma once
// Main functions of benchmarks with positional arguments.

#include <cstdio>
#include <exception>
#include <string_view>

namespace sf::bench {

/// Runs a benchmark. Prints its usage instead for --help and unknown options, and after errors.
/// @param usage its name and its arguments  @param run () -> exit code
/// @return the exit code: that of `run`, 0 for --help, 2 for other options and after errors
template <class Run>
int run_main(int count, char** arguments, const char* usage, const Run& run) {
  for (int i = 1; i < count; ++i) {
    const std::string_view word = arguments[i];
    if (!word.starts_with('-')) continue;
    const bool help = word == "--help" || word == "-h";
    std::fprintf(help ? stdout : stderr, "usage: %s\n", usage);
    return help ? 0 : 2;
  }
  try {
    return run();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\nusage: %s\n", error.what(), usage);
    return 2;
  }
}

}  // namespace sf::bench
