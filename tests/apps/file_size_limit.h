#pragma once
// Limits the size of files, as on a full disk, for programs that start during its lifetime (`ulimit -f`).

#include <gtest/gtest.h>
#include <sys/resource.h>

namespace sf {

struct FileSizeLimit {
  explicit FileSizeLimit(rlim_t bytes) {
    EXPECT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
    const rlimit small{bytes, before.rlim_max};
    EXPECT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  }
  ~FileSizeLimit() { setrlimit(RLIMIT_FSIZE, &before); }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

  rlimit before{};
};

}  // namespace sf
