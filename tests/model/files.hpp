// Files that tests of models write and read.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <unistd.h>
#include <vector>

namespace rbvi {

/// A directory of its own for the files of a test.
struct InOwnDirectory : testing::Test {
  std::filesystem::path directory =
      std::filesystem::path(testing::TempDir()) / ("rbvi_model_" + std::to_string(::getpid()));
  void SetUp() override { std::filesystem::create_directories(directory); }
  void TearDown() override { std::filesystem::remove_all(directory); }
};

inline std::string slurp(const std::filesystem::path &path) {
  std::ostringstream bytes;
  bytes << std::ifstream(path, std::ios::binary).rdbuf();
  return bytes.str();
}

/// The numbers of one DataArray of a VTU file in ASCII.
inline std::vector<double> data_array(const std::string &vtu, const std::string &name) {
  const std::size_t begin = vtu.find('>', vtu.find("Name=\"" + name + "\"")) + 1;
  std::istringstream text(vtu.substr(begin, vtu.find('<', begin) - begin));
  return {std::istream_iterator<double>(text), {}};
}

} // namespace rbvi
