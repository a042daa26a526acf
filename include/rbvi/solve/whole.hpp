// A distributed matrix, whole on every rank.
#pragma once

#include "rbvi/fem/trace.hpp"

#include <vector>

namespace rbvi {

/// Collective on `comm`. All of `a`, sequential; on one rank `a` itself.
Handle<Mat> whole_matrix(Mat a, MPI_Comm comm);

/// Collective. Row of each contact dof of `trace` in it.
std::vector<PetscInt> whole_rows(Mat a, const Trace &trace);

} // namespace rbvi
