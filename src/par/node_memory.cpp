#include "rbvi/par/node_memory.hpp"

#include "rbvi/par/collective.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <limits>
#include <string>

namespace rbvi {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// The number behind a name at the beginning of a line; without a name the first of the file.
double number_in(const std::filesystem::path &path, const std::string &name, double otherwise) {
  std::ifstream file(path);
  std::string word, rest;
  double value = 0;
  while (name.empty() || file >> word) {
    if (word == name) return file >> value ? value : otherwise;
    std::getline(file, rest);
  }
  return otherwise;
}

double available_bytes() {
  const double kilobytes = number_in("/proc/meminfo", "MemAvailable:", infinite);
  return std::min(1024 * kilobytes, left_by_groups());
}

} // namespace

double left_by_groups(const std::filesystem::path &file, const std::filesystem::path &root) {
  std::ifstream groups(file);
  double left = infinite;
  for (std::string line; std::getline(groups, line);) { // "0::/a/b", "4:memory:/a/b"
    const bool second = line.starts_with("0::");        // version of the groups
    if (!second && line.find(":memory:") == std::string::npos) continue;
    const std::filesystem::path base = second ? root : root / "memory";
    for (std::filesystem::path group = line.substr(line.rfind(':') + 1);;
         group = group.parent_path()) {
      const std::filesystem::path at = base / group.relative_path();
      const double bound =
          number_in(at / (second ? "memory.max" : "memory.limit_in_bytes"), "", infinite);
      const double used =
          number_in(at / (second ? "memory.current" : "memory.usage_in_bytes"), "", 0);
      const double caches =
          number_in(at / "memory.stat", second ? "inactive_file" : "total_inactive_file", 0);
      left = std::min(left, bound - used + caches);
      if (!group.has_relative_path()) break;
    }
  }
  return left;
}

NodeMemory tightest_node(MPI_Comm comm) {
  MPI_Comm node = MPI_COMM_NULL;
  MPI_Comm_split_type(comm, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &node);
  const int ranks = ranks_of(node);
  double bytes = available_bytes();
  MPI_Allreduce(MPI_IN_PLACE, &bytes, 1, MPI_DOUBLE, MPI_MIN, node);
  MPI_Comm_free(&node);
  struct {
    double share;
    int rank;
  } tightest{bytes / ranks, rank_of(comm)};
  MPI_Allreduce(MPI_IN_PLACE, &tightest, 1, MPI_DOUBLE_INT, MPI_MINLOC, comm);
  std::array<double, 2> found{static_cast<double>(ranks), bytes};
  MPI_Bcast(found.data(), 2, MPI_DOUBLE, tightest.rank, comm);
  return {static_cast<int>(found[0]), found[1]};
}

} // namespace rbvi
