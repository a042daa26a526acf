#include "rbvi/par/node_memory.hpp"

#include "rbvi/par/collective.hpp"

#include <array>
#include <fstream>
#include <limits>
#include <string>

namespace rbvi {

namespace {

double available_bytes() {
  std::ifstream file("/proc/meminfo");
  std::string name, unit;
  for (double kilobytes = 0; file >> name >> kilobytes;) {
    if (name == "MemAvailable:") return 1024 * kilobytes;
    std::getline(file, unit);
  }
  return std::numeric_limits<double>::infinity();
}

} // namespace

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
