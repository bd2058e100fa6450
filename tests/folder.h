#pragma once
// A folder for the files of one test.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace sf {

class FolderTest : public ::testing::Test {
 protected:
  FolderTest() { std::filesystem::create_directories(folder_); }
  ~FolderTest() override { std::filesystem::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  /// Returns the path of the written file.
  std::string write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return path(name);
  }
  const std::filesystem::path folder_ = std::filesystem::path(::testing::TempDir()) / "files";
};

}  // namespace sf
