// A file that all ranks read.
#pragma once

#include <mpi.h>
#include <petscsys.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace rbvi {

/// Collective. A file that the first rank writes before anyone reads, and removes after.
class TemporaryFile {
public:
  explicit TemporaryFile(const std::string &content) {
    MPI_Comm_rank(PETSC_COMM_WORLD, &rank_);
    int process = static_cast<int>(getpid());
    MPI_Bcast(&process, 1, MPI_INT, 0, PETSC_COMM_WORLD);
    path_ = std::filesystem::temp_directory_path() / ("rbvi_" + std::to_string(process) + ".msh");
    if (rank_ == 0) std::ofstream(path_, std::ios::binary) << content;
    MPI_Barrier(PETSC_COMM_WORLD);
  }
  TemporaryFile(const TemporaryFile &) = delete;
  TemporaryFile &operator=(const TemporaryFile &) = delete;
  ~TemporaryFile() {
    MPI_Barrier(PETSC_COMM_WORLD);
    std::error_code ignored;
    if (rank_ == 0) std::filesystem::remove(path_, ignored);
  }
  std::string name() const { return path_.string(); }

private:
  std::filesystem::path path_;
  int rank_ = 0;
};

} // namespace rbvi
