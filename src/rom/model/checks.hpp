// What is asked of a reduced model. Each throws failure, naming the member.
#pragma once

#include "rbvi/core/dense.hpp"

#include <string>
#include <vector>

namespace rbvi {

void require(bool holds, const std::string &what);
/// With entries that are finite.
void require_shape(const Matrix &matrix, Index rows, Index cols, const std::string &name);
/// In 0 .. bound - 1.
void require_indices(const std::vector<int> &indices, Index bound, const std::string &name);

} // namespace rbvi
