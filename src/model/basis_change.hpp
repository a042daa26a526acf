// Another basis of the reduced displacement: the leading functions of V, or V C. A part of a model
// that has rows or columns of V changes with it; which these are says change_basis in model.cpp,
// and for their parts certificate.cpp and nitsche_part.cpp.
#pragma once

#include "rbvi/model/packed.hpp"

namespace rbvi {

class BasisChange {
public:
  /// The first `size` of n functions.
  BasisChange(Index n, Index size) : before_(n), after_(size) {}
  /// V C, C n x k.
  explicit BasisChange(const Matrix &c) : before_(c.rows()), after_(c.cols()), c_(&c) {}

  Index before() const { return before_; }
  Index after() const { return after_; }
  /// Whether displacements are lost.
  bool loses() const { return after_ < before_; }
  /// M V -> M V C.
  Matrix columns(const Matrix &m) const {
    if (c_ != nullptr) return m * *c_;
    return m.leftCols(after_);
  }
  /// V^T M -> (V C)^T M.
  Matrix rows(const Matrix &m) const {
    if (c_ != nullptr) return c_->transpose() * m;
    return m.topRows(after_);
  }
  /// Packed V^T M V, each a column.
  Matrix triangles(const Matrix &packed) const;
  /// M_q V, each r x n, side by side.
  Matrix side_by_side(const Matrix &m) const;

private:
  Index before_, after_;
  const Matrix *c_ = nullptr; ///< null: the leading functions
};

/// The same of a part that may not be there.
inline void change_rows(const BasisChange &to, Matrix &part) {
  if (part.rows() == to.before()) part = to.rows(part);
}
inline void change_columns(const BasisChange &to, Matrix &part) {
  if (part.cols() == to.before()) part = to.columns(part);
}

} // namespace rbvi
