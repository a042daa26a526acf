// A full body behind contact, at one mu: its compliance on the contact dofs, each column a solve
// over the ranks, and its displacement everywhere.
#pragma once

#include "rbvi/fem/problem.hpp"
#include "rbvi/method/compliance.hpp"
#include "rbvi/method/nodal.hpp"
#include "rbvi/par/groups.hpp"
#include "rbvi/solve/linear.hpp"

#include <optional>

namespace rbvi {

class FullBody : public Compliance {
public:
  using Compliance::Compliance;
  /// What the loads alone move the contact dofs by. Collective.
  virtual Vector free(const Operators &op) = 0;
  /// u of A u = F - B^T lambda. Returns how far u may be off by round-off, as solve_refined().
  /// Collective.
  virtual double displacement(const Operators &op, const Vector &lambda, Vec u) = 0;
};

/// How long the columns of a compliance last.
enum class ColumnsLast {
  for_all_mu, ///< A is the same: one factorisation and at most n_c solves for a whole sweep
  for_one_mu, ///< several B are asked for
  for_one_b   ///< instead of columns C B^T is solved for
};

/// By a KSP, which has A as its operator.
class FactoredBody : public FullBody {
public:
  /// `ksp` and `trace` must outlive it.
  FactoredBody(KSP ksp, const Trace &trace, ColumnsLast last)
      : FullBody(trace.size), ksp_(ksp), trace_(trace), last_(last) {}
  bool keeps_columns() const { return last_ == ColumnsLast::for_all_mu; }
  /// A of the next calls. Not collective.
  void set(Mat a);
  /// As require(), on all groups, which all ask for the same columns; each solves for its share.
  void require(const std::vector<Index> &dofs, const Groups &groups);
  using Compliance::require;
  /// Makes all columns exist, by A's Schur complement on the contact dofs. Collective; with
  /// `groups`, the first makes them for all.
  void require_all(const Groups *groups = nullptr);

  Matrix moved(const SparseMatrix &b, const std::vector<Index> &which) override;
  Vector free(const Operators &op) override;
  double displacement(const Operators &op, const Vector &lambda, Vec u) override;

  /// For contact that is nodal (contact/interface.hpp).
  std::optional<NodalCompliance> nodal{};

private:
  void make(const std::vector<Index> &dofs, Eigen::Ref<Matrix> columns) override;
  /// E^T A^-1 E loads, contact dofs x loads.cols().
  Matrix responses(const Matrix &loads) const;

  KSP ksp_;
  const Trace &trace_;
  const ColumnsLast last_;
  Mat a_ = nullptr;
  const Groups *groups_ = nullptr; ///< that share the columns which are being made
};

} // namespace rbvi
