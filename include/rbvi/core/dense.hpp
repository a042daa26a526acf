// Small dense and sparse matrices that one core holds whole.
#pragma once

#include <Eigen/Dense>
#include <Eigen/SparseCore>

namespace rbvi {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;
using SparseMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;
using Index = Eigen::Index;

} // namespace rbvi
