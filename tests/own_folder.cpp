// A temporary folder per test program, removed at its end: programs run concurrently, and tests use fixed file names.

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

namespace {

struct OwnFolder {
  std::string path = (std::filesystem::temp_directory_path() / "sensorfarm_tests_XXXXXX").string();
  pid_t owner = getpid();

  OwnFolder() {
    if (mkdtemp(path.data()) == nullptr) {
      std::perror("a folder for temporary files");
      std::exit(1);
    }
    setenv("TMPDIR", path.c_str(), 1);               // the standard library's
    setenv("TEST_TMPDIR", (path + "/").c_str(), 1);  // googletest's
  }
  ~OwnFolder() {
    std::error_code ignored;
    if (getpid() == owner) std::filesystem::remove_all(path, ignored);
  }
};

const OwnFolder folder;

}  // namespace
