// The architecture as a test: which module may include which, and which module wraps each heavy library.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace sf {

namespace {

namespace fs = std::filesystem;
using Modules = std::set<std::string>;

// Modules that each module may include, in addition to itself. `shaders` means the compiled kernels, which only their
// hosts may include.
const std::map<std::string, Modules> kMayInclude{
    {"base", {}},
    {"gpu", {"base", "shaders"}},
    {"world", {"base"}},
    {"robots", {"world", "base"}},
    {"robots/device", {"robots", "world", "gpu", "base", "shaders"}},
    {"robots/estimation", {"robots", "world", "base"}},
    {"maps", {"base"}},
    {"raycast", {"robots/device", "world", "gpu", "base", "shaders"}},
    {"scene", {"world", "base"}},
    {"scene/device", {"scene", "gpu", "base", "shaders"}},
    {"sensors",
     {"sensorfarm", "scene/device", "scene", "raycast", "maps", "robots/estimation", "robots", "world", "gpu", "base",
      "shaders"}},
    {"sensorfarm", {}},
    {"python", {"sensorfarm"}},
    {"control", {"sensorfarm", "sensors", "vision", "maps", "robots/estimation", "robots", "world", "base"}},
    {"shaders", {"raycast", "robots/device", "scene/device", "sensors", "maps", "base"}},
    {"farm", {"sensors", "raycast", "maps", "robots", "world", "gpu", "base"}},
    {"record", {"maps", "base"}},
    {"netio", {"base"}},
    {"v2x", {"base"}},
    {"server",
     {"netio", "v2x", "control", "farm", "record", "sensors", "raycast", "maps", "robots/estimation", "robots", "world",
      "gpu", "base"}},
    {"bridges", {"netio", "record", "scene", "sensors", "raycast", "maps", "robots", "world", "gpu", "base"}},
    {"selftest", {"farm", "scene", "sensors", "raycast", "maps", "robots", "world", "gpu", "base"}},
    {"vision", {"world", "base"}},
    {"vision/rendering", {"vision", "sensors", "scene", "base"}},
    {"viz", {"farm", "record", "sensors", "scene", "raycast", "maps", "robots", "world", "gpu", "base"}},
    {"cluster", {"base"}},
    {"scenarios",
     {"selftest", "cluster", "viz", "vision/rendering", "vision", "server", "bridges", "netio", "record", "farm",
      "control", "sensors", "raycast", "maps", "robots/estimation", "robots", "world", "gpu", "base"}},
};
const Modules kMayIncludeAnything{"apps", "examples", "library", "bench", "tests"};

// Libraries that cost seconds per file that includes them: never in a header, in one source each unless said here, some
// in one module only.
struct Heavy {
  std::string prefix;
  std::string module;  ///< empty: any
  std::size_t sources = 1;
};
const std::vector<Heavy> kHeavy{{"CLI/", "apps", 8},
                                {"nlohmann/", "", 6},
                                {"vtk", "viz", 3},
                                {"cairo", "viz"},
                                {"libav", "viz"},
                                {"libswscale", "viz"},
                                {"mpi.h", "cluster"},
                                {"opencv2/", "vision", 6},
                                {"boost/asio", "bridges", 2},
                                {"boost/beast", "bridges"},
                                {"dds/", "bridges", 2},
                                {"fastdds/", "bridges"},
                                {"fastrtps/", "bridges"},
                                {"gdal", "world", 2},
                                {"ogr", "world", 2},
                                {"cpl_", "world"},
                                {"tiny_gltf", "world"},
                                {"assimp/", "world"},
                                {"urdf_parser/", "world"},
                                {"sodium", "netio"},
                                {"zstd.h", "record"},
                                {"spng.h", "", 3},
                                {"jpeglib.h", "base"},
                                {"muParser", "sensors"},
                                {"yaml-cpp/", ""},
                                {"toml++/", ""},
                                {"Eigen/", "robots/estimation", 11},
                                {"unsupported/Eigen/", "robots/estimation"},
                                {"embree", "bench", 2}};

// The machine's sockets, which only netio opens.
const std::vector<std::string> kSockets{"sys/socket.h", "netinet/", "arpa/",     "netdb.h",
                                        "sys/epoll.h",  "poll.h",   "sys/poll.h"};

struct Source {
  std::string path;  ///< from the root, e.g. "viz/canvas.cpp"
  std::string text;
};

bool starts_with(const std::string& text, const std::string& prefix) {
  return text.compare(0, prefix.size(), prefix) == 0;
}
bool is_header(const std::string& path) { return fs::path(path).extension() == ".h"; }
/// The first folder, or a folder below it that is a module of its own.
std::string module_of(const std::string& path) {
  const std::size_t first = path.find('/');
  const std::string two = path.substr(0, path.find('/', first == std::string::npos ? first : first + 1));
  return kMayInclude.count(two) > 0 ? two : path.substr(0, first);
}

std::string complain_of_quoted(const Source& source, const std::string& target) {
  const std::string from = module_of(source.path);
  const std::string to = module_of(target);
  const bool known =
      target.find('/') != std::string::npos && (kMayInclude.count(to) > 0 || kMayIncludeAnything.count(to) > 0);
  if (!known) return "is not a full path from the root";
  if (from == to || kMayIncludeAnything.count(from) > 0) return "";
  const auto row = kMayInclude.find(from);
  if (row == kMayInclude.end()) return "is in a module that is not in the plan";
  if (row->second.count(to) == 0) return "points from " + from + " to " + to + ", which is not in the plan";
  if (to == "shaders" && !std::regex_match(target, std::regex("shaders/\\w+\\.comp\\.h")))
    return "is not a compiled kernel";
  return "";
}

std::string complain_of_angled(const Source& source, const std::string& target) {
  const std::string module = module_of(source.path);
  if (module == "tests") return "";
  if (starts_with(target, "vulkan/") && module != "gpu") return "is for gpu only";
  if (starts_with(target, "pybind11/") && module != "python") return "is for python only";
  for (const std::string& sockets : kSockets)
    if (starts_with(target, sockets) && module != "netio") return "is for netio only";
  for (const Heavy& heavy : kHeavy) {
    if (!starts_with(target, heavy.prefix)) continue;
    if (is_header(source.path)) return "is too heavy for a header";
    if (!heavy.module.empty() && heavy.module != module) return "is for " + heavy.module + " only";
  }
  return "";
}

std::string complain_of_include(const Source& source, const std::string& rest) {
  static const std::regex kTarget("\\s*([\"<])([^\">]+)[\">].*");
  std::smatch m;
  if (!std::regex_match(rest, m, kTarget)) return "cannot be read";
  const std::string why = m[1] == "\"" ? complain_of_quoted(source, m[2]) : complain_of_angled(source, m[2]);
  return why;
}

/// Returns one text "path:line: statement: error" per violation.
std::vector<std::string> complaints(const Source& source) {
  static const std::regex kInclude("\\s*#\\s*include(.*)");
  static const std::regex kParser("\\blasers_of\\(");
  static const std::regex kVulkan("\\b(Vk|vk|PFN_vk)[A-Z]\\w*");
  const std::string module = module_of(source.path);
  std::vector<std::string> found;
  std::istringstream lines(source.text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    std::smatch m;
    std::string why;
    if (std::regex_match(line, m, kInclude)) {
      why = complain_of_include(source, m[1]);
    } else if (module != "gpu" && module != "tests" && std::regex_search(line, kVulkan)) {
      why = "names a type of Vulkan outside gpu";
    } else if (module != "sensors" && module != "tests" && std::regex_search(line, kParser)) {
      why = "parses settings again, which sensors::SensorSet has";
    }
    if (!why.empty()) found.push_back(source.path + ":" + std::to_string(number) + ": " + line + ": " + why);
  }
  return found;
}

/// Sources outside tests that include `heavy`.
std::vector<std::string> users_of(const Heavy& heavy, const std::vector<Source>& sources) {
  const std::regex include("#\\s*include\\s*<" + heavy.prefix);
  std::vector<std::string> users;
  for (const Source& source : sources)
    if (module_of(source.path) != "tests" && std::regex_search(source.text, include)) users.push_back(source.path);
  return users;
}

bool is_source(const fs::path& path) {
  static const std::set<std::string> kEndings{".h", ".cpp", ".comp", ".glsl"};
  return kEndings.count(path.extension().string()) > 0;
}

std::string read(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

bool is_module(const fs::path& folder) {
  const std::string name = folder.filename().string();
  return fs::is_directory(folder) && name[0] != '.' && !starts_with(name, "build") && name != "out" &&
         name != "node_modules";
}

/// Returns all sources of this project, including shaders.
std::vector<Source> read_sources() {
  std::vector<Source> sources;
  for (const auto& module : fs::directory_iterator(SF_SOURCE_DIR)) {
    if (!is_module(module.path())) continue;
    for (const auto& entry : fs::recursive_directory_iterator(module.path()))
      if (entry.is_regular_file() && is_source(entry.path()))
        sources.push_back({fs::relative(entry.path(), SF_SOURCE_DIR).generic_string(), read(entry.path())});
  }
  return sources;
}

}  // namespace

TEST(Layering, EveryArrowIsInThePlan) {
  const std::vector<Source> sources = read_sources();
  ASSERT_GT(sources.size(), 100u) << "the sources were not found";
  for (const Source& source : sources)
    for (const std::string& complaint : complaints(source)) ADD_FAILURE() << complaint;
}

TEST(Layering, EveryModuleIsInThePlan) {
  for (const Source& source : read_sources()) {
    const std::string module = module_of(source.path);
    EXPECT_TRUE(kMayInclude.count(module) > 0 || kMayIncludeAnything.count(module) > 0) << source.path;
  }
}

TEST(Layering, ThePlanHasNoCircles) {
  // The graph is acyclic: a module that A may include may not include A, at any distance.
  for (const auto& [module, below] : kMayInclude) {
    if (module == "shaders") continue;
    std::vector<std::string> open(below.begin(), below.end());
    Modules reached;
    while (!open.empty()) {
      const std::string next = open.back();
      open.pop_back();
      if (next == "shaders" || !reached.insert(next).second) continue;
      const Modules& more = kMayInclude.at(next);
      open.insert(open.end(), more.begin(), more.end());
    }
    EXPECT_EQ(reached.count(module), 0u) << module;
  }
}

TEST(Layering, HeavyLibrariesAreInFewSources) {
  const std::vector<Source> sources = read_sources();
  for (const Heavy& heavy : kHeavy) {
    const auto users = users_of(heavy, sources);
    EXPECT_LE(users.size(), heavy.sources) << heavy.prefix << " in " << testing::PrintToString(users);
  }
}

TEST(Layering, KernelsReadSharedHeadersOnly) {
  // A header that both compilers read says so with a guard, since GLSL has no `#pragma once`, and includes nothing.
  static const std::regex kOurs(
      "#\\s*include\\s*\"(shaders/)?((raycast|robots/device|scene/device|sensors|maps|base)/[^\"]+)\\.(h|glsl)\"");
  for (const Source& source : read_sources()) {
    if (module_of(source.path) != "shaders") continue;
    for (std::sregex_iterator m(source.text.begin(), source.text.end(), kOurs), end; m != end; ++m) {
      const std::string header = read(fs::path(SF_SOURCE_DIR) / ((*m)[2].str() + ".h"));
      EXPECT_NE(header.find("#ifndef"), std::string::npos) << source.path << " includes " << (*m)[2];
      EXPECT_EQ(header.find("#pragma once"), std::string::npos) << source.path << " includes " << (*m)[2];
    }
  }
}

/// The C library's functions differ in their last bit between processors; base/elementary.h has the portable ones. Not
/// among them: the reference caster, which computes in long double, and modules whose results are read by people.
TEST(Layering, ResultsDependOnNoCLibrary) {
  static const std::regex kOfTheLibrary(
      "std::(sin|cos|tan|a?sin|a?cos|atan2?|exp2?|log2?|log10|hypot|pow|cbrt|erfc?)\\(");
  const Modules computing{"base", "world", "raycast", "robots", "robots/estimation", "sensors",
                          "maps", "farm",  "control", "v2x",    "scenarios",         "library"};
  for (const Source& source : read_sources()) {
    if (!computing.contains(module_of(source.path)) || source.path.starts_with("raycast/reference_caster")) continue;
    std::smatch found;
    EXPECT_FALSE(std::regex_search(source.text, found, kOfTheLibrary)) << source.path << ": " << found.str();
  }
}

// Tests of the judge: each rule is broken once, next to a similar line that is allowed.
TEST(LayeringJudge, TakesWhatThePlanAllows) {
  for (const Source& fine :
       std::vector<Source>{{"base/a.cpp", "#include \"base/a.h\"\n#include <vector>\n"},
                           {"viz/a.cpp", "#include \"farm/farm.h\"\n#include <vtkNew.h>\n"},
                           {"gpu/a.h", "#include <vulkan/vulkan.h>\nVkBuffer buffer;\n"},
                           {"gpu/a.cpp", "#include \"shaders/a.comp.h\"\n"},
                           {"netio/a.cpp", "#include <sys/socket.h>\n"},
                           {"shaders/a.comp", "#include \"raycast/records.h\"\n"},
                           {"apps/a.cpp", "#include <CLI/CLI.hpp>\n#include \"netio/inbox.h\"\n"},
                           {"tests/a.cpp", "#include <nlohmann/json.hpp>\n#include \"gpu/device_vk.h\"\n"},
                           {"sensors/a.cpp", "for (auto& laser : lasers_of(mover)) {"},
                           {"world/a.cpp", "// #include \"gpu/device.h\"\nstruct Vkontakte {};\n"}})
    EXPECT_TRUE(complaints(fine).empty()) << testing::PrintToString(complaints(fine));
}

TEST(LayeringJudge, FindsEachBrokenRule) {
  for (const Source& broken : std::vector<Source>{
           {"base/a.cpp", "#include \"world/world.h\""},                    // upwards
           {"world/a.cpp", "#include \"robots/fleet.h\""},                  // upwards, one floor
           {"netio/a.cpp", "#include \"record/mcap.h\""},                   // sideways
           {"farm/a.cpp", "#include \"netio/inbox.h\""},                    // the farm has no sockets
           {"netio/a.cpp", "#include \"server/service.h\""},                // upwards, within one folder
           {"server/a.cpp", "#include <sys/socket.h>"},                     // sockets are netio's
           {"robots/a.cpp", "#include \"robots/estimation/state.h\""},      // upwards, within one folder
           {"robots/a.cpp", "#include <Eigen/Core>"},                       // Eigen is the estimation's
           {"v2x/a.cpp", "#include \"netio/packets.h\""},                   // messages do not depend on packets
           {"control/a.cpp", "#include \"farm/farm.h\""},                   // controllers do not depend on the farm
           {"viz/a.cpp", "#include \"apps/options/options.h\""},            // no module may include the program
           {"shaders/a.comp", "#include \"world/world.h\""},                // kernels read records only
           {"sensors/a.cpp", "#include \"shaders/lib/list_search.glsl\""},  // hosts read compiled kernels only
           {"world/a.cpp", "#include \"shape.h\""},                         // not from the root
           {"world/a.cpp", "#include \"../gpu/device_vk.h\""},              // not from the root
           {"attic/a.cpp", "#include \"base/pose.h\""},                     // a module without a row
           {"world/a.cpp", "  #  include<vulkan/vulkan.h>"},                // Vulkan's header
           {"world/a.cpp", "VkDevice device;"},                             // Vulkan's types
           {"farm/a.cpp", "vkQueueSubmit(queue);"},                         // Vulkan's functions
           {"viz/a.cpp", "for (auto& laser : lasers_of(mover)) {"},         // settings are parsed once
           {"record/a.cpp", "#include <vtkImageData.h>"},                   // VTK's door is viz
           {"apps/a.h", "#include <CLI/CLI.hpp>"},                          // in a header
           {"viz/a.h", "#include <vtkNew.h>"},                              // in a header, in the right module
           {"world/a.cpp", "#include <CLI/App.hpp>"},                       // the command line is the program's
           {"apps/a.cpp", "#include <poll.h>"},                             // sockets are netio's
           {"robots/a.cpp", "#include <netinet/in.h>"},                     // sockets are netio's
           {"control/a.cpp", "#include <pybind11/embed.h>"},                // Python's headers
           {"python/a.cpp", "#include \"farm/farm.h\""},                    // Python uses only the public interface
           {"base/a.cpp", "#include HEADER"}})                              // cannot be judged
    EXPECT_EQ(complaints(broken).size(), 1u) << broken.path << ": " << broken.text;
}

TEST(LayeringJudge, NamesFileAndLine) {
  const auto found = complaints({"base/a.cpp", "// one\n// two\n#include \"gpu/device_vk.h\"\n"});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(starts_with(found[0], "base/a.cpp:3: ")) << found[0];
}

TEST(LayeringJudge, CountsUsersOfHeavyLibraries) {
  const std::vector<Source> sources{{"apps/a.cpp", "#include <CLI/CLI.hpp>"},
                                    {"apps/b.cpp", "#include <CLI/App.hpp>"},
                                    {"tests/c.cpp", "#include <CLI/CLI.hpp>"}};
  EXPECT_EQ(users_of({"CLI/", "apps", 6}, sources).size(), 2u);
}

}  // namespace sf
