// Small dense and sparse matrices that one core holds whole.
#pragma once

// Aligned alike under all flags: programs with others free memory that the library took.
#ifndef EIGEN_MAX_ALIGN_BYTES
#define EIGEN_MAX_ALIGN_BYTES 64
#define EIGEN_MAX_STATIC_ALIGN_BYTES 64
#endif

#include <Eigen/Dense>
#include <Eigen/SparseCore>

// Decompositions are compiled once, in core/dense.cpp: a fifth less to compile where they are used.
namespace Eigen {
extern template class LLT<MatrixXd>;
extern template class LDLT<MatrixXd>;
extern template class PartialPivLU<MatrixXd>;
extern template class HouseholderSequence<MatrixXd, VectorXd>;
extern template class HouseholderQR<MatrixXd>;
extern template class ColPivHouseholderQR<MatrixXd>;
extern template class CompleteOrthogonalDecomposition<MatrixXd>;
extern template class SelfAdjointEigenSolver<MatrixXd>;
} // namespace Eigen

namespace rbvi {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;
using SparseMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;
using Index = Eigen::Index;

} // namespace rbvi
