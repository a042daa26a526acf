#include "rbvi/par/collective.hpp"

#include "rbvi/core/error.hpp"

#include <array>
#include <optional>
#include <string>

namespace rbvi {

namespace {

std::optional<Error> failure_of(const std::function<void()> &work) {
  try {
    work();
  } catch (const Error &error) {
    return error;
  } catch (const std::exception &error) {
    return failure(error.what());
  } catch (...) {
    return failure("something that is not a C++ exception was thrown");
  }
  return std::nullopt;
}

} // namespace

int rank_of(MPI_Comm comm) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  return rank;
}

int ranks_of(MPI_Comm comm) {
  int ranks = 1;
  MPI_Comm_size(comm, &ranks);
  return ranks;
}

void collectively(MPI_Comm comm, const std::function<void()> &work) {
  const std::optional<Error> mine = failure_of(work);
  const int rank = rank_of(comm), size = ranks_of(comm);
  int first = mine ? rank : size;
  MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, comm);
  if (first == size) return;

  std::string message = rank == first ? mine->what() : "";
  std::array<int, 2> head{rank == first ? static_cast<int>(mine->status()) : 0,
                          static_cast<int>(message.size())};
  MPI_Bcast(head.data(), 2, MPI_INT, first, comm);
  message.resize(head[1]);
  MPI_Bcast(message.data(), head[1], MPI_CHAR, first, comm);
  throw Error(static_cast<Status>(head[0]), message);
}

} // namespace rbvi
