#include "linearised_contact.hpp"

#include "fixed_point.hpp"
#include "loaded_columns.hpp"
#include "pivoting.hpp"
#include "rbvi/core/error.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <span>

namespace rbvi {

namespace {

/// K on the contact dofs that it touches.
class CurvatureLoad {
public:
  explicit CurvatureLoad(const CurvatureRows &rows) : s_(rows.s), e_(rows.e) {
    position_.assign(rows.s.cols(), -1);
    touch(rows.s);
    touch(rows.e);
    std::sort(dofs_.begin(), dofs_.end());
    for (std::size_t k = 0; k < dofs_.size(); ++k)
      position_[dofs_[k]] = static_cast<Index>(k);
    s_ = local(rows.s);
    e_ = local(rows.e);
  }
  const std::vector<Index> &dofs() const { return dofs_; } ///< rising
  /// K change, both on dofs().
  Vector operator()(const Vector &change) const {
    return -(s_.transpose() * (e_ * change) + e_.transpose() * (s_ * change));
  }

private:
  void touch(const SparseMatrix &rows) {
    for (Index row = 0; row < rows.rows(); ++row)
      for (SparseMatrix::InnerIterator entry(rows, row); entry; ++entry)
        if (position_[entry.col()] < 0) {
          position_[entry.col()] = 0;
          dofs_.push_back(entry.col());
        }
  }
  SparseMatrix local(const SparseMatrix &rows) const {
    std::vector<Eigen::Triplet<double>> entries;
    for (Index row = 0; row < rows.rows(); ++row)
      for (SparseMatrix::InnerIterator entry(rows, row); entry; ++entry)
        entries.emplace_back(row, position_[entry.col()], entry.value());
    SparseMatrix result(rows.rows(), std::ssize(dofs_));
    result.setFromTriplets(entries.begin(), entries.end());
    return result;
  }

  std::vector<Index> dofs_, position_;
  SparseMatrix s_, e_;
};

/// C between dofs, which rise: a block for each body.
class ComplianceBetween {
public:
  ComplianceBetween(const std::vector<Index> &dofs, const Compliance &compliance) {
    for (auto first = dofs.begin(), after = first; first != dofs.end(); first = after) {
      const auto body = compliance.body_of(*first);
      after = std::lower_bound(first, dofs.end(), body.first + body.count);
      blocks_.push_back(block({first, after}, compliance));
    }
  }
  Vector operator*(const Vector &z) const {
    Vector result(z.size());
    Index first = 0;
    for (const Matrix &block : blocks_) {
      result.segment(first, block.rows()).noalias() = block * z.segment(first, block.rows());
      first += block.rows();
    }
    return result;
  }

private:
  /// Copied run by run, as most dofs follow each other.
  static Matrix block(std::span<const Index> dofs, const Compliance &compliance) {
    const Index count = std::ssize(dofs);
    Matrix result(count, count);
    for (Index first = 0, after = 0; first < count; first = after) {
      while (after < count && dofs[after] - dofs[first] == after - first)
        ++after;
      for (Index k = 0; k < count; ++k)
        result.col(k).segment(first, after - first) =
            compliance.column(dofs[k]).segment(dofs[first], after - first);
    }
    return result;
  }
  std::vector<Matrix> blocks_;
};

} // namespace

LinearisedContact::LinearisedContact(const NonlinearContact &contact, const Vector &state,
                                     double part)
    : contact_(contact), state_(state), back_((1 - part) * contact.undeformed),
      free_(part * contact.free), moved_(contact.laws.rows) {
  contact.linearise(state + back_, at_);
  if (part < 1) at_.g -= at_.b * back_;
  q_ = at_.g - at_.b * free_;
}

void LinearisedContact::move(const std::vector<Index> &which) {
  const Matrix moved = contact_.compliance->moved(at_.b, which);
  for (std::size_t k = 0; k < which.size(); ++k)
    moved_[which[k]] = moved.col(static_cast<Index>(k));
}

Matrix LinearisedContact::columns(const std::vector<Index> &which) {
  move(which);
  Matrix result(at_.b.rows(), std::ssize(which));
  for (std::size_t k = 0; k < which.size(); ++k)
    result.col(static_cast<Index>(k)) = at_.b * moved_[which[k]];
  return result;
}

Vector LinearisedContact::diagonal() const {
  Vector result = Vector::Zero(q_.size());
  double sum = 0, count = 0;
  for (Index row = 0; row < result.size(); ++row)
    if (moved_[row].size() > 0) {
      result[row] = at_.b.row(row).dot(moved_[row]);
      sum += result[row];
      ++count;
    }
  const double mean = sum > 0 ? sum / count : 1;
  return (result.array() > 0).select(result, mean);
}

Matrix LinearisedContact::moved(const std::vector<Index> &which) const {
  Matrix result(at_.b.cols(), std::ssize(which));
  for (std::size_t k = 0; k < which.size(); ++k)
    result.col(static_cast<Index>(k)) = moved_[which[k]];
  return result;
}

Iterate LinearisedContact::iterate(Vector x) const {
  Iterate result;
  result.u = free_;
  for (Index row = 0; row < x.size(); ++row)
    if (x[row] != 0) result.u -= x[row] * moved_[row];
  result.reaction = at_.b.transpose() * x;
  result.x = std::move(x);
  result.diagonal = diagonal();
  return result;
}

std::vector<Index> LinearisedContact::facing(const std::vector<Index> &active) const {
  std::vector<Index> result;
  std::ranges::copy_if(active, std::back_inserter(result), [this](Index row) {
    return static_cast<bool>(SparseMatrix::InnerIterator(at_.b, row));
  });
  return result;
}

Iterate LinearisedContact::solve(const Iterate &start) {
  const auto source = [this](const std::vector<Index> &which) { return columns(which); };
  if (contact_.laws.has_tangents()) {
    FrictionResult found = solve_friction(source, q_, contact_.laws, start.start);
    if (!found.converged) throw failure(found.reason);
    Iterate result = iterate(std::move(found.x));
    result.start = std::move(found.start);
    result.active = std::move(found.active);
    return result;
  }
  LcpResult found = solve_lcp(source, q_, facing(start.active));
  if (!found.converged) throw failure(found.reason);
  Iterate result = iterate(std::move(found.x));
  result.active = std::move(found.active);
  return result;
}

/// Multipliers that pull, and conditions that are not met.
std::vector<Index> LinearisedContact::violated(const std::vector<Index> &active, const Vector &x,
                                               const Vector &u) const {
  constexpr double round_off = 1e-12;
  const Vector w = at_.g - at_.b * u;
  const Vector terms = at_.b.cwiseAbs() * u.cwiseAbs() + at_.g.cwiseAbs();
  std::vector<Index> result;
  std::size_t next = 0;
  const double largest = x.size() > 0 ? x.cwiseAbs().maxCoeff() : 0;
  for (Index row = 0; row < w.size(); ++row) {
    const bool is_active = next < active.size() && active[next] == row;
    const bool wrong = is_active ? x[static_cast<Index>(next)] < -round_off * largest
                                 : w[row] < -round_off * terms[row];
    if (is_active) ++next;
    if (wrong) result.push_back(row);
  }
  return result;
}

/// With the rows of the active set I held as equations, H = B_I C B_I^T and z = K d, d = u - s:
///
///   d + S z = u_I - s,    S = C - C B_I^T H^-1 B_I C,    u_I: the solution without curvature,
///
/// on the dofs that K touches.
std::optional<Iterate> LinearisedContact::solve_with_curvature(const Iterate &start,
                                                               double tolerance) {
  constexpr int most_sets = 20;
  const CurvatureLoad curvature(contact_.curvature(state_ + back_, start.x));
  const std::vector<Index> &dofs = curvature.dofs();
  contact_.compliance->require(dofs);
  const ComplianceBetween local(dofs, *contact_.compliance);
  std::vector<Index> active = facing(start.active);
  for (int set = 0; set < most_sets; ++set) {
    std::vector<Index> fresh;
    std::copy_if(active.begin(), active.end(), std::back_inserter(fresh),
                 [this](Index row) { return moved_[row].size() == 0; });
    move(fresh);
    const Matrix of_active = moved(active), near = of_active(dofs, Eigen::all);
    Matrix h(of_active.cols(), of_active.cols()); // its lower triangle
    for (Index k = 0; k < h.cols(); ++k)
      for (Index j = 0; j <= k; ++j)
        h(k, j) = at_.b.row(active[k]).dot(of_active.col(j));
    if (!cholesky_in_place(h)) return std::nullopt;
    const Vector x0 = -cholesky_solve(h, q_(active));
    const Vector right = free_(dofs) - near * x0 - state_(dofs);
    const Vector d = fixed_point(right, tolerance, [&](const Vector &change) -> Vector {
      const Vector z = curvature(change);
      return local * z - near * cholesky_solve(h, near.transpose() * z);
    });
    const Vector z = curvature(d);
    const Vector x = x0 - cholesky_solve(h, near.transpose() * z);
    Vector u = free_ - of_active * x;
    LoadedColumns by_curvature;
    for (std::size_t k = 0; k < dofs.size(); ++k)
      by_curvature.add(z[static_cast<Index>(k)], contact_.compliance->column(dofs[k]).data(),
                       contact_.compliance->body_of(dofs[k]));
    by_curvature.subtract_from(u, {0, u.size()});
    const std::vector<Index> wrong = violated(active, x, u);
    if (!wrong.empty()) {
      active = pivoting::exchanged(active, wrong);
      continue;
    }
    Iterate result{Vector::Zero(q_.size()), {}, diagonal(), u, {}, active};
    result.x(active) = x.cwiseMax(0.0);
    result.reaction = at_.b.transpose() * result.x;
    result.reaction(dofs) += z;
    return result;
  }
  return std::nullopt;
}

} // namespace rbvi
